//! How far from its mean a quantity lies beyond which only a given probability is left: of the normal and of Student's
//! distribution, and of the largest of a Gaussian process.
//!
//! ```text
//! Q(u)   = ½·erfc(u/√2)                                        normal, one tail
//! Q_ν(t) = ½·I_x(ν/2, ½),  x = ν/(ν + t²)                      Student with ν degrees of freedom, one tail
//! ```
//!
//! I is the regularized incomplete beta function, by its continued fraction (W. Press et al., "Numerical Recipes", 3rd ed. 2007,
//! §6.4; modified Lentz). From [`STUDENT_NORMAL_FROM`] degrees of freedom on, t is u with its first two corrections in 1/ν
//! (M. Abramowitz, I. Stegun, "Handbook of Mathematical Functions", 26.7.5).

use std::f64::consts::{FRAC_1_SQRT_2, PI};

use crate::tolerance::{
    GAMMA_SERIES_FROM, QUANTILE_ROUNDING, QUANTILE_ROUNDS, STUDENT_NORMAL_FROM, STUDENT_ROUNDING, STUDENT_ROUNDS,
};

/// A tail and its density at a place: the probability beyond it, and by how much that falls.
type Tail = [f64; 2];

/// Beyond it lies `tail` of the standard normal distribution, 0 < tail < ½.
pub(crate) fn normal(tail: f64) -> f64 {
    place(normal_tail, tail)
}

/// Beyond it lies `tail` of Student's distribution as it is, of variance ν/(ν − 2); 0 < tail < ½.
pub(crate) fn student(degrees_of_freedom: f64, tail: f64) -> f64 {
    if degrees_of_freedom < STUDENT_NORMAL_FROM {
        let scale = density_scale(degrees_of_freedom);
        return place(|t| student_tail(t, degrees_of_freedom, scale), tail);
    }
    let u = normal(tail);
    let u2 = u * u;
    let first = u * (u2 + 1.0) / 4.0;
    let second = u * ((5.0 * u2 + 16.0) * u2 + 3.0) / 96.0;
    u + (first + second / degrees_of_freedom) / degrees_of_freedom
}

/// Beyond it, somewhere on its way, lies a Gaussian process of unit variance with at most the probability `tail`, both signs
/// counted, whose direction turns by `turn`, rad: 2·Q(u) + turn/π·exp(−u²/2).
pub(crate) fn largest_of_process(turn: f64, tail: f64) -> f64 {
    let law = |u: f64| {
        let [one, density] = normal_tail(u);
        let crossing = turn / PI * libm::exp(-0.5 * u * u);
        [2.0 * one + crossing, 2.0 * density + u * crossing]
    };
    place(law, tail)
}

fn normal_tail(u: f64) -> Tail {
    [
        0.5 * libm::erfc(u * FRAC_1_SQRT_2),
        libm::exp(-0.5 * u * u) / (2.0 * PI).sqrt(),
    ]
}

fn student_tail(t: f64, nu: f64, scale: f64) -> Tail {
    let t2 = t * t;
    let log = libm::log1p(t2 / nu);
    let density = scale * libm::exp(-0.5 * (nu + 1.0) * log);
    let (a, b) = (0.5 * nu, 0.5);
    let (x, rest) = (nu / (nu + t2), t2 / (nu + t2));
    // x^a·(1 − x)^b/B(a, b), which both forms of the function have
    let front = density * t;
    let tail = if x < (a + 1.0) / (a + b + 2.0) {
        0.5 * front * fraction(a, b, x) / a
    } else {
        0.5 - 0.5 * front * fraction(b, a, rest) / b
    };
    [tail, density]
}

/// Γ((ν + 1)/2)/(√(ν·π)·Γ(ν/2)): the density of Student's distribution at 0.
fn density_scale(nu: f64) -> f64 {
    let a = 0.5 * nu;
    if a < GAMMA_SERIES_FROM {
        return libm::exp(libm::lgamma(a + 0.5) - libm::lgamma(a)) / (nu * PI).sqrt();
    }
    let r = 1.0 / a;
    let series = 1.0 + r * (-1.0 / 8.0 + r * (1.0 / 128.0 + r * (5.0 / 1024.0 - r * 21.0 / 32768.0)));
    series / (2.0 * PI).sqrt()
}

/// The continued fraction of the incomplete beta function, without its factor x^a·(1 − x)^b/(a·B(a, b)).
fn fraction(a: f64, b: f64, x: f64) -> f64 {
    let away = |value: f64| {
        if value.abs() < f64::MIN_POSITIVE {
            f64::MIN_POSITIVE
        } else {
            value
        }
    };
    let mut c = 1.0;
    let mut d = 1.0 / away(1.0 - (a + b) * x / (a + 1.0));
    let mut value = d;
    for round in 1..=STUDENT_ROUNDS {
        let m = round as f64;
        let even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        d = 1.0 / away(1.0 + even * d);
        c = away(1.0 + even / c);
        value *= c * d;
        let odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        d = 1.0 / away(1.0 + odd * d);
        c = away(1.0 + odd / c);
        let step = c * d;
        value *= step;
        if (step - 1.0).abs() <= STUDENT_ROUNDING {
            break;
        }
    }
    value
}

/// Where a law that falls from 0 on leaves `tail`; 0 where it leaves less everywhere. Newton's method on the logarithm, kept
/// between bounds.
fn place(law: impl Fn(f64) -> Tail, tail: f64) -> f64 {
    if law(0.0)[0] <= tail {
        return 0.0;
    }
    let (mut low, mut high) = (0.0, 1.0);
    while law(high)[0] > tail && high < f64::MAX.sqrt() {
        (low, high) = (high, 2.0 * high);
    }
    let mut at = 0.5 * (low + high);
    for _ in 0..QUANTILE_ROUNDS {
        let [beyond, density] = law(at);
        if beyond > tail {
            low = at;
        } else {
            high = at;
        }
        let step = beyond / density * libm::log(beyond / tail);
        let next = if step.is_finite() && at + step > low && at + step < high {
            at + step
        } else {
            0.5 * (low + high)
        };
        let moved = (next - at).abs();
        at = next;
        if moved <= QUANTILE_ROUNDING * at {
            break;
        }
    }
    at
}

#[cfg(test)]
mod tests;
