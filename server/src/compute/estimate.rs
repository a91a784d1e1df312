//! Friction from telemetry: the estimator of one stream, and its answers.

use std::sync::Arc;

use takt_motion::{
    Invalid,
    budget::Budget,
    drive::{
        estimate::{FrictionEstimator, UpdateError},
        log_hints::LogHints,
    },
};
use takt_proto::{
    convert::{self, Findings, Path},
    v1,
};

use super::{
    Reading, Subject, decode, finite, not_finite,
    propose::{Known, Proposal},
};
use crate::{
    config::Limits,
    error::ServiceError,
    limits::at_most,
    registry::{Compiled, store::Revision},
};

/// Time between two answers where the caller does not say, s.
const REPORT_PERIOD_S: f64 = 0.1;

/// Shortest time between two answers: a controller's cycle.
const SHORTEST_PERIOD_S: f64 = 1e-3;

/// Longest: a day. Whoever wants none but the last one says so.
const LONGEST_PERIOD_S: f64 = 86_400.0;

/// The estimator of one stream.
#[derive(Debug)]
pub(crate) struct Estimating {
    robot: Arc<Compiled>,
    estimator: FrictionEstimator,
    hints: LogHints,
    provenance: v1::Provenance,
    period: f64,
    /// Time of the telemetry from which on the next answer is due; `None` before the first sample.
    due: Option<f64>,
    is_first: bool,
    max_samples: usize,
}

impl Estimating {
    /// The estimator that a header asks for.
    pub(crate) fn begin(
        mut header: v1::EstimateHeader,
        subject: Subject,
        limits: &Limits,
    ) -> Result<Self, ServiceError> {
        let mut reading = Reading::of(&mut header, subject);
        let at = Path::Root;
        let (options, payload, period) = reading.convert(|spec, findings| {
            let payload = header.payload.as_ref();
            let payload = payload.map(|payload| convert::robot::payload(payload, at.field("payload"), findings));
            let period = header.report_period_s.unwrap_or(REPORT_PERIOD_S);
            let range = SHORTEST_PERIOD_S..=LONGEST_PERIOD_S;
            (
                convert::drive::options(&header, at, spec, findings),
                payload,
                findings.within(at.field("report_period_s"), period, range, " s"),
            )
        });
        let begun = || {
            let (robot, provenance) = reading.checked()?;
            let loaded = match &payload {
                Some(payload) => robot.robot.with_payload(payload),
                None => robot.robot.clone(),
            };
            let found = |list: Vec<Invalid>| {
                let list = list.into_iter();
                let list = list.map(|found| convert::drive::finding_on_header(found, &header, robot.robot.spec()));
                ServiceError::invalid(list.collect())
            };
            let hints = LogHints::new(loaded.clone());
            let estimator = match &header.state {
                None => FrictionEstimator::new(loaded, options).map_err(found)?,
                Some(state) => {
                    FrictionEstimator::resume(loaded, options, &convert::drive::state(state)).map_err(found)?
                }
            };
            Ok(Self {
                robot,
                estimator,
                hints,
                provenance,
                period,
                due: None,
                is_first: true,
                max_samples: limits.max_telemetry_samples,
            })
        };
        begun().map_err(|error: ServiceError| error.below("header"))
    }

    pub(crate) fn revision(&self) -> Revision {
        Arc::clone(&self.robot.revision)
    }

    /// Takes in a block of telemetry; an answer, where one is due. What is wrong with a block leaves everything as it was.
    pub(crate) fn take(
        &mut self,
        block: &v1::Telemetry,
        budget: &Budget<'_>,
    ) -> Result<Option<v1::EstimateFrictionResponse>, ServiceError> {
        const SAMPLES: &str = "telemetry.time_s";
        let count = block.time_s.len();
        if let Some(invalid) = at_most(SAMPLES, count, self.max_samples, "max_telemetry_samples") {
            return Err(ServiceError::invalid(vec![invalid]));
        }
        let mut findings = Findings::default();
        let spec = self.robot.robot.spec();
        let read = convert::drive::telemetry(block, Path::Root.field("telemetry"), spec, &mut findings);
        let read = findings.finish(read).map_err(ServiceError::invalid)?;
        self.estimator.update(&read, budget).map_err(|error| match error {
            UpdateError::Invalid(list) => {
                let list = list.into_iter().map(convert::drive::finding_on_telemetry);
                ServiceError::invalid(list.collect())
            }
            UpdateError::Stopped => ServiceError::deadline(),
        })?;
        self.hints.add_telemetry(&read);
        let last = read.time.iter().rev().find(|time| time.is_finite());
        match last {
            Some(last) if self.is_due(*last) => Ok(Some(self.answer()?)),
            _ => Ok(None),
        }
    }

    /// Whether the telemetry's clock has passed the next answer's time.
    fn is_due(&mut self, now: f64) -> bool {
        let later = now + self.period;
        // A clock that was set back starts the rhythm anew, so that what is skipped meanwhile does not go unsaid.
        let due = self.due.map_or(later, |due| due.min(later));
        let is_due = now >= due;
        let next = due + self.period;
        self.due = Some(match is_due {
            false => due,
            // Answers keep their rhythm; after a gap it begins anew.
            true if next > now => next,
            true => later,
        });
        is_due
    }

    fn answer(&mut self) -> Result<v1::EstimateFrictionResponse, ServiceError> {
        let report = self.estimator.report();
        let mut answer = convert::drive::estimate_to_wire(&report, self.robot.robot.spec());
        answer.warnings = self.hints.messages();
        if !finite::estimate(&answer) {
            return Err(not_finite());
        }
        if std::mem::take(&mut self.is_first) {
            answer.provenance = Some(self.provenance.clone());
        }
        Ok(answer)
    }

    /// The last answer, with the state and what a new revision would be; `description` is the stored one, where there
    /// still is one.
    pub(crate) fn finish(&mut self, description: Option<&[u8]>) -> Result<v1::EstimateFrictionResponse, ServiceError> {
        let mut answer = self.answer()?;
        answer.last = true;
        answer.provenance = Some(self.provenance.clone());
        answer.state = Some(convert::drive::state_to_wire(self.estimator.state()));
        let description = description.map(decode).transpose()?;
        answer.proposal = description.and_then(|description| self.proposal(description));
        Ok(answer)
    }

    /// What a new revision would be; `None` where nothing was learned.
    fn proposal(&self, description: v1::RobotDescription) -> Option<v1::ModelProposal> {
        let report = self.estimator.report();
        let mut proposal = Proposal::new(description, &self.robot);
        let mut known = Known::default();
        for (joint, estimate) in report.joints.iter().enumerate() {
            if estimate.missing.is_empty() {
                let warnings = proposal.change_drive(joint, |drive| estimate.commit(drive));
                proposal.warn(joint, warnings);
                known.parameters.push(estimate.parameters(joint));
            } else {
                proposal.warn(
                    joint,
                    ["friction stays as it is: the motion did not say enough of it".to_owned()],
                );
            }
            known.residuals.push(estimate.residual());
        }
        proposal.know(known);
        let options = self.estimator.options();
        let note = format!(
            "{:?}, {:?} friction, {} samples",
            options.method, options.side, report.sample_count
        );
        proposal.finish("EstimateFriction", note)
    }
}
