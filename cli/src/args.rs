//! The command line as a whole, and the options that every command has.

use std::time::Duration;

use clap::{Args, Parser, Subcommand, ValueEnum};
use takt_client::{Client, Transport};

use crate::{
    commands::{
        check::CheckArgs, completions::CompletionsArgs, drive::DriveCommand, dynamics::DynamicsArgs,
        health::HealthArgs, inverse::IkArgs, plan::PlanCommand, pose::PoseArgs, rehearse::RehearseArgs,
        robot::RobotCommand, serve::ServeArgs, setpoints::SetpointsArgs,
    },
    failure::Failure,
    numbers,
};

/// Plans the motion of robot arms: fast, within every limit, and with the proof.
#[derive(Debug, Parser)]
#[command(
    name = "takt",
    version,
    propagate_version = true,
    max_term_width = 110,
    after_help = "\
Examples:
  takt serve --examples                                    a server with example arms, to try things
  takt robot list                                          what it knows
  takt plan move ur5e --from 0,-90deg,0,0,0,0 --to 1,-1,1,0,0,0
  takt plan move ur5e --from … --to … --plot               speed and torque against their limits
  takt plan move ur5e --from … --to … --sample-period 4ms --csv > move.csv
  takt plan path ur5e examples/pick_and_place.yaml         a program of lines, arcs and joint moves
  takt setpoints ur5e --program seam.yaml --sample-period 4ms | to-the-controller
  takt check ur5e move.csv                                 margins of a trajectory made elsewhere
  takt drive estimate ur5e telemetry.csv                   friction, from what the drives report
  takt drive fit ur5e log.csv --test 20..30                friction, rotors and bodies, from a recording
  takt rehearse ur5e --program seam.yaml --friction 1.5    a program on a simulated arm with more friction

Exit codes:
  0  done
  1  the service could not be reached, could not do it, or took too long
  2  the command line or the request is wrong
  3  the answer is no: the motion is infeasible, the pose out of reach, or the trajectory breaks a limit"
)]
pub(crate) struct Cli {
    #[command(flatten)]
    pub(crate) connection: Connection,
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    Serve(Box<ServeArgs>),
    #[command(subcommand)]
    Robot(RobotCommand),
    #[command(subcommand)]
    Plan(PlanCommand),
    Check(Box<CheckArgs>),
    #[command(subcommand)]
    Drive(DriveCommand),
    Rehearse(Box<RehearseArgs>),
    Dynamics(Box<DynamicsArgs>),
    Pose(PoseArgs),
    Ik(IkArgs),
    Setpoints(Box<SetpointsArgs>),
    Health(HealthArgs),
    Completions(CompletionsArgs),
}

/// Where the service is.
#[derive(Debug, Args)]
#[command(next_help_heading = "Connection")]
pub(crate) struct Connection {
    /// The server; several, separated by commas, are taken in turn and stand in for each other.
    #[arg(
        long,
        global = true,
        value_name = "URL",
        env = "TAKT_SERVER",
        value_delimiter = ',',
        default_value = "http://127.0.0.1:7171"
    )]
    server: Vec<String>,
    /// How to talk to it.
    #[arg(long, global = true, value_enum, env = "TAKT_TRANSPORT", default_value_t = TransportName::Grpc)]
    transport: TransportName,
    /// Time for a call with all its tries, as in 500ms, 30s or 2min.
    #[arg(long, global = true, value_name = "TIME", env = "TAKT_TIMEOUT", default_value = "30s",
        value_parser = numbers::duration)]
    timeout: Duration,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum TransportName {
    Grpc,
    Http,
}

impl Connection {
    /// A client of this service; connects when it is first used.
    pub(crate) fn client(&self) -> Result<Client, Failure> {
        let transport = match self.transport {
            TransportName::Grpc => Transport::Grpc,
            TransportName::Http => Transport::Http,
        };
        let builder = Client::builder().transport(transport).deadline(self.timeout);
        let builder = self
            .server
            .iter()
            .fold(builder, |builder, url| builder.endpoint(url.trim()));
        builder
            .build()
            .map_err(|error| Failure::from(error).hint("name the server with --server URL or TAKT_SERVER"))
    }
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn negative_and_mixed_values_are_values() {
        let line = [
            "takt",
            "plan",
            "move",
            "arm",
            "--from",
            "-1,-90deg",
            "--to",
            "[0, 1]",
            "--server",
            "http://h:1",
        ];
        assert!(Cli::try_parse_from(line).is_ok());
    }

    #[test]
    fn every_command_teaches_by_example() {
        fn walk(command: &clap::Command) {
            let leaf = command.get_subcommands().next().is_none();
            let shown = command.get_after_help().map(ToString::to_string).unwrap_or_default();
            assert!(
                !leaf || shown.contains("Examples:"),
                "{} has no examples",
                command.get_name()
            );
            command.get_subcommands().for_each(walk);
        }
        walk(&Cli::command());
    }
}
