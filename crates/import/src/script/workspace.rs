//! What the names of a script stand for, assignment by assignment: symbols, expressions of them, vectors, matrices. Python's and
//! MATLAB's scripts are read by it, and never run.

use super::super::expression::{ForeignExpr, ForeignKind, Span};
use super::super::functions::{self, constant, is_function};
use super::meaning::{meaning, named_function};
use super::syntax::{Syntax, SyntaxKind};
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
    Many { rows: usize, entries: Vec<ForeignExpr> },
    /// Something that is no number and no matrix.
    Else,
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
}

type Valued = Result<ScriptValue, Problem>;

impl<'b> ScriptWorkspace<'b> {
    /// No names yet.
    pub fn new(budget: &'b Budget) -> ScriptWorkspace<'b> {
        ScriptWorkspace {
            budget,
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
                stacked(parts.into_iter().map(|part| vec![part]).collect(), span)
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
            SyntaxKind::Sum(terms) => {
                let mut sum: Option<ScriptValue> = None;
                for (subtracted, term) in terms {
                    let term = self.value(term)?;
                    sum = Some(match sum {
                        None if *subtracted => each(term, |one| one.negative()),
                        None => term,
                        Some(sum) => entrywise(sum, term, *subtracted, span)?,
                    });
                }
                Ok(flat(sum.unwrap_or(ScriptValue::Else), span))
            }
            SyntaxKind::Product(factors) => {
                let mut product: Option<ScriptValue> = None;
                for (divided, factor) in factors {
                    let factor = self.value(factor)?;
                    product = Some(match product {
                        None => factor,
                        Some(product) => multiplied(product, factor, *divided, span)?,
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
            SyntaxKind::Call(..) if part.span != syntax.span => match self.call(part) {
                Ok(ScriptValue::One(one)) => Some(Ok(one)),
                Ok(ScriptValue::Many { entries, .. }) if entries.len() == 1 => {
                    entries.into_iter().next().map(Ok)
                }
                Ok(_) => Some(Err(Problem::new(Code::Foreign, &part.span, "this is no number", "this"))),
                Err(problem) => Some(Err(problem)),
            },
            _ => None,
        };
        meaning(syntax, &mut special)
    }

    fn call(&mut self, syntax: &Syntax) -> Valued {
        let span = &syntax.span;
        let Some((name, arguments)) = named_function(syntax) else { return self.function_of_time(syntax) };
        // why something is not there is reported where it is used
        if let Some(Err(why)) = self.get(name) {
            return Err(why);
        }
        // an element of a vector or of a matrix, in MATLAB
        if let (Some(Ok(ScriptValue::Many { entries, .. })), 1..=2) = (self.get(name), arguments.len()) {
            let mut numbers = Vec::new();
            for index in arguments {
                numbers.extend(self.count(index)?);
            }
            let is_whole = numbers.len() == arguments.len();
            let place = if is_whole { self.element(name, &numbers, true) } else { None };
            let inside = place.and_then(|place| entries.get(place).cloned());
            return inside.map(ScriptValue::One).ok_or_else(|| {
                Problem::new(Code::Foreign, span, format!("'{name}' has no such element"), "this")
                    .help("elements are counted from 1")
            });
        }
        match (name, arguments) {
            ("Matrix" | "ImmutableMatrix" | "MutableDenseMatrix" | "array", [list]) => self.value(list),
            ("transpose" | "simplify" | "expand" | "vpa" | "sym", [inner])
                if !matches!(inner.kind, SyntaxKind::Text(_)) =>
            {
                let value = self.value(inner)?;
                Ok(if name == "transpose" { transposed(value) } else { value })
            }
            ("length" | "numel", [list]) => {
                let count = self.value(list)?.entries().map_or(1, |entries| entries.len());
                Ok(ScriptValue::One(ForeignExpr::integer(count as i64, span)))
            }
            ("size", [list, way]) => {
                let (value, way) = (self.value(list)?, self.count(way)?);
                let (rows, all) = match &value {
                    ScriptValue::Many { rows, entries } => (*rows, entries.len()),
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
                let columns = size(&sizes[sizes.len() - 1])?;
                let count = rows.saturating_mul(columns);
                if count > MOST_ENTRIES {
                    return Err(Problem::new(Code::Foreign, span, "a matrix of too many entries", "this"));
                }
                Ok(ScriptValue::Many { rows, entries: vec![value; count] })
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
                    Err(entries) => ScriptValue::Many { rows: entries.len(), entries },
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

    /// `sym.Function('x')(t)`
    fn function_of_time(&mut self, syntax: &Syntax) -> Valued {
        if let SyntaxKind::Call(callee, _) = &syntax.kind
            && let Some(("Function", [Syntax { kind: SyntaxKind::Text(text), span }])) =
                named_function(callee)
        {
            return self.symbol(text, span);
        }
        Err(Problem::new(Code::Foreign, &syntax.span, "this call cannot be read", "this"))
    }
}

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

/// One entry is a number.
fn flat(value: ScriptValue, span: &Span) -> ScriptValue {
    match value {
        ScriptValue::One(one) => ScriptValue::One(ForeignExpr { span: span.clone(), ..one }),
        other => other,
    }
}

fn each(value: ScriptValue, of: impl Fn(ForeignExpr) -> ForeignExpr) -> ScriptValue {
    match value {
        ScriptValue::One(one) => ScriptValue::One(of(one)),
        ScriptValue::Many { rows, entries } => {
            ScriptValue::Many { rows, entries: entries.into_iter().map(of).collect() }
        }
        ScriptValue::Else => ScriptValue::Else,
    }
}

fn unlike(span: &Span) -> Problem {
    Problem::new(Code::Foreign, span, "matrices of these sizes do not go together", "here")
        .help("write the elements out")
}

/// A sum that goes on with another term: sums stay flat, however long they are.
fn sum_of(left: ForeignExpr, right: ForeignExpr, subtracted: bool) -> ForeignExpr {
    match left {
        // a sum in brackets is a term as well: adding to it changes nothing
        ForeignExpr { kind: ForeignKind::Sum(mut terms), span } => {
            let span = span.start..right.span.end.max(span.end);
            terms.push((subtracted, right));
            ForeignExpr::new(ForeignKind::Sum(terms), &span)
        }
        left if subtracted => left.minus(right),
        left => left.plus(right),
    }
}

fn product_of(left: ForeignExpr, right: ForeignExpr, divided: bool) -> ForeignExpr {
    match left {
        ForeignExpr { kind: ForeignKind::Product(mut factors), span } => {
            let span = span.start..right.span.end.max(span.end);
            factors.push((divided, right));
            ForeignExpr::new(ForeignKind::Product(factors), &span)
        }
        left if divided => left.over(right),
        left => left.times(right),
    }
}

fn entrywise(left: ScriptValue, right: ScriptValue, subtracted: bool, span: &Span) -> Valued {
    Ok(match (left, right) {
        (ScriptValue::One(a), ScriptValue::One(b)) => ScriptValue::One(sum_of(a, b, subtracted)),
        (ScriptValue::Many { rows, entries }, ScriptValue::Many { rows: other, entries: right })
            if rows == other && entries.len() == right.len() =>
        {
            let entries = entries.into_iter().zip(right).map(|(a, b)| sum_of(a, b, subtracted)).collect();
            ScriptValue::Many { rows, entries }
        }
        (ScriptValue::Many { rows, entries }, ScriptValue::One(b)) => {
            let entries = entries.into_iter().map(|a| sum_of(a, b.clone(), subtracted)).collect();
            ScriptValue::Many { rows, entries }
        }
        (ScriptValue::One(a), ScriptValue::Many { rows, entries }) => {
            let entries = entries.into_iter().map(|b| sum_of(a.clone(), b, subtracted)).collect();
            ScriptValue::Many { rows, entries }
        }
        _ => return Err(unlike(span)),
    })
}

fn multiplied(left: ScriptValue, right: ScriptValue, divided: bool, span: &Span) -> Valued {
    Ok(match (left, right) {
        (ScriptValue::One(a), ScriptValue::One(b)) => ScriptValue::One(product_of(a, b, divided)),
        (ScriptValue::Many { rows, entries }, ScriptValue::One(b)) => {
            let entries = entries.into_iter().map(|a| product_of(a, b.clone(), divided)).collect();
            ScriptValue::Many { rows, entries }
        }
        (ScriptValue::One(a), ScriptValue::Many { rows, entries }) if !divided => {
            let entries = entries.into_iter().map(|b| product_of(a.clone(), b, false)).collect();
            ScriptValue::Many { rows, entries }
        }
        (ScriptValue::Many { rows, entries: a }, ScriptValue::Many { rows: inner, entries: b })
            if !divided && rows > 0 && inner > 0 && a.len() == rows * inner =>
        {
            let columns = b.len() / inner;
            if rows.saturating_mul(columns).saturating_mul(inner) > MOST_ENTRIES {
                return Err(Problem::new(
                    Code::Foreign,
                    span,
                    "a product of matrices that are too large",
                    "this",
                ));
            }
            let mut entries = Vec::new();
            for row in 0..rows {
                for column in 0..columns {
                    let mut terms =
                        (0..inner).map(|k| a[row * inner + k].clone().times(b[k * columns + column].clone()));
                    let Some(first) = terms.next() else { return Err(unlike(span)) };
                    entries.push(terms.fold(first, |sum, term| sum_of(sum, term, false)));
                }
            }
            match (rows, columns) {
                (1, 1) => ScriptValue::One(entries.remove(0)),
                _ => ScriptValue::Many { rows, entries },
            }
        }
        _ => return Err(unlike(span)),
    })
}

fn transposed(value: ScriptValue) -> ScriptValue {
    match value {
        ScriptValue::Many { rows, entries } if rows > 0 => {
            let columns = entries.len() / rows;
            let at = |row: usize, column: usize| entries[row * columns + column].clone();
            let turned = (0..columns).flat_map(|column| (0..rows).map(move |row| (row, column)));
            let entries = turned.map(|(row, column)| at(row, column)).collect();
            ScriptValue::Many { rows: columns, entries }
        }
        other => other,
    }
}

/// A matrix of blocks.
fn stacked(rows: Vec<Vec<ScriptValue>>, span: &Span) -> Valued {
    let (mut height, mut width, mut entries) = (0, None, Vec::new());
    for row in rows {
        let blocks: Vec<(usize, Vec<ForeignExpr>)> = row
            .into_iter()
            .map(|block| match block {
                ScriptValue::One(one) => Ok((1, vec![one])),
                ScriptValue::Many { rows, entries } => Ok((rows, entries)),
                ScriptValue::Else => {
                    Err(Problem::new(Code::Foreign, span, "a matrix of what is no number", "this"))
                }
            })
            .collect::<Result<_, _>>()?;
        let blocks: Vec<(usize, Vec<ForeignExpr>)> =
            blocks.into_iter().filter(|(_, entries)| !entries.is_empty()).collect();
        let Some(tall) = blocks.first().map(|(rows, _)| *rows) else { continue };
        if blocks.iter().any(|(rows, _)| *rows != tall) {
            return Err(unlike(span));
        }
        let columns: usize = blocks.iter().map(|(rows, entries)| entries.len() / rows).sum();
        if *width.get_or_insert(columns) != columns {
            return Err(unlike(span));
        }
        for line in 0..tall {
            for (rows, block) in &blocks {
                let wide = block.len() / rows;
                entries.extend_from_slice(&block[line * wide..(line + 1) * wide]);
            }
        }
        height += tall;
        if entries.len() > MOST_ENTRIES {
            return Err(Problem::new(Code::Foreign, span, "a matrix of too many entries", "this"));
        }
    }
    Ok(ScriptValue::Many { rows: height, entries })
}
