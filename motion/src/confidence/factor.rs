//! The covariance of a robot's fitted parameters, factored once for all bands that are computed with it.
//!
//! ```text
//! Σ = L·Lᵀ      var(φᵀ·π) = |Lᵀ·φ|²
//! ```
//!
//! Parameters are ordered from the tip to the base. A joint's torque depends on the links that it carries alone, so the row φ of
//! joint i has entries in its first columns only, and of the triangle L the top is enough.

use crate::dynamics::regressor;
use crate::error::Invalid;
use crate::robot::spec::RobotSpec;
use crate::tolerance::COVARIANCE_LIFT;

/// What a robot carries of its uncertainty, ready to compute with.
#[derive(Debug)]
pub(crate) struct Factor {
    /// Column of each parameter in a row of the regressor, from the tip to the base.
    columns: Vec<usize>,
    /// How many of them a joint's torque depends on.
    counts: Vec<usize>,
    /// L, its lower triangle row by row.
    lower: Vec<f64>,
}

impl Factor {
    /// Factors what a description says; `None` where it says nothing.
    ///
    /// # Errors
    /// What registration refuses in descriptions: sizes that do not fit, a covariance that is none.
    pub(crate) fn new(spec: &RobotSpec) -> Result<Option<Self>, Vec<Invalid>> {
        let Some(uncertainty) = &spec.uncertainty else {
            return Ok(None);
        };
        let refuse = |path: &str, message: String| Err(vec![Invalid::new(path, message)]);
        let (joints, count) = (spec.joints.len(), uncertainty.parameters.len());
        if uncertainty.covariance.len() != count * (count + 1) / 2 {
            return refuse(
                "uncertainty.covariance",
                format!("must be the lower triangle of {count} parameters"),
            );
        }
        if uncertainty.residuals.len() != joints {
            return refuse(
                "uncertainty.residuals",
                format!("must have one entry for each of {joints} joints"),
            );
        }
        if uncertainty.parameters.iter().any(|parameter| parameter.joint >= joints) {
            return refuse("uncertainty.parameters", format!("must be of {joints} joints"));
        }
        let mut order: Vec<usize> = (0..count).collect();
        order.sort_by_key(|index| std::cmp::Reverse(uncertainty.parameters[*index].joint));
        let entry = |row: usize, column: usize| {
            let (i, j) = (order[row].max(order[column]), order[row].min(order[column]));
            uncertainty.covariance[i * (i + 1) / 2 + j]
        };
        let lower = cholesky(count, 0.0, entry).or_else(|| cholesky(count, COVARIANCE_LIFT, entry));
        let Some(lower) = lower else {
            return refuse("uncertainty.covariance", "is not positive semidefinite".to_owned());
        };
        let carried = |joint: usize| {
            let parameters = uncertainty.parameters.iter();
            parameters.filter(|parameter| parameter.joint >= joint).count()
        };
        let parameters = order.iter().map(|index| uncertainty.parameters[*index]);
        Ok(Some(Self {
            columns: parameters.map(regressor::column).collect(),
            counts: (0..joints).map(carried).collect(),
            lower,
        }))
    }

    /// How many parameters were fitted.
    pub(crate) fn parameter_count(&self) -> usize {
        self.columns.len()
    }

    /// Writes Lᵀ·φ for the row of a joint and returns its length, the standard deviation of what the model says of the joint's
    /// torque. `spread` has an entry a parameter.
    pub(crate) fn spread(&self, joint: usize, row: &[f64], spread: &mut [f64]) -> f64 {
        spread.fill(0.0);
        for (k, column) in self.columns[..self.counts[joint]].iter().enumerate() {
            let derivative = row[*column];
            if derivative == 0.0 {
                continue;
            }
            let start = k * (k + 1) / 2;
            for (sum, factor) in spread.iter_mut().zip(&self.lower[start..=start + k]) {
                *sum += factor * derivative;
            }
        }
        let squares: f64 = spread[..self.counts[joint]].iter().map(|value| value * value).sum();
        squares.sqrt()
    }
}

/// L of Σ, each variance raised by a part of it. A parameter without variance has a row of zeros. `None`, where Σ has a
/// negative eigenvalue.
fn cholesky(count: usize, lift: f64, entry: impl Fn(usize, usize) -> f64) -> Option<Vec<f64>> {
    let mut lower = vec![0.0; count * (count + 1) / 2];
    let deviation: Vec<f64> = (0..count).map(|row| entry(row, row).sqrt()).collect();
    for row in 0..count {
        let start = row * (row + 1) / 2;
        if deviation[row] == 0.0 {
            continue;
        }
        for column in 0..=row {
            let other = column * (column + 1) / 2;
            if deviation[column] == 0.0 {
                continue;
            }
            let scale = deviation[row] * deviation[column];
            let sum: f64 = (0..column).map(|k| lower[start + k] * lower[other + k]).sum();
            let rest = entry(row, column) / scale - sum;
            if column < row {
                lower[start + column] = rest / lower[other + column];
                continue;
            }
            let pivot = rest + lift;
            if pivot.is_nan() || pivot <= 0.0 {
                return None;
            }
            lower[start + column] = pivot.sqrt();
        }
    }
    // of the matrix scaled to ones, back to that of the parameters
    for (row, deviation) in deviation.iter().enumerate() {
        let start = row * (row + 1) / 2;
        for value in &mut lower[start..=start + row] {
            *value *= deviation;
        }
    }
    Some(lower)
}

#[cfg(test)]
mod tests;
