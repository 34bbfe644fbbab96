//! What the program does as a process: results that cannot be written, signals, and files that are none.
//!
//! Oracles: the operating system (its devices, links, pipes and signals), and the same run without the trouble.

mod check;
mod cost;
mod inputs;
mod interrupts;
mod no_times;
mod overwritten;
mod prove;
mod rank;
mod shards;
mod shell;
mod values;
mod watch;
mod writes;

use std::io::Read;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

/// A run that takes longer than this hangs; none of these takes a tenth of it.
const HUNG: Duration = Duration::from_secs(240);

/// A small system with something for each command.
const SMALL: &str = "system \"small\"\nstate x, y\ndrift f\n  x' = y\n  y' = -x + x^2\noutput x\nlet rows = [x + 2, y; y, x + 3]\n\
                     sample x in [1/2, 1] y in [1/2, 1]\nclaim 1: L(f, x) = y\nclaim 2: rank = 2\n";

fn program(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_palmistry"));
    command.args(arguments).current_dir(env!("CARGO_MANIFEST_DIR"));
    command
}

/// The program behind a line of the shell, in which it is called `"$0" "$@"`.
fn in_shell(line: &str, arguments: &[&str]) -> Command {
    let mut command = Command::new("bash");
    command.args(["-c", line, env!("CARGO_BIN_EXE_palmistry")]).args(arguments);
    command.current_dir(env!("CARGO_MANIFEST_DIR"));
    command
}

/// Runs to the end; where there is none, the run is ended and the test fails.
fn finish(command: &mut Command) -> Output {
    command.stdin(Stdio::null());
    let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program runs");
    end_of(child)
}

fn end_of(mut child: Child) -> Output {
    let (mut out, mut err) = (child.stdout.take(), child.stderr.take());
    let (done, ended) = channel();
    let id = child.id().to_string();
    let reader = std::thread::spawn(move || {
        let mut stderr = Vec::new();
        let errors = std::thread::spawn(move || {
            err.as_mut().map(|err| err.read_to_end(&mut stderr));
            stderr
        });
        let mut stdout = Vec::new();
        out.as_mut().map(|out| out.read_to_end(&mut stdout));
        let status = child.wait().expect("it was started");
        let _ = done.send(());
        Output { status, stdout, stderr: errors.join().expect("a reader") }
    });
    if ended.recv_timeout(HUNG) == Err(RecvTimeoutError::Timeout) {
        signal("KILL", &id);
        panic!("it hangs");
    }
    reader.join().expect("a reader")
}

fn signal(name: &str, id: &str) {
    let sent = Command::new("kill").args([&format!("-{name}"), id]).status();
    assert!(sent.expect("there is a 'kill'").success(), "signal {name}");
}

/// What went wrong, for messages.
fn words(output: &Output) -> String {
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    format!("status {:?}\n{}\n{}", output.status.code(), text(&output.stdout), text(&output.stderr))
}

/// The names of the files in a folder.
fn files(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let mut names: Vec<String> =
        entries.map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}
