//! Programs at constant speed, planned from end to end.

use nalgebra::{Isometry3, Vector3};

use super::support::*;
use crate::budget::Budget;
use crate::kinematics;
use crate::path::outcome::{PathInfeasibleReason, PathOutcome, PathPlan};
use crate::path::plan_path;
use crate::path::request::*;
use crate::plan::Failure;
use crate::plan::request::Sampling;
use crate::robot::Robot;

const START: [f64; 6] = [0.3, -1.4, 1.6, -1.7, -1.5, 0.2];

const SPEED: f64 = 0.1;

/// The tool's pose at the start, moved in base-link axes.
fn moved(robot: &Robot, by: [f64; 3]) -> Target {
    let mut pose = kinematics::pose(robot, &START, &tcp());
    pose.translation.vector += Vector3::from(by);
    Target::Pose { pose, frame: None }
}

/// A line, a half circle, a line.
fn seam(robot: &Robot) -> PathRequest {
    let at_speed = |shape: Shape| Segment {
        tool_speed: Some(SPEED),
        ..segment(shape, None)
    };
    let line = |by: [f64; 3]| {
        at_speed(Shape::Line {
            target: moved(robot, by),
        })
    };
    let arc = at_speed(Shape::Arc(Arc {
        circle: Circle::Via {
            point: moved(robot, [0.15, 0.05, 0.0]),
            second: None,
        },
        target: Some(moved(robot, [0.1, 0.1, 0.0])),
        orientation: ArcOrientation::Interpolated,
    }));
    PathRequest {
        tcp: Some(tcp()),
        timing: Timing::ConstantSpeed,
        sampling: Sampling::Period(0.004),
        ..request(&START, vec![line([0.1, 0.0, 0.0]), arc, line([0.0, 0.1, 0.0])])
    }
}

fn outcome_of(robot: &Robot, request: &PathRequest) -> PathOutcome {
    plan_path(robot, request, &Budget::unlimited()).unwrap()
}

fn planned(robot: &Robot, request: &PathRequest) -> PathPlan {
    match outcome_of(robot, request) {
        PathOutcome::Plan(plan) => *plan,
        PathOutcome::Infeasible(why) => panic!("{why:?}"),
    }
}

#[test]
fn the_tool_keeps_its_speed_between_rest_and_rest() {
    let robot = ur5e();
    let plan = planned(&robot, &seam(&robot));
    let report = plan.constant_speed.unwrap();
    assert!(report.speed <= SPEED && report.speed > 0.97 * SPEED, "{report:?}");
    assert_eq!(report.transitions.len(), 4);
    assert!(
        report
            .transitions
            .iter()
            .all(|transition| transition.velocity_jump == 0.0)
    );
    let setpoints = plan.setpoints.unwrap();
    let inner = |time: f64| {
        let [first, .., last] = &report.transitions[..] else {
            panic!()
        };
        time > first.end_time && time < last.begin_time
    };
    let mut kept = 0;
    for (time, speed) in setpoints.samples.time.iter().zip(&setpoints.tool_speed) {
        if !inner(*time) {
            continue;
        }
        assert!(
            *speed <= report.speed * 1.06 && *speed >= report.lowest * (1.0 - 1e-9),
            "{time} {speed}"
        );
        let in_transition = |t: &crate::path::outcome::TransitionReport| *time >= t.begin_time && *time <= t.end_time;
        if !report.transitions.iter().any(in_transition) {
            assert!((speed - report.speed).abs() < 1e-9, "{time} {speed}");
            kept += 1;
        }
    }
    assert!(kept > setpoints.samples.time.len() / 2);
    // a tool that starts and ends at rest, where it was taught
    assert_eq!(
        (setpoints.tool_speed[0], *setpoints.tool_speed.last().unwrap()),
        (0.0, 0.0)
    );
    let last = setpoints.samples.time.len() - 1;
    let q: Vec<f64> = setpoints
        .samples
        .joints
        .iter()
        .map(|joint| joint.position[last])
        .collect();
    let Target::Pose { pose, .. } = moved(&robot, [0.0, 0.1, 0.0]) else {
        panic!()
    };
    let end: Isometry3<f64> = kinematics::pose(&robot, &q, &tcp());
    assert!((end.translation.vector - pose.translation.vector).norm() < 1e-10);
    assert!(end.rotation.angle_to(&pose.rotation) < 1e-7);
    assert!(plan.limit_uses.iter().all(|limit| limit.margin >= 0.0));
}

#[test]
fn a_speed_that_the_arm_cannot_follow_is_lowered_or_refused() {
    let robot = ur5e();
    let mut fast = seam(&robot);
    for segment in &mut fast.segments {
        segment.tool_speed = Some(8.0);
    }
    let plan = planned(&robot, &fast);
    let report = plan.constant_speed.unwrap();
    assert!(report.asked == 8.0 && report.speed < 4.0, "{report:?}");
    assert!(report.lowered.is_some());
    assert!(plan.limit_uses.iter().all(|limit| limit.margin >= 0.0));
    fast.on_excess = OnExcess::Refuse;
    fast.tool_limits.acceleration = None;
    match outcome_of(&robot, &fast) {
        PathOutcome::Infeasible(why) => assert_eq!(why.reason, PathInfeasibleReason::ConstantSpeed),
        PathOutcome::Plan(plan) => panic!("{:?}", plan.constant_speed),
    }
}

/// Transitions that are given, or slowed down for the arm, are no whole number of cycles: the set-points end on one after it.
#[test]
fn set_points_end_at_rest_on_a_whole_cycle() {
    let robot = ur5e();
    for (speed, transition_time) in [(SPEED, None), (SPEED, Some(0.0333)), (8.0, None)] {
        let mut request = seam(&robot);
        request.transition_time = transition_time;
        request.segments[0].dwell = 0.0101;
        for segment in &mut request.segments {
            segment.tool_speed = Some(speed);
        }
        let plan = planned(&robot, &request);
        let cycles = plan.duration / 0.004;
        assert!((cycles - cycles.round()).abs() < 1e-9, "{cycles}");
        let samples = plan.setpoints.unwrap().samples;
        assert_eq!(samples.time.len(), cycles.round() as usize + 1);
        for joint in &samples.joints {
            assert_eq!(
                (joint.velocity.last(), joint.acceleration.last()),
                (Some(&0.0), Some(&0.0))
            );
        }
    }
}

#[test]
fn what_has_no_constant_speed_is_named() {
    let robot = ur5e();
    let mut wrong = seam(&robot);
    wrong.segments[1] = joint(&[0.0; 6], None);
    wrong.segments[2].tool_speed = Some(0.2);
    wrong.end_speed = Some(0.1);
    let Err(Failure::Invalid(findings)) = plan_path(&robot, &wrong, &Budget::unlimited()) else {
        panic!("should be refused");
    };
    let paths: Vec<&str> = findings.iter().map(|finding| finding.path.as_str()).collect();
    assert_eq!(paths, ["end_speed", "segments[1]", "segments[2].tool_speed_m_per_s"]);
}

#[test]
fn the_sources_form_says_where_it_jumps() {
    let robot = ur5e();
    let mut source = seam(&robot);
    source.transition = Transition::Source;
    let report = planned(&robot, &source).constant_speed.unwrap();
    // at the seams of line and arc
    assert!(report.transitions[1].velocity_jump > 0.01 * SPEED, "{report:?}");
    assert!(report.transitions[1].acceleration_jump > 0.0);
}
