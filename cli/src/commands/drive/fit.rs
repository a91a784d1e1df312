//! `takt drive fit`.

use clap::{Args, ValueEnum};
use takt_client::{
    Client,
    v1::{self, fit_drive_request::Fit, fit_drive_response::Outcome, motion_fit_request::Scope},
};

use crate::{
    commands::context::{self, PayloadArgs},
    exit,
    failure::Failure,
    files,
    io::Io,
    log::{Header, Missing},
    numbers,
    render::fit as render,
};

/// Fits friction, rotors and bodies of an arm to a recorded motion, and says how well the model foretells another part of it.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  takt drive fit ur5e log.csv
  takt drive fit panda log.csv --identify 0..8 --test 8.5..13.3
  takt drive fit ur5e log.csv --scope friction --json > fit.json && takt drive commit ur5e fit.json
  takt drive fit ur5e log.csv --scope payload                   what is in its hand?

The first line of a log names its columns: a time (t, time or time_s), and for every joint its position and its torque as
seen from the joint (q1, tau1, or elbow_joint.position, elbow_joint.torque) or its motor current (i1, or
elbow_joint.motor_current); its velocity (qd1, or elbow_joint.velocity) where it was measured. Other columns are passed over.

Errors are those of the torque below the band, over the torque itself. Figures of the test part count: it was not fitted.
It must not overlap the fitted part; where the log ends earlier than a part, a warning says what was used.

One joint on the bench is fitted by other commands: takt drive fit-stiffness, fit-damping and fit-constant-speed.

Exit code 3: the motion does not say what was asked; the answer says what it would have to have.")]
pub(crate) struct FitArgs {
    /// The robot.
    robot_id: String,
    /// The recording in CSV; - for standard input.
    log: String,
    /// Part of it that is fitted to, as in 0..8 (s) or 500ms..2s. Default: all of it.
    #[arg(long, value_name = "BEGIN..END", value_parser = range)]
    identify: Option<(f64, f64)>,
    /// Part of it that the model is compared with, before and after the fit, as in 8.5..13.3; needs --identify.
    #[arg(long, value_name = "BEGIN..END", value_parser = range, requires = "identify")]
    test: Option<(f64, f64)>,
    /// Corner frequency of the low pass for torque and model, Hz.
    #[arg(long, value_name = "HZ")]
    band: Option<f64>,
    /// What is fitted together with friction.
    #[arg(long, value_enum, default_value_t = ScopeName::Bodies)]
    scope: ScopeName,
    /// Contacts slide at once: no deflection is fitted.
    #[arg(long)]
    no_presliding: bool,
    /// Use motor currents where the log has torques too.
    #[arg(long)]
    current: bool,
    #[command(flatten)]
    payload: PayloadArgs,
    /// A revision other than the current one.
    #[arg(long)]
    revision: Option<String>,
    /// Print the reply as it is, with what it proposes.
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum ScopeName {
    /// Friction alone: the bodies are believed.
    Friction,
    /// Friction and what the arm carries.
    Payload,
    /// Friction and the rotors' inertia.
    Rotors,
    /// Friction, rotors and all moving bodies.
    Bodies,
}

/// `0..8`, in s; units as in 500ms and spaces around the dots are taken.
fn range(text: &str) -> Result<(f64, f64), String> {
    const FORM: &str = "write it as BEGIN..END, as in 0..8 or 500ms..2s";
    let (begin, end) = text.split_once("..").ok_or(FORM)?;
    let range = (numbers::seconds(begin)?, numbers::seconds(end)?);
    match range.0 < range.1 {
        true => Ok(range),
        false => Err(format!("{begin} is not before {end}; {FORM}")),
    }
}

pub(super) async fn run(args: FitArgs, client: &Client, io: &mut Io) -> Result<u8, Failure> {
    let robot = context::robot(client, &args.robot_id, args.revision.as_deref()).await?;
    let text = files::read(&args.log, io)?;
    let recording = recording(&text, &robot, args.current, io)?;
    let part = |range: Option<(f64, f64)>| range.map(|(begin_s, end_s)| v1::TimeRange { begin_s, end_s });
    let fit = v1::MotionFitRequest {
        recording: Some(recording),
        identify: part(args.identify),
        test: part(args.test),
        band_hz: args.band,
        scope: Some(i32::from(match args.scope {
            ScopeName::Friction => Scope::Friction,
            ScopeName::Payload => Scope::Payload,
            ScopeName::Rotors => Scope::Rotors,
            ScopeName::Bodies => Scope::Bodies,
        })),
        presliding: Some(!args.no_presliding),
        payload: args.payload.payload(),
    };
    let request = v1::FitDriveRequest {
        robot_id: args.robot_id.clone(),
        revision: Some(robot.revision.clone()),
        fit: Some(Fit::Motion(fit)),
    };
    let reply = client.fit_drive(request).await?;
    if args.json {
        context::print_json(&reply, io)?;
    }
    match &reply.outcome {
        Some(Outcome::Motion(fit)) => {
            if !args.json {
                io.print(&render::fit(fit, &robot, io.terminal))?;
                io.print(&render::proposal(reply.proposal.as_ref(), &robot.robot_id))?;
            }
            Ok(exit::OK)
        }
        Some(Outcome::NotExcited(missing)) => {
            if !args.json {
                io.print(&render::missing("motion does", missing, io.terminal.colour))?;
            }
            Ok(exit::NO)
        }
        _ => Err(Failure::service("the reply holds neither a fit nor what is missing")),
    }
}

/// The columns that a fit reads.
fn recording(text: &str, robot: &v1::Robot, current: bool, io: &mut Io) -> Result<v1::Telemetry, Failure> {
    let names: Vec<String> = robot.joints.iter().map(|joint| joint.name.clone()).collect();
    let mut lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
    let (_, first) = lines.next().ok_or_else(|| Failure::usage("the log is empty"))?;
    let header = Header::read(first, &names)?;
    if !header.ignored.is_empty() {
        io.remark(&format!("columns passed over: {}", header.ignored.join(", ")))?;
    }
    let mut recording = header.block();
    let mut missing = Missing::default();
    for (index, line) in lines {
        header.add(line, index + 1, &mut recording)?;
        missing.count(&header, &mut recording, index + 1);
    }
    let missing = missing.sentences(&names);
    if !missing.is_empty() {
        let failure = Failure::usage(missing.join("\n"));
        return Err(
            failure.hint("a fit needs every sample: leave out what is no number line by line, or cut the log there")
        );
    }
    let has_torque = recording.joints.iter().any(|joint| !joint.torque.is_empty());
    recording.joints = recording
        .joints
        .into_iter()
        .map(|joint| v1::TelemetryColumns {
            joint: joint.joint,
            position: joint.position,
            velocity: joint.velocity,
            torque: if current { Vec::new() } else { joint.torque },
            motor_current: if current || !has_torque {
                joint.motor_current
            } else {
                Vec::new()
            },
            ..Default::default()
        })
        .collect();
    Ok(recording)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_written_with_two_dots() {
        assert_eq!(range("0..8"), Ok((0.0, 8.0)));
        assert_eq!(range("500ms..13.3"), Ok((0.5, 13.3)));
        assert_eq!(range(" 0 .. 8 s"), Ok((0.0, 8.0)));
        assert!(range("0:8").unwrap_err().contains("as in 0..8"));
        for wrong in ["8", "8..0", "a..1", "1..1"] {
            assert!(range(wrong).is_err(), "{wrong}");
        }
    }
}
