//! How well a model says the torque of a motion, and how true its stated intervals are.
//!
//! The interval of 95 % at a sample is that of Student's distribution with the variance φᵀ·Σ·φ + s² (φ: derivatives of the torque by the
//! fitted parameters, Σ: their covariance, s: deviation of the residual). Below `REST_SPEED` friction may be anything between its two
//! directions, and the interval is wider by the Coulomb torque. That is what plans keep. A controller that watches its torques knows more:
//! the second interval also follows the residual, a period of the band behind it (`super::online`).

use super::design::{Design, check_size};
use super::linear::dot;
use super::online::{OnlineInterval, Stated, horizon_samples};
use super::recording::{self, Recording, Selection};
use super::report::{Assessment, IntervalAssessment, JointAssessment, Scope};
use super::signals::Signals;
use super::student::Noise;
use super::unknowns::{Unknowns, deflection};
use crate::budget::Budget;
use crate::dynamics::regressor::PER_JOINT;
use crate::error::Invalid;
use crate::plan::Failure;
use crate::robot::Robot;
use crate::robot::spec::{Parameter, ParameterKind, Residual, Uncertainty};
use crate::tolerance::{BUDGET_STRIDE, REST_SPEED};

/// The confidence of the intervals that are assessed.
const CONFIDENCE: f64 = 0.95;

/// Compares the torque that a model states with a recorded one.
///
/// # Errors
/// [`Failure::Invalid`]: the recording, the selection or the model's uncertainty is wrong; every finding, with its path.
/// [`Failure::Stopped`]: the budget ended.
pub fn assess(
    robot: &Robot,
    recording: &Recording,
    selection: &Selection,
    budget: &Budget<'_>,
) -> Result<Assessment, Failure> {
    let mut faults = recording::check(robot, recording, selection);
    let uncertainty = robot.spec().uncertainty.as_ref();
    faults.extend(uncertainty.and_then(|uncertainty| fault(robot, uncertainty)));
    if !faults.is_empty() {
        return Err(Failure::Invalid(faults));
    }
    let signals = Signals::new(robot, recording, selection, budget)?;
    let unknowns = match uncertainty {
        Some(uncertainty) => Unknowns::of(robot, &uncertainty.parameters),
        None => Unknowns::new(robot, Scope::Friction),
    };
    check_size(&signals, &unknowns, robot.joint_count())?;
    let mut design = Design::new(robot, &signals, &unknowns, budget)?;
    for joint in 0..robot.joint_count() {
        design.set_deflection(&signals, joint, deflection(robot, joint));
    }
    let covariance = uncertainty.map(|uncertainty| whole(&uncertainty.covariance, unknowns.count()));
    let (from, to) = signals.selected;
    let mut joints = Vec::with_capacity(robot.joint_count());
    for (j, rows) in design.rows.iter().enumerate() {
        let errors = rows.residual_of(&unknowns.described, from, to);
        let torque = signals.of(&signals.torque[j]);
        let percentile = part_below(errors.iter().map(|e| e.abs()).collect(), CONFIDENCE);
        let (mut interval, mut online) = (None, None);
        if let (Some(uncertainty), Some(covariance)) = (uncertainty, &covariance) {
            let residual = &uncertainty.residuals[j];
            let stated = Interval::new(residual, coulomb(&unknowns, j));
            let mut watched = OnlineInterval::new(residual, CONFIDENCE, selection.band, signals.period);
            let mut tallies = [Tally::default(), Tally::default()];
            for (sample, error) in (from..to).zip(&errors) {
                if sample % BUDGET_STRIDE == 0 {
                    budget.check()?;
                }
                let moving = stated.moving(rows.variance(covariance, unknowns.count(), sample));
                let allowance = stated.allowance(signals.qd[j][sample]);
                tallies[0].add(error.abs() <= moving + allowance, moving + allowance);
                let stated = Stated {
                    half_width: moving,
                    allowance,
                    speed: signals.qd[j][sample],
                };
                let foretold = watched.next(stated, *error);
                tallies[1].add(foretold.holds(*error), foretold.half_width);
            }
            [interval, online] = tallies.map(|tally| Some(tally.over(percentile)));
        }
        let peak = robot.spec().joints[j].drive.peak_torque;
        joints.push(JointAssessment {
            error: (dot(&errors, &errors) / dot(torque, torque).max(f64::MIN_POSITIVE)).sqrt(),
            percentile,
            percentile_of_peak: peak.map(|peak| percentile / peak),
            interval,
            online,
        });
    }
    Ok(Assessment {
        joints,
        sample_count: signals.count(),
        online_horizon: horizon_samples(selection.band, signals.period) as f64 * signals.period,
    })
}

/// The stated interval of one joint.
struct Interval {
    noise: Noise,
    /// Half width over deviation.
    unit: f64,
    coulomb: f64,
}

impl Interval {
    fn new(residual: &Residual, coulomb: f64) -> Self {
        let noise = Noise {
            deviation: residual.deviation,
            degrees_of_freedom: residual.degrees_of_freedom,
        };
        Self {
            noise,
            unit: noise.unit(CONFIDENCE),
            coulomb,
        }
    }

    /// Half width where a joint moves.
    fn moving(&self, variance: f64) -> f64 {
        let deviation = self.noise.deviation;
        self.unit * (deviation * deviation + variance).sqrt()
    }

    /// What it is wider by at a speed.
    fn allowance(&self, speed: f64) -> f64 {
        if speed.abs() < REST_SPEED { self.coulomb } else { 0.0 }
    }
}

/// Samples counted against their intervals.
#[derive(Debug, Clone, Copy, Default)]
struct Tally {
    count: f64,
    within: f64,
    half_widths: f64,
}

impl Tally {
    fn add(&mut self, is_within: bool, half_width: f64) {
        self.count += 1.0;
        self.within += f64::from(u8::from(is_within));
        self.half_widths += half_width;
    }

    fn over(&self, percentile: f64) -> IntervalAssessment {
        let half_width = self.half_widths / self.count;
        IntervalAssessment {
            coverage: self.within / self.count,
            half_width,
            over_narrowest: half_width / percentile.max(f64::MIN_POSITIVE),
        }
    }
}

/// The larger Coulomb torque of a joint.
fn coulomb(unknowns: &Unknowns, joint: usize) -> f64 {
    let values = &unknowns.joints[joint * PER_JOINT..(joint + 1) * PER_JOINT];
    let of = |kind| values[crate::dynamics::regressor::column(Parameter { joint: 0, kind })];
    of(ParameterKind::CoulombPositive).max(of(ParameterKind::CoulombNegative))
}

/// The value that a part of all does not exceed.
fn part_below(mut sorted: Vec<f64>, part: f64) -> f64 {
    sorted.sort_by(f64::total_cmp);
    let place = (part * sorted.len() as f64).ceil() as usize;
    sorted.get(place.saturating_sub(1)).copied().unwrap_or(0.0)
}

/// A symmetric matrix of its lower triangle.
fn whole(triangle: &[f64], size: usize) -> Vec<f64> {
    let mut matrix = vec![0.0; size * size];
    let mut entries = triangle.iter();
    for i in 0..size {
        for j in 0..=i {
            let value = entries.next().copied().unwrap_or(0.0);
            matrix[i * size + j] = value;
            matrix[j * size + i] = value;
        }
    }
    matrix
}

fn fault(robot: &Robot, uncertainty: &Uncertainty) -> Option<Invalid> {
    let (joints, count) = (robot.joint_count(), uncertainty.parameters.len());
    if let Some(parameter) = uncertainty
        .parameters
        .iter()
        .find(|parameter| parameter.joint >= joints)
    {
        let message = format!("there is no joint {}, the arm has {joints}", parameter.joint);
        return Some(Invalid::new("uncertainty.parameters", message));
    }
    let expected = count * (count + 1) / 2;
    if uncertainty.covariance.len() != expected {
        let message = format!(
            "{} entries, {count} parameters have {expected}",
            uncertainty.covariance.len()
        );
        return Some(Invalid::new("uncertainty.covariance", message));
    }
    if uncertainty.residuals.len() != joints {
        let message = format!("{} entries, the arm has {joints} joints", uncertainty.residuals.len());
        return Some(Invalid::new("uncertainty.residuals", message));
    }
    let is_sound = |residual: &Residual| residual.deviation >= 0.0 && residual.degrees_of_freedom > 2.0;
    if !uncertainty.residuals.iter().all(is_sound) {
        let message = "a deviation must not be negative, degrees of freedom must be above 2";
        return Some(Invalid::new("uncertainty.residuals", message));
    }
    None
}
