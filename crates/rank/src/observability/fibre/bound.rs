//! How likely it is that a random point modulo a random prime shows fewer values than there are.
//!
//! Let `y_1 ... y_n` be derivatives of outputs whose differentials are independent in the `n` unknowns that are not fixed. On the states
//! over which they are `N/R^m`, pairs of points with the same outputs are the zeros of `G_j = N_j(a) R(b)^m - N_j(b) R(a)^m`.
//! Let two points with the same outputs,
//! at almost all `a`, differ in the value that is asked for. Then there is a variety `C` of such pairs over the rationals whose
//! projection to
//! `a` is dense and has finite fibres, with a further coordinate `s`, `s R(b) (v(b) - v(a)) = 1`. It is a component of the
//! zeros of `n + 1` polynomials, so that its degree
//! `D` is at most the product of theirs (Bezout). Each of the `n + 1` coordinates of `C` beside `a` satisfies over `Z[a]` an
//! equation of degree at most `D`: that of the closure of the image of `C`. Where the leading coefficients of all of them do not
//! vanish, modulo a prime or not, the coordinates are integral over `Z[a]`, and over `a` lies a point of `C`, modulo the same prime (Cohen
//! and Seidenberg): a second value is met. The product of these coefficients has a degree of at most `(n + 1) D`, and
//! [`failure_bound`] says how seldom it
//! vanishes. That so and so many values are met and no more is shown in the same way: of the polynomial whose roots are the values,
//! of degree `D`, neither the leading coefficient nor the discriminant may vanish.
//!
//! Nothing of it depends on how many derivatives were taken: those that are left out can only distinguish more values. Nor does it matter that some states begin
//! at given numbers, where the derivatives are independent in the other unknowns on the set of these states: the numbers are put in, `a` and `b` are points of
//! that set, and the coefficients grow.
//!
//! The coefficients are bounded by the arithmetic theorem of Bezout (T. Krick, L. M. Pardo and M. Sombra, *Sharp estimates for the
//! arithmetic Nullstellensatz*, Duke Math. J. 109 (2001), corollary 2.11), with twice as much room for the logarithms of the
//! dimension as Chow forms,
//! their Mahler measures and their values at coordinates need there: what counts is the number of primes that divide them, and
//! these are many.

use super::exact::Exact;
use super::model::{Model, Motion, Quotient};
use crate::observability::generic::Orders;
use dashu::base::BitTest;
use palmistry_math::expression::failure_bound;
use palmistry_math::number::polynomial::Size;

/// Bounds on the two products that may not vanish.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    one: Size,
    several: Size,
}

impl Bounds {
    /// The logarithm of the probability that one round shows `values` where there are more, for each round.
    pub fn of_a_round(&self, values: usize) -> Option<f64> {
        let (rounds, log2_error) = failure_bound(if values <= 1 { self.one } else { self.several })?;
        Some(log2_error / rounds as f64)
    }
}

fn size(polynomial: &Exact) -> Size {
    let degree = |m: &[(u32, u16)]| m.iter().map(|(_, n)| f64::from(*n)).sum::<f64>();
    let magnitudes = polynomial.terms.values().map(|c| c.bit_len() as f64).fold(0.0, f64::max);
    Size {
        degree: polynomial.terms.keys().map(|m| degree(m)).fold(0.0, f64::max),
        bits: magnitudes + (polynomial.terms.len().max(1) as f64).log2(),
    }
}

/// The bounds for the value of an unknown, or of an expression.
pub(super) fn bounds(model: &Model, orders: &Orders, asked: Option<&Quotient>) -> Option<Bounds> {
    if !model.angles.is_empty() {
        return None;
    }
    // a number in the place of a state: with its denominators cleared, coefficients grow by as many bits for each degree
    let bits = model.bits_of_given_numbers()?;
    let size = |polynomial: &Exact| {
        let free = size(polynomial);
        Size { bits: free.bits + free.degree * bits, ..free }
    };
    let rates = model.variables.iter().filter_map(|variable| match &variable.motion {
        Motion::Moves(rate) => Some(rate),
        _ => None,
    });
    let all: Vec<&Quotient> = rates.chain(&model.outputs).collect();
    let mut bottoms: Vec<&Exact> = Vec::new();
    for quotient in &all {
        if !bottoms.contains(&&quotient.bottom) {
            bottoms.push(&quotient.bottom);
        }
    }
    let r = bottoms
        .iter()
        .map(|bottom| size(bottom))
        .fold(Size::default(), |a, b| Size { degree: a.degree + b.degree, bits: a.bits + b.bits });
    // over the common denominator
    let over = |quotient: &Quotient| {
        let (top, bottom) = (size(&quotient.top), size(&quotient.bottom));
        Size { degree: top.degree + r.degree - bottom.degree, bits: top.bits + r.bits }
    };
    let p = all
        .iter()
        .map(|quotient| over(quotient))
        .fold(Size::default(), |a, b| Size { degree: a.degree.max(b.degree), bits: a.bits.max(b.bits) });
    let step = if r.degree > 0.0 {
        (p.degree + r.degree - 1.0).max(2.0 * r.degree)
    } else {
        (p.degree - 1.0).max(0.0)
    };
    let (mut log2_degree, mut heights, mut count, mut deepest) = (0.0, 0.0, 0.0, 0.0f64);
    for (output, raised) in model.outputs.iter().zip(&orders.raised) {
        let (mut row, mut power) = (over(output), if r.degree > 0.0 { 1.0 } else { 0.0 });
        let last = raised.last().copied().unwrap_or(0);
        for order in 0..=last {
            if raised.contains(&order) {
                log2_degree += (row.degree + power * r.degree).max(1.0).log2();
                heights += row.bits + power * r.bits + 1.0;
                count += 1.0;
            }
            let terms = 3.0 * row.degree.max(power * r.degree).max(1.0);
            row.bits += terms.log2() + p.bits + 2.0 * r.bits;
            row.degree += step;
            power += if r.degree > 0.0 { 2.0 } else { 0.0 };
        }
        deepest = deepest.max(last as f64);
    }
    let (top, bottom) = match asked {
        Some(asked) => (size(&asked.top), size(&asked.bottom)),
        None => (Size { degree: 1.0, bits: 1.0 }, Size::default()),
    };
    // derivatives of drives are coordinates too
    let coordinates = model.variables.len() as f64 * (deepest + 1.0) + count + 2.0;
    let room = 8.0 * coordinates * coordinates.log2();
    let differ = 1.0 + r.degree + top.degree + 3.0 * bottom.degree;
    let exists = 1.0 + r.degree + 2.0 * bottom.degree;
    let of_values = r.bits + 2.0 * top.bits + 3.0 * bottom.bits + 2.0;
    let variety = |last: f64| {
        let degree = log2_degree.exp2() * last;
        Size { degree, bits: degree * (heights + of_values + room) }
    };
    let (pairs, points) = (variety(differ), variety(exists));
    let one = Size { degree: (count + 1.0) * pairs.degree, bits: (count + 1.0) * pairs.bits };
    // a resultant of the polynomial of the values and its slope
    let values = (top.degree + bottom.degree).max(1.0) * points.degree;
    let several = Size {
        degree: (count + 2.0) * points.degree + 2.0 * values * values,
        bits: (count + 2.0) * points.bits
            + 2.0
                * values
                * ((top.degree + bottom.degree).max(1.0) * points.bits + values.max(2.0).log2() + 2.0),
    };
    Some(Bounds { one, several })
}
