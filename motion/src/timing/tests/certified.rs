//! What holds between samples, on random paths of real arms with plausible rotors and friction.

use super::super::rows::{RowPlaces, Rows};
use super::*;
use crate::test_arms::loaded;

/// Torque and speed along random paths, with friction and rotors that real arms have.
#[test]
fn no_limit_is_broken_between_samples() {
    for (name, arm) in [
        ("ur5e", with_drives(&ur5e())),
        ("puma", with_drives(&puma560())),
        ("ur5e, loaded", robot(loaded(with_drives(&ur5e()).spec().clone()))),
    ] {
        let own = own_limits(&arm);
        let speeds: Vec<f64> = own.joints.iter().map(|joint| joint.velocity.unwrap()).collect();
        let mut paths = 0;
        for seed in 0..40 {
            let curve = random_walk(6, 1 + seed as usize % 4, &speeds, 100 + seed);
            let mut stretch = own.clone();
            if seed % 2 == 0 {
                stretch.tool_velocity = Some(1.5);
                stretch.tool_acceleration = Some(8.0);
                for joint in &mut stretch.joints {
                    joint.acceleration = Some(15.0);
                }
            }
            let limits = Limits::uniform(stretch);
            match timed(&arm, &curve, &limits, [0.0; 2], 200) {
                Ok(timing) => {
                    let worst = worst_use(&arm, &curve, &limits, &timing.law, 4000, seed);
                    assert!(worst <= 1.0 - 1e-6, "{name} {seed} {worst}");
                    assert!(worst > 0.99, "{name} {seed} {worst}");
                    paths += 1;
                }
                Err(obstacle) => {
                    assert_eq!(obstacle.reason, PathInfeasibleReason::MovingTorque, "{obstacle:?}");
                    assert!(obstacle.needed.abs() >= obstacle.available);
                }
            }
        }
        assert!(paths >= 30, "{name} {paths}");
    }
}

/// The same arm with plausible rotors and friction: 4 % of the torque Coulomb, 3 % viscous at full speed.
fn with_drives(arm: &Robot) -> Robot {
    let mut spec = arm.spec().clone();
    for joint in &mut spec.joints {
        let (torque, speed) = (joint.drive.peak_torque.unwrap(), joint.limits.velocity.unwrap());
        joint.drive = Drive {
            peak_torque: Some(torque),
            gear_ratio: 100.0,
            rotor_inertia: 4e-7 * torque,
            joint_friction: Friction {
                viscous: 0.03 * torque / speed,
                coulomb_positive: 0.04 * torque,
                coulomb_negative: 0.05 * torque,
                ..Friction::default()
            },
            ..Drive::default()
        };
    }
    robot(spec)
}

/// What certainty and 500 intervals cost, against 4000 intervals without reserve or certificate.
#[test]
fn a_certified_timing_is_within_a_percent_of_the_optimum() {
    for arm in [with_drives(&ur5e()), with_drives(&puma560())] {
        let own = own_limits(&arm);
        let speeds: Vec<f64> = own.joints.iter().map(|joint| joint.velocity.unwrap()).collect();
        let limits = Limits::uniform(own);
        let tcp = Isometry3::identity();
        for seed in 0..6 {
            let curve = random_walk(6, 3, &speeds, 300 + seed);
            let certified = timed(&arm, &curve, &limits, [0.0; 2], 500).unwrap().law.duration();
            let fixed = fixed_nodes(&curve, &limits);
            let grid = Grid::new(even(&fixed, 4000), &fixed, 2);
            let budget = Budget::unlimited();
            let coefficients = Coefficients::compute(&arm, &tcp, &curve, &limits, &grid.places, &budget).unwrap();
            let rooms = Rooms {
                reserve: 0.0,
                ..Rooms::full(&coefficients)
            };
            let problem = Problem {
                rows: rows::RowPlaces::new(&grid, 2),
                grid,
                coefficients,
                limits: &limits,
                ends: [0.0; 2],
            };
            let mut reference = None;
            let mut squares = Vec::new();
            for _ in 0..4 {
                squares = problem.solve(&rooms, reference, &budget).unwrap().unwrap();
                reference = Some(problem.reference(&problem.grid.nodes, &squares));
            }
            let optimum = TimeLaw::linear(&problem.grid.nodes, &squares).unwrap().duration();
            assert!(certified < 1.01 * optimum, "{certified} {optimum}");
            assert!(certified > 0.999 * optimum, "{certified} {optimum}");
        }
    }
}

/// Rows that know of each interval only where it begins, as a plain collocation does: limits are broken on the way to the
/// next node, and both the certificate and the check above see it.
#[test]
fn rows_at_the_beginning_of_intervals_alone_break_limits() {
    let arm = ur5e();
    let own = own_limits(&arm);
    let speeds: Vec<f64> = own.joints.iter().map(|joint| joint.velocity.unwrap()).collect();
    let limits = Limits::uniform(own);
    let budget = Budget::unlimited();
    for seed in 0..10 {
        let curve = random_walk(6, 3, &speeds, 500 + seed);
        let fixed = fixed_nodes(&curve, &limits);
        let grid = Grid::new(even(&fixed, 200), &fixed, CHECK_PARTS);
        let tcp = Isometry3::identity();
        let coefficients = Coefficients::compute(&arm, &tcp, &curve, &limits, &grid.places, &budget).unwrap();
        let blind = RowPlaces {
            samples: grid.first.iter().flat_map(|first| [*first; 2]).collect(),
            first: (0..grid.interval_count()).map(|interval| 2 * interval).collect(),
            parts: 1,
        };
        let rows = Rows::new(&coefficients, &limits, &Rooms::full(&coefficients), &blind, None);
        let squares = reach::fastest(&grid, &rows, [0.0; 2], &budget).unwrap().unwrap();
        let law = TimeLaw::linear(&grid.nodes, &squares).unwrap();
        let worst = worst_use(&arm, &curve, &limits, &law, 4000, seed);
        assert!(worst > 1.002, "{seed} {worst}");
        let certificate = Certificate {
            grid: &grid,
            coefficients: &coefficients,
            limits: &limits,
        };
        let verdict = tighten::judge(&certificate, &squares, &budget).unwrap();
        assert!(verdict.worst >= worst - 1e-6, "{seed} {} {worst}", verdict.worst);
    }
}

/// Speeds at both ends, with friction.
#[test]
fn no_limit_is_broken_between_speeds_at_the_ends() {
    for (name, arm) in [
        ("ur5e", with_drives(&ur5e())),
        ("puma, loaded", robot(loaded(with_drives(&puma560()).spec().clone()))),
    ] {
        let own = own_limits(&arm);
        let speeds: Vec<f64> = own.joints.iter().map(|joint| joint.velocity.unwrap()).collect();
        let limits = Limits::uniform(own);
        for seed in 0..10 {
            let curve = random_walk(6, 2, &speeds, 700 + seed);
            let timing = timed(&arm, &curve, &limits, [0.3, 0.4], 200).unwrap();
            let worst = worst_use(&arm, &curve, &limits, &timing.law, 4000, seed);
            assert!(worst <= 1.0 - 1e-6 && worst > 0.99, "{name} {seed} {worst}");
            let ends = [timing.law.at(0.0), timing.law.at(timing.law.duration())].map(|end| end.velocity);
            assert!(
                (ends[0] - 0.3).abs() < 1e-12 && (ends[1] - 0.4).abs() < 1e-12,
                "{ends:?}"
            );
        }
    }
}

/// Arms with axes anywhere and sliding joints, three stretches of limits, any number of joints.
#[test]
fn no_limit_is_broken_by_random_arms() {
    let mut paths = 0;
    for seed in 0..24 {
        let count = 2 + seed as usize % 8;
        let mut spec = crate::test_arms::random_arm(count, 40 + seed);
        for joint in &mut spec.joints {
            joint.drive.peak_torque = Some(900.0);
        }
        let arm = robot(if seed % 2 == 0 { spec } else { loaded(spec) });
        let curve = random_walk(count, 2, &vec![3.0; count], 800 + seed);
        let own = own_limits(&arm);
        let stretch = |end: f64, tool: f64, acceleration| Stretch {
            end: end * curve.length(),
            tool_velocity: Some(tool),
            tool_acceleration: Some(10.0 * tool),
            joints: own
                .joints
                .iter()
                .map(|joint| JointLimits { acceleration, ..*joint })
                .collect(),
        };
        let limits = Limits {
            stretches: vec![
                stretch(0.3, 3.0, None),
                stretch(0.7, 1.0, Some(8.0)),
                stretch(1.0, 5.0, None),
            ],
        };
        let timing = match timed(&arm, &curve, &limits, [0.0; 2], 200) {
            Ok(timing) => timing,
            Err(obstacle) => {
                assert_eq!(
                    obstacle.reason,
                    PathInfeasibleReason::MovingTorque,
                    "{seed} {obstacle:?}"
                );
                continue;
            }
        };
        paths += 1;
        let worst = worst_use(&arm, &curve, &limits, &timing.law, 4000, seed);
        assert!(worst <= 1.0 - 1e-6 && worst > 0.99, "{seed} {worst}");
    }
    assert!(paths >= 12, "{paths}");
}
