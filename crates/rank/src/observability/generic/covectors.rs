//! The differentials of an output's derivatives, from covectors that are carried along a trajectory.
//!
//! With `x' = F(x, u)` and `A = dF/dx` along it, the differential of `y = h(x)` is a row of series, `w_0(t) = dh(x(t))`, and that of its
//! k-th derivative is `w_k = w_(k-1)' + w_(k-1) A`, of which the value at `t = 0` is wanted. Each order needs one coefficient
//! less: all up to `K` cost `K^3/6` products for each entry of `A` that varies, and memory for one row of series.

use palmistry_budget::Share;
use palmistry_math::number::PrimeField;
use rayon::prelude::*;

/// An entry of `A`: row, column, coefficients.
pub(super) struct Entry {
    pub row: usize,
    pub column: usize,
    pub series: Vec<u64>,
}

/// The row of an output at one order.
pub(super) struct Covector {
    /// For each column its coefficients, those behind the end are zero.
    pub series: Vec<Vec<u64>>,
    /// How many coefficients are still known.
    pub length: usize,
}

/// 0, 1, 2, ... in the field, as many as series of a length are differentiated by.
pub(super) fn integers(field: &PrimeField, length: usize) -> Vec<u64> {
    std::iter::successors(Some(0), |k| Some(field.sum(*k, field.one()))).take(length + 1).collect()
}

impl Covector {
    /// The value at `t = 0`.
    pub fn value(&self) -> Vec<u64> {
        self.series.iter().map(|series| series.first().copied().unwrap_or(0)).collect()
    }

    /// The same of the next derivative; `integers` are 0, 1, 2, ... in the field, the entries are in the order of their columns.
    pub fn next(&self, field: &PrimeField, entries: &[Entry], integers: &[u64]) -> Covector {
        let length = self.length.saturating_sub(1);
        let column = |column: usize| {
            let terms = self.series[column].iter().zip(integers).skip(1).take(length);
            let mut sum: Vec<u64> = terms.map(|(coefficient, k)| field.product(*coefficient, *k)).collect();
            let begin = entries.partition_point(|entry| entry.column < column);
            for entry in entries[begin..].iter().take_while(|entry| entry.column == column) {
                add_product(field, &mut sum, &self.series[entry.row], &entry.series, length);
            }
            let end = sum.iter().rposition(|coefficient| *coefficient != 0).map_or(0, |last| last + 1);
            sum.truncate(end);
            sum
        };
        let columns = 0..self.series.len();
        let series = match length * entries.len() > WORTH_SHARING {
            true => {
                let share = Share::here();
                columns.into_par_iter().map(|place| share.carry(|| column(place))).collect()
            }
            false => columns.map(column).collect(),
        };
        Covector { series, length }
    }
}

/// So many coefficients of all entries are worth more than one thread.
const WORTH_SHARING: usize = 4000;

/// Adds the product of two series, to so many coefficients.
fn add_product(field: &PrimeField, sum: &mut Vec<u64>, left: &[u64], right: &[u64], length: usize) {
    if left.is_empty() || right.is_empty() {
        return;
    }
    let most = (left.len() + right.len() - 1).min(length);
    if sum.len() < most {
        sum.resize(most, 0);
    }
    for (k, sum) in sum.iter_mut().enumerate().take(most) {
        let (from, to) = ((k + 1).saturating_sub(right.len()), k.min(left.len() - 1));
        if from <= to {
            *sum = field.sum(*sum, field.dot_reversed(&left[from..=to], &right[k - to..=k - from]));
        }
    }
}
