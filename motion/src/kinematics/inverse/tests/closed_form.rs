//! Arms with a closed form.

use nalgebra::{Isometry3, Vector3};

use super::{all, arms, check_reaches, draw, tool};
use crate::kinematics::inverse::newton::Newton;
use crate::kinematics::inverse::{Inverse, Method, Turns};
use crate::kinematics::pose;
use crate::robot::Robot;
use crate::test_arms::random;

/// The pose of random joint positions has them among its solutions, whatever the reference; returns how often a pose
/// had how many solutions.
fn check_recovers(robot: &Robot, count: usize, seed: u64) -> [usize; 17] {
    let (tcp, state) = (tool(), &mut seed.clone());
    let inverse = Inverse::new(robot, &tcp);
    let mut counts = [0; 17];
    for _ in 0..count {
        let made = draw(robot, state);
        let reference = draw(robot, state);
        let target = pose(robot, &made, &tcp);
        let found = all(robot, &target, &tcp, Some(&reference));
        assert_eq!(found.method, Method::ClosedForm);
        // the same position, whole turns away: the one in range and nearest to the reference
        let is_made = |q: &[f64]| {
            q.iter()
                .zip(&made)
                .all(|(q, made)| libm::sin(0.5 * (q - made)).abs() < 1e-6)
        };
        let recovered = found.solutions.iter().find(|solution| is_made(&solution.position));
        let singular = smallest_singular_value(&inverse, &target, &made);
        assert!(recovered.is_some() || singular < 1e-4, "{made:?} of {found:#?}");
        assert!(recovered.is_none_or(|recovered| recovered.in_range));
        counts[found.solutions.len().min(16)] += 1;
    }
    counts
}

fn smallest_singular_value(inverse: &Inverse, target: &Isometry3<f64>, q: &[f64]) -> f64 {
    let mut newton = Newton::new(&inverse.screws, target.into());
    inverse.solution(q.to_vec(), &mut newton).smallest_singular_value
}

#[test]
fn ur5e_has_its_joints_back() {
    let counts = check_recovers(&arms::ur5e(), 2000, 1);
    // two shoulders, two wrists, two elbows
    let paired = counts
        .iter()
        .enumerate()
        .all(|(count, &often)| often == 0 || count % 2 == 0);
    assert!(paired && counts[9..].iter().sum::<usize>() == 0, "{counts:?}");
    assert!(counts[8] > 1000, "{counts:?}");
}

#[test]
fn puma_has_its_joints_back() {
    let counts = check_recovers(&arms::puma(), 2000, 2);
    assert!(counts[8] > 1000 && counts[9..].iter().sum::<usize>() == 0, "{counts:?}");
}

/// Six lines; the last three through one point.
fn with_wrist(state: &mut u64, change: impl Fn(&mut [[Vector3<f64>; 2]; 6])) -> Robot {
    let mut lines = lines(state);
    let center = lines[3][0];
    (lines[4][0], lines[5][0]) = (center, center);
    change(&mut lines);
    arms::about_lines(&lines, state)
}

fn lines(state: &mut u64) -> [[Vector3<f64>; 2]; 6] {
    let mut vector = || Vector3::from_fn(|_, _| random(state));
    [(); 6].map(|()| [vector(), vector()])
}

#[test]
fn a_wrist_on_any_three_joints_has_its_joints_back() {
    let state = &mut 3;
    for _ in 0..60 {
        check_recovers(&with_wrist(state, |_| ()), 25, 4);
    }
}

#[test]
fn a_wrist_on_axes_that_meet_or_are_parallel_has_its_joints_back() {
    let state = &mut 5;
    for _ in 0..20 {
        check_recovers(&with_wrist(state, |lines| lines[1][0] = lines[0][0]), 25, 6);
        check_recovers(&with_wrist(state, |lines| lines[1][1] = lines[0][1]), 25, 7);
        check_recovers(&with_wrist(state, |lines| lines[2][1] = -lines[1][1]), 25, 8);
        check_recovers(&with_wrist(state, |lines| lines[2][0] = lines[1][0]), 25, 9);
    }
}

#[test]
fn a_wrist_at_the_base_has_its_joints_back() {
    let state = &mut 10;
    for _ in 0..20 {
        let mut lines = lines(state);
        (lines[1][0], lines[2][0]) = (lines[0][0], lines[0][0]);
        check_recovers(&arms::about_lines(&lines, state), 25, 11);
    }
}

#[test]
fn three_parallel_axes_have_their_joints_back() {
    let state = &mut 12;
    for first in [1, 2] {
        for _ in 0..20 {
            for change in 0..3 {
                let mut lines = lines(state);
                lines[first][1] = -lines[first + 1][1];
                lines[first + 2][1] = lines[first + 1][1] * 0.5;
                // beside them two axes that are skew, meet, or are parallel
                let ends = if first == 1 { [4, 5] } else { [1, 0] };
                match change {
                    0 => {}
                    1 => lines[ends[1]][0] = lines[ends[0]][0],
                    _ => lines[ends[1]][1] = lines[ends[0]][1],
                }
                check_recovers(&arms::about_lines(&lines, state), 25, 13);
            }
        }
    }
}

/// A calibrated arm: every frame a little off, by up to a millimetre and a milliradian.
#[test]
fn a_calibrated_arm_has_its_joints_back() {
    let state = &mut 14;
    for arm in [arms::ur5e(), arms::puma()] {
        let mut spec = arm.spec().clone();
        for joint in &mut spec.joints {
            let off = Vector3::from_fn(|_, _| 5e-4 * random(state));
            let askew = Vector3::from_fn(|_, _| 5e-4 * random(state));
            joint.parent_from_joint *= Isometry3::new(off, askew);
        }
        let arm = Robot::new(spec, Vec::new()).unwrap();
        let missed = missed(&arm, 500, state);
        // near singularities the ideal arm may have fewer branches
        assert!(missed <= 5, "{missed} of 500");
    }
}

/// Axes that nearly meet or nearly are parallel, from what is rounding to more than any arm's tolerance: the closed form
/// of the ideal arm leads to the branches of the real one, but for a few near singularities.
#[test]
fn nearly_ideal_arms_have_their_joints_back() {
    let state = &mut 15;
    for family in 0..6 {
        for by in [1e-3, 1e-5, 1e-7] {
            let missed: usize = (0..20)
                .map(|_| missed(&nearly_ideal(family, by, state), 20, state))
                .sum();
            assert!(missed <= 20, "{missed} of 400 in family {family} by {by}");
        }
    }
}

/// Lines of one of the families, one of them displaced or turned.
fn nearly_ideal(family: usize, by: f64, state: &mut u64) -> Robot {
    let mut lines = lines(state);
    let off = Vector3::from_fn(|_, _| by * random(state));
    if family < 3 {
        (lines[4][0], lines[5][0]) = (lines[3][0], lines[3][0]);
    } else {
        (lines[1][1], lines[3][1]) = (-lines[2][1], lines[2][1]);
    }
    match family {
        0 => lines[1][0] = lines[0][0] + off,
        1 => lines[1][1] = lines[0][1].normalize() + off,
        2 => lines[4][0] += off,
        3 => lines[1][1] = off - lines[2][1].normalize(),
        4 => lines[5][0] = lines[4][0] + off,
        _ => lines[5][1] = lines[4][1].normalize() + off,
    }
    arms::about_lines(&lines, state)
}

/// How many poses lack the joint positions that they were made of.
fn missed(robot: &Robot, count: usize, state: &mut u64) -> usize {
    let (tcp, mut missed) = (tool(), 0);
    let inverse = Inverse::new(robot, &tcp);
    for _ in 0..count {
        let made = draw(robot, state);
        let target = pose(robot, &made, &tcp);
        let found = inverse
            .solutions(&target, Some(&draw(robot, state)), Turns::Nearest)
            .unwrap();
        for solution in &found.solutions {
            check_reaches(robot, &solution.position, &tcp, &target, 2e-9);
        }
        let is_made = |q: &[f64]| {
            q.iter()
                .zip(&made)
                .all(|(q, made)| libm::sin(0.5 * (q - made)).abs() < 1e-5)
        };
        missed += usize::from(!found.solutions.iter().any(|solution| is_made(&solution.position)));
    }
    missed
}
