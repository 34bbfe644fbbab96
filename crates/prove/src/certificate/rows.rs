//! The rows of a question: which are asked for, what they are called, and how they stood before anything was put in.

use dashu::rational::RBig;
use palmistry_lang::{Assignment, System, Value};
use palmistry_math::expression::{Guard, NodeId, Symbol};
use palmistry_rank::observability::{Codistribution, Length, OWN_ROWS, Stop};

/// Which rows are to have full rank.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RegionRows {
    /// The full codistribution, with Lie derivatives up to this order. `None` takes one order more than the generic
    /// rank needs, if these are not too many: where all minors of the lower orders vanish, higher ones may not.
    Codistribution(Option<usize>),
    /// The file's own choice of rows.
    Own,
}

impl Default for RegionRows {
    /// The full codistribution, with Lie derivatives of as high an order as is needed.
    fn default() -> Self {
        RegionRows::Codistribution(None)
    }
}

/// A row of the matrix that is to have full rank.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RegionRow {
    /// The Lie derivative as text, or the number of the file's own row.
    pub name: String,
    /// The entries, one for each state.
    pub entries: Vec<NodeId>,
}

/// A symbol that is fixed at one value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HeldSymbol {
    /// The symbol.
    pub symbol: Symbol,
    /// Its value.
    pub value: RBig,
}

/// A question as it was written, before anything was put in or cancelled.
pub(super) struct WrittenRows {
    pub rows: Vec<RegionRow>,
    /// Rows with one entry only, a constant: every minor has these.
    pub unit_rows: Vec<usize>,
    pub guards: Vec<Guard>,
    pub held: Vec<HeldSymbol>,
}

/// More Lie derivatives than this are not taken unless an order is asked for.
const MOST_LIE_DERIVATIVES: usize = 80;

/// The rows with their names.
pub(super) fn rows_by_name(names: &[String], entries: &[NodeId], dimension: usize) -> Vec<RegionRow> {
    let rows = entries.chunks(dimension).zip(names);
    rows.map(|(entries, name)| RegionRow { name: name.clone(), entries: entries.to_vec() }).collect()
}

/// The rows of a question.
pub(super) struct NamedRows {
    pub names: Vec<String>,
    /// One row after the other.
    pub entries: Vec<NodeId>,
    /// The highest order of the Lie derivatives; `None` for a file's own rows.
    pub order: Option<usize>,
}

impl NamedRows {
    /// The rows that are asked for, with the values put in.
    ///
    /// # Errors
    /// In words: the file has no rows of its own, or no Lie derivatives can be made.
    pub fn of(system: &mut System, rows: RegionRows, values: &Assignment) -> Result<NamedRows, String> {
        let order = match rows {
            RegionRows::Own => {
                return match system.definition(OWN_ROWS) {
                    Some(Value::Matrix(matrix)) if matrix.columns == system.unknown_count() => {
                        let names = (1..=matrix.rows).map(|row| format!("row {row}")).collect();
                        Ok(NamedRows { names, entries: matrix.entries.clone(), order: None })
                    }
                    _ => Err(format!(
                        "{} defines no matrix '{OWN_ROWS}' with a column for each state",
                        system.name
                    )),
                };
            }
            RegionRows::Codistribution(order) => order,
        };
        let length = order.map_or(Length::UntilItStops, Length::Exactly);
        let mut found = Codistribution::new(system, values, length)?;
        if order.is_none() && found.stop == Stop::Full {
            let longer = Codistribution::new(system, values, Length::Exactly(found.order + 1))?;
            if longer.lie_derivatives.len() <= MOST_LIE_DERIVATIVES {
                found = longer;
            }
        }
        let names = found.lie_derivatives.iter().map(|word| word.text(system)).collect();
        Ok(NamedRows { names, entries: found.entries(), order: Some(found.order) })
    }
}
