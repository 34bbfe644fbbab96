//! The grammar of a proof file, without the meaning of its names. `book/src/language.md` documents it; it is a public interface.

use super::advice::advised;
use super::dimension::{annotation, declared};
use super::entry_words::{ENTRY, is_an_entry, no_entry, of_a_line};
use super::model::Role;
use super::problems::{Damage, indentation, is_first_in_line, missing_before, next_entry, open_quotation};
use super::signals::{entry, is_word_of_a_constant};
use super::standing::{Basis, basis, fault};
use super::syntax::{ClaimBody, ClaimSyntax, Expectation, Item, OutputSyntax, Statement};
use super::views::{begins, view};
use super::visible::visible;
use palmistry_io::foreign::shown;
use palmistry_math::expression::Expected;
use palmistry_math::expression::parse::{
    Depth, Read, Text, blank, conditions, equations, keyword, list, loops, moved, name, range, read_all,
    repeat, sign, stop, sum, target, written_out,
};
use palmistry_math::expression::syntax::{Equation, Expr, ExprKind, Name, Span};
use std::collections::HashSet;
use winnow::combinator::{alt, cut_err, opt, peek, preceded, separated};
use winnow::error::ErrMode;
use winnow::prelude::*;
use winnow::stream::{Location, Stream};
use winnow::token::{literal, take_till, take_while};

/// A text in double quotation marks, as it may be shown: in one line, with nothing in it that is not seen.
pub(super) fn quoted(input: &mut Text<'_>) -> Read<String> {
    literal("\"").void().context("a text in double quotation marks").parse_next(input)?;
    let text = take_till(0.., |c| c == '"').parse_next(input)?;
    cut_err(literal("\"")).context("a closing quotation mark").parse_next(input)?;
    blank(input)?;
    Ok(shown(&text.split_whitespace().collect::<Vec<_>>().join(" ")).into_owned())
}

fn names(input: &mut Text<'_>) -> Read<Vec<Name>> {
    let one = |input: &mut Text<'_>| -> Read<Vec<Name>> {
        let target = target(input)?;
        repeat(input, &[], |indices| target.names(indices))
    };
    let found: Vec<Vec<Name>> = cut_err(list("a name", one)).context("a list of names").parse_next(input)?;
    Ok(found.concat())
}

/// Expressions between commas, each perhaps for several values of an index.
fn expressions(input: &mut Text<'_>) -> Read<Vec<Expr>> {
    let one = |input: &mut Text<'_>| -> Read<Vec<Expr>> {
        let expr = sum(input)?;
        let loops = loops(input)?;
        repeat(input, &loops, |indices| Ok(written_out(indices.bind(&expr)?)))
    };
    let found: Vec<Vec<Expr>> = list("an expression", one).parse_next(input)?;
    Ok(found.concat())
}

fn system(input: &mut Text<'_>) -> Read<Item> {
    let span = keyword("system").parse_next(input)?;
    let title = cut_err(quoted).parse_next(input)?;
    let cite = opt(preceded(keyword("cite"), cut_err(quoted))).parse_next(input)?;
    Ok(Item::System { title, cite, span })
}

fn import(input: &mut Text<'_>) -> Read<Item> {
    let begin = keyword("use").parse_next(input)?.start;
    let alias = cut_err(name).context("a name for the other system").parse_next(input)?;
    cut_err(sign("=")).context("'=' and a file name in quotation marks").parse_next(input)?;
    let path = cut_err(quoted).parse_next(input)?;
    Ok(Item::Use { alias, path, span: begin..input.current_token_start() })
}

fn states(input: &mut Text<'_>) -> Read<Item> {
    keyword("state").parse_next(input)?;
    cut_err(declared(false)).context("a list of names").map(Item::State).parse_next(input)
}

/// The values of a list of outputs, each behind what is read before it.
fn seen(input: &mut Text<'_>, before: impl Fn(&mut Text<'_>) -> Read<()>) -> Read<Vec<OutputSyntax>> {
    let one = |input: &mut Text<'_>| -> Read<Vec<OutputSyntax>> {
        before(input)?;
        let (expr, dimension) = (sum(input)?, annotation(input)?);
        let loops = loops(input)?;
        repeat(input, &loops, |indices| {
            let entries = written_out(indices.bind(&expr)?);
            let is_repeated = !loops.is_empty() || entries.len() > 1;
            let one = |value| OutputSyntax { value, dimension: dimension.clone(), is_repeated };
            Ok(entries.into_iter().map(one).collect())
        })
    };
    let found: Vec<Vec<_>> = cut_err(list("an output", one)).parse_next(input)?;
    Ok(found.concat())
}

fn outputs(input: &mut Text<'_>) -> Read<Item> {
    keyword("output").parse_next(input)?;
    seen(input, |_| Ok(())).map(Item::Output)
}

fn zero_outputs(input: &mut Text<'_>) -> Read<Item> {
    let zero = |input: &mut Text<'_>| -> Read<()> {
        (literal("0"), blank, literal("=")).void().parse_next(input)?;
        blank(input)
    };
    keyword("output").parse_next(input)?;
    peek(zero).parse_next(input)?;
    let before = |input: &mut Text<'_>| {
        let what = "'0 =': where one output of a list is zero all of them are";
        cut_err(zero).context(what).parse_next(input)
    };
    seen(input, before).map(Item::Zero)
}

fn params(input: &mut Text<'_>) -> Read<Item> {
    keyword("param").parse_next(input)?;
    let list = cut_err(declared(true)).context("a list of parameters").parse_next(input)?;
    Ok(Item::Param(list))
}

/// One definition, or one for each component of a vector.
fn definitions(input: &mut Text<'_>) -> Read<Vec<Item>> {
    keyword("let").parse_next(input)?;
    let target = cut_err(target).context("the name to define").parse_next(input)?;
    let dimension = annotation(input)?;
    cut_err(sign("=")).context("'=' and an expression").parse_next(input)?;
    let value = cut_err(sum).parse_next(input)?;
    let loops = loops(input)?;
    repeat(input, &loops, |indices| {
        let value = indices.bind(&value)?;
        let one = |name| Item::Let { name, dimension: dimension.clone(), value: value.clone() };
        Ok(target.names(indices)?.into_iter().map(one).collect())
    })
}

fn field(input: &mut Text<'_>) -> Read<Item> {
    let role = alt((
        keyword("drift").value(Role::Drift),
        keyword("input").value(Role::Input),
        keyword("field").value(Role::Other),
    ))
    .parse_next(input)?;
    let title = cut_err(name).context("the field's name").parse_next(input)?;
    let mut time = None;
    let mut component = |input: &mut Text<'_>| -> Read<Vec<(Name, Expr)>> {
        let begin = input.current_token_start();
        let (state, steps) = moved(input)?;
        if *time.get_or_insert(steps) != steps {
            let help = "x' is a rate of change, x+ the value after a step: a system has one of the two";
            return stop(begin, "one kind of time in a field", Some(help.to_owned()));
        }
        if steps && state.name == "others" {
            return stop(begin, "the name of a state: one that is not named stays as it is", None);
        }
        cut_err(sign("=")).context("'=' and the rate of change").parse_next(input)?;
        let rate = cut_err(sum).parse_next(input)?;
        let loops = loops(input)?;
        repeat(input, &loops, |indices| {
            let rate = indices.bind(&rate)?;
            Ok(state.names(indices)?.into_iter().map(|name| (name, rate.clone())).collect())
        })
    };
    let mut components: Vec<(Name, Expr)> = Vec::new();
    while !begins(input)
        && let Some(found) = opt(component.by_ref()).parse_next(input)?
    {
        components.extend(found);
    }
    let is_zero = |value: &Expr| matches!(&value.kind, ExprKind::Number(zero) if zero.is_zero());
    let (others, components): (Vec<_>, Vec<_>) =
        components.into_iter().partition(|(state, _)| state.text == "others");
    if let Some((_, value)) = others.iter().find(|(_, value)| !is_zero(value)) {
        return stop(value.span.start, "0: the components that are not named can only be zero", None);
    }
    let others_are_zero = !others.is_empty();
    let is_map = time == Some(true);
    Ok(Item::Field { role, name: title, components, others_are_zero, is_map })
}

fn sample(input: &mut Text<'_>) -> Read<Item> {
    keyword("sample").parse_next(input)?;
    let ranged = |input: &mut Text<'_>| -> Read<Vec<(Name, Expr, Expr)>> {
        let target = target(input)?;
        cut_err(keyword("in")).context("'in' and a range [low, high]").parse_next(input)?;
        let (low, high, _) = cut_err(range).parse_next(input)?;
        let loops = loops(input)?;
        opt(sign(",")).parse_next(input)?;
        repeat(input, &loops, |indices| {
            let (low, high) = (indices.bind(&low)?, indices.bind(&high)?);
            let one = |name| (name, low.clone(), high.clone());
            Ok(target.names(indices)?.into_iter().map(one).collect())
        })
    };
    let mut ranges = Vec::new();
    while !begins(input)
        && let Some(found) = opt(ranged).parse_next(input)?
    {
        ranges.extend(found);
    }
    let avoid = opt(preceded(keyword("avoid"), cut_err(expressions))).parse_next(input)?;
    Ok(Item::Sample { ranges, avoid: avoid.unwrap_or_default() })
}

/// The number or name of a claim.
pub(super) fn identifier(input: &mut Text<'_>) -> Read<Name> {
    let (text, span) = take_while(1.., |c: char| c.is_alphanumeric() || matches!(c, '.' | '_' | '-'))
        .with_span()
        .context("the claim's number or name")
        .parse_next(input)?;
    let text = text.to_owned();
    blank(input)?;
    Ok(Name { text, span })
}

/// Digits that a computer-algebra system carried: `10 digits`, and where that ends.
fn carried_digits(input: &mut Text<'_>) -> Read<(usize, usize)> {
    let at = input.current_token_start();
    let count = cut_err(sum).context("the number of digits").parse_next(input)?;
    let end =
        cut_err(keyword("digits")).context("'digits', as in 'carrying 10 digits'").parse_next(input)?.end;
    let digits = match &count.kind {
        ExprKind::Number(number) if number.is_int() => usize::try_from(number.numerator().clone()).ok(),
        _ => None,
    };
    match digits.filter(|digits| (1..=MOST_CARRIED_DIGITS).contains(digits)) {
        Some(digits) => Ok((digits, end)),
        None => stop(at, format!("a number of digits from 1 to {MOST_CARRIED_DIGITS}"), None),
    }
}

/// More digits than these explain no rounding: a value is certified to forty.
const MOST_CARRIED_DIGITS: usize = 30;

pub(super) fn statement(input: &mut Text<'_>) -> Read<Box<Statement>> {
    let begin = input.current_token_start();
    let (equation, further) = match opt(visible).parse_next(input)? {
        Some(visible) => (visible, Vec::new()),
        None => {
            let mut further = cut_err(equations).parse_next(input)?;
            (further.remove(0), further)
        }
    };
    let mut end = equation.span.end;
    let carried = match opt(keyword("carrying")).parse_next(input)? {
        None => None,
        Some(_) => {
            let (digits, ends) = carried_digits(input)?;
            end = ends;
            Some(digits)
        }
    };
    let on_sample = match opt(keyword("on")).parse_next(input)? {
        None => false,
        Some(_) => {
            end = cut_err(keyword("sample")).context("'sample', as in 'on sample'").parse_next(input)?.end;
            true
        }
    };
    let given = opt(preceded(keyword("where"), conditions)).parse_next(input)?;
    let conditions: Vec<Equation> = given.unwrap_or_default();
    end = conditions.last().map_or(end, |last| last.span.end);
    let everywhere = opt(keyword("everywhere")).parse_next(input)?;
    end = everywhere.as_ref().map_or(end, |word| word.end);
    let except = match opt(keyword("except")).parse_next(input)? {
        None => everywhere.map(|_| Vec::new()),
        Some(_) => {
            cut_err(keyword("where")).context("'where', as in 'except where x = 0'").parse_next(input)?;
            let one = |input: &mut Text<'_>| -> Read<Vec<Equation>> {
                let found: Vec<Vec<Equation>> = cut_err(list("an equation", equations)).parse_next(input)?;
                Ok(found.into_iter().flatten().collect())
            };
            let sets: Vec<Vec<Equation>> = cut_err(separated(1.., one, keyword("or"))).parse_next(input)?;
            Some(sets)
        }
    };
    end = except.iter().flatten().flatten().last().map_or(end, |last| last.span.end);
    Ok(Box::new(Statement { equation, further, carried, on_sample, conditions, except, span: begin..end }))
}

/// Reads a statement that is the whole text, as it stands behind the colon of a claim.
///
/// # Errors
/// What was expected instead, and where.
pub fn parse_statement(text: &str) -> Result<Statement, Expected> {
    read_all(text, &Depth::default(), "an operator, 'where' or the end", statement).map(|found| *found)
}

fn claim(input: &mut Text<'_>) -> Read<Item> {
    keyword("claim").parse_next(input)?;
    let id = cut_err(identifier).parse_next(input)?;
    let given = input.current_token_start();
    let basis = basis(input)?;
    let verdict = alt((
        keyword("proved").value(Expectation::Proved),
        keyword("refuted").value(Expectation::Refuted),
        keyword("undecided").value(Expectation::Undecided),
    ));
    let expected = match opt(preceded(keyword("expect"), opt(verdict))).parse_next(input)? {
        None => Expectation::Proved,
        Some(Some(verdict)) => verdict,
        Some(None) => return stop(input.current_token_start(), "'proved', 'refuted' or 'undecided'", None),
    };
    if basis != Basis::Derived && expected != Expectation::Proved {
        return stop(given, "either what the claim rests on or a verdict other than 'proved'", None);
    }
    cut_err(sign(":")).context("':' and what is claimed").parse_next(input)?;
    let statement = statement(input)?;
    let remark = opt(quoted).parse_next(input)?;
    let body = ClaimBody::Claim { statement, expected };
    let (id, span) = (id.text, id.span);
    Ok(sound(id, span, (body, basis, remark)))
}

/// An entry that is no fault.
fn sound(id: String, span: Span, (body, basis, remark): (ClaimBody, Basis, Option<String>)) -> Item {
    Item::Claim(Box::new(ClaimSyntax {
        id,
        span,
        body,
        basis,
        follows: None,
        passage: None,
        remark,
        conclusion: None,
    }))
}

/// `erratum`, `damaged`, `scan`, `convention` and `loose`.
fn faulty(input: &mut Text<'_>) -> Read<Item> {
    let entry = fault(input)?;
    let remark = opt(quoted).parse_next(input)?;
    let conclusion = opt(preceded(keyword("conclusion"), cut_err(quoted))).parse_next(input)?;
    let (id, span, follows, passage) = (entry.id.text, entry.id.span, entry.follows, entry.passage);
    let (body, basis) = (entry.body, Basis::Derived);
    Ok(Item::Claim(Box::new(ClaimSyntax { id, span, body, basis, follows, passage, remark, conclusion })))
}

/// `definition ID: "text"` and `undecided ID: "reason"`.
fn remark_only(input: &mut Text<'_>) -> Read<Item> {
    let open =
        alt((keyword("definition").value(false), keyword("undecided").value(true))).parse_next(input)?;
    let id = cut_err(identifier).parse_next(input)?;
    cut_err(sign(":")).context("':'").parse_next(input)?;
    let text = cut_err(quoted).parse_next(input)?;
    let body = if open { ClaimBody::Open { reason: text } } else { ClaimBody::Definition { text } };
    let (id, span) = (id.text, id.span);
    Ok(sound(id, span, (body, Basis::Derived, None)))
}

/// How names look in a formula: `latex Fyf "F_{yf}"`.
fn looks(input: &mut Text<'_>) -> Read<Item> {
    keyword("latex").parse_next(input)?;
    let one = |input: &mut Text<'_>| -> Read<(Name, String, Span)> {
        let name = name(input)?;
        let begin = input.current_token_start();
        let text = quoted(input)?;
        Ok((name, text, begin..input.current_token_start()))
    };
    let looks = cut_err(list("a name and how it looks", one))
        .context("a name and how it looks, as in latex Fyf \"F_{yf}\"");
    looks.map(Item::Looks).parse_next(input)
}

fn item(input: &mut Text<'_>) -> Read<Vec<Item>> {
    let one = alt((
        system,
        import,
        states,
        params,
        alt((
            preceded(keyword("angle"), names).map(Item::Angle),
            preceded(keyword("assume"), conditions).map(Item::Assume),
            looks,
        )),
        field,
        alt((zero_outputs, outputs)),
        alt((sample, claim, faulty, remark_only, view, entry)),
    ));
    alt((definitions, one.map(|item| vec![item]))).parse_next(input)
}

/// Reads a whole file.
pub(crate) fn parse_file(text: &str) -> Result<Vec<Item>, Expected> {
    let Entries { items, mut damage, .. } = parse_entries(text, 1);
    if damage.is_empty() { Ok(items) } else { Err(damage.remove(0).expected) }
}

/// That a quotation goes on into the next entry.
fn never_closed(at: usize) -> Expected {
    let help = "the text goes on into the next entry, up to the quotation mark with which another one begins";
    Expected { what: "a closing quotation mark for this one".to_owned(), at, help: Some(help.to_owned()) }
}

/// Whether the last entry is a field that leaves out states of the file.
fn breaks_off(items: &[Item]) -> bool {
    let Some(Item::Field { components, others_are_zero: false, is_map: false, .. }) = items.last() else {
        return false;
    };
    let named: HashSet<&str> = components.iter().map(|(name, _)| name.text.as_str()).collect();
    let states = items.iter().flat_map(|item| match item {
        Item::State(list) => list.as_slice(),
        _ => &[],
    });
    { states }.any(|state| !named.contains(state.name.text.as_str()))
}

/// What could be read of a file.
#[derive(Default)]
pub(super) struct Entries {
    /// The entries that could be.
    pub items: Vec<Item>,
    /// Where each of them stands, with the blanks and comments behind it.
    pub spans: Vec<Span>,
    /// What is no entry.
    pub damage: Vec<Damage>,
    /// The indices in it, wherever one gets its range.
    pub indices: Vec<Name>,
}

/// Reads what can be read of a file: its entries, and up to `most` parts of it that are none. Behind the last of those
/// nothing is read.
pub(super) fn parse_entries(text: &str, most: usize) -> Entries {
    let (mut damage, mut spans) = (Vec::new(), Vec::new());
    let all = |input: &mut Text<'_>| -> Read<Vec<Item>> {
        let mut items = Vec::new();
        // where the last entry begins
        let mut before = (input.checkpoint(), input.current_token_start());
        while !input.input.as_ref().is_empty() {
            let (start, begin) = (input.checkpoint(), input.current_token_start());
            let behind = !items.is_empty() && !is_first_in_line(text, begin);
            let found = match behind && is_word_of_a_constant(input) {
                true => winnow::combinator::fail.parse_next(input),
                false => item.parse_next(input),
            };
            let mut entry = begin;
            let mut expected = match found {
                Ok(found) => {
                    spans.extend(found.iter().map(|_| begin..input.current_token_start()));
                    items.extend(found);
                    before = (start, begin);
                    continue;
                }
                Err(ErrMode::Cut(error)) => Expected { at: missing_before(text, begin, error.at), ..error },
                Err(_) => {
                    entry = if behind { before.1 } else { begin };
                    no_entry(text, input, !items.is_empty())
                }
            };
            expected = advised(of_a_line(expected, text), text, entry);
            let after = |begin: usize| next_entry(text, begin, indentation(text, begin));
            // what stands behind an entry in its line belongs to it
            let swallowed =
                if behind { open_quotation(&text[before.1..after(before.1).min(begin)]) } else { None };
            let (start, begin, damaged, expected) = match swallowed {
                Some(quote) if after(before.1) < begin => {
                    items.pop();
                    spans.pop();
                    (before.0, before.1, before.1, never_closed(before.1 + quote))
                }
                // a field whose rates break off says nothing of the states that it does not come to
                _ if breaks_off(&items) && !is_an_entry(&text[begin..]) => {
                    items.pop();
                    spans.pop();
                    (start, begin, before.1, expected)
                }
                _ => (start, begin, if behind { before.1 } else { begin }, expected),
            };
            let end = if damage.len() + 1 >= most { text.len() } else { after(begin) };
            damage.push(Damage { expected, left_out: damaged..end });
            input.reset(&start);
            input.next_slice(end - begin);
        }
        Ok(items)
    };
    let depth = Depth::default();
    let items = read_all(text, &depth, ENTRY, all);
    let indices = depth.indices.take();
    match items {
        Ok(items) => Entries { items, spans, damage, indices },
        Err(expected) => {
            let damage = vec![Damage { expected, left_out: 0..text.len() }];
            Entries { damage, ..Entries::default() }
        }
    }
}
