//! A serial chain, as a reader hands it over.

use nalgebra::Isometry3;

use super::spec::JointSpec;

/// The moving joints between two links, with the limits and drives that their source states.
#[derive(Debug, Clone, PartialEq)]
pub struct Chain {
    /// In the order from base to tip.
    pub joints: Vec<JointSpec>,
    /// Pose of the tip link's frame in the frame of the last moving joint's link.
    pub link_from_tip: Isometry3<f64>,
}
