//! What stands in a proof file, before its names mean anything.

use super::dimension::{Declared, DeclaredDimension};
use super::model::Role;
use super::signals::{DeclaredInitial, DeclaredSignal, Knowledge};
use super::standing::{Basis, Flaw, Reference};
use super::views::View;
use palmistry_math::expression::syntax::{Equation, Expr, ExprKind, Name, Span};

/// One entry of a file.
#[derive(Clone, Debug)]
pub(crate) enum Item {
    System {
        title: String,
        cite: Option<String>,
        span: Span,
    },
    Use {
        alias: Name,
        path: String,
        span: Span,
    },
    State(Vec<Declared>),
    Param(Vec<Declared>),
    Angle(Vec<Name>),
    /// Inequalities under which every claim of the file is made.
    Assume(Vec<Equation>),
    /// How names look in a formula, in LaTeX, and where that stands.
    Looks(Vec<(Name, String, Span)>),
    Let {
        name: Name,
        dimension: Option<DeclaredDimension>,
        value: Expr,
    },
    Field {
        role: Role,
        name: Name,
        components: Vec<(Name, Expr)>,
        others_are_zero: bool,
        /// Whether it takes states to their successors, `x+ = e`, and is no field.
        is_map: bool,
    },
    Output(Vec<OutputSyntax>),
    /// Outputs that are zero: `output 0 = y`.
    Zero(Vec<OutputSyntax>),
    /// Signals that somebody knows, or nobody.
    Signals {
        knowledge: Knowledge,
        list: Vec<DeclaredSignal>,
    },
    /// What has a known initial condition.
    Initial(Vec<DeclaredInitial>),
    /// How often the system was looked at.
    Experiments {
        count: Expr,
        span: Span,
    },
    Sample {
        ranges: Vec<(Name, Expr, Expr)>,
        avoid: Vec<Expr>,
    },
    Claim(Box<ClaimSyntax>),
    View(Box<View>),
}

/// An output as it stands in the file.
#[derive(Clone, Debug)]
pub(crate) struct OutputSyntax {
    pub value: Expr,
    pub dimension: Option<DeclaredDimension>,
    /// Whether the text stands for several outputs, so that it is no name of this one.
    pub is_repeated: bool,
}

/// Equations or other relations, and the conditions under which they are claimed.
#[derive(Clone, Debug)]
pub struct Statement {
    /// What is said: one equation, or one relation, or those that a chain `a < b < c` stands for.
    pub equation: Equation,
    /// The others of a chain.
    pub further: Vec<Equation>,
    /// `carrying 10 digits`: the right side is a number in print, from a system that carries so many.
    pub carried: Option<usize>,
    /// Whether it is claimed `on sample`, that is for states in the sample box.
    pub on_sample: bool,
    /// `where a = b, c > d, ...`
    pub conditions: Vec<Equation>,
    /// `except where a = b, c = d or e = f`: of a rank at all states, the sets that are left out, each by its equations; none
    /// of them where it says `everywhere`, and nothing where the rank is that at almost all states.
    pub except: Option<Vec<Vec<Equation>>>,
    /// The whole, in the text.
    pub span: Span,
}

/// The verdict that a file says it expects where that is not *proved*.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)] // names and messages say it
pub enum Expectation {
    Proved,
    Refuted,
    Undecided,
}

/// What a claim says.
#[derive(Clone, Debug)]
#[allow(missing_docs)] // names and messages say it
pub enum ClaimBody {
    /// A statement with the verdict that is expected of it.
    Claim { statement: Box<Statement>, expected: Expectation },
    /// A form in the text that is to be refuted, and the right one that is to be proved; whose doing the difference is, and
    /// the words of the text where they are quoted.
    Erratum { fault: Flaw, quoted: Option<String>, printed: Box<Statement>, corrected: Box<Statement> },
    /// A form in the text that is no statement, in words, and the right one that is to be proved.
    Scan { fault: Flaw, scanned: String, repaired: Box<Statement> },
    /// Something that is defined and not claimed.
    Definition { text: String },
    /// Something that is not decided, and why.
    Open { reason: String },
}

impl Statement {
    /// All that is said, one relation after the other.
    pub fn relations(&self) -> impl Iterator<Item = &Equation> {
        std::iter::once(&self.equation).chain(&self.further)
    }

    /// The same, and all that stands behind `where` and `except where`.
    pub fn all_equations(&self) -> impl Iterator<Item = &Equation> {
        self.relations().chain(&self.conditions).chain(self.except.iter().flatten().flatten())
    }
}

impl ClaimBody {
    /// The statements that it makes.
    pub fn statements(&self) -> Vec<&Statement> {
        match self {
            ClaimBody::Claim { statement, .. } | ClaimBody::Scan { repaired: statement, .. } => {
                vec![statement]
            }
            ClaimBody::Erratum { printed, corrected, .. } => vec![printed, corrected],
            ClaimBody::Definition { .. } | ClaimBody::Open { .. } => Vec::new(),
        }
    }

    /// The expression whose pole a statement is about, of `pole(e, x) = n`.
    pub fn pole_of(&self) -> Option<&Expr> {
        self.statements().into_iter().flat_map(|s| [&s.equation.left, &s.equation.right]).find_map(|side| {
            match &side.kind {
                ExprKind::Call(name, arguments) if name == "pole" => arguments.first(),
                _ => None,
            }
        })
    }

    /// Whether a statement is about `rank`, the rank of the observability codistribution, or about what it spans.
    pub fn is_about_the_codistribution(&self) -> bool {
        let is_rank = |side: &Expr| matches!(&side.kind, ExprKind::Name(name) if name == "rank");
        self.statements()
            .iter()
            .any(|s| is_rank(&s.equation.left) || is_rank(&s.equation.right) || s.is_about_observability())
    }
}

/// A claim or an erratum as it stands in the file.
#[derive(Clone, Debug)]
pub struct ClaimSyntax {
    /// Its number or name: `4.48`, `rank.generic`.
    pub id: String,
    /// Where its id stands.
    pub span: Span,
    /// What it says.
    pub body: ClaimBody,
    /// On what it rests; of a claim.
    pub basis: Basis,
    /// The fault of which this one is a consequence.
    pub follows: Option<Reference>,
    /// Where in the text the fault stands: its section and page.
    pub passage: Option<String>,
    /// A remark in quotation marks behind it.
    pub remark: Option<String>,
    /// Of a fault, whether a conclusion of the text changes.
    pub conclusion: Option<String>,
}
