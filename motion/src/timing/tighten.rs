//! What becomes of a timing that breaks a limit between its samples: less room for that limit there, or slower everywhere.

use super::Obstacle;
use super::certificate::{Certificate, Use};
use super::rows::Rooms;
use super::solve::Problem;
use crate::budget::{Budget, Stopped};
use crate::path::outcome::{PathInfeasibleReason, PathLimit};
use crate::tolerance::{CERTIFIED, CHECK_PARTS, SLOWDOWN_AIM, TIGHTEN_MOST, TIMING_RESERVE};

/// What a timing takes of its limits.
#[derive(Debug)]
pub(super) struct Verdict {
    /// The largest part of any limit, where it is above what is certified.
    pub(super) worst: f64,
    /// Every use above what is certified.
    pub(super) excesses: Vec<Use>,
}

/// Looks at a timing with b constant on each interval.
pub(super) fn judge(certificate: &Certificate<'_>, squares: &[f64], budget: &Budget<'_>) -> Result<Verdict, Stopped> {
    let rates = |interval: usize, part: usize| {
        let (from, to) = (squares[interval], squares[interval + 1]);
        let b = (to - from) / (2.0 * certificate.grid.step(interval));
        [from + (to - from) * (part as f64 / CHECK_PARTS as f64), b]
    };
    let mut verdict = Verdict {
        worst: 0.0,
        excesses: Vec::new(),
    };
    certificate.visit(&rates, budget, &mut |at| {
        let ratio = at.ratio();
        if ratio > CERTIFIED {
            verdict.excesses.push(*at);
        }
        verdict.worst = verdict.worst.max(ratio);
    })?;
    Ok(verdict)
}

/// Takes room from the limits that were broken, at the rows on both sides of where they were.
pub(super) fn tighten(rooms: &mut Rooms, excesses: &[Use], problem: &Problem<'_>) {
    let aim = 1.0 - TIMING_RESERVE;
    let (parts, every) = (problem.rows.parts, problem.grid.parts / problem.rows.parts);
    let stride = problem.coefficients.stride;
    // of several uses at the same place the worst counts, not their product
    let before = rooms.clone();
    for at in excesses {
        let factor = match at.kind {
            PathLimit::Torque => (aim * at.limit - at.still) / (at.value - at.still),
            PathLimit::Velocity | PathLimit::ToolVelocity => (aim / at.ratio()) * (aim / at.ratio()),
            _ => aim / at.ratio(),
        };
        let factor = factor.max(TIGHTEN_MOST);
        let first = problem.grid.first[at.interval];
        let (low, high) = (at.part * parts / CHECK_PARTS, (at.part * parts).div_ceil(CHECK_PARTS));
        for sample in (low..=high).map(|row| first + row * every) {
            let entry = at.joint.unwrap_or(0) * stride + sample;
            let (room, known) = match at.kind {
                PathLimit::Torque => (&mut rooms.torque[entry], before.torque[entry]),
                PathLimit::Acceleration => (&mut rooms.acceleration[entry], before.acceleration[entry]),
                PathLimit::ToolAcceleration => (&mut rooms.tool_acceleration[sample], before.tool_acceleration[sample]),
                _ => (&mut rooms.speed[sample], before.speed[sample]),
            };
            *room = room.min(known * factor);
        }
    }
}

/// The part of the speed at which every excess is gone, to first order in what is between the points.
pub(super) fn slower(excesses: &[Use]) -> f64 {
    let part = |at: &Use| match at.kind {
        PathLimit::Torque => {
            let dynamic = at.value - at.still - at.viscous;
            first_root(dynamic, at.viscous, SLOWDOWN_AIM * at.limit - at.still)
        }
        PathLimit::Velocity | PathLimit::ToolVelocity => SLOWDOWN_AIM / at.ratio(),
        _ => (SLOWDOWN_AIM / at.ratio()).sqrt(),
    };
    excesses.iter().map(part).fold(1.0, f64::min)
}

/// The smallest positive z with d·z² + f·z = room, for a positive room; infinite where there is none.
fn first_root(d: f64, f: f64, room: f64) -> f64 {
    let discriminant = f * f + 4.0 * d * room;
    if discriminant < 0.0 {
        return f64::INFINITY;
    }
    let below = f + discriminant.sqrt();
    if below <= 0.0 {
        return f64::INFINITY;
    }
    2.0 * room / below
}

impl Verdict {
    /// The evidence that a limit stays broken.
    pub(super) fn obstacle(&self, certificate: &Certificate<'_>) -> Obstacle {
        let worst = self.excesses.iter().max_by(|a, b| a.ratio().total_cmp(&b.ratio()));
        let mut obstacle = Obstacle {
            reason: PathInfeasibleReason::NoTiming,
            s: 0.0,
            joint: None,
            needed: 0.0,
            available: 0.0,
            gravity_torque: 0.0,
        };
        let Some(at) = worst else { return obstacle };
        let sample = certificate.grid.first[at.interval] + at.part;
        obstacle.s = certificate.grid.places[sample].s;
        obstacle.joint = at.joint;
        (obstacle.needed, obstacle.available) = (at.value, at.limit);
        if let (PathLimit::Torque, Some(joint)) = (at.kind, at.joint) {
            let entry = joint * certificate.coefficients.stride + sample;
            obstacle.gravity_torque = certificate.coefficients.terms.gravity[entry];
        }
        obstacle
    }
}
