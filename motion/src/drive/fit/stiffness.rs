//! The stiffness of a transmission from torques and the deformations under them (eq 6):
//!
//! ```text
//! τE(Φ) = Σ kⱼ·Φ^(2j−1),  j = 1 … P
//! ```
//!
//! Least squares over the pairs, with a constant beside it that takes the offset of the two zeros and is not part of the stiffness. Powers are taken of
//! Φ over its largest magnitude, so that they stay comparable. Where K = ∂τE/∂Φ would not be positive everywhere within the
//! measured deformations the polynomial is not a spring's, and that is said.

use super::least_squares::{Fitted, fit_columns};
use super::recording::is_value;
use super::report::Missing;
use crate::error::Invalid;
use crate::tolerance::{FIT_SAMPLES_MAX, FIT_VALUE_MAX, STIFFNESS_PROBES, STIFFNESS_TERMS_MAX};

/// A stiffness polynomial.
#[derive(Debug, Clone, PartialEq)]
pub struct Stiffness {
    /// k₁ … k_P, in N m/rad^(2j−1) or N/m^(2j−1), as [`crate::robot::spec::Drive::stiffness`] has them.
    pub coefficients: Vec<f64>,
    /// Standard deviation of each.
    pub deviations: Vec<f64>,
    /// Torque at no deformation, taken off: N m or N.
    pub offset: f64,
    /// Standard deviation of the torque about the polynomial, N m or N.
    pub residual: f64,
    /// Least and greatest deformation that it was fitted to, rad or m: beyond them it says nothing.
    pub range: (f64, f64),
}

/// What came of it.
#[derive(Debug, Clone, PartialEq)]
pub enum StiffnessOutcome {
    /// A polynomial that is a spring's over the measured deformations.
    Fitted(Stiffness),
    /// The pairs do not tell.
    Missing(Missing),
}

/// Fits an odd polynomial of `terms` terms to torques (N m or N) and deformations Θ − q (rad or m).
///
/// # Errors
/// Lengths that differ, numbers that are none, and a number of terms that is not between 1 and the most.
pub fn fit_stiffness(torque: &[f64], deformation: &[f64], terms: usize) -> Result<StiffnessOutcome, Vec<Invalid>> {
    let faults = check(torque, deformation, terms);
    if !faults.is_empty() {
        return Err(faults);
    }
    let missing = |message: String| {
        Ok(StiffnessOutcome::Missing(Missing {
            parameters: Vec::new(),
            message,
        }))
    };
    let needed = terms + 2;
    if torque.len() < needed {
        return missing(format!(
            "{} pairs are too few, {terms} terms ask for {needed}",
            torque.len()
        ));
    }
    let range = deformation
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(*x), b.max(*x)));
    let reach = range.0.abs().max(range.1.abs());
    if reach <= 0.0 {
        return missing("nothing was deformed: load the joint".to_owned());
    }
    let power = |x: f64, j: usize| libm::pow(x.abs() / reach, (2 * j + 1) as f64) * x.signum();
    let mut columns: Vec<Vec<f64>> = (0..terms)
        .map(|j| deformation.iter().map(|x| power(*x, j)).collect())
        .collect();
    columns.push(vec![1.0; torque.len()]);
    let Some(fitted) = fit_columns(&columns, torque) else {
        return missing(format!(
            "the deformations do not tell {terms} terms and an offset apart: take more different loads, in both directions"
        ));
    };
    let Fitted {
        mut values,
        mut deviations,
        residual,
    } = fitted;
    let offset = values.pop().unwrap_or(0.0);
    deviations.pop();
    if let Some(at) = slack(&values, range, reach) {
        return missing(format!(
            "the stiffness would not be positive at a deformation of {at:.3e}: use fewer terms, or more accurate pairs there"
        ));
    }
    for j in 0..terms {
        let unit = libm::pow(reach, (2 * j + 1) as f64);
        values[j] /= unit;
        deviations[j] /= unit;
    }
    Ok(StiffnessOutcome::Fitted(Stiffness {
        coefficients: values,
        deviations,
        offset,
        residual,
        range,
    }))
}

/// A deformation in the range at which K is not positive.
fn slack(scaled: &[f64], (from, to): (f64, f64), reach: f64) -> Option<f64> {
    (0..=STIFFNESS_PROBES)
        .map(|k| from + (to - from) * k as f64 / STIFFNESS_PROBES as f64)
        .find(|x| {
            let square = (x / reach) * (x / reach);
            let slope = scaled
                .iter()
                .enumerate()
                .rev()
                .fold(0.0, |sum, (j, k)| sum * square + (2 * j + 1) as f64 * k);
            slope.is_nan() || slope <= 0.0
        })
}

fn check(torque: &[f64], deformation: &[f64], terms: usize) -> Vec<Invalid> {
    let mut faults = Vec::new();
    if !(1..=STIFFNESS_TERMS_MAX).contains(&terms) {
        let message = format!("{terms} must be between 1 and {STIFFNESS_TERMS_MAX}");
        faults.push(Invalid::new("terms", message));
    }
    if torque.len() != deformation.len() {
        let message = format!("{} values for {} torques", deformation.len(), torque.len());
        faults.push(Invalid::new("deformation", message));
    }
    if torque.len() > FIT_SAMPLES_MAX {
        let message = format!("{} values, the most is {FIT_SAMPLES_MAX}", torque.len());
        faults.push(Invalid::new("torque", message));
    }
    for (name, values) in [("torque", torque), ("deformation", deformation)] {
        if let Some(i) = values.iter().position(|value| !is_value(*value)) {
            let message = format!("{} must be a number up to {FIT_VALUE_MAX:e}", values[i]);
            faults.push(Invalid::new(format!("{name}[{i}]"), message));
        }
    }
    faults
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_arms::random;

    fn pairs(count: usize, noise: f64, state: &mut u64) -> (Vec<f64>, Vec<f64>) {
        let deformation: Vec<f64> = (0..count).map(|_| 0.004 * random(state)).collect();
        let torque = deformation
            .iter()
            .map(|x| 1.6e4 * x + 3e8 * x * x * x + 0.7 + noise * random(state))
            .collect();
        (torque, deformation)
    }

    fn fitted(torque: &[f64], deformation: &[f64], terms: usize) -> Stiffness {
        match fit_stiffness(torque, deformation, terms).unwrap() {
            StiffnessOutcome::Fitted(stiffness) => stiffness,
            StiffnessOutcome::Missing(missing) => panic!("{}", missing.message),
        }
    }

    #[test]
    fn an_exact_polynomial_comes_back() {
        let (torque, deformation) = pairs(40, 0.0, &mut 1);
        let found = fitted(&torque, &deformation, 2);
        assert!((found.coefficients[0] / 1.6e4 - 1.0).abs() < 1e-10);
        assert!((found.coefficients[1] / 3e8 - 1.0).abs() < 1e-9);
        assert!((found.offset - 0.7).abs() < 1e-9);
    }

    /// `numpy.linalg.lstsq` (NumPy 2) on the columns Φ, Φ³, 1 of these six pairs.
    #[test]
    fn agrees_with_another_solver() {
        let deformation = [-0.004, -0.002, -0.001, 0.0015, 0.003, 0.0045];
        let torque = [-82.0, -33.5, -15.0, 25.1, 57.0, 99.0];
        let found = fitted(&torque, &deformation, 2);
        for (found, expected) in found.coefficients.iter().chain([&found.offset]).zip(SOLVED) {
            assert!((found - expected).abs() < 1e-8 * expected.abs(), "{found} {expected}");
        }
        for (found, expected) in found.deviations.iter().zip(SOLVED_DEVIATIONS) {
            assert!((found - expected).abs() < 1e-8 * expected.abs(), "{found} {expected}");
        }
    }

    const SOLVED: [f64; 3] = [15915.75093412243, 295257918.09815216, 0.7414148506657948];
    const SOLVED_DEVIATIONS: [f64; 2] = [196.65614552833196, 12507909.695843503];

    #[test]
    fn the_truth_is_within_two_deviations_as_often_as_it_should() {
        let state = &mut 3;
        let runs = 500;
        let within = (0..runs)
            .filter(|_| {
                let (torque, deformation) = pairs(60, 2.0, state);
                let found = fitted(&torque, &deformation, 2);
                (found.coefficients[0] - 1.6e4).abs() < 1.96 * found.deviations[0]
            })
            .count();
        let part = within as f64 / f64::from(runs);
        assert!((0.92..=0.98).contains(&part), "{part}");
    }

    #[test]
    fn what_does_not_tell_is_said() {
        let said = |torque: &[f64], deformation: &[f64], terms| match fit_stiffness(torque, deformation, terms).unwrap()
        {
            StiffnessOutcome::Missing(missing) => missing.message,
            StiffnessOutcome::Fitted(found) => panic!("{found:?}"),
        };
        assert!(said(&[1.0, 2.0], &[0.1, 0.2], 1).contains("too few"));
        assert!(said(&[1.0; 5], &[0.0; 5], 1).contains("nothing was deformed"));
        assert!(said(&[1.0, 1.1, 0.9, 1.0], &[0.1; 4], 1).contains("apart"));
        assert!(said(&[-1.0, 0.0, 1.0, 2.0], &[0.1, 0.0, -0.1, -0.2], 1).contains("not be positive"));
        assert_eq!(fit_stiffness(&[f64::NAN], &[0.0, 1.0], 0).unwrap_err().len(), 3);
    }
}
