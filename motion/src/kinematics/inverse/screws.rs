//! The chain as screws: the form in which inverse kinematics is solved.
//!
//! With every joint at 0, joint i's axis is a line in base-link axes: through pᵢ along the unit vector hᵢ. Links whose
//! frames are all parallel to the base's at 0 then have (R. W. Brockett, "Robotic manipulators and the product of
//! exponentials formula", 1984)
//!
//! ```text
//! Rᵢ = Rᵢ₋₁·rot(hᵢ, qᵢ)        oᵢ = oᵢ₋₁ + Rᵢ₋₁·(pᵢ − pᵢ₋₁)        (turning)
//! Rᵢ = Rᵢ₋₁                    oᵢ = oᵢ₋₁ + Rᵢ₋₁·(pᵢ − pᵢ₋₁ + hᵢ·qᵢ)  (sliding)
//! tool = oₙ + Rₙ·(t₀ − pₙ),  Rₙ·T₀
//! ```
//!
//! where (t₀, T₀) is the tool's pose at 0. Lengths in m, angles in rad.

use nalgebra::{Isometry3, Matrix3, Vector3};

use crate::robot::spec::{JointKind, JointSpec};
use crate::robot::{JOINTS_MAX, Robot};
use crate::tolerance::IK_SIZE_MIN;

/// One joint's axis at 0.
#[derive(Debug, Clone, Copy)]
pub(super) struct Screw {
    pub(super) turns: bool,
    /// h.
    pub(super) axis: Vector3<f64>,
    /// p.
    pub(super) point: Vector3<f64>,
    /// From the point before (the base's origin for the first) to this one.
    offset: Vector3<f64>,
}

/// A chain and its tool.
#[derive(Debug, Clone)]
pub(super) struct Screws {
    pub(super) joints: Vec<Screw>,
    /// T₀.
    pub(super) home_rotation: Matrix3<f64>,
    /// t₀.
    pub(super) home_point: Vector3<f64>,
    /// From the last axis' point to the tool.
    tool: Vector3<f64>,
    /// Length of the arm from its first axis to the tool, m: what makes positions comparable with angles.
    pub(super) size: f64,
}

/// Where the tool is to be.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    pub(super) rotation: Matrix3<f64>,
    pub(super) point: Vector3<f64>,
}

/// Where axes and tool are at some position of the joints, in base-link axes.
#[derive(Debug, Clone)]
pub(super) struct Frames {
    axis: [Vector3<f64>; JOINTS_MAX],
    point: [Vector3<f64>; JOINTS_MAX],
    pub(super) tool: Place,
}

impl Screws {
    pub(super) fn new(robot: &Robot, tcp: &Isometry3<f64>) -> Self {
        let spec = robot.spec();
        let mut base_from_link = Isometry3::identity();
        let mut joints: Vec<Screw> = Vec::with_capacity(spec.joints.len());
        for joint in &spec.joints {
            base_from_link *= joint.parent_from_joint;
            let before = joints.last().map_or(Vector3::zeros(), |last| last.point);
            joints.push(screw(joint, &base_from_link, &before));
        }
        let home = base_from_link * spec.link_from_tip * tcp;
        let home_point = home.translation.vector;
        let tool = home_point - joints.last().map_or(Vector3::zeros(), |last| last.point);
        let between: f64 = joints.iter().skip(1).map(|joint| joint.offset.norm()).sum();
        Self {
            joints,
            home_rotation: home.rotation.to_rotation_matrix().into_inner(),
            home_point,
            tool,
            size: (between + tool.norm()).max(IK_SIZE_MIN),
        }
    }

    pub(super) fn count(&self) -> usize {
        self.joints.len()
    }

    /// Axes and tool at `q`.
    pub(super) fn frames(&self, q: &[f64], frames: &mut Frames) {
        let mut rotation = Matrix3::identity();
        let mut point = Vector3::zeros();
        for (i, (joint, &q)) in self.joints.iter().zip(q).enumerate() {
            point += rotation * joint.offset;
            frames.axis[i] = rotation * joint.axis;
            frames.point[i] = point;
            if joint.turns {
                rotation *= turn(&joint.axis, q);
            } else {
                point += frames.axis[i] * q;
            }
        }
        frames.tool = Place {
            rotation: rotation * self.home_rotation,
            point: point + rotation * self.tool,
        };
    }

    /// Column j of the tool's Jacobian: linear, then angular.
    pub(super) fn column(&self, frames: &Frames, j: usize) -> (Vector3<f64>, Vector3<f64>) {
        let axis = frames.axis[j];
        if self.joints[j].turns {
            (axis.cross(&(frames.tool.point - frames.point[j])), axis)
        } else {
            (axis, Vector3::zeros())
        }
    }
}

impl Frames {
    pub(super) fn new() -> Self {
        Self {
            axis: [Vector3::zeros(); JOINTS_MAX],
            point: [Vector3::zeros(); JOINTS_MAX],
            tool: Place {
                rotation: Matrix3::identity(),
                point: Vector3::zeros(),
            },
        }
    }
}

impl From<&Isometry3<f64>> for Place {
    fn from(pose: &Isometry3<f64>) -> Self {
        Self {
            rotation: pose.rotation.to_rotation_matrix().into_inner(),
            point: pose.translation.vector,
        }
    }
}

fn screw(joint: &JointSpec, base_from_joint: &Isometry3<f64>, before: &Vector3<f64>) -> Screw {
    let point = base_from_joint.translation.vector;
    Screw {
        turns: match joint.kind {
            JointKind::Prismatic => false,
            JointKind::Revolute | JointKind::Continuous => true,
        },
        axis: base_from_joint * joint.axis,
        point,
        offset: point - before,
    }
}

/// rot(h, q) = I + sin q·[h]× + (1 − cos q)·[h]×² (Rodrigues).
#[inline]
pub(super) fn turn(h: &Vector3<f64>, q: f64) -> Matrix3<f64> {
    let (s, c) = libm::sincos(q);
    turn_by(h, c, s)
}

/// The same of a cosine and a sine.
#[inline]
pub(super) fn turn_by(h: &Vector3<f64>, c: f64, s: f64) -> Matrix3<f64> {
    let v = h * (1.0 - c);
    Matrix3::new(
        c + v.x * h.x,
        v.x * h.y - s * h.z,
        v.x * h.z + s * h.y,
        v.y * h.x + s * h.z,
        c + v.y * h.y,
        v.y * h.z - s * h.x,
        v.z * h.x - s * h.y,
        v.z * h.y + s * h.x,
        c + v.z * h.z,
    )
}

#[cfg(test)]
mod tests {
    use super::{Frames, Screws};
    use crate::kinematics::{jacobian, pose};
    use crate::test_arms::{random_arm, robot, values};

    #[test]
    fn tool_and_jacobian_are_the_forward_kinematics() {
        let state = &mut 1;
        for seed in 0..40 {
            let arm = robot(random_arm(1 + seed % 12, seed as u64));
            let count = arm.joint_count();
            let tcp = arm.spec().link_from_tip;
            let q = values(count, 3.0, state);
            let screws = Screws::new(&arm, &tcp);
            let mut frames = Frames::new();
            screws.frames(&q, &mut frames);
            let expected = pose(&arm, &q, &tcp);
            let rotation = expected.rotation.to_rotation_matrix();
            assert!((frames.tool.point - expected.translation.vector).norm() < 1e-13);
            assert!((frames.tool.rotation - rotation.matrix()).norm() < 1e-13);
            let mut matrix = vec![0.0; 6 * count];
            jacobian(&arm, &q, &tcp, &mut matrix);
            for j in 0..count {
                let (linear, angular) = screws.column(&frames, j);
                for row in 0..3 {
                    assert!((linear[row] - matrix[row * count + j]).abs() < 1e-13);
                    assert!((angular[row] - matrix[(row + 3) * count + j]).abs() < 1e-13);
                }
            }
        }
    }
}
