//! Groebner bases modulo a prime, by linear algebra on many pairs at once; monomials are compared by degree, then by the powers
//! of the last variables.
//!
//! References: J.-C. Faugere, *A new efficient algorithm for computing Groebner bases (F4)*, J. Pure Appl. Algebra 139 (1999);
//! R. Gebauer and H. M. Moeller, *On an installation of Buchberger's algorithm*, J. Symbolic Computation 6 (1988).

use super::monomials::Monomials;
use palmistry_budget as budget;
use palmistry_math::number::PrimeField;
use std::cell::Cell;
use std::collections::{BTreeMap, HashMap, HashSet};

/// A polynomial whose leading coefficient is one: monomials from the greatest one down, and coefficients in Montgomery's form.
#[derive(Clone, Debug)]
pub(super) struct Row {
    pub monomials: Vec<u32>,
    pub coefficients: Vec<u64>,
}

/// Why there is no basis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Stop {
    /// Whoever waits does so no longer.
    TimeIsUp,
    /// A matrix of so many columns.
    TooWide(usize),
    /// The degree that was reached.
    DegreeTooHigh(u32),
}

/// How far one goes.
pub(super) struct Limits<'a> {
    pub columns: usize,
    pub degree: u32,
    /// Products of residues that were done so far.
    pub work: &'a Cell<u64>,
    pub is_over: &'a dyn Fn() -> bool,
}

impl Limits<'_> {
    /// Products of residues that are about to be done, or were just done.
    fn spend(&self, products: u64) {
        self.work.set(self.work.get() + products);
        budget::steps(products as usize);
    }
}

/// What it costs to find a monomial, in products of residues.
const LOOK_UP: u64 = 16;

/// A pair of elements of the basis, by their places.
#[derive(Clone, Copy, Debug)]
struct Pair {
    lcm: u32,
    first: usize,
    second: usize,
}

/// A basis as it grows.
pub(super) struct Basis {
    pub field: PrimeField,
    pub monomials: Monomials,
    elements: Vec<Row>,
    /// Those whose leading monomials no other one divides.
    active: Vec<bool>,
    pairs: Vec<Pair>,
}

impl Basis {
    /// The basis of the ideal of some rows; each is sorted, and monic or not.
    pub fn of(
        field: PrimeField,
        monomials: Monomials,
        rows: Vec<Row>,
        limits: &Limits,
    ) -> Result<Basis, Stop> {
        let mut basis =
            Basis { field, monomials, elements: Vec::new(), active: Vec::new(), pairs: Vec::new() };
        let mut waiting: BTreeMap<u32, Vec<Row>> = BTreeMap::new();
        for row in rows {
            if let Some(lead) = row.monomials.first() {
                waiting.entry(basis.monomials.degree(*lead)).or_default().push(row);
            }
        }
        loop {
            let of_pairs = basis.pairs.iter().map(|pair| basis.monomials.degree(pair.lcm)).min();
            let of_rows = waiting.keys().next().copied();
            let Some(degree) = of_pairs.into_iter().chain(of_rows).min() else { return Ok(basis) };
            if degree > limits.degree {
                return Err(Stop::DegreeTooHigh(degree));
            }
            if (limits.is_over)() {
                return Err(Stop::TimeIsUp);
            }
            let generators = if of_rows == Some(degree) { waiting.remove(&degree) } else { None };
            let found = basis.reduced(degree, generators.unwrap_or_default(), limits)?;
            for row in found {
                basis.insert(row);
            }
            if basis.is_everything() {
                return Ok(basis);
            }
        }
    }

    /// Whether one lies in the ideal.
    pub fn is_everything(&self) -> bool {
        self.leads().any(|(lead, _)| self.monomials.degree(lead) == 0)
    }

    /// Leading monomials and the elements that have them, of a minimal basis.
    pub fn leads(&self) -> impl Iterator<Item = (u32, &Row)> {
        let active = self.elements.iter().zip(&self.active).filter(|(_, active)| **active);
        active.map(|(row, _)| (row.monomials[0], row))
    }

    /// The rows of one matrix, reduced: those whose leading monomials are new.
    fn reduced(&mut self, degree: u32, generators: Vec<Row>, limits: &Limits) -> Result<Vec<Row>, Stop> {
        let (now, later): (Vec<Pair>, Vec<Pair>) =
            self.pairs.iter().partition(|pair| self.monomials.degree(pair.lcm) == degree);
        self.pairs = later;
        let mut reducers: Vec<Row> = Vec::new();
        let mut has_reducer: HashSet<u32> = HashSet::new();
        let mut rows: Vec<Row> = generators;
        let mut taken: HashSet<(u32, usize)> = HashSet::new();
        for pair in now {
            for place in [pair.first, pair.second] {
                if !taken.insert((pair.lcm, place)) {
                    continue;
                }
                let row = self.multiple(place, pair.lcm, limits);
                if has_reducer.insert(pair.lcm) { reducers.push(row) } else { rows.push(row) }
            }
        }
        // every monomial that an element divides is to be reduced
        let mut met: HashSet<u32> = HashSet::new();
        let mut waiting: Vec<u32> = Vec::new();
        let meet = |met: &mut HashSet<u32>, waiting: &mut Vec<u32>, row: &Row| {
            waiting.extend(row.monomials.iter().copied().filter(|monomial| met.insert(*monomial)));
        };
        for row in reducers.iter().chain(&rows) {
            meet(&mut met, &mut waiting, row);
        }
        while let Some(monomial) = waiting.pop() {
            if met.len() > limits.columns {
                return Err(Stop::TooWide(met.len()));
            }
            if (limits.is_over)() {
                return Err(Stop::TimeIsUp);
            }
            if has_reducer.contains(&monomial) {
                continue;
            }
            if let Some(place) = self.divisor(monomial) {
                let row = self.multiple(place, monomial, limits);
                meet(&mut met, &mut waiting, &row);
                has_reducer.insert(monomial);
                reducers.push(row);
            }
        }
        self.eliminated(met, &reducers, rows, limits)
    }

    /// Elimination with one dense row at a time.
    fn eliminated(
        &self,
        met: HashSet<u32>,
        reducers: &[Row],
        mut rows: Vec<Row>,
        limits: &Limits,
    ) -> Result<Vec<Row>, Stop> {
        let field = &self.field;
        let mut columns: Vec<u32> = met.into_iter().collect();
        columns.sort_by(|a, b| self.monomials.compare(*b, *a));
        let place: HashMap<u32, u32> =
            columns.iter().zip(0..).map(|(monomial, place)| (*monomial, place)).collect();
        let placed = |row: &Row| -> (Vec<u32>, Vec<u64>) {
            (row.monomials.iter().map(|monomial| place[monomial]).collect(), row.coefficients.clone())
        };
        let mut pivots: Vec<Option<(Vec<u32>, Vec<u64>)>> = vec![None; columns.len()];
        for row in reducers {
            let row = placed(row);
            let lead = row.0[0] as usize;
            pivots[lead] = Some(row);
        }
        rows.sort_by(|a, b| self.monomials.compare(a.monomials[0], b.monomials[0]));
        let bound = u128::from(field.modulus()) << 64;
        let mut dense: Vec<u128> = vec![0; columns.len()];
        let mut found = Vec::new();
        for row in rows {
            if (limits.is_over)() {
                return Err(Stop::TimeIsUp);
            }
            let (places, coefficients) = placed(&row);
            let first = places[0] as usize;
            for (place, coefficient) in places.iter().zip(coefficients) {
                // as a product with one, in the form in which products are summed
                dense[*place as usize] = u128::from(coefficient) * u128::from(field.one());
            }
            let (mut kept_places, mut kept) = (Vec::new(), Vec::new());
            let mut work = columns.len() as u64 / 4;
            for column in first..columns.len() {
                if dense[column] == 0 {
                    continue;
                }
                let value = field.reduced(dense[column]);
                dense[column] = 0;
                if value == 0 {
                    continue;
                }
                match &pivots[column] {
                    None => {
                        kept_places.push(column as u32);
                        kept.push(value);
                    }
                    Some((places, coefficients)) => {
                        let factor = u128::from(field.modulus() - value);
                        work += places.len() as u64;
                        for (place, coefficient) in places.iter().zip(coefficients).skip(1) {
                            let entry = &mut dense[*place as usize];
                            *entry += factor * u128::from(*coefficient);
                            if *entry >= bound {
                                *entry -= bound;
                            }
                        }
                    }
                }
            }
            limits.spend(work);
            let Some(inverse) = kept.first().and_then(|lead| field.inverse(*lead)) else { continue };
            for value in &mut kept {
                *value = field.product(*value, inverse);
            }
            let monomials = kept_places.iter().map(|place| columns[*place as usize]).collect();
            found.push(Row { monomials, coefficients: kept.clone() });
            let lead = kept_places[0] as usize;
            pivots[lead] = Some((kept_places, kept));
        }
        found.sort_by(|a, b| self.monomials.compare(a.monomials[0], b.monomials[0]));
        Ok(found)
    }

    /// An element times what its leading monomial lacks.
    fn multiple(&mut self, place: usize, lead: u32, limits: &Limits) -> Row {
        let row = &self.elements[place];
        // to find a monomial in the table takes as long as some products
        limits.spend(LOOK_UP * row.monomials.len() as u64);
        let factor = self.monomials.quotient(lead, row.monomials[0]);
        let monomials =
            row.monomials.iter().map(|monomial| self.monomials.product(*monomial, factor)).collect();
        Row { monomials, coefficients: row.coefficients.clone() }
    }

    /// An element whose leading monomial divides this one: the shortest.
    fn divisor(&self, monomial: u32) -> Option<usize> {
        let divides = |place: &usize| {
            self.active[*place] && self.monomials.divides(self.elements[*place].monomials[0], monomial)
        };
        (0..self.elements.len()).filter(divides).min_by_key(|place| self.elements[*place].monomials.len())
    }

    /// One element more, with the pairs that have to be looked at (Gebauer and Moeller's criteria).
    fn insert(&mut self, row: Row) {
        let lead = row.monomials[0];
        // what was found in the same matrix may divide it by now: then the pair of the two is all that is needed of it
        let is_needed = self.divisor(lead).is_none();
        let new = self.elements.len();
        let mut fresh: Vec<(u32, usize, bool)> = Vec::new();
        for place in 0..new {
            if self.active[place] {
                let other = self.elements[place].monomials[0];
                let coprime = self.monomials.are_coprime(lead, other);
                fresh.push((self.monomials.lcm(lead, other), place, coprime));
            }
        }
        let mut kept_pairs = Vec::new();
        for pair in std::mem::take(&mut self.pairs) {
            let with = |monomials: &mut Monomials, place: usize| {
                monomials.lcm(lead, self.elements[place].monomials[0]) == pair.lcm
            };
            let is_needed = !self.monomials.divides(lead, pair.lcm)
                || with(&mut self.monomials, pair.first)
                || with(&mut self.monomials, pair.second);
            if is_needed {
                kept_pairs.push(pair);
            }
        }
        fresh.sort_by(|a, b| self.monomials.compare(a.0, b.0).then(b.2.cmp(&a.2)));
        let mut kept: Vec<(u32, usize, bool)> = Vec::new();
        for (lcm, place, coprime) in fresh {
            // a smaller one that divides it makes it superfluous; of equals the first, a coprime one before others
            if !kept.iter().any(|(other, ..)| self.monomials.divides(*other, lcm)) {
                kept.push((lcm, place, coprime));
            }
        }
        let needed = kept.into_iter().filter(|(_, _, coprime)| !coprime);
        kept_pairs.extend(needed.map(|(lcm, place, _)| Pair { lcm, first: place, second: new }));
        self.pairs = kept_pairs;
        for place in 0..new {
            if self.active[place] && self.monomials.divides(lead, self.elements[place].monomials[0]) {
                self.active[place] = false;
            }
        }
        self.elements.push(row);
        self.active.push(is_needed);
    }
}
