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

#[test]
#[ignore]
fn all_models() {
    let only = std::env::var("MODEL").unwrap_or_default();
    let work: u64 = std::env::var("WORK").ok().and_then(|w| w.parse().ok()).unwrap_or(300_000_000);
    let mut files: Vec<_> = std::fs::read_dir("tests/models").unwrap().map(|f| f.unwrap().path()).collect();
    files.sort();
    for file in files {
        if file.extension().is_none_or(|e| e != "proof")
            || !only.split(',').any(|o| file.to_str().unwrap().contains(o))
        {
            continue;
        }
        let begin = std::time::Instant::now();
        let mut system = System::read(&file).unwrap();
        let question = SolutionsQuestion {
            conditions: Assignment::new(),
            expressions: Vec::new(),
            work,
            interrupt: &AtomicBool::new(false),
        };
        let answer = solutions(&mut system, &question);
        let name = file.file_stem().unwrap().to_string_lossy().into_owned();
        match answer {
            Err(why) => println!("{name}: {why}"),
            Ok(answer) => {
                let of = |s: &SolutionsOf| match &s.solutions {
                    Solutions::Finite(n) => {
                        format!("{}={n}{}", s.name, if s.at_most.is_some() { "!" } else { "" })
                    }
                    Solutions::Infinite => format!("{}=oo", s.name),
                    Solutions::Undecided(why) => format!("{}=? ({why})", s.name),
                };
                let mut all: Vec<String> = answer.unknowns.iter().map(of).collect();
                if let Some(why) = answer.unknowns.iter().find_map(|s| match &s.solutions {
                    Solutions::Undecided(why) => Some(why.clone()),
                    _ => None,
                }) {
                    all = vec![format!("UNDECIDED {why}")];
                }
                println!(
                    "{name}: {:.1}s rounds {} work {:.1e} points {:?} orders {:?}: {}",
                    begin.elapsed().as_secs_f64(),
                    answer.rounds,
                    answer.work as f64,
                    answer.points,
                    answer.orders,
                    all.join(" ")
                );
            }
        }
    }
}
