//! What a piece of foreign text is, before anybody asks what its names mean.

use super::super::expression::Span;
use dashu::rational::RBig;

/// A piece of foreign text.
#[derive(Clone, Debug)]
pub(crate) struct Syntax {
    pub kind: SyntaxKind,
    pub span: Span,
}

/// What it is.
#[derive(Clone, Debug)]
pub(crate) enum SyntaxKind {
    Number(RBig),
    Text(String),
    Name(String),
    /// Terms, `true` where one is subtracted.
    Sum(Vec<(bool, Syntax)>),
    /// Factors, `true` where one is divided by.
    Product(Vec<(bool, Syntax)>),
    /// Factors of `.*` and `./` in MATLAB, entry by entry, `true` where one is divided by.
    Pointwise(Vec<(bool, Syntax)>),
    Power(Box<Syntax>, Box<Syntax>),
    /// `<`, `<=`, `>`, `>=`, `==` or `!=` of two.
    Compare(&'static str, Box<Syntax>, Box<Syntax>),
    Not(Box<Syntax>),
    /// Conditions of which all hold, where that is `true`, or any.
    Conditions(bool, Vec<Syntax>),
    /// A condition, the value where it holds, and the value elsewhere.
    Choice(Box<Syntax>, Box<Syntax>, Box<Syntax>),
    Call(Box<Syntax>, Vec<Syntax>),
    Member(Box<Syntax>, String),
    Index(Box<Syntax>, Vec<Syntax>),
    /// `[a, b]`, `(a, b)`
    List(Vec<Syntax>),
    /// Rows of a matrix of MATLAB or Julia.
    Rows(Vec<Vec<Syntax>>),
    /// `{a: b}`
    Pairs(Vec<(Syntax, Syntax)>),
    /// `a'`
    Prime(Box<Syntax>),
    /// `a = b`, `a ~ b`, `a => b`, by the sign between them.
    Equation(&'static str, Box<Syntax>, Box<Syntax>),
}

impl Syntax {
    /// The name that it is, if it is one.
    pub fn as_name(&self) -> Option<&str> {
        match &self.kind {
            SyntaxKind::Name(name) => Some(name),
            _ => None,
        }
    }

    /// Calls `each` for it and for every part of it.
    pub fn each(&self, each: &mut impl FnMut(&Syntax)) {
        each(self);
        match &self.kind {
            SyntaxKind::Name(_) | SyntaxKind::Number(_) | SyntaxKind::Text(_) => {}
            SyntaxKind::Sum(list) | SyntaxKind::Product(list) | SyntaxKind::Pointwise(list) => {
                list.iter().for_each(|(_, one)| one.each(each));
            }
            SyntaxKind::Power(a, b) | SyntaxKind::Compare(_, a, b) | SyntaxKind::Equation(_, a, b) => {
                a.each(each);
                b.each(each);
            }
            SyntaxKind::Choice(a, b, c) => [a, b, c].into_iter().for_each(|one| one.each(each)),
            SyntaxKind::Not(inner) | SyntaxKind::Prime(inner) | SyntaxKind::Member(inner, _) => {
                inner.each(each)
            }
            SyntaxKind::Call(callee, list) | SyntaxKind::Index(callee, list) => {
                callee.each(each);
                list.iter().for_each(|one| one.each(each));
            }
            SyntaxKind::List(list) | SyntaxKind::Conditions(_, list) => {
                list.iter().for_each(|one| one.each(each));
            }
            SyntaxKind::Rows(rows) => rows.iter().flatten().for_each(|one| one.each(each)),
            SyntaxKind::Pairs(pairs) => pairs.iter().for_each(|(a, b)| {
                a.each(each);
                b.each(each);
            }),
        }
    }

    /// Calls `each` for every name in it.
    pub fn names(&self, each: &mut impl FnMut(&str)) {
        let mut all = |list: &[Syntax]| list.iter().for_each(|one| one.names(each));
        match &self.kind {
            SyntaxKind::Name(name) => each(name),
            SyntaxKind::Number(_) | SyntaxKind::Text(_) => {}
            SyntaxKind::Sum(list) | SyntaxKind::Product(list) | SyntaxKind::Pointwise(list) => {
                list.iter().for_each(|(_, one)| one.names(each));
            }
            SyntaxKind::Power(a, b) | SyntaxKind::Compare(_, a, b) | SyntaxKind::Equation(_, a, b) => {
                a.names(each);
                b.names(each);
            }
            SyntaxKind::Choice(a, b, c) => {
                a.names(each);
                b.names(each);
                c.names(each);
            }
            SyntaxKind::Not(inner) | SyntaxKind::Prime(inner) | SyntaxKind::Member(inner, _) => {
                inner.names(each)
            }
            SyntaxKind::Call(callee, list) | SyntaxKind::Index(callee, list) => {
                callee.names(each);
                list.iter().for_each(|one| one.names(each));
            }
            SyntaxKind::List(list) | SyntaxKind::Conditions(_, list) => all(list),
            SyntaxKind::Rows(rows) => rows.iter().for_each(|row| all(row)),
            SyntaxKind::Pairs(pairs) => pairs.iter().for_each(|(a, b)| {
                a.names(each);
                b.names(each);
            }),
        }
    }

    /// The elements of a list, a vector or the rows of a matrix one after the other; itself where it is none.
    pub fn elements(&self) -> Vec<&Syntax> {
        match &self.kind {
            SyntaxKind::List(list) => list.iter().collect(),
            SyntaxKind::Rows(rows) => rows.iter().flatten().collect(),
            _ => vec![self],
        }
    }
}
