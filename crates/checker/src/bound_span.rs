//! Generic ranks and what is observable, shown by elimination among expressions: of a matrix by its rows, of a system by the forms that all Lie derivatives stay among.

use super::checking::Checking;
use super::claim::{BuiltClaim, Compared, Subject, rows_of_lie_derivatives, sides};
use super::doubt::{Doubt, Effort, Missing};
use super::evaluation::Evaluation;
use super::listing::{Listing, Step};
use super::lowering::Lowering;
use super::minor::CertifiedRank;
use super::normal::{
    Closed, Equations, KeptFields, MovingField, RowPlaces, Spans, closed, follow, has_pole, kept, span,
    states_on_parts,
};
use super::state::{ExactCoordinate, ExactState};
use super::witness::holds;
use palmistry_lang::{System, Time};
use palmistry_math::expression::syntax::Relation;
use palmistry_math::expression::{NodeId, Symbol, gradient};

/// The work on one claim.
const WORK: u64 = 1 << 22;

/// So often states are drawn.
const DRAWN: u64 = 8;

/// What is to be shown of almost all states.
#[derive(Clone, Copy, Debug)]
pub(super) struct Asked<'a> {
    /// The rank that was found; of functions none is asked.
    pub rank: Option<usize>,
    /// Rows that have this rank at a state, where there are some.
    pub given: Option<&'a CertifiedRank>,
    /// Whether a minor of those rows that is not zero at one state is not zero at almost all.
    pub is_generic: bool,
    /// Of functions: whether they are observable or not.
    pub is_observable: bool,
}

/// Whether a rank that was found, or what is said of functions, holds at almost all states that are meant. `false` says nothing.
pub(super) fn is_shown(
    system: &mut System,
    claim: &BuiltClaim,
    asked: Asked<'_>,
    with: Checking<'_>,
) -> Result<bool, Doubt> {
    let effort = with.effort.limited(WORK);
    // of no state everything is so, and nothing is said
    if asked.given.is_none() && !has_state(system, claim, with) {
        return Ok(false);
    }
    match try_show(system, claim, asked, &effort) {
        // what takes too much work, and what has no value on a part, is not shown
        Err(Doubt::NoValue(Missing::Effort | Missing::Refused { .. })) => Ok(false),
        other => other,
    }
}

/// Whether an expression has a pole of an order where a factor vanishes. `false` says nothing.
pub(super) fn pole_is_shown(
    system: &System,
    claim: &BuiltClaim,
    ((expression, factor), order): ((NodeId, NodeId), i64),
    with: Checking<'_>,
) -> Result<bool, Doubt> {
    let (listed, places) = claim.listed(system, &Listing::default(), |lowering| {
        Ok((lowering.place(expression)?, lowering.place(factor)?))
    })?;
    if !has_state(system, claim, with) {
        return Ok(false);
    }
    let states = Equations::without_sides(&listed);
    match has_pole(states, places, order, &with.effort.limited(WORK)) {
        Err(Missing::Effort | Missing::Refused { .. }) => Ok(false),
        other => Ok(other?),
    }
}

/// Whether a state is found at which all conditions hold and all requirements are met, in exact numbers.
fn has_state(system: &System, claim: &BuiltClaim, with: Checking<'_>) -> bool {
    let Ok((listed, ())) = claim.listed(system, &Listing::default(), |_| Ok(())) else { return false };
    let mut like = ExactState::new();
    for step in listed.listing.steps() {
        if let Step::Symbol(name) = step {
            let is_angle = system.find_symbol(name).is_some_and(|symbol| system.is_angle(symbol));
            like.insert(name.clone(), ExactCoordinate::unit(is_angle));
        }
    }
    let effort = with.effort.limited(WORK);
    let states = Equations::without_sides(&listed);
    (0..DRAWN).any(|more| {
        let seed = with.seed.wrapping_add(more);
        let parts = states_on_parts(states, &[], (&like, seed), &effort).ok().flatten().unwrap_or_default();
        parts.iter().flatten().any(|state| {
            let values = Evaluation::new(&listed.listing, state, &effort);
            values.is_ok_and(|values| holds(&values, &listed.conditions, &listed.requirements).is_ok())
        })
    })
}

fn try_show(
    system: &mut System,
    claim: &BuiltClaim,
    asked: Asked<'_>,
    effort: &Effort,
) -> Result<bool, Doubt> {
    match (&claim.subject, asked.rank) {
        (Subject::Matrix { rows, .. }, Some(rank)) => has_rank(system, claim, rows, rank, effort),
        // a full rank needs no more than the rows that have it
        (Subject::System { .. }, Some(rank)) if rank == system.unknown_count() => {
            let Some(words) = asked.given.and_then(rows_of_the_minor) else { return Ok(false) };
            let rows = rows_of_lie_derivatives(system, &words, &[])?;
            has_rank(system, claim, &rows, rank, effort)
        }
        (Subject::System { .. }, Some(_)) => has_forms(system, claim, &[], asked, effort),
        (Subject::Functions { functions }, _) => has_forms(system, claim, functions, asked, effort),
        _ => Ok(false),
    }
}

/// The names of the rows that are independent at the first state.
pub(super) fn rows_of_the_minor(given: &CertifiedRank) -> Option<Vec<String>> {
    let minor = &given.states.first()?.minor;
    minor.rows.iter().map(|row| given.row_names.get(*row).cloned()).collect()
}

pub(super) fn placed(lowering: &mut Lowering<'_>, rows: &[Vec<NodeId>]) -> Result<Vec<RowPlaces>, Missing> {
    rows.iter().map(|row| row.iter().map(|entry| lowering.place(*entry)).collect()).collect()
}

fn has_rank(
    system: &System,
    claim: &BuiltClaim,
    rows: &[Vec<NodeId>],
    rank: usize,
    effort: &Effort,
) -> Result<bool, Doubt> {
    let (listed, rows) = claim.listed(system, &Listing::default(), |lowering| placed(lowering, rows))?;
    Ok(span(Spans { states: Equations::without_sides(&listed), rows: &rows, rank }, effort)?)
}

/// The rank that a minor of Lie derivatives has at almost all states, where there is one.
fn rank_of_lie_derivatives(system: &System, functions: &[NodeId], asked: Asked<'_>) -> Option<usize> {
    let words = asked.given.filter(|_| asked.is_generic).and_then(rows_of_the_minor)?;
    let is_function = |word: &String| functions.iter().any(|node| system.graph.text(*node) == *word);
    (!words.iter().any(is_function)).then_some(words.len())
}

/// What is claimed of the codistribution of a system, where this can be argued: no field leaves the set on which the conditions
/// hold, and time is continuous. By affine fields that keep the system, else by its forms, whose coefficients may contain signals;
/// forms are not derived where there are some.
fn has_forms(
    system: &mut System,
    claim: &BuiltClaim,
    functions: &[NodeId],
    asked: Asked<'_>,
    effort: &Effort,
) -> Result<bool, Doubt> {
    // an unknown signal has columns without end
    let is_known = |symbol: &Symbol| system.known.contains(symbol);
    if system.time == Time::Discrete || !system.signal_chains().iter().flatten().all(is_known) {
        return Ok(false);
    }
    let rank_of_lie_derivatives = rank_of_lie_derivatives(system, functions, asked);
    if !is_kept(system, claim, &effort.limited(WORK / 8))? {
        return Ok(false);
    }
    let differences: Vec<NodeId> = claim
        .conditions
        .iter()
        .filter(|(_, relation, _)| *relation == Relation::Equal)
        .map(|(left, _, right)| system.graph.sub(*left, *right))
        .collect();
    let unknowns = system.unknowns();
    let differential = |system: &mut System, node: NodeId| gradient(&mut system.graph, node, &unknowns);
    let outputs: Vec<NodeId> = system.outputs.iter().map(|(_, value)| *value).collect();
    let outputs: Vec<_> = outputs.into_iter().map(|output| differential(system, output)).collect();
    let functions: Vec<_> = functions.iter().map(|node| differential(system, *node)).collect();
    let differences: Vec<_> = differences.into_iter().map(|node| differential(system, node)).collect();
    let known = system.known.clone();
    let columns = system.column_names();
    let mut fields = Vec::new();
    for field in system.moving_fields() {
        let rates = system.fields[field].components.clone();
        let mut rate_of = |symbol| {
            let rate = rates.iter().find(|(moved, _)| *moved == symbol).map(|(_, rate)| *rate);
            let rate = rate.unwrap_or_else(|| system.graph.integer(0));
            differential(system, rate)
        };
        let slopes: Vec<_> = unknowns.iter().map(|symbol| rate_of(*symbol)).collect();
        let known_slopes: Vec<_> = known.iter().map(|symbol| rate_of(*symbol)).collect();
        let rates: Vec<_> =
            rates.iter().map(|(symbol, rate)| (system.symbol_name(*symbol).to_owned(), *rate)).collect();
        fields.push((rates, slopes, known_slopes));
    }
    let (listed, (outputs, functions, differences, fields)) =
        claim.listed(system, &Listing::default(), |lowering| {
            let outputs = placed(lowering, &outputs)?;
            let functions = placed(lowering, &functions)?;
            let differences = placed(lowering, &differences)?;
            let mut moving = Vec::new();
            for (rates, slopes, known_slopes) in &fields {
                let place = |(name, rate): &(String, NodeId)| Ok((name.clone(), lowering.place(*rate)?));
                moving.push(MovingField {
                    rates: rates.iter().map(place).collect::<Result<_, Missing>>()?,
                    slopes: placed(lowering, slopes)?,
                    known_slopes: placed(lowering, known_slopes)?,
                });
            }
            Ok((outputs, functions, differences, moving))
        })?;
    let (inside, outside): (&[RowPlaces], &[RowPlaces]) =
        if asked.is_observable { (&functions, &[]) } else { (&[], &functions) };
    let (states, outputs, fields) = (Equations::without_sides(&listed), &outputs[..], &fields[..]);
    // what is no less by the minor is no more by as many fields
    let dimension = rank_of_lie_derivatives.map(|rank| columns.len().saturating_sub(rank));
    let needs_dimension = asked.rank.is_some() || !inside.is_empty();
    let agrees = asked.rank.is_none() || asked.rank == rank_of_lie_derivatives;
    if agrees && (dimension.is_some() || !needs_dimension) {
        let dimension = dimension.filter(|_| needs_dimension);
        let constant = &[outputs, &differences].concat();
        let by_fields =
            KeptFields { states, columns: &columns, constant, fields, dimension, inside, outside };
        if kept(by_fields, &effort.limited(WORK / 4)).is_ok_and(|shown| shown) {
            return Ok(true);
        }
    }
    if !system.signal_chains().is_empty() {
        return Ok(false);
    }
    Ok(closed(Closed { states, outputs, fields, rank: asked.rank, inside, outside }, effort)?)
}

/// Whether no field leaves the set on which the conditions hold.
pub(super) fn is_kept(system: &mut System, claim: &BuiltClaim, effort: &Effort) -> Result<bool, Doubt> {
    let mut rates: Vec<Compared> = Vec::new();
    for (left, relation, right) in &claim.conditions {
        if *relation != Relation::Equal {
            continue;
        }
        let difference = system.graph.sub(*left, *right);
        for field in system.moving_fields() {
            let zero = system.graph.integer(0);
            rates.push((system.lie_derivative(field, difference), Relation::Equal, zero));
        }
    }
    if rates.is_empty() {
        return Ok(true);
    }
    let (listed, rates) = claim.listed(system, &Listing::default(), |lowering| sides(lowering, &rates))?;
    Ok(follow(Equations { sides: &rates, ..Equations::without_sides(&listed) }, effort)?)
}
