//! Whether a mass distribution can be that of a rigid body.
//!
//! The principal moments A ≤ B ≤ C of a rigid body are not negative and A + B ≥ C (C. Wensing, S. Kim, J.-J. Slotine,
//! "Linear matrix inequalities for physically-consistent inertial parameter identification", 2018). Makers' own files
//! break this, so it is a warning: what cannot be computed with, a singular mass matrix, shows later.

use std::fmt;

use nalgebra::{Matrix3, SymmetricEigen};

use super::bounds::INERTIA_ROUNDING;
use super::spec::Inertial;

/// Rounds of the eigenvalue iteration, which takes about four for a symmetric 3 × 3 matrix.
const EIGEN_ROUNDS: usize = 100;

/// Says what is odd about a body whose numbers are within their bounds.
pub(crate) fn oddity(subject: impl fmt::Display, body: &Inertial) -> Option<String> {
    let is_point = body.inertia.iter().all(|entry| *entry == 0.0);
    if body.mass == 0.0 && !is_point {
        let [xx, yy, zz] = diagonal(&body.inertia);
        return Some(format!(
            "{subject}: mass 0 with a rotational inertia of ({xx:?}, {yy:?}, {zz:?}) kg m² is not a rigid body's"
        ));
    }
    if body.mass > 0.0 && is_point {
        return Some(format!(
            "{subject}: mass {:?} kg with a rotational inertia of zero is taken as a point mass",
            body.mass
        ));
    }
    if is_point {
        return None;
    }
    let [a, b, c] = principal_moments(&body.inertia)?;
    let slack = INERTIA_ROUNDING * (a.abs() + b.abs() + c.abs());
    if a < -slack {
        return Some(format!(
            "{subject}: rotational inertia has the negative principal moment {a:.6e} kg m² (of {a:.6e}, {b:.6e}, {c:.6e})"
        ));
    }
    if a + b < c - slack {
        return Some(format!(
            "{subject}: principal moments {a:.6e} + {b:.6e} < {c:.6e} kg m² break the triangle inequality of a rigid body"
        ));
    }
    None
}

/// The principal moments, smallest first.
fn principal_moments(inertia: &Matrix3<f64>) -> Option<[f64; 3]> {
    // Scaled to its largest entry, so that the tolerance of the iteration is relative.
    let scale = inertia.amax();
    let eigen = SymmetricEigen::try_new(inertia / scale, f64::EPSILON, EIGEN_ROUNDS)?;
    let mut moments = [
        eigen.eigenvalues.x * scale,
        eigen.eigenvalues.y * scale,
        eigen.eigenvalues.z * scale,
    ];
    moments.sort_by(f64::total_cmp);
    Some(moments)
}

fn diagonal(matrix: &Matrix3<f64>) -> [f64; 3] {
    [matrix.m11, matrix.m22, matrix.m33]
}
