//! The HTTP edge: the same messages as JSON. Decodes, calls the service, encodes.

mod json;
mod lines;
mod pages;
mod query;
mod robot;

use std::{borrow::Cow, collections::BTreeSet, sync::Arc};

use axum::{
    Extension, Router,
    extract::{Request, State},
    handler::Handler,
    response::{IntoResponse, Response},
};
use bytes::Bytes;
use http::{HeaderValue, Method, StatusCode, Uri, header};
use takt_motion::Invalid;
use takt_proto::{
    convert::quoted,
    error::ErrorCode,
    route::{self, HttpMethod, Match, ROUTES, Rpc},
    v1,
};

use self::{json::Json, query::Query};
use crate::{
    edge::{SERVER_TIMING, server_timing},
    error::ServiceError,
    form::JsonText,
    health::Health,
    planner::Timing,
    service::{Answer, Call, Service},
};

#[derive(Debug)]
struct Http {
    service: Arc<Service>,
    json: Json,
}

type Answered = Result<Response, ServiceError>;

/// The HTTP side of the port.
pub(crate) fn router(service: Arc<Service>, health: Health, max_request_bytes: usize) -> Router {
    let json = Json::new(Arc::clone(&service), max_request_bytes);
    let rpc = rpc.with_state(Arc::new(Http { service, json }));
    // To axum the robot's id and the verb are one segment: the table of routes tells them, and the methods, apart.
    let paths: BTreeSet<_> = ROUTES.iter().filter_map(|route| route.path.split(':').next()).collect();
    paths.into_iter().fold(pages::router(health), |router, path| {
        router.route_service(path, rpc.clone())
    })
}

async fn rpc(State(http): State<Arc<Http>>, Extension(call): Extension<Call>, request: Request) -> Answered {
    let path = decoded(request.uri());
    let method = match request.method() {
        &Method::HEAD => "GET",
        other => other.as_str(),
    };
    match route::find(method, &path) {
        Match::Found(route, id) => {
            let id = id.to_owned();
            http.answer(route.rpc, id, request, call).await
        }
        Match::OtherMethod(others) => Ok(not_allowed(request.method(), &others)),
        Match::Unknown => Err(unknown(request.uri())),
    }
}

impl Http {
    async fn answer(self: &Arc<Self>, rpc: Rpc, id: String, request: Request, call: Call) -> Answered {
        match rpc {
            Rpc::ListRobots => self.list_robots(request.uri()).await,
            Rpc::RegisterRobot => self.register_robot(request, id, call).await,
            Rpc::GetRobot => self.get_robot(request.uri(), request.headers(), id, call).await,
            Rpc::DeleteRobot => self.delete_robot(request.uri(), request.headers(), id).await,
            Rpc::ListRevisions => self.list_revisions(request.uri(), id).await,
            Rpc::PlanMove => {
                let message: v1::PlanMoveRequest = self.json.read_for(request, id, call).await?;
                Ok(written(self.service.plan_move::<JsonText>(call, message).await?))
            }
            Rpc::PlanPath => {
                let message: v1::PlanPathRequest = self.json.read_for(request, id, call).await?;
                Ok(written(self.service.plan_path::<JsonText>(call, message).await?))
            }
            Rpc::PlanBatch => self.plan_batch(request, id, call),
            Rpc::EstimateFriction => self.estimate_friction(request, id, call).await,
            Rpc::StreamSetpoints => self.stream_setpoints(request, id, call).await,
            Rpc::CheckTrajectory => {
                let message: v1::CheckTrajectoryRequest = self.json.read_for(request, id, call).await?;
                Ok(written(self.service.check_trajectory::<JsonText>(call, message).await?))
            }
            Rpc::FitDrive => {
                let message: v1::FitDriveRequest = self.json.read_for(request, id, call).await?;
                Ok(written(self.service.fit_drive::<JsonText>(call, message).await?))
            }
            Rpc::Rehearse => {
                let message: v1::RehearseRequest = self.json.read_for(request, id, call).await?;
                Ok(written(self.service.rehearse::<JsonText>(call, message).await?))
            }
            Rpc::InverseDynamics => {
                let message: v1::InverseDynamicsRequest = self.json.read_for(request, id, call).await?;
                Ok(written(self.service.inverse_dynamics::<JsonText>(call, message).await?))
            }
            Rpc::ForwardKinematics => {
                let message: v1::ForwardKinematicsRequest = self.json.read_for(request, id, call).await?;
                Ok(written(
                    self.service.forward_kinematics::<JsonText>(call, message).await?,
                ))
            }
            Rpc::InverseKinematics => {
                let message: v1::InverseKinematicsRequest = self.json.read_for(request, id, call).await?;
                Ok(written(
                    self.service.inverse_kinematics::<JsonText>(call, message).await?,
                ))
            }
        }
    }
}

fn decoded(uri: &Uri) -> Cow<'_, str> {
    percent_encoding::percent_decode_str(uri.path()).decode_utf8_lossy()
}

fn unknown(uri: &Uri) -> ServiceError {
    ServiceError::not_found(format!("there is no path {}", quoted(&decoded(uri))))
}

fn not_allowed(method: &Method, allowed: &[HttpMethod]) -> Response {
    let allowed: Vec<_> = allowed.iter().map(|method| method.as_str()).collect();
    let allowed = allowed.join(", ");
    let message = format!("{} is not a method of this path, {allowed} is", quoted(method.as_str()));
    let error = ServiceError::new(ErrorCode::MethodNotAllowed, message);
    ([(header::ALLOW, allowed)], error).into_response()
}

/// An error as its JSON; the error itself goes along for the log.
impl IntoResponse for ServiceError {
    fn into_response(self) -> Response {
        let wire = self.wire();
        let status = StatusCode::from_u16(wire.code.row().http).unwrap_or(StatusCode::INTERNAL_SERVER_ERROR);
        let mut response = json_response(status, wire.to_json().to_string());
        if let Some(delay) = wire.retry_after {
            // The header has whole seconds; the body says it exactly.
            let seconds = delay.as_secs() + u64::from(delay.subsec_nanos() > 0);
            response.headers_mut().insert(header::RETRY_AFTER, seconds.into());
        }
        response.extensions_mut().insert(self);
        response
    }
}

fn json_response(status: StatusCode, body: impl IntoResponse) -> Response {
    (status, [(header::CONTENT_TYPE, "application/json")], body).into_response()
}

/// An answer that is text already.
fn written(answer: Answer<Bytes>) -> Response {
    let mut response = json_response(StatusCode::OK, answer.message);
    add_timing(&mut response, answer.timing);
    response
}

fn add_timing(response: &mut Response, timing: Timing) {
    if let Ok(timing) = HeaderValue::try_from(server_timing(timing)) {
        response.headers_mut().insert(SERVER_TIMING, timing);
    }
}

fn add_etag(response: &mut Response, revision: &str) {
    if let Ok(tag) = HeaderValue::try_from(format!("\"{revision}\"")) {
        response.headers_mut().insert(header::ETAG, tag);
    }
}
