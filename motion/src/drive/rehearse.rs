//! Rehearsals.

pub mod outcome;
pub mod request;
