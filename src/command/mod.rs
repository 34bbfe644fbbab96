//! Floor 8: the command line. A file a verb: it reads its arguments, calls the library, and prints.
//!
//! Results go to standard output (as JSON with `--json`), progress and words to standard error. The exit status is 0
//! when all is as expected, 1 when something is not, 2 when the input could not be used.

mod arguments;
mod certify;
mod eval;
mod observe;
mod output;
mod prove;
mod rank;
mod recheck;
mod stress;
mod trade;
mod verify;

use clap::{Parser, Subcommand};
use miette::{Diagnostic, Report};
use std::process::ExitCode;

/// Checks mathematics about systems that are seen only through their outputs.
///
/// Write down a control system and what you claim of it in a .proof file (the README has the grammar); palmistry says,
/// claim by claim, proved, refuted (with a witness) or undecided. Without a command it runs 'verify'.
#[derive(Parser)]
#[command(name = "palmistry", version, max_term_width = 110)]
#[command(after_help = "Exit status: 0 all as expected, 1 something is not, 2 the input could not be used.")]
struct Cli {
    #[command(subcommand)]
    verb: Option<Verb>,
}

#[derive(Subcommand)]
enum Verb {
    Verify(verify::Verify),
    Prove(prove::Prove),
    Rank(rank::Rank),
    Recheck(recheck::Recheck),
    Certify(certify::Certify),
    Trade(trade::Trade),
    Stress(stress::Stress),
    Eval(eval::Eval),
    Observe(observe::Observe),
}

/// What a command has come to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Status {
    AsExpected,
    NotAsExpected,
}

/// Input that could not be used, in words.
#[derive(Debug, Diagnostic, thiserror::Error)]
#[error("{message}")]
pub(crate) struct Unusable {
    pub message: String,
    #[help]
    pub help: Option<String>,
}

impl Unusable {
    pub fn report(message: impl Into<String>, help: impl Into<String>) -> Report {
        let help: String = help.into();
        Report::new(Unusable { message: message.into(), help: (!help.is_empty()).then_some(help) })
    }
}

/// Runs the program with the arguments it was started with.
pub fn run() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => {
            // --help and --version come this way too, and are no errors
            let _ = error.print();
            return ExitCode::from(if error.use_stderr() { 2 } else { 0 });
        }
    };
    output::stop_on_interrupt();
    let verb = cli.verb.unwrap_or_else(|| Verb::Verify(verify::Verify::default()));
    let (json, result) = match verb {
        Verb::Verify(verb) => (verb.json, verb.run()),
        Verb::Prove(verb) => (verb.json, verb.run()),
        Verb::Rank(verb) => (verb.json, verb.run()),
        Verb::Recheck(verb) => (verb.json, verb.run()),
        Verb::Certify(verb) => (verb.json, verb.run()),
        Verb::Trade(verb) => (verb.json, verb.run()),
        Verb::Stress(verb) => (verb.json, verb.run()),
        Verb::Eval(verb) => (verb.json, verb.run()),
        Verb::Observe(verb) => (verb.json, verb.run()),
    };
    match result {
        Ok(Status::AsExpected) => ExitCode::SUCCESS,
        Ok(Status::NotAsExpected) => ExitCode::from(1),
        Err(report) => {
            if json {
                output::print_json(&output::error_json(&report));
            }
            eprintln!("{report:?}");
            ExitCode::from(2)
        }
    }
}
