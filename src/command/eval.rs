//! `palmistry eval`: the value of an expression at a point.

use super::arguments::Wanted;
use super::interrupt::begin_to_tell;
use super::output::{print_json, print_text};
use super::{Status, Unusable};
use clap::Args;
use dashu::rational::RBig;
use palmistry::claim::{EvaluationError, evaluate};
use palmistry::file;
use palmistry::report::{ValueAsked, expression_latex_in, how_certain, value_json, value_text};
use palmistry::system::Code;
use palmistry::{System, ValueError};
use serde_json::json;
use std::path::PathBuf;

/// Evaluates an expression of the language at a point, to as many digits as you like, all of them certain.
#[derive(Args)]
#[command(after_help = "Examples:
  palmistry eval mysystem.proof 'L(f, x)' --at x=1/3,y=.5
  palmistry eval mysystem.proof 'det(rows)' --at x=1,y=2 --digits 40")]
pub(crate) struct Eval {
    /// The proof file whose names the expression uses.
    pub(super) file: PathBuf,
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
    /// How the digits are established: 'certified', all of them certain, or 'computed', agreed on by doubles and
    /// double-doubles. The cheapest number type that suffices is used; 'escalated' counts those that did not suffice.
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
        let given = system.given_values(&self.at).map_err(Unusable::given)?;
        let digits = usize::from(self.digits);
        let value =
            evaluate(&mut system, &self.expression, &given, digits, self.verdict.into()).map_err(explain)?;
        begin_to_tell();
        if self.json {
            let mut at: Vec<(String, RBig)> =
                given.into_iter().map(|(s, v)| (system.symbol_name(s).to_owned(), v)).collect();
            at.sort();
            let mut object =
                value_json(&ValueAsked { expression: &self.expression, digits, at: &at }, &value);
            if self.latex {
                object["latex"] = json!(expression_latex_in(&self.expression, &system.looks));
            }
            print_json(&object)?;
        } else {
            let formula = self.latex.then(|| expression_latex_in(&self.expression, &system.looks)).flatten();
            let formula = formula.map_or(String::new(), |latex| format!("{latex}\n"));
            print_text(&format!("{formula}{}", value_text(&value)))?;
            // beside the value and not behind it: what is printed is what others read
            file::note(&format!("({})", how_certain(&value, digits)));
        }
        Ok(Status::AsExpected)
    }
}

fn explain(error: EvaluationError) -> miette::Report {
    let help = match &error {
        EvaluationError::Read(_) => String::new(),
        EvaluationError::Value(ValueError::Missing(name)) => format!("give it one: --at {name}=..."),
        EvaluationError::Value(ValueError::Pole(_) | ValueError::NearPole { .. }) => {
            "choose another point, or ask for the order: claim pole(e, factor) = n".to_owned()
        }
        EvaluationError::Value(_) => String::new(),
        EvaluationError::NoValue(_) => "ask 'palmistry rank', or claim it in the file".to_owned(),
        EvaluationError::NotRational(_) => {
            "a rank at a point is exact: give angles only where sines are rational".to_owned()
        }
    };
    match error {
        EvaluationError::Read(error) => error.into(),
        error => Unusable::report(Code::Question, error.to_string(), help),
    }
}
