//! Friction where an arm sets out and where it stops: in the set-points, and in what a plan says of its torques.

use super::support::*;
use crate::budget::Budget;
use crate::dynamics::{self, Workspace};
use crate::path::outcome::{PathLimit, PathOutcome, PathPlan};
use crate::path::plan_path;
use crate::path::request::*;
use crate::plan::request::{LimitOverride, Sampling};
use crate::robot::Robot;
use crate::robot::spec::Friction;
use crate::test_arms;

const COULOMB: Friction = Friction {
    coulomb_positive: 5.0,
    coulomb_negative: 3.0,
    ..NONE
};

const NONE: Friction = Friction {
    viscous: 0.0,
    coulomb_positive: 0.0,
    coulomb_negative: 0.0,
    load_coulomb: 0.0,
    quadratic: 0.0,
    presliding_stiffness: None,
};

/// Two links of 1 m in a vertical plane; the limits of their accelerations and jerks.
fn planar(acceleration: f64, jerk: f64) -> Robot {
    let mut spec = test_arms::planar();
    for joint in &mut spec.joints {
        joint.drive.joint_friction = COULOMB;
        joint.limits.acceleration = Some(acceleration);
        joint.limits.jerk = Some(jerk);
    }
    test_arms::robot(spec)
}

fn planned(robot: &Robot, start: &[f64], segments: Vec<Segment>, limit_jerk: bool) -> PathPlan {
    let program = PathRequest {
        limit_jerk,
        sampling: Sampling::Period(0.004),
        ..request(start, segments)
    };
    match plan_path(robot, &program, &Budget::unlimited()).unwrap() {
        PathOutcome::Plan(plan) => *plan,
        PathOutcome::Infeasible(why) => panic!("{why:?}"),
    }
}

fn stated(plan: &PathPlan, joint: usize) -> f64 {
    let mut uses = plan.limit_uses.iter().filter(|used| used.joint == Some(joint));
    uses.find(|used| used.kind == PathLimit::Torque).unwrap().value
}

/// The torques of a state with Coulomb friction in a direction.
fn torque(robot: &Robot, [q, qd, qdd]: [&[f64]; 3], direction: [f64; 2]) -> [f64; 2] {
    let mut torque = [0.0; 2];
    dynamics::rigid_torque(robot, &mut Workspace::new(robot), q, qd, qdd, &mut torque);
    let coulomb = direction.map(|way| if way > 0.0 { 5.0 } else { -3.0 });
    [torque[0] + coulomb[0], torque[1] + coulomb[1]]
}

#[test]
fn the_first_set_point_has_the_friction_of_the_motion_just_after() {
    for limit_jerk in [false, true] {
        let robot = planar(4.0, 100.0);
        let mut out = joint(&[-0.5, 0.4], None);
        out.dwell = 0.02;
        let plan = planned(&robot, &[-1.2, 0.9], vec![out, joint(&[-0.9, 1.2], None)], limit_jerk);
        let samples = plan.setpoints.as_ref().unwrap();
        let joints = &samples.samples.joints;
        let again = (plan.segments[1].begin / 0.004).round() as usize;
        for (sample, direction) in [(0, [1.0, -1.0]), (again, [-1.0, 1.0])] {
            let column =
                |of: fn(&crate::plan::outcome::JointColumns) -> &Vec<f64>| [0, 1].map(|j| of(&joints[j])[sample]);
            let [q, qd, qdd] = [
                column(|j| &j.position),
                column(|j| &j.velocity),
                column(|j| &j.acceleration),
            ];
            assert_eq!(qd, [0.0; 2]);
            let expected = torque(&robot, [&q, &qd, &qdd], direction);
            let told = column(|j| &j.torque);
            for joint in 0..2 {
                assert!((told[joint] - expected[joint]).abs() < 1e-9, "{told:?} {expected:?}");
            }
        }
        // a stop holds the arm, which friction does not take part in
        let stop = (plan.segments[0].end / 0.004).round() as usize;
        let held = torque(&robot, [&[-0.5, 0.4], &[0.0; 2], &[0.0; 2]], [1.0, 1.0]).map(|torque| torque - 5.0);
        for joint in 0..2 {
            assert!((joints[joint].torque[stop] - held[joint]).abs() < 1e-9);
        }
        // and no set-point asks for more than the plan says
        for (joint, columns) in joints.iter().enumerate() {
            let most = columns
                .torque
                .iter()
                .fold(0.0, |most: f64, torque| most.max(torque.abs()));
            assert!(most <= stated(&plan, joint).abs() * (1.0 + 1e-9), "{joint} {most}");
        }
    }
}

/// Arms stretched out weigh the most: raised to there slowly, the shoulder carries most at the very end, where a jerk
/// limit leaves no acceleration, and friction is still to be overcome.
#[test]
fn friction_counts_up_to_the_last_moment_before_a_stop() {
    let robot = planar(0.002, 0.01);
    let plan = planned(&robot, &[-0.3, 0.0], vec![joint(&[0.0, 0.0], None)], true);
    let expected = torque(&robot, [&[0.0; 2]; 3], [1.0, 1.0]);
    assert!(
        (stated(&plan, 0) - expected[0]).abs() < 1e-9,
        "{} {expected:?}",
        stated(&plan, 0)
    );
}

/// What friction would ask for against the wrong direction, or without it, is not asked for at a start.
#[test]
fn a_start_that_friction_relieves_is_stated_as_it_is() {
    // lowering the stretched arm, friction carries a part of it: the tightest is to hold it before
    let robot = planar(0.05, 0.2);
    let mut program = joint(&[-0.3, 0.0], None);
    program.limits = vec![LimitOverride {
        joint: robot.spec().joints[0].name.clone(),
        peak_torque: Some(70.0),
        ..LimitOverride::default()
    }];
    let held = torque(&robot, [&[0.0; 2]; 3], [1.0, 1.0])[0] - 5.0;
    let plan = planned(&robot, &[0.0, 0.0], vec![program], true);
    assert!((stated(&plan, 0) - held).abs() < 1e-9, "{} {held}", stated(&plan, 0));
}
