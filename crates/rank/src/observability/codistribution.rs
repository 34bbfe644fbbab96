//! The observability codistribution (equations 4.36 and 4.37): the differentials of the outputs and of their repeated
//! Lie derivatives along the fields, added shortest first.

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
pub struct LieDerivative {
    /// The fields, outermost first, by their places in the system. In discrete time the drift for each step.
    pub fields: Vec<usize>,
    /// The output, by its place in the system.
    pub output: usize,
}

impl LieDerivative {
    /// As a paper writes it: `Lg1 Lf s1`; long Lie derivatives in powers, `Lg1 Lf^14 s1`.
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

/// How long the Lie derivatives may become.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Length {
    /// Until the rank stops growing for good. On a set that is not invariant the rank may rest and grow again: there
    /// Lie derivatives of as many fields as there are states are taken, if they are not too many.
    UntilItStops,
    /// So many fields, whether or not the rank grows.
    Exactly(usize),
}

/// No longer Lie derivatives are taken unless they are asked for.
const LONGEST: usize = 12;
/// On a set that is not invariant, Lie derivatives are taken while they are no more than this.
const PATIENCE: usize = 300;

/// The rows from which the rank is decided.
#[derive(Clone, Debug)]
pub struct Codistribution {
    /// All Lie derivatives that were taken, shortest first, but those whose differential is zero on the locus.
    pub lie_derivatives: Vec<LieDerivative>,
    /// The value of each Lie derivative.
    pub values: Vec<NodeId>,
    /// The differentials of all Lie derivatives, by rows of as many entries as there are unknowns.
    pub rows: Vec<Vec<NodeId>>,
    /// The Lie derivatives that were needed: each of them raised the rank at a generic state of the locus.
    pub needed: Vec<usize>,
    /// The length of the longest Lie derivative taken.
    pub order: usize,
    /// Why no longer Lie derivatives were taken.
    pub stop: Stop,
    /// Whether the locus is invariant under all fields. There a rank that has stopped growing has stopped for good: the
    /// span of the Lie derivatives is then mapped into itself by every field.
    pub invariant: bool,
    /// What is observable at almost all states of the locus, by series and not by Lie derivatives.
    pub generic: GenericAnswer,
    /// Whether functions other than sines and cosines of angles are met, which the choice of Lie derivatives takes for
    /// independent unknowns: the generic rank is then no more than a guess.
    pub guessed: bool,
}

/// What is known of a locus before any Lie derivatives are taken.
#[derive(Clone, Debug)]
pub struct Frame {
    around: Ceiling,
    /// What is observable at almost all of its states.
    pub generic: GenericAnswer,
}

impl Frame {
    /// What is observable at almost all states that satisfy `conditions`, values for solved symbols.
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

    /// Whether each of some functions is observable at almost all of these states, and the rank on which that rests, found anew.
    pub fn functions(
        &self,
        system: &System,
        conditions: &Assignment,
        asked: &[NodeId],
    ) -> (GenericAnswer, Vec<Observability>) {
        generic_answer_of(system, conditions, self.around, asked)
    }

    /// Whether the Lie derivatives that decide observability are short enough, and few enough, to be written down in a moment: along one field the
    /// k-th has of the order of `k^2` operations for each of the system's, and so has its differential.
    pub fn lie_derivatives_are_short(&self, system: &System) -> bool {
        let mut nodes: Vec<NodeId> = system.outputs.iter().map(|(_, node)| *node).collect();
        let fields = system.moving_fields();
        for field in &fields {
            nodes.extend(system.fields[*field].components.iter().map(|(_, rate)| *rate));
        }
        let met = system.graph.reachable(nodes);
        let operations = met.len();
        let order = self.generic.order + 1;
        let mut lie_derivatives = system.outputs.len();
        for _ in 0..order {
            lie_derivatives =
                (lie_derivatives * fields.len() + system.outputs.len()).min(MOST_LIE_DERIVATIVES);
        }
        // of functions that are not rational each row is looked at through all that they satisfy
        let is_function = |id: &NodeId| matches!(system.graph.node(*id), Node::Apply(function, _) if !matches!(function, Function::Sin | Function::Cos));
        let costs = if met.iter().any(is_function) { 10 } else { 1 };
        operations * order * order * lie_derivatives * costs <= MOST_SHORT
    }
}

/// Lie derivatives of no more operations are written down in a moment.
const MOST_SHORT: usize = 1_000_000;
/// No more Lie derivatives than this are taken.
const MOST_LIE_DERIVATIVES: usize = 1500;

impl Codistribution {
    /// Takes Lie derivatives until the rank at a generic state that satisfies `conditions` (values for solved symbols) has reached
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

    /// No Lie derivatives at all, and what is known without them.
    pub fn without_lie_derivatives(frame: Frame) -> Codistribution {
        Codistribution {
            lie_derivatives: Vec::new(),
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

    /// The same as [`Codistribution::new`], of what is known without Lie derivatives.
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
            Length::UntilItStops => {
                (saturation.longest(LONGEST), if rests { MOST_LIE_DERIVATIVES } else { PATIENCE })
            }
            Length::Exactly(order) => (order, MOST_LIE_DERIVATIVES),
        };
        // on a set that is not invariant an informative derivative may be of a higher order than there are coordinates
        let longest = match length {
            Length::UntilItStops if !rests && frame.generic.open.is_none() => {
                longest.max(frame.generic.order)
            }
            _ => longest,
        };
        // known signals that outputs tie have derivatives up to there
        let longest = system.highest_lie_order().map_or(longest, |limit| longest.min(limit));
        let mut result = Codistribution::without_lie_derivatives(frame);
        result.stop = Stop::Order;
        // below the order of the last informative derivative no rank is final; with inputs Lie derivatives of lower order may do
        let first = match length {
            Length::UntilItStops if result.generic.open.is_none() && fields.len() == 1 => {
                result.generic.order
            }
            Length::UntilItStops => 0,
            Length::Exactly(order) => order,
        };
        let (mut with_all, mut closed_rank, mut looked_at) = (Vec::new(), 0, 0);
        let mut last: Vec<(LieDerivative, NodeId)> = (0..system.outputs.len())
            .map(|output| (LieDerivative { fields: Vec::new(), output }, system.outputs[output].1))
            .collect();
        for order in 0..=longest {
            if order > 0 {
                if result.lie_derivatives.len() + last.len() * fields.len() > most {
                    result.stop = Stop::TooMany;
                    break;
                }
                last = longer(system, &last);
            }
            for (lie_derivative, value) in &last {
                let value = cheaper(system, lie_derivative, *value);
                if closed.len() > dimension {
                    with_all.push(gradient(&mut system.graph, value, &closed));
                }
                let row = system.differential(value);
                // a row that is zero on the locus adds nothing; in floating point it would be noise
                let on_the_locus = system.graph.substitute(&row, conditions);
                if all_vanish(system, &on_the_locus) {
                    continue;
                }
                result.lie_derivatives.push(lie_derivative.clone());
                result.values.push(value);
                result.rows.push(row);
            }
            result.order = order;
            if order < first && !last.is_empty() {
                continue;
            }
            let below = closed_rank;
            closed_rank = result.look(system, conditions, &with_all)?;
            looked_at = result.lie_derivatives.len();
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
        if looked_at < result.lie_derivatives.len() {
            result.look(system, conditions, &with_all)?;
        }
        let missing = result.generic.at_least > result.needed.len();
        let cut_off = system.highest_lie_order().is_some();
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

    /// Which of the Lie derivatives that were taken are needed; the rank by all coordinates that move, with the rows `with_all` where some of these are known.
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

    /// Whether the Lie derivatives that were taken show a lower rank than there is: those missing were too long, or too many, to be written.
    pub fn is_cut_off(&self) -> bool {
        self.needed.len() < self.generic.at_least && matches!(self.stop, Stop::TooMany | Stop::Order)
    }

    /// Whether the search came to its own end, and was neither cut off nor left out.
    pub fn has_rested(&self) -> bool {
        !matches!(self.stop, Stop::TooMany | Stop::Order | Stop::NotTaken)
    }

    /// An upper bound on the rank at any state of the locus, up to the error probability of the generic answer.
    pub fn most(&self) -> usize {
        self.generic.at_most
    }

    /// Whether longer Lie derivatives cannot raise the rank at a generic state of the locus.
    pub fn is_final(&self) -> bool {
        let stopped = match self.stop {
            Stop::Full | Stop::Ceiling => true,
            Stop::NoGrowth => self.invariant,
            _ => false,
        };
        self.generic.rank() == Some(self.needed.len()) || !self.guessed && stopped
    }

    /// The rank at a generic state of the locus, by the Lie derivatives that were taken.
    pub fn generic_rank(&self) -> usize {
        self.needed.len()
    }

    /// The rows of the Lie derivatives that were needed, one after the other.
    pub fn needed_entries(&self) -> Vec<NodeId> {
        self.needed.iter().flat_map(|index| self.rows[*index].iter().copied()).collect()
    }

    /// The rows of all Lie derivatives, one after the other.
    pub fn entries(&self) -> Vec<NodeId> {
        self.rows.iter().flatten().copied().collect()
    }
}

/// The rank at almost all states, with only those conditions kept that concern parameters; the dimension, where that
/// rank is not known for good. A rank falls on a special set, and never rises. Known initial conditions count as
/// unknown here: where the Lie derivatives that were taken have this rank they span, around such a state, the differentials of all Lie derivatives,
/// so that at it no longer Lie derivative adds anything to them, whichever columns are left out.
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

/// All Lie derivatives with the drift or an input more in front, but those whose value is a constant.
fn longer(system: &mut System, lie_derivatives: &[(LieDerivative, NodeId)]) -> Vec<(LieDerivative, NodeId)> {
    let mut found = Vec::new();
    for field in system.moving_fields() {
        for (lie_derivative, value) in lie_derivatives {
            let derivative = system.lie_derivative(field, *value);
            if system.graph.constant_value(derivative).is_none() {
                let mut fields = vec![field];
                fields.extend_from_slice(&lie_derivative.fields);
                found.push((LieDerivative { fields, output: lie_derivative.output }, derivative));
            }
        }
    }
    found
}

/// From so many fields on the series of a Lie derivative may have fewer operations than its repeated derivation (of the order
/// k^2 for each run of one field, against k^3; `cargo bench --bench series` shows where they cross).
const SERIES_FROM: usize = 5;

/// The same Lie derivative in the fewer operations: as it was derived, or by series.
fn cheaper(system: &mut System, lie_derivative: &LieDerivative, derived: NodeId) -> NodeId {
    // series are of flows
    if lie_derivative.fields.len() < SERIES_FROM || system.time == Time::Discrete {
        return derived;
    }
    let operations = |system: &System, value| system.graph.reachable([value]).len();
    let output = system.outputs[lie_derivative.output].1;
    match lie_derivative_by_series(system, &lie_derivative.fields, output) {
        Ok(series) if operations(system, series) < operations(system, derived) => series,
        _ => derived,
    }
}
