//! The description of an arm as registered: passive data, readers write it, [`crate::robot::Robot`] checks it.

use nalgebra::{Isometry3, Matrix3, Vector3};

/// Standard gravity (CGPM 1901), m/s².
pub const STANDARD_GRAVITY: f64 = 9.80665;

/// A serial arm: its chain from base to tip, what bounds it, and what it carries.
#[derive(Debug, Clone, PartialEq)]
pub struct RobotSpec {
    /// The moving joints, in model order.
    pub joints: Vec<JointSpec>,
    /// Pose of the tip link's frame in the frame of the last moving joint's link.
    pub link_from_tip: Isometry3<f64>,
    /// Gravity in base-link axes, m/s².
    pub gravity: Vector3<f64>,
    /// What the tip link carries by default, in the tip link's frame.
    pub payload: Inertial,
    /// The default tool centre point, in the tip link's frame.
    pub tcp: Isometry3<f64>,
    /// Named frames, in base-link axes.
    pub frames: Vec<(String, Isometry3<f64>)>,
    /// How well the fitted parameters are known; `None`: taken as exact.
    pub uncertainty: Option<Uncertainty>,
}

/// One moving joint and the link that moves with it.
#[derive(Debug, Clone, PartialEq)]
pub struct JointSpec {
    /// Name of the joint.
    pub name: String,
    /// How the joint moves.
    pub kind: JointKind,
    /// Pose of the joint's frame at position 0, in the frame of the link before it (the base link's for the first).
    pub parent_from_joint: Isometry3<f64>,
    /// Axis of motion in the joint's frame: a unit vector.
    pub axis: Vector3<f64>,
    /// Everything that moves with the joint and before the next one, in the joint's frame.
    pub link: Inertial,
    /// Limits of the motion.
    pub limits: Limits,
    /// The drive.
    pub drive: Drive,
}

/// How a joint moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JointKind {
    /// Turns about its axis.
    Revolute,
    /// Turns about its axis, without position limits.
    Continuous,
    /// Slides along its axis.
    Prismatic,
}

/// Mass distribution of a rigid body in some frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inertial {
    /// Mass, kg.
    pub mass: f64,
    /// Centre of mass, m.
    pub center_of_mass: Vector3<f64>,
    /// Rotational inertia about the centre of mass, kg m² (a symmetric tensor: products of inertia are negative).
    pub inertia: Matrix3<f64>,
}

/// Limits of one joint, "rad or m" and time derivatives. `None` is unknown, or no limit.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Limits {
    /// Lowest position.
    pub position_lower: Option<f64>,
    /// Highest position.
    pub position_upper: Option<f64>,
    /// Largest speed, either way.
    pub velocity: Option<f64>,
    /// Largest acceleration.
    pub acceleration: Option<f64>,
    /// Largest deceleration; `None`: the acceleration limit.
    pub deceleration: Option<f64>,
    /// Largest jerk.
    pub jerk: Option<f64>,
    /// Acceleration of the conventional pattern; `None`: derived.
    pub preset_acceleration: Option<f64>,
    /// Deceleration of the conventional pattern; `None`: the preset acceleration.
    pub preset_deceleration: Option<f64>,
}

/// The drive of one joint.
#[derive(Debug, Clone, PartialEq)]
pub struct Drive {
    /// Largest torque at the joint, either way, N m or N: rigid body + rotor + friction.
    pub peak_torque: Option<f64>,
    /// Torque at the joint that can be held for ever, N m or N.
    pub rated_torque: Option<f64>,
    /// Motor speed over joint speed; may be negative.
    pub gear_ratio: f64,
    /// Rotor inertia on the motor side, kg m².
    pub rotor_inertia: f64,
    /// Friction whose coefficients are stated on the motor side.
    pub motor_friction: Friction,
    /// Friction whose coefficients are stated on the joint side.
    pub joint_friction: Friction,
    /// Motor torque over motor current, N m/A.
    pub torque_constant: Option<f64>,
    /// Coefficients of the odd powers of the transmission's deformation, at the joint.
    pub stiffness: Vec<f64>,
    /// Damping of the transmission, at the joint.
    pub damping: Option<f64>,
}

/// Friction on one side of the gear. The direction is always the joint's.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Friction {
    /// Torque over speed on that side.
    pub viscous: f64,
    /// Magnitude of the Coulomb torque while the joint moves in its positive direction.
    pub coulomb_positive: f64,
    /// Magnitude of the Coulomb torque while the joint moves in its negative direction.
    pub coulomb_negative: f64,
    /// Coulomb torque that the load adds, over the magnitude of the joint's gravity torque: a number, the same on either side.
    pub load_coulomb: f64,
    /// Torque over speed squared on that side: q·v·|v|. Negative where the viscous term grows less and less, but no further than that
    /// friction does not fall within the speed limit.
    pub quadratic: f64,
    /// Torque over deflection on that side before the contact slides (Dahl's σ₀); `None`: it slides at once. Plans and their
    /// margins do not use it: a contact that does not slide yet takes at most the Coulomb torque, which they count in full.
    pub presliding_stiffness: Option<f64>,
}

/// How well the parameters of an arm are known, as a fit to recorded motion left them.
///
/// With φ the derivatives of a joint's torque by the parameters (its row of the regressor) and Σ their covariance, the
/// standard deviation of the torque that the model states is √(φᵀ·Σ·φ); what the model cannot say comes on top, as `residuals` has it.
#[derive(Debug, Clone, PartialEq)]
pub struct Uncertainty {
    /// What was fitted, in the order of the covariance's rows.
    pub parameters: Vec<Parameter>,
    /// Covariance of the parameters: its lower triangle row by row, in the product of their units.
    pub covariance: Vec<f64>,
    /// What is left between model and measurement, one entry a joint.
    pub residuals: Vec<Residual>,
}

/// One fitted parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Parameter {
    /// Index of the joint, whose link or drive it is of.
    pub joint: usize,
    /// What it is.
    pub kind: ParameterKind,
}

/// What a fitted parameter is: the torque is linear in each. Bodies are those that move with the joint, payload not
/// included, seen from the joint's frame; drives are seen from the joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum ParameterKind {
    /// kg.
    Mass,
    /// Mass times a coordinate of the centre of mass (0: x, 1: y, 2: z), kg m.
    FirstMoment(usize),
    /// Entry of the inertia tensor about the frame's ORIGIN (0 to 5: xx yy zz xy xz yz), kg m².
    Inertia(usize),
    /// Reflected rotor inertia, kg m² or kg.
    Armature,
    /// Torque over speed.
    Viscous,
    /// Coulomb torque while the joint moves in its positive direction.
    CoulombPositive,
    /// Coulomb torque while the joint moves in its negative direction.
    CoulombNegative,
    /// Coulomb torque over the magnitude of the gravity torque.
    LoadCoulomb,
    /// Torque over speed squared.
    Quadratic,
}

/// The part of a joint's torque that the model does not say.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Residual {
    /// Standard deviation, N m or N.
    pub deviation: f64,
    /// Time over which it stays alike, s: a motion of duration T draws it T/τ times.
    pub correlation_time: f64,
    /// Degrees of freedom, above 2, of the Student distribution that has its tails; infinite: it is normal.
    pub degrees_of_freedom: f64,
}

impl Inertial {
    /// Nothing.
    #[must_use]
    pub fn zero() -> Self {
        Self {
            mass: 0.0,
            center_of_mass: Vector3::zeros(),
            inertia: Matrix3::zeros(),
        }
    }

    /// The same body seen from another frame.
    #[must_use]
    pub fn seen_from(&self, other_from_body: &Isometry3<f64>) -> Self {
        let rotation = other_from_body.rotation.to_rotation_matrix();
        Self {
            mass: self.mass,
            center_of_mass: (other_from_body * nalgebra::Point3::from(self.center_of_mass)).coords,
            inertia: rotation.matrix() * self.inertia * rotation.matrix().transpose(),
        }
    }

    /// Two bodies in one frame, joined rigidly.
    #[must_use]
    pub fn joined(&self, other: &Self) -> Self {
        let mass = self.mass + other.mass;
        if mass == 0.0 {
            return Self {
                mass,
                center_of_mass: Vector3::zeros(),
                inertia: self.inertia + other.inertia,
            };
        }
        let center = (self.center_of_mass * self.mass + other.center_of_mass * other.mass) / mass;
        let about_center = |body: &Self| {
            let r = body.center_of_mass - center;
            body.inertia + (Matrix3::identity() * r.norm_squared() - r * r.transpose()) * body.mass
        };
        Self {
            mass,
            center_of_mass: center,
            inertia: about_center(self) + about_center(other),
        }
    }
}

impl Default for Drive {
    fn default() -> Self {
        Self {
            peak_torque: None,
            rated_torque: None,
            gear_ratio: 1.0,
            rotor_inertia: 0.0,
            motor_friction: Friction::default(),
            joint_friction: Friction::default(),
            torque_constant: None,
            stiffness: Vec::new(),
            damping: None,
        }
    }
}

impl Friction {
    /// Whether there is none.
    #[must_use]
    pub fn is_zero(&self) -> bool {
        *self == Self::default()
    }
}
