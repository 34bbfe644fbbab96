//! What files mean by hand.

use palmistry_import::ImportedModel;

/// Values of names, for states, inputs and constants.
pub type Values = &'static [(&'static str, f64)];

pub fn value_of(model: &ImportedModel, values: Values, expression: &palmistry_import::ForeignExpr) -> f64 {
    value_within(model, values, expression, 0)
}

fn value_within(
    model: &ImportedModel,
    values: Values,
    expression: &palmistry_import::ForeignExpr,
    depth: usize,
) -> f64 {
    assert!(depth < 40, "definitions go round in a circle");
    let of = |name: &str| {
        let own = values.iter().find(|(own, _)| *own == name).map(|(_, value)| *value);
        own.or_else(|| {
            let (_, value) = model.model.definitions.iter().find(|(own, _)| own == name)?;
            Some(value_within(model, values, value, depth + 1))
        })
    };
    expression.value(&of).unwrap_or_else(|| panic!("a name has no value in {expression:?}\n{}", model.text))
}
