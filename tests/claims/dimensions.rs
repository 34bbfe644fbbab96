//! Dimensions: what is declared is checked everywhere, what is not is inferred, and a mistake is marked at its operator.

use palmistry::System;
use palmistry::system::ReadError;
use std::path::{Path, PathBuf};

/// The proof files of the thesis.
fn files() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("proofs/moll2002");
    let mut files: Vec<PathBuf> =
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.retain(|path| path.extension().is_some_and(|end| end == "proof"));
    files.sort();
    files
}

/// The mistake as one line: where, what, and the advice.
fn line(error: &ReadError) -> String {
    let (line, column) = error.line_and_column();
    format!("{line}:{column}: {} ({})", error.message, error.help.as_deref().unwrap_or_default())
}

/// All that is wrong with a text.
fn all_mistakes(name: &str, text: &str, folder: &Path) -> Vec<ReadError> {
    System::examine_text(name, text, folder, 1000).problems
}

#[test]
fn the_thesis_is_right_in_its_dimensions() {
    let mut mistakes = Vec::new();
    for file in files() {
        let text = std::fs::read_to_string(&file).unwrap();
        let name = file.display().to_string();
        let found = all_mistakes(&name, &text, file.parent().unwrap());
        mistakes.extend(found.iter().map(|one| format!("{name}:{}", line(one))));
    }
    assert!(mistakes.is_empty(), "{}", mistakes.join("\n"));
}

/// A body on a spring, with everything that a file can hold.
const SPRING: &str = r#"system "A body on a spring"
state x : length, v
param m : mass = 1, k : stiffness = 4, c
param g : acceleration = -9.81, period = 3, T : temperature, e0 : energy = 1
param phi, b
angle phi
let kinetic : energy = m*v^2/2
let total = kinetic + k*x^2/2
let mass_matrix = [m, 0; 0, m*b^2]
drift f
  x' = v
  v' = -k*x/m - c*v/m + g
input push
  v' = 1/m
  others' = 0
output x, total : joule
sample x in [1, 2] v in [1, 2] avoid total - e0
"#;

fn mistakes(claim: &str) -> Vec<ReadError> {
    let text = format!("{SPRING}{claim}\n");
    all_mistakes("spring.proof", &text, Path::new(""))
}

/// The text that a mistake marks.
fn marked(error: &ReadError) -> &str {
    let text = error.source_code.inner();
    &text[error.span.offset()..error.span.offset() + error.span.len()]
}

/// A row a mistake: what is written, the marked place with what stands before it, and a part of the message. By hand:
/// `x` is a length, `v` a velocity by the drift, `c` mass/time by the drift, `b` a length by nothing but what the row says.
#[test]
fn every_mistake_is_marked_at_its_operator() {
    for (text, before, operator, message) in [
        ("claim 1: x + v = 0", "x ", "+", "terms of two dimensions: length + length/time"),
        ("claim 1: 2*x - x^2 = 0", "2*x ", "-", "length - length^2"),
        ("claim 1: x + 1 = x", "x ", "+", "length + number"),
        ("claim 1: x = v", "x ", "=", "two sides of two dimensions: length = length/time"),
        ("claim 1: x <= 2*v where x > 0", "x ", "<=", "length <= length/time"),
        ("claim 1: 0 < x < v", "x ", "<", "length < length/time"),
        ("claim 1: x in [x, v]", "x ", "in", "length <= length/time"),
        ("claim 1: x != 3", "x ", "!=", "length != number"),
        ("claim 1: x = 0 where v = x", "v ", "=", "length/time = length"),
        ("claim 1: sin(x) = 0", "", "sin", "'sin' takes a number without dimension, not length"),
        ("claim 1: exp(1 + x/v) = 0", "1 ", "+", "number + time"),
        ("claim 1: atan(T) = log(2)", "", "atan", "not temperature"),
        ("claim 1: cot(x/v) = 0", "", "cot", "not time"),
        ("claim 1: sqrt(x) = x", "sqrt(x) ", "=", "length^(1/2) = length"),
        ("claim 1: (x/v)^3 = x", "(x/v)^3 ", "=", "time^3 = length"),
        ("claim 1: x^(-2) = v", "x^(-2) ", "=", "1/length^2 = length/time"),
        ("claim 1: L(f, x) = x", "L(f, x) ", "=", "length/time = length"),
        ("claim 1: L(f, push, x) = v", "L(f, push, x) ", "=", "1/mass = length/time"),
        ("claim 1: d(total, x) = [e0]", "d(total, x) ", "=", "mass*length/time^2 = mass*length^2/time^2"),
        ("claim 1: d(total) = [k*x, m]", "d(total) ", "=", "mass*length/time = mass, in row 1, column 2"),
        ("claim 1: [x, v] + [x, x] = [0, 0]", "[x, v] ", "+", "length/time + length, in row 1, column 2"),
        ("claim 1: [x, v]*[x; v] = [0]", "[x, v]", "*", "the product adds products of two dimensions"),
        ("claim 1: dot([x, v], [x, v]) = 0", "", "dot", "'dot' adds products of two dimensions"),
        ("claim 1: cross([x, v], [v, v]) = 0", "", "cross", "'cross' adds products of two dimensions"),
        ("claim 1: cross([x; x; v], [x; v; v]) = [0; 0; 0]", "", "cross", "'cross' adds"),
        ("claim 1: det([x, x; v, x]) = 0", "", "det", "the determinant adds products of two dimensions"),
        ("claim 1: det([x, x; v, v]) = x", ") ", "=", "length^2/time = length"),
        ("claim 1: inverse([x, x; v, m]) = [0, 0; 0, 0]", "", "inverse", "the inverse adds products"),
        ("claim 1: inverse([x, 0; 0, v]) = [x, 0; 0, v]", ") ", "=", "1/length = length, in row 1, column 1"),
        ("claim 1: transpose([x, v]) = [v; x]", ") ", "=", "in row 1, column 1"),
        ("claim 1: rank([x + v]) = 1", "[x ", "+", "length + length/time"),
        ("claim 1: pole(x/(v - x), v) = 1", "(v ", "-", "length/time - length"),
        ("claim 1: x at {v = x} = 0", "{v ", "=", "'v' is length/time, and what stands for it is length"),
        ("claim 1: (x at {x = 2}) + 3 = 5", "2}) ", "+", "length + number"),
        ("claim 1: x at {x = 0} = 3", "} ", "=", "length = number"),
        ("claim 1: x at {phi = 1} = 3", "} ", "=", "length = number"),
        (
            "claim 1: x = x within v",
            "within ",
            "v",
            "what is compared is length, and its tolerance length/time",
        ),
        (
            "let w : energy = m*v",
            ": ",
            "energy",
            "'w' is declared as mass*length^2/time^2, and is mass*length/time",
        ),
        ("output m*v : energy", ": ", "energy", "'m*v' is declared as"),
        ("field h x' = v v' = v others' = 0", "v' ", "=", "in 'h' the rate of 'v' has to be"),
        ("param p : 1 input h x' = 1 v' = p others' = 0", "v' ", "=", "has to be 1/time, and is number"),
        ("param p : length angle p", ": ", "length", "'p' is declared as length, and an angle is a number"),
        ("claim 1: b = x claim 2: b = v", "claim 2: b ", "=", "length = length/time"),
        ("claim 1: b^2 = x*v claim 2: sin(b) = 0", "claim 2: ", "sin", "length/time^(1/2)"),
        ("claim 1: T*x = c*v", "x ", "=", "length*temperature = mass*length/time^2"),
        ("claim 1: x # 1 + 2 = 3\n + # +\n v = 0", "# 1 + 2 = 3\n ", "+", "length + length/time"),
        ("claim 1: total = m*v^2/2 + k*x/2", "m*v^2/2 ", "+", "mass*length^2/time^2 + mass*length/time^2"),
        ("claim 1: L(bracket(f, push), x) = x", ") ", "=", "1/mass"),
        ("claim 1: bracket(f, push) = [x; v]", ") ", "=", "1/mass = length, in row 1, column 1"),
        ("claim 1: d(total, x) + e0 = 0", ") ", "+", "mass*length/time^2 + mass*length^2/time^2"),
        ("set \"s\": x = v", "x ", "=", "length = length/time"),
        ("pole \"s\": x > 1, sin(x) = 0", "", "sin", "not length"),
        ("line \"s\": x to v", "to ", "v", "'x' is length, and what stands for it is length/time"),
        ("line \"s\": x to x = v", "x ", "=", "length = length/time"),
        ("claim 1: pi*x + pi = 0", "x ", "+", "length + number"),
    ] {
        let found = mistakes(text);
        let [one] = found.as_slice() else {
            panic!("{text}: {:?}", found.iter().map(line).collect::<Vec<_>>());
        };
        assert!(one.message.contains(message), "{text}: {}", line(one));
        assert_eq!(marked(one), operator, "{text}: {}", line(one));
        let whole = one.source_code.inner();
        assert!(whole[..one.span.offset()].ends_with(before), "{text}: {}", line(one));
        // the reader stops at it
        let error = System::parse("spring.proof", whole, Path::new("")).unwrap_err();
        assert_eq!((error.message.as_str(), error.span), (one.message.as_str(), one.span), "{text}");
    }
}

/// What is right is let through: numbers in the file's units, zero, unknowns, what is said to be wrong.
#[test]
fn what_has_one_dimension_is_let_through() {
    for text in [
        "claim 1: x = 0",
        "claim 1: total = m*v^2/2 + k*x^2/2",
        "claim 1: L(f, total) = (m*g - c*v)*v",
        "claim 1: d(total) = [k*x, m*v]",
        "claim 1: d(x) = [1, 0]",
        "claim 1: rank([d(x); d(L(f, x))]) = 2",
        "claim 1: pole(1/x, x) = 1",
        // an entry that takes part in no product of the determinant may be anything
        "claim 1: det([x, T, v; 0, x, x; 0, m, m]) = 0",
        "claim 1: inverse(mass_matrix) = [1/m, 0; 0, 1/(m*b^2)]",
        "claim 1: total at {x = 1, v = 2} = 3",
        "claim 1: total at {x = 1, v = 2} = 3 within 1e-3",
        "claim 1: total = 3 where x = 1, v = 2",
        "claim 1: x <= 2 on sample",
        "claim 1: x > 1 where x > 2",
        "claim 1: x in [1, 2] where x in [1, 2]",
        "claim 1: sin(2*pi*x/(v*T/T)*v/x) = 0",
        "claim 1: sqrt(k/m) = v/x",
        "claim 1: x*0 = v*0",
        "claim 1: [x, v] = [0, 0]",
        "claim 1: b*x = v",
        "claim 1 expect refuted: x = v",
        "erratum 1: printed x = v corrected x = x",
        "scan 1: scanned \"x\" repaired x = x",
        "let length = x let time = length/v claim 1: time*v = length",
        "claim 1: x at {x = 2*x} = 2*x",
        "claim 1: cross([x; x; 0], [v; v; 0]) = [0; 0; 0]",
        "claim 1: x^0 + 1 = 2",
        "claim 1: L(bracket(f, push), m*x) = L(f, push, m*x) - L(push, f, m*x)",
        "claim 1: bracket(f, push, x) = -1/m",
        "claim 1: d(total, x) + m*g = k*x + m*g",
        "set \"s\": x = 2, v < 0 map \"m\": x in [0, 1], v in [0, 1] line \"l\": x to 0 line \"i\": x to infinity",
        "field h x' = x others' = 0 claim 1: L(h, h, v*x) = x*v",
    ] {
        let found = mistakes(text);
        assert!(found.is_empty(), "{text}: {:?}", found.iter().map(line).collect::<Vec<_>>());
    }
}

/// Without a declaration nothing is checked, and nothing known.
#[test]
fn a_file_that_declares_nothing_is_not_checked() {
    let text = "system \"s\" state x, v drift f x' = v v' = x + x^2 output x claim 1: x = sin(x) + v";
    let system = System::parse("s", text, Path::new("")).unwrap();
    assert!(!system.declares_dimensions());
    assert!(system.symbols().all(|(symbol, _)| system.dimension_of(symbol).is_none()));
}

/// What is not declared is found by linear equations in the exponents.
#[test]
fn what_is_not_declared_is_inferred() {
    let text = format!("{SPRING}claim 1: b^2*T = x^3\n");
    let system = System::parse("spring.proof", &text, Path::new("")).unwrap();
    let of = |name: &str| {
        let dimension = system.dimension_of(system.find_symbol(name).unwrap());
        dimension.map(|one| (one.to_string(), one.unit()))
    };
    let pair = |a: &str, b: &str| Some((a.to_owned(), b.to_owned()));
    assert_eq!(of("v"), pair("length/time", "m/s"));
    assert_eq!(of("c"), pair("mass/time", "kg/s"));
    assert_eq!(of("b"), pair("length^(3/2)/temperature^(1/2)", "m^(3/2)/K^(1/2)"));
    assert_eq!(of("phi"), pair("1", "1"));
    assert_eq!(of("e0"), pair("mass*length^2/time^2", "kg*m^2/s^2"));
    assert_eq!(of("period"), None);
}

/// A conflict that another line has part in names that line.
#[test]
fn a_conflict_names_both_places() {
    let found = mistakes("claim 1: b = x\nclaim 2: b = v");
    let lines = SPRING.matches('\n').count();
    assert_eq!(found[0].line_and_column(), (lines + 2, 12));
    let help = found[0].help.as_deref().unwrap();
    assert!(help.contains(&format!("'b' is length by line {}", lines + 1)), "{help}");
    let found = mistakes("claim 1: c = x");
    let help = found[0].help.as_deref().unwrap();
    assert!(help.contains("'c' is mass/time by line 12"), "{help}");
    // all of them, in the order of the file; what follows from a mistake is no other one
    let found = mistakes("claim 1: x = v\nclaim 2: sin(x) + cos(v) = x^2");
    assert_eq!(found.len(), 3, "{:?}", found.iter().map(line).collect::<Vec<_>>());
}

/// The dimension of a declared name.
fn declared(dimension: &str) -> Result<String, ReadError> {
    let text = format!("system \"s\" state x : {dimension}\noutput x");
    let system = System::parse("s", &text, Path::new(""))?;
    Ok(system.dimension_of(system.states[0]).unwrap().to_string())
}

/// Quantities and units of the SI, by name and by symbol. The oracle is the definition of each unit by others (BIPM, The
/// International System of Units, 9th edition, 2019, table 4).
#[test]
fn quantities_and_units() {
    for group in [
        &["force", "newton", "N", "kg*m/s^2", "mass*acceleration", "J/m"][..],
        &["pressure", "Pa", "N/m^2", "energy/volume"],
        &["energy", "joule", "J", "N*m", "torque", "W*s"],
        &["power", "W", "J/s", "V*A", "force*velocity"],
        &["charge", "C", "A*s", "coulomb"],
        &["voltage", "V", "W/A", "J/C", "volt"],
        &["resistance", "ohm", "V/A"],
        &["conductance", "S", "A/V", "siemens", "1/ohm"],
        &["capacitance", "F", "C/V", "farad"],
        &["magnetic_flux", "Wb", "V*s", "weber"],
        &["magnetic_field", "T", "Wb/m^2", "tesla"],
        &["inductance", "H", "Wb/A", "henry"],
        &["frequency", "Hz", "1/s", "s^(-1)", "rate", "rad/s"],
        &["inertia", "kg*m^2", "mass*length^2"],
        &["stiffness", "N/m", "force/length"],
        &["damping", "N*s/m", "kg/s"],
        &["illuminance", "lx", "lm/m^2", "cd*sr/m^2"],
        &["dose", "Gy", "Sv", "J/kg", "velocity^2"],
        &["catalytic_activity", "kat", "mol/s"],
        &["entropy", "J/K"],
        &["specific_heat_capacity", "J/(kg*K)"],
        &["thermal_conductivity", "W/(m*K)"],
        &["viscosity", "Pa*s"],
        &["electric_field", "V/m", "N/C"],
        &["1", "dimensionless", "angle", "rad", "m/m", "sr", "Hz*s"],
        &["length^(1/2)", "m^(2/4)", "(m^2)^(1/4)", "1/m^(-1/2)"],
    ] {
        let found: Vec<String> = group.iter().map(|text| declared(text).unwrap()).collect();
        assert!(found.iter().all(|one| *one == found[0]), "{group:?}: {found:?}");
        // what is printed can be read again, and is the same
        assert_eq!(declared(&found[0]).unwrap(), found[0], "{group:?}");
    }
    let bases = ["mass", "length", "time", "current", "temperature", "amount", "luminous_intensity"];
    for (base, unit) in bases.iter().zip(["kg", "m", "s", "A", "K", "mol", "cd"]) {
        assert_eq!(
            (declared(base).unwrap(), declared(unit).unwrap()),
            ((*base).to_owned(), (*base).to_owned())
        );
    }
}

/// What is no dimension is refused at its place, with advice.
#[test]
fn what_is_no_dimension_is_refused() {
    for (text, at, message, advice) in [
        ("lenght", "lenght", "'lenght' is none", "perhaps you meant 'length'"),
        ("mm", "mm", "'mm' has one", "write 'length'"),
        ("degree", "degree", "without a factor", "write 'angle'"),
        ("km/hour", "km", "without a factor", "write 'length'"),
        ("2*m", "2", "1 is the only number", "units of the SI"),
        ("m^1/2", "2", "1 is the only number", "length^(1/2)"),
        ("m^x", "x", "an exponent", ""),
        ("m^(1/0)", "(", "not divided by zero", ""),
        ("m^1000", "1000", "at most 100", ""),
        ("(m*s", "output", "')'", ""),
        ("m*", "output", "'output' is none", ""),
        ("", "output", "'output' is none", ""),
        ("[m]", "[", "a dimension, as in", "for instance"),
    ] {
        let error = declared(text).unwrap_err();
        assert!(error.message.contains(message), "{text}: {}", line(&error));
        assert!(error.help.as_deref().unwrap_or_default().contains(advice), "{text}: {}", line(&error));
        // what is missing at the end of a line is marked there
        let found = error.source_code.inner()[error.span.offset()..].trim_start();
        assert!(found.starts_with(at), "{text}: {}", line(&error));
    }
}

/// A dimension holds for the names before it in the list that have none, and may stand before or behind a value.
#[test]
fn a_dimension_holds_for_the_names_before_it() {
    let text = "system \"s\" state x, y : length, v : velocity, w # the last : mass\n\
                param a = 1, h, b : mass = 2, c = 3 : time, e\n";
    let system = System::parse("s", text, Path::new("")).unwrap();
    let of = |name: &str| system.dimension_of(system.find_symbol(name).unwrap()).map(ToString::to_string);
    let found: Vec<Option<String>> = ["x", "y", "v", "w", "a", "h", "b", "c", "e"].map(of).to_vec();
    let known = |text: &str| Some(text.to_owned());
    assert_eq!(
        found,
        [
            known("length"),
            known("length"),
            known("length/time"),
            None,
            None,
            known("mass"),
            known("mass"),
            known("time"),
            None
        ]
    );
    let default = |name: &str| system.symbol_info(system.find_symbol(name).unwrap()).unwrap().default.clone();
    assert_eq!(["a", "b", "c"].map(|name| default(name).unwrap().to_string()), ["1", "2", "3"]);
}

/// What is imported brings its dimensions, and two files that mean two things by one name are told so.
#[test]
fn imports_bring_their_dimensions() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("spring.proof"), SPRING).unwrap();
    let parse = |text: &str| all_mistakes("other.proof", text, folder.path());
    let head = "system \"other\" use s = \"spring.proof\"\n";
    let found = parse(&format!("{head}state x\nclaim 1: s.total = L(s.f, s.total)"));
    assert_eq!(found.len(), 1);
    assert!(found[0].message.contains("mass*length^2/time^2 = mass*length^2/time^3"), "{}", found[0].message);
    assert!(parse(&format!("{head}claim 1: L(s.push, v) = 1/m")).is_empty());
    let found = parse(&format!("{head}state x : time\n"));
    assert!(
        found[0].message.contains("'x' is time here, and length in the imported file"),
        "{}",
        line(&found[0])
    );
    assert_eq!(marked(&found[0]), "time");
    // an unknown of the import is one here: 'period' is said to be two things
    let found = parse(&format!("{head}claim 1: period = x\nclaim 2: period = v"));
    assert_eq!(found.len(), 1);
    // a mistake in the import is shown where it is imported
    std::fs::write(folder.path().join("wrong.proof"), format!("{SPRING}claim 1: x = v\n")).unwrap();
    let error = System::parse("o", "system \"o\" use s = \"wrong.proof\"", folder.path()).unwrap_err();
    assert!(error.message.contains("wrong.proof:18:12: two sides of two dimensions"), "{}", line(&error));
    // an import that declares nothing brings nothing that could be wrong
    std::fs::write(folder.path().join("plain.proof"), "system \"p\" state a, b let sum = a + sin(b)")
        .unwrap();
    let text =
        "system \"o\" use s = \"plain.proof\" state a : length claim 1: s.sum = a claim 2: s.sum = a^2";
    assert!(parse(text).is_empty());
}

/// A file that is made to cost much costs little, and no text makes the reader panic.
#[test]
fn no_file_costs_much() {
    let begin = std::time::Instant::now();
    // a chain of a thousand unknowns, asked for a thousand times
    let names: Vec<String> = (0..1000).map(|place| format!("a{place}")).collect();
    let claims: String = names
        .windows(2)
        .enumerate()
        .map(|(n, two)| format!("claim c{n}: {} = {}^2\n", two[0], two[1]))
        .collect();
    let text =
        format!("system \"s\" state x : length param {}\n{claims}claim last: a999 = x\n", names.join(", "));
    let system = System::parse("s", &text, Path::new("")).unwrap();
    let first = system.dimension_of(system.find_symbol("a990").unwrap()).unwrap();
    assert_eq!(first.to_string(), "length^512");
    // powers of powers
    let tower = (0..40).fold("x".to_owned(), |inner, _| format!("({inner})^2"));
    let text = format!("system \"s\" state x : length let y = sqrt({tower}) claim 1: y = x");
    let found = all_mistakes("s", &text, Path::new(""));
    assert!(found[0].message.contains(&format!("length^{}", 1u64 << 39)), "{}", found[0].message);
    assert!(begin.elapsed().as_secs() < 60);
}

mod any_text {
    use super::SPRING;
    use proptest::prelude::*;
    use std::path::Path;

    proptest! {
        #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

        /// Words of the language in any order behind a colon, and in claims.
        #[test]
        fn no_text_makes_the_reader_panic(
            words in prop::collection::vec(prop::sample::select(vec![
                "length", "kg", "1", "2", "^", "(", ")", "*", "/", ":", ",", "=", "-", "x", "#", "\n", "{", "}", "at", "[", "]",
                ";", "+", "sin", "det", "L", "f", "d", "inverse", "claim a:", "where", "0", "within", "<", "é", "mm", "d(",
            ]), 0..24),
        ) {
            let words = words.join(" ");
            for text in [
                format!("system \"s\" state x : {words}"),
                format!("{SPRING} claim z: {words}"),
                format!("{SPRING} param q : {words} = 3"),
                format!("{SPRING} let q : {words}"),
            ] {
                let _ = super::all_mistakes("s", &text, Path::new(""));
            }
        }
    }
}
