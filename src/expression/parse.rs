//! Reading expressions. The parser combinators are winnow's; the error is ours, because it has to say what was
//! expected, and where.

use super::syntax::{Equation, Expr, ExprKind, Name, Relation, Span};
use crate::number::parse_decimal;
use std::cell::Cell;
use winnow::combinator::{alt, cut_err, not, opt, preceded, separated};
use winnow::error::{AddContext, ErrMode, ModalResult, ParserError};
use winnow::prelude::*;
use winnow::stream::{LocatingSlice, Location, Stateful, Stream};
use winnow::token::{literal, one_of, take_till, take_while};

/// Text with the place in it, and how deep in brackets we are.
pub(crate) type Text<'a> = Stateful<LocatingSlice<&'a str>, &'a Depth>;

/// How many brackets are open, and how many may be.
#[derive(Debug, Default)]
pub(crate) struct Depth(Cell<usize>);

/// More brackets within brackets than this are refused: nobody means them.
const DEEPEST: usize = 120;

/// The greatest exponent that may be written after `^`.
const LARGEST_EXPONENT: i32 = 1000;

/// What was expected at a place in the text.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("expected {what}")]
pub struct Expected {
    /// In words.
    pub what: String,
    /// The byte at which it was expected.
    pub at: usize,
    /// What may help.
    pub help: Option<String>,
}

impl<'a> ParserError<Text<'a>> for Expected {
    type Inner = Self;

    fn from_input(input: &Text<'a>) -> Self {
        Expected { what: "something else".to_owned(), at: input.current_token_start(), help: None }
    }
    fn or(self, other: Self) -> Self {
        // the branch that came further knows better
        if self.at > other.at { self } else { other }
    }
    fn into_inner(self) -> Result<Self, Self> {
        Ok(self)
    }
}

impl<'a> AddContext<Text<'a>, &'static str> for Expected {
    fn add_context(
        mut self,
        input: &Text<'a>,
        start: &<Text<'a> as Stream>::Checkpoint,
        what: &'static str,
    ) -> Self {
        // name the whole only where nothing inside it was recognised
        let mut begin = *input;
        begin.reset(start);
        if self.at == begin.current_token_start() || self.what == "something else" {
            self.what = what.to_owned();
        }
        self
    }
}

pub(crate) type Read<T> = ModalResult<T, Expected>;

/// Stops the reading with a message of our own.
pub(crate) fn stop<T>(at: usize, what: impl Into<String>, help: Option<String>) -> Read<T> {
    Err(ErrMode::Cut(Expected { what: what.into(), at, help }))
}

/// Whether a character ends a line, and with it a comment: whatever some editor shows as the end of a line, so that nothing
/// that is shown below a comment is read as a part of it.
pub(crate) fn ends_a_line(c: char) -> bool {
    matches!(c, '\n' | '\r' | '\u{b}' | '\u{c}' | '\u{1c}'..='\u{1e}' | '\u{85}' | '\u{2028}' | '\u{2029}')
}

/// White space and comments, which run from `#` to the end of the line.
pub(crate) fn blank(input: &mut Text<'_>) -> Read<()> {
    loop {
        take_while(0.., |c: char| c.is_whitespace() || ends_a_line(c)).void().parse_next(input)?;
        if opt(literal("#")).parse_next(input)?.is_none() {
            return Ok(());
        }
        take_till(0.., ends_a_line).void().parse_next(input)?;
    }
}

/// A sign or bracket, and the blank after it.
pub(crate) fn sign<'a>(text: &'static str) -> impl Parser<Text<'a>, (), ErrMode<Expected>> {
    (literal(text), blank).void()
}

/// Words that begin something and so cannot be names.
pub(crate) const RESERVED: [&str; 30] = [
    "system",
    "cite",
    "use",
    "state",
    "param",
    "angle",
    "let",
    "drift",
    "input",
    "field",
    "output",
    "sample",
    "avoid",
    "in",
    "claim",
    "erratum",
    "printed",
    "corrected",
    "damaged",
    "convention",
    "loose",
    "scan",
    "scanned",
    "repaired",
    "definition",
    "undecided",
    "where",
    "at",
    "within",
    "expect",
];

/// Words with a meaning at some places; elsewhere they are names.
pub(crate) const SPECIAL: [&str; 23] = [
    "proved",
    "refuted",
    "restates",
    "consequence",
    "example",
    "follows",
    "reads",
    "meant",
    "as",
    "on",
    "carrying",
    "digits",
    "others",
    "set",
    "pole",
    "map",
    "line",
    "reduction",
    "of",
    "order",
    "to",
    "from",
    "infinity",
];

/// Letters, digits and underscores, beginning with a letter.
pub(crate) fn word<'a>(input: &mut Text<'a>) -> Read<(&'a str, Span)> {
    (
        one_of(|c: char| c.is_ascii_alphabetic() || c == '_'),
        take_while(0.., |c: char| c.is_ascii_alphanumeric() || c == '_'),
    )
        .take()
        .with_span()
        .parse_next(input)
}

/// A closing bracket, and the blank after it; where the bracket ends.
fn closing<'a>(text: &'static str) -> impl Parser<Text<'a>, usize, ErrMode<Expected>> {
    (literal(text).span(), blank).map(|(span, ())| span.end)
}

/// One of the words of the language, and the blank after it.
pub(crate) fn keyword<'a>(text: &'static str) -> impl Parser<Text<'a>, Span, ErrMode<Expected>> {
    debug_assert!(RESERVED.contains(&text) || SPECIAL.contains(&text), "'{text}' is in no list of words");
    move |input: &mut Text<'a>| {
        let start = input.checkpoint();
        match word.parse_next(input) {
            Ok((found, span)) if found == text => {
                blank(input)?;
                Ok(span)
            }
            Ok((_, span)) => {
                input.reset(&start);
                Err(ErrMode::Backtrack(Expected { what: format!("'{text}'"), at: span.start, help: None }))
            }
            Err(error) => {
                input.reset(&start);
                Err(error)
            }
        }
    }
}

/// A name that is not reserved, with parts joined by dots (`general.f`), and the blank after it.
pub(crate) fn name(input: &mut Text<'_>) -> Read<Name> {
    let start = input.checkpoint();
    let ((first, _), span) = (word, winnow::combinator::repeat::<_, _, (), _, _>(0.., (literal("."), word)))
        .map(|((text, span), ())| (text, span))
        .with_span()
        .parse_next(input)?;
    if RESERVED.contains(&first) {
        input.reset(&start);
        let what = format!("a name; '{first}' is a word of the language");
        return Err(ErrMode::Backtrack(Expected { what, at: span.start, help: None }));
    }
    let mut whole = *input;
    whole.reset(&start);
    let text = whole.input.as_ref()[..span.len()].to_owned();
    blank(input)?;
    Ok(Name { text, span })
}

/// An unsigned number as it is written in a file.
fn number(input: &mut Text<'_>) -> Read<Expr> {
    let digits = |c: char| c.is_ascii_digit();
    let mantissa = alt((
        (take_while(1.., digits), opt((literal("."), take_while(0.., digits)))).void(),
        (literal("."), take_while(1.., digits)).void(),
    ));
    let exponent = (one_of(['e', 'E']), opt(one_of(['+', '-'])), take_while(1.., digits)).void();
    let (text, span) = (mantissa, opt(exponent)).take().with_span().parse_next(input)?;
    let Some(value) = parse_decimal(text) else {
        // the place is that of the exponent, or of the last digit: at its beginning a number is what is expected
        let at = text.find(['e', 'E']).map_or(span.end - 1, |exponent| span.start + exponent + 1);
        return stop(at, "a number of at most 4096 digits, with an exponent of at most 4096", None);
    };
    blank(input)?;
    Ok(Expr { kind: ExprKind::Number(value), span })
}

/// Something in brackets, counted.
pub(crate) fn within<'a, T>(
    input: &mut Text<'a>,
    inner: impl Parser<Text<'a>, T, ErrMode<Expected>>,
) -> Read<T> {
    let depth = input.state;
    if depth.0.get() >= DEEPEST {
        let at = input.current_token_start();
        return stop(
            at,
            format!("at most {DEEPEST} brackets within brackets"),
            Some("name the inner part with 'let'".into()),
        );
    }
    depth.0.set(depth.0.get() + 1);
    let mut inner = inner;
    let result = inner.parse_next(input);
    depth.0.set(depth.0.get() - 1);
    result
}

fn bracketed(input: &mut Text<'_>) -> Read<Expr> {
    let begin = input.current_token_start();
    sign("(").parse_next(input)?;
    let inner = within(input, cut_err(sum))?;
    let end = cut_err(closing(")")).context("')' or an operator").parse_next(input)?;
    Ok(Expr { span: begin..end, ..inner })
}

fn matrix(input: &mut Text<'_>) -> Read<Expr> {
    let begin = input.current_token_start();
    sign("[").parse_next(input)?;
    let row = |input: &mut Text<'_>| -> Read<Vec<Expr>> { separated(1.., sum, sign(",")).parse_next(input) };
    let rows: Vec<Vec<Expr>> = within(input, cut_err(separated(1.., row, sign(";"))))?;
    let end = cut_err(closing("]"))
        .context("']', ',' between the entries of a row, or ';' between rows")
        .parse_next(input)?;
    Ok(Expr { kind: ExprKind::Matrix(rows), span: begin..end })
}

/// A name, or a call where a bracket follows at once.
fn name_or_call(input: &mut Text<'_>) -> Read<Expr> {
    let name = name(input)?;
    if opt(sign("(")).parse_next(input)?.is_none() {
        return Ok(Expr { kind: ExprKind::Name(name.text), span: name.span });
    }
    let arguments: Vec<Expr> = within(input, cut_err(separated(1.., sum, sign(","))))?;
    let end = cut_err(closing(")")).context("')' or ',' in the list of arguments").parse_next(input)?;
    Ok(Expr { kind: ExprKind::Call(name.text, arguments), span: name.span.start..end })
}

/// `name = value, ...` in braces, and where they end
pub(crate) fn assignments(input: &mut Text<'_>) -> Read<(Vec<(Name, Expr)>, usize)> {
    let one = |input: &mut Text<'_>| -> Read<(Name, Expr)> {
        let name = name.context("a name to give a value to").parse_next(input)?;
        cut_err(sign("=")).context("'=' and a value").parse_next(input)?;
        Ok((name, cut_err(sum).parse_next(input)?))
    };
    cut_err(sign("{")).context("'{' and a list of name = value").parse_next(input)?;
    let list = within(input, cut_err(separated(1.., one, sign(","))))?;
    let end = cut_err(closing("}")).context("'}' or ','").parse_next(input)?;
    Ok((list, end))
}

fn primary(input: &mut Text<'_>) -> Read<Expr> {
    alt((number, bracketed, matrix, name_or_call)).context("a number, a name, '(' or '['").parse_next(input)
}

/// A power, perhaps at a point: `x^2 at {x = 3}` is nine.
fn factor(input: &mut Text<'_>) -> Read<Expr> {
    let mut value = power(input)?;
    while opt(keyword("at")).parse_next(input)?.is_some() {
        let (list, end) = assignments(input)?;
        let span = value.span.start..end;
        value = Expr { kind: ExprKind::At(Box::new(value), list), span };
        if input.state.0.get() + at_depth(&value) > DEEPEST {
            return stop(input.current_token_start(), "fewer 'at' after one another", None);
        }
    }
    Ok(value)
}

fn at_depth(value: &Expr) -> usize {
    let (mut depth, mut inner) = (0, value);
    while let ExprKind::At(next, _) = &inner.kind {
        (depth, inner) = (depth + 1, next);
    }
    depth
}

/// `base^n`, `n` an integer, in brackets or not.
fn power(input: &mut Text<'_>) -> Read<Expr> {
    let base = primary(input)?;
    if opt(sign("^")).parse_next(input)?.is_none() {
        return Ok(base);
    }
    let at = input.current_token_start();
    // the exponent, if it is not too large, and where it ends
    let bare = |input: &mut Text<'_>| -> Read<(Option<i32>, usize)> {
        let minus = opt(sign("-")).parse_next(input)?.is_some();
        let digits = take_while(1.., |c: char| c.is_ascii_digit()).parse_next(input)?;
        not(one_of(['.', '_'])).parse_next(input)?;
        let end = input.current_token_start();
        blank(input)?;
        let value = digits.parse::<i32>().ok().filter(|n| *n <= LARGEST_EXPONENT);
        Ok((value.map(|n| if minus { -n } else { n }), end))
    };
    let in_brackets = (sign("("), bare, closing(")")).map(|((), (n, _), end)| (n, end));
    match opt(alt((in_brackets, bare))).parse_next(input)? {
        Some((Some(n), end)) => {
            if opt(sign("^")).parse_next(input)?.is_some() {
                return stop(at, "one exponent; write (a^b)^c with its brackets", None);
            }
            let span = base.span.start..end;
            Ok(Expr { kind: ExprKind::Power(Box::new(base), n), span })
        }
        Some((None, _)) => stop(at, format!("an exponent of at most {LARGEST_EXPONENT}"), None),
        None => stop(
            at,
            "an integer as exponent, as in x^2 or x^(-1)",
            Some("write sqrt(x) for a square root".into()),
        ),
    }
}

/// Signs before a term or a factor, if there are any: whether they amount to a minus.
fn signs(input: &mut Text<'_>) -> Read<bool> {
    let mut negative = false;
    while let Some(minus) = opt(alt((sign("-").value(true), sign("+").value(false)))).parse_next(input)? {
        negative ^= minus;
    }
    Ok(negative)
}

/// An expression with the signs before it, which begin at `begin`: its span holds them.
fn signed(negative: bool, begin: usize, inner: Expr) -> Expr {
    let span = begin..inner.span.end;
    if negative { Expr { kind: ExprKind::Sum(vec![(true, inner)]), span } } else { Expr { span, ..inner } }
}

/// Factors, and whether the signs before the first amount to a minus. That binds weaker than the power and the product:
/// `-x^2*y` is `-(x^2*y)`. The signs of a later factor, as in `a * -b`, belong to it.
fn product(input: &mut Text<'_>) -> Read<(bool, Expr)> {
    let negative = signs(input)?;
    let first = factor(input)?;
    let begin = first.span.start;
    let mut factors = vec![(false, first)];
    while let Some(divides) = opt(alt((sign("*").value(false), sign("/").value(true)))).parse_next(input)? {
        let begin = input.current_token_start();
        let negative = signs(input)?;
        let value = cut_err(factor).parse_next(input)?;
        factors.push((divides, signed(negative, begin, value)));
    }
    let value = if factors.len() == 1 {
        factors.remove(0).1
    } else {
        let end = factors.last().map_or(begin, |(_, f)| f.span.end);
        Expr { kind: ExprKind::Product(factors), span: begin..end }
    };
    Ok((negative, value))
}

/// An expression. Its span is all of its text, a sign before the first term included; the span of a later term holds the
/// signs that are its own, and not the one that joins it.
pub(crate) fn sum(input: &mut Text<'_>) -> Read<Expr> {
    let begin = input.current_token_start();
    let first = product(input)?;
    let mut terms = vec![first];
    while let Some(minus) = opt(alt((sign("+").value(false), sign("-").value(true)))).parse_next(input)? {
        let begin = input.current_token_start();
        let (negative, value) = cut_err(product).parse_next(input)?;
        terms.push((minus, signed(negative, begin, value)));
    }
    if terms.len() == 1 {
        let (negative, value) = terms.remove(0);
        return Ok(signed(negative, begin, value));
    }
    let end = terms.last().map_or(begin, |(_, t)| t.span.end);
    Ok(Expr { kind: ExprKind::Sum(terms), span: begin..end })
}

/// The sign between two sides.
fn relation(input: &mut Text<'_>) -> Read<Relation> {
    // the longer signs first
    alt((
        sign("!=").value(Relation::NotEqual),
        sign("<=").value(Relation::AtMost),
        sign(">=").value(Relation::AtLeast),
        sign("<").value(Relation::Less),
        sign(">").value(Relation::Greater),
        sign("=").value(Relation::Equal),
    ))
    .parse_next(input)
}

/// `left = right`, perhaps `within tolerance`; `left < right`; and what stands for two of them: `low <= middle < high`,
/// `name in [low, high]`.
pub(crate) fn equations(input: &mut Text<'_>) -> Read<Vec<Equation>> {
    let left = sum(input)?;
    let begin = left.span.start;
    let one = |left: Expr, relation: Relation, right: Expr, end: usize| Equation {
        left,
        relation,
        right,
        within: None,
        span: begin..end,
    };
    if opt(keyword("in")).parse_next(input)?.is_some() {
        let (low, high, end) = cut_err(range).parse_next(input)?;
        let above = one(left.clone(), Relation::AtLeast, low, end);
        return Ok(vec![above, one(left, Relation::AtMost, high, end)]);
    }
    let expected = "'=', '<', '<=', '>', '>=', '!=' or an operator";
    let first = cut_err(relation).context(expected).parse_next(input)?;
    let right = cut_err(sum).parse_next(input)?;
    let end = right.span.end;
    let mut found = vec![one(left, first, right, end)];
    if first == Relation::Equal {
        found[0].within = opt(preceded(keyword("within"), cut_err(sum))).parse_next(input)?;
        found[0].span.end = found[0].within.as_ref().map_or(end, |within| within.span.end);
    } else {
        chain(input, &mut found)?;
    }
    Ok(found)
}

/// The further links of a chain.
fn chain(input: &mut Text<'_>, found: &mut Vec<Equation>) -> Read<()> {
    let first = found[0].relation;
    let mut at = input.current_token_start();
    while let Some(next) = opt(relation).parse_next(input)? {
        if !(first.is_ordering() && next.is_ordering() && first.points_up() == next.points_up()) {
            let help =
                "a chain goes one way, as in a <= b < c; write anything else as relations of their own";
            return stop(at, "the end of the relation", Some(help.into()));
        }
        let right = cut_err(sum).parse_next(input)?;
        let (left, span) = (found[found.len() - 1].right.clone(), found[0].span.start..right.span.end);
        found.push(Equation { left, relation: next, right, within: None, span });
        at = input.current_token_start();
    }
    let end = found[found.len() - 1].span.end;
    found.iter_mut().for_each(|link| link.span.end = end);
    Ok(())
}

/// `[low, high]`, and where it ends.
pub(crate) fn range(input: &mut Text<'_>) -> Read<(Expr, Expr, usize)> {
    sign("[").context("a range [low, high]").parse_next(input)?;
    let low = cut_err(sum).parse_next(input)?;
    cut_err(sign(",")).context("','").parse_next(input)?;
    let high = cut_err(sum).parse_next(input)?;
    let end = cut_err(closing("]")).context("']'").parse_next(input)?;
    Ok((low, high, end))
}

/// Runs a parser over a whole text.
pub(crate) fn read_all<'a, T>(
    text: &'a str,
    depth: &'a Depth,
    what: &'static str,
    parser: impl Parser<Text<'a>, T, ErrMode<Expected>>,
) -> Result<T, Expected> {
    let mut input = Stateful { input: LocatingSlice::new(text), state: depth };
    let mut parser = preceded(blank, parser);
    let value = parser.parse_next(&mut input).map_err(|error| match error {
        ErrMode::Backtrack(inner) | ErrMode::Cut(inner) => inner,
        ErrMode::Incomplete(_) => Expected { what: what.to_owned(), at: text.len(), help: None },
    })?;
    let at = input.current_token_start();
    if at < text.len() { Err(Expected { what: what.to_owned(), at, help: None }) } else { Ok(value) }
}

/// Reads one expression that is the whole text.
///
/// # Errors
/// What was expected instead, and where.
pub fn parse_expression(text: &str) -> Result<Expr, Expected> {
    read_all(text, &Depth::default(), "an operator, or the end", sum)
}
