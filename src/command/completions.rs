//! `palmistry completions`: what a shell needs to complete the command line.

use super::output::print_text;
use super::{Cli, Status};
use clap::{Args, CommandFactory};
use clap_complete::{Shell, generate};

/// Prints a script with which a shell completes commands, options and files.
#[derive(Args)]
#[command(after_help = "Examples:
  palmistry completions bash > ~/.local/share/bash-completion/completions/palmistry
  palmistry completions zsh > ~/.zfunc/_palmistry          where fpath has ~/.zfunc
  palmistry completions fish > ~/.config/fish/completions/palmistry.fish")]
pub(crate) struct Completions {
    /// The shell.
    shell: Shell,
}

impl Completions {
    pub fn run(self) -> miette::Result<Status> {
        let mut script = Vec::new();
        generate(self.shell, &mut Cli::command(), "palmistry", &mut script);
        print_text(String::from_utf8_lossy(&script).trim_end_matches('\n'))?;
        Ok(Status::AsExpected)
    }
}
