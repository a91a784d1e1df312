//! Joint positions against the poses that they were made from.

mod arms;
mod closed_form;
mod engines;
mod hard;
mod numerical;

use nalgebra::Isometry3;

use super::{Inverse, Solutions, Turns};
use crate::kinematics::pose;
use crate::robot::Robot;
use crate::test_arms::random;

/// Joint positions anywhere within the ranges (± 3 where there is none), a little inside their ends.
fn draw(robot: &Robot, state: &mut u64) -> Vec<f64> {
    let joints = robot.spec().joints.iter();
    joints
        .map(|joint| {
            let lower = joint.limits.position_lower.unwrap_or(-3.0);
            let upper = joint.limits.position_upper.unwrap_or(3.0);
            0.5 * (lower + upper) + 0.499 * (upper - lower) * random(state)
        })
        .collect()
}

/// A tool that stands off the flange, askew.
fn tool() -> Isometry3<f64> {
    Isometry3::new([0.03, -0.02, 0.15].into(), [0.3, -0.2, 0.5].into())
}

/// Forward kinematics by [`pose`], which shares nothing with the screws: distance, m, and angle, rad.
fn check_reaches(robot: &Robot, q: &[f64], tcp: &Isometry3<f64>, target: &Isometry3<f64>, tolerance: f64) {
    let reached = pose(robot, q, tcp);
    let distance = (reached.translation.vector - target.translation.vector).norm();
    let angle = 2.0 * (reached.rotation.inverse() * target.rotation).imag().norm();
    assert!(
        distance < tolerance && angle < tolerance,
        "{distance} m and {angle} rad off at {q:?}"
    );
}

/// All solutions, each checked.
fn all(robot: &Robot, target: &Isometry3<f64>, tcp: &Isometry3<f64>, reference: Option<&[f64]>) -> Solutions {
    let found = Inverse::new(robot, tcp)
        .solutions(target, reference, Turns::Nearest)
        .unwrap();
    for solution in &found.solutions {
        check_reaches(robot, &solution.position, tcp, target, 1e-10);
        assert!(solution.position_error < 1e-10 && solution.orientation_error < 1e-10);
    }
    found
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |largest, (a, b)| largest.max((a - b).abs()))
}
