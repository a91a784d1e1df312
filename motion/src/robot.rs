//! Robot models.

pub mod description;
pub mod spec;
