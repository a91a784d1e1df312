//! What is rehearsed: a motion, the arm's truth where it differs from its model, and what is measured. Passive data.

use nalgebra::Vector3;

use crate::drive::controller::{Adaptation, JointGains};
use crate::path::request::PathRequest;
use crate::plan::request::{Interpolation, MoveRequest, TrajectoryPoint};
use crate::robot::spec::Inertial;

/// A motion to be run under the controller on the simulated arm.
#[derive(Debug, Clone, PartialEq)]
pub struct RehearsalRequest {
    /// What is run.
    pub motion: Motion,
    /// Time between two steps of the controller, s.
    pub period: f64,
    /// Time at rest at the target that is run after the motion, s.
    pub settle: f64,
    /// Friction of the simulated arm against the model's, one a joint, or empty: as in the model.
    pub friction: Vec<FrictionTruth>,
    /// What the simulated arm carries, in the tip link's frame; `None`: what the motion was planned with.
    pub true_payload: Option<Inertial>,
    /// What the controller sees, one a joint, or empty: both positions, exactly.
    pub encoders: Vec<Encoder>,
    /// Where the noise begins; the same seed has the same noise.
    pub seed: u64,
    /// What pulls at the flange, and when.
    pub wrenches: Vec<WrenchPulse>,
    /// Gains, one a joint, or empty: derived from the model.
    pub gains: Vec<JointGains>,
    /// Largest motor current, one a joint, A, or empty: none but the peak torque.
    pub current_limits: Vec<f64>,
    /// How the run with adaptation adapts.
    pub adaptation: Adaptation,
    /// Every how many steps a point of the trace is returned; `None`: no trace.
    pub trace_every: Option<usize>,
}

/// A motion, as it is asked for.
#[derive(Debug, Clone, PartialEq)]
pub enum Motion {
    /// Planned as a move; its sampling is not used.
    Move(Box<MoveRequest>),
    /// Planned as a program; its sampling is not used.
    Path(Box<PathRequest>),
    /// A trajectory made elsewhere; its first point is where it starts.
    Setpoints(SetpointMotion),
}

/// A trajectory made elsewhere.
#[derive(Debug, Clone, PartialEq)]
pub struct SetpointMotion {
    /// Points in time order.
    pub points: Vec<TrajectoryPoint>,
    /// What is between them; `None`: quintic where accelerations are given, cubic where velocities are.
    pub interpolation: Option<Interpolation>,
    /// Payload in the tip link's frame; `None`: the model's.
    pub payload: Option<Inertial>,
}

/// How the friction of the simulated arm differs from the model's: F = (scale + rate·t)·F_model, never below 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrictionTruth {
    /// Of the Coulomb terms, the load's included.
    pub coulomb_scale: f64,
    /// Of the viscous and the quadratic term.
    pub viscous_scale: f64,
    /// By how much the Coulomb scale changes, 1/s: wear.
    pub coulomb_rate: f64,
    /// By how much the viscous scale changes, 1/s: temperature.
    pub viscous_rate: f64,
}

/// What is measured of one joint. Positions are seen from the joint: "rad or m".
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Encoder {
    /// Step of the motor's encoder over the gear ratio; 0: exact.
    pub motor_step: f64,
    /// Standard deviation of the motor's position over the gear ratio.
    pub motor_noise: f64,
    /// The joint has an encoder on its output.
    pub has_output: bool,
    /// Step of the output's encoder; 0: exact.
    pub output_step: f64,
    /// Standard deviation of the output's position.
    pub output_noise: f64,
}

/// A constant wrench on the flange for a time. Begin and end are those of the controller's steps that they fall into.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WrenchPulse {
    /// s.
    pub begin: f64,
    /// s.
    pub end: f64,
    /// In base-link axes, at the origin of the tip link's frame, N.
    pub force: Vector3<f64>,
    /// In base-link axes, N m.
    pub moment: Vector3<f64>,
}

impl Default for FrictionTruth {
    fn default() -> Self {
        Self {
            coulomb_scale: 1.0,
            viscous_scale: 1.0,
            coulomb_rate: 0.0,
            viscous_rate: 0.0,
        }
    }
}

impl Default for Encoder {
    fn default() -> Self {
        Self {
            motor_step: 0.0,
            motor_noise: 0.0,
            has_output: true,
            output_step: 0.0,
            output_noise: 0.0,
        }
    }
}

/// Period of the control loop where none is given, s: what most drives' buses run at.
const CONTROL_PERIOD: f64 = 1.0e-3;

impl RehearsalRequest {
    /// A rehearsal at 1 kHz on an arm that is as its model says.
    #[must_use]
    pub fn new(motion: Motion) -> Self {
        Self {
            motion,
            period: CONTROL_PERIOD,
            settle: 0.0,
            friction: Vec::new(),
            true_payload: None,
            encoders: Vec::new(),
            seed: 0,
            wrenches: Vec::new(),
            gains: Vec::new(),
            current_limits: Vec::new(),
            adaptation: Adaptation::default(),
            trace_every: None,
        }
    }
}
