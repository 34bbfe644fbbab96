//! What an expression looks like before anybody knows what its names mean. Every part knows where in the text it
//! stands, so that an error can point there.

use dashu::rational::RBig;
use std::ops::Range;

/// Where in the text: from byte to byte.
pub type Span = Range<usize>;

/// A name and where it stands.
#[derive(Clone, Debug, PartialEq)]
pub struct Name {
    pub text: String,
    pub span: Span,
}

/// An expression and where it stands.
#[derive(Clone, Debug, PartialEq)]
pub struct Expr {
    pub kind: ExprKind,
    pub span: Span,
}

/// The forms of an expression.
///
/// Sums and products are flat lists, however long: the depth of the tree is the depth of the brackets, and that is
/// bounded when it is read.
#[derive(Clone, Debug, PartialEq)]
pub enum ExprKind {
    Number(RBig),
    Name(String),
    /// `f(a, b, ...)`
    Call(String, Vec<Expr>),
    /// Terms; `true` where a term is subtracted.
    Sum(Vec<(bool, Expr)>),
    /// Factors; `true` where a factor divides.
    Product(Vec<(bool, Expr)>),
    Power(Box<Expr>, i32),
    /// Rows of blocks: `[a, b; c, d]`
    Matrix(Vec<Vec<Expr>>),
    /// `e at {name = value, ...}`
    At(Box<Expr>, Vec<(Name, Expr)>),
}

/// `left = right`, and how near they have to be where that is not meant exactly.
#[derive(Clone, Debug, PartialEq)]
pub struct Equation {
    pub left: Expr,
    pub right: Expr,
    /// `within tolerance`
    pub within: Option<Expr>,
}
