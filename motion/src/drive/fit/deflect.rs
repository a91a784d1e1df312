//! How far the contacts of each joint deflect before they slide: the one parameter of friction that is not linear.
//!
//! For one joint at a time, with the bodies as they are, each deflection of a grid gets the friction that suits it best, and the one
//! that leaves the least square of the residual is kept. Deflections are parts of the joint's own travel, from a step of an
//! encoder to a tenth of it: a contact that is longer than that is a spring.

use super::design::Design;
use super::linear::{Cholesky, dot};
use super::signals::Signals;
use super::unknowns::Unknowns;
use crate::budget::{Budget, Stopped};
use crate::robot::spec::ParameterKind;
use crate::tolerance::{DEFLECTION_LEAST, DEFLECTION_MOST, DEFLECTION_STEPS, FRICTION_SHRINK};

/// The best deflection of one joint, beside a solution for everything else.
pub(crate) fn search(
    design: &Design,
    signals: &Signals,
    unknowns: &Unknowns,
    solution: &[f64],
    joint: usize,
    budget: &Budget<'_>,
) -> Result<Option<f64>, Stopped> {
    use ParameterKind as K;
    let rows = &design.rows[joint];
    let place = |kind| {
        let index = unknowns.index(joint, kind)?;
        rows.unknowns.iter().position(|k| *k == index)
    };
    let kinds = [
        K::CoulombPositive,
        K::CoulombNegative,
        K::LoadCoulomb,
        K::Viscous,
        K::Quadratic,
    ];
    let places: Vec<usize> = kinds.into_iter().filter_map(place).collect();
    let (from, to) = signals.selected;
    let mut bare = solution.to_vec();
    for place in &places {
        bare[rows.unknowns[*place]] = 0.0;
    }
    let target = rows.residual_of(&bare, from, to);
    let steady: Vec<&[f64]> = places[3..]
        .iter()
        .map(|place| signals.of(&rows.columns[*place]))
        .collect();
    let (least, most) = extent(signals.of(&signals.q[joint]));
    let travel = most - least;
    let grid = (0..DEFLECTION_STEPS).map(|k| {
        let part = k as f64 / (DEFLECTION_STEPS - 1) as f64;
        Some(travel * DEFLECTION_LEAST * libm::pow(DEFLECTION_MOST / DEFLECTION_LEAST, part))
    });
    let mut best: (f64, Option<f64>) = (f64::INFINITY, None);
    for deflection in std::iter::once(None).chain(grid) {
        budget.check()?;
        let friction = rows.friction(signals, joint, deflection);
        let mut columns: Vec<&[f64]> = friction.iter().map(|column| signals.of(column)).collect();
        columns.extend(&steady);
        let square = least_square(&columns, &target, budget)?;
        if square < best.0 {
            best = (square, deflection);
        }
    }
    Ok(best.1)
}

/// Least and greatest.
fn extent(values: &[f64]) -> (f64, f64) {
    values
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(*x), b.max(*x)))
}

/// Square of what columns leave of a target, each shrunk a little: some are alike.
fn least_square(columns: &[&[f64]], target: &[f64], budget: &Budget<'_>) -> Result<f64, Stopped> {
    let size = columns.len();
    let mut matrix = vec![0.0; size * size];
    let mut product = vec![0.0; size];
    for (a, column) in columns.iter().enumerate() {
        product[a] = dot(column, target);
        for (b, other) in columns.iter().enumerate() {
            matrix[a * size + b] = dot(column, other);
        }
        matrix[a * size + a] = matrix[a * size + a] * (1.0 + FRICTION_SHRINK) + f64::MIN_POSITIVE;
    }
    let Some(factor) = Cholesky::new(&matrix, size, budget)? else {
        return Ok(f64::INFINITY);
    };
    let mut values = product.clone();
    factor.solve(&mut values);
    let mut residual = target.to_vec();
    for (column, value) in columns.iter().zip(&values) {
        for (residual, x) in residual.iter_mut().zip(*column) {
            *residual -= value * x;
        }
    }
    Ok(dot(&residual, &residual))
}
