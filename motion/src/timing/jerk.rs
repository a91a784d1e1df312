//! The fastest timing of a path under jerk limits too, from rest to rest.
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

mod band;
mod basis;
mod certificate;
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
    JERK_COARSE_INTERVALS, JERK_GAP, JERK_GAP_COARSE, JERK_INTERVALS_MIN, JERK_RESERVE, JERK_ROUND_WORTH, JERK_ROUNDS,
    JERK_SLOW_ROUNDS,
};
use certificate::Certificate;
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

/// Times a path as fast as every limit allows, jerk limits too, from rest to rest. Speeds at the ends are not supported
/// together with jerk limits: the obstacle is then a boundary speed.
///
/// # Errors
/// [`Stopped`], when nobody waits any more.
pub(crate) fn jerk_limited(task: &Task<'_>, budget: &Budget<'_>) -> Result<Result<Timing, Obstacle>, Stopped> {
    if let Some(obstacle) = moving_end(task) {
        return Ok(Err(obstacle));
    }
    if task.curve.length() <= 0.0 {
        return Ok(Ok(Timing::default()));
    }
    let fixed = fixed_nodes(task.curve, task.limits);
    let apart = nodes::apart(&fixed);
    let coarse = match Level::new(task, nodes::even(&apart, JERK_COARSE_INTERVALS), &fixed, budget)? {
        Ok(level) => level,
        Err(obstacle) => return Ok(Err(obstacle)),
    };
    let mut x = coarse.unknowns(leaving_rest(task.curve.length()), START_COLD);
    Solver::new(&coarse.problem).improve(&coarse.problem, &mut x, &COLD, budget)?;

    let profile = coarse.profile(&x);
    let intervals = task.intervals.max(JERK_INTERVALS_MIN);
    let nodes = nodes::respread(&profile, &apart, intervals).unwrap_or_else(|| nodes::even(&apart, intervals));
    let mut fine = match Level::new(task, nodes, &fixed, budget)? {
        Ok(level) => level,
        Err(obstacle) => return Ok(Err(obstacle)),
    };
    let mut x = fine.unknowns(|s| profile.square(s), START_PROLONGED);
    let mut solver = Solver::new(&fine.problem);
    solver.improve(&fine.problem, &mut x, &PROLONGED, budget)?;
    certified(task, &mut fine, &mut solver, x, budget)
}

/// The end at which the motion is not asked to be at rest.
fn moving_end(task: &Task<'_>) -> Option<Obstacle> {
    let at = [0.0, task.curve.length()];
    let (s, speed) = at.into_iter().zip(task.end_speeds).find(|(_, speed)| *speed != 0.0)?;
    Some(Obstacle {
        reason: PathInfeasibleReason::BoundarySpeed,
        s,
        needed: speed,
        ..Obstacle::NO_TIMING
    })
}

/// A profile that leaves rest and comes to rest at constant jerk: (4·u·(1 − u))^(4/3), u the part of the path.
fn leaving_rest(length: f64) -> impl Fn(f64) -> f64 {
    move |s| {
        let u = s / length;
        let v = 4.0 * u * (1.0 - u);
        v * libm::cbrt(v)
    }
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
        solver.improve(&level.problem, &mut x, &AGAIN, budget)?;
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
    let nodes = level.nodes();
    for part in [0.1, 0.5, 1.0] {
        if let Some(speed) = certificate.measure(&level.profile(x)) {
            return speed;
        }
        let slow = level.unknowns(leaving_rest(nodes[nodes.len() - 1]), START_COLD);
        for (x, slow) in x.iter_mut().zip(slow) {
            *x += part * (slow - *x);
        }
    }
    certificate.measure(&level.profile(x)).unwrap_or(0.0)
}

#[cfg(test)]
mod tests;
