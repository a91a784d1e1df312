//! Where the joints beside the chain stand still: at 0, at the limit nearest to it, or where their master puts them.

use nalgebra::{Isometry3, Vector3};

use super::model::{Joint, Kind, Model};
use super::tree::Tree;
use crate::robot::bounds::POSITION;
use crate::robot::findings::{Findings, quoted};
use crate::robot::rotation;

/// Positions of held joints, found when asked for.
pub(super) struct Hold<'m, 'a> {
    model: &'m Model<'a>,
    tree: &'m Tree<'a>,
    on_chain: &'m [bool],
    known: Vec<Option<f64>>,
}

impl<'m, 'a> Hold<'m, 'a> {
    pub(super) fn new(model: &'m Model<'a>, tree: &'m Tree<'a>, on_chain: &'m [bool]) -> Self {
        Self {
            model,
            tree,
            on_chain,
            known: vec![None; model.joints.len()],
        }
    }

    /// Pose of the joint's child link in its parent link, and the position that the joint is held at.
    pub(super) fn pose(&mut self, index: usize, findings: &mut Findings) -> (Isometry3<f64>, f64) {
        let joint = &self.model.joints[index];
        let position = self.position(index, findings);
        (joint.parent_from_joint * displacement(joint, position), position)
    }

    /// Follows the masters up to one that stands by itself, then comes back down.
    fn position(&mut self, index: usize, findings: &mut Findings) -> f64 {
        let mut followers = Vec::new();
        let mut index = index;
        let mut position = loop {
            if let Some(position) = self.known[index] {
                break position;
            }
            let joint = &self.model.joints[index];
            if self.on_chain[index] {
                // It moves; its mimic is held where position 0 puts it, and the follower's warning says so.
                break 0.0;
            }
            let Some(mimic) = joint.mimic else {
                break rest(joint);
            };
            let Some(master) = self.tree.joint_of.get(mimic.master).copied() else {
                findings.warn(format!(
                    "{joint} mimics joint {}, which is not there: held at its own rest",
                    quoted(mimic.master)
                ));
                break rest(joint);
            };
            if followers.len() > self.model.joints.len() {
                findings.error("urdf", format!("{joint} mimics itself by way of others"));
                for follower in followers {
                    self.known[follower] = Some(0.0);
                }
                return 0.0;
            }
            if self.on_chain[master] {
                findings.warn(format!(
                    "{joint} mimics joint {}, which moves: held where position 0 of that puts it",
                    quoted(mimic.master)
                ));
            }
            followers.push(index);
            index = master;
        };
        self.known[index] = Some(position);
        for follower in followers.into_iter().rev() {
            let joint = &self.model.joints[follower];
            if let Some(mimic) = joint.mimic {
                position = mimic.multiplier * position + mimic.offset;
            }
            if let Some(fault) = POSITION.fault(position) {
                findings.error("urdf", format!("{joint}: position as a mimic: {fault}"));
                position = 0.0;
            }
            self.known[follower] = Some(position);
        }
        position
    }
}

/// Position 0, or the limit nearest to it.
fn rest(joint: &Joint<'_>) -> f64 {
    let lower = joint.limits.position_lower.unwrap_or(f64::NEG_INFINITY);
    let upper = joint.limits.position_upper.unwrap_or(f64::INFINITY);
    0.0_f64.max(lower).min(upper)
}

/// Pose of the moved joint frame in the joint frame at position 0.
fn displacement(joint: &Joint<'_>, position: f64) -> Isometry3<f64> {
    match joint.kind {
        Kind::Fixed | Kind::Floating | Kind::Planar => Isometry3::identity(),
        Kind::Revolute | Kind::Continuous => rotation::pose(Vector3::zeros(), rotation::about(&joint.axis, position)),
        Kind::Prismatic => rotation::pose(joint.axis * position, nalgebra::UnitQuaternion::identity()),
    }
}
