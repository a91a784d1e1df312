//! What a URDF says, link by link and joint by joint, before any chain is chosen.

use std::fmt;

use nalgebra::{Isometry3, Vector3};

use crate::robot::findings::quoted;
use crate::robot::spec::{Inertial, Limits};

/// The links and joints of a document, in its order.
#[derive(Debug, Default)]
pub(super) struct Model<'a> {
    pub(super) links: Vec<Link<'a>>,
    pub(super) joints: Vec<Joint<'a>>,
}

#[derive(Debug)]
pub(super) struct Link<'a> {
    pub(super) name: &'a str,
    pub(super) line: usize,
    /// In the link's frame.
    pub(super) inertial: Option<Inertial>,
}

#[derive(Debug)]
pub(super) struct Joint<'a> {
    pub(super) name: &'a str,
    pub(super) line: usize,
    pub(super) kind: Kind,
    pub(super) parent: &'a str,
    pub(super) child: &'a str,
    pub(super) parent_from_joint: Isometry3<f64>,
    /// A unit vector, in the joint's frame.
    pub(super) axis: Vector3<f64>,
    /// Position limits only where the joint has them.
    pub(super) limits: Limits,
    /// `None` where the file has 0 or nothing.
    pub(super) effort: Option<f64>,
    pub(super) dynamics: Dynamics,
    pub(super) mimic: Option<Mimic<'a>>,
    /// Warnings that matter where the joint is on the chain.
    pub(super) oddities: Vec<String>,
}

/// How a joint moves, with the kinds that a chain cannot have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Fixed,
    Revolute,
    Continuous,
    Prismatic,
    Floating,
    Planar,
}

/// The `<dynamics>` element: a simulator's values more often than measurements.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Dynamics {
    pub(super) damping: f64,
    pub(super) friction: f64,
}

/// position = multiplier × (position of the master) + offset
#[derive(Debug, Clone, Copy)]
pub(super) struct Mimic<'a> {
    pub(super) master: &'a str,
    pub(super) multiplier: f64,
    pub(super) offset: f64,
}

impl Kind {
    pub(super) fn named(name: &str) -> Option<Self> {
        Some(match name {
            "fixed" => Self::Fixed,
            "revolute" => Self::Revolute,
            "continuous" => Self::Continuous,
            "prismatic" => Self::Prismatic,
            "floating" => Self::Floating,
            "planar" => Self::Planar,
            _ => return None,
        })
    }

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Fixed => "fixed",
            Self::Revolute => "revolute",
            Self::Continuous => "continuous",
            Self::Prismatic => "prismatic",
            Self::Floating => "floating",
            Self::Planar => "planar",
        }
    }

    /// Whether the joint has one degree of freedom along or about an axis.
    pub(super) fn has_axis(self) -> bool {
        matches!(self, Self::Revolute | Self::Continuous | Self::Prismatic)
    }

    /// Whether a range of positions means anything.
    pub(super) fn has_range(self) -> bool {
        matches!(self, Self::Revolute | Self::Prismatic)
    }
}

/// `joint "elbow" (line 12)`
impl fmt::Display for Joint<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "joint {} (line {})", quoted(self.name), self.line)
    }
}

/// `link "forearm" (line 7)`
impl fmt::Display for Link<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "link {} (line {})", quoted(self.name), self.line)
    }
}
