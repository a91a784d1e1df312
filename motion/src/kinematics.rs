//! Where the tool is, and how it moves with the joints.

pub mod inverse;

use nalgebra::{Isometry3, Translation3, Unit, UnitQuaternion, Vector3};

use crate::robot::Robot;
use crate::robot::spec::{JointKind, JointSpec};

/// Pose of the tool centre point in base-link axes; `tcp` is its pose in the tip link's frame.
#[must_use]
pub fn pose(robot: &Robot, q: &[f64], tcp: &Isometry3<f64>) -> Isometry3<f64> {
    let spec = robot.spec();
    let last = spec
        .joints
        .iter()
        .zip(q)
        .fold(Isometry3::identity(), |base_from_link, (joint, &q)| {
            base_from_link * joint.parent_from_joint * motion(joint, q)
        });
    last * spec.link_from_tip * tcp
}

/// Jacobian of the tool centre point in base-link axes: 6 × n, row by row, linear x y z, then angular x y z.
pub fn jacobian(robot: &Robot, q: &[f64], tcp: &Isometry3<f64>, matrix: &mut [f64]) {
    let spec = robot.spec();
    let count = spec.joints.len();
    assert_eq!(matrix.len(), 6 * count, "jacobian: 6 x n entries");
    let point = pose(robot, q, tcp).translation.vector;
    let mut base_from_link = Isometry3::identity();
    for (j, (joint, &q)) in spec.joints.iter().zip(q).enumerate() {
        let base_from_joint = base_from_link * joint.parent_from_joint;
        let axis = base_from_joint * joint.axis;
        let (linear, angular) = match joint.kind {
            JointKind::Prismatic => (axis, Vector3::zeros()),
            JointKind::Revolute | JointKind::Continuous => {
                (axis.cross(&(point - base_from_joint.translation.vector)), axis)
            }
        };
        for row in 0..3 {
            matrix[row * count + j] = linear[row];
            matrix[(row + 3) * count + j] = angular[row];
        }
        base_from_link = base_from_joint * motion(joint, q);
    }
}

/// What a joint does to its link.
fn motion(joint: &JointSpec, q: f64) -> Isometry3<f64> {
    match joint.kind {
        JointKind::Prismatic => Isometry3::from_parts(Translation3::from(joint.axis * q), UnitQuaternion::identity()),
        JointKind::Revolute | JointKind::Continuous => {
            let (sin, cos) = (libm::sin(0.5 * q), libm::cos(0.5 * q));
            let vector = joint.axis * sin;
            let turn = Unit::new_unchecked(nalgebra::Quaternion::new(cos, vector.x, vector.y, vector.z));
            Isometry3::from_parts(Translation3::identity(), turn)
        }
    }
}
