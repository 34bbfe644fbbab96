//! The observability codistribution (equations 4.36 and 4.37): the differentials of the outputs and of their repeated
//! Lie derivatives along words of fields, added shortest first.

use super::elimination::independent_rows;
use crate::expression::{NodeId, Program, draw_residues, expand_angles};
use crate::number::PrimeField;
use crate::system::{Assignment, System};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

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

/// How long the words may become.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Length {
    /// Until the rank stops growing. On a set of states, unlike a set of parameters, the rank may rest and grow again
    /// (the flow leaves the set): there words of [`ORDER_ON_A_SET`] fields are taken in any case.
    UntilItStops,
    /// So many fields, whether or not the rank grows.
    Exactly(usize),
}

/// The length that words have in any case on a set of states.
pub const ORDER_ON_A_SET: usize = 3;
/// No longer words are taken unless they are asked for.
const LONGEST: usize = 8;

/// Why no longer words were taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// The rank has reached the dimension of the state space.
    Full,
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
    /// The differentials of all words, by rows of as many entries as there are states.
    pub rows: Vec<Vec<NodeId>>,
    /// The words that were needed: each of them raised the rank at a generic state of the locus.
    pub needed: Vec<usize>,
    /// The length of the longest word taken.
    pub order: usize,
    /// Why no longer ones were.
    pub stop: Stop,
}

/// No more words than this are taken.
const MOST_WORDS: usize = 1500;
const ATTEMPTS: usize = 40;

impl Codistribution {
    /// Takes words until the rank at a generic state that satisfies `conditions` (values for solved symbols) has reached
    /// the dimension, or until they are long enough.
    ///
    /// # Errors
    /// In words, where every state of the locus is a pole or an angle is met outside sines and cosines.
    pub fn new(
        system: &mut System,
        conditions: &Assignment,
        length: Length,
    ) -> Result<Codistribution, String> {
        let dimension = system.states.len();
        let on_states = conditions.keys().any(|symbol| system.states.contains(symbol));
        let (at_least, longest) = match length {
            Length::UntilItStops => (if on_states { ORDER_ON_A_SET } else { 0 }, LONGEST),
            Length::Exactly(order) => (order, order),
        };
        let mut result =
            Codistribution { words: Vec::new(), rows: Vec::new(), needed: Vec::new(), order: 0, stop: Stop::Order };
        let mut last: Vec<(Word, NodeId)> = (0..system.outputs.len())
            .map(|output| (Word { fields: Vec::new(), output }, system.outputs[output].1))
            .collect();
        for order in 0..=longest {
            if order > 0 {
                if result.words.len() + last.len() * system.fields.len() > MOST_WORDS {
                    result.stop = Stop::TooMany;
                    break;
                }
                last = longer(system, &last);
            }
            for (word, value) in &last {
                let row = system.differential(*value);
                result.words.push(word.clone());
                result.rows.push(row);
            }
            result.order = order;
            let before = result.needed.len();
            result.needed = needed(system, &result.rows, conditions)?;
            if result.needed.len() == dimension && (length == Length::UntilItStops || order == longest) {
                result.stop = Stop::Full;
                break;
            }
            if last.is_empty() || order > 0 && order >= at_least && result.needed.len() == before {
                result.stop = Stop::NoGrowth;
                break;
            }
        }
        Ok(result)
    }

    /// The rank at a generic state of the locus.
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

/// All words with one more field in front, but those whose value is a constant.
fn longer(system: &mut System, words: &[(Word, NodeId)]) -> Vec<(Word, NodeId)> {
    let mut found = Vec::new();
    for field in 0..system.fields.len() {
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

/// The rows that raise the rank at a random point of the locus.
fn needed(system: &mut System, rows: &[Vec<NodeId>], conditions: &Assignment) -> Result<Vec<usize>, String> {
    let angles = system.angles();
    let is_angle = |symbol| angles.contains(&symbol);
    let entries: Vec<NodeId> = rows.iter().flatten().copied().collect();
    let entries = system.graph.substitute(&entries, conditions);
    let entries = expand_angles(&mut system.graph, &entries, is_angle);
    let program = Program::new(&system.graph, &entries, is_angle, true);
    if let Some(angle) = program.bare_angle() {
        let name = system.symbol_name(angle);
        return Err(format!("'{name}' is declared as an angle but stands outside sin, cos and tan"));
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
                let matrix: Vec<Vec<u64>> = values.chunks(system.states.len().max(1)).map(<[u64]>::to_vec).collect();
                let kept = independent_rows(&field, &matrix).map_err(|refusal| refusal.to_string())?;
                if best.as_ref().is_none_or(|b| kept.len() > b.len()) {
                    best = Some(kept);
                }
                successes += 1;
                if successes == 3 {
                    break;
                }
            }
            Err(failure) => divisor = failure.divisor(&system.graph),
        }
    }
    best.ok_or_else(|| match divisor {
        Some(divisor) => format!("every state there is a pole: {} = 0 is divided by", system.graph.text(divisor)),
        None => "no random point could be evaluated".to_owned(),
    })
}
