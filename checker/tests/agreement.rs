//! Two programs that share nothing agree: the checker's dynamics and the planner's, on arms of every make.

use takt_checker::draw::{self, Draw};
use takt_checker::{Arm, Workspace};
use takt_motion::dynamics;
use takt_motion::robot::Robot;
use takt_motion::robot::spec::Inertial;

/// Largest difference over the largest entry, or over 1 N m where all are smaller (the terms of a single joint may
/// cancel): roundings alone.
const AGREEMENT: f64 = 1e-12;

fn assert_agree(found: &[f64], expected: &[f64], what: &str) {
    let largest = expected.iter().fold(1.0, |most: f64, value| most.max(value.abs()));
    for (joint, (found, expected)) in found.iter().zip(expected).enumerate() {
        assert!(
            (found - expected).abs() <= AGREEMENT * largest,
            "{what}, joint {joint}: {found} by the planner, {expected} by the checker"
        );
    }
}

/// Compares torques in random states of random arms, with the payload that `payload_of` makes; `None`: the arm's own.
fn check(seed: u64, payload_of: fn(&mut Draw) -> Option<Inertial>) {
    let mut draw = Draw::seeded(seed);
    for count in (1..=9).chain([16, 32]) {
        for _ in 0..10 {
            let spec = draw::arm(&mut draw, count);
            let payload = payload_of(&mut draw);
            let arm = Arm::new(&spec, payload.as_ref());
            let mut robot = Robot::new(spec, Vec::new()).expect("random arms are sound");
            if let Some(payload) = &payload {
                robot = robot.with_payload(payload);
            }
            let mut workspace = Workspace::default();
            let mut scratch = dynamics::Workspace::new(&robot);
            for _ in 0..10 {
                let q = draw::values(&mut draw, count, 4.0);
                let qd = draw::values(&mut draw, count, 3.0);
                let qdd = draw::values(&mut draw, count, 10.0);
                let (mut expected, mut found) = (vec![0.0; count], vec![0.0; count]);
                arm.rigid_torque(&mut workspace, &q, &qd, &qdd, &mut expected);
                dynamics::rigid_torque(&robot, &mut scratch, &q, &qd, &qdd, &mut found);
                assert_agree(&found, &expected, "rigid bodies");
                arm.drive_torque(&mut workspace, &q, &qd, &qdd, &qd, &mut expected);
                dynamics::drive_torque(&robot, &mut scratch, &q, &qd, &qdd, &mut found);
                assert_agree(&found, &expected, "drive");
                arm.rotor_torque(&qdd, &mut expected);
                dynamics::rotor_torque(&robot, &qdd, &mut found);
                assert_agree(&found, &expected, "rotor");
                arm.friction_torque(&mut workspace, &q, &qd, &mut expected);
                dynamics::friction_torque(&robot, &mut scratch, &q, &qd, &mut found);
                assert_agree(&found, &expected, "friction");
            }
        }
    }
}

#[test]
fn with_the_arms_own_payload() {
    check(1, |_| None);
}

#[test]
fn with_a_requests_payload() {
    check(2, |draw| Some(draw::body(draw)));
}

#[test]
fn with_nothing_carried() {
    check(3, |_| Some(Inertial::zero()));
}
