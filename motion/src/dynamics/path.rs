//! Dynamics along a straight joint path q(s) = q₀ + s·D: the planner's way from a time law to torques.
//!
//! The rigid-body torque is m(s)·s̈ + k(s)·ṡ² + g(s), with m = M(q)·D, k = C(q, D)·D and g the gravity torque. One
//! outward and inward pass computes the three side by side, sharing rotations (Bobrow, Dubowsky and Gibson 1985 for the
//! form). The verifier does not use it: it goes through velocities and accelerations in time.

use pulp::{Simd, WithSimd};

use super::chain::{Body, Chain};
use super::rnea::{Omega, Turn, add, along_axis, cross, cross_constant};
use crate::scalar::{LANES_MAX, Lanes, Real};

/// The three terms of every joint at samples of a straight path, joint by joint: entry `joint * stride + sample`.
#[derive(Debug, Default)]
pub(crate) struct PathTerms {
    pub(crate) stride: usize,
    /// Torque per unit of path acceleration.
    pub(crate) mass: Vec<f64>,
    /// Torque per unit of squared path velocity.
    pub(crate) velocity: Vec<f64>,
    /// Torque of gravity.
    pub(crate) gravity: Vec<f64>,
}

impl PathTerms {
    /// Computes the terms at path positions `s`.
    pub(crate) fn compute(&mut self, chain: &Chain, start: &[f64], direction: &[f64], s: &[f64]) {
        let stride = s.len().next_multiple_of(LANES_MAX);
        let mut positions = s.to_vec();
        positions.resize(stride, s.last().copied().unwrap_or(0.0));
        self.stride = stride;
        let entries = stride * chain.joints.len();
        for column in [&mut self.mass, &mut self.velocity, &mut self.gravity] {
            column.clear();
            column.resize(entries, 0.0);
        }
        let sweep = PathSweep {
            chain,
            start,
            direction,
            positions: &positions,
            terms: self,
        };
        pulp::Arch::new().dispatch(sweep);
    }
}

struct PathSweep<'a> {
    chain: &'a Chain,
    start: &'a [f64],
    direction: &'a [f64],
    positions: &'a [f64],
    terms: &'a mut PathTerms,
}

impl WithSimd for PathSweep<'_> {
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

/// Force and moment on a link for each of the three terms.
#[derive(Clone, Copy)]
struct Wrenches<R> {
    turn: Turn<R>,
    mass: [[R; 3]; 2],
    velocity: [[R; 3]; 2],
    gravity: [[R; 3]; 2],
}

impl PathSweep<'_> {
    #[inline(always)]
    fn run<S: Simd, const N: usize>(self, simd: S) {
        let zero = Lanes::constant(simd, 0.0);
        let empty = Wrenches {
            turn: Turn::zero(zero),
            mass: [[zero; 3]; 2],
            velocity: [[zero; 3]; 2],
            gravity: [[zero; 3]; 2],
        };
        let mut links = [empty; N];
        let mut torques = [[zero; 3]; N];
        let stride = self.terms.stride;
        for at in (0..stride).step_by(S::F64_LANES) {
            let s = Lanes::load(simd, &self.positions[at..]);
            outward(self.chain, self.start, self.direction, s, &mut links);
            inward(self.chain, &links, zero, &mut torques);
            for (joint, torque) in torques.iter().enumerate().take(self.chain.joints.len()) {
                let entry = joint * stride + at;
                torque[0].store(&mut self.terms.mass[entry..]);
                torque[1].store(&mut self.terms.velocity[entry..]);
                torque[2].store(&mut self.terms.gravity[entry..]);
            }
        }
    }
}

#[inline(always)]
fn outward<R: Real>(chain: &Chain, start: &[f64], direction: &[f64], s: R, links: &mut [Wrenches<R>]) {
    let zero = s.splat(0.0);
    let rest = [zero; 3];
    // rates for unit path velocity: w, and wd without path acceleration; for unit path acceleration alone: wd_mass
    let (mut w, mut wd, mut wd_mass) = (rest, rest, rest);
    let (mut a, mut a_mass) = (rest, rest);
    let mut up = [
        s.splat(-chain.gravity[0]),
        s.splat(-chain.gravity[1]),
        s.splat(-chain.gravity[2]),
    ];
    let mut omega = Omega::new(w, wd);
    let line = start.iter().zip(direction);
    for ((joint, link), (&start, &d)) in chain.joints.iter().zip(links).zip(line) {
        let turn = Turn::new(joint, s * d + start);
        let origin = turn.origin(joint);
        a = turn.into_link(joint, add(a, omega.times(origin)));
        a_mass = turn.into_link(joint, add(a_mass, cross(wd_mass, origin)));
        up = turn.into_link(joint, up);
        w = turn.into_link(joint, w);
        wd = turn.into_link(joint, wd);
        wd_mass = turn.into_link(joint, wd_mass);
        if joint.prismatic {
            a = [a[0] + w[1] * (2.0 * d), a[1] + w[0] * (-2.0 * d), a[2]];
            a_mass[2] = a_mass[2] + d;
        } else {
            wd = [wd[0] + w[1] * d, wd[1] + w[0] * -d, wd[2]];
            w[2] = w[2] + d;
            wd_mass[2] = wd_mass[2] + d;
        }
        omega = Omega::new(w, wd);
        let body = &joint.body;
        link.turn = turn;
        link.velocity = [
            add(push(body, a), omega.times_constant(body.first)),
            add(cross_constant(body.first, a), omega.moment(body.second)),
        ];
        let h = body.first;
        let swing = [
            wd_mass[1] * h[2] - wd_mass[2] * h[1],
            wd_mass[2] * h[0] - wd_mass[0] * h[2],
            wd_mass[0] * h[1] - wd_mass[1] * h[0],
        ];
        link.mass = [
            add(push(body, a_mass), swing),
            add(cross_constant(h, a_mass), spin_moment(body.second, wd_mass)),
        ];
        link.gravity = [push(body, up), cross_constant(h, up)];
    }
}

/// ∫ r × (ω̇ × r) dm = I ω̇ from the second moments xx yy zz xy xz yz.
#[inline(always)]
fn spin_moment<R: Real>(s: [f64; 6], wd: [R; 3]) -> [R; 3] {
    [
        wd[0] * (s[1] + s[2]) - wd[1] * s[3] - wd[2] * s[4],
        wd[1] * (s[0] + s[2]) - wd[0] * s[3] - wd[2] * s[5],
        wd[2] * (s[0] + s[1]) - wd[0] * s[4] - wd[1] * s[5],
    ]
}

/// Mass times acceleration.
#[inline(always)]
fn push<R: Real>(body: &Body, a: [R; 3]) -> [R; 3] {
    [a[0] * body.mass, a[1] * body.mass, a[2] * body.mass]
}

#[inline(always)]
fn inward<R: Real>(chain: &Chain, links: &[Wrenches<R>], zero: R, torques: &mut [[R; 3]]) {
    let none = [[zero; 3]; 2];
    let (mut mass, mut velocity, mut gravity) = (none, none, none);
    for ((joint, link), torque) in chain.joints.iter().zip(links).zip(torques).rev() {
        mass = sum(mass, link.mass);
        velocity = sum(velocity, link.velocity);
        gravity = sum(gravity, link.gravity);
        *torque = [
            along_axis(joint, mass[0], mass[1]),
            along_axis(joint, velocity[0], velocity[1]),
            along_axis(joint, gravity[0], gravity[1]),
        ];
        mass = link.turn.wrench_into_parent(joint, mass[0], mass[1]).into();
        velocity = link.turn.wrench_into_parent(joint, velocity[0], velocity[1]).into();
        gravity = link.turn.wrench_into_parent(joint, gravity[0], gravity[1]).into();
    }
}

#[inline(always)]
fn sum<R: Real>(a: [[R; 3]; 2], b: [[R; 3]; 2]) -> [[R; 3]; 2] {
    [add(a[0], b[0]), add(a[1], b[1])]
}
