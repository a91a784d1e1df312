//! The fastest timing of a path under jerk limits too.
//!
//! With a(s) = ṡ², b = s̈ = a′/2 and c = s⃛/ṡ = a″/2, each limit at a place bounds (a, b, c):
//!
//! ```text
//! jerk           |q′·c + 3·q″·b + q‴·a| ≤ J·a^(−1/2)          the right side convex: its tangent is a safe side
//! acceleration   |q′·b + q″·a| ≤ A             torque     |m·b + k·a + g + F± + f_v·√a| ≤ T
//! tool           |p′·b + p″·a| ≤ A_tool        speeds     a ≤ a_max            minimise ∫ ds/√a
//! ```
//!
//! (Verscheure et al. 2009 for the form; Debrouwere et al. 2013 for jerk as a difference of convex functions.) a(s) is
//! a cubic spline between two laws of constant jerk at rest ([`basis`], [`rest`]), its coefficients found by an
//! interior point of three bands ([`interior`]) whose every iterate obeys the limits at the samples. A coarse grid
//! first; its solution says where the fine one has its nodes. What the fine solution exceeds between samples
//! ([`certificate`]) tightens the limits there for another solve; the little that is left then is slowed down evenly.
//! Where the motion moves at an end ([`ends`]), its speed there is given and limits are tightened until nothing is left.

mod band;
mod basis;
mod certificate;
mod ends;
mod fold;
mod interior;
mod level;
mod nodes;
mod pass;
mod profile;
mod rest;
mod rows;
mod uses;

use super::grid::fixed_nodes;
use super::{Obstacle, Task, Timing};
use crate::budget::{Budget, Stopped};
use crate::path::outcome::PathInfeasibleReason;
use crate::tolerance::{
    JERK_COARSE_INTERVALS, JERK_GAP, JERK_GAP_COARSE, JERK_GAP_RAISED, JERK_INTERVALS_MIN, JERK_RAISE_WORTH,
    JERK_RESERVE, JERK_ROUND_WORTH, JERK_ROUNDS, JERK_ROUNDS_MOVING, JERK_ROUNDS_SOLVED, JERK_SLOW_ROUNDS,
};
use certificate::Certificate;
use ends::Moving;
use interior::{Accuracy, Solver};
use level::Level;

/// Part of every limit that the first profile of a solve uses: from nothing, from a coarser grid, after tightening. The
/// nearer it is to the end, the less room its slacks need.
const START_COLD: f64 = 0.6;
const START_PROLONGED: f64 = 0.95;
const START_AGAIN: f64 = 0.98;

const COLD: Accuracy = Accuracy {
    gap: JERK_GAP_COARSE,
    first_center: 30.0,
};
const PROLONGED: Accuracy = Accuracy {
    gap: JERK_GAP,
    first_center: 10.0,
};
const AGAIN: Accuracy = Accuracy {
    gap: JERK_GAP,
    first_center: 0.01,
};

/// Raising the speeds at the ends, whose worth is many times the duration.
const RAISED: Accuracy = Accuracy {
    gap: JERK_GAP_RAISED,
    first_center: JERK_RAISE_WORTH,
};

/// Times a path as fast as every limit allows, jerk limits too.
///
/// # Errors
/// [`Stopped`], when nobody waits any more.
pub(crate) fn jerk_limited(task: &Task<'_>, budget: &Budget<'_>) -> Result<Result<Timing, Obstacle>, Stopped> {
    if task.curve.length() <= 0.0 {
        return Ok(Ok(Timing::default()));
    }
    let fixed = fixed_nodes(task.curve, task.limits);
    let apart = nodes::apart(&fixed);
    let mut coarse = match Level::new(task, nodes::even(&apart, JERK_COARSE_INTERVALS), &fixed, budget)? {
        Ok(level) => level,
        Err(obstacle) => return Ok(Err(obstacle)),
    };
    let mut x = coarse.first(START_COLD);
    // where this grid is too coarse for the speeds at the ends, the fine one may not be
    if raised(&mut coarse, &mut x, budget)? {
        Solver::new(&coarse.problem).improve(&mut coarse.problem, &mut x, &COLD, budget)?;
    }

    let profile = coarse.profile(&x);
    let intervals = task.intervals.max(JERK_INTERVALS_MIN);
    let nodes = nodes::respread(&profile, &apart, intervals).unwrap_or_else(|| nodes::even(&apart, intervals));
    let mut fine = match Level::new(task, nodes, &fixed, budget)? {
        Ok(level) => level,
        Err(obstacle) => return Ok(Err(obstacle)),
    };
    let moves = Moving::of(task.end_speeds) != Moving::default();
    let most = if moves { 1.0 } else { f64::INFINITY };
    let mut x = fine.unknowns(|s| profile.square(s), START_PROLONGED, most);
    raised(&mut fine, &mut x, budget)?;
    if let Some(obstacle) = short(task, &fine, &x) {
        return Ok(Err(obstacle));
    }
    let mut solver = Solver::new(&fine.problem);
    solver.improve(&mut fine.problem, &mut x, &PROLONGED, budget)?;
    if moves {
        return certified_moving(task, &mut fine, &mut solver, x, budget);
    }
    certified(task, &mut fine, &mut solver, x, budget)
}

/// Raises the speeds at ends that move to what is asked for; false where they do not arrive.
fn raised(level: &mut Level, x: &mut Vec<f64>, budget: &Budget<'_>) -> Result<bool, Stopped> {
    level.raise();
    if !level.problem.raises() {
        return Ok(true);
    }
    let ended = Solver::new(&level.problem).improve(&mut level.problem, x, &RAISED, budget)?;
    if level.problem.raises() && !ended.converged {
        // it is stuck between limits: that says nothing yet, a start far from them all may arrive
        *x = level.first(START_COLD);
        level.raise();
        Solver::new(&level.problem).improve(&mut level.problem, x, &RAISED, budget)?;
    }
    Ok(!level.problem.raises())
}

/// The evidence that the speed at an end cannot be had.
fn short(task: &Task<'_>, level: &Level, x: &[f64]) -> Option<Obstacle> {
    let (side, available) = level.short_end(x, task.end_speeds)?;
    Some(Obstacle {
        reason: PathInfeasibleReason::BoundarySpeed,
        s: [0.0, task.curve.length()][side],
        needed: task.end_speeds[side],
        available,
        ..Obstacle::NO_TIMING
    })
}

/// Tightens limits at the samples around what is exceeded and solves again, until nothing is: the speeds at the ends are
/// given, so that slowing down evenly is no way out.
fn certified_moving(
    task: &Task<'_>,
    level: &mut Level,
    solver: &mut Solver,
    mut x: Vec<f64>,
    budget: &Budget<'_>,
) -> Result<Result<Timing, Obstacle>, Stopped> {
    let mut certificate = match Certificate::new(task, level.nodes(), budget)? {
        Ok(certificate) => certificate,
        Err(obstacle) => return Ok(Err(obstacle)),
    };
    for rounds in 0..=JERK_ROUNDS_MOVING {
        let speed = certificate.measure(&level.profile(&x));
        if speed.is_some_and(|speed| speed >= 1.0) {
            let timing = level.profile(&x).law().map(|law| Timing { law, rounds });
            return Ok(timing.ok_or(Obstacle::NO_TIMING));
        }
        if speed.is_some() {
            level.tighten(&certificate);
        } else {
            // it stands still between samples: mixed with one that does not
            for (x, slow) in x.iter_mut().zip(level.first(START_COLD)) {
                *x = 0.5 * (*x + slow);
            }
        }
        level.run_at(&mut x, START_AGAIN, 1.0);
        raised(level, &mut x, budget)?;
        if let Some(obstacle) = short(task, level, &x) {
            return Ok(Err(obstacle));
        }
        // after so many, what the start of a solve leaves of the limits is left
        if speed.is_some() && rounds < JERK_ROUNDS_SOLVED {
            solver.improve(&mut level.problem, &mut x, &AGAIN, budget)?;
        }
    }
    Ok(Err(Obstacle::NO_TIMING))
}

/// Tightens limits at the samples around what is exceeded and solves again, while that is worth it; then slows down.
fn certified(
    task: &Task<'_>,
    level: &mut Level,
    solver: &mut Solver,
    mut x: Vec<f64>,
    budget: &Budget<'_>,
) -> Result<Result<Timing, Obstacle>, Stopped> {
    let mut certificate = match Certificate::new(task, level.nodes(), budget)? {
        Ok(certificate) => certificate,
        Err(obstacle) => return Ok(Err(obstacle)),
    };
    let mut rounds = 0;
    let mut speed = measured(level, &mut certificate, &mut x);
    while rounds < JERK_ROUNDS && speed < 1.0 - JERK_ROUND_WORTH {
        level.tighten(&certificate);
        level.run_at(&mut x, START_AGAIN, 1.0);
        solver.improve(&mut level.problem, &mut x, &AGAIN, budget)?;
        speed = measured(level, &mut certificate, &mut x);
        rounds += 1;
    }
    for _ in 0..JERK_SLOW_ROUNDS {
        budget.check()?;
        if speed >= 1.0 {
            let timing = level.profile(&x).law().map(|law| Timing { law, rounds });
            return Ok(timing.ok_or(Obstacle::NO_TIMING));
        }
        let slower = speed * (1.0 - JERK_RESERVE);
        for x in &mut x {
            *x *= slower * slower;
        }
        speed = measured(level, &mut certificate, &mut x);
    }
    Ok(Err(Obstacle::NO_TIMING))
}

/// How much slower the motion must be. Where it stands still between samples it is mixed with one that does not.
fn measured(level: &Level, certificate: &mut Certificate<'_>, x: &mut [f64]) -> f64 {
    for part in [0.1, 0.5, 1.0] {
        if let Some(speed) = certificate.measure(&level.profile(x)) {
            return speed;
        }
        for (x, slow) in x.iter_mut().zip(level.first(START_COLD)) {
            *x += part * (slow - *x);
        }
    }
    certificate.measure(&level.profile(x)).unwrap_or(0.0)
}

#[cfg(test)]
mod tests;
