//! A symmetric positive definite matrix with three diagonals beside the main one: L·D·Lᵀ in place, without pivoting
//! (Golub and Van Loan 2013, section 4.3.6).

use crate::tolerance::PIVOT_FLOOR;

/// Row `i` holds the entries (i, i), (i, i+1), (i, i+2), (i, i+3), 0 beyond the last column; after
/// [`Band::factorize`] the pivot and the multipliers of L's column `i`.
#[derive(Debug, Default)]
pub(crate) struct Band {
    pub(crate) rows: Vec<[f64; 4]>,
}

impl Band {
    /// All entries 0.
    pub(crate) fn clear(&mut self, size: usize) {
        self.rows.clear();
        self.rows.resize(size, [0.0; 4]);
    }

    /// Makes unknown `i` whatever the right side says, apart from the others; before [`Band::factorize`].
    pub(crate) fn hold(&mut self, i: usize) {
        self.rows[i] = [1.0, 0.0, 0.0, 0.0];
        for above in 1..=i.min(3) {
            self.rows[i - above][above] = 0.0;
        }
    }

    pub(crate) fn factorize(&mut self) {
        let size = self.rows.len();
        for i in 0..size {
            let [pivot, e1, e2, e3] = self.rows[i];
            let pivot = pivot.max(PIVOT_FLOOR);
            let inverse = 1.0 / pivot;
            let [l1, l2, l3] = [e1 * inverse, e2 * inverse, e3 * inverse];
            if let Some([first, rest @ ..]) = self.rows.get_mut(i + 1..) {
                first[0] -= l1 * e1;
                first[1] -= l1 * e2;
                first[2] -= l1 * e3;
                if let [second, rest @ ..] = rest {
                    second[0] -= l2 * e2;
                    second[1] -= l2 * e3;
                    if let [third, ..] = rest {
                        third[0] -= l3 * e3;
                    }
                }
            }
            self.rows[i] = [pivot, l1, l2, l3];
        }
    }

    /// Solves for the right side `x`, in place; after [`Band::factorize`].
    pub(crate) fn solve(&self, x: &mut [f64]) {
        // the last three values of y, nearest first: in registers rather than read back
        let [mut y1, mut y2, mut y3] = [0.0; 3];
        let [mut l1, mut l2, mut l3] = [[0.0; 4]; 3];
        for (x, row) in x.iter_mut().zip(&self.rows) {
            let y = *x - l3[3] * y3 - l2[2] * y2 - l1[1] * y1;
            *x = y;
            (y3, y2, y1) = (y2, y1, y);
            (l3, l2, l1) = (l2, l1, *row);
        }
        [y1, y2, y3] = [0.0; 3];
        for (x, [pivot, l1, l2, l3]) in x.iter_mut().zip(&self.rows).rev() {
            let y = *x / pivot - l3 * y3 - l2 * y2 - l1 * y1;
            *x = y;
            (y3, y2, y1) = (y2, y1, y);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_arms::random;

    /// A = Σ vᵢ·vᵢᵀ + diagonal with random windows vᵢ of four entries: A·x = b, b from a known x.
    #[test]
    fn solves_what_it_was_made_from() {
        let state = &mut 3;
        for size in [1, 2, 3, 4, 5, 40] {
            let mut band = Band::default();
            band.clear(size);
            for i in 0..size {
                let window: [f64; 4] = std::array::from_fn(|_| random(state));
                for r in 0..4.min(size - i) {
                    for m in 0..4.min(size - i) - r {
                        band.rows[i + r][m] += window[r] * window[r + m];
                    }
                }
                band.rows[i][0] += 0.1;
            }
            let expected: Vec<f64> = (0..size).map(|_| random(state)).collect();
            let mut x = vec![0.0; size];
            for i in 0..size {
                for m in 0..4.min(size - i) {
                    x[i] += band.rows[i][m] * expected[i + m];
                    if m > 0 {
                        x[i + m] += band.rows[i][m] * expected[i];
                    }
                }
            }
            band.factorize();
            band.solve(&mut x);
            for (got, expected) in x.iter().zip(&expected) {
                assert!((got - expected).abs() < 1e-10, "{size}: {got} {expected}");
            }
        }
    }
}
