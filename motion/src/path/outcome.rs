//! The answers to a program: a timed path with its proof, or the evidence why there is none. Passive data.

use crate::plan::outcome::{OverrideSafety, Setpoints, TorqueMargin};
use crate::robot::spec::Inertial;

/// The answer to a program.
#[derive(Debug, Clone, PartialEq)]
pub enum PathOutcome {
    /// It can be done.
    Plan(Box<PathPlan>),
    /// It cannot.
    Infeasible(PathInfeasible),
}

/// Where on a program something is.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Location {
    /// Which segment, from 0; within a blend, the one before it up to its middle.
    pub segment: usize,
    /// Part of the segment, 0 to 1.
    pub fraction: f64,
}

/// A verified, timed path.
#[derive(Debug, Clone, PartialEq)]
pub struct PathPlan {
    /// s, dwell times included.
    pub duration: f64,
    /// Derivatives in the path parameter that are continuous everywhere: 3, or 2 where a cubic spline was asked for.
    pub continuity: u32,
    /// When each segment begins and ends.
    pub segments: Vec<SegmentReport>,
    /// What became of each blend that was asked for.
    pub blends: Vec<BlendReport>,
    /// The tightest moment of every joint's torque.
    pub torque_margins: Vec<TorqueMargin>,
    /// The tightest moment of every known limit, tightest first.
    pub limit_uses: Vec<PathLimitUse>,
    /// Which limit holds the path when, in time order and without gaps.
    pub limiting: Vec<LimitingStretch>,
    /// Time spent at each kind of limit, longest first.
    pub limit_costs: Vec<LimitCost>,
    /// What became of the constant speed; `None` under optimal timing.
    pub constant_speed: Option<ConstantSpeedReport>,
    /// Whether torque limits hold at every slower override.
    pub override_safe: Option<OverrideSafety>,
    /// Samples, with their places.
    pub setpoints: Option<PathSetpoints>,
    /// What motors can follow exactly.
    pub smoothness: Smoothness,
    /// What the caller should know.
    pub warnings: Vec<String>,
    /// Echo: part of each peak torque that may be used.
    pub torque_utilization: f64,
    /// Echo: part of each speed that may be used.
    pub speed_scale: f64,
    /// Echo: what the arm carries.
    pub payload: Inertial,
}

/// When a segment is run through.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SegmentReport {
    /// s; within a blend, at its middle.
    pub begin: f64,
    /// s; before the dwell.
    pub end: f64,
    /// Length of the segment as taught, m: blends at its ends cut it short.
    pub tool_length: f64,
}

/// What became of a blend.
#[derive(Debug, Clone, PartialEq)]
pub struct BlendReport {
    /// After which segment.
    pub segment: usize,
    /// Where it begins.
    pub begin: Location,
    /// Where it ends.
    pub end: Location,
    /// Its times, s.
    pub begin_time: f64,
    /// s.
    pub end_time: f64,
    /// Largest distance of the tool's path from the corner's two segments, m.
    pub deviation: f64,
    /// Distance of the blended path from the corner point, m.
    pub corner_distance: f64,
    /// Why it is shorter than asked for.
    pub shrunk: Option<String>,
}

/// What a limit bounds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum PathLimit {
    /// A joint's torque.
    Torque,
    /// A joint's speed.
    Velocity,
    /// A joint's acceleration.
    Acceleration,
    /// A joint's jerk.
    Jerk,
    /// A joint's lowest position.
    PositionLower,
    /// A joint's highest position.
    PositionUpper,
    /// The tool's speed.
    ToolVelocity,
    /// The tool's acceleration.
    ToolAcceleration,
    /// The constant speed asked for.
    ConstantSpeed,
    /// Nothing: at rest, dwelling.
    Rest,
}

impl PathLimit {
    /// In words.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Torque => "torque",
            Self::Velocity => "speed",
            Self::Acceleration => "acceleration",
            Self::Jerk => "jerk",
            Self::PositionLower | Self::PositionUpper => "position",
            Self::ToolVelocity => "tool speed",
            Self::ToolAcceleration => "tool acceleration",
            Self::ConstantSpeed => "constant speed",
            Self::Rest => "rest",
        }
    }
}

/// The tightest moment of one limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathLimitUse {
    /// Which limit.
    pub kind: PathLimit,
    /// Of which joint; `None`: the tool's.
    pub joint: Option<usize>,
    /// The value that comes closest, signed.
    pub value: f64,
    /// The limit in force there.
    pub limit: f64,
    /// (limit − |value|) / limit.
    pub margin: f64,
    /// s.
    pub time: f64,
    /// Where.
    pub location: Location,
}

/// A stretch of time at one limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LimitingStretch {
    /// s.
    pub begin: f64,
    /// s.
    pub end: f64,
    /// Which limit is the tightest.
    pub kind: PathLimit,
    /// Of which joint; `None`: the tool's.
    pub joint: Option<usize>,
    /// Where the stretch begins.
    pub location: Location,
}

/// Time spent at one kind of limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LimitCost {
    /// Which limit.
    pub kind: PathLimit,
    /// Of which joint; `None`: the tool's.
    pub joint: Option<usize>,
    /// s.
    pub time: f64,
}

/// What became of a constant speed.
#[derive(Debug, Clone, PartialEq)]
pub struct ConstantSpeedReport {
    /// Asked for, m/s.
    pub asked: f64,
    /// Kept, m/s.
    pub speed: f64,
    /// Why it is lower.
    pub lowered: Option<String>,
    /// Lowest tool speed between the first and the last transition, m/s.
    pub lowest: f64,
    /// Each transition.
    pub transitions: Vec<TransitionReport>,
}

/// One transition at constant speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TransitionReport {
    /// After which segment; `None`: at the start.
    pub segment: Option<usize>,
    /// s.
    pub begin_time: f64,
    /// s.
    pub end_time: f64,
    /// Largest distance of the tool from the taught path, or of the taught point from the tool's way where that is
    /// larger, m.
    pub deviation: f64,
    /// Largest jump of the velocity at its ends, m/s; 0 in the smooth form.
    pub velocity_jump: f64,
    /// Largest jump of the acceleration at its ends, m/s².
    pub acceleration_jump: f64,
    /// Lowest tool speed within it, m/s.
    pub lowest_speed: f64,
}

/// Samples of a path.
#[derive(Debug, Clone, PartialEq)]
pub struct PathSetpoints {
    /// Times and joint columns.
    pub samples: Setpoints,
    /// One a sample.
    pub locations: Vec<Location>,
    /// Tool speed, m/s, one a sample.
    pub tool_speed: Vec<f64>,
    /// Third derivative of the joints' positions, sample by sample, one a joint.
    pub jerk: Vec<f64>,
}

/// How smooth a path is in time.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Smoothness {
    /// How many derivatives in time are continuous everywhere.
    pub continuity: u32,
    /// The third one is continuous but at the stops.
    pub jerk_is_continuous: bool,
    /// Where strokes begin and end, s.
    pub stops: Vec<f64>,
}

/// A program that cannot be run, with the evidence.
#[derive(Debug, Clone, PartialEq)]
pub struct PathInfeasible {
    /// Why.
    pub reason: PathInfeasibleReason,
    /// Where.
    pub location: Location,
    /// Which joint, where one is to blame.
    pub joint: Option<usize>,
    /// What would be needed there (torque, position, distance…), in the reason's unit.
    pub needed: f64,
    /// What there is.
    pub available: f64,
    /// Gravity's part of a torque that is needed.
    pub gravity_torque: f64,
    /// The largest payload with which gravity and friction would be within the limit there, kg; `None` where no mass would do, or
    /// where it is not the payload's fault.
    pub feasible_payload: Option<f64>,
    /// The part of the segment that can be reached, from its start.
    pub reachable_fraction: Option<f64>,
    /// A sentence: what would make it feasible.
    pub suggestion: String,
}

/// Why a program cannot be run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PathInfeasibleReason {
    /// A pose is out of reach. m or rad of the pose that is missing.
    OutOfReach,
    /// A pose is at a singularity that the path cannot pass in this branch.
    Singularity,
    /// A joint would leave its range. rad or m.
    JointRange,
    /// The pose cannot be held. N m or N.
    HoldingTorque,
    /// Gravity and friction alone exceed the limit on the way. N m or N.
    MovingTorque,
    /// No timing keeps every limit from the speed at the start, or to that at the end. m/s.
    BoundarySpeed,
    /// The arm cannot follow at the constant speed asked for. The unit of the limit.
    ConstantSpeed,
    /// No timing keeps every limit.
    NoTiming,
}
