//! How a dimension is written: `: length/time^2`, `: kg*m^2`, `: length^(1/2)`, `: 1`.
//!
//! Its words are no words of the language: they mean something behind a colon only.

use super::exponents::Dimension;
use super::words::{Meaning, all, meaning};
use crate::nearest;
use crate::signals::{Knowledge, knowledge, spread_knowledge};
use dashu::rational::RBig;
use palmistry_math::expression::parse::{
    Read, Target, Text, blank, ends_a_line, list, loops, repeat, sign, stop, sum, target, within, word,
};
use palmistry_math::expression::syntax::{Expr, Loop, Name, Span};
use winnow::combinator::{alt, cut_err, opt, preceded};
use winnow::prelude::*;
use winnow::stream::{Location, Stream};
use winnow::token::take_while;

/// The greatest number in an exponent.
const LARGEST_EXPONENT: i32 = 100;

/// What stands behind a colon.
#[derive(Clone, Debug)]
pub(crate) struct DeclaredDimension {
    pub dimension: Dimension,
    pub span: Span,
}

/// A name that is declared, perhaps with a value and a dimension.
#[derive(Clone, Debug)]
pub(crate) struct Declared {
    pub name: Name,
    pub value: Option<Expr>,
    pub dimension: Option<DeclaredDimension>,
    /// Whether somebody knows the value; of a parameter, where it is said.
    pub knowledge: Option<Knowledge>,
}

/// `: DIMENSION`, if there is one.
pub(crate) fn annotation(input: &mut Text<'_>) -> Read<Option<DeclaredDimension>> {
    if opt(sign(":")).parse_next(input)?.is_none() {
        return Ok(None);
    }
    let begin = input.current_token_start();
    let (dimension, text) = cut_err(product.with_taken()).parse_next(input)?;
    Ok(Some(DeclaredDimension { dimension, span: begin..begin + length_without_blanks(text) }))
}

/// How much of a text is left without the blanks and comments at its end.
fn length_without_blanks(text: &str) -> usize {
    let (mut end, mut comment) = (0, false);
    for (place, c) in text.char_indices() {
        comment = (comment || c == '#') && !ends_a_line(c);
        if !comment && !c.is_whitespace() && !ends_a_line(c) {
            end = place + c.len_utf8();
        }
    }
    end
}

/// Names as they are declared in one place of a list, before they are written out.
pub(crate) struct DeclaredTarget {
    target: Target,
    pub value: Option<Expr>,
    dimension: Option<DeclaredDimension>,
    pub knowledge: Option<Knowledge>,
    loops: Vec<Loop>,
}

/// A list of names, components and ranges of them, each perhaps with a dimension, and where `with_values` with a value before
/// or behind it and whether that is known.
pub(crate) fn declared<'a>(with_values: bool) -> impl FnMut(&mut Text<'a>) -> Read<Vec<Declared>> {
    move |input: &mut Text<'a>| {
        let one = |input: &mut Text<'a>| -> Read<DeclaredTarget> {
            let target = target(input)?;
            let mut dimension = annotation(input)?;
            let value =
                if with_values { opt(preceded(sign("="), cut_err(sum))).parse_next(input)? } else { None };
            if value.is_some() && dimension.is_none() {
                dimension = annotation(input)?;
            }
            let knowledge = if with_values { knowledge(input)? } else { None };
            Ok(DeclaredTarget { target, value, dimension, knowledge, loops: loops(input)? })
        };
        let mut targets: Vec<DeclaredTarget> = list("a name", one).parse_next(input)?;
        spread(&mut targets);
        spread_knowledge(&mut targets);
        let mut found = Vec::new();
        for DeclaredTarget { target, value, dimension, knowledge, loops } in &targets {
            let knowledge = *knowledge;
            found.extend(repeat(input, loops, |indices| {
                let value = value.as_ref().map(|value| indices.bind(value)).transpose()?;
                let one =
                    |name| Declared { name, value: value.clone(), dimension: dimension.clone(), knowledge };
                Ok(target.names(indices)?.into_iter().map(one).collect())
            })?);
        }
        Ok(found)
    }
}

/// A dimension holds for the names before it that have none yet, as in `x, y : length, v : velocity`. A name with a value
/// of its own is complete without: in `m = 1, g : acceleration` the first is no acceleration.
fn spread(list: &mut [DeclaredTarget]) {
    let mut last: Option<DeclaredDimension> = None;
    for one in list.iter_mut().rev() {
        match &one.dimension {
            Some(own) => last = Some(own.clone()),
            None if one.value.is_some() => last = None,
            None => one.dimension = last.clone(),
        }
    }
}

fn product(input: &mut Text<'_>) -> Read<Dimension> {
    let mut total = power(input)?;
    while let Some(divides) = opt(alt((sign("*").value(false), sign("/").value(true)))).parse_next(input)? {
        let factor = cut_err(power).parse_next(input)?;
        total = if divides { total.over(&factor) } else { total.times(&factor) };
    }
    Ok(total)
}

fn power(input: &mut Text<'_>) -> Read<Dimension> {
    let base = primary(input)?;
    if opt(sign("^")).parse_next(input)?.is_none() {
        return Ok(base);
    }
    let at = input.current_token_start();
    let in_brackets = |input: &mut Text<'_>| -> Read<Option<RBig>> {
        sign("(").parse_next(input)?;
        let above = whole(input)?;
        let below = opt(preceded(sign("/"), whole)).parse_next(input)?;
        sign(")").parse_next(input)?;
        let below = below.unwrap_or(Some(1));
        let divisor = below.filter(|below| *below != 0);
        Ok(above.zip(divisor).map(|(above, below)| RBig::from(above) / RBig::from(below)))
    };
    let bare = whole.map(|exponent| exponent.map(RBig::from));
    match opt(alt((in_brackets, bare))).parse_next(input)? {
        Some(Some(exponent)) => Ok(base.power(&exponent)),
        Some(None) => {
            let what = format!("an exponent with numbers of at most {LARGEST_EXPONENT}, not divided by zero");
            stop(at, what, None)
        }
        None => stop(at, "an exponent, as in length^2 or length^(1/2)", None),
    }
}

/// A whole number, if it is not too large.
fn whole(input: &mut Text<'_>) -> Read<Option<i32>> {
    let minus = opt(sign("-")).parse_next(input)?.is_some();
    let digits = take_while(1.., |c: char| c.is_ascii_digit()).parse_next(input)?;
    blank(input)?;
    let value = digits.parse::<i32>().ok().filter(|value| *value <= LARGEST_EXPONENT);
    Ok(value.map(|value| if minus { -value } else { value }))
}

fn primary(input: &mut Text<'_>) -> Read<Dimension> {
    let at = input.current_token_start();
    if opt(sign("(")).parse_next(input)?.is_some() {
        let inner = within(input, cut_err(product))?;
        cut_err(sign(")")).context("')', '*' or '/'").parse_next(input)?;
        return Ok(inner);
    }
    let digits = opt(take_while(1.., |c: char| c.is_ascii_digit())).parse_next(input)?;
    if let Some(digits) = digits {
        blank(input)?;
        if digits == "1" {
            return Ok(Dimension::none());
        }
        let help = "a unit says what is measured, and the numbers of a file are those in units of the SI; \
                    an exponent that is a fraction stands in brackets, as in length^(1/2)";
        return stop(at, "a dimension: 1 is the only number in one", Some(help.to_owned()));
    }
    let start = input.checkpoint();
    let Some((text, _)) = opt(word).parse_next(input)? else {
        input.reset(&start);
        let help = match input.input.as_ref().starts_with('=') {
            true => "write '=' alone",
            false => "for instance length, velocity, kg, N*m or 1",
        };
        return stop(at, "a dimension, as in length/time^2 or m/s^2", Some(help.to_owned()));
    };
    match meaning(text) {
        Meaning::Dimension(dimension) => {
            blank(input)?;
            Ok(dimension)
        }
        Meaning::Scaled(quantity) => {
            let what = format!("a dimension, or a unit of the SI without a factor; '{text}' has one");
            let help = format!("write '{quantity}', and the numbers of the file in units of the SI");
            stop(at, what, Some(help))
        }
        Meaning::Nothing => {
            let help = match nearest(text, all()) {
                Some(near) => format!("perhaps you meant '{near}'"),
                None => "for instance length, velocity, kg, N*m or 1".to_owned(),
            };
            stop(at, format!("a dimension; '{text}' is none"), Some(help))
        }
    }
}
