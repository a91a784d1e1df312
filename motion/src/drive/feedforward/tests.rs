//! Feed-forward against finite differences of its own positions, and against inverse dynamics.

use super::*;
use crate::dynamics::{self, Workspace};
use crate::robot::spec::{Friction, RobotSpec};
use crate::test_arms::{self, random};

/// An arm whose every joint flexes, with friction on either side.
fn elastic(seed: u64) -> RobotSpec {
    let mut spec = test_arms::random_arm(6, seed);
    let state = &mut (seed + 50);
    for joint in &mut spec.joints {
        joint.drive.rotor_inertia = 1e-3;
        joint.drive.gear_ratio = 30.0 + 10.0 * random(state);
        let linear = 1.5e4 + 5.0e3 * random(state);
        joint.drive.stiffness = vec![linear, 1.0e7 * random(state)];
        joint.drive.torque_constant = Some(0.2);
        joint.drive.joint_friction = Friction {
            viscous: 2.0,
            coulomb_positive: 3.0,
            coulomb_negative: 4.0,
            load_coulomb: 0.05,
            quadratic: 0.3,
            presliding_stiffness: None,
        };
    }
    spec
}

/// Sines that keep every joint moving one way for a second, with all derivatives.
fn sines(count: usize, times: &[f64], seed: u64) -> Reference {
    let state = &mut (seed + 90);
    let waves: Vec<[f64; 3]> = (0..count)
        .map(|_| [0.5 * random(state), 0.8 * random(state), random(state)])
        .collect();
    let states = times.iter().flat_map(|t| {
        waves.iter().map(move |[mean, reach, phase]| {
            let w = 1.3;
            let (sin, cos) = (libm::sin(w * t + 0.2 * phase), libm::cos(w * t + 0.2 * phase));
            [
                mean + reach * sin,
                reach * w * cos,
                -reach * w * w * sin,
                -reach * w * w * w * cos,
                reach * w * w * w * w * sin,
            ]
        })
    });
    Reference {
        joint_count: count,
        period: 1.0e-3,
        duration: 1.0,
        states: states.collect(),
        smooth: vec![true; times.len()],
        continuity: 3,
        payload: None,
        warnings: Vec::new(),
    }
}

fn feed(robot: &Robot, reference: &Reference) -> FeedForward {
    feed_forward(robot, reference, &Budget::unlimited()).unwrap().unwrap()
}

/// The motor's speed and acceleration are the differences of its position, over a hundred random states.
#[test]
fn the_motor_moves_as_its_position_does() {
    let h = 1.0e-4;
    for seed in 0..20 {
        let robot = test_arms::robot(elastic(seed));
        for at in [0.1, 0.3, 0.45, 0.6, 0.8] {
            let reference = sines(6, &[at - h, at, at + h], seed);
            let found = feed(&robot, &reference);
            for joint in 0..6 {
                let position = |k: usize| found.step(k)[joint].position + found.step(k)[joint].deformation;
                let velocity = (position(2) - position(0)) / (2.0 * h);
                let acceleration = (position(2) - 2.0 * position(1) + position(0)) / (h * h);
                let middle = &found.step(1)[joint];
                let scale = 1.0 + velocity.abs();
                assert!(
                    (middle.motor_velocity - velocity).abs() < 1e-7 * scale,
                    "{seed} {joint}"
                );
                // rounding of the position over h² bounds what a difference can say
                assert!(
                    (middle.motor_acceleration - acceleration).abs() < 5e-6 * scale,
                    "{seed} {joint}"
                );
                assert!((middle.motor_velocity - middle.velocity).abs() > 1e-9, "it does flex");
            }
        }
    }
}

/// Eq 10 and 12, term by term, from the public dynamics.
#[test]
fn torques_are_those_of_the_arm_and_of_the_motor() {
    for seed in 0..10 {
        let robot = test_arms::robot(elastic(seed));
        let reference = sines(6, &[0.4], seed);
        let found = feed(&robot, &reference);
        let workspace = &mut Workspace::new(&robot);
        let [q, qd, qdd]: [Vec<f64>; 3] =
            std::array::from_fn(|order| reference.at(0).iter().map(|state| state[order]).collect());
        let (mut rigid, mut gravity) = (vec![0.0; 6], vec![0.0; 6]);
        dynamics::rigid_torque(&robot, workspace, &q, &qd, &qdd, &mut rigid);
        dynamics::gravity_torque(&robot, workspace, &q, &mut gravity);
        for joint in 0..6 {
            let at = &found.step(0)[joint];
            let drive = &robot.spec().joints[joint].drive;
            let coulomb = if qd[joint] > 0.0 { 3.0 } else { 4.0 };
            let output = 2.0 * qd[joint]
                + 0.3 * qd[joint] * qd[joint].abs()
                + (coulomb + 0.05 * gravity[joint].abs()) * qd[joint].signum();
            let through = rigid[joint] + output;
            assert!((at.transmission_torque - through).abs() < 1e-9 * (1.0 + through.abs()));
            let (ratio, motor) = (drive.gear_ratio, &drive.motor_friction);
            let coulomb = if at.motor_velocity > 0.0 {
                motor.coulomb_positive
            } else {
                motor.coulomb_negative
            };
            let friction =
                ratio * ratio * motor.viscous * at.motor_velocity + ratio * coulomb * at.motor_velocity.signum();
            let torque = ratio * ratio * drive.rotor_inertia * at.motor_acceleration + through + friction;
            assert!((at.motor_torque - torque).abs() < 1e-9 * (1.0 + torque.abs()));
            assert!((at.motor_current.unwrap() * 0.2 * ratio - torque).abs() < 1e-9 * (1.0 + torque.abs()));
            let cubic = drive.stiffness[0] * at.deformation + drive.stiffness[1] * at.deformation.powi(3);
            assert!((cubic - through).abs() < 1e-9 * (1.0 + through.abs()));
        }
    }
}

/// Without stiffness it is the torque that the planner and the verifier know.
#[test]
fn a_rigid_arm_has_the_torque_of_its_plan() {
    let robot = test_arms::robot(test_arms::random_arm(6, 3));
    let reference = sines(6, &[0.4], 3);
    let found = feed(&robot, &reference);
    let [q, qd, qdd]: [Vec<f64>; 3] =
        std::array::from_fn(|order| reference.at(0).iter().map(|state| state[order]).collect());
    let mut torque = vec![0.0; 6];
    dynamics::drive_torque(&robot, &mut Workspace::new(&robot), &q, &qd, &qdd, &mut torque);
    for (at, torque) in found.step(0).iter().zip(torque) {
        assert!((at.motor_torque - torque).abs() < 1e-9 * (1.0 + torque.abs()));
        assert_eq!((at.deformation, at.motor_current), (0.0, None));
    }
}

#[test]
fn where_the_motion_jumps_the_transmission_is_stiff() {
    let robot = test_arms::robot(elastic(1));
    let mut reference = sines(6, &[0.2, 0.4], 1);
    reference.smooth[0] = false;
    let found = feed(&robot, &reference);
    assert_eq!((found.smoothness.exact_steps, found.smoothness.steps), (1, 2));
    for (stiff, exact) in found.step(0).iter().zip(found.step(1)) {
        assert_eq!(
            (stiff.motor_velocity, stiff.motor_acceleration),
            (stiff.velocity, stiff.acceleration)
        );
        assert_ne!(exact.motor_acceleration, exact.acceleration);
    }
}

#[test]
fn a_torque_that_the_transmission_does_not_pass_is_named() {
    let mut spec = elastic(2);
    // rises up to 2/3·1e3·√(1e3/3e9) = 0.38 N m
    spec.joints[3].drive.stiffness = vec![1.0e3, -1.0e9];
    let robot = test_arms::robot(spec);
    let range = feed_forward(&robot, &sines(6, &[0.4], 2), &Budget::unlimited())
        .unwrap()
        .unwrap_err();
    assert_eq!((range.joint, range.time), (3, 0.0));
    assert!(range.torque.abs() > range.largest && range.largest < 0.4);
}
