//! What the residual depends on: a body that is wrong leaves torque that goes with the pose, a friction law that is wrong leaves
//! torque that goes with the speed.
//!
//! The share of a residual's variance that its means over [`POSE_BINS`] ranges of a joint's position explain would, by chance, be
//! distributed as Beta((B − 1)/2, (N − B)/2) with N independent samples; what is beyond its mean by more than three standard deviations of it
//! is said.

use super::excitation::name;
use super::linear::dot;
use super::report::{Bin, Estimate, JointFit};
use super::signals::Signals;
use super::unknowns::Unknowns;
use crate::dynamics::regressor::BODY;
use crate::robot::Robot;
use crate::tolerance::{POSE_BINS, POSE_CHANCE_DEVIATIONS, UNSEEN_ERROR_RATIO};

/// What of a residual goes with one joint's position.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Dependence {
    /// Share of the variance beyond chance, 0 where it may be chance.
    pub(crate) share: f64,
    /// Which joint's position.
    pub(crate) joint: usize,
}

/// Residuals by equal numbers of samples in order of a value.
pub(crate) fn bins(values: &[f64], residuals: &[f64]) -> Vec<Bin> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
    let border = |k: usize| order.len() * k / POSE_BINS;
    let bin = |k: usize| {
        let members = &order[border(k)..border(k + 1)];
        let (first, last) = (members.first()?, members.last()?);
        let count = members.len() as f64;
        let sum: f64 = members.iter().map(|i| residuals[*i]).sum();
        let square: f64 = members.iter().map(|i| residuals[*i] * residuals[*i]).sum();
        Some(Bin {
            from: values[*first],
            to: values[*last],
            mean: sum / count,
            rms: (square / count).sqrt(),
        })
    };
    (0..POSE_BINS).filter_map(bin).collect()
}

/// The joint whose position says most of a residual.
pub(crate) fn dependence(signals: &Signals, residuals: &[f64], correlation_time: f64) -> Dependence {
    let duration = residuals.len() as f64 * signals.period;
    let independent = duration / correlation_time.max(signals.period);
    let bins_count = POSE_BINS as f64;
    let mut most = Dependence { share: 0.0, joint: 0 };
    let whole = dot(residuals, residuals) / residuals.len().max(1) as f64;
    if independent <= bins_count + 1.0 || !(whole > 0.0) {
        return most;
    }
    let chance = (bins_count - 1.0) / (independent - 1.0);
    let spread = (2.0 * chance * (1.0 - chance) / (independent + 1.0)).sqrt();
    for (joint, q) in signals.q.iter().enumerate() {
        let means = bins(signals.of(q), residuals);
        let explained = means.iter().map(|bin| bin.mean * bin.mean).sum::<f64>() / (bins_count * whole);
        if explained > chance + POSE_CHANCE_DEVIATIONS * spread && explained - chance > most.share {
            most = Dependence {
                share: explained - chance,
                joint,
            };
        }
    }
    most
}

/// What is odd about a fit, a sentence each.
pub(crate) fn warnings(robot: &Robot, unknowns: &Unknowns, estimates: &[Estimate], joints: &[JointFit]) -> Vec<String> {
    let mut warnings = Vec::new();
    let name_of = |joint: usize| robot.spec().joints[joint].name.as_str();
    for (j, joint) in joints.iter().enumerate() {
        if joint.pose_share > 0.0 {
            warnings.push(format!(
                "joint \"{}\": {:.0} % of what is left of its torque goes with the position of joint \"{}\", so the bodies are not \
                 right, and friction is less known than its deviation says",
                name_of(j),
                100.0 * joint.pose_share,
                name_of(joint.pose_joint)
            ));
        }
        if joint.validated_error > UNSEEN_ERROR_RATIO * joint.fitted_error {
            warnings.push(format!(
                "joint \"{}\": an error of {:.1} % on what was left out of the fit against {:.1} % within it, so the motion is too \
                 short or too plain for what is asked",
                name_of(j),
                100.0 * joint.validated_error,
                100.0 * joint.fitted_error
            ));
        }
    }
    for start in &unknowns.bodies {
        let changed = (0..BODY).any(|k| {
            let (used, said) = (unknowns.described[start + k], estimates[start + k].described);
            used != said
        });
        if changed && estimates[*start].described > 0.0 {
            let subject = name(robot, estimates[*start].unknown);
            let body = subject.trim_start_matches("mass of ");
            warnings.push(format!(
                "the body of {body} is described as none that can be; the nearest that can stands in its place"
            ));
        }
    }
    for estimate in estimates.iter().filter(|estimate| estimate.held) {
        warnings.push(format!(
            "{} would have come out below 0 and is held there",
            name(robot, estimate.unknown)
        ));
    }
    warnings
}
