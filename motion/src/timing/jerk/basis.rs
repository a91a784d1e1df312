//! a(s) = ṡ² as a cubic B-spline, between the laws of constant jerk where an end is at rest.
//!
//! Nodes s₀ … s_N. With both ends at rest, on [s₁, s_{N−1}] with knots {s₁ ×4, s₂ … s_{N−2}, s_{N−1} ×4}, a(s) = Σ dᵢ·Bᵢ(s)
//! with N + 1 coefficients. So s̈ = b = a′/2 and c = s⃛/ṡ = a″/2 are continuous and c is piecewise linear: jerk can follow
//! a path whose third derivative moves within an interval. The first three coefficients follow from a₁ and the last three
//! from a_{N−1} through [`super::rest`]; so x = d₂ … d_{N−2} are the unknowns. (Cox 1972, de Boor 1972.)
//!
//! An end that moves has no interval of rest: the spline goes up to it, and d₀ = a(s₀) = ṡ². There b = (3/2)·(d₁ − d₀)/(s₁ − s₀)
//! is 0, so d₁ = d₀: together they are the first unknown (at the end of the path, the last).

use super::ends::Moving;
use super::rest;

/// Fewest intervals of a grid: below, four neighbouring unknowns are more than there are.
pub(crate) const INTERVALS_MIN: usize = 7;

/// The spline space over one grid.
#[derive(Debug)]
pub(crate) struct Basis {
    nodes: Vec<f64>,
    knots: Vec<f64>,
    moving: Moving,
    /// What the coefficients before the first unknown's are of it: d₀/d₂ and d₁/d₂ from rest, d₀/d₁ where it moves.
    begin: [f64; 2],
    /// The same after the last unknown's, outwards.
    end: [f64; 2],
}

/// (a, b, c) at one place: row `r` is `rows[r]` · x\[base..base + 4\].
#[derive(Debug, Clone, Copy)]
pub(crate) struct Form {
    pub(crate) base: usize,
    pub(crate) rows: [[f64; 4]; 3],
}

impl Form {
    #[inline(always)]
    pub(crate) fn apply(&self, x: &[f64]) -> [f64; 3] {
        let x = &x[self.base..self.base + 4];
        let row = |row: &[f64; 4]| row[0] * x[0] + row[1] * x[1] + (row[2] * x[2] + row[3] * x[3]);
        [row(&self.rows[0]), row(&self.rows[1]), row(&self.rows[2])]
    }
}

impl Basis {
    /// Over strictly increasing nodes, at least [`INTERVALS_MIN`] + 1 of them.
    pub(crate) fn new(nodes: Vec<f64>, moving: Moving) -> Self {
        let intervals = nodes.len() - 1;
        debug_assert!(intervals >= INTERVALS_MIN, "a window of four unknowns");
        let spline = moving.spline_intervals(intervals);
        let mut knots = vec![nodes[spline.start]; 3];
        knots.extend_from_slice(&nodes[spline.start..=spline.end]);
        knots.extend([nodes[spline.end]; 3]);
        let mut basis = Self {
            nodes,
            knots,
            moving,
            begin: [1.0; 2],
            end: [1.0; 2],
        };
        if !moving.start {
            basis.begin = basis.clamp_begin();
        }
        if !moving.end {
            basis.end = basis.clamp_end();
        }
        basis
    }

    /// The intervals where a(s) is the spline.
    pub(crate) fn spline(&self) -> std::ops::Range<usize> {
        self.moving.spline_intervals(self.nodes.len() - 1)
    }

    /// How many coefficients are before the first unknown's, and after the last one's.
    fn dependent(&self) -> [usize; 2] {
        [self.moving.start, self.moving.end].map(|moves| if moves { 1 } else { 2 })
    }

    pub(crate) fn nodes(&self) -> &[f64] {
        &self.nodes
    }

    pub(crate) fn unknown_count(&self) -> usize {
        let [before, after] = self.dependent();
        self.spline().len() + 3 - before - after
    }

    /// Where each unknown acts on average (Greville 1967): a smooth function's values there are close to its
    /// coefficients.
    pub(crate) fn centers(&self) -> impl Iterator<Item = f64> + '_ {
        let [before, _] = self.dependent();
        (before..before + self.unknown_count())
            .map(|i| (self.knots[i + 1] + self.knots[i + 2] + self.knots[i + 3]) / 3.0)
    }

    /// The form at `s` in the interval from node `interval` to the next, one of the spline's.
    pub(crate) fn form(&self, interval: usize, s: f64) -> Form {
        let ([before, _], unknowns) = (self.dependent(), self.unknown_count());
        let first = interval - self.spline().start;
        let base = first.saturating_sub(before).min(unknowns - 4);
        let mut rows = [[0.0; 4]; 3];
        for (row, values) in rows.iter_mut().zip(self.local(first, s)) {
            for (r, value) in values.into_iter().enumerate() {
                let (unknown, factor) = match first + r {
                    i if i < before => (0, self.begin[i]),
                    i if i < before + unknowns => (i - before, 1.0),
                    i => (unknowns - 1, self.end[i - before - unknowns]),
                };
                row[unknown - base] += factor * value;
            }
        }
        Form { base, rows }
    }

    /// a, a′/2 and a″/2 of the four splines that are not 0 on the spline's interval `k`.
    fn local(&self, k: usize, s: f64) -> [[f64; 4]; 3] {
        let t = &self.knots[k + 1..k + 7];
        let [left1, left2, left3] = [s - t[2], s - t[1], s - t[0]];
        let [right1, right2, right3] = [t[3] - s, t[4] - s, t[5] - s];
        let w = 1.0 / (right1 + left1);
        let linear = [right1 * w, left1 * w];
        let [u0, u1] = [1.0 / (right1 + left2), 1.0 / (right2 + left1)];
        let quadratic = [
            right1 * u0 * linear[0],
            left2 * u0 * linear[0] + right2 * u1 * linear[1],
            left1 * u1 * linear[1],
        ];
        let v = [1.0 / (right1 + left3), 1.0 / (right2 + left2), 1.0 / (right3 + left1)];
        let value = [
            right1 * v[0] * quadratic[0],
            left3 * v[0] * quadratic[0] + right2 * v[1] * quadratic[1],
            left2 * v[1] * quadratic[1] + right3 * v[2] * quadratic[2],
            left1 * v[2] * quadratic[2],
        ];
        // derivatives of splines are differences of the splines one degree lower
        let difference = |lower: [f64; 3]| {
            let [d0, d1, d2] = [v[0] * lower[0], v[1] * lower[1], v[2] * lower[2]];
            [-d0, d0 - d1, d1 - d2, d2]
        };
        let slope = [-u0 * linear[0], u0 * linear[0] - u1 * linear[1], u1 * linear[1]];
        [
            value,
            difference(quadratic).map(|d| 1.5 * d),
            difference(slope).map(|d| 3.0 * d),
        ]
    }

    /// The first three coefficients at s₁, where a spline of order k is the first with a derivative of order k, so that
    /// they follow one from another.
    fn clamp_begin(&self) -> [f64; 2] {
        let [_, slope, bend] = self.local(0, self.nodes[1]);
        let [a, b, c] = rest::inner_end(self.nodes[1] - self.nodes[0], 1.0);
        let d1 = (b - slope[0] * a) / slope[1];
        let d2 = (c - bend[0] * a - bend[1] * d1) / bend[2];
        [a / d2, d1 / d2]
    }

    fn clamp_end(&self) -> [f64; 2] {
        let last = self.nodes.len() - 1;
        let [_, slope, bend] = self.local(self.spline().len() - 1, self.nodes[last - 1]);
        let [a, b, c] = rest::inner_end(self.nodes[last] - self.nodes[last - 1], -1.0);
        let d1 = (b - slope[3] * a) / slope[2];
        let d2 = (c - bend[3] * a - bend[2] * d1) / bend[1];
        [d1 / d2, a / d2]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_arms::random;

    fn uneven(count: usize) -> Vec<f64> {
        let state = &mut 5;
        let mut s = 0.0;
        std::iter::once(0.0)
            .chain((0..count).map(|_| {
                s += 1.0 + 0.8 * random(state);
                s
            }))
            .collect()
    }

    fn check_grid(count: usize, moving: Moving) {
        let basis = Basis::new(uneven(count), moving);
        let state = &mut 9;
        let x: Vec<f64> = (0..basis.unknown_count()).map(|_| 2.0 + random(state)).collect();
        let nodes = basis.nodes().to_vec();
        for interval in basis.spline() {
            let (s0, s1) = (nodes[interval], nodes[interval + 1]);
            let at = |s: f64| basis.form(interval, s).apply(&x);
            let [a0, b0, c0] = at(s0);
            let [a1, b1, c1] = at(s1);
            // the cubic that the value, slope and both bends make
            let h = s1 - s0;
            let cubic = a0 + 2.0 * b0 * h + c0 * h * h + (c1 - c0) / 3.0 * h * h;
            assert!((cubic - a1).abs() < 1e-12 * (1.0 + a1.abs()));
            let (mid, step) = (0.5 * (s0 + s1), 1e-4 * h);
            let [a, b, c] = at(mid);
            let [[am, bm, _], [ap, bp, _]] = [at(mid - step), at(mid + step)];
            assert!((b - (ap - am) / (4.0 * step)).abs() < 1e-6 * (1.0 + b.abs()));
            assert!((c - (bp - bm) / (2.0 * step)).abs() < 1e-6 * (1.0 + c.abs()));
            assert!(a > 0.0);
            if interval + 1 < basis.spline().end {
                let after = basis.form(interval + 1, s1).apply(&x);
                for (after, before) in after.into_iter().zip([a1, b1, c1]) {
                    assert!((after - before).abs() < 1e-11 * (1.0 + before.abs()));
                }
            }
        }
        let ends = [
            (1, nodes[1], nodes[1], 1.0, moving.start),
            (
                count - 2,
                nodes[count - 1],
                nodes[count] - nodes[count - 1],
                -1.0,
                moving.end,
            ),
        ];
        for (interval, s, h, direction, moves) in ends {
            if moves {
                let (interval, s, own) = if direction > 0.0 {
                    (0, nodes[0], x[0])
                } else {
                    (count - 1, nodes[count], x[x.len() - 1])
                };
                let [a, b, _] = basis.form(interval, s).apply(&x);
                assert!((a - own).abs() < 1e-12 * own && b.abs() < 1e-12 * own);
                continue;
            }
            let [a, b, c] = basis.form(interval, s).apply(&x);
            let expected = rest::inner_end(h, direction).map(|form| form * a);
            assert!((b - expected[1]).abs() < 1e-12 * a && (c - expected[2]).abs() < 1e-12 * a);
        }
    }

    /// Against differences in s, the cubic's closed form, continuity at nodes, and what is given at both ends.
    #[test]
    fn forms_are_one_smooth_spline() {
        for count in [7, 8, 9, 30] {
            for (start, end) in [(false, false), (true, false), (false, true), (true, true)] {
                check_grid(count, Moving { start, end });
            }
        }
    }

    /// A straight line has its own values as coefficients.
    #[test]
    fn centers_reproduce_a_line() {
        let basis = Basis::new(uneven(12), Moving::default());
        let x: Vec<f64> = basis.centers().map(|s| 1.0 + 0.5 * s).collect();
        let s = 0.4 * basis.nodes()[5] + 0.6 * basis.nodes()[6];
        let [a, b, c] = basis.form(5, s).apply(&x);
        assert!((a - 1.0 - 0.5 * s).abs() < 1e-13 && (b - 0.25).abs() < 1e-13 && c.abs() < 1e-12);
    }
}
