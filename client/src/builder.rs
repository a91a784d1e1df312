//! How a client is set up.

use std::{
    sync::{Arc, Mutex, atomic::AtomicUsize},
    time::Duration,
};

use http::Uri;

use crate::{
    client::{Client, Endpoint, Shared},
    connection,
    error::Error,
    retry::RetryPolicy,
};

/// Which of the two encodings travels. The calls are the same.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Transport {
    /// gRPC over HTTP/2: smaller, and one connection carries many calls at once.
    #[default]
    Grpc,
    /// JSON over HTTP/1.1: passes every proxy.
    Http,
}

/// Settings of a [`Client`].
///
/// ```
/// # fn main() -> Result<(), takt_client::Error> {
/// let client = takt_client::Client::builder()
///     .endpoint("http://10.0.0.1:7171")
///     .endpoint("http://10.0.0.2:7171")
///     .transport(takt_client::Transport::Http)
///     .build()?;
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
#[must_use = "a builder does nothing until it is built"]
pub struct Builder {
    endpoints: Vec<String>,
    transport: Transport,
    deadline: Duration,
    connect_timeout: Duration,
    retry: RetryPolicy,
    max_reply_bytes: usize,
}

impl Default for Builder {
    fn default() -> Self {
        Self {
            endpoints: Vec::new(),
            transport: Transport::default(),
            deadline: Duration::from_secs(30),
            connect_timeout: Duration::from_secs(2),
            retry: RetryPolicy::default(),
            max_reply_bytes: 64 << 20,
        }
    }
}

impl Builder {
    /// Adds a server, as in `http://127.0.0.1:7171`. Several are taken in turn.
    pub fn endpoint(mut self, url: impl Into<String>) -> Self {
        self.endpoints.push(url.into());
        self
    }

    /// Which encoding travels. Default: gRPC.
    pub fn transport(mut self, transport: Transport) -> Self {
        self.transport = transport;
        self
    }

    /// Time for a call with all its tries; the server is told what is left of it. Default: 30 s.
    pub fn deadline(mut self, deadline: Duration) -> Self {
        self.deadline = deadline;
        self
    }

    /// Time for one connection to be made. Default: 2 s.
    pub fn connect_timeout(mut self, timeout: Duration) -> Self {
        self.connect_timeout = timeout;
        self
    }

    /// How often and how patiently calls are tried again.
    pub fn retry(mut self, policy: RetryPolicy) -> Self {
        self.retry = policy;
        self
    }

    /// The largest reply that is read. Default: 64 MiB.
    pub fn max_reply_bytes(mut self, bytes: usize) -> Self {
        self.max_reply_bytes = bytes;
        self
    }

    /// Makes the client. Connects to nothing yet: the first call does.
    ///
    /// # Errors
    ///
    /// No endpoint, one that is no `http://host:port`, or a deadline of zero.
    pub fn build(self) -> Result<Client, Error> {
        if self.endpoints.is_empty() {
            return Err(Error::refused(
                "endpoint",
                "at least one is needed, such as http://127.0.0.1:7171",
            ));
        }
        if self.deadline.is_zero() {
            return Err(Error::refused("deadline", "must be longer than zero"));
        }
        let endpoints = self
            .endpoints
            .iter()
            .map(|url| endpoint(url))
            .collect::<Result<_, _>>()?;
        let http1 = connection::http1(self.connect_timeout)
            .map_err(|error| Error::refused("transport", format!("HTTP cannot be set up: {error}")))?;
        Ok(Client {
            deadline: self.deadline,
            shared: Arc::new(Shared {
                endpoints,
                turn: AtomicUsize::new(0),
                transport: self.transport,
                retry: self.retry,
                max_reply_bytes: self.max_reply_bytes,
                http2: connection::http2(self.connect_timeout),
                http1,
            }),
        })
    }
}

fn endpoint(url: &str) -> Result<Endpoint, Error> {
    let wrong = |why: &str| Error::refused("endpoint", format!("{url:?} {why}"));
    let uri: Uri = url
        .trim_end_matches('/')
        .parse()
        .map_err(|_| wrong("is no URL such as http://127.0.0.1:7171"))?;
    match uri.scheme_str() {
        Some("http") => {}
        Some("https") => {
            return Err(wrong("asks for TLS, which this client does not speak yet; use http://"));
        }
        _ => return Err(wrong("must begin with http://")),
    }
    if uri.authority().is_none_or(|authority| authority.host().is_empty()) {
        return Err(wrong("names no host"));
    }
    if uri.path() != "/" || uri.query().is_some() {
        return Err(wrong("must end after the port"));
    }
    Ok(Endpoint {
        name: url.trim_end_matches('/').to_owned(),
        uri,
        failed_at: Mutex::new(None),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn endpoints_that_cannot_be_are_refused_with_the_reason() {
        for (url, reason) in [
            ("127.0.0.1:7171", "http://"),
            ("https://host:1", "TLS"),
            ("http://host:1/v1", "after the port"),
            ("nonsense nonsense", "no URL"),
            ("ftp://host", "http://"),
        ] {
            let error = Client::builder().endpoint(url).build().unwrap_err();
            assert!(error.message().contains(reason), "{url}: {error}");
        }
        assert!(Client::builder().build().is_err());
        assert!(
            Client::builder()
                .endpoint("http://h")
                .deadline(Duration::ZERO)
                .build()
                .is_err()
        );
    }
}
