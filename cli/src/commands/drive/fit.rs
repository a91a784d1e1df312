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
  takt drive fit panda monday.csv --test-log friday.csv         foretell another day; --test is a part of friday.csv
  takt drive fit ur5e log.csv --scope friction --json > fit.json && takt drive commit ur5e fit.json
  takt drive fit ur5e log.csv --scope payload                   what is in its hand?

The first line of a log names its columns: a time (t, time or time_s; t_ms, t_us, t_ns in other units), and for every joint its position and its torque as
seen from the joint (q1, tau1, or elbow_joint.position, elbow_joint.torque) or its motor current (i1, or
elbow_joint.motor_current); its velocity (qd1, or elbow_joint.velocity) where it was measured. Other columns are passed over.

Errors are those of the torque below the band, over the torque itself. Figures of the test part count: it was not fitted.
It must not overlap the fitted part; where the log ends earlier than a part, a warning says what was used.

With --test-log the comparison is with that log: all of it, or the part in --test, in its own times, which have nothing to do
with those of the other. It is written as the other is, of the same arm with the same payload; currents become torques with the
same constants. Another day says more than another part of the same: grease warms up and wears.

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
    /// Part that the model is compared with, before and after the fit, as in 8.5..13.3: of the log, which needs --identify, or of
    /// --test-log.
    #[arg(long, value_name = "BEGIN..END", value_parser = range)]
    test: Option<(f64, f64)>,
    /// Another recording in CSV that the model is compared with, all of it or --test; - for standard input.
    #[arg(long, value_name = "CSV")]
    test_log: Option<String>,
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

impl FitArgs {
    fn effort(&self) -> Effort {
        match self.current {
            true => Effort::Current,
            false => Effort::TorqueFirst,
        }
    }
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
    if args.test.is_some() && args.identify.is_none() && args.test_log.is_none() {
        let failure = Failure::usage("--test is a part of the log, all of which is fitted without --identify");
        return Err(failure.hint("give --identify BEGIN..END, or another log with --test-log"));
    }
    if args.log == "-" && args.test_log.as_deref() == Some("-") {
        return Err(Failure::usage("only one of LOG and --test-log can be standard input"));
    }
    let text = files::read(&args.log, io)?;
    let recording = recording(&text, &robot, args.effort(), "", io)?;
    let test_recording = match &args.test_log {
        Some(log) => {
            let effort = match args.effort() {
                Effort::TorqueFirst if has_current(&recording) => Effort::CurrentFirst,
                asked => asked,
            };
            let text = files::read(log, io)?;
            let read = self::recording(&text, &robot, effort, &format!("{log}: "), io);
            Some(read.map_err(|failure| failure.hint(format!("that is of the test log, {log}")))?)
        }
        None => None,
    };
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
        test_recording,
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
            if args.json {
                let proposed = reply.proposal.iter().flat_map(|proposal| &proposal.warnings);
                io.warn(fit.warnings.iter().chain(proposed))?;
            } else {
                io.print(&render::fit(fit, &robot, args.test_log.as_deref(), io.terminal))?;
                io.print(&render::proposal(reply.proposal.as_ref(), &robot.robot_id))?;
            }
            Ok(exit::OK)
        }
        Some(Outcome::NotExcited(missing)) => {
            if args.json {
                io.warn(&missing.warnings)?;
            } else {
                io.print(&render::missing("motion does", missing, io.terminal.colour))?;
            }
            Ok(exit::NO)
        }
        _ => Err(Failure::service("the reply holds neither a fit nor what is missing")),
    }
}

/// Which of torques and motor currents is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Effort {
    /// Torques where the log has them.
    TorqueFirst,
    /// Currents where the log has them, as the log that is fitted.
    CurrentFirst,
    /// Currents, as asked for.
    Current,
}

fn has_current(recording: &v1::Telemetry) -> bool {
    recording.joints.iter().any(|joint| !joint.motor_current.is_empty())
}

/// The columns that a fit reads; remarks begin with which log it is.
fn recording(
    text: &str,
    robot: &v1::Robot,
    effort: Effort,
    which: &str,
    io: &mut Io,
) -> Result<v1::Telemetry, Failure> {
    let names: Vec<String> = robot.joints.iter().map(|joint| joint.name.clone()).collect();
    let mut lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
    let (_, first) = lines.next().ok_or_else(|| Failure::usage("the log is empty"))?;
    let header = Header::read(first, &names)?;
    if !header.ignored.is_empty() {
        io.remark(&format!("{which}columns passed over: {}", header.ignored.join(", ")))?;
    }
    if let Some(missing) = header.missing_joints() {
        let failure = Failure::usage(missing);
        return Err(failure.hint("a fit needs the position and the torque or motor current of every joint"));
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
    let current = match effort {
        Effort::TorqueFirst => !has_torque,
        Effort::CurrentFirst => has_current(&recording),
        Effort::Current if has_current(&recording) => true,
        Effort::Current => {
            let failure = Failure::usage("the log has no motor currents, which --current asks for");
            return Err(failure.hint("its columns would be i1, i2 and so on, or elbow_joint.motor_current"));
        }
    };
    recording.joints = recording
        .joints
        .into_iter()
        .map(|joint| v1::TelemetryColumns {
            joint: joint.joint,
            position: joint.position,
            velocity: joint.velocity,
            torque: if current { Vec::new() } else { joint.torque },
            motor_current: if current { joint.motor_current } else { Vec::new() },
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
