//! The example robots.

use takt_proto::{id::RobotId, v1};

use crate::{
    compute,
    error::ServiceError,
    registry::{Registry, store::StoreError, unavailable},
};

/// Ids and descriptions, as JSON.
const EXAMPLES: [(&str, &str); 4] = [
    ("fr3", include_str!("../../robots/fr3.json")),
    ("puma560", include_str!("../../robots/puma560.json")),
    ("scara", include_str!("../../robots/scara.json")),
    ("ur5e", include_str!("../../robots/ur5e.json")),
];

/// Registers the examples that are not there yet. What callers made of them stays.
pub(crate) async fn register(registry: &Registry) -> Result<(), ServiceError> {
    for (id, description) in EXAMPLES {
        if registry.store().current(id).is_some() {
            continue;
        }
        let description: v1::RobotDescription = serde_json::from_str(description)
            .map_err(|error| ServiceError::internal(format!("robot {id}: {error}")))?;
        let id = RobotId::parse(id).map_err(ServiceError::internal)?;
        let (id, compiled, record, _) = compute::register(Ok(id), Some(description))?;
        let written = registry.store().write(&id, record, Some(String::new())).await;
        match written {
            // Another process was faster.
            Ok(()) | Err(StoreError::Conflict { .. }) => registry.keep(compiled.into()),
            Err(error) => return Err(unavailable(error)),
        }
    }
    Ok(())
}
