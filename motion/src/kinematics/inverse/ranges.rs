//! Joint ranges, and the whole turns that lead into them.

use std::f64::consts::TAU;

use crate::robot::Robot;
use crate::robot::spec::JointKind;
use crate::tolerance::{IK_COPIES_MAX, IK_DISTINCT, IK_RANGE_SLACK};

/// The range of one joint; infinite where it is not limited.
#[derive(Debug, Clone, Copy)]
pub(super) struct Range {
    turns: bool,
    pub(super) lower: f64,
    pub(super) upper: f64,
}

pub(super) fn of_robot(robot: &Robot) -> Vec<Range> {
    let joints = robot.spec().joints.iter();
    joints
        .map(|joint| Range {
            turns: joint.kind != JointKind::Prismatic,
            lower: joint.limits.position_lower.unwrap_or(f64::NEG_INFINITY),
            upper: joint.limits.position_upper.unwrap_or(f64::INFINITY),
        })
        .collect()
}

impl Range {
    /// The middle; of a range without end 0, or the end that it has.
    pub(super) fn middle(&self) -> f64 {
        match (self.lower.is_finite(), self.upper.is_finite()) {
            (true, true) => 0.5 * (self.lower + self.upper),
            (true, false) => self.lower.max(0.0),
            (false, true) => self.upper.min(0.0),
            (false, false) => 0.0,
        }
    }

    /// A place in it for x in [0, 1); `reach` is how far a range without end is used to either side.
    pub(super) fn at(&self, x: f64, reach: f64) -> f64 {
        let middle = self.middle();
        let reach = if self.turns { 0.5 * TAU } else { reach };
        // whole turns change nothing: one turn about the middle has every place of a wider range
        let lower = if self.turns || !self.lower.is_finite() {
            self.lower.max(middle - reach)
        } else {
            self.lower
        };
        let upper = if self.turns || !self.upper.is_finite() {
            self.upper.min(middle + reach)
        } else {
            self.upper
        };
        lower + x * (upper - lower)
    }

    /// How far outside `q` is; 0 inside.
    pub(super) fn excess(&self, q: f64) -> f64 {
        (self.lower - q).max(q - self.upper).max(0.0)
    }

    /// The same place within the range, whole turns away and nearest to `reference`; else what comes nearest to the
    /// range. What is outside by rounding is put onto the end.
    pub(super) fn fit(&self, q: f64, reference: f64) -> f64 {
        if !self.turns {
            return self.snapped(q);
        }
        let near = nearest_turn(q, reference);
        if self.snapped_excess(near) == 0.0 {
            return self.snapped(near);
        }
        // one turn inside of the end that is passed, as near to the reference as the range allows
        let inner = if near > self.upper {
            near - TAU * ((near - self.upper - IK_RANGE_SLACK) / TAU).ceil()
        } else {
            near + TAU * ((self.lower - near - IK_RANGE_SLACK) / TAU).ceil()
        };
        let beyond = if near > self.upper { inner + TAU } else { inner - TAU };
        if self.excess(inner) <= self.excess(beyond) {
            return self.snapped(inner);
        }
        beyond
    }

    /// Every place within the range that is whole turns from `q`, nearest to `q` first; `q` alone where it is outside,
    /// slides, or has no end.
    pub(super) fn copies(&self, q: f64) -> Vec<f64> {
        let is_bounded = self.lower.is_finite() && self.upper.is_finite();
        if !self.turns || !is_bounded || self.excess(q) > 0.0 {
            return vec![q];
        }
        let inside = |turns: usize, sign: f64| {
            let copy = q + sign * turns as f64 * TAU;
            (self.snapped_excess(copy) == 0.0).then(|| self.snapped(copy))
        };
        let mut copies = vec![q];
        for turns in 1..=IK_COPIES_MAX {
            let [below, above] = [inside(turns, -1.0), inside(turns, 1.0)];
            copies.extend(below);
            copies.extend(above);
            if below.is_none() && above.is_none() {
                break;
            }
        }
        copies
    }

    /// `q`, or the end of the range that it passes by rounding alone.
    fn snapped(&self, q: f64) -> f64 {
        if self.excess(q) > 0.0 && self.snapped_excess(q) == 0.0 {
            return q.max(self.lower).min(self.upper);
        }
        q
    }

    /// The excess that is more than rounding.
    fn snapped_excess(&self, q: f64) -> f64 {
        let excess = self.excess(q);
        if excess <= IK_RANGE_SLACK { 0.0 } else { excess }
    }
}

/// `q` moved by whole turns to within half a turn of `reference`.
pub(super) fn nearest_turn(q: f64, reference: f64) -> f64 {
    q - TAU * ((q - reference) / TAU).round()
}

/// The first joint of those furthest outside their ranges, if any is.
pub(super) fn worst(ranges: &[Range], q: &[f64]) -> Option<usize> {
    let excess = |j: usize| ranges[j].excess(q[j]);
    let worst = (0..q.len()).fold(0, |worst, j| if excess(j) > excess(worst) { j } else { worst });
    (excess(worst) > 0.0).then_some(worst)
}

/// Moves every joint by whole turns into its range, nearest to the reference.
pub(super) fn fit(ranges: &[Range], q: &mut [f64], reference: &[f64]) {
    for ((q, range), &reference) in q.iter_mut().zip(ranges).zip(reference) {
        *q = range.fit(*q, reference);
    }
}

/// Puts joints that are outside their ranges by rounding onto the end.
pub(super) fn snap(ranges: &[Range], q: &mut [f64]) {
    for (q, range) in q.iter_mut().zip(ranges) {
        *q = range.snapped(*q);
    }
}

/// Moves every joint that turns to within half a turn of the reference, whatever its range.
pub(super) fn unwind(ranges: &[Range], q: &mut [f64], reference: &[f64]) {
    for ((q, range), &reference) in q.iter_mut().zip(ranges).zip(reference) {
        if range.turns {
            *q = nearest_turn(*q, reference);
        }
    }
}

/// Whether two positions are one, whole turns left out.
pub(super) fn is_same(ranges: &[Range], a: &[f64], b: &[f64]) -> bool {
    ranges.iter().zip(a).zip(b).all(|((range, &a), &b)| {
        let b = if range.turns { nearest_turn(b, a) } else { b };
        (a - b).abs() < IK_DISTINCT
    })
}

/// Every solution with its copies by whole turns, at most [`IK_COPIES_MAX`] in all; each solution itself comes first.
pub(super) fn with_copies(ranges: &[Range], solutions: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let mut listed = solutions.to_vec();
    for solution in solutions {
        let copies: Vec<Vec<f64>> = ranges.iter().zip(solution).map(|(range, &q)| range.copies(q)).collect();
        // an odometer over the joints' copies
        let mut digits = vec![0; copies.len()];
        while advance(&mut digits, &copies) {
            if listed.len() >= IK_COPIES_MAX {
                return listed;
            }
            listed.push(
                digits
                    .iter()
                    .zip(&copies)
                    .map(|(&digit, copies)| copies[digit])
                    .collect(),
            );
        }
    }
    listed
}

/// The next combination; false after the last.
fn advance(digits: &mut [usize], copies: &[Vec<f64>]) -> bool {
    for (digit, copies) in digits.iter_mut().zip(copies) {
        *digit += 1;
        if *digit < copies.len() {
            return true;
        }
        *digit = 0;
    }
    false
}
