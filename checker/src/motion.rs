//! One joint's pattern as a motion over time, executed as a drive would: constant acceleration, constant velocity,
//! constant deceleration, each for its stated time, from rest. Nothing is taken from the stated displacement, so a
//! pattern whose figures disagree ends elsewhere, and is found out.

use takt_motion::plan::outcome::Pattern;

/// Position relative to the start, velocity and acceleration of one joint at one time, "rad or m".
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct JointState {
    /// Relative to the start.
    pub travelled: f64,
    /// First derivative.
    pub velocity: f64,
    /// Second derivative.
    pub acceleration: f64,
}

/// Part of a pattern.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// At rest, before or after, or all the time.
    Rest,
    /// The first part.
    Acceleration,
    /// The middle.
    Cruise,
    /// The last part.
    Deceleration,
}

/// A relation between the figures of a move that does not hold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inconsistency {
    /// Which relation.
    pub relation: Relation,
    /// Index of the joint.
    pub joint: usize,
    /// By how much it does not hold, relative to the larger side; infinite where a number is none.
    pub mismatch: f64,
}

/// What must hold between the figures of a move.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Relation {
    /// Every figure is a finite number.
    Finite,
    /// No time is negative.
    TimesNotNegative,
    /// Displacement, velocity, acceleration and deceleration have one sign.
    OneSign,
    /// Peak velocity = acceleration × acceleration time.
    Acceleration,
    /// Peak velocity = deceleration × deceleration time.
    Deceleration,
    /// Displacement = integral of the velocity.
    Displacement,
    /// A joint that is not displaced does not move.
    Still,
    /// All joints that move end together.
    EndTogether,
    /// Start + displacement = target.
    Arrival,
}

/// How long the pattern lasts, s.
#[must_use]
pub fn duration(pattern: &Pattern) -> f64 {
    pattern.acceleration_time + pattern.cruise_time + pattern.deceleration_time
}

/// The part of the pattern at `time`; at a switching time, the later part.
#[must_use]
pub fn part_at(pattern: &Pattern, time: f64) -> Part {
    let cruise_from = pattern.acceleration_time;
    let brake_from = cruise_from + pattern.cruise_time;
    if time < 0.0 || time >= brake_from + pattern.deceleration_time {
        Part::Rest
    } else if time < cruise_from {
        Part::Acceleration
    } else if time < brake_from {
        Part::Cruise
    } else {
        Part::Deceleration
    }
}

/// The time of one part that is closest to `time`. Where switching times of several joints count as one, a joint's own
/// part ends a moment before or begins a moment after: its law beyond that would have speeds that the joint never has.
#[must_use]
pub fn within(pattern: &Pattern, part: Part, time: f64) -> f64 {
    let cruise_from = pattern.acceleration_time;
    let brake_from = cruise_from + pattern.cruise_time;
    match part {
        Part::Rest => time,
        Part::Acceleration => time.min(cruise_from),
        Part::Cruise => time.clamp(cruise_from, brake_from),
        Part::Deceleration => time.clamp(brake_from, brake_from + pattern.deceleration_time),
    }
}

/// The state at `time` by the law of one part, also at its borders and a rounding beyond: so both sides of a switching
/// time can be had.
#[must_use]
pub fn state_in(pattern: &Pattern, part: Part, time: f64) -> JointState {
    let speed_up = pattern.acceleration_time;
    let brake_from = speed_up + pattern.cruise_time;
    let gained = 0.5 * pattern.acceleration * speed_up * speed_up;
    match part {
        Part::Rest if time <= 0.5 * duration(pattern) => JointState::default(),
        Part::Rest => JointState {
            travelled: travel(pattern),
            ..JointState::default()
        },
        Part::Acceleration => JointState {
            travelled: 0.5 * pattern.acceleration * time * time,
            velocity: pattern.acceleration * time,
            acceleration: pattern.acceleration,
        },
        Part::Cruise => JointState {
            travelled: gained + pattern.peak_velocity * (time - speed_up),
            velocity: pattern.peak_velocity,
            acceleration: 0.0,
        },
        Part::Deceleration => {
            let braking = time - brake_from;
            JointState {
                travelled: gained + pattern.peak_velocity * (pattern.cruise_time + braking)
                    - 0.5 * pattern.deceleration * braking * braking,
                velocity: pattern.peak_velocity - pattern.deceleration * braking,
                acceleration: -pattern.deceleration,
            }
        }
    }
}

/// Where executing the pattern ends, relative to the start.
#[must_use]
pub fn travel(pattern: &Pattern) -> f64 {
    state_in(pattern, Part::Deceleration, duration(pattern)).travelled
}

/// Calls `found` for every relation within one pattern that does not hold to `tolerance`, and whether all joints end
/// together after `common_duration`, s.
pub fn examine(pattern: &Pattern, common_duration: f64, tolerance: f64, mut found: impl FnMut(Relation, f64)) {
    let rates = [
        pattern.displacement,
        pattern.peak_velocity,
        pattern.acceleration,
        pattern.deceleration,
    ];
    let times = [
        pattern.acceleration_time,
        pattern.cruise_time,
        pattern.deceleration_time,
    ];
    if rates.iter().chain(&times).any(|value| !value.is_finite()) {
        found(Relation::Finite, f64::INFINITY);
        return;
    }
    let shortest = times.iter().copied().fold(f64::INFINITY, f64::min);
    if shortest < 0.0 {
        found(Relation::TimesNotNegative, -shortest);
    }
    if pattern.displacement == 0.0 {
        let largest = rates
            .iter()
            .chain(&times)
            .fold(0.0, |most: f64, value| most.max(value.abs()));
        if largest > 0.0 {
            found(Relation::Still, largest);
        }
        return;
    }
    let sign = pattern.displacement.signum();
    if rates.iter().any(|rate| rate * sign <= 0.0) {
        found(Relation::OneSign, f64::INFINITY);
    }
    let mut compare = |relation, one: f64, other: f64| {
        let mismatch = relative_difference(one, other);
        if mismatch > tolerance {
            found(relation, mismatch);
        }
    };
    compare(
        Relation::Acceleration,
        pattern.peak_velocity,
        pattern.acceleration * pattern.acceleration_time,
    );
    compare(
        Relation::Deceleration,
        pattern.peak_velocity,
        pattern.deceleration * pattern.deceleration_time,
    );
    let ramps = 0.5 * (pattern.acceleration_time + pattern.deceleration_time);
    compare(
        Relation::Displacement,
        pattern.displacement,
        pattern.peak_velocity * (pattern.cruise_time + ramps),
    );
    compare(Relation::Displacement, pattern.displacement, travel(pattern));
    compare(Relation::EndTogether, common_duration, duration(pattern));
}

/// |one − other| over the larger magnitude; 0 where both are 0.
fn relative_difference(one: f64, other: f64) -> f64 {
    let scale = one.abs().max(other.abs());
    if scale == 0.0 {
        return 0.0;
    }
    (one - other).abs() / scale
}
