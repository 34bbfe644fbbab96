//! The extremes: what is known of toy systems, and what must hold for every system.

use crate::common::{folder, json, palmistry, with_threads, write};
use palmistry::System;
use palmistry::paper::Paper;
use palmistry::report::stress_pictures;
use palmistry::tradeoff::LandscapeRows;
use palmistry::tradeoff::stress::{Line, LineLimit, Mark, Stress, StressOptions, StressStudy, Way};
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::Path;
use std::sync::atomic::AtomicBool;

/// Two rows that become one where x vanishes; what a matrix loses there no scaling brings back.
const EQUAL_ROWS: &str = r#"
system "Two rows that become one"
state x, y
drift f
  x' = 1
  others' = 0
output y
sample
  x in [0.5, 1]
  y in [0.5, 1]
  avoid x
let rows = [1, 1; 1, 1 + x]
"#;

/// A divisor that is a difference of two coordinates, and a high power.
const DIVISOR: &str = r#"
system "A divisor and a power"
state x, y
drift f
  x' = 1
  others' = 0
output y
sample
  x in [0.5, 1]
  y in [2, 3]
let rows = [1/(x - y), x^4; 1, 2]
"#;

fn study(text: &str, interrupt: bool) -> StressStudy {
    let mut system = System::parse("toy.proof", text, Path::new("")).unwrap();
    let options = StressOptions {
        seed: 3,
        states: 3,
        step: 1,
        samples: 20,
        samples_on_sets: 3,
        interrupt: &AtomicBool::new(interrupt),
        progress: &|| (),
    };
    Stress::of_file(&mut system, LandscapeRows::Own, &options).unwrap().run(&options)
}

fn line<'a>(study: &'a StressStudy, title: &str) -> &'a Line {
    study.lines.iter().find(|line| line.title.contains(title)).unwrap_or_else(|| panic!("{:?}", study.lines))
}

fn wrong(line: &Line, way: Way) -> Option<f64> {
    line.ways[way.place()].wrong.as_ref().map(|first| first.distance)
}

/// With rows of length one the matrix has the determinant x/2 and the largest singular value sqrt 2, so that the smallest
/// one, x/(2 sqrt 2), falls below 2 * 2^-52 * sqrt 2 at x = 2^-49; in single precision below 2 * 2^-23 * sqrt 2 at 2^-20.
#[test]
fn the_distance_of_the_first_wrong_rank_is_known() {
    let study = study(EQUAL_ROWS, false);
    let line = line(&study, "x to zero");
    assert_eq!((line.ranks.clone(), line.certified), (BTreeSet::from([2]), true));
    assert_eq!(line.end, LineLimit::Ranks { ranks: BTreeSet::from([1]), certified: true });
    // a comparison of two numbers that are equal but for rounding may go either way
    let near = |found: Option<f64>, power: i32| {
        let expected = 2f64.powi(power);
        found.is_some_and(|distance| distance == expected || distance == expected / 2.0)
    };
    for way in [Way::Customary, Way::Double, Way::Radii] {
        assert!(near(wrong(line, way), -49), "{way:?} {:?}", wrong(line, way));
    }
    assert!(near(wrong(line, Way::Single), -20), "{:?}", wrong(line, Way::Single));
    assert_eq!(wrong(line, Way::DoubleDouble), None);
    // 1 + x is a double as long as x is at least 2^-52, and intervals know which sums are exact
    let intervals = &line.ways[Way::Interval.place()];
    assert!(intervals.marks.iter().all(|mark| *mark == Some(Mark::Right)), "{intervals:?}");
}

/// y is drawn on a grid of 2^-16 below 4: single precision cannot hold y + 2^-k from k = 24 on, and then divides by zero.
#[test]
fn a_division_by_zero_is_named() {
    let study = study(DIVISOR, false);
    let line = line(&study, "divisor x - y");
    assert!(matches!(&line.end, LineLimit::Pole(why) if why.contains("x - y = 0")), "{:?}", line.end);
    let single = line.ways[Way::Single.place()].refused.clone().unwrap();
    assert_eq!(single.said, "division by zero: x - y = 0");
    assert!((2f64.powi(-25)..=2f64.powi(-22)).contains(&single.distance), "{single:?}");
    // a double holds all of these states
    assert_eq!(line.ways[Way::Double.place()].refused, None);
}

/// The fourth power of 1e80 has no double, and neither has that of 1e-90; single precision ends at 1e10.
#[test]
fn an_overflow_is_named() {
    let study = study(DIVISOR, false);
    let scaling = study.scalings.iter().find(|scaling| scaling.quantity == "x").unwrap();
    for (way, highest) in [(Way::Single, 0), (Way::Double, 70), (Way::DoubleDouble, 70)] {
        let found = &scaling.ways[way.place()];
        // before it overflows, a double may have mixed up the sizes; then it says so
        let above = found.above.clone().unwrap();
        let overflows = found.marks.last().unwrap();
        assert_eq!(*overflows, Some(Mark::Refused), "{way:?}");
        assert!(found.right.unwrap().1 <= highest, "{way:?} {found:?}");
        assert!(above.contains("x^4") || above.contains("instead of 2"), "{above}");
    }
}

#[test]
fn what_was_stopped_says_so() {
    let study = study(EQUAL_ROWS, true);
    assert!(study.interrupted && study.lines.is_empty() && study.scalings.is_empty());
}

fn studies(arguments: &[&str]) -> Value {
    let output = palmistry(&[&["stress", "--json"], arguments].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    json(&output)
}

/// All four regimes: intervals never report a wrong rank, nothing is refused without a name, every true rank is
/// certified, and neither the errors that intervals know nor their pivots let a verdict depend on units.
#[test]
fn what_holds_for_the_thesis() {
    let found = studies(&["--states", "1", "--samples", "20"]);
    let studies = found["studies"].as_array().unwrap();
    assert_eq!(studies.len(), 4);
    let mut singular = 0;
    for study in studies {
        let file = &study["file"];
        assert_eq!(study["skipped"], Value::Array(Vec::new()), "{file}");
        for line in study["lines"].as_array().unwrap() {
            let title = &line["title"];
            assert_eq!(line["certified"], true, "{file} {title}");
            assert_eq!(line["distances"].as_array().unwrap().len(), 51);
            assert_eq!(line["distances"][50], 2f64.powi(-50));
            assert_eq!(line["ways"]["intervals"]["first_wrong"], Value::Null, "{file} {title}");
            let on_the_set = |way: &str, what: &str| line["ways"][way]["on_the_set"][what].as_u64().unwrap();
            let asked = |way: &str| {
                ["right", "wrong", "undecided", "refused"]
                    .iter()
                    .map(|what| on_the_set(way, what))
                    .sum::<u64>()
            };
            assert_eq!(on_the_set("escalation", "right"), asked("escalation"), "{file} {title}");
            assert_eq!(on_the_set("intervals", "wrong"), 0, "{file} {title}");
            // who always says "full" is never wrong beside a set of full rank around it, and never right on a lower rank
            let full = study["dimension"].as_u64().unwrap();
            let ranks = line["on_the_set"]["ranks"].as_array();
            if ranks.is_some_and(|ranks| ranks.iter().all(|rank| rank.as_u64().unwrap() < full)) {
                assert_eq!(on_the_set("always full", "right"), 0, "{file} {title}");
                assert!(asked("always full") >= 10, "{file} {title}");
                singular += 1;
            }
            if line["true_ranks"] == serde_json::json!([full]) {
                assert_eq!(line["ways"]["always full"]["first_wrong"], Value::Null, "{file} {title}");
            }
            for way in line["ways"].as_object().unwrap().values().filter(|way| way["first_wrong"].is_object())
            {
                let first = &way["first_wrong"];
                assert!(first["least_distance"].as_f64() <= first["distance"].as_f64(), "{file} {title}");
                assert_eq!(first["states"], 1, "{file} {title}");
            }
            // the ladder climbs until it is certain, however near the set
            let ladder = line["ways"]["escalation"]["marks"].as_array().unwrap();
            assert!(ladder.iter().all(|mark| mark == "right"), "{file} {title}");
            for way in line["ways"].as_object().unwrap().values() {
                let refused = &way["first_refused"];
                assert!(refused.is_null() || refused["said"].as_str().unwrap().len() > 10, "{file} {title}");
            }
        }
        for scaling in study["scalings"].as_array().unwrap() {
            assert_eq!(scaling["ways"]["escalation"]["right"], serde_json::json!([-150, 150]), "{file}");
            for (name, way) in scaling["ways"].as_object().unwrap() {
                let (right, marks) = (&way["right"], way["marks"].as_array().unwrap());
                assert!(right.is_array(), "{file} {} {name}", scaling["quantity"]);
                // where the right range ends, something says why
                assert!(right[0] == -150 || way["below"].is_string(), "{file} {name}");
                assert!(right[1] == 150 || way["above"].is_string(), "{file} {name}");
                assert!(name != "intervals" || marks.iter().all(|mark| mark != "wrong"), "{file}");
            }
        }
        for units in study["units"].as_array().unwrap() {
            for way in ["intervals", "f64 with radii", "escalation"] {
                assert_eq!(units["ways"][way]["changed"], 0, "{file} {} {way}", units["units"]);
                assert_eq!(units["ways"][way]["wrong"], 0, "{file} {} {way}", units["units"]);
            }
        }
    }
    assert!(singular >= 4, "{singular} sets of lower rank");
}

/// The distance to a body on a spring, with a length under a root, in a file that no paper has.
const SPRING: &str = r#"
system "A spring"
state x : length, v : velocity, s : length^(1/2)
param m : mass, k : stiffness, q : charge
drift f
  x' = v
  v' = -k*x/m
  s' = 0
output k*x/m, s^2
sample
  x in [0.5, 1]
  v in [0.5, 1]
  s in [0.5, 1]
  m in [1, 2]
  k in [1, 2]
  avoid x
"#;

/// Changes of units are those of the declared dimensions. By hand: in picometres and kilograms a length is 10^12 times as
/// many, its root 10^6 times; so that the root is rational a file with roots of a length takes the square of that. The charge is
/// in no row, and no rank hangs on it.
#[test]
fn changes_of_units_come_from_the_file() {
    use palmistry::tradeoff::stress::{Rescaling, rows_of, unit_quantities, units};
    let parse = |text: &str| System::parse("spring.proof", text, Path::new("")).unwrap();
    let changes = |text: &str| {
        let mut system = parse(text);
        let rows = rows_of(&mut system, LandscapeRows::Full).unwrap().entries;
        let found = units(&system, &rows)?;
        let quantities = unit_quantities(&system, &rows);
        let named = |factors: &Rescaling| match factors {
            Rescaling::Symbols(list) => list
                .iter()
                .map(|(symbol, factor)| (system.symbol_name(*symbol).to_owned(), factor.to_string()))
                .collect::<Vec<_>>(),
            Rescaling::Column { .. } => panic!("no column"),
        };
        let found: Vec<_> = found.iter().map(|(name, factors)| (name.clone(), named(factors))).collect();
        let quantities: Vec<_> = quantities
            .iter()
            .map(|one| {
                let powers =
                    one.powers.iter().map(|(symbol, power)| (system.symbol_name(*symbol).to_owned(), *power));
                (one.name.clone(), powers.collect::<Vec<_>>())
            })
            .collect();
        Some((found, quantities))
    };
    let owned = |list: &[(&str, &str)]| {
        list.iter().map(|(a, b)| ((*a).to_owned(), (*b).to_owned())).collect::<Vec<_>>()
    };
    let (found, quantities) = changes(SPRING).unwrap();
    let million = "1000000";
    let microseconds = found.iter().find(|(name, _)| name.contains("microsecond")).unwrap();
    assert_eq!(microseconds.0, "metre, kilogram, microsecond");
    assert_eq!(microseconds.1, owned(&[("v", "1/1000000"), ("k", "1/1000000000000")]));
    let small = found.iter().find(|(name, _)| name.contains("milligram")).unwrap();
    assert_eq!(small.0, "10^(-12) of the unit of length, milligram, second");
    assert_eq!(
        small.1,
        owned(&[
            ("x", "1000000000000"),
            ("v", "1000000000000"),
            ("s", million),
            ("m", million),
            ("k", million)
        ])
    );
    assert!(found.iter().all(|(name, _)| !name.contains("ampere")), "{found:?}");
    let powers = |name: &str| {
        let found = quantities.iter().find(|(known, _)| known == name).unwrap();
        found.1.iter().map(|(symbol, power)| (symbol.as_str(), *power)).collect::<Vec<_>>()
    };
    assert_eq!(powers("the unit of mass"), [("m", 1), ("k", 1)]);
    assert_eq!(powers("the unit of length"), [("x", 2), ("v", 2), ("s", 1)]);
    assert_eq!(powers("the unit of time"), [("v", -1), ("k", -2)]);
    assert_eq!(quantities.len(), 3);
    // what the file does not tell is not made up: no dimension, one that is unknown, a number that stands for a length
    for text in [
        SPRING
            .replace(" : length, v : velocity, s : length^(1/2)", ", v, s")
            .replace(" : mass, k : stiffness, q : charge", ", k"),
        SPRING.replace("m : mass, k : stiffness, q : charge", "m, k, q"),
        SPRING.replace("output k*x/m", "let a : length = 2 output k*x/m*(x + a)"),
        SPRING.replace("output k*x/m", "let a = (x + s^2) at {x = 2} output k*x/m"),
    ] {
        assert!(changes(&text).is_none(), "{text}");
    }
    // and a study of any such file looks at its states in these units
    let study = study(SPRING, false);
    let names: Vec<&str> = study.units.iter().map(|row| row.name.as_str()).collect();
    assert_eq!(names[0], "the file's own");
    assert_eq!(names[1..], found.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>());
    for row in &study.units {
        let ladder = &row.ways[Way::Escalation.place()];
        assert_eq!((row.states > 0, ladder.wrong, ladder.changed), (true, 0, 0), "{}", row.name);
    }
    assert!(study.scalings.iter().any(|scaling| scaling.quantity == "the unit of time"));
}

#[test]
fn threads_make_no_difference() {
    let arguments =
        ["stress", "proofs/moll2002/same_rate.proof", "--json", "--states", "2", "--samples", "10"];
    let (one, three) = (with_threads(&arguments, Some("1")), with_threads(&arguments, Some("3")));
    assert!(one.status.success());
    assert_eq!(one.stdout, three.stdout);
}

#[test]
fn pictures_are_written() {
    let folder = folder();
    let file = write(&folder, "toy.proof", EQUAL_ROWS);
    let out = folder.path().join("out");
    let output =
        palmistry(&["stress", file.to_str().unwrap(), "--out", out.to_str().unwrap(), "--samples", "5"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    for name in ["toy-lines.svg", "toy-scaling.svg", "toy-conditioning.svg", "stress.json"] {
        let text = std::fs::read_to_string(out.join(name)).unwrap();
        assert!(!text.contains("could not be drawn") && text.len() > 500, "{name}");
    }
}

#[test]
fn a_file_that_cannot_be_used_is_said_to_be_so() {
    let folder = folder();
    for (text, expected) in [
        ("system \"nothing is seen\"\nstate x\ndrift f\n  x' = 1\n", "no states or no outputs"),
        ("sistem", "line 1"),
    ] {
        let file = write(&folder, "bad.proof", text);
        let output = palmistry(&["stress", file.to_str().unwrap(), "--json"]);
        assert_eq!(output.status.code(), Some(2), "{text}");
        let error = json(&output)["error"].clone();
        let message = error["message"].as_str().unwrap();
        assert!(message.contains(expected) || error["line"] == 1, "{message}");
    }
}

/// Lines go into every set that a file names, and to infinity where a line does; and there are pictures of each.
#[test]
fn every_named_set_has_its_lines() {
    let mut systems = Paper::read(Path::new("proofs/moll2002")).unwrap().systems().unwrap();
    systems.retain(|system| !system.sets.is_empty());
    assert_eq!(systems.len(), 4);
    let options = StressOptions {
        seed: 1,
        states: 1,
        step: 5,
        samples: 40,
        samples_on_sets: 2,
        interrupt: &AtomicBool::new(false),
        progress: &|| (),
    };
    for system in &mut systems {
        let study = Stress::of_file(system, LandscapeRows::Own, &options).unwrap().run(&options);
        for set in &system.sets {
            // two ways to write one set are one line
            let title = |line: &Line| line.title.starts_with(&set.name);
            assert!(study.lines.iter().any(title), "{}: {}", system.name, set.name);
        }
        let infinite = study.lines.iter().filter(|line| line.title.ends_with("infinite")).count();
        assert_eq!(infinite, usize::from(["general.proof", "fixed_palms.proof"].contains(&&*system.name)));
        assert!(study.lines.iter().all(|line| line.distances.len() == 11 && line.certified));
        assert_eq!(stress_pictures(&study).len(), 3);
    }
}

/// Whoever always says "full" wins no table: beside a set it is never wrong, and on the set always.
#[test]
fn saying_full_does_not_win() {
    let found = study(EQUAL_ROWS, false);
    let line = found.lines.iter().find(|line| matches!(&line.end, LineLimit::Ranks { .. })).unwrap();
    let (full, ladder) = (&line.ways[Way::AlwaysFull.place()], &line.ways[Way::Escalation.place()]);
    assert_eq!((&full.wrong, full.on_the_set.right), (&None, 0));
    assert!(full.on_the_set.wrong >= 10);
    assert_eq!((&ladder.wrong, ladder.on_the_set.wrong), (&None, 0));
    assert_eq!(ladder.on_the_set.right, full.on_the_set.wrong);
    // the range over the states: this set is alike everywhere
    let double = line.ways[Way::Double.place()].wrong.as_ref().unwrap();
    assert!(double.least <= double.distance && double.states == line.states, "{double:?}");
    let text = palmistry::report::stress_text(&[found]);
    assert!(text.contains("on the set, right at") && text.contains("always full"), "{text}");
    assert!(text.contains("numpy's rule") && !text.contains("old threshold"), "{text}");
}
