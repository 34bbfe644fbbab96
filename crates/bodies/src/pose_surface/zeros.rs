//! Zeros of a periodic function that is given with its derivative: those between samples, and pairs of them that no sample shows.

use std::f64::consts::TAU;

/// A zero, and whether the function rises there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Zero {
    pub at: f64,
    pub rises: bool,
}

/// Halvings of a bracket: a turn over many samples comes down to a few units in the last place.
const HALVINGS: usize = 60;

/// The zero of a function that changes its sign between two places.
pub(super) fn bisect(f: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    let rises = f(high) > 0.0;
    for _ in 0..HALVINGS {
        let middle = f64::midpoint(low, high);
        if middle <= low || middle >= high {
            break;
        }
        if (f(middle) > 0.0) == rises {
            high = middle;
        } else {
            low = middle;
        }
    }
    f64::midpoint(low, high)
}

/// The zero of a function, `[f, f']`, that changes its sign between two places: Newton's steps where they stay between, halves elsewhere.
pub(super) fn zero_between(f: impl Fn(f64) -> [f64; 2], mut low: f64, mut high: f64) -> f64 {
    let rises = f(high)[0] > 0.0;
    let mut at = f64::midpoint(low, high);
    for round in 0..HALVINGS {
        let [value, slope] = f(at);
        if value == 0.0 {
            return at;
        }
        if (value > 0.0) == rises {
            high = at;
        } else {
            low = at;
        }
        let next = at - value / slope;
        // every third one halves, so that a flat end costs no more than three times as many
        let next = if low < next && next < high && round % 3 != 2 { next } else { f64::midpoint(low, high) };
        if (next - at).abs() <= 2.0 * f64::EPSILON * at.abs().max(1.0) {
            return next;
        }
        at = next;
    }
    at
}

/// The zeros over `[0, 2 pi)` of a function with its derivative, `[f, f']`, in order. Beside changes of sign between `samples` even places
/// those pairs are found that lie between two samples around one extremum.
pub(super) fn zeros_over_a_turn(f: impl Fn(f64) -> [f64; 2], samples: usize) -> Vec<Zero> {
    let step = TAU / samples as f64;
    let at = |i: usize| step * i as f64;
    let values: Vec<[f64; 2]> = (0..samples).map(|i| f(at(i))).collect();
    let mut found = Vec::new();
    let mut between = |low: f64, high: f64, rises: bool| {
        found.push(Zero { at: zero_between(&f, low, high).rem_euclid(TAU), rises });
    };
    for i in 0..samples {
        let ([here, slope], [there, next_slope]) = (values[i], values[(i + 1) % samples]);
        let (low, high) = (at(i), at(i + 1));
        if (here > 0.0) != (there > 0.0) {
            between(low, high, there > 0.0);
        } else if (slope > 0.0) != (next_slope > 0.0) && (slope > 0.0) != (here > 0.0) {
            // it turns toward zero and away again
            let turn = bisect(|x| f(x)[1], low, high);
            let value = f(turn)[0];
            if (value > 0.0) != (here > 0.0) && value != 0.0 {
                between(low, turn, value > 0.0);
                between(turn, high, there > 0.0);
            }
        }
    }
    found.sort_by(|a, b| a.at.total_cmp(&b.at));
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `cos x - c` has the zeros `+- acos c`: for `c` near one both lie within one step.
    #[test]
    fn a_pair_between_two_samples_is_found() {
        for offset in [0.3, 0.9, 0.9999, 0.999_999, -0.999_99] {
            let found = zeros_over_a_turn(|x| [(x - 0.77).cos() - offset, -(x - 0.77).sin()], 64);
            let root = f64::acos(offset);
            assert_eq!(found.len(), 2, "{offset}");
            let expected = [0.77 - root, 0.77 + root].map(|x| x.rem_euclid(TAU));
            for zero in &found {
                assert!(expected.iter().any(|x| (x - zero.at).abs() < 1e-9), "{zero:?}");
            }
            assert_ne!(found[0].rises, found[1].rises);
        }
        assert!(zeros_over_a_turn(|x| [x.cos() - 1.01, -x.sin()], 64).is_empty());
    }
}
