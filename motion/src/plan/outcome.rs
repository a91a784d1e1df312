//! The answers: a plan with its proof, a refusal with its evidence, the report on a trajectory. Passive data.

use super::request::{Interpolation, Method};
use crate::robot::spec::Inertial;

/// The answer to a move.
#[derive(Debug, Clone, PartialEq)]
pub enum MoveOutcome {
    /// It can be done.
    Plan(Box<MovePlan>),
    /// It cannot.
    Infeasible(Infeasible),
}

/// A verified move.
#[derive(Debug, Clone, PartialEq)]
pub struct MovePlan {
    /// s.
    pub duration: f64,
    /// What the conventional preset pattern would have taken, unchecked, s; `None` where a joint that moves has no preset
    /// acceleration.
    pub preset_duration: Option<f64>,
    /// The preset accelerations were derived from the torque limits.
    pub preset_derived: bool,
    /// How it was planned.
    pub method: Method,
    /// Which of the patent's fallbacks made it.
    pub fallback: Fallback,
    /// One a joint, in model order.
    pub patterns: Vec<Pattern>,
    /// One a joint whose peak torque is known, in model order.
    pub torque_margins: Vec<TorqueMargin>,
    /// What keeps the move from being faster; `None` where nothing moves.
    pub limiting: Option<Limiting>,
    /// By how much the raw plan broke a limit, relative to the limit; 0 where it kept all.
    pub raw_excess: f64,
    /// Duration of the raw plan, s.
    pub raw_duration: f64,
    /// What slower overrides do; `None` where no peak torque is known.
    pub override_safe: Option<OverrideSafety>,
    /// Where asked for.
    pub setpoints: Option<Setpoints>,
    /// Sentences, lower case.
    pub warnings: Vec<String>,
    /// As used.
    pub torque_utilization: f64,
    /// As used.
    pub speed_scale: f64,
    /// As used, s.
    pub cycle_time: f64,
    /// As used.
    pub payload: Inertial,
}

/// Which of the patent's fallbacks made a plan.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fallback {
    /// None was needed.
    None,
    /// All ends synchronized again after the failing joints' own patterns.
    Resynchronized,
    /// The slowest failing joint set the common time.
    Rebased,
}

/// The velocity pattern of one joint: a trapezoid, or a triangle where the cruise time is 0.
/// Quantities carry the sign of the displacement; times do not.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Pattern {
    /// Target minus start.
    pub displacement: f64,
    /// Velocity of the cruise, or at the tip of the triangle.
    pub peak_velocity: f64,
    /// Acceleration of the first part.
    pub acceleration: f64,
    /// Deceleration of the last part.
    pub deceleration: f64,
    /// s.
    pub acceleration_time: f64,
    /// s.
    pub cruise_time: f64,
    /// s.
    pub deceleration_time: f64,
}

/// Part of a move.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    /// Speeding up.
    Acceleration,
    /// Constant speed.
    Cruise,
    /// Slowing down.
    Deceleration,
    /// At rest.
    Hold,
}

/// The tightest moment of one joint's torque.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TorqueMargin {
    /// Index of the joint.
    pub joint: usize,
    /// Limit in force.
    pub limit: f64,
    /// The torque of largest magnitude, signed.
    pub peak_torque: f64,
    /// When, s.
    pub time: f64,
    /// In which part of this joint's pattern.
    pub phase: Phase,
    /// (limit − |peak|) / limit.
    pub margin: f64,
    /// Over the cycle.
    pub rms_torque: f64,
    /// Of the drive.
    pub rated_torque: Option<f64>,
    /// rad/s.
    pub peak_motor_speed: f64,
    /// W.
    pub peak_power: f64,
}

/// What keeps a move from being faster.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limiting {
    /// Kind of limit.
    pub kind: LimitingKind,
    /// Index of the joint.
    pub joint: usize,
    /// When, s.
    pub time: f64,
    /// In which part of the move.
    pub phase: Phase,
    /// Value over limit there.
    pub utilization: f64,
}

/// Kind of limit that keeps a move from being faster.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LimitingKind {
    /// A torque limit.
    Torque,
    /// A speed limit.
    Velocity,
    /// An acceleration limit.
    Acceleration,
    /// A deceleration limit.
    Deceleration,
    /// The conventional pattern's fixed accelerations.
    PresetAcceleration,
}

/// Whether a plan keeps its torque limits at every slower speed override.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OverrideSafety {
    /// It does.
    pub safe: bool,
    /// The override at which the torque is tightest, 0 (held still) to 1.
    pub worst_override: f64,
    /// Index of the joint.
    pub joint: usize,
    /// Torque there, signed.
    pub torque: f64,
    /// Limit in force.
    pub limit: f64,
    /// When in the plan at full speed, s.
    pub time: f64,
}

/// Samples of a plan, one column a joint.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Setpoints {
    /// s.
    pub time: Vec<f64>,
    /// In model order.
    pub joints: Vec<JointColumns>,
}

/// The samples of one joint.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct JointColumns {
    /// "rad or m".
    pub position: Vec<f64>,
    /// First derivative.
    pub velocity: Vec<f64>,
    /// Second derivative.
    pub acceleration: Vec<f64>,
    /// Drive torque at the joint.
    pub torque: Vec<f64>,
}

/// A motion that cannot be, with the evidence.
#[derive(Debug, Clone, PartialEq)]
pub struct Infeasible {
    /// What stands against it.
    pub reason: InfeasibleReason,
    /// Index of the joint.
    pub joint: usize,
    /// When in the plan that was tried, s.
    pub time: f64,
    /// Part of the way from start to target, 0 to 1.
    pub location: f64,
    /// Torque that would be needed, signed.
    pub needed: f64,
    /// Limit in force.
    pub available: f64,
    /// Gravity's part of what is needed.
    pub gravity_torque: f64,
    /// What would make it feasible.
    pub suggestion: String,
    /// The largest payload mass that this pose could take, kg.
    pub feasible_payload: Option<f64>,
}

/// What stands against a motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum InfeasibleReason {
    /// The pose cannot be held at rest.
    HoldingTorque,
    /// Gravity and friction alone exceed the limit on the way.
    MovingTorque,
    /// No speed keeps every limit at once.
    NoFeasibleSpeed,
    /// The patent's method finds no acceleration at an end pose.
    NoFeasibleAcceleration,
}

/// The report on a trajectory made elsewhere.
#[derive(Debug, Clone, PartialEq)]
pub struct CheckReport {
    /// Every limit that is known holds.
    pub holds: bool,
    /// s.
    pub duration: f64,
    /// One a joint whose peak torque is known, in model order.
    pub torque_margins: Vec<TorqueMargin>,
    /// The tightest moment of every known limit, tightest first.
    pub limit_uses: Vec<LimitUse>,
    /// What slower overrides do; `None` where no peak torque is known.
    pub override_safe: Option<OverrideSafety>,
    /// Sentences, lower case.
    pub warnings: Vec<String>,
    /// As used.
    pub interpolation: Interpolation,
}

/// The tightest moment of one limit of one joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LimitUse {
    /// Which limit.
    pub kind: LimitKind,
    /// Index of the joint.
    pub joint: usize,
    /// The value that comes closest to the limit, or exceeds it most.
    pub value: f64,
    /// The limit.
    pub limit: f64,
    /// When, s.
    pub time: f64,
    /// By how much the limit is broken, relative to it; 0 where it holds.
    pub excess: f64,
}

/// Kind of limit that a trajectory is checked against.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LimitKind {
    /// Drive torque.
    Torque,
    /// Speed.
    Velocity,
    /// Acceleration.
    Acceleration,
    /// Deceleration.
    Deceleration,
    /// Lower end of the position range.
    PositionLower,
    /// Upper end of the position range.
    PositionUpper,
    /// Jerk.
    Jerk,
}
