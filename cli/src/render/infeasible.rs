//! A move that cannot be, for a person at a terminal.

use std::fmt::Write;

use takt_client::v1;

use super::{
    table::{Tone, number, paint},
    words::{self, Units},
};

/// A move that cannot be: the evidence, and what would help.
pub(crate) fn evidence(infeasible: &v1::Infeasible, robot: &v1::Robot, colour: bool) -> String {
    let unit = Units::default().of(robot, &infeasible.joint).torque;
    let mut out = format!(
        "{} {}\n\n",
        paint("infeasible:", Tone::Bad, colour),
        words::reason(infeasible.reason())
    );
    let mut line = |name: &str, value: &str| {
        let _ = writeln!(out, "{}  {value}", paint(&format!("{name:<10}"), Tone::Bold, colour));
    };
    line("joint", &infeasible.joint);
    let place = match infeasible.location {
        location if location <= 0.0 => "at the start".to_owned(),
        location if location >= 1.0 => "at the target".to_owned(),
        location => format!(
            "{:.1} % of the way, at {:.3} s of the plan as it was tried",
            100.0 * location,
            infeasible.time_s
        ),
    };
    line("where", &place);
    let (needed, available) = (infeasible.needed, infeasible.available);
    let over = 100.0 * (needed.abs() / available - 1.0);
    let over = if over.is_finite() {
        format!(" ({over:.1} % over the limit)")
    } else {
        String::new()
    };
    line("needed", &format!("{} {unit}{over}", number(needed, 5)));
    line("available", &format!("{} {unit}", number(available, 5)));
    line(
        "of which",
        &format!("{} {unit} are gravity's", number(infeasible.gravity_torque, 5)),
    );
    if let Some(band) = infeasible.band {
        let text = format!("{} {unit} are the band of the confidence", number(band, 5));
        line("and", &text);
    }
    if let Some(mass) = infeasible.feasible_payload_kg {
        line("payload", &format!("up to {} kg would do", number(mass, 4)));
    }
    if !infeasible.suggestion.is_empty() {
        line("remedy", &infeasible.suggestion);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::example;

    #[test]
    fn a_refusal_shows_its_evidence() {
        let no = v1::Infeasible {
            reason: v1::infeasible::Reason::HoldingTorque.into(),
            joint: "turn".to_owned(),
            location: 1.0,
            needed: -120.0,
            available: 100.0,
            gravity_torque: -115.0,
            suggestion: "carry less".to_owned(),
            feasible_payload_kg: Some(3.2),
            ..Default::default()
        };
        let text = evidence(&no, &example::robot(), false);
        for part in [
            "cannot be held",
            "at the target",
            "-120.00 N m (20.0 % over",
            "100.00 N m",
            "3.200 kg",
            "carry less",
        ] {
            assert!(text.contains(part), "{part:?} is not in\n{text}");
        }
    }

    #[test]
    fn nothing_breaks_on_an_empty_answer() {
        evidence(&v1::Infeasible::default(), &v1::Robot::default(), true);
    }
}
