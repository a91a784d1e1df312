//! Robot programs.

use std::time::Instant;

use takt_motion::{
    budget::Budget,
    confidence::Confident,
    drive::rehearse::request::Motion,
    path::{self, outcome::PathOutcome},
};
use takt_proto::{convert, v1};
use tracing::Span;

use super::{Planned, Reading, Subject, check_setpoints, check_trace, confident, failed, finite, motor, not_finite};
use crate::{config::Limits, error::ServiceError};

/// Plans a robot program.
pub(crate) fn plan_path(
    request: v1::PlanPathRequest,
    subject: Subject,
    limits: &Limits,
    deadline: Instant,
    budget: &Budget<'_>,
) -> Result<v1::PlanPathResponse, ServiceError> {
    let planned = planned_path(request, subject, limits, deadline, budget)?;
    let spec = planned.robot.robot.spec();
    let mut outcome = convert::confidence::path_to_wire(planned.outcome, spec);
    if let (v1::plan_path_response::Outcome::Plan(plan), Some(motors)) = (&mut outcome, &planned.motors) {
        motor::add(motors, &mut plan.setpoints, &mut plan.warnings, spec)?;
    }
    Ok(v1::PlanPathResponse {
        outcome: Some(outcome),
        provenance: Some(planned.provenance),
    })
}

pub(super) fn planned_path(
    mut request: v1::PlanPathRequest,
    subject: Subject,
    limits: &Limits,
    deadline: Instant,
    budget: &Budget<'_>,
) -> Result<Planned<Confident<PathOutcome>>, ServiceError> {
    let mut reading = Reading::of(&mut request, subject);
    check_trace(&mut reading.findings, request.trace_points, limits);
    let period = request.sample_period_s;
    let wants_motors = motor::is_asked(request.motor_setpoints, period, &mut reading.findings);
    let asked = request.confidence;
    let confidence = reading.convert(|spec, findings| convert::confidence::read(asked.as_ref(), spec, findings));
    confident::check_motors(wants_motors, confidence, &mut reading.findings);
    let request = reading.convert(|spec, findings| convert::path::path_request(request, spec, findings));
    reading.look_further(|robot, budget| path::plan_path(robot, &request, budget));
    let (robot, provenance) = reading.checked()?;
    let outcome = confident::plan_path(&robot.robot, &request, confidence, budget);
    let outcome = outcome.map_err(|failure| failed(failure, deadline))?;
    let (name, setpoints) = match &outcome.outcome {
        PathOutcome::Plan(plan) => ("plan", plan.setpoints.as_ref().map(|setpoints| &setpoints.samples)),
        PathOutcome::Infeasible(_) => ("infeasible", None),
    };
    check_setpoints(setpoints, limits)?;
    if !(finite::path(&outcome.outcome) && finite::confidence(&outcome)) {
        return Err(not_finite());
    }
    Span::current().record("outcome", name);
    let motors = match (&outcome.outcome, period.filter(|_| wants_motors)) {
        (PathOutcome::Plan(_), Some(period)) => {
            let motion = Motion::Path(Box::new(request));
            Some(motor::motors(&robot.robot, &motion, period, deadline, budget)?)
        }
        _ => None,
    };
    Ok(Planned {
        robot,
        outcome,
        motors,
        provenance,
    })
}
