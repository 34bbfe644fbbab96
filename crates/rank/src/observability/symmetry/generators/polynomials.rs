//! Polynomials, and polynomials over products of unknowns, that have the value of a random point on slices of its fibre: linear equations for their coefficients.

use super::super::functions::FunctionTerms;
use super::super::modular::{Echelon, in_integers, simple_vectors};
use super::super::monomial::{Monomial, Polynomial, count};
use super::super::{factor_nodes, product};
use super::{Candidate, Search};
use palmistry_math::expression::SymbolFunction;
use std::collections::BTreeMap;
use std::sync::atomic::Ordering;

/// No more unknown coefficients are solved for at once.
const MOST_UNKNOWNS: usize = 330;
/// Polynomials of no higher degree are looked for.
const HIGHEST_DEGREE: usize = 3;
/// Nor higher powers of one unknown.
const HIGHEST_POWER: usize = 8;
/// No more denominators than this are tried.
const MOST_BELOW: usize = 60;
/// So many slices that add nothing end the search for equations.
const IDLE: usize = 2;

/// What is known of one slice: of each monomial its values on the slice, and its value at the point.
pub(super) struct Sliced {
    forms: Vec<Vec<u64>>,
    own: Vec<u64>,
}

impl Search<'_> {
    /// The highest degree whose monomials were looked at.
    pub(super) fn degree(&self) -> usize {
        self.monomials.iter().map(Monomial::degree).max().unwrap_or(0)
    }

    /// Chooses the monomials, by how many there are.
    ///
    /// # Errors
    /// Where the unknowns are too many.
    pub(super) fn prepare(&mut self) -> Result<(), String> {
        let all: Vec<usize> = (0..self.variables.len()).collect();
        let open: Vec<usize> = all.iter().copied().filter(|place| self.is_open[*place]).collect();
        // what has one value may stand beside what has not, as in x1*p1 + x2*p2
        let degrees = (1..=HIGHEST_DEGREE)
            .rev()
            .flat_map(|of_open| (1..=of_open).rev().map(move |of_all| (of_open, of_all)));
        let fits = |(of_open, of_all): &(usize, usize)| {
            let both = count(all.len(), *of_all) + count(open.len(), *of_open) - count(open.len(), *of_all);
            both <= MOST_UNKNOWNS
        };
        let (of_open, of_all) = degrees
            .into_iter()
            .find(fits)
            .ok_or_else(|| format!("{} variables have too many monomials to be looked at", all.len()))?;
        let mut last = vec![Monomial::default()];
        self.monomials = last.clone();
        for degree in 1..=of_open {
            let mut next = Vec::new();
            for monomial in &last {
                let most = monomial.powers.first().map_or(usize::MAX, |(place, _)| *place);
                let is_all_open = monomial.powers.iter().all(|(place, _)| self.is_open[*place]);
                for place in all.iter().filter(|place| **place <= most) {
                    let is_squared_sine =
                        *place == most && self.variables[*place].function == SymbolFunction::Sine;
                    let is_wanted = degree <= of_all || (is_all_open && self.is_open[*place]);
                    // the square of a sine is one less that of the cosine
                    if is_wanted && !is_squared_sine {
                        next.push(times(monomial, *place));
                    }
                }
            }
            self.monomials.extend(next.iter().cloned());
            last = next;
        }
        // of one unknown as many powers as it has values, as in p^4
        for place in open {
            let values = self.values[place].min(HIGHEST_POWER);
            for power in of_open + 1..=values {
                self.monomials.push(Monomial { powers: vec![(place, power as u8)], angle: None });
            }
        }
        Ok(())
    }

    /// One more slice, with all monomials on it.
    fn slice(&mut self) -> Result<(), String> {
        let mut slice = self.slicer.next()?;
        let place: BTreeMap<&Monomial, usize> = self.monomials.iter().zip(0..).collect();
        let mut sliced = Sliced { forms: Vec::new(), own: Vec::new() };
        for monomial in &self.monomials {
            let (form, own) = match monomial.powers.first() {
                None => (slice.one(), self.residues.one()),
                Some((variable, power)) => {
                    let mut rest = monomial.clone();
                    match power {
                        1 => drop(rest.powers.remove(0)),
                        _ => rest.powers[0].1 -= 1,
                    }
                    let known = place[&rest];
                    let form = slice.times(*variable, &sliced.forms[known]);
                    (form, self.residues.mul(slice.own[*variable], sliced.own[known]))
                }
            };
            sliced.forms.push(form);
            sliced.own.push(own);
        }
        self.slices.push(sliced);
        Ok(())
    }

    /// Polynomials up to a degree that have one value, over all products of so many unknowns; whether there are new ones.
    ///
    /// # Errors
    /// In words, where slices take too much work.
    pub(super) fn polynomials(&mut self, degree: usize, below: usize) -> Result<bool, String> {
        let is_below = |monomial: &Monomial| {
            monomial.degree() == below
                && monomial.powers.iter().all(|(place, _)| {
                    self.is_open[*place] && self.variables[*place].function == SymbolFunction::Itself
                })
        };
        let bottoms: Vec<usize> = (0..self.monomials.len())
            .filter(|place| is_below(&self.monomials[*place]))
            .take(MOST_BELOW)
            .collect();
        let before = self.candidates.len();
        for bottom in bottoms {
            if self.question.interrupt.load(Ordering::Relaxed) {
                return Err("it was interrupted".to_owned());
            }
            let has_open =
                |monomial: &Monomial| monomial.powers.iter().any(|(place, _)| self.is_open[*place]);
            let is_above = |place: &usize| {
                let monomial = &self.monomials[*place];
                let changes = below > 0 || has_open(monomial);
                *place != bottom && monomial.degree() <= degree && changes
            };
            let tops: Vec<usize> = (0..self.monomials.len()).filter(is_above).collect();
            for vector in self.solved(&tops, bottom)? {
                self.candidate(&tops, &vector, bottom);
            }
        }
        Ok(self.candidates.len() > before)
    }

    /// The combinations of monomials that are a multiple of another one by what the point has: a basis with few terms.
    fn solved(&mut self, tops: &[usize], bottom: usize) -> Result<Vec<Vec<u64>>, String> {
        let r = self.residues;
        let mut echelon = Echelon::new(r, tops.len());
        let (mut idle, mut next) = (0, 0);
        while idle < IDLE && echelon.rank() < tops.len() {
            if next == self.slices.len() {
                self.slice()?;
            }
            let (slice, before) = (&self.slices[next], echelon.rank());
            next += 1;
            for point in 0..slice.forms[bottom].len() {
                let entry = |top: &usize| {
                    let here = r.mul(slice.forms[*top][point], slice.own[bottom]);
                    r.sub(here, r.mul(slice.forms[bottom][point], slice.own[*top]))
                };
                echelon.add(tops.iter().map(entry).collect());
            }
            idle = if echelon.rank() == before { idle + 1 } else { 0 };
        }
        let cost = |place: usize| self.monomials[tops[place]].degree() as u64;
        let mut emptied: Vec<usize> = (0..tops.len()).collect();
        emptied.sort_by_key(|place| std::cmp::Reverse(cost(*place)));
        Ok(simple_vectors(r, &echelon.kernel().1, &cost, &emptied))
    }

    /// Takes a combination of monomials over one for a candidate, unless it is one already or an unknown divides both.
    fn candidate(&mut self, tops: &[usize], vector: &[u64], bottom: usize) {
        let Some(vector) = in_integers(self.residues, vector) else { return };
        let terms = tops.iter().zip(&vector).filter(|(_, coefficient)| **coefficient != 0);
        let polynomial: Polynomial = terms.map(|(top, c)| (self.monomials[*top].clone(), *c)).collect();
        let bottom = self.monomials[bottom].clone();
        let divides = |place: usize| {
            let has_it = |(monomial, _): &(Monomial, i64)| monomial.powers.iter().any(|(of, _)| *of == place);
            polynomial.iter().all(has_it)
        };
        if polynomial.is_empty() || bottom.powers.iter().any(|(place, _)| divides(*place)) {
            return;
        }
        let mut factors = vec![(polynomial, 1)];
        for (place, power) in bottom.powers {
            factors.push((vec![(Monomial::variable(place), 1)], -i64::from(power)));
        }
        let function = FunctionTerms { factors };
        let text = function.text(&self.system.graph, &self.variables);
        if self.candidates.iter().any(|known| known.text == text) {
            return;
        }
        let graph = &mut self.system.graph;
        let factors = factor_nodes(graph, &self.variables, &function);
        let value = product(graph, &factors);
        self.candidates.push(Candidate::function(text, value));
    }
}

/// A monomial times a variable that stands before all of its own, or is the first of them.
fn times(monomial: &Monomial, place: usize) -> Monomial {
    let mut powers = monomial.powers.clone();
    match powers.first_mut() {
        Some((first, power)) if *first == place => *power += 1,
        _ => powers.insert(0, (place, 1)),
    }
    Monomial { powers, angle: None }
}
