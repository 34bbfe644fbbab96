//! States on each part of the set on which conditions hold: what is free is drawn, the rest follows.

use super::super::doubt::{Effort, Missing};
use super::super::identity::drawn;
use super::super::listing::{Listing, Step};
use super::super::state::{ExactCoordinate, ExactState, Ratio};
use super::conditions::{Equations, are_open};
use super::span::RowPlaces;
use super::{Atom, Normal, Part, Quotient, Stop, Term, with_divisors};
use dashu::rational::RBig;
use palmistry_math::number::Function;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// So many states are drawn on each part.
const DRAWN: usize = 2;

/// Some states on each part of the set, at which the rank of rows is to be looked at, with the kinds of coordinates that another state has, numbers or angles; nothing where conditions cannot be solved. A part is an open piece of a space in which what is free can have any value, so that a determinant that is not
/// zero at one of its states is zero at almost none.
///
/// # Errors
/// Where it takes too much work.
pub fn states_on_parts(
    states: Equations<'_>,
    rows: &[RowPlaces],
    (like, seed): (&ExactState, u64),
    effort: &Effort,
) -> Result<Option<Vec<Vec<ExactState>>>, Missing> {
    if !are_open(states) {
        return Ok(None);
    }
    with_divisors(effort, |normal| {
        let mut solved = Vec::new();
        if !normal.solve(states, &mut solved)? {
            return Ok(None);
        }
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut all = Vec::new();
        for part in solved {
            // of an angle that is known up to whole turns one value stands for all, where nothing else asks for it
            let turned = part.symbols.iter().filter(|(_, value)| normal.has_turns(value));
            let turned: Vec<String> =
                turned.map(|(name, _)| name).chain(normal.held(&part)).cloned().collect();
            if turned.iter().any(|name| !is_angle_alone(states.listing, rows, name)) {
                return Ok(None);
            }
            let free = like.iter().filter(|(name, _)| !part.symbols.contains_key(*name));
            let free: ExactState = free.map(|(name, value)| (name.clone(), value.clone())).collect();
            normal.set(part.clone());
            let mut found = Vec::new();
            for attempt in 0..DRAWN {
                let mut state = drawn(&free, attempt, &mut rng);
                if normal.complete(&part, &mut state)? {
                    found.push(state);
                }
            }
            all.push(found);
        }
        Ok(Some(all))
    })
}

/// Whether a symbol stands in sines and cosines only, with multiples of one.
fn is_angle_alone(listing: &Listing, rows: &[RowPlaces], name: &str) -> bool {
    let steps = listing.steps();
    let mut holds = vec![false; steps.len()];
    for (place, step) in steps.iter().enumerate() {
        let is_held = step.operands().any(|operand| holds[operand]);
        match step {
            Step::Symbol(own) => holds[place] = own == name,
            Step::Add(..) | Step::Sub(..) | Step::Neg(_) => holds[place] = is_held,
            Step::Apply(Function::Sin | Function::Cos, _) => {}
            _ if is_held => return false,
            _ => {}
        }
    }
    rows.iter().flatten().all(|place| !holds.get(*place).copied().unwrap_or(true))
}

impl Normal<'_> {
    fn has_turns(&self, quotient: &Quotient) -> bool {
        let variables = quotient.powers.keys().flat_map(|factor| self.field.factor(*factor).variables());
        variables.into_iter().any(|variable| matches!(self.atom_of(variable), Some(Atom::Turns(_))))
    }

    /// The symbols for which only sine and cosine are given.
    fn held<'s>(&'s self, part: &'s Part) -> impl Iterator<Item = &'s String> {
        let variables = part.angles.iter().flat_map(|(term, _)| term.0.powers());
        variables.filter_map(|(variable, _)| match self.atom_of(*variable) {
            Some(Atom::Symbol(name)) => Some(name),
            _ => None,
        })
    }

    /// Gives a state what follows from what it has; `false` where that has no rational value, or no rational sine and cosine.
    fn complete(&mut self, part: &Part, state: &mut ExactState) -> Result<bool, Stop> {
        for ((monomial, below), [cosine, sine]) in &part.angles {
            let ([(variable, 1)], true) =
                (monomial.powers(), below.number().is_some_and(|number| number.is_one()))
            else {
                return Ok(false);
            };
            let Some(Atom::Symbol(name)) = self.atom_of(*variable).cloned() else { return Ok(false) };
            let [sin, cos] = [sine, cosine].map(|value| Ratio(RBig::from(*value)));
            state.insert(name, ExactCoordinate::Angle { sin, cos });
        }
        let free = state.clone();
        for (name, value) in &part.symbols {
            let coordinate = match self.number(value, &free) {
                Some(number) => ExactCoordinate::Number(Ratio(number)),
                None => {
                    let (cosine, sine) = self.circular(value)?;
                    match (self.number(&sine, &free), self.number(&cosine, &free)) {
                        (Some(sin), Some(cos)) => ExactCoordinate::Angle { sin: Ratio(sin), cos: Ratio(cos) },
                        _ => return Ok(false),
                    }
                }
            };
            state.insert(name.clone(), coordinate);
        }
        Ok(true)
    }

    /// The value of a quotient at a state, where it is rational there for a reason that is known here.
    fn number(&self, quotient: &Quotient, state: &ExactState) -> Option<RBig> {
        let mut product = quotient.number.clone();
        for (factor, power) in &quotient.powers {
            let mut sum = RBig::ZERO;
            for (monomial, value) in self.field.factor(*factor).terms() {
                let mut term = RBig::from(value.clone());
                for (variable, exponent) in monomial.powers() {
                    term *= self.variable_at(*variable, state)?.pow(*exponent as isize);
                }
                sum += term;
            }
            if sum.is_zero() && *power < 0 {
                return None;
            }
            let value = sum.pow(power.unsigned_abs() as isize);
            product = if *power < 0 { product / value } else { product * value };
        }
        Some(product)
    }

    fn variable_at(&self, variable: u32, state: &ExactState) -> Option<RBig> {
        let circular = |term: &Term| {
            let [(angle, 1)] = *term.0.powers() else { return None };
            let is_whole =
                term.1.number().is_some_and(|number| number.is_one()) && !self.divisors.contains_key(term);
            match (self.atom_of(angle)?, is_whole) {
                (Atom::Symbol(name), true) => match state.get(name)? {
                    ExactCoordinate::Angle { sin, cos } => Some((sin.0.clone(), cos.0.clone())),
                    _ => None,
                },
                _ => None,
            }
        };
        match self.atom_of(variable)? {
            Atom::Symbol(name) => match state.get(name)? {
                ExactCoordinate::Number(value) => Some(value.0.clone()),
                _ => None,
            },
            Atom::Sine(term) => circular(term).map(|(sine, _)| sine),
            Atom::Cosine(term) => circular(term).map(|(_, cosine)| cosine),
            _ => None,
        }
    }
}
