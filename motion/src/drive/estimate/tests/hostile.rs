//! Telemetry as it should not be.

use super::arm::{Recording, blocks, feed, friction, options, two_links};
use super::*;
use crate::test_arms::random;

fn close(report: &EstimateReport, truth: &[Friction], off: f64) {
    for (joint, truth) in report.joints.iter().zip(truth) {
        for (found, expected) in joint.coefficients.iter().zip([truth.coulomb_positive, truth.viscous]) {
            assert!((found.value - expected).abs() < off, "{found:?} for {expected}");
        }
    }
}

/// An hour at rest, with whatever the brakes hold: nothing is learned, nothing is forgotten.
#[test]
fn an_hour_at_rest_leaves_it_unharmed() {
    let robot = two_links();
    let truth = [friction(4.0, 1.5), friction(2.0, 0.8)];
    for method in [
        EstimatorMethod::LeastSquares,
        EstimatorMethod::Observer,
        EstimatorMethod::Kalman,
    ] {
        let mut estimator = FrictionEstimator::new(robot.clone(), EstimatorOptions { method, ..options() }).unwrap();
        feed(&mut estimator, &Recording::of(&robot, &truth).telemetry(0.0, 20.0), 100);
        let before = estimator.report();
        let state = &mut 13;
        for block in 0..360 {
            let telemetry = Telemetry {
                time: (0..1000)
                    .map(|index| 21.0 + 10.0 * f64::from(block) + 0.01 * f64::from(index))
                    .collect(),
                output_position: (0..2000).map(|_| 0.3 + 1e-6 * random(state)).collect(),
                motor_torque: (0..2000).map(|_| 0.3 * random(state)).collect(),
                ..Telemetry::default()
            };
            estimator.update(&telemetry, &Budget::unlimited()).unwrap();
        }
        let after = estimator.report();
        for (before, after) in before.joints.iter().zip(&after.joints) {
            assert_eq!(before.used_count, after.used_count);
            assert!(after.skipped.at_rest > 359_000);
            for (before, after) in before.coefficients.iter().zip(&after.coefficients) {
                assert_eq!(before.value.to_bits(), after.value.to_bits());
                // the Kalman filter's coefficients wander in the meantime, and it says so
                let grown = after.deviation / before.deviation;
                let is_kalman = method == EstimatorMethod::Kalman;
                assert!(
                    if is_kalman { grown > 1.0 } else { grown == 1.0 },
                    "{method:?}: {grown}"
                );
            }
        }
    }
}

#[test]
fn bad_samples_are_counted_and_do_no_harm() {
    let robot = two_links();
    let truth = [friction(4.0, 1.5), friction(2.0, 0.8)];
    let mut telemetry = Recording::of(&robot, &truth).telemetry(0.0, 30.0);
    let bad = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e300];
    for index in 0..30 {
        let (sample, value) = (1000 * index + 500, bad[index % 5]);
        match index % 3 {
            0 => telemetry.output_position[2 * sample] = value,
            1 => telemetry.motor_torque[2 * sample + 1] = value,
            _ => {
                telemetry.time[sample] = if index % 2 == 0 {
                    f64::NAN
                } else {
                    telemetry.time[sample - 7]
                }
            }
        }
    }
    let mut estimator = FrictionEstimator::new(robot, options()).unwrap();
    feed(&mut estimator, &telemetry, 100);
    let report = estimator.report();
    assert_eq!(report.skipped.not_finite + report.skipped.out_of_range, 15);
    assert_eq!(
        (report.skipped.out_of_range, report.skipped.time_went_backwards),
        (4, 5)
    );
    assert_eq!(report.skipped.gaps, 0);
    assert_eq!(report.joints[0].skipped.not_finite, 0);
    assert_eq!(report.joints[1].skipped.not_finite, 10);
    assert_eq!(report.sample_count, 30_000 - 20);
    close(&report, &truth, 0.05);
}

/// A clock that jumps beyond anything is not believed: the samples after it are used.
#[test]
fn one_absurd_time_does_not_end_the_stream() {
    let robot = two_links();
    let truth = [friction(4.0, 1.5), friction(2.0, 0.8)];
    let mut telemetry = Recording::of(&robot, &truth).telemetry(0.0, 20.0);
    telemetry.time[5000] = 1e300;
    telemetry.time[6000] = -1e300;
    let mut estimator = FrictionEstimator::new(robot, options()).unwrap();
    feed(&mut estimator, &telemetry, 100);
    let report = estimator.report();
    assert_eq!((report.skipped.out_of_range, report.sample_count), (2, 19_998));
    close(&report, &truth, 0.05);
}

/// A clock that is set back, and one that jumped forward for a sample, costs a second of samples, not all until the old time is reached. Nor does it matter
/// whether the estimator was put away meanwhile.
#[test]
fn a_clock_that_was_set_costs_a_second() {
    let robot = two_links();
    let truth = [friction(4.0, 1.5), friction(2.0, 0.8)];
    let mut telemetry = Recording::of(&robot, &truth).telemetry(0.0, 30.0);
    telemetry.time[10_000..].iter_mut().for_each(|time| *time -= 3600.0);
    telemetry.time[20_000] = 1.0e9;
    let mut estimator = FrictionEstimator::new(robot.clone(), options()).unwrap();
    for (index, block) in blocks(&telemetry, 2, 100).iter().enumerate() {
        estimator.update(block, &Budget::unlimited()).unwrap();
        if index % 7 == 0 {
            estimator = FrictionEstimator::resume(robot.clone(), options(), &estimator.state()).unwrap();
        }
    }
    let report = estimator.report();
    let lost = report.skipped.time_went_backwards;
    assert!((2000..=2004).contains(&lost), "{lost}");
    // set back, forward, and back from there
    assert_eq!((report.skipped.gaps, report.sample_count), (3, 30_000 - lost));
    close(&report, &truth, 0.05);
}

/// Samples that a network brings late, among others in order, are left out and nothing else.
#[test]
fn late_samples_do_not_set_the_clock() {
    let robot = two_links();
    let truth = [friction(4.0, 1.5), friction(2.0, 0.8)];
    let mut telemetry = Recording::of(&robot, &truth).telemetry(0.0, 20.0);
    // every second one is half a second late
    for index in (600..20_000).step_by(2) {
        telemetry.time[index] -= 0.5;
    }
    let mut estimator = FrictionEstimator::new(robot, options()).unwrap();
    feed(&mut estimator, &telemetry, 100);
    let skipped = estimator.report().skipped;
    assert_eq!((skipped.time_went_backwards, skipped.gaps), (9_700, 0));
}

#[test]
fn jitter_and_gaps_are_lived_with() {
    let robot = two_links();
    let truth = [friction(4.0, 1.5), friction(2.0, 0.8)];
    let state = &mut 17;
    let whole = Recording::of(&robot, &truth).telemetry(0.0, 40.0);
    let mut telemetry = Telemetry::default();
    let mut gaps = 0;
    let mut index = 0;
    while index < whole.time.len() {
        telemetry.time.push(whole.time[index]);
        telemetry
            .output_position
            .extend_from_slice(&whole.output_position[2 * index..2 * index + 2]);
        telemetry
            .motor_torque
            .extend_from_slice(&whole.motor_torque[2 * index..2 * index + 2]);
        // most samples come after 1 to 8 ms, and now and then one after 0.3 s
        let lost = random(state) > 0.997;
        gaps += u64::from(lost && index + 300 < whole.time.len());
        index += if lost {
            300
        } else {
            1 + (4.0 * (1.0 + random(state))) as usize
        };
    }
    let mut estimator = FrictionEstimator::new(robot, options()).unwrap();
    feed(&mut estimator, &telemetry, 33);
    let report = estimator.report();
    assert!(gaps > 2);
    assert_eq!(report.skipped.gaps, gaps);
    close(&report, &truth, 0.1);
}

/// Samples in random order, of random size, with every kind of nonsense: it ends, nothing panics, and what is said is finite.
#[test]
fn nothing_that_a_sample_holds_gets_out() {
    let robot = two_links();
    let state = &mut 23;
    let wild = |state: &mut u64| match (8.0 * random(state)) as i64 {
        -7 => f64::NAN,
        -6 => f64::INFINITY,
        -5 => 1e300,
        -4 => -1e-300,
        6 => 1e4,
        7 => 0.0,
        _ => random(state),
    };
    for method in [
        EstimatorMethod::LeastSquares,
        EstimatorMethod::Observer,
        EstimatorMethod::Kalman,
    ] {
        for law in [0, 5, 7] {
            let options = EstimatorOptions {
                method,
                law: FrictionLaw {
                    by_direction: law & 1 != 0,
                    load: law & 2 != 0,
                    quadratic: law & 4 != 0,
                },
                memory: Memory::Factor(0.9),
                bandwidth: Some(200.0),
                ..options()
            };
            let mut estimator = FrictionEstimator::new(robot.clone(), options).unwrap();
            let mut time = 0.0;
            for _ in 0..200 {
                let telemetry = Telemetry {
                    time: (0..50)
                        .map(|_| {
                            time += 0.01 * (random(state) + 0.8);
                            if random(state) > 0.95 { wild(state) } else { time }
                        })
                        .collect(),
                    output_position: (0..100).map(|_| wild(state)).collect(),
                    output_velocity: (0..100).map(|_| 10.0 * wild(state)).collect(),
                    motor_torque: (0..100).map(|_| 1e3 * wild(state)).collect(),
                    ..Telemetry::default()
                };
                estimator.update(&telemetry, &Budget::unlimited()).unwrap();
            }
            for joint in &estimator.report().joints {
                for coefficient in &joint.coefficients {
                    let finite = [
                        coefficient.value,
                        coefficient.deviation,
                        coefficient.lower,
                        coefficient.upper,
                    ];
                    assert!(finite.iter().all(|value| value.is_finite()), "{joint:?}");
                }
                assert!(joint.residual_rms.is_finite() && joint.residual_tails.is_finite());
            }
            assert!(estimator.state().reals.iter().all(|value| value.is_finite()));
        }
    }
}

#[test]
fn other_columns_too_many_samples_and_an_end_are_said() {
    let robot = two_links();
    let mut estimator = FrictionEstimator::new(robot.clone(), options()).unwrap();
    let telemetry = Recording::of(&robot, &[friction(4.0, 1.5); 2]).telemetry(0.0, 1.0);
    estimator.update(&telemetry, &Budget::unlimited()).unwrap();
    let before = estimator.state();
    let mut other = telemetry.clone();
    other.output_velocity = vec![0.0; 2000];
    assert!(matches!(
        estimator.update(&other, &Budget::unlimited()),
        Err(UpdateError::Invalid(_))
    ));
    let many = Telemetry {
        time: vec![0.0; 1_000_000],
        ..telemetry.clone()
    };
    assert!(matches!(
        estimator.update(&many, &Budget::unlimited()),
        Err(UpdateError::Invalid(_))
    ));
    assert_eq!(estimator.state(), before);
    let stopped = estimator.update(&telemetry, &Budget::until(&|| true));
    assert_eq!(stopped, Err(UpdateError::Stopped));
}

#[test]
fn a_motion_one_way_is_not_enough() {
    let robot = two_links();
    let mut estimator = FrictionEstimator::new(robot, options()).unwrap();
    // 0.3 rad/s for ten seconds
    let count = 10_000;
    let telemetry = Telemetry {
        time: (0..count).map(|index| 0.001 * f64::from(index)).collect(),
        output_position: (0..count).flat_map(|index| [3e-4 * f64::from(index), -1.0]).collect(),
        motor_torque: vec![0.1; 2 * count as usize],
        ..Telemetry::default()
    };
    estimator.update(&telemetry, &Budget::unlimited()).unwrap();
    let report = estimator.report();
    let [ref first, ref second] = report.joints[..] else {
        panic!("two joints")
    };
    assert!(
        matches!(
            first.missing[..],
            [
                MissingExcitation::NegativeDirection { .. },
                MissingExcitation::SpeedsAlike { .. }
            ]
        ),
        "{:?}",
        first.missing
    );
    assert!(matches!(second.missing[..], [MissingExcitation::Motion { .. }]));
    assert!(
        first.missing[1]
            .message()
            .contains("too alike to separate viscous from Coulomb")
    );
}
