//! Where the rank is lower: all minors of a set vanish, and no field leaves it, so that higher Lie derivatives add nothing
//! ([`palmistry_rank::observability::RankGrowth`]).

use super::algebra::{Algebra, Chart, Reach};
use super::case::{Case, Step};
use super::explore::{Ranked, Search, ShortCase, ShortRank};
use super::point::Point;
use super::rows::Chosen;
use palmistry_math::expression::{NodeId, Symbol};
use palmistry_math::number::polynomial::Ring;
use palmistry_rank::observability::{GenericRank, generic_rank, vanishes};

/// No more minors are reduced on one set.
const MOST_BORDERS: usize = 200;

impl Search<'_> {
    /// The rank on a set that is cut out by equations that cannot be solved: the minors that border one which is not zero are
    /// reduced by these equations. Where that one does not vanish, and they do, the rank is its size.
    pub(super) fn lower_on_relations(
        &mut self,
        algebra: &mut Algebra<'_>,
        case: &Case,
        point: &Point,
        rank: usize,
    ) -> Reach<Ranked> {
        let short = |lower| Ok(Ranked::Short(ShortCase::new(case, rank, lower)));
        if let Some(bound) = self.lower_around(algebra, case) {
            return short(Ok(bound));
        }
        if self.rows.is_of_lie_derivatives() {
            if let Some(field) = leaving_field(algebra, case) {
                if self.rows.extend(algebra) {
                    return self.rank_on(algebra, case);
                }
                return short(Err(format!(
                    "the field {field} leaves it, so that higher Lie derivatives may add to the rank"
                )));
            }
            let ranks = self.rows.ranks(algebra, &case.chart, point, &mut self.rng);
            let (_, growth) = ranks.ok_or("no point was found at which the rows are defined")?;
            if !self.rows.have_rested(growth) {
                if self.rows.extend(algebra) {
                    return self.rank_on(algebra, case);
                }
                return short(Err("higher Lie derivatives may add to the rank".to_owned()));
            }
        }
        let (mut doubtful, mut rank) = (Vec::new(), 0);
        for columns in self.rows.spans() {
            let basis = self.rows.shortest(algebra, &case.chart, (point, columns), &mut self.rng);
            let Some(basis) = basis else {
                return short(Err("no point was found at which the rows are defined".to_owned()));
            };
            if let Err(why) = self.borders_vanish(algebra, case, &basis, columns)? {
                return short(Err(why));
            }
            rank = basis.rows.len();
            if !basis.rows.is_empty() {
                let (minor, _) = self.minor(algebra, case, &basis)?;
                for (factor, _) in &minor.powers {
                    for factor in case.doubtful(&case.reduced(factor)?) {
                        if !doubtful.contains(&factor) {
                            doubtful.push(factor);
                        }
                    }
                }
            }
        }
        let cases = case.where_one_vanishes(&doubtful, &[]);
        let mut main = case.clone();
        for factor in doubtful {
            main.add_nonzero(&factor);
            main.divisors.push(factor);
        }
        Ok(Ranked::Lower(cases, ShortCase { case: main, rank, lower: Ok(f64::NEG_INFINITY) }))
    }

    /// Nothing, where all minors that border one of the first so many columns vanish on a set; else why that is not known.
    fn borders_vanish(
        &mut self,
        algebra: &mut Algebra<'_>,
        case: &Case,
        basis: &Chosen,
        width: usize,
    ) -> Reach<Result<(), String>> {
        let height = self.rows.rows.len();
        if (height - basis.rows.len()) * (width - basis.columns.len()) > MOST_BORDERS {
            return Ok(Err("there are too many minors".to_owned()));
        }
        for row in (0..height).filter(|row| !basis.rows.contains(row)) {
            for column in (0..width).filter(|column| !basis.columns.contains(column)) {
                let bordered = Chosen {
                    rows: basis.rows.iter().copied().chain([row]).collect(),
                    columns: basis.columns.iter().copied().chain([column]).collect(),
                };
                let (minor, _) = self.minor(algebra, case, &bordered)?;
                let mut vanishes = minor.is_zero();
                for (factor, power) in &minor.powers {
                    vanishes |= *power > 0 && case.reduced(factor)?.is_zero();
                }
                if !vanishes {
                    return Ok(Err("a minor was not shown to vanish there".to_owned()));
                }
            }
        }
        Ok(Ok(()))
    }

    /// The same by a larger set, on which fewer of the equations hold: the fields may leave the one and not the other.
    pub(super) fn lower_around(&mut self, algebra: &mut Algebra<'_>, case: &Case) -> Option<ShortRank> {
        let mut charts = vec![Chart::new(), case.chart.clone()];
        charts.extend(case.chart.iter().map(|angle| Chart::from([*angle])));
        charts.dedup();
        let count = case.equations.len();
        let alone = (0..count).map(|one| vec![one]);
        let pairs = (0..count).flat_map(|one| (0..one).map(move |other| vec![other, one]));
        let subsets: Vec<Vec<usize>> = alone.chain(pairs).filter(|subset| subset.len() < count).collect();
        let all: Vec<usize> = (0..count).collect();
        for chart in charts {
            let fewer = chart.len() < case.chart.len();
            for subset in subsets.iter().chain(fewer.then_some(&all)) {
                let Some(mut around) = self.domain(algebra, &chart).ok()? else { break };
                for equation in subset {
                    around = around.with_zero(&case.equations[*equation]);
                }
                if let Some(found) = self.lower_where_solved(algebra, around) {
                    return Some(found);
                }
            }
        }
        None
    }

    /// That the rank is lower on a set whose equations can be solved without dividing it.
    fn lower_where_solved(&mut self, algebra: &mut Algebra<'_>, mut case: Case) -> Option<ShortRank> {
        let case = loop {
            match case.step(algebra).ok()? {
                Step::Empty => return None,
                Step::Ready(ready) => break ready,
                Step::Split(mut cases) if cases.len() == 1 => case = cases.remove(0),
                Step::Split(_) => return None,
            }
        };
        let point = self.point(algebra, &case).ok()?;
        let chosen = self.rows.independent(algebra, &case.chart, &point, self.rank, &mut self.rng)?;
        if chosen.iter().any(|chosen| chosen.columns.len() >= self.rank) {
            return None;
        }
        self.lower_on(algebra, &case, &point).ok()
    }

    /// That the rank is lower than asked at all states of a set: one that none of them exceeds.
    ///
    /// Where no field leaves the set, a rank that one order more of Lie derivatives did not raise is that of all of them; all
    /// minors of the asked size are then zero at almost all of its states, and so at all.
    ///
    /// # Errors
    /// Why that is not known, in words.
    pub(super) fn lower_on(
        &mut self,
        algebra: &mut Algebra<'_>,
        case: &Case,
        point: &Point,
    ) -> Result<ShortRank, String> {
        if !case.relations.is_empty() {
            return Err("it is cut out by an equation that is linear in no symbol".to_owned());
        }
        let ranks = self.rows.ranks(algebra, &case.chart, point, &mut self.rng);
        let (seen, growth) = ranks.ok_or("no point was found at which the rows are defined")?;
        let mut error = f64::NEG_INFINITY;
        if self.rows.is_of_lie_derivatives() {
            let field = leaving_field(algebra, case);
            if let Some(field) = field {
                return Err(format!(
                    "the field {field} leaves it, so that higher Lie derivatives may add to the rank"
                ));
            }
            let longer_may_add = || Err("higher Lie derivatives may add to the rank".to_owned());
            if !self.rows.have_rested(growth) {
                return longer_may_add();
            }
            let asked = self.rows.columns;
            for width in self.rows.spans().into_iter().filter(|width| *width > asked) {
                let (rank, log2_error) = self.generic_rank_by(algebra, case, width)?;
                if rank > growth.below {
                    return longer_may_add();
                }
                error = error.max(log2_error);
            }
        }
        match self.generic_rank_by(algebra, case, self.rows.columns)? {
            (rank, log2_error) if rank < self.rank && rank == seen => {
                Ok(ShortRank { rank, log2_error: error.max(log2_error) })
            }
            _ => Err("the rank is no lower there".to_owned()),
        }
    }

    /// The rank of the first so many columns at almost all states of a set, and a bound on the probability of an error.
    fn generic_rank_by(
        &mut self,
        algebra: &mut Algebra<'_>,
        case: &Case,
        columns: usize,
    ) -> Reach<(usize, f64)> {
        let entries: Vec<NodeId> =
            self.rows.rows.iter().flat_map(|row| row[..columns].iter().copied()).collect();
        let entries = algebra.in_chart(&case.chart, &entries);
        let entries = algebra.system.graph.substitute(&entries, &case.values);
        match generic_rank(&mut algebra.system.graph, &entries, columns, |_| false, &mut self.rng) {
            GenericRank::Rank { rank, log2_error, .. } => Ok((rank, log2_error)),
            GenericRank::Pole(_) => Err("there is a singularity at every state of it".to_owned()),
            GenericRank::Functions => Err("functions are met that are not rational".to_owned()),
            GenericRank::Unknown(why) => Err(why),
        }
    }
}

/// The name of a field that leaves a set whose equations are solved; none where all are tangent to it.
fn leaving_field(algebra: &mut Algebra<'_>, case: &Case) -> Option<String> {
    let mut solved: Vec<(Symbol, NodeId)> = case.values.iter().map(|(s, v)| (*s, *v)).collect();
    solved.sort_unstable();
    for field in algebra.system.moving_fields() {
        let name = algebra.system.fields[field].name.clone();
        // an angle that is a half turn has to stay one
        for angle in &case.chart {
            let rate = rate_of(algebra, case, field, *angle);
            if !algebra_vanishes(algebra, case, rate) {
                return Some(name);
            }
        }
        for relation in &case.relations {
            let node = algebra.node(&relation.polynomial);
            let mut sum = algebra.system.graph.integer(0);
            for symbol in algebra.system.graph.symbols_of([node]) {
                let slope = algebra.system.partial(node, symbol);
                let rate = rate_of(algebra, case, field, symbol);
                let part = algebra.system.graph.mul(slope, rate);
                sum = algebra.system.graph.add(sum, part);
            }
            if !algebra_vanishes(algebra, case, sum) {
                return Some(name);
            }
        }
        for (symbol, value) in &solved {
            let mut difference = rate_of(algebra, case, field, *symbol);
            for other in algebra.system.graph.symbols_of([*value]) {
                let slope = algebra.system.partial(*value, other);
                let rate = rate_of(algebra, case, field, other);
                let part = algebra.system.graph.mul(slope, rate);
                difference = algebra.system.graph.sub(difference, part);
            }
            if !algebra_vanishes(algebra, case, difference) {
                return Some(name);
            }
        }
    }
    None
}

/// The rate of a chart's symbol along a field, in the chart.
fn rate_of(algebra: &mut Algebra<'_>, case: &Case, field: usize, symbol: Symbol) -> NodeId {
    let angle = algebra.tangents.iter().find(|(_, tangent)| **tangent == symbol).map(|(angle, _)| *angle);
    let stands_for = algebra.coordinates.changed.iter().find(|(_, new, _)| *new == symbol);
    let meaning = match (angle, stands_for) {
        (Some(angle), _) => algebra.system.graph.symbol(angle),
        (None, Some((_, _, meaning))) => *meaning,
        (None, None) => algebra.system.graph.symbol(symbol),
    };
    let rate = algebra.system.lie_derivative(field, meaning);
    let rate = algebra.in_chart(&case.chart, &[rate])[0];
    if angle.is_none() {
        return rate;
    }
    // t = tan(phi/2): t' = (1 + t^2)/2 phi'
    let graph = &mut algebra.system.graph;
    let t = graph.symbol(symbol);
    let (one, two, square) = (graph.integer(1), graph.integer(2), graph.power(t, 2));
    let sum = graph.add(one, square);
    let factor = graph.div(sum, two);
    graph.mul(factor, rate)
}

/// Whether an expression of a chart is zero all over a case.
fn algebra_vanishes(algebra: &mut Algebra<'_>, case: &Case, node: NodeId) -> bool {
    let there = algebra.system.graph.substitute(&[node], &case.values)[0];
    if case.relations.is_empty() {
        return vanishes(algebra.system, there);
    }
    let top = algebra.numerator(there).and_then(|top| case.reduced(&top));
    top.is_ok_and(|top| top.is_zero())
}
