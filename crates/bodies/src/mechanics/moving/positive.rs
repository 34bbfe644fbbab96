//! Whether a function of an angle is positive everywhere, by a bound on its slope.

use std::f64::consts::TAU;

/// Where a function of an angle is not positive, or cannot be shown to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Doubt {
    /// It is negative or zero here.
    Negative { angle: f64, value: f64 },
    /// It is positive here, but too close to zero for double precision.
    Undecided { angle: f64, value: f64 },
}

/// Intervals at the start.
const PIECES: u32 = 64;
/// An interval is halved this often before it is given up.
const DEPTH: u32 = 40;

/// Whether `function` is positive for all angles, given that its slope is nowhere greater than `slope` and that its
/// computed values are off by no more than `rounding`.
///
/// Where `f(middle) > rounding + slope * half width` it is positive on the whole interval; other intervals are halved.
/// This is a proof up to the rounding that the caller states.
pub(super) fn positive_everywhere(
    function: impl Fn(f64) -> f64,
    slope: f64,
    rounding: f64,
) -> Result<(), Doubt> {
    let half = TAU / f64::from(2 * PIECES);
    let mut open: Vec<(f64, f64, u32)> =
        (0..PIECES).map(|i| (f64::from(2 * i + 1) * half, half, 0)).collect();
    while let Some((angle, half, depth)) = open.pop() {
        let value = function(angle);
        // `half` is inflated for the rounding of the angles themselves
        if value > rounding + slope * half * (1.0 + 1e-9) + slope * 1e-14 {
            continue;
        }
        if value <= 0.0 {
            return Err(Doubt::Negative { angle, value });
        }
        if depth == DEPTH || value.is_nan() || value <= rounding {
            return Err(Doubt::Undecided { angle, value });
        }
        open.push((angle - half / 2.0, half / 2.0, depth + 1));
        open.push((angle + half / 2.0, half / 2.0, depth + 1));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `1 + e + cos(3 a)` has its minima `e` at a third of a turn off zero; its slope is at most 3.
    #[test]
    fn the_sign_is_decided_where_a_grid_would_miss_it() {
        let offset = |e: f64| move |a: f64| 1.0 + e + (3.0 * a).cos();
        assert_eq!(positive_everywhere(offset(1e-6), 3.0, 1e-15), Ok(()));
        let found = positive_everywhere(offset(-1e-6), 3.0, 1e-15);
        let Err(Doubt::Negative { angle, value }) = found else { panic!("{found:?}") };
        assert!(value <= 0.0 && (offset(-1e-6)(angle) - value).abs() == 0.0);
        assert!(matches!(positive_everywhere(offset(1e-15), 3.0, 1e-15), Err(Doubt::Undecided { .. })));
        assert!(matches!(positive_everywhere(|_| f64::NAN, 3.0, 1e-15), Err(Doubt::Undecided { .. })));
    }
}
