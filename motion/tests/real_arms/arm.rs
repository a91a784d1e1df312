//! A chain beside its oracle file, and the textbook formulas that compare them.
//!
//! With z the axes, o the joint origins and c the centres of mass in base axes: Jv = z × (c − o) and Jω = z for a
//! revolute joint, Jv = z and Jω = 0 for a prismatic one; M = Σ m Jvᵀ Jv + Jωᵀ I Jω and g = −Σ m Jvᵀ g₀.

use std::fs;
use std::path::Path;

use serde_json::Value;
use takt_motion::nalgebra::{
    DMatrix, DVector, Isometry3, Matrix3, Matrix3xX, Point3, Rotation3, Translation3, Unit, UnitQuaternion, Vector3,
};
use takt_motion::robot::description::{Description, Kinematics};
use takt_motion::robot::resolve::Resolved;
use takt_motion::robot::spec::{Inertial, JointKind, RobotSpec};
use takt_motion::robot::urdf_writer;

/// Largest difference to the oracle, relative to the largest entry of a vector or matrix: the engines agree among
/// themselves to 3e-15, sums over a chain of seven round a little more.
const TOLERANCE: f64 = 1e-9;

/// What is compared, and against which values.
pub(crate) struct Arm {
    pub(crate) resolved: Resolved,
    oracle: Value,
}

/// Text of a file, from the workspace's top.
pub(crate) fn text(path: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(path);
    fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// JSON of a file, from the workspace's top.
pub(crate) fn json(path: &str) -> Value {
    serde_json::from_str(&text(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

impl Arm {
    /// The chain that the oracle file names, from a URDF.
    pub(crate) fn urdf(folder: &str, urdf: &str, oracle: &str) -> Self {
        let oracle = json(&format!("tests/vectors/robots/{folder}/{oracle}"));
        let link = |key: &str| oracle[key].as_str().map(str::to_owned);
        let description = Description::new(Kinematics::Urdf {
            text: text(&format!("tests/vectors/robots/{folder}/{urdf}")),
            base_link: link("root_link"),
            tip_link: link("tip_link"),
        });
        Self::described(description, oracle)
    }

    /// Any description beside any oracle; its gravity becomes the oracle's.
    pub(crate) fn described(mut description: Description, oracle: Value) -> Self {
        description.gravity = Some(Vector3::from_column_slice(&numbers(&oracle["gravity"])));
        let resolved = description.resolve().unwrap_or_else(|errors| panic!("{errors:#?}"));
        Self { resolved, oracle }
    }

    /// The same arm, written as a URDF and read again.
    pub(crate) fn rewritten(self) -> Self {
        let kinematics = Kinematics::Urdf {
            text: urdf_writer::write(&self.resolved.spec, "arm"),
            base_link: None,
            tip_link: None,
        };
        Self::described(Description::new(kinematics), self.oracle)
    }

    /// Joint names and limits, and everything below.
    pub(crate) fn check(&self) {
        self.check_joints();
        self.check_poses();
        self.check_dynamics(TOLERANCE);
    }

    fn check_joints(&self) {
        let joints = self.oracle["joints"].as_array().expect("an oracle has joints");
        let spec = &self.resolved.spec;
        assert_eq!(spec.joints.len(), joints.len());
        for (joint, oracle) in spec.joints.iter().zip(joints) {
            // The PUMA's file has names alone.
            let Some(name) = oracle["name"].as_str() else {
                assert_eq!(joint.name, oracle.as_str().expect("a name"));
                continue;
            };
            assert_eq!(joint.name, name);
            let kind = match joint.kind {
                JointKind::Revolute => "revolute",
                JointKind::Continuous => "continuous",
                JointKind::Prismatic => "prismatic",
            };
            assert_eq!(kind, oracle["type"]);
            assert_eq!(joint.limits.position_lower, oracle["lower"].as_f64());
            assert_eq!(joint.limits.position_upper, oracle["upper"].as_f64());
            assert_eq!(joint.limits.velocity, oracle["velocity"].as_f64());
            assert_eq!(joint.drive.peak_torque, oracle["effort"].as_f64());
        }
    }

    /// The tip at every state.
    fn check_poses(&self) {
        for state in self.states() {
            let tip = Posed::at(&self.resolved.spec, &numbers(&state["q"])).tip;
            let position = tip.translation.vector;
            check_close(
                "tip position",
                position.as_slice(),
                &numbers(&state["tip_position"]),
                TOLERANCE,
            );
            let rotation = tip.rotation.to_rotation_matrix();
            let rows = rotation.matrix().transpose();
            check_close(
                "tip rotation",
                rows.as_slice(),
                &numbers(&state["tip_rotation"]),
                TOLERANCE,
            );
        }
    }

    /// Mass matrices and gravity torques, which together determine every torque of a rigid-body chain.
    pub(crate) fn check_dynamics(&self, tolerance: f64) {
        for state in self.states() {
            let posed = Posed::at(&self.resolved.spec, &numbers(&state["q"]));
            let mass_matrix = [&state["mass_matrix"], &state["mass_matrix_rigid"]];
            let mass_matrix = mass_matrix.into_iter().find(|matrix| !matrix.is_null());
            let mass_matrix = numbers(mass_matrix.expect("a state has a mass matrix"));
            check_close("mass matrix", posed.mass_matrix().as_slice(), &mass_matrix, tolerance);
            let gravity_torque = numbers(&state["tau_gravity"]);
            check_close(
                "gravity torque",
                posed.gravity_torque().as_slice(),
                &gravity_torque,
                tolerance,
            );
        }
    }

    fn states(&self) -> &[Value] {
        let states = self.oracle["states"].as_array().expect("an oracle has states");
        assert!(!states.is_empty());
        states
    }
}

/// A chain in one pose, everything in base axes.
struct Posed<'a> {
    spec: &'a RobotSpec,
    joints: Vec<Isometry3<f64>>,
    tip: Isometry3<f64>,
}

impl<'a> Posed<'a> {
    fn at(spec: &'a RobotSpec, q: &[f64]) -> Self {
        let mut pose = Isometry3::identity();
        let mut joints = Vec::new();
        for (joint, q) in spec.joints.iter().zip(q) {
            let motion = match joint.kind {
                JointKind::Prismatic => {
                    Isometry3::from_parts(Translation3::from(joint.axis * *q), UnitQuaternion::identity())
                }
                JointKind::Revolute | JointKind::Continuous => {
                    let rotation = Rotation3::from_axis_angle(&Unit::new_unchecked(joint.axis), *q);
                    Isometry3::from_parts(
                        Translation3::identity(),
                        UnitQuaternion::from_rotation_matrix(&rotation),
                    )
                }
            };
            pose = pose * joint.parent_from_joint * motion;
            joints.push(pose);
        }
        let tip = pose * spec.link_from_tip;
        Self { spec, joints, tip }
    }

    /// Jv of a link's centre of mass and Jω of the link.
    fn jacobians(&self, link: usize, center: &Vector3<f64>) -> (Matrix3xX<f64>, Matrix3xX<f64>) {
        let mut linear = Matrix3xX::zeros(self.joints.len());
        let mut angular = Matrix3xX::zeros(self.joints.len());
        for (index, pose) in self.joints.iter().enumerate().take(link + 1) {
            let axis = pose * self.spec.joints[index].axis;
            if self.spec.joints[index].kind == JointKind::Prismatic {
                linear.set_column(index, &axis);
            } else {
                linear.set_column(index, &axis.cross(&(center - pose.translation.vector)));
                angular.set_column(index, &axis);
            }
        }
        (linear, angular)
    }

    fn body(&self, link: usize) -> (f64, Vector3<f64>, Matrix3<f64>) {
        let Inertial {
            mass,
            center_of_mass,
            inertia,
        } = self.spec.joints[link].link;
        let pose = &self.joints[link];
        let rotation = pose.rotation.to_rotation_matrix();
        let center = (pose * Point3::from(center_of_mass)).coords;
        (
            mass,
            center,
            rotation.matrix() * inertia * rotation.matrix().transpose(),
        )
    }

    fn mass_matrix(&self) -> DMatrix<f64> {
        let count = self.joints.len();
        let mut matrix = DMatrix::zeros(count, count);
        for link in 0..count {
            let (mass, center, inertia) = self.body(link);
            let (linear, angular) = self.jacobians(link, &center);
            matrix += linear.transpose() * &linear * mass + angular.transpose() * inertia * &angular;
        }
        matrix
    }

    fn gravity_torque(&self) -> DVector<f64> {
        let mut torque = DVector::zeros(self.joints.len());
        for link in 0..self.joints.len() {
            let (mass, center, _) = self.body(link);
            let (linear, _) = self.jacobians(link, &center);
            torque -= linear.transpose() * self.spec.gravity * mass;
        }
        torque
    }
}

/// Numbers of a JSON array, rows of rows one after another.
pub(crate) fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(values) => values.iter().flat_map(numbers).collect(),
        other => vec![other.as_f64().unwrap_or_else(|| panic!("{other} is not a number"))],
    }
}

fn check_close(what: &str, actual: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(actual.len(), expected.len(), "{what}");
    let scale = expected.iter().fold(1e-6_f64, |scale, value| scale.max(value.abs()));
    for (actual_entry, expected_entry) in actual.iter().zip(expected) {
        let difference = (actual_entry - expected_entry).abs() / scale;
        assert!(
            difference <= tolerance,
            "{what}: off by {difference:e}\n{actual:?}\n{expected:?}"
        );
    }
}
