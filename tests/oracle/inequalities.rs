//! Inequalities: what is proved holds at all states that are tried, the ends of ranges and simple numbers among them; what
//! is refuted fails at its witness, which meets all conditions.

use super::dice::Dice;
use super::expression::{Expression, Function, Symbol};
use super::findings::{Findings, seed};
use super::library::{Said, Word, verdicts};
use super::number::{Number, Sign, Trouble};
use super::point::{Coordinate, Point};
use super::series::value;
use Expression as E;
use dashu::rational::RBig;

const PLAIN: [Symbol; 3] = ["x", "y", "z"];
const ANGLE: Symbol = "phi";

/// `left < right`, or another relation.
#[derive(Clone, Debug)]
struct Inequality {
    left: E,
    sign: &'static str,
    right: E,
}

impl Inequality {
    fn text(&self) -> String {
        format!("{} {} {}", self.left.text(), self.sign, self.right.text())
    }

    /// Whether it holds at a state; `None` where that is not clear.
    fn holds(&self, point: &Point) -> Result<Option<bool>, Trouble> {
        let difference = value(&self.left, point)?.subtract(&value(&self.right, point)?);
        let exact = difference.is_exact();
        Ok(match (difference.sign(), self.sign) {
            (Sign::Unclear, _) => None,
            (Sign::Zero, sign) => exact.then_some(["<=", ">=", "="].contains(&sign)),
            (Sign::Positive, sign) => Some([">", ">=", "!="].contains(&sign)),
            (Sign::Negative, sign) => Some(["<", "<=", "!="].contains(&sign)),
        })
    }
}

#[test]
fn inequalities_hold_where_they_are_proved() {
    let found = Findings::of("inequalities", 120, one_case);
    found.assert_no_fault("inequalities_hold_where_they_are_proved");
    if found.is_whole() {
        for class in ["polynomials", "rational", "waves", "functions"] {
            for what in ["proved", "refuted"] {
                let count = found.counted(class, what);
                assert!(count > 8, "{class}: only {count} {what}");
            }
        }
    }
}

fn one_case(case: u64, findings: &mut Findings) {
    let mut dice = Dice::new(seed() ^ 0x1e99, case);
    let class = ["polynomials", "rational", "waves", "functions"][case as usize % 4];
    let mut text =
        "system \"drawn\"\nstate x, y, z, phi\nangle phi\ndrift f  others' = 0\noutput x\n".to_owned();
    let mut claims = Vec::new();
    for number in 0..6 {
        let claimed = claimed(class, &mut dice);
        let conditions = conditions(class, &mut dice);
        let given: Vec<String> = conditions.iter().map(Inequality::text).collect();
        let place = if given.is_empty() { String::new() } else { format!(" where {}", given.join(", ")) };
        text.push_str(&format!("claim c{number}: {}{place}\n", claimed.text()));
        claims.push((claimed, conditions));
    }
    let said = match verdicts(&text) {
        Ok(said) => said,
        Err(why) => return findings.fault("a file with inequalities is not answered", why, &text),
    };
    for ((claimed, conditions), said) in claims.iter().zip(&said) {
        let line = text.lines().find(|line| line.starts_with(&format!("claim {}:", said.id)));
        judge(class, (claimed, conditions), said, line.unwrap_or_default(), &mut dice, findings);
    }
}

fn judge(
    class: &str,
    (claimed, conditions): (&Inequality, &[Inequality]),
    said: &Said,
    line: &str,
    dice: &mut Dice,
    findings: &mut Findings,
) {
    match said.word {
        Word::Undecided => return findings.undecided(class, &said.why),
        Word::Proved => findings.count(class, "proved"),
        Word::Refuted => {
            findings.count(class, "refuted");
            if said.witness.as_ref().is_some_and(|shown| shown.is_a_zero()) {
                return findings.count(class, "refuted at a zero");
            }
            let point = said.witness.as_ref().and_then(|shown| Point::read(&shown.state));
            let Some(mut point) = point else {
                return findings.fault(
                    "a refutation without a witness that can be read",
                    said.why.clone(),
                    line,
                );
            };
            // what a witness leaves out is needed by nothing: any value will do
            for name in PLAIN.into_iter().chain([ANGLE]) {
                if point.get(name).is_none() {
                    point.put(name, Coordinate::Number(Number::ONE));
                }
            }
            for condition in conditions {
                if !matches!(condition.holds(&point), Ok(Some(true) | None)) {
                    let detail = format!("{} at {}", condition.text(), point.text());
                    findings.fault("a witness does not meet a condition", detail, line);
                }
            }
            if !matches!(claimed.holds(&point), Ok(Some(false) | None)) {
                findings.fault("the inequality holds at the witness", point.text(), line);
            }
            return;
        }
    }
    let mut met = 0;
    for attempt in 0..160 {
        let point = state(attempt, conditions, dice);
        if conditions.iter().any(|condition| !matches!(condition.holds(&point), Ok(Some(true)))) {
            continue;
        }
        match claimed.holds(&point) {
            Ok(Some(true)) => met += 1,
            Ok(Some(false)) => {
                return findings.fault("proved, and false at a state", point.text(), line);
            }
            // a side does not exist there, or 240 digits do not tell
            Ok(None) | Err(_) => {}
        }
    }
    findings.count(
        class,
        if met > 0 { "proved, and true at all states tried" } else { "proved, and no state was found" },
    );
}

/// A state: simple numbers, numbers in the conditions and a little beside them, and any.
fn state(attempt: usize, conditions: &[Inequality], dice: &mut Dice) -> Point {
    let mut point = Point::default();
    let ends: Vec<RBig> = conditions
        .iter()
        .filter_map(|condition| match &condition.right {
            E::Number(value) => Some(value.clone()),
            _ => None,
        })
        .collect();
    for name in PLAIN {
        let number = match (attempt % 4, ends.is_empty()) {
            (0, _) => dice.special(),
            (1, false) => dice.one_of(&ends),
            (2, false) => dice.one_of(&ends) + RBig::from(dice.one_of(&[1i64, -1])) / RBig::from(1000),
            _ if dice.once_in(2) => {
                RBig::from(dice.between(-60, 60)) / RBig::from(dice.one_of(&[16i64, 30, 4]))
            }
            _ => dice.generic(),
        };
        point.put(name, Coordinate::Number(Number::Rational(number)));
    }
    let turns = RBig::from(dice.between(-8, 8)) / RBig::from(dice.one_of(&[2i64, 4, 5]));
    let angle = match dice.below(3) {
        0 => Coordinate::Number(Number::turns(turns)),
        _ => Coordinate::from_half_tangent(&dice.generic()),
    };
    point.put(ANGLE, angle);
    point
}

fn symbol(dice: &mut Dice) -> E {
    E::Symbol(dice.one_of(&PLAIN))
}

/// Ranges, orders, or nothing.
fn conditions(class: &str, dice: &mut Dice) -> Vec<Inequality> {
    let mut found = Vec::new();
    let bounded = class == "functions" || dice.once_in(3);
    if bounded {
        for name in PLAIN {
            let (low, high) = dice.one_of(&[(0, 1), (0, 2), (1, 3), (-1, 1), (-2, 1)]);
            let strict = dice.once_in(2);
            let end = |sign, value| Inequality { left: E::Symbol(name), sign, right: E::integer(value) };
            found.push(end(if strict { ">" } else { ">=" }, low));
            found.push(end(if strict { "<" } else { "<=" }, high));
        }
    } else if dice.once_in(2) {
        for name in PLAIN {
            let sign = dice.one_of(&[">", ">=", "<"]);
            found.push(Inequality { left: E::Symbol(name), sign, right: E::integer(0) });
        }
    }
    if dice.once_in(4) {
        let sign = dice.one_of(&["<", ">=", "!="]);
        found.push(Inequality { left: symbol(dice), sign, right: symbol(dice) });
    }
    // where a square vanishes this says nothing of the other factor
    if dice.once_in(4) {
        let (a, b) = (symbol(dice), symbol(dice));
        let left = if dice.once_in(2) { a.power(2).times(b) } else { a.times(b) };
        found.push(Inequality { left, sign: dice.one_of(&[">=", ">", "<="]), right: E::integer(0) });
    }
    // an inequality of a symbol with itself says nothing or too much
    found.retain(|inequality| inequality.left != inequality.right);
    found
}

/// An inequality that holds by its making, now and then with a number that spoils it, or any.
fn claimed(class: &str, dice: &mut Dice) -> Inequality {
    let (a, b, c) = (symbol(dice), symbol(dice), symbol(dice));
    let number = |value: i64| E::integer(value);
    let square = |e: E| e.power(2);
    let base = match (class, dice.below(5)) {
        ("polynomials", 0) => square(a.clone().minus(b)).plus(square(a)),
        ("polynomials", 1) => square(a.plus(b.times(number(2))).plus(c)).times(number(3)),
        ("polynomials", 2) => square(square(a).minus(b)).plus(square(c)),
        ("polynomials", 3) if dice.once_in(2) => a.times(b),
        ("polynomials", 3) => a.clone().power(4).minus(a.times(number(4))).plus(number(3)),
        ("polynomials", _) => dice.polynomial(&PLAIN, 2, 4),
        ("rational", 0) => square(a.clone()).over(square(a).plus(number(1))),
        ("rational", 1) => {
            let bottom = square(a.clone()).plus(square(b.clone())).plus(number(1));
            number(1).over(number(2)).minus(a.times(b).over(bottom))
        }
        ("rational", 2) => square(a.clone()).plus(number(1)).over(square(b)),
        ("rational", 3) => a.clone().over(b.clone()).plus(b.over(a)).minus(number(2)),
        ("rational", _) => dice.polynomial(&PLAIN, 1, 2).over(dice.divisor(&PLAIN)),
        ("waves", 0) => number(1).minus(dice.wave(&[ANGLE])),
        ("waves", 1) => square(dice.wave(&[ANGLE])).plus(square(a)),
        ("waves", 2) => number(2).plus(dice.wave(&[ANGLE])).plus(dice.wave(&[ANGLE])),
        ("waves", 3) => {
            let wave = dice.wave(&[ANGLE]);
            square(a.clone()).minus(number(2).times(a).times(wave)).plus(number(1))
        }
        ("waves", _) => dice.wave(&[ANGLE]).plus(dice.wave(&[ANGLE]).times(E::integer(dice.factor()))),
        (_, 0) => a.clone().of(Function::Exp).minus(a).minus(number(1)),
        (_, 1) => a.clone().minus(a.of(Function::Sin)).power(2),
        (_, 2) => square(a.clone()).plus(number(1)).of(Function::Sqrt).minus(a),
        (_, 3) => a.clone().minus(number(1)).minus(a.of(Function::Log)),
        (_, _) => dice.transcendental(&PLAIN).plus(dice.transcendental(&PLAIN)),
    };
    let spoiled = match dice.below(4) {
        0 => {
            base.minus(E::Number(RBig::from(dice.between(1, 9)) / RBig::from(dice.one_of(&[1i64, 10, 100]))))
        }
        1 => base.plus(E::Number(RBig::from(1) / RBig::from(100))),
        _ => base,
    };
    let sign = dice.one_of(&[">=", ">=", ">", "!=", "<"]);
    if dice.once_in(4) {
        let flipped = match sign {
            ">=" => "<=",
            ">" => "<",
            "<" => ">",
            other => other,
        };
        return Inequality { left: number(0), sign: flipped, right: spoiled };
    }
    Inequality { left: spoiled, sign, right: number(0) }
}
