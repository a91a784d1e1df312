//! The fastest timing on one grid: the rows, and where their tangents are.

use super::coefficients::Coefficients;
use super::grid::{Grid, spread};
use super::limits::Limits;
use super::reach::{self, Unreachable};
use super::rows::{Rooms, RowPlaces, Rows};
use super::{Obstacle, grid};
use crate::budget::{Budget, Stopped};
use crate::path::outcome::PathInfeasibleReason;
use crate::tolerance::{BOUNDARY_ROUNDS, GRID_EVEN_SHARE, REFERENCE_FLOOR, VISCOUS_PASSES};

/// A path on a grid, and what bounds it.
#[derive(Debug)]
pub(super) struct Problem<'a> {
    pub(super) grid: Grid,
    pub(super) rows: RowPlaces,
    pub(super) coefficients: Coefficients,
    pub(super) limits: &'a Limits,
    /// a at the start and at the end.
    pub(super) ends: [f64; 2],
}

impl Problem<'_> {
    /// The fastest a at every node. `reference` is a timing known before, one a place of rows, where viscous torque has its
    /// tangents; each pass is at least as fast as the one before.
    pub(super) fn solve(
        &self,
        rooms: &Rooms,
        mut reference: Option<Vec<f64>>,
        budget: &Budget<'_>,
    ) -> Result<Result<Vec<f64>, Unreachable>, Stopped> {
        let mut passes = if reference.is_some() { 1 } else { VISCOUS_PASSES };
        let mut squares = Vec::new();
        while passes > 0 {
            passes -= 1;
            let rows = Rows::new(&self.coefficients, self.limits, rooms, &self.rows, reference.as_deref());
            match reach::fastest(&self.grid, &rows, self.ends, budget)? {
                Ok(found) => squares = found,
                // tangents far above the speeds at the ends may forbid them: try those that touch there
                Err(_) if rows.viscous && reference.is_none() => {
                    reference = Some(vec![self.ends[0].max(self.ends[1]); self.rows.samples.len()]);
                    passes = VISCOUS_PASSES;
                    continue;
                }
                Err(unreachable) => return Ok(Err(unreachable)),
            }
            if !rows.viscous {
                break;
            }
            if passes > 0 {
                reference = Some(self.reference(&self.grid.nodes, &squares));
            }
        }
        Ok(Ok(squares))
    }

    /// a at every place of rows, from a timing on any grid; not below a floor, where a tangent would be too steep to be of use.
    pub(super) fn reference(&self, nodes: &[f64], squares: &[f64]) -> Vec<f64> {
        let floor = REFERENCE_FLOOR * squares.iter().fold(0.0, |most: f64, a| most.max(*a));
        let samples = self.rows.samples.iter();
        let mut interval = 0;
        samples
            .map(|sample| {
                let s = self.grid.places[*sample].s;
                while interval + 2 < nodes.len() && nodes[interval + 1] < s {
                    interval += 1;
                }
                let part = (s - nodes[interval]) / (nodes[interval + 1] - nodes[interval]);
                let a = squares[interval] + (squares[interval + 1] - squares[interval]) * part;
                a.max(floor)
            })
            .collect()
    }

    /// The evidence that a speed at an end cannot be had.
    pub(super) fn boundary(
        &self,
        unreachable: Unreachable,
        rooms: &Rooms,
        budget: &Budget<'_>,
    ) -> Result<Obstacle, Stopped> {
        let length = self.grid.nodes[self.grid.interval_count()];
        let (s, needed, available) = match unreachable {
            Unreachable::Start { largest } => (0.0, self.ends[0], largest),
            Unreachable::End => (length, self.ends[1], self.largest_end(rooms, budget)?),
        };
        Ok(Obstacle {
            reason: PathInfeasibleReason::BoundarySpeed,
            s,
            joint: None,
            needed: needed.sqrt(),
            available: available.sqrt(),
            gravity_torque: 0.0,
        })
    }

    /// The largest a at the end that anything can lead to. Those that can be had are all those up to a largest one, since the
    /// rows are convex and standing still keeps them.
    fn largest_end(&self, rooms: &Rooms, budget: &Budget<'_>) -> Result<f64, Stopped> {
        let rows = Rows::new(&self.coefficients, self.limits, rooms, &self.rows, None);
        let (mut low, mut high) = (0.0, self.ends[1]);
        for _ in 0..BOUNDARY_ROUNDS {
            let middle = 0.5 * (low + high);
            match reach::fastest(&self.grid, &rows, [self.ends[0], middle], budget)? {
                Err(Unreachable::End) => high = middle,
                Ok(_) | Err(Unreachable::Start { .. }) => low = middle,
            }
        }
        Ok(low)
    }
}

/// Nodes that are closer together where a timing is slow: equal shares of a mean of way and time.
pub(super) fn graded(fixed: &[f64], intervals: usize, nodes: &[f64], squares: &[f64]) -> Vec<f64> {
    let mut times = vec![0.0];
    for (s, a) in nodes.windows(2).zip(squares.windows(2)) {
        let step = 2.0 * (s[1] - s[0]) / (a[0].sqrt() + a[1].sqrt());
        times.push(times[times.len() - 1] + step);
    }
    let (length, duration) = (nodes[nodes.len() - 1], times[times.len() - 1]);
    if !duration.is_finite() || duration <= 0.0 {
        return grid::even(fixed, intervals);
    }
    let both = nodes.iter().zip(&times);
    let measure: Vec<f64> = both
        .map(|(s, t)| GRID_EVEN_SHARE * s / length + (1.0 - GRID_EVEN_SHARE) * t / duration)
        .collect();
    spread(fixed, intervals, nodes, &measure)
}
