//! The smallest value of a function on 0 to 1: samples, then a golden-section search (Kiefer 1953) about every sampled
//! minimum. It needs no derivatives and finds kinks too, where the nearest segment changes.

use crate::tolerance::{GOLDEN_STEPS, HALVINGS, REACH_CLOSE, TRANSITION_SAMPLES};

/// (√5 − 1)/2.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

pub(super) fn smallest(f: impl Fn(f64) -> f64) -> f64 {
    let spacing = 1.0 / TRANSITION_SAMPLES as f64;
    let at = |index: usize| f(index as f64 * spacing);
    let mut least = at(0).min(at(TRANSITION_SAMPLES));
    let (mut before, mut here) = (at(0), at(1));
    for index in 1..TRANSITION_SAMPLES {
        let after = at(index + 1);
        if here <= before && here <= after {
            let middle = index as f64 * spacing;
            least = least.min(golden(&f, middle - spacing, middle + spacing));
        }
        (before, here) = (here, after);
    }
    // a minimum within the first or the last interval has no sample below both of its neighbours
    least.min(golden(&f, 0.0, spacing)).min(golden(&f, 1.0 - spacing, 1.0))
}

pub(super) fn largest(f: impl Fn(f64) -> f64) -> f64 {
    -smallest(|x| -f(x))
}

fn golden(f: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    let mut inner = [high - GOLDEN * (high - low), low + GOLDEN * (high - low)];
    let mut value = inner.map(&f);
    for _ in 0..GOLDEN_STEPS {
        if value[0] <= value[1] {
            high = inner[1];
            inner = [high - GOLDEN * (high - low), inner[0]];
            value = [f(inner[0]), value[0]];
        } else {
            low = inner[0];
            inner = [inner[1], low + GOLDEN * (high - low)];
            value = [value[1], f(inner[1])];
        }
    }
    value[0].min(value[1])
}

/// The largest x up to `most` for which `holds`, which must hold for small x; 0 where it never does.
pub(super) fn largest_that(most: f64, holds: impl Fn(f64) -> bool) -> f64 {
    if holds(most) {
        return most;
    }
    let (mut low, mut high) = (0.0, most);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if holds(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

/// An x up to `most` with f(x) ≤ bound: `most`, or one where f is within [`REACH_CLOSE`] of the bound. f rises from 0
/// like a power of x, so that its logarithm is nearly a straight line of that of x: secants on it, and halving where
/// one leaves what is known to hold the place. What is returned was tried; where nothing was within the bound, it is
/// the smallest tried.
pub(super) fn power_within(most: f64, bound: f64, f: impl Fn(f64) -> f64) -> f64 {
    let value = f(most);
    if value <= bound {
        return most;
    }
    // a little inside, so that what is close to it is within the bound
    let target = bound * (1.0 - 0.5 * REACH_CLOSE);
    let over = |value: f64| libm::log((value / target).max(f64::MIN_POSITIVE));
    let mut outside = libm::log(most);
    let mut inside = f64::NEG_INFINITY;
    let mut last = [outside, over(value)];
    // as if f were in proportion to x; of a higher power it is a step too far, and inside
    let mut next = last[0] - last[1];
    for _ in 0..HALVINGS {
        let here = [next, over(f(libm::exp(next)))];
        if here[1].abs() <= 0.5 * REACH_CLOSE {
            return libm::exp(next);
        }
        if here[1] > 0.0 {
            outside = next;
        } else {
            inside = next;
        }
        next = here[0] - here[1] * (here[0] - last[0]) / (here[1] - last[1]);
        if !(next > inside && next < outside) {
            // still nothing inside: on as far again
            let low = if inside.is_finite() {
                inside
            } else {
                outside - here[1].abs() - 1.0
            };
            next = 0.5 * (low + outside);
        }
        last = here;
    }
    if inside.is_finite() {
        libm::exp(inside)
    } else {
        libm::exp(outside)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn minima_are_found_wherever_they_are() {
        for place in [0.0, 0.004, 0.3, 0.5, 0.7217, 0.999, 1.0] {
            let smooth = smallest(|x| 2.0 + (x - place) * (x - place));
            assert!((smooth - 2.0).abs() < 1e-15, "{place}: {smooth}");
            let kink = largest(|x| 1.0 - (x - place).abs());
            assert!((kink - 1.0).abs() < 1e-9, "{place}: {kink}");
        }
        // of two minima the deeper, although the samples see the other as deeper
        let two = |x: f64| (200.0 * (x - 0.5078)).abs().min(0.01 + 100.0 * (x - 0.25) * (x - 0.25));
        assert!(smallest(two) < 1e-6);
    }

    #[test]
    fn the_largest_that_holds() {
        assert!((largest_that(3.0, |x| x * x <= 2.0) / 2.0_f64.sqrt() - 1.0).abs() < 1e-12);
        assert_eq!(largest_that(3.0, |_| true), 3.0);
        assert_eq!(largest_that(3.0, |_| false), 0.0);
    }

    #[test]
    fn powers_are_met_from_within() {
        for power in [1.0, 1.5, 2.0, 6.0] {
            for bound in [1e-12, 1e-6, 0.3] {
                let calls = std::cell::Cell::new(0);
                let f = |x: f64| {
                    calls.set(calls.get() + 1);
                    x.powf(power) * (1.0 + 0.2 * x)
                };
                let reached = f(power_within(3.0, bound, f));
                assert!(
                    reached <= bound && reached > bound * (1.0 - REACH_CLOSE),
                    "{power} {bound} {reached}"
                );
                assert!(calls.get() < 12, "{power} {bound}: {}", calls.get());
            }
        }
        assert_eq!(power_within(3.0, 1.0, |_| 0.5), 3.0);
        // one that is no power at all, and one with a jump across the bound, are still kept within
        assert!(power_within(3.0, 1e-3, |x| if x > 0.1 { 1.0 } else { 0.0 }) <= 0.1);
        let cosine = |x: f64| 1.0 - x.cos();
        assert!(cosine(power_within(3.0, 1.2, cosine)) <= 1.2);
    }
}
