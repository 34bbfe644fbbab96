//! What the checker needs of a verdict: sides, conditions and guards as they were read, and a state.

use super::terms::{OnBranch, Point, Terms};
use super::verdict::{Verdict, Witness};
use crate::evidence::{Lowering, StatementAt, exact_state, largest_minor};
use palmistry_checker::{
    CertifiedRank, ClaimedRank, ClaimedWord, Doubt, Effort, Evidence, ExactCoordinate, Finding, Minor,
    Missing, PrintedSides, RankedState, Refutation, StatedIdentity,
};
use palmistry_lang::System;
use palmistry_math::expression::{Guard, NodeId, Program, Symbol, expand_angles};
use palmistry_math::number::PrimeField;
use palmistry_rank::observability::{Branch, Codistribution, Coordinate, Length, State, Stop};
use rand::Rng;

/// So many states are tried for one at which both sides exist.
const STATES: usize = 100;
/// So many states are looked at for the largest minor,
const MINORS: usize = 8;
/// and so many where none of them shows the claim: at simple numbers parameters are often equal, and ranks lower.
const MORE_MINORS: usize = 80;
/// The work that the check of one refutation may take.
const WORK: u64 = 1 << 28;

/// Whether what verdicts rest on is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kept {
    /// Verdicts alone.
    Verdicts,
    /// What they rest on as well, for a verdict file.
    Evidence,
}

/// Why there is nothing for the checker.
pub(super) const TOO_LONG: &str = "the Lie derivatives that show it are too long to be written down";
/// The same.
const NO_STATE: &str = "no state was written down at which all of it is defined";

impl OnBranch {
    fn at<'s>(
        &'s self,
        system: &'s System,
        state: &'s State,
        terms: &'s [(Symbol, NodeId)],
    ) -> StatementAt<'s> {
        StatementAt {
            graph: &system.graph,
            sides: &self.statement.sides,
            relations: &self.statement.relations,
            within: None,
            conditions: &self.statement.conditions,
            guards: &self.statement.guards,
            state,
            terms,
        }
    }

    /// What was drawn of a point, without what follows from it.
    pub(super) fn free_part(&self, point: &Point) -> State {
        let mut state = point.state.clone();
        for (symbol, _) in self.solved_values() {
            state.values.remove(&symbol);
        }
        state
    }
}

/// The refutation by an entry at a point.
///
/// # Errors
/// Where it cannot be written down, or the checker does not confirm it.
pub(super) fn refutation(
    system: &System,
    on: &OnBranch,
    point: &Point,
    entry: usize,
    witness: &Witness,
) -> Result<Box<Refutation>, Doubt> {
    let printed = PrintedSides { left: witness.left.clone(), right: witness.right.clone() };
    confirmed(on.at(system, &point.state, &point.terms).refutation(entry, printed)?)
}

/// A refutation that the checker confirms.
fn confirmed(refutation: Refutation) -> Result<Box<Refutation>, Doubt> {
    match refutation.check(&Effort::new(WORK)) {
        Finding::NotConfirmed(doubt) => Err(doubt),
        _ => Ok(Box::new(refutation)),
    }
}

/// The proof of an equation on a branch.
pub(super) fn identity(
    system: &mut System,
    on: &OnBranch,
    engine: &str,
    log2_error: f64,
    rng: &mut impl Rng,
) -> Evidence {
    let mut attempts = (0..STATES).map(|attempt| on.draw(system, attempt, rng));
    let Some(point) = attempts.find(|point| on.sides(point).is_some()) else {
        return Evidence::Unchecked(NO_STATE.to_owned());
    };
    // what the conditions give is written as it follows, so that the checker may draw the rest anew
    let (plain, terms) = (on.free_part(&point), on.solved_values());
    // at a rational point of the circle conditions hold exactly that do not at a rational number of radians
    let mut paired = plain.clone();
    for (symbol, value) in &mut paired.values {
        if let Coordinate::Number(half) = value
            && system.is_angle(*symbol)
        {
            *value = Coordinate::from_half_tangent(half);
        }
    }
    let stated = |state| on.at(system, state, &terms).identity(engine, log2_error, None);
    let agrees = |stated: &StatedIdentity| match stated.check(1, &Effort::new(WORK)) {
        // where the sides differ the checker has found a proof that is wrong, which must be reported
        Finding::NotConfirmed(doubt) => doubt == Doubt::Differ,
        _ => true,
    };
    let found = match stated(&paired) {
        Ok(stated) if paired == plain || agrees(&stated) => Ok(stated),
        _ => stated(&plain),
    };
    match on.statement.conditions.is_empty() {
        true => found.map_or_else(not_written, Evidence::Proved),
        // there are constants of which the checker has no rule that shows a condition to hold
        false => found.map_or_else(not_written, as_far_as_it_can_be_told),
    }
}

/// A proof for the checker, unless the checker cannot confirm at the very state what the proof takes for granted there: that is
/// no argument against the proof, and could not be distinguished from a fault later on.
fn as_far_as_it_can_be_told(stated: StatedIdentity) -> Evidence {
    match stated.check(1, &Effort::new(WORK)) {
        Finding::NotConfirmed(
            doubt @ (Doubt::ConditionNotShown(_) | Doubt::RequirementNotShown(_) | Doubt::ToleranceNotTold),
        ) => Evidence::Unchecked(format!("the checker cannot decide: {doubt}")),
        _ => Evidence::Proved(stated),
    }
}

fn not_written(why: Missing) -> Evidence {
    Evidence::Unchecked(format!("it could not be written down: {why}"))
}

/// Two numbers that are claimed to be near each other, and the tolerance.
#[derive(Clone, Copy)]
pub(super) struct Nearness {
    pub left: NodeId,
    pub right: NodeId,
    pub tolerance: NodeId,
}

/// The evidence for a verdict on two numbers at the values that the file gives. A refutation that the checker does not
/// confirm is none.
pub(super) fn nearness(
    system: &System,
    near: Nearness,
    guards: &[Guard],
    verdict: &Verdict,
) -> Result<Option<Evidence>, Doubt> {
    let mentioned = [near.left, near.right, near.tolerance].into_iter().chain(guards.iter().map(|g| g.node));
    let mut state = State::default();
    for symbol in system.graph.symbols_of(mentioned) {
        if let Some(value) = system.symbol_info(symbol).and_then(|info| info.default.clone()) {
            state.values.insert(symbol, Coordinate::Number(value));
        }
    }
    let sides = [near.left, near.right];
    let statement = StatementAt {
        graph: &system.graph,
        sides: &sides,
        relations: &[],
        within: Some(near.tolerance),
        conditions: &[],
        guards,
        state: &state,
        terms: &[],
    };
    Ok(match verdict {
        Verdict::Proved { engine, log2_error } => {
            let stated = statement.identity(engine, *log2_error, None);
            Some(stated.map_or_else(not_written, as_far_as_it_can_be_told))
        }
        Verdict::Refuted { witness, .. } => {
            let printed = PrintedSides { left: witness.left.clone(), right: witness.right.clone() };
            Some(Evidence::Refuted(*confirmed(statement.refutation(0, printed)?)?))
        }
        Verdict::Definition { .. } | Verdict::Undecided { .. } => None,
    })
}

/// A matrix whose rank is claimed.
pub(super) struct RankedMatrix {
    /// By rows.
    pub entries: Vec<NodeId>,
    pub columns: Vec<String>,
    pub row_names: Vec<String>,
    pub claimed: usize,
}

impl RankedMatrix {
    /// A matrix of the file.
    pub fn of_file(entries: &[NodeId], width: usize, claimed: usize) -> Self {
        let numbered = |what: &str, count: usize| (1..=count).map(|n| format!("{what} {n}")).collect();
        let height = entries.len().checked_div(width).unwrap_or(0);
        RankedMatrix {
            entries: entries.to_vec(),
            columns: numbered("column", width),
            row_names: numbered("row", height),
            claimed,
        }
    }

    /// The observability codistribution on a branch.
    ///
    /// # Errors
    /// In words, where there are no Lie derivatives, or those that are short enough have a lower rank than claimed: that does not
    /// refute the claim.
    pub fn codistribution(system: &mut System, branch: &Branch, claimed: usize) -> Result<Self, String> {
        let words = Codistribution::new(system, &branch.values, Length::UntilItStops)
            .map_err(|why| why.to_string())?;
        let cut_off = matches!(words.stop, Stop::TooMany | Stop::Order);
        if cut_off && words.generic_rank() < claimed {
            return Err(TOO_LONG.to_owned());
        }
        Ok(RankedMatrix {
            entries: words.entries(),
            columns: system.unknowns().iter().map(|state| system.symbol_name(*state).to_owned()).collect(),
            row_names: words.lie_derivatives.iter().map(|word| word.text(system)).collect(),
            claimed,
        })
    }
}

/// The evidence for a verdict on a rank on a branch: the largest minor at some states.
pub(super) fn claimed_rank(
    system: &mut System,
    on: &OnBranch,
    matrix: &RankedMatrix,
    verdict: &Verdict,
    rng: &mut impl Rng,
) -> Option<Evidence> {
    let (word, engine, log2_error) = match verdict {
        Verdict::Proved { engine, log2_error } => (ClaimedWord::Proved, engine, *log2_error),
        Verdict::Refuted { engine, .. } => (ClaimedWord::Refuted, engine, f64::NEG_INFINITY),
        Verdict::Definition { .. } | Verdict::Undecided { .. } => return None,
    };
    // the entries of a codistribution are no sides of the statement, and mention more symbols
    let sides = matrix.entries.clone();
    let terms = Terms { sides, relations: Vec::new(), ..on.statement.clone() };
    let Ok(on) = &OnBranch::new(system, &on.branch, &terms) else {
        return Some(Evidence::Unchecked(NO_STATE.to_owned()));
    };
    let is_angle = &system.angle_test();
    let expanded = expand_angles(&mut system.graph, &matrix.entries, is_angle);
    let program = Program::new(&system.graph, &expanded, is_angle);
    let field = PrimeField::random(rng);
    let width = matrix.columns.len();
    let most = width.min(matrix.row_names.len());
    let mut best: Option<(Point, Minor)> = None;
    for attempt in 0..MORE_MINORS {
        let known = best.as_ref().map(|(_, known)| known.rows.len());
        let shows_it = known.is_some_and(|known| (known == matrix.claimed) == (word == ClaimedWord::Proved));
        if attempt >= MINORS && shows_it {
            break;
        }
        let point = on.draw(system, attempt, rng);
        let exists = point.terms.is_empty() && on.sides(&point).is_some();
        let Some(minor) = exists.then(|| largest_minor(&program, width, &point.state, field)).flatten()
        else {
            continue;
        };
        let found = minor.rows.len();
        if best.as_ref().is_none_or(|(_, known)| found > known.rows.len()) {
            best = Some((point, minor));
        }
        if found == most {
            break;
        }
    }
    let Some((point, minor)) = best else { return Some(Evidence::Unchecked(NO_STATE.to_owned())) };
    let listed = listed_rank(system, on, matrix, &on.free_part(&point), minor);
    Some(listed.map_or_else(not_written, |matrix_at| {
        Evidence::ClaimedRank(ClaimedRank {
            matrix: matrix_at,
            claimed: matrix.claimed,
            word,
            engine: engine.clone(),
            log2_error: log2_error.is_finite().then_some(log2_error),
        })
    }))
}

/// The rank at a state with its minor, of which `free` was drawn, as the checker reads it; without a kernel.
pub(super) fn listed_rank(
    system: &System,
    on: &OnBranch,
    matrix: &RankedMatrix,
    free: &State,
    minor: Minor,
) -> Result<CertifiedRank, Missing> {
    let graph = &system.graph;
    let mut lowering = Lowering::new(graph);
    let mut state = exact_state(graph, free);
    // what gives a symbol its value has to come before whatever mentions the symbol
    for (symbol, value) in on.solved_values() {
        let place = lowering.place(value)?;
        state.insert(graph.symbol_name(symbol).to_owned(), ExactCoordinate::Step(place));
    }
    let mut rows = Vec::new();
    for row in matrix.entries.chunks(matrix.columns.len().max(1)) {
        rows.push(row.iter().map(|entry| lowering.place(*entry)).collect::<Result<Vec<_>, _>>()?);
    }
    let conditions = on.statement.conditions.iter().map(|condition| lowering.vanishing(*condition));
    let conditions = conditions.collect::<Result<_, _>>()?;
    let requirements = on.statement.guards.iter().map(|guard| lowering.requirement(*guard));
    Ok(CertifiedRank {
        requirements: requirements.collect::<Result<_, _>>()?,
        columns: matrix.columns.clone(),
        row_names: matrix.row_names.clone(),
        rows,
        conditions,
        listing: lowering.finish(),
        states: vec![RankedState { state, rank: minor.rows.len(), minor, kernel: Vec::new() }],
    })
}
