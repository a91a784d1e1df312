//! How large residuals are, with and without their outliers, over the last seconds of motion.
//!
//! ```text
//! s² ← s² + a·(min(r², c²·s²)/κ − s²)        κ = E min(z², c²) for a normal z
//! ```
//!
//! is the variance of a normal residual, and hardly hears of outliers (Huber 1981, 5.2); second and fourth moments are
//! kept beside it as they are. a is 1/n for the first n samples and then the time constant's.

use crate::tolerance::ESTIMATE_SPREAD_SECONDS;

/// Standard deviations beyond which a residual counts as if it were there.
const CLIP: f64 = 3.0;

/// κ for that c: (2Φ(c) − 1) − 2c·φ(c) + 2c²·(1 − Φ(c)).
const CLIPPED_VARIANCE: f64 = 0.995_005_772_219_265;

/// Samples that the assumed deviation counts as.
const ASSUMED: f64 = 10.0;

/// Kurtosis from which on the tails are as heavy as any that are told apart.
const KURTOSIS_MAX: f64 = 100.0;

/// Moments of residuals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Spread {
    /// Without outliers.
    pub(super) robust: f64,
    /// E r².
    pub(super) second: f64,
    /// E r⁴.
    pub(super) fourth: f64,
    /// Samples, up to as many as are remembered.
    pub(super) samples: f64,
}

impl Spread {
    /// Begins at an assumed standard deviation.
    pub(super) fn new(deviation: f64) -> Self {
        let variance = deviation * deviation;
        Self {
            robust: variance,
            second: variance,
            fourth: 3.0 * variance * variance,
            samples: ASSUMED,
        }
    }

    /// Takes in the square of a residual that stands for some seconds.
    #[inline(always)]
    pub(super) fn add(&mut self, square: f64, seconds: f64) {
        self.samples += 1.0;
        let mut share = (seconds * (1.0 / ESTIMATE_SPREAD_SECONDS)).min(1.0);
        if share * self.samples < 1.0 {
            share = 1.0 / self.samples;
        }
        let clipped = square.min(CLIP * CLIP * self.robust) * (1.0 / CLIPPED_VARIANCE);
        self.robust += share * (clipped - self.robust);
        self.second += share * (square - self.second);
        self.fourth += share * (square * square - self.fourth);
    }

    /// Degrees of freedom of Student's distribution with this kurtosis, 3 + 6/(ν − 4).
    pub(super) fn tails(&self) -> f64 {
        let excess = (self.fourth / (self.second * self.second)).min(KURTOSIS_MAX) - 3.0;
        // a kurtosis is known to within some tenths: below that a tail is normal
        if excess > 0.1 { 4.0 + 6.0 / excess } else { 64.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drive::estimate::noise::{normal, student};

    #[test]
    fn the_clipped_variance_of_normal_residuals_is_their_variance() {
        let state = &mut 5;
        let mut spread = Spread::new(30.0);
        for _ in 0..200_000 {
            let residual = 2.0 * normal(state);
            spread.add(residual * residual, 1e-3);
        }
        // 10,000 samples are remembered: 0.7 %
        assert!((spread.robust.sqrt() - 2.0).abs() < 0.06, "{}", spread.robust);
        assert!((spread.second.sqrt() - 2.0).abs() < 0.06);
        assert!(spread.tails() > 20.0, "{}", spread.tails());
    }

    #[test]
    fn outliers_hardly_move_it_and_show_in_the_tails() {
        let state = &mut 6;
        let mut spread = Spread::new(1.0);
        for index in 0..100_000 {
            let residual = if index % 100 == 0 { 50.0 } else { normal(state) };
            spread.add(residual * residual, 1e-4);
        }
        assert!(spread.robust.sqrt() < 1.1, "{}", spread.robust);
        assert!(spread.second.sqrt() > 4.0);
        let mut spread = Spread::new(1.0);
        for _ in 0..100_000 {
            let residual = student(6.0, state);
            spread.add(residual * residual, 1e-4);
        }
        assert!((4.2..12.0).contains(&spread.tails()), "{}", spread.tails());
    }
}
