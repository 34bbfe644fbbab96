//! How large the page of a thesis is: what its claims and its files take of it.

use palmistry::claim::decide_all;
use palmistry::paper::{FileFindings, Findings, Paper};
use palmistry::report::page;
use std::collections::BTreeMap;
use std::path::Path;

const THESIS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/proofs/moll2002");

fn claims_alone() -> Findings {
    let paper = Paper::read(Path::new(THESIS)).unwrap();
    let file = |system| {
        let outcomes = decide_all(&system, 1, &false.into(), &|_| ());
        FileFindings { outcomes, ..FileFindings::begun(system) }
    };
    let files = paper.systems().unwrap().into_iter().map(file).collect();
    Findings { paper, files, ..Findings::begun(1) }
}

/// The parts of a page by the names of their sections, in bytes.
fn sections(page: &str) -> BTreeMap<&str, usize> {
    page.split("<section id=").skip(1).map(|part| (part.split('>').next().unwrap(), part.len())).collect()
}

#[test]
fn the_claims_of_a_thesis_are_small() {
    let found = claims_alone();
    let page = page(&found);
    if let Some(file) = std::env::var_os("PALMISTRY_KEEP_PAGE") {
        std::fs::write(file, &page).unwrap();
    }
    let sizes = sections(&page);
    let count = found.outcomes().count();
    assert!(count > 780, "{count}");
    // a claim with its formula takes less than 800 bytes, and the lines of a file a sixth more than their text
    let text: usize = found.files.iter().map(|file| file.system.source.len()).sum();
    println!("{count} claims, {text} bytes of files: {sizes:?}");
    assert!(sizes["claims"] < 800 * count, "{count} claims: {sizes:?}");
    assert!(sizes["sources"] < text + text / 6, "{text} bytes: {sizes:?}");
}
