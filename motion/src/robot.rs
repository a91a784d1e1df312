//! A robot: a description, checked and made ready to compute with. Immutable; one value serves every thread.

pub(crate) mod bounds;
pub mod chain;
pub mod description;
pub(crate) mod dh;
pub(crate) mod findings;
pub(crate) mod inertial;
mod preset;
pub mod resolve;
pub(crate) mod rotation;
pub mod spec;
pub mod urdf;
pub mod urdf_writer;

use std::sync::Arc;

use crate::confidence::Factor;
use crate::dynamics::chain::Chain;
use crate::dynamics::drive::{DriveTerms, any_loaded};
use crate::error::Invalid;
pub use preset::Preset;
use spec::{Inertial, RobotSpec};

/// Most joints that a chain may have.
pub const JOINTS_MAX: usize = 32;

/// A robot that can be computed with.
#[derive(Debug, Clone)]
pub struct Robot {
    model: Arc<Model>,
    /// The chain with its payload.
    chain: Chain,
    payload: Inertial,
}

/// What does not change with the payload.
#[derive(Debug)]
struct Model {
    spec: RobotSpec,
    warnings: Vec<String>,
    bare: Chain,
    drives: Vec<DriveTerms>,
    /// Some drive's friction depends on its gravity torque.
    is_loaded: bool,
    presets: Vec<Option<Preset>>,
    /// `None`: its parameters are taken as exact.
    factor: Option<Factor>,
}

impl Robot {
    /// Makes a robot of a description. `warnings` are what its reader found odd; they stay with the robot.
    ///
    /// # Errors
    /// Where nothing can be computed: no joint, more than [`JOINTS_MAX`], a mass matrix that is singular, or an uncertainty
    /// that is none.
    pub fn new(spec: RobotSpec, mut warnings: Vec<String>) -> Result<Self, Vec<Invalid>> {
        let count = spec.joints.len();
        if count == 0 {
            return Err(vec![Invalid::new("", "the chain has no moving joint")]);
        }
        if count > JOINTS_MAX {
            let message = format!("the chain has {count} moving joints, the most is {JOINTS_MAX}");
            return Err(vec![Invalid::new("", message)]);
        }
        let factor = Factor::new(&spec)?;
        let bare = Chain::new(&spec);
        let drives: Vec<DriveTerms> = spec.joints.iter().map(|joint| DriveTerms::new(&joint.drive)).collect();
        let payload = spec.payload.on_last_link(&spec);
        let chain = bare.clone().with_load(&payload);
        let presets = preset::derive(&spec, &chain, &drives, &mut warnings)?;
        let payload = spec.payload;
        let model = Model {
            spec,
            warnings,
            bare,
            is_loaded: any_loaded(&drives),
            drives,
            presets,
            factor,
        };
        Ok(Self {
            model: Arc::new(model),
            chain,
            payload,
        })
    }

    /// The same robot with another payload, given in the tip link's frame.
    #[must_use]
    pub fn with_payload(&self, payload: &Inertial) -> Self {
        let on_link = payload.on_last_link(&self.model.spec);
        Self {
            model: Arc::clone(&self.model),
            chain: self.model.bare.clone().with_load(&on_link),
            payload: *payload,
        }
    }

    /// The description that it was made of.
    #[must_use]
    pub fn spec(&self) -> &RobotSpec {
        &self.model.spec
    }

    /// What was odd in the description and could be lived with.
    #[must_use]
    pub fn warnings(&self) -> &[String] {
        &self.model.warnings
    }

    /// How many joints move.
    #[must_use]
    pub fn joint_count(&self) -> usize {
        self.model.drives.len()
    }

    /// What it carries, in the tip link's frame.
    #[must_use]
    pub fn payload(&self) -> &Inertial {
        &self.payload
    }

    /// The accelerations of the conventional pattern; `None` where they are neither given nor can be derived.
    #[must_use]
    pub fn preset(&self, joint: usize) -> Option<Preset> {
        self.model.presets[joint]
    }

    pub(crate) fn chain(&self) -> &Chain {
        &self.chain
    }

    pub(crate) fn factor(&self) -> Option<&Factor> {
        self.model.factor.as_ref()
    }

    pub(crate) fn drives(&self) -> &[DriveTerms] {
        &self.model.drives
    }

    /// Whether some drive's friction depends on what gravity asks of it.
    pub(crate) fn is_loaded(&self) -> bool {
        self.model.is_loaded
    }
}

impl Inertial {
    /// A body on the tip link, seen from the last moving link's frame.
    fn on_last_link(&self, spec: &RobotSpec) -> Self {
        self.seen_from(&spec.link_from_tip)
    }
}
