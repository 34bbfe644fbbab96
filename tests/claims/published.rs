//! What is published is read back: every statement and definition that the outcomes of the shipped proofs show is parsed as
//! the language, by itself, and has the values that it has in its file, at random points and at the shown witnesses.

use dashu::rational::RBig;
use palmistry::expression::{Expected, Input, NodeId, Program, parse_expression};
use palmistry::number::{Floats, parse_decimal};
use palmistry::observability::NamedCoordinate;
use palmistry::system::{ClaimBody, Kind, Value};
use palmistry::{Outcome, System, Verdict, Witness, decide_all};
use std::collections::HashMap;
use std::path::{Path, PathBuf};

fn proofs() -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> =
        std::fs::read_dir("proofs/moll2002").unwrap().map(|entry| entry.unwrap().path()).collect();
    files.retain(|path| path.extension().is_some_and(|extension| extension == "proof"));
    files.sort();
    files
}

/// Names with dots belong to imported systems and cannot be declared: the dots become underscores.
fn undotted(text: &str) -> String {
    let mut out = String::new();
    let mut within_a_name = false;
    let mut characters = text.chars().peekable();
    while let Some(c) = characters.next() {
        let begins = c.is_ascii_alphabetic() || c == '_';
        let number = out.chars().next_back().is_some_and(|last| last.is_ascii_digit() || last == '.');
        within_a_name =
            begins && (within_a_name || !number) || within_a_name && (c.is_ascii_digit() || c == '.');
        let next = characters.peek().is_some_and(|next| next.is_ascii_alphabetic() || *next == '_');
        if c == '.' && within_a_name && next { out.push_str("__") } else { out.push(c) }
    }
    out
}

/// `d(e)` is by all states of its file: here these are named, since what is moved by shown fields is a state too.
fn by_states(text: &str, states: &[String]) -> String {
    let mut out = String::new();
    // for each open bracket whether it is that of a 'd', and whether a comma has been met in it
    let mut open: Vec<(bool, bool)> = Vec::new();
    for c in text.chars() {
        match c {
            '(' | '[' | '{' => {
                let before = out.strip_suffix('d').map(|rest| rest.chars().next_back());
                let differential = c == '('
                    && before.is_some_and(|last| last.is_none_or(|c| !c.is_ascii_alphanumeric() && c != '_'));
                open.push((differential, false));
            }
            ',' => open.iter_mut().last().into_iter().for_each(|(_, comma)| *comma = true),
            ')' | ']' | '}' if open.pop() == Some((true, false)) => {
                out.push_str(&format!(", {}", states.join(", ")));
            }
            _ => {}
        }
        out.push(c);
    }
    out
}

fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !c.is_ascii_alphanumeric() && c != '_').filter(|word| !word.is_empty())
}

fn own_states(system: &System) -> Vec<String> {
    system.states.iter().map(|state| system.symbol_name(*state).to_owned()).collect()
}

/// A file that knows the symbols of a system, and nothing else but what an outcome shows.
fn shown_alone(system: &System, outcome: &Outcome) -> String {
    let own = own_states(system);
    // (name, text of the entry): definitions, and fields under names that no definition has
    let mut waiting: Vec<(String, String, String)> = Vec::new();
    for (name, text) in &outcome.definitions {
        let (name, text) = (undotted(name), by_states(&undotted(text), &own));
        waiting.push((name.clone(), format!("let {name} = {text}"), text));
    }
    let mut moved: Vec<String> = Vec::new();
    for (name, text) in &outcome.differentiated_along {
        let (name, text) = (undotted(name), undotted(text));
        let states = text.split('\'').filter_map(|part| words(part).last().map(str::to_owned));
        moved.extend(states.filter(|state| system.find_symbol(state).is_some()));
        let others = if text.contains("others'") { "" } else { "  others' = 0" };
        waiting.push((format!("field {name}"), format!("field {name}  {text}{others}"), text));
    }
    let mut states = own.clone();
    for name in moved {
        if !states.contains(&name) {
            states.push(name);
        }
    }
    let all: Vec<String> =
        system.symbols().map(|(symbol, _)| system.symbol_name(symbol).to_owned()).collect();
    let others: Vec<&String> = all.iter().filter(|name| !states.contains(name)).collect();
    let angles: Vec<&String> =
        all.iter().filter(|name| system.is_angle(system.find_symbol(name).unwrap())).collect();
    let join = |names: &[&String]| names.iter().map(|name| name.as_str()).collect::<Vec<_>>().join(", ");
    let mut text = "system \"what is shown\"\n".to_owned();
    for (word, names) in [("state", states.iter().collect()), ("param", others), ("angle", angles)] {
        if !names.is_empty() {
            text.push_str(&format!("{word} {}\n", join(&names)));
        }
    }
    // each entry behind those that it mentions
    while !waiting.is_empty() {
        let pending: Vec<String> = waiting.iter().map(|(name, _, _)| name.clone()).collect();
        let ready = waiting.iter().position(|(name, _, body)| {
            pending.iter().all(|other| {
                let bare = other.trim_start_matches("field ");
                other == name
                    || bare != *other && !body.contains("L(")
                    || !words(body).any(|word| word == bare)
            })
        });
        let ready = ready.unwrap_or_else(|| panic!("{}: {waiting:?}", outcome.id));
        text.push_str(&format!("{}\n", waiting.remove(ready).1));
    }
    text
}

/// A point: a value for every symbol by name, its own for each seed; angles are numbers like all others.
fn point(system: &System, seed: u64) -> HashMap<String, RBig> {
    let value = |place: u64| RBig::from(3 + (place * 7 + seed * 5) % 11) / RBig::from(4 + (place + seed) % 5);
    let symbols = system.symbols().enumerate();
    symbols.map(|(i, (symbol, _))| (system.symbol_name(symbol).to_owned(), value(i as u64))).collect()
}

/// The entries of an expression.
fn entries(system: &mut System, text: &str) -> Vec<NodeId> {
    match system.evaluate_text(text).unwrap_or_else(|error| panic!("{error}: {text}")) {
        Value::Scalar(id) | Value::Solutions(id) => vec![id],
        Value::Matrix(matrix) | Value::Rank(matrix) => matrix.entries,
        Value::Pole { expression, factor } => vec![expression, factor],
        Value::CodistributionRank | Value::Visible { .. } | Value::Infinity => Vec::new(),
    }
}

/// The value of an entry at a point in doubles, if it exists.
fn value(system: &System, entry: NodeId, point: &HashMap<String, RBig>) -> Option<f64> {
    let program = Program::plain(&system.graph, &[entry]);
    let inputs = program.inputs().iter().map(|input| match input {
        Input::Plain(symbol) => point.get(system.symbol_name(*symbol)).map(|value| value.to_f64().value()),
        _ => None,
    });
    let inputs: Vec<f64> = inputs.collect::<Option<_>>()?;
    let found = program.load(Floats).ok()?.run(&inputs, &mut Vec::new()).ok()?[0];
    found.is_finite().then_some(found)
}

fn near(a: f64, b: f64, relative: f64) -> bool {
    (a - b).abs() <= relative * a.abs().max(b.abs()).max(1.0)
}

/// The texts of the two sides of each statement of a claim.
fn sides(system: &System, claim: usize) -> Vec<(String, String, bool)> {
    let statements = system.claims[claim].body.statements();
    let text = |span: &std::ops::Range<usize>| system.source[span.clone()].to_owned();
    let sides = statements
        .iter()
        .map(|s| (text(&s.equation.left.span), text(&s.equation.right.span), s.conditions.is_empty()));
    sides.collect()
}

/// The point that a witness shows; what it does not mention is anywhere.
fn shown_point(system: &System, witness: &Witness) -> HashMap<String, RBig> {
    let mut values = point(system, 1);
    for NamedCoordinate { name, exact, value: float } in &witness.state {
        let value = parse_decimal(exact).or_else(|| RBig::try_from(*float).ok());
        values.insert(name.clone(), value.unwrap());
    }
    values
}

#[test]
fn every_shown_statement_is_read_back_and_has_its_values() {
    let (mut compared, mut at_witnesses, mut definitions) = (0, 0, 0);
    for path in proofs() {
        let mut system = System::read(&path).unwrap();
        let outcomes = decide_all(&system, 1, &false.into(), &|_| ());
        for (place, outcome) in outcomes.iter().enumerate() {
            let kind = &system.claims[place].body;
            if matches!(kind, ClaimBody::Definition { .. } | ClaimBody::Open { .. }) {
                continue;
            }
            // signals of an imported file cannot be declared anew; that file's own claims are among those compared
            if system.symbols().any(|(symbol, info)| {
                info.kind == Kind::Imported && system.symbol_name(symbol).contains('\'')
            }) {
                continue;
            }
            let mut text = shown_alone(&system, outcome);
            definitions += outcome.definitions.len();
            let printed = outcome.printed.as_ref().map(|(statement, _)| statement);
            for (i, statement) in printed.into_iter().chain([&outcome.statement]).enumerate() {
                if !statement.starts_with("rank =") {
                    let statement = by_states(&undotted(statement), &own_states(&system));
                    text.push_str(&format!("claim {i}: {statement}\n"));
                }
            }
            let mut alone = System::parse("shown", &text, Path::new("")).unwrap_or_else(|error| {
                panic!("{}: {error} at {:?}\n{text}", outcome.id, error.line_and_column())
            });
            let whole = sides(&system, place);
            for (claim, of_the_file) in whole.iter().enumerate().take(alone.claims.len()) {
                let (left, right, free) = sides(&alone, claim).remove(0);
                for (shown, meant) in [(&left, &of_the_file.0), (&right, &of_the_file.1)] {
                    let (shown, meant) = (entries(&mut alone, shown), entries(&mut system, meant));
                    assert_eq!(shown.len(), meant.len(), "{}: {text}", outcome.id);
                    // of a large matrix some entries, never the same of two claims
                    let step = shown.len().div_ceil(3).max(1);
                    let at = point(&system, place as u64 % 7);
                    for entry in (place % step..shown.len()).step_by(step) {
                        let (a, b) = (value(&alone, shown[entry], &at), value(&system, meant[entry], &at));
                        let (Some(a), Some(b)) = (a, b) else {
                            assert_eq!(a, b, "{}: {text}", outcome.id);
                            continue;
                        };
                        assert!(near(a, b, 1e-9), "{}: {a} {b}\n{text}", outcome.id);
                        compared += 1;
                    }
                }
                let refuted = match (&outcome.printed, &outcome.verdict) {
                    (Some((_, Verdict::Refuted { witness, .. })), _) if claim == 0 => witness,
                    (None, Verdict::Refuted { witness, .. }) => witness,
                    _ => continue,
                };
                if !free || witness_is_a_rank(&left, &right) {
                    continue;
                }
                let at = shown_point(&system, refuted);
                for (side, print) in [(&left, &refuted.left), (&right, &refuted.right)] {
                    let found = entries(&mut alone, side);
                    let columns = columns(&mut alone, side);
                    let entry = refuted.entry.map_or(0, |(row, column)| (row - 1) * columns + column - 1);
                    let print = parse_decimal(print).unwrap_or_else(|| panic!("{}: {print}", outcome.id));
                    let found = value(&alone, found[entry], &at).unwrap();
                    assert!(
                        near(found, print.to_f64().value(), 1e-7),
                        "{}: {found} {print}\n{text}",
                        outcome.id
                    );
                    at_witnesses += 1;
                }
            }
        }
    }
    println!("{compared} values, {definitions} definitions, {at_witnesses} at witnesses");
    assert!(
        compared > 1000 && definitions > 1000 && at_witnesses > 60,
        "{compared} {definitions} {at_witnesses}"
    );
}

fn witness_is_a_rank(left: &str, right: &str) -> bool {
    [left, right].iter().any(|side| side.starts_with("rank") || side.starts_with("pole"))
}

fn columns(system: &mut System, text: &str) -> usize {
    match system.evaluate_text(text).unwrap() {
        Value::Matrix(matrix) | Value::Rank(matrix) => matrix.columns,
        _ => 1,
    }
}

/// An expression of the graph in the notation of the language is that expression: by hand, where brackets matter.
#[test]
fn what_the_graph_prints_is_read_back() {
    let mut system =
        System::parse("s", "system \"s\" state x, y, z angle z output x", Path::new("")).unwrap();
    for text in [
        "(x^2)^3",
        "x*y^2",
        "x/(y^2)",
        "(x/y)^2",
        "(-x)^2",
        "-x^2",
        "x - (y - z)",
        "x/(y/z)",
        "x/(y*z)",
        "x*(-2/3)",
        "(2/3)^2*x",
        "(-1/3)*x - (-2)",
        "-(x + y)*z",
        "x - -y",
        "sin(-z)/cos(z)",
        "(x + y)^(-2)",
        "sqrt(x)^3*pi",
    ] {
        let mut at = point(&system, 3);
        at.insert("z".to_owned(), RBig::from(1));
        let Value::Scalar(node) = system.evaluate_text(text).unwrap() else { panic!("{text}") };
        let printed = system.graph.text(node);
        let again = entries(&mut system, &printed)[0];
        let (meant, read) = (value(&system, node, &at).unwrap(), value(&system, again, &at).unwrap());
        assert!(near(meant, read, 1e-12), "{text}: {printed}");
    }
    // a long one is whole, and what is too long is described: it is never cut
    let long = (1..200).map(|n| format!("{n}*x^{n}")).collect::<Vec<_>>().join(" + ");
    let Value::Scalar(node) = system.evaluate_text(&long).unwrap() else { panic!() };
    assert!(system.graph.text(node).ends_with("199*x^199"));
    let tower = (0..40).fold("x + y".to_owned(), |text, _| format!("sin({text})*({})", "x + 1"));
    let Value::Scalar(mut node) = system.evaluate_text(&tower).unwrap() else { panic!() };
    for _ in 0..20 {
        node = system.graph.mul(node, node);
        node = system.graph.add(node, node);
    }
    let text = system.graph.text(node);
    assert!(text.starts_with("(an expression of ") && text.ends_with(" operations in x, y)"), "{text}");
}

/// A span is all of the text of its expression, signs and brackets included, and no more: each reads back alone.
#[test]
fn spans_hold_signs_and_no_blanks() -> Result<(), Expected> {
    for (text, shown) in [
        ("  -x  ", "-x"),
        ("+x # a comment", "+x"),
        ("- x*y + 2 # c", "- x*y + 2"),
        ("(-x)", "(-x)"),
        ("- -x^2 ", "- -x^2"),
        ("x^2 # c\n", "x^2"),
        ("x^(-2) ", "x^(-2)"),
        ("-[x, y] ", "-[x, y]"),
        ("x at {x = -1} ", "x at {x = -1}"),
        ("-f( x ) ", "-f( x )"),
    ] {
        let expr = parse_expression(text)?;
        assert_eq!(&text[expr.span.clone()], shown);
        let again = parse_expression(shown)?;
        assert_eq!(std::mem::discriminant(&again.kind), std::mem::discriminant(&expr.kind), "{text}");
    }
    Ok(())
}

/// The issue's own case: a definition, an output and what is avoided keep their leading minus.
#[test]
fn a_leading_minus_stays() {
    let text = "system \"s\" state x, y let a = -x # why\n  + y let b = -(x) output -x*y, - y sample avoid -x + y claim 1: -a = -b";
    let system = System::parse("s.proof", text, Path::new("")).unwrap();
    let outputs: Vec<&str> = system.outputs.iter().map(|(text, _)| text.as_str()).collect();
    assert_eq!(outputs, ["-x*y", "- y"]);
    assert_eq!(system.avoid[0].0, "-x + y");
    let outcome = decide_all(&system, 1, &false.into(), &|_| ()).remove(0);
    assert_eq!(outcome.statement, "-a = -b");
    let shown = |name: &str, text: &str| (name.to_owned(), text.to_owned());
    assert_eq!(outcome.definitions, [shown("a", "-x + y"), shown("b", "-(x)")]);
}
