//! Names and units as people read them.

use takt_client::v1;

/// How joint positions and velocities are shown.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Units {
    /// Angles in degrees instead of rad.
    pub(crate) degrees: bool,
}

/// The unit of one joint, and the factor from SI to it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct JointUnit {
    pub(crate) position: &'static str,
    pub(crate) velocity: &'static str,
    pub(crate) acceleration: &'static str,
    pub(crate) jerk: &'static str,
    pub(crate) torque: &'static str,
    /// From rad or m to what is shown.
    pub(crate) factor: f64,
}

impl Units {
    /// The unit of a joint of this robot; without the robot it cannot be known.
    pub(crate) fn of(self, robot: &v1::Robot, joint: &str) -> JointUnit {
        let known = robot
            .joints
            .iter()
            .find(|summary| summary.name == joint)
            .map(v1::JointSummary::r#type);
        match known {
            Some(v1::JointType::Prismatic) => JointUnit {
                position: "m",
                velocity: "m/s",
                acceleration: "m/s²",
                jerk: "m/s³",
                torque: "N",
                factor: 1.0,
            },
            Some(v1::JointType::Revolute | v1::JointType::Continuous) if self.degrees => JointUnit {
                position: "deg",
                velocity: "deg/s",
                acceleration: "deg/s²",
                jerk: "deg/s³",
                torque: "N m",
                factor: 1.0_f64.to_degrees(),
            },
            Some(v1::JointType::Revolute | v1::JointType::Continuous) => JointUnit {
                position: "rad",
                velocity: "rad/s",
                acceleration: "rad/s²",
                jerk: "rad/s³",
                torque: "N m",
                factor: 1.0,
            },
            _ => JointUnit {
                position: "rad or m",
                velocity: "rad/s or m/s",
                acceleration: "rad/s² or m/s²",
                jerk: "rad/s³ or m/s³",
                torque: "N m or N",
                factor: 1.0,
            },
        }
    }
}

/// The one unit that all joints share, or both.
pub(crate) fn common(units: impl IntoIterator<Item = &'static str>) -> String {
    let mut list: Vec<&str> = Vec::new();
    for unit in units {
        if !list.contains(&unit) {
            list.push(unit);
        }
    }
    list.join(" or ")
}

pub(crate) fn phase(phase: v1::Phase) -> &'static str {
    match phase {
        v1::Phase::Unspecified => "",
        v1::Phase::Acceleration => "speeding up",
        v1::Phase::Cruise => "cruise",
        v1::Phase::Deceleration => "slowing down",
        v1::Phase::Hold => "at rest",
    }
}

pub(crate) fn method(method: v1::Method) -> &'static str {
    match method {
        v1::Method::Unspecified => "unknown",
        v1::Method::Preset => "preset",
        v1::Method::Endpoint => "endpoint",
        v1::Method::Verified => "verified",
    }
}

/// What keeps a move from being faster, as a sentence.
pub(crate) fn limiting(limiting: &v1::Limiting) -> String {
    use v1::limiting::Kind;
    let joint = &limiting.joint;
    let what = match limiting.kind() {
        Kind::Unspecified => return "nothing named".to_owned(),
        Kind::Torque => "torque",
        Kind::Velocity => "speed limit",
        Kind::AccelerationLimit => "acceleration limit",
        Kind::DecelerationLimit => "deceleration limit",
        Kind::PresetAcceleration => "preset acceleration",
    };
    let phase = phase(limiting.phase());
    let phase = if phase.is_empty() {
        String::new()
    } else {
        format!(", {phase}")
    };
    format!(
        "{what} of {joint} at {:.3} s{phase} ({:.1} % used)",
        limiting.time_s,
        100.0 * limiting.utilization
    )
}

/// Why a move cannot be, as a sentence.
pub(crate) fn reason(reason: v1::infeasible::Reason) -> &'static str {
    use v1::infeasible::Reason;
    match reason {
        Reason::Unspecified => "no reason given",
        Reason::HoldingTorque => "the pose cannot be held at rest",
        Reason::MovingTorque => "gravity and friction alone exceed the torque limit on the way",
        Reason::NoFeasibleSpeed => "no speed keeps every limit at once",
        Reason::NoFeasibleAcceleration => "the method finds no acceleration at an end pose",
    }
}

/// What slower speed overrides do, as a sentence, and whether that is good.
pub(crate) fn override_safety(safety: &v1::OverrideSafety) -> (String, bool) {
    if safety.safe {
        let text = match safety.joint.as_str() {
            "" => "every slower speed keeps the torque limits".to_owned(),
            joint => format!(
                "every slower speed keeps the torque limits (tightest: {joint} at {:.0} % speed)",
                100.0 * safety.worst_override
            ),
        };
        return (text, true);
    }
    let text = format!(
        "NOT at every slower speed: at {:.0} % {} needs {:.2} of {:.2} at {:.3} s",
        100.0 * safety.worst_override,
        safety.joint,
        safety.torque.abs(),
        safety.limit,
        safety.time_s
    );
    (text, false)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_follow_the_joint() {
        let joint = |name: &str, kind: v1::JointType| v1::JointSummary {
            name: name.to_owned(),
            r#type: kind.into(),
            ..Default::default()
        };
        let robot = v1::Robot {
            joints: vec![
                joint("turn", v1::JointType::Revolute),
                joint("slide", v1::JointType::Prismatic),
            ],
            ..Default::default()
        };
        let degrees = Units { degrees: true };
        assert_eq!(degrees.of(&robot, "turn").position, "deg");
        assert_eq!(degrees.of(&robot, "slide").position, "m");
        assert_eq!(
            common(["turn", "slide"].map(|name| degrees.of(&robot, name).torque)),
            "N m or N"
        );
    }
}
