//! `takt serve`: the one command that uses the server crate.

use std::{net::SocketAddr, path::PathBuf};

use clap::{Args, ValueEnum};
use takt_server::{
    BindError, Config, ConnectionConfig, DrainConfig, Limits, LogFormat, PlannerConfig, Server, StoreConfig,
    init_telemetry,
};
use tokio::signal;

use crate::{exit, failure::Failure, io::Io, numbers};

/// Runs the service: gRPC and HTTP on one port, until ctrl-c or SIGTERM.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  takt serve --examples                          on 127.0.0.1:7171, with example arms
  takt serve --listen 0.0.0.0:7171 --store /var/lib/takt/robots.db
  takt serve --listen 127.0.0.1:0 --store memory       a free port; the first line of the output names it
  TAKT_STORE=/var/lib/takt/robots.db TAKT_LOG_FORMAT=json takt serve

The first line on standard output is `listening on http://ADDRESS:PORT`; the log goes to standard error.
Every option can be given by its environment variable; the option counts more.
On ctrl-c or SIGTERM it says \"not ready\", finishes the requests in work, and exits with 0; on a second one it exits
at once with 1.")]
pub(crate) struct ServeArgs {
    /// Where to listen; port 0 takes a free one.
    #[arg(long, value_name = "ADDRESS", env = "TAKT_LISTEN", default_value = "127.0.0.1:7171")]
    listen: SocketAddr,
    /// Where robots are kept: an SQLite file, made where it is missing, or `memory`.
    #[arg(long, value_name = "PATH|memory", env = "TAKT_STORE", default_value = "takt.db")]
    store: String,
    /// Register the example arms, where they are not there yet.
    #[arg(long, env = "TAKT_EXAMPLES")]
    examples: bool,
    #[command(flatten)]
    limits: LimitArgs,
    #[command(flatten)]
    process: ProcessArgs,
}

#[derive(Debug, Args)]
#[command(next_help_heading = "Limits")]
struct LimitArgs {
    /// Longest time for one request, and the time where the caller states none.
    #[arg(long, value_name = "TIME", env = "TAKT_DEADLINE", default_value = "30s", value_parser = numbers::seconds)]
    deadline: f64,
    /// Largest request.
    #[arg(long, value_name = "BYTES", env = "TAKT_MAX_REQUEST_BYTES")]
    max_request_bytes: Option<usize>,
    /// Most states of one dynamics request.
    #[arg(long, value_name = "COUNT", env = "TAKT_MAX_STATES")]
    max_states: Option<usize>,
    /// Most points of a trajectory to be checked.
    #[arg(long, value_name = "COUNT", env = "TAKT_MAX_TRAJECTORY_POINTS")]
    max_trajectory_points: Option<usize>,
    /// Most set-points or trace points of one plan.
    #[arg(long, value_name = "COUNT", env = "TAKT_MAX_SETPOINTS")]
    max_setpoints: Option<usize>,
    /// Most requests in work at once.
    #[arg(long, value_name = "COUNT", env = "TAKT_MAX_CONCURRENT_REQUESTS")]
    max_concurrent_requests: Option<usize>,
    /// Most connections at once.
    #[arg(long, value_name = "COUNT", env = "TAKT_MAX_CONNECTIONS")]
    max_connections: Option<usize>,
}

#[derive(Debug, Args)]
#[command(next_help_heading = "Process")]
struct ProcessArgs {
    /// Threads that compute. Default: as many as there are cores.
    #[arg(long, value_name = "COUNT", env = "TAKT_THREADS")]
    threads: Option<usize>,
    /// Calculations that run or wait before more are refused. Default: 1024.
    #[arg(long, value_name = "COUNT", env = "TAKT_QUEUE_CAPACITY")]
    queue_capacity: Option<usize>,
    /// Robots that are kept compiled. Default: 256.
    #[arg(long, value_name = "COUNT", env = "TAKT_CACHED_ROBOTS")]
    cached_robots: Option<usize>,
    /// Time between saying "not ready" and closing the port, so that load balancers notice.
    #[arg(long, value_name = "TIME", env = "TAKT_DRAIN_NOTICE", default_value = "0s", value_parser = numbers::seconds)]
    drain_notice: f64,
    /// Time for the requests in work to finish.
    #[arg(long, value_name = "TIME", env = "TAKT_DRAIN_TIMEOUT", default_value = "30s",
        value_parser = numbers::seconds)]
    drain_timeout: f64,
    /// What the log holds, as in info, or warn,takt_server=debug.
    #[arg(long, value_name = "DIRECTIVES", env = "TAKT_LOG", default_value = "info")]
    log: String,
    /// How its lines look.
    #[arg(long, value_enum, env = "TAKT_LOG_FORMAT", default_value_t = LogFormatName::Text)]
    log_format: LogFormatName,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum LogFormatName {
    /// For people.
    Text,
    /// One JSON object a line.
    Json,
}

impl ServeArgs {
    fn config(&self) -> Config {
        let (limits, process) = (&self.limits, &self.process);
        let standard = Limits::default();
        let connections = ConnectionConfig::default();
        Config {
            listen: Some(self.listen),
            store: match self.store.as_str() {
                "memory" => StoreConfig::Memory,
                path => StoreConfig::Sqlite(PathBuf::from(path)),
            },
            examples: self.examples,
            limits: Limits {
                max_request_bytes: limits.max_request_bytes.unwrap_or(standard.max_request_bytes),
                max_states: limits.max_states.unwrap_or(standard.max_states),
                max_trajectory_points: limits.max_trajectory_points.unwrap_or(standard.max_trajectory_points),
                max_setpoints: limits.max_setpoints.unwrap_or(standard.max_setpoints),
                max_concurrent_requests: limits
                    .max_concurrent_requests
                    .unwrap_or(standard.max_concurrent_requests),
                deadline_s: limits.deadline,
            },
            planner: PlannerConfig {
                threads: process.threads,
                queue_capacity: process.queue_capacity,
                cached_robots: process.cached_robots,
            },
            connections: ConnectionConfig {
                max_connections: limits.max_connections.unwrap_or(connections.max_connections),
                ..connections
            },
            drain: DrainConfig {
                notice_s: process.drain_notice,
                timeout_s: process.drain_timeout,
            },
        }
    }
}

pub(crate) async fn run(args: ServeArgs, io: &mut Io) -> Result<u8, Failure> {
    let format = match args.process.log_format {
        LogFormatName::Text => LogFormat::Text,
        LogFormatName::Json => LogFormat::Json,
    };
    init_telemetry(format, &args.process.log).map_err(|error| Failure::usage(format!("--log: {error}")))?;
    // Asked for before the port is open, so that a signal just after the start is not missed.
    let mut signals = Signals::new().map_err(|error| Failure::service(format!("cannot wait for signals: {error}")))?;
    let server = Server::bind(args.config()).await.map_err(|error| failure(&error))?;
    io.print(&format!("listening on http://{}\n", server.local_addr()))?;

    let (stop, stopped) = tokio::sync::oneshot::channel::<()>();
    let running = server.run(async move {
        // A sender that is gone means the same.
        let _ = stopped.await;
    });
    tokio::pin!(running);
    tokio::select! {
        () = &mut running => return Ok(exit::OK),
        () = signals.next() => drop(stop),
    }
    tokio::select! {
        () = running => Ok(exit::OK),
        () = signals.next() => Err(Failure::service("stopped at once, with requests unfinished")),
    }
}

fn failure(error: &BindError) -> Failure {
    let text = error.to_string();
    match error {
        BindError::Config(_) => Failure::usage(text),
        BindError::Listen { .. } => Failure::service(text)
            .hint("another server may be running there; take another port with --listen 127.0.0.1:0"),
        BindError::Store { .. } => {
            Failure::service(text).hint("name another file with --store PATH, or keep robots in memory: --store memory")
        }
        _ => Failure::service(text),
    }
}

/// The signals that ask for the end.
struct Signals {
    #[cfg(unix)]
    interrupt: signal::unix::Signal,
    #[cfg(unix)]
    terminate: signal::unix::Signal,
}

impl Signals {
    #[cfg(unix)]
    fn new() -> std::io::Result<Self> {
        use signal::unix::{SignalKind, signal};
        Ok(Self {
            interrupt: signal(SignalKind::interrupt())?,
            terminate: signal(SignalKind::terminate())?,
        })
    }

    #[cfg(unix)]
    async fn next(&mut self) {
        tokio::select! {
            _ = self.interrupt.recv() => {}
            _ = self.terminate.recv() => {}
        }
    }

    #[cfg(not(unix))]
    fn new() -> std::io::Result<Self> {
        Ok(Self {})
    }

    #[cfg(not(unix))]
    async fn next(&mut self) {
        let _ = signal::ctrl_c().await;
    }
}
