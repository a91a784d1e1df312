//! Reads what is to be rehearsed.

use takt_motion::{
    Invalid,
    drive::{
        controller::{Adaptation, JointGains},
        rehearse::request::{Encoder, FrictionTruth, Motion, RehearsalRequest, SetpointMotion, WrenchPulse},
    },
    nalgebra::Vector3,
    robot::spec::RobotSpec,
};

use crate::{
    convert::{Findings, LARGEST, Path, SMALLEST, path, plan, quoted, robot},
    v1::{
        self,
        rehearse_request::{Adaptation as Named, Motion as WireMotion},
    },
};

const ADAPTATIONS: &str = "OBSERVER, LAW";

/// Reads a request; `None` where it has no motion.
pub fn rehearsal_request(
    wire: v1::RehearseRequest,
    robot: Option<&RobotSpec>,
    findings: &mut Findings,
) -> Option<RehearsalRequest> {
    let at = Path::Root;
    let motion = motion(wire.motion, robot, findings);
    let by_joint = ByJoint { robot };
    let friction = by_joint.read(&wire.friction, |one| &one.joint, at.field("friction"), findings, truth);
    let encoders = by_joint.read(
        &wire.encoders,
        |one| &one.joint,
        at.field("encoders"),
        findings,
        encoder,
    );
    let gains = by_joint.read(&wire.gains, |one| &one.joint, at.field("gains"), findings, gains);
    let limits_at = at.field("current_limits");
    let limits = by_joint.read(
        &wire.current_limits,
        |one| &one.joint,
        limits_at,
        findings,
        |one, at, findings| findings.within(at.field("current_a"), one.current_a, SMALLEST..=LARGEST, " A"),
    );
    let defaults = RehearsalRequest::new(motion?);
    let payload = wire.true_payload.as_ref();
    let wrenches_at = at.field("wrenches");
    let wrenches = wire.wrenches.iter().enumerate();
    let rate = findings.positive_option(at.field("adaptation_rate_per_s"), wire.adaptation_rate_per_s, "/s");
    let memory = findings.positive_option(at.field("adaptation_memory_s"), wire.adaptation_memory_s, " s");
    let adaptation = wire.adaptation;
    let adaptation = adaptation.and_then(|named| findings.enumerated(at.field("adaptation"), named, ADAPTATIONS));
    let adaptation = match adaptation {
        Some(Named::Observer) => {
            if memory.is_some() {
                findings.push(at.field("adaptation_memory_s"), "is of LAW alone");
            }
            Adaptation::Observer { rate }
        }
        Some(Named::Law | Named::Unspecified) | None => Adaptation::Law { rate, memory },
    };
    let request = RehearsalRequest {
        period: findings
            .positive_option(at.field("period_s"), wire.period_s, " s")
            .unwrap_or(defaults.period),
        settle: findings.within(at.field("settle_s"), wire.settle_s.unwrap_or(0.0), 0.0..=LARGEST, " s"),
        friction: friction.unwrap_or_default(),
        true_payload: payload.map(|payload| robot::payload(payload, at.field("true_payload"), findings)),
        encoders: encoders.unwrap_or_default(),
        seed: u64::from(wire.seed.unwrap_or(0)),
        wrenches: wrenches
            .map(|(index, one)| wrench(one, wrenches_at.index(index), findings))
            .collect(),
        gains: gains.unwrap_or_default(),
        current_limits: limits.unwrap_or_default(),
        adaptation,
        trace_every: wire
            .trace_every
            .map(|every| usize::try_from(every).unwrap_or(usize::MAX)),
        ..defaults
    };
    Some(request)
}

fn motion(wire: Option<WireMotion>, robot: Option<&RobotSpec>, findings: &mut Findings) -> Option<Motion> {
    let mut inner = Findings::default();
    let (name, motion) = match wire {
        Some(WireMotion::Move(wire)) => {
            refuse_samples(wire.sample_period_s, wire.trace_points, &mut inner);
            (
                "move",
                Motion::Move(Box::new(plan::move_request(wire, robot, &mut inner))),
            )
        }
        Some(WireMotion::Path(wire)) => {
            refuse_samples(wire.sample_period_s, wire.trace_points, &mut inner);
            (
                "path",
                Motion::Path(Box::new(path::path_request(wire, robot, &mut inner))),
            )
        }
        Some(WireMotion::Setpoints(wire)) => {
            let payload = wire.payload.as_ref();
            let payload = payload.map(|payload| robot::payload(payload, Path::Root.field("payload"), &mut inner));
            let (points, interpolation) = plan::trajectory(wire.trajectory, robot, &mut inner);
            let motion = SetpointMotion {
                points,
                interpolation,
                payload,
            };
            ("setpoints", Motion::Setpoints(motion))
        }
        None => {
            findings.push(Path::Root.field("move"), "must be given, or `path`, or `setpoints`");
            return None;
        }
    };
    for found in inner.into_list() {
        findings.push_invalid(found.below(name));
    }
    Some(motion)
}

fn refuse_samples(period: Option<f64>, trace: Option<u32>, findings: &mut Findings) {
    const WHY: &str = "must not be given: a rehearsal has the period of its controller, `period_s`";
    if period.is_some() {
        findings.push(Path::Root.field("sample_period_s"), WHY);
    }
    if trace.is_some() {
        findings.push(Path::Root.field("trace_points"), WHY);
    }
}

/// Lists by joint: entries with a name are of that joint, one without of every other.
struct ByJoint<'a> {
    robot: Option<&'a RobotSpec>,
}

impl ByJoint<'_> {
    /// One value a joint; `None` where nothing is said of any.
    fn read<W, T: Clone + Standing>(
        &self,
        wire: &[W],
        joint: impl Fn(&W) -> &String,
        at: Path<'_>,
        findings: &mut Findings,
        read: impl Fn(&W, Path<'_>, &mut Findings) -> T,
    ) -> Option<Vec<T>> {
        let robot = self.robot.filter(|_| !wire.is_empty())?;
        let mut named = vec![None; robot.joints.len()];
        let mut other = None;
        for (index, entry) in wire.iter().enumerate() {
            let at = at.index(index);
            let value = read(entry, at, findings);
            let name = joint(entry);
            let place = match robot.joints.iter().position(|joint| joint.name == *name) {
                Some(place) => &mut named[place],
                None if name.is_empty() => &mut other,
                None => {
                    let message = format!("the robot has no joint {}", quoted(name));
                    findings.push(at.field("joint"), message);
                    continue;
                }
            };
            if place.replace(value).is_some() {
                findings.push(at.field("joint"), "has an entry already");
            }
        }
        let missing = named.iter().position(Option::is_none);
        if let (Some(missing), None, None) = (missing, &other, T::standing()) {
            let name = quoted(&robot.joints[missing].name);
            findings.push(at, format!("has no entry of {name}, and none that names no joint"));
        }
        let named = named.into_iter();
        named
            .map(|value| value.or_else(|| other.clone()).or_else(T::standing))
            .collect()
    }
}

/// What holds for a joint of which a list says nothing; `None`: the list must say it of all.
trait Standing: Sized {
    fn standing() -> Option<Self>;
}

impl Standing for FrictionTruth {
    fn standing() -> Option<Self> {
        Some(Self::default())
    }
}

impl Standing for Encoder {
    fn standing() -> Option<Self> {
        Some(Self::default())
    }
}

impl Standing for JointGains {
    fn standing() -> Option<Self> {
        None
    }
}

/// A current limit.
impl Standing for f64 {
    fn standing() -> Option<Self> {
        None
    }
}

fn truth(wire: &v1::FrictionTruth, at: Path<'_>, findings: &mut Findings) -> FrictionTruth {
    let mut number = |name: &'static str, value: Option<f64>, default: f64| {
        findings.finite_option(at.field(name), value).unwrap_or(default)
    };
    FrictionTruth {
        coulomb_scale: number("coulomb_scale", wire.coulomb_scale, 1.0),
        viscous_scale: number("viscous_scale", wire.viscous_scale, 1.0),
        coulomb_rate: number("coulomb_scale_rate", wire.coulomb_scale_rate, 0.0),
        viscous_rate: number("viscous_scale_rate", wire.viscous_scale_rate, 0.0),
    }
}

fn encoder(wire: &v1::Encoder, at: Path<'_>, findings: &mut Findings) -> Encoder {
    let mut number = |name: &'static str, value: Option<f64>| {
        findings.within(at.field(name), value.unwrap_or(0.0), 0.0..=LARGEST, "")
    };
    Encoder {
        motor_step: number("motor_step", wire.motor_step),
        motor_noise: number("motor_noise", wire.motor_noise),
        has_output: !wire.motor_only.unwrap_or(false),
        output_step: number("output_step", wire.output_step),
        output_noise: number("output_noise", wire.output_noise),
    }
}

fn gains(wire: &v1::JointGains, at: Path<'_>, findings: &mut Findings) -> JointGains {
    let mut number = |name: &'static str, value: f64| findings.finite(at.field(name), value);
    JointGains {
        position: number("position", wire.position),
        velocity: number("velocity", wire.velocity),
        torque: number("torque", wire.torque),
        velocity_filter: number("velocity_filter_rad_per_s", wire.velocity_filter_rad_per_s),
    }
}

fn wrench(wire: &v1::WrenchPulse, at: Path<'_>, findings: &mut Findings) -> WrenchPulse {
    let force = findings.vector(at.field("force_n"), &wire.force_n);
    let moment = findings.vector(at.field("moment_n_m"), &wire.moment_n_m);
    WrenchPulse {
        begin: findings.finite(at.field("begin_s"), wire.begin_s),
        end: findings.finite(at.field("end_s"), wire.end_s),
        force: force.unwrap_or_else(Vector3::zeros),
        moment: moment.unwrap_or_else(Vector3::zeros),
    }
}

/// What a rehearsal finds wrong with its request, in the words of the wire.
#[must_use]
pub fn finding_on_request(found: Invalid, wire: &v1::RehearseRequest, robot: &RobotSpec) -> Invalid {
    let Invalid { path, message } = found;
    let path = match path.as_str() {
        "adaptation.rate" => "adaptation_rate_per_s".to_owned(),
        "adaptation.memory" => "adaptation_memory_s".to_owned(),
        path => match of_list(path, wire, robot) {
            Some(path) => path,
            None if OWN.iter().any(|field| path.starts_with(field)) => path.to_owned(),
            None => of_motion(path, wire),
        },
    };
    Invalid::new(path, message)
}

/// Fields of the request itself, as its check names them.
const OWN: [&str; 8] = [
    "period_s",
    "settle_s",
    "trace_every",
    "wrenches",
    "friction",
    "encoders",
    "gains",
    "current_limits",
];

/// The motion is planned as in a call of its own.
fn of_motion(path: &str, wire: &v1::RehearseRequest) -> String {
    let name = match &wire.motion {
        Some(WireMotion::Move(_)) | None => "move",
        Some(WireMotion::Path(_)) => "path",
        Some(WireMotion::Setpoints(_)) => "setpoints",
    };
    format!("{name}.{path}")
}

/// Lists are by joint in the domain; on the wire they are as the caller wrote them.
fn of_list(path: &str, wire: &v1::RehearseRequest, robot: &RobotSpec) -> Option<String> {
    let (field, rest) = path.split_once('[')?;
    let (index, rest) = rest.split_once(']')?;
    let joints: Vec<&str> = match field {
        "friction" => wire.friction.iter().map(|one| one.joint.as_str()).collect(),
        "encoders" => wire.encoders.iter().map(|one| one.joint.as_str()).collect(),
        "gains" => wire.gains.iter().map(|one| one.joint.as_str()).collect(),
        "current_limits" => wire.current_limits.iter().map(|one| one.joint.as_str()).collect(),
        _ => return None,
    };
    let name = &robot.joints.get(index.parse::<usize>().ok()?)?.name;
    let place = joints.iter().position(|joint| joint == name);
    let place = place.or_else(|| joints.iter().position(|joint| joint.is_empty()))?;
    let rest = match rest {
        ".coulomb_rate" => ".coulomb_scale_rate",
        ".viscous_rate" => ".viscous_scale_rate",
        "" if field == "current_limits" => ".current_a",
        rest => rest,
    };
    Some(format!("{field}[{place}]{rest}"))
}
