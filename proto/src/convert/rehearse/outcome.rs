//! Writes what a rehearsal found.

use takt_motion::{
    drive::{
        controller::JointGains,
        rehearse::outcome::{
            FrictionFollowed, JointRun, Rehearsal, RehearsalOutcome, Run, RunEnd, Trace, TransmissionRange,
        },
    },
    robot::spec::RobotSpec,
};

use crate::{
    convert::{
        count_to_wire, path,
        plan::{self, name},
    },
    v1::{self, rehearsal_run::End, rehearse_response::Outcome},
};

/// Writes the outcome; names of joints are the robot's.
#[must_use]
pub fn outcome_to_wire(outcome: RehearsalOutcome, robot: &RobotSpec) -> Outcome {
    match outcome {
        RehearsalOutcome::Run(rehearsal) => Outcome::Rehearsal(of_rehearsal(*rehearsal, robot)),
        RehearsalOutcome::MoveInfeasible(refusal) => Outcome::MoveInfeasible(plan::infeasible_to_wire(*refusal, robot)),
        RehearsalOutcome::PathInfeasible(refusal) => Outcome::PathInfeasible(path::infeasible_to_wire(*refusal, robot)),
        RehearsalOutcome::TransmissionRange(range) => Outcome::TransmissionRange(of_range(range, robot)),
    }
}

fn of_range(range: TransmissionRange, robot: &RobotSpec) -> v1::TransmissionRange {
    v1::TransmissionRange {
        joint: name(robot, range.joint),
        time_s: range.time,
        torque: range.torque,
        largest_torque: range.largest,
    }
}

fn of_rehearsal(rehearsal: Rehearsal, robot: &RobotSpec) -> v1::Rehearsal {
    let joints = rehearsal
        .gains
        .iter()
        .enumerate()
        .map(|(index, gains)| v1::RehearsedJoint {
            joint: name(robot, index),
            flexible: rehearsal.flexible.get(index).copied().unwrap_or(false),
            planned_torque: rehearsal.planned_torque.get(index).copied().unwrap_or(0.0),
            gains: Some(of_gains(*gains, name(robot, index))),
        });
    v1::Rehearsal {
        period_s: rehearsal.period,
        duration_s: rehearsal.duration,
        steps: count_to_wire(rehearsal.steps),
        continuity: rehearsal.smoothness.continuity,
        exact_steps: count_to_wire(rehearsal.smoothness.exact_steps),
        joints: joints.collect(),
        plain: Some(of_run(rehearsal.plain, robot)),
        adapted: Some(of_run(rehearsal.adapted, robot)),
        warnings: rehearsal.warnings,
    }
}

fn of_gains(gains: JointGains, joint: String) -> v1::JointGains {
    v1::JointGains {
        joint,
        position: gains.position,
        velocity: gains.velocity,
        torque: gains.torque,
        velocity_filter_rad_per_s: gains.velocity_filter,
    }
}

fn of_run(run: Run, robot: &RobotSpec) -> v1::RehearsalRun {
    let (end, joint, time, range) = match run.end {
        RunEnd::Completed => (End::Completed, None, None, None),
        RunEnd::Diverged { joint, time } => (End::Diverged, Some(joint), Some(time), None),
        RunEnd::TransmissionRange(range) => (End::OutOfRange, Some(range.joint), Some(range.time), Some(range)),
        RunEnd::TooStiff { time } => (End::TooStiff, None, Some(time), None),
    };
    let joints = run.joints.into_iter().enumerate();
    v1::RehearsalRun {
        end: end.into(),
        end_joint: joint.map(|joint| name(robot, joint)),
        end_time_s: time,
        transmission_range: range.map(|range| of_range(range, robot)),
        steps: count_to_wire(run.steps),
        joints: joints
            .map(|(index, joint)| of_joint(joint, name(robot, index)))
            .collect(),
        tool_error_peak_m: run.tool_error_peak,
        tool_error_time_s: run.tool_error_time,
        tool_error_rms_m: run.tool_error_rms,
        tool_angle_peak_rad: run.tool_angle_peak,
        work_j: run.work,
        energy_given_j: run.energy_given,
        trace: run.trace.map(|trace| of_trace(trace, robot)),
    }
}

fn of_joint(run: JointRun, joint: String) -> v1::JointRun {
    let FrictionFollowed {
        truth_rms,
        error_rms,
        error_rms_last,
        points,
    } = run.friction;
    let points = points.into_iter().map(|point| v1::FrictionPoint {
        time_s: point.time,
        assumed_torque: point.assumed,
        true_torque: point.truth,
    });
    v1::JointRun {
        joint,
        position_error_peak: run.error_peak,
        position_error_time_s: run.error_time,
        position_error_rms: run.error_rms,
        position_error_end: run.error_end,
        torque_peak: run.torque_peak,
        torque_time_s: run.torque_time,
        torque_rms: run.torque_rms,
        torque_limit: run.torque_limit,
        margin: run.margin,
        limited_time_s: run.limited_time,
        current_peak_a: run.current_peak,
        current_rms_a: run.current_rms,
        deformation_peak: run.deformation_peak,
        friction_torque_rms: truth_rms,
        friction_torque_error_rms: error_rms,
        friction_torque_error_rms_last: error_rms_last,
        friction: points.collect(),
    }
}

fn of_trace(trace: Trace, robot: &RobotSpec) -> v1::RehearsalTrace {
    let joints = trace.joints.into_iter().enumerate();
    let joints = joints.map(|(index, columns)| v1::RehearsalColumns {
        joint: name(robot, index),
        planned_position: columns.planned_position,
        position: columns.position,
        motor_position: columns.motor_position,
        velocity: columns.velocity,
        motor_torque: columns.motor_torque,
        transmission_torque: columns.transmission_torque,
        assumed_friction_torque: columns.assumed_friction,
        true_friction_torque: columns.true_friction,
    });
    v1::RehearsalTrace {
        time_s: trace.time,
        joints: joints.collect(),
        tool_error_m: trace.tool_error,
    }
}
