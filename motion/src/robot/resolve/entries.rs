//! The entries of `joints`, before they meet the chain.

use std::collections::HashMap;

use crate::robot::bounds::{
    ACCELERATION, DAMPING, FRICTION, GEAR_RATIO, JERK, LOAD_COULOMB, MAX_JOINT_ENTRIES, MAX_STIFFNESS_TERMS, POSITION,
    PRESLIDING_STIFFNESS, QUADRATIC_FRICTION, ROTOR_INERTIA, STIFFNESS, TORQUE, TORQUE_CONSTANT, VELOCITY,
};
use crate::robot::chain::Chain;
use crate::robot::description::{DriveEntry, FrictionEntry, JointEntry};
use crate::robot::findings::{Findings, listed, quoted};
use crate::robot::spec::Limits;

/// Checks every number; whether all are sound.
pub(super) fn check(entries: &[JointEntry], findings: &mut Findings) -> bool {
    if entries.len() > MAX_JOINT_ENTRIES {
        findings.error(
            "joints",
            format!("{} entries must be at most {MAX_JOINT_ENTRIES}", entries.len()),
        );
        return false;
    }
    let mut own = Findings::default();
    for (index, entry) in entries.iter().enumerate() {
        check_limits(&format!("joints[{index}].limits"), &entry.limits, &mut own);
        check_drive(&format!("joints[{index}].drive"), &entry.drive, &mut own);
    }
    match own.finish(Some(())) {
        Ok(_) => true,
        Err(errors) => {
            findings.extend_errors(errors);
            false
        }
    }
}

fn check_limits(path: &str, limits: &Limits, findings: &mut Findings) {
    for (field, value, bound) in [
        ("position_lower", limits.position_lower, &POSITION),
        ("position_upper", limits.position_upper, &POSITION),
        ("velocity", limits.velocity, &VELOCITY),
        ("acceleration", limits.acceleration, &ACCELERATION),
        ("deceleration", limits.deceleration, &ACCELERATION),
        ("jerk", limits.jerk, &JERK),
        ("preset_acceleration", limits.preset_acceleration, &ACCELERATION),
        ("preset_deceleration", limits.preset_deceleration, &ACCELERATION),
    ] {
        findings.check_some(format!("{path}.{field}"), value, bound);
    }
}

fn check_drive(path: &str, drive: &DriveEntry, findings: &mut Findings) {
    for (field, value, bound) in [
        ("peak_torque", drive.peak_torque, &TORQUE),
        ("rated_torque", drive.rated_torque, &TORQUE),
        ("rotor_inertia_kg_m2", drive.rotor_inertia, &ROTOR_INERTIA),
        ("torque_constant_nm_per_a", drive.torque_constant, &TORQUE_CONSTANT),
        ("damping", drive.damping, &DAMPING),
    ] {
        findings.check_some(format!("{path}.{field}"), value, bound);
    }
    if let Some(ratio) = drive.gear_ratio
        && let Some(fault) = GEAR_RATIO.fault(ratio.abs())
    {
        findings.error(
            format!("{path}.gear_ratio"),
            format!("{ratio:?}: its magnitude {fault}"),
        );
    }
    check_friction(
        &format!("{path}.motor_friction"),
        drive.motor_friction.as_ref(),
        findings,
    );
    check_friction(
        &format!("{path}.joint_friction"),
        drive.joint_friction.as_ref(),
        findings,
    );
    let path = format!("{path}.stiffness");
    if drive.stiffness.len() > MAX_STIFFNESS_TERMS {
        let count = drive.stiffness.len();
        findings.error(
            path,
            format!("{count} coefficients must be at most {MAX_STIFFNESS_TERMS}"),
        );
        return;
    }
    for (index, value) in drive.stiffness.iter().enumerate() {
        findings.check(format!("{path}[{index}]"), *value, &STIFFNESS);
    }
    if let Some(linear) = drive.stiffness.first()
        && *linear <= 0.0
    {
        findings.error(format!("{path}[0]"), format!("{linear:?} must be positive"));
    }
}

fn check_friction(path: &str, friction: Option<&FrictionEntry>, findings: &mut Findings) {
    let Some(friction) = friction else {
        return;
    };
    for (field, value, bound) in [
        ("viscous", friction.viscous, &FRICTION),
        ("coulomb_positive", friction.coulomb_positive, &FRICTION),
        ("coulomb_negative", friction.coulomb_negative, &FRICTION),
        ("load_coulomb", friction.load_coulomb, &LOAD_COULOMB),
        ("quadratic", friction.quadratic, &QUADRATIC_FRICTION),
        (
            "presliding_stiffness",
            friction.presliding_stiffness,
            &PRESLIDING_STIFFNESS,
        ),
    ] {
        findings.check_some(format!("{path}.{field}"), value, bound);
    }
}

/// Per joint of the chain the index of its entry; `None` where an entry names no joint or one that has an entry.
pub(super) fn by_joint(entries: &[JointEntry], chain: &Chain, findings: &mut Findings) -> Option<Vec<Option<usize>>> {
    if entries.len() > MAX_JOINT_ENTRIES {
        return None;
    }
    let names = || chain.joints.iter().map(|joint| joint.name.as_str());
    let joint_of: HashMap<&str, usize> = names().zip(0..).collect();
    let mut entry_of = vec![None; chain.joints.len()];
    let mut is_sound = true;
    for (index, entry) in entries.iter().enumerate() {
        let path = format!("joints[{index}].name");
        let Some(joint) = joint_of.get(entry.name.as_str()) else {
            is_sound = false;
            let name = quoted(&entry.name);
            findings.error(path, format!("{name} is not a joint of the chain: {}", listed(names())));
            continue;
        };
        if let Some(first) = entry_of[*joint] {
            is_sound = false;
            let name = quoted(&entry.name);
            findings.error(path, format!("{name} is the name of joints[{first}] too"));
            continue;
        }
        entry_of[*joint] = Some(index);
    }
    is_sound.then_some(entry_of)
}
