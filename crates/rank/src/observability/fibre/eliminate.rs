//! What can be solved for a variable is solved and put in, before a basis is looked for.

use super::jets::Jet;
use palmistry_math::number::PrimeField;
use std::cell::Cell;
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// Equations that are left, and the variables that are functions of those in them.
pub(super) struct Solved {
    pub equations: Vec<Jet>,
    pub solved: HashMap<u32, Jet>,
    highest_degree: u32,
}

/// What it takes to look at a term of a polynomial in a tree, in products of residues.
pub(super) const TERM: u64 = 40;

/// How many terms polynomials have.
pub(super) fn terms(equations: &[Jet]) -> u64 {
    equations.iter().map(|equation| equation.terms.len() as u64).sum()
}

/// A polynomial may grow to so many terms.
const LONGEST: usize = 3_000;

impl Solved {
    /// Solves equations up to a degree, the others stay; what it takes is added to the work.
    pub fn new(
        field: &PrimeField,
        equations: Vec<Jet>,
        highest_degree: u32,
        work: &Cell<u64>,
        is_over: &dyn Fn() -> bool,
    ) -> Solved {
        let mut solved = Solved { equations, solved: HashMap::new(), highest_degree };
        loop {
            // each step goes through all terms
            work.set(work.get() + TERM * terms(&solved.equations));
            solved.equations.retain(|equation| !equation.is_zero());
            solved.put_numbers_in(field);
            if is_over() || !(solved.put_one_in(field) || solved.combine(field)) {
                return solved;
            }
        }
    }

    /// A variable as a polynomial in those that are left.
    pub fn express(&self, field: &PrimeField, variable: u32) -> Jet {
        self.solved.get(&variable).cloned().unwrap_or_else(|| Jet::variable(field, variable))
    }

    /// All equations that give a variable a value.
    fn put_numbers_in(&mut self, field: &PrimeField) {
        loop {
            let mut values: HashMap<u32, u64> = HashMap::new();
            for equation in &self.equations {
                if let Some((variable, value)) = as_value(field, equation) {
                    values.entry(variable).or_insert(value);
                }
            }
            if values.is_empty() {
                return;
            }
            for equation in self.equations.iter_mut().chain(self.solved.values_mut()) {
                *equation = equation.with_values(field, |variable| values.get(&variable).copied());
            }
            self.equations.retain(|equation| !equation.is_zero());
            self.solved.extend(values.into_iter().map(|(variable, value)| (variable, Jet::constant(value))));
        }
    }

    /// Solves one equation for a variable, where the others do not grow by it.
    fn put_one_in(&mut self, field: &PrimeField) -> bool {
        let mut occurrences: HashMap<u32, usize> = HashMap::new();
        for equation in &self.equations {
            let mut terms: BTreeMap<u32, usize> = BTreeMap::new();
            for (variable, _) in equation.terms.keys().flatten() {
                *terms.entry(*variable).or_default() += 1;
            }
            for (variable, count) in terms {
                *occurrences.entry(variable).or_default() += count;
            }
        }
        let mut best: Option<(usize, usize, u32)> = None;
        for (place, equation) in self.equations.iter().enumerate() {
            if equation.degree() > self.highest_degree {
                continue;
            }
            for variable in alone_and_linear(equation) {
                let elsewhere = occurrences[&variable] - 1;
                let length = equation.terms.len() - 1;
                let degree = equation.degree() as usize;
                let growth = elsewhere * length.saturating_sub(1) * degree.max(1);
                let cost = if degree <= 1 { growth / 4 } else { growth };
                // what is of higher order comes first
                if best
                    .is_none_or(|(least, _, other)| (cost, u32::MAX - variable) < (least, u32::MAX - other))
                {
                    best = Some((cost, place, variable));
                }
            }
        }
        let Some((cost, place, variable)) = best else { return false };
        if cost > WORTH {
            return false;
        }
        let equation = self.equations.swap_remove(place);
        let Some(by) = solve_for(field, &equation, variable) else { return false };
        let mut changed = Vec::new();
        for other in &self.equations {
            match other.substitute(field, variable, &by, LONGEST) {
                Some(other) => changed.push(other),
                None => {
                    self.equations.push(equation);
                    return false;
                }
            }
        }
        self.equations = changed;
        for other in self.solved.values_mut() {
            if other.variables().contains(&variable)
                && let Some(found) = other.substitute(field, variable, &by, LONGEST * 10)
            {
                *other = found;
            }
        }
        self.solved.insert(variable, by);
        true
    }

    /// Linear combinations of the equations, over the numbers: whether one of them is linear that was not.
    fn combine(&mut self, field: &PrimeField) -> bool {
        let linear = |equations: &[Jet]| {
            equations.iter().filter(|e| !alone_and_linear(e).is_empty() && e.degree() <= 1).count()
        };
        let before = linear(&self.equations);
        let degree = |m: &[(u32, u16)]| m.iter().map(|(_, n)| u32::from(*n)).sum::<u32>();
        let mut rows: Vec<Jet> = Vec::new();
        let mut leads: Vec<Vec<(u32, u16)>> = Vec::new();
        let mut waiting = self.equations.clone();
        waiting.sort_by_key(|equation| (equation.degree(), equation.terms.len()));
        for mut equation in waiting {
            for (row, lead) in rows.iter().zip(&leads) {
                if let Some(coefficient) = equation.terms.get(lead).copied() {
                    equation.add_multiple(field, row, field.modulus() - coefficient);
                }
            }
            let lead = equation.terms.keys().max_by_key(|m| (degree(m), (*m).clone())).cloned();
            let Some(lead) = lead else { continue };
            let Some(inverse) = field.inverse(equation.terms[&lead]) else { continue };
            let mut monic = Jet::default();
            monic.add_multiple(field, &equation, inverse);
            for row in &mut rows {
                if let Some(coefficient) = row.terms.get(&lead).copied() {
                    row.add_multiple(field, &monic, field.modulus() - coefficient);
                }
            }
            rows.push(monic);
            leads.push(lead);
        }
        let is_shorter = linear(&rows) > before;
        if is_shorter {
            self.equations = rows;
        }
        is_shorter
    }

    /// The variables that are left.
    pub fn variables(&self) -> BTreeSet<u32> {
        self.equations.iter().flat_map(Jet::variables).collect()
    }
}

/// So many terms more are worth a variable less.
const WORTH: usize = 12;

/// The variable that an equation gives a value, and the value.
fn as_value(field: &PrimeField, equation: &Jet) -> Option<(u32, u64)> {
    let variables = equation.variables();
    let variable = variables.first().copied().filter(|_| variables.len() == 1 && equation.degree() == 1)?;
    let slope = *equation.terms.get(&vec![(variable, 1)])?;
    let constant = equation.terms.get(&Vec::new()).copied().unwrap_or(0);
    let minus = if constant == 0 { 0 } else { field.modulus() - constant };
    Some((variable, field.product(minus, field.inverse(slope)?)))
}

/// The variables that stand in one term, alone and in first power.
fn alone_and_linear(equation: &Jet) -> Vec<u32> {
    let mut terms: BTreeMap<u32, usize> = BTreeMap::new();
    for (variable, _) in equation.terms.keys().flatten() {
        *terms.entry(*variable).or_default() += 1;
    }
    let alone = |variable: &u32| equation.terms.contains_key(&vec![(*variable, 1)]);
    terms.into_iter().filter(|(_, count)| *count == 1).map(|(variable, _)| variable).filter(alone).collect()
}

fn solve_for(field: &PrimeField, equation: &Jet, variable: u32) -> Option<Jet> {
    let slope = *equation.terms.get(&vec![(variable, 1)])?;
    let mut rest = equation.clone();
    rest.terms.remove(&vec![(variable, 1)]);
    let inverse = field.inverse(slope)?;
    let mut by = Jet::default();
    by.add_multiple(field, &rest, field.modulus() - inverse);
    Some(by)
}
