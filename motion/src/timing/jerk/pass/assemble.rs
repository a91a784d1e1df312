//! Multipliers, slacks, and the sums of the normal equations at new points.

use pulp::{Simd, WithSimd};

use super::super::rows::{Block, Rows};
use super::{PerRow, Place, Point, largest, load, range, store, sweep};
use crate::scalar::{LANES_MAX, Lanes};

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
    assemble_linear(pass, &place, block, &mut sums);
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
fn assemble_linear<S: Simd>(pass: &mut Assemble<'_>, place: &Place<S>, block: usize, sums: &mut Sums<S>) {
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
