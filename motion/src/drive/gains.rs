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
//! takes damping K_t·K·1.5·T from the loop, of which it is allowed 0.3·K_d. Rigid joints: no torque error, and for B the
//! least inertia that the joint has while all others are free to give way, 1/((M + B)⁻¹)ᵢᵢ: where two axes are nearly parallel, it is
//! far less than J.

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
    /// Gains of a joint whose link side has at most so much inertia, and the whole joint at least so much while the others
    /// give way.
    pub(crate) fn of_model(joint: &Joint, link_inertia: f64, free_inertia: f64, period: f64) -> Self {
        let total = link_inertia + joint.inertia;
        let stiffness = joint.transmission.as_ref().map(|elastic| elastic.stiffness(0.0));
        let mut bandwidth = 1.0 / (GAIN_SAMPLING * period);
        if let Some(stiffness) = stiffness {
            bandwidth = bandwidth.min(GAIN_RESONANCE * (stiffness / link_inertia).sqrt());
        }
        let rotor = if stiffness.is_some() {
            joint.inertia
        } else {
            free_inertia
        };
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
    let joints = Joint::all(robot);
    let count = joints.len();
    let mut workspace = Workspace::new(robot);
    let mut matrix = vec![0.0; count * count];
    let (mut largest, mut free) = (vec![0.0_f64; count], vec![f64::INFINITY; count]);
    for position in positions {
        dynamics::mass_matrix(robot, &mut workspace, position, &mut matrix);
        for (index, joint) in joints.iter().enumerate() {
            let diagonal = &mut matrix[index * count + index];
            largest[index] = largest[index].max(*diagonal);
            // behind a transmission that flexes, the rotor does not move with the link
            *diagonal += if joint.transmission.is_none() {
                joint.inertia
            } else {
                0.0
            };
        }
        for (index, free) in free.iter_mut().enumerate() {
            *free = free.min(inertia_while_others_give_way(&matrix, index, count));
        }
    }
    let joints = joints.iter().zip(largest.iter().zip(free));
    joints
        .map(|(joint, (largest, free))| {
            JointGains::of_model(joint, *largest, free.min(largest + joint.inertia), period)
        })
        .collect()
}

/// 1/(A⁻¹)ᵢᵢ; the entry itself, where A is singular.
fn inertia_while_others_give_way(matrix: &[f64], index: usize, count: usize) -> f64 {
    let mut unit = vec![0.0; count];
    unit[index] = 1.0;
    if dynamics::solve_symmetric(&mut matrix.to_vec(), &mut unit) {
        return 1.0 / unit[index];
    }
    matrix[index * count + index]
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::*;
    use crate::test_arms::{random_arm, robot, values};

    /// K_d·T ≤ ¼·1/((M + B)⁻¹)ᵢᵢ at every pose, the inverse by another library.
    #[test]
    fn damping_stays_below_what_a_joint_weighs_while_the_others_give_way() {
        let state = &mut 3;
        let period = 1.0e-3;
        for seed in 0..40 {
            let robot = robot(random_arm(6, seed));
            let poses: Vec<Vec<f64>> = (0..5).map(|_| values(6, 3.0, state)).collect();
            let gains = default_gains(&robot, &poses, period);
            for pose in &poses {
                let mut matrix = vec![0.0; 36];
                dynamics::mass_matrix(&robot, &mut Workspace::new(&robot), pose, &mut matrix);
                let mut whole = DMatrix::from_row_slice(6, 6, &matrix);
                for (index, joint) in robot.spec().joints.iter().enumerate() {
                    whole[(index, index)] += Joint::new(&joint.drive).inertia;
                }
                let inverse = whole.try_inverse().expect("a sound arm");
                for (index, gains) in gains.iter().enumerate() {
                    let free = 1.0 / inverse[(index, index)];
                    assert!(gains.velocity * period <= 0.25 * free * (1.0 + 1e-9), "joint {index}");
                }
            }
        }
    }
}
