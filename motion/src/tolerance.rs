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

/// Steps times joints that end the search: some milliseconds.
pub(crate) const IK_WORK: usize = 60_000;

/// Most copies by whole turns of all solutions together.
pub(crate) const IK_COPIES_MAX: usize = 1024;

/// Most sweeps of Jacobi's rotations over a 6 × 6 matrix; four or five do.
pub(crate) const IK_JACOBI_SWEEPS: usize = 12;

/// What is left beside the diagonal, over its sum, when eigenvalues count as found: their error is its square.
pub(crate) const IK_EIGEN_ROUNDING: f64 = 1.0e-9;
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

/// Steps by which the length of the tool's way is measured: extrapolated chords are true to 1e-6 for a quarter turn.
pub(crate) const TOOL_LENGTH_SAMPLES: usize = 32;

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

/// Pace at a sample, as part of full speed, above which a path cannot come to a stop before the next: a turning point is
/// passed at a twentieth between thirty-two samples.
pub(crate) const VALLEY_MAX: f64 = 0.25;
