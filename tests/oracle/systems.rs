//! Random systems: their generic rank, claimed as every number that it could be, and their rank at states where something may
//! vanish.

use super::dice::Dice;
use super::expression::{Expression, Function, Symbol};
use super::findings::{Findings, seed};
use super::library::{Word, rank_at, verdicts};
use super::number::{Number, Trouble};
use super::point::{Coordinate, Point};
use super::rank::ranks;
use super::system::{Field, Model, ROLES_ARE_WRITTEN, Role};
use dashu::rational::RBig;

const NAMES: [Symbol; 6] = ["x", "y", "z", "w", "v", "u"];
const ANGLES: [Symbol; 2] = ["phi", "psi"];

/// The kinds of systems that are drawn, with how many in a dozen.
const CLASSES: [(&str, usize); 9] = [
    ("polynomial", 3),
    ("rational", 2),
    ("of angles", 2),
    ("of bare angles", 1),
    ("transcendental", 1),
    ("late rank", 1),
    ("outputs that say little", 1),
    ("hidden states", 1),
    ("a parameter with a value", 1),
];

#[test]
fn ranks_of_random_systems() {
    let found = Findings::of("ranks of random systems", 480, one_system);
    found.assert_no_fault("ranks_of_random_systems");
    if found.is_whole() {
        for (class, _) in CLASSES {
            let proved = found.counted(class, "right rank proved");
            let certified = found.counted(class, "rank at a state certified");
            assert!(proved + certified > 10, "{class}: {proved} and {certified} are next to nothing");
        }
        // where all is rational, the engine has no excuse
        for class in ["polynomial", "rational", "of angles", "late rank"] {
            let (proved, open) =
                (found.counted(class, "right rank proved"), found.counted(class, "right rank undecided"));
            assert!(open * 20 <= proved, "{class}: {open} undecided beside {proved} proved");
        }
    }
}

fn one_system(case: u64, findings: &mut Findings) {
    let mut dice = Dice::new(seed(), case);
    let weights: Vec<&str> =
        CLASSES.iter().flat_map(|(class, weight)| std::iter::repeat_n(*class, *weight)).collect();
    let class = weights[case as usize % weights.len()];
    let model = draw(class, &mut dice);
    claims(class, &model, &mut dice, findings);
    states(class, &model, &mut dice, findings);
}

/// A system of a kind.
pub fn draw(class: &str, dice: &mut Dice) -> Model {
    let n = dice.one_of(&[1, 2, 2, 2, 3, 3, 3, 4]);
    let mut model = Model { states: NAMES[..n].to_vec(), ..Model::default() };
    let inputs = dice.one_of(&[0, 0, 1, 1, 2]);
    match class {
        "of angles" | "of bare angles" => {
            model.states = [&ANGLES[..1 + dice.below(2)], &NAMES[..dice.below(3)]].concat();
            model.angles = model.states.iter().copied().filter(|name| ANGLES.contains(name)).collect();
        }
        "late rank" => return late(dice),
        "hidden states" => return hidden(dice),
        "a parameter with a value" => {
            let value = dice.one_of(&["0", "1", "2", "0", "-1"]);
            model.parameters = vec![("k", Some(value.to_owned()))];
        }
        _ => {}
    }
    for place in 0..=inputs {
        let role = if place == 0 { Role::Drift } else { Role::Input };
        let name = if place == 0 { "f".to_owned() } else { format!("g{place}") };
        let rates = (0..model.states.len()).map(|_| term(class, &model, dice)).collect();
        model.fields.push(Field::new(&name, role, rates));
    }
    if ROLES_ARE_WRITTEN && dice.once_in(3) {
        // only differentiated along: it may raise no rank
        let rates = (0..model.states.len()).map(|_| term(class, &model, dice)).collect();
        model.fields.push(Field::new("h", Role::Plain, rates));
    }
    let outputs = 1 + dice.below(2);
    for _ in 0..outputs {
        let output = term(class, &model, dice);
        model.outputs.push(output);
    }
    if class == "outputs that say little" {
        let poor = [
            Expression::integer(0),
            Expression::integer(3),
            Expression::Symbol(model.states[0]).times(Expression::Symbol(model.states[n - 1])),
            Expression::Symbol(model.states[0]).minus(Expression::Symbol(model.states[0])),
            model.outputs[0].clone(),
            Expression::Symbol(model.states[0]).power(2),
            Expression::Symbol(model.states[0]).power(0),
        ];
        model.outputs = (0..1 + dice.below(3)).map(|_| dice.one_of(&poor)).collect();
    }
    model
}

/// A rate or an output.
fn term(class: &str, model: &Model, dice: &mut Dice) -> Expression {
    let plain: Vec<Symbol> =
        model.symbols().into_iter().filter(|name| !model.angles.contains(name)).collect();
    if dice.once_in(5) {
        return Expression::integer(dice.one_of(&[0, 0, 1]));
    }
    match class {
        "rational" => {
            let top = dice.polynomial(&plain, 2, 2);
            if dice.once_in(2) { top.over(dice.divisor(&plain)) } else { top }
        }
        "of angles" | "of bare angles" => {
            let wave = dice.wave(&model.angles);
            let factor = if plain.is_empty() || dice.once_in(3) {
                Expression::integer(dice.factor())
            } else {
                dice.polynomial(&plain, 1, 2)
            };
            match dice.below(7) {
                0 if !plain.is_empty() => dice.polynomial(&plain, 2, 2),
                6 if class == "of bare angles" => Expression::Symbol(dice.one_of(&model.angles)),
                1 => factor.over(wave.plus(Expression::integer(2))),
                2 => factor.plus(wave.of_angle_tangent(dice, model)),
                _ => factor.times(wave),
            }
        }
        "transcendental" => {
            let function = dice.of_one_part(&plain);
            match dice.below(3) {
                0 => function.times(dice.polynomial(&plain, 1, 2)),
                1 => function,
                _ => dice.polynomial(&plain, 2, 2),
            }
        }
        _ => dice.polynomial(&plain, 2, 3),
    }
}

impl Expression {
    /// Now and then the tangent of an angle instead.
    fn of_angle_tangent(self, dice: &mut Dice, model: &Model) -> Expression {
        let angle = Expression::Symbol(dice.one_of(&model.angles));
        if dice.once_in(2) { angle.of(Function::Tan) } else { self }
    }
}

/// A chain, in which the last state is seen after many derivatives only, perhaps with a power that vanishes at zero.
fn late(dice: &mut Dice) -> Model {
    let n = 3 + dice.below(3);
    let states = NAMES[..n].to_vec();
    let mut rates: Vec<Expression> = states[1..].iter().map(|name| Expression::Symbol(name)).collect();
    rates.push(dice.polynomial(&states, 1, 2));
    let place = dice.below(n - 1);
    rates[place] = match dice.below(4) {
        0 => Expression::Symbol(states[place + 1]).times(Expression::Symbol(states[0])),
        1 => Expression::Symbol(states[place + 1]).power(2),
        2 => Expression::Symbol(states[place + 1]).plus(Expression::integer(1)),
        _ => Expression::Symbol(states[place + 1]),
    };
    let output = match dice.below(3) {
        0 => Expression::Symbol(states[0]).power(2 + dice.below(3) as i32),
        _ => Expression::Symbol(states[0]),
    };
    Model {
        fields: vec![Field::new("f", Role::Drift, rates)],
        states,
        outputs: vec![output],
        ..Model::default()
    }
}

/// A system of which some states can never be seen: outputs and rates of the first states know nothing of the last
/// ones. New coordinates hide that: each state is replaced by itself and a polynomial of later ones, which does not
/// change any rank at corresponding states.
fn hidden(dice: &mut Dice) -> Model {
    let n = 2 + dice.below(2);
    let states = NAMES[..n].to_vec();
    let seen = states[..n - 1].to_vec();
    // in coordinates p, q with p = x + b(last): p' = a(p), and x' = a(p) - b'(last) last'
    let last = states[n - 1];
    let bend = dice.polynomial(&[last], 2, 2);
    let first = Expression::Symbol(seen[0]).plus(bend.clone());
    let moved = |e: &Expression| e.with(seen[0], &first);
    let last_rate = dice.polynomial(&states, 2, 2);
    let mut rates = Vec::new();
    for (place, _) in seen.iter().enumerate() {
        let rate = moved(&dice.polynomial(&seen, 2, 2));
        rates.push(match place {
            0 => rate.minus(bend.derivative(last).times(last_rate.clone())),
            _ => rate,
        });
    }
    rates.push(last_rate);
    let output = moved(&dice.polynomial(&seen, 2, 2));
    Model {
        fields: vec![Field::new("f", Role::Drift, rates)],
        states,
        outputs: vec![output],
        ..Model::default()
    }
}

/// The generic rank: the largest at some random states. A word of more fields than there are states adds nothing.
pub fn generic_rank(model: &Model, dice: &mut Dice) -> Option<usize> {
    let longest = model.states.len().saturating_sub(1);
    let mut best = None;
    let mut good = 0;
    for _ in 0..30 {
        let point = dice.generic_point(model);
        if let Ok(found) = ranks(model, &point, longest) {
            best = best.max(found.last().copied());
            good += 1;
            if good == 2 {
                break;
            }
        }
    }
    best
}

fn claims(class: &str, model: &Model, dice: &mut Dice, findings: &mut Findings) {
    let Some(truth) = generic_rank(model, dice) else {
        findings.count(class, "defined nowhere that we know");
        return;
    };
    let mut text = model.text();
    for rank in 0..=model.states.len() {
        text.push_str(&format!("claim r{rank}: rank = {rank}\n"));
    }
    let said = match verdicts(&text) {
        Ok(said) => said,
        Err(why) => return findings.fault("a system is not answered", why, &text),
    };
    let special = at_files_values(model, dice);
    if let Some(special) = special.filter(|special| *special != truth)
        && said[truth].word == Word::Proved
    {
        // the rank is another one at the file's values, and that has to be said
        match said[truth].at_files_values {
            Some("refuted" | "undecided") => findings.count(class, "told of the rank at the file's values"),
            other => {
                let detail = format!(
                    "rank = {truth} is proved, at the file's values it is {special}, and is {other:?}"
                );
                findings.fault("nothing is said of the file's values", detail, &text);
            }
        }
    }
    for (rank, said) in said.iter().enumerate() {
        let detail = format!("rank = {rank} is {:?} ({}), the generic rank is {truth}", said.word, said.why);
        match (said.word, rank == truth) {
            (Word::Proved, true) => findings.count(class, "right rank proved"),
            (Word::Refuted, false) => findings.count(class, "wrong rank refuted"),
            (Word::Proved, false) => findings.fault("a wrong rank is proved", detail, &text),
            (Word::Refuted, true) => findings.fault("the right rank is refuted", detail, &text),
            (Word::Undecided, right) => {
                findings.count(class, if right { "right rank undecided" } else { "wrong rank undecided" });
                findings.undecided(class, &said.why);
            }
        }
    }
}

/// The generic rank where parameters have the values of the file, if any are given.
fn at_files_values(model: &Model, dice: &mut Dice) -> Option<usize> {
    let mut special = model.clone();
    for (name, value) in &model.parameters {
        let value = Expression::Number(value.as_ref()?.parse().ok()?);
        let put = |e: &mut Expression| *e = e.with(name, &value);
        special.outputs.iter_mut().for_each(put);
        special.fields.iter_mut().flat_map(|field| &mut field.rates).for_each(put);
    }
    if special.parameters.is_empty() { None } else { generic_rank(&special, dice) }
}

/// The rank at given states. Angles are put at zero, the only angle that is exact for the command.
fn states(class: &str, model: &Model, dice: &mut Dice, findings: &mut Findings) {
    for _ in 0..3 {
        let mut point = Point::default();
        let mut at: Vec<(String, RBig)> = Vec::new();
        for name in model.symbols() {
            let value = if model.angles.contains(&name) {
                RBig::ZERO
            } else if dice.once_in(3) {
                dice.generic()
            } else {
                dice.special()
            };
            point.put(name, Coordinate::Number(Number::Rational(value.clone())));
            at.push((name.to_owned(), value));
        }
        let shown: Vec<String> = at.iter().map(|(name, value)| format!("{name}={value}")).collect();
        let text = format!("{}# rank --at {}\n", model.text(), shown.join(","));
        match rank_at(&text, &at) {
            Ok(said) => {
                let truth = ranks(model, &point, said.order);
                let detail = format!("{said:?}, by our elimination {truth:?} (by length of words)");
                match (truth, said.rank) {
                    (Ok(truth), Some(rank))
                        if truth.len() > said.order || truth.last() == Some(&model.states.len()) =>
                    {
                        let right = truth.last() == Some(&rank);
                        match (right, said.certified) {
                            (true, true) => findings.count(class, "rank at a state certified"),
                            (true, false) => findings.count(class, "rank at a state computed"),
                            (false, true) => {
                                findings.fault("a wrong rank is certified at a state", detail, &text)
                            }
                            (false, false) => {
                                findings.fault("a wrong rank is computed at a state", detail, &text)
                            }
                        }
                    }
                    (Ok(_), Some(_)) => findings.count(class, "too many words for us"),
                    (Ok(_), None) => findings.count(class, "no rank said, though there is one"),
                    (Err(Trouble::Undefined), Some(_)) => {
                        findings.fault("a rank is given where the system is not defined", detail, &text);
                    }
                    (Err(trouble), Some(_)) => {
                        findings.count(class, &format!("a rank where we have {trouble:?}"))
                    }
                    (Err(_), None) => findings.count(class, "no rank at a pole"),
                }
            }
            Err(why) if why.starts_with("panicked") => findings.fault("rank panics", why, &text),
            Err(why) => match ranks(model, &point, 1) {
                Err(Trouble::Undefined) => findings.count(class, "refused at a pole"),
                _ => {
                    findings.count(class, "refused, though defined");
                    findings.undecided(class, &why);
                }
            },
        }
    }
}
