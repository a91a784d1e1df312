//! Fits: how well the model says the torque, what was found, and what the motion does not tell.

use std::fmt::Write;

use takt_client::v1::{self, fit_parameter::Parameter, fitted_parameter::Kind};

use super::{
    table::{Cell, Table, Tone, number, paint},
    words::Units,
};
use crate::io::Terminal;

/// Below this part an estimate is the description's, not the motion's.
const HARDLY_TOLD: f64 = 0.5;

/// Part of a residual that poses may explain before the bodies are to be doubted.
const POSE_SHARE: f64 = 0.3;

/// A fit, for a person; `test_log` is the file that it is compared with where that is another one.
pub(crate) fn fit(fit: &v1::MotionFit, robot: &v1::Robot, test_log: Option<&str>, terminal: Terminal) -> String {
    let mut out = errors(fit, robot).render_for(terminal);
    match &fit.after {
        Some(after) => {
            let of = test_log.map_or_else(|| "the test part".to_owned(), |log| format!("the log {log}"));
            out.push_str(ERRORS_FITTED);
            let _ = writeln!(
                out,
                "before, after: on {of} ({} samples), with the model as it was and as fitted. 95 % within: so much of its errors is \
                 smaller; of peak: over the peak torque",
                after.sample_count
            );
            out.push_str(ERRORS_OF_TEST);
        }
        None => {
            out.push_str(ERRORS_FITTED);
            out.push_str(NO_TEST);
        }
    }
    let _ = writeln!(
        out,
        "{} samples; {} of {} parameters determined by the motion{}",
        fit.sample_count,
        number(fit.determined, 4),
        fit.estimates.len(),
        fit.ridge.map_or_else(String::new, |ridge| format!(
            "; weight of the described bodies against it (ridge, by cross-validation) {}",
            number(ridge, 3)
        ))
    );
    out.push('\n');
    out.push_str(&estimates(fit, robot).render_for(terminal));
    out.push_str(ESTIMATES);
    for joint in &fit.joints {
        if joint.pose_share > POSE_SHARE {
            let _ = writeln!(
                out,
                "{} {:.0} % of what is left of {} depends on the position of {}: its body is not right yet",
                paint("note:", Tone::Bold, terminal.colour),
                100.0 * joint.pose_share,
                joint.joint,
                joint.pose_joint
            );
        }
    }
    for warning in &fit.warnings {
        let _ = writeln!(out, "{} {warning}", paint("warning:", Tone::Bold, terminal.colour));
    }
    out
}

/// What the first columns of errors mean.
const ERRORS_FITTED: &str = "\
error of the torque over the torque, rms. fitted: on what was fitted; left out: on stretches of it left out in turn
";

/// How to get the others.
const NO_TEST: &str = "\
how well the fit foretells other motion takes what was not fitted: a part with --identify and --test, or another log with --test-log
";

/// What the columns of a comparison mean.
const ERRORS_OF_TEST: &str = "\
covered: samples within the 95 % band that the fitted model states; width: of that band over the narrowest constant one that holds 95 %
online: the same of a band that follows the errors seen until a moment before (docs/friction.md)
";

/// What the columns of estimates mean.
const ESTIMATES: &str = "\
before: what the description said. told: part of the value that the motion tells, the rest is the description's; 0 % is not known from this motion
";

fn percent(part: f64) -> String {
    format!("{:.1} %", 100.0 * part)
}

/// Torque errors by joint: of the fit, and of the part to be compared with.
fn errors(fit: &v1::MotionFit, robot: &v1::Robot) -> Table {
    let head = ["joint", "fitted", "left out"];
    let of_test = [
        "before",
        "after",
        "95 % within",
        "of peak",
        "covered",
        "width",
        "online",
        "width",
    ];
    let of_test = if fit.after.is_some() { &of_test[..] } else { &[] };
    let mut table = Table::new(head.iter().chain(of_test).copied()).numbers_from(1);
    let of = |assessment: &Option<v1::Assessment>, index: usize| {
        let assessment = assessment.as_ref();
        assessment.and_then(|assessment| assessment.joints.get(index).cloned())
    };
    let dash = || Cell::new("–", Tone::Dim);
    let width = |interval: v1::IntervalAssessment| Cell::from(format!("x {:.2}", interval.over_narrowest));
    let covered = |interval: v1::IntervalAssessment| Cell::from(percent(interval.coverage));
    for (index, joint) in fit.joints.iter().enumerate() {
        let mut row = vec![
            Cell::from(joint.joint.clone()),
            Cell::from(percent(joint.fitted_error)),
            Cell::from(percent(joint.validated_error)),
        ];
        if let Some(after) = of(&fit.after, index) {
            let unit = Units::default().of(robot, &joint.joint).torque;
            let before = of(&fit.before, index);
            let peak = after.percentile_of_peak;
            row.extend([
                before.map_or_else(dash, |before| percent(before.error).into()),
                Cell::new(percent(after.error), Tone::Bold),
                format!("{} {unit}", number(after.percentile, 3)).into(),
                peak.map_or_else(dash, |part| percent(part).into()),
                after.interval.map_or_else(dash, covered),
                after.interval.map_or_else(dash, width),
                after.online.map_or_else(dash, covered),
                after.online.map_or_else(dash, width),
            ]);
        }
        table.row(row);
    }
    table
}

fn estimates(fit: &v1::MotionFit, robot: &v1::Robot) -> Table {
    let mut table = Table::new(["of", "what", "value", "± 1 σ", "before", "unit", "told"]).numbers_from(2);
    for one in &fit.estimates {
        let (of, what, unit) = named(one.parameter.as_ref(), robot);
        let told = match one.told {
            _ if one.held && one.value < 0.0 => Cell::new("held level", Tone::Dim),
            _ if one.held => Cell::new("held at 0", Tone::Dim),
            told if told < HARDLY_TOLD => Cell::new(format!("{:.0} %", 100.0 * told), Tone::Bad),
            told => Cell::from(format!("{:.0} %", 100.0 * told)),
        };
        table.row([
            Cell::from(of),
            Cell::from(what),
            Cell::from(number(one.value, 4)),
            Cell::from(number(one.standard_error, 2)),
            Cell::new(number(one.described, 4), Tone::Dim),
            Cell::new(unit, Tone::Dim),
            told,
        ]);
    }
    table
}

/// What to do with what a fit proposes; nothing where it changes nothing.
pub(crate) fn proposal(proposal: Option<&v1::ModelProposal>, robot_id: &str) -> String {
    let Some(proposal) = proposal else {
        return String::new();
    };
    format!(
        "changes {}; to store it as a new revision: the same with --json > fit.json, then takt drive commit {robot_id} fit.json\n",
        proposal.joints.join(", ")
    )
}

/// What was measured does not say, for a person; `what` with its verb, as in "motion does".
pub(crate) fn missing(what: &str, missing: &v1::NotExcited, colour: bool) -> String {
    let mut out = format!("{}\n", paint(&format!("the {what} not say enough:"), Tone::Bad, colour));
    for one in &missing.missing {
        let _ = writeln!(out, "  {}", one.message);
        let names: Vec<String> = one
            .parameters
            .iter()
            .map(|parameter| {
                let (of, what, _) = named(Some(parameter), &v1::Robot::default());
                format!("{of} {what}")
            })
            .collect();
        if !names.is_empty() {
            let _ = writeln!(out, "    left open: {}", names.join(", "));
        }
    }
    for warning in &missing.warnings {
        let _ = writeln!(out, "{} {warning}", paint("warning:", Tone::Bold, colour));
    }
    out
}

/// What a commit changes of bodies and rotors, for a person: of a body the mass, with which the rest of it goes.
pub(crate) fn changes(estimates: &[v1::ParameterEstimate], robot: &v1::Robot, terminal: Terminal) -> String {
    let is_listed = |parameter: &Parameter| match parameter {
        Parameter::Joint(one) => matches!(one.kind(), Kind::Mass | Kind::Armature),
        Parameter::Payload(number) => *number == v1::PayloadParameter::PayloadMass as i32,
    };
    let mut table = Table::new(["of", "what", "was", "becomes", "unit"]).numbers_from(2);
    for one in estimates {
        let parameter = one.parameter.as_ref();
        let listed = parameter
            .and_then(|parameter| parameter.parameter.as_ref())
            .is_some_and(is_listed);
        let (was, becomes) = (number(one.described, 4), number(one.value, 4));
        if !listed || was == becomes {
            continue;
        }
        let (of, what, unit) = named(parameter, robot);
        table.row([
            Cell::from(of),
            Cell::from(what),
            Cell::from(was),
            Cell::from(becomes),
            Cell::new(unit, Tone::Dim),
        ]);
    }
    if table.is_empty() {
        return String::new();
    }
    format!(
        "\n{}first moments and inertias of these bodies change too: takt robot show {} --description\n",
        table.render_for(terminal),
        robot.robot_id
    )
}

fn named(parameter: Option<&v1::FitParameter>, robot: &v1::Robot) -> (String, String, String) {
    match parameter.and_then(|parameter| parameter.parameter.clone()) {
        Some(Parameter::Joint(one)) => {
            let torque = Units::default().of(robot, &one.joint).torque;
            let (what, unit) = kind(one.kind(), torque);
            (one.joint, what.to_owned(), unit.to_owned())
        }
        Some(Parameter::Payload(number)) => {
            const WHAT: [(&str, &str); 11] = [
                ("", ""),
                ("mass", "kg"),
                ("first moment x", "kg m"),
                ("first moment y", "kg m"),
                ("first moment z", "kg m"),
                ("inertia xx", "kg m²"),
                ("inertia yy", "kg m²"),
                ("inertia zz", "kg m²"),
                ("inertia xy", "kg m²"),
                ("inertia xz", "kg m²"),
                ("inertia yz", "kg m²"),
            ];
            let index = usize::try_from(number).unwrap_or(0);
            let (what, unit) = WHAT.get(index).copied().unwrap_or(("", ""));
            ("payload".to_owned(), what.to_owned(), unit.to_owned())
        }
        None => Default::default(),
    }
}

fn kind(kind: Kind, torque: &'static str) -> (&'static str, &'static str) {
    let turns = torque != "N";
    match kind {
        Kind::Unspecified => ("", ""),
        Kind::Mass => ("mass", "kg"),
        Kind::FirstMomentX => ("first moment x", "kg m"),
        Kind::FirstMomentY => ("first moment y", "kg m"),
        Kind::FirstMomentZ => ("first moment z", "kg m"),
        Kind::InertiaXx => ("inertia xx", "kg m²"),
        Kind::InertiaYy => ("inertia yy", "kg m²"),
        Kind::InertiaZz => ("inertia zz", "kg m²"),
        Kind::InertiaXy => ("inertia xy", "kg m²"),
        Kind::InertiaXz => ("inertia xz", "kg m²"),
        Kind::InertiaYz => ("inertia yz", "kg m²"),
        Kind::Armature => ("rotor, reflected", if turns { "kg m²" } else { "kg" }),
        Kind::Viscous => ("viscous", if turns { "N m s/rad" } else { "N s/m" }),
        Kind::CoulombPositive => ("Coulomb +", torque),
        Kind::CoulombNegative => ("Coulomb −", torque),
        Kind::LoadCoulomb => ("Coulomb of the load", ""),
        Kind::Quadratic => ("quadratic", if turns { "N m s²/rad²" } else { "N s²/m²" }),
    }
}
