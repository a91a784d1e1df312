//! The chain in the form that the kernels compute with.
//!
//! Every frame is turned so that z is the joint's axis, and turned once more about z so that the rotation from one
//! frame to the next is Rx(α)·Rz(q + θ₀) for any placement of the axes: a rotation B splits into Rz(a)·Rx(α)·Rz(c),
//! where c adds to this joint's zero and a to the one before. Translations stay general, so nearly parallel axes do no
//! harm (a DH table would put its origins kilometres away). A vector then changes frames for 8 products.

use nalgebra::{Matrix3, Rotation3, Unit, Vector3};

use crate::robot::spec::{Inertial, JointKind, RobotSpec};

/// One joint and its link, in kernel frames.
#[derive(Debug, Clone)]
pub(crate) struct ChainJoint {
    /// The joint slides along z instead of turning about it.
    pub(crate) prismatic: bool,
    /// Cosine and sine of the angle α between this z and the one before, about x.
    pub(crate) cos_alpha: f64,
    pub(crate) sin_alpha: f64,
    /// Joint angle at position 0, rad.
    pub(crate) zero_angle: f64,
    /// Origin of this frame at position 0, in the frame before, m.
    pub(crate) origin: [f64; 3],
    /// Mass distribution of the link.
    pub(crate) body: Body,
}

/// Mass distribution of a link about the origin of its kernel frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Body {
    /// kg.
    pub(crate) mass: f64,
    /// First moment ∫ r dm, kg m.
    pub(crate) first: [f64; 3],
    /// Second moments ∫ r rᵀ dm: xx yy zz xy xz yz, kg m².
    pub(crate) second: [f64; 6],
}

/// The chain of a robot, in kernel frames.
#[derive(Debug, Clone)]
pub(crate) struct Chain {
    pub(crate) joints: Vec<ChainJoint>,
    /// Gravity in the base's kernel frame, m/s².
    pub(crate) gravity: [f64; 3],
    /// From the last link's frame as described to its kernel frame.
    kernel_from_last: Rotation3<f64>,
}

impl Chain {
    /// Turns a description into kernel frames. The payload is not part of it: see [`Chain::with_load`].
    pub(crate) fn new(spec: &RobotSpec) -> Self {
        let count = spec.joints.len();
        // described frame <- frame with z on the axis
        let onto_axis: Vec<Rotation3<f64>> = spec.joints.iter().map(|joint| rotation_onto(joint.axis)).collect();
        let mut alpha = vec![0.0; count];
        let mut before = vec![0.0; count];
        let mut after = vec![0.0; count];
        for (i, joint) in spec.joints.iter().enumerate() {
            let parent = i.checked_sub(1).map_or_else(Rotation3::identity, |p| onto_axis[p]);
            let b = parent.inverse() * joint.parent_from_joint.rotation.to_rotation_matrix() * onto_axis[i];
            (before[i], alpha[i], after[i]) = zxz_angles(&b);
        }
        let joints = spec
            .joints
            .iter()
            .enumerate()
            .map(|(i, joint)| {
                let next = before.get(i + 1).copied().unwrap_or(0.0);
                let parent_kernel = match i.checked_sub(1) {
                    Some(parent) => onto_axis[parent] * turn_z(before[i]),
                    None => turn_z(before[0]),
                };
                let kernel = onto_axis[i] * turn_z(next);
                ChainJoint {
                    prismatic: joint.kind == JointKind::Prismatic,
                    cos_alpha: libm::cos(alpha[i]),
                    sin_alpha: libm::sin(alpha[i]),
                    zero_angle: after[i] + next,
                    origin: (parent_kernel.inverse() * joint.parent_from_joint.translation.vector).into(),
                    body: Body::new(&joint.link, &kernel.inverse()),
                }
            })
            .collect();
        let base = turn_z(before.first().copied().unwrap_or(0.0));
        Self {
            joints,
            gravity: (base.inverse() * spec.gravity).into(),
            kernel_from_last: onto_axis.last().map_or_else(Rotation3::identity, Rotation3::inverse),
        }
    }

    /// The chain with a body fixed to its last link, given in that link's described frame.
    pub(crate) fn with_load(mut self, load: &Inertial) -> Self {
        let load = Body::new(load, &self.kernel_from_last);
        if let Some(last) = self.joints.last_mut() {
            last.body = last.body.joined(&load);
        }
        self
    }

    /// A point given in the last link's described frame, in its kernel frame.
    pub(crate) fn point_on_last(&self, point: Vector3<f64>) -> [f64; 3] {
        (self.kernel_from_last * point).into()
    }
}

impl Body {
    /// The body seen from a turned frame with the same origin.
    fn new(inertial: &Inertial, turn: &Rotation3<f64>) -> Self {
        let center = turn * inertial.center_of_mass;
        let inertia = turn.matrix() * inertial.inertia * turn.matrix().transpose();
        let second =
            Matrix3::identity() * (0.5 * inertia.trace()) - inertia + center * center.transpose() * inertial.mass;
        Self {
            mass: inertial.mass,
            first: (center * inertial.mass).into(),
            second: [
                second[(0, 0)],
                second[(1, 1)],
                second[(2, 2)],
                second[(0, 1)],
                second[(0, 2)],
                second[(1, 2)],
            ],
        }
    }

    fn joined(&self, other: &Self) -> Self {
        let mut sum = *self;
        sum.mass += other.mass;
        for (a, b) in sum.first.iter_mut().zip(other.first) {
            *a += b;
        }
        for (a, b) in sum.second.iter_mut().zip(other.second) {
            *a += b;
        }
        sum
    }
}

/// A rotation whose third column is `axis`; the identity where the axis is z already.
fn rotation_onto(axis: Vector3<f64>) -> Rotation3<f64> {
    let z = Unit::new_normalize(axis);
    if z == Vector3::z_axis() {
        return Rotation3::identity();
    }
    // the coordinate direction that is farthest from the axis
    let far = if z.x.abs() <= z.y.abs() && z.x.abs() <= z.z.abs() {
        Vector3::x()
    } else if z.y.abs() <= z.z.abs() {
        Vector3::y()
    } else {
        Vector3::z()
    };
    let x = (far - z.into_inner() * z.dot(&far)).normalize();
    let y = z.cross(&x);
    Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[x, y, z.into_inner()]))
}

/// Rotation about z.
fn turn_z(angle: f64) -> Rotation3<f64> {
    let (s, c) = libm::sincos(angle);
    Rotation3::from_matrix_unchecked(Matrix3::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0))
}

/// Rotation about x.
fn turn_x(angle: f64) -> Rotation3<f64> {
    let (s, c) = libm::sincos(angle);
    Rotation3::from_matrix_unchecked(Matrix3::new(1.0, 0.0, 0.0, 0.0, c, -s, 0.0, s, c))
}

/// Angles (a, α, c) with B = Rz(a)·Rx(α)·Rz(c), α in [0, π].
fn zxz_angles(b: &Rotation3<f64>) -> (f64, f64, f64) {
    let m = b.matrix();
    let sine = libm::hypot(m[(0, 2)], m[(1, 2)]);
    let alpha = libm::atan2(sine, m[(2, 2)]);
    if sine > 0.0 {
        // third column: (sin a sin α, −cos a sin α, cos α)
        let a = libm::atan2(m[(0, 2)], -m[(1, 2)]);
        // what is left is Rz(c) exactly, whatever rounding did to a and α
        let turn = turn_z(a) * turn_x(alpha);
        let rest = turn.inverse() * b;
        return (a, alpha, libm::atan2(rest[(1, 0)], rest[(0, 0)]));
    }
    // parallel or opposite axes: a and c act about the same line, so let c have it all
    let flip = if m[(2, 2)] > 0.0 { 1.0 } else { -1.0 };
    (0.0, alpha, libm::atan2(flip * m[(1, 0)], m[(0, 0)]))
}

#[cfg(test)]
mod tests;
