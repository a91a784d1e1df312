//! The limits that a move must keep.

use takt_motion::plan::request::{LimitOverride, MoveRequest};
use takt_motion::robot::spec::{JointSpec, RobotSpec};

/// The limits in force for one joint, all magnitudes but the positions; `None`: there is none.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Bounds {
    /// Lowest position, rad or m.
    pub position_lower: Option<f64>,
    /// Highest position, rad or m.
    pub position_upper: Option<f64>,
    /// Speed either way, rad/s or m/s.
    pub velocity: Option<f64>,
    /// Acceleration while the joint speeds up.
    pub acceleration: Option<f64>,
    /// Deceleration while the joint slows down.
    pub deceleration: Option<f64>,
    /// Drive torque at the joint either way, N m or N.
    pub torque: Option<f64>,
}

impl Bounds {
    /// The limits of the arm itself, one entry a joint.
    #[must_use]
    pub fn of_robot(spec: &RobotSpec) -> Vec<Self> {
        spec.joints
            .iter()
            .map(|joint| Self::of_joint(joint).completed())
            .collect()
    }

    /// The limits that a request puts in force, one entry a joint: the arm's own, tightened by the request's; of two
    /// speeds the smaller, times the speed scale; the peak torque times the utilization unless the request has its own.
    #[must_use]
    pub fn of_request(spec: &RobotSpec, request: &MoveRequest) -> Vec<Self> {
        let asked = request.target_velocity.as_deref().unwrap_or(&[]);
        let speeds = asked.iter().copied().map(Some).chain(std::iter::repeat(None));
        spec.joints
            .iter()
            .zip(speeds)
            .map(|(joint, speed)| {
                let mut bounds = Self::of_joint(joint);
                bounds.torque = bounds.torque.map(|peak| peak * request.torque_utilization);
                for own in request.limits.iter().filter(|own| own.joint == joint.name) {
                    bounds.tighten(own);
                }
                bounds.velocity = smaller(bounds.velocity, speed).map(|speed| speed * request.speed_scale);
                bounds.completed()
            })
            .collect()
    }

    fn of_joint(joint: &JointSpec) -> Self {
        let limits = &joint.limits;
        Self {
            position_lower: limits.position_lower,
            position_upper: limits.position_upper,
            velocity: limits.velocity,
            acceleration: limits.acceleration,
            deceleration: limits.deceleration,
            torque: joint.drive.peak_torque,
        }
    }

    /// With the deceleration limit, where there is none of its own, that of the acceleration in force.
    fn completed(mut self) -> Self {
        self.deceleration = self.deceleration.or(self.acceleration);
        self
    }

    fn tighten(&mut self, own: &LimitOverride) {
        self.position_lower = larger(self.position_lower, own.position_lower);
        self.position_upper = smaller(self.position_upper, own.position_upper);
        self.velocity = smaller(self.velocity, own.velocity);
        self.acceleration = smaller(self.acceleration, own.acceleration);
        self.deceleration = smaller(self.deceleration, own.deceleration);
        self.torque = own.peak_torque.or(self.torque);
    }
}

fn smaller(one: Option<f64>, other: Option<f64>) -> Option<f64> {
    match (one, other) {
        (Some(one), Some(other)) => Some(one.min(other)),
        (one, other) => one.or(other),
    }
}

fn larger(one: Option<f64>, other: Option<f64>) -> Option<f64> {
    match (one, other) {
        (Some(one), Some(other)) => Some(one.max(other)),
        (one, other) => one.or(other),
    }
}
