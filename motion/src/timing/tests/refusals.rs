//! Paths that cannot be timed, with the evidence, and odd ones that can.

use super::*;
use crate::robot::spec::Inertial;
use crate::timing::test_curves::square_at;

/// The planar arm stretched out, carrying a mass at its end.
fn loaded(mass: f64) -> Robot {
    robot(planar()).with_payload(&Inertial {
        mass,
        center_of_mass: nalgebra::Vector3::x(),
        inertia: nalgebra::Matrix3::zeros(),
    })
}

/// 70 N m of its own and 20 N m a kilogram where the arm is level, of 120 N m.
#[test]
fn a_payload_that_is_too_heavy_on_the_way_is_refused_with_the_place() {
    let through_level = Polynomials::new(vec![vec![-1.4, 2.4], vec![0.0, 0.1]], 1.0);
    let light = loaded(1.0);
    let mut stretch = own_limits(&light);
    stretch.joints[1].torque = Some(200.0);
    let limits = Limits::uniform(stretch);
    assert!(timed(&light, &through_level, &limits, [0.0; 2], 100).is_ok());

    let heavy = loaded(5.0);
    let obstacle = timed(&heavy, &through_level, &limits, [0.0; 2], 100).unwrap_err();
    assert_eq!(obstacle.reason, PathInfeasibleReason::MovingTorque);
    assert_eq!((obstacle.joint, obstacle.available), (Some(0), 120.0));
    assert!((obstacle.needed.abs() - 170.0).abs() < 1.0, "{obstacle:?}");
    assert!((obstacle.gravity_torque.abs() - 170.0).abs() < 1.0, "{obstacle:?}");
    assert!((obstacle.s - 1.4 / 2.4).abs() < 0.03, "{obstacle:?}");

    let from_level = Polynomials::new(vec![vec![0.0, 1.0], vec![0.0, 0.1]], 1.0);
    let obstacle = timed(&heavy, &from_level, &limits, [0.0; 2], 100).unwrap_err();
    assert_eq!(
        (obstacle.reason, obstacle.s),
        (PathInfeasibleReason::HoldingTorque, 0.0)
    );
}

/// 99 % of the torque for gravity leaves a slow motion, 99.95 % none.
#[test]
fn a_load_near_the_limit_is_moved_slowly_or_not_at_all() {
    for (mass, feasible) in [(9.9, true), (9.995, false), (10.1, false)] {
        let arm = robot(lift(mass));
        let curve = Polynomials::new(vec![vec![-1.0, 0.5]], 1.0);
        let limits = Limits::uniform(own_limits(&arm));
        match timed(&arm, &curve, &limits, [0.0; 2], 100) {
            Ok(timing) => {
                assert!(feasible, "{mass}");
                // 1 N lifts 9.9 kg at 0.1 m/s²: 0.5 m at no less than that, and braking is 200 times as hard
                let expected = (2.0f64 * 0.5 * 9.9).sqrt();
                assert!((timing.law.duration() / expected - 1.0).abs() < 0.05);
                assert!(worst_use(&arm, &curve, &limits, &timing.law, 2000, 1) < 1.0);
            }
            Err(obstacle) => {
                assert!(!feasible && obstacle.joint == Some(0), "{mass} {obstacle:?}");
                assert!(obstacle.needed.abs() >= obstacle.available, "{obstacle:?}");
            }
        }
    }
}

/// 5 kg, 0.1 m: at 10 m/s² up from rest √2 m/s can be reached, and 2 m/s is the speed limit.
#[test]
fn speeds_at_the_ends_are_kept_or_refused_with_what_can_be_had() {
    let arm = robot(lift(5.0));
    let curve = Polynomials::new(vec![vec![-1.0, 0.1]], 1.0);
    let limits = Limits::uniform(own_limits(&arm));

    let law = timed(&arm, &curve, &limits, [10.0, 12.0], 200).unwrap().law;
    assert_eq!(law.at(0.0).velocity, 10.0);
    assert!((law.at(law.duration()).velocity - 12.0).abs() < 1e-12);
    assert!(worst_use(&arm, &curve, &limits, &law, 2000, 1) < 1.0);

    let too_fast = timed(&arm, &curve, &limits, [0.0, 16.0], 200).unwrap_err();
    assert_eq!(
        (too_fast.reason, too_fast.s),
        (PathInfeasibleReason::BoundarySpeed, 1.0)
    );
    assert_eq!(too_fast.needed, 16.0);
    assert!((too_fast.available - 200f64.sqrt()).abs() < 0.05, "{too_fast:?}");

    let too_fast = timed(&arm, &curve, &limits, [30.0, 0.0], 200).unwrap_err();
    assert_eq!(
        (too_fast.reason, too_fast.s),
        (PathInfeasibleReason::BoundarySpeed, 0.0)
    );
    assert!((too_fast.available - 20.0).abs() < 0.05, "{too_fast:?}");
}

/// The elbow stands still on the path; what the shoulder's motion does to it still counts.
#[test]
fn a_joint_that_stands_still_must_hold_its_torque() {
    let arm = robot(planar());
    let curve = Polynomials::new(vec![vec![-1.0, 2.0], vec![0.3]], 1.0);
    let mut stretch = own_limits(&arm);
    stretch.joints[1].torque = Some(22.0);
    let limits = Limits::uniform(stretch);
    let timing = timed(&arm, &curve, &limits, [0.0; 2], 200).unwrap();
    let worst = worst_use(&arm, &curve, &limits, &timing.law, 4000, 2);
    assert!(worst < 1.0 && worst > 0.999, "{worst}");
}

/// A joint turns round in mid path: there its acceleration limit bounds the speed alone (a zero-inertia point).
#[test]
fn a_joint_may_turn_round_on_the_way() {
    let arm = robot(planar());
    let curve = Polynomials::new(vec![vec![-0.5, 2.0, -2.0], vec![0.0, 1.0]], 1.0);
    let joint = |acceleration| JointLimits {
        acceleration: Some(acceleration),
        velocity: Some(50.0),
        ..JointLimits::default()
    };
    let limits = Limits::uniform(Stretch {
        joints: vec![joint(4.0), joint(1e3)],
        ..Stretch::default()
    });
    let law = timed(&arm, &curve, &limits, [0.0; 2], 300).unwrap().law;
    // q″ = −4 and q′ = 0 in the middle: 4·ṡ² ≤ 4
    let [a, _] = square_at(&law, 0.5);
    assert!(a < 1.0 && a > 0.99, "{a}");
    let worst = worst_use(&arm, &curve, &limits, &law, 4000, 3);
    assert!(worst < 1.0 && worst > 0.999, "{worst}");
}

/// A slow middle part: its limits hold there, and only there.
#[test]
fn limits_of_a_stretch_hold_on_it_alone() {
    let arm = ur5e();
    let own = own_limits(&arm);
    let speeds: Vec<f64> = own.joints.iter().map(|joint| joint.velocity.unwrap()).collect();
    let curve = random_walk(6, 2, &speeds, 77);
    let stretch = |end: f64, tool_velocity| Stretch {
        end: end * curve.length(),
        tool_velocity,
        ..own.clone()
    };
    let limits = Limits {
        stretches: vec![stretch(0.4, None), stretch(0.6, Some(0.2)), stretch(1.0, None)],
    };
    let slow = timed(&arm, &curve, &limits, [0.0; 2], 300).unwrap();
    let worst = worst_use(&arm, &curve, &limits, &slow.law, 4000, 4);
    assert!(worst < 1.0, "{worst}");
    let fast = timed(&arm, &curve, &Limits::uniform(own.clone()), [0.0; 2], 300).unwrap();
    assert!(slow.law.duration() > 1.2 * fast.law.duration());
    let [a, _] = square_at(&slow.law, 0.15 * curve.length());
    let [b, _] = square_at(&fast.law, 0.15 * curve.length());
    assert!((a / b - 1.0).abs() < 0.01, "{a} {b}");
}

#[test]
fn a_path_without_limits_or_without_length_still_ends() {
    let arm = robot(planar());
    let curve = Polynomials::new(vec![vec![0.0, 1.0], vec![0.0, 1.0]], 1.0);
    let none = Limits::uniform(Stretch {
        joints: vec![JointLimits::default(); 2],
        ..Stretch::default()
    });
    let duration = timed(&arm, &curve, &none, [0.0; 2], 50).unwrap().law.duration();
    assert!(duration > 0.0 && duration < 1e-3, "{duration}");
    let nowhere = Polynomials::new(vec![vec![0.0], vec![0.0]], 0.0);
    let timing = timed(&arm, &nowhere, &none, [0.0; 2], 50).unwrap();
    assert_eq!((timing.law.duration(), timing.law.times().len()), (0.0, 0));
}

#[test]
fn a_timing_stops_when_nobody_waits() {
    let arm = robot(planar());
    let curve = random_walk(2, 2, &[4.0, 5.0], 3);
    let limits = Limits::uniform(own_limits(&arm));
    let tcp = Isometry3::identity();
    let task = Task {
        robot: &arm,
        tcp: &tcp,
        curve: &curve,
        limits: &limits,
        end_speeds: [0.0; 2],
        intervals: 200,
    };
    for looks in [0, 5, 20] {
        let left = std::cell::Cell::new(looks);
        let stop = || left.replace(left.get().max(1) - 1) == 0;
        assert_eq!(optimal(&task, &Budget::until(&stop)), Err(crate::budget::Stopped));
    }
}

/// Only the last joint turns, about an axis through the tool: limits of the tool's point have nothing to bound.
#[test]
fn a_tool_that_turns_on_the_spot_is_not_bound_by_the_limits_of_its_point() {
    let arm = ur5e();
    let curve = Polynomials::new(
        (0..6)
            .map(|joint| vec![0.3, if joint == 5 { 1.0 } else { 0.0 }])
            .collect(),
        1.0,
    );
    let duration = |tool: Option<f64>| {
        let limits = Limits::uniform(Stretch {
            tool_velocity: tool,
            tool_acceleration: tool,
            ..own_limits(&arm)
        });
        let task = Task {
            robot: &arm,
            tcp: &Isometry3::identity(),
            curve: &curve,
            limits: &limits,
            end_speeds: [0.0; 2],
            intervals: 100,
        };
        optimal(&task, &Budget::unlimited()).unwrap().unwrap().law.duration()
    };
    assert_eq!(duration(Some(1e-3)), duration(None));
}
