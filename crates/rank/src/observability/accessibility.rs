//! The dual question: where can the inputs take the state? The accessibility distribution is spanned by the drift, the inputs
//! and all their brackets; strongly accessible is what the inputs and their brackets span, the drift itself left out. Where
//! either has as many dimensions as there are coordinates, the states that can be reached (at some time, or at any one given
//! time) fill an open set.
//!
//! Brackets of brackets are combinations of those that take one field of the system more at a time. At almost all states, and
//! almost everywhere on an invariant set, only the brackets that raised the rank have to be taken further: for a
//! combination with functions as coefficients `[f, a X] = a [f, X] + (L_f a) X`, so that their span holds those of all.
//! Elsewhere all brackets are taken, up to as many fields as there are coordinates.
//!
//! References: H. J. Sussmann and V. Jurdjevic, *Controllability of nonlinear systems*, J. Differential Equations 12 (1972);
//! H. Nijmeijer and A. J. van der Schaft, *Nonlinear Dynamical Control Systems* (1990), propositions 3.22 and 3.47.

use super::generic::{GenericRank, formal_rank};
use super::needed::{CodistributionError, needed};
use super::saturation::{Stop, is_invariant};
use palmistry_lang::{Assignment, Role, System, UnknownKind};
use palmistry_math::expression::{NodeId, Symbol, gradient};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::collections::{BTreeSet, HashMap};

/// On a set that is not invariant, brackets are taken while they are no more than this.
const PATIENCE: usize = 300;
/// A graph with more operations than this is no longer worth growing.
const LARGEST_GRAPH: usize = 4_000_000;

/// What is known of a rank.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RankBounds {
    /// The rank at almost all states is at least this.
    pub at_least: usize,
    /// And no greater, with an error probability below `2^log2_error`; the number of coordinates where nothing is known.
    pub at_most: usize,
    /// Minus infinity where the bound is certain.
    pub log2_error: f64,
    /// Whether the lower bound was shown at a true state, because functions are met: it holds at almost all states that the
    /// domain of the functions connects with that one.
    pub from_a_state: bool,
}

impl RankBounds {
    /// Nothing is known but that the rank is no greater.
    fn open(at_most: usize) -> RankBounds {
        RankBounds { at_least: 0, at_most, log2_error: f64::NEG_INFINITY, from_a_state: false }
    }

    /// The rank, where it is known.
    pub fn rank(&self) -> Option<usize> {
        (self.at_least == self.at_most).then_some(self.at_least)
    }
}

/// A square submatrix of the rows.
#[derive(Clone, Debug)]
pub struct BracketMinor {
    /// The coordinates of its columns.
    pub columns: Vec<Symbol>,
    /// Its entries, by rows.
    pub entries: Vec<NodeId>,
}

/// What is known while brackets are still being taken.
#[derive(Clone, Debug)]
pub struct BracketsSoFar {
    /// The names of those that raised the rank, the drift left out.
    pub needed: Vec<String>,
    /// The most fields in a bracket that was taken.
    pub order: usize,
    /// The rank of all; longer brackets may raise it.
    pub whole: RankBounds,
    /// The rank without the drift itself.
    pub strong: RankBounds,
}

/// A field, or a bracket of fields.
#[derive(Clone, Debug)]
struct Motion {
    /// `[f, [f, g]]`
    name: String,
    /// Its components, one for each state.
    components: Vec<NodeId>,
}

/// The brackets from which the rank is decided.
#[derive(Clone, Debug)]
pub struct Accessibility {
    /// The coordinates that can be moved at all: all states but constants and unknown signals. A column each.
    pub columns: Vec<Symbol>,
    /// The brackets that were taken, shortest first, the drift last: names such as `[f, g]`.
    pub names: Vec<String>,
    /// Their components, by rows of as many entries as there are columns.
    pub rows: Vec<Vec<NodeId>>,
    /// Those that raised the rank; the drift, where it does, is the last.
    pub needed: Vec<usize>,
    /// The most fields in a bracket that was taken.
    pub order: usize,
    /// Why no longer brackets were taken.
    pub stop: Stop,
    /// The rank of all.
    pub whole: RankBounds,
    /// The rank without the drift itself.
    pub strong: RankBounds,
}

impl Accessibility {
    /// Takes brackets at a generic state that satisfies `conditions` (values for solved symbols) until they add nothing, or of
    /// up to `order` fields beyond the first; `tell` is called after each length with what is known by then.
    ///
    /// # Errors
    /// Where no field moves the states, every state is a pole or an angle is met outside sines and cosines.
    pub fn new(
        system: &mut System,
        conditions: &Assignment,
        order: Option<usize>,
        tell: &mut dyn FnMut(BracketsSoFar),
    ) -> Result<Accessibility, CodistributionError> {
        system.require_motion().map_err(CodistributionError::NoMotion)?;
        let columns = Accessibility::columns_of(system);
        let full = columns.len();
        let invariant = is_invariant(system, conditions);
        let unbounded = RankBounds::open(full);
        let around = match invariant {
            true => Around { whole: unbounded, strong: unbounded },
            false => around(system, conditions, order)?,
        };
        let generators: Vec<Generator> =
            system.moving_fields().into_iter().map(|field| Generator::new(system, field)).collect();
        let places: Vec<usize> = columns.iter().filter_map(|symbol| place_of(system, *symbol)).collect();
        let row = |motion: &Motion| places.iter().map(|place| motion.components[*place]).collect::<Vec<_>>();
        let inputs = generators.iter().filter(|one| !one.is_drift);
        let mut motions: Vec<Motion> = inputs.map(|one| one.motion.clone()).collect();
        let mut rows: Vec<Vec<NodeId>> = motions.iter().map(row).collect();
        let mut basis = raising(system, &rows, conditions)?;
        // what is still to be taken further: on an invariant set, only what raised the rank
        let mut taken_further = BTreeSet::new();
        let open = |basis: &[usize], count: usize, done: &BTreeSet<usize>| -> Vec<usize> {
            match invariant {
                true => basis.iter().copied().filter(|place| !done.contains(place)).collect(),
                false => (0..count).filter(|place| !done.contains(place)).collect(),
            }
        };
        let mut frontier = open(&basis, motions.len(), &taken_further);
        let longest = order.unwrap_or(full);
        let (mut taken, mut stop) = (1, Stop::Order);
        for length in 2..=longest.saturating_add(1) {
            let strong = bounds(system, &rows, conditions, (None, around.strong))?;
            let whole = RankBounds { at_least: strong.at_least, ..around.whole };
            let needed = basis.iter().map(|place| motions[*place].name.clone()).collect();
            tell(BracketsSoFar { needed, order: taken, whole, strong });
            if basis.len() == full {
                stop = Stop::Full;
                break;
            }
            if !invariant && order.is_none() && basis.len() == around.strong.at_most {
                stop = Stop::Ceiling;
                break;
            }
            if frontier.is_empty() {
                stop = Stop::NoGrowth;
                break;
            }
            if !invariant && motions.len() + frontier.len() * generators.len() > PATIENCE
                || system.graph.len() > LARGEST_GRAPH
            {
                stop = Stop::TooMany;
                break;
            }
            let begin = motions.len();
            for place in frontier {
                taken_further.insert(place);
                for generator in &generators {
                    let of = motions[place].clone();
                    // a field with itself, and of two inputs one of the two orders
                    let known = inputs_in_order(&motions[..begin], place, generator);
                    if let Some(bracket) = (!known).then(|| generator.bracket(system, &of)).flatten() {
                        rows.push(row(&bracket));
                        motions.push(bracket);
                    }
                }
            }
            taken = length;
            basis = raising(system, &rows, conditions)?;
            frontier = open(&basis, motions.len(), &taken_further);
        }
        if stop == Stop::Order && frontier.is_empty() {
            stop = Stop::NoGrowth;
        }
        if basis.len() == full {
            stop = Stop::Full;
        }
        let closed = invariant && stop == Stop::NoGrowth;
        let closed = closed.then_some(basis.len());
        let strong = bounds(system, &rows, conditions, (closed, around.strong))?;
        if let Some(drift) = generators.iter().find(|one| one.is_drift) {
            rows.push(row(&drift.motion));
            motions.push(drift.motion.clone());
        }
        let needed = raising(system, &rows, conditions)?;
        let closed = closed.map(|_| needed.len());
        let whole = bounds(system, &rows, conditions, (closed, around.whole))?;
        let names = motions.into_iter().map(|motion| motion.name).collect();
        Ok(Accessibility { columns, names, rows, needed, order: taken, stop, whole, strong })
    }

    /// The coordinates of a system that something can move: constants and unknown signals are none.
    pub fn columns_of(system: &System) -> Vec<Symbol> {
        let is_state = |symbol: &Symbol| match system.unknown_kind(*symbol) {
            Some(kind) => kind == UnknownKind::State,
            // a known signal is driven like an input
            None => true,
        };
        system.states.iter().copied().filter(is_state).collect()
    }

    /// A square submatrix of the rows that raised the rank, regular at a random point: where functions are met, a state at
    /// which it is regular too proves a lower bound on the rank. `strong` leaves out the drift.
    ///
    /// # Errors
    /// As [`Accessibility::new`].
    pub fn minor(
        &self,
        system: &mut System,
        conditions: &Assignment,
        strong: bool,
    ) -> Result<BracketMinor, CodistributionError> {
        let has_drift = system.drift().is_some() && strong;
        let kept = self.needed.iter().filter(|place| !has_drift || **place + 1 < self.rows.len());
        let rows: Vec<&Vec<NodeId>> = kept.map(|place| &self.rows[*place]).collect();
        let turned: Vec<Vec<NodeId>> =
            (0..self.columns.len()).map(|column| rows.iter().map(|row| row[column]).collect()).collect();
        let columns = raising(system, &turned, conditions)?;
        let entries = rows.iter().flat_map(|row| columns.iter().map(|column| row[*column])).collect();
        let columns = columns.iter().map(|column| self.columns[*column]).collect();
        Ok(BracketMinor { columns, entries })
    }

    /// The rows that raised the rank, one after the other.
    pub fn needed_entries(&self) -> Vec<NodeId> {
        self.needed.iter().flat_map(|place| self.rows[*place].iter().copied()).collect()
    }

    /// All rows, one after the other.
    pub fn entries(&self) -> Vec<NodeId> {
        self.rows.iter().flatten().copied().collect()
    }

    /// Whether longer brackets cannot raise the ranks at almost all states.
    pub fn is_final(&self) -> bool {
        self.whole.rank().is_some() && self.strong.rank().is_some()
    }
}

fn place_of(system: &System, symbol: Symbol) -> Option<usize> {
    system.states.iter().position(|state| *state == symbol)
}

/// A field that moves the states, and how its components change.
struct Generator {
    field: usize,
    is_drift: bool,
    motion: Motion,
    /// For each state, the derivatives of its component by others that do not vanish.
    slopes: Vec<Vec<(usize, NodeId)>>,
}

impl Generator {
    fn new(system: &mut System, field: usize) -> Generator {
        let zero = system.graph.integer(0);
        let states = system.states.clone();
        let found = &system.fields[field];
        let (name, is_drift) = (found.name.clone(), found.role == Role::Drift);
        let rates: HashMap<Symbol, NodeId> = found.components.iter().copied().collect();
        let components: Vec<NodeId> =
            states.iter().map(|state| rates.get(state).copied().unwrap_or(zero)).collect();
        let mut slopes = Vec::with_capacity(states.len());
        for component in &components {
            let by = match system.graph.constant_value(*component).is_some() {
                true => Vec::new(),
                false => gradient(&mut system.graph, *component, &states),
            };
            slopes.push(by.into_iter().enumerate().filter(|(_, slope)| *slope != zero).collect());
        }
        Generator { field, is_drift, motion: Motion { name, components }, slopes }
    }

    /// `[f, X]_i = L_f X_i - (df_i) X`; nothing where that is zero.
    fn bracket(&self, system: &mut System, of: &Motion) -> Option<Motion> {
        let zero = system.graph.integer(0);
        let mut components = Vec::with_capacity(of.components.len());
        for (component, slopes) in of.components.iter().zip(&self.slopes) {
            let forth = system.lie_derivative(self.field, *component);
            let mut parts = vec![forth];
            for (place, slope) in slopes {
                let part = system.graph.mul(*slope, of.components[*place]);
                parts.push(system.graph.neg(part));
            }
            components.push(system.graph.sum(parts));
        }
        let name = format!("[{}, {}]", self.motion.name, of.name);
        (components.iter().any(|one| *one != zero)).then_some(Motion { name, components })
    }
}

/// Whether the bracket of a field with a motion that is an input itself vanishes, or is that of the two in the other order.
fn inputs_in_order(motions: &[Motion], place: usize, generator: &Generator) -> bool {
    let own = motions.iter().position(|motion| motion.name == generator.motion.name);
    !generator.is_drift && !motions[place].name.starts_with('[') && own.is_some_and(|own| own >= place)
}

/// The rows that raise the rank at a random point that meets the conditions.
fn raising(
    system: &mut System,
    rows: &[Vec<NodeId>],
    conditions: &Assignment,
) -> Result<Vec<usize>, CodistributionError> {
    match rows.iter().any(|row| !row.is_empty()) {
        true => Ok(needed(system, rows, conditions)?.0),
        false => Ok(Vec::new()),
    }
}

/// The rank of some rows where the conditions are met, and with it that of all brackets: the same, where these rows are all
/// that count and have the rank that was found of them, else no more than around.
fn bounds(
    system: &mut System,
    rows: &[Vec<NodeId>],
    conditions: &Assignment,
    (closed, around): (Option<usize>, RankBounds),
) -> Result<RankBounds, CodistributionError> {
    let columns = rows.first().map_or(0, Vec::len);
    if columns == 0 {
        let at_most = if closed.is_some() { 0 } else { around.at_most };
        return Ok(RankBounds::open(at_most));
    }
    let written: Vec<NodeId> = rows.iter().flatten().copied().collect();
    let entries = system.graph.substitute(&written, conditions);
    let is_angle = &system.angle_test();
    let mut rng = ChaCha8Rng::seed_from_u64(0x6272_6163_6b65); // any fixed seed: the rank does not depend on the user's
    let (found, is_formal) = formal_rank(&mut system.graph, &entries, columns, is_angle, &mut rng);
    match found {
        GenericRank::Rank { rank, log2_error, .. } => {
            // where functions are related it may be less
            let at_least = if is_formal { 0 } else { rank };
            Ok(match closed {
                _ if rank == columns => RankBounds { at_least, log2_error, ..RankBounds::open(rank) },
                Some(found) if found == rank => RankBounds { at_least, log2_error, ..RankBounds::open(rank) },
                _ => RankBounds { at_least, ..around },
            })
        }
        GenericRank::Pole(divisor) => Err(CodistributionError::Pole { divisor: system.graph.text(divisor) }),
        GenericRank::Functions => Ok(RankBounds::open(columns)),
        GenericRank::Unknown(why) => Err(CodistributionError::NotEvaluated(why)),
    }
}

/// The ranks at the states around a set.
struct Around {
    whole: RankBounds,
    strong: RankBounds,
}

/// The ranks at almost all states, with only those conditions kept that concern parameters. On a special set they are no more.
fn around(
    system: &mut System,
    conditions: &Assignment,
    order: Option<usize>,
) -> Result<Around, CodistributionError> {
    let states = system.states.clone();
    let kept: Assignment = conditions
        .iter()
        .filter(|(symbol, value)| {
            let mentioned = system.graph.symbols_of([**value]);
            !states.contains(symbol) && !states.iter().any(|state| mentioned.contains(state))
        })
        .map(|(symbol, value)| (*symbol, *value))
        .collect();
    let found = Accessibility::new(system, &kept, order, &mut |_| ())?;
    Ok(Around { whole: found.whole, strong: found.strong })
}
