//! How far one place of the tool is from another.

use nalgebra::{Matrix3, Vector3};

use super::screws::Place;
use crate::tolerance::{IK_ORIENTATION, IK_POSITION};

/// What is missing from one place to another, in base-link axes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Gap {
    /// m.
    pub(super) linear: Vector3<f64>,
    /// Rotation vector, rad: axis times angle, the shortest way.
    pub(super) angular: Vector3<f64>,
}

impl Gap {
    pub(super) fn between(from: &Place, to: &Place) -> Self {
        Self {
            linear: to.point - from.point,
            angular: rotation_vector(&(to.rotation * from.rotation.transpose())),
        }
    }

    /// |(linear/size, angular)|², without unit.
    pub(super) fn squared(&self, size: f64) -> f64 {
        self.linear.norm_squared() / (size * size) + self.angular.norm_squared()
    }

    /// Whether nothing is missing that matters.
    pub(super) fn is_closed(&self) -> bool {
        self.linear.norm() <= IK_POSITION && self.angular.norm() <= IK_ORIENTATION
    }
}

/// log R: the axis times the angle in [0, π].
///
/// sin θ·n is the skew part of R, cos θ half its trace less 1. Towards θ = π the skew part vanishes, and n is a column
/// of the symmetric part (R + Rᵀ)/2 − cos θ·I = (1 − cos θ)·n·nᵀ.
fn rotation_vector(r: &Matrix3<f64>) -> Vector3<f64> {
    let skew = 0.5 * Vector3::new(r.m32 - r.m23, r.m13 - r.m31, r.m21 - r.m12);
    let (sine, cosine) = (skew.norm(), 0.5 * (r.trace() - 1.0));
    if cosine > 0.0 {
        // atan x = x·(1 − x²/3 + …): small angles need neither the arctangent nor the division by 0
        let ratio = if sine > 0.0 {
            libm::atan2(sine, cosine) / sine
        } else {
            1.0
        };
        return skew * ratio;
    }
    let squares = (r + r.transpose()) * 0.5 - Matrix3::identity() * cosine;
    let column = (0..3).fold(0, |best, i| {
        if squares[(i, i)] > squares[(best, best)] {
            i
        } else {
            best
        }
    });
    let along = squares.column(column).into_owned();
    let length = along.norm();
    if length <= 0.0 {
        return skew;
    }
    let axis = along / length;
    let sign = if axis.dot(&skew) < 0.0 { -1.0 } else { 1.0 };
    axis * (sign * libm::atan2(sine, cosine))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use nalgebra::{Rotation3, Vector3};

    use super::rotation_vector;
    use crate::test_arms::random;

    #[test]
    fn the_rotation_vector_is_what_made_the_rotation() {
        let state = &mut 1;
        for angle in [0.0, 1e-12, 1e-6, 0.1, 1.5, PI / 2.0, 1.7, 3.0, PI - 1e-4, PI - 1e-8] {
            for _ in 0..50 {
                let vector = Vector3::from_fn(|_, _| random(state)).normalize() * angle;
                let found = rotation_vector(Rotation3::from_scaled_axis(vector).matrix());
                assert!((found - vector).norm() < 1e-14 + 3e-15 * angle, "{found} {vector}");
            }
        }
    }
}
