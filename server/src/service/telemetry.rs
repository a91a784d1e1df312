//! Friction from telemetry: a stream in both directions, whose blocks are computed one after the other.
//!
//! A block is taken from the caller when the one before has been computed and what it said has been taken: nothing is
//! dropped, and what a stream holds does not grow. Blocks are short, and no more of them are at the planner's door than
//! it has threads, whatever the number of streams: a plan waits for one block a thread, and not for one a stream.

use std::{
    collections::VecDeque,
    sync::{Arc, Mutex},
};

use futures::{
    Stream, StreamExt,
    stream::{self, BoxStream},
};
use takt_motion::{Invalid, budget::Budget};
use takt_proto::{
    id::RobotId,
    v1::{self, estimate_friction_request::Part},
};

use super::{Call, Service, robot_id, streams::while_alive};
use crate::{compute::Estimating, edge::Admission, error::ServiceError, registry::unavailable, stream::Feed};

/// One message of a stream as it came in.
#[derive(Debug)]
pub(crate) struct Arrived {
    pub(crate) request: Result<v1::EstimateFrictionRequest, ServiceError>,
    /// What it holds of the call's bytes, until it is computed.
    pub(crate) bytes: usize,
}

type Arrivals = BoxStream<'static, Result<Arrived, ServiceError>>;

/// The estimator of a stream, and where it computes.
struct Work {
    service: Arc<Service>,
    call: Call,
    /// Shared with the calculation that has its turn; what a calculation that was given up leaves stands.
    estimating: Arc<Mutex<Estimating>>,
}

/// A stream at work.
struct Running {
    work: Work,
    admission: Admission,
    robot_id: RobotId,
    /// `None`: nothing more is taken in.
    arrivals: Option<Arrivals>,
    ready: VecDeque<v1::EstimateFrictionResponse>,
    /// Why it ends early; said after everything that is ready.
    failure: Option<ServiceError>,
}

impl Service {
    /// Reads the header, then estimates for as long as telemetry comes.
    pub(crate) async fn estimate_friction(
        self: &Arc<Self>,
        call: Call,
        admission: Admission,
        arrivals: impl Stream<Item = Result<Arrived, ServiceError>> + Send + 'static,
    ) -> Result<Feed<v1::EstimateFrictionResponse>, ServiceError> {
        let mut arrivals = while_alive(arrivals, self.idle(), "telemetry").boxed();
        let (id, header) = match arrivals.next().await {
            Some(first) => header_of(first?, &admission)?,
            None => return Err(no_header()),
        };
        let subject = self.subject(call, &id, header.revision.as_deref()).await?;
        let limits = self.limits.clone();
        let job = move |_: &Budget<'_>| Estimating::begin(header, subject, &limits);
        let (estimating, _) = self.run(call, job).await?;
        let running = Running {
            work: Work {
                service: Arc::clone(self),
                call,
                estimating: Arc::new(Mutex::new(estimating)),
            },
            admission: admission.clone(),
            robot_id: robot_id(&id).map_err(|invalid| ServiceError::invalid(vec![invalid]))?,
            arrivals: Some(arrivals),
            ready: VecDeque::new(),
            failure: None,
        };
        let answers = stream::unfold(running, |mut running| async move {
            let answer = running.next().await?;
            Some((answer, running))
        });
        Ok(Feed::of(answers, self.idle(), admission))
    }
}

fn no_header() -> ServiceError {
    ServiceError::invalid(vec![Invalid::new("header", "must be the first message")])
}

fn header_of(arrived: Arrived, admission: &Admission) -> Result<(String, v1::EstimateHeader), ServiceError> {
    let request = arrived.request?;
    admission.held().release(arrived.bytes);
    match request.part {
        Some(Part::Header(header)) => Ok((request.robot_id, header)),
        _ => Err(no_header()),
    }
}

impl Running {
    async fn next(&mut self) -> Option<Result<v1::EstimateFrictionResponse, ServiceError>> {
        loop {
            if let Some(answer) = self.ready.pop_front() {
                return Some(Ok(answer));
            }
            if let Some(failure) = self.failure.take() {
                return Some(Err(failure));
            }
            let failure = match self.arrivals.as_mut()?.next().await {
                Some(Ok(arrived)) => match self.take(arrived).await {
                    Ok(()) => continue,
                    Err(failure) => Some(failure),
                },
                Some(Err(failure)) => Some(failure),
                None => None,
            };
            self.arrivals = None;
            // What was learned until then is the caller's, however it ended.
            let ended = self.end().await;
            self.failure = failure.or(ended.err());
        }
    }

    /// Computes one block.
    async fn take(&mut self, arrived: Arrived) -> Result<(), ServiceError> {
        let request = arrived.request?;
        let block = match request.part {
            Some(Part::Telemetry(block)) => block,
            Some(Part::Header(_)) => {
                let message = "comes once, before the telemetry";
                return Err(ServiceError::invalid(vec![Invalid::new("header", message)]));
            }
            None => return Err(ServiceError::invalid(vec![Invalid::new("telemetry", "must be given")])),
        };
        let taken = self
            .work
            .compute(move |estimating, budget| estimating.take(&block, budget))
            .await;
        self.admission.held().release(arrived.bytes);
        self.ready.extend(taken?);
        Ok(())
    }

    /// The last answer. The robot may have been deleted meanwhile: what was estimated stands, but there is nothing that
    /// it could change.
    async fn end(&mut self) -> Result<(), ServiceError> {
        let revision = self.work.compute(|estimating, _| Ok(estimating.revision())).await?;
        let stored = self.work.service.registry.store().read(&self.robot_id, &revision).await;
        let (description, read) = match stored {
            Ok(record) => (record.map(|record| record.description), Ok(())),
            Err(error) => (None, Err(unavailable(error))),
        };
        let last = self
            .work
            .compute(move |estimating, _| estimating.finish(description.as_deref()));
        let last = last.await?;
        self.ready.push_back(last);
        read
    }
}

impl Work {
    /// Runs a calculation with the estimator on the planner's threads.
    async fn compute<T: Send + 'static>(
        &self,
        job: impl FnOnce(&mut Estimating, &Budget<'_>) -> Result<T, ServiceError> + Send + 'static,
    ) -> Result<T, ServiceError> {
        let broken = || ServiceError::internal("an earlier calculation of this stream failed");
        let turn = self.service.turns.acquire().await;
        let _turn = turn.map_err(|_| ServiceError::internal("the planner has ended"))?;
        let estimating = Arc::clone(&self.estimating);
        let job = move |budget: &Budget<'_>| job(&mut *estimating.lock().map_err(|_| broken())?, budget);
        Ok(self.service.run(self.call.of_item(), job).await?.0)
    }
}
