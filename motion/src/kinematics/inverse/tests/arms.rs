//! The arms that inverse kinematics is tested with.

use std::f64::consts::{FRAC_PI_2, PI};

use nalgebra::{Isometry3, Matrix3, Vector3};

use crate::robot::Robot;
use crate::robot::description::{Description, DhConvention, DhLink, Kinematics};
use crate::robot::spec::{Inertial, JointKind, RobotSpec};

pub(super) fn ur5e() -> Robot {
    from_urdf(
        include_str!("../../../../../tests/vectors/robots/ur5e/ur5e.urdf"),
        "world",
        "tool0",
    )
}

pub(super) fn puma() -> Robot {
    from_urdf(
        include_str!("../../../../../tests/vectors/robots/puma560/puma560.urdf"),
        "base_link",
        "flange",
    )
}

pub(super) fn fr3() -> Robot {
    from_urdf(
        include_str!("../../../../../tests/vectors/robots/fr3/fr3.urdf"),
        "base",
        "fr3_link8",
    )
}

fn from_urdf(text: &str, base: &str, tip: &str) -> Robot {
    let link = |name: &str| (!name.is_empty()).then(|| name.to_owned());
    build(Kinematics::Urdf {
        text: text.to_owned(),
        base_link: link(base),
        tip_link: link(tip),
    })
}

fn build(kinematics: Kinematics) -> Robot {
    let description = Description::new(kinematics);
    Robot::new(description.resolve().unwrap().spec, Vec::new()).unwrap()
}

/// A standard DH table of (a, α, d, θ), or of a slide where `prismatic`.
pub(super) fn dh(table: &[(f64, f64, f64, f64, bool)]) -> Robot {
    let links = table.iter().enumerate();
    let links = links.map(|(i, &(a, alpha, d, theta, prismatic))| DhLink {
        name: format!("joint_{i}"),
        prismatic,
        a,
        alpha,
        d,
        theta,
        mass: 1.0,
        center_of_mass: Vector3::zeros(),
        inertia: Matrix3::identity() * 0.01,
    });
    build(Kinematics::Dh {
        convention: DhConvention::Standard,
        links: links.collect(),
    })
}

/// Four joints: turn, turn, slide, turn; 0.35 m and 0.3 m long.
pub(super) fn scara() -> Robot {
    let arm = dh(&[
        (0.35, 0.0, 0.4, 0.0, false),
        (0.30, PI, 0.0, 0.0, false),
        (0.0, 0.0, 0.0, 0.0, true),
        (0.0, 0.0, 0.05, 0.0, false),
    ]);
    with_ranges(&arm, &[(-2.3, 2.3), (-2.5, 2.5), (0.0, 0.2), (-PI, PI)])
}

/// An arm whose last two axes miss each other by 0.07 m: no wrist centre, no three parallel axes.
pub(super) fn offset_wrist() -> Robot {
    dh(&[
        (0.1, FRAC_PI_2, 0.3, 0.0, false),
        (0.4, 0.3, 0.0, 0.0, false),
        (0.05, FRAC_PI_2, 0.1, 0.0, false),
        (0.03, -FRAC_PI_2, 0.35, 0.0, false),
        (0.07, FRAC_PI_2, 0.0, 0.0, false),
        (0.0, 0.0, 0.1, 0.0, false),
    ])
}

pub(super) fn with_ranges(robot: &Robot, ranges: &[(f64, f64)]) -> Robot {
    let mut spec = robot.spec().clone();
    for (joint, &(lower, upper)) in spec.joints.iter_mut().zip(ranges) {
        joint.limits.position_lower = Some(lower);
        joint.limits.position_upper = Some(upper);
    }
    Robot::new(spec, Vec::new()).unwrap()
}

/// Turning joints about lines in base-link axes, each through a point along a direction; frames stand askew.
pub(super) fn about_lines(lines: &[[Vector3<f64>; 2]; 6], state: &mut u64) -> Robot {
    let mut vector = |reach: f64| Vector3::from_fn(|_, _| reach * crate::test_arms::random(state));
    let mut joints = crate::test_arms::random_arm(lines.len(), 1).joints;
    let mut base_from_before = Isometry3::identity();
    for (joint, [point, axis]) in joints.iter_mut().zip(lines) {
        // any frame on the line will do: shifted along it and turned
        let axis = axis.normalize();
        let on_line = point + axis * vector(0.2).x;
        let base_from_joint = Isometry3::new(on_line, vector(1.5));
        joint.kind = JointKind::Revolute;
        joint.parent_from_joint = base_from_before.inverse() * base_from_joint;
        joint.axis = base_from_joint.inverse() * axis;
        base_from_before = base_from_joint;
    }
    let spec = RobotSpec {
        joints,
        link_from_tip: Isometry3::new(vector(0.2), vector(1.5)),
        gravity: Vector3::zeros(),
        payload: Inertial::zero(),
        tcp: Isometry3::identity(),
        frames: Vec::new(),
        uncertainty: None,
    };
    Robot::new(spec, Vec::new()).unwrap()
}
