//! The HTTP edge: the same messages as JSON. Decodes, calls the service, encodes.

mod json;
mod pages;
mod query;
mod robot;

use std::sync::Arc;

use bytes::Bytes;
use http::{HeaderValue, Method, Request, Response, StatusCode, header};
use http_body_util::Full;
use takt_motion::Invalid;
use takt_proto::{
    convert::quoted,
    error::ErrorCode,
    route::{self, Match, Rpc},
    v1,
};
use tonic::body::Body;

use self::{json::Json, query::Query};
use crate::{
    body::Incoming,
    edge::{SERVER_TIMING, server_timing},
    error::ServiceError,
    health::Health,
    planner::Timing,
    service::{Call, Service},
};

/// The HTTP side of the port.
#[derive(Debug)]
pub(crate) struct Http {
    service: Arc<Service>,
    health: Health,
    json: Json,
}

type Answered = Result<Response<Body>, ServiceError>;

impl Http {
    pub(crate) fn new(service: Arc<Service>, health: Health, max_request_bytes: usize) -> Self {
        Self {
            json: Json::new(Arc::clone(&service), max_request_bytes),
            service,
            health,
        }
    }

    /// Answers a request.
    pub(crate) async fn handle(&self, request: Request<Incoming>, call: Call) -> Response<Body> {
        if let Some(page) = pages::find(&request, &self.health) {
            return page;
        }
        self.route(request, call).await.unwrap_or_else(refuse)
    }

    async fn route(&self, request: Request<Incoming>, call: Call) -> Answered {
        let path = percent_encoding::percent_decode_str(request.uri().path()).decode_utf8_lossy();
        let method = match request.method() {
            &Method::HEAD => "GET",
            other => other.as_str(),
        };
        let (route, id) = match route::find(method, &path) {
            Match::Found(route, id) => (route, id.to_owned()),
            Match::OtherMethod(others) => {
                let allowed: Vec<_> = others.iter().map(|method| method.as_str()).collect();
                return Ok(not_allowed(&request, &allowed.join(", ")));
            }
            Match::Unknown => return Err(ServiceError::not_found(format!("there is no path {}", quoted(&path)))),
        };
        match route.rpc {
            Rpc::ListRobots => self.list_robots(&request).await,
            Rpc::RegisterRobot => self.register_robot(request, id, call).await,
            Rpc::GetRobot => self.get_robot(&request, id, call).await,
            Rpc::DeleteRobot => self.delete_robot(&request, id).await,
            Rpc::ListRevisions => self.list_revisions(&request, id).await,
            Rpc::PlanMove => {
                let message: v1::PlanMoveRequest = self.json.read_for(request, id, call).await?;
                self.json
                    .write(self.service.plan_move(call, message).await?, call)
                    .await
            }
            Rpc::CheckTrajectory => {
                let message: v1::CheckTrajectoryRequest = self.json.read_for(request, id, call).await?;
                self.json
                    .write(self.service.check_trajectory(call, message).await?, call)
                    .await
            }
            Rpc::InverseDynamics => {
                let message: v1::InverseDynamicsRequest = self.json.read_for(request, id, call).await?;
                self.json
                    .write(self.service.inverse_dynamics(call, message).await?, call)
                    .await
            }
            Rpc::ForwardKinematics => {
                let message: v1::ForwardKinematicsRequest = self.json.read_for(request, id, call).await?;
                self.json
                    .write(self.service.forward_kinematics(call, message).await?, call)
                    .await
            }
        }
    }
}

fn not_allowed(request: &Request<Incoming>, allowed: &str) -> Response<Body> {
    let message = format!(
        "{} is not a method of this path, {allowed} is",
        quoted(request.method().as_str())
    );
    let mut response = refuse(ServiceError::new(ErrorCode::MethodNotAllowed, message));
    if let Ok(allowed) = HeaderValue::from_str(allowed) {
        response.headers_mut().insert(header::ALLOW, allowed);
    }
    response
}

/// An error as its JSON; the error itself goes along for the log.
pub(crate) fn refuse(error: ServiceError) -> Response<Body> {
    let wire = error.wire();
    let status = StatusCode::from_u16(wire.code.row().http).unwrap_or(StatusCode::INTERNAL_SERVER_ERROR);
    let body = wire.to_json().to_string();
    let mut response = body_response(status, "application/json", body.into());
    if let Some(delay) = wire.retry_after {
        // The header has whole seconds; the body says it exactly.
        let seconds = delay.as_secs() + u64::from(delay.subsec_nanos() > 0);
        response.headers_mut().insert(header::RETRY_AFTER, seconds.into());
    }
    response.extensions_mut().insert(error);
    response
}

pub(crate) fn body_response(status: StatusCode, kind: &'static str, body: Bytes) -> Response<Body> {
    let mut response = Response::new(Body::new(Full::new(body)));
    *response.status_mut() = status;
    response
        .headers_mut()
        .insert(header::CONTENT_TYPE, HeaderValue::from_static(kind));
    response
}

fn add_timing(response: &mut Response<Body>, timing: Timing) {
    if let Ok(timing) = HeaderValue::try_from(server_timing(timing)) {
        response.headers_mut().insert(SERVER_TIMING, timing);
    }
}

fn add_etag(response: &mut Response<Body>, revision: &str) {
    if let Ok(tag) = HeaderValue::try_from(format!("\"{revision}\"")) {
        response.headers_mut().insert(header::ETAG, tag);
    }
}
