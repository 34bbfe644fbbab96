//! At which order Lie derivatives stop, and that nothing of one claim reaches into the next. Ranks by hand.

use palmistry::drops::where_it_drops;
use palmistry::report::{drops_json, global_json, rank_json};
use palmistry::sweep::SolutionsWanted;
use palmistry::sweep::answer_rank_at_once;
use palmistry::{Outcome, RankQuestion, System, answer_rank, answer_solutions, decide, prove};
use serde_json::Value;

fn system(text: &str) -> System {
    text.parse().unwrap_or_else(|why| panic!("{why:?}: {text}"))
}

fn words(outcomes: &[Outcome]) -> Vec<(&str, &str)> {
    outcomes.iter().map(|outcome| (outcome.id.as_str(), outcome.word())).collect()
}

/// `y = z1, y' = z2, y'' = x`: the unknown is met in the second derivative and not in the first, so that by its column alone the rank rests
/// before it begins to grow. With a signal `y'' = u x`, and `u` may be zero: `y''' = u' x` there.
#[test]
fn what_is_known_at_the_beginning_moves() {
    for (rate, and, sets) in [
        ("x", "", "x = 0"),
        ("x*u", "known u(t)", "u = 0"),
        ("x + z1*x^2*0 + z1", "", "z1 = 0"),
        ("x + z1^2", "", "z1 = z2"),
    ] {
        let text = format!(
            "system \"late\" state z1, z2, x {and} drift f z1' = z2 z2' = {rate} x' = 0 output z1 initial z1, z2 known
             claim generic: rank = 1
             claim everywhere: rank = 1 everywhere
             claim off: rank = 1 except where {sets}
             claim on: rank = 1 where {sets}
             claim seen: observable(x)
             claim never expect refuted: rank = 0"
        );
        let mut system = system(&text);
        for outcome in prove(&system) {
            assert!(outcome.ok, "{}: {outcome:?}", outcome.id);
        }
        let answer = where_it_drops(&mut system, 1, &Default::default()).unwrap();
        assert!(answer.is_exact() && answer.sets.is_empty(), "{answer:?}");
    }
}

/// The second factor shows `x` off `w = 0` alone, and no field leaves that set: there the rank is zero, and that is no matter of the order.
#[test]
fn where_nothing_moves_a_rank_stays_low() {
    let mut system = system(
        "system \"late\" state z1, z2, x, w drift f z1' = z2 z2' = x*w x' = 0 w' = 0 output z1, w initial z1, z2 known
         claim off: rank = 2 except where w = 0
         claim on: rank = 1 where w = 0
         claim never expect refuted: rank = 2 everywhere",
    );
    for outcome in prove(&system) {
        assert!(outcome.ok, "{}: {outcome:?}", outcome.id);
    }
    let answer = where_it_drops(&mut system, 1, &Default::default()).unwrap();
    assert!(answer.is_exact(), "{answer:?}");
    let sets: Vec<_> = answer.sets.iter().map(|set| (set.rank, set.equations.clone())).collect();
    assert_eq!(sets, [(1, vec!["w = 0".to_owned()])]);
}

/// Systems in steps, with signals whose later values have names of their own: each claim has the verdict that it has alone, in any order.
#[test]
fn claims_in_steps_do_not_depend_on_those_before() {
    for body in [
        "state x param a, b unknown known u(t) drift f x+ = a*x + b*u output x",
        "state x, y param a unknown known u(t) drift f x+ = y + a*u^2 y+ = x*u output x, y",
        "state x, z param a unknown known u(t), v(t) drift f x+ = a*x*v + z z+ = u*z output x initial z known",
        "state x param a unknown known u(t) drift f x+ = sqrt(a^2)*x + u output x",
    ] {
        let claims = [
            "rank = 3 where u = 0",
            "rank = 3",
            "rank = 2",
            "rank = 2 where x = 0",
            "L(f, f, x) = L(f, L(f, x))",
            "rank = 3 where x = u",
            "observable(a) where u = 1",
            "L(f, f, f, x) = L(f, f, x)",
            "rank = 2 where a = 1",
        ];
        for turn in 0..claims.len() {
            let listed = (0..claims.len()).map(|k| (k + turn) % claims.len());
            let text: String = listed.map(|k| format!("\nclaim c{k}: {}", claims[k])).collect();
            let system = system(&format!("system \"steps\" {body}{text}"));
            let together = prove(&system);
            let alone: Vec<Outcome> = system.claims.iter().map(|claim| decide(&system, claim, 1)).collect();
            assert_eq!(words(&together), words(&alone), "{body}{text}");
            for (one, other) in together.iter().zip(&alone) {
                assert_eq!(one.verdict, other.verdict, "{body}{text}");
            }
        }
    }
}

/// Where a root of a square is taken with a sign, a map stays a map: of states that rest the output is the same at every step. Were it differentiated
/// along `x' = x, a' = a`, then `2 x^2 + |a|` would be another one.
#[test]
fn a_map_with_roots_of_squares_stays_a_map() {
    let system = system(
        "system \"rests\" state x, a drift f x+ = x a+ = a output x^2 + sqrt(a^2)
         claim one: rank = 1
         claim two expect refuted: rank = 2",
    );
    for outcome in prove(&system) {
        assert!(outcome.ok, "{}: {outcome:?}", outcome.id);
    }
}

/// Of one answer no field says what another one denies.
#[test]
fn fields_of_an_answer_agree() {
    for body in [
        "state x param k, c unknown drift f x' = -k*x output c*x",
        "state x param k, c unknown drift f x' = -k^2*x output c*x",
        "state x, y param k unknown drift f x' = -k*x*y y' = y output x",
        "state x param a, b unknown drift f x' = a*b*x output x^2",
        "state x, z param k unknown drift f x' = k*z z' = 0 output x initial z known",
        "state x param k unknown drift f x' = exp(-k*x) output x^3",
        "state x, y, z param a, b unknown drift f x' = a*y y' = b*z z' = 0 output x + y^2",
    ] {
        let text = format!("system \"s\" {body}");
        let values = global_json(
            &answer_solutions(
                &mut system(&text),
                SolutionsWanted::Functions,
                10_000_000,
                &Default::default(),
            )
            .unwrap(),
        );
        for unknown in values["unknowns"].as_array().unwrap() {
            let [values, most, least, bound] =
                ["values", "at_most", "at_least", "error_bound"].map(|key| unknown[key].clone());
            let number = |value: &Value| value.as_u64();
            let is_proved = unknown["verdict"] == "proved";
            assert_eq!(most.is_null(), bound.is_null(), "{body}: {unknown}");
            assert!(number(&least).zip(number(&most)).is_none_or(|(least, most)| least <= most), "{unknown}");
            match number(&values) {
                Some(count) => {
                    assert!(number(&most).is_none_or(|most| count <= most), "{body}: {unknown}");
                    assert!(number(&least).is_none_or(|least| least <= count), "{body}: {unknown}");
                    assert!(!is_proved || number(&most) == Some(count), "{body}: {unknown}");
                }
                // of infinitely many there is no bound, and no number is proved that is not told
                None => {
                    assert!(most.is_null(), "{body}: {unknown}");
                    assert_eq!(values == "infinity", is_proved, "{body}: {unknown}");
                }
            }
        }
        for samples in [0, 20] {
            let question = RankQuestion { samples, ..RankQuestion::default() };
            let mut of_rank = system(&text);
            for answer in [answer_rank(&mut of_rank, &question), answer_rank_at_once(&mut of_rank, &question)]
            {
                let found = rank_json(&answer.unwrap());
                let of = |value: &Value| value.as_u64().unwrap();
                let (generic, dimension) = (&found["generic"], of(&found["dimension"]));
                let (least, most) = (of(&generic["at_least"]), of(&generic["at_most"]));
                assert!(least <= most && most <= dimension, "{body}: {found}");
                assert_eq!(generic["rank"].is_null(), least < most, "{body}: {found}");
                let rank = of(&found["generic_rank"]);
                assert!((least..=most).contains(&rank), "{body}: {found}");
                for (rank, _) in found["rank_histogram"].as_object().unwrap() {
                    assert!(rank.parse::<u64>().unwrap() <= most, "{body}: {found}");
                }
                let left = found["unobservable_dimension"].as_u64();
                assert_eq!(left, generic["rank"].as_u64().map(|rank| dimension - rank), "{body}: {found}");
                let seen = found["unknowns"].as_array().unwrap();
                let all = seen.iter().all(|one| one["verdict"].as_str().unwrap().starts_with("locally"));
                assert_eq!(all, least == dimension, "{body}: {found}");
            }
        }
        if let Ok(answer) = where_it_drops(&mut system(&text), 1, &Default::default()) {
            let found = drops_json(&answer);
            let is_empty = |key: &str| found[key].as_array().is_none_or(Vec::is_empty);
            let exact = found["final"] == true && is_empty("open") && found["out_of_reach"].is_null();
            assert_eq!(found["exact"] == true, exact, "{body}: {found}");
            for set in found["sets"].as_array().unwrap() {
                assert!(set["rank"].as_u64() < found["rank"].as_u64(), "{body}: {found}");
            }
        }
    }
}
