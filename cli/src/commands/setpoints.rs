//! `takt setpoints`.

use clap::Args;
use takt_client::{
    Client,
    v1::{self, plan_move_response, plan_path_response, setpoints_header::Answer, stream_setpoints_request::Motion},
};

use super::context::{self, MotionArgs};
use crate::{
    exit,
    failure::Failure,
    files,
    io::Io,
    numbers,
    render::{csv, infeasible, path},
};

/// Streams the set-points of a move or a program, as CSV or JSON lines, from the moment its plan is verified.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  takt setpoints ur5e --from 0,-90deg,0,0,0,0 --to 1,-1,1,0,0,0 --sample-period 4ms
  takt setpoints ur5e --program examples/welding_seam.yaml --sample-period 4ms | to-the-controller
  takt setpoints scara --program move.json --sample-period 1ms --motors      with feed-forward for the drives
  takt setpoints ur5e --program move.json --sample-period 1ms --json        a header, then chunks, one a line

What reads slowly slows the stream down: nothing piles up. A reader that stops early ends it.

Exit code 3: the motion is infeasible; the evidence is on standard error.")]
pub(crate) struct SetpointsArgs {
    /// The robot.
    robot_id: String,
    #[command(flatten)]
    motion: MotionArgs,
    /// Plain numbers of --from and --to are degrees, for joints that turn.
    #[arg(long, conflicts_with = "program")]
    degrees: bool,
    /// Time between set-points, as in 4ms. Default: the program's.
    #[arg(long, value_name = "TIME", value_parser = numbers::seconds)]
    sample_period: Option<f64>,
    /// Most set-points of one chunk, 1 to 200.
    #[arg(long, value_name = "COUNT")]
    chunk: Option<u32>,
    /// Also torque and current of the motors, with the friction of the revision.
    #[arg(long)]
    motors: bool,
    /// Print the parts of the stream as they are, one a line.
    #[arg(long)]
    json: bool,
}

pub(crate) async fn run(args: SetpointsArgs, client: &Client, io: &mut Io) -> Result<u8, Failure> {
    let request = v1::StreamSetpointsRequest {
        robot_id: args.robot_id.clone(),
        motion: Some(with_motors(motion(&args, client, io).await?, args.motors)),
        sample_period_s: args.sample_period,
        chunk_points: args.chunk,
    };
    let stream = client.stream_setpoints(request).await;
    let mut stream = stream.map_err(without_period)?;
    let header = stream.header().clone();
    let refusal = refusal(&args, &header, client, io).await?;
    if args.json {
        print_line(&header, io)?;
    }
    if let Some(text) = refusal {
        io.remark(text.trim_end())?;
        return Ok(exit::NO);
    }
    for warning in warnings(&header) {
        io.remark(&format!("warning: {warning}"))?;
    }
    let mut is_first = true;
    while let Some(chunk) = stream.next().await? {
        let is_written = if args.json {
            io.pass(&line(&chunk)?)?
        } else {
            let setpoints = chunk.setpoints.unwrap_or_default();
            let head = if is_first { csv::head(&setpoints) } else { String::new() };
            io.pass(&(head + &csv::rows(&setpoints)))?
        };
        if !is_written {
            break;
        }
        is_first = false;
    }
    Ok(exit::OK)
}

/// Why there is no stream; where it has no period, how to give one.
fn without_period(error: takt_client::Error) -> Failure {
    let is_period = error
        .violations()
        .iter()
        .any(|one| one.field.ends_with("sample_period_s"));
    match is_period {
        true => Failure::from(error).hint("give the time between set-points, as in --sample-period 4ms"),
        false => error.into(),
    }
}

async fn motion(args: &SetpointsArgs, client: &Client, io: &mut Io) -> Result<Motion, Failure> {
    if let Some(file) = &args.motion.program {
        let text = files::read(file, io)?;
        return match files::has_key(file, &text, "segments") {
            true => files::program(file, &text).map(Motion::Path),
            false => files::message(file, &text).map(Motion::Move),
        };
    }
    let between = args.motion.between(args.degrees, client, &args.robot_id, None);
    Ok(Motion::Move(between.await?))
}

/// Asks for set-points of the motors; what a file says of them stays where nothing is asked.
fn with_motors(mut motion: Motion, motors: bool) -> Motion {
    let asked = match &mut motion {
        Motion::Move(request) => &mut request.motor_setpoints,
        Motion::Path(request) => &mut request.motor_setpoints,
    };
    *asked = motors.then_some(true).or(*asked);
    motion
}

/// What the plan warns of; motors without set-points are among it.
fn warnings(header: &v1::SetpointsHeader) -> &[String] {
    match &header.answer {
        Some(Answer::Move(v1::PlanMoveResponse {
            outcome: Some(plan_move_response::Outcome::Plan(plan)),
            ..
        })) => &plan.warnings,
        Some(Answer::Path(v1::PlanPathResponse {
            outcome: Some(plan_path_response::Outcome::Plan(plan)),
            ..
        })) => &plan.warnings,
        _ => &[],
    }
}

/// The evidence, where the motion is infeasible.
async fn refusal(
    args: &SetpointsArgs,
    header: &v1::SetpointsHeader,
    client: &Client,
    io: &Io,
) -> Result<Option<String>, Failure> {
    let colour = io.terminal.error_colour;
    match &header.answer {
        Some(Answer::Move(v1::PlanMoveResponse {
            outcome: Some(plan_move_response::Outcome::Infeasible(no)),
            ..
        })) => {
            let robot = context::robot(client, &args.robot_id, None).await?;
            Ok(Some(infeasible::evidence(no, &robot, colour)))
        }
        Some(Answer::Path(v1::PlanPathResponse {
            outcome: Some(plan_path_response::Outcome::Infeasible(no)),
            ..
        })) => {
            let robot = context::robot(client, &args.robot_id, None).await?;
            Ok(Some(path::evidence(no, &robot, colour)))
        }
        _ => Ok(None),
    }
}

fn line<M: serde::Serialize>(part: &M) -> Result<String, Failure> {
    let text = serde_json::to_string(part);
    let text = text.map_err(|error| Failure::service(format!("a part cannot be written as JSON: {error}")))?;
    Ok(text + "\n")
}

fn print_line<M: serde::Serialize>(part: &M, io: &mut Io) -> Result<(), Failure> {
    io.print(&line(part)?)
}
