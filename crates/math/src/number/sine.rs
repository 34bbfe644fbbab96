//! Sine and cosine over any [`Lanes`], in one loop without branches.
//!
//! The argument is brought to `|r| <= pi/4` by subtracting a multiple of `pi/2`, which is held in three parts (W. J. Cody
//! and W. Waite, *Software Manual for the Elementary Functions*, 1980), with what the subtractions round off carried
//! along; there a polynomial takes over. Both values are within 0.8 units in the last place for `|x| <= 1.6e6` (tested
//! against enclosures of 200 bits); beyond that the standard library's functions are used, lane by lane.

use super::Function;
use super::lanes::Lanes;

/// The largest argument that is reduced here: less than `2^20` quarter turns, so that the products below are exact.
const LARGEST: f64 = 1.6e6;

/// `pi/2 = FIRST + SECOND + THIRD`, within `2^-122`; the first two have 33 bits each.
const FIRST: f64 = 1.5707963267341256;
const SECOND: f64 = 6.077100506303966e-11;
const THIRD: f64 = 2.0222662487959506e-21;

/// `1.5 * 2^52`: added to a small number and subtracted again, it rounds to the nearest integer.
const TO_INTEGER: f64 = 6755399441055744.0;

/// `sin r = r + r^3 S(r^2)`: the polynomial that is best in relative error (2^-58) on `|r| <= pi/4`, by Remez exchange.
const SINE: [f64; 6] = [
    -0.16666666666666632,
    0.008333333333322425,
    -0.00019841269829816863,
    2.7557313695195034e-06,
    -2.5050758648155556e-08,
    1.5896827622248918e-10,
];

/// `cos r = 1 - r^2/2 + r^4 C(r^2)`: likewise, in absolute error (2^-64).
const COSINE: [f64; 6] = [
    0.0416666666666666,
    -0.0013888888888874138,
    2.4801587289491746e-05,
    -2.755731435521721e-07,
    2.087572368093122e-09,
    -1.1359669678937124e-11,
];

/// Sine and cosine.
#[inline(always)]
pub(super) fn sin_cos<L: Lanes>(x: L) -> (L, L) {
    let (sine, cosine) = reduced(x);
    let largest = x.splat(LARGEST);
    if largest.any_less(x.abs()) {
        (
            largest.where_less(x.abs(), x.apply(Function::Sin), sine),
            largest.where_less(x.abs(), x.apply(Function::Cos), cosine),
        )
    } else {
        (sine, cosine)
    }
}

#[inline(always)]
fn reduced<L: Lanes>(x: L) -> (L, L) {
    let integer = x.splat(TO_INTEGER);
    let quarters = x * x.splat(std::f64::consts::FRAC_2_PI) + integer - integer;
    let first = x - quarters * x.splat(FIRST); // exact
    let second = quarters * x.splat(SECOND); // exact
    let (high, rest) = two_sum(first, -second);
    let (r, tail) = two_sum(high, rest - quarters * x.splat(THIRD));

    let z = r * r;
    let (half, one) = (x.splat(0.5), x.splat(1.0));
    let half_z = half * z;
    // sin(r + tail) = sin r + tail cos r, and likewise for the cosine, to first order in the tail
    let sine = r + (r * z * polynomial(z, &SINE) + tail * (one - half_z));
    let w = one - half_z;
    let cosine = w + ((one - w - half_z) + (z * z * polynomial(z, &COSINE) - r * tail));

    // the quarter turn: an odd number exchanges the two, and every other half turn changes a sign
    let halves = quarters * half;
    let odd = (halves - nearest(halves, integer)).abs();
    let quarter = x.splat(0.25);
    (
        quarter.where_less(odd, cosine, sine) * sign(halves - odd, integer),
        quarter.where_less(odd, sine, cosine) * sign(halves + odd, integer),
    )
}

/// One after an even number of half turns, minus one after an odd number.
#[inline(always)]
fn sign<L: Lanes>(half_turns: L, integer: L) -> L {
    let turns = half_turns * integer.splat(0.5);
    integer.splat(1.0) - integer.splat(4.0) * (turns - nearest(turns, integer)).abs()
}

/// The nearest integer.
#[inline(always)]
fn nearest<L: Lanes>(x: L, integer: L) -> L {
    x + integer - integer
}

/// `a + b`, rounded, and what rounding left out (D. E. Knuth, *The Art of Computer Programming* 2, 4.2.2).
#[inline(always)]
fn two_sum<L: Lanes>(a: L, b: L) -> (L, L) {
    let sum = a + b;
    let part = sum - a;
    (sum, (a - (sum - part)) + (b - part))
}

#[inline(always)]
fn polynomial<L: Lanes>(z: L, coefficients: &[f64; 6]) -> L {
    let [a, b, c, d, e, f] = *coefficients;
    // in two halves, for shorter chains
    let low = z.splat(a) + z * (z.splat(b) + z * z.splat(c));
    let high = z.splat(d) + z * (z.splat(e) + z * z.splat(f));
    low + z * z * z * high
}

#[cfg(test)]
mod tests {
    use super::super::lanes::{MOST_LANES, Vectorised};
    use super::super::{Arithmetic, Enclosures, Instructions, rational_from_f64};
    use super::*;

    struct All<'a>(&'a [f64]);

    impl Vectorised for All<'_> {
        type Output = Vec<(f64, f64)>;
        #[inline(always)]
        fn run<L: Lanes>(self, lanes: L) -> Self::Output {
            let mut found = Vec::new();
            for some in self.0.chunks(L::COUNT) {
                let mut values = [0.0; MOST_LANES];
                values[..some.len()].copy_from_slice(some);
                let (sine, cosine) = lanes.load(&values).sin_cos();
                let (mut sines, mut cosines) = ([0.0; MOST_LANES], [0.0; MOST_LANES]);
                sine.store(&mut sines);
                cosine.store(&mut cosines);
                found.extend(sines.into_iter().zip(cosines).take(some.len()));
            }
            found
        }
    }

    /// Arguments of all sizes, around multiples of a quarter turn, and the double below 2^60 that comes nearest to one
    /// (J.-M. Muller, *Elementary Functions*, 2006, section 11.1: 16367173 * 2^72 for all doubles).
    fn arguments() -> Vec<f64> {
        let mut found = vec![0.0, -0.0, 1e-300, 1e-8, LARGEST, -LARGEST, 16367173.0 * 2f64.powi(72), 1e22];
        let mut state = 1u64;
        let mut unit = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        for scale in [1.0, 4.0, 100.0, 1e4, LARGEST] {
            found.extend((0..400).map(|_| scale * (2.0 * unit() - 1.0)));
        }
        for k in (0..400).chain([1000, 12345, 345678, 1018591]) {
            let near = f64::from(k) * std::f64::consts::FRAC_PI_2;
            found.extend([near.next_down(), near, -near.next_up()]);
        }
        found
    }

    #[test]
    fn both_are_within_a_unit_in_the_last_place() {
        let all = arguments();
        let exact = Enclosures::new(400);
        let mut worst = 0.0f64;
        for (x, (sine, cosine)) in all.iter().zip(Instructions::Portable.run(All(&all))) {
            let argument = exact.rational(&rational_from_f64(*x).unwrap()).unwrap();
            for (function, found) in [(Function::Sin, sine), (Function::Cos, cosine)] {
                let value = exact.apply(function, &argument).unwrap();
                let found = exact.rational(&rational_from_f64(found).unwrap()).unwrap();
                let error = exact.sub(&value, &found).unwrap().midpoint().abs();
                let size = value.midpoint().abs();
                if size > 0.0 {
                    let unit = size.next_up() - size;
                    worst = worst.max(error / unit.max(2f64.powi(-1070)));
                    assert!(error <= 0.8 * unit, "{function:?} of {x}: {} units", error / unit);
                }
            }
        }
        assert!(worst > 0.5, "the comparison sees nothing: {worst}");
    }

    #[test]
    fn the_same_bits_on_every_processor() {
        let all = arguments();
        let portable = Instructions::Portable.run(All(&all));
        for instructions in Instructions::ALL {
            for ((x, a), b) in all.iter().zip(&portable).zip(instructions.run(All(&all))) {
                assert_eq!((a.0.to_bits(), a.1.to_bits()), (b.0.to_bits(), b.1.to_bits()), "at {x}");
            }
        }
    }

    #[test]
    fn what_is_not_finite_has_neither() {
        for x in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let (sine, cosine) = Instructions::Portable.run(All(&[x]))[0];
            assert!(sine.is_nan() && cosine.is_nan());
        }
    }
}
