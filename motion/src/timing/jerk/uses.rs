//! What a motion uses of every limit around the points of one cell of a [`super::certificate`].

use pulp::{Simd, WithSimd};

use crate::timing::coefficients::Coefficients;
use crate::timing::limits::{JointLimits, Limits};
use crate::tolerance::CERTIFIED;

/// Points of an interval.
pub(super) const POINTS: usize = 8;

/// A value at the points of one interval.
pub(super) type Points = [f64; POINTS];

/// The motion at the points of one interval: ṡ, ṡ², s̈ and s⃛.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Rates {
    pub(super) velocity: Points,
    pub(super) square: Points,
    pub(super) acceleration: Points,
    pub(super) jerk: Points,
}

/// Parts of the limits that are used, at most, around each point of one interval.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Uses {
    pub(super) jerk: Points,
    /// Of joints and tool.
    pub(super) acceleration: Points,
    pub(super) torque: Points,
    /// Of the largest ṡ².
    pub(super) square: Points,
    /// How much slower the motion must be for torque.
    pub(super) torque_speed: f64,
}

/// The uses of every cell.
pub(super) struct Sweep<'a> {
    pub(super) limits: &'a Limits,
    pub(super) at: &'a Coefficients,
    pub(super) rates: &'a [Rates],
    pub(super) uses: &'a mut [Uses],
}

impl WithSimd for Sweep<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _simd: S) {
        for (cell, (rates, uses)) in self.rates.iter().zip(self.uses).enumerate() {
            let first = cell * POINTS;
            // borders of stretches are borders of cells: a cell has one set of limits
            let stretch = &self.limits.stretches[self.at.stretch[first]];
            *uses = Uses {
                torque_speed: 1.0,
                ..Uses::default()
            };
            for (joint, limits) in stretch.joints.iter().enumerate() {
                let entry = joint * self.at.stride + first;
                joint_uses(self.at, [joint, entry], limits, rates, uses);
            }
            for k in 0..POINTS {
                uses.square[k] = rates.square[k] / self.at.speed_bound[first + k];
            }
            if let Some(limit) = stretch.tool_acceleration {
                tool_uses(self.at, first, limit, rates, uses);
            }
        }
    }
}

#[inline(always)]
fn column(values: &[f64], entry: usize) -> &Points {
    values[entry..].first_chunk().unwrap_or(&[f64::NAN; POINTS])
}

#[inline(always)]
fn joint_uses(at: &Coefficients, [joint, entry]: [usize; 2], limits: &JointLimits, rates: &Rates, uses: &mut Uses) {
    let first = column(&at.terms.first, entry);
    let second = column(&at.terms.second, entry);
    let (velocity, square, acceleration) = (&rates.velocity, &rates.square, &rates.acceleration);
    let mut value = [0.0; POINTS];
    if let Some(limit) = limits.jerk {
        let third = column(&at.third, entry);
        for k in 0..POINTS {
            let by_second = 3.0 * velocity[k] * acceleration[k];
            let by_third = velocity[k] * square[k];
            value[k] = (first[k] * rates.jerk[k] + second[k] * by_second + third[k] * by_third) / limit;
        }
        let [up, down] = peaks(&value);
        for k in 0..POINTS {
            uses.jerk[k] = uses.jerk[k].max(up[k]).max(down[k]);
        }
    }
    if let Some(limit) = limits.acceleration {
        for k in 0..POINTS {
            value[k] = (first[k] * acceleration[k] + second[k] * square[k]) / limit;
        }
        let [up, down] = peaks(&value);
        for k in 0..POINTS {
            uses.acceleration[k] = uses.acceleration[k].max(up[k]).max(down[k]);
        }
    }
    if let Some(limit) = limits.torque {
        torque_uses(at, [joint, entry], limit, rates, uses);
    }
}

/// Coulomb torque jumps where a joint turns round: it is added after the parabola. That of the load goes with the gravity
/// torque, with either sign: the higher parabola counts.
#[inline(always)]
fn torque_uses(at: &Coefficients, [joint, entry]: [usize; 2], limit: f64, rates: &Rates, uses: &mut Uses) {
    let mass = column(&at.terms.mass, entry);
    let bend = column(&at.terms.velocity, entry);
    let viscous = column(&at.viscous, entry);
    let gravity = column(&at.terms.gravity, entry);
    let high = column(&at.coulomb_high, entry);
    let low = column(&at.coulomb_low, entry);
    let mut value = [0.0; POINTS];
    for k in 0..POINTS {
        let dynamic = mass[k] * rates.acceleration[k] + bend[k] * rates.square[k] + viscous[k] * rates.velocity[k];
        value[k] = (dynamic + gravity[k]) / limit;
    }
    let [mut up, mut down] = peaks(&value);
    let load = at.load_coulomb[joint] / limit;
    if load != 0.0 {
        for sign in [load, -load] {
            let mut loaded = value;
            for k in 0..POINTS {
                loaded[k] += sign * gravity[k];
            }
            let [high, low] = peaks(&loaded);
            for k in 0..POINTS {
                up[k] = up[k].max(high[k] - sign * gravity[k]);
                down[k] = down[k].max(low[k] + sign * gravity[k]);
            }
        }
    }
    let mut worst = 0.0_f64;
    for k in 0..POINTS {
        let used = (up[k] + high[k] / limit).max(down[k] - low[k] / limit);
        uses.torque[k] = uses.torque[k].max(used);
        worst = worst.max(used);
    }
    if worst <= CERTIFIED {
        return;
    }
    for k in 0..POINTS {
        let sides = [
            (up[k] + high[k] / limit, (gravity[k] + high[k]) / limit),
            (down[k] - low[k] / limit, -(gravity[k] + low[k]) / limit),
        ];
        for (used, at_rest) in sides {
            if used > CERTIFIED {
                // what motion adds grows with its speed or with the square of it: the slower of the two
                uses.torque_speed = uses.torque_speed.min((CERTIFIED - at_rest) / (used - at_rest));
            }
        }
    }
}

#[inline(always)]
fn tool_uses(at: &Coefficients, first: usize, limit: f64, rates: &Rates, uses: &mut Uses) {
    let mut squares = [0.0; POINTS];
    for axis in 0..3 {
        let p1 = column(&at.terms.tool_first, axis * at.stride + first);
        let p2 = column(&at.terms.tool_second, axis * at.stride + first);
        for k in 0..POINTS {
            let value = p1[k] * rates.acceleration[k] + p2[k] * rates.square[k];
            squares[k] += value * value;
        }
    }
    let mut value = [0.0; POINTS];
    for k in 0..POINTS {
        value[k] = squares[k].sqrt() / limit;
    }
    let [up, _] = peaks(&value);
    for (used, up) in uses.acceleration.iter_mut().zip(up) {
        *used = used.max(up);
    }
}

/// The largest value and the largest negative value around each point.
#[inline(always)]
fn peaks(value: &Points) -> [Points; 2] {
    let mut second = [0.0; POINTS];
    for k in 1..POINTS - 1 {
        second[k] = value[k - 1] - 2.0 * value[k] + value[k + 1];
    }
    second[0] = second[1];
    second[POINTS - 1] = second[POINTS - 2];
    let (mut least, mut most) = (second, second);
    for k in 1..POINTS {
        least[k] = least[k].min(second[k - 1]);
        most[k] = most[k].max(second[k - 1]);
        least[k - 1] = least[k - 1].min(second[k]);
        most[k - 1] = most[k - 1].max(second[k]);
    }
    let mut peaks = [[0.0; POINTS]; 2];
    for k in 0..POINTS {
        peaks[0][k] = value[k] + (-least[k]).max(0.0) / 8.0;
        peaks[1][k] = most[k].max(0.0) / 8.0 - value[k];
    }
    peaks
}
