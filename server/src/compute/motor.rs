//! What the motors must do along set-points: feed-forward torque and current.

use std::{ops::Range, time::Instant};

use takt_motion::{
    Invalid,
    budget::Budget,
    drive::{
        feedforward::{FeedForward, feed_forward},
        reference::Reference,
        rehearse::outcome::TransmissionRange,
    },
    robot::{
        Robot,
        spec::{Inertial, RobotSpec},
    },
};
use takt_proto::{convert::Findings, v1};

use super::not_finite;
use crate::{error::ServiceError, planner::stopped};

/// What was asked for of the motors.
pub(super) type Motors = Result<FeedForward, TransmissionRange>;

/// Whether set-points of the motors are asked for.
pub(super) fn is_asked(asked: Option<bool>, period: Option<f64>, findings: &mut Findings) -> bool {
    let is_asked = asked.unwrap_or(false);
    if is_asked && period.is_none() {
        let message = "needs `sample_period_s`: motors have set-points on the controller's cycle";
        findings.push_invalid(Invalid::new("motor_setpoints", message));
    }
    is_asked
}

/// Computes the feed-forward along the motion of a plan that carries a payload.
pub(super) fn motors(
    robot: &Robot,
    payload: Option<&Inertial>,
    reference: &Reference,
    deadline: Instant,
    budget: &Budget<'_>,
) -> Result<Motors, ServiceError> {
    let loaded = payload.map_or_else(|| robot.clone(), |payload| robot.with_payload(payload));
    let motors = feed_forward(&loaded, reference, budget).map_err(|_| stopped(deadline))?;
    if let Ok(forward) = &motors {
        let drives = robot.spec().joints.iter().map(|joint| &joint.drive).cycle();
        let is_finite = forward.desired.iter().zip(drives).all(|(at, drive)| {
            (at.motor_torque / drive.gear_ratio).is_finite() && at.motor_current.is_none_or(f64::is_finite)
        });
        if !is_finite {
            return Err(not_finite());
        }
    }
    Ok(motors)
}

/// Adds the motors' columns to all set-points of a plan, or a warning why there are none.
pub(super) fn add_all(
    motors: Option<&Motors>,
    setpoints: &mut Option<v1::Setpoints>,
    warnings: &mut Vec<String>,
    robot: &RobotSpec,
) {
    match (motors, setpoints) {
        (Some(Ok(forward)), Some(setpoints)) => add(forward, 0..setpoints.time_s.len(), setpoints, robot),
        (Some(Err(range)), _) => warnings.push(left_out(range, robot)),
        (Some(Ok(_)) | None, _) => {}
    }
}

/// Adds the motors' columns to set-points, of which they are all or a piece.
pub(super) fn add(forward: &FeedForward, piece: Range<usize>, setpoints: &mut v1::Setpoints, robot: &RobotSpec) {
    let steps = piece.start..piece.end.min(forward.exact.len());
    let exact = forward.exact[steps.clone()].iter().filter(|exact| **exact).count();
    setpoints.exact_motor_points = u32::try_from(exact).ok();
    let columns = setpoints.joints.iter_mut().zip(&robot.joints).enumerate();
    for (joint, (columns, spec)) in columns {
        let desired = || steps.clone().map(|step| &forward.step(step)[joint]);
        columns.motor_torque = desired().map(|at| at.motor_torque / spec.drive.gear_ratio).collect();
        columns.motor_current_a = desired().filter_map(|at| at.motor_current).collect();
    }
}

/// Why motors have no set-points.
fn left_out(range: &TransmissionRange, robot: &RobotSpec) -> String {
    format!(
        "set-points of the motors are left out: the transmission of {} would have to pass {} at {} s, and its stiffness polynomial \
         rises up to {}",
        robot.joints[range.joint].name, range.torque, range.time, range.largest
    )
}
