//! A quantity along a motion with its first two derivatives in time, carried through arithmetic exactly: truncated Taylor series
//! (Griewank and Walther 2008, chapter 13). With it the kernel of inverse dynamics has torque rates without differences.

use std::ops::{Add, Mul, Sub};

use crate::scalar::Real;

/// Taylor coefficients at some time: f, ḟ, f̈/2.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Series(pub(crate) [f64; 3]);

impl Series {
    pub(crate) const ZERO: Self = Self([0.0; 3]);

    /// From a value and its derivatives.
    pub(crate) fn of_derivatives([f, f1, f2]: [f64; 3]) -> Self {
        Self([f, f1, 0.5 * f2])
    }

    /// f, ḟ, f̈.
    pub(crate) fn derivatives(self) -> [f64; 3] {
        let [f, f1, half] = self.0;
        [f, f1, 2.0 * half]
    }

    /// g∘f for a g with the given value and derivatives at f.
    pub(crate) fn compose(self, [g, g1, g2]: [f64; 3]) -> Self {
        let [_, a, b] = self.0;
        Self([g, g1 * a, g1 * b + 0.5 * g2 * a * a])
    }
}

impl Real for Series {
    fn splat(self, constant: f64) -> Self {
        Self([constant, 0.0, 0.0])
    }

    fn select_below(self, bound: f64, yes: Self, no: Self) -> Self {
        if self.0[0] < bound { yes } else { no }
    }

    fn sine_cosine(self) -> (Self, Self) {
        let (sin, cos) = self.0[0].sine_cosine();
        (self.compose([sin, cos, -sin]), self.compose([cos, -sin, -cos]))
    }
}

impl Add for Series {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        Self([a + x, b + y, c + z])
    }
}

impl Sub for Series {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        Self([a - x, b - y, c - z])
    }
}

impl Mul for Series {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        Self([a * x, a * y + b * x, a * z + b * y + c * x])
    }
}

impl Add<f64> for Series {
    type Output = Self;

    fn add(self, constant: f64) -> Self {
        let [a, b, c] = self.0;
        Self([a + constant, b, c])
    }
}

impl Mul<f64> for Series {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        Self(self.0.map(|coefficient| coefficient * factor))
    }
}
