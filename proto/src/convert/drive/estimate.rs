//! Choices of an estimator in, estimates out.

use takt_motion::{
    Invalid,
    drive::estimate::{
        EstimateReport, EstimatorMethod, EstimatorOptions, EstimatorState, FrictionLaw, FrictionSide, JointEstimate,
        Memory, MissingExcitation, Prior, SkippedOfJoint, SkippedSamples, Term,
    },
    drive::friction_change::{FrictionChange, FrictionTerm},
    robot::spec::RobotSpec,
};

use crate::{
    convert::{Findings, Path, quoted},
    v1::{
        self,
        estimate_header::{Method, Side},
        friction_coefficient::Term as WireTerm,
    },
};

const METHODS: &str = "LEAST_SQUARES, OBSERVER, KALMAN";
const SIDES: &str = "TOTAL, JOINT, MOTOR";

/// Reads the choices; bounds are checked where the estimator is made, see [`finding_on_header`].
pub fn options(
    wire: &v1::EstimateHeader,
    at: Path<'_>,
    robot: Option<&RobotSpec>,
    findings: &mut Findings,
) -> EstimatorOptions {
    let default = EstimatorOptions::default();
    let method = wire
        .method
        .and_then(|method| findings.enumerated(at.field("method"), method, METHODS));
    let side = wire
        .side
        .and_then(|side| findings.enumerated(at.field("side"), side, SIDES));
    let terms = wire.terms.unwrap_or_default();
    let mut number = |name: &'static str, value: Option<f64>, default: f64| {
        findings.finite_option(at.field(name), value).unwrap_or(default)
    };
    let half_life = number("half_life_s", wire.half_life_s, 0.0);
    let forgetting = number("forgetting", wire.forgetting, 1.0);
    let dead_band = number("dead_band", wire.dead_band, default.dead_band);
    let bandwidth = number("bandwidth_hz", wire.bandwidth_hz, default.bandwidth.unwrap_or(0.0));
    let gap = number("gap_s", wire.gap_s, default.gap);
    let outlier = number(
        "outlier_threshold",
        wire.outlier_threshold,
        default.outlier_threshold.unwrap_or(0.0),
    );
    let observer_rate = number("observer_rate_per_s", wire.observer_rate_per_s, default.observer_rate);
    let drift = number("drift", wire.drift, default.drift);
    if wire.half_life_s.is_some() && wire.forgetting.is_some() {
        findings.push(at.field("forgetting"), "must not be given together with `half_life_s`");
    }
    let memory = match (wire.half_life_s, wire.forgetting) {
        (None, None) => default.memory,
        (Some(_), _) => Memory::HalfLife(half_life),
        // One is what it says: for ever.
        (None, Some(1.0)) => Memory::Forever,
        (None, Some(_)) => Memory::Factor(forgetting),
    };
    if wire.state.is_some() && !wire.prior.is_empty() {
        findings.push(
            at.field("prior"),
            "must not be given together with `state`, which has what is known",
        );
    }
    EstimatorOptions {
        method: match method {
            Some(Method::Observer) => EstimatorMethod::Observer,
            Some(Method::Kalman) => EstimatorMethod::Kalman,
            Some(Method::LeastSquares | Method::Unspecified) | None => EstimatorMethod::LeastSquares,
        },
        side: match side {
            Some(Side::Joint) => FrictionSide::Joint,
            Some(Side::Motor) => FrictionSide::Motor,
            Some(Side::Total | Side::Unspecified) | None => FrictionSide::Total,
        },
        law: FrictionLaw {
            by_direction: terms.by_direction.unwrap_or(false),
            load: terms.load.unwrap_or(false),
            quadratic: terms.quadratic.unwrap_or(false),
        },
        memory,
        dead_band,
        bandwidth: (bandwidth != 0.0).then_some(bandwidth),
        gap,
        outlier_threshold: (outlier != 0.0).then_some(outlier),
        observer_rate,
        drift,
        priors: priors(&wire.prior, at.field("prior"), robot, findings),
        ..default
    }
}

/// One entry a joint, or none at all.
fn priors(
    wire: &[v1::FrictionPrior],
    at: Path<'_>,
    robot: Option<&RobotSpec>,
    findings: &mut Findings,
) -> Vec<Option<Prior>> {
    let (Some(robot), false) = (robot, wire.is_empty()) else {
        return Vec::new();
    };
    let mut priors = vec![None; robot.joints.len()];
    for (index, entry) in wire.iter().enumerate() {
        let at = at.index(index);
        findings.finite_list(at.field("mean"), &entry.mean);
        findings.finite_list(at.field("covariance"), &entry.covariance);
        let Some(joint) = robot.joints.iter().position(|joint| joint.name == entry.joint) else {
            let message = format!("the robot has no joint {}", quoted(&entry.joint));
            findings.push(at.field("joint"), message);
            continue;
        };
        let prior = Prior {
            mean: entry.mean.clone(),
            covariance: entry.covariance.clone(),
        };
        if priors[joint].replace(prior).is_some() {
            let message = format!("a second entry of {}", quoted(&entry.joint));
            findings.push(at.field("joint"), message);
        }
    }
    priors
}

/// What an estimator finds wrong with its options, in the words of the header.
#[must_use]
pub fn finding_on_header(found: Invalid, wire: &v1::EstimateHeader, robot: &RobotSpec) -> Invalid {
    const NAMES: [(&str, &str); 6] = [
        ("memory.factor", "forgetting"),
        ("memory.half_life", "half_life_s"),
        ("bandwidth", "bandwidth_hz"),
        ("gap", "gap_s"),
        ("observer_rate", "observer_rate_per_s"),
        ("priors", "prior"),
    ];
    let Invalid { path, message } = found;
    if let Some((joint, rest)) = path.strip_prefix("priors[").and_then(|rest| rest.split_once(']')) {
        // The list of priors is by joint, that of the header as the caller wrote it.
        let name = joint.parse().ok().and_then(|joint: usize| robot.joints.get(joint));
        let place = name.and_then(|joint| wire.prior.iter().position(|entry| entry.joint == joint.name));
        return Invalid::new(format!("prior[{}]{rest}", place.unwrap_or(0)), message);
    }
    let name = NAMES.iter().find(|(domain, _)| *domain == path);
    Invalid::new(name.map_or(path.as_str(), |(_, wire)| wire), message)
}

/// What an estimator finds wrong with a block, in the words of the telemetry.
#[must_use]
pub fn finding_on_telemetry(found: Invalid) -> Invalid {
    let Invalid { path, message } = found;
    let path = match path.as_str() {
        "" => "telemetry",
        "time" => "telemetry.time_s",
        // A column is what all joints have or none.
        _ => "telemetry.joints",
    };
    Invalid::new(path, message)
}

/// Reads what to go on from; whether it is a state of the estimator, the estimator says.
#[must_use]
pub fn state(wire: &v1::FrictionState) -> EstimatorState {
    EstimatorState {
        version: wire.version,
        reals: wire.reals.clone(),
        counts: wire.counts.clone(),
    }
}

/// Writes what to go on from.
#[must_use]
pub fn state_to_wire(state: EstimatorState) -> v1::FrictionState {
    v1::FrictionState {
        version: state.version,
        reals: state.reals,
        counts: state.counts,
    }
}

/// Writes an estimate; `last`, state, proposal and provenance are the caller's.
#[must_use]
pub fn estimate_to_wire(report: &EstimateReport, robot: &RobotSpec) -> v1::EstimateFrictionResponse {
    let joints = report.joints.iter().zip(&robot.joints);
    v1::EstimateFrictionResponse {
        joints: joints
            .map(|(estimate, joint)| of_joint(estimate, &joint.name))
            .collect(),
        sample_count: report.sample_count,
        skipped: Some(skipped(report.skipped)),
        time_s: report.time,
        delay_s: report.delay,
        ..Default::default()
    }
}

fn of_joint(estimate: &JointEstimate, joint: &str) -> v1::FrictionEstimate {
    let committed = estimate.committed();
    let committed = |index: usize| committed.as_ref().and_then(|values| values.get(index).copied());
    let coefficients = estimate.coefficients.iter().enumerate();
    let coefficients = coefficients.map(|(index, one)| v1::FrictionCoefficient {
        term: term(one.term).into(),
        value: one.value,
        standard_error: one.deviation,
        lower: one.lower,
        upper: one.upper,
        told: one.told,
        model: one.known,
        committed: committed(index),
    });
    v1::FrictionEstimate {
        joint: joint.to_owned(),
        coefficients: coefficients.collect(),
        covariance: estimate.covariance.clone(),
        residual_rms: estimate.residual_rms,
        residual_deviation: estimate.residual_deviation,
        correlation_time_s: estimate.correlation_time,
        friction_torque: estimate.friction_torque,
        used_count: estimate.used_count,
        discounted_count: estimate.discounted_count,
        skipped: Some(of_joint_skipped(estimate.skipped)),
        missing: estimate.missing.iter().map(missing).collect(),
        degrees_of_freedom: estimate.degrees_of_freedom,
        residual_tails: estimate.residual_tails,
    }
}

/// Writes what becomes of a joint's friction.
#[must_use]
pub fn friction_change_to_wire(change: FrictionChange, joint: &str) -> v1::FrictionChange {
    use v1::friction_change::Term;
    let term = match change.term {
        FrictionTerm::CoulombPositive => Term::CoulombPositive,
        FrictionTerm::CoulombNegative => Term::CoulombNegative,
        FrictionTerm::Viscous => Term::Viscous,
        FrictionTerm::LoadCoulomb => Term::LoadCoulomb,
        FrictionTerm::Quadratic => Term::Quadratic,
        FrictionTerm::PreslidingStiffness => Term::PreslidingStiffness,
    };
    v1::FrictionChange {
        joint: joint.to_owned(),
        term: term.into(),
        before: change.before,
        after: change.after,
    }
}

fn skipped(skipped: SkippedSamples) -> v1::SkippedSamples {
    v1::SkippedSamples {
        not_finite: skipped.not_finite,
        out_of_range: skipped.out_of_range,
        time_went_backwards: skipped.time_went_backwards,
        gaps: skipped.gaps,
    }
}

fn of_joint_skipped(skipped: SkippedOfJoint) -> v1::SkippedOfJoint {
    v1::SkippedOfJoint {
        at_rest: skipped.at_rest,
        reversing: skipped.reversing,
        settling: skipped.settling,
        not_finite: skipped.not_finite,
        out_of_range: skipped.out_of_range,
        outlier: skipped.outlier,
    }
}

fn term(term: Term) -> WireTerm {
    match term {
        Term::Coulomb => WireTerm::Coulomb,
        Term::CoulombPositive => WireTerm::CoulombPositive,
        Term::CoulombNegative => WireTerm::CoulombNegative,
        Term::Viscous => WireTerm::Viscous,
        Term::LoadCoulomb => WireTerm::LoadCoulomb,
        Term::Quadratic => WireTerm::Quadratic,
    }
}

/// What a motion would have to have, as a sentence.
fn missing(missing: &MissingExcitation) -> String {
    match missing {
        MissingExcitation::Motion { seconds, needed } => {
            format!("moved for {seconds:.3} s that count, it takes {needed:.3} s")
        }
        MissingExcitation::PositiveDirection { seconds, needed } => {
            format!("moved in the positive direction for {seconds:.3} s that count, it takes {needed:.3} s")
        }
        MissingExcitation::NegativeDirection { seconds, needed } => {
            format!("moved in the negative direction for {seconds:.3} s that count, it takes {needed:.3} s")
        }
        MissingExcitation::SpeedsAlike {
            mean,
            deviation,
            needed,
        } => format!(
            "speeds are too alike to tell viscous from Coulomb friction: {mean:.3} with a standard deviation of \
             {deviation:.3}, it takes {needed:.3}"
        ),
        MissingExcitation::LoadsAlike {
            mean,
            deviation,
            needed,
        } => format!(
            "gravity torques are too alike to tell the load's friction: {mean:.3} with a standard deviation of \
             {deviation:.3}, it takes {needed:.3}"
        ),
        MissingExcitation::Untold {
            term,
            deviation,
            before,
        } => format!(
            "the samples hardly tell {}: standard error {deviation:.3e}, beforehand {before:.3e}",
            name(*term)
        ),
    }
}

fn name(term: Term) -> &'static str {
    match term {
        Term::Coulomb => "the Coulomb torque",
        Term::CoulombPositive => "the Coulomb torque in the positive direction",
        Term::CoulombNegative => "the Coulomb torque in the negative direction",
        Term::Viscous => "viscous friction",
        Term::LoadCoulomb => "the load's friction",
        Term::Quadratic => "quadratic friction",
    }
}
