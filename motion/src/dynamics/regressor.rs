//! The regressor of a robot: its drive torques as a product that is linear in the parameters of its links and drives.
//!
//! ```text
//! τ = Y(q, q̇, q̈)·π
//! ```
//!
//! A joint has [`PER_JOINT`] parameters, in the order of [`kinds`]: ten of the link (mass, first moment m·c, inertia tensor about
//! the joint frame's origin, in that frame), reflected rotor inertia, viscous, Coulomb by direction, load-dependent Coulomb,
//! quadratic. The payload has the link's ten, about the tip link's frame.
//!
//! With ω, ω̇ the turning of link j and a the acceleration of its origin less gravity, all in its own frame, the link asks the
//! force f = m·a + Ω·(m·c) and, about its origin, the moment n = (m·c) × a + I·ω̇ + ω × I·ω, with Ω = S(ω̇) + S(ω)·S(ω), S(ω)·x = ω × x. A unit
//! motion of joint i turns link j by ζ and moves its origin by λ, so by the principle of virtual work τᵢ = λ·f + ζ·n: every
//! coefficient is a product of a, ω, ω̇ with λ and ζ (W. Khalil, E. Dombre, "Modeling, Identification and Control of Robots", 2002, §9.4).
//!
//! The load-dependent Coulomb term |g|·sgn q̇ takes the gravity torque g of the robot as it is, payload included: it would not be
//! linear otherwise. At standstill nothing slides, and every friction coefficient is 0.

use nalgebra::{Isometry3, Matrix3, Vector3};

use super::Workspace;
use crate::kinematics::motion;
use crate::robot::Robot;
use crate::robot::spec::{Inertial, JointKind, JointSpec, Parameter, ParameterKind, RobotSpec};

/// Parameters of a rigid body: mass, first moment, inertia about the origin of its frame.
pub const BODY: usize = 10;

/// Parameters of a joint: its link's and its drive's.
pub const PER_JOINT: usize = BODY + 6;

/// What the parameters of a joint are, in the order of the columns.
#[must_use]
pub fn kinds() -> [ParameterKind; PER_JOINT] {
    use ParameterKind as K;
    [
        K::Mass,
        K::FirstMoment(0),
        K::FirstMoment(1),
        K::FirstMoment(2),
        K::Inertia(0),
        K::Inertia(1),
        K::Inertia(2),
        K::Inertia(3),
        K::Inertia(4),
        K::Inertia(5),
        K::Armature,
        K::Viscous,
        K::CoulombPositive,
        K::CoulombNegative,
        K::LoadCoulomb,
        K::Quadratic,
    ]
}

/// Column of a parameter in a row of the regressor. Coordinates beyond the last stand for the last.
#[must_use]
pub fn column(parameter: Parameter) -> usize {
    use ParameterKind as K;
    let within = match parameter.kind {
        K::Mass => 0,
        K::FirstMoment(axis) => 1 + axis.min(2),
        K::Inertia(entry) => 4 + entry.min(5),
        K::Armature => BODY,
        K::Viscous => BODY + 1,
        K::CoulombPositive => BODY + 2,
        K::CoulombNegative => BODY + 3,
        K::LoadCoulomb => BODY + 4,
        K::Quadratic => BODY + 5,
    };
    parameter.joint * PER_JOINT + within
}

/// The parameters of all joints, in the order of the columns.
#[must_use]
pub fn parameters(joint_count: usize) -> Vec<Parameter> {
    let of_joint = |joint| kinds().map(|kind| Parameter { joint, kind });
    (0..joint_count).flat_map(of_joint).collect()
}

/// The ten parameters of a body about the origin of the frame that it is given in.
#[must_use]
pub fn body_parameters(body: &Inertial) -> [f64; BODY] {
    let c = body.center_of_mass;
    let first = c * body.mass;
    let about_origin = body.inertia + (Matrix3::identity() * c.norm_squared() - c * c.transpose()) * body.mass;
    let i = about_origin;
    [
        body.mass, first.x, first.y, first.z, i.m11, i.m22, i.m33, i.m12, i.m13, i.m23,
    ]
}

/// The body of ten parameters; its centre of mass is the frame's origin where it has no mass.
#[must_use]
pub fn body_of(parameters: &[f64; BODY]) -> Inertial {
    let [mass, hx, hy, hz, xx, yy, zz, xy, xz, yz] = *parameters;
    let first = Vector3::new(hx, hy, hz);
    let about_origin = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
    if mass == 0.0 {
        return Inertial {
            mass,
            center_of_mass: Vector3::zeros(),
            inertia: about_origin,
        };
    }
    let c = first / mass;
    Inertial {
        mass,
        center_of_mass: c,
        inertia: about_origin - (Matrix3::identity() * c.norm_squared() - c * c.transpose()) * mass,
    }
}

/// The parameters π of a description, in the order of the columns.
#[must_use]
pub fn values(spec: &RobotSpec) -> Vec<f64> {
    let mut values = Vec::with_capacity(spec.joints.len() * PER_JOINT);
    for joint in &spec.joints {
        values.extend(body_parameters(&joint.link));
        let drive = &joint.drive;
        let (ratio, motor, side) = (drive.gear_ratio, drive.motor_friction, drive.joint_friction);
        let speed = ratio.abs();
        values.extend([
            ratio * ratio * drive.rotor_inertia,
            ratio * ratio * motor.viscous + side.viscous,
            speed * motor.coulomb_positive + side.coulomb_positive,
            speed * motor.coulomb_negative + side.coulomb_negative,
            motor.load_coulomb + side.load_coulomb,
            speed * speed * speed * motor.quadratic + side.quadratic,
        ]);
    }
    values
}

/// The regressor of one state; scratch that is reused from state to state and allocates nothing after its making.
#[derive(Debug)]
pub struct Regressor {
    rows: Vec<f64>,
    payload: Vec<[f64; BODY]>,
    frames: Vec<Frame>,
    gravity_torque: Vec<f64>,
    workspace: Workspace,
}

/// A link's frame in base axes, and how a unit motion of its joint acts.
#[derive(Debug, Clone, Copy)]
struct Frame {
    base_from_link: Isometry3<f64>,
    axis: Vector3<f64>,
    slides: bool,
}

/// Turning of a body and acceleration of its frame's origin less gravity, in its frame.
#[derive(Debug, Clone, Copy)]
struct BodyMotion {
    spin: Vector3<f64>,
    spin_rate: Vector3<f64>,
    acceleration: Vector3<f64>,
}

impl Regressor {
    /// Scratch for a robot, or for any with as many joints.
    #[must_use]
    pub fn new(robot: &Robot) -> Self {
        let count = robot.joint_count();
        let still = Frame {
            base_from_link: Isometry3::identity(),
            axis: Vector3::zeros(),
            slides: false,
        };
        Self {
            rows: vec![0.0; count * count * PER_JOINT],
            payload: vec![[0.0; BODY]; count],
            frames: vec![still; count],
            gravity_torque: vec![0.0; count],
            workspace: Workspace::new(robot),
        }
    }

    /// Computes the regressor of a state: positions rad or m, velocities and accelerations, one value a joint.
    pub fn compute(&mut self, robot: &Robot, q: &[f64], qd: &[f64], qdd: &[f64]) {
        super::gravity_torque(robot, &mut self.workspace, q, &mut self.gravity_torque);
        let spec = robot.spec();
        let mut base_from_link = Isometry3::identity();
        let mut carried = BodyMotion {
            spin: Vector3::zeros(),
            spin_rate: Vector3::zeros(),
            acceleration: -spec.gravity,
        };
        for (j, joint) in spec.joints.iter().enumerate() {
            let slides = joint.kind == JointKind::Prismatic;
            let at_joint = carried.seen_from(&joint.parent_from_joint);
            carried = at_joint.moved(joint, slides, q[j], qd[j], qdd[j]);
            let base_from_joint = base_from_link * joint.parent_from_joint;
            base_from_link = base_from_joint * motion(joint, q[j]);
            self.frames[j] = Frame {
                base_from_link,
                axis: base_from_joint * joint.axis,
                slides,
            };
            for i in 0..self.frames.len() {
                let row = i * self.frames.len() * PER_JOINT + j * PER_JOINT;
                let columns = &mut self.rows[row..row + PER_JOINT];
                columns.fill(0.0);
                if i <= j {
                    let body = self.frames[i].columns(&base_from_link, &carried);
                    columns[..BODY].copy_from_slice(&body);
                }
            }
            let row = j * self.frames.len() * PER_JOINT + j * PER_JOINT;
            let drive = &mut self.rows[row + BODY..row + PER_JOINT];
            drive.copy_from_slice(&drive_columns(qd[j], qdd[j], self.gravity_torque[j]));
        }
        let on_tip = carried.seen_from(&spec.link_from_tip);
        let base_from_tip = base_from_link * spec.link_from_tip;
        for (payload, frame) in self.payload.iter_mut().zip(&self.frames) {
            *payload = frame.columns(&base_from_tip, &on_tip);
        }
    }

    /// Derivatives of a joint's torque by the parameters of all joints, in the order of [`parameters`].
    #[must_use]
    pub fn row(&self, joint: usize) -> &[f64] {
        let width = self.frames.len() * PER_JOINT;
        &self.rows[joint * width..(joint + 1) * width]
    }

    /// Derivatives of a joint's torque by the payload's ten parameters, about the tip link's frame.
    #[must_use]
    pub fn payload_row(&self, joint: usize) -> &[f64; BODY] {
        &self.payload[joint]
    }

    /// Gravity torque of the state, N m or N, payload included.
    #[must_use]
    pub fn gravity_torque(&self, joint: usize) -> f64 {
        self.gravity_torque[joint]
    }
}

/// Columns of the drive: armature, viscous, Coulomb positive and negative, load Coulomb, quadratic.
fn drive_columns(qd: f64, qdd: f64, gravity_torque: f64) -> [f64; PER_JOINT - BODY] {
    let positive = if qd > 0.0 { 1.0 } else { 0.0 };
    let negative = if qd < 0.0 { -1.0 } else { 0.0 };
    [
        qdd,
        qd,
        positive,
        negative,
        (positive + negative) * gravity_torque.abs(),
        qd * qd.abs(),
    ]
}

impl Frame {
    /// Torque about this joint of each of the ten parameters of a body whose frame moves as said.
    fn columns(&self, base_from_body: &Isometry3<f64>, body: &BodyMotion) -> [f64; BODY] {
        let turn = base_from_body.rotation.inverse();
        let axis = turn * self.axis;
        let (turned, moved) = if self.slides {
            (Vector3::zeros(), axis)
        } else {
            let lever = base_from_body.translation.vector - self.base_from_link.translation.vector;
            (axis, turn * self.axis.cross(&lever))
        };
        let (w, wd, a) = (body.spin, body.spin_rate, body.acceleration);
        // Ωᵀ·λ = λ × ω̇ + ω × (ω × λ)
        let first = a.cross(&turned) + moved.cross(&wd) + w.cross(&w.cross(&moved));
        // ζ·(ω × I·ω) = (ζ × ω)·I·ω
        let v = turned.cross(&w);
        let pair = |i: usize, k: usize| turned[i] * wd[k] + v[i] * w[k];
        [
            moved.dot(&a),
            first.x,
            first.y,
            first.z,
            pair(0, 0),
            pair(1, 1),
            pair(2, 2),
            pair(0, 1) + pair(1, 0),
            pair(0, 2) + pair(2, 0),
            pair(1, 2) + pair(2, 1),
        ]
    }
}

impl BodyMotion {
    /// The motion of a frame that is fixed to this one.
    fn seen_from(&self, here_from_there: &Isometry3<f64>) -> Self {
        let lever = here_from_there.translation.vector;
        let swept = self.spin.cross(&lever);
        let turn = here_from_there.rotation.inverse();
        Self {
            spin: turn * self.spin,
            spin_rate: turn * self.spin_rate,
            acceleration: turn * (self.acceleration + self.spin_rate.cross(&lever) + self.spin.cross(&swept)),
        }
    }

    /// The motion of a joint's link, this being that of the joint's frame at position 0.
    fn moved(&self, joint: &JointSpec, slides: bool, q: f64, qd: f64, qdd: f64) -> Self {
        let axis = joint.axis;
        let mut link = self.seen_from(&motion(joint, q));
        if slides {
            link.acceleration += axis * qdd + link.spin.cross(&axis) * (2.0 * qd);
            return link;
        }
        link.spin_rate += axis * qdd + link.spin.cross(&axis) * qd;
        link.spin += axis * qd;
        link
    }
}

#[cfg(test)]
mod tests;
