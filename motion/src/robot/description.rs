//! The description of an arm as a caller gives it: a URDF or a DH table, with limits and drives beside it.
//! [`Description::resolve`] makes a [`super::spec::RobotSpec`] of it, and says what is wrong and what is odd.

use nalgebra::{Isometry3, Matrix3, Vector3};

use super::spec::{Inertial, Limits, ParameterKind, Residual};

/// Everything that a caller says of an arm.
#[derive(Debug, Clone, PartialEq)]
pub struct Description {
    /// Where the chain comes from.
    pub kinematics: Kinematics,
    /// Limits and drives by joint name.
    pub joints: Vec<JointEntry>,
    /// Gravity in base-link axes, m/s²; `None`: standard gravity downwards.
    pub gravity: Option<Vector3<f64>>,
    /// Default payload, in the tip link's frame.
    pub payload: Option<Inertial>,
    /// Default tool centre point, in the tip link's frame.
    pub tcp: Option<Isometry3<f64>>,
    /// Named frames, in base-link axes.
    pub frames: Vec<(String, Isometry3<f64>)>,
    /// Read friction from the URDF's `<dynamics>` elements.
    pub use_urdf_dynamics: bool,
    /// Bodies that take the place of the chain's own.
    pub link_inertia: Vec<LinkEntry>,
    /// How well the fitted parameters are known; `None`: all are taken as exact.
    pub uncertainty: Option<UncertaintyEntry>,
}

impl Description {
    /// A chain of which nothing else is said: its own limits and bodies, standard gravity, no drives.
    #[must_use]
    pub fn new(kinematics: Kinematics) -> Self {
        Self {
            kinematics,
            joints: Vec::new(),
            gravity: None,
            payload: None,
            tcp: None,
            frames: Vec::new(),
            use_urdf_dynamics: false,
            link_inertia: Vec::new(),
            uncertainty: None,
        }
    }
}

/// Everything that moves with a joint and before the next one, in the place of what the chain says of it.
#[derive(Debug, Clone, PartialEq)]
pub struct LinkEntry {
    /// Name of the joint.
    pub joint: String,
    /// In the joint's frame.
    pub body: Inertial,
}

/// [`super::spec::Uncertainty`], with joints by name.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct UncertaintyEntry {
    /// What was fitted: of which joint, and what.
    pub parameters: Vec<(String, ParameterKind)>,
    /// Covariance of the parameters: its lower triangle row by row.
    pub covariance: Vec<f64>,
    /// One entry a joint, in any order.
    pub residuals: Vec<(String, Residual)>,
}

/// Where a chain comes from.
#[derive(Debug, Clone, PartialEq)]
pub enum Kinematics {
    /// The serial chain between two links of a URDF's tree.
    Urdf {
        /// The document.
        text: String,
        /// First link; `None`: the root of the tree.
        base_link: Option<String>,
        /// Last link; `None`: the only leaf.
        tip_link: Option<String>,
    },
    /// A Denavit-Hartenberg table.
    Dh {
        /// Which of the two conventions.
        convention: DhConvention,
        /// One row a joint.
        links: Vec<DhLink>,
    },
}

/// How a row of a DH table is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DhConvention {
    /// Rz(θ) Tz(d) Tx(a) Rx(α): the link's frame stands at its far end.
    Standard,
    /// Rx(α) Tx(a) Rz(θ) Tz(d): the link's frame stands on its own joint's axis.
    Modified,
}

/// One row of a DH table and the link that moves with it.
#[derive(Debug, Clone, PartialEq)]
pub struct DhLink {
    /// Name of the joint.
    pub name: String,
    /// The joint slides along z instead of turning about it.
    pub prismatic: bool,
    /// m.
    pub a: f64,
    /// rad.
    pub alpha: f64,
    /// m.
    pub d: f64,
    /// rad.
    pub theta: f64,
    /// kg.
    pub mass: f64,
    /// In link axes, m.
    pub center_of_mass: Vector3<f64>,
    /// About the centre of mass, in link axes, kg m².
    pub inertia: Matrix3<f64>,
}

/// Limits and drive of one joint, as far as the caller gives them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct JointEntry {
    /// Name of the joint.
    pub name: String,
    /// `None` fields come from the URDF, where it has them.
    pub limits: Limits,
    /// `None` fields come from the URDF, or have their defaults.
    pub drive: DriveEntry,
}

/// The drive of one joint, as far as the caller gives it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct DriveEntry {
    /// At the joint, N m or N.
    pub peak_torque: Option<f64>,
    /// At the joint, N m or N.
    pub rated_torque: Option<f64>,
    /// Default: 1.
    pub gear_ratio: Option<f64>,
    /// On the motor side, kg m². Default: 0.
    pub rotor_inertia: Option<f64>,
    /// Stated on the motor side.
    pub motor_friction: Option<FrictionEntry>,
    /// Stated on the joint side.
    pub joint_friction: Option<FrictionEntry>,
    /// N m/A.
    pub torque_constant: Option<f64>,
    /// Coefficients of odd powers.
    pub stiffness: Vec<f64>,
    /// At the joint.
    pub damping: Option<f64>,
}

/// Friction on one side of the gear, as far as the caller gives it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FrictionEntry {
    /// Default: 0.
    pub viscous: Option<f64>,
    /// Default: 0.
    pub coulomb_positive: Option<f64>,
    /// Default: the positive one.
    pub coulomb_negative: Option<f64>,
    /// Default: 0.
    pub load_coulomb: Option<f64>,
    /// Default: 0. May be negative, but not below −viscous over twice the speed limit on that side.
    pub quadratic: Option<f64>,
    /// Default: the contact slides at once.
    pub presliding_stiffness: Option<f64>,
}
