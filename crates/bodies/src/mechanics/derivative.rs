//! First and second derivatives by differences.
//!
//! Central differences with the steps `h`, `h/2`, `h/4`, `h/8`, extrapolated to step zero (Richardson). With
//! `h = 2^-32` the four steps have an error of about `h^8/2^12 = 2^-268` times a ninth or tenth derivative
//! over its factorial; rounding adds some `2^-320/(h/8)^2 = 2^-250` to a second derivative. The estimate that
//! is handed out is more careful: the difference between the last two extrapolations, which is of the order
//! `h^6`.

use super::Real;

/// The binary exponent of the greatest step.
const STEP: isize = -32;

/// How many steps there are, each half the one before.
const STEPS: usize = 4;

/// A quantity, its rate of change and the rate of that.
#[derive(Clone, Debug)]
pub struct Moving {
    pub value: Real,
    pub first: Real,
    pub second: Real,
}

/// Derivatives of several quantities, and how far they are to be trusted.
#[derive(Clone, Debug)]
pub struct Derivatives {
    /// One entry a quantity, in the order of the function that was differentiated.
    pub all: Vec<Moving>,
    /// The greatest difference between the last two extrapolations of any derivative: an estimate from above,
    /// not a bound. Undefined where a derivative is.
    pub error: Real,
}

impl Derivatives {
    /// The vector of `N` quantities that begins at a place, with its derivatives; undefined beyond the end.
    pub fn vector<const N: usize>(&self, begin: usize) -> [[Real; N]; 3] {
        let pick = |part: fn(&Moving) -> &Real| {
            std::array::from_fn(|i| {
                self.all.get(begin + i).map_or(Real::UNDEFINED, |moving| part(moving).clone())
            })
        };
        [pick(|m| &m.value), pick(|m| &m.first), pick(|m| &m.second)]
    }
}

/// Extrapolates values that belong to steps each half the one before, with an error in even powers of the
/// step. Returns the limit and its distance from the last but one.
fn extrapolate(mut column: Vec<Real>) -> (Real, Real) {
    let mut last_but_one = Real::UNDEFINED;
    for level in 1..column.len() {
        let weight = Real::power_of_two(2 * level as isize);
        let next: Vec<Real> =
            column.windows(2).map(|pair| (&weight * &pair[1] - &pair[0]) / (&weight - Real::one())).collect();
        last_but_one = column[column.len() - 1].clone();
        column = next;
    }
    let limit = column.first().cloned().unwrap_or(Real::UNDEFINED);
    let distance = (&limit - &last_but_one).abs();
    (limit, distance)
}

/// The value and the first two derivatives of a vector function of one variable, at a point near which it is
/// smooth.
///
/// The function is called nine times, within `2^-32` of the point, and has to return the same number of
/// quantities each time.
pub fn differentiate(function: impl Fn(&Real) -> Vec<Real>, at: &Real) -> Derivatives {
    let centre = function(at);
    let steps: Vec<Real> = (0..STEPS as isize).map(|k| Real::power_of_two(STEP - k)).collect();
    let around: Vec<(Vec<Real>, Vec<Real>)> =
        steps.iter().map(|step| (function(&(at - step)), function(&(at + step)))).collect();
    let get = |values: &[Real], i: usize| values.get(i).cloned().unwrap_or(Real::UNDEFINED);
    let mut error = Real::zero();
    let mut all = Vec::with_capacity(centre.len());
    for (i, value) in centre.into_iter().enumerate() {
        let (mut slopes, mut bends) = (Vec::new(), Vec::new());
        for (step, (before, after)) in steps.iter().zip(&around) {
            let (before, after) = (get(before, i), get(after, i));
            slopes.push((&after - &before) / (step + step));
            bends.push((&after + &before - (&value + &value)) / (step * step));
        }
        let ((first, first_error), (second, second_error)) = (extrapolate(slopes), extrapolate(bends));
        error = error.max(&first_error).max(&second_error);
        all.push(Moving { value, first, second });
    }
    Derivatives { all, error }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// sin' = cos, sin'' = -sin; the differences have seventy digits and own up to fifty-seven.
    #[test]
    fn derivatives_of_the_sine() {
        let at = Real::whole(7) / Real::whole(10);
        let three = Real::whole(3);
        let found = differentiate(|t| vec![(&three * t).sin_cos().0], &at);
        let (sine, cosine) = (&three * &at).sin_cos();
        let moving = &found.all[0];
        let seventy = Real::power_of_two(-233);
        assert!((&moving.first - &three * cosine).abs() < seventy);
        assert!((&moving.second + Real::whole(9) * sine).abs() < seventy);
        assert!(found.error > seventy && found.error < Real::power_of_two(-190));
    }

    #[test]
    fn a_derivative_at_a_pole_is_undefined() {
        let found = differentiate(|t| vec![Real::one() / t], &Real::zero());
        assert!(!found.all[0].second.is_defined() && !found.error.is_defined());
    }
}
