//! A program checked against its robot: every limit in force, for the whole path and for each segment, or every reason
//! why not.

use nalgebra::Isometry3;

use super::request::{PathRequest, Segment, Timing, ToolLimits};
use super::stroke::Span;
use crate::error::Invalid;
use crate::plan::Failure;
use crate::plan::problem::{JointLimit, check_part, check_positions, check_sampling, limits_in_force};
use crate::plan::request::LimitOverride;
use crate::robot::Robot;
use crate::timing::limits::{JointLimits, Limits, Stretch};
use crate::tolerance::RATE_RESERVE;

/// A program with everything that bounds it.
#[derive(Debug)]
pub(super) struct Problem {
    /// With the payload of this program.
    pub(super) robot: Robot,
    pub(super) tcp: Isometry3<f64>,
    /// One a joint: of the whole path, unscaled.
    joints: Vec<JointLimit>,
    /// One a segment.
    segments: Vec<Bounds>,
    pub(super) warnings: Vec<String>,
}

/// What bounds one segment, scaled.
#[derive(Debug)]
struct Bounds {
    joints: Vec<JointLimits>,
    tool: ToolLimits,
}

impl Problem {
    pub(super) fn new(robot: &Robot, request: &PathRequest) -> Result<Self, Failure> {
        let mut wrong = Vec::new();
        check_positions(robot, "start.position", &request.start, &mut wrong);
        for (path, part) in [
            ("torque_utilization", request.torque_utilization),
            ("speed_scale", request.speed_scale),
            ("acceleration_scale", request.acceleration_scale),
            ("jerk_scale", request.jerk_scale),
        ] {
            check_part(path, part, &mut wrong);
        }
        check_sampling(request.sampling, &mut wrong);
        check_tool("limits", request.tool_limits, &mut wrong);
        let joints = joint_limits(robot, "", &request.limits, request, &mut wrong);
        let mut segments = Vec::with_capacity(request.segments.len());
        for (index, segment) in request.segments.iter().enumerate() {
            segments.push(bounds(robot, index, segment, request, &joints, &mut wrong));
        }
        check_bounded(robot, &joints, &mut wrong);
        if !wrong.is_empty() {
            return Err(Failure::Invalid(wrong));
        }
        let mut problem = Self {
            robot: request
                .payload
                .as_ref()
                .map_or_else(|| robot.clone(), |payload| robot.with_payload(payload)),
            tcp: request.tcp.unwrap_or(robot.spec().tcp),
            joints,
            segments,
            warnings: Vec::new(),
        };
        problem.warn();
        Ok(problem)
    }

    /// The torque limits of the whole path.
    pub(super) fn torque_limits(&self) -> Vec<Option<f64>> {
        self.joints.iter().map(|joint| joint.torque).collect()
    }

    /// The position limits.
    pub(super) fn ranges(&self) -> Vec<[Option<f64>; 2]> {
        let range = |joint: &JointLimit| [joint.position_lower, joint.position_upper];
        self.joints.iter().map(range).collect()
    }

    /// What bounds a path, segment by segment.
    pub(super) fn limits(&self, spans: &[Span]) -> Limits {
        let stretches = spans.iter().map(|span| {
            let bounds = &self.segments[span.segment];
            Stretch {
                end: span.end,
                joints: bounds.joints.clone(),
                tool_velocity: bounds.tool.velocity,
                tool_acceleration: bounds.tool.acceleration,
            }
        });
        Limits {
            stretches: stretches.collect(),
        }
    }

    /// Whether the jerk of any joint is limited anywhere on a path.
    pub(super) fn limits_jerk(&self, spans: &[Span]) -> bool {
        spans.iter().any(|span| {
            let joints = &self.segments[span.segment].joints;
            joints.iter().any(|joint| joint.jerk.is_some())
        })
    }

    /// The tightest tool acceleration on some segments.
    pub(super) fn tool_acceleration(&self, segments: &[usize]) -> Option<f64> {
        let segments = segments.iter().map(|segment| self.segments[*segment].tool.acceleration);
        segments.fold(None, tighter)
    }

    fn warn(&mut self) {
        let joints = &self.robot.spec().joints;
        let unchecked = self
            .joints
            .iter()
            .zip(joints)
            .filter(|(limit, _)| limit.torque.is_none());
        let unchecked: Vec<&str> = unchecked.map(|(_, joint)| joint.name.as_str()).collect();
        if !unchecked.is_empty() {
            self.warnings.push(format!(
                "peak torque unknown, torque not checked: {}",
                unchecked.join(", ")
            ));
        }
    }
}

/// The joint limits in force under some overrides; findings stand below `parent`.
fn joint_limits(
    robot: &Robot,
    parent: &str,
    overrides: &[LimitOverride],
    request: &PathRequest,
    wrong: &mut Vec<Invalid>,
) -> Vec<JointLimit> {
    let mut found = Vec::new();
    let limits = limits_in_force(robot, overrides, request.torque_utilization, &mut found);
    wrong.extend(found.into_iter().map(|invalid| {
        let path = invalid.path.replacen("limits[", "limits.joints[", 1);
        Invalid::new(path, invalid.message).below(parent)
    }));
    limits
}

/// What bounds a segment: its own limits and the path's, whichever are tighter.
fn bounds(
    robot: &Robot,
    index: usize,
    segment: &Segment,
    request: &PathRequest,
    path: &[JointLimit],
    wrong: &mut Vec<Invalid>,
) -> Bounds {
    let parent = format!("segments[{index}]");
    check_tool(&format!("{parent}.limits"), segment.tool_limits, wrong);
    let own = joint_limits(robot, &parent, &segment.limits, request, wrong);
    for (entry, limit) in segment.limits.iter().enumerate() {
        for (field, position) in [
            ("position_lower", limit.position_lower),
            ("position_upper", limit.position_upper),
        ] {
            if position.is_some() {
                let path = format!("{parent}.limits.joints[{entry}].{field}");
                wrong.push(Invalid::new(
                    path,
                    "position limits hold for the whole path: give them in its `limits`",
                ));
            }
        }
    }
    // a torque of the request stands for the model's times the utilization; without one the segment has nothing to add
    let own_torque = |name: &str| {
        let mut limits = segment.limits.iter();
        limits
            .find(|limit| limit.joint == name)
            .and_then(|limit| limit.peak_torque)
    };
    let specs = &robot.spec().joints;
    let joints = own.iter().zip(path).zip(specs).map(|((own, path), joint)| {
        let acceleration = [own.acceleration, own.deceleration, path.acceleration, path.deceleration];
        let acceleration = acceleration.into_iter().fold(None, tighter);
        let velocity = own.velocity.min(path.velocity);
        let scaled = |value: f64, scale: f64| value * scale * (1.0 - RATE_RESERVE);
        JointLimits {
            velocity: velocity.is_finite().then(|| scaled(velocity, request.speed_scale)),
            acceleration: acceleration.map(|value| scaled(value, request.acceleration_scale)),
            jerk: tighter(own.jerk, path.jerk)
                .filter(|_| request.limit_jerk)
                .map(|value| scaled(value, request.jerk_scale)),
            torque: tighter(path.torque, own_torque(&joint.name)),
        }
    });
    let tool_velocity = [
        segment.tool_limits.velocity,
        segment.tool_speed.filter(|_| request.timing == Timing::Optimal),
        request.tool_limits.velocity,
    ];
    let tool_acceleration = tighter(segment.tool_limits.acceleration, request.tool_limits.acceleration);
    Bounds {
        joints: joints.collect(),
        tool: ToolLimits {
            velocity: tool_velocity
                .into_iter()
                .fold(None, tighter)
                .map(|value| value * request.speed_scale),
            acceleration: tool_acceleration.map(|value| value * request.acceleration_scale),
        },
    }
}

/// The tighter of two limits.
fn tighter(a: Option<f64>, b: Option<f64>) -> Option<f64> {
    match (a, b) {
        (Some(a), Some(b)) => Some(a.min(b)),
        (a, b) => a.or(b),
    }
}

fn check_tool(parent: &str, limits: ToolLimits, wrong: &mut Vec<Invalid>) {
    let fields = [
        ("tcp_velocity_m_per_s", limits.velocity),
        ("tcp_acceleration_m_per_s2", limits.acceleration),
    ];
    for (field, value) in fields {
        if let Some(value) = value {
            crate::plan::problem::check_positive(&format!("{parent}.{field}"), value, wrong);
        }
    }
}

/// Every joint needs something that bounds its acceleration.
fn check_bounded(robot: &Robot, joints: &[JointLimit], wrong: &mut Vec<Invalid>) {
    for (limit, joint) in joints.iter().zip(&robot.spec().joints) {
        if limit.torque.is_none() && limit.acceleration.is_none() {
            let message = format!(
                "joint \"{}\": neither peak torque nor acceleration limit is known, so nothing bounds the motion; give \
                 limits.joints[].peak_torque or limits.joints[].acceleration",
                joint.name
            );
            wrong.push(Invalid::new("limits.joints", message));
        }
    }
}
