//! Rows made ready for minors: each over its common denominator, so that polynomials remain.

use palmistry_math::expression::{Graph, NodeFractions, NodeId, Products, Symbol};
use palmistry_math::number::Factors;
use palmistry_math::number::polynomial::{Polynomial, Ring};

/// A row over its common denominator.
pub(super) struct CommonDenominatorRow {
    /// Its place among all rows.
    pub row: usize,
    /// What all its entries have above the bar, and what stands below it.
    pub above: Factors,
    pub below: Factors,
    /// The rest, by columns.
    pub entries: Vec<Polynomial>,
}

impl CommonDenominatorRow {
    /// The number of monomials.
    pub fn length(&self) -> usize {
        self.entries.iter().map(Polynomial::len).sum()
    }
}

/// Brings a row to its common denominator; with it come all nodes that it needs.
///
/// # Errors
/// In words, where its entries are no rational expressions or too long.
pub(super) fn clear_denominators(
    products: &mut Products,
    graph: &Graph,
    row: usize,
    entries: &[NodeId],
    is_angle: impl Fn(Symbol) -> bool,
) -> Result<(CommonDenominatorRow, NodeFractions), String> {
    let (values, nodes) = products.read(graph, entries, is_angle)?;
    let fractions = products.fractions();
    let is_zero = |top: &Factors| top.keys().any(|place| fractions.factor(*place).is_zero());
    let mut above: Option<Factors> = None;
    let mut below = Factors::new();
    for value in values.iter().filter(|value| !is_zero(&value.top)) {
        above = Some(match above {
            None => value.top.clone(),
            Some(common) => common
                .iter()
                .filter_map(|(place, power)| value.top.get(place).map(|other| (*place, *power.min(other))))
                .collect(),
        });
        for (place, power) in &value.bottom {
            let most = below.entry(*place).or_insert(0);
            *most = (*most).max(*power);
        }
    }
    let above = above.unwrap_or_default();
    let without = |from: &Factors, what: &Factors| -> Factors {
        let less = |(place, power): (&u32, &u32)| (*place, power - what.get(place).unwrap_or(&0).min(power));
        from.iter().map(less).filter(|(_, power)| *power > 0).collect()
    };
    let mut numerators = Vec::new();
    for value in &values {
        if is_zero(&value.top) {
            numerators.push(Polynomial::default());
            continue;
        }
        let mut top = without(&value.top, &above);
        for (place, power) in without(&below, &value.bottom) {
            *top.entry(place).or_insert(0) += power;
        }
        numerators.push(fractions.expand(&top).map_err(|refusal| refusal.to_string())?);
    }
    Ok((CommonDenominatorRow { row, above, below, entries: numerators }, nodes))
}
