//! The ranks of a sweep, each with the minor and the kernel by which it is checked.

use super::NotWritten;
use super::minors::largest_minor;
use super::states::exact_state;
use palmistry_budget::Share;
use palmistry_checker::Lowering;
use palmistry_checker::{
    CertifiedRank, ClaimKind, ClaimParts, Evidence, Missing, RankedState, Ratio, RecordedWord, VerdictRecord,
    listed_statement, source_digest,
};
use palmistry_lang::System;
use palmistry_math::expression::syntax::Relation;
use palmistry_math::expression::{Guard, NodeId, Program, expand_angles};
use palmistry_math::number::PrimeField;
use palmistry_rank::observability::{OWN_ROWS, assumed, parse_condition};
use palmistry_rank::sweep::{RankAnswer, RecordedState, SweepReport, TakenRow};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use std::collections::BTreeSet;

/// The recorded states of an answer as verdicts: for each branch of the conditions the full codistribution, and the
/// file's own rows where it has some.
///
/// # Errors
/// Where there are more operations than a listing holds, or a condition cannot be read.
pub fn rank_records(
    system: &mut System,
    answer: &RankAnswer,
    conditions: &[String],
) -> Result<Vec<VerdictRecord>, NotWritten> {
    // as they were read, and not as they were solved
    let (mut met, mut inequalities) = (Vec::new(), Vec::new());
    for text in conditions {
        for condition in parse_condition(text).map_err(NotWritten::Condition)? {
            let mut side =
                |expr| system.scalar(expr).map_err(|problem| NotWritten::Condition(problem.message));
            let (left, right) = (side(&condition.left)?, side(&condition.right)?);
            match assumed(&mut system.graph, condition.relation, left, right) {
                None => met.push((left, right)),
                Some(guard) => inequalities.push(guard),
            }
        }
    }
    let smooth = [system.smooth_guards(&system.moving_fields()), inequalities.clone()].concat();
    let own = [system.definition_guards(OWN_ROWS), inequalities].concat();
    let conditions_in_one = conditions.join(", ");
    let mut records = Vec::new();
    for branch in &answer.branches {
        let sweeps = [
            ("rank", ClaimKind::SystemAtStates, &branch.taken, Some(&branch.full), &smooth),
            (OWN_ROWS, ClaimKind::RowsAtStates, &branch.own, branch.rows.as_ref(), &own),
        ];
        for (id, what, rows, report, guards) in sweeps {
            let Some(report) = report.filter(|report| !report.recorded.is_empty()) else { continue };
            let held = Conditions { met: &met, guards };
            let asked = ClaimParts::listed(what, &conditions_in_one);
            records.push(VerdictRecord {
                file: answer.file.clone(),
                digest: source_digest(&system.source),
                id: id.to_owned(),
                statement: listed_statement(what, &asked.given),
                asked,
                verdict: RecordedWord::Found,
                evidence: Evidence::Rank(certified_rank(system, rows, report, held, answer.seed)?),
            });
        }
    }
    Ok(records)
}

/// What holds at every state of a sweep.
struct Conditions<'a> {
    /// Equations, left and right side.
    met: &'a [(NodeId, NodeId)],
    /// What the rows need to exist.
    guards: &'a [Guard],
}

fn certified_rank(
    system: &mut System,
    rows: &[TakenRow],
    report: &SweepReport,
    conditions: Conditions<'_>,
    seed: u64,
) -> Result<CertifiedRank, Missing> {
    let is_angle = &system.angle_test();
    let width = system.unknown_count();
    let entries: Vec<NodeId> = rows.iter().flat_map(|row| row.entries.iter().copied()).collect();
    let expanded = expand_angles(&mut system.graph, &entries, is_angle);
    let program = Program::new(&system.graph, &expanded, is_angle);
    let field = PrimeField::random(&mut ChaCha8Rng::seed_from_u64(seed));
    let graph = &system.graph;
    let with_minor = |recorded: &RecordedState| RankedState {
        state: exact_state(graph, &recorded.state),
        rank: recorded.rank,
        // a minor that is too small, or none, is noticed by the checker
        minor: largest_minor(&program, width, &recorded.state, field).unwrap_or_default(),
        kernel: recorded.unobservable.iter().map(|v| v.iter().cloned().map(Ratio).collect()).collect(),
    };
    let share = Share::here();
    let mut states: Vec<RankedState> =
        report.recorded.par_iter().map(|recorded| share.carry(|| with_minor(recorded))).collect();
    let short = states.iter().any(|state| state.rank < width);
    let needed: BTreeSet<usize> = states.iter().flat_map(|state| state.minor.rows.iter().copied()).collect();
    // a full rank is shown by the rows of its minor, a short one by all rows
    let kept: Vec<usize> = (0..rows.len()).filter(|row| short || needed.contains(row)).collect();
    for state in &mut states {
        for row in &mut state.minor.rows {
            *row = kept.binary_search(row).unwrap_or(usize::MAX);
        }
    }
    let mut lowering = Lowering::new(graph);
    let mut places = Vec::new();
    for row in &kept {
        let entries = rows[*row].entries.iter();
        places.push(entries.map(|entry| lowering.place(*entry)).collect::<Result<Vec<_>, _>>()?);
    }
    let met = conditions.met.iter();
    let met =
        met.map(|(left, right)| lowering.sides(*left, Relation::Equal, *right)).collect::<Result<_, _>>()?;
    let requirements =
        conditions.guards.iter().map(|guard| lowering.requirement(*guard)).collect::<Result<_, _>>()?;
    Ok(CertifiedRank {
        columns: system.unknowns().iter().map(|state| graph.symbol_name(*state).to_owned()).collect(),
        row_names: kept.iter().map(|row| rows[*row].lie_derivative.clone()).collect(),
        rows: places,
        conditions: met,
        requirements,
        listing: lowering.finish(),
        states,
    })
}
