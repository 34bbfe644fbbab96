//! Where the rank is full: a minor that is not identically zero on a set, as a product of factors, and the smaller sets on which
//! one of these vanishes.

use super::algebra::{Algebra, Reach, TOO_LONG, expanded};
use super::case::Case;
use super::explore::{FullCase, Ranked, Search};
use super::minor::{Product, determinant};
use super::rows::Chosen;
use crate::expression::NodeId;
use crate::number::polynomial::{Polynomial, Ring};

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
                let cases = case.where_one_vanishes(&doubtful, &[]);
                // where none of them vanishes the rank is full, by this minor
                doubtful.iter().for_each(|factor| full.case.add_nonzero(factor));
                Ok(Some(Ranked::Unless(cases, Box::new(full))))
            }
            (None, Some(why)) => Err(why),
            (None, None) => Ok(None),
        }
    }

    /// A minor with the case's values put in, as a product; and its entries in the chart.
    pub(super) fn minor(
        &mut self,
        algebra: &mut Algebra<'_>,
        case: &Case,
        chosen: &Chosen,
    ) -> Reach<(Product, Vec<NodeId>)> {
        let mut total = Product::default();
        let (mut rows, mut all) = (Vec::new(), Vec::new());
        for row in &chosen.rows {
            let entries: Vec<NodeId> =
                chosen.columns.iter().map(|column| self.rows.rows[*row][*column]).collect();
            let entries = algebra.in_chart(&case.chart, &entries);
            let entries = algebra.system.graph.substitute(&entries, &case.values);
            all.extend(&entries);
            rows.push(self.without_denominators(algebra, &entries, &mut total)?);
        }
        let found = determinant(rows, &mut self.known).ok_or(TOO_LONG)?;
        total.unit *= &found.unit;
        for (factor, power) in found.powers {
            total.times(&factor, power, &mut self.known);
        }
        Ok((total, all))
    }

    /// A row over its common denominator, which the product is divided by.
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
