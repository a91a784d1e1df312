use super::*;
use crate::dynamics::regressor::{PER_JOINT, Regressor, kinds};
use crate::robot::spec::{Parameter, Residual, Uncertainty};
use crate::test_arms::{random, random_arm, robot, values};

/// An uncertainty of all parameters of an arm, scrambled, and its covariance as a full matrix.
fn uncertainty(joints: usize, seed: u64) -> (Uncertainty, Vec<Vec<f64>>) {
    let state = &mut seed.clone();
    let mut parameters: Vec<Parameter> = (0..joints)
        .flat_map(|joint| kinds().map(|kind| Parameter { joint, kind }))
        .collect();
    for index in (1..parameters.len()).rev() {
        let other = ((random(state) + 1.0) * 0.5 * index as f64) as usize;
        parameters.swap(index, other);
    }
    let count = parameters.len();
    let roots: Vec<Vec<f64>> = (0..count).map(|_| values(count, 0.1, state)).collect();
    let product = |i: usize, j: usize| roots[i].iter().zip(&roots[j]).map(|(a, b)| a * b).sum::<f64>();
    let full: Vec<Vec<f64>> = (0..count)
        .map(|i| (0..count).map(|j| product(i, j)).collect())
        .collect();
    let residual = Residual {
        deviation: 0.1,
        correlation_time: 0.1,
        degrees_of_freedom: 5.0,
    };
    let covariance = (0..count).flat_map(|i| full[i][..=i].to_vec()).collect();
    let uncertainty = Uncertainty {
        parameters,
        covariance,
        residuals: vec![residual; joints],
    };
    (uncertainty, full)
}

#[test]
fn a_spread_has_the_length_that_the_covariance_says() {
    for seed in 0..5 {
        let mut spec = random_arm(5, seed);
        let (known, full) = uncertainty(5, seed + 100);
        let columns: Vec<usize> = known.parameters.iter().map(|p| regressor::column(*p)).collect();
        spec.uncertainty = Some(known);
        let robot = robot(spec);
        let factor = robot.factor().unwrap();
        let mut regressor = Regressor::new(&robot);
        let state = &mut (seed + 7);
        let (q, qd, qdd) = (values(5, 2.0, state), values(5, 2.0, state), values(5, 5.0, state));
        regressor.compute(&robot, &q, &qd, &qdd);
        let mut spread = vec![0.0; factor.parameter_count()];
        for joint in 0..5 {
            let row = regressor.row(joint);
            let found = factor.spread(joint, row, &mut spread);
            let phi: Vec<f64> = columns.iter().map(|column| row[*column]).collect();
            let square: f64 = (0..phi.len())
                .flat_map(|i| (0..phi.len()).map(move |j| (i, j)))
                .map(|(i, j)| phi[i] * full[i][j] * phi[j])
                .sum();
            assert!(
                (found / square.sqrt() - 1.0).abs() < 1e-9,
                "{seed} {joint}: {found} {square}"
            );
        }
    }
}

#[test]
fn what_rounding_makes_indefinite_is_lifted_and_a_certain_parameter_has_no_spread() {
    let mut spec = random_arm(2, 1);
    let (mut known, _) = uncertainty(2, 3);
    let count = known.parameters.len();
    assert_eq!(count, 2 * PER_JOINT);
    // all alike: of rank 1, but for the last, which is certain
    known.covariance.fill(4.0);
    let last = count * (count - 1) / 2;
    known.covariance[last..].fill(0.0);
    // and a little more than that
    known.covariance[1] *= 1.0 + 1e-9;
    spec.uncertainty = Some(known.clone());
    let factor = Factor::new(&spec).unwrap().unwrap();
    let mut row = vec![1.0; count];
    let mut spread = vec![0.0; count];
    let expected = 2.0 * (count - 1) as f64;
    let found = factor.spread(0, &row, &mut spread);
    assert!((found / expected - 1.0).abs() < 1e-6, "{found} {expected}");
    row.fill(0.0);
    row[regressor::column(known.parameters[count - 1])] = 1.0;
    assert_eq!(factor.spread(0, &row, &mut spread), 0.0);
}

#[test]
fn what_is_no_covariance_is_refused() {
    let mut spec = random_arm(2, 1);
    let (known, _) = uncertainty(2, 3);
    let mut refused = |change: &dyn Fn(&mut Uncertainty)| {
        let mut wrong = known.clone();
        change(&mut wrong);
        spec.uncertainty = Some(wrong);
        Factor::new(&spec).unwrap_err()[0].path.clone()
    };
    assert_eq!(refused(&|wrong| wrong.covariance[0] = -1.0), "uncertainty.covariance");
    assert_eq!(
        refused(&|wrong| wrong.covariance[0] = f64::NAN),
        "uncertainty.covariance"
    );
    assert_eq!(refused(&|wrong| wrong.covariance[1] = 1e9), "uncertainty.covariance");
    assert_eq!(refused(&|wrong| wrong.covariance.truncate(1)), "uncertainty.covariance");
    assert_eq!(refused(&|wrong| wrong.residuals.truncate(1)), "uncertainty.residuals");
    assert_eq!(
        refused(&|wrong| wrong.parameters[0].joint = 2),
        "uncertainty.parameters"
    );
}
