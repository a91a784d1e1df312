//! Robot models: what callers describe, how it is read, and what comes of it.

pub(crate) mod bounds;
pub mod chain;
pub mod description;
pub(crate) mod dh;
pub(crate) mod findings;
pub(crate) mod inertial;
pub mod resolve;
pub(crate) mod rotation;
pub mod spec;
pub mod urdf;
pub mod urdf_writer;
