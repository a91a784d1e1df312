//! What a fit solves for: the order of its unknowns, what is known of them beforehand, and the model that they make.

use nalgebra::{Matrix4, Vector3};

use super::pseudo;
use super::report::{Scope, Unknown};
use crate::dynamics::regressor::{self, BODY, PER_JOINT, body_of, body_parameters, kinds};
use crate::robot::Robot;
use crate::robot::spec::{Friction, Inertial, Parameter, ParameterKind, RobotSpec};

/// The unknowns of a fit.
#[derive(Debug, Clone)]
pub(crate) struct Unknowns {
    /// In the order of the solution.
    pub(crate) list: Vec<Unknown>,
    /// The description's values, bodies made sound.
    pub(crate) described: Vec<f64>,
    /// Where the ten parameters of each body begin that is fitted.
    pub(crate) bodies: Vec<usize>,
    /// Values of all parameters of the joints, and of the payload, as described.
    pub(crate) joints: Vec<f64>,
    pub(crate) payload: [f64; BODY],
    /// Of each joint, where it has one.
    pub(crate) speed_limits: Vec<Option<f64>>,
}

impl Unknowns {
    pub(crate) fn new(robot: &Robot, scope: Scope) -> Self {
        let spec = robot.spec();
        let joints = regressor::values(spec);
        let mut unknowns = Self {
            list: Vec::new(),
            described: Vec::new(),
            bodies: Vec::new(),
            payload: body_parameters(robot.payload()),
            speed_limits: speed_limits(robot),
            joints,
        };
        for (joint, of) in spec.joints.iter().enumerate() {
            if scope == Scope::Bodies
                && let Some(sound) = pseudo::sound(&of.link)
            {
                unknowns.bodies.push(unknowns.list.len());
                for (kind, value) in kinds().into_iter().zip(sound) {
                    unknowns.push(Unknown::Joint(Parameter { joint, kind }), value);
                }
            }
            for kind in &kinds()[BODY..] {
                if *kind == ParameterKind::Armature && !matches!(scope, Scope::Bodies | Scope::Rotors) {
                    continue;
                }
                let parameter = Parameter { joint, kind: *kind };
                let described = unknowns.joints[regressor::column(parameter)];
                unknowns.push(Unknown::Joint(parameter), described);
            }
        }
        if scope == Scope::Payload {
            unknowns.bodies.push(unknowns.list.len());
            let described = pseudo::sound(robot.payload()).unwrap_or([0.0; BODY]);
            for (k, value) in described.into_iter().enumerate() {
                unknowns.push(Unknown::Payload(k), value);
            }
        }
        unknowns
    }

    /// Given parameters of the joints.
    pub(crate) fn of(robot: &Robot, parameters: &[Parameter]) -> Self {
        let joints = regressor::values(robot.spec());
        Self {
            list: parameters.iter().map(|parameter| Unknown::Joint(*parameter)).collect(),
            described: parameters
                .iter()
                .map(|parameter| joints[regressor::column(*parameter)])
                .collect(),
            bodies: Vec::new(),
            payload: body_parameters(robot.payload()),
            speed_limits: speed_limits(robot),
            joints,
        }
    }

    fn push(&mut self, unknown: Unknown, described: f64) {
        self.list.push(unknown);
        self.described.push(described);
    }

    /// How many there are.
    pub(crate) fn count(&self) -> usize {
        self.list.len()
    }

    /// Whether an unknown is a magnitude: of friction or of a rotor.
    pub(crate) fn is_magnitude(&self, index: usize) -> bool {
        match self.list[index] {
            Unknown::Joint(parameter) => regressor::column(parameter) % PER_JOINT >= BODY,
            Unknown::Payload(_) => false,
        }
    }

    /// Where a joint's parameter is among the unknowns.
    pub(crate) fn index(&self, joint: usize, kind: ParameterKind) -> Option<usize> {
        let wanted = Unknown::Joint(Parameter { joint, kind });
        self.list.iter().position(|unknown| *unknown == wanted)
    }

    /// The description with a solution in it: friction all on the joint's side, deflections before sliding as found.
    pub(crate) fn model(&self, robot: &Robot, solution: &[f64], deflections: &[Option<f64>]) -> RobotSpec {
        let mut spec = robot.spec().clone();
        let mut joints = self.joints.clone();
        let mut payload = self.payload;
        for (unknown, value) in self.list.iter().zip(solution) {
            match unknown {
                Unknown::Joint(parameter) => joints[regressor::column(*parameter)] = *value,
                Unknown::Payload(k) => payload[*k] = *value,
            }
        }
        for (i, joint) in spec.joints.iter_mut().enumerate() {
            let values = &joints[i * PER_JOINT..(i + 1) * PER_JOINT];
            if self.index(i, ParameterKind::Mass).is_some() {
                joint.link = body_from(&values[..BODY]);
            }
            if self.index(i, ParameterKind::Armature).is_some() {
                joint.drive.rotor_inertia = values[BODY] / (joint.drive.gear_ratio * joint.drive.gear_ratio);
            }
            joint.drive.motor_friction = Friction::default();
            let mean = 0.5 * (values[BODY + 2] + values[BODY + 3]);
            joint.drive.joint_friction = Friction {
                viscous: values[BODY + 1],
                coulomb_positive: values[BODY + 2],
                coulomb_negative: values[BODY + 3],
                load_coulomb: values[BODY + 4],
                quadratic: values[BODY + 5],
                presliding_stiffness: deflections[i]
                    .filter(|_| mean > 0.0)
                    .map(|deflection| mean / deflection),
            };
        }
        spec.payload = *robot.payload();
        if self.list.contains(&Unknown::Payload(0)) {
            spec.payload = body_from(&payload);
        }
        spec
    }
}

fn speed_limits(robot: &Robot) -> Vec<Option<f64>> {
    robot.spec().joints.iter().map(|joint| joint.limits.velocity).collect()
}

fn body_from(values: &[f64]) -> Inertial {
    let mut parameters = [0.0; BODY];
    parameters.copy_from_slice(values);
    body_of(&parameters)
}

/// How the ten parameters of a body on the tip link change the last link's: 10 × 10, for its covariance.
pub(crate) fn tip_onto_last_link(spec: &RobotSpec) -> [[f64; BODY]; BODY] {
    let pose = spec.link_from_tip.to_homogeneous();
    let mut onto = [[0.0; BODY]; BODY];
    for k in 0..BODY {
        let mut unit = [0.0; BODY];
        unit[k] = 1.0;
        let moved: Matrix4<f64> = pose * pseudo::matrix(&unit) * pose.transpose();
        for (row, value) in onto.iter_mut().zip(of_matrix(&moved)) {
            row[k] = value;
        }
    }
    onto
}

/// The ten parameters of a pseudo-inertia.
fn of_matrix(p: &Matrix4<f64>) -> [f64; BODY] {
    let trace = p.m11 + p.m22 + p.m33;
    let first = Vector3::new(p.m14, p.m24, p.m34);
    [
        p.m44,
        first.x,
        first.y,
        first.z,
        trace - p.m11,
        trace - p.m22,
        trace - p.m33,
        -p.m12,
        -p.m13,
        -p.m23,
    ]
}

/// Friction as a joint's description says it: what the contact's deflection before sliding is, where it has a stiffness.
pub(crate) fn deflection(robot: &Robot, joint: usize) -> Option<f64> {
    let drive = &robot.spec().joints[joint].drive;
    let ratio = drive.gear_ratio.abs();
    let of = |friction: &Friction, scale: f64, stiffness_scale: f64| {
        let stiffness = friction.presliding_stiffness? * stiffness_scale;
        let coulomb = 0.5 * (friction.coulomb_positive + friction.coulomb_negative) * scale;
        (coulomb > 0.0 && stiffness > 0.0).then(|| coulomb / stiffness)
    };
    // a deflection on the motor's side is a ratio-th of it at the joint
    of(&drive.joint_friction, 1.0, 1.0).or_else(|| of(&drive.motor_friction, ratio, ratio * ratio))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_arms::{random_arm, robot};

    #[test]
    fn the_described_values_make_the_described_arm() {
        let mut spec = random_arm(4, 2);
        for joint in &mut spec.joints {
            joint.link = body_of(&pseudo::sound(&joint.link).unwrap());
        }
        let arm = robot(spec);
        for scope in [Scope::Friction, Scope::Payload, Scope::Rotors, Scope::Bodies] {
            let unknowns = Unknowns::new(&arm, scope);
            let model = unknowns.model(&arm, &unknowns.described, &[None; 4]);
            let (before, after) = (regressor::values(arm.spec()), regressor::values(&model));
            for (x, y) in before.iter().zip(&after) {
                assert!((x - y).abs() < 1e-12 * (1.0 + x.abs()));
            }
            let (before, after) = (body_parameters(&arm.spec().payload), body_parameters(&model.payload));
            for (x, y) in before.iter().zip(&after) {
                assert!((x - y).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn a_payload_on_the_last_link_is_the_payload_seen_from_there() {
        let spec = random_arm(3, 5);
        let onto = tip_onto_last_link(&spec);
        let at_tip = body_parameters(&spec.payload);
        let expected = body_parameters(&spec.payload.seen_from(&spec.link_from_tip));
        for (row, expected) in onto.iter().zip(expected) {
            let found: f64 = row.iter().zip(at_tip).map(|(a, b)| a * b).sum();
            assert!((found - expected).abs() < 1e-12);
        }
    }
}
