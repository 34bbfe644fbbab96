//! Where states are drawn from: the sample box of a system, cut by conditions and by values that are fixed.

use super::conditions::Branch;
use super::defined::Defined;
use super::state::{Coordinate, MissingInput, State};
use dashu::integer::IBig;
use dashu::rational::RBig;
use palmistry_lang::{Assignment, Kind, Range, System};
use palmistry_math::expression::{NodeId, Program, Symbol, expand_angles};
use palmistry_math::number::{Floats, Function, Rationals, Refusal, rational_from_f64, rational_to_f64};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::collections::BTreeMap;

/// Drawn states keep what a file says to `avoid` at least this far from zero.
pub const AVOIDED: f64 = 0.05;

/// Coordinates are drawn on a grid of this many binary places, so that exact arithmetic has short numbers to work on.
const GRID_BITS: usize = 16;

pub(crate) const ATTEMPTS: usize = 2000;

/// Why states cannot be drawn.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LocusError {
    /// Nothing says where to draw a symbol.
    #[error(
        "nothing says where '{0}' is drawn from; give it a range in 'sample', a value in 'param', or one with --at"
    )]
    NoRange(String),
    /// The box and what it avoids leave nothing.
    #[error("no state was found in {ATTEMPTS} draws: {0}")]
    Empty(String),
}

/// Where one symbol comes from.
#[derive(Clone, Debug)]
pub(crate) enum Source {
    Fixed(Coordinate),
    Between(RBig, RBig),
    /// An angle in radians.
    Turn(f64, f64),
}

/// A set of states that can be drawn from.
#[derive(Clone, Debug)]
pub struct Locus {
    pub(crate) sources: BTreeMap<Symbol, Source>,
    /// What the conditions give, as expressions of the rest.
    pub(crate) values: Assignment,
    /// What is avoided, as expressions of what is drawn.
    pub(crate) avoided: Vec<NodeId>,
    /// Solved symbols: value, or sine and cosine.
    dependent: Vec<(Symbol, bool)>,
    dependent_program: Program,
    avoid: Vec<String>,
    avoid_program: Program,
    /// Whether inequalities cut the box, and what they say.
    pub(crate) is_cut: bool,
    inside: Defined,
    /// The conditions and fixed values, in words.
    pub conditions: Vec<String>,
    /// The symbols that are drawn from a range that the file does not give, and this range.
    pub by_default: Vec<(String, Range)>,
}

impl Locus {
    /// The sample box of a system with some symbols fixed and conditions met. `mentioned` are the expressions
    /// that will be evaluated; parameters that they do not need are not drawn. What the file gives neither a range nor a value
    /// is drawn from [`System::default_range`].
    ///
    /// # Errors
    /// Where nothing says what a needed symbol is drawn from.
    pub fn new(
        system: &mut System,
        branch: &Branch,
        fixed: &BTreeMap<Symbol, RBig>,
        mentioned: &[NodeId],
    ) -> Result<Locus, LocusError> {
        let is_angle = &system.angle_test();
        let mut dependent: Vec<(Symbol, bool)> =
            branch.values.keys().map(|symbol| (*symbol, is_angle(*symbol))).collect();
        dependent.sort_unstable();
        let mut values = Vec::new();
        for (symbol, angle) in &dependent {
            let value = branch.values[symbol];
            if *angle {
                values.push(system.graph.apply(Function::Sin, value));
                values.push(system.graph.apply(Function::Cos, value));
            } else {
                values.push(value);
            }
        }
        let values = expand_angles(&mut system.graph, &values, is_angle);

        let kept_clear: Vec<NodeId> = system.avoid.iter().map(|(_, node)| *node).collect();
        let assumed: Vec<NodeId> = branch.assumed.iter().map(|guard| guard.node).collect();
        let all = mentioned.iter().chain(&values).chain(&kept_clear).chain(&assumed);
        let mut needed = system.graph.symbols_of(all.copied());
        needed.extend(system.states.iter().copied());
        needed.sort_unstable();
        needed.dedup();
        let mut sources = BTreeMap::new();
        let mut by_default = Vec::new();
        for symbol in needed {
            if branch.values.contains_key(&symbol) {
                continue;
            }
            if !fixed.contains_key(&symbol)
                && let Some(range) = system.default_range(symbol)
            {
                sources.insert(symbol, drawn_from(&range, is_angle(symbol)));
                by_default.push((system.symbol_name(symbol).to_owned(), range));
                continue;
            }
            sources.insert(symbol, source(system, symbol, fixed.get(&symbol))?);
        }
        let (avoid, avoid_nodes) = avoided(system, branch, &sources, is_angle);
        let mut conditions = branch.in_words(system);
        conditions
            .extend(fixed.iter().map(|(symbol, value)| format!("{} = {value}", system.symbol_name(*symbol))));
        Ok(Locus {
            sources,
            values: branch.values.clone(),
            dependent,
            dependent_program: Program::new(&system.graph, &values, is_angle),
            avoid,
            avoid_program: Program::new(&system.graph, &avoid_nodes, is_angle),
            avoided: avoid_nodes,
            is_cut: !branch.assumed.is_empty(),
            inside: Defined::new(system, &branch.assumed),
            conditions,
            by_default,
        })
    }

    /// The state of an index; the same for the same seed, whoever draws it and in whatever order.
    ///
    /// # Errors
    /// Where nothing was found that keeps clear of what is avoided.
    pub fn draw(&self, seed: u64, index: u64) -> Result<State, LocusError> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(index);
        let mut complaint = "the conditions have no solution there".to_owned();
        for _ in 0..ATTEMPTS {
            let mut state = State::default();
            for (symbol, source) in &self.sources {
                let unit = f64::from(rng.random_range(0..=1u32 << GRID_BITS)) / f64::from(1u32 << GRID_BITS);
                state.values.insert(*symbol, source.at(unit));
            }
            if self.complete(&mut state).is_err() {
                continue;
            }
            if self.is_cut && !self.inside.holds(&state) {
                complaint = "the last one did not meet all inequalities".to_owned();
                continue;
            }
            match self.avoided_value(&state) {
                None => return Ok(state),
                Some(index) => {
                    complaint = format!("the last one had |{}| below {AVOIDED}", self.avoid[index])
                }
            }
        }
        Err(LocusError::Empty(complaint))
    }

    /// Adds the symbols that the conditions give.
    pub(crate) fn complete(&self, state: &mut State) -> Result<(), Refusal> {
        let exact = Rationals::default();
        let inputs = state.inputs(&self.dependent_program, &exact).map_err(|missing| match missing {
            MissingInput::Refused(refusal) => refusal,
            MissingInput::Unsaid => Refusal::NotFinite,
        })?;
        let loaded = self.dependent_program.load(exact)?;
        let mut values = loaded.run(&inputs, &mut Vec::new()).map_err(|failure| failure.refusal)?.into_iter();
        for (symbol, is_angle) in &self.dependent {
            let mut next = || values.next().ok_or(Refusal::NotFinite);
            let value = if *is_angle {
                Coordinate::Angle { sine: next()?, cosine: next()? }
            } else {
                Coordinate::Number(next()?)
            };
            state.values.insert(*symbol, value);
        }
        Ok(())
    }

    /// The first of the avoided expressions that is too near to zero, or undefined.
    fn avoided_value(&self, state: &State) -> Option<usize> {
        if self.avoid.is_empty() {
            return None;
        }
        let values = state
            .inputs(&self.avoid_program, &Floats)
            .ok()
            .and_then(|inputs| self.avoid_program.load(Floats).ok()?.run(&inputs, &mut Vec::new()).ok());
        match values {
            Some(values) => values.iter().position(|value| value.is_nan() || value.abs() < AVOIDED),
            None => Some(0),
        }
    }
}

impl Source {
    /// The value at a part of the range between zero and one.
    fn at(&self, unit: f64) -> Coordinate {
        match self {
            Source::Fixed(value) => value.clone(),
            Source::Between(low, high) => {
                let part = rational_from_f64(unit).unwrap_or(RBig::ZERO);
                Coordinate::Number(low + (high - low) * part)
            }
            Source::Turn(low, high) => {
                Coordinate::from_half_tangent(&grid_half_tangent(low + (high - low) * unit))
            }
        }
    }
}

/// The tangent of half an angle, on the grid.
fn grid_half_tangent(angle: f64) -> RBig {
    let scale = f64::from(1u32 << GRID_BITS);
    let t = (angle / 2.0).tan().clamp(-scale, scale);
    RBig::from(IBig::from((t * scale).round() as i64)) / RBig::from(1i64 << GRID_BITS)
}

fn source(system: &System, symbol: Symbol, fixed: Option<&RBig>) -> Result<Source, LocusError> {
    // a known signal is the same kind of thing at every step
    let info = system.symbol_info(system.now(symbol));
    let is_angle = info.is_some_and(|info| info.is_angle);
    let value = fixed.or(match info {
        Some(info) if info.range.is_none() => info.default.as_ref(),
        _ => None,
    });
    if let Some(value) = value {
        return Ok(Source::Fixed(if is_angle {
            // the nearest double to the tangent of the half angle: an exact state a rounding away from the angle
            let t = (rational_to_f64(value) / 2.0).tan();
            Coordinate::from_half_tangent(&rational_from_f64(t).unwrap_or(RBig::ZERO))
        } else {
            Coordinate::Number(value.clone())
        }));
    }
    match info.and_then(|info| info.range.as_ref()) {
        Some(range) => Ok(drawn_from(range, is_angle)),
        None => Err(LocusError::NoRange(system.symbol_name(symbol).to_owned())),
    }
}

fn drawn_from(range: &Range, is_angle: bool) -> Source {
    match is_angle {
        true => Source::Turn(rational_to_f64(&range.low), rational_to_f64(&range.high)),
        false => Source::Between(range.low.clone(), range.high.clone()),
    }
}

/// What to avoid, as far as it can still vary and is not the very set that the conditions describe.
fn avoided(
    system: &mut System,
    branch: &Branch,
    sources: &BTreeMap<Symbol, Source>,
    is_angle: impl Fn(Symbol) -> bool,
) -> (Vec<String>, Vec<NodeId>) {
    let (mut texts, mut nodes) = (Vec::new(), Vec::new());
    for (text, node) in system.avoid.clone() {
        let value = system.graph.substitute(&[node], &branch.values)[0];
        let varies = system.graph.symbols_of([value]).iter().any(|symbol| {
            let kept = system.symbol_info(*symbol).is_some_and(|info| info.kind != Kind::Imported);
            kept && matches!(sources.get(symbol), Some(Source::Between(..) | Source::Turn(..)))
        });
        if varies && !super::conditions::vanishes(system, value) {
            texts.push(text);
            nodes.push(value);
        }
    }
    let nodes = expand_angles(&mut system.graph, &nodes, is_angle);
    (texts, nodes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sine_and_cosine_of_a_drawn_angle_lie_on_the_circle() {
        for step in 0..=100 {
            let angle = -3.0 + 0.06 * f64::from(step);
            let Coordinate::Angle { sine, cosine } = Coordinate::from_half_tangent(&grid_half_tangent(angle))
            else {
                panic!("not an angle");
            };
            assert!((&sine * &sine + &cosine * &cosine).is_one());
            // the grid of the half tangent is 2^-17 wide; its slope dt/dphi is at least one half
            assert!((rational_to_f64(&sine).atan2(rational_to_f64(&cosine)) - angle).abs() < 2.0 / 65536.0);
        }
    }
}
