//! What is wrong with a request, all of it at once. The motion is checked by its planner, the gains by the controller.

use super::request::{Encoder, FrictionTruth, RehearsalRequest};
use crate::error::Invalid;
use crate::plan::Failure;
use crate::robot::Robot;
use crate::tolerance::{DURATION_MAX, FRICTION_SCALE_MAX, REHEARSAL_PERIOD_MAX, REHEARSAL_PERIOD_MIN, WRENCHES_MAX};

pub(super) fn check(robot: &Robot, request: &RehearsalRequest) -> Result<(), Failure> {
    let mut wrong = Vec::new();
    let mut find = |path: String, message: String| wrong.push(Invalid::new(path, message));
    let period = request.period;
    if !(REHEARSAL_PERIOD_MIN..=REHEARSAL_PERIOD_MAX).contains(&period) {
        let message = format!("{period} must be from {REHEARSAL_PERIOD_MIN} to {REHEARSAL_PERIOD_MAX}");
        find("period_s".to_owned(), message);
    }
    if !(0.0..=DURATION_MAX).contains(&request.settle) {
        let message = format!("{} must be from 0 to {DURATION_MAX}", request.settle);
        find("settle_s".to_owned(), message);
    }
    if request.trace_every == Some(0) {
        find("trace_every".to_owned(), "0 must be at least 1".to_owned());
    }
    let count = robot.joint_count();
    for (path, length) in [
        ("friction", request.friction.len()),
        ("encoders", request.encoders.len()),
    ] {
        if length != 0 && length != count {
            find(
                path.to_owned(),
                format!("{length} values, the robot has {count} joints"),
            );
        }
    }
    for (joint, truth) in request.friction.iter().enumerate() {
        check_friction(&format!("friction[{joint}]"), truth, &mut find);
    }
    for (joint, encoder) in request.encoders.iter().enumerate() {
        check_encoder(&format!("encoders[{joint}]"), encoder, &mut find);
    }
    if request.wrenches.len() > WRENCHES_MAX {
        let message = format!("{} wrenches, the most is {WRENCHES_MAX}", request.wrenches.len());
        find("wrenches".to_owned(), message);
    }
    for (index, pulse) in request.wrenches.iter().enumerate() {
        let path = format!("wrenches[{index}]");
        let values = pulse.force.iter().chain(pulse.moment.iter());
        if !values.copied().all(f64::is_finite) {
            find(path.clone(), "force and moment must be finite".to_owned());
        }
        if !(pulse.begin.is_finite() && pulse.end.is_finite() && pulse.begin <= pulse.end) {
            let message = format!("it begins at {} and ends at {}", pulse.begin, pulse.end);
            find(path, message);
        }
    }
    if wrong.is_empty() {
        return Ok(());
    }
    Err(Failure::Invalid(wrong))
}

fn check_friction(path: &str, truth: &FrictionTruth, find: &mut impl FnMut(String, String)) {
    for (field, value) in [
        ("coulomb_scale", truth.coulomb_scale),
        ("viscous_scale", truth.viscous_scale),
    ] {
        if !(0.0..=FRICTION_SCALE_MAX).contains(&value) {
            let message = format!("{value} must be from 0 to {FRICTION_SCALE_MAX}");
            find(format!("{path}.{field}"), message);
        }
    }
    for (field, value) in [
        ("coulomb_rate", truth.coulomb_rate),
        ("viscous_rate", truth.viscous_rate),
    ] {
        if !(value.abs() <= FRICTION_SCALE_MAX) {
            let message = format!("{value} must be at most {FRICTION_SCALE_MAX} either way");
            find(format!("{path}.{field}"), message);
        }
    }
}

fn check_encoder(path: &str, encoder: &Encoder, find: &mut impl FnMut(String, String)) {
    for (field, value) in [
        ("motor_step", encoder.motor_step),
        ("motor_noise", encoder.motor_noise),
        ("output_step", encoder.output_step),
        ("output_noise", encoder.output_noise),
    ] {
        if !(0.0..=1.0).contains(&value) {
            let message = format!("{value} must be from 0 to 1 rad or m");
            find(format!("{path}.{field}"), message);
        }
    }
}
