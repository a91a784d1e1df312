//! Symmetric matrices of up to six rows, in place: JᵀJ + λ·I, J·Jᵀ + λ·I.

use crate::tolerance::{IK_EIGEN_ROUNDING, IK_EIGEN_ROUNDS};

/// Rows of a Jacobian: three linear, three angular.
pub(super) const TASK: usize = 6;

/// The lower triangle of a symmetric matrix; what is outside `order` is not used.
#[derive(Debug, Clone, Copy)]
pub(super) struct Square {
    order: usize,
    entry: [[f64; TASK]; TASK],
}

impl Square {
    /// JᵀJ + λ·I of at most six columns.
    pub(super) fn of_columns(columns: &[[f64; TASK]], damping: f64) -> Self {
        let mut entry = [[0.0; TASK]; TASK];
        for (i, a) in columns.iter().enumerate() {
            for (j, b) in columns[..=i].iter().enumerate() {
                entry[i][j] = a.iter().zip(b).map(|(a, b)| a * b).sum();
            }
            entry[i][i] += damping;
        }
        Self {
            order: columns.len(),
            entry,
        }
    }

    /// J·Jᵀ + λ·I.
    pub(super) fn of_rows(columns: &[[f64; TASK]], damping: f64) -> Self {
        let mut entry = [[0.0; TASK]; TASK];
        for column in columns {
            for i in 0..TASK {
                for j in 0..=i {
                    entry[i][j] += column[i] * column[j];
                }
            }
        }
        for (i, row) in entry.iter_mut().enumerate() {
            row[i] += damping;
        }
        Self { order: TASK, entry }
    }

    /// x = A⁻¹·x, by A = L·D·Lᵀ. A pivot that is not positive, which rounding alone makes, stands for a direction
    /// without effect: its unknown is 0.
    #[allow(clippy::needless_range_loop, reason = "the indices are the formula's")]
    pub(super) fn solve(mut self, x: &mut [f64; TASK]) {
        let n = self.order;
        let mut inverse = [0.0; TASK];
        for j in 0..n {
            let mut pivot = self.entry[j][j];
            for k in 0..j {
                pivot -= self.entry[j][k] * self.entry[j][k] * self.entry[k][k];
            }
            self.entry[j][j] = pivot.max(0.0);
            inverse[j] = if pivot > 0.0 { 1.0 / pivot } else { 0.0 };
            for i in j + 1..n {
                let mut sum = self.entry[i][j];
                for k in 0..j {
                    sum -= self.entry[i][k] * self.entry[j][k] * self.entry[k][k];
                }
                self.entry[i][j] = sum * inverse[j];
            }
        }
        for i in 0..n {
            for k in 0..i {
                x[i] -= self.entry[i][k] * x[k];
            }
        }
        for i in (0..n).rev() {
            x[i] *= inverse[i];
            for k in i + 1..n {
                x[i] -= self.entry[k][i] * x[k];
            }
        }
    }

    /// The smallest eigenvalue of a matrix without negative ones.
    ///
    /// Householder's reflections make it tridiagonal (α, β); its characteristic polynomial p and two derivatives follow
    /// from pₖ = (αₖ − x)·pₖ₋₁ − βₖ²·pₖ₋₂. From the left of all roots Laguerre's steps rise to the smallest one and never
    /// pass it (B. N. Parlett, "The Symmetric Eigenvalue Problem", 1980; "Laguerre's method applied to the matrix
    /// eigenvalue problem", 1964).
    pub(super) fn smallest_eigenvalue(self) -> f64 {
        match self.order {
            // a number that the compiler knows: loops without ends to look at
            TASK => self.smallest_of(TASK),
            order => self.smallest_of(order),
        }
    }

    #[inline(always)]
    fn smallest_of(mut self, n: usize) -> f64 {
        self.tridiagonalize(n);
        let trace: f64 = (0..n).map(|i| self.entry[i][i]).sum();
        let count = n as f64;
        let mut x = 0.0;
        for _ in 0..IK_EIGEN_ROUNDS {
            let [p, slope, curvature] = self.characteristic(n, x);
            // left of all roots p is positive and falls; rounding alone leads to their right
            if p <= 0.0 || slope >= 0.0 {
                break;
            }
            // Σ 1/(λᵢ − x) and Σ 1/(λᵢ − x)²
            let first = -slope / p;
            let second = first * first - curvature / p;
            let root = libm::sqrt(((count - 1.0) * (count * second - first * first)).max(0.0));
            let step = count / (first + root);
            if !(step.is_finite() && step > trace * IK_EIGEN_ROUNDING) {
                break;
            }
            x += step;
        }
        x
    }

    /// A ← H·A·H for one reflection H = I − 2·v·vᵀ/|v|² after another, each of which clears a column below the
    /// subdiagonal. Only the lower triangle is kept.
    #[allow(clippy::needless_range_loop, reason = "the indices are the formula's")]
    #[inline(always)]
    fn tridiagonalize(&mut self, n: usize) {
        for k in 0..n.saturating_sub(2) {
            let mut v = [0.0; TASK];
            let mut below = 0.0;
            for i in k + 1..n {
                v[i] = self.entry[i][k];
                below += if i > k + 1 { v[i] * v[i] } else { 0.0 };
            }
            if below == 0.0 {
                continue;
            }
            let norm = libm::sqrt(below + v[k + 1] * v[k + 1]);
            let reflected = if v[k + 1] > 0.0 { -norm } else { norm };
            v[k + 1] -= reflected;
            let factor = 2.0 / (below + v[k + 1] * v[k + 1]);
            let mut w = [0.0; TASK];
            for i in k + 1..n {
                for j in k + 1..n {
                    let entry = if i >= j { self.entry[i][j] } else { self.entry[j][i] };
                    w[i] += factor * entry * v[j];
                }
            }
            let along = 0.5 * factor * w.iter().zip(&v).map(|(w, v)| w * v).sum::<f64>();
            for i in k + 1..n {
                w[i] -= along * v[i];
            }
            for i in k + 1..n {
                for j in k + 1..=i {
                    self.entry[i][j] -= v[i] * w[j] + w[i] * v[j];
                }
            }
            self.entry[k + 1][k] = reflected;
        }
    }

    /// p, p′ and p″ at x of the tridiagonal matrix.
    #[inline(always)]
    fn characteristic(&self, n: usize, x: f64) -> [f64; 3] {
        let mut before = [0.0; 3];
        let mut now = [1.0, 0.0, 0.0];
        for k in 0..n {
            let a = self.entry[k][k] - x;
            let beta = if k > 0 { self.entry[k][k - 1] } else { 0.0 };
            let b = beta * beta;
            let next = [
                a * now[0] - b * before[0],
                a * now[1] - now[0] - b * before[1],
                a * now[2] - 2.0 * now[1] - b * before[2],
            ];
            (before, now) = (now, next);
        }
        now
    }
}

#[cfg(test)]
mod tests {
    use super::{Square, TASK};
    use crate::test_arms::random;

    #[test]
    fn equations_are_solved() {
        let state = &mut 2;
        for round in 0..500 {
            let mut columns = vec![[0.0; TASK]; 1 + round % 9];
            columns.iter_mut().flatten().for_each(|entry| *entry = random(state));
            let expected: [f64; TASK] = std::array::from_fn(|_| random(state));
            // (J·Jᵀ + 0.1)·x
            let along: Vec<f64> = columns.iter().map(|column| dot(column, &expected)).collect();
            let mut x: [f64; TASK] = std::array::from_fn(|row| {
                let rows = columns.iter().zip(&along);
                0.1 * expected[row] + rows.map(|(column, along)| column[row] * along).sum::<f64>()
            });
            Square::of_rows(&columns, 0.1).solve(&mut x);
            assert!(x.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-12));
        }
    }

    fn dot(a: &[f64; TASK], b: &[f64; TASK]) -> f64 {
        a.iter().zip(b).map(|(a, b)| a * b).sum()
    }

    #[test]
    fn the_smallest_eigenvalue_is_nalgebras() {
        let state = &mut 1;
        for round in 0..2000 {
            let count = 1 + round % 8;
            let mut columns = vec![[0.0; TASK]; count];
            columns.iter_mut().flatten().for_each(|entry| *entry = random(state));
            if round % 5 == 0 {
                columns[count - 1] = columns[0];
            }
            let square = if count < TASK {
                Square::of_columns(&columns, 0.0)
            } else {
                Square::of_rows(&columns, 0.0)
            };
            let order = count.min(TASK);
            let matrix = nalgebra::DMatrix::from_fn(order, order, |i, j| square.entry[i.max(j)][i.min(j)]);
            let expected = matrix.clone().symmetric_eigenvalues().min();
            let found = square.smallest_eigenvalue();
            let tolerance = 1e-14 * matrix.trace();
            assert!((found - expected).abs() < tolerance, "{found} {expected} of {matrix}");
        }
    }
}
