//! States whose torques or poses cannot be computed.

use takt_proto::v1::{ForwardKinematicsRequest, InverseDynamicsRequest, JointState, Payload, Pose, Tool};
use takt_tests::fixtures::{good_dynamics, good_pose};

use super::{AND_MORE, NOT_FOUND, Row};

const NAN: f64 = f64::NAN;
const INF: f64 = f64::INFINITY;

fn torques(name: &str, change: impl FnOnce(&mut InverseDynamicsRequest), fields: &[&str]) -> Row {
    let mut request = good_dynamics(2);
    change(&mut request);
    Row::message(&format!("torques: {name}"), &request, fields)
}

/// A change of the second state of two.
fn state(name: &str, change: impl FnOnce(&mut JointState), fields: &[&str]) -> Row {
    torques(name, |m| change(&mut m.states[1]), fields)
}

fn pose(name: &str, change: impl FnOnce(&mut ForwardKinematicsRequest), fields: &[&str]) -> Row {
    let mut request = good_pose();
    change(&mut request);
    Row::message(&format!("poses: {name}"), &request, fields)
}

fn tool(position_m: Vec<f64>, orientation: Vec<f64>) -> Option<Tool> {
    Some(Tool {
        tcp: Some(Pose {
            position_m,
            orientation,
        }),
    })
}

fn unknown_quantity(quantity: i32, field: &'static str) -> Row {
    let mut request = good_dynamics(1);
    let mut json = serde_json::to_value(&request).expect("a request can be written");
    json["return"] = vec![1, quantity].into();
    request.r#return = vec![1, quantity];
    let json = json.to_string().into_bytes();
    Row::message_and_json(&format!("torques: quantity {quantity} *"), &request, json, &[field])
}

pub(super) fn rows() -> Vec<Row> {
    vec![
        torques("no states", |m| m.states.clear(), &["states"]),
        torques(
            "too many states",
            |m| m.states = vec![JointState::default(); 10_001],
            &["states"],
        ),
        state("no position", |s| s.position.clear(), &["states[1].position"]),
        state("position short", |s| s.position.truncate(3), &["states[1].position"]),
        state("position NaN", |s| s.position[0] = NAN, &["states[1].position[0]"]),
        state("position far out", |s| s.position[0] = 1e6, &["states[1].position[0]"]),
        state("velocity long", |s| s.velocity.push(1.0), &["states[1].velocity"]),
        state("velocity infinite", |s| s.velocity[4] = INF, &["states[1].velocity[4]"]),
        state("velocity 1e300", |s| s.velocity[3] = 1e300, &["states[1].velocity[3]"]),
        state(
            "acceleration short",
            |s| s.acceleration.truncate(1),
            &["states[1].acceleration"],
        ),
        state(
            "acceleration NaN",
            |s| s.acceleration[2] = NAN,
            &["states[1].acceleration[2]"],
        ),
        state(
            "acceleration 1e308",
            |s| s.acceleration[1] = 1e308,
            &["states[1].acceleration[1]"],
        ),
        torques(
            "all NaN",
            |m| {
                m.states = vec![
                    JointState {
                        position: vec![NAN; 6],
                        ..Default::default()
                    };
                    1000
                ];
            },
            &["states[0].position[0]", "states[0].position[1]", AND_MORE],
        ),
        torques(
            "a quantity that says nothing",
            |m| m.r#return = vec![2, 0],
            &["return[1]"],
        ),
        unknown_quantity(3, "return[1]"),
        unknown_quantity(-1, "return[1]"),
        torques(
            "payload NaN",
            |m| m.payload.get_or_insert_default().mass_kg = Some(NAN),
            &["payload.mass_kg"],
        ),
        torques(
            "payload without mass",
            |m| m.payload = Some(Payload::default()),
            &["payload.mass_kg"],
        ),
        torques(
            "payload of 1e300 kg",
            |m| m.payload.get_or_insert_default().mass_kg = Some(1e300),
            &["payload.mass_kg"],
        ),
        torques("robot without a name", |m| m.robot_id = "?".to_owned(), &["robot_id"]),
        torques("no such robot", |m| m.robot_id = "nobody".to_owned(), &[]).refused(NOT_FOUND),
        pose("no states", |m| m.states.clear(), &["states"]),
        pose(
            "too many states",
            |m| m.states = vec![m.states[0].clone(); 10_001],
            &["states"],
        ),
        pose(
            "position long",
            |m| m.states[0].position.push(0.0),
            &["states[0].position"],
        ),
        pose(
            "position NaN",
            |m| m.states[0].position[1] = NAN,
            &["states[0].position[1]"],
        ),
        pose(
            "position far out",
            |m| m.states[0].position[1] = -2e5,
            &["states[0].position[1]"],
        ),
        pose(
            "tool orientation zero",
            |m| m.tool = tool(vec![], vec![0.0; 4]),
            &["tool.tcp.orientation"],
        ),
        pose(
            "tool orientation NaN",
            |m| m.tool = tool(vec![], vec![0.0, 0.0, 0.0, NAN]),
            &["tool.tcp.orientation[3]"],
        ),
        pose(
            "tool position of four",
            |m| m.tool = tool(vec![0.0; 4], vec![]),
            &["tool.tcp.position_m"],
        ),
        pose(
            "tool position 1e308",
            |m| m.tool = tool(vec![1e308; 3], vec![]),
            &[
                "tool.tcp.position_m[0]",
                "tool.tcp.position_m[1]",
                "tool.tcp.position_m[2]",
            ],
        ),
        pose("no such revision", |m| m.revision = Some("r".to_owned()), &[]).refused(NOT_FOUND),
    ]
}
