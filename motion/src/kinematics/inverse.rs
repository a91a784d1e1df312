//! Inverse kinematics: the joint positions that bring the tool to a pose.
//!
//! ```text
//! find every q with  pose(q) = P        P: the tool centre point's pose in base-link axes
//! ```
//!
//! Every answer is checked by forward kinematics: its tool is within 1e-9 m and 1e-9 rad of the pose.
//!
//! Arms of six turning joints with a wrist, or with three parallel axes, have a closed form (`six`, `wrist`,
//! `parallel`); it gives every branch. Every other chain is searched (`search`).
//!
//! Where the pose leaves joints free, whether by a seventh joint or at a singularity, the reference r decides: of a
//! connected family the answer is a member to which no neighbour is nearer, (I − J⁺·J)·(r − q) = 0. A joint that would
//! leave its range there is held at the end of it, where the others can make up for that. Distances between joint
//! positions are √Σ(qⱼ − rⱼ)², rad and m alike.
//!
//! Nothing here asks a budget: the longest search, for a pose out of reach, takes some milliseconds. Whoever solves for
//! many poses asks between them.

mod circle;
mod gap;
mod newton;
mod parallel;
mod quartic;
mod ranges;
mod screws;
mod search;
mod singular;
mod six;
mod square;
#[cfg(test)]
mod tests;
mod unreachable;
mod wrist;

use nalgebra::Isometry3;

use crate::robot::Robot;
use crate::tolerance::{IK_NEAR, IK_PATIENCE, IK_PATIENCE_NEAR};
use newton::{Newton, squared_distance};
use ranges::Range;
use screws::{Place, Screws};
use six::ClosedForm;
pub use unreachable::Unreachable;

/// The answers for one pose.
#[derive(Debug, Clone, PartialEq)]
pub struct Solutions {
    /// Never empty. Those within every joint range come first, then the others; both by distance from the reference.
    pub solutions: Vec<Solution>,
    /// How they were found.
    pub method: Method,
}

/// How solutions are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// In closed form: these are all there are. Where the arm's axes do not quite meet or are not quite parallel, near a
    /// singularity some may be missing.
    ClosedForm,
    /// By iterating from many starts: there may be more.
    Numerical,
}

/// Joint positions that give the pose.
#[derive(Debug, Clone, PartialEq)]
pub struct Solution {
    /// rad or m, in model order.
    pub position: Vec<f64>,
    /// Distance of the tool from the pose, m.
    pub position_error: f64,
    /// Angle between the tool and the pose, rad.
    pub orientation_error: f64,
    /// Whether every joint is within its range.
    pub in_range: bool,
    /// Smallest singular value of the tool's Jacobian, its linear rows divided by the arm's length: 0 at a singularity.
    pub smallest_singular_value: f64,
}

/// Which of the positions that differ by whole turns are listed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Turns {
    /// The one within the joint's range that is nearest to the reference.
    Nearest,
    /// Every one within the joint's range, where that has two ends; at most 1024 in all.
    Every,
}

/// Every solution for a pose of the tool centre point in base-link axes; `tcp` is its pose in the tip link's frame.
/// Without a reference, one value a joint, distances are from the middle of the joints' ranges.
///
/// # Errors
/// Where no joint positions give the pose, whatever the ranges.
pub fn solutions(
    robot: &Robot,
    pose: &Isometry3<f64>,
    tcp: &Isometry3<f64>,
    reference: Option<&[f64]>,
    turns: Turns,
) -> Result<Solutions, Unreachable> {
    Inverse::new(robot, tcp).solutions(pose, reference, turns)
}

/// The solution within every joint range that is nearest to the reference. See [`Inverse::nearest`].
///
/// # Errors
/// Where there is none.
pub fn nearest(
    robot: &Robot,
    pose: &Isometry3<f64>,
    tcp: &Isometry3<f64>,
    reference: &[f64],
) -> Result<Vec<f64>, Unreachable> {
    Inverse::new(robot, tcp).nearest(pose, reference)
}

/// The inverse kinematics of one robot with one tool, made ready once for many poses.
#[derive(Debug, Clone)]
pub struct Inverse {
    screws: Screws,
    ranges: Vec<Range>,
    closed_form: Option<ClosedForm>,
}

impl Inverse {
    /// Looks at the chain of a robot; `tcp` is the tool centre point's pose in the tip link's frame.
    #[must_use]
    pub fn new(robot: &Robot, tcp: &Isometry3<f64>) -> Self {
        let screws = Screws::new(robot, tcp);
        Self {
            closed_form: ClosedForm::new(&screws),
            ranges: ranges::of_robot(robot),
            screws,
        }
    }

    /// As [`solutions`].
    ///
    /// # Errors
    /// Where no joint positions give the pose, whatever the ranges.
    pub fn solutions(
        &self,
        pose: &Isometry3<f64>,
        reference: Option<&[f64]>,
        turns: Turns,
    ) -> Result<Solutions, Unreachable> {
        let target = Place::from(pose);
        let reference = self.reference(reference);
        let (solutions, method) = self.every_branch(target, &reference)?;
        let positions = self.listed(solutions, &reference, turns);
        let mut newton = Newton::new(&self.screws, target);
        Ok(Solutions {
            solutions: positions.into_iter().map(|q| self.solution(q, &mut newton)).collect(),
            method,
        })
    }

    /// The solution within every joint range that is nearest to the reference, one value a joint.
    ///
    /// Without a closed form it is the one that Newton steps from the reference lead to, where that is near; otherwise
    /// the nearest of those that a short search finds.
    ///
    /// # Errors
    /// Where there is none.
    pub fn nearest(&self, pose: &Isometry3<f64>, reference: &[f64]) -> Result<Vec<f64>, Unreachable> {
        let target = Place::from(pose);
        let reference = self.reference(Some(reference));
        let solutions = if self.closed_form.is_some() {
            self.every_branch(target, &reference)?.0
        } else {
            self.near(target, &reference)?
        };
        let mut positions = self.listed(solutions, &reference, Turns::Nearest);
        if self.is_in_range(&positions[0]) {
            return Ok(positions.swap_remove(0));
        }
        Err(self.outside(positions))
    }

    /// The solution on the reference's own branch, continuously from there and without whole turns: for the next place
    /// of a path. The reference must be near, by less than some tenths of a radian: the steps follow no path in between,
    /// so that whoever does sees by the joints' travel whether they have passed a singularity.
    ///
    /// # Errors
    /// Where the branch ends at a singularity before the pose, or leaves a joint's range, or the pose is out of reach.
    pub fn follow(&self, pose: &Isometry3<f64>, reference: &[f64]) -> Result<Vec<f64>, Unreachable> {
        let target = Place::from(pose);
        let reference = self.reference(Some(reference));
        let (q, gap) = search::from_reference(&self.screws, target, &self.ranges, &reference, false);
        if gap.is_closed() {
            return if self.is_in_range(&q) {
                Ok(q)
            } else {
                Err(self.outside(vec![q]))
            };
        }
        self.every_branch(target, &reference)?;
        Err(Unreachable::Singular {
            smallest_singular_value: singular::look(&mut Newton::new(&self.screws, target), &q).1,
            closest: q,
            position_gap: gap.linear.norm(),
            orientation_gap: gap.angular.norm(),
        })
    }

    /// Every solution, each moved into its range where that is possible: by the closed form, else by searching.
    fn every_branch(&self, target: Place, reference: &[f64]) -> Result<(Vec<Vec<f64>>, Method), Unreachable> {
        if let Some(closed_form) = &self.closed_form {
            let solutions = search::from_candidates(&self.screws, closed_form, target, &self.ranges, reference);
            if !solutions.is_empty() {
                return Ok((solutions, Method::ClosedForm));
            }
        }
        Ok((self.searched(target, reference, IK_PATIENCE)?, Method::Numerical))
    }

    /// The solution that a run from the reference leads to, where that is near; else those of a short search.
    fn near(&self, target: Place, reference: &[f64]) -> Result<Vec<Vec<f64>>, Unreachable> {
        let (q, gap) = search::from_reference(&self.screws, target, &self.ranges, reference, true);
        let is_near = q.iter().zip(reference).all(|(q, r)| (q - r).abs() <= IK_NEAR);
        if gap.is_closed() && is_near && self.is_in_range(&q) {
            return Ok(vec![q]);
        }
        self.searched(target, reference, IK_PATIENCE_NEAR)
    }

    fn searched(&self, target: Place, reference: &[f64], patience: usize) -> Result<Vec<Vec<f64>>, Unreachable> {
        let found = search::everywhere(&self.screws, target, &self.ranges, reference, patience);
        if found.solutions.is_empty() {
            return Err(out_of_reach(found.closest));
        }
        Ok(found.solutions)
    }

    /// One value a joint: the reference, or the middle of the range where it has none.
    fn reference(&self, reference: Option<&[f64]>) -> Vec<f64> {
        let given = reference.unwrap_or(&[]);
        let joints = self.ranges.iter().enumerate();
        joints
            .map(|(j, range)| given.get(j).copied().unwrap_or_else(|| range.middle()))
            .collect()
    }

    fn is_in_range(&self, q: &[f64]) -> bool {
        ranges::worst(&self.ranges, q).is_none()
    }

    /// Copies by whole turns added, in the order of the answer.
    fn listed(&self, solutions: Vec<Vec<f64>>, reference: &[f64], turns: Turns) -> Vec<Vec<f64>> {
        let positions = match turns {
            Turns::Nearest => solutions,
            Turns::Every => ranges::with_copies(&self.ranges, &solutions),
        };
        let is_outside = |q: &[f64]| ranges::worst(&self.ranges, q).is_some();
        let mut keyed: Vec<(bool, f64, Vec<f64>)> = positions
            .into_iter()
            .map(|q| (is_outside(&q), squared_distance(&q, reference), q))
            .collect();
        keyed.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        keyed.into_iter().map(|(_, _, q)| q).collect()
    }

    fn solution(&self, position: Vec<f64>, newton: &mut Newton<'_>) -> Solution {
        let (gap, smallest_singular_value) = singular::look(newton, &position);
        Solution {
            position_error: gap.linear.norm(),
            orientation_error: gap.angular.norm(),
            in_range: self.is_in_range(&position),
            smallest_singular_value,
            position,
        }
    }

    /// The evidence that every solution is outside the ranges.
    fn outside(&self, positions: Vec<Vec<f64>>) -> Unreachable {
        let excess = |q: &[f64]| {
            let joints = self.ranges.iter().zip(q);
            joints.fold(0.0, |most: f64, (range, &q)| most.max(range.excess(q)))
        };
        let least = positions.into_iter().min_by(|a, b| excess(a).total_cmp(&excess(b)));
        let positions = least.unwrap_or_default();
        let joint = ranges::worst(&self.ranges, &positions).unwrap_or(0);
        let (range, needed) = (self.ranges[joint], positions[joint]);
        Unreachable::JointRange {
            joint,
            needed,
            available: if needed > range.upper { range.upper } else { range.lower },
            positions,
        }
    }
}

fn out_of_reach((closest, gap): (Vec<f64>, gap::Gap)) -> Unreachable {
    Unreachable::OutOfReach {
        closest,
        position_gap: gap.linear.norm(),
        orientation_gap: gap.angular.norm(),
    }
}
