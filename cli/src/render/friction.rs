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
    let mut table = Table::new(["joint", "term", "estimate", "± 95 %", "model", "commit", "unit", ""]).numbers_from(2);
    for joint in &last.joints {
        let torque = Units::default().of(robot, &joint.joint).torque;
        for (index, one) in joint.coefficients.iter().enumerate() {
            let first = |text: &str| if index == 0 { text.to_owned() } else { String::new() };
            let (estimate, width) = match joint.used_count {
                // what is there is what was assumed beforehand
                0 => (dash(), dash()),
                _ => (number(one.value, 4), number(0.5 * (one.upper - one.lower), 2)),
            };
            let (commit, why) = outcome(joint, one);
            table.row([
                Cell::from(first(&joint.joint)),
                Cell::from(term(one.term())),
                Cell::from(estimate),
                Cell::from(width),
                Cell::from(number(one.model, 4)),
                commit,
                Cell::new(unit(one.term(), torque), Tone::Dim),
                Cell::from(why),
            ]);
        }
    }
    let mut out = table.render_for(terminal);
    out.push('\n');
    out.push_str(&evidence(last, robot).render_for(terminal));
    for line in facts(last) {
        let _ = writeln!(out, "{line}");
    }
    for (missing, joints) in folded(&last.joints) {
        let _ = writeln!(
            out,
            "{} {}: {missing}",
            paint("missing:", Tone::Bad, terminal.colour),
            joints.join(", ")
        );
    }
    let proposal = last.proposal.iter().flat_map(|proposal| &proposal.warnings);
    for warning in last.warnings.iter().chain(proposal) {
        let _ = writeln!(out, "warning: {warning}");
    }
    out
}

/// What a commit writes of a coefficient, and why it is not what was estimated.
fn outcome(joint: &v1::FrictionEstimate, one: &v1::FrictionCoefficient) -> (Cell, &'static str) {
    match one.committed {
        None if joint.used_count == 0 => (Cell::new("stays", Tone::Dim), "no sample counted"),
        None if !one.told => (Cell::new("stays", Tone::Dim), "not told, see missing"),
        None => (Cell::new("stays", Tone::Dim), "see missing"),
        Some(committed) => {
            let why = match committed == 0.0 && one.value < 0.0 {
                true if one.upper < 0.0 => "below 0 for certain: has the torque the right sign?",
                true => "friction is never below 0",
                false if committed.to_bits() != one.value.to_bits() => "fitted to another term's bound, see warnings",
                false => "",
            };
            (Cell::new(number(committed, 4), Tone::Good), why)
        }
    }
}

/// What each joint's estimate stands on.
fn evidence(last: &v1::EstimateFrictionResponse, robot: &v1::Robot) -> Table {
    let mut table = Table::new([
        "joint",
        "used",
        "residual",
        "without outliers",
        "at rest",
        "turning back",
        "settling",
        "no torque",
        "out of range",
        "did not fit",
    ])
    .numbers_from(1);
    for joint in &last.joints {
        let torque = Units::default().of(robot, &joint.joint).torque;
        let skipped = joint.skipped.unwrap_or_default();
        let residual = |value: f64| match joint.used_count {
            0 => dash(),
            _ => format!("{} {torque}", number(value, 3)),
        };
        table.row([
            joint.joint.clone(),
            joint.used_count.to_string(),
            residual(joint.residual_rms),
            residual(joint.residual_deviation),
            skipped.at_rest.to_string(),
            skipped.reversing.to_string(),
            skipped.settling.to_string(),
            skipped.not_finite.to_string(),
            skipped.out_of_range.to_string(),
            skipped.outlier.to_string(),
        ]);
    }
    table
}

/// What is missing, each once with all its joints.
fn folded(joints: &[v1::FrictionEstimate]) -> Vec<(&str, Vec<&str>)> {
    let mut found: Vec<(&str, Vec<&str>)> = Vec::new();
    for joint in joints {
        for missing in &joint.missing {
            match found.iter_mut().find(|(known, _)| known == missing) {
                Some((_, joints)) => joints.push(&joint.joint),
                None => found.push((missing, vec![&joint.joint])),
            }
        }
    }
    found
}

/// What a commit changes of friction, for a person.
pub(crate) fn changes(changes: &[v1::FrictionChange], robot: &v1::Robot, terminal: Terminal) -> String {
    use v1::friction_change::Term as Changed;
    let mut table = Table::new(["joint", "friction", "was", "becomes", "unit"]).numbers_from(2);
    let mut before = "";
    for change in changes {
        let turns = Units::default().of(robot, &change.joint).torque == "N m";
        let (name, unit) = match (change.term(), turns) {
            (Changed::Unspecified, _) => ("", ""),
            (Changed::CoulombPositive, true) => (term(Term::CoulombPositive), "N m"),
            (Changed::CoulombPositive, false) => (term(Term::CoulombPositive), "N"),
            (Changed::CoulombNegative, true) => (term(Term::CoulombNegative), "N m"),
            (Changed::CoulombNegative, false) => (term(Term::CoulombNegative), "N"),
            (Changed::Viscous, true) => (term(Term::Viscous), "N m s/rad"),
            (Changed::Viscous, false) => (term(Term::Viscous), "N s/m"),
            (Changed::LoadCoulomb, _) => (term(Term::LoadCoulomb), ""),
            (Changed::Quadratic, true) => (term(Term::Quadratic), "N m s²/rad²"),
            (Changed::Quadratic, false) => (term(Term::Quadratic), "N s²/m²"),
            (Changed::PreslidingStiffness, true) => ("presliding", "N m/rad"),
            (Changed::PreslidingStiffness, false) => ("presliding", "N/m"),
        };
        let value = |value: Option<f64>| value.map_or_else(dash, |value| number(value, 4));
        let stays = change.before.map(f64::to_bits) == change.after.map(f64::to_bits);
        let becomes = match stays {
            true => Cell::new("stays", Tone::Dim),
            false => Cell::from(value(change.after)),
        };
        let joint = if change.joint == before {
            ""
        } else {
            change.joint.as_str()
        };
        before = &change.joint;
        table.row([
            Cell::from(joint),
            Cell::from(name),
            Cell::from(value(change.before)),
            becomes,
            Cell::new(unit, Tone::Dim),
        ]);
    }
    if table.is_empty() {
        return String::new();
    }
    format!(
        "{}both sides of the gear together, as seen from the joint\n",
        table.render_for(terminal)
    )
}

fn dash() -> String {
    "–".to_owned()
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
