//! The client: its calls, and the choice of the endpoint.

use std::{
    fmt,
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicUsize, Ordering},
    },
    time::Duration,
};

use http::Uri;
use takt_proto::{id::RobotId, v1};
use tokio::time::Instant;

use crate::{
    builder::{Builder, Transport},
    connection::Http2,
    error::{Code, Error},
    grpc, http_json,
    retry::{self, RetryPolicy},
    rpc::{self, Rpc},
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
        /// The margins of a trajectory that somebody else made.
        check_trajectory: CheckTrajectory, CheckTrajectoryRequest => CheckTrajectoryResponse;
        /// Joint torques, and on request mass matrix and Jacobian, of many states.
        inverse_dynamics: InverseDynamics, InverseDynamicsRequest => InverseDynamicsResponse;
        /// The tool's pose for many configurations.
        forward_kinematics: ForwardKinematics, ForwardKinematicsRequest => ForwardKinematicsResponse;
    }

    async fn call<R: Rpc>(&self, request: R::Request) -> Result<R::Response, Error> {
        // What is no id could be another path over HTTP; both transports refuse it with the same words.
        if let Some(id) = R::robot_id(&request) {
            RobotId::parse(id).map_err(|why| Error::refused("robot_id", why))?;
        }
        let shared = &self.shared;
        let order = self.order();
        let request = &request;
        // Which endpoint was asked last: a call whose time is up cannot say it itself.
        let asked = &AtomicUsize::new(order[0]);
        let attempt = |index: usize, left| async move {
            asked.store(index, Ordering::Relaxed);
            let endpoint = &shared.endpoints[index];
            let most = shared.max_reply_bytes;
            let result = match shared.transport {
                Transport::Grpc => grpc::send::<R>(&shared.http2, &endpoint.uri, request.clone(), left, most).await,
                Transport::Http => http_json::send::<R>(&shared.http1, &endpoint.uri, request, left, most).await,
            };
            endpoint.set_failed(matches!(&result, Err(error) if error.code() == Code::Unavailable));
            result.map_err(|error| error.at(&endpoint.name))
        };
        let result = retry::run(&shared.retry, R::safety(request), self.deadline, &order, attempt).await;
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
