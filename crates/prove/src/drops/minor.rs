//! A determinant of polynomials as a product of factors, without multiplying it out.

use super::factors::factors;
use dashu::integer::IBig;
use dashu::rational::RBig;
use palmistry_math::number::polynomial::{Polynomial, Ring};
use palmistry_math::number::split;

/// A number times powers of factors, negative powers among them.
#[derive(Clone, Debug)]
pub(super) struct Product {
    pub unit: RBig,
    pub powers: Vec<(Polynomial, i64)>,
}

impl Default for Product {
    fn default() -> Self {
        Product { unit: RBig::ONE, powers: Vec::new() }
    }
}

/// Longer entries are not reduced any further.
const LONGEST: usize = 1_500;
/// Nor are those that come of more products of monomials.
const MOST_PRODUCTS: usize = 60_000;
/// So many factors that were met before are tried.
const MOST_KNOWN: usize = 40;

impl Product {
    pub fn is_zero(&self) -> bool {
        self.unit.is_zero()
    }

    /// Multiplies by a power of a polynomial.
    pub fn times(&mut self, polynomial: &Polynomial, power: i64, known: &mut Vec<Polynomial>) {
        if power == 0 || self.is_zero() {
            return;
        }
        if polynomial.is_zero() {
            self.unit = RBig::ZERO;
            return;
        }
        let recent = known.len().saturating_sub(MOST_KNOWN);
        let content = polynomial.content();
        let content = RBig::from(content);
        let one = if power < 0 { RBig::ONE / content } else { content };
        for _ in 0..power.unsigned_abs() {
            self.unit *= &one;
        }
        for (factor, n) in factors(polynomial, &known[recent..]) {
            if factor.len() > 1 && !known.contains(&factor) {
                known.push(factor.clone());
            }
            match self.powers.iter_mut().find(|(other, _)| *other == factor) {
                Some((_, m)) => *m += power * i64::from(n),
                None => self.powers.push((factor, power * i64::from(n))),
            }
        }
        self.powers.retain(|(_, n)| *n != 0);
    }

    /// The total length, by which products are compared.
    pub fn length(&self) -> usize {
        self.powers.iter().map(|(factor, _)| factor.len()).sum()
    }
}

/// The determinant of a square matrix, by elimination without fractions; what a row or a column has in common is taken out
/// at once. `None` where it becomes too long.
pub(super) fn determinant(mut rows: Vec<Vec<Polynomial>>, known: &mut Vec<Polynomial>) -> Option<Product> {
    let mut found = Product::default();
    while !rows.is_empty() {
        for row in &mut rows {
            take_out(row, &mut found, known)?;
        }
        for column in 0..rows.len() {
            let mut entries: Vec<Polynomial> = rows.iter().map(|row| row[column].clone()).collect();
            take_out(&mut entries, &mut found, known)?;
            rows.iter_mut().zip(entries).for_each(|(row, entry)| row[column] = entry);
        }
        if found.is_zero() {
            return Some(found);
        }
        let (at, column) = pivot(&rows)?;
        let pivot_row = rows.remove(at);
        if (at + column) % 2 == 1 {
            found.unit = -found.unit;
        }
        let head = &pivot_row[column];
        found.times(head, 1, known);
        for row in rows.iter_mut().filter(|row| !row[column].is_zero()) {
            let (a, p) = without_common(&row[column], head, known);
            for (other, entry) in row.iter_mut().enumerate().filter(|(other, _)| *other != column) {
                let products = entry.len() * p.len() + pivot_row[other].len() * a.len();
                if products > MOST_PRODUCTS {
                    return None;
                }
                *entry = entry.mul(&p)?.add(&pivot_row[other].mul(&a)?.neg());
                if entry.len() > LONGEST {
                    return None;
                }
            }
            found.times(&p, -1, known);
        }
        for row in &mut rows {
            row.remove(column);
        }
    }
    Some(found)
}

/// The place with the fewest entries beside and above it, then the shortest.
fn pivot(rows: &[Vec<Polynomial>]) -> Option<(usize, usize)> {
    let filled = |row: &Vec<Polynomial>| row.iter().filter(|entry| !entry.is_zero()).count();
    let in_column =
        |column: usize| rows.iter().filter(|row| !row[column].is_zero()).count().saturating_sub(1);
    let places = rows.iter().enumerate().flat_map(|(at, row)| {
        let beside = filled(row).saturating_sub(1);
        row.iter()
            .enumerate()
            .filter(|(_, entry)| !entry.is_zero())
            .map(move |(column, entry)| (beside, entry.len(), (at, column)))
    });
    places.min_by_key(|(beside, length, place)| (beside * in_column(place.1), *length)).map(|found| found.2)
}

/// Divides entries by what all of them have in common.
fn take_out(entries: &mut [Polynomial], found: &mut Product, known: &mut Vec<Polynomial>) -> Option<()> {
    let shortest = entries.iter().filter(|entry| !entry.is_zero()).min_by_key(|entry| entry.len());
    let Some(shortest) = shortest.cloned() else {
        found.unit = RBig::ZERO;
        return Some(());
    };
    let recent = known.len().saturating_sub(MOST_KNOWN);
    let number = entries.iter().filter(|entry| !entry.is_zero()).fold(IBig::ZERO, |common, entry| {
        use dashu::base::Gcd;
        let content = entry.content();
        if common.is_zero() { content } else { IBig::from(common.gcd(content)) }
    });
    let number = Polynomial::integer(&number);
    let others = split(&shortest, &known[recent..]).factors;
    for (factor, power) in std::iter::once((number, 1)).chain(others) {
        for _ in 0..power {
            let quotients: Option<Vec<Polynomial>> =
                entries.iter().map(|entry| entry.divide_exactly(&factor)).collect();
            let Some(quotients) = quotients else { break };
            entries.clone_from_slice(&quotients);
            found.times(&factor, 1, known);
        }
    }
    Some(())
}

/// Two polynomials without what both have in common, as far as that is found.
fn without_common(a: &Polynomial, p: &Polynomial, known: &[Polynomial]) -> (Polynomial, Polynomial) {
    let (mut a, mut p) = (a.clone(), p.clone());
    let recent = known.len().saturating_sub(MOST_KNOWN);
    for (factor, power) in split(&p.clone(), &known[recent..]).factors {
        for _ in 0..power {
            if let (Some(less_a), Some(less_p)) = (a.divide_exactly(&factor), p.divide_exactly(&factor)) {
                (a, p) = (less_a, less_p);
            }
        }
    }
    (a, p)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn x(place: usize) -> Polynomial {
        Polynomial::variable(place)
    }

    /// Vandermonde: `(y - x)(z - x)(z - y)`.
    #[test]
    fn vandermonde_has_three_factors() {
        let one = Polynomial::integer(&IBig::ONE);
        let rows = (0..3).map(|i| vec![one.clone(), x(i), x(i).mul(&x(i)).unwrap()]).collect();
        let found = determinant(rows, &mut Vec::new()).unwrap();
        let total = found.powers.iter().fold(one, |product, (factor, n)| {
            assert_eq!(*n, 1);
            product.mul(factor).unwrap()
        });
        let difference = |a: usize, b: usize| x(a).add(&x(b).neg());
        let by_hand = difference(1, 0).mul(&difference(2, 0)).unwrap().mul(&difference(2, 1)).unwrap();
        let unit = Polynomial::integer(found.unit.numerator());
        assert_eq!(total.mul(&unit), Some(by_hand));
        assert_eq!(found.powers.len(), 3);
    }

    #[test]
    fn dependent_rows_give_zero() {
        let rows = vec![vec![x(0), x(1)], vec![x(0).add(&x(0)), x(1).add(&x(1))]];
        assert!(determinant(rows, &mut Vec::new()).unwrap().is_zero());
    }
}
