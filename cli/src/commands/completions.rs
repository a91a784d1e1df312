//! `takt completions`.

use clap::{Args, CommandFactory};
use clap_complete::Shell;

use crate::{args::Cli, exit, failure::Failure, io::Io};

/// Prints completions for a shell.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  takt completions bash > /etc/bash_completion.d/takt
  takt completions zsh > ~/.zfunc/_takt
  takt completions fish > ~/.config/fish/completions/takt.fish")]
pub(crate) struct CompletionsArgs {
    /// The shell.
    shell: Shell,
}

pub(crate) fn run(args: &CompletionsArgs, io: &mut Io) -> Result<u8, Failure> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "takt", &mut script);
    io.print(&String::from_utf8_lossy(&script))?;
    Ok(exit::OK)
}
