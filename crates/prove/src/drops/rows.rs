//! The rows whose rank is asked for: a matrix of the file, or the differentials of Lie derivatives of higher and higher order,
//! which are taken as they are needed. They are taken by all coordinates that move, the unknown ones first: whether higher
//! orders add nothing is asked of all columns ([`RankGrowth`]), and the rank of the unknown ones.

use super::algebra::{Algebra, Chart};
use super::point::{Point, run};
use palmistry_lang::System;
use palmistry_math::expression::{Graph, NodeId, Program, Symbol, gradient};
use palmistry_math::number::PrimeField;
use palmistry_rank::observability::{Codistribution, Length, LieDerivative, RankGrowth, independent_rows};
use rand::Rng;
use std::collections::HashMap;

/// Rows of as many entries as the span is taken by.
pub(super) struct Rows {
    /// The columns whose rank is asked for; they are the first.
    pub columns: usize,
    /// All columns: for Lie derivatives those of known initial conditions too.
    pub width: usize,
    /// The coordinates that Lie derivatives are differentiated by, in the order of the columns.
    by: Vec<Symbol>,
    /// What each row is of, as a paper writes it.
    pub names: Vec<String>,
    pub rows: Vec<Vec<NodeId>>,
    /// The same as the file has them, by its states.
    written: Vec<Vec<NodeId>>,
    /// The order of the Lie derivative of each row.
    orders: Vec<usize>,
    /// By how many nodes each is made of: short ones are taken first.
    costs: Vec<usize>,
    /// The Lie derivatives of the highest order and their values; empty where the rows are all that there are.
    last: Vec<(LieDerivative, NodeId)>,
    pub order: usize,
    grows: bool,
    /// Whether no Lie derivative of higher order has a differential that is not zero.
    pub complete: bool,
    programs: HashMap<Chart, (usize, Program)>,
}

/// The order is at most the number of columns plus this, and the number of rows is bounded.
const MORE_FIELDS: usize = 2;
const MOST_WORDS: usize = 300;

/// Rows and columns of a minor.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Chosen {
    pub rows: Vec<usize>,
    pub columns: Vec<usize>,
}

impl Rows {
    /// A matrix of the file, by rows.
    pub fn of_matrix(graph: &Graph, entries: &[NodeId], columns: usize) -> Rows {
        let rows: Vec<Vec<NodeId>> = entries.chunks(columns.max(1)).map(<[NodeId]>::to_vec).collect();
        let costs = rows.iter().map(|row| cost(graph, row)).collect();
        let names = (1..=rows.len()).map(|n| format!("row {n}")).collect();
        let orders = vec![0; rows.len()];
        let (last, programs, written) = (Vec::new(), HashMap::new(), Vec::new());
        Rows {
            columns,
            width: columns,
            by: Vec::new(),
            names,
            rows,
            written,
            orders,
            costs,
            last,
            order: 0,
            grows: false,
            complete: true,
            programs,
        }
    }

    /// The differentials of the outputs, and what comes of them.
    pub fn of_lie_derivatives(system: &mut System) -> Rows {
        let last: Vec<(LieDerivative, NodeId)> = (0..system.outputs.len())
            .map(|output| (LieDerivative { fields: Vec::new(), output }, system.outputs[output].1))
            .collect();
        let mut by = system.unknowns();
        let columns = by.len();
        by.extend(system.closed_coordinates().into_iter().filter(|symbol| system.known.contains(symbol)));
        let mut rows = Rows {
            columns,
            width: by.len(),
            by,
            names: Vec::new(),
            rows: Vec::new(),
            written: Vec::new(),
            orders: Vec::new(),
            costs: Vec::new(),
            last: Vec::new(),
            order: 0,
            grows: true,
            complete: false,
            programs: HashMap::new(),
        };
        rows.add(system, last);
        rows.rows = rows.written.clone();
        rows
    }

    /// The rows in the coordinates of an algebra, all of them: called when the coordinates have changed.
    pub fn prepare(&mut self, algebra: &mut Algebra<'_>) {
        self.rows.clear();
        self.programs.clear();
        self.catch_up(algebra);
    }

    fn catch_up(&mut self, algebra: &mut Algebra<'_>) {
        let coordinates = algebra.coordinates.clone();
        for row in self.written.get(self.rows.len()..).unwrap_or_default() {
            self.rows.push(coordinates.row(algebra.system, &self.by, row));
        }
    }

    /// The columns whose rank is asked for of some rows, as the file has them, one row after the other.
    pub fn as_written(&self, rows: impl IntoIterator<Item = usize>) -> Vec<NodeId> {
        let all = if self.grows { &self.written } else { &self.rows };
        rows.into_iter().flat_map(|row| all[row][..self.columns].iter().copied()).collect()
    }

    /// The numbers of columns whose rank has to be examined, one after the other: all columns, by which it is known whether higher
    /// orders add to the rank, and then those whose rank is asked for.
    pub fn spans(&self) -> Vec<usize> {
        match self.complete || self.width == self.columns {
            true => vec![self.columns],
            false => vec![self.width, self.columns],
        }
    }

    /// Whether Lie derivatives of higher order can be taken.
    pub fn is_of_lie_derivatives(&self) -> bool {
        self.grows
    }

    fn add(&mut self, system: &mut System, words: Vec<(LieDerivative, NodeId)>) {
        for (word, value) in &words {
            let row = gradient(&mut system.graph, *value, &self.by);
            if row.iter().all(|entry| system.graph.constant_value(*entry).is_some_and(|c| c.is_zero())) {
                continue;
            }
            self.names.push(word.text(system));
            self.costs.push(cost(&system.graph, &row));
            self.orders.push(word.fields.len());
            self.written.push(row);
        }
        self.last = words;
    }

    /// Takes Lie derivatives of one order more; whether there were any.
    pub fn extend(&mut self, algebra: &mut Algebra<'_>) -> bool {
        let longer = self.longer(algebra.system);
        self.catch_up(algebra);
        longer
    }

    fn longer(&mut self, system: &mut System) -> bool {
        let fields = system.moving_fields();
        let next = self.rows.len() + self.last.len() * fields.len();
        if !self.grows || self.order >= self.width + MORE_FIELDS || next > MOST_WORDS {
            return false;
        }
        let mut longer = Vec::new();
        for field in fields {
            for (word, value) in &self.last {
                let derivative = system.lie_derivative(field, *value);
                if system.graph.constant_value(derivative).is_none() {
                    let mut fields = vec![field];
                    fields.extend_from_slice(&word.fields);
                    longer.push((LieDerivative { fields, output: word.output }, derivative));
                }
            }
        }
        if longer.is_empty() {
            self.complete = true;
            return false;
        }
        self.order += 1;
        self.add(system, longer);
        true
    }

    /// Rows and columns that are independent at a point, of Lie derivatives below the highest order, unless these are all; among the
    /// first so many columns.
    pub fn shortest(
        &mut self,
        algebra: &mut Algebra<'_>,
        chart: &Chart,
        (point, columns): (&Point, usize),
        rng: &mut impl Rng,
    ) -> Option<Chosen> {
        let matrix = self.at(algebra, chart, point, rng)?;
        let counts = |row: &usize| self.complete || self.orders[*row] < self.order;
        let order: Vec<usize> = (0..matrix.len()).filter(counts).collect();
        choose(&point.field, &matrix, &order, columns, columns)
    }

    /// The rank at a point; and how the rank of all columns has grown with the highest order.
    pub fn ranks(
        &mut self,
        algebra: &mut Algebra<'_>,
        chart: &Chart,
        point: &Point,
        rng: &mut impl Rng,
    ) -> Option<(usize, RankGrowth)> {
        let matrix = self.at(algebra, chart, point, rng)?;
        let order: Vec<usize> = (0..matrix.len()).collect();
        let shorter: Vec<usize> =
            order.iter().copied().filter(|row| self.orders[*row] < self.order).collect();
        let rank = |rows: &[usize], columns: usize| {
            choose(&point.field, &matrix, rows, columns, columns).map(|chosen| chosen.rows.len())
        };
        let growth = RankGrowth {
            order: self.order,
            below: rank(&shorter, self.width)?,
            up_to: rank(&order, self.width)?,
        };
        Some((rank(&order, self.columns)?, growth))
    }

    /// Whether no higher order adds to the rank where no field leaves the set on which its rows have grown so.
    pub fn have_rested(&self, growth: RankGrowth) -> bool {
        self.complete || growth.has_ended()
    }

    /// Rows and columns, at most so many, that are independent at a point: for each way to prefer rows.
    pub fn independent(
        &mut self,
        algebra: &mut Algebra<'_>,
        chart: &Chart,
        point: &Point,
        most: usize,
        rng: &mut impl Rng,
    ) -> Option<Vec<Chosen>> {
        let matrix = self.at(algebra, chart, point, rng)?;
        let mut cheap: Vec<usize> = (0..matrix.len()).collect();
        cheap.sort_by_key(|row| self.costs[*row]);
        let mut found: Vec<Chosen> = Vec::new();
        for order in [cheap, (0..matrix.len()).collect()] {
            let chosen = choose(&point.field, &matrix, &order, most, self.columns)?;
            if !found.contains(&chosen) {
                found.push(chosen);
            }
        }
        Some(found)
    }

    fn at(
        &mut self,
        algebra: &mut Algebra<'_>,
        chart: &Chart,
        point: &Point,
        rng: &mut impl Rng,
    ) -> Option<Vec<Vec<u64>>> {
        if self.programs.get(chart).is_none_or(|(count, _)| *count != self.rows.len()) {
            let entries: Vec<NodeId> = self.rows.iter().flatten().copied().collect();
            let entries = algebra.in_chart(chart, &entries);
            let program = Program::with_unknown_functions(&algebra.system.graph, &entries, |_| false);
            self.programs.insert(chart.clone(), (self.rows.len(), program));
        }
        let values = run(&self.programs.get(chart)?.1, point, rng)?;
        Some(values.chunks(self.width.max(1)).map(<[u64]>::to_vec).collect())
    }
}

/// The rows of Lie derivatives, with their names, until some of them have a rank at almost all states, and of one order
/// more.
pub(crate) fn rows_up_to(system: &mut System, rank: usize) -> (Vec<String>, Vec<NodeId>) {
    let fields = Codistribution::new(system, &Default::default(), Length::UntilItStops);
    let order = fields.map_or(0, |words| if words.generic_rank() >= rank { words.order } else { 0 });
    let mut rows = Rows::of_lie_derivatives(system);
    while rows.order <= order && rows.longer(system) {}
    let is_zero = |entry: &NodeId| system.graph.constant_value(*entry).is_some_and(|c| c.is_zero());
    let counts = |row: &usize| !rows.written[*row][..rows.columns].iter().all(is_zero);
    let kept: Vec<usize> = (0..rows.written.len()).filter(counts).collect();
    (kept.iter().map(|row| rows.names[*row].clone()).collect(), rows.as_written(kept))
}

fn cost(graph: &Graph, row: &[NodeId]) -> usize {
    graph.reachable(row.iter().copied()).len()
}

fn choose(
    field: &PrimeField,
    matrix: &[Vec<u64>],
    order: &[usize],
    most: usize,
    columns: usize,
) -> Option<Chosen> {
    let ordered: Vec<Vec<u64>> = order.iter().map(|row| matrix[*row][..columns].to_vec()).collect();
    let mut places = independent_rows(field, &ordered).ok()?;
    places.truncate(most);
    let mut rows: Vec<usize> = places.into_iter().map(|place| order[place]).collect();
    rows.sort_unstable();
    let transposed: Vec<Vec<u64>> =
        (0..columns).map(|column| rows.iter().map(|row| matrix[*row][column]).collect()).collect();
    let columns = independent_rows(field, &transposed).ok()?;
    Some(Chosen { rows, columns })
}
