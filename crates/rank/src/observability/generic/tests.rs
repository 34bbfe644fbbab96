//! The generic answer against Lie derivatives, and against systems whose answers are known by hand.

use super::*;
use crate::observability::{Codistribution, Length};
use palmistry_io::foreign::name_of;
use palmistry_math::number::PrimeField;

fn answer(text: &str) -> (System, GenericAnswer) {
    let system: System = format!("system \"s\" {text}").parse().unwrap();
    let answer = generic_answer(&system, &Assignment::new(), Ceiling::Rests);
    (system, answer)
}

/// The rank by bounds, and the names of what is unobservable.
fn found(text: &str) -> (usize, usize, Vec<String>) {
    let (system, answer) = answer(text);
    let unobservable = answer.unknowns.iter().filter(|(_, seen)| *seen == Observability::No);
    let unobservable = unobservable.map(|(symbol, _)| system.symbol_name(*symbol).to_owned()).collect();
    if answer.at_most < answer.dimension {
        assert!(answer.log2_error < -100.0, "{answer:?}");
    }
    (answer.at_least, answer.at_most, unobservable)
}

#[test]
fn words_and_series_span_the_same() {
    let mut seen = 0;
    for folder in std::fs::read_dir("../../proofs").unwrap() {
        for file in std::fs::read_dir(folder.unwrap().path()).unwrap() {
            let path = file.unwrap().path();
            if path.extension().is_none_or(|e| e != "proof") {
                continue;
            }
            let mut system = System::read(&path).unwrap();
            if system.states.is_empty() || system.outputs.is_empty() || system.moving_fields().is_empty() {
                continue;
            }
            let Ok(lie_derivatives) =
                Codistribution::new(&mut system, &Assignment::new(), Length::UntilItStops)
            else {
                continue;
            };
            let series = generic_answer(&system, &Assignment::new(), Ceiling::Rests);
            if lie_derivatives.is_final() {
                assert_eq!(
                    series.rank(),
                    Some(lie_derivatives.generic_rank()),
                    "{}: {series:?}",
                    name_of(&path)
                );
                seen += 1;
            }
        }
    }
    assert!(seen >= 5, "{seen}");
}

#[test]
fn what_is_known_by_hand() {
    // only the sum is observable
    assert_eq!(found("state x, y drift f x' = 0 y' = 0 output x + y"), (1, 1, vec!["x".into(), "y".into()]));
    // a harmonic oscillator with unknown frequency
    assert_eq!(found("state x, v, k drift f x' = v v' = -k*x k' = 0 output x"), (3, 3, vec![]));
    // logistic growth measured up to a factor: only r is identifiable
    let scaled = "state x, r, K, s drift f x' = r*x*(1 - x/K) r' = 0 K' = 0 s' = 0 output s*x";
    assert_eq!(found(scaled), (3, 3, vec!["x".into(), "K".into(), "s".into()]));
    // the input makes observable what the drift does not: p enters with the input alone
    let driven = "state x, p drift f x' = 0 p' = 0 input g x' = p p' = 0 output x";
    assert_eq!(found(driven), (2, 2, vec![]));
    // an output that is constant
    assert_eq!(found("state x drift f x' = -x output 1"), (0, 0, vec!["x".into()]));
    // x' = 1, y = x^5 z: full almost everywhere, though not at x = 0
    assert_eq!(found("state x, z drift f x' = 1 z' = 0 output x^5*z"), (2, 2, vec![]));
}

/// The unicycle measured by its range to a beacon: rotations about the beacon are unobservable.
#[test]
fn a_unicycle_seen_by_ranges_turns_unseen() {
    let text = "state x, y, theta angle theta input v x' = cos(theta) y' = sin(theta) others' = 0 input w theta' = 1 others' = 0 output x^2 + y^2";
    assert_eq!(found(text), (2, 2, vec!["x".into(), "y".into(), "theta".into()]));
}

#[test]
fn functions_are_adjoined() {
    // independent by the theorem of Kolchin and Ostrowski
    let text = "state x, k drift f x' = -exp(k*x) k' = 0 output x";
    assert_eq!(found(text), (2, 2, vec![]));
    // a short one
    let text = "state x, a, b drift f x' = -a*b*log(x) a' = 0 b' = 0 output x";
    assert_eq!(found(text), (2, 2, vec!["a".into(), "b".into()]));
    // a hidden identity is none once equal exponentials have one name
    let text = "state x, k drift f x' = 0 k' = 0 output exp(x)*exp(k) - exp(x + k)";
    assert_eq!(found(text), (0, 0, vec!["x".into(), "k".into()]));
    // signs of roots: one or nothing
    let text = "state x drift f x' = 0 output x + sqrt(x^2)";
    assert_eq!(found(text), (0, 1, vec![]));
    let text = "state x, y drift f x' = 0 y' = 0 output sqrt(x + y)";
    assert_eq!(found(text), (1, 1, vec!["x".into(), "y".into()]));
}

/// All cases of residues: squares have roots, others have none.
#[test]
fn square_roots_are_roots() {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    for _ in 0..20 {
        let field = PrimeField::random(&mut rng);
        let mut roots = 0;
        for _ in 0..50 {
            let a = field.draw(&mut rng);
            if let Some(root) = field.square_root(a) {
                assert_eq!(field.product(root, root), a);
                roots += 1;
            }
        }
        assert!((10..40).contains(&roots), "{roots}");
    }
}

/// A sum of many products is what its terms give one by one.
#[test]
fn long_sums_are_reduced_in_time() {
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    let field = PrimeField::random(&mut rng);
    let largest = field.modulus() - 1;
    for length in [0, 1, 2, 17, 300] {
        let mut draw = |extreme: bool| if extreme { largest } else { field.draw(&mut rng) };
        for extreme in [true, false] {
            let a: Vec<u64> = (0..length).map(|_| draw(extreme)).collect();
            let b: Vec<u64> = (0..length).map(|_| draw(extreme)).collect();
            let terms = a.iter().zip(b.iter().rev());
            let sum = terms.fold(0, |sum, (a, b)| field.sum(sum, field.product(*a, *b)));
            assert_eq!(field.dot_reversed(&a, &b), sum);
        }
    }
}

/// By hand, as in `tests/claims/inputs.rs`: signals that are known have no column, and a known initial condition alone has
/// none and yet leads to what is not.
#[test]
fn known_coordinates_have_no_column() {
    let signal = "state x param a, b unknown known u(t) drift f x' = a*u + b*u^2 output x";
    assert_eq!(found(signal), (3, 3, vec![]));
    assert_eq!(found("param k unknown known u(t) output k*u'"), (1, 1, vec![]));
    let late = "state x1, x2 param k unknown drift f x1' = x2 x2' = k output x1 initial x1, x2 known";
    assert_eq!(found(late), (1, 1, vec![]));
    let scaled = "state x param k, c unknown drift f x' = -k*x output c*x";
    assert_eq!(found(scaled), (2, 2, vec!["x".into(), "c".into()]));
    assert_eq!(found(&format!("{scaled} initial x known")), (2, 2, vec![]));
    let twice = "state x, z param a, b unknown experiments 2 drift f x' = a + b*z z' = 0 output x, z";
    assert_eq!(found(twice), (6, 6, vec![]));
}

/// In discrete time: the same ranks as by Lie derivatives, also where the images are a thin set, and whether each unknown is observable.
#[test]
fn sequences_are_followed_in_discrete_time() {
    for (text, rank, seen) in [
        ("state x param r unknown drift f x+ = r*x*(1 - x) output x", 2, "yy"),
        ("state x, y drift f x+ = x/2 output x", 1, "yn"),
        ("state x, y, z, w drift f x+ = 0 y+ = 1 z+ = x w+ = z/y output x*y, x*z, w", 4, "yyyy"),
        ("state x, z known u(t) drift f x+ = x + u*z output x", 2, "yy"),
        ("state x param a unknown, b unknown drift f x+ = a*b*x output x", 2, "ynn"),
        ("state x, a, b angle a, b drift f x+ = x*cos(a) a+ = a + b output x", 3, "yyy"),
        ("state x[1..60] drift f x[i]+ = x[i + 1] for i in 1..59 output x[1]", 60, ""),
        ("state x, y drift f x+ = exp(y) output x", 0, "??"),
        ("state x, y initial x known drift f x+ = x + y output y", 1, "y"),
    ] {
        let system: System =
            format!("system \"s\" {text}").parse().unwrap_or_else(|why| panic!("{why:?}: {text}"));
        let found = generic_answer(&system, &Assignment::new(), Ceiling::Rests);
        assert_eq!(found.at_least, rank, "{text}: {found:?}");
        assert_eq!(found.is_final(), !seen.starts_with('?'), "{text}: {found:?}");
        let lie_derivative = |seen: &Observability| match seen {
            Observability::Yes => 'y',
            Observability::No => 'n',
            Observability::Undecided => '?',
        };
        if !seen.is_empty() {
            assert_eq!(
                found.unknowns.iter().map(|(_, seen)| lie_derivative(seen)).collect::<String>(),
                seen,
                "{text}"
            );
        }
        if rank < found.dimension && found.is_final() {
            assert!(found.log2_error < -100.0, "{text}: {found:?}");
        }
    }
}

/// On the set `x = pi` the second factor of the output is zero, and so is every derivative of it: `x` is observable, and `z` not. On a
/// set given in terms of another function the answer is what holds around it.
#[test]
fn states_that_are_told_by_pi_or_by_functions() {
    for (value, expected) in [("pi", Some(1)), ("3", Some(1)), ("sqrt(2)", None), ("exp(1)", None)] {
        let text = format!("system \"s\" state x, z drift f x' = 0 z' = 0 output (x - {value})*z");
        let mut system: System = text.parse().unwrap();
        let conditions = crate::observability::parse_condition(&format!("x = {value}")).unwrap();
        let branch = crate::observability::solve_conditions(&mut system, &conditions).unwrap().remove(0);
        let answer = generic_answer(&system, &branch.values, Ceiling::Rests);
        assert_eq!(answer.rank(), expected, "{value}: {answer:?}");
        let seen: Vec<Observability> = answer.unknowns.iter().map(|(_, seen)| *seen).collect();
        match expected {
            Some(_) => assert_eq!(seen, [Observability::Yes, Observability::No], "{value}"),
            None => assert_eq!(seen, [Observability::Undecided; 2], "{value}"),
        }
    }
}
