//! `takt serve`.

use clap::Args;

use crate::{failure::Failure, io::Io};

/// Runs the service: gRPC and HTTP on one port.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  takt serve --examples")]
pub(crate) struct ServeArgs {
    /// Where to listen; port 0 takes a free one.
    #[arg(
        long,
        value_name = "ADDRESS",
        env = "TAKT_LISTEN",
        default_value = "127.0.0.1:7171"
    )]
    listen: String,
}

#[allow(clippy::unused_async, reason = "the server comes with the next merge")]
pub(crate) async fn run(args: ServeArgs, _io: &mut Io) -> Result<u8, Failure> {
    Err(Failure::service(format!(
        "cannot listen on {}: there is no server in this build",
        args.listen
    )))
}
