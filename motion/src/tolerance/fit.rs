//! Fits of drives and bodies to recordings.

/// Most samples of a recording: an hour at 100 Hz, ten minutes at 1 kHz, and more would wait in memory for nothing.
pub(crate) const FIT_SAMPLES_MAX: usize = 1_000_000;

/// Largest magnitude of anything in a recording: beyond any unit of an arm, with products of three that stay finite.
pub(crate) const FIT_VALUE_MAX: f64 = 1.0e9;

/// Periods by which a part of a recording may be asked for beyond its ends without a word: the last sample of 8 s at 1 kHz is at 7.999 s, and
/// half a period is for time stamps that jitter.
pub(crate) const RANGE_SLACK: f64 = 1.5;

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

/// Rounds of Newton's method of a fit; from the description it takes about ten, along a path of ridges up to thirty each.
pub(crate) const FIT_NEWTON_ROUNDS: usize = 60;

/// Ridges, over the one that is asked for, along which a solution far from the description is followed: at the first the description wins
/// against a motion of a million independent samples, and each next is near the one before.
pub(crate) const FIT_RIDGE_PATH: [f64; 13] = [
    1.0e6, 3.16e5, 1.0e5, 3.16e4, 1.0e4, 3.16e3, 1.0e3, 316.0, 100.0, 31.6, 10.0, 3.16, 1.0,
];

/// Decrease, over the objective, at which a fit is at its least: its parameters are then true to 1e-5 of their deviation.
pub(crate) const FIT_NEWTON_DONE: f64 = 1.0e-12;

/// Part of the foreseen decrease that a step must bring (Armijo).
pub(crate) const FIT_DECREASE: f64 = 1.0e-4;

/// Slope of friction at the speed limit, over its quadratic coefficient, that counts as none: what rounding leaves of c + 2·d·v̂ when d was made of
/// the slope 0. A description's friction may fall by as much.
pub(crate) const SLOPE_ROUNDING: f64 = 1.0e-12;

/// Halvings of a step before it counts as none: below 1e-9 of it is rounding.
pub(crate) const FIT_BACKTRACKS: usize = 30;

/// Degrees of freedom that residuals are compared with: from hardly any variance to none but the normal one's.
pub(crate) const STUDENT_DEGREES: [f64; 11] = [2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 15.0, 20.0, 30.0, 200.0];

/// Natural logarithm of how far the likeliest deviation of a residual may be from its root mean square, either way.
pub(crate) const STUDENT_SCALE_RANGE: f64 = 3.0;

/// Speed below which a joint is at rest to a fit, rad/s or m/s: friction is then between its two directions, and a model's torque is
/// uncertain by it.
pub(crate) const REST_SPEED: f64 = 0.02;

/// Time over which a joint's way is held against [`REST_SPEED`], s, and part of a recording that an arm may stand still at its ends without a remark: a start and a
/// stop of an exciting motion are shorter.
pub(crate) const STANDSTILL_WINDOW: f64 = 0.1;
pub(crate) const STANDSTILL_PART: f64 = 0.05;

/// How far ahead an online interval is foretold, in periods of the band. The filter is without delay and reaches forwards as far as
/// backwards: a sample's own deviation comes into residuals one period older with 3 % of its size, into newer ones with up to
/// all of it. It is also how long a contact has to stand out before the interval follows it.
pub(crate) const ONLINE_HORIZON_BANDS: f64 = 1.0;

/// Memory of an online interval's correlation and deviation, in correlation times, and how much the model's stated ones count: about as many
/// as a fit to ten seconds leaves out, so that both are worth the same.
pub(crate) const ONLINE_MEMORY: f64 = 6.0;

/// Part of that memory within which a residual that has grown is followed: a quarter of a correlation time.
pub(crate) const ONLINE_SOON: f64 = 1.0 / 24.0;

/// What the deviation of a residual is taken to grow by where a joint has turned back, until its own turns have shown it: an error of friction changes its
/// side, by twice its size, one of a body does not.
pub(crate) const ONLINE_TURN: f64 = 1.5;

/// Step of an online interval's θ: what half a period of the band with every sample outside adds to it. Smaller follows too late, larger makes
/// the interval swing of itself. This and the two memories were chosen on logs of another arm than the one that is quoted; what others of them do there is in
/// `docs/friction.md`.
pub(crate) const ONLINE_GAIN: f64 = 0.3;

/// Greatest factor between an online interval and the model's: beyond it the units are wrong, or the sensor is.
pub(crate) const ONLINE_RATIO_MAX: f64 = 1.0e3;

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

/// Part of a torque left on unseen stretches from which on a fit is called hardly a model of it: friction on a wrong body leaves up to that.
pub(crate) const UNEXPLAINED_ERROR: f64 = 0.6;

/// How many times as large the error on unseen stretches may be as on fitted ones before it is said.
pub(crate) const UNSEEN_ERROR_RATIO: f64 = 2.0;

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
