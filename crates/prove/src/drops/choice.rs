//! Coordinates in which the rows are short: what the file gives a name to, in the place of a state.
//!
//! A definition that is linear in a state, with a slope that vanishes nowhere, may stand for it: `d1` for `r1`, where
//! `d1 = (r1*cos(phi2) + r2)/sin(phi2) - s1`. The rank is the same, since the differentials are multiplied by a matrix whose
//! determinant is that slope's inverse; what is shown is in the file's own symbols.

use super::algebra::{Algebra, Chart, Reach};
use super::case::Case;
use super::coordinates::Coordinates;
use super::explore::Search;
use super::rows::Rows;
use palmistry_lang::{Assignment, Value};
use palmistry_math::expression::{NodeId, Symbol};
use palmistry_math::number::polynomial::{Polynomial, Ring};

/// So many definitions are tried.
const MOST_TRIED: usize = 24;

/// Chooses coordinates for the rows of Lie derivatives, one after the other, as long as they make the rows shorter.
pub(super) fn choose(algebra: &mut Algebra<'_>, search: &mut Search<'_>) -> Reach<()> {
    let mut domains = Vec::new();
    for chart in algebra.charts().ok_or("there are too many angles")? {
        // a case that contradicts itself has no states, and nothing to ask for
        let domain = search.domain(algebra, &chart)?;
        domains.extend(domain.filter(|case| !case.nonzero.iter().any(|factor| factor.is_zero())));
    }
    let rows = &mut search.rows;
    let at_first = lengths(algebra, rows);
    let Some(mut least) = total(&at_first, &at_first) else { return Ok(()) };
    let candidates = candidates(algebra);
    for _ in 0..algebra.system.states.len() {
        let before = algebra.coordinates.clone();
        let mut best: Option<(usize, Coordinates)> = None;
        for (name, meaning) in &candidates {
            if before.changed.iter().any(|(_, _, known)| known == meaning) {
                continue;
            }
            for state in algebra.system.unknowns() {
                let Some(next) = with(algebra, &before, &domains, (name, *meaning), state) else { continue };
                algebra.change(next.clone());
                rows.prepare(algebra);
                if let Some(found) = total(&lengths(algebra, rows), &at_first)
                    && found < best.as_ref().map_or(least, |(known, _)| *known)
                {
                    best = Some((found, next));
                }
                algebra.change(before.clone());
            }
        }
        let Some((found, next)) = best else { break };
        least = found;
        algebra.change(next);
    }
    rows.prepare(algebra);
    Ok(())
}

/// Numbers that the file gives names to and that depend on states.
fn candidates(algebra: &mut Algebra<'_>) -> Vec<(String, NodeId)> {
    let system = &*algebra.system;
    let rates = system.moving_fields().into_iter().flat_map(|field| &system.fields[field].components);
    let used = system.graph.reachable(rates.map(|(_, rate)| *rate));
    let named = system.definitions.iter().filter_map(|(name, value)| match value {
        Value::Scalar(node) if !name.contains('.') => Some((name.clone(), *node)),
        _ => None,
    });
    let depends = |node: NodeId| {
        let symbols = system.graph.symbols_of([node]);
        symbols.len() > 1 && system.states.iter().any(|state| symbols.contains(state))
    };
    named.filter(|(_, node)| used.contains(node) && depends(*node)).take(MOST_TRIED).collect()
}

/// The coordinates with a definition in the place of a state too.
fn with(
    algebra: &mut Algebra<'_>,
    before: &Coordinates,
    domains: &[Case],
    (name, meaning): (&str, NodeId),
    state: Symbol,
) -> Option<Coordinates> {
    if algebra.tangents.contains_key(&state) || before.changed.iter().any(|(old, ..)| *old == state) {
        return None;
    }
    let there = algebra.system.graph.substitute(&[meaning], &before.values)[0];
    if !algebra.system.graph.symbols_of([there]).contains(&state) {
        return None;
    }
    let slope = algebra.system.partial(there, state);
    if algebra.system.graph.symbols_of([slope]).contains(&state) {
        return None;
    }
    for case in domains {
        let in_chart = algebra.in_chart(&case.chart, &[slope, there]);
        let (slope, meaning) = (algebra.read(in_chart[0]).ok()?, algebra.read(in_chart[1]).ok()?);
        let never_zero = |factors: &[(Polynomial, u32)]| {
            factors.iter().all(|(factor, _)| !factor.is_zero() && case.doubtful(factor).is_empty())
        };
        if !never_zero(&slope.top) || !never_zero(&slope.bottom) || !never_zero(&meaning.bottom) {
            return None;
        }
    }
    let zero = algebra.system.graph.integer(0);
    let rest = algebra.system.graph.substitute(&[there], &Assignment::from([(state, zero)]))[0];
    let symbol = algebra.system.graph.intern(name);
    let new = algebra.system.graph.symbol(symbol);
    let difference = algebra.system.graph.sub(new, rest);
    let value = algebra.system.graph.div(difference, slope);
    let mut next = before.clone();
    let single = Assignment::from([(state, value)]);
    for known in next.values.values_mut() {
        *known = algebra.system.graph.substitute(&[*known], &single)[0];
    }
    next.values.insert(state, value);
    next.changed.push((state, symbol, meaning));
    Some(next)
}

/// The length of each row, multiplied out over common denominators; none of one that is too long.
fn lengths(algebra: &mut Algebra<'_>, rows: &Rows) -> Vec<Option<usize>> {
    let all: Vec<Vec<NodeId>> = rows.rows.iter().map(|row| algebra.in_chart(&Chart::new(), row)).collect();
    // symbols that are only tried take no place among the variables
    algebra.apart(|algebra| all.iter().map(|row| length(algebra, row)).collect())
}

fn length(algebra: &mut Algebra<'_>, row: &[NodeId]) -> Option<usize> {
    let mut sum = 0;
    for entry in row {
        let ratio = algebra.read(*entry).ok()?;
        sum += ratio.top.iter().chain(&ratio.bottom).map(|(factor, _)| factor.len()).sum::<usize>();
    }
    Some(sum)
}

/// The length of those rows that had one at first; none where one of them has become too long.
fn total(lengths: &[Option<usize>], at_first: &[Option<usize>]) -> Option<usize> {
    lengths.iter().zip(at_first).filter(|(_, first)| first.is_some()).map(|(now, _)| *now).sum()
}
