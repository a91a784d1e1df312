//! The numbers that the dynamics kernels compute with: one `f64`, or as many side by side as the processor has lanes.
//!
//! A kernel is written once, over [`Real`]. Every operation is a single IEEE 754 one (no fused multiply-add), so a
//! lane has the same bits as the scalar, on every processor: the same request has the same plan on every replica.

use std::ops::{Add, Div, Mul, Sub};

use pulp::Simd;

/// The most lanes that any processor has; sample columns are padded to a multiple of it.
pub(crate) const LANES_MAX: usize = 8;

/// A number, or several side by side.
pub(crate) trait Real:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Add<f64, Output = Self> + Mul<f64, Output = Self>
{
    /// The same constant in every lane.
    fn splat(self, constant: f64) -> Self;

    /// Picks `yes` in the lanes where `self < bound`, `no` in the others.
    fn select_below(self, bound: f64, yes: Self, no: Self) -> Self;

    /// Sine and cosine of an angle of magnitude up to a million, to about one unit in the last place. (n·π/2 stays exact up to n = 2²⁰.)
    ///
    /// Reduction to [−π/4, π/4] by subtracting n·π/2 in three exact parts (Cody and Waite 1980), then Taylor series:
    /// at π/4 the first term left out is below 2⁻⁶⁰.
    #[inline(always)]
    fn sine_cosine(self) -> (Self, Self) {
        let n = self * FRAC_2_PI + ROUND + -ROUND;
        let r = self - n * HALF_PI_HIGH - n * HALF_PI_MIDDLE - n * HALF_PI_LOW;
        let z = r * r;
        let z2 = z * z;
        let z4 = z2 * z2;
        let sine = {
            let low = (z * SIN[1] + SIN[0]) + (z * SIN[3] + SIN[2]) * z2;
            let high = (z * SIN[5] + SIN[4]) + (z * SIN[7] + SIN[6]) * z2;
            r + r * z * (low + high * z4)
        };
        let cosine = {
            let low = (z * COS[1] + COS[0]) + (z * COS[3] + COS[2]) * z2;
            let high = (z * COS[5] + COS[4]) + z2 * COS[6];
            let half = z * 0.5;
            let main = self.splat(1.0) - half;
            main + ((self.splat(1.0) - main - half) + z2 * (low + high * z4))
        };
        // The quadrant, −2 to 2: −2 and 2 are the same one.
        let quadrant = n - (n * 0.25 + ROUND + -ROUND) * 4.0;
        let square = quadrant * quadrant;
        let zero = self.splat(0.0);
        let sin_magnitude = square.select_below(0.5, sine, square.select_below(1.5, cosine, sine));
        let cos_magnitude = square.select_below(0.5, cosine, square.select_below(1.5, sine, cosine));
        // sine is negative in quadrants −1 and ±2, cosine in 1 and ±2
        let sin = square.select_below(
            3.0,
            quadrant.select_below(-0.5, zero - sin_magnitude, sin_magnitude),
            zero - sin_magnitude,
        );
        let cos = square.select_below(
            3.0,
            quadrant.select_below(0.5, cos_magnitude, zero - cos_magnitude),
            zero - cos_magnitude,
        );
        (sin, cos)
    }
}

/// 2/π.
const FRAC_2_PI: f64 = std::f64::consts::FRAC_2_PI;
/// Adding and subtracting 1.5·2⁵² rounds to the nearest whole number.
const ROUND: f64 = 6_755_399_441_055_744.0;
/// The first 33 bits of π/2.
const HALF_PI_HIGH: f64 = 1.570_796_326_734_125_6;
/// The next 33 bits of π/2.
const HALF_PI_MIDDLE: f64 = 6.077_100_506_303_966e-11;
/// The rest of π/2.
const HALF_PI_LOW: f64 = 2.022_266_248_795_950_6e-21;

/// Coefficients of r³, r⁵ … r¹⁷ of the sine: (−1)ᵏ/(2k+1)!.
const SIN: [f64; 8] = [
    -1.0 / 6.0,
    1.0 / 120.0,
    -1.0 / 5_040.0,
    1.0 / 362_880.0,
    -1.0 / 39_916_800.0,
    1.0 / 6_227_020_800.0,
    -1.0 / 1_307_674_368_000.0,
    1.0 / 355_687_428_096_000.0,
];

/// Coefficients of r⁴, r⁶ … r¹⁶ of the cosine: (−1)ᵏ/(2k)!.
const COS: [f64; 7] = [
    1.0 / 24.0,
    -1.0 / 720.0,
    1.0 / 40_320.0,
    -1.0 / 3_628_800.0,
    1.0 / 479_001_600.0,
    -1.0 / 87_178_291_200.0,
    1.0 / 20_922_789_888_000.0,
];

impl Real for f64 {
    #[inline(always)]
    fn splat(self, constant: f64) -> Self {
        constant
    }

    #[inline(always)]
    fn select_below(self, bound: f64, yes: Self, no: Self) -> Self {
        if self < bound { yes } else { no }
    }
}

/// As many numbers side by side as `S` has lanes.
#[derive(Clone, Copy)]
pub(crate) struct Lanes<S: Simd> {
    simd: S,
    values: S::f64s,
}

impl<S: Simd> Lanes<S> {
    /// Reads the lanes that start at `values[0]`. (A whole register at once: pulp's partial loads are calls.)
    #[inline(always)]
    pub(crate) fn load(simd: S, values: &[f64]) -> Self {
        let (registers, _) = S::as_simd_f64s(values);
        Self {
            simd,
            values: registers[0],
        }
    }

    /// Writes the lanes from `values[0]` on.
    #[inline(always)]
    pub(crate) fn store(self, values: &mut [f64]) {
        let (registers, _) = S::as_mut_simd_f64s(values);
        registers[0] = self.values;
    }

    /// The same constant in every lane.
    #[inline(always)]
    pub(crate) fn constant(simd: S, constant: f64) -> Self {
        Self {
            simd,
            values: simd.splat_f64s(constant),
        }
    }
}

impl<S: Simd> Real for Lanes<S> {
    #[inline(always)]
    fn splat(self, constant: f64) -> Self {
        Self::constant(self.simd, constant)
    }

    #[inline(always)]
    fn select_below(self, bound: f64, yes: Self, no: Self) -> Self {
        let mask = self.simd.less_than_f64s(self.values, self.simd.splat_f64s(bound));
        Self {
            simd: self.simd,
            values: self.simd.select_f64s(mask, yes.values, no.values),
        }
    }
}

impl<S: Simd> Add for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self {
            simd: self.simd,
            values: self.simd.add_f64s(self.values, other.values),
        }
    }
}

impl<S: Simd> Sub for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self {
            simd: self.simd,
            values: self.simd.sub_f64s(self.values, other.values),
        }
    }
}

impl<S: Simd> Mul for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self {
            simd: self.simd,
            values: self.simd.mul_f64s(self.values, other.values),
        }
    }
}

impl<S: Simd> Add<f64> for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn add(self, constant: f64) -> Self {
        self + Self::constant(self.simd, constant)
    }
}

impl<S: Simd> Mul<f64> for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, constant: f64) -> Self {
        self * Self::constant(self.simd, constant)
    }
}

impl<S: Simd> Lanes<S> {
    #[inline(always)]
    pub(crate) fn sqrt(self) -> Self {
        Self {
            simd: self.simd,
            values: self.simd.sqrt_f64s(self.values),
        }
    }

    /// The larger one; of no use where one is not a number.
    #[inline(always)]
    pub(crate) fn max(self, other: Self) -> Self {
        Self {
            simd: self.simd,
            values: self.simd.max_f64s(self.values, other.values),
        }
    }
}

impl<S: Simd> Div for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        Self {
            simd: self.simd,
            values: self.simd.div_f64s(self.values, other.values),
        }
    }
}

#[cfg(test)]
mod tests;
