//! Ranks at all states but those of named sets, and the sets on which a rank drops: at many states, chosen on such sets, the
//! witness evaluates the matrix exactly and compares.

use super::dice::Dice;
use super::expression::{Expression, Function, Symbol};
use super::findings::{Findings, seed};
use super::library::{Said, Word, drops, verdicts};
use super::number::{Number, Trouble};
use super::point::{Compared, Coordinate, Point, compare};
use super::rank::{rank, ranks};
use super::reading::read_expression;
use super::series::value;
use super::system::{Field, Model, Role};
use Expression as E;
use dashu::rational::RBig;
use palmistry::drops::{DropAnswer, DropSet};

/// At so many states a claim is tried.
const STATES: usize = 200;

const CLASSES: [&str; 5] = ["polynomials", "an angle", "two angles", "quotients and roots", "inequalities"];

/// Numbers of which states are made: on the pool's lines, circles and quadrics many of them meet.
const NUMBERS: [(i64, i64); 12] =
    [(0, 1), (0, 1), (0, 1), (1, 1), (1, 1), (-1, 1), (-1, 1), (2, 1), (-2, 1), (1, 2), (3, 5), (-4, 5)];

fn symbols(class: &str) -> (Vec<Symbol>, Vec<Symbol>) {
    match class {
        "an angle" => (vec!["x", "y", "z"], vec!["phi"]),
        "two angles" => (vec!["x", "y"], vec!["phi", "psi"]),
        _ => (vec!["x", "y", "z"], Vec::new()),
    }
}

/// Simple factors that vanish somewhere, or nowhere.
fn factor(dice: &mut Dice, plain: &[Symbol], angles: &[Symbol]) -> E {
    let [a, b, c] = [(); 3].map(|()| E::Symbol(dice.one_of(plain)));
    let one = || E::integer(1);
    if !angles.is_empty() && dice.once_in(2) {
        let angle = E::Symbol(dice.one_of(angles));
        let other = E::Symbol(dice.one_of(angles));
        let (sine, cosine) = (angle.clone().of(Function::Sin), angle.clone().of(Function::Cos));
        let half = |more: E, less: E| {
            let (more, less) =
                (more.times(one().plus(cosine.clone())), less.times(one().minus(cosine.clone())));
            more.minus(less)
        };
        return match dice.below(11) {
            0 => sine,
            1 => cosine,
            2 => one().minus(cosine),
            3 => one().plus(cosine),
            4 => a.times(cosine).minus(b.times(sine)),
            5 => half(a.power(2), b.power(2)),
            6 => half(a, b),
            7 if angle != other => angle.minus(other).of(Function::Sin),
            8 if angle != other => angle.minus(other).of(Function::Cos),
            9 => sine.minus(one()),
            _ => a.times(sine),
        };
    }
    match dice.below(16) {
        0..=4 => a,
        5 => a.minus(one()),
        6 => a.plus(b),
        7 => a.power(2).minus(b),
        8 => a.times(b).minus(one()),
        9 => a.power(2).plus(b.power(2)),
        10 => a.power(2).plus(b.power(2)).minus(one()),
        11 => a.power(2).plus(one()),
        12 => a.times(b).minus(c.power(2)),
        // the umbrella of Whitney, and one of Cartan: their real points have parts of several dimensions
        13 => a
            .clone()
            .power(2)
            .plus(b.clone().power(2))
            .times(c)
            .plus(a.power(2))
            .plus(b.power(2).times(E::integer(2))),
        14 => a.power(2).minus(b.times(c.power(2))),
        _ => a.power(2).times(b).minus(c.power(2)),
    }
}

/// A state of simple numbers; angles at zero, half and quarter turns, and of right triangles.
fn state(dice: &mut Dice, plain: &[Symbol], angles: &[Symbol]) -> Point {
    let mut point = Point::default();
    let mut last = RBig::ONE;
    for name in plain {
        let (top, bottom) = dice.one_of(&NUMBERS);
        let number = match dice.below(8) {
            0 => last.clone(),
            1 => &last * &last,
            2 => -last.clone(),
            _ => RBig::from(top) / RBig::from(bottom),
        };
        last = number.clone();
        point.put(name, Coordinate::Number(Number::Rational(number)));
    }
    let rational = |(top, bottom): (i64, i64)| RBig::from(top) / RBig::from(bottom);
    let turns = [(0, 1), (0, -1), (0, -1), (1, 0), (-1, 0)].map(|(s, c)| ((s, 1), (c, 1)));
    let mut known: Option<(RBig, RBig)> = None;
    for name in angles {
        let (sine, cosine) = match (dice.below(6), &known) {
            (0, _) => ((3, 5), (4, 5)),
            (1, _) => ((-4, 5), (3, 5)),
            _ => dice.one_of(&turns),
        };
        let mut own = (rational(sine), rational(cosine));
        if let Some(known) = &known
            && dice.once_in(3)
        {
            own = known.clone();
        }
        known = Some(own.clone());
        point.put(name, Coordinate::Angle { sine: own.0, cosine: own.1 });
    }
    point
}

/// What is claimed, and how it is written.
struct Claim {
    matrix: Vec<Vec<E>>,
    conditions: Vec<(E, &'static str)>,
    sets: Vec<Vec<E>>,
    rank: usize,
}

impl Claim {
    fn drawn(class: &str, dice: &mut Dice) -> Claim {
        let (plain, angles) = symbols(class);
        let mut pool: Vec<E> = (0..4).map(|_| factor(dice, &plain, &angles)).collect();
        pool.extend([E::Symbol(dice.one_of(&plain)), E::Symbol(dice.one_of(&plain))]);
        let (height, width) = dice.one_of(&[(1, 1), (2, 1), (1, 2), (2, 2), (2, 2), (3, 2)]);
        let entry = |dice: &mut Dice| match dice.below(6) {
            0 => E::integer(0),
            1 => E::integer(1),
            2 => dice.one_of(&pool).times(dice.one_of(&pool)),
            3 => dice.one_of(&pool).plus(dice.one_of(&pool)),
            _ => dice.one_of(&pool),
        };
        let matrix: Vec<Vec<E>> = (0..height).map(|_| (0..width).map(|_| entry(dice)).collect()).collect();
        let sets = (0..dice.below(4)).map(|_| {
            let equations = 1 + dice.below(2) + dice.below(2);
            (0..equations).map(|_| equation(class, dice, &pool)).collect()
        });
        let sets = sets.collect();
        let mut conditions = Vec::new();
        if class == "inequalities" {
            for _ in 0..1 + dice.below(2) {
                conditions.push((dice.one_of(&pool), dice.one_of(&[">=", "<=", ">", "<", "!=", "="])));
            }
            if dice.once_in(3) {
                let one = dice.one_of(&pool);
                conditions.extend([(one.clone(), ">="), (one, "<=")]);
            }
        }
        let rank = height.min(width) - usize::from(dice.once_in(8));
        Claim { matrix, conditions, sets, rank }
    }

    fn text(&self, id: &str) -> String {
        let rows = self.matrix.iter().map(|row| row.iter().map(E::text).collect::<Vec<_>>().join(", "));
        let matrix: Vec<String> = rows.collect();
        let mut text = format!("claim {id}: rank([{}]) = {}", matrix.join("; "), self.rank);
        let conditions =
            self.conditions.iter().map(|(left, relation)| format!("{} {relation} 0", left.text()));
        let conditions: Vec<String> = conditions.collect();
        if !conditions.is_empty() {
            text.push_str(&format!(" where {}", conditions.join(", ")));
        }
        let set = |set: &Vec<E>| {
            set.iter().map(|left| format!("{} = 0", left.text())).collect::<Vec<_>>().join(", ")
        };
        let sets: Vec<String> = self.sets.iter().map(set).collect();
        match sets.is_empty() {
            true => text.push_str(" everywhere\n"),
            false => text.push_str(&format!(" except where {}\n", sets.join(" or "))),
        }
        text
    }

    /// The rank at a state that the claim is about; nothing at others, and where that is not clear.
    fn rank_at(&self, point: &Point) -> Option<usize> {
        for (left, relation) in &self.conditions {
            if !holds(left, relation, point)? {
                return None;
            }
        }
        for set in &self.sets {
            // where its equations do not exist it is not
            let met: Vec<Option<bool>> = set.iter().map(|left| holds(left, "=", point)).collect();
            if !met.contains(&Some(false)) {
                return None;
            }
        }
        let rows: Result<Vec<Vec<Number>>, Trouble> =
            self.matrix.iter().map(|row| row.iter().map(|entry| value(entry, point)).collect()).collect();
        rank(rows.ok()?).ok()
    }
}

/// The left side of an equation of a set that is left out.
fn equation(class: &str, dice: &mut Dice, pool: &[E]) -> E {
    let own = dice.one_of(pool);
    if class != "quotients and roots" {
        return own;
    }
    let other = dice.one_of(pool);
    match dice.below(5) {
        0 => own.over(other),
        1 => own.times(other.of(Function::Sqrt)),
        2 => own.times(E::integer(0).times(other.of(Function::Sqrt)).plus(E::integer(1))),
        3 => own.times(other.clone()).over(other),
        _ => own,
    }
}

/// Whether a relation to zero holds: not where the left side does not exist. `None` where that is not clear.
fn holds(left: &E, relation: &str, point: &Point) -> Option<bool> {
    let found = match value(left, point) {
        Err(Trouble::Undefined) => return Some(false),
        Err(_) => return None,
        Ok(found) => found,
    };
    let Number::Rational(found) = found else { return None };
    Some(match relation {
        "=" => found.is_zero(),
        "!=" => !found.is_zero(),
        ">" => found > RBig::ZERO,
        ">=" => found >= RBig::ZERO,
        "<" => found < RBig::ZERO,
        _ => found <= RBig::ZERO,
    })
}

#[test]
fn ranks_off_named_sets() {
    let found = Findings::of("ranks off named sets", 300, one_case);
    found.assert_no_fault("ranks_off_named_sets");
    if found.is_whole() {
        for class in CLASSES {
            let (proved, refuted) = (found.counted(class, "proved"), found.counted(class, "refuted"));
            assert!(
                proved > 10 && refuted > 10,
                "{class}: {proved} proved, {refuted} refuted are next to nothing"
            );
        }
    }
}

fn one_case(case: u64, findings: &mut Findings) {
    let mut dice = Dice::new(seed() ^ 0xe5e7, case);
    let class = CLASSES[case as usize % CLASSES.len()];
    let (plain, angles) = symbols(class);
    let all: Vec<Symbol> = [plain.clone(), angles.clone()].concat();
    let mut text = format!("system \"drawn\"\nstate {}\n", all.join(", "));
    if !angles.is_empty() {
        text.push_str(&format!("angle {}\n", angles.join(", ")));
    }
    text.push_str("drift f others' = 0\noutput x\n");
    let claims: Vec<Claim> = (0..6).map(|_| Claim::drawn(class, &mut dice)).collect();
    for (number, claim) in claims.iter().enumerate() {
        text.push_str(&claim.text(&format!("c{number}")));
    }
    match verdicts(&text) {
        Err(why) => findings.fault("claims are not answered", why, &text),
        Ok(said) => {
            for (said, claim) in said.iter().zip(&claims) {
                judge(class, claim, said, &mut dice, findings);
            }
        }
    }
}

fn judge(class: &str, claim: &Claim, said: &Said, dice: &mut Dice, findings: &mut Findings) {
    let (plain, angles) = symbols(class);
    let text = claim.text("c");
    match said.word {
        Word::Undecided => findings.undecided(class, &said.why),
        Word::Proved => {
            findings.count(class, "proved");
            for _ in 0..STATES {
                let point = state(dice, &plain, &angles);
                match claim.rank_at(&point) {
                    Some(found) if found != claim.rank => {
                        let detail = format!("the rank is {found} at {}", point.text());
                        return findings.fault("a rank is proved, and is another", detail, &text);
                    }
                    Some(_) => findings.count(class, "states at which it is as proved"),
                    None => {}
                }
            }
        }
        Word::Refuted => {
            findings.count(class, "refuted");
            let shown = said.witness.as_ref();
            if shown.is_some_and(|shown| shown.is_a_zero()) {
                return findings.count(class, "refuted at a zero");
            }
            let Some(mut point) = shown.and_then(|shown| Point::read(&shown.state)) else {
                return findings.fault("a witness that cannot be read", format!("{said:?}"), &text);
            };
            for name in plain {
                if point.get(name).is_none() {
                    point.put(name, Coordinate::Number(Number::integer(1)));
                }
            }
            let found = claim.rank_at(&point);
            if found.is_none_or(|found| found == claim.rank) {
                let detail = format!("{} is a witness; the rank there: {found:?}", point.text());
                findings.fault(
                    "a witness that meets the claim, or of which it does not speak",
                    detail,
                    &text,
                );
            }
        }
    }
}

#[test]
fn sets_on_which_ranks_drop() {
    let found = Findings::of("sets on which ranks drop", 120, one_system);
    found.assert_no_fault("sets_on_which_ranks_drop");
    if found.is_whole() {
        let (on, off) = (found.total("states on the sets"), found.total("states off them"));
        assert!(on > 1000 && off > 1000, "{on} and {off} states are next to nothing");
    }
}

/// A system at rest, or one that moves and has some of its values given at the beginning.
fn one_system(case: u64, findings: &mut Findings) {
    let mut dice = Dice::new(seed() ^ 0xd209, case);
    let class =
        ["polynomials", "an angle", "two angles", "that moves", "given at the beginning"][case as usize % 5];
    let (plain, angles) = symbols(class);
    let states: Vec<Symbol> = [plain.clone(), angles.clone()].concat();
    let moves = ["that moves", "given at the beginning"].contains(&class);
    let rates = states.iter().map(|_| match moves && dice.once_in(2) {
        true => dice.polynomial(&plain, 2, 1),
        false => E::integer(0),
    });
    let rates = rates.collect();
    let outputs = (0..2 + dice.below(2)).map(|_| match dice.below(3) {
        0 => E::Symbol(dice.one_of(&plain)).times(factor(&mut dice, &plain, &angles)),
        1 => factor(&mut dice, &plain, &angles).times(factor(&mut dice, &plain, &angles)),
        _ => factor(&mut dice, &plain, &angles),
    });
    let outputs = outputs.collect();
    let fields = vec![Field::new("f", Role::Drift, rates)];
    let model = Model { states: states.clone(), angles: angles.clone(), fields, outputs, ..Model::default() };
    let mut text = model.text();
    let mut fixed = Vec::new();
    if class == "given at the beginning" {
        let given = RBig::from(dice.between(-1, 1));
        text.push_str(&format!("initial z = {given}\n"));
        fixed.push(("z", Coordinate::Number(Number::Rational(given))));
    }
    let answer = match drops(&text) {
        Ok(answer) => answer,
        Err(why) if why.starts_with("panicked") => return findings.fault("a panic", why, &text),
        Err(why) => return findings.undecided(class, &why),
    };
    findings.count(class, if answer.is_exact() { "exact" } else { "not exact" });
    for set in &answer.sets {
        if let Some(shown) = &set.state {
            let words: Vec<_> = shown.iter().map(|at| (at.name.clone(), at.exact.clone())).collect();
            let inside = Point::read(&words).and_then(|point| lies_in(set, &point, &states));
            if inside != Some(true) {
                findings.fault("an example that is not in its set", format!("{set:?}"), &text);
            }
        }
    }
    for _ in 0..80 {
        let mut point = state(&mut dice, &plain, &angles);
        fixed.iter().for_each(|(name, at)| point.put(name, at.clone()));
        at_state(class, &model, &answer, &point, &text, findings);
    }
}

/// Whether a state lies in a set as it is printed.
fn lies_in(set: &DropSet, point: &Point, states: &[Symbol]) -> Option<bool> {
    let is = |text: &str| -> Option<bool> {
        let (text, vanishes) = match text.split_once(" != ") {
            Some((left, right)) => (format!("{left} = {right}"), false),
            None => (text.to_owned(), true),
        };
        let (left, right) = text.rsplit_once(" = ")?;
        if right == "pi" {
            let cosine = value(&read_expression(left, states)?.of(Function::Cos), point).ok()?;
            return Some(cosine.add(&Number::integer(1)).is_exact_zero() == vanishes);
        }
        let (left, right) = (read_expression(left, states)?, read_expression(right, states)?);
        match compare(&left, &right, point) {
            Compared::Equal => Some(vanishes),
            Compared::Differ => Some(!vanishes),
            _ => None,
        }
    };
    let mut all = true;
    for text in set.equations.iter().chain(&set.unless) {
        all &= is(text)?;
    }
    Some(all)
}

fn at_state(
    class: &str,
    model: &Model,
    answer: &DropAnswer,
    point: &Point,
    text: &str,
    findings: &mut Findings,
) {
    let known = model.states.len() - answer.dimension;
    let Some(found) = known_rank(model, point, known) else { return };
    let mut lower = false;
    for (set, open) in
        answer.sets.iter().map(|set| (set, false)).chain(answer.open.iter().map(|set| (set, true)))
    {
        if set.equations.iter().chain(&set.unless).any(|text| text.contains("(an expression of ")) {
            return findings.count(class, "states beside a set too long to be written");
        }
        let Some(inside) = lies_in(set, point, &model.states) else {
            return findings.fault("a set that cannot be read", format!("{set:?}"), text);
        };
        if !inside {
            continue;
        }
        lower = true;
        let at_rest = class != "that moves" && class != "given at the beginning";
        if !open
            && (found > set.rank || set.rank >= answer.rank || set.exactly && at_rest && found != set.rank)
        {
            let detail = format!("the rank is {found} at {}, which lies in {set:?}", point.text());
            return findings.fault("a set on which the rank is another", detail, text);
        }
    }
    findings.count(class, if lower { "states on the sets" } else { "states off them" });
    if !lower && answer.out_of_reach.is_none() && found < answer.rank {
        let detail = format!(
            "the rank is {found} and not {} at {}, which lies in none of {:?}",
            answer.rank,
            point.text(),
            answer.sets
        );
        findings.fault("a state at which the rank drops, and which lies in no set", detail, text);
    }
}

/// The rank at a state by all words of a length that suffices nearly always, where `z` has no column if it is known.
fn known_rank(model: &Model, point: &Point, known: usize) -> Option<usize> {
    let longest = if model.fields.iter().all(|field| field.rates.iter().all(|rate| *rate == E::integer(0))) {
        0
    } else {
        model.states.len() + 3
    };
    let mut model = model.clone();
    if known == 0 {
        return ranks(&model, point, longest).ok()?.last().copied();
    }
    // with the known state among the outputs, whose row is that of its column alone, and never differentiated along
    let space = super::series::Space { variables: model.states.clone(), degree: longest as u32 + 1 };
    let at = |e: &E| super::series::series(e, point, &space);
    let rates: Option<Vec<_>> = model.fields.remove(0).rates.iter().map(|rate| at(rate).ok()).collect();
    let rates = rates?;
    let mut last: Vec<_> = model.outputs.iter().map(|e| at(e).ok()).collect::<Option<_>>()?;
    let mut rows = Vec::new();
    for _ in 0..=longest {
        rows.extend(last.iter().map(|word| {
            let mut row = word.gradient(&space);
            row.truncate(2); // z is the last of x, y, z
            row
        }));
        last = last
            .iter()
            .map(|word| {
                rates.iter().enumerate().fold(super::series::Series::default(), |sum, (place, rate)| {
                    sum.add(&rate.multiply(&word.derivative(place), &space))
                })
            })
            .collect();
    }
    rank(rows).ok()
}

/// The examples of issue 32: what was proved and is false, and what is refuted at a state that is none.
#[test]
fn sets_that_were_merged_and_limits_equation_by_equation() {
    let text = "system \"s\" state x, y, theta, phi, a, b, c angle theta, phi\ndrift f others' = 0\noutput x\n\
        claim one: rank([sin(phi), 0; 0, 1]) = 2 except where cos(phi) = 1, sin(phi) = 0\n\
        claim same: rank([sin(phi), 0; 0, 1]) = 2 except where cos(phi) = 1\n\
        claim both: rank([sin(phi), 0; 0, 1]) = 2 except where cos(phi) = 1, sin(phi) = 0 or cos(phi) = -1\n\
        claim cosine: rank([cos(phi)]) = 1 except where cos(phi) = 0, sin(phi) = 1\n\
        claim heading: rank([1, 0; sin(theta), x*cos(theta)]) = 2 except where x = 0 or cos(theta) = 0, sin(theta) = 1\n\
        claim limits: rank([b^2*(1+cos(phi)) - a^2*(1-cos(phi)); c^2*(1+cos(phi)) - a^2*(1-cos(phi))]) = 1 \
        except where b^2*(1+cos(phi)) - a^2*(1-cos(phi)) = 0, b^2 = c^2\n\
        claim limits.all: rank([b^2*(1+cos(phi)) - a^2*(1-cos(phi)); c^2*(1+cos(phi)) - a^2*(1-cos(phi))]) = 1 \
        except where b^2*(1+cos(phi)) - a^2*(1-cos(phi)) = 0, b^2 = c^2 or a = 0, cos(phi) = -1\n\
        claim guard: rank([x*y]) = 1 except where x/y = 0\n\
        claim guard.all: rank([x*y]) = 1 except where x/y = 0 or y = 0\n\
        claim guard.root: rank([x*y]) = 1 except where x = 0 or y*sqrt(-x^2 - 1) = 0\n\
        claim thin: rank([x]) = 1 where x >= 0, x <= 0 except where x = 0\n\
        claim thin.roots: rank([x; 0*sqrt(x); 0*sqrt(-x)]) = 1 except where x = 0\n\
        claim beyond: rank([x]) = 1 where x >= 1 everywhere\n";
    let said = verdicts(text).expect("it is read");
    let words: Vec<(&str, Word)> = said.iter().map(|said| (said.id.as_str(), said.word)).collect();
    use Word::{Proved, Refuted, Undecided};
    assert_eq!(
        words,
        [
            ("one", Refuted),
            ("same", Refuted),
            ("both", Proved),
            ("cosine", Refuted),
            ("heading", Refuted),
            ("limits", Refuted),
            ("limits.all", Proved),
            ("guard", Refuted),
            ("guard.all", Proved),
            ("guard.root", Refuted),
            ("thin", Undecided),
            ("thin.roots", Undecided),
            ("beyond", Proved),
        ]
    );
}

/// `z' = x z` from `z = 0` stays there, and says nothing of `x`: the rank is nought at all states that are asked for.
#[test]
fn values_at_the_beginning_are_met() {
    let text = "system \"s\" state x, z\ndrift f\n  x' = 0\n  z' = x*z\noutput z\ninitial z = GIVEN\n\
        claim none: rank = 0 everywhere\nclaim full: rank = 1 everywhere\n";
    let zero = text.replace("GIVEN", "0");
    let answer = drops(&zero).expect("there is a codistribution");
    assert!(answer.is_exact() && answer.rank == 0 && answer.sets.is_empty(), "{answer:?}");
    assert_eq!(answer.initial, ["z = 0"]);
    let words =
        |text: &str| verdicts(text).expect("it is read").iter().map(|said| said.word).collect::<Vec<_>>();
    assert_eq!(words(&zero), [Word::Proved, Word::Refuted]);
    let one = text.replace("GIVEN", "1");
    let answer = drops(&one).expect("there is a codistribution");
    assert!(answer.is_exact() && answer.rank == 1 && answer.sets.is_empty(), "{answer:?}");
    assert_eq!(words(&one), [Word::Refuted, Word::Proved]);
}
