//! Paths: their shapes, their verification, and constant speed along them.

/// A duration that exceeds a whole number of cycles by less than this part has that number.
pub(crate) const LAW_CYCLE_ROUNDING: f64 = 1.0e-12;

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

/// How many times the arm's length a taught point is out of reach from which on it is asked whether it is in millimetres, which
/// makes it up to a thousand times; a wrong frame is off by the size of a hall.
pub(crate) const REACH_ABSURD: f64 = 100.0;

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

/// Samples of each polynomial of a spline, where a single curve has [`PACE_SAMPLES`]: its pieces are short, so that chords
/// and means are as true.
pub(crate) const PIECE_SAMPLES: usize = 8;

/// How far a sample's time may be from a stop to be the stop's, as part of the duration: some roundings of both.
pub(crate) const SAMPLE_AT_STOP: f64 = 1.0e-13;

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
