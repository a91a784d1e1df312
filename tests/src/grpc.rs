//! gRPC by the byte: what is sent need not be a message.

use std::net::SocketAddr;

use bytes::{Buf, BufMut, Bytes};
use http::Uri;
use hyper_util::{
    client::legacy::{self, connect::HttpConnector},
    rt::TokioExecutor,
};
use tonic::{
    Request, Response, Status,
    client::Grpc,
    codec::{Codec, DecodeBuf, Decoder, EncodeBuf, Encoder},
    metadata::MetadataValue,
};

/// A client of HTTP/2 that adds nothing: tonic's own channel ends calls by a deadline of its own.
pub type Http2 = legacy::Client<HttpConnector, tonic::body::Body>;

/// One HTTP/2 connection.
#[derive(Debug, Clone)]
pub struct Connection {
    http2: Http2,
    origin: Uri,
}

impl Connection {
    pub(crate) fn to(address: SocketAddr) -> Self {
        Self {
            http2: legacy::Client::builder(TokioExecutor::new())
                .http2_only(true)
                .build(HttpConnector::new()),
            origin: format!("http://{address}").parse().expect("an address is a URL"),
        }
    }

    /// For the generated clients: what they call, and where it is.
    #[must_use]
    pub fn parts(&self) -> (Http2, Uri) {
        (self.http2.clone(), self.origin.clone())
    }

    /// Sends these bytes as a message to the method at `path`, and returns the bytes of the answer.
    ///
    /// # Errors
    /// The status, where it is not OK.
    pub async fn unary(&self, path: &str, message: impl Into<Bytes>) -> Result<Bytes, Status> {
        let answer = self.send(path, Request::new(message.into())).await?;
        Ok(answer.into_inner())
    }

    /// The same with a deadline that the server is told, and nobody else.
    ///
    /// # Errors
    /// The status, where it is not OK.
    pub async fn within(&self, timeout: &'static str, path: &str, message: Vec<u8>) -> Result<Bytes, Status> {
        let mut request = Request::new(message.into());
        request
            .metadata_mut()
            .insert("grpc-timeout", MetadataValue::from_static(timeout));
        Ok(self.send(path, request).await?.into_inner())
    }

    /// Sends a message with its metadata.
    ///
    /// # Errors
    /// The status, where it is not OK.
    pub async fn send(&self, path: &str, request: Request<Bytes>) -> Result<Response<Bytes>, Status> {
        let (http2, origin) = self.parts();
        let mut grpc = Grpc::with_origin(http2, origin).max_decoding_message_size(usize::MAX);
        let ready = grpc.ready().await;
        ready.map_err(|error| Status::unavailable(format!("no connection: {error}")))?;
        let path = path.parse().expect("the path is one");
        grpc.unary(request, path, Raw).await
    }
}

/// Hands bytes through.
#[derive(Debug, Clone, Copy)]
struct Raw;

impl Codec for Raw {
    type Encode = Bytes;
    type Decode = Bytes;
    type Encoder = Self;
    type Decoder = Self;

    fn encoder(&mut self) -> Self {
        Self
    }

    fn decoder(&mut self) -> Self {
        Self
    }
}

impl Encoder for Raw {
    type Item = Bytes;
    type Error = Status;

    fn encode(&mut self, item: Bytes, buffer: &mut EncodeBuf<'_>) -> Result<(), Status> {
        buffer.put(item);
        Ok(())
    }
}

impl Decoder for Raw {
    type Item = Bytes;
    type Error = Status;

    fn decode(&mut self, buffer: &mut DecodeBuf<'_>) -> Result<Option<Bytes>, Status> {
        Ok(Some(buffer.copy_to_bytes(buffer.remaining())))
    }
}
