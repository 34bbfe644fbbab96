//! What the book has to name: every entry of the language, every command with its page, every field of the JSON.

use crate::blocks::blocks;
use crate::common::{folder, json, palmistry, write};
use std::collections::BTreeSet;

fn chapter(name: &str) -> String {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("book/src").join(name);
    std::fs::read_to_string(path).expect("a chapter")
}

/// A file that begins with no entry is told which words begin one.
#[test]
fn the_grammar_has_every_entry() {
    let why = palmistry::System::parse("a.proof", "nothing", std::path::Path::new("")).expect_err("no entry");
    let all = format!("{:?}", miette::Report::new(why));
    let all = all.split_once("one of:").expect("a list").1;
    let names: Vec<&str> = all
        .split(|c: char| !c.is_ascii_lowercase())
        .filter(|word| !word.is_empty())
        .take_while(|word| *word != "help")
        .collect();
    let language = chapter("language.md");
    let grammar =
        blocks(&language).into_iter().find(|block| block.text.contains("file       = ")).expect("a grammar");
    assert!(names.contains(&"system") && names.contains(&"reduction"), "{names:?}");
    for name in names.iter().take_while(|name| **name != "reduction").chain(&["reduction"]) {
        assert!(grammar.text.contains(&format!("\"{name}\"")), "the grammar lacks '{name}'");
        assert!(language.contains(&format!("`{name} ")), "no entry '{name}' is explained");
    }
}

/// Each command is listed, and has a page with its help, which the test of all blocks keeps as it is printed.
#[test]
fn every_command_has_its_page() {
    let text = |arguments: &[&str]| String::from_utf8(palmistry(arguments).stdout).expect("a text");
    let (commands, summary) = (chapter("commands.md"), chapter("SUMMARY.md"));
    let help = text(&["--help"]);
    let list = help.split("Commands:").nth(1).unwrap().split("Options:").next().unwrap();
    let names = list.lines().filter(|line| line.starts_with("  ") && !line.starts_with("   "));
    let names: Vec<&str> = names.filter_map(|line| line.split_whitespace().next()).collect();
    assert!(names.len() > 12, "{names:?}");
    for name in names.into_iter().filter(|name| *name != "help") {
        let file = format!("commands/{name}.md");
        for (list, link) in
            [(&commands, format!("]({file}) |")), (&summary, format!("  - [`{name}`]({file})"))]
        {
            assert_eq!(list.matches(&link).count(), 1, "'{name}' is listed once");
        }
        let help = format!("$ palmistry {name} --help");
        let page = chapter(&file);
        let shown = blocks(&page).into_iter().filter(|block| block.text.lines().next() == Some(&help));
        let all = shown.map(|block| block.text).collect::<String>();
        assert!(all.lines().count() > 3 && !all.lines().any(|line| line == "..."), "{file}: {all}");
        for old in
            ["almost all states", "not seen", " readings", "told apart", "sought", "is told", "are told"]
        {
            assert!(!all.contains(old), "'{name} --help' says '{old}'");
        }
    }
}

/// The fields of each object, first level, stand in the part on its command.
#[test]
fn every_field_of_the_json_is_named() {
    let folder = folder();
    let text = "system \"small\"\nstate x, y\ndrift f\n  x' = y\n  y' = -x + x^2\noutput x\nsample x in [1/2, 1] y in [1/2, 1]\n\
                claim 1: L(f, x) = y\n";
    let file = write(&folder, "small.proof", text);
    let file = file.to_str().unwrap();
    let [verdicts, paper, out] =
        ["v.json", "paper", "out"].map(|name| folder.path().join(name).display().to_string());
    let chapter = chapter("json.md");
    let begin = chapter.split_once("\n## ").expect("parts").0;
    let runs: [&[&str]; 19] = [
        &["prove", file, "--verdicts", &verdicts],
        &["recheck", &verdicts],
        &["rank", file, "--samples", "20", "--digits", "5"],
        &["rank", file, "--singular-set"],
        &["eval", file, "x", "--at", "x=1", "--latex"],
        &["certify", file, "--boxes", "20"],
        &["trade", file, "--samples", "20"],
        &["stress", file, "--samples", "20", "--states", "1"],
        &["observe", "proofs/moll2002/scenes/section_4_6.toml"],
        &["advise", "proofs/moll2002/scenes/general.toml", "--trials", "4"],
        &["poses", "--shape", "ellipse:1.2,1", "--grid", "6", "--levels", "1"],
        &["poses", "--bodies", "1", "--family", "splines", "--margins", "0.3"],
        &["verify", file, "--out", &out],
        &["check", file],
        &["fmt", file],
        &["import", "tests/imports/latent.py"],
        &["import", "tests/petab/0001/_0001.yaml"],
        &["observe", "examples/experiments/vessels.toml"],
        &["new", &paper],
    ];
    for run in runs {
        let found = json(&palmistry(&[run, &["--json"]].concat()));
        assert_eq!(found["version"], 4, "{run:?}");
        let part = chapter
            .split("\n## ")
            .find(|part| part.lines().next().is_some_and(|title| title.contains(&format!("`{}`", run[0]))))
            .unwrap_or_else(|| panic!("no part on {}", run[0]));
        for field in found.as_object().expect("an object").keys() {
            let named = |text: &str| text.contains(&format!("`{field}`"));
            assert!(named(part) || named(begin), "{}: '{field}' is not told", run[0]);
        }
    }
}

/// The fields of the lists that the chapter takes apart: of each kind of claim, of a witness, of what is wrong with a file.
#[test]
fn every_field_of_a_claim_is_named() {
    let folder = folder();
    let text = "system \"s\"\nstate x\nparam k = 2\ndrift f\n  x' = -k*x\noutput x\nlet a = k*x\nclaim 1: L(f, x) = -a \"why\"\n\
                claim 2: x = 2*x\nclaim 3: [x; k] = [x; 2]\nclaim 4 restates 1: L(f, x) = -k*x\nclaim 5: rank = 1\n\
                erratum 6: printed \"x\" as x = k*x/2 + 1 corrected x = x + 0\nerratum 7: printed k = 2 corrected k = k + 0\n\
                convention 8 follows 6: printed x = 1 + x meant x = x + 0\ndefinition 9: \"words\"\nundecided 10: \"open\"\n";
    let file = write(&folder, "a.proof", text);
    let verdicts = folder.path().join("v.json").display().to_string();
    let found =
        json(&palmistry(&["prove", file.to_str().unwrap(), "--json", "--latex", "--verdicts", &verdicts]));
    let checked = json(&palmistry(&["recheck", &verdicts, "--json"]));
    let bad = write(&folder, "bad.proof", "system \"s\"\nstate x\nclaim 1: y = x\n");
    let wrong = json(&palmistry(&["check", bad.to_str().unwrap(), "--json"]));
    let chapter = chapter("json.md");
    let claims = found["claims"].as_array().unwrap_or_else(|| panic!("{found}"));
    assert_eq!(claims.len(), 10, "{found}");
    let mut missing = BTreeSet::new();
    let mut look = |title: &str, list: &[&serde_json::Value]| {
        let part = chapter.split("\n## ").find(|part| part.starts_with(title)).expect("a part");
        let fields = list.iter().flat_map(|one| one.as_object().expect("an object").keys());
        missing.extend(fields.filter(|field| !part.contains(&format!("`{field}`"))).cloned());
        list.len()
    };
    look("`prove`", &claims.iter().collect::<Vec<_>>());
    for inner in ["witness", "printed", "corrected", "at_the_files_values"] {
        let list: Vec<_> = claims.iter().map(|claim| &claim[inner]).filter(|one| one.is_object()).collect();
        assert!(look("`prove`", &list) > 0, "no {inner} in {found}");
    }
    assert!(look("`recheck`", &checked["verdicts"].as_array().unwrap().iter().collect::<Vec<_>>()) > 5);
    assert_eq!(look("`check`", &wrong["errors"].as_array().unwrap().iter().collect::<Vec<_>>()), 1);
    assert!(missing.is_empty(), "{missing:?} are not told");
}

/// What the chapter on the library says that an example prints is what the example's head says, which CI holds to the output.
#[test]
fn the_example_prints_what_the_library_chapter_shows() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let example = std::fs::read_to_string(root.join("examples/pendulum.rs")).expect("an example");
    let head: Vec<&str> = example
        .lines()
        .skip_while(|line| *line != "//! ```text")
        .skip(1)
        .take_while(|line| *line != "//! ```")
        .map(|line| line.trim_start_matches("//!").trim())
        .collect();
    let chapter = chapter("library.md");
    let shown = blocks(&chapter).into_iter().find(|block| block.kind == "text").expect("what it prints").text;
    assert!(head.len() > 5, "{head:?}");
    assert_eq!(shown.lines().map(str::trim).collect::<Vec<_>>(), head);
}

/// Each file of tests stands in the map of them, by itself or with its folder.
#[test]
fn every_test_file_is_on_the_map() {
    let map = chapter("tests.md");
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let names = |folder: &str| -> Vec<String> {
        let entries = std::fs::read_dir(root.join(folder)).expect("a folder");
        entries
            .map(|entry| format!("{folder}/{}", entry.expect("an entry").file_name().to_string_lossy()))
            .collect()
    };
    let told = |path: &str| map.contains(&format!("`{path}`")) || map.contains(&format!("`{path}/`"));
    let helpers = ["tests/common", "tests/corpus"];
    let mut missing = Vec::new();
    for group in names("tests").into_iter().filter(|path| !helpers.contains(&path.as_str()) && !told(path)) {
        let files = names(&group)
            .into_iter()
            .filter(|path| !path.ends_with("/main.rs") && !path.ends_with("/snapshots"));
        missing.extend(files.filter(|path| !told(path)));
    }
    assert!(missing.is_empty(), "{missing:?} on no map");
    // and what the map names is there
    let named = map.split('`').filter(|word| word.starts_with("tests/"));
    let gone: Vec<&str> = named.filter(|path| !root.join(path).exists()).collect();
    assert!(gone.is_empty(), "{gone:?} are gone");
}

/// What the book names of the program's text is there, and a length in lines, rounded to tens, is right to a tenth: a file that has
/// moved, or has grown, is not where a reader should look for what has to be trusted.
#[test]
fn files_of_the_program_are_where_the_book_says() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let pages = std::fs::read_dir(root.join("book/src")).expect("the book");
    let pages = pages.map(|entry| entry.expect("an entry").path());
    // what is published has the other crates beside it and not in it
    let is_workspace = root.join("crates").exists();
    let (mut wrong, mut lengths) = (Vec::new(), 0);
    for page in pages.filter(|path| path.extension().is_some_and(|ending| ending == "md")) {
        let text = std::fs::read_to_string(&page).expect("a page");
        let pieces: Vec<&str> = text.split('`').collect();
        for pair in pieces.windows(2) {
            let [path, after] = pair else { continue };
            let is_path = (path.starts_with("src/") || path.starts_with("crates/") && is_workspace)
                && path.chars().all(|c| c.is_ascii_alphanumeric() || "/_.-".contains(c));
            if !is_path {
                continue;
            }
            if !root.join(path).exists() {
                wrong.push(format!("{}: '{path}' is not there", page.display()));
                continue;
            }
            let Some((digits, _)) = after.strip_prefix(" (").and_then(|rest| rest.split_once(')')) else {
                continue;
            };
            let Ok(said) = digits.parse::<usize>() else { continue };
            lengths += 1;
            let found = lines_without_tests(&root.join(path));
            if said.abs_diff(found) > 10 + found / 10 {
                wrong.push(format!("{}: '{path}' has {found} lines, not {said}", page.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(lengths > 30 || !is_workspace, "{lengths} lengths were read");
}

/// The lines of a file before its tests, or of all files of a folder that are no tests.
pub fn lines_without_tests(path: &std::path::Path) -> usize {
    if path.is_dir() {
        let entries = std::fs::read_dir(path).expect("a folder").map(|entry| entry.expect("an entry").path());
        let is_source = |inner: &std::path::PathBuf| {
            let is_test = inner.file_stem().is_some_and(|name| name == "tests");
            !is_test && (inner.is_dir() || inner.extension().is_some_and(|ending| ending == "rs"))
        };
        return entries.filter(is_source).map(|inner| lines_without_tests(&inner)).sum();
    }
    let text = std::fs::read_to_string(path).expect("a file");
    text.lines().take_while(|line| !line.starts_with("#[cfg(test)]")).count()
}

/// Each chapter stands in the summary, each link leads somewhere, and the README stays short.
#[test]
fn links_lead_somewhere() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let summary = chapter("SUMMARY.md");
    for path in crate::pages::pages() {
        let text = std::fs::read_to_string(&path).expect("a page");
        let name = path.file_name().expect("a name").to_string_lossy();
        if let Ok(chapter) = path.strip_prefix(root.join("book/src"))
            && name != "SUMMARY.md"
        {
            assert!(summary.contains(&format!("({})", chapter.display())), "{name} is in no summary");
        }
        let folder = path.parent().expect("a folder");
        for link in text.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
            let (file, place) = link.split_once('#').unwrap_or((link, ""));
            if file.starts_with("http") {
                continue;
            }
            let target = if file.is_empty() { path.clone() } else { folder.join(file) };
            // a package goes without most of the reports
            let packed = !root.join(".ci").exists() && file.contains("reports/");
            assert!(packed || target.exists(), "{name}: {link} leads nowhere");
            if !place.is_empty() {
                let to = std::fs::read_to_string(&target).expect("a page");
                let headings = to.lines().filter_map(|line| line.strip_prefix('#'));
                let anchors: Vec<String> = headings.map(anchor).collect();
                assert!(anchors.iter().any(|anchor| anchor == place), "{name}: no {place} among {anchors:?}");
            }
        }
    }
    let length = std::fs::metadata(root.join("README.md")).expect("a README").len();
    assert!(length < 8000, "the README has {length} bytes");
}

/// The pages that say which compiler is needed name the one of the manifest.
#[test]
fn the_compiler_is_that_of_the_manifest() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let manifest = std::fs::read_to_string(root.join("Cargo.toml")).expect("a manifest");
    let (_, rest) = manifest.split_once("rust-version = \"").expect("a version");
    let version = rest.split('"').next().expect("its end");
    for (page, words) in
        [("README.md", "You need Rust {}"), ("book/src/introduction.md", "A Rust toolchain ({} or newer)")]
    {
        let text = std::fs::read_to_string(root.join(page)).expect("a page");
        let words = words.replace("{}", version);
        assert!(text.contains(&words), "{page} does not say '{words}'");
    }
    for path in crate::pages::pages() {
        let text = std::fs::read_to_string(&path).expect("a page");
        let parts: Vec<&str> = text.split(" or newer").collect();
        for before in &parts[..parts.len() - 1] {
            let named = before.rsplit([' ', '(']).next().expect("a word");
            let is_rust = before.lines().last().is_some_and(|line| line.contains("Rust"));
            assert!(
                !is_rust || named == version,
                "{}: Rust {named}, and {version} is needed",
                path.display()
            );
        }
    }
}

/// What a heading is called in a link.
fn anchor(heading: &str) -> String {
    let words = heading.trim_start_matches('#').trim().to_lowercase();
    let kept = words.chars().filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
    kept.map(|c| if c == ' ' { '-' } else { c }).collect()
}

/// The index of errors is what `explain` prints from, and every code has a wrong and a right example in it, which are run with the page.
#[test]
fn the_index_of_errors_is_the_programs_own() {
    let source = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("crates/lang/src/errors.md");
    let own = std::fs::read_to_string(source).expect("the page");
    assert_eq!(chapter("errors.md"), own, "book/src/errors.md is a copy of crates/lang/src/errors.md");
    for (code, id) in palmistry::system::Code::ALL {
        let examples = blocks(code.page());
        let [wrong, right] = examples.as_slice() else { panic!("{id}: {} examples", examples.len()) };
        assert_eq!(wrong.value("refused"), Some(id));
        assert_eq!(right.value("refused"), None, "{id}");
    }
    let found = json(&palmistry(&["explain", "--json"]));
    assert_eq!(found["errors"].as_array().unwrap().len(), palmistry::system::Code::ALL.len());
    assert!(String::from_utf8_lossy(&palmistry(&["explain", "e201"]).stdout).contains("not known"));
    assert_eq!(palmistry(&["explain", "E999"]).status.code(), Some(2));
}
