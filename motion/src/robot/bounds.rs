//! What a number in a description may be, and how much of everything one description may hold.
//!
//! The numeric bounds are far outside anything that is built. They keep products and squares of what is read finite,
//! and they catch the wrong unit: a mass in grams passes, a length in micrometres does not.

/// The values that a quantity may have.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Bound {
    min: f64,
    max: f64,
    unit: &'static str,
}

/// Distances between frames and centres of mass, either way.
pub(crate) const LENGTH: Bound = symmetric(1e5, " m");
/// Angles between frames.
pub(crate) const ANGLE: Bound = symmetric(1e5, " rad");
/// Joint positions: a hundred kilometres of travel, or 15,915 turns.
pub(crate) const POSITION: Bound = symmetric(1e5, "");
/// The heaviest thing that an arm was ever asked to carry is 2.3 t; a thousand tonnes is a unit error.
pub(crate) const MASS: Bound = between(0.0, 1e6, " kg");
/// Entries of an inertia tensor: the largest mass at 30 m.
pub(crate) const INERTIA: Bound = symmetric(1e9, " kg m²");
/// Speed limits. A limit of 0 would be a joint that cannot move; below 1e-9 times and their squares leave the range.
pub(crate) const VELOCITY: Bound = between(1e-9, 1e6, "");
/// Acceleration limits.
pub(crate) const ACCELERATION: Bound = between(1e-9, 1e9, "");
/// Jerk limits.
pub(crate) const JERK: Bound = between(1e-9, 1e12, "");
/// Torque limits at the joint.
pub(crate) const TORQUE: Bound = between(1e-9, 1e9, "");
/// Magnitude of a gear ratio: a ball screw of 1 mm pitch has 6283 rad/m.
pub(crate) const GEAR_RATIO: Bound = between(1e-6, 1e6, "");
/// Rotor inertia on the motor side; times the largest gear ratio squared it stays finite.
pub(crate) const ROTOR_INERTIA: Bound = between(0.0, 1e6, " kg m²");
/// Friction coefficients.
pub(crate) const FRICTION: Bound = between(0.0, 1e9, "");
/// Friction over speed squared. Lubricated gears resist less and less per speed: it may be below 0, as far as `merge` allows.
pub(crate) const QUADRATIC_FRICTION: Bound = symmetric(1e9, "");
/// Coulomb torque over gravity torque: gears have 0.05, and from 1 on a load does not sink by itself; a hundred is a unit error.
pub(crate) const LOAD_COULOMB: Bound = between(0.0, 100.0, "");
/// Torque over deflection before a contact slides.
pub(crate) const PRESLIDING_STIFFNESS: Bound = between(1e-9, 1e15, "");
/// Motor torque over current.
pub(crate) const TORQUE_CONSTANT: Bound = between(1e-9, 1e6, " N m/A");
/// Coefficients of the stiffness polynomial; a higher one may be negative.
pub(crate) const STIFFNESS: Bound = symmetric(1e15, "");
/// Damping of the transmission.
pub(crate) const DAMPING: Bound = between(0.0, 1e9, "");
/// Length of the gravity vector: zero is a robot in orbit, a thousand is a hundred times the earth's.
pub(crate) const GRAVITY: Bound = between(0.0, 1000.0, " m/s²");
/// Standard deviation of what is left between model and measurement: that of a torque.
pub(crate) const RESIDUAL_DEVIATION: Bound = between(0.0, 1e9, "");
/// Time over which that stays alike: from the fastest current loop to eleven days.
pub(crate) const RESIDUAL_TIME: Bound = between(1e-6, 1e6, " s");
/// Degrees of freedom of its distribution: at 2 the variance is infinite, from a thousand on it is normal to four digits.
pub(crate) const DEGREES_OF_FREEDOM: Bound = between(2.001, 1e9, "");
/// Entries of a covariance: squares of masses, first moments, inertias and frictions within their own bounds.
pub(crate) const COVARIANCE: Bound = symmetric(1e18, "");
/// Multiplier and offset of a mimic joint.
pub(crate) const MIMIC: Bound = symmetric(1e5, "");

/// Moving joints of a chain: four times the longest arm on the market.
pub(crate) const MAX_JOINTS: usize = super::JOINTS_MAX;
/// Bytes of a URDF. The largest published humanoid is under 1 MiB.
pub(crate) const MAX_URDF_BYTES: usize = 4 << 20;
/// XML nodes of a URDF: what its text can unfold to in memory.
pub(crate) const MAX_XML_NODES: u32 = 400_000;
/// Nesting of XML elements. A URDF needs five, simulator plug-ins a dozen.
pub(crate) const MAX_XML_DEPTH: usize = 64;
/// Attributes of one element: the parser compares each with all before it.
pub(crate) const MAX_XML_ATTRIBUTES: usize = 64;
/// Namespace declarations of a document: the parser copies those in force to each element that adds one.
pub(crate) const MAX_XML_NAMESPACES: usize = 256;
/// Links, and as many joints.
pub(crate) const MAX_LINKS: usize = 10_000;
/// Bytes of the name of a link, joint or frame.
pub(crate) const MAX_NAME_BYTES: usize = 256;
/// Entries in `joints`: more than there can be joints is a mistake, but each is named in the answer.
pub(crate) const MAX_JOINT_ENTRIES: usize = 1000;
/// Named frames.
pub(crate) const MAX_FRAMES: usize = 1000;
/// Terms of a stiffness polynomial.
pub(crate) const MAX_STIFFNESS_TERMS: usize = 8;
/// Errors, and warnings, that one answer lists before it only counts them.
pub(crate) const MAX_FINDINGS: usize = 100;
/// Names that one message lists.
pub(crate) const MAX_LISTED_NAMES: usize = 8;
/// Mass of the moving links above which a warning asks whether the unit is right: the heaviest arms move 6 t, files
/// with one density for every mesh reach 5 t for a small one.
pub(crate) const ODD_TOTAL_MASS: f64 = 2000.0;

/// How far, relative to the trace, an inertia tensor may be outside what a rigid body can have before it is called
/// odd: published tensors are rounded to four digits and more.
pub(crate) const INERTIA_ROUNDING: f64 = 1e-6;
/// How far below 0, against a diagonal of ones, the smallest eigenvalue of a covariance may be: what a fit leaves open
/// has the eigenvalue 0, and rounding to nine digits takes it to either side.
pub(crate) const COVARIANCE_ROUNDING: f64 = 1e-8;
/// How far the norm of a pose's quaternion may be from 1.
pub(crate) const QUATERNION_ROUNDING: f64 = 1e-6;
/// The shortest axis of a joint whose direction is trusted. Real files hold 1 and roundings of it.
pub(crate) const MIN_AXIS: f64 = 1e-6;

const fn symmetric(max: f64, unit: &'static str) -> Bound {
    Bound { min: -max, max, unit }
}

const fn between(min: f64, max: f64, unit: &'static str) -> Bound {
    Bound { min, max, unit }
}

impl Bound {
    /// The largest value.
    pub(crate) fn max(&self) -> f64 {
        self.max
    }

    /// What is wrong with `value`, if anything is.
    pub(crate) fn fault(&self, value: f64) -> Option<String> {
        let unit = self.unit;
        if !value.is_finite() {
            return Some(format!("{value} must be a finite number"));
        }
        if value < self.min {
            return Some(format!("{value:?}{unit} must be at least {:?}{unit}", self.min));
        }
        if value > self.max {
            return Some(format!("{value:?}{unit} must be at most {:?}{unit}", self.max));
        }
        None
    }
}
