//! `takt plan`.

use clap::{Args, Subcommand, ValueEnum};
use takt_client::{Client, v1};

use super::{
    batch::{self, BatchArgs},
    confidence::ConfidenceArgs,
    context::{self, PayloadArgs, limit, limits},
    path::{self, PathArgs},
};
use crate::{
    exit,
    failure::Failure,
    files,
    io::Io,
    numbers::{self, JointValues},
    render::{
        csv,
        curves::Curves,
        html, infeasible, plan as tables, ros,
        svg::{self, Heading},
        terminal_plot,
        words::Units,
    },
};

/// Samples asked for where a picture is to be drawn and nothing else was said.
const PICTURE_POINTS: u32 = 400;

/// Plans motions.
#[derive(Debug, Subcommand)]
pub(crate) enum PlanCommand {
    Move(Box<MoveArgs>),
    Path(Box<PathArgs>),
    Batch(BatchArgs),
}

pub(crate) async fn run(command: PlanCommand, client: &Client, io: &mut Io) -> Result<u8, Failure> {
    match command {
        PlanCommand::Move(args) => plan_move(*args, client, io).await,
        PlanCommand::Path(args) => path::run(*args, client, io).await,
        PlanCommand::Batch(args) => batch::run(args, client, io).await,
    }
}

/// Plans a move from one configuration to another: as fast as every limit allows, with the proof.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  takt plan move ur5e --from 0,-90deg,0,0,0,0 --to 1,-1,1,0,0,0
  takt plan move ur5e --degrees --from 0,-90,0,0,0,0 --to 60,-60,60,0,0,0 --payload 3 --plot
  takt plan move ur5e --from … --to … --sample-period 4ms --csv > move.csv      set-points for a controller
  takt plan move ur5e --from … --to … --html report.html                       a report to hand on
  takt plan move ur5e --from … --to … --sample-period 8ms --ros                a ROS trajectory_msgs/JointTrajectory
  takt plan move ur5e --from … --to … --limit elbow_joint.velocity=1.5 --utilization 0.9
  takt plan move fitted --from … --to … --confidence 95% --per-move             limits hold with what a fit left open
  takt plan move ur5e --request move.json --json                               as the API takes and gives it
  takt plan move ur5e --from … --to … --sample-period 8ms --json | takt check ur5e -

Exit code 3: the move is infeasible; the answer says which joint, where, and what would do.")]
pub(crate) struct MoveArgs {
    /// The robot.
    robot_id: String,
    /// Joint positions to start from, in model order: rad or m, or with a unit (90deg, 5mm).
    #[arg(
        long,
        value_name = "Q1,Q2,…",
        required_unless_present = "request",
        allow_hyphen_values = true
    )]
    from: Option<JointValues>,
    /// Joint positions to end at.
    #[arg(
        long,
        value_name = "Q1,Q2,…",
        required_unless_present = "request",
        allow_hyphen_values = true
    )]
    to: Option<JointValues>,
    /// A request in JSON, YAML or TOML; - for standard input. Options given besides take the place of its fields.
    #[arg(long, value_name = "FILE")]
    request: Option<String>,
    /// Plain numbers are degrees, for joints that turn; tables and pictures show degrees.
    #[arg(long)]
    degrees: bool,
    /// A revision other than the current one.
    #[arg(long)]
    revision: Option<String>,
    /// How to plan. Default: verified.
    #[arg(long, value_enum)]
    method: Option<MethodName>,
    /// Speed asked for, per joint. Default: the speed limits.
    #[arg(long, value_name = "V1,V2,…", allow_hyphen_values = true)]
    target_velocity: Option<JointValues>,
    /// Part of each peak torque that may be used, above 0 up to 1.
    #[arg(long, value_name = "PART")]
    utilization: Option<f64>,
    /// Part of each speed that may be used, above 0 up to 1.
    #[arg(long, value_name = "PART")]
    speed_scale: Option<f64>,
    /// Tightens a limit for this move, as in elbow_joint.velocity=1.5 (SI units); may be given several times.
    #[arg(long, value_name = "JOINT.LIMIT=VALUE", value_parser = limit)]
    limit: Vec<(String, String, f64)>,
    /// Time from one start of this move to the next, for the RMS torque, as in 3s.
    #[arg(long, value_name = "TIME", value_parser = numbers::seconds)]
    cycle_time: Option<f64>,
    #[command(flatten)]
    confidence: ConfidenceArgs,
    #[command(flatten)]
    payload: PayloadArgs,
    #[command(flatten)]
    samples: Samples,
    #[command(flatten)]
    output: Output,
}

#[derive(Debug, Args)]
#[command(next_help_heading = "Samples")]
pub(super) struct Samples {
    /// Set-points at this period, as in 4ms; the duration becomes a whole number of periods.
    #[arg(long, value_name = "TIME", value_parser = numbers::seconds, conflicts_with = "trace")]
    sample_period: Option<f64>,
    /// So many samples of the plan as it is. Default: 400 where a picture is drawn.
    #[arg(long, value_name = "COUNT")]
    trace: Option<u32>,
    /// Also torque and current of the motors, with the friction of the revision; needs --sample-period.
    #[arg(long)]
    pub(super) motors: bool,
}

impl Samples {
    /// Puts what is asked for into the fields of a request, and what a form of output needs where nothing is.
    pub(super) fn apply(
        &self,
        output: &Output,
        sample_period_s: &mut Option<f64>,
        trace_points: &mut Option<u32>,
    ) -> Result<(), Failure> {
        if self.sample_period.is_some() || self.trace.is_some() {
            (*sample_period_s, *trace_points) = (self.sample_period, self.trace);
        }
        if output.ros && sample_period_s.is_none() {
            return Err(Failure::usage("--ros needs to know the period of the points")
                .hint("as for a controller: --sample-period 4ms"));
        }
        if sample_period_s.is_some() || trace_points.is_some() {
            return Ok(());
        }
        if output.csv {
            return Err(Failure::usage("--csv needs to know which samples to print")
                .hint("set-points for a controller: --sample-period 4ms")
                .hint("the plan as it is: --trace 400"));
        }
        *trace_points = output.draws().then_some(PICTURE_POINTS);
        Ok(())
    }
}

#[derive(Debug, Args)]
#[command(next_help_heading = "Output (default: tables)")]
pub(super) struct Output {
    /// Print the reply as it is.
    #[arg(long, group = "form")]
    pub(super) json: bool,
    /// Print the set-points as CSV.
    #[arg(long, group = "form")]
    pub(super) csv: bool,
    /// Print the set-points as the JSON of a ROS trajectory_msgs/JointTrajectory.
    #[arg(long, group = "form")]
    pub(super) ros: bool,
    /// Also draw speed and torque against their limits.
    #[arg(long, conflicts_with = "form")]
    pub(super) plot: bool,
    /// Write the curves to an SVG file.
    #[arg(long, value_name = "FILE")]
    pub(super) svg: Option<String>,
    /// Write a report with tables and curves to an HTML file, complete in itself.
    #[arg(long, value_name = "FILE")]
    pub(super) html: Option<String>,
}

impl Output {
    pub(super) fn draws(&self) -> bool {
        self.plot || self.svg.is_some() || self.html.is_some()
    }

    /// Whether the answer is for a program, which must not find sentences in it.
    pub(super) fn is_data(&self) -> bool {
        self.csv || self.ros
    }

    /// Prints set-points in the form asked for.
    pub(super) fn print_setpoints(&self, setpoints: &v1::Setpoints, io: &mut Io) -> Result<(), Failure> {
        match self.ros {
            true => context::print_json(&ros::trajectory(setpoints), io),
            false => io.print(&csv::setpoints(setpoints)),
        }
    }
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum MethodName {
    /// The conventional synchronized pattern: fixed accelerations per joint.
    Preset,
    /// Accelerations from the torque left at both end poses.
    Endpoint,
    /// One time law that keeps every limit everywhere and uses the room that is left.
    Verified,
}

async fn plan_move(args: MoveArgs, client: &Client, io: &mut Io) -> Result<u8, Failure> {
    let revision = args.revision.as_deref();
    let mut robot = match args.degrees {
        true => Some(context::robot(client, &args.robot_id, revision).await?),
        false => None,
    };
    let request = request(&args, robot.as_ref(), io)?;
    let reply = client.plan_move(request.clone()).await?;
    let feasible = matches!(reply.outcome, Some(v1::plan_move_response::Outcome::Plan(_)));
    let code = if feasible { exit::OK } else { exit::NO };
    if args.output.json {
        context::print_json(&reply, io)?;
    }
    if args.output.json && !(feasible && args.output.draws()) {
        return Ok(code);
    }
    // The limits and names of the very revision that the plan is of.
    let used = reply.provenance.clone().unwrap_or_default();
    let needed = !args.output.is_data() || args.output.draws() || !feasible;
    let other = robot.as_ref().is_none_or(|robot| robot.revision != used.revision);
    if needed && other {
        robot = Some(context::robot(client, &args.robot_id, Some(&used.revision)).await?);
    }
    let robot = robot.unwrap_or_default();
    match &reply.outcome {
        Some(v1::plan_move_response::Outcome::Plan(plan)) => show(&args, &request, plan, &used, &robot, io)?,
        Some(v1::plan_move_response::Outcome::Infeasible(no)) => {
            let text = infeasible::evidence(no, &robot, io.terminal.colour);
            match args.output.is_data() {
                true => io.remark(text.trim_end())?,
                false => io.print(&text)?,
            }
        }
        None => {
            return Err(Failure::service("the reply holds neither a plan nor a refusal"));
        }
    }
    Ok(code)
}

fn request(args: &MoveArgs, robot: Option<&v1::Robot>, io: &mut Io) -> Result<v1::PlanMoveRequest, Failure> {
    let mut request = match &args.request {
        Some(file) => files::message(file, &files::read(file, io)?)?,
        None => v1::PlanMoveRequest::default(),
    };
    let values = |values: &JointValues| context::si(values, args.degrees, robot);
    request.robot_id.clone_from(&args.robot_id);
    if let Some(from) = &args.from {
        request.start = Some(v1::JointPosition { position: values(from) });
    }
    if let Some(to) = &args.to {
        request.target = Some(v1::JointPosition { position: values(to) });
    }
    if let Some(speeds) = &args.target_velocity {
        request.target_velocity = values(speeds);
    }
    if let Some(method) = args.method {
        request.method = Some(i32::from(match method {
            MethodName::Preset => v1::Method::Preset,
            MethodName::Endpoint => v1::Method::Endpoint,
            MethodName::Verified => v1::Method::Verified,
        }));
    }
    request.limits.extend(limits(&args.limit));
    request.payload = args.payload.payload().or(request.payload);
    request.revision = args.revision.clone().or(request.revision);
    request.torque_utilization = args.utilization.or(request.torque_utilization);
    request.speed_scale = args.speed_scale.or(request.speed_scale);
    request.cycle_time_s = args.cycle_time.or(request.cycle_time_s);
    request.motor_setpoints = args.samples.motors.then_some(true).or(request.motor_setpoints);
    request.confidence = args.confidence.or(request.confidence.take());
    args.samples
        .apply(&args.output, &mut request.sample_period_s, &mut request.trace_points)?;
    Ok(request)
}

fn show(
    args: &MoveArgs,
    request: &v1::PlanMoveRequest,
    plan: &v1::MovePlan,
    used: &v1::Provenance,
    robot: &v1::Robot,
    io: &mut Io,
) -> Result<(), Failure> {
    let units = Units { degrees: args.degrees };
    let output = &args.output;
    if output.is_data() {
        output.print_setpoints(&plan.setpoints.clone().unwrap_or_default(), io)?;
    } else if !output.json {
        io.print(&tables::plan(plan, used, robot, units, io.terminal))?;
    }
    if !output.draws() {
        return Ok(());
    }
    let curves = Curves::of(plan, robot, &request.limits, units)
        .ok_or_else(|| Failure::service("the reply came without samples, so there is nothing to draw"))?;
    if output.plot {
        let picture = terminal_plot::render(&curves, io.terminal.width, io.terminal.colour);
        io.print(&format!("\n{picture}"))?;
    }
    if let Some(file) = &output.svg {
        let heading = Heading {
            title: format!("{}: a move in {:.3} s", robot.robot_id, plan.duration_s),
            lines: tables::facts(plan)
                .into_iter()
                .skip(1)
                .map(|(name, value, _)| format!("{name}: {value}"))
                .collect(),
        };
        files::write(file, &svg::render(&curves, Some(&heading)))?;
        io.remark(&format!("wrote {file}"))?;
    }
    if let Some(file) = &output.html {
        let asked = serde_json::to_string_pretty(request)
            .map_err(|error| Failure::service(format!("the request cannot be written as JSON: {error}")))?;
        files::write(file, &html::render(plan, used, robot, &curves, units, &asked))?;
        io.remark(&format!("wrote {file}"))?;
    }
    Ok(())
}
