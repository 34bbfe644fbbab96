//! Each table of numbers, and each paragraph with three or more, says where its numbers are from.
//!
//! Behind it stands a comment: `held...` (`numbers.rs`), or one of these, each of which may be about `rows 3 to 3` of a table alone:
//!
//! - `measured: COMMAND; WHERE AND WHEN` for times, memory and other programs, which differ from machine to machine;
//! - `counted once: WHY` where no command of the program repeats it;
//! - `held elsewhere: PATH` where a test that reads the page compares it;
//! - `not held: WHY` where the program does not print it: a definition, a formula, a citation, what was set.
//!
//! A table needs a source for each row that has a number. What a script writes between `<!-- NAME -->` and `<!-- end ... -->` has its
//! `measured` behind that end. Numbers in code, formulas and links do not count, nor those of sections, figures and years.

use crate::numbers::{cells, root};
use crate::pages::pages;
use regex_lite::Regex;

/// Pages that are made by a program, which another test compares with them.
const MADE: [(&str, &str); 4] = [
    ("gallery.md", "tests/book/gallery.rs makes it"),
    ("errors.md", "a copy of crates/lang/src/errors.md (complete.rs), whose blocks are run"),
    ("python_api.md", "python/tests/test_api.py makes it"),
    ("python_names.md", "python/tests/test_names.py makes it"),
];

/// From how many numbers on a paragraph or a table needs a source.
const MANY: usize = 3;

/// How many paragraphs and tables may say that they are not held, or were counted once.
const EXCEPTIONS: usize = 40;

/// A paragraph or a table, or a comment on one.
#[derive(Debug)]
struct Part {
    line: usize,
    lines: Vec<String>,
    is_comment: bool,
}

impl Part {
    fn is_table(&self) -> bool {
        !self.is_comment && self.lines.len() > 2 && self.lines.iter().all(|line| line.starts_with('|'))
    }

    /// A comment without its marks, if it is about numbers.
    fn source(&self) -> Option<&str> {
        let text = self.lines.first().filter(|_| self.is_comment)?.strip_prefix("<!-- ")?;
        ["held", "measured", "counted once", "not held"]
            .iter()
            .any(|word| text.starts_with(word))
            .then_some(text)
    }
}

/// The paragraphs, tables and comments of a page, in order, without its blocks.
fn parts(page: &str) -> Vec<Part> {
    let mut found: Vec<Part> = Vec::new();
    let (mut in_block, mut in_comment, mut goes_on) = (false, false, false);
    for (line, text) in (1..).zip(page.lines().map(str::trim)) {
        if text.starts_with("```") && !in_comment {
            in_block = !in_block;
            goes_on = false;
            continue;
        }
        if in_block {
            continue;
        }
        let begins_comment = !in_comment && text.starts_with("<!--");
        if text.is_empty() && !in_comment {
            goes_on = false;
        } else if goes_on && !begins_comment {
            found.last_mut().expect("it goes on").lines.push(text.to_owned());
        } else {
            found.push(Part { line, lines: vec![text.to_owned()], is_comment: begins_comment });
            goes_on = true;
        }
        in_comment |= begins_comment;
        if in_comment && text.ends_with("-->") {
            (in_comment, goes_on) = (false, false);
        }
    }
    found
}

/// How many numbers a text has that a program may have printed.
fn count(text: &str) -> usize {
    let mut text = text.to_owned();
    for beside in [
        r"`[^`]*`",
        r"\$[^$]*\$",
        r"\]\([^)]*\)",
        r"(?i)(sections?|figures?|tables?|chapters?|equations?|plan|seeds?|of order|at order) [0-9A-C][0-9.]*((,| and| to) [0-9][0-9.]*)*",
        r"\b(1[89]|20)[0-9][0-9]\b",
        r"^[0-9]+\. ",
    ] {
        text = Regex::new(beside).expect("an expression").replace_all(&text, " ").into_owned();
    }
    let number = Regex::new(r"(^|[^A-Za-z0-9._^{/])[-+]?[0-9][0-9,]*(\.[0-9]+)?(e[-+]?[0-9]+)?")
        .expect("an expression");
    number.find_iter(&text).count()
}

/// The rows of a table that a comment is about, from 1; none where it is about all.
fn rows(source: &str) -> Option<(usize, usize)> {
    let found =
        Regex::new(r"^[a-z ]+, rows ([0-9]+) to ([0-9]+):").expect("an expression").captures(source)?;
    Some((found[1].parse().ok()?, found[2].parse().ok()?))
}

/// What is wrong with a comment that is not `held`.
fn misstated(source: &str) -> Option<String> {
    let (how, rest) = source.split_once(':').unwrap_or((source, ""));
    let rest = rest.trim().trim_end_matches("-->").trim();
    if how == "held elsewhere" {
        let path = rest.split_whitespace().next().unwrap_or_default();
        let text = std::fs::read_to_string(root().join(path)).unwrap_or_default();
        return (!text.contains("book/src/")).then(|| format!("'{path}' reads no page of the book"));
    }
    if how.starts_with("held") {
        return None;
    }
    if rest.split_whitespace().count() < 3 {
        return Some(format!("'{how}:' has no reason"));
    }
    if !how.starts_with("measured") {
        return None;
    }
    let Some((command, when)) = rest.split_once("; ") else {
        return Some("'measured: COMMAND; WHERE AND WHEN' has no '; '".to_owned());
    };
    let named = |expression: &str| -> Vec<String> {
        let found = Regex::new(expression).expect("an expression");
        found.captures_iter(command).map(|found| found[1].to_owned()).collect()
    };
    let benches = named(r"--bench ([a-z_]+)");
    let files = named(r"\b((?:benches|tests|python)/[a-z_/.-]+)");
    let commands = named(r"palmistry ([a-z]+)");
    let tests = named(r"--test ([a-z]+)");
    if benches.len() + files.len() + commands.len() + tests.len() == 0 {
        return Some(format!("'{command}' is no command of the project"));
    }
    let manifest = std::fs::read_to_string(root().join("Cargo.toml")).expect("a manifest");
    // what is published lacks some of the folders
    let is_there = |path: &str| root().join(path).exists() || !root().join("benches/peers").exists();
    let lacks = (benches.iter().filter(|name| !manifest.contains(&format!("name = \"{name}\""))))
        .chain(files.iter().filter(|path| !is_there(path)))
        .chain(commands.iter().filter(|name| !root().join(format!("book/src/commands/{name}.md")).exists()))
        .chain(tests.iter().filter(|name| !root().join(format!("tests/{name}")).is_dir()))
        .next();
    match lacks {
        Some(name) => Some(format!("there is no '{name}', as in '{command}'")),
        None => {
            (when.split_whitespace().count() < 2).then(|| format!("'{when}' says neither where nor when"))
        }
    }
}

/// The sources behind the end of what a script writes, if that is where these parts begin.
fn behind_the_end(below: &[Part]) -> impl Iterator<Item = &str> {
    let mut marks = below.iter().enumerate().filter(|(_, part)| part.is_comment && part.source().is_none());
    let end = marks.next().filter(|(_, mark)| mark.lines[0].starts_with("<!-- end")).map(|(place, _)| place);
    let behind = end.map_or(&below[..0], |end| &below[end..]);
    behind.iter().take_while(|part| part.is_comment).filter_map(Part::source)
}

/// What has no source on a page, and how many say that they are not held.
fn without_source(page: &str) -> (Vec<String>, usize) {
    let parts = parts(page);
    let (mut wrong, mut exceptions) = (Vec::new(), 0);
    for (place, part) in parts.iter().enumerate() {
        if let Some(source) = part.source() {
            exceptions += usize::from(!source.starts_with("held") && !source.starts_with("measured"));
            wrong.extend(misstated(&part.lines.join(" ")[5..]).map(|why| format!("{}: {why}", part.line)));
        }
        if part.is_comment || part.lines[0].starts_with('#') {
            continue;
        }
        let below = &parts[place + 1..];
        if behind_the_end(below).any(|source| !source.starts_with("held")) {
            continue;
        }
        let next_to = below.iter().take_while(|part| part.is_comment).filter_map(Part::source);
        if !part.is_table() {
            // a list item, or a line of one, begins with its number
            let numbers: usize = part.lines.iter().map(|line| count(line)).sum();
            if numbers >= MANY && next_to.count() == 0 {
                wrong.push(format!("{}: {numbers} numbers: {}", part.line, part.lines[0]));
            }
            continue;
        }
        let numbers: usize = part.lines[2..].iter().map(|line| count(line)).sum();
        // comments on rows may stand behind a paragraph
        let on_rows = below.iter().take_while(|part| !part.is_table()).filter_map(Part::source);
        let on_rows = on_rows.filter(|source| source.contains(", row"));
        let sources: Vec<&str> = next_to.chain(on_rows).collect();
        let is_covered = |row: usize| {
            sources.iter().any(|source| rows(source).is_none_or(|(from, to)| (from..=to).contains(&row)))
        };
        let open = (1..).zip(&part.lines[2..]).find(|(row, line)| count(line) > 0 && !is_covered(*row));
        if numbers >= MANY
            && let Some((row, line)) = open
        {
            let first = cells(line).into_iter().next().unwrap_or_default();
            wrong.push(format!("{}: a table with {numbers} numbers, row {row} ('{first}')", part.line));
        }
    }
    (wrong, exceptions)
}

#[test]
fn tables_and_paragraphs_say_where_their_numbers_are_from() {
    let (mut wrong, mut exceptions) = (Vec::new(), 0);
    for path in pages() {
        let name = path.strip_prefix(root()).expect("a page of the project").display().to_string();
        // the README has no room for comments: `README` in numbers.rs
        if name == "README.md" || MADE.iter().any(|(made, _)| name.ends_with(made)) {
            continue;
        }
        let (found, more) = without_source(&std::fs::read_to_string(&path).expect("a page"));
        wrong.extend(found.into_iter().map(|line| format!("{name}:{line}")));
        exceptions += more;
    }
    println!("{exceptions} are not held, or were counted once");
    assert!(
        wrong.is_empty(),
        "no comment says where these numbers are from (tests/book/sources.rs):\n{}",
        wrong.join("\n")
    );
    assert!(exceptions <= EXCEPTIONS, "{exceptions} are not held or were counted once; hold one of them");
}

#[test]
fn numbers_without_a_source_are_found() {
    let said = |page: &str| without_source(page).0.join("; ");
    let table = "| a | b |\n|---|---|\n| x | 1, 2 |\n| y | 3 |\n";
    assert_eq!(said(table), "1: a table with 3 numbers, row 1 ('x')");
    assert_eq!(
        said(&format!("{table}\nWords.\n\n<!-- held, rows 1 to 1: x\n{{b}} = y -->")),
        "1: a table with 3 numbers, row 2 ('y')"
    );
    assert_eq!(said(&format!("{table}\n<!-- end -->\n\n<!-- held, row by row: x\n{{b}} = y -->")), "");
    let rest =
        "<!-- held, rows 1 to 1: x\n{b} = y -->\n\n<!-- counted once, rows 2 to 2: by a study of ours -->";
    assert_eq!(said(&format!("{table}\n{rest}")), "");
    assert_eq!(without_source(&format!("{table}\n{rest}")).1, 1);
    assert_eq!(said("Of 12 bodies 3 fall\nand 4.5 % lie.\n\nWords."), "1: 3 numbers: Of 12 bodies 3 fall");
    assert_eq!(said("Of 12 bodies 3 fall\nand 4.5 % lie.\n<!-- not held: they are set -->"), "");
    let written = format!("<!-- a -->\n\n{table}\nOf 1 to 2 and 3.\n\n<!-- end a -->");
    let source = "measured: benches/compare; an AMD EPYC, 2026";
    assert_eq!(said(&format!("{written}\n\n<!-- {source} -->")), "");
    assert_eq!(said(&written).matches("3 numbers").count(), 2);
    assert_eq!(said("In section 3.4 and figure 3.14 of 2002, `1 2 3`, $4 + 5$, [6](7), m8 and 9."), "");
    assert_eq!(said("```\n1 2 3\n```\n1 2\n"), "");
    for (comment, why) in [
        ("not held: no", "'not held:' has no reason"),
        ("held elsewhere: tests/nothing.rs", "'tests/nothing.rs' reads no page"),
        ("measured: cargo bench --bench drawn_solids", "has no '; '"),
        ("measured: by a stop watch; today at noon", "is no command of the project"),
        ("measured: cargo bench --bench nothing; an AMD EPYC, 2026", "there is no 'nothing'"),
        ("measured: palmistry nothing -q; an AMD EPYC, 2026", "there is no 'nothing'"),
        ("measured: cargo bench --bench arrival; here", "neither where nor when"),
    ] {
        let found = said(&format!("1 2 3\n\n<!-- {comment} -->"));
        assert!(found.contains(why), "{comment}: {found}");
    }
}
