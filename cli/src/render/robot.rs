//! Registered arms, for a person at a terminal.

use std::fmt::Write;

use takt_client::v1;

use super::table::{Table, Tone, number, paint};

/// One line a robot.
pub(crate) fn list(robots: &[v1::Robot], colour: bool) -> String {
    let mut table = Table::new(["robot", "revision", "joints", "warnings"]).numbers_from(2);
    for robot in robots {
        table.row([
            robot.robot_id.clone(),
            robot.revision.clone(),
            robot.joints.len().to_string(),
            robot.warnings.len().to_string(),
        ]);
    }
    table.render(colour)
}

/// A robot with its joints.
pub(crate) fn show(robot: &v1::Robot, colour: bool) -> String {
    let mut out = format!(
        "{} revision {}\n\n",
        paint(&robot.robot_id, Tone::Bold, colour),
        robot.revision
    );
    let mut limits = Table::new([
        "joint",
        "type",
        "lower",
        "upper",
        "velocity",
        "acceleration",
        "deceleration",
        "jerk",
        "preset ±",
    ])
    .numbers_from(2);
    let mut drives = Table::new([
        "joint",
        "peak torque",
        "rated",
        "gear ratio",
        "rotor [kg m²]",
        "friction: viscous",
        "Coulomb",
        "of load",
        "quadratic",
    ])
    .numbers_from(1);
    for joint in &robot.joints {
        let limit = joint.limits.unwrap_or_default();
        limits.row([
            joint.name.clone(),
            kind(joint.r#type()).to_owned(),
            maybe(limit.position_lower),
            maybe(limit.position_upper),
            maybe(limit.velocity),
            maybe(limit.acceleration),
            maybe(limit.deceleration),
            maybe(limit.jerk),
            preset(&limit, joint.preset_derived),
        ]);
        let drive = joint.drive.clone().unwrap_or_default();
        drives.row([
            joint.name.clone(),
            maybe(drive.peak_torque),
            maybe(drive.rated_torque),
            maybe(drive.gear_ratio),
            drive
                .rotor_inertia_kg_m2
                .map_or_else(dash, |value| format!("{value:e}")),
            sides(&drive, |friction| friction.viscous),
            sides(&drive, |friction| friction.coulomb_positive),
            sides(&drive, |friction| friction.load_coulomb),
            sides(&drive, |friction| friction.quadratic),
        ]);
    }
    out.push_str(&limits.render(colour));
    out.push('\n');
    out.push_str(&drives.render(colour));
    let _ = writeln!(
        out,
        "{}",
        paint(
            "rad or m, seconds, N m or N, at the joint; friction on the side that it is given for (m: motor, j: joint)",
            Tone::Dim,
            colour
        )
    );
    out.push_str(&super::plan::warnings(&robot.warnings, colour));
    out
}

fn kind(kind: v1::JointType) -> &'static str {
    match kind {
        v1::JointType::Unspecified => "",
        v1::JointType::Revolute => "revolute",
        v1::JointType::Prismatic => "prismatic",
        v1::JointType::Continuous => "continuous",
    }
}

fn dash() -> String {
    "–".to_owned()
}

fn maybe(value: Option<f64>) -> String {
    value.map_or_else(dash, |value| number(value, 4))
}

fn preset(limits: &v1::JointLimits, derived: bool) -> String {
    let mark = if derived { " (derived)" } else { "" };
    match (limits.preset_acceleration, limits.preset_deceleration) {
        (Some(up), Some(down)) if up.to_bits() != down.to_bits() => {
            format!("{} / {}{mark}", number(up, 4), number(down, 4))
        }
        (Some(up), _) => format!("{}{mark}", number(up, 4)),
        (None, _) => dash(),
    }
}

fn sides(drive: &v1::Drive, value: fn(&v1::Friction) -> Option<f64>) -> String {
    let text = |friction: &v1::Friction| {
        let side = match friction.side() {
            v1::friction::Side::Motor => " (m)",
            v1::friction::Side::Joint => " (j)",
            v1::friction::Side::Unspecified => "",
        };
        value(friction).map(|value| format!("{value}{side}"))
    };
    let list: Vec<String> = drive.friction.iter().filter_map(text).collect();
    if list.is_empty() { dash() } else { list.join(", ") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::example;

    #[test]
    fn a_robot_shows_joints_limits_and_warnings() {
        let text = show(&example::robot(), false);
        for part in [
            "arm revision r1",
            "revolute",
            "prismatic",
            "-3.000",
            "100.0",
            "warning: link \"a\"",
        ] {
            assert!(text.contains(part), "{part:?} is not in\n{text}");
        }
        assert_eq!(list(&[example::robot()], false).lines().count(), 3);
    }
}
