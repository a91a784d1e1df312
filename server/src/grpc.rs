//! The gRPC edge: decodes, calls the service, encodes.

use std::sync::Arc;

use async_trait::async_trait;
use axum::{Router, response::Response};
use futures::{Stream, StreamExt, stream::BoxStream};
use http::Uri;
use takt_proto::{
    DESCRIPTOR,
    convert::quoted,
    error::{Error, ErrorCode},
    v1::{
        self, drive_service_server::DriveServiceServer, dynamics_service_server::DynamicsServiceServer,
        plan_service_server::PlanServiceServer, robot_service_server::RobotServiceServer,
    },
};
use tonic::{Status, metadata::AsciiMetadataValue, server::NamedService, service::Routes};
use tonic_health::{pb::health_server::HealthServer, server::HealthService};

use crate::{
    edge::{Admission, SERVER_TIMING, server_timing},
    error::ServiceError,
    health::Health,
    service::{Answer, Arrived, Call, Incoming, Service},
    stream::Feed,
};

/// The services whose health can be asked for.
pub(crate) const SERVICES: [&str; 4] = [
    RobotServiceServer::<Handler>::NAME,
    PlanServiceServer::<Handler>::NAME,
    DynamicsServiceServer::<Handler>::NAME,
    DriveServiceServer::<Handler>::NAME,
];

/// Every gRPC service of the port.
pub(crate) fn router(
    service: Arc<Service>,
    health: &Health,
    max_request_bytes: usize,
) -> Result<Router, tonic_reflection::server::Error> {
    let handler = Arc::new(Handler(service));
    let robots = RobotServiceServer::from_arc(Arc::clone(&handler));
    let plans = PlanServiceServer::from_arc(Arc::clone(&handler));
    let dynamics = DynamicsServiceServer::from_arc(Arc::clone(&handler));
    let drives = DriveServiceServer::from_arc(handler);
    let reflection = || {
        tonic_reflection::server::Builder::configure()
            .register_encoded_file_descriptor_set(DESCRIPTOR)
            .register_encoded_file_descriptor_set(tonic_health::pb::FILE_DESCRIPTOR_SET)
    };
    let unknown = |uri: Uri| async move {
        let message = format!("there is no method {}", quoted(uri.path()));
        refuse(ServiceError::new(ErrorCode::Unimplemented, message))
    };
    let routes = Routes::from(Router::new().fallback(unknown))
        .add_service(robots.max_decoding_message_size(max_request_bytes))
        .add_service(plans.max_decoding_message_size(max_request_bytes))
        .add_service(dynamics.max_decoding_message_size(max_request_bytes))
        .add_service(drives.max_decoding_message_size(max_request_bytes))
        .add_service(HealthServer::new(HealthService::from_health_reporter(
            health.reporter(),
        )))
        .add_service(reflection().build_v1()?)
        .add_service(reflection().build_v1alpha()?);
    Ok(routes.into_axum_router())
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

/// The generated services' implementation.
#[derive(Debug)]
pub(crate) struct Handler(Arc<Service>);

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

/// The methods of one service: each hands its message on, with or without the call. Those that stream stand at the end.
macro_rules! methods {
    ($service:path { $($name:ident($request:ident) -> $response:ident $($call:ident)?;)* $({ $($rest:item)* })? }) => {
        #[async_trait]
        impl $service for Handler {
            $(async fn $name(
                &self,
                request: tonic::Request<v1::$request>,
            ) -> Result<tonic::Response<v1::$response>, Status> {
                $(let $call = call_of(&request)?;)?
                respond(self.0.$name($($call,)? request.into_inner()).await)
            })*

            $($($rest)*)?
        }
    };
}

methods!(v1::robot_service_server::RobotService {
    register_robot(RegisterRobotRequest) -> RegisterRobotResponse call;
    get_robot(GetRobotRequest) -> GetRobotResponse call;
    list_robots(ListRobotsRequest) -> ListRobotsResponse;
    list_revisions(ListRevisionsRequest) -> ListRevisionsResponse;
    delete_robot(DeleteRobotRequest) -> DeleteRobotResponse;
});

methods!(v1::plan_service_server::PlanService {
    plan_move(PlanMoveRequest) -> PlanMoveResponse call;
    plan_path(PlanPathRequest) -> PlanPathResponse call;
    check_trajectory(CheckTrajectoryRequest) -> CheckTrajectoryResponse call;
    {
        type PlanBatchStream = Pieces<v1::PlanBatchResponse>;
        type StreamSetpointsStream = Pieces<v1::StreamSetpointsResponse>;

        async fn plan_batch(
            &self,
            request: tonic::Request<tonic::Streaming<v1::PlanBatchRequest>>,
        ) -> Result<tonic::Response<Self::PlanBatchStream>, Status> {
            let (call, admission) = (call_of(&request)?, admission_of(&request)?);
            let requests = counted(request.into_inner());
            let requests = requests.map(|read| read.map(|(request, bytes)| Incoming { request: Ok(request), bytes }));
            Ok(respond_in_pieces(self.0.plan_batch(call, admission, requests)))
        }

        async fn stream_setpoints(
            &self,
            request: tonic::Request<v1::StreamSetpointsRequest>,
        ) -> Result<tonic::Response<Self::StreamSetpointsStream>, Status> {
            let (call, admission) = (call_of(&request)?, admission_of(&request)?);
            let feed = self.0.stream_setpoints(call, admission, request.into_inner()).await;
            Ok(respond_in_pieces(feed.map_err(status_of)?))
        }
    }
});

methods!(v1::dynamics_service_server::DynamicsService {
    inverse_dynamics(InverseDynamicsRequest) -> InverseDynamicsResponse call;
    forward_kinematics(ForwardKinematicsRequest) -> ForwardKinematicsResponse call;
    inverse_kinematics(InverseKinematicsRequest) -> InverseKinematicsResponse call;
});

methods!(v1::drive_service_server::DriveService {
    fit_drive(FitDriveRequest) -> FitDriveResponse call;
    rehearse(RehearseRequest) -> RehearseResponse call;
    {
        type EstimateFrictionStream = Pieces<v1::EstimateFrictionResponse>;

        async fn estimate_friction(
            &self,
            request: tonic::Request<tonic::Streaming<v1::EstimateFrictionRequest>>,
        ) -> Result<tonic::Response<Self::EstimateFrictionStream>, Status> {
            let (call, admission) = (call_of(&request)?, admission_of(&request)?);
            let arrivals = counted(request.into_inner());
            let arrivals = arrivals.map(|read| read.map(|(request, bytes)| Arrived { request: Ok(request), bytes }));
            let feed = self.0.estimate_friction(call, admission, arrivals).await;
            Ok(respond_in_pieces(feed.map_err(status_of)?))
        }
    }
});
