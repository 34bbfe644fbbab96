//! Fields that keep a system: affine ones that change no output and commute with all fields that move the states. A function that
//! changes along one is not observable from any experiment
//! (*Lie symmetries*: J. Yates, N. Evans and M. Chappell, *Structural identifiability analysis via symmetries of differential equations*, Automatica 45, 2009).
//!
//! The equations for the coefficients of such a field are linear, and each monomial of what has to vanish is one of them: what solves them is proved by that.

use super::super::doubt::{Effort, Missing};
use super::closure::MovingField;
use super::conditions::{Equations, on_each_part};
use super::polynomial::{IntegerPolynomial, Monomial};
use super::span::{Echelon, RowPlaces, entries};
use super::{Normal, Quotient, Stop};
use dashu::rational::RBig;
use std::collections::{BTreeMap, HashMap};

/// What is asked of the affine fields that keep a system.
#[derive(Clone, Copy, Debug)]
pub struct KeptFields<'l> {
    /// The listing, the conditions and the requirements; no sides. No field that moves the states leaves the set on which the conditions hold.
    pub states: Equations<'l>,
    /// The symbols of the columns.
    pub columns: &'l [String],
    /// The differentials of the outputs, and of the conditions.
    pub constant: &'l [RowPlaces],
    /// The fields.
    pub fields: &'l [MovingField],
    /// How many of them there have to be, independent at almost all states; `None` where that is not asked.
    pub dimension: Option<usize>,
    /// Differentials that all of them leave unchanged.
    pub inside: &'l [RowPlaces],
    /// Differentials each of which is changed by one of them.
    pub outside: &'l [RowPlaces],
}

/// Whether affine fields that keep the system show all that is asked, on each part of the set on which the conditions hold. `false` says nothing.
///
/// # Errors
/// Where it takes too much work, or an operation has no value.
pub fn kept(asked: KeptFields<'_>, effort: &Effort) -> Result<bool, Missing> {
    on_each_part(asked.states, effort, |normal, _| normal.is_kept(asked))
}

/// The place of a coefficient: of the component of a column, that of another column's symbol, or, behind all of them, the constant; and, behind all components, by how much a bracket with a
/// field is another one that is known.
#[derive(Clone, Copy)]
struct Places {
    width: usize,
}

impl Places {
    fn of(self, component: usize, by: Option<usize>) -> usize {
        component * (self.width + 1) + by.unwrap_or(self.width)
    }

    fn count(self) -> usize {
        self.width * (self.width + 1)
    }
}

/// An equation: coefficients by their places.
type Equation = BTreeMap<usize, RBig>;

/// A field by its components.
type Components = Vec<Quotient>;

impl Normal<'_> {
    fn is_kept(&mut self, asked: KeptFields<'_>) -> Result<bool, Stop> {
        let mut wanted = [asked.constant, asked.inside, asked.outside].concat().concat();
        for field in asked.fields {
            wanted.extend(field.rates.iter().map(|(_, place)| *place));
            wanted.extend(field.slopes.iter().chain(&field.known_slopes).flatten());
        }
        let mut values = BTreeMap::new();
        self.forms(asked.states.listing, &wanted, &mut values)?;
        // those that bracket into others follow these
        let mut fields: Vec<Components> = Vec::new();
        loop {
            let more = self.fields_beside(asked, &values, &fields)?;
            if more.len() <= fields.len() {
                break;
            }
            fields = more;
        }
        if let Some(dimension) = asked.dimension {
            let mut echelon = Echelon::default();
            for field in &fields {
                let left = self.reduced(&echelon, field.clone())?;
                if left.iter().any(|entry| !entry.is_zero()) && !self.enter(&mut echelon, left)? {
                    return Ok(false);
                }
            }
            if echelon.rows.len() != dimension {
                return Ok(false);
            }
        }
        for (rows, is_moved) in [(asked.inside, false), (asked.outside, true)] {
            for row in rows {
                let row = entries(row, &values)?;
                let mut moved = false;
                for field in &fields {
                    let terms: Vec<Quotient> = row
                        .iter()
                        .zip(field)
                        .map(|(slope, component)| self.field.times(slope, component))
                        .collect::<Result<_, _>>()?;
                    let change = self.field.sum(&terms)?;
                    moved |= !change.is_zero() && (!is_moved || self.is_free(&change));
                }
                if moved != is_moved {
                    return Ok(false);
                }
            }
        }
        Ok(true)
    }

    /// All affine fields that change nothing that is constant and whose brackets with the fields that move the states are combinations, with numbers, of some others.
    fn fields_beside(
        &mut self,
        asked: KeptFields<'_>,
        values: &BTreeMap<usize, Quotient>,
        others: &[Components],
    ) -> Result<Vec<Components>, Stop> {
        let places = Places { width: asked.columns.len() };
        // what is given by others is no coordinate of the set
        let is_free: Vec<bool> =
            asked.columns.iter().map(|name| !self.part.symbols.contains_key(name)).collect();
        let symbols: Vec<Option<IntegerPolynomial>> = asked
            .columns
            .iter()
            .zip(&is_free)
            .map(|(name, is_free)| is_free.then(|| self.symbol(name)))
            .collect();
        let mut equations = Vec::new();
        let known = asked.fields.iter().flat_map(|field| &field.known_slopes);
        for row in asked.constant.iter().chain(known) {
            let terms: Vec<(usize, Quotient)> = entries(row, values)?.into_iter().enumerate().collect();
            self.equate(places, &symbols, &terms, &[], &mut equations)?;
        }
        for (number, field) in asked.fields.iter().enumerate() {
            let zero = Quotient::from(RBig::ZERO);
            let rate = |name: &String| {
                let place = field.rates.iter().find(|(moved, _)| moved == name).map(|(_, place)| place);
                place.and_then(|place| values.get(place)).unwrap_or(&zero).clone()
            };
            let rates: Vec<Quotient> = asked.columns.iter().map(rate).collect();
            for (component, slopes) in field.slopes.iter().enumerate() {
                let terms: Vec<(usize, Quotient)> =
                    entries(slopes, values)?.into_iter().enumerate().collect();
                // the field's own component along the rates
                let along = rates.iter().enumerate().filter(|(by, _)| is_free[*by]);
                let along = along.map(|(by, rate)| (places.of(component, Some(by)), rate.neg()));
                let into = others.iter().enumerate().map(|(other, components)| {
                    (places.count() + number * others.len() + other, components[component].clone())
                });
                let own: Vec<(usize, Quotient)> = along.chain(into).collect();
                self.equate(places, &symbols, &terms, &own, &mut equations)?;
            }
        }
        let count = places.count() + asked.fields.len() * others.len();
        // a coefficient of what is no coordinate is none
        for component in 0..places.width {
            let given = (0..places.width).filter(|by| !is_free[*by]);
            equations.extend(given.map(|by| Equation::from([(places.of(component, Some(by)), RBig::ONE)])));
        }
        let solutions = solved(equations, count, self.field.effort)?;
        let mut fields = Vec::new();
        for solution in &solutions {
            let mut components = Vec::new();
            for component in 0..places.width {
                let mut terms = vec![Quotient::from(solution[places.of(component, None)].clone())];
                for (by, symbol) in symbols.iter().enumerate() {
                    let value = &solution[places.of(component, Some(by))];
                    if let Some(symbol) = symbol.as_ref().filter(|_| !value.is_zero()) {
                        let symbol = self.field.quotient(symbol.clone());
                        terms.push(self.field.times(&symbol, &Quotient::from(value.clone()))?);
                    }
                }
                components.push(self.field.sum(&terms)?);
            }
            if !components.iter().all(Quotient::is_zero) {
                fields.push(components);
            }
        }
        Ok(fields)
    }

    /// The equations that a sum is zero: of `terms`, each a quotient times the component of a column, and of quotients times coefficients by their places.
    fn equate(
        &mut self,
        places: Places,
        symbols: &[Option<IntegerPolynomial>],
        terms: &[(usize, Quotient)],
        own: &[(usize, Quotient)],
        equations: &mut Vec<Equation>,
    ) -> Result<(), Missing> {
        let all: Vec<&Quotient> = terms.iter().chain(own).map(|(_, quotient)| quotient).collect();
        let above = self.field.above(&all)?;
        let mut by_monomial: HashMap<Monomial, Equation> = HashMap::new();
        let mut enter = |polynomial: &IntegerPolynomial, scale: &RBig, place: usize| {
            for (monomial, value) in polynomial.terms() {
                let entry = by_monomial.entry(monomial.clone()).or_default().entry(place).or_default();
                *entry += scale * RBig::from(value.clone());
            }
        };
        for ((component, _), (scale, polynomial)) in terms.iter().zip(&above) {
            enter(polynomial, scale, places.of(*component, None));
            for (by, symbol) in symbols.iter().enumerate() {
                let Some(symbol) = symbol else { continue };
                let product = self.field.relations.times(polynomial, symbol, self.field.effort)?;
                enter(&product, scale, places.of(*component, Some(by)));
            }
        }
        for ((place, _), (scale, polynomial)) in own.iter().zip(&above[terms.len()..]) {
            enter(polynomial, scale, *place);
        }
        equations.extend(by_monomial.into_values());
        Ok(())
    }
}

/// All solutions of homogeneous equations in so many unknowns: a basis.
fn solved(equations: Vec<Equation>, count: usize, effort: &Effort) -> Result<Vec<Vec<RBig>>, Missing> {
    let mut solved: BTreeMap<usize, Equation> = BTreeMap::new();
    for mut equation in equations {
        equation.retain(|_, value| !value.is_zero());
        while let Some(pivot) = equation.keys().copied().find(|place| solved.contains_key(place)) {
            let Some(by) = equation.get(&pivot).cloned() else { break };
            subtract(&mut equation, &solved[&pivot], &by, effort)?;
        }
        let Some((pivot, value)) = equation.iter().next().map(|(place, value)| (*place, value.clone()))
        else {
            continue;
        };
        equation.values_mut().for_each(|entry| *entry = &*entry / &value);
        for other in solved.values_mut() {
            if let Some(by) = other.get(&pivot).cloned() {
                subtract(other, &equation, &by, effort)?;
            }
        }
        solved.insert(pivot, equation);
    }
    let free = (0..count).filter(|place| !solved.contains_key(place));
    let basis = free.map(|place| {
        let mut solution = vec![RBig::ZERO; count];
        solution[place] = RBig::ONE;
        for (pivot, equation) in &solved {
            if let Some(value) = equation.get(&place) {
                solution[*pivot] = -value.clone();
            }
        }
        solution
    });
    Ok(basis.collect())
}

fn subtract(from: &mut Equation, other: &Equation, by: &RBig, effort: &Effort) -> Result<(), Missing> {
    effort.spend(4 * other.len() as u64)?;
    for (place, value) in other {
        let entry = from.entry(*place).or_default();
        *entry = &*entry - by * value;
        if entry.is_zero() {
            from.remove(place);
        }
    }
    Ok(())
}
