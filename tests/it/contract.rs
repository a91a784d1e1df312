//! The contract as files: the schema, and what requests and replies look like in JSON. `TAKT_UPDATE=1` writes them again;
//! a change shows in the review.

use std::{env, fs, path::PathBuf};

use prost::Message;
use prost_types::{
    DescriptorProto, EnumDescriptorProto, FileDescriptorSet,
    field_descriptor_proto::{Label, Type},
};
use serde_json::{Value, json};
use takt_proto::{
    DESCRIPTOR,
    route::{JSON_LINES, ROUTES, Route, Rpc},
    v1,
};
use takt_tests::{
    TestServer,
    fixtures::{good_check, good_dynamics, good_pose, good_target, plan_move, registration},
};

/// Numbers of a reply may differ by so much, relative, on another machine.
const TOLERANCE: f64 = 1e-9;

fn golden(name: &str) -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/golden")).join(name)
}

fn is_update() -> bool {
    env::var_os("TAKT_UPDATE").is_some()
}

fn read(name: &str) -> String {
    let path = golden(name);
    fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}; TAKT_UPDATE=1 writes it", path.display()))
}

#[test]
fn the_schema_is_the_recorded_one() {
    let set = FileDescriptorSet::decode(DESCRIPTOR).unwrap();
    let mut lines = Vec::new();
    for file in set.file.iter().filter(|file| file.package() == "takt.v1") {
        for message in &file.message_type {
            add_message(&mut lines, "", message);
        }
        for one in &file.enum_type {
            add_enum(&mut lines, "", one);
        }
        for service in &file.service {
            for method in &service.method {
                let [input, output] = [method.input_type(), method.output_type()].map(short);
                lines.push(format!("rpc {}.{}({input}) -> {output}", service.name(), method.name()));
            }
        }
    }
    lines.sort();
    let text = lines.join("\n") + "\n";
    if is_update() {
        fs::write(golden("schema.txt"), &text).unwrap();
    }
    assert_eq!(
        text,
        read("schema.txt"),
        "the schema has changed; TAKT_UPDATE=1 records it"
    );
}

fn short(name: &str) -> &str {
    name.strip_prefix(".takt.v1.").unwrap_or(name)
}

fn add_message(lines: &mut Vec<String>, above: &str, message: &DescriptorProto) {
    let name = format!("{above}{}", message.name());
    for field in &message.field {
        let kind = match field.r#type() {
            Type::Message | Type::Enum => short(field.type_name()).to_owned(),
            other => other.as_str_name().trim_start_matches("TYPE_").to_ascii_lowercase(),
        };
        let oneof = field
            .oneof_index
            .and_then(|index| message.oneof_decl.get(index as usize));
        let label = match (field.label(), field.proto3_optional(), oneof) {
            (Label::Repeated, ..) => "repeated ".to_owned(),
            (_, true, _) => "optional ".to_owned(),
            (_, _, Some(oneof)) => format!("oneof {} ", oneof.name()),
            _ => String::new(),
        };
        lines.push(format!("{name}.{} = {}: {label}{kind}", field.name(), field.number()));
    }
    if message.field.is_empty() {
        lines.push(format!("{name} is empty"));
    }
    let below = format!("{name}.");
    message
        .nested_type
        .iter()
        .for_each(|nested| add_message(lines, &below, nested));
    message
        .enum_type
        .iter()
        .for_each(|nested| add_enum(lines, &below, nested));
}

fn add_enum(lines: &mut Vec<String>, above: &str, one: &EnumDescriptorProto) {
    for value in &one.value {
        lines.push(format!("{above}{}: {} = {}", one.name(), value.name(), value.number()));
    }
}

/// Requests over HTTP, in order: what is said to them is recorded.
fn requests() -> Vec<(&'static str, Rpc, &'static str, Value)> {
    let body = |mut request: Value| {
        if let Some(members) = request.as_object_mut() {
            members.remove("robot_id");
        }
        request
    };
    let of = |request: serde_json::Result<Value>| body(request.expect("a request can be written"));
    let moved = v1::PlanMoveRequest {
        trace_points: Some(3),
        ..plan_move("scara", &[-1.0, 1.0, 0.1, 0.0], &[1.0, -1.0, 0.15, 2.0])
    };
    let heavy = v1::PlanMoveRequest {
        payload: Some(v1::Payload {
            mass_kg: Some(500.0),
            ..Default::default()
        }),
        ..moved.clone()
    };
    let dynamics = v1::InverseDynamicsRequest {
        r#return: vec![1, 2],
        ..good_dynamics(1)
    };
    vec![
        (
            "register_robot",
            Rpc::RegisterRobot,
            "arm",
            of(serde_json::to_value(registration("arm", 5.0))),
        ),
        ("get_robot", Rpc::GetRobot, "arm", Value::Null),
        ("list_revisions", Rpc::ListRevisions, "arm", Value::Null),
        ("list_robots", Rpc::ListRobots, "", Value::Null),
        ("plan_move", Rpc::PlanMove, "scara", of(serde_json::to_value(moved))),
        (
            "plan_move_infeasible",
            Rpc::PlanMove,
            "scara",
            of(serde_json::to_value(heavy)),
        ),
        (
            "plan_move_refused",
            Rpc::PlanMove,
            "scara",
            json!({"start": {"position": [0]}, "speed_scale": 2}),
        ),
        (
            "plan_path_refused",
            Rpc::PlanPath,
            "scara",
            json!({"start": {"position": [0]}, "segments": [{"line": {"target": {}}, "blend": {}}]}),
        ),
        (
            "plan_path",
            Rpc::PlanPath,
            "ur5e",
            json!({
                "start": {"position": [0, -1.57, 1.57, -1.57, -1.57, 0]},
                "segments": [
                    {"joint": {"target": {"position": [0.3, -1.57, 1.57, -1.57, -1.57, 0]}}, "blend": {"fraction": 0.4}},
                    {"joint": {"target": {"position": [0.3, -1.3, 1.57, -1.57, -1.57, 0]}}},
                ],
                "limits": {"tcp_velocity_m_per_s": 1.0},
                "trace_points": 3,
            }),
        ),
        (
            "plan_batch",
            Rpc::PlanBatch,
            "scara",
            json!({"id": "a", "move": {"start": {"position": [-1, 1, 0.1, 0]}, "target": {"position": [1, -1, 0.15]}}}),
        ),
        (
            "stream_setpoints",
            Rpc::StreamSetpoints,
            "scara",
            json!({
                "move": {"start": {"position": [-1, 1, 0.1, 0]}, "target": {"position": [-0.9, 1, 0.1, 0]}},
                "sample_period_s": 0.05, "chunk_points": 2,
            }),
        ),
        (
            "estimate_friction",
            Rpc::EstimateFriction,
            "scara",
            json!({"header": {"method": "KALMAN", "terms": {"by_direction": true}, "half_life_s": 30, "report_period_s": 1}}),
        ),
        (
            "fit_drive_not_excited",
            Rpc::FitDrive,
            "scara",
            json!({"motion": {"scope": "FRICTION", "recording": {
                "time_s": (0..40).map(|index| 0.01 * f64::from(index)).collect::<Vec<_>>(),
                "joints": vec![json!({"position": vec![0.1; 40], "torque": vec![1.0; 40]}); 4],
            }}}),
        ),
        (
            "fit_drive_refused",
            Rpc::FitDrive,
            "scara",
            json!({"motion": {"band_hz": 0, "recording": {"time_s": [0, 0], "joints": [{"joint": "tail"}]}}}),
        ),
        (
            "rehearse",
            Rpc::Rehearse,
            "scara",
            json!({
                "move": {"start": {"position": [-1, 1, 0.1, 0]}, "target": {"position": [-0.9, 1, 0.1, 0]}},
                "friction": [{"coulomb_scale": 2}], "period_s": 0.002, "settle_s": 0.1, "trace_every": 100,
            }),
        ),
        (
            "rehearse_refused",
            Rpc::Rehearse,
            "scara",
            json!({
                "move": {"start": {"position": [-1, 1, 0.1, 0]}, "sample_period_s": 0.004},
                "friction": [{"joint": "tail"}, {"coulomb_scale": -1}], "trace_every": 0,
            }),
        ),
        (
            "check_trajectory",
            Rpc::CheckTrajectory,
            "ur5e",
            of(serde_json::to_value(good_check(2))),
        ),
        (
            "inverse_dynamics",
            Rpc::InverseDynamics,
            "ur5e",
            of(serde_json::to_value(dynamics)),
        ),
        (
            "forward_kinematics",
            Rpc::ForwardKinematics,
            "ur5e",
            of(serde_json::to_value(good_pose())),
        ),
        (
            "inverse_kinematics",
            Rpc::InverseKinematics,
            "ur5e",
            of(serde_json::to_value(good_target())),
        ),
        ("get_robot_not_found", Rpc::GetRobot, "nobody", Value::Null),
        (
            "register_robot_conflict",
            Rpc::RegisterRobot,
            "arm",
            of(serde_json::to_value(v1::RegisterRobotRequest {
                expected_revision: Some(String::new()),
                ..registration("arm", 6.0)
            })),
        ),
        ("delete_robot", Rpc::DeleteRobot, "arm", Value::Null),
    ]
}

#[tokio::test]
async fn requests_and_replies_look_as_recorded() {
    let server = TestServer::start().await;
    let mut http = server.http().await;
    for (name, rpc, robot, request) in requests() {
        let route = Route::of(rpc);
        let body = if request.is_null() {
            String::new()
        } else {
            request.to_string()
        };
        let kind = [("content-type", "application/json")];
        let reply = http
            .request(route.method.as_str(), &route.path_for(robot), &kind, body.as_bytes())
            .await;
        let answer = match reply.header("content-type") {
            Some(JSON_LINES) => reply.json_lines().into(),
            _ => reply.json(),
        };
        let found = json!({"request": request, "status": reply.status, "reply": answer});
        let file = format!("{name}.json");
        if is_update() {
            let text = serde_json::to_string_pretty(&found).expect("JSON can be written");
            fs::write(golden(&file), text + "\n").unwrap();
        }
        let recorded: Value = serde_json::from_str(&read(&file)).unwrap();
        if let Some(difference) = difference(name, &found, &recorded) {
            panic!("{difference}; TAKT_UPDATE=1 records it");
        }
    }
    let rpcs: Vec<Rpc> = requests().iter().map(|(_, rpc, ..)| *rpc).collect();
    for route in ROUTES {
        assert!(rpcs.contains(&route.rpc), "{route:?} has no example");
    }
}

/// Where two documents differ first; numbers may by the tolerance.
fn difference(path: &str, found: &Value, recorded: &Value) -> Option<String> {
    match (found, recorded) {
        (Value::Object(one), Value::Object(other)) => {
            let keys = |map: &serde_json::Map<String, Value>| map.keys().cloned().collect::<Vec<_>>();
            if keys(one) != keys(other) {
                return Some(format!("{path} has {:?}, recorded are {:?}", keys(one), keys(other)));
            }
            one.iter()
                .find_map(|(key, value)| difference(&format!("{path}.{key}"), value, &other[key]))
        }
        (Value::Array(one), Value::Array(other)) if one.len() == other.len() => {
            let pairs = one.iter().zip(other).enumerate();
            pairs
                .filter_map(|(index, (one, other))| difference(&format!("{path}[{index}]"), one, other))
                .next()
        }
        (Value::Number(one), Value::Number(other)) => {
            let (one, other) = (one.as_f64()?, other.as_f64()?);
            let same = (one - other).abs() <= TOLERANCE * other.abs().max(1.0);
            (!same).then(|| format!("{path} is {one}, recorded is {other}"))
        }
        _ => (found != recorded).then(|| format!("{path} is {found}, recorded is {recorded}")),
    }
}
