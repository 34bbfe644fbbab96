//! Sine and cosine of one double, enclosed: the price of a box is mostly that of the sines of its ends.
//!
//! For angles up to 2^16 a few dozen operations on doubles do, with this bound on their errors. `u = 2^-53`.
//!
//! 1. *Reduction.* `n` is a whole number near `64 x/pi`, so that `r = x - n pi/64` is at most `0.02455 < 2^-5.34` in size.
//!    pi/64 is `P1 + P2 + P3`, 31, 31 and 53 bits. `n` has 21 bits, so `n P1` and `n P2` are exact; so is `x - n P1`, a
//!    multiple of the last place of `x` no greater than `x`. Of the rest, `P3` is off by `2^-120`, and `n P3 < 2^-45` and
//!    the sum of the low parts are rounded: `|r - (rh + rl)| < 2^-97`, and nothing where `n = 0`. `|rl| <= 2^-53 |rh|`.
//! 2. *Sine of the rest*, `rh + p`, `p = rl + rh z (-1/6 + z/120 - ...)`, `z = rh^2`: the series is at most `1.01e-4 |rh|`
//!    and its relative error `5u`; what is dropped (`rl z/2`, `rh^11/11!`) and the last rounding bring it to less than
//!    `2^-62 |rh|`.
//! 3. *One less the cosine of the rest*, `q = z/2 - z^2/24 + ... + rh rl`, at most `3.03e-4`, with an error below
//!    `3u * 3.03e-4 + 2^-74 < 2^-62.9`.
//! 4. *Sum.* With `S + S'`, `C + C'` the sine and cosine of `n pi/64` as double-doubles:
//!    `sin x = (S + C rh) + (S' + C' rh + C p - S q)`. The product `C rh < 0.0246` is rounded, by `2^-59` at most; its sum
//!    with `S` is kept whole; the bracket, at most `3.1e-4`, takes five roundings, `5u * 3.1e-4 < 2^-62.3`. Together with
//!    the errors of `p`, `q` and `r` less than `2^-58.7`. The cosine likewise. Where `S = 0` the sine is `rh + p`, and its
//!    error `2^-62 |rh| + 2^-97`.
//!
//! `2^-58` stands for `2^-58.7` below, `2^-61 |rh| + 2^-96` for the other, and the difference for the rounding of these
//! bounds themselves.

use super::Interval;
use super::arithmetic::{above, below};
use super::rounding::around;
use crate::number::double_double::{DoubleDouble, SINE};
use crate::number::error_free::{fast_two_sum, two_sum};

/// pi/64 in three parts.
pub(super) const PARTS: [f64; 3] = [0.049087385210441425, 1.8990939073729564e-12, 9.102287675291738e-22];

/// Up to here the number of 64ths of half turns has 21 bits.
const FAR: f64 = 65536.0;

/// Sine and cosine of a number, and how many right angles go into it, rounded down; of great angles modulo four.
#[derive(Clone, Copy)]
pub(super) struct Circular {
    pub sin: Interval,
    pub cos: Interval,
    pub right_angles: i32,
}

impl Circular {
    /// Whether a number that is `k` right angles, modulo four, lies between this number and another, `width` above it
    /// at most.
    pub fn meets(&self, other: &Circular, width: f64, k: i32) -> bool {
        const THREE_RIGHT_ANGLES: f64 = 4.7;
        // less than three right angles wide, it meets three multiples of one at most
        let passed = (other.right_angles - self.right_angles) & 3;
        width >= THREE_RIGHT_ANGLES || (self.right_angles - k + passed) >> 2 > (self.right_angles - k) >> 2
    }
}

const fn power_of_two(n: i32) -> f64 {
    f64::from_bits(((1023 + n) as u64) << 52)
}

/// Sine and cosine of a finite number.
pub(super) fn circular(x: f64) -> Circular {
    if x.abs() < power_of_two(-27) {
        // x - x^3/6 and 1 - x^2/2: less than one place from x and from one
        let sin = Interval {
            lo: if x > 0.0 { x.next_down() } else { x },
            hi: if x < 0.0 { x.next_up() } else { x },
        };
        let cos = Interval { lo: if x == 0.0 { 1.0 } else { 1f64.next_down() }, hi: 1.0 };
        return Circular { sin, cos, right_angles: -i32::from(x < 0.0) };
    }
    if x.abs() > FAR {
        return carefully(x);
    }
    // to the nearest whole number, by the bits that do not fit
    const ROUND: f64 = 1.5 * power_of_two(52);
    let n = (x * (64.0 / std::f64::consts::PI) + ROUND) - ROUND;
    let count = n as i32;
    let (high, low) = two_sum(x - n * PARTS[0], -(n * PARTS[1]));
    let (rh, rl) = fast_two_sum(high, low - n * PARTS[2]);
    if rh.abs() < power_of_two(-80) {
        return carefully(x); // next to a whole right angle, it may be on either side
    }
    let z = rh * rh;
    let p = rl + rh * (z * (-1.0 / 6.0 + z * (1.0 / 120.0 + z * (-1.0 / 5040.0 + z * (1.0 / 362_880.0)))));
    let q = z * (0.5 + z * (-1.0 / 24.0 + z * (1.0 / 720.0 + z * (-1.0 / 40_320.0)))) + rh * rl;
    let step = (count & 31) as usize;
    let (s, c) = if step == 0 {
        let error = power_of_two(-61) * rh.abs() + if count == 0 { 0.0 } else { power_of_two(-96) };
        (near(rh, p, error), near(1.0, -q, power_of_two(-58)))
    } else {
        let (a, b) = (SINE[step], SINE[32 - step]);
        let sum = |(s, t): (f64, f64), (c, d): (f64, f64), sign: f64| {
            let (whole, part) = two_sum(s, sign * (c * rh));
            near(whole, part + (t + sign * (d * rh + c * p) - s * q), power_of_two(-58))
        };
        let (a, b) = ((a.hi(), a.lo()), (b.hi(), b.lo()));
        (sum(a, b, 1.0), sum(b, a, -1.0))
    };
    let (s, c) = (within(s), within(c));
    let (sin, cos) = match (count >> 5) & 3 {
        0 => (s, c),
        1 => (c, -s),
        2 => (-s, -c),
        _ => (-c, s),
    };
    Circular { sin, cos, right_angles: (count >> 5) - i32::from(step == 0 && rh < 0.0) }
}

/// By double-doubles, whose reduction is right for every angle.
#[cold]
fn carefully(x: f64) -> Circular {
    let x = DoubleDouble::from(x);
    let (sin, cos) = x.sin_cos();
    Circular { sin: within(around(sin)), cos: within(around(cos)), right_angles: x.quadrant() }
}

fn within(all: Interval) -> Interval {
    Interval { lo: all.lo.max(-1.0), hi: all.hi.min(1.0) }
}

/// What lies within `error` of `high + low`, where `high` is by far the greater, and `error` less than either of its
/// neighbours' distances.
#[inline]
fn near(high: f64, low: f64, error: f64) -> Interval {
    let (high, low) = fast_two_sum(high, low);
    let (least, most) = (low - error, low + error);
    let (lo, hi) = (high + least, high + most);
    let beyond = |end: f64, rest: f64| rest - (end - high);
    Interval { lo: below(lo, beyond(lo, least) < 0.0), hi: above(hi, beyond(hi, most) > 0.0) }
}
