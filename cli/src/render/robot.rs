//! Registered arms, for a person at a terminal.

use std::fmt::Write;

use takt_client::v1;

use super::{
    table::{Table, Tone, number, paint},
    words::Units,
};

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
pub(crate) fn show(robot: &v1::Robot, description: &v1::RobotDescription, colour: bool) -> String {
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
    let mut drives = Table::new(["joint", "peak torque", "rated", "gear ratio", "rotor [kg m²]"]).numbers_from(1);
    let mut friction = Table::new([
        "joint",
        "friction on",
        "viscous",
        "Coulomb +",
        "Coulomb −",
        "of load",
        "quadratic",
        "presliding",
    ])
    .numbers_from(2);
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
            drive.rotor_inertia_kg_m2.map_or_else(dash, short),
        ]);
        for one in &drive.friction {
            friction.row([
                joint.name.clone(),
                side(one.side()).to_owned(),
                maybe_short(one.viscous),
                maybe_short(one.coulomb_positive),
                maybe_short(one.coulomb_negative.or(one.coulomb_positive)),
                maybe_short(one.load_coulomb),
                maybe_short(one.quadratic),
                maybe_short(one.presliding_stiffness),
            ]);
        }
    }
    out.push_str(&limits.render(colour));
    out.push('\n');
    out.push_str(&drives.render(colour));
    if !friction.is_empty() {
        out.push('\n');
        out.push_str(&friction.render(colour));
    }
    let _ = writeln!(
        out,
        "{}",
        paint(
            "rad or m, seconds, N m or N, at the joint; friction on the side that it is given for",
            Tone::Dim,
            colour
        )
    );
    if let Some(uncertainty) = &description.uncertainty {
        let _ = writeln!(out, "{}", known(uncertainty, robot));
    }
    if let Some(origin) = &description.origin {
        let _ = writeln!(out, "{}", from(origin));
    }
    out.push_str(&super::plan::warnings(&robot.warnings, colour));
    out
}

/// How well the model is known, in short.
fn known(uncertainty: &v1::ModelUncertainty, robot: &v1::Robot) -> String {
    use v1::fitted_parameter::Kind;
    let (mut bodies, mut rotors, mut friction) = (0_u32, 0_u32, 0_u32);
    for parameter in &uncertainty.parameters {
        match parameter.kind() {
            Kind::Unspecified
            | Kind::Mass
            | Kind::FirstMomentX
            | Kind::FirstMomentY
            | Kind::FirstMomentZ
            | Kind::InertiaXx
            | Kind::InertiaYy
            | Kind::InertiaZz
            | Kind::InertiaXy
            | Kind::InertiaXz
            | Kind::InertiaYz => bodies += 1,
            Kind::Armature => rotors += 1,
            Kind::Viscous | Kind::CoulombPositive | Kind::CoulombNegative | Kind::LoadCoulomb | Kind::Quadratic => {
                friction += 1;
            }
        }
    }
    let counts = [(friction, "friction"), (rotors, "rotor"), (bodies, "body")];
    let counts = counts.iter().filter(|(count, _)| *count > 0);
    let counts: Vec<String> = counts.map(|(count, what)| format!("{count} {what}")).collect();
    let residuals = uncertainty.residuals.iter().map(|residual| {
        let torque = Units::default().of(robot, &residual.joint).torque;
        format!("{} {} {torque}", residual.joint, short(residual.deviation))
    });
    let residuals: Vec<String> = residuals.collect();
    format!(
        "uncertainty: covariance of {} parameters, for plans with --confidence; torque that no parameter explains (standard \
         deviation): {}",
        counts.join(", "),
        residuals.join(", ")
    )
}

/// What made the revision, in short.
fn from(origin: &v1::ModelOrigin) -> String {
    let mut text = format!("origin: {}", origin.source);
    if !origin.base_revision.is_empty() {
        let _ = write!(text, " on revision {}", origin.base_revision);
    }
    for line in origin.note.lines() {
        let _ = write!(text, "\n  {line}");
    }
    text
}

/// Digits of a coefficient that are shown: `--description` has all of them.
const DIGITS: i32 = 6;

/// The shortest decimals of six digits: 0.3, and not 0.30000000000000004.
fn short(value: f64) -> String {
    let exponent = value.abs().log10().floor();
    if value == 0.0 || !value.is_finite() {
        return "0".to_owned();
    }
    if !(-4.0..6.0).contains(&exponent) {
        let text = format!("{value:.5e}");
        return match text.split_once('e') {
            Some((digits, power)) => format!("{}e{power}", without_zeros(digits)),
            None => text,
        };
    }
    #[allow(clippy::cast_possible_truncation, reason = "it is between -4 and 5")]
    let decimals = usize::try_from(DIGITS - 1 - exponent as i32).unwrap_or(0);
    without_zeros(&format!("{value:.decimals$}")).to_owned()
}

fn without_zeros(text: &str) -> &str {
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.'),
        false => text,
    }
}

fn maybe_short(value: Option<f64>) -> String {
    value.map_or_else(dash, short)
}

fn side(side: v1::friction::Side) -> &'static str {
    match side {
        v1::friction::Side::Motor => "the motor",
        v1::friction::Side::Joint => "the joint",
        v1::friction::Side::Unspecified => "",
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::example;

    #[test]
    fn a_robot_shows_joints_limits_and_warnings() {
        let text = show(&example::robot(), &v1::RobotDescription::default(), false);
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

    #[test]
    fn numbers_are_as_short_as_they_can_be() {
        for (value, text) in [
            (0.1 + 0.2, "0.3"),
            (12.0, "12"),
            (1.1e-4, "0.00011"),
            (3.0000000000000004e-7, "3e-7"),
            (-0.123_456_789, "-0.123457"),
            (123_456.7, "123457"),
            (2.5e7, "2.5e7"),
            (0.0, "0"),
        ] {
            assert_eq!(short(value), text);
        }
    }

    #[test]
    fn both_directions_the_uncertainty_and_the_origin_are_shown() {
        let mut robot = example::robot();
        let name = robot.joints[0].name.clone();
        robot.joints[0].drive.get_or_insert_default().friction = vec![v1::Friction {
            side: v1::friction::Side::Joint.into(),
            viscous: Some(0.1 + 0.2),
            coulomb_positive: Some(4.0),
            coulomb_negative: Some(3.5),
            load_coulomb: Some(0.06),
            quadratic: Some(0.5),
            presliding_stiffness: Some(9000.0),
        }];
        let description = v1::RobotDescription {
            uncertainty: Some(v1::ModelUncertainty {
                parameters: vec![v1::FittedParameter {
                    joint: name.clone(),
                    kind: v1::fitted_parameter::Kind::Viscous.into(),
                }],
                covariance: vec![0.1],
                residuals: vec![v1::JointResidual {
                    joint: name,
                    deviation: 0.25,
                    ..Default::default()
                }],
            }),
            origin: Some(v1::ModelOrigin {
                source: "FitDrive".to_owned(),
                base_revision: "r0".to_owned(),
                note: "new gear".to_owned(),
            }),
            ..Default::default()
        };
        let text = show(&robot, &description, false);
        for part in [
            "Coulomb −",
            "3.5",
            "0.06",
            "9000",
            " 0.3 ",
            "covariance of 1 friction parameters",
            "0.25 N",
            "origin: FitDrive on revision r0",
            "new gear",
        ] {
            assert!(text.contains(part), "{part:?} is not in\n{text}");
        }
        assert!(!text.contains("0.300000"), "{text}");
    }
}
