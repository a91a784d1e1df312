//! Estimates of friction: a table by joint, what is missing, and how the coefficients came about.

use std::fmt::Write;

use takt_client::v1::{self, friction_coefficient::Term};

use super::{
    curves::{Curve, Curves, JointCurves, Limit, Subject},
    table::{Cell, Table, Tone, number, paint},
    words::Units,
};
use crate::io::Terminal;

/// The last estimate of a stream, for a person.
pub(crate) fn estimate(last: &v1::EstimateFrictionResponse, robot: &v1::Robot, terminal: Terminal) -> String {
    let mut table = Table::new([
        "joint",
        "term",
        "value",
        "± 95 %",
        "unit",
        "told",
        "used",
        "residual",
        "deviation",
    ])
    .numbers_from(2);
    for joint in &last.joints {
        let torque = Units::default().of(robot, &joint.joint).torque;
        for (index, one) in joint.coefficients.iter().enumerate() {
            let first = |text: String| if index == 0 { text } else { String::new() };
            let told = match one.told {
                true => Cell::new("yes", Tone::Good),
                false => Cell::new("no", Tone::Bad),
            };
            table.row([
                Cell::from(first(joint.joint.clone())),
                Cell::from(term(one.term())),
                Cell::from(number(one.value, 4)),
                Cell::from(number(0.5 * (one.upper - one.lower), 2)),
                Cell::new(unit(one.term(), torque), Tone::Dim),
                told,
                Cell::from(first(joint.used_count.to_string())),
                Cell::from(first(format!("{} {torque}", number(joint.residual_rms, 3)))),
                Cell::from(first(format!("{} {torque}", number(joint.residual_deviation, 3)))),
            ]);
        }
    }
    let mut out = table.render_for(terminal);
    for line in facts(last) {
        let _ = writeln!(out, "{line}");
    }
    for joint in &last.joints {
        for missing in &joint.missing {
            let _ = writeln!(
                out,
                "{} {}: {missing}",
                paint("missing:", Tone::Bad, terminal.colour),
                joint.joint
            );
        }
    }
    if let Some(proposal) = &last.proposal {
        for warning in &proposal.warnings {
            let _ = writeln!(out, "warning: {warning}");
        }
    }
    out
}

/// What was taken in, and what was not, in sentences.
pub(crate) fn facts(last: &v1::EstimateFrictionResponse) -> Vec<String> {
    let mut lines = Vec::new();
    let time = last
        .time_s
        .map_or_else(String::new, |time| format!(", the last at {time:.3} s"));
    lines.push(format!(
        "{} samples{time}; {:.3} s behind it",
        last.sample_count, last.delay_s
    ));
    let skipped = last.skipped.unwrap_or_default();
    let whole = listed(&[
        (skipped.not_finite, "with a number missing"),
        (skipped.out_of_range, "out of range"),
        (skipped.time_went_backwards, "not after the one before"),
    ]);
    if !whole.is_empty() {
        lines.push(format!("left out: {whole}"));
    }
    if skipped.gaps > 0 {
        lines.push(format!("{} gaps, after which filters started anew", skipped.gaps));
    }
    for joint in &last.joints {
        let skipped = joint.skipped.unwrap_or_default();
        let list = listed(&[
            (skipped.at_rest, "at rest"),
            (skipped.reversing, "just after turning back"),
            (skipped.settling, "while filters settled"),
            (skipped.not_finite, "with a torque missing"),
            (skipped.out_of_range, "with a torque out of range"),
            (skipped.outlier, "that did not fit"),
        ]);
        if !list.is_empty() {
            lines.push(format!("not used of {}: {list}", joint.joint));
        }
    }
    lines
}

fn listed(counts: &[(u64, &str)]) -> String {
    let list = counts.iter().filter(|(count, _)| *count > 0);
    let list: Vec<String> = list.map(|(count, what)| format!("{count} {what}")).collect();
    list.join(", ")
}

fn term(term: Term) -> &'static str {
    match term {
        Term::Unspecified => "",
        Term::Coulomb => "Coulomb",
        Term::CoulombPositive => "Coulomb +",
        Term::CoulombNegative => "Coulomb −",
        Term::Viscous => "viscous",
        Term::LoadCoulomb => "of the load",
        Term::Quadratic => "quadratic",
    }
}

fn unit(term: Term, torque: &str) -> String {
    let turns = torque == "N m";
    let (speed, square) = match turns {
        true => ("N m s/rad", "N m s²/rad²"),
        false => ("N s/m", "N s²/m²"),
    };
    match term {
        Term::Unspecified | Term::LoadCoulomb => String::new(),
        Term::Coulomb | Term::CoulombPositive | Term::CoulombNegative => torque.to_owned(),
        Term::Viscous => speed.to_owned(),
        Term::Quadratic => square.to_owned(),
    }
}

/// How the Coulomb and the viscous coefficient of every joint came about.
#[derive(Debug, Default)]
pub(crate) struct History {
    time: Vec<f64>,
    /// By joint: name, Coulomb, viscous.
    joints: Vec<(String, Vec<f64>, Vec<f64>)>,
}

impl History {
    pub(crate) fn add(&mut self, estimate: &v1::EstimateFrictionResponse) {
        let Some(time) = estimate.time_s else {
            return;
        };
        // Pictures begin at 0.
        self.time.push(time);
        for (index, joint) in estimate.joints.iter().enumerate() {
            if self.joints.len() == index {
                self.joints.push((joint.joint.clone(), Vec::new(), Vec::new()));
            }
            let value = |wanted: &[Term]| {
                let found = joint.coefficients.iter().find(|one| wanted.contains(&one.term()));
                found.map_or(f64::NAN, |one| one.value)
            };
            let (_, coulomb, viscous) = &mut self.joints[index];
            coulomb.push(value(&[Term::Coulomb, Term::CoulombPositive]));
            viscous.push(value(&[Term::Viscous]));
        }
    }

    pub(crate) fn curves(&self, robot: &v1::Robot) -> Curves {
        let begin = self.time.first().copied().unwrap_or(0.0);
        let joints = self.joints.iter().map(|(joint, coulomb, viscous)| {
            let turns = Units::default().of(robot, joint).torque != "N";
            let curve = |name, unit, values: &Vec<f64>| Curve {
                name,
                unit,
                values: values.clone(),
                limit: Limit::None,
            };
            JointCurves {
                joint: joint.clone(),
                left: curve("Coulomb torque", if turns { "N m" } else { "N" }, coulomb),
                right: curve("viscous friction", if turns { "N m s/rad" } else { "N s/m" }, viscous),
                switches: None,
            }
        });
        Curves {
            joints: joints.collect(),
            time: self.time.iter().map(|time| time - begin).collect(),
            tool: None,
            subject: Subject::Estimate,
        }
    }
}
