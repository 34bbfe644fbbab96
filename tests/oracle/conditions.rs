//! Claims on sets: of each set some states are known, and a claim that fails at one of them may not be proved; what
//! follows from the conditions may not be refuted; and the order of the conditions changes nothing.

use super::condition_sets::{ANGLES, PLAIN, anchor, never, points_on, through};
use super::dice::Dice;
use super::expression::{Expression, Function};
use super::findings::{Findings, seed};
use super::library::{Said, Word, verdicts};
use super::point::{Compared, Point};
use super::rewriting::Alphabet;
use super::series::value;
use super::system::Model;
use super::witness::{Equation, Standing, examine};
use Expression as E;

/// The set of a case, and what is known of it.
struct Set {
    conditions: Vec<Equation>,
    /// States that meet all conditions; none where there are none.
    points: Vec<Point>,
    class: &'static str,
}

#[test]
fn claims_on_sets() {
    let found = Findings::of("claims on sets", 500, one_case);
    found.assert_no_fault("claims_on_sets");
    if found.is_whole() {
        for (class, what) in
            [("one condition", "proved"), ("one condition", "refuted"), ("several", "proved")]
        {
            let count = found.counted(class, what);
            assert!(count > 20, "{class}: only {count} {what}");
        }
        let tried: u64 = ["undecided", "refused"].iter().map(|what| found.counted("never met", what)).sum();
        assert!(tried > 20, "only {tried} sets that are empty");
    }
}

fn one_case(case: u64, findings: &mut Findings) {
    let mut dice = Dice::new(seed() ^ 0xc04d, case);
    let set = draw(case, &mut dice);
    let claims = claims(&set, &mut dice);
    let model = Model {
        states: PLAIN.to_vec(),
        parameters: ANGLES.map(|name| (name, None)).to_vec(),
        angles: ANGLES.to_vec(),
        ..Model::default()
    };
    let mut text = model.text();
    let orders = orders(set.conditions.len());
    for (place, (claimed, _)) in claims.iter().enumerate() {
        for (number, order) in orders.iter().enumerate() {
            let conditions: Vec<String> = order.iter().map(|i| set.conditions[*i].text()).collect();
            text.push_str(&format!(
                "claim c{place}.{number}: {} where {}\n",
                claimed.text(),
                conditions.join(", ")
            ));
        }
    }
    let said = match verdicts(&text) {
        Ok(said) => said,
        Err(why) => return findings.fault("a file with conditions is not answered", why, &text),
    };
    for ((claimed, follows), said) in claims.iter().zip(said.chunks(orders.len())) {
        let line = |said: &Said| text.lines().find(|line| line.starts_with(&format!("claim {}:", said.id)));
        let shown = |said: &Said| format!("{}{}\n", model.text(), line(said).unwrap_or_default());
        for said in said {
            judge(&set, claimed, *follows, said, &shown(said), findings);
        }
        if let Some(other) = said.iter().find(|other| other.word != said[0].word) {
            let both = format!("{}{}\n", shown(&said[0]), line(other).unwrap_or_default());
            let kind = match (said[0].word, other.word) {
                (Word::Undecided, _) | (_, Word::Undecided) => {
                    "the order of conditions decides whether it is decided"
                }
                _ => "the order of conditions decides the verdict",
            };
            let detail = format!("{:?} ({}), {:?} ({})", said[0].word, said[0].why, other.word, other.why);
            findings.fault(kind, detail, &both);
        }
    }
}

fn draw(case: u64, dice: &mut Dice) -> Set {
    let point = anchor(dice);
    let wanted = [1, 2, 2, 3][case as usize % 4];
    let mut conditions = Vec::new();
    for _ in 0..40 {
        if conditions.len() == wanted {
            break;
        }
        conditions.extend(through(&point, dice));
    }
    if case % 8 == 7 {
        conditions.truncate(1);
        conditions.extend(never(dice));
        return Set { conditions, points: Vec::new(), class: "never met" };
    }
    let points = points_on(&conditions, &point, dice);
    let class = if conditions.len() == 1 { "one condition" } else { "several" };
    Set { conditions, points, class }
}

/// Equations, and whether they follow from the conditions.
fn claims(set: &Set, dice: &mut Dice) -> Vec<(Equation, bool)> {
    let alphabet = Alphabet { plain: PLAIN.to_vec(), angles: ANGLES.to_vec(), functions: false };
    let term = dice.polynomial(&PLAIN, 1, 2);
    let mut same = term.clone();
    for condition in &set.conditions {
        let factor = if dice.once_in(2) { dice.monomial(&PLAIN, 1) } else { E::integer(dice.factor()) };
        same = same.plus(factor.times(condition.left.clone().minus(condition.right.clone())));
    }
    let mut found = vec![
        (Equation::new(alphabet.rewritten(&term, 1, dice), same.clone()), true),
        (Equation::new(term.clone(), alphabet.near_miss(&same, dice)), false),
    ];
    // what holds at one state of the set, and perhaps at no other
    let zero = || E::integer(0);
    let anchor = set.points.first().cloned().unwrap_or_else(|| anchor(dice));
    for _ in 0..3 {
        let name = dice.one_of(&PLAIN);
        let angle = E::Symbol(dice.one_of(&ANGLES));
        let half = |e: E| e.over(E::integer(2));
        let e = match dice.below(8) {
            6 => half(angle).of(Function::Cos),
            7 => half(E::Symbol(name)).of(Function::Sin),
            0 => E::Symbol(name),
            1 => E::Symbol(name).power(2),
            2 => angle.of(Function::Cos),
            3 => angle.of(Function::Sin).times(E::Symbol(name)),
            4 => E::Symbol(name).of(Function::Cos),
            _ => E::Symbol(name).times(E::Symbol(dice.one_of(&PLAIN))),
        };
        let Some(at) = value(&e, &anchor).ok().as_ref().and_then(E::of_number) else { continue };
        let difference = e.clone().minus(at.clone());
        found.push(match dice.below(3) {
            0 => (Equation::new(e, at), false),
            1 => (Equation::new(difference.clone().times(E::Symbol(name).minus(E::Pi)), zero()), false),
            _ => (Equation::new(difference.clone().times(E::Symbol(name)), zero()), false),
        });
    }
    found
}

fn judge(set: &Set, claimed: &Equation, follows: bool, said: &Said, text: &str, findings: &mut Findings) {
    let false_at = set.points.iter().find(|point| claimed.at(point) == Compared::Differ);
    if follows && let Some(point) = false_at {
        return findings.fault("the oracle contradicts itself on a set", point.text(), text);
    }
    match said.word {
        Word::Proved if set.points.is_empty() => {
            findings.fault("proved on a set that is empty", said.why.clone(), text);
        }
        Word::Proved => match false_at {
            Some(point) => {
                let detail = format!("proved ({}), and false at {}", said.why, point.text());
                findings.fault("a claim is proved that fails on the set", detail, text);
            }
            None => findings.count(set.class, "proved"),
        },
        Word::Refuted => {
            let shown = format!("{:?}", said.witness);
            if set.points.is_empty() {
                return findings.fault("refuted on a set that is empty", shown, text);
            }
            if follows {
                return findings.fault("what follows from the conditions is refuted", shown, text);
            }
            match examine(said, claimed, &set.conditions) {
                Standing::Good => findings.count(set.class, "refuted"),
                Standing::Incomplete => findings.count(set.class, "refuted, by part of a state"),
                Standing::Unclear => findings.count(set.class, "refuted, unclear to us"),
                Standing::Bad(why) => {
                    findings.fault("a witness on a set that is none", format!("{why}; {shown}"), text)
                }
            }
        }
        Word::Undecided => findings.undecided(set.class, &said.why),
    }
}

/// All orders of so many things.
fn orders(n: usize) -> Vec<Vec<usize>> {
    let mut found = vec![Vec::new()];
    for next in 0..n {
        found = found
            .iter()
            .flat_map(|order: &Vec<usize>| {
                (0..=order.len()).map(move |place| {
                    let mut longer = order.clone();
                    longer.insert(place, next);
                    longer
                })
            })
            .collect();
    }
    found
}
