//! What a person reads is in the words of the field: phrases of our own that it once had do not come back. Read are the texts in quotation
//! marks of the program, its help, the README and the book, the Python package and the notebooks, titles and remarks of proof files and
//! scenes, and the editors' grammars.

use std::path::{Path, PathBuf};

/// Phrases, and what to write in their place; of whole words, whatever their capitals.
#[rustfmt::skip]
const OLD: &[(&str, &str)] = &[
    ("almost all", "generically"),
    ("seen", "observable, identifiable, measured"),
    ("unseen", "unobservable"),
    ("told", "distinguished; observable; printed"),
    ("sought", "estimated"),
    ("by themselves", "observable or identifiable functions; the drift"),
    ("how many values", "globally or locally identifiable; the number of solutions"),
    ("words of up to", "Lie derivatives up to order"),
    ("longer words", "higher Lie derivatives"),
    ("words needed", "Lie derivatives used"),
    ("degrees of freedom are", "dimension of the unobservable distribution"),
    ("but for a probability", "error probability below"),
    ("restated", "holds by definition"),
    ("of them on their own", "independent, the rest consequential"),
    ("where it drops", "the singular set"),
    ("where-it-drops", "--singular-set"),
    ("where the rank drops", "the singular set"),
    ("on which the rank drops", "the singular set, rank-deficient states"),
    ("it is lower", "rank-deficient"),
    ("exists nowhere", "is defined nowhere"),
    ("exist nowhere", "are defined nowhere"),
    ("is a pole", "is a singularity"),
    ("at a pole", "at a singularity"),
    ("were poles", "were singularities"),
    ("are poles", "are singularities"),
    ("met poles", "met singularities"),
    ("their poles", "their singularities"),
    ("poles left out", "singular states left out"),
    ("contain a pole", "contain a singularity"),
    ("contains a pole", "contains a singularity"),
    ("crosses a pole", "crosses a singularity"),
    ("the pole that", "the singularity that"),
    ("beginning", "initial condition; initially; the first sample"),
    ("beginnings", "initial conditions"),
    ("readings", "measurements"),
    ("what is left of", "residuals"),
    ("what is left is", "the residuals are"),
    ("misfit", "residual"),
    ("fits (probability", "passes the chi-square test (p ="),
    ("in parts of its", "normalised by its prior standard deviation"),
    ("rung", "number type"),
    ("rungs", "number types"),
    ("climbed", "escalated to a higher precision"),
    ("the ladder", "the number types"),
    ("by windows", "moving-horizon estimation"),
    ("window whole", "batch least squares"),
    ("region of trust", "trust region"),
    ("gauss and newton", "Gauss-Newton"),
    ("blind", "not observable from this data; uninformative"),
    ("constants at rest", "constants"),
    ("held at the file", "fixed at the values in the file"),
    ("held fixed", "fixed"),
    ("experiments side by side", "multiple experiments"),
    ("systems side by side", "a system for each mode"),
    ("modes side by side", "modes"),
    ("more than it knows", "overclaims; unsound"),
];

/// Where an old word stays: the end of a file's path, a part of the line, and why.
const KEPT: [(&str, &str, &str); 8] = [
    ("src/command/rank.rs", "where-it-drops", "the old name of an option, which is still read"),
    ("crates/scenes/src/scene/keys.rs", "blind", "the old name of a key, which is still read"),
    ("crates/scenes/src/scene/mod.rs", "blind", "the old name of a key, which is still read"),
    ("book/src/scenes.md", "and `blind`; the old names are still read", "it says what a key was called"),
    ("crates/report/src/motion/section.rs", "long enough to be seen", "a length on the screen"),
    ("book/src/poses.md", "\"for almost all combinations", "words of the thesis"),
    ("proofs/moll2002/chapter3_sentences.proof", "printed \"for almost all", "words of the thesis"),
    ("book/src/python_api.md", "### `.readings`", "the old name of a property, which is still there"),
];

/// The old phrase in a text.
fn old_words(text: &str) -> Option<(&'static str, &'static str)> {
    let text = text.to_lowercase();
    let is_part = |c: char| c.is_alphanumeric() || c == '_';
    let stands = |phrase: &str| {
        text.match_indices(phrase).any(|(at, _)| {
            let before = text[..at].chars().next_back().is_some_and(is_part);
            let behind = text[at + phrase.len()..].chars().next().is_some_and(is_part);
            !(before || behind && phrase.ends_with(is_part))
        })
    };
    OLD.iter().copied().find(|(phrase, _)| stands(phrase))
}

/// A text without what stands in braces, which is a name in a pattern of the program.
fn without_places(text: &str) -> String {
    let (mut kept, mut depth) = (String::new(), 0_usize);
    for c in text.chars() {
        match c {
            '{' => depth += 1,
            '}' => depth = depth.saturating_sub(1),
            c if depth == 0 => kept.push(c),
            _ => {}
        }
    }
    kept
}

/// The text literals of a Rust source, with the number of the line in which each begins; not those of its unit tests or its comments.
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

/// The doc comments of commands, options and their values, which `--help` prints: those before an attribute of the reader of commands, or before
/// a field or a variant.
fn help(source: &str) -> Vec<(usize, String)> {
    let (mut found, mut text, mut begin) = (Vec::new(), String::new(), 0);
    for (number, line) in source.lines().enumerate() {
        let line = line.trim();
        if let Some(doc) = line.strip_prefix("///") {
            if text.is_empty() {
                begin = number + 1;
            }
            text.push_str(doc);
            continue;
        }
        let is_help = ["#[arg", "#[command", "#[value", "#[derive(Args", "#[derive(Parser"]
            .iter()
            .any(|start| line.starts_with(start));
        if !text.is_empty() && (is_help || line.ends_with(',') && !line.contains("fn ")) {
            found.push((begin, text.clone()));
        }
        text.clear();
    }
    found
}

/// The lines of a page: prose, and blocks that somebody wrote. What commands print is held by what they print, and comments are not shown.
fn page(source: &str) -> Vec<(usize, String)> {
    let (mut found, mut fence, mut comment) = (Vec::new(), None::<bool>, false);
    for (number, line) in source.lines().enumerate() {
        comment |= fence.is_none() && line.starts_with("<!--");
        if comment {
            comment = !line.contains("-->");
        } else if let Some(kind) = line.strip_prefix("```") {
            let is_output = kind.starts_with("console") || kind.starts_with("json");
            fence = fence.is_none().then_some(is_output);
        } else if fence != Some(true) {
            found.push((number + 1, line.to_owned()));
        }
    }
    found
}

/// The texts of a Python source: in quotation marks of each kind, and comments on what is public (`#:`).
fn python(source: &str) -> Vec<(usize, String)> {
    let (mut found, mut line, mut at) = (Vec::new(), 1, 0);
    while let Some(c) = source[at..].chars().next() {
        let rest = &source[at..];
        let quote = ["\"\"\"", "'''", "\"", "'"].into_iter().find(|quote| rest.starts_with(quote));
        let (length, text) = match (c, quote) {
            ('#', _) => {
                let comment = rest.lines().next().unwrap_or_default();
                (comment.len(), comment.starts_with("#:").then(|| comment.to_owned()))
            }
            (_, Some(quote)) => {
                let inside = &rest[quote.len()..];
                let mut end = 0;
                while end < inside.len() && !inside[end..].starts_with(quote) {
                    let mut two = inside[end..].chars();
                    let first = two.next().expect("it is not the end");
                    let second = if first == '\\' { two.next().map_or(0, char::len_utf8) } else { 0 };
                    end += first.len_utf8() + second;
                }
                (quote.len() * 2 + end, Some(without_places(&inside[..end])))
            }
            _ => (c.len_utf8(), None),
        };
        if let Some(text) = text {
            let lines = text.lines().enumerate();
            found.extend(lines.map(|(below, text)| (line + below, text.to_owned())));
        }
        let taken = &source[at..(at + length).min(source.len())];
        line += taken.matches('\n').count();
        at += taken.len();
    }
    found
}

fn lines(source: &str) -> Vec<(usize, String)> {
    source.lines().enumerate().map(|(number, line)| (number + 1, line.to_owned())).collect()
}

/// The files below a folder with one of these endings; not those of tests, and nothing that others wrote.
fn files(folder: &Path, endings: &[&str], found: &mut Vec<PathBuf>) {
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    for path in entries.flatten().map(|entry| entry.path()) {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        match path.is_dir() {
            true if !["tests", "target", "__pycache__"].contains(&name.as_str()) => {
                files(&path, endings, found);
            }
            false if endings.iter().any(|ending| name.ends_with(ending)) && name != "tests.rs" => {
                found.push(path);
            }
            _ => {}
        }
    }
}

type Texts = fn(&str) -> Vec<(usize, String)>;

/// What a program's source prints.
fn printed(source: &str) -> Vec<(usize, String)> {
    literals(source).into_iter().map(|(line, text)| (line, without_places(&text))).collect()
}

/// Folders or files, the endings in them, how their texts are found, and how many there are at least where the whole project is there.
const READ: [(&str, &[&str], Texts, usize); 15] = [
    ("src", &[".rs"], printed, 500),
    ("crates", &[".rs"], printed, 3000),
    ("python/src", &[".rs"], printed, 20),
    ("src/command", &[".rs"], help, 150),
    ("README.md", &["README.md"], page, 80),
    ("book/src", &[".md"], page, 5000),
    ("book/book.toml", &["book.toml"], lines, 5),
    ("python/palmistry", &[".py"], python, 1000),
    ("notebooks", &[".py", ".md"], lines, 500),
    ("proofs", &[".proof", ".toml"], lines, 3000),
    ("examples", &[".proof", ".toml", ".md"], lines, 50),
    ("src/command/template", &[".proof", ".toml"], lines, 30),
    ("editors", &[".json"], lines, 100),
    ("python/pyproject.toml", &["pyproject.toml"], lines, 5),
    ("Cargo.toml", &["Cargo.toml"], lines, 50),
];

#[test]
fn what_is_read_has_the_words_of_the_field() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    // a package that is published has a part of it alone
    let is_whole = root.join(".ci").exists();
    let (mut wrong, mut kept) = (Vec::new(), vec![0; KEPT.len()]);
    for (place, endings, texts, least) in READ {
        let path = root.join(place);
        let mut found = Vec::new();
        match path.is_file() {
            true => found.push(path),
            false => files(&path, endings, &mut found),
        }
        let mut count = 0;
        for file in &found {
            let name = file.display().to_string();
            // a tool of the notebooks, and no notebook
            if name.ends_with("notebooks/renew.py") {
                continue;
            }
            for (line, text) in texts(&std::fs::read_to_string(file).unwrap()) {
                count += 1;
                let Some((old, new)) = old_words(&text) else { continue };
                let reason =
                    KEPT.iter().position(|(end, part, _)| name.ends_with(end) && text.contains(part));
                match reason {
                    Some(at) => kept[at] += 1,
                    None => wrong.push(format!("{name}:{line}: '{old}' is '{new}': {text}")),
                }
            }
        }
        assert!(count >= least || !is_whole, "{count} texts in {} files of {place}", found.len());
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    let unused = KEPT.iter().zip(&kept).find(|(_, count)| **count == 0 && is_whole);
    assert!(unused.is_none(), "an exception for nothing: {unused:?}");
}

/// Each term of the glossary says where it comes from.
#[test]
fn the_glossary_has_sources() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("book/src/glossary.md");
    let Ok(glossary) = std::fs::read_to_string(path) else { return };
    let rows: Vec<&str> =
        glossary.lines().filter(|line| line.starts_with("| ") && !line.starts_with("| term")).collect();
    assert!(rows.len() > 30, "{} rows", rows.len());
    for row in rows {
        let cells: Vec<&str> = row.trim_matches('|').split(" | ").map(str::trim).collect();
        assert!(cells.len() == 3 && cells.iter().all(|cell| !cell.is_empty()), "{row}");
    }
}

#[test]
fn phrases_are_whole_words() {
    for text in
        ["It is Seen.", "what is left of it", "the initial readings, twice", "fits (probability 0.05)"]
    {
        assert!(old_words(text).is_some(), "{text}");
    }
    for text in ["unforeseen", "`when_blind`", "what is left out", "the order of a pole", "toldness"] {
        assert!(old_words(text).is_none(), "{text}: {:?}", old_words(text));
    }
}

#[test]
fn texts_are_found() {
    let source = "let a = \"one \\\n    two\"; // \"three\"\nlet b = '\"'; let c = \"a\\\"b\nc\"; let d = '\\'';\nlet e = \"last\";\n#[cfg(test)]\nmod tests { \"none\" }";
    let found: Vec<String> = literals(source).into_iter().map(|(_, text)| text).collect();
    assert_eq!(found, ["one two", "ab c", "last"]);
    assert_eq!(literals(source)[2].0, 5);

    let source = "/// Not shown.\nfn one() {}\n/// Shown\n/// twice.\n#[arg(long)]\nfield: bool,\n/// A value.\nCertified,\n";
    assert_eq!(help(source), [(3, " Shown twice.".to_owned()), (7, " A value.".to_owned())]);

    let source = "prose\n```console\n$ output\n```\n```palmistry\nsystem \"s\"\n```\n<!-- held\nx -->\nend\n";
    assert_eq!(page(source).into_iter().map(|(line, _)| line).collect::<Vec<_>>(), [1, 6, 10]);

    let source = "a = 1 # 'no'\n#: public\nb = f\"x {seen} y\" + 'it\\'s'\n\"\"\"Two\nlines.\"\"\"\n";
    let texts: Vec<(usize, String)> = python(source);
    let expected = [(2, "#: public"), (3, "x  y"), (3, "it\\'s"), (4, "Two"), (5, "lines.")];
    assert_eq!(texts, expected.map(|(line, text)| (line, text.to_owned())));
}
