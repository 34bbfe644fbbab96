//! A set as it is printed: equations in the file's own symbols, and what must not vanish on it.
//!
//! Equations of a chart say something of half turns too, once they are written in sines and cosines: each in its own way, which
//! may be more than the limits of the set, and less. So it is asked in each chart what the printed equations describe there.

use super::algebra::{Algebra, Chart, Reach};
use super::case::Case;
use super::cover::{covered, on_case};
use super::explore::{Search, ShortCase};
use super::factors::{coefficient, places};
use palmistry_math::expression::{NodeId, Symbol, Variable};
use palmistry_math::number::polynomial::{Polynomial, Ring};
use std::collections::BTreeSet;

/// One equation of a set.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Line {
    /// A polynomial of the chart vanishes.
    Zero(Polynomial),
    /// An expression of the file does.
    Named(NodeId),
}

/// A set as it is shown.
#[derive(Clone, Debug)]
pub(super) struct Shown {
    /// The cases that lie in it, whose union it is but for those that others show.
    pub cases: Vec<Case>,
    pub chart: Chart,
    pub lines: Vec<Line>,
    /// What does not vanish on it.
    pub nonzero: Vec<Polynomial>,
    /// Angles that are no half turn on it.
    pub no_half_turn: BTreeSet<Symbol>,
    /// No state of it has a higher rank.
    pub rank: usize,
    /// Whether all of its states have this rank.
    pub exactly: bool,
    pub lower: Result<f64, String>,
}

impl Shown {
    /// A case by itself: its states and no others.
    pub fn alone(algebra: &Algebra<'_>, short: &ShortCase) -> Shown {
        let case = short.case.clone();
        // what was divided by comes last, and so is kept where it says the same in other symbols
        let mut nonzero: Vec<Polynomial> = case.nonzero.clone();
        nonzero.retain(|factor| !case.divisors.contains(factor));
        nonzero.extend(case.divisors.iter().cloned());
        Shown {
            chart: case.chart.clone(),
            lines: simplified(&case).into_iter().map(Line::Zero).collect(),
            nonzero,
            no_half_turn: algebra
                .tangents
                .keys()
                .filter(|angle| !case.chart.contains(angle))
                .copied()
                .collect(),
            rank: short.rank,
            exactly: false,
            lower: short.lower.clone(),
            cases: vec![case],
        }
    }

    /// A case whose equations are not all met, or of which not enough is known: it lies in the set that is shown.
    pub fn around(short: &ShortCase) -> Shown {
        let case = short.case.clone();
        Shown {
            chart: case.chart.clone(),
            lines: simplified(&case).into_iter().map(Line::Zero).collect(),
            nonzero: case.divisors.clone(),
            no_half_turn: BTreeSet::new(),
            rank: short.rank,
            exactly: false,
            lower: short.lower.clone(),
            cases: vec![case],
        }
    }

    /// The equations.
    pub fn texts(&self, algebra: &mut Algebra<'_>) -> Vec<String> {
        let mut found = Vec::new();
        for angle in &self.chart {
            found.push(format!("{} = pi", algebra.system.symbol_name(*angle)));
        }
        for line in &self.lines {
            let node = match line {
                Line::Zero(polynomial) => algebra.shown(polynomial),
                Line::Named(node) => *node,
            };
            found.push(format!("{} = 0", algebra.system.graph.text(node)));
        }
        found
    }

    /// What does not vanish.
    pub fn unless(&self, algebra: &mut Algebra<'_>) -> Vec<String> {
        let mut found = Vec::new();
        for factor in &self.nonzero {
            let node = algebra.shown(factor);
            found.push(format!("{} != 0", algebra.system.graph.text(node)));
        }
        for angle in &self.no_half_turn {
            found.push(format!("{} != pi", algebra.system.symbol_name(*angle)));
        }
        found
    }

    /// All that is said of it.
    pub fn place(&self, algebra: &mut Algebra<'_>) -> Vec<String> {
        [self.texts(algebra), self.unless(algebra)].concat()
    }

    /// The rank of its states: `2`, or `at most 2`.
    pub fn rank_in_words(&self) -> String {
        if self.exactly || self.lower.is_err() {
            self.rank.to_string()
        } else {
            format!("at most {}", self.rank)
        }
    }

    /// Its states in a chart, as far as the rows exist there and all of it is asked for; `None` where there are none.
    pub fn in_chart(
        &self,
        algebra: &mut Algebra<'_>,
        search: &Search<'_>,
        chart: &Chart,
    ) -> Reach<Option<Case>> {
        if !self.chart.is_subset(chart) || self.no_half_turn.iter().any(|angle| chart.contains(angle)) {
            return Ok(None);
        }
        let Some(mut case) = search.domain(algebra, chart)? else { return Ok(None) };
        for node in search.nonzero.clone() {
            let node = algebra.in_chart(chart, &[node])[0];
            case.add_nonzero(&algebra.numerator(node)?);
        }
        for factor in &self.nonzero {
            case.add_nonzero(&self.there(algebra, factor, chart)?);
        }
        for line in &self.lines {
            let polynomial = self.line_in(algebra, line, chart)?;
            case = case.with_zero(&polynomial);
        }
        Ok(Some(case))
    }

    fn line_in(&self, algebra: &mut Algebra<'_>, line: &Line, chart: &Chart) -> Reach<Polynomial> {
        match line {
            Line::Zero(polynomial) => self.there(algebra, polynomial, chart),
            Line::Named(node) => {
                let node = algebra.in_chart(chart, &[*node])[0];
                algebra.numerator(node)
            }
        }
    }

    /// What a printed polynomial is in a chart with more half turns: for each of them what stands before the highest power of its
    /// tangent, since it is printed as a form in the sine and the cosine of the half.
    fn there(&self, algebra: &Algebra<'_>, polynomial: &Polynomial, chart: &Chart) -> Reach<Polynomial> {
        let mut found = polynomial.clone();
        for angle in chart.difference(&self.chart) {
            let Some(tangent) = algebra.tangents.get(angle) else { continue };
            let inside = algebra.functions_of(*tangent);
            if inside.into_iter().any(|place| polynomial.degree_in(place) > 0) {
                return Err("a function of an angle has no limit there that is known".to_owned());
            }
            let place =
                algebra.variables().iter().position(|variable| *variable == Variable::Plain(*tangent));
            if let Some(place) = place {
                found = coefficient(&found, place, polynomial.degree_in(place));
            }
        }
        Ok(found)
    }

    /// Whether all states of a case lie in this set.
    pub fn contains(&self, algebra: &mut Algebra<'_>, case: &Case) -> bool {
        if !self.chart.is_subset(&case.chart)
            || self.no_half_turn.iter().any(|angle| case.chart.contains(angle))
        {
            return false;
        }
        let vanishes = self.lines.iter().all(|line| {
            let there = self.line_in(algebra, line, &case.chart);
            there.and_then(|top| on_case(algebra, case, &top)).is_ok_and(|top| top.is_zero())
        });
        vanishes
            && self.nonzero.iter().all(|factor| {
                let there = self.there(algebra, factor, &case.chart);
                let there = there.and_then(|factor| on_case(algebra, case, &factor));
                there.is_ok_and(|top| !top.is_zero() && case.doubtful(&top).is_empty())
            })
    }

    /// Whether all of its states in some charts lie in the union of some cases, or among their limits.
    pub fn lies_in(
        &self,
        algebra: &mut Algebra<'_>,
        search: &Search<'_>,
        charts: &[Chart],
        cases: &[&Case],
    ) -> bool {
        charts.iter().all(|chart| match self.in_chart(algebra, search, chart) {
            Ok(Some(case)) => covered(algebra, case, cases),
            Ok(None) => true,
            Err(_) => false,
        })
    }

    /// Leaves out of what is said not to vanish, and not to be a half turn, what needs not be said: the set is larger then, and still
    /// lies in the union of some cases.
    pub fn widen(
        &mut self,
        algebra: &mut Algebra<'_>,
        search: &Search<'_>,
        charts: &[Chart],
        cases: &[&Case],
    ) {
        let own = std::slice::from_ref(&self.chart).to_vec();
        // all of it at once, which is often so and quickly checked
        let mut wider = self.clone();
        wider.nonzero.clear();
        if wider.lies_in(algebra, search, &own, cases) {
            *self = wider;
        }
        for factor in self.nonzero.clone() {
            let mut wider = self.clone();
            wider.nonzero.retain(|other| *other != factor);
            // the states that come with it
            let mut added = wider.clone();
            added.lines.push(Line::Zero(factor));
            if added.lies_in(algebra, search, &own, cases) {
                *self = wider;
            }
        }
        let mut wider = self.clone();
        wider.no_half_turn.clear();
        let turned = |chart: &&Chart| chart.iter().any(|angle| self.no_half_turn.contains(angle));
        let with: Vec<Chart> = charts.iter().filter(turned).cloned().collect();
        if wider.lies_in(algebra, search, &with, cases) {
            *self = wider;
        }
        for angle in self.no_half_turn.clone() {
            let mut wider = self.clone();
            wider.no_half_turn.remove(&angle);
            let with: Vec<Chart> = charts.iter().filter(|chart| chart.contains(&angle)).cloned().collect();
            if wider.lies_in(algebra, search, &with, cases) {
                *self = wider;
            }
        }
    }
}

/// The equations of a case with the variables that vanish left out of the others, as far as one factor is left of each.
fn simplified(case: &Case) -> Vec<Polynomial> {
    let mut lines = case.equations.clone();
    for _ in 0..lines.len() {
        let zero: Vec<usize> = lines
            .iter()
            .filter(|line| line.len() == 1 && line.degree() == 1)
            .flat_map(|line| places(line).into_iter().take(1))
            .collect();
        let mut changed = false;
        for line in lines.iter_mut().filter(|line| line.len() > 1) {
            let mut rest = Polynomial::default();
            for (exponents, value) in line.terms().filter(|(e, _)| zero.iter().all(|place| e[*place] == 0)) {
                rest = rest.add(&Polynomial::term(*exponents, value.clone()));
            }
            if rest == *line || rest.is_zero() {
                continue;
            }
            if let [factor] = case.doubtful(&rest).as_slice() {
                *line = factor.clone();
                changed = true;
            }
        }
        if !changed {
            break;
        }
    }
    lines
}
