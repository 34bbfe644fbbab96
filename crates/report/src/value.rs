//! The value of an expression at a point, as JSON and as text.

use dashu::rational::RBig;
use palmistry_math::number::NumberType;
use palmistry_prove::claim::{PointValue, ValueAtPoint};
use palmistry_rank::sweep::Certainty;
use serde_json::{Value as Json, json};

/// Longer fractions than this are not shown beside their decimals.
const LONGEST_EXACT: usize = 60;

/// The question for a value: the expression, to how many digits, and at what values, by name.
#[derive(Clone, Debug)]
pub struct ValueAsked<'a> {
    /// The expression as it was written.
    pub expression: &'a str,
    /// How many significant decimal digits.
    pub digits: usize,
    /// The values that were given, in the order of their names.
    pub at: &'a [(String, RBig)],
}

/// A value as JSON: `value` is a text with all its digits, for a matrix a list of rows.
pub fn value_json(asked: &ValueAsked<'_>, value: &ValueAtPoint) -> Json {
    let mut object = match value {
        ValueAtPoint::Number(value) => json!({
            "value": value.decimal,
            "exact": value.exact.as_ref().map(RBig::to_string),
            "verdict": if value.certainty == Certainty::Certified { "certified" } else { "computed" },
            "numbers": value.number_type.name(),
            "width": value.width,
            "escalated": value.climbed,
        }),
        ValueAtPoint::Matrix { entries, .. } => json!({
            "value": rows_of(value),
            "escalated": entries.iter().filter(|value| value.climbed > 0).count(),
        }),
        ValueAtPoint::Rank(rank) => json!({ "value": rank.to_string() }),
    };
    object["expression"] = json!(asked.expression);
    object["digits"] = json!(asked.digits);
    object["how"] = json!(how_certain(value, asked.digits));
    object["at"] = asked.at.iter().map(|(name, value)| (name.clone(), json!(value.to_string()))).collect();
    object
}

/// A value as it is printed: a matrix by rows, a line each.
pub fn value_text(value: &ValueAtPoint) -> String {
    rows_of(value).iter().map(|row| row.join("  ")).collect::<Vec<_>>().join("\n")
}

fn rows_of(value: &ValueAtPoint) -> Vec<Vec<String>> {
    match value {
        ValueAtPoint::Number(value) => vec![vec![value.decimal.clone()]],
        ValueAtPoint::Rank(rank) => vec![vec![rank.to_string()]],
        ValueAtPoint::Matrix { columns, entries } => entries
            .chunks((*columns).max(1))
            .map(|row| row.iter().map(|value| value.decimal.clone()).collect())
            .collect(),
    }
}

/// Whether the digits of a value are certain, and why.
pub fn how_certain(value: &ValueAtPoint, digits: usize) -> String {
    match value {
        ValueAtPoint::Number(value) => of_number(value, digits),
        ValueAtPoint::Matrix { entries, .. } => of_entries(entries, digits),
        ValueAtPoint::Rank(_) => "certain: by elimination in rational numbers".to_owned(),
    }
}

fn of_number(value: &PointValue, digits: usize) -> String {
    let width = value.width.as_deref().unwrap_or_default();
    match (&value.exact, value.certainty, value.number_type) {
        (Some(exact), ..) => {
            let exact = exact.to_string();
            let equal =
                if exact.len() <= LONGEST_EXACT { format!(", which is {exact}") } else { String::new() };
            format!("{digits} digits, certain: rounded from the exact value{equal}")
        }
        (None, Certainty::Computed, _) => {
            format!(
                "{digits} digits, computed: doubles and double-doubles agree on them, which proves nothing"
            )
        }
        (None, Certainty::Certified, number_type) => format!(
            "{digits} digits, certain: the value is enclosed by an interval of width {width}, both ends of which round to \
             them; {}",
            match number_type {
                NumberType::Intervals => "by doubles, each operation rounded outward".to_owned(),
                number_type => format!("by {}, each operation rounded outward", number_type.name()),
            }
        ),
    }
}

/// The same of the entries of a matrix.
fn of_entries(values: &[PointValue], digits: usize) -> String {
    let mut numbers: Vec<String> = values.iter().map(|value| value.number_type.name()).collect();
    numbers.sort();
    numbers.dedup();
    let numbers = numbers.join(", ");
    match values.iter().all(|value| value.certainty == Certainty::Certified) {
        true => format!("{digits} digits of each entry, certain: enclosed or exact, by {numbers}"),
        false => format!("{digits} digits of each entry, not all of them certain: by {numbers}"),
    }
}
