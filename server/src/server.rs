//! The server: bind, say where, run until asked to stop.

use std::{
    future::Future,
    io,
    net::{Ipv4Addr, SocketAddr},
    sync::Arc,
    time::Duration,
};

use hyper_util::server::graceful::GracefulShutdown;
use tokio::{net::TcpListener, sync::Semaphore, task::JoinSet};

use crate::{
    config::{Config, ConfigError, DrainConfig, StoreConfig},
    connection::Connections,
    edge::Edge,
    examples,
    health::Health,
    planner::Pool,
    registry::{
        Registry,
        memory::Memory,
        sqlite::Sqlite,
        store::{RobotStore, StoreError},
    },
    service::Service,
};

/// A server with its port bound.
#[derive(Debug)]
pub struct Server {
    listener: TcpListener,
    address: SocketAddr,
    connections: Arc<Connections>,
    places: Arc<Semaphore>,
    health: Health,
    drain: DrainConfig,
}

/// Why a server cannot be started.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BindError {
    /// A value of the configuration cannot be used.
    #[error("configuration: {0}")]
    Config(#[from] ConfigError),
    /// The port cannot be had.
    #[error("cannot listen on {address}: {source}")]
    Listen {
        /// Where.
        address: SocketAddr,
        /// Why not.
        source: io::Error,
    },
    /// The store cannot be opened.
    #[error("cannot open the store {path}: {message}")]
    Store {
        /// Which file.
        path: String,
        /// Why not.
        message: String,
    },
    /// The threads that compute cannot be started.
    #[error("cannot start the planner's threads: {0}")]
    Planner(String),
    /// An example robot is not accepted: a fault of this version.
    #[error("cannot register the example robots: {0}")]
    Examples(String),
    /// The schema that is built in cannot be read: a fault of this version.
    #[error("cannot set reflection up: {0}")]
    Reflection(String),
}

/// How long the listener rests after it could not accept: there are no file descriptors left, mostly.
const ACCEPT_PAUSE: Duration = Duration::from_millis(50);

impl Server {
    /// Opens the store and binds the port.
    ///
    /// # Errors
    /// Whatever stands against it, in one sentence.
    pub async fn bind(config: Config) -> Result<Self, BindError> {
        config.validate()?;
        let store = open(&config.store).await?;
        let planner = Pool::new(&config.planner).map_err(|error| BindError::Planner(error.to_string()))?;
        let registry = Registry::new(store, config.planner.cached_robots());
        if config.examples {
            let registered = examples::register(&registry).await;
            registered.map_err(|error| BindError::Examples(error.wire().to_string()))?;
        }
        let service = Arc::new(Service::new(registry, planner, config.limits.clone()));
        let health = Health::serving().await;
        let edge = Edge::new(service, health.clone(), config.limits);
        let edge = edge.map_err(|error| BindError::Reflection(error.to_string()))?;
        let address = config.listen.unwrap_or((Ipv4Addr::LOCALHOST, 0).into());
        let listener = TcpListener::bind(address).await;
        let bound = listener.and_then(|listener| Ok((listener.local_addr()?, listener)));
        let (address, listener) = bound.map_err(|source| BindError::Listen { address, source })?;
        Ok(Self {
            listener,
            address,
            places: Arc::new(Semaphore::new(config.connections.max_connections)),
            connections: Arc::new(Connections::new(Arc::new(edge), config.connections)),
            health,
            drain: config.drain,
        })
    }

    /// Where the server listens.
    #[must_use]
    pub fn local_addr(&self) -> SocketAddr {
        self.address
    }

    /// Serves until `shutdown` is there, then lets the requests in work finish: it says "not ready", keeps serving for
    /// `drain.notice_s`, closes the port, and returns when all connections have ended, or after `drain.timeout_s`.
    pub async fn run(self, shutdown: impl Future<Output = ()> + Send) {
        let graceful = GracefulShutdown::new();
        let mut tasks = JoinSet::new();
        let health = self.health.clone();
        let notice = Duration::from_secs_f64(self.drain.notice_s);
        let stopping = async {
            shutdown.await;
            health.set(false).await;
            tracing::info!("stopping: not ready any more");
            tokio::time::sleep(notice).await;
        };
        tokio::pin!(stopping);
        tracing::info!(address = %self.address, version = crate::VERSION, "listening");
        loop {
            tokio::select! {
                () = &mut stopping => break,
                accepted = self.listener.accept() => self.accept(accepted, &graceful, &mut tasks).await,
                Some(_) = tasks.join_next() => {}
            }
        }
        drop(self.listener);
        let timeout = Duration::from_secs_f64(self.drain.timeout_s);
        let ended = async {
            graceful.shutdown().await;
            while tasks.join_next().await.is_some() {}
        };
        match tokio::time::timeout(timeout, ended).await {
            Ok(()) => tracing::info!("stopped"),
            Err(_) => tracing::warn!("stopped with requests unfinished: the drain timeout passed"),
        }
    }

    async fn accept(
        &self,
        accepted: io::Result<(tokio::net::TcpStream, SocketAddr)>,
        graceful: &GracefulShutdown,
        tasks: &mut JoinSet<()>,
    ) {
        let stream = match accepted {
            Ok((stream, _)) => stream,
            Err(error) => {
                tracing::warn!(%error, "a connection could not be accepted");
                tokio::time::sleep(ACCEPT_PAUSE).await;
                return;
            }
        };
        let Ok(place) = Arc::clone(&self.places).try_acquire_owned() else {
            tracing::warn!("a connection was refused: `connections.max_connections` are open");
            return;
        };
        tasks.spawn(Arc::clone(&self.connections).serve(stream, place, graceful.watcher()));
    }
}

async fn open(store: &StoreConfig) -> Result<Box<dyn RobotStore>, BindError> {
    match store {
        StoreConfig::Memory => Ok(Box::new(Memory::default())),
        StoreConfig::Sqlite(path) => {
            let failed = |error: StoreError| BindError::Store {
                path: path.display().to_string(),
                message: error.to_string(),
            };
            Ok(Box::new(Sqlite::open(path).await.map_err(failed)?))
        }
    }
}
