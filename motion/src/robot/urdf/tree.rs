//! The tree that joints make of links: every link but one has exactly one parent.

use std::collections::HashMap;

use super::model::Model;
use crate::robot::findings::{Findings, listed, quoted};

/// Indices into the model's links and joints.
#[derive(Debug)]
pub(super) struct Tree<'a> {
    /// Link by name. Looked up only, never walked, so its order shows nowhere.
    pub(super) link_of: HashMap<&'a str, usize>,
    /// Joint by name.
    pub(super) joint_of: HashMap<&'a str, usize>,
    /// Per link: the joint above it.
    pub(super) joint_above: Vec<Option<usize>>,
    /// Per link: the joints below it, in the document's order.
    pub(super) joints_below: Vec<Vec<usize>>,
    /// Per joint: the link above and the link below.
    pub(super) ends: Vec<(usize, usize)>,
    /// The one link without a parent.
    pub(super) root: usize,
}

impl<'a> Tree<'a> {
    /// The tree; `None` where there is none.
    pub(super) fn of(model: &Model<'a>, findings: &mut Findings) -> Option<Self> {
        if model.links.is_empty() {
            findings.error("urdf", "<robot> has no <link>");
            return None;
        }
        let link_of = links_by_name(model, findings);
        let joint_of = joints_by_name(model, findings);
        let ends = ends(model, &link_of, findings);
        if findings.has_errors() {
            return None;
        }
        let mut joint_above = vec![None; model.links.len()];
        let mut joints_below = vec![Vec::new(); model.links.len()];
        for (index, (parent, child)) in ends.iter().copied().enumerate() {
            if let Some(other) = joint_above[child] {
                let message = format!(
                    "{} has two parents: {} and {}",
                    model.links[child], model.joints[other], model.joints[index]
                );
                findings.error("urdf", message);
                continue;
            }
            joint_above[child] = Some(index);
            joints_below[parent].push(index);
        }
        if findings.has_errors() {
            return None;
        }
        let root = root(model, &joint_above, findings)?;
        let tree = Self {
            link_of,
            joint_of,
            joint_above,
            joints_below,
            ends,
            root,
        };
        tree.check_reach(model, findings);
        (!findings.has_errors()).then_some(tree)
    }

    /// All links at and below one, parents before children.
    pub(super) fn below(&self, link: usize) -> Vec<usize> {
        let mut reached = vec![link];
        let mut next = 0;
        while let Some(link) = reached.get(next) {
            reached.extend(self.joints_below[*link].iter().map(|joint| self.ends[*joint].1));
            next += 1;
        }
        reached
    }

    /// With one root and one parent for every other link, what the root does not reach goes round in circles.
    fn check_reach(&self, model: &Model<'_>, findings: &mut Findings) {
        let reached = self.below(self.root);
        if reached.len() == model.links.len() {
            return;
        }
        let mut is_reached = vec![false; model.links.len()];
        for link in reached {
            is_reached[link] = true;
        }
        let lost = is_reached.iter().position(|reached| !reached);
        if let Some(joint) = lost.and_then(|link| cycle_joint(link, &self.joint_above, &self.ends)) {
            findings.error("urdf", cycle_message(model, joint));
        }
    }
}

fn links_by_name<'a>(model: &Model<'a>, findings: &mut Findings) -> HashMap<&'a str, usize> {
    let mut link_of = HashMap::with_capacity(model.links.len());
    for (index, link) in model.links.iter().enumerate() {
        if let Some(first) = link_of.insert(link.name, index) {
            let line = model.links[first].line;
            findings.error("urdf", format!("{link} has the name of the link on line {line}"));
        }
    }
    link_of
}

fn joints_by_name<'a>(model: &Model<'a>, findings: &mut Findings) -> HashMap<&'a str, usize> {
    let mut joint_of = HashMap::with_capacity(model.joints.len());
    for (index, joint) in model.joints.iter().enumerate() {
        if let Some(first) = joint_of.insert(joint.name, index) {
            let line = model.joints[first].line;
            findings.error("urdf", format!("{joint} has the name of the joint on line {line}"));
        }
    }
    joint_of
}

/// Per joint its two links; incomplete where an error was found.
fn ends(model: &Model<'_>, link_of: &HashMap<&str, usize>, findings: &mut Findings) -> Vec<(usize, usize)> {
    let mut ends = Vec::with_capacity(model.joints.len());
    for joint in &model.joints {
        if joint.parent == joint.child {
            let link = quoted(joint.parent);
            findings.error("urdf", format!("{joint} connects link {link} with itself"));
            continue;
        }
        let mut find = |role: &str, name: &str| {
            let link = link_of.get(name).copied();
            if link.is_none() {
                findings.error(
                    "urdf",
                    format!("{joint}: its {role} link {} is not there", quoted(name)),
                );
            }
            link
        };
        let parent = find("parent", joint.parent);
        let child = find("child", joint.child);
        ends.extend(parent.zip(child));
    }
    ends
}

fn root(model: &Model<'_>, joint_above: &[Option<usize>], findings: &mut Findings) -> Option<usize> {
    let mut roots = (0..model.links.len()).filter(|link| joint_above[*link].is_none());
    let Some(root) = roots.next() else {
        // Every link has a parent, so the first joint's parents go round in circles too.
        let first = &model.links[0];
        findings.error(
            "urdf",
            format!("the tree has no root: {first} and every other link is the child of a joint"),
        );
        return None;
    };
    let others: Vec<&str> = roots.map(|link| model.links[link].name).collect();
    if !others.is_empty() {
        findings.error(
            "urdf",
            format!(
                "the tree must have one root, but these links are the child of no joint: {}",
                listed(std::iter::once(model.links[root].name).chain(others))
            ),
        );
        return None;
    }
    Some(root)
}

/// A joint of the cycle that is above `link`.
fn cycle_joint(link: usize, joint_above: &[Option<usize>], ends: &[(usize, usize)]) -> Option<usize> {
    let mut is_seen = vec![false; joint_above.len()];
    let mut link = link;
    loop {
        let joint = joint_above[link]?;
        if is_seen[link] {
            return Some(joint);
        }
        is_seen[link] = true;
        link = ends[joint].0;
    }
}

fn cycle_message(model: &Model<'_>, joint: usize) -> String {
    let joint = &model.joints[joint];
    format!(
        "{joint} closes a loop: its parent link {} is also below its child link {}",
        quoted(joint.parent),
        quoted(joint.child)
    )
}
