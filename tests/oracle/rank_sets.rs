//! Ranks on sets: on each branch of some conditions states are drawn in exact numbers, and their rank by all words up
//! to a length is known; a set may be one that the fields leave, where a rank rests and grows again.

use super::dice::Dice;
use super::expression::{Expression, Function, Symbol};
use super::findings::{Findings, seed};
use super::library::{Said, Word, rank_where, verdicts};
use super::number::Trouble;
use super::point::{Coordinate, Point};
use super::rank::ranks;
use super::series::value;
use super::system::{Field, Model, Role};
use super::systems::{draw, generic_rank};
use super::witness::Equation;
use Expression as E;
use dashu::rational::RBig;

/// A way to meet the conditions: values for some symbols, in this order, all others being free.
type Branch = Vec<(Symbol, E)>;

const CLASSES: [&str; 7] = [
    "polynomial",
    "of angles",
    "late on a set",
    "polynomial",
    "rational",
    "hidden states",
    "a parameter with a value",
];

struct Set {
    conditions: Vec<Equation>,
    branches: Vec<Branch>,
}

/// What is known of the rank at almost all states of a set.
struct Truth {
    /// For each branch the rank by all words up to [`Truth::longest`] fields.
    at_least: Vec<usize>,
    /// At almost all states around; no state of the set has more.
    around: usize,
    longest: usize,
}

#[test]
fn ranks_on_sets() {
    let found = Findings::of("ranks on sets", 420, one_case);
    found.assert_no_fault("ranks_on_sets");
    if found.is_whole() {
        for class in ["polynomial", "of angles", "late on a set"] {
            let (proved, refuted) = (found.counted(class, "proved"), found.counted(class, "refuted"));
            assert!(
                proved > 10 && refuted > 10,
                "{class}: {proved} proved and {refuted} refuted are next to nothing"
            );
        }
    }
}

fn one_case(case: u64, findings: &mut Findings) {
    let mut dice = Dice::new(seed() ^ 0x5e75, case);
    let class = CLASSES[case as usize % CLASSES.len()];
    let (model, set) = match class {
        "late on a set" => late(&mut dice),
        _ => {
            let model = draw(class, &mut dice);
            let set = set(&model, &mut dice);
            (model, set)
        }
    };
    let Some(truth) = truth(&model, &set, &mut dice) else {
        findings.count(class, "not known to us");
        return;
    };
    let mut orders = vec![set.conditions.clone()];
    if set.conditions.len() > 1 {
        orders.push(set.conditions.iter().rev().cloned().collect());
    }
    sampled(class, &model, &set, &mut dice, findings);
    for rank in 0..=model.states.len() {
        let mut text = model.text();
        for (number, conditions) in orders.iter().enumerate() {
            let all: Vec<String> = conditions.iter().map(Equation::text).collect();
            text.push_str(&format!("claim r{rank}.{number}: rank = {rank} where {}\n", all.join(", ")));
        }
        match verdicts(&text) {
            Err(why) => findings.fault("a rank on a set is not answered", why, &text),
            Ok(said) => {
                for said in &said {
                    judge(class, &model, &truth, rank, said, &text, findings);
                }
                if said.iter().any(|other| other.word != said[0].word) {
                    let words: Vec<_> = said.iter().map(|said| (said.word, &said.why)).collect();
                    findings.fault("the order of conditions changes a rank", format!("{words:?}"), &text);
                }
            }
        }
    }
}

/// A system whose rank rests on a set for some lengths of words, and a set that its field leaves: `x' = 1` and an output
/// that vanishes with a power of `x`.
fn late(dice: &mut Dice) -> (Model, Set) {
    let power = 1 + dice.below(4) as i32;
    let states = vec!["x", "y", "z"][..2 + dice.below(2)].to_vec();
    let other = E::Symbol(states[states.len() - 1]);
    let factor = other.clone().plus(dice.one_of(&[E::integer(0), other.power(2), E::Symbol("x")]));
    let mut rates = vec![E::integer(dice.one_of(&[1, 1, 0, 2]))];
    rates.extend(
        states[1..]
            .iter()
            .map(|_| if dice.once_in(2) { E::integer(0) } else { dice.polynomial(&states, 1, 1) }),
    );
    let mut outputs = vec![E::Symbol("x").power(power).times(factor)];
    if dice.once_in(2) {
        outputs.push(E::Symbol("x"));
    }
    let model =
        Model { fields: vec![Field::new("f", Role::Drift, rates)], outputs, states, ..Model::default() };
    let zero = E::integer(0);
    let set = Set {
        conditions: vec![Equation::new(E::Symbol("x"), zero.clone())],
        branches: vec![vec![("x", zero)]],
    };
    (model, set)
}

fn set(model: &Model, dice: &mut Dice) -> Set {
    let zero = || E::integer(0);
    let halves = |n: i64| E::Number(RBig::from(n) / RBig::from(2)).times(E::Pi);
    let plain: Vec<Symbol> =
        model.states.iter().copied().filter(|name| !model.angles.contains(name)).collect();
    let first = plain.first().copied();
    if !model.angles.is_empty() && (first.is_none() || dice.once_in(2)) {
        let name = dice.one_of(&model.angles);
        let (function, values) =
            if dice.once_in(2) { (Function::Sin, [0, 2]) } else { (Function::Cos, [1, -1]) };
        return Set {
            conditions: vec![Equation::new(E::Symbol(name).of(function), zero())],
            branches: values.map(|n| vec![(name, halves(n))]).to_vec(),
        };
    }
    let c = E::Number(dice.special());
    if let Some((name, _)) = model.parameters.first()
        && dice.once_in(2)
    {
        return Set {
            conditions: vec![Equation::new(E::Symbol(name), c.clone())],
            branches: vec![vec![(*name, c)]],
        };
    }
    let x = first.unwrap_or("x");
    let Some(y) = plain.get(1).copied() else {
        return Set {
            conditions: vec![Equation::new(E::Symbol(x), c.clone())],
            branches: vec![vec![(x, c)]],
        };
    };
    let rest: Vec<Symbol> = plain.iter().copied().filter(|name| *name != x).collect();
    match dice.below(6) {
        0 | 1 => {
            Set { conditions: vec![Equation::new(E::Symbol(x), c.clone())], branches: vec![vec![(x, c)]] }
        }
        2 => {
            let e = dice.polynomial(&rest, 2, 2);
            Set { conditions: vec![Equation::new(E::Symbol(x), e.clone())], branches: vec![vec![(x, e)]] }
        }
        3 => Set {
            conditions: vec![Equation::new(E::Symbol(x).times(E::Symbol(y)), zero())],
            branches: vec![vec![(x, zero())], vec![(y, zero())]],
        },
        4 => {
            let e = dice.polynomial(&rest, 1, 2);
            let e = e.with(y, &c);
            Set {
                conditions: vec![
                    Equation::new(
                        E::Symbol(x).minus(e.clone().plus(E::Symbol(y).times(E::Symbol(y)))),
                        zero(),
                    ),
                    Equation::new(E::Symbol(y), c.clone()),
                ],
                branches: vec![vec![(y, c.clone()), (x, e.plus(c.power(2)))]],
            }
        }
        _ => Set {
            // y z = x on y = 0: then x = 0 too
            conditions: vec![
                Equation::new(
                    E::Symbol(y).times(E::Symbol(rest[rest.len() - 1])).minus(E::Symbol(x)),
                    zero(),
                ),
                Equation::new(E::Symbol(y), zero()),
            ],
            branches: vec![vec![(y, zero()), (x, zero())]],
        },
    }
}

/// `rank --where`: the ranks that are found at drawn states of each branch are those of a branch of ours, by words of the
/// same length.
fn sampled(class: &str, model: &Model, set: &Set, dice: &mut Dice, findings: &mut Findings) {
    let mut text = format!("{}sample\n", model.text());
    for name in model.symbols() {
        text.push_str(&format!("  {name} in [1/2, 3]\n"));
    }
    let conditions: Vec<String> = set.conditions.iter().map(Equation::text).collect();
    let branches = match rank_where(&text, &conditions) {
        Ok(branches) => branches,
        Err(why) if why.starts_with("panicked") => return findings.fault("rank --where panics", why, &text),
        Err(why) => return findings.undecided(&format!("{class}, drawn"), &why),
    };
    let mut ours: Vec<Vec<usize>> = Vec::new();
    for branch in &set.branches {
        let mut point = dice.generic_point(model);
        for (name, e) in branch {
            let Ok(number) = value(e, &point) else { return };
            point.put(name, Coordinate::Number(number));
        }
        let Ok(found) = ranks(model, &point, model.states.len() + 3) else { return };
        ours.push(found);
    }
    for said in &branches {
        let Some(rank) = said.rank else {
            findings.count(class, "several ranks at drawn states");
            continue;
        };
        let right = ours.iter().any(|found| {
            let known = found.get(said.order).or(found.last().filter(|last| **last == model.states.len()));
            known == Some(&rank)
        });
        let long =
            ours.iter().any(|found| found.len() <= said.order && found.last() != Some(&model.states.len()));
        if right || long {
            findings.count(class, "rank at drawn states as ours");
        } else {
            let detail = format!("{said:?}; ours on the branches {ours:?}, where {}", conditions.join(", "));
            findings.fault("a rank at drawn states of a set is another", detail, &text);
        }
    }
}

fn truth(model: &Model, set: &Set, dice: &mut Dice) -> Option<Truth> {
    let around = generic_rank(model, dice)?;
    let mut at_least = Vec::new();
    let mut longest = model.states.len() + 3;
    for branch in &set.branches {
        let mut best = None;
        for _ in 0..3 {
            let mut point = dice.generic_point(model);
            for (name, e) in branch {
                let number = value(e, &point).ok()?;
                point.put(name, Coordinate::Number(number));
            }
            if set.conditions.iter().any(|c| c.at(&point) != super::point::Compared::Equal) {
                return None;
            }
            match ranks(model, &point, longest) {
                Ok(found) => {
                    if found.last() != Some(&model.states.len()) {
                        longest = longest.min(found.len() - 1);
                    }
                    best = best.max(found.last().copied());
                }
                Err(Trouble::Undefined) => return None, // the set lies in a pole
                Err(_) => {}
            }
        }
        at_least.push(best?);
    }
    Some(Truth { at_least, around, longest })
}

fn judge(
    class: &str,
    model: &Model,
    truth: &Truth,
    claimed: usize,
    said: &Said,
    text: &str,
    findings: &mut Findings,
) {
    let detail = format!(
        "rank = {claimed} is {:?} ({}, {:?}); by words of up to {} fields it is {:?} on the branches, {} around",
        said.word, said.why, said.witness, truth.longest, truth.at_least, truth.around
    );
    let all_are = truth.at_least.iter().all(|rank| *rank == claimed);
    let one_is_more = truth.at_least.iter().any(|rank| *rank > claimed);
    let as_long = truth.longest > model.states.len();
    match said.word {
        Word::Proved if one_is_more || claimed > truth.around => {
            findings.fault("a rank is proved on a set, and is another", detail, text);
        }
        Word::Proved if !all_are && as_long => {
            findings.fault("a rank is proved on a set that no word reaches", detail, text);
        }
        Word::Proved => findings.count(class, "proved"),
        Word::Refuted if all_are && (claimed == truth.around || as_long) => {
            findings.fault("the right rank is refuted on a set", detail, text);
        }
        Word::Refuted => {
            findings.count(class, "refuted");
            witness(class, model, said, &detail, text, findings);
        }
        Word::Undecided => findings.undecided(class, &said.why),
    }
}

/// The rank at the state that a refutation names, if it names one.
fn witness(class: &str, model: &Model, said: &Said, detail: &str, text: &str, findings: &mut Findings) {
    let Some(shown) = &said.witness else { return };
    let Some(point) = Point::read(&shown.state) else {
        return findings.fault("a state of a rank that cannot be read", detail, text);
    };
    if model.symbols().iter().any(|name| point.get(name).is_none()) {
        return findings.count(class, "refuted by no full state");
    }
    let longest = model.states.len() + 2;
    match (ranks(model, &point, longest), shown.left.parse::<usize>()) {
        (Ok(found), Ok(printed))
            if found.len() > model.states.len()
                && found.last() != Some(&printed)
                && !found.contains(&printed) =>
        {
            findings.fault(
                "a refuted rank's state has another rank",
                format!("{detail}; ours {found:?}"),
                text,
            );
        }
        (Err(Trouble::Undefined), _) => findings.fault("a refuted rank's state is a pole", detail, text),
        _ => {}
    }
}
