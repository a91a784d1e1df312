//! What a timing takes of every limit, between its samples too.
//!
//! Each value (torque, speed, acceleration, jerk apart) is evaluated exactly at several points of every interval. Between
//! neighbouring ones it is taken for a cubic: a parabola, whose peak is at most |D₂|/8 above them, and a rest of at most
//! |D₃|/(9·√3), D₂ and D₃ being second and third differences. What is left out are fourth differences. Viscous torque goes with √a, which is no parabola near rest and
//! has a bound of its own. Coulomb torque jumps where a joint turns round; around such a
//! place both of its signs count. That of the load, κ·|g|, is as smooth as the gravity torque g with one sign or the other: the
//! bulges of both count, and around a place where g is zero the load may be nothing, too.

use super::coefficients::Coefficients;
use super::grid::Grid;
use super::limits::{Limits, Stretch};
use crate::budget::{Budget, Stopped};
use crate::path::outcome::PathLimit;
use crate::tolerance::{CERTIFIED, CHECK_PARTS};

/// Intervals between two looks at the budget.
const BUDGET_EVERY: usize = 64;

/// Points of an interval.
const POINTS: usize = CHECK_PARTS + 1;

/// The largest |t·(t² − 1)/6| for t in [0, 1], 1/(9·√3).
const CUBIC_REST: f64 = 0.064_150_029_909_958_42;

/// What a timing takes of one limit at one point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Use {
    pub(crate) kind: PathLimit,
    /// `None`: the tool's.
    pub(crate) joint: Option<usize>,
    pub(crate) interval: usize,
    /// Which point of the interval, from 0 to [`CHECK_PARTS`].
    pub(crate) part: usize,
    /// Magnitude, with what may be beyond it between the points. Of a torque, in the direction of its sign.
    pub(crate) value: f64,
    pub(crate) limit: f64,
    /// Of a torque: what gravity and Coulomb friction take in that direction; else 0.
    pub(crate) still: f64,
    /// Of a torque: what viscous friction takes in that direction; else 0.
    pub(crate) viscous: f64,
}

impl Use {
    fn plain(kind: PathLimit, joint: Option<usize>, [interval, part]: [usize; 2], value: f64, limit: f64) -> Self {
        Self {
            kind,
            joint,
            interval,
            part,
            value,
            limit,
            still: 0.0,
            viscous: 0.0,
        }
    }

    /// Part of the limit.
    pub(crate) fn ratio(&self) -> f64 {
        self.value / self.limit
    }
}

/// Points of a path at which timings are checked.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Certificate<'a> {
    /// Its samples divide each interval into [`CHECK_PARTS`].
    pub(crate) grid: &'a Grid,
    pub(crate) coefficients: &'a Coefficients,
    pub(crate) limits: &'a Limits,
}

/// One interval's values of a and b at its points.
struct Rates {
    a: [f64; POINTS],
    b: [f64; POINTS],
    root: [f64; POINTS],
}

impl Certificate<'_> {
    /// Looks at every limit on every interval; `rates` is a and b at a point of an interval. `visit` sees the use of every
    /// limit in the middle of each interval, and elsewhere every use above [`CERTIFIED`].
    ///
    /// # Errors
    /// [`Stopped`], when nobody waits any more.
    pub(crate) fn visit(
        &self,
        rates: &dyn Fn(usize, usize) -> [f64; 2],
        budget: &Budget<'_>,
        visit: &mut dyn FnMut(&Use),
    ) -> Result<(), Stopped> {
        for interval in 0..self.grid.interval_count() {
            if interval % BUDGET_EVERY == 0 {
                budget.check()?;
            }
            let mut at = Rates {
                a: [0.0; POINTS],
                b: [0.0; POINTS],
                root: [0.0; POINTS],
            };
            for part in 0..POINTS {
                [at.a[part], at.b[part]] = rates(interval, part);
                at.root[part] = at.a[part].sqrt();
            }
            // borders of stretches are nodes: the last point belongs to the stretch of the others
            let stretch = &self.limits.stretches[self.coefficients.stretch[self.grid.first[interval]]];
            for joint in 0..self.coefficients.joint_count {
                self.visit_joint(interval, joint, stretch, &at, visit);
            }
            self.visit_tool(interval, stretch, &at, visit);
        }
        Ok(())
    }

    fn visit_joint(&self, interval: usize, joint: usize, stretch: &Stretch, at: &Rates, visit: &mut dyn FnMut(&Use)) {
        let limits = &stretch.joints[joint];
        let begin = joint * self.coefficients.stride + self.grid.first[interval];
        let column = |column: &[f64]| -> [f64; POINTS] { std::array::from_fn(|part| column[begin + part]) };
        let terms = &self.coefficients.terms;
        let first = column(&terms.first);
        let plain = |kind, part, value, limit| Use::plain(kind, Some(joint), [interval, part], value, limit);
        if let Some(limit) = limits.velocity {
            let values: [f64; POINTS] = std::array::from_fn(|part| first[part] * at.root[part]);
            for (part, value) in noteworthy(&magnitudes(&values), limit) {
                visit(&plain(PathLimit::Velocity, part, value, limit));
            }
        }
        if let Some(limit) = limits.acceleration {
            let second = column(&terms.second);
            let values: [f64; POINTS] =
                std::array::from_fn(|part| first[part] * at.b[part] + second[part] * at.a[part]);
            for (part, value) in noteworthy(&magnitudes(&values), limit) {
                visit(&plain(PathLimit::Acceleration, part, value, limit));
            }
        }
        let Some(limit) = limits.torque else { return };
        let (mass, velocity, gravity) = (column(&terms.mass), column(&terms.velocity), column(&terms.gravity));
        let viscous = column(&self.coefficients.viscous);
        let smooth: [f64; POINTS] =
            std::array::from_fn(|part| mass[part] * at.b[part] + velocity[part] * at.a[part] + gravity[part]);
        let values = std::array::from_fn(|part| smooth[part] + viscous[part] * at.root[part]);
        let mut bulge = larger(bulges(&values), bulges_with_root(&smooth, &viscous, &at.root));
        let load = self.coefficients.load_coulomb[joint];
        if load != 0.0 {
            for sign in [load, -load] {
                let loaded = |values: &[f64; POINTS]| std::array::from_fn(|part| values[part] + sign * gravity[part]);
                let with_root = bulges_with_root(&loaded(&smooth), &viscous, &at.root);
                bulge = larger(bulge, larger(bulges(&loaded(&values)), with_root));
            }
        }
        let [above, below] = bulge;
        let coulomb = [
            column(&self.coefficients.coulomb_high),
            column(&self.coefficients.coulomb_low),
        ];
        let up: [f64; POINTS] = std::array::from_fn(|part| values[part] + above[part] + coulomb[0][part]);
        let down: [f64; POINTS] = std::array::from_fn(|part| below[part] - values[part] - coulomb[1][part]);
        let more = std::array::from_fn(|part| up[part].max(down[part]));
        for (part, value) in noteworthy(&more, limit) {
            let sign = if up[part] >= down[part] { 1.0 } else { -1.0 };
            let side = if sign > 0.0 { 0 } else { 1 };
            visit(&Use {
                still: sign * (gravity[part] + coulomb[side][part]),
                viscous: sign * viscous[part] * at.root[part],
                ..plain(PathLimit::Torque, part, value, limit)
            });
        }
    }

    fn visit_tool(&self, interval: usize, stretch: &Stretch, at: &Rates, visit: &mut dyn FnMut(&Use)) {
        let begin = self.grid.first[interval];
        let plain = |kind, part, value, limit| Use::plain(kind, None, [interval, part], value, limit);
        let length = |v: [f64; 3]| (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
        if let Some(limit) = stretch.tool_velocity {
            let values: [f64; POINTS] =
                std::array::from_fn(|part| length(self.coefficients.tool_first(begin + part)) * at.root[part]);
            for (part, value) in noteworthy(&magnitudes(&values), limit) {
                visit(&plain(PathLimit::ToolVelocity, part, value, limit));
            }
        }
        if let Some(limit) = stretch.tool_acceleration {
            let values: [f64; POINTS] = std::array::from_fn(|part| {
                let first = self.coefficients.tool_first(begin + part);
                let second = self.coefficients.tool_second(begin + part);
                length(std::array::from_fn(|axis| {
                    first[axis] * at.b[part] + second[axis] * at.a[part]
                }))
            });
            for (part, value) in noteworthy(&magnitudes(&values), limit) {
                visit(&plain(PathLimit::ToolAcceleration, part, value, limit));
            }
        }
    }
}

/// The points in the middle of an interval and those where a value is above what is certified.
fn noteworthy(values: &[f64; POINTS], limit: f64) -> impl Iterator<Item = (usize, f64)> {
    let worth = move |(part, value): &(usize, f64)| *part == CHECK_PARTS / 2 || *value > CERTIFIED * limit;
    values.iter().copied().enumerate().filter(worth)
}

/// By how much values may be above, and below, what they are at the points: the bulge of the cubics nearby.
fn bulges(values: &[f64; POINTS]) -> [[f64; POINTS]; 2] {
    let mut bend = [0.0; POINTS];
    for part in 1..POINTS - 1 {
        bend[part] = (values[part - 1] - 2.0 * values[part] + values[part + 1]) / 8.0;
    }
    let mut skew: f64 = 0.0;
    for part in 1..POINTS - 2 {
        skew = skew.max(8.0 * CUBIC_REST * (bend[part + 1] - bend[part]).abs());
    }
    (bend[0], bend[POINTS - 1]) = (bend[1], bend[POINTS - 2]);
    let near = |part: usize| bend[part.saturating_sub(1)..(part + 2).min(POINTS)].iter();
    [
        std::array::from_fn(|part| skew - near(part).fold(0.0, |least: f64, bend| least.min(*bend))),
        std::array::from_fn(|part| skew + near(part).fold(0.0, |most: f64, bend| most.max(*bend))),
    ]
}

/// The bulges of `smooth + factor·√a` near rest, where √a is far from a parabola. Between two points it is above its chord by
/// at most (r₁ − r₀)²/(4·(r₀ + r₁)), the r being its values there and a being linear.
fn bulges_with_root(smooth: &[f64; POINTS], factor: &[f64; POINTS], root: &[f64; POINTS]) -> [[f64; POINTS]; 2] {
    let mut all = bulges(smooth);
    for part in 0..POINTS - 1 {
        let (step, sum) = (root[part + 1] - root[part], root[part + 1] + root[part]);
        if sum <= 0.0 {
            continue;
        }
        let rise = step * step / (4.0 * sum);
        let most = factor[part].abs().max(factor[part + 1].abs()) * rise;
        // a positive factor bulges up, a negative one down
        let side = &mut all[usize::from(factor[part] < 0.0)];
        side[part] += most;
        side[part + 1] += most;
    }
    all
}

fn larger(a: [[f64; POINTS]; 2], b: [[f64; POINTS]; 2]) -> [[f64; POINTS]; 2] {
    std::array::from_fn(|side| std::array::from_fn(|part| a[side][part].max(b[side][part])))
}

/// Magnitudes with their bulges.
fn magnitudes(values: &[f64; POINTS]) -> [f64; POINTS] {
    let [above, below] = bulges(values);
    std::array::from_fn(|part| (values[part] + above[part]).max(below[part] - values[part]))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The true peak of a curve between its points is within what is stated, and not far below.
    #[test]
    fn bulges_cover_peaks_between_points() {
        for shift in 0..20 {
            let angle = |x: f64| 0.9 + (x + f64::from(shift) / 20.0) * 0.13;
            let values = std::array::from_fn(|part| angle(part as f64).sin());
            let stated = magnitudes(&values).into_iter().fold(0.0, f64::max);
            let last = (POINTS - 1) as f64;
            let true_peak = (0..=1000)
                .map(|k| angle(last * f64::from(k) / 1000.0).sin())
                .fold(0.0, f64::max);
            assert!(
                stated >= true_peak - 1e-6 && stated < true_peak + 0.005,
                "{stated} {true_peak}"
            );
        }
    }
}
