//! Ordinary least squares of a few columns: values, their deviations, and whether the columns are independent.

use super::linear::{Cholesky, dot, eigen};
use crate::budget::Budget;
use crate::tolerance::COLUMNS_INDEPENDENT;

/// A solution.
#[derive(Debug, Clone)]
pub(crate) struct Fitted {
    pub(crate) values: Vec<f64>,
    /// Standard deviations, of independent errors with the residual's variance.
    pub(crate) deviations: Vec<f64>,
    /// Standard deviation of the residual.
    pub(crate) residual: f64,
}

/// Fits columns to a target. `None`: there are not more rows than columns, or a singular value of the columns, each scaled to
/// length 1, is below [`COLUMNS_INDEPENDENT`].
pub(crate) fn fit_columns(columns: &[Vec<f64>], target: &[f64]) -> Option<Fitted> {
    let (size, rows) = (columns.len(), target.len());
    if rows <= size {
        return None;
    }
    let length: Vec<f64> = columns.iter().map(|column| dot(column, column).sqrt()).collect();
    if length.iter().any(|length| length.is_nan() || *length <= 0.0) {
        return None;
    }
    let mut gram = vec![0.0; size * size];
    for (a, column) in columns.iter().enumerate() {
        for (b, other) in columns.iter().enumerate() {
            gram[a * size + b] = dot(column, other) / (length[a] * length[b]);
        }
    }
    let budget = Budget::unlimited();
    let (eigenvalues, _) = eigen(&gram, size, &budget).ok()?;
    if eigenvalues
        .iter()
        .any(|value| *value < COLUMNS_INDEPENDENT * COLUMNS_INDEPENDENT)
    {
        return None;
    }
    let factor = Cholesky::new(&gram, size, &budget).ok()??;
    let inverse = factor.inverse(&budget).ok()?;
    let mut scaled = vec![0.0; size];
    let mut residuals = target.to_vec();
    // the second round takes off what rounding left of the normal equations
    for _ in 0..2 {
        let mut step: Vec<f64> = columns
            .iter()
            .zip(&length)
            .map(|(column, length)| dot(column, &residuals) / length)
            .collect();
        factor.solve(&mut step);
        for ((value, step), (column, length)) in scaled.iter_mut().zip(&step).zip(columns.iter().zip(&length)) {
            *value += step;
            for (residual, x) in residuals.iter_mut().zip(column) {
                *residual -= step * x / length;
            }
        }
    }
    let residual = (dot(&residuals, &residuals) / (rows - size) as f64).sqrt();
    let deviation = |k: usize| residual * inverse[k * size + k].max(0.0).sqrt() / length[k];
    Some(Fitted {
        values: scaled.iter().zip(&length).map(|(v, l)| v / l).collect(),
        deviations: (0..size).map(deviation).collect(),
        residual,
    })
}
