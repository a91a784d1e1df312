//! Robot programs that say nothing that could be planned, and poses that cannot be read.

use takt_proto::v1::{
    ArcSegment, Blend, InverseKinematicsRequest, JointPosition, LimitOverride, PathLimits, PathSegment,
    PlanPathRequest, Pose, SplineSegment, Target, path_segment::Shape,
};
use takt_tests::fixtures::{good_program, good_target};

use super::{NOT_FOUND, Row};

const NAN: f64 = f64::NAN;
const INF: f64 = f64::INFINITY;

fn row(name: &str, change: impl FnOnce(&mut PlanPathRequest), fields: &[&str]) -> Row {
    let mut request = good_program();
    change(&mut request);
    Row::message(&format!("program: {name}"), &request, fields)
}

/// A change of the second segment, a line.
fn segment(name: &str, change: impl FnOnce(&mut PathSegment), fields: &[&str]) -> Row {
    row(name, |m| change(&mut m.segments[1]), fields)
}

/// A change of the line's target.
fn target(name: &str, change: impl FnOnce(&mut Target), fields: &[&str]) -> Row {
    segment(
        name,
        |s| {
            if let Some(Shape::Line(line)) = &mut s.shape {
                change(line.target.get_or_insert_default());
            }
        },
        fields,
    )
}

fn pose() -> Pose {
    Pose {
        position_m: vec![0.4, 0.0, 0.2],
        orientation: vec![0.0, 1.0, 0.0, 0.0],
    }
}

fn point() -> Target {
    Target {
        pose: Some(pose()),
        ..Default::default()
    }
}

/// An arc in place of the line.
fn arc(name: &str, change: impl FnOnce(&mut ArcSegment), fields: &[&str]) -> Row {
    let mut arc = ArcSegment {
        via: Some(point()),
        target: Some(point()),
        ..Default::default()
    };
    change(&mut arc);
    segment(&format!("arc {name}"), |s| s.shape = Some(Shape::Arc(arc)), fields)
}

/// A spline in place of the line.
fn spline(name: &str, change: impl FnOnce(&mut SplineSegment), fields: &[&str]) -> Row {
    let mut spline = SplineSegment {
        points: vec![point(), point()],
        ..Default::default()
    };
    change(&mut spline);
    segment(
        &format!("spline {name}"),
        |s| s.shape = Some(Shape::Spline(spline)),
        fields,
    )
}

/// A blend after the first segment.
fn blend(name: &str, blend: Blend, fields: &[&str]) -> Row {
    row(&format!("blend {name}"), |m| m.segments[0].blend = Some(blend), fields)
}

fn limits(name: &str, limits: PathLimits, fields: &[&str]) -> Row {
    row(&format!("limits {name}"), |m| m.limits = Some(limits), fields)
}

fn inverse(name: &str, change: impl FnOnce(&mut InverseKinematicsRequest), fields: &[&str]) -> Row {
    let mut request = good_target();
    change(&mut request);
    Row::message(&format!("inverse kinematics: {name}"), &request, fields)
}

/// A number that is no value of an enum, which JSON can carry as a number.
fn unknown_enum(name: &str, place: &str, change: impl FnOnce(&mut PlanPathRequest)) -> Row {
    let mut request = good_program();
    let mut json = serde_json::to_value(&request).expect("a request can be written");
    change(&mut request);
    json[place] = 77.into();
    Row::message_and_json(
        &format!("program: {name} *"),
        &request,
        json.to_string().into_bytes(),
        &[place],
    )
}

pub(super) fn rows() -> Vec<Row> {
    let mut rows = whole();
    rows.extend(segments());
    rows.extend(curves());
    rows.extend(blends());
    rows.extend(poses());
    rows
}

fn whole() -> Vec<Row> {
    vec![
        row("no start", |m| m.start = None, &["start", "start.position"]),
        row(
            "start short",
            |m| m.start = Some(JointPosition { position: vec![0.0; 5] }),
            &["start.position"],
        ),
        row("no segments", |m| m.segments.clear(), &["segments"]),
        row(
            "too many segments",
            |m| m.segments = vec![PathSegment::default(); 10_001],
            &["segments"],
        ),
        row(
            "utilization 0",
            |m| m.torque_utilization = Some(0.0),
            &["torque_utilization"],
        ),
        row("speed 2", |m| m.speed_scale = Some(2.0), &["speed_scale"]),
        row(
            "acceleration NaN",
            |m| m.acceleration_scale = Some(NAN),
            &["acceleration_scale"],
        ),
        row("jerk -1", |m| m.jerk_scale = Some(-1.0), &["jerk_scale"]),
        row("start speed infinite", |m| m.start_speed = Some(INF), &["start_speed"]),
        row("end speed 0", |m| m.end_speed = Some(0.0), &["end_speed"]),
        row(
            "a speed at the end, on a cycle",
            |m| {
                m.end_speed = Some(0.1);
                (m.sample_period_s, m.trace_points) = (Some(0.004), None);
            },
            &["end_speed"],
        ),
        row("period 0", |m| m.sample_period_s = Some(0.0), &["sample_period_s"]),
        row("trace of one", |m| m.trace_points = Some(1), &["trace_points"]),
        row("a long trace", |m| m.trace_points = Some(100_001), &["trace_points"]),
        row(
            "period and trace",
            |m| {
                m.sample_period_s = Some(0.01);
                m.trace_points = Some(10);
            },
            &["trace_points"],
        ),
        unknown_enum("timing", "timing", |m| m.timing = Some(77)),
        unknown_enum("transition", "transition", |m| m.transition = Some(77)),
        unknown_enum("excess", "on_excess", |m| m.on_excess = Some(77)),
        row("timing unspecified", |m| m.timing = Some(0), &["timing"]),
        row(
            "two mistakes",
            |m| {
                m.speed_scale = Some(0.0);
                m.segments[1].dwell_s = Some(-1.0);
            },
            &["segments[1].dwell_s", "speed_scale"],
        ),
        row("no such robot", |m| m.robot_id = "nobody".to_owned(), &[]).refused(NOT_FOUND),
        row("no such revision", |m| m.revision = Some("r".to_owned()), &[]).refused(NOT_FOUND),
        row("robot without a name", |m| m.robot_id = "?".to_owned(), &["robot_id"]),
    ]
}

fn segments() -> Vec<Row> {
    let joint = |name: &str| LimitOverride {
        joint: name.to_owned(),
        ..Default::default()
    };
    vec![
        segment("no shape", |s| s.shape = None, &["segments[1]"]),
        segment("dwell NaN", |s| s.dwell_s = Some(NAN), &["segments[1].dwell_s"]),
        segment(
            "dwell of a day",
            |s| s.dwell_s = Some(86_400.0),
            &["segments[1].dwell_s"],
        ),
        segment(
            "speed 0",
            |s| s.tool_speed_m_per_s = Some(0.0),
            &["segments[1].tool_speed_m_per_s"],
        ),
        row(
            "dwell in a blend",
            |m| m.segments[0].dwell_s = Some(1.0),
            &["segments[0].dwell_s"],
        ),
        row(
            "blend after the last",
            |m| m.segments[3].blend = m.segments[0].blend,
            &["segments[3].blend"],
        ),
        target("without a place", |t| t.pose = None, &["segments[1].line.target"]),
        target(
            "pose without orientation",
            |t| {
                *t = Target {
                    pose: Some(Pose {
                        orientation: Vec::new(),
                        ..pose()
                    }),
                    ..Default::default()
                };
            },
            &["segments[1].line.target.pose.orientation"],
        ),
        target(
            "with two places",
            |t| t.position = vec![0.0; 6],
            &["segments[1].line.target"],
        ),
        target(
            "of five joints",
            |t| {
                t.pose = None;
                t.position = vec![0.0; 5];
            },
            &["segments[1].line.target.position"],
        ),
        target(
            "far out",
            |t| {
                t.pose = None;
                t.position = vec![0.0, 0.0, 1e9, 0.0, 0.0, 0.0];
            },
            &["segments[1].line.target.position[2]"],
        ),
        target(
            "in no frame",
            |t| t.frame = Some("table".to_owned()),
            &["segments[1].line.target.frame"],
        ),
        target(
            "of no length",
            |t| t.pose.get_or_insert_default().orientation = vec![0.0; 4],
            &["segments[1].line.target.pose.orientation"],
        ),
        target(
            "not a number",
            |t| t.pose.get_or_insert_default().position_m[2] = NAN,
            &["segments[1].line.target.pose.position_m[2]"],
        ),
        limits(
            "speed 0",
            PathLimits {
                tcp_velocity_m_per_s: Some(0.0),
                ..Default::default()
            },
            &["limits.tcp_velocity_m_per_s"],
        ),
        limits(
            "acceleration infinite",
            PathLimits {
                tcp_acceleration_m_per_s2: Some(INF),
                ..Default::default()
            },
            &["limits.tcp_acceleration_m_per_s2"],
        ),
        limits(
            "no such joint",
            PathLimits {
                joints: vec![joint("knee")],
                ..Default::default()
            },
            &["limits.joints[0].joint"],
        ),
        limits(
            "a joint twice",
            PathLimits {
                joints: vec![joint("elbow_joint"), joint("elbow_joint")],
                ..Default::default()
            },
            &["limits.joints[1].joint"],
        ),
        segment(
            "jerk of a joint",
            |s| {
                s.limits = Some(PathLimits {
                    joints: vec![LimitOverride {
                        jerk: Some(-1.0),
                        ..joint("elbow_joint")
                    }],
                    ..Default::default()
                });
            },
            &["segments[1].limits.joints[0].jerk"],
        ),
    ]
}

fn curves() -> Vec<Row> {
    vec![
        arc("in no way", |a| a.via = None, &["segments[1].arc"]),
        arc("in two ways", |a| a.radius_m = Some(0.1), &["segments[1].arc"]),
        arc(
            "via nothing",
            |a| a.via = Some(Target::default()),
            &["segments[1].arc.via"],
        ),
        arc(
            "the long way via",
            |a| a.long_way = Some(true),
            &["segments[1].arc.long_way"],
        ),
        arc(
            "a normal via",
            |a| a.normal = vec![0.0, 0.0, 1.0],
            &["segments[1].arc.normal"],
        ),
        arc(
            "a flat normal",
            |a| {
                a.via = None;
                a.center_m = vec![0.4, 0.0, 0.2];
                a.normal = vec![0.0; 3];
            },
            &["segments[1].arc.normal"],
        ),
        arc(
            "a centre of two",
            |a| {
                a.via = None;
                a.center_m = vec![0.4, 0.0];
            },
            &["segments[1].arc.center_m"],
        ),
        arc(
            "a radius without a normal",
            |a| {
                a.via = None;
                a.radius_m = Some(0.2);
            },
            &["segments[1].arc.normal"],
        ),
        arc(
            "a negative radius",
            |a| {
                a.via = None;
                a.radius_m = Some(-0.2);
                a.normal = vec![0.0, 0.0, 1.0];
            },
            &["segments[1].arc.radius_m"],
        ),
        arc(
            "a second point beside none",
            |a| {
                a.via = None;
                a.center_m = vec![0.4, 0.0, 0.2];
                a.second_via = Some(point());
            },
            &["segments[1].arc.second_via"],
        ),
        arc(
            "orientation unspecified",
            |a| a.orientation = Some(0),
            &["segments[1].arc.orientation"],
        ),
        spline("of nothing", |s| s.points.clear(), &["segments[1].spline.points"]),
        spline(
            "through nothing",
            |s| s.points[1] = Target::default(),
            &["segments[1].spline.points[1]"],
        ),
        spline(
            "of too many points",
            |s| s.points = vec![Target::default(); 2001],
            &["segments[1].spline.points"],
        ),
        spline("kind unspecified", |s| s.kind = Some(0), &["segments[1].spline.kind"]),
        spline(
            "space unspecified",
            |s| s.space = Some(0),
            &["segments[1].spline.space"],
        ),
    ]
}

fn blends() -> Vec<Row> {
    let radius = Blend {
        radius_m: Some(0.02),
        ..Default::default()
    };
    vec![
        blend("of no extent", Blend::default(), &["segments[0].blend"]),
        blend(
            "of two extents",
            Blend {
                fraction: Some(0.5),
                ..radius
            },
            &["segments[0].blend"],
        ),
        blend(
            "with radius 0",
            Blend {
                radius_m: Some(0.0),
                ..radius
            },
            &["segments[0].blend.radius_m"],
        ),
        blend(
            "of the whole",
            Blend {
                radius_m: None,
                fraction: Some(1.0),
                ..radius
            },
            &["segments[0].blend.fraction"],
        ),
        blend(
            "on one side",
            Blend {
                radius_m: None,
                before: Some(0.1),
                ..radius
            },
            &["segments[0].blend.after"],
        ),
        blend(
            "steep",
            Blend {
                steepness: Some(5.0),
                ..radius
            },
            &["segments[0].blend.steepness"],
        ),
        blend(
            "steepness NaN",
            Blend {
                weight: Some(2),
                steepness: Some(NAN),
                ..radius
            },
            &["segments[0].blend.steepness"],
        ),
        blend(
            "weight unspecified",
            Blend {
                weight: Some(0),
                ..radius
            },
            &["segments[0].blend.weight"],
        ),
    ]
}

fn poses() -> Vec<Row> {
    vec![
        inverse("no targets", |m| m.targets.clear(), &["targets"]),
        inverse(
            "too many targets",
            |m| m.targets = vec![m.targets[0].clone(); 10_001],
            &["targets"],
        ),
        inverse("no pose", |m| m.targets[0].pose = None, &["targets[0].pose"]),
        inverse(
            "no such frame",
            |m| m.targets[0].frame = Some("table".to_owned()),
            &["targets[0].frame"],
        ),
        inverse(
            "pose NaN",
            |m| m.targets[0].pose.get_or_insert_default().position_m[0] = NAN,
            &["targets[0].pose.position_m[0]"],
        ),
        inverse(
            "orientation of length 2",
            |m| m.targets[0].pose.get_or_insert_default().orientation = vec![0.0, 2.0, 0.0, 0.0],
            &["targets[0].pose.orientation"],
        ),
        inverse(
            "reference short",
            |m| m.reference = Some(JointPosition { position: vec![0.0; 3] }),
            &["reference.position"],
        ),
        inverse(
            "reference infinite",
            |m| {
                let mut position = vec![0.0; 6];
                position[5] = INF;
                m.reference = Some(JointPosition { position });
            },
            &["reference.position[5]"],
        ),
        inverse("no such robot", |m| m.robot_id = "nobody".to_owned(), &[]).refused(NOT_FOUND),
        inverse("robot without a name", |m| m.robot_id = "?".to_owned(), &["robot_id"]),
    ]
}
