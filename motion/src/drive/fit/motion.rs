//! Fits a model to a recorded motion: friction of all joints together with what of the arm is asked for.
//!
//! ```text
//! τ = Y(q, q̇, q̈)·π + friction          linear in all parameters but the deflection before sliding
//! ```
//!
//! 1. Signals in one band (`super::signals`), columns of the unknowns (`super::design`), whether they say enough (`super::excitation`).
//! 2. The noise of each joint: what its own columns alone cannot explain. Its inverse square is the joint's weight, over the
//!    number of samples that are alike, so that the prior meets as many independent samples as there are.
//! 3. Deflections before sliding (`super::deflect`), one joint after the other, bodies in between.
//! 4. The ridge by cross-validation (`super::validate`), the solution, weights from its residuals, and once more.
//! 5. The noise that is stated: the likeliest one for errors on stretches that were left out, beside the covariance of the
//!    parameters there (`super::student`). The covariance is the inverse of all second derivatives at the solution.

use super::design::{Design, check_size};
use super::excitation::{check_motion, check_rank};
use super::linear::{Cholesky, dot};
use super::normal::{Gram, Normal};
use super::pose;
use super::recording::{self, Recording};
use super::report::{Estimate, JointFit, Missing, MotionFit, MotionOptions, MotionOutcome, Scope, Unknown};
use super::signals::Signals;
use super::solve::{Prior, Solution, inverse};
use super::student::{Noise, correlated_samples};
use super::uncertain;
use super::unknowns::Unknowns;
use super::validate::{Problem, Validated};
use super::{deflect, free_bodies, payload};
use crate::budget::{Budget, Stopped};
use crate::plan::Failure;
use crate::robot::Robot;
use crate::robot::spec::{ParameterKind, Residual};
use crate::tolerance::{ALONE_SHRINK, DEFLECTION_ROUNDS, FIT_FOLDS, LOAD_COULOMB_DEVIATION, RIDGE_START, RIDGES};

/// Fits a model to a recorded motion of an arm, beginning from its description.
///
/// # Errors
/// [`Failure::Invalid`]: the recording or the options are wrong; every finding, with its path. [`Failure::Stopped`]: the
/// budget ended.
pub fn fit_motion(
    robot: &Robot,
    recording: &Recording,
    options: &MotionOptions,
    budget: &Budget<'_>,
) -> Result<MotionOutcome, Failure> {
    let faults = recording::check(robot, recording, &options.selection);
    if !faults.is_empty() {
        return Err(Failure::Invalid(faults));
    }
    let signals = Signals::new(robot, recording, &options.selection, budget)?;
    let missing = check_motion(robot, &signals, options.selection.band);
    if !missing.is_empty() {
        return Ok(MotionOutcome::NotExcited(missing));
    }
    let unknowns = Unknowns::new(robot, options.scope);
    let joints = robot.joint_count();
    check_size(&signals, &unknowns, joints)?;
    let mut fit = Fit::new(robot, &signals, &unknowns, budget)?;
    let missing = check_rank(robot, &fit.normal, &unknowns, options.scope, &fit.weights, budget)?;
    if !missing.is_empty() {
        return Ok(MotionOutcome::NotExcited(missing));
    }
    let deviations = deviations(&signals, &unknowns);
    let mut aim = unknowns.described.clone();
    if options.scope == Scope::Payload
        && let Err(missing) = payload::aim(&fit.normal, &unknowns, &fit.weights, &mut aim, budget)?
    {
        return Ok(MotionOutcome::NotExcited(vec![missing]));
    }
    let Some(prior) = Prior::new(&unknowns, &aim, &deviations) else {
        return Ok(MotionOutcome::NotExcited(vec![unsolvable()]));
    };
    if options.presliding && !fit.find_deflections(&prior)? {
        return Ok(MotionOutcome::NotExcited(vec![unsolvable()]));
    }
    let Some(found) = fit.settle(&prior)? else {
        return Ok(MotionOutcome::NotExcited(vec![unsolvable()]));
    };
    let mut report = fit.report(&prior, &found)?;
    if options.scope != Scope::Bodies && check_size(&signals, &Unknowns::new(robot, Scope::Bodies), joints).is_ok() {
        let errors = free_bodies::validated(robot, &signals, budget)?;
        for (joint, error) in report.joints.iter_mut().zip(errors) {
            joint.error_with_free_bodies = Some(error);
        }
    }
    report.warnings = pose::warnings(robot, &unknowns, &report);
    Ok(MotionOutcome::Fitted(Box::new(report)))
}

fn unsolvable() -> Missing {
    Missing {
        parameters: Vec::new(),
        message: "the equations have no solution: the motion says too little of what is asked".to_owned(),
    }
}

/// How far friction and rotors may be from the description: as far as the torque itself goes. Bodies have their own measure.
fn deviations(signals: &Signals, unknowns: &Unknowns) -> Vec<f64> {
    let rms = |values: &[f64]| (dot(values, values) / values.len().max(1) as f64).sqrt();
    let of = |unknown: &Unknown| {
        let Unknown::Joint(parameter) = unknown else { return 1.0 };
        let j = parameter.joint;
        let torque = signals.of(&signals.torque[j]);
        let mean = torque.iter().sum::<f64>() / torque.len() as f64;
        let centred: Vec<f64> = torque.iter().map(|t| t - mean).collect();
        let torque = rms(&centred).max(f64::MIN_POSITIVE.sqrt());
        let speed = rms(signals.of(&signals.qd[j]));
        match parameter.kind {
            ParameterKind::Armature => torque / rms(signals.of(&signals.qdd[j])),
            ParameterKind::Viscous => torque / speed,
            ParameterKind::Quadratic => torque / (speed * speed),
            ParameterKind::LoadCoulomb => LOAD_COULOMB_DEVIATION,
            _ => torque,
        }
    };
    unknowns.list.iter().map(of).collect()
}

/// A fit under way.
struct Fit<'a> {
    robot: &'a Robot,
    signals: &'a Signals,
    unknowns: &'a Unknowns,
    budget: &'a Budget<'a>,
    design: Design,
    normal: Normal,
    /// Weight of each joint's samples.
    weights: Vec<f64>,
    deflections: Vec<Option<f64>>,
}

/// Where a fit came to rest.
struct Found {
    ridge: f64,
    solution: Solution,
    validated: Validated,
}

impl<'a> Fit<'a> {
    fn new(
        robot: &'a Robot,
        signals: &'a Signals,
        unknowns: &'a Unknowns,
        budget: &'a Budget<'a>,
    ) -> Result<Self, Failure> {
        let design = Design::new(robot, signals, unknowns, budget)?;
        let normal = Normal::new(&design, signals, FIT_FOLDS, unknowns.count(), budget)?;
        let mut fit = Self {
            robot,
            signals,
            unknowns,
            budget,
            design,
            normal,
            weights: Vec::new(),
            deflections: vec![None; robot.joint_count()],
        };
        fit.weigh_alone()?;
        Ok(fit)
    }

    fn problem<'b>(&'b self, prior: &'b Prior) -> Problem<'b> {
        Problem {
            design: &self.design,
            normal: &self.normal,
            prior,
            weights: &self.weights,
            budget: self.budget,
        }
    }

    /// Weights from what each joint's own columns leave of its torque.
    fn weigh_alone(&mut self) -> Result<(), Stopped> {
        let mut residuals = Vec::with_capacity(self.design.rows.len());
        for (joint, rows) in self.design.rows.iter().enumerate() {
            let alone = alone(&self.normal.of_joint(joint), self.budget)?;
            let mut solution = vec![0.0; self.unknowns.count()];
            for (unknown, value) in rows.unknowns.iter().zip(alone) {
                solution[*unknown] = value;
            }
            let (from, to) = self.signals.selected;
            residuals.push(rows.residual_of(&solution, from, to));
        }
        self.weigh(&residuals)
    }

    fn weigh(&mut self, residuals: &[Vec<f64>]) -> Result<(), Stopped> {
        let mut alike = Vec::with_capacity(residuals.len());
        for residual in residuals {
            alike.push(correlated_samples(residual, self.budget)?);
        }
        alike.sort_by(f64::total_cmp);
        let alike = alike[alike.len() / 2];
        self.weights = residuals
            .iter()
            .zip(&self.design.rows)
            .map(|(residual, rows)| {
                let target = self.signals.of(&rows.target);
                // a torque that is explained to the last digit would weigh more than its rounding allows
                let least = f64::EPSILON * (dot(target, target) + f64::MIN_POSITIVE.sqrt());
                residual.len() as f64 / (dot(residual, residual).max(least) * alike)
            })
            .collect();
        Ok(())
    }

    fn find_deflections(&mut self, prior: &Prior) -> Result<bool, Stopped> {
        let joints = self.design.rows.len();
        for _ in 0..DEFLECTION_ROUNDS {
            let Some(solution) = self.problem(prior).solve(RIDGE_START, &prior.values)? else {
                return Ok(false);
            };
            let mut changed = false;
            for joint in 0..joints {
                let found = deflect::search(
                    &self.design,
                    self.signals,
                    self.unknowns,
                    &solution.values,
                    joint,
                    self.budget,
                )?;
                if found == self.deflections[joint] {
                    continue;
                }
                changed = true;
                self.deflections[joint] = found;
                self.design.set_deflection(self.signals, joint, found);
                self.normal.update(&self.design.rows[joint], joint, self.budget)?;
            }
            if !changed {
                break;
            }
            self.weigh_alone()?;
        }
        Ok(true)
    }

    /// Ridge, solution and weights, twice: the first weights know nothing of what the joints say of one another.
    fn settle(&mut self, prior: &Prior) -> Result<Option<Found>, Stopped> {
        let Some(ridges) = self.ridges(prior, &prior.values)? else {
            return Ok(None);
        };
        let mut first = None;
        for ridge in ridges {
            first = self.problem(prior).solve(ridge, &prior.values)?;
            if first.is_some() {
                break;
            }
        }
        let Some(first) = first else { return Ok(None) };
        let (from, to) = self.signals.selected;
        let residuals: Vec<Vec<f64>> = self
            .design
            .rows
            .iter()
            .map(|rows| rows.residual_of(&first.values, from, to))
            .collect();
        self.weigh(&residuals)?;
        let Some(ridges) = self.ridges(prior, &first.values)? else {
            return Ok(None);
        };
        for ridge in ridges {
            let found = self.find(prior, ridge, &first.values)?;
            if found.is_some() {
                return Ok(found);
            }
        }
        Ok(None)
    }

    /// The ridge of the cross-validation, and the stronger ones: where the weakest leave a body too near to none for its equations to be solved with some stretch
    /// left out, the next one does.
    fn ridges(&self, prior: &Prior, start: &[f64]) -> Result<Option<Vec<f64>>, Stopped> {
        if prior.bodies.is_empty() {
            return Ok(Some(vec![0.0]));
        }
        let Some(middle) = self.problem(prior).solve(RIDGE_START, start)? else {
            return Ok(None);
        };
        let chosen = self.problem(prior).choose_ridge(&middle.values, self.trusts_bodies())?;
        Ok(chosen.map(|chosen| RIDGES.into_iter().filter(|ridge| *ridge >= chosen).collect()))
    }

    fn find(&self, prior: &Prior, ridge: f64, start: &[f64]) -> Result<Option<Found>, Stopped> {
        let Some(mut solution) = self.problem(prior).solve(ridge, start)? else {
            return Ok(None);
        };
        if !self.trusts_bodies()
            && let Some(beforehand) = prior.second_derivatives(RIDGES[0], &solution.values)
        {
            // the body that it is drawn to came from the same torques: it adds no certainty
            let (data, _) = self.normal.sum(&self.weights, None);
            solution.hessian = data.iter().zip(&beforehand).map(|(a, b)| a + b).collect();
        }
        let validated = self.problem(prior).validate(ridge, &solution.values, true)?;
        Ok(validated.map(|validated| Found {
            ridge,
            solution,
            validated,
        }))
    }

    fn report(&self, prior: &Prior, found: &Found) -> Result<MotionFit, Stopped> {
        let (from, to) = self.signals.selected;
        let count = self.unknowns.count();
        let values = &found.solution.values;
        let covariance = inverse(&found.solution.hessian, count, self.budget)?.unwrap_or_default();
        let (data, _) = self.normal.sum(&self.weights, None);
        let ridge = if self.trusts_bodies() { found.ridge } else { RIDGES[0] };
        let beforehand = match prior.second_derivatives(ridge, values) {
            Some(precision) => inverse(&precision, count, self.budget)?.unwrap_or_default(),
            None => Vec::new(),
        };
        let told = |k: usize| {
            let before = beforehand.get(k * count + k).copied().unwrap_or(f64::INFINITY);
            (1.0 - covariance[k * count + k] / before).clamp(0.0, 1.0)
        };
        let mut estimates = Vec::with_capacity(count);
        for (k, unknown) in self.unknowns.list.iter().enumerate() {
            estimates.push(Estimate {
                unknown: *unknown,
                value: values[k],
                described: self.described(k),
                deviation: covariance[k * count + k].max(0.0).sqrt(),
                told: told(k),
                held: prior.is_held(values, k),
            });
        }
        let mut joints = Vec::with_capacity(self.design.rows.len());
        let mut noises = Vec::with_capacity(joints.capacity());
        for (j, rows) in self.design.rows.iter().enumerate() {
            self.budget.check()?;
            let (errors, variances) = (&found.validated.errors[j], &found.validated.variances[j]);
            let noise = Noise::of(errors, variances, self.budget)?;
            let correlation_time = correlated_samples(errors, self.budget)? * self.signals.period;
            noises.push(Residual {
                deviation: noise.deviation,
                correlation_time,
                degrees_of_freedom: noise.degrees_of_freedom,
            });
            let torque = self.signals.of(&self.signals.torque[j]);
            let share = |e: &[f64]| (dot(e, e) / dot(torque, torque).max(f64::MIN_POSITIVE)).sqrt();
            let dependence = pose::dependence(self.signals, errors, self.budget)?;
            joints.push(JointFit {
                fitted_error: share(&rows.residual_of(values, from, to)),
                validated_error: share(errors),
                presliding_deflection: self.deflections[j],
                correlation_time,
                error_with_free_bodies: None,
                pose_share: dependence.share,
                pose_joint: dependence.joint,
                by_position: pose::bins(self.signals.of(&self.signals.q[j]), errors),
                by_speed: pose::bins(self.signals.of(&self.signals.qd[j]), errors),
            });
        }
        let mut spec = self.unknowns.model(self.robot, values, &self.deflections);
        spec.uncertainty = Some(uncertain::of(&spec, self.unknowns, &covariance, noises));
        Ok(MotionFit {
            spec,
            // the trace of the product: how many directions are the motion's
            determined: dot(&covariance, &data),
            estimates,
            joints,
            ridge: (!prior.bodies.is_empty()).then_some(found.ridge),
            sample_count: self.signals.count(),
            fold_count: self.normal.stretches.len(),
            warnings: Vec::new(),
        })
    }

    /// Whether bodies are drawn to a maker's description, and not to a payload of which only the torque speaks.
    fn trusts_bodies(&self) -> bool {
        !self.unknowns.list.contains(&Unknown::Payload(0))
    }

    fn described(&self, k: usize) -> f64 {
        match self.unknowns.list[k] {
            Unknown::Joint(parameter) => self.unknowns.joints[crate::dynamics::regressor::column(parameter)],
            Unknown::Payload(part) => self.unknowns.payload[part],
        }
    }
}

/// One joint's torque explained by its own columns alone, each shrunk by rounding.
pub(crate) fn alone(gram: &Gram, budget: &Budget<'_>) -> Result<Vec<f64>, Stopped> {
    let size = gram.product.len();
    let scale: Vec<f64> = (0..size)
        .map(|k| 1.0 / gram.matrix[k * size + k].max(f64::MIN_POSITIVE).sqrt())
        .collect();
    let mut matrix: Vec<f64> = (0..size * size)
        .map(|e| gram.matrix[e] * scale[e / size] * scale[e % size])
        .collect();
    for k in 0..size {
        matrix[k * size + k] += ALONE_SHRINK;
    }
    let mut values: Vec<f64> = gram.product.iter().zip(&scale).map(|(b, s)| b * s).collect();
    if let Some(factor) = Cholesky::new(&matrix, size, budget)? {
        factor.solve(&mut values);
    }
    Ok(values.iter().zip(&scale).map(|(v, s)| v * s).collect())
}

#[cfg(test)]
mod tests;
