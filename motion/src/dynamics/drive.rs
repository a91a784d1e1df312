//! What the drive adds to the rigid-body torque at the joint: reflected rotor inertia, and friction.
//!
//! τ_drive = ξ²·I_m·q̈ + (ξ²·c_m + c_j)·q̇ + (|ξ|·F_m± + F_j±)·sgn(q̇), with the gear ratio ξ, motor-side coefficients m and
//! joint-side ones j, and F± by the direction in which the joint moves (JP4358979B2, eq 52 to 56).

use crate::robot::spec::Drive;

/// The drive of one joint, seen from the joint.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct DriveTerms {
    /// Reflected rotor inertia, kg m² or kg.
    pub(crate) armature: f64,
    /// Torque over joint speed.
    pub(crate) viscous: f64,
    /// Magnitude of the Coulomb torque, moving in the positive direction.
    pub(crate) coulomb_positive: f64,
    /// Magnitude of the Coulomb torque, moving in the negative direction.
    pub(crate) coulomb_negative: f64,
}

impl DriveTerms {
    pub(crate) fn new(drive: &Drive) -> Self {
        let ratio = drive.gear_ratio;
        let (motor, joint) = (drive.motor_friction, drive.joint_friction);
        Self {
            armature: ratio * ratio * drive.rotor_inertia,
            viscous: ratio * ratio * motor.viscous + joint.viscous,
            coulomb_positive: ratio.abs() * motor.coulomb_positive + joint.coulomb_positive,
            coulomb_negative: ratio.abs() * motor.coulomb_negative + joint.coulomb_negative,
        }
    }

    /// Coulomb torque while the joint moves in a direction: its sign counts, and 0 is standstill, without friction.
    #[inline]
    pub(crate) fn coulomb(&self, direction: f64) -> f64 {
        if direction > 0.0 {
            return self.coulomb_positive;
        }
        if direction < 0.0 {
            return -self.coulomb_negative;
        }
        0.0
    }

    /// Friction torque at a joint speed.
    #[inline]
    pub(crate) fn friction(&self, velocity: f64) -> f64 {
        self.friction_towards(velocity, velocity)
    }

    /// Friction torque at a joint speed, of a motion in a direction: that of the motion just after or just before, where
    /// the speed is 0.
    #[inline]
    pub(crate) fn friction_towards(&self, velocity: f64, direction: f64) -> f64 {
        self.viscous * velocity + self.coulomb(direction)
    }
}
