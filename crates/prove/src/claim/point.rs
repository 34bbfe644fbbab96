//! The value at a point of whatever an expression can mean there: a number, a matrix of numbers, a rank.

use super::value::{PointValue, ValueError, certified_value, computed_value, exists_at};
use dashu::rational::RBig;
use palmistry_lang::{ReadError, System, Value};
use palmistry_math::expression::{Input, NodeId, Program, Symbol};
use palmistry_math::number::Rationals;
use palmistry_rank::observability::rank;
use palmistry_rank::sweep::Certainty;
use std::collections::HashMap;

/// What an expression is at a point.
#[derive(Clone, Debug, PartialEq)]
pub enum ValueAtPoint {
    /// A number.
    Number(PointValue),
    /// A matrix, by rows.
    Matrix {
        /// How many columns it has.
        columns: usize,
        /// Its entries, row by row.
        entries: Vec<PointValue>,
    },
    /// The rank of a matrix at this very point, by elimination in rational numbers.
    Rank(usize),
}

/// Why there is none.
#[derive(Clone, Debug, thiserror::Error)]
pub enum EvaluationError {
    /// The expression cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// It has no value here, or none that can be determined.
    #[error(transparent)]
    Value(#[from] ValueError),
    /// An expression of a kind that has no value at a point; the kind, as text.
    #[error("{0} has no value at a point")]
    NoValue(String),
    /// The entries of a matrix are not rational here, and a rank is decided in rational numbers.
    #[error("{0}")]
    NotRational(String),
}

/// The value of an expression of the language at a point, angles in radians, to `digits` significant decimal digits. What `at` says nothing
/// of has the value that the file gives it.
///
/// # Errors
/// What cannot be read, a point that lacks a value, is a pole or lies outside of a domain, and what has no value at a point.
pub fn evaluate(
    system: &mut System,
    expression: &str,
    at: &HashMap<Symbol, RBig>,
    digits: usize,
    wanted: Certainty,
) -> Result<ValueAtPoint, EvaluationError> {
    let (value, guards) = system.evaluate_text_guarded(expression)?;
    let defaults = system.symbols().filter_map(|(symbol, info)| Some((symbol, info.default.clone()?)));
    let mut point: HashMap<Symbol, RBig> = defaults.collect();
    point.extend(at.iter().map(|(symbol, value)| (*symbol, value.clone())));
    exists_at(&system.graph, &guards, &point)?;
    let one = |id: NodeId| match wanted {
        Certainty::Certified => certified_value(&system.graph, id, &point, digits),
        Certainty::Computed => computed_value(&system.graph, id, &point, digits),
    };
    Ok(match &value {
        Value::Scalar(id) => ValueAtPoint::Number(one(*id)?),
        Value::Matrix(matrix) => ValueAtPoint::Matrix {
            columns: matrix.columns,
            entries: matrix.entries.iter().map(|id| one(*id)).collect::<Result<_, _>>()?,
        },
        Value::Rank(matrix) => ValueAtPoint::Rank(rank_at(system, &matrix.entries, matrix.columns, &point)?),
        other => return Err(EvaluationError::NoValue(other.describe())),
    })
}

/// The rank of a matrix at a rational point, certified: by elimination in rational numbers. Entries row by row.
///
/// # Errors
/// A point that lacks a value, and entries that are not rational there.
fn rank_at(
    system: &System,
    entries: &[NodeId],
    columns: usize,
    point: &HashMap<Symbol, RBig>,
) -> Result<usize, EvaluationError> {
    let refuse = |why: String| EvaluationError::NotRational(why);
    let missing = |symbol: Symbol| ValueError::Missing(system.symbol_name(symbol).to_owned());
    let program = Program::plain(&system.graph, entries);
    let exact = Rationals::default();
    let value = |input: &Input| match input {
        Input::Plain(symbol) => point.get(symbol).cloned().ok_or_else(|| missing(*symbol).into()),
        _ => Err(refuse("an input that is no symbol".to_owned())),
    };
    let inputs: Vec<RBig> = program.inputs().iter().map(value).collect::<Result<_, EvaluationError>>()?;
    let loaded = program.load(exact).map_err(|why| refuse(why.to_string()))?;
    let values =
        loaded.run(&inputs, &mut Vec::new()).map_err(|failure| refuse(failure.refusal.to_string()))?;
    let rows = values.chunks(columns).map(<[RBig]>::to_vec).collect();
    rank(&exact, rows).map_err(|why| refuse(why.to_string()))
}
