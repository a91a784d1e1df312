//! Fits of one joint on the bench.

use std::fmt::Write;

use takt_client::v1;

use super::{
    table::{Cell, Table, Tone, number, paint},
    words::Units,
};
use crate::io::Terminal;

/// The units of one joint's drive, seen from the joint.
struct DriveUnits {
    position: &'static str,
    torque: &'static str,
    /// Of the k-th coefficient of a stiffness polynomial: powers 1, 3, 5 and so on.
    stiffness: fn(usize) -> String,
    viscous: &'static str,
}

impl DriveUnits {
    fn of(robot: &v1::Robot, joint: &str) -> Self {
        let unit = Units::default().of(robot, joint);
        let turns = unit.torque != "N";
        Self {
            position: unit.position,
            torque: unit.torque,
            stiffness: if turns {
                |term| format!("N m/rad{}", power(term))
            } else {
                |term| format!("N/m{}", power(term))
            },
            viscous: if turns { "N m s/rad" } else { "N s/m" },
        }
    }
}

/// The power of a term, where it is not 1.
fn power(term: usize) -> String {
    match term {
        0 => String::new(),
        term => format!("^{}", 2 * term + 1),
    }
}

/// One coefficient: its name, value, standard error and unit.
type Row<'a> = (&'a str, f64, Option<f64>, String);

fn table<'a>(rows: impl IntoIterator<Item = Row<'a>>, terminal: Terminal) -> String {
    let mut table = Table::new(["what", "value", "± 1 σ", "unit"]).numbers_from(1);
    for (what, value, error, unit) in rows {
        table.row([
            Cell::from(what),
            Cell::from(number(value, 5)),
            error.map_or_else(|| Cell::new("–", Tone::Dim), |error| Cell::from(number(error, 2))),
            Cell::new(unit, Tone::Dim),
        ]);
    }
    table.render_for(terminal)
}

/// A stiffness polynomial.
pub(crate) fn stiffness(fit: &v1::StiffnessFit, robot: &v1::Robot, terminal: Terminal) -> String {
    let unit = DriveUnits::of(robot, &fit.joint);
    let names: Vec<String> = (0..fit.stiffness.len())
        .map(|term| format!("stiffness{}", power(term)))
        .collect();
    let rows = fit.stiffness.iter().zip(&names).enumerate();
    let rows = rows.map(|(term, (value, name))| {
        let error = fit.standard_error.get(term).copied();
        (name.as_str(), *value, error, (unit.stiffness)(term))
    });
    let mut out = format!("{}\n", fit.joint);
    out.push_str(&table(rows, terminal));
    let _ = writeln!(
        out,
        "fitted from {} to {} {}, beyond that it says nothing; torque at no deformation, taken off: {} {t}; left over: {} {t} rms",
        number(fit.deformation_lower, 3),
        number(fit.deformation_upper, 3),
        unit.position,
        number(fit.offset_torque, 3),
        number(fit.residual_torque, 3),
        t = unit.torque
    );
    out
}

/// What a free oscillation says.
pub(crate) fn damping(fit: &v1::DampingFit, robot: &v1::Robot, terminal: Terminal) -> String {
    let unit = DriveUnits::of(robot, &fit.joint);
    let error = |index: usize| fit.standard_errors.get(index).copied();
    let mut out = format!("{}\n", fit.joint);
    let rows = [
        (
            "damping and the motor's viscous friction",
            fit.damping_and_viscous,
            error(0),
            unit.viscous.to_owned(),
        ),
        (
            "damping of the transmission",
            fit.damping,
            None,
            unit.viscous.to_owned(),
        ),
        ("Coulomb friction", fit.coulomb, error(1), unit.torque.to_owned()),
        ("stiffness, from the period", fit.stiffness, None, (unit.stiffness)(0)),
    ];
    out.push_str(&table(rows, terminal));
    let _ = writeln!(
        out,
        "period {} ms; the first two maxima alone, all taken for damping, would have said {} {}",
        number(1e3 * fit.period_s, 4),
        number(fit.decrement_of_first_pair, 4),
        unit.viscous
    );
    out
}

/// Friction at constant speed: of both sides, and of each where they can be told apart.
pub(crate) fn constant_speed(fit: &v1::ConstantSpeedFit, robot: &v1::Robot, terminal: Terminal) -> String {
    let unit = DriveUnits::of(robot, &fit.joint);
    let mut out = String::new();
    for (name, side) in [
        ("both sides together", &fit.total),
        ("behind the gear", &fit.joint_side),
        ("before the gear, seen from the joint", &fit.motor_side),
    ] {
        let Some(side) = side else { continue };
        let error = |index: usize| side.standard_errors.get(index).copied();
        let _ = writeln!(out, "{}: {name}", fit.joint);
        let rows = [
            ("viscous", side.viscous, error(0), unit.viscous.to_owned()),
            ("Coulomb +", side.coulomb_positive, error(1), unit.torque.to_owned()),
            ("Coulomb −", side.coulomb_negative, error(2), unit.torque.to_owned()),
        ];
        out.push_str(&table(rows, terminal));
        let _ = writeln!(
            out,
            "left over: {} {} rms",
            number(side.residual_torque, 3),
            unit.torque
        );
    }
    if fit.joint_side.is_none() {
        out.push_str(
            "the two sides of the gear are not told apart: that takes deformations and a stiffness in the model\n",
        );
    }
    for warning in &fit.warnings {
        let _ = writeln!(out, "{} {warning}", paint("warning:", Tone::Bold, terminal.colour));
    }
    out
}
