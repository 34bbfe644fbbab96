//! Full rank on whole regions: what is called proved is true, and what is true is mostly proved.

use crate::common::{folder, json, palmistry, with_threads, without_times, write};
use crate::picture::Picture;
use dashu::rational::RBig;
use palmistry::System;
use palmistry::certificate::{BoxStanding, Limits, Progress, Region, RegionAnswer, RegionRows};
use palmistry::expression::Symbol;
use palmistry::expression::{Program, expand_angles};
use palmistry::number::{Interval, Rationals, RealNumber};
use palmistry::observability::{Branch, Codistribution, Coordinate, Length, Locus, rank};
use palmistry::system::Assignment;
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

const SAME_RATE: &str = "proofs/moll2002/same_rate.proof";
const ONE_PALM_FIXED: &str = "proofs/moll2002/one_palm_fixed.proof";
const FIXED_PALMS: &str = "proofs/moll2002/fixed_palms.proof";
const GENERAL: &str = "proofs/moll2002/general.proof";

fn certify(arguments: &[&str]) -> Value {
    let output = palmistry(&[&["certify"], arguments, &["--json"]].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    json(&output)
}

fn fraction(found: &Value) -> f64 {
    found["proved_fraction"].as_f64().unwrap()
}

/// A system without a name, from its text.
fn system(text: &str) -> System {
    System::parse("test.proof", &format!("system \"test\" {text}"), Path::new("")).unwrap()
}

/// The region of a system after some boxes.
fn searched(system: &mut System, rows: RegionRows, boxes: u64) -> (Region, RegionAnswer) {
    let mut region = Region::new(system, rows, &BTreeMap::new(), None).unwrap();
    region.run(Limits { seconds: None, boxes: Some(boxes) }, &false.into(), &|_| ());
    let answer = region.answer();
    let sum = answer.proved + answer.minor_vanishes + answer.rest;
    assert!((sum - 1.0).abs() < 1e-12, "the three parts are the whole: {sum}");
    (region, answer)
}

const ALL: RegionRows = RegionRows::Codistribution(None);

/// The aim of the method on the thesis's regimes of three to five free coordinates.
#[test]
fn nearly_all_of_the_small_regimes_is_proved() {
    for (file, free, at_least) in
        [(SAME_RATE, 2, 0.999_999), (ONE_PALM_FIXED, 3, 0.999), (FIXED_PALMS, 5, 0.995)]
    {
        let found = certify(&[file, "--boxes", "60000"]);
        assert!(fraction(&found) > at_least, "{file}: {}", fraction(&found));
        assert!(found["proved_fraction_of_sampled"].as_f64().unwrap() > at_least, "{file}");
        assert_eq!(found["free_coordinates"].as_array().unwrap().len(), free, "{file}");
    }
}

/// The ten states: two parts of six and three coordinates instead of one of nine. Palms' accelerations and the inclination
/// of palm 1 do not matter.
#[test]
fn most_of_the_ten_state_regime_is_proved() {
    let found = certify(&[GENERAL, "--boxes", "200000"]);
    assert!(fraction(&found) > 0.7, "{}", fraction(&found));
    assert_eq!(found["without_effect"], json!(["phi1", "alpha1", "alpha2"]));
    let curve: Vec<f64> =
        found["curve"].as_array().unwrap().iter().map(|p| p["proved_fraction"].as_f64().unwrap()).collect();
    assert!(curve.windows(2).all(|pair| pair[0] <= pair[1]), "the fraction grows");
    assert_eq!(curve.last().copied(), Some(fraction(&found)));
}

/// No state that exact arithmetic finds short of rank lies in a proved box: not among those drawn from the sample box,
/// nor among those drawn from the sets on which the thesis's own rows fail.
#[test]
fn proved_boxes_hold_no_counterexample_among_drawn_states() {
    for (file, conditions) in [
        (SAME_RATE, vec!["", "omega0 = 0", "r1 = r2"]),
        (FIXED_PALMS, vec!["", "d1 = 0", "d2 = 0"]),
        (ONE_PALM_FIXED, vec!["", "bracket = 0"]),
    ] {
        let mut system = System::read(Path::new(file)).unwrap();
        for rows in [ALL, RegionRows::Own] {
            let (region, answer) = searched(&mut system, rows, 20_000);
            assert!(answer.proved > 0.5, "{file}: {}", answer.proved);
            let mut proved = 0;
            for condition in &conditions {
                for (state, exact) in drawn(&mut system, rows, condition, 150) {
                    if region.standing(|symbol| enclosed(&state, symbol)) == Some(BoxStanding::Proved) {
                        assert_eq!(exact, system.states.len(), "{file} {condition} {state:?}");
                        proved += 1;
                    }
                }
            }
            assert!(proved > 100, "{file}: the test has looked at something: {proved}");
        }
    }
}

type Drawn = (BTreeMap<Symbol, Coordinate>, usize);

/// States of the sample box that meet a condition, and the exact rank of the rows there.
fn drawn(system: &mut System, rows: RegionRows, condition: &str, count: u64) -> Vec<Drawn> {
    let mut branch = Branch::default();
    if !condition.is_empty() {
        let equation = palmistry::observability::parse_condition(condition).unwrap();
        branch = palmistry::observability::solve_conditions(system, &equation).unwrap().remove(0);
    }
    let entries = match (rows, system.definition("rows").cloned()) {
        (RegionRows::Own, Some(palmistry::system::Value::Matrix(matrix))) => matrix.entries,
        _ => {
            let longest =
                Codistribution::new(system, &Assignment::new(), Length::UntilItStops).unwrap().order + 1;
            Codistribution::new(system, &Assignment::new(), Length::Exactly(longest)).unwrap().entries()
        }
    };
    let locus = Locus::new(system, &branch, &BTreeMap::new(), &entries).unwrap();
    let is_angle = &system.angle_test();
    let entries = expand_angles(&mut system.graph, &entries, is_angle);
    let program = Program::new(&system.graph, &entries, is_angle);
    let exact = Rationals::default();
    let loaded = program.load(exact).unwrap();
    let columns = system.states.len();
    (0..count)
        .filter_map(|index| {
            let state = locus.draw(7, index).unwrap();
            let inputs = state.inputs(&program, &exact).unwrap();
            let values = loaded.run(&inputs, &mut Vec::new()).ok()?; // a pole has no rank
            let matrix = values.chunks(columns).map(<[RBig]>::to_vec).collect();
            Some((state.values, rank(&exact, matrix).unwrap()))
        })
        .collect()
}

/// A coordinate as an interval; angles by the arc tangent, with room for its rounding.
fn enclosed(state: &BTreeMap<Symbol, Coordinate>, symbol: Symbol) -> Option<Interval> {
    Some(match state.get(&symbol)? {
        Coordinate::Number(value) => Interval::from_rational(value),
        angle => Interval::point(angle.to_f64()) + Interval::new(-1e-14, 1e-14),
    })
}

/// The rank drops where y = x^3 - x and nowhere else: every rational point of that curve is outside of the proved boxes,
/// and in every box in which a minor is said to vanish the determinant has both signs at corners, exactly.
#[test]
fn a_curve_on_which_the_rank_drops_is_left_out_everywhere() {
    // the differential of z y - z x^3 + z x by z, with x and y seen
    let mut system = system(
        "state x, y, z drift f x' = 0 y' = 0 z' = 0 output x, y, z*(y - x^3 + x)
         sample x in [-2, 2] y in [-2, 2] z in [1, 2]",
    );
    let (region, answer) = searched(&mut system, ALL, 20_000);
    assert!(answer.proved > 0.99 && answer.rest < 0.01, "{answer:?}");
    let (x, y) = (system.find_symbol("x").unwrap(), system.find_symbol("y").unwrap());
    let ratio = |top: i64, bottom: i64| RBig::from(top) / RBig::from(bottom);
    let mut seen = 0;
    for step in -6000i64..=6000 {
        let a = ratio(step, 3001);
        let b = &a * &a * &a - &a;
        let at = |symbol: Symbol| {
            let value = if symbol == x {
                &a
            } else if symbol == y {
                &b
            } else {
                &RBig::ONE
            };
            Some(Interval::from_rational(value))
        };
        if let Some(standing) = region.standing(at) {
            assert_ne!(standing, BoxStanding::Proved, "x = {a}");
            seen += 1;
        }
    }
    assert!(seen > 8000);
    let vanishing: Vec<_> =
        answer.largest.iter().filter(|b| b.standing == BoxStanding::MinorVanishes).collect();
    assert!(!vanishing.is_empty());
    for open in vanishing {
        let exact = |value: f64| palmistry::number::rational_from_f64(value).unwrap();
        let side = |name: &str| {
            let found =
                open.ranges.iter().find(|range| range.name == *name).map(|range| (range.low, range.high));
            let (low, high) = found.unwrap_or((-2.0, 2.0)); // binary fractions throughout: the ends are exact
            [exact(low), exact(high)]
        };
        let mut signs = Vec::new();
        for a in side("x") {
            for b in side("y") {
                signs.push(b > &a * &a * &a - &a);
            }
        }
        assert!(signs.contains(&true) && signs.contains(&false), "{open:?}");
    }
}

/// Where the drop is a single point of the plane nothing is lost but boxes around it: x^2 + y^2 is not zero elsewhere.
#[test]
fn squares_are_recognised() {
    let mut system = system(
        "state x, y, z drift f x' = 0 y' = 0 z' = 0 output x, y, z*(x^2 + x*y + y^2)
         sample x in [-1, 2] y in [-1, 2] z in [1, 2]",
    );
    let (_, answer) = searched(&mut system, ALL, 400);
    assert!(answer.proved > 0.999, "{}", answer.proved);
}

/// Known to be unobservable: nothing is proved, not even a little.
#[test]
fn of_an_unobservable_system_nothing_is_proved() {
    for text in [
        // a point on a circle, seen by its distance
        "state x, y drift f x' = -y y' = x output x^2 + y^2 sample x in [1, 2] y in [1, 2]",
        // a state that enters no output
        "state x, y drift f x' = x y' = y output x sample x in [1, 2] y in [1, 2]",
        // two states that are seen by their sum only
        "state x, y drift f x' = x y' = y output x + y sample x in [1, 2] y in [1, 2]",
        // fixed palms without torques (Moll 2002, after 4.74)
        "state a, b, w drift f a' = 0 b' = 0 w' = 0 output a*w, b*w sample a in [1, 2] b in [1, 2] w in [1, 2]",
    ] {
        let (region, answer) = searched(&mut system(text), ALL, 1000);
        assert_eq!(answer.proved, 0.0, "{text}");
        assert_eq!(answer.proved_of_sampled, 0.0, "{text}");
        assert_eq!(answer.rest, 1.0, "{text}");
        assert!(region.is_finished() && answer.minors.is_empty(), "{text}");
    }
}

/// Unobservable in a way that no exact arithmetic here knows: exp(x) exp(-x) - 1 is zero everywhere.
#[test]
fn what_is_zero_unknown_to_us_is_not_proved_to_be_something_else() {
    let text = "state x, y drift f x' = 0 y' = 0 output x, (exp(x)*exp(-x) - 1)*y
                sample x in [1, 2] y in [1, 2]";
    let (_, answer) = searched(&mut system(text), ALL, 3000);
    assert_eq!(answer.proved, 0.0);
}

/// Where everything is regular all of it is proved, and the search knows that it has finished.
#[test]
fn a_regular_system_is_proved_on_all_of_its_box() {
    for text in [
        "state x, v drift f x' = v v' = -x output x sample x in [-1, 1] v in [-1, 1]",
        "state x, v drift f x' = v v' = -sin(x) output x sample x in [-3, 3] v in [-1, 1]",
        "state x, y drift f x' = 0 y' = 0 output exp(x + y), x - y sample x in [-2, 2] y in [-2, 2]",
        "state x, phi angle phi drift f x' = 0 phi' = 0 output x*sin(phi), x*cos(phi)
         sample x in [1, 2] phi in [-7, 7]",
        "state x, y drift f x' = 0 y' = 0 output sqrt(x), log(y)*sqrt(x) sample x in [1, 2] y in [1, 2]",
        "state x, y drift f x' = 0 y' = 0 output x, atan(y) + asin(y/3) sample x in [1, 2] y in [-2, 2]",
    ] {
        let (region, answer) = searched(&mut system(text), ALL, 20_000);
        assert_eq!(answer.proved, 1.0, "{text}");
        assert_eq!(answer.rest, 0.0, "{text}");
        assert!(region.is_finished(), "{text}");
    }
}

/// A pole in the box is no state with a rank: it stays open, and is called by its name. So does what lies outside of a
/// function's domain.
#[test]
fn poles_and_undefined_states_are_not_proved() {
    let (region, answer) = searched(
        &mut system("state x, y drift f x' = 0 y' = 0 output x, y/x sample x in [-1, 1] y in [1, 2]"),
        ALL,
        5000,
    );
    assert!(answer.proved > 0.999 && answer.proved < 1.0);
    assert!(
        answer.parts.iter().flat_map(|part| &part.vanishing).any(|v| v.minor.is_none() && v.factor == "x")
    );
    assert_ne!(region.standing(|_| Some(Interval::ZERO.hull(Interval::ONE))), Some(BoxStanding::Proved));
    // sin(phi) = 0 in the middle of the box, at a half turn, where the tangent of the half angle is infinite
    let text = "state x, phi angle phi drift f x' = 0 phi' = 0 output phi, x/sin(phi)
                sample x in [1, 2] phi in [2, 4]";
    let mut turned = system(text);
    let (region, answer) = searched(&mut turned, ALL, 5000);
    assert!(answer.proved > 0.999 && answer.proved < 1.0, "{}", answer.proved);
    let half_turn =
        |symbol| Some(if turned.is_angle(symbol) { Interval::pi() } else { Interval::point(1.5) });
    assert_ne!(region.standing(half_turn), Some(BoxStanding::Proved));
    // half of the box has no logarithm
    let text = "state x drift f x' = 0 output log(x) + x sample x in [-1, 1]";
    let (_, answer) = searched(&mut system(text), ALL, 5000);
    assert!(answer.proved > 0.499 && answer.proved <= 0.5, "{}", answer.proved);
    assert!(answer.rest >= 0.5);
}

/// A rank that drops at a half turn, where the tangent of the half angle is infinite: 1 + cos(phi) has its zero there.
#[test]
fn a_half_turn_is_seen() {
    let text = "state x, phi angle phi drift f x' = 0 phi' = 0 output phi, x*(1 + cos(phi))
                sample x in [1, 2] phi in [2, 4]";
    let mut system = system(text);
    let (region, answer) = searched(&mut system, ALL, 2000);
    assert!(answer.proved > 0.999 && answer.proved < 1.0, "{}", answer.proved);
    let half_turn =
        |symbol| Some(if system.is_angle(symbol) { Interval::pi() } else { Interval::point(1.5) });
    assert_ne!(region.standing(half_turn), Some(BoxStanding::Proved));
}

/// What sampled states keep away from counts for the whole and not for what is sampled.
#[test]
fn avoided_neighbourhoods_are_told_from_the_rest() {
    let text = "state x, y drift f x' = 0 y' = 0 output x, y/x sample x in [-1, 1] y in [1, 2] avoid x";
    let (_, answer) = searched(&mut system(text), ALL, 300);
    assert!(answer.proved < 1.0);
    assert_eq!(answer.proved_of_sampled, 1.0);
    // |x - y| < 0.05 is a band across the square, with a part of 0.0975 of it; outside of it all is proved in the end
    let text = "state x, y drift f x' = 0 y' = 0 output x - y, 1/(x - y)^2 + y sample x in [0, 1] y in [0, 1] avoid x - y";
    let (_, answer) = searched(&mut system(text), ALL, 20_000);
    assert!(answer.proved < 1.0 && answer.proved_of_sampled > 0.99, "{answer:?}");
}

/// Nothing depends on threads or on where a search was interrupted.
#[test]
fn boxes_give_one_result_on_any_number_of_threads() {
    let run = |threads: &str| {
        let arguments = ["certify", FIXED_PALMS, "--boxes", "9000", "--json"];
        let mut found = json(&with_threads(&arguments, Some(threads)));
        without_times(&mut found);
        found
    };
    assert_eq!(run("1"), run("3"));
}

/// A search that is taken up again comes to the same as one that was not interrupted, and a finished one says so.
#[test]
fn a_search_is_taken_up_where_it_stood() {
    let folder = folder();
    let state = folder.path().join("search.state");
    let state = state.to_str().unwrap();
    let mut once = certify(&[ONE_PALM_FIXED, "--boxes", "7000"]);
    for boxes in ["1", "999", "3000", "3000"] {
        let mut parts = certify(&[ONE_PALM_FIXED, "--boxes", boxes, "--state", state]);
        if parts["boxes"] == once["boxes"] {
            without_times(&mut parts);
            without_times(&mut once);
            // the curve has a point where each run ended, too
            parts["curve"] = json!(null);
            once["curve"] = json!(null);
            assert_eq!(parts, once);
        }
    }
    assert!(once["curve"].is_null(), "the runs were compared");
    // finished: same_rate is done within two hundred boxes
    let state = folder.path().join("finished.state");
    let arguments = ["certify", SAME_RATE, "--state", state.to_str().unwrap(), "--json"];
    let first = json(&palmistry(&arguments));
    let again = palmistry(&arguments);
    assert!(again.status.success());
    assert!(String::from_utf8_lossy(&again.stderr).contains("finished"));
    assert_eq!(json(&again)["proved_fraction"], first["proved_fraction"]);
}

/// A state that was cut, changed, or belongs to another question is refused; nothing is written over.
#[test]
fn damaged_and_foreign_states_are_refused() {
    let folder = folder();
    let state = folder.path().join("search.state");
    let name = state.to_str().unwrap();
    certify(&[FIXED_PALMS, "--boxes", "3000", "--state", name]);
    let whole = std::fs::read_to_string(&state).unwrap();
    let half: String = whole.lines().take(40).map(|line| format!("{line}\n")).collect();
    let last = whole.rfind("open ").unwrap();
    let swapped = format!("{}{}", &whole[..last], whole[last..].replacen("open", "left", 1));
    let middle = whole.len() / 2;
    let flipped = format!(
        "{}{}{}",
        &whole[..middle],
        if &whole[middle..=middle] == "1" { "2" } else { "1" },
        &whole[middle + 1..]
    );
    for (text, complaint) in [
        (half, "damaged"),
        (swapped, "damaged"),
        (flipped, "damaged"),
        (whole.replace("end ", "ende "), "damaged"),
        (String::new(), "no saved search"),
        ("{\"a\": 1}\n".to_owned(), "no saved search"),
        ("palmistry region 1\n".to_owned(), "damaged"),
    ] {
        std::fs::write(&state, &text).unwrap();
        let output = palmistry(&["certify", FIXED_PALMS, "--boxes", "10", "--state", name, "--json"]);
        assert_eq!(output.status.code(), Some(2), "{complaint}");
        let message = json(&output)["error"]["message"].as_str().unwrap().to_owned();
        assert!(message.contains(complaint), "{message}");
        assert_eq!(std::fs::read_to_string(&state).unwrap(), text, "nothing is written over");
    }
    std::fs::write(&state, &whole).unwrap();
    for other in [
        vec!["certify", SAME_RATE, "--state", name],
        vec!["certify", FIXED_PALMS, "--box", "r1=1..2", "--state", name],
        vec!["certify", FIXED_PALMS, "--rows", "own", "--state", name],
    ] {
        let output = palmistry(&other);
        assert_eq!(output.status.code(), Some(2), "{other:?}");
        let words = String::from_utf8_lossy(&output.stderr).split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(words.contains("another question"), "{words}");
    }
}

/// A box of one's own, a fixed value, and the thesis's own rows, which fail on more than the full codistribution.
#[test]
fn boxes_and_rows_can_be_chosen() {
    let found = certify(&[SAME_RATE, "--box", "omega0=1/2..1,phi1=0.1..0.2", "--boxes", "100"]);
    assert_eq!(fraction(&found), 1.0);
    let found = certify(&[SAME_RATE, "--box", "omega0=0..0", "--boxes", "100"]);
    assert_eq!(fraction(&found), 0.0, "an object that does not turn hides its radii (4.49)");
    let found = certify(&[SAME_RATE, "--box", "phi1=-1..1", "--rows", "own", "--boxes", "2000"]);
    assert!(fraction(&found) < 1.0 && fraction(&found) > 0.99);
    let factors: Vec<&Value> =
        found["parts"].as_array().unwrap().iter().flat_map(|p| p["not_zero"].as_array().unwrap()).collect();
    assert!(factors.iter().any(|f| f.as_str().unwrap().contains("phi1")), "4.54: palm 1 level, {factors:?}");
    // a parameter that the file holds at one value may be given a range
    let found = certify(&[SAME_RATE, "--box", "omega1=3..4", "--boxes", "100"]);
    assert!(fraction(&found) > 0.9);
}

#[test]
fn what_cannot_be_asked_is_refused_with_advice() {
    for (arguments, advice) in [
        (vec!["--box", "omga0=0..1"], "omega0"),
        (vec!["--box", "omega0=0"], "name=low..high"),
        (vec!["--box", "omega0"], "name=low..high"),
        (vec!["--box", "omega0=1..0"], "low end comes first"),
        (vec!["--box", "omega0=0..x"], "not a number"),
        (vec!["--box", "omega0=0..1,omega0=2..3"], "twice"),
        (vec!["--box", "rho=0..1"], "no state or parameter"),
        (vec!["--budget", "0"], "positive number of seconds"),
        (vec!["--budget", "1", "--boxes", "2"], "cannot be used with"),
        (vec!["--rows", "own", "--order", "2"], "leave out --order"),
        (vec!["--map", "omega0"], "two coordinates"),
        (vec!["--map", "omega0,r1"], "depend on omega0, phi1"),
        (vec!["--map", "omega0,bracket"], "no state or parameter"),
        (vec!["--box", "omega0=2..2"], "undefined at every state"),
    ] {
        let output = palmistry(&[&["certify", SAME_RATE], arguments.as_slice()].concat());
        let words = String::from_utf8_lossy(&output.stderr).replace('│', " ");
        let words = words.split_whitespace().collect::<Vec<_>>().join(" ");
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(words.contains(advice), "{arguments:?}: {words}");
    }
    let folder = folder();
    let file = write(&folder, "free.proof", "system \"s\" state x drift f x' = 0 output x^2");
    let output = palmistry(&["certify", file.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("--box"));
}

/// The pictures are written, and are pictures.
#[test]
fn pictures_are_written() {
    let folder = folder();
    let out = folder.path().join("out");
    certify(&[ONE_PALM_FIXED, "--boxes", "3000", "--map", "s1,phi2", "--out", out.to_str().unwrap()]);
    let read = |name: &str| std::fs::read_to_string(out.join(name)).unwrap();
    let written: Value = serde_json::from_str(&read("certify.json")).unwrap();
    assert!(fraction(&written) > 0.9);

    // one line, of no more points than there are entries (those on straight stretches are left out), with powers of ten up to
    // the 3000 boxes below it
    let curve = Picture::read(&read("curve.svg"));
    assert_eq!(curve.title, written["title"].as_str().unwrap());
    let points = written["curve"].as_array().unwrap().len();
    let lines = curve.lines_of("#0072b2");
    assert!(matches!(lines[..], [drawn] if drawn > points / 2 && drawn <= points), "{lines:?} of {points}");
    for label in ["boxes", "part of the volume that is open", "1e0", "1e3"] {
        assert!(curve.texts.contains(&label.to_owned()), "{label}: {:?}", curve.texts);
    }
    assert!(!curve.texts.contains(&"1e4".to_owned()));

    // s1 from 1/2 to 3 below, phi2 from 4/5 to 12/5 beside it, in the units that the file declares; a minor vanishes on a curve, which takes many boxes
    let map = Picture::read(&read("map.svg"));
    let expected = ["φ2, rad", "s1, m", "1.0", "1.5", "2.0", "1.0", "2.0", "3.0"];
    // an index stands lower in a tspan of its own
    let plain =
        |text: &String| text.split('<').map(|part| part.rsplit('>').next().unwrap()).collect::<String>();
    assert_eq!(map.texts[1..].iter().map(plain).collect::<Vec<_>>(), expected);
    assert!(map.boxes_of("#d55e00") > 100, "{}", map.boxes_of("#d55e00"));
    assert_eq!(map.boxes_of("#cde4f0"), 1);
}

/// A search that is interrupted, here where half is proved, keeps what it had; another one takes it up there.
#[test]
fn an_interrupted_search_keeps_what_it_had() {
    let read = || System::read(Path::new(ONE_PALM_FIXED)).unwrap();
    let begun = || Region::new(&mut read(), ALL, &BTreeMap::new(), None).unwrap();
    let mut region = begun();
    let interrupt = AtomicBool::new(false);
    let stop_at_half = |now: Progress| {
        interrupt.fetch_or(now.proved > 0.5, Ordering::Relaxed);
    };
    region.run(Limits { seconds: None, boxes: None }, &interrupt, &stop_at_half);
    assert!(interrupt.load(Ordering::Relaxed) && region.proved() > 0.5 && !region.is_finished());
    let mut again = begun();
    again.resume(&region.saved()).unwrap();
    assert_eq!(again.proved_exactly(), region.proved_exactly());
    assert_eq!(again.boxes(), region.boxes());
    again.run(Limits { seconds: None, boxes: Some(1) }, &false.into(), &|_| ());
    assert_eq!(again.boxes(), region.boxes() + 1);
}

/// Interrupts that fall anywhere, into blocks of boxes as well: what was begun is not counted, and the search goes on as if nothing had been.
/// Oracle: a search without an interrupt.
#[test]
fn interrupts_at_any_box_change_nothing() {
    const BOXES: u64 = 6000;
    let begun = || {
        Region::new(&mut System::read(Path::new(ONE_PALM_FIXED)).unwrap(), ALL, &BTreeMap::new(), None)
            .unwrap()
    };
    let told = |region: &Region| -> Vec<String> {
        let of_time = |line: &&str| ["seconds", "curve", "end"].iter().any(|word| line.starts_with(word));
        region.saved().lines().filter(|line| !of_time(line)).map(str::to_owned).collect()
    };
    let blocks = Mutex::new(BTreeSet::from([0]));
    let mut whole = begun();
    let tell = |now: Progress| {
        blocks.lock().unwrap().insert(now.boxes);
    };
    whole.run(Limits { seconds: None, boxes: Some(BOXES) }, &false.into(), &tell);
    assert_eq!(whole.boxes(), BOXES);
    let interrupted = || {
        let (mut region, mut runs) = (begun(), 0);
        while region.boxes() < BOXES {
            runs += 1;
            let interrupt = AtomicBool::new(false);
            let limits = Limits { seconds: None, boxes: Some(BOXES - region.boxes()) };
            std::thread::scope(|scope| {
                scope.spawn(|| {
                    std::thread::sleep(Duration::from_micros(100 << (runs / 2)));
                    interrupt.store(true, Ordering::Relaxed);
                });
                region.run(limits, &interrupt, &|_| ());
            });
            assert!(
                blocks.lock().unwrap().contains(&region.boxes()),
                "{} boxes are no whole blocks",
                region.boxes()
            );
        }
        (region, runs)
    };
    // beside other work an interrupt may come after the end
    let often = (0..10).map(|_| interrupted()).find(|(_, runs)| *runs > 2);
    let (region, _) = often.expect("a search that was interrupted more than once");
    assert_eq!(told(&region), told(&whole));
    // an interrupt leaves the answer what is proved, and explains the largest boxes alone
    let (all, some) = (region.answer(), region.answer_until(&true.into()));
    assert_eq!((some.proved, some.boxes, some.open_boxes), (all.proved, all.boxes, all.open_boxes));
    assert!(some.minor_vanishes <= all.minor_vanishes && some.rest >= all.rest);
    assert!(some.proved_of_sampled <= all.proved_of_sampled);
    assert_eq!(some.largest, all.largest);
}
