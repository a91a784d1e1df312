//! The use cases that answer in pieces.

use std::{sync::Arc, time::Duration};

use futures::{FutureExt, Stream, StreamExt, stream};
use takt_motion::{Invalid, budget::Budget};
use takt_proto::{
    convert::{quoted, stream::batch_error},
    error::ErrorCode,
    v1::{
        self, plan_batch_request::Motion, plan_batch_response::Answer as BatchAnswer,
        stream_setpoints_request::Motion as Streamed,
    },
};
use tokio::time::timeout;

use super::{Call, Service, robot_id};
use crate::{compute, edge::Admission, error::ServiceError, form::Plain, stream::Feed};

/// Most plans of one batch in work at once, however many threads there are.
const WIDEST: usize = 64;

/// One request of a batch as it came in.
#[derive(Debug)]
pub(crate) struct Incoming {
    /// What was read; an error where it could not be, and those behind it can.
    pub(crate) request: Result<v1::PlanBatchRequest, ServiceError>,
    /// What it holds of the call's bytes, until it is answered.
    pub(crate) bytes: usize,
}

impl Service {
    pub(super) fn idle(&self) -> Duration {
        Duration::from_secs_f64(self.limits.stream_idle_s)
    }

    /// Plans, then feeds the set-points to the caller. The planner's thread is free once the plan is made.
    pub(crate) async fn stream_setpoints(
        self: &Arc<Self>,
        call: Call,
        admission: Admission,
        mut request: v1::StreamSetpointsRequest,
    ) -> Result<Feed<v1::StreamSetpointsResponse>, ServiceError> {
        let outer = &request.robot_id;
        let (id, revision) = match &mut request.motion {
            Some(Streamed::Move(motion)) => {
                adopt("move", outer, &mut motion.robot_id)?;
                (motion.robot_id.clone(), motion.revision.clone())
            }
            Some(Streamed::Path(motion)) => {
                adopt("path", outer, &mut motion.robot_id)?;
                (motion.robot_id.clone(), motion.revision.clone())
            }
            None => (outer.clone(), None),
        };
        let subject = self.subject(call, &id, revision.as_deref()).await?;
        let service = Arc::clone(self);
        let job = move |budget: &Budget<'_>| {
            compute::stream_setpoints(request, subject, &service.limits, call.deadline, budget)
        };
        let (pieces, _) = self.run(call, job).await?;
        let parts = stream::iter(pieces.into_parts()).map(Ok);
        Ok(Feed::of(parts, self.idle(), admission))
    }

    /// Answers requests as they come, several at once, in their order or as they are ready.
    pub(crate) fn plan_batch(
        self: &Arc<Self>,
        call: Call,
        admission: Admission,
        requests: impl Stream<Item = Result<Incoming, ServiceError>> + Send + 'static,
    ) -> Feed<v1::PlanBatchResponse> {
        let (service, held) = (Arc::clone(self), admission.clone());
        let idle = self.idle();
        let width = self.planner.thread_count().saturating_mul(2).min(WIDEST);
        let answers = async move {
            let mut requests = while_alive(requests, idle, "request").boxed();
            let first = requests.next().await;
            let is_ordered = match &first {
                Some(Ok(Incoming {
                    request: Ok(request), ..
                })) => request.ordered.unwrap_or(false),
                _ => false,
            };
            let requests = stream::iter(first).chain(requests).enumerate();
            let answers = requests.map(move |(index, request)| {
                let (service, held) = (Arc::clone(&service), held.clone());
                async move {
                    let Incoming { request, bytes } = request?;
                    let answered = answer(&service, call, index, request).await;
                    held.held().release(bytes);
                    Ok(answered)
                }
                .boxed()
            });
            match is_ordered {
                true => answers.buffered(width).boxed(),
                false => answers.buffer_unordered(width).boxed(),
            }
        };
        Feed::of(answers.into_stream().flatten(), idle, admission)
    }
}

/// Ends a stream of requests to which nothing is added for too long.
pub(super) fn while_alive<T>(
    requests: impl Stream<Item = Result<T, ServiceError>> + Send,
    idle: Duration,
    what: &'static str,
) -> impl Stream<Item = Result<T, ServiceError>> + Send {
    stream::unfold(Some(Box::pin(requests)), move |requests| async move {
        let mut requests = requests?;
        match timeout(idle, requests.next()).await {
            Ok(Some(Ok(request))) => Some((Ok(request), Some(requests))),
            Ok(Some(Err(error))) => Some((Err(error), None)),
            Ok(None) => None,
            Err(_) => {
                let seconds = idle.as_secs_f64();
                let message = format!("no {what} came for the {seconds} s of `limits.stream_idle_s`");
                Some((Err(ServiceError::new(ErrorCode::DeadlineExceeded, message)), None))
            }
        }
    })
}

/// The answer to one request of a batch.
async fn answer(
    service: &Arc<Service>,
    call: Call,
    index: usize,
    request: Result<v1::PlanBatchRequest, ServiceError>,
) -> v1::PlanBatchResponse {
    let (id, answer) = match request {
        Ok(request) => {
            let planned = plan(service, call.of_item(), request.robot_id, request.motion).await;
            (request.id, planned)
        }
        Err(error) => (String::new(), Err(error)),
    };
    v1::PlanBatchResponse {
        id,
        index: u32::try_from(index).unwrap_or(u32::MAX),
        answer: Some(answer.unwrap_or_else(|error| BatchAnswer::Error(batch_error(error.wire())))),
    }
}

async fn plan(
    service: &Arc<Service>,
    call: Call,
    robot_id: String,
    motion: Option<Motion>,
) -> Result<BatchAnswer, ServiceError> {
    match motion {
        Some(Motion::Move(mut request)) => {
            adopt("move", &robot_id, &mut request.robot_id)?;
            let planned = service.plan_move::<Plain>(call, request).await;
            let planned = planned.map_err(|error| error.below("move"))?;
            Ok(BatchAnswer::Move(planned.message))
        }
        Some(Motion::Path(mut request)) => {
            adopt("path", &robot_id, &mut request.robot_id)?;
            let planned = service.plan_path::<Plain>(call, request).await;
            let planned = planned.map_err(|error| error.below("path"))?;
            Ok(BatchAnswer::Path(planned.message))
        }
        None => {
            let invalid = Invalid::new("move", "must be given, or `path`");
            Err(ServiceError::invalid(vec![invalid]))
        }
    }
}

/// The robot of a motion is that of the request around it.
pub(super) fn adopt(field: &str, outer: &str, inner: &mut String) -> Result<(), ServiceError> {
    if !outer.is_empty() {
        robot_id(outer).map_err(|invalid| ServiceError::invalid(vec![invalid]))?;
    }
    if inner.is_empty() {
        outer.clone_into(inner);
    }
    if outer.is_empty() || inner == outer {
        return Ok(());
    }
    let message = format!(
        "{} is not the robot of the request around it, {}",
        quoted(inner),
        quoted(outer)
    );
    Err(ServiceError::invalid(vec![Invalid::new(
        format!("{field}.robot_id"),
        message,
    )]))
}
