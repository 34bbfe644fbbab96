//! The differentials of an output's derivatives, from covectors that are carried along a trajectory.
//!
//! With `x' = F(x, u)` and `A = dF/dx` along it, the differential of `y = h(x)` is a row of series, `w_0(t) = dh(x(t))`, and that of its
//! k-th derivative is `w_k = w_(k-1)' + w_(k-1) A`, of which the value at `t = 0` is wanted. Each order needs one coefficient
//! less: all up to `K` cost `K^3/6` products for each entry of `A` that varies, and memory for one row of series.

use crate::number::PrimeField;

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

impl Covector {
    /// The value at `t = 0`.
    pub fn value(&self) -> Vec<u64> {
        self.series.iter().map(|series| series.first().copied().unwrap_or(0)).collect()
    }

    /// The same of the next derivative; `integers` are 0, 1, 2, ... in the field.
    pub fn next(&self, field: &PrimeField, entries: &[Entry], integers: &[u64]) -> Covector {
        let length = self.length.saturating_sub(1);
        let derivative = |series: &Vec<u64>| -> Vec<u64> {
            let terms = series.iter().zip(integers).skip(1).take(length);
            terms.map(|(coefficient, k)| field.product(*coefficient, *k)).collect()
        };
        let mut next: Vec<Vec<u64>> = self.series.iter().map(derivative).collect();
        for entry in entries {
            let factor = &self.series[entry.row];
            if factor.is_empty() || entry.series.is_empty() {
                continue;
            }
            let target = &mut next[entry.column];
            let most = (factor.len() + entry.series.len() - 1).min(length);
            if target.len() < most {
                target.resize(most, 0);
            }
            for (k, sum) in target.iter_mut().enumerate().take(most) {
                let from = (k + 1).saturating_sub(entry.series.len());
                let to = k.min(factor.len() - 1);
                if from <= to {
                    let product = field.dot_reversed(&factor[from..=to], &entry.series[k - to..=k - from]);
                    *sum = field.sum(*sum, product);
                }
            }
        }
        for series in &mut next {
            let end = series.iter().rposition(|coefficient| *coefficient != 0).map_or(0, |last| last + 1);
            series.truncate(end);
        }
        Covector { series: next, length }
    }
}
