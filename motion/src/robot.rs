//! Robot models.

pub mod spec;
