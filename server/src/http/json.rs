//! Messages as JSON bodies. Long ones are read and written on the planner's threads.

use std::sync::Arc;

use axum::{extract::Request, response::Response};
use bytes::Bytes;
use http::{HeaderMap, StatusCode, header};
use http_body_util::{BodyExt, LengthLimitError, Limited};
use prost::Message;
use serde::{Serialize, de::DeserializeOwned};
use takt_motion::{Invalid, budget::Budget};
use takt_proto::{
    convert::quoted,
    error::{Error, ErrorCode},
    v1,
};

use super::{json_response, written};
use crate::{
    error::ServiceError,
    form::json_text,
    service::{Answer, Call, Service},
};

/// Bodies up to this size are read where they arrive: it takes less than the hop to another thread and back.
const SHORT_BODY_BYTES: usize = 16 << 10;

/// Messages up to this encoded size are written where they are.
const SHORT_MESSAGE_BYTES: usize = 8 << 10;

/// What a body is.
pub(super) const JSON: &str = "application/json";

/// Reads and writes bodies.
#[derive(Debug)]
pub(super) struct Json {
    service: Arc<Service>,
    max_bytes: usize,
}

/// A request that names its robot, in the URL and perhaps in the body.
pub(super) trait ForRobot {
    fn robot_id(&mut self) -> &mut String;
}

macro_rules! for_robot {
    ($($request:ident)*) => {
        $(impl ForRobot for v1::$request {
            fn robot_id(&mut self) -> &mut String {
                &mut self.robot_id
            }
        })*
    };
}

for_robot!(
    RegisterRobotRequest PlanMoveRequest PlanPathRequest PlanBatchRequest StreamSetpointsRequest CheckTrajectoryRequest
    InverseDynamicsRequest ForwardKinematicsRequest InverseKinematicsRequest EstimateFrictionRequest FitDriveRequest RehearseRequest
);

impl Json {
    pub(super) fn new(service: Arc<Service>, max_bytes: usize) -> Self {
        Self { service, max_bytes }
    }

    /// Reads the body of a request about the robot of the URL.
    pub(super) async fn read_for<T>(&self, request: Request, id: String, call: Call) -> Result<T, ServiceError>
    where
        T: DeserializeOwned + ForRobot + Send + 'static,
    {
        check_query(&request)?;
        check_kind(request.headers(), &[JSON])?;
        let body = self.body(request).await?;
        self.message_for(body, &id, call).await
    }

    /// Reads a message about the robot of the URL.
    pub(super) async fn message_for<T>(&self, body: Bytes, id: &str, call: Call) -> Result<T, ServiceError>
    where
        T: DeserializeOwned + ForRobot + Send + 'static,
    {
        let mut message: T = if body.len() <= SHORT_BODY_BYTES {
            parse(&body)?
        } else {
            let job = move |_: &Budget<'_>| parse(&body);
            self.service.run(call, job).await?.0
        };
        let named = message.robot_id();
        if !named.is_empty() && *named != id {
            let message = format!("{} is not the robot of the URL, {}", quoted(named), quoted(id));
            return Err(ServiceError::invalid(vec![Invalid::new("robot_id", message)]));
        }
        id.clone_into(named);
        Ok(message)
    }

    /// The longest request.
    pub(super) fn max_bytes(&self) -> usize {
        self.max_bytes
    }

    /// Refuses something that is longer.
    pub(super) fn too_large(&self, what: &str) -> ServiceError {
        let most = self.max_bytes;
        let message = format!("{what} is larger than the {most} bytes that `limits.max_request_bytes` allows");
        ServiceError::new(ErrorCode::TooLarge, message)
    }

    async fn body(&self, request: Request) -> Result<Bytes, ServiceError> {
        let too_large = || self.too_large("the body");
        let announced = hyper::body::Body::size_hint(request.body()).lower();
        if announced > u64::try_from(self.max_bytes).unwrap_or(u64::MAX) {
            return Err(too_large());
        }
        match Limited::new(request.into_body(), self.max_bytes).collect().await {
            Ok(body) => Ok(body.to_bytes()),
            Err(error) if error.is::<LengthLimitError>() => Err(too_large()),
            Err(error) => Err(ended_early(&*error)),
        }
    }

    /// Writes an answer.
    pub(super) async fn write<T>(&self, answer: Answer<T>, call: Call) -> Result<Response, ServiceError>
    where
        T: Serialize + Message + 'static,
    {
        let Answer { message, timing } = answer;
        let message = self.text_of(message, call).await?;
        Ok(written(Answer { message, timing }))
    }

    /// A message as text.
    pub(super) async fn text_of<T>(&self, message: T, call: Call) -> Result<Bytes, ServiceError>
    where
        T: Serialize + Message + 'static,
    {
        if message.encoded_len() <= SHORT_MESSAGE_BYTES {
            return json_text(&message);
        }
        let job = move |_: &Budget<'_>| json_text(&message);
        Ok(self.service.run(call, job).await?.0)
    }

    /// Writes an answer that is short or was read from the store.
    pub(super) fn write_now<T: Serialize>(&self, answer: &Answer<T>) -> Result<Response, ServiceError> {
        Ok(json_response(StatusCode::OK, json_text(&answer.message)?))
    }
}

/// Why a body could not be read to its end.
pub(super) fn ended_early(error: &(dyn std::error::Error + 'static)) -> ServiceError {
    // axum wraps what the body said.
    if let Some(status) = error.source().and_then(|said| said.downcast_ref::<tonic::Status>()) {
        return Error::from_status(status).into();
    }
    ServiceError::new(ErrorCode::InvalidRequest, format!("the body ended early: {error}"))
}

pub(super) fn check_query(request: &Request) -> Result<(), ServiceError> {
    let Some(query) = request.uri().query() else {
        return Ok(());
    };
    let message = format!("is not known here: {}", quoted(query));
    Err(ServiceError::invalid(vec![Invalid::new("?", message)]))
}

/// Checks what the body says that it is; the first kind is the one to name.
pub(super) fn check_kind(headers: &HeaderMap, kinds: &[&str]) -> Result<(), ServiceError> {
    let Some(kind) = headers.get(header::CONTENT_TYPE) else {
        return Ok(());
    };
    let text = kind.to_str().unwrap_or("");
    let essence = text.split(';').next().unwrap_or("").trim();
    if kinds.iter().any(|kind| essence.eq_ignore_ascii_case(kind)) {
        return Ok(());
    }
    let message = format!("{} is not {}", quoted(text), kinds.first().unwrap_or(&JSON));
    Err(ServiceError::invalid(vec![Invalid::new("content-type", message)]))
}

fn parse<T: DeserializeOwned>(body: &[u8]) -> Result<T, ServiceError> {
    if body.is_empty() {
        let message = "the body is empty, it must be a JSON object";
        return Err(ServiceError::new(ErrorCode::InvalidRequest, message));
    }
    serde_json::from_slice(body).map_err(|error| {
        let invalid = located::<T>(body, &error);
        if invalid.path.is_empty() {
            return ServiceError::new(ErrorCode::InvalidRequest, invalid.message);
        }
        ServiceError::invalid(vec![invalid])
    })
}

/// Where the body cannot be read: read again, noting the way.
fn located<T: DeserializeOwned>(body: &[u8], error: &serde_json::Error) -> Invalid {
    let mut reader = serde_json::Deserializer::from_slice(body);
    let path = match serde_path_to_error::deserialize::<_, T>(&mut reader) {
        Ok(_) => String::new(),
        Err(error) => error.path().to_string(),
    };
    // A place that has no name is that of the object around it.
    let path = path
        .strip_suffix('?')
        .map_or(&*path, |object| object.trim_end_matches('.'));
    let path = if path == "." { "" } else { path };
    let mut message = error.to_string();
    let mut path = path.to_owned();
    if let Some((name, _)) = message
        .strip_prefix("duplicate field `")
        .and_then(|rest| rest.split_once('`'))
    {
        let separator = if path.is_empty() { "" } else { "." };
        path = format!("{path}{separator}{name}");
    }
    if message.len() > LONGEST_MESSAGE {
        message.truncate(message.floor_char_boundary(LONGEST_MESSAGE));
        message.push('…');
        message = format!("{message} at line {} column {}", error.line(), error.column());
    }
    Invalid::new(path, message)
}

const LONGEST_MESSAGE: usize = 400;
