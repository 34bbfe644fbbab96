//! From syntax to meaning: expressions of the language as values in a system's graph.

use super::codes::Code;
use super::error::{Problem, nearest};
use super::foreign::call_of;
use super::matrices::transpose;
use super::model::{Assignment, Kind, Matrix, Role, System, Value};
use super::problems::Cause;
use super::read::is_a_word;
use dashu::rational::RBig;
use palmistry_math::expression::syntax::{Expr, ExprKind, Name, Span};
use palmistry_math::expression::{Need, NodeId, Symbol, gradient};
use palmistry_math::number::Function;

/// A graph with more nodes than this is no longer something a person wrote down.
pub(super) const LARGEST_GRAPH: usize = 4_000_000;

/// The functions of the language beside [`Function::ALL`].
pub(super) const OTHER_FUNCTIONS: [&str; 22] = [
    "tan",
    "cot",
    "sec",
    "csc",
    "L",
    "bracket",
    "d",
    "det",
    "rank",
    "pole",
    "transpose",
    "inverse",
    "dot",
    "cross",
    "sum",
    "product",
    "observable",
    "unobservable",
    "identifiable",
    "unidentifiable",
    "solutions",
    "codistribution",
];

/// What a name should have been.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Wanted {
    State,
    Symbol,
    Field,
    Name,
}

impl System {
    /// The value of an expression.
    pub fn elaborate(&mut self, expr: &Expr) -> Result<Value, Problem> {
        if self.graph.len() > LARGEST_GRAPH {
            let message = format!("this grows beyond {LARGEST_GRAPH} operations");
            return Err(Problem::new(Code::TooLarge, &expr.span, message, "here")
                .help("use fewer or shorter Lie derivatives"));
        }
        match &expr.kind {
            ExprKind::Number(value) => Ok(Value::Scalar(self.graph.rational(value.clone()))),
            ExprKind::Name(name) => self.named(name, &expr.span),
            ExprKind::Call(name, arguments) => self.call(name, arguments, &expr.span),
            ExprKind::Sum(terms) => {
                let mut total: Option<Value> = None;
                for (negative, term) in terms {
                    let mut value = self.elaborate(term)?;
                    if *negative {
                        value = self.map(value, &term.span, |system, id| system.graph.neg(id))?;
                    }
                    total = Some(match total {
                        None => value,
                        Some(sum) => self.entrywise(sum, value, &term.span)?,
                    });
                }
                total.ok_or_else(|| Problem::new(Code::Syntax, &expr.span, "an empty sum", "here"))
            }
            ExprKind::Product(factors) => {
                let mut total: Option<Value> = None;
                for (divides, factor) in factors {
                    let value = self.elaborate(factor)?;
                    total = Some(match total {
                        None => value,
                        Some(product) => self.multiply(product, value, *divides, &factor.span)?,
                    });
                }
                total.ok_or_else(|| Problem::new(Code::Syntax, &expr.span, "an empty product", "here"))
            }
            ExprKind::Power(base, exponent) => {
                let value = self.elaborate(base)?;
                let value = match (value.as_number(), value) {
                    (Some(number), _) => number,
                    (None, Value::Matrix(_)) => {
                        let message = "a matrix has no powers";
                        return Err(Problem::new(Code::Value, &expr.span, message, "this power").help(
                            "an inverse is written inverse(M), a product M*M, a transpose transpose(M)",
                        ));
                    }
                    _ => self.scalar(base)?,
                };
                if *exponent < 0 {
                    self.need(value, Need::NotZero);
                }
                Ok(Value::Scalar(self.graph.power(value, *exponent)))
            }
            ExprKind::RealPower(base, exponent) => self.real_power(base, exponent, &expr.span),
            ExprKind::Matrix(rows) => self.blocks(rows, &expr.span),
            ExprKind::At(inner, list) => {
                let (value, domain) = self.apart(|system| system.elaborate(inner))?;
                if matches!(
                    value,
                    Value::CodistributionRank
                        | Value::Pole { .. }
                        | Value::Visible { .. }
                        | Value::Solutions(_)
                        | Value::Infinity
                ) {
                    let message = format!("{} is not taken at a point", value.describe());
                    return Err(Problem::new(Code::Value, &expr.span, message, "here")
                        .help("write 'where name = value' behind the claim"));
                }
                let assignment = self.assignment(list)?;
                let guards = self.guards_of(&domain);
                let guards = self.substitute_guards(&guards, &assignment);
                self.need_all(guards);
                Ok(self.substitute(value, &assignment))
            }
            ExprKind::Indexed(indexed) => Err(self.without_index(indexed, &expr.span)),
        }
    }

    /// The value of an expression that has to be a number.
    pub fn scalar(&mut self, expr: &Expr) -> Result<NodeId, Problem> {
        let value = self.elaborate(expr)?;
        value.as_number().ok_or_else(|| {
            let message = format!("expected a number, found {}", value.describe());
            let problem = Problem::new(Code::Value, &expr.span, message, "this");
            match value {
                Value::Matrix(_) => problem.help(
                    "numbers stand in lists, as in output x, y, or with a name of their own; a range is an entry, as in sample k in [1, 2]",
                ),
                Value::Infinity => problem.help("there is no infinite number: a bound on one side is x >= 0"),
                _ => problem.help("it stands alone on one side of a claim"),
            }
        })
    }

    /// The value of an expression that has to be an exact rational number.
    pub fn rational(&mut self, expr: &Expr) -> Result<RBig, Problem> {
        let id = self.scalar(expr)?;
        self.graph.constant_value(id).cloned().ok_or_else(|| {
            Problem::new(Code::Number, &expr.span, "expected a rational number", "this is none")
                .help("such as 2, 0.5 or 1/3")
        })
    }

    /// The meaning of `name = value, ...`.
    pub fn assignment(&mut self, list: &[(Name, Expr)]) -> Result<Assignment, Problem> {
        let mut assignment = Assignment::new();
        for (name, value) in list {
            let Some(symbol) = self.find_symbol(&name.text) else {
                return Err(self.unknown(&name.text, &name.span, Wanted::Symbol));
            };
            let value = self.scalar(value)?;
            if assignment.insert(symbol, value).is_some() {
                return Err(Problem::new(
                    Code::Twice,
                    &name.span,
                    format!("'{}' is given twice", name.text),
                    "the second time",
                ));
            }
        }
        Ok(assignment)
    }

    /// A value with symbols replaced.
    pub(crate) fn substitute(&mut self, value: Value, assignment: &Assignment) -> Value {
        let graph = &mut self.graph;
        let mut matrix = |m: Matrix| Matrix { entries: graph.substitute(&m.entries, assignment), ..m };
        match value {
            Value::Matrix(m) => Value::Matrix(matrix(m)),
            Value::Rank(m) => Value::Rank(matrix(m)),
            Value::Scalar(id) => Value::Scalar(graph.substitute(&[id], assignment)[0]),
            Value::Pole { expression, factor } => {
                let both = graph.substitute(&[expression, factor], assignment);
                Value::Pole { expression: both[0], factor: both[1] }
            }
            Value::Visible { functions, is_observable } => {
                Value::Visible { functions: graph.substitute(&functions, assignment), is_observable }
            }
            Value::Solutions(id) => Value::Solutions(graph.substitute(&[id], assignment)[0]),
            Value::CodistributionRank | Value::Infinity => value,
        }
    }

    fn named(&mut self, name: &str, span: &Span) -> Result<Value, Problem> {
        if let Some(value) = self.definitions.get(name).cloned() {
            self.need_definition(name);
            return Ok(value);
        }
        if let Some(symbol) = self.find_symbol(name) {
            return Ok(Value::Scalar(self.graph.symbol(symbol)));
        }
        if let Some(value) = self.named_in_experiment(name, span)? {
            return Ok(value);
        }
        match name {
            "pi" => Ok(Value::Scalar(self.graph.pi())),
            "rank" => Ok(Value::CodistributionRank),
            "infinity" => Ok(Value::Infinity),
            _ => Err(self.unknown(name, span, Wanted::Name)),
        }
    }

    /// The error for a name that nobody has declared as what it should be.
    pub(crate) fn unknown(&self, name: &str, span: &Span, wanted: Wanted) -> Problem {
        let what = match wanted {
            Wanted::Field => "field",
            Wanted::State => "state",
            Wanted::Symbol => "state or parameter",
            Wanted::Name => "name",
        };
        if let Some(problem) = self.unknown_component(name, span) {
            return problem;
        }
        let is_value = self.find_symbol(name).is_some() || self.definitions.contains_key(name);
        let is_field = self.field(name).is_some();
        let problem = match is_value || is_field {
            true => {
                let message = match is_value {
                    true => format!("'{name}' is no {what}"),
                    false => format!("'{name}' is a field"),
                };
                Problem::new(Code::OtherKind, span, message, "declared above as something else")
            }
            false => {
                let message = format!("unknown {what} '{name}'");
                Problem::new(Code::UnknownName, span, message, "not declared above")
                    .because(Cause::Unknown(name.to_owned()))
            }
        };
        let help = match (is_value, is_field, wanted) {
            (true, _, Wanted::State) => {
                "a constant has neither a rate nor an initial condition, but a value, as in param k = 1"
                    .to_owned()
            }
            (true, _, Wanted::Field) => "the field stands first, as in L(f, x)".to_owned(),
            (_, true, Wanted::Name) if self.field(name).is_some_and(|field| field.role == Role::Input) => {
                format!(
                    "a field stands first in L({name}, x) and bracket({name}, g); a signal that drives the system is declared instead, as in known u(t)"
                )
            }
            (_, true, _) => {
                format!(
                    "a field stands first in L({name}, x) and bracket({name}, g); its component of x is L({name}, x)"
                )
            }
            _ => self.habit(name, wanted).unwrap_or_else(|| self.nearest_or_declared(name, wanted)),
        };
        problem.help(help)
    }

    /// The nearest name that is known, or how one is declared.
    fn nearest_or_declared(&self, name: &str, wanted: Wanted) -> String {
        let symbols =
            self.symbols.iter().filter(|(_, info)| wanted != Wanted::State || info.kind == Kind::State);
        let symbols = symbols.map(|(symbol, _)| self.symbol_name(*symbol));
        let definitions = self.definitions.keys().map(String::as_str).chain(["pi", "rank", "infinity"]);
        let written = self.fields.iter().filter(|field| !self.is_made(field));
        let fields: Vec<&str> =
            written.chain(&self.imported_fields).map(|field| field.name.as_str()).collect();
        let near = match wanted {
            Wanted::Field => nearest(name, fields.iter().copied()),
            Wanted::State => nearest(name, symbols.chain(["others"])),
            Wanted::Symbol => nearest(name, symbols),
            Wanted::Name => nearest(name, symbols.chain(definitions)),
        };
        match (near, wanted) {
            (Some(near), _) => format!("perhaps you meant '{near}'"),
            (None, Wanted::Field) if fields.is_empty() => {
                "a field is declared above, as in drift f, and a rate for each state below it".to_owned()
            }
            (None, Wanted::Field) => format!("the fields above are: {}", fields.join(", ")),
            (None, Wanted::State) => format!("declare it above: state {name}"),
            (None, Wanted::Symbol) => format!("declare it above: 'state {name}' or 'param {name}'"),
            (None, Wanted::Name) if is_a_word(name) => {
                format!("'{name}' is a word of the language, and has no value of its own")
            }
            (None, Wanted::Name) if name.contains('.') => {
                format!(
                    "a name with a dot is one of an imported file, as in use {} = \"other.proof\"",
                    name.split('.').next().unwrap_or_default()
                )
            }
            (None, Wanted::Name) => format!(
                "declare it: 'state {name}', 'param {name}', 'let {name} = ...', or 'known {name}(t)' for a signal"
            ),
        }
    }

    fn call(&mut self, name: &str, arguments: &[Expr], span: &Span) -> Result<Value, Problem> {
        let one = |system: &mut Self| -> Result<NodeId, Problem> {
            match arguments {
                [argument] => system.scalar(argument),
                _ => Err(Problem::new(
                    Code::Arguments,
                    span,
                    format!("'{name}' takes one argument"),
                    format!("{} here", arguments.len()),
                )
                .help(call_of(name))),
            }
        };
        if let Some(function) = Function::ALL.into_iter().find(|f| f.name() == name) {
            let argument = one(self)?;
            if let Some(need) = Need::of(function) {
                self.need(argument, need);
            }
            return Ok(Value::Scalar(self.graph.apply(function, argument)));
        }
        match name {
            "tan" | "cot" | "sec" | "csc" => {
                let argument = one(self)?;
                let sine = self.graph.apply(Function::Sin, argument);
                let cosine = self.graph.apply(Function::Cos, argument);
                let unit = self.graph.integer(1);
                let (top, bottom) = match name {
                    "tan" => (sine, cosine),
                    "cot" => (cosine, sine),
                    "sec" => (unit, cosine),
                    _ => (unit, sine),
                };
                self.need(bottom, Need::NotZero);
                Ok(Value::Scalar(self.graph.div(top, bottom)))
            }
            "L" => self.lie(arguments, span),
            "bracket" => self.bracket_column(arguments, span),
            "codistribution" => self.codistribution(arguments, span),
            "d" => self.differential_row(arguments, span),
            "det" | "rank" => match arguments {
                [argument] => match self.elaborate(argument)? {
                    Value::Matrix(matrix) if name == "rank" => Ok(Value::Rank(matrix)),
                    Value::Matrix(matrix) => self.determinant(&matrix, &argument.span),
                    other => {
                        let message = format!("'{name}' takes a matrix, not {}", other.describe());
                        Err(Problem::new(Code::Arguments, &argument.span, message, "this")
                            .help(call_of(name)))
                    }
                },
                _ => Err(Problem::new(Code::Arguments, span, format!("'{name}' takes one matrix"), "here")
                    .help(call_of(name))),
            },
            "transpose" | "inverse" => match arguments {
                [argument] => match self.elaborate(argument)? {
                    Value::Matrix(matrix) if name == "transpose" => Ok(Value::Matrix(transpose(&matrix))),
                    Value::Matrix(matrix) => self.inverse(&matrix, &argument.span),
                    other => {
                        let message = format!("'{name}' takes a matrix, not {}", other.describe());
                        Err(Problem::new(Code::Arguments, &argument.span, message, "this")
                            .help(call_of(name)))
                    }
                },
                _ => Err(Problem::new(Code::Arguments, span, format!("'{name}' takes one matrix"), "here")
                    .help(call_of(name))),
            },
            "dot" | "cross" => match arguments {
                [a, b] => match (self.elaborate(a)?, self.elaborate(b)?) {
                    (Value::Matrix(x), Value::Matrix(y)) if name == "dot" => self.dot(&x, &y, span),
                    (Value::Matrix(x), Value::Matrix(y)) => self.cross(&x, &y, span),
                    (x, y) => {
                        let message = format!("'{name}' of {} and {}", x.describe(), y.describe());
                        Err(Problem::new(Code::Arguments, span, message, "two vectors are needed")
                            .help("as in [x; y; z]"))
                    }
                },
                _ => Err(Problem::new(Code::Arguments, span, format!("'{name}' takes two vectors"), "here")
                    .help(call_of(name))),
            },
            "solutions" => match arguments {
                [expression] => Ok(Value::Solutions(self.scalar(expression)?)),
                _ => Err(Problem::new(
                    Code::Arguments,
                    span,
                    "'solutions' takes one unknown, or one expression",
                    "here",
                )
                .help(call_of(name))),
            },
            "pole" => match arguments {
                [expression, factor] => {
                    let expression = self.scalar(expression)?;
                    let factor = self.scalar(factor)?;
                    Ok(Value::Pole { expression, factor })
                }
                _ => Err(Problem::new(
                    Code::Arguments,
                    span,
                    "'pole' takes an expression and what vanishes at the pole",
                    "here",
                )
                .help(call_of(name))),
            },
            _ => {
                if let Some(word) = super::visible::VISIBLE.into_iter().find(|(word, ..)| *word == name) {
                    return self.visible(word, arguments, span);
                }
                if let Some(found) = self.composed(name, arguments, span) {
                    return found;
                }
                let message = format!("unknown function '{name}'");
                let problem = Problem::new(Code::UnknownName, span, message, "here");
                Err(problem.help(self.advice_for_function(name, arguments)))
            }
        }
    }

    /// `d(e)`, a row of as many entries as there are states; or `d(e, x, y)`, only the entries of `x` and `y`. A row of one
    /// entry is a number wherever a number is meant.
    fn differential_row(&mut self, arguments: &[Expr], span: &Span) -> Result<Value, Problem> {
        let Some((first, names)) = arguments.split_first() else {
            return Err(Problem::new(Code::Arguments, span, "'d' takes an expression", "here"));
        };
        let expression = self.scalar(first)?;
        let states = self.states_of(names, span)?;
        let entries = gradient(&mut self.graph, expression, &states);
        Ok(Value::Matrix(Matrix { rows: 1, columns: entries.len(), entries }))
    }

    /// The states that are named, or all where none is.
    pub(super) fn states_of(&mut self, names: &[Expr], span: &Span) -> Result<Vec<Symbol>, Problem> {
        let mut states = Vec::new();
        for name in names {
            let id = self.scalar(name)?;
            let Some(symbol) = self.graph.as_symbol(id) else {
                return Err(Problem::new(
                    Code::OtherKind,
                    &name.span,
                    "expected the name of a state",
                    "this is none",
                ));
            };
            states.push(symbol);
        }
        if names.is_empty() {
            states = self.unknowns();
            self.states_are_final = true;
        }
        if states.is_empty() {
            return Err(Problem::new(Code::Field, span, "there is no state to differentiate by", "here")
                .help("declare 'state x, ...'"));
        }
        Ok(states)
    }
}
