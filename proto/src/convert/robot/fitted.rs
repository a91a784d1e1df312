//! What a fit adds to a description: bodies, how well they are known, and where it all comes from.

use takt_motion::{
    nalgebra::{Matrix3, Vector3},
    robot::{
        description::{LinkEntry, UncertaintyEntry},
        spec::{Inertial, JointSpec, ParameterKind, Residual, Uncertainty},
    },
};

use super::inertia;
use crate::{
    convert::{Findings, Path},
    v1::{self, fitted_parameter::Kind},
};

const KINDS: &str = "MASS, FIRST_MOMENT_X to FIRST_MOMENT_Z, INERTIA_XX to INERTIA_YZ, ARMATURE, VISCOUS, \
    COULOMB_POSITIVE, COULOMB_NEGATIVE, LOAD_COULOMB, QUADRATIC";

/// Bytes of the texts of an origin: a name, and a page.
const ORIGIN_NAME_BYTES: usize = 256;
const ORIGIN_NOTE_BYTES: usize = 4096;

pub(super) fn link_inertia(wire: &[v1::LinkInertia], at: Path<'_>, findings: &mut Findings) -> Vec<LinkEntry> {
    let entries = wire.iter().enumerate();
    let entries = entries.map(|(index, entry)| {
        let at = at.index(index);
        if entry.joint.is_empty() {
            findings.push(at.field("joint"), "must be given");
        }
        if entry.mass_kg.is_none() {
            findings.push(at.field("mass_kg"), "must be given");
        }
        let center = findings.vector(at.field("center_of_mass_m"), &entry.center_of_mass_m);
        LinkEntry {
            joint: entry.joint.clone(),
            body: Inertial {
                mass: findings.finite(at.field("mass_kg"), entry.mass_kg.unwrap_or(0.0)),
                center_of_mass: center.unwrap_or_else(Vector3::zeros),
                inertia: inertia(&entry.inertia_kg_m2, at.field("inertia_kg_m2"), findings),
            },
        }
    });
    entries.collect()
}

/// `None` where a parameter says nothing of its kind: of the rest nothing more can be said then.
pub(super) fn uncertainty(
    wire: &v1::ModelUncertainty,
    at: Path<'_>,
    findings: &mut Findings,
) -> Option<UncertaintyEntry> {
    let parameters_at = at.field("parameters");
    let parameters = wire.parameters.iter().enumerate().map(|(index, parameter)| {
        let at = parameters_at.index(index);
        let kind = findings.enumerated(at.field("kind"), parameter.kind, KINDS);
        Some((parameter.joint.clone(), kind_from_wire(kind?)?))
    });
    // every one is looked at, and only then is it known whether all are sound
    let parameters: Vec<Option<_>> = parameters.collect();
    findings.finite_list(at.field("covariance"), &wire.covariance);
    let residuals_at = at.field("residuals");
    let residuals = wire.residuals.iter().enumerate().map(|(index, residual)| {
        let at = residuals_at.index(index);
        let degrees = findings.finite_option(at.field("degrees_of_freedom"), residual.degrees_of_freedom);
        let read = Residual {
            deviation: findings.finite(at.field("deviation"), residual.deviation),
            correlation_time: findings.finite(at.field("correlation_time_s"), residual.correlation_time_s),
            degrees_of_freedom: degrees.unwrap_or(f64::INFINITY),
        };
        (residual.joint.clone(), read)
    });
    let residuals = residuals.collect();
    Some(UncertaintyEntry {
        parameters: parameters.into_iter().collect::<Option<_>>()?,
        covariance: wire.covariance.clone(),
        residuals,
    })
}

/// Texts are bounded and else free: nothing is computed from them.
pub(super) fn check_origin(wire: &v1::ModelOrigin, at: Path<'_>, findings: &mut Findings) {
    for (name, text, most) in [
        ("source", &wire.source, ORIGIN_NAME_BYTES),
        ("base_revision", &wire.base_revision, ORIGIN_NAME_BYTES),
        ("note", &wire.note, ORIGIN_NOTE_BYTES),
    ] {
        if text.len() > most {
            findings.push(at.field(name), format!("{} bytes must be at most {most}", text.len()));
        }
    }
}

/// Writes the bodies of a model, joints by name: as many of them as stand in `joints`.
#[must_use]
pub fn link_inertia_to_wire<'a>(joints: impl IntoIterator<Item = &'a JointSpec>) -> Vec<v1::LinkInertia> {
    let entries = joints.into_iter().map(|joint| v1::LinkInertia {
        joint: joint.name.clone(),
        mass_kg: Some(joint.link.mass),
        center_of_mass_m: joint.link.center_of_mass.as_slice().to_vec(),
        inertia_kg_m2: tensor_to_wire(&joint.link.inertia),
    });
    entries.collect()
}

/// Writes how well a model is known, joints by name.
#[must_use]
pub fn uncertainty_to_wire(uncertainty: &Uncertainty, joints: &[JointSpec]) -> v1::ModelUncertainty {
    let name = |joint: usize| joints.get(joint).map_or_else(String::new, |joint| joint.name.clone());
    let parameters = uncertainty.parameters.iter().map(|parameter| v1::FittedParameter {
        joint: name(parameter.joint),
        kind: kind_to_wire(parameter.kind).into(),
    });
    let residuals = uncertainty.residuals.iter().enumerate();
    let residuals = residuals.map(|(joint, residual)| {
        let degrees = residual.degrees_of_freedom;
        v1::JointResidual {
            joint: name(joint),
            deviation: residual.deviation,
            correlation_time_s: residual.correlation_time,
            degrees_of_freedom: degrees.is_finite().then_some(degrees),
        }
    });
    v1::ModelUncertainty {
        parameters: parameters.collect(),
        covariance: uncertainty.covariance.clone(),
        residuals: residuals.collect(),
    }
}

/// A tensor in the order xx yy zz xy xz yz.
pub(super) fn tensor_to_wire(i: &Matrix3<f64>) -> Vec<f64> {
    vec![i[(0, 0)], i[(1, 1)], i[(2, 2)], i[(0, 1)], i[(0, 2)], i[(1, 2)]]
}

const PAIRS: [(Kind, ParameterKind); 16] = [
    (Kind::Mass, ParameterKind::Mass),
    (Kind::FirstMomentX, ParameterKind::FirstMoment(0)),
    (Kind::FirstMomentY, ParameterKind::FirstMoment(1)),
    (Kind::FirstMomentZ, ParameterKind::FirstMoment(2)),
    (Kind::InertiaXx, ParameterKind::Inertia(0)),
    (Kind::InertiaYy, ParameterKind::Inertia(1)),
    (Kind::InertiaZz, ParameterKind::Inertia(2)),
    (Kind::InertiaXy, ParameterKind::Inertia(3)),
    (Kind::InertiaXz, ParameterKind::Inertia(4)),
    (Kind::InertiaYz, ParameterKind::Inertia(5)),
    (Kind::Armature, ParameterKind::Armature),
    (Kind::Viscous, ParameterKind::Viscous),
    (Kind::CoulombPositive, ParameterKind::CoulombPositive),
    (Kind::CoulombNegative, ParameterKind::CoulombNegative),
    (Kind::LoadCoulomb, ParameterKind::LoadCoulomb),
    (Kind::Quadratic, ParameterKind::Quadratic),
];

/// Which parameter a wire's kind is; `None`: it says nothing.
#[must_use]
pub fn kind_from_wire(kind: Kind) -> Option<ParameterKind> {
    PAIRS.iter().find(|(wire, _)| *wire == kind).map(|(_, domain)| *domain)
}

/// The wire's kind of a parameter.
#[must_use]
pub fn kind_to_wire(kind: ParameterKind) -> Kind {
    let pair = PAIRS.iter().find(|(_, domain)| *domain == kind);
    pair.map_or(Kind::Unspecified, |(wire, _)| *wire)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_of_parameter_goes_both_ways() {
        for number in 1.. {
            let Ok(kind) = Kind::try_from(number) else {
                assert_eq!(usize::try_from(number).unwrap(), PAIRS.len() + 1);
                break;
            };
            assert_eq!(kind_to_wire(kind_from_wire(kind).unwrap()), kind);
        }
        assert_eq!(kind_from_wire(Kind::Unspecified), None);
    }

    #[test]
    fn an_uncertainty_comes_back_as_it_was_written() {
        let entry = v1::ModelUncertainty {
            parameters: vec![v1::FittedParameter {
                joint: "a".to_owned(),
                kind: Kind::InertiaXz.into(),
            }],
            covariance: vec![0.25],
            residuals: vec![
                v1::JointResidual {
                    joint: "a".to_owned(),
                    deviation: 0.5,
                    correlation_time_s: 0.2,
                    degrees_of_freedom: None,
                },
                v1::JointResidual {
                    joint: "b".to_owned(),
                    deviation: 0.1,
                    correlation_time_s: 0.3,
                    degrees_of_freedom: Some(4.0),
                },
            ],
        };
        let mut findings = Findings::default();
        let read = uncertainty(&entry, Path::Root, &mut findings).unwrap();
        assert!(findings.is_empty());
        let joint = |name: &str| JointSpec {
            name: name.to_owned(),
            kind: takt_motion::robot::spec::JointKind::Revolute,
            parent_from_joint: takt_motion::nalgebra::Isometry3::identity(),
            axis: Vector3::z(),
            link: Inertial::zero(),
            limits: takt_motion::robot::spec::Limits::default(),
            drive: takt_motion::robot::spec::Drive::default(),
        };
        let parameters = read.parameters.iter();
        let resolved = Uncertainty {
            parameters: parameters
                .map(|(_, kind)| takt_motion::robot::spec::Parameter { joint: 0, kind: *kind })
                .collect(),
            covariance: read.covariance,
            residuals: read.residuals.into_iter().map(|(_, residual)| residual).collect(),
        };
        assert_eq!(uncertainty_to_wire(&resolved, &[joint("a"), joint("b")]), entry);
    }
}
