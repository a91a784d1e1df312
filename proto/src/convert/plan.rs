//! Moves and trajectories in, plans and reports out.

use takt_motion::plan::{
    outcome::{
        CheckReport, Fallback, Infeasible, InfeasibleReason, LimitKind, LimitUse, Limiting, LimitingKind, MoveOutcome,
        MovePlan, OverrideSafety, Phase, Setpoints, TorqueMargin,
    },
    request::{CheckRequest, Interpolation, LimitOverride, Method, MoveRequest, Sampling, TrajectoryPoint},
};
use takt_motion::robot::{JOINTS_MAX, spec::RobotSpec};

use super::{Findings, Path, quoted, robot, unknown};
use crate::v1;

const METHODS: &str = "PRESET, ENDPOINT, VERIFIED";
const INTERPOLATIONS: &str = "LINEAR, CUBIC, QUINTIC";

/// Reads a move. The robot, where it is known, says how many joints there are and what they are called.
pub fn move_request(wire: v1::PlanMoveRequest, robot: Option<&RobotSpec>, findings: &mut Findings) -> MoveRequest {
    let at = Path::Root;
    let joint_count = robot.map(|robot| robot.joints.len());
    let start = configuration(wire.start, at.field("start"), joint_count, findings);
    let target = configuration(wire.target, at.field("target"), joint_count, findings);
    let target_velocity = (!wire.target_velocity.is_empty()).then_some(wire.target_velocity);
    if let Some(velocity) = &target_velocity {
        findings.joint_values(at.field("target_velocity"), velocity, joint_count);
    }
    let payload = wire.payload.as_ref();
    if let Some(tool) = &wire.tool {
        robot::tool(tool, at.field("tool"), findings);
    }
    MoveRequest {
        start,
        target,
        target_velocity,
        payload: payload.map(|payload| robot::payload(payload, at.field("payload"), findings)),
        limits: limit_overrides(wire.limits, at.field("limits"), robot, findings),
        torque_utilization: findings.fraction(at.field("torque_utilization"), wire.torque_utilization),
        speed_scale: findings.fraction(at.field("speed_scale"), wire.speed_scale),
        method: method(wire.method, at.field("method"), findings),
        sampling: sampling(wire.sample_period_s, wire.trace_points, findings),
        cycle_time: findings.positive_option(at.field("cycle_time_s"), wire.cycle_time_s, " s"),
    }
}

pub(super) fn configuration(
    wire: Option<v1::JointPosition>,
    at: Path<'_>,
    joint_count: Option<usize>,
    findings: &mut Findings,
) -> Vec<f64> {
    let Some(configuration) = wire else {
        findings.push(at, "must be given");
        return Vec::new();
    };
    findings.joint_values(at.field("position"), &configuration.position, joint_count);
    configuration.position
}

pub(super) fn limit_overrides(
    wire: Vec<v1::LimitOverride>,
    at: Path<'_>,
    robot: Option<&RobotSpec>,
    findings: &mut Findings,
) -> Vec<LimitOverride> {
    let most = robot.map_or(JOINTS_MAX, |robot| robot.joints.len());
    if wire.len() > most {
        findings.push(at, format!("has {} entries, one a joint is {most}", wire.len()));
        return Vec::new();
    }
    let mut limits: Vec<LimitOverride> = Vec::with_capacity(wire.len());
    for (index, limit) in wire.into_iter().enumerate() {
        let at = at.index(index);
        let joint_at = at.field("joint");
        let stranger = robot.filter(|robot| robot.joints.iter().all(|joint| joint.name != limit.joint));
        if limit.joint.is_empty() {
            findings.push(joint_at, "must be given");
        } else if let Some(robot) = stranger {
            let known = robot.joints.iter().map(|joint| joint.name.as_str());
            findings.push(joint_at, unknown("joint", &limit.joint, known));
        } else if limits.iter().any(|other| other.joint == limit.joint) {
            findings.push(joint_at, format!("{} is there twice", quoted(&limit.joint)));
        }
        limits.push(LimitOverride {
            position_lower: findings.finite_option(at.field("position_lower"), limit.position_lower),
            position_upper: findings.finite_option(at.field("position_upper"), limit.position_upper),
            velocity: findings.positive_option(at.field("velocity"), limit.velocity, ""),
            acceleration: findings.positive_option(at.field("acceleration"), limit.acceleration, ""),
            deceleration: findings.positive_option(at.field("deceleration"), limit.deceleration, ""),
            peak_torque: findings.positive_option(at.field("peak_torque"), limit.peak_torque, ""),
            jerk: findings.positive_option(at.field("jerk"), limit.jerk, ""),
            joint: limit.joint,
        });
    }
    limits
}

fn method(wire: Option<i32>, at: Path<'_>, findings: &mut Findings) -> Method {
    let method = wire.and_then(|number| findings.enumerated(at, number, METHODS));
    match method {
        Some(v1::Method::Preset) => Method::Preset,
        Some(v1::Method::Endpoint) => Method::Endpoint,
        Some(v1::Method::Verified | v1::Method::Unspecified) | None => Method::Verified,
    }
}

pub(super) fn sampling(period: Option<f64>, trace_points: Option<u32>, findings: &mut Findings) -> Sampling {
    let at = Path::Root;
    let period = findings.positive_option(at.field("sample_period_s"), period, " s");
    match (period, trace_points) {
        (None, None) => Sampling::None,
        (Some(period), None) => Sampling::Period(period),
        (None, Some(points)) => {
            if points < 2 {
                let message = format!("{points} must be at least 2: the start and the end");
                findings.push(at.field("trace_points"), message);
            }
            Sampling::Trace(usize::try_from(points).unwrap_or(usize::MAX))
        }
        (Some(_), Some(_)) => {
            findings.push(
                at.field("trace_points"),
                "cannot stand beside `sample_period_s`: give one of them",
            );
            Sampling::None
        }
    }
}

/// Reads a trajectory to be checked.
pub fn check_request(
    wire: v1::CheckTrajectoryRequest,
    robot: Option<&RobotSpec>,
    findings: &mut Findings,
) -> CheckRequest {
    let at = Path::Root;
    let (points, interpolation) = trajectory(wire.trajectory, robot, findings);
    let payload = wire.payload.as_ref();
    CheckRequest {
        points,
        interpolation,
        payload: payload.map(|payload| robot::payload(payload, at.field("payload"), findings)),
        limits: limit_overrides(wire.limits, at.field("limits"), robot, findings),
        torque_utilization: findings.fraction(at.field("torque_utilization"), wire.torque_utilization),
        cycle_time: findings.positive_option(at.field("cycle_time_s"), wire.cycle_time_s, " s"),
    }
}

/// Reads the field `trajectory`.
pub(super) fn trajectory(
    wire: Option<v1::Trajectory>,
    robot: Option<&RobotSpec>,
    findings: &mut Findings,
) -> (Vec<TrajectoryPoint>, Option<Interpolation>) {
    let trajectory_at = Path::Root.field("trajectory");
    if wire.is_none() {
        findings.push(trajectory_at, "must be given");
    }
    let trajectory = wire.unwrap_or_default();
    let interpolation = trajectory
        .interpolation
        .and_then(|number| findings.enumerated(trajectory_at.field("interpolation"), number, INTERPOLATIONS));
    let interpolation = interpolation.map(|interpolation| match interpolation {
        v1::Interpolation::Linear => Interpolation::Linear,
        v1::Interpolation::Cubic => Interpolation::Cubic,
        v1::Interpolation::Quintic | v1::Interpolation::Unspecified => Interpolation::Quintic,
    });
    let joint_count = robot.map(|robot| robot.joints.len());
    let points = points(trajectory.points, trajectory_at.field("points"), joint_count, findings);
    (points, interpolation)
}

fn points(
    wire: Vec<v1::TrajectoryPoint>,
    at: Path<'_>,
    joint_count: Option<usize>,
    findings: &mut Findings,
) -> Vec<TrajectoryPoint> {
    let mut before = f64::NEG_INFINITY;
    let points = wire.into_iter().enumerate().map(|(index, point)| {
        let at = at.index(index);
        let time = point.time_s;
        if !time.is_finite() {
            findings.finite(at.field("time_s"), time);
        } else if time < 0.0 {
            findings.push(at.field("time_s"), format!("{time} s must not be negative"));
        } else if time <= before {
            findings.push(
                at.field("time_s"),
                format!("{time} s must be after the point before, {before} s"),
            );
        }
        if time.is_finite() {
            before = time;
        }
        findings.joint_values(at.field("position"), &point.position, joint_count);
        for (name, values) in [("velocity", &point.velocity), ("acceleration", &point.acceleration)] {
            if !values.is_empty() {
                findings.joint_values(at.field(name), values, joint_count);
            }
        }
        TrajectoryPoint {
            time,
            position: point.position,
            velocity: point.velocity,
            acceleration: point.acceleration,
        }
    });
    points.collect()
}

/// Writes the answer to a move.
#[must_use]
pub fn outcome_to_wire(outcome: MoveOutcome, robot: &RobotSpec) -> v1::plan_move_response::Outcome {
    match outcome {
        MoveOutcome::Plan(plan) => v1::plan_move_response::Outcome::Plan(plan_to_wire(*plan, robot)),
        MoveOutcome::Infeasible(refusal) => {
            v1::plan_move_response::Outcome::Infeasible(infeasible_to_wire(refusal, robot))
        }
    }
}

/// The name of a joint.
pub(super) fn name(robot: &RobotSpec, joint: usize) -> String {
    let joint = robot.joints.get(joint);
    joint.map(|joint| joint.name.clone()).unwrap_or_default()
}

fn plan_to_wire(plan: MovePlan, robot: &RobotSpec) -> v1::MovePlan {
    let patterns = plan.patterns.iter().enumerate().map(|(joint, pattern)| v1::Pattern {
        joint: name(robot, joint),
        displacement: pattern.displacement,
        peak_velocity: pattern.peak_velocity,
        acceleration: pattern.acceleration,
        deceleration: pattern.deceleration,
        acceleration_time_s: pattern.acceleration_time,
        cruise_time_s: pattern.cruise_time,
        deceleration_time_s: pattern.deceleration_time,
    });
    let preset_source = if plan.preset_derived {
        v1::move_plan::PresetSource::Derived
    } else {
        v1::move_plan::PresetSource::Given
    };
    v1::MovePlan {
        duration_s: plan.duration,
        preset_duration_s: plan.preset_duration,
        method: method_to_wire(plan.method).into(),
        fallback: fallback_to_wire(plan.fallback).into(),
        patterns: patterns.collect(),
        torque_margins: margins_to_wire(&plan.torque_margins, robot),
        limiting: plan.limiting.as_ref().map(|limiting| limiting_to_wire(limiting, robot)),
        raw_excess: plan.raw_excess,
        raw_duration_s: plan.raw_duration,
        override_safe: plan.override_safe.as_ref().map(|safety| safety_to_wire(safety, robot)),
        setpoints: plan.setpoints.map(|setpoints| setpoints_to_wire(setpoints, robot)),
        warnings: plan.warnings,
        preset_source: preset_source.into(),
        torque_utilization: plan.torque_utilization,
        speed_scale: plan.speed_scale,
        cycle_time_s: plan.cycle_time,
        payload: Some(robot::payload_to_wire(&plan.payload)),
        confidence: None,
    }
}

fn method_to_wire(method: Method) -> v1::Method {
    match method {
        Method::Preset => v1::Method::Preset,
        Method::Endpoint => v1::Method::Endpoint,
        Method::Verified => v1::Method::Verified,
    }
}

fn fallback_to_wire(fallback: Fallback) -> v1::move_plan::Fallback {
    match fallback {
        Fallback::None => v1::move_plan::Fallback::None,
        Fallback::Resynchronized => v1::move_plan::Fallback::Resynchronized,
        Fallback::Rebased => v1::move_plan::Fallback::Rebased,
    }
}

fn phase_to_wire(phase: Phase) -> v1::Phase {
    match phase {
        Phase::Acceleration => v1::Phase::Acceleration,
        Phase::Cruise => v1::Phase::Cruise,
        Phase::Deceleration => v1::Phase::Deceleration,
        Phase::Hold => v1::Phase::Hold,
    }
}

pub(super) fn margins_to_wire(margins: &[TorqueMargin], robot: &RobotSpec) -> Vec<v1::TorqueMargin> {
    let margins = margins.iter().map(|margin| v1::TorqueMargin {
        joint: name(robot, margin.joint),
        limit: margin.limit,
        peak_torque: margin.peak_torque,
        time_s: margin.time,
        phase: phase_to_wire(margin.phase).into(),
        margin: margin.margin,
        rms_torque: margin.rms_torque,
        rated_torque: margin.rated_torque,
        peak_motor_speed: margin.peak_motor_speed,
        peak_power_w: margin.peak_power,
        location: None,
    });
    margins.collect()
}

fn limiting_to_wire(limiting: &Limiting, robot: &RobotSpec) -> v1::Limiting {
    use v1::limiting::Kind;
    let kind = match limiting.kind {
        LimitingKind::Torque => Kind::Torque,
        LimitingKind::Velocity => Kind::Velocity,
        LimitingKind::Acceleration => Kind::AccelerationLimit,
        LimitingKind::Deceleration => Kind::DecelerationLimit,
        LimitingKind::PresetAcceleration => Kind::PresetAcceleration,
    };
    v1::Limiting {
        kind: kind.into(),
        joint: name(robot, limiting.joint),
        time_s: limiting.time,
        phase: phase_to_wire(limiting.phase).into(),
        utilization: limiting.utilization,
    }
}

pub(super) fn safety_to_wire(safety: &OverrideSafety, robot: &RobotSpec) -> v1::OverrideSafety {
    v1::OverrideSafety {
        safe: safety.safe,
        worst_override: safety.worst_override,
        joint: name(robot, safety.joint),
        torque: safety.torque,
        limit: safety.limit,
        time_s: safety.time,
    }
}

pub(super) fn setpoints_to_wire(setpoints: Setpoints, robot: &RobotSpec) -> v1::Setpoints {
    let joints = setpoints.joints.into_iter().enumerate();
    let joints = joints.map(|(joint, columns)| v1::JointColumns {
        joint: name(robot, joint),
        position: columns.position,
        velocity: columns.velocity,
        acceleration: columns.acceleration,
        torque: columns.torque,
        ..v1::JointColumns::default()
    });
    v1::Setpoints {
        joints: joints.collect(),
        time_s: setpoints.time,
        ..v1::Setpoints::default()
    }
}

pub(super) fn infeasible_to_wire(refusal: Infeasible, robot: &RobotSpec) -> v1::Infeasible {
    use v1::infeasible::Reason;
    let reason = match refusal.reason {
        InfeasibleReason::HoldingTorque => Reason::HoldingTorque,
        InfeasibleReason::MovingTorque => Reason::MovingTorque,
        InfeasibleReason::NoFeasibleSpeed => Reason::NoFeasibleSpeed,
        InfeasibleReason::NoFeasibleAcceleration => Reason::NoFeasibleAcceleration,
    };
    v1::Infeasible {
        reason: reason.into(),
        joint: name(robot, refusal.joint),
        time_s: refusal.time,
        location: refusal.location,
        needed: refusal.needed,
        available: refusal.available,
        gravity_torque: refusal.gravity_torque,
        suggestion: refusal.suggestion,
        feasible_payload_kg: refusal.feasible_payload,
        band: None,
    }
}

/// Writes the report on a trajectory.
#[must_use]
pub fn report_to_wire(report: CheckReport, robot: &RobotSpec) -> v1::CheckTrajectoryResponse {
    let interpolation = match report.interpolation {
        Interpolation::Linear => v1::Interpolation::Linear,
        Interpolation::Cubic => v1::Interpolation::Cubic,
        Interpolation::Quintic => v1::Interpolation::Quintic,
    };
    let uses = report.limit_uses.iter();
    v1::CheckTrajectoryResponse {
        holds: report.holds,
        duration_s: report.duration,
        torque_margins: margins_to_wire(&report.torque_margins, robot),
        limit_uses: uses.map(|limit| limit_use_to_wire(limit, robot)).collect(),
        override_safe: report
            .override_safe
            .as_ref()
            .map(|safety| safety_to_wire(safety, robot)),
        warnings: report.warnings,
        interpolation: interpolation.into(),
        provenance: None,
        confidence: None,
    }
}

fn limit_use_to_wire(limit: &LimitUse, robot: &RobotSpec) -> v1::LimitUse {
    use v1::limit_use::Limit;
    let kind = match limit.kind {
        LimitKind::Torque => Limit::Torque,
        LimitKind::Velocity => Limit::Velocity,
        LimitKind::Acceleration => Limit::Acceleration,
        LimitKind::Deceleration => Limit::Deceleration,
        LimitKind::PositionLower => Limit::PositionLower,
        LimitKind::PositionUpper => Limit::PositionUpper,
        LimitKind::Jerk => Limit::Jerk,
    };
    v1::LimitUse {
        limit_kind: kind.into(),
        joint: name(robot, limit.joint),
        value: limit.value,
        limit: limit.limit,
        time_s: limit.time,
        excess: limit.excess,
    }
}
