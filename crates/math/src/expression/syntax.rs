//! The syntax of an expression, before its names have a meaning. Every part knows where in the text it
//! stands, so that an error can point there.

use dashu::rational::RBig;
use std::cmp::Ordering;
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

impl Expr {
    /// Whether it is a number as it is written, perhaps with a sign.
    pub fn is_literal(&self) -> bool {
        match &self.kind {
            ExprKind::Number(_) => true,
            ExprKind::Sum(terms) => matches!(&terms[..], [(_, Expr { kind: ExprKind::Number(_), .. })]),
            _ => false,
        }
    }
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
    /// A power whose exponent is not written as an integer.
    RealPower(Box<Expr>, Box<Expr>),
    /// Rows of blocks: `[a, b; c, d]`
    Matrix(Vec<Vec<Expr>>),
    /// `e at {name = value, ...}`
    At(Box<Expr>, Vec<(Name, Expr)>),
    /// What stands for others once its indices have values. It is put in their place where the last of them gets one, so
    /// that in what was read it is met only where an index has none, or where a range stands by itself.
    Indexed(Box<Indexed>),
}

/// The forms of an expression with indices.
#[derive(Clone, Debug, PartialEq)]
pub enum Indexed {
    /// `x[2*i - 1]`, or `x[1..3]`, which is three entries of a list; and what stands behind it, as in `x[1]'` and `x[1]@2`
    Component { vector: String, place: Place, suffix: String },
    /// `sum(i in 1..20, e)`, or `product(...)`
    Fold { is_product: bool, over: Loop, body: Expr },
}

/// Which components of a vector are meant.
#[derive(Clone, Debug, PartialEq)]
pub enum Place {
    One(Whole),
    Range(Whole, Whole),
}

/// A whole number that is made of indices: `2*i - 1`.
#[derive(Clone, Debug, PartialEq)]
pub struct Whole {
    pub constant: i64,
    /// How often each index is taken; none that falls out.
    pub terms: Vec<(String, i64)>,
    pub span: Span,
}

/// `i in 2..20`
#[derive(Clone, Debug, PartialEq)]
pub struct Loop {
    pub index: Name,
    pub from: Whole,
    pub to: Whole,
}

/// How one side is claimed to compare with the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Relation {
    Equal,
    NotEqual,
    Less,
    AtMost,
    Greater,
    AtLeast,
}

impl Relation {
    /// Its sign.
    pub fn sign(self) -> &'static str {
        match self {
            Relation::Equal => "=",
            Relation::NotEqual => "!=",
            Relation::Less => "<",
            Relation::AtMost => "<=",
            Relation::Greater => ">",
            Relation::AtLeast => ">=",
        }
    }

    /// Whether it says which side is the greater one.
    pub fn is_ordering(self) -> bool {
        !matches!(self, Relation::Equal | Relation::NotEqual)
    }

    /// The relation of the right side to the left one.
    pub fn turned(self) -> Relation {
        match self {
            Relation::Less => Relation::Greater,
            Relation::AtMost => Relation::AtLeast,
            Relation::Greater => Relation::Less,
            Relation::AtLeast => Relation::AtMost,
            same => same,
        }
    }

    /// Whether it holds of sides that compare so.
    pub fn holds(self, order: Ordering) -> bool {
        match self {
            Relation::Equal => order.is_eq(),
            Relation::NotEqual => order.is_ne(),
            Relation::Less => order.is_lt(),
            Relation::AtMost => order.is_le(),
            Relation::Greater => order.is_gt(),
            Relation::AtLeast => order.is_ge(),
        }
    }

    /// Whether it puts the left side below the right one.
    pub fn points_up(self) -> bool {
        matches!(self, Relation::Less | Relation::AtMost)
    }
}

/// `left = right`, or another relation; and how near they have to be where equality is not meant exactly.
#[derive(Clone, Debug, PartialEq)]
pub struct Equation {
    pub left: Expr,
    pub relation: Relation,
    pub right: Expr,
    /// `within tolerance`
    pub within: Option<Expr>,
    /// All of it; of a chain `a < b < c`, the whole chain.
    pub span: Span,
}
