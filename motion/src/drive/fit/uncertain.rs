//! A fit's covariance as the model carries it.

use super::report::Unknown;
use super::unknowns::{Unknowns, tip_onto_last_link};
use crate::dynamics::regressor::{BODY, kinds};
use crate::robot::spec::{Parameter, Residual, RobotSpec, Uncertainty};

/// The covariance of the joints' parameters; a payload's is that of the last link, which it moves with.
pub(crate) fn of(spec: &RobotSpec, unknowns: &Unknowns, covariance: &[f64], residuals: Vec<Residual>) -> Uncertainty {
    // each parameter as a sum of unknowns
    let mut parameters = Vec::new();
    let mut sums: Vec<Vec<(usize, f64)>> = Vec::new();
    for (k, unknown) in unknowns.list.iter().enumerate() {
        if let Unknown::Joint(parameter) = unknown {
            parameters.push(*parameter);
            sums.push(vec![(k, 1.0)]);
        }
    }
    if let Some(start) = unknowns.list.iter().position(|unknown| *unknown == Unknown::Payload(0)) {
        let joint = spec.joints.len().saturating_sub(1);
        for (row, kind) in tip_onto_last_link(spec).iter().zip(kinds()) {
            parameters.push(Parameter { joint, kind });
            sums.push((0..BODY).map(|part| (start + part, row[part])).collect());
        }
    }
    let count = unknowns.count();
    let mut triangle = Vec::with_capacity(sums.len() * (sums.len() + 1) / 2);
    for (i, row) in sums.iter().enumerate() {
        for column in &sums[..=i] {
            let terms = row
                .iter()
                .flat_map(|(a, x)| column.iter().map(move |(b, y)| x * y * covariance[a * count + b]));
            triangle.push(terms.sum());
        }
    }
    Uncertainty {
        parameters,
        covariance: triangle,
        residuals,
    }
}
