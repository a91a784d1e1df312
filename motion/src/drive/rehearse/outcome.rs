//! What a rehearsal found. Passive data; positions are seen from the joint, torques are those at the joint.

use crate::drive::controller::{Adaptation, JointGains};
use crate::drive::feedforward::Smoothness;
use crate::path::outcome::PathInfeasible;
use crate::plan::outcome::Infeasible;

/// The answer to a rehearsal.
#[derive(Debug, Clone, PartialEq)]
pub enum RehearsalOutcome {
    /// It was run.
    Run(Box<Rehearsal>),
    /// The move cannot be planned.
    MoveInfeasible(Box<Infeasible>),
    /// The program cannot be planned.
    PathInfeasible(Box<PathInfeasible>),
    /// The plan asks for a torque that the transmission's polynomial does not reach.
    TransmissionRange(TransmissionRange),
}

/// A torque beyond what the stiffness polynomial describes: past its first maximum it would fall with more deformation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TransmissionRange {
    /// Index of the joint.
    pub joint: usize,
    /// When, s.
    pub time: f64,
    /// Torque that would have to pass.
    pub torque: f64,
    /// Largest torque up to which the polynomial rises.
    pub largest: f64,
}

/// A motion that was run twice: with the model's friction, and with friction adapted while it ran.
#[derive(Debug, Clone, PartialEq)]
pub struct Rehearsal {
    /// Time between two steps, s.
    pub period: f64,
    /// Duration of the motion, without settling, s.
    pub duration: f64,
    /// Steps that were asked for, settling included.
    pub steps: usize,
    /// How smooth the plan is, and where the motor's acceleration is exact.
    pub smoothness: Smoothness,
    /// Whether each joint's transmission flexes.
    pub flexible: Vec<bool>,
    /// The gains as used.
    pub gains: Vec<JointGains>,
    /// The adaptation as used.
    pub adaptation: Adaptation,
    /// Largest motor torque that the plan and the model ask for, one a joint.
    pub planned_torque: Vec<f64>,
    /// Without adaptation.
    pub plain: Run,
    /// With adaptation.
    pub adapted: Run,
    /// What the caller should know.
    pub warnings: Vec<String>,
}

/// One run.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// How it ended.
    pub end: RunEnd,
    /// Steps that were run.
    pub steps: usize,
    /// One a joint.
    pub joints: Vec<JointRun>,
    /// Largest distance of the tool centre point from where the plan has it, m.
    pub tool_error_peak: f64,
    /// When, s.
    pub tool_error_time: f64,
    /// Root of the mean square of that distance, m.
    pub tool_error_rms: f64,
    /// Largest angle between the tool and its planned orientation, rad.
    pub tool_angle_peak: f64,
    /// Work of the motors, J: what they gave less what they took.
    pub work: f64,
    /// What the motors gave, J, without what they took while braking.
    pub energy_given: f64,
    /// Steps of the integrator.
    pub integrator_steps: u64,
    /// Where asked for.
    pub trace: Option<Trace>,
}

/// How a run ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RunEnd {
    /// As planned.
    Completed,
    /// A joint left its planned motion farther than anything that is worth simulating; its index and the time, s.
    Diverged {
        /// Index of the joint.
        joint: usize,
        /// s.
        time: f64,
    },
    /// A transmission was deformed beyond the range of its polynomial.
    TransmissionRange(TransmissionRange),
    /// The integrator could not go on with the steps that it may make: the transmission is all but rigid, or the friction.
    TooStiff {
        /// s.
        time: f64,
    },
}

/// What one joint did in one run.
#[derive(Debug, Clone, PartialEq)]
pub struct JointRun {
    /// Largest |q − planned q|.
    pub error_peak: f64,
    /// When, s.
    pub error_time: f64,
    /// Root mean square of q − planned q.
    pub error_rms: f64,
    /// q − planned q at the end.
    pub error_end: f64,
    /// Largest motor torque that the controller asked for, before limits, signed.
    pub torque_peak: f64,
    /// When, s.
    pub torque_time: f64,
    /// Root mean square of the torque that the motor gave.
    pub torque_rms: f64,
    /// The limit in force; `None`: none known.
    pub torque_limit: Option<f64>,
    /// True margin: (limit − |torque asked for|) / limit; below 0 where the limit cut it off.
    pub margin: Option<f64>,
    /// Time that the limit was in force, s.
    pub limited_time: f64,
    /// Largest motor current, A, signed; `None`: torque constant not known.
    pub current_peak: Option<f64>,
    /// Root mean square of the motor current, A.
    pub current_rms: Option<f64>,
    /// Largest deformation of the transmission, signed.
    pub deformation_peak: f64,
    /// How the friction was followed.
    pub friction: FrictionFollowed,
}

/// What the controller took for friction against what friction was, both sides of the transmission together.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FrictionFollowed {
    /// Root mean square of the true friction.
    pub truth_rms: f64,
    /// Root mean square of assumed less true friction over the whole run.
    pub error_rms: f64,
    /// The same over the last quarter.
    pub error_rms_last: f64,
    /// A few moments, evenly spaced.
    pub points: Vec<FrictionPoint>,
}

/// Friction at one moment.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FrictionPoint {
    /// s.
    pub time: f64,
    /// What the controller took it for.
    pub assumed: f64,
    /// What it was.
    pub truth: f64,
}

/// A run for plotting.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Trace {
    /// s.
    pub time: Vec<f64>,
    /// In model order.
    pub joints: Vec<TraceColumns>,
    /// Distance of the tool from where the plan has it, m.
    pub tool_error: Vec<f64>,
}

/// The trace of one joint; every column has as many values as there are times.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TraceColumns {
    /// As planned.
    pub planned_position: Vec<f64>,
    /// Of the output.
    pub position: Vec<f64>,
    /// Of the motor.
    pub motor_position: Vec<f64>,
    /// Of the output.
    pub velocity: Vec<f64>,
    /// That the motor gave.
    pub motor_torque: Vec<f64>,
    /// Through the transmission.
    pub transmission_torque: Vec<f64>,
    /// What the controller took friction for.
    pub assumed_friction: Vec<f64>,
    /// What it was.
    pub true_friction: Vec<f64>,
}
