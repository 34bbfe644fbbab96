//! Fields with their roles and symbols with their values, as JSON and as text.

use dashu::rational::RBig;
use palmistry_lang::{FieldRole, Range};
use palmistry_math::number::{parse_decimal, round_to_decimal};
use serde_json::{Value, json};

/// The fields of which Lie derivatives are made, each with its role.
pub(crate) fn fields_json(fields: &[FieldRole]) -> Value {
    fields.iter().map(|field| json!({ "name": field.name, "role": field.role.name() })).collect()
}

/// The same as text: `drift f, input g1`.
pub(crate) fn fields_text(fields: &[FieldRole]) -> String {
    let each: Vec<String> =
        fields.iter().map(|field| format!("{} {}", field.role.name(), field.name)).collect();
    each.join(", ")
}

/// Names and exact values, as people write them.
pub(crate) fn values_json(values: &[(String, RBig)]) -> Value {
    let each = values.iter().map(|(name, value)| (name.clone(), json!(plain_number(value))));
    each.collect::<serde_json::Map<_, _>>().into()
}

/// The same as text: `g = -9.81, m = 1`.
pub(crate) fn values_text(values: &[(String, RBig)]) -> String {
    let each: Vec<String> =
        values.iter().map(|(name, value)| format!("{name} = {}", plain_number(value))).collect();
    each.join(", ")
}

/// Names and the ranges that they are drawn from.
pub(crate) fn ranges_json(ranges: &[(String, Range)]) -> Value {
    let ends = |range: &Range| json!([plain_number(&range.low), plain_number(&range.high)]);
    let each = ranges.iter().map(|(name, range)| (name.clone(), ends(range)));
    each.collect::<serde_json::Map<_, _>>().into()
}

/// That some symbols are drawn from ranges that the file does not give.
pub(crate) fn by_default_text(ranges: &[(String, Range)]) -> String {
    let mut text = "drawn by default, since no 'sample' says where from: ".to_owned();
    for (place, (name, range)) in ranges.iter().enumerate() {
        // names of one range stand together
        let ends = format!("in [{}, {}]", plain_number(&range.low), plain_number(&range.high));
        let same = ranges.get(place + 1).is_some_and(|(_, next)| next == range);
        text.push_str(name);
        match (same, place + 1 == ranges.len()) {
            (true, _) => text.push_str(", "),
            (false, false) => text.push_str(&format!(" {ends}; ")),
            (false, true) => text.push_str(&format!(" {ends}")),
        }
    }
    text
}

/// A rational as a decimal where a short one is exact, else as a fraction.
pub(crate) fn plain_number(value: &RBig) -> String {
    let decimal = round_to_decimal(value, 20);
    let short = match decimal.contains('.') && !decimal.contains('e') {
        true => decimal.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => decimal,
    };
    if parse_decimal(&short).as_ref() == Some(value) { short } else { value.to_string() }
}
