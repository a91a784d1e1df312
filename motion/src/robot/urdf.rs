//! Reads the serial chain between two links out of a URDF's tree.
//!
//! Fixed joints are folded into the link before them. Links beside the chain and beyond its tip are held still, at
//! position 0 or the nearest limit, and count with their mass in the moving link that carries them; what hangs on the
//! base link, or is above it, does not move and counts nowhere.
//!
//! Reference: the URDF specification at wiki.ros.org/urdf/XML; where real files differ from it, the functions below
//! say what is done.

mod element;
mod fold;
mod guard;
mod hold;
mod limit;
mod model;
mod reader;
mod select;
mod tree;

#[cfg(test)]
mod tests;

use super::chain::Chain;
use super::findings::Findings;
use crate::error::Invalid;

/// Which chain to read, and how.
#[derive(Debug, Clone, Copy, Default)]
pub struct Options<'a> {
    /// First link; `None`: the root of the tree.
    pub base_link: Option<&'a str>,
    /// Last link; `None`: the only leaf below the base link.
    pub tip_link: Option<&'a str>,
    /// Read the `<dynamics>` of joints as friction on the joint side.
    pub use_dynamics: bool,
}

/// Reads a chain. What is odd but can be lived with comes back as warnings.
///
/// ```
/// use takt_motion::robot::urdf::{Options, read};
///
/// let text = "<robot name='slide'>
///   <link name='rail'/>
///   <link name='cart'><inertial><mass value='3'/></inertial></link>
///   <joint name='drive' type='prismatic'>
///     <parent link='rail'/><child link='cart'/>
///     <limit lower='0' upper='2' effort='400' velocity='3'/>
///   </joint>
/// </robot>";
/// let (chain, warnings) = read(text, &Options::default()).expect("the text is a URDF with one chain");
/// assert_eq!(chain.joints[0].limits.velocity, Some(3.0));
/// assert!(warnings[0].contains("point mass"));
/// ```
///
/// # Errors
///
/// All that is wrong, with `urdf`, `base_link` or `tip_link` as path and the line in the text.
pub fn read(text: &str, options: &Options<'_>) -> Result<(Chain, Vec<String>), Vec<Invalid>> {
    let mut findings = Findings::default();
    let chain = read_chain(text, options, &mut findings);
    findings.finish(chain)
}

pub(super) fn read_chain(text: &str, options: &Options<'_>, findings: &mut Findings) -> Option<Chain> {
    if let Err(message) = guard::check(text) {
        findings.error("urdf", message);
        return None;
    }
    let document = match reader::parse(text) {
        Ok(document) => document,
        Err(message) => {
            findings.error("urdf", message);
            return None;
        }
    };
    let lines = element::Lines::of(&document);
    let model = reader::model(&document, &lines, findings)?;
    let tree = tree::Tree::of(&model, findings)?;
    let selection = select::Selection::of(&model, &tree, options, findings)?;
    selection.chain(options.use_dynamics, findings)
}
