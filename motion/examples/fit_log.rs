//! Fits a model to the log of an arm and says how well it foretells a part of the log that it was not fitted to.
//!
//! ```text
//! cargo run --release -p takt-motion --example fit_log -- arm.urdf log.csv 0:8 8.5:13.3
//!     [--test-log other.csv] [--tip LINK] [--peak 87,87,…]
//!     [--scope friction|payload|rotors|bodies] [--band 5] [--friction VISCOUS,…:COULOMB,…]
//! ```
//!
//! The log is a CSV with a line of names: `t` or `time` in s, `q1`…, `qd1`… (may be left out), `tau1`… or `i1`… (currents, with `--constant` N m/A
//! and `--ratio`, one a joint). With `--test-log` the second range is of that log. Peak torques come from the URDF where they are not
//! given. `--friction` is a published friction to compare with.

use std::error::Error;
use std::fmt::Write as _;
use std::io::Write as _;

use takt_motion::budget::Budget;
use takt_motion::drive::fit::assess::assess;
use takt_motion::drive::fit::motion::fit_motion;
use takt_motion::drive::fit::recording::{Effort, Recording, Selection};
use takt_motion::drive::fit::report::{
    Assessment, BAND_DEFAULT, MotionFit, MotionOptions, MotionOutcome, Scope, Unknown,
};
use takt_motion::plan::Failure;
use takt_motion::robot::Robot;
use takt_motion::robot::description::{Description, Kinematics};
use takt_motion::robot::spec::Friction;

type Fallible<T> = Result<T, Box<dyn Error>>;

/// What the command line asks for.
struct Options {
    files: Vec<String>,
    test_log: Option<String>,
    tip: Option<String>,
    peak: Vec<f64>,
    scope: Scope,
    band: f64,
    friction: Option<(Vec<f64>, Vec<f64>)>,
    constant: Vec<f64>,
    ratio: Vec<f64>,
}

fn main() -> Fallible<()> {
    let options = Options::parse()?;
    let [urdf, log, fit_range, test_range] = options.files.as_slice() else {
        return Err("usage: fit_log arm.urdf log.csv FROM:TO FROM:TO".into());
    };
    let robot = options.robot(&std::fs::read_to_string(urdf)?)?;
    let recording = read_log(&std::fs::read_to_string(log)?, robot.joint_count())?;
    let other = match &options.test_log {
        Some(log) => Some(read_log(&std::fs::read_to_string(log)?, robot.joint_count())?),
        None => None,
    };
    let compared = other.as_ref().unwrap_or(&recording);
    let of_range = |text: &str| -> Fallible<Selection> {
        let (from, to) = text.split_once(':').ok_or("a range is FROM:TO")?;
        Ok(Selection {
            range: Some((from.parse()?, to.parse()?)),
            band: options.band,
        })
    };
    let (identify, test) = (of_range(fit_range)?, of_range(test_range)?);
    let fit_options = MotionOptions {
        selection: identify,
        scope: options.scope,
        ..MotionOptions::default()
    };
    let budget = Budget::unlimited();
    let mut out = String::new();
    match fit_motion(&robot, &recording, &fit_options, &budget).map_err(said)? {
        MotionOutcome::NotExcited(missing) => {
            for missing in missing {
                writeln!(out, "{}", missing.message)?;
            }
        }
        MotionOutcome::Fitted(fit) => {
            write_estimates(&mut out, &robot, &fit)?;
            let fitted = Robot::new(fit.spec.clone(), Vec::new()).map_err(|faults| format!("{faults:?}"))?;
            let mut compare = |name: &str, robot: &Robot| -> Fallible<()> {
                write_assessment(&mut out, name, &assess(robot, compared, &test, &budget).map_err(said)?)
            };
            compare("as described, without friction", &with_friction(&robot, None)?)?;
            if let Some(friction) = &options.friction {
                compare("with the friction given", &with_friction(&robot, Some(friction))?)?;
            }
            compare("as fitted", &fitted)?;
        }
    }
    std::io::stdout().write_all(out.as_bytes())?;
    Ok(())
}

impl Options {
    fn parse() -> Fallible<Self> {
        let mut options = Self {
            files: Vec::new(),
            test_log: None,
            tip: None,
            peak: Vec::new(),
            scope: Scope::Bodies,
            band: BAND_DEFAULT,
            friction: None,
            constant: Vec::new(),
            ratio: Vec::new(),
        };
        let mut arguments = std::env::args().skip(1);
        while let Some(argument) = arguments.next() {
            if !argument.starts_with("--") {
                options.files.push(argument);
                continue;
            }
            let value = arguments.next().ok_or_else(|| format!("{argument} needs a value"))?;
            match argument.as_str() {
                "--test-log" => options.test_log = Some(value),
                "--tip" => options.tip = Some(value),
                "--peak" => options.peak = numbers(&value)?,
                "--constant" => options.constant = numbers(&value)?,
                "--ratio" => options.ratio = numbers(&value)?,
                "--band" => options.band = value.parse()?,
                "--scope" => {
                    options.scope = match value.as_str() {
                        "friction" => Scope::Friction,
                        "payload" => Scope::Payload,
                        "rotors" => Scope::Rotors,
                        "bodies" => Scope::Bodies,
                        other => return Err(format!("{other} is no scope").into()),
                    }
                }
                "--friction" => {
                    let (viscous, coulomb) = value.split_once(':').ok_or("friction is VISCOUS,…:COULOMB,…")?;
                    options.friction = Some((numbers(viscous)?, numbers(coulomb)?));
                }
                other => return Err(format!("{other} is no option").into()),
            }
        }
        Ok(options)
    }

    fn robot(&self, text: &str) -> Fallible<Robot> {
        let description = Description::new(Kinematics::Urdf {
            text: text.to_owned(),
            base_link: None,
            tip_link: self.tip.clone(),
        });
        let mut resolved = description.resolve().map_err(|faults| format!("{faults:?}"))?;
        for (joint, of) in resolved.spec.joints.iter_mut().enumerate() {
            if let Some(peak) = self.peak.get(joint) {
                of.drive.peak_torque = Some(*peak);
            }
            of.drive.torque_constant = self.constant.get(joint).copied();
            if let Some(ratio) = self.ratio.get(joint) {
                of.drive.gear_ratio = *ratio;
            }
        }
        Robot::new(resolved.spec, resolved.warnings).map_err(|faults| format!("{faults:?}").into())
    }
}

fn said(failure: Failure) -> String {
    match failure {
        Failure::Stopped => "stopped".to_owned(),
        Failure::Invalid(faults) => {
            let lines: Vec<String> = faults.iter().map(ToString::to_string).collect();
            lines.join("\n")
        }
    }
}

fn numbers(text: &str) -> Fallible<Vec<f64>> {
    text.split(',').map(|part| Ok(part.trim().parse()?)).collect()
}

fn read_log(text: &str, joints: usize) -> Fallible<Recording> {
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().ok_or("an empty log")?.split(',').map(str::trim).collect();
    let rows: Vec<Vec<f64>> = lines
        .filter(|line| !line.trim().is_empty())
        .map(numbers)
        .collect::<Fallible<_>>()?;
    let column = |name: &str| -> Option<Vec<f64>> {
        let place = names.iter().position(|n| *n == name)?;
        rows.iter().map(|row| row.get(place).copied()).collect()
    };
    let series =
        |prefix: &str| -> Option<Vec<Vec<f64>>> { (1..=joints).map(|j| column(&format!("{prefix}{j}"))).collect() };
    let effort = match (series("tau"), series("i")) {
        (Some(torque), _) => Effort::Torque(torque),
        (None, Some(current)) => Effort::Current(current),
        (None, None) => return Err("no columns tau1… or i1…".into()),
    };
    Ok(Recording {
        time: column("t").or_else(|| column("time")).ok_or("no column t or time")?,
        position: series("q").ok_or("no columns q1…")?,
        velocity: series("qd"),
        effort,
    })
}

fn with_friction(robot: &Robot, friction: Option<&(Vec<f64>, Vec<f64>)>) -> Fallible<Robot> {
    let mut spec = robot.spec().clone();
    for (j, joint) in spec.joints.iter_mut().enumerate() {
        joint.drive.motor_friction = Friction::default();
        joint.drive.joint_friction = Friction::default();
        if let Some((viscous, coulomb)) = friction {
            let (Some(viscous), Some(coulomb)) = (viscous.get(j), coulomb.get(j)) else {
                return Err(format!("no friction of joint {}", j + 1).into());
            };
            joint.drive.joint_friction = Friction {
                viscous: *viscous,
                coulomb_positive: *coulomb,
                coulomb_negative: *coulomb,
                ..Friction::default()
            };
        }
    }
    Robot::new(spec, Vec::new()).map_err(|faults| format!("{faults:?}").into())
}

fn write_estimates(out: &mut String, robot: &Robot, fit: &MotionFit) -> Fallible<()> {
    let ridge = fit.ridge.map_or("none".to_owned(), |ridge| ridge.to_string());
    writeln!(
        out,
        "{} samples, ridge {ridge}, {:.1} of {} parameters determined",
        fit.sample_count,
        fit.determined,
        fit.estimates.len()
    )?;
    writeln!(
        out,
        "\n{:14} {:24} {:>10} {:>10} {:>10} {:>6}",
        "joint", "parameter", "value", "deviation", "described", "told"
    )?;
    for estimate in &fit.estimates {
        let (joint, kind) = match estimate.unknown {
            Unknown::Joint(parameter) => (
                robot.spec().joints[parameter.joint].name.as_str(),
                format!("{:?}", parameter.kind),
            ),
            Unknown::Payload(part) => ("payload", format!("parameter {part}")),
        };
        writeln!(
            out,
            "{joint:14} {kind:24} {:10.4} {:10.4} {:10.4} {:6.2}",
            estimate.value, estimate.deviation, estimate.described, estimate.told
        )?;
    }
    writeln!(
        out,
        "\n{:14} {:>8} {:>10} {:>12} {:>12} {:>6}",
        "joint", "fitted", "validated", "correlation", "presliding", "pose"
    )?;
    for (joint, of) in fit.joints.iter().zip(&robot.spec().joints) {
        let presliding = joint
            .presliding_deflection
            .map_or("-".to_owned(), |x| format!("{x:.5}"));
        writeln!(
            out,
            "{:14} {:6.2} % {:8.2} % {:10.2} s {presliding:>12} {:4.0} %",
            of.name,
            100.0 * joint.fitted_error,
            100.0 * joint.validated_error,
            joint.correlation_time,
            100.0 * joint.pose_share
        )?;
    }
    for warning in &fit.warnings {
        writeln!(out, "{warning}")?;
    }
    Ok(())
}

fn write_assessment(out: &mut String, name: &str, assessment: &Assessment) -> Fallible<()> {
    writeln!(out, "\n{name}, {} samples", assessment.sample_count)?;
    let mut row = |title: &str, value: &dyn Fn(usize) -> Option<f64>| -> Fallible<()> {
        write!(out, "{title:32}")?;
        for joint in 0..assessment.joints.len() {
            match value(joint) {
                Some(value) => write!(out, " {value:8.2}")?,
                None => write!(out, " {:>8}", "-")?,
            }
        }
        Ok(writeln!(out)?)
    };
    let joints = &assessment.joints;
    row("error over torque, %", &|j| Some(100.0 * joints[j].error))?;
    row("95th percentile, N m", &|j| Some(joints[j].percentile))?;
    row("95th percentile over peak, %", &|j| {
        joints[j].percentile_of_peak.map(|p| 100.0 * p)
    })?;
    if joints.iter().any(|joint| joint.interval.is_some()) {
        row("within the stated 95 %, %", &|j| {
            joints[j].interval.map(|i| 100.0 * i.coverage)
        })?;
        row("half width over the narrowest", &|j| {
            joints[j].interval.map(|i| i.over_narrowest)
        })?;
        row("within the online 95 %, %", &|j| {
            joints[j].online.map(|i| 100.0 * i.coverage)
        })?;
        row("half width over the narrowest", &|j| {
            joints[j].online.map(|i| i.over_narrowest)
        })?;
    }
    Ok(())
}
