//! An entry of `joints` laid over a joint of the chain.

use crate::robot::description::{DriveEntry, FrictionEntry, JointEntry};
use crate::robot::findings::{Findings, quoted};
use crate::robot::spec::{Drive, Friction, JointKind, JointSpec, Limits};
use crate::tolerance::SLOPE_ROUNDING;

/// What the entry states takes the place of what the joint has.
pub(super) fn lay_over(joint: &mut JointSpec, entry: &JointEntry, index: usize, findings: &mut Findings) {
    lay_limits(joint, &entry.limits, index, findings);
    lay_drive(&mut joint.drive, &entry.drive);
    check_slopes(joint, index, findings);
}

/// Friction must not fall with speed within the speed limit: it would push there, and a plan that goes faster than what was measured would
/// count on it.
fn check_slopes(joint: &JointSpec, index: usize, findings: &mut Findings) {
    let Drive {
        motor_friction,
        joint_friction,
        gear_ratio,
        ..
    } = &joint.drive;
    for (field, friction, ratio) in [
        ("motor_friction", motor_friction, gear_ratio.abs()),
        ("joint_friction", joint_friction, 1.0),
    ] {
        let (viscous, quadratic) = (friction.viscous, friction.quadratic);
        if quadratic >= 0.0 {
            continue;
        }
        let path = format!("joints[{index}].drive.{field}.quadratic");
        let Some(limit) = joint.limits.velocity else {
            let message = format!("{quadratic:?} must not be negative for a joint without a speed limit");
            findings.error(path, message);
            continue;
        };
        let least = -viscous / (2.0 * ratio * limit);
        if quadratic < least * (1.0 + SLOPE_ROUNDING) {
            let message = format!(
                "{quadratic:?} must be at least {least:?} (viscous {viscous:?} over twice the speed limit {limit:?}), or friction falls with speed"
            );
            findings.error(path, message);
        }
    }
}

fn lay_limits(joint: &mut JointSpec, entry: &Limits, index: usize, findings: &mut Findings) {
    let has_range = entry.position_lower.is_some() || entry.position_upper.is_some();
    if has_range && joint.kind == JointKind::Continuous {
        // Cables end what bearings would allow.
        joint.kind = JointKind::Revolute;
        findings.warn(format!(
            "joint {}: continuous in the URDF, revolute with the position limits of its entry",
            quoted(&joint.name)
        ));
    }
    let limits = &mut joint.limits;
    for (value, stated) in [
        (&mut limits.position_lower, entry.position_lower),
        (&mut limits.position_upper, entry.position_upper),
        (&mut limits.velocity, entry.velocity),
        (&mut limits.acceleration, entry.acceleration),
        (&mut limits.deceleration, entry.deceleration),
        (&mut limits.jerk, entry.jerk),
        (&mut limits.preset_acceleration, entry.preset_acceleration),
        (&mut limits.preset_deceleration, entry.preset_deceleration),
    ] {
        *value = stated.or(*value);
    }
    if let (Some(lower), Some(upper)) = (limits.position_lower, limits.position_upper)
        && lower > upper
    {
        let field = if entry.position_lower.is_some() {
            "position_lower"
        } else {
            "position_upper"
        };
        findings.error(
            format!("joints[{index}].limits.{field}"),
            format!("lower limit {lower:?} must be at most upper limit {upper:?}"),
        );
    }
}

fn lay_drive(drive: &mut Drive, entry: &DriveEntry) {
    drive.peak_torque = entry.peak_torque.or(drive.peak_torque);
    drive.rated_torque = entry.rated_torque.or(drive.rated_torque);
    drive.gear_ratio = entry.gear_ratio.unwrap_or(drive.gear_ratio);
    drive.rotor_inertia = entry.rotor_inertia.unwrap_or(drive.rotor_inertia);
    drive.torque_constant = entry.torque_constant.or(drive.torque_constant);
    drive.damping = entry.damping.or(drive.damping);
    if !entry.stiffness.is_empty() {
        drive.stiffness.clone_from(&entry.stiffness);
    }
    lay_friction(&mut drive.motor_friction, entry.motor_friction.as_ref());
    lay_friction(&mut drive.joint_friction, entry.joint_friction.as_ref());
}

/// A Coulomb torque stated for the positive direction alone holds for both.
fn lay_friction(friction: &mut Friction, entry: Option<&FrictionEntry>) {
    let Some(entry) = entry else {
        return;
    };
    friction.viscous = entry.viscous.unwrap_or(friction.viscous);
    friction.coulomb_negative = entry
        .coulomb_negative
        .or(entry.coulomb_positive)
        .unwrap_or(friction.coulomb_negative);
    friction.coulomb_positive = entry.coulomb_positive.unwrap_or(friction.coulomb_positive);
    friction.load_coulomb = entry.load_coulomb.unwrap_or(friction.load_coulomb);
    friction.quadratic = entry.quadratic.unwrap_or(friction.quadratic);
    friction.presliding_stiffness = entry.presliding_stiffness.or(friction.presliding_stiffness);
}
