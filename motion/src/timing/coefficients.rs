//! What each limit says at samples of a path, linear in path acceleration s̈ and squared path velocity ṡ².
//!
//! ```text
//! velocity      q′·ṡ            acceleration  q′·s̈ + q″·ṡ²
//! torque        m·s̈ + k·ṡ² + g + F± ± κ·|g| + c·q′·ṡ     with the rotors in m and k, F± and κ·|g| the Coulomb torque of the
//!               drive and of its load, c the viscous one; the quadratic one, d·q′·|q′|·ṡ², is in k
//! tool          |p′|·ṡ          p′·s̈ + p″·ṡ²
//! jerk          q′·s⃛ + 3·q″·ṡ·s̈ + q‴·ṡ³
//! ```
//!
//! (Bobrow, Dubowsky and Gibson 1985; Verscheure et al. 2009.) Joint columns have entry `joint * stride + sample`.

use nalgebra::Isometry3;

use super::grid::Place;
use super::limits::Limits;
use crate::budget::{Budget, Stopped};
use crate::curve::{Curve, CurvePoint};
use crate::dynamics::path::PathTerms;
use crate::robot::Robot;
use crate::tolerance::PATH_SPEED_SQUARED_MAX;

/// Samples of the path between two looks at the budget: well below 10 ms with any curve.
const BUDGET_EVERY: usize = 64;

/// Samples whose terms are computed between two looks, a multiple of any number of lanes: 2 ms with 32 joints.
const BLOCK: usize = 2048;

/// The coefficients of every limit at samples of a path.
#[derive(Debug, Default)]
pub(crate) struct Coefficients {
    pub(crate) joint_count: usize,
    pub(crate) stride: usize,
    pub(crate) places: Vec<Place>,
    /// Index of the limits in force, one a sample.
    pub(crate) stretch: Vec<usize>,
    /// q, q′, q″, m, k, g, p′, p″; p′ and p″ only where something bounds the tool.
    pub(crate) terms: PathTerms,
    /// q‴.
    pub(crate) third: Vec<f64>,
    /// c·q′: viscous torque per unit of path velocity.
    pub(crate) viscous: Vec<f64>,
    /// The larger and the smaller Coulomb torque of a sample and its two neighbours: they differ where a joint turns
    /// round nearby, and where its load does.
    pub(crate) coulomb_high: Vec<f64>,
    pub(crate) coulomb_low: Vec<f64>,
    /// κ: Coulomb torque over the magnitude of the gravity torque, one a joint.
    pub(crate) load_coulomb: Vec<f64>,
    /// Largest ṡ² that the speeds of joints and tool allow here and up to the next sample on both sides; one a sample.
    pub(crate) speed_bound: Vec<f64>,
}

impl Coefficients {
    /// Evaluates the path at places in order.
    ///
    /// # Errors
    /// [`Stopped`], when nobody waits any more.
    pub(crate) fn compute(
        robot: &Robot,
        tcp: &Isometry3<f64>,
        curve: &dyn Curve,
        limits: &Limits,
        places: &[Place],
        budget: &Budget<'_>,
    ) -> Result<Self, Stopped> {
        let joint_count = curve.joint_count();
        let mut terms = PathTerms::default();
        terms.reset(joint_count, places.len());
        let stride = terms.stride;
        let mut third = vec![0.0; joint_count * stride];
        let mut point = CurvePoint::new(joint_count);
        for (sample, place) in places.iter().enumerate() {
            if sample % BUDGET_EVERY == 0 {
                budget.check()?;
            }
            curve.evaluate(place.s, place.side, &mut point);
            terms.set(sample, &point);
            for (joint, value) in point.third.iter().enumerate() {
                third[joint * stride + sample] = *value;
            }
        }
        let on_last = || (robot.spec().link_from_tip * tcp).translation.vector;
        let tool = limits.bound_the_tool().then(|| robot.chain().point_on_last(on_last()));
        for begin in (0..stride).step_by(BLOCK) {
            budget.check()?;
            terms.compute_some(robot.chain(), tool, begin..(begin + BLOCK).min(stride));
        }
        let mut coefficients = Self {
            joint_count,
            stride,
            places: places.to_vec(),
            stretch: stretches(limits, places),
            terms,
            third,
            viscous: vec![0.0; joint_count * stride],
            coulomb_high: vec![0.0; joint_count * stride],
            coulomb_low: vec![0.0; joint_count * stride],
            load_coulomb: robot.drives().iter().map(|drive| drive.load_coulomb).collect(),
            speed_bound: vec![PATH_SPEED_SQUARED_MAX; places.len()],
        };
        coefficients.add_drives(robot);
        coefficients.bound_speeds(limits);
        Ok(coefficients)
    }

    /// Rotors and friction.
    fn add_drives(&mut self, robot: &Robot) {
        let count = self.places.len();
        for (joint, drive) in robot.drives().iter().enumerate() {
            let column = joint * self.stride..joint * self.stride + count;
            let (first, second) = (&self.terms.first[column.clone()], &self.terms.second[column.clone()]);
            for (mass, first) in self.terms.mass[column.clone()].iter_mut().zip(first) {
                *mass += drive.armature * first;
            }
            for (velocity, second) in self.terms.velocity[column.clone()].iter_mut().zip(second) {
                *velocity += drive.armature * second;
            }
            for (viscous, first) in self.viscous[column.clone()].iter_mut().zip(first) {
                *viscous = drive.viscous * first;
            }
            if drive.quadratic != 0.0 {
                for (velocity, first) in self.terms.velocity[column.clone()].iter_mut().zip(first) {
                    *velocity += drive.drag(*first);
                }
            }
            if drive.coulomb_positive == 0.0 && drive.coulomb_negative == 0.0 && drive.load_coulomb == 0.0 {
                continue;
            }
            let gravity = &self.terms.gravity[column.clone()];
            let (high, low) = (
                &mut self.coulomb_high[column.clone()],
                &mut self.coulomb_low[column.clone()],
            );
            for sample in 0..count {
                let near = &first[sample.saturating_sub(1)..(sample + 2).min(count)];
                let bounds = |gravity: f64| {
                    let torques = near.iter().map(|first| drive.coulomb(*first, gravity));
                    torques.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), torque| {
                        (low.min(torque), high.max(torque))
                    })
                };
                (low[sample], high[sample]) = bounds(gravity[sample]);
                if drive.load_coulomb != 0.0 && passes_zero(gravity, sample) {
                    // a load that turns round takes anything from nothing on
                    let (least, most) = bounds(0.0);
                    low[sample] = low[sample].min(least);
                    high[sample] = high[sample].max(most);
                }
            }
        }
    }

    fn bound_speeds(&mut self, limits: &Limits) {
        let count = self.places.len();
        for joint in 0..self.joint_count {
            let column = joint * self.stride..joint * self.stride + count;
            let (first, second) = (&self.terms.first[column.clone()], &self.terms.second[column]);
            let mut peak_before: f64 = 0.0;
            for sample in 0..count {
                let peak_after = match self.places.get(sample + 1) {
                    Some(next) => peak_between(
                        [first[sample], first[sample + 1]],
                        [second[sample], second[sample + 1]],
                        next.s - self.places[sample].s,
                    ),
                    None => 0.0,
                };
                let rate = first[sample].abs().max(peak_before).max(peak_after);
                peak_before = peak_after;
                let Some(limit) = limits.stretches[self.stretch[sample]].joints[joint].velocity else {
                    continue;
                };
                let bound = &mut self.speed_bound[sample];
                *bound = bound.min(limit * limit / (rate * rate));
            }
        }
        for sample in 0..count {
            let Some(limit) = limits.stretches[self.stretch[sample]].tool_velocity else {
                continue;
            };
            let rate = norm_squared(self.tool_first(sample));
            let bound = &mut self.speed_bound[sample];
            *bound = bound.min(limit * limit / rate);
        }
    }

    /// p′ at a sample.
    pub(crate) fn tool_first(&self, sample: usize) -> [f64; 3] {
        std::array::from_fn(|axis| self.terms.tool_first[axis * self.stride + sample])
    }

    /// p″ at a sample.
    pub(crate) fn tool_second(&self, sample: usize) -> [f64; 3] {
        std::array::from_fn(|axis| self.terms.tool_second[axis * self.stride + sample])
    }
}

fn stretches(limits: &Limits, places: &[Place]) -> Vec<usize> {
    places
        .iter()
        .map(|place| limits.stretch_at(place.s, place.side))
        .collect()
}

fn norm_squared(v: [f64; 3]) -> f64 {
    v[0] * v[0] + v[1] * v[1] + v[2] * v[2]
}

/// Whether a gravity torque may be zero between a sample and one of its neighbours: it has another sign there, or is so small
/// that it may dip through zero in between.
fn passes_zero(gravity: &[f64], sample: usize) -> bool {
    let here = gravity[sample];
    let before = gravity[sample.saturating_sub(1)];
    let after = gravity[(sample + 1).min(gravity.len() - 1)];
    let bend = before - 2.0 * here + after;
    here * before <= 0.0 || here * after <= 0.0 || here.abs() <= bend.abs()
}

/// Magnitude of the extreme of q′ strictly between two samples, were q″ linear there; 0 where there is none.
fn peak_between(first: [f64; 2], second: [f64; 2], step: f64) -> f64 {
    if second[0] * second[1] >= 0.0 {
        return 0.0;
    }
    let at = step * (second[0] / (second[0] - second[1]));
    (first[0] + 0.5 * second[0] * at).abs()
}

#[cfg(test)]
mod tests;
