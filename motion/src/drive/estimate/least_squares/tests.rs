use nalgebra::{DMatrix, DVector};

use super::*;
use crate::drive::estimate::factor::lower;
use crate::drive::estimate::law::FrictionLaw;
use crate::drive::estimate::noise::{Correlated, normal};
use crate::quantile;
use crate::test_arms::random;

const FAR: [f64; TERMS_MAX] = [1e12; TERMS_MAX];

fn law(terms: usize) -> FrictionLaw {
    FrictionLaw {
        load: terms > 2,
        by_direction: terms > 3,
        quadratic: terms > 4,
    }
}

fn diagonal(variances: &[f64]) -> [f64; TRIANGLE] {
    let mut triangle = [0.0; TRIANGLE];
    for (index, &variance) in variances.iter().enumerate() {
        triangle[lower(index, index)] = variance;
    }
    triangle
}

/// The weighted problem as one least-squares problem, rows scaled by the roots of their weights, by Householder's QR.
struct Batch {
    rows: Vec<Vec<f64>>,
    right: Vec<f64>,
}

impl Batch {
    fn of_prior(mean: &[f64], variances: &[f64]) -> Self {
        let mut batch = Self {
            rows: Vec::new(),
            right: Vec::new(),
        };
        for (index, variance) in variances.iter().enumerate() {
            let mut row = vec![0.0; mean.len()];
            row[index] = 1.0 / variance.sqrt();
            batch.right.push(mean[index] / variance.sqrt());
            batch.rows.push(row);
        }
        batch
    }

    fn add(&mut self, psi: &[f64], torque: f64, weight: f64, lambda: f64) {
        let (fade, root) = (lambda.sqrt(), weight.sqrt());
        for (row, right) in self.rows.iter_mut().zip(&mut self.right) {
            row.iter_mut().for_each(|value| *value *= fade);
            *right *= fade;
        }
        self.rows.push(psi.iter().map(|psi| psi * root).collect());
        self.right.push(torque * root);
    }

    fn solution(&self, count: usize) -> (DVector<f64>, DMatrix<f64>) {
        let matrix = DMatrix::from_fn(self.rows.len(), count, |i, k| self.rows[i][k]);
        let qr = matrix.qr();
        let right = qr.q().transpose() * DVector::from_column_slice(&self.right);
        let root = qr.r().try_inverse().unwrap();
        (&root * right, &root * root.transpose())
    }
}

/// Every λ from 0.8 to 1, every law, weights over three decades: coefficients and Q, to 1e-9.
#[test]
fn it_is_the_batch_solution_with_the_prior() {
    let state = &mut 11;
    for lambda in [0.8, 0.9, 0.95, 0.98, 0.99, 0.995, 0.998, 0.999, 0.9999, 0.999_99, 1.0] {
        for terms in 2..=5 {
            for samples in [1, 7, 60, 400] {
                let law = law(terms);
                let mean: Vec<f64> = (0..terms).map(|_| 3.0 * random(state)).collect();
                let variances: Vec<f64> = (0..terms).map(|_| libm::pow(10.0, 3.0 * random(state))).collect();
                let mut padded = [0.0; TERMS_MAX];
                padded[..terms].copy_from_slice(&mean);
                let noise = 0.04;
                let mut state_of = LeastSquares::new(terms, &padded, &diagonal(&variances), noise, FAR).unwrap();
                let scaled: Vec<f64> = variances.iter().map(|variance| variance / noise).collect();
                let mut batch = Batch::of_prior(&mean, &scaled);
                for _ in 0..samples {
                    let psi = law.regressors(3.0 * random(state), 40.0 * random(state));
                    let torque = 5.0 * random(state);
                    let weight = libm::pow(10.0, -1.5 + 1.5 * random(state));
                    state_of
                        .update(&Row {
                            psi: &psi,
                            torque,
                            worth: Worth::new(weight, lambda, 0.001),
                            bound: f64::INFINITY,
                        })
                        .unwrap();
                    batch.add(&psi[..terms], torque, weight, lambda);
                }
                let (expected, matrix) = batch.solution(terms);
                let actual = state_of.factor.matrix(terms);
                for i in 0..terms {
                    let error = (state_of.coefficients[i] - expected[i]).abs();
                    assert!(
                        error < 1e-9 * expected.amax().max(1.0),
                        "λ {lambda}, {terms}, {samples}: {error}"
                    );
                    for k in 0..=i {
                        let scale = (matrix[(i, i)] * matrix[(k, k)]).sqrt();
                        let error = (actual[lower(i, k)] - matrix[(i, k)]).abs();
                        assert!(
                            error < 1e-9 * scale,
                            "Q, λ {lambda}, {terms}, {samples}: {error} of {scale}"
                        );
                    }
                }
            }
        }
    }
}

/// The mean age of what an estimate of a constant stands on is 1/(1 − λ) samples: it is that late behind a drift.
#[test]
fn it_follows_a_drift_with_the_lag_of_its_memory() {
    for lambda in [0.99, 0.995, 0.999] {
        let mut state_of = LeastSquares::new(2, &[0.0; TERMS_MAX], &diagonal(&[1e4, 1e4]), 1.0, FAR).unwrap();
        let per_sample = 1e-3;
        let samples = (30.0 / (1.0 - lambda)) as usize;
        for index in 0..samples {
            let velocity = if index % 2 == 0 { 0.5 } else { -1.0 };
            let psi = FrictionLaw::default().regressors(velocity, 0.0);
            let friction = [per_sample * index as f64, 2.0];
            let torque = psi[0] * friction[0] + psi[1] * friction[1];
            let row = Row {
                psi: &psi,
                torque,
                worth: Worth::new(1.0, lambda, 0.001),
                bound: f64::INFINITY,
            };
            state_of.update(&row).unwrap();
        }
        let lag = (samples as f64 - 1.0) - state_of.coefficients[0] / per_sample;
        let expected = lambda / (1.0 - lambda);
        assert!(
            (lag - expected).abs() < 0.02 * expected,
            "λ {lambda}: {lag} for {expected}"
        );
    }
}

/// An hour of motion in one direction at one speed: the two coefficients are not told apart, and Q stays below its caps;
/// what is said of the torque at that speed and what is said of the coefficients stay true.
#[test]
fn a_motion_that_says_little_does_not_wind_it_up() {
    let state = &mut 21;
    let truth = [3.0, 1.5];
    let caps = [1e4, 1e4, 0.0, 0.0, 0.0];
    let mut state_of = LeastSquares::new(2, &[2.0, 1.0, 0.0, 0.0, 0.0], &diagonal(&[1.0, 1.0]), 0.01, caps).unwrap();
    let law = FrictionLaw::default();
    let mut feed = |state_of: &mut LeastSquares, velocity: f64, samples: usize| {
        let psi = law.regressors(velocity, 0.0);
        for _ in 0..samples {
            let torque = psi[0] * truth[0] + psi[1] * truth[1] + 0.1 * normal(state);
            let row = Row {
                psi: &psi,
                torque,
                worth: Worth::new(1.0, 0.9999, 0.001),
                bound: f64::INFINITY,
            };
            state_of.update(&row).unwrap();
        }
    };
    feed(&mut state_of, 0.5, 360_000);
    for index in 0..2 {
        assert!(state_of.factor.variance(2, index) <= 1e4);
    }
    let known = state_of.evidence.known(2, &state_of.factor, 0.01);
    // nothing has been said of how the error is shared: the prior's deviation of 1 for the difference is still there
    for (index, truth) in truth.iter().enumerate() {
        let deviation = known.covariance[lower(index, index)].sqrt();
        let error = (state_of.coefficients[index] - truth).abs();
        assert!(
            (0.3..2.0).contains(&deviation) && error < 3.0 * deviation,
            "{index}: {error} ± {deviation}"
        );
    }
    let torque = state_of.coefficients[0] + 0.5 * state_of.coefficients[1];
    assert!((torque - 3.75).abs() < 0.02, "{torque}");
    // and a second of another speed tells
    feed(&mut state_of, 2.0, 10_000);
    feed(&mut state_of, -1.0, 10_000);
    for (index, truth) in truth.iter().enumerate() {
        assert!(
            (state_of.coefficients[index] - truth).abs() < 0.05,
            "{:?}",
            state_of.coefficients
        );
    }
}

#[test]
fn what_is_no_number_changes_nothing() {
    let mut state_of = LeastSquares::new(2, &[1.0; TERMS_MAX], &diagonal(&[1.0, 1.0]), 1.0, FAR).unwrap();
    let before = state_of.clone();
    let good = [1.0, 0.5, 0.0, 0.0, 0.0];
    fn row(psi: &[f64; TERMS_MAX], torque: f64, weight: f64) -> Row<'_> {
        Row {
            psi,
            torque,
            worth: Worth::new(weight, 0.99, 0.001),
            bound: f64::INFINITY,
        }
    }
    for bad in [f64::NAN, f64::INFINITY, 1e300] {
        assert!(state_of.update(&row(&good, bad, 1.0)).is_none());
        let psi = [1.0, bad, 0.0, 0.0, 0.0];
        assert!(state_of.update(&row(&psi, 1.0, 1.0)).is_none());
    }
    for weight in [0.0, -1.0, f64::NAN] {
        assert!(state_of.update(&row(&good, 1.0, weight)).is_none());
    }
    assert_eq!(state_of, before);
}

/// How often the true coefficients are inside their 95 % intervals: strokes at 100 Hz for two minutes, half-life one minute,
/// 200 seeds, two coefficients each. `correlation`, s, and degrees of freedom of the noise's tails.
fn coverage(correlation: f64, tails: Option<f64>) -> f64 {
    let (runs, step, samples) = (200, 0.01, 12_000);
    let truth = [4.0, 1.2];
    let law = FrictionLaw::default();
    let lambda = libm::exp(-std::f64::consts::LN_2 * step / 60.0);
    let mut inside = 0;
    for run in 0..runs {
        let state = &mut (1000 + run);
        let mut noise = Correlated::new(step, correlation, tails, state);
        let mean = [truth[0] + normal(state), truth[1] + normal(state), 0.0, 0.0, 0.0];
        let mut state_of = LeastSquares::new(2, &mean, &diagonal(&[1.0, 1.0]), 0.25, FAR).unwrap();
        let (mut velocity, mut second): (f64, f64) = (1.0, 0.25);
        for index in 0..samples {
            // strokes of a second, each at a speed of its own
            if index % 100 == 0 {
                velocity = -velocity.signum() * (0.2 + random(state).abs());
            }
            let psi = law.regressors(velocity, 0.0);
            let error = 0.5 * noise.next(state);
            second += 0.001 * (error * error - second);
            let row = Row {
                psi: &psi,
                torque: psi[0] * truth[0] + psi[1] * truth[1] + error,
                worth: Worth::new(0.5 * step / 0.2, lambda, step),
                bound: f64::INFINITY,
            };
            state_of.update(&row).unwrap();
        }
        let known = state_of.evidence.known(2, &state_of.factor, second);
        let width = quantile::student(known.degrees_of_freedom.unwrap_or(f64::INFINITY), 0.025);
        for (index, truth) in truth.iter().enumerate() {
            let deviation = known.covariance[lower(index, index)].sqrt();
            inside += u32::from((state_of.coefficients[index] - truth).abs() <= width * deviation);
        }
    }
    f64::from(inside) / (2.0 * runs as f64)
}

/// Four standard deviations of the share of 400 draws at 95 %, of which the two of a run are not independent.
const SLACK: f64 = 0.06;

fn check_coverage(name: &str, covered: f64, most: f64) {
    println!("{name}: {covered}");
    assert!((0.95 - SLACK..=most).contains(&covered), "{name}: {covered}");
}

/// Noise that is far less alike than the 0.2 s assumed: intervals are too wide by what the prior's errors did at the beginning.
#[test]
fn intervals_cover_in_white_noise() {
    check_coverage("white", coverage(1e-6, None), 1.0);
}

#[test]
fn intervals_cover_in_white_noise_with_heavy_tails() {
    check_coverage("white, Student 3", coverage(1e-6, Some(3.0)), 1.0);
}

#[test]
fn intervals_cover_in_correlated_noise() {
    check_coverage("0.1 s", coverage(0.1, None), 0.99);
}

#[test]
fn intervals_cover_in_long_correlated_noise() {
    check_coverage("0.4 s", coverage(0.4, None), 0.99);
}

#[test]
fn intervals_cover_in_correlated_noise_with_heavy_tails() {
    check_coverage("0.4 s, Student 3", coverage(0.4, Some(3.0)), 0.99);
}

#[test]
fn the_measured_correlation_time_is_the_noises() {
    let state = &mut 77;
    let (step, correlation) = (0.005, 0.3);
    let mut noise = Correlated::new(step, correlation, None, state);
    let mut state_of = LeastSquares::new(2, &[0.0; TERMS_MAX], &diagonal(&[1.0, 1.0]), 1.0, FAR).unwrap();
    let mut second = 0.0;
    for index in 0..200_000 {
        let velocity = if (index / 200) % 2 == 0 { 0.5 } else { -1.0 };
        let psi = FrictionLaw::default().regressors(velocity, 0.0);
        let row = Row {
            psi: &psi,
            torque: noise.next(state),
            worth: Worth::new(0.01, 1.0, step),
            bound: f64::INFINITY,
        };
        let square = state_of.update(&row).unwrap().square;
        second += (square - second) / f64::from(index + 1);
    }
    let found = state_of.evidence.correlation_time(second).unwrap();
    assert!((0.22..0.4).contains(&found), "{found}");
}
