//! The affine direction: how far it goes, and what it says of the second order.

use pulp::{Simd, WithSimd};

use super::super::rows::{Block, Rows};
use super::{PerRow, Place, Point, affine, largest, load, range, store, sweep};
use crate::scalar::{LANES_MAX, Lanes};

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
