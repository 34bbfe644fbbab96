//! The README and the book: every fenced block is run, and its output is what the page shows.
//!
//! What stands behind a fence: `palmistry` (a proof file, proved as it expects; `file=NAME` writes it beside the commands of the
//! page, `after=NAME` puts it behind the file that was shown under that name, `refused` says that it is an error,
//! `fails=ID,...` that these claims are not as expected), `console` (lines
//! that begin with `$ ` are run, what is shown below them is their output), `toml file=NAME`, `csv file=NAME` and those of other
//! languages (files for the commands), `json` (read). `not run: REASON` says why nothing is run. `PALMISTRY_BOOK=renew` writes outputs into the pages.

#![cfg(unix)]

#[path = "../common/mod.rs"]
mod common;
#[path = "../common/picture.rs"]
mod picture;

mod blocks;
mod complete;
mod gallery;
mod kept;
mod likeness;
mod numbers;
mod pages;
mod pictures;
mod solutions;
mod sources;
mod values;

use pages::{go_through, pages};

/// How many blocks are not run; each says why.
const NOT_RUN: usize = 26;

#[test]
fn every_block_is_run_and_shows_its_output() {
    let renew = std::env::var("PALMISTRY_BOOK").is_ok_and(|word| word == "renew");
    let (mut wrong, mut not_run, mut run) = (Vec::new(), Vec::new(), 0);
    let all = pages();
    let findings: Vec<_> = std::thread::scope(|scope| {
        let begun: Vec<_> = all
            .iter()
            .map(|path| {
                scope.spawn(|| {
                    let folder = common::folder();
                    go_through(path, folder.path())
                })
            })
            .collect();
        begun.into_iter().map(|page| page.join().expect("a page is gone through")).collect()
    });
    for (path, found) in all.iter().zip(findings) {
        // what has not changed may be written by another test meanwhile
        if renew && found.has_changed {
            std::fs::write(path, &found.renewed).expect("a page is written");
        }
        wrong.extend(found.wrong);
        not_run.extend(found.not_run);
        run += found.run;
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
    assert!(run > 40, "{run} blocks are run");
    // these are run, by tests that have the Python package
    not_run.retain(|line| !line.contains(": python/tests/"));
    assert_eq!(not_run.len(), NOT_RUN, "not run:\n{}", not_run.join("\n"));
}
