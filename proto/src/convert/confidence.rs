//! Confidences in, what they cost out.

use takt_motion::{
    confidence::{Confidence, ConfidenceReport, Confident, Over},
    path::outcome::PathOutcome,
    plan::outcome::{CheckReport, MoveOutcome},
    robot::spec::RobotSpec,
};

use super::{Findings, Path, path, plan};
use crate::v1;

const OVERS: &str = "SAMPLE, MOVE";

/// Reads the confidence of a request. The robot, where it is known, says whether it can be had.
pub fn read(wire: Option<&v1::Confidence>, robot: Option<&RobotSpec>, findings: &mut Findings) -> Option<Confidence> {
    let wire = wire?;
    let at = Path::Root.field("confidence");
    if robot.is_some_and(|robot| robot.uncertainty.is_none()) {
        let message = "the model does not say how well its parameters are known: fit its drives to recorded motion, and register \
                       it with the `uncertainty` that the fit gives";
        findings.push(at, message);
    }
    let level = findings.finite(at.field("level"), wire.level);
    if wire.level.is_finite() && !(level > 0.5 && level < 1.0) {
        findings.push(at.field("level"), format!("{level} must be above 0.5 and below 1"));
    }
    let over = wire
        .over
        .and_then(|number| findings.enumerated(at.field("over"), number, OVERS));
    Some(Confidence {
        level,
        over: match over {
            Some(v1::confidence::Over::Move) => Over::Move,
            Some(v1::confidence::Over::Sample | v1::confidence::Over::Unspecified) | None => Over::Sample,
        },
    })
}

/// Writes the answer to a move.
#[must_use]
pub fn move_to_wire(answer: Confident<MoveOutcome>, robot: &RobotSpec) -> v1::plan_move_response::Outcome {
    use v1::plan_move_response::Outcome;
    let mut wire = plan::outcome_to_wire(answer.outcome, robot);
    match &mut wire {
        Outcome::Plan(plan) => plan.confidence = answer.report.map(|report| report_to_wire(&report, robot)),
        Outcome::Infeasible(refusal) => refusal.band = answer.band,
    }
    wire
}

/// Writes the answer to a program.
#[must_use]
pub fn path_to_wire(answer: Confident<PathOutcome>, robot: &RobotSpec) -> v1::plan_path_response::Outcome {
    use v1::plan_path_response::Outcome;
    let mut wire = path::outcome_to_wire(answer.outcome, robot);
    match &mut wire {
        Outcome::Plan(plan) => plan.confidence = answer.report.map(|report| report_to_wire(&report, robot)),
        Outcome::Infeasible(refusal) => refusal.band = answer.band,
    }
    wire
}

/// Writes the report on a trajectory.
#[must_use]
pub fn check_to_wire(answer: Confident<CheckReport>, robot: &RobotSpec) -> v1::CheckTrajectoryResponse {
    let report = answer.report.map(|report| report_to_wire(&report, robot));
    v1::CheckTrajectoryResponse {
        confidence: report,
        ..plan::report_to_wire(answer.outcome, robot)
    }
}

fn report_to_wire(report: &ConfidenceReport, robot: &RobotSpec) -> v1::ConfidenceReport {
    let over = match report.confidence.over {
        Over::Sample => v1::confidence::Over::Sample,
        Over::Move => v1::confidence::Over::Move,
    };
    let joints = report.joints.iter().map(|joint| v1::JointConfidence {
        joint: plan::name(robot, joint.joint),
        limit: joint.limit,
        torque: joint.torque,
        band: joint.band,
        margin: joint.margin,
        time_s: joint.time,
        parameter_deviation: joint.parameter_deviation,
        residual_deviation: joint.residual_deviation,
        set_aside: joint.set_aside,
    });
    v1::ConfidenceReport {
        confidence: Some(v1::Confidence {
            level: report.confidence.level,
            over: Some(over.into()),
        }),
        holds: report.holds,
        nominal_duration_s: report.nominal_duration,
        joints: joints.collect(),
    }
}
