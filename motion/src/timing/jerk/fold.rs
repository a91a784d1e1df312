//! Between unknowns and samples: (a, b, c) = E·x at every sample, and Eᵀ·g, Eᵀ·H·E summed over samples.

use pulp::{Simd, WithSimd};

use super::band::Band;
use super::basis::Form;
use super::pass::{Normal, Point, Second};
use crate::scalar::LANES_MAX;

/// One sample of a problem.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sample {
    pub(crate) form: Form,
    /// Its weight in ∫ ds/√a.
    pub(crate) weight: f64,
}

/// (a, b, c) of every sample.
pub(crate) struct Evaluate<'a> {
    pub(crate) samples: &'a [Sample],
    pub(crate) x: &'a [f64],
    pub(crate) points: &'a mut [Point],
}

impl WithSimd for Evaluate<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _simd: S) {
        for (k, sample) in self.samples.iter().enumerate() {
            let (block, lane) = (k / LANES_MAX, k % LANES_MAX);
            let values = sample.form.apply(self.x);
            let point = &mut self.points[block];
            point[0][lane] = values[0];
            point[1][lane] = values[1];
            point[2][lane] = values[2];
        }
    }
}

/// The normal equations: their matrix, and two right sides: −∇ of the duration, and the residual of the multipliers
/// −∇ of the duration + Σ l·∇z.
pub(crate) struct Fold<'a> {
    pub(crate) samples: &'a [Sample],
    pub(crate) points: &'a [Point],
    pub(crate) normals: &'a [Normal],
    pub(crate) band: &'a mut Band,
    pub(crate) descent: &'a mut [f64],
    pub(crate) residual: &'a mut [f64],
}

impl WithSimd for Fold<'_> {
    /// The duration by the trapezoidal rule.
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _simd: S) -> f64 {
        let mut duration = 0.0;
        for (k, sample) in self.samples.iter().enumerate() {
            let (block, lane) = (k / LANES_MAX, k % LANES_MAX);
            let inverse = 1.0 / self.points[block][0][lane];
            let part = sample.weight * inverse.sqrt();
            duration += part;
            let (pull, bend) = (0.5 * part * inverse, 0.75 * part * inverse * inverse);
            let normal = &self.normals[block];
            let h: [f64; 6] = [
                normal.hessian[0][lane] + bend,
                normal.hessian[1][lane],
                normal.hessian[2][lane],
                normal.hessian[3][lane],
                normal.hessian[4][lane],
                normal.hessian[5][lane],
            ];
            let g = [pull + normal.pull[0][lane], normal.pull[1][lane], normal.pull[2][lane]];
            let [ea, eb, ec] = &sample.form.rows;
            let base = sample.form.base;
            let descent = &mut self.descent[base..base + 4];
            let residual = &mut self.residual[base..base + 4];
            let band = &mut self.band.rows[base..base + 4];
            for r in 0..4 {
                descent[r] += pull * ea[r];
                residual[r] += g[0] * ea[r] + g[1] * eb[r] + g[2] * ec[r];
                let v = [
                    h[0] * ea[r] + h[1] * eb[r] + h[2] * ec[r],
                    h[1] * ea[r] + h[3] * eb[r] + h[4] * ec[r],
                    h[2] * ea[r] + h[4] * eb[r] + h[5] * ec[r],
                ];
                for m in 0..4 - r {
                    band[r][m] += v[0] * ea[r + m] + v[1] * eb[r + m] + v[2] * ec[r + m];
                }
            }
        }
        duration
    }
}

/// The corrector's right side: x ← x + Eᵀ·(center·Σ ∇z/z − damping·Σ ∇z·(δz·δl)/z).
pub(crate) struct Recenter<'a> {
    pub(crate) samples: &'a [Sample],
    pub(crate) seconds: &'a [Second],
    pub(crate) center: f64,
    pub(crate) damping: f64,
    pub(crate) x: &'a mut [f64],
}

impl WithSimd for Recenter<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _simd: S) {
        for (k, sample) in self.samples.iter().enumerate() {
            let (block, lane) = (k / LANES_MAX, k % LANES_MAX);
            let second = &self.seconds[block];
            let [ga, gb, gc] = &second.center;
            let [xa, xb, xc] = &second.cross;
            let g = [
                self.center * ga[lane] - self.damping * xa[lane],
                self.center * gb[lane] - self.damping * xb[lane],
                self.center * gc[lane] - self.damping * xc[lane],
            ];
            let base = sample.form.base;
            let x = &mut self.x[base..base + 4];
            let [ea, eb, ec] = &sample.form.rows;
            for r in 0..4 {
                x[r] += g[0] * ea[r] + g[1] * eb[r] + g[2] * ec[r];
            }
        }
    }
}
