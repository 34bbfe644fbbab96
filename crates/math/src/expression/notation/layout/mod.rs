//! From syntax to what is set: brackets where they are needed, quotients as fractions, products side by side.

mod call;
mod parts;

use super::{Fence, Formula, FormulaName, FormulaSign, latex::latex};
use crate::expression::syntax::{Equation, Expr, ExprKind, Relation};
use crate::number::parse_decimal;
use call::is_function;
use parts::{joined, number, rational, round, scripts};
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

/// Upright words with a meaning: a name may not look like one.
const WORDS: [&str; 25] = [
    "sin",
    "cos",
    "tan",
    "cot",
    "sec",
    "csc",
    "arcsin",
    "arccos",
    "arctan",
    "exp",
    "log",
    "det",
    "rank",
    "pole",
    "lg",
    "ln",
    "mod",
    "sinh",
    "cosh",
    "tanh",
    "min",
    "max",
    "sgn",
    "atan2",
    "solutions",
];

/// How a name looks: as the file says, of a component what it says of the vector, else by its letters.
fn look_of(name: &str, own: &BTreeMap<String, FormulaName>) -> Option<FormulaName> {
    let base = name.split_once('[');
    own.get(name)
        .cloned()
        .or_else(|| {
            let (vector, component) = base?;
            let mut look = own.get(vector)?.clone();
            look.index.push(component.strip_suffix(']')?.to_owned());
            Some(look)
        })
        .or_else(|| FormulaName::of(name))
}

/// Lays out the expressions of one text.
pub struct FormulaLayout<'a> {
    source: &'a str,
    /// The looks that a file gives to its names.
    own: &'a BTreeMap<String, FormulaName>,
    /// The names that are set as they are written: their looks would be those of others.
    alike: BTreeSet<String>,
}

impl<'a> FormulaLayout<'a> {
    /// A layout for expressions that were read from a text and stand in one formula.
    pub fn new<'e>(source: &'a str, expressions: impl IntoIterator<Item = &'e Expr>) -> Self {
        static NONE: BTreeMap<String, FormulaName> = BTreeMap::new();
        Self::with_looks(source, expressions, &NONE)
    }

    /// The same with looks of some names that are not what they would be by their letters.
    pub fn with_looks<'e>(
        source: &'a str,
        expressions: impl IntoIterator<Item = &'e Expr>,
        own: &'a BTreeMap<String, FormulaName>,
    ) -> Self {
        let mut names = BTreeSet::new();
        let mut derives = false;
        expressions.into_iter().for_each(|expression| collect(expression, &mut names, &mut derives));
        let mut looks: BTreeMap<String, Vec<String>> = BTreeMap::new();
        for name in names {
            if let Some(look) = look_of(&name, own) {
                looks.entry(latex(&Formula::Name(look))).or_default().push(name);
            }
        }
        let means_something = |name: &str| {
            look_of(name, own).is_some_and(|look| {
                look.from.is_empty()
                    && (WORDS.contains(&look.letters.as_str()) && name != "rank"
                        || look.letters == "L" && derives && !look.index.is_empty())
            })
        };
        let shared = |(_, names): (String, Vec<String>)| {
            let alike = names.len() > 1;
            names.into_iter().filter(move |name| alike || means_something(name)).collect::<Vec<_>>()
        };
        FormulaLayout { source, own, alike: looks.into_iter().flat_map(shared).collect() }
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
            ExprKind::RealPower(base, exponent) => {
                (self.raised(base, self.expression(exponent)), Binding::Power)
            }
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
            // what was read has none
            ExprKind::Indexed(_) => (Formula::Text("?"), Binding::Atom),
        }
    }

    fn name(&self, text: &str) -> Formula {
        match look_of(text, self.own) {
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
}

/// The names in an expression, and whether something is differentiated along a field in it.
fn collect(expr: &Expr, names: &mut BTreeSet<String>, derives: &mut bool) {
    match &expr.kind {
        ExprKind::Number(_) | ExprKind::Indexed(_) => {}
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
        ExprKind::RealPower(base, exponent) => {
            [base, exponent].into_iter().for_each(|part| collect(part, names, derives));
        }
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
