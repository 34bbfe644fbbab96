//! Numbers of values where functions are not rational. Drawn outputs of drawn functions of two states that decay at known rates and of two
//! constants; the witness knows the flow in closed form and looks for other real states and constants with the same outputs at several
//! times, by Gauss and Newton's steps from drawn starts. What it finds beside an unknown of which is said that it has one value is a fault.

use super::dice::Dice;
use super::findings::{Findings, seed};
use super::library::numbers_of_values;

const NAMES: [&str; 4] = ["x", "y", "a", "b"];
/// The states decay at these rates.
const RATES: [f64; 2] = [1.0, 2.0];
const TIMES: usize = 6;
const STARTS: usize = 40;
const STEPS: usize = 60;
/// Two points are one where all their coordinates differ by less.
const APART: f64 = 1e-3;
/// Outputs agree where they differ by less than this in all.
const AGREE: f64 = 1e-11;

#[derive(Clone, Debug)]
enum Tree {
    Leaf(usize),
    Whole(i64),
    Sum(Box<Tree>, Box<Tree>),
    Product(Box<Tree>, Box<Tree>),
    Of(&'static str, Box<Tree>),
}

impl Tree {
    fn drawn(dice: &mut Dice, depth: usize) -> Tree {
        if depth == 0 || dice.once_in(5) {
            return if dice.once_in(8) { Tree::Whole(dice.between(1, 3)) } else { Tree::Leaf(dice.below(4)) };
        }
        let inner = |dice: &mut Dice| Box::new(Tree::drawn(dice, depth - 1));
        match dice.below(8) {
            0 | 1 => Tree::Sum(inner(dice), inner(dice)),
            2 | 3 => Tree::Product(inner(dice), inner(dice)),
            4 => {
                // a square
                let tree = inner(dice);
                Tree::Product(tree.clone(), tree)
            }
            _ => Tree::Of(dice.one_of(&["exp", "exp", "log", "sqrt", "sqrt", "sin", "atan"]), inner(dice)),
        }
    }

    fn text(&self) -> String {
        match self {
            Tree::Leaf(place) => NAMES[*place].to_owned(),
            Tree::Whole(number) => number.to_string(),
            Tree::Sum(a, b) => format!("({} + {})", a.text(), b.text()),
            Tree::Product(a, b) => format!("{}*{}", a.text(), b.text()),
            Tree::Of(name, a) => format!("{name}({})", a.text()),
        }
    }

    /// Not a number where it has no value.
    fn at(&self, point: &[f64; 4]) -> f64 {
        match self {
            Tree::Leaf(place) => point[*place],
            Tree::Whole(number) => *number as f64,
            Tree::Sum(a, b) => a.at(point) + b.at(point),
            Tree::Product(a, b) => a.at(point) * b.at(point),
            Tree::Of("exp", a) => a.at(point).exp(),
            Tree::Of("log", a) => a.at(point).ln(),
            Tree::Of("sqrt", a) => a.at(point).sqrt(),
            Tree::Of("sin", a) => a.at(point).sin(),
            Tree::Of(_, a) => a.at(point).atan(),
        }
    }

    fn has_functions(&self) -> bool {
        match self {
            Tree::Leaf(_) | Tree::Whole(_) => false,
            Tree::Sum(a, b) | Tree::Product(a, b) => a.has_functions() || b.has_functions(),
            Tree::Of(..) => true,
        }
    }
}

/// The outputs at all times.
fn outputs(trees: &[Tree], start: &[f64; 4]) -> Vec<f64> {
    let mut values = Vec::new();
    for step in 0..TIMES {
        let time = 0.25 * step as f64;
        let mut point = *start;
        for (state, rate) in point.iter_mut().zip(RATES) {
            *state *= (-rate * time).exp();
        }
        values.extend(trees.iter().map(|tree| tree.at(&point)));
    }
    values
}

/// A step of Gauss and Newton's with a little damping, by finite differences.
fn step(trees: &[Tree], at: &[f64; 4], wanted: &[f64], damping: f64) -> Option<[f64; 4]> {
    let here = outputs(trees, at);
    let mut columns = Vec::new();
    for place in 0..4 {
        let mut moved = *at;
        let by = 1e-7 * at[place].abs().max(1e-2);
        moved[place] += by;
        columns
            .push(outputs(trees, &moved).iter().zip(&here).map(|(a, b)| (a - b) / by).collect::<Vec<f64>>());
    }
    let mut rows = [[0.0; 5]; 4];
    for i in 0..4 {
        for j in 0..4 {
            rows[i][j] = columns[i].iter().zip(&columns[j]).map(|(a, b)| a * b).sum();
        }
        rows[i][i] *= 1.0 + damping;
        rows[i][i] += 1e-14;
        rows[i][4] = columns[i].iter().zip(wanted.iter().zip(&here)).map(|(a, (w, h))| a * (w - h)).sum();
    }
    for pivot in 0..4 {
        let best = (pivot..4).max_by(|a, b| rows[*a][pivot].abs().total_cmp(&rows[*b][pivot].abs()))?;
        rows.swap(pivot, best);
        let lead = rows[pivot];
        for (place, row) in rows.iter_mut().enumerate() {
            if place != pivot {
                let factor = row[pivot] / lead[pivot];
                row.iter_mut().zip(&lead).for_each(|(entry, own)| *entry -= factor * own);
            }
        }
    }
    let mut next = *at;
    for place in 0..4 {
        next[place] += rows[place][4] / rows[place][place];
    }
    next.iter().all(|value| value.is_finite()).then_some(next)
}

fn off(trees: &[Tree], at: &[f64; 4], wanted: &[f64]) -> f64 {
    let sum: f64 = outputs(trees, at).iter().zip(wanted).map(|(a, b)| (a - b) * (a - b)).sum();
    if sum.is_nan() { f64::INFINITY } else { sum.sqrt() }
}

/// Where a search from a start ends, if the outputs are the same there.
fn searched(trees: &[Tree], start: [f64; 4], wanted: &[f64]) -> Option<[f64; 4]> {
    let (mut at, mut damping) = (start, 1e-2);
    let mut best = off(trees, &at, wanted);
    for _ in 0..STEPS {
        if best < AGREE {
            return Some(at);
        }
        match step(trees, &at, wanted, damping).map(|next| (off(trees, &next, wanted), next)) {
            Some((better, next)) if better < best => {
                (best, at, damping) = (better, next, damping * 0.2);
            }
            _ => damping *= 8.0,
        }
        if damping > 1e8 {
            return None;
        }
    }
    (best < AGREE).then_some(at)
}

#[test]
fn unknowns_with_one_value() {
    let all = Findings::of("numbers of values with functions", 400, |case, findings| {
        let mut dice = Dice::new(seed(), case);
        let count = 2 + dice.below(2);
        let trees: Vec<Tree> = (0..count).map(|_| Tree::drawn(&mut dice, 3)).collect();
        let list: Vec<String> = trees.iter().map(Tree::text).collect();
        let text = format!(
            "system \"drawn\"\nstate x, y\nparam a, b unknown\ndrift f\n  x' = -x\n  y' = -2*y\noutput {}\n",
            list.join(", ")
        );
        let said = match numbers_of_values(&text) {
            Ok(said) => said,
            Err(why) => {
                if why.contains("panicked") {
                    findings.fault("a panic", &why, &text);
                }
                findings.count("functions", "not asked");
                return;
            }
        };
        let class = if trees.iter().any(Tree::has_functions) { "functions" } else { "rational" };
        let mut draw = || dice.between(1, 3000) as f64 / 1500.0;
        let truth = [draw(), draw(), draw(), draw()];
        let wanted = outputs(&trees, &truth);
        let has_value = wanted.iter().all(|value| value.is_finite());
        let mut others: Vec<[f64; 4]> = Vec::new();
        if has_value && said.iter().any(|(_, count)| *count == Some(1)) {
            for number in 0..STARTS {
                let mut start = [draw(), draw(), draw(), draw()];
                if number % 2 == 0 {
                    // also other signs
                    start.iter_mut().for_each(|value| *value = 4.0 * (*value - 1.0));
                }
                others.extend(searched(&trees, start, &wanted));
            }
        }
        for (place, name) in NAMES.iter().enumerate() {
            let count = said.iter().find(|(own, _)| own == name).and_then(|(_, count)| *count);
            let word = match count {
                Some(1) => "one",
                Some(_) => "several",
                None => "undecided or infinitely many",
            };
            findings.count(class, word);
            let another = others.iter().find(|other| (other[place] - truth[place]).abs() > APART);
            if let (Some(1), Some(other)) = (count, another) {
                findings.fault(
                    &format!("one value, and there is another ({class})"),
                    format!("{name}: {truth:?} and {other:?} have the same outputs"),
                    &text,
                );
            }
        }
    });
    all.assert_no_fault("unknowns_with_one_value");
    if all.is_whole() {
        assert!(all.counted("functions", "one") > 50, "hardly anything is decided");
    }
}
