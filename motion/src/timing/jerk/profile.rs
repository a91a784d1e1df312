//! a(s) over a whole grid, from its values at the nodes: one cubic an interval, between the laws of constant jerk where an
//! end is at rest.
//!
//! c = a″/2 is linear from node to node, so with h the interval's length and x the distance from its beginning
//!
//! ```text
//! a = a₀ + 2·b₀·x + c₀·x² + (c₁ − c₀)/(3h)·x³      b = b₀ + c₀·x + (c₁ − c₀)/(2h)·x²      c = c₀ + (c₁ − c₀)/h·x
//! ```

use super::ends::Moving;
use super::rest;
use crate::timing::law::{Form, Piece, TimeLaw};

/// A motion over a grid.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Profile<'a> {
    pub(crate) nodes: &'a [f64],
    pub(crate) moving: Moving,
    /// (a, b, c) at s₁ … s_{N−1}, and at s₀ and s_N where the motion moves there.
    pub(crate) inner: Vec<[f64; 3]>,
}

impl Profile<'_> {
    pub(crate) fn interval_count(&self) -> usize {
        self.nodes.len() - 1
    }

    fn length(&self, interval: usize) -> f64 {
        self.nodes[interval + 1] - self.nodes[interval]
    }

    fn form(&self, interval: usize) -> Form {
        let last = self.inner.len() - 1;
        let spline = self.moving.spline_intervals(self.interval_count());
        if interval < spline.start {
            return Form::FromRest { end: self.inner[0][0] };
        }
        if interval >= spline.end {
            return Form::ToRest {
                begin: self.inner[last][0],
            };
        }
        let at = interval - spline.start;
        let [a, b, c] = self.inner[at];
        let rise = self.inner[at + 1][2] - c;
        Form::Polynomial([a, 2.0 * b, c, rise / (3.0 * self.length(interval))])
    }

    /// ṡ², s̈ and s⃛ at a part of an interval; ṡ² as the polynomial has it, positive or not.
    pub(crate) fn rates(&self, interval: usize, part: f64) -> [f64; 3] {
        let h = self.length(interval);
        let last = self.inner.len() - 1;
        let at_rest = |direction, a1, part| {
            let [sd, sdd, sddd] = rest::rates(h, direction, a1, part);
            [sd * sd, sdd, sddd]
        };
        let spline = self.moving.spline_intervals(self.interval_count());
        if interval < spline.start {
            return at_rest(1.0, self.inner[0][0], part);
        }
        if interval >= spline.end {
            return at_rest(-1.0, self.inner[last][0], 1.0 - part);
        }
        let at = interval - spline.start;
        let [a0, b0, c0] = self.inner[at];
        let rise = self.inner[at + 1][2] - c0;
        let x = part * h;
        let a = a0 + x * (2.0 * b0 + x * (c0 + rise * part / 3.0));
        let b = b0 + x * (c0 + 0.5 * rise * part);
        let c = c0 + rise * part;
        [a, b, c * a.max(0.0).sqrt()]
    }

    /// ṡ² anywhere between the ends.
    pub(crate) fn square(&self, s: f64) -> f64 {
        let last = self.interval_count() - 1;
        let interval = self.nodes.partition_point(|node| *node <= s).clamp(1, last + 1) - 1;
        let part = (s - self.nodes[interval]) / self.length(interval);
        self.rates(interval, part.clamp(0.0, 1.0))[0]
    }

    /// The motion in time; `None` where it would not end.
    pub(crate) fn law(&self) -> Option<TimeLaw> {
        let piece = |interval| Piece {
            begin: self.nodes[interval],
            end: self.nodes[interval + 1],
            form: self.form(interval),
        };
        TimeLaw::new((0..self.interval_count()).map(piece).collect())
    }
}
