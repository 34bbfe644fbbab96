//! The grammar for highlighting knows every word that the reader knows, and colours what the reader reads so.

use super::shipped;
use super::textmate::Grammar;
use crate::common::{folder, palmistry, write};
use palmistry::System;
use palmistry::system::vocabulary::{
    CONSTANTS, ENTRIES, RESERVED, SPECIAL, UNDECLARABLE, VIEWS, dimensions, functions,
};
use std::collections::BTreeSet;
use std::path::Path;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn grammar() -> Grammar {
    Grammar::read(&root().join("editors/palmistry.tmLanguage.json"))
}

fn is_keyword(scope: &str) -> bool {
    ["keyword.control.", "keyword.other.", "storage.type."].iter().any(|kind| scope.contains(kind))
}

/// A scope for a text: the one that all its bytes have.
fn scope_of(grammar: &Grammar, text: &str, part: &str) -> String {
    let at = text.rfind(part).expect("it is a part");
    let scopes = &grammar.scopes(text)[at..at + part.len()];
    assert!(scopes.iter().all(|scope| *scope == scopes[0]), "{part} in {text}: {scopes:?}");
    scopes[0].clone()
}

#[test]
fn every_word_of_the_reader_is_known() {
    let grammar = grammar();
    for word in RESERVED {
        assert!(is_keyword(&scope_of(&grammar, &format!("{word} x"), word)), "{word}");
        assert!(is_keyword(&scope_of(&grammar, word, word)), "{word} alone in its line");
    }
    for word in functions() {
        assert!(scope_of(&grammar, &format!("{word}(x)"), word).contains("support.function"), "{word}");
        // a name where no bracket follows; 'rank' is then that of the codistribution
        let scope = scope_of(&grammar, &format!("1 + {word}*x"), word);
        assert!(!scope.contains("function") && !is_keyword(&scope), "{word}: {scope}");
    }
    for word in CONSTANTS {
        assert!(scope_of(&grammar, &format!("{word} = 2"), word).contains("constant.language"), "{word}");
    }
    for word in dimensions() {
        let text = format!("state a, b : {word}^2/time, c");
        assert!(scope_of(&grammar, &text, word).contains("support.type.dimension"), "{word}");
        assert!(
            !scope_of(&grammar, &format!("claim 1: {word} = 0"), word).contains("support.type"),
            "{word}"
        );
    }
}

/// Where words that are names elsewhere are none: in files that the reader reads.
#[test]
fn words_that_may_be_names_are_told_by_what_follows() {
    let other = "system \"other\" state a, b drift f a' = b others' = 0 output a claim 3: a = a\n";
    let text = "system \"s\"\nuse o = \"other.proof\"\nstate a, b\n\
                param k = 2 unknown, l known, m : 1/time unknown\nknown u(t)\nunknown w(t) order 2\ndrift f\n  a' = b\n  others' = 0\n\
                claim 1 restates 3 in \"other.proof\": a = a\nclaim 2 consequence: a = a\nclaim 4 example: a = a\n\
                claim 5 expect refuted: a = 1\nclaim 6 expect proved: a = a\nerratum 7: printed \"a\" as a = 1 corrected a = a \"b\" conclusion \"none\"\n\
                convention 8 follows 7: printed a = 1 meant a = a\ndamaged 9: reads a = 1 repaired a = a\n\
                claim 10: a at {a = 2} = 2.0 carrying 2 digits\nclaim 11: a^2 >= 0 on sample\n\
                claim 12: rank = 2 except where a = 0, b = 0 or b = 1\nclaim 13: rank = 2 everywhere\nset \"x\": a = 0\nsingularity \"y\": a = 1\npole \"z\": a = 2\n\
                map \"m\": a in [0, 1], b in [0, 1] order 2\nline \"l\": a to infinity from {b = 1}\nreduction of o: b = 0\n\
                experiments 2\ninitial a known\n";
    let folder = folder();
    write(&folder, "other.proof", other);
    System::parse("s.proof", text, folder.path()).expect("the reader reads it");
    let grammar = grammar();
    let scopes = grammar.scopes(text);
    let mut met = BTreeSet::new();
    let words = text.split(|c: char| !c.is_ascii_alphanumeric()).filter(|word| !word.is_empty());
    for word in words {
        let at = word.as_ptr() as usize - text.as_ptr() as usize;
        if SPECIAL.contains(&word) && !scopes[at].contains("string") {
            let known =
                is_keyword(&scopes[at]) || word == "infinity" && scopes[at].contains("constant.language");
            assert!(known, "{word} at {at}: {}", scopes[at]);
            met.insert(word);
        }
    }
    assert_eq!(met, SPECIAL.iter().copied().collect(), "each of them");

    // and the same words as names
    let names: Vec<&str> = SPECIAL.iter().copied().filter(|word| !UNDECLARABLE.contains(word)).collect();
    let sum = names.join(" + ");
    let text =
        format!("system \"names\"\nstate {}\nlet total = {sum}\nlet o = total*order/to\n", names.join(", "));
    System::parse("names.proof", &text, Path::new("")).expect("all of them are names");
    for (at, scope) in grammar.scopes(&text).iter().enumerate().skip(text.find("let total").unwrap()) {
        let word: String = text[at..].chars().take_while(char::is_ascii_alphanumeric).collect();
        let begins = !text[..at].ends_with(|c: char| c.is_ascii_alphanumeric());
        assert!(!(begins && SPECIAL.contains(&word.as_str()) && is_keyword(scope)), "{word}: {scope}");
    }
}

/// Components, ranges and steps.
#[test]
fn vectors_and_steps_are_coloured() {
    let grammar = grammar();
    for (text, part, kind) in [
        ("  x[i]' = 1", "'", "keyword.operator.derivative"),
        ("  x[i + 1]+ = 1", "+ =", "keyword.operator"),
        ("  x+ = 1", "x", "variable.other.state"),
        ("state x[1..20]", "..", "keyword.operator.range"),
        ("state x[1..20]", "20", "constant.numeric"),
        ("  x[i]' = 1 for i in 2..3", "for", "keyword.other"),
        ("let a = sum(i in 1..3, x[i])", "sum", "support.function"),
        ("let a = 1.5", "1.5", "constant.numeric"),
    ] {
        let at = text.rfind(part).expect("it is a part");
        let scope = &grammar.scopes(text)[at];
        assert!(scope.contains(kind), "{part} in {text}: {scope}");
    }
}

/// Of every shipped file: each word that begins an entry is a keyword, and each byte is part of a comment or of a text in quotation marks
/// where the reader has it so.
#[test]
fn every_line_of_every_shipped_file_is_coloured() {
    let grammar = grammar();
    let (mut entries, mut equations) = (0, 0);
    for path in shipped() {
        let text = std::fs::read_to_string(&path).expect("a text");
        let scopes = grammar.scopes(&text);
        let (mut quoted, mut comment, mut is_first) = (false, false, true);
        for (at, c) in text.char_indices() {
            let place = || format!("{}:{}", path.display(), text[..at].matches('\n').count() + 1);
            let scope = scopes[at].as_str();
            if c == '\n' {
                (comment, is_first) = (false, true);
                continue;
            }
            comment |= c == '#' && !quoted;
            let in_quotes = !comment && (quoted || c == '"');
            assert_eq!(scope.contains("comment"), comment, "{}: {scope}", place());
            assert_eq!(scope.contains("string"), in_quotes, "{}: {scope}", place());
            if is_first && !c.is_whitespace() && !comment && !in_quotes {
                let word: &str =
                    text[at..].split(|c: char| !(c.is_ascii_alphanumeric() || c == '_')).next().unwrap();
                let rest = text[at + word.len()..].trim_start();
                let is_view = VIEWS.contains(&word);
                if ENTRIES.contains(&word) && (!is_view || rest.starts_with('"') || rest.starts_with("of ")) {
                    entries += 1;
                    let whole = &scopes[at..at + word.len()];
                    assert!(whole.iter().all(|scope| is_keyword(scope)), "{}: '{word}' is {scope}", place());
                    if whole[0].contains("control.claim") {
                        let id = at + text[at..].find(rest).unwrap();
                        assert!(
                            scopes[id].contains("entity.name.section.equation"),
                            "{}: {}",
                            place(),
                            scopes[id]
                        );
                        equations += 1;
                    }
                }
            }
            quoted ^= c == '"' && !comment;
            is_first &= c.is_whitespace();
        }
    }
    // some files write several entries in a line, so that these are not all
    assert!(entries > 1500 && equations > 800, "{entries} entries, {equations} equations");
}

/// The extension for one editor carries the same grammar, names files that are there, and starts a command that is there.
#[test]
fn the_extension_fits_the_grammar_and_the_program() {
    let folder = root().join("editors/vscode");
    let read =
        |path: &Path| std::fs::read_to_string(path).unwrap_or_else(|why| panic!("{}: {why}", path.display()));
    let manifest: serde_json::Value =
        serde_json::from_str(&read(&folder.join("package.json"))).expect("JSON");
    let language = &manifest["contributes"]["languages"][0];
    let grammar = &manifest["contributes"]["grammars"][0];
    assert_eq!(language["id"], grammar["language"]);
    assert_eq!(language["extensions"], serde_json::json!([".proof"]));
    let copy = folder.join(grammar["path"].as_str().unwrap());
    assert_eq!(
        read(&copy),
        read(&root().join("editors/palmistry.tmLanguage.json")),
        "one grammar in two places"
    );
    let configuration = read(&folder.join(language["configuration"].as_str().unwrap()));
    let configuration: serde_json::Value = serde_json::from_str(&configuration).expect("JSON");
    assert_eq!(configuration["comments"]["lineComment"], "#");
    assert_eq!(manifest["version"], env!("CARGO_PKG_VERSION"));
    let code = read(&folder.join(manifest["main"].as_str().unwrap()));
    assert!(code.contains("args: [\"lsp\"]"), "{code}");
    assert_eq!(palmistry(&["lsp", "--help"]).status.code(), Some(0));
}
