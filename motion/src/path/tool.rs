//! The tool's pose along a path, with its derivatives: position p, and orientation as a unit quaternion Q.
//!
//! Mixed with the weight w, positions are p₁ + w(p₂ − p₁) and orientations R₁·exp(w·log(R₁ᵀR₂)), in quaternions
//!
//! ```text
//! Q = Q₁·k(1 − w) + Q₂·k(w)      k(x) = sin(xφ)/sin φ = x·S(x²φ²)/S(φ²)      S(z) = sin(√z)/√z      cos φ = Q₁·Q₂
//! ```
//!
//! (Shoemake 1985). φ is half the angle between the two. As a function of m = |Q₁ − Q₂|² the square φ² is analytic, so
//! that nothing is lost where both agree:
//!
//! ```text
//! φ² = 4·asin²(√m/2) = 2·Σₙ mⁿ/(n²·C(2n, n))        (Abramowitz and Stegun 1964, 15.1)
//! ```

use nalgebra::{Quaternion, Vector3};

use super::arm::{Frames, Rates};
use crate::jet::Jet;
use crate::tolerance::{ANGLE_TERMS, SINC_TERMS};

/// A pose with its derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ToolPoint {
    /// p in base-link axes, m.
    pub(super) position: [Jet; 3],
    /// Q: w x y z.
    pub(super) turn: [Jet; 4],
}

impl ToolPoint {
    /// Of an arm, from where its tool is and how it moves.
    pub(super) fn of_arm(frames: &Frames, rates: &Rates) -> Self {
        let [p1, p2, p3] = rates.linear;
        let position = std::array::from_fn(|i| Jet::of_derivatives([frames.position[i], p1[i], p2[i], p3[i]]));
        // Q′ = ½ω·Q, and on by the product rule
        let [w, w1, w2] = rates.angular.map(|w| Quaternion::from_imag(w * 0.5));
        let q = frames.quaternion();
        let q1 = w * q;
        let q2 = w1 * q + w * q1;
        let q3 = w2 * q + w1 * q1 * 2.0 + w * q2;
        let of = |i: usize| {
            // nalgebra stores x y z w
            let i = (i + 3) % 4;
            Jet::of_derivatives([q.coords[i], q1.coords[i], q2.coords[i], q3.coords[i]])
        };
        Self {
            position,
            turn: std::array::from_fn(of),
        }
    }

    /// The pose itself.
    pub(super) fn value(&self) -> (Vector3<f64>, Quaternion<f64>) {
        let [w, x, y, z] = self.turn.map(Jet::value);
        (
            Vector3::from(self.position.map(Jet::value)),
            Quaternion::new(w, x, y, z),
        )
    }

    /// p′, p″, p‴ and ω, ω′, ω″ with ω = 2Q′·Q̄.
    pub(super) fn rates(&self) -> Rates {
        let p = self.position.map(Jet::derivatives);
        let slope = self.turn.map(|Jet([_, c1, c2, c3])| Jet([c1, 2.0 * c2, 3.0 * c3, 0.0]));
        let [w, x, y, z] = self.turn;
        let omega = product(slope, [w, -x, -y, -z]).map(|part| (part * 2.0).0);
        Rates {
            linear: std::array::from_fn(|k| Vector3::new(p[0][k + 1], p[1][k + 1], p[2][k + 1])),
            angular: std::array::from_fn(|k| Vector3::new(omega[1][k], omega[2][k], omega[3][k]) * [1.0, 1.0, 2.0][k]),
        }
    }

    /// Part w of the way to another pose, the shorter way round.
    pub(super) fn mixed(&self, other: &Self, w: Jet) -> Self {
        let position = std::array::from_fn(|i| self.position[i] + w * (other.position[i] - self.position[i]));
        let sign = if self.cosine(other) < 0.0 { -1.0 } else { 1.0 };
        let target = other.turn.map(|part| part * sign);
        let m = self.turn.iter().zip(target).fold(Jet::default(), |sum, (one, other)| {
            let difference = other - *one;
            sum + difference * difference
        });
        let square = m.compose(half_angle_squared(m.value()));
        let whole = square.compose(sinc_of_square(square.value())).recip();
        let part = |x: Jet| {
            let inner = x * x * square;
            x * inner.compose(sinc_of_square(inner.value())) * whole
        };
        let (from, to) = (part(-w + 1.0), part(w));
        Self {
            position,
            turn: std::array::from_fn(|i| self.turn[i] * from + target[i] * to),
        }
    }

    /// Cosine of half the angle between two orientations; its sign is the quaternions' alone.
    pub(super) fn cosine(&self, other: &Self) -> f64 {
        let pairs = self.turn.iter().zip(other.turn);
        pairs.map(|(one, other)| one.value() * other.value()).sum()
    }
}

/// Product of two quaternions, w x y z.
pub(super) fn product(a: [Jet; 4], b: [Jet; 4]) -> [Jet; 4] {
    [
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
        a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
        a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
    ]
}

/// A rotation about a fixed axis in base-link axes, after a fixed one.
pub(super) fn turned(axis: &Vector3<f64>, angle: Jet, from: &Quaternion<f64>) -> [Jet; 4] {
    let (sin, cos) = (angle * 0.5).sin_cos();
    // axis and start do not change: two constant quaternions, mixed
    let across = Quaternion::from_imag(*axis) * from;
    let of = |from: f64, across: f64| cos * from + sin * across;
    [
        of(from.w, across.w),
        of(from.i, across.i),
        of(from.j, across.j),
        of(from.k, across.k),
    ]
}

/// φ² with three derivatives in m.
fn half_angle_squared(m: f64) -> [f64; 4] {
    let mut derivatives = [0.0; 4];
    // the coefficient of mⁿ: 2/(n²·C(2n, n)), from the one before
    let (mut coefficient, mut power) = (1.0, [m, 1.0, 0.0, 0.0]);
    for n in 1..=ANGLE_TERMS {
        let n = n as f64;
        let [_, p1, p2, p3] = power;
        derivatives[0] += coefficient * power[0];
        derivatives[1] += coefficient * n * p1;
        derivatives[2] += coefficient * n * (n - 1.0) * p2;
        derivatives[3] += coefficient * n * (n - 1.0) * (n - 2.0) * p3;
        coefficient *= n * n / ((2.0 * n + 1.0) * (2.0 * n + 2.0));
        power = [power[0] * m, power[0], p1, p2];
    }
    derivatives
}

/// S(z) with three derivatives: Σₙ (−z)ⁿ/(2n + 1)!, for z up to (π/2)².
fn sinc_of_square(z: f64) -> [f64; 4] {
    let mut derivatives = [0.0; 4];
    let (mut coefficient, mut power) = (1.0, [1.0, 0.0, 0.0, 0.0]);
    for n in 0..SINC_TERMS {
        let n = n as f64;
        let [p0, p1, p2, p3] = power;
        derivatives[0] += coefficient * p0;
        derivatives[1] += coefficient * n * p1;
        derivatives[2] += coefficient * n * (n - 1.0) * p2;
        derivatives[3] += coefficient * n * (n - 1.0) * (n - 2.0) * p3;
        coefficient *= -1.0 / ((2.0 * n + 2.0) * (2.0 * n + 3.0));
        power = [p0 * z, p0, p1, p2];
    }
    derivatives
}

#[cfg(test)]
mod tests;
