//! What an estimator says of each joint: coefficients, how well they are known, what they stand on, and what is missing.

use super::law::{FrictionLaw, Term};
use super::options::FrictionSide;
use crate::robot::spec::Friction;

/// What an estimator knows.
#[derive(Debug, Clone, PartialEq)]
pub struct EstimateReport {
    /// One entry a joint.
    pub joints: Vec<JointEstimate>,
    /// Samples that were taken in, used or not.
    pub sample_count: u64,
    /// Samples left out of the whole arm, by reason.
    pub skipped: SkippedSamples,
    /// Time of the last sample taken, s; `None`: there was none.
    pub time: Option<f64>,
    /// How far behind the last sample the estimate is because of the filter, s: every signal is delayed by as much.
    pub delay: f64,
}

/// Samples that were left out of the whole arm.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct SkippedSamples {
    /// A position, velocity or acceleration, or the time, was no number.
    pub not_finite: u64,
    /// A position, velocity or acceleration was beyond what any arm does.
    pub out_of_range: u64,
    /// The time was not after that of the sample before. After a second of such samples in order the clock is taken to have been set.
    pub time_went_backwards: u64,
    /// Gaps: the sample came so late, or its clock was set back, that filters had to start anew. It was taken in.
    pub gaps: u64,
}

/// Samples of one joint that did not count, of those that the arm took in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct SkippedOfJoint {
    /// The joint was at rest: friction is not determined.
    pub at_rest: u64,
    /// It had just set out or turned back: filters still remember the friction of the other direction.
    pub reversing: u64,
    /// Filters had just started.
    pub settling: u64,
    /// A torque or current was no number.
    pub not_finite: u64,
    /// A torque was beyond what any drive gives.
    pub out_of_range: u64,
    /// The torque did not fit by far (Kalman filter).
    pub outlier: u64,
}

/// What is known of one joint's friction, seen from the joint.
#[derive(Debug, Clone, PartialEq)]
pub struct JointEstimate {
    /// Which friction it is, as chosen; in any case seen from the joint.
    pub side: FrictionSide,
    /// Its terms, as chosen.
    pub law: FrictionLaw,
    /// One entry a term of the law.
    pub coefficients: Vec<Coefficient>,
    /// Covariance of the coefficients: its lower triangle row by row.
    pub covariance: Vec<f64>,
    /// Quadratic friction at which the model's was held, where the law has no such term; 0 where it has.
    pub held_quadratic: f64,
    /// The joint's speed limit, rad/s or m/s: within it friction must not fall with speed.
    pub speed_limit: Option<f64>,
    /// How many independent pieces of evidence the covariance stands on: its intervals are Student's. `None`: there are too few to
    /// say, or the method does not ask; intervals are normal, with the noise and the correlation time that the options assume.
    pub degrees_of_freedom: Option<f64>,
    /// Root mean square of what the estimate left of recent torques, N m or N.
    pub residual_rms: f64,
    /// Standard deviation of it without outliers.
    pub residual_deviation: f64,
    /// Time over which it stays alike, s, as measured; `None`: not yet.
    pub correlation_time: Option<f64>,
    /// Degrees of freedom of the Student distribution with its tails: large where it is normal.
    pub residual_tails: f64,
    /// Torque of friction in the last sample that was used: the observer's, or what the sample itself says. N m or N.
    pub friction_torque: Option<f64>,
    /// Samples used.
    pub used_count: u64,
    /// Samples that counted less, because the torque did not fit.
    pub discounted_count: u64,
    /// Samples not used, by reason.
    pub skipped: SkippedOfJoint,
    /// What the motion did not say; empty: it said enough of every term.
    pub missing: Vec<MissingExcitation>,
}

/// One coefficient of a friction law.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coefficient {
    /// Of which term.
    pub term: Term,
    /// Its value.
    pub value: f64,
    /// What the model has of it. Of one Coulomb torque for both directions: the mean of the model's two.
    pub known: f64,
    /// Standard error.
    pub deviation: f64,
    /// Lower end of the 95 % interval.
    pub lower: f64,
    /// Upper end of the 95 % interval.
    pub upper: f64,
    /// Whether the samples told it: its standard error is below half of what it was beforehand.
    pub told: bool,
}

/// What a motion would have to have for an estimate to be had.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MissingExcitation {
    /// Hardly any samples outside the dead band.
    Motion {
        /// Seconds of motion that count, forgetting included.
        seconds: f64,
        /// How many it takes.
        needed: f64,
    },
    /// Too few samples in the positive direction, of a term that needs them.
    PositiveDirection {
        /// Seconds of motion that count.
        seconds: f64,
        /// How many it takes.
        needed: f64,
    },
    /// Too few samples in the negative direction.
    NegativeDirection {
        /// Seconds of motion that count.
        seconds: f64,
        /// How many it takes.
        needed: f64,
    },
    /// Speeds too alike to separate terms that grow with speed from those that do not.
    SpeedsAlike {
        /// Mean of the speed's magnitude, rad/s or m/s.
        mean: f64,
        /// Its standard deviation.
        deviation: f64,
        /// What it should be at least.
        needed: f64,
    },
    /// Gravity torques too alike to separate the load's friction from the constant one.
    LoadsAlike {
        /// Mean of the gravity torque's magnitude, N m or N.
        mean: f64,
        /// Its standard deviation.
        deviation: f64,
        /// What it should be at least.
        needed: f64,
    },
    /// The samples hardly know more of a term than was known before.
    Untold {
        /// Which.
        term: Term,
        /// Standard error.
        deviation: f64,
        /// What it was beforehand.
        before: f64,
    },
}

/// An estimate as the friction of a model.
#[derive(Debug, Clone, PartialEq)]
pub struct CommittedFriction {
    /// Seen from the joint.
    pub friction: Friction,
    /// What was changed so that it is physical.
    pub warnings: Vec<String>,
}
