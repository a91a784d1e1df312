//! A real server in this process, on a free port.

use std::net::SocketAddr;

use takt_client::{Client, Code, RetryPolicy, Transport};
use takt_server::{Config, Limits, Server};
use tokio::{sync::oneshot, task::JoinHandle};

use crate::{Protocol, fixtures::good_move, grpc, http};

/// A server that stops when it is told to, or with the test.
#[derive(Debug)]
pub struct TestServer {
    address: SocketAddr,
    stop: Option<oneshot::Sender<()>>,
    task: JoinHandle<()>,
}

impl TestServer {
    /// A server with the example robots and nothing else out of the ordinary.
    pub async fn start() -> Self {
        Self::with(Config {
            examples: true,
            ..Config::default()
        })
        .await
    }

    /// A server with a configuration.
    pub async fn with(config: Config) -> Self {
        let server = Server::bind(config).await.expect("the configuration is right");
        let address = server.local_addr();
        let (stop, stopped) = oneshot::channel();
        let running = server.run(async {
            // A test that is gone means the same.
            let _ = stopped.await;
        });
        Self {
            address,
            stop: Some(stop),
            task: tokio::spawn(running),
        }
    }

    /// A server of the examples with room for so many requests, and so much patience with a stream that stands still.
    pub async fn narrow(max_concurrent_requests: usize, stream_idle_s: f64) -> Self {
        Self::with(Config {
            examples: true,
            limits: Limits {
                max_concurrent_requests,
                stream_idle_s,
                ..Limits::default()
            },
            ..Config::default()
        })
        .await
    }

    /// Waits until there is room for a request.
    pub async fn until_there_is_room(&self) {
        let client = self.client(Protocol::Grpc);
        while let Err(error) = client.plan_move(good_move()).await {
            assert_eq!(error.code(), Code::Overloaded, "{error}");
            tokio::task::yield_now().await;
        }
    }

    /// Where it listens.
    #[must_use]
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// Asks it to stop.
    pub fn stop(&mut self) {
        if let Some(stop) = self.stop.take() {
            // A server that has ended needs no asking.
            let _ = stop.send(());
        }
    }

    /// Waits for its end.
    pub async fn ended(mut self) {
        self.stop();
        self.task.await.expect("the server ends by itself");
    }

    /// The project's own client, without second tries.
    #[must_use]
    pub fn client(&self, protocol: Protocol) -> Client {
        let transport = match protocol {
            Protocol::Grpc => Transport::Grpc,
            Protocol::Http => Transport::Http,
        };
        let builder = Client::builder().endpoint(format!("http://{}", self.address));
        let builder = builder.transport(transport).retry(RetryPolicy::none());
        builder.build().expect("the address is one")
    }

    /// A bare HTTP/1.1 connection.
    pub async fn http(&self) -> http::Connection {
        http::Connection::open(self.address).await
    }

    /// A bare gRPC connection, made by its first call.
    #[must_use]
    pub fn grpc(&self) -> grpc::Connection {
        grpc::Connection::to(self.address)
    }
}
