//! Every branch, against other engines.

use nalgebra::{Isometry3, Matrix3, Rotation3, UnitQuaternion, Vector3};

use super::{all, arms};
use crate::kinematics::inverse::Method;
use crate::robot::Robot;

/// The engines' figures have twelve decimals, the poses fifteen.
const AGREED: f64 = 1e-9;

fn numbers<'a>(words: impl Iterator<Item = &'a str>) -> Vec<f64> {
    words.map(|word| word.parse().unwrap()).collect()
}

fn arm(table: &[f64]) -> Robot {
    let rows: Vec<_> = table
        .chunks(3)
        .map(|row| (row[0], row[1], row[2], 0.0, false))
        .collect();
    arms::dh(&rows)
}

fn read_pose(m: &[f64]) -> Isometry3<f64> {
    let rotation = Matrix3::new(m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10]);
    let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(rotation));
    Isometry3::from_parts(Vector3::new(m[3], m[7], m[11]).into(), rotation)
}

fn check(robot: &Robot, pose: &Isometry3<f64>, expected: &[Vec<f64>]) {
    let found = all(robot, pose, &Isometry3::identity(), None);
    assert_eq!(found.method, Method::ClosedForm);
    assert_eq!(found.solutions.len(), expected.len(), "{expected:?} {found:#?}");
    for expected in expected {
        let is_same = |q: &[f64]| {
            q.iter()
                .zip(expected)
                .all(|(a, b)| libm::sin(0.5 * (a - b)).abs() < AGREED)
        };
        let is_found = found.solutions.iter().any(|solution| is_same(&solution.position));
        assert!(is_found, "{expected:?} {found:#?}");
    }
}

#[test]
fn every_branch_is_the_engines() {
    let mut robot = None;
    let mut case: Option<(Isometry3<f64>, Vec<Vec<f64>>)> = None;
    let mut checked = 0;
    let lines = include_str!("branches.txt").lines().chain(["end"]);
    for line in lines {
        let mut words = line.split_whitespace();
        let kind = words.next().unwrap();
        if let ("pose" | "arm" | "end", Some(robot), Some((pose, expected))) = (kind, &robot, &case) {
            check(robot, pose, expected);
            checked += 1;
            case = None;
        }
        match kind {
            "arm" => robot = Some(arm(&numbers(words.skip(1)))),
            "pose" => case = Some((read_pose(&numbers(words)), Vec::new())),
            "joints" => case.as_mut().unwrap().1.push(numbers(words)),
            _ => {}
        }
    }
    assert_eq!(checked, 40);
}
