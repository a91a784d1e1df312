//! Torque limits that hold at a stated confidence, given how well the model is known.
//!
//! A model that was fitted to recorded motion carries the covariance of its parameters and the residual that it left
//! ([`crate::robot::spec::Uncertainty`]). The torque that a drive will need is then within a band about the one that the model
//! says, and a plan holds its limits T at a confidence where
//!
//! ```text
//! |τ| + b ≤ T        at every joint, everywhere
//! ```
//!
//! `width` derives the half-width b. A plan is made by the planner as it is: its torque limits are tightened by the excess that
//! the plan before had anywhere, until none is left (`hold`). Where tightened limits leave no plan, since b is wide at some other
//! place than the torque, the plan is slowed down instead. What holds nowhere, however slow, is infeasible.

mod course;
mod demand;
mod factor;
mod hold;
mod moves;
mod tightened;
mod width;

pub(crate) use course::{Course, JointState};
pub(crate) use demand::{Bands, Demand, Tightest};
pub(crate) use factor::Factor;
pub(crate) use hold::{Held, Planner, Short, Tightening, hold};
pub use moves::{check_trajectory, plan_move};
pub(crate) use tightened::{overrides, tightened_torque};

pub use crate::path::confident::plan_path;
use crate::plan::Failure;
use crate::robot::Robot;

/// The probability with which torque limits shall hold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Confidence {
    /// Above 0.5 and below 1.
    pub level: f64,
    /// Of what.
    pub over: Over,
}

/// What a confidence is the probability of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Over {
    /// Any one joint at any one moment is within its limit.
    Sample,
    /// All joints are within their limits throughout the motion.
    Move,
}

/// An answer for which a confidence was asked.
#[derive(Debug, Clone, PartialEq)]
pub struct Confident<O> {
    /// The answer; its torque margins are against the whole limits, bands not counted.
    pub outcome: O,
    /// What the confidence cost; `None` where the motion is infeasible.
    pub report: Option<ConfidenceReport>,
    /// Where a motion is infeasible for the confidence alone: the part of the torque needed that is the band.
    pub band: Option<f64>,
}

impl<O> Confident<O> {
    /// An answer as it is, where no confidence was asked for.
    pub fn without(outcome: O) -> Self {
        Self {
            outcome,
            report: None,
            band: None,
        }
    }
}

/// What a confidence cost.
#[derive(Debug, Clone, PartialEq)]
pub struct ConfidenceReport {
    /// As asked.
    pub confidence: Confidence,
    /// Every limit holds with its band.
    pub holds: bool,
    /// What the motion would take without the confidence, s; `None` for a trajectory made elsewhere.
    pub nominal_duration: Option<f64>,
    /// One a joint whose peak torque is known, in model order.
    pub joints: Vec<JointConfidence>,
}

/// The tightest moment of one joint's torque with its band.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointConfidence {
    /// Index of the joint.
    pub joint: usize,
    /// Limit in force, N m or N.
    pub limit: f64,
    /// The torque there, signed.
    pub torque: f64,
    /// Half-width of its band.
    pub band: f64,
    /// (limit − |torque| − band) / limit.
    pub margin: f64,
    /// When, s.
    pub time: f64,
    /// Standard deviation there of what the parameters leave open.
    pub parameter_deviation: f64,
    /// Standard deviation of what the model leaves over.
    pub residual_deviation: f64,
    /// By how much the limit was tightened to plan.
    pub set_aside: f64,
}

impl ConfidenceReport {
    pub(crate) fn new(
        confidence: Confidence,
        demand: &Demand,
        set_aside: &[f64],
        nominal_duration: Option<f64>,
        residuals: &[crate::robot::spec::Residual],
    ) -> Self {
        let joints: Vec<JointConfidence> = demand
            .tightest
            .iter()
            .enumerate()
            .filter_map(|(joint, tightest)| {
                let tightest = (*tightest)?;
                Some(JointConfidence {
                    joint,
                    limit: tightest.limit,
                    torque: tightest.torque,
                    band: tightest.band,
                    margin: tightest.margin(),
                    time: tightest.time,
                    parameter_deviation: tightest.deviation,
                    residual_deviation: residuals[joint].deviation,
                    set_aside: set_aside[joint],
                })
            })
            .collect();
        Self {
            confidence,
            holds: joints
                .iter()
                .all(|joint| joint.margin >= -crate::tolerance::CHECK_EXCESS),
            nominal_duration,
            joints,
        }
    }
}

impl Confidence {
    /// Checks a confidence against its robot.
    pub(crate) fn check(self, robot: &Robot) -> Result<(), Failure> {
        if !(self.level > 0.5 && self.level < 1.0) {
            let message = format!("{} must be above 0.5 and below 1", self.level);
            return Err(Failure::invalid("confidence.level", message));
        }
        if robot.factor().is_none() {
            let message = "the model does not say how well its parameters are known: fit the drives to recorded motion, and \
                           register the model with the uncertainty that the fit gives";
            return Err(Failure::invalid("confidence", message.to_owned()));
        }
        Ok(())
    }
}

/// What a refusal says where it is for the confidence alone.
pub(crate) fn suggestion(confidence: Confidence, name: &str, tightest: &Tightest) -> String {
    let needed = tightest.torque.abs() + tightest.band;
    format!(
        "however slow, joint \"{name}\" needs {:.4} and a band of {:.4} for {} %: allow it at least {needed:.4}, or ask a lower \
         level, or carry less, or fit the drives to more motion",
        tightest.torque.abs(),
        tightest.band,
        100.0 * confidence.level,
    )
}

#[cfg(test)]
pub(crate) mod tests;
