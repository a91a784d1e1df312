//! Fits: the description that a proposal changes is read before it is computed.

use std::sync::Arc;

use takt_motion::budget::Budget;
use takt_proto::v1;

use super::{Answer, Call, Service, answer, robot_id};
use crate::{
    compute::{self, Subject},
    error::ServiceError,
    form::Form,
    registry::unavailable,
};

impl Service {
    /// Fits drives and bodies to a recording.
    pub(crate) async fn fit_drive<F: Form<v1::FitDriveResponse>>(
        self: &Arc<Self>,
        call: Call,
        request: v1::FitDriveRequest,
    ) -> Result<Answer<F::Written>, ServiceError> {
        let subject = self
            .subject(call, &request.robot_id, request.revision.as_deref())
            .await?;
        let description = match (&subject, robot_id(&request.robot_id)) {
            (Subject::Robot(robot), Ok(id)) => {
                let record = self.registry.store().read(&id, &robot.revision).await;
                record.map_err(unavailable)?.map(|record| record.description)
            }
            _ => None,
        };
        let job = move |budget: &Budget<'_>| {
            F::write(compute::fit_drive(
                request,
                subject,
                description.as_deref(),
                call.deadline,
                budget,
            )?)
        };
        let (message, timing) = self.run(call, job).await?;
        Ok(answer(message, timing))
    }
}
