//! Timings under jerk limits against closed forms, another solver, and a check in time that shares nothing with them.

use nalgebra::{Isometry3, Vector3};

use super::*;
use crate::curve::Curve;
use crate::measured::Polynomials;
use crate::robot::Robot;
use crate::robot::spec::{Drive, Friction};
use crate::test_arms::{lift, loaded, planar, robot};
use crate::timing::limits::{JointLimits, Limits, Stretch};
use crate::timing::test_curves::{puma560, random_walk, ur5e};
use crate::timing::tests::own_limits;

mod check;
mod iterates;
mod jumps;
mod moving;
mod oracle;

use check::worst_uses;

fn timed(robot: &Robot, curve: &dyn Curve, limits: &Limits, intervals: usize) -> Result<Timing, Obstacle> {
    timed_between(robot, curve, limits, [0.0; 2], intervals)
}

/// With these speeds at the ends.
fn timed_between(
    robot: &Robot,
    curve: &dyn Curve,
    limits: &Limits,
    end_speeds: [f64; 2],
    intervals: usize,
) -> Result<Timing, Obstacle> {
    let tcp = Isometry3::translation(0.05, 0.0, 0.1);
    let task = Task {
        robot,
        tcp: &tcp,
        curve,
        limits,
        end_speeds,
        intervals,
    };
    jerk_limited(&task, &Budget::unlimited()).unwrap()
}

/// Rest to rest over `d` with speed, acceleration and jerk bounded (Biagiotti and Melchiorri 2008, section 3.4).
fn double_s(d: f64, [v, a, j]: [f64; 3]) -> f64 {
    let ramp = |v: f64| {
        if v * j >= a * a {
            v / a + a / j
        } else {
            2.0 * (v / j).sqrt()
        }
    };
    if v * ramp(v) <= d {
        return ramp(v) + d / v;
    }
    if d >= 2.0 * a * a * a / (j * j) {
        let fastest = 0.5 * (-a * a / j + (a * a * a * a / (j * j) + 4.0 * d * a).sqrt());
        return 2.0 * (fastest / a + a / j);
    }
    4.0 * libm::cbrt(0.5 * d / j)
}

fn one_joint(rates: [f64; 3]) -> Limits {
    let [velocity, acceleration, jerk] = rates.map(Some);
    Limits::uniform(Stretch {
        joints: vec![JointLimits {
            velocity,
            acceleration,
            jerk,
            torque: None,
        }],
        ..Stretch::default()
    })
}

/// One joint, straight: seven phases, or fewer where speed or acceleration is not reached.
#[test]
fn one_joint_moves_by_a_double_s() {
    let lift = robot(lift(5.0));
    for (d, rates) in [
        (2.0, [1.0, 3.0, 20.0]),
        (0.5, [1.0, 3.0, 20.0]),
        (0.02, [1.0, 3.0, 20.0]),
        (1.5, [1.0, 30.0, 20.0]),
        (100.0, [1.0, 3.0, 20.0]),
    ] {
        let curve = Polynomials::new(vec![vec![-0.3, d]], 1.0);
        let limits = one_joint(rates);
        let timing = timed(&lift, &curve, &limits, 500).unwrap();
        let (duration, expected) = (timing.law.duration(), double_s(d, rates));
        assert!(
            duration > expected && duration < 1.005 * expected,
            "{d} {rates:?}: {duration} {expected}"
        );
        let [jerk, others] = worst_uses(&lift, &curve, &limits, &timing.law, 4000, 1);
        assert!(jerk <= 1.0 + 1e-4 && others <= 1.0 - 1e-6, "{jerk} {others}");
        assert!(jerk.max(others) > 0.99);
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

fn with_jerk(mut stretch: Stretch, acceleration: f64, jerk: f64) -> Stretch {
    for joint in &mut stretch.joints {
        joint.acceleration = Some(acceleration);
        joint.jerk = Some(jerk);
    }
    stretch
}

/// Every limit along random paths of arms with friction and rotors, against a check in time.
#[test]
fn no_limit_is_broken_between_samples() {
    for (name, arm, jerk) in [
        ("ur5e", with_drives(&ur5e()), 150.0),
        ("puma", with_drives(&puma560()), 120.0),
        (
            "puma, loaded",
            robot(loaded(with_drives(&puma560()).spec().clone())),
            120.0,
        ),
    ] {
        let own = own_limits(&arm);
        let speeds: Vec<f64> = own.joints.iter().map(|joint| joint.velocity.unwrap()).collect();
        let mut paths = 0;
        for seed in 0..25 {
            let curve = random_walk(6, seed as usize % 5, &speeds, 300 + seed);
            let mut stretch = with_jerk(own.clone(), 15.0, jerk);
            if seed % 2 == 0 {
                stretch.tool_velocity = Some(1.5);
                stretch.tool_acceleration = Some(8.0);
            }
            if seed % 3 == 0 {
                // torque alone holds the motion back
                for joint in &mut stretch.joints {
                    joint.acceleration = None;
                }
            }
            let limits = Limits::uniform(stretch);
            match timed(&arm, &curve, &limits, 200) {
                Ok(timing) => {
                    let [jerk, others] = worst_uses(&arm, &curve, &limits, &timing.law, 4000, seed);
                    assert!(
                        jerk <= 1.0 + 1e-3 && others <= 1.0 - 1e-6,
                        "{name} {seed} {jerk} {others}"
                    );
                    assert!(jerk.max(others) > 0.99, "{name} {seed} {jerk} {others}");
                    paths += 1;
                }
                Err(obstacle) => {
                    assert_eq!(obstacle.reason, PathInfeasibleReason::MovingTorque, "{obstacle:?}");
                    assert!(obstacle.needed.abs() >= obstacle.available);
                }
            }
        }
        assert!(paths >= 18, "{name} {paths}");
    }
}

/// Limits that change on the way, on knots and elsewhere, and joints of which some have no jerk limit.
#[test]
fn limits_hold_stretch_by_stretch() {
    let arm = with_drives(&ur5e());
    let own = with_jerk(own_limits(&arm), 15.0, 150.0);
    let curve = random_walk(6, 3, &[3.1; 6], 8);
    let mut slow = own.clone();
    for joint in &mut slow.joints {
        joint.velocity = Some(0.6);
        joint.jerk = Some(40.0);
        joint.acceleration = None;
    }
    slow.joints[2].jerk = None;
    let ends = [0.3, 0.55, 1.0].map(|part| part * curve.length());
    let stretches = [own.clone(), slow, own].into_iter().zip(ends);
    let limits = Limits {
        stretches: stretches.map(|(stretch, end)| Stretch { end, ..stretch }).collect(),
    };
    let timing = timed(&arm, &curve, &limits, 300).unwrap();
    let [jerk, others] = worst_uses(&arm, &curve, &limits, &timing.law, 8000, 4);
    assert!(jerk <= 1.0 + 1e-3 && others <= 1.0 - 1e-6, "{jerk} {others}");
}

/// A finer grid gains little: the spline follows the path.
#[test]
fn refinement_changes_little() {
    let arm = with_drives(&ur5e());
    let limits = Limits::uniform(with_jerk(own_limits(&arm), 15.0, 150.0));
    for seed in [1, 2, 3, 4] {
        let curve = random_walk(6, 3, &[3.1; 6], seed);
        let duration = |intervals| timed(&arm, &curve, &limits, intervals).unwrap().law.duration();
        let (coarse, fine) = (duration(400), duration(1600));
        assert!(fine < coarse && coarse < 1.004 * fine, "{coarse} {fine}");
    }
}

/// Without gravity and friction, limits × (λ, λ², λ³) are those of the same motion λ times as fast.
#[test]
fn without_gravity_limits_scale_with_time() {
    let mut spec = planar();
    spec.gravity = Vector3::zeros();
    let arm = robot(spec);
    let curve = random_walk(2, 3, &[4.0, 5.0], 3);
    let limits = |factor: f64| {
        let mut stretch = own_limits(&arm);
        for joint in &mut stretch.joints {
            joint.velocity = joint.velocity.map(|v| v * factor);
            joint.acceleration = Some(30.0 * factor * factor);
            joint.torque = joint.torque.map(|torque| torque * factor * factor);
            joint.jerk = Some(300.0 * factor * factor * factor);
        }
        Limits::uniform(stretch)
    };
    let first = timed(&arm, &curve, &limits(1.0), 150).unwrap().law.duration();
    let faster = timed(&arm, &curve, &limits(1.7), 150).unwrap().law.duration();
    assert!((first / faster - 1.7).abs() < 1e-6, "{first} {faster}");
}

/// A joint that stands still has only its torque to keep; two points are a path.
#[test]
fn a_joint_that_stands_still_holds_its_torque() {
    let arm = robot(planar());
    let limits = Limits::uniform(with_jerk(own_limits(&arm), 40.0, 400.0));
    let swing = Polynomials::new(vec![vec![-1.0, 1.5], vec![0.4]], 1.0);
    let timing = timed(&arm, &swing, &limits, 200).unwrap();
    let [jerk, others] = worst_uses(&arm, &swing, &limits, &timing.law, 4000, 2);
    assert!(
        jerk <= 1.0 + 1e-3 && others <= 1.0 - 1e-6 && jerk.max(others) > 0.99,
        "{jerk} {others}"
    );
}

/// An arm that cannot hold itself, and a path without length.
#[test]
fn what_cannot_be_timed_is_said() {
    let arm = robot(planar());
    let mut stretch = with_jerk(own_limits(&arm), 40.0, 400.0);
    let swing = Polynomials::new(vec![vec![-1.0, 2.0], vec![0.4, -0.3]], 1.0);
    stretch.joints[0].torque = Some(45.0);
    let weak = timed(&arm, &swing, &Limits::uniform(stretch.clone()), 200).unwrap_err();
    assert_eq!((weak.reason, weak.joint), (PathInfeasibleReason::MovingTorque, Some(0)));
    assert!(weak.needed.abs() > 45.0 && weak.available == 45.0, "{weak:?}");

    stretch.joints[0].torque = None;
    let limits = Limits::uniform(stretch);
    let point = Polynomials::new(vec![vec![-1.0], vec![0.4]], 0.0);
    assert!(timed(&arm, &point, &limits, 100).unwrap().law.duration() <= 0.0);
}

/// Nobody waits: the solver stops.
#[test]
fn a_budget_stops_it() {
    let arm = robot(planar());
    let limits = Limits::uniform(with_jerk(own_limits(&arm), 40.0, 400.0));
    let swing = Polynomials::new(vec![vec![-1.0, 1.5], vec![0.4]], 1.0);
    let tcp = Isometry3::identity();
    let task = Task {
        robot: &arm,
        tcp: &tcp,
        curve: &swing,
        limits: &limits,
        end_speeds: [0.0; 2],
        intervals: 100,
    };
    let looks = std::cell::Cell::new(0);
    let should_stop = || {
        looks.set(looks.get() + 1);
        looks.get() > 20
    };
    assert_eq!(jerk_limited(&task, &Budget::until(&should_stop)), Err(Stopped));
    assert_eq!(looks.get(), 21);
}
