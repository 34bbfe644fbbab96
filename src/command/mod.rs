//! The command line. A file a verb: it reads its arguments, calls the library, and prints.
//!
//! Results go to standard output (as JSON with `--json`), progress and words to standard error. The exit status is 0
//! when all is as expected, 1 when something is not, 2 when the input could not be used or the results could not be
//! written, and 3 when the work was cut off by a signal and nothing that was found until then is wrong.

mod advise;
mod advise_space;
mod advise_system;
mod arguments;
mod certify;
mod check;
mod claims;
mod completions;
mod coq;
mod demo;
mod derived;
mod eval;
mod explain;
mod fmt;
mod given_files;
mod import;
mod interrupt;
mod lab;
mod lsp;
mod man;
mod new;
mod observe;
mod observe_choice;
mod observe_joint;
mod observe_modes;
mod observe_slow;
mod observe_space;
mod observe_stream;
mod observe_studies;
mod output;
mod overwritten;
mod plan;
mod poses;
mod prove;
mod rank;
mod recheck;
mod reduce;
mod reparametrise;
mod shards;
mod slow_text;
mod stage;
mod stress;
mod terminal;
mod threads;
mod trade;
mod usage;
mod verify;
mod version;
mod watch;
mod what_to_do;

use clap::{CommandFactory, Parser, Subcommand};
use given_files::{Given, Kind, Written};
use miette::{Diagnostic, Report};
use output::Form;
use palmistry::file;
use palmistry::system::{Code, GivenError};
use std::fmt::Display;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Verifies mathematics about nonlinear control systems: observability, identifiability, Lie derivatives, published equations.
///
/// Write down a control system and what you claim of it in a .proof file (the book has the grammar); palmistry says,
/// claim by claim, proved, refuted (with a witness) or undecided.
#[derive(Parser)]
#[command(name = "palmistry", version, disable_version_flag = true, max_term_width = 110)]
#[command(
    after_help = "Exit status: 0 all as expected, 1 something is not, 2 input that cannot be used or output that cannot be written, 3 incomplete: cut off by a signal, or left undecided.",
    after_long_help = "Where to begin:
  palmistry demo                            four questions and their answers on a system of five lines
  palmistry lab                             write a system in the browser, and see its answers beside it
  palmistry new mypaper                     a folder with a small paper whose claims are all proved, with comments
  palmistry check mysystem.proof            is it a proof file? every mistake, each at its place
  palmistry prove mysystem.proof --watch    decide its claims, and again whenever it is changed
  palmistry rank mysystem.proof             which states and parameters are observable or identifiable?
  palmistry eval mysystem.proof 'L(f, x)' --at x=1/3 --digits 40
  palmistry verify mypaper                  check a folder of proof files; writes a page with pictures

Exit status: 0 all as expected, 1 something is not, 2 input that cannot be used or output that cannot be written, 3 incomplete: cut off by a signal, or left undecided."
)]
struct Cli {
    #[command(subcommand)]
    verb: Option<Verb>,
    /// Print the version; with --verbose what it was built from and what it uses here.
    #[arg(short = 'V', long)]
    version: bool,
    /// With --version: commit, compiler, features, number types, processor.
    #[arg(long, requires = "version")]
    verbose: bool,
}

#[derive(Subcommand)]
enum Verb {
    Verify(verify::Verify),
    Prove(prove::Prove),
    Check(check::Check),
    Rank(rank::Rank),
    Reduce(reduce::Reduce),
    Recheck(recheck::Recheck),
    Certify(certify::Certify),
    Trade(trade::Trade),
    Stress(stress::Stress),
    Eval(eval::Eval),
    Observe(observe::Observe),
    Advise(advise::Advise),
    Plan(plan::Plan),
    Poses(poses::Poses),
    Import(import::Import),
    Lab(lab::Lab),
    New(new::New),
    Demo(demo::Demo),
    Explain(explain::Explain),
    Fmt(fmt::Fmt),
    Lsp(lsp::Lsp),
    Completions(completions::Completions),
    Man(man::Man),
}

/// What a command has come to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Status {
    AsExpected,
    NotAsExpected,
    /// A signal has ended the work early; what was found until then is as expected, and is not all.
    CutOff,
    /// A file could not be used; what is wrong with it is printed.
    Unusable,
    /// The results are printed, but a file that was asked for could not be written.
    Unwritten,
}

impl Status {
    /// What a run has come to in which what was found is as expected or not. A signal takes nothing back that is wrong, and
    /// makes nothing whole that is right.
    pub fn of(as_expected: bool) -> Status {
        match (as_expected, interrupt::interrupted()) {
            (false, _) => Status::NotAsExpected,
            (true, true) => Status::CutOff,
            (true, false) => Status::AsExpected,
        }
    }
}

/// Input that could not be used, or a machine that refuses.
#[derive(Debug, thiserror::Error)]
#[error("{message}")]
pub(crate) struct Unusable {
    pub code: Code,
    pub message: String,
    /// What to do; may be empty.
    pub help: String,
}

/// The help names the code, whose page has an example.
impl Diagnostic for Unusable {
    fn help<'a>(&'a self) -> Option<Box<dyn Display + 'a>> {
        let more = self.code.reference();
        Some(Box::new(match self.help.as_str() {
            "" => more,
            help => format!("{help}\n{more}"),
        }))
    }
}

impl Unusable {
    pub fn report(code: Code, message: impl Into<String>, help: impl Into<String>) -> Report {
        let (message, mut help) = (message.into(), help.into());
        if help.is_empty() {
            help.push_str(what_to_do::about(&message));
        }
        Report::new(Unusable { code, message, help })
    }

    /// A value, a range or a name in an option that is none.
    pub fn given(why: GivenError) -> Report {
        Unusable::report(Code::Option, why.message, why.help.unwrap_or_default())
    }
}

/// Runs the program with the arguments it was started with.
pub fn run() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => return not_understood(&error),
    };
    if cli.version {
        return asked_for(&version::text(cli.verbose));
    }
    let Some(verb) = cli.verb else {
        // who says nothing asks what there is to say
        let help = Cli::command().render_long_help().to_string();
        return asked_for(help.trim_end_matches('\n'));
    };
    interrupt::stop_on_interrupt();
    let form = verb.form();
    if verb.is_a_stream() {
        output::print_in_lines();
    }
    let result = given_files::refuse(&verb)
        .and_then(|()| overwritten::refuse(&verb))
        .and_then(|()| threads::prepare())
        .and_then(|()| verb.run());
    match result {
        Ok(Status::AsExpected) => ExitCode::SUCCESS,
        Ok(Status::NotAsExpected) => ExitCode::from(1),
        Ok(Status::CutOff) => ExitCode::from(3),
        Ok(Status::Unusable | Status::Unwritten) => ExitCode::from(2),
        Err(report) => {
            if form == Form::Json {
                // where this cannot be written either, the words below are all that can be done
                let _ = output::print_json(&output::error_json(&report));
            }
            file::note(&format!("{report:?}"));
            ExitCode::from(2)
        }
    }
}

impl Verb {
    fn form(&self) -> Form {
        Form::of(match self {
            Verb::Verify(verb) => verb.json,
            Verb::Prove(verb) => verb.claims.json,
            Verb::Check(verb) => verb.json,
            Verb::Rank(verb) => verb.json,
            Verb::Reduce(verb) => verb.json,
            Verb::Recheck(verb) => verb.json,
            Verb::Certify(verb) => verb.json,
            Verb::Trade(verb) => verb.json,
            Verb::Stress(verb) => verb.json,
            Verb::Eval(verb) => verb.json,
            Verb::Observe(verb) => verb.json,
            Verb::Advise(verb) => verb.json,
            Verb::Plan(verb) => verb.json,
            Verb::Poses(verb) => verb.json,
            Verb::Import(verb) => verb.json,
            Verb::Lab(verb) => verb.json,
            Verb::New(verb) => verb.json,
            Verb::Demo(verb) => verb.json,
            Verb::Explain(verb) => verb.json,
            Verb::Fmt(verb) => verb.json,
            Verb::Lsp(_) | Verb::Completions(_) | Verb::Man(_) => false,
        })
    }

    /// The command, as it is called.
    fn name(&self) -> &'static str {
        match self {
            Verb::Verify(_) => "verify",
            Verb::Prove(_) => "prove",
            Verb::Check(_) => "check",
            Verb::Rank(_) => "rank",
            Verb::Reduce(_) => "reduce",
            Verb::Recheck(_) => "recheck",
            Verb::Certify(_) => "certify",
            Verb::Trade(_) => "trade",
            Verb::Stress(_) => "stress",
            Verb::Eval(_) => "eval",
            Verb::Observe(_) => "observe",
            Verb::Advise(_) => "advise",
            Verb::Plan(_) => "plan",
            Verb::Poses(_) => "poses",
            Verb::Import(_) => "import",
            Verb::Lab(_) => "lab",
            Verb::New(_) => "new",
            Verb::Demo(_) => "demo",
            Verb::Explain(_) => "explain",
            Verb::Fmt(_) => "fmt",
            Verb::Lsp(_) => "lsp",
            Verb::Completions(_) => "completions",
            Verb::Man(_) => "man",
        }
    }

    /// The files that it is given.
    fn given(&self) -> Vec<Given<'_>> {
        let one = |path, wanted| vec![Given::one(path, wanted)];
        match self {
            Verb::Verify(verb) => verb.path.iter().map(|path| Given::or_folder(path)).collect(),
            Verb::Prove(verb) => verb.claims.paths.iter().map(|path| Given::or_folder(path)).collect(),
            // one that is not there costs the others nothing
            Verb::Check(verb) => {
                verb.paths.iter().filter(|path| path.exists()).map(|path| Given::or_folder(path)).collect()
            }
            Verb::Fmt(verb) => verb.paths.iter().map(|path| Given::or_folder(path)).collect(),
            Verb::Rank(verb) => one(&verb.file, Kind::Proof),
            Verb::Reduce(verb) => one(&verb.file, Kind::Proof),
            Verb::Certify(verb) => one(&verb.file, Kind::Proof),
            Verb::Trade(verb) => one(&verb.file, Kind::Proof),
            Verb::Stress(verb) => verb.file.iter().map(|file| Given::one(file, Kind::Proof)).collect(),
            Verb::Eval(verb) => one(&verb.file, Kind::Proof),
            Verb::Recheck(verb) => one(&verb.file, Kind::Json),
            Verb::Observe(verb) => scene_with_data(&verb.scene, verb.data.as_deref()),
            Verb::Plan(verb) => scene_with_data(&verb.scene, verb.data.as_deref()),
            // without --identify it takes scenes, and says itself what a proof file needs
            Verb::Advise(verb) if verb.identify.is_empty() => Vec::new(),
            Verb::Advise(verb) => one(&verb.file, Kind::Proof),
            Verb::Poses(verb) => verb.scene.iter().map(|scene| Given::one(scene, Kind::Scene)).collect(),
            Verb::Import(verb) => one(&verb.file, Kind::Model),
            _ => Vec::new(),
        }
    }

    /// What it is to write and cannot, whatever it finds.
    fn written(&self) -> Vec<Written<'_>> {
        let tables: Vec<(&'static str, &Option<PathBuf>)> = match self {
            Verb::Observe(verb) => vec![
                ("--record", &verb.record),
                ("--motion", &verb.motion),
                ("--outline", &verb.outline),
                ("--track", &verb.track),
            ],
            Verb::Rank(verb) => vec![("--table", &verb.table)],
            _ => Vec::new(),
        };
        let folders: Vec<(&'static str, Option<&PathBuf>)> = match self {
            Verb::Verify(verb) => vec![("--out", Some(&verb.out))],
            Verb::Prove(verb) => vec![("--coq", verb.coq.as_ref())],
            Verb::Observe(verb) => vec![("--out", verb.out.as_ref())],
            Verb::Rank(verb) => vec![("--out", verb.out.as_ref())],
            Verb::Certify(verb) => vec![("--out", verb.out.as_ref())],
            Verb::Trade(verb) => vec![("--out", verb.out.as_ref())],
            Verb::Stress(verb) => vec![("--out", verb.out.as_ref())],
            Verb::Poses(verb) => vec![("--out", verb.out.as_ref())],
            Verb::Man(verb) => vec![("--out", verb.out.as_ref())],
            _ => Vec::new(),
        };
        let tables =
            tables.into_iter().filter_map(|(option, path)| Some(Written::Table(option, path.as_deref()?)));
        let folders = folders.into_iter().filter_map(|(option, path)| Some(Written::Folder(option, path?)));
        tables.chain(folders).collect()
    }

    /// Whether the command line asks for a stream of answers.
    fn is_a_stream(&self) -> bool {
        match self {
            Verb::Prove(verb) => verb.watch,
            Verb::Observe(verb) => verb.reads_a_stream(),
            _ => false,
        }
    }

    /// Does what is asked for, on a thread of its own: see [`interrupt`].
    fn run(self) -> miette::Result<Status> {
        let form = self.form();
        let nothing = move || interrupt::nothing_found(form);
        match self {
            Verb::Verify(verb) => verb.run(),
            Verb::Prove(verb) => verb.run(),
            Verb::Check(verb) => interrupt::watched(move || verb.run(), nothing),
            Verb::Rank(verb) => verb.run(),
            Verb::Reduce(verb) => interrupt::watched(move || verb.run(), nothing),
            Verb::Recheck(verb) => interrupt::watched(move || verb.run(), nothing),
            Verb::Certify(verb) => interrupt::watched(move || verb.run(), nothing),
            Verb::Trade(verb) => interrupt::watched(move || verb.run(), nothing),
            Verb::Stress(verb) => verb.run(),
            Verb::Eval(verb) => interrupt::watched(move || verb.run(), nothing),
            Verb::Observe(verb) => verb.run(),
            Verb::Advise(verb) => interrupt::watched(move || verb.run(), nothing),
            Verb::Plan(verb) => interrupt::watched(move || verb.run(), nothing),
            Verb::Poses(verb) => verb.run(),
            Verb::Import(verb) => interrupt::watched(move || verb.run(), nothing),
            Verb::Lab(verb) => verb.run(),
            Verb::New(verb) => verb.run(),
            Verb::Demo(verb) => verb.run(),
            Verb::Explain(verb) => verb.run(),
            Verb::Fmt(verb) => verb.run(),
            Verb::Lsp(verb) => verb.run(),
            Verb::Completions(verb) => verb.run(),
            Verb::Man(verb) => verb.run(),
        }
    }
}

/// A scene, and a recording in place of its own.
fn scene_with_data<'a>(scene: &'a Path, data: Option<&'a Path>) -> Vec<Given<'a>> {
    let data = data.map(|data| Given::one(data, Kind::Table));
    std::iter::once(Given::one(scene, Kind::Scene)).chain(data).collect()
}

/// What clap has to say: help and the version, which were asked for, or what is wrong with the command line.
fn not_understood(error: &clap::Error) -> ExitCode {
    let text = usage::mended(error);
    if !error.use_stderr() {
        return asked_for(text.trim_end_matches('\n'));
    }
    // the arguments are not understood, so what they ask for has to be looked for by hand
    let arguments: Vec<_> = std::env::args_os().skip(1).take_while(|argument| argument != "--").collect();
    let said = |word: &str| arguments.iter().any(|argument| argument == word);
    if said("--json") {
        let from_a_stream = arguments.windows(2).any(|pair| pair[0] == "--data" && pair[1] == "-");
        if said("--watch") || said("--data=-") || from_a_stream {
            output::print_in_lines();
        }
        let _ = output::print_json(&output::usage_json(&text));
    }
    file::note(&format!("{}\n{}", text.trim_end_matches('\n'), Code::Option.reference()));
    ExitCode::from(2)
}

/// Prints help or a version, which were asked for.
fn asked_for(text: &str) -> ExitCode {
    match output::print_text(text) {
        Ok(()) => ExitCode::SUCCESS,
        Err(report) => {
            file::note(&format!("{report:?}"));
            ExitCode::from(2)
        }
    }
}
