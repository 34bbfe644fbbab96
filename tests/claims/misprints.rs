//! Misprints other than signs: an exponent one more or one less, a factor dropped, one name for another. How many of them
//! does the check of dimensions find alone, without any arithmetic? It is asked of all, and of all signs, of which it can
//! find none; a sample is decided as well. What dimensions find is no theorem, so that a misprint that they find and that
//! is proved all the same would be a fault of the check, or a term that is zero.

use palmistry::expression::syntax::{Expr, ExprKind};
use palmistry::system::{ClaimBody, ClaimSyntax, Expectation, Statement, Value};
use palmistry::{System, decide};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use serde_json::json;
use std::collections::BTreeMap;
use std::path::Path;

/// What is wrong in a misprint.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Misprint {
    Sign,
    ExponentMore,
    ExponentLess,
    FactorDropped,
    OtherName,
}

impl Misprint {
    const ALL: [Misprint; 5] = [
        Misprint::Sign,
        Misprint::ExponentMore,
        Misprint::ExponentLess,
        Misprint::FactorDropped,
        Misprint::OtherName,
    ];

    fn words(self) -> &'static str {
        match self {
            Misprint::Sign => "a sign turned round",
            Misprint::ExponentMore => "an exponent one more",
            Misprint::ExponentLess => "an exponent one less",
            Misprint::FactorDropped => "a factor dropped",
            Misprint::OtherName => "one name for another",
        }
    }
}

/// Puts one misprint in, the one of a number, counted through the expression; whether there is one of that number. `other`
/// gives another name for one.
fn misprint(
    kind: Misprint,
    expr: &mut Expr,
    number: &mut usize,
    other: &mut dyn FnMut(&str) -> Option<String>,
) -> bool {
    let here = |number: &mut usize| {
        let is_it = *number == 0;
        *number = number.wrapping_sub(1);
        is_it
    };
    match &mut expr.kind {
        ExprKind::Number(_) | ExprKind::Indexed(_) => false,
        ExprKind::Name(name) => {
            if kind != Misprint::OtherName {
                return false;
            }
            let Some(new) = other(name) else { return false };
            if here(number) {
                *name = new;
                return true;
            }
            false
        }
        ExprKind::Sum(terms) => {
            for (negative, term) in terms {
                if kind == Misprint::Sign && here(number) {
                    *negative = !*negative;
                    return true;
                }
                if misprint(kind, term, number, other) {
                    return true;
                }
            }
            false
        }
        ExprKind::Product(factors) => {
            if kind == Misprint::FactorDropped {
                for place in 0..factors.len() {
                    // what is divided by may go, and the first factor where another one is left above the line
                    let may_go = place > 0 || factors.get(1).is_some_and(|(divides, _)| !divides);
                    if may_go && here(number) {
                        factors.remove(place);
                        return true;
                    }
                }
            }
            factors.iter_mut().any(|(_, factor)| misprint(kind, factor, number, other))
        }
        ExprKind::Power(base, exponent) => {
            let change = match kind {
                Misprint::ExponentMore => 1,
                Misprint::ExponentLess => -1,
                _ => 0,
            };
            if change != 0 && here(number) {
                *exponent += change;
                return true;
            }
            misprint(kind, base, number, other)
        }
        ExprKind::RealPower(base, exponent) => {
            misprint(kind, base, number, other) || misprint(kind, exponent, number, other)
        }
        ExprKind::Call(name, arguments) => {
            // fields and the states of a differential are no formulas
            let formulas = match (name.as_str(), arguments.len()) {
                ("L", count) => count - 1..count,
                ("d", _) => 0..1,
                ("bracket", _) => 0..0,
                (_, count) => 0..count,
            };
            arguments[formulas].iter_mut().any(|argument| misprint(kind, argument, number, other))
        }
        ExprKind::Matrix(rows) => rows.iter_mut().flatten().any(|entry| misprint(kind, entry, number, other)),
        // the point at which something is taken is a condition, and not what is claimed
        ExprKind::At(inner, _) => misprint(kind, inner, number, other),
    }
}

/// The statement that has to be proved, as a claim of its own.
fn proper(claim: &ClaimSyntax) -> Option<ClaimSyntax> {
    let statement = match &claim.body {
        ClaimBody::Claim { statement, expected: Expectation::Proved } => statement,
        ClaimBody::Scan { repaired: statement, .. } | ClaimBody::Erratum { corrected: statement, .. } => {
            statement
        }
        _ => return None,
    };
    let body = ClaimBody::Claim { statement: statement.clone(), expected: Expectation::Proved };
    Some(ClaimSyntax { body, ..claim.clone() })
}

fn statement(claim: &ClaimSyntax) -> &Statement {
    match &claim.body {
        ClaimBody::Claim { statement, .. } => statement,
        _ => unreachable!("made by 'proper'"),
    }
}

/// Names by the shape of what they stand for.
type Names = BTreeMap<(usize, usize), Vec<String>>;

/// The names of a file: symbols and definitions, in order.
fn names_by_shape(system: &System) -> Names {
    let mut found = Names::new();
    for (symbol, _) in system.symbols() {
        found.entry((0, 0)).or_default().push(system.symbol_name(symbol).to_owned());
    }
    let names = system.source.split(|c: char| !c.is_alphanumeric() && c != '_' && c != '.');
    let mut names: Vec<&str> = names.collect();
    names.sort_unstable();
    names.dedup();
    for name in names {
        if let Some(shape) = shape(system, name).filter(|_| system.definition(name).is_some()) {
            found.entry(shape).or_default().push(name.to_owned());
        }
    }
    found
}

fn shape(system: &System, name: &str) -> Option<(usize, usize)> {
    match system.definition(name) {
        Some(Value::Scalar(_)) => Some((0, 0)),
        Some(Value::Matrix(matrix)) => Some((matrix.rows, matrix.columns)),
        Some(_) => None,
        None => system.find_symbol(name).map(|_| (0, 0)),
    }
}

/// All misprints of a kind in a claim; each name is replaced by one that is drawn from those of its shape.
fn misprints(system: &System, names: &Names, claim: &ClaimSyntax, kind: Misprint) -> Vec<ClaimSyntax> {
    let mut found = Vec::new();
    for place in 0.. {
        let mut rng = ChaCha8Rng::seed_from_u64(place as u64);
        let mut other = |name: &str| {
            let all = names.get(&shape(system, name)?)?;
            let begin = rng.random_range(0..all.len());
            all.iter().cycle().skip(begin).take(all.len()).find(|other| *other != name).cloned()
        };
        let mut mutant = claim.clone();
        let ClaimBody::Claim { statement, .. } = &mut mutant.body else { return found };
        let mut number = place;
        let is_one = misprint(kind, &mut statement.equation.left, &mut number, &mut other)
            || misprint(kind, &mut statement.equation.right, &mut number, &mut other);
        if !is_one {
            return found;
        }
        found.push(mutant);
    }
    found
}

fn systems() -> Vec<System> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("proofs/moll2002");
    let mut files: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.retain(|path| path.extension().is_some_and(|e| e == "proof"));
    files.sort();
    files.iter().map(|file| System::read(file).unwrap()).collect()
}

/// So many misprints of each kind are decided, half of them among those that dimensions find.
const DECIDED: usize = 60;

#[derive(Default)]
struct Count {
    all: usize,
    found: usize,
    found_and: BTreeMap<&'static str, usize>,
    not_found_and: BTreeMap<&'static str, usize>,
}

#[test]
fn what_dimensions_find_alone() {
    let systems: Vec<System> = systems().into_iter().filter(System::declares_dimensions).collect();
    assert!(systems.len() >= 24, "{} files", systems.len());
    let mut table = Vec::new();
    let mut proved = Vec::new();
    for kind in Misprint::ALL {
        let mutants: Vec<(&System, ClaimSyntax)> = systems
            .par_iter()
            .flat_map_iter(|system| {
                let names = names_by_shape(system);
                let claims: Vec<ClaimSyntax> = system.claims.iter().filter_map(proper).collect();
                let all = claims.iter().flat_map(|claim| misprints(system, &names, claim, kind));
                all.map(|one| (system, one)).collect::<Vec<_>>()
            })
            .collect();
        let is_found: Vec<bool> = mutants
            .par_iter()
            .map(|(system, mutant)| !system.dimension_mistakes(statement(mutant)).is_empty())
            .collect();
        let mut count = Count { all: mutants.len(), ..Count::default() };
        count.found = is_found.iter().filter(|found| **found).count();
        let mut sample = Vec::new();
        for wanted in [true, false] {
            let places: Vec<usize> = (0..mutants.len()).filter(|place| is_found[*place] == wanted).collect();
            let mut rng = ChaCha8Rng::seed_from_u64(12);
            let draw = |_| places.get(rng.random_range(0..places.len().max(1))).copied();
            sample.extend((0..DECIDED / 2).filter_map(draw));
        }
        let words: Vec<&'static str> = sample
            .par_iter()
            .map(|place| decide(mutants[*place].0, &mutants[*place].1, 1).verdict.word())
            .collect();
        for (place, word) in sample.iter().zip(words) {
            let counts = if is_found[*place] { &mut count.found_and } else { &mut count.not_found_and };
            *counts.entry(word).or_insert(0) += 1;
            if is_found[*place] && word == "proved" {
                let (system, mutant) = &mutants[*place];
                let file = Path::new(&system.name).file_name().unwrap().to_string_lossy().into_owned();
                let mistake = &system.dimension_mistakes(statement(mutant))[0].message;
                proved.push(format!("{file} {}, {}: {mistake}", mutant.id, kind.words()));
            }
        }
        table.push((kind, count));
    }
    let signs = &table[0].1;
    assert!(signs.all > 1000 && signs.found == 0, "{} signs, {} found", signs.all, signs.found);
    for (kind, count) in &table[1..] {
        assert!(count.all > 100, "{kind:?}: {}", count.all);
    }
    let others = table[1..].iter().map(|(_, count)| count.all).sum::<usize>();
    let found = table[1..].iter().map(|(_, count)| count.found).sum::<usize>();
    let row = |(kind, count): &(Misprint, Count)| {
        json!({
            "misprint": kind.words(),
            "all": count.all,
            "found_by_dimensions": count.found,
            "of_a_sample_found": count.found_and,
            "of_a_sample_not_found": count.not_found_and,
        })
    };
    let reason = "A misprint that dimensions find and that is proved stands in a term that is zero, or changes one side \
                  of two that vanish.";
    insta::with_settings!({ description => reason }, {
        insta::assert_json_snapshot!("misprints", json!({
            "kinds": table.iter().map(row).collect::<Vec<_>>(),
            "all_but_signs": others,
            "found_by_dimensions": found,
            "found_and_proved": proved,
        }));
    });
}

/// Every claim as it stands has no mistake: what is counted above comes from the misprint.
#[test]
fn claims_as_they_stand_have_none() {
    let mut count = 0;
    for system in &systems() {
        for claim in system.claims.iter().filter_map(proper) {
            let found = system.dimension_mistakes(statement(&claim));
            assert!(found.is_empty(), "{} {}: {}", system.name, claim.id, found[0].message);
            count += 1;
        }
    }
    assert!(count > 700, "{count}");
}

/// By hand: what the forms of errata in print have wrong in their dimensions is a part of what is wrong with them. 5.7 adds
/// a length to a velocity, 4.80 says nothing of dimensions that is wrong.
#[test]
fn errata_that_dimensions_find() {
    let mut found = Vec::new();
    for system in &systems() {
        for claim in &system.claims {
            if let ClaimBody::Erratum { printed, .. } = &claim.body
                && !system.dimension_mistakes(printed).is_empty()
            {
                found.push(claim.id.clone());
            }
        }
    }
    found.sort();
    insta::assert_json_snapshot!("errata_by_dimensions", found);
}
