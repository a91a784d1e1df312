//! Chains without a closed form.

use super::{all, arms, check_reaches, draw, largest_difference, tool};
use crate::kinematics::inverse::{Inverse, Method};
use crate::kinematics::pose;
use crate::robot::Robot;
use crate::test_arms::{random_arm, robot, values};

/// From a reference some tenths of a radian away the answer is as near as what the pose was made of.
fn check_from_near(robot: &Robot, count: usize, seed: u64) {
    let tcp = tool();
    let inverse = Inverse::new(robot, &tcp);
    let state = &mut seed.clone();
    for _ in 0..count {
        let made = draw(robot, state);
        let mut reference = values(made.len(), 0.2, state);
        reference
            .iter_mut()
            .zip(&made)
            .for_each(|(reference, made)| *reference += made);
        let target = pose(robot, &made, &tcp);
        let q = inverse.nearest(&target, &reference).unwrap();
        check_reaches(robot, &q, &tcp, &target, 1e-10);
    }
}

#[test]
fn any_chain_reaches_what_it_has_reached() {
    check_from_near(&arms::scara(), 1000, 1);
    check_from_near(&arms::offset_wrist(), 1000, 2);
    check_from_near(&arms::fr3(), 1000, 3);
    for seed in 0..20 {
        check_from_near(&robot(random_arm(3 + seed % 10, seed as u64)), 50, 4);
    }
}

#[test]
fn the_search_finds_what_the_pose_was_made_of() {
    let (arm, tcp, state) = (arms::offset_wrist(), tool(), &mut 5);
    let mut missed = 0;
    for _ in 0..60 {
        let made = draw(&arm, state);
        let found = all(&arm, &pose(&arm, &made, &tcp), &tcp, Some(&[0.0; 6]));
        assert_eq!(found.method, Method::Numerical);
        let is_made = |q: &Vec<f64>| largest_difference(q, &made) < 1e-5;
        missed += usize::from(!found.solutions.iter().any(|solution| is_made(&solution.position)));
    }
    assert!(missed <= 3, "{missed} of 60 missed");
}
