//! Writes what a fit found.

use takt_motion::{
    drive::fit::report::{Assessment, Bin, Estimate, IntervalAssessment, JointFit, Missing, MotionFit, Unknown},
    robot::spec::RobotSpec,
};

use crate::{
    convert::{count_to_wire, plan::name, robot::kind_to_wire},
    v1::{self, fit_parameter::Parameter},
};

/// Writes a fit; what it was compared with is the caller's.
#[must_use]
pub fn fit_to_wire(fit: &MotionFit, robot: &RobotSpec) -> v1::MotionFit {
    let joints = fit.joints.iter().enumerate();
    v1::MotionFit {
        estimates: fit.estimates.iter().map(|one| estimate(one, robot)).collect(),
        joints: joints.map(|(joint, one)| joint_fit(one, joint, robot)).collect(),
        ridge: fit.ridge,
        determined: fit.determined,
        sample_count: count_to_wire(fit.sample_count),
        fold_count: count_to_wire(fit.fold_count),
        warnings: fit.warnings.clone(),
        before: None,
        after: None,
    }
}

/// Writes what a motion does not say; warnings are the caller's.
#[must_use]
pub fn missing_to_wire(missing: &[Missing], robot: &RobotSpec) -> v1::NotExcited {
    let missing = missing.iter().map(|one| v1::MissingInMotion {
        parameters: one
            .parameters
            .iter()
            .map(|unknown| parameter(*unknown, robot))
            .collect(),
        message: one.message.clone(),
    });
    v1::NotExcited {
        missing: missing.collect(),
        warnings: Vec::new(),
    }
}

fn parameter(unknown: Unknown, robot: &RobotSpec) -> v1::FitParameter {
    let parameter = match unknown {
        Unknown::Joint(parameter) => Parameter::Joint(v1::FittedParameter {
            joint: name(robot, parameter.joint),
            kind: kind_to_wire(parameter.kind).into(),
        }),
        // Numbered in the same order, from 1.
        Unknown::Payload(index) => Parameter::Payload(i32::try_from(index + 1).unwrap_or(0)),
    };
    v1::FitParameter {
        parameter: Some(parameter),
    }
}

fn estimate(estimate: &Estimate, robot: &RobotSpec) -> v1::ParameterEstimate {
    v1::ParameterEstimate {
        parameter: Some(parameter(estimate.unknown, robot)),
        value: estimate.value,
        described: estimate.described,
        standard_error: estimate.deviation,
        told: estimate.told,
        held: estimate.held,
    }
}

fn joint_fit(fit: &JointFit, joint: usize, robot: &RobotSpec) -> v1::JointFit {
    v1::JointFit {
        joint: name(robot, joint),
        fitted_error: fit.fitted_error,
        validated_error: fit.validated_error,
        presliding_deflection: fit.presliding_deflection,
        correlation_time_s: fit.correlation_time,
        pose_share: fit.pose_share,
        pose_joint: name(robot, fit.pose_joint),
        by_position: bins(&fit.by_position),
        by_speed: bins(&fit.by_speed),
    }
}

fn bins(bins: &[Bin]) -> Vec<v1::ResidualBin> {
    let bins = bins.iter().map(|bin| v1::ResidualBin {
        from: bin.from,
        to: bin.to,
        mean: bin.mean,
        rms: bin.rms,
    });
    bins.collect()
}

/// Writes how well a model says the torque of a motion.
#[must_use]
pub fn assessment_to_wire(assessment: &Assessment, robot: &RobotSpec) -> v1::Assessment {
    let joints = assessment
        .joints
        .iter()
        .enumerate()
        .map(|(joint, one)| v1::JointAssessment {
            joint: name(robot, joint),
            error: one.error,
            percentile: one.percentile,
            percentile_of_peak: one.percentile_of_peak,
            interval: one.interval.map(interval),
            online: one.online.map(interval),
        });
    v1::Assessment {
        joints: joints.collect(),
        sample_count: count_to_wire(assessment.sample_count),
        online_horizon_s: assessment.online_horizon,
    }
}

fn interval(interval: IntervalAssessment) -> v1::IntervalAssessment {
    v1::IntervalAssessment {
        coverage: interval.coverage,
        half_width: interval.half_width,
        over_narrowest: interval.over_narrowest,
    }
}
