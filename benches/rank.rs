//! What the rank costs at one state: the counter gives states a second, on all cores, exact and floating rank together.
//!
//! `cargo bench --bench rank`

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use palmistry::sweep::Certainty;
use palmistry::{RankQuestion, System, answer_rank};
use std::collections::BTreeMap;
use std::path::Path;

fn main() {
    divan::main();
}

const STATES: u64 = 4000;

#[divan::bench(args = ["general", "same_rate", "one_palm_fixed", "fixed_palms"], sample_count = 10)]
fn sweep(bencher: Bencher, regime: &str) {
    let file =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("proofs/moll2002").join(regime).with_extension("proof");
    let system = System::read(&file).expect("the file is read");
    bencher.counter(ItemsCount::new(STATES)).with_inputs(|| system.clone()).bench_local_values(
        |mut system| {
            let question = RankQuestion {
                samples: black_box(STATES),
                seed: 1,
                wanted: Certainty::Certified,
                digits: None,
                order: None,
                fixed: BTreeMap::new(),
                conditions: Vec::new(),
                recorded: 0,
                interrupt: &false.into(),
                progress: &|_| (),
            };
            answer_rank(&mut system, &question)
        },
    );
}
