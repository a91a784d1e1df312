//! One joint on the bench: its transmission's stiffness and damping, its friction at constant speed.

use std::sync::Arc;

use takt_motion::{
    Invalid,
    drive::fit::{
        constant_speed::{ConstantSpeed, ConstantSpeedOutcome, fit_constant_speed},
        damping::{DampingOutcome, fit_damping},
        report::Missing,
        stiffness::{StiffnessOutcome, fit_stiffness},
    },
    robot::spec::{Drive, Friction},
};
use takt_proto::{
    convert,
    v1::{self, fit_drive_request::Fit, fit_drive_response::Outcome},
};
use tracing::Span;

use super::super::{Reading, decode, finite, not_finite, propose::Proposal};
use crate::{error::ServiceError, registry::Compiled};

/// What was found, and what it changes of the drive; nothing where the data cannot tell.
type Found = (Outcome, Option<Box<dyn FnOnce(&mut Drive)>>);

/// Fits one property of one joint.
pub(super) fn fit_joint(
    fit: &Fit,
    mut reading: Reading,
    description: Option<&[u8]>,
) -> Result<v1::FitDriveResponse, ServiceError> {
    let (name, joint) = match fit {
        Fit::Motion(_) => ("motion", ""),
        Fit::Stiffness(wire) => ("stiffness", wire.joint.as_str()),
        Fit::Damping(wire) => ("damping", wire.joint.as_str()),
        Fit::ConstantSpeed(wire) => ("constant_speed", wire.joint.as_str()),
    };
    let joint = reading.convert(|spec, findings| convert::fit::joint(joint, name, spec, findings));
    let (robot, provenance) = reading.checked()?;
    let joint = joint.ok_or_else(|| ServiceError::internal("the request was let through without a joint"))?;
    let named = |list: Vec<Invalid>| {
        let list = list.into_iter();
        ServiceError::invalid(list.map(|found| convert::fit::finding_on_bench(found, name)).collect())
    };
    let (outcome, change) = match fit {
        Fit::Motion(_) => return Err(ServiceError::internal("a motion is of the whole arm")),
        Fit::Stiffness(wire) => stiffness(wire, &robot).map_err(named)?,
        Fit::Damping(wire) => damping(wire, joint, &robot).map_err(named)?,
        Fit::ConstantSpeed(wire) => constant_speed(wire, joint, &robot).map_err(named)?,
    };
    if !finite::bench(&outcome) {
        return Err(not_finite());
    }
    Span::current().record("outcome", if change.is_some() { "fit" } else { "not excited" });
    let description = description.map(decode).transpose()?;
    let proposal = description.zip(change).and_then(|(description, change)| {
        let mut proposal = Proposal::new(description, &robot);
        proposal.change_drive(joint, change);
        proposal.finish(
            "FitDrive",
            format!("{name} of {}", robot.robot.spec().joints[joint].name),
        )
    });
    Ok(v1::FitDriveResponse {
        outcome: Some(outcome),
        proposal,
        provenance: Some(provenance),
    })
}

fn untold(missing: Missing, robot: &Compiled) -> Found {
    let missing = convert::fit::missing_to_wire(&[missing], robot.robot.spec());
    (Outcome::NotExcited(missing), None)
}

fn stiffness(wire: &v1::StiffnessFitRequest, robot: &Arc<Compiled>) -> Result<Found, Vec<Invalid>> {
    let terms = usize::try_from(wire.terms.unwrap_or(1)).unwrap_or(usize::MAX);
    let found = match fit_stiffness(&wire.torque, &wire.deformation, terms)? {
        StiffnessOutcome::Fitted(found) => found,
        StiffnessOutcome::Missing(missing) => return Ok(untold(missing, robot)),
    };
    let answer = convert::fit::stiffness_to_wire(&found, &wire.joint);
    let change = move |drive: &mut Drive| drive.stiffness = found.coefficients;
    Ok((Outcome::Stiffness(answer), Some(Box::new(change))))
}

fn damping(wire: &v1::DampingFitRequest, joint: usize, robot: &Arc<Compiled>) -> Result<Found, Vec<Invalid>> {
    let drive = &robot.robot.spec().joints[joint].drive;
    let inertia = drive.gear_ratio * drive.gear_ratio * drive.rotor_inertia;
    if inertia <= 0.0 {
        let message = "has no rotor inertia in the model, against which its transmission could swing";
        return Err(vec![Invalid::new("joint", message)]);
    }
    let found = match fit_damping(&wire.time_s, &wire.amplitude, inertia)? {
        DampingOutcome::Fitted(found) => found,
        DampingOutcome::Missing(missing) => return Ok(untold(missing, robot)),
    };
    // What the motor's own viscous friction takes is no damping of the transmission.
    let own = drive.gear_ratio * drive.gear_ratio * drive.motor_friction.viscous;
    let damping = (found.viscous - own).max(0.0);
    let answer = convert::fit::damping_to_wire(&found, damping, &wire.joint);
    let change = move |drive: &mut Drive| drive.damping = Some(damping);
    Ok((Outcome::Damping(answer), Some(Box::new(change))))
}

fn constant_speed(
    wire: &v1::ConstantSpeedFitRequest,
    joint: usize,
    robot: &Arc<Compiled>,
) -> Result<Found, Vec<Invalid>> {
    let drive = &robot.robot.spec().joints[joint].drive;
    let runs = convert::fit::runs(&wire.runs);
    let ConstantSpeed { total, sides, warnings } = match fit_constant_speed(&runs, &drive.stiffness)? {
        ConstantSpeedOutcome::Fitted(found) => *found,
        ConstantSpeedOutcome::Missing(missing) => return Ok(untold(missing, robot)),
    };
    let answer = convert::fit::constant_speed_to_wire(&total, sides.as_ref(), warnings, &wire.joint);
    let change = move |drive: &mut Drive| match sides {
        Some((output, motor)) => {
            // Stated at the shaft; terms that were not fitted stay.
            let ratio = drive.gear_ratio.abs();
            drive.motor_friction.viscous = motor.friction.viscous / (ratio * ratio);
            drive.motor_friction.coulomb_positive = motor.friction.coulomb_positive / ratio;
            drive.motor_friction.coulomb_negative = motor.friction.coulomb_negative / ratio;
            drive.joint_friction = basic(output.friction, drive.joint_friction);
        }
        None => {
            drive.motor_friction = basic(Friction::default(), drive.motor_friction);
            drive.joint_friction = basic(total.friction, drive.joint_friction);
        }
    };
    Ok((Outcome::ConstantSpeed(answer), Some(Box::new(change))))
}

/// Viscous and Coulomb friction as found, the other terms as they were.
fn basic(found: Friction, before: Friction) -> Friction {
    Friction {
        viscous: found.viscous,
        coulomb_positive: found.coulomb_positive,
        coulomb_negative: found.coulomb_negative,
        ..before
    }
}
