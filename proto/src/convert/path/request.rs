//! A robot program, read segment by segment.

use takt_motion::{
    POSITION_MAX, SEGMENTS_MAX, SPLINE_POINTS_MAX,
    nalgebra::{Isometry3, Vector3},
    path::request::{
        Arc, ArcOrientation, Circle, OnExcess, PathRequest, Segment, Shape, Space, Spline, SplineKind, Target, Timing,
        ToolLimits, Transition,
    },
    plan::request::LimitOverride,
    robot::spec::RobotSpec,
};

use super::blend;
use crate::{
    convert::{Findings, Path, SMALLEST, plan, robot, robot::LENGTH_MAX, unknown},
    v1,
};

/// Longest dwell, s: an hour.
const DWELL_MAX: f64 = 3600.0;

const TIMINGS: &str = "OPTIMAL, CONSTANT_SPEED";
const EXCESSES: &str = "SLOW_DOWN, REFUSE";
const TRANSITIONS: &str = "SMOOTH, SOURCE";
const ORIENTATIONS: &str = "INTERPOLATED, TANGENT";
const KINDS: &str = "QUINTIC, CUBIC, B_SPLINE, BEZIER";
pub(super) const SPACES: &str = "JOINT, TOOL";

/// Reads a program. The robot, where it is known, says how many joints there are and which frames have names.
pub fn path_request(wire: v1::PlanPathRequest, robot: Option<&RobotSpec>, findings: &mut Findings) -> PathRequest {
    let at = Path::Root;
    let reader = Reader { robot };
    let start = plan::configuration(wire.start, at.field("start"), reader.joint_count(), findings);
    let segments = reader.segments(wire.segments, at.field("segments"), findings);
    let (limits, tool_limits) = reader.limits(wire.limits, at.field("limits"), findings);
    let timing = optional_enum(findings, at.field("timing"), wire.timing, TIMINGS);
    let on_excess = optional_enum(findings, at.field("on_excess"), wire.on_excess, EXCESSES);
    let transition = optional_enum(findings, at.field("transition"), wire.transition, TRANSITIONS);
    let payload = wire.payload.as_ref();
    let tool = wire.tool.as_ref();
    PathRequest {
        start,
        segments,
        payload: payload.map(|payload| robot::payload(payload, at.field("payload"), findings)),
        tcp: tool.map(|tool| robot::tool(tool, at.field("tool"), findings)),
        limits,
        tool_limits,
        torque_utilization: findings.fraction(at.field("torque_utilization"), wire.torque_utilization),
        speed_scale: findings.fraction(at.field("speed_scale"), wire.speed_scale),
        acceleration_scale: findings.fraction(at.field("acceleration_scale"), wire.acceleration_scale),
        jerk_scale: findings.fraction(at.field("jerk_scale"), wire.jerk_scale),
        limit_jerk: wire.limit_jerk.unwrap_or(true),
        timing: match timing {
            Some(v1::plan_path_request::Timing::ConstantSpeed) => Timing::ConstantSpeed,
            Some(v1::plan_path_request::Timing::Optimal | v1::plan_path_request::Timing::Unspecified) | None => {
                Timing::Optimal
            }
        },
        on_excess: match on_excess {
            Some(v1::plan_path_request::OnExcess::Refuse) => OnExcess::Refuse,
            Some(v1::plan_path_request::OnExcess::SlowDown | v1::plan_path_request::OnExcess::Unspecified) | None => {
                OnExcess::SlowDown
            }
        },
        transition: match transition {
            Some(v1::plan_path_request::Transition::Source) => Transition::Source,
            Some(v1::plan_path_request::Transition::Smooth | v1::plan_path_request::Transition::Unspecified) | None => {
                Transition::Smooth
            }
        },
        transition_time: findings.positive_option(at.field("transition_time_s"), wire.transition_time_s, " s"),
        tolerance: findings.positive_option(at.field("tolerance_m"), wire.tolerance_m, " m"),
        start_speed: findings.positive_option(at.field("start_speed"), wire.start_speed, ""),
        end_speed: findings.positive_option(at.field("end_speed"), wire.end_speed, ""),
        sampling: plan::sampling(wire.sample_period_s, wire.trace_points, findings),
    }
}

/// What the robot says of its programs.
#[derive(Debug, Clone, Copy)]
struct Reader<'a> {
    robot: Option<&'a RobotSpec>,
}

impl Reader<'_> {
    fn joint_count(self) -> Option<usize> {
        self.robot.map(|robot| robot.joints.len())
    }

    fn segments(self, wire: Vec<v1::PathSegment>, at: Path<'_>, findings: &mut Findings) -> Vec<Segment> {
        if wire.is_empty() {
            findings.push(at, "must have at least one entry");
        }
        if wire.len() > SEGMENTS_MAX {
            findings.push(at, format!("has {} entries, the most is {SEGMENTS_MAX}", wire.len()));
            return Vec::new();
        }
        let tool_space: Vec<bool> = wire.iter().map(is_in_tool_space).collect();
        let segments = wire.into_iter().enumerate().map(|(index, segment)| {
            let next = tool_space.get(index + 1).copied();
            let blend_space = match (tool_space[index], next) {
                (true, Some(true)) => Space::Tool,
                _ => Space::Joint,
            };
            self.segment(segment, next.is_none(), blend_space, at.index(index), findings)
        });
        segments.collect()
    }

    fn segment(
        self,
        wire: v1::PathSegment,
        is_last: bool,
        blend_space: Space,
        at: Path<'_>,
        findings: &mut Findings,
    ) -> Segment {
        use v1::path_segment::Shape as Wire;
        let shape = match wire.shape {
            Some(Wire::Joint(joint)) => Shape::Joint {
                target: self.needed_target(joint.target, at.field("joint").field("target"), findings),
            },
            Some(Wire::Line(line)) => Shape::Line {
                target: self.needed_target(line.target, at.field("line").field("target"), findings),
            },
            Some(Wire::Arc(arc)) => Shape::Arc(self.arc(arc, at.field("arc"), findings)),
            Some(Wire::Spline(spline)) => Shape::Spline(self.spline(spline, at.field("spline"), findings)),
            None => {
                findings.push(at, "must have one of `joint`, `line`, `arc`, `spline`");
                Shape::Joint { target: nowhere() }
            }
        };
        if is_last && wire.blend.is_some() {
            findings.push(at.field("blend"), "the last segment has no next one to go over into");
        }
        let blend = wire
            .blend
            .map(|wire| blend::read(wire, blend_space, at.field("blend"), findings));
        let dwell_at = at.field("dwell_s");
        let dwell = wire
            .dwell_s
            .map_or(0.0, |dwell| findings.within(dwell_at, dwell, 0.0..=DWELL_MAX, " s"));
        if dwell > 0.0 && blend.is_some() {
            findings.push(dwell_at, "cannot stand beside `blend`: the path does not stop there");
        }
        let (limits, tool_limits) = self.limits(wire.limits, at.field("limits"), findings);
        Segment {
            shape,
            blend,
            dwell,
            limits,
            tool_limits,
            tool_speed: findings.positive_option(at.field("tool_speed_m_per_s"), wire.tool_speed_m_per_s, " m/s"),
        }
    }

    fn limits(
        self,
        wire: Option<v1::PathLimits>,
        at: Path<'_>,
        findings: &mut Findings,
    ) -> (Vec<LimitOverride>, ToolLimits) {
        let Some(wire) = wire else {
            return (Vec::new(), ToolLimits::default());
        };
        let velocity_at = at.field("tcp_velocity_m_per_s");
        let acceleration_at = at.field("tcp_acceleration_m_per_s2");
        let tool_limits = ToolLimits {
            velocity: findings.positive_option(velocity_at, wire.tcp_velocity_m_per_s, " m/s"),
            acceleration: findings.positive_option(acceleration_at, wire.tcp_acceleration_m_per_s2, " m/s²"),
        };
        let joints = plan::limit_overrides(wire.joints, at.field("joints"), self.robot, findings);
        (joints, tool_limits)
    }

    fn needed_target(self, wire: Option<v1::Target>, at: Path<'_>, findings: &mut Findings) -> Target {
        if let Some(wire) = wire {
            return self.target(wire, at, findings);
        }
        findings.push(at, "must be given");
        nowhere()
    }

    /// A point where the tool stands: of a pose, its orientation is said too, or it would turn to that of the frame
    /// without a word.
    fn target(self, wire: v1::Target, at: Path<'_>, findings: &mut Findings) -> Target {
        if wire.pose.as_ref().is_some_and(|pose| pose.orientation.is_empty()) {
            findings.push(
                at.field("pose").field("orientation"),
                "must be given, x y z w: the tool would turn to it",
            );
        }
        self.place(wire, at, findings)
    }

    /// A point that is passed, whatever the orientation there.
    fn place(self, wire: v1::Target, at: Path<'_>, findings: &mut Findings) -> Target {
        let frame = self.frame(wire.frame, at.field("frame"), findings);
        match (&wire.pose, wire.position.is_empty()) {
            (Some(pose), true) => Target::Pose {
                pose: robot::pose(pose, at.field("pose"), findings),
                frame,
            },
            (None, false) => {
                if frame.is_some() {
                    findings.push(at.field("frame"), "is the frame of a `pose`, and none is given");
                }
                let position_at = at.field("position");
                findings.joint_values(position_at, &wire.position, self.joint_count());
                findings.at_most(position_at, &wire.position, POSITION_MAX);
                Target::Joints(wire.position)
            }
            (Some(_), false) => {
                findings.push(at, "has both `position` and `pose`: give one of them");
                nowhere()
            }
            (None, true) => {
                findings.push(at, "must have `position` or `pose`");
                nowhere()
            }
        }
    }

    /// A frame of the robot by its name; the empty name is none.
    fn frame(self, wire: Option<String>, at: Path<'_>, findings: &mut Findings) -> Option<String> {
        let name = wire.filter(|name| !name.is_empty())?;
        let stranger = |robot: &&RobotSpec| robot.frames.iter().all(|(known, _)| *known != name);
        if let Some(robot) = self.robot.filter(stranger) {
            let known = robot.frames.iter().map(|(name, _)| name.as_str());
            findings.push(at, unknown("frame", &name, known));
        }
        Some(name)
    }

    fn arc(self, mut wire: v1::ArcSegment, at: Path<'_>, findings: &mut Findings) -> Arc {
        let ways = [wire.via.is_some(), !wire.center_m.is_empty(), wire.radius_m.is_some()];
        if ways.iter().filter(|given| **given).count() != 1 {
            findings.push(at, "must have exactly one of `via`, `center_m`, `radius_m`");
        }
        let normal_at = at.field("normal");
        let normal = findings.vector(normal_at, &wire.normal);
        findings.at_most(normal_at, &wire.normal, LENGTH_MAX);
        if normal == Some(Vector3::zeros()) {
            findings.push(normal_at, "has the length 0, so it is no direction");
        }
        let frame = self.frame(wire.frame.take(), at.field("frame"), findings);
        let second = wire.second_via.take();
        let second = second.map(|point| self.place(point, at.field("second_via"), findings));
        let circle = if let Some(via) = wire.via.take() {
            for (name, is_given) in [
                ("normal", normal.is_some()),
                ("long_way", wire.long_way.is_some()),
                ("frame", frame.is_some()),
            ] {
                if is_given {
                    findings.push(at.field(name), "cannot stand beside `via`, which says it already");
                }
            }
            Circle::Via {
                point: self.place(via, at.field("via"), findings),
                second,
            }
        } else {
            if second.is_some() {
                findings.push(at.field("second_via"), "is the second beside `via`, and none is given");
            }
            self.circle(&wire, normal, frame, at, findings)
        };
        let orientation = optional_enum(findings, at.field("orientation"), wire.orientation, ORIENTATIONS);
        Arc {
            circle,
            target: wire
                .target
                .map(|target| self.target(target, at.field("target"), findings)),
            orientation: match orientation {
                Some(v1::arc_segment::Orientation::Tangent) => ArcOrientation::Tangent,
                Some(v1::arc_segment::Orientation::Interpolated | v1::arc_segment::Orientation::Unspecified) | None => {
                    ArcOrientation::Interpolated
                }
            },
        }
    }

    /// A circle that is given by its centre or its radius.
    fn circle(
        self,
        wire: &v1::ArcSegment,
        normal: Option<Vector3<f64>>,
        frame: Option<String>,
        at: Path<'_>,
        findings: &mut Findings,
    ) -> Circle {
        let long_way = wire.long_way.unwrap_or(false);
        if let Some(radius) = wire.radius_m {
            if normal.is_none() {
                findings.push(at.field("normal"), "must be given with `radius_m`");
            }
            return Circle::Radius {
                radius: findings.within(at.field("radius_m"), radius, SMALLEST..=LENGTH_MAX, " m"),
                normal: normal.unwrap_or_else(Vector3::z),
                long_way,
                frame,
            };
        }
        let center_at = at.field("center_m");
        findings.at_most(center_at, &wire.center_m, LENGTH_MAX);
        Circle::Center {
            center: findings
                .vector(center_at, &wire.center_m)
                .unwrap_or_else(Vector3::zeros),
            normal,
            long_way,
            frame,
        }
    }

    fn spline(self, wire: v1::SplineSegment, at: Path<'_>, findings: &mut Findings) -> Spline {
        let points_at = at.field("points");
        let is_tool = !wire.points.iter().all(is_joints);
        let mut points = wire.points;
        if points.is_empty() {
            findings.push(points_at, "must have at least one entry");
        }
        if points.len() > SPLINE_POINTS_MAX {
            let count = points.len();
            findings.push(
                points_at,
                format!("has {count} entries, the most is {SPLINE_POINTS_MAX}"),
            );
            points.clear();
        }
        let points = points.into_iter().enumerate();
        let points = points.map(|(index, point)| self.target(point, points_at.index(index), findings));
        let points = points.collect();
        let kind = optional_enum(findings, at.field("kind"), wire.kind, KINDS);
        let space = optional_enum(findings, at.field("space"), wire.space, SPACES);
        Spline {
            kind: match kind {
                Some(v1::spline_segment::Kind::Cubic) => SplineKind::Cubic,
                Some(v1::spline_segment::Kind::BSpline) => SplineKind::BSpline,
                Some(v1::spline_segment::Kind::Bezier) => SplineKind::Bezier,
                Some(v1::spline_segment::Kind::Quintic | v1::spline_segment::Kind::Unspecified) | None => {
                    SplineKind::Quintic
                }
            },
            points,
            space: space_or(space, if is_tool { Space::Tool } else { Space::Joint }),
        }
    }
}

/// Stands for a point that cannot be read; the finding keeps it from being used.
fn nowhere() -> Target {
    Target::Pose {
        pose: Isometry3::identity(),
        frame: None,
    }
}

fn is_joints(target: &v1::Target) -> bool {
    target.pose.is_none()
}

/// Whether a segment follows a path of the tool.
fn is_in_tool_space(segment: &v1::PathSegment) -> bool {
    use v1::path_segment::Shape;
    match &segment.shape {
        Some(Shape::Line(_) | Shape::Arc(_)) => true,
        Some(Shape::Spline(spline)) => match spline.space {
            None => !spline.points.iter().all(is_joints),
            Some(space) => space == i32::from(v1::Space::Tool),
        },
        Some(Shape::Joint(_)) | None => false,
    }
}

pub(super) fn space_or(wire: Option<v1::Space>, default: Space) -> Space {
    match wire {
        Some(v1::Space::Joint) => Space::Joint,
        Some(v1::Space::Tool) => Space::Tool,
        Some(v1::Space::Unspecified) | None => default,
    }
}

/// A number of an enum where one is given: known and specified.
pub(super) fn optional_enum<E: TryFrom<i32>>(
    findings: &mut Findings,
    at: Path<'_>,
    wire: Option<i32>,
    names: &'static str,
) -> Option<E> {
    wire.and_then(|number| findings.enumerated(at, number, names))
}
