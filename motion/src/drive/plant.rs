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
//! The arm changes slowly, its transmissions swing fast: M⁻¹, C·q̇ + g, and Jᵀ·F are computed at nodes a fraction of a millisecond apart and run
//! on from there; springs, rotors, damping and friction are integrated between the nodes by Dormand and Prince's pair of
//! orders 5 and 4 with error control (`integrator.rs`). From one node to the next, H away, f runs on as the straight line that is
//! nearest to the parabola through the last three,
//!
//! ```text
//! f(t) ≈ f₀ − δ²/12 + (δ + δ²)·t/H        δ = f₀ − f₋₁,   δ² = f₀ − 2·f₋₁ + f₋₂
//! ```
//!
//! which is off by H³ in the mean. Tests hold the sum of both errors against an independent integrator.

use nalgebra::{Isometry3, Vector3};

use super::feedforward::Joint;
use super::integrator::{Integrator, System};
use crate::budget::Budget;
use crate::dynamics::composite::{self, Composite};
use crate::dynamics::rnea::{LinkWrench, rnea};
use crate::kinematics;
use crate::robot::Robot;
use crate::tolerance::{PLANT_NODES, PLANT_POSITION, PLANT_STEPS_MAX, PLANT_STRIDE, PLANT_TURN_WAY, PLANT_VELOCITY};

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
#[derive(Debug, Clone, Copy, PartialEq, Default)]
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
    /// There is a node with rates.
    started: bool,
    /// Largest distance of two nodes, s.
    nodes: f64,
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
    jacobian: Vec<f64>,
    right: Vec<f64>,
    /// When the last node was.
    node_time: f64,
    /// What was found there, and the rate from the one before it.
    found: Node,
    found_rate: Node,
    /// The line that runs on from there, and its slope.
    node: Node,
    rate: Node,
    /// Room for the next one.
    fresh: Node,
}

/// What changes slowly.
#[derive(Debug, Clone)]
struct Node {
    /// (M + rotors of rigid joints)⁻¹, row by row.
    inverse: Vec<f64>,
    /// C·q̇ + g.
    bias: Vec<f64>,
    /// g, where it is needed.
    gravity: Vec<f64>,
    /// Jᵀ·F.
    push: Vec<f64>,
}

impl Node {
    fn zero(count: usize) -> Self {
        Self {
            inverse: vec![0.0; count * count],
            bias: vec![0.0; count],
            gravity: vec![0.0; count],
            push: vec![0.0; count],
        }
    }

    fn parts(&mut self) -> [&mut Vec<f64>; 4] {
        [&mut self.inverse, &mut self.bias, &mut self.gravity, &mut self.push]
    }
}

impl<'a> Plant<'a> {
    /// An arm in motion, its motors where they hold what is to be held.
    pub(crate) fn new(robot: &'a Robot, joints: Vec<PlantJoint>, q: &[f64], qd: &[f64]) -> Self {
        let count = joints.len();
        let loaded = joints
            .iter()
            .any(|at| at.joint.motor.load > 0.0 || at.joint.output.load > 0.0);
        let still = |q: &f64| {
            [Contact {
                position: *q,
                part: 0.0,
            }; 2]
        };
        let mut arm = Arm {
            robot,
            joints,
            contacts: q.iter().map(still).collect(),
            loaded,
            torque: vec![0.0; count],
            wrench: None,
            links: vec![LinkWrench::zero(0.0); count],
            composites: vec![Composite::zero(); count],
            zeros: vec![0.0; count],
            jacobian: vec![0.0; 6 * count],
            right: vec![0.0; count],
            node_time: 0.0,
            found: Node::zero(count),
            found_rate: Node::zero(count),
            node: Node::zero(count),
            rate: Node::zero(count),
            fresh: Node::zero(count),
        };
        let (links, node) = (&mut arm.links, &mut arm.node);
        rnea::<f64, true>(
            robot.chain(),
            q,
            qd,
            &arm.zeros,
            links,
            &mut node.bias,
            &mut node.gravity,
        );
        let mut state = vec![0.0; 4 * count];
        for (index, at) in arm.joints.iter().enumerate() {
            let elastic = at.joint.transmission.as_ref();
            let wound = elastic.and_then(|elastic| elastic.deformation(arm.node.bias[index]));
            let motor = q[index] + wound.unwrap_or(0.0);
            state[index] = q[index];
            state[count + index] = qd[index];
            state[2 * count + index] = motor;
            state[3 * count + index] = qd[index];
            arm.contacts[index][0].position = motor;
        }
        let weights = [PLANT_POSITION, PLANT_VELOCITY].repeat(2);
        Self {
            arm,
            integrator: Integrator::new(weights.iter().flat_map(|weight| vec![*weight; count]).collect()),
            state,
            time: 0.0,
            started: false,
            nodes: PLANT_NODES,
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
        if self.arm.wrench != wrench {
            self.arm.wrench = wrench;
            self.arm.push_anew(&self.state);
        }
        let pieces = (span / self.nodes).ceil().max(1.0);
        let piece = span / pieces;
        for _ in 0..pieces as usize {
            if !self.started {
                self.start(piece, budget)?;
            }
            self.piece(piece, budget)?;
        }
        Ok(())
    }

    /// The rates of the first node, from a piece that is then taken back.
    fn start(&mut self, span: f64, budget: &Budget<'_>) -> Result<(), Stuck> {
        self.started = true;
        self.arm.first_node(self.time, &self.state)?;
        let (state, time) = (self.state.clone(), self.time);
        let (contacts, found) = (self.arm.contacts.clone(), self.arm.found.clone());
        self.piece(span, budget)?;
        (self.state, self.time) = (state, time);
        (self.arm.contacts, self.arm.found, self.arm.node_time) = (contacts, found, time);
        self.arm.node.clone_from(&self.arm.found);
        self.arm.rate.clone_from(&self.arm.found_rate);
        Ok(())
    }

    /// From one node to the next.
    fn piece(&mut self, span: f64, budget: &Budget<'_>) -> Result<(), Stuck> {
        let end = self.time + span;
        self.integrator.begin();
        for step in 0..PLANT_STEPS_MAX {
            if step % PLANT_STRIDE == 0 {
                budget.check().map_err(|_| Stuck::Stopped)?;
            }
            let left = end - self.time;
            if self.integrator.step(&mut self.arm, self.time, &mut self.state, left) {
                self.time = end;
                return self.arm.next_node(end, &self.state);
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
    /// Makes the first node: nothing is known of rates.
    fn first_node(&mut self, time: f64, state: &[f64]) -> Result<(), Stuck> {
        // a span of any length; what is made of it is thrown away
        self.node_time = time - 1.0;
        self.next_node(time, state)?;
        self.node.clone_from(&self.found);
        for rate in self.rate.parts().into_iter().chain(self.found_rate.parts()) {
            rate.fill(0.0);
        }
        Ok(())
    }

    /// Makes a node of a state, and the line that runs on from it.
    fn next_node(&mut self, time: f64, state: &[f64]) -> Result<(), Stuck> {
        let count = self.joints.len();
        let (q, qd) = (&state[..count], &state[count..2 * count]);
        let (links, fresh) = (&mut self.links, &mut self.fresh);
        let (bias, gravity) = (&mut fresh.bias, &mut fresh.gravity);
        if self.loaded {
            rnea::<f64, true>(self.robot.chain(), q, qd, &self.zeros, links, bias, gravity);
        } else {
            rnea::<f64, false>(self.robot.chain(), q, qd, &self.zeros, links, bias, gravity);
        }
        composite::mass_matrix(self.robot.chain(), q, &mut self.composites, &mut fresh.inverse);
        for (joint, at) in self.joints.iter().enumerate() {
            if at.joint.transmission.is_none() {
                fresh.inverse[joint * count + joint] += at.joint.inertia;
            }
        }
        if !invert(&mut fresh.inverse, count) {
            return Err(Stuck::Diverged);
        }
        push(self.robot, self.wrench, q, &mut self.jacobian, &mut self.fresh.push);
        let span = time - self.node_time;
        let lines = self.node.parts().into_iter().zip(self.rate.parts());
        let known = self.found.parts().into_iter().zip(self.found_rate.parts());
        for (((node, rate), (found, found_rate)), fresh) in lines.zip(known).zip(self.fresh.parts()) {
            for (entry, fresh) in fresh.iter().enumerate() {
                let slope = (fresh - found[entry]) / span;
                let bend = slope - found_rate[entry];
                node[entry] = fresh - bend * span / 12.0;
                rate[entry] = slope + bend;
                found[entry] = *fresh;
                found_rate[entry] = slope;
            }
        }
        self.node_time = time;
        Ok(())
    }

    /// The wrench has changed: its torques begin anew.
    fn push_anew(&mut self, state: &[f64]) {
        let q = &state[..self.joints.len()];
        push(self.robot, self.wrench, q, &mut self.jacobian, &mut self.node.push);
        self.found.push.clone_from(&self.node.push);
        self.rate.push.fill(0.0);
        self.found_rate.push.fill(0.0);
    }

    /// Friction of a joint on the motor's side and on the output's; the state is q, q̇, Θ, Θ̇.
    #[inline]
    fn losses(&self, joint: usize, time: f64, [q, qd, motor, motor_rate]: [f64; 4]) -> [f64; 2] {
        let at = &self.joints[joint];
        let (wet, dry) = (at.wet.at(time), at.dry.at(time));
        let gravity = self.node.gravity[joint] + (time - self.node_time) * self.rate.gravity[joint];
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
}

/// Torques Jᵀ·F of a wrench on the flange.
fn push(robot: &Robot, wrench: Option<Wrench>, q: &[f64], jacobian: &mut [f64], torque: &mut [f64]) {
    torque.fill(0.0);
    let Some(wrench) = wrench else { return };
    let count = q.len();
    kinematics::jacobian(robot, q, &Isometry3::identity(), jacobian);
    for axis in 0..3 {
        let linear = &jacobian[axis * count..(axis + 1) * count];
        let angular = &jacobian[(axis + 3) * count..(axis + 4) * count];
        for ((torque, linear), angular) in torque.iter_mut().zip(linear).zip(angular) {
            *torque += linear * wrench.force[axis] + angular * wrench.moment[axis];
        }
    }
}

/// The inverse of a symmetric positive definite matrix in its place, by Gauss and Jordan's method, which needs no pivots for those.
/// False where it is not one.
fn invert(a: &mut [f64], n: usize) -> bool {
    for k in 0..n {
        let pivot = a[k * n + k];
        if !(pivot > 0.0 && pivot.is_finite()) {
            return false;
        }
        let over = 1.0 / pivot;
        for j in 0..n {
            a[k * n + j] *= over;
        }
        a[k * n + k] = over;
        for i in 0..n {
            if i == k {
                continue;
            }
            let factor = a[i * n + k];
            a[i * n + k] = 0.0;
            for j in 0..n {
                a[i * n + j] -= factor * a[k * n + j];
            }
        }
    }
    true
}

impl System for Arm<'_> {
    fn rates(&mut self, time: f64, state: &[f64], rates: &mut [f64]) {
        let count = self.joints.len();
        let (q, rest) = state.split_at(count);
        let (qd, rest) = rest.split_at(count);
        let (motor, motor_rate) = rest.split_at(count);
        let since = time - self.node_time;
        for joint in 0..count {
            let [on_motor, on_output] =
                self.losses(joint, time, [q[joint], qd[joint], motor[joint], motor_rate[joint]]);
            let own = &self.joints[joint].joint;
            let given = self.torque[joint] - on_motor;
            let through = match &own.transmission {
                Some(elastic) => {
                    let through =
                        elastic.torque(motor[joint] - q[joint]) + elastic.damping() * (motor_rate[joint] - qd[joint]);
                    rates[3 * count + joint] = (given - through) / own.inertia;
                    through
                }
                None => given,
            };
            let slow =
                self.node.bias[joint] - self.node.push[joint] + since * (self.rate.bias[joint] - self.rate.push[joint]);
            self.right[joint] = through - on_output - slow;
        }
        let rows = self
            .node
            .inverse
            .chunks_exact(count)
            .zip(self.rate.inverse.chunks_exact(count));
        for (joint, (row, row_rate)) in rows.enumerate() {
            let entries = row.iter().zip(row_rate).zip(&self.right);
            let acceleration = entries.fold(0.0, |sum, ((entry, rate), right)| sum + (entry + since * rate) * right);
            rates[count + joint] = acceleration;
            if self.joints[joint].joint.transmission.is_none() {
                rates[3 * count + joint] = acceleration;
            }
        }
        rates[..count].copy_from_slice(qd);
        rates[2 * count..3 * count].copy_from_slice(motor_rate);
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

    /// Contacts move on, by way of the place where they turned round under the mean acceleration: x₀ − v₀²/(2·a).
    fn accept(&mut self, span: f64, from: &[f64], to: &[f64]) {
        let count = self.joints.len();
        for (joint, at) in self.joints.iter().enumerate() {
            for (side, (part, loss)) in [(2, &at.joint.motor), (0, &at.joint.output)].into_iter().enumerate() {
                let (position, rate) = (part * count + joint, (part + 1) * count + joint);
                let contact = &mut self.contacts[joint][side];
                if loss.is_dry() {
                    let (before, after) = (from[rate], to[rate]);
                    if before * after < 0.0 {
                        let turn = from[position] - 0.5 * span * before * before / (after - before);
                        contact.part = loss.part_after(contact.part, turn - contact.position);
                        contact.position = turn;
                    }
                    contact.part = loss.part_after(contact.part, to[position] - contact.position);
                }
                contact.position = to[position];
            }
        }
    }
}

#[cfg(test)]
mod tests;
