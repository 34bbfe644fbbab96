//! How large the page of a thesis is: what its claims and its files take of it.

use palmistry::claim::decide_all;
use palmistry::paper::{FileFindings, Findings, Paper};
use palmistry::report::page;
use std::collections::BTreeMap;
use std::path::Path;

const THESIS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/proofs/moll2002");

fn claims_alone() -> Findings {
    let paper = Paper::read(Path::new(THESIS)).unwrap();
    let file = |system| FileFindings {
        outcomes: decide_all(&system, 1, &false.into(), &|_| ()),
        system,
        ranks: Vec::new(),
        maps: Vec::new(),
        lines: Vec::new(),
        printed: Vec::new(),
        reductions: Vec::new(),
        derivatives: None,
        trade: None,
        stress: None,
        certificate: None,
        left_out: Vec::new(),
    };
    let files = paper.systems().unwrap().into_iter().map(file).collect();
    Findings { paper, files, experiments: Vec::new(), seed: 1, interrupted: false, seconds: 0.0 }
}

/// The parts of a page by the names of their sections, in bytes.
fn sections(page: &str) -> BTreeMap<&str, usize> {
    let named = |part: &'static str| part;
    let _ = named;
    page.split("<section id=\"").skip(1).map(|part| (part.split('"').next().unwrap(), part.len())).collect()
}

#[test]
fn the_claims_of_a_thesis_are_small() {
    let found = claims_alone();
    let page = page(&found);
    if let Some(file) = std::env::var_os("PALMISTRY_KEEP_PAGE") {
        std::fs::write(file, &page).unwrap();
    }
    let sizes = sections(&page);
    let (claims, count) = (sizes["claims"], found.outcomes().count());
    assert!(count > 780, "{count}");
    assert!(claims + sizes["sources"] < 650_000, "{sizes:?}");
}
