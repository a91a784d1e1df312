//! Symmetric systems of equations, row by row in one slice: Cholesky's factors, their inverse, and Jacobi's eigenvalues.
//!
//! Written out here because a general matrix product picks its instructions by the processor, and results must not.

use crate::budget::{Budget, Stopped};
use crate::tolerance::{JACOBI_SWEEPS, PIVOT_PART_MIN};

/// The lower factor L of A = L·Lᵀ.
#[derive(Debug, Clone)]
pub(crate) struct Cholesky {
    size: usize,
    lower: Vec<f64>,
}

impl Cholesky {
    /// Factors a matrix; `None` where it is not positive definite.
    pub(crate) fn new(matrix: &[f64], size: usize, budget: &Budget<'_>) -> Result<Option<Self>, Stopped> {
        let mut lower = matrix.to_vec();
        for i in 0..size {
            budget.check()?;
            for j in 0..=i {
                let (above, row) = lower.split_at(i * size);
                let sum = if j < i {
                    dot(&row[..j], &above[j * size..j * size + j])
                } else {
                    dot(&row[..j], &row[..j])
                };
                let rest = row[j] - sum;
                if j < i {
                    lower[i * size + j] = rest / lower[j * size + j];
                    continue;
                }
                if rest.is_nan() || rest <= PIVOT_PART_MIN * matrix[i * size + i] {
                    return Ok(None);
                }
                lower[i * size + i] = rest.sqrt();
            }
        }
        Ok(Some(Self { size, lower }))
    }

    /// Solves A·x = b in place.
    pub(crate) fn solve(&self, b: &mut [f64]) {
        let n = self.size;
        for i in 0..n {
            let (before, at) = b.split_at_mut(i);
            at[0] = (at[0] - dot(&self.lower[i * n..i * n + i], before)) / self.lower[i * n + i];
        }
        for i in (0..n).rev() {
            b[i] /= self.lower[i * n + i];
            for k in 0..i {
                b[k] -= self.lower[i * n + k] * b[i];
            }
        }
    }

    /// A⁻¹, whole.
    pub(crate) fn inverse(&self, budget: &Budget<'_>) -> Result<Vec<f64>, Stopped> {
        let n = self.size;
        let mut inverse = vec![0.0; n * n];
        let mut column = vec![0.0; n];
        for j in 0..n {
            budget.check()?;
            column.fill(0.0);
            column[j] = 1.0;
            self.solve(&mut column);
            for i in 0..n {
                inverse[i * n + j] = column[i];
            }
        }
        for i in 0..n {
            for j in 0..i {
                let mean = 0.5 * (inverse[i * n + j] + inverse[j * n + i]);
                inverse[i * n + j] = mean;
                inverse[j * n + i] = mean;
            }
        }
        Ok(inverse)
    }
}

/// Eigenvalues of a symmetric matrix and its eigenvectors, one a row, in no order (C. Jacobi 1846; cyclic, as G. Golub, C. Van
/// Loan, "Matrix Computations", §8.5).
pub(crate) fn eigen(matrix: &[f64], size: usize, budget: &Budget<'_>) -> Result<(Vec<f64>, Vec<Vec<f64>>), Stopped> {
    let mut a = matrix.to_vec();
    let mut vectors: Vec<Vec<f64>> = (0..size)
        .map(|i| (0..size).map(|j| if i == j { 1.0 } else { 0.0 }).collect())
        .collect();
    for _ in 0..JACOBI_SWEEPS {
        let mut turned = false;
        for p in 0..size {
            budget.check()?;
            for q in p + 1..size {
                let off = a[p * size + q];
                if off.abs() <= f64::EPSILON * (a[p * size + p] * a[q * size + q]).abs().sqrt() || off == 0.0 {
                    continue;
                }
                turned = true;
                let theta = (a[q * size + q] - a[p * size + p]) / (2.0 * off);
                let t = theta.signum() / (theta.abs() + libm::sqrt(theta * theta + 1.0));
                let c = 1.0 / libm::sqrt(t * t + 1.0);
                let s = t * c;
                for k in 0..size {
                    let (x, y) = (a[k * size + p], a[k * size + q]);
                    a[k * size + p] = c * x - s * y;
                    a[k * size + q] = s * x + c * y;
                }
                for k in 0..size {
                    let (x, y) = (a[p * size + k], a[q * size + k]);
                    a[p * size + k] = c * x - s * y;
                    a[q * size + k] = s * x + c * y;
                    let (x, y) = (vectors[p][k], vectors[q][k]);
                    vectors[p][k] = c * x - s * y;
                    vectors[q][k] = s * x + c * y;
                }
            }
        }
        if !turned {
            break;
        }
    }
    Ok(((0..size).map(|i| a[i * size + i]).collect(), vectors))
}

/// Sum of products, in four running sums that the compiler can keep in one register.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 4];
    let (fours, rest) = a.as_chunks::<4>();
    let (other_fours, other_rest) = b.as_chunks::<4>();
    for (x, y) in fours.iter().zip(other_fours) {
        for ((sum, x), y) in sums.iter_mut().zip(x).zip(y) {
            *sum += x * y;
        }
    }
    let tail: f64 = rest.iter().zip(other_rest).map(|(x, y)| x * y).sum();
    (sums[0] + sums[1]) + (sums[2] + sums[3]) + tail
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_arms::values;

    fn random_definite(size: usize, seed: u64) -> Vec<f64> {
        let root = values(size * size, 1.0, &mut seed.clone());
        let mut matrix = vec![0.0; size * size];
        for i in 0..size {
            for j in 0..size {
                matrix[i * size + j] = dot(&root[i * size..(i + 1) * size], &root[j * size..(j + 1) * size]);
            }
            matrix[i * size + i] += 0.1;
        }
        matrix
    }

    #[test]
    fn the_inverse_times_the_matrix_is_one() {
        for size in [1, 2, 5, 23, 64] {
            let matrix = random_definite(size, size as u64);
            let factor = Cholesky::new(&matrix, size, &Budget::unlimited()).unwrap().unwrap();
            let inverse = factor.inverse(&Budget::unlimited()).unwrap();
            for i in 0..size {
                for j in 0..size {
                    let product = dot(&matrix[i * size..(i + 1) * size], &inverse[j * size..(j + 1) * size]);
                    assert!((product - if i == j { 1.0 } else { 0.0 }).abs() < 1e-9);
                }
            }
        }
    }

    #[test]
    fn eigenvectors_are_only_stretched() {
        for size in [1, 3, 12, 40] {
            let matrix = random_definite(size, 7 + size as u64);
            let (eigenvalues, vectors) = eigen(&matrix, size, &Budget::unlimited()).unwrap();
            for (value, vector) in eigenvalues.iter().zip(&vectors) {
                for i in 0..size {
                    let stretched = dot(&matrix[i * size..(i + 1) * size], vector);
                    assert!((stretched - value * vector[i]).abs() < 1e-10 * size as f64);
                }
                assert!((dot(vector, vector) - 1.0).abs() < 1e-12 && *value > 0.0);
            }
        }
    }

    #[test]
    fn what_is_not_positive_definite_has_no_factor() {
        let indefinite = [1.0, 2.0, 2.0, 1.0];
        assert!(Cholesky::new(&indefinite, 2, &Budget::unlimited()).unwrap().is_none());
        assert!(Cholesky::new(&[f64::NAN], 1, &Budget::unlimited()).unwrap().is_none());
    }
}
