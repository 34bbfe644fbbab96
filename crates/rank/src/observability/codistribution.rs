//! The observability codistribution (equations 4.36 and 4.37): the differentials of the outputs and of their repeated
//! Lie derivatives along words of fields, added shortest first.

use super::conditions::{all_vanish, vanishes};
use super::generic::{GenericAnswer, Observability, generic_answer, generic_answer_of};
use super::needed::{CodistributionError, needed};
use super::saturation::{Ceiling, RankGrowth, Saturation, Stop, is_invariant};
use super::series::lie_derivative_by_series;
use palmistry_lang::{Assignment, System, Time};
use palmistry_math::expression::{Node, NodeId, gradient};
use palmistry_math::number::Function;

/// The name of the matrix that holds a paper's own choice of rows.
pub const OWN_ROWS: &str = "rows";

/// A repeated Lie derivative of an output: `L_{X1} L_{X2} ... h`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Word {
    /// The fields, outermost first, by their places in the system. In discrete time the drift for each step.
    pub fields: Vec<usize>,
    /// The output, by its place in the system.
    pub output: usize,
}

impl Word {
    /// As a paper writes it: `Lg1 Lf s1`; long words in powers, `Lg1 Lf^14 s1`.
    pub fn text(&self, system: &System) -> String {
        let mut text = String::new();
        // nobody counts more than a dozen of the same
        let in_powers = self.fields.len() > LONGEST;
        let mut rest = self.fields.as_slice();
        while let Some(field) = rest.first() {
            let run = if in_powers { rest.iter().take_while(|other| *other == field).count() } else { 1 };
            text.push('L');
            text.push_str(&system.fields[*field].name);
            if run > 1 {
                text.push_str(&format!("^{run}"));
            }
            text.push(' ');
            rest = &rest[run..];
        }
        text + &system.outputs[self.output].0
    }
}

/// How long the words may become.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Length {
    /// Until the rank stops growing for good. On a set that the fields leave the rank may rest and grow again: there
    /// words of as many fields as there are states are taken, if they are not too many.
    UntilItStops,
    /// So many fields, whether or not the rank grows.
    Exactly(usize),
}

/// No longer words are taken unless they are asked for.
const LONGEST: usize = 12;
/// On a set that the fields leave, words are taken while they are no more than this.
const PATIENCE: usize = 300;

/// The rows from which the rank is decided.
#[derive(Clone, Debug)]
pub struct Codistribution {
    /// All words that were taken, shortest first, but those whose Lie derivative is constant.
    pub words: Vec<Word>,
    /// The value of each word.
    pub values: Vec<NodeId>,
    /// The differentials of all words, by rows of as many entries as there are states.
    pub rows: Vec<Vec<NodeId>>,
    /// The words that were needed: each of them raised the rank at a generic state of the locus.
    pub needed: Vec<usize>,
    /// The length of the longest word taken.
    pub order: usize,
    /// Why no longer ones were.
    pub stop: Stop,
    /// Whether the fields leave no state of the locus. There a rank that has stopped growing has stopped for good: the
    /// span of the words is then mapped into itself by every field.
    pub invariant: bool,
    /// What is seen at almost all states of the locus, by series and not by words.
    pub generic: GenericAnswer,
    /// Whether functions other than sines and cosines of angles are met, which the choice of words takes for
    /// independent unknowns: the generic rank is then no more than a guess.
    pub guessed: bool,
}

/// What is known of a locus before any words are taken.
#[derive(Clone, Debug)]
pub struct Frame {
    around: Ceiling,
    /// What is seen at almost all of its states.
    pub generic: GenericAnswer,
}

impl Frame {
    /// What is seen at almost all states that satisfy `conditions`, values for solved symbols.
    ///
    /// # Errors
    /// Where no field is a drift or an input.
    pub fn new(system: &mut System, conditions: &Assignment) -> Result<Frame, CodistributionError> {
        system.require_motion().map_err(CodistributionError::NoMotion)?;
        for output in system.zero_outputs() {
            // off the tie no point is a state of the system, and its rank is none
            let there = system.graph.substitute(&[output], conditions)[0];
            if !vanishes(system, there) {
                return Err(CodistributionError::NotTied);
            }
        }
        let around =
            if is_invariant(system, conditions) { Ceiling::Rests } else { rank_around(system, conditions) };
        let generic = generic_answer(system, conditions, around);
        Ok(Frame { around, generic })
    }

    /// Of each of some functions whether it is seen at almost all of these states, and what that rests on: the rank, found anew.
    pub fn functions(
        &self,
        system: &System,
        conditions: &Assignment,
        asked: &[NodeId],
    ) -> (GenericAnswer, Vec<Observability>) {
        generic_answer_of(system, conditions, self.around, asked)
    }

    /// Whether the words that show what is seen are short enough, and few enough, to be written down in a moment: along one field the
    /// k-th has of the order of `k^2` operations for each of the system's, and so has its differential.
    pub fn words_are_short(&self, system: &System) -> bool {
        let mut nodes: Vec<NodeId> = system.outputs.iter().map(|(_, node)| *node).collect();
        let fields = system.moving_fields();
        for field in &fields {
            nodes.extend(system.fields[*field].components.iter().map(|(_, rate)| *rate));
        }
        let met = system.graph.reachable(nodes);
        let operations = met.len();
        let order = self.generic.order + 1;
        let mut words = system.outputs.len();
        for _ in 0..order {
            words = (words * fields.len() + system.outputs.len()).min(MOST_WORDS);
        }
        // of functions that are not rational each row is looked at through all that they satisfy
        let is_function = |id: &NodeId| matches!(system.graph.node(*id), Node::Apply(function, _) if !matches!(function, Function::Sin | Function::Cos));
        let costs = if met.iter().any(is_function) { 10 } else { 1 };
        operations * order * order * words * costs <= MOST_SHORT
    }
}

/// Words of no more operations are written down in a moment.
const MOST_SHORT: usize = 1_000_000;
/// No more words than this are taken.
const MOST_WORDS: usize = 1500;

impl Codistribution {
    /// Takes words until the rank at a generic state that satisfies `conditions` (values for solved symbols) has reached
    /// the dimension, or until they are long enough.
    ///
    /// # Errors
    /// Where no field is a drift or an input, every state of the locus is a pole or an angle is met outside sines and cosines.
    pub fn new(
        system: &mut System,
        conditions: &Assignment,
        length: Length,
    ) -> Result<Codistribution, CodistributionError> {
        let frame = Frame::new(system, conditions)?;
        Codistribution::within(system, conditions, length, frame)
    }

    /// No words at all, and what is known without them.
    pub fn without_words(frame: Frame) -> Codistribution {
        Codistribution {
            words: Vec::new(),
            values: Vec::new(),
            rows: Vec::new(),
            needed: Vec::new(),
            order: 0,
            stop: Stop::NotTaken,
            invariant: frame.around == Ceiling::Rests,
            generic: frame.generic,
            guessed: false,
        }
    }

    /// The same as [`Codistribution::new`], of what is known without words.
    ///
    /// # Errors
    /// Where every state of the locus is a pole or an angle is met outside sines and cosines.
    pub fn within(
        system: &mut System,
        conditions: &Assignment,
        length: Length,
        frame: Frame,
    ) -> Result<Codistribution, CodistributionError> {
        let fields = system.moving_fields();
        let dimension = system.unknown_count();
        let closed = system.closed_coordinates();
        let saturation = Saturation::new(system, conditions, frame.around)?;
        let rests = saturation.is_on_an_invariant_set();
        let (longest, most) = match length {
            Length::UntilItStops => (saturation.longest(LONGEST), if rests { MOST_WORDS } else { PATIENCE }),
            Length::Exactly(order) => (order, MOST_WORDS),
        };
        // where fields leave the set the derivative that tells something may be of a higher order than there are coordinates
        let longest = match length {
            Length::UntilItStops if !rests && frame.generic.open.is_none() => {
                longest.max(frame.generic.order)
            }
            _ => longest,
        };
        // known signals that outputs tie have derivatives up to there
        let longest = system.longest_word().map_or(longest, |limit| longest.min(limit));
        let mut result = Codistribution::without_words(frame);
        result.stop = Stop::Order;
        // below the order of the last derivative that tells something no rank is at its end; with inputs words may tell it in fewer fields
        let first = match length {
            Length::UntilItStops if result.generic.open.is_none() && fields.len() == 1 => {
                result.generic.order
            }
            Length::UntilItStops => 0,
            Length::Exactly(order) => order,
        };
        let (mut with_all, mut closed_rank, mut looked_at) = (Vec::new(), 0, 0);
        let mut last: Vec<(Word, NodeId)> = (0..system.outputs.len())
            .map(|output| (Word { fields: Vec::new(), output }, system.outputs[output].1))
            .collect();
        for order in 0..=longest {
            if order > 0 {
                if result.words.len() + last.len() * fields.len() > most {
                    result.stop = Stop::TooMany;
                    break;
                }
                last = longer(system, &last);
            }
            for (word, value) in &last {
                let value = cheaper(system, word, *value);
                if closed.len() > dimension {
                    with_all.push(gradient(&mut system.graph, value, &closed));
                }
                let row = system.differential(value);
                // a row that is zero on the locus adds nothing; in floating point it would be noise
                let on_the_locus = system.graph.substitute(&row, conditions);
                if all_vanish(system, &on_the_locus) {
                    continue;
                }
                result.words.push(word.clone());
                result.values.push(value);
                result.rows.push(row);
            }
            result.order = order;
            if order < first && !last.is_empty() {
                continue;
            }
            let below = closed_rank;
            closed_rank = result.look(system, conditions, &with_all)?;
            looked_at = result.words.len();
            let growth = RankGrowth { order, below, up_to: closed_rank };
            let stop = saturation.stop(growth, result.needed.len());
            match length {
                Length::UntilItStops if stop.is_some() => result.stop = stop.unwrap_or(result.stop),
                Length::Exactly(_) if order == longest && stop == Some(Stop::Full) => {
                    result.stop = Stop::Full
                }
                // all further ones are constant
                _ if last.is_empty() => result.stop = Stop::NoGrowth,
                _ => continue,
            }
            break;
        }
        if looked_at < result.words.len() {
            result.look(system, conditions, &with_all)?;
        }
        let missing = result.generic.at_least > result.needed.len();
        let cut_off = system.longest_word().is_some();
        if length == Length::UntilItStops
            && missing
            && !cut_off
            && system.time == Time::Continuous
            && matches!(result.stop, Stop::TooMany | Stop::Order)
        {
            result.take_by_need(system, conditions, &fields)?;
        }
        Ok(result)
    }

    /// Which of the words that were taken are needed; the rank by all coordinates that move, of which `with_all` has the rows where not all of them are unknown.
    fn look(
        &mut self,
        system: &mut System,
        conditions: &Assignment,
        with_all: &[Vec<NodeId>],
    ) -> Result<usize, CodistributionError> {
        (self.needed, self.guessed) = needed(system, &self.rows, conditions)?;
        match with_all.is_empty() {
            true => Ok(self.needed.len()),
            false => Ok(needed(system, with_all, conditions)?.0.len()),
        }
    }

    /// Whether the words that were taken show less than is there: those that are missing were too long, or too many, to be written.
    pub fn is_cut_off(&self) -> bool {
        self.needed.len() < self.generic.at_least && matches!(self.stop, Stop::TooMany | Stop::Order)
    }

    /// Whether the search came to its own end, and was neither cut off nor left out.
    pub fn has_rested(&self) -> bool {
        !matches!(self.stop, Stop::TooMany | Stop::Order | Stop::NotTaken)
    }

    /// What no rank can exceed at any state of the locus, for certain but for the error of the generic answer.
    pub fn most(&self) -> usize {
        self.generic.at_most
    }

    /// Whether longer words cannot raise the rank at a generic state of the locus.
    pub fn is_final(&self) -> bool {
        let stopped = match self.stop {
            Stop::Full | Stop::Ceiling => true,
            Stop::NoGrowth => self.invariant,
            _ => false,
        };
        self.generic.rank() == Some(self.needed.len()) || !self.guessed && stopped
    }

    /// The rank at a generic state of the locus, by the words that were taken.
    pub fn generic_rank(&self) -> usize {
        self.needed.len()
    }

    /// The rows of the words that were needed, one after the other.
    pub fn needed_entries(&self) -> Vec<NodeId> {
        self.needed.iter().flat_map(|index| self.rows[*index].iter().copied()).collect()
    }

    /// The rows of all words, one after the other.
    pub fn entries(&self) -> Vec<NodeId> {
        self.rows.iter().flatten().copied().collect()
    }
}

/// The rank at almost all states, with only those conditions kept that concern parameters; the dimension, where that
/// rank is not known for good. A rank falls on a special set, and never rises. Known initial conditions count as
/// unknown here: where the words that were taken have this rank they span, around such a state, the differentials of all words,
/// so that at it no longer word adds anything to them, whichever columns are left out.
fn rank_around(system: &mut System, conditions: &Assignment) -> Ceiling {
    let states = system.states.clone();
    let kept: Assignment = conditions
        .iter()
        .filter(|(symbol, value)| {
            let mentioned = system.graph.symbols_of([**value]);
            !states.contains(symbol) && !states.iter().any(|state| mentioned.contains(state))
        })
        .map(|(symbol, value)| (*symbol, *value))
        .collect();
    let around = generic_answer(system, &kept, Ceiling::Rests);
    Ceiling::Around { closed: around.closed_at_most, unknown: around.at_most }
}

/// All words with the drift or an input more in front, but those whose value is a constant.
fn longer(system: &mut System, words: &[(Word, NodeId)]) -> Vec<(Word, NodeId)> {
    let mut found = Vec::new();
    for field in system.moving_fields() {
        for (word, value) in words {
            let derivative = system.lie_derivative(field, *value);
            if system.graph.constant_value(derivative).is_none() {
                let mut fields = vec![field];
                fields.extend_from_slice(&word.fields);
                found.push((Word { fields, output: word.output }, derivative));
            }
        }
    }
    found
}

/// From so many fields on the series of a word may have fewer operations than its repeated derivation (of the order
/// k^2 for each run of one field, against k^3; `cargo bench --bench series` shows where they cross).
const SERIES_FROM: usize = 5;

/// The same Lie derivative in the fewer operations: as it was derived, or by series.
fn cheaper(system: &mut System, word: &Word, derived: NodeId) -> NodeId {
    // series are of flows
    if word.fields.len() < SERIES_FROM || system.time == Time::Discrete {
        return derived;
    }
    let operations = |system: &System, value| system.graph.reachable([value]).len();
    let output = system.outputs[word.output].1;
    match lie_derivative_by_series(system, &word.fields, output) {
        Ok(series) if operations(system, series) < operations(system, derived) => series,
        _ => derived,
    }
}
