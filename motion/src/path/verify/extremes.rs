//! Maxima between samples, by branch and bound: found to within [`EXTREME_GAIN`] of the limit, not by luck.
//!
//! Between two samples of a smooth f, h apart, the chord is below f by at most h²·max|f″|/8, so
//!
//! ```text
//! f ≤ max(f₀, f₁) + h²·max|f″|/8        h²·f″ ≈ f₋ − 2f + f₊
//! ```
//!
//! with the largest second difference around, and [`BEND_RESERVE`] times as much for how f″ varies in between. Of all
//! stretches of a motion whose bound is above the largest value that is known, the one with the highest is halved, until
//! none is left. Halving quarters the bend, so a smooth maximum takes a handful of rounds, and a stretch without it is
//! dropped after one or two.
//!
//! Coulomb friction makes a torque jump where its joint turns back. Without friction, with it forwards and with it
//! backwards, the torque is smooth: each stretch is bounded by those of the three that hold at its ends, by both ways
//! where the joint turns back or may turn twice between them, and halving closes in on where it does.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use crate::budget::{Budget, Stopped};
use crate::tolerance::{BUDGET_STRIDE, EXTREME_GAIN, EXTREME_STEPS};

/// How much larger than the second differences around it a second derivative may be between two samples.
const BEND_RESERVE: f64 = 2.0;

/// What a bend shrinks to at most when a stretch is halved: a second difference that happens to vanish, at a point of
/// inflection, says nothing of its surroundings.
const BEND_SHRINK: f64 = 0.125;

/// One moment of a value that is limited, as part of the limit.
#[derive(Debug, Clone, Copy)]
pub(super) struct Node {
    pub(super) time: f64,
    /// With friction against a motion backwards, without friction, and with it against a motion forwards; all the same
    /// where friction has no part in it.
    pub(super) parts: [f64; 3],
    /// Which of them holds: [`way`].
    pub(super) way: usize,
    /// q̇ and q̈ of the joint whose friction it is; 0 where it is none's.
    pub(super) rates: [f64; 2],
}

/// The part of [`Node::parts`] that holds for a direction.
pub(super) fn way(direction: f64) -> usize {
    match direction {
        direction if direction > 0.0 => 2,
        direction if direction < 0.0 => 0,
        _ => 1,
    }
}

/// Two neighbouring moments, between which the value is smooth but for friction.
#[derive(Debug, Clone, Copy)]
pub(super) struct Span {
    pub(super) ends: [Node; 2],
    /// The largest second difference around, over the span's own length.
    pub(super) bend: f64,
    /// The limit in force.
    pub(super) limit: f64,
}

impl Span {
    /// The most that the value can be; `size` says what counts of a part.
    pub(super) fn bound(&self, size: impl Fn(f64) -> f64) -> f64 {
        let [from, to] = &self.ends;
        let turns = self.may_turn_twice();
        let holds = |way: usize| way == from.way || way == to.way || (turns && way != 1);
        let most = |way: usize| size(from.parts[way]).max(size(to.parts[way]));
        let top = (0..3)
            .filter(|way| holds(*way))
            .map(most)
            .fold(f64::NEG_INFINITY, f64::max);
        top + BEND_RESERVE * self.bend / 8.0
    }

    /// Whether a joint that moves the same way at both ends slows down from the one and speeds up towards the other so
    /// hard that it may have turned back and forth: the tangents of its velocity meet beyond standstill.
    fn may_turn_twice(&self) -> bool {
        let [from, to] = &self.ends;
        let ([v0, a0], [v1, a1]) = (from.rates, to.rates);
        if v0 * v1 <= 0.0 || v0 * a0 >= 0.0 || v1 * a1 <= 0.0 {
            return false;
        }
        let length = to.time - from.time;
        let meets = (v1 - a1 * length - v0) / (a0 - a1);
        (v0 + a0 * meets) * v0 <= 0.0
    }

    fn halves(&self, middle: Node) -> [Self; 2] {
        let [from, to] = self.ends;
        let bends = (0..3).map(|way| (from.parts[way] - 2.0 * middle.parts[way] + to.parts[way]).abs());
        let bend = bends.fold(BEND_SHRINK * self.bend, f64::max);
        [[from, middle], [middle, to]].map(|ends| Self { ends, bend, ..*self })
    }
}

/// A span that is still open, by its bound.
struct Open {
    bound: f64,
    span: Span,
}

impl Ord for Open {
    fn cmp(&self, other: &Self) -> Ordering {
        self.bound.total_cmp(&other.bound)
    }
}

impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Open {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Open {}

/// Looks for values above `known` between samples. `evaluate` gives the value at a moment of a span, and keeps it where
/// it is the largest; `size` says what counts of a part.
///
/// # Errors
/// [`Stopped`], when nobody waits any more.
pub(super) fn search(
    spans: Vec<Span>,
    mut known: f64,
    size: impl Fn(f64) -> f64,
    mut evaluate: impl FnMut(&Span, f64) -> Node,
    budget: &Budget<'_>,
) -> Result<(), Stopped> {
    let open = |span: Span| Open {
        bound: span.bound(&size),
        span,
    };
    let mut heap: BinaryHeap<Open> = spans.into_iter().map(open).collect();
    for step in 0..EXTREME_STEPS {
        let Some(Open { bound, span }) = heap.pop() else { break };
        // not a number is no bound either
        if bound.is_nan() || bound <= known + EXTREME_GAIN {
            break;
        }
        if step % BUDGET_STRIDE == 0 {
            budget.check()?;
        }
        let [from, to] = span.ends.map(|node| node.time);
        let time = 0.5 * (from + to);
        if time <= from || time >= to {
            continue;
        }
        let middle = evaluate(&span, time);
        known = known.max(size(middle.parts[middle.way]));
        heap.extend(span.halves(middle).map(open));
    }
    Ok(())
}

#[cfg(test)]
mod tests;
