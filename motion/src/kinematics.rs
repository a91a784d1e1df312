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

/// How the tool centre point moves, in base-link axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ToolMotion {
    /// m/s.
    pub(crate) velocity: Vector3<f64>,
    /// m/s².
    pub(crate) acceleration: Vector3<f64>,
}

/// Velocity and acceleration of the tool centre point from those of the joints, link by link from the base (Featherstone
/// 2008, chapter 2: v + ω × r, a + ω̇ × r + ω × (ω × r), and Coriolis' 2 ω × ṙ on a slide).
pub(crate) fn tool_motion(robot: &Robot, q: &[f64], qd: &[f64], qdd: &[f64], tcp: &Isometry3<f64>) -> ToolMotion {
    let spec = robot.spec();
    let (mut spin, mut spin_rate) = (Vector3::zeros(), Vector3::zeros());
    let (mut velocity, mut acceleration) = (Vector3::zeros(), Vector3::zeros());
    let mut base_from_link = Isometry3::identity();
    let carry = |from: &Isometry3<f64>, to: &Isometry3<f64>, spin: &Vector3<f64>, spin_rate: &Vector3<f64>| {
        let arm = to.translation.vector - from.translation.vector;
        let swept = spin.cross(&arm);
        (swept, spin_rate.cross(&arm) + spin.cross(&swept))
    };
    for (joint, ((&q, &qd), &qdd)) in spec.joints.iter().zip(q.iter().zip(qd).zip(qdd)) {
        let base_from_joint = base_from_link * joint.parent_from_joint;
        let axis = base_from_joint * joint.axis;
        let moved = base_from_joint * motion(joint, q);
        let (swept, bent) = carry(&base_from_link, &moved, &spin, &spin_rate);
        velocity += swept;
        acceleration += bent;
        match joint.kind {
            JointKind::Prismatic => {
                velocity += axis * qd;
                acceleration += axis * qdd + spin.cross(&axis) * (2.0 * qd);
            }
            JointKind::Revolute | JointKind::Continuous => {
                spin_rate += axis * qdd + spin.cross(&axis) * qd;
                spin += axis * qd;
            }
        }
        base_from_link = moved;
    }
    let tool = base_from_link * spec.link_from_tip * tcp;
    let (swept, bent) = carry(&base_from_link, &tool, &spin, &spin_rate);
    ToolMotion {
        velocity: velocity + swept,
        acceleration: acceleration + bent,
    }
}

/// What a joint does to its link.
pub(crate) fn motion(joint: &JointSpec, q: f64) -> Isometry3<f64> {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_arms;

    /// Against differences of the pose along q(t) = q + q̇·t + ½·q̈·t².
    #[test]
    fn the_tool_moves_as_its_pose_does() {
        for seed in 0..20 {
            let state = &mut (100 + seed);
            let robot = test_arms::robot(test_arms::random_arm(7, seed));
            let [q, qd, qdd] = std::array::from_fn(|_| test_arms::values(7, 1.0, state));
            let tcp = Isometry3::new(Vector3::new(0.1, -0.2, 0.05), Vector3::new(0.3, 0.2, -0.4));
            let at = |t: f64| {
                let moved: Vec<f64> = (0..7).map(|j| q[j] + t * (qd[j] + 0.5 * t * qdd[j])).collect();
                pose(&robot, &moved, &tcp).translation.vector
            };
            let step = 1e-4;
            let found = tool_motion(&robot, &q, &qd, &qdd, &tcp);
            let velocity = (at(step) - at(-step)) / (2.0 * step);
            let acceleration = (at(step) - at(0.0) * 2.0 + at(-step)) / (step * step);
            assert!((found.velocity - velocity).norm() < 1e-6 * (1.0 + velocity.norm()));
            assert!((found.acceleration - acceleration).norm() < 1e-5 * (1.0 + acceleration.norm()));
            let mut jacobian = vec![0.0; 42];
            super::jacobian(&robot, &q, &tcp, &mut jacobian);
            for row in 0..3 {
                let product: f64 = (0..7).map(|j| jacobian[row * 7 + j] * qd[j]).sum();
                assert!((found.velocity[row] - product).abs() < 1e-12 * (1.0 + product.abs()));
            }
        }
    }
}
