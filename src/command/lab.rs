//! `palmistry lab`: a page on this machine on which one writes a system and sees what can be told of it.

use super::interrupt::{STACK, interrupted};
use super::output::print_json;
use super::{Status, Unusable};
use clap::Args;
use palmistry::file::note;
use palmistry::foreign::shown_path;
use palmistry::lab::{Access, LabError, LabOptions, LabServer, QuestionLimits, answer, open_in_browser};
use palmistry::system::Code;
use serde_json::{Value, json};
use std::ffi::OsString;
use std::io::{Read, Write};
use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::Duration;

/// The port that is tried first, so that links that a colleague sends lead to one's own lab.
const PORT: u16 = 8417;

/// Opens a page in the browser on which you write a system and see its answers beside it.
///
/// Verdicts appear beside the claims as you type, with a table of what is observable and identifiable, unobservable directions, the singular
/// set, maps over any two coordinates, motions from two states with the same outputs, and estimates from a recording that is dropped on the
/// page. The models that come with the program open there, and files of other programs are imported. A link holds the whole text.
///
/// It serves only this machine, without an account and without the network, until it is interrupted. Each question is answered by a
/// process of its own, with a limit of time and memory; a button on the page ends it. Files are read only in FOLDER, and written only
/// when you press 'save'.
#[derive(Args)]
#[command(after_help = "Examples:
  palmistry lab                             an empty page; nothing is written
  palmistry lab mypaper                     with the proof files of a folder
  palmistry lab mysystem.proof              with one of them
  palmistry lab --no-open --port 9000       print the address, and open no browser
  palmistry lab --public 0.0.0.0:8417       for a group: no files, and a limit for each client")]
pub(crate) struct Lab {
    /// The folder whose proof files the page opens and saves; or one of its files, with which it begins.
    #[arg(value_name = "FOLDER-OR-FILE")]
    folder: Option<PathBuf>,
    /// Listen on this port; 0 is any free one [default: 8417, or any free one].
    #[arg(long, value_name = "N")]
    port: Option<u16>,
    /// Open no browser.
    #[arg(long)]
    no_open: bool,
    /// Serve everybody who reaches this address, for example a reading group: without files, and with less time and memory for each question.
    /// It has no password and no encryption; put it behind a server that has both.
    #[arg(long, value_name = "ADDRESS", conflicts_with_all = ["folder", "port"])]
    public: Option<SocketAddr>,
    /// Print one JSON object, on a line, with the 'url'; it is there once the lab listens.
    #[arg(long)]
    pub json: bool,
    /// Answer one question from standard input.
    #[arg(long, hide = true, requires = "work")]
    answer: bool,
    #[command(flatten)]
    of_one: OfOne,
    /// Do this command in the place of this process, and end with whoever has started it.
    #[arg(long, hide = true, num_args = 1.., allow_hyphen_values = true, value_name = "COMMAND")]
    then: Vec<OsString>,
}

/// What one question may take.
#[derive(Args)]
struct OfOne {
    /// Memory, in bytes.
    #[arg(long, hide = true, value_name = "BYTES")]
    memory: Option<u64>,
    /// Processor time.
    #[arg(long, hide = true, value_name = "S")]
    seconds: Option<u64>,
    /// A folder in which it may write.
    #[arg(long, hide = true, value_name = "DIR")]
    work: Option<PathBuf>,
    /// The folder in which it may read.
    #[arg(long, hide = true, value_name = "DIR")]
    within: Option<PathBuf>,
}

impl Lab {
    pub fn run(self) -> miette::Result<Status> {
        if !self.then.is_empty() {
            return self.become_another();
        }
        if let (true, Some(work)) = (self.answer, &self.of_one.work) {
            return self.of_one.answer(work);
        }
        let server = self.server()?;
        let Lab { no_open, json, public, .. } = self;
        let (server, access) = server;
        let address = server.address();
        let url = access.address(address);
        if json {
            super::output::print_in_lines();
            print_json(&json!({ "url": url, "address": address.to_string() }))?;
        } else {
            super::output::print_text(&url)?;
            note("the lab listens there; interrupt it (Ctrl-C) to end it");
        }
        if !no_open
            && public.is_none()
            && let Err(why) = open_in_browser(&access.address_once(address))
        {
            note(&format!("no browser could be opened ({why}): open the address above yourself"));
        }
        server.run(&interrupted);
        Ok(Status::AsExpected)
    }

    /// Becomes another command of the program, which ends where its parent does.
    fn become_another(&self) -> miette::Result<Status> {
        self.of_one.limit();
        let program = std::env::current_exe();
        let failed =
            |why| Unusable::report(Code::System, format!("the program cannot be started: {why}"), "");
        let mut command = std::process::Command::new(program.map_err(failed)?);
        command.args(&self.then);
        #[cfg(unix)]
        return Err(failed(std::os::unix::process::CommandExt::exec(&mut command)));
        #[cfg(not(unix))]
        match command.status().map_err(failed)?.code() {
            Some(code) => std::process::exit(code),
            None => Ok(Status::CutOff),
        }
    }

    fn server(&self) -> miette::Result<(LabServer, Access)> {
        let program = std::env::current_exe().map_err(|why| {
            Unusable::report(
                Code::System,
                format!("the program does not find itself: {why}"),
                "start it by its full path",
            )
        })?;
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        let here = |port| SocketAddr::new(IpAddr::V4(Ipv4Addr::LOCALHOST), port);
        let (access, limits) = match self.public {
            None => {
                let [cheap, dear] = [10, 1800].map(Duration::from_secs);
                (
                    Access::with_token(),
                    QuestionLimits {
                        cheap,
                        dear,
                        memory: 8 << 30,
                        question: 32 << 20,
                        places: [64; 2],
                        connections: [256; 2],
                        at_once: [cores.max(4); 2],
                    },
                )
            }
            Some(_) => {
                let [cheap, dear] = [10, 30].map(Duration::from_secs);
                (
                    Access::Public,
                    QuestionLimits {
                        cheap,
                        dear,
                        memory: 2 << 30,
                        question: 1 << 20,
                        places: [512, 128],
                        connections: [1024, 256],
                        at_once: [cores, 2.min(cores)],
                    },
                )
            }
        };
        let options = |address| LabOptions {
            address,
            access: access.clone(),
            folder: self.folder.clone(),
            limits,
            program: (program.clone(), vec!["lab".to_owned(), "--answer".to_owned()]),
        };
        let server = match (self.public, self.port) {
            (Some(address), _) => LabServer::new(options(address)),
            (None, Some(port)) => LabServer::new(options(here(port))),
            (None, None) => match LabServer::new(options(here(PORT))) {
                // another lab has it
                Err(LabError::Address(..)) => LabServer::new(options(here(0))),
                other => other,
            },
        };
        server.map(|server| (server, access.clone())).map_err(|why| match why {
            LabError::Address(address, why) => Unusable::report(
                Code::System,
                format!("cannot listen on {address}: {why}"),
                "choose another port, or 0 for any free one",
            ),
            LabError::Folder(folder, why) => {
                Unusable::report(Code::File, format!("cannot read {}: {why}", shown_path(&folder)), "")
            }
            LabError::Threads(why) => Unusable::report(
                Code::System,
                format!("the system gives no thread to work on: {why}"),
                "end other programs first",
            ),
        })
    }
}

impl OfOne {
    /// Answers one question: a line for each thing that is found.
    fn answer(&self, work: &Path) -> miette::Result<Status> {
        self.limit();
        let mut question = String::new();
        std::io::stdin().read_to_string(&mut question).map_err(|why| {
            Unusable::report(
                Code::System,
                format!("cannot read the question: {why}"),
                "it comes from 'palmistry lab'",
            )
        })?;
        let out = Mutex::new(std::io::stdout());
        let tell = |line: Value| {
            if let Ok(mut out) = out.lock()
                && writeln!(out, "{line}").and_then(|()| out.flush()).is_err()
            {
                // nobody reads any more
                std::process::exit(1);
            }
        };
        let (work, within) = (work.to_owned(), self.within.clone());
        std::thread::scope(|scope| {
            let answered = std::thread::Builder::new()
                .stack_size(STACK)
                .spawn_scoped(scope, || answer(&question, within.as_deref(), &work, &tell));
            answered.map(|thread| thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
        })
        .map_err(|why| {
            Unusable::report(Code::System, format!("the system gives no thread to work on: {why}"), "")
        })?;
        Ok(Status::AsExpected)
    }

    /// Takes no more than this from now on, nor does what is started from here.
    fn limit(&self) {
        #[cfg(unix)]
        palmistry::lab::limit_this_process(self.memory, self.seconds);
    }
}
