//! The use cases: the same for both protocols.

mod fit;
mod rehearse;
mod streams;
mod telemetry;

use std::{
    sync::Arc,
    time::{Duration, Instant},
};

use futures::FutureExt;
use takt_motion::{Invalid, budget::Budget};
use takt_proto::{error::Error, id::RobotId, v1};
use tokio::sync::Semaphore;
use tracing::Span;

pub(crate) use self::{streams::Incoming, telemetry::Arrived};
use crate::{
    compute::{self, Subject},
    config::Limits,
    error::ServiceError,
    form::Form,
    planner::{Length, Pool, Timing},
    registry::{
        Compiled, Registry, no_revision, no_robot,
        store::{Sequence, check_expected},
        unavailable,
    },
};

/// What a request carries beside its message.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Call {
    /// When the answer must be there.
    pub(crate) deadline: Instant,
    /// Time for one answer from its request on.
    allowed: Duration,
    /// Whether it waits where the planner's queue is full; else it is refused.
    in_turn: bool,
}

impl Call {
    pub(crate) fn new(deadline: Instant, allowed: Duration) -> Self {
        Self {
            deadline,
            allowed,
            in_turn: false,
        }
    }

    /// The call of one request of a stream, which begins now.
    pub(crate) fn of_item(self) -> Self {
        Self {
            deadline: Instant::now() + self.allowed,
            in_turn: true,
            ..self
        }
    }
}

/// A message, and how long it took.
#[derive(Debug)]
pub(crate) struct Answer<T> {
    pub(crate) message: T,
    pub(crate) timing: Timing,
}

/// The use cases.
#[derive(Debug)]
pub(crate) struct Service {
    registry: Registry,
    planner: Pool,
    /// Turns of streams at the planner's door.
    turns: Semaphore,
    limits: Limits,
}

const PAGE_SIZE: u32 = 100;
const LARGEST_PAGE: u32 = 1000;

/// One calculation on the planner's threads about one robot; its answer in the form that the caller wants.
macro_rules! calculation {
    ($(#[$doc:meta])* $name:ident: $request:ident -> $response:ident, $length:path) => {
        $(#[$doc])*
        pub(crate) async fn $name<F: Form<v1::$response>>(
            self: &Arc<Self>,
            call: Call,
            request: v1::$request,
        ) -> Result<Answer<F::Written>, ServiceError> {
            let subject = self.subject(call, &request.robot_id, request.revision.as_deref()).await?;
            let length = $length(&request);
            let service = Arc::clone(self);
            let job = move |budget: &Budget<'_>| {
                F::write(compute::$name(request, subject, &service.limits, call.deadline, budget)?)
            };
            let (message, timing) = self.run_of(call, length, job).await?;
            Ok(answer(message, timing))
        }
    };
}

impl Service {
    pub(crate) fn new(registry: Registry, planner: Pool, limits: Limits) -> Self {
        Self {
            registry,
            turns: Semaphore::new(planner.thread_count()),
            planner,
            limits,
        }
    }

    /// Runs a calculation for a call on the planner's threads.
    pub(crate) async fn run<T, J>(&self, call: Call, job: J) -> Result<(T, Timing), ServiceError>
    where
        T: Send + 'static,
        J: FnOnce(&Budget<'_>) -> Result<T, ServiceError> + Send + 'static,
    {
        self.run_of(call, Length::Any, job).await
    }

    async fn run_of<T, J>(&self, call: Call, length: Length, job: J) -> Result<(T, Timing), ServiceError>
    where
        T: Send + 'static,
        J: FnOnce(&Budget<'_>) -> Result<T, ServiceError> + Send + 'static,
    {
        match call.in_turn {
            true => self.planner.run_in_turn(call.deadline, length, job).await,
            false => self.planner.run(call.deadline, length, job).await,
        }
    }

    calculation!(plan_move: PlanMoveRequest -> PlanMoveResponse, length_of_move);
    calculation!(plan_path: PlanPathRequest -> PlanPathResponse, any_length);
    calculation!(check_trajectory: CheckTrajectoryRequest -> CheckTrajectoryResponse, any_length);
    calculation!(inverse_dynamics: InverseDynamicsRequest -> InverseDynamicsResponse, any_length);
    calculation!(forward_kinematics: ForwardKinematicsRequest -> ForwardKinematicsResponse, any_length);
    calculation!(inverse_kinematics: InverseKinematicsRequest -> InverseKinematicsResponse, any_length);

    /// Checks a description and keeps it.
    pub(crate) async fn register_robot(
        &self,
        call: Call,
        request: v1::RegisterRobotRequest,
    ) -> Result<Answer<v1::RegisterRobotResponse>, ServiceError> {
        let id = robot_id(&request.robot_id);
        let description = request.description;
        let job = move |_: &Budget<'_>| compute::register(id, description);
        let ((id, compiled, record, summary), timing) = self.run(call, job).await?;
        Span::current().record("robot", id.as_str());
        Span::current().record("revision", &*compiled.revision);
        if request.validate_only.unwrap_or(false) {
            let current = self.registry.store().current(id.as_str());
            check_expected(current.as_ref(), request.expected_revision.as_deref()).map_err(unavailable)?;
        } else {
            let written = self.registry.store().write(&id, record, request.expected_revision);
            written.await.map_err(unavailable)?;
            self.registry.keep(Arc::new(compiled));
        }
        let message = v1::RegisterRobotResponse { robot: Some(summary) };
        Ok(answer(message, timing))
    }

    /// The description back out.
    pub(crate) async fn get_robot(
        &self,
        call: Call,
        request: v1::GetRobotRequest,
    ) -> Result<Answer<v1::GetRobotResponse>, ServiceError> {
        let id = named(&request.robot_id)?;
        let current = self.registry.store().current(id.as_str());
        let current = current.ok_or_else(|| no_robot(&id))?;
        let wanted = request.revision.as_deref().unwrap_or(&current);
        let record = self.registry.store().read(&id, wanted).await.map_err(unavailable)?;
        let record = record.ok_or_else(|| no_revision(&id, wanted))?;
        let mut urdf = None;
        if request.as_urdf.unwrap_or(false) {
            let compiled = self.compiled(call, &id, Some(wanted)).await?;
            urdf = Some(compute::urdf(&compiled.robot, &id));
        }
        let message = v1::GetRobotResponse {
            robot: Some(compute::decode(&record.summary)?),
            description: Some(compute::decode(&record.description)?),
            urdf,
        };
        Ok(answer(message, Timing::default()))
    }

    /// Robots in the order of their ids.
    pub(crate) async fn list_robots(
        &self,
        request: v1::ListRobotsRequest,
    ) -> Result<Answer<v1::ListRobotsResponse>, ServiceError> {
        let mut violations = Vec::new();
        let count = page_size(request.page_size, &mut violations);
        let after = page_token(request.page_token.as_deref(), &mut violations, |text| {
            RobotId::parse(text).ok()
        });
        if !violations.is_empty() {
            return Err(ServiceError::invalid(violations));
        }
        let after = after.as_ref().map(RobotId::as_str);
        let found = self
            .registry
            .store()
            .list(after, count + 1)
            .await
            .map_err(unavailable)?;
        let next_page_token = match found.get(count) {
            Some(_) => to_token(&found[count - 1].0),
            None => String::new(),
        };
        let robots = found.iter().take(count).map(|(_, summary)| compute::decode(summary));
        let message = v1::ListRobotsResponse {
            robots: robots.collect::<Result<_, _>>()?,
            next_page_token,
        };
        Ok(answer(message, Timing::default()))
    }

    /// Revisions of one robot, newest first.
    pub(crate) async fn list_revisions(
        &self,
        request: v1::ListRevisionsRequest,
    ) -> Result<Answer<v1::ListRevisionsResponse>, ServiceError> {
        let mut violations = Vec::new();
        let id = robot_id(&request.robot_id).map_err(|invalid| violations.push(invalid));
        let count = page_size(request.page_size, &mut violations);
        let before = page_token(request.page_token.as_deref(), &mut violations, |text| {
            text.parse::<Sequence>().ok()
        });
        let Ok(id) = id else {
            return Err(ServiceError::invalid(violations));
        };
        if !violations.is_empty() {
            return Err(ServiceError::invalid(violations));
        }
        Span::current().record("robot", id.as_str());
        let found = self.registry.store().revisions(&id, before, count + 1).await;
        let found = found.map_err(|error| match error {
            crate::registry::store::StoreError::NotFound => no_robot(&id),
            other => unavailable(other),
        })?;
        let next_page_token = match found.get(count) {
            Some(_) => to_token(&found[count - 1].0.to_string()),
            None => String::new(),
        };
        let revisions = found.into_iter().take(count).map(|(_, revision)| revision);
        let message = v1::ListRevisionsResponse {
            revisions: revisions.collect(),
            next_page_token,
        };
        Ok(answer(message, Timing::default()))
    }

    /// Deletes a robot with all its revisions.
    pub(crate) async fn delete_robot(
        &self,
        request: v1::DeleteRobotRequest,
    ) -> Result<Answer<v1::DeleteRobotResponse>, ServiceError> {
        let id = named(&request.robot_id)?;
        let deleted = self.registry.delete(&id, request.expected_revision).await;
        deleted.map_err(|error| match error {
            crate::registry::store::StoreError::NotFound => no_robot(&id),
            other => unavailable(other),
        })?;
        Ok(answer(v1::DeleteRobotResponse {}, Timing::default()))
    }

    async fn subject(&self, call: Call, id: &str, revision: Option<&str>) -> Result<Subject, ServiceError> {
        let id = match robot_id(id) {
            Ok(id) => id,
            Err(invalid) => return Ok(Subject::Unnamed(invalid)),
        };
        let robot = self.compiled(call, &id, revision).await?;
        let span = Span::current();
        span.record("robot", id.as_str());
        span.record("revision", &*robot.revision);
        Ok(Subject::Robot(robot))
    }

    async fn compiled(&self, call: Call, id: &RobotId, revision: Option<&str>) -> Result<Arc<Compiled>, ServiceError> {
        let compile = |record| {
            let job = move |_: &Budget<'_>| compute::compile_stored(&record);
            let compiling = self.run(call, job);
            async move { Ok(compiling.await?.0) }.boxed()
        };
        self.registry.compiled(id, revision, compile).await
    }
}

/// A move takes some ten microseconds; its set-points take as long as there are many of them.
fn length_of_move(request: &v1::PlanMoveRequest) -> Length {
    match (request.sample_period_s, request.trace_points) {
        (None, None) => Length::Brief,
        _ => Length::Any,
    }
}

fn any_length<T>(_: &T) -> Length {
    Length::Any
}

fn answer<T>(message: T, timing: Timing) -> Answer<T> {
    let span = Span::current();
    if !span.is_disabled() {
        span.record("queue_us", micros(timing.queue));
        span.record("compute_us", micros(timing.compute));
    }
    Answer { message, timing }
}

fn micros(duration: std::time::Duration) -> u64 {
    u64::try_from(duration.as_micros()).unwrap_or(u64::MAX)
}

fn robot_id(id: &str) -> Result<RobotId, Invalid> {
    RobotId::parse(id).map_err(|message| Invalid::new("robot_id", message))
}

fn named(id: &str) -> Result<RobotId, ServiceError> {
    let id = robot_id(id).map_err(|invalid| Error::invalid(vec![invalid]))?;
    Span::current().record("robot", id.as_str());
    Ok(id)
}

fn page_size(size: Option<u32>, violations: &mut Vec<Invalid>) -> usize {
    let size = size.unwrap_or(PAGE_SIZE);
    if !(1..=LARGEST_PAGE).contains(&size) {
        let message = format!("{size} must be at least 1 and at most {LARGEST_PAGE}");
        violations.push(Invalid::new("page_size", message));
    }
    usize::try_from(size).unwrap_or(usize::MAX)
}

/// Tokens are the place to go on from, in hexadecimal: not meant to be read or made by callers.
fn to_token(place: &str) -> String {
    use std::fmt::Write;
    let mut token = String::with_capacity(2 * place.len());
    for byte in place.bytes() {
        // Writing to a string does not fail.
        let _ = write!(token, "{byte:02x}");
    }
    token
}

fn page_token<T>(
    token: Option<&str>,
    violations: &mut Vec<Invalid>,
    read: impl FnOnce(&str) -> Option<T>,
) -> Option<T> {
    let token = token.filter(|token| !token.is_empty())?;
    let place = from_token(token).and_then(|place| read(&place));
    if place.is_none() {
        let message = format!("{} is not a token of this service", takt_proto::convert::quoted(token));
        violations.push(Invalid::new("page_token", message));
    }
    place
}

fn from_token(token: &str) -> Option<String> {
    if !token.len().is_multiple_of(2) {
        return None;
    }
    let pairs = token.as_bytes().chunks_exact(2);
    let bytes = pairs.map(|pair| u8::from_str_radix(std::str::from_utf8(pair).ok()?, 16).ok());
    String::from_utf8(bytes.collect::<Option<_>>()?).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tokens_come_back() {
        for place in ["a", "cell-3.arm_2", "42"] {
            assert_eq!(from_token(&to_token(place)).as_deref(), Some(place));
        }
        for bad in ["0", "zz", "é"] {
            assert_eq!(page_token(Some(bad), &mut Vec::new(), |_| Some(())), None, "{bad}");
        }
    }
}
