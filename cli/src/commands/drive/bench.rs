//! `takt drive fit-stiffness`, `fit-damping` and `fit-constant-speed`: one joint, measured on the bench.

use clap::Args;
use takt_client::{
    Client,
    v1::{self, fit_drive_request::Fit, fit_drive_response::Outcome},
};

use crate::{
    commands::context,
    exit,
    failure::Failure,
    files,
    io::Io,
    render::{bench as render, fit},
    sheet::{self, Column},
};

/// What the fits of one joint share.
#[derive(Debug, Args)]
struct BenchArgs {
    /// The robot.
    robot_id: String,
    /// The measurements in CSV; - for standard input.
    file: String,
    /// The joint that they are of.
    #[arg(long)]
    joint: String,
    /// A revision other than the current one.
    #[arg(long)]
    revision: Option<String>,
    /// Print the reply as it is, with what it proposes.
    #[arg(long)]
    json: bool,
}

/// Fits a transmission's stiffness to torques and the deformations under them.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  takt drive fit-stiffness scara spring.csv --joint shoulder
  takt drive fit-stiffness scara spring.csv --joint shoulder --terms 2 --json > fit.json && takt drive commit scara fit.json

The file has one row a measurement, the output held and the motor turned against it, or the output loaded:

  torque,deformation
  -12.1,-0.0010
  0.3,0
  12.4,0.0010

torque       through the transmission, N m (N where the joint slides)
deformation  of the transmission, the motor's position over the gear ratio less the joint's, rad (m)

Exit code 3: the measurements do not say it; the answer says what is missing.")]
pub(crate) struct StiffnessArgs {
    #[command(flatten)]
    bench: BenchArgs,
    /// Terms of the polynomial of odd powers: 1 is a plain spring, 2 adds the cube. Default: 1.
    #[arg(long, value_name = "COUNT")]
    terms: Option<u32>,
}

/// Fits a transmission's damping and its Coulomb friction to the maxima of a free oscillation.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  takt drive fit-damping scara swing.csv --joint shoulder
  takt drive fit-damping scara swing.csv --joint shoulder --json > fit.json && takt drive commit scara fit.json

The motor swings against its transmission, the output held. The file has one row a maximum, all of them on one side:

  time_s,amplitude
  0,0.0010
  0.021,0.0008
  0.042,0.00064

time_s     when, s; also: t, time
amplitude  from the unloaded position, seen from the joint, rad (m where the joint slides)

Three maxima are the least: one pair cannot tell damping from Coulomb friction. The model needs the rotor's inertia.
Exit code 3: the maxima do not say it; the answer says what is missing.")]
pub(crate) struct DampingArgs {
    #[command(flatten)]
    bench: BenchArgs,
}

/// Fits a joint's friction to runs at constant speed.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  takt drive fit-constant-speed scara runs.csv --joint shoulder
  takt drive fit-constant-speed scara runs.csv --joint shoulder --json > fit.json && takt drive commit scara fit.json

The joint turns about a vertical axis, so that gravity asks nothing. The file has one row a run, the means over it:

  speed,motor_torque,deformation
  -1.0,-7.1,-0.00021
  -0.5,-5.4,-0.00019
  0.5,6.6,0.00020
  1.0,8.1,0.00022

speed         in the direction of motion, rad/s (m/s where the joint slides)
motor_torque  seen from the joint, N m (N)
deformation   of the transmission, rad (m); may be left out. With it, and the model's stiffness, friction before and
              behind the gear are told apart

Four runs are the least, in both directions and at different speeds.
Exit code 3: the runs do not say it; the answer says what is missing.")]
pub(crate) struct ConstantSpeedArgs {
    #[command(flatten)]
    bench: BenchArgs,
}

const fn needed(names: &'static [&'static str]) -> Column {
    Column { names, optional: false }
}

const DEFORMATION: &[&str] = &["deformation"];

/// A column of a sheet in which every cell is given.
fn column<const N: usize>(rows: &[[Option<f64>; N]], index: usize) -> Vec<f64> {
    rows.iter().filter_map(|row| row[index]).collect()
}

pub(super) async fn stiffness(args: StiffnessArgs, client: &Client, io: &mut Io) -> Result<u8, Failure> {
    let rows = sheet::rows(
        &files::read(&args.bench.file, io)?,
        [needed(&["torque"]), needed(DEFORMATION)],
    )?;
    let asked = Fit::Stiffness(v1::StiffnessFitRequest {
        joint: args.bench.joint.clone(),
        torque: column(&rows, 0),
        deformation: column(&rows, 1),
        terms: args.terms,
    });
    run(args.bench, asked, client, io).await
}

pub(super) async fn damping(args: DampingArgs, client: &Client, io: &mut Io) -> Result<u8, Failure> {
    let rows = sheet::rows(
        &files::read(&args.bench.file, io)?,
        [needed(&["time_s", "t", "time"]), needed(&["amplitude"])],
    )?;
    let asked = Fit::Damping(v1::DampingFitRequest {
        joint: args.bench.joint.clone(),
        time_s: column(&rows, 0),
        amplitude: column(&rows, 1),
    });
    run(args.bench, asked, client, io).await
}

pub(super) async fn constant_speed(args: ConstantSpeedArgs, client: &Client, io: &mut Io) -> Result<u8, Failure> {
    let deformation = Column {
        names: DEFORMATION,
        optional: true,
    };
    let rows = sheet::rows(
        &files::read(&args.bench.file, io)?,
        [needed(&["speed"]), needed(&["motor_torque"]), deformation],
    )?;
    let runs = rows
        .into_iter()
        .map(|[speed, motor_torque, deformation]| v1::ConstantSpeedRun {
            speed: speed.unwrap_or_default(),
            motor_torque: motor_torque.unwrap_or_default(),
            deformation,
        });
    let asked = Fit::ConstantSpeed(v1::ConstantSpeedFitRequest {
        joint: args.bench.joint.clone(),
        runs: runs.collect(),
    });
    run(args.bench, asked, client, io).await
}

async fn run(args: BenchArgs, asked: Fit, client: &Client, io: &mut Io) -> Result<u8, Failure> {
    let robot = context::robot(client, &args.robot_id, args.revision.as_deref()).await?;
    let request = v1::FitDriveRequest {
        robot_id: args.robot_id,
        revision: Some(robot.revision.clone()),
        fit: Some(asked),
    };
    let reply = client.fit_drive(request).await?;
    let (text, code) = match &reply.outcome {
        Some(Outcome::Stiffness(fit)) => (render::stiffness(fit, &robot, io.terminal), exit::OK),
        Some(Outcome::Damping(fit)) => (render::damping(fit, &robot, io.terminal), exit::OK),
        Some(Outcome::ConstantSpeed(fit)) => (render::constant_speed(fit, &robot, io.terminal), exit::OK),
        Some(Outcome::NotExcited(missing)) => (fit::missing("measurements do", missing, io.terminal.colour), exit::NO),
        Some(Outcome::Motion(_)) | None => {
            return Err(Failure::service("the reply holds neither a fit nor what is missing"));
        }
    };
    if args.json {
        context::print_json(&reply, io)?;
        let of_fit = match &reply.outcome {
            Some(Outcome::ConstantSpeed(fit)) => &fit.warnings[..],
            Some(Outcome::NotExcited(missing)) => &missing.warnings,
            _ => &[],
        };
        let proposed = reply.proposal.iter().flat_map(|proposal| &proposal.warnings);
        io.warn(of_fit.iter().chain(proposed))?;
    } else {
        io.print(&text)?;
        io.print(&fit::proposal(reply.proposal.as_ref(), &robot.robot_id))?;
    }
    Ok(code)
}
