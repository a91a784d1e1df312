//! Which signals there are, on an arm with transmissions that give.

use super::arm::{RATIOS, feed, friction, motion, options, two_links};
use super::*;
use crate::dynamics::{self, Workspace};

const JOINT_SIDE: [(f64, f64); 2] = [(3.0, 1.0), (1.5, 0.5)];
const MOTOR_SIDE: [(f64, f64); 2] = [(2.0, 0.7), (1.0, 0.4)];

/// Torque through both transmissions at a time: eq 10.
fn transmission(robot: &Robot, workspace: &mut Workspace, time: f64) -> [f64; 2] {
    let states = [motion(0, time), motion(1, time)];
    let column = |order: usize| [states[0][order], states[1][order]];
    let mut torque = [0.0; 2];
    dynamics::rigid_torque(robot, workspace, &column(0), &column(1), &column(2), &mut torque);
    for joint in 0..2 {
        let (coulomb, viscous) = JOINT_SIDE[joint];
        torque[joint] += law::torque(&friction(coulomb, viscous), states[joint][1], 0.0);
    }
    torque
}

/// Deformation under a torque at rest: τE(Φ) = τ by Newton's method.
fn deformation(torque: f64) -> f64 {
    let mut phi = torque / 8000.0;
    for _ in 0..30 {
        let value = 8000.0 * phi + 2e6 * phi * phi * phi - torque;
        phi -= value / (8000.0 + 6e6 * phi * phi);
    }
    phi
}

/// Every signal that there could be, without the transmission's damping.
fn everything(robot: &Robot) -> Telemetry {
    let workspace = &mut Workspace::new(robot);
    let mut telemetry = Telemetry::default();
    // far below the time in which anything changes, far above rounding in the second difference
    let h = 1e-4;
    for index in 0..25_000 {
        let time = 0.001 * f64::from(index);
        let torques = [time - h, time, time + h].map(|time| transmission(robot, workspace, time));
        telemetry.time.push(time);
        for joint in 0..2 {
            let [q, qd, qdd] = motion(joint, time);
            let phi = torques.map(|torque| deformation(torque[joint]));
            let crossing = motion(joint, time - h)[1] * motion(joint, time + h)[1] < 0.0;
            // a Coulomb torque that changes sign within the difference is no acceleration
            let second = if crossing {
                0.0
            } else {
                (phi[2] - 2.0 * phi[1] + phi[0]) / (h * h)
            };
            let first = if crossing { 0.0 } else { (phi[2] - phi[0]) / (2.0 * h) };
            let drive = &robot.spec().joints[joint].drive;
            let armature = drive.gear_ratio * drive.gear_ratio * drive.rotor_inertia;
            let (coulomb, viscous) = MOTOR_SIDE[joint];
            let lost = law::torque(&friction(coulomb, viscous), qd + first, 0.0);
            let motor = armature * (qdd + second) + torques[1][joint] + lost;
            telemetry.motor_position.push((q + phi[1]) * RATIOS[joint]);
            telemetry.output_position.push(q);
            telemetry.output_velocity.push(qd);
            telemetry.output_acceleration.push(qdd);
            telemetry.motor_torque.push(motor / RATIOS[joint]);
            telemetry.motor_current.push(motor / RATIOS[joint] / 0.1);
            telemetry.transmission_torque.push(torques[1][joint]);
        }
    }
    telemetry
}

fn only(telemetry: &Telemetry, columns: &[&str]) -> Telemetry {
    let keep = |name: &str, column: &Vec<f64>| {
        if columns.contains(&name) {
            column.clone()
        } else {
            Vec::new()
        }
    };
    Telemetry {
        time: telemetry.time.clone(),
        motor_position: keep("Θ", &telemetry.motor_position),
        output_position: keep("q", &telemetry.output_position),
        output_velocity: keep("qd", &telemetry.output_velocity),
        output_acceleration: keep("qdd", &telemetry.output_acceleration),
        motor_torque: keep("τm", &telemetry.motor_torque),
        motor_current: keep("i", &telemetry.motor_current),
        transmission_torque: keep("τJ", &telemetry.transmission_torque),
        external_torque: Vec::new(),
    }
}

/// The robot, whose model knows the friction of both sides.
fn elastic() -> Robot {
    let mut spec = two_links().spec().clone();
    for (joint, spec) in spec.joints.iter_mut().enumerate() {
        spec.drive.damping = None;
        let (coulomb, viscous) = JOINT_SIDE[joint];
        spec.drive.joint_friction = friction(coulomb, viscous);
        let (coulomb, viscous) = MOTOR_SIDE[joint];
        let ratio = RATIOS[joint].abs();
        spec.drive.motor_friction = friction(coulomb / ratio, viscous / (ratio * ratio));
    }
    Robot::new(spec, Vec::new()).unwrap()
}

#[test]
fn each_combination_finds_its_friction() {
    let robot = elastic();
    let telemetry = everything(&robot);
    let sum = [(5.0, 1.7), (2.5, 0.9)];
    use EstimatorMethod::{Kalman, LeastSquares, Observer};
    use FrictionSide::{Joint, Motor, Total};
    for (side, columns, method, expected) in [
        (Total, &["q", "τm"][..], LeastSquares, sum),
        (Total, &["Θ", "i"], LeastSquares, sum),
        (Total, &["q", "qd", "qdd", "i"], Kalman, sum),
        (Total, &["q", "Θ", "τm"], Observer, sum),
        (Joint, &["q", "τJ"], LeastSquares, JOINT_SIDE),
        (Joint, &["q", "Θ"], LeastSquares, JOINT_SIDE),
        (Joint, &["q", "qd", "τm"], LeastSquares, JOINT_SIDE),
        (Motor, &["q", "Θ", "τm"], LeastSquares, MOTOR_SIDE),
        (Motor, &["q", "Θ", "τm", "τJ"], Observer, MOTOR_SIDE),
        (Motor, &["Θ", "τm"], LeastSquares, MOTOR_SIDE),
        (Motor, &["q", "τm", "τJ"], LeastSquares, MOTOR_SIDE),
    ] {
        let options = EstimatorOptions {
            side,
            method,
            ..options()
        };
        let mut estimator = FrictionEstimator::new(robot.clone(), options).unwrap();
        feed(&mut estimator, &only(&telemetry, columns), 100);
        for (joint, expected) in estimator.report().joints.iter().zip(expected) {
            let found = (joint.coefficients[0].value, joint.coefficients[1].value);
            let off = (found.0 - expected.0).abs().max((found.1 - expected.1).abs());
            assert!(
                off < 0.06,
                "{side:?} {columns:?} {method:?}: {found:?} for {expected:?}"
            );
        }
    }
}

/// Without a filter, position, velocity and acceleration are taken as they are, and so is the torque.
#[test]
fn signals_that_need_no_filter_are_taken_as_they_are() {
    let robot = elastic();
    let telemetry = everything(&robot);
    let options = EstimatorOptions {
        bandwidth: None,
        side: FrictionSide::Joint,
        ..options()
    };
    let mut estimator = FrictionEstimator::new(robot.clone(), options.clone()).unwrap();
    feed(&mut estimator, &only(&telemetry, &["q", "qd", "qdd", "τJ"]), 1000);
    let report = estimator.report();
    assert_eq!(report.delay, 0.0);
    for (joint, expected) in report.joints.iter().zip(JOINT_SIDE) {
        assert!((joint.coefficients[0].value - expected.0).abs() < 1e-3, "{joint:?}");
        assert!((joint.coefficients[1].value - expected.1).abs() < 1e-3, "{joint:?}");
    }
    let mut estimator = FrictionEstimator::new(robot, options).unwrap();
    let refused = estimator.update(&only(&telemetry, &["q", "τJ"]), &Budget::unlimited());
    assert!(matches!(refused, Err(UpdateError::Invalid(_))), "{refused:?}");
}

/// An arm that pushes against something loses no friction to it, where it says so.
#[test]
fn a_push_on_the_surroundings_is_no_friction() {
    let robot = elastic();
    let mut telemetry = only(&everything(&robot), &["q", "τm"]);
    telemetry.external_torque = vec![0.0; telemetry.output_position.len()];
    for (index, external) in telemetry.external_torque.iter_mut().enumerate() {
        *external = 12.0 * libm::sin(0.001 * index as f64);
        telemetry.motor_torque[index] += *external / RATIOS[index % 2];
    }
    let mut estimator = FrictionEstimator::new(robot, options()).unwrap();
    feed(&mut estimator, &telemetry, 100);
    assert!(
        estimator
            .combination()
            .is_some_and(|combination| combination.external_torque)
    );
    for (joint, expected) in estimator.report().joints.iter().zip([(5.0, 1.7), (2.5, 0.9)]) {
        assert!((joint.coefficients[0].value - expected.0).abs() < 0.06, "{joint:?}");
        assert!((joint.coefficients[1].value - expected.1).abs() < 0.06, "{joint:?}");
    }
}
