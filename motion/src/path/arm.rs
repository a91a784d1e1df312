//! The arm's kinematics along a path: where the tool is, and its derivatives in the path parameter s up to the third.
//!
//! All vectors are in base-link axes. Joint i turns about the unit vector zᵢ (or slides along it), and rᵢ leads from it to
//! the next joint, fixed to link i. With ω the angular rate of a link in s, a vector r that is fixed to it has
//!
//! ```text
//! r′ = ω × r        r″ = ω′ × r + ω × r′        r‴ = ω″ × r + 2 ω′ × r′ + ω × r″
//! ω += z q′         ω′ += z q″ + z′ q′          ω″ += z q‴ + 2 z′ q″ + z″ q′
//! ```
//!
//! and the tool's derivatives are the sums over the chain (the forward step of Luh, Walker and Paul 1980, carried one
//! order further).

use nalgebra::{Isometry3, Matrix3, Quaternion, Rotation3, UnitQuaternion, Vector3};

use crate::jet::Jet;
use crate::robot::spec::{JointKind, RobotSpec};
use crate::robot::{JOINTS_MAX, Robot};

/// The chain with frames whose z is the joint's axis, and the tool centre point at its end.
#[derive(Debug, Clone)]
pub(super) struct Arm {
    joints: Vec<ArmJoint>,
    /// The tool in the last joint's frame.
    tool_turn: Matrix3<f64>,
    tool_offset: Vector3<f64>,
    /// Length of the stretched chain, m: what makes angles of lengths.
    span: f64,
}

#[derive(Debug, Clone, Copy)]
struct ArmJoint {
    prismatic: bool,
    /// Pose of this joint's frame at position 0 in the one before.
    turn: Matrix3<f64>,
    offset: Vector3<f64>,
}

/// Where everything is at one joint position.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frames {
    /// zᵢ.
    axis: [Vector3<f64>; JOINTS_MAX],
    /// rᵢ, without the next joint's slide.
    lever: [Vector3<f64>; JOINTS_MAX],
    /// From joint i to the tool centre point.
    reach: [Vector3<f64>; JOINTS_MAX],
    /// Orientation of the tool.
    pub(super) turn: Matrix3<f64>,
    /// The tool centre point.
    pub(super) position: Vector3<f64>,
}

/// How the tool moves with s.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Rates {
    /// p′, p″, p‴.
    pub(super) linear: [Vector3<f64>; 3],
    /// ω, ω′, ω″.
    pub(super) angular: [Vector3<f64>; 3],
}

impl Arm {
    pub(super) fn new(robot: &Robot, tcp: &Isometry3<f64>) -> Self {
        let spec = robot.spec();
        let mut onto_parent = Rotation3::identity();
        let mut joints = Vec::with_capacity(spec.joints.len());
        for joint in &spec.joints {
            let onto_axis = rotation_onto(joint.axis);
            let placed = joint.parent_from_joint;
            joints.push(ArmJoint {
                prismatic: joint.kind == JointKind::Prismatic,
                turn: (onto_parent.inverse() * placed.rotation.to_rotation_matrix() * onto_axis).into_inner(),
                offset: onto_parent.inverse() * placed.translation.vector,
            });
            onto_parent = onto_axis;
        }
        let tool = spec.link_from_tip * tcp;
        let tool_offset = onto_parent.inverse() * tool.translation.vector;
        let span = span(spec, &tool_offset);
        Self {
            joints,
            tool_turn: (onto_parent.inverse() * tool.rotation.to_rotation_matrix()).into_inner(),
            tool_offset,
            span,
        }
    }

    pub(super) fn joint_count(&self) -> usize {
        self.joints.len()
    }

    /// Length of the stretched chain, m.
    pub(super) fn span(&self) -> f64 {
        self.span
    }

    /// Where everything is at the jets' values.
    pub(super) fn frames(&self, q: &[Jet]) -> Frames {
        let mut frames = Frames {
            axis: [Vector3::zeros(); JOINTS_MAX],
            lever: [Vector3::zeros(); JOINTS_MAX],
            reach: [Vector3::zeros(); JOINTS_MAX],
            turn: Matrix3::identity(),
            position: Vector3::zeros(),
        };
        let mut turn = Matrix3::identity();
        let mut origin = Vector3::zeros();
        let count = self.joints.len();
        for (i, (joint, q)) in self.joints.iter().zip(q).enumerate() {
            let offset = turn * joint.offset;
            if i > 0 {
                frames.lever[i - 1] = offset;
            }
            origin += offset;
            turn *= joint.turn;
            let z = turn.column(2).into_owned();
            frames.axis[i] = z;
            if joint.prismatic {
                origin += z * q.value();
            } else {
                let (sin, cos) = (libm::sin(q.value()), libm::cos(q.value()));
                let (x, y) = (turn.column(0).into_owned(), turn.column(1).into_owned());
                turn.set_column(0, &(x * cos + y * sin));
                turn.set_column(1, &(y * cos - x * sin));
            }
            frames.reach[i] = origin;
        }
        let last = turn * self.tool_offset;
        frames.lever[count - 1] = last;
        frames.position = origin + last;
        frames.turn = turn * self.tool_turn;
        for reach in &mut frames.reach[..count] {
            *reach = frames.position - *reach;
        }
        frames
    }

    /// Column of the Jacobian of joint `i`: linear, then angular.
    pub(super) fn column(&self, frames: &Frames, i: usize) -> (Vector3<f64>, Vector3<f64>) {
        let axis = frames.axis[i];
        if self.joints[i].prismatic {
            (axis, Vector3::zeros())
        } else {
            (axis.cross(&frames.reach[i]), axis)
        }
    }

    /// How the tool moves, up to the given order in s; higher ones stay 0.
    pub(super) fn rates<const ORDER: usize>(&self, frames: &Frames, q: &[Jet]) -> Rates {
        let zero = Vector3::zeros();
        let ([mut w, mut w1, mut w2], [mut p1, mut p2, mut p3]) = ([zero; 3], [zero; 3]);
        for (i, (joint, q)) in self.joints.iter().zip(q).enumerate() {
            let [q0, q1, q2, q3] = q.derivatives();
            let z = frames.axis[i];
            let z1 = w.cross(&z);
            let z2 = if ORDER > 1 { w1.cross(&z) + w.cross(&z1) } else { zero };
            if joint.prismatic {
                p1 += z1 * q0 + z * q1;
                if ORDER > 1 {
                    p2 += z2 * q0 + z1 * (2.0 * q1) + z * q2;
                }
                if ORDER > 2 {
                    let z3 = w2.cross(&z) + w1.cross(&z1) * 2.0 + w.cross(&z2);
                    p3 += z3 * q0 + z2 * (3.0 * q1) + z1 * (3.0 * q2) + z * q3;
                }
            } else {
                w += z * q1;
                if ORDER > 1 {
                    w1 += z * q2 + z1 * q1;
                }
                if ORDER > 2 {
                    w2 += z * q3 + z1 * (2.0 * q2) + z2 * q1;
                }
            }
            let r = frames.lever[i];
            let r1 = w.cross(&r);
            p1 += r1;
            if ORDER > 1 {
                let r2 = w1.cross(&r) + w.cross(&r1);
                p2 += r2;
                if ORDER > 2 {
                    p3 += w2.cross(&r) + w1.cross(&r1) * 2.0 + w.cross(&r2);
                }
            }
        }
        Rates {
            linear: [p1, p2, p3],
            angular: [w, w1, w2],
        }
    }

    /// The tool centre point.
    pub(super) fn position(&self, q: &[Jet]) -> Vector3<f64> {
        self.frames(q).position
    }
}

impl Frames {
    /// Pose of the tool.
    pub(super) fn quaternion(&self) -> Quaternion<f64> {
        UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(self.turn)).into_inner()
    }
}

/// Length of the stretched chain; 1 m where it has none, as a bare turntable.
fn span(spec: &RobotSpec, tool_offset: &Vector3<f64>) -> f64 {
    let links: f64 = spec
        .joints
        .iter()
        .map(|joint| joint.parent_from_joint.translation.vector.norm())
        .sum();
    let span = links + tool_offset.norm();
    if span > 0.0 { span } else { 1.0 }
}

/// A rotation whose third column is `axis`; the identity where the axis is z already.
fn rotation_onto(axis: Vector3<f64>) -> Rotation3<f64> {
    if axis == Vector3::z() {
        return Rotation3::identity();
    }
    // the coordinate direction that is farthest from the axis
    let far = if axis.x.abs() <= axis.y.abs() && axis.x.abs() <= axis.z.abs() {
        Vector3::x()
    } else if axis.y.abs() <= axis.z.abs() {
        Vector3::y()
    } else {
        Vector3::z()
    };
    let x = (far - axis * axis.dot(&far)).normalize();
    Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[x, axis.cross(&x), axis]))
}

#[cfg(test)]
mod tests;
