//! The band of a drive's torque at one state, from a model's uncertainty, put together without the planner's regressor.
//!
//! Torque is linear in every parameter, so its derivative by one is the difference that a unit of it makes, exactly: an arm is
//! made with one unit more and its torque taken ([`crate::arm`]). A body with a unit more of mass, first moment or inertia about its frame's
//! origin need not exist; the equations of motion do not ask. The deviation is then √(Σᵢⱼ φᵢ·Σᵢⱼ·φⱼ), entry by entry.

use nalgebra::{Matrix3, Vector3};
use takt_motion::robot::spec::{Inertial, Parameter, ParameterKind, RobotSpec, Uncertainty};

use crate::arm::{Arm, Workspace};

/// A state, one entry a joint.
#[derive(Debug, Clone, Copy)]
pub struct At<'a> {
    /// rad or m.
    pub q: &'a [f64],
    /// Its first derivative.
    pub qd: &'a [f64],
    /// Its second derivative.
    pub qdd: &'a [f64],
    /// The direction that Coulomb friction opposes: positive, negative, or 0 at rest.
    pub direction: &'a [f64],
}

/// An arm whose parameters are known within a covariance.
#[derive(Debug)]
pub struct Bands<'a> {
    known: &'a Uncertainty,
    payload: Inertial,
    nominal: Arm,
    /// One a parameter; `None` where the friction law has a form of its own.
    varied: Vec<Option<Arm>>,
}

impl<'a> Bands<'a> {
    /// Bands of a description with `payload` in the tip link's frame; `None`: its own. `None`, where it carries no uncertainty.
    #[must_use]
    pub fn new(spec: &'a RobotSpec, payload: Option<&Inertial>) -> Option<Self> {
        let known = spec.uncertainty.as_ref()?;
        let payload = *payload.unwrap_or(&spec.payload);
        let vary = |parameter: &Parameter| varied(spec, *parameter).map(|spec| Arm::new(&spec, Some(&payload)));
        Some(Self {
            known,
            payload,
            nominal: Arm::new(spec, Some(&payload)),
            varied: known.parameters.iter().map(vary).collect(),
        })
    }

    /// What the arm carries.
    #[must_use]
    pub fn payload(&self) -> &Inertial {
        &self.payload
    }

    /// Torque of every joint, and the standard deviation of what the parameters leave open of it, N m or N.
    #[must_use]
    pub fn at(&self, workspace: &mut Workspace, at: At<'_>) -> (Vec<f64>, Vec<f64>) {
        let count = self.nominal.joint_count();
        let torque = |arm: &Arm, workspace: &mut Workspace| {
            let mut torque = vec![0.0; count];
            arm.drive_torque(workspace, at.q, at.qd, at.qdd, at.direction, &mut torque);
            torque
        };
        let nominal = torque(&self.nominal, workspace);
        let mut gravity = vec![0.0; count];
        let still = vec![0.0; count];
        self.nominal.rigid_torque(workspace, at.q, &still, &still, &mut gravity);
        let rows: Vec<Vec<f64>> = self
            .varied
            .iter()
            .zip(&self.known.parameters)
            .map(|(arm, parameter)| match arm {
                Some(arm) => {
                    let varied = torque(arm, workspace);
                    varied
                        .iter()
                        .zip(&nominal)
                        .map(|(varied, nominal)| varied - nominal)
                        .collect()
                }
                None => friction_row(*parameter, at, &gravity),
            })
            .collect();
        let deviation = (0..count).map(|joint| {
            let mut square = 0.0;
            for (i, one) in rows.iter().enumerate() {
                for (j, other) in rows[..=i].iter().enumerate() {
                    let twice = if i == j { 1.0 } else { 2.0 };
                    square += twice * one[joint] * other[joint] * self.known.covariance[i * (i + 1) / 2 + j];
                }
            }
            square.max(0.0).sqrt()
        });
        let deviation = deviation.collect();
        (nominal, deviation)
    }
}

/// What a unit of a friction coefficient adds: its law, at its joint.
fn friction_row(parameter: Parameter, at: At<'_>, gravity: &[f64]) -> Vec<f64> {
    let joint = parameter.joint;
    let (speed, direction) = (at.qd[joint], at.direction[joint]);
    let side = if direction == 0.0 { 0.0 } else { direction.signum() };
    let mut row = vec![0.0; gravity.len()];
    row[joint] = match parameter.kind {
        ParameterKind::Armature => at.qdd[joint],
        ParameterKind::Viscous => speed,
        ParameterKind::CoulombPositive => side.max(0.0),
        ParameterKind::CoulombNegative => side.min(0.0),
        ParameterKind::LoadCoulomb => side * gravity[joint].abs(),
        ParameterKind::Quadratic => speed * speed.abs(),
        ParameterKind::Mass | ParameterKind::FirstMoment(_) | ParameterKind::Inertia(_) => 0.0,
    };
    row
}

/// The description with a unit more of one parameter of a body; `None` for a drive's.
fn varied(spec: &RobotSpec, parameter: Parameter) -> Option<RobotSpec> {
    let mut spec = spec.clone();
    let body = &mut spec.joints[parameter.joint].link;
    let c = body.center_of_mass;
    let mut mass = body.mass;
    let mut first = c * mass;
    let mut about_origin = body.inertia + steiner(mass, &c);
    match parameter.kind {
        ParameterKind::Mass => mass += 1.0,
        ParameterKind::FirstMoment(axis) => first[axis] += 1.0,
        ParameterKind::Inertia(entry) => {
            let (i, j) = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)][entry];
            about_origin[(i, j)] += 1.0;
            if i != j {
                about_origin[(j, i)] += 1.0;
            }
        }
        _ => return None,
    }
    let center = first / mass;
    *body = Inertial {
        mass,
        center_of_mass: center,
        inertia: about_origin - steiner(mass, &center),
    };
    Some(spec)
}

/// What a mass adds to an inertia where it is `c` away.
fn steiner(mass: f64, c: &Vector3<f64>) -> Matrix3<f64> {
    (Matrix3::identity() * c.norm_squared() - c * c.transpose()) * mass
}
