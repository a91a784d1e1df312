//! The limits that a program puts in force, segment by segment.
//!
//! The whole path has the arm's own limits, tightened by the request's; a segment has those, tightened by its own. A
//! peak torque of a request takes the place of the arm's times the utilization. An acceleration counts against the
//! tighter of the limits for speeding up and slowing down, whichever the joint does. Speeds, accelerations and jerks are
//! multiplied by the request's scales at the end, the tool's like the joints'.

use takt_motion::path::request::{PathRequest, Segment, Timing};
use takt_motion::plan::request::LimitOverride;
use takt_motion::robot::spec::{JointKind, JointSpec, RobotSpec};

/// What bounds the motion on one segment; `None` does not.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SegmentBounds {
    /// One a joint, in model order.
    pub joints: Vec<JointBounds>,
    /// Speed of the tool centre point, m/s.
    pub tool_velocity: Option<f64>,
    /// Its acceleration, m/s².
    pub tool_acceleration: Option<f64>,
}

/// What bounds one joint on one segment, all magnitudes but the positions; `None`: nothing does.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct JointBounds {
    /// Lowest position, rad or m.
    pub position_lower: Option<f64>,
    /// Highest position, rad or m.
    pub position_upper: Option<f64>,
    /// Speed either way.
    pub velocity: Option<f64>,
    /// Acceleration, speeding up or slowing down.
    pub acceleration: Option<f64>,
    /// Jerk either way.
    pub jerk: Option<f64>,
    /// Drive torque at the joint either way, N m or N.
    pub torque: Option<f64>,
}

/// The limits of a program, one entry a segment.
#[must_use]
pub fn of_program(spec: &RobotSpec, request: &PathRequest) -> Vec<SegmentBounds> {
    request
        .segments
        .iter()
        .map(|segment| of_segment(spec, request, segment))
        .collect()
}

fn of_segment(spec: &RobotSpec, request: &PathRequest, segment: &Segment) -> SegmentBounds {
    let joints = spec.joints.iter().map(|joint| {
        let mut bounds = JointBounds::of_joint(joint);
        bounds.torque = own(&request.limits, joint)
            .find_map(|own| own.peak_torque)
            .or(bounds.torque.map(|peak| peak * request.torque_utilization));
        let segments_own = own(&segment.limits, joint).filter_map(|own| own.peak_torque);
        bounds.torque = segments_own.map(Some).fold(bounds.torque, smaller);
        for own in own(&request.limits, joint).chain(own(&segment.limits, joint)) {
            bounds.tighten(own);
        }
        bounds.scaled(request)
    });
    let (path, own) = (&request.tool_limits, &segment.tool_limits);
    // at constant speed it is not a limit but the speed itself
    let tool_speed = segment.tool_speed.filter(|_| request.timing == Timing::Optimal);
    let speed = smaller(smaller(path.velocity, own.velocity), tool_speed);
    SegmentBounds {
        joints: joints.collect(),
        tool_velocity: speed.map(|speed| speed * request.speed_scale),
        tool_acceleration: smaller(path.acceleration, own.acceleration)
            .map(|acceleration| acceleration * request.acceleration_scale),
    }
}

fn own<'a>(limits: &'a [LimitOverride], joint: &JointSpec) -> impl Iterator<Item = &'a LimitOverride> {
    limits.iter().filter(move |own| own.joint == joint.name)
}

impl JointBounds {
    fn of_joint(joint: &JointSpec) -> Self {
        let limits = &joint.limits;
        // A joint that turns for ever has no range, whatever its description carries along.
        let turns = joint.kind == JointKind::Continuous;
        Self {
            position_lower: limits.position_lower.filter(|_| !turns),
            position_upper: limits.position_upper.filter(|_| !turns),
            velocity: limits.velocity,
            acceleration: smaller(limits.acceleration, limits.deceleration),
            jerk: limits.jerk,
            torque: joint.drive.peak_torque,
        }
    }

    /// Everything but the torque, of which a request's takes the model's place.
    fn tighten(&mut self, own: &LimitOverride) {
        self.position_lower = larger(self.position_lower, own.position_lower);
        self.position_upper = smaller(self.position_upper, own.position_upper);
        self.velocity = smaller(self.velocity, own.velocity);
        self.acceleration = smaller(self.acceleration, smaller(own.acceleration, own.deceleration));
        self.jerk = smaller(self.jerk, own.jerk);
    }

    fn scaled(mut self, request: &PathRequest) -> Self {
        self.velocity = self.velocity.map(|limit| limit * request.speed_scale);
        self.acceleration = self.acceleration.map(|limit| limit * request.acceleration_scale);
        self.jerk = match request.limit_jerk {
            true => self.jerk.map(|limit| limit * request.jerk_scale),
            false => None,
        };
        self
    }

    /// The range, by which ways beyond a position limit are measured; 1 where one of its ends is open.
    #[must_use]
    pub fn range(&self) -> f64 {
        match (self.position_lower, self.position_upper) {
            (Some(lower), Some(upper)) if upper > lower => upper - lower,
            _ => 1.0,
        }
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
