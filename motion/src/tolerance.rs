//! Every tolerance and cap of the planner and the verifier: what it is, in which unit, and why it has its value.

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

/// A duration that exceeds a whole number of cycles by less than this part has that number.
pub(crate) const LAW_CYCLE_ROUNDING: f64 = 1.0e-12;
/// Largest distance of the tool from a pose that counts as reached, m: a thousandth of what the best arm repeats.
pub(crate) const IK_POSITION: f64 = 1.0e-9;

/// The same for its orientation, rad: at a metre from the wrist it moves the tool by as much.
pub(crate) const IK_ORIENTATION: f64 = 1.0e-9;

/// Gap of inverse kinematics, over the arm's size and in rad, that is rounding: a few units in the last place.
pub(crate) const IK_ROUNDING: f64 = 1.0e-15;

/// Shortest size of an arm, m, where positions are measured against it: a chain without any extent is all wrist.
pub(crate) const IK_SIZE_MIN: f64 = 1.0e-3;

/// Most steps of one Newton run. From near a solution four do; from anywhere the median is ten.
pub(crate) const IK_ITERATIONS: usize = 80;

/// Damping that is always there, against a squared singular value of order 1: it only keeps pivots above 0.
pub(crate) const IK_DAMPING_FLOOR: f64 = 1.0e-18;

/// Damping over the squared gap at which a run ends: steps are then below rounding, and did not help.
pub(crate) const IK_DAMPING_MAX: f64 = 1.0e12;

/// Part of the squared gap by which an accepted step must lower it: less is a minimum that is not a solution.
pub(crate) const IK_STALLED: f64 = 1.0e-7;

/// Longest step of one joint, rad or m: beyond about a radian the Jacobian says nothing.
pub(crate) const IK_STEP_MAX: f64 = 1.0;

/// Rounds of moving a solution along what its pose leaves free. From near the reference two or three do.
pub(crate) const IK_ATTRACTION_ROUNDS: usize = 40;

/// Step along what a pose leaves free, rad or m, below which the solution is the nearest to the reference: its distance
/// is then the least to 1e-16.
pub(crate) const IK_FREE_STEP: f64 = 1.0e-8;

/// Squared singular value over the sum of all, below which a direction counts as free: a millionth of the arm's speed.
pub(crate) const IK_RANK: f64 = 1.0e-12;

/// Part of a joint's own motion that must be free of the tool for it to be held at the end of its range.
pub(crate) const IK_FREE_PART: f64 = 1.0e-3;

/// How far outside its range a joint may be by rounding, rad or m; it is put onto the end.
pub(crate) const IK_RANGE_SLACK: f64 = 1.0e-11;

/// Largest joint difference of two solutions that are one, rad or m: at a double solution, where a pose that is true to
/// 1e-9 leaves the square root of that open.
pub(crate) const IK_DISTINCT: f64 = 1.0e-4;

/// Most starts of the search for all solutions of a chain.
pub(crate) const IK_STARTS: usize = 256;

/// Starts in a row without a new solution that end the search.
pub(crate) const IK_PATIENCE: usize = 40;

/// The same where only the solution nearest to a reference is asked for, and that is not near.
pub(crate) const IK_PATIENCE_NEAR: usize = 12;

/// Largest joint difference from the reference, rad or m, at which the solution that Newton steps lead to is taken for the
/// nearest: other branches are further apart.
pub(crate) const IK_NEAR: f64 = 0.5;

/// Steps times joints that end the search: some milliseconds.
pub(crate) const IK_WORK: usize = 20_000;

/// Most copies by whole turns of all solutions together.
pub(crate) const IK_COPIES_MAX: usize = 1024;

/// Most steps to the smallest eigenvalue of a 6 × 6 matrix; four to six do.
pub(crate) const IK_EIGEN_ROUNDS: usize = 20;

/// Step over the trace that is rounding of the characteristic polynomial.
pub(crate) const IK_EIGEN_ROUNDING: f64 = 1.0e-16;

/// Rounds of slowing a timed path down and verifying it again, and of the bisection for how much. The timing is certified
/// already: one round at most is expected.
pub(crate) const PATH_SLOW_ROUNDS: usize = 40;

/// Part by which a path is slowed down more than the broken limit asks for, against the same excess a second time.
pub(crate) const PATH_SLOW_RESERVE: f64 = 1.0e-7;

/// Change of path speed over the whole duration, relative to the speed, below which it counts as constant.
pub(crate) const PATH_CRUISE: f64 = 1.0e-6;

/// Rounds of bisection for a place on a path: to the last bit.
pub(crate) const PATH_LOCATE_ROUNDS: usize = 60;
/// Exponent beyond which the tan-sigmoid counts as 0 or 1: exp(−300) is 1e-130, far below rounding, and every factor of
/// its derivatives is still finite.
pub(crate) const SIGMOID_EXPONENT_MAX: f64 = 300.0;

/// Rounds of Newton's method on the pace of a blend; four do for any ratio of its sides up to ten.
pub(crate) const PASSAGE_ROUNDS: usize = 60;

/// The place within a blend, 0 to 1, is known to so much: four units in the last place.
pub(crate) const PASSAGE_ROUNDING: f64 = 1.0e-15;

/// Part of a path's length within which a point counts as being at a knot: a thousand roundings of sums of lengths.
pub(crate) const KNOT_ROUNDING: f64 = 1.0e-13;

/// What is left of a segment between two blends counts as nothing below this part of it.
pub(crate) const SEAM_ROUNDING: f64 = 1.0e-9;

/// Samples of one polynomial or one blend for its mean and least pace: they set the scale of the path's parameter and
/// where a least value is sought, not the path.
pub(crate) const PACE_SAMPLES: usize = 32;

/// Panels of Gauss's rule with eight points by which the length of the tool's way on one curve is measured: true to 1e-9 for
/// a joint move of a full turn.
pub(crate) const WAY_PANELS: usize = 4;

/// The same on one polynomial of a spline.
pub(crate) const PIECE_PANELS: usize = 2;

/// Steps from a corner in which the end of a blend is sought before it is bisected.
pub(crate) const HELPER_SAMPLES: usize = 64;

/// Halvings until an interval is at the rounding of its ends.
pub(crate) const BISECTIONS: usize = 52;

/// Rounds of a golden section: the valley is then found to 1e-8 of its width, where the values differ by rounding.
pub(crate) const GOLDEN_ROUNDS: usize = 40;

/// Most segments of one program: as many as a long deburring path that was taught point by point.
pub const SEGMENTS_MAX: usize = 10_000;

/// Most taught points of one program, those of its splines included.
pub const TARGETS_MAX: usize = 20_000;

/// Most points of one spline: their equations are solved at once.
pub const SPLINE_POINTS_MAX: usize = 2_000;

/// Most control points of one Bezier curve after its start: its degree, beyond which powers lose digits.
pub const BEZIER_POINTS_MAX: usize = 10;

/// Steepest tan-sigmoid: the jerk of a blend goes with its cube, and at a hundred it is a step.
pub(crate) const SIGMOID_STEEPNESS_MAX: f64 = 100.0;

/// Travel below which a segment goes nowhere, rad or m: under any encoder's step, above the rounding of taught points.
pub(crate) const SEGMENT_MIN: f64 = 1.0e-9;

/// Shortest part that a blend may take of a segment, in seconds at full speed: a tenth of a micrometre for a fast arm.
/// Shorter, the blend's place on a path of hours loses its digits.
pub(crate) const BLEND_MIN: f64 = 1.0e-7;

/// Least pace of a path, as part of full speed at ṡ = 1. Below it the path turns back on itself and needs a stop; a corner
/// that only nearly does is that slow at 1e-4 rad from it.
pub(crate) const PACE_MIN: f64 = 1.0e-4;

/// Samples of each part of a blend for its deviation: chords miss an arc by a thousandth of its height.
pub(crate) const DEVIATION_SAMPLES: usize = 32;

/// Intervals of the grid that a path is timed on: the certified timing is then within 1 % of the optimum.
pub(crate) const TIMING_INTERVALS: usize = 500;

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
/// How far axes may be from meeting, over the arm's size, or from being parallel, rad, for a closed form to be used: the
/// calibrated kinematics of real arms are within it. Newton steps lead from the ideal arm's answer to the real one's.
pub(crate) const IK_GEOMETRY: f64 = 5.0e-3;

/// The same where the closed form is that of the arm itself, but for rounding.
pub(crate) const IK_IDEAL: f64 = 1.0e-9;

/// Distance of two axes over the arm's size below which they meet in a closed form's equations: these divide by its
/// square, which leaves six digits, and Newton steps do the rest. Nearly parallel axes count as parallel from
/// [`IK_GEOMETRY`] on, since the feet of their common perpendicular are far away.
pub(crate) const IK_SEPARATE: f64 = 1.0e-5;

/// Least sine between neighbouring axes of a wrist: below it, half of all rotations are out of reach.
pub(crate) const IK_BESIDE_MIN: f64 = 1.0e-2;

/// How far beyond a circle a solution may lie, of its squared radius, to count as touching it: the arm is stretched, and
/// rounding decides. Newton steps find out whether the pose is reached.
pub(crate) const IK_CLAMP: f64 = 1.0e-6;

/// Distance from a turn's axis of what it acts on, over the arm's size, below which its angle is left to the reference:
/// rounding of a cosine near 1 is an angle of 1e-8.
pub(crate) const IK_UNDETERMINED: f64 = 1.0e-7;

/// Relative step at which roots of a quartic are found: convergence is cubic, the next one is below rounding.
pub(crate) const IK_ROOT_ROUNDING: f64 = 1.0e-9;

/// Most rounds of the iteration for them; simple roots take six to eight, double ones thirty.
pub(crate) const IK_ROOT_ROUNDS: usize = 40;

/// Gap of a closed form's answer, over the arm's size and in rad, that is not worth a Newton step.
pub(crate) const IK_POLISHED: f64 = 1.0e-13;

/// The same below which the angle may be free: the distance is itself the root of a root of rounding where two
/// singularities come together.
pub(crate) const IK_NEARLY_FREE: f64 = 1.0e-4;
/// Terms of the square of half an angle in the distance of two quaternions: up to a right angle (a turn by π) each is half
/// of the one before, so that the third derivative is true to 1e-12.
pub(crate) const ANGLE_TERMS: usize = 52;

/// Terms of sin(√z)/√z up to (π/2)²: the last is 1e-20, and 1e-17 in the third derivative.
pub(crate) const SINC_TERMS: usize = 13;

/// Smallest pivot that is divided by, where lengths are parts of the arm's: the result stays finite, and is refused for
/// its singularity.
pub(crate) const RANK_MIN: f64 = 1.0e-30;

/// Largest joint step after which Newton's method counts as ended, rad or m: the derivatives that are taken before the
/// step are then true to as much.
pub(crate) const NEWTON_DONE: f64 = 1.0e-12;

/// Rounds of Newton's method: from a seed 1e-3 off it needs three, twelve tell that there is no answer near.
pub(crate) const NEWTON_ROUNDS: usize = 12;

/// Gap between a pose and the tool that counts as none, rad or parts of the arm's length: rounding of taught poses.
pub(crate) const CLOSED: f64 = 1.0e-9;

/// Largest difference between the predicted and the true joints of a step along a curve, rad or m. Branches are much
/// further apart wherever the Jacobian's smallest singular value is above [`SINGULAR_MIN`].
pub(crate) const SEED_ERROR: f64 = 1.0e-3;

/// Smallest singular value of the Jacobian, linear rows in parts of the arm's length, with which a curve of the tool is
/// followed: a wrist within 0.6° of straight. Closer, joint speeds are a hundred times the tool's.
pub(crate) const SINGULAR_MIN: f64 = 1.0e-2;

/// Shortest step along a curve of the tool, as part of it, before it counts as ended there.
pub(crate) const FOLLOW_MIN: f64 = 1.0e-5;

/// Most steps along one curve of the tool; a long weave takes hundreds.
pub(crate) const FOLLOW_STEPS: usize = 20_000;

/// How far the points of an arc may be off their circle, as part of its radius, and a normal off its direction: taught
/// points are rounded to tenths of a millimetre.
pub(crate) const ARC_MISFIT: f64 = 1.0e-3;

/// Sine of an angle below which three points of an arc lie on one line, and metres below which two of them are one.
pub(crate) const COLLINEAR: f64 = 1.0e-6;

/// Largest difference of joint positions that were found on two ways and are meant to be the same, rad or m: other
/// branches differ by far more, rounding and taught digits by less.
pub(crate) const SAME_BRANCH: f64 = 1.0e-6;

/// Places on the rest of a curve at which its reach is looked at, once it could not be followed.
pub(crate) const REACH_PROBES: usize = 8;

/// Largest angle between two orientations that are mixed, rad: at π there is no shortest way any more.
pub(crate) const BLEND_ANGLE_MAX: f64 = 3.0;

/// Rounds of a golden section about the sample of a blend that is furthest off: a hundredth of the step between samples.
pub(crate) const DEVIATION_ROUNDS: usize = 12;
/// Shortest segment, radius, tolerance and reach at constant speed, m: below what the best arms repeat.
pub(crate) const PROCESS_LENGTH_MIN: f64 = 1.0e-6;

/// Largest constant tool speed, m/s: a hundred times that of any arm, so that its square stays a number to compute
/// with.
pub(crate) const PROCESS_SPEED_MAX: f64 = 1.0e3;

/// Farthest that a segment may begin from where the one before it ends, m: rounding of taught points. A transition
/// takes it in.
pub(crate) const SEAM_GAP_MAX: f64 = 1.0e-9;

/// Farthest that an arc's start may be outside the circle's plane, as part of the radius: rounding of taught points.
pub(crate) const ARC_PLANE_SLACK: f64 = 1.0e-9;

/// Shortest half of a transition, s: below any servo cycle.
pub(crate) const TRANSITION_TIME_MIN: f64 = 1.0e-6;

/// Shortest half of a transition that is chosen, s: a few servo cycles, so that slow tools are not jerked for nothing.
pub(crate) const TRANSITION_TIME_LEAST: f64 = 0.01;

/// Shortest servo cycle, s.
pub(crate) const CYCLE_TIME_MIN: f64 = 1.0e-6;

/// Acceleration of the tool that transitions are chosen by where nobody says, m/s²: half of gravity's, which arms with
/// a torch or a nozzle have to spare. It lowers no speed.
pub(crate) const TRANSITION_ACCELERATION: f64 = 5.0;

/// Part of a cycle by which a count of cycles may be too large and still be whole: rounding of a quotient.
pub(crate) const CYCLE_SLACK: f64 = 1.0e-9;

/// Shorter than this part of the duration, what is between two transitions is rounding.
pub(crate) const STRETCH_MIN: f64 = 1.0e-13;

/// Jumps below this part of the speed, or of the transition's acceleration, are rounding. Pinned by
/// `random_chains_have_no_jumps`.
pub(crate) const JUMP_ROUNDING: f64 = 1.0e-9;

/// Samples of a transition in the search for its extremes: its curves are of the fifth degree.
pub(crate) const TRANSITION_SAMPLES: usize = 64;

/// Steps of the golden-section search between two samples: they shorten 1/32 to 3e-12, the error at a kink.
pub(crate) const GOLDEN_STEPS: usize = 48;

/// How close the deviation of a shortened transition is to its tolerance, as part of that.
pub(crate) const REACH_CLOSE: f64 = 1.0e-6;

/// Halvings in the search for a reach or a speed: to rounding.
pub(crate) const HALVINGS: usize = 50;

/// Rounds of lowering the speed until every transition keeps the tool's acceleration; the second nearly always
/// confirms the first.
pub(crate) const GENTLE_ROUNDS: usize = 8;

/// Rounds of lowering a constant speed until the arm can follow; torque limits near singularities take a few.
pub(crate) const CONSTANT_SLOW_ROUNDS: usize = 40;

/// Fewest intervals that the verifier samples of each stretch and transition at constant speed.
pub(crate) const CONSTANT_PARTS_MIN: usize = 16;

/// What a turn of one radian counts as, m, where the knots of a spline of the tool are spaced: the reach of a hand-held
/// tool, so that a turn takes about the time of the way that such a tool's tip makes.
pub(crate) const TURN_LENGTH: f64 = 0.1;

/// Samples of a path between two of its knots, where its joint ranges are looked at.
pub(crate) const RANGE_SAMPLES: usize = 16;

/// How near the end of its range a joint must come for its true extreme to be sought, rad or m: more than a cubic between
/// two samples can miss of it.
pub(crate) const RANGE_NEAR: f64 = 1.0e-2;

/// How far a joint may be outside its range, rad or m: the rounding of a taught point at the very end of it.
pub(crate) const RANGE_ROUNDING: f64 = 1.0e-9;

/// Pace at a sample, as part of full speed, above which a path cannot come to a stop before the next: with eight samples
/// a polynomial that turns back in its middle is passed at a third of full speed at most.
pub(crate) const VALLEY_MAX: f64 = 0.5;
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

/// Samples of each polynomial of a spline, where a single curve has [`PACE_SAMPLES`]: its pieces are short, so that chords
/// and means are as true.
pub(crate) const PIECE_SAMPLES: usize = 8;

/// Points of a path that are computed between two looks at the budget: under a millisecond of inverse kinematics.
pub(crate) const BUDGET_STRIDE: usize = 64;
/// How often a path that no timing was found for is tried on a grid twice as fine: with speeds given at its ends, what is
/// between the samples of a coarse one can be too much for tightening.
pub(crate) const FINER_GRIDS: usize = 2;
/// How far a sample's time may be from a stop to be the stop's, as part of the duration: some roundings of both.
pub(crate) const SAMPLE_AT_STOP: f64 = 1.0e-13;
/// Halvings of a bracket of the first maximum of a stiffness polynomial: from Cauchy's bound, which unequal coefficients make
/// large, down to rounding.
pub(crate) const TRANSMISSION_BISECTIONS: usize = 200;

/// Rounds of Newton's method from a torque to a deformation; four do, doubling and halving take the rest where it is flat.
pub(crate) const TRANSMISSION_ROUNDS: usize = 200;

/// A deformation is found when Newton's step is this part of it: some units in the last place.
pub(crate) const TRANSMISSION_ROUNDING: f64 = 1.0e-15;

/// How far a contact gives way before it slides where the model has no presliding stiffness, rad or m: friction with corners
/// has no solution that an integrator finds. It is below what an encoder at the joint resolves; the dry friction is off by more than
/// 1 % over 4.6 times that way after each turn.
pub(crate) const PRESLIDING_DEFAULT: f64 = 1.0e-4;

/// Part of the dry friction that may be missing from full sliding and counts as full: rounding.
pub(crate) const PRESLIDING_SETTLED: f64 = 1.0e-14;

/// A derivative jumps between two pieces of a motion if it changes by more than this part of its largest value: below it is
/// the rounding of decimal points. The same part of a period separates a sample from a jump.
pub(crate) const SMOOTH_JUMP: f64 = 1.0e-6;

/// Bandwidth of the joint controller, as part of the frequency at which the arm swings against a held motor: there, motor and arm
/// still move together to within 1/(1 − 1/9), an eighth.
pub(crate) const GAIN_RESONANCE: f64 = 1.0 / 3.0;

/// Periods in one over the bandwidth: the delay of one and a half of them costs 4° of phase.
pub(crate) const GAIN_SAMPLING: f64 = 20.0;

/// Damping ratio of the joint controller: the least that has next to no overshoot.
pub(crate) const GAIN_DAMPING: f64 = 0.7;

/// Largest K_d·T over the rotor's inertia: from 1 on, a speed that is known a period late drives the rotor alone unstable.
pub(crate) const GAIN_ROTOR: f64 = 0.25;

/// Largest torque-error gain: the rotor feels half as heavy.
pub(crate) const GAIN_TORQUE: f64 = 1.0;

/// Part of K_d that the torque error's delay may take.
pub(crate) const GAIN_TORQUE_DAMPING: f64 = 0.3;

/// Cut-off of the measured speed over the bandwidth: 6° of phase.
pub(crate) const GAIN_FILTER: f64 = 10.0;

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
/// Path speed that is rest at an end of a path, as part of the mean speed: the root of a place's rounding.
pub(crate) const PATH_AT_REST: f64 = 1.0e-6;

/// How far inside a path, as part of its length, its derivative says in which direction a joint sets out or arrives. Where
/// q′ is zero at the end itself, what is there is rounding; this far inside, q″ shows through it. A joint that turns back
/// nearer to the end moves by the square of this before it does: 1e-12 rad, at which it counts as standing.
pub(crate) const PATH_DEPARTURE: f64 = 1.0e-6;

/// How much larger than stated a use of a limit on a path may be between samples, as part of the limit: a fifth of the 1e-6
/// that no drive and no sensor sees. The search for it ends there.
pub(crate) const EXTREME_GAIN: f64 = 2.0e-7;

/// Most values that the search for one limit's maximum takes on a path: twenty do on average; a limit that is just used all
/// along the path takes one or two an interval.
pub(crate) const EXTREME_STEPS: usize = 8192;

/// Moments of a path closer than this part of its duration are one, when intervals are formed that nothing jumps within: a
/// place is passed at a time that is known to some 1e-15, and near a stop to the root of a rounding.
pub(crate) const BREAKS_APART: f64 = 1.0e-10;
/// Error of a position that the simulated arm may make in one step of its integrator, rad or m. Chosen by measurement: against an independent
/// integrator the positions of a swinging arm are off by less than 1e-7 after half a second (test in `drive/plant/tests.rs`); a tenth
/// of it costs a fifth more time.
pub(crate) const PLANT_POSITION: f64 = 1.0e-9;

/// The same of a speed, rad/s or m/s: as much at 100 rad/s, the frequency of a slow transmission.
pub(crate) const PLANT_VELOCITY: f64 = 1.0e-7;

/// First step of the simulated arm's integrator, s; it finds its own.
pub(crate) const PLANT_STEP_FIRST: f64 = 1.0e-4;

/// Part of the step's length that would just be good enough that is tried.
pub(crate) const PLANT_STEP_FACTOR: f64 = 0.9;

/// How much shorter the next step may be.
pub(crate) const PLANT_STEP_SHRINK: f64 = 0.25;

/// How much longer.
pub(crate) const PLANT_STEP_GROWTH: f64 = 4.0;

/// Most steps of the integrator in one step of the controller: at 1 kHz, a transmission of some hundred kHz. Stiffer ones are rigid.
pub(crate) const PLANT_STEPS_MAX: usize = 2_000;

/// Way back and forth within a step in which a joint turns round, as part of the presliding way. On the way back dry friction
/// is taken for what it was on the way out until the step ends, which is off by twice this part of it.
pub(crate) const PLANT_TURN_WAY: f64 = 1.0e-4;

/// Steps of the simulated arm's integrator between two looks at the budget: of 32 joints, 1 ms.
pub(crate) const PLANT_STRIDE: usize = 16;

/// How far a joint of the simulated arm may be from where the plan has it, rad or m: beyond, nothing is worth simulating.
pub(crate) const REHEARSAL_DIVERGED: f64 = 10.0;

/// Shortest period of a rehearsed controller, s: ten times as fast as any drive's current loop.
pub(crate) const REHEARSAL_PERIOD_MIN: f64 = 1.0e-6;

/// Longest period of a rehearsed controller, s: slower than any arm's.
pub(crate) const REHEARSAL_PERIOD_MAX: f64 = 0.1;

/// Largest scale of friction against the model's.
pub(crate) const FRICTION_SCALE_MAX: f64 = 1.0e3;

/// Poses of a motion at which the arm's inertia is looked at for gains: it varies slowly.
pub(crate) const GAIN_POSES: usize = 64;

/// Most wrenches of a rehearsal: each is looked at in every step.
pub(crate) const WRENCHES_MAX: usize = 100;

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

/// Variance of a learned friction coefficient at the start, over that of a sample: a twentieth of a second at 1 kHz
/// outweighs it, so that the first transient does not become the law.
pub(crate) const ADAPT_PRIOR: f64 = 0.02;

/// Speed below which no friction is learned, rad/s or m/s: the contact may not slide yet.
pub(crate) const ADAPT_REST: f64 = 0.02;

/// How long the controller remembers what it learned of friction, s: two or three moves; temperature takes minutes.
pub(crate) const ADAPT_MEMORY: f64 = 2.0;

/// Rate of the observer on the output's side over that on the motor's: at the same rate the slowest pole of an arm on its
/// transmission keeps 0.15 to 0.2 of critical damping, at a quarter 0.35 to 0.4.
pub(crate) const ADAPT_OUTPUT: f64 = 0.25;

/// Most samples of a recording: an hour at 100 Hz, ten minutes at 1 kHz, and more would wait in memory for nothing.
pub(crate) const FIT_SAMPLES_MAX: usize = 1_000_000;

/// Largest magnitude of anything in a recording: beyond any unit of an arm, with products of three that stay finite.
pub(crate) const FIT_VALUE_MAX: f64 = 1.0e9;

/// Lowest corner of a fit's filter, Hz: slower motion is holding.
pub(crate) const FIT_BAND_MIN: f64 = 0.1;

/// Highest corner of a fit's filter, Hz: above it the transmission, not the rigid arm, answers.
pub(crate) const FIT_BAND_MAX: f64 = 100.0;
/// Smallest part of a diagonal entry that a pivot of Cholesky's method may be in a fit: below it the parameter is not told by
/// anything, and rounding is what is left.
pub(crate) const PIVOT_PART_MIN: f64 = 1.0e-14;

/// Sweeps of Jacobi's method: it converges quadratically after three or four.
pub(crate) const JACOBI_SWEEPS: usize = 30;

/// Periods of a filter's corner by which a signal is continued beyond its ends: its answer has died away to 1e-4 after that.
pub(crate) const FILTER_PAD_PERIODS: f64 = 4.0;

/// Corner of the filter that positions and speeds go through, over the band: what it takes off within the band is 1e-4, and
/// products of positions within the band stay whole.
pub(crate) const KINEMATIC_BAND: f64 = 3.0;

/// Samples per period of the band at which the model is computed: its steps of friction are then a twentieth of a period.
pub(crate) const FIT_BAND_SAMPLES: f64 = 20.0;

/// Samples per period of the band that a recording must have: the corner at [`KINEMATIC_BAND`] is then below half of its rate.
pub(crate) const NATIVE_BAND_SAMPLES: f64 = 8.0;

/// Longest gap between two samples, in periods of the band: a straight line across half a period is no longer the motion.
pub(crate) const GAP_BANDS: f64 = 0.5;

/// Smallest radius of gyration about a body's own centre that a fit assumes where a description says less, m: that of a bolt.
pub(crate) const GYRATION_MIN: f64 = 0.01;

/// Rounds of Newton's method of a fit; from the description it takes about ten.
pub(crate) const FIT_NEWTON_ROUNDS: usize = 100;

/// Decrease, over the objective, at which a fit is at its least: its parameters are then true to 1e-5 of their deviation.
pub(crate) const FIT_NEWTON_DONE: f64 = 1.0e-12;

/// Part of the foreseen decrease that a step must bring (Armijo).
pub(crate) const FIT_DECREASE: f64 = 1.0e-4;

/// Halvings of a step before it counts as none: below 1e-9 of it is rounding.
pub(crate) const FIT_BACKTRACKS: usize = 30;

/// Degrees of freedom that residuals are compared with: from hardly any variance to none but the normal one's.
pub(crate) const STUDENT_DEGREES: [f64; 11] = [2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 15.0, 20.0, 30.0, 200.0];

/// Natural logarithm of how far the likeliest deviation of a residual may be from its root mean square, either way.
pub(crate) const STUDENT_SCALE_RANGE: f64 = 3.0;

/// Speed below which a joint is at rest to a fit, rad/s or m/s: friction is then between its two directions, and a model's torque is
/// uncertain by it.
pub(crate) const REST_SPEED: f64 = 0.02;

/// Shortest motion that is fitted, in periods of the band: as many stretches as the cross-validation leaves out.
pub(crate) const FIT_PERIODS_MIN: f64 = 10.0;

/// Stretches that a cross-validation leaves out in turn: with ten a fit loses a tenth of its data, and there are enough of them to
/// have a spread (R. Kohavi 1995).
pub(crate) const FIT_FOLDS: usize = 10;

/// Smallest singular value of scaled columns whose combination a motion tells: noise comes through fifty-fold there.
pub(crate) const EXCITATION_MIN: f64 = 0.02;

/// Smallest part of a combination that is named as part of it.
pub(crate) const EXCITATION_NAMED: f64 = 0.3;

/// Weights of the description that are tried. At 1 a body's parameters are held to about their own size, against a motion that
/// counts each stretch of correlated samples once.
pub(crate) const RIDGES: [f64; 9] = [0.1, 0.316, 1.0, 3.16, 10.0, 31.6, 100.0, 316.0, 1000.0];

/// Weight of the description before there is a cross-validation: the middle of [`RIDGES`].
pub(crate) const RIDGE_START: f64 = 10.0;

/// Least deflection before sliding that is tried, as part of the joint's travel: a step of an encoder of 14 bits.
pub(crate) const DEFLECTION_LEAST: f64 = 1.0e-4;

/// Greatest deflection before sliding that is tried, as part of the joint's travel.
pub(crate) const DEFLECTION_MOST: f64 = 0.1;

/// Deflections that are tried, a factor of 1.6 apart: the residual is flat about its least.
pub(crate) const DEFLECTION_STEPS: usize = 16;

/// Rounds of the search for deflections, between which the bodies are fitted again; the second changes one joint in seven.
pub(crate) const DEFLECTION_ROUNDS: usize = 3;

/// Part of a column's square that is added to it where friction is fitted beside fixed bodies: columns of a slow motion are
/// alike to 1e-3.
pub(crate) const FRICTION_SHRINK: f64 = 1.0e-4;

/// The same where a joint's torque is explained by its own columns alone, to find its noise: directions of less than a
/// thousandth are not used.
pub(crate) const ALONE_SHRINK: f64 = 1.0e-6;

/// Most samples that the likelihood of a noise is taken over: neighbours are alike, and more change nothing.
pub(crate) const NOISE_SAMPLES_MAX: usize = 5_000;

/// Standard deviation of load-dependent friction before it is fitted, Coulomb torque over gravity torque: what is published for
/// harmonic and planetary gears.
pub(crate) const LOAD_COULOMB_DEVIATION: f64 = 0.05;

/// Numbers that the equations of a fit may have: 160 MB, ten minutes of seven joints.
pub(crate) const FIT_ENTRIES_MAX: usize = 20_000_000;

/// Radius of gyration about its own centre that a payload is drawn to where none is described, m: that of a small gripper.
pub(crate) const PAYLOAD_GYRATION: f64 = 0.05;

/// Ranges of position or speed that residuals are told apart by.
pub(crate) const POSE_BINS: usize = 6;

/// Steps in which a residual is shifted against the positions: it exceeds all shifted ones by chance once in so many joints.
pub(crate) const POSE_SHIFTS: usize = 40;

/// Share of a residual beyond chance from which on its dependence on the pose is said: less changes a model's torque by less than a
/// twentieth of the residual.
pub(crate) const POSE_SHARE_MIN: f64 = 0.1;

/// How many times as large the error on unseen stretches may be as on fitted ones before it is said.
pub(crate) const UNSEEN_ERROR_RATIO: f64 = 2.0;
/// Distance of the nodes at which the simulated arm's inertia, Coriolis and gravity torques are computed, s. Chosen by measurement: with it the
/// UR5e is off an independent integrator by 3e-8 rad after half a second (1 ms: 7e-8; 50 µs: 2e-10), and an elastic arm of 24 J
/// keeps its energy to 8e-6 J in a second (6e-5; 8e-9). Pinned by the tests of `drive/plant/tests.rs`.
pub(crate) const PLANT_NODES: f64 = 5.0e-4;

/// Most terms of a fitted stiffness polynomial: as many as a description may have.
pub(crate) const STIFFNESS_TERMS_MAX: usize = 8;

/// Places at which a fitted stiffness is looked at.
pub(crate) const STIFFNESS_PROBES: usize = 1_000;

/// Smallest singular value of scaled columns that count as independent where measured pairs are fitted: odd powers up to the
/// third are 0.2 apart, up to the seventh 1e-3.
pub(crate) const COLUMNS_INDEPENDENT: f64 = 1.0e-4;

/// How unevenly the maxima of a free oscillation may follow one another, as part of the period: Coulomb friction leaves it as it is, a
/// missing maximum doubles it.
pub(crate) const OSCILLATION_UNEVEN: f64 = 0.2;

/// Least part by which an oscillation must have become smaller: encoders read a hundredth of a swing.
pub(crate) const SWING_MIN: f64 = 0.01;

/// Greatest decay a period that is looked for, −ln of the ratio of two maxima: at 5 the second is below a hundredth.
pub(crate) const DECAY_MOST: f64 = 5.0;

/// Decays that are tried before the best is refined: the square has one valley but for noise.
pub(crate) const DECAY_STEPS: usize = 200;

/// Ratio of two speeds from which on they tell viscous from Coulomb friction.
pub(crate) const SPEEDS_APART: f64 = 1.1;

/// How many times as large an error may be with the described bodies as with free ones before it is said: those have ten parameters a
/// body more, and are not drawn to anything.
pub(crate) const WRONG_BODY_RATIO: f64 = 1.5;
/// Degrees of freedom from which on Student's distribution is the normal one with two corrections: what they leave is z⁷/ν³/384,
/// below 1e-11 of z at every probability that there is.
pub(crate) const STUDENT_NORMAL_FROM: f64 = 1.0e5;

/// Half the degrees of freedom from which on the ratio of two gamma functions is its series, true to rounding; the difference of
/// their logarithms loses digits instead.
pub(crate) const GAMMA_SERIES_FROM: f64 = 500.0;

/// The continued fraction of Student's distribution ends when a step is this close to 1, and after so many at the latest: it
/// needs some roots of the degrees of freedom.
pub(crate) const STUDENT_ROUNDING: f64 = 1.0e-15;
pub(crate) const STUDENT_ROUNDS: usize = 5_000;

/// A quantile is found when Newton's step is this part of it, and after so many rounds at the latest: halving alone needs sixty.
pub(crate) const QUANTILE_ROUNDING: f64 = 1.0e-14;
pub(crate) const QUANTILE_ROUNDS: usize = 60;

/// Part of a band that plans leave unused: torque and band are sampled, ten times in a stretch of a tenth of a radian and once more
/// around the largest sum, so that a maximum between samples is missed by less than this part of the band.
pub(crate) const BAND_RESERVE: f64 = 1.0e-2;

/// What a joint's torque limit is tightened by beyond the excess found, as part of the band there: the slower plan has its tightest
/// moment elsewhere, and needs fewer rounds so.
pub(crate) const BAND_AHEAD: f64 = 5.0e-3;

/// Most plans that are made one after the other until torque limits hold at a confidence; four are usual.
pub(crate) const CONFIDENT_ROUNDS: usize = 10;

/// How often a plan that holds is tried again with what it left unused, and what it must have left, as part of the torque set
/// aside: once brings what there is.
pub(crate) const CONFIDENT_LOOSENINGS: usize = 2;
pub(crate) const CONFIDENT_SLACK: f64 = 0.05;

/// The lowest part of the nominal speed that is tried before a confidence is refused: forces of motion are then 4e-4 of what they
/// were.
pub(crate) const CONFIDENT_SLOWEST: f64 = 0.02;

/// Halvings of the range of speeds that may hold a confidence, on its logarithm: the one found is within 2 % of the fastest.
pub(crate) const CONFIDENT_HALVINGS: usize = 8;

/// How far inside of a stretch of a motion its ends are sampled for bands, as part of it: speeds are then not 0 where a joint
/// starts or turns back, and friction has its side.
pub(crate) const BAND_INSIDE: f64 = 1.0e-9;

/// Rounds of golden section around the largest sum of torque and band: they narrow two intervals to a fiftieth.
pub(crate) const BAND_GOLDEN_ROUNDS: usize = 8;

/// Joint travel between two samples of a band, rad or m, summed over joints: φ·Σ·φ swings twice as fast as φ.
pub(crate) const BAND_TRAVEL: f64 = 0.1;

/// Most samples of a band in one stretch of a motion, and fewest in one whose path is timed already in many.
pub(crate) const BAND_PARTS_MAX: usize = 1000;
pub(crate) const BAND_PARTS_MIN: usize = 2;

/// Fewest samples of a band, less one, in one phase of a move's pattern.
pub(crate) const BAND_PATTERN_PARTS_MIN: usize = 10;

/// Samples of a band between two looks at the budget: some hundred microseconds.
pub(crate) const BAND_BLOCK: usize = 32;

/// What a parameter's variance is raised by, relative, where rounding has made a covariance indefinite: twice what registration
/// lets through.
pub(crate) const COVARIANCE_LIFT: f64 = 2.0e-8;

/// What the multiplier of a band at a sample is raised by where a normal and a Student variable add up: the tail of their sum is
/// above that of either by 1.5e-4 of it, by quadrature, and falls by four times the part that the multiplier is raised by.
pub(crate) const MIXTURE_RESERVE: f64 = 2.0e-4;
