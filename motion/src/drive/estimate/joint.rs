//! One joint of the stream: its filters, whether it moves, and what becomes of a sample of it.

use super::combination::{Combination, PositionSource, TransmissionTorqueSource};
use super::excitation::Excitation;
use super::filter::{Filter, FilterStep};
use super::kalman::{Kalman, Measurement, Taken};
use super::law::{self, FrictionLaw, TERMS_MAX, TRIANGLE};
use super::least_squares::{LeastSquares, Row, Worth};
use super::model::JointModel;
use super::observer::{LagStep, Observer};
use super::options::{EstimatorMethod, FrictionSide};
use super::report::SkippedOfJoint;
use super::spread::Spread;
use crate::tolerance::TELEMETRY_TORQUE_MAX;

/// Everything that a joint's estimate goes on from.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct JointState {
    pub(super) position: Filter,
    pub(super) velocity: Filter,
    pub(super) acceleration: Filter,
    pub(super) motor: Filter,
    pub(super) torque: Filter,
    /// No torque has been read since filters started.
    pub(super) torque_lost: bool,
    /// Seconds until filters have forgotten how they started.
    pub(super) settling: f64,
    /// Which way it moves: −1, 1, or 0 at rest; and for how many seconds.
    pub(super) direction: f64,
    pub(super) moving: f64,
    /// Seconds since the Kalman filter's coefficients last wandered.
    pub(super) waiting: f64,
    pub(super) least_squares: LeastSquares,
    pub(super) kalman: Kalman,
    pub(super) observer: Observer,
    /// Regressors behind the observer's lag, and those of the last sample.
    pub(super) lagged: [f64; TERMS_MAX],
    pub(super) regressors: [f64; TERMS_MAX],
    pub(super) spread: Spread,
    pub(super) excitation: Excitation,
    /// Friction in the last sample used.
    pub(super) friction: f64,
    pub(super) used: u64,
    pub(super) discounted: u64,
    pub(super) skipped: SkippedOfJoint,
}

/// One joint's readings in one sample, reflected to the joint; what there is no column for is 0.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Reading {
    pub(super) position: f64,
    pub(super) velocity: f64,
    pub(super) acceleration: f64,
    /// Θ.
    pub(super) motor: f64,
    /// Every torque that is read, summed with its sign in the balance; NaN where one is missing.
    pub(super) torque: f64,
}

/// Which columns there are beside the position.
#[derive(Debug, Clone, Copy)]
pub(super) struct Given {
    pub(super) velocity: bool,
    pub(super) acceleration: bool,
    pub(super) motor: bool,
}

/// What all joints have in common in one sample.
#[derive(Debug, Clone, Copy)]
pub(super) struct Step {
    pub(super) seconds: f64,
    /// `None`: signals are not filtered.
    pub(super) filter: Option<FilterStep>,
    /// Of the observer, where there is one.
    pub(super) lag: Option<LagStep>,
    /// How much of a new sample one is, by its time over that for which residuals stay alike; and how it is forgotten.
    pub(super) worth: Worth,
}

/// What the options say, worked out.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rules {
    pub(super) method: EstimatorMethod,
    pub(super) law: FrictionLaw,
    /// Gravity torques are asked for: friction has a term in them, of the law or held.
    pub(super) loads: bool,
    pub(super) dead_band: f64,
    pub(super) outlier_threshold: Option<f64>,
    /// Seconds for which filters remember a start.
    pub(super) memory: f64,
    /// Seconds for which filters and observer remember the other direction.
    pub(super) hold: f64,
    /// 3/a of the filter, s.
    pub(super) lag: f64,
}

impl JointState {
    /// Starts all filters at a reading.
    pub(super) fn restart(&mut self, reading: &Reading, given: Given, rules: &Rules) {
        let rate = if given.velocity { reading.velocity } else { 0.0 };
        self.position.reset(reading.position, rate, rules.lag);
        self.motor.reset(reading.motor, rate, rules.lag);
        let acceleration = if given.acceleration { reading.acceleration } else { 0.0 };
        self.velocity.reset(reading.velocity, acceleration, rules.lag);
        self.acceleration.reset(reading.acceleration, 0.0, rules.lag);
        self.torque_lost = !reading.torque.is_finite();
        self.torque
            .reset(if self.torque_lost { 0.0 } else { reading.torque }, 0.0, rules.lag);
        self.settling = rules.memory;
        self.moving = 0.0;
        self.direction = 0.0;
    }

    /// Takes a reading into the filters.
    #[inline(always)]
    pub(super) fn filter(&mut self, reading: &Reading, given: Given, step: &Step, rules: &Rules) {
        self.settling = (self.settling - step.seconds).max(0.0);
        let Some(filter) = &step.filter else {
            self.position.state = [reading.position, reading.velocity, reading.acceleration];
            self.torque_lost = !reading.torque.is_finite();
            self.torque.state[0] = if self.torque_lost { 0.0 } else { reading.torque };
            return;
        };
        self.position.update(filter, reading.position);
        if given.velocity {
            self.velocity.update(filter, reading.velocity);
        }
        if given.acceleration {
            self.acceleration.update(filter, reading.acceleration);
        }
        if given.motor {
            self.motor.update(filter, reading.motor);
        }
        if !reading.torque.is_finite() {
            self.torque_lost = true;
        } else if self.torque_lost {
            self.torque_lost = false;
            self.torque.reset(reading.torque, 0.0, rules.lag);
            self.settling = self.settling.max(rules.memory);
        } else {
            self.torque.update(filter, reading.torque);
        }
    }

    /// Filtered position, velocity and acceleration.
    #[inline(always)]
    pub(super) fn motion(&self, given: Given, filtered: bool) -> [f64; 3] {
        if !filtered {
            return self.position.state;
        }
        let [position, mut velocity, mut acceleration] = self.position.state;
        if given.velocity {
            velocity = self.velocity.state[0];
            acceleration = self.velocity.state[1];
        }
        if given.acceleration {
            acceleration = self.acceleration.state[0];
        }
        [position, velocity, acceleration]
    }

    /// Velocity that the friction is over: the motor's for its own side, where it is known.
    #[inline(always)]
    pub(super) fn sliding(&self, combination: &Combination, velocity: f64) -> f64 {
        let own = combination.side == FrictionSide::Motor && combination.motor_acceleration;
        if own && combination.position == PositionSource::Output {
            return self.motor.state[1];
        }
        velocity
    }

    /// Whether the sample says something of the friction; if not, it is counted under its reason.
    #[inline(always)]
    pub(super) fn is_telling(&mut self, velocity: f64, step: &Step, rules: &Rules) -> bool {
        self.waiting += step.seconds;
        let direction = if velocity.abs() <= rules.dead_band {
            0.0
        } else {
            velocity.signum()
        };
        if direction == self.direction {
            self.moving += step.seconds;
        } else {
            self.direction = direction;
            self.moving = 0.0;
        }
        let skipped = &mut self.skipped;
        let reason = if self.torque_lost {
            &mut skipped.not_finite
        } else if self.settling > 0.0 {
            &mut skipped.settling
        } else if direction == 0.0 {
            &mut skipped.at_rest
        } else if self.moving < rules.hold {
            &mut skipped.reversing
        } else {
            return true;
        };
        *reason += 1;
        false
    }

    /// What the torques leave for the law's terms of friction (and, for the observer, for the rotor) at a filtered motion.
    #[inline(always)]
    pub(super) fn balance(
        &self,
        model: &JointModel,
        combination: &Combination,
        sliding: f64,
        gravity: f64,
        rigid: f64,
    ) -> f64 {
        let mut torque = self.torque.state[0];
        if combination.transmission_torque == Some(TransmissionTorqueSource::Deformation) {
            let deformation = self.motor.state[0] - self.position.state[0];
            let rate = self.motor.state[1] - self.position.state[1];
            torque += model.deformation_sign * model.transmission(deformation, rate);
        }
        if combination.needs_rigid_torque() {
            torque -= rigid;
        }
        if combination.other_side_from_model {
            torque -= law::torque(&model.other_side, sliding, gravity);
        }
        torque -= law::torque(&model.held, sliding, gravity);
        torque
    }

    /// Takes in a sample: the balance of torques at a sliding velocity, and the acceleration of the rotor. `telling`: it says something
    /// of the friction.
    #[inline(always)]
    pub(super) fn estimate(&mut self, model: &JointModel, rules: &Rules, step: &Step, sample: &Sample) {
        let psi = rules.law.regressors(sample.velocity, sample.gravity);
        let (torque, psi) = match &step.lag {
            Some(lag) => self.observe(lag, model, sample, psi),
            None => (sample.torque - model.armature_used * sample.rotor_acceleration, psi),
        };
        if sample.telling {
            self.use_sample(rules, step, sample, torque, &psi);
        }
    }

    /// The friction behind the observer's lag, and the regressors behind the same.
    #[inline(always)]
    fn observe(
        &mut self,
        lag: &LagStep,
        model: &JointModel,
        sample: &Sample,
        psi: [f64; TERMS_MAX],
    ) -> (f64, [f64; TERMS_MAX]) {
        self.observer
            .update(lag, model.armature, sample.torque, sample.rotor_velocity);
        let mut lagged = self.lagged;
        for ((lagged, last), psi) in lagged.iter_mut().zip(self.regressors).zip(psi) {
            *lagged = lag.follow(*lagged, last, psi);
        }
        (self.lagged, self.regressors) = (lagged, psi);
        (self.observer.friction, lagged)
    }

    /// Takes in a torque and its regressors. Inlined to the last sum, so that they stay in registers: a row that is stored one
    /// number at a time and loaded two at a time right after makes the processor wait.
    #[inline(always)]
    fn use_sample(&mut self, rules: &Rules, step: &Step, sample: &Sample, torque: f64, psi: &[f64; TERMS_MAX]) {
        if torque.is_nan() || torque.abs() > TELEMETRY_TORQUE_MAX {
            self.skipped.out_of_range += 1;
            return;
        }
        let square = if rules.method == EstimatorMethod::Kalman {
            self.kalman.wander(self.waiting);
            self.waiting = 0.0;
            let measurement = Measurement {
                psi,
                torque,
                variance: self.spread.robust,
                weight: step.worth.weight(),
                gate: rules.outlier_threshold,
            };
            match self.kalman.update(&measurement) {
                Taken::Used(square) => square,
                Taken::Outlier(square) => {
                    // it is heard of here alone: where all torques have changed, the gate opens
                    self.spread.add(square, step.seconds);
                    self.skipped.outlier += 1;
                    return;
                }
                Taken::NotFinite => {
                    self.skipped.out_of_range += 1;
                    return;
                }
            }
        } else {
            let row = Row {
                psi,
                torque,
                worth: step.worth,
                bound: match rules.outlier_threshold {
                    Some(threshold) => threshold * threshold * self.spread.robust,
                    None => f64::INFINITY,
                },
            };
            let Some(fitted) = self.least_squares.update(&row) else {
                self.skipped.out_of_range += 1;
                return;
            };
            self.discounted += u64::from(fitted.is_discounted);
            fitted.square
        };
        self.spread.add(square, step.seconds);
        self.excitation
            .add(sample.velocity, sample.gravity, step.worth.lambda(), step.seconds);
        self.friction = torque + sample.held;
        self.used += 1;
    }

    /// The coefficients.
    pub(super) fn coefficients(&self, method: EstimatorMethod) -> &[f64; TERMS_MAX] {
        match method {
            EstimatorMethod::Kalman => &self.kalman.coefficients,
            EstimatorMethod::LeastSquares | EstimatorMethod::Observer => &self.least_squares.coefficients,
        }
    }

    /// Covariance of the coefficients as the Kalman filter has it now, time since its last sample included.
    pub(super) fn kalman_covariance(&self) -> [f64; TRIANGLE] {
        let mut kalman = self.kalman.clone();
        kalman.wander(self.waiting);
        kalman.covariance
    }
}

/// One joint's filtered sample.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sample {
    /// What the torques leave for the law's terms of friction and for the rotor.
    pub(super) torque: f64,
    /// Torque of the terms that are held at the model's values.
    pub(super) held: f64,
    pub(super) velocity: f64,
    pub(super) gravity: f64,
    pub(super) rotor_velocity: f64,
    pub(super) rotor_acceleration: f64,
    /// Whether it says something of the friction.
    pub(super) telling: bool,
}
