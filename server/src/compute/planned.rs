//! Moves and programs from the request to the plan, the same way: read, planned, sampled for the motors, and not yet written.

use std::{sync::Arc, time::Instant};

use takt_motion::{
    budget::Budget,
    confidence::{self, Confidence, Confident},
    drive::reference::Reference,
    path::{self, outcome::PathOutcome, request::PathRequest},
    plan::{
        self, Failure,
        outcome::{MoveOutcome, Setpoints},
        request::MoveRequest,
    },
    robot::{
        Robot,
        spec::{Inertial, RobotSpec},
    },
};
use takt_proto::{
    convert::{self, Findings},
    v1,
};
use tracing::Span;

use super::{
    OfRevision, Reading, Subject, check_setpoints, check_trace, failed, finite,
    motor::{self, Motors},
    not_finite,
};
use crate::{config::Limits, error::ServiceError, registry::Compiled};

/// A plan before it is written.
pub(super) struct Planned<O> {
    pub(super) robot: Arc<Compiled>,
    pub(super) outcome: Confident<O>,
    /// Where asked for.
    pub(super) motors: Option<Motors>,
    pub(super) provenance: v1::Provenance,
}

/// A request to plan, as it came.
pub(super) trait Plannable: OfRevision + Sized {
    /// The request in the planner's words.
    type Request;
    /// What the planner answers.
    type Outcome;

    /// What the service looks at itself.
    fn asked(&self) -> Asked;
    fn read(self, spec: Option<&RobotSpec>, findings: &mut Findings) -> Self::Request;
    fn plan(robot: &Robot, request: &Self::Request, budget: &Budget<'_>) -> Result<Self::Outcome, Failure>;
    fn plan_confident(
        robot: &Robot,
        request: &Self::Request,
        confidence: Confidence,
        budget: &Budget<'_>,
    ) -> Result<Confident<Self::Outcome>, Failure>;
    fn is_plan(outcome: &Self::Outcome) -> bool;
    /// The set-points of a plan, where it has any.
    fn setpoints(outcome: &Self::Outcome) -> Option<&Setpoints>;
    fn is_finite(outcome: &Self::Outcome) -> bool;
    /// The motion of a plan at its set-points; `None` where it is infeasible.
    fn reference(request: &Self::Request, outcome: &Self::Outcome, period: f64) -> Option<Result<Reference, Failure>>;
    fn payload(request: &Self::Request) -> Option<&Inertial>;
}

/// What requests to plan have in common.
#[derive(Debug, Clone)]
pub(super) struct Asked {
    trace_points: Option<u32>,
    sample_period: Option<f64>,
    motors: Option<bool>,
    confidence: Option<v1::Confidence>,
}

/// Reads a request and plans.
pub(super) fn planned<R: Plannable>(
    mut request: R,
    subject: Subject,
    limits: &Limits,
    deadline: Instant,
    budget: &Budget<'_>,
) -> Result<Planned<R::Outcome>, ServiceError> {
    let mut reading = Reading::of(&mut request, subject);
    let asked = request.asked();
    check_trace(&mut reading.findings, asked.trace_points, limits);
    let wants_motors = motor::is_asked(asked.motors, asked.sample_period, &mut reading.findings);
    let confidence =
        reading.convert(|spec, findings| convert::confidence::read(asked.confidence.as_ref(), spec, findings));
    let request = reading.convert(|spec, findings| request.read(spec, findings));
    reading.look_further(|robot, budget| R::plan(robot, &request, budget));
    let (robot, provenance) = reading.checked()?;
    let outcome = match confidence {
        Some(confidence) => R::plan_confident(&robot.robot, &request, confidence, budget),
        None => R::plan(&robot.robot, &request, budget).map(Confident::without),
    };
    let outcome = outcome.map_err(|failure| failed(failure, deadline))?;
    check_setpoints(R::setpoints(&outcome.outcome), limits)?;
    if !(R::is_finite(&outcome.outcome) && finite::confidence(&outcome)) {
        return Err(not_finite());
    }
    let name = match R::is_plan(&outcome.outcome) {
        true => "plan",
        false => "infeasible",
    };
    Span::current().record("outcome", name);
    let period = asked.sample_period.filter(|_| wants_motors);
    let reference = period.and_then(|period| R::reference(&request, &outcome.outcome, period));
    let motors = reference.map(|reference| {
        let reference = reference.map_err(|failure| failed(failure, deadline))?;
        motor::motors(&robot.robot, R::payload(&request), &reference, deadline, budget)
    });
    let motors = motors.transpose()?;
    let count = R::setpoints(&outcome.outcome).map(|setpoints| setpoints.time.len());
    if let Some(Ok(forward)) = &motors
        && Some(forward.exact.len()) != count
    {
        return Err(ServiceError::internal(
            "motors and joints have not the same number of set-points",
        ));
    }
    Ok(Planned {
        robot,
        outcome,
        motors,
        provenance,
    })
}

impl Plannable for v1::PlanMoveRequest {
    type Request = MoveRequest;
    type Outcome = MoveOutcome;

    fn asked(&self) -> Asked {
        Asked {
            trace_points: self.trace_points,
            sample_period: self.sample_period_s,
            motors: self.motor_setpoints,
            confidence: self.confidence,
        }
    }

    fn read(self, spec: Option<&RobotSpec>, findings: &mut Findings) -> MoveRequest {
        convert::plan::move_request(self, spec, findings)
    }

    fn plan(robot: &Robot, request: &MoveRequest, budget: &Budget<'_>) -> Result<MoveOutcome, Failure> {
        plan::plan_move(robot, request, budget)
    }

    fn plan_confident(
        robot: &Robot,
        request: &MoveRequest,
        confidence: Confidence,
        budget: &Budget<'_>,
    ) -> Result<Confident<MoveOutcome>, Failure> {
        confidence::plan_move(robot, request, confidence, budget)
    }

    fn is_plan(outcome: &MoveOutcome) -> bool {
        matches!(outcome, MoveOutcome::Plan(_))
    }

    fn setpoints(outcome: &MoveOutcome) -> Option<&Setpoints> {
        match outcome {
            MoveOutcome::Plan(plan) => plan.setpoints.as_ref(),
            MoveOutcome::Infeasible(_) => None,
        }
    }

    fn is_finite(outcome: &MoveOutcome) -> bool {
        finite::outcome(outcome)
    }

    fn reference(request: &MoveRequest, outcome: &MoveOutcome, period: f64) -> Option<Result<Reference, Failure>> {
        match outcome {
            MoveOutcome::Plan(plan) => Some(Reference::of_planned_move(request, plan, period)),
            MoveOutcome::Infeasible(_) => None,
        }
    }

    fn payload(request: &MoveRequest) -> Option<&Inertial> {
        request.payload.as_ref()
    }
}

impl Plannable for v1::PlanPathRequest {
    type Request = PathRequest;
    type Outcome = PathOutcome;

    fn asked(&self) -> Asked {
        Asked {
            trace_points: self.trace_points,
            sample_period: self.sample_period_s,
            motors: self.motor_setpoints,
            confidence: self.confidence,
        }
    }

    fn read(self, spec: Option<&RobotSpec>, findings: &mut Findings) -> PathRequest {
        convert::path::path_request(self, spec, findings)
    }

    fn plan(robot: &Robot, request: &PathRequest, budget: &Budget<'_>) -> Result<PathOutcome, Failure> {
        path::plan_path(robot, request, budget)
    }

    fn plan_confident(
        robot: &Robot,
        request: &PathRequest,
        confidence: Confidence,
        budget: &Budget<'_>,
    ) -> Result<Confident<PathOutcome>, Failure> {
        confidence::plan_path(robot, request, confidence, budget)
    }

    fn is_plan(outcome: &PathOutcome) -> bool {
        matches!(outcome, PathOutcome::Plan(_))
    }

    fn setpoints(outcome: &PathOutcome) -> Option<&Setpoints> {
        match outcome {
            PathOutcome::Plan(plan) => plan.setpoints.as_ref().map(|setpoints| &setpoints.samples),
            PathOutcome::Infeasible(_) => None,
        }
    }

    fn is_finite(outcome: &PathOutcome) -> bool {
        finite::path(outcome)
    }

    fn reference(request: &PathRequest, outcome: &PathOutcome, period: f64) -> Option<Result<Reference, Failure>> {
        match outcome {
            PathOutcome::Plan(plan) => Some(Reference::of_planned_path(request, plan, period)),
            PathOutcome::Infeasible(_) => None,
        }
    }

    fn payload(request: &PathRequest) -> Option<&Inertial> {
        request.payload.as_ref()
    }
}
