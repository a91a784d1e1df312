//! Every set-point by itself: its state against the limits, its torque and tool speed against those of its state.
//!
//! Coulomb friction opposes the motion. Where a joint stands still at a set-point it may have arrived just then, or set
//! out just then, and friction acts against that motion: in the direction in which it moves at the next set-point if it
//! accelerates that way, and in the one in which it moved at the last if it decelerates. An arm that rests must also be
//! held, without friction's help.

use takt_motion::path::outcome::PathLimit;

use super::Case;
use super::report::{Extremes, FaultKind, PathReport, Source};
use super::samples::State;
use crate::arm::Workspace;
use crate::tolerance;

pub(super) fn check(case: &Case<'_>, workspace: &mut Workspace, report: &mut PathReport) {
    let joint_count = case.samples.joints().len();
    let mut extremes = Extremes::new(Source::States, joint_count);
    let mut state = State::default();
    let mut direction = vec![0.0; joint_count];
    let mut torque = vec![0.0; joint_count];
    let columns = case.samples.joints();
    let scales: Vec<f64> = columns.iter().map(|column| largest(&column.torque)).collect();
    let fastest = largest(case.samples.tool_speed());
    for index in 0..case.samples.len() {
        let time = case.samples.times()[index];
        let bounds = &case.bounds[case.samples.locations()[index].segment];
        case.samples.state(index, &mut state);
        let State { q, qd, qdd } = &state;
        direction.copy_from_slice(qd);
        case.arm.drive_torque(workspace, q, qd, qdd, &direction, &mut torque);
        for (joint, bounds) in bounds.joints.iter().enumerate() {
            let mut offer = |kind, value| extremes.joint(kind, joint, value, bounds, time);
            offer(PathLimit::Torque, torque[joint]);
            offer(PathLimit::Velocity, qd[joint]);
            offer(PathLimit::Acceleration, qdd[joint]);
            offer(PathLimit::PositionLower, q[joint]);
            offer(PathLimit::PositionUpper, q[joint]);
            let told = columns[joint].torque[index];
            if (told - torque[joint]).abs() > tolerance::DYNAMICS * scales[joint] {
                report.fault(FaultKind::TorqueColumn, joint, time, told, torque[joint]);
            }
        }
        let tool = case.arm.tool_motion(workspace, &case.tool, q, qd, qdd);
        let speed = tool.velocity.norm();
        extremes.tool(PathLimit::ToolVelocity, speed, bounds, time);
        extremes.tool(PathLimit::ToolAcceleration, tool.acceleration.norm(), bounds, time);
        let told = case.samples.tool_speed()[index];
        if (told - speed).abs() > tolerance::DYNAMICS * fastest {
            report.fault(FaultKind::ToolSpeedColumn, 0, time, told, speed);
        }
        for later in [false, true] {
            if !set_direction(case, index, later, &state, &mut direction) {
                continue;
            }
            case.arm
                .drive_torque(workspace, &state.q, &state.qd, &state.qdd, &direction, &mut torque);
            for (joint, bounds) in bounds.joints.iter().enumerate() {
                extremes.joint(PathLimit::Torque, joint, torque[joint], bounds, time);
            }
        }
        if state.qd.iter().all(|rate| *rate == 0.0) {
            state.qdd.fill(0.0);
            direction.fill(0.0);
            case.arm
                .drive_torque(workspace, &state.q, &state.qd, &state.qdd, &direction, &mut torque);
            for (joint, bounds) in bounds.joints.iter().enumerate() {
                extremes.joint(PathLimit::Torque, joint, torque[joint], bounds, time);
            }
        }
    }
    report.extremes.extend(extremes.found());
}

/// Sets the directions just after or just before a set-point; false where they are those of the set-point itself.
fn set_direction(case: &Case<'_>, index: usize, later: bool, state: &State, direction: &mut [f64]) -> bool {
    let other = if later { index + 1 } else { index.wrapping_sub(1) };
    let mut any = false;
    for (joint, direction) in direction.iter_mut().enumerate() {
        *direction = state.qd[joint];
        if *direction != 0.0 {
            continue;
        }
        let Some(beside) = case.samples.joints()[joint].velocity.get(other) else {
            continue;
        };
        // Just after, the joint moves the way it accelerates; just before, the other way.
        let gain = if later { state.qdd[joint] } else { -state.qdd[joint] };
        if *beside != 0.0 && gain * beside >= 0.0 {
            *direction = *beside;
            any = true;
        }
    }
    any
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, value| most.max(value.abs()))
}
