//! Answers with the confidence that was asked for, or as they are where none was.

use takt_motion::{
    Invalid,
    budget::Budget,
    confidence::{self, Confidence, Confident},
    path::{self, outcome::PathOutcome, request::PathRequest},
    plan::{
        self, Failure,
        outcome::{CheckReport, MoveOutcome},
        request::{CheckRequest, MoveRequest},
    },
    robot::Robot,
};
use takt_proto::convert::Findings;

pub(super) fn plan_move(
    robot: &Robot,
    request: &MoveRequest,
    confidence: Option<Confidence>,
    budget: &Budget<'_>,
) -> Result<Confident<MoveOutcome>, Failure> {
    match confidence {
        Some(confidence) => confidence::plan_move(robot, request, confidence, budget),
        None => plan::plan_move(robot, request, budget).map(as_it_is),
    }
}

pub(super) fn plan_path(
    robot: &Robot,
    request: &PathRequest,
    confidence: Option<Confidence>,
    budget: &Budget<'_>,
) -> Result<Confident<PathOutcome>, Failure> {
    match confidence {
        Some(confidence) => confidence::plan_path(robot, request, confidence, budget),
        None => path::plan_path(robot, request, budget).map(as_it_is),
    }
}

pub(super) fn check_trajectory(
    robot: &Robot,
    request: &CheckRequest,
    confidence: Option<Confidence>,
    budget: &Budget<'_>,
) -> Result<Confident<CheckReport>, Failure> {
    match confidence {
        Some(confidence) => confidence::check_trajectory(robot, request, confidence, budget),
        None => plan::check_trajectory(robot, request, budget).map(as_it_is),
    }
}

/// Set-points of the motors follow the plan that the model alone makes.
pub(super) fn check_motors(wants_motors: bool, confidence: Option<Confidence>, findings: &mut Findings) {
    if wants_motors && confidence.is_some() {
        let message = "cannot stand beside `confidence`: motors have set-points of plans that take the model as exact";
        findings.push_invalid(Invalid::new("motor_setpoints", message));
    }
}

fn as_it_is<O>(outcome: O) -> Confident<O> {
    Confident {
        outcome,
        report: None,
        band: None,
    }
}
