//! What is added up over a run, and what it comes to.

use super::outcome::{FrictionFollowed, FrictionPoint, JointRun, Run, RunEnd, Trace, TraceColumns};
use super::request::RehearsalRequest;
use crate::drive::controller::{Command, Controller};
use crate::drive::feedforward::FeedForward;

/// Moments at which it is said how friction was followed.
const FRICTION_POINTS: usize = 11;

/// What is added up over a run.
pub(super) struct Sums {
    pub(super) joints: Vec<JointSums>,
    friction: Vec<FrictionFollowed>,
    /// Steps at which friction is stated.
    friction_stride: usize,
    /// From which step on the last quarter is.
    last_quarter: usize,
    pub(super) seen: usize,
    tool_peak: (f64, f64),
    tool_squared: f64,
    tool_angle: f64,
    pub(super) work: f64,
    pub(super) given: f64,
    pub(super) trace: Option<Trace>,
}

#[derive(Default)]
pub(super) struct JointSums {
    error_peak: (f64, f64),
    error_squared: f64,
    error_end: f64,
    demanded_peak: (f64, f64),
    torque_squared: f64,
    current_squared: f64,
    current_peak: Option<f64>,
    acted: f64,
    limited: f64,
    limit: f64,
    deformation: f64,
}

impl JointSums {
    pub(super) fn seen(&mut self, time: f64, error: f64, deformation: f64, command: &Command) {
        self.error_squared += error * error;
        self.error_end = error;
        if error.abs() > self.error_peak.0 {
            self.error_peak = (error.abs(), time);
        }
        if command.demanded.abs() > self.demanded_peak.0.abs() {
            self.demanded_peak = (command.demanded, time);
        }
        if deformation.abs() > self.deformation.abs() {
            self.deformation = deformation;
        }
    }

    pub(super) fn acted(&mut self, command: &Command, period: f64) {
        self.acted += period;
        self.torque_squared += command.torque * command.torque * period;
        if let Some(current) = command.current {
            self.current_squared += current * current * period;
            let before = self.current_peak.unwrap_or(0.0);
            self.current_peak = Some(if current.abs() > before.abs() { current } else { before });
        }
        if command.demanded.abs() > self.limit {
            self.limited += period;
        }
    }
}

impl Sums {
    pub(super) fn new(
        count: usize,
        controller: &Controller,
        request: &RehearsalRequest,
        planned: &FeedForward,
    ) -> Self {
        let joints = controller.joints().iter().map(|joint| JointSums {
            limit: joint.limit(),
            ..JointSums::default()
        });
        let steps = planned.smoothness.steps;
        Self {
            joints: joints.collect(),
            friction: vec![FrictionFollowed::default(); count],
            friction_stride: (steps - 1).div_ceil(FRICTION_POINTS - 1).max(1),
            last_quarter: steps - steps.div_ceil(4),
            seen: 0,
            tool_peak: (0.0, 0.0),
            tool_squared: 0.0,
            tool_angle: 0.0,
            work: 0.0,
            given: 0.0,
            trace: request.trace_every.map(|_| Trace {
                joints: vec![TraceColumns::default(); count],
                ..Trace::default()
            }),
        }
    }

    pub(super) fn tool(&mut self, time: f64, distance: f64, angle: f64) {
        self.tool_squared += distance * distance;
        self.tool_angle = self.tool_angle.max(angle);
        if distance > self.tool_peak.0 {
            self.tool_peak = (distance, time);
        }
    }

    pub(super) fn friction(&mut self, step: usize, joint: usize, time: f64, assumed: f64, truth: f64) {
        let followed = &mut self.friction[joint];
        let error = (assumed - truth) * (assumed - truth);
        followed.truth_rms += truth * truth;
        followed.error_rms += error;
        if step >= self.last_quarter {
            followed.error_rms_last += error;
        }
        if step.is_multiple_of(self.friction_stride) {
            followed.points.push(FrictionPoint { time, assumed, truth });
        }
    }

    pub(super) fn into_run(self, end: RunEnd, integrator_steps: u64) -> Run {
        let count = self.seen.max(1) as f64;
        let last = self.seen.saturating_sub(self.last_quarter).max(1) as f64;
        let joints = self.joints.into_iter().zip(self.friction).map(|(sums, mut friction)| {
            friction.truth_rms = (friction.truth_rms / count).sqrt();
            friction.error_rms = (friction.error_rms / count).sqrt();
            friction.error_rms_last = (friction.error_rms_last / last).sqrt();
            let acted = sums.acted.max(f64::MIN_POSITIVE);
            let known = sums.limit.is_finite().then_some(sums.limit);
            JointRun {
                error_peak: sums.error_peak.0,
                error_time: sums.error_peak.1,
                error_rms: (sums.error_squared / count).sqrt(),
                error_end: sums.error_end,
                torque_peak: sums.demanded_peak.0,
                torque_time: sums.demanded_peak.1,
                torque_rms: (sums.torque_squared / acted).sqrt(),
                torque_limit: known,
                margin: known.map(|limit| (limit - sums.demanded_peak.0.abs()) / limit),
                limited_time: sums.limited,
                current_peak: sums.current_peak,
                current_rms: sums.current_peak.map(|_| (sums.current_squared / acted).sqrt()),
                deformation_peak: sums.deformation,
                friction,
            }
        });
        Run {
            end,
            steps: self.seen,
            joints: joints.collect(),
            tool_error_peak: self.tool_peak.0,
            tool_error_time: self.tool_peak.1,
            tool_error_rms: (self.tool_squared / count).sqrt(),
            tool_angle_peak: self.tool_angle,
            work: self.work,
            energy_given: self.given,
            integrator_steps,
            trace: self.trace,
        }
    }
}
