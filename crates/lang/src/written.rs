//! Formulas as they are written in a file: for messages, reports, and readers with a pocket calculator.
//!
//! What is shown is cut from the text by the span of what was read, without comments and line breaks, and means the same
//! when it is read again. Names of definitions and fields are kept apart from the rest, so that a file that imports the
//! formula can show it under the names that it has there.

use palmistry_math::expression::parse::ends_a_line;
use palmistry_math::expression::syntax::{Equation, Expr, ExprKind, Span};

/// A part of a formula.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Piece {
    /// Signs, numbers, symbols, functions.
    Plain(String),
    /// The name of a definition, and how it is written: a component may be so by an index.
    Definition { name: String, written: String },
    /// The name of a field, in `L(f, e)`.
    Field(String),
    /// Behind the argument of `d(e)`: the states of its file, which another file has to name.
    States(Vec<String>),
}

/// A formula as it is written.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Written {
    pieces: Vec<Piece>,
}

/// A name that stands for something longer.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Mention {
    Definition(String),
    Field(String),
}

/// What is put in the place of a part of the text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Insert {
    Mention(Mention),
    /// Nothing in its own file, `, x, y` in one that imports it.
    States(Vec<String>),
}

/// What the names of a text mean: what is needed of a system.
pub(crate) struct Scope<'a> {
    pub source: &'a str,
    pub is_definition: &'a dyn Fn(&str) -> bool,
    pub states: &'a dyn Fn() -> Vec<String>,
}

/// A name in the text of a file that stands for something else, and where it stands.
pub(crate) type Place = (Span, Insert);

impl Written {
    /// The text of a span of a file; `places` are the names in it that stand for something else.
    pub fn new(source: &str, span: &Span, mut places: Vec<Place>) -> Written {
        places.sort_by_key(|(span, _)| (span.start, span.end));
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
            // a text that is repeated for values of an index stands there once
            if place.start < begin {
                continue;
            }
            plain(&mut written, source.get(begin..place.start).unwrap_or_default());
            begin = place.end;
            written.pieces.push(match mention {
                Insert::Mention(Mention::Definition(name)) => {
                    let written = source.get(place).unwrap_or_default().to_owned();
                    Piece::Definition { name, written }
                }
                Insert::Mention(Mention::Field(name)) => Piece::Field(name),
                Insert::States(names) => Piece::States(names),
            });
        }
        plain(&mut written, source.get(begin..span.end).unwrap_or_default());
        if let Some(Piece::Plain(last)) = written.pieces.last_mut() {
            last.truncate(last.trim_end().len());
        }
        written
    }

    /// A text that holds no names that stand for something longer.
    pub fn plain(text: String) -> Written {
        Written { pieces: vec![Piece::Plain(text)] }
    }

    /// The formula in one line.
    pub fn text(&self) -> String {
        let mut text = String::new();
        for piece in &self.pieces {
            match piece {
                Piece::Plain(part) | Piece::Definition { written: part, .. } | Piece::Field(part) => {
                    text.push_str(part);
                }
                Piece::States(_) => {}
            }
        }
        text
    }

    /// The same in a file that imports this one under another name.
    pub fn under(&self, alias: &str) -> Written {
        let piece = |piece: &Piece| match piece {
            Piece::Plain(text) => Piece::Plain(text.clone()),
            Piece::Definition { name, written } => {
                Piece::Definition { name: format!("{alias}.{name}"), written: format!("{alias}.{written}") }
            }
            Piece::Field(name) => Piece::Field(format!("{alias}.{name}")),
            // the states of a file are symbols, and those have one name everywhere
            Piece::States(names) => Piece::Plain(names.iter().map(|name| format!(", {name}")).collect()),
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
            Piece::Plain(_) | Piece::States(_) => None,
            Piece::Definition { name, .. } => Some(Mention::Definition(name.clone())),
            Piece::Field(name) => Some(Mention::Field(name.clone())),
        })
    }
}

/// A text without comments and line breaks.
pub fn in_one_line(source: &str, span: &Span) -> String {
    Written::new(source, span, Vec::new()).text()
}

/// The names in an expression that stand for something else, with their places.
pub(crate) fn places_in(scope: &Scope<'_>, expr: &Expr, found: &mut Vec<Place>) {
    let mut inner = |expr: &Expr| places_in(scope, expr, found);
    match &expr.kind {
        ExprKind::Number(_) | ExprKind::Indexed(_) => {}
        ExprKind::Name(name) => {
            if (scope.is_definition)(name) {
                let mention = Insert::Mention(Mention::Definition(name.clone()));
                found.push((name_within(scope.source, expr, name), mention));
            }
        }
        ExprKind::Call(function, arguments) => {
            let fields = match function.as_str() {
                "L" => arguments.len().saturating_sub(1),
                "bracket" => arguments.len().min(2),
                _ => 0,
            };
            arguments[fields..].iter().for_each(&mut inner);
            for argument in &arguments[..fields] {
                field_places_in(scope, argument, found);
            }
            if let ("d", [argument]) | ("bracket", [_, argument]) = (function.as_str(), arguments.as_slice())
            {
                let end = argument.span.end;
                found.push((end..end, Insert::States((scope.states)())));
            }
        }
        ExprKind::Sum(parts) | ExprKind::Product(parts) => parts.iter().for_each(|(_, part)| inner(part)),
        ExprKind::Power(base, _) => inner(base),
        ExprKind::RealPower(base, exponent) => [base, exponent].into_iter().for_each(|part| inner(part)),
        ExprKind::Matrix(rows) => rows.iter().flatten().for_each(inner),
        ExprKind::At(value, list) => {
            inner(value);
            list.iter().for_each(|(_, value)| inner(value));
        }
    }
}

/// The same where an expression stands for a field: it is a name, or the bracket of two.
fn field_places_in(scope: &Scope<'_>, field: &Expr, found: &mut Vec<Place>) {
    match &field.kind {
        ExprKind::Name(name) => {
            let mention = Insert::Mention(Mention::Field(name.clone()));
            found.push((name_within(scope.source, field, name), mention));
        }
        ExprKind::Call(_, fields) => fields.iter().for_each(|field| field_places_in(scope, field, found)),
        _ => {}
    }
}

/// The same for an equation.
pub(crate) fn places_in_equation(scope: &Scope<'_>, equation: &Equation, found: &mut Vec<Place>) {
    for side in [Some(&equation.left), Some(&equation.right), equation.within.as_ref()].into_iter().flatten()
    {
        places_in(scope, side, found);
    }
}

/// Where a name stands in an expression that is nothing but it, perhaps with brackets and signs around. Of a component the
/// index may be written in another way.
fn name_within(source: &str, expr: &Expr, name: &str) -> Span {
    let text = source.get(expr.span.clone()).unwrap_or_default();
    let vector = name.split('[').next().unwrap_or_default();
    let mut comment = false;
    for (place, c) in text.char_indices() {
        comment = (comment || c == '#') && !ends_a_line(c);
        if !comment && text[place..].starts_with(vector) {
            let start = expr.span.start + place;
            let index = match name.len() > vector.len() {
                true => text[place..].find(']').map_or(vector.len(), |end| end + 1),
                false => vector.len(),
            };
            return start..start + index;
        }
    }
    expr.span.clone()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The oracle is the text itself, rewritten by hand.
    #[test]
    fn comments_and_line_breaks_are_left_out_and_names_are_kept_apart() {
        let source = "( - v # the rate, v\n  + L(v, w)*\u{2028} d(x) ) # all";
        let expr = palmistry_math::expression::parse_expression(source).unwrap();
        assert_eq!(in_one_line(source, &expr.span), "( - v + L(v, w)* d(x) )");
        let states = || vec!["x".to_owned(), "y".to_owned()];
        let scope = Scope { source, is_definition: &|name| name == "v" || name == "w", states: &states };
        let mut places = Vec::new();
        places_in(&scope, &expr, &mut places);
        let written = Written::new(source, &expr.span, places);
        assert_eq!(written.text(), "( - v + L(v, w)* d(x) )");
        assert_eq!(written.under("a").text(), "( - a.v + L(a.v, a.w)* d(x, x, y) )");
        let mentions: Vec<Mention> = written.under("a").under("b").mentions().collect();
        let definition = |name: &str| Mention::Definition(name.to_owned());
        let along = Mention::Field("b.a.v".to_owned());
        assert_eq!(mentions, [definition("b.a.v"), along, definition("b.a.w")]);
    }
}
