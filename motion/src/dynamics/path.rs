//! Dynamics along a path q(s): the planner's way from a time law to torques.
//!
//! With q̇ = q′·ṡ and q̈ = q′·s̈ + q″·ṡ² the rigid-body torque is m(s)·s̈ + k(s)·ṡ² + g(s), with m = M(q)·q′,
//! k = M(q)·q″ + C(q, q′)·q′ and g the gravity torque; the tool's velocity is p′·ṡ, its acceleration p′·s̈ + p″·ṡ². One
//! outward and inward pass computes all of them side by side, sharing rotations (Bobrow, Dubowsky and Gibson 1985 for the
//! form). The verifier does not use it: it goes through velocities and accelerations in time.

use std::ops::Range;

use pulp::{Simd, WithSimd};

use super::chain::{Body, Chain};
use super::rnea::{Omega, Turn, add, along_axis, cross, cross_constant};
use crate::curve::CurvePoint;
use crate::scalar::{LANES_MAX, Lanes, Real};

/// The terms of every joint at samples of a path, joint by joint: entry `joint * stride + sample`. Positions and
/// derivatives are set first, then [`PathTerms::compute`] fills the rest.
#[derive(Debug, Default)]
pub(crate) struct PathTerms {
    pub(crate) stride: usize,
    joint_count: usize,
    /// q.
    pub(crate) position: Vec<f64>,
    /// q′.
    pub(crate) first: Vec<f64>,
    /// q″.
    pub(crate) second: Vec<f64>,
    /// m: torque per unit of path acceleration.
    pub(crate) mass: Vec<f64>,
    /// k: torque per unit of squared path velocity.
    pub(crate) velocity: Vec<f64>,
    /// g: torque of gravity.
    pub(crate) gravity: Vec<f64>,
    /// p′ of the tool, x y z by `stride`, in axes that turn with the last link: lengths and angles are what counts.
    pub(crate) tool_first: Vec<f64>,
    /// p″ of the tool, in the same axes.
    pub(crate) tool_second: Vec<f64>,
}

impl PathTerms {
    /// Makes room for `count` samples of a chain. What is beyond them up to the stride is at position 0 and stands still.
    pub(crate) fn reset(&mut self, joint_count: usize, count: usize) {
        self.joint_count = joint_count;
        self.stride = count.next_multiple_of(LANES_MAX);
        let entries = self.stride * joint_count;
        for column in [&mut self.position, &mut self.first, &mut self.second] {
            column.clear();
            column.resize(entries, 0.0);
        }
        // these are written, not read
        for column in [&mut self.mass, &mut self.velocity, &mut self.gravity] {
            column.resize(entries, 0.0);
        }
        for column in [&mut self.tool_first, &mut self.tool_second] {
            column.resize(3 * self.stride, 0.0);
        }
    }

    /// Samples of the straight path q₀ + s·D at path positions `s`.
    pub(crate) fn set_line(&mut self, start: &[f64], direction: &[f64], s: &[f64]) {
        self.reset(start.len(), s.len());
        for (joint, (start, direction)) in start.iter().zip(direction).enumerate() {
            let column = joint * self.stride;
            for (sample, s) in s.iter().enumerate() {
                self.position[column + sample] = s * direction + start;
                self.first[column + sample] = *direction;
            }
        }
    }

    /// Sets one sample.
    pub(crate) fn set(&mut self, sample: usize, point: &CurvePoint) {
        for joint in 0..self.joint_count {
            let entry = joint * self.stride + sample;
            self.position[entry] = point.position[joint];
            self.first[entry] = point.first[joint];
            self.second[entry] = point.second[joint];
        }
    }

    /// Computes the terms of every sample; those of a tool at a point of the last link's kernel frame, if there is one.
    pub(crate) fn compute(&mut self, chain: &Chain, tool: Option<[f64; 3]>) {
        self.compute_some(chain, tool, 0..self.stride);
    }

    /// Computes the terms of samples from a multiple of [`LANES_MAX`] to another.
    pub(crate) fn compute_some(&mut self, chain: &Chain, tool: Option<[f64; 3]>, samples: Range<usize>) {
        let tool_or_origin = tool.unwrap_or_default();
        if tool.is_some() {
            return pulp::Arch::new().dispatch(PathSweep::<true> {
                chain,
                tool: tool_or_origin,
                samples,
                terms: self,
            });
        }
        pulp::Arch::new().dispatch(PathSweep::<false> {
            chain,
            tool: tool_or_origin,
            samples,
            terms: self,
        });
    }
}

struct PathSweep<'a, const TOOL: bool> {
    chain: &'a Chain,
    tool: [f64; 3],
    samples: Range<usize>,
    terms: &'a mut PathTerms,
}

impl<const TOOL: bool> WithSimd for PathSweep<'_, TOOL> {
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

impl<const TOOL: bool> PathSweep<'_, TOOL> {
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
        let (mut q, mut q1, mut q2) = ([zero; N], [zero; N], [zero; N]);
        let stride = self.terms.stride;
        let count = self.chain.joints.len();
        for at in self.samples.step_by(S::F64_LANES) {
            for joint in 0..count.min(N) {
                let entry = joint * stride + at;
                q[joint] = Lanes::load(simd, &self.terms.position[entry..]);
                q1[joint] = Lanes::load(simd, &self.terms.first[entry..]);
                q2[joint] = Lanes::load(simd, &self.terms.second[entry..]);
            }
            let last = outward(self.chain, &q, &q1, &q2, &mut links);
            inward(self.chain, &links, zero, &mut torques);
            for (joint, torque) in torques.iter().enumerate().take(count) {
                let entry = joint * stride + at;
                torque[0].store(&mut self.terms.mass[entry..]);
                torque[1].store(&mut self.terms.velocity[entry..]);
                torque[2].store(&mut self.terms.gravity[entry..]);
            }
            if TOOL {
                let [first, second] = last.of_point(self.tool);
                for axis in 0..3 {
                    first[axis].store(&mut self.terms.tool_first[axis * stride + at..]);
                    second[axis].store(&mut self.terms.tool_second[axis * stride + at..]);
                }
            }
        }
    }
}

/// How the last link moves, seen from itself: for unit path acceleration, and for unit path velocity.
struct LastLink<R> {
    a_mass: [R; 3],
    wd_mass: [R; 3],
    a: [R; 3],
    omega: Omega<R>,
}

impl<R: Real> LastLink<R> {
    /// p′ and p″ of a point fixed to the link. A velocity is to q̇ what an acceleration from rest is to q̈, so p′ is the
    /// acceleration for unit path acceleration.
    #[inline(always)]
    fn of_point(&self, r: [f64; 3]) -> [[R; 3]; 2] {
        let w = self.wd_mass;
        let swing = [
            w[1] * r[2] - w[2] * r[1],
            w[2] * r[0] - w[0] * r[2],
            w[0] * r[1] - w[1] * r[0],
        ];
        [add(self.a_mass, swing), add(self.a, self.omega.times_constant(r))]
    }
}

#[inline(always)]
fn outward<R: Real>(chain: &Chain, q: &[R], q1: &[R], q2: &[R], links: &mut [Wrenches<R>]) -> LastLink<R> {
    let zero = q[0].splat(0.0);
    let rest = [zero; 3];
    // rates for unit path velocity: w, and wd without path acceleration; for unit path acceleration alone: wd_mass
    let (mut w, mut wd, mut wd_mass) = (rest, rest, rest);
    let (mut a, mut a_mass) = (rest, rest);
    let mut up = [
        zero.splat(-chain.gravity[0]),
        zero.splat(-chain.gravity[1]),
        zero.splat(-chain.gravity[2]),
    ];
    let mut omega = Omega::new(w, wd);
    let points = q.iter().zip(q1).zip(q2);
    for ((joint, link), ((&q, &q1), &q2)) in chain.joints.iter().zip(links).zip(points) {
        let turn = Turn::new(joint, q);
        let origin = turn.origin(joint);
        a = turn.into_link(joint, add(a, omega.times(origin)));
        a_mass = turn.into_link(joint, add(a_mass, cross(wd_mass, origin)));
        up = turn.into_link(joint, up);
        w = turn.into_link(joint, w);
        wd = turn.into_link(joint, wd);
        wd_mass = turn.into_link(joint, wd_mass);
        if joint.prismatic {
            let twice = q1 + q1;
            a = [a[0] + w[1] * twice, a[1] - w[0] * twice, a[2] + q2];
            a_mass[2] = a_mass[2] + q1;
        } else {
            wd = [wd[0] + w[1] * q1, wd[1] - w[0] * q1, wd[2] + q2];
            w[2] = w[2] + q1;
            wd_mass[2] = wd_mass[2] + q1;
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
    LastLink {
        a_mass,
        wd_mass,
        a,
        omega,
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
