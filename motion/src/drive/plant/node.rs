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

use nalgebra::Isometry3;

use super::{Arm, Stuck, Wrench};
use crate::dynamics::composite;
use crate::dynamics::rnea::rnea;
use crate::kinematics;
use crate::robot::Robot;

/// What changes slowly.
#[derive(Debug, Clone)]
pub(super) struct Node {
    /// (M + rotors of rigid joints)⁻¹, row by row.
    pub(super) inverse: Vec<f64>,
    /// C·q̇ + g.
    pub(super) bias: Vec<f64>,
    /// g, where it is needed.
    pub(super) gravity: Vec<f64>,
    /// Jᵀ·F.
    pub(super) push: Vec<f64>,
}

impl Node {
    pub(super) fn zero(count: usize) -> Self {
        Self {
            inverse: vec![0.0; count * count],
            bias: vec![0.0; count],
            gravity: vec![0.0; count],
            push: vec![0.0; count],
        }
    }

    pub(super) fn parts(&mut self) -> [&mut Vec<f64>; 4] {
        [&mut self.inverse, &mut self.bias, &mut self.gravity, &mut self.push]
    }
}

impl Arm<'_> {
    /// Makes the first node: nothing is known of rates.
    pub(super) fn first_node(&mut self, time: f64, state: &[f64]) -> Result<(), Stuck> {
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
    pub(super) fn next_node(&mut self, time: f64, state: &[f64]) -> Result<(), Stuck> {
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
    pub(super) fn push_anew(&mut self, state: &[f64]) {
        let q = &state[..self.joints.len()];
        push(self.robot, self.wrench, q, &mut self.jacobian, &mut self.node.push);
        self.found.push.clone_from(&self.node.push);
        self.rate.push.fill(0.0);
        self.found_rate.push.fill(0.0);
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
