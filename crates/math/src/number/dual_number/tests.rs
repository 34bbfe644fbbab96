//! The functions of the trait against those of the machine.

use super::*;

/// A function of the trait over two numbers.
type Pair<T> = (fn(&T) -> T, fn(&f64) -> f64);

/// At a few points, against the functions of the machine, with no claim on more than their digits.
#[test]
fn every_function_of_the_trait_is_the_one_it_is_called() {
    fn agree<T: DualNum<Primitive = f64> + Copy>(near: impl Fn(T, f64) -> bool) {
        for x in [0.3, 0.75, 1.0, 2.5, -0.6, 7.0] {
            let functions: [Pair<T>; 18] = [
                (T::cbrt, f64::cbrt_),
                (T::exp, DualNum::exp),
                (T::exp2, DualNum::exp2),
                (T::exp_m1, DualNum::exp_m1),
                (T::sin, DualNum::sin),
                (T::cos, DualNum::cos),
                (T::tan, DualNum::tan),
                (T::atan, DualNum::atan),
                (T::sinh, DualNum::sinh),
                (T::cosh, DualNum::cosh),
                (T::tanh, DualNum::tanh),
                (T::asinh, DualNum::asinh),
                (T::recip, DualNum::recip),
                (|x| x.powi(-3), |x| x.powi(-3)),
                (|x| x.powi(5), |x| x.powi(5)),
                (|x| x.atan2(T::from(-2.0)), |x| x.atan2(-2.0)),
                (|x| T::from(-1.5).atan2(*x), |x| (-1.5f64).atan2(*x)),
                (|x| *x % T::from(0.55), |x| x % 0.55),
            ];
            for (number, (ours, theirs)) in functions.into_iter().enumerate() {
                assert!(near(ours(&T::from(x)), theirs(&x)), "function {number} at {x}");
            }
            // the machine's closed form cancels near zero, where that of order two takes 3/x^3 times the sine
            let cancels = |x: f64| 1.0 + 10.0 / (x * x * f64::abs(x));
            let bessel: [Pair<T>; 3] =
                [(T::sph_j0, DualNum::sph_j0), (T::sph_j1, DualNum::sph_j1), (T::sph_j2, DualNum::sph_j2)];
            for (ours, theirs) in bessel {
                let scale = T::from(cancels(x).recip());
                assert!(near(ours(&T::from(x)) * scale, theirs(&x) / cancels(x)), "Bessel at {x}");
            }
            let positive: [Pair<T>; 6] = [
                (T::sqrt, DualNum::sqrt),
                (T::ln, DualNum::ln),
                (T::log2, DualNum::log2),
                (T::log10, DualNum::log10),
                (T::ln_1p, DualNum::ln_1p),
                (|x| x.powf(1.7), |x| x.powf(1.7)),
            ];
            for (number, (ours, theirs)) in positive.into_iter().enumerate() {
                let x = f64::abs(x);
                assert!(near(ours(&T::from(x)), theirs(&x)), "positive {number} at {x}");
            }
        }
        for x in [0.3, -0.75] {
            assert!(near(T::from(x).asin(), x.asin()) && near(T::from(x).acos(), x.acos()));
            assert!(
                near(T::from(x).atanh(), x.atanh()) && near(T::from(1.0 - x).log(3.0), (1.0 - x).log(3.0))
            );
            assert!(near(T::from(2.0 + x).acosh(), (2.0 + x).acosh()));
        }
    }
    trait CubeRoot {
        fn cbrt_(&self) -> f64;
    }
    impl CubeRoot for f64 {
        fn cbrt_(&self) -> f64 {
            f64::cbrt(*self)
        }
    }
    let close = |x: f64, y: f64| (x - y).abs() <= 1e-14 * y.abs().max(1.0);
    agree::<DoubleDouble>(|ours, theirs| close(ours.hi(), theirs));
    agree::<Interval>(|ours, theirs| close(ours.low(), theirs) && close(ours.high(), theirs));
}

#[test]
fn numbers_are_read_without_loss() {
    let third = <DoubleDouble as Num>::from_str_radix("1/3", 10).unwrap();
    assert_eq!(third, DoubleDouble::ONE / DoubleDouble::from(3.0));
    let large = <Interval as FromPrimitive>::from_i64(i64::MAX).unwrap();
    assert!(!large.is_point() && large.contains(2f64.powi(63)));
    assert!(<Interval as Num>::from_str_radix("11", 2).is_err());
}
