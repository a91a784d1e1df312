//! The controller of one arm, step by step: for a cell controller to link into its own loop, and for rehearsals.
//!
//! ```text
//! τJ,d = M·q̈d + C·q̇d + g + F̂q                      F̂ = F_model + ΔF̂
//! τr   = B·Θ̈d + τJ,d + F̂Θ                           feed-forward
//!      + K_t·(τJ,d − τ̂J)                              torque error
//!      + K_p·(Θd − Θ) + K_d·(Θ̇d − Θ̇)                feedback,  Θd = qd + τE⁻¹(τJ,d)
//! i    = τr/(ξ·k_t), after limits
//! ```
//!
//! ("controlling a robot arm based on adaptive friction", figs. 6, 8, 10.) τ̂J = τE(Θ − q) + D·d(Θ − q)/dt where the output's position is
//! measured, the model's τJ,d where it is not. Friction is adapted by the observer of fig. 11 on either side,
//!
//! ```text
//! d(ΔF̂Θ)/dt = L·(τm − B·Θ̈ − τ̂J − F_model,Θ − ΔF̂Θ)        d(ΔF̂q)/dt = L·(τ̂J − (M·q̈d + C·q̇d + g) − F_model,q − ΔF̂q)
//! ```
//!
//! on what the model's friction, and the coefficients that are learned where asked for (`adapt.rs`), leave over: a first-order lag of rate L. Over a period T its input is constant, so that its exact
//! solution is ΔF̂ ← ΔF̂ + (1 − e^(−L·T))·(r − ΔF̂): stable for every T. Where the output is not measured ΔF̂Θ takes in both sides, and
//! what the tracking error accelerates besides.
//!
//! What is desired is computed beforehand ([`feed_forward`](super::feedforward::feed_forward)) and friction added here, so that adapting costs no dynamics. A
//! step allocates nothing, reads no clock and has no state but what it is given.

pub use super::adapt::Learned;
use super::feedforward::{Desired, Joint};
pub use super::gains::{JointGains, default_gains};
use crate::error::Invalid;
use crate::robot::Robot;
use crate::tolerance::{ADAPT_MEMORY, ADAPT_OUTPUT};

/// Whether, and how fast, friction is adapted. L is that of the motor's side; the output's side, whose friction is only seen
/// through the arm's own swinging, has a quarter of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Adaptation {
    /// The model's friction.
    Off,
    /// By the observer.
    Observer {
        /// L, 1/s; `None`: K_p/K_d of the joint.
        rate: Option<f64>,
    },
    /// By coefficients that are learned, and by the observer for what they leave over.
    Law {
        /// L, 1/s; `None`: K_p/K_d of the joint.
        rate: Option<f64>,
        /// How long is remembered, s; `None`: 2.
        memory: Option<f64>,
    },
}

impl Default for Adaptation {
    fn default() -> Self {
        Self::Law {
            rate: None,
            memory: None,
        }
    }
}

impl Adaptation {
    /// L of a joint, 1/s.
    fn rate(self, gains: &JointGains) -> f64 {
        match self {
            Self::Off => 0.0,
            Self::Observer { rate: Some(rate) } | Self::Law { rate: Some(rate), .. } => rate,
            Self::Observer { rate: None } | Self::Law { rate: None, .. } if gains.velocity > 0.0 => {
                gains.position / gains.velocity
            }
            Self::Observer { rate: None } | Self::Law { rate: None, .. } => 0.0,
        }
    }

    /// λ at a period; `None` where nothing is learned.
    fn forget(self, period: f64) -> Option<f64> {
        let Self::Law { memory, .. } = self else { return None };
        Some(libm::exp(-period / memory.unwrap_or(ADAPT_MEMORY)))
    }

    fn check(self, wrong: &mut Vec<Invalid>) {
        let (rate, memory) = match self {
            Self::Off => (None, None),
            Self::Observer { rate } => (rate, None),
            Self::Law { rate, memory } => (rate, memory),
        };
        if let Some(rate) = rate.filter(|rate| !(rate.is_finite() && *rate >= 0.0)) {
            let message = format!("{rate} must be finite and at least 0");
            wrong.push(Invalid::new("adaptation.rate", message));
        }
        if let Some(memory) = memory.filter(|memory| !(memory.is_finite() && *memory > 0.0)) {
            let message = format!("{memory} must be positive and finite");
            wrong.push(Invalid::new("adaptation.memory", message));
        }
    }
}

/// What is measured of a joint at the beginning of a step, seen from the joint.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Measured {
    /// Θ: the motor's position over the gear ratio.
    pub motor_position: f64,
    /// q, where it is measured.
    pub output_position: Option<f64>,
}

/// What the controller knows of a joint from one step to the next.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct JointState {
    /// Something was measured before.
    pub running: bool,
    /// Θ at the step before.
    pub motor_position: f64,
    /// Θ̇ over the period before, as differenced.
    pub motor_velocity: f64,
    /// Θ̇d at the step before.
    pub desired_velocity: f64,
    /// Θ̇d − Θ̇, filtered.
    pub velocity_error: f64,
    /// Θ − q at the step before.
    pub deformation: f64,
    /// d(Θ − q)/dt, filtered.
    pub deformation_rate: f64,
    /// τ̂J at the step before.
    pub transmission_torque: f64,
    /// Torque that the motor was told to give over the period before.
    pub motor_torque: f64,
    /// The same of the period before that.
    pub motor_torque_before: f64,
    /// The model's friction on the motor's side at the step before.
    pub motor_model: f64,
    /// ΔF̂Θ, without what is learned.
    pub motor_friction: f64,
    /// ΔF̂q, without what is learned.
    pub output_friction: f64,
    /// What is learned of the friction on the motor's side.
    pub motor_learned: Learned,
    /// The same of the output's side.
    pub output_learned: Learned,
}

/// What a joint's motor is told.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Command {
    /// Torque within its limit, at the joint.
    pub torque: f64,
    /// Torque that the controller would have, at the joint.
    pub demanded: f64,
    /// A, for `torque`; `None` where the torque constant is not known.
    pub current: Option<f64>,
    /// What friction was taken for, both sides together.
    pub friction: f64,
}

/// The controller of one joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointController {
    joint: Joint,
    gains: JointGains,
    /// s.
    period: f64,
    /// 1 − e^(−ω·T) of the speed's filter.
    filter: f64,
    /// 1 − e^(−L·T) on the motor's side; 0 without adaptation.
    adaptation: f64,
    /// The same on the output's.
    output_adaptation: f64,
    /// λ of the coefficients; `None`: none are learned.
    forget: Option<f64>,
    /// Largest torque at the joint, infinite where none is known.
    limit: f64,
}

/// The controllers of an arm.
#[derive(Debug, Clone, PartialEq)]
pub struct Controller {
    joints: Vec<JointController>,
}

impl Controller {
    /// The controller of a robot at a period, in s. `current_limits` may be empty.
    ///
    /// # Errors
    /// A period, gain, rate or limit that cannot be.
    pub fn new(
        robot: &Robot,
        gains: &[JointGains],
        current_limits: &[f64],
        adaptation: Adaptation,
        period: f64,
    ) -> Result<Self, Vec<Invalid>> {
        let mut wrong = Vec::new();
        let count = robot.joint_count();
        if gains.len() != count {
            let message = format!("{} values, the robot has {count} joints", gains.len());
            wrong.push(Invalid::new("gains", message));
        }
        if !current_limits.is_empty() && current_limits.len() != count {
            let message = format!("{} values, the robot has {count} joints", current_limits.len());
            wrong.push(Invalid::new("current_limits", message));
        }
        if !(period.is_finite() && period > 0.0) {
            wrong.push(Invalid::new(
                "period_s",
                format!("{period} must be positive and finite"),
            ));
        }
        for (joint, gains) in gains.iter().enumerate() {
            gains.check(&format!("gains[{joint}]"), &mut wrong);
        }
        adaptation.check(&mut wrong);
        for (joint, limit) in current_limits.iter().enumerate() {
            let path = format!("current_limits[{joint}]");
            if !(*limit > 0.0) {
                wrong.push(Invalid::new(path, format!("{limit} must be positive")));
            } else if robot
                .spec()
                .joints
                .get(joint)
                .is_some_and(|j| j.drive.torque_constant.is_none())
            {
                let message = "the drive has no torque constant, so that a current means no torque";
                wrong.push(Invalid::new(path, message));
            }
        }
        if !wrong.is_empty() {
            return Err(wrong);
        }
        let joints = robot
            .spec()
            .joints
            .iter()
            .zip(gains)
            .enumerate()
            .map(|(index, (spec, gains))| {
                let joint = Joint::new(&spec.drive);
                let by_current = current_limits.get(index).zip(joint.torque_constant);
                let by_current = by_current.map_or(f64::INFINITY, |(current, constant)| current * constant.abs());
                JointController {
                    joint,
                    gains: *gains,
                    period,
                    filter: lag(gains.velocity_filter * period),
                    adaptation: lag(adaptation.rate(gains) * period),
                    output_adaptation: lag(ADAPT_OUTPUT * adaptation.rate(gains) * period),
                    forget: adaptation.forget(period),
                    limit: spec.drive.peak_torque.unwrap_or(f64::INFINITY).min(by_current),
                }
            });
        Ok(Self {
            joints: joints.collect(),
        })
    }

    /// States of all joints before the first step.
    #[must_use]
    pub fn start(&self) -> Vec<JointState> {
        vec![JointState::default(); self.joints.len()]
    }

    /// The controllers of the joints.
    #[must_use]
    pub fn joints(&self) -> &[JointController] {
        &self.joints
    }

    /// One step of all joints: `desired` at its time, `next` a period later. Slices have one entry a joint; allocates nothing.
    pub fn step(
        &self,
        states: &mut [JointState],
        measured: &[Measured],
        desired: &[Desired],
        next: &[Desired],
        commands: &mut [Command],
    ) {
        let inputs = measured.iter().zip(desired.iter().zip(next));
        let joints = self.joints.iter().zip(states).zip(commands);
        for (((joint, state), command), (measured, (desired, next))) in joints.zip(inputs) {
            (*state, *command) = joint.step(*state, *measured, desired, next);
        }
    }
}

impl JointController {
    /// Largest torque that is commanded, infinite where none is known.
    #[must_use]
    pub fn limit(&self) -> f64 {
        self.limit
    }

    /// One step: from what was known and is measured to what is known and commanded.
    ///
    /// The command acts from now until the next step, so that its feed-forward is the mean of both.
    #[must_use]
    pub fn step(
        &self,
        mut state: JointState,
        measured: Measured,
        desired: &Desired,
        next: &Desired,
    ) -> (JointState, Command) {
        let seen = measured.motor_position.is_finite() && measured.output_position.is_none_or(f64::is_finite);
        if !seen {
            return self.blind(state, desired, next);
        }
        self.observe(&mut state, measured, desired);
        let output_friction = self.output_friction(&state, desired);
        let motor_friction = self.motor_friction(&state, desired);
        let transmission_torque = desired.rigid_torque + output_friction;
        let deformation = self.joint.transmission.as_ref().map_or(0.0, |elastic| {
            let largest = elastic.largest().deformation.copysign(transmission_torque);
            elastic.deformation(transmission_torque).unwrap_or(largest)
        });
        let torque_error = match measured.output_position {
            Some(_) if self.joint.transmission.is_some() => transmission_torque - state.transmission_torque,
            _ => 0.0,
        };
        let now = self.joint.inertia * desired.motor_acceleration + transmission_torque + motor_friction;
        let feed_forward = 0.5 * (now + self.feed_forward(&state, next));
        let demanded = feed_forward
            + self.gains.torque * torque_error
            + self.gains.position * (desired.position + deformation - measured.motor_position)
            + self.gains.velocity * state.velocity_error;
        self.told(state, demanded, output_friction + motor_friction)
    }

    /// A step whose measurement is no number: the feed-forward alone; the next measurement begins anew.
    fn blind(&self, mut state: JointState, desired: &Desired, next: &Desired) -> (JointState, Command) {
        let demanded = 0.5 * (self.feed_forward(&state, desired) + self.feed_forward(&state, next));
        state.running = false;
        let friction = self.output_friction(&state, desired) + self.motor_friction(&state, desired);
        self.told(state, demanded, friction)
    }

    /// What the motor is told of what it should give.
    fn told(&self, mut state: JointState, demanded: f64, friction: f64) -> (JointState, Command) {
        let torque = demanded.clamp(-self.limit, self.limit);
        state.motor_torque_before = state.motor_torque;
        state.motor_torque = torque;
        let command = Command {
            torque,
            demanded,
            current: self.joint.torque_constant.map(|constant| torque / constant),
            friction,
        };
        (state, command)
    }

    fn feed_forward(&self, state: &JointState, at: &Desired) -> f64 {
        self.joint.inertia * at.motor_acceleration
            + at.rigid_torque
            + self.output_friction(state, at)
            + self.motor_friction(state, at)
    }

    /// F̂q.
    fn output_friction(&self, state: &JointState, at: &Desired) -> f64 {
        self.model_output(at) + state.output_learned.friction(at.velocity) + state.output_friction
    }

    /// F̂Θ.
    fn motor_friction(&self, state: &JointState, at: &Desired) -> f64 {
        self.model_motor(at) + state.motor_learned.friction(at.motor_velocity) + state.motor_friction
    }

    fn model_output(&self, at: &Desired) -> f64 {
        self.joint.output.sliding(at.velocity, at.gravity_torque)
    }

    fn model_motor(&self, at: &Desired) -> f64 {
        self.joint.motor.sliding(at.motor_velocity, at.gravity_torque)
    }

    /// Takes in what is measured: speed, transmission torque, and what friction is beyond the model's.
    fn observe(&self, state: &mut JointState, measured: Measured, desired: &Desired) {
        let elastic = self.joint.transmission.as_ref().zip(measured.output_position);
        let deformation = elastic.map_or(0.0, |(_, output)| measured.motor_position - output);
        if !state.running {
            state.running = true;
            state.motor_velocity = desired.motor_velocity;
            state.deformation_rate = desired.motor_velocity - desired.velocity;
            state.motor_torque = desired.motor_torque;
            state.motor_torque_before = desired.motor_torque;
        } else {
            // the same filter and the same half period late on either side: the error has no lag of its own
            let velocity = (measured.motor_position - state.motor_position) / self.period;
            let error = 0.5 * (state.desired_velocity + desired.motor_velocity) - velocity;
            state.velocity_error += self.filter * (error - state.velocity_error);
            let winding = (deformation - state.deformation) / self.period;
            state.deformation_rate += self.filter * (winding - state.deformation_rate);
            // speeds are those of the middles of two periods: everything is taken where they meet, at the step before
            let given = 0.5 * (state.motor_torque + state.motor_torque_before);
            let gain = self.joint.inertia * (velocity - state.motor_velocity) / self.period;
            let left = given - gain - state.transmission_torque - state.motor_model;
            if let Some(forget) = self.forget {
                state.motor_learned.learn(state.desired_velocity, left, forget);
            }
            let left = left - state.motor_learned.friction(state.desired_velocity);
            state.motor_friction += self.adaptation * (left - state.motor_friction);
            state.motor_velocity = velocity;
        }
        state.motor_position = measured.motor_position;
        state.desired_velocity = desired.motor_velocity;
        state.deformation = deformation;
        state.motor_model = self.model_motor(desired);
        state.transmission_torque = self.transmission_torque(state, measured, desired);
        if elastic.is_some() {
            let left = state.transmission_torque - desired.rigid_torque - self.model_output(desired);
            if let Some(forget) = self.forget {
                state.output_learned.learn(desired.velocity, left, forget);
            }
            let left = left - state.output_learned.friction(desired.velocity);
            state.output_friction += self.output_adaptation * (left - state.output_friction);
        }
    }

    /// τ̂J.
    fn transmission_torque(&self, state: &JointState, measured: Measured, desired: &Desired) -> f64 {
        match (&self.joint.transmission, measured.output_position) {
            (Some(elastic), Some(_)) => {
                let reach = elastic.largest().deformation;
                elastic.torque(state.deformation.clamp(-reach, reach)) + elastic.damping() * state.deformation_rate
            }
            _ => desired.transmission_torque,
        }
    }
}

/// 1 − e^(−x).
fn lag(x: f64) -> f64 {
    -libm::expm1(-x)
}

#[cfg(test)]
mod tests;
