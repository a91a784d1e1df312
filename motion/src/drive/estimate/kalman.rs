//! A Kalman filter for coefficients that wander at random (Kalman 1960; Joseph's form: Bucy and Joseph 1968):
//!
//! ```text
//! f(t + Δ) = f(t) + N(0, W·Δ)            y = ψ·f + N(0, R)
//! P ← P + W·Δ ;  S = ψ·P·ψᵀ + R ;  K = P·ψᵀ/S ;  f ← f + K·(y − ψ·f)
//! P ← (I − K·ψ)·P·(I − K·ψ)ᵀ + K·R·Kᵀ = M + (K·R − M·ψᵀ)·Kᵀ        M = P − K·(P·ψᵀ)ᵀ
//! ```
//!
//! R is the residual's variance over the weight of a sample, so that samples which are alike do not count as new ones. A sample whose
//! innovation is beyond the gate is not taken. P is what the filter's assumptions say: unlike least squares it does not
//! look at how its residuals turn out to correlate.

use super::factor::lower;
use super::law::{TERMS_MAX, TRIANGLE};

/// State of one filter.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Kalman {
    pub(super) count: usize,
    pub(super) coefficients: [f64; TERMS_MAX],
    /// P: its lower triangle.
    pub(super) covariance: [f64; TRIANGLE],
    /// W: its diagonal, per second.
    pub(super) drift: [f64; TERMS_MAX],
    /// Variances that P does not grow beyond.
    pub(super) caps: [f64; TERMS_MAX],
}

/// One sample.
#[derive(Debug, Clone, Copy)]
pub(super) struct Measurement<'a> {
    pub(super) psi: &'a [f64; TERMS_MAX],
    /// Torque that the terms should add up to.
    pub(super) torque: f64,
    /// Of its noise.
    pub(super) variance: f64,
    /// How much of a new sample it is.
    pub(super) weight: f64,
    /// How many standard deviations an innovation may have.
    pub(super) gate: Option<f64>,
}

/// What became of a sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Taken {
    /// It was used; the square of its residual, of the variance of the noise whatever the estimate still lacks.
    Used(f64),
    /// Its innovation was beyond the gate; the square of its residual.
    Outlier(f64),
    /// It was not finite: nothing changed.
    NotFinite,
}

impl Kalman {
    /// Lets time pass.
    #[inline(always)]
    pub(super) fn wander(&mut self, seconds: f64) {
        for index in 0..TERMS_MAX {
            let (variance, cap) = (&mut self.covariance[lower(index, index)], self.caps[index]);
            // stored in any case, which is faster than to ask whether
            *variance = if *variance < cap {
                (*variance + self.drift[index] * seconds).min(cap)
            } else {
                *variance
            };
        }
    }

    /// Takes in a sample.
    #[inline(always)]
    pub(super) fn update(&mut self, sample: &Measurement<'_>) -> Taken {
        match self.count {
            2 => self.step::<2>(sample),
            3 => self.step::<3>(sample),
            4 => self.step::<4>(sample),
            _ => self.step::<5>(sample),
        }
    }

    #[inline(always)]
    #[allow(
        clippy::needless_range_loop,
        reason = "rows and columns by their index, as in the formulas"
    )]
    fn step<const N: usize>(&mut self, sample: &Measurement<'_>) -> Taken {
        let &Measurement {
            psi,
            torque,
            variance,
            weight,
            gate,
        } = sample;
        let noise = variance / weight;
        // P with both of its triangles, by columns: nothing is shuffled where a column goes at once
        let mut matrix = [[0.0; N]; N];
        for column in 0..N {
            for row in 0..N {
                matrix[column][row] = self.covariance[lower(row, column)];
            }
        }
        let mut product = [0.0; N];
        for column in 0..N {
            for row in 0..N {
                product[row] += matrix[column][row] * psi[column];
            }
        }
        let (mut spread, mut predicted) = (0.0, 0.0);
        for row in 0..N {
            predicted += psi[row] * self.coefficients[row];
            spread += psi[row] * product[row];
        }
        let innovation = torque - predicted;
        let square = innovation * innovation;
        let total = spread + noise;
        if !(square + total).is_finite() || total <= 0.0 {
            return Taken::NotFinite;
        }
        let expected = spread + variance;
        let residual = square * (variance / expected);
        if gate.is_some_and(|gate| square > gate * gate * expected) {
            return Taken::Outlier(residual);
        }
        let mut gain = [0.0; N];
        let inverse = 1.0 / total;
        for row in 0..N {
            gain[row] = product[row] * inverse;
            self.coefficients[row] += gain[row] * innovation;
        }
        // M, and K·R − M·ψᵀ
        let mut excess = gain.map(|gain| gain * noise);
        for column in 0..N {
            for row in 0..N {
                matrix[column][row] -= gain[row] * product[column];
                excess[row] -= matrix[column][row] * psi[column];
            }
        }
        for column in 0..N {
            for row in 0..N {
                matrix[column][row] += excess[row] * gain[column];
            }
        }
        for row in 0..N {
            for column in 0..=row {
                self.covariance[lower(row, column)] = matrix[column][row];
            }
        }
        Taken::Used(residual)
    }
}

#[cfg(test)]
mod tests;
