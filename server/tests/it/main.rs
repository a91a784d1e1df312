//! The essentials of the service over both protocols, in-process.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a test that cannot go on fails")]

mod harness;
mod limits;
mod robots;
mod wire;
