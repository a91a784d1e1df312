//! Normal equations of a fit, kept apart by stretch of time and joint, so that weights and stretches can be chosen later.

use super::design::{Design, Rows};
use super::linear::dot;
use super::signals::Signals;
use crate::budget::{Budget, Stopped};

/// XᵀX and Xᵀy of one joint over one stretch.
#[derive(Debug, Clone)]
pub(crate) struct Gram {
    pub(crate) matrix: Vec<f64>,
    pub(crate) product: Vec<f64>,
}

/// The stretches of a fit, and the normal equations of each.
#[derive(Debug, Clone)]
pub(crate) struct Normal {
    /// First sample of each stretch and the one after its last.
    pub(crate) stretches: Vec<(usize, usize)>,
    /// By stretch, then by joint.
    pub(crate) grams: Vec<Vec<Gram>>,
    /// Unknowns of each joint's columns.
    unknowns: Vec<Vec<usize>>,
    /// How many unknowns there are.
    count: usize,
}

impl Normal {
    pub(crate) fn new(
        design: &Design,
        signals: &Signals,
        stretch_count: usize,
        unknown_count: usize,
        budget: &Budget<'_>,
    ) -> Result<Self, Stopped> {
        let (from, to) = signals.selected;
        let border = |k: usize| from + (to - from) * k / stretch_count;
        let stretches: Vec<(usize, usize)> = (0..stretch_count).map(|k| (border(k), border(k + 1))).collect();
        let mut grams = Vec::with_capacity(stretch_count);
        for stretch in &stretches {
            let mut of_stretch = Vec::with_capacity(design.rows.len());
            for rows in &design.rows {
                of_stretch.push(Gram::new(rows, *stretch, budget)?);
            }
            grams.push(of_stretch);
        }
        Ok(Self {
            stretches,
            grams,
            unknowns: design.rows.iter().map(|rows| rows.unknowns.clone()).collect(),
            count: unknown_count,
        })
    }

    /// Σ w·XᵀX and Σ w·Xᵀy over the joints and all stretches but one.
    pub(crate) fn sum(&self, weights: &[f64], left_out: Option<usize>) -> (Vec<f64>, Vec<f64>) {
        let n = self.count;
        let (mut matrix, mut product) = (vec![0.0; n * n], vec![0.0; n]);
        for (k, of_stretch) in self.grams.iter().enumerate() {
            if Some(k) == left_out {
                continue;
            }
            for ((gram, unknowns), weight) in of_stretch.iter().zip(&self.unknowns).zip(weights) {
                let width = unknowns.len();
                for (a, row) in unknowns.iter().enumerate() {
                    product[*row] += weight * gram.product[a];
                    for (b, column) in unknowns.iter().enumerate() {
                        matrix[row * n + column] += weight * gram.matrix[a * width + b];
                    }
                }
            }
        }
        (matrix, product)
    }

    /// Takes in new columns of one joint.
    pub(crate) fn update(&mut self, rows: &Rows, joint: usize, budget: &Budget<'_>) -> Result<(), Stopped> {
        for (stretch, grams) in self.stretches.iter().zip(&mut self.grams) {
            grams[joint] = Gram::new(rows, *stretch, budget)?;
        }
        Ok(())
    }

    /// The equations of one joint alone, over all stretches.
    pub(crate) fn of_joint(&self, joint: usize) -> Gram {
        let mut whole = self.grams[0][joint].clone();
        for of_stretch in &self.grams[1..] {
            let gram = &of_stretch[joint];
            whole.matrix.iter_mut().zip(&gram.matrix).for_each(|(a, b)| *a += b);
            whole.product.iter_mut().zip(&gram.product).for_each(|(a, b)| *a += b);
        }
        whole
    }
}

impl Gram {
    pub(crate) fn new(rows: &Rows, (from, to): (usize, usize), budget: &Budget<'_>) -> Result<Self, Stopped> {
        let width = rows.columns.len();
        let mut matrix = vec![0.0; width * width];
        let mut product = Vec::with_capacity(width);
        let target = &rows.target[from..to];
        for (a, column) in rows.columns.iter().enumerate() {
            budget.check()?;
            let column = &column[from..to];
            product.push(dot(column, target));
            for (b, other) in rows.columns[..=a].iter().enumerate() {
                let value = dot(column, &other[from..to]);
                matrix[a * width + b] = value;
                matrix[b * width + a] = value;
            }
        }
        Ok(Self { matrix, product })
    }
}
