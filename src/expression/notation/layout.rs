//! From syntax to what is set: brackets where they are needed, quotients as fractions, products side by side.

use super::{Fence, Formula, FormulaName, FormulaSign, latex::latex};
use crate::expression::syntax::{Equation, Expr, ExprKind, Relation};
use crate::number::parse_decimal;
use std::collections::{BTreeMap, BTreeSet};

/// How tightly a formula holds together.
#[derive(Clone, Copy, PartialEq, PartialOrd)]
enum Binding {
    Sum,
    /// A product of vectors, which stands in brackets in every other product.
    Vectors,
    Product,
    /// A function and its argument without brackets: nothing may follow.
    Prefix,
    Power,
    Atom,
}

/// Functions whose names stand as they are, or with another word.
const FUNCTIONS: [(&str, &str); 11] = [
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
];

/// Upright words with a meaning: a name may not look like one.
const WORDS: [&str; 17] = [
    "sin", "cos", "tan", "cot", "sec", "csc", "arcsin", "arccos", "arctan", "exp", "log", "det", "rank",
    "pole", "lg", "ln", "mod",
];

/// Lays out the expressions of one text.
pub struct FormulaLayout<'a> {
    source: &'a str,
    /// The names that are set as they are written: their looks would be those of others.
    alike: BTreeSet<String>,
}

impl<'a> FormulaLayout<'a> {
    /// A layout for expressions that were read from a text and stand in one formula.
    pub fn new<'e>(source: &'a str, expressions: impl IntoIterator<Item = &'e Expr>) -> Self {
        let mut names = BTreeSet::new();
        let mut derives = false;
        expressions.into_iter().for_each(|expression| collect(expression, &mut names, &mut derives));
        let mut looks: BTreeMap<String, Vec<String>> = BTreeMap::new();
        for name in names {
            if let Some(look) = FormulaName::of(&name) {
                looks.entry(latex(&Formula::Name(look))).or_default().push(name);
            }
        }
        let means_something = |name: &str| {
            FormulaName::of(name).is_some_and(|look| {
                look.from.is_empty()
                    && (WORDS.contains(&look.letters.as_str()) && name != "rank"
                        || look.letters == "L" && derives && !look.index.is_empty())
            })
        };
        let shared = |(_, names): (String, Vec<String>)| {
            let alike = names.len() > 1;
            names.into_iter().filter(move |name| alike || means_something(name)).collect::<Vec<_>>()
        };
        FormulaLayout { source, alike: looks.into_iter().flat_map(shared).collect() }
    }

    /// An expression.
    pub fn expression(&self, expr: &Expr) -> Formula {
        self.lay(expr).0
    }

    /// Relations that stand under one another's span are one chain: `a < b < c`, or `x` in an interval.
    pub fn relations(&self, equations: &[&Equation]) -> Formula {
        let mut row = Vec::new();
        for (place, chain) in equations.chunk_by(|a, b| a.span == b.span).enumerate() {
            if place > 0 {
                row.push(Formula::Sign(FormulaSign::Comma));
            }
            self.chain(chain, &mut row);
        }
        Formula::Row(row)
    }

    fn chain(&self, chain: &[&Equation], row: &mut Vec<Formula>) {
        let mut put = |formula: Formula| match formula {
            Formula::Row(parts) => row.extend(parts),
            other => row.push(other),
        };
        if let [low, high] = chain
            && low.left.span == high.left.span
        {
            put(self.expression(&low.left));
            put(Formula::Sign(FormulaSign::In));
            let ends = [
                self.expression(&low.right),
                Formula::Sign(FormulaSign::Comma),
                self.expression(&high.right),
            ];
            return put(Formula::Fence(Fence::Square, Box::new(Formula::Row(ends.into()))));
        }
        for (place, link) in chain.iter().enumerate() {
            if place == 0 {
                put(self.expression(&link.left));
            }
            put(Formula::Sign(FormulaSign::Relation(link.relation)));
            put(self.expression(&link.right));
            if let Some(within) = &link.within {
                put(Formula::Text("within"));
                put(self.expression(within));
            }
        }
    }

    fn lay(&self, expr: &Expr) -> (Formula, Binding) {
        match &expr.kind {
            ExprKind::Number(value) => {
                let written = self.source.get(expr.span.clone()).unwrap_or_default();
                let written = written.trim_matches(|c: char| c == '(' || c == ')' || c.is_whitespace());
                let is_decimal = written.starts_with(|c: char| c.is_ascii_digit() || c == '.');
                match is_decimal && !written.contains('/') && parse_decimal(written).as_ref() == Some(value) {
                    true => number(written),
                    false => rational(value),
                }
            }
            ExprKind::Name(name) => (self.name(name), Binding::Atom),
            ExprKind::Call(name, arguments) => self.call(name, arguments, false),
            ExprKind::Sum(terms) => self.sum(terms),
            ExprKind::Product(factors) => self.product(factors),
            ExprKind::Power(base, exponent) => (self.power(base, *exponent), Binding::Power),
            ExprKind::Matrix(rows) => {
                let rows = rows.iter().map(|row| row.iter().map(|entry| self.expression(entry)).collect());
                (Formula::Matrix(rows.collect()), Binding::Atom)
            }
            ExprKind::At(value, list) => {
                let mut values = Vec::new();
                for (place, (name, value)) in list.iter().enumerate() {
                    if place > 0 {
                        values.push(Formula::Sign(FormulaSign::Comma));
                    }
                    let equal = Formula::Sign(FormulaSign::Relation(Relation::Equal));
                    values.extend([self.name(&name.text), equal, self.expression(value)]);
                }
                let inner = Formula::Row(vec![round(self.expression(value)), Formula::Sign(FormulaSign::At)]);
                (scripts(inner, Some(Formula::Row(values)), None), Binding::Power)
            }
        }
    }

    fn name(&self, text: &str) -> Formula {
        match FormulaName::of(text) {
            Some(name) if !self.alike.contains(text) => match text {
                "rank" => Formula::Word("rank"),
                _ => Formula::Name(name),
            },
            _ => Formula::Literal(text.to_owned()),
        }
    }

    /// In brackets where it does not hold together as tightly as asked for.
    fn at_least(&self, expr: &Expr, least: Binding) -> Formula {
        let (formula, binding) = self.lay(expr);
        if binding < least { round(formula) } else { formula }
    }

    fn sum(&self, terms: &[(bool, Expr)]) -> (Formula, Binding) {
        let mut row = Vec::new();
        for (place, (minus, term)) in terms.iter().enumerate() {
            let (formula, binding) = self.lay(term);
            let led_by_minus = matches!(&formula, Formula::Row(parts) if parts.first() == Some(&Formula::Sign(FormulaSign::Negative)));
            let brackets = binding == Binding::Sum && (*minus || (place > 0 && led_by_minus));
            match (place, minus) {
                (0, false) => {}
                (0, true) => row.push(Formula::Sign(FormulaSign::Negative)),
                (_, true) => row.push(Formula::Sign(FormulaSign::Minus)),
                (_, false) => row.push(Formula::Sign(FormulaSign::Plus)),
            }
            match formula {
                formula if brackets => row.push(round(formula)),
                Formula::Row(parts) => row.extend(parts),
                formula => row.push(formula),
            }
        }
        (Formula::Row(row), Binding::Sum)
    }

    /// What is multiplied up to what divides stands above the line, what divides below it, and so on from the left.
    fn product(&self, factors: &[(bool, Expr)]) -> (Formula, Binding) {
        let mut flat = Vec::new();
        flatten(factors, &mut flat);
        let mut set = Vec::new();
        let mut rest = flat.as_slice();
        while !rest.is_empty() {
            let above = rest.iter().take_while(|(divides, _)| !divides).count();
            let below = rest[above..].iter().take_while(|(divides, _)| *divides).count();
            let list =
                |part: &[(bool, &Expr)]| self.side_by_side(&part.iter().map(|f| f.1).collect::<Vec<_>>());
            if below == 0 {
                set.extend(self.factors(&rest.iter().map(|f| f.1).collect::<Vec<_>>()));
            } else {
                let (top, bottom) = (list(&rest[..above]), list(&rest[above..above + below]));
                set.push(Formula::Fraction(Box::new(top), Box::new(bottom)));
            }
            rest = &rest[above + below..];
        }
        match set.len() {
            1 => (set.remove(0), Binding::Product),
            _ => (joined(set), Binding::Product),
        }
    }

    /// Factors that are all of one side of a line: a single one needs no brackets.
    fn side_by_side(&self, factors: &[&Expr]) -> Formula {
        match factors {
            [one] => self.expression(one),
            many => joined(self.factors(many)),
        }
    }

    fn factors(&self, factors: &[&Expr]) -> Vec<Formula> {
        let one = |(place, factor): (usize, &&Expr)| {
            let next = factors.get(place + 1);
            if let ExprKind::Call(name, arguments) = &factor.kind {
                let between_functions = is_function(factor) && next.is_some_and(|next| is_function(next));
                let closed = next.is_some() && !between_functions;
                let (formula, binding) = self.call(name, arguments, closed);
                return if binding <= Binding::Vectors { round(formula) } else { formula };
            }
            self.at_least(factor, Binding::Product)
        };
        factors.iter().enumerate().map(one).collect()
    }

    fn power(&self, base: &Expr, exponent: i32) -> Formula {
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
            _ => match self.at_least(base, Binding::Atom) {
                Formula::Scripts { base, below, above: None } => {
                    Formula::Scripts { base, below, above: Some(Box::new(above)) }
                }
                base => scripts(base, None, Some(above)),
            },
        }
    }

    /// A function of its arguments; `closed` where something follows, so that brackets have to say where they end.
    fn call(&self, name: &str, arguments: &[Expr], closed: bool) -> (Formula, Binding) {
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
            ("bracket", [_, _]) => (Formula::Fence(Fence::Square, Box::new(all())), Binding::Atom),
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
            _ => (Formula::Row(vec![self.name(name), round(all())]), Binding::Prefix),
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

/// The names in an expression, and whether something is differentiated along a field in it.
fn collect(expr: &Expr, names: &mut BTreeSet<String>, derives: &mut bool) {
    match &expr.kind {
        ExprKind::Number(_) => {}
        ExprKind::Name(name) => {
            names.insert(name.clone());
        }
        ExprKind::Call(name, arguments) => {
            *derives |= name == "L";
            arguments.iter().for_each(|argument| collect(argument, names, derives));
        }
        ExprKind::Sum(parts) | ExprKind::Product(parts) => {
            parts.iter().for_each(|(_, part)| collect(part, names, derives));
        }
        ExprKind::Power(base, _) => collect(base, names, derives),
        ExprKind::Matrix(rows) => rows.iter().flatten().for_each(|entry| collect(entry, names, derives)),
        ExprKind::At(value, list) => {
            collect(value, names, derives);
            for (name, value) in list {
                names.insert(name.text.clone());
                collect(value, names, derives);
            }
        }
    }
}

/// Factors of factors are factors; what divides stays together.
fn flatten<'e>(factors: &'e [(bool, Expr)], flat: &mut Vec<(bool, &'e Expr)>) {
    for (divides, factor) in factors {
        match &factor.kind {
            ExprKind::Product(inner) if !divides => flatten(inner, flat),
            _ => flat.push((*divides, factor)),
        }
    }
}

fn is_function(expr: &Expr) -> bool {
    matches!(&expr.kind, ExprKind::Call(name, arguments) if arguments.len() == 1 && FUNCTIONS.iter().any(|(known, _)| known == name))
}

fn function_word(name: &str) -> &'static str {
    FUNCTIONS.iter().find(|(known, _)| *known == name).map_or("", |(_, word)| word)
}

fn round(inner: Formula) -> Formula {
    Formula::Fence(Fence::Round, Box::new(inner))
}

fn scripts(base: Formula, below: Option<Formula>, above: Option<Formula>) -> Formula {
    Formula::Scripts { base: Box::new(base), below: below.map(Box::new), above: above.map(Box::new) }
}

fn commas(parts: Vec<Formula>) -> Formula {
    let mut row = Vec::new();
    for part in parts {
        if !row.is_empty() {
            row.push(Formula::Sign(FormulaSign::Comma));
        }
        row.push(part);
    }
    Formula::Row(row)
}

/// Factors one after the other, with a sign or some room where they would run together.
fn joined(factors: Vec<Formula>) -> Formula {
    let mut row: Vec<Formula> = Vec::new();
    for factor in factors {
        let (first, last) = (first_of(&factor), row.last().map(last_of));
        let sign = match (last, first) {
            (None, _) => None,
            (Some(_), Formula::Number(_)) => Some(FormulaSign::Dot),
            (Some(Formula::Number(_)), Formula::Fraction(..)) => Some(FormulaSign::Dot),
            (Some(last), first) if is_wide(last) || is_wide(first) => Some(FormulaSign::Thin),
            _ => None,
        };
        row.extend(sign.map(Formula::Sign));
        match factor {
            Formula::Row(parts) => row.extend(parts),
            other => row.push(other),
        }
    }
    Formula::Row(row)
}

fn first_of(formula: &Formula) -> &Formula {
    match formula {
        Formula::Row(parts) => parts.first().map_or(formula, first_of),
        Formula::Scripts { base, .. } => first_of(base),
        other => other,
    }
}

fn last_of(formula: &Formula) -> &Formula {
    match formula {
        Formula::Row(parts) => parts.last().map_or(formula, last_of),
        other => other,
    }
}

fn is_wide(formula: &Formula) -> bool {
    match formula {
        Formula::Word(_) | Formula::Literal(_) => true,
        Formula::Name(name) => name.is_wide(),
        Formula::Scripts { base, .. } => is_wide(base),
        _ => false,
    }
}

/// A decimal as it is written, its exponent as a power of ten.
fn number(written: &str) -> (Formula, Binding) {
    let Some((digits, exponent)) = written.split_once(['e', 'E']) else {
        return (Formula::Number(written.to_owned()), Binding::Atom);
    };
    let exponent = exponent.trim_start_matches('+');
    let above = match exponent.strip_prefix('-') {
        Some(size) => {
            Formula::Row(vec![Formula::Sign(FormulaSign::Negative), Formula::Number(size.to_owned())])
        }
        None => Formula::Number(exponent.to_owned()),
    };
    let power = scripts(Formula::Number("10".to_owned()), None, Some(above));
    match digits {
        "1" => (power, Binding::Power),
        _ => {
            let row = vec![Formula::Number(digits.to_owned()), Formula::Sign(FormulaSign::Dot), power];
            (Formula::Row(row), Binding::Product)
        }
    }
}

/// A number that stands nowhere in the text.
fn rational(value: &dashu::rational::RBig) -> (Formula, Binding) {
    let (top, bottom) = (value.numerator(), value.denominator());
    let number = |text: String| Formula::Number(text);
    let size = number(top.to_string().trim_start_matches('-').to_owned());
    let formula = match bottom.to_string().as_str() {
        "1" => size,
        bottom => Formula::Fraction(Box::new(size), Box::new(number(bottom.to_owned()))),
    };
    match (top.to_string().starts_with('-'), &formula) {
        (true, _) => (Formula::Row(vec![Formula::Sign(FormulaSign::Negative), formula]), Binding::Sum),
        (false, Formula::Number(_)) => (formula, Binding::Atom),
        (false, _) => (formula, Binding::Product),
    }
}
