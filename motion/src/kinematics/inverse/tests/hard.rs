//! Singular places, the ends of reach and of ranges, whole turns.

use std::f64::consts::{PI, TAU};

use nalgebra::{Isometry3, Vector3};

use super::{all, arms, check_reaches, draw, largest_difference, tool};
use crate::kinematics::inverse::{Inverse, Turns, Unreachable, nearest, solutions};
use crate::kinematics::{jacobian, pose};
use crate::robot::Robot;
use crate::test_arms::{planar, random, robot, values};

/// Places where the arm has less freedom: straight, folded wrist, tool above the shoulder, and all of them.
fn singular_places(robot: &Robot, state: &mut u64) -> Vec<Vec<f64>> {
    let mut places = vec![vec![0.0; robot.joint_count()]];
    for _ in 0..200 {
        let mut q = draw(robot, state);
        for (j, q) in q.iter_mut().enumerate() {
            // multiples of right angles in some joints, so that axes line up
            if j > 0 && random(state) < 0.2 {
                let inside = robot.spec().joints[j].limits.position_upper.unwrap_or(PI);
                *q = (PI / 2.0 * (2.0 * random(state)).round()).clamp(-inside, inside);
            }
        }
        places.push(q);
    }
    places
}

#[test]
fn singular_places_are_reached() {
    let state = &mut 1;
    for arm in [arms::ur5e(), arms::puma(), arms::offset_wrist()] {
        let arm = arms::with_ranges(&arm, &[(-3.5, 3.5); 6]);
        for q in singular_places(&arm, state) {
            let target = pose(&arm, &q, &tool());
            let reached = nearest(&arm, &target, &tool(), &q).unwrap();
            check_reaches(&arm, &reached, &tool(), &target, 2e-9);
            // the pose's own joint positions are a solution, and none is nearer to themselves
            assert!(largest_difference(&reached, &q) < 1e-3, "{reached:?} from {q:?}");
        }
    }
}

#[test]
fn what_a_singularity_leaves_free_stays_with_the_reference() {
    let arm = arms::puma();
    // the wrist is straight: joints 4 and 6 turn about one line
    let made = [0.3, -0.5, -1.0, 0.5, 0.0, 0.2];
    let target = pose(&arm, &made, &tool());
    let reference = [0.3, -0.5, -1.0, 1.1, 0.0, -0.2];
    let q = nearest(&arm, &target, &tool(), &reference).unwrap();
    // q4 + q6 is what the pose asks for: both give way alike
    let expected = [0.3, -0.5, -1.0, 1.1 - 0.1, 0.0, -0.2 - 0.1];
    assert!(largest_difference(&q, &expected) < 1e-6, "{q:?}");
    let found = solutions(&arm, &target, &tool(), Some(&reference), Turns::Nearest).unwrap();
    assert!(found.solutions[0].smallest_singular_value < 1e-6);
}

#[test]
fn out_of_reach_says_how_far() {
    // two links of 1 m in a plane: a point at 2.5 m is half a metre beyond
    let arm = robot(planar());
    let tcp = Isometry3::translation(1.0, 0.0, 0.0);
    let straight = pose(&arm, &[0.4, 0.0], &tcp);
    let mut beyond = straight;
    beyond.translation.vector *= 1.25;
    match nearest(&arm, &beyond, &tcp, &[0.1, 0.2]) {
        Err(Unreachable::OutOfReach {
            position_gap,
            orientation_gap,
            closest,
        }) => {
            assert!(
                (position_gap - 0.5).abs() < 1e-3 && orientation_gap < 1e-3,
                "{position_gap} {orientation_gap}"
            );
            assert!(largest_difference(&closest, &[0.4, 0.0]) < 2e-2, "{closest:?}");
        }
        other => panic!("{other:?}"),
    }
    for arm in [
        arms::ur5e(),
        arms::puma(),
        arms::fr3(),
        arms::scara(),
        arms::offset_wrist(),
    ] {
        let far = Isometry3::translation(3.0, 0.0, 0.5);
        match solutions(&arm, &far, &tool(), None, Turns::Nearest) {
            Err(Unreachable::OutOfReach { position_gap, .. }) => assert!((0.5..3.0).contains(&position_gap)),
            other => panic!("{other:?}"),
        }
    }
}

#[test]
fn a_tilt_that_four_joints_cannot_make_is_out_of_reach() {
    let arm = arms::scara();
    let q = [0.3, 0.7, 0.1, -0.4];
    let mut target = pose(&arm, &q, &Isometry3::identity());
    let exact = nearest(&arm, &target, &Isometry3::identity(), &[0.0, 0.2, 0.0, 0.0]).unwrap();
    assert!(largest_difference(&exact, &q) < 1e-9);
    target.rotation *= Isometry3::rotation(Vector3::new(0.01, 0.0, 0.0)).rotation;
    match nearest(&arm, &target, &Isometry3::identity(), &q) {
        Err(Unreachable::OutOfReach { orientation_gap, .. }) => assert!((orientation_gap - 0.01).abs() < 1e-4),
        other => panic!("{other:?}"),
    }
}

#[test]
fn only_outside_a_range_names_the_joint() {
    let arm = arms::with_ranges(&arms::scara(), &[(-2.3, 2.3), (-2.5, 2.5), (0.0, 0.2), (-PI, PI)]);
    let target = pose(&arm, &[0.3, 0.7, 0.25, -0.4], &Isometry3::identity());
    match nearest(&arm, &target, &Isometry3::identity(), &[0.3, 0.7, 0.2, -0.4]) {
        Err(Unreachable::JointRange {
            joint,
            needed,
            available,
            ..
        }) => assert!(joint == 2 && (needed - 0.25).abs() < 1e-9 && available == 0.2),
        other => panic!("{other:?}"),
    }
    let found = solutions(&arm, &target, &Isometry3::identity(), None, Turns::Nearest).unwrap();
    assert!(found.solutions.iter().all(|solution| !solution.in_range));
}

#[test]
fn whole_turns_lead_into_the_range() {
    let arm = arms::ur5e();
    let made = [4.0, -1.2, 1.0, -5.5, 0.9, 2.0];
    let target = pose(&arm, &made, &tool());
    let q = nearest(&arm, &target, &tool(), &made).unwrap();
    assert!(largest_difference(&q, &made) < 1e-9, "{q:?}");
    // the reference is nearer to what is one turn outside of the range
    let q = nearest(&arm, &target, &tool(), &[TAU, -1.2, 1.0, -5.5, 0.9, 2.0]).unwrap();
    assert!(largest_difference(&q, &made) < 1e-9, "{q:?}");

    // five joints have ranges of two turns, in which every place but the middle is twice; the elbow has one
    let every = solutions(&arm, &target, &tool(), Some(&made), Turns::Every).unwrap();
    let once = all(&arm, &target, &tool(), Some(&made));
    assert_eq!(every.solutions.len(), 32 * once.solutions.len());
    for solution in &every.solutions {
        check_reaches(&arm, &solution.position, &tool(), &target, 1e-10);
        assert!(solution.in_range);
    }
    let distances: Vec<f64> = every.solutions.iter().map(|s| distance(&s.position, &made)).collect();
    assert!(distances.is_sorted() && distances[0] < 1e-9);
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    libm::sqrt(a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum())
}

/// Whatever the reference: what has been within the ranges is found within them.
#[test]
fn a_pose_taken_within_the_ranges_is_reached_within_them() {
    let state = &mut 8;
    for (arm, count) in [
        (arms::ur5e(), 500),
        (arms::puma(), 500),
        (arms::scara(), 200),
        (arms::fr3(), 100),
    ] {
        let inverse = Inverse::new(&arm, &tool());
        for _ in 0..count {
            let made = draw(&arm, state);
            let target = pose(&arm, &made, &tool());
            let q = inverse.nearest(&target, &draw(&arm, state)).unwrap();
            check_reaches(&arm, &q, &tool(), &target, 1e-10);
            assert!(inverse.is_in_range(&q));
        }
    }
}

/// At the nearest solution the way back to the reference has no part that the tool would not notice: it is in the row
/// space of the Jacobian.
#[test]
fn seven_joints_go_to_what_is_nearest() {
    let arm = arms::fr3();
    let (state, mut within, mut further) = (&mut 3, 0, 0);
    for _ in 0..300 {
        let made = draw(&arm, state);
        let target = pose(&arm, &made, &tool());
        let mut reference = values(7, 0.3, state);
        reference
            .iter_mut()
            .zip(&made)
            .for_each(|(reference, made)| *reference += made);
        let q = nearest(&arm, &target, &tool(), &reference).unwrap();
        check_reaches(&arm, &q, &tool(), &target, 1e-10);
        further += usize::from(distance(&q, &reference) > distance(&made, &reference) + 1e-9);
        let ends = arm.spec().joints.iter().zip(&q);
        let is_at_end = ends.clone().any(|(joint, &q)| {
            let limits = joint.limits;
            q - limits.position_lower.unwrap() < 1e-9 || limits.position_upper.unwrap() - q < 1e-9
        });
        if is_at_end {
            continue;
        }
        within += 1;
        let free = free_direction(&arm, &q);
        let along: f64 = (0..7).map(|j| free[j] * (reference[j] - q[j])).sum();
        assert!(along.abs() < 1e-6, "{along}");
    }
    // nearest among its neighbours: a family may have a second such place, rarely a nearer one
    assert!(within > 150 && further <= 3, "{within} {further}");
}

/// The direction in which seven joints move without the tool: the minors of the Jacobian, with alternating signs.
fn free_direction(robot: &Robot, q: &[f64]) -> Vec<f64> {
    let mut matrix = vec![0.0; 42];
    jacobian(robot, q, &tool(), &mut matrix);
    let minor = |left_out: usize| {
        let m = nalgebra::Matrix6::from_fn(|row, column| matrix[row * 7 + column + usize::from(column >= left_out)]);
        if left_out.is_multiple_of(2) {
            m.determinant()
        } else {
            -m.determinant()
        }
    };
    let direction: Vec<f64> = (0..7).map(minor).collect();
    let norm = distance(&direction, &[0.0; 7]);
    direction.iter().map(|entry| entry / norm).collect()
}

#[test]
fn following_keeps_the_branch() {
    let (arm, tcp) = (arms::ur5e(), tool());
    let inverse = Inverse::new(&arm, &tcp);
    let start = [0.4, -1.2, 1.5, -0.9, 1.1, 0.3];
    let from = pose(&arm, &start, &tcp);
    let (mut q, mut before) = (start.to_vec(), start.to_vec());
    for step in 1..=100 {
        let mut target = from;
        target.translation.vector += Vector3::new(0.0, 0.002, -0.001) * f64::from(step);
        q = inverse.follow(&target, &q).unwrap();
        check_reaches(&arm, &q, &tcp, &target, 1e-10);
        assert!(largest_difference(&q, &before) < 0.02);
        before.clone_from(&q);
    }
    // straight outwards the branch ends where the arm is stretched
    let outwards = Vector3::new(from.translation.vector.x, from.translation.vector.y, 0.0).normalize();
    let end = (1..=1000).find_map(|step| {
        let mut target = from;
        target.translation.vector += outwards * (0.001 * f64::from(step));
        match inverse.follow(&target, &q) {
            Ok(next) => {
                q = next;
                None
            }
            Err(error) => Some(error),
        }
    });
    assert!(
        matches!(end, Some(Unreachable::OutOfReach { position_gap, .. }) if position_gap < 1.1e-3),
        "{end:?}"
    );
}

/// An arm that reaches back over its own shoulder reaches less far, by twice the shoulder's offset.
#[test]
fn a_branch_that_ends_at_a_singularity_is_told_from_the_end_of_reach() {
    let arm = arms::dh(&[
        (0.15, PI / 2.0, 0.45, 0.0, false),
        (0.59, 0.0, 0.0, 0.0, false),
        (0.13, PI / 2.0, 0.0, 0.0, false),
        (0.0, -PI / 2.0, 0.647, 0.0, false),
        (0.0, PI / 2.0, 0.0, 0.0, false),
        (0.0, 0.0, 0.095, 0.0, false),
    ]);
    let tcp = Isometry3::identity();
    let inverse = Inverse::new(&arm, &tcp);
    // outwards, the hand at right angles to the arm
    let target = |radius: f64| Isometry3::new(Vector3::new(radius, 0.0, 0.45), Vector3::new(1.2, 0.0, 0.0));
    let mut ends = [0, 0];
    for solution in all(&arm, &target(0.6), &tcp, None).solutions {
        let mut q = solution.position;
        let (radius, end) = (0..2000)
            .map(|step| 0.6 + 0.001 * f64::from(step))
            .find_map(|radius| match inverse.follow(&target(radius), &q) {
                Ok(next) => {
                    q = next;
                    None
                }
                Err(error) => Some((radius, error)),
            })
            .unwrap();
        // stretched: from the shoulder to the wrist centre
        let stretched = 0.59 + libm::sqrt(0.13 * 0.13 + 0.647 * 0.647);
        match end {
            Unreachable::Singular {
                position_gap,
                smallest_singular_value,
                ..
            } => {
                ends[0] += 1;
                assert!((radius - (stretched - 0.15)).abs() < 0.01, "{radius}");
                assert!(position_gap < 2e-3 && smallest_singular_value < 0.05);
            }
            Unreachable::OutOfReach { .. } => {
                ends[1] += 1;
                assert!((radius - (stretched + 0.15)).abs() < 0.01, "{radius}");
            }
            other @ Unreachable::JointRange { .. } => panic!("{other}"),
        }
    }
    assert_eq!(ends, [4, 4]);
}

#[test]
fn no_pose_and_no_reference_stops_the_service() {
    for arm in [arms::ur5e(), arms::puma(), arms::fr3(), arms::scara(), robot(planar())] {
        let count = arm.joint_count();
        for value in [f64::NAN, f64::INFINITY, 1e300, 1e5] {
            let pose = Isometry3::translation(value, 0.0, 0.3);
            assert!(solutions(&arm, &pose, &tool(), None, Turns::Every).is_err());
            assert!(nearest(&arm, &pose, &tool(), &vec![value; count]).is_err());
            let near = pose_at_middle(&arm);
            nearest(&arm, &near, &tool(), &vec![value; count]).ok();
            solutions(&arm, &near, &tool(), Some(&[value]), Turns::Every).ok();
        }
    }
}

fn pose_at_middle(arm: &Robot) -> Isometry3<f64> {
    pose(arm, &draw(arm, &mut 7), &tool())
}
