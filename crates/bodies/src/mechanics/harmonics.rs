//! A support function by its harmonics, over any number: the one that bodies in 320 bits and in doubles share.
//!
//! What is shared is what the body looks like. How it moves is found twice, by differences of positions in 320 bits and by
//! contact constraints in doubles, and neither knows the other.

use std::ops::{Add, Mul, Sub};

/// Numbers of which a support function is made.
pub trait SupportNumber: Clone {
    /// A small whole number.
    fn whole(n: i32) -> Self;
}

impl SupportNumber for f64 {
    fn whole(n: i32) -> Self {
        f64::from(n)
    }
}

impl SupportNumber for super::Real {
    fn whole(n: i32) -> Self {
        super::Real::whole(i64::from(n))
    }
}

/// `h(a) = mean + sum_k (p_k cos(k a) + q_k sin(k a))`, the extent of a convex body from the origin in the direction at the
/// angle `a`. The first harmonic moves the body without changing its form.
#[derive(Clone, Debug)]
pub(super) struct Harmonics<N> {
    pub mean: N,
    /// `[p_k, q_k]` for `k` from one.
    pub pairs: Vec<[N; 2]>,
}

impl<N: SupportNumber> Harmonics<N>
where
    for<'a> &'a N: Add<&'a N, Output = N> + Sub<&'a N, Output = N> + Mul<&'a N, Output = N>,
{
    /// `h`, `h'` and `h''`; `multiple` gives cosine and sine of `k a` for `k` from one, in this order.
    pub fn support(&self, mut multiple: impl FnMut(i32) -> [N; 2]) -> [N; 3] {
        let mut total = [self.mean.clone(), N::whole(0), N::whole(0)];
        for (k, [p, q]) in (1..).zip(&self.pairs) {
            let [cosine, sine] = multiple(k);
            let value = &(p * &cosine) + &(q * &sine);
            let slope = &(q * &cosine) - &(p * &sine);
            let k = N::whole(k);
            total = [&total[0] + &value, &total[1] + &(&k * &slope), &total[2] - &(&(&k * &k) * &value)];
        }
        total
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::Real;
    use palmistry_math::number::rational_from_f64;

    fn real(x: f64) -> Real {
        Real::from_rational(&rational_from_f64(x).unwrap())
    }

    /// A point `(p, q)` reaches `p cos a + q sin a` far, and its second derivative is minus that; `p cos(3 a)` is
    /// `p (4 c^3 - 3 c)`, by hand.
    #[test]
    fn a_point_and_a_third_harmonic() {
        let (angle, zero) = (0.7f64, [0.0, 0.0]);
        let multiple = |k: i32| [(f64::from(k) * angle).cos(), (f64::from(k) * angle).sin()];
        let (c, s) = (angle.cos(), angle.sin());
        let point = Harmonics { mean: 0.0, pairs: vec![[2.0, -0.5]] }.support(multiple);
        let expected = [2.0 * c - 0.5 * s, -2.0 * s - 0.5 * c, -2.0 * c + 0.5 * s];
        let third = Harmonics { mean: 5.0, pairs: vec![zero, zero, [0.25, 0.0]] }.support(multiple);
        let cubic = 0.25 * (4.0 * c.powi(3) - 3.0 * c);
        // (4 c^3 - 3 c)' = -(12 c^2 - 3) s
        let expected_third = [5.0 + cubic, -0.25 * (12.0 * c * c - 3.0) * s, -9.0 * cubic];
        for (found, expected) in point.iter().chain(&third).zip(expected.iter().chain(&expected_third)) {
            assert!((found - expected).abs() < 1e-14, "{found} {expected}");
        }
    }

    #[test]
    fn doubles_and_long_numbers_agree() {
        let pairs = [[0.2, -0.1], [0.1, 0.05], [-0.02, 0.03], [0.001, 0.004]];
        let doubles = Harmonics { mean: 1.5, pairs: pairs.to_vec() };
        let long = Harmonics { mean: real(1.5), pairs: pairs.map(|pair| pair.map(real)).to_vec() };
        for angle in [0.0, 0.3, -2.0, 3.0, 6.0] {
            let short = doubles.support(|k| [(f64::from(k) * angle).cos(), (f64::from(k) * angle).sin()]);
            let found = long.support(|k| {
                let (sine, cosine) = (Real::whole(i64::from(k)) * real(angle)).sin_cos();
                [cosine, sine]
            });
            for (short, long) in short.iter().zip(&found) {
                assert!((short - long.to_f64()).abs() < 4e-15, "{short} {long:?} at {angle}");
            }
        }
    }
}
