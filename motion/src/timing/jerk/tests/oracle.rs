//! Against a sequence of cone programs solved by Clarabel 0.11.1, with the dynamics by Pinocchio 4.1.0, both in Python.
//!
//! UR5e of the test vectors without rotors and friction, a cubic path of six joints over s in [0, 1]. Unknowns are (a,
//! b, c) at 800 nodes, with c linear between them, 1/√a in the objective by power cones, jerk rows linearised at the
//! solution before; repeated until the duration changes by less than 1e-5 of itself. Rows at nodes alone, nothing
//! certified between them: a lower bound but for its own grid, where 400 nodes give 0.91736 s and 0.76169 s.

use super::*;

const PATH: [[f64; 4]; 6] = [
    [0.2, 2.0, -3.1, 1.4],
    [-1.3, 0.7, 0.9, -1.1],
    [0.9, -1.5, 2.2, -0.6],
    [-0.4, 1.2, -2.0, 1.9],
    [0.6, -0.8, 1.6, -1.2],
    [0.1, 2.4, -1.0, -0.5],
];

/// 3.14 rad/s, 15 rad/s² and 150 rad/s³ of every joint.
const DURATION_WITHOUT_TORQUE: f64 = 0.917_186;

/// 3.14 rad/s, 150 rad/s², 600 rad/s³, and half of the peak torques: 75 N m of the first three joints, 14 N m of the
/// others.
const DURATION_WITH_TORQUE: f64 = 0.761_609;

#[allow(clippy::approx_constant, reason = "the limit that the other solver was given")]
fn limits([acceleration, jerk]: [f64; 2], torques: Option<[f64; 6]>) -> Limits {
    let joint = |joint: usize| JointLimits {
        velocity: Some(3.14),
        acceleration: Some(acceleration),
        jerk: Some(jerk),
        torque: torques.map(|torques| torques[joint]),
    };
    Limits::uniform(Stretch {
        joints: (0..6).map(joint).collect(),
        ..Stretch::default()
    })
}

/// Certified, and within 0.3 % of what the other solver finds without a certificate.
#[test]
fn durations_are_those_of_another_solver() {
    let arm = ur5e();
    let curve = Polynomials::new(PATH.iter().map(|joint| joint.to_vec()).collect(), 1.0);
    let half = [75.0, 75.0, 75.0, 14.0, 14.0, 14.0];
    for (limits, expected) in [
        (limits([15.0, 150.0], None), DURATION_WITHOUT_TORQUE),
        (limits([150.0, 600.0], Some(half)), DURATION_WITH_TORQUE),
    ] {
        let duration = timed(&arm, &curve, &limits, 500).unwrap().law.duration();
        assert!(
            duration > 0.999 * expected && duration < 1.003 * expected,
            "{duration} {expected}"
        );
    }
}
