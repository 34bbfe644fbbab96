//! Where the rank is full: a minor that is not identically zero on a set, as a product of factors, and the smaller sets on which
//! one of these vanishes.

use super::algebra::{Algebra, Ratio, Reach, TOO_LONG, expanded};
use super::case::Case;
use super::explore::{FullCase, Ranked, Search};
use super::minor::{Product, determinant};
use super::rows::Chosen;
use palmistry_math::expression::{Graph, NodeId};
use palmistry_math::number::polynomial::{Polynomial, Ring};

/// Of a minor whose doubtful factors have no more monomials than this no better one is looked for.
const SHORT: usize = 40;

impl Search<'_> {
    /// What the minors of some rows say of a set; `None` where each of them is zero after all.
    pub(super) fn minor_on(
        &mut self,
        algebra: &mut Algebra<'_>,
        case: &Case,
        chosen: &[Chosen],
    ) -> Reach<Option<Ranked>> {
        let mut best: Option<((usize, usize), FullCase, Vec<Polynomial>)> = None;
        let mut trouble = None;
        let rank = self.rank;
        for chosen in chosen.iter().filter(|chosen| chosen.columns.len() == rank) {
            if best.as_ref().is_some_and(|((length, _), ..)| *length <= SHORT) {
                break;
            }
            let (minor, entries) = match self.minor(algebra, case, chosen) {
                Ok(found) => found,
                Err(why) => {
                    trouble = Some(why);
                    continue;
                }
            };
            if minor.is_zero() {
                continue;
            }
            // its entries may have brought functions that were not met before
            let case = &case.clone().knowing(algebra);
            let mut doubtful: Vec<Polynomial> = Vec::new();
            let mut vanishes = false;
            for (factor, _) in &minor.powers {
                let there = case.reduced(factor)?;
                vanishes |= there.is_zero();
                for factor in case.doubtful(&there) {
                    if !doubtful.contains(&factor) {
                        doubtful.push(factor);
                    }
                }
            }
            if vanishes {
                continue;
            }
            doubtful.sort_by_key(|factor| (factor.len(), factor.degree()));
            let key = (doubtful.iter().map(Polynomial::len).sum::<usize>(), minor.length());
            if best.as_ref().is_none_or(|(least, ..)| key < *least) {
                let full = FullCase { case: case.clone(), chosen: chosen.clone(), minor, entries };
                best = Some((key, full, doubtful));
            }
        }
        match (best, trouble) {
            (Some((_, full, doubtful)), _) if doubtful.is_empty() => Ok(Some(Ranked::Full(Box::new(full)))),
            (Some((_, mut full, doubtful)), _) => {
                let cases = full.case.where_one_vanishes(&doubtful, &[]);
                // where none of them vanishes the rank is full, by this minor
                doubtful.iter().for_each(|factor| full.case.add_nonzero(factor));
                Ok(Some(Ranked::Unless(cases, Box::new(full))))
            }
            (None, Some(why)) => Err(why),
            (None, None) => Ok(None),
        }
    }

    /// A minor with the case's values put in, as a product; and its entries in the chart.
    ///
    /// What stands alone in its row or column is a factor of the whole, and what stands beside it or above it is not looked at: that
    /// is often what would be long.
    pub(super) fn minor(
        &mut self,
        algebra: &mut Algebra<'_>,
        case: &Case,
        chosen: &Chosen,
    ) -> Reach<(Product, Vec<NodeId>)> {
        let (mut rows, mut all) = (Vec::new(), Vec::new());
        for row in &chosen.rows {
            let entries: Vec<NodeId> =
                chosen.columns.iter().map(|column| self.rows.rows[*row][*column]).collect();
            let entries = algebra.in_chart(&case.chart, &entries);
            let entries = algebra.system.graph.substitute(&entries, &case.values);
            all.extend(&entries);
            rows.push(entries);
        }
        let mut total = Product::default();
        while let Some((at, column)) = alone(&algebra.system.graph, &rows) {
            let ratio = algebra.read(rows[at][column])?;
            for (factors, sign) in [(&ratio.top, 1), (&ratio.bottom, -1)] {
                for (factor, power) in factors {
                    total.times(factor, sign * i64::from(*power), &mut self.known);
                }
            }
            if (at + column) % 2 == 1 {
                total.unit = -total.unit;
            }
            rows.remove(at);
            rows.iter_mut().for_each(|row| _ = row.remove(column));
        }
        let rows: Reach<Vec<_>> =
            rows.iter().map(|row| self.without_denominators(algebra, row, &mut total)).collect();
        let found = determinant(rows?, &mut self.known).ok_or(TOO_LONG)?;
        total.unit *= &found.unit;
        for (factor, power) in found.powers {
            total.times(&factor, power, &mut self.known);
        }
        Ok((total, all))
    }

    /// A row over its common denominator, which the product is divided by, without what all of its entries have above the bar.
    fn without_denominators(
        &mut self,
        algebra: &mut Algebra<'_>,
        entries: &[NodeId],
        total: &mut Product,
    ) -> Reach<Vec<Polynomial>> {
        let mut ratios = Vec::new();
        let mut below: Vec<(Polynomial, u32)> = Vec::new();
        for entry in entries {
            let ratio = algebra.read(*entry)?;
            if !ratio.top.iter().any(|(factor, _)| factor.is_zero()) {
                for (factor, power) in &ratio.bottom {
                    match below.iter_mut().find(|(other, _)| other == factor) {
                        Some((_, most)) => *most = (*most).max(*power),
                        None => below.push((factor.clone(), *power)),
                    }
                }
            }
            ratios.push(ratio);
        }
        let is_zero = |ratio: &Ratio| ratio.top.iter().any(|(factor, _)| factor.is_zero());
        let power_in = |factors: &[(Polynomial, u32)], factor: &Polynomial| {
            factors.iter().find(|(other, _)| other == factor).map_or(0, |(_, n)| *n)
        };
        let mut above: Vec<(Polynomial, u32)> = Vec::new();
        if let Some(first) = ratios.iter().find(|ratio| !is_zero(ratio)) {
            for (factor, power) in &first.top {
                let others = ratios.iter().filter(|ratio| !is_zero(ratio));
                let least = others.map(|ratio| power_in(&ratio.top, factor)).min().unwrap_or(0).min(*power);
                if least > 0 && factor.degree() > 0 {
                    above.push((factor.clone(), least));
                }
            }
        }
        for ratio in ratios.iter_mut().filter(|ratio| !is_zero(ratio)) {
            for (factor, power) in &mut ratio.top {
                *power -= power_in(&above, factor);
            }
        }
        for (factor, power) in above {
            total.times(&factor, i64::from(power), &mut self.known);
        }
        let mut row = Vec::new();
        for ratio in ratios {
            let mut top = ratio.top;
            for (factor, power) in &below {
                let own = ratio.bottom.iter().find(|(other, _)| other == factor).map_or(0, |(_, n)| *n);
                top.push((factor.clone(), power - own.min(*power)));
            }
            row.push(match top.iter().any(|(factor, _)| factor.is_zero()) {
                true => Polynomial::default(),
                false => expanded(&top).ok_or(TOO_LONG)?,
            });
        }
        for (factor, power) in below {
            total.times(&factor, -i64::from(power), &mut self.known);
        }
        Ok(row)
    }
}

/// The place of an entry that is not written as zero and beside or above which all are; of the shortest of them.
fn alone(graph: &Graph, rows: &[Vec<NodeId>]) -> Option<(usize, usize)> {
    let filled: Vec<Vec<bool>> = rows
        .iter()
        .map(|row| {
            row.iter()
                .map(|entry| graph.constant_value(*entry).is_none_or(|value| !value.is_zero()))
                .collect()
        })
        .collect();
    let in_column = |column: usize| filled.iter().filter(|row| row[column]).count();
    let mut places = Vec::new();
    for (at, row) in filled.iter().enumerate() {
        let in_row = row.iter().filter(|filled| **filled).count();
        for column in (0..row.len()).filter(|column| row[*column]) {
            if in_row == 1 || in_column(column) == 1 {
                places.push((at, column));
            }
        }
    }
    places.into_iter().min_by_key(|(at, column)| graph.reachable([rows[*at][*column]]).len())
}
