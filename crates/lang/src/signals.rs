//! How it is written what somebody knows of a system: signals that enter it, values at the beginning, how many experiments
//! were made, and behind a parameter whether its value is known.
//!
//! The words that begin these entries are names too, where nothing follows that makes an entry of them.

use super::dimension::{DeclaredDimension, DeclaredTarget, annotation};
use super::driven::Driven;
use super::syntax::{Item, Statement};
use super::views::View;
use palmistry_math::expression::parse::{
    Read, Text, keyword, list, loops, name, repeat, sign, stop, sum, target,
};
use palmistry_math::expression::syntax::{Equation, Expr, ExprKind, Name, Span};
use std::collections::HashMap;
use winnow::combinator::{alt, cut_err, opt, peek, preceded};
use winnow::prelude::*;
use winnow::stream::Location;

/// What stands behind a name whose value somebody knows, or nobody.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Knowledge {
    Known,
    Unknown,
}

/// A signal as it is declared: `u(t) : force order 2`.
#[derive(Clone, Debug)]
pub(crate) struct DeclaredSignal {
    pub name: Name,
    pub dimension: Option<DeclaredDimension>,
    /// How many of its derivatives are taken not to vanish; of an unknown one.
    pub order: Option<Expr>,
}

/// What is known of a state at the beginning: that it is, or its value.
#[derive(Clone, Debug)]
pub(crate) struct DeclaredInitial {
    pub name: Name,
    pub value: Option<Expr>,
}

/// The words that begin these entries.
pub(super) const WORDS: [&str; 4] = ["known", "unknown", "initial", "experiments"];

/// Whether one of these entries begins here, and not a name that is one of their words.
pub(super) fn begins(input: &mut Text<'_>) -> bool {
    let signal = (alt((keyword("known"), keyword("unknown"))), target, sign("(")).void();
    let initial = (keyword("initial"), target, alt((sign("="), sign(","), keyword("known").void()))).void();
    let experiments = (keyword("experiments"), winnow::token::one_of(|c: char| c.is_ascii_digit())).void();
    peek(alt((signal, initial, experiments))).parse_next(input).is_ok()
}

/// Whether one of the words stands here that say of a constant whether it is known, and begins no entry.
pub(super) fn is_word_of_a_constant(input: &mut Text<'_>) -> bool {
    let word = alt((keyword("known"), keyword("unknown")));
    peek(word).parse_next(input).is_ok() && !begins(input)
}

/// Whether the text behind one of these words makes an entry of it, as far as its next signs tell: [`begins`] for those who read
/// lines and not the grammar.
pub(super) fn goes_on(word: &str, rest: &str) -> bool {
    let rest = rest.trim_start();
    let end = rest.find(|c: char| !(c.is_ascii_alphanumeric() || c == '_')).unwrap_or(rest.len());
    let component = rest[end..].strip_prefix('[').and_then(|behind| behind.split_once(']'));
    let (next, behind) = (&rest[..end], component.map_or(&rest[end..], |(_, behind)| behind).trim_start());
    match word {
        "experiments" => next.starts_with(|c: char| c.is_ascii_digit()),
        "initial" => {
            let said = behind.starts_with("known") || behind.starts_with(['=', ',']);
            !next.is_empty() && next != "in" && said
        }
        _ => !next.is_empty() && behind.starts_with('('),
    }
}

/// `known` or `unknown` behind a parameter, unless it begins the next entry.
pub(crate) fn knowledge(input: &mut Text<'_>) -> Read<Option<Knowledge>> {
    if begins(input) {
        return Ok(None);
    }
    opt(alt((keyword("known").value(Knowledge::Known), keyword("unknown").value(Knowledge::Unknown))))
        .parse_next(input)
}

/// The word of a parameter holds for the names before it that have neither this word nor a value, as a dimension does.
pub(crate) fn spread_knowledge(list: &mut [DeclaredTarget]) {
    let mut last = None;
    for one in list.iter_mut().rev() {
        match one.knowledge {
            Some(own) => last = Some(own),
            None if one.value.is_some() => last = None,
            None => one.knowledge = last,
        }
    }
}

fn signals(input: &mut Text<'_>) -> Read<Item> {
    let knowledge =
        alt((keyword("known").value(Knowledge::Known), keyword("unknown").value(Knowledge::Unknown)))
            .parse_next(input)?;
    let one = |input: &mut Text<'_>| -> Read<Vec<DeclaredSignal>> {
        let target = target.context("the name of a signal, as in u(t)").parse_next(input)?;
        cut_err(sign("("))
            .context("'(t)' behind the name of a signal, as in known u(t)")
            .parse_next(input)?;
        let at = input.current_token_start();
        let time = cut_err(name_of_time).parse_next(input)?;
        if time != "t" {
            return stop(at, "'t': a signal is one of time", None);
        }
        cut_err(sign(")")).context("')'").parse_next(input)?;
        let dimension = annotation(input)?;
        let at = input.current_token_start();
        let order = opt(preceded(keyword("order"), cut_err(sum))).parse_next(input)?;
        if order.is_some() && knowledge == Knowledge::Known {
            let help = "of a known signal as many derivatives are taken as the file mentions";
            return stop(at, "no order behind a known signal", Some(help.to_owned()));
        }
        repeat(input, &[], |indices| {
            let one = |name| DeclaredSignal { name, dimension: dimension.clone(), order: order.clone() };
            Ok(target.names(indices)?.into_iter().map(one).collect())
        })
    };
    let found: Vec<Vec<DeclaredSignal>> = cut_err(list("the name of a signal, as in u(t)", one))
        .context("a list of signals, as in u(t), v(t)")
        .parse_next(input)?;
    let mut list = found.concat();
    let (mut dimension, mut order) = (None, None);
    for one in list.iter_mut().rev() {
        match &one.dimension {
            Some(own) => dimension = Some(own.clone()),
            None => one.dimension = dimension.clone(),
        }
        match &one.order {
            Some(own) => order = Some(own.clone()),
            None => one.order = order.clone(),
        }
    }
    Ok(Item::Signals { knowledge, list })
}

fn name_of_time(input: &mut Text<'_>) -> Read<String> {
    name.context("'t', as in u(t)").map(|name| name.text).parse_next(input)
}

fn initial(input: &mut Text<'_>) -> Read<Item> {
    keyword("initial").parse_next(input)?;
    let one = |input: &mut Text<'_>| -> Read<Vec<(DeclaredInitial, bool)>> {
        let target = target.context("a state").parse_next(input)?;
        let value = opt(preceded(sign("="), cut_err(sum))).parse_next(input)?;
        let known = value.is_none() && !begins(input) && opt(keyword("known")).parse_next(input)?.is_some();
        let loops = loops(input)?;
        repeat(input, &loops, |indices| {
            let value = value.as_ref().map(|value| indices.bind(value)).transpose()?;
            let one = |name| (DeclaredInitial { name, value: value.clone() }, known);
            Ok(target.names(indices)?.into_iter().map(one).collect())
        })
    };
    let found: Vec<Vec<(DeclaredInitial, bool)>> = cut_err(list("the name of a state", one))
        .context("a list of states, as in 'initial x known' or 'initial x = 0'")
        .parse_next(input)?;
    let list = found.concat();
    let mut said = false;
    for (one, known) in list.iter().rev() {
        said = one.value.is_none() && (said || *known);
        if one.value.is_none() && !said {
            let what = format!("'known' or a value behind '{}', as in 'initial {0} known'", one.name.text);
            return stop(one.name.span.end, what, None);
        }
    }
    Ok(Item::Initial(list.into_iter().map(|(one, _)| one).collect()))
}

fn experiments(input: &mut Text<'_>) -> Read<Item> {
    let span = keyword("experiments").parse_next(input)?;
    let count = cut_err(sum).context("how many experiments").parse_next(input)?;
    Ok(Item::Experiments { count, span })
}

/// One of these entries, where one begins.
pub(super) fn entry(input: &mut Text<'_>) -> Read<Item> {
    alt((signals, initial, experiments)).parse_next(input)
}

/// The name of a signal of which a name is a derivative, and the how manieth: `u''@2` is the second one of `u` in the
/// second experiment.
pub(super) fn derivative(name: &str) -> Option<(&str, usize)> {
    let base = name.trim_end_matches('\'');
    let order = name.len() - base.len();
    let signal = base.split('@').next().unwrap_or(base);
    (order > 0).then_some((signal, order))
}

/// The highest derivatives that a file mentions, by the names of what is derived; and those that known signals are led to.
#[derive(Default)]
pub(super) struct Derivatives {
    mentioned: HashMap<String, usize>,
    driven: Driven,
}

impl Derivatives {
    /// Of all entries of a file.
    pub fn of(items: &[Item]) -> Derivatives {
        let mut found = Derivatives { driven: Driven::of(items), ..Derivatives::default() };
        items.iter().for_each(|item| found.item(item));
        found
    }

    /// The highest one of a signal that is mentioned.
    pub fn highest(&self, signal: &str) -> usize {
        self.mentioned.get(signal).copied().unwrap_or(0)
    }

    /// The highest one of a known signal that is mentioned, or that a Lie derivative along the drift comes to.
    pub fn reached(&self, signal: &str) -> usize {
        self.highest(signal).max(self.driven.highest(signal))
    }

    fn name(&mut self, name: &str) {
        if let Some((signal, order)) = derivative(name) {
            let highest = self.mentioned.entry(signal.to_owned()).or_default();
            *highest = order.max(*highest);
        }
    }

    fn item(&mut self, item: &Item) {
        match item {
            Item::Let { value, .. } => self.expression(value),
            // what moves is no mention: (w')' = e is written w'' = e
            Item::Field { components, .. } => components.iter().for_each(|(_, expr)| self.expression(expr)),
            Item::Output(list) | Item::Zero(list) => list.iter().for_each(|one| self.expression(&one.value)),
            Item::Sample { ranges, avoid } => {
                ranges.iter().for_each(|(name, ..)| self.name(&name.text));
                avoid.iter().for_each(|expr| self.expression(expr));
            }
            Item::Claim(claim) => claim.body.statements().into_iter().for_each(|one| self.statement(one)),
            Item::View(view) => self.view(view),
            _ => {}
        }
    }

    fn view(&mut self, view: &View) {
        view.equations().into_iter().for_each(|equation| self.equation(equation));
        match view {
            View::Map { axes, at, of, .. } => {
                of.iter().for_each(|name| self.name(&name.text));
                axes.iter().for_each(|axis| self.name(&axis.name.text));
                at.iter().for_each(|(name, _)| self.name(&name.text));
            }
            View::Line { moving, from, of, .. } => {
                of.iter().for_each(|name| self.name(&name.text));
                self.name(&moving.text);
                from.iter().flatten().for_each(|(name, _)| self.name(&name.text));
            }
            _ => {}
        }
    }

    fn statement(&mut self, statement: &Statement) {
        statement.relations().chain(&statement.conditions).for_each(|equation| self.equation(equation));
    }

    fn equation(&mut self, equation: &Equation) {
        for side in [Some(&equation.left), Some(&equation.right), equation.within.as_ref()] {
            side.into_iter().for_each(|side| self.expression(side));
        }
    }

    fn expression(&mut self, expr: &Expr) {
        match &expr.kind {
            ExprKind::Indexed(_) => {}
            ExprKind::Name(name) => self.name(name),
            ExprKind::Call(function, arguments) => {
                // fields that drive signals have the names of derivatives, and are none
                let fields = match function.as_str() {
                    "L" => arguments.len().saturating_sub(1),
                    "bracket" => arguments.len().min(2),
                    _ => 0,
                };
                arguments[fields..].iter().for_each(|argument| self.expression(argument));
            }
            ExprKind::RealPower(base, exponent) => {
                [base, exponent].into_iter().for_each(|part| self.expression(part));
            }
            ExprKind::Sum(parts) | ExprKind::Product(parts) => {
                parts.iter().for_each(|(_, part)| self.expression(part));
            }
            ExprKind::Power(base, _) => self.expression(base),
            ExprKind::Matrix(rows) => rows.iter().flatten().for_each(|entry| self.expression(entry)),
            ExprKind::At(inner, list) => {
                self.expression(inner);
                for (name, value) in list {
                    self.name(&name.text);
                    self.expression(value);
                }
            }
            ExprKind::Number(_) => {}
        }
    }
}

/// A span that is nowhere in particular, for equations that no text holds.
pub(super) const NOWHERE: Span = 0..0;
