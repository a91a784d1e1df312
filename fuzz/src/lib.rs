//! Fuzz targets of everything that reads what callers send.

pub mod targets;
