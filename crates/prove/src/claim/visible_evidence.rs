//! What the checker needs of a claim about observability: the rank of the Lie derivatives, the ranks with the functions'
//! differentials, and that outputs do not change along an unobservable direction.

use super::evidence::{RankedMatrix, TOO_LONG, claimed_rank, listed_rank};
use super::terms::{OnBranch, Point, Terms, Values};
use super::verdict::{Verdict, Witness};
use crate::evidence::{StatementAt, largest_minor};
use dashu::rational::RBig;
use palmistry_checker::{CertifiedRank, Effort, Evidence, Finding, Ratio};
use palmistry_io::UNINTERRUPTED;
use palmistry_lang::System;
use palmistry_math::expression::{NodeId, Program, expand_angles, gradient};
use palmistry_math::number::{PrimeField, Rationals};
use palmistry_rank::observability::{
    Codistribution, Frame, Length, UnobservableField, WrittenState, kernel, rank,
};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// So many states are tried for one that the checker confirms.
const ATTEMPTS: usize = 20;
/// The work of the checker on a refutation.
const WORK: u64 = 1 << 28;
/// The length to which exact values may grow.
const BITS: usize = 1 << 14;

/// That a field changes no output, as equations that the checker tries.
pub(super) fn kept_outputs(
    system: &mut System,
    on: &OnBranch,
    field: &UnobservableField,
    rng: &mut ChaCha8Rng,
) -> Evidence {
    let states: Vec<_> = field.components.iter().map(|part| part.state).collect();
    let mut sides = Vec::new();
    for (_, output) in system.outputs.clone() {
        let slopes = gradient(&mut system.graph, output, &states);
        let terms: Vec<NodeId> = slopes
            .iter()
            .zip(&field.components)
            .map(|(slope, part)| system.graph.mul(*slope, part.rate))
            .collect();
        sides.push(system.graph.sum(terms));
    }
    sides.extend(vec![system.graph.integer(0); sides.len()]);
    let terms = Terms { sides: sides.clone(), guards: on.statement.guards.clone(), ..Terms::default() };
    let Ok(there) = OnBranch::new(system, &on.branch, &terms) else {
        return Evidence::Unchecked("no state was found at which all of it is defined".to_owned());
    };
    let mut points = (0..ATTEMPTS).map(|attempt| there.draw(system, attempt, rng));
    let point = points.find(|point| there.sides(point).is_some());
    let stated = point.map(|point| {
        StatementAt {
            graph: &system.graph,
            sides: &sides,
            relations: &[],
            within: None,
            conditions: &[],
            guards: &on.statement.guards,
            state: &point.state,
            terms: &[],
        }
        .identity("no output changes along an unobservable direction", field.log2_error, None)
    });
    match stated {
        Some(Ok(stated)) => Evidence::Proved(stated),
        Some(Err(why)) => Evidence::Unchecked(format!("it could not be written down: {why}")),
        None => Evidence::Unchecked("no state was found at which all of it is defined".to_owned()),
    }
}

/// The Lie derivatives on the set, as a matrix with its claimed rank; `None` where they are too long.
fn words(system: &mut System, on: &OnBranch, frame: Frame) -> Option<RankedMatrix> {
    if !frame.lie_derivatives_are_short(system) {
        return None;
    }
    let rank = frame.generic.rank();
    let words = Codistribution::within(system, &on.branch.values, Length::UntilItStops, frame).ok()?;
    // Lie derivatives that were cut off do not span the codistribution
    if rank.is_some_and(|rank| rank != words.generic_rank()) {
        return None;
    }
    Some(RankedMatrix {
        claimed: words.generic_rank(),
        entries: words.entries(),
        columns: system.column_names(),
        row_names: words.lie_derivatives.iter().map(|word| word.text(system)).collect(),
    })
}

/// The same with the differentials of functions, and the rank that it has then.
fn with_functions(
    system: &mut System,
    words: &RankedMatrix,
    functions: &[NodeId],
    claimed: usize,
) -> RankedMatrix {
    let mut all = RankedMatrix {
        entries: words.entries.clone(),
        columns: words.columns.clone(),
        row_names: words.row_names.clone(),
        claimed,
    };
    for function in functions {
        all.entries.extend(system.differential(*function));
        all.row_names.push(system.graph.text(*function));
    }
    all
}

/// What the checker needs of a proof: the rank of the Lie derivatives, and the ranks with the functions.
pub(super) fn proof(
    system: &mut System,
    on: &OnBranch,
    (is_observable, frame): (bool, Frame),
    verdict: &Verdict,
    rng: &mut ChaCha8Rng,
) -> Vec<Evidence> {
    let Some(words) = words(system, on, frame) else {
        return vec![Evidence::Unchecked(TOO_LONG.to_owned())];
    };
    let rank = words.claimed;
    let functions = on.statement.sides.clone();
    let mut matrices = Vec::new();
    match is_observable {
        true => matrices.push(with_functions(system, &words, &functions, rank)),
        false => {
            for function in functions {
                matrices.push(with_functions(system, &words, &[function], rank + 1));
            }
        }
    }
    matrices.insert(0, words);
    matrices.iter().filter_map(|matrix| claimed_rank(system, on, matrix, verdict, rng)).collect()
}

/// A function for which the contrary of the claim holds.
pub(super) struct Refuted<'a> {
    pub on: &'a OnBranch,
    pub function: NodeId,
    /// What was claimed of it.
    pub is_observable: bool,
}

impl Refuted<'_> {
    /// A state at which the Lie derivatives have their generic rank and the function's differential changes it as it does generically,
    /// with both ranks, which the checker has confirmed; an empty state where none was found.
    pub(super) fn witness(
        &self,
        system: &mut System,
        frame: Frame,
        rng: &mut ChaCha8Rng,
    ) -> (Witness, Vec<Evidence>) {
        let known = frame.generic.rank();
        let shown = words(system, self.on, frame).and_then(|words| self.at_a_state(system, &words, rng));
        let text = system.graph.text(self.function);
        let (state, rank, evidence) = match shown {
            Some((rank, point, evidence)) => (point, Some(rank), evidence),
            None => (Vec::new(), known, Vec::new()),
        };
        let (left, right) = match rank {
            Some(rank) => (
                format!("rank {} with d({text})", rank + usize::from(self.is_observable)),
                format!("rank {rank} without it"),
            ),
            None => (format!("d({text})"), "the span of what is measured".to_owned()),
        };
        (Witness { state, left, right, entry: None, refutation: None }, evidence)
    }

    fn at_a_state(
        &self,
        system: &mut System,
        words: &RankedMatrix,
        rng: &mut ChaCha8Rng,
    ) -> Option<(usize, WrittenState, Vec<Evidence>)> {
        let rank = words.claimed;
        let with_it = rank + usize::from(self.is_observable);
        let all = with_functions(system, words, &[self.function], with_it);
        let terms = Terms { sides: all.entries.clone(), relations: Vec::new(), ..self.on.statement.clone() };
        let on = OnBranch::new(system, &self.on.branch, &terms).ok()?;
        for attempt in 0..ATTEMPTS {
            let point = on.draw(system, attempt, rng);
            let Some(Values::Exact(values)) = on.sides(&point) else { continue };
            let width = words.columns.len().max(1);
            let rows: Vec<Vec<_>> = values.chunks(width).map(<[_]>::to_vec).collect();
            let rank_of = |count: usize| rank_of(&rows[..count]);
            if rank_of(rows.len() - 1) != Some(rank) || rank_of(rows.len()) != Some(with_it) {
                continue;
            }
            let certified = |system: &mut System, matrix: &RankedMatrix| {
                certified(system, &on, matrix, &point, &rows[..matrix.row_names.len()])
            };
            let both = [certified(system, words), certified(system, &all)];
            let [Some(without), Some(with)] = both else { continue };
            return Some((
                rank,
                on.describe(system, &point),
                vec![Evidence::Rank(without), Evidence::Rank(with)],
            ));
        }
        None
    }
}

fn rank_of(rows: &[Vec<RBig>]) -> Option<usize> {
    rank(&Rationals { bits: BITS }, rows.to_vec()).ok()
}

/// The rank at a state with its minor and its kernel, where the checker confirms it.
fn certified(
    system: &mut System,
    on: &OnBranch,
    matrix: &RankedMatrix,
    point: &Point,
    rows: &[Vec<RBig>],
) -> Option<CertifiedRank> {
    let width = matrix.columns.len();
    let is_angle = &system.angle_test();
    let expanded = expand_angles(&mut system.graph, &matrix.entries, is_angle);
    let program = Program::new(&system.graph, &expanded, is_angle);
    let field = PrimeField::random(&mut ChaCha8Rng::seed_from_u64(0x6d69_6e6f));
    let minor = largest_minor(&program, width, &point.state, field)?;
    let unobservable = kernel(&Rationals { bits: BITS }, rows.to_vec(), width).ok()?;
    let mut found = listed_rank(system, on, matrix, &on.free_part(point), minor).ok()?;
    for state in &mut found.states {
        state.kernel = unobservable.iter().map(|v| v.iter().cloned().map(Ratio).collect()).collect();
    }
    let confirmed = matches!(found.check(&Effort::new(WORK), &UNINTERRUPTED), Finding::Confirmed { .. });
    confirmed.then_some(found)
}
