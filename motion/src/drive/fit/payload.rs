//! Where the fit of a payload begins: a described one, or the point mass that the torque asks for.

use super::linear::Cholesky;
use super::normal::Normal;
use super::report::{Missing, Unknown};
use super::unknowns::Unknowns;
use crate::budget::{Budget, Stopped};
use crate::dynamics::regressor::BODY;
use crate::tolerance::{ALONE_SHRINK, PAYLOAD_GYRATION};

/// Sets the payload that the fit is drawn to. Where none is described it is the body that fits best among those of
/// [`PAYLOAD_GYRATION`] about their own centre; a mass below zero is no payload, and is said.
pub(crate) fn aim(
    normal: &Normal,
    unknowns: &Unknowns,
    weights: &[f64],
    aim: &mut [f64],
    budget: &Budget<'_>,
) -> Result<Result<(), Missing>, Stopped> {
    let start = unknowns.bodies[0];
    if aim[start] > 0.0 {
        return Ok(Ok(()));
    }
    let (matrix, product) = normal.sum(weights, None);
    let n = unknowns.count();
    // friction, mass and first moment
    let free: Vec<usize> = (0..start + 4).collect();
    let scale: Vec<f64> = free
        .iter()
        .map(|k| 1.0 / matrix[k * n + k].max(f64::MIN_POSITIVE).sqrt())
        .collect();
    let mut scaled = Vec::with_capacity(free.len() * free.len());
    for a in &free {
        scaled.extend(free.iter().map(|b| matrix[a * n + b] * scale[*a] * scale[*b]));
    }
    for k in 0..free.len() {
        scaled[k * free.len() + k] += ALONE_SHRINK;
    }
    let mut values: Vec<f64> = free.iter().map(|k| product[*k] * scale[*k]).collect();
    if let Some(factor) = Cholesky::new(&scaled, free.len(), budget)? {
        factor.solve(&mut values);
    }
    let found: Vec<f64> = (start..start + 4).map(|k| values[k] * scale[k]).collect();
    let mass = found[0];
    if mass.is_nan() || mass <= 0.0 {
        let message = format!(
            "the torque asks for a payload of {mass:.3} kg: the described bodies are too heavy, and are what to fit"
        );
        return Ok(Err(Missing {
            parameters: vec![Unknown::Payload(0)],
            message,
        }));
    }
    let c = [found[1] / mass, found[2] / mass, found[3] / mass];
    let own = 2.0 * mass * PAYLOAD_GYRATION * PAYLOAD_GYRATION;
    let square: f64 = c.iter().map(|x| x * x).sum();
    let body: [f64; BODY] = [
        mass,
        found[1],
        found[2],
        found[3],
        mass * (square - c[0] * c[0]) + own,
        mass * (square - c[1] * c[1]) + own,
        mass * (square - c[2] * c[2]) + own,
        -mass * c[0] * c[1],
        -mass * c[0] * c[2],
        -mass * c[1] * c[2],
    ];
    aim[start..start + BODY].copy_from_slice(&body);
    Ok(Ok(()))
}
