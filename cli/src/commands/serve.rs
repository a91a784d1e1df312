//! `takt serve`: the one command that uses the server crate.

use std::{net::SocketAddr, path::PathBuf};

use clap::{Args, ValueEnum};
use takt_server::{BindError, Config, LogFormat, Server, StoreConfig, init_telemetry};
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
    network: NetworkArgs,
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
    /// Most samples of one message of telemetry.
    #[arg(long, value_name = "COUNT", env = "TAKT_MAX_TELEMETRY_SAMPLES")]
    max_telemetry_samples: Option<usize>,
    /// Most points of each trace of one rehearsal.
    #[arg(long, value_name = "COUNT", env = "TAKT_MAX_TRACE_POINTS")]
    max_trace_points: Option<usize>,
    /// Most requests in work at once.
    #[arg(long, value_name = "COUNT", env = "TAKT_MAX_CONCURRENT_REQUESTS")]
    max_concurrent_requests: Option<usize>,
    /// Most bytes of all requests in work together.
    #[arg(long, value_name = "BYTES", env = "TAKT_MAX_BYTES_IN_WORK")]
    max_bytes_in_work: Option<usize>,
    /// Time after which a stream ends of which the caller takes nothing, or to which it adds nothing. Default: 60s.
    #[arg(long, value_name = "TIME", env = "TAKT_STREAM_IDLE", value_parser = numbers::seconds)]
    stream_idle: Option<f64>,
}

#[derive(Debug, Args)]
#[command(next_help_heading = "Connections")]
struct NetworkArgs {
    /// Most connections at once.
    #[arg(long, value_name = "COUNT", env = "TAKT_MAX_CONNECTIONS")]
    max_connections: Option<usize>,
    /// Most HTTP/2 streams at once on one connection.
    #[arg(long, value_name = "COUNT", env = "TAKT_MAX_CONCURRENT_STREAMS")]
    max_concurrent_streams: Option<u32>,
    /// Most bytes that wait to be sent on one HTTP/2 stream.
    #[arg(long, value_name = "BYTES", env = "TAKT_MAX_SEND_BUFFER_BYTES")]
    max_send_buffer_bytes: Option<usize>,
    /// Time from the connection to the bytes that tell its protocol.
    #[arg(long, value_name = "TIME", env = "TAKT_DETECT_TIMEOUT", value_parser = numbers::seconds)]
    detect_timeout: Option<f64>,
    /// Time for the head of an HTTP/1 request; also how long an idle HTTP/1 connection is kept.
    #[arg(long, value_name = "TIME", env = "TAKT_HEADER_TIMEOUT", value_parser = numbers::seconds)]
    header_timeout: Option<f64>,
    /// Time between HTTP/2 keep-alive pings, and for the answer to one.
    #[arg(long, value_name = "TIME", env = "TAKT_KEEP_ALIVE", value_parser = numbers::seconds)]
    keep_alive: Option<f64>,
    /// Time after which a peer that acknowledges nothing is cut off.
    #[arg(long, value_name = "TIME", env = "TAKT_UNACKNOWLEDGED_TIMEOUT", value_parser = numbers::seconds)]
    unacknowledged_timeout: Option<f64>,
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
        let (limits, network, process) = (&self.limits, &self.network, &self.process);
        let mut config = Config {
            listen: Some(self.listen),
            examples: self.examples,
            ..Config::default()
        };
        config.store = match self.store.as_str() {
            "memory" => StoreConfig::Memory,
            path => StoreConfig::Sqlite(PathBuf::from(path)),
        };
        config.limits.deadline_s = limits.deadline;
        set(&mut config.limits.max_request_bytes, limits.max_request_bytes);
        set(&mut config.limits.max_states, limits.max_states);
        set(&mut config.limits.max_trajectory_points, limits.max_trajectory_points);
        set(&mut config.limits.max_setpoints, limits.max_setpoints);
        set(&mut config.limits.max_telemetry_samples, limits.max_telemetry_samples);
        set(&mut config.limits.max_trace_points, limits.max_trace_points);
        set(
            &mut config.limits.max_concurrent_requests,
            limits.max_concurrent_requests,
        );
        set(&mut config.limits.max_bytes_in_work, limits.max_bytes_in_work);
        set(&mut config.limits.stream_idle_s, limits.stream_idle);
        let connections = &mut config.connections;
        set(&mut connections.max_connections, network.max_connections);
        set(&mut connections.max_concurrent_streams, network.max_concurrent_streams);
        set(&mut connections.max_send_buffer_bytes, network.max_send_buffer_bytes);
        set(&mut connections.detect_timeout_s, network.detect_timeout);
        set(&mut connections.header_timeout_s, network.header_timeout);
        set(&mut connections.keep_alive_s, network.keep_alive);
        set(
            &mut connections.unacknowledged_timeout_s,
            network.unacknowledged_timeout,
        );
        config.planner.threads = process.threads;
        config.planner.queue_capacity = process.queue_capacity;
        config.planner.cached_robots = process.cached_robots;
        config.drain.notice_s = process.drain_notice;
        config.drain.timeout_s = process.drain_timeout;
        config
    }
}

/// Takes the place of a default where something is given.
fn set<T: Copy>(field: &mut T, given: Option<T>) {
    if let Some(value) = given {
        *field = value;
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

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;

    #[derive(Debug, Parser)]
    struct Line {
        #[command(flatten)]
        serve: ServeArgs,
    }

    fn config(line: &[&str]) -> Config {
        Line::try_parse_from([&["serve"], line].concat())
            .unwrap()
            .serve
            .config()
    }

    #[test]
    fn what_is_not_given_is_the_servers_own_default() {
        let plain = config(&["--store", "memory", "--listen", "127.0.0.1:0"]);
        assert_eq!(Config { listen: None, ..plain }, Config::default());
    }

    #[test]
    fn what_is_given_arrives() {
        let given = config(&[
            "--store",
            "a.db",
            "--deadline",
            "2s",
            "--max-states",
            "7",
            "--keep-alive",
            "500ms",
        ]);
        assert_eq!(given.store, StoreConfig::Sqlite("a.db".into()));
        assert_eq!((given.limits.deadline_s, given.limits.max_states), (2.0, 7));
        assert_eq!(given.connections.keep_alive_s, 0.5);
    }

    #[test]
    fn every_option_has_a_variable() {
        use clap::CommandFactory;
        for option in Line::command().get_arguments() {
            let name = format!("TAKT_{}", option.get_id().as_str().to_uppercase());
            assert_eq!(option.get_env().and_then(|env| env.to_str()), Some(name.as_str()));
        }
    }
}
