//! The smallest value of a function on 0 to 1: samples, then a golden-section search (Kiefer 1953) about every sampled
//! minimum. It needs no derivatives and finds kinks too, where the nearest segment changes.

use crate::tolerance::{GOLDEN_STEPS, HALVINGS, TRANSITION_SAMPLES};

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
}
