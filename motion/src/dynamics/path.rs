//! Dynamics along a straight joint path q(s) = q₀ + s·D: the planner's way from a time law to torques.
//!
//! The rigid-body torque is m(s)·s̈ + k(s)·ṡ² + g(s), with m = M(q)·D, k = C(q, D)·D and g the gravity torque. One
//! outward and inward pass computes the three side by side, sharing rotations (Bobrow, Dubowsky and Gibson 1985 for the
//! form). The verifier does not use it: it goes through velocities and accelerations in time.

use pulp::{Simd, WithSimd};

use super::chain::Chain;
use super::rnea::{Omega, Turn, add, cross, cross_constant};
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
    turn: Option<Turn<R>>,
    mass: [[R; 3]; 2],
    velocity: [[R; 3]; 2],
    gravity: [[R; 3]; 2],
}

impl PathSweep<'_> {
    #[inline(always)]
    fn run<S: Simd, const N: usize>(self, simd: S) {
        let zero = Lanes::constant(simd, 0.0);
        let empty = Wrenches {
            turn: None,
            mass: [[zero; 3]; 2],
            velocity: [[zero; 3]; 2],
            gravity: [[zero; 3]; 2],
        };
        let mut links = [empty; N];
        let stride = self.terms.stride;
        for at in (0..stride).step_by(S::F64_LANES) {
            let s = Lanes::load(simd, &self.positions[at..]);
            outward(self.chain, self.start, self.direction, s, &mut links);
            inward(self.chain, &mut links, zero, |joint, mass, velocity, gravity| {
                let entry = joint * stride + at;
                mass.store(&mut self.terms.mass[entry..]);
                velocity.store(&mut self.terms.velocity[entry..]);
                gravity.store(&mut self.terms.gravity[entry..]);
            });
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
        let push = |a: [R; 3]| [a[0] * body.mass, a[1] * body.mass, a[2] * body.mass];
        link.turn = Some(turn);
        link.velocity = [
            add(push(a), omega.times_constant(body.first)),
            add(cross_constant(body.first, a), omega.moment(body.second)),
        ];
        let h = body.first;
        let swing = [
            wd_mass[1] * h[2] - wd_mass[2] * h[1],
            wd_mass[2] * h[0] - wd_mass[0] * h[2],
            wd_mass[0] * h[1] - wd_mass[1] * h[0],
        ];
        link.mass = [
            add(push(a_mass), swing),
            add(cross_constant(h, a_mass), spin_moment(body.second, wd_mass)),
        ];
        link.gravity = [push(up), cross_constant(h, up)];
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

#[inline(always)]
fn inward<R: Real>(chain: &Chain, links: &mut [Wrenches<R>], zero: R, mut put: impl FnMut(usize, R, R, R)) {
    let none = [[zero; 3]; 2];
    let (mut mass, mut velocity, mut gravity) = (none, none, none);
    for (i, (joint, link)) in chain.joints.iter().zip(links).enumerate().rev() {
        let Some(turn) = link.turn else { return };
        let sum = |a: [[R; 3]; 2], b: [[R; 3]; 2]| [add(a[0], b[0]), add(a[1], b[1])];
        mass = sum(mass, link.mass);
        velocity = sum(velocity, link.velocity);
        gravity = sum(gravity, link.gravity);
        let part = usize::from(!joint.prismatic);
        put(i, mass[part][2], velocity[part][2], gravity[part][2]);
        let origin = turn.origin(joint);
        let to_parent = |wrench: [[R; 3]; 2]| {
            let force = turn.into_parent(joint, wrench[0]);
            let moment = turn.into_parent(joint, wrench[1]);
            [force, add(moment, cross(origin, force))]
        };
        mass = to_parent(mass);
        velocity = to_parent(velocity);
        gravity = to_parent(gravity);
    }
}
