//! `palmistry lsp`: what an editor asks while a proof file is written.

use super::interrupt::{STACK, interrupted};
use super::{Status, Unusable};
use clap::Args;
use palmistry::lsp::{SessionEnd, serve, standard_streams};
use palmistry::system::Code;

/// Serves an editor over standard input and output, by the Language Server Protocol.
///
/// It gives mistakes as 'check' finds them while you type, what a name is and its dimension, where it is declared (also in files that are
/// imported), the outline of a file, and its normal form as 'fmt' writes it. Editors start it themselves; book/src/editors.md says
/// how. It ends when the editor says so: with exit status 0 where the editor asked it to shut down before, with 1 where it did not.
#[derive(Args)]
#[command(after_help = "Examples:
  palmistry lsp                             started by an editor")]
pub(crate) struct Lsp {
    /// Standard input and output are the channel; accepted because editors pass it.
    #[arg(long)]
    stdio: bool,
}

impl Lsp {
    pub fn run(self) -> miette::Result<Status> {
        let begun = standard_streams().and_then(|(connection, channel)| {
            let thread = std::thread::Builder::new().stack_size(STACK);
            Ok((thread.spawn(move || serve(&connection, &interrupted))?, channel))
        });
        let (served, channel) = begun.map_err(|error| {
            Unusable::report(
                Code::System,
                format!("the system gives no thread to work on: {error}"),
                "end other programs first",
            )
        })?;
        let end = served.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        if end == SessionEnd::Left && interrupted() {
            // the thread that reads waits for an input that may never come
            return Ok(Status::NotAsExpected);
        }
        channel.join().map_err(|error| {
            Unusable::report(
                Code::System,
                format!("the channel to the editor broke: {error}"),
                "'palmistry lsp' is started by an editor",
            )
        })?;
        Ok(match end {
            SessionEnd::Asked => Status::AsExpected,
            SessionEnd::Left => Status::NotAsExpected,
        })
    }
}
