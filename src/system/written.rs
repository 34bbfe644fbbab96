//! Formulas as they are written in a file: for messages, reports, and readers with a pocket calculator.
//!
//! What is shown is cut from the text by the span of what was read, without comments and line breaks, and means the same
//! when it is read again. Names of definitions and fields are kept apart from the rest, so that a file that imports the
//! formula can show it under the names that it has there.

use crate::expression::parse::ends_a_line;
use crate::expression::syntax::{Equation, Expr, ExprKind, Span};

/// A part of a formula.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Piece {
    /// Signs, numbers, symbols, functions.
    Plain(String),
    /// The name of a definition.
    Definition(String),
    /// The name of a field, in `L(f, e)`.
    Field(String),
}

/// A formula as it is written.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Written {
    pieces: Vec<Piece>,
}

/// A name that stands for something longer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Mention {
    Definition(String),
    Field(String),
}

/// A name in the text of a file that stands for something else, and where it stands.
pub(crate) type Place = (Span, Mention);

impl Written {
    /// The text of a span of a file; `places` are the names in it that stand for something else.
    pub fn new(source: &str, span: &Span, mut places: Vec<Place>) -> Written {
        places.sort_by_key(|(span, _)| span.start);
        let mut written = Written::default();
        let (mut begin, mut is_blank) = (span.start, false);
        let mut plain = |written: &mut Written, part: &str| {
            let mut text = String::new();
            let mut comment = false;
            for c in part.chars() {
                comment = (comment || c == '#') && !ends_a_line(c);
                if comment || c.is_whitespace() || ends_a_line(c) {
                    is_blank = true;
                } else {
                    if std::mem::take(&mut is_blank) && !(text.is_empty() && written.pieces.is_empty()) {
                        text.push(' ');
                    }
                    text.push(c);
                }
            }
            if std::mem::take(&mut is_blank) && !(text.is_empty() && written.pieces.is_empty()) {
                text.push(' ');
            }
            if !text.is_empty() {
                written.pieces.push(Piece::Plain(text));
            }
        };
        for (place, mention) in places {
            plain(&mut written, source.get(begin..place.start).unwrap_or_default());
            begin = place.end;
            written.pieces.push(match mention {
                Mention::Definition(name) => Piece::Definition(name),
                Mention::Field(name) => Piece::Field(name),
            });
        }
        plain(&mut written, source.get(begin..span.end).unwrap_or_default());
        if let Some(Piece::Plain(last)) = written.pieces.last_mut() {
            last.truncate(last.trim_end().len());
        }
        written
    }

    /// The formula in one line.
    pub fn text(&self) -> String {
        let piece = |piece: &Piece| match piece {
            Piece::Plain(text) | Piece::Definition(text) | Piece::Field(text) => text.clone(),
        };
        self.pieces.iter().map(piece).collect()
    }

    /// The same in a file that imports this one under another name.
    pub fn under(&self, alias: &str) -> Written {
        let piece = |piece: &Piece| match piece {
            Piece::Plain(text) => Piece::Plain(text.clone()),
            Piece::Definition(name) => Piece::Definition(format!("{alias}.{name}")),
            Piece::Field(name) => Piece::Field(format!("{alias}.{name}")),
        };
        Written { pieces: self.pieces.iter().map(piece).collect() }
    }

    /// The same with more text behind it.
    pub fn followed_by(mut self, text: &str) -> Written {
        let blank = if self.pieces.is_empty() { "" } else { "  " };
        self.pieces.push(Piece::Plain(format!("{blank}{text}")));
        self
    }

    /// The names in it that stand for something else, in order.
    pub fn mentions(&self) -> impl Iterator<Item = Mention> {
        self.pieces.iter().filter_map(|piece| match piece {
            Piece::Plain(_) => None,
            Piece::Definition(name) => Some(Mention::Definition(name.clone())),
            Piece::Field(name) => Some(Mention::Field(name.clone())),
        })
    }
}

/// A text without comments and line breaks.
pub(crate) fn in_one_line(source: &str, span: &Span) -> String {
    Written::new(source, span, Vec::new()).text()
}

/// The names in an expression that stand for something else, with their places; `is_definition` tells definitions from
/// symbols.
pub(crate) fn places_in(
    source: &str,
    expr: &Expr,
    is_definition: &dyn Fn(&str) -> bool,
    found: &mut Vec<Place>,
) {
    let mut inner = |expr: &Expr| places_in(source, expr, is_definition, found);
    match &expr.kind {
        ExprKind::Number(_) => {}
        ExprKind::Name(name) => {
            if is_definition(name) {
                found.push((name_within(source, expr, name), Mention::Definition(name.clone())));
            }
        }
        ExprKind::Call(function, arguments) => {
            let fields = if function == "L" { arguments.len().saturating_sub(1) } else { 0 };
            arguments[fields..].iter().for_each(&mut inner);
            for argument in &arguments[..fields] {
                if let ExprKind::Name(name) = &argument.kind {
                    found.push((name_within(source, argument, name), Mention::Field(name.clone())));
                }
            }
        }
        ExprKind::Sum(parts) | ExprKind::Product(parts) => parts.iter().for_each(|(_, part)| inner(part)),
        ExprKind::Power(base, _) => inner(base),
        ExprKind::Matrix(rows) => rows.iter().flatten().for_each(inner),
        ExprKind::At(value, list) => {
            inner(value);
            list.iter().for_each(|(_, value)| inner(value));
        }
    }
}

/// The same for an equation.
pub(crate) fn places_in_equation(
    source: &str,
    equation: &Equation,
    is_definition: &dyn Fn(&str) -> bool,
    found: &mut Vec<Place>,
) {
    for side in [Some(&equation.left), Some(&equation.right), equation.within.as_ref()].into_iter().flatten()
    {
        places_in(source, side, is_definition, found);
    }
}

/// Where a name stands in an expression that is nothing but it, perhaps with brackets and signs around.
fn name_within(source: &str, expr: &Expr, name: &str) -> Span {
    let text = source.get(expr.span.clone()).unwrap_or_default();
    let mut comment = false;
    for (place, c) in text.char_indices() {
        comment = (comment || c == '#') && !ends_a_line(c);
        if !comment && text[place..].starts_with(name) {
            let start = expr.span.start + place;
            return start..start + name.len();
        }
    }
    expr.span.clone()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_and_line_breaks_are_left_out_and_names_are_kept_apart() {
        let source = "x = ( - v # the rate, v\n  + L(f, w)*\u{2028} 2 ) # all";
        let expr = crate::expression::parse_expression(&source[4..]).unwrap();
        assert_eq!(in_one_line(&source[4..], &expr.span), "( - v + L(f, w)* 2 )");
        let mut places = Vec::new();
        places_in(&source[4..], &expr, &|name| name == "v" || name == "w", &mut places);
        let written = Written::new(&source[4..], &expr.span, places);
        assert_eq!(written.text(), "( - v + L(f, w)* 2 )");
        assert_eq!(written.under("a").text(), "( - a.v + L(a.f, a.w)* 2 )");
        assert_eq!(written.under("a").under("b").mentions().count(), 3);
    }
}
