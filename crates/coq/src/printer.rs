//! Expressions as terms of the library.
//!
//! Which operation is meant hangs on what a name stands for, a number or a matrix: that is all that is found out here. A matrix of one
//! row and one column is a number, as everywhere in the language.

use crate::names::Names;
use dashu::rational::RBig;
use palmistry_lang::{System, Value};
use palmistry_math::expression::syntax::{Expr, ExprKind, Name};
use std::collections::{BTreeMap, BTreeSet};

/// A number, or a matrix of rows and columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Number,
    Matrix(usize, usize),
}

/// How tightly a printed term holds together.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Hold {
    Sum,
    /// `- a`
    Negative,
    Product,
    Power,
    /// A function of arguments.
    Call,
    Name,
}

/// A printed term.
#[derive(Clone)]
pub(crate) struct Printed {
    pub text: String,
    pub kind: Kind,
    hold: Hold,
}

/// Longer terms are refused: nobody would read them.
const LONGEST: usize = 100_000;

/// Why something cannot be written.
pub(crate) type Reason = String;
type Found = Result<Printed, Reason>;

impl Printed {
    fn number(text: impl Into<String>, hold: Hold) -> Printed {
        Printed { text: text.into(), kind: Kind::Number, hold }
    }

    fn matrix(text: impl Into<String>, rows: usize, columns: usize, hold: Hold) -> Printed {
        let text = text.into();
        match (rows, columns) {
            (1, 1) => Printed::number(format!("entry {}", bracketed(text, hold < Hold::Name)), Hold::Call),
            _ => Printed { text, kind: Kind::Matrix(rows, columns), hold },
        }
    }

    /// In brackets where it holds less tightly.
    fn at_least(&self, hold: Hold) -> String {
        bracketed(self.text.clone(), self.hold < hold)
    }

    /// As an argument.
    pub fn argument(&self) -> String {
        self.at_least(Hold::Name)
    }

    /// As a matrix.
    pub fn as_matrix(&self) -> Printed {
        match self.kind {
            Kind::Number => {
                Printed { text: format!("[[{}]]", self.text), kind: Kind::Matrix(1, 1), hold: Hold::Name }
            }
            Kind::Matrix(..) => self.clone(),
        }
    }
}

fn bracketed(text: String, yes: bool) -> String {
    if yes { format!("({text})") } else { text }
}

/// What a name of a file stands for in what is printed.
#[derive(Clone)]
pub(crate) struct Known {
    pub ident: String,
    pub kind: Kind,
}

/// What can be named where something is printed.
pub(crate) struct Printer<'s> {
    pub system: &'s System,
    /// What the names of the file before it are called: `contact.` of an imported one.
    pub prefix: String,
    pub names: &'s mut Names,
    /// Definitions that are printed, and why others are not; by their whole names.
    pub definitions: &'s BTreeMap<String, Result<Known, Reason>>,
    /// Fields, likewise.
    pub fields: &'s BTreeMap<String, Result<String, Reason>>,
    /// What was named.
    pub used: BTreeSet<String>,
}

impl Printer<'_> {
    pub fn variable(&mut self, name: &str) -> String {
        let ident = self.names.of("value", name);
        self.used.insert(ident.clone());
        ident
    }

    /// A term for an expression.
    pub fn print(&mut self, expr: &Expr) -> Found {
        let found = self.printed(expr)?;
        refuse_length(Some(&found))?;
        Ok(found)
    }

    fn printed(&mut self, expr: &Expr) -> Found {
        match &expr.kind {
            ExprKind::Number(value) => Ok(number(value)),
            ExprKind::Name(name) => self.named(name),
            ExprKind::Call(name, arguments) => self.call(name, arguments),
            ExprKind::Sum(terms) => self.sum(terms),
            ExprKind::Product(factors) => self.product(factors),
            ExprKind::Power(base, exponent) => {
                let base = self.scalar(base)?;
                Ok(power(&base, *exponent))
            }
            ExprKind::RealPower(base, exponent) => self.real_power(base, exponent),
            ExprKind::Matrix(rows) => self.blocks(rows),
            ExprKind::At(inner, list) => {
                let inner = self.print(inner)?;
                let list = self.assignment(list)?;
                Ok(match inner.kind {
                    Kind::Number => Printed::number(format!("{} at {list}", inner.argument()), Hold::Call),
                    Kind::Matrix(rows, columns) => {
                        let text = format!("each (subst (put {list})) {}", inner.argument());
                        Printed::matrix(text, rows, columns, Hold::Call)
                    }
                })
            }
            ExprKind::Indexed(_) => Err("an index without a value".to_owned()),
        }
    }

    /// The same of what has to be a number.
    pub fn scalar(&mut self, expr: &Expr) -> Found {
        let found = self.print(expr)?;
        match found.kind {
            Kind::Number => Ok(found),
            Kind::Matrix(..) => Err("a matrix where a number is expected".to_owned()),
        }
    }

    fn named(&mut self, name: &str) -> Found {
        let whole = format!("{}{name}", self.prefix);
        if let Some(known) = self.definitions.get(&whole) {
            let known = known.clone()?;
            self.used.insert(known.ident.clone());
            return Ok(Printed { text: known.ident, kind: known.kind, hold: Hold::Name });
        }
        if self.system.find_symbol(name).is_some() {
            return Ok(Printed::number(self.variable(name), Hold::Name));
        }
        match name {
            "pi" => Ok(Printed::number("Pi", Hold::Name)),
            _ => Err(format!("'{name}'")),
        }
    }

    fn assignment(&mut self, list: &[(Name, Expr)]) -> Result<String, Reason> {
        let mut pairs = Vec::new();
        for (name, value) in list {
            let value = self.scalar(value)?;
            pairs.push(format!("({}, {})", self.variable(&name.text), value.text));
        }
        Ok(format!("[{}]", pairs.join("; ")))
    }

    fn call(&mut self, name: &str, arguments: &[Expr]) -> Found {
        if let Some(function) = function(name) {
            return match arguments {
                [argument] => {
                    let argument = self.scalar(argument)?;
                    Ok(Printed::number(format!("{function} {}", argument.argument()), Hold::Call))
                }
                [y, x] if name == "atan2" => {
                    let (y, x) = (self.scalar(y)?, self.scalar(x)?);
                    let text = format!("{function} {} {}", y.argument(), x.argument());
                    Ok(Printed::number(text, Hold::Call))
                }
                _ => Err(format!("'{name}' of {} arguments", arguments.len())),
            };
        }
        match (name, arguments) {
            ("L", [fields @ .., last]) => {
                let mut found = self.print(last)?;
                for field in fields.iter().rev() {
                    let field = self.field(field)?;
                    found = match found.kind {
                        Kind::Number => {
                            Printed::number(format!("L {field} {}", found.argument()), Hold::Call)
                        }
                        Kind::Matrix(rows, columns) => {
                            let text = format!("each (L {field}) {}", found.argument());
                            Printed::matrix(text, rows, columns, Hold::Call)
                        }
                    };
                }
                Ok(found)
            }
            ("bracket", [first, second, states @ ..]) => {
                let (first, second) = (self.field(first)?, self.field(second)?);
                let states = self.states(states)?;
                let text = format!("column_of (bracket {first} {second}) [{}]", states.join("; "));
                Ok(Printed::matrix(text, states.len(), 1, Hold::Call))
            }
            ("d", [of, states @ ..]) => {
                let of = self.scalar(of)?;
                match self.states(states)?.as_slice() {
                    [one] => Ok(Printed::number(format!("d {one} {}", of.argument()), Hold::Call)),
                    states => {
                        let text = format!("differential [{}] {}", states.join("; "), of.argument());
                        Ok(Printed::matrix(text, 1, states.len(), Hold::Call))
                    }
                }
            }
            ("det", [of]) => {
                let (of, _) = self.matrix(of)?;
                Ok(Printed::number(format!("det {}", of.argument()), Hold::Call))
            }
            ("transpose", [of]) => {
                let (of, (rows, columns)) = self.matrix(of)?;
                Ok(Printed::matrix(format!("transpose {}", of.argument()), columns, rows, Hold::Call))
            }
            ("inverse", [of]) => {
                let (of, (rows, columns)) = self.matrix(of)?;
                Ok(Printed::matrix(format!("inverse {}", of.argument()), rows, columns, Hold::Call))
            }
            ("dot", [a, b]) => {
                let ((a, _), (b, _)) = (self.matrix(a)?, self.matrix(b)?);
                Ok(Printed::number(format!("dot {} {}", a.argument(), b.argument()), Hold::Call))
            }
            ("cross", [a, b]) => {
                let ((a, (rows, columns)), (b, _)) = (self.matrix(a)?, self.matrix(b)?);
                let arguments = format!("{} {}", a.argument(), b.argument());
                Ok(match rows * columns {
                    2 => Printed::number(format!("cross2 {arguments}"), Hold::Call),
                    _ => Printed::matrix(format!("cross3 {arguments}"), rows, columns, Hold::Call),
                })
            }
            _ => Err(format!("'{name}(...)'")),
        }
    }

    fn matrix(&mut self, expr: &Expr) -> Result<(Printed, (usize, usize)), Reason> {
        let found = self.print(expr)?.as_matrix();
        match found.kind {
            Kind::Matrix(rows, columns) => Ok((found, (rows, columns))),
            Kind::Number => Err("a number where a matrix is expected".to_owned()),
        }
    }

    /// A field by its name, or the bracket of two.
    fn field(&mut self, expr: &Expr) -> Result<String, Reason> {
        match &expr.kind {
            ExprKind::Name(name) => {
                let whole = format!("{}{name}", self.prefix);
                let ident = self.fields.get(&whole).cloned().unwrap_or_else(|| Err(format!("'{name}'")))?;
                self.used.insert(ident.clone());
                Ok(ident)
            }
            ExprKind::Call(name, arguments) if name == "bracket" => match arguments.as_slice() {
                [first, second] => Ok(format!("(bracket {} {})", self.field(first)?, self.field(second)?)),
                _ => Err("a bracket of more than two fields".to_owned()),
            },
            _ => Err("a field that is none".to_owned()),
        }
    }

    /// The states that are named, or all unknown ones where none is.
    fn states(&mut self, names: &[Expr]) -> Result<Vec<String>, Reason> {
        let mut found = Vec::new();
        for name in names {
            let ExprKind::Name(name) = &name.kind else { return Err("a state that is none".to_owned()) };
            if self.system.find_symbol(name).is_none() {
                return Err(format!("'{name}'"));
            }
            found.push(self.variable(name));
        }
        if names.is_empty() {
            found = self.system.column_names().iter().map(|name| self.variable(name)).collect();
        }
        Ok(found)
    }

    fn sum(&mut self, terms: &[(bool, Expr)]) -> Found {
        let mut total: Option<Printed> = None;
        for (negative, term) in terms {
            let term = self.print(term)?;
            refuse_length(total.as_ref())?;
            total = Some(match (total, term.kind) {
                (None, Kind::Number) if *negative => {
                    Printed::number(format!("- {}", term.at_least(Hold::Power)), Hold::Negative)
                }
                (None, Kind::Matrix(rows, columns)) if *negative => {
                    Printed::matrix(format!("each Opp {}", term.argument()), rows, columns, Hold::Call)
                }
                (None, _) => term,
                (Some(mut sum), Kind::Number) if sum.kind == Kind::Number => {
                    sum.text.push_str(if *negative { " - " } else { " + " });
                    sum.text.push_str(&term.at_least(Hold::Product));
                    Printed { hold: Hold::Sum, ..sum }
                }
                (Some(sum), Kind::Matrix(rows, columns)) if sum.kind == term.kind => {
                    let operation = if *negative { "minus" } else { "plus" };
                    let text = format!("{operation} {} {}", sum.argument(), term.argument());
                    Printed::matrix(text, rows, columns, Hold::Call)
                }
                _ => return Err("a sum of a number and a matrix".to_owned()),
            });
        }
        total.ok_or_else(|| "an empty sum".to_owned())
    }

    fn product(&mut self, factors: &[(bool, Expr)]) -> Found {
        let mut total: Option<Printed> = None;
        for (divides, factor) in factors {
            let factor = self.print(factor)?;
            refuse_length(total.as_ref())?;
            let Some(so_far) = total else {
                total = Some(match divides {
                    false => factor,
                    true => Printed::number(format!("1 / {}", factor.at_least(Hold::Power)), Hold::Product),
                });
                continue;
            };
            total = Some(match (so_far.kind, factor.kind) {
                (Kind::Number, Kind::Number) => {
                    let mut text =
                        if so_far.hold < Hold::Product { format!("({})", so_far.text) } else { so_far.text };
                    text.push_str(if *divides { " / " } else { " * " });
                    text.push_str(&factor.at_least(Hold::Power));
                    Printed::number(text, Hold::Product)
                }
                (Kind::Matrix(rows, columns), Kind::Number) => {
                    let by = if *divides { format!("Inv {}", factor.argument()) } else { factor.text };
                    let text = format!("each (Mul ({by})) {}", so_far.argument());
                    Printed::matrix(text, rows, columns, Hold::Call)
                }
                (Kind::Number, Kind::Matrix(rows, columns)) if !divides => {
                    let text = format!("each (Mul {}) {}", so_far.argument(), factor.argument());
                    Printed::matrix(text, rows, columns, Hold::Call)
                }
                (Kind::Matrix(rows, inner), Kind::Matrix(height, columns)) if inner == height && !divides => {
                    let text = format!("times {} {}", so_far.argument(), factor.argument());
                    Printed::matrix(text, rows, columns, Hold::Call)
                }
                _ => return Err("a product of shapes that do not fit".to_owned()),
            });
        }
        total.ok_or_else(|| "an empty product".to_owned())
    }

    /// A power whose exponent is not written as an integer: of halves by roots, else by the exponential function.
    fn real_power(&mut self, base: &Expr, exponent: &Expr) -> Found {
        let base = self.scalar(base)?;
        let Some(value) = rational(exponent) else {
            let exponent = self.scalar(exponent)?;
            let text = format!("Exp ({} * Ln {})", exponent.at_least(Hold::Product), base.argument());
            return Ok(Printed::number(text, Hold::Call));
        };
        let twice = &value * RBig::from(2);
        let whole = |value: &RBig| value.denominator().is_one();
        let count = if whole(&value) { value.numerator() } else { twice.numerator() };
        match i32::try_from(count.clone()) {
            Ok(count) if whole(&value) => Ok(power(&base, count)),
            Ok(count) if whole(&twice) => {
                let root = Printed::number(format!("Sqrt {}", base.argument()), Hold::Call);
                Ok(power(&root, count))
            }
            _ => {
                let exponent = number(&value);
                let text = format!("Exp ({} * Ln {})", exponent.at_least(Hold::Product), base.argument());
                Ok(Printed::number(text, Hold::Call))
            }
        }
    }

    fn blocks(&mut self, rows: &[Vec<Expr>]) -> Found {
        let mut printed = Vec::new();
        for row in rows {
            let row: Vec<Printed> = row.iter().map(|block| self.print(block)).collect::<Result<_, _>>()?;
            printed.push(row);
        }
        let all_numbers = printed.iter().flatten().all(|block| block.kind == Kind::Number);
        if all_numbers {
            let columns = printed.first().map_or(0, Vec::len);
            let row = |row: &Vec<Printed>| {
                let entries: Vec<&str> = row.iter().map(|block| block.text.as_str()).collect();
                format!("[{}]", entries.join("; "))
            };
            let text = format!("[{}]", printed.iter().map(row).collect::<Vec<_>>().join("; "));
            return Ok(Printed::matrix(text, printed.len(), columns, Hold::Name));
        }
        let shape = |block: &Printed| match block.kind {
            Kind::Number => (1, 1),
            Kind::Matrix(rows, columns) => (rows, columns),
        };
        let (mut height, mut whole) = (0, None::<Printed>);
        for row in &printed {
            let mut line: Option<Printed> = None;
            let (mut rows, mut columns) = (0, 0);
            for block in row {
                let (down, across) = shape(block);
                (rows, columns) = (down, columns + across);
                let block = block.as_matrix();
                line = Some(match line {
                    None => block,
                    Some(line) => joined("beside", &line, &block, (rows, columns)),
                });
            }
            let line = line.ok_or_else(|| "an empty row".to_owned())?;
            height += rows;
            whole = Some(match whole {
                None => line,
                Some(whole) => joined("above", &whole, &line, (height, columns)),
            });
        }
        whole.ok_or_else(|| "an empty matrix".to_owned())
    }
}

fn refuse_length(found: Option<&Printed>) -> Result<(), Reason> {
    match found.is_some_and(|found| found.text.len() > LONGEST) {
        true => Err(format!("it is longer than {LONGEST} characters")),
        false => Ok(()),
    }
}

/// Two matrices in one, which is not made a number here.
fn joined(how: &str, a: &Printed, b: &Printed, (rows, columns): (usize, usize)) -> Printed {
    let text = format!("{how} {} {}", a.argument(), b.argument());
    Printed { text, kind: Kind::Matrix(rows, columns), hold: Hold::Call }
}

/// What a function of numbers is called in the library.
fn function(name: &str) -> Option<&'static str> {
    Some(match name {
        "sin" => "Sin",
        "cos" => "Cos",
        "tan" => "Tan",
        "cot" => "Cot",
        "sec" => "Sec",
        "csc" => "Csc",
        "sqrt" => "Sqrt",
        "exp" => "Exp",
        "log" => "Ln",
        "atan" => "Atan",
        "sinh" => "Sinh",
        "cosh" => "Cosh",
        "tanh" => "Tanh",
        "abs" => "Abs",
        "sign" => "Sign",
        "atan2" => "Atan2",
        _ => return None,
    })
}

fn number(value: &RBig) -> Printed {
    let (above, below) = (value.numerator().to_string(), value.denominator().to_string());
    match below.as_str() {
        "1" => Printed::number(above, Hold::Name),
        _ => Printed::number(format!("{above} / {below}"), Hold::Product),
    }
}

/// The language has no exponent beyond a thousand: in Coq it is a natural number, which is as long as it is great.
fn power(base: &Printed, exponent: i32) -> Printed {
    let text = format!("{} ^ {}", base.at_least(Hold::Call), exponent.unsigned_abs());
    match exponent {
        ..0 => Printed::number(format!("1 / {text}"), Hold::Product),
        _ => Printed::number(text, Hold::Power),
    }
}

/// The value of an expression of numbers alone.
fn rational(expr: &Expr) -> Option<RBig> {
    match &expr.kind {
        ExprKind::Number(value) => Some(value.clone()),
        ExprKind::Sum(terms) => terms.iter().try_fold(RBig::ZERO, |sum, (negative, term)| {
            let value = rational(term)?;
            Some(if *negative { sum - value } else { sum + value })
        }),
        ExprKind::Product(factors) => factors.iter().try_fold(RBig::ONE, |product, (divides, factor)| {
            let value = rational(factor)?;
            match divides {
                true if value.is_zero() => None,
                true => Some(product / value),
                false => Some(product * value),
            }
        }),
        _ => None,
    }
}

/// What a definition of this value is.
pub(crate) fn kind_of(value: &Value) -> Result<Kind, Reason> {
    match value {
        Value::Scalar(_) => Ok(Kind::Number),
        Value::Matrix(matrix) if (matrix.rows, matrix.columns) == (1, 1) => Ok(Kind::Number),
        Value::Matrix(matrix) => Ok(Kind::Matrix(matrix.rows, matrix.columns)),
        other => Err(other.describe()),
    }
}
