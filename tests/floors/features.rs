//! What a build of the library alone leaves out: the crates of the command line, of pages and pictures, and of Parquet files.

use std::collections::BTreeSet;
use std::process::Command;

/// The crates that the library is built with, those that others ask for too.
fn built_with(features: &[&str]) -> BTreeSet<String> {
    let output = Command::new(env!("CARGO"))
        .args([
            "tree",
            "--package",
            "palmistry",
            "--locked",
            "--offline",
            "--edges",
            "normal",
            "--prefix",
            "none",
            "--format",
            "{p}",
        ])
        .args(features)
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .expect("cargo runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).expect("names of crates are text");
    text.lines().filter_map(|line| line.split(' ').next()).map(str::to_owned).collect()
}

const COMMAND_LINE: [&str; 5] = ["clap", "clap_complete", "indicatif", "owo-colors", "terminal_size"];
const REPORT: [&str; 5] = ["anstyle", "maud", "plotters", "quick-junit", "textwrap"];
const PARQUET: [&str; 2] = ["bytes", "parquet"];

/// Which of the lists above are in a build, each whole or not at all.
fn kinds(features: &[&str]) -> [bool; 3] {
    let crates = built_with(features);
    [&COMMAND_LINE[..], &REPORT, &PARQUET].map(|list| {
        let found = list.iter().filter(|name| crates.contains(**name)).count();
        assert!(found == 0 || found == list.len(), "{features:?}: some of {list:?} are in {crates:?}");
        found > 0
    })
}

#[test]
fn the_library_alone_leaves_out_what_only_commands_need() {
    assert_eq!(kinds(&["--no-default-features"]), [false, false, false]);
    assert_eq!(kinds(&["--no-default-features", "--features", "report"]), [false, true, false]);
    assert_eq!(kinds(&["--no-default-features", "--features", "parquet"]), [false, false, true]);
    assert_eq!(kinds(&[]), [true, true, true]);
    let stop = if cfg!(unix) { "signal-hook" } else { "ctrlc" };
    assert!(!built_with(&["--no-default-features"]).contains(stop) && built_with(&[]).contains(stop));
}
