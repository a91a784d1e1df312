//! A quantity along a path with its first three derivatives, carried through arithmetic exactly: truncated Taylor series
//! (Griewank and Walther 2008, chapter 13).

use std::ops::{Add, Mul, Neg, Sub};

/// Taylor coefficients of f at some s: f, f′, f″/2, f‴/6.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Jet(pub(crate) [f64; 4]);

impl Jet {
    /// What does not change along the path.
    pub(crate) const fn constant(value: f64) -> Self {
        Self([value, 0.0, 0.0, 0.0])
    }

    /// The path parameter itself, times `rate`.
    pub(crate) const fn variable(value: f64, rate: f64) -> Self {
        Self([value, rate, 0.0, 0.0])
    }

    /// From a value and its derivatives.
    pub(crate) fn of_derivatives([f, f1, f2, f3]: [f64; 4]) -> Self {
        Self([f, f1, f2 / 2.0, f3 / 6.0])
    }

    /// f, f′, f″, f‴.
    pub(crate) fn derivatives(self) -> [f64; 4] {
        let [f, f1, f2, f3] = self.0;
        [f, f1, 2.0 * f2, 6.0 * f3]
    }

    pub(crate) fn value(self) -> f64 {
        self.0[0]
    }

    /// g∘f for a g with the given value and derivatives at f.
    pub(crate) fn compose(self, [g, g1, g2, g3]: [f64; 4]) -> Self {
        let [_, a, b, c] = self.0;
        Self([
            g,
            g1 * a,
            g1 * b + 0.5 * g2 * a * a,
            g1 * c + g2 * a * b + g3 / 6.0 * a * a * a,
        ])
    }

    pub(crate) fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = (libm::sin(self.value()), libm::cos(self.value()));
        (
            self.compose([sin, cos, -sin, -cos]),
            self.compose([cos, -sin, -cos, sin]),
        )
    }

    /// 1/f; f must not be 0.
    pub(crate) fn recip(self) -> Self {
        let r = 1.0 / self.value();
        let (r2, r3) = (r * r, r * r * r);
        self.compose([r, -r2, 2.0 * r3, -6.0 * r3 * r])
    }

    /// √f; f must be positive.
    pub(crate) fn sqrt(self) -> Self {
        let root = self.value().sqrt();
        let r = 1.0 / self.value();
        self.compose([root, 0.5 * root * r, -0.25 * root * r * r, 0.375 * root * r * r * r])
    }
}

impl Add for Jet {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self(std::array::from_fn(|k| self.0[k] + other.0[k]))
    }
}

impl Sub for Jet {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self(std::array::from_fn(|k| self.0[k] - other.0[k]))
    }
}

impl Neg for Jet {
    type Output = Self;

    fn neg(self) -> Self {
        Self(self.0.map(|c| -c))
    }
}

impl Mul for Jet {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let (a, b) = (self.0, other.0);
        Self([
            a[0] * b[0],
            a[0] * b[1] + a[1] * b[0],
            a[0] * b[2] + a[1] * b[1] + a[2] * b[0],
            a[0] * b[3] + a[1] * b[2] + a[2] * b[1] + a[3] * b[0],
        ])
    }
}

impl Mul<f64> for Jet {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        Self(self.0.map(|c| c * factor))
    }
}

impl Add<f64> for Jet {
    type Output = Self;

    fn add(mut self, other: f64) -> Self {
        self.0[0] += other;
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(got: Jet, expected: [f64; 4]) {
        for (got, expected) in got.derivatives().into_iter().zip(expected) {
            assert!(
                (got - expected).abs() < 1e-12 * (1.0 + expected.abs()),
                "{got} {expected}"
            );
        }
    }

    /// Functions of s at 0.7 whose derivatives are known.
    #[test]
    fn derivatives_of_known_functions() {
        let s: f64 = 0.7;
        let x = Jet::variable(s, 1.0);
        close(x * x * x, [s.powi(3), 3.0 * s * s, 6.0 * s, 6.0]);
        let (sin, cos) = (x * 2.0).sin_cos();
        let (a, b) = (2.0 * s).sin_cos();
        close(sin, [a, 2.0 * b, -4.0 * a, -8.0 * b]);
        close(cos, [b, -2.0 * a, -4.0 * b, 8.0 * a]);
        close(sin * sin + cos * cos, [1.0, 0.0, 0.0, 0.0]);
        close(
            x.recip(),
            [1.0 / s, -1.0 / s.powi(2), 2.0 / s.powi(3), -6.0 / s.powi(4)],
        );
        close(x.sqrt() * x.sqrt(), [s, 1.0, 0.0, 0.0]);
        close(Jet::of_derivatives([1.0, 2.0, 3.0, 4.0]), [1.0, 2.0, 3.0, 4.0]);
    }
}
