//! Symmetric matrices of up to six rows, in place: JᵀJ + λ·I, J·Jᵀ + λ·I.

use crate::tolerance::{IK_EIGEN_ROUNDING, IK_JACOBI_SWEEPS};

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

    /// The smallest eigenvalue, by Jacobi's rotations.
    pub(super) fn smallest_eigenvalue(mut self) -> f64 {
        let n = self.order;
        let a = &mut self.entry;
        for i in 0..n {
            for j in 0..i {
                a[j][i] = a[i][j];
            }
        }
        for _ in 0..IK_JACOBI_SWEEPS {
            let mut off = 0.0;
            for p in 0..n {
                for q in p + 1..n {
                    off += a[p][q] * a[p][q];
                    rotate(a, n, p, q);
                }
            }
            let trace: f64 = (0..n).map(|i| a[i][i]).sum();
            if off <= (IK_EIGEN_ROUNDING * trace) * (IK_EIGEN_ROUNDING * trace) {
                break;
            }
        }
        (0..n).map(|i| a[i][i]).fold(f64::INFINITY, f64::min)
    }
}

/// Makes entry (p, q) 0: t² + 2·t·θ = 1 with θ = (a_qq − a_pp)/(2·a_pq), the smaller root.
fn rotate(a: &mut [[f64; TASK]; TASK], n: usize, p: usize, q: usize) {
    if a[p][q] == 0.0 {
        return;
    }
    let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
    let root = theta.abs() + libm::sqrt(theta * theta + 1.0);
    let t = if theta < 0.0 { -1.0 / root } else { 1.0 / root };
    let c = 1.0 / libm::sqrt(t * t + 1.0);
    let s = t * c;
    for row in a.iter_mut().take(n) {
        let (x, y) = (row[p], row[q]);
        row[p] = c * x - s * y;
        row[q] = s * x + c * y;
    }
    for k in 0..n {
        let (x, y) = (a[p][k], a[q][k]);
        a[p][k] = c * x - s * y;
        a[q][k] = s * x + c * y;
    }
}
