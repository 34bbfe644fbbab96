//! The whole question of a rank, from a system and some conditions to sweeps of every branch.

use super::asked::{RankQuestion, held_conditions};
use super::cells::by_signs;
use super::deviation::{StandardDeviations, standard_deviations};
use super::series::sweep_by_series;
use super::states::{SweepOptions, SweepReport, sweep};
use crate::expression::{Guard, NodeId, Symbol};
use crate::observability::{
    Branch, Codistribution, CodistributionError, Frame, GenericAnswer, Length, Locus, LocusError, OWN_ROWS,
    Probe, Stop, UnseenMotions, Unsolved, in_sign_cell, parse_condition, solve_conditions, unseen_motions,
};
use crate::system::{Assignment, FieldRole, Range, SymbolInfo, System, Time, UnknownKind, Value};
use dashu::rational::RBig;
use std::collections::HashSet;

/// A row whose rank was decided.
pub struct TakenRow {
    /// The word of which it is the differential; of the file's own rows, their number, counted from one.
    pub word: String,
    /// Its entries, one for each state of the system.
    pub entries: Vec<NodeId>,
}

/// What was found on one branch of the conditions.
pub struct BranchAnswer {
    /// The conditions, solved, in words.
    pub conditions: Vec<String>,
    /// The parameters that the rank depends on and the file gives a value to: they were held at it. A claim about the rank is
    /// about all values.
    pub held: Vec<(String, RBig)>,
    /// What is drawn from a range that the file does not give, and this range.
    pub by_default: Vec<(String, Range)>,
    /// The words that were needed, as a paper writes them.
    pub words: Vec<String>,
    /// What is seen at almost all states of the branch, and of each unknown whether it is.
    pub generic: GenericAnswer,
    /// The unknowns: their names and what they are.
    pub unknowns: Vec<(String, UnknownKind)>,
    /// The length of the longest word taken, and why no longer ones were.
    pub order: usize,
    /// Why no longer words were taken.
    pub stop: Stop,
    /// The rank at almost all states of the branch, by these words.
    pub generic_rank: usize,
    /// Whether longer words cannot raise it there.
    pub is_final: bool,
    /// Whether the rank is not known because no longer words were looked at, though nobody asked for shorter ones.
    pub cut_off: bool,
    /// What is not seen as fields, and what is seen of it as functions: where the rank is short of the dimension and no
    /// condition is one on states.
    pub motions: Option<UnseenMotions>,
    /// The rank of the full codistribution at the sampled states.
    pub full: SweepReport,
    /// How well each state is seen where what is measured has noise; none where the sweep was interrupted.
    pub deviations: Option<StandardDeviations>,
    /// The rank of the file's own choice of rows at the same states, where it defines a matrix `rows`.
    pub rows: Option<SweepReport>,
    /// The rows of the full codistribution.
    pub taken: Vec<TakenRow>,
    /// The file's own rows.
    pub own: Vec<TakenRow>,
}

/// What was found.
pub struct RankAnswer {
    /// The file and the title of the system.
    pub file: String,
    /// The title of the system.
    pub title: String,
    /// How many outputs it has.
    pub outputs: usize,
    /// The fields that the words take.
    pub fields: Vec<FieldRole>,
    /// The seed of the drawn states.
    pub seed: u64,
    /// The number of states of the system: the rank of one that is seen.
    pub dimension: usize,
    /// The coordinates that are known and have no column, by name.
    pub known: Vec<String>,
    /// What is assumed of signals that are not known.
    pub assumed: Vec<String>,
    /// An answer for each branch of the conditions, and for each part of one by the signs on which roots depend; one where there are
    /// none.
    pub branches: Vec<BranchAnswer>,
    /// Parts by signs of which no state was found in the sample box, in words.
    pub left_out: Vec<String>,
}

impl RankAnswer {
    /// Whether any sweep was stopped early.
    pub fn interrupted(&self) -> bool {
        self.branches.iter().any(|branch| branch.full.interrupted)
    }
}

impl RankAnswer {
    /// Whether a search ended before its end: longer words might say more, and no series did.
    pub fn cut_off(&self) -> bool {
        self.branches.iter().any(|branch| branch.cut_off)
    }
}

/// Why there is no answer.
#[derive(Clone, Debug, thiserror::Error)]
pub enum RankError {
    /// The file declares no states or no outputs.
    #[error("{0} declares no states or no outputs")]
    NothingToSee(String),
    /// A condition that cannot be read, or that fixes an angle up to whole turns where these matter.
    #[error("{0}")]
    Condition(String),
    /// A condition that cannot be solved.
    #[error(transparent)]
    Unsolved(#[from] Unsolved),
    /// A symbol that is both held and solved for.
    #[error("'{0}' is fixed with --at and solved for in a condition; choose one")]
    HeldAndSolved(String),
    /// No field moves the states, or every state is a pole.
    #[error(transparent)]
    Codistribution(#[from] CodistributionError),
    /// No state can be drawn.
    #[error(transparent)]
    Locus(#[from] LocusError),
}

/// The parameters with a value in the file, and no other from the question, that outputs, fields and own rows mention.
pub(super) fn held_parameters<'a>(
    system: &System,
    question: &RankQuestion<'_>,
    solved: &Assignment,
    own: impl Iterator<Item = &'a NodeId>,
) -> Vec<(String, RBig)> {
    let mut nodes: Vec<NodeId> = system.outputs.iter().map(|(_, node)| *node).chain(own.copied()).collect();
    for field in system.moving_fields() {
        nodes.extend(system.fields[field].components.iter().map(|(_, node)| *node));
    }
    let mentioned = system.graph.symbols_of(nodes);
    let held = |(symbol, info): (Symbol, &SymbolInfo)| {
        let value = info.default.clone().filter(|_| info.range.is_none() && mentioned.contains(&symbol))?;
        let given = question.fixed.contains_key(&symbol) || solved.contains_key(&symbol);
        (!given).then(|| (system.symbol_name(symbol).to_owned(), value))
    };
    system.symbols().filter_map(held).collect()
}

/// What outputs and fields divide by, and take roots and logarithms of: a state has to have values for it too, also where no entry
/// of the codistribution mentions it, as the mass in `v' = -x/m` where `x` and `v` are seen.
pub(super) fn guarded(system: &System) -> Vec<NodeId> {
    let guards = system.smooth_guards(&system.moving_fields());
    let open = guards.iter().filter(|guard| guard.is_obvious(&system.graph) != Some(true));
    open.map(|guard| guard.node).collect()
}

/// The unknowns of a system, by name; a state that no field moves is a parameter, whatever it is called.
pub(super) fn named_unknowns(system: &System) -> Vec<(String, UnknownKind)> {
    let fields = || system.moving_fields().into_iter().flat_map(|field| &system.fields[field].components);
    let moved: HashSet<Symbol> = fields()
        .filter(|(symbol, rate)| match system.time {
            Time::Continuous => !system.graph.constant_value(*rate).is_some_and(RBig::is_zero),
            Time::Discrete => system.graph.as_symbol(*rate) != Some(*symbol),
        })
        .map(|(symbol, _)| *symbol)
        .collect();
    let named = |symbol: Symbol| {
        let kind = match system.unknown_kind(symbol) {
            Some(UnknownKind::State) | None if !moved.contains(&symbol) => UnknownKind::Parameter,
            kind => kind.unwrap_or(UnknownKind::State),
        };
        (system.symbol_name(symbol).to_owned(), kind)
    };
    system.unknowns().into_iter().map(named).collect()
}

/// The unseen fields, where something is unseen and all conditions are on parameters; `given` are those of the question.
fn motions(
    system: &mut System,
    codistribution: &Codistribution,
    conditions: &Assignment,
    given: &[Symbol],
) -> Option<UnseenMotions> {
    let found = codistribution.generic.rank().unwrap_or(codistribution.generic_rank());
    let unseen = found < system.unknown_count();
    let of_states = |system: &System, symbol: &Symbol, value: NodeId| {
        let mentioned = system.graph.symbols_of([value]);
        [*symbol].iter().chain(&mentioned).any(|symbol| system.states.contains(symbol))
    };
    if !unseen || conditions.iter().any(|(symbol, value)| of_states(system, symbol, *value)) {
        return None;
    }
    let given = given.iter().map(|symbol| (*symbol, conditions[symbol])).collect();
    let found = unseen_motions(system, Some(codistribution), conditions, &given)?;
    (found.directions() > 0).then_some(found)
}

/// Answers a question about the rank of a system's observability codistribution.
///
/// # Errors
/// No states or outputs, no drift or input, conditions that cannot be solved, a pole everywhere, an empty sample box.
pub fn answer_rank(system: &mut System, question: &RankQuestion<'_>) -> Result<RankAnswer, RankError> {
    answer(system, question, false)
}

/// The same, but states are drawn only where the words that show what is seen are short enough to be written down in a moment.
///
/// # Errors
/// As for [`answer_rank`].
pub fn answer_rank_at_once(
    system: &mut System,
    question: &RankQuestion<'_>,
) -> Result<RankAnswer, RankError> {
    answer(system, question, true)
}

fn answer(
    system: &mut System,
    question: &RankQuestion<'_>,
    only_if_short: bool,
) -> Result<RankAnswer, RankError> {
    if system.unknown_count() == 0 || system.outputs.is_empty() {
        return Err(RankError::NothingToSee(system.name.clone()));
    }
    system.require_motion().map_err(CodistributionError::NoMotion)?;
    let mut equations = Vec::new();
    for text in &question.conditions {
        equations.extend(parse_condition(text).map_err(RankError::Condition)?);
    }
    equations.extend(system.initial_conditions().iter().cloned());
    let mut branches = Vec::new();
    for branch in solve_conditions(system, &equations)? {
        branches.push(branch.tied_by_outputs(system)?);
    }
    for branch in &mut branches {
        for symbol in question.fixed.keys() {
            if branch.values.contains_key(symbol) {
                return Err(RankError::HeldAndSolved(system.symbol_name(*symbol).to_owned()));
            }
        }
    }
    let own = match system.definition(OWN_ROWS) {
        Some(Value::Matrix(matrix)) if matrix.columns == system.unknown_count() => {
            Some(matrix.entries.clone())
        }
        _ => None,
    };
    let own_guards = system.definition_guards(OWN_ROWS);
    let mut answers = Vec::new();
    let mut left_out = Vec::new();
    for part in by_signs(system, question, branches, own.as_deref().unwrap_or_default()) {
        let unsampled =
            RankQuestion { samples: 0, conditions: Vec::new(), fixed: question.fixed.clone(), ..*question };
        let question = if part.without_states.is_some() { &unsampled } else { question };
        left_out.extend(part.without_states);
        let work = |system: &mut System| {
            answer_branch(system, question, only_if_short, &part.branch, own.as_deref(), &own_guards)
        };
        answers.push(in_sign_cell(system, &part.cell, work)?);
    }
    Ok(RankAnswer {
        file: system.name.clone(),
        title: system.title.clone(),
        outputs: system.outputs.len(),
        fields: system.roles(),
        seed: question.seed,
        dimension: system.unknown_count(),
        known: system.known_names(),
        assumed: system.assumed_of_signals(),
        branches: answers,
        left_out,
    })
}

/// The answer on one branch.
fn answer_branch(
    system: &mut System,
    question: &RankQuestion<'_>,
    only_if_short: bool,
    branch: &Branch,
    own: Option<&[NodeId]>,
    own_guards: &[Guard],
) -> Result<BranchAnswer, RankError> {
    branch.check_codistribution(system).map_err(RankError::Condition)?;
    let conditions = held_conditions(system, question, branch);
    let given = |symbol: &Symbol| branch.values.contains_key(symbol) || question.fixed.contains_key(symbol);
    let given: Vec<Symbol> = conditions.keys().copied().filter(given).collect();
    let length = question.order.map_or(Length::UntilItStops, Length::Exactly);
    let frame = Frame::new(system, &conditions)?;
    let wanted = question.samples > 0 && (!only_if_short || frame.words_are_short(system));
    let samples = if wanted { question.samples } else { 0 };
    let codistribution = match wanted {
        true => Codistribution::within(system, &conditions, length, frame)?,
        false => Codistribution::without_words(frame),
    };
    let all = codistribution.entries();
    let mut mentioned: Vec<NodeId> = all.clone();
    mentioned.extend(own.into_iter().flatten());
    mentioned.extend(guarded(system));
    let locus = Locus::new(system, branch, &question.fixed, &mentioned)?;
    let options = SweepOptions {
        samples,
        seed: question.seed,
        most: None,
        guards: &[],
        wanted: question.wanted,
        digits: question.digits,
        recorded: question.recorded,
        interrupt: question.interrupt,
        progress: question.progress,
    };
    // words that somebody asked for are looked at as they are; functions have no residues at a state
    let by_series =
        codistribution.is_cut_off() && question.order.is_none() && system.time == Time::Continuous;
    let probe = by_series.then(|| Probe::new(system, &conditions)).filter(|probe| !probe.has_functions());
    let full = if let Some(probe) = &probe {
        let options = SweepOptions { most: Some(codistribution.most()), ..options };
        sweep_by_series(system, &locus, probe, &options)?
    } else {
        codistribution.sweep(system, &locus, options)?
    };
    let deviations = match full.interrupted || probe.is_some() || !wanted {
        true => None,
        false => standard_deviations(system, &locus, &codistribution, &full, question.seed, samples)?,
    };
    let rows = match own {
        Some(own) if wanted => {
            let silent = SweepOptions { guards: own_guards, progress: &|_| (), ..options };
            Some(sweep(system, &locus, own, own, silent)?)
        }
        _ => None,
    };
    let mut codistribution = codistribution;
    codistribution.generic.seen_at_states(system, &full);
    let known = codistribution.generic.is_final() && question.order.is_none();
    let motions = motions(system, &codistribution, &conditions, &given);
    let generic_rank =
        codistribution.generic.rank().filter(|_| known).unwrap_or(codistribution.generic_rank());
    // fields settle what the rank of all words is, and these words may be fewer
    let settled = motions.as_ref().is_some_and(|found| {
        found.settles_the_rank && generic_rank + found.directions() == system.unknown_count()
    });
    let word = |(word, entries): (&crate::observability::Word, &Vec<NodeId>)| TakenRow {
        word: word.text(system),
        entries: entries.clone(),
    };
    let numbered = |(index, entries): (usize, &[NodeId])| TakenRow {
        word: format!("row {}", index + 1),
        entries: entries.to_vec(),
    };
    let own_rows = own.unwrap_or_default().chunks(system.unknown_count());
    Ok(BranchAnswer {
        taken: codistribution.words.iter().zip(&codistribution.rows).map(word).collect(),
        own: own_rows.enumerate().map(numbered).collect(),
        conditions: locus.conditions.clone(),
        by_default: locus.by_default.clone(),
        held: held_parameters(system, question, &branch.values, own.into_iter().flatten()),
        words: codistribution.needed.iter().map(|i| codistribution.words[*i].text(system)).collect(),
        unknowns: named_unknowns(system),
        order: codistribution.order,
        stop: codistribution.stop,
        generic_rank,
        is_final: codistribution.is_final() || known || settled,
        motions,
        cut_off: question.order.is_none()
            && !known
            && !codistribution.is_final()
            && !codistribution.has_rested(),
        generic: codistribution.generic,
        full,
        deviations,
        rows,
    })
}
