//! The conventional pattern: fixed accelerations per joint, ends synchronized (JP4358979B2, eq 41 to 51 and 67 to 69).

use super::outcome::Pattern;
use super::problem::Problem;
use crate::tolerance::{RATE_RESERVE, SQUARE_ROUNDING};

/// The raw preset pattern of a move, unchecked; `None` where a joint that moves has no preset acceleration.
pub(super) fn plan(problem: &Problem) -> Option<Vec<Pattern>> {
    let own: Option<Vec<Pattern>> = (0..problem.start.len())
        .map(|joint| {
            if !problem.moves(joint) {
                return Some(still());
            }
            let (acceleration, deceleration) = preset(problem, joint)?;
            Some(first_calculation(
                problem.displacement[joint],
                speed(problem, joint),
                acceleration,
                deceleration,
            ))
        })
        .collect();
    Some(synchronize(&own?))
}

/// The preset accelerations of a joint, within the limits of this move.
pub(super) fn preset(problem: &Problem, joint: usize) -> Option<(f64, f64)> {
    let preset = problem.presets[joint]?;
    let limit = &problem.limits[joint];
    let within = |value: f64, limit: Option<f64>| limit.map_or(value, |limit| value.min(limit * (1.0 - RATE_RESERVE)));
    Some((
        within(preset.acceleration, limit.acceleration),
        within(preset.deceleration, limit.deceleration),
    ))
}

/// The speed that a joint may have, less the reserve for rounding.
pub(super) fn speed(problem: &Problem, joint: usize) -> f64 {
    problem.limits[joint].velocity * (1.0 - RATE_RESERVE)
}

/// The pattern of a joint that does not move.
pub(super) fn still() -> Pattern {
    Pattern::default()
}

/// "First calculation": the fastest pattern over a signed displacement with positive speed, acceleration and
/// deceleration; a triangle where the speed is not reached.
pub(super) fn first_calculation(displacement: f64, velocity: f64, acceleration: f64, deceleration: f64) -> Pattern {
    let distance = displacement.abs();
    let (up, down) = (velocity / acceleration, velocity / deceleration);
    let ramps = 0.5 * velocity * (up + down);
    // eq 46: a triangle of the same accelerations scales with the root of the distance
    let f = (distance / ramps).sqrt().min(1.0);
    let cruise = if f < 1.0 { 0.0 } else { (distance - ramps) / velocity };
    let sign = displacement.signum();
    Pattern {
        displacement,
        peak_velocity: sign * velocity * f,
        acceleration: sign * acceleration,
        deceleration: sign * deceleration,
        acceleration_time: up * f,
        cruise_time: cruise,
        deceleration_time: down * f,
    }
}

/// "Second calculation": the pattern of given accelerations that takes exactly `time` (eq 90 to 97); `None` where there
/// is none.
pub(super) fn second_calculation(
    displacement: f64,
    velocity: f64,
    acceleration: f64,
    deceleration: f64,
    time: f64,
) -> Option<Pattern> {
    let distance = displacement.abs();
    let per_speed = (acceleration + deceleration) / (acceleration * deceleration);
    // eq 94
    let square = time * time - 2.0 * distance * per_speed;
    let rounding = SQUARE_ROUNDING * time * time;
    if square < -rounding {
        return None;
    }
    let sign = displacement.signum();
    if square <= rounding {
        // A triangle but for rounding, whose root would be a cruise of a millionth of the time. The triangle that takes
        // the time exactly has accelerations that differ from the given ones by as little as the square does.
        let peak = 2.0 * distance / time;
        if peak > velocity * (1.0 + SQUARE_ROUNDING) {
            return None;
        }
        let up = time * deceleration / (acceleration + deceleration);
        let down = time - up;
        return Some(Pattern {
            displacement,
            peak_velocity: sign * peak,
            acceleration: sign * peak / up,
            deceleration: sign * peak / down,
            acceleration_time: up,
            cruise_time: 0.0,
            deceleration_time: down,
        });
    }
    let peak = (time - square.sqrt()) / per_speed;
    if peak > velocity * (1.0 + SQUARE_ROUNDING) {
        return None;
    }
    let (up, down) = (peak / acceleration, peak / deceleration);
    Some(Pattern {
        displacement,
        peak_velocity: sign * peak,
        acceleration: sign * acceleration,
        deceleration: sign * deceleration,
        acceleration_time: up,
        // what is left of the time, so that all joints end together to the last bit that matters
        cruise_time: (time - up - down).max(0.0),
        deceleration_time: down,
    })
}

/// Slows every pattern down so that it ends with the slowest (eq 67 to 69).
pub(super) fn synchronize(own: &[Pattern]) -> Vec<Pattern> {
    let slowest = own.iter().map(Pattern::duration).fold(0.0, f64::max);
    own.iter()
        .map(|pattern| {
            if pattern.moves() {
                return pattern.slowed(pattern.duration() / slowest);
            }
            *pattern
        })
        .collect()
}

impl Pattern {
    /// The same pattern at a part of its speed.
    pub(super) fn slowed(&self, part: f64) -> Self {
        Self {
            displacement: self.displacement,
            peak_velocity: self.peak_velocity * part,
            acceleration: self.acceleration * part * part,
            deceleration: self.deceleration * part * part,
            acceleration_time: self.acceleration_time / part,
            cruise_time: self.cruise_time / part,
            deceleration_time: self.deceleration_time / part,
        }
    }
}
