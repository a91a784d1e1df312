//! Every tolerance of the checker, with its reason.

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
