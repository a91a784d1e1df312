//! Where the load of a drive passes zero on the way: friction in proportion to |g| has a kink there, which no parabola
//! through samples follows.
//!
//! Between samples of opposite sign the zero is found by the regula falsi, Illinois variant (Dowell and Jarratt 1971). Where
//! three of one sign dip towards zero, the parabola through them says where to look for a sign change in between. A search
//! says where it looks next and is told what is there, so that many can look at once.

use crate::tolerance::{KINK_APART, KINK_DIP_ROUNDS, KINK_ROUNDS};

/// A moment and the value there.
type At = (f64, f64);

/// A search for one zero, or for two in a dip.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Search {
    bracket: Bracket,
    /// Where it looks next.
    probe: f64,
    round: usize,
}

#[derive(Debug, Clone, Copy)]
enum Bracket {
    /// Two moments of opposite sign; whether the first was kept by the last step.
    Crossing { ends: [At; 2], kept: bool },
    /// Three moments of one sign, the middle one closest to zero.
    Dip([At; 3]),
}

impl Search {
    /// The searches for the zeros of a function known at samples. Values within `floor` of zero are as good as zero: a
    /// function that stays there passes nowhere. What is found at once goes to `found`.
    pub(crate) fn begin(times: &[f64], values: &[f64], floor: f64, found: &mut Vec<f64>) -> Vec<Self> {
        let at = |k: usize| (times[k], values[k]);
        let mut searches = Vec::new();
        for k in 1..values.len() {
            searches.extend(Self::crossing([at(k - 1), at(k)], floor));
        }
        for k in 1..values.len().saturating_sub(1) {
            if values[k] == 0.0 && values[k - 1] * values[k + 1] < 0.0 {
                found.push(times[k]);
            }
            searches.extend(Self::dip([at(k - 1), at(k), at(k + 1)], 0, floor));
        }
        searches
    }

    /// Where to look next.
    pub(crate) fn probe(&self) -> f64 {
        self.probe
    }

    /// Goes on with the value at the probe: what is still to be searched for, and what is found.
    pub(crate) fn step(self, value: f64, floor: f64, found: &mut Vec<f64>) -> [Option<Self>; 2] {
        let here = (self.probe, value);
        match self.bracket {
            Bracket::Crossing { ends, kept } => [self.closer(ends, kept, here, floor, found), None],
            Bracket::Dip(three) => self.deeper(three, here, floor),
        }
    }

    /// Between two moments, if the values have opposite signs that mean something.
    fn crossing(ends: [At; 2], floor: f64) -> Option<Self> {
        let [a, b] = ends;
        if a.1 * b.1 >= 0.0 || a.1.abs().max(b.1.abs()) <= floor {
            return None;
        }
        Some(Self {
            bracket: Bracket::Crossing { ends, kept: false },
            probe: falsi(ends),
            round: 0,
        })
    }

    fn closer(&self, ends: [At; 2], kept: bool, here: At, floor: f64, found: &mut Vec<f64>) -> Option<Self> {
        if here.1.abs() <= floor || self.round + 1 == KINK_ROUNDS {
            found.push(here.0);
            return None;
        }
        let [mut a, b] = ends;
        let (ends, kept) = if here.1 * b.1 < 0.0 {
            ([b, here], false)
        } else {
            // the same end twice: its value is halved, so that the next line crosses on its side
            if kept {
                a.1 *= 0.5;
            }
            ([a, here], true)
        };
        Some(Self {
            bracket: Bracket::Crossing { ends, kept },
            probe: falsi(ends),
            round: self.round + 1,
        })
    }

    /// In three moments of one sign, if the parabola through them comes close to zero.
    fn dip(three: [At; 3], round: usize, floor: f64) -> Option<Self> {
        let [(t0, v0), (t1, v1), (t2, v2)] = three;
        let sign = v1.signum();
        let [v0, v1, v2] = [v0, v1, v2].map(|value| sign * value);
        if v1 <= floor || v0 < v1 || v2 < v1 {
            return None;
        }
        let (left, right) = ((v1 - v0) / (t1 - t0), (v2 - v1) / (t2 - t1));
        let curvature = (right - left) / (t2 - t0);
        let probe = 0.5 * (t0 + t1) - 0.5 * left / curvature;
        let lowest = v0 + (probe - t0) * (left + curvature * (probe - t1));
        // a parabola that stays that high stands for a load that does not come down to zero
        let stays = round == 0 && lowest > 0.5 * v1;
        if !(probe > t0 && probe < t2) || probe == t1 || stays || round == KINK_DIP_ROUNDS {
            return None;
        }
        Some(Self {
            bracket: Bracket::Dip(three),
            probe,
            round,
        })
    }

    fn deeper(&self, three: [At; 3], here: At, floor: f64) -> [Option<Self>; 2] {
        let middle = three[1];
        if here.1 * middle.1 <= 0.0 {
            return [[three[0], here], [here, three[2]]].map(|ends| Self::crossing(ends, floor));
        }
        let three = match (here.0 < middle.0, here.1.abs() <= middle.1.abs()) {
            (true, true) => [three[0], here, middle],
            (true, false) => [here, middle, three[2]],
            (false, true) => [middle, here, three[2]],
            (false, false) => [three[0], middle, here],
        };
        [Self::dip(three, self.round + 1, floor), None]
    }
}

/// Where the line through two points crosses zero.
fn falsi([a, b]: [At; 2]) -> f64 {
    (a.0 * b.1 - b.0 * a.1) / (b.1 - a.1)
}

/// Where a function passes zero, strictly between the first and the last of its samples, in increasing order.
pub(crate) fn zeros(times: &[f64], values: &[f64], floor: f64, at: &mut dyn FnMut(f64) -> f64) -> Vec<f64> {
    let mut found = Vec::new();
    let mut searches = Search::begin(times, values, floor, &mut found);
    while let Some(search) = searches.pop() {
        let value = at(search.probe());
        searches.extend(search.step(value, floor, &mut found).into_iter().flatten());
    }
    if let (Some(first), Some(last)) = (times.first(), times.last()) {
        keep_apart(&mut found, *first, *last);
    }
    found
}

/// Sorts moments, and leaves out those that are too close to another or to an end.
pub(crate) fn keep_apart(found: &mut Vec<f64>, first: f64, last: f64) {
    let apart = KINK_APART * (last - first);
    found.retain(|time| *time > first + apart && *time < last - apart);
    found.sort_by(f64::total_cmp);
    found.dedup_by(|a, b| *a - *b <= apart);
}

#[cfg(test)]
mod tests {
    use super::*;

    const FLOOR: f64 = 1e-9;

    fn sampled(function: impl Fn(f64) -> f64, count: usize) -> Vec<f64> {
        let times: Vec<f64> = (0..=count).map(|k| k as f64 / count as f64).collect();
        let values: Vec<f64> = times.iter().map(|time| function(*time)).collect();
        zeros(&times, &values, FLOOR, &mut |time| function(time))
    }

    fn check(found: &[f64], expected: &[f64]) {
        assert_eq!(found.len(), expected.len(), "{found:?} {expected:?}");
        for (found, expected) in found.iter().zip(expected) {
            assert!((found - expected).abs() <= 1e-8, "{found} {expected}");
        }
    }

    #[test]
    fn zeros_of_a_sine_are_found_at_any_phase() {
        for step in 0..50 {
            let shift = 0.02 * f64::from(step) * std::f64::consts::PI;
            let found = sampled(|time| libm::sin(7.0 * time + shift), 12);
            let expected: Vec<f64> = (1..5)
                .map(|k| (f64::from(k) * std::f64::consts::PI - shift) / 7.0)
                .filter(|time| *time > 1e-7 && *time < 1.0 - 1e-7)
                .collect();
            check(&found, &expected);
        }
    }

    #[test]
    fn a_dip_between_samples_has_two_zeros_and_a_shallow_one_none() {
        // lowest at 0.45, in the middle of two samples: depth d below zero
        let bowl = |depth: f64| move |time: f64| 20.0 * (time - 0.45) * (time - 0.45) * (1.0 + 0.3 * time) - depth;
        for depth in [1e-2, 1e-3, 1e-5, 1e-7] {
            let found = sampled(bowl(depth), 10);
            assert_eq!(found.len(), 2, "{depth} {found:?}");
            for time in found {
                assert!(bowl(depth)(time).abs() <= FLOOR, "{depth}");
            }
        }
        check(&sampled(bowl(-1e-3), 10), &[]);
    }

    #[test]
    fn what_is_as_good_as_zero_passes_nowhere() {
        let noise = |time: f64| 1e-13 * libm::sin(1e3 * time);
        check(&sampled(noise, 20), &[]);
        check(&sampled(|_| 0.0, 20), &[]);
        // exactly zero on a sample
        check(&sampled(|time| time - 0.5, 10), &[0.5]);
        check(&sampled(|time| time, 10), &[]);
    }
}
