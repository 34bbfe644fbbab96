//! The numbered equations of the thesis, and which entries speak of each. Nothing is left out silently.

use crate::claim::Outcome;
use crate::system::Flaw;
use std::collections::BTreeMap;

/// The chapters that have numbered equations, with the number of the last one.
pub const NUMBERED: [(&str, u32); 5] = [("3", 49), ("4", 91), ("5", 42), ("6", 12), ("A", 27)];

/// The entries of one equation.
#[derive(Clone, Debug)]
pub struct Equation<'o> {
    /// As in `4.48`.
    pub number: String,
    /// The outcomes whose ids begin with the number, and the parts of it.
    pub entries: Vec<&'o Outcome>,
}

impl Equation<'_> {
    /// One word for all entries; `no entry` where there are none. What is the matter with a form in the text comes first,
    /// then what is undecided; else it is the word of the entry that has the equation's own number, and where there are only
    /// parts, the one that claims least. That a variant is refuted, where the file expects it, says nothing against the
    /// equation.
    pub fn word(&self) -> &'static str {
        if let Some(bad) = self.entries.iter().find(|outcome| !outcome.ok) {
            return bad.word();
        }
        let has = |word: &&str| self.entries.iter().any(|outcome| outcome.word() == *word);
        let matters = Flaw::ALL.map(Flaw::word).into_iter().chain(["undecided"]).find(has);
        let own = || self.entries.iter().find(|outcome| outcome.id == self.number);
        let parts = ["example", "consequence", "restated", "proved", "definition"];
        matters
            .or_else(|| own().map(|outcome| outcome.word()))
            .or_else(|| parts.into_iter().find(has))
            .unwrap_or("no entry")
    }
}

/// All equations in the order of the thesis.
pub fn equations(outcomes: &[Outcome]) -> Vec<Equation<'_>> {
    let mut by_number: BTreeMap<String, Vec<&Outcome>> = BTreeMap::new();
    for outcome in outcomes {
        if let Some(number) = number_of(&outcome.id) {
            by_number.entry(number).or_default().push(outcome);
        }
    }
    NUMBERED
        .iter()
        .flat_map(|(chapter, last)| (1..=*last).map(move |n| format!("{chapter}.{n}")))
        .map(|number| {
            let entries = by_number.remove(&number).unwrap_or_default();
            Equation { number, entries }
        })
        .collect()
}

/// Outcomes in the order of the thesis: by chapter, number and part; what speaks of no numbered equation comes with its
/// chapter, and the rest at the end.
pub fn in_order_of_the_thesis<'o>(outcomes: impl IntoIterator<Item = &'o Outcome>) -> Vec<&'o Outcome> {
    let mut sorted: Vec<&Outcome> = outcomes.into_iter().collect();
    sorted.sort_by_key(|outcome| {
        let mut parts = outcome.id.split('.');
        let chapter = parts.next().and_then(|c| NUMBERED.iter().position(|(known, _)| *known == c));
        let number = number_of(&outcome.id).and_then(|n| n.split('.').nth(1)?.parse().ok());
        (chapter.unwrap_or(NUMBERED.len()), number.unwrap_or(u32::MAX), outcome.id.clone())
    });
    sorted
}

/// The equation that an id speaks of: `4.31` for `4.31.s2`, nothing for `A.section2.generic` or `rank.level`.
fn number_of(id: &str) -> Option<String> {
    let mut parts = id.split('.');
    let chapter = parts.next().filter(|c| NUMBERED.iter().any(|(known, _)| known == c))?;
    let number: u32 = parts.next()?.parse().ok()?;
    Some(format!("{chapter}.{number}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_belong_to_their_equation_and_sections_to_none() {
        assert_eq!(number_of("4.31.s2").as_deref(), Some("4.31"));
        assert_eq!(number_of("A.16").as_deref(), Some("A.16"));
        assert_eq!(number_of("A.section2.generic"), None);
        assert_eq!(number_of("3.text.curvature"), None);
        assert_eq!(number_of("rank.level"), None);
    }

    #[test]
    fn there_are_two_hundred_and_twenty_one() {
        assert_eq!(equations(&[]).len(), 221);
        assert!(equations(&[]).iter().all(|equation| equation.word() == "no entry"));
    }
}
