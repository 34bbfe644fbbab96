//! What is combined, and what came of it.

use palmistry_lang::{FieldRole, Range};
use std::collections::BTreeMap;

/// A kind of number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Number {
    Single,
    Double,
    /// A double with a bound on its error.
    Bounded,
    DoubleDouble,
    Interval,
    Residue,
    Rational,
}

impl Number {
    /// All of them.
    pub const ALL: [Number; 7] = [
        Number::Single,
        Number::Double,
        Number::Bounded,
        Number::DoubleDouble,
        Number::Interval,
        Number::Residue,
        Number::Rational,
    ];

    /// A short name.
    pub fn name(self) -> &'static str {
        match self {
            Number::Single => "f32",
            Number::Double => "f64",
            Number::Bounded => "f64 with bounds",
            Number::DoubleDouble => "double-double",
            Number::Interval => "interval",
            Number::Residue => "residue",
            Number::Rational => "rational",
        }
    }
}

/// A way to the differentials of Lie derivatives.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Derivative {
    /// The expression graph, differentiated again and again.
    Graph,
    /// The same, as a program over blocks of states.
    Blocks,
    /// The graph of Taylor series along the fields.
    Series,
    /// num-dual's dual numbers, one within the other.
    Duals,
    /// Nested forward differences.
    Forward,
    /// Nested central differences.
    Central,
    /// The multiplied-out form, term by term.
    Expanded,
}

impl Derivative {
    /// All of them.
    pub const ALL: [Derivative; 7] = [
        Derivative::Graph,
        Derivative::Blocks,
        Derivative::Series,
        Derivative::Duals,
        Derivative::Forward,
        Derivative::Central,
        Derivative::Expanded,
    ];

    /// A short name.
    pub fn name(self) -> &'static str {
        match self {
            Derivative::Graph => "graph",
            Derivative::Blocks => "graph, blocks",
            Derivative::Series => "series",
            Derivative::Duals => "duals",
            Derivative::Forward => "forward differences",
            Derivative::Central => "central differences",
            Derivative::Expanded => "term by term",
        }
    }
}

/// A way to a rank.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum RankMethod {
    /// Of the whole matrix, unit rows and all: what most people do.
    SvdWhole,
    SvdNalgebra,
    SvdFaer,
    /// After equilibration, as `palmistry rank` does it.
    SvdEquilibrated,
    /// One-sided Jacobi over blocks of states.
    Jacobi,
    QrPivoted,
    LuFullPivoting,
    /// Elimination with complete pivoting and a threshold.
    Elimination,
    ExactElimination,
    IntervalElimination,
    /// Elimination with error bounds, over blocks of states.
    BoundedElimination,
}

impl RankMethod {
    /// All of them.
    pub const ALL: [RankMethod; 11] = [
        RankMethod::SvdWhole,
        RankMethod::SvdNalgebra,
        RankMethod::SvdFaer,
        RankMethod::SvdEquilibrated,
        RankMethod::Jacobi,
        RankMethod::QrPivoted,
        RankMethod::LuFullPivoting,
        RankMethod::Elimination,
        RankMethod::ExactElimination,
        RankMethod::IntervalElimination,
        RankMethod::BoundedElimination,
    ];

    /// A short name.
    pub fn name(self) -> &'static str {
        match self {
            RankMethod::SvdWhole => "SVD, whole matrix",
            RankMethod::SvdNalgebra => "SVD (nalgebra)",
            RankMethod::SvdFaer => "SVD (faer)",
            RankMethod::SvdEquilibrated => "SVD, equilibrated",
            RankMethod::Jacobi => "SVD, Jacobi in blocks",
            RankMethod::QrPivoted => "QR, column pivoting",
            RankMethod::LuFullPivoting => "LU, full pivoting",
            RankMethod::Elimination => "elimination",
            RankMethod::ExactElimination => "exact elimination",
            RankMethod::IntervalElimination => "interval elimination",
            RankMethod::BoundedElimination => "bounds, in blocks",
        }
    }
}

impl RankMethod {
    /// Whether it takes the whole matrix, and not what remains without unit rows.
    pub(super) fn keeps_unit_rows(self) -> bool {
        self == RankMethod::SvdWhole
    }
}

/// How many decimal digits of the entries are right: of the least accurate entry at each state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CorrectDigits {
    /// All of them: rational numbers.
    Exact,
    /// The values modulo a prime: exact, but no digits.
    Modular,
    /// At the median state and at the worst.
    Measured { median: f64, worst: f64 },
}

impl CorrectDigits {
    /// Those of the worst state; none where there are only residues.
    pub fn worst(self) -> f64 {
        match self {
            CorrectDigits::Exact => f64::INFINITY,
            CorrectDigits::Modular => 0.0,
            CorrectDigits::Measured { worst, .. } => worst,
        }
    }
}

/// A way to a derivative over one kind of number.
#[derive(Clone, Copy, Debug)]
pub struct DerivativeResult {
    pub number: Number,
    pub derivative: Derivative,
    /// Seconds a state, the least of all rounds.
    pub seconds: f64,
    pub digits: CorrectDigits,
    /// States without a value: an operation was refused, or the value is infinite or not a number.
    pub failed: u64,
}

/// A way to a rank over one kind of number.
#[derive(Clone, Copy, Debug)]
pub struct RankResult {
    pub number: Number,
    pub rank: RankMethod,
    /// Seconds a state, the least of all rounds, on the matrices of the first way to a derivative.
    pub seconds: f64,
}

/// A combination on all states.
#[derive(Clone, Copy, Debug)]
pub struct Combination {
    pub number: Number,
    pub derivative: Derivative,
    pub rank: RankMethod,
    /// Seconds a state: both parts, timed apart and added.
    pub seconds: f64,
    pub digits: CorrectDigits,
    /// Verdicts that are not the certified rank.
    pub wrong: u64,
    /// States at which it is undecided.
    pub undecided: u64,
    /// States at which there was no matrix, or its decomposition gave up.
    pub failed: u64,
    /// Right verdicts that are proofs, and not computed.
    pub certified: u64,
    /// No other is as fast, as accurate at its worst state, as often right and as often certain, and better in one of
    /// these, by more than what differs from run to run; see `beats`.
    pub on_front: bool,
}

impl Combination {
    /// States without the right verdict.
    pub fn not_right(&self) -> u64 {
        self.wrong + self.undecided + self.failed
    }
}

/// A combination that makes no sense, or is not possible here; `None` stands for all.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CombinationLeftOut {
    pub number: Number,
    pub derivative: Option<Derivative>,
    pub rank: Option<RankMethod>,
    pub reason: String,
}

/// What was measured on one system.
#[derive(Clone, Debug)]
pub struct Trade {
    pub file: String,
    pub title: String,
    /// The fields of the Lie derivatives.
    pub fields: Vec<FieldRole>,
    /// What is drawn from a range that the file does not give, and this range.
    pub by_default: Vec<(String, Range)>,
    /// Where the rows come from.
    pub rows: String,
    /// The Lie derivatives whose differentials the rows are, where they are known.
    pub lie_derivatives: Vec<String>,
    /// Rows and columns of the matrix.
    pub size: (usize, usize),
    /// How many of its entries are no constants.
    pub varying: usize,
    /// Rows and columns of what remains without unit rows: on it the rank is decided.
    pub block: (usize, usize),
    pub seed: u64,
    /// States on which everything was done.
    pub states: u64,
    /// States that were drawn and left out, because nothing is known of them for certain: poles among them.
    pub without_truth: u64,
    /// The certified ranks.
    pub certified_ranks: BTreeMap<usize, u64>,
    pub derivatives: Vec<DerivativeResult>,
    pub ranks: Vec<RankResult>,
    pub combinations: Vec<Combination>,
    pub left_out: Vec<CombinationLeftOut>,
    /// Rounds of timing, in which all take turns.
    pub rounds: usize,
    pub interrupted: bool,
    pub seconds: f64,
}
