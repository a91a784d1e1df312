//! How much of every limit a profile uses, between samples too.
//!
//! Each interval (each part of it, where a knot is inside) has eight points, both ends included, where every limit is
//! evaluated exactly. Between two of them a value v that were a parabola peaks at most |Δ²v|/8 above the higher one,
//! Δ²v the second difference there; that is added on the side to which the parabola bulges, with the largest Δ²v of the
//! point and its neighbours. The bound is rigorous up to third differences, which the grid keeps small.

use pulp::Arch;

use super::ends::Moving;
use super::profile::Profile;
use super::rows::Tightening;
use super::uses::{POINTS, Points, Rates, Sweep, Uses};
use crate::budget::{Budget, Stopped};
use crate::curve::Side;
use crate::timing::coefficients::Coefficients;
use crate::timing::grid::{Place, fixed_nodes};
use crate::timing::limits::Limits;
use crate::timing::{Obstacle, Task, standstill};
use crate::tolerance::{CERTIFIED, JERK_TIGHTEN_MIN, JERK_TIGHTEN_TO};

/// The coefficients of every limit at all points of a grid; a use of 1 is all of the limit.
#[derive(Debug)]
pub(crate) struct Certificate<'a> {
    pub(super) limits: &'a Limits,
    pub(super) at: Coefficients,
    moving: Moving,
    cells: Vec<Cell>,
    pub(super) rates: Vec<Rates>,
    uses: Vec<Uses>,
}

/// An interval of the grid, or a part of one where it has a knot of the path or a border of limits inside.
#[derive(Debug, Clone, Copy)]
struct Cell {
    interval: usize,
    /// Parts of the interval.
    from: f64,
    to: f64,
}

impl Cell {
    /// Where a point is, as part of the interval.
    fn part(&self, point: usize) -> f64 {
        self.from + (self.to - self.from) * (point as f64 / (POINTS - 1) as f64)
    }
}

impl<'a> Certificate<'a> {
    /// # Errors
    /// [`Stopped`], when nobody waits any more.
    pub(crate) fn new(task: &Task<'a>, nodes: &[f64], budget: &Budget<'_>) -> Result<Result<Self, Obstacle>, Stopped> {
        let fixed = fixed_nodes(task.curve, task.limits);
        let mut cells = Vec::with_capacity(nodes.len() + fixed.len());
        let mut places = Vec::with_capacity(POINTS * cells.capacity());
        for (interval, pair) in nodes.windows(2).enumerate() {
            let h = pair[1] - pair[0];
            let mut from = pair[0];
            for to in inside(&fixed, pair).iter().chain([&pair[1]]) {
                let inner = (1..POINTS - 1).map(|k| from + (to - from) * (k as f64 / (POINTS - 1) as f64));
                let place = |side| move |s| Place { s, side };
                places.extend([from].map(place(Side::After)));
                places.extend(inner.chain([*to]).map(place(Side::Before)));
                let [from_part, to_part] = [(from - pair[0]) / h, (to - pair[0]) / h];
                cells.push(Cell {
                    interval,
                    from: from_part,
                    to: to_part,
                });
                from = *to;
            }
        }
        let at = Coefficients::compute(task.robot, task.tcp, task.curve, task.limits, &places, budget)?;
        if let Some(obstacle) = standstill::obstacle(&at, task.limits) {
            return Ok(Err(obstacle));
        }
        let count = cells.len();
        Ok(Ok(Self {
            limits: task.limits,
            at,
            moving: Moving::of(task.end_speeds),
            cells,
            rates: vec![Rates::default(); count],
            uses: vec![Uses::default(); count],
        }))
    }

    /// The cells of an interval.
    fn within(&self, interval: usize) -> std::ops::Range<usize> {
        let below = |limit: usize| self.cells.partition_point(|cell| cell.interval < limit);
        below(interval)..below(interval + 1)
    }

    /// The largest even change of speed, at most 1, with which no limit is exceeded; for torque, a safe estimate.
    /// `None` where the profile stands still or turns round between samples.
    pub(crate) fn measure(&mut self, profile: &Profile<'_>) -> Option<f64> {
        for (cell, rates) in self.cells.iter().zip(&mut self.rates) {
            for k in 0..POINTS {
                let (interval, part) = (cell.interval, cell.part(k));
                let [square, acceleration, jerk] = profile.rates(interval, part);
                let last = profile.interval_count() - 1;
                let is_rest = (interval == 0 && part <= 0.0) || (interval == last && part >= 1.0);
                if !is_rest && (square.is_nan() || square <= 0.0) {
                    return None;
                }
                rates.velocity[k] = square.sqrt();
                rates.square[k] = square;
                rates.acceleration[k] = acceleration;
                rates.jerk[k] = jerk;
            }
        }
        Arch::new().dispatch(Sweep {
            limits: self.limits,
            at: &self.at,
            rates: &self.rates,
            uses: &mut self.uses,
        });
        let mut speed = 1.0_f64;
        for uses in &self.uses {
            let worst = |points: &Points| points.iter().copied().fold(0.0, f64::max);
            let squared = worst(&uses.acceleration).max(worst(&uses.square));
            let cubed = worst(&uses.jerk);
            if squared > CERTIFIED {
                speed = speed.min((CERTIFIED / squared).sqrt());
            }
            if cubed > CERTIFIED {
                speed = speed.min(libm::cbrt(CERTIFIED / cubed));
            }
            speed = speed.min(uses.torque_speed);
        }
        Some(speed)
    }

    /// How much less of the limits a sample at the part `part` of an interval may use, so that nothing around it is
    /// exceeded. At the ends of the grid the sample answers for its rest interval too.
    pub(crate) fn tightening(&self, interval: usize, part: f64) -> Tightening {
        let mut uses = [0.0_f64; 4];
        let mut add = |interval: usize, low: f64, high: f64| {
            for cell in self.within(interval) {
                let found = &self.uses[cell];
                let columns = [&found.jerk, &found.acceleration, &found.torque, &found.square];
                for k in 0..POINTS {
                    let at = self.cells[cell].part(k);
                    if low <= at && at <= high {
                        for (worst, column) in uses.iter_mut().zip(columns) {
                            *worst = worst.max(column[k]);
                        }
                    }
                }
            }
        };
        if part <= 0.0 || part >= 1.0 {
            let after = if part > 0.0 { interval + 1 } else { interval };
            if let Some(before) = after.checked_sub(1) {
                add(before, 0.5, 1.0);
            }
            add(after, 0.0, 0.5);
        } else {
            add(interval, 0.0, 1.0);
        }
        let last = self.cells.last().map_or(0, |cell| cell.interval);
        let rest = match (interval, part) {
            (1, 0.0) if !self.moving.start => self.within(0),
            (i, 1.0) if i + 1 == last && !self.moving.end => self.within(last),
            _ => 0..0,
        };
        let at_rest = self.uses[rest].iter().flat_map(|uses| {
            let columns = [&uses.jerk, &uses.acceleration, &uses.torque, &uses.square];
            columns.into_iter().flatten().copied()
        });
        let at_rest = at_rest.fold(0.0, f64::max);
        let [jerk, acceleration, torque, square] = uses.map(left);
        Tightening {
            jerk,
            acceleration,
            torque,
            speed: square.min(left(at_rest)),
        }
    }
}

/// Those of sorted places that are strictly inside an interval.
pub(super) fn inside<'a>(places: &'a [f64], interval: &[f64]) -> &'a [f64] {
    let from = places.partition_point(|s| *s <= interval[0]);
    let to = places.partition_point(|s| *s < interval[1]);
    &places[from..to.max(from)]
}

/// What part of a limit is to be left, where `used` of it is used.
fn left(used: f64) -> f64 {
    if used <= JERK_TIGHTEN_TO {
        return 1.0;
    }
    (JERK_TIGHTEN_TO / used).max(JERK_TIGHTEN_MIN)
}
