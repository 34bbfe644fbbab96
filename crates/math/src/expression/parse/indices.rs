//! Vectors in one line: components `x[i + 1]`, ranges `x[1..20]`, sums and products over an index, and lines that are repeated
//! `for i in 1..20`. What has indices is written out where the last of them gets its value, so that nobody but the reader
//! meets any: a component is a symbol like others, with the name `x[3]`.

use super::tokens::{
    Depth, Expected, Read, Text, bare_name, blank, closing, helped, keyword, name, sign, stop, suffix, within,
};
use super::{cut_err, opt, read_all, sum};
use crate::expression::syntax::{Equation, Expr, ExprKind, Indexed, Loop, Name, Place, Span, Whole};
use dashu::rational::RBig;
use std::cell::Cell;
use winnow::combinator::{alt, peek, preceded, repeat as many};
use winnow::error::ErrMode;
use winnow::prelude::*;
use winnow::stream::Location;
use winnow::token::{literal, take_while};

/// A range has no more numbers than these.
const MOST_COMPONENTS: i64 = 5000;

/// All that is written out for values of indices in one text has no more parts than these.
const MOST_PARTS: usize = 1_000_000;

/// A number in an index has no more digits.
const MOST_DIGITS: usize = 9;

/// What is declared, moved or given a value: a name, a component, or several of them.
#[derive(Clone, Debug)]
pub struct Target {
    /// The index, as it is written.
    pub name: String,
    place: Option<Place>,
    /// Primes and the number of an experiment behind it.
    suffix: String,
    /// Where it stands in the text, in bytes.
    pub span: Span,
}

/// Indices that have values.
pub struct Indices<'d> {
    values: Vec<(String, i64)>,
    written_out: &'d Cell<usize>,
}

impl Whole {
    fn of(&self, indices: &Indices<'_>) -> Result<Whole, Expected> {
        let mut found = Whole { constant: self.constant, terms: Vec::new(), span: self.span.clone() };
        for (index, times) in &self.terms {
            match indices.value(index) {
                None => found.terms.push((index.clone(), *times)),
                Some(value) => {
                    let term = value.checked_mul(*times);
                    let total = term.and_then(|term| found.constant.checked_add(term));
                    found.constant = total.ok_or_else(|| too_large(self.span.start))?;
                }
            }
        }
        Ok(found)
    }

    fn value(&self) -> Option<i64> {
        self.terms.is_empty().then_some(self.constant)
    }
}

fn too_large(at: usize) -> Expected {
    let what = format!("an index made of numbers of at most {MOST_DIGITS} digits");
    Expected { what, at, help: None }
}

/// The numbers of a range, all indices in it having values. A sum may be over none: from one number to that before it.
fn numbers(from: &Whole, to: &Whole, may_be_empty: bool) -> Result<std::ops::RangeInclusive<i64>, Expected> {
    let (low, high) = (from.constant, to.constant);
    let at = from.span.start;
    let refuse = |what: String| Err(Expected { what, at, help: None });
    match high.checked_sub(low) {
        Some(-1) if may_be_empty => {}
        Some(above) if (0..MOST_COMPONENTS).contains(&above) => {}
        Some(above) if above >= 0 => {
            return refuse(format!("a range of at most {MOST_COMPONENTS} numbers; {low}..{high} has more"));
        }
        _ => return refuse(format!("a range that ends no lower than it begins; {low}..{high} is empty")),
    }
    Ok(low..=high)
}

fn component_name(vector: &str, place: i64, suffix: &str) -> String {
    format!("{vector}[{place}]{suffix}")
}

impl Indices<'_> {
    fn value(&self, index: &str) -> Option<i64> {
        self.values.iter().rev().find(|(name, _)| name == index).map(|(_, value)| *value)
    }

    /// One more part is written out.
    fn count(&self, at: usize) -> Result<(), Expected> {
        self.written_out.set(self.written_out.get() + 1);
        if self.written_out.get() <= MOST_PARTS {
            return Ok(());
        }
        let what = format!("ranges that stand for at most {MOST_PARTS} parts of expressions in one file");
        Err(Expected { what, at, help: Some("use shorter ranges".to_owned()) })
    }

    /// An expression with their values.
    pub fn bind(&self, expr: &Expr) -> Result<Expr, Expected> {
        if self.values.is_empty() {
            return Ok(expr.clone());
        }
        self.count(expr.span.start)?;
        let one = |inner: &Expr| self.bind(inner).map(Box::new);
        let list = |list: &[Expr]| list.iter().map(|one| self.bind(one)).collect::<Result<Vec<_>, _>>();
        let parts = |list: &[(bool, Expr)]| {
            list.iter().map(|(sign, part)| Ok((*sign, self.bind(part)?))).collect::<Result<Vec<_>, _>>()
        };
        let kind = match &expr.kind {
            ExprKind::Number(_) => expr.kind.clone(),
            ExprKind::Name(name) => match self.value(name) {
                Some(value) => ExprKind::Number(RBig::from(value)),
                None => expr.kind.clone(),
            },
            ExprKind::Call(name, arguments) => ExprKind::Call(name.clone(), spread(list(arguments)?)),
            ExprKind::Sum(terms) => ExprKind::Sum(parts(terms)?),
            ExprKind::Product(factors) => ExprKind::Product(parts(factors)?),
            ExprKind::Power(base, exponent) => ExprKind::Power(one(base)?, *exponent),
            ExprKind::RealPower(base, exponent) => ExprKind::RealPower(one(base)?, one(exponent)?),
            ExprKind::Matrix(rows) => {
                let rows = rows.iter().map(|row| list(row).map(spread));
                ExprKind::Matrix(rows.collect::<Result<_, _>>()?)
            }
            ExprKind::At(inner, values) => {
                let values = values.iter().map(|(name, value)| Ok((name.clone(), self.bind(value)?)));
                ExprKind::At(one(inner)?, values.collect::<Result<_, _>>()?)
            }
            ExprKind::Indexed(indexed) => match &**indexed {
                Indexed::Component { vector, place, suffix } => component_of(vector, place.of(self)?, suffix),
                Indexed::Fold { is_product, over, body } => {
                    let (from, to) = (over.from.of(self)?, over.to.of(self)?);
                    let over = Loop { index: over.index.clone(), from, to };
                    // what it runs through is free in its body, whatever is outside
                    let values =
                        self.values.iter().filter(|(name, _)| *name != over.index.text).cloned().collect();
                    let outside = Indices { values, written_out: self.written_out };
                    outside.fold(*is_product, over, outside.bind(body)?)?
                }
            },
        };
        Ok(Expr { kind, span: expr.span.clone() })
    }

    /// A relation with their values.
    pub fn bind_relation(&self, relation: &Equation) -> Result<Equation, Expected> {
        Ok(Equation {
            left: self.bind(&relation.left)?,
            right: self.bind(&relation.right)?,
            within: relation.within.as_ref().map(|within| self.bind(within)).transpose()?,
            ..relation.clone()
        })
    }

    /// A sum or a product, written out where the range has its numbers.
    fn fold(&self, is_product: bool, over: Loop, body: Expr) -> Result<ExprKind, Expected> {
        if over.from.value().and(over.to.value()).is_none() {
            return Ok(ExprKind::Indexed(Box::new(Indexed::Fold { is_product, over, body })));
        }
        let mut parts = Vec::new();
        for value in numbers(&over.from, &over.to, true)? {
            let values = vec![(over.index.text.clone(), value)];
            let inner = Indices { values, written_out: self.written_out };
            parts.push((false, inner.bind(&body)?));
        }
        Ok(match (parts.is_empty(), is_product) {
            (true, _) => ExprKind::Number(RBig::from(i64::from(is_product))),
            (false, true) => ExprKind::Product(parts),
            (false, false) => ExprKind::Sum(parts),
        })
    }
}

impl Place {
    fn of(&self, indices: &Indices<'_>) -> Result<Place, Expected> {
        Ok(match self {
            Place::One(one) => Place::One(one.of(indices)?),
            Place::Range(from, to) => {
                let (from, to) = (from.of(indices)?, to.of(indices)?);
                if from.value().and(to.value()).is_some() {
                    numbers(&from, &to, false)?;
                }
                Place::Range(from, to)
            }
        })
    }

    /// An index without a value, if there is one.
    pub fn open_index(&self) -> Option<&str> {
        let wholes = match self {
            Place::One(one) => vec![one],
            Place::Range(from, to) => vec![from, to],
        };
        wholes.into_iter().flat_map(|whole| &whole.terms).map(|(index, _)| index.as_str()).next()
    }

    /// The names of the components, where all indices have values.
    fn names(&self, vector: &str, suffix: &str) -> Option<Vec<String>> {
        match self {
            Place::One(one) => Some(vec![component_name(vector, one.value()?, suffix)]),
            Place::Range(from, to) => {
                let range = from.value()?..=to.value()?;
                Some(range.map(|place| component_name(vector, place, suffix)).collect())
            }
        }
    }
}

fn component_of(vector: &str, place: Place, suffix: &str) -> ExprKind {
    let value = match &place {
        Place::One(one) => one.value(),
        Place::Range(..) => None,
    };
    match value {
        Some(value) => ExprKind::Name(component_name(vector, value, suffix)),
        None => {
            let (vector, suffix) = (vector.to_owned(), suffix.to_owned());
            ExprKind::Indexed(Box::new(Indexed::Component { vector, place, suffix }))
        }
    }
}

/// The entries of a list, ranges of components written out.
pub(super) fn spread(list: Vec<Expr>) -> Vec<Expr> {
    let is_range = |entry: &Expr| match &entry.kind {
        ExprKind::Indexed(indexed) => matches!(**indexed, Indexed::Component { .. }),
        _ => false,
    };
    if !list.iter().any(is_range) {
        return list;
    }
    list.into_iter().flat_map(written_out).collect()
}

/// An entry of a list: the components of a range, or itself.
pub fn written_out(entry: Expr) -> Vec<Expr> {
    let names = match &entry.kind {
        ExprKind::Indexed(indexed) => match &**indexed {
            Indexed::Component { vector, place, suffix } => place.names(vector, suffix),
            Indexed::Fold { .. } => None,
        },
        _ => None,
    };
    match names {
        Some(names) => {
            let component = |name| Expr { kind: ExprKind::Name(name), span: entry.span.clone() };
            names.into_iter().map(component).collect()
        }
        None => vec![entry],
    }
}

impl Target {
    /// Whether it is a name and nothing more.
    pub fn is_plain(&self) -> bool {
        self.place.is_none() && self.suffix.is_empty()
    }

    /// What it stands for in an expression.
    pub fn expression(self) -> Expr {
        let kind = match self.place {
            None => ExprKind::Name(self.name + &self.suffix),
            Some(place) => component_of(&self.name, place, &self.suffix),
        };
        Expr { kind, span: self.span }
    }

    /// The names that it stands for.
    pub fn names(&self, indices: &Indices<'_>) -> Result<Vec<Name>, Expected> {
        let span = &self.span;
        let name = |text| Name { text, span: span.clone() };
        let Some(place) = &self.place else { return Ok(vec![name(format!("{}{}", self.name, self.suffix))]) };
        let place = place.of(indices)?;
        match place.names(&self.name, &self.suffix) {
            Some(names) => {
                names.iter().try_for_each(|_| indices.count(span.start))?;
                Ok(names.into_iter().map(name).collect())
            }
            None => {
                let index = place.open_index().unwrap_or_default();
                let what = format!("a number as index; nothing says what '{index}' runs through");
                let help = format!("as in 'for {index} in 1..20' at the end");
                Err(Expected { what, at: span.start, help: Some(help) })
            }
        }
    }
}

/// `2*i - 1`
fn whole(input: &mut Text<'_>) -> Read<Whole> {
    let begin = input.current_token_start();
    let mut found = Whole { constant: 0, terms: Vec::new(), span: begin..begin };
    let mut negative = opt(sign("-")).parse_next(input)?.is_some();
    loop {
        let at = input.current_token_start();
        let (times, index) = term(input)?;
        let times = if negative { -times } else { times };
        match index {
            None => found.constant = found.constant.checked_add(times).ok_or(ErrMode::Cut(too_large(at)))?,
            Some(index) => {
                match found.terms.iter_mut().find(|(known, _)| *known == index.text) {
                    Some((_, known)) => {
                        *known = known.checked_add(times).ok_or(ErrMode::Cut(too_large(at)))?
                    }
                    None => found.terms.push((index.text, times)),
                }
                found.terms.retain(|(_, times)| *times != 0);
            }
        }
        found.span.end = input.current_token_start();
        match opt(alt((sign("+").value(false), sign("-").value(true)))).parse_next(input)? {
            Some(minus) => negative = minus,
            None => return Ok(found),
        }
    }
}

/// A number, an index, or a product of the two.
fn term(input: &mut Text<'_>) -> Read<(i64, Option<Name>)> {
    let what = "a whole number or an index, as in x[3], x[i + 1], x[1..20]";
    let at = input.current_token_start();
    if let Some(digits) = opt(take_while(1.., |c: char| c.is_ascii_digit())).parse_next(input)? {
        if digits.len() > MOST_DIGITS {
            return Err(ErrMode::Cut(too_large(at)));
        }
        let number = digits.parse().unwrap_or(0);
        blank(input)?;
        let index = opt(preceded(sign("*"), cut_err(name).context(what))).parse_next(input)?;
        return Ok((number, index));
    }
    let index = cut_err(name).context(what).parse_next(input)?;
    if index.text.contains('.') {
        return stop(at, what, None);
    }
    let times = opt(preceded(sign("*"), cut_err(take_while(1..=MOST_DIGITS, |c: char| c.is_ascii_digit()))))
        .parse_next(input)?;
    blank(input)?;
    Ok((times.map_or(1, |digits| digits.parse().unwrap_or(0)), Some(index)))
}

/// `i in 2..20`, and that it is known to be an index.
fn over(input: &mut Text<'_>) -> Read<Loop> {
    let index = cut_err(name).context("an index and its range, as in i in 1..20").parse_next(input)?;
    if index.text.contains('.') {
        return stop(index.span.start, "an index and its range, as in i in 1..20", None);
    }
    let help = "as in sum(i in 1..3, x[i]); a line for each index ends with 'for i in 1..3'";
    helped(help, cut_err(keyword("in")).context("'in' and a range, as in i in 1..20")).parse_next(input)?;
    let dots = cut_err(sign("..")).context("'..' and the last number of the range, as in 1..20");
    let (from, _, to) = helped(help, (whole, dots, whole)).parse_next(input)?;
    input.state.indices.borrow_mut().push(index.clone());
    Ok(Loop { index, from, to })
}

/// `for i in 2..20 for j in 1..i`, if there is any.
pub fn loops(input: &mut Text<'_>) -> Read<Vec<Loop>> {
    many(0.., preceded(keyword("for"), over)).parse_next(input)
}

/// What stands before `for`, for all values of the indices, the last of them running first.
pub fn repeat<T>(
    input: &Text<'_>,
    loops: &[Loop],
    mut one: impl FnMut(&Indices<'_>) -> Result<Vec<T>, Expected>,
) -> Read<Vec<T>> {
    let mut found = Vec::new();
    let depth: &Depth = input.state;
    let mut indices = Indices { values: Vec::new(), written_out: &depth.written_out };
    run(loops, &mut indices, &mut |indices| {
        found.extend(one(indices)?);
        Ok(())
    })
    .map_err(ErrMode::Cut)?;
    Ok(found)
}

fn run(
    loops: &[Loop],
    indices: &mut Indices<'_>,
    one: &mut dyn FnMut(&Indices<'_>) -> Result<(), Expected>,
) -> Result<(), Expected> {
    let Some((first, rest)) = loops.split_first() else { return one(indices) };
    let (from, to) = (first.from.of(indices)?, first.to.of(indices)?);
    for end in [&from, &to] {
        if let Some((index, _)) = end.terms.first() {
            let what = format!("a range of numbers; nothing says what '{index}' runs through");
            return Err(Expected { what, at: end.span.start, help: None });
        }
    }
    for value in numbers(&from, &to, true)? {
        indices.count(first.index.span.start)?;
        indices.values.push((first.index.text.clone(), value));
        let done = run(rest, indices, one);
        indices.values.pop();
        done?;
    }
    Ok(())
}

/// `[3]`, `[i + 1]` or `[1..20]`, if it is there.
fn place(input: &mut Text<'_>) -> Read<Option<Place>> {
    if opt(sign("[")).parse_next(input)?.is_none() {
        return Ok(None);
    }
    let from = whole(input)?;
    let place = match opt(sign("..")).parse_next(input)? {
        None => Place::One(from),
        Some(()) => Place::Range(from, whole(input)?),
    };
    let at = input.current_token_start();
    if input.input.as_ref().starts_with(',') {
        let help = "name several vectors, one for each row";
        return stop(at, "']': a vector has one index", Some(help.to_owned()));
    }
    let help = "a component of a vector is written x[3], a range of them x[1..3]";
    helped(help, cut_err(literal("]").void()).context("']' or '..'")).parse_next(input)?;
    if let Place::Range(from, to) = &place
        && from.value().and(to.value()).is_some()
    {
        numbers(from, to, false).map_err(ErrMode::Cut)?;
    }
    Ok(Some(place))
}

/// A target, without the blanks behind it.
fn located_target(input: &mut Text<'_>) -> Read<Target> {
    let name = bare_name(input)?;
    let place = place(input)?;
    let suffix = suffix(input)?;
    Ok(Target { name: name.text, place, suffix, span: name.span.start..input.current_token_start() })
}

/// A name, a component or a range of them, derivatives and experiments included.
pub fn target(input: &mut Text<'_>) -> Read<Target> {
    let found = located_target(input)?;
    blank(input)?;
    Ok(found)
}

/// A target with one prime more: `x'` is how `x` moves, `u''` how the derivative `u'` of a signal does. The prime at the end
/// may stand apart. Or a target and the sign of a step, `x+`: whether it is that.
pub fn moved(input: &mut Text<'_>) -> Read<(Target, bool)> {
    let mut found = located_target(input)?;
    let step = |input: &mut Text<'_>| -> Read<usize> {
        blank(input)?;
        let at = input.current_token_start();
        literal("+").void().parse_next(input)?;
        Ok(at)
    };
    let before = input.checkpoint();
    if let Some(at) = opt(step).parse_next(input)? {
        if opt(peek(literal("="))).parse_next(input)?.is_some() {
            let what = "'+ =' with a blank between, or a rate";
            let name = &found.name;
            let help = format!(
                "'+=' adds elsewhere: the value after a step is {name}+ = v, and what adds v is {name}+ = {name} + v"
            );
            return stop(at, what, Some(help));
        }
        blank(input)?;
        if found.suffix.contains('\'') && !input.input.as_ref().starts_with('=') {
            let help = format!("a rate stands alone on the left, as in {}{} = ...", found.name, found.suffix);
            return stop(at, "'=' and the rate of change", Some(help));
        }
        if input.input.as_ref().starts_with('=') {
            return Ok((found, true));
        }
        // the sum of `2x + y`, and no step
        input.reset(&before);
    }
    let suffix = found.suffix.clone();
    let (primes, experiment) = suffix.split_at(suffix.find('@').unwrap_or(suffix.len()));
    match primes.strip_suffix('\'') {
        Some(primes) => {
            found.suffix = format!("{primes}{experiment}");
            // the mark is no part of the name
            if experiment.is_empty() {
                found.span.end -= 1;
            }
            blank(input)?;
        }
        None => {
            blank(input)?;
            cut_err(sign("'")).context("' after the state, as in x' = ...").parse_next(input)?;
        }
    }
    Ok((found, false))
}

/// The names that a text stands for: one, or the components of a range. None where it is no such text.
pub fn names_of_range(text: &str) -> Option<Vec<String>> {
    let all = |input: &mut Text<'_>| {
        let target = target(input)?;
        repeat(input, &[], |indices| target.names(indices))
    };
    let names = read_all(text, &Depth::default(), "a name, or a range as in x[1..20]", all).ok()?;
    Some(names.into_iter().map(|name| name.text).collect())
}

/// `sum(i in 1..20, e)`, behind its opening bracket.
pub(super) fn fold(input: &mut Text<'_>, name: &str, begin: usize) -> Read<Expr> {
    let what = format!("an index and its range, as in {name}(i in 1..20, x[i])");
    let at = input.current_token_start();
    let (over, body) = within(input, |input: &mut Text<'_>| {
        let over = over(input).map_err(|error| match error {
            ErrMode::Cut(error) if error.at == at => ErrMode::Cut(Expected { what: what.clone(), ..error }),
            error => error,
        })?;
        cut_err(sign(",")).context("',' and what is added up or multiplied").parse_next(input)?;
        Ok((over, cut_err(sum).parse_next(input)?))
    })?;
    let end = cut_err(closing(")")).context("')' or an operator").parse_next(input)?;
    let indices = Indices { values: Vec::new(), written_out: &input.state.written_out };
    let kind = indices.fold(name == "product", over, body).map_err(ErrMode::Cut)?;
    Ok(Expr { kind, span: begin..end })
}
