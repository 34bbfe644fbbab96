//! What is answered to the question of a rank, and what stands in the way of an answer.

use super::asked::RankQuestion;
use super::deviation::StandardDeviations;
use super::part::MergeError;
use super::states::SweepReport;
use crate::observability::{
    Branch, CodistributionError, Frame, GenericAnswer, LocusError, Stop, UnobservableDirections, Unsolved,
};
use dashu::rational::RBig;
use palmistry_budget::Spent;
use palmistry_lang::{Assignment, FieldRole, Range, SymbolInfo, System, Time, UnknownKind};
use palmistry_math::expression::{NodeId, Symbol};
use std::collections::HashSet;

/// A row whose rank was decided.
pub struct TakenRow {
    /// The Lie derivative of which it is the differential; of the file's own rows, their number, counted from one.
    pub lie_derivative: String,
    /// Its entries, one for each unknown of the system.
    pub entries: Vec<NodeId>,
}

/// What was found on one branch of the conditions.
pub struct BranchAnswer {
    /// The conditions, solved, in words.
    pub conditions: Vec<String>,
    /// The parameters that the rank depends on and the file gives a value to: they were fixed at it. A claim about the rank is
    /// about all values.
    pub held: Vec<(String, RBig)>,
    /// What is drawn from a range that the file does not give, and this range.
    pub by_default: Vec<(String, Range)>,
    /// The Lie derivatives that were needed, as a paper writes them.
    pub lie_derivatives: Vec<String>,
    /// What is observable at almost all states of the branch, and whether each unknown is.
    pub generic: GenericAnswer,
    /// The unknowns: their names and what they are.
    pub unknowns: Vec<(String, UnknownKind)>,
    /// The length of the longest Lie derivative taken, and why no longer ones were.
    pub order: usize,
    /// Why no longer Lie derivatives were taken.
    pub stop: Stop,
    /// The rank at almost all states of the branch, by these Lie derivatives.
    pub generic_rank: usize,
    /// Whether longer Lie derivatives cannot raise it there.
    pub is_final: bool,
    /// Whether the rank is not known because no longer Lie derivatives were looked at, though nobody asked for shorter ones.
    pub cut_off: bool,
    /// The unobservable directions as fields, and the observable part as functions: where the rank is short of the dimension and no
    /// condition is one on states.
    pub motions: Option<UnobservableDirections>,
    /// The rank of the full codistribution at the sampled states.
    pub full: SweepReport,
    /// How well each state is observable where what is measured has noise; none where the sweep was interrupted.
    pub deviations: Option<StandardDeviations>,
    /// The rank of the file's own choice of rows at the same states, where it defines a matrix `rows`.
    pub rows: Option<SweepReport>,
    /// The rows of the full codistribution.
    pub taken: Vec<TakenRow>,
    /// The file's own rows.
    pub own: Vec<TakenRow>,
}

/// What is known of a branch of the conditions before states are looked at, or Lie derivatives written down.
#[derive(Clone, Debug)]
pub struct GenericOnBranch {
    /// The conditions, solved, in words.
    pub conditions: Vec<String>,
    /// What is observable at almost all of its states, and whether each unknown is.
    pub generic: GenericAnswer,
    /// The unknowns: their names and what they are.
    pub unknowns: Vec<(String, UnknownKind)>,
}

impl BranchAnswer {
    /// Whether the rank at a sampled state is that of the Lie derivatives which were taken, and higher ones may raise it: the rank of all is not
    /// known on the branch, or is higher at almost all of its states.
    pub fn may_be_raised(&self, rank: usize) -> bool {
        rank < self.unknowns.len() && (!self.is_final || rank < self.generic_rank)
    }

    /// Whether it may at one of the sampled states.
    pub fn is_short_somewhere(&self) -> bool {
        self.full.rank_histogram.keys().any(|rank| self.may_be_raised(*rank))
    }
}

impl GenericOnBranch {
    pub(super) fn new(system: &System, branch: &Branch, frame: &Frame) -> GenericOnBranch {
        let mut solved: Vec<_> = branch.values.iter().collect();
        solved.sort_unstable();
        let condition = |(symbol, value): (&Symbol, &NodeId)| {
            format!("{} = {}", system.symbol_name(*symbol), system.graph.text(*value))
        };
        GenericOnBranch {
            conditions: solved.into_iter().map(condition).collect(),
            generic: frame.generic.clone(),
            unknowns: named_unknowns(system),
        }
    }
}

/// What was found.
pub struct RankAnswer {
    /// The file of the system.
    pub file: String,
    /// The title of the system.
    pub title: String,
    /// How many outputs it has.
    pub outputs: usize,
    /// The fields along which Lie derivatives are taken.
    pub fields: Vec<FieldRole>,
    /// The seed of the drawn states.
    pub seed: u64,
    /// The number of unknowns of the system: the rank where all are observable.
    pub dimension: usize,
    /// The coordinates that are known and have no column, by name.
    pub known: Vec<String>,
    /// What is assumed of unknown signals.
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
    /// Removes all times.
    pub fn forget_times(&mut self) {
        for branch in &mut self.branches {
            branch.full.seconds = f64::NAN;
            branch.rows.iter_mut().for_each(|rows| rows.seconds = f64::NAN);
        }
    }

    /// Whether a search was cut off: longer Lie derivatives might raise the rank, and no series decided it.
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
    /// A symbol that is both fixed and solved for.
    #[error("'{0}' is fixed and solved for in a condition; choose one")]
    HeldAndSolved(String),
    /// No field moves the states, or every state is a pole.
    #[error(transparent)]
    Codistribution(#[from] CodistributionError),
    /// On all of the set the argument of an absolute value vanishes.
    #[error(
        "all of these states lie in a kink of an absolute value, where the rules of derivatives give no Lie derivatives; a claim 'rank = n where ...' is decided by those that are continuously differentiable there"
    )]
    InAKink,
    /// No state can be drawn.
    #[error(transparent)]
    Locus(#[from] LocusError),
    /// States that are handed over cannot be decided; in words, why.
    #[error("{0}")]
    NotAtGivenStates(String),
    /// Parts that do not make a whole.
    #[error(transparent)]
    Merge(#[from] MergeError),
    /// Lie derivatives or brackets are too large, or what is to be decided about them is too much work.
    #[error("cut off: {0}, and no question may take more")]
    CutOff(#[from] Spent),
}

/// The parameters with a value in the file, and no other from the question, that outputs, fields and own rows mention.
pub(crate) fn held_parameters<'a>(
    system: &System,
    question: &RankQuestion<'_>,
    solved: &Assignment,
    own: impl Iterator<Item = &'a NodeId>,
) -> Vec<(String, RBig)> {
    let mut nodes: Vec<NodeId> = system.outputs.iter().map(|(_, node)| *node).chain(own.copied()).collect();
    for field in system.moving_fields() {
        nodes.extend(system.fields[field].components.iter().map(|(_, node)| *node));
    }
    // what the conditions put in depends on parameters too, as initial values do
    nodes.extend(solved.values());
    let mentioned = system.graph.symbols_of(nodes);
    let held = |(symbol, info): (Symbol, &SymbolInfo)| {
        let value = info.default.clone().filter(|_| info.range.is_none() && mentioned.contains(&symbol))?;
        let given = question.fixed.contains_key(&symbol) || solved.contains_key(&symbol);
        (!given).then(|| (system.symbol_name(symbol).to_owned(), value))
    };
    system.symbols().filter_map(held).collect()
}

/// What outputs and fields divide by, and take roots and logarithms of: a state has to have values for it too, also where no entry
/// of the codistribution mentions it, as the mass in `v' = -x/m` where `x` and `v` are measured.
pub(super) fn guarded(system: &System) -> Vec<NodeId> {
    let guards = system.smooth_guards(&system.moving_fields());
    let open = guards.iter().filter(|guard| guard.is_obvious(&system.graph) != Some(true));
    open.map(|guard| guard.node).collect()
}

/// The unknowns of a system, by name; a state that no field moves is a parameter, whatever it is called.
pub(crate) fn named_unknowns(system: &System) -> Vec<(String, UnknownKind)> {
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
