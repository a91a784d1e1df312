//! The command line of Takt, as a library: the binary `takt` calls [`run`], and so can a test.
//!
//! Arguments are read in `args` and beside each command; `commands` has one file a command, `render` one a form of
//! output. Exit codes are [`exit`]'s.

mod args;
mod commands;
mod failure;
mod files;
mod follow;
mod io;
mod log;
mod numbers;
mod render;
mod sheet;
mod telemetry;

pub use crate::io::{Io, Terminal};

/// What the process ends with.
pub mod exit {
    /// Done.
    pub const OK: u8 = 0;
    /// The service could not be reached, could not do it, or took too long.
    pub const SERVICE: u8 = 1;
    /// The command line or the request is wrong.
    pub const USAGE: u8 = 2;
    /// The answer is no: the move is infeasible, or the trajectory breaks a limit.
    pub const NO: u8 = 3;
}

use std::{ffi::OsString, io::Write};

use clap::Parser;

/// Runs one command and returns its exit code.
pub fn run(args: impl IntoIterator<Item = OsString>, io: &mut Io) -> u8 {
    let cli = match args::Cli::try_parse_from(args) {
        Ok(cli) => cli,
        Err(error) => {
            let text = error.render();
            let (is_error, colour) = (error.use_stderr(), io.terminal.colour_of(error.use_stderr()));
            let text = if colour {
                text.ansi().to_string()
            } else {
                text.to_string()
            };
            let stream = if is_error { &mut io.errors } else { &mut io.output };
            // Nobody is left to be told that nobody listens.
            let _ = stream.write_all(text.as_bytes()).and_then(|()| stream.flush());
            return u8::try_from(error.exit_code()).unwrap_or(exit::USAGE);
        }
    };
    match commands::run(cli, io) {
        Ok(code) => code,
        Err(failure) => {
            let text = failure.render(io.terminal.error_colour);
            let _ = io.errors.write_all(text.as_bytes()).and_then(|()| io.errors.flush());
            failure.code
        }
    }
}
