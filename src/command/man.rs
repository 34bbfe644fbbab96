//! `palmistry man`: the manual pages.

use super::output::{Files, Form, print_text};
use super::{Cli, Status, Unusable};
use clap::{Args, CommandFactory};
use palmistry::foreign::shown_path;
use palmistry::system::Code;
use serde_json::json;
use std::path::PathBuf;

/// Prints the manual page, or writes the pages of all commands into a folder.
#[derive(Args)]
#[command(after_help = "Examples:
  palmistry man | man -l -                  the page of the program
  palmistry man --out ~/.local/share/man/man1")]
pub(crate) struct Man {
    /// Write 'palmistry.1' and a page for each command, such as 'palmistry-prove.1', into this folder.
    #[arg(long, value_name = "FOLDER")]
    pub(super) out: Option<PathBuf>,
}

/// The name of each page's file and its text, that of the program first.
pub(super) fn pages() -> Result<Vec<(String, String)>, std::io::Error> {
    let mut cli = Cli::command();
    // names, versions and usages of commands are made when the command line is built
    cli.build();
    // the list of the commands is on the first page
    let commands = cli.get_subcommands().filter(|command| command.get_name() != "help").cloned();
    let mut pages = Vec::new();
    for (index, command) in std::iter::once(cli.clone()).chain(commands).enumerate() {
        let name = match index {
            0 => command.get_name().to_owned(),
            _ => format!("palmistry-{}", command.get_name()),
        };
        let page = clap_mangen::Man::new(command.display_name(&name)).title(name.to_uppercase());
        let mut text = Vec::new();
        page.render(&mut text)?;
        pages.push((format!("{name}.1"), String::from_utf8_lossy(&text).into_owned()));
    }
    Ok(pages)
}

impl Man {
    pub fn run(self) -> miette::Result<Status> {
        let pages = pages().map_err(|error| {
            Unusable::report(Code::System, format!("the pages cannot be made: {error}"), "")
        })?;
        let Some(folder) = self.out else {
            print_text(pages[0].1.trim_end_matches('\n'))?;
            return Ok(Status::AsExpected);
        };
        let mut files = Files::default();
        for (name, text) in &pages {
            files.text(&folder.join(name), text);
        }
        let written = pages.iter().filter(|(name, _)| files.has_written(&folder.join(name))).count();
        let words = || format!("{written} pages in {}", shown_path(&folder));
        files.print(Form::Text, json!({}), words, Status::AsExpected)
    }
}
