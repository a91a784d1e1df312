//! What a fit to recorded motion adds to a description: bodies in the place of the chain's own, and how well it all is known.

use std::collections::HashMap;

use nalgebra::Matrix3;

use crate::robot::bounds::{
    COVARIANCE, COVARIANCE_ROUNDING, DEGREES_OF_FREEDOM, INERTIA, LENGTH, MASS, MAX_JOINTS, RESIDUAL_DEVIATION,
    RESIDUAL_TIME,
};
use crate::robot::description::{LinkEntry, UncertaintyEntry};
use crate::robot::findings::{Findings, listed, quoted};
use crate::robot::inertial;
use crate::robot::spec::{JointSpec, Parameter, ParameterKind, Residual, Uncertainty};

/// How many parameters one joint has: ten of its body, six of its drive.
const PARAMETERS_A_JOINT: usize = 16;

/// The joints of a chain by name; nothing is known of them where the chain could not be read.
pub(super) struct Names<'a> {
    joints: Option<HashMap<&'a str, usize>>,
    list: String,
}

impl<'a> Names<'a> {
    pub(super) fn new(joints: Option<&'a [JointSpec]>) -> Self {
        let names = || {
            joints
                .iter()
                .flat_map(|joints| joints.iter().map(|joint| joint.name.as_str()))
        };
        Self {
            joints: joints.map(|_| names().zip(0..).collect()),
            list: listed(names()),
        }
    }

    /// The index of a joint; `None`, and a finding where the chain is known, if there is none of that name.
    fn index(&self, name: &str, path: impl FnOnce() -> String, findings: &mut Findings) -> Option<usize> {
        let joints = self.joints.as_ref()?;
        let index = joints.get(name).copied();
        if index.is_none() {
            let message = format!("{} is not a joint of the chain: {}", quoted(name), self.list);
            findings.error(path(), message);
        }
        index
    }
}

/// Lays bodies over those of the chain.
pub(super) fn lay_bodies(entries: &[LinkEntry], joints: Option<&mut Vec<JointSpec>>, findings: &mut Findings) {
    if entries.len() > MAX_JOINTS {
        let message = format!("{} entries must be at most {MAX_JOINTS}", entries.len());
        findings.error("link_inertia", message);
        return;
    }
    let names = Names::new(joints.as_deref().map(Vec::as_slice));
    let mut entry_of: HashMap<usize, usize> = HashMap::new();
    for (index, entry) in entries.iter().enumerate() {
        let path = |field: &str| format!("link_inertia[{index}].{field}");
        let body = &entry.body;
        findings.check(path("mass_kg"), body.mass, &MASS);
        findings.check_vector(&path("center_of_mass_m"), &body.center_of_mass, &LENGTH);
        findings.check_tensor(&path("inertia_kg_m2"), &body.inertia, &INERTIA);
        if body.mass == 0.0 && body.inertia != Matrix3::zeros() {
            findings.error(path("inertia_kg_m2"), "must be zero where mass_kg is 0");
        }
        let Some(joint) = names.index(&entry.joint, || path("joint"), findings) else {
            continue;
        };
        if let Some(first) = entry_of.insert(joint, index) {
            let name = quoted(&entry.joint);
            findings.error(
                path("joint"),
                format!("{name} is the joint of link_inertia[{first}] too"),
            );
        }
    }
    let Some(joints) = joints.filter(|_| !findings.has_errors()) else {
        return;
    };
    for (joint, spec) in joints.iter_mut().enumerate() {
        let Some(entry) = entry_of.get(&joint) else {
            continue;
        };
        let body = entries[*entry].body;
        if let Some(oddity) = inertial::oddity(format_args!("link_inertia of joint {}", quoted(&spec.name)), &body) {
            findings.warn(oddity);
        }
        spec.link = body;
    }
}

/// How well the parameters are known, with joints by index.
pub(super) fn uncertainty(
    entry: Option<&UncertaintyEntry>,
    joints: Option<&[JointSpec]>,
    findings: &mut Findings,
) -> Option<Uncertainty> {
    let entry = entry?;
    let names = Names::new(joints);
    let parameters = parameters(&entry.parameters, &names, findings);
    check_covariance(&entry.covariance, entry.parameters.len(), findings);
    let residuals = residuals(&entry.residuals, &names, joints, findings);
    Some(Uncertainty {
        parameters,
        covariance: entry.covariance.clone(),
        residuals,
    })
}

fn parameters(entries: &[(String, ParameterKind)], names: &Names<'_>, findings: &mut Findings) -> Vec<Parameter> {
    let at = "uncertainty.parameters";
    if entries.len() > PARAMETERS_A_JOINT * MAX_JOINTS {
        let most = PARAMETERS_A_JOINT * MAX_JOINTS;
        findings.error(at, format!("{} entries must be at most {most}", entries.len()));
        return Vec::new();
    }
    let mut first_of = HashMap::new();
    let mut parameters = Vec::with_capacity(entries.len());
    for (index, (name, kind)) in entries.iter().enumerate() {
        let path = || format!("{at}[{index}].joint");
        let Some(joint) = names.index(name, path, findings) else {
            continue;
        };
        let parameter = Parameter { joint, kind: *kind };
        if let Some(first) = first_of.insert(parameter, index) {
            findings.error(format!("{at}[{index}]"), format!("is the same as {at}[{first}]"));
        }
        parameters.push(parameter);
    }
    parameters
}

fn residuals(
    entries: &[(String, Residual)],
    names: &Names<'_>,
    joints: Option<&[JointSpec]>,
    findings: &mut Findings,
) -> Vec<Residual> {
    let at = "uncertainty.residuals";
    if entries.len() > MAX_JOINTS {
        findings.error(at, format!("{} entries must be at most {MAX_JOINTS}", entries.len()));
        return Vec::new();
    }
    let mut found: Vec<Option<(usize, Residual)>> = vec![None; joints.map_or(0, <[JointSpec]>::len)];
    for (index, (name, residual)) in entries.iter().enumerate() {
        let path = |field: &str| format!("{at}[{index}].{field}");
        findings.check(path("deviation"), residual.deviation, &RESIDUAL_DEVIATION);
        findings.check(path("correlation_time_s"), residual.correlation_time, &RESIDUAL_TIME);
        // a normal distribution has infinitely many
        if residual.degrees_of_freedom != f64::INFINITY {
            findings.check(
                path("degrees_of_freedom"),
                residual.degrees_of_freedom,
                &DEGREES_OF_FREEDOM,
            );
        }
        let Some(joint) = names.index(name, || path("joint"), findings) else {
            continue;
        };
        if let Some((first, _)) = found[joint] {
            let name = quoted(name);
            findings.error(path("joint"), format!("{name} is the joint of {at}[{first}] too"));
        }
        found[joint] = Some((index, *residual));
    }
    let missing = joints.unwrap_or_default().iter().zip(&found);
    let mut missing = missing.filter(|(_, found)| found.is_none()).peekable();
    if missing.peek().is_some() {
        let names = listed(missing.map(|(joint, _)| joint.name.as_str()));
        findings.error(at, format!("must have an entry for every joint, has none for {names}"));
    }
    found.into_iter().flatten().map(|(_, residual)| residual).collect()
}

/// A lower triangle, row by row, of a matrix that is positive semidefinite.
fn check_covariance(triangle: &[f64], count: usize, findings: &mut Findings) {
    let at = "uncertainty.covariance";
    let needed = count * (count + 1) / 2;
    if triangle.len() != needed {
        let message = format!(
            "has {} values, the lower triangle of {count} parameters has {needed}",
            triangle.len()
        );
        findings.error(at, message);
        return;
    }
    let mut is_sound = true;
    for (index, value) in triangle.iter().enumerate() {
        if let Some(fault) = COVARIANCE.fault(*value) {
            findings.error(format!("{at}[{index}]"), fault);
            is_sound = false;
        }
    }
    for row in 0..count {
        let index = at_diagonal(row);
        if triangle[index] < 0.0 {
            findings.error(
                format!("{at}[{index}]"),
                format!("a variance of {:?} must not be negative", triangle[index]),
            );
            is_sound = false;
        }
    }
    if is_sound && let Some(row) = negative_pivot(triangle, count) {
        let message =
            format!("is not positive semidefinite: parameters[0] to parameters[{row}] cannot vary together like that");
        findings.error(at, message);
    }
}

/// Where the triangle has the diagonal entry of a row.
fn at_diagonal(row: usize) -> usize {
    row * (row + 3) / 2
}

/// The first row that Cholesky's method fails at, of the matrix scaled to a diagonal of ones and [`COVARIANCE_ROUNDING`]
/// more: there is one where an eigenvalue of the scaled matrix is below −[`COVARIANCE_ROUNDING`]. A parameter without
/// variance may not vary with another.
fn negative_pivot(triangle: &[f64], count: usize) -> Option<usize> {
    let deviation: Vec<f64> = (0..count).map(|row| triangle[at_diagonal(row)].sqrt()).collect();
    let mut factor = vec![0.0; triangle.len()];
    for row in 0..count {
        let start = at_diagonal(row) - row;
        for column in 0..=row {
            let entry = triangle[start + column];
            let scale = deviation[row] * deviation[column];
            if scale == 0.0 {
                if entry != 0.0 {
                    return Some(row);
                }
                factor[start + column] = if row == column { 1.0 } else { 0.0 };
                continue;
            }
            let other = at_diagonal(column) - column;
            let sum: f64 = (0..column).map(|k| factor[start + k] * factor[other + k]).sum();
            let scaled = entry / scale;
            if row != column {
                factor[start + column] = (scaled - sum) / factor[other + column];
                continue;
            }
            let pivot = scaled + COVARIANCE_ROUNDING - sum;
            if pivot.is_nan() || pivot <= 0.0 {
                return Some(row);
            }
            factor[start + column] = pivot.sqrt();
        }
    }
    None
}

#[cfg(test)]
mod tests;
