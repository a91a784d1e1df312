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
    /// By what factor Q can grow, at the least, before it reaches a cap: forgetting alone makes it grow, and samples make it
    /// smaller. Below 1, it is looked at.
    pub(super) room: f64,
    pub(super) evidence: Evidence,
}

/// One sample.
#[derive(Debug, Clone, Copy)]
pub(super) struct Row<'a> {
    pub(super) psi: &'a [f64; TERMS_MAX],
    /// Torque that the terms should add up to.
    pub(super) torque: f64,
    pub(super) worth: Worth,
    /// Square of the innovation from which on it counts less (Huber), once the coefficients' errors are taken off.
    pub(super) bound: f64,
}

/// What a sample counts for; worked out once for all joints.
#[derive(Debug, Clone, Copy)]
pub(super) struct Worth {
    /// Its weight, > 0.
    weight: f64,
    /// λ, above 0 and at most 1.
    lambda: f64,
    /// Seconds that it stands for.
    pub(super) seconds: f64,
    /// 1/λ.
    growth: f64,
    /// λ/w, and w/λ.
    noise: f64,
    information: f64,
}

/// What became of a sample.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fitted {
    /// Square of its residual, of the variance of the noise whatever the estimate still lacks.
    pub(super) square: f64,
    /// It counted less, because its torque did not fit.
    pub(super) is_discounted: bool,
}

impl Worth {
    /// A sample of a weight > 0 that stands for some seconds, with λ in (0, 1].
    pub(super) fn new(weight: f64, lambda: f64, seconds: f64) -> Self {
        Self {
            weight,
            lambda,
            seconds,
            growth: 1.0 / lambda,
            noise: lambda / weight,
            information: weight / lambda,
        }
    }

    pub(super) fn weight(&self) -> f64 {
        self.weight
    }

    pub(super) fn lambda(&self) -> f64 {
        self.lambda
    }
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
            room: 0.0,
            evidence: Evidence::new(prior),
        })
    }

    /// Takes in one sample. A row that is not finite changes nothing: `None`.
    #[inline(always)]
    pub(super) fn update(&mut self, row: &Row<'_>) -> Option<Fitted> {
        match self.count {
            2 => self.step::<2>(row),
            3 => self.step::<3>(row),
            4 => self.step::<4>(row),
            _ => self.step::<5>(row),
        }
    }

    #[inline(always)]
    fn step<const N: usize>(&mut self, row: &Row<'_>) -> Option<Fitted> {
        let Worth {
            weight,
            lambda,
            growth,
            mut noise,
            mut information,
            ..
        } = row.worth;
        let (mut predicted, mut length) = (0.0, 0.0);
        for index in 0..N {
            predicted += row.psi[index] * self.coefficients[index];
            length += row.psi[index] * row.psi[index];
        }
        let innovation = row.torque - predicted;
        let square = innovation * innovation;
        // sums that overflow are refused with the rest
        if !(square + length + noise).is_finite() || noise <= 0.0 {
            return None;
        }
        let mut discount = 1.0;
        if square > row.bound {
            discount = self.discount::<N>(row, square);
            noise /= discount;
            information *= discount;
        }
        let gain = self.factor.measure::<N>(row.psi, noise, information);
        for index in 0..N {
            self.coefficients[index] += gain.gain[index] * innovation;
        }
        let fitting = 1.0 / (1.0 + gain.spread * growth);
        self.factor.grow::<N>(growth);
        self.evidence.add::<N>(
            row.psi,
            weight * discount,
            lambda,
            row.worth.seconds,
            innovation * fitting,
        );
        self.room *= lambda;
        if self.room < 1.0 {
            self.bound::<N>();
        }
        Some(Fitted {
            square: square * fitting,
            is_discounted: discount < 1.0,
        })
    }

    /// Huber's weight: 1, or less where the torque is further off than the noise and the coefficients' errors explain.
    #[cold]
    fn discount<const N: usize>(&self, row: &Row<'_>, square: f64) -> f64 {
        let bound = row.bound * (1.0 + self.factor.spread(N, row.psi));
        libm::sqrt(bound / square).min(1.0)
    }

    /// Holds Q below its caps. It goes to half a cap, so that it is seldom done.
    #[cold]
    fn bound<const N: usize>(&mut self) {
        self.room = f64::INFINITY;
        for index in 0..N {
            if self.factor.variance(N, index) > self.caps[index] {
                self.bound_one::<N>(index);
            }
            // what is added at another coefficient later takes from this one too
            self.room = self.room.min(self.caps[index] / self.factor.variance(N, index));
        }
    }

    #[cold]
    fn bound_one<const N: usize>(&mut self, index: usize) {
        let column = self.factor.column(N, index);
        let (variance, target) = (column[index], 0.5 * self.caps[index]);
        let information = 1.0 / target - 1.0 / variance;
        let mut unit = [0.0; TERMS_MAX];
        unit[index] = 1.0;
        self.factor.measure::<N>(&unit, 1.0 / information, information);
        self.evidence.told::<N>(index, &column, information);
    }
}

#[cfg(test)]
mod tests;
