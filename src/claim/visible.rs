//! Claims about single unknowns and functions of them: `observable(x, a*b)`, `unobservable(k)`.
//!
//! A function is seen at almost all states of a set where its differential lies in the span of the differentials of all words there: then
//! it is, near such a state, a function of what is measured and of its derivatives (R. Hermann and A. J. Krener, *Nonlinear
//! controllability and observability*, IEEE Trans. Automat. Control 22, 1977). Both halves are a rank: that of the words, and
//! that of the words with the function's differential. A field along which no output ever changes, and the function does, is the better
//! proof that it is not seen, and is given where it is found.

use super::evidence::{Kept, RankedMatrix, claimed_rank, listed_rank};
use super::existence::{Existence, existence};
use super::identity::OnOneBranch;
use super::rank_bounds::{Limits, Rows};
use super::ranks::{MINOR_OF_SERIES, SERIES, decide as decide_rows, decide_codistribution, on_one_branch};
use super::terms::{OnBranch, Point, Terms, Values};
use super::verdict::{Verdict, Witness};
use crate::checker::{CertifiedRank, Effort, Evidence, Finding, Ratio};
use crate::evidence::{StatementAt, largest_minor};
use crate::expression::{Guard, Need, NodeId, Program, ZeroTest, add_guard, expand_angles, identically_zero};
use crate::number::{PrimeField, Rationals};
use crate::observability::{
    Branch, Codistribution, Frame, Length, Seen, UnseenField, kernel, rank, unseen_motions,
};
use crate::sweep::UNINTERRUPTED;
use crate::system::{System, Time};
use rand_chacha::ChaCha8Rng;

/// So many states are tried for one that the checker confirms.
const ATTEMPTS: usize = 20;
/// The work of the checker on a refutation.
const WORK: u64 = 1 << 28;
/// The length to which exact values may grow.
const BITS: usize = 1 << 14;
/// Fields are looked for where there are no more unknowns.
const MOST_FOR_FIELDS: usize = 24;

/// What is known of one function, the probability of an error as a power of two; or why nothing is.
enum Known {
    Seen(f64),
    Unseen(f64),
    Open(String),
}

/// Decides that all sides of the terms are seen, or that none is, on the states of a branch.
///
/// # Errors
/// In words: there is no codistribution, or it tells apart what the conditions leave open.
pub(super) fn decide_visible(
    system: &mut System,
    on: &OnBranch,
    is_seen: bool,
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
            Known::Seen(error) if is_seen => errors.push(error),
            Known::Unseen(error) if !is_seen => errors.push(error),
            Known::Open(why) => open.push(why),
            Known::Seen(_) | Known::Unseen(_) => {
                other.get_or_insert(*function);
            }
        }
    }
    let mut evidence = Vec::new();
    let verdict = match (other, open.into_iter().next()) {
        (Some(function), _) => {
            let refuted = Refuted { on, function, is_seen };
            let (witness, shown) = refuted.witness(system, frame, rng);
            evidence = shown;
            Verdict::Refuted { engine: SERIES.to_owned(), witness }
        }
        (None, Some(why)) => Verdict::undecided(why),
        (None, None) => {
            let fields = if is_seen { None } else { fields_that_move(system, branch, functions, rng) };
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
                evidence = proof(system, on, (is_seen, frame), &verdict, &mut rng.clone());
                evidence.extend(
                    fields.iter().flatten().map(|field| kept_outputs(system, on, field, &mut rng.clone())),
                );
            }
            verdict
        }
    };
    Ok((on_one_branch(exists, || verdict), evidence))
}

/// What is known of each function, and of the set.
fn known(system: &mut System, on: &OnBranch, rng: &mut ChaCha8Rng) -> Result<(Vec<Known>, Frame), String> {
    let values = &on.branch.values;
    let functions = &on.statement.sides;
    let frame = Frame::new(system, values)?;
    let (answer, seen) = frame.functions(system, values, functions);
    // one bound holds for all that the series tell together
    let mut joint = Some(answer.log2_error);
    let mut found = Vec::new();
    for (function, seen) in functions.iter().zip(seen) {
        let row = system.differential(*function);
        let row = system.graph.substitute(&row, values);
        let is_zero = |entry: &NodeId| system.graph.constant_value(*entry).is_some_and(|v| v.is_zero());
        found.push(match seen {
            _ if row.iter().all(is_zero) => Known::Seen(f64::NEG_INFINITY),
            Seen::Yes => Known::Seen(joint.take().unwrap_or(f64::NEG_INFINITY)),
            Seen::No => Known::Unseen(joint.take().unwrap_or(f64::NEG_INFINITY)),
            Seen::Undecided => by_rows(system, on, &frame, *function, rng).unwrap_or_else(Known::Open),
        });
    }
    Ok((found, frame))
}

/// The same of one function by the ranks of rows that are written down, where series leave it open.
fn by_rows(
    system: &mut System,
    on: &OnBranch,
    frame: &Frame,
    function: NodeId,
    rng: &mut ChaCha8Rng,
) -> Result<Known, String> {
    if !frame.words_are_short(system) {
        return Err(open_series(frame));
    }
    let branch = &on.branch;
    let words = Codistribution::within(system, &branch.values, Length::UntilItStops, frame.clone())?;
    let rank = words.generic_rank().max(frame.generic.at_least);
    let mut log2_error = match decide_codistribution(system, on, branch, rank, rng)? {
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
        match decide_rows(system, &rows, limits, with_it, rng) {
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

/// Unseen fields of which each function is moved by one, those that are needed.
fn fields_that_move(
    system: &mut System,
    branch: &Branch,
    functions: &[NodeId],
    rng: &mut ChaCha8Rng,
) -> Option<Vec<UnseenField>> {
    let on_a_set =
        !branch.values.is_empty() || !branch.guards.iter().all(|guard| guard.need == Need::NotZero);
    if on_a_set || system.time == Time::Discrete || system.unknown_count() > MOST_FOR_FIELDS {
        return None;
    }
    let found = unseen_motions(system, None, &Default::default(), &Default::default())?;
    let mut needed: Vec<usize> = Vec::new();
    for function in functions {
        let by = (0..found.fields.len()).find(|field| {
            let rates = found.fields[*field].components.iter();
            let terms: Vec<NodeId> = rates
                .map(|part| {
                    let slope = crate::expression::gradient(&mut system.graph, *function, &[part.state])[0];
                    system.graph.mul(slope, part.rate)
                })
                .collect();
            let change = system.graph.sum(terms);
            let is_angle = &system.angle_test();
            let expanded = expand_angles(&mut system.graph, &[change], is_angle);
            matches!(identically_zero(&system.graph, &expanded, is_angle, rng), ZeroTest::Nonzero(_))
        })?;
        if !needed.contains(&by) {
            needed.push(by);
        }
    }
    Some(needed.into_iter().map(|field| found.fields[field].clone()).collect())
}

fn by_fields(fields: &[UnseenField]) -> Verdict {
    let one = |field: &UnseenField| {
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

/// That a field changes no output, as equations that the checker tries.
fn kept_outputs(system: &mut System, on: &OnBranch, field: &UnseenField, rng: &mut ChaCha8Rng) -> Evidence {
    let states: Vec<_> = field.components.iter().map(|part| part.state).collect();
    let mut sides = Vec::new();
    for (_, output) in system.outputs.clone() {
        let slopes = crate::expression::gradient(&mut system.graph, output, &states);
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
        return Evidence::Unchecked("no state was found at which all of it exists".to_owned());
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
        .identity("no output changes along an unseen field", field.log2_error, None)
    });
    match stated {
        Some(Ok(stated)) => Evidence::Proved(stated),
        Some(Err(why)) => Evidence::Unchecked(format!("it could not be written down: {why}")),
        None => Evidence::Unchecked("no state was found at which all of it exists".to_owned()),
    }
}

/// The words on the set, as a matrix whose rank is said to be so much; none where they are too long.
fn words(system: &mut System, on: &OnBranch, frame: Frame) -> Option<RankedMatrix> {
    if !frame.words_are_short(system) {
        return None;
    }
    let words = Codistribution::within(system, &on.branch.values, Length::UntilItStops, frame).ok()?;
    Some(RankedMatrix {
        claimed: words.generic_rank(),
        entries: words.entries(),
        columns: system.column_names(),
        words: words.words.iter().map(|word| word.text(system)).collect(),
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
        words: words.words.clone(),
        claimed,
    };
    for function in functions {
        all.entries.extend(system.differential(*function));
        all.words.push(system.graph.text(*function));
    }
    all
}

/// What the checker needs of a proof: the rank of the words, and the ranks with the functions.
fn proof(
    system: &mut System,
    on: &OnBranch,
    (is_seen, frame): (bool, Frame),
    verdict: &Verdict,
    rng: &mut ChaCha8Rng,
) -> Vec<Evidence> {
    let Some(words) = words(system, on, frame) else {
        return vec![Evidence::Unchecked("the words are too long to be written down".to_owned())];
    };
    let rank = words.claimed;
    let functions = on.statement.sides.clone();
    let mut matrices = Vec::new();
    match is_seen {
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

/// A function of which the contrary is so.
struct Refuted<'a> {
    on: &'a OnBranch,
    function: NodeId,
    /// What was claimed of it.
    is_seen: bool,
}

impl Refuted<'_> {
    /// A state at which the words have the rank that they have almost everywhere and the function's differential does to it what it
    /// does there, with both ranks for the checker, which has confirmed them; no state where none was found.
    fn witness(&self, system: &mut System, frame: Frame, rng: &mut ChaCha8Rng) -> (Witness, Vec<Evidence>) {
        let known = frame.generic.rank();
        let shown = words(system, self.on, frame).and_then(|words| self.at_a_state(system, &words, rng));
        let text = system.graph.text(self.function);
        let (state, rank, evidence) = match shown {
            Some((rank, point, evidence)) => (point, Some(rank), evidence),
            None => (Vec::new(), known, Vec::new()),
        };
        let (left, right) = match rank {
            Some(rank) => (
                format!("rank {} with d({text})", rank + usize::from(self.is_seen)),
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
    ) -> Option<(usize, crate::observability::StateInWords, Vec<Evidence>)> {
        let rank = words.claimed;
        let with_it = rank + usize::from(self.is_seen);
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
                certified(system, &on, matrix, &point, &rows[..matrix.words.len()])
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

fn rank_of(rows: &[Vec<dashu::rational::RBig>]) -> Option<usize> {
    rank(&Rationals { bits: BITS }, rows.to_vec()).ok()
}

/// The rank at a state with its minor and its kernel, where the checker confirms it.
fn certified(
    system: &mut System,
    on: &OnBranch,
    matrix: &RankedMatrix,
    point: &Point,
    rows: &[Vec<dashu::rational::RBig>],
) -> Option<CertifiedRank> {
    let width = matrix.columns.len();
    let is_angle = &system.angle_test();
    let expanded = expand_angles(&mut system.graph, &matrix.entries, is_angle);
    let program = Program::new(&system.graph, &expanded, is_angle);
    let field = PrimeField::random(&mut <ChaCha8Rng as rand::SeedableRng>::seed_from_u64(0x6d69_6e6f));
    let minor = largest_minor(&program, width, &point.state, field)?;
    let unseen = kernel(&Rationals { bits: BITS }, rows.to_vec(), width).ok()?;
    let mut found = listed_rank(system, on, matrix, &on.free_part(point), minor).ok()?;
    for state in &mut found.states {
        state.kernel = unseen.iter().map(|v| v.iter().cloned().map(Ratio).collect()).collect();
    }
    let confirmed = matches!(found.check(&Effort::new(WORK), &UNINTERRUPTED), Finding::Confirmed { .. });
    confirmed.then_some(found)
}

/// What functions need to be smooth, and not only to exist.
pub(super) fn smooth(guards: &mut [Guard]) {
    for guard in guards {
        guard.need = guard.need.smooth();
    }
}
