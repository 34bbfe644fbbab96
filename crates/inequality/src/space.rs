//! All ways to write a polynomial as a sum of given products, each so many times: a space of solutions of linear equations.

use dashu::rational::RBig;
use palmistry_math::number::polynomial::{Exponents, Polynomial};
use std::collections::{BTreeMap, BTreeSet};

/// Coefficients, by place.
type Row = Vec<(usize, RBig)>;

/// The entries for which `sum u_k products[k]` is the polynomial: some free, the others by these.
pub struct Space {
    count: usize,
    pub free: Vec<usize>,
    /// For each entry that is not free: the entry, its constant, and the coefficients of free ones (by place in `free`).
    bound: Vec<(usize, RBig, Row)>,
}

impl Space {
    pub fn new(polynomial: &Polynomial, products: &[Polynomial]) -> Option<Space> {
        let mut rows: BTreeMap<Exponents, (BTreeMap<usize, RBig>, RBig)> = BTreeMap::new();
        for (exponents, coefficient) in polynomial.terms() {
            rows.entry(*exponents).or_default().1 = RBig::from(coefficient.clone());
        }
        for (place, product) in products.iter().enumerate() {
            for (exponents, coefficient) in product.terms() {
                rows.entry(*exponents).or_default().0.insert(place, RBig::from(coefficient.clone()));
            }
        }
        // elimination; each row is solved for the unknown that the fewest rows mention
        let mut solved: Vec<(usize, BTreeMap<usize, RBig>, RBig)> = Vec::new();
        for (mut row, mut right) in rows.into_values() {
            for (pivot, known, value) in &solved {
                if let Some(factor) = row.remove(pivot) {
                    right -= &factor * value;
                    subtract(&mut row, known, &factor);
                }
            }
            let Some(pivot) = row.keys().next_back().copied() else {
                if right.is_zero() {
                    continue;
                }
                return None; // a monomial that no product has
            };
            let lead = row.remove(&pivot)?;
            row.values_mut().for_each(|value| *value /= &lead);
            right /= &lead;
            for (_, known, value) in &mut solved {
                if let Some(factor) = known.remove(&pivot) {
                    *value -= &factor * &right;
                    subtract(known, &row, &factor);
                }
            }
            solved.push((pivot, row, right));
        }
        let pivots: BTreeSet<usize> = solved.iter().map(|(pivot, ..)| *pivot).collect();
        let free: Vec<usize> = (0..products.len()).filter(|place| !pivots.contains(place)).collect();
        let place: BTreeMap<usize, usize> = free.iter().enumerate().map(|(i, k)| (*k, i)).collect();
        let bound = solved.into_iter().map(|(pivot, row, right)| {
            (pivot, right, row.into_iter().map(|(k, value)| (place[&k], -value)).collect())
        });
        Some(Space { count: products.len(), bound: bound.collect(), free })
    }

    /// All entries, from the free ones.
    pub fn fill(&self, free: &[RBig]) -> Vec<RBig> {
        let mut all = vec![RBig::ZERO; self.count];
        for (place, value) in self.free.iter().zip(free) {
            all[*place] = value.clone();
        }
        for (place, constant, row) in &self.bound {
            let sum = row.iter().fold(constant.clone(), |sum, (k, c)| sum + c * &free[*k]);
            all[*place] = sum;
        }
        all
    }

    /// The entries where all free ones are zero, and what each free one adds.
    pub fn as_doubles(&self) -> (Vec<f64>, Vec<Vec<(usize, f64)>>) {
        let mut start = vec![0.0; self.count];
        let mut directions: Vec<Vec<(usize, f64)>> =
            self.free.iter().map(|place| vec![(*place, 1.0)]).collect();
        for (place, constant, row) in &self.bound {
            start[*place] = constant.to_f64().value();
            for (k, value) in row {
                directions[*k].push((*place, value.to_f64().value()));
            }
        }
        (start, directions)
    }
}

fn subtract(from: &mut BTreeMap<usize, RBig>, what: &BTreeMap<usize, RBig>, factor: &RBig) {
    for (place, value) in what {
        let entry = from.entry(*place).or_insert(RBig::ZERO);
        *entry -= factor * value;
        if entry.is_zero() {
            from.remove(place);
        }
    }
}
