//! Seeded mutations of good inputs, through everything that reads what callers send: the functions that the fuzz targets
//! run, on a few thousand inputs each, in every run of the tests. None of them may panic.

#[allow(unreachable_pub, reason = "another crate's file")]
#[path = "../../fuzz/src/targets.rs"]
mod targets;

use prost::Message;
use takt_checker::draw::Draw;
use takt_proto::v1;
use takt_tests::{
    fixtures::{example, plan_move, registration, text},
    telemetry::Reporter,
};

/// Mutations of each seed.
const ROUNDS: usize = 1500;

/// What is put into texts: what has a meaning there, and what should have none.
const WORDS: [&[u8]; 24] = [
    b"<",
    b">",
    b"/>",
    b"<!DOCTYPE",
    b"&a;",
    b"]]>",
    b"\"",
    b"'",
    b"{",
    b"}",
    b"[",
    b"]",
    b",",
    b":",
    b"null",
    b"NaN",
    b"1e999",
    b"-0",
    b"\\ud800",
    b"\xff",
    b"\x00",
    b"1e-320",
    b"99999999999999999999",
    b"\xe2\x80\xae",
];

/// A few changes of the bytes: bits, numbers, words, pieces cut out, doubled or moved.
fn mutated(draw: &mut Draw, seed: &[u8]) -> Vec<u8> {
    let mut bytes = seed.to_vec();
    for _ in 0..=draw.bits() % 4 {
        let length = bytes.len().max(1) as u64;
        let at = ((draw.bits() % length) as usize).min(bytes.len());
        let end = (at + (draw.bits() % 24) as usize).min(bytes.len());
        match draw.bits() % 8 {
            0 if at < bytes.len() => bytes[at] ^= 1 << (draw.bits() % 8),
            1 if at < bytes.len() => bytes[at] = draw.bits() as u8,
            2 => {
                let word = WORDS[(draw.bits() % WORDS.len() as u64) as usize];
                bytes.splice(at..at, word.iter().copied());
            }
            3 => {
                let word = WORDS[(draw.bits() % WORDS.len() as u64) as usize];
                bytes.splice(at..end, word.iter().copied());
            }
            4 => drop(bytes.drain(at..end)),
            5 => {
                let piece = bytes[at..end].to_vec();
                bytes.splice(at..at, piece);
            }
            6 => {
                // Eight bytes are a double where the message has one.
                let value = f64::from_bits(draw.bits()).to_le_bytes();
                let end = (at + 8).min(bytes.len());
                bytes[at..end].copy_from_slice(&value[..end - at]);
            }
            _ => bytes.truncate(at),
        }
    }
    bytes
}

/// Runs a target on mutations of seeds, and on the seeds themselves.
fn run(seed: u64, target: fn(&[u8]), inputs: &[Vec<u8>]) {
    let mut draw = Draw::seeded(seed);
    for input in inputs {
        target(input);
        for _ in 0..ROUNDS {
            let bytes = mutated(&mut draw, input);
            let outcome = std::panic::catch_unwind(|| target(&bytes));
            assert!(outcome.is_ok(), "{:?}", String::from_utf8_lossy(&bytes));
        }
    }
}

/// The same message in both encodings.
fn encodings<M: Message + serde::Serialize>(message: &M) -> [Vec<u8>; 2] {
    let json = serde_json::to_vec(message).expect("a message can be written");
    [message.encode_to_vec(), json]
}

const SLIDE: &str = "<robot name='r'>\n<link name='base'/>\n<link name='cart'><inertial><origin xyz='0 0 1' rpy='0 0 0'/>\
    <mass value='2'/><inertia ixx='0.1' ixy='0' ixz='0' iyy='0.1' iyz='0' izz='0.1'/></inertial></link>\n\
    <joint name='j' type='prismatic'><parent link='base'/><child link='cart'/><axis xyz='0 1 0'/>\
    <limit lower='-1' upper='1' effort='10' velocity='2'/><dynamics damping='1' friction='2'/>\
    <mimic joint='k' multiplier='2'/></joint><!-- c --></robot>";

#[test]
fn urdfs_are_read_or_refused() {
    let arm = text("tests/vectors/robots/ur5e/ur5e.urdf");
    run(
        1,
        targets::urdf,
        &[SLIDE.into(), SLIDE.replace("<mimic", "<x").into(), arm.into()],
    );
}

#[test]
fn registrations_are_read_or_refused() {
    let urdf = v1::RegisterRobotRequest {
        description: Some(v1::RobotDescription {
            urdf: SLIDE.replace("<mimic", "<x"),
            ..Default::default()
        }),
        ..Default::default()
    };
    let scara = v1::RegisterRobotRequest {
        description: Some(example("scara")),
        ..urdf.clone()
    };
    let inputs = [
        encodings(&registration("arm", 5.0)),
        encodings(&urdf),
        encodings(&scara),
    ]
    .concat();
    run(2, targets::register_robot, &inputs);
}

#[test]
fn moves_are_planned_or_refused() {
    let plain = plan_move("scara", &[-1.0, 1.0, 0.1, 0.0], &[1.0, -1.0, 0.15, 2.0]);
    let full = v1::PlanMoveRequest {
        target_velocity: vec![1.0, 2.0, 0.5, 3.0],
        payload: Some(v1::Payload {
            mass_kg: Some(1.0),
            center_of_mass_m: vec![0.0, 0.0, 0.1],
            inertia_kg_m2: vec![0.01, 0.01, 0.01, 0.0, 0.0, 0.0],
        }),
        limits: vec![v1::LimitOverride {
            joint: "elbow".to_owned(),
            velocity: Some(2.0),
            peak_torque: Some(50.0),
            ..Default::default()
        }],
        torque_utilization: Some(0.9),
        speed_scale: Some(0.5),
        method: Some(1),
        sample_period_s: Some(0.1),
        cycle_time_s: Some(20.0),
        ..plain.clone()
    };
    run(3, targets::plan_move, &[encodings(&plain), encodings(&full)].concat());
}

#[test]
fn programs_are_planned_or_refused() {
    use v1::path_segment::Shape;
    let target = |x_m: f64| v1::Target {
        pose: Some(v1::Pose {
            position_m: vec![x_m, 0.2, 0.1],
            orientation: vec![1.0, 0.0, 0.0, 0.0],
        }),
        ..Default::default()
    };
    let segment = |shape: Shape| v1::PathSegment {
        shape: Some(shape),
        ..Default::default()
    };
    let arc = v1::ArcSegment {
        via: Some(target(0.42)),
        target: Some(target(0.4)),
        ..Default::default()
    };
    let spline = v1::SplineSegment {
        points: vec![target(0.35), target(0.3)],
        ..Default::default()
    };
    let joints = v1::Target {
        position: vec![0.5, 0.5, 0.1, 0.0],
        ..Default::default()
    };
    let request = v1::PlanPathRequest {
        start: Some(v1::JointPosition {
            position: vec![-1.0, 1.0, 0.1, 0.0],
        }),
        segments: vec![
            v1::PathSegment {
                blend: Some(v1::Blend {
                    radius_m: Some(0.02),
                    ..Default::default()
                }),
                ..segment(Shape::Joint(v1::JointSegment { target: Some(joints) }))
            },
            segment(Shape::Line(v1::LineSegment {
                target: Some(target(0.4)),
            })),
            segment(Shape::Arc(arc)),
            segment(Shape::Spline(spline)),
        ],
        speed_scale: Some(0.5),
        sample_period_s: Some(0.1),
        ..Default::default()
    };
    run(7, targets::plan_path, &encodings(&request));
}

#[test]
fn trajectories_are_checked_or_refused() {
    let point = |time_s: f64, position: f64| v1::TrajectoryPoint {
        time_s,
        position: vec![position, 0.0, 0.1, 0.0],
        velocity: vec![0.1; 4],
        acceleration: vec![0.0; 4],
    };
    let request = v1::CheckTrajectoryRequest {
        trajectory: Some(v1::Trajectory {
            points: vec![point(0.0, 0.0), point(0.5, 0.1), point(1.0, 0.3)],
            interpolation: Some(2),
        }),
        torque_utilization: Some(0.9),
        cycle_time_s: Some(2.0),
        ..Default::default()
    };
    run(4, targets::check_trajectory, &encodings(&request));
}

#[test]
fn states_are_computed_or_refused() {
    let state = v1::JointState {
        position: vec![0.1, -0.2, 0.1, 0.4],
        velocity: vec![1.0; 4],
        acceleration: vec![2.0; 4],
    };
    let torques = v1::InverseDynamicsRequest {
        states: vec![state.clone(), state],
        payload: Some(v1::Payload {
            mass_kg: Some(1.0),
            ..Default::default()
        }),
        r#return: vec![1, 2],
        ..Default::default()
    };
    run(5, targets::inverse_dynamics, &encodings(&torques));
    let poses = v1::ForwardKinematicsRequest {
        states: vec![v1::JointPosition {
            position: vec![0.1, -0.2, 0.1, 0.4],
        }],
        tool: Some(v1::Tool {
            tcp: Some(v1::Pose {
                position_m: vec![0.0, 0.0, 0.2],
                orientation: vec![0.0, 0.0, 0.0, 1.0],
            }),
        }),
        ..Default::default()
    };
    run(6, targets::forward_kinematics, &encodings(&poses));
    let solved = v1::InverseKinematicsRequest {
        targets: vec![v1::PoseTarget {
            pose: Some(v1::Pose {
                position_m: vec![0.4, 0.2, 0.1],
                orientation: vec![1.0, 0.0, 0.0, 0.0],
            }),
            frame: None,
        }],
        reference: Some(v1::JointPosition {
            position: vec![0.1, -0.2, 0.1, 0.4],
        }),
        ..Default::default()
    };
    run(8, targets::inverse_kinematics, &encodings(&solved));
}

#[test]
fn telemetry_is_read_or_refused() {
    use v1::estimate_friction_request::Part;
    let message = |part| v1::EstimateFrictionRequest {
        robot_id: "scara".to_owned(),
        part: Some(part),
    };
    let mut block = Reporter::default().block(20);
    // Of the arm that has four joints, by their places.
    block.joints.truncate(4);
    block.joints.iter_mut().for_each(|joint| joint.joint.clear());
    let header = v1::EstimateHeader {
        method: Some(3),
        terms: Some(v1::FrictionTerms {
            by_direction: Some(true),
            load: Some(true),
            quadratic: Some(true),
        }),
        half_life_s: Some(10.0),
        bandwidth_hz: Some(20.0),
        prior: vec![v1::FrictionPrior {
            joint: "elbow".to_owned(),
            mean: vec![1.0, 1.0, 2.0, 0.1, 0.01],
            covariance: vec![
                1.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0,
            ],
        }],
        ..Default::default()
    };
    let inputs = [
        encodings(&message(Part::Header(header))),
        encodings(&message(Part::Telemetry(block))),
    ]
    .concat();
    run(9, targets::estimate_friction, &inputs);
}

#[test]
fn rehearsals_are_run_or_refused() {
    let request = v1::RehearseRequest {
        motion: Some(v1::rehearse_request::Motion::Move(plan_move(
            "scara",
            &[-1.0, 1.0, 0.1, 0.0],
            &[-0.9, 1.0, 0.1, 0.0],
        ))),
        friction: vec![v1::FrictionTruth {
            coulomb_scale: Some(1.5),
            ..Default::default()
        }],
        encoders: vec![v1::Encoder {
            joint: "elbow".to_owned(),
            motor_step: Some(1e-4),
            motor_noise: Some(1e-5),
            ..Default::default()
        }],
        wrenches: vec![v1::WrenchPulse {
            begin_s: 0.1,
            end_s: 0.2,
            force_n: vec![10.0, 0.0, 0.0],
            moment_n_m: Vec::new(),
        }],
        trace_every: Some(10),
        ..Default::default()
    };
    run(10, targets::rehearse, &encodings(&request));
}

/// Recorded torques and positions of an arm with four joints that swing for some seconds.
fn recorded() -> v1::Telemetry {
    let times: Vec<f64> = (0..240).map(|index| 0.02 * f64::from(index)).collect();
    let column = |of: &dyn Fn(f64) -> f64| times.iter().map(|time| of(*time)).collect::<Vec<_>>();
    let joints = (1..=4).map(|joint| {
        let rate = 0.8 + 0.3 * f64::from(joint);
        v1::TelemetryColumns {
            position: column(&|time| 0.1 + 0.08 * (rate * time).sin()),
            torque: column(&|time| 2.0 * (rate * time).cos().signum() - (rate * time).sin()),
            ..Default::default()
        }
    });
    v1::Telemetry {
        joints: joints.collect(),
        time_s: times.clone(),
    }
}

#[test]
fn fits_are_made_or_refused() {
    use v1::fit_drive_request::Fit;
    let request = |fit| v1::FitDriveRequest {
        robot_id: "scara".to_owned(),
        fit: Some(fit),
        ..Default::default()
    };
    let joint = || "elbow".to_owned();
    let motion = v1::MotionFitRequest {
        recording: Some(recorded()),
        identify: Some(v1::TimeRange {
            begin_s: 0.0,
            end_s: 3.0,
        }),
        test: Some(v1::TimeRange {
            begin_s: 3.2,
            end_s: 4.7,
        }),
        scope: Some(1),
        ..Default::default()
    };
    let stiffness = v1::StiffnessFitRequest {
        joint: joint(),
        torque: vec![-20.0, -10.0, 5.0, 10.0, 20.0],
        deformation: vec![-1e-3, -5e-4, 2.5e-4, 5e-4, 1e-3],
        terms: Some(2),
    };
    let damping = v1::DampingFitRequest {
        joint: joint(),
        time_s: vec![0.0, 0.05, 0.1, 0.15],
        amplitude: vec![1e-3, 7e-4, 5e-4, 3.4e-4],
    };
    let run_at = |speed: f64| v1::ConstantSpeedRun {
        speed,
        motor_torque: 3.0 * speed.signum() + 2.0 * speed,
        deformation: Some(1e-4 * speed.signum()),
    };
    let constant_speed = v1::ConstantSpeedFitRequest {
        joint: joint(),
        runs: [-1.0, -0.5, -0.2, 0.2, 0.5, 1.0].map(run_at).to_vec(),
    };
    let inputs = [
        encodings(&request(Fit::Motion(motion))),
        encodings(&request(Fit::Stiffness(stiffness))),
        encodings(&request(Fit::Damping(damping))),
        encodings(&request(Fit::ConstantSpeed(constant_speed))),
    ]
    .concat();
    run(11, targets::fit_drive, &inputs);
}
