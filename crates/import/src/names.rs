//! Names of other programs as names of our language: Greek letters spelled out, what may not stand in a name replaced, words of the
//! language avoided, and no two names made one.

use palmistry_lang::vocabulary;
use std::collections::{BTreeMap, BTreeSet};

/// What each foreign name is called here.
#[derive(Debug, Default)]
pub(super) struct ForeignNames {
    ours: BTreeMap<String, String>,
    taken: BTreeSet<String>,
    /// Of names that are taken, the last number that was put behind.
    counts: BTreeMap<String, usize>,
}

const GREEK: [(char, &str); 56] = [
    ('α', "alpha"),
    ('β', "beta"),
    ('γ', "gamma"),
    ('δ', "delta"),
    ('ε', "epsilon"),
    ('ϵ', "epsilon"),
    ('ζ', "zeta"),
    ('η', "eta"),
    ('θ', "theta"),
    ('ϑ', "vartheta"),
    ('ι', "iota"),
    ('κ', "kappa"),
    ('λ', "lambda"),
    ('μ', "mu"),
    ('µ', "mu"),
    ('ν', "nu"),
    ('ξ', "xi"),
    ('ο', "omicron"),
    ('π', "pi"),
    ('ρ', "rho"),
    ('σ', "sigma"),
    ('ς', "sigma"),
    ('τ', "tau"),
    ('υ', "upsilon"),
    ('φ', "phi"),
    ('ϕ', "phi"),
    ('χ', "chi"),
    ('ψ', "psi"),
    ('ω', "omega"),
    ('Α', "Alpha"),
    ('Β', "Beta"),
    ('Γ', "Gamma"),
    ('Δ', "Delta"),
    ('Ε', "Epsilon"),
    ('Ζ', "Zeta"),
    ('Η', "Eta"),
    ('Θ', "Theta"),
    ('Ι', "Iota"),
    ('Κ', "Kappa"),
    ('Λ', "Lambda"),
    ('Μ', "Mu"),
    ('Ν', "Nu"),
    ('Ξ', "Xi"),
    ('Ο', "Omicron"),
    ('Π', "Pi"),
    ('Ρ', "Rho"),
    ('Σ', "Sigma"),
    ('Τ', "Tau"),
    ('Υ', "Upsilon"),
    ('Φ', "Phi"),
    ('Χ', "Chi"),
    ('Ψ', "Psi"),
    ('Ω', "Omega"),
    ('ℯ', "e"),
    ('′', "_prime"),
    ('∞', "infinity"),
];

/// A name in letters, digits and underscores, that begins with a letter.
fn spelled(name: &str) -> String {
    let mut out = String::new();
    for c in name.chars() {
        let greek = GREEK.iter().find(|(own, _)| *own == c).map(|(_, word)| *word);
        match (c, greek) {
            (_, Some(word)) => out.push_str(word),
            ('₀'..='₉', _) => out.extend(char::from_digit(c as u32 - '₀' as u32, 10)),
            ('⁰' | '⁴'..='⁹', _) => out.extend(char::from_digit(c as u32 - '⁰' as u32, 10)),
            ('¹', _) => out.push('1'),
            ('²', _) => out.push('2'),
            ('³', _) => out.push('3'),
            _ if c.is_ascii_alphanumeric() || c == '_' => out.push(c),
            _ if c.is_alphanumeric() => out.push_str(&format!("u{:x}", u32::from(c))),
            // what stands at the end of a name divides nothing
            _ => out.push('_'),
        }
    }
    match out.chars().next() {
        Some(c) if c.is_ascii_alphabetic() => out,
        Some('_') => format!("v{out}"),
        Some(_) => format!("v_{out}"),
        None => "v".to_owned(),
    }
}

/// Words that ask something of a model, and that no list of the vocabulary has: the language refuses them where a name is declared. A test holds
/// each of them to that.
const ASKING: [&str; 6] =
    ["observable", "unobservable", "identifiable", "unidentifiable", "solutions", "codistribution"];

/// Whether a name means something else in our language, at some place or other. The name of a function is one where a bracket
/// follows, and a symbol elsewhere.
fn has_a_meaning(name: &str) -> bool {
    let lists = [
        vocabulary::ENTRIES,
        vocabulary::VIEWS,
        vocabulary::RESERVED,
        vocabulary::UNDECLARABLE,
        vocabulary::SPECIAL,
        vocabulary::CONSTANTS,
    ];
    ASKING.contains(&name) || lists.iter().any(|list| list.contains(&name))
}

impl ForeignNames {
    /// Names for all of these. Those that may stay as they are do so, and the others make way for them.
    pub fn of<'a>(foreign: impl IntoIterator<Item = &'a str> + Clone) -> ForeignNames {
        let mut names = ForeignNames::default();
        for name in foreign.clone() {
            if spelled(name) == name && !has_a_meaning(name) {
                names.taken.insert(name.to_owned());
                names.ours.insert(name.to_owned(), name.to_owned());
            }
        }
        for name in foreign {
            if !names.ours.contains_key(name) {
                let ours = names.free(&spelled(name));
                names.ours.insert(name.to_owned(), ours);
            }
        }
        names
    }

    /// A name like this one that nothing has yet; it is taken then.
    pub fn free(&mut self, wanted: &str) -> String {
        let mut name = if has_a_meaning(wanted) { format!("{wanted}_") } else { wanted.to_owned() };
        let stem = wanted.trim_end_matches('_');
        while self.taken.contains(&name) || has_a_meaning(&name) {
            let count = self.counts.entry(stem.to_owned()).or_insert(1);
            *count += 1;
            name = format!("{stem}_{count}");
        }
        self.taken.insert(name.clone());
        name
    }

    /// What a foreign name is called here.
    pub fn ours<'a>(&'a self, foreign: &'a str) -> &'a str {
        self.ours.get(foreign).map_or(foreign, String::as_str)
    }

    /// Those that are called otherwise here: foreign name and ours.
    pub fn renamed(&self) -> impl Iterator<Item = (&str, &str)> {
        self.ours
            .iter()
            .map(|(foreign, ours)| (foreign.as_str(), ours.as_str()))
            .filter(|(foreign, ours)| foreign != ours)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_names_become_one_and_no_name_is_a_word_of_the_language() {
        let foreign = [
            "β", "beta", "beta_", "x₁", "x1", "state", "state_", "rank", "pi", "_a", "1b", "a.b", "a-b", "é",
            "sin", "π",
        ];
        let names = ForeignNames::of(foreign);
        let ours: BTreeSet<&str> = foreign.iter().map(|name| names.ours(name)).collect();
        assert_eq!(ours.len(), foreign.len(), "{ours:?}");
        for name in &ours {
            assert!(!has_a_meaning(name) && name.starts_with(|c: char| c.is_ascii_alphabetic()), "{name}");
            assert!(name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_'), "{name}");
        }
        let said: Vec<(&str, &str)> =
            ["beta", "β", "x₁", "x1", "state"].iter().map(|name| (*name, names.ours(name))).collect();
        assert_eq!(
            said,
            [("beta", "beta"), ("β", "beta_2"), ("x₁", "x1_2"), ("x1", "x1"), ("state", "state_2")]
        );
    }
}
