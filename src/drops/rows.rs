//! The rows whose rank is asked for: a matrix of the file, or the differentials of Lie derivatives along longer and longer
//! words, which are taken as they are needed.

use super::algebra::{Algebra, Chart};
use super::point::{Point, run};
use crate::expression::{Graph, NodeId, Program};
use crate::number::PrimeField;
use crate::observability::{Codistribution, Length, Word, independent_rows};
use crate::system::System;
use rand::Rng;
use std::collections::HashMap;

/// Rows of as many entries as there are columns.
pub(super) struct Rows {
    pub columns: usize,
    /// What each row is of, as a paper writes it.
    pub names: Vec<String>,
    pub rows: Vec<Vec<NodeId>>,
    /// The same as the file has them, by its states.
    written: Vec<Vec<NodeId>>,
    /// How many fields the word of each has.
    orders: Vec<usize>,
    /// By how many nodes each is made of: short ones are taken first.
    costs: Vec<usize>,
    /// The longest words and their values; none where the rows are all that there are.
    last: Vec<(Word, NodeId)>,
    pub order: usize,
    grows: bool,
    /// Whether no longer word has a differential that is not zero.
    pub complete: bool,
    programs: HashMap<Chart, (usize, Program)>,
}

/// Words have at most so many fields more than there are states, and no more of them are taken.
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
    pub fn of_words(system: &mut System) -> Rows {
        let last: Vec<(Word, NodeId)> = (0..system.outputs.len())
            .map(|output| (Word { fields: Vec::new(), output }, system.outputs[output].1))
            .collect();
        let mut rows = Rows {
            columns: system.unknown_count(),
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

    /// The rows in the coordinates of an algebra, those of words that were added since the last time; all of them where the
    /// coordinates were changed.
    pub fn prepare(&mut self, algebra: &mut Algebra<'_>) {
        self.rows.clear();
        self.programs.clear();
        self.catch_up(algebra);
    }

    fn catch_up(&mut self, algebra: &mut Algebra<'_>) {
        let coordinates = algebra.coordinates.clone();
        for row in self.written.get(self.rows.len()..).unwrap_or_default() {
            self.rows.push(coordinates.row(algebra.system, row));
        }
    }

    /// The rows as the file has them.
    pub fn as_written(&self) -> &[Vec<NodeId>] {
        if self.grows { &self.written } else { &self.rows }
    }

    /// Whether longer words can be taken.
    pub fn is_of_words(&self) -> bool {
        self.grows
    }

    fn add(&mut self, system: &mut System, words: Vec<(Word, NodeId)>) {
        for (word, value) in &words {
            let row = system.differential(*value);
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

    /// Takes words of one field more; whether there were any.
    pub fn extend(&mut self, algebra: &mut Algebra<'_>) -> bool {
        let longer = self.longer(algebra.system);
        self.catch_up(algebra);
        longer
    }

    fn longer(&mut self, system: &mut System) -> bool {
        let fields = system.moving_fields();
        let next = self.rows.len() + self.last.len() * fields.len();
        if !self.grows || self.order >= self.columns + MORE_FIELDS || next > MOST_WORDS {
            return false;
        }
        let mut longer = Vec::new();
        for field in fields {
            for (word, value) in &self.last {
                let derivative = system.lie_derivative(field, *value);
                if system.graph.constant_value(derivative).is_none() {
                    let mut fields = vec![field];
                    fields.extend_from_slice(&word.fields);
                    longer.push((Word { fields, output: word.output }, derivative));
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

    /// Rows and columns that are independent at a point, of words that are shorter than the longest, unless these are all.
    pub fn shortest(
        &mut self,
        algebra: &mut Algebra<'_>,
        chart: &Chart,
        point: &Point,
        rng: &mut impl Rng,
    ) -> Option<Chosen> {
        let matrix = self.at(algebra, chart, point, rng)?;
        let counts = |row: &usize| self.complete || self.orders[*row] < self.order;
        let order: Vec<usize> = (0..matrix.len()).filter(counts).collect();
        choose(&point.field, &matrix, &order, self.columns, self.columns)
    }

    /// The rank at a point, of the words that are shorter than the longest, and of all.
    pub fn ranks(
        &mut self,
        algebra: &mut Algebra<'_>,
        chart: &Chart,
        point: &Point,
        rng: &mut impl Rng,
    ) -> Option<(usize, usize)> {
        let matrix = self.at(algebra, chart, point, rng)?;
        let order: Vec<usize> = (0..matrix.len()).collect();
        let shorter: Vec<usize> =
            order.iter().copied().filter(|row| self.orders[*row] < self.order).collect();
        let rank = |rows: &[usize]| {
            choose(&point.field, &matrix, rows, self.columns, self.columns).map(|chosen| chosen.rows.len())
        };
        Some((rank(&shorter)?, rank(&order)?))
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
        Some(values.chunks(self.columns.max(1)).map(<[u64]>::to_vec).collect())
    }
}

/// The rows of words, by name and one after the other, until some of them have a rank at almost all states, and of one field
/// more.
pub(crate) fn rows_up_to(system: &mut System, rank: usize) -> (Vec<String>, Vec<NodeId>) {
    let fields = Codistribution::new(system, &Default::default(), Length::UntilItStops);
    let order = fields.map_or(0, |words| if words.generic_rank() >= rank { words.order } else { 0 });
    let mut rows = Rows::of_words(system);
    while rows.order <= order && rows.longer(system) {}
    (rows.names, rows.written.into_iter().flatten().collect())
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
    let ordered: Vec<Vec<u64>> = order.iter().map(|row| matrix[*row].clone()).collect();
    let mut places = independent_rows(field, &ordered).ok()?;
    places.truncate(most);
    let mut rows: Vec<usize> = places.into_iter().map(|place| order[place]).collect();
    rows.sort_unstable();
    let transposed: Vec<Vec<u64>> =
        (0..columns).map(|column| rows.iter().map(|row| matrix[*row][column]).collect()).collect();
    let columns = independent_rows(field, &transposed).ok()?;
    Some(Chosen { rows, columns })
}
