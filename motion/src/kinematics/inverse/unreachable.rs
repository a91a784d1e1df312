//! Why a pose has no joint positions, as evidence.

use std::fmt;

/// A pose that cannot be taken.
#[derive(Debug, Clone, PartialEq)]
pub enum Unreachable {
    /// No joint positions at all give the pose, whatever the ranges.
    OutOfReach {
        /// The joint positions found that bring the tool closest, rad or m; some may be outside their ranges.
        closest: Vec<f64>,
        /// Distance of the tool from the pose there, m.
        position_gap: f64,
        /// Angle between the tool and the pose there, rad.
        orientation_gap: f64,
    },
    /// The pose needs a joint outside its range: of all solutions, the one least outside.
    JointRange {
        /// Which joint is the furthest outside in that solution.
        joint: usize,
        /// Where it would have to be, rad or m.
        needed: f64,
        /// The end of its range, rad or m.
        available: f64,
        /// That solution.
        positions: Vec<f64>,
    },
    /// The pose can be taken, but not on the reference's branch: a singularity is between.
    Singular {
        /// How far the branch was followed, rad or m.
        closest: Vec<f64>,
        /// Smallest singular value of the Jacobian there.
        smallest_singular_value: f64,
        /// Distance of the tool from the pose there, m.
        position_gap: f64,
        /// Angle between the tool and the pose there, rad.
        orientation_gap: f64,
    },
}

impl fmt::Display for Unreachable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OutOfReach {
                position_gap,
                orientation_gap,
                ..
            } => write!(
                f,
                "the pose is out of reach: the tool comes no closer than {position_gap:.6} m and {orientation_gap:.6} rad"
            ),
            Self::JointRange {
                joint,
                needed,
                available,
                ..
            } => write!(
                f,
                "the pose needs joint {joint} at {needed:.6}, outside its range, which ends at {available:.6}"
            ),
            Self::Singular {
                smallest_singular_value,
                position_gap,
                orientation_gap,
                ..
            } => write!(
                f,
                "the branch ends at a singularity (smallest singular value {smallest_singular_value:.6}) \
                 {position_gap:.6} m and {orientation_gap:.6} rad before the pose"
            ),
        }
    }
}

impl std::error::Error for Unreachable {}
