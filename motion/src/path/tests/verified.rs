//! What a plan says of its limits, and what its set-points are at stops.

use super::support::*;
use crate::budget::Budget;
use crate::dynamics::{self, Workspace};
use crate::path::outcome::{PathLimit, PathLimitUse, PathOutcome, PathPlan};
use crate::path::plan_path;
use crate::path::request::*;
use crate::plan::request::{LimitOverride, Sampling};
use crate::robot::Robot;

const START: [f64; 6] = [0.0, -1.2, 1.4, -1.6, -1.5, 0.3];
const TARGET: [f64; 6] = [0.6, -1.0, 1.6, -1.8, -1.3, 0.1];
const BACK: [f64; 6] = [0.1, -1.3, 1.2, -1.4, -1.6, 0.2];

fn planned(robot: &Robot, request: &PathRequest) -> PathPlan {
    match plan_path(robot, request, &Budget::unlimited()).unwrap() {
        PathOutcome::Plan(plan) => *plan,
        PathOutcome::Infeasible(why) => panic!("{why:?}"),
    }
}

fn torque_use(plan: &PathPlan, joint: usize) -> &PathLimitUse {
    let mut of_joint = plan.limit_uses.iter().filter(|used| used.joint == Some(joint));
    of_joint.find(|used| used.kind == PathLimit::Torque).unwrap()
}

fn peak(robot: &Robot, joint: usize, peak: f64) -> LimitOverride {
    LimitOverride {
        joint: robot.spec().joints[joint].name.clone(),
        peak_torque: Some(peak),
        ..LimitOverride::default()
    }
}

#[test]
fn a_peak_torque_of_the_request_stands_for_the_models_times_the_utilization() {
    let robot = ur5e();
    let mut request = request(&START, vec![joint(&TARGET, None)]);
    request.torque_utilization = 0.6;
    request.limits = vec![peak(&robot, 1, 140.0)];
    let plan = planned(&robot, &request);
    assert_eq!(torque_use(&plan, 1).limit, 140.0);
    assert_eq!(torque_use(&plan, 2).limit, 0.6 * 150.0);
}

#[test]
fn margins_are_of_the_limit_that_is_tightest_where_it_holds() {
    let robot = ur5e();
    let mut second = joint(&BACK, None);
    second.limits = vec![peak(&robot, 1, 100.0)];
    let plan = planned(&robot, &request(&START, vec![joint(&TARGET, None), second]));
    let used = torque_use(&plan, 1);
    let margin = plan.torque_margins[1];
    assert_eq!((margin.limit, margin.margin), (used.limit, used.margin));
    assert_eq!((used.limit, used.location.segment), (100.0, 1));
}

#[test]
fn holding_the_arm_uses_torque_too() {
    let robot = ur5e();
    let plan = planned(&robot, &request(&START, vec![joint(&TARGET, None)]));
    let mut holding = [0.0; 6];
    for position in [START, TARGET] {
        dynamics::gravity_torque(&robot, &mut Workspace::new(&robot), &position, &mut holding);
        for (joint, torque) in holding.iter().enumerate() {
            let used = torque_use(&plan, joint);
            assert!(
                torque.abs() <= used.value.abs() + 1e-12,
                "{joint}: {torque} and {used:?}"
            );
        }
    }
}

#[test]
fn set_points_at_stops_are_at_rest_to_the_last_bit() {
    let robot = ur5e();
    for period in [0.001, 0.003, 0.004, 0.007, 0.008, 0.012] {
        let mut first = joint(&TARGET, None);
        first.dwell = 0.1;
        let mut request = request(&START, vec![first, joint(&BACK, None)]);
        request.limit_jerk = false;
        request.sampling = Sampling::Period(period);
        let plan = planned(&robot, &request);
        let dwells = plan.segments[0].end..plan.segments[1].begin - 0.5 * period;
        let samples = plan.setpoints.unwrap().samples;
        for (index, time) in samples.time.iter().enumerate() {
            let last = index + 1 == samples.time.len();
            // the first of a dwell is the end of the motion before it
            if !last && !dwells.contains(&(time + 0.25 * period)) {
                continue;
            }
            for joint in &samples.joints {
                assert_eq!(
                    (joint.velocity[index], joint.acceleration[index]),
                    (0.0, 0.0),
                    "{period} {time}"
                );
            }
        }
    }
}
