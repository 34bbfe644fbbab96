//! Sets of several charts as few sets in the file's own symbols, to be printed: what lies in another one is left out, and what is
//! cut out by the two factors of a sine or a cosine is cut out by that. Together they are the same states: each of these steps is
//! checked against the cases as they were found, in every chart.

use super::algebra::{Algebra, Chart, normal};
use super::case::Case;
use super::explore::{Search, ShortCase};
use super::shown::{Line, Shown};
use palmistry_math::expression::{NodeId, Symbol, Variable};
use palmistry_math::number::Function;
use palmistry_math::number::polynomial::{Polynomial, Ring};

/// Few sets that together are the same. Where it is not known that a rank is lower, they may be more.
pub(super) fn merged(algebra: &mut Algebra<'_>, search: &mut Search<'_>, short: &[ShortCase]) -> Vec<Shown> {
    let charts = algebra.charts().unwrap_or_default();
    let (mut lower, mut open): (Vec<Shown>, Vec<Shown>) = (Vec::new(), Vec::new());
    for one in short {
        if one.lower.is_err() {
            open.push(Shown::around(one));
            continue;
        }
        if let Some(known) = lower.iter().position(|shown| shown.contains(algebra, &one.case)) {
            lower[known].cases.push(one.case.clone());
            continue;
        }
        let mut shown = Shown::alone(algebra, one);
        shown.widen(algebra, search, &charts, &no_higher(short, one.rank));
        lower.push(shown);
    }
    let mut found = Vec::new();
    for list in [lower, open] {
        let few = fewest(algebra, list);
        let few = joined(algebra, search, &charts, few, short);
        found.extend(named(algebra, search, &charts, few, short));
    }
    for shown in found.iter_mut().filter(|shown| shown.lower.is_ok()) {
        shown.exactly = shown.rank == 0 || is_exact(algebra, search, &charts, shown);
    }
    found
}

/// The cases whose states are known to have no higher rank.
fn no_higher(short: &[ShortCase], rank: usize) -> Vec<&Case> {
    short.iter().filter(|one| one.lower.is_ok() && one.rank <= rank).map(|one| &one.case).collect()
}

/// Those that do not lie in others that are kept; each case is among those of a set that contains it.
fn fewest(algebra: &mut Algebra<'_>, all: Vec<Shown>) -> Vec<Shown> {
    let mut kept: Vec<Shown> = Vec::new();
    for mut shown in all {
        // of two that are one the first is kept
        if let Some(at) = kept.iter().position(|other| lies_in(algebra, &shown, other)) {
            kept[at].cases.extend(shown.cases);
            continue;
        }
        let (inside, others): (Vec<_>, _) =
            kept.into_iter().partition(|other| lies_in(algebra, other, &shown));
        kept = others;
        shown.cases.extend(inside.into_iter().flat_map(|other: Shown| other.cases));
        kept.push(shown);
    }
    kept
}

/// Whether all cases of a set lie in another one.
fn lies_in(algebra: &mut Algebra<'_>, one: &Shown, other: &Shown) -> bool {
    one.cases.iter().all(|case| other.contains(algebra, case))
}

/// Two by two as one where that is cut out by a sine or a cosine.
fn joined(
    algebra: &mut Algebra<'_>,
    search: &Search<'_>,
    charts: &[Chart],
    mut kept: Vec<Shown>,
    short: &[ShortCase],
) -> Vec<Shown> {
    'again: loop {
        for first in 0..kept.len() {
            for second in 0..first {
                if let Some(both) = both(algebra, &kept[second], &kept[first])
                    && is_the_same(algebra, search, charts, &both, short)
                {
                    kept[second] = both;
                    kept.remove(first);
                    continue 'again;
                }
            }
        }
        return kept;
    }
}

/// Lines that are a sine or a cosine, as that.
fn named(
    algebra: &mut Algebra<'_>,
    search: &Search<'_>,
    charts: &[Chart],
    kept: Vec<Shown>,
    short: &[ShortCase],
) -> Vec<Shown> {
    let mut found = Vec::new();
    for mut shown in kept {
        for at in 0..shown.lines.len() {
            if let Line::Zero(polynomial) = &shown.lines[at]
                && polynomial.len() > 2
                && let Some(wave) = wave_of(algebra, &shown.chart, polynomial)
            {
                let mut other = shown.clone();
                other.lines[at] = Line::Named(wave);
                if is_the_same(algebra, search, charts, &other, short) {
                    shown = other;
                }
            }
        }
        found.push(shown);
    }
    found
}

/// Whether a set that is shown for some cases contains them, and no state besides that is not in cases of as low a rank. Where it
/// is not known that the rank is lower, it may be larger.
fn is_the_same(
    algebra: &mut Algebra<'_>,
    search: &Search<'_>,
    charts: &[Chart],
    shown: &Shown,
    short: &[ShortCase],
) -> bool {
    shown.cases.iter().all(|case| shown.contains(algebra, case))
        && (shown.lower.is_err() || shown.lies_in(algebra, search, charts, &no_higher(short, shown.rank)))
}

/// Whether all states of a set have its rank.
fn is_exact(algebra: &mut Algebra<'_>, search: &mut Search<'_>, charts: &[Chart], shown: &Shown) -> bool {
    charts.iter().all(|chart| match shown.in_chart(algebra, search, chart) {
        Ok(Some(case)) => search.is_no_lower(algebra, case, shown.rank),
        Ok(None) => true,
        Err(_) => false,
    })
}

/// Two sets as one, where that is cut out by a sine or a cosine. Whether it is the same has still to be asked.
fn both(algebra: &mut Algebra<'_>, one: &Shown, other: &Shown) -> Option<Shown> {
    if one.rank != other.rank || one.nonzero != other.nonzero {
        return None;
    }
    let (small, large) = if one.chart.len() <= other.chart.len() { (one, other) } else { (other, one) };
    let more: Vec<Symbol> = large.chart.difference(&small.chart).copied().collect();
    let without = |from: &[Line], what: &[Line]| -> Vec<Line> {
        from.iter().filter(|line| !what.contains(line)).cloned().collect()
    };
    let (only_small, only_large) = (without(&small.lines, &large.lines), without(&large.lines, &small.lines));
    let merged_line = match (more.as_slice(), only_small.as_slice(), only_large.as_slice()) {
        // phi = 0 and phi = pi
        ([angle], [Line::Zero(line)], []) => {
            let tangent = *algebra.tangents.get(angle)?;
            let variable = Variable::Plain(tangent);
            let place = algebra.variables().iter().position(|known| *known == variable)?;
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
    found.cases.extend(large.cases.iter().cloned());
    found.lines = small.lines.iter().filter(|line| large.lines.contains(line)).cloned().collect();
    found.lines.push(Line::Named(merged_line));
    found.no_half_turn.retain(|angle| large.no_half_turn.contains(angle) && !more.contains(angle));
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
