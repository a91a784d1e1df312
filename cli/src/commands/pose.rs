//! `takt pose`.

use clap::Args;
use takt_client::{Client, v1};

use super::context;
use crate::{exit, failure::Failure, io::Io, numbers::JointValues, render::table::Table};

/// Where the tool is: its pose in base-link axes for one or several joint positions.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  takt pose ur5e --position 0,-90deg,90deg,0,0,0
  takt pose ur5e --degrees --position 0,-90,90,0,0,0 --position 45,-90,90,0,0,0 --json")]
pub(crate) struct PoseArgs {
    /// The robot.
    robot_id: String,
    /// Joint positions in model order, rad or m (or with a unit: 90deg, 5mm); may be given several times.
    #[arg(long, value_name = "Q1,Q2,…", required = true, allow_hyphen_values = true)]
    position: Vec<JointValues>,
    /// Plain numbers are degrees, for joints that turn.
    #[arg(long)]
    degrees: bool,
    /// A revision other than the current one.
    #[arg(long)]
    revision: Option<String>,
    /// Print the reply as it is.
    #[arg(long)]
    json: bool,
}

pub(crate) async fn run(args: PoseArgs, client: &Client, io: &mut Io) -> Result<u8, Failure> {
    let robot = match args.degrees {
        true => Some(context::robot(client, &args.robot_id, args.revision.as_deref()).await?),
        false => None,
    };
    let state = |values| v1::JointPosition {
        position: context::si(values, args.degrees, robot.as_ref()),
    };
    let request = v1::ForwardKinematicsRequest {
        states: args.position.iter().map(state).collect(),
        robot_id: args.robot_id,
        revision: args.revision,
        tool: None,
    };
    let reply = client.forward_kinematics(request).await?;
    if args.json {
        context::print_json(&reply, io)?;
        return Ok(exit::OK);
    }
    let mut table = Table::new(["x [m]", "y [m]", "z [m]", "qx", "qy", "qz", "qw"]).numbers_from(0);
    for result in &reply.results {
        let pose = result.pose.clone().unwrap_or_default();
        table.row(
            pose.position_m
                .iter()
                .chain(&pose.orientation)
                .map(|value| format!("{value:.6}")),
        );
    }
    io.print(&table.render(io.terminal.colour))?;
    Ok(exit::OK)
}
