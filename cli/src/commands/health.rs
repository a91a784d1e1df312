//! `takt health`.

use clap::Args;
use takt_client::Client;

use crate::{exit, failure::Failure, io::Io};

/// Asks whether the service takes requests; for health checks of containers and supervisors.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  takt health
  takt health --server http://10.0.0.1:7171,http://10.0.0.2:7171 --timeout 2s     every one of them

Exit code 1: one cannot be reached, or is not ready (any more).")]
pub(crate) struct HealthArgs {}

pub(crate) async fn run(client: &Client, io: &mut Io) -> Result<u8, Failure> {
    client.ready().await?;
    io.print("ready\n")?;
    Ok(exit::OK)
}
