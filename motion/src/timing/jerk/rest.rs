//! The law of constant jerk that leaves rest and comes to rest.
//!
//! From rest with constant s⃛ = j: s = j·t³/6, so in x = s/h, with a₁ = ṡ² at s = h,
//!
//! ```text
//! a = ṡ² = a₁·x^(4/3)      b = s̈ = ±(2/3)·(a₁/h)·x^(1/3)      s⃛ = (2/9)·a₁^(3/2)/h²      duration 3·h/√a₁
//! ```
//!
//! At its inner end (a, b, c = s⃛/ṡ) = a₁·(1, ±2/(3h), 2/(9h²)), linear in a₁. The same law backwards comes to rest; b
//! is then negative. c grows beyond all bounds towards rest, which no polynomial a(s) can follow: that is why the first
//! and the last interval of a grid have this law.

/// (a, b, c)/a₁ at the inner end of a law of length `h`; `direction` is 1 where it leaves rest, −1 where it comes to
/// rest.
pub(crate) fn inner_end(h: f64, direction: f64) -> [f64; 3] {
    [1.0, direction * 2.0 / (3.0 * h), 2.0 / (9.0 * h * h)]
}

/// ṡ, s̈ and s⃛ at the part `x` of the length `h` away from rest, for a value `a1` at the inner end.
pub(crate) fn rates(h: f64, direction: f64, a1: f64, x: f64) -> [f64; 3] {
    let root = libm::cbrt(x);
    let speed = a1.sqrt();
    [
        speed * root * root,
        direction * (2.0 / 3.0) * (a1 / h) * root,
        (2.0 / 9.0) * a1 * speed / (h * h),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// s = j·t³/6 and its derivatives in time, against the law in s.
    #[test]
    fn constant_jerk() {
        let (jerk, t_end) = (7.0, 0.4_f64);
        let h = jerk * t_end.powi(3) / 6.0;
        let a1 = (jerk * t_end * t_end / 2.0).powi(2);
        assert!((3.0 * h / a1.sqrt() - t_end).abs() < 1e-14);
        for part in [0.0, 0.1, 0.5, 0.9, 1.0] {
            let t = part * t_end;
            let s = jerk * t.powi(3) / 6.0;
            for direction in [1.0, -1.0] {
                let [sd, sdd, sddd] = rates(h, direction, a1, s / h);
                assert!((sd - jerk * t * t / 2.0).abs() < 1e-14);
                assert!((sdd - direction * jerk * t).abs() < 1e-13);
                assert!((sddd - jerk).abs() < 1e-12);
            }
        }
        let [a, b, c] = inner_end(h, -1.0).map(|form| form * a1);
        let [sd, sdd, sddd] = rates(h, -1.0, a1, 1.0);
        assert!((a - sd * sd).abs() < 1e-14 && (b - sdd).abs() < 1e-13 && (c * sd - sddd).abs() < 1e-12);
    }

    /// b = a′/2 and c = b′ by central differences of a in s.
    #[test]
    fn derivatives_in_s() {
        let (h, a1, step) = (0.3, 2.0, 1e-5);
        let a = |s: f64| rates(h, 1.0, a1, s / h)[0].powi(2);
        for s in [0.1, 0.2, 0.29] {
            let [sd, sdd, sddd] = rates(h, 1.0, a1, s / h);
            assert!((sdd - (a(s + step) - a(s - step)) / (4.0 * step)).abs() < 1e-8);
            let c = (a(s + step) - 2.0 * a(s) + a(s - step)) / (2.0 * step * step);
            assert!((sddd / sd - c).abs() < 1e-4);
        }
    }
}
