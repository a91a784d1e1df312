//! The simulated arm: joints, motors, and what is between them.
//!
//! ```text
//! M(q)·q̈ = τJ − C(q, q̇)·q̇ − g(q) − Fq + Jᵀ·F        elastic joints: τJ = τE(Θ − q) + D·(Θ̇ − q̇)
//! B·Θ̈    = τm − τJ − FΘ
//! (M + B)·q̈ = τm − C·q̇ − g − FΘ − Fq + Jᵀ·F          rigid ones: Θ = q
//! ```
//!
//! ("controlling a robot arm based on adaptive friction", eq 10 to 12; Spong 1987: the rotors' own turning is all of their kinetic energy.) F is the
//! wrench that acts on the flange. The motors' torques are constant over a step of the controller. Friction is that of
//! `loss.rs`, dry friction as a function of the way since a joint last turned, so that standstill holds and nothing chatters; what
//! that is off by is the presliding way itself (see `PRESLIDING_DEFAULT`). Base-link axes, SI units, seen from the joint.
//!
//! Integrated by Dormand and Prince's pair of orders 5 and 4 with error control (`integrator.rs`).

use nalgebra::{Isometry3, Vector3};

use super::feedforward::Joint;
use super::integrator::{Integrator, System};
use crate::budget::Budget;
use crate::dynamics::composite::{self, Composite};
use crate::dynamics::rnea::{LinkWrench, rnea};
use crate::dynamics::solve_symmetric;
use crate::kinematics;
use crate::robot::Robot;
use crate::tolerance::{PLANT_POSITION, PLANT_STEPS_MAX, PLANT_STRIDE, PLANT_TURN_WAY, PLANT_VELOCITY};

/// How friction differs from the model's: F = (scale + rate·t)·F_model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Drift {
    pub(crate) scale: f64,
    pub(crate) rate: f64,
}

impl Drift {
    #[inline]
    fn at(&self, time: f64) -> f64 {
        (self.scale + self.rate * time).max(0.0)
    }
}

/// One joint of the arm.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PlantJoint {
    pub(crate) joint: Joint,
    /// Of the dry friction.
    pub(crate) dry: Drift,
    /// Of the friction that depends on speed.
    pub(crate) wet: Drift,
}

/// Where a contact last was, and the part of its dry friction that was in force.
#[derive(Debug, Clone, Copy, Default)]
struct Contact {
    position: f64,
    part: f64,
}

/// What moves the arm over a step of the controller.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Wrench {
    pub(crate) force: Vector3<f64>,
    pub(crate) moment: Vector3<f64>,
}

/// Why a step could not be made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Stuck {
    /// Something is no longer a number, or the mass matrix is singular.
    Diverged,
    /// More steps of the integrator than may be.
    TooStiff,
    /// Nobody waits any more.
    Stopped,
}

/// The state of an arm that moves.
pub(crate) struct Plant<'a> {
    pub(crate) arm: Arm<'a>,
    integrator: Integrator,
    /// q, q̇, Θ, Θ̇, each of all joints.
    pub(crate) state: Vec<f64>,
    pub(crate) time: f64,
}

/// What an arm is made of, and what acts on it.
pub(crate) struct Arm<'a> {
    robot: &'a Robot,
    pub(crate) joints: Vec<PlantJoint>,
    /// Contacts of the motors, then of the outputs.
    contacts: Vec<[Contact; 2]>,
    /// Gravity's torque is needed, since some friction grows with it.
    loaded: bool,
    torque: Vec<f64>,
    wrench: Option<Wrench>,
    links: Vec<LinkWrench<f64>>,
    composites: Vec<Composite>,
    zeros: Vec<f64>,
    bias: Vec<f64>,
    gravity: Vec<f64>,
    matrix: Vec<f64>,
    jacobian: Vec<f64>,
    right: Vec<f64>,
}

impl<'a> Plant<'a> {
    /// An arm in motion, its motors where they hold what is to be held.
    pub(crate) fn new(robot: &'a Robot, joints: Vec<PlantJoint>, q: &[f64], qd: &[f64]) -> Self {
        let count = joints.len();
        let loaded = joints
            .iter()
            .any(|at| at.joint.motor.load > 0.0 || at.joint.output.load > 0.0);
        let mut arm = Arm {
            robot,
            joints,
            contacts: q
                .iter()
                .map(|q| {
                    [Contact {
                        position: *q,
                        part: 0.0,
                    }; 2]
                })
                .collect(),
            loaded,
            torque: vec![0.0; count],
            wrench: None,
            links: vec![LinkWrench::zero(0.0); count],
            composites: vec![Composite::zero(); count],
            zeros: vec![0.0; count],
            bias: vec![0.0; count],
            gravity: vec![0.0; count],
            matrix: vec![0.0; count * count],
            jacobian: vec![0.0; 6 * count],
            right: vec![0.0; count],
        };
        arm.bias(q, qd);
        let mut state = vec![0.0; 4 * count];
        for (index, at) in arm.joints.iter().enumerate() {
            let wound = at
                .joint
                .transmission
                .as_ref()
                .and_then(|elastic| elastic.deformation(arm.bias[index]));
            let motor = q[index] + wound.unwrap_or(0.0);
            state[index] = q[index];
            state[count + index] = qd[index];
            state[2 * count + index] = motor;
            state[3 * count + index] = qd[index];
            arm.contacts[index][0].position = motor;
        }
        Self {
            arm,
            integrator: Integrator::new(
                [PLANT_POSITION, PLANT_VELOCITY]
                    .repeat(2)
                    .iter()
                    .flat_map(|of| vec![*of; count])
                    .collect(),
            ),
            state,
            time: 0.0,
        }
    }

    /// Lets the arm move for a time under constant motor torques and a constant wrench.
    pub(crate) fn advance(
        &mut self,
        torque: &[f64],
        wrench: Option<Wrench>,
        span: f64,
        budget: &Budget<'_>,
    ) -> Result<(), Stuck> {
        self.arm.torque.copy_from_slice(torque);
        self.arm.wrench = wrench;
        let end = self.time + span;
        self.integrator.begin();
        for step in 0..PLANT_STEPS_MAX {
            if step % PLANT_STRIDE == 0 {
                budget.check().map_err(|_| Stuck::Stopped)?;
            }
            let left = end - self.time;
            if self.integrator.step(&mut self.arm, self.time, &mut self.state, left)? {
                self.time = end;
                return Ok(());
            }
            self.time += self.integrator.taken;
        }
        Err(Stuck::TooStiff)
    }

    /// Steps of the integrator since the beginning, those not accepted included.
    pub(crate) fn steps(&self) -> u64 {
        self.integrator.steps
    }

    pub(crate) fn position(&self) -> &[f64] {
        &self.state[..self.arm.joints.len()]
    }

    pub(crate) fn velocity(&self) -> &[f64] {
        let count = self.arm.joints.len();
        &self.state[count..2 * count]
    }

    pub(crate) fn motor_position(&self) -> &[f64] {
        let count = self.arm.joints.len();
        &self.state[2 * count..3 * count]
    }

    /// Torque through a transmission, and friction on both sides together, as they are now.
    pub(crate) fn torques(&self, joint: usize) -> (f64, f64) {
        let count = self.arm.joints.len();
        let at = |part: usize| self.state[part * count + joint];
        let loss = self.arm.losses(joint, self.time, [at(0), at(1), at(2), at(3)]);
        let through = match &self.arm.joints[joint].joint.transmission {
            Some(elastic) => elastic.torque(at(2) - at(0)) + elastic.damping() * (at(3) - at(1)),
            None => self.arm.torque[joint] - loss[0],
        };
        (through, loss[0] + loss[1])
    }
}

impl Arm<'_> {
    /// C·q̇ + g, and g where it is needed.
    fn bias(&mut self, q: &[f64], qd: &[f64]) {
        let links = &mut self.links;
        if self.loaded {
            rnea::<f64, true>(
                self.robot.chain(),
                q,
                qd,
                &self.zeros,
                links,
                &mut self.bias,
                &mut self.gravity,
            );
        } else {
            rnea::<f64, false>(
                self.robot.chain(),
                q,
                qd,
                &self.zeros,
                links,
                &mut self.bias,
                &mut self.gravity,
            );
        }
    }

    /// Friction of a joint on the motor's side and on the output's; the state is q, q̇, Θ, Θ̇.
    #[inline]
    fn losses(&self, joint: usize, time: f64, [q, qd, motor, motor_rate]: [f64; 4]) -> [f64; 2] {
        let at = &self.joints[joint];
        let (wet, dry) = (at.wet.at(time), at.dry.at(time));
        let gravity = self.gravity[joint];
        let sides = [(&at.joint.motor, motor, motor_rate), (&at.joint.output, q, qd)];
        let mut losses = [0.0; 2];
        for (side, (loss, position, rate)) in sides.into_iter().enumerate() {
            losses[side] = wet * loss.wet(rate);
            if loss.is_dry() {
                let contact = &self.contacts[joint][side];
                let part = loss.part_after(contact.part, position - contact.position);
                losses[side] += dry * loss.dry(part, gravity);
            }
        }
        losses
    }

    fn add_wrench(&mut self, q: &[f64]) {
        let Some(wrench) = self.wrench else { return };
        let count = q.len();
        kinematics::jacobian(self.robot, q, &Isometry3::identity(), &mut self.jacobian);
        for axis in 0..3 {
            let linear = &self.jacobian[axis * count..(axis + 1) * count];
            let angular = &self.jacobian[(axis + 3) * count..(axis + 4) * count];
            for ((right, linear), angular) in self.right.iter_mut().zip(linear).zip(angular) {
                *right += linear * wrench.force[axis] + angular * wrench.moment[axis];
            }
        }
    }
}

impl System for Arm<'_> {
    fn rates(&mut self, time: f64, state: &[f64], rates: &mut [f64]) -> bool {
        let count = self.joints.len();
        let (q, rest) = state.split_at(count);
        let (qd, rest) = rest.split_at(count);
        let (motor, motor_rate) = rest.split_at(count);
        self.bias(q, qd);
        composite::mass_matrix(self.robot.chain(), q, &mut self.composites, &mut self.matrix);
        for joint in 0..count {
            let [on_motor, on_output] =
                self.losses(joint, time, [q[joint], qd[joint], motor[joint], motor_rate[joint]]);
            let own = self.joints[joint].joint;
            let given = self.torque[joint] - on_motor;
            self.right[joint] = match own.transmission {
                Some(elastic) => {
                    let through =
                        elastic.torque(motor[joint] - q[joint]) + elastic.damping() * (motor_rate[joint] - qd[joint]);
                    rates[3 * count + joint] = (given - through) / own.inertia;
                    through
                }
                None => {
                    self.matrix[joint * count + joint] += own.inertia;
                    given
                }
            } - self.bias[joint]
                - on_output;
        }
        self.add_wrench(q);
        if !solve_symmetric(&mut self.matrix, &mut self.right) {
            return false;
        }
        for joint in 0..count {
            rates[joint] = qd[joint];
            rates[count + joint] = self.right[joint];
            rates[2 * count + joint] = motor_rate[joint];
            if self.joints[joint].joint.transmission.is_none() {
                rates[3 * count + joint] = self.right[joint];
            }
        }
        true
    }

    /// A joint with dry friction that turns round does so over a way on which friction hardly changes.
    fn is_fine(&self, span: f64, from: &[f64], to: &[f64]) -> bool {
        let count = self.joints.len();
        self.joints.iter().enumerate().all(|(joint, at)| {
            [(2, &at.joint.motor), (0, &at.joint.output)]
                .into_iter()
                .all(|(part, loss)| {
                    let (before, after) = (from[(part + 1) * count + joint], to[(part + 1) * count + joint]);
                    if !loss.is_dry() || before * after >= 0.0 {
                        return true;
                    }
                    // way out and way back under the mean acceleration: v²/(2·a)
                    let larger = before.abs().max(after.abs());
                    0.5 * span * larger * larger / (before - after).abs() <= PLANT_TURN_WAY * loss.presliding
                })
        })
    }

    fn accept(&mut self, to: &[f64]) {
        let count = self.joints.len();
        for (joint, at) in self.joints.iter().enumerate() {
            for (side, (part, loss)) in [(2, &at.joint.motor), (0, &at.joint.output)].into_iter().enumerate() {
                let position = to[part * count + joint];
                let contact = &mut self.contacts[joint][side];
                if loss.is_dry() {
                    contact.part = loss.part_after(contact.part, position - contact.position);
                }
                contact.position = position;
            }
        }
    }
}

#[cfg(test)]
mod tests;
