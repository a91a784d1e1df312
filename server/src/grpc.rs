//! The gRPC edge: decodes, calls the service, encodes.

use std::sync::Arc;

use axum::{Router, response::Response};
use bytes::Bytes;
use futures::{Stream, StreamExt, stream::BoxStream};
use http::Uri;
use takt_proto::{
    DESCRIPTOR,
    codec::{Codec, Encoded},
    convert::quoted,
    error::{Error, ErrorCode},
    route::{self, Rpc},
    v1,
};
use tonic::{Status, metadata::AsciiMetadataValue, service::Routes};
use tonic_health::{pb::health_server::HealthServer, server::HealthService};
use tower::{Service as _, service_fn};

use crate::{
    body::Incoming as Body,
    edge::{Admission, SERVER_TIMING, server_timing},
    error::ServiceError,
    form::{Form as _, Protobuf},
    health::Health,
    service::{Answer, Arrived, Call, Incoming, Service},
    stream::Feed,
};

/// The services whose health can be asked for.
pub(crate) const SERVICES: [&str; 4] = [
    v1::robot_service_server::SERVICE_NAME,
    v1::plan_service_server::SERVICE_NAME,
    v1::dynamics_service_server::SERVICE_NAME,
    v1::drive_service_server::SERVICE_NAME,
];

/// Every gRPC service of the port.
#[derive(Debug)]
pub(crate) struct Grpc {
    service: Arc<Service>,
    max_request_bytes: usize,
    /// Health and reflection, and what is not there.
    others: Router,
}

impl Grpc {
    pub(crate) fn new(
        service: Arc<Service>,
        health: &Health,
        max_request_bytes: usize,
    ) -> Result<Self, tonic_reflection::server::Error> {
        let reflection = || {
            tonic_reflection::server::Builder::configure()
                .register_encoded_file_descriptor_set(DESCRIPTOR)
                .register_encoded_file_descriptor_set(tonic_health::pb::FILE_DESCRIPTOR_SET)
        };
        let unknown = |uri: Uri| async move {
            let message = format!("there is no method {}", quoted(uri.path()));
            refuse(ServiceError::new(ErrorCode::Unimplemented, message))
        };
        let others = Routes::from(Router::new().fallback(unknown))
            .add_service(HealthServer::new(HealthService::from_health_reporter(
                health.reporter(),
            )))
            .add_service(reflection().build_v1()?)
            .add_service(reflection().build_v1alpha()?);
        Ok(Self {
            service,
            max_request_bytes,
            others: others.into_axum_router(),
        })
    }

    /// Answers one request.
    pub(crate) async fn answer(&self, request: http::Request<Body>) -> Response {
        let Some(rpc) = route::find_rpc(request.uri().path()) else {
            let Ok(response) = self.others.clone().call(request).await;
            return response;
        };
        let service = &self.service;
        let answered = match rpc {
            Rpc::RegisterRobot => {
                let method = |call, message| async move { encoded(service.register_robot(call, message).await) };
                self.unary(request, method).await
            }
            Rpc::GetRobot => {
                let method = |call, message| async move { encoded(service.get_robot(call, message).await) };
                self.unary(request, method).await
            }
            Rpc::ListRobots => {
                let method = |_, message| async move { encoded(service.list_robots(message).await) };
                self.unary(request, method).await
            }
            Rpc::ListRevisions => {
                let method = |_, message| async move { encoded(service.list_revisions(message).await) };
                self.unary(request, method).await
            }
            Rpc::DeleteRobot => {
                let method = |_, message| async move { encoded(service.delete_robot(message).await) };
                self.unary(request, method).await
            }
            Rpc::PlanMove => {
                let method = |call, message| service.plan_move::<Protobuf>(call, message);
                self.unary(request, method).await
            }
            Rpc::PlanPath => {
                let method = |call, message| service.plan_path::<Protobuf>(call, message);
                self.unary(request, method).await
            }
            Rpc::CheckTrajectory => {
                let method = |call, message| service.check_trajectory::<Protobuf>(call, message);
                self.unary(request, method).await
            }
            Rpc::InverseDynamics => {
                let method = |call, message| service.inverse_dynamics::<Protobuf>(call, message);
                self.unary(request, method).await
            }
            Rpc::ForwardKinematics => {
                let method = |call, message| service.forward_kinematics::<Protobuf>(call, message);
                self.unary(request, method).await
            }
            Rpc::InverseKinematics => {
                let method = |call, message| service.inverse_kinematics::<Protobuf>(call, message);
                self.unary(request, method).await
            }
            Rpc::FitDrive => {
                let method = |call, message| service.fit_drive::<Protobuf>(call, message);
                self.unary(request, method).await
            }
            Rpc::Rehearse => {
                let method = |call, message| service.rehearse::<Protobuf>(call, message);
                self.unary(request, method).await
            }
            Rpc::EstimateFriction => self.estimate_friction(request).await,
            Rpc::PlanBatch => self.plan_batch(request).await,
            Rpc::StreamSetpoints => self.stream_setpoints(request).await,
        };
        answered.map(axum::body::Body::new)
    }

    /// A method of one message and one answer.
    async fn unary<M, F>(
        &self,
        request: http::Request<Body>,
        method: impl Fn(Call, M) -> F,
    ) -> http::Response<tonic::body::Body>
    where
        M: prost::Message + Default + Send + 'static,
        F: Future<Output = Result<Answer<Bytes>, ServiceError>>,
    {
        let method = service_fn(|request: tonic::Request<M>| {
            let method = &method;
            async move {
                let call = call_of(&request)?;
                respond(method(call, request.into_inner()).await)
            }
        });
        let mut grpc = tonic::server::Grpc::new(Encoded::default()).max_decoding_message_size(self.max_request_bytes);
        grpc.unary(method, request).await
    }

    async fn plan_batch(&self, request: http::Request<Body>) -> http::Response<tonic::body::Body> {
        let method = service_fn(
            |request: tonic::Request<tonic::Streaming<v1::PlanBatchRequest>>| async move {
                let (call, admission) = (call_of(&request)?, admission_of(&request)?);
                let requests = counted(request.into_inner()).map(|read| {
                    let (request, bytes) = read?;
                    Ok(Incoming {
                        request: Ok(request),
                        bytes,
                    })
                });
                Ok(respond_in_pieces(self.service.plan_batch(call, admission, requests)))
            },
        );
        let mut grpc = tonic::server::Grpc::new(Codec::default()).max_decoding_message_size(self.max_request_bytes);
        grpc.streaming(method, request).await
    }

    async fn estimate_friction(&self, request: http::Request<Body>) -> http::Response<tonic::body::Body> {
        let method = service_fn(
            |request: tonic::Request<tonic::Streaming<v1::EstimateFrictionRequest>>| async move {
                let (call, admission) = (call_of(&request)?, admission_of(&request)?);
                let arrivals = counted(request.into_inner()).map(|read| {
                    let (request, bytes) = read?;
                    Ok(Arrived {
                        request: Ok(request),
                        bytes,
                    })
                });
                let feed = self.service.estimate_friction(call, admission, arrivals).await;
                Ok(respond_in_pieces(feed.map_err(status_of)?))
            },
        );
        let mut grpc = tonic::server::Grpc::new(Codec::default()).max_decoding_message_size(self.max_request_bytes);
        grpc.streaming(method, request).await
    }

    async fn stream_setpoints(&self, request: http::Request<Body>) -> http::Response<tonic::body::Body> {
        let method = service_fn(|request: tonic::Request<v1::StreamSetpointsRequest>| async move {
            let (call, admission) = (call_of(&request)?, admission_of(&request)?);
            let feed = self.service.stream_setpoints(call, admission, request.into_inner());
            Ok(respond_in_pieces(feed.await.map_err(status_of)?))
        });
        let mut grpc = tonic::server::Grpc::new(Codec::default()).max_decoding_message_size(self.max_request_bytes);
        grpc.server_streaming(method, request).await
    }
}

/// An answer that is short or was read from the store, written where it is.
fn encoded<M: prost::Message>(answer: Result<Answer<M>, ServiceError>) -> Result<Answer<Bytes>, ServiceError> {
    let Answer { message, timing } = answer?;
    let message = Protobuf::write(message)?;
    Ok(Answer { message, timing })
}

/// An error without a message: the status is all there is.
pub(crate) fn refuse(error: ServiceError) -> Response {
    status_of(error).into_http()
}

/// The status, with the error itself for the log.
fn status_of(error: ServiceError) -> Status {
    let mut status = error.wire().to_status();
    status.set_source(Arc::new(error));
    status
}

fn call_of<T>(request: &tonic::Request<T>) -> Result<Call, Status> {
    let call = request.extensions().get::<Call>().copied();
    call.ok_or_else(|| Status::internal("the request has no deadline"))
}

/// What stands before every message: whether it is compressed, and its length.
const FRAME_HEAD_BYTES: usize = 5;

fn admission_of<T>(request: &tonic::Request<T>) -> Result<Admission, Status> {
    let admission = request.extensions().get::<Admission>().cloned();
    admission.ok_or_else(|| Status::internal("the request has no place among those in work"))
}

/// Messages as they come in, and what they hold of the call's bytes.
fn counted<T: prost::Message>(
    messages: tonic::Streaming<T>,
) -> impl Stream<Item = Result<(T, usize), ServiceError>> + Send {
    messages.map(|message| {
        let message = message.map_err(|status| ServiceError::from(Error::from_status(&status)))?;
        let bytes = FRAME_HEAD_BYTES + message.encoded_len();
        Ok((message, bytes))
    })
}

/// Pieces on their way out.
type Pieces<T> = BoxStream<'static, Result<T, Status>>;

fn respond_in_pieces<T: Send + 'static>(feed: Feed<T>) -> tonic::Response<Pieces<T>> {
    tonic::Response::new(feed.map(|piece| piece.map_err(status_of)).boxed())
}

fn respond<T>(answer: Result<Answer<T>, ServiceError>) -> Result<tonic::Response<T>, Status> {
    match answer {
        Ok(answer) => {
            let mut response = tonic::Response::new(answer.message);
            let timing = AsciiMetadataValue::try_from(server_timing(answer.timing));
            if let Ok(timing) = timing {
                response.metadata_mut().insert(SERVER_TIMING, timing);
            }
            Ok(response)
        }
        Err(error) => Err(status_of(error)),
    }
}
