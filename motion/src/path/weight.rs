//! The weight of a blend, w(x) from 0 to 1 over x from 0 to 1, with three derivatives.
//!
//! ```text
//! smoothstep    w = x⁴(35 − 84x + 70x² − 20x³)          w′ = 140 x³(1 − x)³
//! tan-sigmoid   w = 1/(1 + exp(−g)),  g = a·tan(π(x − ½))
//! ```
//!
//! The second is the patent's (JP2016-055404, paragraph 0087); all its derivatives vanish at the ends, where g is infinite.

use super::request::Weight;
use crate::tolerance::SIGMOID_EXPONENT_MAX;

/// w, w′, w″, w‴ at x.
pub(super) fn weight(kind: Weight, x: f64) -> [f64; 4] {
    if x <= 0.0 {
        return [0.0; 4];
    }
    if x >= 1.0 {
        return [1.0, 0.0, 0.0, 0.0];
    }
    match kind {
        Weight::Smoothstep => smoothstep(x),
        Weight::TanSigmoid { a } => sigmoid(a, x),
    }
}

fn smoothstep(x: f64) -> [f64; 4] {
    let y = 1.0 - x;
    let (xx, yy) = (x * x, y * y);
    let low = |x: f64| (x * x) * (x * x) * (35.0 + x * (-84.0 + x * (70.0 - 20.0 * x)));
    [
        // the polynomial loses digits near 1, where its mirror image is small
        if x < 0.5 { low(x) } else { 1.0 - low(y) },
        140.0 * xx * x * yy * y,
        420.0 * xx * yy * (y - x),
        840.0 * x * y * (1.0 - 5.0 * x * y),
    ]
}

fn sigmoid(a: f64, x: f64) -> [f64; 4] {
    let angle = std::f64::consts::PI * (x - 0.5);
    let t = libm::sin(angle) / libm::cos(angle);
    let g = a * t;
    // beyond it the weight is 0 or 1 and every derivative is 0, while their factors overflow
    if g.abs() > SIGMOID_EXPONENT_MAX {
        return [if g > 0.0 { 1.0 } else { 0.0 }, 0.0, 0.0, 0.0];
    }
    let pi = std::f64::consts::PI;
    let slope = 1.0 + t * t;
    let g1 = a * pi * slope;
    let g2 = 2.0 * pi * t * g1;
    let g3 = 2.0 * pi * pi * g1 * (1.0 + 3.0 * t * t);
    let f = 1.0 / (1.0 + libm::exp(-g));
    // f(1 − f) without the cancellation of 1 − f near 1
    let decay = libm::exp(-g.abs());
    let f1 = decay / ((1.0 + decay) * (1.0 + decay));
    let f2 = f1 * (1.0 - 2.0 * f);
    let f3 = f1 * (1.0 - 6.0 * f1);
    [
        f,
        f1 * g1,
        f2 * g1 * g1 + f1 * g2,
        f3 * g1 * g1 * g1 + 3.0 * f2 * g1 * g2 + f1 * g3,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    const KINDS: [Weight; 4] = [
        Weight::Smoothstep,
        Weight::TanSigmoid { a: 2.0 },
        Weight::TanSigmoid { a: 5.0 },
        Weight::TanSigmoid { a: 30.0 },
    ];

    #[test]
    fn derivatives_are_those_of_the_value() {
        let h = 1e-5;
        for kind in KINDS {
            for i in 1..100 {
                let x = f64::from(i) / 100.0;
                let (before, at, after) = (weight(kind, x - h), weight(kind, x), weight(kind, x + h));
                for k in 0..3 {
                    let slope = (after[k] - before[k]) / (2.0 * h);
                    let scale = 1.0 + at[k + 1].abs() + at[3].abs();
                    assert!((slope - at[k + 1]).abs() < 1e-5 * scale, "{kind:?} at {x}, order {k}");
                }
            }
        }
    }

    #[test]
    fn both_halves_are_mirror_images() {
        for kind in KINDS {
            for i in 0..=64 {
                let x = f64::from(i) / 64.0;
                let (left, right) = (weight(kind, x), weight(kind, 1.0 - x));
                let scale = |k: usize| 1e-12 * (1.0 + left[k].abs());
                assert!((left[0] + right[0] - 1.0).abs() < scale(0));
                assert!((left[1] - right[1]).abs() < scale(1));
                assert!((left[2] + right[2]).abs() < 100.0 * scale(2));
                assert!((left[3] - right[3]).abs() < 1000.0 * scale(3));
            }
        }
    }

    #[test]
    fn ends_are_flat_and_finite() {
        for kind in KINDS {
            for x in [-1.0, 0.0, f64::MIN_POSITIVE, 1e-300, 1e-12] {
                let [w, w1, w2, _] = weight(kind, x);
                assert!(w.abs() < 1e-30 && w1.abs() < 1e-30 && w2.abs() < 1e-20, "{kind:?} {x}");
                let high = weight(kind, 1.0 - x);
                assert!((high[0] - 1.0).abs() < 1e-15, "{kind:?} {x}");
                assert!(high.iter().all(|value| value.is_finite()));
            }
        }
    }

    /// Peaks that were computed on a grid of 200,001 points.
    #[test]
    fn peaks_are_the_published_ones() {
        let peaks = |kind| {
            let mut peaks = [0.0f64; 4];
            for i in 0..=20_000 {
                for (peak, value) in peaks.iter_mut().zip(weight(kind, f64::from(i) / 20_000.0)) {
                    *peak = peak.max(value.abs());
                }
            }
            peaks
        };
        let close = |got: [f64; 4], expected: [f64; 3], part: f64| {
            for (got, expected) in got[1..].iter().zip(expected) {
                assert!((got / expected - 1.0).abs() < part, "{got} {expected}");
            }
        };
        close(peaks(Weight::Smoothstep), [2.19, 7.51, 52.5], 2e-3);
        close(peaks(Weight::TanSigmoid { a: 5.0 }), [3.93, 22.98, 407.0], 2e-3);
    }
}
