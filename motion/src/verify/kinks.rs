//! Where the load of a drive passes zero on the way: friction in proportion to |g| has a kink there, which no parabola
//! through samples follows.
//!
//! Between samples of opposite sign the zero is found by the regula falsi, Illinois variant (Dowell and Jarratt 1971). Where
//! three of one sign dip towards zero, the parabola through them says where to look for a sign change in between.

use crate::tolerance::{KINK_APART, KINK_DIP_ROUNDS, KINK_ROUNDS};

/// A moment and the value there.
type At = (f64, f64);

/// Where a function passes zero, strictly between the first and the last of its samples, in increasing order. Values within
/// `floor` of zero are as good as zero: a function that stays there passes nowhere.
pub(crate) fn zeros(times: &[f64], values: &[f64], floor: f64, at: &mut dyn FnMut(f64) -> f64) -> Vec<f64> {
    let mut found = Vec::new();
    let samples: Vec<At> = times.iter().copied().zip(values.iter().copied()).collect();
    for pair in samples.windows(2) {
        crossing(pair[0], pair[1], floor, at, &mut found);
    }
    for three in samples.windows(3) {
        if three[1].1 == 0.0 && three[0].1 * three[2].1 < 0.0 {
            found.push(three[1].0);
        }
        dip([three[0], three[1], three[2]], floor, at, &mut found);
    }
    let (Some(first), Some(last)) = (times.first(), times.last()) else {
        return found;
    };
    let apart = KINK_APART * (last - first);
    found.retain(|time| *time > first + apart && *time < last - apart);
    found.sort_by(f64::total_cmp);
    found.dedup_by(|a, b| *a - *b <= apart);
    found
}

/// The zero between two samples of opposite sign.
fn crossing(mut a: At, mut b: At, floor: f64, at: &mut dyn FnMut(f64) -> f64, found: &mut Vec<f64>) {
    if a.1 * b.1 >= 0.0 || a.1.abs().max(b.1.abs()) <= floor {
        return;
    }
    // which end was kept the last time
    let mut kept = 0;
    let mut time = a.0;
    for _ in 0..KINK_ROUNDS {
        time = (a.0 * b.1 - b.0 * a.1) / (b.1 - a.1);
        let value = at(time);
        if value.abs() <= floor {
            break;
        }
        if value * b.1 < 0.0 {
            (a, b) = (b, (time, value));
            kept = 0;
        } else {
            // the same end twice: its value is halved, so that the next line crosses on its side
            b = (time, value);
            if kept > 0 {
                a.1 *= 0.5;
            }
            kept += 1;
        }
    }
    found.push(time);
}

/// The zeros around a dip of three samples of one sign.
fn dip(mut three: [At; 3], floor: f64, at: &mut dyn FnMut(f64) -> f64, found: &mut Vec<f64>) {
    let sign = three[1].1.signum();
    for round in 0..KINK_DIP_ROUNDS {
        let [v0, v1, v2] = three.map(|(_, value)| sign * value);
        if v1 <= floor || v0 < v1 || v2 < v1 {
            return;
        }
        let [t0, t1, t2] = three.map(|(time, _)| time);
        let (left, right) = ((v1 - v0) / (t1 - t0), (v2 - v1) / (t2 - t1));
        let curvature = (right - left) / (t2 - t0);
        let time = 0.5 * (t0 + t1) - 0.5 * left / curvature;
        let lowest = v0 + (time - t0) * (left + curvature * (time - t1));
        // a parabola that stays that high stands for a load that does not come down to zero
        let stays = round == 0 && lowest > 0.5 * v1;
        if !(time > t0 && time < t2) || time == t1 || stays {
            return;
        }
        let lowest = (time, at(time));
        if sign * lowest.1 <= 0.0 {
            crossing(three[0], lowest, floor, at, found);
            crossing(lowest, three[2], floor, at, found);
            return;
        }
        three = match (time < t1, sign * lowest.1 <= v1) {
            (true, true) => [three[0], lowest, three[1]],
            (true, false) => [lowest, three[1], three[2]],
            (false, true) => [three[1], lowest, three[2]],
            (false, false) => [three[0], three[1], lowest],
        };
    }
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
