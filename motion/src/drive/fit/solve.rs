//! The fit itself: the least of
//!
//! ```text
//! ½·Σ w·|y − X·p|²  +  γ·Σ d(P, P₀)  +  ½·Σ ((p − p₀)/s)²        over bodies P, magnitudes p ≥ 0, slopes u ≥ 0
//! u = c + 2·d·v̂                                                   slope of friction c·v + d·v·|v| at the speed limit v̂
//! ```
//!
//! The first term is the motion's, with weights that count each stretch of correlated samples once; the second draws bodies
//! towards the description and keeps them bodies ([`super::pseudo`]); the third is what is known of friction and rotors
//! beforehand, wide. The whole is convex: Newton's method with backtracking, magnitudes that would fall below 0 held there
//! (D. Bertsekas, "Projected Newton methods for optimization problems with simple constraints", 1982).
//!
//! Gears under oil resist less and less per speed, so the quadratic term d may be negative: but friction never falls with speed within the
//! limit, where the motion that is fitted may not have been. That bound is simple in u, which Newton's method therefore has in the place of d.

use super::linear::{Cholesky, dot};
use super::pseudo::Pull;
use super::unknowns::Unknowns;
use crate::budget::{Budget, Stopped};
use crate::dynamics::regressor::BODY;
use crate::robot::spec::ParameterKind;
use crate::tolerance::{
    FIT_BACKTRACKS, FIT_DECREASE, FIT_NEWTON_DONE, FIT_NEWTON_ROUNDS, FIT_RIDGE_PATH, SLOPE_ROUNDING,
};

/// What is known of the unknowns before the motion.
#[derive(Debug, Clone)]
pub(crate) struct Prior {
    /// Values to begin at and to be drawn to; bodies are sound ones.
    pub(crate) values: Vec<f64>,
    /// Precision of each unknown that is no body's: 1/s².
    pub(crate) precision: Vec<f64>,
    /// Where each body begins, and what draws it.
    pub(crate) bodies: Vec<(usize, Pull)>,
    /// Which unknowns must not be below 0: of a quadratic term with a slope the slope.
    pub(crate) magnitudes: Vec<bool>,
    /// Joints with a speed limit and both terms.
    slopes: Vec<Slope>,
}

/// What ties a joint's quadratic friction to its viscous one: where they are among the unknowns, and twice the speed limit.
#[derive(Debug, Clone, Copy)]
struct Slope {
    viscous: usize,
    quadratic: usize,
    twice: f64,
}

/// A solution and its second derivatives.
#[derive(Debug, Clone)]
pub(crate) struct Solution {
    pub(crate) values: Vec<f64>,
    /// Second derivatives of the whole, as if nothing were held.
    pub(crate) hessian: Vec<f64>,
}

impl Prior {
    /// Of unknowns whose magnitudes have given standard deviations (a value for each unknown, unused for bodies), drawing bodies towards `values`.
    pub(crate) fn new(unknowns: &Unknowns, values: &[f64], deviations: &[f64]) -> Option<Self> {
        let mut bodies = Vec::with_capacity(unknowns.bodies.len());
        for start in &unknowns.bodies {
            bodies.push((*start, Pull::towards(&values[*start..start + BODY])?));
        }
        let magnitudes: Vec<bool> = (0..unknowns.count()).map(|k| unknowns.is_magnitude(k)).collect();
        let precision = magnitudes
            .iter()
            .zip(deviations)
            .map(|(is_magnitude, s)| if *is_magnitude { 1.0 / (s * s) } else { 0.0 });
        Some(Self {
            values: values.to_vec(),
            precision: precision.collect(),
            bodies,
            magnitudes,
            slopes: slopes(unknowns),
        })
    }

    /// Whether an unknown is where it may go no further.
    pub(crate) fn is_held(&self, values: &[f64], index: usize) -> bool {
        self.magnitudes[index] && self.bounded(values)[index] <= SLOPE_ROUNDING * values[index].abs()
    }

    /// The values with slopes in the place of quadratic terms.
    fn bounded(&self, values: &[f64]) -> Vec<f64> {
        let mut bounded = values.to_vec();
        for slope in &self.slopes {
            bounded[slope.quadratic] = values[slope.viscous] + slope.twice * values[slope.quadratic];
        }
        bounded
    }

    fn unbounded(&self, bounded: &[f64]) -> Vec<f64> {
        let mut values = bounded.to_vec();
        for slope in &self.slopes {
            values[slope.quadratic] = (bounded[slope.quadratic] - bounded[slope.viscous]) / slope.twice;
        }
        values
    }

    /// Derivatives by what is bounded, of those by the unknowns: a row of them, in place.
    fn by_bounded(&self, row: &mut [f64]) {
        for slope in &self.slopes {
            let by_slope = row[slope.quadratic] / slope.twice;
            row[slope.viscous] -= by_slope;
            row[slope.quadratic] = by_slope;
        }
    }

    fn second_by_bounded(&self, hessian: &mut [f64]) {
        let n = self.values.len();
        hessian.chunks_mut(n).for_each(|row| self.by_bounded(row));
        for slope in &self.slopes {
            for column in 0..n {
                let by_slope = hessian[slope.quadratic * n + column] / slope.twice;
                hessian[slope.viscous * n + column] -= by_slope;
                hessian[slope.quadratic * n + column] = by_slope;
            }
        }
    }

    /// Second derivatives of what is known beforehand, at given values.
    pub(crate) fn second_derivatives(&self, ridge: f64, values: &[f64]) -> Option<Vec<f64>> {
        let n = self.values.len();
        let mut hessian = vec![0.0; n * n];
        for (k, precision) in self.precision.iter().enumerate() {
            hessian[k * n + k] = *precision;
        }
        for (start, pull) in &self.bodies {
            let (_, of_body) = pull.derivatives(&values[*start..start + BODY])?;
            for (a, row) in of_body.iter().enumerate() {
                for (b, value) in row.iter().enumerate() {
                    hessian[(start + a) * n + start + b] = ridge * value;
                }
            }
        }
        Some(hessian)
    }

    fn objective(&self, matrix: &[f64], product: &[f64], ridge: f64, p: &[f64]) -> Option<f64> {
        let n = p.len();
        let mut sum = 0.0;
        for (k, value) in p.iter().enumerate() {
            let off = value - self.values[k];
            sum += value * (0.5 * dot(&matrix[k * n..(k + 1) * n], p) - product[k]);
            sum += 0.5 * self.precision[k] * off * off;
        }
        for (start, pull) in &self.bodies {
            sum += ridge * pull.distance(&p[*start..start + BODY])?;
        }
        sum.is_finite().then_some(sum)
    }

    fn gradient(&self, matrix: &[f64], product: &[f64], ridge: f64, p: &[f64]) -> Option<Vec<f64>> {
        let n = p.len();
        let mut gradient: Vec<f64> = (0..n)
            .map(|k| dot(&matrix[k * n..(k + 1) * n], p) - product[k] + self.precision[k] * (p[k] - self.values[k]))
            .collect();
        for (start, pull) in &self.bodies {
            let (of_body, _) = pull.derivatives(&p[*start..start + BODY])?;
            for (k, value) in of_body.iter().enumerate() {
                gradient[start + k] += ridge * value;
            }
        }
        Some(gradient)
    }
}

fn slopes(unknowns: &Unknowns) -> Vec<Slope> {
    let of_joint = |(joint, limit): (usize, &Option<f64>)| {
        Some(Slope {
            viscous: unknowns.index(joint, ParameterKind::Viscous)?,
            quadratic: unknowns.index(joint, ParameterKind::Quadratic)?,
            twice: 2.0 * (*limit)?,
        })
    };
    unknowns
        .speed_limits
        .iter()
        .enumerate()
        .filter_map(|(j, limit)| of_joint((j, limit)))
        .collect()
}

/// Where Newton's method came to rest, or did not.
enum Ended {
    Least(Vec<f64>),
    /// After so many rounds that the start was too far away.
    Far,
    Unsolvable,
}

/// Solves from a start that keeps every bound. `None`: the second derivatives are not positive definite, so something is told neither by the
/// motion nor beforehand.
///
/// A body that must grow tenfold against a weak ridge is far for Newton's method: each step would leave what bodies can be, and is cut short. Then the solution is
/// followed from the description on along ridges that give way.
pub(crate) fn solve(
    prior: &Prior,
    equations: &(Vec<f64>, Vec<f64>),
    ridge: f64,
    start: &[f64],
    budget: &Budget<'_>,
) -> Result<Option<Solution>, Stopped> {
    let mut ended = newton(prior, equations, ridge, start, budget)?;
    if let Ended::Far = ended {
        let mut at = prior.values.clone();
        for factor in FIT_RIDGE_PATH {
            ended = newton(prior, equations, ridge * factor, &at, budget)?;
            let Ended::Least(values) = &ended else { break };
            at.clone_from(values);
        }
    }
    let Ended::Least(values) = ended else { return Ok(None) };
    let of_prior = prior.second_derivatives(ridge, &values);
    Ok(of_prior.map(|of_prior| Solution {
        hessian: of_prior.iter().zip(&equations.0).map(|(a, b)| a + b).collect(),
        values,
    }))
}

fn newton(
    prior: &Prior,
    (matrix, product): &(Vec<f64>, Vec<f64>),
    ridge: f64,
    start: &[f64],
    budget: &Budget<'_>,
) -> Result<Ended, Stopped> {
    let n = start.len();
    let mut p = start.to_vec();
    let mut bounded = prior.bounded(&p);
    let Some(mut least) = prior.objective(matrix, product, ridge, &p) else {
        return Ok(Ended::Unsolvable);
    };
    let scale = least.abs() + 1.0;
    for _ in 0..FIT_NEWTON_ROUNDS {
        let Some((mut gradient, hessian)) = prior
            .gradient(matrix, product, ridge, &p)
            .zip(prior.second_derivatives(ridge, &p))
        else {
            return Ok(Ended::Unsolvable);
        };
        let mut hessian: Vec<f64> = hessian.iter().zip(matrix).map(|(a, b)| a + b).collect();
        prior.by_bounded(&mut gradient);
        prior.second_by_bounded(&mut hessian);
        let held: Vec<bool> = (0..n)
            .map(|k| prior.magnitudes[k] && bounded[k] <= 0.0 && gradient[k] > 0.0)
            .collect();
        let Some(step) = newton_step(&hessian, &gradient, &held, budget)? else {
            return Ok(Ended::Unsolvable);
        };
        let decrease = -dot(&gradient, &step);
        let mut done = decrease <= FIT_NEWTON_DONE * scale;
        let mut length = 1.0;
        let mut tried = 0;
        while !done {
            let candidate: Vec<f64> = (0..n)
                .map(|k| {
                    let moved = bounded[k] + length * step[k];
                    if prior.magnitudes[k] { moved.max(0.0) } else { moved }
                })
                .collect();
            let foreseen: f64 = (0..n).map(|k| gradient[k] * (bounded[k] - candidate[k])).sum();
            let values = prior.unbounded(&candidate);
            let value = prior.objective(matrix, product, ridge, &values);
            if let Some(value) = value.filter(|value| *value <= least - FIT_DECREASE * foreseen) {
                done = least - value <= FIT_NEWTON_DONE * scale;
                p = values;
                bounded = candidate;
                least = value;
                break;
            }
            length *= 0.5;
            tried += 1;
            done = tried == FIT_BACKTRACKS;
        }
        if done {
            return Ok(Ended::Least(p));
        }
    }
    Ok(Ended::Far)
}

/// −H⁻¹·g over what is free.
fn newton_step(
    hessian: &[f64],
    gradient: &[f64],
    held: &[bool],
    budget: &Budget<'_>,
) -> Result<Option<Vec<f64>>, Stopped> {
    let n = gradient.len();
    let free: Vec<usize> = (0..n).filter(|k| !held[*k]).collect();
    // scaled to a diagonal of ones: units of mass and of inertia are far apart
    let scale: Vec<f64> = free.iter().map(|k| 1.0 / hessian[k * n + k].sqrt()).collect();
    let mut matrix = Vec::with_capacity(free.len() * free.len());
    for (row, row_scale) in free.iter().zip(&scale) {
        matrix.extend(
            free.iter()
                .zip(&scale)
                .map(|(c, s)| hessian[row * n + c] * row_scale * s),
        );
    }
    let Some(factor) = Cholesky::new(&matrix, free.len(), budget)? else {
        return Ok(None);
    };
    let mut reduced: Vec<f64> = free.iter().zip(&scale).map(|(k, s)| -gradient[*k] * s).collect();
    factor.solve(&mut reduced);
    let mut step = vec![0.0; n];
    for ((k, s), value) in free.iter().zip(&scale).zip(reduced) {
        step[*k] = value * s;
    }
    Ok(Some(step))
}

/// Inverse of a positive definite matrix of mixed units.
pub(crate) fn inverse(matrix: &[f64], size: usize, budget: &Budget<'_>) -> Result<Option<Vec<f64>>, Stopped> {
    let scale: Vec<f64> = (0..size).map(|k| 1.0 / matrix[k * size + k].sqrt()).collect();
    let scaled: Vec<f64> = (0..size * size)
        .map(|e| matrix[e] * scale[e / size] * scale[e % size])
        .collect();
    let Some(factor) = Cholesky::new(&scaled, size, budget)? else {
        return Ok(None);
    };
    let mut inverse = factor.inverse(budget)?;
    for (e, value) in inverse.iter_mut().enumerate() {
        *value *= scale[e / size] * scale[e % size];
    }
    Ok(Some(inverse))
}
