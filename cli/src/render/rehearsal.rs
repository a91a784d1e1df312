//! Rehearsals: both runs side by side.

use std::fmt::Write;

use takt_client::v1::{self, rehearsal_run::End};

use super::{
    curves::{Curve, Curves, JointCurves},
    table::{Cell, Table, Tone, number, paint},
    words::Units,
};
use crate::io::Terminal;

/// What became of it, for a person.
pub(crate) fn report(rehearsal: &v1::Rehearsal, robot: &v1::Robot, terminal: Terminal) -> String {
    let mut table = Table::new([
        "joint",
        "run",
        "error peak",
        "error rms",
        "torque peak",
        "margin",
        "friction off",
        "at the end",
        "current peak",
        "deformation",
    ])
    .numbers_from(2);
    let (plain, adapted) = (joints(&rehearsal.plain), joints(&rehearsal.adapted));
    for (plain, adapted) in plain.iter().zip(adapted) {
        for (run, name, label) in [(plain, plain.joint.as_str(), "model"), (adapted, "", "adapted")] {
            let unit = Units::default().of(robot, &run.joint);
            let torque = |value: f64| format!("{} {}", number(value, 3), unit.torque);
            let margin = match run.margin {
                Some(margin) if margin < 0.0 => Cell::new(format!("{:.1} %", 100.0 * margin), Tone::Bad),
                Some(margin) => Cell::from(format!("{:.1} %", 100.0 * margin)),
                None => Cell::new("unknown", Tone::Dim),
            };
            let current = run.current_peak_a;
            table.row([
                Cell::from(name),
                Cell::from(label),
                Cell::from(format!("{} {}", number(run.position_error_peak, 3), unit.position)),
                Cell::from(format!("{} {}", number(run.position_error_rms, 3), unit.position)),
                Cell::from(torque(run.torque_peak)),
                margin,
                Cell::from(torque(run.friction_torque_error_rms)),
                Cell::from(torque(run.friction_torque_error_rms_last)),
                Cell::from(current.map_or_else(|| "–".to_owned(), |current| format!("{} A", number(current, 3)))),
                Cell::from(format!("{} {}", number(run.deformation_peak, 3), unit.position)),
            ]);
        }
    }
    let mut out = table.render_for(terminal);
    for line in facts(rehearsal) {
        let _ = writeln!(out, "{line}");
    }
    for warning in &rehearsal.warnings {
        let _ = writeln!(out, "{} {warning}", paint("warning:", Tone::Bold, terminal.colour));
    }
    out
}

fn joints(run: &Option<v1::RehearsalRun>) -> &[v1::JointRun] {
    run.as_ref().map_or(&[], |run| &run.joints)
}

/// What is said of the runs as a whole.
pub(crate) fn facts(rehearsal: &v1::Rehearsal) -> Vec<String> {
    let mut lines = vec![format!(
        "{:.3} s, {} steps of {} ms; the motor's acceleration is exact at {} of them, at the others its transmission counts as stiff",
        rehearsal.duration_s,
        rehearsal.steps,
        number(1e3 * rehearsal.period_s, 4),
        rehearsal.exact_steps
    )];
    let rigid: Vec<&str> = rehearsal
        .joints
        .iter()
        .filter(|joint| !joint.flexible)
        .map(|joint| joint.joint.as_str())
        .collect();
    if !rigid.is_empty() {
        lines.push(format!(
            "rigid, as the model has no stiffness or no rotor inertia of them: {}",
            rigid.join(", ")
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
                limit: None,
            }
        };
        JointCurves {
            joint: plain.joint.clone(),
            velocity: curve("off, model's friction", plain),
            torque: curve("off, adapted", adapted),
            switches: None,
        }
    });
    Some(Curves {
        joints: joints.collect(),
        time: plain.time_s.clone(),
    })
}
