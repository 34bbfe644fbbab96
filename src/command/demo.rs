//! `palmistry demo`: a first answer to each question, on a system of five lines.

use super::new::{Folder, refuse_taken};
use super::output::{Files, Form, print_text};
use super::{Status, Unusable, interrupt};
use clap::Args;
use palmistry::foreign::{name_of, shown_path};
use palmistry::system::Code;
use serde_json::json;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// The files of the demonstration.
const FILES: Folder<'_> = &[
    ("paper.toml", include_str!("template/demo/paper.toml")),
    ("spring.proof", include_str!("template/demo/spring.proof")),
    ("spring.toml", include_str!("template/demo/spring.toml")),
];

/// Shows on a system of five lines what the program does: observability, a proof, an estimate from noisy measurements, a page.
///
/// Makes a folder with a proof file and a scene, and runs four commands on them, each shown before its answer: together they take
/// some seconds. The files are yours to change.
#[derive(Args)]
#[command(after_help = "Example:
  palmistry demo                  makes the folder palmistry-demo and answers four questions")]
pub(crate) struct Demo {
    /// The folder to make; it must not be there yet, or be empty.
    #[arg(value_name = "FOLDER", default_value = "palmistry-demo")]
    folder: PathBuf,
    /// Print one JSON object: 'folder', 'files', and 'commands' with the exit status of each.
    #[arg(long)]
    pub json: bool,
}

/// A question, and the command that answers it.
struct Step {
    question: &'static str,
    /// The command, and the file in the folder.
    verb: &'static str,
    file: &'static str,
}

const STEPS: [Step; 4] = [
    Step {
        question: "1. Which states and parameters can be observed or identified from the output?",
        verb: "rank",
        file: "spring.proof",
    },
    Step { question: "2. Do the claims about it hold, for all values?", verb: "prove", file: "spring.proof" },
    Step {
        question: "3. What are they, from ten seconds of noisy measurements, and how sure is that?",
        verb: "observe",
        file: "spring.toml",
    },
    Step { question: "4. All of it on one page, with pictures.", verb: "verify", file: "" },
];

impl Demo {
    pub fn run(self) -> miette::Result<Status> {
        let folder = &self.folder;
        refuse_taken(folder)?;
        super::new::fill(folder, FILES).map_err(|error| {
            Unusable::report(
                Code::Place,
                format!("cannot make {}: {error}", shown_path(folder)),
                "choose another place",
            )
        })?;
        let program = own_path().map_err(|error| {
            Unusable::report(
                Code::System,
                format!("this program does not find itself: {error}"),
                "call it by its whole path",
            )
        })?;
        if !self.json {
            let text = FILES.iter().find(|(name, _)| *name == "spring.proof").map_or("", |(_, text)| *text);
            print_text(&format!("{}:\n\n{}", shown_path(&folder.join("spring.proof")), text.trim_end()))?;
        }
        let mut commands = Vec::new();
        for Step { question, verb, file } in &STEPS {
            let mut arguments = vec![PathBuf::from(verb), folder.join(file)];
            if *verb == "verify" {
                arguments = vec![PathBuf::from(verb), folder.clone(), "--out".into(), folder.join("page")];
            }
            let words: Vec<String> = arguments.iter().map(|argument| shown_path(argument)).collect();
            let line = format!("palmistry {}", words.join(" "));
            if !self.json {
                print_text(&format!("\n{question}\n$ {line}\n"))?;
            }
            let status = self.answer(&program, &arguments)?;
            commands.push(json!({ "command": line, "status": status }));
            if interrupt::interrupted() {
                break;
            }
        }
        let right = commands.iter().all(|command| command["status"] == 0);
        let files: Vec<String> = FILES.iter().map(|(name, _)| name_of(&folder.join(name))).collect();
        let object = json!({ "folder": name_of(folder), "files": files, "commands": commands });
        let words = || {
            format!(
                "\nOpen {} in a browser. Then change {}, and ask again; 'palmistry new mypaper' begins one of your own.",
                shown_path(&folder.join("page").join("index.html")),
                shown_path(&folder.join("spring.proof")),
            )
        };
        Files::default().print(Form::of(self.json), object, words, Status::of(right))
    }

    /// Runs one command; with `--json` what it prints is left out.
    fn answer(&self, program: &Path, arguments: &[PathBuf]) -> miette::Result<Option<i32>> {
        let mut command = Command::new(program);
        // a pipe that is closed at once: an empty root has no null device
        command.args(arguments).stdin(Stdio::piped());
        if self.json {
            command.stdout(Stdio::null()).stderr(Stdio::null());
        }
        let status = command.status().map_err(|error| {
            Unusable::report(Code::System, format!("cannot run {}: {error}", shown_path(program)), "")
        })?;
        Ok(status.code())
    }
}

/// Where this program is: in a root without `/proc`, where it was called by its path.
fn own_path() -> std::io::Result<PathBuf> {
    let called = || {
        let path = PathBuf::from(std::env::args_os().next()?);
        (path.components().count() > 1 && path.is_file()).then_some(path)
    };
    std::env::current_exe().or_else(|error| called().ok_or(error))
}
