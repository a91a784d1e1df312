//! Set-points in pieces: the plan is made as without a stream, its samples stay as the planner made them and are written
//! chunk by chunk.

use std::{sync::Arc, time::Instant};

use takt_motion::{
    Invalid, budget::Budget, drive::feedforward::FeedForward, path::outcome::PathOutcome, plan::outcome::MoveOutcome,
};
use takt_proto::{
    convert::{self, path::SetpointsOf},
    v1::{
        self, plan_move_response, plan_path_response, setpoints_header::Answer, stream_setpoints_request::Motion,
        stream_setpoints_response::Part,
    },
};

use super::{
    Subject,
    motor::{self, Motors},
    planned,
};
use crate::{config::Limits, error::ServiceError, registry::Compiled};

/// Set-points of one chunk where the caller does not say.
const CHUNK_POINTS: u32 = 50;

/// Most set-points of one chunk: more would keep the thread that writes them from others for too long.
const LARGEST_CHUNK: u32 = 200;

/// A stream before it is written.
#[derive(Debug)]
pub(crate) struct Pieces {
    header: v1::SetpointsHeader,
    setpoints: Option<SetpointsOf>,
    /// Where asked for.
    motors: Option<FeedForward>,
    robot: Arc<Compiled>,
    chunk: usize,
}

impl Pieces {
    /// The header, then the chunks, each written when it is asked for.
    pub(crate) fn into_parts(self) -> impl Iterator<Item = v1::StreamSetpointsResponse> {
        let Self {
            header,
            setpoints,
            motors,
            robot,
            chunk,
        } = self;
        let count = setpoints.as_ref().map_or(0, SetpointsOf::count);
        let chunks = (0..count).step_by(chunk).filter_map(move |first| {
            let (range, spec) = (first..first + chunk, robot.robot.spec());
            let mut piece = setpoints.as_ref()?.piece_to_wire(range.clone(), spec);
            if let Some(forward) = &motors {
                motor::add(forward, range, &mut piece, spec);
            }
            Some(part(Part::Chunk(v1::SetpointsChunk {
                first: u32::try_from(first).unwrap_or(u32::MAX),
                last: first + chunk >= count,
                setpoints: Some(piece),
            })))
        });
        std::iter::once(part(Part::Header(header))).chain(chunks)
    }
}

fn part(part: Part) -> v1::StreamSetpointsResponse {
    v1::StreamSetpointsResponse { part: Some(part) }
}

/// Plans what is to be streamed.
pub(crate) fn stream_setpoints(
    request: v1::StreamSetpointsRequest,
    subject: Subject,
    limits: &Limits,
    deadline: Instant,
    budget: &Budget<'_>,
) -> Result<Pieces, ServiceError> {
    let chunk = request.chunk_points.unwrap_or(CHUNK_POINTS);
    if !(1..=LARGEST_CHUNK).contains(&chunk) {
        let message = format!("{chunk} must be at least 1 and at most {LARGEST_CHUNK}");
        return Err(ServiceError::invalid(vec![Invalid::new("chunk_points", message)]));
    }
    let chunk = usize::try_from(chunk).unwrap_or(1);
    match request.motion {
        Some(Motion::Move(mut motion)) => {
            let within = |error: ServiceError| error.below("move");
            let period = period(
                request.sample_period_s,
                &mut motion.sample_period_s,
                motion.trace_points,
            );
            let period = period.map_err(within)?;
            let mut planned = planned(motion, subject, limits, deadline, budget).map_err(within)?;
            let setpoints = match &mut planned.outcome.outcome {
                MoveOutcome::Plan(plan) => plan.setpoints.take().map(SetpointsOf::Move),
                MoveOutcome::Infeasible(_) => None,
            };
            let spec = planned.robot.robot.spec();
            let mut outcome = convert::confidence::move_to_wire(planned.outcome, spec);
            if let plan_move_response::Outcome::Plan(plan) = &mut outcome {
                motor::add_all(planned.motors.as_ref(), &mut plan.setpoints, &mut plan.warnings, spec);
            }
            let answer = Answer::Move(v1::PlanMoveResponse {
                outcome: Some(outcome),
                provenance: Some(planned.provenance),
            });
            Ok(pieces(answer, setpoints, planned.motors, period, planned.robot, chunk))
        }
        Some(Motion::Path(mut motion)) => {
            let within = |error: ServiceError| error.below("path");
            let period = period(
                request.sample_period_s,
                &mut motion.sample_period_s,
                motion.trace_points,
            );
            let period = period.map_err(within)?;
            let mut planned = planned(motion, subject, limits, deadline, budget).map_err(within)?;
            let setpoints = match &mut planned.outcome.outcome {
                PathOutcome::Plan(plan) => plan.setpoints.take().map(SetpointsOf::Path),
                PathOutcome::Infeasible(_) => None,
            };
            let spec = planned.robot.robot.spec();
            let mut outcome = convert::confidence::path_to_wire(planned.outcome, spec);
            if let plan_path_response::Outcome::Plan(plan) = &mut outcome {
                motor::add_all(planned.motors.as_ref(), &mut plan.setpoints, &mut plan.warnings, spec);
            }
            let answer = Answer::Path(v1::PlanPathResponse {
                outcome: Some(outcome),
                provenance: Some(planned.provenance),
            });
            Ok(pieces(answer, setpoints, planned.motors, period, planned.robot, chunk))
        }
        None => {
            let invalid = Invalid::new("move", "must be given, or `path`");
            Err(ServiceError::invalid(vec![invalid]))
        }
    }
}

/// Settles the period in the motion itself, where it counts for the hash.
fn period(beside: Option<f64>, within: &mut Option<f64>, trace_points: Option<u32>) -> Result<f64, ServiceError> {
    let refused = |field: &str, message: String| Err(ServiceError::invalid(vec![Invalid::new(field, message)]));
    if trace_points.is_some() {
        return refused(
            "trace_points",
            "a stream has set-points: give `sample_period_s`".to_owned(),
        );
    }
    match (beside, *within) {
        (Some(beside), Some(within)) if beside.to_bits() != within.to_bits() => {
            let message = format!("{within} s is not the {beside} s that the stream asks for");
            refused("sample_period_s", message)
        }
        (Some(period), _) | (None, Some(period)) => {
            *within = Some(period);
            Ok(period)
        }
        (None, None) => refused("sample_period_s", "must be given".to_owned()),
    }
}

fn pieces(
    answer: Answer,
    setpoints: Option<SetpointsOf>,
    motors: Option<Motors>,
    sample_period_s: f64,
    robot: Arc<Compiled>,
    chunk: usize,
) -> Pieces {
    let count = setpoints.as_ref().map_or(0, SetpointsOf::count);
    Pieces {
        header: v1::SetpointsHeader {
            answer: Some(answer),
            setpoint_count: u32::try_from(count).unwrap_or(u32::MAX),
            sample_period_s,
        },
        setpoints,
        motors: motors.and_then(Result::ok),
        robot,
        chunk,
    }
}
