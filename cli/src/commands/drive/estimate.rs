//! `takt drive estimate`.

use std::time::{Duration, Instant};

use clap::{Args, ValueEnum};
use takt_client::{
    Client,
    v1::{self, estimate_header},
};

use crate::{
    commands::context::{self, PayloadArgs},
    exit,
    failure::Failure,
    files,
    io::Io,
    numbers,
    render::{
        friction::{self, History},
        svg::{self, Heading},
        terminal_plot,
    },
    telemetry,
};

/// Least time of telemetry between two lines about the progress, s.
const PROGRESS_S: f64 = 10.0;

/// Least time between them as people feel it: a long log is read in a moment, one in ms seems a thousand times as long.
const PROGRESS_FELT: Duration = Duration::from_secs(1);

/// When the progress was last told.
#[derive(Debug, Default)]
struct Progress {
    told: Option<(f64, Instant)>,
}

impl Progress {
    /// Whether it is to be told again, at a time of the telemetry and of the clock.
    fn is_due(&mut self, time_s: f64, now: Instant) -> bool {
        let is_due = self.told.is_none_or(|(told_s, told)| {
            time_s >= told_s + PROGRESS_S && now.saturating_duration_since(told) >= PROGRESS_FELT
        });
        if is_due {
            self.told = Some((time_s, now));
        }
        is_due
    }
}

/// Estimates friction from telemetry: recorded, or as it comes.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  takt drive estimate ur5e telemetry.csv
  takt drive estimate ur5e telemetry.csv --by-direction --plot
  takt drive estimate ur5e telemetry.csv --json > estimate.json && takt drive commit ur5e estimate.json
  read-from-the-controller | takt drive estimate ur5e - --lines       an estimate a line, while it works
  takt drive estimate ur5e monday.csv --save-state friction.json
  takt drive estimate ur5e tuesday.csv --state friction.json          goes on from there

The first line of a CSV names its columns: a time (t, time or time_s), and for every joint what there is of it, by number
or by name. At least the position and what the motor does:
  q1, qd1, qdd1    elbow_joint.position, .velocity, .acceleration     of the joint: rad or m
  tau1             elbow_joint.torque                                 of the motor, seen from the joint: N m or N
  taum1, i1        elbow_joint.motor_torque, .motor_current           of the motor itself: N m, A
  theta1           elbow_joint.motor_position                         of the motor: rad
  tauj1            elbow_joint.transmission_torque                    of a sensor behind the gear: N m or N
  tauext1          elbow_joint.external_torque                        on the surroundings: N m or N
Times may be in other units: t_ms, t_us, t_ns. Semicolons and tabs part cells too, and numbers may then have a decimal comma.
Empty cells and NaN are missing values: their samples are passed over and counted. Lines of JSON are blocks of
`Telemetry` as the API has them.

A robot that stands still teaches nothing: every joint should move both ways, at speeds that differ.
Exit code 3: the motion said enough of no joint; what is missing is said.")]
pub(crate) struct EstimateArgs {
    /// The robot.
    robot_id: String,
    /// Telemetry in CSV or JSON lines; - for standard input.
    telemetry: String,
    /// How it is estimated.
    #[arg(long, value_enum, default_value_t = MethodName::LeastSquares)]
    method: MethodName,
    /// Which friction.
    #[arg(long, value_enum, default_value_t = SideName::Total)]
    side: SideName,
    /// A Coulomb torque for each direction.
    #[arg(long)]
    by_direction: bool,
    /// Also a Coulomb torque in proportion to the gravity torque. Terms that are not asked for are held at the model's values.
    #[arg(long)]
    load: bool,
    /// Also a torque in proportion to the speed squared.
    #[arg(long)]
    quadratic: bool,
    /// Time of motion after which a sample counts half, as in 60s.
    #[arg(long, value_name = "TIME", value_parser = numbers::seconds)]
    half_life: Option<f64>,
    /// In place of the half-life: what every sample lessens those before it by, up to 1 (for ever).
    #[arg(long, value_name = "RATIO", conflicts_with = "half_life")]
    forgetting: Option<f64>,
    /// Speed up to which a joint counts as at rest, rad/s or m/s.
    #[arg(long, value_name = "SPEED")]
    dead_band: Option<f64>,
    /// Corner frequency of the low pass for all signals, Hz; 0 for none.
    #[arg(long, value_name = "HZ")]
    bandwidth: Option<f64>,
    /// Time of telemetry between two estimates, as in 100ms.
    #[arg(long, value_name = "TIME", value_parser = numbers::seconds)]
    report_period: Option<f64>,
    /// Go on from a state that was saved.
    #[arg(long, value_name = "FILE")]
    state: Option<String>,
    /// Save the state at the end, to go on from.
    #[arg(long, value_name = "FILE")]
    save_state: Option<String>,
    #[command(flatten)]
    payload: PayloadArgs,
    /// A revision other than the current one.
    #[arg(long)]
    revision: Option<String>,
    /// Print the last estimate as it is, with what it proposes.
    #[arg(long, group = "form")]
    json: bool,
    /// Print every estimate as it comes, one a line.
    #[arg(long, group = "form")]
    lines: bool,
    /// Also draw how the coefficients came about.
    #[arg(long, conflicts_with = "form")]
    plot: bool,
    /// Write that picture to an SVG file.
    #[arg(long, value_name = "FILE")]
    svg: Option<String>,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum MethodName {
    /// Recursive least squares with forgetting.
    LeastSquares,
    /// An observer of the motor, and least squares on what it sees.
    Observer,
    /// A Kalman filter whose coefficients wander.
    Kalman,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum SideName {
    /// All friction, as torque margins need it.
    Total,
    /// What is behind the gear; takes tauj (a torque sensor), or a model that has the motor's friction.
    Joint,
    /// What is before the gear; takes tauj, or a model that has the joint's friction.
    Motor,
}

pub(super) async fn run(args: EstimateArgs, client: &Client, io: &mut Io) -> Result<u8, Failure> {
    let robot = context::robot(client, &args.robot_id, args.revision.as_deref()).await?;
    let header = header(&args, &robot, io)?;
    let names = robot.joints.iter().map(|joint| joint.name.clone()).collect();
    let (blocks, troubles) = telemetry::blocks(&args.telemetry, names, io)?;
    let mut estimates = client.estimate_friction(&args.robot_id, header, blocks).await?;
    let mut history = History::default();
    let mut progress = Progress::default();
    let mut last = None;
    while let Some(estimate) = estimates.next().await? {
        if args.lines {
            let text = serde_json::to_string(&estimate)
                .map_err(|error| Failure::service(format!("an estimate cannot be written as JSON: {error}")))?;
            if !io.pass(&(text + "\n"))? {
                return Ok(exit::OK);
            }
        }
        history.add(&estimate);
        // Before the first sample there is no time, and nothing to tell.
        if let Some(now) = estimate.time_s.filter(|_| !args.lines)
            && progress.is_due(now, Instant::now())
        {
            io.remark(&format!("{now:.1} s, {} samples", estimate.sample_count))?;
        }
        last = Some(estimate);
    }
    for remark in troubles.remarks() {
        io.remark(&remark)?;
    }
    if let Some(failure) = troubles.take() {
        return Err(failure);
    }
    let last = last.ok_or_else(|| Failure::service("the stream ended without an estimate"))?;
    if let (Some(file), Some(state)) = (&args.save_state, &last.state) {
        let text = serde_json::to_string(state)
            .map_err(|error| Failure::service(format!("the state cannot be written as JSON: {error}")))?;
        files::write(file, &text)?;
        io.remark(&format!("wrote {file}"))?;
    }
    show(&args, &robot, &last, &history, io)?;
    Ok(match last.proposal {
        Some(_) => exit::OK,
        None => exit::NO,
    })
}

fn header(args: &EstimateArgs, robot: &v1::Robot, io: &mut Io) -> Result<v1::EstimateHeader, Failure> {
    let state = match &args.state {
        Some(file) => Some(files::message(file, &files::read(file, io)?)?),
        None => None,
    };
    Ok(v1::EstimateHeader {
        // Pinned, so that what is shown is what was used.
        revision: Some(robot.revision.clone()),
        method: Some(i32::from(match args.method {
            MethodName::LeastSquares => estimate_header::Method::LeastSquares,
            MethodName::Observer => estimate_header::Method::Observer,
            MethodName::Kalman => estimate_header::Method::Kalman,
        })),
        side: Some(i32::from(match args.side {
            SideName::Total => estimate_header::Side::Total,
            SideName::Joint => estimate_header::Side::Joint,
            SideName::Motor => estimate_header::Side::Motor,
        })),
        terms: Some(v1::FrictionTerms {
            by_direction: Some(args.by_direction),
            load: Some(args.load),
            quadratic: Some(args.quadratic),
        }),
        half_life_s: args.half_life,
        forgetting: args.forgetting,
        dead_band: args.dead_band,
        bandwidth_hz: args.bandwidth,
        report_period_s: args.report_period,
        payload: args.payload.payload(),
        state,
        ..Default::default()
    })
}

fn show(
    args: &EstimateArgs,
    robot: &v1::Robot,
    last: &v1::EstimateFrictionResponse,
    history: &History,
    io: &mut Io,
) -> Result<(), Failure> {
    if args.json {
        context::print_json(last, io)?;
        let proposed = last.proposal.iter().flat_map(|proposal| &proposal.warnings);
        io.warn(last.warnings.iter().chain(proposed))?;
    } else if !args.lines {
        io.print(&friction::estimate(last, robot, io.terminal))?;
    }
    if args.plot {
        let picture = terminal_plot::render(&history.curves(robot), io.terminal.width, io.terminal.colour);
        io.print(&format!("\n{picture}"))?;
    }
    if let Some(file) = &args.svg {
        let heading = Heading {
            title: format!("{}: friction from {} samples", robot.robot_id, last.sample_count),
            lines: friction::facts(last),
        };
        files::write(file, &svg::render(&history.curves(robot), Some(&heading)))?;
        io.remark(&format!("wrote {file}"))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn progress_is_told_as_rarely_as_either_clock_says() {
        let start = Instant::now();
        let at = |seconds: u64| start + Duration::from_secs(seconds);
        let mut progress = Progress::default();
        assert!(progress.is_due(0.0, at(0)), "the beginning is told");
        assert!(!progress.is_due(1e6, at(0)), "a log in ms");
        assert!(!progress.is_due(9.0, at(60)), "a log as it comes");
        assert!(progress.is_due(10.0, at(60)));
        assert!(!progress.is_due(15.0, at(70)));
    }
}
