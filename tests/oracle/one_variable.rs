//! Inequalities that are decided completely: polynomials in one variable, and of degree two in several. The witness makes them as products
//! whose zeros it has chosen, or as sums of squares whose least value it has chosen, multiplies them out, and knows each answer before it asks.

use super::dice::Dice;
use super::findings::{Findings, seed};
use super::library::{Word, verdicts};
use std::cmp::Ordering;

/// A factor whose signs are known.
#[derive(Clone, Debug)]
enum Factor {
    /// `bottom x - top`
    Line { top: i128, bottom: i128 },
    /// `x^2 - radicand`, which is no square
    Pair { radicand: i128 },
    /// `x^2 + b x + c` with `b^2 < 4 c`
    Positive { b: i128, c: i128 },
}

/// A place of the line: a fraction, or plus or minus a square root.
#[derive(Clone, Debug, PartialEq)]
enum Place {
    Fraction(i128, i128),
    Root { negative: bool, radicand: i128 },
}

impl Place {
    fn near(&self) -> f64 {
        match self {
            Place::Fraction(top, bottom) => *top as f64 / *bottom as f64,
            Place::Root { negative, radicand } => {
                if *negative {
                    -(*radicand as f64).sqrt()
                } else {
                    (*radicand as f64).sqrt()
                }
            }
        }
    }

    /// Compared with a fraction, whose denominator is positive.
    fn compare(&self, top: i128, bottom: i128) -> Ordering {
        match self {
            Place::Fraction(own, below) => (own * bottom).cmp(&(top * below)),
            Place::Root { negative: false, radicand } if top > 0 => {
                (radicand * bottom * bottom).cmp(&(top * top))
            }
            Place::Root { negative: false, .. } => Ordering::Greater,
            Place::Root { negative: true, radicand } if top < 0 => {
                (top * top).cmp(&(radicand * bottom * bottom))
            }
            Place::Root { negative: true, .. } => Ordering::Less,
        }
    }
}

impl Factor {
    fn drawn(dice: &mut Dice) -> Factor {
        match dice.below(5) {
            0 => Factor::Pair { radicand: dice.one_of(&[2, 3, 5, 6, 7]) },
            1 => {
                let b = i128::from(dice.between(-3, 3));
                Factor::Positive { b, c: b * b / 4 + i128::from(dice.between(1, 4)) }
            }
            _ => {
                Factor::Line { top: i128::from(dice.between(-6, 6)), bottom: i128::from(dice.between(1, 3)) }
            }
        }
    }

    fn coefficients(&self) -> Vec<i128> {
        match self {
            Factor::Line { top, bottom } => vec![-top, *bottom],
            Factor::Pair { radicand } => vec![-radicand, 0, 1],
            Factor::Positive { b, c } => vec![*c, *b, 1],
        }
    }

    fn sign(&self, place: &Place) -> Ordering {
        match (self, place) {
            (Factor::Line { top, bottom }, _) => place.compare(*top, *bottom),
            (Factor::Pair { radicand }, Place::Root { radicand: own, .. }) => own.cmp(radicand),
            (Factor::Pair { radicand }, Place::Fraction(top, bottom)) => {
                (top * top).cmp(&(radicand * bottom * bottom))
            }
            (Factor::Positive { .. }, _) => Ordering::Greater,
        }
    }

    fn zeros(&self) -> Vec<Place> {
        match self {
            Factor::Line { top, bottom } => vec![Place::Fraction(*top, *bottom)],
            Factor::Pair { radicand } => {
                [true, false].map(|negative| Place::Root { negative, radicand: *radicand }).to_vec()
            }
            Factor::Positive { .. } => Vec::new(),
        }
    }
}

/// A product of powers of factors, times a sign, and what is said of it.
#[derive(Clone, Debug)]
struct Relation {
    negative: bool,
    factors: Vec<(Factor, usize)>,
    sign: &'static str,
}

impl Relation {
    fn drawn(dice: &mut Dice, most: usize, signs: &[&'static str]) -> Relation {
        let mut factors = Vec::new();
        let mut degree = 0;
        for _ in 0..=dice.below(most) {
            let (factor, power) = (Factor::drawn(dice), 1 + dice.below(3));
            degree += (factor.coefficients().len() - 1) * power;
            if degree <= 12 {
                factors.push((factor, power));
            }
        }
        Relation { negative: dice.once_in(2), factors, sign: dice.one_of(signs) }
    }

    fn text(&self) -> String {
        let one = vec![if self.negative { -1 } else { 1 }];
        let product = self.factors.iter().fold(one, |product, (factor, power)| {
            (0..*power).fold(product, |product, _| multiplied(&product, &factor.coefficients()))
        });
        let terms: Vec<String> =
            product.iter().enumerate().rev().map(|(power, value)| format!("({value})*x^{power}")).collect();
        format!("{} {} 0", terms.join(" + "), self.sign)
    }

    fn holds(&self, place: &Place) -> bool {
        let mut sign = if self.negative { Ordering::Less } else { Ordering::Greater };
        for (factor, power) in &self.factors {
            match factor.sign(place) {
                Ordering::Equal => sign = Ordering::Equal,
                Ordering::Less if power % 2 == 1 => sign = sign.reverse(),
                _ => {}
            }
        }
        holds(self.sign, sign)
    }
}

fn holds(relation: &str, sign: Ordering) -> bool {
    match relation {
        "<" => sign.is_lt(),
        "<=" => sign.is_le(),
        ">" => sign.is_gt(),
        ">=" => sign.is_ge(),
        _ => sign.is_ne(),
    }
}

fn multiplied(a: &[i128], b: &[i128]) -> Vec<i128> {
    let mut product = vec![0; a.len() + b.len() - 1];
    for (i, x) in a.iter().enumerate() {
        for (j, y) in b.iter().enumerate() {
            product[i + j] += x * y;
        }
    }
    product
}

/// All zeros of some relations, and fractions before, between and behind them.
fn places(relations: &[&Relation]) -> Vec<Place> {
    let zeros =
        relations.iter().flat_map(|relation| &relation.factors).flat_map(|(factor, _)| factor.zeros());
    let mut found: Vec<Place> = zeros.collect();
    found.sort_by(|a, b| a.near().total_cmp(&b.near()));
    let near: Vec<f64> = found.iter().map(Place::near).collect();
    let scale = 1 << 20;
    let fraction = |x: f64| Place::Fraction((x * scale as f64).round() as i128, scale);
    found.extend(near.windows(2).map(|pair| fraction((pair[0] + pair[1]) / 2.0)));
    found.push(fraction(near.first().copied().unwrap_or(0.0) - 1.0));
    found.push(fraction(near.last().copied().unwrap_or(0.0) + 1.0));
    found
}

#[test]
fn polynomials_in_one_variable() {
    let found = Findings::of("polynomials in one variable", 400, one_polynomial);
    found.assert_no_fault("polynomials_in_one_variable");
    if found.is_whole() {
        for (class, what) in
            [("free", "proved"), ("free", "refuted"), ("on a set", "proved"), ("on a set", "refuted")]
        {
            assert!(found.counted(class, what) > 20, "{class}: only {} {what}", found.counted(class, what));
        }
    }
}

fn one_polynomial(case: u64, findings: &mut Findings) {
    let mut dice = Dice::new(seed() ^ 0x1f5, case);
    let mut claim = Relation::drawn(&mut dice, 4, &["<", "<=", ">", ">=", "!="]);
    let given: Vec<Relation> =
        (0..dice.below(3)).map(|_| Relation::drawn(&mut dice, 2, &["<", "<=", ">", ">="])).collect();
    // half of them are true where the factors that change their sign are given away
    if dice.once_in(2) {
        for (factor, power) in &mut claim.factors {
            if !matches!(factor, Factor::Positive { .. }) {
                *power += *power % 2;
            }
        }
    }
    let condition: Vec<String> = given.iter().map(Relation::text).collect();
    let place = if given.is_empty() { String::new() } else { format!(" where {}", condition.join(", ")) };
    let text =
        format!("system \"line\"\nstate x\ndrift f\n  x' = 0\noutput x\nclaim c: {}{place}\n", claim.text());
    let class = if given.is_empty() { "free" } else { "on a set" };
    let said = match verdicts(&text) {
        Ok(said) => said,
        Err(why) => return findings.fault("no verdict", why, &text),
    };
    let relations: Vec<&Relation> = std::iter::once(&claim).chain(&given).collect();
    let inside: Vec<Place> =
        places(&relations).into_iter().filter(|place| given.iter().all(|other| other.holds(place))).collect();
    if inside.is_empty() {
        return match said[0].word {
            Word::Undecided => findings.count(class, "of nothing"),
            _ => findings.fault("a verdict on an empty set", said[0].why.clone(), &text),
        };
    }
    let wrong = inside.iter().find(|place| !claim.holds(place));
    match (said[0].word, wrong) {
        (Word::Proved, None) => findings.count(class, "proved"),
        (Word::Refuted, Some(_)) => findings.count(class, "refuted"),
        // what is decided completely is never left open
        (Word::Undecided, None) => findings.fault("true, and undecided", said[0].why.clone(), &text),
        (Word::Undecided, Some(place)) => {
            findings.fault("false, and undecided", format!("{place:?}: {}", said[0].why), &text)
        }
        (Word::Proved, Some(place)) => findings.fault("proved, and false", format!("at {place:?}"), &text),
        (Word::Refuted, None) => findings.fault("refuted, and true", said[0].why.clone(), &text),
    }
    if let (Word::Refuted, Some(witness)) = (said[0].word, &said[0].witness)
        && let Some(place) = witness.state.first().and_then(|(_, value)| read(value))
        && (claim.holds(&place) || !given.iter().all(|other| other.holds(&place)))
    {
        findings.fault("a witness that is none", format!("{place:?}"), &text);
    }
}

/// A fraction as it is printed; nothing of what is irrational.
fn read(text: &str) -> Option<Place> {
    let (top, bottom) = text.split_once('/').unwrap_or((text, "1"));
    let fraction = Place::Fraction(top.parse().ok()?, bottom.parse().ok()?);
    // products of such numbers have to fit
    (top.len() < 9 && bottom.len() < 9).then_some(fraction)
}

#[test]
fn polynomials_of_degree_two() {
    let found = Findings::of("polynomials of degree two", 300, one_quadric);
    found.assert_no_fault("polynomials_of_degree_two");
    if found.is_whole() {
        for what in ["proved", "refuted"] {
            assert!(
                found.counted("degree two", what) > 50,
                "only {} {what}",
                found.counted("degree two", what)
            );
        }
    }
}

/// `sum of d_i l_i^2 + m`, where the forms `l_i` are those of a triangular matrix with ones on its diagonal, so that they vanish together.
fn one_quadric(case: u64, findings: &mut Findings) {
    let mut dice = Dice::new(seed() ^ 0x2b7, case);
    let names = ["x", "y", "z", "1"];
    let forms = 1 + dice.below(3);
    let least = i128::from(dice.between(-2, 2));
    let weights: Vec<i128> =
        (0..forms).map(|_| if dice.once_in(4) { -1 } else { i128::from(dice.between(1, 3)) }).collect();
    let mut sums = [[0i128; 4]; 4];
    sums[3][3] = least;
    for (i, weight) in weights.iter().enumerate() {
        let mut form = [0i128; 4];
        form[i] = 1;
        for entry in &mut form[i + 1..] {
            *entry = i128::from(dice.between(-3, 3));
        }
        for (j, a) in form.iter().enumerate() {
            for (k, b) in form.iter().enumerate() {
                sums[j.min(k)][j.max(k)] += weight * a * b;
            }
        }
    }
    let mut terms = Vec::new();
    for (j, row) in sums.iter().enumerate() {
        for (k, value) in row.iter().enumerate().filter(|(_, value)| **value != 0) {
            terms.push(format!("({value})*{}*{}", names[j], names[k]));
        }
    }
    let sign = dice.one_of(&[">", ">="]);
    // a product of two forms that are independent takes all values, whatever is linear beside it
    if dice.once_in(4) {
        let numbers: Vec<i64> = (0..5).map(|_| dice.between(-3, 3)).collect();
        let [a, b, c, d, e] = numbers[..] else { return };
        let text = format!(
            "system \"form\"\nstate x, y, z\ndrift f\n  others' = 0\noutput x\n\
             claim c: (x + ({a})*z)*(y + ({b})*z) + ({c})*x + ({d})*y + ({e}) {sign} 0\n"
        );
        return match verdicts(&text) {
            Err(why) => findings.fault("no verdict", why, &text),
            Ok(said) if said[0].word == Word::Refuted => findings.count("degree two", "refuted"),
            Ok(said) => findings.fault("another verdict", said[0].why.clone(), &text),
        };
    }
    let sum = if terms.is_empty() { "0".to_owned() } else { terms.join(" + ") };
    let text = format!(
        "system \"form\"\nstate x, y, z\ndrift f\n  others' = 0\noutput x\nclaim c: {sum} {sign} 0\n"
    );
    let is_true = weights.iter().all(|weight| *weight > 0) && (least > 0 || least == 0 && sign == ">=");
    match verdicts(&text) {
        Err(why) => findings.fault("no verdict", why, &text),
        Ok(said) => match (said[0].word, is_true) {
            (Word::Proved, true) => findings.count("degree two", "proved"),
            (Word::Refuted, false) => findings.count("degree two", "refuted"),
            (word, _) => findings.fault("another verdict", format!("{word:?}: {}", said[0].why), &text),
        },
    }
}
