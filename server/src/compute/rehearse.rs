//! A motion on a simulated arm.

use std::time::Instant;

use takt_motion::{
    Invalid,
    budget::Budget,
    drive::rehearse::{self, outcome::RehearsalOutcome},
    plan,
};
use takt_proto::{convert, v1};
use tracing::Span;

use super::{Reading, Subject, failed, finite, not_finite};
use crate::{config::Limits, error::ServiceError, limits::at_most};

/// Rehearses a motion.
pub(crate) fn rehearse(
    mut request: v1::RehearseRequest,
    subject: Subject,
    limits: &Limits,
    deadline: Instant,
    budget: &Budget<'_>,
) -> Result<v1::RehearseResponse, ServiceError> {
    let mut reading = Reading::of(&mut request, subject);
    let wire = request.clone();
    let read = reading.convert(|spec, findings| convert::rehearse::rehearsal_request(request, spec, findings));
    let (robot, provenance) = reading.checked()?;
    let read = read.ok_or_else(|| ServiceError::internal("the request was let through without a motion"))?;
    let outcome = rehearse::rehearse(&robot.robot, &read, budget).map_err(|failure| match failure {
        plan::Failure::Invalid(list) => {
            let list = list.into_iter();
            let list = list.map(|found| convert::rehearse::finding_on_request(found, &wire, robot.robot.spec()));
            let mut list: Vec<Invalid> = list.collect();
            // An entry for all joints is wrong for each of them.
            list.dedup();
            ServiceError::invalid(list)
        }
        stopped @ plan::Failure::Stopped => failed(stopped, deadline),
    })?;
    check_trace(&outcome, limits)?;
    let outcome = convert::rehearse::outcome_to_wire(outcome, robot.robot.spec());
    if !finite::rehearsal(&outcome) {
        return Err(not_finite());
    }
    Span::current().record("outcome", name(&outcome));
    Ok(v1::RehearseResponse {
        outcome: Some(outcome),
        provenance: Some(provenance),
    })
}

fn name(outcome: &v1::rehearse_response::Outcome) -> &'static str {
    use v1::rehearse_response::Outcome;
    match outcome {
        Outcome::Rehearsal(_) => "rehearsal",
        Outcome::MoveInfeasible(_) | Outcome::PathInfeasible(_) => "infeasible",
        Outcome::TransmissionRange(_) => "transmission range",
    }
}

/// How many points a step makes is known when the motion is.
fn check_trace(outcome: &RehearsalOutcome, limits: &Limits) -> Result<(), ServiceError> {
    let RehearsalOutcome::Run(rehearsal) = outcome else {
        return Ok(());
    };
    let trace = rehearsal.plain.trace.as_ref();
    let count = trace.map_or(0, |trace| trace.time.len());
    let found: Option<Invalid> = at_most("trace_every", count, limits.max_trace_points, "max_trace_points");
    match found {
        Some(invalid) => Err(ServiceError::invalid(vec![invalid])),
        None => Ok(()),
    }
}
