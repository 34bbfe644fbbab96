//! Angles reduced to a few degrees by fixed-point arithmetic, right for every double-double (M. H. Payne, R. N. Hanek,
//! *Radian reduction for trigonometric functions*, SIGNUM Newsletter 18 (1983)).
//!
//! A double is a whole number `m` times `2^e`. Of `m * 2^e * 2/pi`, in right angles, only the rest after whole
//! turns is wanted: modulo four, and down to `2^-254`. So only 256 bits of `2/pi` matter, from a place that depends
//! on `e`, and 64 more to guard the product. No double-double below `2^1024` lies nearer to a multiple of a right
//! angle than about `2^-120` of one (a probabilistic count: there are `2^118` of them; the tests try the worst
//! doubles known), so that the rest keeps some 130 bits.

use super::DoubleDouble;
use super::tables::{STEP, TWO_BY_PI};

/// A whole number of right angles modulo four, a number of 32nds of a right angle from 0 to 31, and the rest in
/// radians: between minus and plus pi/128 with a relative error below `10u^2` (the bits that are
/// cut off `2u^2`, pi/64 `u^2`, their product `7u^2`).
pub(super) struct Reduced {
    pub quadrant: u32,
    pub step: usize,
    pub rest: DoubleDouble,
}

/// Fixed point: 256 bits, the least significant word first; two bits before the point.
type Turns = [u64; 4];

/// Reduces a finite angle.
pub(super) fn reduce(x: DoubleDouble) -> Reduced {
    if x.hi.abs() < 0.5 * STEP.hi {
        return Reduced { quadrant: 0, step: 0, rest: x };
    }
    let mut angle = [0; 4];
    accumulate(&mut angle, x.hi);
    accumulate(&mut angle, x.lo);
    // seven bits count the 32nds of right angles; the bit below them rounds
    let (top, half) = (angle[3], 1u64 << 56);
    let count = (top.wrapping_add(half) >> 57) as u32;
    angle[3] = top.wrapping_sub(u64::from(count) << 57);
    let negative = angle[3] >> 63 == 1;
    if negative {
        negate(&mut angle);
    }
    let rest = unit(angle) * STEP;
    Reduced { quadrant: count >> 5, step: (count & 31) as usize, rest: if negative { -rest } else { rest } }
}

fn negate(angle: &mut Turns) {
    let mut carry = true;
    for word in angle {
        (*word, carry) = (!*word).overflowing_add(u64::from(carry));
    }
}

/// Adds a double, in right angles, modulo four.
fn accumulate(angle: &mut Turns, x: f64) {
    let bits = x.to_bits();
    let exponent = ((bits >> 52) & 0x7ff) as i32;
    let fraction = bits & ((1 << 52) - 1);
    let (m, e) = if exponent == 0 { (fraction, -1074) } else { (fraction | 1 << 52, exponent - 1075) };
    // x * 2/pi * 2^254 = m * (2/pi shifted left by e + 254): 256 bits of that, and 64 below the point
    let last = e + 254 + 64;
    if m == 0 || last <= 0 {
        return;
    }
    let mut carry = 0;
    let mut product = [0; 5];
    for (i, word) in product.iter_mut().enumerate() {
        let wide = u128::from(m) * u128::from(window(last - 64 * i as i32)) + u128::from(carry);
        (*word, carry) = (wide as u64, (wide >> 64) as u64);
    }
    let mut part: Turns = [product[1], product[2], product[3], product[4]];
    if bits >> 63 == 1 {
        negate(&mut part);
    }
    let mut carry = false;
    for (word, more) in angle.iter_mut().zip(part) {
        let (sum, first) = word.overflowing_add(more);
        let (sum, second) = sum.overflowing_add(u64::from(carry));
        (*word, carry) = (sum, first || second);
    }
}

/// The 64 bits of 2/pi that end with the `last`-th after the point; before the point there are zeros.
fn window(last: i32) -> u64 {
    let word = |index: i32| usize::try_from(index).ok().and_then(|i| TWO_BY_PI.get(i)).copied().unwrap_or(0);
    let (index, offset) = ((last - 1).div_euclid(64), (last - 1).rem_euclid(64) as u32);
    // the bit `last` is the `offset`-th from the left, from zero, of the word `index`
    if offset == 63 { word(index) } else { word(index - 1) << (offset + 1) | word(index) >> (63 - offset) }
}

/// A fixed-point number below a 64th of a right angle, in steps of a 32nd: its leading 128 bits as a double-double.
fn unit(angle: Turns) -> DoubleDouble {
    let zeros = match angle.iter().rev().position(|word| *word != 0) {
        Some(words) => 64 * words as u32 + angle[3 - words].leading_zeros(),
        None => return DoubleDouble::ZERO,
    };
    let (words, shift) = ((zeros / 64) as usize, zeros % 64);
    let at = |i: usize| if i < 4 - words { angle[3 - words - i] } else { 0 };
    let leading = |i: usize| if shift == 0 { at(i) } else { at(i) << shift | at(i + 1) >> (64 - shift) };
    // 2^249 is one step; the first bit of `top` has the weight 2^(255 - zeros)
    let (top, bottom) = (leading(0), leading(1));
    let high = (top >> 11) as f64;
    let low = (((top & 0x7ff) << 42) | (bottom >> 22)) as f64; // 53 bits
    let weight = |exponent: i32| f64::from_bits(((1023 + exponent) as u64) << 52);
    let exponent = 255 - zeros as i32 - 249;
    DoubleDouble::normalised(high * weight(exponent - 52), low * weight(exponent - 105))
}
