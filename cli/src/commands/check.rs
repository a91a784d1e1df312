//! `takt check`.

use clap::{Args, ValueEnum};
use takt_client::{Client, v1};

use super::{
    confidence::ConfidenceArgs,
    context::{self, PayloadArgs, limit, limits},
};
use crate::{
    exit,
    failure::Failure,
    files,
    io::Io,
    numbers,
    render::{check as render, csv},
};

/// Checks a trajectory that somebody else made against every limit of an arm, torque included.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  takt check ur5e move.csv                                     columns time_s, JOINT.position, JOINT.velocity, …
  takt check ur5e trajectory.json --payload 3
  takt check ur5e move.csv --interpolation cubic --json
  takt plan move ur5e --from … --to … --sample-period 8ms --json | takt check ur5e -

The set-points of a plan jump in acceleration at its switching times, and polynomials between samples overshoot such a
jump: by up to a third of it where they are cubic, by half where they are quintic. Read back like this, a plan that uses
all the torque breaks its limit, as it would on a controller that interpolates so. To leave such a controller room, plan
with less: --utilization 0.7, say.

A file holds a trajectory, a request to check one, or the reply to a plan with its set-points.
Exit code 3: a limit is broken; the answer says which, by how much, and when.")]
pub(crate) struct CheckArgs {
    /// The robot.
    robot_id: String,
    /// The trajectory in CSV, JSON, YAML or TOML; - for standard input.
    trajectory: String,
    /// What runs between the points. Default: quintic where accelerations are given, cubic where velocities are.
    #[arg(long, value_enum)]
    interpolation: Option<InterpolationName>,
    /// Part of each peak torque that may be used, above 0 up to 1.
    #[arg(long, value_name = "PART")]
    utilization: Option<f64>,
    /// Tightens a limit for this check, as in elbow_joint.velocity=1.5 (SI units); may be given several times.
    #[arg(long, value_name = "JOINT.LIMIT=VALUE", value_parser = limit)]
    limit: Vec<(String, String, f64)>,
    /// Time from one start of this trajectory to the next, for the RMS torque, as in 3s.
    #[arg(long, value_name = "TIME", value_parser = numbers::seconds)]
    cycle_time: Option<f64>,
    #[command(flatten)]
    confidence: ConfidenceArgs,
    #[command(flatten)]
    payload: PayloadArgs,
    /// A revision other than the current one.
    #[arg(long)]
    revision: Option<String>,
    /// Print the reply as it is.
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum InterpolationName {
    Linear,
    Cubic,
    Quintic,
}

pub(crate) async fn run(args: CheckArgs, client: &Client, io: &mut Io) -> Result<u8, Failure> {
    let text = files::read(&args.trajectory, io)?;
    let is_csv = args.trajectory.ends_with(".csv") || csv::looks_like_csv(&text);
    let robot = match is_csv || !args.json {
        true => context::robot(client, &args.robot_id, args.revision.as_deref()).await?,
        false => v1::Robot::default(),
    };
    let mut request = if is_csv {
        let joints: Vec<String> = robot.joints.iter().map(|joint| joint.name.clone()).collect();
        let trajectory = Some(csv::trajectory(&text, &joints)?);
        v1::CheckTrajectoryRequest {
            trajectory,
            ..Default::default()
        }
    } else {
        files::check_request(&args.trajectory, &text)?
    };
    apply(&args, &mut request);
    refuse_trace(&request)?;
    let reply = client.check_trajectory(request).await?;
    if args.json {
        context::print_json(&reply, io)?;
    } else {
        io.print(&render::report(&reply, &robot, io.terminal))?;
    }
    Ok(if reply.holds { exit::OK } else { exit::NO })
}

/// A trace has two samples at each switching time; a trajectory has one.
fn refuse_trace(request: &v1::CheckTrajectoryRequest) -> Result<(), Failure> {
    let points = request
        .trajectory
        .as_ref()
        .map_or(&[][..], |trajectory| &trajectory.points);
    match points
        .windows(2)
        .find(|pair| pair[0].time_s.to_bits() == pair[1].time_s.to_bits())
    {
        Some(pair) => Err(
            Failure::usage(format!("two points at the same time, {} s", pair[0].time_s))
                .hint("a trace has both sides of each switching time; take set-points instead: --sample-period 4ms"),
        ),
        None => Ok(()),
    }
}

/// Options take the place of the file's fields.
fn apply(args: &CheckArgs, request: &mut v1::CheckTrajectoryRequest) {
    request.robot_id.clone_from(&args.robot_id);
    request.limits.extend(limits(&args.limit));
    request.payload = args.payload.payload().or(request.payload.take());
    request.revision = args.revision.clone().or(request.revision.take());
    request.torque_utilization = args.utilization.or(request.torque_utilization);
    request.confidence = args.confidence.or(request.confidence.take());
    request.cycle_time_s = args.cycle_time.or(request.cycle_time_s);
    if let (Some(name), Some(trajectory)) = (args.interpolation, request.trajectory.as_mut()) {
        trajectory.interpolation = Some(i32::from(match name {
            InterpolationName::Linear => v1::Interpolation::Linear,
            InterpolationName::Cubic => v1::Interpolation::Cubic,
            InterpolationName::Quintic => v1::Interpolation::Quintic,
        }));
    }
}
