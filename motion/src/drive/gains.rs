//! Gains of the joint controller, derived from the model.
//!
//! The motor's position is fed back, at the place where the torque acts, so that the loop cannot excite the transmission (Tomei
//! 1991); it must stay below the frequency at which the arm swings against a held motor, though, or the arm swings on after the motor
//! has stopped. With M the joint's own inertia at its largest, B the rotor's, J = M + B, K the stiffness, T the period:
//!
//! ```text
//! ω = min(⅓·√(K/M), 1/(20·T))        K_p = J·ω²        K_d = 2·0.7·J·ω
//! ```
//!
//! ω is lowered until K_d·T ≤ ¼·B: at high frequency the rotor alone moves, and its speed is known half a period and a filter late.
//! The torque-error gain K_t makes the rotor lighter by 1 + K_t (Ott, Albu-Schäffer, Kugi and Hirzinger 2008); a period late it
//! takes damping K_t·K·1.5·T from the loop, of which it is allowed 0.3·K_d. Rigid joints: J for B, no torque error.

use crate::drive::feedforward::Joint;
use crate::dynamics::{self, Workspace};
use crate::error::Invalid;
use crate::robot::Robot;
use crate::tolerance::{
    GAIN_DAMPING, GAIN_FILTER, GAIN_RESONANCE, GAIN_ROTOR, GAIN_SAMPLING, GAIN_TORQUE, GAIN_TORQUE_DAMPING,
};

/// Gains of one joint, seen from the joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointGains {
    /// Torque over the error of the motor's position: K_p.
    pub position: f64,
    /// Torque over the error of the motor's speed: K_d.
    pub velocity: f64,
    /// Torque over the error of the transmission's torque: K_t.
    pub torque: f64,
    /// Cut-off of the measured speed, rad/s.
    pub velocity_filter: f64,
}

impl JointGains {
    /// Gains of a joint whose link side has at most so much inertia.
    pub(crate) fn of_model(joint: &Joint, link_inertia: f64, period: f64) -> Self {
        let total = link_inertia + joint.inertia;
        let stiffness = joint.transmission.as_ref().map(|elastic| elastic.stiffness(0.0));
        let mut bandwidth = 1.0 / (GAIN_SAMPLING * period);
        if let Some(stiffness) = stiffness {
            bandwidth = bandwidth.min(GAIN_RESONANCE * (stiffness / link_inertia).sqrt());
        }
        let rotor = if stiffness.is_some() { joint.inertia } else { total };
        let most = GAIN_ROTOR * rotor / period;
        let damping = |bandwidth: f64| 2.0 * GAIN_DAMPING * total * bandwidth;
        if damping(bandwidth) > most {
            bandwidth *= most / damping(bandwidth);
        }
        let velocity = damping(bandwidth);
        let torque = stiffness.map_or(0.0, |stiffness| {
            GAIN_TORQUE.min(GAIN_TORQUE_DAMPING * velocity / (1.5 * stiffness * period))
        });
        Self {
            position: total * bandwidth * bandwidth,
            velocity,
            torque,
            velocity_filter: GAIN_FILTER * bandwidth,
        }
    }

    pub(crate) fn check(&self, path: &str, wrong: &mut Vec<Invalid>) {
        let all = [
            ("position", self.position),
            ("velocity", self.velocity),
            ("torque", self.torque),
            ("velocity_filter", self.velocity_filter),
        ];
        for (field, value) in all {
            if !(value.is_finite() && value >= 0.0) {
                let message = format!("{value} must be finite and at least 0");
                wrong.push(Invalid::new(format!("{path}.{field}"), message));
            }
        }
    }
}

/// Gains for motions near some positions, one joint after the other in each.
#[must_use]
pub fn default_gains(robot: &Robot, positions: &[Vec<f64>], period: f64) -> Vec<JointGains> {
    let count = robot.joint_count();
    let mut workspace = Workspace::new(robot);
    let mut matrix = vec![0.0; count * count];
    let mut inertia = vec![0.0_f64; count];
    for position in positions {
        dynamics::mass_matrix(robot, &mut workspace, position, &mut matrix);
        for (joint, largest) in inertia.iter_mut().enumerate() {
            *largest = largest.max(matrix[joint * count + joint]);
        }
    }
    let joints = robot.spec().joints.iter().zip(inertia);
    joints
        .map(|(joint, inertia)| JointGains::of_model(&Joint::new(&joint.drive), inertia, period))
        .collect()
}
