//! The corrected direction: how multipliers change, and how far it goes.

use pulp::{Simd, WithSimd};

use super::super::rows::{Block, Rows};
use super::{PerRow, Place, Point, affine, largest, load, range, store, sweep};
use crate::scalar::{LANES_MAX, Lanes};

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
