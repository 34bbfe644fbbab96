//! What the names of a script stand for, assignment by assignment: symbols, expressions of them, vectors, matrices. Python's and
//! MATLAB's scripts are read by it, and never run.

use super::super::expression::{ForeignExpr, ForeignKind, Span};
use super::super::functions::constant;
use super::forms::{self, added, by_entries, each, flat, multiplied, product_of, stacked, transposed};
use super::meaning::meaning;
use super::syntax::{Syntax, SyntaxKind};
use super::tokens::Dialect;
use super::values::ScriptValue;
use palmistry_io::foreign::Budget;
use palmistry_lang::{Code, Problem};
use std::collections::{BTreeMap, BTreeSet};

/// What is used of an argument of a function: itself, or elements by their numbers.
#[derive(Debug, Default)]
pub(crate) struct OpenArgument {
    pub whole: bool,
    pub numbers: BTreeSet<usize>,
}

/// Why something could not be read: where, what, and what to do.
pub(super) type Broken = (Span, String, Option<String>);

/// The names of a script.
pub(crate) struct ScriptWorkspace<'b> {
    /// What the values of all names together may cost.
    budget: &'b Budget,
    pub(super) bound: BTreeMap<String, Result<ScriptValue, Broken>>,
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
    pub(super) dialect: Dialect,
    /// Arguments of a function whose elements are symbols, with what is used of them.
    pub open: BTreeMap<String, OpenArgument>,
    /// Definitions that are made of whole arguments.
    of_whole: BTreeSet<String>,
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
            open: BTreeMap::new(),
            of_whole: BTreeSet::new(),
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

    /// Whether a name stands for a number or something else that is known.
    pub fn is_bound(&self, name: &str) -> bool {
        matches!(self.bound.get(name), Some(Ok(ScriptValue::One(_) | ScriptValue::Many { .. }) | Err(_)))
    }

    /// Pays for what looks at many things.
    pub fn pay(&self, steps: usize) -> Result<(), Problem> {
        self.budget.steps(steps).map_err(|spent| super::super::too_much(&(0..0), spent))
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
                if self.whole_argument(&one).is_some() {
                    self.of_whole.insert(own.clone());
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

    /// The argument of the function that stands as a whole in an expression, if one does.
    fn whole_argument(&self, of: &ForeignExpr) -> Option<String> {
        let mut found = None;
        if !self.open.is_empty() {
            of.names(&mut |name, _| {
                if found.is_none() && (self.open.contains_key(name) || self.of_whole.contains(name)) {
                    found = Some(name.to_owned());
                }
            });
        }
        found
    }

    /// Refuses an argument as a whole beside a matrix: it may be a matrix itself, and would be taken for one number.
    fn refuse_whole_beside(
        &self,
        left: &ScriptValue,
        right: &ScriptValue,
        span: &Span,
    ) -> Result<(), Problem> {
        let ((ScriptValue::One(one), ScriptValue::Many { .. })
        | (ScriptValue::Many { .. }, ScriptValue::One(one))) = (left, right)
        else {
            return Ok(());
        };
        match self.whole_argument(one) {
            Some(name) => {
                let message = format!(
                    "'{name}' is used as a whole beside a matrix: it may be a number, a vector or a matrix"
                );
                Err(Problem::new(Code::Foreign, span, message, "here")
                    .help("write the elements of the arguments of the function: x(1), x(2), p(1)"))
            }
            None => Ok(()),
        }
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
                    if let Some(sum) = &sum {
                        self.refuse_whole_beside(sum, &term, span)?;
                    }
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
                    if let Some(product) = &product {
                        self.refuse_whole_beside(product, &factor, span)?;
                    }
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
                    if let Some(product) = &product {
                        self.refuse_whole_beside(product, &factor, span)?;
                    }
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
                None if self.open.contains_key(name) => {
                    if let Some(open) = self.open.get_mut(name) {
                        open.whole = true;
                    }
                    Ok(ForeignExpr::name(name, &part.span))
                }
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
