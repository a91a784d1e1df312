//! Moves that are wrong.

use takt_proto::v1::{Confidence, LimitOverride, Payload, PlanMoveRequest, Pose, Tool};
use takt_tests::fixtures::good_move;

use super::{AND_MORE, NOT_FOUND, Row};

const NAN: f64 = f64::NAN;
const INF: f64 = f64::INFINITY;

fn row(name: &str, change: impl FnOnce(&mut PlanMoveRequest), fields: &[&str]) -> Row {
    let mut request = good_move();
    change(&mut request);
    Row::message(&format!("move: {name}"), &request, fields)
}

fn start(request: &mut PlanMoveRequest) -> &mut Vec<f64> {
    &mut request.start.get_or_insert_default().position
}

fn target(request: &mut PlanMoveRequest) -> &mut Vec<f64> {
    &mut request.target.get_or_insert_default().position
}

fn payload(name: &str, change: impl FnOnce(&mut Payload), fields: &[&str]) -> Row {
    let mut payload = Payload {
        mass_kg: Some(1.0),
        ..Default::default()
    };
    change(&mut payload);
    row(&format!("payload: {name}"), |m| m.payload = Some(payload), fields)
}

fn tool(name: &str, position_m: Vec<f64>, orientation: Vec<f64>, fields: &[&str]) -> Row {
    let tcp = Some(Pose {
        position_m,
        orientation,
    });
    row(&format!("tool: {name}"), |m| m.tool = Some(Tool { tcp }), fields)
}

fn limit(name: &str, change: impl FnOnce(&mut LimitOverride), fields: &[&str]) -> Row {
    let mut limit = elbow();
    change(&mut limit);
    row(&format!("limits: {name}"), |m| m.limits = vec![limit], fields)
}

fn elbow() -> LimitOverride {
    LimitOverride {
        joint: "elbow_joint".to_owned(),
        ..Default::default()
    }
}

fn confidence(name: &str, level: f64, over: Option<i32>, fields: &[&str]) -> Row {
    let confidence = Some(Confidence { level, over });
    row(&format!("confidence: {name}"), |m| m.confidence = confidence, fields)
}

/// The model of the arm counts as exact.
fn confidences() -> Vec<Row> {
    const EXACT: &str = "confidence";
    const LEVEL: &[&str] = &[EXACT, "confidence.level"];
    vec![
        confidence("of an exact model", 0.95, None, &[EXACT]),
        confidence("of a half", 0.5, None, LEVEL),
        confidence("of one", 1.0, Some(2), LEVEL),
        confidence("in percent", 95.0, None, LEVEL),
        confidence("not a number", NAN, None, LEVEL),
        confidence("over nothing named", 0.95, Some(0), &[EXACT, "confidence.over"]),
    ]
}

pub(super) fn rows() -> Vec<Row> {
    let mut rows = positions();
    rows.extend(speeds());
    rows.extend(loads());
    rows.extend(limits());
    rows.extend(scalars());
    rows.extend(names());
    rows.extend(confidences());
    rows.push(row(
        "everything is wrong at once",
        |m| {
            start(m)[0] = NAN;
            target(m).pop();
            m.payload = Some(Payload::default());
            m.speed_scale = Some(-1.0);
            m.torque_utilization = Some(INF);
            m.cycle_time_s = Some(0.0);
        },
        &[
            "start.position[0]",
            "target.position",
            "payload.mass_kg",
            "torque_utilization",
            "speed_scale",
            "cycle_time_s",
        ],
    ));
    rows
}

fn positions() -> Vec<Row> {
    vec![
        row(
            "motors without a period",
            |m| m.motor_setpoints = Some(true),
            &["motor_setpoints"],
        ),
        row("no start", |m| m.start = None, &["start", "start.position"]),
        row("no target", |m| m.target = None, &["target", "target.position"]),
        row("empty start", |m| start(m).clear(), &["start.position"]),
        row("start too short", |m| start(m).truncate(5), &["start.position"]),
        row("target too long", |m| target(m).push(0.0), &["target.position"]),
        row(
            "ten thousand positions",
            |m| *target(m) = vec![0.0; 10_000],
            &["target.position"],
        ),
        row("start NaN", |m| start(m)[2] = NAN, &["start.position[2]"]),
        row("start infinite", |m| start(m)[0] = INF, &["start.position[0]"]),
        row(
            "target minus infinite",
            |m| target(m)[5] = -INF,
            &["target.position[5]"],
        ),
        row(
            "a thousand NaN",
            |m| *target(m) = vec![NAN; 1000],
            &[
                "target.position[0]",
                "target.position[1]",
                "target.position[2]",
                AND_MORE,
            ],
        ),
        row("target 1e300", |m| target(m)[3] = 1e300, &["target.position[3]"]),
        row("target out of range", |m| target(m)[0] = 6.4, &["target.position[0]"]),
        row("start out of range", |m| start(m)[0] = -7.0, &["start.position[0]"]),
        row(
            "start just out of range and the move outwards",
            |m| {
                start(m)[2] = 3.145;
                target(m)[2] = 3.1455;
            },
            &["target.position[2]", "start.position[2]"],
        ),
        row(
            "target in degrees",
            |m| *target(m) = vec![10.0, -90.0, 90.0, -90.0, -90.0, 0.0],
            &[
                "target.position[0]",
                "target.position[1]",
                "target.position[2]",
                "target.position[3]",
                "target.position[4]",
            ],
        ),
    ]
}

fn speeds() -> Vec<Row> {
    let at = |joint: usize, speed: f64| {
        move |m: &mut PlanMoveRequest| {
            m.target_velocity = vec![1.0; 6];
            m.target_velocity[joint] = speed;
        }
    };
    vec![
        row(
            "one speed for six joints",
            |m| m.target_velocity = vec![1.0],
            &["target_velocity"],
        ),
        row("speed 0", at(1, 0.0), &["target_velocity[1]"]),
        row("speed negative", at(2, -1.0), &["target_velocity[2]"]),
        row("speed NaN", at(0, NAN), &["target_velocity[0]"]),
        row("speed infinite", at(5, INF), &["target_velocity[5]"]),
        row("speed above the limit", at(3, 3.2), &["target_velocity[3]"]),
        row("speed in degrees a second", at(4, 180.0), &["target_velocity[4]"]),
    ]
}

fn loads() -> Vec<Row> {
    vec![
        payload("no mass", |p| p.mass_kg = None, &["payload.mass_kg"]),
        payload("negative mass", |p| p.mass_kg = Some(-0.1), &["payload.mass_kg"]),
        payload("mass NaN", |p| p.mass_kg = Some(NAN), &["payload.mass_kg"]),
        payload("mass infinite", |p| p.mass_kg = Some(INF), &["payload.mass_kg"]),
        payload("mass 1e300", |p| p.mass_kg = Some(1e300), &["payload.mass_kg"]),
        payload("mass in micrograms", |p| p.mass_kg = Some(2e9), &["payload.mass_kg"]),
        payload(
            "center of two",
            |p| p.center_of_mass_m = vec![0.0; 2],
            &["payload.center_of_mass_m"],
        ),
        payload(
            "center of seven",
            |p| p.center_of_mass_m = vec![0.0; 7],
            &["payload.center_of_mass_m"],
        ),
        payload(
            "center NaN",
            |p| p.center_of_mass_m = vec![0.0, NAN, 0.0],
            &["payload.center_of_mass_m[1]"],
        ),
        payload(
            "center in micrometres",
            |p| p.center_of_mass_m = vec![0.0, 0.0, 1.2e5],
            &["payload.center_of_mass_m[2]"],
        ),
        payload(
            "inertia of five",
            |p| p.inertia_kg_m2 = vec![0.0; 5],
            &["payload.inertia_kg_m2"],
        ),
        payload(
            "inertia of nine",
            |p| p.inertia_kg_m2 = vec![0.0; 9],
            &["payload.inertia_kg_m2"],
        ),
        payload(
            "inertia infinite",
            |p| p.inertia_kg_m2 = vec![0.1, 0.1, INF, 0.0, 0.0, 0.0],
            &["payload.inertia_kg_m2[2]"],
        ),
        payload(
            "inertia 1e300",
            |p| p.inertia_kg_m2 = vec![1e300, 0.1, 0.1, 0.0, 0.0, 0.0],
            &["payload.inertia_kg_m2[0]"],
        ),
        payload(
            "inertia without mass",
            |p| {
                p.mass_kg = Some(0.0);
                p.inertia_kg_m2 = vec![0.1, 0.1, 0.1, 0.0, 0.0, 0.0];
            },
            &["payload.inertia_kg_m2"],
        ),
        tool("position of two", vec![0.0; 2], vec![], &["tool.tcp.position_m"]),
        tool("position NaN", vec![NAN, 0.0, 0.0], vec![], &["tool.tcp.position_m[0]"]),
        tool(
            "position 1e300",
            vec![1e300, 0.0, 0.0],
            vec![],
            &["tool.tcp.position_m[0]"],
        ),
        tool("orientation of three", vec![], vec![0.0; 3], &["tool.tcp.orientation"]),
        tool("orientation zero", vec![], vec![0.0; 4], &["tool.tcp.orientation"]),
        tool(
            "orientation twice a unit",
            vec![],
            vec![0.0, 0.0, 0.0, 2.0],
            &["tool.tcp.orientation"],
        ),
        tool(
            "orientation infinite",
            vec![],
            vec![0.0, 0.0, INF, 1.0],
            &["tool.tcp.orientation[2]"],
        ),
        tool(
            "orientation 1e200",
            vec![],
            vec![1e200, 0.0, 0.0, 0.0],
            &["tool.tcp.orientation"],
        ),
    ]
}

fn limits() -> Vec<Row> {
    vec![
        limit(
            "of a joint that is not there",
            |l| l.joint = "wrist_4".to_owned(),
            &["limits[0].joint"],
        ),
        limit("of no joint", |l| l.joint.clear(), &["limits[0].joint"]),
        limit(
            "of a joint with a megabyte of name",
            |l| l.joint = "x".repeat(1 << 20),
            &["limits[0].joint"],
        ),
        row(
            "limits: twice the same joint",
            |m| m.limits = vec![elbow(), elbow()],
            &["limits[1].joint"],
        ),
        limit("speed 0", |l| l.velocity = Some(0.0), &["limits[0].velocity"]),
        limit("speed negative", |l| l.velocity = Some(-1.0), &["limits[0].velocity"]),
        limit("speed NaN", |l| l.velocity = Some(NAN), &["limits[0].velocity"]),
        limit("speed looser", |l| l.velocity = Some(10.0), &["limits[0].velocity"]),
        limit(
            "acceleration infinite",
            |l| l.acceleration = Some(INF),
            &["limits[0].acceleration"],
        ),
        limit(
            "acceleration 0",
            |l| l.acceleration = Some(0.0),
            &["limits[0].acceleration"],
        ),
        limit(
            "deceleration negative",
            |l| l.deceleration = Some(-3.0),
            &["limits[0].deceleration"],
        ),
        limit(
            "torque looser",
            |l| l.peak_torque = Some(1e4),
            &["limits[0].peak_torque"],
        ),
        limit(
            "torque negative",
            |l| l.peak_torque = Some(-5.0),
            &["limits[0].peak_torque"],
        ),
        limit(
            "lower position looser",
            |l| l.position_lower = Some(-9.0),
            &["limits[0].position_lower"],
        ),
        limit(
            "upper position looser",
            |l| l.position_upper = Some(9.0),
            &["limits[0].position_upper"],
        ),
        limit(
            "upper position NaN",
            |l| l.position_upper = Some(NAN),
            &["limits[0].position_upper"],
        ),
        limit(
            "an empty range",
            |l| {
                l.position_lower = Some(1.0);
                l.position_upper = Some(0.5);
            },
            &["limits[0].position_lower"],
        ),
        limit(
            "a range without the target",
            |l| l.position_lower = Some(1.2),
            &["target.position[2]"],
        ),
        row(
            "limits: a hundred joints that are not there",
            |m| {
                m.limits = (0..100)
                    .map(|index| LimitOverride {
                        joint: format!("joint_{index}"),
                        ..Default::default()
                    })
                    .collect();
            },
            &["limits"],
        ),
    ]
}

fn scalars() -> Vec<Row> {
    let mut rows = Vec::new();
    for (name, value) in [
        ("0", 0.0),
        ("negative", -0.5),
        ("just above 1", 1.000_000_1),
        ("in percent", 80.0),
        ("NaN", NAN),
        ("infinite", INF),
    ] {
        let utilization = |m: &mut PlanMoveRequest| m.torque_utilization = Some(value);
        rows.push(row(
            &format!("utilization {name}"),
            utilization,
            &["torque_utilization"],
        ));
        let scale = |m: &mut PlanMoveRequest| m.speed_scale = Some(value);
        rows.push(row(&format!("speed scale {name}"), scale, &["speed_scale"]));
    }
    for (name, value) in [
        ("0", 0.0),
        ("negative", -0.004),
        ("NaN", NAN),
        ("infinite", INF),
        ("1e-12", 1e-12),
    ] {
        let period = |m: &mut PlanMoveRequest| m.sample_period_s = Some(value);
        rows.push(row(&format!("sample period {name}"), period, &["sample_period_s"]));
    }
    for (name, value) in [
        ("0", 0.0),
        ("negative", -1.0),
        ("NaN", NAN),
        ("infinite", INF),
        ("shorter than the move", 0.01),
    ] {
        let cycle = |m: &mut PlanMoveRequest| m.cycle_time_s = Some(value);
        rows.push(row(&format!("cycle time {name}"), cycle, &["cycle_time_s"]));
    }
    for points in [0, 1, 100_001, u32::MAX] {
        let trace = |m: &mut PlanMoveRequest| m.trace_points = Some(points);
        rows.push(row(&format!("{points} trace points"), trace, &["trace_points"]));
    }
    rows.push(row(
        "trace points beside a sample period",
        |m| {
            m.trace_points = Some(10);
            m.sample_period_s = Some(0.01);
        },
        &["trace_points"],
    ));
    rows.push(row("a method that says nothing", |m| m.method = Some(0), &["method"]));
    for method in [4, 99, -1, i32::MAX, i32::MIN] {
        rows.push(unknown_method(method));
    }
    rows
}

/// No JSON writer writes an unknown value, so it is put in by hand.
fn unknown_method(method: i32) -> Row {
    let mut request = good_move();
    let mut json = serde_json::to_value(&request).expect("a request can be written");
    json["method"] = method.into();
    request.method = Some(method);
    let name = format!("move: method {method} *");
    Row::message_and_json(&name, &request, json.to_string().into_bytes(), &["method"])
}

fn names() -> Vec<Row> {
    let mut rows: Vec<Row> = [
        "UR5E",
        "a b",
        "..",
        "ur5e;drop table robots",
        "é",
        "-a",
        ".hidden",
        "ur5e\n",
        "\u{0}",
        "a%2fb",
    ]
    .into_iter()
    .map(|id| row(&format!("robot {id:?}"), |m| m.robot_id = id.to_owned(), &["robot_id"]))
    .collect();
    rows.push(row(
        "an id of 64 letters",
        |m| m.robot_id = "x".repeat(64),
        &["robot_id"],
    ));
    rows.push(row(
        "no such id, and a NaN",
        |m| {
            m.robot_id = "No".to_owned();
            start(m)[0] = NAN;
        },
        &["robot_id", "start.position[0]"],
    ));
    rows.push(row("no such robot", |m| m.robot_id = "ur6e".to_owned(), &[]).refused(NOT_FOUND));
    for (name, revision) in [
        ("no such revision", "0123456789abcdef0123456789abcdef".to_owned()),
        ("an empty revision", String::new()),
        ("a long revision", "x".repeat(100_000)),
        ("a revision that is SQL", "' or 1=1 --".to_owned()),
    ] {
        rows.push(row(name, |m| m.revision = Some(revision), &[]).refused(NOT_FOUND));
    }
    rows
}
