//! Friction estimated from telemetry while an arm works: one estimator for all joints of an arm, fed with blocks of samples.
//!
//! ```text
//! y = [τmotor − B·Θ̈] − [τJ or rigid(q, q̇, q̈)] − τext        F(ω, g) = ψ(ω, g)·f
//! ```
//!
//! Per sample: every signal goes through the same low pass (`filter`), which differentiates positions on the way; the balance
//! of torques that the signals allow (`combination`) leaves what friction took; and where a joint has been sliding in one
//! direction for long enough, its coefficients (`law`) are updated by the method chosen: `least_squares`, with how well
//! they are known from `evidence`; the same behind the `observer`; or `kalman`. At rest nothing is learned and
//! nothing is forgotten.
//!
//! An estimator is a value without clock, threads or I/O: the same samples in the same order give the same bits, in blocks
//! of any size, and whether or not it was taken out and put back in between (`state`). It allocates
//! nothing per sample. Whatever a sample holds, the worst that it does is not to be used.

mod answer;
mod combination;
mod commit;
mod evidence;
mod excitation;
mod factor;
mod filter;
mod joint;
mod kalman;
mod law;
mod least_squares;
mod model;
#[cfg(test)]
mod noise;
mod observer;
mod options;
mod report;
mod sample;
mod spread;
mod state;

use crate::budget::{Budget, Stopped};
use crate::drive::telemetry::{Signals, Telemetry};
use crate::dynamics::rnea::LinkWrench;
use crate::error::Invalid;
use crate::robot::Robot;
use crate::tolerance::{ESTIMATE_FILTER_MEMORY, ESTIMATE_OBSERVER_MEMORY, TELEMETRY_BUDGET_STRIDE};

pub use combination::{Combination, MotorTorqueSource, PositionSource, TransmissionTorqueSource};
pub(super) use model::known;

pub use law::{FrictionLaw, TERMS_MAX, Term};
pub use options::{EstimatorMethod, EstimatorOptions, FrictionSide, Memory, Prior};
pub use report::{
    Coefficient, CommittedFriction, EstimateReport, JointEstimate, MissingExcitation, SkippedOfJoint, SkippedSamples,
};
pub use state::EstimatorState;

use joint::{JointState, Reading, Rules, Step};
use model::JointModel;

/// Why a block was not taken in, or not wholly.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum UpdateError {
    /// It is no block for this estimator; nothing of it was taken in.
    Invalid(Vec<Invalid>),
    /// Nobody waits any more; part of it was taken in.
    Stopped,
}

/// Estimates the friction of all joints of an arm.
#[derive(Debug, Clone)]
pub struct FrictionEstimator {
    robot: Robot,
    options: EstimatorOptions,
    rules: Rules,
    models: Vec<JointModel>,
    joints: Vec<JointState>,
    /// What blocks hold, and how it is combined; since the first block.
    sources: Option<(Signals, Combination)>,
    /// Time of the last sample taken.
    time: Option<f64>,
    /// Since then, samples of a clock that is behind.
    behind: Option<Behind>,
    sample_count: u64,
    skipped: SkippedSamples,
    scratch: Scratch,
}

/// Samples whose clock is behind that of the last sample taken.
#[derive(Debug, Clone, Copy, Default)]
struct Behind {
    /// Time of the last of them.
    time: f64,
    /// How long they have come in order, s.
    seconds: f64,
}

/// Working memory, without meaning between samples.
#[derive(Clone)]
struct Scratch {
    readings: Vec<Reading>,
    q: Vec<f64>,
    qd: Vec<f64>,
    qdd: Vec<f64>,
    rigid: Vec<f64>,
    gravity: Vec<f64>,
    sliding: Vec<f64>,
    telling: Vec<bool>,
    links: Vec<LinkWrench<f64>>,
    /// The last step, kept for as long as samples come at the same interval.
    step: Option<Step>,
}

impl std::fmt::Debug for Scratch {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Scratch").finish_non_exhaustive()
    }
}

impl Scratch {
    fn new(count: usize) -> Self {
        Self {
            readings: vec![Reading::default(); count],
            q: vec![0.0; count],
            qd: vec![0.0; count],
            qdd: vec![0.0; count],
            rigid: vec![0.0; count],
            gravity: vec![0.0; count],
            sliding: vec![0.0; count],
            telling: vec![false; count],
            links: vec![LinkWrench::zero(0.0); count],
            step: None,
        }
    }
}

impl FrictionEstimator {
    /// An estimator that knows its priors and nothing else. The robot carries the payload that the arm does.
    ///
    /// # Errors
    /// Everything that is wrong with the options.
    pub fn new(robot: Robot, options: EstimatorOptions) -> Result<Self, Vec<Invalid>> {
        let count = robot.joint_count();
        let findings = options.findings(count);
        if !findings.is_empty() {
            return Err(findings);
        }
        let mut models: Vec<JointModel> = (0..count)
            .map(|joint| JointModel::new(&robot, joint, options.side, options.law))
            .collect();
        let joints = models
            .iter_mut()
            .enumerate()
            .map(|(joint, model)| model.state(&robot, joint, &options))
            .collect::<Result<Vec<_>, _>>()
            .map_err(|finding| vec![finding])?;
        Ok(Self {
            rules: Rules::new(&options, &models),
            scratch: Scratch::new(count),
            robot,
            options,
            models,
            joints,
            sources: None,
            time: None,
            behind: None,
            sample_count: 0,
            skipped: SkippedSamples::default(),
        })
    }

    /// Which signals the estimate is made of; `None` before the first block.
    #[must_use]
    pub fn combination(&self) -> Option<Combination> {
        self.sources.map(|(_, combination)| combination)
    }

    /// What was chosen.
    #[must_use]
    pub fn options(&self) -> &EstimatorOptions {
        &self.options
    }

    /// Takes in a block of samples, which follow those of the block before.
    ///
    /// # Errors
    /// [`UpdateError::Invalid`] where columns do not fit the arm, do not serve the estimate, or are others than in the first
    /// block; [`UpdateError::Stopped`] where the budget ends.
    pub fn update(&mut self, block: &Telemetry, budget: &Budget<'_>) -> Result<(), UpdateError> {
        block.check(self.joints.len()).map_err(UpdateError::Invalid)?;
        if block.time.is_empty() {
            return Ok(());
        }
        let combination = self.combine(block.signals()).map_err(UpdateError::Invalid)?;
        for index in 0..block.sample_count() {
            if index % TELEMETRY_BUDGET_STRIDE == 0 {
                budget.check().map_err(|Stopped| UpdateError::Stopped)?;
            }
            self.take(block, index, &combination);
        }
        Ok(())
    }

    /// How the columns of a block are combined: as those of the first were.
    fn combine(&mut self, signals: Signals) -> Result<Combination, Vec<Invalid>> {
        if let Some((first, combination)) = self.sources {
            if first == signals {
                return Ok(combination);
            }
            let message =
                "the block has other columns than the first: an estimate is made of the same signals all the way";
            return Err(vec![Invalid::new("", message)]);
        }
        let combination = Combination::of(&self.robot, &self.options, signals)?;
        self.rely_on(signals, combination);
        Ok(combination)
    }

    fn rely_on(&mut self, signals: Signals, combination: Combination) {
        for (model, spec) in self.models.iter_mut().zip(&self.robot.spec().joints) {
            model.combine(&combination, spec.drive.torque_constant);
        }
        self.sources = Some((signals, combination));
    }
}

impl Rules {
    fn new(options: &EstimatorOptions, models: &[JointModel]) -> Self {
        let lag = options.bandwidth.map_or(0.0, filter::delay);
        let memory = ESTIMATE_FILTER_MEMORY * lag / 3.0;
        let observing = match options.method {
            EstimatorMethod::Observer => ESTIMATE_OBSERVER_MEMORY / options.observer_rate,
            EstimatorMethod::LeastSquares | EstimatorMethod::Kalman => 0.0,
        };
        Self {
            method: options.method,
            law: options.law,
            loads: options.law.load || models.iter().any(|model| model.held.load_coulomb != 0.0),
            dead_band: options.dead_band,
            outlier_threshold: options.outlier_threshold,
            memory,
            hold: memory + observing,
            lag,
        }
    }
}

#[cfg(test)]
mod tests;
