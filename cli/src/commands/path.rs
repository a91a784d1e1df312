//! `takt plan path`.

use clap::Args;
use takt_client::{Client, v1};

use super::{
    confidence::ConfidenceArgs,
    context::{self, PayloadArgs, limit, limits},
    plan::{Output, Samples},
};
use crate::{
    exit,
    failure::Failure,
    files,
    io::Io,
    render::{
        curves::Curves,
        html_path, path as tables,
        svg::{self, Heading},
        terminal_plot,
        words::Units,
    },
};

/// Plans a robot program: joint moves, lines, arcs and splines, blended into one motion as fast as every limit allows.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  takt plan path ur5e examples/pick_and_place.yaml
  takt plan path ur5e examples/welding_seam.yaml --plot
  takt plan path ur5e examples/glue_bead.yaml --sample-period 4ms --csv > bead.csv
  takt plan path ur5e program.yaml --sample-period 8ms --ros > trajectory.json
  takt plan path ur5e program.yaml --html report.html --speed-scale 0.5

A program is the API's request in YAML, TOML or JSON:
  start: {position: [0, -1.57, 1.57, -1.57, -1.57, 0]}
  segments:
  - joint: {target: {pose: {position_m: [0.45, 0.1, 0.25], orientation: [0, 1, 0, 0]}}}
    blend: {radius_m: 0.03}
  - line: {target: {pose: {position_m: [0.45, 0.1, 0.15], orientation: [0, 1, 0, 0]}}}
docs/programs.md has all of it.

Exit code 3: the program cannot be run; the answer says where, and what would do.")]
pub(crate) struct PathArgs {
    /// The robot.
    robot_id: String,
    /// The program in YAML, TOML or JSON; - for standard input.
    program: String,
    /// Tables and pictures show degrees for joints that turn.
    #[arg(long)]
    degrees: bool,
    /// A revision other than the current one.
    #[arg(long)]
    revision: Option<String>,
    /// Part of each peak torque that may be used, above 0 up to 1.
    #[arg(long, value_name = "PART")]
    utilization: Option<f64>,
    /// Part of each speed that may be used, above 0 up to 1.
    #[arg(long, value_name = "PART")]
    speed_scale: Option<f64>,
    /// Tightens a limit for the whole path, as in elbow_joint.velocity=1.5 (SI units); may be given several times.
    #[arg(long, value_name = "JOINT.LIMIT=VALUE", value_parser = limit)]
    limit: Vec<(String, String, f64)>,
    #[command(flatten)]
    confidence: ConfidenceArgs,
    #[command(flatten)]
    payload: PayloadArgs,
    #[command(flatten)]
    samples: Samples,
    #[command(flatten)]
    output: Output,
}

pub(super) async fn run(args: PathArgs, client: &Client, io: &mut Io) -> Result<u8, Failure> {
    let request = request(&args, io)?;
    let reply = client.plan_path(request.clone()).await?;
    let feasible = matches!(reply.outcome, Some(v1::plan_path_response::Outcome::Plan(_)));
    let code = if feasible { exit::OK } else { exit::NO };
    let output = &args.output;
    if output.json {
        context::print_json(&reply, io)?;
    }
    if output.json && !(feasible && output.draws()) {
        return Ok(code);
    }
    let used = reply.provenance.clone().unwrap_or_default();
    let robot = match output.is_data() && feasible && !output.draws() {
        true => v1::Robot::default(),
        false => context::robot(client, &args.robot_id, Some(&used.revision)).await?,
    };
    match &reply.outcome {
        Some(v1::plan_path_response::Outcome::Plan(plan)) => show(&args, &request, plan, &used, &robot, io)?,
        Some(v1::plan_path_response::Outcome::Infeasible(no)) => {
            let text = tables::evidence(no, &robot, io.terminal.colour);
            match output.is_data() {
                true => io.remark(text.trim_end())?,
                false => io.print(&text)?,
            }
        }
        None => return Err(Failure::service("the reply holds neither a plan nor a refusal")),
    }
    Ok(code)
}

/// The program, with what the options put in the place of its fields.
fn request(args: &PathArgs, io: &mut Io) -> Result<v1::PlanPathRequest, Failure> {
    let mut request = files::program(&args.program, &files::read(&args.program, io)?)?;
    request.robot_id.clone_from(&args.robot_id);
    if !args.limit.is_empty() {
        let all = request.limits.get_or_insert_default();
        all.joints.extend(limits(&args.limit));
    }
    request.payload = args.payload.payload().or(request.payload);
    request.revision = args.revision.clone().or(request.revision);
    request.torque_utilization = args.utilization.or(request.torque_utilization);
    request.speed_scale = args.speed_scale.or(request.speed_scale);
    request.motor_setpoints = args.samples.motors.then_some(true).or(request.motor_setpoints);
    request.confidence = args.confidence.or(request.confidence.take());
    args.samples
        .apply(&args.output, &mut request.sample_period_s, &mut request.trace_points)?;
    Ok(request)
}

fn show(
    args: &PathArgs,
    request: &v1::PlanPathRequest,
    plan: &v1::PathPlan,
    used: &v1::Provenance,
    robot: &v1::Robot,
    io: &mut Io,
) -> Result<(), Failure> {
    let output = &args.output;
    let units = Units { degrees: args.degrees };
    if output.is_data() {
        output.print_setpoints(&plan.setpoints.clone().unwrap_or_default(), io)?;
    } else if !output.json {
        io.print(&tables::plan(plan, used, robot, units, io.terminal))?;
    }
    if !output.draws() {
        return Ok(());
    }
    let curves = Curves::of_path(plan, robot, request, units)
        .ok_or_else(|| Failure::service("the reply came without samples, so there is nothing to draw"))?;
    if output.plot {
        let picture = terminal_plot::render(&curves, io.terminal.width, io.terminal.colour);
        io.print(&format!("\n{picture}"))?;
    }
    if let Some(file) = &output.svg {
        let facts = tables::facts(plan).into_iter().skip(1);
        let heading = Heading {
            title: format!("{}: a program in {:.3} s", robot.robot_id, plan.duration_s),
            lines: facts.map(|(name, value, _)| format!("{name}: {value}")).collect(),
        };
        files::write(file, &svg::render(&curves, Some(&heading)))?;
        io.remark(&format!("wrote {file}"))?;
    }
    if let Some(file) = &output.html {
        let asked = serde_json::to_string_pretty(request)
            .map_err(|error| Failure::service(format!("the request cannot be written as JSON: {error}")))?;
        files::write(file, &html_path::render(plan, used, robot, &curves, &asked))?;
        io.remark(&format!("wrote {file}"))?;
    }
    Ok(())
}
