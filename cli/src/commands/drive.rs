//! `takt drive`.

mod bench;
mod commit;
mod estimate;
mod fit;

use clap::Subcommand;
use takt_client::Client;

use crate::{failure::Failure, io::Io};

/// Finds out what drives are like, from what they report.
#[derive(Debug, Subcommand)]
pub(crate) enum DriveCommand {
    Estimate(Box<estimate::EstimateArgs>),
    Fit(Box<fit::FitArgs>),
    FitStiffness(bench::StiffnessArgs),
    FitDamping(bench::DampingArgs),
    FitConstantSpeed(bench::ConstantSpeedArgs),
    Commit(commit::CommitArgs),
}

pub(crate) async fn run(command: DriveCommand, client: &Client, io: &mut Io) -> Result<u8, Failure> {
    match command {
        DriveCommand::Estimate(args) => estimate::run(*args, client, io).await,
        DriveCommand::Fit(args) => fit::run(*args, client, io).await,
        DriveCommand::FitStiffness(args) => bench::stiffness(args, client, io).await,
        DriveCommand::FitDamping(args) => bench::damping(args, client, io).await,
        DriveCommand::FitConstantSpeed(args) => bench::constant_speed(args, client, io).await,
        DriveCommand::Commit(args) => commit::run(args, client, io).await,
    }
}
