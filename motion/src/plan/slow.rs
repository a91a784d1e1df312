//! Slowing a plan down until it keeps its torque limits.
//!
//! At a part λ of its speed a torque is λ²·d + λ·f + c ([`Point`]). Slower need not be safer, so λ descends from root to
//! root until every point holds, and the slower plan is verified again.

use super::Failure;
use super::outcome::Pattern;
use super::problem::Problem;
use super::verified::{Verified, excess};
use crate::budget::Budget;
use crate::tolerance::{PLAN_RESERVE, SLOW_ROUNDS, SLOWEST, VERIFY_RESERVE};
use crate::trajectory::Trajectory;
use crate::verify::{Peak, Point, Verification, Verifier};

/// Relative excess that a torque at a root may have from rounding: far inside the reserve.
const ROOT_ROUNDING: f64 = 1.0e-9;

/// A plan made slow enough, or the torque that no speed brings below its limit.
pub(super) type Slowed = Result<Verified, Peak>;

/// Slows verified patterns until they hold with the reserve, beginning at a part of their speed.
pub(super) fn until_it_holds(
    problem: &Problem,
    verifier: &mut Verifier,
    raw: &[Pattern],
    verification: Verification,
    budget: &Budget<'_>,
) -> Result<Slowed, Failure> {
    let limits = problem.torque_limits();
    let mut patterns = raw.to_vec();
    let mut verification = verification;
    let mut part = 1.0;
    for _ in 0..SLOW_ROUNDS {
        budget.check()?;
        if excess(&verification, &limits) <= -VERIFY_RESERVE {
            return Ok(Ok((patterns, verification)));
        }
        let step = match descend(&verification.points, &limits) {
            Ok(step) => step,
            Err(peak) => return Ok(Err(peak)),
        };
        part *= step;
        if part < SLOWEST {
            break;
        }
        patterns = patterns.iter().map(|pattern| slowed(pattern, step)).collect();
        verification = verify(problem, verifier, &patterns);
    }
    Ok(Err(tightest(&verification, &limits)))
}

/// Verifies patterns of a problem.
pub(super) fn verify(problem: &Problem, verifier: &mut Verifier, patterns: &[Pattern]) -> Verification {
    let motion = Trajectory::of_patterns(&problem.start, patterns);
    verifier.verify(
        problem.robot.chain(),
        problem.robot.drives(),
        &problem.torque_limits(),
        &motion,
    )
}

/// The same pattern at a part of its speed.
pub(super) fn slowed(pattern: &Pattern, part: f64) -> Pattern {
    if pattern.moves() {
        pattern.slowed(part)
    } else {
        *pattern
    }
}

/// The largest part of the speed, at most 1, at which every point holds; or a point that holds at none below.
fn descend(points: &[Point], limits: &[Option<f64>]) -> Result<f64, Peak> {
    let mut part = 1.0;
    loop {
        let before = part;
        for point in points {
            let Some(limit) = limits[point.joint] else { continue };
            let limit = limit * (1.0 - PLAN_RESERVE);
            let torque = point.torque(part);
            if torque.abs() <= limit * (1.0 + ROOT_ROUNDING) {
                continue;
            }
            let bound = limit.copysign(torque);
            let Some(lower) = root_below(point.dynamic, point.viscous, point.still - bound, part) else {
                return Err(Peak {
                    joint: point.joint,
                    time: point.time,
                    segment: point.segment,
                    torque,
                });
            };
            part = lower;
        }
        if part == before {
            return Ok(part);
        }
    }
}

/// The largest root of a·x² + b·x + c in (0, below).
fn root_below(a: f64, b: f64, c: f64, below: f64) -> Option<f64> {
    let discriminant = b * b - 4.0 * a * c;
    if discriminant < 0.0 {
        return None;
    }
    let q = -0.5 * (b + discriminant.sqrt().copysign(b));
    [q / a, c / q]
        .into_iter()
        .filter(|x| x.is_finite() && *x > 0.0 && *x < below)
        .max_by(f64::total_cmp)
}

fn tightest(verification: &Verification, limits: &[Option<f64>]) -> Peak {
    let use_of = |joint: usize| {
        let limit = limits[joint].unwrap_or(f64::INFINITY);
        verification.joints[joint].peak_torque.abs() / limit
    };
    let joint = (0..limits.len())
        .max_by(|a, b| use_of(*a).total_cmp(&use_of(*b)))
        .unwrap_or(0);
    let demand = &verification.joints[joint];
    Peak {
        joint,
        time: demand.time,
        segment: demand.segment,
        torque: demand.peak_torque,
    }
}
