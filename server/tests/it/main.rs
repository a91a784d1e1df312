//! The essentials of the service over both protocols, in-process.

mod harness;
mod limits;
mod robots;
mod wire;
