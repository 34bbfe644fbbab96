//! `[columns]`: which column of a recording is which, and in what unit.

use super::place::Places;
use palmistry_lang::{Base, Code, Dimension, Problem, ScaledUnit, System, nearest};
use palmistry_observe::{ColumnNames, ColumnSource, TIME};
use std::collections::BTreeMap;

/// `[columns]`: a column of a recording under the name that the model gives it.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneColumn {
    /// `from`: its name in the recording; the model's own unless given.
    pub from: String,
    /// `unit`, in which the recording has it; the model's own unless given.
    pub unit: Option<ScaledUnit>,
    /// `factor`: the factor by which numbers of the recording are multiplied, beside their unit; 1 unless given.
    pub factor: f64,
    /// `offset`: the number that is added then, in the model's unit; 0 unless given.
    pub offset: f64,
}

/// The columns by the names and units of a system.
///
/// # Errors
/// The model knows no such name, or measures it in a unit of another kind.
pub(super) fn names(
    columns: &BTreeMap<String, SceneColumn>,
    system: &System,
    text: &str,
) -> Result<ColumnNames, Problem> {
    let span = |place: &str| Places::of(text).map_or(0..0, |places| places.value(place));
    let mut sources = Vec::new();
    for (name, column) in columns {
        let symbol = system.find_symbol(name);
        let outputs = || system.outputs.iter().map(|(output, _)| output.as_str());
        if name != TIME && symbol.is_none() && !outputs().any(|output| output == name) {
            let known =
                system.symbols().map(|(symbol, _)| system.symbol_name(symbol)).chain(outputs()).chain([TIME]);
            let known: Vec<&str> = known.collect();
            let help = match nearest(name, known.iter().copied()) {
                Some(near) => format!(
                    "perhaps you meant '{near}'; a column is called here as the model calls it, and 'from' has its name in the recording"
                ),
                None => format!("a column is called here as the model calls it: {}", known.join(", ")),
            };
            let place = span(&format!("columns.{name}"));
            return Err(Problem::new(
                Code::SceneKey,
                &place,
                format!("the model knows no '{name}'"),
                "this column",
            )
            .help(help));
        }
        let (factor, mut offset) = column.unit.as_ref().map_or((1.0, 0.0), |unit| (unit.factor, unit.offset));
        let measures = match name.as_str() {
            TIME => Some(Dimension::of(Base::Time)),
            _ => symbol.and_then(|symbol| system.dimension_of(symbol).cloned()),
        };
        if let (Some(unit), Some(measures)) = (&column.unit, &measures)
            && unit.dimension != *measures
        {
            let unit_of = |dimension: &Dimension| match dimension.unit() {
                unit if unit == "1" => "a number".to_owned(),
                unit => format!("in {unit}"),
            };
            let message = format!(
                "'{name}' is {}, and this unit is one of what is {}",
                unit_of(measures),
                unit_of(&unit.dimension)
            );
            let place = span(&format!("columns.{name}.unit"));
            return Err(Problem::new(Code::SceneValue, &place, message, "this unit")
                .help("name the unit in which the recording has it"));
        }
        offset = offset * column.factor + column.offset;
        sources.push(ColumnSource {
            name: name.clone(),
            from: column.from.clone(),
            factor: factor * column.factor,
            offset,
        });
    }
    Ok(ColumnNames { sources })
}
