//! The client: its calls, and the choice of the endpoint.

use std::{
    fmt,
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicUsize, Ordering},
    },
    time::Duration,
};

use futures::{FutureExt, Stream, StreamExt, future::BoxFuture, stream};
use http::Uri;
use takt_proto::{
    id::RobotId,
    v1::{self, estimate_friction_request::Part},
};
use tokio::time::Instant;

use crate::{
    builder::{Builder, Transport},
    connection::Http2,
    error::{Code, Error},
    grpc, http_json,
    retry::{self, RetryPolicy, Safety},
    rpc::{self, Rpc},
    stream::{BatchAnswers, FrictionEstimates, Pieces, SetpointStream},
};

/// How long an endpoint that could not be reached is asked last instead of in its turn.
const AVOID_AFTER_FAILURE: Duration = Duration::from_secs(5);

/// A client of one Takt service, with one or several endpoints.
///
/// Cheap to clone; clones share their connections. See the [crate's page](crate) for an example and for what happens
/// when something goes wrong.
#[derive(Clone)]
pub struct Client {
    pub(crate) deadline: Duration,
    pub(crate) shared: Arc<Shared>,
}

pub(crate) struct Shared {
    pub(crate) endpoints: Vec<Endpoint>,
    /// Which endpoint the next call starts at.
    pub(crate) turn: AtomicUsize,
    pub(crate) transport: Transport,
    pub(crate) retry: RetryPolicy,
    pub(crate) max_reply_bytes: usize,
    pub(crate) http2: Http2,
    pub(crate) http1: reqwest::Client,
}

pub(crate) struct Endpoint {
    pub(crate) name: String,
    pub(crate) uri: Uri,
    /// When it was last found unreachable or unavailable.
    pub(crate) failed_at: Mutex<Option<Instant>>,
}

impl Endpoint {
    fn failed_lately(&self) -> bool {
        let failed_at = *self.failed_at.lock().unwrap_or_else(PoisonError::into_inner);
        failed_at.is_some_and(|at| at.elapsed() < AVOID_AFTER_FAILURE)
    }

    fn set_failed(&self, failed: bool) {
        let at = failed.then(Instant::now);
        *self.failed_at.lock().unwrap_or_else(PoisonError::into_inner) = at;
    }
}

impl fmt::Debug for Client {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let endpoints: Vec<_> = self.shared.endpoints.iter().map(|endpoint| &endpoint.name).collect();
        f.debug_struct("Client")
            .field("endpoints", &endpoints)
            .field("transport", &self.shared.transport)
            .field("deadline", &self.deadline)
            .field("retry", &self.shared.retry)
            .finish_non_exhaustive()
    }
}

/// What is no id could be another path over HTTP; both transports refuse it with the same words.
fn check_robot_id(id: &str) -> Result<(), Error> {
    match RobotId::parse(id) {
        Ok(_) => Ok(()),
        Err(why) => Err(Error::refused("robot_id", why)),
    }
}

macro_rules! calls {
    ($($(#[$doc:meta])* $name:ident: $rpc:ident, $request:ident => $response:ident;)*) => {
        $(
            $(#[$doc])*
            ///
            /// # Errors
            ///
            /// See [`Error`].
            pub async fn $name(&self, request: v1::$request) -> Result<v1::$response, Error> {
                Box::pin(self.call::<rpc::$rpc>(request)).await
            }
        )*
    };
}

impl Client {
    /// Starts the settings of a client.
    pub fn builder() -> Builder {
        Builder::default()
    }

    /// The same client with another deadline, for a call that may take longer or must not.
    #[must_use]
    pub fn with_deadline(&self, deadline: Duration) -> Self {
        Self {
            deadline,
            shared: Arc::clone(&self.shared),
        }
    }

    calls! {
        /// Checks a description and stores it as a revision of a robot. The same content is the same revision.
        ///
        /// Tried again like a reading call, unless an expected revision is set: then only where it certainly never
        /// left.
        register_robot: RegisterRobot, RegisterRobotRequest => RegisterRobotResponse;
        /// Reads a robot and its description.
        get_robot: GetRobot, GetRobotRequest => GetRobotResponse;
        /// Lists the robots, a page at a time.
        list_robots: ListRobots, ListRobotsRequest => ListRobotsResponse;
        /// Lists the revisions of a robot, newest first, a page at a time.
        list_revisions: ListRevisions, ListRevisionsRequest => ListRevisionsResponse;
        /// Deletes a robot with all its revisions. Never tried again once it may have been sent.
        delete_robot: DeleteRobot, DeleteRobotRequest => DeleteRobotResponse;
        /// Plans a move from one configuration to another. A move that cannot be is an answer, with its evidence.
        plan_move: PlanMove, PlanMoveRequest => PlanMoveResponse;
        /// Plans a robot program. A program that cannot be run is an answer, with its evidence.
        plan_path: PlanPath, PlanPathRequest => PlanPathResponse;
        /// The margins of a trajectory that somebody else made.
        check_trajectory: CheckTrajectory, CheckTrajectoryRequest => CheckTrajectoryResponse;
        /// Joint torques, and on request mass matrix and Jacobian, of many states.
        inverse_dynamics: InverseDynamics, InverseDynamicsRequest => InverseDynamicsResponse;
        /// The tool's pose for many configurations.
        forward_kinematics: ForwardKinematics, ForwardKinematicsRequest => ForwardKinematicsResponse;
        /// Every way to reach each of many poses, or the evidence why there is none.
        inverse_kinematics: InverseKinematics, InverseKinematicsRequest => InverseKinematicsResponse;
        /// Fits drives and bodies to a recorded motion. A motion that does not say enough has an answer that says what is
        /// missing.
        fit_drive: FitDrive, FitDriveRequest => FitDriveResponse;
        /// Runs a motion on a simulated arm whose friction is not the model's, with and without adaptation.
        rehearse: Rehearse, RehearseRequest => RehearseResponse;
    }

    /// Set-points of a move or a program on the controller's cycle. Its header is here as soon as the plan is verified;
    /// the set-points come as they are asked for.
    ///
    /// # Errors
    ///
    /// See [`Error`].
    pub async fn stream_setpoints(&self, request: v1::StreamSetpointsRequest) -> Result<SetpointStream, Error> {
        check_robot_id(&request.robot_id)?;
        let shared = &self.shared;
        let request = &request;
        let attempt = |endpoint: &Endpoint, _| {
            let uri = endpoint.uri.clone();
            async move {
                let most = shared.max_reply_bytes;
                let pieces = match shared.transport {
                    Transport::Grpc => {
                        let request = stream::iter([request.clone()]);
                        grpc::open::<rpc::StreamSetpoints>(&shared.http2, &uri, request, most).await?
                    }
                    Transport::Http => {
                        http_json::open::<rpc::StreamSetpoints>(&shared.http1, &uri, request, None, most).await?
                    }
                };
                SetpointStream::begin(pieces, self.deadline).await
            }
            .boxed()
        };
        self.attempts(Safety::Repeatable, attempt).await
    }

    /// Plans many motions of one robot over one call. Requests are taken from the stream as the service has room for
    /// them; read the answers while they are, or both wait for each other. Never tried again.
    ///
    /// # Errors
    ///
    /// See [`Error`]. What is wrong with one of the requests is the answer to it.
    pub async fn plan_batch(
        &self,
        robot_id: &str,
        requests: impl Stream<Item = v1::PlanBatchRequest> + Send + 'static,
    ) -> Result<BatchAnswers, Error> {
        let id = robot_id.to_owned();
        let requests = requests.map(move |mut request| {
            id.clone_into(&mut request.robot_id);
            request
        });
        let pieces = self.both_ways::<rpc::PlanBatch>(robot_id, requests).await?;
        Ok(BatchAnswers::new(pieces, self.deadline))
    }

    /// Estimates friction from telemetry: the header goes first, then telemetry as the service takes it. Read the
    /// estimates while it does, or both wait for each other. Never tried again; a stream that breaks off can be gone on
    /// with from a state.
    ///
    /// # Errors
    ///
    /// See [`Error`].
    pub async fn estimate_friction(
        &self,
        robot_id: &str,
        header: v1::EstimateHeader,
        telemetry: impl Stream<Item = v1::Telemetry> + Send + 'static,
    ) -> Result<FrictionEstimates, Error> {
        let first = v1::EstimateFrictionRequest {
            robot_id: robot_id.to_owned(),
            part: Some(Part::Header(header)),
        };
        let blocks = telemetry.map(|block| v1::EstimateFrictionRequest {
            robot_id: String::new(),
            part: Some(Part::Telemetry(block)),
        });
        let requests = stream::iter([first]).chain(blocks);
        let pieces = self.both_ways::<rpc::EstimateFriction>(robot_id, requests).await?;
        Ok(FrictionEstimates::new(pieces, self.deadline))
    }

    /// Begins a stream in both directions, once.
    async fn both_ways<R: rpc::Streamed>(
        &self,
        robot_id: &str,
        requests: impl Stream<Item = R::Request> + Send + 'static,
    ) -> Result<Pieces<R::Response>, Error> {
        check_robot_id(robot_id)?;
        let shared = &self.shared;
        let requests = Mutex::new(Some(requests.boxed()));
        let attempt = |endpoint: &Endpoint, _| {
            let uri = endpoint.uri.clone();
            let requests = requests.lock().unwrap_or_else(PoisonError::into_inner).take();
            async move {
                let requests = requests.ok_or_else(|| Error::refused("requests", "are sent once"))?;
                let most = shared.max_reply_bytes;
                match shared.transport {
                    Transport::Grpc => grpc::open::<R>(&shared.http2, &uri, requests, most).await,
                    Transport::Http => {
                        let bodies = requests.map(|request| R::body(&request)).boxed();
                        http_json::open::<R>(&shared.http1, &uri, &R::about(robot_id), Some(bodies), most).await
                    }
                }
            }
            .boxed()
        };
        self.attempts_within(&RetryPolicy::none(), Safety::Once, &self.order()[..1], attempt)
            .await
    }

    async fn call<R: Rpc>(&self, request: R::Request) -> Result<R::Response, Error> {
        if let Some(id) = R::robot_id(&request) {
            check_robot_id(id)?;
        }
        let shared = &self.shared;
        let request = &request;
        let attempt = |endpoint: &Endpoint, left| {
            let uri = endpoint.uri.clone();
            async move {
                let most = shared.max_reply_bytes;
                match shared.transport {
                    Transport::Grpc => grpc::send::<R>(&shared.http2, &uri, request.clone(), left, most).await,
                    Transport::Http => http_json::send::<R>(&shared.http1, &uri, request, left, most).await,
                }
            }
            .boxed()
        };
        self.attempts(R::safety(request), attempt).await
    }

    /// Attempts at one endpoint after the other, as the policy has it.
    async fn attempts<'a, T>(
        &'a self,
        safety: Safety,
        attempt: impl Fn(&'a Endpoint, Duration) -> BoxFuture<'a, Result<T, Error>>,
    ) -> Result<T, Error> {
        self.attempts_within(&self.shared.retry, safety, &self.order(), attempt)
            .await
    }

    async fn attempts_within<'a, T>(
        &'a self,
        retry: &RetryPolicy,
        safety: Safety,
        order: &[usize],
        attempt: impl Fn(&'a Endpoint, Duration) -> BoxFuture<'a, Result<T, Error>>,
    ) -> Result<T, Error> {
        let shared = &self.shared;
        let attempt = &attempt;
        // Which endpoint was asked last: a call whose time is up cannot say it itself.
        let asked = &AtomicUsize::new(order[0]);
        let attempt = |index: usize, left| async move {
            asked.store(index, Ordering::Relaxed);
            let endpoint = &shared.endpoints[index];
            let result = attempt(endpoint, left).await;
            endpoint.set_failed(matches!(&result, Err(error) if error.code() == Code::Unavailable));
            result.map_err(|error| error.at(&endpoint.name))
        };
        let result = retry::run(retry, safety, self.deadline, order, attempt).await;
        result.map_err(|error| {
            if !error.endpoint().is_empty() {
                return error;
            }
            let endpoint = &shared.endpoints[asked.load(Ordering::Relaxed)];
            endpoint.set_failed(true);
            error.at(&endpoint.name)
        })
    }

    /// The endpoints in the order of this call: each call starts one further, and those that failed lately come last.
    fn order(&self) -> Vec<usize> {
        let endpoints = &self.shared.endpoints;
        let first = self.shared.turn.fetch_add(1, Ordering::Relaxed);
        let mut order: Vec<usize> = (0..endpoints.len())
            .map(|step| first.wrapping_add(step) % endpoints.len())
            .collect();
        order.sort_by_key(|&index| endpoints[index].failed_lately());
        order
    }
}
