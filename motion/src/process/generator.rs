//! Set-points at constant tool speed, cycle by cycle: no allocation, no sine, no root in a cycle (JPH0743606B2).
//!
//! An arc turns by the same angle Δφ = Vs·Δt/r in every cycle, so that the rotation is computed once (Rodrigues 1840, n
//! the unit normal):
//!
//! ```text
//! p ← centre + R·(p − centre),      R = I + sin Δφ·[n]× + (1 − cos Δφ)·[n]×²
//! ```
//!
//! What is applied to the last offset o from the centre is
//!
//! ```text
//! o ← f·(o + (R·P − I)·o)           P = I − n·nᵀ,  f = (3 − o²/r²)/2
//! ```
//!
//! P puts o back into the plane, at no cost since it is within the matrix; f puts it back to the radius: a Newton step
//! for r/|o|, exact to the square of an error of 1e-16, that does not wait for the rotation. Without n·nᵀ, which is
//! symmetric and so does not turn, R·P − I is of the size of Δφ: its rounding turns the circle less by that factor than
//! the rounding of R's own entries would, in every cycle the same way.
//!
//! A transition is its polynomial in h.
//!
//! Base axes or any other, m.
//!
//! ```
//! use takt_motion::nalgebra::Vector3;
//! use takt_motion::process::generator::CircleGenerator;
//!
//! // 0.25 m/s on a circle of 0.1 m, every 4 ms
//! let circle = CircleGenerator::new(Vector3::zeros(), Vector3::z(), Vector3::new(0.1, 0.0, 0.0), 0.25 * 0.004)?;
//! let after_a_second = circle.take(250).last().expect("a circle has no end");
//! assert!((after_a_second - Vector3::new(0.1 * 2.5_f64.cos(), 0.1 * 2.5_f64.sin(), 0.0)).norm() < 1e-13);
//! # Ok::<(), takt_motion::Invalid>(())
//! ```

use nalgebra::{Matrix3, Vector3};

use super::geometry::PathFrame;
use super::transition::Polynomial;
use crate::error::Invalid;

/// Set-points along a circle at constant speed: an iterator without end.
#[derive(Debug, Clone, PartialEq)]
pub struct CircleGenerator {
    center: Vector3<f64>,
    /// R·P − I.
    change: Matrix3<f64>,
    /// 1/(2r²).
    half_inverse_square: f64,
    /// o.
    offset: Vector3<f64>,
}

impl CircleGenerator {
    /// A circle about `center` from `start` on, right-handed about `normal` (of any length), with `step` m of way in
    /// every cycle: Vs·Δt; a negative one turns the other way. A start beside the circle's plane counts as its foot in
    /// the plane through `start`.
    ///
    /// # Errors
    /// Where there is no circle: a normal of length zero, a start on the axis, a step that is not finite.
    pub fn new(center: Vector3<f64>, normal: Vector3<f64>, start: Vector3<f64>, step: f64) -> Result<Self, Invalid> {
        let longest = normal.amax();
        // written so that NaN is refused too
        if !(longest > 0.0 && longest.is_finite()) {
            return Err(Invalid::new("normal", "has no direction"));
        }
        let normal = (normal / longest).normalize();
        let from_center = start - center;
        let height = normal * normal.dot(&from_center);
        let offset = from_center - height;
        let radius = offset.norm();
        let half_inverse_square = 0.5 / (radius * radius);
        if !(half_inverse_square > 0.0 && half_inverse_square.is_finite()) {
            return Err(Invalid::new("start", format!("is {radius} m from the circle's axis")));
        }
        if !step.is_finite() {
            return Err(Invalid::new("step", format!("is {step} m")));
        }
        let angle = step / radius;
        let half_sine = libm::sin(0.5 * angle);
        let flat = normal * normal.transpose();
        let change = normal.cross_matrix() * libm::sin(angle)
            - (Matrix3::identity() - flat) * (2.0 * half_sine * half_sine)
            - flat;
        Ok(Self {
            center: center + height,
            change,
            half_inverse_square,
            offset,
        })
    }
}

impl Iterator for CircleGenerator {
    type Item = Vector3<f64>;

    /// The set-point one cycle on.
    #[inline]
    fn next(&mut self) -> Option<Vector3<f64>> {
        let onto_radius = 1.5 - self.half_inverse_square * self.offset.norm_squared();
        // two short sums side by side: a set-point waits for the one before it
        let [x, y, z] = [0, 1, 2].map(|axis| self.change.column(axis) * self.offset[axis]);
        self.offset = ((self.offset + x) + (y + z)) * onto_radius;
        Some(self.center + self.offset)
    }
}

/// Set-points of one transition; the last one ends it.
#[derive(Debug, Clone, PartialEq)]
pub struct TransitionGenerator {
    polynomial: Polynomial,
    done: u32,
    cycles: u32,
}

impl TransitionGenerator {
    /// The source's form, from `before` (P−) over the taught point `corner` (P) to `after` (P+), in so many cycles: its
    /// velocity goes from −Δ−/ta to Δ+/ta with Δ± = P± − P, its acceleration from 0 to 0. With `before` = `corner`
    /// it starts from rest, with `after` = `corner` it comes to rest.
    #[must_use]
    pub fn source(before: &Vector3<f64>, corner: &Vector3<f64>, after: &Vector3<f64>, cycles: u32) -> Self {
        Self::new(Polynomial::quartic(before, corner, after), cycles)
    }

    /// The form without jumps, from one place on a path to another in so many cycles, at the speed and with the
    /// acceleration that the paths have there when run at constant speed; `reach` is Vs·ta, m.
    #[must_use]
    pub fn smooth(before: &PathFrame, after: &PathFrame, reach: f64, cycles: u32) -> Self {
        Self::new(Polynomial::quintic(before, after, reach), cycles)
    }

    fn new(polynomial: Polynomial, cycles: u32) -> Self {
        Self {
            polynomial,
            done: 0,
            cycles,
        }
    }
}

impl Iterator for TransitionGenerator {
    type Item = Vector3<f64>;

    /// The set-point one cycle on.
    #[inline]
    fn next(&mut self) -> Option<Vector3<f64>> {
        if self.done == self.cycles {
            return None;
        }
        self.done += 1;
        Some(self.polynomial.position(f64::from(self.done) / f64::from(self.cycles)))
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        let left = (self.cycles - self.done) as usize;
        (left, Some(left))
    }
}

impl ExactSizeIterator for TransitionGenerator {}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_arms::random;

    fn vector(state: &mut u64) -> Vector3<f64> {
        Vector3::new(random(state), random(state), random(state))
    }

    /// Against the angle itself, a million cycles on: along the circle, in radius and in plane.
    #[test]
    fn a_million_set_points_do_not_drift() {
        let state = &mut 1;
        for (radius, step) in [(0.1, 0.25e-3), (0.5, 1.0e-3), (2.0, 0.125e-3), (0.05, -1.0e-3)] {
            let (center, normal) = (vector(state), vector(state).normalize());
            let out = normal.cross(&vector(state)).normalize() * radius;
            let mut circle = CircleGenerator::new(center, normal * 3.0, center + out, step).unwrap();
            let steps = 1_000_000;
            let last = circle.nth(steps - 1).unwrap();
            // the angle in full turns is exact to 1e-16 of a turn count below 1e4
            let (sin, cos) = (steps as f64 * (step / radius)).sin_cos();
            let expected = center + out * cos + normal.cross(&out) * sin;
            let off = (last - expected).norm() / radius;
            assert!(off < 1e-10, "{off}");
            let from_center = last - center;
            assert!((from_center.norm() / radius - 1.0).abs() < 1e-14);
            assert!(normal.dot(&from_center).abs() < 1e-14);
        }
    }

    /// One step is the rotation that nalgebra computes from the same axis and angle.
    #[test]
    fn a_step_is_a_rotation() {
        let state = &mut 2;
        for _ in 0..100 {
            let (center, normal, start) = (vector(state), vector(state), vector(state));
            let axis = nalgebra::Unit::new_normalize(normal);
            let radius = axis.cross(&(start - center)).norm();
            let angle = 3.0 * random(state);
            let mut circle = CircleGenerator::new(center, normal, start, radius * angle).unwrap();
            let expected = center + nalgebra::Rotation3::from_axis_angle(&axis, angle) * (start - center);
            assert!((circle.next().unwrap() - expected).norm() < 1e-14);
        }
    }

    #[test]
    fn what_is_no_circle_is_refused() {
        let (zero, x, z) = (Vector3::zeros(), Vector3::x(), Vector3::z());
        let path = |center, normal, start, step| CircleGenerator::new(center, normal, start, step).unwrap_err().path;
        assert_eq!(path(zero, zero, x, 0.1), "normal");
        assert_eq!(path(zero, z * f64::NAN, x, 0.1), "normal");
        assert_eq!(path(zero, z, z, 0.1), "start");
        assert_eq!(path(zero, z, x * f64::INFINITY, 0.1), "start");
        assert_eq!(path(zero, z, x, f64::NAN), "step");
    }

    /// A transition ends where it should, at the speed of what follows.
    #[test]
    fn a_transition_leads_into_what_follows() {
        let state = &mut 3;
        let frame = |state: &mut u64| PathFrame {
            position: vector(state),
            tangent: vector(state).normalize(),
            curvature: vector(state),
        };
        let (before, corner, after) = (frame(state), vector(state), frame(state));
        let (reach, cycles) = (0.3, 100_000);
        let smooth = TransitionGenerator::smooth(&before, &after, reach, cycles);
        let source = TransitionGenerator::source(&before.position, &corner, &after.position, cycles);
        // Vs·Δt with 2·ta in so many cycles; Δ+ instead of Vs·ta·t̂ in the source's form
        let per_cycle = 2.0 / f64::from(cycles);
        for (generator, step) in [(smooth, after.tangent * reach), (source, after.position - corner)] {
            assert_eq!(generator.len(), cycles as usize);
            let points: Vec<Vector3<f64>> = generator.collect();
            let [.., early, last] = points.as_slice() else {
                panic!("{}", points.len());
            };
            assert!((last - after.position).norm() < 1e-14);
            assert!((last - early - step * per_cycle).norm() < 1e-9);
        }
        let mut none = TransitionGenerator::source(&Vector3::x(), &Vector3::y(), &Vector3::z(), 0);
        assert_eq!((none.len(), none.next()), (0, None));
    }
}
