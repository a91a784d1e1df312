//! What a new revision of a robot would be: its stored description with what was found in place of what it had.
//!
//! The description stays as its caller wrote it, but for the fields that change: a URDF is still that URDF.

use std::sync::Arc;

use takt_motion::{
    drive::friction_change::friction_changes,
    robot::spec::{Drive, Inertial, JointSpec, Parameter, Residual, RobotSpec, Uncertainty},
};
use takt_proto::{convert, v1};

use crate::registry::Compiled;

/// A description that changes.
pub(super) struct Proposal {
    robot: Arc<Compiled>,
    description: v1::RobotDescription,
    /// Indices of the joints that change.
    joints: Vec<usize>,
    friction: Vec<v1::FrictionChange>,
    warnings: Vec<Warning>,
}

/// What is said of some joints, or of none.
struct Warning {
    joints: Vec<usize>,
    text: String,
}

/// How well what changes is known: it is independent of what stays.
#[derive(Debug, Default)]
pub(super) struct Known {
    /// Parameters with their covariance (its lower triangle row by row); those of different entries are independent.
    pub(super) parameters: Vec<(Vec<Parameter>, Vec<f64>)>,
    /// One a joint; `None`: not known.
    pub(super) residuals: Vec<Option<Residual>>,
}

impl Proposal {
    pub(super) fn new(description: v1::RobotDescription, robot: &Arc<Compiled>) -> Self {
        Self {
            robot: Arc::clone(robot),
            description,
            joints: Vec::new(),
            friction: Vec::new(),
            warnings: Vec::new(),
        }
    }

    fn spec(&self) -> &RobotSpec {
        self.robot.robot.spec()
    }

    /// Says something of a joint; what is said of several is one warning.
    pub(super) fn warn(&mut self, joint: usize, texts: impl IntoIterator<Item = String>) {
        for text in texts {
            match self.warnings.iter_mut().find(|warning| warning.text == text) {
                Some(warning) => warning.joints.push(joint),
                None => self.warnings.push(Warning {
                    joints: vec![joint],
                    text,
                }),
            }
        }
    }

    /// Changes friction, rotor inertia and transmission of a joint's drive; what the change returns is handed on.
    pub(super) fn change_drive<T>(&mut self, joint: usize, change: impl FnOnce(&mut Drive) -> T) -> T {
        use v1::friction::Side;
        let spec = &self.robot.robot.spec().joints[joint];
        let mut drive = spec.drive.clone();
        let said = change(&mut drive);
        let changes = friction_changes(&spec.drive, &drive).into_iter();
        let changes = changes.map(|change| convert::drive::friction_change_to_wire(change, &spec.name));
        self.friction.extend(changes);
        let entries = &mut self.description.joints;
        let place = entries
            .iter()
            .position(|entry| entry.name == spec.name)
            .unwrap_or_else(|| {
                entries.push(v1::JointDescription {
                    name: spec.name.clone(),
                    ..Default::default()
                });
                entries.len() - 1
            });
        let wire = entries[place].drive.get_or_insert_default();
        if drive.stiffness != spec.drive.stiffness {
            wire.stiffness.clone_from(&drive.stiffness);
        }
        if drive.damping != spec.drive.damping {
            wire.damping = drive.damping;
        }
        if drive.rotor_inertia.to_bits() != spec.drive.rotor_inertia.to_bits() {
            wire.rotor_inertia_kg_m2 = Some(drive.rotor_inertia);
        }
        let before = (&spec.drive.motor_friction, &spec.drive.joint_friction);
        if (&drive.motor_friction, &drive.joint_friction) != before {
            // The joint's side is said even where it is nothing: an empty list would leave it to the URDF.
            wire.friction = vec![convert::robot::friction_to_wire(Side::Joint, &drive.joint_friction)];
            if !drive.motor_friction.is_zero() {
                let motor = convert::robot::friction_to_wire(Side::Motor, &drive.motor_friction);
                wire.friction.insert(0, motor);
            }
        }
        self.joints.push(joint);
        said
    }

    /// Puts a body in the place of a joint's, where it is another one.
    pub(super) fn change_body(&mut self, joint: usize, fitted: &JointSpec) {
        if self.spec().joints[joint].link == fitted.link {
            return;
        }
        let bodies = &mut self.description.link_inertia;
        bodies.retain(|body| body.joint != fitted.name);
        bodies.extend(convert::robot::link_inertia_to_wire([fitted]));
    }

    /// Puts another payload in the place of the model's.
    pub(super) fn change_payload(&mut self, payload: &Inertial) {
        self.description.payload = Some(convert::robot::payload_to_wire(payload));
    }

    /// States how well the model is known from now on, all of it.
    pub(super) fn know_all(&mut self, uncertainty: Option<&Uncertainty>) {
        let joints = &self.robot.robot.spec().joints;
        self.description.uncertainty =
            uncertainty.map(|uncertainty| convert::robot::uncertainty_to_wire(uncertainty, joints));
    }

    /// States how well the model is known from now on. What was known of other parameters stays; that of the ones that
    /// change is replaced, and their correlation with others is dropped with it.
    pub(super) fn know(&mut self, known: Known) {
        if known.parameters.is_empty() {
            return;
        }
        let before = self.spec().uncertainty.as_ref();
        let residuals = known.residuals.iter().enumerate();
        let residuals = residuals.map(|(joint, residual)| residual.or_else(|| Some(before?.residuals[joint])));
        let Some(residuals) = residuals.collect::<Option<Vec<_>>>() else {
            self.warnings.push(Warning {
                joints: Vec::new(),
                text: "how well it is known is left out: not every joint has moved for long enough to say what is left of its \
                       torque"
                    .to_owned(),
            });
            self.description.uncertainty = None;
            return;
        };
        let mut blocks: Vec<(Vec<Parameter>, Vec<f64>)> = known.parameters;
        if let Some(before) = before {
            let changed: Vec<Parameter> = blocks.iter().flat_map(|(parameters, _)| parameters).copied().collect();
            blocks.insert(0, without(before, &changed));
        }
        let uncertainty = Uncertainty {
            parameters: blocks.iter().flat_map(|(parameters, _)| parameters).copied().collect(),
            covariance: side_by_side(&blocks),
            residuals,
        };
        let wire = convert::robot::uncertainty_to_wire(&uncertainty, &self.spec().joints);
        self.description.uncertainty = Some(wire);
    }

    /// The proposal; `None` where nothing changes.
    pub(super) fn finish(mut self, source: &str, note: String) -> Option<v1::ModelProposal> {
        if self.joints.is_empty() {
            return None;
        }
        let base_revision = self.robot.revision.to_string();
        self.description.origin = Some(v1::ModelOrigin {
            source: source.to_owned(),
            base_revision: base_revision.clone(),
            note,
        });
        let spec = self.robot.robot.spec();
        Some(v1::ModelProposal {
            base_revision,
            joints: self
                .joints
                .iter()
                .map(|joint| spec.joints[*joint].name.clone())
                .collect(),
            description: Some(self.description),
            warnings: self.warnings.iter().map(|warning| warning.sentence(spec)).collect(),
            friction: self.friction,
        })
    }
}

impl Warning {
    fn sentence(&self, spec: &RobotSpec) -> String {
        let names: Vec<&str> = self
            .joints
            .iter()
            .map(|joint| spec.joints[*joint].name.as_str())
            .collect();
        match names[..] {
            [] => self.text.clone(),
            [name] => format!("joint {name}: {}", self.text),
            _ => format!("joints {}: {}", names.join(", "), self.text),
        }
    }
}

/// Place of an entry in a lower triangle row by row.
fn entry(a: usize, b: usize) -> usize {
    let (row, column) = (a.max(b), a.min(b));
    row * (row + 1) / 2 + column
}

/// What is known of the other parameters.
fn without(known: &Uncertainty, changed: &[Parameter]) -> (Vec<Parameter>, Vec<f64>) {
    let kept: Vec<usize> = (0..known.parameters.len())
        .filter(|index| !changed.contains(&known.parameters[*index]))
        .collect();
    let covariance = kept
        .iter()
        .enumerate()
        .flat_map(|(row, &a)| kept[..=row].iter().map(move |&b| entry(a, b)))
        .map(|place| known.covariance[place]);
    let covariance = covariance.collect();
    (kept.iter().map(|index| known.parameters[*index]).collect(), covariance)
}

/// Covariances of what is independent, as one.
fn side_by_side(blocks: &[(Vec<Parameter>, Vec<f64>)]) -> Vec<f64> {
    let mut whole = Vec::new();
    let mut before = 0;
    for (parameters, covariance) in blocks {
        for row in 0..parameters.len() {
            whole.extend(std::iter::repeat_n(0.0, before));
            whole.extend_from_slice(&covariance[entry(row, 0)..=entry(row, row)]);
        }
        before += parameters.len();
    }
    whole
}

#[cfg(test)]
mod tests {
    use takt_motion::robot::spec::ParameterKind;

    use super::*;

    fn parameter(joint: usize, kind: ParameterKind) -> Parameter {
        Parameter { joint, kind }
    }

    #[test]
    fn what_changes_takes_the_place_of_what_was_known_of_it() {
        use ParameterKind::{CoulombPositive, Mass, Viscous};
        let before = Uncertainty {
            parameters: vec![parameter(0, Mass), parameter(0, Viscous), parameter(1, Mass)],
            covariance: vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0],
            residuals: Vec::new(),
        };
        let changed = [parameter(0, Viscous), parameter(0, CoulombPositive)];
        let kept = without(&before, &changed);
        assert_eq!(
            kept,
            (vec![parameter(0, Mass), parameter(1, Mass)], vec![1.0, 4.0, 6.0])
        );
        let whole = side_by_side(&[kept, (changed.to_vec(), vec![7.0, 8.0, 9.0])]);
        assert_eq!(whole, [1.0, 4.0, 6.0, 0.0, 0.0, 7.0, 0.0, 0.0, 8.0, 9.0]);
    }
}
