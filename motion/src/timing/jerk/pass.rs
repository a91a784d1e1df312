//! The three sweeps of one interior-point iteration over all rows, eight samples at a time.
//!
//! A row has the slack z(a, b, c) ≥ 0 and the multiplier l ≥ 0; a pair of rows is z± = u ∓ v. Per sample:
//!
//! ```text
//! Assemble  l ← l + α_dual·δl, z, and the sums  H = Σ (l/z)·∇z·∇zᵀ + concave parts,  r = Σ l·∇z,  gap = Σ l·z
//! Predict   with ρ = ∇z·δ/z the affine step has δl/l = −1 − ρ:  the largest −ρ and 1 + ρ (1/step lengths),
//!           Σ ∇z/z  and  Σ ∇z·(δz·δl)/z  for the corrector
//! Correct   δl = (σμ − κ·(δz·δl)_aff)/z − l − (l/z)·∇z·δ, the largest −ρ and −δl/l
//! ```
//!
//! The curvature of convex slacks (jerk, costly friction) is left out of H: that is their tangent, a safe
//! side of the limit. Curvature of concave ones (helping friction, tool) is in H, which so stays positive semidefinite.
//! Sums over samples are taken in order by the caller: the lanes of the processor do not show in any bit.

mod assemble;
mod correct;
mod predict;
#[cfg(test)]
mod tests;

use pulp::Simd;

pub(crate) use assemble::{Assemble, Normal};
pub(crate) use correct::Correct;
pub(crate) use predict::{Predict, Second};

use super::rows::{Block, Group, Rows};
use crate::scalar::{LANES_MAX, Lanes};

/// One number a row: slacks' inverses, multipliers, or steps. Pairs are (+, −).
#[derive(Debug, Clone)]
pub(crate) struct PerRow {
    pub(crate) jerk: Vec<[Block; 2]>,
    pub(crate) acceleration: Vec<[Block; 2]>,
    pub(crate) torque: Vec<[Block; 2]>,
    pub(crate) tool: Vec<[Block; 1]>,
    pub(crate) speed: Vec<[Block; 1]>,
}

/// (a, b, c) or a step of them, at the samples of one block.
pub(crate) type Point = [Block; 3];

pub(crate) const ZERO: Block = [0.0; LANES_MAX];

impl PerRow {
    pub(crate) fn new(rows: &Rows) -> Self {
        Self {
            jerk: vec![[ZERO; 2]; rows.jerk.rows.len()],
            acceleration: vec![[ZERO; 2]; rows.acceleration.rows.len()],
            torque: vec![[ZERO; 2]; rows.torque.rows.len()],
            tool: vec![[ZERO; 1]; rows.tool.rows.len()],
            speed: vec![[ZERO; 1]; rows.speed.rows.len()],
        }
    }

    pub(crate) fn fill(&mut self, value: f64) {
        let block = [value; LANES_MAX];
        self.jerk.fill([block; 2]);
        self.acceleration.fill([block; 2]);
        self.torque.fill([block; 2]);
        self.tool.fill([block; 1]);
        self.speed.fill([block; 1]);
    }

    /// Every value at least `factor` times the other's.
    pub(crate) fn at_least(&mut self, other: &Self, factor: f64) {
        fn each<const C: usize>(to: &mut [[Block; C]], from: &[[Block; C]], factor: f64) {
            for (to, from) in to.as_flattened_mut().iter_mut().zip(from.as_flattened()) {
                for (to, from) in to.iter_mut().zip(from) {
                    *to = to.max(from * factor);
                }
            }
        }
        each(&mut self.jerk, &other.jerk, factor);
        each(&mut self.acceleration, &other.acceleration, factor);
        each(&mut self.torque, &other.torque, factor);
        each(&mut self.tool, &other.tool, factor);
        each(&mut self.speed, &other.speed, factor);
    }
}

#[inline(always)]
fn load<S: Simd, const C: usize>(simd: S, blocks: &[Block; C], at: usize) -> [Lanes<S>; C] {
    let mut lanes = [Lanes::constant(simd, 0.0); C];
    let mut k = 0;
    while k < C {
        lanes[k] = Lanes::load(simd, &blocks[k][at..]);
        k += 1;
    }
    lanes
}

#[inline(always)]
fn store<S: Simd, const C: usize>(lanes: [Lanes<S>; C], blocks: &mut [Block; C], at: usize) {
    let mut k = 0;
    while k < C {
        lanes[k].store(&mut blocks[k][at..]);
        k += 1;
    }
}

/// The largest of a register's lanes, over a pass.
#[inline(always)]
fn largest<S: Simd>(lanes: Lanes<S>) -> f64 {
    let mut values = [f64::NEG_INFINITY; LANES_MAX];
    lanes.store(&mut values);
    values.iter().copied().fold(f64::NEG_INFINITY, f64::max)
}

/// ∇v and du/da of a pair z± = u ∓ v.
#[derive(Clone, Copy)]
struct Slope<S: Simd> {
    v: [Lanes<S>; 3],
    u: Lanes<S>,
}

impl<S: Simd> Slope<S> {
    /// ∇z± · d.
    #[inline(always)]
    fn along(&self, d: [Lanes<S>; 3]) -> [Lanes<S>; 2] {
        let v = self.v[0] * d[0] + self.v[1] * d[1] + self.v[2] * d[2];
        let u = self.u * d[0];
        [u - v, u + v]
    }

    /// sum ← sum + ∇z₊·t₊ + ∇z₋·t₋.
    #[inline(always)]
    fn add(&self, t: [Lanes<S>; 2], sum: &mut [Lanes<S>; 3]) {
        let difference = t[1] - t[0];
        sum[0] = sum[0] + self.u * (t[0] + t[1]) + self.v[0] * difference;
        sum[1] = sum[1] + self.v[1] * difference;
        sum[2] = sum[2] + self.v[2] * difference;
    }
}

/// Rows at the lanes of one register.
struct Place<S: Simd> {
    simd: S,
    a: Lanes<S>,
    b: Lanes<S>,
    c: Lanes<S>,
    /// √a and 1/√a.
    root: Lanes<S>,
    inverse_root: Lanes<S>,
    scale: Lanes<S>,
    at: usize,
}

impl<S: Simd> Place<S> {
    #[inline(always)]
    fn new(simd: S, point: &Point, scale: &Block, at: usize) -> Self {
        let [a, b, c] = load(simd, point, at);
        let root = a.sqrt();
        Self {
            simd,
            a,
            b,
            c,
            root,
            inverse_root: Lanes::constant(simd, 1.0) / root,
            scale: Lanes::load(simd, &scale[at..]),
            at,
        }
    }

    /// Slacks and slopes of jerk rows, times the sample's factor.
    #[inline(always)]
    fn jerk(&self, row: &[Block; 3]) -> ([Lanes<S>; 2], Slope<S>) {
        let [q1, q2, q3] = load(self.simd, row, self.at);
        let v = [q3 * self.scale, q2 * self.scale, q1 * self.scale];
        let value = v[2] * self.c + v[1] * self.b + v[0] * self.a;
        let u = self.inverse_root * self.scale;
        let slope = u * self.inverse_root * self.inverse_root * -0.5;
        ([u - value, u + value], Slope { v, u: slope })
    }

    #[inline(always)]
    fn acceleration(&self, row: &[Block; 2]) -> ([Lanes<S>; 2], Slope<S>) {
        let [q1, q2] = load(self.simd, row, self.at);
        let value = q1 * self.b + q2 * self.a;
        let (one, zero) = (Lanes::constant(self.simd, 1.0), Lanes::constant(self.simd, 0.0));
        (
            [one - value, one + value],
            Slope {
                v: [q2, q1, zero],
                u: zero,
            },
        )
    }

    /// The last value is f_v/(4·a^(3/2)), the curvature of the upper slack.
    #[inline(always)]
    fn torque(&self, row: &[Block; 5]) -> ([Lanes<S>; 2], Slope<S>, Lanes<S>) {
        let [m, k, f, up, down] = load(self.simd, row, self.at);
        let value = m * self.b + k * self.a + f * self.root;
        let zero = Lanes::constant(self.simd, 0.0);
        let bend = f * self.inverse_root;
        let v = [k + bend * 0.5, m, zero];
        let curvature = bend * self.inverse_root * self.inverse_root * 0.25;
        ([up - value, down + value], Slope { v, u: zero }, curvature)
    }

    /// Slack and gradient of the speed row.
    #[inline(always)]
    fn speed(&self, row: &[Block; 1]) -> (Lanes<S>, [Lanes<S>; 2]) {
        let [inverse] = load(self.simd, row, self.at);
        let slack = Lanes::constant(self.simd, 1.0) - inverse * self.a;
        (slack, [inverse * -1.0, Lanes::constant(self.simd, 0.0)])
    }

    /// Slack and gradient of the tool row.
    #[inline(always)]
    fn tool(&self, row: &[Block; 3]) -> (Lanes<S>, [Lanes<S>; 2]) {
        let [bb, ab, aa] = load(self.simd, row, self.at);
        let by_b = bb * self.b + ab * self.a;
        let by_a = ab * self.b + aa * self.a;
        let slack = Lanes::constant(self.simd, 1.0) - (by_b * self.b + by_a * self.a);
        (slack, [by_a * -2.0, by_b * -2.0])
    }
}

/// Every register of every block.
macro_rules! sweep {
    ($pass:ident, $simd:ident, $register:ident) => {{
        let mut worst = [Lanes::constant($simd, f64::NEG_INFINITY); 2];
        for block in 0..$pass.rows.blocks {
            let mut at = 0;
            while at < LANES_MAX {
                $register($simd, &mut $pass, block, at, &mut worst);
                at += S::F64_LANES;
            }
        }
        [largest(worst[0]), largest(worst[1])]
    }};
}

#[inline(always)]
fn range<const C: usize>(group: &Group<C>, block: usize) -> std::ops::Range<usize> {
    block * group.count..(block + 1) * group.count
}

/// δz·δl of one row in the affine direction; δl = −l·(1 + δz/z).
#[inline(always)]
fn affine<S: Simd>(dz: Lanes<S>, inverse: Lanes<S>, l: Lanes<S>) -> (Lanes<S>, Lanes<S>) {
    let ratio = dz * inverse;
    let dl = (l + l * ratio) * -1.0;
    (ratio, dz * dl)
}

use sweep;
