//! Names of a proof file as names of Coq: no two are the same, and none is a word of Coq or of the library.

use std::collections::{HashMap, HashSet};

/// Words of Coq that are no names, and names that the library or what is printed here uses.
const TAKEN: [&str; 123] = [
    "Add",
    "AtMost",
    "Atan",
    "Axiom",
    "Check",
    "Cos",
    "Cst",
    "Definition",
    "Differ",
    "End",
    "Equal",
    "Exp",
    "Fixpoint",
    "Inductive",
    "Inv",
    "L",
    "Lemma",
    "Less",
    "Ln",
    "Module",
    "Mul",
    "Notation",
    "O",
    "Opp",
    "Pi",
    "Pow",
    "Prop",
    "Proof",
    "Qed",
    "S",
    "Section",
    "Set",
    "Sin",
    "Sqrt",
    "Sub",
    "Theorem",
    "Type",
    "Var",
    "above",
    "anywhere",
    "entry_at",
    "Number",
    "Angle",
    "refuted",
    "is_about_something",
    "differs_at",
    "defined_at",
    "matrices_are_about_something",
    "as",
    "at",
    "beside",
    "bracket",
    "by",
    "IF",
    "SProp",
    "_",
    "Abs",
    "Sign",
    "Atan2",
    "Tan",
    "Cot",
    "Sec",
    "Csc",
    "Sinh",
    "Cosh",
    "Tanh",
    "cofix",
    "column_of",
    "cons",
    "cross2",
    "cross3",
    "d",
    "det",
    "differential",
    "dot",
    "each",
    "else",
    "end",
    "entry",
    "equal",
    "eval",
    "exists",
    "exists2",
    "field",
    "fix",
    "for",
    "forall",
    "fun",
    "identity",
    "if",
    "in",
    "inverse",
    "let",
    "list",
    "match",
    "matrix",
    "minus",
    "mod",
    "mul",
    "nat",
    "nil",
    "of",
    "opp",
    "plus",
    "put",
    "return",
    "same",
    "state",
    "sub",
    "subst",
    "term",
    "then",
    "times",
    "total",
    "transpose",
    "using",
    "where",
    "with",
    "zip",
    "add",
    "one",
    "zero",
    "pair",
];

/// The names that were given.
#[derive(Default)]
pub(crate) struct Names {
    given: HashMap<String, String>,
    taken: HashSet<String>,
}

impl Names {
    /// The name in Coq of what has this name here; the kind distinguishes what may share a name: `claim`,
    /// `field`.
    pub fn of(&mut self, kind: &str, name: &str) -> String {
        let key = format!("{kind} {name}");
        if let Some(known) = self.given.get(&key) {
            return known.clone();
        }
        let plain = plain(name);
        let begin = match kind {
            "claim" => format!("claim_{plain}"),
            _ if plain.starts_with(|first: char| first.is_ascii_digit() || first == '\'') => {
                format!("n{plain}")
            }
            _ => plain,
        };
        let mut found = begin;
        while TAKEN.contains(&found.as_str()) || self.taken.contains(&found) {
            found.push('_');
        }
        self.taken.insert(found.clone());
        self.given.insert(key, found.clone());
        found
    }
}

/// Letters, digits, underscores and primes stay, brackets fall, all others become underscores.
fn plain(name: &str) -> String {
    let sign = |sign: char| match sign {
        ']' => None,
        'a'..='z' | 'A'..='Z' | '0'..='9' | '_' | '\'' => Some(sign),
        letter if letter.is_alphabetic() && letter as u32 <= 0x3ff => Some(letter),
        _ => Some('_'),
    };
    name.chars().filter_map(sign).collect()
}

/// A text of a file within a comment: it neither ends the comment nor begins another, nor a string.
pub(crate) fn in_comment(text: &str) -> String {
    let shown = palmistry_io::foreign::shown(text);
    let mut out = String::with_capacity(shown.len());
    for sign in shown.chars() {
        match (out.chars().last(), sign) {
            (Some('('), '*') | (Some('*'), ')') => {
                out.push(' ');
                out.push(sign);
            }
            (_, '"') => out.push('\''),
            _ => out.push(sign),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_differ_where_they_did() {
        let mut names = Names::default();
        assert_eq!(names.of("value", "r1"), "r1");
        assert_eq!(names.of("value", "x[1]"), "x_1");
        assert_eq!(names.of("value", "x_1"), "x_1_");
        assert_eq!(names.of("value", "at"), "at_");
        assert_eq!(names.of("value", "contact.d1"), "contact_d1");
        assert_eq!(names.of("value", "u'"), "u'");
        assert_eq!(names.of("claim", "4.48"), "claim_4_48");
        assert_eq!(names.of("value", "r1"), "r1");
    }

    #[test]
    fn a_comment_ends_where_it_should() {
        assert_eq!(in_comment("a *) Qed. (* \"b"), "a * ) Qed. ( * 'b");
        assert_eq!(in_comment("**) (*)"), "** ) ( * )");
        assert!(!in_comment("one\ntwo").contains('\n'));
    }
}
