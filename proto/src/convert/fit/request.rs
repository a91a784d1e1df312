//! Reads what a model is to be fitted to.

use takt_motion::{
    Invalid,
    drive::fit::{
        recording::{Effort, Recording, Selection},
        report::{MotionOptions, Scope},
    },
    robot::spec::{Inertial, RobotSpec},
};

use super::same;
use crate::{
    convert::{Findings, Path, drive, robot},
    v1,
};

const SCOPES: &str = "FRICTION, PAYLOAD, ROTORS, BODIES";

/// A fit that is asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct MotionFitRequest {
    /// What was recorded.
    pub recording: Recording,
    /// What is fitted, to which part of it.
    pub options: MotionOptions,
    /// Which part the fit is compared with.
    pub test: Option<Selection>,
    /// What that is a part of; `None`: of what is fitted.
    pub test_recording: Option<Recording>,
    /// What the arm carried; `None`: the model's payload.
    pub payload: Option<Inertial>,
}

/// One of the two parts that a fit looks at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// What is fitted.
    Identify,
    /// What the fit is compared with.
    Test,
}

impl Part {
    /// The field of its range.
    #[must_use]
    pub fn range_field(self) -> &'static str {
        match self {
            Self::Identify => "identify",
            Self::Test => "test",
        }
    }

    /// The recording that it is a part of, with the name of its field.
    #[must_use]
    pub fn recording(self, wire: &v1::MotionFitRequest) -> (&'static str, Option<&v1::Telemetry>) {
        match (self, &wire.test_recording) {
            (Self::Test, Some(recording)) => ("test_recording", Some(recording)),
            (Self::Identify | Self::Test, _) => ("recording", wire.recording.as_ref()),
        }
    }
}

impl MotionFitRequest {
    /// What the part for the comparison is a part of.
    #[must_use]
    pub fn compared(&self) -> &Recording {
        self.test_recording.as_ref().unwrap_or(&self.recording)
    }
}

/// Reads a fit to a motion. Recordings need a robot that is known: `None` without.
pub fn motion_fit_request(
    wire: &v1::MotionFitRequest,
    spec: Option<&RobotSpec>,
    findings: &mut Findings,
) -> Option<MotionFitRequest> {
    let root = Path::Root;
    let at = root.field("motion");
    let default = MotionOptions::default();
    let band = findings.finite_option(at.field("band_hz"), wire.band_hz);
    let selection = |range: Option<v1::TimeRange>| Selection {
        range: range.map(|range| (range.begin_s, range.end_s)),
        band: band.unwrap_or(default.selection.band),
    };
    let scope = wire
        .scope
        .and_then(|scope| findings.enumerated(at.field("scope"), scope, SCOPES));
    for (name, range) in [("identify", &wire.identify), ("test", &wire.test)] {
        if let Some(range) = range {
            let at = at.field(name);
            findings.finite(at.field("begin_s"), range.begin_s);
            findings.finite(at.field("end_s"), range.end_s);
        }
    }
    let payload = wire.payload.as_ref();
    let payload = payload.map(|payload| robot::payload(payload, at.field("payload"), findings));
    let Some(wire_recording) = &wire.recording else {
        findings.push(at.field("recording"), "must be given");
        return None;
    };
    let mut test = wire.test.map(|range| selection(Some(range)));
    match &wire.test_recording {
        // Times of different recordings have nothing to do with each other.
        Some(_) => test = test.or(Some(selection(None))),
        None => check_apart(wire, test, selection(wire.identify), at.field("test"), findings),
    }
    let spec = spec?;
    let recording = read_recording(wire_recording, at.field("recording"), spec, findings);
    let other = wire.test_recording.as_ref();
    let other = other.map(|other| read_recording(other, at.field("test_recording"), spec, findings));
    let recording = recording?;
    let test_recording = match other {
        Some(other) => Some(other?),
        None => None,
    };
    let together = test_recording.as_ref();
    if let Some(message) = together.and_then(|other| recording.too_long_with(other)) {
        findings.push(at.field("test_recording").field("time_s"), message);
    }
    if let Some(other) = together {
        let at = at.field("test_recording");
        check_other(wire, test, selection(wire.identify), (&recording, other), at, findings);
    }
    Some(MotionFitRequest {
        recording,
        options: MotionOptions {
            selection: selection(wire.identify),
            scope: match scope {
                Some(v1::motion_fit_request::Scope::Friction) => Scope::Friction,
                Some(v1::motion_fit_request::Scope::Payload) => Scope::Payload,
                Some(v1::motion_fit_request::Scope::Rotors) => Scope::Rotors,
                Some(v1::motion_fit_request::Scope::Bodies | v1::motion_fit_request::Scope::Unspecified) | None => {
                    Scope::Bodies
                }
            },
            presliding: wire.presliding.unwrap_or(default.presliding),
        },
        test,
        test_recording,
        payload,
    })
}

/// What was fitted foretells nothing: within one recording the two parts must be apart.
fn check_apart(
    wire: &v1::MotionFitRequest,
    test: Option<Selection>,
    identify: Selection,
    at: Path<'_>,
    findings: &mut Findings,
) {
    if let Some(both) = test.and_then(|test| test.overlap(&identify)) {
        findings.push(at, not_apart(wire, both));
    }
}

/// The same of a recording to compare with that has the samples of the fitted one at the times that they share.
fn check_other(
    wire: &v1::MotionFitRequest,
    test: Option<Selection>,
    identify: Selection,
    (fitted, other): (&Recording, &Recording),
    at: Path<'_>,
    findings: &mut Findings,
) {
    let Some(times) = same::shared(fitted, other) else {
        return;
    };
    let fitted = Selection {
        range: Some(times),
        ..identify
    };
    let common = identify.overlap(&fitted).map(|times| Selection {
        range: Some(times),
        ..identify
    });
    let both = common.and_then(|common| test.unwrap_or(fitted).overlap(&common));
    if let Some(both) = both {
        let message = format!(
            "has the samples of `recording`, so that `test` {}; give a recording of another run, or parts that are apart",
            not_apart(wire, both)
        );
        findings.push(at, message);
    }
}

fn not_apart(wire: &v1::MotionFitRequest, (begin, end): (f64, f64)) -> String {
    let fitted = match &wire.identify {
        Some(range) => format!("{} to {} s are fitted", range.begin_s, range.end_s),
        None => "all of the recording is fitted, as `identify` is not given".to_owned(),
    };
    format!(
        "must be apart from the part that is fitted: {fitted}, and {begin} to {end} s are in both; what was fitted foretells nothing"
    )
}

/// Reads a recording: joints in model order.
fn read_recording(wire: &v1::Telemetry, at: Path<'_>, robot: &RobotSpec, findings: &mut Findings) -> Option<Recording> {
    findings.finite_series(at.field("time_s"), &wire.time_s);
    let joints_at = at.field("joints");
    let joints = drive::in_model_order(&wire.joints, joints_at, robot, findings)?;
    let count = wire.time_s.len();
    let mut column = |name: &'static str, column: drive::Column| {
        for (index, one) in &joints {
            findings.finite_series(joints_at.index(*index).field(name), column(one));
        }
        drive::is_given(name, column, count, &joints, joints_at, findings)
            .then(|| joints.iter().map(|(_, one)| column(one).clone()).collect::<Vec<_>>())
    };
    let position = column("position", |one| &one.position);
    let velocity = column("velocity", |one| &one.velocity);
    let torque = column("torque", |one| &one.torque);
    let current = column("motor_current", |one| &one.motor_current);
    if position.is_none() {
        findings.push(joints_at, "must have the position of every joint");
    }
    let effort = match (torque, current) {
        (Some(torque), None) => Some(Effort::Torque(torque)),
        (None, Some(current)) => Some(Effort::Current(current)),
        (Some(_), Some(_)) => {
            findings.push(joints_at, "must have torques or motor currents, and not both");
            None
        }
        (None, None) => {
            findings.push(joints_at, "must have the torque or the motor current of every joint");
            None
        }
    };
    Some(Recording {
        time: wire.time_s.clone(),
        position: position?,
        velocity,
        effort: effort?,
    })
}

/// What a fit finds wrong with a recording, in the words of the wire; `part` is the one that it looked at.
#[must_use]
pub fn finding_on_recording(found: Invalid, wire: &v1::MotionFitRequest, robot: &RobotSpec, part: Part) -> Invalid {
    let Invalid { path, message } = found;
    let (field, recording) = part.recording(wire);
    let (name, rest) = path.split_at(path.find('[').unwrap_or(path.len()));
    let column = match name {
        "band" => return Invalid::new("motion.band_hz", message),
        "range" => return Invalid::new(format!("motion.{}", part.range_field()), message),
        "time" => return Invalid::new(format!("motion.{field}.time_s{rest}"), message),
        "position" | "velocity" | "torque" => name,
        "current" => "motor_current",
        "" => return Invalid::new("motion", message),
        other => return Invalid::new(format!("motion.{other}{rest}"), message),
    };
    let Some((joint, rest)) = rest.strip_prefix('[').and_then(|rest| rest.split_once(']')) else {
        return Invalid::new(format!("motion.{field}.joints"), message);
    };
    // Joints of a recording are in model order, those of the wire where their names are.
    let joint: usize = joint.parse().unwrap_or(0);
    let name = robot.joints.get(joint).map_or("", |joint| joint.name.as_str());
    let joints = recording.into_iter().flat_map(|recording| &recording.joints);
    let place = joints
        .map(|one| &one.joint)
        .position(|known| known == name)
        .unwrap_or(joint);
    Invalid::new(format!("motion.{field}.joints[{place}].{column}{rest}"), message)
}
