//! Published formulas as text, and numbers from a real motion to hold them against.

use dashu::rational::RBig;
use palmistry::mechanics::Real;
use palmistry::number::{parse_decimal, rational_to_f64};
use palmistry::{System, certified_value, system::Value};
use std::collections::HashMap;
use std::path::Path;

/// Two sides that agree to within this part of the larger (or of one) are called equal. The derivatives come
/// with an estimate of their error, which each test asserts to be smaller; the formulas themselves are
/// evaluated to eighty certain digits and add nothing.
fn tolerance() -> RBig {
    parse_decimal("1e-40").unwrap()
}

/// Holds an estimated error to be below what is tolerated.
pub fn check_error(error: &Real) {
    assert!(error.to_rational().expect("derivatives") < tolerance(), "error estimate {:e}", error.to_f64());
}

/// Names with their values, and definitions that use them.
#[derive(Default)]
pub struct Sheet {
    names: Vec<String>,
    lets: String,
    point: HashMap<String, RBig>,
}

impl Sheet {
    pub fn number(&mut self, name: &str, value: &Real) -> &mut Self {
        let value = value.to_rational().unwrap_or_else(|| panic!("{name} is undefined"));
        self.point.insert(name.to_owned(), value);
        self.names.push(name.to_owned());
        self
    }

    /// A column vector.
    pub fn vector(&mut self, name: &str, values: &[Real]) -> &mut Self {
        let rows: Vec<[Real; 1]> = values.iter().map(|value| [value.clone()]).collect();
        self.matrix(name, &rows)
    }

    pub fn matrix<const COLUMNS: usize>(&mut self, name: &str, rows: &[[Real; COLUMNS]]) -> &mut Self {
        let mut text = Vec::new();
        for (i, row) in rows.iter().enumerate() {
            let mut entries = Vec::new();
            for (j, value) in row.iter().enumerate() {
                let entry = format!("{name}_at_{i}{j}");
                self.number(&entry, value);
                entries.push(entry);
            }
            text.push(entries.join(", "));
        }
        self.lets += &format!("let {name} = [{}]\n", text.join("; "));
        self
    }

    /// Definitions, in the language of proof files.
    pub fn define(&mut self, text: &str) -> &mut Self {
        self.lets += text;
        self.lets += "\n";
        self
    }

    pub fn open(&self) -> OpenSheet {
        let text = format!("system \"a motion\"\nstate {}\n{}", self.names.join(", "), self.lets);
        let system =
            System::parse("sheet", &text, Path::new("")).unwrap_or_else(|error| panic!("{error:?}\n{text}"));
        OpenSheet::new(system, &self.point)
    }
}

/// A system at one point.
pub struct OpenSheet {
    system: System,
    point: HashMap<palmistry::expression::Symbol, RBig>,
    /// The greatest difference that any equation left.
    pub worst: f64,
}

impl OpenSheet {
    pub fn new(system: System, point: &HashMap<String, RBig>) -> Self {
        let symbol = |name: &str| system.find_symbol(name).unwrap_or_else(|| panic!("no symbol {name}"));
        let point = point.iter().map(|(name, value)| (symbol(name), value.clone())).collect();
        OpenSheet { system, point, worst: 0.0 }
    }

    /// The entries of an expression's value, to eighty digits.
    pub fn value(&mut self, text: &str) -> Vec<RBig> {
        let entries =
            match self.system.evaluate_text(text).unwrap_or_else(|error| panic!("{error:?} in {text}")) {
                Value::Scalar(id) => vec![id],
                Value::Matrix(matrix) => matrix.entries,
                other => panic!("{text} is {}", other.describe()),
            };
        let value = |id| {
            certified_value(&self.system.graph, id, &self.point, 80).unwrap_or_else(|e| panic!("{text}: {e}"))
        };
        entries.into_iter().map(|id| parse_decimal(&value(id).decimal).unwrap()).collect()
    }

    /// How far apart two expressions are: the greatest difference of their entries, as a part of the larger
    /// or of one.
    pub fn distance(&mut self, left: &str, right: &str) -> RBig {
        let (left_values, right_values) = (self.value(left), self.value(right));
        assert_eq!(left_values.len(), right_values.len(), "{left} and {right}");
        let magnitude = |x: &RBig| x.clone().max(-x.clone());
        let pairs = left_values.iter().zip(&right_values);
        pairs.fold(RBig::ZERO, |worst, (a, b)| {
            let scale = magnitude(a).max(magnitude(b)).max(RBig::ONE);
            worst.max(magnitude(&(a - b)) / scale)
        })
    }

    /// Holds the two sides of an equation to be equal.
    pub fn holds(&mut self, label: &str, left: &str, right: &str) {
        let distance = self.distance(left, right);
        self.worst = self.worst.max(rational_to_f64(&distance));
        assert!(
            distance < tolerance(),
            "{label}: {left} = {right} fails by {:e}",
            rational_to_f64(&distance)
        );
    }

    /// Holds a printed equation to be wrong: it has to miss by far more than any rounding.
    pub fn fails(&mut self, label: &str, left: &str, right: &str) {
        let distance = rational_to_f64(&self.distance(left, right));
        assert!(distance > 1e-6, "{label}: {left} = {right} to within {distance:e}");
    }
}
