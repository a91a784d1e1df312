//! Servers in processes of their own (this program again), and the time that their threads ran. Linux only: times are read
//! from `/proc`.

use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::{Child, Command, Stdio};

/// Says which server a process is to be.
pub(crate) const SERVE: &str = "--serve";

/// A process that serves until its standard input ends.
pub(crate) struct Served {
    process: Child,
    pub(crate) url: String,
}

impl Served {
    /// This program with `--serve NAME`; its first line says where it listens.
    pub(crate) fn start(name: &str) -> Self {
        let program = std::env::current_exe().expect("this program has a path");
        let mut process = Command::new(program)
            .args([SERVE, name])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("this program runs again");
        let mut line = String::new();
        let output = process.stdout.take().expect("it is piped");
        let read = BufReader::new(output).read_line(&mut line);
        read.expect("it says where it listens");
        Self {
            process,
            url: format!("http://{}", line.trim()),
        }
    }

    /// Time that its threads have run so far, s.
    pub(crate) fn cpu_time(&self) -> f64 {
        let threads = std::fs::read_dir(format!("/proc/{}/task", self.process.id())).expect("the process runs");
        threads.flatten().map(|thread| ran(thread.path())).sum()
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        drop(self.process.stdin.take());
        self.process.wait().ok();
    }
}

/// Time that a thread has run so far, s: the scheduler's own count, in nanoseconds.
pub(crate) fn ran(thread: impl AsRef<Path>) -> f64 {
    let text = std::fs::read_to_string(thread.as_ref().join("schedstat")).unwrap_or_default();
    let nanoseconds = text.split_whitespace().next().and_then(|text| text.parse::<f64>().ok());
    nanoseconds.unwrap_or(0.0) / 1e9
}

pub(crate) type Failure = Box<dyn std::error::Error + Send + Sync>;

/// Runs a server, with the log that `takt serve` has, until the standard input of this process ends.
pub(crate) async fn until_told(server: impl Future<Output = Result<(), Failure>>) -> Result<(), Failure> {
    takt_server::init_telemetry(takt_server::LogFormat::Text, "info")?;
    let told = tokio::task::spawn_blocking(|| std::io::stdin().read_to_end(&mut Vec::new()));
    tokio::select! {
        ended = server => ended,
        _ = told => std::process::exit(0),
    }
}

/// The service as `takt serve --examples --store memory` starts it, on any free port.
pub(crate) async fn takt() -> Result<(), Failure> {
    let config = takt_server::Config {
        examples: true,
        ..takt_server::Config::default()
    };
    let server = takt_server::Server::bind(config).await?;
    println!("{}", server.local_addr());
    server.run(std::future::pending()).await;
    Ok(())
}
