//! Published models, those in `tests/models` and those in `proofs/benchmarks`: the rank at almost all states, and of each unknown whether it is seen, as `tests/models/expected.toml` has them. Those
//! answers are held to a program that shares nothing with ours by `benches/peers/models.py`.

use palmistry::System;
use palmistry::observability::{Frame, Observability};
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::path::Path;

#[derive(serde::Deserialize)]
struct Expected {
    rank: usize,
    dimension: usize,
    not_seen: BTreeSet<String>,
}

#[test]
fn published_models_have_their_answers() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(root.join("tests/models/expected.toml")).unwrap();
    let expected: BTreeMap<String, Expected> = toml::from_str(&text).unwrap();
    assert!(expected.len() > 70);
    let mut open = Vec::new();
    for (name, expected) in &expected {
        // those that are proved besides lie there, and none lies at both places
        let places = ["tests/models", "proofs/benchmarks"];
        let paths = places.map(|folder| root.join(folder).join(name).with_extension("proof"));
        let path: Vec<_> = paths.iter().filter(|path| path.exists()).collect();
        assert_eq!(path.len(), 1, "{name}");
        let mut system = System::read(path[0]).unwrap();
        let answer = Frame::new(&mut system, &HashMap::new()).unwrap().generic;
        assert_eq!(answer.dimension, expected.dimension, "{name}");
        assert!(answer.at_least <= expected.rank && expected.rank <= answer.at_most, "{name}: {answer:?}");
        if answer.rank().is_none() {
            open.push(name.as_str());
            continue;
        }
        assert!(answer.log2_error < -100.0, "{name}: {answer:?}");
        let unobservable = answer.unknowns.iter().filter(|(_, seen)| *seen == Observability::No);
        let unobservable: BTreeSet<String> =
            unobservable.map(|(symbol, _)| system.symbol_name(*symbol).to_owned()).collect();
        assert_eq!(unobservable, expected.not_seen, "{name}");
        assert!(answer.unknowns.iter().all(|(_, seen)| *seen != Observability::Undecided), "{name}");
    }
    // where functions are met that may satisfy relations, series alone bound the rank from above
    println!("left to true states: {open:?}");
    assert!(open.len() * 10 <= expected.len(), "{open:?}");
}
