//! Programs planned from end to end: what the answer says must agree with itself.

use super::support::*;
use crate::budget::Budget;
use crate::path::outcome::{PathInfeasibleReason, PathLimit, PathOutcome, PathPlan};
use crate::path::plan_path;
use crate::path::request::*;
use crate::plan::Failure;
use crate::plan::request::{LimitOverride, Sampling};
use crate::robot::Robot;
use crate::robot::spec::Inertial;
use crate::test_arms;

const START: [f64; 6] = [0.0, -1.2, 1.4, -1.6, -1.5, 0.3];

/// Two joint segments and a third after a stop.
fn corner() -> Vec<Segment> {
    let mut stop = joint(&[0.9, -0.8, 1.2, -1.4, -1.2, 0.8], None);
    stop.dwell = 0.25;
    vec![
        joint(&[0.6, -1.0, 1.6, -1.8, -1.3, 0.1], blend(Extent::Fraction(0.3))),
        stop,
        joint(&[0.2, -1.1, 1.0, -1.2, -1.6, 0.0], None),
    ]
}

fn planned(robot: &Robot, request: &PathRequest) -> PathPlan {
    match plan_path(robot, request, &Budget::unlimited()).unwrap() {
        PathOutcome::Plan(plan) => *plan,
        PathOutcome::Infeasible(why) => panic!("{why:?}"),
    }
}

fn assert_near(a: f64, b: f64) {
    assert!((a - b).abs() < 1e-9, "{a} {b}");
}

#[test]
fn an_answer_agrees_with_itself() {
    let robot = ur5e();
    let plan = planned(&robot, &request(&START, corner()));
    assert_eq!(plan.continuity, 3);
    assert_eq!(plan.segments.len(), 3);
    assert_near(plan.segments[0].begin, 0.0);
    assert_near(plan.segments[0].end, plan.segments[1].begin);
    assert_near(plan.segments[1].end + 0.25, plan.segments[2].begin);
    assert_near(plan.segments[2].end, plan.duration);
    // one blend, around the seam of its two segments
    let [blend] = &plan.blends[..] else {
        panic!("{:?}", plan.blends)
    };
    assert!(blend.begin_time < plan.segments[0].end && plan.segments[0].end < blend.end_time);
    assert!(blend.end_time < plan.segments[1].end);
    // the stretches of limits cover the duration, and so do their costs
    let mut time = 0.0;
    for stretch in &plan.limiting {
        assert_near(stretch.begin, time);
        time = stretch.end;
    }
    assert_near(time, plan.duration);
    assert_near(plan.limit_costs.iter().map(|cost| cost.time).sum(), plan.duration);
    let rest = plan.limit_costs.iter().find(|cost| cost.kind == PathLimit::Rest);
    assert_near(rest.unwrap().time, 0.25);
    // nothing is exceeded, and something is used up
    assert!(
        plan.limit_uses.iter().all(|limit| limit.margin >= 0.0),
        "{:?}",
        plan.limit_uses
    );
    assert!(plan.limit_uses[0].margin < 2e-3, "{:?}", plan.limit_uses[0]);
    assert!(plan.torque_margins.iter().all(|margin| margin.margin >= 0.0));
}

#[test]
fn set_points_are_on_the_cycle_and_end_exactly() {
    let robot = ur5e();
    let cycle = 0.008;
    let program = PathRequest {
        sampling: Sampling::Period(cycle),
        ..request(&START, corner())
    };
    let plan = planned(&robot, &program);
    let setpoints = plan.setpoints.unwrap();
    let count = (plan.duration / cycle).round() as usize + 1;
    assert_near(plan.duration, (count - 1) as f64 * cycle);
    assert_eq!(setpoints.samples.time.len(), count);
    assert_eq!(setpoints.locations.len(), count);
    let Shape::Joint {
        target: Target::Joints(target),
    } = &program.segments[2].shape
    else {
        panic!()
    };
    for (joint, columns) in setpoints.samples.joints.iter().enumerate() {
        assert_eq!(columns.position[0], START[joint]);
        assert_eq!(columns.position[count - 1], target[joint]);
        assert_eq!(
            (columns.velocity[count - 1], columns.acceleration[count - 1]),
            (0.0, 0.0)
        );
        // each step is what the velocities say, but for jumps of the acceleration within a cycle
        for k in 1..count {
            let step = columns.position[k] - columns.position[k - 1];
            let mean = 0.5 * (columns.velocity[k] + columns.velocity[k - 1]);
            assert!((step - mean * cycle).abs() < 1e-3, "{step} {}", mean * cycle);
        }
    }
    let order = |pair: &[crate::path::outcome::Location]| {
        (pair[0].segment, pair[0].fraction) <= (pair[1].segment, pair[1].fraction)
    };
    assert!(setpoints.locations.windows(2).all(order));
}

#[test]
fn slower_limits_of_one_segment_hold_there_alone() {
    let robot = ur5e();
    let fast = planned(&robot, &request(&START, corner()));
    let mut segments = corner();
    segments[2].limits = vec![LimitOverride {
        joint: robot.spec().joints[0].name.clone(),
        velocity: Some(0.2),
        ..LimitOverride::default()
    }];
    let slow = planned(&robot, &request(&START, segments));
    assert_near(slow.segments[1].end, fast.segments[1].end);
    assert!(slow.duration - slow.segments[2].begin > 0.7 / 0.2);
}

#[test]
fn half_the_speed_takes_longer_and_nobody_is_faster_with_less_torque() {
    let robot = ur5e();
    let full = planned(&robot, &request(&START, corner())).duration;
    let scaled = |speed_scale, torque_utilization| {
        let program = PathRequest {
            speed_scale,
            torque_utilization,
            ..request(&START, corner())
        };
        planned(&robot, &program).duration
    };
    assert!(scaled(0.5, 1.0) > 1.2 * full);
    assert!(scaled(1.0, 0.6) > full);
}

#[test]
fn a_payload_that_cannot_be_held_half_way_is_told_with_its_joint() {
    let robot = ur5e();
    // from hanging to upright by way of stretched out
    let start = [0.0, 1.5, 0.0, 0.0, 0.0, 0.0];
    let segments = vec![joint(&[0.0, -1.5, 0.0, 0.0, 0.0, 0.0], None)];
    let program = PathRequest {
        payload: Some(Inertial {
            mass: 30.0,
            ..Inertial::zero()
        }),
        ..request(&start, segments)
    };
    let PathOutcome::Infeasible(why) = plan_path(&robot, &program, &Budget::unlimited()).unwrap() else {
        panic!("30 kg should be too much");
    };
    assert_eq!(why.reason, PathInfeasibleReason::MovingTorque);
    assert_eq!(why.location.segment, 0);
    assert!((why.location.fraction - 0.5).abs() < 0.1, "{why:?}");
    assert_eq!(why.joint, Some(1));
    assert!(why.needed.abs() > why.available && why.gravity_torque.abs() > 0.9 * why.available);
}

#[test]
fn wrong_numbers_are_named() {
    let robot = ur5e();
    let mut segments = corner();
    segments[1].tool_limits.velocity = Some(f64::NAN);
    segments[2].limits = vec![LimitOverride {
        joint: "elbow".to_owned(),
        position_upper: Some(1.0),
        ..LimitOverride::default()
    }];
    let program = PathRequest {
        speed_scale: 1.5,
        ..request(&START, segments)
    };
    let Err(crate::plan::Failure::Invalid(findings)) = plan_path(&robot, &program, &Budget::unlimited()) else {
        panic!("should be refused");
    };
    let paths: Vec<&str> = findings.iter().map(|finding| finding.path.as_str()).collect();
    for path in [
        "speed_scale",
        "segments[1].limits.tcp_velocity_m_per_s",
        "segments[2].limits.joints[0].joint",
        "segments[2].limits.joints[0].position_upper",
    ] {
        assert!(paths.contains(&path), "{paths:?}");
    }
}

#[test]
fn a_speed_at_the_end_is_kept() {
    let robot = ur5e();
    let segments = corner()
        .into_iter()
        .take(1)
        .map(|segment| Segment { blend: None, ..segment })
        .collect();
    let program = PathRequest {
        end_speed: Some(0.5),
        sampling: Sampling::Trace(200),
        ..request(&START, segments)
    };
    let plan = planned(&robot, &program);
    let columns = plan.setpoints.unwrap().samples.joints;
    let fastest = columns
        .iter()
        .map(|joint| joint.velocity[199].abs())
        .fold(0.0, f64::max);
    assert!((fastest - 0.5).abs() < 1e-9, "{fastest}");
}

#[test]
fn on_a_cycle_a_speed_at_the_start_is_kept_and_one_at_the_end_refused() {
    let robot = ur5e();
    let on_cycle = |start_speed, end_speed| PathRequest {
        start_speed,
        end_speed,
        sampling: Sampling::Period(0.008),
        ..request(&START, corner())
    };
    let plan = planned(&robot, &on_cycle(Some(0.3), None));
    let samples = plan.setpoints.unwrap().samples;
    let last = samples.time.len() - 1;
    assert!((plan.duration - samples.time[last]).abs() < 1e-12, "{}", plan.duration);
    let fastest = |at: usize| {
        samples
            .joints
            .iter()
            .fold(0.0_f64, |most, joint| most.max(joint.velocity[at].abs()))
    };
    assert!((fastest(0) - 0.3).abs() < 1e-9 && fastest(last) == 0.0);
    let refused = plan_path(&robot, &on_cycle(None, Some(0.3)), &Budget::unlimited()).unwrap_err();
    let Failure::Invalid(found) = refused else {
        panic!("{refused:?}");
    };
    assert_eq!(found[0].path, "end_speed");
}

/// Every joint's jerk is limited: the set-points' third differences keep it, and it costs time.
#[test]
fn jerk_limits_hold_between_set_points() {
    let robot = ur5e();
    let free = planned(&robot, &request(&START, corner())).duration;
    let (jerk, cycle) = (60.0, 0.004);
    let joints = robot.spec().joints.iter();
    let limits = joints.map(|joint| LimitOverride {
        joint: joint.name.clone(),
        jerk: Some(jerk),
        ..LimitOverride::default()
    });
    let program = PathRequest {
        limits: limits.collect(),
        sampling: Sampling::Period(cycle),
        ..request(&START, corner())
    };
    let plan = planned(&robot, &program);
    assert!(plan.duration > 1.1 * free, "{} {free}", plan.duration);
    for columns in plan.setpoints.unwrap().samples.joints {
        for p in columns.position.windows(4) {
            let third = (p[3] - 3.0 * p[2] + 3.0 * p[1] - p[0]) / (cycle * cycle * cycle);
            // rounding of a radian, eightfold, over the cube of the cycle
            let rounding = 8.0 * 4.0 * f64::EPSILON / (cycle * cycle * cycle);
            assert!(third.abs() <= jerk + rounding, "{third}");
        }
    }
}

/// A single joint's trapezoid is held by its acceleration, its speed, its acceleration; with jerk, by that too.
#[test]
fn the_limit_that_holds_the_path_is_named() {
    let lift = test_arms::robot(test_arms::lift(5.0));
    let limited = |jerk| PathRequest {
        tcp: None,
        limits: vec![LimitOverride {
            joint: "lift".to_owned(),
            velocity: Some(1.0),
            acceleration: Some(3.0),
            jerk,
            ..LimitOverride::default()
        }],
        ..request(&[-0.3], vec![joint(&[1.7], None)])
    };
    let plan = planned(&lift, &limited(None));
    let kinds: Vec<PathLimit> = plan.limiting.iter().map(|stretch| stretch.kind).collect();
    assert_eq!(
        kinds,
        [PathLimit::Acceleration, PathLimit::Velocity, PathLimit::Acceleration]
    );
    assert!((plan.duration - (2.0 + 1.0 / 3.0)).abs() < 2e-3, "{}", plan.duration);
    let plan = planned(&lift, &limited(Some(20.0)));
    let time = |kind| {
        let costs = plan.limit_costs.iter().filter(|cost| cost.kind == kind);
        costs.map(|cost| cost.time).sum::<f64>()
    };
    // four phases of jerk of A/J, two of acceleration of V/A − A/J, and the cruise of d/V − V/A − A/J
    assert!((time(PathLimit::Jerk) - 0.6).abs() < 0.1, "{:?}", plan.limit_costs);
    assert!(
        (time(PathLimit::Velocity) - (2.0 - 1.0 / 3.0 - 0.15)).abs() < 0.1,
        "{:?}",
        plan.limit_costs
    );
}
