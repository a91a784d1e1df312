//! Three arms with drives, and a program for each: published bodies and limits, assumed drives where nobody publishes any.

#[path = "../../benches/common/vectors.rs"]
mod vectors;

use takt_motion::nalgebra::Matrix3;
use takt_motion::path::request::{PathRequest, Segment, Shape, Target};
use takt_motion::plan::request::LimitOverride;
use takt_motion::robot::Robot;
use takt_motion::robot::spec::{Friction, Inertial, JointSpec};

/// An arm and what it runs.
pub(crate) struct Arm {
    pub(crate) name: &'static str,
    pub(crate) robot: Robot,
    pub(crate) program: PathRequest,
}

/// What is assumed of a joint's drive, seen from the joint.
struct Assumed {
    /// kg m².
    rotor: f64,
    /// N m/rad.
    stiffness: f64,
    /// N m.
    coulomb: f64,
    /// N m s/rad.
    viscous: f64,
}

const RATIO: f64 = 100.0;

/// Part of the friction that is the motor's side's.
const MOTOR_PART: f64 = 0.75;

/// Damping of the transmission over its stiffness, s: 2 % of critical at 80 rad/s.
const DAMPING: f64 = 5.0e-4;

pub(crate) fn all() -> Vec<Arm> {
    let small = |torque| assumed(0.2, 5.0e3, 0.06 * torque);
    let big = |torque| assumed(1.5, 2.0e4, 0.06 * torque);
    let franka = |torque| assumed(0.6, 1.4e4, 0.03 * torque);
    let ur5e = [150.0, 150.0, 150.0].map(big).into_iter();
    let ur5e: Vec<Assumed> = ur5e.chain([28.0, 28.0, 28.0].map(small)).collect();
    let fr3 = [87.0, 87.0, 87.0, 87.0].map(franka).into_iter();
    let fr3: Vec<Assumed> = fr3.chain([12.0, 12.0, 12.0].map(small)).collect();
    vec![
        arm(
            "ur5e",
            &ur5e,
            &[0.0, -1.6, 1.4, -1.4, -1.57, 0.0],
            &[1.2, -1.0, 0.9, -0.9, 0.6, 1.0],
        ),
        arm(
            "fr3",
            &fr3,
            &[0.0, -0.5, 0.0, -2.0, 0.0, 1.6, 0.8],
            &[0.9, 0.8, -0.6, 0.8, 0.8, 0.9, -1.0],
        ),
        arm(
            "puma560",
            &[],
            &[0.0, 0.8, -1.2, 0.3, 0.6, 0.0],
            &[0.8, -0.7, 0.6, 0.8, -0.9, 1.0],
        ),
    ]
}

/// A drive whose viscous friction at 3 rad/s is its Coulomb friction.
fn assumed(rotor: f64, stiffness: f64, coulomb: f64) -> Assumed {
    Assumed {
        rotor,
        stiffness,
        coulomb,
        viscous: coulomb / 3.0,
    }
}

fn arm(name: &'static str, assumed: &[Assumed], start: &[f64], way: &[f64]) -> Arm {
    let resolved = vectors::resolved(name);
    let mut spec = resolved.spec;
    for (joint, assumed) in spec.joints.iter_mut().zip(assumed) {
        assume(joint, assumed);
    }
    if assumed.is_empty() {
        corke(&mut spec.joints);
    }
    spec.payload = Inertial {
        mass: 1.5,
        center_of_mass: [0.0, 0.0, 0.06].into(),
        inertia: Matrix3::identity() * 3.0e-3,
    };
    let names: Vec<String> = spec.joints.iter().map(|joint| joint.name.clone()).collect();
    let robot = Robot::new(spec, resolved.warnings).expect("the arm is sound");
    Arm {
        name,
        robot,
        program: program(&names, start, way),
    }
}

fn assume(joint: &mut JointSpec, assumed: &Assumed) {
    let drive = &mut joint.drive;
    drive.gear_ratio = RATIO;
    drive.rotor_inertia = assumed.rotor / (RATIO * RATIO);
    drive.torque_constant = Some(0.1);
    drive.stiffness = vec![assumed.stiffness];
    drive.damping = Some(DAMPING * assumed.stiffness);
    drive.motor_friction = Friction {
        viscous: MOTOR_PART * assumed.viscous / (RATIO * RATIO),
        coulomb_positive: MOTOR_PART * assumed.coulomb / RATIO,
        coulomb_negative: MOTOR_PART * assumed.coulomb / RATIO,
        ..Friction::default()
    };
    let rest = 1.0 - MOTOR_PART;
    drive.joint_friction = Friction {
        viscous: rest * assumed.viscous,
        coulomb_positive: rest * assumed.coulomb,
        coulomb_negative: rest * assumed.coulomb,
        ..Friction::default()
    };
}

/// The PUMA 560's published drives (Corke and Armstrong-Hélouvry 1994; peak torques Armstrong, Khatib and Burdick 1986): gear ratio, rotor inertia,
/// viscous and Coulomb friction at the motor, peak torque at the joint. Its stiffness is assumed.
fn corke(joints: &mut [JointSpec]) {
    let published = [
        (-62.6111, 200e-6, 1.48e-3, 0.395, 0.435, 97.6),
        (107.815, 200e-6, 0.817e-3, 0.126, 0.071, 186.4),
        (-53.7063, 200e-6, 1.38e-3, 0.132, 0.105, 89.4),
        (76.0364, 33e-6, 71.2e-6, 11.2e-3, 16.9e-3, 24.2),
        (71.923, 33e-6, 82.6e-6, 9.26e-3, 14.5e-3, 20.1),
        (76.686, 33e-6, 36.7e-6, 3.96e-3, 10.5e-3, 21.3),
    ];
    let stiffness = [5.0e4, 6.0e4, 3.0e4, 5.0e3, 5.0e3, 5.0e3];
    for ((joint, (ratio, rotor, viscous, positive, negative, peak)), stiffness) in
        joints.iter_mut().zip(published).zip(stiffness)
    {
        let drive = &mut joint.drive;
        drive.gear_ratio = ratio;
        drive.rotor_inertia = rotor;
        drive.peak_torque = Some(peak);
        drive.stiffness = vec![stiffness];
        drive.damping = Some(DAMPING * stiffness);
        drive.motor_friction = Friction {
            viscous,
            coulomb_positive: positive,
            coulomb_negative: negative,
            ..Friction::default()
        };
    }
}

/// There, part of the way back, and there again: joints turn round twice. The jerk is limited, so that transmissions can follow.
fn program(names: &[String], start: &[f64], way: &[f64]) -> PathRequest {
    let at = |part: f64| -> Vec<f64> { start.iter().zip(way).map(|(q, way)| q + part * way).collect() };
    let to = |part: f64| {
        Segment::new(Shape::Joint {
            target: Target::Joints(at(part)),
        })
    };
    let limits = names.iter().map(|name| LimitOverride {
        joint: name.clone(),
        velocity: Some(1.5),
        acceleration: Some(8.0),
        jerk: Some(150.0),
        ..LimitOverride::default()
    });
    PathRequest {
        limits: limits.collect(),
        torque_utilization: 0.7,
        ..PathRequest::new(start.to_vec(), vec![to(1.0), to(0.4), to(0.9)])
    }
}
