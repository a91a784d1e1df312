//! Plans: what is asked for, and the answers.

pub mod outcome;
pub mod request;
