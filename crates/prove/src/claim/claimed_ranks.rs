//! What is claimed of a rank: a number, or bounds.

use palmistry_math::expression::syntax::Relation;
use std::fmt;

/// The ranks that a claim allows: `rank = 3`, `rank >= 2`, `1 <= rank < 4`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ClaimedRanks {
    pub least: usize,
    /// `usize::MAX` where no upper bound is claimed.
    pub most: usize,
    /// Whether bounds are claimed and no equation, whether they allow one number or several.
    pub are_bounds: bool,
}

impl ClaimedRanks {
    pub fn exactly(rank: usize) -> ClaimedRanks {
        ClaimedRanks { least: rank, most: rank, are_bounds: false }
    }

    /// What `rank RELATION number` says; of several, what all of them do.
    ///
    /// # Errors
    /// In words, where no rank satisfies the relations.
    pub fn of(relations: &[(Relation, i64)]) -> Result<ClaimedRanks, String> {
        let (mut least, mut most) = (0, i64::MAX);
        for (relation, number) in relations {
            let (from, to) = match relation {
                Relation::Equal => (*number, *number),
                Relation::AtLeast => (*number, i64::MAX),
                Relation::Greater => (number.saturating_add(1), i64::MAX),
                Relation::AtMost => (0, *number),
                Relation::Less => (0, number.saturating_sub(1)),
                Relation::NotEqual => return Err("a rank has bounds, as in 2 <= rank <= 3".to_owned()),
            };
            (least, most) = (from.max(least), to.min(most));
        }
        if let [(Relation::Equal, number)] = relations
            && *number < 0
        {
            return Err(format!("a rank is never {number}"));
        }
        if least > most {
            return Err(if relations.len() == 1 { "no rank is so low" } else { "no rank is both" }.to_owned());
        }
        let number =
            |bound: i64| if bound == i64::MAX { usize::MAX } else { usize::try_from(bound).unwrap_or(0) };
        let are_bounds = relations.iter().any(|(relation, _)| *relation != Relation::Equal);
        Ok(ClaimedRanks { least: number(least), most: number(most), are_bounds })
    }

    pub fn holds(self, rank: usize) -> bool {
        (self.least..=self.most).contains(&rank)
    }

    /// Whether the claim holds for all of these ranks, or for none of them.
    pub fn stays(self, ranks: std::ops::RangeInclusive<usize>) -> bool {
        let (first, last) = (*ranks.start(), *ranks.end());
        let holds_of_all = self.least <= first && last <= self.most;
        holds_of_all || self.most < first || last < self.least
    }
}

impl fmt::Display for ClaimedRanks {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.least, self.most) {
            (least, most) if least == most => write!(out, "{least}"),
            (least, usize::MAX) => write!(out, "at least {least}"),
            (0, most) => write!(out, "at most {most}"),
            (least, most) => write!(out, "{least} to {most}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use Relation::{AtLeast, AtMost, Equal, Greater, Less, NotEqual};

    #[test]
    fn bounds_are_met_together() {
        let of = |relations: &[(Relation, i64)]| ClaimedRanks::of(relations).map(|ranks| ranks.to_string());
        assert_eq!(of(&[(Equal, 3)]).unwrap(), "3");
        assert_eq!(of(&[(AtLeast, 2)]).unwrap(), "at least 2");
        assert_eq!(of(&[(Greater, 2)]).unwrap(), "at least 3");
        assert_eq!(of(&[(Less, 2)]).unwrap(), "at most 1");
        assert_eq!(of(&[(AtLeast, -1), (AtMost, 4)]).unwrap(), "at most 4");
        assert_eq!(of(&[(AtLeast, 2), (Less, 5)]).unwrap(), "2 to 4");
        for none in [&[(AtLeast, 3), (AtMost, 2)][..], &[(Less, 0)], &[(Equal, -1)], &[(NotEqual, 1)]] {
            assert!(of(none).is_err(), "{none:?}");
        }
    }

    #[test]
    fn an_answer_that_further_rows_may_change_is_none() {
        let (equal, least, most) = (
            ClaimedRanks::exactly(3),
            ClaimedRanks { least: 3, most: usize::MAX, are_bounds: true },
            ClaimedRanks { least: 0, most: 3, are_bounds: true },
        );
        for (found, stays) in [(2, [false, false, false]), (3, [false, true, false]), (4, [true, true, true])]
        {
            assert_eq!([equal, least, most].map(|claimed| claimed.stays(found..=5)), stays, "{found}");
        }
        assert!(equal.stays(3..=3));
    }
}
