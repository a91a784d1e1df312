//! The gRPC transport.

use std::{error::Error as _, time::Duration};

use futures::Stream;
use http::{Uri, uri::PathAndQuery};
use takt_proto::error as wire;
use tonic::{
    Request, Status,
    client::Grpc,
    metadata::{Ascii, MetadataValue},
};
use tonic_prost::ProstCodec;

use crate::{
    connection::{self, Http2},
    error::Error,
    rpc::{self, Rpc},
    stream::Pieces,
};

/// Sends one request to one endpoint.
pub(crate) async fn send<R: Rpc>(
    pool: &Http2,
    endpoint: &Uri,
    request: R::Request,
    left: Duration,
    max_reply_bytes: usize,
) -> Result<R::Response, Error> {
    let mut grpc = grpc(pool, endpoint, max_reply_bytes);
    let mut request = Request::new(request);
    if let Ok(value) = MetadataValue::<Ascii>::try_from(connection::grpc_timeout(left)) {
        request.metadata_mut().insert("grpc-timeout", value);
    }
    grpc.ready().await.map_err(|error| broken(&error))?;
    let path =
        PathAndQuery::try_from(rpc::grpc_path::<R>()).map_err(|error| Error::refused("request", error.to_string()))?;
    let codec = ProstCodec::<R::Request, R::Response>::default();
    match grpc.unary(request, path, codec).await {
        Ok(reply) => Ok(reply.into_inner()),
        Err(status) => Err(from_status(&status)),
    }
}

/// Begins a stream. Its time is the caller's own: a deadline of gRPC would bound the whole of it.
pub(crate) async fn open<R: Rpc>(
    pool: &Http2,
    endpoint: &Uri,
    requests: impl Stream<Item = R::Request> + Send + 'static,
    max_reply_bytes: usize,
) -> Result<Pieces<R::Response>, Error> {
    let mut grpc = grpc(pool, endpoint, max_reply_bytes);
    grpc.ready().await.map_err(|error| broken(&error))?;
    let path =
        PathAndQuery::try_from(rpc::grpc_path::<R>()).map_err(|error| Error::refused("request", error.to_string()))?;
    let codec = ProstCodec::<R::Request, R::Response>::default();
    match grpc.streaming(Request::new(requests), path, codec).await {
        Ok(reply) => Ok(Pieces::Grpc(Box::new(reply.into_inner()))),
        Err(status) => Err(from_status(&status)),
    }
}

fn grpc(pool: &Http2, endpoint: &Uri, max_reply_bytes: usize) -> Grpc<Http2> {
    Grpc::with_origin(pool.clone(), endpoint.clone())
        .max_decoding_message_size(max_reply_bytes)
        .max_encoding_message_size(usize::MAX)
}

fn broken(error: &(dyn std::error::Error + 'static)) -> Error {
    let (message, unsent) = connection::describe(error);
    let error = Error::transport(message.clone(), message);
    if unsent { error.unsent() } else { error }
}

/// A status with a source was made on this side: the exchange failed. One without came from the server.
pub(crate) fn from_status(status: &Status) -> Error {
    if let Some(source) = status.source() {
        return broken(source);
    }
    let mut error = wire::Error::from_status(status);
    if error.message.is_empty() {
        status.code().description().clone_into(&mut error.message);
    }
    Error::from_wire(error)
}
