//! One sample of the whole arm: read, filtered, weighed, and handed to its joints.

use std::f64::consts::LN_2;

use super::filter::FilterStep;
use super::joint::{Given, JointState, Reading, Sample, Step};
use super::law;
use super::least_squares::Worth;
use super::observer::LagStep;
use super::{
    Behind, Combination, EstimatorMethod, FrictionEstimator, Memory, MotorTorqueSource, PositionSource, TERMS_MAX,
    TransmissionTorqueSource,
};
use crate::drive::telemetry::Telemetry;
use crate::dynamics::rnea;
use crate::tolerance::{
    POSITION_MAX, TELEMETRY_ACCELERATION_MAX, TELEMETRY_CLOCK_SET, TELEMETRY_STEP_GRID, TELEMETRY_STEP_MIN,
    TELEMETRY_TIME_MAX, TELEMETRY_TORQUE_MAX, TELEMETRY_VELOCITY_MAX,
};

enum Unreadable {
    NotFinite,
    OutOfRange,
}

impl FrictionEstimator {
    /// Takes in one sample of a block.
    pub(super) fn take(&mut self, block: &Telemetry, index: usize, combination: &Combination) {
        let time = block.time[index];
        let given = Given {
            velocity: !block.output_velocity.is_empty(),
            acceleration: !block.output_acceleration.is_empty(),
            motor: combination.motor_acceleration
                || combination.transmission_torque == Some(TransmissionTorqueSource::Deformation),
        };
        let read = check(time, TELEMETRY_TIME_MAX).and_then(|()| self.read(block, index, combination, given));
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
        // in whole parts, so that samples at one interval have one step, whatever their times are rounded to
        let seconds = self
            .time
            .map(|last| libm::rint((time - last) / TELEMETRY_STEP_GRID) * TELEMETRY_STEP_GRID);
        if seconds.is_some_and(|seconds| seconds < TELEMETRY_STEP_MIN) && !self.was_clock_set_back(time) {
            self.skipped.time_went_backwards += 1;
            return;
        }
        self.behind = None;
        self.sample_count += 1;
        self.time = Some(time);
        match seconds {
            Some(seconds) if (0.0..=self.options.gap).contains(&seconds) => self.go_on(seconds, given, combination),
            _ => {
                self.skipped.gaps += u64::from(seconds.is_some());
                self.restart(seconds.map(|seconds| seconds.max(0.0)), given, combination);
            }
        }
    }

    /// Whether samples that are behind the last one have come in order for so long that it is the clock that was set, back or for one sample forward. Single
    /// samples that come late are between others that do not.
    fn was_clock_set_back(&mut self, time: f64) -> bool {
        let seconds = match self.behind {
            Some(behind) if (TELEMETRY_STEP_MIN..=self.options.gap).contains(&(time - behind.time)) => {
                behind.seconds + time - behind.time
            }
            _ => 0.0,
        };
        self.behind = Some(Behind { time, seconds });
        seconds >= TELEMETRY_CLOCK_SET
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
            let motor = at(&block.motor_position, joint) * model.joint_over_motor;
            let position = match combination.position {
                PositionSource::Output => at(&block.output_position, joint),
                PositionSource::Motor => motor,
            };
            check(position, POSITION_MAX)?;
            let (mut velocity, mut acceleration) = (0.0, 0.0);
            if given.velocity {
                velocity = at(&block.output_velocity, joint);
                check(velocity, TELEMETRY_VELOCITY_MAX)?;
            }
            if given.acceleration {
                acceleration = at(&block.output_acceleration, joint);
                check(acceleration, TELEMETRY_ACCELERATION_MAX)?;
            }
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
        if !(combination.needs_rigid_torque() || self.rules.loads) {
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
                held: law::torque(&model.held, velocity, gravity),
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
        let lambda = match self.options.memory {
            Memory::Forever => 1.0,
            Memory::Factor(lambda) => lambda,
            Memory::HalfLife(half_life) => libm::exp(-LN_2 * seconds / half_life),
        };
        let step = Step {
            seconds,
            filter: self
                .options
                .bandwidth
                .map(|bandwidth| FilterStep::new(bandwidth, seconds)),
            lag: (self.rules.method == EstimatorMethod::Observer)
                .then(|| LagStep::new(self.options.observer_rate, seconds)),
            worth: Worth::new(
                (0.5 * seconds / self.options.correlation_time).min(1.0),
                lambda,
                seconds,
            ),
        };
        self.scratch.step = Some(step);
        step
    }
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
