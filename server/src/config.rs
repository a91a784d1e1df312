//! What can be set, with its defaults.

use std::{fmt, net::SocketAddr, path::PathBuf};

/// The whole configuration. The default listens on a free loopback port and keeps robots in memory.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Config {
    /// Where to listen; `None`: a free port on 127.0.0.1.
    pub listen: Option<SocketAddr>,
    /// Where robots are kept.
    pub store: StoreConfig,
    /// Register the example robots at the start, where they are not there yet.
    pub examples: bool,
    /// What one request may ask for.
    pub limits: Limits,
    /// The threads that compute.
    pub planner: PlannerConfig,
    /// What one connection may do.
    pub connections: ConnectionConfig,
    /// How the service stops.
    pub drain: DrainConfig,
}

/// Where robots are kept.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum StoreConfig {
    /// In memory: gone when the process ends.
    #[default]
    Memory,
    /// In an SQLite file, made where it is missing.
    Sqlite(PathBuf),
}

/// What one request may ask for. One more than a limit is refused by name.
#[derive(Debug, Clone, PartialEq)]
pub struct Limits {
    /// Bytes of a request: of the body over HTTP, of the message over gRPC.
    pub max_request_bytes: usize,
    /// States of one dynamics request.
    pub max_states: usize,
    /// Points of one trajectory to be checked.
    pub max_trajectory_points: usize,
    /// Set-points or trace points of one plan.
    pub max_setpoints: usize,
    /// Samples of one message of telemetry.
    pub max_telemetry_samples: usize,
    /// Points of each trace of one rehearsal.
    pub max_trace_points: usize,
    /// Requests in work at once, over all connections.
    pub max_concurrent_requests: usize,
    /// Bytes of all requests in work together.
    pub max_bytes_in_work: usize,
    /// Longest time for one request, and the time where the caller states none. Of a stream: for its plan, or for each of
    /// its plans.
    pub deadline_s: f64,
    /// Time after which a stream ends of which the caller takes nothing, or to which the caller adds nothing.
    pub stream_idle_s: f64,
}

/// The threads that compute.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct PlannerConfig {
    /// Threads; `None`: as many as the machine has cores.
    pub threads: Option<usize>,
    /// Calculations that run or wait, before more are refused; `None`: 1024.
    pub queue_capacity: Option<usize>,
    /// Compiled robots that are kept; `None`: 256.
    pub cached_robots: Option<usize>,
}

/// What one connection may do.
#[derive(Debug, Clone, PartialEq)]
pub struct ConnectionConfig {
    /// Connections at once.
    pub max_connections: usize,
    /// HTTP/2 streams at once on one connection.
    pub max_concurrent_streams: u32,
    /// Time from the connection to the bytes that tell its protocol.
    pub detect_timeout_s: f64,
    /// Time for the head of an HTTP/1 request; also how long an idle HTTP/1 connection is kept.
    pub header_timeout_s: f64,
    /// Time between HTTP/2 keep-alive pings, and for the answer to one.
    pub keep_alive_s: f64,
    /// Time after which a peer that acknowledges nothing is cut off.
    pub unacknowledged_timeout_s: f64,
    /// Bytes that wait to be sent on one HTTP/2 stream.
    pub max_send_buffer_bytes: usize,
}

/// How the service stops: not ready, then closed to new connections, then without those that take too long.
#[derive(Debug, Clone, PartialEq)]
pub struct DrainConfig {
    /// Time between saying "not ready" and closing the port, so that load balancers notice.
    pub notice_s: f64,
    /// Time for the requests in work to finish.
    pub timeout_s: f64,
}

/// A value that cannot be used.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ConfigError {
    /// Name of the key, with dots.
    pub key: &'static str,
    /// What is wrong with its value.
    pub message: String,
}

impl fmt::Display for ConfigError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.key, self.message)
    }
}

impl std::error::Error for ConfigError {}

impl Default for Limits {
    fn default() -> Self {
        Self {
            max_request_bytes: 8 << 20,
            max_states: 10_000,
            max_trajectory_points: 50_000,
            max_setpoints: 100_000,
            max_telemetry_samples: 1000,
            max_trace_points: 10_000,
            max_concurrent_requests: 2048,
            max_bytes_in_work: 256 << 20,
            deadline_s: 30.0,
            stream_idle_s: 60.0,
        }
    }
}

impl Default for ConnectionConfig {
    fn default() -> Self {
        Self {
            max_connections: 4096,
            max_concurrent_streams: 256,
            detect_timeout_s: 10.0,
            header_timeout_s: 75.0,
            keep_alive_s: 20.0,
            unacknowledged_timeout_s: 10.0,
            max_send_buffer_bytes: 64 << 10,
        }
    }
}

impl Default for DrainConfig {
    fn default() -> Self {
        Self {
            notice_s: 0.0,
            timeout_s: 30.0,
        }
    }
}

impl PlannerConfig {
    pub(crate) fn threads(&self) -> usize {
        let cores = || std::thread::available_parallelism().map_or(1, usize::from);
        self.threads.unwrap_or_else(cores)
    }

    pub(crate) fn queue_capacity(&self) -> usize {
        self.queue_capacity.unwrap_or(1024)
    }

    pub(crate) fn cached_robots(&self) -> usize {
        self.cached_robots.unwrap_or(256)
    }
}

impl Config {
    /// Checks every value.
    ///
    /// # Errors
    /// The first value that cannot be used, by its key.
    pub fn validate(&self) -> Result<(), ConfigError> {
        let counts = [
            ("limits.max_request_bytes", self.limits.max_request_bytes),
            ("limits.max_states", self.limits.max_states),
            ("limits.max_trajectory_points", self.limits.max_trajectory_points),
            ("limits.max_setpoints", self.limits.max_setpoints),
            ("limits.max_telemetry_samples", self.limits.max_telemetry_samples),
            ("limits.max_trace_points", self.limits.max_trace_points),
            ("limits.max_bytes_in_work", self.limits.max_bytes_in_work),
            ("limits.max_concurrent_requests", self.limits.max_concurrent_requests),
            ("planner.threads", self.planner.threads()),
            ("planner.queue_capacity", self.planner.queue_capacity()),
            ("planner.cached_robots", self.planner.cached_robots()),
            ("connections.max_connections", self.connections.max_connections),
            (
                "connections.max_send_buffer_bytes",
                self.connections.max_send_buffer_bytes,
            ),
        ];
        /// Far above anything sensible, far below what overflows.
        const LARGEST_COUNT: usize = 1 << 30;
        for (key, count) in counts {
            if count == 0 || count > LARGEST_COUNT {
                let message = format!("{count} must be at least 1 and at most {LARGEST_COUNT}");
                return Err(ConfigError { key, message });
            }
        }
        if self.connections.max_concurrent_streams == 0 {
            let message = "0 must be at least 1".to_owned();
            let key = "connections.max_concurrent_streams";
            return Err(ConfigError { key, message });
        }
        let positive = [
            ("limits.deadline_s", self.limits.deadline_s),
            ("limits.stream_idle_s", self.limits.stream_idle_s),
            ("connections.detect_timeout_s", self.connections.detect_timeout_s),
            ("connections.header_timeout_s", self.connections.header_timeout_s),
            ("connections.keep_alive_s", self.connections.keep_alive_s),
            (
                "connections.unacknowledged_timeout_s",
                self.connections.unacknowledged_timeout_s,
            ),
        ];
        let from_zero = [
            ("drain.notice_s", self.drain.notice_s),
            ("drain.timeout_s", self.drain.timeout_s),
        ];
        /// A day.
        const LONGEST_S: f64 = 86_400.0;
        for (key, seconds) in positive.into_iter().chain(from_zero) {
            let least = if from_zero.iter().any(|(other, _)| *other == key) {
                0.0
            } else {
                0.001
            };
            if !(least..=LONGEST_S).contains(&seconds) {
                let message = format!("{seconds} s must be at least {least} s and at most {LONGEST_S} s");
                return Err(ConfigError { key, message });
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_is_valid() {
        assert_eq!(Config::default().validate(), Ok(()));
    }

    #[test]
    fn a_bad_value_is_named() {
        let mut config = Config::default();
        config.limits.deadline_s = f64::NAN;
        assert_eq!(config.validate().unwrap_err().key, "limits.deadline_s");
        let mut config = Config::default();
        config.planner.threads = Some(0);
        assert_eq!(config.validate().unwrap_err().key, "planner.threads");
    }
}
