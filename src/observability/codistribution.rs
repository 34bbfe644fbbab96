//! The observability codistribution (equations 4.36 and 4.37): the differentials of the outputs and of their repeated
//! Lie derivatives along words of fields, added shortest first.

use super::conditions::{all_vanish, vanishes};
use super::elimination::independent_rows;
use super::series::lie_derivative_by_series;
use crate::expression::{NodeId, Program, draw_residues, expand_angles};
use crate::number::PrimeField;
use crate::system::{Assignment, System};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// The name of the matrix that holds a paper's own choice of rows.
pub const OWN_ROWS: &str = "rows";

/// A repeated Lie derivative of an output: `L_{X1} L_{X2} ... h`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Word {
    /// The fields, outermost first, by their places in the system.
    pub fields: Vec<usize>,
    /// The output, by its place in the system.
    pub output: usize,
}

impl Word {
    /// As a paper writes it: `Lg1 Lf s1`.
    pub fn text(&self, system: &System) -> String {
        let mut text = String::new();
        for field in &self.fields {
            text.push('L');
            text.push_str(&system.fields[*field].name);
            text.push(' ');
        }
        text + &system.outputs[self.output].0
    }
}

/// Why there is no codistribution.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CodistributionError {
    /// No field is a drift or an input.
    #[error("{0}")]
    NoMotion(String),
    /// Every state is a pole: a divisor is zero at all of them.
    #[error("every state there is a pole: {divisor} = 0 is divided by")]
    Pole {
        /// As the file writes it.
        divisor: String,
    },
    /// A symbol that is declared as an angle is met as a number.
    #[error("'{0}' is declared as an angle but stands outside sin, cos and tan")]
    AngleOutside(String),
    /// Nothing could be evaluated, and why.
    #[error("{0}")]
    NotEvaluated(String),
}

impl From<CodistributionError> for String {
    fn from(error: CodistributionError) -> String {
        error.to_string()
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

/// Why no longer words were taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// The rank has reached the dimension of the state space.
    Full,
    /// The rank has reached that at almost all states around, which no state of the locus can exceed.
    Ceiling,
    /// One further order did not raise the rank.
    NoGrowth,
    /// The longest word that was allowed.
    Order,
    /// There are more words of the next length than are worth taking.
    TooMany,
}

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
    /// Whether functions other than sines and cosines of angles are met, which the choice of words takes for
    /// independent unknowns: the generic rank is then no more than a guess.
    pub guessed: bool,
}

/// No more words than this are taken.
const MOST_WORDS: usize = 1500;
const ATTEMPTS: usize = 40;

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
        system.require_motion().map_err(CodistributionError::NoMotion)?;
        let fields = system.moving_fields();
        let dimension = system.unknown_count();
        let invariant = is_invariant(system, conditions);
        let ceiling = if invariant { dimension } else { rank_around(system, conditions, length)? };
        let (at_least, longest, most) = match length {
            Length::UntilItStops if invariant => (0, LONGEST, MOST_WORDS),
            Length::UntilItStops => (dimension, dimension, PATIENCE),
            Length::Exactly(order) => (order, order, MOST_WORDS),
        };
        let mut result = Codistribution {
            words: Vec::new(),
            values: Vec::new(),
            rows: Vec::new(),
            needed: Vec::new(),
            order: 0,
            stop: Stop::Order,
            invariant,
            guessed: false,
        };
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
            let before = result.needed.len();
            (result.needed, result.guessed) = needed(system, &result.rows, conditions)?;
            if result.needed.len() == dimension && (length == Length::UntilItStops || order == longest) {
                result.stop = Stop::Full;
                break;
            }
            if result.needed.len() == ceiling && length == Length::UntilItStops {
                result.stop = Stop::Ceiling;
                break;
            }
            if last.is_empty() || invariant && order > at_least && result.needed.len() == before {
                result.stop = Stop::NoGrowth;
                break;
            }
        }
        Ok(result)
    }

    /// Whether longer words cannot raise the rank at a generic state of the locus.
    pub fn is_final(&self) -> bool {
        !self.guessed
            && (matches!(self.stop, Stop::Full | Stop::Ceiling)
                || self.stop == Stop::NoGrowth && self.invariant)
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
/// rank is not known for good. A rank falls on a special set, and never rises.
fn rank_around(
    system: &mut System,
    conditions: &Assignment,
    length: Length,
) -> Result<usize, CodistributionError> {
    let states = system.states.clone();
    let kept: Assignment = conditions
        .iter()
        .filter(|(symbol, value)| {
            let mentioned = system.graph.symbols_of([**value]);
            !states.contains(symbol) && !states.iter().any(|state| mentioned.contains(state))
        })
        .map(|(symbol, value)| (*symbol, *value))
        .collect();
    let around = Codistribution::new(system, &kept, length)?;
    Ok(if around.is_final() { around.generic_rank() } else { system.unknown_count() })
}

/// Whether the drift and every input are tangent to the set that the conditions describe: `L_X (x - value) = 0` on it.
fn is_invariant(system: &mut System, conditions: &Assignment) -> bool {
    let mut solved: Vec<_> = conditions.iter().map(|(symbol, value)| (*symbol, *value)).collect();
    solved.sort_unstable();
    solved.into_iter().all(|(symbol, value)| {
        let left = system.graph.symbol(symbol);
        let difference = system.graph.sub(left, value);
        system.moving_fields().into_iter().all(|field| {
            let rate = system.lie_derivative(field, difference);
            let on_the_set = system.graph.substitute(&[rate], conditions)[0];
            vanishes(system, on_the_set)
        })
    })
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
    if word.fields.len() < SERIES_FROM {
        return derived;
    }
    let operations = |system: &System, value| system.graph.reachable([value]).len();
    let output = system.outputs[word.output].1;
    match lie_derivative_by_series(system, &word.fields, output) {
        Ok(series) if operations(system, series) < operations(system, derived) => series,
        _ => derived,
    }
}

/// The rows that raise the rank at a random point of the locus, and whether unknown functions took part.
fn needed(
    system: &mut System,
    rows: &[Vec<NodeId>],
    conditions: &Assignment,
) -> Result<(Vec<usize>, bool), CodistributionError> {
    let is_angle = &system.angle_test();
    let as_written: Vec<NodeId> = rows.iter().flatten().copied().collect();
    let entries = system.graph.substitute(&as_written, conditions);
    let entries = expand_angles(&mut system.graph, &entries, is_angle);
    let program = Program::with_unknown_functions(&system.graph, &entries, is_angle);
    if let Some(angle) = program.bare_angle() {
        let name = system.symbol_name(angle);
        return Err(CodistributionError::AngleOutside(name.to_owned()));
    }
    let mut rng = ChaCha8Rng::seed_from_u64(0x0077_6f72_6473); // any fixed seed: the words do not depend on the user's
    let (mut registers, mut divisor, mut best) = (Vec::new(), None, None::<Vec<usize>>);
    let mut successes = 0;
    for _ in 0..ATTEMPTS {
        let field = PrimeField::random(&mut rng);
        let Ok(loaded) = program.load(field) else { continue };
        let inputs = draw_residues(&program, &field, &mut rng);
        match loaded.run(&inputs, &mut registers) {
            Ok(values) => {
                let matrix: Vec<Vec<u64>> =
                    values.chunks(system.unknown_count().max(1)).map(<[u64]>::to_vec).collect();
                let kept = independent_rows(&field, &matrix)
                    .map_err(|refusal| CodistributionError::NotEvaluated(refusal.to_string()))?;
                if best.as_ref().is_none_or(|b| kept.len() > b.len()) {
                    best = Some(kept);
                }
                successes += 1;
                if successes == 3 {
                    break;
                }
            }
            Err(failure) => divisor = failure.divisor,
        }
    }
    let guessed = program.unknown_function(&system.graph).is_some();
    best.map(|kept| (kept, guessed)).ok_or_else(|| match divisor {
        Some(divisor) => {
            // what has become the constant zero is named as it was written
            let named = system.graph.vanishing_divisor(&as_written, conditions).unwrap_or(divisor);
            CodistributionError::Pole { divisor: system.graph.text(named) }
        }
        None => CodistributionError::NotEvaluated("no random point could be evaluated".to_owned()),
    })
}
