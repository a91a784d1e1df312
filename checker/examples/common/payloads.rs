//! What the example robots carry.

use nalgebra::{Matrix3, Vector3};
use takt_motion::robot::spec::Inertial;

/// A payload with its centre at `center`, in the tip link's frame; it turns like a ball of 5 cm.
pub(crate) fn ball(mass: f64, center: Vector3<f64>) -> Inertial {
    Inertial {
        mass,
        center_of_mass: center,
        inertia: Matrix3::identity() * (0.4 * 0.05 * 0.05 * mass),
    }
}
