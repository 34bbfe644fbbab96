//! Whether a set of states lies in others. What decides a claim is asked here, of the cases as they were found: never of a set
//! that was put together to be printed, which stands for several of them.

use super::algebra::{Algebra, Ratio, Reach, TOO_LONG};
use super::case::{Case, Step};
use super::explore::{Search, is_pole};
use palmistry_math::expression::{Guard, Need, NodeId, Symbol};
use palmistry_math::number::polynomial::{Polynomial, Ring};

/// So many cases are followed to find out whether a set lies in others.
const MOST_CASES: usize = 60;

/// A set that a claim leaves out: where the guards hold, so that its equations exist, and all of these do.
#[derive(Clone, Debug)]
pub(crate) struct NamedSet {
    /// The left sides of its equations, whose right sides are zero.
    pub vanishing: Vec<NodeId>,
    /// What its equations need to exist, beyond what the claim needs anyway: a state at which they do not exist is not in it.
    pub guards: Vec<Guard>,
    /// It as it is written.
    pub written: String,
}

impl NamedSet {
    /// The one expression that vanishes on it and nowhere else, where there is one.
    pub fn single(&self) -> Option<NodeId> {
        match (self.vanishing.as_slice(), self.guards.as_slice()) {
            ([node], []) => Some(*node),
            _ => None,
        }
    }

    /// All expressions that it mentions.
    pub fn mentioned(&self) -> impl Iterator<Item = NodeId> {
        self.vanishing.iter().copied().chain(self.guards.iter().map(|guard| guard.node))
    }
}

/// A polynomial of a chart with the values of a case put in and its relations used: zero where it vanishes all over the case.
pub(super) fn on_case(algebra: &mut Algebra<'_>, case: &Case, polynomial: &Polynomial) -> Reach<Polynomial> {
    let node = algebra.node(polynomial);
    let node = algebra.system.graph.substitute(&[node], &case.values)[0];
    algebra.numerator(node).and_then(|top| case.reduced(&top))
}

/// Whether all states of a case lie in the union of others, or among their limits: so that a rank which no state of
/// these exceeds is exceeded at no state of it. The others' domain is that of the case.
pub(super) fn covered(algebra: &mut Algebra<'_>, case: Case, by: &[&Case]) -> bool {
    let mut open = vec![case];
    for _ in 0..MOST_CASES {
        let Some(case) = open.pop() else { return true };
        match case.step(algebra) {
            Ok(Step::Empty) => {}
            Ok(Step::Split(cases)) => open.extend(cases),
            Ok(Step::Ready(case)) => match least_rest(algebra, &case, by) {
                Some(rest) => open.extend(rest),
                None => return false,
            },
            Err(_) => return false,
        }
    }
    false
}

/// The least rest of a case outside of one of some others; `None` where none of them holds almost all of it.
fn least_rest(algebra: &mut Algebra<'_>, case: &Case, by: &[&Case]) -> Option<Vec<Case>> {
    let mut best: Option<Vec<Polynomial>> = None;
    for other in by.iter().filter(|other| other.chart.is_subset(&case.chart)) {
        let Some(doubtful) = doubtful_within(algebra, case, other) else { continue };
        if best.as_ref().is_none_or(|known| doubtful.len() < known.len()) {
            best = Some(doubtful);
        }
    }
    Some(best?.iter().map(|factor| case.with_zero(factor)).collect())
}

/// What may vanish on a case and must not for what is said of another one to hold on it; `None` where that does not follow.
fn doubtful_within(algebra: &mut Algebra<'_>, case: &Case, other: &Case) -> Option<Vec<Polynomial>> {
    match (within(algebra, case, other), on_the_graph(algebra, case, other)) {
        (Some(one), Some(two)) => Some(if one.len() <= two.len() { one } else { two }),
        (one, two) => one.or(two),
    }
}

/// That the case lies in the other one: its equations hold there, and what is not zero is not.
fn within(algebra: &mut Algebra<'_>, case: &Case, other: &Case) -> Option<Vec<Polynomial>> {
    if case.chart != other.chart {
        return None;
    }
    for equation in &other.equations {
        if !on_case(algebra, case, equation).ok()?.is_zero() {
            return None;
        }
    }
    let nonzero: Reach<Vec<Polynomial>> =
        other.nonzero.iter().map(|factor| on_case(algebra, case, factor)).collect();
    all_doubtful(case, &nonzero.ok()?)
}

/// That the case lies among the limits of the other one, whose states are given by values that depend continuously on the rest
/// as long as no divisor vanishes; where no value mentions an angle that becomes a half turn, also at half turns. Minors that are
/// zero on a set are zero at its limits.
fn on_the_graph(algebra: &mut Algebra<'_>, case: &Case, other: &Case) -> Option<Vec<Polynomial>> {
    if !other.relations.is_empty() {
        return None;
    }
    let mut divisors = Vec::new();
    let turned = case.chart.difference(&other.chart).filter_map(|angle| algebra.tangents.get(angle));
    let turned: Vec<Symbol> = turned.copied().collect();
    let mut mentioned = algebra.system.graph.symbols_of(other.values.values().copied());
    mentioned.extend(other.values.keys());
    if turned.iter().any(|tangent| mentioned.contains(tangent)) {
        return None;
    }
    for (symbol, value) in &other.values {
        for (factor, _) in algebra.read(*value).ok()?.bottom {
            divisors.push(on_case(algebra, case, &factor).ok()?);
        }
        let own = algebra.system.graph.symbol(*symbol);
        let difference = algebra.system.graph.sub(own, *value);
        let there = algebra.system.graph.substitute(&[difference], &case.values)[0];
        let top = algebra.numerator(there).and_then(|top| case.reduced(&top)).ok()?;
        if !top.is_zero() {
            return None;
        }
    }
    all_doubtful(case, &divisors)
}

/// The factors of some polynomials that may vanish on a case; `None` where one of them is zero all over it.
fn all_doubtful(case: &Case, polynomials: &[Polynomial]) -> Option<Vec<Polynomial>> {
    let mut found: Vec<Polynomial> = Vec::new();
    for polynomial in polynomials {
        if polynomial.is_zero() {
            return None;
        }
        for factor in case.doubtful(polynomial) {
            if !found.contains(&factor) {
                found.push(factor);
            }
        }
    }
    Some(found)
}

/// The states of a case that lie in none of some sets, as cases; none of them where it lies in their union.
///
/// # Errors
/// In words, where that is out of reach.
pub(super) fn off_sets(
    algebra: &mut Algebra<'_>,
    search: &Search<'_>,
    case: &Case,
    sets: &[NamedSet],
) -> Reach<Vec<Case>> {
    let mut left = vec![case.clone()];
    for set in sets {
        let mut next = Vec::new();
        for case in &left {
            next.extend(off_set(algebra, search, case, set)?);
        }
        if next.len() > MOST_CASES {
            return Err(TOO_LONG.to_owned());
        }
        left = next;
    }
    Ok(left)
}

fn off_set(algebra: &mut Algebra<'_>, search: &Search<'_>, case: &Case, set: &NamedSet) -> Reach<Vec<Case>> {
    let mut found = Vec::new();
    let nodes: Vec<NodeId> = set.mentioned().collect();
    let nodes = algebra.in_chart(&case.chart, &nodes);
    let nodes = algebra.system.graph.substitute(&nodes, &case.values);
    if nodes.iter().any(|node| is_pole(algebra, *node)) {
        return Ok(vec![case.clone()]);
    }
    let (equations, guards) = nodes.split_at(set.vanishing.len());
    for node in equations {
        let top = algebra.numerator(*node).and_then(|top| case.reduced(&top))?;
        if !top.is_zero() {
            let mut piece = case.clone();
            piece.add_nonzero(&top);
            found.extend(piece.all_ready(algebra)?);
        }
    }
    for (guard, node) in set.guards.iter().zip(guards) {
        if search.guards.contains(guard) {
            continue;
        }
        let ratio = algebra.read(*node)?;
        for piece in where_it_fails(case, guard.need, &ratio)? {
            found.extend(piece.all_ready(algebra)?);
        }
    }
    Ok(found)
}

/// The states of a case at which a guard does not hold.
fn where_it_fails(case: &Case, need: Need, ratio: &Ratio) -> Reach<Vec<Case>> {
    let value = ratio.signed().ok_or(TOO_LONG)?;
    let positive = |polynomial: &Polynomial| {
        let mut piece = case.clone();
        piece.add_positive(polynomial);
        piece
    };
    let beyond_one = || ratio.below_one().map(|value| value.neg()).ok_or(TOO_LONG);
    Ok(match need {
        Need::NotZero => vec![case.with_zero(&value)],
        Need::Positive => vec![case.with_zero(&value), positive(&value.neg())],
        Need::NotNegative => vec![positive(&value.neg())],
        Need::WithinOne => vec![positive(&beyond_one()?)],
        Need::InsideOne => {
            let more = beyond_one()?;
            vec![case.with_zero(&more), positive(&more)]
        }
    })
}
