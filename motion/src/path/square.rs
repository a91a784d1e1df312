//! Least squares of six equations and up to six unknowns: Householder's QR (Golub and Van Loan 2013, algorithm 5.2.1).

use crate::tolerance::RANK_MIN;

/// A 6 × n matrix, n ≤ 6, decomposed.
#[derive(Debug, Clone, Copy)]
pub(super) struct Decomposed {
    count: usize,
    /// By column: below and on the diagonal the reflector, above it R.
    columns: [[f64; 6]; 6],
    /// Diagonal of R.
    diagonal: [f64; 6],
    /// 2/|v|² of each reflector.
    scale: [f64; 6],
}

impl Decomposed {
    /// Decomposes the first `count` columns.
    pub(super) fn new(mut columns: [[f64; 6]; 6], count: usize) -> Self {
        let (mut diagonal, mut scale) = ([0.0; 6], [0.0; 6]);
        for k in 0..count {
            let norm = columns[k][k..].iter().map(|v| v * v).sum::<f64>().sqrt();
            let head = columns[k][k];
            diagonal[k] = if head > 0.0 { -norm } else { norm };
            columns[k][k] = head - diagonal[k];
            // |v|² = 2·norm·(norm + |head|)
            let square = norm * (norm + head.abs());
            scale[k] = if square > 0.0 { 1.0 / square } else { 0.0 };
            let reflector = columns[k];
            for column in &mut columns[k + 1..count] {
                reflect(&reflector, scale[k], column, k);
            }
        }
        Self {
            count,
            columns,
            diagonal,
            scale,
        }
    }

    /// The unknowns that leave the least square of what is missing, and that.
    pub(super) fn solve(&self, mut right: [f64; 6]) -> ([f64; 6], f64) {
        for k in 0..self.count {
            reflect(&self.columns[k], self.scale[k], &mut right, k);
        }
        let missing = right[self.count..].iter().map(|v| v * v).sum::<f64>().sqrt();
        for k in (0..self.count).rev() {
            let value = right[k] / self.pivot(k);
            right[k] = value;
            for (right, entry) in right.iter_mut().zip(&self.columns[k][..k]) {
                *right -= entry * value;
            }
        }
        right[self.count..].fill(0.0);
        (right, missing)
    }

    /// A lower bound of the smallest singular value, at most √n below it: 1/‖R⁻¹‖, Frobenius norm.
    pub(super) fn smallest(&self) -> f64 {
        let mut sum = 0.0;
        for unit in 0..self.count {
            let mut column = [0.0; 6];
            column[unit] = 1.0;
            for k in (0..=unit).rev() {
                let value = column[k] / self.pivot(k);
                sum += value * value;
                for (column, entry) in column.iter_mut().zip(&self.columns[k][..k]) {
                    *column -= entry * value;
                }
            }
        }
        1.0 / sum.sqrt()
    }

    /// The diagonal of R, kept from 0.
    fn pivot(&self, k: usize) -> f64 {
        let pivot = self.diagonal[k];
        if pivot.abs() > RANK_MIN {
            pivot
        } else {
            RANK_MIN.copysign(pivot)
        }
    }
}

/// x − v·(2/|v|²)·(v·x), from row k on; `scale` is 1/(|v|²/2).
#[inline(always)]
fn reflect(reflector: &[f64; 6], scale: f64, column: &mut [f64; 6], k: usize) {
    let mut dot = 0.0;
    for row in k..6 {
        dot += reflector[row] * column[row];
    }
    let factor = dot * scale;
    for row in k..6 {
        column[row] -= factor * reflector[row];
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use super::*;
    use crate::test_arms::values;

    fn random_columns(state: &mut u64) -> [[f64; 6]; 6] {
        std::array::from_fn(|_| values(6, 1.0, state).try_into().unwrap())
    }

    #[test]
    fn agrees_with_a_singular_value_decomposition() {
        let state = &mut 4;
        for round in 0..600 {
            let count = 1 + round % 6;
            let columns = random_columns(state);
            let right: [f64; 6] = values(6, 1.0, state).try_into().unwrap();
            let matrix = DMatrix::from_fn(6, count, |row, column| columns[column][row]);
            let svd = matrix.clone().svd(true, true);
            let b = DVector::from_row_slice(&right);
            let expected = svd.solve(&b, 0.0).unwrap();
            let decomposed = Decomposed::new(columns, count);
            let (x, missing) = decomposed.solve(right);
            let smallest = svd.singular_values.min();
            for j in 0..count {
                assert!((x[j] - expected[j]).abs() < 1e-12 * (1.0 + expected[j].abs()) / smallest / smallest);
            }
            assert!((missing - (b - matrix * expected).norm()).abs() < 1e-12 / smallest);
            let bound = decomposed.smallest();
            assert!(bound <= smallest * (1.0 + 1e-9) && bound >= smallest / 6f64.sqrt() * (1.0 - 1e-9));
        }
    }

    #[test]
    fn singular_ones_stay_finite() {
        let mut columns = [[0.0; 6]; 6];
        columns[0] = [1.0; 6];
        columns[1] = [1.0; 6];
        let decomposed = Decomposed::new(columns, 6);
        assert!(
            decomposed
                .solve([1.0, -2.0, 3.0, 0.0, 0.0, 0.0])
                .0
                .iter()
                .all(|x| x.is_finite())
        );
        assert!(decomposed.smallest() < 1e-12);
    }
}
