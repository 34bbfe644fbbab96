//! Verdicts that are changed in one place, and verdicts that are filed under another claim: none that turned false is confirmed.
//!
//! What is true is known without either checker: of a claim by the files in `mutants/`, which say what is expected of each and
//! were written by hand; of a rank at a state and of a box by the formula of these systems, whose rows are spanned by (y, x) and
//! (x, y). The mutants are written into `target/mutated_verdicts`, where the second checker's tests find them.

use crate::common::palmistry;
use dashu::rational::RBig;
use palmistry::System;
use palmistry::checker::{Checking, Effort, Evidence, ProofSources, VerdictFile};
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

const FILES: [&str; 3] = ["full", "short", "given"];
/// Of long lists so many places are changed.
const PLACES: usize = 8;

/// What is so of each claim, by file and id: the word of a true verdict.
type Truth = BTreeMap<(String, String), &'static str>;

fn path(name: &str) -> String {
    format!("tests/claims/mutants/{name}.proof")
}

/// By what the files expect, which was written by hand.
fn truth() -> Truth {
    let mut found = Truth::new();
    for name in FILES {
        let text = std::fs::read_to_string(path(name)).expect("the file is there");
        for line in text.lines().filter_map(|line| line.strip_prefix("claim ")) {
            let head = line.split(':').next().unwrap_or_default();
            let id = head.split(' ').next().unwrap_or_default().to_owned();
            let word = if head.contains("expect refuted") { "refuted" } else { "proved" };
            found.insert((path(name), id), word);
        }
    }
    found.insert((path("full"), "sign as printed".to_owned()), "refuted");
    found.insert((path("full"), "sign corrected".to_owned()), "proved");
    found
}

/// What the program finds: claims, ranks at states, boxes.
fn honest(folder: &Path) -> Vec<Value> {
    let file = folder.join("found.json");
    let name = file.to_str().expect("a name");
    let mut records = Vec::new();
    let mut run = |arguments: &[&str]| {
        let output = palmistry(&[arguments, &["--verdicts", name]].concat());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stdout));
        let text = std::fs::read_to_string(&file).expect("it is written");
        let found: Value = serde_json::from_str(&text).expect("it is JSON");
        records.extend(found["verdicts"].as_array().expect("a list").clone());
    };
    for of in FILES {
        run(&["prove", &path(of), "-q"]);
    }
    for of in &FILES[..2] {
        run(&["rank", &path(of), "--samples", "10", "--verdict-states", "3"]);
    }
    run(&["certify", &path("full"), "--boxes", "60", "--verdict-boxes", "4"]);
    run(&["certify", &path("full"), "--boxes", "60", "--verdict-boxes", "2", "--rows", "own"]);
    records
}

fn number(value: &Value) -> Option<RBig> {
    let text = value.as_str()?;
    let (top, bottom) = text.split_once('/').unwrap_or((text, "1"));
    let (top, bottom): (i128, i128) = (top.parse().ok()?, bottom.parse().ok()?);
    (bottom > 0).then(|| RBig::from(top) / RBig::from(bottom))
}

/// The rank at a state, by hand: the determinant of (y, x) and (x, y) is y^2 - x^2.
fn rank_at(state: &Value) -> Option<u64> {
    let at = |name: &str| number(&state[name]["number"]);
    let (x, y) = (at("x")?, at("y")?);
    let zero = RBig::ZERO;
    Some(if &x * &x != &y * &y { 2 } else { u64::from(x != zero || y != zero) })
}

/// Whether boxes are what a certificate says: within the sample, apart, and away from x = y and x = -y.
fn boxes_are_so(boxes: &Value) -> Option<bool> {
    let ranges = boxes["ranges"].as_array()?;
    let names: Vec<&str> = ranges.iter().filter_map(|range| range["symbol"].as_str()).collect();
    if !names.starts_with(&["x", "y"]) {
        return Some(false);
    }
    let ends = |range: &Value| Some((number(&range["low"])?, number(&range["high"])?));
    let whole: Vec<(RBig, RBig)> = ranges.iter().take(2).map(ends).collect::<Option<_>>()?;
    let mut seen: Vec<Vec<(RBig, RBig)>> = Vec::new();
    let mut volume = RBig::ZERO;
    for one in boxes["boxes"].as_array()? {
        let sides: Vec<(RBig, RBig)> = one["sides"]
            .as_array()?
            .iter()
            .map(|side| Some((number(&side[0])?, number(&side[1])?)))
            .collect::<Option<_>>()?;
        let [(xl, xh), (yl, yh)] = sides.as_slice() else { return Some(false) };
        let inside = sides.iter().zip(&whole).all(|((l, h), (least, most))| least <= l && l < h && h <= most);
        let (minus, plus) = ((yl - xh, yh - xl), (yl + xl, yh + xh));
        let away = |(l, h): &(RBig, RBig)| *l > RBig::ZERO || *h < RBig::ZERO;
        let apart = seen.iter().all(|other| {
            sides.iter().zip(other).any(|((l, h), (other_l, other_h))| h <= other_l || other_h <= l)
        });
        if !inside || !away(&minus) || !away(&plus) || !apart {
            return Some(false);
        }
        let part = sides.iter().zip(&whole).map(|((l, h), (least, most))| (h - l) / (most - least));
        volume += part.fold(RBig::ONE, |product, side| product * side);
        seen.push(sides);
    }
    Some(!seen.is_empty() && number(&boxes["volume"]) == Some(volume))
}

/// Whether a record may be confirmed, and half confirmed, by what is true.
fn allowed(record: &Value, honest: &[Value], truth: &Truth) -> (bool, bool) {
    // spaces say nothing
    let spoken = |part: &Value| match part.as_str() {
        Some(text) => json!(text.split_whitespace().collect::<String>()),
        None => part.clone(),
    };
    let key = |of: &Value| {
        let statement = spoken(&of["statement"]);
        (["file", "id", "asked", "digest"].map(|name| of[name].clone()), statement)
    };
    // it speaks of a claim of a file, in that file's words
    if !honest.iter().any(|other| key(other) == key(record)) {
        return (false, false);
    }
    if record["verdict"] != "found" {
        let id = (text(&record["file"]), text(&record["id"]));
        let is_so = truth.get(&id).is_some_and(|word| record["verdict"] == *word);
        return (is_so, is_so);
    }
    let evidence = &record["evidence"];
    if let Some(states) = evidence["rank"]["states"].as_array() {
        let ranks: Option<Vec<(u64, u64)>> =
            states.iter().map(|state| Some((state["rank"].as_u64()?, rank_at(&state["state"])?))).collect();
        let Some(ranks) = ranks.filter(|ranks| !ranks.is_empty()) else { return (false, false) };
        let is_so = ranks.iter().all(|(said, is)| said == is);
        return (is_so, is_so);
    }
    let is_so = boxes_are_so(&evidence["boxes"]).unwrap_or(false);
    (is_so, is_so)
}

fn text(value: &Value) -> String {
    value.as_str().unwrap_or_default().to_owned()
}

/// All places of a value, each as a pointer; of long lists some.
fn places(value: &Value, at: &str, found: &mut Vec<String>) {
    found.push(at.to_owned());
    match value {
        Value::Array(list) => {
            let step = list.len().div_ceil(PLACES).max(1);
            for place in (0..list.len()).step_by(step) {
                places(&list[place], &format!("{at}/{place}"), found);
            }
        }
        Value::Object(object) => {
            for (name, inner) in object {
                places(inner, &format!("{at}/{}", name.replace('~', "~0").replace('/', "~1")), found);
            }
        }
        _ => {}
    }
}

/// What may stand at a place instead.
fn others(value: &Value) -> Vec<Value> {
    let mut found = vec![Value::Null];
    match value {
        Value::String(text) => {
            found.extend([
                json!(""),
                json!(format!("{text} ")),
                json!(format!("{text}0")),
                json!("1"),
                json!("y"),
            ]);
            if let Some(positive) = text.strip_prefix('-') {
                found.push(json!(positive));
            } else {
                found.push(json!(format!("-{text}")));
            }
            for (word, other) in
                [("proved", "refuted"), ("generic", "everywhere"), ("always", "generic"), ("=", "!=")]
            {
                if text == word {
                    found.push(json!(other));
                } else if text == other {
                    found.push(json!(word));
                }
            }
        }
        Value::Number(number) => {
            if let Some(number) = number.as_i64() {
                found.extend([json!(number + 1), json!(number - 1), json!(0), json!(1_000_000)]);
            }
        }
        Value::Bool(is_so) => found.push(json!(!is_so)),
        Value::Array(list) => {
            found.push(json!([]));
            found.extend((0..list.len()).take(PLACES).map(|place| without(list, place)));
            found.push(list.iter().rev().cloned().collect());
            if let Some(last) = list.last() {
                found.push(list.iter().chain([last]).cloned().collect());
            }
        }
        Value::Object(object) => {
            found.push(json!({}));
            for name in object.keys() {
                let mut less = object.clone();
                less.remove(name);
                found.push(Value::Object(less));
            }
        }
        Value::Null => {}
    }
    found
}

fn without(list: &[Value], place: usize) -> Value {
    let kept = list.iter().enumerate().filter(|(at, _)| *at != place);
    kept.map(|(_, value)| value.clone()).collect()
}

/// A mutant, and by what it was made.
struct Mutant {
    kind: String,
    record: Value,
}

fn kind_of(record: &Value) -> String {
    record["evidence"].as_object().and_then(|object| object.keys().next().cloned()).unwrap_or_default()
}

/// One place of a record changed.
fn changed(record: &Value, mutants: &mut Vec<Mutant>) {
    let mut all = Vec::new();
    places(record, "", &mut all);
    for place in all.iter().filter(|place| !place.is_empty()) {
        let part = record.pointer(place).expect("the place is there");
        for other in others(part).into_iter().filter(|other| other != part) {
            let mut record = record.clone();
            *record.pointer_mut(place).expect("the place is there") = other;
            let field = place
                .split('/')
                .find(|name| !["", "evidence"].contains(name) && !name.starts_with(char::is_numeric));
            let what = if place.starts_with("/evidence/") {
                "a part of its evidence"
            } else {
                field.unwrap_or_default()
            };
            let kind = format!("{}: {what} changed", kind_of(&record));
            mutants.push(Mutant { kind, record });
        }
    }
}

/// What binds a record to its claim, put before other evidence.
fn refiled(evidence: &Value, claim: &Value, verdict: &str) -> Value {
    let mut record = claim.clone();
    record["verdict"] = json!(verdict);
    record["evidence"] = evidence["evidence"].clone();
    record
}

/// Fits what the evidence says of its claim to the claim that it is filed under, as a careful hand would.
fn fitted(record: &mut Value) {
    let (word, claimed) = (record["verdict"].clone(), text(&record["asked"]["claimed"]).parse::<u64>());
    if let Some(rank) = record["evidence"].get_mut("claimed_rank") {
        rank["word"] = word.clone();
        if let Ok(claimed) = claimed {
            rank["claimed"] = json!(claimed);
        }
    }
}

/// The evidence of a rank with so many of its rows: what a lower rank would look like.
fn fewer_rows(record: &Value, kept: usize) -> Option<Value> {
    let mut record = record.clone();
    let rank = match kind_of(&record).as_str() {
        "rank" => &mut record["evidence"]["rank"],
        "claimed_rank" => &mut record["evidence"]["claimed_rank"]["matrix"],
        _ => return None,
    };
    let width = rank["columns"].as_array()?.len();
    for name in ["rows", "row_names"] {
        let list = rank[name].as_array_mut()?;
        list.truncate(kept);
    }
    for state in rank["states"].as_array_mut()? {
        let at = |name: &str| number(&state["state"][name]["number"]).unwrap_or(RBig::ONE);
        let (x, y) = (at("x"), at("y"));
        state["rank"] = json!(kept);
        let places: Vec<usize> = (0..kept).collect();
        state["minor"] = json!({"rows": places, "columns": places});
        // what (y, x, 0) annihilates, or everything
        let unit =
            |place: usize| (0..width).map(|at| json!(u8::from(at == place).to_string())).collect::<Value>();
        let mut kernel: Vec<Value> = (kept.min(1) * 2..width).map(unit).collect();
        if kept == 1 && width >= 2 {
            let mut vector = vec![json!((-&x).to_string()), json!(y.to_string())];
            vector.resize(width, json!("0"));
            kernel.push(json!(vector));
        }
        state["kernel"] = json!(kernel);
    }
    Some(record)
}

fn mutants(honest: &[Value]) -> Vec<Mutant> {
    let mut found = Vec::new();
    for record in honest {
        changed(record, &mut found);
        for kept in 0..3 {
            found.extend(
                fewer_rows(record, kept)
                    .map(|record| Mutant { kind: format!("{}: rows left out", kind_of(&record)), record }),
            );
        }
        for claim in honest {
            for verdict in ["proved", "refuted", "found"] {
                if claim["file"] != record["file"] && verdict == "found" {
                    continue;
                }
                let mut other = refiled(record, claim, verdict);
                if other == *record {
                    continue;
                }
                let kind = format!("{}: filed under another claim or verdict", kind_of(record));
                found.push(Mutant { kind: kind.clone(), record: other.clone() });
                fitted(&mut other);
                for kept in [1, 2] {
                    found
                        .extend(fewer_rows(&other, kept).map(|record| Mutant { kind: kind.clone(), record }));
                }
                found.push(Mutant { kind, record: other });
            }
        }
    }
    let mut known = BTreeSet::new();
    found.retain(|mutant| known.insert(mutant.record.to_string()));
    // of the many that are alike every fourth
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    found.retain(|mutant| {
        let count = counts.entry(mutant.kind.clone()).or_default();
        *count += 1;
        *count < 100 || (*count).is_multiple_of(4)
    });
    found.iter_mut().for_each(|mutant| sealed(&mut mutant.record));
    found
}

/// Certificates with the digest that fits.
fn sealed(record: &mut Value) {
    let file =
        json!({"schema": "palmistry-verdicts", "version": 4, "tool": "", "seed": 1, "verdicts": [record]});
    if let Ok(file) = VerdictFile::read(&file.to_string())
        && let Evidence::Boxes(boxes) = &file.verdicts[0].evidence
    {
        record["evidence"]["boxes"]["digest"] = json!(boxes.digest_of_the_rest());
    }
}

#[test]
fn no_verdict_that_turned_false_is_confirmed() {
    let folder = Path::new("target/mutated_verdicts");
    std::fs::create_dir_all(folder).expect("a folder");
    let (honest, truth) = (honest(folder), truth());
    let systems = FILES.map(|name| System::read(Path::new(&path(name))).expect("a system"));
    let sources = ProofSources::given(systems);
    let never = false.into();
    let word = |record: &Value| {
        let file = json!({"schema": "palmistry-verdicts", "version": 4, "tool": "", "seed": 1, "verdicts": [record]});
        let Ok(file) = VerdictFile::read(&file.to_string()) else { return "not read" };
        let effort = Effort::new(1 << 24);
        file.check(Checking { sources: &sources, seed: 1, effort: &effort, interrupt: &never }, &|| ())[0]
            .finding
            .word()
    };
    // what is so is not doubted, and each kind of evidence is among it
    let mut kinds = BTreeMap::new();
    for record in &honest {
        let found = word(record);
        assert_ne!(found, "NOT CONFIRMED", "{record}");
        *kinds.entry(format!("{}, {found}", kind_of(record))).or_insert(0) += 1;
    }
    for kind in [
        "refuted, confirmed",
        "proved, consistent",
        "proved, confirmed",
        "claimed_rank, confirmed",
        "claimed_rank, consistent",
        "rank, confirmed",
        "rank, half confirmed",
        "rank, consistent",
        "boxes, confirmed",
    ] {
        assert!(kinds.contains_key(kind), "{kind}: {kinds:#?}");
    }
    // by kind: mutants, those that are false, and those that are confirmed or half confirmed
    let mut table: BTreeMap<String, [usize; 3]> = BTreeMap::new();
    let (mut written, mut wrong) = (Vec::new(), Vec::new());
    for Mutant { kind, record } in mutants(&honest) {
        let (whole, half) = allowed(&record, &honest, &truth);
        let found = word(&record);
        let is_wrong = found == "confirmed" && !whole || found == "half confirmed" && !half;
        if is_wrong {
            wrong.push(format!("{kind}: {found}\n{record}"));
        }
        let counts = table.entry(kind.clone()).or_default();
        counts[0] += 1;
        counts[1] += usize::from(!whole);
        counts[2] += usize::from(found.ends_with("confirmed") && found != "NOT CONFIRMED");
        written.push(json!({"kind": kind, "whole": whole, "half": half, "record": record}));
    }
    for (kind, [all, turned, confirmed]) in &table {
        println!("| {kind} | {all} | {turned} | {confirmed} |");
    }
    std::fs::write(folder.join("mutants.json"), Value::Array(written).to_string()).expect("it is written");
    let sum = |place: usize| table.values().map(|counts| counts[place]).sum::<usize>();
    println!("| together | {} | {} | {} |", sum(0), sum(1), sum(2));
    assert!(
        wrong.is_empty(),
        "{} are wrong, such as\n{}",
        wrong.len(),
        wrong[..wrong.len().min(20)].join("\n")
    );
    assert!(sum(1) >= 2000 && sum(2) >= 100, "{table:#?}");
}
