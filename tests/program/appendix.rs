//! Story 2: does the appendix hold?

use crate::common::{folder, json, palmistry, without_times};
use serde_json::json;

const GENERAL: &str = "proofs/moll2002/general.proof";
const POINT: &str = "m=1,rho=.5,phi2=2,s1=1,s2=2,r1=1.5,r2=1.5,omega0=1,omega1=2,omega2=3";

/// Forty digits of det A, found a second time by SymPy 1.13 (differentiation) and mpmath 1.3 (90 digits).
#[test]
fn the_determinant_to_forty_digits() {
    for (rates, digits) in [
        ("omega0=1,omega1=2,omega2=3", "25.66837164143751007333938458550988284346"),
        ("omega0=1,omega1=2,omega2=0", "1647.937602641709674164055586494218870315"),
        ("omega0=1,omega1=0,omega2=2", "1634.172755735818928909828991769988554758"),
    ] {
        let at = format!("m=1,rho=.5,phi2=2,s1=1,s2=2,r1=1.5,r2=1.5,{rates}");
        let output = palmistry(&["eval", GENERAL, "det(A)", "--at", &at, "--digits", "40", "--json"]);
        assert!(output.status.success());
        assert_eq!(json(&output)["value"], digits);
    }
}

/// A value does not change with the number of digits that are asked for, but for its last one.
#[test]
fn more_digits_begin_with_fewer() {
    let value = |digits: &str| {
        let output = palmistry(&["eval", GENERAL, "det(A)", "--at", POINT, "--digits", digits, "--json"]);
        json(&output)["value"].as_str().unwrap().to_owned()
    };
    let long = value("500");
    for digits in ["5", "60", "300"] {
        let short = value(digits);
        assert_eq!(short[..short.len() - 1], long[..short.len() - 1]);
    }
}

/// The cheapest numbers that suffice are taken, better ones where they do not, and the answer is the same.
#[test]
fn an_accuracy_is_asked_for_and_not_a_type() {
    let exact = "25.66837164143751"; // of the forty digits above
    for (digits, verdict, numbers, certainty, climbed) in [
        ("10", "certified", "intervals", "certified", 0),
        ("10", "computed", "double-doubles", "computed", 0),
        ("15", "certified", "enclosures of 116 bits", "certified", 1),
        ("16", "computed", "enclosures of 120 bits", "certified", 0),
    ] {
        let arguments = ["eval", GENERAL, "det(A)", "--at", POINT, "--digits", digits, "--json"];
        let found = json(&palmistry(&[&arguments[..], &["--verdict", verdict]].concat()));
        let (value, wanted) = (found["value"].as_str().unwrap(), digits.parse::<usize>().unwrap() + 1);
        assert_eq!(value.len(), wanted, "digits and the point");
        assert_eq!(value[..wanted - 1], exact[..wanted - 1]);
        assert_eq!(
            (&found["numbers"], &found["verdict"], &found["escalated"]),
            (&json!(numbers), &json!(certainty), &json!(climbed))
        );
    }
}

#[test]
fn fractions_and_decimals_are_one() {
    let value = |rho: &str| {
        let at = POINT.replace("rho=.5", rho);
        json(&palmistry(&["eval", GENERAL, "det(A)", "--at", &at, "--json"]))["value"].clone()
    };
    assert_eq!(value("rho=1/2"), value("rho=.5"));
    assert_eq!(value("rho=1/2"), value("rho=5e-1"));
}

/// At the thesis's singular points ("division by zero") the divisor is named.
#[test]
fn a_pole_is_named() {
    for (rates, divisor) in [
        ("omega0=1,omega1=1,omega2=3", "omega1 - omega0 = 0"),
        ("omega0=2,omega1=1,omega2=1", "omega1 + omega2 - omega0 = 0"),
    ] {
        let at = format!("m=1,rho=.5,phi2=2,s1=1,s2=2,r1=1.5,r2=1.5,{rates}");
        let output = palmistry(&["eval", GENERAL, "det(A)", "--at", &at, "--json"]);
        assert_eq!(output.status.code(), Some(2));
        let message = json(&output)["error"]["message"].as_str().unwrap().to_owned();
        assert!(message.contains(divisor), "{message}");
    }
}

/// The whole main job, as a user runs it: exit status 0, the page and the JSON written, and everything that does not
/// depend on time as it was when somebody last read it.
#[test]
fn the_main_job_holds() {
    let folder = folder();
    let out = folder.path().join("out");
    let output = palmistry(&["verify", "--out", out.to_str().unwrap(), "--json"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let mut found = json(&output);
    without_times(&mut found);
    let written = std::fs::read(out.join("verify.json")).unwrap();
    let mut written: serde_json::Value = serde_json::from_slice(&written).unwrap();
    without_times(&mut written);
    assert_eq!(found, written);

    let page = std::fs::read_to_string(out.join("index.html")).unwrap();
    // with the systems as mathematics; a mail takes ten times as much
    assert!(page.len() < 1_300_000, "{} bytes", page.len());
    assert!(!page.contains("could not be drawn"));
    for outside in ["src=\"http", "href=\"http", "url(http"] {
        assert!(!page.contains(outside), "the page is to need nothing from elsewhere");
    }
    assert_eq!(page.matches("<svg ").count(), page.matches("</svg>").count());

    slow_scenes_are_there(&found, &page);

    insta::assert_json_snapshot!("errata", found["errata"]);
    let files = found["files"].as_array().unwrap();
    insta::assert_json_snapshot!("appendix", files[0]["printed"]);
    let reductions: Vec<_> = files.iter().flat_map(|file| file["reductions"].as_array().unwrap()).collect();
    assert_eq!(reductions.len(), 3);
    for reduction in reductions {
        assert_eq!(reduction["proved"], true, "{reduction}");
        assert!(reduction["claims"].as_array().unwrap().len() > 10);
        let saved = &reduction["saved"];
        assert!(saved["states"].as_u64() < saved["states_of_the_larger"].as_u64(), "{saved}");
    }
    let ranks: Vec<_> = files
        .iter()
        .filter(|file| !file["ranks"].as_array().unwrap().is_empty())
        .map(|regime| {
            let rows: Vec<_> = regime["ranks"]
                .as_array()
                .unwrap()
                .iter()
                .map(|r| {
                    // several branches of one condition are summed up; each has its own answer for the own rows
                    let own: Vec<_> = r["branches"].as_array().map_or(vec![&r["own_rows"]["rank_histogram"]], |list| {
                        list.iter().map(|b| &b["own_rows"]["rank_histogram"]).collect()
                    });
                    if r["singularity"].is_string() {
                        return json!({ "set": r["set"], "singularity": r["singularity"] });
                    }
                    json!({ "set": r["set"], "full": r["rank_histogram"], "own": own, "certified": r["certified"] })
                })
                .collect();
            json!({ "file": regime["file"], "ranks": rows })
        })
        .collect();
    insta::assert_json_snapshot!("ranks", ranks);
}

/// Two slow scenes: one body that jumps, one under the sensor of section 3.5; what the bodies are stands in their scenes.
fn slow_scenes_are_there(found: &serde_json::Value, page: &str) {
    let experiments = found["experiments"].as_array().unwrap();
    let slow: Vec<_> = experiments.iter().filter(|one| one["motion"] == "quasistatic").collect();
    assert_eq!((experiments.len(), slow.len()), (4, 2));
    for (one, samples, mean, off) in [(slow[0], 60, 1.0, 1e-12), (slow[1], 270, 0.02, 2e-5)] {
        assert_eq!((&one["samples"], &one["shape"]["explained"]), (&json!(samples), &json!(true)), "{one}");
        assert!((one["shape"]["mean"].as_f64().unwrap() - mean).abs() < off, "{one}");
        assert!(one["ways"][0]["radius_error"].as_f64().unwrap() < 2.0 * off, "{one}");
        assert!(page.contains(one["scene"].as_str().unwrap()));
    }
    assert_eq!(slow[0]["simulation"]["jumps"].as_array().unwrap().len(), 1);
    assert_eq!(slow[0]["jumps"][0]["predicted"], true);
    let section =
        page.split_once("<section id=slow>").expect("a section").1.split_once("</section>").unwrap().0;
    // four pictures of what was touched, errors of the radii and of the orientation
    assert_eq!(section.matches("<h3>").count(), 2);
    assert_eq!(section.matches("After ").count(), 8);
    assert_eq!(section.matches("<svg ").count(), 12);
}

/// The expansion is the determinant: its monomials summed exactly at a rational point give the value of the graph.
#[test]
fn the_expansion_is_the_determinant() {
    use palmistry::expression::{Input, expand};
    use palmistry::number::{Rationals, parse_decimal};
    use palmistry::observability::{Coordinate, State};
    use palmistry::{System, system::Value};
    let mut system = System::read(std::path::Path::new(GENERAL)).unwrap();
    let Value::Scalar(determinant) = system.evaluate_text("det(A)").unwrap() else { panic!("not a number") };
    let is_angle = &system.angle_test();
    let expansion = expand(&mut system.graph, determinant, is_angle).unwrap();
    assert_eq!(expansion.numerator.len(), 1481); // also counted with SymPy
    // the monomials that the thesis prints of its own expansion (those that the scan leaves legible), with the factor -18
    assert_eq!(expansion.front.to_string(), "-18");
    let place = |name: &str| {
        (0..expansion.variables.len()).find(|i| expansion.variable_name(&system.graph, *i) == name).unwrap()
    };
    for (coefficient, factors) in [
        (-12, &[("r1", 3), ("cos(phi2)", 5), ("rho", 4), ("r2", 1), ("omega1", 1)][..]),
        (
            -4,
            &[("s1", 1), ("sin(phi2)", 1), ("r1", 2), ("cos(phi2)", 6), ("rho", 2), ("r2", 3), ("omega0", 1)],
        ),
        (-42, &[("r1", 2), ("cos(phi2)", 6), ("s1", 2), ("r2", 4), ("omega2", 1)]),
        (-2, &[("rho", 4), ("cos(phi2)", 6), ("r2", 4), ("omega0", 1)]),
        (12, &[("r1", 3), ("cos(phi2)", 5), ("rho", 4), ("r2", 1), ("omega0", 1)]),
        (12, &[("r1", 1), ("cos(phi2)", 3), ("r2", 3), ("rho", 4), ("omega0", 1)]),
        (18, &[("s1", 4), ("cos(phi2)", 4), ("r1", 2), ("s2", 2), ("omega2", 1)]),
        (-6, &[("r2", 4), ("s1", 2), ("rho", 2), ("cos(phi2)", 2), ("omega0", 1)]),
        (
            12,
            &[("s1", 1), ("sin(phi2)", 1), ("r2", 1), ("rho", 4), ("r1", 2), ("cos(phi2)", 2), ("omega0", 1)],
        ),
    ] {
        let mut wanted = [0; _];
        factors.iter().for_each(|(name, power)| wanted[place(name)] = *power);
        let found = expansion.numerator.terms().find(|(exponents, _)| **exponents == wanted);
        assert_eq!(found.map(|(_, c)| c.clone()), Some(coefficient.into()), "{factors:?}");
    }
    let q = |text: &str| parse_decimal(text).unwrap();
    let mut state = State::default();
    for (name, value) in [
        ("m", "3/7"),
        ("rho", "5/11"),
        ("s1", "13/8"),
        ("s2", "2/3"),
        ("r1", "9/5"),
        ("r2", "7/4"),
        ("omega0", "1/6"),
        ("omega1", "-8/3"),
        ("omega2", "12/5"),
    ] {
        state.values.insert(system.find_symbol(name).unwrap(), Coordinate::Number(q(value)));
    }
    state.values.insert(system.find_symbol("phi2").unwrap(), Coordinate::from_half_tangent(&q("3/2")));
    let exact = Rationals::default();
    let values: Vec<_> = expansion
        .variables
        .iter()
        .map(|input| {
            match (
                input,
                state.values.get(match input {
                    Input::Plain(s) | Input::Sine(s) | Input::Cosine(s) => s,
                    Input::Opaque(_) => panic!("a function"),
                }),
            ) {
                (Input::Plain(_), Some(Coordinate::Number(v))) => v.clone(),
                (Input::Sine(_), Some(Coordinate::Angle { sine, .. })) => sine.clone(),
                (Input::Cosine(_), Some(Coordinate::Angle { cosine, .. })) => cosine.clone(),
                other => panic!("{other:?}"),
            }
        })
        .collect();
    let order: Vec<usize> = (0..expansion.numerator.len()).collect();
    let within: Vec<usize> = (0..values.len()).collect();
    let sum = expansion.sum_terms(&exact, &values, &order, &within).unwrap();
    let roots = palmistry::expression::expand_angles(&mut system.graph, &[determinant], is_angle);
    let program = palmistry::expression::Program::new(&system.graph, &roots, is_angle);
    let inputs = state.inputs(&program, &exact).unwrap();
    let direct = program.load(exact).unwrap().run(&inputs, &mut Vec::new()).unwrap();
    assert_eq!(sum, direct[0]);
}
