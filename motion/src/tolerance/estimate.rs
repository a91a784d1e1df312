//! Friction from telemetry.

/// Most samples of one block of telemetry: ten seconds at 1 kHz, a hundred times what a stream sends at once.
pub const TELEMETRY_SAMPLES_MAX: usize = 10_000;

/// Largest speed in telemetry, rad/s or m/s: beyond it a reading is broken, not fast.
pub(crate) const TELEMETRY_VELOCITY_MAX: f64 = 1.0e3;

/// Largest acceleration in telemetry, rad/s² or m/s².
pub(crate) const TELEMETRY_ACCELERATION_MAX: f64 = 1.0e6;

/// Largest torque in telemetry at the joint, N m or N.
pub(crate) const TELEMETRY_TORQUE_MAX: f64 = 1.0e7;

/// Largest time of a sample, s: three hundred years on any clock. One sample beyond would make all others late.
pub(crate) const TELEMETRY_TIME_MAX: f64 = 1.0e10;

/// How long samples must come in order behind the last one before their clock is believed, s: no network holds samples back for so long, and a
/// stream loses no more of them when a clock is set.
pub(crate) const TELEMETRY_CLOCK_SET: f64 = 1.0;

/// What times between samples are whole multiples of, s: 60 ns, a twentieth of what a drive's clock resolves, and 6e-5 of a
/// millisecond at most. A power of two, so that multiples are exact.
pub(crate) const TELEMETRY_STEP_GRID: f64 = 1.0 / 16_777_216.0;

/// Shortest time between two samples, s: below it differences of positions are rounding.
pub(crate) const TELEMETRY_STEP_MIN: f64 = 1.0e-6;

/// Samples that an estimator takes in between two looks at the budget: some microseconds each at 32 joints.
pub(crate) const TELEMETRY_BUDGET_STRIDE: usize = 256;

/// Smallest λ: a memory of two samples, fewer than a law has coefficients.
pub(crate) const ESTIMATE_LAMBDA_MIN: f64 = 0.5;

/// Bandwidth of the estimator's filter, Hz: below, its delay is a minute; above, it filters nothing at any drive's sample time.
pub(crate) const ESTIMATE_BANDWIDTH_MIN: f64 = 0.01;
pub(crate) const ESTIMATE_BANDWIDTH_MAX: f64 = 1.0e4;

/// What options of an estimator and entries of a prior may be between, whatever their unit: far outside of anything physical, and
/// far from overflow in a product of four.
pub(crate) const ESTIMATE_DEVIATION_MIN: f64 = 1.0e-9;
pub(crate) const ESTIMATE_DEVIATION_MAX: f64 = 1.0e12;

/// How long a filter remembers, in its time constants 1/a: exp(−x)·(1 + x + x²/2) is 0.3 % of a step at x = 10.
pub(crate) const ESTIMATE_FILTER_MEMORY: f64 = 10.0;

/// The same for the observer's lag, in 1/L: exp(−5) is 0.7 %.
pub(crate) const ESTIMATE_OBSERVER_MEMORY: f64 = 5.0;

/// Length of the shortest blocks of residuals, s; the others are 4 and 16 times as long. Residuals of real arms stay alike for 0.1
/// to 0.4 s, with a wrong body for seconds.
pub(crate) const ESTIMATE_BLOCK_SECONDS: f64 = 0.25;

/// Fewest blocks that a variance is taken from: Student's interval is then 30 % wider than the normal one.
pub(crate) const ESTIMATE_BLOCKS_MIN: f64 = 8.0;

/// Seconds of motion over which residuals' moments are taken.
pub(crate) const ESTIMATE_SPREAD_SECONDS: f64 = 10.0;

/// Standard deviation of residuals that is assumed where none is given, as part of the joint's peak torque.
pub(crate) const ESTIMATE_NOISE_PART: f64 = 0.01;

/// Standard deviation of each term at full speed that is assumed of a model's friction, as part of the joint's peak torque: friction
/// is 5 to 30 % of it.
pub(crate) const ESTIMATE_PRIOR_PART: f64 = 0.3;

/// Peak torque, N m or N, and speed limit, rad/s or m/s, of a joint whose description has none: they only make units comparable.
pub(crate) const ESTIMATE_TORQUE_DEFAULT: f64 = 100.0;
pub(crate) const ESTIMATE_VELOCITY_DEFAULT: f64 = 2.0;

/// Motion that an estimate takes, over the time for which residuals stay alike: ten independent pieces of evidence.
pub(crate) const ESTIMATE_MOTION_MIN: f64 = 10.0;

/// Standard deviation of the speed's magnitude that separates viscous from Coulomb friction, over its mean; a term in speed
/// squared takes twice that.
pub(crate) const ESTIMATE_SPEED_SPREAD_MIN: f64 = 0.1;

/// Standard deviation of the gravity torque's magnitude that separates the load's friction, over its mean.
pub(crate) const ESTIMATE_LOAD_SPREAD_MIN: f64 = 0.1;

/// A coefficient is told by the samples where its standard error is below this part of what it was beforehand.
pub(crate) const ESTIMATE_TOLD_PART: f64 = 0.5;

/// Variance of a sum of coefficients, over the sum of its terms' own, that counts as none: what rounding leaves of a sum that was set to a bound.
pub(crate) const SETTLED_VARIANCE: f64 = 1.0e-12;
