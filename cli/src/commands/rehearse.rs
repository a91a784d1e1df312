//! `takt rehearse`.

use clap::Args;
use takt_client::{
    Client,
    v1::{self, rehearse_request::Motion, rehearse_response::Outcome},
};

use super::context::{self, MotionArgs};
use crate::{
    exit,
    failure::Failure,
    files, follow,
    io::Io,
    numbers,
    render::{
        infeasible, path, rehearsal,
        svg::{self, Heading},
        terminal_plot,
        words::Units,
    },
};

/// Points of a trace, about, where there is something to draw.
const TRACE_POINTS: f64 = 400.0;

/// Runs a motion on a simulated arm whose friction is not the model's, with and without adaptation.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  takt rehearse scara --from -1,1,0.1,0 --to 1,0.6,0.12,0.4 --friction 1.5
  takt rehearse ur5e --degrees --from 0,-90,0,0,0,0 --to 60,-60,60,0,0,0 --friction 150%
  takt rehearse scara --program examples/scara_pick_and_place.yaml --friction 150% --plot
  takt rehearse scara --program move.json --friction elbow=2 --drift 0.1 --settle 1s
  takt rehearse scara --program rehearsal.yaml --json         a whole request of the API

The arm swings against its transmissions where the model has their stiffness and the rotors' inertia; elsewhere they are
rigid. The model's friction is what the controller begins with; --friction is by how much the arm's own differs.

A program is a request to plan a move or a path, a trajectory (`trajectory: {points: …}`), or a whole request to
rehearse, in YAML, TOML or JSON. What the request says of encoders, wrenches and gains is in docs/api.md.

Exit code 3: the motion cannot be planned, or the simulated arm did not follow it, with the model's friction or with adapted
friction: the run ended early, a joint was farther than 0.2 rad or 0.1 m from the plan at some time, or farther than 0.05 rad or
10 mm from its place at the end. Which joint and which run is said.")]
pub(crate) struct RehearseArgs {
    /// The robot.
    robot_id: String,
    #[command(flatten)]
    motion: MotionArgs,
    /// True friction over the model's: 1.5 or 150% is half as much again, of one joint elbow_joint=1.5; may be given several times.
    #[arg(long, value_name = "[JOINT=]RATIO", value_parser = of_joint)]
    friction: Vec<(String, f64)>,
    /// By how much that ratio changes every second, as in 0.1 or elbow_joint=-0.05.
    #[arg(long, value_name = "[JOINT=]RATIO", value_parser = of_joint, allow_hyphen_values = true)]
    drift: Vec<(String, f64)>,
    /// Time at rest after the motion, as in 500ms.
    #[arg(long, value_name = "TIME", value_parser = numbers::seconds)]
    settle: Option<f64>,
    /// The controller's period, as in 1ms.
    #[arg(long, value_name = "TIME", value_parser = numbers::seconds)]
    period: Option<f64>,
    /// Rate of the observer that adapts friction, 1/s.
    #[arg(long, value_name = "RATE")]
    adaptation_rate: Option<f64>,
    /// A revision other than the current one.
    #[arg(long)]
    revision: Option<String>,
    /// Plain numbers of --from and --to are degrees, for joints that turn; tables and pictures show degrees.
    #[arg(long)]
    degrees: bool,
    /// Print the reply as it is.
    #[arg(long)]
    json: bool,
    /// Also draw the joints' distance from the plan, without and with adaptation.
    #[arg(long, conflicts_with = "json")]
    plot: bool,
    /// Write that picture to an SVG file.
    #[arg(long, value_name = "FILE")]
    svg: Option<String>,
}

/// `1.5` or `150%` is of every joint, `elbow=1.5` of one.
fn of_joint(text: &str) -> Result<(String, f64), String> {
    let (joint, value) = text.rsplit_once('=').unwrap_or(("", text));
    let value = numbers::ratio(value)
        .map_err(|error| format!("{error}; as in 1.5 or 150%, of one joint as elbow_joint=1.5"))?;
    Ok((joint.trim().to_owned(), value))
}

pub(crate) async fn run(args: RehearseArgs, client: &Client, io: &mut Io) -> Result<u8, Failure> {
    let mut request = request(&args, client, io).await?;
    let draws = args.plot || args.svg.is_some();
    if draws && request.trace_every.is_none() {
        request.trace_every = Some(trace_every(client, &request).await?);
    }
    let reply = client.rehearse(request).await?;
    if args.json {
        context::print_json(&reply, io)?;
    }
    let used = reply.provenance.clone().unwrap_or_default();
    let robot = context::robot(client, &args.robot_id, Some(&used.revision)).await?;
    match &reply.outcome {
        Some(Outcome::Rehearsal(rehearsal)) => {
            if !args.json {
                let units = Units { degrees: args.degrees };
                io.print(&rehearsal::report(rehearsal, &robot, units, io.terminal))?;
            }
            if draws {
                draw(&args, rehearsal, &robot, io)?;
            }
            let lost = follow::lost(rehearsal, &robot);
            for sentence in &lost {
                io.remark(sentence)?;
            }
            Ok(match lost.is_empty() {
                true => exit::OK,
                false => exit::NO,
            })
        }
        Some(no) => {
            if !args.json {
                io.print(&evidence(no, &robot, io.terminal.colour))?;
            }
            Ok(exit::NO)
        }
        None => Err(Failure::service("the reply holds neither a rehearsal nor a refusal")),
    }
}

fn evidence(no: &Outcome, robot: &v1::Robot, colour: bool) -> String {
    match no {
        Outcome::MoveInfeasible(no) => infeasible::evidence(no, robot, colour),
        Outcome::PathInfeasible(no) => path::evidence(no, robot, colour),
        Outcome::TransmissionRange(range) => rehearsal::range(range, robot, colour),
        Outcome::Rehearsal(_) => String::new(),
    }
}

fn draw(args: &RehearseArgs, rehearsal: &v1::Rehearsal, robot: &v1::Robot, io: &mut Io) -> Result<(), Failure> {
    let curves = rehearsal::curves(rehearsal, robot, Units { degrees: args.degrees })
        .ok_or_else(|| Failure::service("the reply came without traces, so there is nothing to draw"))?;
    if args.plot {
        let picture = terminal_plot::render(&curves, io.terminal.width, io.terminal.colour);
        io.print(&format!("\n{picture}"))?;
    }
    if let Some(file) = &args.svg {
        let heading = Heading {
            title: format!("{}: a rehearsal of {:.3} s", robot.robot_id, rehearsal.duration_s),
            lines: rehearsal::facts(rehearsal),
        };
        files::write(file, &svg::render(&curves, Some(&heading)))?;
        io.remark(&format!("wrote {file}"))?;
    }
    Ok(())
}

async fn request(args: &RehearseArgs, client: &Client, io: &mut Io) -> Result<v1::RehearseRequest, Failure> {
    let mut request = match &args.motion.program {
        Some(file) => of_file(file, &files::read(file, io)?)?,
        None => {
            let revision = args.revision.as_deref();
            let between = args.motion.between(args.degrees, client, &args.robot_id, revision);
            v1::RehearseRequest {
                motion: Some(Motion::Move(between.await?)),
                ..Default::default()
            }
        }
    };
    request.robot_id.clone_from(&args.robot_id);
    request.revision = args.revision.clone().or(request.revision);
    request.settle_s = args.settle.or(request.settle_s);
    request.period_s = args.period.or(request.period_s);
    request.adaptation_rate_per_s = args.adaptation_rate.or(request.adaptation_rate_per_s);
    for (joint, scale) in &args.friction {
        let truth = truth_of(&mut request.friction, joint);
        truth.coulomb_scale = Some(*scale);
        truth.viscous_scale = Some(*scale);
    }
    for (joint, rate) in &args.drift {
        let truth = truth_of(&mut request.friction, joint);
        truth.coulomb_scale_rate = Some(*rate);
        truth.viscous_scale_rate = Some(*rate);
    }
    Ok(request)
}

fn truth_of<'a>(list: &'a mut Vec<v1::FrictionTruth>, joint: &str) -> &'a mut v1::FrictionTruth {
    let place = list.iter().position(|entry| entry.joint == joint).unwrap_or_else(|| {
        list.push(v1::FrictionTruth {
            joint: joint.to_owned(),
            ..Default::default()
        });
        list.len() - 1
    });
    &mut list[place]
}

/// A file holds a motion, or a whole request.
fn of_file(name: &str, text: &str) -> Result<v1::RehearseRequest, Failure> {
    let has = |key| files::has_key(name, text, key);
    let motion = if has("move") || has("path") || has("setpoints") {
        return files::message(name, text);
    } else if has("segments") {
        Motion::Path(files::program(name, text)?)
    } else if has("trajectory") {
        Motion::Setpoints(files::message(name, text)?)
    } else {
        Motion::Move(files::message(name, text)?)
    };
    Ok(v1::RehearseRequest {
        motion: Some(motion),
        ..Default::default()
    })
}

/// Every how manyth step makes a picture: a first rehearsal without a trace says how many there are.
async fn trace_every(client: &Client, request: &v1::RehearseRequest) -> Result<u32, Failure> {
    let reply = client.rehearse(request.clone()).await?;
    let steps = match reply.outcome {
        Some(Outcome::Rehearsal(rehearsal)) => rehearsal.steps,
        _ => 1,
    };
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "at most the steps"
    )]
    let every = (f64::from(steps) / TRACE_POINTS).ceil().max(1.0) as u32;
    Ok(every)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ratio_is_of_one_joint_or_of_all() {
        assert_eq!(of_joint("1.5"), Ok((String::new(), 1.5)));
        assert_eq!(of_joint("left.elbow=0.5"), Ok(("left.elbow".to_owned(), 0.5)));
        assert!(of_joint("elbow=much").is_err() && of_joint("nan").is_err());
        let said = of_joint("elbow=50").unwrap_err();
        assert!(said.contains("write it as 50% or 0.5; it is a ratio"), "{said}");
        assert_eq!(of_joint("5000%"), Ok((String::new(), 50.0)));
        let mut list = Vec::new();
        truth_of(&mut list, "a").coulomb_scale = Some(2.0);
        truth_of(&mut list, "a").viscous_scale = Some(3.0);
        assert_eq!((list.len(), list[0].coulomb_scale), (1, Some(2.0)));
    }

    #[test]
    fn a_file_is_a_motion_or_a_whole_request() {
        let read = |text: &str| of_file("r.yaml", text).unwrap();
        assert!(matches!(read("start: {position: [0]}").motion, Some(Motion::Move(_))));
        assert!(matches!(read("segments: []").motion, Some(Motion::Path(_))));
        assert!(matches!(
            read("trajectory: {points: []}").motion,
            Some(Motion::Setpoints(_))
        ));
        let whole = read("move: {start: {position: [0]}}\nsettle_s: 2\n");
        assert_eq!(whole.settle_s, Some(2.0));
    }
}
