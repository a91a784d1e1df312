//! What a plan states of its limits against its set-points, set close: it may not promise more room than they leave.

use super::support::*;
use crate::budget::Budget;
use crate::path::outcome::{PathLimit, PathOutcome, PathPlan};
use crate::path::plan_path;
use crate::path::request::*;
use crate::plan::request::Sampling;
use crate::robot::Robot;
use crate::robot::spec::Friction;
use crate::test_arms;

/// Half as far again as the search promises, of the limit.
const STATED: f64 = 3e-7;

/// Two links in a vertical plane, whose joints take a fifth of their torque to turn back, and a part of their load.
fn planar(jerk: Option<f64>, load: f64) -> Robot {
    let mut spec = test_arms::planar();
    for joint in &mut spec.joints {
        let coulomb = 0.1 * joint.drive.peak_torque.unwrap();
        joint.drive.joint_friction = Friction {
            coulomb_positive: coulomb,
            coulomb_negative: 0.7 * coulomb,
            viscous: 0.5,
            load_coulomb: load,
            quadratic: load,
            ..joint.drive.joint_friction
        };
        joint.limits.jerk = jerk;
    }
    test_arms::robot(spec)
}

/// A way there and back that no joint goes evenly, its corners blended, with the shoulder around an angle.
fn program(state: &mut u64, around: f64, limit_jerk: bool) -> PathRequest {
    let near = |state: &mut u64| {
        [
            around + 0.8 * test_arms::random(state),
            1.0 + 0.8 * test_arms::random(state),
        ]
    };
    let start = near(state);
    let corner = || blend(Extent::Fraction(0.45));
    let segments = vec![
        joint(&near(state), corner()),
        joint(&near(state), corner()),
        joint(&near(state), None),
    ];
    PathRequest {
        limit_jerk,
        sampling: Sampling::Trace(20_001),
        ..request(&start, segments)
    }
}

fn planned(robot: &Robot, request: &PathRequest) -> Option<PathPlan> {
    match plan_path(robot, request, &Budget::unlimited()).unwrap() {
        PathOutcome::Plan(plan) => Some(*plan),
        PathOutcome::Infeasible(_) => None,
    }
}

/// How much more of a limit the set-points use than is stated, and how much less, as parts of the limit.
fn missed(plan: &PathPlan, kind: PathLimit, joint: usize) -> Option<(f64, f64)> {
    let mut uses = plan.limit_uses.iter();
    let stated = uses.find(|used| (used.kind, used.joint) == (kind, Some(joint)))?;
    let columns = &plan.setpoints.as_ref().unwrap().samples.joints[joint];
    let column = match kind {
        PathLimit::Torque => &columns.torque,
        PathLimit::Velocity => &columns.velocity,
        _ => &columns.acceleration,
    };
    let found = column.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
    let apart = (found - stated.value.abs()) / stated.limit;
    Some((apart, -apart))
}

fn check(limit_jerk: bool) {
    check_around(-1.2, 0.0, limit_jerk);
}

fn check_around(around: f64, load: f64, limit_jerk: bool) {
    let robot = planar(limit_jerk.then_some(400.0), load);
    let state = &mut 20_261_122;
    let mut plans = 0;
    for _ in 0..24 {
        let Some(plan) = planned(&robot, &program(state, around, limit_jerk)) else {
            continue;
        };
        plans += 1;
        for kind in [PathLimit::Torque, PathLimit::Velocity, PathLimit::Acceleration] {
            for joint in 0..2 {
                let Some((more, less)) = missed(&plan, kind, joint) else {
                    continue;
                };
                assert!(more <= STATED, "{kind:?} of {joint}: {more:e} more than stated");
                // and none is made up: set-points come that close
                assert!(less <= 2e-3, "{kind:?} of {joint}: {less:e} less than stated");
            }
        }
    }
    assert!(plans > 12, "{plans}");
}

#[test]
fn no_set_point_uses_more_than_is_stated() {
    check(false);
}

/// Both links hang down about half way: there their loads pass zero, and friction in proportion to them has a kink.
#[test]
fn no_set_point_uses_more_than_is_stated_where_a_load_passes_zero() {
    for limit_jerk in [false, true] {
        check_around(-0.5 * std::f64::consts::PI - 0.5, 0.3, limit_jerk);
    }
}

#[test]
fn no_set_point_uses_more_than_is_stated_with_jerk_limits() {
    check(true);
}
