//! Limits held at a stated confidence.

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

/// Most plans that are made one after the other until torque limits hold at a confidence; five are usual.
pub(crate) const CONFIDENT_ROUNDS: usize = 10;

/// How often a plan that holds is tried again with what it left unused, and what it must have left, as part of the torque set
/// aside: that costs some thousandths of the duration.
pub(crate) const CONFIDENT_LOOSENINGS: usize = 3;
pub(crate) const CONFIDENT_SLACK: f64 = 0.02;

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
