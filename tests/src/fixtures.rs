//! Robots and requests that are known to be good.

use std::{fs, path::Path};

use serde_json::Value;
use takt_proto::v1;

/// The ids of the example robots.
pub const EXAMPLES: [&str; 4] = ["fr3", "puma560", "scara", "ur5e"];

/// The text of a file of the workspace.
#[must_use]
pub fn text(path: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(path);
    fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The JSON of a file of the workspace.
#[must_use]
pub fn json(path: &str) -> Value {
    serde_json::from_str(&text(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// Numbers of a JSON array, rows of rows one after another.
#[must_use]
pub fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(values) => values.iter().flat_map(numbers).collect(),
        other => vec![other.as_f64().unwrap_or_else(|| panic!("{other} is not a number"))],
    }
}

/// The description of an example robot.
#[must_use]
pub fn example(id: &str) -> v1::RobotDescription {
    serde_json::from_value(json(&format!("robots/{id}.json"))).expect("an example is a description")
}

/// An arm with two joints; the mass of its first link makes it another content.
#[must_use]
pub fn two_joints(mass_kg: f64) -> v1::RobotDescription {
    let link = |name: &str, a_m: f64, mass_kg: f64| v1::DhLink {
        name: name.to_owned(),
        r#type: v1::JointType::Revolute.into(),
        a_m,
        mass_kg,
        center_of_mass_m: vec![-0.2, 0.0, 0.0],
        inertia_kg_m2: vec![0.1, 0.1, 0.1, 0.0, 0.0, 0.0],
        ..Default::default()
    };
    let joint = |name: &str, peak_torque: f64| v1::JointDescription {
        name: name.to_owned(),
        limits: Some(v1::JointLimits {
            velocity: Some(3.0),
            ..Default::default()
        }),
        drive: Some(v1::Drive {
            peak_torque: Some(peak_torque),
            ..Default::default()
        }),
    };
    v1::RobotDescription {
        dh: Some(v1::DhTable {
            convention: v1::dh_table::Convention::Standard.into(),
            links: vec![link("a", 0.5, mass_kg), link("b", 0.4, 2.0)],
        }),
        joints: vec![joint("a", 200.0), joint("b", 100.0)],
        ..Default::default()
    }
}

/// A registration of that arm.
#[must_use]
pub fn registration(robot_id: &str, mass_kg: f64) -> v1::RegisterRobotRequest {
    v1::RegisterRobotRequest {
        robot_id: robot_id.to_owned(),
        description: Some(two_joints(mass_kg)),
        ..Default::default()
    }
}

/// A move between two configurations.
#[must_use]
pub fn plan_move(robot_id: &str, start: &[f64], target: &[f64]) -> v1::PlanMoveRequest {
    let at = |position: &[f64]| {
        Some(v1::JointPosition {
            position: position.to_vec(),
        })
    };
    v1::PlanMoveRequest {
        robot_id: robot_id.to_owned(),
        start: at(start),
        target: at(target),
        ..Default::default()
    }
}

/// A move of the UR5e that can be planned, quickly.
#[must_use]
pub fn good_move() -> v1::PlanMoveRequest {
    plan_move(
        "ur5e",
        &[0.0, -1.57, 1.57, -1.57, -1.57, 0.0],
        &[1.0, -1.0, 1.0, -1.0, -1.0, 0.5],
    )
}

/// A trajectory of the UR5e with so many points, all at rest in one pose.
#[must_use]
pub fn good_check(point_count: u32) -> v1::CheckTrajectoryRequest {
    let points = (0..point_count).map(|index| v1::TrajectoryPoint {
        time_s: 0.01 * f64::from(index),
        position: vec![0.0, -1.57, 1.57, -1.57, -1.57, 0.0],
        velocity: vec![0.0; 6],
        acceleration: vec![0.0; 6],
    });
    v1::CheckTrajectoryRequest {
        robot_id: "ur5e".to_owned(),
        trajectory: Some(v1::Trajectory {
            points: points.collect(),
            interpolation: None,
        }),
        ..Default::default()
    }
}

/// So many states of the UR5e, for its torques.
#[must_use]
pub fn good_dynamics(state_count: usize) -> v1::InverseDynamicsRequest {
    let state = v1::JointState {
        position: vec![0.1; 6],
        velocity: vec![0.2; 6],
        acceleration: vec![0.3; 6],
    };
    v1::InverseDynamicsRequest {
        robot_id: "ur5e".to_owned(),
        states: vec![state; state_count],
        ..Default::default()
    }
}

/// A state of the UR5e, for its pose.
#[must_use]
pub fn good_pose() -> v1::ForwardKinematicsRequest {
    v1::ForwardKinematicsRequest {
        robot_id: "ur5e".to_owned(),
        states: vec![v1::JointPosition { position: vec![0.1; 6] }],
        ..Default::default()
    }
}

/// A pose of the UR5e, for its joint positions.
#[must_use]
pub fn good_target() -> v1::InverseKinematicsRequest {
    let pose = v1::Pose {
        position_m: vec![0.4, 0.2, 0.3],
        orientation: vec![0.0, 1.0, 0.0, 0.0],
    };
    v1::InverseKinematicsRequest {
        robot_id: "ur5e".to_owned(),
        targets: vec![v1::PoseTarget {
            pose: Some(pose),
            frame: None,
        }],
        ..Default::default()
    }
}

/// A program of the UR5e: above a part, down to it on a line, and back.
#[must_use]
pub fn good_program() -> v1::PlanPathRequest {
    use v1::path_segment::Shape;
    let down = |height_m: f64| v1::Target {
        pose: Some(v1::Pose {
            position_m: vec![0.45, 0.1, height_m],
            orientation: vec![0.0, 1.0, 0.0, 0.0],
        }),
        ..Default::default()
    };
    let home = vec![0.0, -1.57, 1.57, -1.57, -1.57, 0.0];
    let segment = |shape: Shape| v1::PathSegment {
        shape: Some(shape),
        ..Default::default()
    };
    let blend = v1::Blend {
        radius_m: Some(0.03),
        ..Default::default()
    };
    let line = |height_m: f64| {
        Shape::Line(v1::LineSegment {
            target: Some(down(height_m)),
        })
    };
    v1::PlanPathRequest {
        robot_id: "ur5e".to_owned(),
        start: Some(v1::JointPosition { position: home.clone() }),
        segments: vec![
            v1::PathSegment {
                blend: Some(blend),
                ..segment(Shape::Joint(v1::JointSegment {
                    target: Some(down(0.25)),
                }))
            },
            v1::PathSegment {
                dwell_s: Some(0.1),
                ..segment(line(0.15))
            },
            v1::PathSegment {
                blend: Some(blend),
                ..segment(line(0.25))
            },
            segment(Shape::Joint(v1::JointSegment {
                target: Some(v1::Target {
                    position: home,
                    ..Default::default()
                }),
            })),
        ],
        ..Default::default()
    }
}

/// A stream of the set-points of the good move.
#[must_use]
pub fn good_stream(sample_period_s: f64) -> v1::StreamSetpointsRequest {
    v1::StreamSetpointsRequest {
        robot_id: "ur5e".to_owned(),
        motion: Some(v1::stream_setpoints_request::Motion::Move(v1::PlanMoveRequest {
            robot_id: String::new(),
            ..good_move()
        })),
        sample_period_s: Some(sample_period_s),
        chunk_points: None,
    }
}
