//! The way between two links of a tree: which joints are on the chain, and whether a chain can have them.

use super::Options;
use super::model::{Kind, Model};
use super::tree::Tree;
use crate::robot::bounds::MAX_JOINTS;
use crate::robot::findings::{Findings, listed, quoted};

/// The way from the base link to the tip link.
pub(super) struct Selection<'m, 'a> {
    pub(super) model: &'m Model<'a>,
    pub(super) tree: &'m Tree<'a>,
    base: usize,
    /// Joints from base to tip, fixed ones too.
    pub(super) path: Vec<usize>,
    /// Per joint of the model.
    pub(super) on_chain: Vec<bool>,
}

impl<'m, 'a> Selection<'m, 'a> {
    /// The way between the links that the options name; `None` where there is none that can be computed with.
    pub(super) fn of(
        model: &'m Model<'a>,
        tree: &'m Tree<'a>,
        options: &Options<'_>,
        findings: &mut Findings,
    ) -> Option<Self> {
        let base = match options.base_link {
            Some(name) => find_link(tree, "base_link", name, findings),
            None => Some(tree.root),
        };
        let tip = match options.tip_link {
            Some(name) => find_link(tree, "tip_link", name, findings),
            None => only_leaf(model, tree, base?, findings),
        };
        let path = path(model, tree, base?, tip?, findings)?;
        let mut on_chain = vec![false; model.joints.len()];
        for joint in &path {
            on_chain[*joint] = true;
        }
        let selection = Self {
            model,
            tree,
            base: base?,
            path,
            on_chain,
        };
        selection.check_joints(tip?, findings);
        (!findings.has_errors()).then_some(selection)
    }

    fn check_joints(&self, tip: usize, findings: &mut Findings) {
        let joints = self.path.iter().map(|joint| &self.model.joints[*joint]);
        for joint in joints.clone() {
            for oddity in &joint.oddities {
                findings.warn(oddity);
            }
            if matches!(joint.kind, Kind::Floating | Kind::Planar) {
                let kind = joint.kind.name();
                findings.error(
                    "urdf",
                    format!("{joint} is {kind}: a chain has fixed, revolute, continuous and prismatic joints"),
                );
            }
            if let Some(mimic) = joint.mimic {
                findings.error(
                    "urdf",
                    format!(
                        "{joint} mimics joint {}: every joint of the chain must move by itself",
                        quoted(mimic.master)
                    ),
                );
            }
        }
        let count = joints.filter(|joint| joint.kind.has_axis()).count();
        if count == 0 {
            findings.error(
                "urdf",
                format!(
                    "no joint moves between base link {} and tip link {}",
                    quoted(self.model.links[self.base].name),
                    quoted(self.model.links[tip].name)
                ),
            );
        }
        if count > MAX_JOINTS {
            findings.error(
                "urdf",
                format!("{count} moving joints on the chain must be at most {MAX_JOINTS}"),
            );
        }
    }
}

fn find_link(tree: &Tree<'_>, field: &str, name: &str, findings: &mut Findings) -> Option<usize> {
    let link = tree.link_of.get(name).copied();
    if link.is_none() {
        findings.error(field, format!("link {} is not in the URDF", quoted(name)));
    }
    link
}

/// The only leaf below the base link: where there are several, a guess would plan for the wrong arm.
fn only_leaf(model: &Model<'_>, tree: &Tree<'_>, base: usize, findings: &mut Findings) -> Option<usize> {
    let below = tree.below(base);
    let mut leaves: Vec<usize> = below
        .into_iter()
        .filter(|link| tree.joints_below[*link].is_empty())
        .collect();
    if let [leaf] = leaves[..] {
        return Some(leaf);
    }
    leaves.sort_unstable();
    findings.error(
        "tip_link",
        format!(
            "must be given, because {} links below {} are leaves: {}",
            leaves.len(),
            quoted(model.links[base].name),
            listed(leaves.iter().map(|leaf| model.links[*leaf].name))
        ),
    );
    None
}

/// Joints from base to tip.
fn path(model: &Model<'_>, tree: &Tree<'_>, base: usize, tip: usize, findings: &mut Findings) -> Option<Vec<usize>> {
    let mut path = Vec::new();
    let mut link = tip;
    while link != base {
        let Some(joint) = tree.joint_above[link] else {
            findings.error(
                "tip_link",
                format!(
                    "link {} is not below base link {}",
                    quoted(model.links[tip].name),
                    quoted(model.links[base].name)
                ),
            );
            return None;
        };
        path.push(joint);
        link = tree.ends[joint].0;
    }
    path.reverse();
    Some(path)
}
