//! What the names of a script stand for, assignment by assignment: symbols, expressions of them, vectors, matrices. Python's and
//! MATLAB's scripts are read by it, and never run.

use super::super::expression::{ForeignExpr, ForeignKind, Span};
use super::super::functions::{self, constant, is_function};
use super::forms::{
    self, added, by_entries, each, flat, matrix, multiplied, product_of, stacked, transposed,
};
use super::meaning::{keeps_the_value, meaning, named_function};
use super::syntax::{Syntax, SyntaxKind};
use super::tokens::Dialect;
use palmistry_io::foreign::Budget;
use palmistry_lang::{Code, Problem};
use std::collections::{BTreeMap, BTreeSet};

/// A matrix with more entries is refused.
pub(super) const MOST_ENTRIES: usize = 20_000;

/// What a name stands for.
#[derive(Clone, Debug)]
pub(crate) enum ScriptValue {
    /// A number: an expression of symbols and definitions.
    One(ForeignExpr),
    /// A matrix, row by row; a list is a column.
    Many { rows: usize, entries: Vec<ForeignExpr>, form: Form },
    /// Something that is no number and no matrix.
    Else,
}

/// What a matrix is in its language: by that it is joined and multiplied.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Form {
    /// Of MATLAB, or of SymPy.
    Matrix,
    /// A list of Python.
    List,
    /// A list of lists of Python.
    Rows,
    /// An array of numpy with one index.
    Vector,
    /// An array of numpy with two.
    Array,
}

impl Form {
    pub fn is_list(self) -> bool {
        matches!(self, Form::List | Form::Rows)
    }
}

impl ScriptValue {
    /// All entries, as they are.
    fn parts(&self) -> &[ForeignExpr] {
        match self {
            ScriptValue::One(one) => std::slice::from_ref(one),
            ScriptValue::Many { entries, .. } => entries,
            ScriptValue::Else => &[],
        }
    }

    /// All entries, row by row.
    pub fn entries(self) -> Option<Vec<ForeignExpr>> {
        match self {
            ScriptValue::One(one) => Some(vec![one]),
            ScriptValue::Many { entries, .. } => Some(entries),
            ScriptValue::Else => None,
        }
    }
}

/// Why something could not be read: where, what, and what to do.
type Broken = (Span, String, Option<String>);

/// The names of a script.
pub(crate) struct ScriptWorkspace<'b> {
    /// What the values of all names together may cost.
    budget: &'b Budget,
    bound: BTreeMap<String, Result<ScriptValue, Broken>>,
    symbols: BTreeSet<String>,
    /// Definitions in the order in which they are made: name and expression.
    pub definitions: Vec<(String, ForeignExpr)>,
    /// The names of definitions, and of those that several have, the last number that was put behind.
    defined: BTreeSet<String>,
    counts: BTreeMap<String, usize>,
    /// The definitions that are whole numbers.
    pub(super) wholes: BTreeMap<String, i64>,
    /// How often each symbol stands in definitions and in what names stand for.
    used: BTreeMap<String, usize>,
    /// Names that are kept as values and get no definition.
    pub plain: BTreeSet<String>,
    dialect: Dialect,
    /// Names that Python takes from modules that are not read, each with the module.
    pub elsewhere: BTreeMap<String, String>,
    /// Names that Python takes from SymPy.
    pub from_sympy: BTreeSet<String>,
    /// Functions of time, or of something else: their names, what they are functions of, and where.
    pub functions: BTreeMap<String, (Vec<ForeignExpr>, Span)>,
}

type Valued = Result<ScriptValue, Problem>;

impl<'b> ScriptWorkspace<'b> {
    /// No names yet.
    pub fn new(budget: &'b Budget, dialect: Dialect) -> ScriptWorkspace<'b> {
        ScriptWorkspace {
            budget,
            dialect,
            elsewhere: BTreeMap::new(),
            from_sympy: BTreeSet::new(),
            functions: BTreeMap::new(),
            bound: BTreeMap::new(),
            symbols: BTreeSet::new(),
            definitions: Vec::new(),
            defined: BTreeSet::new(),
            counts: BTreeMap::new(),
            wholes: BTreeMap::new(),
            used: BTreeMap::new(),
            plain: BTreeSet::new(),
        }
    }

    /// Makes a symbol and gives it as a value.
    pub fn symbol(&mut self, name: &str, span: &Span) -> Valued {
        if self.defined.contains(name) {
            return Err(Problem::new(
                Code::Foreign,
                span,
                format!("'{name}' has a value already, and becomes a symbol here"),
                "this",
            )
            .help("give one of the two another name"));
        }
        self.symbols.insert(name.to_owned());
        Ok(ScriptValue::One(ForeignExpr::name(name, span)))
    }

    /// Whether a definition has a name.
    pub fn has_definition(&self, name: &str) -> bool {
        self.defined.contains(name)
    }

    /// Whether a name stands for several numbers, or for something that could not be read.
    pub fn holds_a_list(&self, name: &str) -> bool {
        matches!(self.bound.get(name), Some(Ok(ScriptValue::Many { .. }) | Err(_)))
    }

    /// Two lists, one behind the other.
    pub fn chained(&self, left: ScriptValue, right: ScriptValue, span: &Span) -> Valued {
        forms::chained(left, right, span)
    }

    /// Binds a name.
    pub fn bind(&mut self, name: &str, value: ScriptValue) {
        value.parts().iter().for_each(|one| count_names(&mut self.used, one, true));
        self.rebind(name, Ok(value));
    }

    fn rebind(&mut self, name: &str, value: Result<ScriptValue, Broken>) {
        if let Some(Ok(before)) = self.bound.insert(name.to_owned(), value) {
            before.parts().iter().for_each(|one| count_names(&mut self.used, one, false));
        }
    }

    /// Binds a name to an error: it is reported only where the name is used.
    pub fn break_name(&mut self, name: &str, why: Problem) {
        self.rebind(name, Err((why.span, why.message, why.help)));
    }

    /// What a name stands for, if anything.
    pub fn get(&self, name: &str) -> Option<Valued> {
        self.bound.get(name).map(|bound| match bound {
            // who uses a value has it once more
            Ok(value) => {
                let parts = value.parts();
                let place = parts.first().map_or(0..0, |one| one.span.clone());
                let size = parts.iter().map(ForeignExpr::size).sum();
                self.budget.nodes(size).map_err(|spent| super::super::too_much(&place, spent))?;
                Ok(value.clone())
            }
            Err((span, message, help)) => {
                Err(Problem { help: help.clone(), ..Problem::new(Code::Foreign, span, message, "this") })
            }
        })
    }

    /// Assigns a value to a name. A number that is no symbol by itself becomes a definition.
    pub fn assign(&mut self, name: &str, value: ScriptValue) {
        let value = match value {
            ScriptValue::One(one)
                if !matches!(one.kind, ForeignKind::Name(_)) && !self.plain.contains(name) =>
            {
                // a symbol that nothing has used yet makes way for its value
                if self.symbols.contains(name) && !self.uses(name) && !one_uses(&one, name) {
                    self.symbols.remove(name);
                }
                let mut own = name.to_owned();
                while self.symbols.contains(&own) || self.defined.contains(&own) {
                    let count = self.counts.entry(name.to_owned()).or_insert(1);
                    *count += 1;
                    own = format!("{name}_{count}");
                }
                let span = one.span.clone();
                // by those before it: a number that is doubled sixty times is not looked for in all of its parts
                if let Some(number) = self.whole(&one) {
                    self.wholes.insert(own.clone(), number);
                }
                self.defined.insert(own.clone());
                count_names(&mut self.used, &one, true);
                self.definitions.push((own.clone(), one));
                ScriptValue::One(ForeignExpr::name(own, &span))
            }
            other => other,
        };
        self.bind(name, value);
    }

    /// Whether a value of another name, or a definition, is made of a symbol.
    fn uses(&self, symbol: &str) -> bool {
        let mut own = BTreeMap::new();
        if let Some(Ok(value)) = self.bound.get(symbol) {
            value.parts().iter().for_each(|one| count_names(&mut own, one, true));
        }
        self.used.get(symbol).copied().unwrap_or(0) > own.get(symbol).copied().unwrap_or(0)
    }

    /// The value of an expression.
    pub fn value(&mut self, syntax: &Syntax) -> Valued {
        let span = &syntax.span;
        match &syntax.kind {
            SyntaxKind::Name(name) if self.bound.contains_key(name) => {
                // a number stands where it is used
                Ok(match self.get(name).unwrap_or(Ok(ScriptValue::Else))? {
                    ScriptValue::One(one) => ScriptValue::One(ForeignExpr { span: span.clone(), ..one }),
                    other => other,
                })
            }
            SyntaxKind::List(list) => {
                let parts: Vec<ScriptValue> =
                    list.iter().map(|part| self.value(part)).collect::<Result<_, _>>()?;
                forms::list(parts, span)
            }
            SyntaxKind::Rows(rows) => {
                let rows = rows
                    .iter()
                    .map(|row| row.iter().map(|part| self.value(part)).collect::<Result<Vec<_>, _>>())
                    .collect::<Result<Vec<_>, _>>()?;
                stacked(rows, span)
            }
            SyntaxKind::Prime(inner) => Ok(transposed(self.value(inner)?)),
            SyntaxKind::Text(_) => Ok(ScriptValue::Else),
            SyntaxKind::Member(inner, name) if name == "T" => Ok(transposed(self.value(inner)?)),
            SyntaxKind::Call(..) => self.call(syntax),
            SyntaxKind::Index(inner, indices) => self.indexed(inner, indices, span),
            SyntaxKind::Sum(terms) => {
                let mut sum: Option<ScriptValue> = None;
                for (subtracted, term) in terms {
                    let term = self.value(term)?;
                    sum = Some(match sum {
                        None if *subtracted => each(term, |one| one.negative()),
                        None => term,
                        Some(sum) => added(sum, term, *subtracted, span)?,
                    });
                }
                Ok(flat(sum.unwrap_or(ScriptValue::Else), span))
            }
            SyntaxKind::Product(factors) => {
                let is_list =
                    |value: &ScriptValue| matches!(value, ScriptValue::Many { form, .. } if form.is_list());
                let mut product: Option<ScriptValue> = None;
                for (divided, factor) in factors {
                    let factor = self.value(factor)?;
                    product = Some(match (product, factor) {
                        (None, factor) => factor,
                        (Some(list), ScriptValue::One(times)) | (Some(ScriptValue::One(times)), list)
                            if !divided && is_list(&list) =>
                        {
                            forms::repeated(list, self.whole(&times), span)?
                        }
                        (Some(product), factor) => multiplied(product, factor, *divided, span)?,
                    });
                }
                Ok(flat(product.unwrap_or(ScriptValue::Else), span))
            }
            SyntaxKind::Pointwise(factors) => {
                let mut product: Option<ScriptValue> = None;
                for (divided, factor) in factors {
                    let factor = self.value(factor)?;
                    product = Some(match product {
                        None => factor,
                        Some(product) => {
                            by_entries(product, factor, &|a, b| product_of(a, b, *divided), span)?
                        }
                    });
                }
                Ok(flat(product.unwrap_or(ScriptValue::Else), span))
            }
            _ => self.one(syntax).map(ScriptValue::One),
        }
    }

    /// An expression that has to be a number.
    pub fn one(&mut self, syntax: &Syntax) -> Result<ForeignExpr, Problem> {
        let mut special = |part: &Syntax| match &part.kind {
            SyntaxKind::Name(name) => Some(match self.get(name) {
                Some(Ok(ScriptValue::One(one))) => Ok(ForeignExpr { span: part.span.clone(), ..one }),
                Some(Ok(ScriptValue::Many { entries, .. })) => match <[_; 1]>::try_from(entries) {
                    Ok([one]) => Ok(one),
                    Err(_) => {
                        Err(Problem::new(Code::Foreign, &part.span, format!("'{name}' is no number"), "this"))
                    }
                },
                Some(Ok(ScriptValue::Else)) => {
                    Err(Problem::new(Code::Foreign, &part.span, format!("'{name}' is no number"), "this"))
                }
                Some(Err(problem)) => Err(problem),
                None => match constant(name, &part.span) {
                    Some(value) if name != "E" => Ok(value),
                    _ => Err(Problem::new(
                        Code::Foreign,
                        &part.span,
                        format!("nothing says what '{name}' is"),
                        "this name",
                    )
                    .help(format!("declare '{name}' as a symbol above its use"))),
                },
            }),
            SyntaxKind::Call(..) | SyntaxKind::Index(..) if part.span != syntax.span => {
                match self.value(part) {
                    Ok(ScriptValue::One(one)) => Some(Ok(one)),
                    Ok(ScriptValue::Many { entries, .. }) if entries.len() == 1 => {
                        entries.into_iter().next().map(Ok)
                    }
                    Ok(_) => Some(Err(Problem::new(Code::Foreign, &part.span, "this is no number", "this"))),
                    Err(problem) => Some(Err(problem)),
                }
            }
            _ => None,
        };
        meaning(syntax, &mut special)
    }

    /// `x[0]`, `A[0, 1]` of Python.
    fn indexed(&mut self, inner: &Syntax, indices: &[Syntax], span: &Span) -> Valued {
        let refused = |what: &str| {
            Problem::new(Code::Foreign, span, what.to_owned(), "this")
                .help("elements are counted from 0; write the symbol, or the element's formula")
        };
        let ScriptValue::Many { rows, entries, form } = self.value(inner)? else {
            return Err(refused("this has no elements"));
        };
        let mut numbers = Vec::new();
        for index in indices {
            let number = self.one(index).ok().and_then(|index| self.whole(&index));
            numbers.push(number.ok_or_else(|| refused("elements by such an index are not read"))?);
        }
        let columns = entries.len() / rows.max(1);
        // from the end, where it is negative
        let place = |number: i64, count: usize| {
            let number = if number < 0 { number.checked_add(count as i64)? } else { number };
            usize::try_from(number).ok().filter(|place| *place < count)
        };
        let found = match (form, numbers.as_slice()) {
            (Form::List | Form::Vector | Form::Matrix, [at]) => place(*at, entries.len()),
            (Form::Rows | Form::Array, [at]) => {
                let row = place(*at, rows).ok_or_else(|| refused("there is no such row"))?;
                let entries: Vec<ForeignExpr> = entries[row * columns..(row + 1) * columns].to_vec();
                let form = if form == Form::Rows { Form::List } else { Form::Vector };
                return Ok(ScriptValue::Many { rows: entries.len(), entries, form });
            }
            (Form::Matrix | Form::Array, [row, column]) => {
                place(*row, rows).zip(place(*column, columns)).map(|(row, column)| row * columns + column)
            }
            _ => return Err(refused("elements by such indices are not read")),
        };
        let found = found.ok_or_else(|| refused("there is no such element"))?;
        Ok(ScriptValue::One(ForeignExpr { span: span.clone(), ..entries[found].clone() }))
    }

    /// An element of what a name stands for, in MATLAB; a call of it is nothing in Python.
    fn element_of(&mut self, name: &str, arguments: &[Syntax], span: &Span) -> Option<Valued> {
        let bound = match self.get(name)? {
            Ok(bound) => bound,
            // why something is not there is reported where it is used
            Err(why) => return Some(Err(why)),
        };
        let entries = match bound {
            ScriptValue::Else => return None,
            ScriptValue::One(one) => vec![one],
            ScriptValue::Many { entries, .. } => entries,
        };
        if self.dialect == Dialect::Python {
            let message = format!("'{name}' is no function, and a bracket stands behind it");
            return Some(Err(Problem::new(Code::Foreign, span, message, "this")
                .help(format!("a product is written with '*': {name}*(...); an element is {name}[0]"))));
        }
        let mut numbers = Vec::new();
        for index in arguments {
            match self.count(index) {
                Ok(number) => numbers.extend(number),
                Err(why) => return Some(Err(why)),
            }
        }
        let is_whole = numbers.len() == arguments.len() && (1..=2).contains(&numbers.len());
        let place = if is_whole { self.element(name, &numbers, true) } else { None };
        let inside = place.and_then(|place| entries.get(place).cloned());
        Some(inside.map(|one| ScriptValue::One(ForeignExpr { span: span.clone(), ..one })).ok_or_else(|| {
            Problem::new(Code::Foreign, span, format!("'{name}' has no such element"), "this")
                .help("elements are counted from 1, and asked for by numbers; a product is written with '*'")
        }))
    }

    fn call(&mut self, syntax: &Syntax) -> Valued {
        let span = &syntax.span;
        let Some((name, arguments)) = named_function(syntax) else { return self.function_of_time(syntax) };
        let module = match &syntax.kind {
            SyntaxKind::Call(callee, _) => match &callee.kind {
                SyntaxKind::Member(module, _) => Some(module.as_name().unwrap_or_default()),
                _ => None,
            },
            _ => None,
        };
        if module.is_none() {
            if let Some(from) = self.elsewhere.get(name) {
                let message = format!("'{name}' comes from '{from}', which is not read");
                return Err(Problem::new(Code::Foreign, span, message, "this call")
                    .help("write its formula in its place"));
            }
            if let Some(element) = self.element_of(name, arguments, span) {
                return element;
            }
        }
        let is_numpy = matches!(module, Some("np" | "numpy"));
        match (name, arguments) {
            ("Matrix" | "ImmutableMatrix" | "MutableDenseMatrix" | "array", [list]) => {
                Ok(match self.value(list)? {
                    ScriptValue::Many { rows, entries, form } => {
                        let form = match (name, form) {
                            ("array", Form::List | Form::Vector) => Form::Vector,
                            ("array", _) => Form::Array,
                            _ => Form::Matrix,
                        };
                        ScriptValue::Many { rows, entries, form }
                    }
                    other => other,
                })
            }
            ("transpose", [inner]) => Ok(transposed(self.value(inner)?)),
            ("simplify" | "expand" | "vpa" | "sym", [inner])
                if !matches!(inner.kind, SyntaxKind::Text(_)) =>
            {
                self.value(inner)
            }
            ("collect", [inner]) if self.dialect == Dialect::Matlab => self.value(inner),
            (_, [inner])
                if keeps_the_value(syntax) || self.from_sympy.contains(name) && KEPT.contains(&name) =>
            {
                self.value(inner)
            }
            // the longest side of a matrix, and all of its entries
            ("length" | "numel" | "len", [list]) => {
                let count = match self.value(list)? {
                    ScriptValue::Many { rows, entries, form } => match (name, form) {
                        ("numel", _) | (_, Form::List | Form::Vector) => entries.len(),
                        _ if entries.is_empty() => 0,
                        ("len", Form::Rows | Form::Array) => rows,
                        ("len", _) => entries.len(),
                        _ => rows.max(entries.len() / rows.max(1)),
                    },
                    _ => 1,
                };
                Ok(ScriptValue::One(ForeignExpr::integer(count as i64, span)))
            }
            ("size", [list, way]) => {
                let (value, way) = (self.value(list)?, self.count(way)?);
                let (rows, all) = match &value {
                    ScriptValue::Many { rows, entries, .. } => (*rows, entries.len()),
                    _ => (1, 1),
                };
                let size = if way == Some(1) { rows } else { all / rows.max(1) };
                Ok(ScriptValue::One(ForeignExpr::integer(size as i64, span)))
            }
            ("zeros" | "ones", sizes) if !sizes.is_empty() && sizes.len() <= 2 => {
                let value = ForeignExpr::integer(i64::from(name == "ones"), span);
                let mut size = |one: &Syntax| -> Result<usize, Problem> {
                    self.count(one)?
                        .filter(|value| *value <= MOST_ENTRIES)
                        .ok_or_else(|| Problem::new(Code::Foreign, &one.span, "this is no size", "this"))
                };
                let rows = size(&sizes[0])?;
                // one number makes a square matrix, and a vector in numpy
                let is_vector = is_numpy && sizes.len() == 1;
                let columns = if is_vector { 1 } else { size(&sizes[sizes.len() - 1])? };
                let count = rows.saturating_mul(columns);
                if count > MOST_ENTRIES {
                    return Err(Problem::new(Code::Foreign, span, "a matrix of too many entries", "this"));
                }
                let form = match (is_vector, is_numpy) {
                    (true, _) => Form::Vector,
                    (_, true) => Form::Array,
                    _ => Form::Matrix,
                };
                Ok(ScriptValue::Many { rows, entries: vec![value; count], form })
            }
            ("sym", [Syntax { kind: SyntaxKind::Text(text), span }, rest @ ..])
                if self.dialect == Dialect::Matlab =>
            {
                self.symbols_by_size(text.trim(), rest, span)
            }
            ("Symbol" | "sym", [Syntax { kind: SyntaxKind::Text(text), span }, ..]) => {
                self.symbol(text.trim(), span)
            }
            ("symbols" | "var", [Syntax { kind: SyntaxKind::Text(text), span }, ..]) => {
                let names = symbol_names(text, span)?;
                let entries: Vec<ForeignExpr> = names
                    .iter()
                    .map(|name| self.symbol(name, span).map(|value| value.entries().unwrap_or_default()))
                    .collect::<Result<Vec<_>, _>>()?
                    .concat();
                Ok(match <[_; 1]>::try_from(entries) {
                    Ok([one]) => ScriptValue::One(one),
                    Err(entries) => ScriptValue::Many { rows: entries.len(), entries, form: Form::List },
                })
            }
            ("Rational", [top, bottom]) => {
                let (top, bottom) = (self.one(top)?, self.one(bottom)?);
                Ok(ScriptValue::One(top.over(bottom)))
            }
            ("Integer" | "Float", [value, ..]) => match &value.kind {
                SyntaxKind::Text(text) => ForeignExpr::number(text, &value.span).map(ScriptValue::One),
                _ => self.value(value),
            },
            ("copy" | "locals", []) => Ok(ScriptValue::Else),
            // of each entry, as MATLAB has it
            (_, [inner]) if is_function(name) => match self.value(inner)? {
                ScriptValue::One(one) => functions::call(name, vec![one], span).map(ScriptValue::One),
                _ => Err(Problem::new(
                    Code::Foreign,
                    span,
                    format!("'{name}' of a vector is not read"),
                    "this",
                )
                .help("write it for each element")),
            },
            _ => self.one(syntax).map(ScriptValue::One),
        }
    }

    /// `sym('k')`, `sym('k', [2 1])`, `sym('1/2')` of MATLAB.
    fn symbols_by_size(&mut self, text: &str, rest: &[Syntax], span: &Span) -> Valued {
        let refused = |message: String| {
            Problem::new(Code::Foreign, span, message, "this")
                .help("a symbol is declared by its name: sym('k')")
        };
        if !text.starts_with(|c: char| c.is_alphabetic())
            || !text.chars().all(|c| c.is_alphanumeric() || c == '_')
        {
            // a number as a text is that number exactly
            let (top, bottom) = text.split_once('/').unwrap_or((text, "1"));
            let number = |text: &str| ForeignExpr::number(text.trim(), span).ok();
            return match number(top).zip(number(bottom)) {
                Some((top, bottom)) => match (top.as_number(), bottom.as_number()) {
                    (Some(top), Some(bottom)) => functions::fraction(top, bottom, span)
                        .map(ScriptValue::One)
                        .ok_or_else(|| refused(format!("'{text}' is no number"))),
                    _ => Err(refused(format!("'{text}' is no number"))),
                },
                None => Err(refused(format!("'{text}' is no name of a symbol"))),
            };
        }
        if let Some(number) = constant(text, span).filter(|_| text == "pi") {
            return Ok(ScriptValue::One(number));
        }
        let sizes = match rest.first().map(|first| &first.kind) {
            None | Some(SyntaxKind::Text(_)) => return self.symbol(text, span),
            Some(_) => match self.value(&rest[0])? {
                ScriptValue::One(one) => vec![one.clone(), one],
                ScriptValue::Many { entries, .. } => entries,
                ScriptValue::Else => Vec::new(),
            },
        };
        let sizes: Option<Vec<usize>> =
            sizes.iter().map(|one| self.whole(one).and_then(|size| usize::try_from(size).ok())).collect();
        let Some([rows, columns]) = sizes.and_then(|sizes| <[usize; 2]>::try_from(sizes).ok()) else {
            return Err(refused("this is no size of a matrix of symbols".to_owned()));
        };
        if rows.saturating_mul(columns) > MOST_ENTRIES {
            return Err(refused("a matrix of too many symbols".to_owned()));
        }
        let mut entries = Vec::new();
        for row in 1..=rows {
            for column in 1..=columns {
                let name = match (rows, columns) {
                    (1, _) => format!("{text}{column}"),
                    (_, 1) => format!("{text}{row}"),
                    _ => format!("{text}{row}_{column}"),
                };
                entries.extend(self.symbol(&name, span)?.entries().unwrap_or_default());
            }
        }
        Ok(match (rows, columns) {
            (1, 1) => entries.pop().map_or(ScriptValue::Else, ScriptValue::One),
            _ => matrix(rows, entries),
        })
    }

    /// `sym.Function('x')(t)`
    fn function_of_time(&mut self, syntax: &Syntax) -> Valued {
        if let SyntaxKind::Call(callee, arguments) = &syntax.kind
            && let Some(("Function", [Syntax { kind: SyntaxKind::Text(text), span }])) =
                named_function(callee)
        {
            let of = arguments.iter().map(|one| self.one(one)).collect::<Result<Vec<_>, _>>()?;
            self.functions.insert(text.clone(), (of, syntax.span.clone()));
            return self.symbol(text, span);
        }
        Err(Problem::new(Code::Foreign, &syntax.span, "this call cannot be read", "this"))
    }
}

/// Functions of SymPy that change the form of an expression and not its value.
const KEPT: [&str; 6] = ["factor", "collect", "together", "cancel", "sympify", "S"];

/// Counts the names in an expression, or takes them back.
fn count_names(counts: &mut BTreeMap<String, usize>, one: &ForeignExpr, more: bool) {
    one.names(&mut |name, _| match counts.get_mut(name) {
        Some(count) => *count = if more { *count + 1 } else { count.saturating_sub(1) },
        None if more => drop(counts.insert(name.to_owned(), 1)),
        None => {}
    });
}

fn one_uses(one: &ForeignExpr, symbol: &str) -> bool {
    let mut found = false;
    one.names(&mut |name, _| found |= name == symbol);
    found
}

/// The names of `symbols('x y, z1:4')`.
fn symbol_names(text: &str, span: &Span) -> Result<Vec<String>, Problem> {
    let mut names = Vec::new();
    for word in text.split([',', ' ', '\t', '\n']).filter(|word| !word.is_empty()) {
        match word.split_once(':') {
            None => names.push(word.to_owned()),
            Some((begin, end)) => {
                let stem = begin.trim_end_matches(|c: char| c.is_ascii_digit());
                let first = begin[stem.len()..].parse::<usize>().unwrap_or(0);
                let last = end.parse::<usize>().ok().filter(|last| *last <= MOST_ENTRIES);
                let Some(last) = last else {
                    return Err(Problem::new(
                        Code::Foreign,
                        span,
                        format!("'{word}' names no range of symbols"),
                        "this",
                    )
                    .help("write them one by one"));
                };
                names.extend((first..last).map(|index| format!("{stem}{index}")));
            }
        }
    }
    Ok(names)
}
