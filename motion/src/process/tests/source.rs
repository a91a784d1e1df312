//! What JPH0743606B2 claims of its form, and where the claim ends.

use super::*;
use crate::process::transition::Polynomial;

/// Velocity from −Δ−/ta to Δ+/ta, acceleration 0 at both ends, p(0) = P− and p(1) = P+: for any three points.
#[test]
fn the_quartic_does_what_the_source_claims() {
    let draw = &mut 1;
    for _ in 0..1000 {
        let (before, corner, after) = (vector(draw), vector(draw), vector(draw));
        let half_time = 0.1 + 0.09 * random(draw);
        let quartic = Polynomial::quartic(&before, &corner, &after);
        let at = |h: f64| {
            let [x, y, z] = quartic.point(Jet::variable(h, 0.5 / half_time)).map(Jet::derivatives);
            [0, 1, 2].map(|order| Vector3::new(x[order], y[order], z[order]))
        };
        for (h, place, leg) in [(0.0, before, corner - before), (1.0, after, after - corner)] {
            let [position, velocity, acceleration] = at(h);
            assert!((position - place).norm() < 1e-15);
            assert!((velocity - leg / half_time).norm() < 1e-14 / half_time);
            assert!(acceleration.norm() < 1e-13 / (half_time * half_time), "{acceleration}");
        }
        // the source's text as it stands: P + Δ− + [(Δ− + Δ+)(2 − h)h² − 2Δ−]h
        let h = 0.5 + 0.5 * random(draw);
        let (minus, plus) = (before - corner, after - corner);
        let text = corner + minus + ((minus + plus) * ((2.0 - h) * h * h) - minus * 2.0) * h;
        assert!((at(h)[0] - text).norm() < 1e-14);
        // from rest it is a straight line, run up by (2 − h)h³
        let from_rest = Polynomial::quartic(&corner, &corner, &after).position(h);
        assert!((from_rest - corner - plus * ((2.0 - h) * h * h * h)).norm() < 1e-14);
    }
}

/// 6 % of Vs and 3.6° at r = 0.1 m, Vs = 0.25 m/s, ta = 0.05 s; the acceleration jumps by Vs²/r.
#[test]
fn at_an_arc_the_source_jumps_and_says_so() {
    let (radius, speed, half_time) = (0.1, 0.25, 0.05);
    let segments = [arc(radius, 2.0)];
    let request = ProcessRequest {
        form: Transition::Source,
        ..asked(&segments, speed, half_time)
    };
    let (motion, report) = run(&request);
    let whole = speed * speed * half_time / (2.0 * radius);
    let [start, stop] = [report.transitions[0], report.transitions[1]];
    for (transition, end) in [(start, start.end_time), (stop, stop.begin_time)] {
        assert!((transition.velocity_jump / whole - 1.0).abs() < 2e-3, "{transition:?}");
        assert!(
            (transition.velocity_jump / speed - 0.0625).abs() < 1e-4,
            "{transition:?}"
        );
        assert!((transition.acceleration_jump / (speed * speed / radius) - 1.0).abs() < 1e-12);
        let velocities = [Side::Before, Side::After].map(|side| state(&motion, end, side)[1]);
        let degrees = velocities[0].angle(&velocities[1]).to_degrees();
        assert!((degrees - 3.58).abs() < 0.005, "{degrees}");
        // the chord's sagitta r(1 − cos(D/2r)); at the taught point itself nothing is cut
        let sagitta = radius * (1.0 - (speed * half_time / (2.0 * radius)).cos());
        assert!((transition.deviation - sagitta).abs() < 1e-12, "{transition:?}");
    }
    let (_, smooth) = run(&asked(&segments, speed, half_time));
    for transition in smooth.transitions {
        assert_eq!(
            (
                transition.velocity_jump,
                transition.acceleration_jump,
                transition.deviation
            ),
            (0.0, 0.0, 0.0)
        );
    }
}

#[test]
fn a_seam_with_an_arc_jumps_in_the_source_and_not_by_default() {
    let segments = line_into_arc(0.1, 2.0);
    let smooth = asked(&segments, 0.25, 0.05);
    let source = ProcessRequest {
        form: Transition::Source,
        ..smooth.clone()
    };
    let (seam, smooth) = (run(&source).1.transitions[1], run(&smooth).1.transitions[1]);
    assert!((seam.velocity_jump / 0.25 - 0.0625).abs() < 1e-4, "{seam:?}");
    assert!((seam.acceleration_jump / 0.625 - 1.0).abs() < 1e-12, "{seam:?}");
    assert_eq!((smooth.velocity_jump, smooth.acceleration_jump), (0.0, 0.0));
    assert!(smooth.deviation < 1e-4 && smooth.lowest_speed > 0.24, "{smooth:?}");
}

/// Between lines both forms are the same curve, and no other segment changes either.
#[test]
fn between_lines_there_is_one_form() {
    let segments = corner(70.0);
    let smooth = asked(&segments, 0.25, 0.05);
    let source = ProcessRequest {
        form: Transition::Source,
        ..smooth.clone()
    };
    let ((a, report), (b, same)) = (run(&smooth), run(&source));
    assert_eq!((report.speed, a.duration()), (same.speed, b.duration()));
    for step in 0..=1000 {
        let time = a.duration() * f64::from(step) / 1000.0;
        let [smooth, source] = [&a, &b].map(|motion| state(motion, time, Side::After));
        for (order, (smooth, source)) in smooth.iter().zip(&source).enumerate() {
            assert!((smooth - source).norm() < [1e-15, 1e-14, 1e-12, 1e-10][order]);
        }
    }
    let node = super::super::transition::Node::Seam;
    let taught: Vec<_> = segments.iter().map(|taught| Segment::new(taught).unwrap()).collect();
    let (before, after) = (taught[0].frame(0.5 - 0.0125), taught[1].frame(0.0125));
    let quintic = Polynomial::quintic(&before, &after, 0.0125);
    let quartic = Polynomial::quartic(
        &before.position,
        &node(&taught[0], &taught[1]).corner(),
        &after.position,
    );
    for step in 0..=100 {
        let h = f64::from(step) / 100.0;
        assert!((quintic.position(h) - quartic.position(h)).norm() < 1e-16);
    }
}

/// At a corner of θ the middle is run at cos(θ/2): 0.86·Vs at 60°. It passes the taught point at ⅜·D·sin(θ/2).
#[test]
fn in_a_corner_the_speed_dips() {
    for degrees in [0.0_f64, 30.0, 60.0, 90.0, 135.0, 180.0] {
        let segments = corner(degrees);
        let (_, report) = run(&asked(&segments, 0.25, 0.05));
        let half = 0.5 * degrees.to_radians();
        let seam = report.transitions[1];
        assert!(
            (seam.lowest_speed - 0.25 * half.cos()).abs() < 1e-12,
            "{degrees}: {seam:?}"
        );
        assert!(
            (seam.deviation - 0.375 * 0.0125 * half.sin()).abs() < 1e-12,
            "{degrees}: {seam:?}"
        );
        assert_eq!(report.lowest, seam.lowest_speed.min(0.25));
        assert_eq!((seam.velocity_jump, seam.acceleration_jump), (0.0, 0.0));
    }
}
