//! Claims about single unknowns and functions of them: `observable(x, a*b)`, `unobservable(k)`.
//!
//! A function is observable at almost all states of a set where its differential lies in the span of the differentials of all Lie
//! derivatives there: near such a state it is a function of the outputs and their derivatives (R. Hermann and A. J. Krener, *Nonlinear
//! controllability and observability*, IEEE Trans. Automat. Control 22, 1977). Both halves are a rank: that of the Lie derivatives,
//! and that of the Lie derivatives with the function's differential. A field along which no output changes but the function does is
//! the better proof that it is unobservable, and is given where it is found.

use super::claimed_ranks::ClaimedRanks;
use super::evidence::Kept;
use super::existence::{Existence, existence};
use super::identity::OnOneBranch;
use super::rank_bounds::{Limits, Rows};
use super::ranks::{MINOR_OF_SERIES, SERIES, decide as decide_rows, decide_codistribution, on_one_branch};
use super::terms::{OnBranch, Terms};
use super::verdict::Verdict;
use super::visible_evidence::{Refuted, kept_outputs, proof};
use palmistry_checker::Evidence;
use palmistry_lang::{System, Time};
use palmistry_math::expression::{
    Guard, Need, NodeId, Related, ZeroTest, add_guard, expand_angles, gradient, identically_zero,
    zero_by_relations,
};
use palmistry_rank::observability::{
    Branch, Codistribution, Frame, Length, Observability, UnobservableField, unobservable_directions,
};
use rand_chacha::ChaCha8Rng;

/// Fields are looked for where there are no more unknowns.
const MOST_FOR_FIELDS: usize = 24;

/// What is known of one function, the probability of an error as a power of two; or why nothing is.
enum Known {
    Seen(f64),
    Unseen(f64),
    Open(String),
}

/// Decides that all sides of the terms are observable, or that none is, on the states of a branch.
///
/// # Errors
/// In words: there is no codistribution, or it distinguishes values that the conditions leave open.
pub(super) fn decide_visible(
    system: &mut System,
    on: &OnBranch,
    is_observable: bool,
    kept: Kept,
    rng: &mut ChaCha8Rng,
) -> Result<(OnOneBranch, Vec<Evidence>), String> {
    if system.outputs.is_empty() || system.unknown_count() == 0 {
        return Err("there is no codistribution: the file declares no states or no outputs".to_owned());
    }
    let branch = &on.branch;
    branch.check_codistribution(system)?;
    let exists = existence(system, on, rng);
    if let Existence::Nowhere(guard) = exists {
        return Ok((OnOneBranch::Empty(guard), Vec::new()));
    }
    // what the functions need may be used of the outputs as well: nothing is said of other states
    let guards = system.output_guards.clone();
    if let Some(first) = system.output_guards.first_mut() {
        on.statement.guards.iter().for_each(|guard| add_guard(&system.graph, first, *guard));
    }
    let found = known(system, on, rng);
    system.output_guards = guards;
    let (known, frame) = found?;
    let functions = &on.statement.sides;
    let (mut errors, mut open, mut other) = (Vec::new(), Vec::new(), None);
    for (function, known) in functions.iter().zip(known) {
        match known {
            Known::Seen(error) if is_observable => errors.push(error),
            Known::Unseen(error) if !is_observable => errors.push(error),
            Known::Open(why) => open.push(why),
            Known::Seen(_) | Known::Unseen(_) => {
                other.get_or_insert(*function);
            }
        }
    }
    let mut evidence = Vec::new();
    let verdict = match (other, open.into_iter().next()) {
        (Some(function), _) => {
            let refuted = Refuted { on, function, is_observable };
            let (witness, shown) = refuted.witness(system, frame, rng);
            evidence = shown;
            Verdict::Refuted { engine: SERIES.to_owned(), witness }
        }
        (None, Some(why)) => Verdict::undecided(why),
        (None, None) => {
            let fields = if is_observable { None } else { fields_that_move(system, branch, functions, rng) };
            let log2_error = errors.iter().map(|error| error.exp2()).sum::<f64>().log2();
            let verdict = match &fields {
                Some(fields) => by_fields(fields),
                None => {
                    let engine = if log2_error == f64::NEG_INFINITY { MINOR_OF_SERIES } else { SERIES };
                    Verdict::Proved { engine: engine.to_owned(), log2_error }
                }
            };
            if kept == Kept::Evidence {
                // random numbers of its own: what is kept changes no verdict
                evidence = proof(system, on, (is_observable, frame), &verdict, &mut rng.clone());
                evidence.extend(
                    fields.iter().flatten().map(|field| kept_outputs(system, on, field, &mut rng.clone())),
                );
            }
            verdict
        }
    };
    Ok((on_one_branch(exists, || verdict), evidence))
}

/// What is known of each function, and the frame for the set.
fn known(system: &mut System, on: &OnBranch, rng: &mut ChaCha8Rng) -> Result<(Vec<Known>, Frame), String> {
    let values = &on.branch.values;
    let functions = &on.statement.sides;
    let frame = Frame::new(system, values)?;
    let (answer, seen) = frame.functions(system, values, functions);
    // one bound holds for all results of the series together
    let mut joint = Some(answer.log2_error);
    let mut found = Vec::new();
    for (function, seen) in functions.iter().zip(seen) {
        let row = system.differential(*function);
        let row = system.graph.substitute(&row, values);
        let is_zero = |entry: &NodeId| system.graph.constant_value(*entry).is_some_and(|v| v.is_zero());
        found.push(match seen {
            _ if row.iter().all(is_zero) => Known::Seen(f64::NEG_INFINITY),
            Observability::Yes => Known::Seen(joint.take().unwrap_or(f64::NEG_INFINITY)),
            Observability::No => Known::Unseen(joint.take().unwrap_or(f64::NEG_INFINITY)),
            Observability::Undecided => {
                by_rows(system, on, &frame, *function, rng).unwrap_or_else(Known::Open)
            }
        });
    }
    Ok((found, frame))
}

/// The same for one function by the ranks of rows that are written down, where series leave it open.
fn by_rows(
    system: &mut System,
    on: &OnBranch,
    frame: &Frame,
    function: NodeId,
    rng: &mut ChaCha8Rng,
) -> Result<Known, String> {
    if !frame.lie_derivatives_are_short(system) {
        return Err(open_series(frame));
    }
    let branch = &on.branch;
    let words = Codistribution::within(system, &branch.values, Length::UntilItStops, frame.clone())?;
    let rank = words.generic_rank().max(frame.generic.at_least);
    let mut log2_error = match decide_codistribution(system, on, branch, ClaimedRanks::exactly(rank), rng)? {
        OnOneBranch::Verdict(Verdict::Proved { log2_error, .. }, _) => log2_error.exp2(),
        OnOneBranch::Verdict(Verdict::Undecided { why }, _) => return Err(why),
        _ => return Err(open_series(frame)),
    };
    let columns = system.unknown_count();
    let differential = system.differential(function);
    let all = [words.entries(), differential.clone()].concat();
    let entries = system.graph.substitute(&all, &branch.values);
    let sides = [words.needed_entries(), differential].concat();
    let terms = Terms { sides, guards: on.statement.guards.clone(), ..Terms::default() };
    let needed = OnBranch::new(system, branch, &terms)?;
    let limits = Limits { most: columns, log2_error: f64::NEG_INFINITY, settled: false };
    let mut why = open_series(frame);
    for with_it in [rank, rank + 1] {
        let rows = Rows { entries: &entries, columns, scope: "", on: &needed };
        match decide_rows(system, &rows, limits, ClaimedRanks::exactly(with_it), rng) {
            Verdict::Proved { log2_error: error, .. } => {
                log2_error += error.exp2();
                let log2_error = log2_error.log2();
                return Ok(if with_it == rank { Known::Seen(log2_error) } else { Known::Unseen(log2_error) });
            }
            Verdict::Undecided { why: other } => why = other,
            _ => {}
        }
    }
    Err(why)
}

fn open_series(frame: &Frame) -> String {
    let why = frame.generic.open.clone();
    why.unwrap_or_else(|| "the rank with its differential is not known".to_owned())
}

/// Unobservable directions, as few as needed, such that each function changes along one of them.
fn fields_that_move(
    system: &mut System,
    branch: &Branch,
    functions: &[NodeId],
    rng: &mut ChaCha8Rng,
) -> Option<Vec<UnobservableField>> {
    let on_a_set =
        !branch.values.is_empty() || !branch.guards.iter().all(|guard| guard.need == Need::NotZero);
    if on_a_set || system.time == Time::Discrete || system.unknown_count() > MOST_FOR_FIELDS {
        return None;
    }
    let found = unobservable_directions(system, None, &Default::default(), &Default::default())?;
    let mut needed: Vec<usize> = Vec::new();
    for function in functions {
        let by = (0..found.fields.len()).find(|field| {
            let rates = found.fields[*field].components.iter();
            let terms: Vec<NodeId> = rates
                .map(|part| {
                    let slope = gradient(&mut system.graph, *function, &[part.state])[0];
                    system.graph.mul(slope, part.rate)
                })
                .collect();
            let change = system.graph.sum(terms);
            let is_angle = &system.angle_test();
            let expanded = expand_angles(&mut system.graph, &[change], is_angle);
            // functions may satisfy relations that the test does not know
            matches!(identically_zero(&system.graph, &expanded, is_angle, rng), ZeroTest::Nonzero(_))
                && matches!(
                    zero_by_relations(&mut system.graph, &expanded, &branch.guards, is_angle, rng),
                    Related::NoFunctions
                )
        })?;
        if !needed.contains(&by) {
            needed.push(by);
        }
    }
    Some(needed.into_iter().map(|field| found.fields[field].clone()).collect())
}

fn by_fields(fields: &[UnobservableField]) -> Verdict {
    let one = |field: &UnobservableField| {
        let parts = field.components.iter().map(|part| format!("{}' = {}", part.name, part.text));
        parts.collect::<Vec<_>>().join(", ")
    };
    let all: Vec<String> = fields.iter().map(one).collect();
    let errors = fields.iter().map(|field| field.log2_error.exp2()).sum::<f64>();
    Verdict::Proved {
        engine: format!("nothing that is measured changes along {}", all.join("; nor along ")),
        log2_error: errors.log2(),
    }
}

/// What functions need to be smooth, and not only to exist.
pub(super) fn smooth(guards: &mut [Guard]) {
    for guard in guards {
        guard.need = guard.need.smooth();
    }
}
