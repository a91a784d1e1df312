//! What the motors must do along set-points: feed-forward torque and current.

use std::time::Instant;

use takt_motion::{
    Invalid,
    budget::Budget,
    drive::{
        feedforward::{FeedForward, feed_forward},
        reference::Reference,
        rehearse::{outcome::TransmissionRange, request::Motion},
    },
    robot::{Robot, spec::RobotSpec},
};
use takt_proto::{convert::Findings, v1};

use super::{failed, finite, not_finite};
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

/// Computes the feed-forward of a motion that has been planned.
pub(super) fn motors(
    robot: &Robot,
    motion: &Motion,
    period: f64,
    deadline: Instant,
    budget: &Budget<'_>,
) -> Result<Motors, ServiceError> {
    let loaded = match motion {
        Motion::Move(request) => request.payload.as_ref(),
        Motion::Path(request) => request.payload.as_ref(),
        Motion::Setpoints(points) => points.payload.as_ref(),
    };
    let loaded = loaded.map_or_else(|| robot.clone(), |payload| robot.with_payload(payload));
    let reference = Reference::new(robot, motion, period, 0.0, budget).map_err(|failure| failed(failure, deadline))?;
    let reference = reference.map_err(|_| ServiceError::internal("the motion was planned, and cannot be any more"))?;
    feed_forward(&loaded, &reference, budget).map_err(|_| stopped(deadline))
}

/// Adds the motors' columns to the set-points, or says why there are none.
pub(super) fn add(
    motors: &Motors,
    setpoints: &mut Option<v1::Setpoints>,
    warnings: &mut Vec<String>,
    robot: &RobotSpec,
) -> Result<(), ServiceError> {
    let Some(setpoints) = setpoints else {
        return Ok(());
    };
    let forward = match motors {
        Ok(forward) => forward,
        Err(range) => {
            warnings.push(format!(
                "set-points of the motors are left out: the transmission of {} would have to pass {} at {} s, and its \
                 stiffness polynomial rises up to {}",
                robot.joints[range.joint].name, range.torque, range.time, range.largest
            ));
            return Ok(());
        }
    };
    if forward.smoothness.steps != setpoints.time_s.len() {
        return Err(ServiceError::internal(
            "motors and joints have not the same number of set-points",
        ));
    }
    setpoints.exact_motor_points = u32::try_from(forward.smoothness.exact_steps).ok();
    let columns = setpoints.joints.iter_mut().zip(&robot.joints).enumerate();
    for (joint, (columns, spec)) in columns {
        let steps = || forward.desired.iter().skip(joint).step_by(forward.joint_count);
        columns.motor_torque = steps().map(|at| at.motor_torque / spec.drive.gear_ratio).collect();
        columns.motor_current_a = steps().filter_map(|at| at.motor_current).collect();
        if !finite::all(&columns.motor_torque) || !finite::all(&columns.motor_current_a) {
            return Err(not_finite());
        }
    }
    Ok(())
}
