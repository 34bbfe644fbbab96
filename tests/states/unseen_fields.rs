//! Unseen directions as vector fields, seen functions, and systems written in these.
//!
//! The expected fields and functions were found by hand, each from the equations as said beside it. Two oracles that share nothing
//! with what found them: num-dual's differentials of all words up to three fields long vanish along every field, and the new
//! system's claims are proved.

use crate::common::{folder, json, palmistry, write};
use palmistry::System;
use palmistry::expression::Program;
use palmistry::number::Floats;
use palmistry::observability::{
    Codistribution, Length, NotReparametrised, UnobservableDirections, differential_by_duals, reparametrise,
    unobservable_directions,
};
use palmistry::report::unobservable_field_text;
use palmistry::system::Assignment;
use std::collections::HashMap;

/// What is found of a system, by words and by power series alike.
fn found(text: &str) -> (System, UnobservableDirections) {
    let mut system: System = text.parse().expect("a system");
    let nothing = Assignment::new();
    let words = Codistribution::new(&mut system, &nothing, Length::UntilItStops).expect("words");
    let by_words = unobservable_directions(&mut system, Some(&words), &nothing, &nothing).expect("points");
    let by_series = unobservable_directions(&mut system, None, &nothing, &nothing).expect("points");
    assert_eq!(fields(&by_words), fields(&by_series));
    assert_eq!(functions(&by_words), functions(&by_series));
    assert_eq!(by_words.directions(), system.unknowns().len() - words.generic_rank());
    (system, by_words)
}

fn fields(found: &UnobservableDirections) -> Vec<String> {
    found.fields.iter().map(unobservable_field_text).collect()
}

fn functions(found: &UnobservableDirections) -> Vec<&str> {
    found.functions.iter().map(|function| function.text.as_str()).collect()
}

/// Along each field no word of up to three fields changes, by another route of differentiation.
fn no_word_changes(system: &System, found: &UnobservableDirections) {
    let mut words: Vec<Vec<usize>> = vec![Vec::new()];
    for length in 1..=3 {
        let shorter: Vec<Vec<usize>> =
            words.iter().filter(|word| word.len() == length - 1).cloned().collect();
        for field in system.moving_fields() {
            words.extend(shorter.iter().map(|word| [&[field], word.as_slice()].concat()));
        }
    }
    let mut checked = 0;
    for place in 0..5 {
        let value = |number: usize| 0.3 + 0.37 * ((number * 7 + place * 3) % 11) as f64;
        let point: HashMap<_, f64> =
            system.symbols().enumerate().map(|(number, (symbol, _))| (symbol, value(number))).collect();
        for field in &found.fields {
            let rates: Vec<_> = field.components.iter().map(|part| part.rate).collect();
            let program = Program::plain(&system.graph, &rates);
            let inputs: Vec<f64> =
                program.inputs().iter().map(|input| point[&input.symbol().unwrap()]).collect();
            let rates = program.load(Floats).unwrap().run(&inputs, &mut Vec::new()).unwrap();
            for word in &words {
                for (_, output) in &system.outputs {
                    let row = differential_by_duals(system, word, *output, &point).expect("no pole");
                    let (mut change, mut size) = (0.0, 1.0f64);
                    for (part, rate) in field.components.iter().zip(&rates) {
                        let column = system.unknowns().iter().position(|state| *state == part.state).unwrap();
                        change += rate * row[column];
                        size = size.max((rate * row[column]).abs());
                    }
                    assert!(
                        change.abs() < 1e-9 * size,
                        "{change} of {size} along {}",
                        unobservable_field_text(field)
                    );
                    checked += 1;
                }
            }
        }
    }
    assert!(checked >= 5 * found.fields.len() * words.len());
}

/// The system in what is seen has the rank as its dimension, and all its claims are proved.
fn is_reparametrised(system: &System, text: &str, found: &UnobservableDirections) -> String {
    let folder = folder();
    write(&folder, "original.proof", text);
    let reduced = reparametrise(system, found, "original.proof").expect("a reparametrisation");
    let read =
        System::parse("reduced.proof", &reduced, folder.path()).unwrap_or_else(|e| panic!("{e}\n{reduced}"));
    assert_eq!(read.states.len(), system.unknowns().len() - found.directions());
    let outcomes = palmistry::prove(&read);
    assert_eq!(outcomes.len(), read.states.len() * read.fields.len() + 2, "{reduced}");
    for outcome in outcomes {
        assert!(
            ["proved", "holds by definition"].contains(&outcome.word()),
            "{}: {}\n{reduced}",
            outcome.id,
            outcome.statement
        );
        assert!(outcome.ok);
    }
    reduced
}

/// A system, its fields, what is seen by itself, and the functions that are seen.
struct Case {
    text: &'static str,
    fields: &'static [&'static str],
    seen: &'static [&'static str],
    functions: &'static [&'static str],
}

fn check(case: &Case) {
    let (system, found) = found(case.text);
    assert_eq!(fields(&found), case.fields, "{}", system.title);
    assert_eq!(found.observable_names, case.seen, "{}", system.title);
    assert_eq!(functions(&found), case.functions, "{}", system.title);
    assert_eq!((found.fields_missing, found.functions_missing), (0, 0), "{}", system.title);
    assert!(found.settles_the_rank && found.for_all_parameters && !found.cut_off, "{}", system.title);
    assert!(found.fields.iter().all(|field| field.log2_error < -100.0));
    assert!(found.functions.iter().all(|function| function.log2_error < -100.0));
    no_word_changes(&system, &found);
    is_reparametrised(&system, case.text, &found);
}

/// Turning everything about the beacon at (b, 0) changes no range: the field of the issue, with its centre moved. In the robot's own
/// axes the beacon stands still under it.
#[test]
fn a_unicycle_and_ranges_to_a_beacon() {
    check(&Case {
        text: "system \"range\"  state x, y, theta  param b  angle theta
            input drive x' = cos(theta) y' = sin(theta) theta' = 0  input turn theta' = 1 others' = 0
            output (x - b)^2 + y^2",
        fields: &["-y d/dx + (x - b) d/dy + d/dtheta"],
        seen: &[],
        functions: &[
            "x*sin(theta) - y*cos(theta) - b*sin(theta)",
            "x*cos(theta) + y*sin(theta) - b*cos(theta)",
        ],
    });
}

/// The tangent of the bearing of the origin, with a known speed: the scale is seen, the turn is not. With an unknown speed `v`
/// neither is.
#[test]
fn a_unicycle_and_bearings() {
    check(&Case {
        text: "system \"bearing\"  state x, y, theta  angle theta
            input drive x' = cos(theta) y' = sin(theta) theta' = 0  input turn theta' = 1 others' = 0
            output (y*cos(theta) - x*sin(theta))/(x*cos(theta) + y*sin(theta))",
        fields: &["-y d/dx + x d/dy + d/dtheta"],
        seen: &[],
        functions: &["x*sin(theta) - y*cos(theta)", "x*cos(theta) + y*sin(theta)"],
    });
    check(&Case {
        text: "system \"bearing, speed unknown\"  state x, y, theta, v  angle theta
            drift f x' = v*cos(theta) y' = v*sin(theta) others' = 0  input turn theta' = 1 others' = 0
            output (y*cos(theta) - x*sin(theta))/(x*cos(theta) + y*sin(theta))",
        fields: &["x d/dx + y d/dy + v d/dv", "-y d/dx + x d/dy + d/dtheta"],
        seen: &[],
        functions: &["(x*sin(theta) - y*cos(theta))/v", "(x*cos(theta) + y*sin(theta))/v"],
    });
}

/// Bearings of two landmarks, with an unknown speed: two translations, the scale and a turn of everything.
#[test]
fn mapping_by_bearings_alone() {
    let text = "system \"mapping\"  state x, y, theta, a1, b1, a2, b2, v  angle theta
        drift f x' = v*cos(theta) y' = v*sin(theta) others' = 0  input turn theta' = 1 others' = 0
        output ((b1 - y)*cos(theta) - (a1 - x)*sin(theta))/((a1 - x)*cos(theta) + (b1 - y)*sin(theta)),
               ((b2 - y)*cos(theta) - (a2 - x)*sin(theta))/((a2 - x)*cos(theta) + (b2 - y)*sin(theta))";
    let (system, found) = found(text);
    let mut fields = fields(&found);
    fields.sort();
    assert_eq!(
        fields,
        [
            "-y d/dx + x d/dy + d/dtheta - b1 d/da1 + a1 d/db1 - b2 d/da2 + a2 d/db2",
            "d/dx + d/da1 + d/da2",
            "d/dy + d/db1 + d/db2",
            "x d/dx + y d/dy + a1 d/da1 + b1 d/db1 + a2 d/da2 + b2 d/db2 + v d/dv",
        ]
    );
    assert_eq!((found.functions.len(), found.functions_missing), (4, 0));
    no_word_changes(&system, &found);
    is_reparametrised(&system, text, &found);
}

/// Two masses and the distance between them: both may be anywhere and drift together.
#[test]
fn translations() {
    check(&Case {
        text: "system \"masses\"  state x1, v1, x2, v2  param k, m1, m2
            drift f x1' = v1 v1' = k*(x2 - x1)/m1 x2' = v2 v2' = -k*(x2 - x1)/m2  output x2 - x1",
        fields: &["d/dx1 + d/dx2", "d/dv1 + d/dv2"],
        seen: &[],
        functions: &["x1 - x2", "v1 - v2"],
    });
}

/// Infected people are seen in an unknown proportion k, and the transmission coefficient is divided by the population: counted in
/// other units nothing changes (S, I and N by c, k by 1/c), and of beta and N only the quotient is met.
#[test]
fn an_epidemic() {
    check(&Case {
        text: "system \"SIR\"  state S, I, beta, N, gamma, k
            drift f S' = -beta*S*I/N  I' = beta*S*I/N - gamma*I  others' = 0  output k*I",
        fields: &["beta d/dbeta + N d/dN", "S d/dS + I d/dI - beta d/dbeta - k d/dk"],
        seen: &["gamma"],
        functions: &["S*k", "I*k", "N*k/beta"],
    });
    // with the product beta*N instead of the quotient
    check(&Case {
        text: "system \"SI with births\"  state i, beta, N, gamma
            drift f i' = beta*N*(1 - i)*i - gamma*i  others' = 0  output i",
        fields: &["beta d/dbeta - N d/dN"],
        seen: &["i", "gamma"],
        functions: &["beta*N"],
    });
}

/// Michaelis and Menten's kinetics: with the concentration in unknown units those of V and K go along; far below saturation, where the
/// rate is V x/K, only the quotient is met.
#[test]
fn an_enzyme() {
    check(&Case {
        text: "system \"saturation\"  state x, V, K, c
            drift f x' = -V*x/(K + x) others' = 0  output c*x",
        fields: &["x d/dx + V d/dV + K d/dK - c d/dc"],
        seen: &[],
        functions: &["x*c", "V*c", "K*c"],
    });
    check(&Case {
        text: "system \"far below saturation\"  state x, V, K
            drift f x' = -V*x/K others' = 0  output x",
        fields: &["V d/dV + K d/dK"],
        seen: &["x"],
        functions: &["V/K"],
    });
}

/// Two compartments with elimination from the first one, its concentration seen. By the coefficients of the characteristic polynomial
/// k12 + k21 + ke and k21*ke are seen (Bellman and Astrom, On structural identifiability, Math. Biosciences 7, 1970, have the method),
/// and no single rate without a known dose.
#[test]
fn two_compartments() {
    check(&Case {
        text: "system \"two compartments\"  state x1, x2, k12, k21, ke, v
            drift f x1' = -(k12 + ke)*x1 + k21*x2  x2' = k12*x1 - k21*x2 others' = 0  output x1/v",
        fields: &[
            "x1 d/dx1 + x2 d/dx2 + v d/dv",
            "(x1 + x2) d/dx2 + (k21 - ke) d/dk12 - k21 d/dk21 + ke d/dke",
        ],
        seen: &[],
        functions: &["x1/v", "k12 + k21 + ke", "k21*ke", "k21*(x1 + x2)/x1"],
    });
}

/// A reversible reaction, one substance seen in unknown units. Of A and B, which are met alike, only symmetric functions are seen:
/// besides the units there is a motion that keeps A B - (A + C)(B + C) and so on.
#[test]
fn a_reaction() {
    let text = "system \"A + B <-> C\"  state A, B, C, k1, k2, s
        drift f A' = -k1*A*B + k2*C B' = -k1*A*B + k2*C C' = k1*A*B - k2*C others' = 0  output s*C";
    let (system, found) = found(text);
    assert_eq!(fields(&found)[0], "A d/dA + B d/dB + C d/dC - k1 d/dk1 - s d/ds");
    assert_eq!((found.fields.len(), found.functions.len(), found.functions_missing), (2, 4, 0));
    no_word_changes(&system, &found);
    is_reparametrised(&system, text, &found);
}

/// A sum, a product and a difference of angles: each hides one direction.
#[test]
fn sums_products_and_angles() {
    check(&Case {
        text: "system \"sum and product\"  state x, a, b, c, d
            drift f x' = (a + b)*x + c*d others' = 0  output x",
        fields: &["d/da - d/db", "c d/dc - d d/dd"],
        seen: &["x"],
        functions: &["a + b", "c*d"],
    });
    check(&Case {
        text: "system \"two hands\"  state p, q, w  angle p, q
            drift f p' = w + sin(p - q) q' = w  w' = 0  output sin(p - q), w",
        fields: &["d/dp + d/dq"],
        seen: &["w"],
        functions: &["p - q"],
    });
}

/// Three points of the plane by their distances: they may be moved and turned together. And a point in space with a constant velocity,
/// its distance from the origin seen: the three turns.
#[test]
fn turns() {
    let text = "system \"three points\"  state x1, y1, x2, y2, x3, y3  drift f others' = 0
        output (x1 - x2)^2 + (y1 - y2)^2, (x1 - x3)^2 + (y1 - y3)^2, (x2 - x3)^2 + (y2 - y3)^2";
    let (system, three) = found(text);
    let mut of_three = fields(&three);
    of_three.sort();
    assert_eq!(
        of_three,
        [
            "-y1 d/dx1 + x1 d/dy1 - y2 d/dx2 + x2 d/dy2 - y3 d/dx3 + x3 d/dy3",
            "d/dx1 + d/dx2 + d/dx3",
            "d/dy1 + d/dy2 + d/dy3",
        ]
    );
    assert_eq!((three.functions.len(), three.functions_missing), (3, 0));
    no_word_changes(&system, &three);
    let text = "system \"in space\"  state x, y, z, u, v, w  drift f x' = u y' = v z' = w others' = 0
        output x^2 + y^2 + z^2";
    let (system, space) = found(text);
    let mut of_space = fields(&space);
    of_space.sort();
    assert_eq!(
        of_space,
        [
            "-y d/dx + x d/dy - v d/du + u d/dv",
            "-z d/dx + x d/dz - w d/du + u d/dw",
            "-z d/dy + y d/dz - w d/dv + v d/dw",
        ]
    );
    assert_eq!(functions(&space), ["x*u + y*v + z*w", "x^2 + y^2 + z^2", "u^2 + v^2 + w^2"]);
    no_word_changes(&system, &space);
    // no section would do: a length is no linear function of any coordinate
    let reduced = is_reparametrised(&system, text, &space);
    assert!(reduced.contains("z1' = z3\n  z2' = 2*z1\n"), "{reduced}");
}

/// The cross ratio of four numbers is that of their images under every fractional linear map: the third field is quadratic.
#[test]
fn projective_motions() {
    let (system, found) = found(
        "system \"cross ratio\"  state a, b, c, d  drift f others' = 0
        output (a - c)*(b - d)/((a - d)*(b - c))",
    );
    assert_eq!(
        fields(&found),
        [
            "d/da + d/db + d/dc + d/dd",
            "a d/da + b d/db + c d/dc + d d/dd",
            "a^2 d/da + b^2 d/db + c^2 d/dc + d^2 d/dd",
        ]
    );
    assert_eq!((found.functions.len(), found.functions_missing), (1, 0));
    no_word_changes(&system, &found);
}

/// Arrhenius' law at one temperature: of A, E and T only the rate is seen, which stands in the file. Functions that are not rational are
/// proved by what is known of them.
#[test]
fn functions_that_are_not_rational() {
    let text =
        "system \"Arrhenius\"  state x, T, A, E, c  drift f x' = -A*exp(-E/T)*x others' = 0  output c*x";
    let mut system: System = text.parse().unwrap();
    let nothing = Assignment::new();
    let found = unobservable_directions(&mut system, None, &nothing, &nothing).unwrap();
    assert_eq!(fields(&found), ["x d/dx - c d/dc", "T d/dT + E d/dE", "A d/dA + T d/dE"]);
    assert_eq!(functions(&found), ["x*c", "A*exp(-E/T)"]);
    assert!(found.settles_the_rank);
    no_word_changes(&system, &found);
    let reduced = is_reparametrised(&system, text, &found);
    assert!(reduced.contains("z1' = -z1*z2"), "{reduced}");
}

/// Constants to be identified and a signal that nobody knows are unknowns like states; a known signal has no column, and a system that
/// has one is not written anew.
#[test]
fn signals_and_constants() {
    check(&Case {
        text: "system \"a force in unknown units\"  state x  param a unknown, s unknown  unknown w(t)
            drift f x' = -a*x + s*w  output x",
        fields: &["s d/ds - w d/dw - w' d/dw'"],
        seen: &["x", "a"],
        functions: &["w/w'", "s*w"],
    });
    let text = "system \"a known force\"  state x  param a unknown, b unknown, c unknown  known u(t)
        drift f x' = -a*x + b*c*u  output x";
    let (system, found) = found(text);
    assert_eq!(fields(&found), ["b d/db - c d/dc"]);
    assert_eq!((found.observable_names.join(" "), functions(&found)), ("x a".to_owned(), vec!["b*c"]));
    no_word_changes(&system, &found);
    assert_eq!(reparametrise(&system, &found, "a.proof"), Err(NotReparametrised::KnownSignals));
}

/// The removed of an epidemic stand in no rate and no output: they are left out, and no coordinate is new.
#[test]
fn what_nothing_mentions_is_left_out() {
    check(&Case {
        text: "system \"epidemic\"  state S, I, R  param b unknown, g unknown
            drift f S' = -b*S*I I' = b*S*I - g*I R' = g*I  output I",
        fields: &["d/dR"],
        seen: &["S", "I", "b", "g"],
        functions: &[],
    });
}

/// A chain of twenty, 61 unknowns, in a time that a test has: the scalings of each link.
#[test]
fn sixty_unknowns() {
    let names = |letter: &str| (1..=20).map(|k| format!("{letter}{k}")).collect::<Vec<_>>().join(", ");
    let mut text = format!("system \"chain\"  state {}, {}, {}, c\n", names("x"), names("a"), names("b"));
    text += "input u x1' = a1 others' = 0  drift f x1' = -b1*x1";
    (2..=20).for_each(|k| text += &format!(" x{k}' = a{k}*x{} - b{k}*x{k}", k - 1));
    text += " others' = 0  output c*x20";
    let mut system: System = text.parse().unwrap();
    let nothing = Assignment::new();
    let found = unobservable_directions(&mut system, None, &nothing, &nothing).unwrap();
    assert_eq!((found.fields.len(), found.fields_missing), (20, 0));
    assert_eq!((found.functions.len(), found.functions_missing), (21, 0));
    assert_eq!(found.observable_names.len(), 20);
    assert!(fields(&found).contains(&"x7 d/dx7 + a7 d/da7 - a8 d/da8".to_owned()));
    assert!(functions(&found).contains(&"x6*a7/x7"));
}

/// The field through fractions: along it x/(1 + z^2) and y/(1 + z^3) are kept, over a common denominator it has degree five. The
/// outputs themselves say what is seen.
#[test]
fn fractions_of_polynomials() {
    let text = "system \"quotients\"  state x, y, z  drift f others' = 0  output x/(1 + z^2), y/(1 + z^3)";
    let (system, found) = found(text);
    assert_eq!(fields(&found), ["2*x*z/(1 + z^2) d/dx + 3*y*z^2/(1 + z^3) d/dy + d/dz"]);
    assert_eq!((found.fields_missing, found.functions.len(), found.functions_missing), (0, 2, 0));
    no_word_changes(&system, &found);
    let reduced = is_reparametrised(&system, text, &found);
    assert!(reduced.contains("output z1, z2"), "{reduced}");
}

/// A field of degree eight is not found: it is counted, and no other is given in its place. What is measured is seen all the same.
#[test]
fn what_is_not_found_is_counted() {
    let text = "system \"high degree\"  state x, y  drift f others' = 0  output x^7*y + y^9*x^2 + x^9";
    let (system, found) = found(text);
    assert_eq!((found.fields.len(), found.fields_missing), (0, 1));
    assert!(!found.settles_the_rank);
    assert!(reparametrise(&system, &found, "original.proof").is_err());
}

/// Where a parameter's value makes directions unseen that others would not, the fields are those at this value.
#[test]
fn a_value_that_hides() {
    let mut system: System = "system \"no spring\"  state x1, v1, x2, v2  param k = 0
        drift f x1' = v1 v1' = k*(x2 - x1) x2' = v2 v2' = k*(x1 - x2)  output x1"
        .parse()
        .unwrap();
    let k = system.find_symbol("k").unwrap();
    let held = Assignment::from([(k, system.graph.integer(0))]);
    let words = Codistribution::new(&mut system, &held, Length::UntilItStops).unwrap();
    let found = unobservable_directions(&mut system, Some(&words), &held, &Assignment::new()).unwrap();
    assert_eq!(fields(&found), ["d/dx2", "d/dv2"]);
    assert!(!found.for_all_parameters);
    let reduced = reparametrise(&system, &found, "original.proof").unwrap();
    assert!(reduced.contains("where k = 0"), "{reduced}");
}

/// What users see: the text, the JSON, and the file that is written.
#[test]
fn the_program_tells_and_writes() {
    let folder = folder();
    let text = "system \"sum\"  state x, a, b  drift f x' = (a + b)*x others' = 0  output x
        sample x in [1, 2] a in [1, 2] b in [1, 2]";
    let path = write(&folder, "sum.proof", text);
    let out = folder.path().join("deep/seen.proof");
    let (path, out) = (path.to_str().unwrap(), out.to_str().unwrap());
    let answer = palmistry(&["rank", path, "--samples", "10", "--reparametrise", out, "--json"]);
    assert!(answer.status.success());
    let answer = json(&answer);
    assert_eq!(answer["unobservable_directions"]["fields"][0]["text"], "d/da - d/db");
    assert_eq!(answer["unobservable_directions"]["fields"][0]["components"]["b"], "-1");
    assert_eq!(answer["unobservable_directions"]["functions"][0]["text"], "a + b");
    assert_eq!(answer["unobservable_directions"]["observable"][0], "x");
    assert_eq!(answer["reparametrised"]["claims"], 4);
    assert_eq!(answer["reparametrised"]["proved"], 4);
    let proved = palmistry(&["prove", out]);
    assert!(proved.status.success(), "{}", String::from_utf8_lossy(&proved.stdout));
    let again = palmistry(&["rank", out, "--samples", "10", "--json"]);
    assert_eq!(json(&again)["rank_histogram"]["2"], 10);
    let text = palmistry(&["rank", path, "--samples", "10"]);
    let text = String::from_utf8_lossy(&text.stdout).into_owned();
    assert!(text.contains("\n  d/da - d/db  (proved, certain)"), "{text}");
    assert!(text.contains("\n  a + b  (proved"), "{text}");
}
