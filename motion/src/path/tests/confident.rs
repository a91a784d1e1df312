//! Programs whose torque limits hold at a confidence.

use super::support::*;
use crate::budget::Budget;
use crate::confidence::tests::uncertain;
use crate::confidence::{Confidence, ConfidenceReport, Confident, Over, plan_path};
use crate::dynamics::regressor::{self, Regressor};
use crate::path::outcome::{PathLimit, PathOutcome, PathPlan};
use crate::path::request::*;
use crate::plan::request::{LimitOverride, Sampling};
use crate::robot::Robot;

const START: [f64; 6] = [0.0, -1.2, 1.4, -1.6, -1.5, 0.3];

fn arm(part: f64, residual: f64) -> Robot {
    Robot::new(uncertain(ur5e().spec().clone(), part, residual, 4), Vec::new()).unwrap()
}

fn corner() -> PathRequest {
    let mut stop = joint(&[0.9, -0.8, 1.2, -1.4, -1.2, 0.8], None);
    stop.dwell = 0.25;
    stop.limits = vec![LimitOverride {
        joint: "shoulder_lift_joint".to_owned(),
        peak_torque: Some(120.0),
        ..LimitOverride::default()
    }];
    let first = joint(&[0.6, -1.0, 1.6, -1.8, -1.3, 0.1], blend(Extent::Fraction(0.3)));
    PathRequest {
        sampling: Sampling::Trace(800),
        ..request(
            &START,
            vec![first, stop, joint(&[0.2, -1.1, 1.0, -1.2, -1.6, 0.0], None)],
        )
    }
}

fn held(robot: &Robot, request: &PathRequest, confidence: Confidence) -> (PathPlan, ConfidenceReport) {
    let Confident { outcome, report, .. } = plan_path(robot, request, confidence, &Budget::unlimited()).unwrap();
    match outcome {
        PathOutcome::Plan(plan) => (*plan, report.unwrap()),
        PathOutcome::Infeasible(why) => panic!("{why:?}"),
    }
}

fn sample(level: f64) -> Confidence {
    Confidence {
        level,
        over: Over::Sample,
    }
}

fn peak_torques(robot: &Robot) -> Vec<f64> {
    let joints = robot.spec().joints.iter();
    joints.map(|joint| joint.drive.peak_torque.unwrap()).collect()
}

/// The least room that torques and their bands leave along set-points, as part of the limit, bands put together entry by entry.
fn least_margin(robot: &Robot, plan: &PathPlan, multiplier: f64, limit: impl Fn(usize, usize) -> f64) -> f64 {
    let known = robot.spec().uncertainty.as_ref().unwrap();
    let columns: Vec<usize> = known.parameters.iter().map(|p| regressor::column(*p)).collect();
    let setpoints = plan.setpoints.as_ref().unwrap();
    let mut regressor = Regressor::new(robot);
    let mut least = f64::INFINITY;
    for sample in 0..setpoints.samples.time.len() {
        let at = |pick: fn(&crate::plan::outcome::JointColumns) -> &Vec<f64>| -> Vec<f64> {
            setpoints
                .samples
                .joints
                .iter()
                .map(|joint| pick(joint)[sample])
                .collect()
        };
        let (q, qd, qdd) = (at(|j| &j.position), at(|j| &j.velocity), at(|j| &j.acceleration));
        regressor.compute(robot, &q, &qd, &qdd);
        for (joint, torque) in at(|j| &j.torque).into_iter().enumerate() {
            let row = regressor.row(joint);
            let mut square = known.residuals[joint].deviation.powi(2);
            for (i, one) in columns.iter().enumerate() {
                for (j, other) in columns[..=i].iter().enumerate() {
                    let twice = if i == j { 1.0 } else { 2.0 };
                    square += twice * row[*one] * row[*other] * known.covariance[i * (i + 1) / 2 + j];
                }
            }
            let limit = limit(joint, setpoints.locations[sample].segment);
            least = least.min((limit - torque.abs() - multiplier * square.sqrt()) / limit);
        }
    }
    least
}

#[test]
fn a_program_holds_its_limits_with_their_bands_and_says_what_that_costs() {
    let robot = arm(0.1, 0.02);
    let asked = corner();
    let (plan, report) = held(&robot, &asked, sample(0.95));
    assert!(report.holds && plan.duration > report.nominal_duration.unwrap());
    let peaks = peak_torques(&robot);
    let limit = |joint: usize, segment: usize| {
        if joint == 1 && segment == 1 {
            120.0
        } else {
            peaks[joint]
        }
    };
    // the normal quantile, which is above that of four degrees of freedom at this level
    let least = least_margin(&robot, &plan, 1.959_963_984_540_054, limit);
    assert!(least > -1e-6 && least < 0.02, "{least}");
    let stated = report
        .joints
        .iter()
        .map(|joint| joint.margin)
        .fold(f64::INFINITY, f64::min);
    assert!((stated - least).abs() < 5e-3, "{stated} {least}");
    // limits in the answer are whole ones
    for used in plan.limit_uses.iter().filter(|used| used.kind == PathLimit::Torque) {
        let joint = used.joint.unwrap();
        assert!(
            (used.limit - peaks[joint]).abs() < 1e-9 || (used.limit - 120.0).abs() < 1e-9,
            "{used:?}"
        );
        assert!((used.margin - (used.limit - used.value.abs()) / used.limit).abs() < 1e-12);
    }
    let (over_move, _) = held(
        &robot,
        &asked,
        Confidence {
            level: 0.95,
            over: Over::Move,
        },
    );
    assert!(over_move.duration > plan.duration);
}

#[test]
fn a_program_of_an_arm_without_variance_is_the_nominal_one() {
    let robot = arm(0.0, 0.0);
    let asked = corner();
    let (plan, report) = held(&robot, &asked, sample(0.99));
    let nominal = crate::path::plan_path(&robot, &asked, &Budget::unlimited()).unwrap();
    assert_eq!(PathOutcome::Plan(Box::new(plan)), nominal);
    assert!(report.joints.iter().all(|joint| joint.set_aside == 0.0));
}

#[test]
fn a_constant_speed_is_lowered_or_refused_for_its_bands() {
    let robot = arm(0.1, 0.05);
    let mut pose = crate::kinematics::pose(&robot, &START, &tcp());
    pose.translation.vector.z += 0.25;
    let mut line = segment(
        Shape::Line {
            target: Target::Pose { pose, frame: None },
        },
        None,
    );
    line.tool_speed = Some(0.6);
    let mut asked = PathRequest {
        tcp: Some(tcp()),
        timing: Timing::ConstantSpeed,
        transition_time: Some(0.08),
        sampling: Sampling::Trace(400),
        ..request(&START, vec![line])
    };
    asked.torque_utilization = 0.75;
    let (plan, report) = held(&robot, &asked, sample(0.99));
    let peaks = peak_torques(&robot);
    let least = least_margin(&robot, &plan, 2.575_829_303_548_901, |joint, _| 0.75 * peaks[joint]);
    assert!(report.holds && least > -1e-6, "{least}");
    assert!(plan.duration >= report.nominal_duration.unwrap());
}

#[test]
fn a_program_that_no_speed_lets_hold_is_refused_with_its_place_and_band() {
    let robot = arm(0.1, 0.4);
    let answer = plan_path(&robot, &corner(), sample(0.99), &Budget::unlimited()).unwrap();
    let PathOutcome::Infeasible(no) = answer.outcome else {
        panic!()
    };
    let band = answer.band.unwrap();
    assert!(
        no.joint.is_some() && no.needed.abs() > no.available && band > 0.0,
        "{no:?}"
    );
    assert!(no.suggestion.contains("99 %"), "{}", no.suggestion);
}
