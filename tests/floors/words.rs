//! What is printed is in the words of the field: phrases of our own that it once had do not come back.

use std::path::{Path, PathBuf};

/// Phrases, and what to write in their place.
const OLD: [(&str, &str); 18] = [
    ("almost all states", "generically"),
    ("not seen", "unobservable"),
    ("seen together", "identifiable functions"),
    ("seen by themselves", "observable"),
    ("degrees of freedom are", "dimension of the unobservable distribution"),
    ("told apart", "distinguished"),
    ("told from", "distinguished from"),
    ("is told by", "is given by"),
    ("sought", "estimated"),
    ("words of up to", "Lie derivatives up to order"),
    ("longer words", "higher Lie derivatives"),
    ("rungs", "number types"),
    ("states climbed", "states escalated to a higher precision"),
    ("region of trust", "trust region"),
    ("by windows", "moving-horizon"),
    (" readings", "measurements"),
    ("what is left of", "residuals"),
    ("at the beginning", "initially; an initial condition"),
];

/// The one literal that keeps an old word: a value of a field of JSON.
const KEPT: [&str; 1] = ["all readings"];

/// The text literals of a source, with the number of the line in which each begins; not those of its unit tests or its comments.
fn literals(source: &str) -> Vec<(usize, String)> {
    let source = source.split("#[cfg(test)]\nmod tests").next().unwrap_or_default();
    let (mut found, mut line) = (Vec::new(), 1);
    let mut rest = source.chars().peekable();
    while let Some(c) = rest.next() {
        match c {
            '\n' => line += 1,
            '/' if rest.peek() == Some(&'/') => {
                for next in rest.by_ref() {
                    if next == '\n' {
                        line += 1;
                        break;
                    }
                }
            }
            // a character that is a quotation mark opens no text
            '\'' if rest.peek() == Some(&'"') => {
                rest.next();
            }
            '\'' if rest.peek() == Some(&'\\') => {
                rest.next();
                rest.next();
            }
            '"' => {
                let (begin, mut text) = (line, String::new());
                while let Some(next) = rest.next() {
                    match next {
                        '"' => break,
                        '\\' => {
                            if rest.next() == Some('\n') {
                                line += 1;
                                while rest.peek().is_some_and(|c| *c == ' ') {
                                    rest.next();
                                }
                            }
                        }
                        '\n' => {
                            line += 1;
                            text.push(' ');
                        }
                        next => text.push(next),
                    }
                }
                found.push((begin, text));
            }
            _ => {}
        }
    }
    found
}

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    for path in entries.flatten().map(|entry| entry.path()) {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        match path.is_dir() {
            true if name != "tests" => sources(&path, found),
            false if name.ends_with(".rs") && name != "tests.rs" => found.push(path),
            _ => {}
        }
    }
}

#[test]
fn what_is_printed_has_the_words_of_the_field() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files = Vec::new();
    for folder in ["src", "crates"] {
        sources(&root.join(folder), &mut files);
    }
    let (mut wrong, mut count) = (Vec::new(), 0);
    for file in &files {
        let text = std::fs::read_to_string(file).unwrap();
        for (line, literal) in literals(&text) {
            count += 1;
            let old = OLD.iter().find(|(old, _)| literal.contains(old) && !KEPT.contains(&literal.as_str()));
            if let Some((old, new)) = old {
                wrong.push(format!("{}:{line}: '{old}' is '{new}': {literal}", file.display()));
            }
        }
    }
    // a package that is published has the root alone
    assert!(count > 500, "{count} literals in {} files", files.len());
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn literals_are_read_as_they_are_printed() {
    let source = "let a = \"one \\\n    two\"; // \"three\"\nlet b = '\"'; let c = \"a\\\"b\nc\"; let d = '\\'';\nlet e = \"last\";\n#[cfg(test)]\nmod tests { \"none\" }";
    let found: Vec<String> = literals(source).into_iter().map(|(_, text)| text).collect();
    assert_eq!(found, ["one two", "ab c", "last"]);
    assert_eq!(literals(source)[2].0, 5);
}
