//! Groebner bases modulo a prime, by linear algebra on many pairs at once; monomials are compared by degree, then by the powers
//! of the last variables.
//!
//! References: J.-C. Faugere, *A new efficient algorithm for computing Groebner bases (F4)*, J. Pure Appl. Algebra 139 (1999);
//! R. Gebauer and H. M. Moeller, *On an installation of Buchberger's algorithm*, J. Symbolic Computation 6 (1988).

use super::monomials::Monomials;
use palmistry_budget as budget;
use palmistry_math::number::PrimeField;
use std::cell::Cell;
use std::collections::{BTreeMap, HashSet};

/// A polynomial whose leading coefficient is one: monomials from the greatest one down, and coefficients in Montgomery's form.
#[derive(Clone, Debug)]
pub(super) struct Row {
    pub monomials: Vec<u32>,
    pub coefficients: Vec<u64>,
}

/// Why there is no basis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Stop {
    /// It was interrupted, or its work is used up.
    TimeIsUp,
    /// A matrix of so many columns.
    TooWide(usize),
    /// A matrix with so many entries.
    TooFull(usize),
    /// The degree that was reached.
    DegreeTooHigh(u32),
}

/// How far one goes.
pub(super) struct Limits<'a> {
    pub columns: usize,
    /// Of one matrix, of what is found in it, and of the basis: so much each. A zero is no entry.
    pub entries: usize,
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

    /// The same for monomials that are looked up in the table: what that takes was measured to grow with the number of variables.
    fn spend_on_monomials(&self, count: usize, monomials: &Monomials) {
        self.spend(count as u64 * (8 + monomials.variables() as u64 / 2));
    }
}

/// A pair of elements of the basis, by their places.
#[derive(Clone, Copy, Debug)]
struct Pair {
    lcm: u32,
    degree: u32,
    /// Of the least common multiple.
    mask: u64,
    first: usize,
    second: usize,
}

/// No number of a monomial, of an element or of a column.
const NONE: u32 = u32::MAX;

/// What is known of the elements that divide a monomial.
#[derive(Clone, Copy, Debug)]
struct Divisor {
    /// The shortest of those that were looked at, or none.
    place: u32,
    /// So many elements were looked at.
    looked_at: u32,
}

/// The columns of one matrix as they are met; the table is as long as there are monomials, and used again.
#[derive(Default)]
struct Columns {
    met: Vec<u32>,
    /// Of each monomial: not met, met, met and with a row that begins with it; then its column.
    state: Vec<u32>,
}

const NOT_MET: u32 = NONE;
const MET: u32 = 0;
const HAS_ROW: u32 = 1;

impl Columns {
    fn make_room(&mut self, monomials: usize) {
        self.state.resize(monomials.max(self.state.len()), NOT_MET);
    }

    fn meet(&mut self, row: &Row) {
        for monomial in &row.monomials {
            let state = &mut self.state[*monomial as usize];
            if *state == NOT_MET {
                *state = MET;
                self.met.push(*monomial);
            }
        }
    }

    fn clear(&mut self) {
        for monomial in self.met.drain(..) {
            self.state[monomial as usize] = NOT_MET;
        }
    }
}

/// A basis as it grows.
pub(super) struct Basis {
    pub field: PrimeField,
    pub monomials: Monomials,
    elements: Vec<Row>,
    /// Those whose leading monomials no other one divides.
    active: Vec<bool>,
    /// Of each element the mask of its leading monomial.
    masks: Vec<u64>,
    /// By monomial.
    divisors: Vec<Divisor>,
    pairs: Vec<Pair>,
    columns: Columns,
}

impl Basis {
    /// The basis of the ideal of some rows; each is sorted, and monic or not.
    pub fn of(
        field: PrimeField,
        monomials: Monomials,
        rows: Vec<Row>,
        limits: &Limits,
    ) -> Result<Basis, Stop> {
        let mut basis = Basis {
            field,
            monomials,
            elements: Vec::new(),
            active: Vec::new(),
            masks: Vec::new(),
            divisors: Vec::new(),
            pairs: Vec::new(),
            columns: Columns::default(),
        };
        let mut held = 0;
        let mut waiting: BTreeMap<u32, Vec<Row>> = BTreeMap::new();
        for row in rows {
            if let Some(lead) = row.monomials.first() {
                waiting.entry(basis.monomials.degree(*lead)).or_default().push(row);
            }
        }
        loop {
            let of_pairs = basis.pairs.iter().map(|pair| pair.degree).min();
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
                limits.spend_on_monomials(basis.elements.len(), &basis.monomials);
                held += row.monomials.len();
                if held > limits.entries {
                    return Err(Stop::TooFull(held));
                }
                basis.insert(row);
                if (limits.is_over)() {
                    return Err(Stop::TimeIsUp);
                }
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
        let mut columns = std::mem::take(&mut self.columns);
        let found = self.reduced_in(&mut columns, degree, generators, limits);
        columns.clear();
        self.columns = columns;
        found
    }

    fn reduced_in(
        &mut self,
        columns: &mut Columns,
        degree: u32,
        generators: Vec<Row>,
        limits: &Limits,
    ) -> Result<Vec<Row>, Stop> {
        let (now, later): (Vec<Pair>, Vec<Pair>) = self.pairs.iter().partition(|pair| pair.degree == degree);
        self.pairs = later;
        let mut reducers: Vec<Row> = Vec::new();
        let mut rows: Vec<Row> = generators;
        for row in &rows {
            columns.make_room(self.monomials.len());
            columns.meet(row);
        }
        let mut taken: HashSet<(u32, usize)> = HashSet::new();
        for pair in now {
            for place in [pair.first, pair.second] {
                if !taken.insert((pair.lcm, place)) {
                    continue;
                }
                let row = self.multiple(place, pair.lcm, limits);
                columns.make_room(self.monomials.len());
                columns.meet(&row);
                let state = &mut columns.state[pair.lcm as usize];
                if *state == HAS_ROW {
                    rows.push(row);
                } else {
                    *state = HAS_ROW;
                    reducers.push(row);
                }
            }
        }
        let mut entries: usize = reducers.iter().chain(&rows).map(|row| row.monomials.len()).sum();
        // every monomial that an element divides is to be reduced
        let mut next = 0;
        while let Some(monomial) = columns.met.get(next).copied() {
            next += 1;
            if columns.met.len() > limits.columns {
                return Err(Stop::TooWide(columns.met.len()));
            }
            if entries > limits.entries {
                return Err(Stop::TooFull(entries));
            }
            if next % 256 == 0 && (limits.is_over)() {
                return Err(Stop::TimeIsUp);
            }
            if columns.state[monomial as usize] == HAS_ROW {
                continue;
            }
            if let Some(place) = self.divisor(monomial) {
                let row = self.multiple(place, monomial, limits);
                entries += row.monomials.len();
                columns.make_room(self.monomials.len());
                columns.meet(&row);
                columns.state[monomial as usize] = HAS_ROW;
                reducers.push(row);
            }
        }
        self.eliminated(columns, reducers, rows, limits)
    }

    /// Elimination with one dense row at a time.
    fn eliminated(
        &self,
        columns: &mut Columns,
        reducers: Vec<Row>,
        mut rows: Vec<Row>,
        limits: &Limits,
    ) -> Result<Vec<Row>, Stop> {
        let field = &self.field;
        let Columns { met: columns, state: place } = columns;
        columns.sort_unstable_by(|a, b| self.monomials.compare(*b, *a));
        for (monomial, column) in columns.iter().zip(0..) {
            place[*monomial as usize] = column;
        }
        let places = |row: &Row| row.monomials.iter().map(|monomial| place[*monomial as usize]).collect();
        let mut pivots: Vec<Option<(Vec<u32>, Vec<u64>)>> = vec![None; columns.len()];
        for row in reducers {
            let places: Vec<u32> = places(&row);
            let lead = places[0] as usize;
            pivots[lead] = Some((places, row.coefficients));
        }
        rows.sort_by(|a, b| self.monomials.compare(a.monomials[0], b.monomials[0]));
        let bound = u128::from(field.modulus()) << 64;
        let mut dense: Vec<u128> = vec![0; columns.len()];
        let (mut found, mut entries) = (Vec::new(), 0);
        for row in rows {
            if entries > limits.entries {
                return Err(Stop::TooFull(entries));
            }
            if (limits.is_over)() {
                return Err(Stop::TimeIsUp);
            }
            let first = place[row.monomials[0] as usize] as usize;
            for (monomial, coefficient) in row.monomials.iter().zip(&row.coefficients) {
                // as a product with one, in the form in which products are summed
                let column = place[*monomial as usize] as usize;
                dense[column] = u128::from(*coefficient) * u128::from(field.one());
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
            entries += kept.len();
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
        limits.spend_on_monomials(row.monomials.len(), &self.monomials);
        let factor = self.monomials.quotient(lead, row.monomials[0]);
        let monomials =
            row.monomials.iter().map(|monomial| self.monomials.product(*monomial, factor)).collect();
        Row { monomials, coefficients: row.coefficients.clone() }
    }

    /// An element whose leading monomial divides this one: the shortest.
    fn divisor(&mut self, monomial: u32) -> Option<usize> {
        let not_looked = Divisor { place: NONE, looked_at: 0 };
        if self.divisors.len() <= monomial as usize {
            self.divisors.resize(self.monomials.len(), not_looked);
        }
        let known = self.divisors[monomial as usize];
        // what divided it before it was superseded was so by an element that came later
        let mut best = Some(known.place as usize).filter(|place| known.place != NONE && self.active[*place]);
        let (absent, length) =
            (!self.monomials.mask(monomial), |place: usize| self.elements[place].monomials.len());
        for place in known.looked_at as usize..self.elements.len() {
            if self.masks[place] & absent == 0
                && self.active[place]
                && best.is_none_or(|best| length(place) < length(best))
                && self.monomials.divides(self.elements[place].monomials[0], monomial)
            {
                best = Some(place);
            }
        }
        self.divisors[monomial as usize] =
            Divisor { place: best.map_or(NONE, |place| place as u32), looked_at: self.elements.len() as u32 };
        best
    }

    /// One element more, with the pairs that have to be looked at (Gebauer and Moeller's criteria).
    fn insert(&mut self, row: Row) {
        let lead = row.monomials[0];
        let mask = self.monomials.mask(lead);
        // what was found in the same matrix may divide it by now: then the pair of the two is all that is needed of it
        let is_needed = self.divisor(lead).is_none();
        let new = self.elements.len();
        // by degree, so that what divides comes first; of equals a coprime one before others
        let mut fresh: Vec<(u32, u32, bool, usize)> = Vec::new();
        for place in 0..new {
            if self.active[place] {
                let other = self.elements[place].monomials[0];
                let has_common_factor = !self.monomials.are_coprime(lead, other);
                let lcm = self.monomials.lcm(lead, other);
                fresh.push((self.monomials.degree(lcm), lcm, has_common_factor, place));
            }
        }
        let (monomials, elements) = (&self.monomials, &self.elements);
        let with = |place: usize, lcm: u32| monomials.is_lcm(lead, elements[place].monomials[0], lcm);
        self.pairs.retain(|pair| {
            mask & !pair.mask != 0
                || !monomials.divides(lead, pair.lcm)
                || with(pair.first, pair.lcm)
                || with(pair.second, pair.lcm)
        });
        fresh.sort_unstable();
        let mut kept: Vec<(u32, u32, bool, usize)> = Vec::new();
        for pair in fresh {
            // a smaller one that divides it makes it superfluous
            if !kept.iter().any(|(_, other, ..)| self.monomials.divides(*other, pair.1)) {
                kept.push(pair);
            }
        }
        for (degree, lcm, has_common_factor, place) in kept {
            if has_common_factor {
                let mask = self.monomials.mask(lcm);
                self.pairs.push(Pair { lcm, degree, mask, first: place, second: new });
            }
        }
        for place in 0..new {
            if mask & !self.masks[place] == 0
                && self.active[place]
                && self.monomials.divides(lead, self.elements[place].monomials[0])
            {
                self.active[place] = false;
            }
        }
        self.elements.push(row);
        self.active.push(is_needed);
        self.masks.push(mask);
    }
}
