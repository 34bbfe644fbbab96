//! Calls and elements in scripts: functions of the languages, symbols that are made, elements of vectors and matrices.

use super::super::expression::{ForeignExpr, Span};
use super::super::functions::{self, constant, is_function};
use super::forms::{matrix, transposed};
use super::meaning::{keeps_the_value, made_number, named_function};
use super::syntax::{Syntax, SyntaxKind};
use super::tokens::Dialect;
use super::values::{Form, MOST_ENTRIES, ScriptValue};
use super::workspace::ScriptWorkspace;
use palmistry_lang::{Code, Problem};

type Valued = Result<ScriptValue, Problem>;

impl ScriptWorkspace<'_> {
    /// `x[0]`, `A[0, 1]` of Python.
    pub(super) fn indexed(&mut self, inner: &Syntax, indices: &[Syntax], span: &Span) -> Valued {
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

    /// An element of an argument of a function.
    fn open_element(&mut self, name: &str, arguments: &[Syntax], span: &Span) -> Valued {
        let mut numbers = Vec::new();
        for index in arguments {
            numbers.push(self.count(index)?);
        }
        let number = match numbers.as_slice() {
            [Some(at)] | [Some(at), Some(1)] | [Some(1), Some(at)] => Some(*at),
            _ => None,
        };
        let number = number.filter(|at| (1..=MOST_ENTRIES).contains(at)).ok_or_else(|| {
            Problem::new(
                Code::Foreign,
                span,
                format!("elements of '{name}' by such an index are not read"),
                "this",
            )
            .help("write a number: x(1)")
        })?;
        if let Some(open) = self.open.get_mut(name) {
            open.numbers.insert(number);
        }
        self.symbol(&format!("{name}{number}"), span)
    }

    /// An element of what a name stands for, in MATLAB; a call of it is nothing in Python.
    fn element_of(&mut self, name: &str, arguments: &[Syntax], span: &Span) -> Option<Valued> {
        if self.open.contains_key(name) && !self.bound.contains_key(name) {
            return Some(self.open_element(name, arguments, span));
        }
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

    pub(super) fn call(&mut self, syntax: &Syntax) -> Valued {
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
            // a number as a text is that number exactly
            (
                "Rational" | "S" | "sympify" | "Integer",
                [Syntax { kind: SyntaxKind::Text(text), span: place }],
            ) if text.contains('/') || name == "Rational" => {
                let (top, bottom) = text.split_once('/').unwrap_or((text, "1"));
                let top = ForeignExpr::number(top.trim(), place)?;
                let bottom = ForeignExpr::number(bottom.trim(), place)?;
                let value = top.as_number().zip(bottom.as_number());
                let value = value.and_then(|(top, bottom)| functions::fraction(top, bottom, span));
                let value = value.ok_or_else(|| {
                    Problem::new(Code::Foreign, place, format!("'{text}' is no number"), "this")
                        .help("write a fraction of two numbers")
                })?;
                made_number(name, value, &[], span).map(ScriptValue::One)
            }
            ("S" | "sympify", [Syntax { kind: SyntaxKind::Text(text), span: place }])
                if module.is_some() || self.from_sympy.contains(name) =>
            {
                ForeignExpr::number(text.trim(), place).map(ScriptValue::One)
            }
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
            ("Integer" | "Float", [value, rest @ ..]) => {
                let value = match &value.kind {
                    SyntaxKind::Text(text) => ForeignExpr::number(text, &value.span)?,
                    _ => self.one(value)?,
                };
                made_number(name, value, rest, span).map(ScriptValue::One)
            }
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
