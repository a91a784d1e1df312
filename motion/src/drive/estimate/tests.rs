//! The estimator of a whole arm on simulated telemetry.

mod arm;
mod hostile;
mod published;
mod signals;

use super::*;
use crate::drive::telemetry::Telemetry;
use crate::robot::spec::Friction;
use arm::{Recording, feed, friction, options, two_links};

/// The true friction's coefficients are inside intervals of twice the stated width (a chance of one in ten thousand that they are not,
/// and there are a dozen here), which are narrow.
fn check_recovered(report: &EstimateReport, truth: &[Friction], narrow: f64) {
    for (joint, truth) in report.joints.iter().zip(truth) {
        let coefficients = joint.law.coefficients(truth);
        for (found, expected) in joint.coefficients.iter().zip(coefficients) {
            let width = found.upper - found.lower;
            assert!((found.value - expected).abs() < width, "{found:?} for {expected}");
            assert!(width < narrow, "{found:?}");
            assert!(found.told);
        }
        assert_eq!(joint.missing, []);
    }
}

#[test]
fn every_method_recovers_the_friction_from_positions_and_motor_torques() {
    let robot = two_links();
    let truth = [friction(4.0, 1.5), friction(2.0, 0.8)];
    let recording = Recording::of(&robot, &truth).with_noise(0.3);
    for method in [
        EstimatorMethod::LeastSquares,
        EstimatorMethod::Observer,
        EstimatorMethod::Kalman,
    ] {
        let mut estimator = FrictionEstimator::new(robot.clone(), EstimatorOptions { method, ..options() }).unwrap();
        feed(&mut estimator, &recording.telemetry(0.0, 40.0), 100);
        let report = estimator.report();
        for joint in &report.joints {
            println!(
                "{method:?} {:?} {:?} {:?}",
                joint.coefficients, joint.correlation_time, joint.degrees_of_freedom
            );
        }
        check_recovered(&report, &truth, 1.0);
        assert!((report.delay - 3.0 / (std::f64::consts::TAU * 10.0)).abs() < 1e-12);
    }
}

#[test]
fn the_richer_law_finds_load_and_square_and_directions() {
    let robot = two_links();
    let truth = [Friction {
        viscous: 1.5,
        coulomb_positive: 4.0,
        coulomb_negative: 3.0,
        load_coulomb: 0.06,
        quadratic: 0.5,
        presliding_stiffness: None,
    }; 2];
    let law = FrictionLaw {
        by_direction: true,
        load: true,
        quadratic: true,
    };
    let options = EstimatorOptions {
        law,
        memory: Memory::Forever,
        ..options()
    };
    let mut estimator = FrictionEstimator::new(robot.clone(), options).unwrap();
    feed(
        &mut estimator,
        &Recording::of(&robot, &truth).with_noise(0.1).telemetry(0.0, 60.0),
        100,
    );
    let report = estimator.report();
    check_recovered(&report, &truth, 1.5);
    let (torque, deviation) = report.joints[0].torque_at(-1.0, 20.0);
    let expected = law::torque(&truth[0], -1.0, 20.0);
    assert!(
        (torque - expected).abs() < 4.0 * deviation && deviation < 0.1,
        "{torque} ± {deviation}, {expected}"
    );
}

/// What the model knows of load and square is taken off: the two other terms come out as they are, and all four are committed.
#[test]
fn terms_that_the_law_does_not_have_are_held_at_the_models_values() {
    let truth = Friction {
        viscous: 1.5,
        coulomb_positive: 4.0,
        coulomb_negative: 4.0,
        load_coulomb: 0.06,
        quadratic: 0.5,
        presliding_stiffness: None,
    };
    let bare = two_links();
    let telemetry = Recording::of(&bare, &[truth; 2]).telemetry(0.0, 40.0);
    let mut spec = bare.spec().clone();
    for joint in &mut spec.joints {
        joint.drive.motor_friction = Friction::default();
        joint.drive.joint_friction = Friction {
            coulomb_positive: 9.0,
            coulomb_negative: 8.0,
            viscous: 0.1,
            presliding_stiffness: Some(5e3),
            ..truth
        };
    }
    let informed = crate::test_arms::robot(spec);
    let estimate = |robot: &Robot| {
        let mut estimator = FrictionEstimator::new(robot.clone(), options()).unwrap();
        feed(&mut estimator, &telemetry, 100);
        estimator.report()
    };
    let (with, without) = (estimate(&informed), estimate(&bare));
    for (index, joint) in with.joints.iter().enumerate() {
        let [coulomb, viscous] = [0, 1].map(|term| joint.coefficients[term]);
        assert!(
            (coulomb.value - 4.0).abs() < 0.1 && (viscous.value - 1.5).abs() < 0.1,
            "{joint:?}"
        );
        assert_eq!((coulomb.known, viscous.known), (8.5, 0.1));
        let mut drive = informed.spec().joints[index].drive.clone();
        joint.commit(&mut drive);
        let (load, quadratic) = (drive.joint_friction.load_coulomb, drive.joint_friction.quadratic);
        assert_eq!(
            (load, quadratic, drive.joint_friction.presliding_stiffness),
            (0.06, 0.5, Some(5e3))
        );
    }
    let missed = |report: &EstimateReport| (report.joints[0].coefficients[0].value - 4.0).abs();
    assert!(
        missed(&without) > 10.0 * missed(&with),
        "{} {}",
        missed(&without),
        missed(&with)
    );
}

/// Friction that changes is followed, and what came before is forgotten with the half-life.
#[test]
fn it_follows_a_change_of_friction() {
    let robot = two_links();
    let before = [friction(4.0, 1.5), friction(2.0, 0.8)];
    let after = [friction(3.0, 1.0), friction(2.5, 0.8)];
    let options = EstimatorOptions {
        memory: Memory::HalfLife(3.0),
        ..options()
    };
    let mut estimator = FrictionEstimator::new(robot.clone(), options).unwrap();
    feed(
        &mut estimator,
        &Recording::of(&robot, &before).telemetry(0.0, 20.0),
        100,
    );
    feed(
        &mut estimator,
        &Recording::of(&robot, &after).telemetry(20.0, 50.0),
        100,
    );
    for (joint, truth) in estimator.report().joints.iter().zip(&after) {
        // 0.1 N m: what the filter makes of gravity torques of 80 N m
        assert!(
            (joint.coefficients[0].value - truth.coulomb_positive).abs() < 0.05,
            "{joint:?}"
        );
        assert!((joint.coefficients[1].value - truth.viscous).abs() < 0.05, "{joint:?}");
    }
}

#[test]
fn blocks_of_any_size_and_a_change_of_hands_give_the_same_bits() {
    let robot = two_links();
    let recording = Recording::of(&robot, &[friction(4.0, 1.5), friction(2.0, 0.8)]).with_noise(0.2);
    let telemetry = recording.telemetry(0.0, 6.0);
    for method in [
        EstimatorMethod::LeastSquares,
        EstimatorMethod::Observer,
        EstimatorMethod::Kalman,
    ] {
        let options = EstimatorOptions { method, ..options() };
        let mut whole = FrictionEstimator::new(robot.clone(), options.clone()).unwrap();
        feed(&mut whole, &telemetry, 6001);
        let mut parts = FrictionEstimator::new(robot.clone(), options.clone()).unwrap();
        for (index, block) in arm::blocks(&telemetry, 2, 37).into_iter().enumerate() {
            if index % 5 == 3 {
                parts = FrictionEstimator::resume(robot.clone(), options.clone(), &parts.state()).unwrap();
            }
            parts.update(&block, &Budget::unlimited()).unwrap();
        }
        assert_eq!(parts.state(), whole.state());
        assert_eq!(parts.report(), whole.report());
        assert_eq!(parts.combination(), whole.combination());
    }
}

#[test]
fn a_state_of_something_else_is_refused() {
    let robot = two_links();
    let mut estimator = FrictionEstimator::new(robot.clone(), options()).unwrap();
    let recording = Recording::of(&robot, &[friction(4.0, 1.5); 2]);
    feed(&mut estimator, &recording.telemetry(0.0, 2.0), 100);
    let state = estimator.state();
    let resume = |options: EstimatorOptions, state: &EstimatorState| {
        FrictionEstimator::resume(robot.clone(), options, state).map_err(|findings| findings[0].path.clone())
    };
    assert!(resume(options(), &state).is_ok());
    let kalman = EstimatorOptions {
        method: EstimatorMethod::Kalman,
        ..options()
    };
    assert_eq!(resume(kalman, &state).unwrap_err(), "state.counts[0]");
    let mut wrong = state.clone();
    wrong.version = 7;
    assert_eq!(resume(options(), &wrong).unwrap_err(), "state.version");
    let mut wrong = state.clone();
    wrong.reals.pop();
    assert_eq!(resume(options(), &wrong).unwrap_err(), "state.reals");
    let mut wrong = state.clone();
    wrong.reals[3] = f64::NAN;
    assert_eq!(resume(options(), &wrong).unwrap_err(), "state.reals");
    let mut wrong = state.clone();
    wrong.reals.iter_mut().for_each(|value| *value = -1.0);
    assert_eq!(resume(options(), &wrong).unwrap_err(), "state");
    // and numbers that could be a state, but make no sense, do no harm
    let mut wild = state;
    wild.reals
        .iter_mut()
        .for_each(|value| *value = if *value > 0.0 { 1e200 } else { *value });
    if let Ok(mut estimator) = resume(options(), &wild) {
        estimator.time = Some(2.0);
        feed(&mut estimator, &recording.telemetry(2.001, 3.0), 100);
        assert_eq!(estimator.report().joints.len(), 2);
    }
}

#[test]
fn wrong_options_are_named() {
    let wrong = EstimatorOptions {
        memory: Memory::Factor(1.5),
        dead_band: 0.0,
        bandwidth: Some(f64::NAN),
        gap: -1.0,
        correlation_time: f64::INFINITY,
        outlier_threshold: Some(0.0),
        noise: vec![1.0, 0.0],
        priors: vec![
            Some(Prior {
                mean: vec![1.0],
                covariance: vec![1.0, 1.0, 1.0],
            }),
            None,
        ],
        ..EstimatorOptions::default()
    };
    let findings = FrictionEstimator::new(two_links(), wrong).unwrap_err();
    let paths: Vec<&str> = findings.iter().map(|finding| finding.path.as_str()).collect();
    assert_eq!(
        paths,
        [
            "memory.factor",
            "dead_band",
            "gap",
            "correlation_time",
            "outlier_threshold",
            "bandwidth",
            "noise[1]",
            "priors[0].mean",
            "priors[0].covariance"
        ]
    );
}

/// A fit that is sure of itself is not thrown over by a second of motion; what the samples cannot tell stays as it was.
#[test]
fn a_prior_is_a_warm_start() {
    let robot = two_links();
    let truth = [friction(4.0, 1.5), friction(2.0, 0.8)];
    let prior = |friction: &Friction| {
        Some(Prior {
            mean: vec![friction.coulomb_positive, friction.viscous],
            covariance: vec![0.01, 0.0, 0.01],
        })
    };
    let options = EstimatorOptions {
        priors: truth.iter().map(prior).collect(),
        ..options()
    };
    let mut estimator = FrictionEstimator::new(robot.clone(), options).unwrap();
    let still = estimator.report();
    assert!((still.joints[1].coefficients[0].deviation - 0.1).abs() < 1e-12);
    assert!((still.joints[1].coefficients[0].lower - (2.0 - 0.196)).abs() < 1e-4);
    feed(
        &mut estimator,
        &Recording::of(&robot, &truth).with_noise(0.5).telemetry(0.0, 1.5),
        100,
    );
    for (joint, truth) in estimator.report().joints.iter().zip(&truth) {
        assert!(
            (joint.coefficients[0].value - truth.coulomb_positive).abs() < 0.2,
            "{joint:?}"
        );
    }
}
