use super::*;
use crate::drive::estimate::law::FrictionLaw;
use crate::drive::estimate::least_squares::{LeastSquares, Row, Worth};
use crate::drive::estimate::noise::normal;
use crate::test_arms::random;

fn measured(psi: &[f64; TERMS_MAX], torque: f64, variance: f64, weight: f64, gate: Option<f64>) -> Measurement<'_> {
    Measurement {
        psi,
        torque,
        variance,
        weight,
        gate,
    }
}

fn filter(count: usize, variance: f64, drift: f64) -> Kalman {
    let mut covariance = [0.0; TRIANGLE];
    for index in 0..count {
        covariance[lower(index, index)] = variance;
    }
    Kalman {
        count,
        coefficients: [0.0; TERMS_MAX],
        covariance,
        drift: [drift; TERMS_MAX],
        caps: [1e6; TERMS_MAX],
    }
}

/// Without drift it is least squares that forget nothing, whose recursion goes another way.
#[test]
fn without_drift_it_is_least_squares() {
    let state = &mut 31;
    for (count, law) in [
        (2, FrictionLaw::default()),
        (
            3,
            FrictionLaw {
                load: true,
                ..FrictionLaw::default()
            },
        ),
        (
            4,
            FrictionLaw {
                by_direction: true,
                load: false,
                quadratic: true,
            },
        ),
        (
            5,
            FrictionLaw {
                by_direction: true,
                load: true,
                quadratic: true,
            },
        ),
    ] {
        let mut kalman = filter(count, 4.0, 0.0);
        let mut triangle = [0.0; TRIANGLE];
        triangle.copy_from_slice(&kalman.covariance);
        let noise = 0.09;
        let mut squares = LeastSquares::new(count, &[0.0; TERMS_MAX], &triangle, noise, [1e12; TERMS_MAX]).unwrap();
        for _ in 0..500 {
            let psi = law.regressors(2.0 * random(state), 5.0 * random(state));
            let (torque, weight) = (3.0 * random(state), 0.6 + 0.4 * random(state));
            kalman.wander(0.001);
            assert!(matches!(
                kalman.update(&measured(&psi, torque, noise, weight, None)),
                Taken::Used(_)
            ));
            let row = Row {
                psi: &psi,
                torque,
                worth: Worth::new(weight, 1.0, 0.001),
                bound: f64::INFINITY,
            };
            squares.update(&row).unwrap();
        }
        let expected = squares.factor.matrix(count);
        for i in 0..count {
            assert!((kalman.coefficients[i] - squares.coefficients[i]).abs() < 1e-9);
            for k in 0..=i {
                let scale = noise * (expected[lower(i, i)] * expected[lower(k, k)]).sqrt();
                let error = (kalman.covariance[lower(i, k)] - noise * expected[lower(i, k)]).abs();
                assert!(error < 1e-9 * scale, "{i} {k}: {error}");
            }
        }
    }
}

/// Coefficients that wander as assumed are inside their 95 % intervals in 95 % of 1000 draws, to within four standard
/// deviations of that share (0.7 %).
#[test]
fn intervals_cover_while_coefficients_wander() {
    let (drift, step, deviation) = (0.04, 0.01, 0.5);
    let mut inside = 0;
    for run in 0..500 {
        let state = &mut (500 + run);
        let mut truth = [2.0 * normal(state), 2.0 * normal(state)];
        let mut kalman = filter(2, 4.0, drift);
        for _ in 0..600 {
            for value in &mut truth {
                *value += libm::sqrt(drift * step) * normal(state);
            }
            let psi = FrictionLaw::default().regressors(1.5 * random(state), 0.0);
            let torque = psi[0] * truth[0] + psi[1] * truth[1] + deviation * normal(state);
            kalman.wander(step);
            kalman.update(&measured(&psi, torque, deviation * deviation, 1.0, None));
        }
        for (index, truth) in truth.iter().enumerate() {
            let width = 1.96 * kalman.covariance[lower(index, index)].sqrt();
            inside += u32::from((kalman.coefficients[index] - truth).abs() < width);
        }
    }
    let covered = f64::from(inside) / 1000.0;
    println!("{covered}");
    assert!((covered - 0.95).abs() < 0.028, "{covered}");
}

#[test]
fn an_outlier_is_not_taken_and_nonsense_changes_nothing() {
    let state = &mut 41;
    let mut kalman = filter(2, 4.0, 0.01);
    let law = FrictionLaw::default();
    for _ in 0..1000 {
        let psi = law.regressors(random(state), 0.0);
        kalman.wander(0.001);
        kalman.update(&measured(
            &psi,
            2.0 * psi[0] + 0.1 * normal(state),
            0.01,
            1.0,
            Some(5.0),
        ));
    }
    let before = kalman.clone();
    let psi = law.regressors(0.5, 0.0);
    assert!(matches!(
        kalman.update(&measured(&psi, 9.0, 0.01, 1.0, Some(5.0))),
        Taken::Outlier(_)
    ));
    for bad in [f64::NAN, f64::INFINITY, 1e300] {
        assert_eq!(
            kalman.update(&measured(&psi, bad, 0.01, 1.0, Some(5.0))),
            Taken::NotFinite
        );
    }
    assert_eq!(kalman, before);
}

/// A year at rest: what is known fades to the caps and no further.
#[test]
fn it_never_grows_beyond_its_caps() {
    let mut kalman = filter(2, 1.0, 10.0);
    kalman.caps = [50.0; TERMS_MAX];
    for _ in 0..1000 {
        kalman.wander(31_536.0);
    }
    assert_eq!([kalman.covariance[0], kalman.covariance[2]], [50.0, 50.0]);
}
