//! A small synthetic plan for the tests of this module.

use takt_client::v1;

use crate::io::Terminal;

/// Plain text of any width.
pub(crate) const PAPER: Terminal = Terminal {
    width: 100,
    table_width: None,
    colour: false,
    error_colour: false,
};

pub(crate) const TIMES: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];

/// Two joints, one that turns and one that slides.
pub(crate) fn robot() -> v1::Robot {
    let joint = |name: &str, kind: v1::JointType, velocity: f64, torque: f64| v1::JointSummary {
        name: name.to_owned(),
        r#type: kind.into(),
        limits: Some(v1::JointLimits {
            position_lower: Some(-3.0),
            position_upper: Some(3.0),
            velocity: Some(velocity),
            ..Default::default()
        }),
        drive: Some(v1::Drive {
            peak_torque: Some(torque),
            ..Default::default()
        }),
        preset_derived: true,
    };
    v1::Robot {
        robot_id: "arm".to_owned(),
        revision: "r1".to_owned(),
        joints: vec![
            joint("turn", v1::JointType::Revolute, 2.0, 100.0),
            joint("slide", v1::JointType::Prismatic, 1.0, 50.0),
        ],
        warnings: vec!["link \"a\" has no mass".to_owned()],
    }
}

fn columns(joint: &str, reach: f64, torque: f64) -> v1::JointColumns {
    v1::JointColumns {
        joint: joint.to_owned(),
        position: TIMES.map(|time| reach * time).into(),
        velocity: [0.0, 1.0, 1.0, 1.0, 0.0].map(|part| part * reach).into(),
        acceleration: [4.0, 0.0, 0.0, 0.0, -4.0].map(|part| part * reach).into(),
        torque: [1.0, 0.5, 0.4, 0.3, -0.8].map(|part| part * torque).into(),
        ..Default::default()
    }
}

fn margin(joint: &str, limit: f64, peak: f64) -> v1::TorqueMargin {
    v1::TorqueMargin {
        joint: joint.to_owned(),
        limit,
        peak_torque: peak,
        time_s: 0.0,
        phase: v1::Phase::Acceleration.into(),
        margin: (limit - peak.abs()) / limit,
        rms_torque: peak / 2.0,
        rated_torque: None,
        peak_motor_speed: 120.0,
        peak_power_w: 300.0,
        location: None,
    }
}

pub(crate) fn plan() -> v1::MovePlan {
    let pattern = |joint: &str, reach: f64| v1::Pattern {
        joint: joint.to_owned(),
        displacement: reach,
        peak_velocity: reach,
        acceleration: 4.0 * reach,
        deceleration: 4.0 * reach,
        acceleration_time_s: 0.25,
        cruise_time_s: 0.5,
        deceleration_time_s: 0.25,
    };
    v1::MovePlan {
        duration_s: 1.0,
        preset_duration_s: Some(1.25),
        method: v1::Method::Verified.into(),
        fallback: v1::move_plan::Fallback::None.into(),
        patterns: vec![pattern("turn", 1.5), pattern("slide", -0.5)],
        torque_margins: vec![margin("turn", 100.0, 97.5), margin("slide", 50.0, -20.0)],
        limiting: Some(v1::Limiting {
            kind: v1::limiting::Kind::Torque.into(),
            joint: "turn".to_owned(),
            time_s: 0.0,
            phase: v1::Phase::Acceleration.into(),
            utilization: 0.975,
        }),
        raw_excess: 0.04,
        raw_duration_s: 0.9,
        override_safe: Some(v1::OverrideSafety {
            safe: true,
            worst_override: 0.5,
            ..Default::default()
        }),
        setpoints: Some(v1::Setpoints {
            time_s: TIMES.into(),
            joints: vec![columns("turn", 1.5, 97.5), columns("slide", -0.5, -20.0)],
            ..Default::default()
        }),
        warnings: vec!["jerk limits do not apply".to_owned()],
        preset_source: v1::move_plan::PresetSource::Derived.into(),
        torque_utilization: 1.0,
        speed_scale: 1.0,
        cycle_time_s: 1.0,
        payload: Some(v1::Payload {
            mass_kg: Some(2.0),
            ..Default::default()
        }),
        confidence: None,
    }
}

pub(crate) fn provenance() -> v1::Provenance {
    v1::Provenance {
        revision: "r1".to_owned(),
        version: "0.1.0".to_owned(),
        request_hash: "h".to_owned(),
    }
}

/// A program of two segments with a blend between them.
pub(crate) fn path() -> v1::PathPlan {
    use v1::PathLimitKind;
    let location = Some(v1::PathLocation {
        segment: 1,
        fraction: 0.25,
    });
    let segment = |begin_s: f64, end_s: f64| v1::SegmentReport {
        begin_s,
        end_s,
        tool_length_m: 0.25,
    };
    let cost = |kind: PathLimitKind, joint: &str, time_s: f64| v1::LimitCost {
        kind: kind.into(),
        joint: joint.to_owned(),
        time_s,
    };
    v1::PathPlan {
        duration_s: 1.0,
        continuity: 3,
        segments: vec![segment(0.0, 0.5), segment(0.5, 1.0)],
        blends: vec![v1::BlendReport {
            begin_s: 0.4,
            end_s: 0.6,
            deviation_m: 0.002,
            corner_distance_m: 0.003,
            shrunk: Some("neighbour too short".to_owned()),
            ..Default::default()
        }],
        torque_margins: plan().torque_margins,
        limit_uses: vec![v1::PathLimitUse {
            kind: PathLimitKind::TcpVelocity.into(),
            value: 0.5,
            limit: 0.5,
            time_s: 0.3,
            location,
            ..Default::default()
        }],
        limit_costs: vec![
            cost(PathLimitKind::JointTorque, "turn", 0.6),
            cost(PathLimitKind::TcpVelocity, "", 0.4),
        ],
        setpoints: plan().setpoints,
        torque_utilization: 1.0,
        speed_scale: 1.0,
        ..Default::default()
    }
}
