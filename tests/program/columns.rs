//! What `rank` and `observe` print for people fits a terminal of 80 columns.

use crate::common::palmistry;

/// Of a formula or a name without a blank nothing is broken off: it is to be copied.
fn could_be_broken(line: &str) -> bool {
    line.trim().contains(' ')
}

fn is_narrow(arguments: &[&str]) {
    let output = palmistry(arguments);
    let text = String::from_utf8(output.stdout).unwrap();
    // 1 and 3 are answers, too: a test that fails, a search that was cut off
    assert!(matches!(output.status.code(), Some(0 | 1 | 3)) && !text.is_empty(), "{arguments:?}: {text}");
    for line in text.lines().filter(|line| line.chars().count() > 80) {
        assert!(!could_be_broken(line), "{arguments:?}: {} columns: {line}", line.chars().count());
    }
}

#[test]
fn rank_has_eighty_columns() {
    let sliding = "proofs/moll2002/constraint/friction_sliding.proof";
    is_narrow(&["rank", sliding, "--samples", "3"]);
    is_narrow(&["rank", sliding, "--samples", "3", "--details"]);
    let space = "proofs/moll2002/space/ranks.proof";
    is_narrow(&["rank", space]);
    is_narrow(&["rank", space, "--samples", "3", "--details"]);
    for file in [
        "proofs/moll2002/general.proof",
        "proofs/benchmarks/chemostat.proof",
        "proofs/benchmarks/bruno2016.proof",
        "proofs/hermann1977/cubic.proof",
        "tests/models/mammillary3.proof",
    ] {
        is_narrow(&["rank", file]);
        is_narrow(&["rank", file, "--samples", "20", "--details"]);
        is_narrow(&["rank", file, "--functions", "--work", "100000000"]);
    }
    for file in ["proofs/benchmarks/mammillary4.proof", "proofs/martinelli2005/two_beacons.proof"] {
        is_narrow(&["rank", file, "--singular-set"]);
        is_narrow(&["rank", file, "--global", "--samples", "20", "--digits", "10"]);
        is_narrow(&["rank", file, "--accessible", "--samples", "20"]);
    }
}

#[test]
fn observe_has_eighty_columns() {
    for scene in ["section_4_6", "library", "touchpad_switch", "robot", "slow_touchpad"] {
        is_narrow(&["observe", &format!("proofs/moll2002/scenes/{scene}.toml")]);
    }
}
