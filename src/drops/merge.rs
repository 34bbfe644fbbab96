//! Sets of several charts as few sets of the file's own words: what lies in another one is left out, and what is cut out by
//! the two factors of a sine or a cosine is cut out by that.

use super::algebra::{Algebra, Chart, normal};
use super::case::{Case, Step};
use super::explore::{Search, ShortCase};
use super::factors::{coefficient, places};
use crate::expression::{NodeId, Symbol};
use crate::number::Function;
use crate::number::polynomial::{Polynomial, Ring};
use std::collections::BTreeSet;

/// One equation of a set.
#[derive(Clone, Debug, PartialEq)]
enum Line {
    /// A polynomial of the chart vanishes.
    Zero(Polynomial),
    /// An expression of the file does.
    Named(NodeId),
}

/// A set as it is shown.
#[derive(Clone, Debug)]
pub(super) struct Shown {
    pub case: Case,
    chart: Chart,
    lines: Vec<Line>,
    divisors: Vec<Polynomial>,
    /// Angles that are no half turn on it, since what it becomes there is not a part of it.
    no_half_turn: BTreeSet<Symbol>,
    pub rank: usize,
    pub lower: Result<f64, String>,
}

impl Shown {
    pub fn of(short: &ShortCase) -> Shown {
        let case = short.case.clone();
        Shown {
            chart: case.chart.clone(),
            lines: simplified(&case).into_iter().map(Line::Zero).collect(),
            divisors: case.divisors.clone(),
            no_half_turn: BTreeSet::new(),
            rank: short.rank,
            lower: short.lower.clone(),
            case,
        }
    }

    /// The equations.
    pub fn texts(&self, algebra: &mut Algebra<'_>) -> Vec<String> {
        let mut found = Vec::new();
        for angle in &self.chart {
            found.push(format!("{} = pi", algebra.system.symbol_name(*angle)));
        }
        for line in &self.lines {
            let node = match line {
                Line::Zero(polynomial) => algebra.shown(polynomial),
                Line::Named(node) => *node,
            };
            found.push(format!("{} = 0", algebra.system.graph.text(node)));
        }
        found
    }

    /// What does not vanish.
    pub fn unless(&self, algebra: &mut Algebra<'_>) -> Vec<String> {
        let mut found = Vec::new();
        for divisor in &self.divisors {
            let node = algebra.shown(divisor);
            found.push(format!("{} != 0", algebra.system.graph.text(node)));
        }
        for angle in &self.no_half_turn {
            found.push(format!("{} != pi", algebra.system.symbol_name(*angle)));
        }
        found
    }

    /// Whether a set of a chart lies in this one, taken with its limits where angles become half turns.
    fn contains(&self, algebra: &mut Algebra<'_>, other: &Case) -> bool {
        let at_half_turns = |polynomial: &Polynomial, algebra: &Algebra<'_>| {
            let mut found = polynomial.clone();
            for angle in other.chart.difference(&self.chart) {
                let tangent = algebra.tangents.get(angle);
                let place = algebra.variables().iter().position(|variable| {
                    matches!(variable, crate::expression::Variable::Plain(symbol) if Some(symbol) == tangent)
                });
                if let Some(place) = place {
                    found = coefficient(&found, place, found.degree_in(place));
                }
            }
            found
        };
        let vanishes = |polynomial: &Polynomial, algebra: &mut Algebra<'_>| {
            let there = at_half_turns(polynomial, algebra);
            let node = algebra.node(&there);
            let node = algebra.system.graph.substitute(&[node], &other.values)[0];
            algebra.numerator(node).and_then(|top| other.reduced(&top)).ok()
        };
        self.chart.is_subset(&other.chart)
            && self.lines.iter().all(|line| match line {
                Line::Zero(polynomial) => vanishes(polynomial, algebra).is_some_and(|top| top.is_zero()),
                Line::Named(_) => false,
            })
            && self.divisors.iter().all(|divisor| {
                vanishes(divisor, algebra)
                    .is_some_and(|top| !top.is_zero() && other.doubtful(&top).is_empty())
            })
    }
}

/// The equations of a case with the variables that vanish left out of the others, as far as one factor is left of each.
fn simplified(case: &Case) -> Vec<Polynomial> {
    let mut lines = case.equations.clone();
    for _ in 0..lines.len() {
        let zero: Vec<usize> = lines
            .iter()
            .filter(|line| line.len() == 1 && line.degree() == 1)
            .flat_map(|line| places(line).into_iter().take(1))
            .collect();
        let mut changed = false;
        for line in lines.iter_mut().filter(|line| line.len() > 1) {
            let mut rest = Polynomial::default();
            for (exponents, value) in line.terms().filter(|(e, _)| zero.iter().all(|place| e[*place] == 0)) {
                rest = rest.add(&Polynomial::term(*exponents, value.clone()));
            }
            if rest == *line || rest.is_zero() {
                continue;
            }
            if let [factor] = case.doubtful(&rest).as_slice() {
                *line = factor.clone();
                changed = true;
            }
        }
        if !changed {
            break;
        }
    }
    lines
}

/// Few sets that together are the same.
pub(super) fn merged(algebra: &mut Algebra<'_>, search: &Search<'_>, short: &[ShortCase]) -> Vec<Shown> {
    let mut all: Vec<Shown> = short.iter().map(Shown::of).collect();
    for index in 0..all.len() {
        for divisor in all[index].divisors.clone() {
            if all[index].lower.is_ok() && rest_is_known(algebra, search, &all, index, &divisor) {
                all[index].divisors.retain(|other| *other != divisor);
            }
        }
    }
    let mut kept: Vec<Shown> = Vec::new();
    for (index, shown) in all.iter().enumerate() {
        let inside = all.iter().enumerate().any(|(at, other)| {
            at != index
                && other.lower.is_ok() == shown.lower.is_ok()
                && other.contains(algebra, &shown.case)
                // of two that are one the first is kept
                && (at < index || !shown.contains(algebra, &other.case))
        });
        if !inside {
            kept.push(shown.clone());
        }
    }
    // where a set has limits at a half turn that no set of that chart is, it has to be said
    for shown in &mut kept {
        for (angle, tangent) in algebra.tangents.clone() {
            if shown.chart.contains(&angle) {
                continue;
            }
            let place = algebra.variables().iter().position(|variable| {
                matches!(variable, crate::expression::Variable::Plain(symbol) if *symbol == tangent)
            });
            let depends = place.is_some_and(|place| {
                let polynomials = shown.lines.iter().filter_map(|line| match line {
                    Line::Zero(polynomial) => Some(polynomial),
                    Line::Named(_) => None,
                });
                // one equation of odd or even degree describes a hypersurface, which is closed
                shown.lines.len() + shown.divisors.len() > 1
                    && polynomials.chain(&shown.divisors).any(|polynomial| polynomial.degree_in(place) > 0)
                    && !shown.lines.contains(&Line::Zero(Polynomial::variable(place)))
            });
            let continued = all.iter().any(|other| {
                other.chart.contains(&angle)
                    && other.lines.len() == shown.lines.len()
                    && shown.contains(algebra, &other.case)
            });
            let there: Chart = shown.chart.iter().copied().chain([angle]).collect();
            let exists = match search.domain(algebra, &there) {
                Ok(domain) => domain.is_some_and(|case| !case.nonzero.iter().any(|factor| factor.is_zero())),
                Err(_) => true,
            };
            if depends && !continued && exists {
                shown.no_half_turn.insert(angle);
            }
        }
    }
    let mut merging = true;
    while merging {
        merging = false;
        'pairs: for first in 0..kept.len() {
            for second in 0..first {
                if let Some(both) = both(algebra, &kept[second], &kept[first]) {
                    kept[second] = both;
                    kept.remove(first);
                    merging = true;
                    break 'pairs;
                }
            }
        }
    }
    for shown in &mut kept {
        for line in &mut shown.lines {
            if let Line::Zero(polynomial) = line
                && polynomial.len() > 2
                && let Some(wave) = wave_of(algebra, &shown.chart, polynomial)
            {
                *line = Line::Named(wave);
            }
        }
    }
    kept
}

/// Whether the states at which the equations of a set hold and something that does not vanish on it does lie in the other
/// sets on which the rank is lower.
fn rest_is_known(
    algebra: &mut Algebra<'_>,
    search: &Search<'_>,
    all: &[Shown],
    index: usize,
    divisor: &Polynomial,
) -> bool {
    let shown = &all[index];
    let Ok(Some(mut case)) = search.domain(algebra, &shown.chart) else { return false };
    for line in &shown.lines {
        match line {
            Line::Zero(polynomial) => case = case.with_zero(polynomial),
            Line::Named(_) => return false,
        }
    }
    let mut open = vec![case.with_zero(divisor)];
    for _ in 0..MOST_CASES {
        let Some(case) = open.pop() else { return true };
        match case.step(algebra) {
            Ok(Step::Empty) => {}
            Ok(Step::Split(cases)) => open.extend(cases),
            Ok(Step::Ready(case)) => {
                let others = all.iter().enumerate().filter(|(at, other)| *at != index && other.lower.is_ok());
                let mut others = others.map(|(_, other)| other);
                if !others.any(|other| other.contains(algebra, &case)) {
                    return false;
                }
            }
            Err(_) => return false,
        }
    }
    false
}

/// So many cases are followed to find out whether something has to be said beside the equations of a set.
const MOST_CASES: usize = 60;

/// Two sets as one, where that is cut out by a sine or a cosine.
fn both(algebra: &mut Algebra<'_>, one: &Shown, other: &Shown) -> Option<Shown> {
    if one.lower.is_ok() != other.lower.is_ok()
        || one.rank != other.rank
        || one.divisors != other.divisors
        || one.no_half_turn != other.no_half_turn
    {
        return None;
    }
    let (small, large) = if one.chart.len() <= other.chart.len() { (one, other) } else { (other, one) };
    let more: Vec<Symbol> = large.chart.difference(&small.chart).copied().collect();
    let without = |from: &[Line], what: &[Line]| -> Vec<Line> {
        from.iter().filter(|line| !what.contains(line)).cloned().collect()
    };
    let (only_small, only_large) = (without(&small.lines, &large.lines), without(&large.lines, &small.lines));
    let place_of = |symbol: Symbol| {
        algebra.variables().iter().position(
            |variable| matches!(variable, crate::expression::Variable::Plain(known) if *known == symbol),
        )
    };
    let merged_line = match (more.as_slice(), only_small.as_slice(), only_large.as_slice()) {
        // phi = 0 and phi = pi
        ([angle], [Line::Zero(line)], []) => {
            let place = place_of(*algebra.tangents.get(angle)?)?;
            if *line != Polynomial::variable(place) {
                return None;
            }
            let graph = &mut algebra.system.graph;
            let angle = graph.symbol(*angle);
            graph.apply(Function::Sin, angle)
        }
        ([], [Line::Zero(a)], [Line::Zero(b)]) if small.chart == large.chart => {
            let product = normal(&a.mul(b)?);
            wave_of(algebra, &small.chart, &product)?
        }
        _ => return None,
    };
    let mut found = small.clone();
    let common: Vec<Line> = small.lines.iter().filter(|line| large.lines.contains(line)).cloned().collect();
    found.lines = common;
    found.lines.push(Line::Named(merged_line));
    if let (Ok(a), Ok(b)) = (&small.lower, &large.lower) {
        found.lower = Ok(a.max(*b) + 1.0);
    }
    Some(found)
}

/// The sine or cosine of an angle, or of the sum or difference of two, whose numerator in the tangents this is.
fn wave_of(algebra: &mut Algebra<'_>, chart: &Chart, product: &Polynomial) -> Option<NodeId> {
    let angles: Vec<Symbol> = algebra.tangents.keys().copied().collect();
    let mut arguments = Vec::new();
    for (at, angle) in angles.iter().enumerate() {
        let own = algebra.system.graph.symbol(*angle);
        arguments.push(own);
        for other in &angles[..at] {
            let other = algebra.system.graph.symbol(*other);
            arguments.push(algebra.system.graph.add(other, own));
            arguments.push(algebra.system.graph.sub(other, own));
        }
    }
    for argument in arguments {
        for function in [Function::Sin, Function::Cos] {
            let wave = algebra.system.graph.apply(function, argument);
            let there = algebra.in_chart(chart, &[wave])[0];
            if algebra.numerator(there).ok().is_some_and(|top| normal(&top) == *product) {
                return Some(wave);
            }
        }
    }
    None
}
