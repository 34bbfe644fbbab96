//! `palmistry eval`: the value of an expression at a point.

use super::arguments::{Wanted, assignments};
use super::interrupt::begin_to_tell;
use super::output::{print_json, print_text};
use super::{Status, Unusable};
use clap::Args;
use dashu::rational::RBig;
use palmistry::claim::{PointValue, computed_value, exists_at};
use palmistry::expression::{NodeId, Symbol};
use palmistry::file;
use palmistry::number::Rung;
use palmistry::report::expression_latex;
use palmistry::sweep::Certainty;
use palmistry::{System, ValueError, certified_value, system::Value};
use serde_json::{Value as Json, json};
use std::collections::HashMap;
use std::path::PathBuf;

/// Evaluates an expression of the language at a point, to as many digits as you like, all of them certain.
#[derive(Args)]
#[command(after_help = "Examples:
  palmistry eval mysystem.proof 'L(f, x)' --at x=1/3,y=.5
  palmistry eval mysystem.proof 'det(rows)' --at x=1,y=2 --digits 40")]
pub(crate) struct Eval {
    /// The proof file whose names the expression uses.
    file: PathBuf,
    /// The expression, such as 'det(A)' or 'L(f, s1)'.
    #[arg(allow_hyphen_values = true)]
    expression: String,
    /// Values: name=value,... (1/2 and .5 alike; angles in radians). Parameters that are not named have the values of
    /// the file.
    #[arg(long, value_name = "NAME=VALUE,...", value_delimiter = ',')]
    at: Vec<String>,
    /// Significant decimal digits.
    #[arg(long, default_value_t = 20, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=10_000))]
    digits: u16,
    /// What the digits have to be: 'certified', all of them certain, or 'computed', agreed on by doubles and
    /// double-doubles. The cheapest numbers that suffice are taken; 'climbed' says how many were tried before.
    #[arg(long, value_enum, default_value_t = Wanted::Certified, value_name = "HOW")]
    verdict: Wanted,
    /// Print one JSON object with 'value' (a string), 'exact' where the value is rational, 'how' its digits are certain,
    /// 'numbers', 'width' of the interval that encloses it, and 'at'.
    #[arg(long)]
    pub json: bool,
    /// Give the expression in LaTeX too: a line before the value, or 'latex' in the JSON.
    #[arg(long)]
    latex: bool,
}

impl Eval {
    pub fn run(self) -> miette::Result<Status> {
        let mut system = System::read(&self.file)?;
        let given = assignments(&system, &self.at)?;
        let (value, guards) = system.evaluate_text_guarded(&self.expression)?;
        let mut point: HashMap<Symbol, RBig> =
            system.symbols().filter_map(|(symbol, info)| Some((symbol, info.default.clone()?))).collect();
        point.extend(given.clone());
        exists_at(&system.graph, &guards, &point).map_err(explain)?;
        let digits = usize::from(self.digits);
        let one = |id: NodeId| {
            match self.verdict {
                Wanted::Certified => certified_value(&system.graph, id, &point, digits),
                Wanted::Computed => computed_value(&system.graph, id, &point, digits),
            }
            .map_err(explain)
        };
        let how: String;
        let shown = match &value {
            Value::Scalar(id) => {
                let value = one(*id)?;
                how = how_certain(&value, digits);
                json!({
                    "value": value.decimal,
                    "exact": value.exact.map(|q| q.to_string()),
                    "verdict": if value.certainty == Certainty::Certified { "certified" } else { "computed" },
                    "numbers": value.rung.name(),
                    "width": value.width,
                    "climbed": value.climbed,
                })
            }
            Value::Matrix(matrix) => {
                let entries: Vec<PointValue> =
                    matrix.entries.iter().map(|id| one(*id)).collect::<Result<_, _>>()?;
                how = how_certain_all(&entries, digits);
                let decimals: Vec<&str> = entries.iter().map(|value| value.decimal.as_str()).collect();
                json!({
                    "value": decimals.chunks(matrix.columns).collect::<Vec<_>>(),
                    "climbed": entries.iter().filter(|value| value.climbed > 0).count(),
                })
            }
            Value::Rank(matrix) => {
                how = "certain: by elimination in rational numbers".to_owned();
                json!({ "value": rank_at(&mut system, matrix.entries.clone(), matrix.columns, &point)?.to_string() })
            }
            other => {
                let message = format!("{} has no value at a point", other.describe());
                return Err(Unusable::report(message, "ask 'palmistry rank', or claim it in the file"));
            }
        };
        begin_to_tell();
        if self.json {
            let mut object = shown;
            object["expression"] = json!(self.expression);
            object["digits"] = json!(digits);
            object["how"] = json!(how);
            if self.latex {
                object["latex"] = json!(expression_latex(&self.expression));
            }
            let mut at: Vec<(String, String)> =
                given.iter().map(|(s, v)| (system.symbol_name(*s).to_owned(), v.to_string())).collect();
            at.sort();
            object["at"] = at.into_iter().map(|(name, value)| (name, json!(value))).collect();
            print_json(&object)?;
        } else {
            let formula = self.latex.then(|| expression_latex(&self.expression)).flatten();
            let formula = formula.map_or(String::new(), |latex| format!("{latex}\n"));
            print_text(&format!("{formula}{}", in_lines(&shown["value"])))?;
            // beside the value and not behind it: what is printed is what others read
            file::note(&format!("({how})"));
        }
        Ok(Status::AsExpected)
    }
}

/// Whether the digits of a value are certain, and why.
fn how_certain(value: &PointValue, digits: usize) -> String {
    let width = value.width.as_deref().unwrap_or_default();
    match (&value.exact, value.certainty, value.rung) {
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
        (None, Certainty::Certified, rung) => format!(
            "{digits} digits, certain: the value is enclosed by an interval of width {width}, both ends of which round to \
             them; {}",
            match rung {
                Rung::Intervals => "by doubles, each operation rounded outward".to_owned(),
                rung => format!("by {}, each operation rounded outward", rung.name()),
            }
        ),
    }
}

/// The same of the entries of a matrix.
fn how_certain_all(values: &[PointValue], digits: usize) -> String {
    let mut numbers: Vec<String> = values.iter().map(|value| value.rung.name()).collect();
    numbers.sort();
    numbers.dedup();
    let numbers = numbers.join(", ");
    match values.iter().all(|value| value.certainty == Certainty::Certified) {
        true => format!("{digits} digits of each entry, certain: enclosed or exact, by {numbers}"),
        false => format!("{digits} digits of each entry, not all of them certain: by {numbers}"),
    }
}

/// Longer fractions than this are not shown beside their decimals.
const LONGEST_EXACT: usize = 60;

/// A value as it is printed: a matrix by rows, a line each.
fn in_lines(value: &Json) -> String {
    match value {
        Json::String(text) => text.clone(),
        Json::Array(rows) => {
            let entries = |row: &Json| -> Vec<String> {
                row.as_array().into_iter().flatten().filter_map(Json::as_str).map(str::to_owned).collect()
            };
            rows.iter().map(|row| entries(row).join("  ")).collect::<Vec<_>>().join("\n")
        }
        other => other.to_string(),
    }
}

/// The certified rank of a matrix at a rational point.
fn rank_at(
    system: &mut System,
    entries: Vec<NodeId>,
    columns: usize,
    point: &HashMap<Symbol, RBig>,
) -> miette::Result<usize> {
    use palmistry::number::Rationals;
    let program = palmistry::expression::Program::plain(&system.graph, &entries);
    let exact = Rationals::default();
    let refuse = |why: String| {
        Unusable::report(why, "a rank at a point is exact: give angles only where sines are rational")
    };
    let inputs: Vec<RBig> = program
        .inputs()
        .iter()
        .map(|input| match input {
            palmistry::expression::Input::Plain(symbol) => point
                .get(symbol)
                .cloned()
                .ok_or_else(|| explain(ValueError::Missing(system.symbol_name(*symbol).to_owned()))),
            _ => Err(refuse("an input that is no symbol".to_owned())),
        })
        .collect::<Result<_, _>>()?;
    let loaded = program.load(exact).map_err(|e| refuse(e.to_string()))?;
    let values =
        loaded.run(&inputs, &mut Vec::new()).map_err(|failure| refuse(failure.refusal.to_string()))?;
    let rows = values.chunks(columns).map(<[RBig]>::to_vec).collect();
    palmistry::observability::rank(&exact, rows).map_err(|e| refuse(e.to_string()))
}

fn explain(error: ValueError) -> miette::Report {
    let help = match &error {
        ValueError::Missing(name) => format!("give it one: --at {name}=..."),
        ValueError::Pole(_) | ValueError::NearPole { .. } => {
            "choose another point, or ask for the order: claim pole(e, factor) = n".to_owned()
        }
        _ => String::new(),
    };
    Unusable::report(error.to_string(), help)
}
