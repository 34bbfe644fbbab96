//! The Pareto front: what no other combination beats.

use super::combination::Combination;

/// Times that differ by less than this part are one: another run has them the other way round.
pub const TIME_TOLERANCE: f64 = 0.05;
/// Digits at the worst state that differ by less than this are one: other states have them the other way round.
pub const DIGITS_TOLERANCE: f64 = 0.25;

/// Whether one combination beats another: it is better in time, digits at the worst state, right verdicts or certain ones by
/// more than the tolerance, and worse in none of them by more than that. Counts of verdicts have no tolerance.
pub fn beats(a: &Combination, b: &Combination) -> bool {
    let faster = |a: &Combination, b: &Combination| a.seconds < b.seconds * (1.0 - TIME_TOLERANCE);
    let sharper = |a: &Combination, b: &Combination| a.digits.worst() > b.digits.worst() + DIGITS_TOLERANCE;
    let surer = |a: &Combination, b: &Combination| a.not_right() < b.not_right() || a.certified > b.certified;
    let better = |a, b| faster(a, b) || sharper(a, b) || surer(a, b);
    better(a, b) && !better(b, a)
}

/// Marks the combinations that no other beats. Where each is beaten by another one, which tolerances allow, there is no front,
/// and all are on it.
pub(super) fn mark_front(combinations: &mut [Combination]) {
    let all = combinations.to_vec();
    for combination in combinations.iter_mut() {
        combination.on_front = !all.iter().any(|other| beats(other, combination));
    }
    if !combinations.iter().any(|combination| combination.on_front) {
        combinations.iter_mut().for_each(|combination| combination.on_front = true);
    }
}

#[cfg(test)]
mod tests {
    use super::super::combination::{CorrectDigits, Derivative, Number, RankMethod};
    use super::*;

    fn combination(seconds: f64, worst: f64, wrong: u64) -> Combination {
        Combination {
            number: Number::Double,
            derivative: Derivative::Graph,
            rank: RankMethod::SvdFaer,
            seconds,
            digits: CorrectDigits::Measured { median: worst, worst },
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

    /// Other seeds move the digits by a tenth, other runs the times by a hundredth: the front stays what it was.
    #[test]
    fn gaps_below_the_tolerance_do_not_decide() {
        let front = |shift: f64, part: f64| {
            // each second one is moved the other way
            let moved = |place: usize, seconds: f64, worst: f64, wrong: u64| {
                let sign = if place.is_multiple_of(2) { 1.0 } else { -1.0 };
                combination(seconds * (1.0 + sign * part), worst + sign * shift, wrong)
            };
            let mut all = vec![
                moved(0, 1.0, 5.0, 3),
                moved(1, 1.0, 5.0, 3),  // a tie
                moved(2, 2.0, 5.0, 3),  // slower
                moved(3, 2.5, 8.0, 3),  // sharper
                moved(4, 2.5, 8.02, 3), // a tie but for a fiftieth of a digit
                moved(5, 4.0, 7.0, 0),
                moved(6, 6.0, 7.0, 1),
            ];
            mark_front(&mut all);
            all.iter().map(|c| c.on_front).collect::<Vec<bool>>()
        };
        let expected = [true, true, false, true, true, true, false];
        for (shift, part) in [(0.0, 0.0), (0.1, 0.01), (-0.1, -0.01), (0.1, -0.02), (-0.1, 0.02)] {
            assert_eq!(front(shift, part), expected, "{shift} {part}");
        }
        // beyond the tolerance they do
        assert_eq!(front(0.2, 0.0), [true, false, false, false, true, true, true]);
    }
}
