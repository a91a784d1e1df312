use super::*;
use crate::plan::outcome::MoveOutcome;
use crate::plan::plan_move;
use crate::plan::request::Sampling;
use crate::test_arms::{lift, planar, request, robot};

fn check_request(points: Vec<TrajectoryPoint>) -> CheckRequest {
    CheckRequest {
        points,
        interpolation: None,
        payload: None,
        limits: Vec::new(),
        torque_utilization: 1.0,
        cycle_time: None,
    }
}

fn point(time: f64, position: f64, velocity: f64, acceleration: f64) -> TrajectoryPoint {
    TrajectoryPoint {
        time,
        position: vec![position],
        velocity: vec![velocity],
        acceleration: vec![acceleration],
    }
}

fn check(robot: &Robot, request: &CheckRequest) -> CheckReport {
    check_trajectory(robot, request, &Budget::unlimited()).unwrap()
}

fn findings(robot: &Robot, request: &CheckRequest) -> Vec<String> {
    match check_trajectory(robot, request, &Budget::unlimited()) {
        Err(Failure::Invalid(wrong)) => wrong.into_iter().map(|invalid| invalid.to_string()).collect(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_planned_move_read_back_as_a_trajectory_holds_with_the_margins_of_its_plan() {
    let robot = robot(planar());
    let mut asked = request(&[-0.5, 0.3], &[0.9, -1.2]);
    asked.sampling = Sampling::Period(0.001);
    let MoveOutcome::Plan(plan) = plan_move(&robot, &asked, &Budget::unlimited()).unwrap() else {
        panic!("infeasible");
    };
    let setpoints = plan.setpoints.unwrap();
    let points = (0..setpoints.time.len())
        .map(|k| TrajectoryPoint {
            time: setpoints.time[k],
            position: setpoints.joints.iter().map(|joint| joint.position[k]).collect(),
            velocity: setpoints.joints.iter().map(|joint| joint.velocity[k]).collect(),
            acceleration: Vec::new(),
        })
        .collect();
    let report = check(&robot, &check_request(points));
    assert_eq!(report.interpolation, Interpolation::Cubic);
    assert!((report.duration - plan.duration).abs() < 1e-9);
    for (ours, planned) in report.torque_margins.iter().zip(&plan.torque_margins) {
        // within a period of a switching time a cubic's acceleration overshoots: nowhere else do they differ
        assert!((ours.rms_torque / planned.rms_torque - 1.0).abs() < 1e-2);
        assert!((ours.margin - planned.margin).abs() < 0.5, "{ours:?} {planned:?}");
    }
}

#[test]
fn a_quintic_lift_has_the_torque_of_its_acceleration() {
    let robot = robot(lift(5.0));
    // minimum-jerk motion over 1 m in 1 s: largest acceleration 10/√3 m/s², largest speed 15/8 m/s
    let report = check(
        &robot,
        &check_request(vec![point(0.0, 0.0, 0.0, 0.0), point(1.0, 1.0, 0.0, 0.0)]),
    );
    let largest = 10.0 / 3.0_f64.sqrt();
    let margin = report.torque_margins[0];
    assert!((margin.peak_torque - 5.0 * (10.0 + largest)).abs() < 1e-6, "{margin:?}");
    assert_eq!(margin.phase, Phase::Acceleration);
    let speed = report
        .limit_uses
        .iter()
        .find(|used| used.kind == LimitKind::Velocity)
        .unwrap();
    assert!(
        (speed.value - 15.0 / 8.0).abs() < 1e-12 && (speed.time - 0.5).abs() < 1e-9,
        "{speed:?}"
    );
    assert!(report.holds && report.warnings.is_empty());
}

#[test]
fn broken_limits_are_reported_tightest_first() {
    let robot = robot(lift(5.0));
    let report = check(
        &robot,
        &check_request(vec![point(0.0, 0.0, 0.0, 0.0), point(0.5, 1.0, 0.0, 0.0)]),
    );
    assert!(!report.holds);
    let largest = 4.0 * 10.0 / 3.0_f64.sqrt();
    let first = report.limit_uses[0];
    assert_eq!(first.kind, LimitKind::Velocity);
    assert!(
        (first.excess - (2.0 * 15.0 / 8.0 / 2.0 - 1.0)).abs() < 1e-9,
        "{first:?}"
    );
    let torque = report
        .limit_uses
        .iter()
        .find(|used| used.kind == LimitKind::Torque)
        .unwrap();
    assert!(
        (torque.excess - (5.0 * (10.0 + largest) / 100.0 - 1.0)).abs() < 1e-6,
        "{torque:?}"
    );
}

#[test]
fn friction_turns_with_the_motion_inside_a_segment() {
    let mut spec = lift(1.0);
    spec.joints[0].drive.joint_friction.coulomb_positive = 30.0;
    spec.joints[0].drive.joint_friction.coulomb_negative = 5.0;
    let robot = robot(spec);
    // up and back within one cubic: both directions of friction count
    let points = vec![
        TrajectoryPoint {
            acceleration: Vec::new(),
            ..point(0.0, 0.0, 1.0, 0.0)
        },
        TrajectoryPoint {
            acceleration: Vec::new(),
            ..point(1.0, 0.0, -1.0, 0.0)
        },
    ];
    let report = check(&robot, &check_request(points));
    // constant acceleration −2 m/s²: 10 − 2 + 30 on the way up, 10 − 2 − 5 on the way down
    assert!(
        (report.torque_margins[0].peak_torque - 38.0).abs() < 1e-9,
        "{:?}",
        report.torque_margins
    );
    assert_eq!(report.warnings.len(), 2, "{:?}", report.warnings);
}

#[test]
fn long_trajectories_are_verified_in_pieces_with_the_same_result() {
    let robot = robot(lift(5.0));
    let wave = |k: usize| {
        let t = k as f64 * 0.01;
        point(t, 0.3 * t.sin(), 0.3 * t.cos(), -0.3 * t.sin())
    };
    let report = check(&robot, &check_request((0..1500).map(wave).collect()));
    // acceleration 0.3 m/s² at 3π/2
    let margin = report.torque_margins[0];
    assert!((margin.peak_torque - 5.0 * 10.3).abs() < 1e-6, "{margin:?}");
    assert!((margin.time - 1.5 * std::f64::consts::PI).abs() < 1e-2, "{margin:?}");
}

#[test]
fn what_is_wrong_with_a_trajectory_is_named() {
    let robot = robot(lift(5.0));
    let good = || vec![point(0.0, 0.0, 0.0, 0.0), point(1.0, 1.0, 0.0, 0.0)];
    let first = |change: &dyn Fn(&mut Vec<TrajectoryPoint>)| {
        let mut points = good();
        change(&mut points);
        findings(&robot, &check_request(points))[0].clone()
    };
    assert!(first(&|points| points[1].time = 0.0).starts_with("trajectory.points[1].time_s: 0 must be at least"));
    assert!(first(&|points| points[0].time = f64::NAN).starts_with("trajectory.points[0].time_s"));
    assert!(
        first(&|points| points[1].position = vec![1.0, 2.0]).starts_with("trajectory.points[1].position: 2 values")
    );
    assert!(first(&|points| points[1].velocity[0] = f64::INFINITY).starts_with("trajectory.points[1].velocity[0]"));
    assert!(first(&|points| points[1].velocity[0] = 9.0e8).starts_with("trajectory.points[1]: up to here"));
    assert!(first(&|points| points.truncate(1)).starts_with("trajectory.points: 1 points"));
    assert!(first(&|points| points[0].velocity.clear()).starts_with("trajectory.interpolation"));
}
