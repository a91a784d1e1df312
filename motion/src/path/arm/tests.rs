use nalgebra::{Isometry3, Vector3};

use super::*;
use crate::kinematics;
use crate::test_arms::{random_arm, values};

fn tool() -> Isometry3<f64> {
    Isometry3::new(Vector3::new(0.1, -0.2, 0.3), Vector3::new(0.4, 0.5, -0.6))
}

fn jets(state: &mut u64, count: usize) -> Vec<Jet> {
    (0..count)
        .map(|_| Jet(<[f64; 4]>::try_from(values(4, 1.0, state)).unwrap()))
        .collect()
}

/// The joints where the jets are after a step h.
fn moved(q: &[Jet], h: f64) -> Vec<f64> {
    q.iter()
        .map(|q| q.0[0] + h * (q.0[1] + h * (q.0[2] + h * q.0[3])))
        .collect()
}

#[test]
fn agrees_with_the_kinematics_of_the_service() {
    let state = &mut 5;
    for count in 1..9 {
        let robot = Robot::new(random_arm(count, count as u64), Vec::new()).unwrap();
        let arm = Arm::new(&robot, &tool());
        let q = jets(state, count);
        let expected = kinematics::pose(&robot, &moved(&q, 0.0), &tool());
        let frames = arm.frames(&q);
        assert!((frames.position - expected.translation.vector).norm() < 1e-13);
        let turn = expected.rotation.to_rotation_matrix().into_inner();
        assert!((frames.turn - turn).norm() < 1e-13);
        let mut jacobian = vec![0.0; 6 * count];
        kinematics::jacobian(&robot, &moved(&q, 0.0), &tool(), &mut jacobian);
        for joint in 0..count {
            let (linear, angular) = arm.column(&frames, joint);
            for row in 0..3 {
                assert!((linear[row] - jacobian[row * count + joint]).abs() < 1e-13);
                assert!((angular[row] - jacobian[(row + 3) * count + joint]).abs() < 1e-13);
            }
        }
    }
}

/// Central differences of positions, and of rotations for ω; then of ω along the same motion.
#[test]
fn rates_are_derivatives_of_the_pose() {
    let state = &mut 11;
    let h = 1e-4;
    for count in [1, 3, 6, 7] {
        let robot = Robot::new(random_arm(count, 40 + count as u64), Vec::new()).unwrap();
        let arm = Arm::new(&robot, &tool());
        let q = jets(state, count);
        let at = |s: f64| {
            let shifted: Vec<Jet> = q
                .iter()
                .map(|q| {
                    let [c0, c1, c2, c3] = q.0;
                    Jet([
                        c0 + s * (c1 + s * (c2 + s * c3)),
                        c1 + s * (2.0 * c2 + s * 3.0 * c3),
                        c2 + 3.0 * s * c3,
                        c3,
                    ])
                })
                .collect();
            let frames = arm.frames(&shifted);
            (frames, arm.rates::<3>(&frames, &shifted))
        };
        let (_, rates) = at(0.0);
        let ((before, low), (after, high)) = (at(-h), at(h));
        let slope = (after.position - before.position) / (2.0 * h);
        assert!((slope - rates.linear[0]).norm() < 1e-6 * (1.0 + slope.norm()));
        let skew = (after.turn - before.turn) / (2.0 * h) * at(0.0).0.turn.transpose();
        let omega = Vector3::new(skew[(2, 1)], skew[(0, 2)], skew[(1, 0)]);
        assert!((omega - rates.angular[0]).norm() < 1e-6 * (1.0 + omega.norm()));
        for order in 0..2 {
            let linear = (high.linear[order] - low.linear[order]) / (2.0 * h);
            let angular = (high.angular[order] - low.angular[order]) / (2.0 * h);
            let scale = 1e-5 * (10.0 + linear.norm() + angular.norm());
            assert!((linear - rates.linear[order + 1]).norm() < scale, "{count} {order}");
            assert!((angular - rates.angular[order + 1]).norm() < scale, "{count} {order}");
        }
    }
}
