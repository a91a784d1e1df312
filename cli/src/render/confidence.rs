//! What a confidence cost, for a person at a terminal.

use takt_client::v1;

use super::{
    table::{Cell, Table, Tone, aligned},
    words::{self, Units},
};

/// In a line: what holds, and what it cost. `duration_s`: of the plan that holds it; `None` for a check.
pub(crate) fn fact(report: &v1::ConfidenceReport, duration_s: Option<f64>) -> (&'static str, String, Tone) {
    let asked = report.confidence.unwrap_or_default();
    let over = match asked.over() {
        v1::confidence::Over::Move => "of all joints throughout the motion",
        v1::confidence::Over::Sample | v1::confidence::Over::Unspecified => "of any one sample",
    };
    let level = level(asked.level);
    let verdict = if report.holds { "holds" } else { "does not hold" };
    let mut text = format!("{verdict} torque limits at {level} {over}");
    if let (Some(duration), Some(nominal)) = (duration_s, report.nominal_duration_s) {
        let cost = 1e3 * (duration - nominal);
        text += &format!("; {cost:.1} ms longer than the {nominal:.3} s without");
    }
    ("confidence", text, if report.holds { Tone::Plain } else { Tone::Bad })
}

/// A level in percent, as it was typed.
fn level(level: f64) -> String {
    let percent = format!("{:.6}", 100.0 * level);
    format!("{} %", percent.trim_end_matches('0').trim_end_matches('.'))
}

/// One row a joint: its tightest moment, band included.
pub(crate) fn table(report: &v1::ConfidenceReport, robot: &v1::Robot) -> Table {
    let joints = &report.joints;
    let unit = words::common(
        joints
            .iter()
            .map(|joint| Units::default().of(robot, &joint.joint).torque),
    );
    let column = |value: fn(&v1::JointConfidence) -> f64| {
        let values = joints.iter().map(|joint| Some(value(joint)));
        aligned(&values.collect::<Vec<_>>())
    };
    let (torques, bands) = (column(|joint| joint.torque), column(|joint| joint.band));
    let (limits, asides) = (column(|joint| joint.limit), column(|joint| joint.set_aside));
    let mut table = Table::new([
        "joint".to_owned(),
        format!("torque [{unit}]"),
        "band ±".to_owned(),
        "limit".to_owned(),
        "margin at confidence".to_owned(),
        "at [s]".to_owned(),
        "set aside".to_owned(),
    ])
    .numbers_from(1);
    for (index, joint) in joints.iter().enumerate() {
        let tone = if joint.margin < 0.0 { Tone::Bad } else { Tone::Plain };
        table.row([
            Cell::from(joint.joint.clone()),
            Cell::from(torques[index].clone()),
            Cell::from(bands[index].clone()),
            Cell::from(limits[index].clone()),
            Cell::new(format!("{:.1} %", 100.0 * joint.margin), tone),
            Cell::from(format!("{:.3}", joint.time_s)),
            Cell::from(asides[index].clone()),
        ]);
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::example;

    fn report() -> v1::ConfidenceReport {
        v1::ConfidenceReport {
            confidence: Some(v1::Confidence {
                level: 0.95,
                over: Some(v1::confidence::Over::Move.into()),
            }),
            holds: true,
            nominal_duration_s: Some(0.9),
            joints: vec![v1::JointConfidence {
                joint: "turn".to_owned(),
                limit: 100.0,
                torque: -90.0,
                band: 8.0,
                margin: 0.02,
                time_s: 0.25,
                set_aside: 8.1,
                ..Default::default()
            }],
        }
    }

    #[test]
    fn a_cost_is_said_in_time_and_torque() {
        let (name, text, _) = fact(&report(), Some(1.0));
        assert_eq!(name, "confidence");
        for part in ["95 % of all joints", "100.0 ms longer", "0.900 s"] {
            assert!(text.contains(part), "{part:?} is not in {text}");
        }
        let text = table(&report(), &example::robot()).render_for(example::PAPER);
        for part in ["turn", "-90.00", "8.000", "2.0 %", "8.100"] {
            assert!(text.contains(part), "{part:?} is not in\n{text}");
        }
    }

    #[test]
    fn nothing_breaks_on_an_empty_report() {
        let report = v1::ConfidenceReport::default();
        fact(&report, None);
        assert!(table(&report, &v1::Robot::default()).is_empty());
    }
}
