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

use pulp::{Simd, WithSimd};

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

/// What [`Assemble`] leaves of one block.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Normal {
    /// Σ (l/z)·∇z·∇zᵀ and concave parts: aa, ab, ac, bb, bc, cc.
    pub(crate) hessian: [Block; 6],
    /// Σ l·∇z.
    pub(crate) pull: [Block; 3],
    /// Σ l·z.
    pub(crate) gap: Block,
}

/// What [`Predict`] leaves of one block.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Second {
    /// Σ ∇z/z.
    pub(crate) center: [Block; 3],
    /// Σ ∇z·(δz·δl)/z.
    pub(crate) cross: [Block; 3],
    /// Σ δz·δl.
    pub(crate) gap: Block,
}

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
}

impl PerRow {
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

/// Multipliers, slacks and sums at new points.
pub(crate) struct Assemble<'a> {
    pub(crate) rows: &'a Rows,
    pub(crate) points: &'a [Point],
    /// Factor of a sample's jerk slacks.
    pub(crate) scale: &'a [Block],
    pub(crate) multipliers: &'a PerRow,
    pub(crate) step: &'a PerRow,
    pub(crate) dual_step: f64,
    pub(crate) moved: &'a mut PerRow,
    pub(crate) inverse: &'a mut PerRow,
    pub(crate) normals: &'a mut [Normal],
}

/// The affine direction.
pub(crate) struct Predict<'a> {
    pub(crate) rows: &'a Rows,
    pub(crate) points: &'a [Point],
    pub(crate) scale: &'a [Block],
    pub(crate) directions: &'a [Point],
    pub(crate) multipliers: &'a PerRow,
    pub(crate) inverse: &'a PerRow,
    pub(crate) seconds: &'a mut [Second],
}

/// The corrected direction.
pub(crate) struct Correct<'a> {
    pub(crate) rows: &'a Rows,
    pub(crate) points: &'a [Point],
    pub(crate) scale: &'a [Block],
    pub(crate) affine: &'a [Point],
    pub(crate) directions: &'a [Point],
    pub(crate) multipliers: &'a PerRow,
    pub(crate) inverse: &'a PerRow,
    /// σμ.
    pub(crate) center: f64,
    /// κ.
    pub(crate) damping: f64,
    pub(crate) step: &'a mut PerRow,
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

/// Every register of every block, jerk rows alone beyond the full ones.
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

impl WithSimd for Assemble<'_> {
    /// The largest of −z: below 0 where every slack is positive.
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f64 {
        let mut pass = self;
        let [negative, _] = sweep!(pass, simd, assemble);
        negative
    }
}

struct Sums<S: Simd> {
    hessian: [Lanes<S>; 6],
    pull: [Lanes<S>; 3],
    gap: Lanes<S>,
    negative: Lanes<S>,
}

/// Moves a row's multiplier, and returns it with l/z.
#[inline(always)]
#[allow(
    clippy::too_many_arguments,
    reason = "one row of four columns; a struct of them would be built a row at a time"
)]
fn advance<S: Simd, const C: usize>(
    simd: S,
    slack: [Lanes<S>; C],
    [multiplier, step]: [&[Block; C]; 2],
    dual_step: f64,
    [moved, inverse]: [&mut [Block; C]; 2],
    at: usize,
    sums: &mut Sums<S>,
) -> ([Lanes<S>; C], [Lanes<S>; C]) {
    let mut l = load(simd, multiplier, at);
    let dl = load(simd, step, at);
    let mut inverses = l;
    let mut weights = l;
    let mut k = 0;
    while k < C {
        l[k] = l[k] + dl[k] * dual_step;
        inverses[k] = Lanes::constant(simd, 1.0) / slack[k];
        weights[k] = l[k] * inverses[k];
        sums.gap = sums.gap + l[k] * slack[k];
        sums.negative = sums.negative.max(slack[k] * -1.0);
        k += 1;
    }
    store(l, moved, at);
    store(inverses, inverse, at);
    (l, weights)
}

#[inline(always)]
fn assemble<S: Simd>(simd: S, pass: &mut Assemble<'_>, block: usize, at: usize, worst: &mut [Lanes<S>; 2]) {
    let zero = Lanes::constant(simd, 0.0);
    let rows = pass.rows;
    let place = Place::new(simd, &pass.points[block], &pass.scale[block], at);
    let mut sums = Sums {
        hessian: [zero; 6],
        pull: [zero; 3],
        gap: zero,
        negative: worst[0],
    };
    for row in range(&rows.jerk, block) {
        let (slack, slope) = place.jerk(&rows.jerk.rows[row]);
        let old = [&pass.multipliers.jerk[row], &pass.step.jerk[row]];
        let new = [&mut pass.moved.jerk[row], &mut pass.inverse.jerk[row]];
        let (l, w) = advance(simd, slack, old, pass.dual_step, new, at, &mut sums);
        slope.add(l, &mut sums.pull);
        let (sum, difference) = (w[0] + w[1], w[1] - w[0]);
        let [va, vb, vc] = slope.v;
        let cross = sum * va + difference * slope.u;
        let [aa, ab, ac, bb, bc, cc] = sums.hessian;
        let (sum_b, sum_c) = (sum * vb, sum * vc);
        sums.hessian = [
            aa + cross * va + (sum * slope.u + difference * va) * slope.u,
            ab + cross * vb,
            ac + cross * vc,
            bb + sum_b * vb,
            bc + sum_b * vc,
            cc + sum_c * vc,
        ];
    }
    if block < rows.full {
        assemble_full(pass, &place, block, &mut sums);
    }
    worst[0] = sums.negative;
    let normal = &mut pass.normals[block];
    store(sums.hessian, &mut normal.hessian, at);
    store(sums.pull, &mut normal.pull, at);
    sums.gap.store(&mut normal.gap[at..]);
}

/// Adds a pair without du/da and without c, or one row (`difference` its multiplier's weight, `v` its gradient).
#[inline(always)]
fn add_square<S: Simd>(hessian: &mut [Lanes<S>; 6], weight: Lanes<S>, va: Lanes<S>, vb: Lanes<S>) {
    let (wa, wb) = (weight * va, weight * vb);
    hessian[0] = hessian[0] + wa * va;
    hessian[1] = hessian[1] + wa * vb;
    hessian[3] = hessian[3] + wb * vb;
}

#[inline(always)]
fn assemble_full<S: Simd>(pass: &mut Assemble<'_>, place: &Place<S>, block: usize, sums: &mut Sums<S>) {
    let (rows, simd, at, step) = (pass.rows, place.simd, place.at, pass.dual_step);
    let zero = Lanes::constant(simd, 0.0);
    for row in range(&rows.acceleration, block) {
        let (slack, slope) = place.acceleration(&rows.acceleration.rows[row]);
        let old = [&pass.multipliers.acceleration[row], &pass.step.acceleration[row]];
        let new = [&mut pass.moved.acceleration[row], &mut pass.inverse.acceleration[row]];
        let (l, w) = advance(simd, slack, old, step, new, at, sums);
        slope.add(l, &mut sums.pull);
        add_square(&mut sums.hessian, w[0] + w[1], slope.v[0], slope.v[1]);
    }
    for row in range(&rows.torque, block) {
        let (slack, slope, curvature) = place.torque(&rows.torque.rows[row]);
        let old = [&pass.multipliers.torque[row], &pass.step.torque[row]];
        let new = [&mut pass.moved.torque[row], &mut pass.inverse.torque[row]];
        let (l, w) = advance(simd, slack, old, step, new, at, sums);
        slope.add(l, &mut sums.pull);
        add_square(&mut sums.hessian, w[0] + w[1], slope.v[0], slope.v[1]);
        let helping = l[0] * (zero - curvature).max(zero) + l[1] * curvature.max(zero);
        sums.hessian[0] = sums.hessian[0] + helping;
    }
    for row in range(&rows.tool, block) {
        let (slack, [va, vb]) = place.tool(&rows.tool.rows[row]);
        let old = [&pass.multipliers.tool[row], &pass.step.tool[row]];
        let new = [&mut pass.moved.tool[row], &mut pass.inverse.tool[row]];
        let ([l], [w]) = advance(simd, [slack], old, step, new, at, sums);
        sums.pull[0] = sums.pull[0] + l * va;
        sums.pull[1] = sums.pull[1] + l * vb;
        add_square(&mut sums.hessian, w, va, vb);
        let [bb, ab, aa] = load(simd, &rows.tool.rows[row], at);
        let twice = l * 2.0;
        sums.hessian[0] = sums.hessian[0] + twice * aa;
        sums.hessian[1] = sums.hessian[1] + twice * ab;
        sums.hessian[3] = sums.hessian[3] + twice * bb;
    }
    for row in range(&rows.speed, block) {
        let (slack, [va, vb]) = place.speed(&rows.speed.rows[row]);
        let old = [&pass.multipliers.speed[row], &pass.step.speed[row]];
        let new = [&mut pass.moved.speed[row], &mut pass.inverse.speed[row]];
        let ([l], [w]) = advance(simd, [slack], old, step, new, at, sums);
        sums.pull[0] = sums.pull[0] + l * va;
        add_square(&mut sums.hessian, w, va, vb);
    }
}

impl WithSimd for Predict<'_> {
    /// The largest of −δz/z and of −δl/l.
    type Output = [f64; 2];

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> [f64; 2] {
        let mut pass = self;
        sweep!(pass, simd, predict)
    }
}

struct Corrections<S: Simd> {
    center: [Lanes<S>; 3],
    cross: [Lanes<S>; 3],
    gap: Lanes<S>,
}

/// δz·δl of one row in the affine direction; δl = −l·(1 + δz/z).
#[inline(always)]
fn affine<S: Simd>(dz: Lanes<S>, inverse: Lanes<S>, l: Lanes<S>) -> (Lanes<S>, Lanes<S>) {
    let ratio = dz * inverse;
    let dl = (l + l * ratio) * -1.0;
    (ratio, dz * dl)
}

#[inline(always)]
fn predict_row<S: Simd, const C: usize>(
    simd: S,
    dz: [Lanes<S>; C],
    [multiplier, inverse]: [&[Block; C]; 2],
    at: usize,
    worst: &mut [Lanes<S>; 2],
    gap: &mut Lanes<S>,
) -> ([Lanes<S>; C], [Lanes<S>; C]) {
    let (l, inverse) = (load(simd, multiplier, at), load(simd, inverse, at));
    let mut cross = inverse;
    let mut k = 0;
    while k < C {
        let (ratio, product) = affine(dz[k], inverse[k], l[k]);
        worst[0] = worst[0].max(ratio * -1.0);
        worst[1] = worst[1].max(ratio);
        *gap = *gap + product;
        cross[k] = product * inverse[k];
        k += 1;
    }
    (inverse, cross)
}

#[inline(always)]
fn predict<S: Simd>(simd: S, pass: &mut Predict<'_>, block: usize, at: usize, worst: &mut [Lanes<S>; 2]) {
    let zero = Lanes::constant(simd, 0.0);
    let rows = pass.rows;
    let place = Place::new(simd, &pass.points[block], &pass.scale[block], at);
    let d = load(simd, &pass.directions[block], at);
    let mut sums = Corrections {
        center: [zero; 3],
        cross: [zero; 3],
        gap: zero,
    };
    for row in range(&rows.jerk, block) {
        let (_, slope) = place.jerk(&rows.jerk.rows[row]);
        let columns = [&pass.multipliers.jerk[row], &pass.inverse.jerk[row]];
        let (inverse, cross) = predict_row(simd, slope.along(d), columns, at, worst, &mut sums.gap);
        slope.add(inverse, &mut sums.center);
        slope.add(cross, &mut sums.cross);
    }
    if block < rows.full {
        for row in range(&rows.acceleration, block) {
            let (_, slope) = place.acceleration(&rows.acceleration.rows[row]);
            let columns = [&pass.multipliers.acceleration[row], &pass.inverse.acceleration[row]];
            let (inverse, cross) = predict_row(simd, slope.along(d), columns, at, worst, &mut sums.gap);
            slope.add(inverse, &mut sums.center);
            slope.add(cross, &mut sums.cross);
        }
        for row in range(&rows.torque, block) {
            let (_, slope, _) = place.torque(&rows.torque.rows[row]);
            let columns = [&pass.multipliers.torque[row], &pass.inverse.torque[row]];
            let (inverse, cross) = predict_row(simd, slope.along(d), columns, at, worst, &mut sums.gap);
            slope.add(inverse, &mut sums.center);
            slope.add(cross, &mut sums.cross);
        }
        for row in range(&rows.tool, block) {
            let (_, gradient) = place.tool(&rows.tool.rows[row]);
            let columns = [&pass.multipliers.tool[row], &pass.inverse.tool[row]];
            predict_single(simd, gradient, d, columns, at, worst, &mut sums);
        }
        for row in range(&rows.speed, block) {
            let (_, gradient) = place.speed(&rows.speed.rows[row]);
            let columns = [&pass.multipliers.speed[row], &pass.inverse.speed[row]];
            predict_single(simd, gradient, d, columns, at, worst, &mut sums);
        }
    }
    let second = &mut pass.seconds[block];
    store(sums.center, &mut second.center, at);
    store(sums.cross, &mut second.cross, at);
    sums.gap.store(&mut second.gap[at..]);
}

#[inline(always)]
fn predict_single<S: Simd>(
    simd: S,
    [va, vb]: [Lanes<S>; 2],
    d: [Lanes<S>; 3],
    columns: [&[Block; 1]; 2],
    at: usize,
    worst: &mut [Lanes<S>; 2],
    sums: &mut Corrections<S>,
) {
    let ([inverse], [cross]) = predict_row(simd, [va * d[0] + vb * d[1]], columns, at, worst, &mut sums.gap);
    for (sum, t) in [(&mut sums.center, inverse), (&mut sums.cross, cross)] {
        sum[0] = sum[0] + va * t;
        sum[1] = sum[1] + vb * t;
    }
}

impl WithSimd for Correct<'_> {
    /// The largest of −δz/z and of −δl/l.
    type Output = [f64; 2];

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> [f64; 2] {
        let mut pass = self;
        sweep!(pass, simd, correct)
    }
}

#[inline(always)]
#[allow(
    clippy::too_many_arguments,
    reason = "one row of three columns; a struct of them would be built a row at a time"
)]
fn correct_row<S: Simd, const C: usize>(
    simd: S,
    [affine_dz, dz]: [[Lanes<S>; C]; 2],
    [multiplier, inverse]: [&[Block; C]; 2],
    [center, damping]: [f64; 2],
    step: &mut [Block; C],
    at: usize,
    worst: &mut [Lanes<S>; 2],
) {
    let (l, inverse) = (load(simd, multiplier, at), load(simd, inverse, at));
    let mut dl = l;
    let mut k = 0;
    while k < C {
        let (_, product) = affine(affine_dz[k], inverse[k], l[k]);
        let ratio = dz[k] * inverse[k];
        dl[k] = (product * -damping + center) * inverse[k] - l[k] - l[k] * ratio;
        worst[0] = worst[0].max(ratio * -1.0);
        worst[1] = worst[1].max(dl[k] * -1.0 / l[k]);
        k += 1;
    }
    store(dl, step, at);
}

#[inline(always)]
fn correct<S: Simd>(simd: S, pass: &mut Correct<'_>, block: usize, at: usize, worst: &mut [Lanes<S>; 2]) {
    let rows = pass.rows;
    let place = Place::new(simd, &pass.points[block], &pass.scale[block], at);
    let d = [
        load(simd, &pass.affine[block], at),
        load(simd, &pass.directions[block], at),
    ];
    let mix = [pass.center, pass.damping];
    let (l, inverse, step) = (pass.multipliers, pass.inverse, &mut *pass.step);
    for row in range(&rows.jerk, block) {
        let (_, slope) = place.jerk(&rows.jerk.rows[row]);
        let dz = [slope.along(d[0]), slope.along(d[1])];
        correct_row(
            simd,
            dz,
            [&l.jerk[row], &inverse.jerk[row]],
            mix,
            &mut step.jerk[row],
            at,
            worst,
        );
    }
    if block >= rows.full {
        return;
    }
    for row in range(&rows.acceleration, block) {
        let (_, slope) = place.acceleration(&rows.acceleration.rows[row]);
        let dz = [slope.along(d[0]), slope.along(d[1])];
        let columns = [&l.acceleration[row], &inverse.acceleration[row]];
        correct_row(simd, dz, columns, mix, &mut step.acceleration[row], at, worst);
    }
    for row in range(&rows.torque, block) {
        let (_, slope, _) = place.torque(&rows.torque.rows[row]);
        let dz = [slope.along(d[0]), slope.along(d[1])];
        let columns = [&l.torque[row], &inverse.torque[row]];
        correct_row(simd, dz, columns, mix, &mut step.torque[row], at, worst);
    }
    for row in range(&rows.tool, block) {
        let (_, [va, vb]) = place.tool(&rows.tool.rows[row]);
        let dz = [[va * d[0][0] + vb * d[0][1]], [va * d[1][0] + vb * d[1][1]]];
        correct_row(
            simd,
            dz,
            [&l.tool[row], &inverse.tool[row]],
            mix,
            &mut step.tool[row],
            at,
            worst,
        );
    }
    for row in range(&rows.speed, block) {
        let (_, [va, _]) = place.speed(&rows.speed.rows[row]);
        let dz = [[va * d[0][0]], [va * d[1][0]]];
        correct_row(
            simd,
            dz,
            [&l.speed[row], &inverse.speed[row]],
            mix,
            &mut step.speed[row],
            at,
            worst,
        );
    }
}
