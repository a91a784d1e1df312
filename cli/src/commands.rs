//! One file a command.

pub(crate) mod batch;
pub(crate) mod check;
pub(crate) mod completions;
pub(crate) mod drive;
pub(crate) mod dynamics;
pub(crate) mod health;
pub(crate) mod inverse;
pub(crate) mod path;
pub(crate) mod plan;
pub(crate) mod pose;
pub(crate) mod rehearse;
pub(crate) mod robot;
pub(crate) mod serve;
pub(crate) mod setpoints;

mod confidence;
mod context;

use tokio::runtime::Builder;

use crate::{
    args::{Cli, Command},
    failure::Failure,
    io::Io,
};

/// Runs a command; the exit code says what the answer was.
pub(crate) fn run(cli: Cli, io: &mut Io) -> Result<u8, Failure> {
    let Cli { connection, command } = cli;
    let mut builder = match &command {
        Command::Serve(_) => Builder::new_multi_thread(),
        _ => Builder::new_current_thread(),
    };
    let runtime = builder
        .enable_all()
        .build()
        .map_err(|error| Failure::service(format!("cannot start: {error}")))?;
    runtime.block_on(async {
        match command {
            Command::Serve(args) => Box::pin(serve::run(*args, io)).await,
            Command::Robot(command) => robot::run(command, &connection.client()?, io).await,
            Command::Plan(command) => plan::run(command, &connection.client()?, io).await,
            Command::Check(args) => check::run(*args, &connection.client()?, io).await,
            Command::Drive(command) => drive::run(command, &connection.client()?, io).await,
            Command::Rehearse(args) => rehearse::run(*args, &connection.client()?, io).await,
            Command::Dynamics(args) => dynamics::run(*args, &connection.client()?, io).await,
            Command::Pose(args) => pose::run(args, &connection.client()?, io).await,
            Command::Ik(args) => inverse::run(args, &connection.client()?, io).await,
            Command::Setpoints(args) => setpoints::run(*args, &connection.client()?, io).await,
            Command::Health(_) => health::run(&connection.client()?, io).await,
            Command::Completions(args) => completions::run(&args, io),
        }
    })
}
