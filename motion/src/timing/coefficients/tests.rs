use nalgebra::{Isometry3, Vector3};

use super::*;
use crate::dynamics::{self, Workspace};
use crate::test_arms::{loaded, random_arm, robot, values};
use crate::timing::grid::{Grid, even, fixed_nodes};
use crate::timing::limits::{JointLimits, Limits, Stretch};
use crate::timing::measured::Polynomials;
use crate::timing::test_curves::random_walk;

fn limits(count: usize, velocity: f64) -> Limits {
    let joint = JointLimits {
        velocity: Some(velocity),
        ..JointLimits::default()
    };
    Limits::uniform(Stretch {
        joints: vec![joint; count],
        tool_velocity: Some(1.5),
        ..Stretch::default()
    })
}

/// Torques of a motion along a path, against those of its positions, velocities and accelerations in time.
#[test]
fn torques_are_those_of_the_motion_in_time() {
    for spec in [random_arm(6, 3), loaded(random_arm(6, 3))] {
        those_of_the_motion_in_time(&robot(spec));
    }
}

fn those_of_the_motion_in_time(arm: &crate::robot::Robot) {
    let curve = random_walk(6, 3, &[2.0; 6], 5);
    let limits = limits(6, 2.0);
    let fixed = fixed_nodes(&curve, &limits);
    let grid = Grid::new(even(&fixed, 20), &fixed, 2);
    let budget = Budget::unlimited();
    let tcp = Isometry3::translation(0.1, 0.0, 0.2);
    let found = Coefficients::compute(arm, &tcp, &curve, &limits, &grid.places, &budget).unwrap();
    let ws = &mut Workspace::new(arm);
    let (sd, sdd) = (0.7, -1.9);
    let mut point = CurvePoint::new(6);
    for (sample, place) in grid.places.iter().enumerate() {
        curve.evaluate(place.s, place.side, &mut point);
        let qd: Vec<f64> = point.first.iter().map(|d| d * sd).collect();
        let bends = point.first.iter().zip(&point.second);
        let qdd: Vec<f64> = bends.map(|(d, dd)| d * sdd + dd * sd * sd).collect();
        let mut torque = vec![0.0; 6];
        dynamics::drive_torque(arm, ws, &point.position, &qd, &qdd, &mut torque);
        for (joint, torque) in torque.iter().enumerate() {
            let e = joint * found.stride + sample;
            let terms = &found.terms;
            let without = terms.mass[e] * sdd + terms.velocity[e] * sd * sd + terms.gravity[e] + found.viscous[e] * sd;
            let (low, high) = (without + found.coulomb_low[e], without + found.coulomb_high[e]);
            let slack = 1e-10 * (1.0 + torque.abs());
            assert!(
                low - slack <= *torque && *torque <= high + slack,
                "{low} {torque} {high}"
            );
            assert!(
                (low - torque).abs().min((high - torque).abs()) <= slack,
                "{low} {torque} {high}"
            );
        }
    }
}

/// No speed between samples is above its limit where ṡ² is at the bound of both, whichever way it is interpolated.
#[test]
fn speed_bounds_hold_between_samples() {
    let arm = robot(random_arm(3, 3));
    // q′ = 1 − 4·(s − ½)² has its peak between the two samples
    let curve = Polynomials::new(vec![vec![0.0, 0.0, 2.0, -4.0 / 3.0], vec![0.0, 0.1], vec![1.0]], 1.0);
    let bound = limits(3, 2.0);
    let place = |s| Place {
        s,
        side: crate::curve::Side::After,
    };
    let budget = Budget::unlimited();
    let found = Coefficients::compute(
        &arm,
        &Isometry3::identity(),
        &curve,
        &Limits::uniform(Stretch {
            tool_velocity: None,
            ..bound.stretches[0].clone()
        }),
        &[place(0.25), place(0.75)],
        &budget,
    )
    .unwrap();
    for bound in &found.speed_bound {
        assert!((bound - 4.0).abs() < 1e-12, "{bound}");
    }
}

#[test]
fn the_tools_speed_bounds_too() {
    let arm = robot(random_arm(6, 3));
    let state = &mut 8;
    let lines = (0..6).map(|_| values(2, 1.0, state)).collect();
    let curve = Polynomials::new(lines, 1.0);
    let tcp = Isometry3::translation(0.1, 0.0, 0.2);
    let place = Place {
        s: 0.4,
        side: crate::curve::Side::After,
    };
    let budget = Budget::unlimited();
    let found = Coefficients::compute(&arm, &tcp, &curve, &limits(6, 1e9), &[place], &budget).unwrap();
    let at = |s: f64| {
        let mut point = CurvePoint::new(6);
        curve.evaluate(s, place.side, &mut point);
        crate::kinematics::pose(&arm, &point.position, &tcp).translation.vector
    };
    let rate: Vector3<f64> = (at(0.4 + 1e-5) - at(0.4 - 1e-5)) / 2e-5;
    let bound = 1.5 * 1.5 / rate.norm_squared();
    assert!((found.speed_bound[0] - bound).abs() < 1e-7 * bound);
}
