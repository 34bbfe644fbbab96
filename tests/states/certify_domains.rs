//! Certificates where terms do not exist: what the graph simplifies away guards the box all the same. Poles and edges of
//! domains are known by construction, so that exact points on them are the oracle: none may lie in a proved box.

use dashu::rational::RBig;
use palmistry::System;
use palmistry::certificate::{BoxStanding, Limits, Region, RegionAnswer, RegionRows};
use palmistry::expression::Symbol;
use palmistry::number::{Interval, RealNumber};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::collections::BTreeMap;
use std::f64::consts::FRAC_PI_2;
use std::path::Path;

const ALL: RegionRows = RegionRows::Codistribution(None);

fn system(text: &str) -> System {
    System::parse("test.proof", &format!("system \"test\" {text}"), Path::new("")).unwrap()
}

fn ratio(top: i64, bottom: i64) -> RBig {
    RBig::from(top) / RBig::from(bottom)
}

/// The region of a system after some boxes, its sample box or another.
fn searched(
    system: &mut System,
    rows: RegionRows,
    given: &[(&str, RBig, RBig)],
    boxes: u64,
) -> (Region, RegionAnswer) {
    let given: BTreeMap<Symbol, (RBig, RBig)> = given
        .iter()
        .map(|(name, low, high)| (system.find_symbol(name).unwrap(), (low.clone(), high.clone())))
        .collect();
    let mut region = Region::new(system, rows, &given, None).unwrap();
    region.run(Limits { seconds: None, boxes: Some(boxes) }, &false.into(), &|_| ());
    let answer = region.answer();
    (region, answer)
}

/// Whether a state, given by enclosures of its coordinates, lies in proved boxes only.
fn is_proved(system: &System, region: &Region, at: &[(&str, Interval)]) -> bool {
    let value = |symbol: Symbol| {
        at.iter().find(|(name, _)| *name == system.symbol_name(symbol)).map(|(_, value)| *value)
    };
    let standing = region.standing(value);
    assert!(standing.is_some(), "the state lies in the box: {at:?}");
    standing == Some(BoxStanding::Proved)
}

/// A pole or an edge that nothing of the simplified rows shows any more: a text, the rows, what is proved at most and at
/// least, and a state that must not be.
struct Hidden {
    text: &'static str,
    rows: RegionRows,
    at_least: f64,
    at_most: f64,
    state: Vec<(&'static str, Interval)>,
}

const HALF_TURN: Interval = Interval::PI;

#[test]
fn what_was_simplified_away_guards_the_box() {
    let own = RegionRows::Own;
    let zero = || vec![("x", Interval::ZERO)];
    let half_turn = || vec![("phi", HALF_TURN)];
    // half-angle tangents cancel, quotients cancel, roots are unwound, products with zero vanish
    for Hidden { text, rows, at_least, at_most, state } in [
        Hidden {
            text: "state phi angle phi output sin(phi)\nlet rows = [2 + sin(phi)/(1 + cos(phi))]\nsample phi in [3, 4]",
            rows: own,
            at_least: 0.99,
            at_most: 0.999_999_999_9,
            state: half_turn(),
        },
        Hidden {
            text: "state phi angle phi output sin(phi)\nlet rows = [3 + tan(phi)*cos(phi)]\nsample phi in [-7, 7]",
            rows: own,
            at_least: 0.99,
            at_most: 0.999_999_999_9,
            state: vec![("phi", Interval::new(FRAC_PI_2, FRAC_PI_2.next_up()))],
        },
        Hidden {
            text: "state x output x\nlet rows = [x/x]\nsample x in [-1, 1]",
            rows: own,
            at_least: 0.99,
            at_most: 0.999_999_999_9,
            state: zero(),
        },
        // what vanishes by the square of a root is no minor
        Hidden {
            text: "state x drift f x' = 1 output sqrt(x^2)\nsample x in [-1, 1]",
            rows: ALL,
            at_least: 0.99,
            at_most: 0.999_999_999_9,
            state: zero(),
        },
        Hidden {
            text: "state x drift f x' = 1 output sqrt((x - 1)^2)\nsample x in [-1, 1]",
            rows: ALL,
            at_least: 0.99,
            at_most: 0.999_999_999_99,
            state: vec![("x", Interval::ONE)],
        },
        // at the very end of the box
        Hidden {
            text: "state x output x\nlet rows = [x/x]\nsample x in [0, 1]",
            rows: own,
            at_least: 0.99,
            at_most: 0.999_999_999_9,
            state: zero(),
        },
        Hidden {
            text: "state x output x\nlet a = x/x\nlet b = 1 + 0*a\nlet rows = [b]\nsample x in [-1, 1]",
            rows: own,
            at_least: 0.99,
            at_most: 0.999_999_999_9,
            state: zero(),
        },
        Hidden {
            text: "state x output x\nlet rows = [2 + 0*log(x)]\nsample x in [-1, 1]",
            rows: own,
            at_least: 0.49,
            at_most: 0.5,
            state: zero(),
        },
        Hidden {
            text: "state x output x\nlet rows = [2 + 0*acos(x)]\nsample x in [-2, 2]",
            rows: own,
            at_least: 0.49,
            at_most: 0.5,
            state: vec![("x", Interval::new(1.001, 1.001))],
        },
        // zero is allowed under a root of rows that need only exist, and there the row exists
        Hidden {
            text: "state x output x\nlet rows = [2 + 0*sqrt(x)]\nsample x in [-1, 1]",
            rows: own,
            at_least: 0.49,
            at_most: 0.5,
            state: vec![("x", Interval::new(-1e-6, -1e-6))],
        },
        Hidden {
            text: "state x drift f x' = 0 output sqrt(x)^2\nsample x in [-1, 1]",
            rows: ALL,
            at_least: 0.49,
            at_most: 0.5,
            state: zero(),
        },
        Hidden {
            text: "state x drift f x' = 0 output 1/(1/x)\nsample x in [-1, 1]",
            rows: ALL,
            at_least: 0.99,
            at_most: 0.999_999_999_9,
            state: zero(),
        },
        Hidden {
            text: "state x drift f x' = x*x/x output x\nsample x in [-1, 1]",
            rows: ALL,
            at_least: 0.99,
            at_most: 0.999_999_999_9,
            state: zero(),
        },
        // own rows, of a system that is not defined
        Hidden {
            text: "state x drift f x' = 0 output x + 0/x\nlet rows = [1]\nsample x in [-1, 1]",
            rows: own,
            at_least: 0.99,
            at_most: 0.999_999_999_9,
            state: zero(),
        },
        // no product of polynomials: a divisor that is looked at as it is written
        Hidden {
            text: "state x output x\nlet rows = [1 + 0/(exp(x) - 1)]\nsample x in [-1, 1]",
            rows: own,
            at_least: 0.99,
            at_most: 0.999_999_999_9,
            state: zero(),
        },
        Hidden {
            text: "state x, phi angle phi output x\nlet rows = [1, 0; 0, 1 + 0/(phi - 3)]\nsample x in [0, 1] phi in [2, 4]",
            rows: own,
            at_least: 0.99,
            at_most: 0.999_999_999_9,
            state: vec![("x", Interval::ONE), ("phi", Interval::new(3.0, 3.0))],
        },
        // differentiated rows divide by more than was written
        Hidden {
            text: "state x drift f x' = 0 output x\nlet rows = d(sqrt(x)^3) + d(x)\nsample x in [-1, 1]",
            rows: own,
            at_least: 0.49,
            at_most: 0.5,
            state: vec![("x", Interval::new(-0.5, -0.5))],
        },
    ] {
        let mut system = system(text);
        let (region, answer) = searched(&mut system, rows, &[], 3000);
        assert!((at_least..=at_most).contains(&answer.proved), "{text}: {}", answer.proved);
        assert!(!is_proved(&system, &region, &state), "{text}");
    }
}

/// What exists nowhere has no rank anywhere, and the answer says why.
#[test]
fn of_what_exists_nowhere_nothing_is_proved() {
    for (text, rows, given) in [
        (
            "state x output x\nlet rows = [1 + 0/((x + 1)^2 - x^2 - 2*x - 1)]\nsample x in [-1, 1]",
            RegionRows::Own,
            None,
        ),
        ("state x output x\nlet rows = [1 + (x - x)/(x - x)]\nsample x in [-1, 1]", RegionRows::Own, None),
        ("state x output x\nlet rows = [1 + 0*sqrt(0 - 1)]\nsample x in [-1, 1]", RegionRows::Own, None),
        ("state x output x\nlet rows = [2 + 0*acos(2)]\nsample x in [-1, 1]", RegionRows::Own, None),
        (
            "state phi angle phi output sin(phi)\nlet rows = [1 + 0/(sin(phi)^2 + cos(phi)^2 - 1)]\nsample phi in [1, 2]",
            RegionRows::Own,
            None,
        ),
        ("state x drift f x' = 0 output x + 0/(x - x)\nsample x in [-1, 1]", ALL, None),
        // a parameter that is held at a pole, and a state
        ("state x param k = 0 drift f x' = 0 output x + 0/k\nsample x in [-1, 1]", ALL, None),
        ("state x param k = 1 drift f x' = 0 output x*k/k\nsample x in [-1, 1]", ALL, Some(("k", 0))),
        ("state x output x\nlet rows = [x/x]\nsample x in [-1, 1]", RegionRows::Own, Some(("x", 0))),
    ] {
        let mut system = system(text);
        let given: Vec<(&str, RBig, RBig)> =
            given.into_iter().map(|(name, value)| (name, ratio(value, 1), ratio(value, 1))).collect();
        if rows == ALL && !text.contains("0/k") {
            // not even words of Lie derivatives can be chosen
            let whole: BTreeMap<Symbol, (RBig, RBig)> = given
                .iter()
                .map(|(n, l, h)| (system.find_symbol(n).unwrap(), (l.clone(), h.clone())))
                .collect();
            let refused = Region::new(&mut system, rows, &whole, None).err().unwrap_or_default();
            assert!(refused.contains("every state"), "{text}: {refused}");
            continue;
        }
        let (region, answer) = searched(&mut system, rows, &given, 3000);
        assert_eq!((answer.proved, answer.proved_of_sampled, answer.rest), (0.0, 0.0, 1.0), "{text}");
        assert!(!answer.nowhere.is_empty() && region.is_finished(), "{text}: {answer:?}");
        assert!(palmistry::report::region_text(&answer).contains("nothing is proved"), "{text}");
    }
    // a zero that only interval arithmetic meets is nowhere shown to be one, and nowhere shown not to be
    let mut hidden = system("state x output x\nlet rows = [1 + 0/(exp(x)*exp(-x) - 1)]\nsample x in [-1, 1]");
    assert_eq!(searched(&mut hidden, RegionRows::Own, &[], 3000).1.proved, 0.0);
}

/// A constant output has no differential: no rows, and no rank.
#[test]
fn of_no_rows_nothing_is_proved() {
    for text in [
        "state x, y drift f x' = y y' = x output 3\nsample x in [-1, 1] y in [-1, 1]",
        "state x drift f x' = 0 output 1, 2\nsample x in [-1, 1]",
        "state x drift f x' = x output x - x\nsample x in [-1, 1]",
    ] {
        let (_, answer) = searched(&mut system(text), ALL, &[], 1000);
        assert_eq!((answer.proved, answer.minors.len()), (0.0, 0), "{text}");
    }
}

/// A sign that changes at a pole is no zero, and a slope of one sign on both sides of a pole does not make a function
/// monotone: `exp(1/x) = 1/20` at `x = -1/ln(20)`, in a box that has the pole of `1/x` in it at first.
#[test]
fn nothing_is_concluded_across_a_pole() {
    let text = "state x, y drift f x' = 0 y' = 0 output x, y*(exp(x^(-1)) - 1/20)
                sample x in [-1, 3/2] y in [1, 2]";
    let mut system = system(text);
    let (region, answer) = searched(&mut system, ALL, &[], 3000);
    assert!(answer.proved > 0.99 && answer.proved < 1.0, "{}", answer.proved);
    let zero = Interval::point(-1.0) / Interval::point(20.0).image(palmistry::number::Function::Log).unwrap();
    assert!(!is_proved(&system, &region, &[("x", zero), ("y", Interval::new(1.5, 1.5))]));
    assert!(!is_proved(&system, &region, &[("x", Interval::ZERO), ("y", Interval::new(1.5, 1.5))]));
}

/// A journal is taken up by the question that it was written for, also where another one has the same operations on
/// other functions of the coordinates: `x` has no zero on [2, 4], and `sin(x)` has.
#[test]
fn a_journal_of_another_function_is_refused() {
    let text = |factor: &str| {
        format!("state x, y drift f x' = 0 y' = 0 output x, y*{factor}\nsample x in [2, 4] y in [1, 2]")
    };
    let (region, answer) = searched(&mut system(&text("x")), ALL, &[], 100);
    assert_eq!(answer.proved, 1.0);
    let saved = region.saved();
    let mut other = Region::new(&mut system(&text("sin(x)")), ALL, &BTreeMap::new(), None).unwrap();
    let refused = other.resume(&saved).unwrap_err();
    assert!(refused.contains("another question"), "{refused}");
    let mut same = Region::new(&mut system(&text("x")), ALL, &BTreeMap::new(), None).unwrap();
    same.resume(&saved).unwrap();
    assert_eq!(same.proved(), 1.0);
}

/// Ends of ranges that doubles do not hold, and an empty range.
#[test]
fn ranges_at_the_edge_of_the_numbers() {
    let text = "state x output x\nlet rows = [x/x + 1]\nsample x in [0, 1]";
    let huge: RBig = palmistry::number::parse_decimal("1e400").unwrap();
    let (region, answer) =
        searched(&mut system(text), RegionRows::Own, &[("x", -huge.clone(), huge.clone())], 300);
    assert!(answer.proved < 1.0);
    assert!(!is_proved(&system(text), &region, &[("x", Interval::ZERO)]));
    let mut empty = system(text);
    let x = empty.find_symbol("x").unwrap();
    let given = BTreeMap::from([(x, (ratio(2, 1), ratio(1, 1)))]);
    assert!(Region::new(&mut empty, RegionRows::Own, &given, None).is_err());
}

/// One random term that exists on a part of the square only, with exact points at which it does not.
struct Term {
    text: String,
    missing: Vec<[RBig; 2]>,
}

/// `x` and `y` on a grid of the square from -1 to 1.
fn grid() -> Vec<[RBig; 2]> {
    let step = |i: i64| ratio(i, 12);
    (-12..=12).flat_map(|i| (-12..=12).map(move |j| [step(i), step(j)])).collect()
}

fn random_term(rng: &mut ChaCha8Rng) -> Term {
    let mut small = |most: i64| rng.random_range(-most..=most);
    let (a, b, c) = (small(11), small(11), small(3));
    let (p, q) = (ratio(a, 12), ratio(b, 12));
    // a polynomial of which the sign at rational points is exact
    type Value = Box<dyn Fn(&RBig, &RBig) -> RBig>;
    let (base, value): (String, Value) = match rng.random_range(0..5) {
        0 => (format!("(x - ({a}/12))"), Box::new(move |x, _| x - &p)),
        1 => (format!("(x - ({a}/12))*(y - ({b}/12))"), Box::new(move |x, y| (x - &p) * (y - &q))),
        2 => (format!("(x - y + ({a}/12))"), Box::new(move |x, y| x - y + &p)),
        3 => (format!("(x^2 + y^2 - ({a}/12)^2)"), Box::new(move |x, y| x * x + y * y - &p * &p)),
        _ => (
            format!("(x^2 - ({b}/12)^2 + ({c})*(x - ({b}/12)))"),
            Box::new(move |x, _| x * x - &q * &q + RBig::from(c) * (x - &q)),
        ),
    };
    let zero = RBig::ZERO;
    let (text, exists): (String, fn(&RBig, &RBig) -> bool) = match rng.random_range(0..7) {
        0 => (format!("({base})/({base})"), |v, zero| v != zero),
        1 => (format!("0/({base})"), |v, zero| v != zero),
        2 => (format!("0*1/(1/({base}))"), |v, zero| v != zero),
        3 => (format!("0*sqrt({base})^2"), |v, zero| v >= zero),
        4 => (format!("0*log({base})"), |v, zero| v > zero),
        5 => (format!("0*({base})^(-2)"), |v, zero| v != zero),
        _ => (format!("0*asin({base} - 1)"), |v, zero| v >= zero && *v <= RBig::from(2)),
    };
    let missing = grid().into_iter().filter(|[x, y]| !exists(&value(x, y), &zero)).collect();
    Term { text, missing }
}

/// Random rows and outputs with poles and edges known by construction, and a determinant with a zero: none of these points
/// lies in a proved box, and what is far from all of them is proved.
#[test]
fn no_proved_box_holds_a_point_that_is_known_to_be_missing() {
    let seed = 0x9e37_79b9;
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let (mut looked_at, mut proved_in_all, mut cases) = (0, 0.0, 0);
    for case in 0..60 {
        let (first, second) = (random_term(&mut rng), random_term(&mut rng));
        let drop = ratio(rng.random_range(-11..=11), 12);
        let own = rng.random_range(0..2) == 0;
        let text = if own {
            format!(
                "state x, y output x\nlet rows = [1 + {}, 0; y, (x - ({drop}))*(2 + 0*({}))]
                 sample x in [-1, 1] y in [-1, 1]",
                first.text, second.text
            )
        } else {
            format!(
                "state x, y drift f x' = {} y' = 0 output x + 0*({}), (x - ({drop}))*y
                 sample x in [-1, 1] y in [-1, 1]",
                first.text, second.text
            )
        };
        let mut system = system(&text);
        let rows = if own { RegionRows::Own } else { RegionRows::Codistribution(Some(0)) };
        let (region, answer) = searched(&mut system, rows, &[], 1500);
        let dropped = grid().into_iter().filter(|[x, _]| *x == drop);
        for [x, y] in first.missing.iter().chain(&second.missing).cloned().chain(dropped) {
            let at = [("x", Interval::from_rational(&x)), ("y", Interval::from_rational(&y))];
            assert!(!is_proved(&system, &region, &at), "seed {seed} case {case}: {text}\n at {x}, {y}");
            looked_at += 1;
        }
        proved_in_all += answer.proved;
        cases += 1;
    }
    assert!(looked_at > 5000, "the test has looked at something: {looked_at}");
    assert!(proved_in_all > 0.3 * f64::from(cases), "and something was proved: {proved_in_all} of {cases}");
}

/// The same for angles: what vanishes at multiples of a quarter turn, in ranges longer than a turn too.
#[test]
fn no_proved_box_holds_an_angle_that_is_known_to_be_a_pole() {
    // the poles among the quarter turns, by quarters modulo four
    let terms: [(&str, &[i64]); 8] = [
        ("sin(phi)/sin(phi)", &[0, 2]),
        ("tan(phi)*cos(phi)", &[1, 3]),
        ("0*sin(phi)/(1 + cos(phi))", &[2]),
        ("0*(1 - cos(phi))/sin(phi)", &[0, 2]),
        ("0/(1 - cos(phi))", &[0]),
        ("0*cot(2*phi)", &[0, 1, 2, 3]),
        ("0/(1 + sin(phi))", &[3]),
        ("1/(1/(1 + cos(phi))) - cos(phi)", &[2]),
    ];
    for (term, poles) in terms {
        for (low, high) in [(-7, 7), (3, 4), (-4, 1), (0, 13)] {
            let text = format!(
                "state x, phi angle phi output x\nlet rows = [2 + 0*({term}), sin(phi); 0, x]\nsample x in [1, 2] phi in [{low}, {high}]"
            );
            let mut system = system(&text);
            let (region, answer) = searched(&mut system, RegionRows::Own, &[], 3000);
            assert!(answer.proved > 0.9, "{text}: {}", answer.proved);
            let mut seen = 0;
            for quarter in -4i64..=8 {
                let angle = Interval::pi() * Interval::point(quarter as f64 * 0.5);
                let inside = f64::from(low) < angle.low() && angle.high() < f64::from(high);
                if inside && poles.contains(&quarter.rem_euclid(4)) {
                    let at = [("x", Interval::new(1.3, 1.3)), ("phi", angle)];
                    assert!(!is_proved(&system, &region, &at), "{text} at {quarter} quarter turns");
                    seen += 1;
                }
            }
            assert!(seen > 0 || high - low == 1 && !poles.contains(&2), "{text}");
        }
    }
}
