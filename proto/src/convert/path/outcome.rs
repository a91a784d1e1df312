//! A timed path with its proof, or the evidence why there is none.

use std::ops::Range;

use takt_motion::{
    path::outcome::{
        BlendReport, ConstantSpeedReport, LimitCost, LimitingStretch, Location, PathInfeasible, PathInfeasibleReason,
        PathLimit, PathLimitUse, PathOutcome, PathPlan, PathSetpoints, SegmentReport, TransitionReport,
    },
    plan::outcome::Setpoints,
    robot::spec::RobotSpec,
};

use crate::{
    convert::{count_to_wire, plan, robot},
    v1,
};

/// Writes the answer to a program.
#[must_use]
pub fn outcome_to_wire(outcome: PathOutcome, robot: &RobotSpec) -> v1::plan_path_response::Outcome {
    match outcome {
        PathOutcome::Plan(plan) => v1::plan_path_response::Outcome::Plan(plan_to_wire(*plan, robot)),
        PathOutcome::Infeasible(refusal) => {
            v1::plan_path_response::Outcome::Infeasible(infeasible_to_wire(refusal, robot))
        }
    }
}

fn plan_to_wire(plan: PathPlan, robot: &RobotSpec) -> v1::PathPlan {
    let mut torque_margins = plan::margins_to_wire(&plan.torque_margins, robot);
    for (wire, margin) in torque_margins.iter_mut().zip(&plan.torque_margins) {
        let same = |limit: &&PathLimitUse| limit.kind == PathLimit::Torque && limit.joint == Some(margin.joint);
        let found = plan.limit_uses.iter().find(same);
        wire.location = found.map(|limit| location_to_wire(limit.location));
    }
    let safety = plan.override_safe.as_ref();
    v1::PathPlan {
        duration_s: plan.duration,
        continuity: plan.continuity,
        segments: plan.segments.iter().map(segment_to_wire).collect(),
        blends: plan.blends.into_iter().map(blend_to_wire).collect(),
        torque_margins,
        limit_uses: plan.limit_uses.iter().map(|limit| use_to_wire(limit, robot)).collect(),
        limiting: plan
            .limiting
            .iter()
            .map(|stretch| stretch_to_wire(stretch, robot))
            .collect(),
        limit_costs: plan.limit_costs.iter().map(|cost| cost_to_wire(cost, robot)).collect(),
        constant_speed: plan.constant_speed.map(constant_speed_to_wire),
        override_safe: safety.map(|safety| plan::safety_to_wire(safety, robot)),
        setpoints: plan.setpoints.map(|setpoints| setpoints_to_wire(setpoints, robot)),
        warnings: plan.warnings,
        torque_utilization: plan.torque_utilization,
        speed_scale: plan.speed_scale,
        payload: Some(robot::payload_to_wire(&plan.payload)),
        confidence: None,
    }
}

fn location_to_wire(location: Location) -> v1::PathLocation {
    v1::PathLocation {
        segment: count_to_wire(location.segment),
        fraction: location.fraction,
    }
}

/// The name of a joint; empty where it is the tool.
fn joint_or_tool(robot: &RobotSpec, joint: Option<usize>) -> String {
    joint.map(|joint| plan::name(robot, joint)).unwrap_or_default()
}

fn segment_to_wire(segment: &SegmentReport) -> v1::SegmentReport {
    v1::SegmentReport {
        begin_s: segment.begin,
        end_s: segment.end,
        tool_length_m: segment.tool_length,
    }
}

fn blend_to_wire(blend: BlendReport) -> v1::BlendReport {
    v1::BlendReport {
        segment: count_to_wire(blend.segment),
        begin: Some(location_to_wire(blend.begin)),
        end: Some(location_to_wire(blend.end)),
        begin_s: blend.begin_time,
        end_s: blend.end_time,
        deviation_m: blend.deviation,
        corner_distance_m: blend.corner_distance,
        shrunk: blend.shrunk,
    }
}

fn kind_to_wire(kind: PathLimit) -> i32 {
    use v1::PathLimitKind as Wire;
    let kind = match kind {
        PathLimit::Torque => Wire::JointTorque,
        PathLimit::Velocity => Wire::JointVelocity,
        PathLimit::Acceleration => Wire::JointAcceleration,
        PathLimit::Jerk => Wire::JointJerk,
        PathLimit::PositionLower => Wire::JointPositionLower,
        PathLimit::PositionUpper => Wire::JointPositionUpper,
        PathLimit::ToolVelocity => Wire::TcpVelocity,
        PathLimit::ToolAcceleration => Wire::TcpAcceleration,
        PathLimit::ConstantSpeed => Wire::ToolSpeed,
        PathLimit::Rest => Wire::Rest,
    };
    kind.into()
}

fn use_to_wire(limit: &PathLimitUse, robot: &RobotSpec) -> v1::PathLimitUse {
    v1::PathLimitUse {
        kind: kind_to_wire(limit.kind),
        joint: joint_or_tool(robot, limit.joint),
        value: limit.value,
        limit: limit.limit,
        margin: limit.margin,
        time_s: limit.time,
        location: Some(location_to_wire(limit.location)),
    }
}

fn stretch_to_wire(stretch: &LimitingStretch, robot: &RobotSpec) -> v1::LimitingStretch {
    v1::LimitingStretch {
        begin_s: stretch.begin,
        end_s: stretch.end,
        kind: kind_to_wire(stretch.kind),
        joint: joint_or_tool(robot, stretch.joint),
        location: Some(location_to_wire(stretch.location)),
    }
}

fn cost_to_wire(cost: &LimitCost, robot: &RobotSpec) -> v1::LimitCost {
    v1::LimitCost {
        kind: kind_to_wire(cost.kind),
        joint: joint_or_tool(robot, cost.joint),
        time_s: cost.time,
    }
}

fn constant_speed_to_wire(report: ConstantSpeedReport) -> v1::ConstantSpeedReport {
    v1::ConstantSpeedReport {
        asked_m_per_s: report.asked,
        speed_m_per_s: report.speed,
        lowered: report.lowered,
        lowest_m_per_s: report.lowest,
        transitions: report.transitions.iter().map(transition_to_wire).collect(),
    }
}

fn transition_to_wire(transition: &TransitionReport) -> v1::TransitionReport {
    v1::TransitionReport {
        segment: transition.segment.map(count_to_wire),
        begin_s: transition.begin_time,
        end_s: transition.end_time,
        deviation_m: transition.deviation,
        velocity_jump_m_per_s: transition.velocity_jump,
        acceleration_jump_m_per_s2: transition.acceleration_jump,
        lowest_m_per_s: transition.lowest_speed,
    }
}

fn setpoints_to_wire(setpoints: PathSetpoints, robot: &RobotSpec) -> v1::Setpoints {
    let locations = &setpoints.locations;
    v1::Setpoints {
        segment: locations
            .iter()
            .map(|location| count_to_wire(location.segment))
            .collect(),
        fraction: locations.iter().map(|location| location.fraction).collect(),
        tool_speed_m_per_s: setpoints.tool_speed,
        ..plan::setpoints_to_wire(setpoints.samples, robot)
    }
}

/// The set-points of either kind of plan, to be written piece by piece.
#[derive(Debug, Clone, PartialEq)]
pub enum SetpointsOf {
    /// Of a move.
    Move(Setpoints),
    /// Of a path.
    Path(PathSetpoints),
}

impl SetpointsOf {
    fn samples(&self) -> &Setpoints {
        match self {
            Self::Move(setpoints) => setpoints,
            Self::Path(setpoints) => &setpoints.samples,
        }
    }

    /// How many there are.
    #[must_use]
    pub fn count(&self) -> usize {
        self.samples().time.len()
    }

    /// Writes a piece; what lies beyond the end is left out.
    #[must_use]
    pub fn piece_to_wire(&self, piece: Range<usize>, robot: &RobotSpec) -> v1::Setpoints {
        let samples = self.samples();
        let joints = samples
            .joints
            .iter()
            .enumerate()
            .map(|(joint, columns)| v1::JointColumns {
                joint: plan::name(robot, joint),
                position: part(&columns.position, &piece),
                velocity: part(&columns.velocity, &piece),
                acceleration: part(&columns.acceleration, &piece),
                torque: part(&columns.torque, &piece),
                ..v1::JointColumns::default()
            });
        let mut wire = v1::Setpoints {
            time_s: part(&samples.time, &piece),
            joints: joints.collect(),
            ..v1::Setpoints::default()
        };
        if let Self::Path(setpoints) = self {
            let locations = part(&setpoints.locations, &piece);
            wire.segment = locations
                .iter()
                .map(|location| count_to_wire(location.segment))
                .collect();
            wire.fraction = locations.iter().map(|location| location.fraction).collect();
            wire.tool_speed_m_per_s = part(&setpoints.tool_speed, &piece);
        }
        wire
    }
}

fn part<T: Clone>(column: &[T], piece: &Range<usize>) -> Vec<T> {
    let end = piece.end.min(column.len());
    column.get(piece.start.min(end)..end).unwrap_or_default().to_vec()
}

pub(in crate::convert) fn infeasible_to_wire(refusal: PathInfeasible, robot: &RobotSpec) -> v1::PathInfeasible {
    use v1::path_infeasible::Reason;
    let reason = match refusal.reason {
        PathInfeasibleReason::OutOfReach => Reason::OutOfReach,
        PathInfeasibleReason::Singularity => Reason::Singularity,
        PathInfeasibleReason::JointRange => Reason::JointRange,
        PathInfeasibleReason::HoldingTorque => Reason::HoldingTorque,
        PathInfeasibleReason::MovingTorque => Reason::MovingTorque,
        PathInfeasibleReason::BoundarySpeed => Reason::BoundarySpeed,
        PathInfeasibleReason::ConstantSpeed => Reason::ConstantSpeed,
        PathInfeasibleReason::NoTiming => Reason::NoTiming,
    };
    v1::PathInfeasible {
        reason: reason.into(),
        location: Some(location_to_wire(refusal.location)),
        joint: joint_or_tool(robot, refusal.joint),
        needed: refusal.needed,
        available: refusal.available,
        gravity_torque: refusal.gravity_torque,
        feasible_payload_kg: refusal.feasible_payload,
        reachable_fraction: refusal.reachable_fraction,
        suggestion: refusal.suggestion,
        band: None,
    }
}
