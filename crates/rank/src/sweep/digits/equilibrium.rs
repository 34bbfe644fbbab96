//! The equilibrated matrix itself, and not what comes near to it: the limit of what [`equilibrate`] does.
//!
//! Wanted are positive `p_i`, `q_j` with `sum_j p_i a_ij^2 q_j = columns/rows` for every row and `sum_i p_i a_ij^2 q_j
//! = 1` for every column; where they exist `sqrt(p_i q_j) a_ij` is unique (R. Sinkhorn and P. Knopp 1967; M. V. Menon,
//! "Matrix links, an extremization problem, and the reduction of a non-negative matrix to one with prescribed row and
//! column sums", Canad. J. Math. 20, 1968). Newton's method finds them, and an interval Newton step after R. Krawczyk
//! proves that they lie near by (S. M. Rump, "Verification methods", Acta Numerica 19, 2010, theorem 13.3).
//!
//! The matrix must be connected: rows and columns cannot be parted so that all entries between the parts are zero.
//!
//! [`equilibrate`]: crate::observability::equilibrate

use super::numbers::{Approximate, Enclosing, dot, inverse};
use crate::sweep::stream::Equilibrium;
use dashu::rational::RBig;
use palmistry_math::number::{Arithmetic, Function, Refusal, rational_from_f64};

/// After so many steps of Newton's method there is no equilibrium near, or none at all.
const MOST_STEPS: usize = 60;
/// Below this residual Newton's method converges, and what stops it is rounding.
const NEAR: f64 = 1e-3;

type Matrix<N> = Vec<Vec<N>>;

/// `p_i` and `q_j`, approximately.
struct Squares<N> {
    rows: Vec<N>,
    columns: Vec<N>,
}

/// The equilibrated matrix approximately; `None` where it is not found.
///
/// # Errors
/// What the numbers refuse.
pub fn approximately_equilibrated<A: Approximate>(
    on: &A,
    matrix: &Matrix<A::Number>,
) -> Result<Option<Matrix<A::Number>>, Refusal> {
    let Some(squares) = find(on, matrix)? else { return Ok(None) };
    scaled(on, matrix, &squares).map(Some)
}

/// An enclosure of the equilibrated matrix; `None` where none is found.
///
/// # Errors
/// What the numbers refuse.
pub fn equilibrated<A: Enclosing>(
    on: &A,
    matrix: &Matrix<A::Number>,
) -> Result<Option<Matrix<A::Number>>, Refusal> {
    let Some(mut squares) = find(on, matrix)? else { return Ok(None) };
    let weights = weights(on, matrix, &squares)?;
    let (rows, unknowns) = (weights.len(), squares.rows.len() + squares.columns.len() - 1);
    let one = on.rational(&RBig::ONE)?;
    let near_inverse = inverse(on, &derivative(on, &weights, &one)?)?;
    // the step of Newton's method from p = q = 1, the factors that remain to be multiplied by
    let residual = residual(on, &weights)?;
    let mut step = Vec::with_capacity(unknowns);
    for row in &near_inverse {
        step.push(on.neg(&dot(on, row.iter().zip(&residual))?)?);
    }
    let nothing = |x: &A::Number| on.is_zero(x) == Some(true);
    if !step.iter().all(nothing) {
        // a box around, twice as wide; if the step leads from all of it into its inside, the zero is there
        let mut around = on.rational(&RBig::ZERO)?;
        for x in &step {
            around = on.hull(&around, &on.add(x, x)?);
        }
        around = on.hull(&around, &on.neg(&around)?);
        let slopes = derivative(on, &weights, &on.add(&one, &around)?)?;
        let Some((low, high)) = on.ends(&around) else { return Ok(None) };
        for (k, row) in near_inverse.iter().enumerate() {
            for l in 0..unknowns {
                let product = dot(on, row.iter().zip(slopes.iter().map(|slope| &slope[l])))?;
                let unit = on.rational(&RBig::from(u8::from(k == l)))?;
                let rest = on.mul(&on.sub(&unit, &product)?, &around)?;
                step[k] = on.add(&step[k], &rest)?;
            }
            match on.ends(&step[k]) {
                Some((left, right)) if low < left && right < high && high < RBig::ONE => {}
                _ => return Ok(None),
            }
        }
    }
    for (k, x) in step.iter().enumerate() {
        let square = if k < rows { &mut squares.rows[k] } else { &mut squares.columns[k - rows] };
        *square = on.mul(square, &on.add(&one, x)?)?;
    }
    scaled(on, matrix, &squares).map(Some)
}

/// Newton's method, from where doubles come to.
fn find<A: Approximate>(on: &A, matrix: &Matrix<A::Number>) -> Result<Option<Squares<A::Number>>, Refusal> {
    let (rows, columns) = (matrix.len(), matrix.first().map_or(0, Vec::len));
    let mut rough = Equilibrium::new(rows, columns, 0.0f64);
    let mut middles = Vec::with_capacity(rows);
    for (i, row) in matrix.iter().enumerate() {
        for (j, entry) in row.iter().enumerate() {
            rough.set(i, j, on.near(entry).abs());
        }
        middles.push(row.iter().map(|entry| on.middle(entry)).collect::<Result<Vec<_>, _>>()?);
    }
    rough.solve();
    let square = |factor: &f64| {
        let factor = on.rational(&rational_from_f64(*factor).ok_or(Refusal::NotFinite)?)?;
        on.middle(&on.mul(&factor, &factor)?)
    };
    let (r, c) = rough.factors();
    let mut squares = Squares {
        rows: r.iter().map(square).collect::<Result<_, _>>()?,
        columns: c.iter().map(square).collect::<Result<_, _>>()?,
    };
    let one = on.rational(&RBig::ONE)?;
    let mut least = f64::INFINITY;
    for _ in 0..MOST_STEPS {
        let weights = weights(on, &middles, &squares)?;
        let residual = residual(on, &weights)?;
        let size = residual.iter().fold(0.0f64, |most, x| most.max(on.near(x).abs()));
        if size == 0.0 || least < NEAR && size >= 0.5 * least {
            return Ok(Some(squares));
        }
        least = least.min(size);
        for (k, row) in inverse(on, &derivative(on, &weights, &one)?)?.iter().enumerate() {
            let step = on.neg(&dot(on, row.iter().zip(&residual))?)?;
            // far from the solution a step may lead out of what is positive
            let step = match on.near(&step) {
                x if x.abs() <= 0.5 => step,
                x => on.rational(&rational_from_f64(0.5 * x.signum()).ok_or(Refusal::NotFinite)?)?,
            };
            let square = if k < rows { &mut squares.rows[k] } else { &mut squares.columns[k - rows] };
            *square = on.middle(&on.mul(square, &on.add(&one, &step)?)?)?;
        }
    }
    Ok(None)
}

/// `p_i a_ij^2 q_j`
fn weights<A: Arithmetic>(
    on: &A,
    matrix: &Matrix<A::Number>,
    squares: &Squares<A::Number>,
) -> Result<Matrix<A::Number>, Refusal> {
    let weight = |a: &A::Number, p: &A::Number, q: &A::Number| on.mul(&on.power(a, 2)?, &on.mul(p, q)?);
    let row = |(row, p): (&Vec<A::Number>, &A::Number)| {
        row.iter().zip(&squares.columns).map(|(a, q)| weight(a, p, q)).collect()
    };
    matrix.iter().zip(&squares.rows).map(row).collect()
}

/// By how much the sums of rows, and of all columns but the last, which follows, differ from what they should be.
fn residual<A: Arithmetic>(on: &A, weights: &Matrix<A::Number>) -> Result<Vec<A::Number>, Refusal> {
    let (rows, columns) = (weights.len(), weights[0].len());
    let share = on.rational(&(RBig::from(columns) / RBig::from(rows)))?;
    let one = on.rational(&RBig::ONE)?;
    let mut all = Vec::with_capacity(rows + columns - 1);
    for row in weights {
        all.push(on.sub(&sum(on, row.iter())?, &share)?);
    }
    for j in 0..columns - 1 {
        all.push(on.sub(&sum(on, weights.iter().map(|row| &row[j]))?, &one)?);
    }
    Ok(all)
}

/// The derivatives of the residual by all further factors but that of the last column, each within `factor`.
fn derivative<A: Arithmetic>(
    on: &A,
    weights: &Matrix<A::Number>,
    factor: &A::Number,
) -> Result<Matrix<A::Number>, Refusal> {
    let (rows, columns) = (weights.len(), weights[0].len());
    let zero = on.rational(&RBig::ZERO)?;
    let mut matrix = vec![vec![zero; rows + columns - 1]; rows + columns - 1];
    for (i, row) in weights.iter().enumerate() {
        matrix[i][i] = on.mul(&sum(on, row.iter())?, factor)?;
        for j in 0..columns - 1 {
            matrix[i][rows + j] = on.mul(&row[j], factor)?;
            matrix[rows + j][i] = matrix[i][rows + j].clone();
        }
    }
    for j in 0..columns - 1 {
        matrix[rows + j][rows + j] = on.mul(&sum(on, weights.iter().map(|row| &row[j]))?, factor)?;
    }
    Ok(matrix)
}

fn sum<'n, A: Arithmetic>(on: &A, terms: impl Iterator<Item = &'n A::Number>) -> Result<A::Number, Refusal>
where
    A::Number: 'n,
{
    let mut sum = on.rational(&RBig::ZERO)?;
    for term in terms {
        sum = on.add(&sum, term)?;
    }
    Ok(sum)
}

/// `sqrt(p_i q_j) a_ij`
fn scaled<A: Arithmetic>(
    on: &A,
    matrix: &Matrix<A::Number>,
    squares: &Squares<A::Number>,
) -> Result<Matrix<A::Number>, Refusal> {
    let entry =
        |a: &A::Number, p: &A::Number, q: &A::Number| on.mul(a, &on.apply(Function::Sqrt, &on.mul(p, q)?)?);
    let row = |(row, p): (&Vec<A::Number>, &A::Number)| {
        row.iter().zip(&squares.columns).map(|(a, q)| entry(a, p, q)).collect()
    };
    matrix.iter().zip(&squares.rows).map(row).collect()
}
