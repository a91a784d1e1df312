//! Telemetry in, friction out.

mod estimate;
mod telemetry;

pub(super) use self::telemetry::{Column, in_model_order, is_given};
pub use self::{
    estimate::{
        estimate_to_wire, finding_on_header, finding_on_telemetry, friction_change_to_wire, options, state,
        state_to_wire,
    },
    telemetry::telemetry,
};
