//! All states, divided into sets on each of which the rank is known.

use super::algebra::{Algebra, Chart, Reach};
use super::case::{Case, Step};
use super::minor::Product;
use super::point::{Point, draw};
use super::rows::{Chosen, Rows};
use palmistry_math::expression::{Guard, Need, NodeId, Program, Symbol, draw_residues};
use palmistry_math::number::PrimeField;
use palmistry_math::number::polynomial::Polynomial;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::sync::atomic::{AtomicBool, Ordering};

/// No more cases are looked at.
const MOST_CASES: usize = 3_000;
/// No more cases of a set are followed to find out whether all of it has one rank.
const MOST_FOLLOWED: usize = 40;
/// Nor are minors looked for on more of them.
const MOST_TRIED: usize = 4;
/// At most this many of the remaining ones are reported.
const MOST_LEFT: usize = 60;

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
    /// Where it is known to be lower, a rank that none of its states exceeds, whatever rows are taken; else that at almost all of
    /// its states, by the rows that were taken.
    pub rank: usize,
    /// A bound on the probability that the rank is lower than asked by an error, as a power of two; why it is not known to be
    /// lower, where it is not.
    pub lower: Result<f64, String>,
}

/// A rank that no state of a set exceeds, and a bound on the probability of an error, as a power of two.
#[derive(Clone, Copy, Debug)]
pub struct ShortRank {
    pub rank: usize,
    pub log2_error: f64,
}

impl ShortCase {
    /// A set on which the rows that were taken have some rank, and what is known of all rows.
    pub fn new(case: &Case, rank: usize, lower: Result<ShortRank, String>) -> ShortCase {
        let rank = lower.as_ref().map_or(rank, |bound| bound.rank);
        ShortCase { case: case.clone(), rank, lower: lower.map(|bound| bound.log2_error) }
    }
}

/// What all states come to.
#[derive(Default)]
pub(super) struct Explored {
    pub full: Vec<FullCase>,
    pub short: Vec<ShortCase>,
    /// How many sets were found empty.
    pub empty: usize,
    pub cases: usize,
    /// Why it ended before all sets were looked at; those that were left are among the short ones then.
    pub stopped: Option<String>,
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

/// Is called for each set on which the rank is lower, when it is found.
pub(super) type Tell<'a> = dyn FnMut(&mut Algebra<'_>, &mut Search<'_>, &ShortCase) + 'a;

impl Search<'_> {
    /// Follows all states to where their rank is known.
    ///
    /// # Errors
    /// In words, where something is out of reach.
    pub fn run(&mut self, algebra: &mut Algebra<'_>) -> Reach<Explored> {
        self.run_telling(algebra, &mut |_, _, _| ())
    }

    /// The same, and reports what it finds; random numbers drawn by `tell` change nothing.
    ///
    /// # Errors
    /// In words, where something is out of reach.
    pub fn run_telling(&mut self, algebra: &mut Algebra<'_>, tell: &mut Tell<'_>) -> Reach<Explored> {
        let charts = algebra.charts().ok_or("there are too many angles")?;
        let mut found = Explored::default();
        for chart in charts {
            self.chart(algebra, &chart, &mut found, tell)?;
        }
        Ok(found)
    }

    /// The states of a chart at which the rows are defined; none where that is nowhere.
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
                Need::Positive => match ratio.signed() {
                    Some(polynomial) => case.add_positive(&polynomial),
                    None => ratio.top.iter().for_each(|(factor, _)| case.add_nonzero(factor)),
                },
                // a case may be larger than the set that it stands for: more is proved then than is needed
                Need::NotNegative => case.not_negative.extend(ratio.signed()),
                Need::WithinOne | Need::InsideOne => case.not_negative.extend(ratio.below_one()),
            }
        }
        Ok(Some(case))
    }

    /// The states of a chart that are asked for, their equations not yet met; none where the rows exist nowhere.
    fn asked_for(&self, algebra: &mut Algebra<'_>, chart: &Chart) -> Reach<Option<Case>> {
        let Some(mut case) = self.domain(algebra, chart)? else { return Ok(None) };
        for node in &self.nonzero {
            let node = algebra.in_chart(chart, &[*node])[0];
            let polynomial = algebra.numerator(node)?;
            case.add_nonzero(&polynomial);
        }
        for node in &self.conditions {
            let node = algebra.in_chart(chart, &[*node])[0];
            let polynomial = algebra.numerator(node)?;
            case = case.with_zero(&polynomial);
        }
        Ok(Some(case))
    }

    /// All states that are asked for, as cases whose equations are met.
    ///
    /// # Errors
    /// In words, where an equation is out of reach.
    pub(super) fn all_cases(&self, algebra: &mut Algebra<'_>) -> Reach<Vec<Case>> {
        let mut found = Vec::new();
        for chart in algebra.charts().ok_or("there are too many angles")? {
            if let Some(case) = self.asked_for(algebra, &chart)? {
                found.extend(case.all_ready(algebra)?);
            }
        }
        Ok(found)
    }

    fn chart(
        &mut self,
        algebra: &mut Algebra<'_>,
        chart: &Chart,
        found: &mut Explored,
        tell: &mut Tell<'_>,
    ) -> Reach<()> {
        let Some(case) = self.asked_for(algebra, chart)? else {
            found.empty += 1;
            return Ok(());
        };
        let mut open = vec![case];
        while let Some(case) = open.pop() {
            if found.stopped.is_none() && found.cases >= MOST_CASES {
                found.stopped = Some(format!("there are more than {MOST_CASES} cases"));
            }
            if found.stopped.is_none() && self.interrupt.load(Ordering::Relaxed) {
                found.stopped = Some("it was interrupted".to_owned());
            }
            if let Some(why) = &found.stopped {
                if found.short.iter().filter(|short| short.lower.is_err()).count() < MOST_LEFT {
                    found.short.push(ShortCase { case, rank: 0, lower: Err(why.clone()) });
                }
                continue;
            }
            found.cases += 1;
            match case.clone().step(algebra) {
                Ok(Step::Empty) => found.empty += 1,
                Ok(Step::Split(cases)) => open.extend(cases.into_iter().rev()),
                Ok(Step::Ready(case)) => match self.rank_on(algebra, &case) {
                    Ok(Ranked::Full(full)) => found.full.push(*full),
                    Ok(Ranked::Unless(cases, full)) => {
                        found.full.push(*full);
                        open.extend(cases.into_iter().rev());
                    }
                    Ok(Ranked::Short(short)) => {
                        self.told(algebra, &short, tell);
                        found.short.push(short);
                    }
                    Ok(Ranked::Lower(cases, short)) => {
                        self.told(algebra, &short, tell);
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

    fn told(&mut self, algebra: &mut Algebra<'_>, short: &ShortCase, tell: &mut Tell<'_>) {
        if short.lower.is_ok() {
            let rng = self.rng.clone();
            tell(algebra, self, short);
            self.rng = rng;
        }
    }

    /// The rank on a set whose equations are all met.
    pub(super) fn rank_on(&mut self, algebra: &mut Algebra<'_>, case: &Case) -> Reach<Ranked> {
        loop {
            let point = self.point(algebra, case)?;
            let chosen = self.rows.independent(algebra, &case.chart, &point, self.rank, &mut self.rng);
            let chosen = chosen.ok_or("no point was found at which the rows are defined")?;
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
                && let Some(bound) = self.lower_around(algebra, case)
            {
                lower = Ok(bound);
            }
            if lower.is_ok() || !self.rows.extend(algebra) {
                return Ok(Ranked::Short(ShortCase::new(case, rank, lower)));
            }
        }
    }

    /// Whether the rows that were taken have some rank at all states of a set, as far as a few cases show it.
    pub(super) fn is_no_lower(&mut self, algebra: &mut Algebra<'_>, case: Case, rank: usize) -> bool {
        let asked = std::mem::replace(&mut self.rank, rank);
        let found = self.has_minors(algebra, case);
        self.rank = asked;
        found.is_ok_and(|found| found)
    }

    fn has_minors(&mut self, algebra: &mut Algebra<'_>, case: Case) -> Reach<bool> {
        let (mut open, mut tried) = (vec![case], 0);
        for _ in 0..MOST_FOLLOWED {
            let Some(case) = open.pop() else { return Ok(true) };
            let case = match case.step(algebra)? {
                Step::Empty => continue,
                Step::Split(cases) => {
                    open.extend(cases);
                    continue;
                }
                Step::Ready(case) => case,
            };
            if tried == MOST_TRIED {
                break;
            }
            tried += 1;
            let point = self.point(algebra, &case)?;
            let chosen = self.rows.independent(algebra, &case.chart, &point, self.rank, &mut self.rng);
            match self.minor_on(algebra, &case, &chosen.unwrap_or_default())? {
                Some(Ranked::Full(_)) => {}
                Some(Ranked::Unless(cases, _)) => open.extend(cases),
                _ => return Ok(false),
            }
        }
        Ok(false)
    }

    pub(super) fn point(&mut self, algebra: &mut Algebra<'_>, case: &Case) -> Reach<Point> {
        let entries: Vec<NodeId> = self.rows.rows.iter().flatten().copied().collect();
        let entries = algebra.in_chart(&case.chart, &entries);
        let mut symbols: Vec<Symbol> = algebra.system.graph.symbols_of(entries);
        for variable in algebra.variables() {
            if let palmistry_math::expression::Variable::Plain(symbol) = variable
                && !symbols.contains(symbol)
            {
                symbols.push(*symbol);
            }
        }
        symbols.sort_unstable();
        draw(algebra, case, &symbols, &mut self.rng)
            .ok_or_else(|| "no point of it was found modulo a prime".to_owned())
    }
}

/// Whether an expression of a chart is divided by zero at all of its points.
pub(super) fn is_pole(algebra: &Algebra<'_>, node: NodeId) -> bool {
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

/// What is known of a set.
pub(super) enum Ranked {
    Full(Box<FullCase>),
    /// It is the union of these, and of one on which the rank is full.
    Unless(Vec<Case>, Box<FullCase>),
    Short(ShortCase),
    /// It is the union of these, and of one on which the rank is lower.
    Lower(Vec<Case>, ShortCase),
}
