//! Robot programs in, timed paths out.

mod blend;
mod outcome;
mod request;

pub(super) use self::outcome::infeasible_to_wire;
pub use self::{
    outcome::{SetpointsOf, outcome_to_wire},
    request::path_request,
};
