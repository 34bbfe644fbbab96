//! Laurent series modulo a prime, each known up to some power, and linear equations over them.

use palmistry_budget as budget;
use palmistry_math::number::PrimeField;

/// `sum_k terms[k] t^(low + k)`, the first of them not zero, known below `low + terms.len()`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Laurent {
    low: i64,
    terms: Vec<u64>,
}

impl Laurent {
    /// A power series of which so many coefficients are known; those behind the end are zero.
    pub fn new(series: &[u64], known: usize) -> Laurent {
        let mut terms = series[..series.len().min(known)].to_vec();
        terms.resize(known, 0);
        Laurent { low: 0, terms }.normal()
    }

    fn normal(mut self) -> Laurent {
        let zeros = self.terms.iter().take_while(|term| **term == 0).count();
        self.terms.drain(..zeros);
        self.low += zeros as i64;
        self
    }

    /// The lowest power and its coefficient; nothing where all that is known is zero.
    pub fn leading(&self) -> Option<(i64, u64)> {
        Some((self.low, *self.terms.first()?))
    }

    /// Coefficients below this power are known.
    pub fn known(&self) -> i64 {
        self.low + self.terms.len() as i64
    }

    fn product(&self, field: &PrimeField, other: &Laurent) -> Laurent {
        let length = self.terms.len().min(other.terms.len());
        budget::steps(length * length);
        let mut terms = vec![0; length];
        for (place, a) in self.terms.iter().take(length).enumerate() {
            for (b, sum) in other.terms.iter().zip(&mut terms[place..]) {
                *sum = field.sum(*sum, field.product(*a, *b));
            }
        }
        Laurent { low: self.low + other.low, terms }.normal()
    }

    fn difference(&self, field: &PrimeField, other: &Laurent) -> Laurent {
        let (low, known) = (self.low.min(other.low), self.known().min(other.known()));
        let length = (known - low).max(0) as usize;
        let low = if length == 0 { known } else { low };
        let at = |of: &Laurent, power: i64| -> u64 {
            usize::try_from(power - of.low).ok().and_then(|place| of.terms.get(place)).copied().unwrap_or(0)
        };
        let term = |place: usize| {
            let power = low + place as i64;
            let minus = at(other, power);
            field.sum(at(self, power), if minus == 0 { 0 } else { field.modulus() - minus })
        };
        Laurent { low, terms: (0..length).map(term).collect() }.normal()
    }

    /// One over it; nothing where all that is known is zero.
    fn inverse(&self, field: &PrimeField) -> Option<Laurent> {
        let first = field.inverse(*self.terms.first()?)?;
        let mut terms: Vec<u64> = Vec::with_capacity(self.terms.len());
        terms.push(first);
        for k in 1..self.terms.len() {
            let sum = (1..=k).fold(0, |sum, j| field.sum(sum, field.product(self.terms[j], terms[k - j])));
            let minus = if sum == 0 { 0 } else { field.modulus() - sum };
            terms.push(field.product(minus, first));
        }
        Some(Laurent { low: -self.low, terms })
    }
}

/// The factors by which the rows sum up to another row, where they are independent as far as is known, and do.
pub(super) fn solve(field: &PrimeField, rows: &[Vec<Laurent>], right: Vec<Laurent>) -> Option<Vec<Laurent>> {
    let unknowns = rows.len();
    // an equation a column, the right side last
    let mut equations: Vec<Vec<Laurent>> = right
        .into_iter()
        .enumerate()
        .map(|(column, right)| rows.iter().map(|row| row[column].clone()).chain([right]).collect())
        .collect();
    let mut pivots: Vec<usize> = Vec::new();
    for step in 0..unknowns {
        // the lowest power, so that nothing that is known is lost
        let open = (step..equations.len()).flat_map(|row| {
            (0..unknowns).filter(|column| !pivots.contains(column)).map(move |column| (row, column))
        });
        let lowest =
            open.filter_map(|(row, column)| Some((equations[row][column].leading()?.0, row, column)));
        let (_, row, column) = lowest.min()?;
        equations.swap(step, row);
        let inverse = equations[step][column].inverse(field)?;
        let (above, below) = equations.split_at_mut(step + 1);
        let pivot = &above[step];
        for other in below {
            if other[column].leading().is_none() {
                continue;
            }
            let factor = other[column].product(field, &inverse);
            for (place, entry) in other.iter_mut().enumerate() {
                if !pivots.contains(&place) && place != column {
                    *entry = entry.difference(field, &factor.product(field, &pivot[place]));
                }
            }
            other[column] = Laurent { low: other[column].known(), terms: Vec::new() };
        }
        pivots.push(column);
    }
    if equations[unknowns..].iter().any(|rest| rest[unknowns].leading().is_some()) {
        return None;
    }
    let mut factors: Vec<Option<Laurent>> = vec![None; unknowns];
    for step in (0..unknowns).rev() {
        let equation = &equations[step];
        let mut left = equation[unknowns].clone();
        for later in &pivots[step + 1..] {
            let known = factors[*later].as_ref()?;
            left = left.difference(field, &known.product(field, &equation[*later]));
        }
        let inverse = equation[pivots[step]].inverse(field)?;
        factors[pivots[step]] = Some(left.product(field, &inverse));
    }
    factors.into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;

    fn series(field: &PrimeField, terms: &[i64], known: usize) -> Laurent {
        let terms: Vec<u64> = terms.iter().map(|term| field.integer(&(*term).into())).collect();
        Laurent::new(&terms, known)
    }

    /// `(1, t)` and `(0, t^2)`: `(t, 3 t^2 + t^3) = t (1, t) + (2 + t) (0, t^2)`; and what a short series leaves open.
    #[test]
    fn factors_are_found_as_far_as_series_are_known() {
        let field = PrimeField::random(&mut rand_chacha::ChaCha8Rng::seed_from_u64(1));
        let of = |terms: &[i64]| series(&field, terms, 6);
        let rows = [vec![of(&[1]), of(&[0, 1])], vec![of(&[]), of(&[0, 0, 1])]];
        let found = solve(&field, &rows, vec![of(&[0, 1]), of(&[0, 0, 3, 1])]).unwrap();
        assert_eq!(found[0].leading(), Some((1, field.one())));
        assert_eq!(found[1].leading(), Some((0, field.integer(&2.into()))));
        assert!(found[1].known() >= 3, "{found:?}");
        // one over t: the factor has a pole
        let found = solve(&field, &[vec![of(&[0, 1])]], vec![of(&[2])]).unwrap();
        assert_eq!(found[0].leading(), Some((-1, field.integer(&2.into()))));
        // nothing is known of a row that is zero so far
        assert_eq!(solve(&field, &[vec![of(&[])]], vec![of(&[1])]), None);
        // and two equations for one factor contradict each other
        assert_eq!(solve(&field, &[vec![of(&[1]), of(&[1])]], vec![of(&[1]), of(&[2])]), None);
    }
}
