//! What the residual depends on: a body that is wrong leaves torque that goes with the pose, a friction law that is wrong leaves
//! torque that goes with the speed.
//!
//! The share of a residual's square that its means over [`POSE_BINS`] ranges of a joint's position explain is compared with what
//! they explain of the same residual shifted in time against the positions, all the way round in [`POSE_SHIFTS`] steps: residual and
//! motion stay as smooth as they are, only what binds them is lost (H. Theiler et al., "Testing for nonlinearity in time series: the
//! method of surrogate data", 1992). A residual that the true order explains better than every other depends on the pose.

use super::excitation::name;
use super::linear::dot;
use super::report::{Bin, Estimate, MotionFit};
use super::signals::Signals;
use super::unknowns::Unknowns;
use crate::budget::{Budget, Stopped};
use crate::dynamics::regressor::BODY;
use crate::robot::Robot;
use crate::tolerance::{
    POSE_BINS, POSE_SHARE_MIN, POSE_SHIFTS, UNEXPLAINED_ERROR, UNSEEN_ERROR_RATIO, WRONG_BODY_RATIO,
};

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
pub(crate) fn dependence(signals: &Signals, residuals: &[f64], budget: &Budget<'_>) -> Result<Dependence, Stopped> {
    let none = Dependence { share: 0.0, joint: 0 };
    let whole = dot(residuals, residuals);
    if whole.is_nan() || whole <= 0.0 || residuals.len() < POSE_BINS * POSE_SHIFTS {
        return Ok(none);
    }
    // which range each sample is in, for every joint
    let mut ranges = Vec::with_capacity(signals.q.len());
    for q in &signals.q {
        budget.check()?;
        ranges.push(ranks(signals.of(q)));
    }
    let most = |shift: usize| -> (f64, usize) {
        let shares = ranges.iter().map(|range| explained(range, residuals, shift) / whole);
        let best =
            |best: (f64, usize), (joint, share): (usize, f64)| if share > best.0 { (share, joint) } else { best };
        shares.enumerate().fold((0.0, 0), best)
    };
    let (share, joint) = most(0);
    let (mut by_chance, mut mean) = (0.0_f64, 0.0);
    for k in 1..POSE_SHIFTS {
        budget.check()?;
        let (share, _) = most(residuals.len() * k / POSE_SHIFTS);
        by_chance = by_chance.max(share);
        mean += share / (POSE_SHIFTS - 1) as f64;
    }
    if share <= by_chance || share - mean < POSE_SHARE_MIN {
        return Ok(none);
    }
    Ok(Dependence {
        share: share - mean,
        joint,
    })
}

/// Which of [`POSE_BINS`] ranges with equal numbers of samples each value is in.
fn ranks(values: &[f64]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
    let mut ranks = vec![0; values.len()];
    for (place, sample) in order.into_iter().enumerate() {
        ranks[sample] = place * POSE_BINS / values.len();
    }
    ranks
}

/// Sum of squares that the means over ranges explain of residuals shifted in time.
fn explained(ranges: &[usize], residuals: &[f64], shift: usize) -> f64 {
    let (mut sums, mut counts) = ([0.0; POSE_BINS], [0.0; POSE_BINS]);
    let shifted = residuals[shift..].iter().chain(&residuals[..shift]);
    for (range, residual) in ranges.iter().zip(shifted) {
        sums[*range] += residual;
        counts[*range] += 1.0;
    }
    let squares = sums
        .iter()
        .zip(counts)
        .map(|(sum, count): (&f64, f64)| sum * sum / count.max(1.0));
    squares.sum()
}

/// What is odd about a fit, a sentence each.
pub(crate) fn warnings(robot: &Robot, unknowns: &Unknowns, fit: &MotionFit) -> Vec<String> {
    let (estimates, joints) = (&fit.estimates, &fit.joints);
    let mut warnings = Vec::new();
    let name_of = |joint: usize| robot.spec().joints[joint].name.as_str();
    for (j, joint) in joints.iter().enumerate() {
        if joint.validated_error > UNEXPLAINED_ERROR {
            warnings.push(format!(
                "joint \"{}\": {:.0} % of its torque is left on what was left out of the fit, which is hardly a model of it: units, directions \
                 and the order of joints may not be those of the description, or it carried what nobody said",
                name_of(j),
                100.0 * joint.validated_error
            ));
        }
    }
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
        if let Some(free) = joint.error_with_free_bodies
            && joint.validated_error > WRONG_BODY_RATIO * free
        {
            warnings.push(format!(
                "joint \"{}\": {:.1} % of its torque is left, and {:.1} % if the bodies were free, so the described ones are not right, \
                 and what was fitted takes on part of that",
                name_of(j),
                100.0 * joint.validated_error,
                100.0 * free
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
    let (level, zero): (Vec<&Estimate>, Vec<&Estimate>) = estimates
        .iter()
        .filter(|estimate| estimate.held)
        .partition(|estimate| estimate.value < 0.0);
    for (held, what) in [
        (zero, "would have come out below 0, and held there"),
        (
            level,
            "friction would fall with speed below the speed limit, and is held level there",
        ),
    ] {
        let names: Vec<String> = held.iter().map(|estimate| name(robot, estimate.unknown)).collect();
        if !names.is_empty() {
            warnings.push(format!("{what}: {}", names.join(", ")));
        }
    }
    warnings
}
