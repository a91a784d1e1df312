//! Rehearsals: what is run and what is true of the arm in, what became of it out.

mod outcome;
mod request;

pub use self::{
    outcome::outcome_to_wire,
    request::{finding_on_request, rehearsal_request},
};
