//! Models of other programs: an imported file says what the foreign file says. Held to that by three routes: the foreign syntax tree
//! evaluated in doubles (which shares nothing with the writer), formulas copied by hand from the papers (which share nothing with the
//! readers), and random expressions written in each language by a printer of this test (which shares nothing with either).

mod dialects;
mod fixtures;
mod refused;
mod round_trip;

use palmistry::import::{ImportQuestion, ImportedModel, import};
use std::path::Path;

/// A fixture of `tests/imports`, read.
fn imported(name: &str, question: &ImportQuestion) -> ImportedModel {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/imports").join(name);
    let text = std::fs::read_to_string(&path).expect("a fixture");
    import(name, &text, question).unwrap_or_else(|why| panic!("{:?}", miette::Report::new(why)))
}

/// A text, read.
fn of_text(name: &str, text: &str) -> ImportedModel {
    import(name, text, &ImportQuestion::default())
        .unwrap_or_else(|why| panic!("{:?}\n{text}", miette::Report::new(why)))
}

/// Numbers that look random, the same on every machine.
struct Draws(u64);

impl Draws {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        self.0 >> 33
    }

    fn below(&mut self, bound: u64) -> u64 {
        self.next() % bound
    }
}
