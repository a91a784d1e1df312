//! Inverse kinematics.

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
