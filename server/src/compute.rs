//! What runs on the planner's threads: from a request and a robot to the answer. Pure.

mod dynamics;
mod estimate;
mod finite;
mod fit;
mod motor;
mod planned;
mod propose;
mod rehearse;
mod stream;

use std::{sync::Arc, time::Instant};

use prost::Message;
use takt_motion::{
    Invalid,
    budget::Budget,
    confidence::{self, Confident},
    plan::{self, outcome::Setpoints},
    robot::{Robot, spec::RobotSpec, urdf_writer},
};
use takt_proto::{
    convert::{self, Findings, Path, robot::PresetInForce},
    id::{RobotId, content_hash},
    v1,
};

use self::planned::planned;
pub(crate) use self::{
    dynamics::{forward_kinematics, inverse_dynamics, inverse_kinematics},
    estimate::Estimating,
    fit::fit_drive,
    rehearse::rehearse,
    stream::stream_setpoints,
};
use crate::{
    config::Limits,
    error::ServiceError,
    limits::at_most,
    planner::stopped,
    registry::{
        Compiled,
        store::{Record, Revision},
    },
};

/// The robot of a request.
pub(crate) enum Subject {
    /// Found.
    Robot(Arc<Compiled>),
    /// The request does not name one; what else is wrong with it is said together with this.
    Unnamed(Invalid),
}

/// A request being read: its robot, its hash, and what is wrong with it so far.
struct Reading {
    robot: Option<Arc<Compiled>>,
    hash: String,
    findings: Findings,
}

/// What a request says of its revision: it is settled, and counts for the hash, once the robot is known.
trait OfRevision: Message {
    const NAME: &'static str;
    fn revision(&mut self) -> &mut Option<String>;
}

macro_rules! of_revision {
    ($($request:ident)*) => {
        $(impl OfRevision for v1::$request {
            const NAME: &'static str = stringify!($request);

            fn revision(&mut self) -> &mut Option<String> {
                &mut self.revision
            }
        })*
    };
}

of_revision!(
    EstimateHeader FitDriveRequest RehearseRequest PlanMoveRequest PlanPathRequest CheckTrajectoryRequest InverseDynamicsRequest ForwardKinematicsRequest
    InverseKinematicsRequest
);

impl Reading {
    fn of<M: OfRevision>(request: &mut M, subject: Subject) -> Self {
        let mut reading = Self {
            robot: None,
            hash: String::new(),
            findings: Findings::default(),
        };
        match subject {
            Subject::Robot(robot) => {
                *request.revision() = Some(robot.revision.to_string());
                reading.hash = content_hash(M::NAME, request);
                reading.robot = Some(robot);
            }
            Subject::Unnamed(invalid) => reading.findings.push_invalid(invalid),
        }
        reading
    }

    /// Converts the message, or a part of it.
    fn convert<T>(&mut self, convert: impl FnOnce(Option<&RobotSpec>, &mut Findings) -> T) -> T {
        let spec = self.robot.as_ref().map(|robot| robot.robot.spec());
        convert(spec, &mut self.findings)
    }

    /// Where the request is wrong already, what else the planner finds wrong with it: the caller sees everything at once.
    fn look_further<T>(&mut self, plan: impl FnOnce(&Robot, &Budget<'_>) -> Result<T, plan::Failure>) {
        let Some(robot) = self.robot.as_ref().filter(|_| !self.findings.is_empty()) else {
            return;
        };
        // Enough for a request to be looked at, and for nothing to be computed.
        let no_time = Budget::until(&|| true);
        if let Err(plan::Failure::Invalid(list)) = plan(&robot.robot, &no_time) {
            self.findings.extend(list);
        }
    }

    /// The robot and the provenance, when nothing was found wrong.
    fn checked(self) -> Result<(Arc<Compiled>, v1::Provenance), ServiceError> {
        self.findings.finish(()).map_err(ServiceError::invalid)?;
        let robot = self.robot;
        let robot = robot.ok_or_else(|| ServiceError::internal("the request was let through without a robot"))?;
        let provenance = provenance(&robot.revision, self.hash);
        Ok((robot, provenance))
    }
}

/// What the answer was computed from. The hash is of the request with the revision that was used.
fn provenance(revision: &Revision, request_hash: String) -> v1::Provenance {
    v1::Provenance {
        revision: revision.to_string(),
        version: crate::VERSION.to_owned(),
        request_hash,
    }
}

/// A description checked and compiled, and the record to be kept of it.
pub(crate) fn register(
    id: Result<RobotId, Invalid>,
    description: Option<v1::RobotDescription>,
) -> Result<(RobotId, Compiled, Record, v1::Robot), ServiceError> {
    let mut findings = Findings::default();
    if let Err(invalid) = &id {
        findings.push_invalid(invalid.clone());
    }
    let at = Path::Root.field("description");
    let Some(mut description) = description else {
        findings.push(at, "must be given");
        return Err(ServiceError::invalid(findings.into_list()));
    };
    // Said or not, the default is the same content, and so the same revision.
    description.use_urdf_dynamics = description.use_urdf_dynamics.filter(|used| *used);
    let robot = match compile(&description, findings) {
        Ok(robot) => robot,
        Err(invalid) => return Err(ServiceError::invalid(invalid)),
    };
    let id = id.map_err(|invalid| ServiceError::invalid(vec![invalid]))?;
    let revision: Revision = content_hash("RobotDescription", &description).into();
    let summary = convert::robot::robot_to_wire(id.as_str(), &revision, robot.spec(), robot.warnings(), |joint| {
        robot.preset(joint).map(|preset| PresetInForce {
            acceleration: preset.acceleration,
            deceleration: preset.deceleration,
            derived: preset.derived,
        })
    });
    let record = Record {
        revision: Arc::clone(&revision),
        description: description.encode_to_vec(),
        summary: summary.encode_to_vec(),
    };
    Ok((id, Compiled { revision, robot }, record, summary))
}

/// A stored description compiled again.
pub(crate) fn compile_stored(record: &Record) -> Result<Robot, ServiceError> {
    let description = decode::<v1::RobotDescription>(&record.description)?;
    compile(&description, Findings::default()).map_err(|invalid| {
        let first = invalid.first().map(ToString::to_string).unwrap_or_default();
        let message = format!("this version cannot use revision {} any more: {first}", record.revision);
        ServiceError::internal(message)
    })
}

/// A stored message.
pub(crate) fn decode<M: Message + Default>(bytes: &[u8]) -> Result<M, ServiceError> {
    M::decode(bytes).map_err(|error| ServiceError::internal("a stored message cannot be read").caused_by(error))
}

fn compile(wire: &v1::RobotDescription, mut findings: Findings) -> Result<Robot, Vec<Invalid>> {
    let at = Path::Root.field("description");
    let below = |invalid: Invalid| invalid.below("description");
    let Some(description) = convert::robot::description(wire, at, &mut findings) else {
        return Err(findings.into_list());
    };
    // Also where something is wrong already: the caller sees everything at once.
    let resolved = match description.resolve() {
        Ok(resolved) => findings.finish(resolved)?,
        Err(list) => {
            let list = list.into_iter();
            let list = list.map(|invalid| below(convert::robot::finding_on_description(invalid, wire)));
            findings.extend(list.collect());
            return Err(findings.into_list());
        }
    };
    let spec = resolved.spec.clone();
    Robot::new(resolved.spec, resolved.warnings).map_err(|list| {
        let list = list.into_iter();
        let list = list.map(|invalid| below(convert::robot::finding_on_spec(invalid, &spec, wire)));
        list.collect()
    })
}

/// The chain as a URDF.
pub(crate) fn urdf(robot: &Robot, id: &RobotId) -> String {
    urdf_writer::write(robot.spec(), id.as_str())
}

/// Plans a move.
pub(crate) fn plan_move(
    request: v1::PlanMoveRequest,
    subject: Subject,
    limits: &Limits,
    deadline: Instant,
    budget: &Budget<'_>,
) -> Result<v1::PlanMoveResponse, ServiceError> {
    let planned = planned(request, subject, limits, deadline, budget)?;
    let spec = planned.robot.robot.spec();
    let mut outcome = convert::confidence::move_to_wire(planned.outcome, spec);
    if let v1::plan_move_response::Outcome::Plan(plan) = &mut outcome {
        motor::add_all(planned.motors.as_ref(), &mut plan.setpoints, &mut plan.warnings, spec);
    }
    Ok(v1::PlanMoveResponse {
        outcome: Some(outcome),
        provenance: Some(planned.provenance),
    })
}

/// Plans a robot program.
pub(crate) fn plan_path(
    request: v1::PlanPathRequest,
    subject: Subject,
    limits: &Limits,
    deadline: Instant,
    budget: &Budget<'_>,
) -> Result<v1::PlanPathResponse, ServiceError> {
    let planned = planned(request, subject, limits, deadline, budget)?;
    let spec = planned.robot.robot.spec();
    let mut outcome = convert::confidence::path_to_wire(planned.outcome, spec);
    if let v1::plan_path_response::Outcome::Plan(plan) = &mut outcome {
        motor::add_all(planned.motors.as_ref(), &mut plan.setpoints, &mut plan.warnings, spec);
    }
    Ok(v1::PlanPathResponse {
        outcome: Some(outcome),
        provenance: Some(planned.provenance),
    })
}

fn check_trace(findings: &mut Findings, trace_points: Option<u32>, limits: &Limits) {
    let count = usize::try_from(trace_points.unwrap_or(0)).unwrap_or(usize::MAX);
    if let Some(invalid) = at_most("trace_points", count, limits.max_setpoints, "max_setpoints") {
        findings.push_invalid(invalid);
    }
}

/// How many set-points a period makes is known when the plan is.
fn check_setpoints(setpoints: Option<&Setpoints>, limits: &Limits) -> Result<(), ServiceError> {
    let count = setpoints.map_or(0, |setpoints| setpoints.time.len());
    match at_most("sample_period_s", count, limits.max_setpoints, "max_setpoints") {
        Some(invalid) => Err(ServiceError::invalid(vec![invalid])),
        None => Ok(()),
    }
}

/// What the bounds of requests and models should have kept out.
fn not_finite() -> ServiceError {
    ServiceError::internal("the answer has a number that is not finite: this is a fault of the service")
}

fn failed(failure: plan::Failure, deadline: Instant) -> ServiceError {
    match failure {
        plan::Failure::Invalid(violations) => ServiceError::invalid(violations),
        plan::Failure::Stopped => stopped(deadline),
    }
}

/// Checks a trajectory.
pub(crate) fn check_trajectory(
    mut request: v1::CheckTrajectoryRequest,
    subject: Subject,
    limits: &Limits,
    deadline: Instant,
    budget: &Budget<'_>,
) -> Result<v1::CheckTrajectoryResponse, ServiceError> {
    let mut reading = Reading::of(&mut request, subject);
    let trajectory = request.trajectory.as_ref();
    let count = trajectory.map_or(0, |trajectory| trajectory.points.len());
    const POINTS: &str = "trajectory.points";
    if let Some(invalid) = at_most(POINTS, count, limits.max_trajectory_points, "max_trajectory_points") {
        return Err(ServiceError::invalid(vec![invalid]));
    }
    let asked = request.confidence;
    let confidence = reading.convert(|spec, findings| convert::confidence::read(asked.as_ref(), spec, findings));
    let request = reading.convert(|spec, findings| convert::plan::check_request(request, spec, findings));
    reading.look_further(|robot, budget| plan::check_trajectory(robot, &request, budget));
    let (robot, provenance) = reading.checked()?;
    let report = match confidence {
        Some(confidence) => confidence::check_trajectory(&robot.robot, &request, confidence, budget),
        None => plan::check_trajectory(&robot.robot, &request, budget).map(Confident::without),
    };
    let report = report.map_err(|failure| failed(failure, deadline))?;
    if !(finite::report(&report.outcome) && finite::confidence(&report)) {
        return Err(not_finite());
    }
    Ok(v1::CheckTrajectoryResponse {
        provenance: Some(provenance),
        ..convert::confidence::check_to_wire(report, robot.robot.spec())
    })
}
