//! Recursive least squares with forgetting ("controlling a robot arm based on adaptive friction", eq 15 to 20), with a
//! prior, and with a weight w a sample:
//!
//! ```text
//! minimise  λⁿ·(f − f₀)ᵀ·Q₀⁻¹·(f − f₀) + Σ λⁿ⁻ᵏ·wₖ·(yₖ − ψₖ·f)²
//!
//! ε = y − ψ·f ;  L = Q·ψᵀ/(λ/w + ψ·Q·ψᵀ) ;  f ← f + L·ε ;  Q ← (Q − L·ψ·Q)/λ
//! ```
//!
//! Q is kept as U·D·Uᵀ, so that it stays symmetric and positive for ever. It is bounded: where a motion says nothing of a
//! coefficient, forgetting would make its variance grow for ever; above a cap, information is added at the present estimate,
//! which therefore does not move.
//!
//! What Q means is left to [`super::evidence`]: the covariance of f is not Q times a variance where residuals correlate.

use super::evidence::Evidence;
use super::factor::UnitFactor;
use super::law::{TERMS_MAX, TRIANGLE};

/// The state of one recursion.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct LeastSquares {
    /// How many terms there are: 2 to [`TERMS_MAX`].
    pub(super) count: usize,
    pub(super) coefficients: [f64; TERMS_MAX],
    pub(super) factor: UnitFactor,
    /// Largest entries of Q's diagonal.
    pub(super) caps: [f64; TERMS_MAX],
    pub(super) evidence: Evidence,
}

/// One sample.
#[derive(Debug, Clone, Copy)]
pub(super) struct Row<'a> {
    pub(super) psi: &'a [f64; TERMS_MAX],
    /// Torque that the terms should add up to.
    pub(super) torque: f64,
    /// Its weight, > 0.
    pub(super) weight: f64,
    /// λ, above 0 and at most 1.
    pub(super) lambda: f64,
    /// Seconds that it stands for.
    pub(super) seconds: f64,
}

impl LeastSquares {
    /// Begins at a prior: coefficients, and their covariance over the variance `noise` of a sample of weight 1. `None` where the
    /// covariance is none.
    pub(super) fn new(
        count: usize,
        mean: &[f64; TERMS_MAX],
        covariance: &[f64; TRIANGLE],
        noise: f64,
        caps: [f64; TERMS_MAX],
    ) -> Option<Self> {
        let mut scaled = *covariance;
        for value in &mut scaled {
            *value /= noise;
        }
        let factor = UnitFactor::of(count, &scaled)?;
        let mut caps = caps;
        for (index, cap) in caps.iter_mut().enumerate().take(count) {
            *cap = cap.max(factor.variance(count, index));
        }
        let mut prior = factor.inverse(count);
        for value in &mut prior {
            *value *= noise;
        }
        Some(Self {
            count,
            coefficients: *mean,
            factor,
            caps,
            evidence: Evidence::new(prior),
        })
    }

    /// Torque that the terms add up to.
    #[inline(always)]
    pub(super) fn predicted(&self, psi: &[f64; TERMS_MAX]) -> f64 {
        let mut sum = 0.0;
        for index in 0..TERMS_MAX {
            sum += psi[index] * self.coefficients[index];
        }
        sum
    }

    /// Takes in one sample. Returns its residual, of the variance of the noise whatever the estimate still lacks. A row that is
    /// not finite changes nothing and has none.
    #[inline]
    pub(super) fn update(&mut self, row: &Row<'_>) -> Option<f64> {
        match self.count {
            2 => self.step::<2>(row),
            3 => self.step::<3>(row),
            4 => self.step::<4>(row),
            _ => self.step::<5>(row),
        }
    }

    #[inline(always)]
    fn step<const N: usize>(&mut self, row: &Row<'_>) -> Option<f64> {
        let innovation = row.torque - self.predicted(row.psi);
        let noise = row.lambda / row.weight;
        // sums that overflow are refused with the rest
        let checked = innovation * innovation + noise + row.psi.iter().map(|psi| psi * psi).sum::<f64>();
        if !checked.is_finite() || noise.is_nan() || noise <= 0.0 {
            return None;
        }
        let gain = self.factor.measure::<N>(row.psi, noise);
        for index in 0..N {
            self.coefficients[index] += gain.gain[index] * innovation;
        }
        let total = 1.0 + gain.spread / row.lambda;
        let residual = innovation / libm::sqrt(total);
        self.factor.forget::<N>(row.lambda);
        self.evidence.add::<N>(row, residual, innovation / total);
        if row.lambda < 1.0 {
            self.bound::<N>();
        }
        Some(residual)
    }

    /// Holds Q below its caps. It goes to half a cap, so that it is seldom done.
    #[inline(always)]
    fn bound<const N: usize>(&mut self) {
        for index in 0..N {
            if self.factor.variance(N, index) > self.caps[index] {
                self.bound_one::<N>(index);
            }
        }
    }

    #[cold]
    fn bound_one<const N: usize>(&mut self, index: usize) {
        let column = self.factor.column(N, index);
        let (variance, target) = (column[index], 0.5 * self.caps[index]);
        let information = 1.0 / target - 1.0 / variance;
        let mut unit = [0.0; TERMS_MAX];
        unit[index] = 1.0;
        self.factor.measure::<N>(&unit, 1.0 / information);
        self.evidence.told::<N>(index, &column, information);
    }
}

#[cfg(test)]
mod tests;
