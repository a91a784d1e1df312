//! Where a command reads and writes.

use std::io::{self, ErrorKind, Read, Write};

use crate::failure::Failure;

/// The streams of a command.
pub struct Io {
    /// Standard input.
    pub input: Box<dyn Read + Send>,
    /// Standard output: answers.
    pub output: Box<dyn Write>,
    /// Standard error: everything else.
    pub errors: Box<dyn Write>,
    /// What is known of the screen.
    pub terminal: Terminal,
}

impl std::fmt::Debug for Io {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Io")
            .field("terminal", &self.terminal)
            .finish_non_exhaustive()
    }
}

/// What is known of the screen.
#[derive(Debug, Clone, Copy)]
pub struct Terminal {
    /// Columns, for plots.
    pub width: usize,
    /// Columns that tables must fit; `None`: they may be as wide as they are.
    pub table_width: Option<usize>,
    /// Whether standard output may be coloured.
    pub colour: bool,
    /// Whether standard error may be coloured.
    pub error_colour: bool,
}

impl Terminal {
    pub(crate) fn colour_of(self, errors: bool) -> bool {
        if errors { self.error_colour } else { self.colour }
    }
}

impl Io {
    /// Says each warning once, on standard error: with --json too, where standard output is the reply alone.
    pub(crate) fn warn<'a>(&mut self, warnings: impl IntoIterator<Item = &'a String>) -> Result<(), Failure> {
        let mut said: Vec<&String> = Vec::new();
        for warning in warnings {
            if !said.contains(&warning) {
                self.remark(&format!("warning: {warning}"))?;
                said.push(warning);
            }
        }
        Ok(())
    }

    /// Writes an answer. A reader that has gone away (`takt … | head`) is no failure.
    pub(crate) fn print(&mut self, text: &str) -> Result<(), Failure> {
        quiet(
            self.output
                .write_all(text.as_bytes())
                .and_then(|()| self.output.flush()),
        )
    }

    /// Writes a piece of an answer; false where nobody reads any more.
    pub(crate) fn pass(&mut self, text: &str) -> Result<bool, Failure> {
        let written = self
            .output
            .write_all(text.as_bytes())
            .and_then(|()| self.output.flush());
        let goes_on = written.is_ok();
        quiet(written)?;
        Ok(goes_on)
    }

    /// Writes a remark.
    pub(crate) fn remark(&mut self, text: &str) -> Result<(), Failure> {
        quiet(writeln!(self.errors, "{text}").and_then(|()| self.errors.flush()))
    }
}

fn quiet(result: io::Result<()>) -> Result<(), Failure> {
    match result {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::service(format!("cannot write the answer: {error}")))
        }
        _ => Ok(()),
    }
}
