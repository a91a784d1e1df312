//! Programs of every kind of segment, blended in every pairing.

use nalgebra::Vector3;

use super::support::*;
use crate::curve::{Curve, Side};
use crate::path::request::*;
use crate::robot::Robot;
use crate::test_arms::{random, values};

/// A program around READY whose poses are all well within reach.
fn random_program(robot: &Robot, blend: impl Fn(&mut u64) -> Option<Blend>, state: &mut u64) -> PathRequest {
    let segments = (0..5)
        .map(|_| {
            let near = |state: &mut u64| {
                let by = values(3, 0.1, state).try_into().unwrap();
                shifted(robot, &READY, by, values(3, 0.3, state).try_into().unwrap())
            };
            let kind = (1.5 * (1.0 + random(state))) as usize;
            match kind {
                0 => {
                    let target = to_pose(near(state));
                    segment(Shape::Joint { target }, blend(state))
                }
                1 => line(to_pose(near(state)), blend(state)),
                _ => {
                    let (point, target) = (to_pose(near(state)), to_pose(near(state)));
                    let orientation = if random(state) < 0.0 {
                        ArcOrientation::Interpolated
                    } else {
                        ArcOrientation::Tangent
                    };
                    arc(
                        Circle::Via { point, second: None },
                        Some(target),
                        orientation,
                        blend(state),
                    )
                }
            }
        })
        .collect();
    request(&READY, segments)
}

fn check_random(space: Space, seed: u64) {
    let robot = ur5e();
    let state = &mut seed.clone();
    let mut blends = 0;
    for _ in 0..30 {
        let blend = |state: &mut u64| {
            let size = 0.5 * (1.0 + random(state));
            let extent = if random(state) < 0.0 {
                Extent::Radius(0.005 + 0.04 * size)
            } else {
                Extent::Fraction(0.05 + 0.4 * size)
            };
            Some(Blend {
                extent,
                space,
                weight: Weight::Smoothstep,
            })
        };
        let request = random_program(&robot, blend, state);
        // a random arc may be large enough to leave the reach
        let Ok(program) = outcome(&robot, &request).unwrap() else {
            continue;
        };
        for stroke in &program.strokes {
            check_continuity(stroke, 3);
            check_derivatives(stroke, seed);
        }
        blends += program.blends.len();
        for report in &program.blends {
            assert!(report.deviation <= 0.1 && report.corner_distance < 0.2, "{report:?}");
        }
    }
    assert!(blends > 40, "{blends}");
}

#[test]
fn random_programs_blended_in_joint_space_are_smooth() {
    check_random(Space::Joint, 31);
}

#[test]
fn random_programs_blended_in_tool_space_are_smooth() {
    check_random(Space::Tool, 32);
}

/// Two lines at a right angle, blended in tool space: in their plane, symmetric, a quarter of the radius off the corner on
/// both.
#[test]
fn two_lines_at_a_right_angle() {
    let robot = ur5e();
    let corner = shifted(&robot, &READY, [0.15, 0.0, 0.0], [0.0; 3]);
    let end = shifted(&robot, &READY, [0.15, 0.15, 0.0], [0.0; 3]);
    let radius = 0.06;
    let segments = vec![
        line(to_pose(corner), tool_blend(Extent::Radius(radius))),
        line(to_pose(end), None),
    ];
    let program = program(&robot, &request(&READY, segments));
    let stroke = &program.strokes[0];
    let knots = stroke.knots();
    assert_eq!(knots.len(), 4);
    let from_corner = |s: f64| tool_at(&robot, stroke, s).translation.vector - corner.translation.vector;
    assert!((from_corner(knots[1]) - Vector3::new(-radius, 0.0, 0.0)).norm() < 1e-9);
    assert!((from_corner(knots[2]) - Vector3::new(0.0, radius, 0.0)).norm() < 1e-9);
    let middle = from_corner(stroke.spans()[0].end);
    assert!((middle - Vector3::new(-0.25 * radius, 0.25 * radius, 0.0)).norm() < 1e-9);
    for i in 0..=50 {
        let s = knots[1] + (knots[2] - knots[1]) * f64::from(i) / 50.0;
        assert!(from_corner(s).z.abs() < 1e-12);
    }
    let report = &program.blends[0];
    let expected = 0.25 * radius * 2f64.sqrt();
    assert!((report.corner_distance - expected).abs() < 1e-3 * radius, "{report:?}");
    assert!((report.deviation - 0.25 * radius).abs() < 1e-3 * radius, "{report:?}");
    check_continuity(stroke, 3);
}

/// Up to a length before the corner the tool is on the line, from a length after it on the next.
#[test]
fn lengths_are_where_lines_begin_and_end() {
    let robot = ur5e();
    let corner = shifted(&robot, &READY, [0.15, 0.0, 0.0], [0.0; 3]);
    let end = shifted(&robot, &READY, [0.1, 0.15, 0.1], [0.3, 0.0, 0.0]);
    let lengths = Extent::Lengths {
        before: 0.03,
        after: 0.08,
    };
    for space in [Space::Joint, Space::Tool] {
        let blend = Some(Blend {
            extent: lengths,
            space,
            weight: Weight::TanSigmoid { a: 3.0 },
        });
        let segments = vec![line(to_pose(corner), blend), line(to_pose(end), None)];
        let program = program(&robot, &request(&READY, segments));
        let stroke = &program.strokes[0];
        let tool = |s: f64| tool_at(&robot, stroke, s).translation.vector;
        let (p2a, p1a) = (tool(stroke.knots()[1]), tool(stroke.knots()[2]));
        assert!(((p2a - corner.translation.vector).norm() - 0.03).abs() < 1e-9);
        assert!(((p1a - corner.translation.vector).norm() - 0.08).abs() < 1e-9);
    }
}

/// Seven joints, blended in tool space: those that are led are mixed, the others follow.
#[test]
fn seven_joints_round_a_corner() {
    let robot = robot(PANDA, "fer_link8");
    let start = [0.0, -0.6, 0.1, -2.2, 0.1, 1.7, 0.7];
    let corner = shifted(&robot, &start, [0.1, 0.0, -0.1], [0.1, 0.2, 0.3]);
    let end = shifted(&robot, &start, [0.1, 0.2, -0.1], [0.0; 3]);
    let segments = vec![
        line(to_pose(corner), tool_blend(Extent::Radius(0.05))),
        line(to_pose(end), None),
    ];
    let program = program(&robot, &request(&start, segments));
    check_continuity(&program.strokes[0], 3);
    check_derivatives(&program.strokes[0], 1);
}

#[test]
fn orientations_too_far_apart_are_refused() {
    let robot = ur5e();
    let corner = shifted(&robot, &READY, [0.05, 0.0, 0.0], [0.0, 0.0, 3.1]);
    let end = shifted(&robot, &READY, [0.05, 0.05, 0.0], [0.0, 0.0, 0.1]);
    let segments = vec![
        line(to_pose(corner), tool_blend(Extent::Fraction(0.99))),
        line(to_pose(end), None),
    ];
    let findings = refused(&robot, &request(&READY, segments));
    assert!(
        findings[0].starts_with("segments[0].blend: the orientations of segments 0 and 1"),
        "{findings:?}"
    );
}

/// A joint move into a line, a line into a joint move: outside the blend the line is a line.
#[test]
fn a_line_between_joint_moves_stays_straight() {
    let robot = ur5e();
    let near = shifted(&robot, &READY, [0.05, 0.05, 0.05], [0.0; 3]);
    let far = shifted(&robot, &READY, [-0.1, 0.15, -0.05], [0.2, 0.1, 0.0]);
    for blend in [blend(Extent::Radius(0.03)), tool_blend(Extent::Radius(0.03))] {
        let segments = vec![
            segment(Shape::Joint { target: to_pose(near) }, blend),
            line(to_pose(far), blend),
            joint(&READY, None),
        ];
        let program = program(&robot, &request(&READY, segments));
        let stroke = &program.strokes[0];
        assert_eq!(stroke.knots().len(), 6);
        let way = far.translation.vector - near.translation.vector;
        for i in 0..=20 {
            let s = stroke.knots()[2] + (stroke.knots()[3] - stroke.knots()[2]) * f64::from(i) / 20.0;
            let from = tool_at(&robot, stroke, s).translation.vector - near.translation.vector;
            assert!((from - way * (from.dot(&way) / way.norm_squared())).norm() < 1e-12);
        }
        check_continuity(stroke, 3);
        check_derivatives(stroke, 4);
        let last = at(stroke, stroke.length(), Side::Before).position;
        assert!(last.iter().zip(READY).all(|(got, asked)| (got - asked).abs() < 1e-13));
    }
}
