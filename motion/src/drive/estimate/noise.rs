//! Noise for the tests: normal, heavy-tailed, and correlated in time, the same in every run.

use std::f64::consts::TAU;

use crate::test_arms::random;

/// A standard normal number (Box and Muller 1958).
pub(super) fn normal(state: &mut u64) -> f64 {
    let uniform = 0.5 * (1.0 + random(state)) + f64::EPSILON;
    libm::sqrt(-2.0 * libm::log(uniform)) * libm::cos(TAU * random(state))
}

/// A number of Student's distribution (whole degrees of freedom).
pub(super) fn student(degrees_of_freedom: f64, state: &mut u64) -> f64 {
    let count = degrees_of_freedom as usize;
    let squares: f64 = (0..count).map(|_| normal(state)).map(|z| z * z).sum();
    normal(state) / libm::sqrt(squares / degrees_of_freedom)
}

/// Noise of standard deviation 1 that stays alike for a time: x ← e·x + √(1 − e²)·z, e = exp(−Δ/τ).
pub(super) struct Correlated {
    value: f64,
    kept: f64,
    /// Degrees of freedom of z's tails; `None`: normal.
    tails: Option<f64>,
}

impl Correlated {
    pub(super) fn new(seconds: f64, correlation_time: f64, tails: Option<f64>, state: &mut u64) -> Self {
        let mut noise = Self {
            value: 0.0,
            kept: libm::exp(-seconds / correlation_time),
            tails,
        };
        noise.value = noise.draw(state);
        noise
    }

    fn draw(&self, state: &mut u64) -> f64 {
        match self.tails {
            // Student's variance is ν/(ν − 2)
            Some(tails) => student(tails, state) * libm::sqrt((tails - 2.0) / tails),
            None => normal(state),
        }
    }

    pub(super) fn next(&mut self, state: &mut u64) -> f64 {
        self.value = self.kept * self.value + libm::sqrt(1.0 - self.kept * self.kept) * self.draw(state);
        self.value
    }
}
