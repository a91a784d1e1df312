//! Folds the tree around a chain into its moving links.

use std::fmt::Write as _;

use nalgebra::Isometry3;

use super::hold::Hold;
use super::model::{Joint, Kind};
use super::select::Selection;
use crate::robot::bounds::{FRICTION, MAX_LISTED_NAMES};
use crate::robot::chain::Chain;
use crate::robot::findings::{Findings, quoted};
use crate::robot::inertial;
use crate::robot::rotation::renormalized;
use crate::robot::spec::{Drive, Friction, Inertial, JointKind, JointSpec};

impl<'m> Selection<'m, '_> {
    /// The chain, each moving link with the mass of all that it carries.
    pub(super) fn chain(&self, use_dynamics: bool, findings: &mut Findings) -> Option<Chain> {
        let mut hold = Hold::new(self.model, self.tree, &self.on_chain);
        let mut held = Held::default();
        let mut joints: Vec<JointSpec> = Vec::new();
        let mut link_from_frame = Isometry3::identity();
        for index in &self.path {
            let joint = &self.model.joints[*index];
            let link_from_joint = renormalized(link_from_frame * joint.parent_from_joint);
            match moving_kind(joint.kind) {
                None => link_from_frame = link_from_joint,
                Some(kind) => {
                    joints.push(joint_spec(joint, kind, link_from_joint, use_dynamics, findings));
                    link_from_frame = Isometry3::identity();
                }
            }
            // Before the first moving joint everything stands still with the base link.
            if let Some(moving) = joints.last_mut() {
                let link = self.tree.ends[*index].1;
                self.fold(link, &link_from_frame, &mut moving.link, &mut hold, &mut held, findings);
            }
        }
        for joint in &joints {
            if joint.link.mass == 0.0 {
                findings.warn(format!(
                    "joint {}: the links that it moves have no mass",
                    quoted(&joint.name)
                ));
            }
        }
        held.warn(findings);
        if !use_dynamics {
            self.warn_of_dynamics(findings);
        }
        (!findings.has_errors()).then_some(Chain {
            joints,
            link_from_tip: link_from_frame,
        })
    }

    /// Adds a link of the chain, and all that hangs on it beside the chain, to the body that it moves with.
    fn fold(
        &self,
        link: usize,
        body_from_link: &Isometry3<f64>,
        body: &mut Inertial,
        hold: &mut Hold<'_, '_>,
        held: &mut Held<'m>,
        findings: &mut Findings,
    ) {
        let mut open = Vec::new();
        self.add(link, *body_from_link, body, &mut open, findings);
        while let Some((index, body_from_parent)) = open.pop() {
            let joint = &self.model.joints[index];
            let (parent_from_child, position) = hold.pose(index, findings);
            if joint.kind != Kind::Fixed {
                held.joints.push((joint.name, position));
            }
            let body_from_child = renormalized(body_from_parent * parent_from_child);
            self.add(self.tree.ends[index].1, body_from_child, body, &mut open, findings);
        }
    }

    /// Adds one link to a body, and to `open` the joints that hang on it beside the chain.
    fn add(
        &self,
        link: usize,
        body_from_link: Isometry3<f64>,
        body: &mut Inertial,
        open: &mut Vec<(usize, Isometry3<f64>)>,
        findings: &mut Findings,
    ) {
        let model = &self.model.links[link];
        if let Some(inertial) = &model.inertial {
            if let Some(oddity) = inertial::oddity(format_args!("link {}", quoted(model.name)), inertial) {
                findings.warn(oddity);
            }
            *body = body.joined(&inertial.seen_from(&body_from_link));
        }
        // Taken from the back, so put there in reverse: links are met in the document's order.
        let joints = self.tree.joints_below[link].iter().rev().copied();
        let beside = joints.filter(|joint| !self.on_chain[*joint]);
        open.extend(beside.map(|joint| (joint, body_from_link)));
    }

    /// A file with values that look like friction should not be thought to be planned with.
    fn warn_of_dynamics(&self, findings: &mut Findings) {
        let joints = self.path.iter().map(|joint| &self.model.joints[*joint]);
        let mut stated = joints.filter(|joint| joint.dynamics.damping != 0.0 || joint.dynamics.friction != 0.0);
        let Some(first) = stated.next() else {
            return;
        };
        let further = match stated.count() {
            0 => String::new(),
            count => format!(" and {count} more"),
        };
        findings.warn(format!(
            "<dynamics> of joint {}{further} (damping {:?}, friction {:?}) is not used as friction: use_urdf_dynamics is not set",
            quoted(first.name),
            first.dynamics.damping,
            first.dynamics.friction
        ));
    }
}

/// Joints beside the chain that could move, and where they are held.
#[derive(Default)]
struct Held<'m> {
    joints: Vec<(&'m str, f64)>,
}

impl Held<'_> {
    fn warn(&self, findings: &mut Findings) {
        if self.joints.is_empty() {
            return;
        }
        let mut list = String::new();
        for (count, (name, position)) in self.joints.iter().take(MAX_LISTED_NAMES).enumerate() {
            let separator = if count == 0 { "" } else { ", " };
            // Writing to a string cannot fail.
            let _ = write!(list, "{separator}{} at {position:?}", quoted(name));
        }
        if let further @ 1.. = self.joints.len().saturating_sub(MAX_LISTED_NAMES) {
            let _ = write!(list, " and {further} more");
        }
        findings.warn(format!("joints beside the chain are held still: {list}"));
    }
}

fn moving_kind(kind: Kind) -> Option<JointKind> {
    match kind {
        Kind::Revolute => Some(JointKind::Revolute),
        Kind::Continuous => Some(JointKind::Continuous),
        Kind::Prismatic => Some(JointKind::Prismatic),
        Kind::Fixed | Kind::Floating | Kind::Planar => None,
    }
}

fn joint_spec(
    joint: &Joint<'_>,
    kind: JointKind,
    parent_from_joint: Isometry3<f64>,
    use_dynamics: bool,
    findings: &mut Findings,
) -> JointSpec {
    let joint_friction = if use_dynamics {
        friction(joint, findings)
    } else {
        Friction::default()
    };
    JointSpec {
        name: joint.name.to_owned(),
        kind,
        parent_from_joint,
        axis: joint.axis,
        link: Inertial::zero(),
        limits: joint.limits,
        drive: Drive {
            peak_torque: joint.effort,
            joint_friction,
            ..Drive::default()
        },
    }
}

/// `<dynamics>` as friction: damping is viscous, friction is Coulomb's, the same both ways.
fn friction(joint: &Joint<'_>, findings: &mut Findings) -> Friction {
    let dynamics = &joint.dynamics;
    for (name, value) in [("damping", dynamics.damping), ("friction", dynamics.friction)] {
        if let Some(fault) = FRICTION.fault(value) {
            findings.error("urdf", format!("{joint}: {name} of <dynamics>: {fault}"));
        }
    }
    Friction {
        viscous: dynamics.damping,
        coulomb_positive: dynamics.friction,
        coulomb_negative: dynamics.friction,
        ..Friction::default()
    }
}
