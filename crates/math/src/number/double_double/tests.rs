//! Held against exact rationals and against dashu's enclosures of several hundred bits.

use super::arithmetic::{exponent_of, shifted};
use super::tables::*;
use super::*;
use crate::number::{Arithmetic, Enclosure, Enclosures, Floats};
use dashu::integer::IBig;
use proptest::prelude::*;

/// Double-doubles of every size between `2^-low` and `2^high`.
fn number(low: i32, high: i32) -> impl Strategy<Value = DoubleDouble> {
    let part = prop_oneof![3 => 1.0..2.0f64, 1 => (1i32..64).prop_map(|n| f64::from(n) / 32.0)];
    let tail = prop_oneof![3 => -1.0..1.0f64, 1 => Just(0.0), 1 => -1e-15..1e-15];
    (part, tail, -low..high, any::<bool>()).prop_map(|(hi, lo, e, negative)| {
        let x = shifted(DoubleDouble::new(hi, lo * 2f64.powi(-53)), e);
        if negative { -x } else { x }
    })
}

fn exact(x: DoubleDouble) -> RBig {
    x.to_rational().unwrap()
}

fn two_to(n: i32) -> RBig {
    let power = RBig::from(IBig::ONE << n.unsigned_abs() as usize);
    if n < 0 { RBig::ONE / power } else { power }
}

fn size(x: RBig) -> RBig {
    if x < RBig::ZERO { -x } else { x }
}

/// Whether a result is normalised and within `bound * u^2` of the exact one, or a few units of `2^-1074`.
fn is_right(x: DoubleDouble, value: &RBig, bound: f64) -> bool {
    let error = size(exact(x) - value);
    let allowed = rational_from_f64(bound).unwrap() * two_to(-106) * size(value.clone());
    x.hi + x.lo == x.hi && (error <= allowed || error <= two_to(-1070))
}

/// The bounds of the cited papers, with their terms in `u^3`.
const SUM: f64 = 3.0001;
const PRODUCT: f64 = 7.0;
const QUOTIENT: f64 = 15.0001;
const ROOT: f64 = 3.126;

proptest! {
    #![proptest_config(ProptestConfig { cases: 10_000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn operations_keep_their_bounds(a in number(480, 480), b in number(480, 480), near in -60i32..60) {
        let c = shifted(b, exponent_of(a.hi) - exponent_of(b.hi) + near);
        for b in [b, c] {
            let (x, y) = (exact(a), exact(b));
            prop_assert!(is_right(a + b, &(&x + &y), SUM));
            prop_assert!(is_right(a - b, &(&x - &y), SUM));
            prop_assert!(is_right(a * b, &(&x * &y), PRODUCT));
            prop_assert!(is_right(a / b, &(&x / &y), QUOTIENT));
            prop_assert!(is_right(a.times(b.hi), &(&x * rational_from_f64(b.hi).unwrap()), 1.5001));
        }
    }

    #[test]
    fn to_the_ends_of_the_range(a in number(1073, 1023), b in number(1073, 1023)) {
        prop_assume!(b.hi != 0.0);
        let (x, y) = (exact(a), exact(b));
        let limit = rational_from_f64(f64::MAX).unwrap();
        for (result, value) in [(a + b, &x + &y), (a * b, &x * &y), (a / b, &x / &y)] {
            if size(value.clone()) <= limit {
                prop_assert!(is_right(result, &value, 2f64.powi(6)) || size(value.clone()) < two_to(-960)
                    && size(exact(result) - &value) <= two_to(-1070), "{a:?} {b:?}: {result:?}");
            } else {
                prop_assert!(result.hi.is_infinite() && result.lo == 0.0);
            }
        }
        let root = a.abs().sqrt();
        // by the square: the error doubles
        let square = exact(root) * exact(root);
        prop_assert!(size(square - size(x.clone())) <= rational_from_f64(2.0 * ROOT + 0.01).unwrap() * two_to(-106) * size(x)
            || a.hi.abs() < 1e-290);
    }

    #[test]
    fn a_rational_is_rounded_to_nearest(n in any::<i64>(), d in 1u64..) {
        let value = RBig::from_parts(n.into(), d.into());
        prop_assert!(is_right(DoubleDouble::from_rational(&value), &value, 1.0));
    }
}

/// The error of a function in units of `u^2` of its value, rounded up; `None` where the enclosure has no value.
fn error(function: Function, x: DoubleDouble, wide: &Enclosures) -> Option<f64> {
    let value: Enclosure = wide.apply(function, &wide.rational(&exact(x)).ok()?).ok()?;
    let Ok(found) = x.function(function) else { return Some(f64::INFINITY) };
    if !found.hi.is_finite() {
        // beyond the greatest double, or wrong
        return (rational_to_f64(&value.low()).abs() < f64::INFINITY).then_some(f64::INFINITY);
    }
    assert!(found.hi + found.lo == found.hi, "{function:?} {x:?}");
    let found = exact(found);
    let error = size(&found - value.low()).max(size(found - value.high()));
    let low = size(value.low());
    if low.is_zero() {
        return Some(if error.is_zero() { 0.0 } else { f64::INFINITY });
    }
    if error <= two_to(-1070) {
        return Some(0.0);
    }
    Some(rational_to_f64(&(error / low * two_to(106))))
}

/// Arguments of a function that give a number: a wide range, and the neighbourhood of where it is delicate.
fn argument() -> impl Strategy<Value = DoubleDouble> {
    prop_oneof![
        3 => number(8, 8),
        1 => number(1000, 1000),
        1 => number(60, 0).prop_map(|x| DoubleDouble::ONE + x * DoubleDouble::from(0.03)),
        1 => number(60, 0).prop_map(|x| DoubleDouble::ONE - x.abs()),
        1 => (number(60, 6), -400i32..400).prop_map(|(x, n)| {
            HALF_PI * DoubleDouble::from(f64::from(n)) + x.scaled(1e-4)
        }),
        1 => (-4000i32..4000, -3i32..4).prop_map(|(n, k)| {
            DoubleDouble::from(f64::from(n) / 64.0) + DoubleDouble::from(f64::from(k) * 1e-18)
        }),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1_000, failure_persistence: None, ..ProptestConfig::default() })]

    /// 2^-100 is 64 u^2.
    #[test]
    fn functions_are_right_to_two_to_the_minus_hundred(x in argument()) {
        let wide = Enclosures::new(300);
        for function in Function::ALL {
            if let Some(error) = error(function, x, &wide) {
                prop_assert!(error <= 64.0, "{function:?} {x:?}: {error} u^2");
            }
        }
    }
}

/// The doubles nearest to multiples of pi/2, found by continued fractions: 6381956970095103 * 2^797 is the worst of all
/// (J.-M. Muller, *Elementary Functions*, 3rd ed., 2016, sec. 11.3.2: 5.3e-19 from one).
#[test]
fn the_worst_angles_are_reduced() {
    let wide = Enclosures::new(400);
    let worst = 6381956970095103.0 * 2f64.powi(797);
    for x in [worst, -worst, f64::MAX, 1e22, 1e300, 710.0, 3.0 * std::f64::consts::FRAC_PI_2, 5e-324, 1e-300]
    {
        for function in [Function::Sin, Function::Cos] {
            let error = error(function, x.into(), &wide).unwrap();
            assert!(error <= 32.0, "{function:?} {x}: {error}");
        }
    }
    assert!(DoubleDouble::from(worst).sin_cos().1.hi.abs() < 5.4e-19);
}

/// Digits of mpmath 1.3, mp.dps = 40.
#[test]
fn published_digits() {
    let digits = |x: DoubleDouble| round_to_decimal(&exact(x), 30);
    let third = DoubleDouble::ONE / DoubleDouble::from(3.0);
    assert_eq!(digits(third), "0.333333333333333333333333333333");
    assert_eq!(digits(DoubleDouble::from(2.0).sqrt()), "1.41421356237309504880168872421");
    assert_eq!(digits(DoubleDouble::from(2.0).sin_cos().0), "0.909297426825681695396019865912");
    assert_eq!(digits(DoubleDouble::ONE.exp()), "2.71828182845904523536028747135");
    assert_eq!(digits(DoubleDouble::from(2.0).ln()), "0.693147180559945309417232121458");
    assert_eq!(digits(third.atan()), "0.321750554396642193401404614359");
}

#[test]
fn the_ends_of_the_range_are_named() {
    let d = DoubleDouble::from;
    let (huge, infinite, nan) = (d(1e300), d(f64::INFINITY), d(f64::NAN));
    for overflow in [
        huge * huge,
        huge / d(1e-300),
        d(f64::MAX) + d(f64::MAX),
        d(1000.0).exp(),
        infinite + huge,
        infinite * huge,
    ] {
        assert_eq!((overflow.hi, overflow.lo), (f64::INFINITY, 0.0), "{overflow:?}");
    }
    for none in [
        infinite - infinite,
        infinite * d(0.0),
        d(0.0) / d(0.0),
        d(-1.0).sqrt(),
        nan + d(1.0),
        nan.exp(),
        d(2.0).asin(),
        d(-1.5).acos(),
        d(-1.0).ln(),
        infinite.sin_cos().0,
    ] {
        assert!(none.hi.is_nan() && none.lo == 0.0, "{none:?}");
    }
    assert_eq!(d(1.0) / infinite, d(0.0));
    assert_eq!(infinite.atan(), HALF_PI);
    assert_eq!(d(-1.0).acos(), PI);
    assert_eq!(d(0.0).ln().hi, f64::NEG_INFINITY);
    assert_eq!(d(-1000.0).exp(), d(0.0));
    assert_eq!(d(f64::MAX) / d(f64::MAX), d(1.0));
    assert_eq!(d(-1.0).function(Function::Log), Err(Refusal::OutsideDomain(Function::Log)));
    let all = Floats::<DoubleDouble>::new();
    assert_eq!(all.div(&d(1.0), &d(0.0)), Err(Refusal::DivisionByZero));
    assert_eq!(format!("{}", d(0.1)), "0.10000000000000000555111512312578");
}

/// Every constant is the double-double nearest to its number.
#[test]
fn the_tables_are_right() {
    let wide = Enclosures::new(400);
    let check = |name: &str, found: DoubleDouble, value: Enclosure| {
        assert_eq!(found, DoubleDouble::from_rational(&value.low()), "{name}");
        assert_eq!(found, DoubleDouble::from_rational(&value.high()), "{name}");
    };
    let q = |n: i64, d: u64| wide.rational(&RBig::from_parts(n.into(), d.into())).unwrap();
    let pi_times = |n: i64, d: u64| wide.mul(&wide.pi().unwrap(), &q(n, d)).unwrap();
    let ln_2 = wide.apply(Function::Log, &q(2, 1)).unwrap();
    check("pi", PI, pi_times(1, 1));
    check("pi/2", HALF_PI, pi_times(1, 2));
    check("pi/64", STEP, pi_times(1, 64));
    check("ln 2", LN_2, ln_2.clone());
    let mut factorial = 1;
    for (n, found) in (0..).zip(INVERSE_FACTORIAL) {
        factorial *= u64::max(n, 1);
        check("1/n!", found, q(1, factorial));
    }
    for (n, found) in (0..).zip(INVERSE_ODD) {
        check("1/(2n + 1)", found, q(1, 2 * n + 1));
    }
    for (j, found) in (0..).zip(SINE) {
        // the sine of zero and of a right angle are not enclosed by a point
        if (1..32).contains(&j) {
            check("sin", found, wide.apply(Function::Sin, &pi_times(j, 64)).unwrap());
        }
    }
    assert_eq!((SINE[0], SINE[32]), (DoubleDouble::ZERO, DoubleDouble::ONE));
    for (j, found) in (0..).zip(POWER_OF_TWO) {
        check("2^(j/32)", found, wide.apply(Function::Exp, &wide.mul(&ln_2, &q(j, 32)).unwrap()).unwrap());
    }
    for (j, found) in (0..).zip(ARC_TANGENT) {
        check("atan", found, wide.apply(Function::Atan, &q(j, 32)).unwrap());
    }
    for (c, found) in RECIPROCAL.into_iter().zip(MINUS_LOG) {
        check("-ln", -found, wide.apply(Function::Log, &q(c as i64, 256)).unwrap());
    }
    for (i, c) in (23..).zip(RECIPROCAL) {
        assert!((c * f64::from(i) / (256.0 * 32.0) - 1.0).abs() < 0.005 && c < 512.0);
    }
    // the three parts of ln 2 / 32: short ones, and together right to 2^-130
    let parts: RBig =
        LN_2_BY_32.iter().map(|part| rational_from_f64(*part).unwrap()).fold(RBig::ZERO, |a, b| a + b);
    assert!(size(parts - ln_2.low() / RBig::from(32)) < two_to(-130));
    assert!(LN_2_BY_32[..2].iter().all(|part| part.to_bits() & ((1 << 17) - 1) == 0));
    // 2/pi: the words as one fraction
    let words = TWO_BY_PI.iter().fold(IBig::ZERO, |all, word| (all << 64) + IBig::from(*word));
    let wide = Enclosures::new(1500);
    let whole = wide.div(&wide.rational(&RBig::from(2)).unwrap(), &wide.pi().unwrap()).unwrap();
    assert_eq!((whole.low() * two_to(22 * 64)).floor(), words);
    assert_eq!((whole.high() * two_to(22 * 64)).floor(), words);
}
