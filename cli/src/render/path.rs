//! The answer to a robot program, for a person at a terminal.

use std::fmt::Write;

use takt_client::v1::{self, PathLimitKind, path_infeasible::Reason};

use super::{
    confidence,
    plan::{margins, warnings},
    table::{Cell, Table, Tone, number, paint},
    words::{self, JointUnit, Units},
};
use crate::io::Terminal;

/// Most limits and blends that are listed: the tightest ones. `--json` has all.
const LISTED: usize = 12;

/// A plan: what it takes, where the time goes, what is tightest.
pub(crate) fn plan(
    plan: &v1::PathPlan,
    provenance: &v1::Provenance,
    robot: &v1::Robot,
    units: Units,
    terminal: Terminal,
) -> String {
    let colour = terminal.colour;
    let mut out = String::new();
    let revision = format!(
        "{} revision {}, takt {}",
        robot.robot_id, provenance.revision, provenance.version
    );
    let robot_fact = ("robot", revision, Tone::Plain);
    for (name, value, tone) in facts(plan).into_iter().chain([robot_fact]) {
        let name = paint(&format!("{name:<10}"), Tone::Bold, colour);
        let _ = writeln!(out, "{name}  {}", paint(&value, tone, colour));
    }
    let nothing = v1::ConfidenceReport::default();
    let tables = [
        segments(plan),
        blends(plan),
        costs(plan),
        limits(plan, robot, units),
        margins(&plan.torque_margins, robot),
        confidence::table(plan.confidence.as_ref().unwrap_or(&nothing), robot),
    ];
    for table in tables.iter().filter(|table| !table.is_empty()) {
        out.push('\n');
        out.push_str(&table.render_for(terminal));
    }
    out.push_str(&warnings(&plan.warnings, colour));
    out
}

/// The lines above the tables: name, value, and how it is meant.
pub(crate) fn facts(plan: &v1::PathPlan) -> Vec<(&'static str, String, Tone)> {
    let way: f64 = plan.segments.iter().map(|segment| segment.tool_length_m).sum();
    let mut facts = vec![
        ("duration", format!("{:.3} s", plan.duration_s), Tone::Bold),
        (
            "path",
            format!(
                "{}, {}, {way:.3} m of the tool as taught, its shape continuous to derivative {}",
                counted(plan.segments.len(), "segment"),
                counted(plan.blends.len(), "blend"),
                plan.continuity
            ),
            Tone::Plain,
        ),
    ];
    // standing still is no limit
    let mut limits = plan
        .limit_costs
        .iter()
        .filter(|cost| cost.kind() != v1::PathLimitKind::Rest);
    if let Some(cost) = limits.next() {
        let part = 100.0 * cost.time_s / plan.duration_s;
        let text = format!(
            "{}: {:.3} s, {part:.0} % of the time",
            limit(cost.kind(), &cost.joint),
            cost.time_s
        );
        facts.push(("limited by", text, Tone::Plain));
    }
    if let Some(constant) = &plan.constant_speed {
        let mut text = format!(
            "{:.4} m/s of {:.4} m/s asked for, {:.4} m/s at the lowest",
            constant.speed_m_per_s, constant.asked_m_per_s, constant.lowest_m_per_s
        );
        if let Some(why) = &constant.lowered {
            let _ = write!(text, "; lowered: {why}");
        }
        facts.push(("tool speed", text, Tone::Plain));
        let worst = constant
            .transitions
            .iter()
            .map(|one| one.deviation_m)
            .fold(0.0, f64::max);
        if worst > 0.0 {
            let text = format!("{:.3} mm at most from the taught path", 1e3 * worst);
            facts.push(("corners", text, Tone::Plain));
        }
    }
    if let Some(report) = &plan.confidence {
        facts.push(confidence::fact(report, Some(plan.duration_s)));
    }
    if let Some(safety) = &plan.override_safe {
        let (text, good) = words::override_safety(safety);
        facts.push(("override", text, if good { Tone::Plain } else { Tone::Bad }));
    }
    let mass = plan.payload.as_ref().and_then(|payload| payload.mass_kg);
    if let Some(mass) = mass.filter(|mass| *mass > 0.0) {
        facts.push(("payload", format!("{mass} kg"), Tone::Plain));
    }
    facts
}

/// A limit in words.
pub(crate) fn limit(kind: PathLimitKind, joint: &str) -> String {
    let what = match kind {
        PathLimitKind::Unspecified => "nothing named",
        PathLimitKind::JointTorque => "torque",
        PathLimitKind::JointVelocity => "speed",
        PathLimitKind::JointAcceleration => "acceleration",
        PathLimitKind::JointJerk => "jerk",
        PathLimitKind::JointPositionLower => "lowest position",
        PathLimitKind::JointPositionUpper => "highest position",
        PathLimitKind::TcpVelocity => "speed of the tool",
        PathLimitKind::TcpAcceleration => "acceleration of the tool",
        PathLimitKind::ToolSpeed => "the tool speed asked for",
        PathLimitKind::Rest => "at rest",
    };
    match joint {
        "" => what.to_owned(),
        joint => format!("{what} of {joint}"),
    }
}

/// A number of things, one or several.
fn counted(count: usize, thing: &str) -> String {
    format!("{count} {thing}{}", if count == 1 { "" } else { "s" })
}

/// Segments as programs count them in messages, from 0.
fn place(location: Option<&v1::PathLocation>) -> String {
    location.map_or_else(
        || "–".to_owned(),
        |place| format!("{} at {:.1} %", place.segment, 100.0 * place.fraction),
    )
}

fn segments(plan: &v1::PathPlan) -> Table {
    let mut table = Table::new(["segment", "from [s]", "to [s]", "takes [s]", "taught [m]"]).numbers_from(1);
    for (index, segment) in plan.segments.iter().enumerate() {
        let takes = segment.end_s - segment.begin_s;
        table.row([
            index.to_string(),
            format!("{:.3}", segment.begin_s),
            format!("{:.3}", segment.end_s),
            format!("{takes:.3}"),
            format!("{:.4}", segment.tool_length_m),
        ]);
    }
    table
}

fn blends(plan: &v1::PathPlan) -> Table {
    let mut table = Table::new([
        "blend after",
        "from [s]",
        "to [s]",
        "off by [mm]",
        "from corner [mm]",
        "shorter because",
    ])
    .numbers_from(1);
    for blend in plan.blends.iter().take(LISTED) {
        table.row([
            blend.segment.to_string(),
            format!("{:.3}", blend.begin_s),
            format!("{:.3}", blend.end_s),
            format!("{:.3}", 1e3 * blend.deviation_m),
            format!("{:.3}", 1e3 * blend.corner_distance_m),
            blend.shrunk.clone().unwrap_or_default(),
        ]);
    }
    table
}

/// Where the time goes.
fn costs(plan: &v1::PathPlan) -> Table {
    let mut table = Table::new(["limit", "holds for [s]", "of the time"]).numbers_from(1);
    for cost in plan.limit_costs.iter().take(LISTED) {
        table.row([
            limit(cost.kind(), &cost.joint),
            format!("{:.3}", cost.time_s),
            format!("{:.1} %", 100.0 * cost.time_s / plan.duration_s),
        ]);
    }
    table
}

/// The unit in which a limit is shown, and the factor from SI to it.
fn unit_of(kind: PathLimitKind, joint: JointUnit) -> (&'static str, f64) {
    match kind {
        PathLimitKind::JointTorque => (joint.torque, 1.0),
        PathLimitKind::JointVelocity => (joint.velocity, joint.factor),
        PathLimitKind::JointAcceleration => (joint.acceleration, joint.factor),
        PathLimitKind::JointJerk => (joint.jerk, joint.factor),
        PathLimitKind::JointPositionLower | PathLimitKind::JointPositionUpper => (joint.position, joint.factor),
        PathLimitKind::TcpVelocity | PathLimitKind::ToolSpeed => ("m/s", 1.0),
        PathLimitKind::TcpAcceleration => ("m/s²", 1.0),
        PathLimitKind::Rest | PathLimitKind::Unspecified => ("", 1.0),
    }
}

/// The tightest moments of what is not torque, which has a table of its own.
fn limits(plan: &v1::PathPlan, robot: &v1::Robot, units: Units) -> Table {
    let mut table = Table::new(["limit", "peak", "allowed", "unit", "margin", "at [s]", "segment"]).numbers_from(1);
    let uses = plan.limit_uses.iter();
    let uses = uses.filter(|one| one.kind() != PathLimitKind::JointTorque);
    for one in uses.take(LISTED) {
        let tone = if one.margin < 0.0 { Tone::Bad } else { Tone::Plain };
        let (unit, factor) = unit_of(one.kind(), units.of(robot, &one.joint));
        table.row([
            Cell::from(limit(one.kind(), &one.joint)),
            Cell::from(number(factor * one.value, 5)),
            Cell::from(number(factor * one.limit, 5)),
            Cell::from(unit),
            Cell::new(format!("{:.1} %", 100.0 * one.margin), tone),
            Cell::from(format!("{:.3}", one.time_s)),
            Cell::from(place(one.location.as_ref())),
        ]);
    }
    table
}

/// A program that cannot be run: the evidence, and what would help.
pub(crate) fn evidence(no: &v1::PathInfeasible, robot: &v1::Robot, colour: bool) -> String {
    let unit = Units::default().of(robot, &no.joint);
    let (reason, unit) = match no.reason() {
        Reason::Unspecified => ("no reason given", ""),
        Reason::OutOfReach => ("a pose is out of reach", ""),
        Reason::Singularity => ("the path meets a singularity that it cannot pass", ""),
        Reason::JointRange => ("a joint would leave its range", unit.position),
        Reason::HoldingTorque => ("the pose cannot be held at rest", unit.torque),
        Reason::MovingTorque => (
            "gravity and friction alone exceed the torque limit on the way",
            unit.torque,
        ),
        Reason::BoundarySpeed => ("no timing keeps every limit at the speed at an end", "m/s or rad/s"),
        Reason::ConstantSpeed => ("the arm cannot follow at the constant speed", ""),
        Reason::NoTiming => ("no timing keeps every limit", ""),
    };
    let mut out = format!("{} {reason}\n\n", paint("infeasible:", Tone::Bad, colour));
    let mut line = |name: &str, value: &str| {
        let _ = writeln!(out, "{}  {value}", paint(&format!("{name:<10}"), Tone::Bold, colour));
    };
    line("where", &format!("segment {}", place(no.location.as_ref())));
    if !no.joint.is_empty() {
        line("joint", &no.joint);
    }
    // How far a pose is out of reach, in m or in rad, is in the remedy.
    if no.reason() != Reason::OutOfReach {
        line("needed", format!("{} {unit}", number(no.needed, 5)).trim_end());
        line("available", format!("{} {unit}", number(no.available, 5)).trim_end());
    }
    if matches!(no.reason(), Reason::HoldingTorque | Reason::MovingTorque) {
        line(
            "of which",
            &format!("{} {unit} are gravity's", number(no.gravity_torque, 5)),
        );
    }
    if let Some(band) = no.band {
        let text = format!("{} {unit} are the band of the confidence", number(band, 5));
        line("and", &text);
    }
    if let Some(mass) = no.feasible_payload_kg {
        line("payload", &format!("up to {} kg would do", number(mass, 4)));
    }
    if let Some(part) = no.reachable_fraction {
        line("reachable", &format!("the first {:.1} % of the segment", 100.0 * part));
    }
    if !no.suggestion.is_empty() {
        line("remedy", &no.suggestion);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::example;

    #[test]
    fn a_plan_says_where_the_time_goes() {
        let text = plan(
            &example::path(),
            &example::provenance(),
            &example::robot(),
            Units::default(),
            example::PAPER,
        );
        for part in [
            "duration    1.000 s",
            "2 segments, 1 blend, 0.500 m of the tool as taught, its shape continuous to derivative 3",
            "limited by  torque of turn: 0.600 s, 60 % of the time",
            "speed of the tool",
            "1 at 25.0 %",
            "arm revision r1, takt 0.1.0",
            "neighbour too short",
        ] {
            assert!(text.contains(part), "{part:?} is not in\n{text}");
        }
        assert!(!text.contains('\x1b'));
    }

    #[test]
    fn a_refusal_says_where_and_what_can_be_reached() {
        let no = v1::PathInfeasible {
            reason: Reason::JointRange.into(),
            location: Some(v1::PathLocation {
                segment: 1,
                fraction: 0.5,
            }),
            joint: "turn".to_owned(),
            needed: 3.2,
            available: 3.0,
            reachable_fraction: Some(0.5),
            suggestion: "turn the part".to_owned(),
            ..Default::default()
        };
        let text = evidence(&no, &example::robot(), false);
        for part in [
            "leave its range",
            "segment 1 at 50.0 %",
            "3.2000 rad",
            "first 50.0 %",
            "turn the part",
        ] {
            assert!(text.contains(part), "{part:?} is not in\n{text}");
        }
    }

    #[test]
    fn nothing_breaks_on_empty_answers() {
        plan(
            &v1::PathPlan::default(),
            &v1::Provenance::default(),
            &v1::Robot::default(),
            Units { degrees: true },
            example::PAPER,
        );
        evidence(&v1::PathInfeasible::default(), &v1::Robot::default(), true);
    }
}
