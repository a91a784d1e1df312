//! Linear equations whose matrix is a band: Gaussian elimination with partial pivoting (Golub and Van Loan 2013,
//! section 4.3.3), all right-hand sides at once.

/// A square band matrix with as many diagonals below the main one as above it, and its right-hand sides.
#[derive(Debug, Clone)]
pub(super) struct Band {
    size: usize,
    /// Diagonals on each side.
    width: usize,
    /// By row, from column row − width on; pivoting needs twice the diagonals above.
    rows: Vec<f64>,
    sides: usize,
    right: Vec<f64>,
}

impl Band {
    pub(super) fn new(size: usize, width: usize, sides: usize) -> Self {
        Self {
            size,
            width,
            rows: vec![0.0; size * (3 * width + 1)],
            sides,
            right: vec![0.0; size * sides],
        }
    }

    fn index(&self, row: usize, column: usize) -> usize {
        row * (3 * self.width + 1) + column + self.width - row
    }

    /// Adds to one entry of the matrix.
    pub(super) fn add(&mut self, row: usize, column: usize, value: f64) {
        let index = self.index(row, column);
        self.rows[index] += value;
    }

    /// Adds to one right-hand side.
    pub(super) fn add_right(&mut self, row: usize, side: usize, value: f64) {
        self.right[row * self.sides + side] += value;
    }

    /// The unknowns, by row and side. A singular matrix gives values that are not finite.
    pub(super) fn solve(mut self) -> Vec<f64> {
        for k in 0..self.size {
            let last = (k + self.width).min(self.size - 1);
            let end = (k + 2 * self.width).min(self.size - 1);
            let size = |row: usize| self.rows[self.index(row, k)].abs();
            let pivot = (k..=last).fold(k, |best, row| if size(row) > size(best) { row } else { best });
            self.swap(k, pivot, end);
            let diagonal = self.rows[self.index(k, k)];
            for row in k + 1..=last {
                let factor = self.rows[self.index(row, k)] / diagonal;
                if factor == 0.0 {
                    continue;
                }
                for column in k..=end {
                    let (from, to) = (self.index(k, column), self.index(row, column));
                    self.rows[to] -= factor * self.rows[from];
                }
                for side in 0..self.sides {
                    self.right[row * self.sides + side] -= factor * self.right[k * self.sides + side];
                }
            }
        }
        for k in (0..self.size).rev() {
            let end = (k + 2 * self.width).min(self.size - 1);
            for side in 0..self.sides {
                let mut value = self.right[k * self.sides + side];
                for column in k + 1..=end {
                    value -= self.rows[self.index(k, column)] * self.right[column * self.sides + side];
                }
                self.right[k * self.sides + side] = value / self.rows[self.index(k, k)];
            }
        }
        self.right
    }

    fn swap(&mut self, one: usize, other: usize, end: usize) {
        if one == other {
            return;
        }
        for column in one..=end {
            let (a, b) = (self.index(one, column), self.index(other, column));
            self.rows.swap(a, b);
        }
        for side in 0..self.sides {
            self.right.swap(one * self.sides + side, other * self.sides + side);
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use super::*;
    use crate::test_arms::random;

    #[test]
    fn agrees_with_a_dense_decomposition() {
        let state = &mut 12;
        for size in [1, 2, 3, 5, 8, 21] {
            for width in [1, 2, 3] {
                let mut band = Band::new(size, width, 2);
                let mut dense = DMatrix::zeros(size, size);
                let mut right = [DVector::zeros(size), DVector::zeros(size)];
                for row in 0..size {
                    for column in row.saturating_sub(width)..(row + width + 1).min(size) {
                        // a small diagonal: rows must be exchanged
                        let value = random(state) * if row == column { 1e-3 } else { 1.0 };
                        band.add(row, column, value);
                        dense[(row, column)] = value;
                    }
                    for (side, right) in right.iter_mut().enumerate() {
                        right[row] = random(state);
                        band.add_right(row, side, right[row]);
                    }
                }
                let lu = dense.full_piv_lu();
                let got = band.solve();
                for (side, right) in right.iter().enumerate() {
                    let expected = lu.solve(right).unwrap();
                    for row in 0..size {
                        let error = (got[row * 2 + side] - expected[row]).abs();
                        assert!(error < 1e-9 * (1.0 + expected.norm()), "{size} {width} {error}");
                    }
                }
            }
        }
    }
}
