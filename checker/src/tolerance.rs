//! Every tolerance of the checker, with its reason.

use takt_motion::path::outcome::PathLimit;

/// Relative disagreement that the figures of one pattern may have among themselves.
///
/// A pattern is seven numbers with three equations between them, each a handful of roundings from the others; a short
/// move far from zero loses digits when its displacement is formed, but all seven come from that displacement. Pinned
/// by `tests/recheck.rs`.
pub const CONSISTENCY: f64 = 1e-9;

/// Disagreement between start + displacement and the target, relative to the larger of the positions and 1 rad or m.
///
/// One subtraction and one addition round by a few units in the last place; a planner may also leave out a motion that
/// no encoder sees. Pinned by `tests/recheck.rs`.
pub const ARRIVAL: f64 = 2e-12;

/// Switching times closer than this part of the duration are one.
///
/// Joints that switch together in exact arithmetic differ by roundings; where a switching time comes out of a root of a
/// difference (JP4358979B2, eq 94), by the root of a rounding, 1e-8 of the duration. What torque there is in the
/// nanoseconds between, no drive gives. The error in position by treating them as one is at most this part of the
/// displacement. Pinned by `tests/recheck.rs`.
pub const SWITCHING: f64 = 1e-7;

/// The same as a part of the shortest time in which any joint speeds up or slows down: no such time may be lost among
/// the switching times of others. Pinned by `tests/recheck.rs`.
pub const SWITCHING_OF_RAMP: f64 = 1e-3;

/// Patterns whose squared durations differ by less than this part take the same time, in the end-pose method: the
/// difference under the root of eq 94 is rounding, and its root would be a cruise.
pub const SAME_TIME: f64 = 1e-12;

/// Relative excess over a limit of a timed path above which the limit counts as broken. Torques, speeds and
/// accelerations follow from the set-points themselves, to rounding; 1e-6 is what no drive and no sensor sees. Jerk is
/// seen in third differences of positions alone, and bounds the wear of gears, not their strength: a thousandth.
/// Positions are to rounding within their range. Pinned by `tests/path_recheck.rs`.
#[must_use]
pub const fn path_excess(kind: PathLimit) -> f64 {
    match kind {
        PathLimit::Jerk => 1e-3,
        PathLimit::PositionLower | PathLimit::PositionUpper => 1e-9,
        PathLimit::Torque
        | PathLimit::Velocity
        | PathLimit::Acceleration
        | PathLimit::ToolVelocity
        | PathLimit::ToolAcceleration
        | PathLimit::ConstantSpeed
        | PathLimit::Rest => 1e-6,
    }
}

/// How far a set-point's time may be from its even place, and other times of a plan from each other, as part of the
/// duration: sums of some hundred rounded durations. Pinned by `tests/path_recheck.rs`.
pub const EVEN_TIMES: f64 = 1e-11;

/// Error of a set-point's position, as part of the larger of it and 1 rad or m: a few hundred units in the last place,
/// which is what following a tool path by Newton's method to the end leaves. Pinned by `tests/path_recheck.rs`.
pub const POSITION_ROUNDING: f64 = 1e-13;

/// Error of a set-point's velocity, as part of the joint's largest.
pub const RATE_ROUNDING: f64 = 1e-11;

/// Part of an excess's bar that the rounding of a difference may take up.
pub const ROUNDING_SHARE: f64 = 0.1;

/// Disagreement of two engines about a torque or a tool speed, as part of the plan's largest: they agree to 1e-12 on
/// random arms (docs/verification.md), and near standstill a part of the largest is what counts.
pub const DYNAMICS: f64 = 1e-9;

/// Distance, in m and rad, from a pose that counts as reached: twice what inverse kinematics promises.
pub const POSE: f64 = 2e-9;

/// Speed of a joint that counts as rest at a stop without a dwell, as part of its largest: a time that is rounded meets
/// the stop by a rounding too early or too late.
pub const REST: f64 = 1e-9;

/// Disagreement about the speed at an end of the path, relative.
pub const BOUNDARY_SPEED: f64 = 1e-6;

/// Acceleration of a joint, or of the tool at a metre's reach, that counts as none at an end of the path, as part of the
/// joints' largest: following the tool by inverse kinematics leaves some 1e-10 of it.
pub const BOUNDARY_ACCELERATION: f64 = 1e-6;

/// Disagreement about a limit in force or a margin, relative: a planner may keep a reserve of 1e-10 of each.
pub const SAME_LIMIT: f64 = 1e-9;

/// Rounding of a part of a segment.
pub const PART: f64 = 1e-9;

/// How far a time that a plan computes from a place may be off, s: near a stop the place moves as the square of the time,
/// and knows it to the root of its own rounding.
pub const STOP_TIME: f64 = 1e-7;

/// How much more room a plan may promise than was found: the bar itself; of a range, as much of it.
#[must_use]
pub const fn path_claim(kind: PathLimit) -> f64 {
    match kind {
        PathLimit::PositionLower | PathLimit::PositionUpper => 1e-6,
        other => path_excess(other),
    }
}

/// What a mean acceleration over a step may be beyond its neighbours', as part of the range of all, where no jerk limit
/// says more: a jump there and back within a hundredth of the step.
pub const BLIP: f64 = 1e-2;

/// Acceleration that says which way a joint at rest sets out, as part of the joint's largest; and the way, in rad or m, that
/// it must take a joint in the square of the plan's duration. What is smaller is the rounding of nothing.
pub const WAY: f64 = 1e-9;

/// Disagreement about a tool speed that is constant, or about the lowest one, relative: following the tool by inverse
/// kinematics leaves some 1e-10 of it.
pub const CONSTANT_SPEED: f64 = 1e-8;
