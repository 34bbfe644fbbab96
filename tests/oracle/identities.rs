//! Random identities: true ones by rewriting, near misses, terms that exist on a thin set or nowhere, Lie derivatives and
//! differentials by our own rules.

use super::dice::Dice;
use super::expression::{Expression, Function, Symbol};
use super::findings::{Findings, seed};
use super::library::{Said, Word, verdicts};
use super::number::Number;
use super::point::{Compared, Coordinate, Point};
use super::rewriting::Alphabet;
use super::system::{Field, Model, Role};
use super::witness::{Equation, Standing, examine};
use Expression as E;
use dashu::rational::RBig;

/// A claim with what we know of it.
struct Claim {
    class: &'static str,
    /// The statement as it stands in the file; a side may be given a name first.
    text: String,
    equation: Equation,
    /// States at which the sides are compared.
    points: Vec<Point>,
    truth: Truth,
}

/// What is known of a claim by its construction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Truth {
    /// It holds wherever both sides exist.
    Holds,
    /// One of the sides exists nowhere, so that nothing may be said.
    Nowhere,
    /// Only the states tell.
    Open,
}

#[test]
fn identities_and_near_misses() {
    let found = Findings::of("identities and near misses", 500, one_case);
    found.assert_no_fault("identities_and_near_misses");
    if found.is_whole() {
        let (proved, open) = (found.counted("true", "proved"), found.counted("true", "undecided"));
        assert!(proved > 50 && open < proved, "{proved} proved, {open} undecided");
        let (refuted, open) =
            (found.counted("near miss", "refuted"), found.counted("near miss", "undecided"));
        assert!(refuted > 100 && open * 4 < refuted, "{refuted} refuted, {open} undecided");
        for class in ["exists nowhere", "exists on a thin set", "at a point", "Lie derivative"] {
            let tried: u64 = ["proved", "refuted", "undecided"].iter().map(|w| found.counted(class, w)).sum();
            assert!(tried > 50, "{class}: only {tried} tried");
        }
    }
}

fn one_case(case: u64, findings: &mut Findings) {
    let mut dice = Dice::new(seed() ^ 0x1de4, case);
    let model = model(&mut dice);
    let plain: Vec<Symbol> =
        model.symbols().into_iter().filter(|name| !model.angles.contains(name)).collect();
    let alphabet = Alphabet { plain, angles: model.angles.clone(), functions: dice.once_in(2) };
    let mut claims = Vec::new();
    let term = alphabet.term(&mut dice);
    let points: Vec<Point> = (0..14).map(|_| some_point(&model, &mut dice)).collect();
    let same = alphabet.rewritten(&term, 1 + case as usize % 6, &mut dice);
    let push = |claims: &mut Vec<Claim>, class, left: &E, right: &E, truth| {
        let equation = Equation::new(left.clone(), right.clone());
        claims.push(Claim { class, text: equation.text(), equation, points: points.clone(), truth });
    };
    push(&mut claims, "true", &term, &same, Truth::Holds);
    for _ in 0..2 {
        push(&mut claims, "near miss", &term, &alphabet.near_miss(&same, &mut dice), Truth::Open);
    }
    claims.push(at_a_point(&alphabet, &term, &same, &mut dice));
    claims.extend(nowhere(&alphabet, &term, &mut dice));
    claims.extend(thin(&alphabet, &mut dice));
    lie(&model, &term, &alphabet, &points, &mut dice, &mut claims);
    claims.push(determinant(&alphabet, &points, &mut dice));

    let mut text = model.text();
    let entries: Vec<String> = claims
        .iter()
        .enumerate()
        .map(|(place, claim)| {
            let whole = claim.equation.text();
            if claim.text == whole && dice.once_in(3) {
                let (left, right) = (claim.equation.left.text(), claim.equation.right.text());
                format!("let v{place} = {left}\nclaim c{place}: v{place} = {right}\n")
            } else {
                format!("claim c{place}: {}\n", claim.text)
            }
        })
        .collect();
    text.push_str(&entries.concat());
    match verdicts(&text) {
        Err(why) => findings.fault("a file is not answered", why, &text),
        Ok(said) => {
            for ((claim, entry), said) in claims.iter().zip(&entries).zip(&said) {
                judge(claim, said, &format!("{}{entry}", model.text()), findings);
            }
        }
    }
}

fn model(dice: &mut Dice) -> Model {
    let states = vec!["x", "y"];
    let mut rates = vec![dice.polynomial(&states, 2, 2), dice.polynomial(&states, 1, 2)];
    if dice.once_in(4) {
        rates[0] = dice.monomial(&states, 1).over(dice.divisor(&states));
    }
    let mut model = Model { states, fields: vec![Field::new("f", Role::Drift, rates)], ..Model::default() };
    let value = dice.one_of(&[None, Some("2"), Some("0")]);
    model.parameters = vec![("k", value.map(str::to_owned))];
    if dice.once_in(2) {
        model.parameters.extend([("phi", None), ("psi", None)]);
        model.angles = vec!["phi", "psi"];
    }
    model
}

/// A state, special in some of its coordinates.
fn some_point(model: &Model, dice: &mut Dice) -> Point {
    let mut point = dice.generic_point(model);
    for name in model.symbols() {
        if !model.angles.contains(&name) && dice.once_in(6) {
            let value = dice.special();
            point.put(name, Coordinate::Number(Number::Rational(value)));
        }
    }
    point
}

/// Both sides at a value of one symbol, which may be a pole of theirs.
fn at_a_point(alphabet: &Alphabet, left: &E, right: &E, dice: &mut Dice) -> Claim {
    let name = alphabet.plain[0];
    let value = if dice.once_in(2) { dice.special() } else { RBig::from(dice.between(-5, 5)) };
    let put = |e: &E| e.with(name, &E::Number(value.clone()));
    let equation = Equation::new(put(left), put(right));
    let text = format!("(({}) at {{{name} = {value}}}) = {}", left.text(), equation.right.text());
    let points = (0..8)
        .map(|_| {
            let mut point = Point::default();
            for name in alphabet.plain.iter().chain(&alphabet.angles) {
                let number = dice.generic();
                let coordinate = if alphabet.angles.contains(name) {
                    Coordinate::from_half_tangent(&number)
                } else {
                    Coordinate::Number(Number::Rational(number))
                };
                point.put(name, coordinate);
            }
            point
        })
        .collect();
    Claim { class: "at a point", text, equation, points, truth: Truth::Holds }
}

fn nowhere(alphabet: &Alphabet, term: &E, dice: &mut Dice) -> Vec<Claim> {
    let gap = alphabet.nowhere(dice);
    let zero = || E::integer(0);
    let pairs = [
        (gap.clone(), gap.clone()),
        (zero().times(gap.clone()), zero()),
        (gap.clone().minus(gap.clone()), zero()),
        (gap.clone().power(0), E::integer(1)),
        (zero().over(gap.clone()), zero()),
        (term.clone().plus(zero().times(gap.clone())), term.clone()),
        (gap.clone().power(2), zero()),
        (gap.clone().power(-1), E::integer(3)),
        (gap, term.clone()),
    ];
    (0..2)
        .map(|_| {
            let (left, right) = dice.one_of(&pairs);
            let (left, right) = if dice.once_in(2) { (left, right) } else { (right, left) };
            let equation = Equation::new(left, right);
            let text = equation.text();
            Claim { class: "exists nowhere", text, equation, points: Vec::new(), truth: Truth::Nowhere }
        })
        .collect()
}

/// Terms that exist where `t = 0` only, and sides that agree there, or do not.
fn thin(alphabet: &Alphabet, dice: &mut Dice) -> Vec<Claim> {
    let (name, other) = (alphabet.plain[0], alphabet.plain[1]);
    let value = RBig::from(dice.between(-2, 3));
    let t = E::Symbol(name).minus(E::Number(value.clone()));
    let root = |e: E| e.of(Function::Sqrt);
    let one = || E::integer(1);
    let gate = match dice.below(6) {
        0 => root(t.clone().power(2).negated()),
        1 => root(t.clone()).times(root(t.clone().negated())),
        2 => one().plus(t.clone().power(2)).of(Function::Acos),
        3 => root(t.clone()).plus(root(t.clone().negated())),
        4 => root(t.clone().power(2).times(E::Symbol(other).power(2).plus(one())).negated()),
        _ => one().plus(t.clone().power(2)).of(Function::Asin).minus(E::Pi.over(E::integer(2))),
    };
    let a = dice.polynomial(&alphabet.plain, 2, 2);
    let offset = dice.one_of(&[0, 0, 1]);
    let b = a.clone().plus(t.times(dice.monomial(&alphabet.plain, 1))).plus(E::integer(offset));
    let equation = Equation::new(gate.plus(a), b);
    let points = (0..4)
        .map(|_| {
            let mut point = Point::default();
            for symbol in &alphabet.plain {
                let number = if *symbol == name { value.clone() } else { dice.generic() };
                point.put(symbol, Coordinate::Number(Number::Rational(number)));
            }
            point
        })
        .collect();
    let truth = if offset == 0 { Truth::Holds } else { Truth::Open };
    vec![Claim { class: "exists on a thin set", text: equation.text(), equation, points, truth }]
}

/// `L(f, e)`, and `d(e)` multiplied by a vector, beside what our rules of derivation make of them.
fn lie(
    model: &Model,
    term: &E,
    alphabet: &Alphabet,
    points: &[Point],
    dice: &mut Dice,
    claims: &mut Vec<Claim>,
) {
    let mut sum = E::integer(0);
    for (name, rate) in model.states.iter().zip(&model.fields[0].rates) {
        sum = sum.plus(term.derivative(name).times(rate.clone()));
    }
    let mut push = |right: &E, truth| {
        let text = format!("L(f, {}) = {}", term.text(), right.text());
        // the derivative may exist where the term does not: ours is written so that both are asked for
        let left = sum.clone().plus(E::integer(0).times(term.clone()));
        let equation = Equation::new(left, right.clone());
        claims.push(Claim { class: "Lie derivative", text, equation, points: points.to_vec(), truth });
    };
    push(&sum, Truth::Holds);
    push(&alphabet.near_miss(&sum, dice), Truth::Open);
}

/// A determinant of two rows, written out; multiplied by that of the inverse it is one, unless it vanishes everywhere.
fn determinant(alphabet: &Alphabet, points: &[Point], dice: &mut Dice) -> Claim {
    let [a, b, c] = [(); 3].map(|()| alphabet.term(dice));
    let dependent = dice.once_in(3);
    let d = if dependent { b.clone().times(c.clone()).over(a.clone()) } else { alphabet.term(dice) };
    let matrix = format!("[{}, {}; {}, {}]", a.text(), b.text(), c.text(), d.text());
    let written = a.times(d).minus(b.times(c));
    let class = "determinant";
    if dice.once_in(2) {
        let right = if dice.once_in(2) { alphabet.near_miss(&written, dice) } else { written.clone() };
        let truth = if right == written { Truth::Holds } else { Truth::Open };
        let text = format!("det({matrix}) = {}", right.text());
        let equation = Equation::new(written, right);
        return Claim { class, text, equation, points: points.to_vec(), truth };
    }
    let text = format!("det({matrix})*det(inverse({matrix})) = 1");
    let left = written.clone().over(written);
    let truth = if dependent { Truth::Nowhere } else { Truth::Holds };
    Claim { class, text, equation: Equation::new(left, E::integer(1)), points: points.to_vec(), truth }
}

fn judge(claim: &Claim, said: &Said, text: &str, findings: &mut Findings) {
    let compared: Vec<Compared> = claim.points.iter().map(|point| claim.equation.at(point)).collect();
    let at = |what: Compared| compared.iter().position(|found| *found == what);
    let differs = at(Compared::Differ);
    let exists = at(Compared::Equal).is_some() || differs.is_some();
    if claim.truth != Truth::Open
        && let Some(place) = differs
    {
        let detail = format!("they differ at {}", claim.points[place].text());
        return findings.fault("the oracle contradicts itself", detail, text);
    }
    let class = match (claim.class, differs) {
        ("near miss" | "Lie derivative" | "determinant", None) if claim.truth == Truth::Open => {
            "a miss that may hold"
        }
        (class, _) => class,
    };
    match said.word {
        Word::Proved => {
            if let Some(place) = differs {
                let detail = format!("proved ({}), and false at {}", said.why, claim.points[place].text());
                return findings.fault(&format!("{class}: a false identity is proved"), detail, text);
            }
            if claim.truth == Truth::Nowhere {
                return findings.fault("what exists nowhere is proved", said.why.clone(), text);
            }
            findings.count(class, if exists { "proved" } else { "proved, at no state that we tried" });
        }
        Word::Refuted => {
            let shown = format!("{:?}", said.witness);
            if claim.truth == Truth::Holds {
                return findings.fault(&format!("{class}: a true identity is refuted"), shown, text);
            }
            if claim.truth == Truth::Nowhere {
                return findings.fault("what exists nowhere is refuted", shown, text);
            }
            match examine(said, &claim.equation, &[]) {
                Standing::Good => findings.count(class, "refuted"),
                Standing::Incomplete => findings.count(class, "refuted, by part of a state"),
                Standing::Unclear => findings.count(class, "refuted, unclear to us"),
                Standing::Bad(why) => {
                    findings.fault("a witness that is none", format!("{why}; {shown}"), text);
                }
            }
        }
        Word::Undecided => findings.undecided(class, &said.why),
    }
}
