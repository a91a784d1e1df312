//! The gRPC transport.

use std::{error::Error as _, time::Duration};

use http::{Uri, uri::PathAndQuery};
use tonic::{
    Request, Status,
    client::Grpc,
    metadata::{Ascii, MetadataValue},
};
use tonic_prost::ProstCodec;
use tonic_types::StatusExt;

use crate::{
    connection::{self, Pool},
    error::{Code, Error, FieldViolation},
    rpc::Rpc,
};

/// Sends one request to one endpoint.
pub(crate) async fn send<R: Rpc>(
    pool: &Pool,
    endpoint: &Uri,
    request: R::Request,
    left: Duration,
    max_reply_bytes: usize,
) -> Result<R::Response, Error> {
    let mut grpc = Grpc::with_origin(pool.clone(), endpoint.clone())
        .max_decoding_message_size(max_reply_bytes)
        .max_encoding_message_size(usize::MAX);
    let mut request = Request::new(request);
    if let Ok(value) = MetadataValue::<Ascii>::try_from(connection::timeout_header(left)) {
        request.metadata_mut().insert("grpc-timeout", value);
    }
    grpc.ready().await.map_err(|error| broken(&error))?;
    let path = PathAndQuery::from_static(R::GRPC_PATH);
    let codec = ProstCodec::<R::Request, R::Response>::default();
    match grpc.unary(request, path, codec).await {
        Ok(reply) => Ok(reply.into_inner()),
        Err(status) => Err(from_status(&status)),
    }
}

fn broken(error: &(dyn std::error::Error + 'static)) -> Error {
    let (message, unsent) = connection::describe(error);
    let error = Error::transport(message.clone(), message);
    if unsent { error.unsent() } else { error }
}

/// A status with a source was made on this side: the exchange failed. One without came from the server.
fn from_status(status: &Status) -> Error {
    if let Some(source) = status.source() {
        return broken(source);
    }
    let details = status.get_error_details();
    let violations = details.bad_request().map_or_else(Vec::new, |bad| {
        bad.field_violations
            .iter()
            .map(|violation| FieldViolation {
                field: violation.field.clone(),
                description: violation.description.clone(),
            })
            .collect()
    });
    let retry_after = details.retry_info().and_then(|info| info.retry_delay);
    let more = details
        .error_info()
        .map(|info| info.metadata.clone().into_iter().collect())
        .unwrap_or_default();
    let message = match status.message() {
        "" => status.code().description(),
        message => message,
    };
    Error::answered(Code::from_grpc(i32::from(status.code())), message)
        .with_violations(violations)
        .with_retry_after(retry_after)
        .with_details(more)
}
