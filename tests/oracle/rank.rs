//! Ranks by the witness: differentials of outputs and of their Lie derivatives along all words up to a length, at one
//! state, by series; and elimination over the exact rationals, or over 240 digits with the largest pivot.

use super::expression::Expression;
use super::number::{Number, Trouble, is_blurred, threshold};
use super::point::Point;
use super::series::{Series, Space, series};
use super::system::Model;
use dashu::base::Abs;

/// More words than this are not taken.
const MOST_WORDS: usize = 260;

/// The rank at a state by all words of at most 0, 1, ..., `longest` fields; shorter where it becomes full, or where the
/// words become too many.
pub fn ranks(model: &Model, point: &Point, longest: usize) -> Result<Vec<usize>, Trouble> {
    let space = Space { variables: model.states.clone(), degree: longest as u32 + 1 };
    let at = |e: &Expression| series(e, point, &space);
    let mut rates: Vec<Vec<Series>> = Vec::new();
    for field in model.fields.iter().filter(|field| field.counts) {
        rates.push(field.rates.iter().map(at).collect::<Result<_, _>>()?);
    }
    // a field that is not defined makes the state a pole, though no word may be longer than none
    let mut last: Vec<Series> = model.outputs.iter().map(at).collect::<Result<_, _>>()?;
    let (mut rows, mut found, mut words) = (Vec::new(), Vec::new(), 0);
    for length in 0..=longest {
        if length > 0 {
            let mut next = Vec::new();
            for word in &last {
                for field in &rates {
                    let mut sum = Series::default();
                    for (place, rate) in field.iter().enumerate() {
                        sum = sum.add(&rate.multiply(&word.derivative(place), &space));
                    }
                    next.push(sum);
                }
            }
            last = next;
        }
        words += last.len();
        if words > MOST_WORDS {
            break;
        }
        rows.extend(last.iter().map(|word| word.gradient(&space)));
        let rank = rank(rows.clone())?;
        found.push(rank);
        if rank == model.states.len() {
            break;
        }
    }
    Ok(found)
}

/// The rank of a matrix of rows of one length.
pub fn rank(mut rows: Vec<Vec<Number>>) -> Result<usize, Trouble> {
    let columns = rows.first().map_or(0, Vec::len);
    let mut found = 0;
    for column in 0..columns {
        let mut pivot: Option<(usize, &Number)> = None;
        for (place, row) in rows.iter().enumerate().skip(found) {
            let entry = &row[column];
            if entry.is_exact_zero() {
                continue;
            }
            if !entry.is_exact() {
                let digits = entry.digits();
                if is_blurred(&digits) {
                    continue; // taken for zero: of 240 digits 90 are
                }
                if digits.abs() < threshold(150) {
                    return Err(Trouble::Unclear);
                }
            }
            let larger = |other: &Number| {
                entry.is_exact() && !other.is_exact()
                    || entry.is_exact() == other.is_exact()
                        && !entry.is_exact()
                        && entry.digits().abs() > other.digits().abs()
            };
            if pivot.is_none_or(|(_, other)| larger(other)) {
                pivot = Some((place, entry));
            }
        }
        let Some((place, _)) = pivot else { continue };
        rows.swap(found, place);
        let (done, rest) = rows.split_at_mut(found + 1);
        let head = &done[found];
        for row in rest {
            let factor = row[column].divide(&head[column])?;
            if factor.is_exact_zero() {
                continue;
            }
            for (entry, above) in row.iter_mut().zip(head).skip(column) {
                *entry = entry.subtract(&factor.multiply(above));
            }
            row[column] = Number::ZERO;
        }
        found += 1;
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Duerer's magic square (*Melencolia I*, 1514) has rank 3.
    #[test]
    fn a_magic_square_of_order_four_has_rank_three() {
        let square = [[16, 3, 2, 13], [5, 10, 11, 8], [9, 6, 7, 12], [4, 15, 14, 1]];
        let rows = square.iter().map(|row| row.iter().map(|n| Number::integer(*n)).collect()).collect();
        assert_eq!(rank(rows), Ok(3));
        assert_eq!(rank(Vec::new()), Ok(0));
    }
}
