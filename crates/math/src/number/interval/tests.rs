//! Held against exact rationals, and for the functions against dashu's enclosures of 200 bits.

use super::*;
use crate::number::{Arithmetic, DoubleDouble, Enclosures, Floats, Function};
use proptest::prelude::*;

/// Doubles of every kind: any bits that are no NaN, small whole numbers, the ends of the range.
fn double() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => any::<u64>().prop_map(f64::from_bits).prop_filter("a number", |x| !x.is_nan()),
        4 => -1e3..1e3,
        2 => (-40i32..40).prop_map(f64::from),
        2 => (-1000i32..1000, -1074i32..1023).prop_map(|(n, e)| f64::from(n) * 2f64.powi(e)),
        1 => prop::sample::select(vec![
            0.0, -0.0, f64::MIN_POSITIVE, f64::from_bits(1), -f64::from_bits(1), f64::MAX, f64::MIN, 1e-300, 1e300,
            f64::INFINITY, f64::NEG_INFINITY, 1.0 + f64::EPSILON, -1.0,
        ]),
    ]
}

fn interval() -> impl Strategy<Value = Interval> {
    prop_oneof![
        3 => (double(), double()).prop_map(|(a, b)| Interval::new(a, b)),
        1 => double().prop_map(Interval::point),
        2 => (double(), 0u64..4).prop_map(|(a, n)| Interval::new(a, (0..n).fold(a, |x, _| x.next_up()))),
    ]
}

/// An interval and rationals in it: its ends where they are finite, and some between.
fn inhabited() -> impl Strategy<Value = (Interval, Vec<RBig>)> {
    (interval(), 0.0..1.0f64).prop_map(|(all, t)| {
        let inner = all.lo.max(f64::MIN) * (1.0 - t) + all.hi.min(f64::MAX) * t;
        let numbers = [all.lo, all.hi, all.mid(), inner.clamp(all.lo, all.hi)];
        (all, numbers.into_iter().filter_map(rational_from_f64).collect())
    })
}

/// Whether an exact number lies in the interval.
fn holds(all: Interval, value: &RBig) -> bool {
    rational_from_f64(all.lo).is_none_or(|lo| lo <= *value)
        && rational_from_f64(all.hi).is_none_or(|hi| *value <= hi)
        && is_well_formed(all)
}

fn is_well_formed(all: Interval) -> bool {
    all.lo <= all.hi && all.lo < f64::INFINITY && all.hi > f64::NEG_INFINITY
}

/// The bound on the width: the doubles next to the exact ends, and one more.
fn is_tight(all: Interval, exact: &[RBig]) -> bool {
    let (Some(least), Some(greatest)) = (exact.iter().min(), exact.iter().max()) else { return true };
    let inner = Interval::from_rational(least).hull(Interval::from_rational(greatest));
    all.lo >= inner.lo.next_down() && all.hi <= inner.hi.next_up()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 10_000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn sums_products_and_quotients_enclose_the_exact_ones((a, xs) in inhabited(), (b, ys) in inhabited()) {
        let (sum, difference, product, quotient) = (a + b, a - b, a * b, a / b);
        for x in &xs {
            for y in &ys {
                prop_assert!(holds(sum, &(x + y)), "{a} + {b} = {sum}");
                prop_assert!(holds(difference, &(x - y)), "{a} - {b} = {difference}");
                prop_assert!(holds(product, &(x * y)), "{a} * {b} = {product}");
                if !y.is_zero() {
                    prop_assert!(holds(quotient, &(x / y)), "{a} / {b} = {quotient}");
                }
            }
        }
        prop_assert!(is_well_formed(sum) && is_well_formed(product) && is_well_formed(quotient));
        if RealNumber::is_finite(a) && RealNumber::is_finite(b) {
            let all = |f: &dyn Fn(&RBig, &RBig) -> RBig| -> Vec<RBig> {
                xs[..2].iter().flat_map(|x| ys[..2].iter().map(|y| f(x, y)).collect::<Vec<_>>()).collect()
            };
            prop_assert!(is_tight(sum, &all(&|x, y| x + y)), "{a} + {b} = {sum}");
            prop_assert!(is_tight(product, &all(&|x, y| x * y)), "{a} * {b} = {product}");
            if !b.contains_zero() {
                prop_assert!(is_tight(quotient, &all(&|x, y| x / y)), "{a} / {b} = {quotient}");
            }
        }
    }

    #[test]
    fn powers_enclose_the_exact_ones((a, xs) in inhabited(), n in 0u32..9) {
        let power = a.pow(n);
        for x in &xs {
            prop_assert!(holds(power, &x.pow(n as isize)), "{a}^{n} = {power}");
        }
        prop_assert!(n % 2 == 1 || power.lo >= 0.0);
    }

    #[test]
    fn a_rational_is_enclosed_by_neighbours(n in any::<i64>(), d in 1u64.., e in -1100i32..1100) {
        let scale = RBig::from(dashu::integer::IBig::ONE << e.unsigned_abs() as usize);
        let value = RBig::from_parts(n.into(), d.into());
        let value = if e < 0 { value / scale } else { value * scale };
        let all = Interval::from_rational(&value);
        prop_assert!(holds(all, &value));
        let is_double = rational_from_f64(all.lo).as_ref() == Some(&value);
        prop_assert_eq!(all.hi, if is_double { all.lo } else { all.lo.next_up() });
    }

    #[test]
    fn roots_enclose_the_exact_ones(a in interval()) {
        let a = a.abs();
        let root = a.image(Function::Sqrt).unwrap();
        prop_assert!(is_well_formed(root));
        let square = |x: f64| rational_from_f64(x).map(|x| &x * &x);
        prop_assert!(square(root.lo) <= rational_from_f64(a.lo));
        prop_assert!(rational_from_f64(a.hi).is_none_or(|hi| square(root.hi).is_none_or(|s| s >= hi)));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1_000, failure_persistence: None, ..ProptestConfig::default() })]

    /// At the ends and between them, for every function, on every interval in its domain.
    #[test]
    fn functions_enclose_the_exact_ones((a, xs) in inhabited()) {
        let wide = Enclosures::new(200);
        for function in Function::ALL {
            let Some(image) = a.image(function) else { continue };
            prop_assert!(is_well_formed(image));
            for x in &xs {
                if let Ok(value) = wide.apply(function, &wide.rational(x).unwrap()) {
                    prop_assert!(holds(image, &value.low()) && holds(image, &value.high()),
                        "{function:?} {a} = {image}, not {}", value.midpoint());
                }
            }
        }
    }
}

#[test]
fn exact_results_stay_points() {
    let p = Interval::point;
    assert_eq!(p(0.1) + p(0.0), p(0.1));
    assert_eq!(p(0.5) + p(0.25), p(0.75));
    assert_eq!(p(0.1) - p(0.1), Interval::ZERO);
    assert_eq!(Interval::new(-0.1, 0.3) * Interval::ZERO, Interval::ZERO);
    assert_eq!(Interval::new(-0.1, 0.3) * p(-2.0), Interval::new(-0.6, 0.2));
    assert_eq!(p(3.0) * p(5.0), p(15.0));
    assert_eq!(p(15.0) / p(5.0), p(3.0));
    assert_eq!(p(0.1) / p(4.0), p(0.025));
    assert_eq!(p(2.25).image(Function::Sqrt), Some(p(1.5)));
    assert_eq!(Interval::WHOLE * Interval::ZERO, Interval::ZERO);
}

#[test]
fn inexact_results_do_not() {
    let p = Interval::point;
    assert!((p(0.1) + p(0.2)).contains(0.3) && !(p(0.1) + p(0.2)).is_point());
    assert_eq!((p(1e-200) * p(1e-200)).low(), 0.0);
    assert_eq!((p(1e-200) * p(1e-200)).high(), f64::from_bits(1));
    assert_eq!((p(1e200) * p(1e200)), Interval::new(f64::MAX, f64::INFINITY));
    assert_eq!((p(f64::MAX) + p(f64::MAX)), Interval::new(f64::MAX, f64::INFINITY));
}

#[test]
fn what_is_not_known_is_the_whole_line_or_refused() {
    let straddling = Interval::new(-1.0, 2.0);
    assert_eq!(Interval::point(f64::NAN), Interval::WHOLE);
    assert_eq!(Interval::ONE / straddling, Interval::WHOLE);
    assert_eq!(Interval::ONE.quotient(straddling), Err(Refusal::DivisorNotSeparated));
    assert_eq!(Interval::ONE.quotient(Interval::ZERO), Err(Refusal::DivisionByZero));
    assert_eq!(straddling.power(-2), Err(Refusal::DivisorNotSeparated));
    assert_eq!(straddling.function(Function::Sqrt), Err(Refusal::OutsideDomain(Function::Sqrt)));
    assert_eq!(straddling.function(Function::Log), Err(Refusal::OutsideDomain(Function::Log)));
    assert_eq!(Interval::new(0.5, 1.5).function(Function::Acos), Err(Refusal::OutsideDomain(Function::Acos)));
    let all = Floats::<Interval>::new();
    assert_eq!(all.is_zero(&Interval::ZERO), Some(true));
    assert_eq!(all.is_zero(&straddling), None);
    assert_eq!(all.is_zero(&Interval::ONE), Some(false));
}

/// By hand: a square is never negative, sine and cosine turn at their crests, and only there.
#[test]
fn ranges_by_hand() {
    assert_eq!(Interval::new(-2.0, 3.0).sqr(), Interval::new(0.0, 9.0));
    assert_eq!(Interval::new(-2.0, 3.0).pow(3), Interval::new(-8.0, 27.0));
    assert_eq!(Interval::new(-2.0, 1.0).pow(4), Interval::new(0.0, 16.0));
    let sine = Interval::new(0.0, 3.0).image(Function::Sin).unwrap();
    assert_eq!((sine.lo, sine.hi), (0.0, 1.0));
    let cosine = Interval::new(3.0, 3.5).image(Function::Cos).unwrap();
    assert!(cosine.lo == -1.0 && cosine.contains(3.5f64.cos()) && cosine.hi < -0.93);
    let falling = Interval::new(2.0, 4.0).image(Function::Sin).unwrap();
    assert!(falling.contains(2f64.sin()) && falling.width() < 1.6662);
    assert_eq!(Interval::new(0.0, 7.0).image(Function::Sin), Some(Interval::new(-1.0, 1.0)));
    assert_eq!(Interval::new(0.0, f64::INFINITY).image(Function::Cos), Some(Interval::new(-1.0, 1.0)));
}

#[test]
fn halves_meet_in_the_middle() {
    let all = Interval::new(-1.0, f64::INFINITY);
    let (left, right) = all.split();
    assert_eq!((left.hull(right), left.intersection(right)), (all, Some(Interval::point(all.mid()))));
    assert_eq!(Interval::new(1.0, 2.0).intersection(Interval::new(3.0, 4.0)), None);
    assert_eq!((Interval::new(1.0, 4.0).mid(), Interval::new(1.0, 4.0).rad()), (2.5, 1.5));
    assert_eq!(Interval::new(-4.0, 1.0).mignitude(), 0.0);
}

/// Angles of every size, and those next to multiples of a right angle and of a 64th of half a turn.
fn angle() -> impl Strategy<Value = f64> {
    use std::f64::consts::PI;
    let aside = |x: f64, places: i32| {
        (0..places.abs()).fold(x, |x, _| if places < 0 { x.next_down() } else { x.next_up() })
    };
    prop_oneof![
        3 => -10.0..10.0f64,
        1 => -65536.0..65536.0f64,
        1 => -1e-3..1e-3f64,
        1 => (-40i32..40, 1.0..2.0f64).prop_map(|(e, x)| x * 2f64.powi(e)),
        1 => (40i32..1020, 1.0..2.0f64).prop_map(|(e, x)| x * 2f64.powi(e)),
        2 => (-40_000i32..40_000, -3i32..4).prop_map(move |(n, places)| aside(f64::from(n) * (PI / 2.0), places)),
        2 => (-4_000i32..4_000, -3i32..4).prop_map(move |(n, places)| aside(f64::from(n) * (PI / 128.0), places)),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1_500, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn sine_and_cosine_of_a_point_are_two_places_wide(x in angle()) {
        let wide = Enclosures::new(200);
        let (sin, cos) = Interval::point(x).sin_cos();
        for (found, function) in [(sin, Function::Sin), (cos, Function::Cos)] {
            let value = wide.apply(function, &wide.rational(&rational_from_f64(x).unwrap()).unwrap()).unwrap();
            prop_assert!(holds(found, &value.low()) && holds(found, &value.high()), "{function:?} {x:e} = {found:?}");
            // the least sines, next to whole right angles, to fifty bits or so
            let place = found.lo.abs().next_up() - found.lo.abs();
            prop_assert!(found.hi - found.lo <= (2.0 * place).max(1e-14 * found.lo.abs()).max(2f64.powi(-93)),
                "{function:?} {x:e} = {found:?}");
        }
    }

    #[test]
    fn sine_and_cosine_of_an_interval_are_its_values(a in angle(), width in prop_oneof![0.0..7.0f64, 0.0..1e-3f64], t in 0.0..1.0f64) {
        let all = Interval::new(a, a + width);
        let inner = (all.lo + t * width).clamp(all.lo, all.hi);
        let ((sin, cos), (s, c)) = (all.sin_cos(), Interval::point(inner).sin_cos());
        prop_assert!(sin.hi >= s.lo && sin.lo <= s.hi && cos.hi >= c.lo && cos.lo <= c.hi);
        // no wider than the slope allows, and monotone pieces end where their ends do
        let width = all.width();
        prop_assert!(sin.width() <= 1.0001 * width + 1e-15 && cos.width() <= 1.0001 * width + 1e-15);
        let turns = |shift: f64| ((all.lo / std::f64::consts::PI + shift).floor(), (all.hi / std::f64::consts::PI + shift).floor());
        let (low, high) = turns(0.5);
        if low == high && all.lo.abs() < 1e4 {
            let ends = Interval::point(all.lo).sin_cos().0.hull(Interval::point(all.hi).sin_cos().0);
            prop_assert!(sin == ends || (sin.hi == 1.0 && ends.hi > 1.0 - 1e-9) || (sin.lo == -1.0 && ends.lo < 1e-9 - 1.0));
        }
    }
}

/// A million points against double-doubles, whose error is below 2^-100.
#[test]
fn quick_sines_hold_the_precise_ones() {
    use rand::{RngExt, SeedableRng};
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(4);
    for _ in 0..500_000 {
        let size = 2f64.powi(rng.random_range(-30..16));
        let x = size * rng.random_range(-1.0..1.0);
        let (sin, cos) = Interval::point(x).sin_cos();
        let (s, c) = DoubleDouble::from(x).sin_cos();
        for (found, value) in [(sin, s), (cos, c)] {
            let inside = DoubleDouble::from(found.lo) <= value && value <= DoubleDouble::from(found.hi);
            assert!(inside, "{x:e}: {found:?} {value:?}");
        }
    }
}

#[test]
fn the_parts_of_pi_are_right() {
    let wide = Enclosures::new(300);
    let sum: RBig =
        circular::PARTS.iter().filter_map(|part| rational_from_f64(*part)).fold(RBig::ZERO, |a, b| a + b);
    let off = wide.pi().unwrap().low() / RBig::from(64) - sum;
    assert!(rational_to_f64(&off).abs() < 2f64.powi(-120));
    // the first two end 22 bits before a double does
    assert!(circular::PARTS[..2].iter().all(|part| part.to_bits() & ((1 << 22) - 1) == 0));
}
