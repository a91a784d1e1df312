//! `takt dynamics`.

use clap::Args;
use takt_client::{Client, v1};

use super::context::{self, PayloadArgs};
use crate::{exit, failure::Failure, files, io::Io, numbers::JointValues, render::dynamics as render};

/// Joint torques of a state, and where they come from: rigid bodies, gravity, rotors, friction.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  takt dynamics ur5e --position 0,-90deg,90deg,0,0,0                         what holding this pose takes
  takt dynamics ur5e --position … --velocity 1,0,0,0,0,0 --acceleration 5,0,0,0,0,0 --payload 2
  takt dynamics ur5e --position … --mass-matrix --jacobian
  takt dynamics ur5e --request states.json --json                            many states in one call")]
pub(crate) struct DynamicsArgs {
    /// The robot.
    robot_id: String,
    /// Joint positions in model order, rad or m (or with a unit: 90deg, 5mm).
    #[arg(
        long,
        value_name = "Q1,Q2,…",
        required_unless_present = "request",
        allow_hyphen_values = true
    )]
    position: Option<JointValues>,
    /// Joint velocities. Default: at rest.
    #[arg(long, value_name = "V1,V2,…", allow_hyphen_values = true, requires = "position")]
    velocity: Option<JointValues>,
    /// Joint accelerations. Default: zero.
    #[arg(long, value_name = "A1,A2,…", allow_hyphen_values = true, requires = "position")]
    acceleration: Option<JointValues>,
    /// A whole request in JSON, YAML or TOML; - for standard input.
    #[arg(long, value_name = "FILE", conflicts_with = "position")]
    request: Option<String>,
    /// Plain numbers are degrees, for joints that turn.
    #[arg(long)]
    degrees: bool,
    /// Also the mass matrix.
    #[arg(long)]
    mass_matrix: bool,
    /// Also the Jacobian of the tool centre point.
    #[arg(long)]
    jacobian: bool,
    #[command(flatten)]
    payload: PayloadArgs,
    /// A revision other than the current one.
    #[arg(long)]
    revision: Option<String>,
    /// Print the reply as it is.
    #[arg(long)]
    json: bool,
}

pub(crate) async fn run(args: DynamicsArgs, client: &Client, io: &mut Io) -> Result<u8, Failure> {
    let robot = match args.degrees || !args.json {
        true => context::robot(client, &args.robot_id, args.revision.as_deref()).await?,
        false => v1::Robot::default(),
    };
    let request = request(&args, &robot, io)?;
    let reply = client.inverse_dynamics(request).await?;
    if args.json {
        context::print_json(&reply, io)?;
    } else {
        io.print(&render::torques(&reply, &robot, io.terminal.colour))?;
    }
    Ok(exit::OK)
}

fn request(args: &DynamicsArgs, robot: &v1::Robot, io: &mut Io) -> Result<v1::InverseDynamicsRequest, Failure> {
    use v1::inverse_dynamics_request::Quantity;
    let mut request = match &args.request {
        Some(file) => files::message(file, &files::read(file, io)?)?,
        None => v1::InverseDynamicsRequest::default(),
    };
    request.robot_id.clone_from(&args.robot_id);
    if let Some(position) = &args.position {
        let list = |values: &Option<JointValues>| {
            values
                .as_ref()
                .map(|values| context::si(values, args.degrees, Some(robot)))
                .unwrap_or_default()
        };
        request.states.push(v1::JointState {
            position: context::si(position, args.degrees, Some(robot)),
            velocity: list(&args.velocity),
            acceleration: list(&args.acceleration),
        });
    }
    for (wanted, quantity) in [
        (args.mass_matrix, Quantity::MassMatrix),
        (args.jacobian, Quantity::Jacobian),
    ] {
        let quantity = i32::from(quantity);
        if wanted && !request.r#return.contains(&quantity) {
            request.r#return.push(quantity);
        }
    }
    request.payload = args.payload.payload().or(request.payload);
    request.revision = args.revision.clone().or(request.revision);
    Ok(request)
}
