//! What a plan says of itself, against what the recheck found.
//!
//! The recheck samples, so it finds a peak torque or power a little too low, by at most about
//! [`crate::report::JointReport::torque_resolution`]; and it integrates the squared torque by trapezoids.

use takt_motion::plan::outcome::{MovePlan, TorqueMargin};
use takt_motion::robot::spec::RobotSpec;

use crate::bounds::Bounds;
use crate::report::Report;

/// A figure of a plan that differs from what was found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FalseClaim {
    /// Which figure.
    pub figure: Figure,
    /// Index of the joint; 0 for the duration.
    pub joint: usize,
    /// As the plan has it.
    pub claimed: f64,
    /// As it was found.
    pub found: f64,
    /// |claimed − found| over the scale of such figures: the limit for torques, the found value for the others.
    pub mismatch: f64,
}

/// A figure that a plan states.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Figure {
    /// Of the move, s.
    Duration,
    /// Torque limit in force, N m or N.
    TorqueLimit,
    /// Magnitude of the peak torque, N m or N.
    PeakTorque,
    /// (limit − |peak|)/limit.
    Margin,
    /// RMS torque over the cycle, N m or N.
    RmsTorque,
    /// rad/s.
    PeakMotorSpeed,
    /// Largest magnitude of torque × velocity at the joint, W.
    PeakPower,
    /// That there is a margin at all: 1 for a joint with a torque limit, else 0.
    Presence,
}

/// Lists the figures of `plan` that differ by more than `tolerance` from `report`, which must be of its patterns.
#[must_use]
pub fn false_claims(
    spec: &RobotSpec,
    bounds: &[Bounds],
    plan: &MovePlan,
    report: &Report,
    tolerance: f64,
) -> Vec<FalseClaim> {
    let mut all = Vec::new();
    let mut compare = |figure, joint, claimed: f64, found: f64, scale: f64| {
        let difference = (claimed - found).abs();
        let mismatch = if difference == 0.0 {
            0.0
        } else {
            difference / scale.abs()
        };
        if mismatch.is_nan() || mismatch > tolerance {
            all.push(FalseClaim {
                figure,
                joint,
                claimed,
                found,
                mismatch,
            });
        }
    };
    compare(Figure::Duration, 0, plan.duration, report.duration, report.duration);
    for (joint, (bounds, found)) in bounds.iter().zip(&report.joints).enumerate() {
        let of_joint = |margin: &&TorqueMargin| margin.joint == joint;
        let count = plan.torque_margins.iter().filter(of_joint).count();
        let expected = f64::from(u8::from(bounds.torque.is_some()));
        compare(Figure::Presence, joint, count as f64, expected, 1.0);
        let (Some(margin), Some(limit)) = (plan.torque_margins.iter().find(of_joint), bounds.torque) else {
            continue;
        };
        let peak = found.torque.value.abs().max(found.holding.value.abs());
        let rms = report.rms_torque(joint, plan.cycle_time);
        let speed = found.velocity.value.abs() * spec.joints[joint].drive.gear_ratio.abs();
        let power = found.power.value.abs();
        compare(Figure::TorqueLimit, joint, margin.limit, limit, limit);
        compare(Figure::PeakTorque, joint, margin.peak_torque.abs(), peak, limit);
        compare(Figure::Margin, joint, margin.margin, (limit - peak) / limit, 1.0);
        compare(Figure::RmsTorque, joint, margin.rms_torque, rms, limit);
        compare(Figure::PeakMotorSpeed, joint, margin.peak_motor_speed, speed, speed);
        compare(Figure::PeakPower, joint, margin.peak_power.abs(), power, power);
    }
    all
}
