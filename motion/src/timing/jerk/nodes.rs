//! Where the nodes of a grid are: on knots of the path and borders of limits, and between them where the motion spends
//! its time.

use super::profile::Profile;
use crate::timing::grid;
use crate::tolerance::{JERK_INTERVALS_RATIO, JERK_NODES_APART};

/// Into how many parts the first intervals are divided: after that at rest, or the very first where the motion moves so
/// slowly at the end that it is nearly at rest there.
const NEAR_REST: [usize; 4] = [4, 3, 2, 2];

/// How many times ṡ² grows over an interval that is divided as from rest.
const NEARLY_REST: f64 = 4.0;

/// Of knots and borders those that are nodes of every grid: of several very close ones, the first.
pub(super) fn apart(nodes: &[f64]) -> Vec<f64> {
    let length = nodes[nodes.len() - 1];
    let apart = JERK_NODES_APART * length;
    let mut kept = vec![nodes[0]];
    for s in &nodes[1..nodes.len() - 1] {
        if s - kept[kept.len() - 1] > apart && length - s > apart {
            kept.push(*s);
        }
    }
    kept.push(length);
    kept
}

/// About `count` intervals of the same length.
pub(super) fn even(fixed: &[f64], count: usize) -> Vec<f64> {
    gradual(grid::even(fixed, count))
}

/// About `count` intervals, nodes where the motion spends its time and where its way is, half and half.
pub(super) fn respread(profile: &Profile<'_>, fixed: &[f64], count: usize) -> Option<Vec<f64>> {
    const PARTS: usize = 8;
    let law = profile.law()?;
    let nodes = profile.nodes;
    let last = nodes.len() - 1;
    let mut places = Vec::with_capacity(PARTS * last + 1);
    for (interval, pair) in nodes.windows(2).enumerate() {
        for k in 0..PARTS {
            let part = k as f64 / PARTS as f64;
            // near rest, equal times
            let part = match interval {
                0 => part * part * part,
                i if i + 1 == last => 1.0 - (1.0 - part) * (1.0 - part) * (1.0 - part),
                _ => part,
            };
            places.push(pair[0] + part * (pair[1] - pair[0]));
        }
    }
    places.push(nodes[last]);
    let way = 0.5 / nodes[last];
    let time = 0.5 / law.duration();
    let measure: Vec<f64> = places.iter().map(|s| way * s + time * law.time_at(*s)).collect();
    Some(gradual(eased(&grid::spread(fixed, count, &places, &measure), profile)))
}

/// The same nodes, with the intervals next to those at rest divided at equal times. There nodes at equal times are at
/// distances from rest in the ratio 1 : 8 : 27, however fine the grid is, and a cubic follows s^(4/3) the less well.
fn eased(nodes: &[f64], profile: &Profile<'_>) -> Vec<f64> {
    let last = nodes.len() - 1;
    let mut eased = Vec::with_capacity(nodes.len() + 2 * NEAR_REST.iter().sum::<usize>());
    for (interval, pair) in nodes.windows(2).enumerate() {
        eased.push(pair[0]);
        let from_end = last - 1 - interval;
        let (rest, moves) = if interval <= from_end {
            (nodes[0], profile.moving.start)
        } else {
            (nodes[last], profile.moving.end)
        };
        let after_rest = interval.min(from_end).checked_sub(usize::from(!moves));
        let mut parts = after_rest.and_then(|k| NEAR_REST.get(k)).copied().unwrap_or(1);
        if moves && parts > 1 {
            // short intervals where nothing changes leave the normal equations without digits
            let [a, b] = [pair[0], pair[1]].map(|s| profile.square(s));
            parts = if a.max(b) > NEARLY_REST * a.min(b) { parts } else { 1 };
        }
        let roots = [pair[0] - rest, pair[1] - rest].map(libm::cbrt);
        for k in 1..parts {
            let root = roots[0] + (roots[1] - roots[0]) * k as f64 / parts as f64;
            eased.push(rest + root * root * root);
        }
    }
    eased.push(nodes[last]);
    eased.dedup_by(|later, earlier| *later <= *earlier);
    eased
}

/// The same nodes and more, so that no interval is much longer than its neighbours: next to a very short one, a spline
/// with a long one has coefficients that say nothing of its values.
fn gradual(nodes: Vec<f64>) -> Vec<f64> {
    let forwards = growing(nodes.into_iter());
    let mirrored = growing(forwards.iter().rev().map(|s| -s));
    mirrored.iter().rev().map(|s| -s).collect()
}

/// Nodes such that no interval is much longer than the one before it.
fn growing(mut nodes: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut grown: Vec<f64> = nodes.next().into_iter().collect();
    let mut before = f64::INFINITY;
    for end in nodes {
        while let Some(begin) = grown.last().copied() {
            let left = end - begin;
            let step = JERK_INTERVALS_RATIO * before;
            let next = begin + if left < 2.0 * step { 0.5 * left } else { step };
            if left <= step || next <= begin || next >= end {
                before = left;
                break;
            }
            before = next - begin;
            grown.push(next);
        }
        grown.push(end);
    }
    grown
}

#[cfg(test)]
mod tests {
    use super::super::ends::Moving;
    use super::*;

    #[test]
    fn intervals_grow_gradually_on_both_sides() {
        let nodes = gradual(vec![0.0, 0.3, 0.300_01, 1.0, 1.000_001, 1.5]);
        assert!(nodes.len() < 60, "{nodes:?}");
        for s in [0.0, 0.3, 0.300_01, 1.0, 1.000_001, 1.5] {
            assert!(nodes.contains(&s), "{s} {nodes:?}");
        }
        let lengths: Vec<f64> = nodes.windows(2).map(|pair| pair[1] - pair[0]).collect();
        for pair in lengths.windows(2) {
            assert!(
                pair[0] > 0.0 && (pair[1] / pair[0]).max(pair[0] / pair[1]) < 1.01 * JERK_INTERVALS_RATIO,
                "{pair:?}"
            );
        }
        let even = vec![0.0, 1.0, 2.0, 2.5];
        assert_eq!(gradual(even.clone()), even);
    }

    /// Distances from rest 1, 8, 27 … 216 become cubes of equal steps.
    #[test]
    fn nodes_near_rest_are_at_equal_times() {
        let cubes = |k: i32| f64::from(k * k * k);
        let nodes: Vec<f64> = (0..=6)
            .map(cubes)
            .chain((0..6).rev().map(|k| 432.0 - cubes(k)))
            .collect();
        let from_rest = Profile {
            nodes: &nodes,
            moving: Moving::default(),
            inner: vec![[1.0, 0.0, 0.0]; nodes.len() - 2],
        };
        let eased = eased(&nodes, &from_rest);
        assert!(eased.is_sorted_by(|a, b| a < b));
        for (node, expected) in eased
            .iter()
            .zip([0.0, 1.0, 1.25, 1.5, 1.75, 2.0].map(|k: f64| k * k * k))
        {
            assert!((node - expected).abs() < 1e-12);
        }
        for (a, b) in eased.iter().zip(eased.iter().rev()) {
            assert!((a + b - 432.0).abs() < 1e-9);
        }
    }
}
