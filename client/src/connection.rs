//! The connections of both transports: pooled, kept alive, and given up when the peer is dead.

use std::time::Duration;

use hyper_util::{
    client::legacy::{self, connect::HttpConnector},
    rt::{TokioExecutor, TokioTimer},
};
use tonic::body::Body;

/// A pool of HTTP/2 connections to any number of endpoints, for gRPC.
pub(crate) type Http2 = legacy::Client<HttpConnector, Body>;

/// How often a quiet connection is asked for a sign of life, and how long the sign may take.
const KEEP_ALIVE_INTERVAL: Duration = Duration::from_secs(5);
const KEEP_ALIVE_TIMEOUT: Duration = Duration::from_secs(3);
/// How long sent data may stay without acknowledgement before the connection counts as dead.
const UNACKNOWLEDGED_TIMEOUT: Duration = Duration::from_secs(8);
/// How long an unused connection is kept.
const IDLE_TIMEOUT: Duration = Duration::from_secs(90);
/// Room for long trajectories to come in without waiting for window updates.
const STREAM_WINDOW: u32 = 1 << 20;
const CONNECTION_WINDOW: u32 = 4 << 20;

fn connector(connect_timeout: Duration) -> HttpConnector {
    let mut connector = HttpConnector::new();
    connector.set_nodelay(true);
    connector.set_connect_timeout(Some(connect_timeout));
    connector.set_keepalive(Some(KEEP_ALIVE_INTERVAL));
    connector.set_keepalive_interval(Some(KEEP_ALIVE_TIMEOUT));
    #[cfg(any(target_os = "android", target_os = "fuchsia", target_os = "linux"))]
    connector.set_tcp_user_timeout(Some(UNACKNOWLEDGED_TIMEOUT));
    connector
}

/// HTTP/2 without negotiation, as gRPC wants it.
pub(crate) fn http2(connect_timeout: Duration) -> Http2 {
    legacy::Client::builder(TokioExecutor::new())
        .timer(TokioTimer::new())
        .pool_timer(TokioTimer::new())
        .pool_idle_timeout(IDLE_TIMEOUT)
        .http2_only(true)
        .http2_keep_alive_interval(KEEP_ALIVE_INTERVAL)
        .http2_keep_alive_timeout(KEEP_ALIVE_TIMEOUT)
        // A peer that died between two calls must not cost the second one its deadline.
        .http2_keep_alive_while_idle(true)
        .http2_initial_stream_window_size(STREAM_WINDOW)
        .http2_initial_connection_window_size(CONNECTION_WINDOW)
        .build(connector(connect_timeout))
}

/// HTTP/1.1, which every proxy and every debugging tool understands.
pub(crate) fn http1(connect_timeout: Duration) -> reqwest::Result<reqwest::Client> {
    let builder = reqwest::Client::builder()
        .http1_only()
        .redirect(reqwest::redirect::Policy::none())
        .connect_timeout(connect_timeout)
        .tcp_nodelay(true)
        .tcp_keepalive(KEEP_ALIVE_INTERVAL)
        .tcp_keepalive_interval(KEEP_ALIVE_TIMEOUT)
        .pool_idle_timeout(IDLE_TIMEOUT);
    #[cfg(any(target_os = "android", target_os = "fuchsia", target_os = "linux"))]
    let builder = builder.tcp_user_timeout(UNACKNOWLEDGED_TIMEOUT);
    builder.build()
}

/// The value of the header `grpc-timeout`: at most eight digits and a unit.
pub(crate) fn grpc_timeout(left: Duration) -> String {
    const MOST: u128 = 99_999_999;
    if left.as_micros() <= MOST {
        format!("{}u", left.as_micros())
    } else if left.as_millis() <= MOST {
        format!("{}m", left.as_millis())
    } else {
        format!("{}S", u128::from(left.as_secs()).min(MOST))
    }
}

/// The same for HTTP: seconds.
pub(crate) fn request_timeout(left: Duration) -> String {
    format!("{:.6}", left.as_secs_f64())
}

/// A sentence for a failed exchange, and whether the request certainly never left.
pub(crate) fn describe(error: &(dyn std::error::Error + 'static)) -> (String, bool) {
    let mut unsent = false;
    let mut cause = error;
    loop {
        if let Some(error) = cause.downcast_ref::<legacy::Error>() {
            unsent |= error.is_connect();
        }
        if let Some(error) = cause.downcast_ref::<reqwest::Error>() {
            unsent |= error.is_connect();
        }
        match cause.source() {
            Some(next) => cause = next,
            None => break,
        }
    }
    let what = if unsent {
        "cannot connect"
    } else {
        "the connection broke"
    };
    (format!("{what}: {cause}"), unsent)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn timeouts_have_at_most_eight_digits() {
        assert_eq!(grpc_timeout(Duration::from_millis(1500)), "1500000u");
        assert_eq!(grpc_timeout(Duration::from_micros(99_999_999)), "99999999u");
        assert_eq!(grpc_timeout(Duration::from_secs(100)), "100000m");
        assert_eq!(grpc_timeout(Duration::from_secs(100_000)), "100000S");
        assert_eq!(grpc_timeout(Duration::MAX), "99999999S");
    }
}
