//! Mistakes in dimensions, at their places.

use super::super::codes::Code;
use super::check::Checker;
use super::form::Form;
use super::problem::Asked;
use super::solution::Conflict;
use crate::Problem;
use palmistry_math::expression::parse::ends_a_line;
use palmistry_math::expression::syntax::Span;

/// More places than this are not named in one mistake.
const MOST_PLACES: usize = 3;

impl Checker<'_> {
    /// Takes two dimensions for one, or notes the mistake; whether they are one.
    pub(super) fn equate(&mut self, left: &Form, right: &Form, place: &Span, asked: &Asked) -> bool {
        match self.known.solution.equate(left, right, Some(place.clone())) {
            Ok(()) => true,
            Err(conflict) => {
                self.report(&conflict, place, asked);
                false
            }
        }
    }

    /// Notes a mistake.
    pub(super) fn report(&mut self, conflict: &Conflict, place: &Span, asked: &Asked) {
        let [left, right] = &conflict.sides;
        let (left_text, right_text) = (self.known.solution.text(left), self.known.solution.text(right));
        let mut help: Vec<String> = Vec::new();
        for unknown in conflict.decided.iter().take(MOST_PLACES) {
            let (of, place) = self.known.solution.origin(*unknown);
            let (of, place) = (of.to_owned(), place.cloned());
            let what = self.known.solution.resolve(&Form::unknown(*unknown), &mut Default::default());
            let what = self.known.solution.text(&what);
            help.push(match place {
                Some(place) => format!("{of} is {what} by line {}", self.line_of(&place)),
                None => format!("{of} is {what} by an imported file"),
            });
        }
        if help.is_empty() {
            help.extend(asked.advice([left, right]).map(str::to_owned));
        }
        let mut problem =
            Problem::new(Code::Dimension, place, asked.message(&left_text, &right_text), asked.label());
        if !help.is_empty() {
            problem = problem.help(help.join("; "));
        }
        self.problems.push(problem);
    }

    fn line_of(&self, place: &Span) -> usize {
        let before = self.system.source.get(..place.start).unwrap_or_default();
        before.matches('\n').count() + 1
    }

    /// Where the operator between two parts of the text stands, and what it is.
    pub(super) fn operator(&self, from: usize, to: usize, otherwise: &Span) -> (Span, String) {
        let text = self.system.source.get(from..to).unwrap_or_default();
        let mut comment = false;
        let mut found: Option<Span> = None;
        for (place, c) in text.char_indices() {
            comment = (comment || c == '#') && !ends_a_line(c);
            let goes_on = found.as_ref().is_none_or(|span| span.end == place);
            let is_part = match &found {
                _ if comment => false,
                None => "+-*/=<>!i".contains(c),
                Some(span) => match &text[span.start..=span.start] {
                    "<" | ">" | "!" => c == '=',
                    "i" => c == 'n',
                    _ => false,
                },
            };
            match &mut found {
                Some(_) if !goes_on || !is_part => break,
                Some(span) => span.end = place + c.len_utf8(),
                None if is_part => found = Some(place..place + c.len_utf8()),
                None => {}
            }
        }
        match found {
            Some(span) => (from + span.start..from + span.end, text[span].to_owned()),
            None => (otherwise.clone(), "and".to_owned()),
        }
    }
}
