use super::*;

/// The number of values of each unknown, none where infinitely many.
fn found(text: &str) -> Vec<(String, Option<usize>)> {
    let mut system: System = format!("system \"s\" {text}").parse().unwrap();
    let question = SolutionsQuestion {
        conditions: Assignment::new(),
        expressions: Vec::new(),
        work: WORK,
        interrupt: &AtomicBool::new(false),
    };
    let answer = solutions(&mut system, &question).unwrap();
    let number = |of_it: &SolutionsOf| match &of_it.solutions {
        Solutions::Finite(number) => Some(*number),
        Solutions::Infinite => None,
        Solutions::Undecided(why) => panic!("{}: {why}", of_it.name),
    };
    eprintln!("{answer:?}");
    answer.unknowns.iter().map(|of_it| (of_it.name.clone(), number(of_it))).collect()
}

fn is(text: &str, expected: &[(&str, Option<usize>)]) {
    let expected: Vec<(String, Option<usize>)> =
        expected.iter().map(|(name, n)| ((*name).to_owned(), *n)).collect();
    assert_eq!(found(text), expected, "{text}");
}

#[test]
fn a_square_has_two_roots() {
    is("state x param k unknown drift f x' = k^2*x output x", &[("x", Some(1)), ("k", Some(2))]);
    is("state x param k unknown drift f x' = k*x output x^2", &[("x", Some(2)), ("k", Some(1))]);
    is("state x param a, b unknown drift f x' = a*b*x output x", &[("x", Some(1)), ("a", None), ("b", None)]);
    is(
        "state x param a, b unknown drift f x' = (a + b)*x + a*b output x",
        &[("x", Some(1)), ("a", Some(2)), ("b", Some(2))],
    );
}
