//! The program as a user runs it.

#![allow(dead_code)] // each test file takes what it needs

use serde_json::Value;
use std::path::PathBuf;
use std::process::{Command, Output};

/// Runs the program in the project's folder.
pub fn palmistry(arguments: &[&str]) -> Output {
    with_threads(arguments, None)
}

/// The same with a fixed number of threads.
pub fn with_threads(arguments: &[&str], threads: Option<&str>) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_palmistry"));
    command.args(arguments).current_dir(env!("CARGO_MANIFEST_DIR"));
    if let Some(threads) = threads {
        command.env("RAYON_NUM_THREADS", threads);
    }
    command.output().expect("the program runs")
}

/// The words that it printed, with one blank between them: where a line is broken says nothing.
pub fn words_of(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).split_whitespace().collect::<Vec<_>>().join(" ")
}

/// What it printed, as JSON.
pub fn json(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).unwrap_or_else(|error| {
        panic!(
            "{error}\n{}\n{}",
            String::from_utf8_lossy(&output.stdout),
            String::from_utf8_lossy(&output.stderr)
        )
    })
}

/// A folder of its own that goes away with the test.
pub fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

/// Writes a file into a folder.
pub fn write(folder: &tempfile::TempDir, name: &str, text: impl AsRef<[u8]>) -> PathBuf {
    let path = folder.path().join(name);
    std::fs::write(&path, text).expect("a file is written");
    path
}

/// Removes what may differ from run to run: times, and ratios of times.
pub fn without_times(value: &mut Value) {
    palmistry::report::forget_seconds(value);
}
