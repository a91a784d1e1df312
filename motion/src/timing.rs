//! The fastest timing of a path under every limit but jerk, with a certificate.
//!
//! A path q(s) is given; what is free is when it is where. With a(s) = ṡ² the path acceleration is b = s̈ = a′/2, the
//! duration ∫ ds/√a, and every limit is linear in (a, b) or nearly so (Verscheure et al. 2009):
//!
//! 1. [`coefficients`]: what each limit says at samples of a [`grid`]; gravity and friction must leave room everywhere.
//! 2. [`reach`] finds the fastest a(s) that keeps the [`rows`] at every node and at samples between them, first on a coarse
//!    even grid, then on one that is finer where the motion is slow.
//! 3. [`certificate`] looks at every limit between samples. Where one is broken, its row gets less room and step 2 is
//!    repeated; what still remains after some rounds is slowed down evenly.
//!
//! The result is a [`law`]: a(s) linear on each interval, so that s(t) is a parabola on each.

pub(crate) mod certificate;
pub(crate) mod coefficients;
pub(crate) mod grid;
pub(crate) mod jerk;
pub(crate) mod law;
pub(crate) mod limits;
pub mod measured;
pub(crate) mod reach;
pub(crate) mod rows;
mod solve;
mod standstill;
mod tighten;

use nalgebra::Isometry3;

use crate::budget::{Budget, Stopped};
use crate::curve::Curve;
use crate::path::outcome::PathInfeasibleReason;
use crate::robot::Robot;
use crate::tolerance::{
    CERTIFIED, CHECK_PARTS, FINER_GRIDS, SLOW_ROUNDS, SPAN_INTERVALS_MIN, TIGHTEN_ROUNDS, TIGHTEN_ROUNDS_MOVING,
    TIMING_INTERVALS_MIN, TIMING_PARTS,
};
use certificate::Certificate;
use coefficients::Coefficients;
use grid::{Grid, even, fixed_nodes};
use law::TimeLaw;
use limits::Limits;
use rows::{Rooms, RowPlaces};
use solve::Problem;

/// What is timed.
#[derive(Clone, Copy)]
pub(crate) struct Task<'a> {
    pub(crate) robot: &'a Robot,
    /// Tool centre point in the tip link's frame.
    pub(crate) tcp: &'a Isometry3<f64>,
    pub(crate) curve: &'a dyn Curve,
    pub(crate) limits: &'a Limits,
    /// ṡ at the start and at the end.
    pub(crate) end_speeds: [f64; 2],
    /// About how many intervals the grid has; knots are added.
    pub(crate) intervals: usize,
}

/// A timing that keeps every limit.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Timing {
    pub(crate) law: TimeLaw,
    /// How often it was planned again because a limit was broken between samples.
    pub(crate) rounds: usize,
}

/// Why a path cannot be timed, with the evidence.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Obstacle {
    pub(crate) reason: PathInfeasibleReason,
    /// Where on the path.
    pub(crate) s: f64,
    /// `None`: no single joint, or the tool.
    pub(crate) joint: Option<usize>,
    /// Torque, or ṡ, that would be needed there.
    pub(crate) needed: f64,
    /// What there is.
    pub(crate) available: f64,
    /// Gravity's part of a torque.
    pub(crate) gravity_torque: f64,
}

impl Obstacle {
    /// No timing was found, and no single limit is to blame.
    const NO_TIMING: Self = Self {
        reason: PathInfeasibleReason::NoTiming,
        s: 0.0,
        joint: None,
        needed: 0.0,
        available: 0.0,
        gravity_torque: 0.0,
    };
}

/// Times a path as fast as every limit but jerk allows.
///
/// # Errors
/// [`Stopped`], when nobody waits any more.
pub(crate) fn optimal(task: &Task<'_>, budget: &Budget<'_>) -> Result<Result<Timing, Obstacle>, Stopped> {
    if task.curve.length() <= 0.0 {
        return Ok(Ok(Timing::default()));
    }
    let fixed = fixed_nodes(task.curve, task.limits);
    let least = TIMING_INTERVALS_MIN.max((fixed.len() - 1) * SPAN_INTERVALS_MIN);
    let mut intervals = task.intervals.max(least);
    let mut outcome = on_grid(task, &fixed, intervals, budget)?;
    for _ in 0..FINER_GRIDS {
        let no_timing = |obstacle: &Obstacle| obstacle.reason == PathInfeasibleReason::NoTiming;
        if !outcome.as_ref().is_err_and(no_timing) {
            break;
        }
        intervals *= 2;
        outcome = on_grid(task, &fixed, intervals, budget)?;
    }
    Ok(outcome)
}

/// The same with about so many intervals.
fn on_grid(
    task: &Task<'_>,
    fixed: &[f64],
    intervals: usize,
    budget: &Budget<'_>,
) -> Result<Result<Timing, Obstacle>, Stopped> {
    let coarse = Grid::new(even(fixed, intervals / 2), fixed, 1);
    let first = match solve(task, coarse, 1, None, budget)? {
        Ok(solved) => solved,
        Err(obstacle) => return Ok(Err(obstacle)),
    };
    let nodes = solve::graded(fixed, intervals, &first.problem.grid.nodes, &first.squares);
    let grid = Grid::new(nodes, fixed, CHECK_PARTS);
    let solved = match solve(task, grid, TIMING_PARTS, Some(&first), budget)? {
        Ok(solved) => solved,
        Err(obstacle) => return Ok(Err(obstacle)),
    };
    certify(task, solved, budget)
}

/// A problem on a grid, and its solution.
struct Solved<'a> {
    problem: Problem<'a>,
    /// a at every node.
    squares: Vec<f64>,
}

fn solve<'a>(
    task: &Task<'a>,
    grid: Grid,
    parts: usize,
    known: Option<&Solved<'_>>,
    budget: &Budget<'_>,
) -> Result<Result<Solved<'a>, Obstacle>, Stopped> {
    let Task {
        robot,
        tcp,
        curve,
        limits,
        ..
    } = *task;
    let coefficients = Coefficients::compute(robot, tcp, curve, limits, &grid.places, budget)?;
    if let Some(obstacle) = standstill::obstacle(&coefficients, limits) {
        return Ok(Err(obstacle));
    }
    let rooms = Rooms::full(&coefficients);
    let problem = Problem {
        rows: RowPlaces::new(&grid, parts),
        grid,
        coefficients,
        limits,
        ends: task.end_speeds.map(|speed| speed * speed),
    };
    let reference = known.map(|known| problem.reference(&known.problem.grid.nodes, &known.squares));
    let found = problem.solve(&rooms, reference, budget)?;
    Ok(match found {
        Ok(squares) => Ok(Solved { problem, squares }),
        Err(unreachable) => Err(problem.boundary(unreachable, &rooms, budget)?),
    })
}

/// Makes a solution keep every limit between its samples.
fn certify(task: &Task<'_>, solved: Solved<'_>, budget: &Budget<'_>) -> Result<Result<Timing, Obstacle>, Stopped> {
    let Solved { problem, mut squares } = solved;
    let certificate = Certificate {
        grid: &problem.grid,
        coefficients: &problem.coefficients,
        limits: task.limits,
    };
    // from rest to rest, slower is always possible
    let from_rest = task.end_speeds == [0.0; 2];
    let rounds_max = if from_rest {
        TIGHTEN_ROUNDS
    } else {
        TIGHTEN_ROUNDS_MOVING
    };
    let mut rooms = Rooms::full(&problem.coefficients);
    let mut rounds = 0;
    let mut verdict = tighten::judge(&certificate, &squares, budget)?;
    while verdict.worst > CERTIFIED && rounds < rounds_max {
        tighten::tighten(&mut rooms, &verdict.excesses, &problem);
        let reference = problem.reference(&problem.grid.nodes, &squares);
        match problem.solve(&rooms, Some(reference), budget)? {
            Ok(tighter) => squares = tighter,
            Err(unreachable) => return Ok(Err(problem.boundary(unreachable, &rooms, budget)?)),
        }
        verdict = tighten::judge(&certificate, &squares, budget)?;
        rounds += 1;
    }
    for _ in 0..SLOW_ROUNDS {
        if verdict.worst <= CERTIFIED || !from_rest {
            break;
        }
        let factor = tighten::slower(&verdict.excesses);
        for square in &mut squares {
            *square *= factor * factor;
        }
        verdict = tighten::judge(&certificate, &squares, budget)?;
    }
    let law = TimeLaw::linear(&problem.grid.nodes, &squares);
    let kept = verdict.worst <= CERTIFIED;
    Ok(match law {
        Some(law) if kept => Ok(Timing { law, rounds }),
        _ => Err(verdict.obstacle(&certificate)),
    })
}

#[cfg(test)]
mod test_curves;
#[cfg(test)]
mod tests;
