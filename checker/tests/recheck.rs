//! The recheck finds what is wrong, and nothing where nothing is.

use nalgebra::{Isometry3, Matrix3, Vector3};
use takt_checker::claims::{Figure, false_claims};
use takt_checker::motion::Relation;
use takt_checker::recheck::LengthMismatch;
use takt_checker::{Bounds, Grid, Move, Report, recheck};
use takt_motion::plan::outcome::{Fallback, LimitKind, MovePlan, Pattern, Phase, TorqueMargin};
use takt_motion::plan::request::{LimitOverride, Method, MoveRequest};
use takt_motion::robot::spec::{Drive, Friction, Inertial, JointKind, JointSpec, Limits, RobotSpec};

/// A lift of 10 kg over a lift of 2 kg, in a world where things weigh 10 N a kilogramme, the lower one with friction.
fn two_lifts() -> RobotSpec {
    let lift = |name: &str, mass, drive| JointSpec {
        name: name.to_owned(),
        kind: JointKind::Prismatic,
        parent_from_joint: Isometry3::identity(),
        axis: Vector3::z(),
        link: Inertial {
            mass,
            center_of_mass: Vector3::zeros(),
            inertia: Matrix3::zeros(),
        },
        limits: Limits {
            position_lower: Some(0.0),
            position_upper: Some(2.0),
            velocity: Some(1.0),
            acceleration: Some(4.0),
            ..Limits::default()
        },
        drive,
    };
    let friction = Friction {
        viscous: 6.0,
        coulomb_positive: 5.0,
        coulomb_negative: 3.0,
        ..Friction::default()
    };
    let lower = Drive {
        peak_torque: Some(200.0),
        joint_friction: friction,
        ..Drive::default()
    };
    let upper = Drive {
        peak_torque: Some(40.0),
        ..Drive::default()
    };
    RobotSpec {
        joints: vec![lift("lower", 10.0, lower), lift("upper", 2.0, upper)],
        link_from_tip: Isometry3::identity(),
        gravity: Vector3::new(0.0, 0.0, -10.0),
        payload: Inertial::zero(),
        tcp: Isometry3::identity(),
        frames: Vec::new(),
        uncertainty: None,
    }
}

/// 1 m up in 0.25 + 0.75 + 0.5 s: +4, 0, −2 m/s² (the upper lift, half of that downwards).
fn patterns() -> [Pattern; 2] {
    let up = Pattern {
        displacement: 1.125,
        peak_velocity: 1.0,
        acceleration: 4.0,
        deceleration: 2.0,
        acceleration_time: 0.25,
        cruise_time: 0.75,
        deceleration_time: 0.5,
    };
    let down = Pattern {
        displacement: -0.5625,
        peak_velocity: -0.5,
        acceleration: -2.0,
        deceleration: -1.0,
        ..up
    };
    [up, down]
}

const START: [f64; 2] = [0.25, 1.0];
const TARGET: [f64; 2] = [1.375, 0.4375];

fn report_on(spec: &RobotSpec, patterns: &[Pattern], target: &[f64]) -> Report {
    let planned = Move {
        start: &START,
        target,
        patterns,
    };
    recheck(spec, None, &Bounds::of_robot(spec), &planned, Grid::default()).expect("one entry a joint")
}

fn check(change: impl FnOnce(&mut RobotSpec, &mut [Pattern; 2])) -> Report {
    let mut spec = two_lifts();
    let mut patterns = patterns();
    change(&mut spec, &mut patterns);
    report_on(&spec, &patterns, &TARGET)
}

fn check_relation(relation: Relation, change: impl FnOnce(&mut [Pattern; 2])) {
    let report = check(|_, patterns| change(patterns));
    assert!(
        report.inconsistencies.iter().any(|found| found.relation == relation),
        "{relation:?} not among {:?}",
        report.inconsistencies
    );
    assert!(!report.holds(f64::MAX), "an unsound move never holds");
}

fn check_excess(report: &Report, kind: LimitKind, joint: usize, time: f64, excess: f64) {
    let worst = report.worst().expect("the arm has limits");
    assert_eq!((worst.kind, worst.joint), (kind, joint));
    assert!((worst.extreme.time - time).abs() < 1e-9, "at {} s", worst.extreme.time);
    assert!((worst.excess - excess).abs() < 1e-9, "by {}", worst.excess);
    assert!(!report.holds(0.0) || excess <= 0.0);
}

#[test]
fn sound_move_holds() {
    let report = check(|_, _| ());
    assert_eq!(report.inconsistencies, []);
    assert!(report.holds(0.0), "{:?}", report.worst());
    assert_eq!(report.duration, 1.5);
    assert!(report.sample_count > 1000);
}

#[test]
fn torque_peaks_on_the_near_side_of_a_switching_time() {
    // Lower lift at 0.25 s, still accelerating: 12 kg × 10 + (10 + 2)·4 − 2·2 + 6·1 + 5.
    let report = check(|_, _| ());
    let torque = report.joints[0].torque;
    assert!((torque.value - (120.0 + 44.0 + 6.0 + 5.0)).abs() < 1e-9, "{torque:?}");
    assert!((torque.time - 0.25).abs() < 1e-9);
    assert!((torque.excess.unwrap() - (175.0 / 200.0 - 1.0)).abs() < 1e-9);
}

#[test]
fn torque_peaks_on_the_far_side_of_a_switching_time() {
    // The upper lift goes down by itself and is heaviest from the moment on at which it brakes: 2·(10 + 2).
    let braking = Pattern {
        displacement: -0.4375,
        peak_velocity: -0.5,
        acceleration: -0.5,
        deceleration: -2.0,
        acceleration_time: 1.0,
        cruise_time: 0.25,
        deceleration_time: 0.25,
    };
    let report = report_on(&two_lifts(), &[Pattern::default(), braking], &[0.25, 0.5625]);
    assert_eq!(report.inconsistencies, []);
    let torque = report.joints[1].torque;
    assert_eq!((torque.value, torque.time), (24.0, 1.25));
}

#[test]
fn friction_acts_from_the_first_moment_to_the_last_and_not_at_rest() {
    // Very slow start: 120 + 5 (moving) against 120 (held).
    let report = check(|spec, _| {
        spec.joints[0].drive.joint_friction.viscous = 0.0;
        spec.joints[0].drive.joint_friction.coulomb_positive = 500.0;
    });
    let torque = report.joints[0].torque;
    assert!((torque.value - (120.0 + 44.0 + 500.0)).abs() < 1e-9, "{torque:?}");
    // Still at 0 s: Coulomb friction at the start has the sign of the motion just after.
    assert_eq!(torque.time, 0.0);
}

#[test]
fn pose_that_cannot_be_held_is_found_at_the_ends() {
    // Going down, friction carries part of the load: holding still is the tightest moment.
    let mut spec = two_lifts();
    spec.joints[0].drive.peak_torque = Some(119.0);
    spec.joints[0].drive.joint_friction.coulomb_negative = 60.0;
    let slow = Pattern {
        displacement: -0.2,
        peak_velocity: -0.1,
        acceleration: -0.1,
        deceleration: -0.1,
        acceleration_time: 1.0,
        cruise_time: 1.0,
        deceleration_time: 1.0,
    };
    let planned = [slow, Pattern::default()];
    let report = report_on(&spec, &planned, &[0.05, 1.0]);
    assert_eq!(report.inconsistencies, []);
    check_excess(&report, LimitKind::Torque, 0, 0.0, 120.0 / 119.0 - 1.0);
}

#[test]
fn every_kind_of_limit_is_found_exceeded() {
    let limit = |change: fn(&mut JointSpec)| check(|spec, _| change(&mut spec.joints[0]));
    let report = limit(|joint| joint.drive.peak_torque = Some(140.0));
    check_excess(&report, LimitKind::Torque, 0, 0.25, 0.25);
    let report = limit(|joint| joint.limits.velocity = Some(0.8));
    check_excess(&report, LimitKind::Velocity, 0, 0.25, 0.25);
    let report = limit(|joint| joint.limits.acceleration = Some(3.2));
    check_excess(&report, LimitKind::Acceleration, 0, 0.0, 0.25);
    let report = limit(|joint| joint.limits.deceleration = Some(1.6));
    check_excess(&report, LimitKind::Deceleration, 0, 1.0, 0.25);
    let report = limit(|joint| joint.limits.position_upper = Some(1.125));
    check_excess(&report, LimitKind::PositionUpper, 0, 1.5, 0.25 / 1.125);
    let report = limit(|joint| joint.limits.position_lower = Some(0.5));
    check_excess(&report, LimitKind::PositionLower, 0, 0.0, 0.25 / 1.5);
}

#[test]
fn every_relation_is_found_broken() {
    check_relation(Relation::Finite, |patterns| patterns[0].cruise_time = f64::NAN);
    check_relation(Relation::TimesNotNegative, |patterns| patterns[0].cruise_time = -0.1);
    check_relation(Relation::OneSign, |patterns| patterns[1].deceleration = 1.0);
    check_relation(Relation::Acceleration, |patterns| {
        patterns[0].acceleration *= 1.0 + 1e-8
    });
    check_relation(Relation::Deceleration, |patterns| {
        patterns[0].deceleration *= 1.0 - 1e-8
    });
    check_relation(Relation::Displacement, |patterns| {
        patterns[1].displacement *= 1.0 + 1e-8
    });
    check_relation(Relation::Arrival, |patterns| patterns[1].displacement *= 1.0 + 1e-8);
    check_relation(Relation::EndTogether, |patterns| patterns[1].cruise_time += 1e-7);
    check_relation(Relation::Still, |patterns| {
        patterns[1] = Pattern {
            peak_velocity: 1e-9,
            ..Pattern::default()
        };
    });
}

#[test]
fn roundings_break_no_relation() {
    let report = check(|_, patterns| {
        for pattern in patterns {
            pattern.acceleration *= 1.0 + 1e-12;
            pattern.peak_velocity *= 1.0 - 1e-12;
            pattern.cruise_time *= 1.0 + 1e-12;
        }
    });
    assert_eq!(report.inconsistencies, []);
}

#[test]
fn switching_times_apart_by_a_rounding_are_one() {
    // The upper lift stops speeding up an instant after the lower one has: no state with the one at rest and not the
    // other may count.
    let together = check(|_, _| ());
    let apart = check(|_, patterns| {
        patterns[1].acceleration_time += 2e-8;
        patterns[1].cruise_time -= 2e-8;
    });
    assert_eq!(together.sample_count, apart.sample_count);
    let (one, other) = (together.joints[1].torque.value, apart.joints[1].torque.value);
    assert!((one - other).abs() < 1e-9, "{one} and {other}");
    let truly_apart = check(|_, patterns| {
        patterns[1].acceleration_time += 1e-6;
        patterns[1].cruise_time -= 1e-6;
    });
    assert!(truly_apart.sample_count > apart.sample_count);
}

#[test]
fn no_law_is_followed_beyond_its_part() {
    // The upper lift brakes an instant before the lower one, which cruises at its limit: braking that began with the
    // upper one's would have come from a higher speed.
    let report = check(|_, patterns| {
        patterns[1].cruise_time -= 2e-8;
        patterns[1].deceleration_time += 2e-8;
    });
    let worst = report.worst_of(LimitKind::Velocity).expect("speeds are limited");
    assert_eq!((worst.joint, worst.excess), (0, 0.0));
}

#[test]
fn shortest_of_ramps_is_not_lost() {
    // 1e-8 of the duration, and 2·(10 + 1e6) N.
    let sudden = Pattern {
        displacement: 0.015,
        peak_velocity: 0.01,
        acceleration: 1e6,
        deceleration: 1e6,
        acceleration_time: 1e-8,
        cruise_time: 1.5 - 1e-8,
        deceleration_time: 1e-8,
    };
    let report = report_on(&two_lifts(), &[Pattern::default(), sudden], &[0.25, 1.015]);
    assert_eq!(report.joints[1].torque.value, 2.0 * (10.0 + 1e6));
}

#[test]
fn numbers_that_are_none_exceed_every_limit() {
    let report = check(|spec, _| spec.joints[0].link.mass = f64::NAN);
    assert!(!report.holds(f64::MAX));
    assert_eq!(report.worst_of(LimitKind::Torque).unwrap().excess, f64::INFINITY);
}

#[test]
fn move_that_does_not_move_is_held() {
    let mut spec = two_lifts();
    let still = [Pattern::default(); 2];
    let report = report_on(&spec, &still, &START);
    assert!(report.holds(0.0));
    assert_eq!(report.joints[0].torque.value, 120.0);
    spec.joints[1].drive.peak_torque = Some(16.0);
    check_excess(&report_on(&spec, &still, &START), LimitKind::Torque, 1, 0.0, 0.25);
}

#[test]
fn finer_grid_agrees_within_the_stated_resolution() {
    // A pendulum whose torque has its maximum between the switching times.
    let mut spec = two_lifts();
    spec.joints[0].kind = JointKind::Revolute;
    spec.joints[0].axis = -Vector3::y();
    spec.joints[0].link.center_of_mass = Vector3::new(1.0, 0.0, 0.0);
    spec.joints[0].parent_from_joint = Isometry3::rotation(-Vector3::y() * -1.0);
    let bounds = Bounds::of_robot(&spec);
    let on_grid = |per_move| {
        let planned = Move {
            start: &START,
            target: &TARGET,
            patterns: &patterns(),
        };
        let grid = Grid {
            per_interval: 2,
            per_move,
        };
        recheck(&spec, None, &bounds, &planned, grid).unwrap().joints[0]
    };
    let (coarse, fine) = (on_grid(30), on_grid(30_000));
    let missed = fine.torque.value.abs() - coarse.torque.value.abs();
    assert!(
        missed >= -1e-12 && missed <= 1.01 * coarse.torque_resolution,
        "{missed}, {coarse:?}"
    );
    assert!(fine.torque_resolution < 1e-5 * coarse.torque_resolution);
}

#[test]
fn lists_of_wrong_length_are_refused() {
    let spec = two_lifts();
    let planned = Move {
        start: &START[..1],
        target: &TARGET,
        patterns: &patterns(),
    };
    let refused = recheck(&spec, None, &Bounds::of_robot(&spec), &planned, Grid::default());
    let mismatch = LengthMismatch {
        what: "start",
        found: 1,
        joint_count: 2,
    };
    assert_eq!(refused, Err(mismatch));
    assert_eq!(mismatch.to_string(), "start: 1 entries for 2 joints");
}

#[test]
fn request_puts_its_own_limits_in_force() {
    let spec = two_lifts();
    let request = MoveRequest {
        target_velocity: Some(vec![0.8, 3.0]),
        limits: vec![LimitOverride {
            joint: "upper".to_owned(),
            position_upper: Some(1.5),
            acceleration: Some(2.0),
            peak_torque: Some(39.0),
            ..LimitOverride::default()
        }],
        torque_utilization: 0.5,
        speed_scale: 0.5,
        ..MoveRequest::new(START.to_vec(), TARGET.to_vec())
    };
    let bounds = Bounds::of_request(&spec, &request);
    let lower = Bounds {
        position_lower: Some(0.0),
        position_upper: Some(2.0),
        velocity: Some(0.4),
        acceleration: Some(4.0),
        deceleration: Some(4.0),
        torque: Some(100.0),
    };
    let upper = Bounds {
        position_upper: Some(1.5),
        velocity: Some(0.5),
        acceleration: Some(2.0),
        deceleration: Some(2.0),
        torque: Some(39.0),
        ..lower
    };
    assert_eq!(bounds, [lower, upper]);
}

/// What a truthful planner says of the sound move: peaks and squares by hand.
fn truthful_plan() -> MovePlan {
    // Lower lift: 12·10 + 10·a + 2·(a + a') and friction 6 v + 5; upper: 2·(10 + a + a').
    let ramp = |from: f64, to: f64, time: f64| (from * from + from * to + to * to) / 3.0 * time;
    let lower = ramp(169.0, 175.0, 0.25) + 131.0 * 131.0 * 0.75 + ramp(109.0, 103.0, 0.5);
    let upper = 24.0 * 24.0 * 0.25 + 20.0 * 20.0 * 0.75 + 18.0 * 18.0 * 0.5;
    let cycle_time = 2.0;
    let rms = |moving: f64, holding: f64| f64::sqrt((moving + holding * holding * 0.5) / cycle_time);
    let margin = |joint, limit: f64, peak: f64, rms_torque, peak_motor_speed, peak_power| TorqueMargin {
        joint,
        limit,
        peak_torque: peak,
        time: 0.25,
        phase: Phase::Acceleration,
        margin: (limit - peak) / limit,
        rms_torque,
        rated_torque: None,
        peak_motor_speed,
        peak_power,
    };
    MovePlan {
        duration: 1.5,
        preset_duration: Some(1.5),
        preset_derived: false,
        method: Method::Verified,
        fallback: Fallback::None,
        patterns: patterns().to_vec(),
        torque_margins: vec![
            margin(0, 200.0, 175.0, rms(lower, 120.0), 1.0, 175.0),
            margin(1, 40.0, 24.0, rms(upper, 20.0), 0.5, 12.0),
        ],
        limiting: None,
        raw_excess: 0.0,
        raw_duration: 1.5,
        override_safe: None,
        setpoints: None,
        warnings: Vec::new(),
        torque_utilization: 1.0,
        speed_scale: 1.0,
        cycle_time,
        payload: Inertial::zero(),
    }
}

fn false_figures(change: impl FnOnce(&mut MovePlan)) -> Vec<(Figure, usize)> {
    let spec = two_lifts();
    let mut plan = truthful_plan();
    change(&mut plan);
    let report = report_on(&spec, &patterns(), &TARGET);
    let bounds = Bounds::of_robot(&spec);
    false_claims(&spec, &bounds, &plan, &report, 1e-6)
        .iter()
        .map(|claim| (claim.figure, claim.joint))
        .collect()
}

#[test]
fn truthful_plan_has_no_false_claims() {
    assert_eq!(false_figures(|_| ()), []);
}

#[test]
fn every_false_claim_is_found() {
    let first = |change: fn(&mut TorqueMargin)| false_figures(|plan| change(&mut plan.torque_margins[0]));
    assert_eq!(false_figures(|plan| plan.duration = 1.4), [(Figure::Duration, 0)]);
    assert_eq!(first(|margin| margin.limit = 201.0), [(Figure::TorqueLimit, 0)]);
    assert_eq!(first(|margin| margin.peak_torque = 174.0), [(Figure::PeakTorque, 0)]);
    assert_eq!(first(|margin| margin.margin = 0.12), [(Figure::Margin, 0)]);
    assert_eq!(first(|margin| margin.rms_torque = 100.0), [(Figure::RmsTorque, 0)]);
    assert_eq!(
        first(|margin| margin.peak_motor_speed = 1.1),
        [(Figure::PeakMotorSpeed, 0)]
    );
    assert_eq!(first(|margin| margin.peak_power = f64::NAN), [(Figure::PeakPower, 0)]);
    let missing = false_figures(|plan| plan.torque_margins.truncate(1));
    assert_eq!(missing, [(Figure::Presence, 1)]);
}
