//! The binary `takt`.

use std::{
    env,
    io::{self, IsTerminal},
    process::ExitCode,
};

use takt_cli::{Io, Terminal, run};

/// A plan is made on one thread and sent from another, which the C library's allocator does not take lightly: it cost
/// the service a sixth of a plan's time (`docs/performance.md`).
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> ExitCode {
    let (output, errors) = (io::stdout(), io::stderr());
    let width = env::var("COLUMNS").ok().and_then(|columns| columns.parse().ok());
    let width = width.or_else(|| terminal_size::terminal_size().map(|(width, _)| usize::from(width.0)));
    let plain = env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty())
        || env::var_os("TERM").is_some_and(|value| value == "dumb");
    let mut io = Io {
        terminal: Terminal {
            width: width.unwrap_or(100),
            table_width: width.filter(|_| output.is_terminal()),
            colour: output.is_terminal() && !plain,
            error_colour: errors.is_terminal() && !plain,
        },
        input: Box::new(io::stdin()),
        output: Box::new(output),
        errors: Box::new(errors),
    };
    ExitCode::from(run(env::args_os(), &mut io))
}
