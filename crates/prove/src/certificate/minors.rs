//! The minors of rows of polynomials, as products of factors: each factor alone has narrower bounds than their product,
//! and depends on fewer coordinates.
//!
//! Rows are added one by one and reduced by those before them, without fractions; what the entries of a reduced row
//! have in common is taken out at once, so that nothing becomes longer than it has to be. A minor is then the product of
//! its pivots and of what was taken out, over what rows were multiplied by, which all but always cancels.

use super::common_denominator::CommonDenominatorRow;
use palmistry_math::expression::{Products, Variable};
use palmistry_math::number::polynomial::{Polynomial, Ring};
use palmistry_math::number::split;
use std::collections::{BTreeMap, HashMap};
use std::rc::Rc;

/// A minor that is not identically zero.
pub(super) struct SplitMinor {
    /// The rows, by their places.
    pub rows: Vec<usize>,
    /// Where none of [`SplitMinor::below`] is zero, the minor is zero where one of these is, and nowhere else.
    pub factors: Vec<Polynomial>,
    /// The places of the tangents of half angles whose cosines are factors too.
    pub half_cosines: Vec<usize>,
    /// What must not be zero for the rows to be defined, and for the factors to say what they say.
    pub below: Vec<Polynomial>,
}

/// What the minors of some rows are.
pub(super) struct Minors {
    pub found: Vec<SplitMinor>,
    /// Whether no minor was left out.
    pub complete: bool,
}

/// Polynomials of more monomials are not looked at.
const LONGEST: usize = 2_000;
/// Nor those that come of more products of monomials.
const MOST_PRODUCTS: usize = 60_000;
/// Minors with a factor of more monomials are left out: their bounds would be too wide to be of use.
const LONGEST_FACTOR: usize = 600;
/// No more minors are looked at.
const MOST: usize = 200;
/// The number of products of monomials after which no further minors are looked at: a few seconds.
const MOST_WORK: u64 = 16_000_000;

/// Powers of polynomials, negative ones too.
type Powers = BTreeMap<usize, i64>;

/// A row that others are reduced by.
struct Pivot {
    row: usize,
    column: usize,
    entries: Vec<Polynomial>,
    /// The pivot's factors, and those of the pivots before it, and all else that the minor is a product of.
    powers: Powers,
    /// The rows before it.
    before: Option<Rc<Pivot>>,
}

impl Pivot {
    /// Itself and the rows before it, in order.
    fn chain(this: &Option<Rc<Pivot>>) -> Vec<Rc<Pivot>> {
        let (mut found, mut at) = (Vec::new(), this.clone());
        while let Some(pivot) = at {
            at = pivot.before.clone();
            found.push(pivot);
        }
        found.reverse();
        found
    }
}

/// Adds rows to minors.
struct Builder<'a> {
    products: &'a Products,
    rows: &'a [CommonDenominatorRow],
    columns: usize,
    /// All factors that were met, by number.
    factors: Vec<Polynomial>,
    splits: HashMap<Polynomial, Vec<(usize, u32)>>,
    work: u64,
    found: Vec<SplitMinor>,
    complete: bool,
}

/// The minors of rows of `columns` entries, those of the first rows first, as far as they are not too long or too many.
/// `known` are factors that may be met, and receives those that were.
pub(super) fn minors(
    products: &Products,
    rows: &[CommonDenominatorRow],
    columns: usize,
    known: &mut Vec<Polynomial>,
) -> Minors {
    let mut builder = Builder {
        products,
        rows,
        columns,
        factors: known.clone(),
        splits: HashMap::new(),
        work: 0,
        found: Vec::new(),
        complete: true,
    };
    builder.build();
    *known = builder.factors;
    Minors { found: builder.found, complete: builder.complete }
}

/// The factors of a polynomial; those that are new are added to the known ones.
pub(super) fn factors_of(polynomial: &Polynomial, known: &mut Vec<Polynomial>) -> Vec<(Polynomial, u32)> {
    let found = split(polynomial, &known[..known.len().min(MOST_KNOWN)]).factors;
    for (factor, _) in &found {
        if !known.contains(factor) {
            known.push(factor.clone());
        }
    }
    found
}

/// So many factors that were met before are tried.
const MOST_KNOWN: usize = 48;

/// How often the cosine of half of each angle is a factor beside those in the tangent, which forms of degree `d` in the
/// half angle stand for: by the places of the tangents. Negative where it is a divisor.
pub(super) fn half_cosines<'a>(
    products: &Products,
    above: impl IntoIterator<Item = (&'a Polynomial, i64)>,
) -> Vec<(usize, i64)> {
    let is_tangent = |place: &usize| matches!(products.variables()[*place], Variable::HalfTangent(_));
    let mut surplus: Vec<(usize, i64)> =
        (0..products.variables().len()).filter(is_tangent).map(|place| (place, 0)).collect();
    for (polynomial, power) in above {
        for (place, sum) in &mut surplus {
            *sum -= power * i64::from(polynomial.degree_in(*place));
        }
    }
    surplus
}

impl Builder<'_> {
    /// The factors of a polynomial, by number.
    fn split(&mut self, polynomial: &Polynomial) -> Vec<(usize, u32)> {
        if let Some(known) = self.splits.get(polynomial) {
            return known.clone();
        }
        self.work += (polynomial.len() * MOST_KNOWN) as u64;
        let found = factors_of(polynomial, &mut self.factors);
        let number = |factor: &Polynomial| self.factors.iter().position(|known| known == factor);
        let numbered: Vec<(usize, u32)> =
            found.iter().filter_map(|(factor, power)| Some((number(factor)?, *power))).collect();
        self.splits.insert(polynomial.clone(), numbered.clone());
        numbered
    }

    fn count(&mut self, powers: &mut Powers, polynomial: &Polynomial, sign: i64) {
        for (factor, power) in self.split(polynomial) {
            *powers.entry(factor).or_insert(0) += sign * i64::from(power);
        }
        powers.retain(|_, power| *power != 0);
    }

    /// Adds each row to all sets of rows before it.
    fn build(&mut self) {
        // sets of independent rows, by their number
        let mut sets: Vec<Vec<Option<Rc<Pivot>>>> = vec![Vec::new(); self.columns + 1];
        sets[0].push(None);
        if self.columns == 0 {
            self.finish(&[], &Powers::new());
        }
        for row in 0..self.rows.len() {
            for size in (0..self.columns).rev() {
                for at in 0..sets[size].len() {
                    if self.work > MOST_WORK || self.found.len() >= MOST {
                        self.complete = false;
                        return;
                    }
                    let before = sets[size][at].clone();
                    let Some(pivot) = self.add_row(row, before) else { continue };
                    if size + 1 == self.columns {
                        let powers = pivot.powers.clone();
                        self.finish(&Pivot::chain(&Some(Rc::new(pivot))), &powers);
                    } else {
                        sets[size + 1].push(Some(Rc::new(pivot)));
                    }
                }
            }
        }
    }

    /// A row added to others; `None` where it depends on them, or becomes too long.
    fn add_row(&mut self, row: usize, before: Option<Rc<Pivot>>) -> Option<Pivot> {
        let mut powers = before.as_ref().map(|pivot| pivot.powers.clone()).unwrap_or_default();
        let Some(entries) = self.reduce(row, &Pivot::chain(&before), &mut powers) else {
            self.complete = false;
            return None;
        };
        // the shortest entry is the pivot
        let filled = (0..self.columns).filter(|column| !entries[*column].is_zero());
        let column = filled.min_by_key(|column| entries[*column].len())?;
        self.count(&mut powers, &entries[column].clone(), 1);
        Some(Pivot { row, column, entries, powers, before })
    }

    /// A row without what the pivots have; `None` where it becomes too long.
    fn reduce(&mut self, row: usize, pivots: &[Rc<Pivot>], powers: &mut Powers) -> Option<Vec<Polynomial>> {
        let mut entries = self.rows[row].entries.clone();
        for pivot in pivots {
            let (mut a, mut p) = (entries[pivot.column].clone(), pivot.entries[pivot.column].clone());
            if a.is_zero() {
                continue;
            }
            // what both have in common need not be multiplied by
            for (factor, power) in self.split(&p) {
                let factor = self.factors[factor].clone();
                for _ in 0..power {
                    if let (Some(less_a), Some(less_p)) =
                        (a.divide_exactly(&factor), p.divide_exactly(&factor))
                    {
                        (a, p) = (less_a, less_p);
                    }
                }
            }
            for (column, entry) in entries.iter_mut().enumerate() {
                let other = &pivot.entries[column];
                let products = entry.len() * p.len() + other.len() * a.len();
                if products > MOST_PRODUCTS {
                    return None;
                }
                self.work += products as u64;
                *entry = entry.mul(&p)?.add(&other.mul(&a)?.neg());
                if entry.len() > LONGEST {
                    return None;
                }
            }
            self.count(powers, &p, -1);
            self.take_out_common(&mut entries, powers)?;
        }
        Some(entries)
    }

    /// Divides a row by what its entries have in common.
    fn take_out_common(&mut self, entries: &mut [Polynomial], powers: &mut Powers) -> Option<()> {
        let filled = |entries: &[Polynomial]| -> Vec<usize> {
            (0..entries.len()).filter(|column| !entries[*column].is_zero()).collect()
        };
        let columns = filled(entries);
        let Some(shortest) = columns.iter().copied().min_by_key(|column| entries[*column].len()) else {
            return Some(());
        };
        for (factor, power) in self.split(&entries[shortest].clone()) {
            let polynomial = self.factors[factor].clone();
            for _ in 0..power {
                self.work += columns.iter().map(|column| entries[*column].len() as u64).sum::<u64>();
                let quotients: Option<Vec<Polynomial>> =
                    columns.iter().map(|column| entries[*column].divide_exactly(&polynomial)).collect();
                let Some(quotients) = quotients else { break };
                for (column, quotient) in columns.iter().zip(quotients) {
                    entries[*column] = quotient;
                }
                *powers.entry(factor).or_insert(0) += 1;
            }
        }
        powers.retain(|_, power| *power != 0);
        Some(())
    }

    /// Notes the minor of the rows that are there.
    fn finish(&mut self, pivots: &[Rc<Pivot>], powers: &Powers) {
        let rows: Vec<usize> = pivots.iter().map(|pivot| pivot.row).collect();
        let (mut total, mut below) = (powers.clone(), Powers::new());
        for (factor, power) in powers.iter().filter(|(_, power)| **power < 0) {
            below.insert(*factor, -power);
        }
        for row in &rows {
            for (factors, sign) in [(&self.rows[*row].above, 1), (&self.rows[*row].below, -1)] {
                for (place, power) in factors {
                    let polynomial = self.products.fractions().factor(*place);
                    for (factor, inner) in self.split(&polynomial) {
                        let power = i64::from(*power) * i64::from(inner);
                        *total.entry(factor).or_insert(0) += sign * power;
                        if sign < 0 {
                            *below.entry(factor).or_insert(0) += power;
                        }
                    }
                }
            }
        }
        let surplus = half_cosines(self.products, total.iter().map(|(f, n)| (&self.factors[*f], *n)));
        let circles = self.products.circles();
        let list = |numbers: &mut dyn Iterator<Item = usize>| -> Vec<Polynomial> {
            numbers.map(|factor| self.factors[factor].clone()).filter(|f| !circles.contains(f)).collect()
        };
        let is_above =
            |(factor, power): (&usize, &i64)| (*power > 0 && !below.contains_key(factor)).then_some(*factor);
        if total.keys().any(|factor| self.factors[*factor].len() > LONGEST_FACTOR) {
            self.complete = false;
            return;
        }
        self.found.push(SplitMinor {
            rows,
            factors: list(&mut total.iter().filter_map(is_above)),
            half_cosines: surplus.iter().filter(|(_, n)| *n > 0).map(|(place, _)| *place).collect(),
            below: list(&mut below.keys().copied()),
        });
    }
}
