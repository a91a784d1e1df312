//! Friction estimated from telemetry while an arm works: one estimator for all joints of an arm, fed with blocks of samples.
//!
//! ```text
//! y = [τmotor − B·Θ̈] − [τJ or rigid(q, q̇, q̈)] − τext        F(ω, g) = ψ(ω, g)·f
//! ```
//!
//! Per sample: every signal goes through the same low pass ([`filter`]), which differentiates positions on the way; the balance
//! of torques that the signals allow ([`combination`]) leaves what friction took; and where a joint has been sliding in one
//! direction for long enough, its coefficients ([`law`]) are updated by the method chosen: [`least_squares`], with how well
//! they are known from [`evidence`]; the same behind the [`observer`]; or [`kalman`]. At rest nothing is learned and
//! nothing is forgotten.
//!
//! An estimator is a value without clock, threads or I/O: the same samples in the same order give the same bits, in blocks
//! of any size, and whether or not it was taken out and put back in between ([`state`]). It allocates
//! nothing per sample. Whatever a sample holds, the worst that it does is not to be used.

mod answer;
mod combination;
mod commit;
mod evidence;
mod excitation;
mod factor;
mod filter;
mod interval;
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
mod spread;
mod state;

use std::f64::consts::LN_2;

use crate::budget::{Budget, Stopped};
use crate::drive::telemetry::{Signals, Telemetry};
use crate::dynamics::rnea::{self, LinkWrench};
use crate::error::Invalid;
use crate::robot::Robot;
use crate::tolerance::{
    ESTIMATE_FILTER_MEMORY, ESTIMATE_OBSERVER_MEMORY, POSITION_MAX, TELEMETRY_ACCELERATION_MAX,
    TELEMETRY_BUDGET_STRIDE, TELEMETRY_STEP_MIN, TELEMETRY_TORQUE_MAX, TELEMETRY_VELOCITY_MAX,
};

pub use combination::{Combination, MotorTorqueSource, PositionSource, TransmissionTorqueSource};
pub use law::{FrictionLaw, TERMS_MAX, Term};
pub use options::{EstimatorMethod, EstimatorOptions, FrictionSide, Memory, Prior};
pub use report::{
    Coefficient, CommittedFriction, EstimateReport, JointEstimate, MissingExcitation, SkippedOfJoint, SkippedSamples,
};
pub use state::EstimatorState;

use filter::FilterStep;
use joint::{Given, JointState, Reading, Rules, Sample, Step};
use model::JointModel;
use observer::LagStep;

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
    sample_count: u64,
    skipped: SkippedSamples,
    scratch: Scratch,
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
            .map(|joint| JointModel::new(&robot, joint, options.side))
            .collect();
        let joints = models
            .iter_mut()
            .enumerate()
            .map(|(joint, model)| model.state(&robot, joint, &options))
            .collect::<Result<Vec<_>, _>>()
            .map_err(|finding| vec![finding])?;
        Ok(Self {
            rules: Rules::new(&options),
            scratch: Scratch::new(count),
            robot,
            options,
            models,
            joints,
            sources: None,
            time: None,
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

    fn take(&mut self, block: &Telemetry, index: usize, combination: &Combination) {
        let time = block.time[index];
        let given = Given {
            velocity: !block.output_velocity.is_empty(),
            acceleration: !block.output_acceleration.is_empty(),
            motor: combination.motor_acceleration || combination.transmission_torque.is_some(),
        };
        let read = if time.is_finite() {
            self.read(block, index, combination, given)
        } else {
            Err(Unreadable::NotFinite)
        };
        match read {
            Ok(()) => {}
            Err(Unreadable::NotFinite) => {
                self.skipped.not_finite += 1;
                return;
            }
            Err(Unreadable::OutOfRange) => {
                self.skipped.out_of_range += 1;
                return;
            }
        }
        let seconds = self.time.map(|last| time - last);
        if seconds.is_some_and(|seconds| seconds < TELEMETRY_STEP_MIN) {
            self.skipped.time_went_backwards += 1;
            return;
        }
        self.sample_count += 1;
        self.time = Some(time);
        match seconds {
            Some(seconds) if seconds <= self.options.gap => self.go_on(seconds, given, combination),
            _ => {
                self.skipped.gaps += u64::from(seconds.is_some());
                self.restart(seconds, given, combination);
            }
        }
    }

    /// Reads a sample into the scratch, with everything reflected to the joints.
    fn read(
        &mut self,
        block: &Telemetry,
        index: usize,
        combination: &Combination,
        given: Given,
    ) -> Result<(), Unreadable> {
        let count = self.joints.len();
        let row = index * count;
        let at = |column: &[f64], joint: usize| column.get(row + joint).copied().unwrap_or(0.0);
        let motor_torque = match combination.motor_torque {
            Some(MotorTorqueSource::Current) => &block.motor_current,
            Some(MotorTorqueSource::Torque) | None => &block.motor_torque,
        };
        let external = if combination.external_torque { 1.0 } else { 0.0 };
        for (joint, (reading, model)) in self.scratch.readings.iter_mut().zip(&self.models).enumerate() {
            let motor = at(&block.motor_position, joint) / model.gear_ratio;
            let position = match combination.position {
                PositionSource::Output => at(&block.output_position, joint),
                PositionSource::Motor => motor,
            };
            let (velocity, acceleration) = (at(&block.output_velocity, joint), at(&block.output_acceleration, joint));
            check(position, POSITION_MAX)?;
            check(velocity, TELEMETRY_VELOCITY_MAX)?;
            check(acceleration, TELEMETRY_ACCELERATION_MAX)?;
            if given.motor {
                check(motor, POSITION_MAX)?;
            }
            let torque = sum([
                (model.motor_gain, at(motor_torque, joint)),
                (model.sensor_sign, at(&block.transmission_torque, joint)),
                (-external, at(&block.external_torque, joint)),
            ]);
            *reading = Reading {
                position,
                velocity,
                acceleration,
                motor,
                torque,
            };
        }
        Ok(())
    }

    /// Starts all filters at the sample that was read. Time passes for the Kalman filter even so.
    fn restart(&mut self, seconds: Option<f64>, given: Given, combination: &Combination) {
        for (joint, reading) in self.joints.iter_mut().zip(&self.scratch.readings) {
            joint.restart(reading, given, &self.rules);
            joint.waiting += seconds.unwrap_or(0.0);
            joint.skipped.settling += 1;
        }
        if self.rules.method != EstimatorMethod::Observer {
            return;
        }
        self.move_on(given, combination);
        self.weigh(combination);
        for (index, joint) in self.joints.iter_mut().enumerate() {
            let scratch = &self.scratch;
            let sliding = scratch.sliding[index];
            let (gravity, rigid) = (scratch.gravity[index], scratch.rigid[index]);
            let torque = joint.balance(&self.models[index], combination, sliding, gravity, rigid);
            joint.observer.reset(torque, rotor(joint, given, scratch.qd[index]).0);
            joint.lagged = [0.0; TERMS_MAX];
            joint.regressors = self.rules.law.regressors(sliding, gravity);
        }
    }

    /// Filtered motion of all joints.
    fn move_on(&mut self, given: Given, combination: &Combination) {
        let filtered = self.options.bandwidth.is_some();
        let scratch = &mut self.scratch;
        for (index, joint) in self.joints.iter().enumerate() {
            let [q, qd, qdd] = joint.motion(given, filtered);
            (scratch.q[index], scratch.qd[index], scratch.qdd[index]) = (q, qd, qdd);
            scratch.sliding[index] = joint.sliding(combination, qd);
        }
    }

    /// Torque of the rigid body in the filtered motion, and gravity's part of it, where they are asked for.
    fn weigh(&mut self, combination: &Combination) {
        if !(combination.needs_rigid_torque() || self.rules.law.load) {
            return;
        }
        let scratch = &mut self.scratch;
        rnea::rnea::<f64, true>(
            self.robot.chain(),
            &scratch.q,
            &scratch.qd,
            &scratch.qdd,
            &mut scratch.links,
            &mut scratch.rigid,
            &mut scratch.gravity,
        );
    }

    fn go_on(&mut self, seconds: f64, given: Given, combination: &Combination) {
        let step = self.step(seconds);
        for (joint, reading) in self.joints.iter_mut().zip(&self.scratch.readings) {
            joint.filter(reading, given, &step, &self.rules);
        }
        self.move_on(given, combination);
        let scratch = &mut self.scratch;
        let mut anything = self.rules.method == EstimatorMethod::Observer;
        for ((joint, telling), &sliding) in self.joints.iter_mut().zip(&mut scratch.telling).zip(&scratch.sliding) {
            *telling = joint.is_telling(sliding, &step, &self.rules);
            anything |= *telling;
        }
        if !anything {
            return;
        }
        self.weigh(combination);
        let scratch = &self.scratch;
        for (index, (joint, model)) in self.joints.iter_mut().zip(&self.models).enumerate() {
            let (velocity, gravity) = (scratch.sliding[index], scratch.gravity[index]);
            let (rotor_velocity, rotor_acceleration) = rotor(joint, given, scratch.qd[index]);
            let sample = Sample {
                torque: joint.balance(model, combination, velocity, gravity, scratch.rigid[index]),
                velocity,
                gravity,
                rotor_velocity,
                rotor_acceleration: rotor_acceleration.unwrap_or(scratch.qdd[index]),
                telling: scratch.telling[index],
            };
            joint.estimate(model, &self.rules, &step, &sample);
        }
    }

    /// What the joints have in common over a step of so many seconds.
    fn step(&mut self, seconds: f64) -> Step {
        if let Some(step) = self.scratch.step
            && step.seconds.to_bits() == seconds.to_bits()
        {
            return step;
        }
        let step = Step {
            seconds,
            filter: self
                .options
                .bandwidth
                .map(|bandwidth| FilterStep::new(bandwidth, seconds)),
            lag: LagStep::new(self.options.observer_rate, seconds),
            lambda: match self.options.memory {
                Memory::Forever => 1.0,
                Memory::Factor(lambda) => lambda,
                Memory::HalfLife(half_life) => libm::exp(-LN_2 * seconds / half_life),
            },
            weight: (0.5 * seconds / self.options.correlation_time).min(1.0),
        };
        self.scratch.step = Some(step);
        step
    }
}

impl Rules {
    fn new(options: &EstimatorOptions) -> Self {
        let lag = options.bandwidth.map_or(0.0, filter::delay);
        let memory = ESTIMATE_FILTER_MEMORY * lag / 3.0;
        let observing = match options.method {
            EstimatorMethod::Observer => ESTIMATE_OBSERVER_MEMORY / options.observer_rate,
            EstimatorMethod::LeastSquares | EstimatorMethod::Kalman => 0.0,
        };
        Self {
            method: options.method,
            law: options.law,
            dead_band: options.dead_band,
            outlier_threshold: options.outlier_threshold,
            memory,
            hold: memory + observing,
            lag,
        }
    }
}

enum Unreadable {
    NotFinite,
    OutOfRange,
}

#[inline(always)]
fn check(value: f64, largest: f64) -> Result<(), Unreadable> {
    if value.abs() <= largest {
        return Ok(());
    }
    Err(if value.is_finite() {
        Unreadable::OutOfRange
    } else {
        Unreadable::NotFinite
    })
}

/// The sum of those torques that count; NaN where it is no torque.
#[inline(always)]
fn sum(terms: [(f64, f64); 3]) -> f64 {
    let mut sum = 0.0;
    for (factor, value) in terms {
        if factor != 0.0 {
            sum += factor * value;
        }
    }
    if sum.abs() <= TELEMETRY_TORQUE_MAX {
        sum
    } else {
        f64::NAN
    }
}

/// Velocity and acceleration of the rotor, as the joint sees it: its own where it is known, the joint's elsewhere.
#[inline(always)]
fn rotor(joint: &JointState, given: Given, velocity: f64) -> (f64, Option<f64>) {
    if given.motor {
        return (joint.motor.state[1], Some(joint.motor.state[2]));
    }
    (velocity, None)
}

#[cfg(test)]
mod tests;
