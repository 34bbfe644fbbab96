//! What a proof costs: all claims of a file (the counter gives claims a second), and one identity by its size.
//!
//! `cargo bench --bench claims`

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use palmistry::{System, decide_all};
use std::path::{Path, PathBuf};

fn main() {
    divan::main();
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("proofs/moll2002")
}

fn files() -> Vec<String> {
    let mut files: Vec<String> = std::fs::read_dir(folder())
        .expect("the folder is there")
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .filter(|name| name.ends_with(".proof"))
        .collect();
    files.sort();
    files
}

#[divan::bench(args = files(), sample_count = 10)]
fn all_claims_of(bencher: Bencher, file: &str) {
    let system = System::read(&folder().join(file)).expect("the file is read");
    bencher
        .counter(ItemsCount::new(system.claims.len()))
        .bench_local(|| decide_all(black_box(&system), 1, &false.into(), &|_| ()));
}

/// `(x1 + ... + xn)^2` against its expansion, about n^2/2 terms.
#[divan::bench(args = [4, 8, 16, 32, 64], sample_count = 10)]
fn identity_of_terms(bencher: Bencher, n: usize) {
    let names: Vec<String> = (0..n).map(|i| format!("x{i}")).collect();
    let mut terms: Vec<String> = names.iter().map(|x| format!("{x}^2")).collect();
    for i in 0..n {
        terms.extend((0..i).map(|j| format!("2*{}*{}", names[i], names[j])));
    }
    let text = format!(
        "system \"square\" param {} claim 1: ({})^2 = {}",
        names.join(", "),
        names.join(" + "),
        terms.join(" + ")
    );
    let system = System::parse("square.proof", &text, Path::new("")).expect("the text is read");
    bencher
        .counter(ItemsCount::new(terms.len()))
        .bench_local(|| decide_all(black_box(&system), 1, &false.into(), &|_| ()));
}
