//! Every tolerance and cap of the planner and the verifier: what it is, in which unit, and why it has its value.

mod confidence;
mod estimate;
mod fit;
mod kinematics;
mod log;
mod path;
mod rehearsal;
mod timing;

pub(crate) use confidence::*;
pub use estimate::TELEMETRY_SAMPLES_MAX;
pub(crate) use estimate::*;
pub(crate) use fit::*;
pub(crate) use kinematics::*;
pub(crate) use log::*;
pub(crate) use path::*;
pub use path::{BEZIER_POINTS_MAX, SEGMENTS_MAX, SPLINE_POINTS_MAX, TARGETS_MAX};
pub(crate) use rehearsal::*;
pub(crate) use timing::*;

/// Part of every torque limit that the planner leaves unused. It plans on samples and so meets a limit only to within
/// what is between them; the exchange in `plan/verified.rs` brings that below this reserve. Costs about half of it in
/// time.
pub(crate) const PLAN_RESERVE: f64 = 1.0e-5;

/// Part of every torque limit that a verified plan must leave unused: ten times the error of the verifier's extremes,
/// a tenth of [`PLAN_RESERVE`]. Pinned by `extremes_are_true_to_a_tenth_of_the_reserve`.
pub(crate) const VERIFY_RESERVE: f64 = 1.0e-6;

/// Part of every speed and acceleration limit that plans leave unused, against the rounding of whoever evaluates the
/// pattern.
pub(crate) const RATE_RESERVE: f64 = 1.0e-10;

/// Joint travel between two samples of the verifier and the planner, rad or m, summed over joints. Torques along a
/// path are sums of sines of up to twice the summed angles: a tenth of a radian each resolves them to 1e-3 before
/// refinement, 1e-8 after.
pub(crate) const SAMPLE_TRAVEL: f64 = 0.2;

/// Fewest intervals that a stretch of constant acceleration is sampled with.
pub(crate) const INTERVALS_MIN: usize = 8;

/// Rounds of successive parabolic interpolation on an extreme; most need three or four.
pub(crate) const REFINE_ROUNDS: usize = 8;

/// An extreme is found once two parabolas in a row promise to raise it by less than this part of the limit. One alone
/// may peak where it has its middle although the torque does not.
pub(crate) const REFINE_GAIN: f64 = 1.0e-9;

/// Rounds of planning, verifying and adding what verification found. Two do nearly always.
pub(crate) const EXCHANGE_ROUNDS: usize = 10;

/// Rounds of slowing a plan down and verifying it again.
pub(crate) const SLOW_ROUNDS: usize = 24;

/// Slowest that a plan is made, as part of its first speed; what is slower yet counts as infeasible.
pub(crate) const SLOWEST: f64 = 1.0e-3;

/// Largest path acceleration that is planned where nothing bounds it, 1/s².
pub(crate) const PATH_ACCELERATION_MAX: f64 = 1.0e8;

/// Shorter than this part of the way, a cruise is left out: the pattern is a triangle.
pub(crate) const CRUISE_MIN: f64 = 1.0e-6;

/// Relative rounding of a difference of squared times, where it stands for 0: a few hundred units in the last place.
pub(crate) const SQUARE_ROUNDING: f64 = 1.0e-12;

/// Joint travel below which a joint counts as standing still, rad or m: far below any encoder's step.
pub(crate) const TRAVEL_MIN: f64 = 1.0e-12;

/// Largest sum of joint travels of one request, rad or m: it bounds the samples, so time and memory.
pub const TRAVEL_MAX: f64 = 2.0e3;

/// Largest sum of joint travels of a foreign trajectory, rad or m: an hour of hard work of six joints.
pub(crate) const TRAJECTORY_TRAVEL_MAX: f64 = 2.0e4;

/// Largest position of a joint, rad or m; sines keep full accuracy to ten times as far.
pub const POSITION_MAX: f64 = 1.0e5;

/// Switching times closer than this part of the duration are one: those of joints that switch together differ by
/// rounding.
pub(crate) const SWITCH_APART: f64 = 1.0e-13;

/// How far outside its range a start may be, as part of the range: an encoder's noise at the end stop.
pub(crate) const START_SLACK: f64 = 1.0e-3;

/// Most set-points or trace samples of one plan: over three minutes at 1 kHz; 32 joints of them take 200 MB.
pub const SETPOINTS_MAX: usize = 200_000;

/// Longest plan, s; beyond it, a speed or acceleration limit is not meant as it is written.
pub const DURATION_MAX: f64 = 1.0e6;

/// Relative excess that the check of a foreign trajectory forgives: the rounding of decimal text.
pub(crate) const CHECK_EXCESS: f64 = 1.0e-9;

/// Most points of a foreign trajectory.
pub const TRAJECTORY_POINTS_MAX: usize = 100_000;

/// Shortest time between two points of a foreign trajectory, s: below any controller's cycle by a factor of a thousand.
pub(crate) const POINT_SPACING_MIN: f64 = 1.0e-7;

/// Halvings until an interval is at the rounding of its ends.
pub(crate) const BISECTIONS: usize = 52;

/// Steps of the golden-section search between two samples: they shorten 1/32 to 3e-12, the error at a kink.
pub(crate) const GOLDEN_STEPS: usize = 48;

/// Points of a path that are computed between two looks at the budget: under a millisecond of inverse kinematics.
pub(crate) const BUDGET_STRIDE: usize = 64;

/// Error of a position that the simulated arm may make in one step of its integrator, rad or m: far below what the distance of nodes
/// costs, and hardly dearer than 1e-8, since transmissions and nodes shorten the steps anyway.
/// Gravity torque that counts as none where a load passes zero, as part of the largest on the way: a kink of friction that
/// is missed there is as small, a thousandth of [`VERIFY_RESERVE`].
pub(crate) const KINK_FLOOR: f64 = 1.0e-9;

/// Part of a stretch that separates two kinks, or one from its end: closer, what is between them takes less than the floor.
pub(crate) const KINK_APART: f64 = 1.0e-9;

/// Steps of the regula falsi on a zero of the load; from samples that resolve it, six to ten do. What is reached then is taken.
pub(crate) const KINK_ROUNDS: usize = 40;

/// Parabolas that follow a load that dips towards zero between samples, before it is taken not to reach it.
pub(crate) const KINK_DIP_ROUNDS: usize = 6;
