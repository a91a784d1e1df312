//! The roots of a quartic, all four at once, by Aberth's iteration.
//!
//! ```text
//! zᵢ ← zᵢ − N/(1 − N·Σ_{j≠i} 1/(zᵢ − zⱼ)),   N = p(zᵢ)/p′(zᵢ)
//! ```
//!
//! (O. Aberth, "Iteration methods for finding all zeros of a polynomial simultaneously", 1973). Simple roots converge
//! cubically, and to rounding; a radical formula would lose half of the digits to cancellation.

use crate::tolerance::{IK_ROOT_ROUNDING, IK_ROOT_ROUNDS};

#[derive(Clone, Copy)]
struct Complex {
    re: f64,
    im: f64,
}

/// The real roots of p₀ + p₁·t + … + p₄·t⁴. A double root is a pair of complex ones as soon as its coefficients are
/// rounded: of a pair with imaginary parts up to ± `nearly` the sums of both parts are taken, one on either side.
pub(super) fn nearly_real_roots(p: &[f64; 5], nearly: f64) -> [Option<f64>; 4] {
    let is_usable = p[4] != 0.0 && p.iter().all(|coefficient| (coefficient / p[4]).is_finite());
    if !is_usable {
        return [None; 4];
    }
    let monic = [p[0] / p[4], p[1] / p[4], p[2] / p[4], p[3] / p[4]];
    roots(&monic).map(|z| (z.im.abs() <= nearly * (1.0 + z.re.abs())).then_some(z.re + z.im))
}

/// The roots of m₀ + m₁·z + m₂·z² + m₃·z³ + z⁴.
fn roots(m: &[f64; 4]) -> [Complex; 4] {
    // on a circle about the roots' mean, of the size of their spread, and not symmetric to the real axis
    let center = -0.25 * m[3];
    let spread = libm::sqrt(libm::sqrt(magnitude(value(m, Complex { re: center, im: 0.0 }).0)));
    let radius = if spread > 0.0 { spread } else { 1.0 };
    let mut z = [(0.878, 0.479), (-0.479, 0.878), (-0.878, -0.479), (0.479, -0.878)].map(|(x, y)| Complex {
        re: center + radius * x,
        im: radius * y,
    });
    for _ in 0..IK_ROOT_ROUNDS {
        let mut largest = 0.0;
        for i in 0..4 {
            let (p, slope) = value(m, z[i]);
            if p.re == 0.0 && p.im == 0.0 {
                continue;
            }
            // p/(p′ − p·Σ): the same step, and no division by a slope that may be 0
            let mut sum = Complex { re: 0.0, im: 0.0 };
            for j in 0..4 {
                if j != i {
                    let apart = inverse(sub(z[i], z[j]));
                    sum = Complex {
                        re: sum.re + apart.re,
                        im: sum.im + apart.im,
                    };
                }
            }
            let step = mul(p, inverse(sub(slope, mul(p, sum))));
            if !(step.re.is_finite() && step.im.is_finite()) {
                continue;
            }
            z[i] = sub(z[i], step);
            largest = f64::max(largest, magnitude(step) / (1.0 + magnitude(z[i])));
        }
        if largest <= IK_ROOT_ROUNDING {
            break;
        }
    }
    z
}

/// p and p′ at z (Horner).
fn value(m: &[f64; 4], z: Complex) -> (Complex, Complex) {
    let mut p = Complex { re: 1.0, im: 0.0 };
    let mut slope = Complex { re: 0.0, im: 0.0 };
    for &m in m.iter().rev() {
        slope = mul(slope, z);
        slope = Complex {
            re: slope.re + p.re,
            im: slope.im + p.im,
        };
        p = mul(p, z);
        p.re += m;
    }
    (p, slope)
}

fn mul(a: Complex, b: Complex) -> Complex {
    Complex {
        re: a.re * b.re - a.im * b.im,
        im: a.re * b.im + a.im * b.re,
    }
}

fn sub(a: Complex, b: Complex) -> Complex {
    Complex {
        re: a.re - b.re,
        im: a.im - b.im,
    }
}

fn inverse(a: Complex) -> Complex {
    let squared = a.re * a.re + a.im * a.im;
    Complex {
        re: a.re / squared,
        im: -a.im / squared,
    }
}

fn magnitude(a: Complex) -> f64 {
    libm::sqrt(a.re * a.re + a.im * a.im)
}

#[cfg(test)]
mod tests {
    use super::nearly_real_roots;
    use crate::test_arms::{random, values};

    /// (t − a)(t − b)(t − c)(t − d), times a factor.
    fn expanded([a, b, c, d]: [f64; 4], factor: f64) -> [f64; 5] {
        [
            a * b * c * d,
            -(a * b * c + a * b * d + a * c * d + b * c * d),
            a * b + a * c + a * d + b * c + b * d + c * d,
            -(a + b + c + d),
            1.0,
        ]
        .map(|coefficient| coefficient * factor)
    }

    fn sorted(p: &[f64; 5]) -> Vec<f64> {
        let mut roots: Vec<f64> = nearly_real_roots(p, 1e-3).into_iter().flatten().collect();
        roots.sort_by(f64::total_cmp);
        roots
    }

    fn check(mut expected: [f64; 4], tolerance: f64, state: &mut u64) {
        let found = sorted(&expanded(expected, 3.0 * random(state)));
        expected.sort_by(f64::total_cmp);
        assert_eq!(found.len(), 4, "{expected:?} {found:?}");
        let is_close = |(a, b): (&f64, &f64)| (a - b).abs() < tolerance;
        assert!(found.iter().zip(&expected).all(is_close), "{expected:?} {found:?}");
    }

    #[test]
    fn four_real_roots_are_found() {
        let state = &mut 1;
        for _ in 0..2000 {
            let mut roots = [0.0; 4];
            // apart by 0.1 at least: the error of a root grows as they come together
            for (root, step) in roots.iter_mut().zip(0..) {
                *root = 0.4 * (f64::from(step) - 1.5) + 0.15 * random(state);
            }
            check(roots, 1e-12, state);
        }
    }

    #[test]
    fn double_roots_are_found_twice() {
        let state = &mut 2;
        for _ in 0..500 {
            let &[a, b, c] = &values(3, 1.0, state)[..] else {
                panic!("three values");
            };
            if (a - b).abs().min((a - c).abs()) > 0.2 && (b - c).abs() > 0.2 {
                check([a, a, b, c], 1e-6, state);
                check([a, a, b, b], 1e-6, state);
            }
        }
        check([0.5; 4], 1e-3, state);
        check([0.0; 4], 1e-3, state);
    }

    #[test]
    fn complex_roots_are_left_out() {
        // (t² + 1)(t − 2)(t + 3), (t² + 1)(t² + 4)
        assert_eq!(sorted(&[-6.0, 1.0, -5.0, 1.0, 1.0]).len(), 2);
        assert_eq!(sorted(&[4.0, 0.0, 5.0, 0.0, 1.0]).len(), 0);
        assert_eq!(sorted(&[1.0, 2.0, 3.0, 4.0, 0.0]).len(), 0);
        assert_eq!(sorted(&[f64::NAN, 2.0, 3.0, 4.0, 1.0]).len(), 0);
    }
}
