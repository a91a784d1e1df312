//! What is asked for: a move, or the check of a trajectory made elsewhere. Passive data; the planner checks it.

use crate::robot::spec::Inertial;

/// A point-to-point move.
#[derive(Debug, Clone, PartialEq)]
pub struct MoveRequest {
    /// Joint positions to start from, at rest, "rad or m" in model order.
    pub start: Vec<f64>,
    /// Joint positions to end at, at rest.
    pub target: Vec<f64>,
    /// Speed asked for, per joint; `None`: the speed limits.
    pub target_velocity: Option<Vec<f64>>,
    /// Payload in the tip link's frame; `None`: the model's.
    pub payload: Option<Inertial>,
    /// Limits tightened for this move.
    pub limits: Vec<LimitOverride>,
    /// Part of each peak torque that may be used, in (0, 1].
    pub torque_utilization: f64,
    /// Part of each speed that may be used, in (0, 1].
    pub speed_scale: f64,
    /// How to plan.
    pub method: Method,
    /// Which samples to return.
    pub sampling: Sampling,
    /// Time from one start of this move to the next, s; `None`: the duration.
    pub cycle_time: Option<f64>,
}

impl MoveRequest {
    /// A move with all that the arm has, without samples.
    #[must_use]
    pub fn new(start: Vec<f64>, target: Vec<f64>) -> Self {
        Self {
            start,
            target,
            target_velocity: None,
            payload: None,
            limits: Vec::new(),
            torque_utilization: 1.0,
            speed_scale: 1.0,
            method: Method::Verified,
            sampling: Sampling::None,
            cycle_time: None,
        }
    }
}

/// How a move is planned.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// The conventional synchronized pattern.
    Preset,
    /// The patent's method.
    Endpoint,
    /// One time law along the straight joint path that keeps every limit everywhere.
    Verified,
}

/// Which samples of a plan to return.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Sampling {
    /// None.
    None,
    /// One each period, s; the duration becomes a whole number of periods.
    Period(f64),
    /// This many, evenly spaced over the plan as it is, and both sides of each switching time.
    Trace(usize),
}

/// Limits of one joint that a request tightens.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LimitOverride {
    /// Name of the joint.
    pub joint: String,
    /// Lowest position.
    pub position_lower: Option<f64>,
    /// Highest position.
    pub position_upper: Option<f64>,
    /// Largest speed.
    pub velocity: Option<f64>,
    /// Largest acceleration.
    pub acceleration: Option<f64>,
    /// Largest deceleration.
    pub deceleration: Option<f64>,
    /// Largest jerk. Moves have trapezoidal patterns, to which it does not apply.
    pub jerk: Option<f64>,
    /// Takes the place of the model's peak torque times the utilization.
    pub peak_torque: Option<f64>,
}

/// A trajectory that somebody else made, to be checked.
#[derive(Debug, Clone, PartialEq)]
pub struct CheckRequest {
    /// Points in time order.
    pub points: Vec<TrajectoryPoint>,
    /// How to read what is between the points; `None`: quintic where accelerations are given, cubic where velocities
    /// are.
    pub interpolation: Option<Interpolation>,
    /// Payload in the tip link's frame; `None`: the model's.
    pub payload: Option<Inertial>,
    /// Limits tightened for this check.
    pub limits: Vec<LimitOverride>,
    /// Part of each peak torque that may be used, in (0, 1].
    pub torque_utilization: f64,
    /// Time from one start of this trajectory to the next, s; `None`: its duration.
    pub cycle_time: Option<f64>,
}

/// One point of a trajectory; `velocity` and `acceleration` may be empty.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TrajectoryPoint {
    /// s, strictly increasing from point to point.
    pub time: f64,
    /// "rad or m", in model order.
    pub position: Vec<f64>,
    /// First derivative, in model order or empty.
    pub velocity: Vec<f64>,
    /// Second derivative, in model order or empty.
    pub acceleration: Vec<f64>,
}

/// What runs between two points of a trajectory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Interpolation {
    /// Straight lines: position only.
    Linear,
    /// Cubic polynomials through positions and velocities.
    Cubic,
    /// Quintic polynomials through positions, velocities and accelerations.
    Quintic,
}
