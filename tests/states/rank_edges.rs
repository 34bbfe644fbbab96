//! Ranks at the edges: states that do not exist, numbers that doubles do not hold, states that they cannot tell apart.

use palmistry::observability::Observability;
use palmistry::report::rank_text;
use palmistry::sweep::StandardDeviation;
use palmistry::{RankAnswer, RankQuestion, System, answer_rank};

fn ranks(text: &str) -> RankAnswer {
    let mut system: System = text.parse().unwrap();
    answer_rank(&mut system, &RankQuestion { samples: 40, ..RankQuestion::default() }).unwrap()
}

fn deviations(answer: &RankAnswer) -> &[StandardDeviation] {
    &answer.branches[0].deviations.as_ref().unwrap().list
}

/// No row of the codistribution mentions the root, so that rows have values where the system does not exist.
#[test]
fn nothing_is_told_of_states_that_do_not_exist() {
    let system = |rate: &str| {
        format!(
            "system \"s\" state x, v drift f x' = v v' = {rate} output x sample x in [-1, 1] v in [-1, 1]"
        )
    };
    let mut nowhere: System = system("sqrt(-1 - x^2)").parse().unwrap();
    let question = RankQuestion { samples: 40, ..RankQuestion::default() };
    let why = answer_rank(&mut nowhere, &question).map(|answer| answer.branches.len()).unwrap_err();
    assert!(why.to_string().contains("that needs -1 - x^2 > 0"), "{why}");
    let half = ranks(&system("log(x)"));
    let full = &half.branches[0].full;
    assert!((1..40).contains(&full.samples), "{}", full.samples);
    assert_eq!(half.branches[0].deviations.as_ref().unwrap().states as u64, full.samples);
}

/// The rank is certified to be full: that doubles cannot tell how well a state is seen is not that it is not seen.
#[test]
fn a_state_that_is_certified_to_be_seen_is_not_said_not_to_be() {
    let system = |outputs: &str, sample: &str| {
        format!("system \"s\" state x, y drift f x' = 0 y' = 0 output {outputs} sample {sample}")
    };
    for text in [
        system("x + y, x + (1 + 10^(-14))*y", "x in [-1, 1] y in [2, 3]"),
        system("x, 10^(-330)*y", "x in [-1, 1] y in [2, 3]"),
        // beyond the range of doubles
        system("x, 10^250*y", "x in [-10^100, 10^100] y in [-10^100, 10^100]"),
        system("x, y", "x in [-10^400, 10^400] y in [2, 3]"),
    ] {
        let answer = ranks(&text);
        assert_eq!(answer.branches[0].full.rank_histogram, [(2, 40)].into(), "{text}");
        let y = &deviations(&answer)[1];
        let x = &deviations(&answer)[0];
        assert!(x.is_observable && y.is_observable && x.infinite + y.infinite > 0, "{text}: {x:?} {y:?}");
        let told = rank_text(&answer, true);
        assert!(told.contains("  unknown") && !told.contains("unobservable"), "{told}");
    }
    // two states that are not told apart are not seen
    let answer = ranks(&system("x + y", "x in [-1, 1] y in [2, 3]"));
    assert!(deviations(&answer).iter().all(|state| !state.is_observable && state.infinite == 40));
    let told = rank_text(&answer, true);
    assert!(!told.contains("  unknown") && told.contains("  unobservable"), "{told}");
}

/// What is drawn in blocks is drawn in doubles: a box wider than these is drawn state by state.
#[test]
fn a_box_wider_than_doubles_has_ranks() {
    let answer = ranks(
        "system \"s\" state x, y drift f x' = 0 y' = 0 output x + x^3, y^3 + x \
         sample x in [-10^400, 10^400] y in [2, 3]",
    );
    let full = &answer.branches[0].full;
    assert_eq!((full.certified, &full.rank_histogram), (40, &[(2, 40)].into()), "{:?}", full.poles);
}

/// Where functions are met the random points bound a rank from above only. The sampled states bound it from below; an unknown without
/// which the bound is smaller is seen then, and one that is not seen at one of the states is not.
#[test]
fn unknowns_are_decided_where_the_states_decide_the_rank() {
    let seen = |text: &str| -> Vec<Observability> {
        ranks(text).branches[0].generic.unknowns.iter().map(|(_, seen)| *seen).collect()
    };
    let power = "system \"s\" state x, y param n unknown drift f x' = -x^n y' = y^n output x initial x = 1 sample y in [1, 2]";
    assert_eq!(seen(power), [Observability::No, Observability::Yes]);
    // without states it is left undecided, and that is said
    let unasked = |text: &str| {
        let mut system: System = text.parse().unwrap();
        answer_rank(&mut system, &RankQuestion { samples: 0, ..RankQuestion::default() }).unwrap().cut_off()
    };
    assert!(unasked(power) && !unasked(&power.replace("x^n", "n*x").replace("y^n", "y")));
    // asin(sin(x)) is x on a part of the states: their ranks are two
    let parts = |range: &str| {
        format!(
            "system \"s\" state x, y, z drift f x' = 0 y' = 0 z' = 0 output x, (asin(sin(x)) - 2*x)*(y + z) sample x in {range} y in [1, 2]"
        )
    };
    assert_eq!(seen(&parts("[2, 3]")), [Observability::Yes, Observability::No, Observability::No]);
    let split = parts("[-3, 3]").replace("2*x", "x");
    assert_eq!(seen(&split), [Observability::Undecided; 3]);
}
