//! The answer to a move, for a person at a terminal.

use std::fmt::Write;

use takt_client::v1;

use super::{
    confidence,
    table::{Cell, Table, Tone, aligned, paint},
    words::{self, JointUnit, Units},
};
use crate::io::Terminal;

/// Below this margin a joint is marked as tight.
const TIGHT: f64 = 0.02;

/// A plan: what it takes, what limits it, and the margins of every joint.
pub(crate) fn plan(
    plan: &v1::MovePlan,
    provenance: &v1::Provenance,
    robot: &v1::Robot,
    units: Units,
    terminal: Terminal,
) -> String {
    let colour = terminal.colour;
    let mut out = String::new();
    for (name, value, tone) in facts(plan) {
        let _ = writeln!(
            out,
            "{}  {}",
            paint(&format!("{name:<10}"), Tone::Bold, colour),
            paint(&value, tone, colour)
        );
    }
    let revision = format!(
        "{} revision {}, takt {}",
        robot.robot_id, provenance.revision, provenance.version
    );
    let _ = writeln!(out, "{}  {revision}", paint("robot     ", Tone::Bold, colour));
    out.push('\n');
    out.push_str(&motion(plan, robot, units).render_for(terminal));
    let margins = margins(&plan.torque_margins, robot);
    if !margins.is_empty() {
        out.push('\n');
        out.push_str(&margins.render_for(terminal));
    }
    if let Some(report) = &plan.confidence {
        out.push('\n');
        out.push_str(&confidence::table(report, robot).render_for(terminal));
    }
    out.push_str(&warnings(&plan.warnings, colour));
    out
}

/// The lines above the tables: name, value, and how it is meant.
pub(crate) fn facts(plan: &v1::MovePlan) -> Vec<(&'static str, String, Tone)> {
    let mut facts = vec![(
        "duration",
        format!("{:.3} s  ({} method)", plan.duration_s, words::method(plan.method())),
        Tone::Bold,
    )];
    facts.push(("preset", against_preset(plan), Tone::Plain));
    if let Some(limiting) = &plan.limiting {
        facts.push(("limited by", words::limiting(limiting), Tone::Plain));
    }
    if plan.raw_excess > 0.0 {
        let cost = 1e3 * (plan.duration_s - plan.raw_duration_s);
        let text = format!(
            "the raw plan broke a limit by {:.1} %; holding it cost {cost:.1} ms",
            100.0 * plan.raw_excess
        );
        facts.push(("slowed", text, Tone::Plain));
    }
    match plan.fallback() {
        v1::move_plan::Fallback::Resynchronized => {
            facts.push(("fallback", "all ends synchronized again".to_owned(), Tone::Plain));
        }
        v1::move_plan::Fallback::Rebased => {
            facts.push((
                "fallback",
                "the slowest failing joint set the common time".to_owned(),
                Tone::Plain,
            ));
        }
        v1::move_plan::Fallback::None | v1::move_plan::Fallback::Unspecified => {}
    }
    if let Some(report) = &plan.confidence {
        facts.push(confidence::fact(report, Some(plan.duration_s)));
    }
    if let Some(safety) = &plan.override_safe {
        let (text, good) = words::override_safety(safety);
        facts.push(("override", text, if good { Tone::Plain } else { Tone::Bad }));
    }
    if let Some(mass) = plan
        .payload
        .as_ref()
        .and_then(|payload| payload.mass_kg)
        .filter(|mass| *mass > 0.0)
    {
        facts.push(("payload", format!("{mass} kg"), Tone::Plain));
    }
    if plan.torque_utilization < 1.0 || plan.speed_scale < 1.0 {
        let text = format!(
            "{:.0} % of the torque, {:.0} % of the speed may be used",
            100.0 * plan.torque_utilization,
            100.0 * plan.speed_scale
        );
        facts.push(("restrained", text, Tone::Plain));
    }
    facts
}

/// What was won against the conventional pattern.
pub(crate) fn against_preset(plan: &v1::MovePlan) -> String {
    let derived = match plan.preset_source() {
        v1::move_plan::PresetSource::Derived => ", its accelerations derived from the torque limits",
        v1::move_plan::PresetSource::Given | v1::move_plan::PresetSource::Unspecified => "",
    };
    let Some(preset) = plan.preset_duration_s else {
        return "unknown: a joint that moves has no preset acceleration".to_owned();
    };
    let won = 1.0 - plan.duration_s / preset;
    let verdict = match won {
        won if !won.is_finite() => String::new(),
        won if won.abs() < 5e-4 => ": as long".to_owned(),
        won if won > 0.0 => format!(": {:.1} % of it saved", 100.0 * won),
        won => format!(": {:.1} % longer than it, which does not check torques", -100.0 * won),
    };
    format!("{preset:.3} s by the conventional pattern{derived}{verdict}")
}

fn limits_of<'r>(robot: &'r v1::Robot, joint: &str) -> Option<&'r v1::JointLimits> {
    robot
        .joints
        .iter()
        .find(|summary| summary.name == joint)?
        .limits
        .as_ref()
}

/// One row a joint: how it moves.
fn motion(plan: &v1::MovePlan, robot: &v1::Robot, units: Units) -> Table {
    let list: Vec<JointUnit> = plan
        .patterns
        .iter()
        .map(|pattern| units.of(robot, &pattern.joint))
        .collect();
    let (move_unit, speed_unit) = (
        words::common(list.iter().map(|unit| unit.position)),
        words::common(list.iter().map(|unit| unit.velocity)),
    );
    let column = |value: fn(&v1::Pattern) -> f64| {
        let values = plan
            .patterns
            .iter()
            .zip(&list)
            .map(|(pattern, unit)| Some(unit.factor * value(pattern)));
        aligned(&values.collect::<Vec<_>>())
    };
    let (moves, speeds) = (
        column(|pattern| pattern.displacement),
        column(|pattern| pattern.peak_velocity),
    );
    let (up, down) = (
        column(|pattern| pattern.acceleration),
        column(|pattern| pattern.deceleration),
    );
    let mut table = Table::new([
        "joint".to_owned(),
        format!("move [{move_unit}]"),
        format!("peak speed [{speed_unit}]"),
        "of limit".to_owned(),
        "accel. [/s²]".to_owned(),
        "decel. [/s²]".to_owned(),
        "up, cruise, down [s]".to_owned(),
    ])
    .numbers_from(1);
    for (index, pattern) in plan.patterns.iter().enumerate() {
        let limit = limits_of(robot, &pattern.joint).and_then(|limits| limits.velocity);
        let used = limit.map_or_else(
            || "–".to_owned(),
            |limit| format!("{:.1} %", 100.0 * pattern.peak_velocity.abs() / limit),
        );
        table.row([
            pattern.joint.clone(),
            moves[index].clone(),
            speeds[index].clone(),
            used,
            up[index].clone(),
            down[index].clone(),
            format!(
                "{:.3}  {:.3}  {:.3}",
                pattern.acceleration_time_s, pattern.cruise_time_s, pattern.deceleration_time_s
            ),
        ]);
    }
    table
}

/// One row a joint: its tightest moment.
pub(crate) fn margins(margins: &[v1::TorqueMargin], robot: &v1::Robot) -> Table {
    let unit = words::common(
        margins
            .iter()
            .map(|margin| Units::default().of(robot, &margin.joint).torque),
    );
    let column = |value: fn(&v1::TorqueMargin) -> Option<f64>| aligned(&margins.iter().map(value).collect::<Vec<_>>());
    let (peaks, limits) = (
        column(|margin| Some(margin.peak_torque)),
        column(|margin| Some(margin.limit)),
    );
    let (rms, rated) = (
        column(|margin| Some(margin.rms_torque)),
        column(|margin| margin.rated_torque),
    );
    let (speeds, powers) = (
        column(|margin| Some(margin.peak_motor_speed)),
        column(|margin| Some(margin.peak_power_w)),
    );
    let mut table = Table::new([
        "joint".to_owned(),
        format!("peak [{unit}]"),
        "limit".to_owned(),
        "margin".to_owned(),
        "at [s]".to_owned(),
        "while".to_owned(),
        "RMS".to_owned(),
        "rated".to_owned(),
        "motor rad/s".to_owned(),
        "W".to_owned(),
    ])
    .numbers_from(1);
    for (index, margin) in margins.iter().enumerate() {
        let tone = match margin.margin {
            part if part < 0.0 => Tone::Bad,
            part if part < TIGHT => Tone::Bold,
            _ => Tone::Plain,
        };
        let hot = margin.rated_torque.is_some_and(|rated| margin.rms_torque.abs() > rated);
        table.row([
            Cell::from(margin.joint.clone()),
            Cell::from(peaks[index].clone()),
            Cell::from(limits[index].clone()),
            Cell::new(format!("{:.1} %", 100.0 * margin.margin), tone),
            Cell::from(format!("{:.3}", margin.time_s)),
            Cell::from(words::phase(margin.phase())),
            Cell::new(rms[index].clone(), if hot { Tone::Bad } else { Tone::Plain }),
            Cell::from(rated[index].clone()),
            Cell::from(speeds[index].clone()),
            Cell::from(powers[index].clone()),
        ]);
    }
    table
}

/// The warnings, one a line, after an empty one.
pub(crate) fn warnings(warnings: &[String], colour: bool) -> String {
    let mut out = String::new();
    for (index, warning) in warnings.iter().enumerate() {
        let start = if index == 0 { "\n" } else { "" };
        let _ = writeln!(out, "{start}{} {warning}", paint("warning:", Tone::Bold, colour));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::example;

    fn row<'t>(text: &'t str, joint: &str, nth: usize) -> &'t str {
        text.lines().filter(|line| line.starts_with(joint)).nth(nth).unwrap()
    }

    #[test]
    fn a_plan_says_what_it_takes_what_was_won_and_what_limits_it() {
        let text = plan(
            &example::plan(),
            &example::provenance(),
            &example::robot(),
            Units::default(),
            example::PAPER,
        );
        for part in [
            "duration    1.000 s  (verified method)",
            "1.250 s by the conventional pattern, its accelerations derived from the torque limits: 20.0 % of it saved",
            "torque of turn at 0.000 s, speeding up (97.5 % used)",
            "broke a limit by 4.0 %; holding it cost 100.0 ms",
            "move [rad or m]",
            "peak [N m or N]",
            "warning: jerk limits do not apply",
            "arm revision r1, takt 0.1.0",
            "payload     2 kg",
        ] {
            assert!(text.contains(part), "{part:?} is not in\n{text}");
        }
        assert!(row(&text, "turn", 0).contains("75.0 %"), "of the speed limit: {text}");
        assert!(row(&text, "turn", 1).contains("2.5 %"), "torque margin: {text}");
        assert!(!text.contains('\x1b'));
    }

    #[test]
    fn degrees_are_labelled() {
        let text = plan(
            &example::plan(),
            &example::provenance(),
            &example::robot(),
            Units { degrees: true },
            example::PAPER,
        );
        assert!(text.contains("move [deg or m]"), "{text}");
        assert!(row(&text, "turn", 0).contains("85.94"), "{text}");
    }

    #[test]
    fn nothing_breaks_on_empty_answers() {
        plan(
            &v1::MovePlan::default(),
            &v1::Provenance::default(),
            &v1::Robot::default(),
            Units::default(),
            example::PAPER,
        );
    }
}
