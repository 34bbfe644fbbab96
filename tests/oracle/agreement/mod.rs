//! All that is said of one file has to agree: the rank at almost all states, under conditions, at all states but those of some
//! sets, the exact set on which it drops, ranks at drawn states, and what is observable; with each other, and with the ranks of
//! an oracle that has polynomials of its own and no rule on when Lie derivatives stop ([`model`]).

mod draw;
mod model;
mod polynomial;
mod sets;

use super::dice::Dice;
use super::findings::{Findings, seed};
use super::library::{Said, Word, drops, recorded, verdicts};
use model::{Differentials, Knowledge, Model, State};
use palmistry::drops::DropAnswer;
use sets::Set;

/// Conditions and sets are drawn so often for one file, and special states of each.
const SETS: usize = 3;
const STATES: usize = 25;

#[test]
fn all_that_is_said_of_one_file_agrees() {
    let found = Findings::of("all that is said of one file", 350, one_case);
    found.assert_no_fault("all_that_is_said_of_one_file_agrees");
    if found.is_whole() {
        for class in draw::CLASSES {
            let (proved, refuted) = (found.counted(class, "proved"), found.counted(class, "refuted"));
            assert!(
                proved > 20 && refuted > 20,
                "{class}: {proved} proved and {refuted} refuted are next to nothing"
            );
        }
        assert!(found.total("the exact set agrees at a state") > 500);
    }
}

/// A file, what is claimed in it, and what is so.
struct Case<'a> {
    class: &'a str,
    model: &'a Model,
    found: Differentials,
    /// The rank at almost all states that the file allows.
    generic: usize,
    text: String,
}

impl Case<'_> {
    fn rank(&self, state: &State, dice: &mut Dice) -> usize {
        self.model.span(&self.found, state, &mut || dice.generic()).len()
    }

    /// The rank at almost all states of each component of a set.
    fn ranks_on(&self, set: &Set, dice: &mut Dice) -> Vec<usize> {
        let rank = |component: usize, dice: &mut Dice| {
            (0..3).map(|_| self.rank(&set.state(self.model, component, false, dice), dice)).max().unwrap_or(0)
        };
        (0..set.components()).map(|component| rank(component, dice)).collect()
    }

    fn in_words(&self, state: &State) -> String {
        let names = Model::names(&self.model.coordinates);
        let all: Vec<String> =
            names.iter().zip(state).map(|(name, value)| format!("{name} = {value}")).collect();
        all.join(", ")
    }
}

fn one_case(number: u64, findings: &mut Findings) {
    let mut dice = Dice::new(seed() ^ 0xa9_7ee5, number);
    let class = draw::CLASSES[number as usize % draw::CLASSES.len()];
    let model = draw::model(class, &mut dice);
    let text = model.text.clone();
    let mut case = Case { class, model: &model, found: model.differentials(), generic: 0, text };
    if !case.found.is_far {
        return findings.count(class, "too many Lie derivatives for us");
    }
    case.generic = case.ranks_on(&Set::all(), &mut dice)[0];
    let sets: Vec<Set> = (0..SETS).filter_map(|_| Set::drawn(&model, &mut dice)).collect();
    let on_sets: Vec<Vec<usize>> = sets.iter().map(|set| case.ranks_on(set, &mut dice)).collect();
    let all = Set::all();
    let claims = claims(&case, &all, &sets, &on_sets);
    let mut text = model.text.clone();
    for (place, claim) in claims.iter().enumerate() {
        text.push_str(&format!("claim c{place}: {}\n", claim.statement));
    }
    case.text = text;
    match verdicts(&case.text) {
        Err(why) => findings.fault("claims are not answered", why, &case.text),
        Ok(said) => {
            for (claim, said) in claims.iter().zip(&said) {
                judge(&case, claim, said, &mut dice, findings);
            }
        }
    }
    if !model.steps {
        match drops(&model.text) {
            Ok(said) => judge_drops(&case, &said, &mut dice, findings),
            Err(why) if why.starts_with("panicked") => {
                findings.fault("--singular-set panics", why, &case.text)
            }
            Err(why) => findings.undecided(class, &why),
        }
    }
    judge_states(&case, &all, &mut dice, findings);
    if let Some(set) = sets.first() {
        judge_states(&case, set, &mut dice, findings);
    }
}

/// The certified ranks at states that are drawn on a set.
fn judge_states(case: &Case<'_>, set: &Set, dice: &mut Dice, findings: &mut Findings) {
    let conditions: Vec<String> = [set.text.clone()].into_iter().filter(|text| !text.is_empty()).collect();
    match recorded(&case.model.text, conditions, 5) {
        Ok(said) => {
            for (is_final, words, rank) in said {
                let Some(state) = case.model.read(&words) else { continue };
                let ours = case.rank(&state, dice);
                if !set.holds(&state) || is_final && ours != rank {
                    let detail =
                        format!("{rank} where {} at {}; ours {ours}", set.text, case.in_words(&state));
                    findings.fault("a certified rank is another", detail, &case.text);
                } else {
                    findings.count(case.class, "a certified rank agrees");
                }
            }
        }
        Err(why) if why.starts_with("panicked") => findings.fault("rank panics", why, &case.text),
        Err(why) => findings.undecided(case.class, &why),
    }
}

/// What is claimed.
enum About<'a> {
    /// The rank at almost all states of a set, which is this on its components.
    Almost(Vec<usize>),
    /// At all states of a set but those of others.
    All(&'a Set, Vec<&'a Set>),
    /// That a coordinate is observable, or unobservable, at almost all states of a set.
    Seen(usize, bool, &'a Set),
}

struct Claim<'a> {
    statement: String,
    rank: usize,
    about: About<'a>,
}

fn claims<'a>(case: &Case<'_>, all: &'a Set, sets: &'a [Set], on_sets: &[Vec<usize>]) -> Vec<Claim<'a>> {
    let mut found = Vec::new();
    let most = case.model.unknowns().len();
    let mut add = |statement: String, rank: usize, about| found.push(Claim { statement, rank, about });
    for rank in 0..=most {
        add(format!("rank = {rank}"), rank, About::Almost(vec![case.generic]));
        for (set, ranks) in sets.iter().zip(on_sets) {
            add(format!("rank = {rank} where {}", set.text), rank, About::Almost(ranks.clone()));
        }
    }
    if !case.model.steps {
        for rank in [case.generic, case.generic.saturating_sub(1)] {
            add(format!("rank = {rank} everywhere"), rank, About::All(all, Vec::new()));
            for set in sets {
                add(format!("rank = {rank} except where {}", set.text), rank, About::All(all, vec![set]));
            }
        }
        if let [first, .., last] = sets {
            let (rank, texts) = (case.generic, [&first.text, &last.text]);
            let statement = format!("rank = {rank} except where {} or {}", texts[0], texts[1]);
            add(statement, rank, About::All(all, vec![first, last]));
            let rank = on_sets[0].iter().copied().max().unwrap_or(0);
            let statement = format!("rank = {rank} where {} except where {}", texts[0], texts[1]);
            add(statement, rank, About::All(first, vec![last]));
        }
    }
    for unknown in case.model.unknowns() {
        let name = &case.model.coordinates[unknown].name;
        if case.model.coordinates[unknown].is_angle {
            continue;
        }
        for (word, wanted) in [("observable", true), ("unobservable", false)] {
            add(format!("{word}({name})"), 0, About::Seen(unknown, wanted, all));
            if let Some(set) = sets.first() {
                add(format!("{word}({name}) where {}", set.text), 0, About::Seen(unknown, wanted, set));
            }
        }
    }
    found
}

fn judge(case: &Case<'_>, claim: &Claim<'_>, said: &Said, dice: &mut Dice, findings: &mut Findings) {
    let mut fault = |kind: &str, detail: String| {
        let detail =
            format!("{}: {:?} ({}, {:?}); {detail}", claim.statement, said.word, said.why, said.witness);
        findings.fault(kind, detail, &case.text);
    };
    match (&claim.about, said.word) {
        (_, Word::Undecided) => return findings.undecided(case.class, &said.why),
        (About::Almost(ranks), word) => {
            let holds = ranks.iter().all(|rank| *rank == claim.rank);
            if holds != (word == Word::Proved) {
                fault("a rank at almost all states of a set is another", format!("ours {ranks:?}"));
            }
        }
        (About::Seen(unknown, wanted, set), word) => {
            let (mut seen, mut unobservable) = (0, 0);
            for place in 0..3 * set.components() {
                let state = set.state(case.model, place % set.components(), false, dice);
                let mut span = case.model.span(&case.found, &state, &mut || dice.generic());
                *(if span.insert(case.model.unit(*unknown)) { &mut unobservable } else { &mut seen }) += 1;
            }
            let holds = if *wanted { unobservable == 0 } else { seen == 0 };
            if holds != (word == Word::Proved) {
                fault(
                    "what is observable is not, or the other way round",
                    format!("seen at {seen} states, not at {unobservable}"),
                );
            }
        }
        (About::All(on, except), Word::Proved) => {
            for place in 0..STATES {
                let state = on.state(case.model, place % on.components(), true, dice);
                if except.iter().any(|set| set.holds(&state)) {
                    continue;
                }
                let ours = case.rank(&state, dice);
                if ours != claim.rank {
                    let detail = format!("{ours} at {}", case.in_words(&state));
                    return fault("a rank at all states is another at one", detail);
                }
            }
        }
        (About::All(on, except), Word::Refuted) => {
            let Some(state) = said.witness.as_ref().and_then(|shown| case.model.read(&shown.state)) else {
                return findings.count(case.class, "refuted by no full state");
            };
            let ours = case.rank(&state, dice);
            let is_meant = on.holds(&state) && !except.iter().any(|set| set.holds(&state));
            let begins = case.model.coordinates.iter().enumerate().all(|(place, one)| match &one.knowledge {
                Knowledge::Number(value) => state[case.model.place(place)] == *value,
                _ => true,
            });
            if ours == claim.rank || !is_meant || !begins {
                let detail = format!("{ours} at {}", case.in_words(&state));
                return fault("a state that refutes meets the claim", detail);
            }
        }
    }
    findings.count(case.class, if said.word == Word::Proved { "proved" } else { "refuted" });
}

/// The exact set on which the rank drops, at special states.
fn judge_drops(case: &Case<'_>, said: &DropAnswer, dice: &mut Dice, findings: &mut Findings) {
    if said.rank != case.generic {
        let detail = format!("{} at almost all states; ours {}", said.rank, case.generic);
        if said.is_final {
            findings.fault("the rank off the exact set is another", detail, &case.text);
        }
        return;
    }
    let names = Model::names(&case.model.coordinates);
    let read = |texts: &[String]| -> Option<Vec<polynomial::Polynomial>> {
        texts.iter().map(|text| polynomial::read_equation(text, &names)).collect()
    };
    let sets: Option<Vec<_>> =
        said.sets.iter().map(|set| Some((read(&set.equations)?, read(&set.unless)?))).collect();
    let Some(sets) = sets else { return findings.count(case.class, "an exact set that we cannot read") };
    for _ in 0..STATES {
        let state = Set::all().state(case.model, 0, true, dice);
        let vanishes = |one: &polynomial::Polynomial| one.at(&state).is_zero();
        let inside =
            sets.iter().any(|(zero, unless)| zero.iter().all(vanishes) && !unless.iter().any(vanishes));
        let around = sets.iter().any(|(zero, _)| zero.iter().all(vanishes));
        let ours = case.rank(&state, dice);
        let detail = || format!("{said:?}; ours {ours} at {}", case.in_words(&state));
        if inside && ours == case.generic {
            return findings.fault("the rank does not drop on the exact set", detail(), &case.text);
        }
        if said.is_exact() && !around && ours < case.generic {
            return findings.fault("the rank drops off the exact set", detail(), &case.text);
        }
        findings.count(case.class, "the exact set agrees at a state");
    }
}
