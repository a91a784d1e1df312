//! Splines of the joints and of the tool, alone and blended.

use super::support::*;
use crate::curve::{Curve, Side};
use crate::path::request::*;
use crate::test_arms::values;

const KINDS: [SplineKind; 4] = [
    SplineKind::Quintic,
    SplineKind::Cubic,
    SplineKind::BSpline,
    SplineKind::Bezier,
];

fn spline(kind: SplineKind, space: Space, points: Vec<Target>, blend: Option<Blend>) -> Segment {
    segment(Shape::Spline(Spline { kind, points, space }), blend)
}

fn joint_points(count: usize, state: &mut u64) -> Vec<Target> {
    let near = |state: &mut u64| {
        let by = values(6, 0.4, state);
        Target::Joints(READY.iter().zip(by).map(|(q, by)| q + by).collect())
    };
    (0..count).map(|_| near(state)).collect()
}

fn tool_points(count: usize, state: &mut u64) -> Vec<Target> {
    let robot = ur5e();
    let near = |state: &mut u64| {
        let by = values(3, 0.08, state).try_into().unwrap();
        to_pose(shifted(&robot, &READY, by, values(3, 0.2, state).try_into().unwrap()))
    };
    (0..count).map(|_| near(state)).collect()
}

fn order(kind: SplineKind) -> usize {
    if kind == SplineKind::Cubic { 2 } else { 3 }
}

#[test]
fn splines_are_as_smooth_as_they_say() {
    let robot = ur5e();
    let state = &mut 14;
    for kind in KINDS {
        for (space, points) in [
            (Space::Joint, joint_points(8, state)),
            (Space::Tool, tool_points(8, state)),
        ] {
            let program = program(&robot, &request(&READY, vec![spline(kind, space, points, None)]));
            assert_eq!(program.continuity as usize, order(kind));
            let stroke = &program.strokes[0];
            check_continuity(stroke, order(kind));
            check_derivatives(stroke, 3);
        }
    }
}

/// Interpolating splines run through every point in order, the others end at the last.
#[test]
fn splines_run_through_their_points() {
    let robot = ur5e();
    let state = &mut 15;
    for kind in [SplineKind::Quintic, SplineKind::Cubic] {
        let points = tool_points(6, state);
        let program = program(
            &robot,
            &request(&READY, vec![spline(kind, Space::Tool, points.clone(), None)]),
        );
        let stroke = &program.strokes[0];
        assert_eq!(stroke.knots().len(), 7);
        for (knot, point) in stroke.knots()[1..].iter().zip(&points) {
            let Target::Pose { pose, .. } = point else {
                panic!("a pose")
            };
            let tool = tool_at(&robot, stroke, *knot);
            assert!((tool.translation.vector - pose.translation.vector).norm() < 1e-11);
            assert!(tool.rotation.angle_to(&pose.rotation) < 1e-7);
        }
    }
    for kind in KINDS {
        let points = joint_points(5, state);
        let Some(Target::Joints(end)) = points.last().cloned() else {
            panic!("joints")
        };
        let program = program(&robot, &request(&READY, vec![spline(kind, Space::Joint, points, None)]));
        let stroke = &program.strokes[0];
        let got = at(stroke, stroke.length(), Side::Before).position;
        assert!(got.iter().zip(&end).all(|(got, asked)| (got - asked).abs() < 1e-12));
    }
}

#[test]
fn splines_blend_with_lines_and_joint_moves() {
    let robot = ur5e();
    let state = &mut 16;
    for kind in KINDS {
        for (space, points) in [
            (Space::Joint, joint_points(6, state)),
            (Space::Tool, tool_points(6, state)),
        ] {
            let lengths = Extent::Lengths {
                before: 0.03,
                after: 0.02,
            };
            let segments = vec![
                line(tool_points(1, state).remove(0), tool_blend(Extent::Radius(0.02))),
                spline(kind, space, points, blend(lengths)),
                line(tool_points(1, state).remove(0), blend(Extent::Fraction(0.3))),
                joint(&READY, None),
            ];
            let Ok(program) = outcome(&robot, &request(&READY, segments)).unwrap() else {
                panic!("{kind:?} {space:?}");
            };
            for stroke in &program.strokes {
                check_continuity(stroke, order(kind));
                check_derivatives(stroke, 8);
            }
        }
    }
}

#[test]
fn points_that_coincide_or_turn_back_are_refused() {
    let robot = ur5e();
    let state = &mut 17;
    let mut points = tool_points(3, state);
    points.insert(1, points[0].clone());
    let twice = spline(SplineKind::Quintic, Space::Tool, points, None);
    let finding = &refused(&robot, &request(&READY, vec![twice]))[0];
    assert!(
        finding.starts_with("segments[0].spline.points[1]: it coincides"),
        "{finding}"
    );
    // out and back on one line: the parabola through the three points has its turning point on it
    let mut out = READY.to_vec();
    out[0] += 0.5;
    let points = vec![Target::Joints(out), Target::Joints(READY.to_vec())];
    let back = spline(SplineKind::Quintic, Space::Joint, points, None);
    let finding = &refused(&robot, &request(&READY, vec![back]))[0];
    assert!(
        finding.starts_with("segments[0].spline.points: the spline comes to a stop"),
        "{finding}"
    );
    let none = spline(SplineKind::Bezier, Space::Joint, Vec::new(), None);
    let finding = &refused(&robot, &request(&READY, vec![none]))[0];
    assert_eq!(finding, "segments[0].spline.points: 0 points, from 1 to 10 can be had");
}

/// Path lengths along a spline of many pieces, from either end, against a fine polyline.
#[test]
fn lengths_on_a_spline_are_measured_along_it() {
    let robot = ur5e();
    let state = &mut 18;
    let lengths = Extent::Lengths {
        before: 0.06,
        after: 0.11,
    };
    let segments = vec![
        spline(SplineKind::Quintic, Space::Tool, tool_points(7, state), blend(lengths)),
        spline(SplineKind::BSpline, Space::Tool, tool_points(9, state), None),
    ];
    let program = program(&robot, &request(&READY, segments));
    let alone = |segment: usize, from: f64, to: f64| {
        // the taught curves themselves: the same segments with an exact stop
        let state = &mut 18;
        let first = spline(SplineKind::Quintic, Space::Tool, tool_points(7, state), None);
        let second = spline(SplineKind::BSpline, Space::Tool, tool_points(9, state), None);
        let stopping = super::support::program(&robot, &request(&READY, vec![first, second]));
        let stroke = &stopping.strokes[segment];
        let point = |i: usize| {
            let part = from + (to - from) * i as f64 / 2000.0;
            tool_at(&robot, stroke, stroke.length() * part).translation.vector
        };
        (1..=2000).map(|i| (point(i) - point(i - 1)).norm()).sum::<f64>()
    };
    let report = &program.blends[0];
    assert!(report.shrunk.is_none(), "{report:?}");
    assert!((alone(0, report.begin.fraction, 1.0) - 0.06).abs() < 1e-5);
    assert!((alone(1, 0.0, report.end.fraction) - 0.11).abs() < 1e-5);
    assert!((alone(0, 0.0, 1.0) / program.tool_lengths[0] - 1.0).abs() < 1e-5);
}
