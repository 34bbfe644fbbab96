//! Certificates: what lies in a proved box has full rank and is defined, at states drawn densely, and at the zeros and
//! poles that are known by construction.

use super::condition_sets::ANGLES;
use super::dice::Dice;
use super::expression::{Expression, Function, Symbol};
use super::findings::{Findings, seed};
use super::library::{Rows, certify};
use super::number::{Number, Sign, Trouble};
use super::point::{Coordinate, Point};
use super::rank::{rank, ranks};
use super::series::{Space, series};
use super::system::{Field, Model, Role};
use Expression as E;
use dashu::rational::RBig;

/// A side of a box.
type Side = (Symbol, i64, i64);

/// A box, the rows on it, and values of its coordinates at which something may happen.
struct Question {
    model: Model,
    /// The file's own rows, where these are asked for.
    rows: Option<Vec<Vec<E>>>,
    sides: Vec<Side>,
}

/// Boxes that are looked at in a search.
const BOXES: u64 = 200;

#[test]
fn boxes_that_are_proved() {
    let found = Findings::of("boxes that are proved", 240, one_case);
    found.assert_no_fault("boxes_that_are_proved");
    if found.is_whole() {
        for class in ["own rows", "codistribution"] {
            let proved = found.counted(class, "states in proved boxes, of full rank");
            assert!(proved > 500, "{class}: only {proved} states lay in proved boxes");
            let outside = found.counted(class, "states of no full rank, not proved");
            assert!(outside > 50, "{class}: only {outside} states were short of rank or poles");
        }
    }
}

fn one_case(case: u64, findings: &mut Findings) {
    let mut dice = Dice::new(seed() ^ 0xb0c5, case);
    let own = case % 2 == 0;
    let question = draw(own, &mut dice);
    let class = if own { "own rows" } else { "codistribution" };
    let text = text(&question);
    let rows = if own { Rows::Own } else { Rows::Codistribution };
    let certificate = match certify(&text, rows, BOXES) {
        Ok(certificate) => certificate,
        Err(why) if why.starts_with("panicked") || why.starts_with("not read") => {
            return findings.fault("certify fails", why, &text);
        }
        Err(why) => return findings.undecided(class, &why),
    };
    findings.count(
        class,
        match certificate.proved {
            whole if whole >= 1.0 => "boxes proved as a whole",
            none if none <= 0.0 => "boxes of which nothing is proved",
            _ => "boxes proved in part",
        },
    );
    let longest = certificate.order.unwrap_or(0).min(6);
    for state in states(&question, &mut dice) {
        let mut point = Point::default();
        let mut at = Vec::new();
        for (name, value) in &state {
            point.put(name, Coordinate::Number(value.clone()));
            at.push(((*name).to_owned(), hull(value)));
        }
        let full = is_full(&question, &point, longest);
        let proved = certificate.proves(&at);
        let detail = || format!("{} lies in a proved box; {full:?} by our elimination", point.text());
        match (full, proved) {
            (Ok(true), true) => findings.count(class, "states in proved boxes, of full rank"),
            (Ok(true), false) => findings.count(class, "states of full rank, not proved"),
            (Ok(false), true) => findings.fault("a state short of rank is certified", detail(), &text),
            (Err(Trouble::Undefined), true) => {
                findings.fault("a state at which nothing is defined is certified", detail(), &text)
            }
            (Err(Trouble::NotSmooth), true) => {
                findings.fault("a state without derivatives is certified", detail(), &text)
            }
            (Ok(false) | Err(Trouble::Undefined | Trouble::NotSmooth), false) => {
                findings.count(class, "states of no full rank, not proved");
            }
            (Err(_), _) => findings.count(class, "states that we cannot judge"),
        }
    }
}

/// Whether the rank is full at a state where everything is defined.
fn is_full(question: &Question, point: &Point, longest: usize) -> Result<bool, Trouble> {
    let n = question.model.states.len();
    match &question.rows {
        Some(rows) => {
            let space = Space { variables: Vec::new(), degree: 0 };
            let mut matrix = Vec::new();
            for row in rows {
                let entries: Result<Vec<Number>, Trouble> =
                    row.iter().map(|e| Ok(series(e, point, &space)?.value())).collect();
                matrix.push(entries?);
            }
            Ok(rank(matrix)? == n)
        }
        None => {
            let found = ranks(&question.model, point, longest)?;
            if found.last() != Some(&n) && found.len() <= longest {
                return Err(Trouble::TooLarge);
            }
            Ok(found.last() == Some(&n))
        }
    }
}

fn text(question: &Question) -> String {
    let mut text = question.model.text();
    if let Some(rows) = &question.rows {
        let rows: Vec<String> =
            rows.iter().map(|row| row.iter().map(E::text).collect::<Vec<_>>().join(", ")).collect();
        text.push_str(&format!("let rows = [{}]\n", rows.join("; ")));
    }
    text.push_str("sample\n");
    for (name, low, high) in &question.sides {
        text.push_str(&format!("  {name} in [{low}, {high}]\n"));
    }
    text
}

/// An interval that holds a number.
fn hull(value: &Number) -> (RBig, RBig) {
    match value {
        Number::Rational(value) => (value.clone(), value.clone()),
        other => {
            let near = RBig::try_from(other.digits().to_f64().value()).unwrap_or(RBig::ZERO);
            let room = RBig::from(1) / RBig::from(1i64 << 46);
            (&near - &room, near + room)
        }
    }
}

/// A value at which something may happen.
fn special(name: Symbol, dice: &mut Dice) -> Number {
    if ANGLES.contains(&name) {
        return Number::turns(RBig::from(dice.between(-4, 4)) / RBig::from(2));
    }
    let (top, bottom) = dice.one_of(&[(0, 1), (1, 1), (-1, 1), (2, 1), (1, 2), (-1, 2), (3, 2), (3, 1)]);
    Number::Rational(RBig::from(top) / RBig::from(bottom))
}

/// Values on grids, special ones in all combinations with them, and equal ones, where differences of coordinates vanish.
fn states(question: &Question, dice: &mut Dice) -> Vec<Vec<(Symbol, Number)>> {
    let inside = |value: &Number, (_, low, high): &Side| {
        let above = value.subtract(&Number::integer(*low)).sign();
        let below = Number::integer(*high).subtract(value).sign();
        ![above, below].contains(&Sign::Negative)
    };
    let mut found = Vec::new();
    for attempt in 0..60 {
        let mut state: Vec<(Symbol, Number)> = Vec::new();
        for side in &question.sides {
            let (name, low, high) = *side;
            let special = special(name, dice);
            let value = if attempt % 3 < 2 && dice.once_in(2) && inside(&special, side) {
                special
            } else {
                let cells = dice.one_of(&[1i64, 2, 4, 64, 97]);
                let part = RBig::from((high - low) * dice.between(0, cells)) / RBig::from(cells);
                Number::Rational(RBig::from(low) + part)
            };
            state.push((name, value));
        }
        if attempt % 5 == 4
            && let [(_, first), (_, second)] = state.as_mut_slice()
            && inside(first, &question.sides[1])
        {
            *second = first.clone();
        }
        found.push(state);
    }
    found
}

fn draw(own: bool, dice: &mut Dice) -> Question {
    let states: Vec<Symbol> = dice.one_of(&[
        vec!["x"],
        vec!["x", "y"],
        vec!["x", "y"],
        vec!["phi"],
        vec!["x", "phi"],
        vec!["phi", "psi"],
    ]);
    let n = states.len();
    let sides: Vec<Side> = states
        .iter()
        .map(|name| {
            let low = dice.between(-2, if ANGLES.contains(name) { 3 } else { 1 });
            (*name, low, low + dice.between(1, 3))
        })
        .collect();
    let rates = states.iter().map(|_| rate(&states, dice)).collect();
    let mut model = Model {
        fields: vec![Field::new("f", Role::Drift, rates)],
        states: states.clone(),
        ..Model::default()
    };
    if own {
        model.outputs = vec![doubtless(states[0])];
        let count = n + dice.below(2);
        let entry = |dice: &mut Dice| {
            if dice.once_in(4) { E::integer(dice.one_of(&[0, 1])) } else { doubtful(&states, dice) }
        };
        let rows = (0..count).map(|_| (0..n).map(|_| entry(dice)).collect()).collect();
        return Question { model, rows: Some(rows), sides };
    }
    model.outputs = (0..1 + dice.below(2)).map(|_| doubtful(&states, dice)).collect();
    Question { model, rows: None, sides }
}

fn rate(states: &[Symbol], dice: &mut Dice) -> E {
    match dice.below(4) {
        0 => E::integer(dice.one_of(&[0, 1])),
        1 => doubtful(states, dice),
        _ => match dice.one_of(states) {
            name if ANGLES.contains(&name) => doubtless(name),
            name => dice.polynomial(&[name], 1, 2),
        },
    }
}

/// A symbol, or the sine of an angle.
fn doubtless(name: Symbol) -> E {
    let symbol = E::Symbol(name);
    if ANGLES.contains(&name) { symbol.of(Function::Sin) } else { symbol }
}

/// A term that may be undefined, or constant, or vanish somewhere in a box.
fn doubtful(states: &[Symbol], dice: &mut Dice) -> E {
    let (zero, one) = (|| E::integer(0), || E::integer(1));
    let mut atom = || {
        let name = dice.one_of(states);
        if ANGLES.contains(&name) { dice.wave(&[name]) } else { E::Symbol(name) }
    };
    let (x, y) = (atom(), atom());
    let shift = E::Number(dice.special());
    let t = x.clone().minus(shift);
    if let Some(name) = states.iter().find(|name| ANGLES.contains(name))
        && dice.once_in(3)
    {
        let (sine, cosine) = (E::Symbol(name).of(Function::Sin), E::Symbol(name).of(Function::Cos));
        return match dice.below(5) {
            0 => E::integer(2).plus(sine.over(one().plus(cosine))),
            1 => E::Symbol(name).of(Function::Tan),
            2 => sine.power(2).over(one().minus(cosine)),
            3 => sine.clone().over(sine).plus(y),
            _ => one().minus(cosine).of(Function::Sqrt),
        };
    }
    match dice.below(18) {
        0 => x.clone().over(x),
        1 => t.clone().power(2).over(t),
        2 => t.clone().of(Function::Sqrt).power(2),
        3 => t.of(Function::Log),
        4 => one().over(t).plus(y),
        5 => zero().over(t.clone().minus(t)).plus(x),
        6 => one().over(one().over(t)),
        7 => zero().times(t.of(Function::Log)).plus(y),
        8 => t.of(Function::Sqrt),
        9 => t.clone().times(y).over(t),
        10 => t.times(y),
        11 => x.clone().times(x).plus(y),
        12 => t.power(0).times(y),
        13 => t.power(-1).power(-1).plus(y),
        14 => E::integer(2).plus(x.clone().of(Function::Sin).over(t)),
        15 => x.of(Function::Asin),
        16 => zero().over(t).plus(y).plus(x),
        _ => t.of(Function::Exp).times(y),
    }
}
