//! Cross-validation: what a fit to all but one stretch of the motion says of the stretch that it did not see.
//!
//! Neighbouring samples are alike, so single ones left out would be told by their neighbours; whole stretches are left out
//! (C. Bergmeir, J. Benítez, "On the use of cross-validation for time series predictor evaluation", 2012).

use super::design::Design;
use super::linear::dot;
use super::normal::Normal;
use super::solve::{Prior, Solution, inverse, solve};
use crate::budget::{Budget, Stopped};
use crate::tolerance::{BUDGET_STRIDE, RIDGES};

/// Everything that a fit is made of.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Problem<'a> {
    pub(crate) design: &'a Design,
    pub(crate) normal: &'a Normal,
    pub(crate) prior: &'a Prior,
    /// Weight of each joint's samples.
    pub(crate) weights: &'a [f64],
    pub(crate) budget: &'a Budget<'a>,
}

/// Errors on stretches that were left out: by joint, over the selected samples.
#[derive(Debug, Clone)]
pub(crate) struct Validated {
    pub(crate) errors: Vec<Vec<f64>>,
    /// Variances of the torque that the parameters left at each, where asked for.
    pub(crate) variances: Vec<Vec<f64>>,
}

impl Problem<'_> {
    /// Solves with everything.
    pub(crate) fn solve(&self, ridge: f64, start: &[f64]) -> Result<Option<Solution>, Stopped> {
        solve(
            self.prior,
            &self.normal.sum(self.weights, None),
            ridge,
            start,
            self.budget,
        )
    }

    /// Solves with one stretch left out after the other.
    pub(crate) fn validate(
        &self,
        ridge: f64,
        start: &[f64],
        with_variances: bool,
    ) -> Result<Option<Validated>, Stopped> {
        let joints = self.design.rows.len();
        let mut validated = Validated {
            errors: vec![Vec::new(); joints],
            variances: vec![Vec::new(); joints],
        };
        let count = start.len();
        for (left_out, (from, to)) in self.normal.stretches.iter().enumerate() {
            let equations = self.normal.sum(self.weights, Some(left_out));
            let Some(solution) = solve(self.prior, &equations, ridge, start, self.budget)? else {
                return Ok(None);
            };
            let covariance = if with_variances {
                let Some(covariance) = inverse(&solution.hessian, count, self.budget)? else {
                    return Ok(None);
                };
                Some(covariance)
            } else {
                None
            };
            for (joint, rows) in self.design.rows.iter().enumerate() {
                self.budget.check()?;
                let residual = rows.residual_of(&solution.values, *from, *to);
                validated.errors[joint].extend(residual);
                let Some(covariance) = &covariance else { continue };
                for sample in *from..*to {
                    if sample % BUDGET_STRIDE == 0 {
                        self.budget.check()?;
                    }
                    validated.variances[joint].push(rows.variance(covariance, count, sample));
                }
            }
        }
        Ok(Some(validated))
    }

    /// The ridge with the least error on what was left out, or, where the description is to be `trusted`, the strongest that is no worse
    /// by more than one standard error of the difference (L. Breiman et al., "Classification and Regression Trees", 1984,
    /// §3.4.3): motions to come are less like this one than its own stretches are, so what it cannot tell is left to the
    /// description.
    pub(crate) fn choose_ridge(&self, start: &[f64], trusted: bool) -> Result<Option<f64>, Stopped> {
        let mut tried: Vec<(f64, Vec<Vec<f64>>)> = Vec::with_capacity(RIDGES.len());
        for ridge in RIDGES {
            let Some(validated) = self.validate(ridge, start, false)? else {
                continue;
            };
            tried.push((ridge, self.squares(&validated)));
        }
        let total = |squares: &Vec<Vec<f64>>| -> f64 {
            let of_joint = |j: usize| libm::log(squares.iter().map(|stretch| stretch[j]).sum::<f64>());
            (0..self.design.rows.len()).map(of_joint).sum()
        };
        let Some(best) = tried.iter().min_by(|a, b| total(&a.1).total_cmp(&total(&b.1))) else {
            return Ok(None);
        };
        if !trusted {
            return Ok(Some(best.0));
        }
        let strongest = tried.iter().rev().find(|(_, squares)| is_as_good(squares, &best.1));
        Ok(strongest.or(Some(best)).map(|(ridge, _)| *ridge))
    }

    /// Sum of squared errors by stretch and joint.
    fn squares(&self, validated: &Validated) -> Vec<Vec<f64>> {
        let first = self.normal.stretches[0].0;
        let of_stretch = |(from, to): &(usize, usize)| -> Vec<f64> {
            let of_joint = |errors: &Vec<f64>| {
                let errors = &errors[from - first..to - first];
                dot(errors, errors)
            };
            validated.errors.iter().map(of_joint).collect()
        };
        self.normal.stretches.iter().map(of_stretch).collect()
    }
}

/// Whether squared errors, by stretch and joint, are those of the best ridge but for chance.
fn is_as_good(squares: &[Vec<f64>], best: &[Vec<f64>]) -> bool {
    let joints = best.first().map_or(0, Vec::len);
    let scale: Vec<f64> = (0..joints)
        .map(|j| best.iter().map(|stretch| stretch[j]).sum::<f64>())
        .collect();
    let differences: Vec<f64> = squares
        .iter()
        .zip(best)
        .map(|(a, b)| {
            (0..joints)
                .map(|j| (a[j] - b[j]) / scale[j].max(f64::MIN_POSITIVE))
                .sum()
        })
        .collect();
    let count = differences.len() as f64;
    let mean = differences.iter().sum::<f64>() / count;
    let spread: f64 = differences.iter().map(|d| (d - mean) * (d - mean)).sum();
    mean <= (spread / (count * (count - 1.0).max(1.0))).sqrt()
}
