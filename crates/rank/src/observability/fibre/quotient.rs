//! How many values a polynomial has on the points of an ideal: by the minimal polynomial in the quotient algebra.

use super::basis::{Basis, Row};
use crate::observability::residue_polynomial::gcd;
use palmistry_math::number::PrimeField;
use std::collections::HashMap;

/// The polynomials modulo an ideal with finitely many points.
pub(super) struct Algebra {
    basis: Basis,
    /// The monomials that no leading monomial divides, and their places.
    standard: Vec<u32>,
    place: HashMap<u32, usize>,
    known: HashMap<u32, Vec<u64>>,
}

/// Why there is no algebra.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NoAlgebra {
    /// The points are infinitely many.
    Infinite,
    /// They are more than this.
    MoreThan(usize),
}

impl Algebra {
    pub fn new(mut basis: Basis, most: usize) -> Result<Algebra, NoAlgebra> {
        let variables = basis.monomials.variables();
        let leads: Vec<u32> = basis.leads().map(|(lead, _)| lead).collect();
        let is_standard =
            |basis: &Basis, monomial: u32| !leads.iter().any(|lead| basis.monomials.divides(*lead, monomial));
        for variable in 0..variables {
            let is_power = |lead: &u32| {
                basis
                    .monomials
                    .powers(*lead)
                    .iter()
                    .enumerate()
                    .all(|(other, power)| other == variable || *power == 0)
            };
            if !leads.iter().any(is_power) {
                return Err(NoAlgebra::Infinite);
            }
        }
        let one = basis.monomials.of(&[]);
        let single: Vec<u32> = (0..variables).map(|variable| basis.monomials.of(&[(variable, 1)])).collect();
        let (mut standard, mut place, mut next) = (Vec::new(), HashMap::new(), 0);
        if is_standard(&basis, one) {
            place.insert(one, 0);
            standard.push(one);
        }
        while next < standard.len() {
            for variable in &single {
                let product = basis.monomials.product(standard[next], *variable);
                if !place.contains_key(&product) && is_standard(&basis, product) {
                    place.insert(product, standard.len());
                    standard.push(product);
                    if standard.len() > most {
                        return Err(NoAlgebra::MoreThan(most));
                    }
                }
            }
            next += 1;
        }
        Ok(Algebra { basis, standard, place, known: HashMap::new() })
    }

    /// How many points there are, each as often as it counts.
    pub fn dimension(&self) -> usize {
        self.standard.len()
    }

    fn field(&self) -> PrimeField {
        self.basis.field
    }

    /// A monomial as a combination of standard ones.
    fn normal_form(&mut self, monomial: u32) -> Vec<u64> {
        // those that are waited for, the one that is asked first
        let mut waiting = vec![monomial];
        while let Some(now) = waiting.last().copied() {
            if self.known.contains_key(&now) {
                waiting.pop();
                continue;
            }
            if let Some(place) = self.place.get(&now) {
                let mut unit = vec![0; self.standard.len()];
                unit[*place] = self.field().one();
                self.known.insert(now, unit);
                continue;
            }
            let lead = self
                .basis
                .leads()
                .map(|(lead, _)| lead)
                .find(|lead| self.basis.monomials.divides(*lead, now));
            let Some(lead) = lead else {
                // no monomial is neither standard nor a multiple of a leading one
                self.known.insert(now, vec![0; self.standard.len()]);
                continue;
            };
            if lead == now {
                let row: Option<Row> =
                    self.basis.leads().find(|(other, _)| *other == lead).map(|(_, row)| row.clone());
                let Some(row) = row else { return vec![0; self.standard.len()] };
                let missing: Vec<u32> = row.monomials[1..]
                    .iter()
                    .copied()
                    .filter(|other| !self.known.contains_key(other))
                    .collect();
                if !missing.is_empty() {
                    waiting.extend(missing);
                    continue;
                }
                let field = self.field();
                let mut sum = vec![0; self.standard.len()];
                for (other, coefficient) in row.monomials.iter().zip(&row.coefficients).skip(1) {
                    field.subtract_multiple(&mut sum, *coefficient, &self.known[other]);
                }
                self.known.insert(now, sum);
                continue;
            }
            // a variable times a smaller monomial that is no standard one
            let (variable, smaller) = self.factor(now, lead);
            let Some(form) = self.known.get(&smaller).cloned() else {
                waiting.push(smaller);
                continue;
            };
            let mut missing = Vec::new();
            for (place, coefficient) in form.iter().enumerate() {
                if *coefficient != 0 {
                    let product = self.basis.monomials.product(self.standard[place], variable);
                    if !self.known.contains_key(&product) {
                        missing.push(product);
                    }
                }
            }
            if !missing.is_empty() {
                waiting.extend(missing);
                continue;
            }
            let image = self.combined(&form, variable);
            self.known.insert(now, image);
        }
        self.known[&monomial].clone()
    }

    /// `variable * form`, where the products with all standard monomials in it are known.
    fn combined(&mut self, form: &[u64], variable: u32) -> Vec<u64> {
        let field = self.field();
        let mut sum = vec![0; self.standard.len()];
        for (place, coefficient) in form.iter().enumerate() {
            if *coefficient != 0 {
                let product = self.basis.monomials.product(self.standard[place], variable);
                let minus = field.modulus() - coefficient;
                field.subtract_multiple(&mut sum, minus, &self.known[&product]);
            }
        }
        sum
    }

    /// A variable that divides a multiple of a leading monomial so that the rest still is one.
    fn factor(&mut self, monomial: u32, lead: u32) -> (u32, u32) {
        let powers = self.basis.monomials.powers(monomial).iter().zip(self.basis.monomials.powers(lead));
        let variable = powers.enumerate().find(|(_, (a, b))| a > b).map_or(0, |(variable, _)| variable);
        let single = self.basis.monomials.of(&[(variable, 1)]);
        (single, self.basis.monomials.quotient(monomial, single))
    }

    /// The function that is one everywhere.
    pub fn one(&self) -> Vec<u64> {
        let mut unit = vec![0; self.standard.len()];
        if let Some(first) = unit.first_mut() {
            *first = self.field().one();
        }
        unit
    }

    /// `polynomial * vector`
    pub fn apply(&mut self, polynomial: &[(Vec<(usize, u16)>, u64)], vector: &[u64]) -> Vec<u64> {
        let field = self.field();
        let mut sum = vec![0; self.standard.len()];
        for (monomial, coefficient) in polynomial {
            let mut image = vector.to_vec();
            for (variable, power) in monomial {
                let single = self.basis.monomials.of(&[(*variable, 1)]);
                for _ in 0..*power {
                    for (place, entry) in image.iter().enumerate() {
                        if *entry != 0 {
                            let product = self.basis.monomials.product(self.standard[place], single);
                            if !self.known.contains_key(&product) {
                                self.normal_form(product);
                            }
                        }
                    }
                    image = self.combined(&image, single);
                }
            }
            field.subtract_multiple(&mut sum, field.modulus() - coefficient, &image);
        }
        sum
    }

    /// The minimal polynomial of an element, constant first, the last coefficient one.
    pub fn minimal_polynomial(&mut self, polynomial: &[(Vec<(usize, u16)>, u64)]) -> Vec<u64> {
        let field = self.field();
        let size = self.standard.len();
        // each row: a combination of powers in echelon form, and which one it is
        let mut rows: Vec<(usize, Vec<u64>, Vec<u64>)> = Vec::new();
        let mut power = vec![0; size];
        let Some(first) = power.first_mut() else { return vec![field.one()] };
        *first = field.one();
        for k in 0..=size {
            let (mut rest, mut combination) = (power.clone(), vec![0; size + 1]);
            combination[k] = field.one();
            for (pivot, row, of_it) in &rows {
                let factor = rest[*pivot];
                field.subtract_multiple(&mut rest, factor, row);
                field.subtract_multiple(&mut combination, factor, of_it);
            }
            let Some(pivot) = rest.iter().position(|entry| *entry != 0) else {
                combination.truncate(k + 1);
                return combination;
            };
            let inverse = field.inverse(rest[pivot]).unwrap_or(field.one());
            for entry in rest.iter_mut().chain(&mut combination) {
                *entry = field.product(*entry, inverse);
            }
            rows.push((pivot, rest, combination));
            power = self.apply(polynomial, &power);
        }
        Vec::new()
    }
}

/// How many distinct roots a polynomial has over the algebraic closure.
pub(super) fn distinct_roots(field: &PrimeField, polynomial: &[u64]) -> usize {
    let one = field.one();
    let (mut slope, mut count) = (Vec::new(), 0);
    for coefficient in polynomial.iter().skip(1) {
        count = field.sum(count, one);
        slope.push(field.product(*coefficient, count));
    }
    let common = gcd(field, polynomial.to_vec(), slope);
    polynomial.len() - common.len().max(1)
}
