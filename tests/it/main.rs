//! The service as its callers see it: a real server on a free port, asked over both protocols.

mod bad_inputs;
mod contract;
mod limits;
mod moves;
mod mutations;
mod operations;
mod oracle;
mod plan;
mod registry;
mod tidy;
