//! Where a path is looked at: nodes that divide it into intervals, and equally spaced samples in each interval.
//!
//! Knots of the path and borders of the limits are nodes. There a sample is taken on each side, so that an interval never
//! sees what holds beyond it; elsewhere neighbours share the sample at their common node.

use crate::curve::{Curve, Side};
use crate::tolerance::{GRID_NODES_APART, SPAN_INTERVALS_MIN};

use super::limits::Limits;

/// A place on the path, and the side that it is seen from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Place {
    pub(crate) s: f64,
    pub(crate) side: Side,
}

/// Nodes, and samples between them.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Grid {
    /// Nodes s₀ < s₁ < … < s_N, both ends of the path included.
    pub(crate) nodes: Vec<f64>,
    /// Samples of interval i are `first[i]` to `first[i] + parts`, both included.
    pub(crate) first: Vec<usize>,
    /// Into how many parts the samples divide an interval.
    pub(crate) parts: usize,
    /// All samples, in order.
    pub(crate) places: Vec<Place>,
}

/// Nodes that no grid may be without: knots and borders, strictly increasing.
pub(crate) fn fixed_nodes(curve: &dyn Curve, limits: &Limits) -> Vec<f64> {
    let length = curve.length();
    let borders = limits.stretches.iter().map(|stretch| stretch.end);
    let mut nodes: Vec<f64> = curve
        .knots()
        .iter()
        .copied()
        .chain(borders)
        .filter(|s| *s > 0.0 && *s < length)
        .collect();
    nodes.sort_by(f64::total_cmp);
    let apart = GRID_NODES_APART * length;
    let mut kept = vec![0.0];
    for s in nodes {
        if s - kept[kept.len() - 1] > apart && length - s > apart {
            kept.push(s);
        }
    }
    kept.push(length);
    kept
}

/// About `count` intervals, but several between any two fixed nodes, of equal length in `measure`, a growing function of s given at
/// increasing places. Places and values of the measure are linear in between.
pub(crate) fn spread(fixed: &[f64], count: usize, places: &[f64], measure: &[f64]) -> Vec<f64> {
    let total = measure[measure.len() - 1] - measure[0];
    let value = |s: f64| interpolate(places, measure, s);
    let mut nodes = vec![fixed[0]];
    for pair in fixed.windows(2) {
        let (low, high) = (value(pair[0]), value(pair[1]));
        let intervals = ((count as f64 * (high - low) / total).round() as usize).max(SPAN_INTERVALS_MIN);
        for k in 1..intervals {
            let part = low + (high - low) * k as f64 / intervals as f64;
            let s = interpolate(measure, places, part);
            if s > nodes[nodes.len() - 1] && s < pair[1] {
                nodes.push(s);
            }
        }
        nodes.push(pair[1]);
    }
    nodes
}

/// About `count` intervals of equal length in s between fixed nodes.
pub(crate) fn even(fixed: &[f64], count: usize) -> Vec<f64> {
    let ends = [fixed[0], fixed[fixed.len() - 1]];
    spread(fixed, count, &ends, &ends)
}

fn interpolate(x: &[f64], y: &[f64], at: f64) -> f64 {
    let k = x.partition_point(|x| *x <= at).clamp(1, x.len() - 1);
    let step = x[k] - x[k - 1];
    if step <= 0.0 {
        return y[k];
    }
    y[k - 1] + (y[k] - y[k - 1]) * ((at - x[k - 1]) / step)
}

impl Grid {
    /// Samples between nodes. `fixed` is a subset of the nodes.
    pub(crate) fn new(nodes: Vec<f64>, fixed: &[f64], parts: usize) -> Self {
        let mut places = Vec::with_capacity(nodes.len() * parts + fixed.len());
        let mut first = Vec::with_capacity(nodes.len());
        let mut borders = fixed.iter().copied().peekable();
        for pair in nodes.windows(2) {
            let (low, high) = (pair[0], pair[1]);
            while borders.next_if(|border| *border < low).is_some() {}
            if places.is_empty() || borders.peek().is_some_and(|border| *border <= low) {
                places.push(Place {
                    s: low,
                    side: Side::After,
                });
            }
            first.push(places.len() - 1);
            let inner = (1..parts).map(|k| low + (high - low) * k as f64 / parts as f64);
            places.extend(inner.chain([high]).map(|s| Place { s, side: Side::Before }));
        }
        Self {
            nodes,
            first,
            parts,
            places,
        }
    }

    /// How many intervals there are.
    pub(crate) fn interval_count(&self) -> usize {
        self.first.len()
    }

    /// Length of an interval.
    pub(crate) fn step(&self, interval: usize) -> f64 {
        self.nodes[interval + 1] - self.nodes[interval]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn knots_have_a_sample_on_each_side_and_other_nodes_one() {
        let fixed = [0.0, 1.0, 3.0];
        let nodes = vec![0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0];
        let grid = Grid::new(nodes, &fixed, 2);
        assert_eq!(grid.first, [0, 2, 5, 7, 9, 11]);
        let at: Vec<f64> = grid.places.iter().map(|place| place.s).collect();
        assert_eq!(
            at,
            [
                0.0, 0.25, 0.5, 0.75, 1.0, 1.0, 1.25, 1.5, 1.75, 2.0, 2.25, 2.5, 2.75, 3.0
            ]
        );
        assert_eq!(grid.places[4].side, Side::Before);
        assert_eq!(grid.places[5].side, Side::After);
    }

    #[test]
    fn a_measure_draws_nodes_together() {
        let nodes = spread(&[0.0, 1.0], 16, &[0.0, 0.2, 1.0], &[0.0, 1.0, 2.0]);
        assert_eq!(nodes.len(), 17);
        for (k, node) in nodes.iter().enumerate() {
            let expected = if k <= 8 {
                0.025 * k as f64
            } else {
                0.2 + 0.1 * (k - 8) as f64
            };
            assert!((node - expected).abs() < 1e-15, "{nodes:?}");
        }
    }

    #[test]
    fn every_stretch_between_knots_has_several_intervals() {
        let nodes = even(&[0.0, 0.01, 3.0], 20);
        assert_eq!(nodes.iter().filter(|s| **s < 0.01).count(), SPAN_INTERVALS_MIN);
        assert_eq!(nodes.len(), 1 + SPAN_INTERVALS_MIN + 20);
    }

    #[test]
    fn knots_and_borders_that_rounding_parted_are_one() {
        let curve = crate::timing::test_curves::Rounded::new(vec![vec![0.0], vec![1.0], vec![3.0]], &[1.0]);
        let knots = curve.knots();
        let stretch = |end| crate::timing::limits::Stretch {
            end,
            ..Default::default()
        };
        let limits = Limits {
            stretches: vec![stretch(knots[1] + 1e-15), stretch(1.2), stretch(9.0)],
        };
        let nodes = fixed_nodes(&curve, &limits);
        assert_eq!(nodes.len(), knots.len() + 1, "{nodes:?} {knots:?}");
        assert_eq!((nodes[0], nodes[nodes.len() - 1]), (0.0, curve.length()));
    }
}
