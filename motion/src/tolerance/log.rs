//! Logs that are not in the units and directions that they are taken for.

/// Time over which positions and speeds of a log are compared, s: long against a cycle and the rounding of an encoder, short against a
/// stroke.
pub(crate) const LOG_WINDOW: f64 = 0.1;

/// Fewest windows that a hint is made from: two seconds of motion. Torques that have nothing to do with the model's have a correlation of
/// 1/√20, a quarter of [`LOG_CORRELATION_MIN`].
pub(crate) const LOG_WINDOWS_MIN: u32 = 20;

/// Least correlation, either way, at which two signals are the same but for a factor. Torque beside that of a model without friction or
/// with a body half as heavy has more.
pub(crate) const LOG_CORRELATION_MIN: f64 = 0.8;

/// How far a ratio may be from the factor between two units, as part of it: jitter of time stamps and the delay of a drive's speed take a few
/// per cent, and the next factor is seventeen times as far.
pub(crate) const LOG_RATIO_SLACK: f64 = 0.2;

/// How far beyond its range a position is another unit, over the range: an arm that is off by less has been calibrated otherwise.
pub(crate) const LOG_RANGE_EXCESS: f64 = 0.5;

/// What a speed is over its limit when it is another unit: overshoot and noise stay below.
pub(crate) const LOG_SPEED_EXCESS: f64 = 3.0;

/// What a torque is over the drive's peak when it is another unit or a broken sample: drives overshoot by less, and peak torques in
/// descriptions are right within that.
pub(crate) const LOG_TORQUE_EXCESS: f64 = 5.0;

/// How far what was converted may be beyond its limit, over it: encoders and overshoot.
pub(crate) const LOG_WITHIN: f64 = 0.05;

/// Mean time between samples, s, from which on they cannot be a drive's: friction has changed direction in between.
pub(crate) const LOG_STEP_MAX: f64 = 0.5;
