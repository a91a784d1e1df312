use super::support::*;
use crate::curve::{Curve, Side};
use crate::path::request::*;
use crate::robot::Robot;
use crate::test_arms::{random, values};

const HOME: [f64; 6] = [0.1, -1.4, 1.6, -1.7, -1.5, 0.3];

fn away(joint: usize, by: f64) -> Vec<f64> {
    let mut q = HOME.to_vec();
    q[joint] += by;
    q
}

#[test]
fn one_move_is_straight_and_at_full_speed() {
    let robot = ur5e();
    let target = [0.6, -1.0, 1.2, -1.9, -1.0, 1.3];
    let program = program(&robot, &request(&HOME, vec![joint(&target, None)]));
    let stroke = &program.strokes[0];
    let point = at(stroke, 0.3 * stroke.length(), Side::After);
    let mut fastest = 0.0f64;
    for j in 0..6 {
        let expected = HOME[j] + 0.3 * (target[j] - HOME[j]);
        assert!((point.position[j] - expected).abs() < 1e-14);
        assert_eq!((point.second[j], point.third[j]), (0.0, 0.0));
        fastest = fastest.max(point.first[j].abs() / robot.spec().joints[j].limits.velocity.unwrap());
    }
    assert!((fastest - 1.0).abs() < 1e-14);
    assert_eq!(at(stroke, stroke.length(), Side::Before).position.len(), 6);
    assert_eq!(program.continuity, 3);
}

/// A right angle in joint space, worked out by hand: at the middle x = ½ and w = ½, so that q is a quarter of the
/// extents from the corner.
#[test]
fn the_middle_of_a_blend_is_a_quarter_off() {
    let robot = ur5e();
    let mut corner = away(0, 1.0);
    let first = joint(&corner, blend(Extent::Fraction(0.4)));
    let tip = corner.clone();
    corner[1] += 1.0;
    let program = program(&robot, &request(&HOME, vec![first, joint(&corner, None)]));
    let stroke = &program.strokes[0];
    let middle = stroke.spans()[0].end;
    let point = at(stroke, middle, Side::After);
    assert!((point.position[0] - (tip[0] - 0.1)).abs() < 1e-12, "{point:?}");
    assert!((point.position[1] - (tip[1] + 0.1)).abs() < 1e-12);
    assert_eq!(stroke.knots().len(), 4);
    let location = stroke.location(stroke.knots()[1]);
    assert_eq!(location.segment, 0);
    assert!((location.fraction - 0.6).abs() < 1e-12);
    let location = stroke.location(stroke.knots()[2]);
    assert_eq!(location.segment, 1);
    assert!((location.fraction - 0.4).abs() < 1e-12);
}

/// Up to its helper points a blended program is on its segments exactly.
#[test]
fn outside_its_blends_a_path_is_on_its_segments() {
    let robot = ur5e();
    let lengths = Extent::Lengths {
        before: 0.2,
        after: 0.3,
    };
    let segments = vec![joint(&away(0, 1.0), blend(lengths)), joint(&away(1, 0.5), None)];
    let program = program(&robot, &request(&HOME, segments));
    let stroke = &program.strokes[0];
    let knots = stroke.knots();
    for part in [0.0, 0.5, 1.0] {
        let q = at(stroke, part * knots[1], Side::Before).position;
        assert!((q[0] - HOME[0] - 0.8 * part).abs() < 1e-13);
        assert!((q[1] - HOME[1]).abs() < 1e-13);
        let q = at(stroke, knots[2] + part * (knots[3] - knots[2]), Side::After).position;
        let done = 0.3 + 0.7 * part;
        assert!((q[0] - HOME[0] - (1.0 - done)).abs() < 1e-13);
        assert!((q[1] - HOME[1] - 0.5 * done).abs() < 1e-13);
    }
}

fn random_program(robot: &Robot, state: &mut u64) -> PathRequest {
    let count = 2 + (4.0 * (1.0 + random(state))) as usize;
    let mut q = HOME.to_vec();
    let segments = (0..count)
        .map(|_| {
            let reach = 0.1 + 0.4 * (1.0 + random(state));
            for (q, step) in q.iter_mut().zip(values(robot.joint_count(), reach, state)) {
                *q = (*q + step).clamp(-2.5, 2.5);
            }
            let size = 0.5 * (1.0 + random(state));
            let extent = match (3.0 * size) as usize {
                0 => Extent::Radius(0.3 * size + 0.001),
                1 => Extent::Fraction(0.1 + 0.8 * size),
                _ => Extent::Lengths {
                    before: 0.3 * size + 0.01,
                    after: 0.01 + 0.9 * (1.0 - size),
                },
            };
            let weight = if size < 0.5 {
                Weight::Smoothstep
            } else {
                Weight::TanSigmoid { a: 2.0 + 2.0 * size }
            };
            let blend = Blend {
                extent,
                space: Space::Joint,
                weight,
            };
            joint(&q, Some(blend))
        })
        .collect();
    request(&HOME, segments)
}

#[test]
fn random_programs_are_smooth() {
    let robot = ur5e();
    let state = &mut 3;
    for seed in 0..40 {
        let request = random_program(&robot, state);
        let program = program(&robot, &request);
        assert_eq!(program.blends.len(), request.segments.len() - 1);
        for stroke in &program.strokes {
            check_continuity(stroke, 3);
            check_derivatives(stroke, seed);
            assert_eq!(stroke.spans().last().unwrap().end, stroke.length());
        }
        let last = program.strokes.last().unwrap();
        let end = at(last, last.length(), Side::Before).position;
        let Shape::Joint {
            target: Target::Joints(target),
        } = &request.segments.last().unwrap().shape
        else {
            panic!("a joint segment");
        };
        for (got, expected) in end.iter().zip(target) {
            assert!((got - expected).abs() < 1e-13);
        }
    }
}

#[test]
fn a_radius_is_the_distance_of_both_helper_points() {
    let robot = ur5e();
    let corner = away(0, 0.5);
    let mut end = corner.clone();
    end[1] += 0.6;
    let segments = vec![joint(&corner, blend(Extent::Radius(0.05))), joint(&end, None)];
    let program = program(&robot, &request(&HOME, segments));
    let stroke = &program.strokes[0];
    let tool = |q: &[f64]| crate::kinematics::pose(&robot, q, &tcp()).translation.vector;
    for knot in &stroke.knots()[1..3] {
        let distance = (tool(&at(stroke, *knot, Side::After).position) - tool(&corner)).norm();
        assert!((distance - 0.05).abs() < 1e-9, "{distance}");
    }
    let report = &program.blends[0];
    assert!(report.shrunk.is_none());
    assert!(report.deviation > 0.005 && report.deviation <= report.corner_distance + 1e-12);
    assert!(report.corner_distance < 0.05);
}

#[test]
fn blends_that_meet_share_their_segment() {
    let robot = ur5e();
    let segments = vec![
        joint(&away(0, 1.0), blend(Extent::Fraction(0.9))),
        joint(&away(1, 0.5), blend(Extent::Fraction(0.9))),
        joint(&away(2, 0.5), None),
    ];
    let program = program(&robot, &request(&HOME, segments));
    let stroke = &program.strokes[0];
    assert!(program.blends.iter().all(|report| report.shrunk.is_some()));
    // single, blend, blend, single
    assert_eq!(stroke.knots().len(), 5);
    assert!((program.blends[0].end.fraction - 0.5).abs() < 1e-12);
    assert!((program.blends[1].begin.fraction - 0.5).abs() < 1e-12);
    check_continuity(stroke, 3);
}

#[test]
fn there_and_back_needs_a_stop() {
    let robot = ur5e();
    let segments = vec![joint(&away(0, 1.0), blend(Extent::Fraction(0.3))), joint(&HOME, None)];
    let program = program(&robot, &request(&HOME, segments));
    assert_eq!(program.strokes.len(), 2);
    assert_eq!(program.blends.len(), 1);
    assert!(program.blends[0].shrunk.as_ref().unwrap().contains("turns back"));
    assert!(program.warnings[0].contains("between segments 0 and 1"));
}

#[test]
fn segments_that_go_nowhere_leave_their_dwell_and_their_stop() {
    let robot = ur5e();
    let mut still = joint(&HOME, None);
    still.dwell = 0.25;
    let mut pause = joint(&away(0, 1.0), None);
    pause.dwell = 0.5;
    let segments = vec![
        still,
        joint(&away(0, 1.0), blend(Extent::Fraction(0.3))),
        pause,
        joint(&away(1, 1.0), None),
    ];
    let program = program(&robot, &request(&HOME, segments));
    assert_eq!(program.initial_dwell, 0.25);
    assert_eq!(program.strokes.len(), 2);
    assert_eq!(program.strokes[0].dwell(), 0.5);
    assert_eq!(program.warnings.len(), 2);
    let nowhere = super::support::program(&robot, &request(&HOME, vec![joint(&HOME, None)]));
    assert!(nowhere.strokes.is_empty());
}

#[test]
fn what_is_wrong_is_named_where_it_is() {
    let robot = ur5e();
    let mut wrong = joint(&[0.0; 5], blend(Extent::Fraction(1.0)));
    wrong.dwell = 1.0;
    let radius = joint(&HOME, blend(Extent::Radius(0.0)));
    let far = joint(&[0.0, 0.0, 9.0, 0.0, 0.0, f64::NAN], None);
    let findings = refused(&robot, &request(&HOME, vec![wrong, radius, far]));
    let paths: Vec<&str> = findings
        .iter()
        .map(|finding| finding.split(": ").next().unwrap())
        .collect();
    assert_eq!(
        paths,
        [
            "segments[0].joint.target.position",
            "segments[0].blend.fraction",
            "segments[0].dwell_s",
            "segments[1].blend.radius_m",
            "segments[2].joint.target.position[2]",
            "segments[2].joint.target.position[5]",
        ]
    );
    assert!(refused(&robot, &request(&HOME, Vec::new()))[0].starts_with("segments: "));
}
