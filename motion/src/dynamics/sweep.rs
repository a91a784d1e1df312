//! Inverse dynamics of many states at once, as many side by side as the processor has lanes.

use pulp::{Simd, WithSimd};

use super::chain::Chain;
use super::rnea::{LinkWrench, rnea};
use crate::scalar::{LANES_MAX, Lanes};
use crate::trajectory::{Polynomial, evaluate};

/// States and their torques as columns, joint by joint: entry `joint * stride + state`.
#[derive(Debug, Default)]
pub(crate) struct Sweep {
    stride: usize,
    joint_count: usize,
    pub(crate) position: Vec<f64>,
    pub(crate) velocity: Vec<f64>,
    pub(crate) acceleration: Vec<f64>,
    /// Rigid-body torque.
    pub(crate) torque: Vec<f64>,
    /// Gravity's part of it.
    pub(crate) gravity: Vec<f64>,
}

impl Sweep {
    /// Makes room for `count` states, all zero.
    pub(crate) fn reset(&mut self, joint_count: usize, count: usize) {
        self.joint_count = joint_count;
        self.stride = count.next_multiple_of(LANES_MAX);
        let entries = self.stride * joint_count;
        for column in [&mut self.position, &mut self.velocity, &mut self.acceleration] {
            column.clear();
            column.resize(entries, 0.0);
        }
        // these are written, not read
        for column in [&mut self.torque, &mut self.gravity] {
            column.resize(entries, 0.0);
        }
    }

    /// Sets one state from polynomials of time, one a joint.
    pub(crate) fn set(&mut self, state: usize, polynomials: &[Polynomial], time: f64) {
        for (joint, polynomial) in polynomials.iter().enumerate() {
            let entry = joint * self.stride + state;
            let at = evaluate(polynomial, time);
            self.position[entry] = at.position;
            self.velocity[entry] = at.velocity;
            self.acceleration[entry] = at.acceleration;
        }
    }

    /// Sets one state at rest.
    pub(crate) fn set_position(&mut self, state: usize, position: &[f64]) {
        for (joint, position) in position.iter().enumerate() {
            self.position[joint * self.stride + state] = *position;
        }
    }

    /// Where the column of a joint begins.
    pub(crate) fn column(&self, joint: usize) -> usize {
        joint * self.stride
    }

    /// Computes the torques of every state.
    pub(crate) fn compute(&mut self, chain: &Chain) {
        pulp::Arch::new().dispatch(Kernel { chain, sweep: self });
    }
}

struct Kernel<'a> {
    chain: &'a Chain,
    sweep: &'a mut Sweep,
}

impl WithSimd for Kernel<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        match self.chain.joints.len() {
            0..=8 => self.run::<S, 8>(simd),
            9..=16 => self.run::<S, 16>(simd),
            _ => self.run::<S, 32>(simd),
        }
    }
}

impl Kernel<'_> {
    #[inline(always)]
    fn run<S: Simd, const N: usize>(self, simd: S) {
        let Sweep {
            stride,
            joint_count,
            position,
            velocity,
            acceleration,
            torque,
            gravity,
        } = self.sweep;
        let (stride, count) = (*stride, *joint_count);
        let zero = Lanes::constant(simd, 0.0);
        let mut links = [LinkWrench::zero(zero); N];
        let (mut q, mut qd, mut qdd) = ([zero; N], [zero; N], [zero; N]);
        let (mut tau, mut tau_gravity) = ([zero; N], [zero; N]);
        for at in (0..stride).step_by(S::F64_LANES) {
            for joint in 0..count.min(N) {
                let entry = joint * stride + at;
                q[joint] = Lanes::load(simd, &position[entry..]);
                qd[joint] = Lanes::load(simd, &velocity[entry..]);
                qdd[joint] = Lanes::load(simd, &acceleration[entry..]);
            }
            rnea::<_, true>(self.chain, &q, &qd, &qdd, &mut links, &mut tau, &mut tau_gravity);
            for joint in 0..count.min(N) {
                let entry = joint * stride + at;
                tau[joint].store(&mut torque[entry..]);
                tau_gravity[joint].store(&mut gravity[entry..]);
            }
        }
    }
}
