//! Drives and bodies fitted to a recording.

mod bench;

use std::{sync::Arc, time::Instant};

use takt_motion::{
    Invalid,
    budget::Budget,
    drive::fit::{
        assess::assess,
        motion::fit_motion,
        recording::{Recording, Selection},
        report::{Assessment, MotionFit, MotionOutcome, Scope},
    },
    drive::log_hints::LogHints,
    plan,
    robot::Robot,
};
use takt_proto::{
    convert::{
        self,
        fit::{MotionFitRequest, Part},
    },
    v1::{self, fit_drive_request::Fit, fit_drive_response::Outcome},
};
use tracing::Span;

use super::{Reading, Subject, decode, failed, finite, not_finite, propose::Proposal};
use crate::{error::ServiceError, registry::Compiled};

/// Fits a model; `description` is the stored one of its revision, where there still is one.
pub(crate) fn fit_drive(
    mut request: v1::FitDriveRequest,
    subject: Subject,
    description: Option<&[u8]>,
    deadline: Instant,
    budget: &Budget<'_>,
) -> Result<v1::FitDriveResponse, ServiceError> {
    let mut reading = Reading::of(&mut request, subject);
    let wire = match &request.fit {
        Some(Fit::Motion(wire)) => wire,
        Some(other) => return bench::fit_joint(other, reading, description),
        None => {
            let message = "must be given, or `stiffness`, `damping` or `constant_speed`";
            reading.findings.push_invalid(Invalid::new("motion", message));
            return Err(ServiceError::invalid(reading.findings.into_list()));
        }
    };
    let read = reading.convert(|spec, findings| convert::fit::motion_fit_request(wire, spec, findings));
    let (robot, provenance) = reading.checked()?;
    let read = read.ok_or_else(|| ServiceError::internal("the request was let through without a recording"))?;
    let loaded = match &read.payload {
        Some(payload) => robot.robot.with_payload(payload),
        None => robot.robot.clone(),
    };
    // what looks wrong with a log may be why there is no fit
    let hints_of = |recording: &Recording| {
        let hints = LogHints::of_recording(&loaded, recording, budget);
        hints.map_err(|stopped| failed(stopped.into(), deadline))
    };
    let mut hints = vec![("recording", hints_of(&read.recording)?)];
    if let Some(other) = &read.test_recording {
        hints.push(("test_recording", hints_of(other)?));
    }
    let in_words = |part: Part| {
        let (spec, hints) = (robot.robot.spec(), &hints);
        move |failure: plan::Failure| match failure {
            plan::Failure::Invalid(list) => {
                let list = list.into_iter();
                let list = list.map(|found| convert::fit::finding_on_recording(found, wire, spec, part));
                let hints = hints.iter().flat_map(|(field, hints)| {
                    let at = move |hint: &String| Invalid::new(format!("motion.{field}"), hint.clone());
                    hints.iter().map(at)
                });
                ServiceError::invalid(list.chain(hints).collect())
            }
            stopped @ plan::Failure::Stopped => failed(stopped, deadline),
        }
    };
    let hints = said_of_logs(&hints, &read);
    let test = |robot: &Robot| -> Result<Option<Assessment>, ServiceError> {
        let compare = |selection: &Selection| assess(robot, read.compared(), selection, budget);
        read.test
            .as_ref()
            .map(compare)
            .transpose()
            .map_err(in_words(Part::Test))
    };
    let before = test(&loaded)?;
    let outcome = fit_motion(&loaded, &read.recording, &read.options, budget).map_err(in_words(Part::Identify))?;
    let spec = robot.robot.spec();
    let (outcome, proposal) = match outcome {
        MotionOutcome::NotExcited(missing) => {
            Span::current().record("outcome", "not excited");
            let mut answer = convert::fit::missing_to_wire(&missing, spec);
            answer.warnings.clone_from(&hints);
            (Outcome::NotExcited(answer), None)
        }
        MotionOutcome::Fitted(fit) => {
            Span::current().record("outcome", "fit");
            let fitted = Robot::new(fit.spec.clone(), Vec::new()).map_err(|list| unusable(&list))?;
            let mut answer = convert::fit::fit_to_wire(&fit, spec);
            // what is wrong with the log comes before what is odd in its fit
            answer.warnings.splice(0..0, hints.iter().cloned());
            let to_wire = |assessment: Option<Assessment>| {
                assessment.map(|assessment| convert::fit::assessment_to_wire(&assessment, spec))
            };
            let parts = [
                (Part::Identify, &read.recording, Some(&read.options.selection)),
                (Part::Test, read.compared(), read.test.as_ref()),
            ];
            for (part, recording, selection) in parts {
                let Some(selection) = selection else { continue };
                let name = part.range_field();
                answer.warnings.extend(recording.shortfall(selection, name));
                answer.warnings.extend(recording.standstill(selection, name));
            }
            answer.before = to_wire(before);
            answer.after = to_wire(test(&fitted)?);
            if !finite::fit(&answer) {
                return Err(not_finite());
            }
            let description = description.map(decode).transpose()?;
            let proposal = description.and_then(|description| propose(&robot, description, &fit, &read));
            (Outcome::Motion(answer), proposal)
        }
    };
    Ok(v1::FitDriveResponse {
        outcome: Some(outcome),
        proposal,
        provenance: Some(provenance),
    })
}

/// What is odd about the recordings, a sentence each.
fn said_of_logs(hints: &[(&str, Vec<String>)], read: &MotionFitRequest) -> Vec<String> {
    let sentence = |field: &str, hint: &String| match field {
        "recording" => hint.clone(),
        _ => format!("{field}: {hint}"),
    };
    let mut said: Vec<String> = hints
        .iter()
        .flat_map(|(field, hints)| hints.iter().map(|hint| sentence(field, hint)))
        .collect();
    if !read.compared().has_the_effort_of(&read.recording) {
        said.push(
            "test_recording: one recording has torques and the other motor currents, so what differs between sensors and currents is \
             in the comparison too"
                .to_owned(),
        );
    }
    said
}

/// A fit keeps to what a robot can be.
fn unusable(list: &[Invalid]) -> ServiceError {
    let first = list.first().map(ToString::to_string).unwrap_or_default();
    ServiceError::internal(format!("the fit made a robot that cannot be: {first}"))
}

fn propose(
    robot: &Arc<Compiled>,
    description: v1::RobotDescription,
    fit: &MotionFit,
    read: &MotionFitRequest,
) -> Option<v1::ModelProposal> {
    let mut proposal = Proposal::new(description, robot);
    for (joint, fitted) in fit.spec.joints.iter().enumerate() {
        proposal.change_drive(joint, |drive| drive.clone_from(&fitted.drive));
        proposal.change_body(joint, fitted);
    }
    if read.options.scope == Scope::Payload {
        proposal.change_payload(&fit.spec.payload);
    }
    proposal.know_all(fit.spec.uncertainty.as_ref());
    let range = read.options.selection.range.map_or_else(
        || "the whole recording".to_owned(),
        |(begin, end)| format!("{begin} to {end} s of a recording"),
    );
    let note = format!(
        "{:?}, {range}, {} samples, below {} Hz",
        read.options.scope, fit.sample_count, read.options.selection.band
    );
    proposal.finish("FitDrive", note)
}
