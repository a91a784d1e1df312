//! What a fit to a recorded motion found, and how well it is known.

use crate::robot::spec::{Inertial, Parameter, RobotSpec};

/// Corner of the low-pass filter where nobody says, Hz: above what arms are commanded to do, below their first resonance.
pub const BAND_DEFAULT: f64 = 5.0;

/// What of the arm is fitted together with its friction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scope {
    /// Nothing: the bodies are believed.
    Friction,
    /// What the arm carries.
    Payload,
    /// The reflected inertia of the rotors.
    Rotors,
    /// Rotors and all moving bodies, drawn towards what the description says of them.
    Bodies,
}

/// What came of a fit.
#[derive(Debug, Clone, PartialEq)]
pub enum MotionOutcome {
    /// A model.
    Fitted(Box<MotionFit>),
    /// The motion does not say what was asked.
    NotExcited(Vec<Missing>),
}

/// Something that a motion does not say.
#[derive(Debug, Clone, PartialEq)]
pub struct Missing {
    /// The parameters that it leaves open, as far as they can be told apart; empty where it is too short for any.
    pub parameters: Vec<Unknown>,
    /// What is missing, and which motion would bring it: a sentence without full stop.
    pub message: String,
}

/// Something that is fitted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unknown {
    /// A parameter of a joint's link or drive.
    Joint(Parameter),
    /// One of the payload's ten, about the tip link's frame: mass, first moment x y z, inertia xx yy zz xy xz yz.
    Payload(usize),
}

/// A model fitted to a motion.
#[derive(Debug, Clone, PartialEq)]
pub struct MotionFit {
    /// The arm with what was found in place of what it had, all friction on the joint's side, and with how well it is known.
    pub spec: RobotSpec,
    /// Every fitted parameter.
    pub estimates: Vec<Estimate>,
    /// What is left of each joint's torque.
    pub joints: Vec<JointFit>,
    /// Weight of the description against the motion, found by cross-validation; `None` where no body was fitted.
    pub ridge: Option<f64>,
    /// How many parameters the motion determines more than what was known before: at most as many as are fitted.
    pub determined: f64,
    /// Samples of the fit.
    pub sample_count: usize,
    /// Stretches that were left out in turn.
    pub fold_count: usize,
    /// What is odd, a sentence each.
    pub warnings: Vec<String>,
}

/// One fitted parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// Which.
    pub unknown: Unknown,
    /// Its value, in its SI unit.
    pub value: f64,
    /// What the description said.
    pub described: f64,
    /// Standard deviation.
    pub deviation: f64,
    /// Part of the variance beforehand that the motion took away: near 1 where the motion tells, 0 where it says nothing and the
    /// value is the description's.
    pub told: f64,
    /// It would have come out below 0, and was held there. Of quadratic friction: friction would have fallen with speed within the limit,
    /// and is level there.
    pub held: bool,
}

/// What is left of one joint's torque in a fit.
#[derive(Debug, Clone, PartialEq)]
pub struct JointFit {
    /// Root mean square of the residual over that of the torque, on the samples of the fit.
    pub fitted_error: f64,
    /// The same on stretches that were left out of the fit in turn.
    pub validated_error: f64,
    /// The same where this joint's torque alone chooses the bodies beyond the joint: far less than `validated_error` says that the
    /// described bodies are wrong. `None` where bodies were fitted, or that would have been too much.
    pub error_with_free_bodies: Option<f64>,
    /// Deflection over which the contact begins to slide, rad or m; `None`: at once.
    pub presliding_deflection: Option<f64>,
    /// Time over which the residual stays alike, s.
    pub correlation_time: f64,
    /// Largest part of the residual's variance that the position of one joint explains, beyond chance, and which joint's.
    pub pose_share: f64,
    /// The joint whose position that is.
    pub pose_joint: usize,
    /// The residual by the joint's own position.
    pub by_position: Vec<Bin>,
    /// The residual by the joint's own speed.
    pub by_speed: Vec<Bin>,
}

/// Residuals of samples that are alike.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bin {
    /// Least position or speed, rad or m, or per s.
    pub from: f64,
    /// Greatest.
    pub to: f64,
    /// Mean residual, N m or N.
    pub mean: f64,
    /// Root mean square, N m or N.
    pub rms: f64,
}

/// How well a model says the torque of a motion, one joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointAssessment {
    /// Root mean square of the error over that of the torque.
    pub error: f64,
    /// 95th percentile of the error, N m or N.
    pub percentile: f64,
    /// The same over the joint's peak torque; `None` where that is unknown.
    pub percentile_of_peak: Option<f64>,
    /// Interval of 95 % that the model states; `None` where it carries no uncertainty.
    pub interval: Option<IntervalAssessment>,
    /// Interval of 95 % that a controller can state online, from the model and residuals that are [`Assessment::online_horizon`] old; `None` where the
    /// model carries no uncertainty.
    pub online: Option<IntervalAssessment>,
}

/// How true intervals are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IntervalAssessment {
    /// Part of the samples within them.
    pub coverage: f64,
    /// Mean of their half width, N m or N.
    pub half_width: f64,
    /// Half width over that of the narrowest interval of constant width about the model's torque that holds 95 % of the samples.
    pub over_narrowest: f64,
}

/// A motion that a model was compared with.
#[derive(Debug, Clone, PartialEq)]
pub struct Assessment {
    /// One entry a joint.
    pub joints: Vec<JointAssessment>,
    /// Samples that were compared.
    pub sample_count: usize,
    /// How old the newest residual is that an online interval knows, s.
    pub online_horizon: f64,
}

/// What is fitted, from which part of the recording.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionOptions {
    /// Which part of the recording, in which band.
    pub selection: super::recording::Selection,
    /// What of the arm is fitted.
    pub scope: Scope,
    /// Fit how far the contacts of each joint deflect before they slide.
    pub presliding: bool,
}

impl Default for MotionOptions {
    fn default() -> Self {
        Self {
            selection: super::recording::Selection::default(),
            scope: Scope::Bodies,
            presliding: true,
        }
    }
}

/// A fitted payload, where that was asked.
impl MotionFit {
    /// What the arm carries, as fitted or described.
    #[must_use]
    pub fn payload(&self) -> &Inertial {
        &self.spec.payload
    }
}
