//! The Pareto front: what no other combination beats.

use super::combination::Combination;

/// Marks the combinations that no other beats in time, digits at the worst state, right verdicts and certain ones.
pub(super) fn mark_front(combinations: &mut [Combination]) {
    let beats = |a: &Combination, b: &Combination| {
        let measures = |c: &Combination| (c.seconds, -c.digits.worst(), c.not_right(), -(c.certified as f64));
        let (x, y) = (measures(a), measures(b));
        x.0 <= y.0 && x.1 <= y.1 && x.2 <= y.2 && x.3 <= y.3 && x != y
    };
    let all = combinations.to_vec();
    for combination in combinations {
        combination.on_front = !all.iter().any(|other| beats(other, combination));
    }
}

#[cfg(test)]
mod tests {
    use super::super::combination::{Derivative, Digits, Number, RankMethod};
    use super::*;

    fn combination(seconds: f64, worst: f64, wrong: u64) -> Combination {
        Combination {
            number: Number::Double,
            derivative: Derivative::Graph,
            rank: RankMethod::SvdFaer,
            seconds,
            digits: Digits::Measured { median: worst, worst },
            wrong,
            undecided: 0,
            failed: 0,
            certified: 0,
            on_front: false,
        }
    }

    #[test]
    fn the_front_holds_what_nothing_beats() {
        let mut all = vec![
            combination(1.0, 5.0, 3), // the fastest
            combination(2.0, 5.0, 3), // as the fastest, and slower
            combination(3.0, 9.0, 3), // more digits
            combination(4.0, 7.0, 0), // fewer wrong verdicts
            combination(5.0, 8.0, 1), // beaten in nothing by one alone: more digits than the one before
            combination(6.0, 8.0, 1), // the same, later
        ];
        mark_front(&mut all);
        let front: Vec<bool> = all.iter().map(|c| c.on_front).collect();
        assert_eq!(front, [true, false, true, true, true, false]);
    }
}
