//! Singular values of one matrix to many digits, and enclosures of them.
//!
//! One-sided Jacobi rotations `V` make the columns of `W = B V` nearly orthogonal. Let `d_j` be their exact lengths, `W =
//! Q D`, `e` the Frobenius norm of `Q^T Q - 1` and `f` that of `V^T V - 1`. By A. M. Ostrowski ("A quantitative formulation
//! of Sylvester's law of inertia", Proc. Nat. Acad. Sci. 45, 1959) the k-th singular value of `W` is the k-th largest
//! `d` times what lies between the extreme singular values of `Q`, and likewise for `B V` and `V`, so that
//!
//! `d_k sqrt((1 - e)/(1 + f)) <= sigma_k(B) <= d_k sqrt((1 + e)/(1 - f))`:
//!
//! small singular values are enclosed as narrowly as large ones.

use super::numbers::{Approximate, Enclosing, dot};
use dashu::rational::RBig;
use palmistry_math::number::{Arithmetic, Function, Refusal};

/// After so many sweeps it is given up; Jacobi's method converges quadratically.
const MOST_SWEEPS: usize = 60;
/// Below this cosine between columns it converges, and what stops it is rounding.
const NEAR: f64 = 1e-4;

type Columns<N> = Vec<Vec<N>>;

/// The singular values approximately, in no order; the matrix is given by columns.
///
/// # Errors
/// What the numbers refuse.
pub fn approximate_values<A: Approximate>(
    on: &A,
    matrix: &Columns<A::Number>,
) -> Result<Vec<A::Number>, Refusal> {
    rotated(on, matrix)?.columns.iter().map(|column| length(on, column)).collect()
}

/// Enclosures of the singular values, in no order: the k-th largest lies between the k-th largest lower end and the k-th
/// largest upper end. The matrix is given by columns. `None` where the rotations have not come near enough.
///
/// # Errors
/// What the numbers refuse.
pub fn enclosed_values<A: Enclosing>(
    on: &A,
    matrix: &Columns<A::Number>,
) -> Result<Option<Vec<A::Number>>, Refusal> {
    let rotations = rotated(on, matrix)?.rotations;
    let rows = matrix.first().map_or(0, Vec::len);
    let mut turned = Vec::with_capacity(rotations.len());
    for rotation in &rotations {
        let entry = |i: usize| dot(on, rotation.iter().zip(matrix.iter().map(|column| &column[i])));
        turned.push((0..rows).map(entry).collect::<Result<Vec<_>, _>>()?);
    }
    let lengths = turned.iter().map(|column| length(on, column)).collect::<Result<Vec<_>, _>>()?;
    let one = on.rational(&RBig::ONE)?;
    // upper bounds on e^2 and f^2
    let (mut skew, mut stretch) = (RBig::ZERO, RBig::ZERO);
    for i in 0..rotations.len() {
        for j in 0..=i {
            let product = dot(on, rotations[i].iter().zip(&rotations[j]))?;
            if i == j {
                stretch += largest_square(on, &on.sub(&product, &one)?)?;
                continue;
            }
            stretch += RBig::from(2) * largest_square(on, &product)?;
            let cosine =
                on.div(&dot(on, turned[i].iter().zip(&turned[j]))?, &on.mul(&lengths[i], &lengths[j])?)?;
            skew += RBig::from(2) * largest_square(on, &cosine)?;
        }
    }
    // what lies between minus and plus the norm, and one more
    let mut near_one = Vec::with_capacity(2);
    for square in [&skew, &stretch] {
        let norm = on.apply(Function::Sqrt, &on.rational(square)?)?;
        match on.ends(&norm) {
            Some((_, high)) if high < RBig::ONE => {}
            _ => return Ok(None),
        }
        near_one.push(on.add(&one, &on.hull(&norm, &on.neg(&norm)?))?);
    }
    let factor = on.apply(Function::Sqrt, &on.div(&near_one[0], &near_one[1])?)?;
    lengths.iter().map(|length| on.mul(length, &factor)).collect::<Result<_, _>>().map(Some)
}

/// A matrix by columns, turned until these are orthogonal, approximately; and what it was multiplied by.
struct Rotated<N> {
    columns: Columns<N>,
    rotations: Columns<N>,
}

fn rotated<A: Approximate>(on: &A, matrix: &Columns<A::Number>) -> Result<Rotated<A::Number>, Refusal> {
    let count = matrix.len();
    let mut both = Vec::with_capacity(count);
    for (k, column) in matrix.iter().enumerate() {
        let mut column = column.iter().map(|x| on.middle(x)).collect::<Result<Vec<_>, _>>()?;
        for i in 0..count {
            column.push(on.rational(&RBig::from(u8::from(i == k)))?);
        }
        both.push(column);
    }
    let rows = matrix.first().map_or(0, Vec::len);
    let mut before = f64::INFINITY;
    for _ in 0..MOST_SWEEPS {
        let mut largest = 0.0f64;
        for p in 0..count {
            for q in p + 1..count {
                let (left, right) = both.split_at_mut(q);
                largest = largest.max(rotate(on, &mut left[p], &mut right[0], rows)?);
            }
        }
        if largest == 0.0 || before < NEAR && largest >= 0.5 * before {
            break;
        }
        before = before.min(largest);
    }
    let rotations = both.iter_mut().map(|column| column.split_off(rows)).collect();
    Ok(Rotated { columns: both, rotations })
}

/// Turns two columns, of which the first `rows` entries count, so that they become orthogonal; what follows is turned with
/// them. The cosine that was between them.
fn rotate<A: Approximate>(
    on: &A,
    left: &mut [A::Number],
    right: &mut [A::Number],
    rows: usize,
) -> Result<f64, Refusal> {
    let part = |a: &[A::Number], b: &[A::Number]| on.middle(&dot(on, a[..rows].iter().zip(&b[..rows]))?);
    let (product, a, b) = (part(left, right)?, part(left, left)?, part(right, right)?);
    let size = (on.near(&a) * on.near(&b)).sqrt();
    let cosine = on.near(&product).abs() / size;
    if on.near(&product) == 0.0 {
        return Ok(0.0);
    }
    // t = tan of the angle, the smaller root of t^2 + t (b - a)/product - 1 = 0
    let difference = on.middle(&on.sub(&b, &a)?)?;
    let twice = on.add(&product, &product)?;
    let root = on.apply(Function::Sqrt, &on.add(&on.power(&difference, 2)?, &on.power(&twice, 2)?)?)?;
    let negative = on.near(&difference) < 0.0;
    let magnitude = if negative { on.neg(&difference)? } else { difference };
    let t = on.div(&twice, &on.add(&magnitude, &root)?)?;
    let t = on.middle(&if negative { on.neg(&t)? } else { t })?;
    let one = on.rational(&RBig::ONE)?;
    let cos = on.middle(&on.div(&one, &on.apply(Function::Sqrt, &on.add(&one, &on.power(&t, 2)?)?)?)?)?;
    let sin = on.middle(&on.mul(&cos, &t)?)?;
    for (x, y) in left.iter_mut().zip(right.iter_mut()) {
        let new = on.middle(&on.sub(&on.mul(&cos, x)?, &on.mul(&sin, y)?)?)?;
        *y = on.middle(&on.add(&on.mul(&sin, x)?, &on.mul(&cos, y)?)?)?;
        *x = new;
    }
    Ok(cosine)
}

/// The largest square of what lies in an enclosure.
fn largest_square<A: Enclosing>(on: &A, a: &A::Number) -> Result<RBig, Refusal> {
    let (low, high) = on.ends(a).ok_or(Refusal::NotFinite)?;
    let largest = high.max(-low);
    Ok(&largest * &largest)
}

fn length<A: Arithmetic>(on: &A, column: &[A::Number]) -> Result<A::Number, Refusal> {
    on.apply(Function::Sqrt, &dot(on, column.iter().zip(column))?)
}
