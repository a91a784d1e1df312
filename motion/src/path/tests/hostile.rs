//! Requests that nobody means: an answer or a reason, never a panic, and never a path with a hole.

use nalgebra::{Isometry3, Vector3};

use super::support::*;
use crate::budget::Budget;
use crate::curve::{Curve, Side};
use crate::path::build;
use crate::path::request::*;
use crate::plan::Failure;
use crate::robot::Robot;
use crate::test_arms::{planar, random, random_arm, values};

const ODD: [f64; 12] = [
    0.0,
    -0.0,
    1e-300,
    1e-12,
    1e-9,
    1e-5,
    0.1,
    1.0,
    3.0,
    1e5,
    1e300,
    f64::INFINITY,
];

fn odd(state: &mut u64) -> f64 {
    if random(state) < 0.6 {
        return 0.2 + 0.15 * random(state);
    }
    let index = (6.0 * (1.0 + random(state))) as usize;
    let value = ODD[index.min(11)];
    if random(state) < -0.9 {
        f64::NAN
    } else {
        value * random(state).signum()
    }
}

fn target(robot: &Robot, state: &mut u64) -> Target {
    if random(state) < 0.0 {
        let reach = if random(state) < 0.0 { 1e-9 } else { 1.0 };
        return Target::Joints(values(robot.joint_count(), reach, state));
    }
    if random(state) < 0.6 {
        return to_pose(shifted(
            robot,
            &vec![0.3; robot.joint_count()],
            [0.05, odd(state).clamp(-0.1, 0.1), 0.0],
            [0.1; 3],
        ));
    }
    to_pose(Isometry3::translation(odd(state), odd(state), odd(state)))
}

fn shape(robot: &Robot, state: &mut u64) -> Shape {
    let vector = |state: &mut u64| Vector3::new(odd(state), odd(state), odd(state));
    match (3.0 * (1.0 + random(state))) as usize {
        0 => Shape::Joint {
            target: target(robot, state),
        },
        1 => Shape::Line {
            target: target(robot, state),
        },
        2 | 3 => {
            let circle = match (1.5 * (1.0 + random(state))) as usize {
                0 => Circle::Via {
                    point: target(robot, state),
                    second: (random(state) < 0.0).then(|| target(robot, state)),
                },
                1 => Circle::Center {
                    center: vector(state),
                    normal: (random(state) < 0.0).then(|| vector(state)),
                    long_way: random(state) < 0.0,
                    frame: None,
                },
                _ => Circle::Radius {
                    radius: odd(state),
                    normal: vector(state),
                    long_way: random(state) < 0.0,
                    frame: None,
                },
            };
            Shape::Arc(Arc {
                circle,
                target: (random(state) < 0.5).then(|| target(robot, state)),
                orientation: if random(state) < 0.0 {
                    ArcOrientation::Tangent
                } else {
                    ArcOrientation::Interpolated
                },
            })
        }
        _ => {
            let kinds = [
                SplineKind::Quintic,
                SplineKind::Cubic,
                SplineKind::BSpline,
                SplineKind::Bezier,
            ];
            let count = (5.0 * (1.0 + random(state))) as usize;
            Shape::Spline(Spline {
                kind: kinds[((2.0 * (1.0 + random(state))) as usize).min(3)],
                points: (0..count).map(|_| target(robot, state)).collect(),
                space: if random(state) < 0.0 { Space::Joint } else { Space::Tool },
            })
        }
    }
}

fn any_blend(state: &mut u64) -> Option<Blend> {
    let extent = match (2.0 * (1.0 + random(state))) as usize {
        0 => return None,
        1 => Extent::Radius(odd(state)),
        2 => Extent::Fraction(odd(state)),
        _ => Extent::Lengths {
            before: odd(state),
            after: odd(state),
        },
    };
    Some(Blend {
        extent,
        space: if random(state) < 0.0 { Space::Joint } else { Space::Tool },
        weight: if random(state) < 0.0 {
            Weight::Smoothstep
        } else {
            Weight::TanSigmoid { a: odd(state) }
        },
    })
}

#[test]
fn odd_requests_end_in_an_answer() {
    let state = &mut 99;
    let robots: Vec<Robot> = [
        planar(),
        random_arm(1, 1),
        random_arm(4, 2),
        random_arm(6, 3),
        random_arm(8, 4),
    ]
    .into_iter()
    .map(|spec| Robot::new(spec, Vec::new()).unwrap())
    .chain([ur5e()])
    .collect();
    let mut counts = [0; 3];
    for round in 0..1500 {
        let robot = &robots[round % robots.len()];
        let count = 1 + (2.0 * (1.0 + random(state))) as usize;
        let segments = (0..count)
            .map(|_| segment(shape(robot, state), any_blend(state)))
            .collect();
        let request = request(&vec![0.3; robot.joint_count()], segments);
        match outcome(robot, &request) {
            Err(Failure::Invalid(findings)) => {
                assert!(!findings.is_empty());
                counts[0] += 1;
            }
            Err(Failure::Stopped) => panic!("nobody stopped it"),
            Ok(Err(infeasible)) => {
                assert!(
                    infeasible.needed.is_finite() && infeasible.available.is_finite(),
                    "{infeasible:?}"
                );
                assert!(!infeasible.suggestion.is_empty());
                counts[1] += 1;
            }
            Ok(Ok(program)) => {
                counts[2] += 1;
                for stroke in &program.strokes {
                    assert!(stroke.knots().windows(2).all(|pair| pair[0] < pair[1]));
                    for i in 0..=20 {
                        let point = at(stroke, stroke.length() * f64::from(i) / 20.0, Side::After);
                        let all = [point.position, point.first, point.second, point.third].concat();
                        assert!(all.iter().all(|value| value.is_finite()));
                    }
                }
            }
        }
    }
    assert!(counts.iter().all(|count| *count > 50), "{counts:?}");
}

#[test]
fn a_budget_that_ends_stops_the_making() {
    let robot = ur5e();
    let end = to_pose(shifted(&robot, &READY, [0.1, 0.0, 0.0], [0.0; 3]));
    let request = request(&READY, vec![line(end, None)]);
    let stopped = build(&robot, &tcp(), &request, &Budget::until(&|| true));
    assert_eq!(stopped.err(), Some(Failure::Stopped));
}
