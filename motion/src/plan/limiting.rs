//! What keeps a move from being faster.
//!
//! T = 1/v + v/2α + v/2δ along the path, so faster cruising saves in proportion to the cruise time, and more acceleration
//! (deceleration) in proportion to half the time spent on it. Of the phases whose tightest limit is used up, the one with
//! the most to save is named.

use super::outcome::{Limiting, LimitingKind, Pattern, Phase};
use super::preset::preset;
use super::problem::Problem;
use super::request::Method;
use crate::trajectory::{self, Trajectory};
use crate::verify::Verification;

/// From this part of a limit on, it counts as used up.
const USED_UP: f64 = 0.999;

/// Names what limits a move.
pub(super) fn of_move(
    problem: &Problem,
    patterns: &[Pattern],
    verification: &Verification,
    method: Method,
) -> Option<Limiting> {
    let pace = pace_joint(problem, patterns, method)?;
    let pattern = &patterns[pace];
    let (up, cruise, down) = (
        pattern.acceleration_time,
        pattern.cruise_time,
        pattern.deceleration_time,
    );
    let phases = [
        (Phase::Acceleration, 0.5 * up, 0.0),
        (Phase::Cruise, cruise, up),
        (Phase::Deceleration, 0.5 * down, up + cruise),
    ];
    let torques = torques_by_phase(problem, patterns, verification, pace);
    let tightest: Vec<(f64, Limiting)> = phases
        .iter()
        .zip(torques)
        .filter(|((_, saving, _), _)| *saving > 0.0)
        .filter_map(|((phase, saving, begin), torque)| {
            let limits = rates(problem, patterns, *phase, *begin, method);
            limits
                .into_iter()
                .chain(torque)
                .max_by(|a, b| a.utilization.total_cmp(&b.utilization))
                .map(|limiting| (*saving, limiting))
        })
        .collect();
    tightest
        .iter()
        .filter(|(_, limiting)| limiting.utilization >= USED_UP)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .or_else(|| {
            tightest
                .iter()
                .max_by(|a, b| a.1.utilization.total_cmp(&b.1.utilization))
        })
        .map(|(_, limiting)| *limiting)
}

/// The moving joint that uses most of its speed or acceleration limits.
fn pace_joint(problem: &Problem, patterns: &[Pattern], method: Method) -> Option<usize> {
    (0..patterns.len())
        .filter(|joint| patterns[*joint].moves())
        .max_by(|a, b| {
            let used = |joint: usize| {
                [Phase::Acceleration, Phase::Cruise, Phase::Deceleration]
                    .into_iter()
                    .filter_map(|phase| rate(problem, patterns, joint, phase, method))
                    .map(|(_, utilization)| utilization)
                    .fold(0.0, f64::max)
            };
            used(*a).total_cmp(&used(*b)).then(b.cmp(a))
        })
}

/// The speed and acceleration limits of all joints in a phase.
fn rates(problem: &Problem, patterns: &[Pattern], phase: Phase, time: f64, method: Method) -> Vec<Limiting> {
    (0..patterns.len())
        .filter_map(|joint| {
            rate(problem, patterns, joint, phase, method).map(|(kind, utilization)| Limiting {
                kind,
                joint,
                time,
                phase,
                utilization,
            })
        })
        .collect()
}

/// The part of its speed or acceleration limit that a joint uses in a phase.
fn rate(
    problem: &Problem,
    patterns: &[Pattern],
    joint: usize,
    phase: Phase,
    method: Method,
) -> Option<(LimitingKind, f64)> {
    let pattern = &patterns[joint];
    if !pattern.moves() {
        return None;
    }
    let limit = &problem.limits[joint];
    let preset = (method == Method::Preset).then(|| preset(problem, joint)).flatten();
    let (kind, value, limit) = match (phase, preset) {
        (Phase::Acceleration, Some((acceleration, _))) => (
            LimitingKind::PresetAcceleration,
            pattern.acceleration,
            Some(acceleration),
        ),
        (Phase::Deceleration, Some((_, deceleration))) => (
            LimitingKind::PresetAcceleration,
            pattern.deceleration,
            Some(deceleration),
        ),
        (Phase::Acceleration, None) => (LimitingKind::Acceleration, pattern.acceleration, limit.acceleration),
        (Phase::Deceleration, None) => (LimitingKind::Deceleration, pattern.deceleration, limit.deceleration),
        (Phase::Cruise | Phase::Hold, _) => (LimitingKind::Velocity, pattern.peak_velocity, Some(limit.velocity)),
    };
    limit.map(|limit| (kind, value.abs() / limit))
}

/// The tightest torque in each phase of the pace joint.
fn torques_by_phase(
    problem: &Problem,
    patterns: &[Pattern],
    verification: &Verification,
    pace: usize,
) -> [Option<Limiting>; 3] {
    let duration = trajectory::duration(patterns);
    let motion = Trajectory::of_patterns(&problem.start, patterns);
    let phases: Vec<Phase> = (0..motion.segment_count())
        .map(|segment| patterns[pace].phase(motion.middle(segment), duration))
        .collect();
    let mut tightest: [Option<Limiting>; 3] = [None; 3];
    for point in &verification.points {
        let Some(limit) = problem.limits[point.joint].torque else {
            continue;
        };
        let phase = phases[point.segment];
        let slot = match phase {
            Phase::Acceleration => &mut tightest[0],
            Phase::Cruise | Phase::Hold => &mut tightest[1],
            Phase::Deceleration => &mut tightest[2],
        };
        let utilization = point.torque(1.0).abs() / limit;
        if slot.is_none_or(|known| utilization > known.utilization) {
            *slot = Some(Limiting {
                kind: LimitingKind::Torque,
                joint: point.joint,
                time: point.time,
                phase,
                utilization,
            });
        }
    }
    tightest
}
