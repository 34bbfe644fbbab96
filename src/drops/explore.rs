//! All states, taken apart into sets on each of which the rank is known.

use super::algebra::{Algebra, Chart, Reach, TOO_LONG, expanded};
use super::case::{Case, Step};
use super::minor::{Product, determinant};
use super::point::{Point, draw};
use super::rows::{Chosen, Rows};
use crate::expression::{Guard, Need, NodeId, Program, Symbol, draw_residues};
use crate::number::PrimeField;
use crate::number::polynomial::{Polynomial, Ring};
use crate::observability::{GenericRank, generic_rank, vanishes};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::sync::atomic::{AtomicBool, Ordering};

/// No more minors are reduced on one set.
const MOST_BORDERS: usize = 200;
/// Of a minor whose doubtful factors have no more monomials than this no better one is looked for.
const SHORT: usize = 40;
/// No more cases are looked at.
const MOST_CASES: usize = 3_000;

/// A minor that is nowhere zero on a set.
#[derive(Clone)]
pub(super) struct FullCase {
    pub case: Case,
    pub chosen: Chosen,
    pub minor: Product,
    pub entries: Vec<NodeId>,
}

/// A set on which no minor of the asked size was found.
#[derive(Clone)]
pub(super) struct ShortCase {
    pub case: Case,
    /// The rank at almost all of its states, by the rows that were taken.
    pub rank: usize,
    /// A bound on the probability that the rank is lower than asked by an error, as a power of two; why it is not known to be
    /// lower, where it is not.
    pub lower: Result<f64, String>,
}

/// What all states come to.
#[derive(Default)]
pub(super) struct Explored {
    pub full: Vec<FullCase>,
    pub short: Vec<ShortCase>,
    /// How many sets were found empty.
    pub empty: usize,
    pub cases: usize,
}

/// What is asked.
pub(super) struct Search<'a> {
    pub rows: Rows,
    /// The rank that states are asked for.
    pub rank: usize,
    /// What has to hold for the rows to exist.
    pub guards: Vec<Guard>,
    /// What vanishes at all states that are asked for.
    pub conditions: Vec<NodeId>,
    /// What has to differ from zero.
    pub nonzero: Vec<NodeId>,
    pub interrupt: &'a AtomicBool,
    pub rng: ChaCha8Rng,
    /// Factors that were met, and are likely to be met again.
    pub known: Vec<Polynomial>,
}

impl Search<'_> {
    /// Follows all states to where their rank is known.
    ///
    /// # Errors
    /// In words, where something is out of reach.
    pub fn run(&mut self, algebra: &mut Algebra<'_>) -> Reach<Explored> {
        let charts = algebra.charts().ok_or("there are too many angles")?;
        let mut found = Explored::default();
        for chart in charts {
            self.chart(algebra, &chart, &mut found)?;
        }
        Ok(found)
    }

    /// The states of a chart at which the rows exist; none where that is nowhere.
    pub fn domain(&self, algebra: &mut Algebra<'_>, chart: &Chart) -> Reach<Option<Case>> {
        let mut case = Case::of(chart);
        for guard in self.guards.clone() {
            let node = algebra.in_chart(chart, &[guard.node])[0];
            let ratio = match algebra.read(node) {
                Ok(ratio) => ratio,
                Err(_) if is_pole(algebra, node) => return Ok(None),
                Err(why) => return Err(why),
            };
            match guard.need {
                Need::NotZero => ratio.top.iter().for_each(|(factor, _)| case.add_nonzero(factor)),
                Need::Positive => {
                    let odd = ratio.bottom.iter().filter(|(_, n)| n % 2 == 1);
                    let odd = odd.map(|(factor, _)| (factor.clone(), 1));
                    let signed: Vec<_> = ratio.top.iter().cloned().chain(odd).collect();
                    match expanded(&signed) {
                        Some(polynomial) => case.add_positive(&polynomial),
                        None => ratio.top.iter().for_each(|(factor, _)| case.add_nonzero(factor)),
                    }
                }
                // a case may be larger than the set that it stands for: more is proved then than is needed
                Need::NotNegative | Need::WithinOne | Need::InsideOne => {}
            }
        }
        Ok(Some(case))
    }

    fn chart(&mut self, algebra: &mut Algebra<'_>, chart: &Chart, found: &mut Explored) -> Reach<()> {
        let Some(mut case) = self.domain(algebra, chart)? else {
            found.empty += 1;
            return Ok(());
        };
        for node in self.nonzero.clone() {
            let node = algebra.in_chart(chart, &[node])[0];
            let polynomial = algebra.numerator(node)?;
            case.add_nonzero(&polynomial);
        }
        for node in self.conditions.clone() {
            let node = algebra.in_chart(chart, &[node])[0];
            let polynomial = algebra.numerator(node)?;
            case = case.with_zero(&polynomial);
        }
        let mut open = vec![case];
        while let Some(case) = open.pop() {
            found.cases += 1;
            if found.cases > MOST_CASES {
                return Err(format!("there are more than {MOST_CASES} cases"));
            }
            if self.interrupt.load(Ordering::Relaxed) {
                return Err("it was interrupted".to_owned());
            }
            match case.clone().step(algebra) {
                Ok(Step::Empty) => found.empty += 1,
                Ok(Step::Split(cases)) => open.extend(cases.into_iter().rev()),
                Ok(Step::Ready(case)) => match self.rank_on(algebra, &case) {
                    Ok(Ranked::Full(full)) => found.full.push(*full),
                    Ok(Ranked::Unless(cases, full)) => {
                        found.full.push(*full);
                        open.extend(cases.into_iter().rev());
                    }
                    Ok(Ranked::Short(short)) => found.short.push(short),
                    Ok(Ranked::Lower(cases, short)) => {
                        found.short.push(short);
                        open.extend(cases.into_iter().rev());
                    }
                    Err(why) => found.short.push(ShortCase { case: *case, rank: 0, lower: Err(why) }),
                },
                Err(why) => found.short.push(ShortCase { case, rank: 0, lower: Err(why) }),
            }
        }
        Ok(())
    }

    /// The rank on a set whose equations are all met.
    fn rank_on(&mut self, algebra: &mut Algebra<'_>, case: &Case) -> Reach<Ranked> {
        loop {
            let point = self.point(algebra, case)?;
            let chosen = self.rows.independent(algebra, &case.chart, &point, self.rank, &mut self.rng);
            let chosen = chosen.ok_or("no point was found at which the rows exist")?;
            let rank = chosen.iter().map(|chosen| chosen.columns.len()).max().unwrap_or(0);
            if rank == self.rank {
                if let Some(found) = self.minor_on(algebra, case, &chosen)? {
                    return Ok(found);
                }
                return Err("the minor that was tried is zero".to_owned());
            }
            if !case.relations.is_empty() {
                return self.lower_on_relations(algebra, case, &point, rank);
            }
            let mut lower = self.lower_on(algebra, case, &point);
            if lower.is_err() && self.rows.order == 0 && self.rows.extend(algebra) {
                continue;
            }
            if lower.is_err() {
                lower = self.lower_on(algebra, case, &point);
            }
            if lower.is_err()
                && let Some(log2_error) = self.lower_around(algebra, case)
            {
                lower = Ok(log2_error);
            }
            if lower.is_ok() || !self.rows.extend(algebra) {
                return Ok(Ranked::Short(ShortCase { case: case.clone(), rank, lower }));
            }
        }
    }

    fn point(&mut self, algebra: &mut Algebra<'_>, case: &Case) -> Reach<Point> {
        let entries: Vec<NodeId> = self.rows.rows.iter().flatten().copied().collect();
        let entries = algebra.in_chart(&case.chart, &entries);
        let mut symbols: Vec<Symbol> = algebra.system.graph.symbols_of(entries);
        for variable in algebra.variables() {
            if let crate::expression::Variable::Plain(symbol) = variable
                && !symbols.contains(symbol)
            {
                symbols.push(*symbol);
            }
        }
        symbols.sort_unstable();
        draw(algebra, case, &symbols, &mut self.rng)
            .ok_or_else(|| "no point of it was found modulo a prime".to_owned())
    }

    /// What the minors of some rows say of a set; `None` where each of them is zero after all.
    fn minor_on(
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
    fn minor(
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

    /// The rank on a set that is cut out by equations that cannot be solved: the minors that border one which is not zero are
    /// reduced by these equations. Where that one does not vanish, and they do, the rank is its size.
    fn lower_on_relations(
        &mut self,
        algebra: &mut Algebra<'_>,
        case: &Case,
        point: &Point,
        rank: usize,
    ) -> Reach<Ranked> {
        let short = |lower| Ok(Ranked::Short(ShortCase { case: case.clone(), rank, lower }));
        if let Some(log2_error) = self.lower_around(algebra, case) {
            return short(Ok(log2_error));
        }
        if self.rows.is_of_words() {
            if let Some(field) = leaving_field(algebra, case) {
                if self.rows.extend(algebra) {
                    return self.rank_on(algebra, case);
                }
                return short(Err(format!(
                    "the field {field} leaves it, so that longer words may add to the rank"
                )));
            }
            let ranks = self.rows.ranks(algebra, &case.chart, point, &mut self.rng);
            let (shorter, seen) = ranks.ok_or("no point was found at which the rows exist")?;
            if !self.rows.complete && (self.rows.order == 0 || shorter < seen) {
                if self.rows.extend(algebra) {
                    return self.rank_on(algebra, case);
                }
                return short(Err("longer words may add to the rank".to_owned()));
            }
        }
        let Some(basis) = self.rows.shortest(algebra, &case.chart, point, &mut self.rng) else {
            return short(Err("no point was found at which the rows exist".to_owned()));
        };
        let (height, width) = (self.rows.rows.len(), self.rows.columns);
        if (height - basis.rows.len()) * (width - basis.columns.len()) > MOST_BORDERS {
            return short(Err("there are too many minors".to_owned()));
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
                    return short(Err("a minor is not seen to vanish there".to_owned()));
                }
            }
        }
        let mut doubtful: Vec<Polynomial> = Vec::new();
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
        let cases = case.where_one_vanishes(&doubtful, &[]);
        let mut main = case.clone();
        for factor in doubtful {
            main.add_nonzero(&factor);
            main.divisors.push(factor);
        }
        Ok(Ranked::Lower(
            cases,
            ShortCase { case: main, rank: basis.rows.len(), lower: Ok(f64::NEG_INFINITY) },
        ))
    }

    /// The same by a larger set, on which fewer of the equations hold: the fields may leave the one and not the other.
    fn lower_around(&mut self, algebra: &mut Algebra<'_>, case: &Case) -> Option<f64> {
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

    /// That the rank is lower on a set whose equations can be solved without taking it apart.
    fn lower_where_solved(&mut self, algebra: &mut Algebra<'_>, mut case: Case) -> Option<f64> {
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

    /// That the rank is lower than asked at all states of a set: a bound on the probability of an error.
    ///
    /// Where no field leaves the set, a rank that one order more of words did not raise is that of all words; all minors of
    /// the asked size are then zero at almost all of its states, and so at all.
    ///
    /// # Errors
    /// Why that is not known, in words.
    fn lower_on(&mut self, algebra: &mut Algebra<'_>, case: &Case, point: &Point) -> Result<f64, String> {
        if !case.relations.is_empty() {
            return Err("it is cut out by an equation that is linear in no symbol".to_owned());
        }
        let ranks = self.rows.ranks(algebra, &case.chart, point, &mut self.rng);
        let (shorter, seen) = ranks.ok_or("no point was found at which the rows exist")?;
        if self.rows.is_of_words() {
            let field = leaving_field(algebra, case);
            if let Some(field) = field {
                return Err(format!("the field {field} leaves it, so that longer words may add to the rank"));
            }
            if !self.rows.complete && (self.rows.order == 0 || shorter < seen) {
                return Err("longer words may add to the rank".to_owned());
            }
        }
        let entries: Vec<NodeId> = self.rows.rows.iter().flatten().copied().collect();
        let entries = algebra.in_chart(&case.chart, &entries);
        let entries = algebra.system.graph.substitute(&entries, &case.values);
        match generic_rank(&mut algebra.system.graph, &entries, self.rows.columns, |_| false, &mut self.rng) {
            GenericRank::Rank { rank, log2_error, .. } if rank < self.rank && rank == seen => Ok(log2_error),
            GenericRank::Rank { .. } => Err("the rank is no lower there".to_owned()),
            GenericRank::Pole(_) => Err("every state of it is a pole".to_owned()),
            GenericRank::Functions => Err("functions are met that are not rational".to_owned()),
            GenericRank::Unknown(why) => Err(why),
        }
    }
}

/// Whether an expression of a chart is divided by zero at all of its points.
fn is_pole(algebra: &Algebra<'_>, node: NodeId) -> bool {
    let program = Program::with_unknown_functions(&algebra.system.graph, &[node], |_| false);
    let mut rng = ChaCha8Rng::seed_from_u64(0x706f_6c65); // any fixed seed
    (0..4).all(|_| {
        let field = PrimeField::random(&mut rng);
        let inputs = draw_residues(&program, &field, &mut rng);
        match program.load(field).map(|loaded| loaded.run(&inputs, &mut Vec::new())) {
            Ok(Err(failure)) => failure.divisor.is_some(),
            _ => false,
        }
    })
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

/// What is known of a set.
enum Ranked {
    Full(Box<FullCase>),
    /// It is the union of these, and of one on which the rank is full.
    Unless(Vec<Case>, Box<FullCase>),
    Short(ShortCase),
    /// It is the union of these, and of one on which the rank is lower.
    Lower(Vec<Case>, ShortCase),
}
