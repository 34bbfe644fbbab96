//! The verdicts of outcomes: what each one means, how many entries have it, and which errors are independent.

use palmistry_io::foreign::markdown;
use palmistry_lang::Flaw;
use palmistry_prove::claim::Outcome;
use palmistry_workbench::paper::Numbering;
use std::fmt::Write as _;

/// The rule by which a damage is given to the author, to the scanner or to neither; shown wherever verdicts are explained.
pub(crate) const RULE_OF_DAMAGE: &str = "One rule for damage. What is wrong in the text at hand may be the author's, the \
    typesetter's or the scanner's. *Scanning fault* is said only where characters stand that no typesetter sets (glyphs \
    that are no symbol there, a line set twice or broken off). *Print or scan* is said where a sign, dot, prime, tilde, \
    bar, index, bracket, letter or component is missing or another one, once, and what comes before and after has it \
    right: only the printed page could show whose. *Erratum* is said where the same \
    mistake is carried on, or is one of substance, so that no scanner made it. What is damaged is never *proved*.";

/// What a verdict means.
pub(crate) fn meaning(word: &str) -> &'static str {
    match word {
        "proved" => {
            "derived: the two sides come from different premises, and an exact argument shows that they are equal"
        }
        "holds by definition" => {
            "the two sides are one expression once names are put in: a field or a formula written down again; where it is \
             derived is named"
        }
        "definition" => "nothing is claimed: this is what a name means",
        "consequence" => "what the text says is not decided itself; something that follows from it is proved",
        "example" => "a case of what the text says is proved, and not all of it",
        "erratum" => "the author's: the printed form is refuted, the corrected one proved",
        "print or scan" => {
            "a sign, dot, tilde, bar, index or bracket: the form in the text is refuted where it can be stated, the \
             repaired one proved; only the printed page could show whose mistake it is"
        }
        "scanning fault" => "the scanner's: characters that no typesetter sets; the repaired form is proved",
        "convention" => {
            "refuted as the text names things and proved in another convention that it has in mind: an order of rows, \
             the sign of a permutation"
        }
        "loose wording" => {
            "a sentence or a scheme that does not hold to the letter, and of which nothing that follows makes use to the \
             letter; what is meant is proved"
        }
        "refuted" => "a state in exact numbers at which the two sides differ",
        "undecided" => "neither, with the reason",
        _ => "no entry speaks of it",
    }
}

/// How many outcomes have each verdict, in the order of [`Outcome::WORDS`]; verdicts that none has are left out.
pub(crate) fn counts<'o>(outcomes: impl IntoIterator<Item = &'o Outcome>) -> Vec<(&'static str, usize)> {
    let words: Vec<&str> = outcomes.into_iter().map(Outcome::word).collect();
    let count = |word: &str| words.iter().filter(|known| **known == word).count();
    Outcome::WORDS.into_iter().map(|word| (word, count(word))).filter(|(_, count)| *count > 0).collect()
}

/// The same as text: `12 proved, 2 errata`.
pub fn counts_text<'o>(outcomes: impl IntoIterator<Item = &'o Outcome>) -> String {
    let each: Vec<String> = counts(outcomes).into_iter().map(|(word, count)| numbered(count, word)).collect();
    each.join(", ")
}

/// A number of outcomes with a verdict, in the plural where it has one: `1 erratum`, `2 errata`, `2 proved`.
pub(crate) fn numbered(count: usize, word: &str) -> String {
    match (count, word) {
        (1, _) => format!("1 {word}"),
        (_, "erratum") => format!("{count} errata"),
        (_, "definition" | "consequence" | "example" | "scanning fault" | "convention") => {
            format!("{count} {word}s")
        }
        (_, "holds by definition") => format!("{count} hold by definition"),
        _ => format!("{count} {word}"),
    }
}

/// Faults of one kind, in the order of the paper: those that follow from no other, and the others with what they follow
/// from.
pub(crate) struct Errors<'o> {
    pub independent: Vec<&'o Outcome>,
    pub following: Vec<(&'o Outcome, &'o str)>,
}

/// The errors of one kind.
pub(crate) fn errors<'o>(
    numbering: &Numbering,
    outcomes: impl IntoIterator<Item = &'o Outcome>,
    fault: Flaw,
) -> Errors<'o> {
    let of_kind = outcomes.into_iter().filter(|outcome| outcome.fault == Some(fault) && outcome.ok);
    let mut found = Errors { independent: Vec::new(), following: Vec::new() };
    for outcome in numbering.in_order(of_kind) {
        match &outcome.follows {
            None => found.independent.push(outcome),
            Some(from) => found.following.push((outcome, from)),
        }
    }
    found
}

impl Errors<'_> {
    /// How many there are, how many of them are independent, and from what each other one follows.
    pub fn text(&self, word: &str) -> String {
        match self.consequences() {
            text if text.is_empty() => self.counts(word),
            text => format!("{}: {text}", self.counts(word)),
        }
    }

    /// How many there are, and how many of them are independent of one another.
    pub fn counts(&self, word: &str) -> String {
        let (independent, following) = (self.independent.len(), self.following.len());
        let all = numbered(independent + following, word);
        match following {
            0 => all,
            _ => format!("{all} ({independent} independent, {following} consequential)"),
        }
    }

    /// From what each consequential one follows.
    pub fn consequences(&self) -> String {
        let each = self.following.iter().map(|(outcome, from)| format!("{} follows {from}", outcome.id));
        each.collect::<Vec<_>>().join(", ")
    }
}

/// A table of all verdicts that occur: what they mean, and how many entries and numbered equations have them.
pub(crate) fn verdicts_markdown(numbering: &Numbering, outcomes: &[&Outcome], out: &mut String) {
    let rows = numbering.equations(outcomes.iter().copied());
    let _ = writeln!(out, "| word | entries | equations | what it says |\n|---|---:|---:|---|");
    for (word, count) in counts(outcomes.iter().copied()) {
        let of_equations = rows.iter().filter(|equation| equation.word() == word).count();
        let _ = writeln!(out, "| {word} | {count} | {of_equations} | {} |", meaning(word));
    }
    let _ = writeln!(out, "\n{RULE_OF_DAMAGE}\n");
    for fault in Flaw::ALL {
        let found = errors(numbering, outcomes.iter().copied(), fault);
        if !(found.independent.is_empty() && found.following.is_empty()) {
            let _ = writeln!(out, "- {}.", markdown(&found.text(fault.word())));
        }
    }
    out.push('\n');
}
