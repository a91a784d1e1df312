//! Motions with a speed at an end: closed forms, symmetry, limits, and what is refused.

use super::*;
use crate::test_arms::random;

/// From one speed to another, accelerating from 0 to 0: time and distance.
fn ramp(from: f64, to: f64, [a, j]: [f64; 2]) -> [f64; 2] {
    let change = (to - from).abs();
    let time = if change * j >= a * a {
        change / a + a / j
    } else {
        2.0 * (change / j).sqrt()
    };
    [time, 0.5 * (from + to) * time]
}

/// The fastest way over `d` between two speeds (Biagiotti and Melchiorri 2008, section 3.4.2).
fn double_s_between(d: f64, [from, to]: [f64; 2], [v, a, j]: [f64; 3]) -> f64 {
    let both = |peak: f64| {
        let (up, down) = (ramp(from, peak, [a, j]), ramp(peak, to, [a, j]));
        [up[0] + down[0], up[1] + down[1]]
    };
    let (mut low, mut high) = (from.max(to), v);
    if both(high)[1] <= d {
        let [time, way] = both(high);
        return time + (d - way) / high;
    }
    assert!(both(low)[1] <= d);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if both(middle)[1] <= d {
            low = middle
        } else {
            high = middle
        }
    }
    let [time, way] = both(low);
    time + (d - way) / low
}

const RATES: [f64; 3] = [1.0, 3.0, 20.0];

fn straight(d: f64) -> Polynomials {
    Polynomials::new(vec![vec![-0.3, d]], 1.0)
}

/// One joint over `d` between two of its speeds.
fn over(d: f64, speeds: [f64; 2], rates: [f64; 3]) -> Result<Timing, Obstacle> {
    let lift = robot(lift(5.0));
    timed_between(&lift, &straight(d), &one_joint(rates), speeds.map(|v| v / d), 500)
}

/// One joint, straight: from speed to speed, through the largest speed or below it, and at one speed all the way.
#[test]
fn one_joint_moves_by_a_double_s_between_speeds() {
    let lift = robot(lift(5.0));
    for (d, speeds) in [
        (2.0, [0.5, 0.3]),
        (2.0, [0.0, 0.9]),
        (2.0, [0.9, 0.0]),
        (0.4, [0.2, 0.6]),
        (0.4, [0.6, 0.2]),
        (0.05, [0.3, 0.3]),
        (0.02, [0.02, 0.0]),
        (5.0, [0.99, 0.99]),
        (2.0, [1e-3, 0.5]),
        (2.0, [1e-6, 1e-6]),
        (2.0, [1e-9, 0.0]),
    ] {
        let timing = over(d, speeds, RATES).unwrap();
        let (duration, expected) = (timing.law.duration(), double_s_between(d, speeds, RATES));
        assert!(
            duration > (1.0 - 1e-5) * expected && duration < 1.01 * expected,
            "{d} {speeds:?}: {duration} {expected}"
        );
        for (time, speed) in [(0.0, speeds[0]), (duration, speeds[1])] {
            let at = timing.law.at(time);
            assert!((at.velocity * d - speed).abs() <= 1e-9 * speed, "{d} {speeds:?} {at:?}");
            if speed > 0.0 {
                assert!((at.acceleration * d).abs() < 1e-6, "{d} {speeds:?} {at:?}");
            }
        }
        let [jerk, others] = worst_uses(&lift, &straight(d), &one_joint(RATES), &timing.law, 4000, 1);
        assert!(jerk <= 1.0 + 1e-4 && others <= 1.0 - 1e-6, "{jerk} {others}");
    }
}

/// Over 0.2 m, one speed is the largest from which the arm comes to rest, and to which it comes from rest.
#[test]
fn speeds_that_cannot_be_had_are_refused_with_the_largest() {
    let d = 0.2;
    let (mut low, mut high) = (0.0, RATES[0]);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if ramp(0.0, middle, [RATES[1], RATES[2]])[1] <= d {
            low = middle
        } else {
            high = middle
        }
    }
    let largest = low;
    for (side, s) in [(0, 0.0), (1, 1.0)] {
        let speeds = |part: f64| {
            let mut speeds = [0.0; 2];
            speeds[side] = part * largest;
            speeds
        };
        let near = over(d, speeds(0.99), RATES).unwrap();
        let expected = double_s_between(d, speeds(0.99), RATES);
        assert!((near.law.duration() / expected - 1.0).abs() < 0.01);
        for part in [1.01, 1.5, 100.0] {
            let refused = over(d, speeds(part), RATES).unwrap_err();
            assert_eq!((refused.reason, refused.s), (PathInfeasibleReason::BoundarySpeed, s));
            assert!((refused.needed * d - part * largest).abs() < 1e-9);
            assert!((refused.available * d / largest - 1.0).abs() < 0.005, "{refused:?}");
        }
    }
    // too fast for what comes then, and too fast for what was before
    for (speeds, s) in [([0.9, 0.1], 0.0), ([0.1, 0.9], 1.0)] {
        let refused = over(d, speeds, RATES).unwrap_err();
        assert_eq!((refused.reason, refused.s), (PathInfeasibleReason::BoundarySpeed, s));
    }
}

/// A speed above what the joint may have at all is refused with that; just below it, kept.
#[test]
fn a_speed_at_its_own_limit_is_kept_or_refused() {
    for speeds in [[0.9994, 0.0], [0.0, 0.9994], [0.9994, 0.9994]] {
        let timing = over(3.0, speeds, RATES).unwrap();
        let expected = double_s_between(3.0, speeds, RATES);
        assert!((timing.law.duration() / expected - 1.0).abs() < 0.01);
    }
    let refused = over(3.0, [0.0, 1.2], RATES).unwrap_err();
    assert_eq!((refused.reason, refused.s), (PathInfeasibleReason::BoundarySpeed, 1.0));
    assert!((refused.available * 3.0 - 1.0).abs() < 1e-3, "{refused:?}");
}

/// Without friction a motion run backwards takes the same torques: the way back takes as long.
#[test]
fn the_way_back_takes_as_long() {
    let arm = ur5e();
    let limits = Limits::uniform(with_jerk(own_limits(&arm), 15.0, 150.0));
    let joint = |joint: usize| [0.1 * joint as f64 - 1.0, 1.0 - 0.3 * joint as f64, 0.8, -0.6];
    let there = Polynomials::new((0..6).map(|j| joint(j).to_vec()).collect(), 1.0);
    // q(1 - s)
    let mirrored = |[c0, c1, c2, c3]: [f64; 4]| vec![c0 + c1 + c2 + c3, -c1 - 2.0 * c2 - 3.0 * c3, c2 + 3.0 * c3, -c3];
    let back = Polynomials::new((0..6).map(|j| mirrored(joint(j))).collect(), 1.0);
    for [v0, v1] in [[0.5, 0.0], [0.0, 0.8], [0.4, 0.7]] {
        let duration = |curve: &Polynomials, speeds| {
            let timing = timed_between(&arm, curve, &limits, speeds, 300).unwrap();
            timing.law.duration()
        };
        let (one, other) = (duration(&there, [v0, v1]), duration(&back, [v1, v0]));
        assert!((one / other - 1.0).abs() < 2e-3, "{one} {other}");
        assert!(one < duration(&there, [0.0; 2]));
    }
}

/// Every limit along random paths of an arm with friction and rotors, with speeds at either end or both, against a check in
/// time; what is refused is refused for its ends.
#[test]
fn no_limit_is_broken_with_speeds_at_the_ends() {
    let arm = with_drives(&puma560());
    let own = own_limits(&arm);
    let speeds: Vec<f64> = own.joints.iter().map(|joint| joint.velocity.unwrap()).collect();
    let state = &mut 17;
    let (mut planned, mut refused) = (0, 0);
    for seed in 0..40 {
        let curve = random_walk(6, seed as usize % 5, &speeds, 300 + seed);
        let mut stretch = with_jerk(own.clone(), 15.0, 120.0);
        if seed % 2 == 0 {
            stretch.tool_velocity = Some(1.5);
            stretch.tool_acceleration = Some(8.0);
        }
        if seed % 3 == 0 {
            for joint in &mut stretch.joints {
                joint.acceleration = None;
            }
        }
        let limits = Limits::uniform(stretch);
        let Ok(rest) = timed(&arm, &curve, &limits, 200) else {
            continue;
        };
        let fastest = curve.length() / rest.law.duration();
        let mut draw = || (0.5 + 0.5 * random(state)) * fastest;
        let ends = match seed % 4 {
            0 => [draw(), 0.0],
            1 => [0.0, draw()],
            _ => [draw(), draw()],
        };
        match timed_between(&arm, &curve, &limits, ends, 200) {
            Ok(timing) => {
                let [jerk, others] = worst_uses(&arm, &curve, &limits, &timing.law, 4000, seed);
                assert!(jerk <= 1.0 + 1e-3 && others <= 1.0 - 1e-6, "{seed} {jerk} {others}");
                assert!(jerk.max(others) > 0.98, "{seed} {jerk} {others}");
                for (time, speed) in [(0.0, ends[0]), (timing.law.duration(), ends[1])] {
                    assert!((timing.law.at(time).velocity - speed).abs() <= 1e-9 * speed);
                }
                planned += 1;
            }
            Err(obstacle) => {
                assert_eq!(
                    obstacle.reason,
                    PathInfeasibleReason::BoundarySpeed,
                    "{seed} {obstacle:?}"
                );
                assert!(obstacle.available < obstacle.needed, "{seed} {obstacle:?}");
                refused += 1;
            }
        }
    }
    assert!(planned >= 20, "{planned} {refused}");
}
