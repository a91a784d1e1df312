//! What the drive adds to the rigid-body torque at the joint: reflected rotor inertia, and friction.
//!
//! ```text
//! τ_drive = ξ²·I_m·q̈ + F(q, q̇)
//! F(q, q̇) = (ξ²·c_m + c_j)·q̇ + (|ξ|³·d_m + d_j)·q̇·|q̇| + (|ξ|·F_m± + F_j±)·sgn q̇ + (k_m + k_j)·|g(q)|·sgn q̇
//! ```
//!
//! with the gear ratio ξ, motor-side coefficients m and joint-side ones j, F± by the direction in which the joint moves, and g
//! the torque that gravity takes of the joint, payload included (JP4358979B2, eq 52 to 56, for the viscous and the Coulomb
//! terms; the teeth of a loaded gear rub in proportion to their load, oil and seals in proportion to the speed squared). What
//! is stated in proportion to the load is a number on either side of the gear: torque over torque.

use crate::robot::spec::Drive;

/// The drive of one joint, seen from the joint.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct DriveTerms {
    /// Reflected rotor inertia, kg m² or kg.
    pub(crate) armature: f64,
    /// Torque over joint speed.
    pub(crate) viscous: f64,
    /// Torque over joint speed squared.
    pub(crate) quadratic: f64,
    /// Magnitude of the Coulomb torque, moving in the positive direction.
    pub(crate) coulomb_positive: f64,
    /// Magnitude of the Coulomb torque, moving in the negative direction.
    pub(crate) coulomb_negative: f64,
    /// Coulomb torque over the magnitude of the gravity torque.
    pub(crate) load_coulomb: f64,
}

impl DriveTerms {
    pub(crate) fn new(drive: &Drive) -> Self {
        let ratio = drive.gear_ratio;
        let (motor, joint) = (drive.motor_friction, drive.joint_friction);
        Self {
            armature: ratio * ratio * drive.rotor_inertia,
            viscous: ratio * ratio * motor.viscous + joint.viscous,
            quadratic: ratio * ratio * ratio.abs() * motor.quadratic + joint.quadratic,
            coulomb_positive: ratio.abs() * motor.coulomb_positive + joint.coulomb_positive,
            coulomb_negative: ratio.abs() * motor.coulomb_negative + joint.coulomb_negative,
            load_coulomb: motor.load_coulomb + joint.load_coulomb,
        }
    }

    /// Coulomb torque under a gravity torque while the joint moves in a direction: its sign counts, and 0 is standstill,
    /// without friction.
    #[inline]
    pub(crate) fn coulomb(&self, direction: f64, gravity: f64) -> f64 {
        if direction > 0.0 {
            return self.coulomb_positive + self.load_coulomb * gravity.abs();
        }
        if direction < 0.0 {
            return -(self.coulomb_negative + self.load_coulomb * gravity.abs());
        }
        0.0
    }

    /// Friction torque that grows with the square of the speed, at q̇ or, per unit of ṡ², at q′.
    #[inline]
    pub(crate) fn drag(&self, velocity: f64) -> f64 {
        self.quadratic * (velocity * velocity.abs())
    }

    /// Friction torque at a joint speed, under a gravity torque.
    #[inline]
    pub(crate) fn friction(&self, velocity: f64, gravity: f64) -> f64 {
        self.friction_towards(velocity, velocity, gravity)
    }

    /// Friction torque at a joint speed, of a motion in a direction: that of the motion just after or just before, where
    /// the speed is 0.
    #[inline]
    pub(crate) fn friction_towards(&self, velocity: f64, direction: f64, gravity: f64) -> f64 {
        self.viscous * velocity + self.drag(velocity) + self.coulomb(direction, gravity)
    }
}

/// Whether some drive's friction needs to know what gravity asks of it.
pub(crate) fn any_loaded(drives: &[DriveTerms]) -> bool {
    drives.iter().any(|drive| drive.load_coulomb != 0.0)
}
