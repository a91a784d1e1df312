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

/// Roll, pitch and yaw of a rotation, the inverse of [`from_roll_pitch_yaw`].
///
/// Near a pitch of a right angle, where roll and yaw turn about one axis and yaw is lost in rounding, roll is computed
/// from what is left after that yaw, so that the three together stay exact.
pub(crate) fn to_roll_pitch_yaw(rotation: &UnitQuaternion<f64>) -> Vector3<f64> {
    let r = rotation.to_rotation_matrix();
    let m = r.matrix();
    let yaw = libm::atan2(m.m21, m.m11);
    let (sine, cosine) = libm::sincos(yaw);
    // Rz(−yaw) R = Ry(pitch) Rx(roll), entry by entry.
    let pitch = libm::atan2(-m.m31, cosine * m.m11 + sine * m.m21);
    let roll = libm::atan2(sine * m.m13 - cosine * m.m23, cosine * m.m22 - sine * m.m12);
    Vector3::new(roll, pitch, yaw)
}

/// Translation, then rotation.
pub(crate) fn pose(position: Vector3<f64>, rotation: UnitQuaternion<f64>) -> Isometry3<f64> {
    Isometry3::from_parts(Translation3::from(position), rotation)
}

/// The pose with its quaternion's norm back at 1, after a long product.
pub(crate) fn renormalized(mut pose: Isometry3<f64>) -> Isometry3<f64> {
    pose.rotation.renormalize();
    pose
}
