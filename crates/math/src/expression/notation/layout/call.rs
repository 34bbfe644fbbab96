//! Functions of arguments, and powers.

use super::parts::{commas, round, scripts};
use super::{Binding, FormulaLayout};
use crate::expression::notation::{Fence, Formula, FormulaName, FormulaSign};
use crate::expression::syntax::{Expr, ExprKind, Relation};

/// Functions whose names stand as they are, or with another word.
const FUNCTIONS: [(&str, &str); 15] = [
    ("sin", "sin"),
    ("cos", "cos"),
    ("tan", "tan"),
    ("cot", "cot"),
    ("sec", "sec"),
    ("csc", "csc"),
    ("asin", "arcsin"),
    ("acos", "arccos"),
    ("atan", "arctan"),
    ("exp", "exp"),
    ("log", "log"),
    ("sinh", "sinh"),
    ("cosh", "cosh"),
    ("tanh", "tanh"),
    ("sign", "sgn"),
];

/// What is said of functions, and stands as it is.
const VISIBLE: [&str; 4] = ["observable", "unobservable", "identifiable", "unidentifiable"];

/// Functions of several arguments, and how they are called.
const OF_SEVERAL: [(&str, &str); 3] = [("min", "min"), ("max", "max"), ("atan2", "atan2")];

impl FormulaLayout<'_> {
    pub(super) fn power(&self, base: &Expr, exponent: i32) -> Formula {
        let above = match exponent {
            0.. => Formula::Number(exponent.to_string()),
            _ => Formula::Row(vec![
                Formula::Sign(FormulaSign::Negative),
                Formula::Number(exponent.unsigned_abs().to_string()),
            ]),
        };
        match &base.kind {
            // not of a negative exponent: that would be read as the inverse function
            ExprKind::Call(name, arguments) if is_function(base) && exponent > 1 => {
                let word = scripts(Formula::Word(function_word(name)), None, Some(above));
                let arguments = arguments.iter().map(|argument| self.expression(argument)).collect();
                Formula::Row(vec![word, round(commas(arguments))])
            }
            _ => self.raised(base, above),
        }
    }

    /// A base with an exponent above it.
    pub(super) fn raised(&self, base: &Expr, above: Formula) -> Formula {
        match self.at_least(base, Binding::Atom) {
            Formula::Scripts { base, below, above: None } => {
                Formula::Scripts { base, below, above: Some(Box::new(above)) }
            }
            base => scripts(base, None, Some(above)),
        }
    }

    /// A function of its arguments; `closed` where something follows, so that brackets have to say where they end.
    pub(super) fn call(&self, name: &str, arguments: &[Expr], closed: bool) -> (Formula, Binding) {
        let all = || commas(arguments.iter().map(|argument| self.expression(argument)).collect());
        match (name, arguments) {
            ("sqrt", [inner]) => (Formula::Root(Box::new(self.expression(inner))), Binding::Atom),
            ("abs", [inner]) => {
                (Formula::Fence(Fence::Bars, Box::new(self.expression(inner))), Binding::Atom)
            }
            ("transpose", [inner]) => {
                let above = Some(Formula::Sign(FormulaSign::Transpose));
                (scripts(self.at_least(inner, Binding::Atom), None, above), Binding::Power)
            }
            ("inverse", [inner]) => {
                let minus_one =
                    Formula::Row(vec![Formula::Sign(FormulaSign::Negative), Formula::Number("1".into())]);
                (scripts(self.at_least(inner, Binding::Atom), None, Some(minus_one)), Binding::Power)
            }
            ("dot" | "cross", [a, b]) => {
                let sign = if name == "dot" { FormulaSign::Dot } else { FormulaSign::Cross };
                let [a, b] = [a, b].map(|side| self.at_least(side, Binding::Power));
                (Formula::Row(vec![a, Formula::Sign(sign), b]), Binding::Vectors)
            }
            ("L", [fields @ .., last]) if !fields.is_empty() => self.lie(fields, last, closed),
            ("d", [inner]) => self.applied(Formula::Word("d"), inner, closed),
            ("d", [inner, by @ ..]) => {
                let partial = || Formula::Sign(FormulaSign::Partial);
                let top = Formula::Row(vec![partial(), self.at_least(inner, Binding::Atom)]);
                let by = commas(by.iter().map(|state| self.expression(state)).collect());
                let bottom = Formula::Row(vec![partial(), round(by)]);
                (Formula::Fraction(Box::new(top), Box::new(bottom)), Binding::Product)
            }
            ("det", [inner]) => self.applied(Formula::Word("det"), inner, closed),
            ("rank", [inner]) => self.applied(Formula::Word("rank"), inner, closed),
            ("observable" | "unobservable" | "identifiable" | "unidentifiable", _) => {
                let word = VISIBLE.into_iter().find(|word| *word == name).unwrap_or_default();
                (Formula::Row(vec![Formula::Word(word), round(all())]), Binding::Prefix)
            }
            ("solutions", [inner]) => {
                let word = Formula::Word("solutions");
                (Formula::Row(vec![word, round(self.expression(inner))]), Binding::Prefix)
            }
            ("pole", [inner, factor]) => {
                let zero =
                    [Formula::Sign(FormulaSign::Relation(Relation::Equal)), Formula::Number("0".into())];
                let place = Formula::Row([self.expression(factor)].into_iter().chain(zero).collect());
                let word = scripts(Formula::Word("pole"), Some(place), None);
                (Formula::Row(vec![word, round(self.expression(inner))]), Binding::Prefix)
            }
            (name, [inner]) if FUNCTIONS.iter().any(|(known, _)| *known == name) => {
                self.applied(Formula::Word(function_word(name)), inner, closed)
            }
            (name, list) => {
                let of_several = OF_SEVERAL.iter().find(|(known, _)| list.len() > 1 && *known == name);
                let word = of_several.map_or_else(|| self.name(name), |(_, word)| Formula::Word(word));
                (Formula::Row(vec![word, round(all())]), Binding::Prefix)
            }
        }
    }

    /// A function before its argument.
    fn applied(&self, function: Formula, argument: &Expr, closed: bool) -> (Formula, Binding) {
        let (inner, binding) = self.lay(argument);
        let parts = if closed || binding < Binding::Atom || matches!(inner, Formula::Number(_)) {
            vec![function, round(inner)]
        } else {
            vec![function, Formula::Sign(FormulaSign::Thin), inner]
        };
        (Formula::Row(parts), Binding::Prefix)
    }

    /// `L(f, g, h)` as the derivative along `f` of the one along `g` of `h`.
    fn lie(&self, fields: &[Expr], last: &Expr, closed: bool) -> (Formula, Binding) {
        let mut row = Vec::new();
        for field in fields {
            let letter = FormulaName::of("L").map_or(Formula::Word("L"), Formula::Name);
            row.push(scripts(letter, Some(self.expression(field)), None));
        }
        match &last.kind {
            ExprKind::Call(name, inner) if name == "L" && inner.len() > 1 => {
                match self.call(name, inner, closed).0 {
                    Formula::Row(parts) => row.extend(parts),
                    other => row.push(other),
                }
            }
            _ => match self.lay(last) {
                (inner, Binding::Atom) if !closed && !matches!(inner, Formula::Number(_)) => row.push(inner),
                (inner, _) => row.push(round(inner)),
            },
        }
        (Formula::Row(row), Binding::Prefix)
    }
}

pub(super) fn is_function(expr: &Expr) -> bool {
    matches!(&expr.kind, ExprKind::Call(name, arguments) if arguments.len() == 1 && FUNCTIONS.iter().any(|(known, _)| known == name))
}

fn function_word(name: &str) -> &'static str {
    FUNCTIONS.iter().find(|(known, _)| *known == name).map_or("", |(_, word)| word)
}
