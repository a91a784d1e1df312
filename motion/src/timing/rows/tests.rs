use nalgebra::{Isometry3, Vector3};

use super::*;
use crate::budget::Budget;
use crate::robot::Robot;
use crate::test_arms::{random, random_arm, robot, values};
use crate::timing::grid::{Grid, even};
use crate::timing::limits::{JointLimits, Stretch};
use crate::timing::measured::Polynomials;

/// An arm with friction on a curved path, and the rows of one sample.
fn arm_and_path() -> (Robot, Polynomials) {
    let mut spec = random_arm(6, 4);
    for joint in &mut spec.joints {
        joint.drive.joint_friction.viscous = 40.0;
    }
    let state = &mut 6;
    let curve = Polynomials::new((0..6).map(|_| values(4, 1.0, state)).collect(), 1.0);
    (robot(spec), curve)
}

/// Whatever a and b the rows allow, the true torque and the true tool acceleration keep their limits; and at the tangent
/// the torque row is exact.
#[test]
fn what_the_rows_allow_keeps_the_limits() {
    let (arm, curve) = arm_and_path();
    let joint = JointLimits {
        torque: Some(1200.0),
        velocity: Some(3.0),
        ..JointLimits::default()
    };
    let limits = Limits::uniform(Stretch {
        joints: vec![joint; 6],
        tool_acceleration: Some(20.0),
        ..Stretch::default()
    });
    let grid = Grid::new(even(&[0.0, 1.0], 8), &[0.0, 1.0], 2);
    let budget = Budget::unlimited();
    let coefficients =
        Coefficients::compute(&arm, &Isometry3::identity(), &curve, &limits, &grid.places, &budget).unwrap();
    let places = RowPlaces::new(&grid, 2);
    let rooms = Rooms {
        reserve: 0.0,
        ..Rooms::full(&coefficients)
    };
    let state = &mut 12;
    let (mut allowed, mut tight) = (0, 0);
    for _ in 0..400 {
        let reference: Vec<f64> = places.samples.iter().map(|_| 0.2 + 0.1 * random(state)).collect();
        let rows = Rows::new(&coefficients, &limits, &rooms, &places, Some(&reference));
        for (place, sample) in places.samples.iter().copied().enumerate() {
            let a = (0.5 + 0.5 * random(state)) * rows.speed_bound[place].min(4.0);
            let b = 30.0 * random(state);
            let keeps = |pair: &Pair| {
                let most = pair.a[0] * a + pair.b * b - pair.c[0];
                most.max(pair.a[1] * a - pair.b * b - pair.c[1]) <= 0.0
            };
            if !rows.at(place).iter().all(keeps) {
                continue;
            }
            allowed += 1;
            let vector = |v: [f64; 3]| Vector3::from(v);
            let tool = vector(coefficients.tool_first(sample)) * b + vector(coefficients.tool_second(sample)) * a;
            assert!(tool.norm() <= 20.0 * (1.0 + 1e-12), "{}", tool.norm());
            if tool.norm() > 19.0 {
                tight += 1;
            }
            for joint in 0..6 {
                let entry = joint * coefficients.stride + sample;
                let terms = &coefficients.terms;
                let without = terms.mass[entry] * b
                    + terms.velocity[entry] * a
                    + terms.gravity[entry]
                    + coefficients.viscous[entry] * a.sqrt();
                let (up, down) = (
                    without + coefficients.coulomb_high[entry],
                    without + coefficients.coulomb_low[entry],
                );
                assert!(
                    up <= 1200.0 * (1.0 + 1e-12) && down >= -1200.0 * (1.0 + 1e-12),
                    "{up} {down}"
                );
            }
        }
    }
    assert!(allowed > 500 && tight > 5, "{allowed} {tight}");
}

#[test]
fn a_tangent_is_exact_where_it_touches() {
    let (arm, curve) = arm_and_path();
    let joint = JointLimits {
        torque: Some(1200.0),
        velocity: Some(3.0),
        ..JointLimits::default()
    };
    let limits = Limits::uniform(Stretch {
        joints: vec![joint; 6],
        ..Stretch::default()
    });
    let grid = Grid::new(even(&[0.0, 1.0], 8), &[0.0, 1.0], 1);
    let budget = Budget::unlimited();
    let coefficients =
        Coefficients::compute(&arm, &Isometry3::identity(), &curve, &limits, &grid.places, &budget).unwrap();
    let places = RowPlaces::new(&grid, 1);
    let rooms = Rooms {
        reserve: 0.0,
        ..Rooms::full(&coefficients)
    };
    let a = 0.3;
    let rows = Rows::new(
        &coefficients,
        &limits,
        &rooms,
        &places,
        Some(&vec![a; places.samples.len()]),
    );
    assert!(rows.viscous);
    for (place, sample) in places.samples.iter().copied().enumerate() {
        for (joint, pair) in rows.at(place).iter().enumerate() {
            let entry = joint * coefficients.stride + sample;
            let viscous = coefficients.viscous[entry];
            let (side, still) = if viscous > 0.0 {
                (0, coefficients.terms.gravity[entry] + coefficients.coulomb_high[entry])
            } else {
                (1, -coefficients.terms.gravity[entry] - coefficients.coulomb_low[entry])
            };
            let dynamic = if side == 0 { 1.0 } else { -1.0 } * coefficients.terms.velocity[entry] * a;
            let room = pair.c[side] - pair.a[side] * a;
            let expected = 1200.0 - still - dynamic - viscous.abs() * a.sqrt();
            assert!((room - expected).abs() < 1e-9 * 1200.0, "{room} {expected}");
        }
    }
}
