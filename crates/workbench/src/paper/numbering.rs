//! The numbered equations of a paper, and which entries speak of each. Nothing is left out silently.

use palmistry_lang::Flaw;
use palmistry_prove::claim::Outcome;
use std::collections::BTreeMap;

/// How a paper numbers its equations: the parts that have numbers (chapters, sections, an appendix), each with the number of
/// its last equation. `4.31` is equation 31 of part 4; a part without a name has equations `1`, `2` and so on.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Numbering(pub Vec<(String, u32)>);

/// The entries of one equation.
#[derive(Clone, Debug)]
pub struct NumberedEquation<'o> {
    /// As in `4.48`.
    pub number: String,
    /// The outcomes whose ids begin with the number, and the parts of it.
    pub entries: Vec<&'o Outcome>,
}

impl NumberedEquation<'_> {
    /// One word for all entries; `no entry` where there are none. A flaw of a form in the text comes first,
    /// then what is undecided; else it is the word of the entry that has the equation's own number, and where there are only
    /// parts, the one that claims least. A variant that is refuted, where the file expects it, does not count against the
    /// equation.
    pub fn word(&self) -> &'static str {
        if let Some(bad) = self.entries.iter().find(|outcome| !outcome.ok) {
            return bad.word();
        }
        let has = |word: &&str| self.entries.iter().any(|outcome| outcome.word() == *word);
        let matters = Flaw::ALL.map(Flaw::word).into_iter().chain(["undecided"]).find(has);
        let own = || self.entries.iter().find(|outcome| outcome.id == self.number);
        let parts = ["example", "consequence", "holds by definition", "proved", "definition"];
        matters
            .or_else(|| own().map(|outcome| outcome.word()))
            .or_else(|| parts.into_iter().find(has))
            .unwrap_or("no entry")
    }
}

impl Numbering {
    /// How many equations there are.
    pub fn count(&self) -> usize {
        self.0.iter().map(|(_, last)| *last as usize).sum()
    }

    /// All equations in the order of the paper.
    pub fn equations<'o>(
        &self,
        outcomes: impl IntoIterator<Item = &'o Outcome>,
    ) -> Vec<NumberedEquation<'o>> {
        let mut by_number: BTreeMap<String, Vec<&Outcome>> = BTreeMap::new();
        for outcome in outcomes {
            if let Some(number) = self.number_of(&outcome.id) {
                by_number.entry(number).or_default().push(outcome);
            }
        }
        let numbers = self.0.iter().flat_map(|(part, last)| (1..=*last).map(move |n| name(part, n)));
        let equation = |number: String| NumberedEquation {
            entries: by_number.remove(&number).unwrap_or_default(),
            number,
        };
        numbers.map(equation).collect()
    }

    /// Outcomes in the order of the paper: by part and number; what speaks of no numbered equation comes with its part, and the
    /// rest at the end, in the order of the files.
    pub fn in_order<'o>(&self, outcomes: impl IntoIterator<Item = &'o Outcome>) -> Vec<&'o Outcome> {
        let mut sorted: Vec<&Outcome> = outcomes.into_iter().collect();
        let place = |outcome: &Outcome| {
            let first = outcome.id.split('.').next();
            let part = self.0.iter().position(|(known, _)| known.is_empty() || Some(known.as_str()) == first);
            let number = self.number_of(&outcome.id).and_then(|n| n.rsplit('.').next()?.parse().ok());
            (part.unwrap_or(self.0.len()), number.unwrap_or(u32::MAX))
        };
        // by name only within a part: what belongs to none keeps its place
        sorted.sort_by_cached_key(|outcome| {
            let (part, number) = place(outcome);
            (part, number, if part < self.0.len() { outcome.id.clone() } else { String::new() })
        });
        sorted
    }

    /// The equation that an id speaks of: `4.31` for `4.31.s2`, nothing for `A.section2.generic` or `rank.level`.
    fn number_of(&self, id: &str) -> Option<String> {
        let (part, last, rest) = self.0.iter().find_map(|(part, last)| match part.as_str() {
            "" => Some((part, last, id)),
            _ => Some((part, last, id.strip_prefix(part.as_str())?.strip_prefix('.')?)),
        })?;
        let number: u32 = rest.split('.').next()?.parse().ok()?;
        (1..=*last).contains(&number).then(|| name(part, number))
    }
}

fn name(part: &str, number: u32) -> String {
    if part.is_empty() { number.to_string() } else { format!("{part}.{number}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_belong_to_their_equation_and_sections_to_none() {
        let numbering = Numbering(vec![("4".to_owned(), 91), ("A".to_owned(), 27)]);
        let number = |id: &str| numbering.number_of(id);
        assert_eq!(number("4.31.s2").as_deref(), Some("4.31"));
        assert_eq!(number("A.16").as_deref(), Some("A.16"));
        for none in
            ["A.section2.generic", "3.1", "4.text.curvature", "rank.level", "4.92", "4.0", "4", "45.1"]
        {
            assert_eq!(number(none), None, "{none}");
        }
        let all = numbering.equations([]);
        assert_eq!((all.len(), numbering.count()), (118, 118));
        assert!(all.iter().all(|equation| equation.word() == "no entry"));
        let plain = Numbering(vec![(String::new(), 9)]);
        assert_eq!(plain.number_of("7.b").as_deref(), Some("7"));
        assert_eq!(plain.equations([])[8].number, "9");
    }
}
