//! Oracles: identities and ranks by hand, true and false; the primes below a thousand by division.

use super::super::doubt::Effort;
use super::super::listing::{Listing, Step};
use super::super::witness::{Sides, SidesRelation};
use super::{GivenSymbols, given_by, have_rank_of_at_most, vanish};
use dashu::rational::RBig;
use palmistry_math::number::Function;

/// A listing that is written down one operation after the other.
#[derive(Default)]
struct Written(Listing);

impl Written {
    fn step(&mut self, step: Step) -> usize {
        self.0.push(step).unwrap()
    }
    fn number(&mut self, value: i64) -> usize {
        self.step(Step::Constant(RBig::from(value)))
    }
    fn symbol(&mut self, name: &str) -> usize {
        self.step(Step::Symbol(name.to_owned()))
    }
    fn of(&mut self, function: Function, argument: usize) -> usize {
        self.step(Step::Apply(function, argument))
    }
    fn agree(&self, given: &GivenSymbols, left: usize, right: usize) -> bool {
        vanish(&self.0, given, &[(left, right)], &Effort::new(1 << 30)).unwrap()
    }
}

const NOTHING: GivenSymbols = GivenSymbols { symbols: Vec::new() };

#[test]
fn identities_and_what_is_none() {
    let mut all = Written::default();
    let (x, y) = (all.symbol("x"), all.symbol("y"));
    let (two, four, pi) = (all.number(2), all.number(4), all.step(Step::Pi));
    // (x + y)^2 - (x - y)^2 = 4 x y, and not 4 x
    let (sum, difference) = (all.step(Step::Add(x, y)), all.step(Step::Sub(x, y)));
    let (a, b) = (all.step(Step::Power(sum, 2)), all.step(Step::Power(difference, 2)));
    let left = all.step(Step::Sub(a, b));
    let right = all.step(Step::Mul(four, x));
    assert!(!all.agree(&NOTHING, left, right));
    let right = all.step(Step::Mul(right, y));
    assert!(all.agree(&NOTHING, left, right));
    // cos(x + y) = cos x cos y - sin x sin y
    let [sx, cx, sy, cy] = [(Function::Sin, x), (Function::Cos, x), (Function::Sin, y), (Function::Cos, y)]
        .map(|(function, of)| all.of(function, of));
    let cosine = all.of(Function::Cos, sum);
    let (cc, ss) = (all.step(Step::Mul(cx, cy)), all.step(Step::Mul(sx, sy)));
    let product = all.step(Step::Sub(cc, ss));
    assert!(all.agree(&NOTHING, cosine, product) && !all.agree(&NOTHING, cosine, cc));
    // cos x = 1 - 2 sin(x/2)^2, sin(x + pi/2) = cos x
    let half = all.step(Step::Div(x, two));
    let sine = all.of(Function::Sin, half);
    let square = all.step(Step::Power(sine, 2));
    let twice = all.step(Step::Mul(two, square));
    let one = all.number(1);
    let rest = all.step(Step::Sub(one, twice));
    assert!(all.agree(&NOTHING, cx, rest));
    let quarter = all.step(Step::Div(pi, two));
    let turned = all.step(Step::Add(x, quarter));
    let turned = all.of(Function::Sin, turned);
    assert!(all.agree(&NOTHING, turned, cx) && !all.agree(&NOTHING, turned, sx));
    // exp(2 x) = exp(x)^2, and not exp(x)
    let exponential = all.of(Function::Exp, x);
    let argument = all.step(Step::Mul(two, x));
    let (double, squared) = (all.of(Function::Exp, argument), all.step(Step::Power(exponential, 2)));
    assert!(all.agree(&NOTHING, double, squared) && !all.agree(&NOTHING, double, exponential));
    // a sine of something else is a variable: sin(x y) of the same product, however it is written
    let (xy, yx) = (all.step(Step::Mul(x, y)), all.step(Step::Mul(y, x)));
    let (first, second) = (all.of(Function::Sin, xy), all.of(Function::Sin, yx));
    assert!(all.agree(&NOTHING, first, second) && !all.agree(&NOTHING, first, sx));
    // a number that is a multiple of a prime is not zero
    let prime = all.number((1 << 61) - 1);
    let zero = all.number(0);
    assert!(!all.agree(&NOTHING, prime, zero));
    // a root has two values, of which one is meant: nothing is said
    let inner = all.step(Step::Mul(x, x));
    let root = all.of(Function::Sqrt, inner);
    assert!(!all.agree(&NOTHING, root, x));
}

#[test]
fn symbols_that_are_given() {
    let mut all = Written::default();
    let (x, y, z) = (all.symbol("x"), all.symbol("y"), all.symbol("z"));
    let one = all.number(1);
    let below = all.step(Step::Add(y, one));
    let quotient = all.step(Step::Div(y, below));
    let equal = |left, right| Sides { left, relation: SidesRelation::Equal, right };
    // x = y/(y + 1), z = x: then z (y + 1) = y
    let given = given_by(&all.0, &[equal(x, quotient), equal(x, z)], true).unwrap();
    let product = all.step(Step::Mul(z, below));
    assert!(all.agree(&given, product, y) && !all.agree(&NOTHING, product, y));
    // what would give itself, or is no symbol, gives nothing
    assert!(given_by(&all.0, &[equal(x, quotient), equal(below, x)], true).is_none());
    assert!(given_by(&all.0, &[equal(y, below)], true).is_none());
    assert!(given_by(&all.0, &[equal(below, one)], true).is_none());
    let closed = Sides { left: x, relation: SidesRelation::AtLeast, right: one };
    assert!(given_by(&all.0, &[closed], false).is_none() && given_by(&all.0, &[closed], true).is_some());
}

#[test]
fn ranks_are_no_greater() {
    let mut all = Written::default();
    let (x, y) = (all.symbol("x"), all.symbol("y"));
    let (sum, product, zero) = (all.step(Step::Add(x, y)), all.step(Step::Mul(x, y)), all.number(0));
    let square = all.step(Step::Power(y, 2));
    // the second row is y times the first one
    let rows = vec![vec![x, y, zero], vec![product, square, zero]];
    let holds = |rows: &[Vec<usize>], rank| {
        have_rank_of_at_most(&all.0, &NOTHING, rows, rank, &Effort::new(1 << 30)).unwrap()
    };
    assert!(holds(&rows, 1) && !holds(&rows, 0));
    let rows = vec![vec![x, y, zero], vec![product, sum, zero]];
    assert!(holds(&rows, 2) && !holds(&rows, 1));
}

/// `x^(2^60)` is too large for a prime to say anything.
#[test]
fn what_is_too_large_is_not_said() {
    let mut all = Written::default();
    let mut power = all.symbol("x");
    let first = all.step(Step::Mul(power, power));
    assert!(all.agree(&NOTHING, first, first));
    for _ in 0..60 {
        power = all.step(Step::Mul(power, power));
    }
    assert!(!all.agree(&NOTHING, power, power));
}

/// Numbers that double in length, and a sum with a divisor in each of its terms, take no room and are not said.
#[test]
fn sizes_that_double_take_no_room() {
    let mut all = Written::default();
    let x = all.symbol("x");
    let mut number = all.number(3);
    for _ in 0..50 {
        number = all.step(Step::Mul(number, number));
    }
    let product = all.step(Step::Mul(number, x));
    let sine = all.of(Function::Sin, product);
    assert!(!all.agree(&NOTHING, sine, sine));
    let mut sum = x;
    for n in 1..20_000 {
        let n = all.number(n);
        let below = all.step(Step::Add(x, n));
        let term = all.step(Step::Div(x, below));
        sum = all.step(Step::Add(sum, term));
    }
    assert!(!all.agree(&NOTHING, sum, sum));
}

#[test]
fn primes_are_prime() {
    for n in 0..1000u64 {
        let is_prime = n > 1 && (2..n).all(|divisor| n % divisor != 0);
        assert_eq!(super::point::is_prime(n), is_prime, "{n}");
    }
    // 2^61 - 1 is one, and the product of two near 2^30 is none
    assert!(super::point::is_prime((1 << 61) - 1) && !super::point::is_prime(1_073_741_827 * 1_073_741_831));
}
