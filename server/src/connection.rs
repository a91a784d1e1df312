//! One connection: which protocol it speaks, and how long it may keep us waiting.

mod turn;

use std::{convert::Infallible, io, sync::Arc, time::Duration};

use axum::response::Response;
use http::Request;
use hyper::body::Incoming;
use hyper_util::{
    rt::{TokioExecutor, TokioIo, TokioTimer},
    server::{conn::auto, graceful::Watcher},
};
use tokio::{net::TcpStream, sync::OwnedSemaphorePermit};

use self::turn::AfterOthers;
use crate::{config::ConnectionConfig, edge::Edge};

/// The first bytes of an HTTP/2 connection.
const PREFACE: &[u8; 24] = b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n";

/// How often a connection is looked at again that has sent the first bytes of the preface and not the rest.
const PREFACE_POLL: Duration = Duration::from_millis(10);

/// Serves connections.
#[derive(Debug)]
pub(crate) struct Connections {
    edge: Arc<Edge>,
    config: ConnectionConfig,
    protocol: auto::Builder<TokioExecutor>,
}

impl Connections {
    pub(crate) fn new(edge: Arc<Edge>, config: ConnectionConfig) -> Self {
        let seconds = Duration::from_secs_f64;
        let mut protocol = auto::Builder::new(TokioExecutor::new());
        protocol
            .http1()
            .timer(TokioTimer::new())
            .header_read_timeout(seconds(config.header_timeout_s));
        protocol
            .http2()
            .timer(TokioTimer::new())
            .keep_alive_interval(seconds(config.keep_alive_s))
            .keep_alive_timeout(seconds(config.keep_alive_s))
            .max_concurrent_streams(config.max_concurrent_streams)
            .max_send_buf_size(config.max_send_buffer_bytes);
        Self { edge, config, protocol }
    }

    /// Serves one connection to its end, or until `watcher` asks to end it.
    pub(crate) async fn serve(self: Arc<Self>, stream: TcpStream, place: OwnedSemaphorePermit, watcher: Watcher) {
        let _place = place;
        if let Err(error) = self.prepare(&stream) {
            tracing::debug!(%error, "connection could not be set up");
            return;
        }
        let detection = Duration::from_secs_f64(self.config.detect_timeout_s);
        let Ok(Ok(Some(protocol))) = tokio::time::timeout(detection, detected(&stream)).await else {
            return;
        };
        let edge = Arc::clone(&self.edge);
        let service = hyper::service::service_fn(move |request: Request<Incoming>| {
            let edge = Arc::clone(&edge);
            // On the heap: what follows moves the future several times, and it is kilobytes long.
            Box::pin(async move { Ok::<Response, Infallible>(edge.handle(request).await) })
        });
        let connection = self.protocol.serve_connection(TokioIo::new(stream), service);
        let connection = watcher.watch(connection.into_owned());
        let ended = match protocol {
            Protocol::Http1 => connection.await,
            Protocol::Http2 => AfterOthers::new(connection).await,
        };
        if let Err(error) = ended {
            tracing::debug!(error = %error, "connection ended");
        }
    }

    fn prepare(&self, stream: &TcpStream) -> io::Result<()> {
        stream.set_nodelay(true)?;
        #[cfg(any(target_os = "linux", target_os = "android"))]
        {
            let timeout = Duration::from_secs_f64(self.config.unacknowledged_timeout_s);
            socket2::SockRef::from(stream).set_tcp_user_timeout(Some(timeout))?;
        }
        Ok(())
    }
}

/// What a connection's first bytes say.
#[derive(Debug, Clone, Copy)]
enum Protocol {
    /// One request after the other.
    Http1,
    /// Many at once.
    Http2,
}

/// Waits for the bytes that tell the protocol; none: the peer closed first. They stay to be read.
async fn detected(stream: &TcpStream) -> io::Result<Option<Protocol>> {
    let mut first = [0; PREFACE.len()];
    loop {
        let count = stream.peek(&mut first).await?;
        if count == 0 {
            return Ok(None);
        }
        if first[..count] != PREFACE[..count] {
            return Ok(Some(Protocol::Http1));
        }
        if count == PREFACE.len() {
            return Ok(Some(Protocol::Http2));
        }
        tokio::time::sleep(PREFACE_POLL).await;
    }
}
