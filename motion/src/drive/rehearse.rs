//! A motion run under the controller on the simulated arm before the real one runs it: with the friction, the encoders, the payload
//! and the wrench on the flange that the caller supposes, without adaptation and with it.
//!
//! At every period: positions are measured, the controller steps, its torques act for a period. Errors are q − q_d and the tool's distance
//! from its planned place at the beginning of every period. The true margin of a joint is that of the torque
//! which its controller asked for, limits apart: (T − |τ|)/T.

mod check;
pub mod outcome;
pub mod request;
mod run;
mod sums;

use self::outcome::{Rehearsal, RehearsalOutcome};
use self::request::{FrictionTruth, Motion, RehearsalRequest};
use super::controller::{Adaptation, Controller, default_gains};
use super::feedforward::{FeedForward, Joint, feed_forward};
use super::reference::{NoMotion, Reference};
use crate::budget::Budget;
use crate::plan::Failure;
use crate::robot::Robot;
use crate::tolerance::GAIN_POSES;
use run::Rehearsed;

/// Runs a motion on the simulated arm, without adaptation and with it.
///
/// # Errors
/// A request that is wrong, or a budget that ended. A motion that cannot be planned is not an error: it is an outcome.
pub fn rehearse(robot: &Robot, request: &RehearsalRequest, budget: &Budget<'_>) -> Result<RehearsalOutcome, Failure> {
    check::check(robot, request)?;
    let reference = match Reference::new(robot, &request.motion, request.period, request.settle, budget)? {
        Ok(reference) => reference,
        Err(NoMotion::Move(infeasible)) => return Ok(RehearsalOutcome::MoveInfeasible(infeasible)),
        Err(NoMotion::Path(infeasible)) => return Ok(RehearsalOutcome::PathInfeasible(infeasible)),
    };
    let model = match &reference.payload {
        Some(payload) => robot.with_payload(payload),
        None => robot.clone(),
    };
    let planned = match feed_forward(&model, &reference, budget)? {
        Ok(planned) => planned,
        Err(range) => return Ok(RehearsalOutcome::TransmissionRange(range)),
    };
    let gains = if request.gains.is_empty() {
        default_gains(&model, &poses(&reference), request.period)
    } else {
        request.gains.clone()
    };
    let controller = |adaptation| {
        Controller::new(&model, &gains, &request.current_limits, adaptation, request.period).map_err(Failure::Invalid)
    };
    let (plain, adapted) = (controller(Adaptation::Off)?, controller(request.adaptation)?);
    let truth = match &request.true_payload {
        Some(payload) => model.with_payload(payload),
        None => model.clone(),
    };
    let tcp = match &request.motion {
        Motion::Path(path) => path.tcp.unwrap_or(robot.spec().tcp),
        Motion::Move(_) | Motion::Setpoints(_) => robot.spec().tcp,
    };
    let rehearsed = Rehearsed {
        request,
        truth: &truth,
        planned: &planned,
        tcp,
    };
    let joints = Joint::all(robot);
    Ok(RehearsalOutcome::Run(Box::new(Rehearsal {
        period: request.period,
        duration: reference.duration,
        steps: reference.steps(),
        smoothness: planned.smoothness,
        flexible: joints.iter().map(|joint| joint.transmission.is_some()).collect(),
        gains: gains.clone(),
        adaptation: request.adaptation,
        planned_torque: largest_torques(&planned),
        plain: rehearsed.run(&plain, budget)?,
        adapted: rehearsed.run(&adapted, budget)?,
        warnings: warnings(robot, request, &joints, reference.warnings),
    })))
}

/// Some poses of a motion, evenly spaced.
fn poses(reference: &Reference) -> Vec<Vec<f64>> {
    let stride = reference.steps().div_ceil(GAIN_POSES);
    let steps = (0..reference.steps()).step_by(stride);
    steps
        .map(|step| reference.at(step).iter().map(|state| state[0]).collect())
        .collect()
}

fn largest_torques(planned: &FeedForward) -> Vec<f64> {
    let mut largest = vec![0.0_f64; planned.joint_count];
    for step in planned.desired.chunks(planned.joint_count) {
        for (largest, desired) in largest.iter_mut().zip(step) {
            *largest = largest.max(desired.motor_torque.abs());
        }
    }
    largest
}

fn warnings(robot: &Robot, request: &RehearsalRequest, joints: &[Joint], mut warnings: Vec<String>) -> Vec<String> {
    let scaled = robot.spec().joints.iter().zip(&request.friction);
    let without: Vec<String> = scaled
        .filter(|(spec, truth)| {
            let drive = &spec.drive;
            **truth != FrictionTruth::default() && drive.motor_friction.is_zero() && drive.joint_friction.is_zero()
        })
        .map(|(spec, _)| format!("{:?}", spec.name))
        .collect();
    if !without.is_empty() {
        warnings.push(format!(
            "scaling friction changes nothing where the model has none: {}",
            without.join(", ")
        ));
    }
    for (spec, joint) in robot.spec().joints.iter().zip(joints) {
        if !spec.drive.stiffness.is_empty() && joint.transmission.is_none() {
            let name = &spec.name;
            warnings.push(format!(
                "joint {name:?} has a stiffness but no rotor inertia to swing against: its transmission is taken as rigid"
            ));
        }
    }
    if joints.iter().all(|joint| joint.transmission.is_none()) {
        warnings.push("no transmission of the model flexes: the arm is simulated as rigid".to_owned());
    }
    warnings
}

#[cfg(test)]
mod tests;
