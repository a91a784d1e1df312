//! Timing of paths under limits.

pub(crate) mod jerk;
