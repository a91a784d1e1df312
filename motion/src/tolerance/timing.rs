//! The timing of paths.

use super::VERIFY_RESERVE;

/// Nodes of a timing grid closer than this part of the path are one: rounding of knots that were computed twice.
pub(crate) const GRID_NODES_APART: f64 = 1.0e-12;

/// Largest squared path velocity that is planned where nothing bounds it, 1/s².
pub(crate) const PATH_SPEED_SQUARED_MAX: f64 = 1.0e12;

/// How far from the middle of a panel of the integral for time the squared path velocity has no root, in half widths: Gauss
/// and Legendre's six points then leave a relative error below 1e-11. Pinned by `durations_are_those_of_closed_forms` and
/// `a_dip_of_the_speed_within_a_piece_takes_its_time`.
pub(crate) const LAW_PANEL_CLEAR: f64 = 3.5;

/// Shortest panel, as part of its piece: a dip of the speed that is narrower is rest.
pub(crate) const LAW_PANEL_LEAST: f64 = 1.0e-6;

/// Most panels of one piece: a dip as narrow as that takes some hundred.
pub(crate) const LAW_PANELS_MAX: usize = 512;

/// Rounds of Newton's method from a time to a place; two or three do, bisection alone would take fifty.
pub(crate) const LAW_INVERSE_ROUNDS: usize = 60;

/// A place is found when its time is met to this part of its piece's duration: rounding.
pub(crate) const LAW_INVERSE_TIME: f64 = 1.0e-15;

/// Least pivot of the jerk solver's normal equations, which are positive definite but for rounding.
pub(crate) const PIVOT_FLOOR: f64 = 1.0e-300;

/// Part of the room between static torque and its limit that tightening leaves at least: slower always helps, so
/// tightening further than this is left to the uniform slow-down.
pub(crate) const TORQUE_ROOM_MIN: f64 = 0.25;

/// Most iterations of one solve of the jerk problem; 10 to 40 are usual, and every iterate obeys the limits.
pub(crate) const JERK_ITERATIONS: usize = 100;

/// Most halvings of a step of the jerk solver; one is rare.
pub(crate) const JERK_BACKTRACKS: usize = 30;

/// Least ṡ² of a starting profile as part of its largest: a solve must begin within its limits, not on them.
pub(crate) const JERK_START_FLOOR: f64 = 1.0e-9;

/// Intervals of the coarse grid of the jerk solver: its solution is within a few percent, and its work a tenth of that on
/// the fine one.
pub(crate) const JERK_COARSE_INTERVALS: usize = 80;

/// Fewest intervals of the fine grid that are asked for: fewer would not follow the phases of constant jerk.
pub(crate) const JERK_INTERVALS_MIN: usize = 40;

/// Duality gap at which a solve ends, as part of the duration, on the fine and on the coarse grid. On the fine one it is below
/// what the grid and the certificate cost.
pub(crate) const JERK_GAP: f64 = 1.0e-3;
pub(crate) const JERK_GAP_COARSE: f64 = 2.0e-2;

/// Most rounds of tightening limits between samples and solving again; one or two do.
pub(crate) const JERK_ROUNDS: usize = 3;

/// The same where a speed at an end is given, so that slowing down evenly is no way out; three to six do.
pub(crate) const JERK_ROUNDS_MOVING: usize = 20;

/// Rounds of those that solve again to the end; one in fifty motions needs more, which then stay a few percent slower than
/// they could be.
pub(crate) const JERK_ROUNDS_SOLVED: usize = 10;

/// What the whole speed at an end is worth while it is raised, as a multiple of the duration: the largest speed that is
/// found is short of the largest that there is by about the square of its inverse.
pub(crate) const JERK_RAISE_WORTH: f64 = 100.0;

/// Duality gap at which raising a speed at an end stops short, as part of the duration: a thousandth of what it is worth.
pub(crate) const JERK_GAP_RAISED: f64 = 1.0e-1;

/// Most heights of the first motion between two speeds at the ends, each a quarter of the one before.
pub(crate) const JERK_HUMPS: usize = 8;

/// Part of the speed that must be at stake for another round of tightening: below, slowing down evenly costs less
/// than what a solve leaves.
pub(crate) const JERK_ROUND_WORTH: f64 = 1.0e-3;

/// Tightening aims at this part of each limit, and takes away at most down to the second in one round: a peak
/// between two samples of a bad first grid is no measure of them.
pub(crate) const JERK_TIGHTEN_TO: f64 = 0.9995;
pub(crate) const JERK_TIGHTEN_MIN: f64 = 0.6;

/// Rounds of slowing down evenly; one or two do, unless viscous friction helps against gravity.
pub(crate) const JERK_SLOW_ROUNDS: usize = 40;

/// By how much slower than the certificate asks a motion is made: more than its rounding, far below every other loss.
pub(crate) const JERK_RESERVE: f64 = 1.0e-5;

/// Part of every limit that the timing leaves unused when it plans on samples: what is found between them is mostly below,
/// so that few timings need another round. Costs a quarter of it in time.
pub(crate) const TIMING_RESERVE: f64 = 5.0e-4;

/// Part of a torque limit that gravity and Coulomb friction must leave anywhere on the path: twice [`TIMING_RESERVE`], so
/// that every row has room left at standstill.
pub(crate) const STATIC_ROOM: f64 = 1.0e-3;

/// Facets of the polygon that stands for the circle of the tool's accelerations, a multiple of 4: 32 lose at most 0.5 %.
pub(crate) const TOOL_FACETS: usize = 32;

/// A row bounds no path acceleration where its coefficient is below this part of its right side, per 1/s²: even 1e8 1/s²
/// takes up a millionth of the limit then.
pub(crate) const REACH_ROW_FLAT: f64 = 1.0e-14;

/// Width, relative to the terms it is a difference of, below which two bounds of the path acceleration meet: rounding.
pub(crate) const REACH_WIDTH: f64 = 1.0e-13;

/// Rounds of Newton's method to the border of a set: it takes fewer than there are rows, three or four as a rule.
pub(crate) const REACH_ROUNDS: usize = 100;

/// Into how many parts the certificate of a timing divides an interval of its grid: a multiple of [`TIMING_PARTS`]. What a
/// cubic through neighbours leaves out is a fourth difference, some 1e-6 of a limit; ten parts find no more.
pub(crate) const CHECK_PARTS: usize = 4;

/// Fewest intervals that a path is timed with: fewer do not resolve one acceleration and one deceleration.
pub(crate) const TIMING_INTERVALS_MIN: usize = 16;

/// Into how many parts samples divide an interval of the timing. With b constant on an interval two keep torques to 0.1 %
/// between samples at 500 intervals; more cost time and gain nothing that tightening does not.
pub(crate) const TIMING_PARTS: usize = 2;

/// A timing keeps a limit where it takes at most this part of it: what [`TIMING_RESERVE`] leaves, but for the reserve of
/// whoever verifies the motion in time.
pub(crate) const CERTIFIED: f64 = 1.0 - 2.0 * VERIFY_RESERVE;

/// Rounds of planning again with less room where a limit was broken between samples. One to three do nearly always.
pub(crate) const TIGHTEN_ROUNDS: usize = 4;

/// Least part of its room that a round leaves a limit: what needs more is far from linear, and another round sees better.
pub(crate) const TIGHTEN_MOST: f64 = 0.6;

/// Part of a limit that slowing down evenly aims at: a little below what is certified, so that it ends.
pub(crate) const SLOWDOWN_AIM: f64 = 1.0 - 1.0e-5;

/// Passes with tangents of viscous torque where nothing is known yet: after two, a third gains below 0.1 % of the time.
pub(crate) const VISCOUS_PASSES: usize = 2;

/// Smallest squared path velocity of a tangent of viscous torque, as part of the largest on the path.
pub(crate) const REFERENCE_FLOOR: f64 = 1.0e-4;

/// Share of the grid's intervals that is spread evenly along the path; the rest is spread evenly in time.
pub(crate) const GRID_EVEN_SHARE: f64 = 0.5;

/// Rounds of bisection for the largest speed at the end of a path: evidence to a thousandth.
pub(crate) const BOUNDARY_ROUNDS: usize = 12;

/// Fewest intervals of a timing grid between two knots of the path: a blend, where accelerations rise and fall once or
/// twice, has that many even if it is short.
pub(crate) const SPAN_INTERVALS_MIN: usize = 8;

/// Knots and borders closer than this part of the path are one node for the jerk solver (both have samples, and both are
/// checked): its normal equations hold fourth powers of the ratio of path to interval, which leave no digits below.
pub(crate) const JERK_NODES_APART: f64 = 1.0e-4;

/// How many times as long as its neighbour an interval of the jerk solver's grid may be.
pub(crate) const JERK_INTERVALS_RATIO: f64 = 4.0;

/// The same where a speed at an end is given, so that slowing down evenly is no way out.
pub(crate) const TIGHTEN_ROUNDS_MOVING: usize = 12;

/// How often a path that no timing was found for is tried on a grid twice as fine: with speeds given at its ends, what is
/// between the samples of a coarse one can be too much for tightening.
pub(crate) const FINER_GRIDS: usize = 2;
