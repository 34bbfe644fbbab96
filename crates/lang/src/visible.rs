//! Statements about single unknowns and functions of them: `observable(x, a*b)`, `unobservable(k)`, and of constants
//! `identifiable(a*b)`, `unidentifiable(k)`. They stand by themselves, with no relation behind them.

use super::codes::Code;
use super::error::Problem;
use super::model::{System, Time, Value};
use super::syntax::Statement;
use palmistry_math::expression::parse::{Read, Text, blank, name, relation, stop, sum};
use palmistry_math::expression::syntax::{Equation, Expr, ExprKind, Relation, Span};
use palmistry_math::expression::{NodeId, Symbol};
use winnow::combinator::{cut_err, opt, peek};
use winnow::prelude::*;
use winnow::stream::Location;
use winnow::token::literal;

/// The words, whether what they are said of is seen, and whether it has to be made of constants.
pub(super) const VISIBLE: [(&str, bool, bool); 4] = [
    ("observable", true, false),
    ("unobservable", false, false),
    ("identifiable", true, true),
    ("unidentifiable", false, true),
];

impl Statement {
    /// Whether it says of functions that they are seen, or that they are not: then both sides of its equation are the whole.
    pub fn is_about_observability(&self) -> bool {
        is_visible(&self.equation.left) && self.equation.left.span == self.equation.right.span
    }
}

/// Whether an expression is one of these statements.
pub(super) fn is_visible(expr: &Expr) -> bool {
    matches!(&expr.kind, ExprKind::Call(name, _) if VISIBLE.iter().any(|(word, ..)| word == name))
}

/// A statement about what is seen, as an equation whose two sides are the whole of it.
pub(super) fn visible(input: &mut Text<'_>) -> Read<Equation> {
    let begin = |input: &mut Text<'_>| -> Read<()> {
        let word = name
            .verify(|found: &palmistry_math::expression::syntax::Name| {
                VISIBLE.iter().any(|(word, ..)| *word == found.text)
            })
            .parse_next(input)?;
        let _ = (word, blank(input)?);
        literal("(").void().parse_next(input)
    };
    peek(begin).parse_next(input)?;
    let at = input.current_token_start();
    let whole = cut_err(sum).parse_next(input)?;
    if !is_visible(&whole) {
        let help = "the states of a claim stand behind 'where', as in observable(x) where x = 0";
        let what = "'observable(...)' by itself: it is a statement, and no number";
        return stop(at, what, Some(help.to_owned()));
    }
    let at = input.current_token_start();
    if peek(opt(relation)).parse_next(input)?.is_some() {
        let help = "leave it out, as in observable(x); what is not so is unobservable(x)";
        let what = "'where' or the end: what is observable is compared with nothing";
        return stop(at, what, Some(help.to_owned()));
    }
    let span = whole.span.clone();
    Ok(Equation { left: whole.clone(), relation: Relation::Equal, right: whole, within: None, span })
}

impl System {
    /// The meaning of one of these statements: the functions that it names, the components of vectors one by one.
    pub(super) fn visible(
        &mut self,
        (word, is_observable, of_constants): (&str, bool, bool),
        arguments: &[Expr],
        span: &Span,
    ) -> Result<Value, Problem> {
        let mut functions: Vec<NodeId> = Vec::new();
        for argument in arguments {
            let found = match self.elaborate(argument)? {
                Value::Scalar(one) => vec![one],
                Value::Matrix(matrix) => matrix.entries,
                other => {
                    let message =
                        format!("'{word}' is said of unknowns and functions, not of {}", other.describe());
                    return Err(Problem::new(Code::Value, &argument.span, message, "this"));
                }
            };
            let mentioned = self.graph.symbols_of(found.iter().copied());
            if of_constants && let Some(moves) = mentioned.into_iter().find(|symbol| self.is_moved(*symbol)) {
                let moves = self.symbol_name(moves).to_owned();
                let other = if is_observable { "observable" } else { "unobservable" };
                let message = format!("'{word}' is said of constants, and '{moves}' moves");
                return Err(Problem::new(Code::Statement, &argument.span, message, "this")
                    .help(format!("write '{other}'")));
            }
            functions.extend(found);
        }
        if functions.is_empty() {
            return Err(Problem::new(
                Code::Arguments,
                span,
                format!("'{word}' takes unknowns, or functions of them"),
                "here",
            ));
        }
        Ok(Value::Visible { functions, is_observable })
    }

    /// Whether some field changes a symbol.
    fn is_moved(&mut self, symbol: Symbol) -> bool {
        let same = match self.time {
            Time::Continuous => self.graph.integer(0),
            Time::Discrete => self.graph.symbol(symbol),
        };
        self.moving_fields().into_iter().any(|field| {
            let components = &self.fields[field].components;
            components.iter().any(|(moved, rate)| *moved == symbol && *rate != same)
        })
    }
}
