//! The service as its callers see it: a real server on a free port, asked over both protocols.

mod bad_inputs;
mod moves;
mod oracle;
mod plan;
