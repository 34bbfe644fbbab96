//! How likely it is that a random point shows less than there is.
//!
//! The coefficients of all series are rational functions of what is drawn: of the states (for an angle, of the tangent of its half),
//! parameters, coefficients of inputs and initial values of functions. Over a common denominator `R` of the rates `P/R`
//! and the outputs `N_0/R`, `d/dt (N/R^m) = (N_z P R - m N R_z P + N_u u' R^2)/R^(m+2)`: a derivative adds no more than
//! `max(deg P + deg R - 1, 2 deg R)` to the degree, and to the logarithm of the sum of the coefficients' magnitudes no more than those of the factors. A
//! minor has one row of each order or fewer, so that its degree is bounded; what vanishes at a random point of a random prime field
//! then vanishes but for the error of [`failure_bound`] (Schwartz and Zippel).

use super::equations::Equations;
use palmistry_math::expression::{Program, failure_bound, sizes};
use palmistry_math::number::polynomial::Size;

/// In how many rounds a rank is known, and the logarithm of the probability of an error then.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rounds {
    pub rounds: usize,
    pub log2_error: f64,
}

/// The bound for ranks of the first `orders` derivatives, and of all of their columns but one.
///
/// # Errors
/// Where there is none, in words.
pub(super) fn rounds(equations: &Equations, orders: usize) -> Result<Rounds, String> {
    let columns = equations.columns.len().max(1);
    let program =
        Program::with_unknown_functions(&equations.graph, &equations.measured, equations.is_angle());
    let of_entries = sizes(&program).map_err(|refusal| refusal.to_string())?;
    let most = |of: fn(&Size) -> f64| of_entries.iter().map(|(top, _)| of(top)).fold(0.0, f64::max);
    let all = |of: fn(&Size) -> f64| of_entries.iter().map(|(_, bottom)| of(bottom)).sum::<f64>();
    let r = Size { degree: all(|size| size.degree), bits: all(|size| size.bits) };
    // the tangent t of half an angle moves by t' = (1 + t^2)/2 times the angle's rate
    let p = Size {
        degree: most(|size| size.degree) + r.degree + 2.0,
        bits: most(|size| size.bits) + r.bits + 1.0,
    };
    let step = (p.degree + r.degree - 1.0).max(2.0 * r.degree).max(1.0);
    let (mut row, mut power) = (p, 1.0);
    for _ in 0..orders {
        let terms = 3.0 * row.degree.max(power * r.degree).max(1.0);
        row.bits += terms.log2() + p.bits + 2.0 * r.bits;
        row.degree += step;
        power += 2.0;
    }
    // a row is the differential: along the states, and with the slopes of what was adjoined
    row.bits += 2.0 * (p.bits + r.bits) + (row.degree + power * r.degree).max(1.0).log2() + 1.0;
    row.degree += 2.0 * (p.degree + r.degree);
    let rows = columns as f64;
    let mut minor = Size { degree: rows * row.degree, bits: rows * (row.bits + rows.log2()) };
    // on the set of the conditions each symbol is a function of others
    let fixed = sizes(&equations.starts).map_err(|refusal| refusal.to_string())?;
    let (mut degree, mut bits) = (1.0f64, 0.0f64);
    for (top, bottom) in &fixed {
        // one that is drawn itself has degree one and no denominator
        if bottom.degree > 0.0 || top.degree > 1.0 || top.bits > 0.0 {
            degree += top.degree + bottom.degree;
            bits = bits.max(top.bits) + bottom.bits;
        }
    }
    minor = Size { degree: minor.degree * degree, bits: minor.bits + minor.degree * bits };
    // with roots the product of all conjugates counts, and a point is drawn until its roots exist
    let conjugates = 4f64.powi(equations.roots as i32);
    // an order is where it seems to be only if the ranks of all orders are
    let tried = conjugates * (orders + 1) as f64;
    let size = Size { degree: minor.degree * tried, bits: minor.bits * tried };
    let bounded = failure_bound(size);
    let Some((rounds, log2_error)) = bounded else {
        return Err(format!("the degree of a minor may be {:.1e}", size.degree));
    };
    // of each column it is asked whether the others do without it, and of functions whether they add to the span
    let each = log2_error / rounds as f64;
    let questions = rows + equations.asked as f64;
    let rounds = rounds.max(((100.0 + questions.log2() + 1.0) / -each).ceil() as usize);
    Ok(Rounds { rounds, log2_error: rounds as f64 * each + (questions + 1.0).log2() })
}

/// The logarithm of the sum of two probabilities.
pub(crate) fn sum_of_errors(a: f64, b: f64) -> f64 {
    (a.exp2() + b.exp2()).log2()
}
