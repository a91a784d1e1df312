//! The controller, the simulated arm, and its rehearsals.

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

/// Distance of the nodes at which the simulated arm's inertia, Coriolis and gravity torques are computed, s. Chosen by measurement: with it the
/// UR5e is off an independent integrator by 3e-8 rad after half a second (1 ms: 7e-8; 50 µs: 2e-10), and an elastic arm of 24 J
/// keeps its energy to 8e-6 J in a second (6e-5; 8e-9). Pinned by the tests of `drive/plant/tests.rs`.
pub(crate) const PLANT_NODES: f64 = 5.0e-4;
