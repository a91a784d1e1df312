//! The service as its callers see it: a real server on a free port, asked over both protocols.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod bad_inputs;
mod bench;
mod confidence;
mod contract;
mod fit_motion;
mod inverse;
mod limits;
mod moves;
mod mutations;
mod operations;
mod oracle;
mod plan;
mod programs;
mod registry;
mod rehearse;
mod streams;
mod telemetry;
mod tidy;
