//! How a blend runs through its two segments: x from 0 to 1 over the blend, as a function of the path parameter s.
//!
//! The first segment is followed over its last b of s, the second over its first c. With u₁ = L₁ − b(1 − x) and
//! u₂ = c·x both reach their helper points together, and
//!
//! ```text
//! ds/dx = g(x) = b(1 − S(x)) + c·S(x),      S = x³(10 − 15x + 6x²)
//! ```
//!
//! so that du₁/ds = 1 where the blend begins and du₂/ds = 1 where it ends, with two more derivatives 0 there: neither path
//! changes its pace, however unequal b and c are. S integrates to ½, so that the blend is (b + c)/2 long; g is positive,
//! so that x has an inverse, found by Newton's method.

use crate::jet::Jet;
use crate::tolerance::{PASSAGE_ROUNDING, PASSAGE_ROUNDS};

/// The overlap of two segments.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Passage {
    /// b: what of the first segment takes part, in s.
    pub(super) before: f64,
    /// c: what of the second.
    pub(super) after: f64,
}

impl Passage {
    /// Length in s.
    pub(super) fn length(&self) -> f64 {
        0.5 * (self.before + self.after)
    }

    /// s at x.
    pub(super) fn s_at(&self, x: f64) -> f64 {
        // ∫S = x⁴(2.5 − 3x + x²)
        let (b, c) = (self.before, self.after);
        b * x + (c - b) * (x * x) * (x * x) * (2.5 - 3.0 * x + x * x)
    }

    /// g, g′, g″ at x.
    fn pace(&self, x: f64) -> [f64; 3] {
        let (b, change) = (self.before, self.after - self.before);
        let y = 1.0 - x;
        [
            b + change * x * x * x * (10.0 - 15.0 * x + 6.0 * x * x),
            change * 30.0 * x * x * y * y,
            change * 60.0 * x * y * (y - x),
        ]
    }

    /// x at s, from the blend's beginning, with its derivatives in s.
    pub(super) fn at(&self, s: f64) -> Jet {
        let length = self.length();
        let x = self.inverse((s / length).clamp(0.0, 1.0) * length);
        let [g, g1, g2] = self.pace(x);
        // x′ = 1/g, and on by the chain rule
        let r = 1.0 / g;
        Jet::of_derivatives([x, r, -g1 * r * r * r, (3.0 * g1 * g1 - g * g2) * (r * r) * (r * r) * r])
    }

    fn inverse(&self, s: f64) -> f64 {
        let length = self.length();
        let mut x = s / length;
        if self.before == self.after {
            return x;
        }
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..PASSAGE_ROUNDS {
            let excess = self.s_at(x) - s;
            if excess > 0.0 {
                high = x;
            } else {
                low = x;
            }
            let mut next = x - excess / self.pace(x)[0];
            if !(next >= low && next <= high) {
                next = 0.5 * (low + high);
            }
            let done = (next - x).abs() <= PASSAGE_ROUNDING;
            x = next;
            if done {
                break;
            }
        }
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATIOS: [(f64, f64); 6] = [
        (1.0, 1.0),
        (1.0, 2.0),
        (3.0, 0.5),
        (1.0, 1e-3),
        (1e-4, 5.0),
        (0.2, 0.19),
    ];

    #[test]
    fn the_inverse_is_one_and_never_turns_back() {
        for (before, after) in RATIOS {
            let passage = Passage { before, after };
            let mut last = -1.0;
            for i in 0..=1000 {
                let s = passage.length() * f64::from(i) / 1000.0;
                let x = passage.at(s).value();
                assert!((passage.s_at(x) - s).abs() < 1e-14 * passage.length());
                assert!(x > last);
                last = x;
            }
            assert!((last - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn both_segments_keep_their_pace_at_the_ends() {
        for (before, after) in RATIOS {
            let passage = Passage { before, after };
            for (s, pace) in [(0.0, before), (passage.length(), after)] {
                let [_, x1, x2, x3] = passage.at(s).derivatives();
                assert!((x1 * pace - 1.0).abs() < 1e-12);
                assert!((x2 * pace * pace).abs() < 1e-9 && (x3 * pace * pace * pace).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn derivatives_are_those_of_the_value() {
        let passage = Passage {
            before: 1.0,
            after: 0.4,
        };
        let h = 1e-5;
        for i in 1..50 {
            let s = passage.length() * f64::from(i) / 50.0;
            let (low, at, high) = (
                passage.at(s - h).derivatives(),
                passage.at(s).derivatives(),
                passage.at(s + h).derivatives(),
            );
            for k in 0..3 {
                let slope = (high[k] - low[k]) / (2.0 * h);
                assert!((slope - at[k + 1]).abs() < 1e-6 * (1.0 + at[k + 1].abs()), "{k} at {s}");
            }
        }
    }
}
