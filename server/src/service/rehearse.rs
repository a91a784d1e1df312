//! Rehearsals: the robot of the motion is that of the request around it.

use std::sync::Arc;

use takt_motion::{Invalid, budget::Budget};
use takt_proto::{
    convert::quoted,
    v1::{self, rehearse_request::Motion},
};

use super::{Answer, Call, Service, answer, streams::adopt};
use crate::{compute, error::ServiceError, form::Form};

impl Service {
    /// Runs a motion on a simulated arm.
    pub(crate) async fn rehearse<F: Form<v1::RehearseResponse>>(
        self: &Arc<Self>,
        call: Call,
        mut request: v1::RehearseRequest,
    ) -> Result<Answer<F::Written>, ServiceError> {
        settle(&mut request)?;
        let subject = self
            .subject(call, &request.robot_id, request.revision.as_deref())
            .await?;
        let service = Arc::clone(self);
        let job = move |budget: &Budget<'_>| {
            F::write(compute::rehearse(
                request,
                subject,
                &service.limits,
                call.deadline,
                budget,
            )?)
        };
        let (message, timing) = self.run(call, job).await?;
        Ok(answer(message, timing))
    }
}

/// Robot and revision stand once: in the request itself.
fn settle(request: &mut v1::RehearseRequest) -> Result<(), ServiceError> {
    let (field, robot_id, revision) = match &mut request.motion {
        Some(Motion::Move(motion)) => ("move", &mut motion.robot_id, &mut motion.revision),
        Some(Motion::Path(motion)) => ("path", &mut motion.robot_id, &mut motion.revision),
        Some(Motion::Setpoints(_)) | None => return Ok(()),
    };
    adopt(field, &request.robot_id, robot_id)?;
    request.robot_id = std::mem::take(robot_id);
    match (revision.take(), &request.revision) {
        (Some(inner), Some(outer)) if inner != *outer => {
            let message = format!(
                "{} is not the {} of the request around it",
                quoted(&inner),
                quoted(outer)
            );
            let invalid = Invalid::new(format!("{field}.revision"), message);
            Err(ServiceError::invalid(vec![invalid]))
        }
        (Some(inner), None) => {
            request.revision = Some(inner);
            Ok(())
        }
        _ => Ok(()),
    }
}
