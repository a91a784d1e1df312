//! Every tolerance of the checker, with its reason.

/// Relative disagreement that the figures of one pattern may have among themselves.
///
/// A pattern is seven numbers with three equations between them, each a handful of roundings from the others; a short
/// move far from zero loses digits when its displacement is formed, but all seven come from that displacement. Pinned
/// by `tests/recheck.rs`.
pub const CONSISTENCY: f64 = 1e-9;

/// Disagreement between start + displacement and the target, relative to the larger of the positions and 1.
///
/// One subtraction and one addition: a few units in the last place. Pinned by `tests/recheck.rs`.
pub const ARRIVAL: f64 = 1e-14;

/// Switching times closer than this part of the duration are one.
///
/// Joints that switch together in exact arithmetic differ by roundings, and no drive feels the torque of the 1e-16 s
/// between. The error in position by treating them as one is at most this part of the displacement. Pinned by
/// `tests/recheck.rs`.
pub const SWITCHING: f64 = 1e-11;
