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
//! (Verscheure et al. 2009 for the form; Debrouwere et al. 2013 for jerk as a difference of convex functions.) a(s) is a
//! cubic spline between two laws of constant jerk at rest ([`basis`], [`rest`]), its coefficients found by an interior
//! point of three bands ([`interior`]) whose every iterate obeys the limits at the samples. A coarse grid first; its
//! solution says where the fine one has its nodes. What the fine solution exceeds between samples
//! ([`certificate`]) tightens the limits there for another solve; the little that is left then is slowed down evenly.

mod band;
mod basis;
mod certificate;
mod fold;
mod interior;
mod level;
mod limiting;
mod pass;
mod profile;
mod rest;
mod rows;

use super::grid::{even, fixed_nodes, spread};
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
use profile::Profile;

/// Part of every limit that the first profile of a solve uses: from nothing, from a coarser grid, after tightening.
const START_COLD: f64 = 0.6;
const START_PROLONGED: f64 = 0.95;
const START_AGAIN: f64 = 0.98;

/// Into how many parts the first intervals after that at rest are divided.
const NEAR_REST: [usize; 4] = [4, 3, 2, 2];

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
    let coarse = match Level::new(task, even(&fixed, JERK_COARSE_INTERVALS), &fixed, budget)? {
        Ok(level) => level,
        Err(obstacle) => return Ok(Err(obstacle)),
    };
    let mut x = coarse.unknowns(leaving_rest(task.curve.length()), START_COLD);
    Solver::new(&coarse.problem).improve(&coarse.problem, &mut x, &COLD, budget)?;

    let profile = coarse.profile(&x);
    let Some(nodes) = respread(&profile, &fixed, task.intervals.max(JERK_INTERVALS_MIN)) else {
        return Ok(Err(Obstacle::NO_TIMING));
    };
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
            let timing = level.profile(&x).law().map(|law| Timing {
                law,
                limiting: certificate.limiting(),
                rounds,
            });
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

/// About `count` intervals, nodes where the motion spends its time and where its way is, half and half.
fn respread(profile: &Profile<'_>, fixed: &[f64], count: usize) -> Option<Vec<f64>> {
    const PARTS: usize = 8;
    let law = profile.law()?;
    let nodes = profile.nodes;
    let last = nodes.len() - 1;
    let mut places = Vec::with_capacity(PARTS * last + 1);
    for (interval, pair) in nodes.windows(2).enumerate() {
        for k in 0..PARTS {
            let part = k as f64 / PARTS as f64;
            // near rest, equal times
            let part = match interval {
                0 => part * part * part,
                i if i + 1 == last => 1.0 - (1.0 - part) * (1.0 - part) * (1.0 - part),
                _ => part,
            };
            places.push(pair[0] + part * (pair[1] - pair[0]));
        }
    }
    places.push(nodes[last]);
    let way = 0.5 / nodes[last];
    let time = 0.5 / law.duration();
    let measure: Vec<f64> = places.iter().map(|s| way * s + time * law.time_at(*s)).collect();
    Some(eased(&spread(fixed, count, &places, &measure)))
}

/// The same nodes, with the intervals next to those at rest divided at equal times, [`NEAR_REST`] says into how many. There
/// nodes at equal times are at distances from rest in the ratio 1 : 8 : 27, however fine the grid is, and a cubic
/// follows s^(4/3) the less well.
fn eased(nodes: &[f64]) -> Vec<f64> {
    let last = nodes.len() - 1;
    let (begin, end) = (nodes[0], nodes[last]);
    let mut eased = Vec::with_capacity(nodes.len() + 2 * NEAR_REST.iter().sum::<usize>());
    for (interval, pair) in nodes.windows(2).enumerate() {
        eased.push(pair[0]);
        let from_end = last - 1 - interval;
        let (parts, roots) = if interval <= from_end {
            let parts = interval.checked_sub(1).and_then(|k| NEAR_REST.get(k));
            (parts, [pair[0] - begin, pair[1] - begin].map(libm::cbrt))
        } else {
            let parts = from_end.checked_sub(1).and_then(|k| NEAR_REST.get(k));
            (parts, [pair[0] - end, pair[1] - end].map(libm::cbrt))
        };
        let rest = if interval <= from_end { begin } else { end };
        for k in 1..parts.copied().unwrap_or(1) {
            let part = k as f64 / parts.copied().unwrap_or(1) as f64;
            let root = roots[0] + part * (roots[1] - roots[0]);
            let s = rest + root * root * root;
            if s > eased[eased.len() - 1] && s < pair[1] {
                eased.push(s);
            }
        }
    }
    eased.push(end);
    eased
}

#[cfg(test)]
mod tests;
