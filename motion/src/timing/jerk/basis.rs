//! a(s) = ṡ² as a cubic B-spline between the two laws of constant jerk at rest.
//!
//! Nodes s₀ … s_N. On [s₁, s_{N−1}], with knots {s₁ ×4, s₂ … s_{N−2}, s_{N−1} ×4}, a(s) = Σ dᵢ·Bᵢ(s) with N + 1
//! coefficients. So s̈ = b = a′/2 and c = s⃛/ṡ = a″/2 are continuous and c is piecewise linear: jerk can follow a path
//! whose third derivative moves within an interval. The first three coefficients follow from a₁ and the last three from
//! a_{N−1} through [`super::rest`]; so x = d₂ … d_{N−2} are the unknowns. (Cox 1972, de Boor 1972.)

use super::rest;

/// Fewest intervals of a grid: below, four neighbouring unknowns are more than there are.
pub(crate) const INTERVALS_MIN: usize = 7;

/// The spline space over one grid.
#[derive(Debug)]
pub(crate) struct Basis {
    nodes: Vec<f64>,
    knots: Vec<f64>,
    /// d₀/d₂ and d₁/d₂.
    begin: [f64; 2],
    /// d_{N−1}/d_{N−2} and d_N/d_{N−2}.
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
    pub(crate) fn new(nodes: Vec<f64>) -> Self {
        let last = nodes.len() - 1;
        debug_assert!(last >= INTERVALS_MIN, "a window of four unknowns");
        let mut knots = vec![nodes[1]; 3];
        knots.extend_from_slice(&nodes[1..last]);
        knots.extend([nodes[last - 1]; 3]);
        let mut basis = Self {
            nodes,
            knots,
            begin: [0.0; 2],
            end: [0.0; 2],
        };
        basis.begin = basis.clamp_begin();
        basis.end = basis.clamp_end();
        basis
    }

    pub(crate) fn nodes(&self) -> &[f64] {
        &self.nodes
    }

    pub(crate) fn unknown_count(&self) -> usize {
        self.nodes.len() - 4
    }

    /// Where each unknown acts on average (Greville 1967): a smooth function's values there are close to its
    /// coefficients.
    pub(crate) fn centers(&self) -> impl Iterator<Item = f64> + '_ {
        (2..2 + self.unknown_count()).map(|i| (self.knots[i + 1] + self.knots[i + 2] + self.knots[i + 3]) / 3.0)
    }

    /// The form at `s` in the interval from node `interval` to the next; neither the first nor the last interval.
    pub(crate) fn form(&self, interval: usize, s: f64) -> Form {
        let (last, unknowns) = (self.nodes.len() - 1, self.unknown_count());
        let first = interval - 1;
        let base = first.saturating_sub(2).min(unknowns - 4);
        let mut rows = [[0.0; 4]; 3];
        for (row, values) in rows.iter_mut().zip(self.local(first, s)) {
            for (r, value) in values.into_iter().enumerate() {
                let (unknown, factor) = match first + r {
                    i @ (0 | 1) => (0, self.begin[i]),
                    i if i <= last - 2 => (i - 2, 1.0),
                    i => (unknowns - 1, self.end[i + 1 - last]),
                };
                row[unknown - base] += factor * value;
            }
        }
        Form { base, rows }
    }

    /// a, a′/2 and a″/2 of the four splines that are not 0 on knot interval `k`, from node `k` + 1 to the next.
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
        let [_, slope, bend] = self.local(last - 3, self.nodes[last - 1]);
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

    fn check_grid(count: usize) {
        let basis = Basis::new(uneven(count));
        let state = &mut 9;
        let x: Vec<f64> = (0..basis.unknown_count()).map(|_| 2.0 + random(state)).collect();
        let nodes = basis.nodes().to_vec();
        for interval in 1..count - 1 {
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
            if interval + 1 < count - 1 {
                let after = basis.form(interval + 1, s1).apply(&x);
                for (after, before) in after.into_iter().zip([a1, b1, c1]) {
                    assert!((after - before).abs() < 1e-11 * (1.0 + before.abs()));
                }
            }
        }
        let ends = [
            (1, nodes[1], nodes[1], 1.0),
            (count - 2, nodes[count - 1], nodes[count] - nodes[count - 1], -1.0),
        ];
        for (interval, s, h, direction) in ends {
            let [a, b, c] = basis.form(interval, s).apply(&x);
            let expected = rest::inner_end(h, direction).map(|form| form * a);
            assert!((b - expected[1]).abs() < 1e-12 * a && (c - expected[2]).abs() < 1e-12 * a);
        }
    }

    /// Against differences in s, the cubic's closed form, continuity at nodes, and the laws at both ends.
    #[test]
    fn forms_are_one_smooth_spline() {
        for count in [7, 8, 9, 30] {
            check_grid(count);
        }
    }

    /// A straight line has its own values as coefficients.
    #[test]
    fn centers_reproduce_a_line() {
        let basis = Basis::new(uneven(12));
        let x: Vec<f64> = basis.centers().map(|s| 1.0 + 0.5 * s).collect();
        let s = 0.4 * basis.nodes()[5] + 0.6 * basis.nodes()[6];
        let [a, b, c] = basis.form(5, s).apply(&x);
        assert!((a - 1.0 - 0.5 * s).abs() < 1e-13 && (b - 0.25).abs() < 1e-13 && c.abs() < 1e-12);
    }
}
