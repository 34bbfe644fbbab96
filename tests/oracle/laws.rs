//! Laws of elementary functions that any handbook has (Abramowitz and Stegun, chapters 4.1 to 4.4), some of them for
//! part of their domain only; numbers within a tolerance; ranks of matrices.

use super::dice::Dice;
use super::expression::{Binary, Expression, Function, Symbol};
use super::findings::{Findings, seed};
use super::library::{Said, Word, verdicts};
use super::number::{Number, Trouble, float};
use super::point::{Compared, Coordinate, Point};
use super::rank::rank;
use super::series::value;
use super::witness::{Equation, Standing, examine};
use Expression as E;
use dashu::base::Abs;
use dashu::integer::UBig;
use dashu::rational::RBig;

const SYMBOLS: [Symbol; 2] = ["x", "y"];

#[test]
fn laws_numbers_and_matrices() {
    let found = Findings::of("laws, numbers and matrices", 400, one_case);
    found.assert_no_fault("laws_numbers_and_matrices");
    if found.is_whole() {
        for (class, what) in [
            ("a law", "proved"),
            ("constants", "proved"),
            ("a law of part of the domain", "refuted"),
            ("within", "proved"),
            ("within", "refuted"),
            ("rank of a matrix", "proved"),
            ("rank of a matrix", "refuted"),
        ] {
            let count = found.counted(class, what);
            assert!(count > 10, "{class}: only {count} {what}");
        }
        // what functions satisfy is known: what is open are laws of terms that exist nowhere that we know
        let (proved, open) = (found.counted("a law", "proved"), found.counted("a law", "undecided"));
        assert!(open * 8 < proved, "{open} laws are undecided, {proved} proved");
        assert_eq!(found.counted("constants", "undecided"), 0);
    }
}

fn one_case(case: u64, findings: &mut Findings) {
    let mut dice = Dice::new(seed() ^ 0x1a35, case);
    laws(&mut dice, findings);
    constants(&mut dice, findings);
    numbers(&mut dice, findings);
    matrices(&mut dice, findings);
}

fn answered(text: &str, findings: &mut Findings) -> Vec<Said> {
    verdicts(text).unwrap_or_else(|why| {
        findings.fault("a file of laws is not answered", why, text);
        Vec::new()
    })
}

/// The left and right side of a law, and whether it holds wherever both exist.
fn law(x: E, y: E, dice: &mut Dice) -> (E, E, bool) {
    use Function::{Acos, Asin, Atan, Cos, Exp, Log, Sin, Sqrt, Tan};
    let (one, two) = (|| E::integer(1), || E::integer(2));
    let (cx, cy) = (x.clone(), y.clone());
    let square = x.clone().power(2);
    let quarter = || E::Pi.over(E::integer(2));
    use Binary::{Atan2, Max, Min, RealPower};
    use Function::{Abs, Cosh, Sign, Sinh, Tanh};
    let n = || E::integer(2).over(E::integer(3)).plus(y.clone());
    match dice.below(46) {
        28 => (x.clone().of(Abs).power(2), square, true),
        29 => (x.clone().of(Abs), x, false),
        30 => (x.clone().times(y.clone()).of(Abs), x.of(Abs).times(y.of(Abs)), true),
        31 => (x.clone().of(Sign).times(x.clone().of(Abs)), x, true),
        32 => (cx.with_other(Min, cy).plus(x.clone().with_other(Max, y.clone())), x.plus(y), true),
        33 => (cx.with_other(Max, cy), x, false),
        34 => (x.clone().of(Tanh), x.clone().of(Sinh).over(x.of(Cosh)), true),
        // of large arguments the oracle has not the digits to tell it
        35 => (x.of(Sin).of(Cosh).power(2).minus(cx.of(Sin).of(Sinh).power(2)), one(), true),
        36 => (x.clone().plus(x.clone()).of(Sinh), two().times(x.of(Sinh)).times(cx.of(Cosh)), true),
        37 => (
            cx.with_other(RealPower, n()).times(x.clone().with_other(RealPower, n())),
            x.with_other(RealPower, n().plus(n())),
            true,
        ),
        38 => (cx.with_other(RealPower, n()), x, false),
        39 => (cx.with_other(RealPower, n()).of(Log), n().times(x.of(Log)), true),
        40 => (cx.with_other(Atan2, cy).of(Tan), x.over(y), true),
        41 => (cx.with_other(Atan2, cy).of(Cos), y.clone().over(square.plus(y.power(2)).of(Sqrt)), true),
        42 => (cx.with_other(Atan2, cy), x.over(y).of(Atan), false),
        43 => (x.clone().of(Sign).power(2), one(), true),
        44 => (square.of(Log), two().times(x.of(Abs).of(Log)), true),
        45 => (x.clone().of(Sinh), x.of(Tanh), false),
        0 => (square.of(Sqrt), x, false),
        1 => (x.clone().power(4).of(Sqrt), square, true),
        2 => (square.of(Log), two().times(x.of(Log)), true),
        3 => (x.clone().times(y.clone()).of(Log), x.of(Log).plus(y.of(Log)), true),
        4 => (x.clone().plus(y.clone()).of(Exp), x.of(Exp).times(y.of(Exp)), true),
        5 => (x.clone().times(y.clone()).of(Sqrt), x.of(Sqrt).times(y.of(Sqrt)), true),
        6 => (x.clone().over(y.clone()).of(Sqrt), x.of(Sqrt).over(y.of(Sqrt)), true),
        7 => (x.clone().of(Asin).plus(x.of(Acos)), quarter(), true),
        8 => (x.clone().of(Atan).plus(one().over(x).of(Atan)), quarter(), false),
        9 => (x.clone().of(Asin).of(Sin), x, true),
        10 => (x.clone().of(Sin).of(Asin), x, false),
        11 => (x.clone().of(Acos).of(Sin), one().minus(square).of(Sqrt), true),
        12 => (one().minus(x.clone().of(Sin).power(2)).of(Sqrt), x.of(Cos), false),
        13 => (x.clone().of(Exp).of(Log), x, true),
        14 => (x.clone().of(Log).of(Exp), x, true),
        15 => (x.clone().of(Tan).of(Atan), x, false),
        16 => (x.clone().of(Atan).of(Tan), x, true),
        17 => (x.clone().over(square.of(Sqrt)), one(), false),
        18 => (x.clone().of(Acos).of(Cos), x, true),
        19 => (x.clone().of(Cos).of(Acos), x, false),
        20 => (x.clone().of(Log).over(two()).of(Exp), x.of(Sqrt), true),
        21 => (square.of(Sqrt).of(Sqrt), x.of(Sqrt), true),
        22 => (x.of(Sin).power(2).plus(cx.of(Cos).power(2)), one(), true),
        23 => (two().times(x.clone()).of(Sin), two().times(x.of(Sin)).times(cx.of(Cos)), true),
        24 => (x.clone().of(Atan).of(Cos), one().over(one().plus(square).of(Sqrt)), true),
        25 => (
            x.clone().of(Sqrt).minus(y.clone().of(Sqrt)).times(x.of(Sqrt).plus(y.of(Sqrt))),
            cx.minus(cy),
            true,
        ),
        26 => (x.clone().power(2).of(Log), two().times(x.negated().of(Log)), true),
        _ => (x.clone().of(Asin), x.clone().over(one().minus(square).of(Sqrt)).of(Atan), true),
    }
}

fn laws(dice: &mut Dice, findings: &mut Findings) {
    let mut text = "system \"drawn\"\nstate x, y\n".to_owned();
    let mut claims = Vec::new();
    for place in 0..3 {
        let mut inner = || match dice.below(4) {
            0 => dice.polynomial(&SYMBOLS, 1, 2),
            1 => E::Symbol("x").over(E::integer(2)),
            2 => E::Symbol("y"),
            _ => E::Symbol("x"),
        };
        let (x, y) = (inner(), inner());
        let (left, right, holds) = law(x, y, dice);
        let equation = if dice.once_in(2) { Equation::new(left, right) } else { Equation::new(right, left) };
        text.push_str(&format!("claim l{place}: {}\n", equation.text()));
        claims.push((equation, holds));
    }
    for ((equation, holds), said) in claims.iter().zip(&answered(&text, findings)) {
        let false_at = (0..24).map(|_| point(dice)).find(|point| equation.at(point) == Compared::Differ);
        let class = if *holds { "a law" } else { "a law of part of the domain" };
        let line = format!("system \"drawn\"\nstate x, y\nclaim 1: {}\n", equation.text());
        if *holds && let Some(point) = &false_at {
            findings.fault("the oracle contradicts itself on a law", point.text(), &line);
        }
        match (said.word, &false_at) {
            (Word::Proved, Some(point)) => {
                findings.fault("a law is proved that fails", format!("at {}", point.text()), &line);
            }
            (Word::Refuted, _) if *holds => {
                findings.fault("a law is refuted", format!("{:?}", said.witness), &line);
            }
            (Word::Proved, None) => findings.count(class, "proved"),
            (Word::Refuted, _) => match examine(said, equation, &[]) {
                Standing::Bad(why) => findings.fault("a law's witness is none", why, &line),
                _ => findings.count(class, "refuted"),
            },
            (Word::Undecided, _) => findings.undecided(class, &said.why),
        }
    }
}

/// Equations between constants: what 240 digits say is so.
fn constants(dice: &mut Dice, findings: &mut Findings) {
    use Function::{Acos, Asin, Atan, Cos, Exp, Log, Sin, Sqrt};
    let n = |a: i64, b: i64| E::Number(RBig::from(a) / RBig::from(b));
    let part = |b: i64| E::Pi.over(E::integer(b));
    let all = [
        (part(3).of(Cos), n(1, 2)),
        (part(6).of(Sin), n(1, 2)),
        (E::Pi.of(Sin), n(0, 1)),
        (part(4).of(Sin).power(2), n(1, 2)),
        (n(1, 1).of(Atan).times(n(4, 1)), E::Pi),
        // Machin (1706)
        (n(16, 1).times(n(1, 5).of(Atan)).minus(n(4, 1).times(n(1, 239).of(Atan))), E::Pi),
        (n(2, 1).of(Sqrt).times(n(3, 1).of(Sqrt)), n(6, 1).of(Sqrt)),
        (n(4, 1).of(Log), n(2, 1).times(n(2, 1).of(Log))),
        (n(2, 1).of(Log).of(Exp), n(2, 1)),
        (n(1, 1).of(Asin), part(2)),
        (n(-1, 1).of(Acos), E::Pi),
        (n(9, 4).of(Sqrt), n(3, 2)),
        (n(5, 1).plus(n(2, 1).times(n(6, 1).of(Sqrt))).of(Sqrt), n(2, 1).of(Sqrt).plus(n(3, 1).of(Sqrt))),
        (E::Pi, n(355, 113)),
        (E::Pi.times(n(163, 1).of(Sqrt)).of(Exp), E::Number(RBig::from(262_537_412_640_768_744i64))),
    ];
    let (left, right) = dice.one_of(&all);
    let right = if dice.once_in(2) { right } else { right.plus(n(dice.between(-1, 1), 1_000_000)) };
    let equation = Equation::new(left, right);
    let text = format!("system \"drawn\"\nclaim 1: {}\n", equation.text());
    let truth = equation.at(&Point::default());
    for said in answered(&text, findings) {
        match (said.word, truth) {
            (Word::Proved, Compared::Equal) => findings.count("constants", "proved"),
            (Word::Refuted, Compared::Differ) => findings.count("constants", "refuted"),
            (Word::Undecided, _) => findings.undecided("constants", &said.why),
            (word, truth) => {
                findings.fault("constants", format!("{word:?}, and {truth:?} in 240 digits"), &text)
            }
        }
    }
}

fn point(dice: &mut Dice) -> Point {
    let mut found = Point::default();
    for name in SYMBOLS {
        let number = match dice.below(4) {
            0 => RBig::from(dice.between(-9, 9)) / RBig::from(10),
            1 => dice.special(),
            2 => dice.positive(),
            _ => dice.generic(),
        };
        found.put(name, Coordinate::Number(Number::Rational(number)));
    }
    found
}

/// `e at {...} = number within tolerance`, and the same without values, of parameters that have a default: a claim is
/// about all their values, and so no number.
fn numbers(dice: &mut Dice, findings: &mut Findings) {
    let head = "system \"drawn\"\nstate x, y\nparam k = 2\n";
    let e = match dice.below(3) {
        0 => dice.polynomial(&["x", "k"], 2, 3).over(dice.divisor(&["x", "k"])),
        1 => dice.transcendental(&["x", "k"]),
        _ => dice.transcendental(&["x"]).plus(dice.polynomial(&["k"], 2, 2)),
    };
    let (x, k) = (dice.special(), RBig::from(dice.between(1, 3)));
    let rational = |value: &RBig| Coordinate::Number(Number::Rational(value.clone()));
    let at = Point::of([("x", rational(&x)), ("k", rational(&k))]);
    let here = value(&e, &at);
    let near = here.as_ref().map_or(1.0, |value| value.digits().to_f64().value());
    let rounded = RBig::from((near * 1e4).round() as i64) / RBig::from(10_000);
    let tolerance = dice.one_of(&["1/20000", "1/1000", "1/1000000", "0"]);
    let said_number = &rounded + RBig::from(dice.one_of(&[0i64, 0, 1])) / RBig::from(1000);
    let right = E::Number(said_number.clone()).text();
    let claims = [
        format!("claim 1: ({} at {{x = {x}, k = {k}}}) = {right} within {tolerance}\n", e.text()),
        format!("claim 2: ({} at {{x = {x}}}) = {right} within {tolerance}\n", e.text()),
    ];
    let text = format!("{head}{}", claims.concat());
    let answers = answered(&text, findings);
    let [first, second] = answers.as_slice() else { return };
    let room: RBig = tolerance.parse().unwrap_or(RBig::ZERO);
    let truth = here.map(|value| {
        let distance = value.subtract(&Number::Rational(said_number));
        match &distance {
            Number::Rational(d) => d.clone().max(-d.clone()) <= room,
            other => other.digits().abs() <= float(&room),
        }
    });
    let line = format!("{head}{}", claims[0]);
    match (first.word, truth) {
        (Word::Proved, Ok(true)) => findings.count("within", "proved"),
        (Word::Refuted, Ok(false)) => findings.count("within", "refuted"),
        (Word::Undecided, _) => findings.undecided("within", &first.why),
        (_, Err(Trouble::Unclear | Trouble::TooLarge)) => findings.count("within", "unclear to us"),
        (word, truth) => {
            findings.fault("a number is said that is not so", format!("{word:?}, {truth:?}"), &line)
        }
    }
    // to be refuted at the default is to be refuted
    if e.symbols().contains(&"k") && second.word == Word::Proved && !cancels(&e, &x, dice) {
        let detail = "that is so at the default of k, and at few other values";
        findings.fault("a parameter's default proves a claim", detail, &format!("{head}{}", claims[1]));
    }
}

/// Whether an expression does not depend on `k` after all.
fn cancels(e: &E, x: &RBig, dice: &mut Dice) -> bool {
    let at = |dice: &mut Dice| {
        let number = |value: RBig| Coordinate::Number(Number::Rational(value));
        value(e, &Point::of([("x", number(x.clone())), ("k", number(dice.positive()))]))
    };
    match (at(dice), at(dice)) {
        // numbers of 240 digits that differ in none of 200 are meant to be equal
        (Ok(a), Ok(b)) => {
            a.subtract(&b).digits().abs() < float(&RBig::from_parts(1.into(), UBig::from(10u8).pow(200)))
        }
        _ => true,
    }
}

/// `rank([...]) = n` for small matrices with dependent rows, or without.
fn matrices(dice: &mut Dice, findings: &mut Findings) {
    let (rows, columns) = (1 + dice.below(3), 1 + dice.below(3));
    let entry = |dice: &mut Dice| match dice.below(6) {
        0 | 1 => E::integer(dice.between(-1, 1)),
        2 => E::Symbol("x").over(E::Symbol("x")),
        3 => dice.polynomial(&SYMBOLS, 1, 2).over(dice.divisor(&SYMBOLS)),
        _ => dice.polynomial(&SYMBOLS, 2, 2),
    };
    let mut matrix: Vec<Vec<E>> = (0..rows).map(|_| (0..columns).map(|_| entry(dice)).collect()).collect();
    if rows > 1 && dice.once_in(2) {
        // the last row is a multiple of the first
        let factor = dice.polynomial(&SYMBOLS, 1, 2);
        matrix[rows - 1] = matrix[0].iter().map(|e| factor.clone().times(e.clone())).collect();
    }
    let mut truth = None;
    for _ in 0..12 {
        let point = point(dice);
        let numbers: Result<Vec<Vec<Number>>, Trouble> =
            matrix.iter().map(|row| row.iter().map(|e| value(e, &point)).collect()).collect();
        if let Ok(found) = numbers.and_then(rank) {
            truth = truth.max(Some(found));
        }
    }
    let Some(truth) = truth else {
        return findings.count("rank of a matrix", "defined nowhere that we know");
    };
    let lines: Vec<String> =
        matrix.iter().map(|row| row.iter().map(E::text).collect::<Vec<_>>().join(", ")).collect();
    let mut text = "system \"drawn\"\nstate x, y\n".to_owned();
    for n in 0..=rows.min(columns) {
        text.push_str(&format!("claim m{n}: rank([{}]) = {n}\n", lines.join("; ")));
    }
    for (n, said) in answered(&text, findings).iter().enumerate() {
        let detail = format!("rank = {n} is {:?} ({}), and is {truth}", said.word, said.why);
        match (said.word, n == truth) {
            (Word::Proved, true) => findings.count("rank of a matrix", "proved"),
            (Word::Refuted, false) => findings.count("rank of a matrix", "refuted"),
            (Word::Undecided, _) => findings.undecided("rank of a matrix", &said.why),
            _ => findings.fault("the rank of a matrix is said to be another", detail, &text),
        }
    }
}
