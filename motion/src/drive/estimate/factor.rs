//! A covariance as U·D·Uᵀ (U unit upper triangular, D diagonal), and its update by one measurement, which keeps it
//! symmetric and positive by construction and loses no digits where the textbook's Q − L·Ψ·Q does (Bierman, Factorization
//! Methods for Discrete Sequential Estimation, 1977, V.3).

use super::law::{TERMS_MAX, TRIANGLE};

/// Entries of U above its diagonal.
const ABOVE: usize = TERMS_MAX * (TERMS_MAX - 1) / 2;

/// Part of a variance that is rounding once the others are taken out of it: below, the matrix is singular.
const PIVOT_MIN: f64 = 1.0e-13;

/// U·D·Uᵀ of the first `count` rows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct UnitFactor {
    /// U above its diagonal, column by column: row i of column j at j(j−1)/2 + i.
    pub(super) upper: [f64; ABOVE],
    pub(super) diagonal: [f64; TERMS_MAX],
}

/// What a measurement does to the estimate: f ← f + gain·innovation.
#[derive(Debug, Clone, Copy)]
pub(super) struct Gain {
    pub(super) gain: [f64; TERMS_MAX],
    /// ψ·P·ψᵀ before the measurement.
    pub(super) spread: f64,
}

#[inline(always)]
const fn above(row: usize, column: usize) -> usize {
    column * (column - 1) / 2 + row
}

/// Where the entry of a symmetric matrix stands in its lower triangle, row by row.
#[inline(always)]
pub(super) const fn lower(row: usize, column: usize) -> usize {
    if row < column {
        return lower(column, row);
    }
    row * (row + 1) / 2 + column
}

impl UnitFactor {
    /// Factors of a matrix given by its lower triangle; `None` where it is not positive definite.
    pub(super) fn of(count: usize, triangle: &[f64; TRIANGLE]) -> Option<Self> {
        let mut rest = *triangle;
        let mut factor = Self {
            upper: [0.0; ABOVE],
            diagonal: [0.0; TERMS_MAX],
        };
        for j in (0..count).rev() {
            let pivot = rest[lower(j, j)];
            let whole = triangle[lower(j, j)];
            if !(pivot.is_finite() && pivot > PIVOT_MIN * whole && pivot > 0.0) {
                return None;
            }
            factor.diagonal[j] = pivot;
            for i in 0..j {
                factor.upper[above(i, j)] = rest[lower(j, i)] / pivot;
            }
            for i in 0..j {
                for k in 0..=i {
                    rest[lower(i, k)] -= factor.upper[above(i, j)] * pivot * factor.upper[above(k, j)];
                }
            }
        }
        Some(factor)
    }

    #[inline(always)]
    fn entry(&self, row: usize, column: usize) -> f64 {
        match row.cmp(&column) {
            std::cmp::Ordering::Less => self.upper[above(row, column)],
            std::cmp::Ordering::Equal => 1.0,
            std::cmp::Ordering::Greater => 0.0,
        }
    }

    /// The matrix: its lower triangle.
    pub(super) fn matrix(&self, count: usize) -> [f64; TRIANGLE] {
        let mut matrix = [0.0; TRIANGLE];
        for i in 0..count {
            for k in 0..=i {
                matrix[lower(i, k)] = (i..count)
                    .map(|j| self.entry(i, j) * self.diagonal[j] * self.entry(k, j))
                    .sum();
            }
        }
        matrix
    }

    /// One entry of its diagonal.
    #[inline(always)]
    pub(super) fn variance(&self, count: usize, index: usize) -> f64 {
        let mut sum = self.diagonal[index];
        for j in index + 1..count {
            let entry = self.upper[above(index, j)];
            sum += entry * entry * self.diagonal[j];
        }
        sum
    }

    /// ψ·P·ψᵀ.
    pub(super) fn spread(&self, count: usize, psi: &[f64; TERMS_MAX]) -> f64 {
        (0..count)
            .map(|j| {
                let turned: f64 = (0..=j).map(|i| self.entry(i, j) * psi[i]).sum();
                turned * turned * self.diagonal[j]
            })
            .sum()
    }

    /// One column of the matrix.
    pub(super) fn column(&self, count: usize, index: usize) -> [f64; TERMS_MAX] {
        let mut column = [0.0; TERMS_MAX];
        for (row, value) in column.iter_mut().enumerate().take(count) {
            *value = (row.max(index)..count)
                .map(|j| self.entry(row, j) * self.diagonal[j] * self.entry(index, j))
                .sum();
        }
        column
    }

    /// The inverse of the matrix: its lower triangle. U⁻ᵀ·D⁻¹·U⁻¹.
    pub(super) fn inverse(&self, count: usize) -> [f64; TRIANGLE] {
        // columns of U⁻¹ by back substitution
        let mut inverse = [[0.0; TERMS_MAX]; TERMS_MAX];
        for (column, solved) in inverse.iter_mut().enumerate().take(count) {
            solved[column] = 1.0;
            for i in (0..column).rev() {
                solved[i] = -(i + 1..=column).map(|j| self.entry(i, j) * solved[j]).sum::<f64>();
            }
        }
        let mut matrix = [0.0; TRIANGLE];
        for i in 0..count {
            for k in 0..=i {
                matrix[lower(i, k)] = (0..=k).map(|j| inverse[i][j] * inverse[k][j] / self.diagonal[j]).sum();
            }
        }
        matrix
    }

    /// Takes in a measurement of ψ·f with a noise of variance `noise` > 0, whose inverse is `information`, and says by how much the
    /// estimate moves.
    #[inline(always)]
    #[allow(
        clippy::needless_range_loop,
        reason = "rows and columns by their index, as in the formulas"
    )]
    pub(super) fn measure<const N: usize>(&mut self, psi: &[f64; TERMS_MAX], noise: f64, information: f64) -> Gain {
        let mut turned = [0.0; N];
        for j in 0..N {
            let mut sum = psi[j];
            for i in 0..j {
                sum += self.upper[above(i, j)] * psi[i];
            }
            turned[j] = sum;
        }
        let mut gain = [0.0; TERMS_MAX];
        let mut alpha = noise;
        let mut inverse = information;
        for j in 0..N {
            let weighted = self.diagonal[j] * turned[j];
            let next = alpha + turned[j] * weighted;
            let slope = -turned[j] * inverse;
            inverse = 1.0 / next;
            self.diagonal[j] *= alpha * inverse;
            gain[j] = weighted;
            for i in 0..j {
                let entry = self.upper[above(i, j)];
                self.upper[above(i, j)] = entry + gain[i] * slope;
                gain[i] += entry * weighted;
            }
            alpha = next;
        }
        for value in gain.iter_mut().take(N) {
            *value *= inverse;
        }
        Gain {
            gain,
            spread: alpha - noise,
        }
    }

    /// The matrix times a factor.
    #[inline(always)]
    pub(super) fn grow<const N: usize>(&mut self, growth: f64) {
        for value in self.diagonal.iter_mut().take(N) {
            *value *= growth;
        }
    }
}

/// What a symmetric matrix makes of a vector.
pub(super) fn times(count: usize, triangle: &[f64; TRIANGLE], vector: &[f64; TERMS_MAX]) -> [f64; TERMS_MAX] {
    let mut product = [0.0; TERMS_MAX];
    for (row, value) in product.iter_mut().enumerate().take(count) {
        *value = (0..count)
            .map(|column| triangle[lower(row, column)] * vector[column])
            .sum();
    }
    product
}

/// A·B·A of two symmetric matrices.
pub(super) fn sandwich(count: usize, outer: &[f64; TRIANGLE], inner: &[f64; TRIANGLE]) -> [f64; TRIANGLE] {
    let mut columns = [[0.0; TERMS_MAX]; TERMS_MAX];
    for (index, column) in columns.iter_mut().enumerate().take(count) {
        let mut unit = [0.0; TERMS_MAX];
        unit[index] = 1.0;
        *column = times(count, inner, &times(count, outer, &unit));
    }
    let mut product = [0.0; TRIANGLE];
    for (index, column) in columns.iter().enumerate().take(count) {
        let product_column = times(count, outer, column);
        for row in index..count {
            product[lower(row, index)] = product_column[row];
        }
    }
    product
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use super::*;
    use crate::test_arms::{random, values};

    fn full(count: usize, triangle: &[f64; TRIANGLE]) -> DMatrix<f64> {
        DMatrix::from_fn(count, count, |i, k| triangle[lower(i, k)])
    }

    fn random_covariance(count: usize, state: &mut u64) -> [f64; TRIANGLE] {
        let root = DMatrix::from_fn(count, count, |_, _| random(state));
        let matrix = &root * root.transpose() + DMatrix::identity(count, count) * 0.01;
        let mut triangle = [0.0; TRIANGLE];
        for i in 0..count {
            for k in 0..=i {
                triangle[lower(i, k)] = matrix[(i, k)];
            }
        }
        triangle
    }

    #[test]
    fn factors_multiply_to_the_matrix_and_its_inverse() {
        let state = &mut 3;
        for count in [2, 3, 4, 5] {
            let triangle = random_covariance(count, state);
            let factor = UnitFactor::of(count, &triangle).unwrap();
            let matrix = full(count, &triangle);
            assert!((full(count, &factor.matrix(count)) - &matrix).amax() < 1e-14);
            assert!((full(count, &factor.inverse(count)) * &matrix - DMatrix::identity(count, count)).amax() < 1e-11);
            for index in 0..count {
                assert!((factor.variance(count, index) - matrix[(index, index)]).abs() < 1e-14);
                let column = factor.column(count, index);
                assert!((0..count).all(|row| (column[row] - matrix[(row, index)]).abs() < 1e-14));
            }
            let inner = random_covariance(count, state);
            let product = &matrix * full(count, &inner) * &matrix;
            assert!((full(count, &sandwich(count, &triangle, &inner)) - product).amax() < 1e-12);
        }
    }

    #[test]
    fn a_measurement_is_the_textbooks() {
        let state = &mut 8;
        let triangle = random_covariance(3, state);
        let matrix = full(3, &triangle);
        let mut factor = UnitFactor::of(3, &triangle).unwrap();
        let mut psi = [0.0; TERMS_MAX];
        psi[..3].copy_from_slice(&values(3, 2.0, state));
        let gain = factor.measure::<3>(&psi, 0.3, 1.0 / 0.3);
        let row = DVector::from_column_slice(&psi[..3]);
        let spread = (row.transpose() * &matrix * &row)[(0, 0)];
        let textbook = &matrix * &row / (0.3 + spread);
        assert!((0..3).all(|i| (gain.gain[i] - textbook[i]).abs() < 1e-14));
        assert!((gain.spread - spread).abs() < 1e-13);
        let after = &matrix - &textbook * row.transpose() * &matrix;
        assert!((full(3, &factor.matrix(3)) - after).amax() < 1e-14);
    }

    #[test]
    fn what_is_no_covariance_has_no_factors() {
        let mut triangle = [0.0; TRIANGLE];
        triangle[..3].copy_from_slice(&[1.0, 1.0, 1.0]);
        assert!(UnitFactor::of(2, &triangle).is_none(), "singular");
        triangle[..3].copy_from_slice(&[1.0, 2.0, 1.0]);
        assert!(UnitFactor::of(2, &triangle).is_none(), "indefinite");
        triangle[..3].copy_from_slice(&[f64::NAN, 0.0, 1.0]);
        assert!(UnitFactor::of(2, &triangle).is_none(), "no number");
        triangle[..3].copy_from_slice(&[0.0, 0.0, 1.0]);
        assert!(UnitFactor::of(2, &triangle).is_none(), "known exactly");
    }
}
