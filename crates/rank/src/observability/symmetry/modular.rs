//! Linear algebra modulo a prime: what all equations leave open, and solutions with few terms.

use dashu::integer::{IBig, UBig};
use dashu::rational::RBig;
use palmistry_budget as budget;
use palmistry_math::number::PrimeField;

/// Sums, differences and products of residues: these are never refused.
#[derive(Clone, Copy, Debug)]
pub(super) struct Residues(pub PrimeField);

impl Residues {
    pub fn one(&self) -> u64 {
        self.integer(1)
    }

    pub fn integer(&self, value: i64) -> u64 {
        self.0.integer(&IBig::from(value))
    }

    pub fn add(&self, a: u64, b: u64) -> u64 {
        let sum = a + b;
        if sum >= self.0.modulus() { sum - self.0.modulus() } else { sum }
    }

    pub fn sub(&self, a: u64, b: u64) -> u64 {
        if a >= b { a - b } else { a + self.0.modulus() - b }
    }

    pub fn neg(&self, a: u64) -> u64 {
        self.sub(0, a)
    }

    pub fn mul(&self, a: u64, b: u64) -> u64 {
        use palmistry_math::number::Arithmetic;
        self.0.mul(&a, &b).unwrap_or(0)
    }

    pub fn power(&self, a: u64, n: u8) -> u64 {
        (0..n).fold(self.one(), |product, _| self.mul(product, a))
    }

    /// `row -= factor * other`, from a column on.
    fn subtract(&self, row: &mut [u64], factor: u64, other: &[u64]) {
        if factor == 0 {
            return;
        }
        for (entry, subtracted) in row.iter_mut().zip(other) {
            if *subtracted != 0 {
                *entry = self.sub(*entry, self.mul(factor, *subtracted));
            }
        }
    }
}

/// Rows in echelon form, to which more are added.
pub(super) struct Echelon {
    residues: Residues,
    columns: usize,
    /// Each with a one at its pivot, and zeros at the pivots of those before it.
    rows: Vec<(usize, Vec<u64>)>,
}

impl Echelon {
    pub fn new(residues: Residues, columns: usize) -> Echelon {
        Echelon { residues, columns, rows: Vec::new() }
    }

    pub fn rank(&self) -> usize {
        self.rows.len()
    }

    /// Adds a row; whether it raised the rank.
    pub fn add(&mut self, mut row: Vec<u64>) -> bool {
        budget::steps(self.rows.len() * row.len());
        for (pivot, known) in &self.rows {
            let factor = row[*pivot];
            self.residues.subtract(&mut row, factor, known);
        }
        let Some(pivot) = row.iter().position(|entry| *entry != 0) else { return false };
        let Some(inverse) = self.residues.0.inverse(row[pivot]) else { return false };
        row.iter_mut().for_each(|entry| *entry = self.residues.mul(*entry, inverse));
        self.rows.push((pivot, row));
        true
    }

    /// The rows with zeros at all pivots but their own, by pivot.
    pub fn reduced(mut self) -> Vec<(usize, Vec<u64>)> {
        for last in (0..self.rows.len()).rev() {
            let (before, after) = self.rows.split_at_mut(last);
            let (pivot, row) = &after[0];
            for (_, other) in before {
                let factor = other[*pivot];
                self.residues.subtract(other, factor, row);
            }
        }
        self.rows.sort_unstable_by_key(|(pivot, _)| *pivot);
        self.rows
    }

    /// The free columns, and for each the vector that all rows annihilate with a one there and zeros at the others.
    pub fn kernel(self) -> (Vec<usize>, Vec<Vec<u64>>) {
        let (residues, columns) = (self.residues, self.columns);
        let rows = self.reduced();
        let free: Vec<usize> =
            (0..columns).filter(|column| rows.iter().all(|(pivot, _)| pivot != column)).collect();
        let vector = |free: &usize| {
            let mut vector = vec![0; columns];
            vector[*free] = residues.one();
            for (pivot, row) in &rows {
                vector[*pivot] = residues.neg(row[*free]);
            }
            vector
        };
        let basis = free.iter().map(vector).collect();
        (free, basis)
    }
}

/// The rank of some rows.
pub(super) fn rank(residues: Residues, rows: &[Vec<u64>]) -> usize {
    let mut echelon = Echelon::new(residues, rows.first().map_or(0, Vec::len));
    rows.iter().for_each(|row| {
        echelon.add(row.clone());
    });
    echelon.rank()
}

/// How often all vectors of a basis are gone through.
const PASSES: usize = 3;
/// More vectors of one space than this are not combined with one another.
const MOST_COMBINED: usize = 160;

/// Vectors of a space with as few terms as adding multiples of others leaves: what a person would write. `weight` says what
/// a term at a place costs; `first` lists the places that are better empty, before all others.
pub(super) fn simple_vectors(
    residues: Residues,
    basis: &[Vec<u64>],
    weight: &dyn Fn(usize) -> u64,
    first: &[usize],
) -> Vec<Vec<u64>> {
    let Some(columns) = basis.first().map(Vec::len) else { return Vec::new() };
    let mut found: Vec<Vec<u64>> = Vec::new();
    let forward: Vec<usize> = (0..columns).collect();
    let backward: Vec<usize> = forward.iter().rev().copied().collect();
    let preferred: Vec<usize> = first
        .iter()
        .copied()
        .chain(backward.iter().copied().filter(|place| !first.contains(place)))
        .collect();
    for order in [preferred, backward, forward] {
        let mut echelon = Echelon::new(residues, columns);
        for vector in basis {
            echelon.add(order.iter().map(|place| vector[*place]).collect());
        }
        let mut reduced: Vec<Vec<u64>> = echelon
            .reduced()
            .into_iter()
            .map(|(_, row)| {
                let mut vector = vec![0; columns];
                order.iter().zip(row).for_each(|(place, entry)| vector[*place] = entry);
                vector
            })
            .collect();
        // one after the other, so that the result is a basis of the same space
        for _ in 0..PASSES {
            let mut shorter = false;
            for place in 0..reduced.len() {
                let vector = reduced.swap_remove(place);
                let next = with_fewer_terms(residues, vector.clone(), &reduced, weight);
                shorter |= next != vector;
                reduced.push(next);
                let last = reduced.len() - 1;
                reduced.swap(place, last);
            }
            if !shorter {
                break;
            }
        }
        found.extend(reduced);
    }
    found.iter_mut().for_each(|vector| normalise(residues, vector));
    found.sort_by_cached_key(|vector| (cost(vector, weight), vector.clone()));
    found.dedup();
    found
}

fn cost(vector: &[u64], weight: &dyn Fn(usize) -> u64) -> (usize, u64) {
    let places = vector.iter().enumerate().filter(|(_, entry)| **entry != 0);
    places.fold((0, 0), |(terms, total), (place, _)| (terms + 1, total + weight(place)))
}

/// A one at the first term.
fn normalise(residues: Residues, vector: &mut [u64]) {
    let lead = vector.iter().find(|entry| **entry != 0).and_then(|entry| residues.0.inverse(*entry));
    if let Some(inverse) = lead {
        vector.iter_mut().for_each(|entry| *entry = residues.mul(*entry, inverse));
    }
}

/// Adds multiples of others as long as terms go.
fn with_fewer_terms(
    residues: Residues,
    mut vector: Vec<u64>,
    others: &[Vec<u64>],
    weight: &dyn Fn(usize) -> u64,
) -> Vec<u64> {
    if others.len() > MOST_COMBINED {
        return vector;
    }
    let mut best = cost(&vector, weight);
    loop {
        let before = best;
        for other in others {
            for place in (0..vector.len()).filter(|place| vector[*place] != 0 && other[*place] != 0) {
                let Some(inverse) = residues.0.inverse(other[place]) else { continue };
                let mut next = vector.clone();
                residues.subtract(&mut next, residues.mul(vector[place], inverse), other);
                let found = cost(&next, weight);
                if found.0 > 0 && found < best {
                    (vector, best) = (next, found);
                    break;
                }
            }
        }
        if best == before {
            return vector;
        }
    }
}

/// Numerators and denominators up to this are looked for.
const LARGEST: i64 = 1 << 20;

/// The fraction of small numbers that a residue is the image of, by Euclid's algorithm (Wang's rational reconstruction,
/// 1981): there is at most one, since twice the square of the bound is below the prime.
fn fraction(residues: Residues, value: u64) -> Option<RBig> {
    let p = residues.0.modulus();
    let (mut r0, mut r1) = (i128::from(p), i128::from(residues.0.representative(value)));
    let (mut t0, mut t1) = (0i128, 1i128);
    while r1 > i128::from(LARGEST) {
        let quotient = r0 / r1;
        (r0, r1) = (r1, r0 - quotient * r1);
        (t0, t1) = (t1, t0 - quotient * t1);
    }
    if t1 == 0 || t1.abs() > i128::from(LARGEST) {
        return None;
    }
    let numerator = if t1 < 0 { -r1 } else { r1 };
    Some(RBig::from_parts(IBig::from(numerator), UBig::try_from(t1.abs()).ok()?))
}

/// A vector in integers without a common divisor whose first entry that is not zero is positive, along one modulo the prime;
/// none where that has no small entries.
pub(super) fn in_integers(residues: Residues, vector: &[u64]) -> Option<Vec<i64>> {
    use dashu::base::Gcd;
    let mut scaled = vector.to_vec();
    normalise(residues, &mut scaled);
    let fractions = scaled.iter().map(|entry| fraction(residues, *entry)).collect::<Option<Vec<RBig>>>()?;
    let common = fractions.iter().fold(UBig::ONE, |all, part| {
        let next = part.denominator();
        &all / (&all).gcd(next) * next
    });
    if common > UBig::from(LARGEST as u64) {
        return None;
    }
    let whole = |part: &RBig| i64::try_from((part * RBig::from(common.clone())).into_parts().0).ok();
    let integers = fractions.iter().map(whole).collect::<Option<Vec<i64>>>()?;
    let divisor = integers.iter().fold(0u64, |all, part| gcd(all, part.unsigned_abs()));
    let divisor = i64::try_from(divisor.max(1)).ok()?;
    Some(integers.into_iter().map(|part| part / divisor).collect())
}

pub(super) fn gcd(a: u64, b: u64) -> u64 {
    if b == 0 { a } else { gcd(b, a % b) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;

    fn residues() -> Residues {
        Residues(PrimeField::random(&mut rand_chacha::ChaCha8Rng::seed_from_u64(5)))
    }

    #[test]
    fn the_kernel_of_two_rows_is_found_again_in_integers() {
        let residues = residues();
        let mut echelon = Echelon::new(residues, 4);
        for row in [[2, -3, 0, 0], [0, 0, 5, 7], [2, -3, 5, 7]] {
            echelon.add(row.iter().map(|x| residues.integer(*x)).collect());
        }
        assert_eq!(echelon.rank(), 2);
        let (free, basis) = echelon.kernel();
        assert_eq!(free, [1, 3]);
        let integers: Vec<_> = basis.iter().map(|vector| in_integers(residues, vector).unwrap()).collect();
        assert_eq!(integers, [vec![3, 2, 0, 0], vec![0, 0, 7, -5]]);
    }

    /// `(1, 1, 1, 0, 0)`, `(0, 0, 0, 1, -1)` and their mixtures: the vectors with the fewest terms come first.
    #[test]
    fn few_terms_come_first() {
        let residues = residues();
        let rows = [[1, 1, 1, 2, -2], [1, 1, 1, 5, -5]];
        let basis: Vec<Vec<u64>> =
            rows.iter().map(|row| row.iter().map(|x| residues.integer(*x)).collect()).collect();
        let simple = simple_vectors(residues, &basis, &|_| 1, &[]);
        assert_eq!(in_integers(residues, &simple[0]).unwrap(), [0, 0, 0, 1, -1]);
        assert_eq!(in_integers(residues, &simple[1]).unwrap(), [1, 1, 1, 0, 0]);
    }

    /// A residue that no small fraction has is refused.
    #[test]
    fn large_numbers_are_no_fractions() {
        let residues = residues();
        let large = residues.mul(residues.integer(1_234_567_891_011), residues.integer(987_654_321_234));
        assert_eq!(in_integers(residues, &[residues.one(), large]), None);
    }
}
