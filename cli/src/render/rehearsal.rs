//! Rehearsals: both runs side by side.

use std::fmt::Write;

use takt_client::v1::{self, rehearsal_run::End};

use super::{
    curves::{Curve, Curves, JointCurves, Limit, Subject},
    table::{Cell, Table, Tone, number, paint},
    words::Units,
};
use crate::io::Terminal;

/// What became of it, for a person.
pub(crate) fn report(rehearsal: &v1::Rehearsal, robot: &v1::Robot, units: Units, terminal: Terminal) -> String {
    let mut out = table(rehearsal, robot, units).render_for(terminal);
    out.push_str(LEGEND);
    out.push('\n');
    for line in facts(rehearsal) {
        let _ = writeln!(out, "{line}");
    }
    for warning in &rehearsal.warnings {
        let _ = writeln!(out, "{} {warning}", paint("warning:", Tone::Bold, terminal.colour));
    }
    out
}

/// What the columns mean.
const LEGEND: &str = "\
friction: what the controller takes it for, the model's or adapted while it runs. error: the joint's position less the planned one
margin: (limit − largest torque asked for)/limit; planned: of the plan, with the model's friction. at limit: time that the limit cut it off
friction off: assumed less true friction, rms; at the end: the same over the last quarter
";

/// Both runs of every joint. Columns of what the model does not have are left out.
fn table(rehearsal: &v1::Rehearsal, robot: &v1::Robot, units: Units) -> Table {
    let (plain, adapted) = (joints(&rehearsal.plain), joints(&rehearsal.adapted));
    let has_current = plain.iter().any(|run| run.current_peak_a.is_some());
    let flexes = rehearsal.joints.iter().any(|joint| joint.flexible);
    let mut head = vec![
        "joint",
        "friction",
        "error peak",
        "error rms",
        "margin",
        "planned",
        "at limit",
        "torque peak",
        "friction off",
        "at the end",
    ];
    head.extend(has_current.then_some("current peak"));
    head.extend(flexes.then_some("deformation"));
    let mut table = Table::new(head).numbers_from(2);
    for ((joint, plain), adapted) in rehearsal.joints.iter().zip(plain).zip(adapted) {
        for (run, name, label) in [(plain, plain.joint.as_str(), "model"), (adapted, "", "adapted")] {
            let unit = units.of(robot, &run.joint);
            let position = |value: f64| format!("{} {}", number(unit.factor * value, 3), unit.position);
            let torque = |value: f64| format!("{} {}", number(value, 3), unit.torque);
            let planned = run
                .torque_limit
                .filter(|limit| *limit > 0.0)
                .map(|limit| (limit - joint.planned_torque.abs()) / limit);
            let limited = run.limited_time_s;
            let mut row = vec![
                Cell::from(name),
                Cell::from(label),
                Cell::from(position(run.position_error_peak)),
                Cell::from(position(run.position_error_rms)),
                margin(run.margin),
                Cell::new(planned.map_or_else(|| "unknown".to_owned(), percent), Tone::Dim),
                if limited > 0.0 {
                    Cell::new(format!("{limited:.3} s"), Tone::Bad)
                } else {
                    Cell::new("–", Tone::Dim)
                },
                Cell::from(torque(run.torque_peak)),
                Cell::from(torque(run.friction_torque_error_rms)),
                Cell::from(torque(run.friction_torque_error_rms_last)),
            ];
            if has_current {
                let current = run.current_peak_a.map(|current| format!("{} A", number(current, 3)));
                row.push(current.map_or_else(|| Cell::new("–", Tone::Dim), Cell::from));
            }
            if flexes {
                row.push(Cell::from(position(run.deformation_peak)));
            }
            table.row(row);
        }
    }
    table
}

fn percent(part: f64) -> String {
    format!("{:.1} %", 100.0 * part)
}

fn margin(margin: Option<f64>) -> Cell {
    match margin {
        Some(margin) if margin < 0.0 => Cell::new(percent(margin), Tone::Bad),
        Some(margin) => Cell::from(percent(margin)),
        None => Cell::new("unknown", Tone::Dim),
    }
}

fn joints(run: &Option<v1::RehearsalRun>) -> &[v1::JointRun] {
    run.as_ref().map_or(&[], |run| &run.joints)
}

/// What is said of the runs as a whole.
pub(crate) fn facts(rehearsal: &v1::Rehearsal) -> Vec<String> {
    let (flexible, rigid): (Vec<_>, Vec<_>) = rehearsal.joints.iter().partition(|joint| joint.flexible);
    let steps = format!(
        "{:.3} s, {} steps of {} ms",
        rehearsal.duration_s,
        rehearsal.steps,
        number(1e3 * rehearsal.period_s, 4)
    );
    // Where every joint is rigid a warning of the service says so, and the motors accelerate as their joints do.
    let mut lines = match flexible.is_empty() {
        true => vec![steps],
        false => vec![format!(
            "{steps}; the motor's acceleration is exact at {} of them, at the others its transmission counts as stiff",
            rehearsal.exact_steps
        )],
    };
    if !flexible.is_empty() && !rigid.is_empty() {
        let names: Vec<&str> = rigid.iter().map(|joint| joint.joint.as_str()).collect();
        lines.push(format!(
            "rigid, as the model has no stiffness or no rotor inertia of them: {}",
            names.join(", ")
        ));
    }
    for (run, label) in [
        (&rehearsal.plain, "model's friction"),
        (&rehearsal.adapted, "adapted friction"),
    ] {
        let Some(run) = run else { continue };
        lines.push(format!(
            "{label}: tool off by at most {} mm, {} mm rms; work {} J{}",
            number(1e3 * run.tool_error_peak_m, 3),
            number(1e3 * run.tool_error_rms_m, 3),
            number(run.work_j, 4),
            ended(run)
        ));
    }
    lines
}

fn ended(run: &v1::RehearsalRun) -> String {
    let time = run.end_time_s.unwrap_or(0.0);
    let joint = run.end_joint.as_deref().unwrap_or_default();
    match run.end() {
        End::Unspecified | End::Completed => String::new(),
        End::Diverged => format!("; ENDED at {time:.3} s: {joint} left its motion"),
        End::OutOfRange => format!("; ENDED at {time:.3} s: the transmission of {joint} is beyond its polynomial"),
        End::TooStiff => format!("; ENDED at {time:.3} s: too stiff to be simulated"),
    }
}

/// A plan whose torque a transmission does not reach.
pub(crate) fn range(range: &v1::TransmissionRange, robot: &v1::Robot, colour: bool) -> String {
    let unit = Units::default().of(robot, &range.joint).torque;
    format!(
        "{} the transmission of {} would have to pass {} {unit} at {:.3} s; its stiffness polynomial rises up to {} {unit}\n",
        paint("not possible:", Tone::Bad, colour),
        range.joint,
        number(range.torque, 4),
        range.time_s,
        number(range.largest_torque, 4)
    )
}

/// How far the joints are from the plan, without and with adaptation; `None` where there are no traces.
pub(crate) fn curves(rehearsal: &v1::Rehearsal, robot: &v1::Robot, units: Units) -> Option<Curves> {
    let plain = rehearsal.plain.as_ref()?.trace.as_ref()?;
    let adapted = rehearsal.adapted.as_ref()?.trace.as_ref()?;
    let joints = plain.joints.iter().zip(&adapted.joints).map(|(plain, adapted)| {
        let unit = units.of(robot, &plain.joint);
        let curve = |name, columns: &v1::RehearsalColumns| {
            let pairs = columns.position.iter().zip(&columns.planned_position);
            Curve {
                name,
                unit: unit.position,
                values: pairs.map(|(is, planned)| unit.factor * (is - planned)).collect(),
                limit: Limit::None,
            }
        };
        JointCurves {
            joint: plain.joint.clone(),
            left: curve("off, model's friction", plain),
            right: curve("off, adapted", adapted),
            switches: None,
        }
    });
    Some(Curves {
        joints: joints.collect(),
        time: plain.time_s.clone(),
        tool: None,
        subject: Subject::Rehearsal,
    })
}
