//! Reading expressions. The parser combinators are winnow's; the error is ours, because it has to say what was
//! expected, and where.

mod hints;
mod indices;
mod tokens;

use super::syntax::{Equation, Expr, ExprKind, Name, Relation};
#[doc(hidden)]
pub use indices::{Target, loops, moved, names_of_range, repeat, target, written_out};
use indices::{fold, spread};
pub use tokens::Expected;
use tokens::{DEEPEST, closing, number};
#[doc(hidden)]
pub use tokens::{
    Depth, RESERVED, Read, SPECIAL, Text, UNDECLARABLE, blank, ends_a_line, helped, keyword, list, name,
    sign, stop, within, word,
};
use winnow::combinator::{alt, cut_err, not, opt, peek, preceded, separated};
use winnow::error::ErrMode;
use winnow::prelude::*;
use winnow::stream::{LocatingSlice, Location, Stateful};
use winnow::token::{literal, one_of, take_while};

/// The greatest exponent that may be written after `^`.
const LARGEST_EXPONENT: i32 = 1000;

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
    let row = |input: &mut Text<'_>| -> Read<Vec<Expr>> {
        input.state.in_row.set(true);
        list("an entry of the row", sum).map(spread).parse_next(input)
    };
    let rows: Vec<Vec<Expr>> = within(input, cut_err(separated(1.., row, sign(";"))))?;
    let end = cut_err(closing("]"))
        .context("']', ',' between the entries of a row, or ';' between rows")
        .parse_next(input)?;
    // elsewhere this is a matrix of two rows, and here it would be one long row
    let is_row = |entry: &Expr| matches!(&entry.kind, ExprKind::Matrix(inner) if inner.len() == 1);
    if let [row] = rows.as_slice()
        && row.len() > 1
        && row.iter().all(is_row)
    {
        let help = "rows have ';' between them, as in [a, b; c, d]; entries of one row stand in one pair of brackets";
        return stop(begin, "a matrix, with ';' between its rows", Some(help.to_owned()));
    }
    Ok(Expr { kind: ExprKind::Matrix(rows), span: begin..end })
}

/// A name, a call where a bracket follows at once, or a component of a vector where a square one does.
fn name_or_call(input: &mut Text<'_>) -> Read<Expr> {
    let name = target(input)?;
    if !name.is_plain() || opt(sign("(")).parse_next(input)?.is_none() {
        return Ok(name.expression());
    }
    let Target { name, span, .. } = name;
    if ["sum", "product"].contains(&name.as_str()) {
        return fold(input, &name, span.start);
    }
    let arguments: Vec<Expr> = within(input, cut_err(list("an argument", sum)))?;
    let end = cut_err(closing(")")).context("')' or ',' in the list of arguments").parse_next(input)?;
    Ok(Expr { kind: ExprKind::Call(name, spread(arguments)), span: span.start..end })
}

/// `name = value, ...` in braces, and where they end
pub fn assignments(input: &mut Text<'_>) -> Read<(Vec<(Name, Expr)>, usize)> {
    let one = |input: &mut Text<'_>| -> Read<Vec<(Name, Expr)>> {
        let target = target.context("a name to give a value to").parse_next(input)?;
        cut_err(sign("=")).context("'=' and a value").parse_next(input)?;
        let value = cut_err(sum).parse_next(input)?;
        let loops = loops(input)?;
        repeat(input, &loops, |indices| {
            let value = indices.bind(&value)?;
            Ok(target.names(indices)?.into_iter().map(|name| (name, value.clone())).collect())
        })
    };
    cut_err(sign("{")).context("'{' and a list of name = value").parse_next(input)?;
    let found: Vec<Vec<(Name, Expr)>> = within(input, cut_err(list("a name to give a value to", one)))?;
    let end = cut_err(closing("}")).context("'}' or ','").parse_next(input)?;
    Ok((found.concat(), end))
}

fn primary(input: &mut Text<'_>) -> Read<Expr> {
    alt((number, bracketed, matrix, name_or_call)).context("a number, a name, '(' or '['").parse_next(input)
}

/// A power, perhaps at a point: `x^2 at {x = 3}` is nine.
fn factor(input: &mut Text<'_>) -> Read<Expr> {
    let is_bracketed = input.starts_with('(');
    let mut value = power(input)?;
    loop {
        let at = input.current_token_start();
        if opt(keyword("at")).parse_next(input)?.is_none() {
            return Ok(value);
        }
        // `rank = 3 at {x = 0}` would say nothing of the rank at that point
        if matches!(value.kind, ExprKind::Number(_)) && !is_bracketed && input.starts_with('{') {
            let help = "'at' belongs to the number before it, which has the same value everywhere: a sum is taken at a point in brackets, as in (x + 3) at {x = 2}; the states of a claim stand behind 'where', as in rank = 3 where x = 0";
            return stop(at, "an expression with names before 'at'", Some(help.to_owned()));
        }
        let (list, end) = assignments(input)?;
        let span = value.span.start..end;
        value = Expr { kind: ExprKind::At(Box::new(value), list), span };
        if input.state.open.get() + at_depth(&value) > DEEPEST {
            return stop(input.current_token_start(), "fewer 'at' after one another", None);
        }
    }
}

fn at_depth(value: &Expr) -> usize {
    let (mut depth, mut inner) = (0, value);
    while let ExprKind::At(next, _) = &inner.kind {
        (depth, inner) = (depth + 1, next);
    }
    depth
}

/// `base^n`: `n` an integer, in brackets or not, or any number, name, call or expression in brackets, perhaps behind a minus.
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
    let in_brackets = (sign("("), bare, closing(")")).map(|((), (n, _), end)| (n, end, true));
    match opt(alt((in_brackets, bare.map(|(n, end)| (n, end, false))))).parse_next(input)? {
        Some((Some(n), end, is_in_brackets)) => {
            if opt(sign("^")).parse_next(input)?.is_some() {
                return stop(at, "one exponent; write (a^b)^c with its brackets", None);
            }
            let divides = ('/', take_while(1.., |c: char| c.is_ascii_digit()));
            if n == 1 && !is_in_brackets && opt(peek(divides)).parse_next(input)?.is_some() {
                let help = "x^1/2 is half of x: a root is written sqrt(x), or with a bracket, as in x^(1/2)";
                return stop(at, "an exponent in brackets, as in x^(1/2)", Some(help.to_owned()));
            }
            let span = base.span.start..end;
            Ok(Expr { kind: ExprKind::Power(Box::new(base), n), span })
        }
        Some((None, ..)) => stop(at, format!("an exponent of at most {LARGEST_EXPONENT}"), None),
        None => real_power(input, base),
    }
}

/// The rest of a power whose exponent is no integer.
fn real_power(input: &mut Text<'_>, base: Expr) -> Read<Expr> {
    let at = input.current_token_start();
    let negative = opt(sign("-")).parse_next(input)?.is_some();
    let exponent = cut_err(alt((number, bracketed, name_or_call)))
        .context("an exponent, as in x^2, x^(-1), x^n or x^(n + 1/2)")
        .parse_next(input)?;
    let exponent = signed(negative, at, exponent);
    let next = input.current_token_start();
    if opt(sign("^")).parse_next(input)?.is_some() {
        return stop(next, "one exponent; write (a^b)^c with its brackets", None);
    }
    let span = base.span.start..exponent.span.end;
    Ok(Expr { kind: ExprKind::RealPower(Box::new(base), Box::new(exponent)), span })
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
pub fn sum(input: &mut Text<'_>) -> Read<Expr> {
    let begin = input.current_token_start();
    let first = product(input)?;
    let mut end = first.1.span.end;
    let mut terms = vec![first];
    loop {
        let at = input.current_token_start();
        let joins = alt((literal("+").value(false), literal("-").value(true)));
        let Some(minus) = opt(joins).parse_next(input)? else { break };
        // `2 +- 0.1` is a tolerance elsewhere
        let is_tolerance = !minus
            && input
                .input
                .as_ref()
                .strip_prefix('-')
                .is_some_and(|behind| end < at || behind.starts_with(|c: char| c.is_whitespace()));
        if is_tolerance {
            let help = format!("{}; a negative term is written a + (-b)", hints::TOLERANCE);
            return stop(at, "one sign between two terms", Some(help));
        }
        // `[1 -2]` is a difference here, and two entries elsewhere
        let joined = input.current_token_start();
        blank(input)?;
        if input.state.in_row.get() && end < at && input.current_token_start() == joined {
            let help = "entries have ',' between them, as in [1, -2]; a difference has a blank on either side of its sign, or none";
            return stop(at, "',' or ']'", Some(help.to_owned()));
        }
        let begin = input.current_token_start();
        let (negative, value) = cut_err(product).parse_next(input)?;
        end = value.span.end;
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
pub fn relation(input: &mut Text<'_>) -> Read<Relation> {
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
pub fn equations(input: &mut Text<'_>) -> Read<Vec<Equation>> {
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

/// Relations between commas, each perhaps for several components or values of an index: `x[i] = 0 for i in 1..3`,
/// `x[1..3] > 0`.
pub fn conditions(input: &mut Text<'_>) -> Read<Vec<Equation>> {
    let one = |input: &mut Text<'_>| -> Read<Vec<Equation>> {
        let found = cut_err(equations).parse_next(input)?;
        let loops = loops(input)?;
        repeat(input, &loops, |indices| {
            let mut all = Vec::new();
            for one in &found {
                let one = indices.bind_relation(one)?;
                let lefts = written_out(one.left.clone());
                all.extend(lefts.into_iter().map(|left| Equation { left, ..one.clone() }));
            }
            Ok(all)
        })
    };
    let found: Vec<Vec<Equation>> = list("a relation", one).parse_next(input)?;
    Ok(found.concat())
}

/// `[low, high]`, and where it ends.
pub fn range(input: &mut Text<'_>) -> Read<(Expr, Expr, usize)> {
    sign("[").context("a range [low, high]").parse_next(input)?;
    let low = cut_err(sum).parse_next(input)?;
    cut_err(sign(",")).context("','").parse_next(input)?;
    let high = cut_err(sum).parse_next(input)?;
    let end = cut_err(closing("]")).context("']'").parse_next(input)?;
    Ok((low, high, end))
}

/// Runs a parser over a whole text.
pub fn read_all<'a, T>(
    text: &'a str,
    depth: &'a Depth,
    what: &'static str,
    parser: impl Parser<Text<'a>, T, ErrMode<Expected>>,
) -> Result<T, Expected> {
    let mut input = Stateful { input: LocatingSlice::new(text), state: depth };
    let mut parser = preceded(blank, parser);
    let value = parser.parse_next(&mut input).map_err(|error| match error {
        ErrMode::Backtrack(inner) | ErrMode::Cut(inner) => inner.hinted(text),
        ErrMode::Incomplete(_) => Expected { what: what.to_owned(), at: text.len(), help: None },
    })?;
    let at = input.current_token_start();
    if at < text.len() {
        Err(Expected { what: what.to_owned(), at, help: None }.hinted(text))
    } else {
        Ok(value)
    }
}

/// Reads one expression that is the whole text.
///
/// # Errors
/// What was expected instead, and where.
pub fn parse_expression(text: &str) -> Result<Expr, Expected> {
    read_all(text, &Depth::default(), "an operator, or the end", sum)
}
