//! Sets that inequalities, equations and domains cut out of the plane, thin parts among them: points, lines, discs of radius zero. What is
//! proved of such a set may fail nowhere on it. The witness knows rational numbers and a grid on which all special points lie; around each of
//! its states it looks at a finer grid, which meets every line and every region that these conditions can leave there.

use super::dice::Dice;
use super::findings::{Findings, seed};
use super::library::{Said, Word, verdicts};
use dashu::rational::RBig;
use std::collections::BTreeMap;

/// A factor of a polynomial, to a power.
#[derive(Clone, Copy, Debug)]
enum Factor {
    X(i64),
    Y(i64),
    Sum(i64),
    /// `(x - a)^2 + (y - b)^2 - c`
    Disc(i64, i64, i64),
}

#[derive(Clone, Debug)]
struct Product {
    sign: i64,
    factors: Vec<(Factor, u32)>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Relation {
    AtLeast,
    AtMost,
    Zero,
    Above,
}

type Place = (RBig, RBig);

fn less(name: &str, a: i64) -> String {
    if a == 0 { name.to_owned() } else { format!("({name} - ({a}))") }
}

impl Factor {
    fn text(self) -> String {
        match self {
            Factor::X(a) => less("x", a),
            Factor::Y(a) => less("y", a),
            Factor::Sum(a) => format!("(x + y - ({a}))"),
            Factor::Disc(a, b, c) => format!("({}^2 + {}^2 - {c})", less("x", a), less("y", b)),
        }
    }

    fn at(self, (x, y): &Place) -> RBig {
        let from = |value: &RBig, a: i64| value - RBig::from(a);
        match self {
            Factor::X(a) => from(x, a),
            Factor::Y(a) => from(y, a),
            Factor::Sum(a) => from(&(x + y), a),
            Factor::Disc(a, b, c) => {
                let (x, y) = (from(x, a), from(y, b));
                &x * &x + &y * &y - RBig::from(c)
            }
        }
    }
}

impl Product {
    fn drawn(dice: &mut Dice, disc: bool) -> Product {
        let mut factors = Vec::new();
        for _ in 0..1 + dice.below(2) {
            let a = dice.between(-1, 1);
            let factor = match dice.below(if disc { 5 } else { 4 }) {
                0 | 1 => Factor::X(a),
                2 => Factor::Y(a),
                3 => Factor::Sum(a),
                _ => Factor::Disc(a, dice.between(-1, 1), dice.one_of(&[0, 0, 1])),
            };
            factors.push((factor, dice.one_of(&[1, 1, 1, 2])));
        }
        Product { sign: dice.one_of(&[1, 1, -1]), factors }
    }

    fn text(&self) -> String {
        let power = |(factor, power): &(Factor, u32)| match power {
            1 => factor.text(),
            power => format!("{}^{power}", factor.text()),
        };
        let product = self.factors.iter().map(power).collect::<Vec<_>>().join("*");
        if self.sign < 0 { format!("-({product})") } else { product }
    }

    fn at(&self, place: &Place) -> RBig {
        let one = RBig::from(self.sign);
        self.factors.iter().fold(one, |product, (factor, power)| {
            (0..*power).fold(product, |product, _| product * factor.at(place))
        })
    }

    fn has_a_disc(&self) -> bool {
        self.factors.iter().any(|(factor, _)| matches!(factor, Factor::Disc(..)))
    }
}

/// A set: products, and how each stands to zero.
struct Set(Vec<(Product, Relation)>);

impl Set {
    fn drawn(dice: &mut Dice) -> Set {
        let mut found: Vec<(Product, Relation)> = Vec::new();
        for _ in 0..1 + dice.below(3) {
            // a circle has hardly a state on the grid
            let disc = !found.iter().any(|(product, _)| product.has_a_disc());
            let product = Product::drawn(dice, disc);
            let relation = match dice.below(8) {
                0..=2 => Relation::AtLeast,
                3..=5 => Relation::AtMost,
                6 if !product.has_a_disc() => Relation::Zero,
                _ => Relation::Above,
            };
            // the line again from its other side
            if dice.once_in(3) && relation != Relation::Zero && !product.has_a_disc() {
                let other = if relation == Relation::AtMost { Relation::AtLeast } else { Relation::AtMost };
                found.push((product.clone(), other));
            }
            found.push((product, relation));
        }
        Set(found)
    }

    fn text(&self) -> String {
        let one = |(product, relation): &(Product, Relation)| {
            let sign = match relation {
                Relation::AtLeast => ">=",
                Relation::AtMost => "<=",
                Relation::Zero => "=",
                Relation::Above => ">",
            };
            format!("{} {sign} 0", product.text())
        };
        self.0.iter().map(one).collect::<Vec<_>>().join(", ")
    }

    fn holds(&self, place: &Place) -> bool {
        self.0.iter().all(|(product, relation)| {
            let value = product.at(place);
            match relation {
                Relation::AtLeast => value >= RBig::ZERO,
                Relation::AtMost => value <= RBig::ZERO,
                Relation::Zero => value.is_zero(),
                Relation::Above => value > RBig::ZERO,
            }
        })
    }
}

/// What is claimed of the set.
enum Claim {
    Differs(Product),
    Vanishes(Product),
    NotNegative(Product),
    /// `rank([e, 0; 0, f]) = n`, with a term that needs a product to be not negative.
    Rank([Product; 2], usize, Option<Product>),
}

impl Claim {
    fn drawn(dice: &mut Dice) -> Claim {
        match dice.below(8) {
            0 => Claim::Differs(Product::drawn(dice, false)),
            1 => Claim::Vanishes(Product::drawn(dice, false)),
            2 => Claim::NotNegative(Product::drawn(dice, false)),
            _ => {
                let entries = [Product::drawn(dice, false), Product::drawn(dice, false)];
                let needed = dice.once_in(3).then(|| Product::drawn(dice, false));
                Claim::Rank(entries, dice.one_of(&[2, 2, 1, 0]), needed)
            }
        }
    }

    fn text(&self) -> String {
        match self {
            Claim::Differs(e) => format!("{} != 0", e.text()),
            Claim::Vanishes(e) => format!("{} = 0", e.text()),
            Claim::NotNegative(e) => format!("{} >= 0", e.text()),
            Claim::Rank([e, f], rank, needed) => {
                let zero = needed.as_ref().map_or("0".to_owned(), |p| format!("0*sqrt({})", p.text()));
                format!("rank([{}, {zero}; 0, {}]) = {rank}", e.text(), f.text())
            }
        }
    }

    fn exists(&self, place: &Place) -> bool {
        !matches!(self, Claim::Rank(.., Some(needed)) if needed.at(place) < RBig::ZERO)
    }

    /// Whether it is so at a state.
    fn holds(&self, place: &Place) -> bool {
        match self {
            Claim::Differs(e) => !e.at(place).is_zero(),
            Claim::Vanishes(e) => e.at(place).is_zero(),
            Claim::NotNegative(e) => e.at(place) >= RBig::ZERO,
            Claim::Rank(entries, rank, _) => {
                entries.iter().filter(|entry| !entry.at(place).is_zero()).count() == *rank
            }
        }
    }
}

/// The states of a grid around a place, so many steps of a width to each side.
fn grid(around: &Place, steps: i64, width: &RBig) -> Vec<Place> {
    let along = |at: &RBig| (-steps..=steps).map(|k| at + width * RBig::from(k)).collect::<Vec<_>>();
    let (xs, ys) = (along(&around.0), along(&around.1));
    xs.iter().flat_map(|x| ys.iter().map(|y| (x.clone(), y.clone()))).collect()
}

/// What is wrong with a verdict, if anything is.
fn fault(set: &Set, claim: &Claim, said: &Said) -> Option<String> {
    let is_in = |place: &Place| set.holds(place) && claim.exists(place);
    let origin = (RBig::ZERO, RBig::ZERO);
    let half = RBig::ONE / RBig::from(2);
    match said.word {
        Word::Undecided => None,
        Word::Proved => {
            for place in grid(&origin, 6, &half).iter().filter(|place| is_in(place)) {
                let around = match claim {
                    // a rank is one of almost all states around each
                    Claim::Rank(..) => grid(place, 3, &(RBig::ONE / RBig::from(97))),
                    _ => vec![place.clone()],
                };
                let near: Vec<&Place> = around.iter().filter(|place| is_in(place)).collect();
                if near.iter().all(|place| !claim.holds(place)) {
                    return Some(format!("proved, and false at x = {}, y = {}", place.0, place.1));
                }
            }
            None
        }
        Word::Refuted => {
            let Some(witness) = &said.witness else { return Some("refuted without a witness".to_owned()) };
            let values: BTreeMap<&str, &str> =
                witness.state.iter().map(|(name, value)| (name.as_str(), value.as_str())).collect();
            let value = |name: &str| match values.get(name) {
                Some(text) => RBig::from_str_radix(text, 10).ok(),
                None => Some(RBig::ONE),
            };
            let (Some(x), Some(y)) = (value("x"), value("y")) else { return None };
            let place = (x, y);
            if !is_in(&place) {
                return Some(format!("refuted at x = {}, y = {}, which is not in the set", place.0, place.1));
            }
            claim
                .holds(&place)
                .then(|| format!("refuted at x = {}, y = {}, where it holds", place.0, place.1))
        }
    }
}

#[test]
fn thin_sets() {
    let found = Findings::of("thin sets", 260, one_case);
    found.assert_no_fault("thin_sets");
    if found.is_whole() {
        for (class, what) in
            [("states", "proved"), ("states", "refuted"), ("rank", "proved"), ("rank", "refuted")]
        {
            assert!(found.counted(class, what) > 5, "{class}: only {} {what}", found.counted(class, what));
        }
    }
}

fn one_case(case: u64, findings: &mut Findings) {
    let mut dice = Dice::new(seed(), case);
    let (set, claim) = (Set::drawn(&mut dice), Claim::drawn(&mut dice));
    let text = format!(
        "system \"thin\"\nstate x, y\ndrift f\n  others' = 0\noutput x, y\nclaim c: {} where {}\n",
        claim.text(),
        set.text()
    );
    let class = if matches!(claim, Claim::Rank(..)) { "rank" } else { "states" };
    let said = match verdicts(&text) {
        Ok(said) => said,
        Err(why) => return findings.fault("no verdict", why, &text),
    };
    match said[0].word {
        Word::Proved => findings.count(class, "proved"),
        Word::Refuted => findings.count(class, "refuted"),
        Word::Undecided => findings.undecided(class, &said[0].why),
    }
    if let Some(why) = fault(&set, &claim, &said[0]) {
        findings.fault("a false verdict on a thin set", why, &text);
    }
}
