//! Small arms whose motions can be worked out by hand, and random ones, for the unit tests of this crate.

use nalgebra::{Isometry3, Matrix3, UnitQuaternion, Vector3};

use crate::plan::request::MoveRequest;
use crate::robot::Robot;
use crate::robot::spec::{Drive, Friction, Inertial, JointKind, JointSpec, Limits, RobotSpec};

/// A pseudo-random number in [-1, 1] (SplitMix64): the same ones in every run.
pub(crate) fn random(state: &mut u64) -> f64 {
    *state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

pub(crate) fn values(count: usize, reach: f64, state: &mut u64) -> Vec<f64> {
    (0..count).map(|_| reach * random(state)).collect()
}

/// A mass of `mass` kg on a vertical slide: peak force 100 N, speed 2 m/s, no friction.
pub(crate) fn lift(mass: f64) -> RobotSpec {
    let body = Inertial {
        mass,
        ..Inertial::zero()
    };
    spec(vec![joint(
        "lift",
        JointKind::Prismatic,
        Isometry3::identity(),
        body,
        100.0,
        2.0,
    )])
}

/// Two links of 1 m in a vertical plane, each with its mass at its end.
pub(crate) fn planar() -> RobotSpec {
    let body = |mass| Inertial {
        mass,
        center_of_mass: Vector3::x(),
        inertia: Matrix3::identity() * 0.01,
    };
    // the axis is horizontal, so that gravity pulls the links down
    let shoulder = Isometry3::from_parts(
        Vector3::zeros().into(),
        UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::FRAC_PI_2),
    );
    let elbow = Isometry3::translation(1.0, 0.0, 0.0);
    spec(vec![
        joint("shoulder", JointKind::Revolute, shoulder, body(3.0), 120.0, 4.0),
        joint("elbow", JointKind::Revolute, elbow, body(2.0), 40.0, 5.0),
    ])
}

/// An arm with axes anywhere, every third joint prismatic, with drives and limits that bind.
pub(crate) fn random_arm(count: usize, seed: u64) -> RobotSpec {
    let state = &mut seed.clone();
    let vector = |state: &mut u64, reach: f64| Vector3::from(<[f64; 3]>::try_from(values(3, reach, state)).unwrap());
    let joints = (0..count)
        .map(|i| {
            let spread = Matrix3::from_fn(|_, _| 0.2 * random(state));
            let kind = if i % 3 == 2 {
                JointKind::Prismatic
            } else {
                JointKind::Revolute
            };
            let body = Inertial {
                mass: 1.5 + random(state),
                center_of_mass: vector(state, 0.2),
                inertia: spread * spread.transpose() + Matrix3::identity() * 0.02,
            };
            let placement = Isometry3::new(vector(state, 0.4), vector(state, 2.0));
            let mut joint = joint(&format!("joint_{i}"), kind, placement, body, 400.0, 3.0);
            joint.axis = vector(state, 1.0).normalize();
            joint.drive.gear_ratio = 40.0 * random(state);
            joint.drive.rotor_inertia = 1e-4;
            joint.drive.motor_friction = Friction {
                viscous: 1e-3,
                coulomb_positive: 0.02,
                coulomb_negative: 0.03,
                ..Friction::default()
            };
            joint
        })
        .collect();
    let mut spec = spec(joints);
    spec.link_from_tip = Isometry3::new(vector(state, 0.3), vector(state, 1.0));
    spec.gravity = Vector3::new(1.0, -2.0, -9.0);
    spec.payload = Inertial {
        mass: 2.0,
        center_of_mass: vector(state, 0.1),
        inertia: Matrix3::identity() * 0.03,
    };
    spec
}

/// The same arm with drives that rub in proportion to their load, to 9 %, and to the speed squared, to 3 % of the torque at
/// full speed.
pub(crate) fn loaded(mut spec: RobotSpec) -> RobotSpec {
    for joint in &mut spec.joints {
        let drive = &mut joint.drive;
        let (torque, speed) = (drive.peak_torque.unwrap(), joint.limits.velocity.unwrap());
        let ratio = drive.gear_ratio.abs();
        drive.motor_friction.load_coulomb = 0.05;
        drive.joint_friction.load_coulomb = 0.04;
        drive.motor_friction.quadratic = 0.01 * torque / (speed * speed * ratio * ratio * ratio);
        drive.joint_friction.quadratic = 0.02 * torque / (speed * speed);
    }
    spec
}

pub(crate) fn robot(spec: RobotSpec) -> Robot {
    Robot::new(spec, Vec::new()).unwrap()
}

/// A request with every default.
pub(crate) fn request(start: &[f64], target: &[f64]) -> MoveRequest {
    MoveRequest::new(start.to_vec(), target.to_vec())
}

fn joint(name: &str, kind: JointKind, placement: Isometry3<f64>, link: Inertial, torque: f64, speed: f64) -> JointSpec {
    JointSpec {
        name: name.to_owned(),
        kind,
        parent_from_joint: placement,
        axis: Vector3::z(),
        link,
        limits: Limits {
            position_lower: Some(-3.0),
            position_upper: Some(3.0),
            velocity: Some(speed),
            ..Limits::default()
        },
        drive: Drive {
            peak_torque: Some(torque),
            ..Drive::default()
        },
    }
}

fn spec(joints: Vec<JointSpec>) -> RobotSpec {
    RobotSpec {
        joints,
        link_from_tip: Isometry3::identity(),
        gravity: Vector3::new(0.0, 0.0, -10.0),
        payload: Inertial::zero(),
        tcp: Isometry3::identity(),
        frames: Vec::new(),
        uncertainty: None,
    }
}
