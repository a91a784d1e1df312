//! Rotations and poses from the numbers that descriptions hold.
//!
//! Sines and cosines come from `libm`, so that a description gives the same bits on every machine.

use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion, Vector3};

/// Turns by `angle`, rad, about a unit vector.
pub(crate) fn about(axis: &Vector3<f64>, angle: f64) -> UnitQuaternion<f64> {
    let (sine, cosine) = libm::sincos(0.5 * angle);
    let vector = axis * sine;
    UnitQuaternion::new_unchecked(Quaternion::new(cosine, vector.x, vector.y, vector.z))
}

/// R = Rz(yaw) Ry(pitch) Rx(roll): roll, pitch and yaw about the fixed axes of the parent, in that order.
pub(crate) fn from_roll_pitch_yaw(rpy: &Vector3<f64>) -> UnitQuaternion<f64> {
    about(&Vector3::z(), rpy.z) * about(&Vector3::y(), rpy.y) * about(&Vector3::x(), rpy.x)
}

/// Roll, pitch and yaw of a rotation, the inverse of [`from_roll_pitch_yaw`]; roll is 0 where pitch is a right angle.
pub(crate) fn to_roll_pitch_yaw(rotation: &UnitQuaternion<f64>) -> Vector3<f64> {
    let r = rotation.to_rotation_matrix();
    let m = r.matrix();
    let cosine = libm::hypot(m[(0, 0)], m[(1, 0)]);
    let pitch = libm::atan2(-m[(2, 0)], cosine);
    // Within rounding of the right angle roll and yaw turn about one axis: all of it is called yaw.
    if cosine < GIMBAL_LOCK {
        return Vector3::new(0.0, pitch, libm::atan2(-m[(0, 1)], m[(1, 1)]));
    }
    Vector3::new(
        libm::atan2(m[(2, 1)], m[(2, 2)]),
        pitch,
        libm::atan2(m[(1, 0)], m[(0, 0)]),
    )
}

/// Cosine of the pitch below which roll and yaw are not told apart.
const GIMBAL_LOCK: f64 = 1e-9;

/// Translation, then rotation.
pub(crate) fn pose(position: Vector3<f64>, rotation: UnitQuaternion<f64>) -> Isometry3<f64> {
    Isometry3::from_parts(Translation3::from(position), rotation)
}

/// The pose with its quaternion's norm back at 1, after a long product.
pub(crate) fn renormalized(mut pose: Isometry3<f64>) -> Isometry3<f64> {
    pose.rotation.renormalize();
    pose
}
