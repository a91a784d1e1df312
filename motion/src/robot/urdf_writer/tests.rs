use nalgebra::{Isometry3, Matrix3, Vector3};
use proptest::prelude::*;

use super::write;
use crate::robot::rotation;
use crate::robot::spec::{Drive, Friction, Inertial, JointKind, JointSpec, Limits, RobotSpec};
use crate::robot::urdf::{self, Options};

/// Roll, pitch and yaw there and back, rad.
const TOLERANCE: f64 = 1e-14;

fn joint(name: &str, kind: JointKind) -> JointSpec {
    let is_ranged = kind != JointKind::Continuous;
    JointSpec {
        name: name.to_owned(),
        kind,
        parent_from_joint: rotation::pose(
            Vector3::new(0.1, -0.2, 1.0 / 3.0),
            rotation::from_roll_pitch_yaw(&Vector3::new(0.3, -1.1, 2.5)),
        ),
        axis: Vector3::new(0.0, 0.6, -0.8),
        link: Inertial {
            mass: 2.5,
            center_of_mass: Vector3::new(0.01, 0.02, -0.03),
            inertia: Matrix3::new(0.02, 1e-3, -2e-3, 1e-3, 0.03, 3e-3, -2e-3, 3e-3, 0.025),
        },
        limits: Limits {
            position_lower: is_ranged.then_some(-1.5),
            position_upper: is_ranged.then_some(0.7),
            velocity: Some(3.0),
            acceleration: Some(10.0),
            deceleration: Some(12.0),
            jerk: Some(500.0),
            ..Limits::default()
        },
        drive: Drive {
            peak_torque: Some(87.0),
            joint_friction: Friction {
                viscous: 0.5,
                coulomb_positive: 1.5,
                coulomb_negative: 1.5,
                ..Friction::default()
            },
            ..Drive::default()
        },
    }
}

fn robot(joints: Vec<JointSpec>) -> RobotSpec {
    RobotSpec {
        joints,
        link_from_tip: rotation::pose(
            Vector3::new(0.0, 0.0, 0.107),
            rotation::from_roll_pitch_yaw(&Vector3::new(0.0, 0.0, -0.785)),
        ),
        gravity: Vector3::zeros(),
        payload: Inertial::zero(),
        tcp: Isometry3::identity(),
        frames: Vec::new(),
        uncertainty: None,
    }
}

fn read_back(spec: &RobotSpec) -> Result<RobotSpec, String> {
    let text = write(spec, "arm");
    let options = Options {
        use_dynamics: true,
        ..Options::default()
    };
    let (chain, _) = urdf::read(&text, &options).map_err(|errors| format!("{errors:?}\n{text}"))?;
    Ok(RobotSpec {
        joints: chain.joints,
        link_from_tip: chain.link_from_tip,
        ..spec.clone()
    })
}

fn check_same(actual: &RobotSpec, expected: &RobotSpec) {
    check_pose(&actual.link_from_tip, &expected.link_from_tip);
    assert_eq!(actual.joints.len(), expected.joints.len());
    for (actual, expected) in actual.joints.iter().zip(&expected.joints) {
        check_pose(&actual.parent_from_joint, &expected.parent_from_joint);
        assert!((actual.axis - expected.axis).norm() < TOLERANCE);
        let but_for_rounding = JointSpec {
            parent_from_joint: expected.parent_from_joint,
            axis: expected.axis,
            ..actual.clone()
        };
        assert_eq!(&but_for_rounding, expected);
    }
}

fn check_pose(actual: &Isometry3<f64>, expected: &Isometry3<f64>) {
    assert_eq!(actual.translation, expected.translation);
    assert!(
        actual.rotation.rotation_to(&expected.rotation).vector().norm() < TOLERANCE,
        "{actual} {expected}"
    );
}

#[test]
fn every_kind_of_joint_comes_back() {
    let spec = robot(vec![
        joint("a", JointKind::Revolute),
        joint("b", JointKind::Continuous),
        joint("c", JointKind::Prismatic),
    ]);
    check_same(&read_back(&spec).unwrap(), &spec);
}

#[test]
fn what_is_unknown_stays_unknown() {
    let mut spec = robot(vec![joint("a", JointKind::Prismatic), joint("b", JointKind::Prismatic)]);
    spec.joints[0].limits = Limits::default();
    spec.joints[0].drive = Drive::default();
    spec.joints[1].limits.position_lower = None;
    check_same(&read_back(&spec).unwrap(), &spec);
}

#[test]
fn a_revolute_joint_without_range_comes_back_as_continuous() {
    let mut spec = robot(vec![joint("a", JointKind::Revolute)]);
    spec.joints[0].limits.position_lower = None;
    spec.joints[0].limits.position_upper = None;
    let back = read_back(&spec).unwrap();
    assert_eq!(back.joints[0].kind, JointKind::Continuous);
}

#[test]
fn names_may_hold_anything_and_clash_with_ours() {
    let spec = robot(vec![
        joint("base", JointKind::Revolute),
        joint("tip", JointKind::Revolute),
        joint("<a & \"b\">\t'é'\n", JointKind::Revolute),
    ]);
    check_same(&read_back(&spec).unwrap(), &spec);
}

proptest! {
    #[test]
    fn any_rotation_comes_back(rpy in [-4.0..4.0_f64, -4.0..4.0, -4.0..4.0], beside in prop::option::of(-20..-1_i32)) {
        let mut spec = robot(vec![joint("a", JointKind::Revolute)]);
        // At a right angle, and ever closer to it, roll and yaw are hard to tell apart.
        let near = |exponent: i32| std::f64::consts::FRAC_PI_2 - 10.0_f64.powi(exponent);
        let pitch = beside.map_or(rpy[1], near);
        let rotation = rotation::from_roll_pitch_yaw(&Vector3::new(rpy[0], pitch, rpy[2]));
        spec.joints[0].parent_from_joint.rotation = rotation;
        check_same(&read_back(&spec).unwrap(), &spec);
    }
}
