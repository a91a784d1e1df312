//! Chains of every kind: continuous in position, velocity and acceleration, at Vs outside of their transitions.

use super::*;

/// Largest difference of the two sides at a time: m, m/s, m/s².
fn jumps(motion: &ConstantSpeedMotion, time: f64) -> [f64; 3] {
    let (before, after) = (state(motion, time, Side::Before), state(motion, time, Side::After));
    [0, 1, 2].map(|order| (after[order] - before[order]).norm())
}

#[test]
fn random_chains_have_no_jumps() {
    let draw = &mut 1;
    for count in (0..300).map(|index| 1 + index % 6) {
        let segments = random_chain(count, draw);
        let speed = 0.3 + 0.25 * random(draw);
        let (motion, report) = run(&asked(&segments, speed, 0.06 + 0.05 * random(draw)));
        let knots = motion.knots();
        assert!(knots.windows(2).all(|pair| pair[0] < pair[1]), "{knots:?}");
        for knot in &knots {
            let jumps = jumps(&motion, *knot);
            assert!(jumps.iter().all(|jump| *jump < 1e-9), "{jumps:?} {report:?}");
        }
        for transition in &report.transitions {
            assert_eq!((transition.velocity_jump, transition.acceleration_jump), (0.0, 0.0));
            for (time, side) in [
                (transition.begin_time, Side::After),
                (transition.end_time, Side::Before),
            ] {
                let [_, velocity, acceleration, _] = state(&motion, time, side);
                let rest = time == 0.0 || time == motion.duration();
                assert!((velocity.norm() - if rest { 0.0 } else { report.speed }).abs() < 1e-12);
                // Vs·(tangential acceleration), or all of it at rest
                let along = if rest {
                    acceleration.norm()
                } else {
                    acceleration.dot(&velocity)
                };
                assert!(along.abs() < 1e-9, "{along}");
            }
        }
        let far = |report: &TransitionReport| report.begin_time..report.end_time;
        for step in 0..200 {
            let time = motion.duration() * f64::from(step) / 200.0;
            if report
                .transitions
                .iter()
                .any(|transition| far(transition).contains(&time))
            {
                continue;
            }
            let [position, velocity, ..] = state(&motion, time, Side::After);
            assert!((velocity.norm() / report.speed - 1.0).abs() < 1e-12);
            let taught = Segment::new(&segments[motion.location(time).segment]).unwrap();
            assert!(taught.distance(&position) < 1e-13);
        }
    }
}

/// Fractions run from 0 to 1 without a jump of their rate or acceleration, and stand at both ends.
#[test]
fn fractions_of_orientation_run_smoothly() {
    let draw = &mut 2;
    for count in [1, 2, 5] {
        let segments = random_chain(count, draw);
        let (motion, _) = run(&asked(&segments, 0.4, 0.08));
        // of every segment, at every time: 0 before it, 1 after it
        let fractions = |time: f64, side: Side| -> Vec<[f64; 3]> {
            let tool = motion.evaluate(time, side);
            (0..count)
                .map(|index| {
                    let jet = match tool.next_fraction {
                        Some(next) if index == tool.segment + 1 => next,
                        _ if index == tool.segment => tool.fraction,
                        _ => Jet::constant(if index < tool.segment { 1.0 } else { 0.0 }),
                    };
                    let [value, first, second, _] = jet.derivatives();
                    [value, first, second]
                })
                .collect()
        };
        for knot in motion.knots() {
            let sides = [Side::Before, Side::After].map(|side| fractions(knot, side));
            for (before, after) in sides[0].iter().zip(&sides[1]) {
                assert!(
                    before.iter().zip(after).all(|(a, b)| (a - b).abs() < 1e-9),
                    "{before:?} {after:?}"
                );
            }
        }
        for (time, value) in [(0.0, 0.0), (motion.duration(), 1.0)] {
            for fraction in fractions(time, Side::After) {
                assert!((fraction[0] - value).abs() < 1e-15 && fraction[1].abs() < 1e-12 && fraction[2].abs() < 1e-9);
            }
        }
        for step in 0..=2000 {
            let time = motion.duration() * f64::from(step) / 2000.0;
            for fraction in fractions(time, Side::After) {
                assert!(
                    (-1e-14..=1.0 + 1e-14).contains(&fraction[0]) && fraction[1] > -1e-12,
                    "{fraction:?}"
                );
            }
        }
    }
}

/// Each derivative against the difference quotient of the one before it.
#[test]
fn derivatives_are_those_of_the_motion() {
    let draw = &mut 3;
    let step = 1e-5;
    for form in [Transition::Smooth, Transition::Source] {
        let segments = random_chain(5, draw);
        let request = ProcessRequest {
            form,
            ..asked(&segments, 0.4, 0.08)
        };
        let (motion, _) = run(&request);
        let knots = motion.knots();
        for _ in 0..500 {
            let time = motion.duration() * (0.5 + 0.5 * random(draw));
            if knots.iter().any(|knot| (knot - time).abs() < 2.0 * step) {
                continue;
            }
            let here = state(&motion, time, Side::After);
            let [early, late] = [time - step, time + step].map(|time| state(&motion, time, Side::After));
            for order in 0..3 {
                let quotient = (late[order] - early[order]) / (2.0 * step);
                let scale = 1.0 + here[order + 1].norm();
                assert!((quotient - here[order + 1]).norm() < 1e-6 * scale, "{order} {quotient}");
            }
        }
    }
}

#[test]
fn the_ends_are_the_taught_points_and_lie_at_rest() {
    let draw = &mut 4;
    for count in 1..8 {
        let segments = random_chain(count, draw);
        let (motion, report) = run(&asked(&segments, 0.4, 0.08));
        let taught: Vec<_> = segments.iter().map(|taught| Segment::new(taught).unwrap()).collect();
        let last = &taught[count - 1];
        let end = motion.duration();
        for (times, place) in [
            ([-1.0, 0.0], taught[0].frame(0.0)),
            ([end, end + 1.0], last.frame(last.length)),
        ] {
            for time in times {
                let [position, velocity, acceleration, _] = state(&motion, time, Side::After);
                assert!((position - place.position).norm() < 1e-14);
                assert!(velocity.norm() < 1e-13 && acceleration.norm() < 1e-10);
            }
        }
        let length: f64 = taught.iter().map(|segment| segment.length).sum();
        assert!((motion.duration() - length / report.speed - 0.16).abs() < 1e-12);
        assert_eq!(motion.passes().len(), count + 1);
    }
}

/// A chain taught backwards is the same motion backwards.
#[test]
fn backwards_is_the_same_way_back() {
    let draw = &mut 6;
    for count in 1..8 {
        let there = random_chain(count, draw);
        let back: Vec<ProcessSegment> = there
            .iter()
            .rev()
            .map(|taught| {
                let segment = Segment::new(taught).unwrap();
                let end = segment.frame(segment.length).position;
                match *taught {
                    ProcessSegment::Line { from, .. } => ProcessSegment::Line { from: end, to: from },
                    ProcessSegment::Arc {
                        center, normal, angle, ..
                    } => ProcessSegment::Arc {
                        center,
                        normal,
                        start: end,
                        angle: -angle,
                    },
                }
            })
            .collect();
        for form in [Transition::Smooth, Transition::Source] {
            let ask = |segments| ProcessRequest {
                form,
                tolerance: Some(2e-3),
                ..asked(segments, 0.4, 0.08)
            };
            let ((forwards, report), (backwards, same)) = (run(&ask(&there)), run(&ask(&back)));
            let duration = forwards.duration();
            assert!((backwards.duration() - duration).abs() < 1e-9);
            assert!((report.lowest - same.lowest).abs() < 1e-9);
            for step in 0..=500 {
                let time = duration * f64::from(step) / 500.0;
                let [position, ..] = state(&forwards, time, Side::After);
                let [other, ..] = state(&backwards, duration - time, Side::After);
                assert!((position - other).norm() < 1e-8, "{count} {step}");
            }
        }
    }
}

/// A full circle, an arc of 300°, and more than one turn: the tool stays on the circle and makes all of its way.
#[test]
fn full_circles_and_more() {
    for angle in [PI, 300_f64.to_radians(), 2.0 * PI, 7.0 * PI, -2.0 * PI] {
        let segments = [arc(0.1, angle)];
        let (motion, report) = run(&asked(&segments, 0.25, 0.05));
        assert!((motion.duration() - (0.1 * angle.abs() / 0.25 + 0.1)).abs() < 1e-13);
        assert_eq!(report.transitions.len(), 2);
        let mut turned = 0.0;
        let mut before = Vector3::new(0.1, 0.0, 0.0);
        for step in 1..=4000 {
            let [position, ..] = state(&motion, motion.duration() * f64::from(step) / 4000.0, Side::After);
            assert!((position.norm() - 0.1).abs() < 1e-15 && position.z == 0.0);
            turned += (before.x * position.y - before.y * position.x).atan2(before.dot(&position));
            before = position;
        }
        assert!((turned - angle).abs() < 1e-12, "{turned}");
    }
}

#[test]
fn locations_run_through_the_chain() {
    let draw = &mut 5;
    let segments = random_chain(4, draw);
    let (motion, report) = run(&asked(&segments, 0.4, 0.08));
    let mut before = (0, 0.0);
    for step in 0..=3000 {
        let at = motion.location(motion.duration() * f64::from(step) / 3000.0);
        let here = (at.segment, at.fraction);
        assert!(here >= before && here.1 <= 1.0, "{before:?} {here:?}");
        before = here;
    }
    assert_eq!(before, (3, 1.0));
    // at a seam's middle the taught point itself
    for transition in &report.transitions[1..4] {
        let at = motion.location(0.5 * (transition.begin_time + transition.end_time) + 1e-12);
        assert!(Some(at.segment) == transition.segment.map(|segment| segment + 1) && at.fraction < 1e-10);
    }
}

/// The generator gives the same set-points as the motion in time, a cycle after the other.
#[test]
fn generated_set_points_are_those_of_the_motion() {
    let (radius, speed, cycle) = (0.1, 0.25, 0.004);
    let segments = [arc(radius, 4.0)];
    let request = ProcessRequest {
        cycle_time: Some(cycle),
        ..asked(&segments, speed, 0.048)
    };
    let (motion, report) = run(&request);
    let start = state(&motion, 0.096, Side::After)[0];
    let circle = generator::CircleGenerator::new(Vector3::zeros(), Vector3::z(), start, report.speed * cycle).unwrap();
    let mut cycles = 0;
    for (index, point) in circle.enumerate() {
        let time = 0.096 + (index + 1) as f64 * cycle;
        if time > motion.duration() - 0.096 + 1e-9 {
            break;
        }
        assert!((state(&motion, time, Side::Before)[0] - point).norm() < 1e-14);
        cycles += 1;
    }
    assert!((f64::from(cycles) * cycle + 0.192 - motion.duration()).abs() < 1e-12);
}
