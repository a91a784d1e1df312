//! Which squared path velocities can be had at all: time-optimal path parameterization by reachability analysis
//! (TOPP-RA, Pham and Pham 2018).
//!
//! On an interval of length h the path acceleration b is constant, so a at distance θ·h is a + 2·θ·h·b, and a row that
//! holds there reads
//!
//! ```text
//! α·(a + 2·θ·h·b) + β·b ≤ γ
//! ```
//!
//! Backwards from the end, the set of all a from which the rest of the path can be done is an interval; its borders are
//! those of the a with lower(a) ≤ upper(a), where every row bounds b by a line in a. Forwards from the start, the largest b
//! that stays within these sets is the fastest timing.

use super::grid::Grid;
use super::rows::Rows;
use crate::budget::{Budget, Stopped};
use crate::tolerance::{REACH_ROUNDS, REACH_ROW_FLAT, REACH_WIDTH};

/// Intervals between two looks at the budget.
const BUDGET_EVERY: usize = 64;

/// Why no timing was found: a speed at an end of the path cannot be had.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Unreachable {
    /// The end cannot be reached as fast as is asked.
    End,
    /// The start is too fast for what follows.
    Start {
        /// The largest a that is not.
        largest: f64,
    },
}

/// Lines at_rest − slope·a, filled up to whole groups with lines that are infinite.
#[derive(Debug, Default)]
struct Lines {
    at_rest: Vec<f64>,
    slope: Vec<f64>,
    count: usize,
}

/// Lines that are compared side by side.
const GROUP: usize = 4;

impl Lines {
    /// Room for so many.
    fn with_room(most: usize) -> Self {
        let entries = most.next_multiple_of(GROUP);
        Self {
            at_rest: vec![f64::INFINITY; entries],
            slope: vec![0.0; entries],
            count: 0,
        }
    }

    #[inline]
    fn push(&mut self, at_rest: f64, slope: f64) {
        self.at_rest[self.count] = at_rest;
        self.slope[self.count] = slope;
        self.count += 1;
    }

    /// Fills up the last group.
    fn finish(&mut self) {
        while !self.count.is_multiple_of(GROUP) {
            self.push(f64::INFINITY, 0.0);
        }
    }

    fn lowest(&self, a: f64) -> (f64, f64) {
        lowest(&self.at_rest[..self.count], &self.slope[..self.count], a)
    }
}

/// The smallest of lines at a, and its slope.
fn lowest(at_rest: &[f64], slope: &[f64], a: f64) -> (f64, f64) {
    let mut values = [f64::INFINITY; GROUP];
    let mut slopes = [0.0; GROUP];
    for (at_rest, slope) in at_rest.chunks_exact(GROUP).zip(slope.chunks_exact(GROUP)) {
        for lane in 0..GROUP {
            let here = at_rest[lane] - slope[lane] * a;
            let less = here < values[lane];
            values[lane] = if less { here } else { values[lane] };
            slopes[lane] = if less { slope[lane] } else { slopes[lane] };
        }
    }
    let mut best = (values[0], slopes[0]);
    for lane in 1..GROUP {
        if values[lane] < best.0 {
            best = (values[lane], slopes[lane]);
        }
    }
    best
}

/// What bounds b on one interval.
#[derive(Debug)]
struct Interval {
    /// b ≤ each of these.
    upper: Lines,
    /// −b ≤ each of these.
    lower: Lines,
    /// Largest a.
    cap: f64,
}

impl Interval {
    /// α·a + β·b ≤ γ.
    #[inline]
    fn push(&mut self, alpha: f64, beta: f64, gamma: f64) {
        if beta.abs() > REACH_ROW_FLAT * gamma {
            let scale = 1.0 / beta.abs();
            let lines = if beta > 0.0 { &mut self.upper } else { &mut self.lower };
            lines.push(gamma * scale, alpha * scale);
        } else if alpha > 0.0 {
            self.cap = self.cap.min(gamma / alpha);
        }
    }

    /// Rows of all places of an interval. The last one's a is not bounded here: what can be had there is.
    fn fill(&mut self, grid: &Grid, rows: &Rows<'_>, interval: usize) {
        (self.upper.count, self.lower.count) = (0, 0);
        let (first, parts) = (rows.places.first[interval], rows.places.parts);
        self.cap = rows.speed_bound[first];
        let step = 2.0 * grid.step(interval) / parts as f64;
        for part in 0..=parts {
            let reach = step * part as f64;
            for pair in rows.at(first + part) {
                self.push(pair.a[0], pair.b + reach * pair.a[0], pair.c[0]);
                self.push(pair.a[1], reach * pair.a[1] - pair.b, pair.c[1]);
            }
            if part > 0 && part < parts {
                // 0 ≤ a + reach·b ≤ bound
                let scale = 1.0 / reach;
                self.upper.push(rows.speed_bound[first + part] * scale, scale);
                self.lower.push(0.0, -scale);
            }
        }
    }

    /// Ends within [low, high].
    fn end_within(&mut self, step: f64, [low, high]: [f64; 2]) {
        let scale = 1.0 / (2.0 * step);
        self.upper.push(high * scale, scale);
        self.lower.push(-low * scale, -scale);
        self.upper.finish();
        self.lower.finish();
    }

    /// The border of {a: lower(a) ≤ upper(a)} that is met first from outside, from the right or from the left. The width
    /// upper − lower is concave and made of lines, so that Newton's method arrives after finitely many, one-sided steps.
    fn border(&self, from: f64, from_right: bool) -> Option<f64> {
        let mut a = from;
        for _ in 0..REACH_ROUNDS {
            let (upper, falls) = self.upper.lowest(a);
            let (lower, rises) = self.lower.lowest(a);
            let width = upper + lower;
            // scaled by the terms that cancel, not by what they leave
            if width >= -REACH_WIDTH * (upper.abs() + (falls * a).abs() + lower.abs() + (rises * a).abs()) {
                return Some(a);
            }
            let slope = -rises - falls;
            if (slope >= 0.0) == from_right {
                return None;
            }
            a -= width / slope;
            if a < 0.0 {
                return None;
            }
        }
        Some(a)
    }
}

/// The fastest a at every node, from `ends[0]` at the start to `ends[1]` at the end.
///
/// # Errors
/// [`Stopped`], when nobody waits any more.
pub(crate) fn fastest(
    grid: &Grid,
    rows: &Rows<'_>,
    ends: [f64; 2],
    budget: &Budget<'_>,
) -> Result<Result<Vec<f64>, Unreachable>, Stopped> {
    let count = grid.interval_count();
    let at_end = rows.speed_bound.last().copied().unwrap_or(0.0);
    if ends[1] > at_end {
        return Ok(Err(Unreachable::End));
    }
    let mut sets = vec![[ends[1]; 2]; count + 1];
    // the upper lines of every interval, and where each one's begin: for the way forwards
    let most = rows.lines_of_interval();
    let mut interval = Interval {
        upper: Lines::with_room(most),
        lower: Lines::with_room(most),
        cap: 0.0,
    };
    let (mut kept_at_rest, mut kept_slope) = (Vec::new(), Vec::new());
    let mut ranges = vec![0..0; count];
    for i in (0..count).rev() {
        if i % BUDGET_EVERY == 0 {
            budget.check()?;
        }
        interval.fill(grid, rows, i);
        interval.end_within(grid.step(i), sets[i + 1]);
        // the place before a node may be bound more tightly than the one after it
        let high = match i.checked_sub(1) {
            Some(before) => interval
                .cap
                .min(rows.speed_bound[rows.places.first[before] + rows.places.parts]),
            None => interval.cap,
        };
        let Some(high) = interval.border(high, true) else {
            return Ok(Err(Unreachable::End));
        };
        let low = if sets[i + 1][0] > 0.0 {
            interval.border(0.0, false).unwrap_or(high).min(high)
        } else {
            0.0
        };
        sets[i] = [low, high];
        let (begin, lines) = (kept_slope.len(), interval.upper.count);
        kept_at_rest.extend_from_slice(&interval.upper.at_rest[..lines]);
        kept_slope.extend_from_slice(&interval.upper.slope[..lines]);
        ranges[i] = begin..begin + lines;
    }
    let [low, high] = sets[0];
    if ends[0] > high {
        return Ok(Err(Unreachable::Start { largest: high }));
    }
    if ends[0] < low {
        return Ok(Err(Unreachable::End));
    }
    let mut squares = vec![ends[0]; count + 1];
    for i in 0..count {
        let range = ranges[i].clone();
        let (b, _) = lowest(&kept_at_rest[range.clone()], &kept_slope[range], squares[i]);
        let [low, high] = sets[i + 1];
        squares[i + 1] = (squares[i] + 2.0 * grid.step(i) * b).max(low).min(high);
    }
    Ok(Ok(squares))
}
