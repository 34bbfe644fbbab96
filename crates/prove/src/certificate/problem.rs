//! What is to be proved on a box, from a system, its rows and its ranges.

use super::boxes::FreeCoordinate;
use super::choice::choose;
use super::collector::{Collector, Ranges};
use super::common_denominator::{CommonDenominatorRow, clear_denominators};
use super::domain::{Domain, domain};
use super::minors::minors as minors_of;
use super::part::{FactoredMinor, Part};
use super::rows::{HeldSymbol, NamedRows, RegionRows, WrittenRows, rows_by_name};
use dashu::rational::RBig;
use palmistry_lang::{Assignment, FieldRole, Kind, Range, System};
use palmistry_math::expression::{NodeId, Symbol, Variable, expand_angles};
use palmistry_math::number::{Interval, RealNumber, rational_to_f64};
use palmistry_rank::observability::{Reduction, vanishes};
use std::collections::{BTreeMap, HashMap};

/// A box and what is to be proved on it.
pub(super) struct Problem {
    pub file: String,
    pub title: String,
    /// The fields that move the states.
    pub fields: Vec<FieldRole>,
    pub dimension: usize,
    /// The number of columns in which the rows have to be independent, once unit rows are taken out with theirs.
    pub columns: usize,
    /// The number of rows, without unit rows.
    pub rows: usize,
    /// The highest order of the Lie derivatives.
    pub order: Option<usize>,
    /// All sides of the box, whether anything depends on them or not.
    pub ranges: Vec<FreeCoordinate>,
    /// The minors that are kept. Without any, nothing can be proved.
    pub minors: Vec<FactoredMinor>,
    /// The number of minors that were looked at, and whether these were all.
    pub candidates: usize,
    pub all_minors: bool,
    pub parts: Vec<Part>,
    /// The texts of what sampled states keep away from.
    pub avoid: Vec<String>,
    /// What could not be written as a product, and why.
    pub remarks: Vec<String>,
    /// Sides of the box that the file does not give.
    pub by_default: Vec<(String, Range)>,
    /// What would have to hold for the system and its rows to exist, and holds nowhere.
    pub nowhere: Vec<String>,
    /// The question as it was written, for those who check the answer.
    pub written: WrittenRows,
}

impl Problem {
    /// The question whether some rows of a system have full rank on a box: its sample box, with some ranges replaced.
    ///
    /// # Errors
    /// In words: no states or outputs, a pole everywhere, no rows of its own, a symbol without a range, an empty range.
    pub fn new(
        system: &mut System,
        rows: RegionRows,
        given: &BTreeMap<Symbol, (RBig, RBig)>,
    ) -> Result<Problem, String> {
        if system.unknown_count() == 0 || system.outputs.is_empty() {
            return Err(format!("{} declares no states or no outputs", system.name));
        }
        let RangesAndValues { mut ranges, values, exactly, by_default } = ranges_of(system, given)?;
        let is_angle = &system.angle_test();
        let dimension = system.unknown_count();
        let NamedRows { names, entries: flat, order } = NamedRows::of(system, rows, &values)?;
        let as_written = rows_by_name(&names, &flat, dimension);
        let flat = system.graph.substitute(&flat, &values);
        let flat = expand_angles(&mut system.graph, &flat, is_angle);
        add_later_values(system, &flat, &mut ranges);
        let block = Reduction::new(&system.graph, &flat, dimension);

        let mut collector = Collector::default();
        let mut remarks = Vec::new();
        let Domain { guards, nowhere, written } = domain(system, rows, &mut collector, &values);
        let mut ready = Vec::new();
        let columns = block.columns.len();
        for (row, entries) in block.rows.iter().zip(block.entries.chunks(columns.max(1))) {
            match clear_denominators(&mut collector.products, &system.graph, *row, entries, is_angle) {
                Ok((row, nodes)) => {
                    collector.note(&system.graph, &nodes);
                    ready.push(row);
                }
                Err(why) => remarks.push(format!("{} is left out: {why}", names[*row])),
            }
        }
        ready.sort_by_key(CommonDenominatorRow::length); // stable: rows of one length stay in order
        let split = minors_of(&collector.products, &ready, columns, &mut collector.known);
        let mut minors = Vec::new();
        // to polynomials a root is an unknown of its own, and what is zero by its square is no zero to them
        let has_unknowns =
            collector.products.variables().iter().any(|variable| matches!(variable, Variable::Unknown(_)));
        let mut vanishing: HashMap<usize, bool> = HashMap::new();
        for minor in &split.found {
            let rows = minor.rows.iter().map(|row| names[ready[*row].row].clone()).collect();
            let graph = &mut system.graph;
            let mut factors: Vec<usize> =
                minor.factors.iter().map(|factor| collector.polynomial(graph, factor)).collect();
            let below = minor.below.iter().map(|factor| collector.polynomial(graph, factor)).collect();
            for place in &minor.half_cosines {
                let node = collector.products.half_cosine(graph, *place);
                factors.extend(node.map(|node| collector.expression(node)));
            }
            let mut is_zero = |place: &usize| {
                let node = collector.node(*place);
                *vanishing.entry(*place).or_insert_with(|| vanishes(system, node))
            };
            if has_unknowns && factors.iter().any(&mut is_zero) {
                continue;
            }
            let places = minor.rows.iter().map(|row| ready[*row].row).collect();
            minors.push(FactoredMinor { rows, places, factors, below });
        }
        let mut avoid = Vec::new();
        for (text, node) in system.avoid.clone() {
            let node = system.graph.substitute(&[node], &values);
            let node = expand_angles(&mut system.graph, &node, is_angle)[0];
            if !ranges.coordinates_of(&system.graph, node).is_empty() {
                avoid.push((text, node));
            }
        }
        let (avoid, avoided): (Vec<String>, Vec<NodeId>) = avoid.into_iter().unzip();
        let candidates = minors.len();
        if !nowhere.is_empty() {
            minors.clear(); // where nothing exists nothing has a rank
        }
        let (minors, parts) = choose(&system.graph, &collector, &ranges, &guards, minors, &avoided)?;
        Ok(Problem {
            file: system.name.clone(),
            title: system.title.clone(),
            fields: system.roles(),
            dimension,
            columns,
            rows: block.rows.len(),
            order,
            ranges: ranges.free,
            minors,
            candidates,
            all_minors: split.complete && remarks.is_empty(),
            parts,
            avoid,
            remarks,
            by_default,
            nowhere,
            written: WrittenRows {
                rows: as_written,
                unit_rows: block.unit_rows,
                guards: written,
                held: exactly,
            },
        })
    }
}

/// Where the symbols are.
struct RangesAndValues {
    ranges: Ranges,
    /// The values that can be put in.
    values: Assignment,
    /// All symbols that are fixed.
    exactly: Vec<HeldSymbol>,
    /// Ranges that the file does not give and that are taken by default.
    by_default: Vec<(String, Range)>,
}

/// Known signals lie at every step where they do at the first.
fn add_later_values(system: &System, entries: &[NodeId], ranges: &mut Ranges) {
    let mut later: Vec<Symbol> = system.graph.symbols_of(entries.iter().copied()).into_iter().collect();
    later.retain(|symbol| system.now(*symbol) != *symbol);
    later.sort_unstable();
    for symbol in later {
        let now = system.now(symbol);
        let name = system.symbol_name(symbol).to_owned();
        if let Some(found) = ranges.free.iter().find(|range| range.symbol == now).cloned() {
            ranges.free.push(FreeCoordinate { symbol, name, ..found });
        } else if let Some(held) = ranges.held.get(&now).cloned() {
            ranges.held.insert(symbol, held);
        }
    }
}

/// The sides of the box, what the other symbols are, and which of these can be put in exactly.
fn ranges_of(system: &mut System, given: &BTreeMap<Symbol, (RBig, RBig)>) -> Result<RangesAndValues, String> {
    let (mut exactly, mut by_default) = (Vec::new(), Vec::new());
    let mut found = Ranges { free: Vec::new(), held: Default::default() };
    let mut values = Vec::new();
    if let Some(open) = system.initial_value_without_a_number() {
        return Err(format!(
            "'{open}' has an initial condition that is no number: give the parameters in it numbers there"
        ));
    }
    let without = system.without_range();
    // sides are taken by default, and no box of which nobody has said anything
    let somebody_said = !given.is_empty() || system.symbols().any(|(_, info)| info.range.is_some());
    for (symbol, info) in system.symbols().filter(|(_, info)| info.kind != Kind::Imported) {
        let range = info.range.as_ref().map(|range| (range.low.clone(), range.high.clone()));
        let value = info.default.as_ref().map(|value| (value.clone(), value.clone()));
        let default = match somebody_said && without.contains(&symbol) && !given.contains_key(&symbol) {
            true => system.default_range(symbol),
            false => None,
        };
        by_default.extend(default.iter().map(|range| (system.symbol_name(symbol).to_owned(), range.clone())));
        let default = default.map(|range| (range.low, range.high));
        let Some((low, high)) = given.get(&symbol).cloned().or(range).or(value).or(default) else { continue };
        let name = system.symbol_name(symbol).to_owned();
        if low == high {
            exactly.push(HeldSymbol { symbol, value: low.clone() });
        }
        if low > high {
            return Err(format!("the range of '{name}' is empty: {low} is above {high}"));
        }
        if low < high {
            found.free.push(FreeCoordinate { symbol, name, low, high });
        } else if info.is_angle && !low.is_zero() {
            found.held.insert(symbol, held_angle(&low));
        } else {
            found.held.insert(symbol, Interval::from_rational(&low));
            values.push((symbol, low));
        }
    }
    let values = values.into_iter().map(|(symbol, value)| (symbol, system.graph.rational(value))).collect();
    Ok(RangesAndValues { ranges: found, values, exactly, by_default })
}

/// A fixed angle, with room for the difference from the exact states of [`Locus`](palmistry_rank::observability::Locus):
/// they have the double nearest to the tangent of its half.
fn held_angle(value: &RBig) -> Interval {
    let slack = 8.0 * f64::EPSILON * rational_to_f64(value).abs().max(1.0);
    Interval::from_rational(value) + Interval::new(-slack, slack)
}
