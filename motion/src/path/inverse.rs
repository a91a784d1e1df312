//! From the tool to the joints with three derivatives, by inverse kinematics in Taylor arithmetic.
//!
//! q by Newton's method from a seed close by; then, order by order, with the joints known up to the order below,
//!
//! ```text
//! J q′ = x′ − ẋ₁        J q″ = x″ − ẋ₂        J q‴ = x‴ − ẋ₃
//! ```
//!
//! where x is the tool's position and orientation as asked for and ẋₖ the arm's derivative of order k with that order's
//! unknown at 0: one decomposition of J serves all (Griewank and Walther 2008, section 13.5). Linear rows are divided by the
//! arm's length. With fewer than six joints the equations hold in the least-squares sense, exactly where the curve can be
//! followed at all; with more, all but six joints are led: their course is given.

use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use super::arm::{Arm, Frames, Rates};
use super::square::Decomposed;
use super::tool::ToolPoint;
use super::track::Joints;
use crate::tolerance::{NEWTON_DONE, NEWTON_ROUNDS};

/// Which joints follow the tool.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Followers {
    joints: [usize; 6],
    count: usize,
    leads: bool,
}

/// How well a pose was reached.
#[derive(Debug, Clone, Copy)]
pub(super) struct Reached {
    /// What is missing, rad or parts of the arm's length; infinite where Newton's method did not end.
    pub(super) gap: f64,
    decomposed: Decomposed,
}

impl Reached {
    /// A lower bound of the Jacobian's smallest singular value.
    pub(super) fn smallest(&self) -> f64 {
        self.decomposed.smallest()
    }
}

impl Followers {
    /// All joints but those that are led; at most six may follow.
    pub(super) fn all_but(joint_count: usize, led: &[usize]) -> Self {
        let mut followers = Self {
            joints: [0; 6],
            count: 0,
            leads: !led.is_empty(),
        };
        for joint in (0..joint_count).filter(|joint| !led.contains(joint)).take(6) {
            followers.joints[followers.count] = joint;
            followers.count += 1;
        }
        followers
    }

    pub(super) fn joints(&self) -> &[usize] {
        &self.joints[..self.count]
    }

    /// Whether any joints are led.
    pub(super) fn leads(&self) -> bool {
        self.leads
    }

    /// Whether a joint follows the tool.
    pub(super) fn has(&self, joint: usize) -> bool {
        self.joints().contains(&joint)
    }

    fn jacobian(&self, arm: &Arm, frames: &Frames) -> Decomposed {
        let mut columns = [[0.0; 6]; 6];
        for (column, joint) in columns.iter_mut().zip(self.joints()) {
            let (linear, angular) = arm.column(frames, *joint);
            *column = stacked(arm, &linear, &angular);
        }
        Decomposed::new(columns, self.count)
    }

    /// Brings the tool to a point. `q` holds seeds of the followers and the full jets of the others.
    pub(super) fn solve(&self, arm: &Arm, aim: &ToolPoint, q: &mut Joints) -> Reached {
        let (frames, decomposed, gap) = self.reach(arm, aim, q);
        self.derive(arm, aim, &frames, &decomposed, q);
        Reached { gap, decomposed }
    }

    /// The joints' values, what is decomposed there, and the gap. The last step is too small to look again after it.
    fn reach(&self, arm: &Arm, aim: &ToolPoint, q: &mut Joints) -> (Frames, Decomposed, f64) {
        let (position, turn) = aim.value();
        let turn = UnitQuaternion::new_unchecked(turn).to_rotation_matrix().into_inner();
        let mut round = 0;
        loop {
            let frames = arm.frames(&q[..arm.joint_count()]);
            let decomposed = self.jacobian(arm, &frames);
            let (linear, angular) = (position - frames.position, turn_between(&frames.turn, &turn));
            let (step, gap) = decomposed.solve(stacked(arm, &linear, &angular));
            let mut largest = 0.0f64;
            for (joint, step) in self.joints().iter().zip(step) {
                q[*joint].0[0] += step;
                largest = largest.max(step.abs());
            }
            round += 1;
            if largest <= NEWTON_DONE || round == NEWTON_ROUNDS {
                let gap = if largest <= NEWTON_DONE { gap } else { f64::INFINITY };
                return (frames, decomposed, gap);
            }
        }
    }

    /// The joints' derivatives.
    fn derive(&self, arm: &Arm, aim: &ToolPoint, frames: &Frames, decomposed: &Decomposed, q: &mut Joints) {
        let count = arm.joint_count();
        let asked = aim.rates();
        for joint in self.joints() {
            q[*joint].0[1..].fill(0.0);
        }
        // without joints that are led, the arm stands still until q′ is known
        let first = if self.leads {
            arm.rates::<1>(frames, &q[..count])
        } else {
            Rates::default()
        };
        self.set(arm, decomposed, &asked, &first, 1, q);
        let second = arm.rates::<2>(frames, &q[..count]);
        self.set(arm, decomposed, &asked, &second, 2, q);
        let third = arm.rates::<3>(frames, &q[..count]);
        self.set(arm, decomposed, &asked, &third, 3, q);
    }

    fn set(&self, arm: &Arm, decomposed: &Decomposed, asked: &Rates, had: &Rates, order: usize, q: &mut Joints) {
        let k = order - 1;
        let (linear, angular) = (asked.linear[k] - had.linear[k], asked.angular[k] - had.angular[k]);
        let (solution, _) = decomposed.solve(stacked(arm, &linear, &angular));
        let factorial = [1.0, 2.0, 6.0][k];
        for (joint, value) in self.joints().iter().zip(solution) {
            q[*joint].0[order] = value / factorial;
        }
    }
}

/// Six rows: linear ones in parts of the arm's length, then angular ones.
fn stacked(arm: &Arm, linear: &Vector3<f64>, angular: &Vector3<f64>) -> [f64; 6] {
    let scale = 1.0 / arm.span();
    [
        linear.x * scale,
        linear.y * scale,
        linear.z * scale,
        angular.x,
        angular.y,
        angular.z,
    ]
}

/// The rotation vector from one orientation to another: its axis times the sine of its angle, or times the angle's
/// growth beyond a right angle, where the sine would shrink again.
fn turn_between(from: &Matrix3<f64>, to: &Matrix3<f64>) -> Vector3<f64> {
    let half = |i: usize| from.column(i).cross(&to.column(i));
    let sine = (half(0) + half(1) + half(2)) * 0.5;
    let cosine = 0.5 * ((0..3).map(|i| from.column(i).dot(&to.column(i))).sum::<f64>() - 1.0);
    let norm = sine.norm();
    if cosine > 0.0 || norm == 0.0 {
        return sine;
    }
    sine * (libm::atan2(norm, cosine) / norm)
}
