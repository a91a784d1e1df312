//! What a caller chooses of an estimator, and the one place where it is checked.

use crate::error::Invalid;
use crate::tolerance::{
    ESTIMATE_BANDWIDTH_MAX, ESTIMATE_BANDWIDTH_MIN, ESTIMATE_DEVIATION_MAX, ESTIMATE_DEVIATION_MIN, ESTIMATE_LAMBDA_MIN,
};

use super::law::FrictionLaw;

/// How friction is estimated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EstimatorMethod {
    /// Recursive least squares with forgetting (eq 15 to 20), on the balance of torques.
    LeastSquares,
    /// The observer of fig. 11 gives the friction torque; least squares with forgetting find the coefficients in it. Needs no
    /// acceleration of the motor, but its rotor inertia.
    Observer,
    /// A Kalman filter whose coefficients wander at random.
    Kalman,
}

/// Which friction is estimated; always as seen from the joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FrictionSide {
    /// All of it: Fq + FΘ. What torque margins need; the least that drives must report gives it.
    Total,
    /// On the output side of the gear: Fq (eq 10).
    Joint,
    /// On the motor's side: FΘ (eq 12).
    Motor,
}

/// How long the estimator remembers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Memory {
    /// For ever: the friction is a constant. λ = 1.
    Forever,
    /// λ: what a sample counts for is multiplied by it at every further sample that is used.
    Factor(f64),
    /// Seconds of motion after which a sample counts half, whatever the sample time.
    HalfLife(f64),
}

/// What is known of one joint's coefficients beforehand, in the order of [`FrictionLaw::terms`].
#[derive(Debug, Clone, PartialEq)]
pub struct Prior {
    /// The coefficients.
    pub mean: Vec<f64>,
    /// Their covariance: its lower triangle row by row.
    pub covariance: Vec<f64>,
}

/// What a caller chooses.
#[derive(Debug, Clone, PartialEq)]
pub struct EstimatorOptions {
    /// How.
    pub method: EstimatorMethod,
    /// Which friction.
    pub side: FrictionSide,
    /// Its terms.
    pub law: FrictionLaw,
    /// How long it remembers; the Kalman filter has `drift` instead.
    pub memory: Memory,
    /// Joint speed, rad/s or m/s, up to which a joint counts as at rest: its friction is then not determined.
    pub dead_band: f64,
    /// Corner frequency, Hz, of the low pass that all signals go through, so that positions can be differentiated. `None`:
    /// no filter; position, velocity and acceleration are all given.
    pub bandwidth: Option<f64>,
    /// Time between two samples, s, from which on something is missing: filters start anew.
    pub gap: f64,
    /// Time over which residuals stay alike, s: as much of motion has about one sample's information. Weighs samples
    /// against the prior; stated intervals have the correlation that was measured, once there is enough of it.
    pub correlation_time: f64,
    /// Residuals beyond so many standard deviations count with no more than that (Huber); the Kalman filter takes none of
    /// them. `None`: all count in full.
    pub outlier_threshold: Option<f64>,
    /// Rate L of the observer, 1/s.
    pub observer_rate: f64,
    /// How far friction at full speed wanders in an hour, standard deviation over the joint's peak torque: the Kalman
    /// filter's process noise.
    pub drift: f64,
    /// Standard deviation of the residual that is expected, N m or N, one a joint; empty: a hundredth of the peak torque.
    pub noise: Vec<f64>,
    /// What is known beforehand, one a joint; empty, or `None`: the model's friction, hardly trusted.
    pub priors: Vec<Option<Prior>>,
}

impl Default for EstimatorOptions {
    fn default() -> Self {
        Self {
            method: EstimatorMethod::LeastSquares,
            side: FrictionSide::Total,
            law: FrictionLaw::default(),
            memory: Memory::HalfLife(60.0),
            dead_band: 0.02,
            bandwidth: Some(10.0),
            gap: 0.1,
            correlation_time: 0.2,
            outlier_threshold: Some(4.0),
            observer_rate: 20.0,
            drift: 0.02,
            noise: Vec::new(),
            priors: Vec::new(),
        }
    }
}

impl EstimatorOptions {
    /// Everything that is wrong with the options, for an arm of so many joints.
    pub(super) fn findings(&self, joint_count: usize) -> Vec<Invalid> {
        let mut findings = Vec::new();
        match self.memory {
            Memory::Factor(lambda) if !(ESTIMATE_LAMBDA_MIN..=1.0).contains(&lambda) => {
                let message = format!("{lambda} must be between {ESTIMATE_LAMBDA_MIN} and 1");
                findings.push(Invalid::new("memory.factor", message));
            }
            Memory::HalfLife(seconds) => positive(&mut findings, "memory.half_life", seconds),
            Memory::Forever | Memory::Factor(_) => {}
        }
        for (path, value) in [
            ("dead_band", self.dead_band),
            ("gap", self.gap),
            ("correlation_time", self.correlation_time),
            ("observer_rate", self.observer_rate),
            ("drift", self.drift),
        ] {
            positive(&mut findings, path, value);
        }
        if let Some(threshold) = self.outlier_threshold
            && !(1.0..=ESTIMATE_DEVIATION_MAX).contains(&threshold)
        {
            let message = format!("{threshold} standard deviations must be between 1 and {ESTIMATE_DEVIATION_MAX:e}");
            findings.push(Invalid::new("outlier_threshold", message));
        }
        if let Some(bandwidth) = self.bandwidth
            && !(ESTIMATE_BANDWIDTH_MIN..=ESTIMATE_BANDWIDTH_MAX).contains(&bandwidth)
        {
            let message =
                format!("{bandwidth} Hz must be between {ESTIMATE_BANDWIDTH_MIN} and {ESTIMATE_BANDWIDTH_MAX} Hz");
            findings.push(Invalid::new("bandwidth", message));
        }
        one_a_joint(&mut findings, "noise", self.noise.len(), joint_count);
        one_a_joint(&mut findings, "priors", self.priors.len(), joint_count);
        for (joint, &noise) in self.noise.iter().enumerate() {
            positive(&mut findings, &format!("noise[{joint}]"), noise);
        }
        for (joint, prior) in self.priors.iter().enumerate() {
            if let Some(prior) = prior {
                prior.check(self.law, &format!("priors[{joint}]"), &mut findings);
            }
        }
        findings
    }
}

impl Prior {
    fn check(&self, law: FrictionLaw, path: &str, findings: &mut Vec<Invalid>) {
        let count = law.count();
        for (name, values, wanted) in [
            ("mean", &self.mean, count),
            ("covariance", &self.covariance, count * (count + 1) / 2),
        ] {
            if values.len() != wanted {
                let message = format!("{} values, a law of {count} terms has {wanted}", values.len());
                findings.push(Invalid::new(format!("{path}.{name}"), message));
            } else if !values.iter().all(|value| value.abs() <= ESTIMATE_DEVIATION_MAX) {
                let message = format!("every value must be within ±{ESTIMATE_DEVIATION_MAX:e}");
                findings.push(Invalid::new(format!("{path}.{name}"), message));
            }
        }
        if self.covariance.len() != count * (count + 1) / 2 {
            return;
        }
        if !super::model::is_covariance(count, &self.covariance) {
            let message = "must be positive definite; a coefficient that is known exactly has a small variance, not 0";
            findings.push(Invalid::new(format!("{path}.covariance"), message));
        }
    }
}

fn one_a_joint(findings: &mut Vec<Invalid>, path: &str, count: usize, joint_count: usize) {
    if count != 0 && count != joint_count {
        let message = format!("{count} entries, the arm has {joint_count} joints");
        findings.push(Invalid::new(path, message));
    }
}

fn positive(findings: &mut Vec<Invalid>, path: &str, value: f64) {
    if !(ESTIMATE_DEVIATION_MIN..=ESTIMATE_DEVIATION_MAX).contains(&value) {
        let message = format!("{value} must be between {ESTIMATE_DEVIATION_MIN:e} and {ESTIMATE_DEVIATION_MAX:e}");
        findings.push(Invalid::new(path, message));
    }
}
