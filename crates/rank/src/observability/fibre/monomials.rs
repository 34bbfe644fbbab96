//! Monomials in a table: each has a number, and one is stored once.

use std::cmp::Ordering;
use std::collections::HashMap;

/// All monomials that were met, by their numbers; the first one is one.
pub(super) struct Monomials {
    weights: Vec<u32>,
    variables: usize,
    powers: Vec<u16>,
    degrees: Vec<u32>,
    /// Of each some variables that are in it, by bits.
    masks: Vec<u64>,
    numbers: HashMap<Box<[u16]>, u32>,
    scratch: Vec<u16>,
}

impl Monomials {
    /// Monomials in so many variables as there are weights: a degree is a sum of these.
    pub fn new(weights: Vec<u32>) -> Monomials {
        let variables = weights.len();
        let mut table = Monomials {
            weights,
            variables,
            powers: Vec::new(),
            degrees: Vec::new(),
            masks: Vec::new(),
            numbers: HashMap::new(),
            scratch: vec![0; variables],
        };
        table.number();
        table
    }

    pub fn variables(&self) -> usize {
        self.variables
    }

    pub fn powers(&self, monomial: u32) -> &[u16] {
        let begin = monomial as usize * self.variables;
        &self.powers[begin..begin + self.variables]
    }

    pub fn degree(&self, monomial: u32) -> u32 {
        self.degrees[monomial as usize]
    }

    /// The number of what stands in the scratch space.
    fn number(&mut self) -> u32 {
        if let Some(known) = self.numbers.get(self.scratch.as_slice()) {
            return *known;
        }
        let number = self.degrees.len() as u32;
        self.powers.extend_from_slice(&self.scratch);
        let weighted =
            self.scratch.iter().zip(&self.weights).map(|(power, weight)| u32::from(*power) * weight);
        self.degrees.push(weighted.sum());
        let bits = self.scratch.iter().enumerate().filter(|(_, power)| **power > 0);
        self.masks.push(bits.fold(0, |mask, (variable, _)| mask | 1 << (variable % 64)));
        self.numbers.insert(self.scratch.clone().into_boxed_slice(), number);
        number
    }

    fn build(&mut self, a: u32, b: u32, combine: impl Fn(u16, u16) -> u16) -> u32 {
        let (a, b) = (a as usize * self.variables, b as usize * self.variables);
        for k in 0..self.variables {
            self.scratch[k] = combine(self.powers[a + k], self.powers[b + k]);
        }
        self.number()
    }

    /// The monomial with these powers.
    pub fn of(&mut self, powers: &[(usize, u16)]) -> u32 {
        self.scratch.fill(0);
        for (variable, power) in powers {
            self.scratch[*variable] = *power;
        }
        self.number()
    }

    /// The product; powers stay far below what they can be, since degrees are limited.
    pub fn product(&mut self, a: u32, b: u32) -> u32 {
        self.build(a, b, |a, b| a.saturating_add(b))
    }

    /// Where `b` divides `a`.
    pub fn quotient(&mut self, a: u32, b: u32) -> u32 {
        self.build(a, b, |a, b| a.saturating_sub(b))
    }

    pub fn lcm(&mut self, a: u32, b: u32) -> u32 {
        self.build(a, b, u16::max)
    }

    pub fn divides(&self, a: u32, b: u32) -> bool {
        self.masks[a as usize] & !self.masks[b as usize] == 0
            && self.powers(a).iter().zip(self.powers(b)).all(|(a, b)| a <= b)
    }

    pub fn are_coprime(&self, a: u32, b: u32) -> bool {
        self.powers(a).iter().zip(self.powers(b)).all(|(a, b)| *a == 0 || *b == 0)
    }

    /// By degree, then the one with the lower power of the last variable in which they differ is the greater one.
    pub fn compare(&self, a: u32, b: u32) -> Ordering {
        let by_degree = self.degree(a).cmp(&self.degree(b));
        by_degree.then_with(|| self.powers(b).iter().rev().cmp(self.powers(a).iter().rev()))
    }
}
