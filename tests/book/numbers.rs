//! Numbers in the sentences and tables of the pages, held to what the program says.
//!
//! Below a paragraph or a table stands a comment, which no reader of the book sees:
//!
//! ```text
//! <!-- held: palmistry rank model.proof --samples 100 --json
//! of rank [16] in 40 unknowns = .generic.rank
//! certified at 100 of 100
//! -->
//! ```
//!
//! The first line has a command, which runs beside the files that the page shows above it. Each further line has words of the
//! paragraph and, behind a sign, what they are compared with. The words have to stand in the paragraph; their first number, or the
//! one in brackets, is compared. Signs: `=` (equal, as rounded on the page), `~` (within a factor of two), `>` and `<` (the page's
//! number is above or below). Behind the sign stands
//!
//! - `.a[0].b`, a place in JSON. `.list[key=value]` (or `!=`) are those elements, `.*` is each value of an object. A list counts by
//!   its length; `max`, `min` or `sum` may stand before the place;
//! - a text of the output with `{}` where it has the number, or with several for all numbers of the words; between blanks `...` stands
//!   for any words and `#` for one;
//! - a text without `{}`, which the output has to contain. Without a sign the output contains the words of the page.
//!
//! `* 1e3` or `/ 2^20` behind a number changes its unit.
//!
//! `held: source` compares with the source instead: `NAME in FILE` (a constant, or the length of a table), `text {} in FILE`,
//! `lines in FILES` (without tests; right to a tenth), `files in FOLDER/*.ending`.
//! `held, row by row:` (or `rows 2 to 5`) is about each row of the nearest table above, and `{title}` is its cell below that title.
//! `held on request:` is for what takes long: `cargo test --release --test book -- --ignored`.
//! `held: kept NAME` compares with an output that is kept in `reports/kept` (`kept.rs`), of a command that takes minutes.
//! What else a comment may say of numbers, and that each table says something, is in `sources.rs`.

use crate::blocks::blocks;
use crate::common::folder;
use crate::kept;
use crate::pages::pages;
use crate::values::{Number, Value, all_numbers, collapsed, in_output, in_source, numbers_of};
use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;
use std::sync::Mutex;

/// What holds numbers of the README, which has no room for comments: words of a paragraph, and the comment.
const README: [(&str, &str); 1] = [(
    "with their published answers as claims",
    "held: source\n[Four] papers = const PAPERS: [&str; {}] in tests/book/gallery.rs\n\
     forty models = files in proofs/benchmarks/*.proof",
)];

/// A comment with what stands above it.
struct Held {
    /// The page and the line.
    place: String,
    /// The files that the page shows above.
    files: Vec<(String, String)>,
    on_request: bool,
    /// A command, or nothing where the source or a kept output is asked.
    command: Option<String>,
    /// The name of a kept output.
    kept: Option<String>,
    claims: Vec<Claim>,
}

/// Words of the page, and what they are compared with.
struct Claim {
    place: String,
    words: String,
    sign: char,
    what: String,
}

/// What a command printed.
#[derive(Clone)]
pub struct Output {
    pub stdout: String,
    pub all: String,
}

pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The lines above a comment that belong together, without other such comments.
fn paragraph(lines: &[&str]) -> Vec<String> {
    let mut above: Vec<String> = Vec::new();
    let mut in_comment = false;
    for line in lines.iter().rev().map(|line| line.trim()) {
        // read upwards, a comment begins with its end
        if line.ends_with("-->") {
            if !above.is_empty() {
                break;
            }
            in_comment = true;
        }
        if in_comment {
            in_comment = !line.starts_with("<!--");
            continue;
        }
        match line.is_empty() {
            true if above.is_empty() => {}
            true => break,
            false => above.push(line.to_owned()),
        }
    }
    above.reverse();
    above
}

/// The lines of the nearest table above.
pub fn table(lines: &[&str]) -> Vec<String> {
    let is_row = |line: &&&str| line.starts_with('|');
    let above = lines.iter().rev().skip_while(|line| !is_row(line)).take_while(is_row);
    let mut above: Vec<String> = above.map(|line| (*line).to_owned()).collect();
    above.reverse();
    above
}

/// The cells of a row.
pub fn cells(row: &str) -> Vec<String> {
    row.trim().trim_matches('|').split('|').map(|cell| cell.trim().to_owned()).collect()
}

/// The rows of a table that a comment is about, as titles with cells.
fn rows(above: &[String], which: &str) -> Result<Vec<Vec<(String, String)>>, String> {
    if above.len() < 3 || !above.iter().all(|line| line.starts_with('|')) {
        return Err("no table stands above".to_owned());
    }
    let titles: Vec<String> = cells(&above[0]);
    let all: Vec<Vec<(String, String)>> =
        above[2..].iter().map(|row| titles.iter().cloned().zip(cells(row)).collect()).collect();
    if which == "row by row" {
        return Ok(all);
    }
    let ends = which.strip_prefix("rows ").and_then(|rest| rest.split_once(" to "));
    let ends = ends.and_then(|(from, to)| Some((from.parse::<usize>().ok()?, to.parse::<usize>().ok()?)));
    match ends {
        Some((from, to)) if 0 < from && from <= to && to <= all.len() => Ok(all[from - 1..to].to_vec()),
        _ => Err(format!("'{which}' is neither 'row by row' nor 'rows 1 to {}'", all.len())),
    }
}

/// A text with the cells of a row in the place of their titles; of a cell with code, each piece of code.
fn filled(text: &str, row: &[(String, String)]) -> String {
    let mut text = text.to_owned();
    for (title, cell) in row {
        let place = format!("{{{title}}}");
        if !text.contains(&place) {
            continue;
        }
        let code: Vec<&str> = cell.split('`').skip(1).step_by(2).collect();
        // `lines in folder/{file}` of several files
        text = match code.is_empty() {
            true => text.replace(&place, cell),
            false => {
                let words = text.split(' ').flat_map(|word| match word.contains(&place) {
                    true => code.iter().map(|piece| word.replace(&place, piece)).collect(),
                    false => vec![word.to_owned()],
                });
                words.collect::<Vec<_>>().join(" ")
            }
        };
    }
    text
}

/// Where a sign stands between blanks, outside of braces.
fn sign_of(text: &str) -> Option<(usize, char)> {
    let mut depth = 0;
    text.char_indices().find(|(at, c)| {
        depth += i32::from(*c == '{') - i32::from(*c == '}');
        let is_alone = text[..*at].ends_with(' ') && text[at + c.len_utf8()..].starts_with(' ');
        depth == 0 && is_alone && ['=', '~', '>', '<'].contains(c)
    })
}

/// A comment as it is written, without its marks.
fn read(
    place: (&str, usize),
    text: &str,
    above: &[String],
    files: &[(String, String)],
) -> Result<Vec<Held>, String> {
    let mut lines = (place.1..).zip(text.lines());
    let head = lines.next().map_or("", |(_, line)| line);
    let (how, source) = head.split_once(':').ok_or("no ':' behind 'held'")?;
    let mut source = source.trim().to_owned();
    while let Some(begin) = source.strip_suffix('\\') {
        source = format!("{begin}{}", lines.next().ok_or("the command does not end")?.1.trim());
    }
    let (how, which) = how.split_once(", ").map_or((how, None), |(how, which)| (how, Some(which)));
    let on_request = match how {
        "held" => false,
        "held on request" => true,
        _ => return Err(format!("'{how}' is neither 'held' nor 'held on request'")),
    };
    let claims: Vec<(usize, &str)> =
        lines.map(|(line, text)| (line, text.trim())).filter(|(_, text)| !text.is_empty()).collect();
    if source.is_empty() || claims.is_empty() {
        return Err("it holds nothing: 'held: COMMAND', then a line for each number".to_owned());
    }
    let rows = which.map(|which| rows(above, which)).transpose()?;
    let is_by_rows = rows.is_some();
    let whole = collapsed(&above.join(" "));
    let mut found = Vec::new();
    for row in rows.unwrap_or_else(|| vec![Vec::new()]) {
        let mut own = Vec::new();
        for (line, text) in &claims {
            let split = sign_of(text);
            let (words, sign, what) = match split {
                Some((at, sign)) => (text[..at].trim(), sign, text[at + 1..].trim()),
                None => (*text, '=', *text),
            };
            let words = filled(words, &row);
            // an empty cell is a nought
            let words = if words.is_empty() && is_by_rows { "0".to_owned() } else { words };
            let said = collapsed(&words.replace(['[', ']'], ""));
            if !is_by_rows && !whole.contains(&said) {
                return Err(format!("'{said}' does not stand above (line {line})"));
            }
            let what = filled(what, &row);
            own.push(Claim { place: format!("{}:{line}", place.0), words, sign, what });
        }
        found.push(Held {
            place: format!("{}:{}", place.0, place.1),
            files: files.to_vec(),
            on_request,
            command: (source != "source" && !source.starts_with("kept ")).then(|| filled(&source, &row)),
            kept: source.strip_prefix("kept ").map(|name| filled(name.trim(), &row)),
            claims: own,
        });
    }
    Ok(found)
}

/// The comments of a page, and what is wrong with their form.
fn comments(path: &Path, wrong: &mut Vec<String>) -> Vec<Held> {
    let text = std::fs::read_to_string(path).expect("a page");
    let name = path.strip_prefix(root()).expect("a page of the project").display().to_string();
    let lines: Vec<&str> = text.lines().collect();
    let blocks = blocks(&text);
    let shown = |line: usize| -> Vec<(String, String)> {
        let above = blocks.iter().filter(|block| block.line < line);
        above.filter_map(|block| Some((block.value("file")?.to_owned(), block.text.clone()))).collect()
    };
    let (mut found, mut at) = (Vec::new(), 0);
    while at < lines.len() {
        let begin = at;
        at += 1;
        let held = lines[begin].trim().strip_prefix("<!-- held");
        let Some(mut comment) =
            held.filter(|rest| !rest.starts_with(" elsewhere:")).map(|rest| format!("held{rest}"))
        else {
            continue;
        };
        while !comment.ends_with("-->") && at < lines.len() {
            comment.push_str(&format!("\n{}", lines[at].trim_end()));
            at += 1;
        }
        let is_by_rows = comment.starts_with("held, row") || comment.starts_with("held on request, row");
        let above = if is_by_rows { table(&lines[..begin]) } else { paragraph(&lines[..begin]) };
        let comment = comment.trim_end_matches("-->").trim_end();
        match read((&name, begin + 1), comment, &above, &shown(begin)) {
            Ok(held) => found.extend(held),
            Err(why) => wrong.push(format!("{name}:{}: {why}", begin + 1)),
        }
    }
    if name == "README.md" {
        for (words, comment) in README {
            let line = lines.iter().position(|line| line.contains(words)).unwrap_or(0);
            let end = lines[line..].iter().position(|line| line.is_empty()).map_or(lines.len(), |n| line + n);
            match read((&name, line + 1), comment, &paragraph(&lines[..end]), &shown(line)) {
                Ok(held) => found.extend(held),
                Err(why) => wrong.push(format!("{name}:{}: {why}", line + 1)),
            }
        }
    }
    found
}

/// Runs a command where the files of its page are.
fn run(held: &Held, command: &str) -> Output {
    let folder = folder();
    for name in ["proofs", "examples", "tests", "python", "benches", "book"] {
        std::os::unix::fs::symlink(root().join(name), folder.path().join(name)).expect("a link");
    }
    for (name, text) in &held.files {
        let path = folder.path().join(name);
        // what a page shows below one of these folders is there
        if ["proofs/", "examples/", "tests/"].iter().any(|begin| name.starts_with(begin)) {
            continue;
        }
        std::fs::create_dir_all(path.parent().expect("a folder")).expect("a folder is made");
        std::fs::write(path, text).expect("a file is written");
    }
    let program = Path::new(env!("CARGO_BIN_EXE_palmistry"));
    let mut path = program.parent().expect("a folder").as_os_str().to_owned();
    path.push(":");
    path.push(std::env::var_os("PATH").unwrap_or_default());
    let output = Command::new("bash")
        .args(["-c", command])
        .current_dir(folder.path())
        .env("PATH", path)
        .env("PYTHONPATH", root().join("python"))
        .envs([("LANG", "C.UTF-8"), ("NO_COLOR", "1")])
        .env_remove("COLUMNS")
        .output()
        .expect("there is a bash");
    let [stdout, stderr] =
        [output.stdout, output.stderr].map(|text| String::from_utf8(text).expect("a text"));
    Output { all: collapsed(&format!("{stdout}\n{stderr}")), stdout }
}

/// Why a claim is false, if it is.
fn judge(claim: &Claim, output: Option<&Output>) -> Result<(), String> {
    let value = match output {
        Some(output) => in_output(&claim.what, claim.words == claim.what, output)?,
        None => in_source(root(), &claim.what)?,
    };
    let value = match value {
        Value::Number(value) => value,
        Value::Text => return Ok(()),
        Value::Numbers(values) => {
            let said = all_numbers(&claim.words.replace(['[', ']'], ""));
            let is_so = said.len() == values.len()
                && said.iter().zip(&values).all(|(said, value)| said.compares(claim.sign, *value));
            let why =
                || format!("the page says '{}', and these are {values:?} ({})", claim.words, claim.what);
            return is_so.then_some(()).ok_or_else(why);
        }
    };
    let Some(said) = Number::of(&claim.words) else {
        return Err(format!("'{}' has no number", claim.words));
    };
    // lengths of files are rounded to tens
    let is_length = output.is_none() && claim.what.starts_with("lines in") && claim.sign == '=';
    let is_so = match is_length {
        true => (said.value - value).abs() <= 10.0 + value / 10.0,
        false => said.compares(claim.sign, value),
    };
    match is_so {
        true => Ok(()),
        false => {
            let sign = claim.sign;
            Err(format!(
                "the page says '{}': {} {sign} {value} is not so ({})",
                claim.words, said.value, claim.what
            ))
        }
    }
}

fn hold(on_request: bool) {
    let mut wrong = Vec::new();
    let all: Vec<Held> = pages().iter().flat_map(|path| comments(path, &mut wrong)).collect();
    let asked: Vec<&Held> = all.iter().filter(|held| held.on_request == on_request).collect();
    let key = |held: &Held| Some((held.command.clone()?, held.files.clone()));
    let mut commands: BTreeMap<_, &Held> = BTreeMap::new();
    for held in &asked {
        if let Some(key) = key(held) {
            commands.entry(key).or_insert(held);
        }
    }
    let waiting = Mutex::new(commands.into_iter().collect::<Vec<_>>());
    let done = Mutex::new(BTreeMap::new());
    let threads = std::thread::available_parallelism().map_or(2, std::num::NonZero::get);
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                loop {
                    let next = waiting.lock().expect("a list").pop();
                    let Some((key, held)) = next else { break };
                    let begin = std::time::Instant::now();
                    let output = run(held, &key.0);
                    println!("{:6.1} s  {}: {}", begin.elapsed().as_secs_f64(), held.place, key.0);
                    done.lock().expect("a map").insert(key, output);
                }
            });
        }
    });
    let done = done.into_inner().expect("a map");
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for held in &asked {
        let kept = match held.kept.as_deref().map(kept::output) {
            Some(Ok(None)) => continue,
            Some(Err(why)) => {
                wrong.push(format!("{}: {why}", held.place));
                continue;
            }
            Some(Ok(output)) => output,
            None => None,
        };
        let output = key(held).map(|key| &done[&key]).or(kept.as_ref());
        for claim in &held.claims {
            let kind = match &held.command {
                Some(_) => "of commands",
                None if held.kept.is_some() => "of kept outputs",
                None if claim.what.starts_with("lines ") || claim.what.starts_with("files ") => "of files",
                None if claim.what.contains("{}") => "of texts in the source",
                None => "constants",
            };
            *counts.entry(kind).or_default() += numbers_of(&claim.words).max(1);
            if let Err(why) = judge(claim, output) {
                let by = held.command.as_deref().or(held.kept.as_deref());
                let command = by.unwrap_or("the source");
                wrong.push(format!("{}: {why}\n    by: {command}", claim.place));
            }
        }
    }
    println!("numbers that are held: {counts:?}");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(on_request || counts.values().sum::<usize>() > 100, "{counts:?}");
}

#[test]
fn numbers_in_sentences_and_tables_are_those_of_the_program() {
    hold(false);
}

#[test]
#[ignore = "takes minutes"]
fn numbers_that_take_long_are_those_of_the_program() {
    hold(true);
}

/// A comment that is false, or about nothing, is found, with its place.
#[test]
fn what_is_false_is_said() {
    let said = |above: &str, comment: &str| -> Result<(), String> {
        let above: Vec<String> = above.lines().map(str::to_owned).collect();
        let held = read(("page.md", 7), comment, &above, &[])?;
        let output = Output {
            stdout: "{\"rank\": 16, \"of\": [{\"a\": 1.26e-3}, {\"a\": 2}], \"at\": [{\"is\": [0.5, 1], \"b\": {\"x\": 7, \"y\": 3}}]}"
                .to_owned(),
            all: "rank 16 of 40, at 7 states".to_owned(),
        };
        for claim in held.iter().flat_map(|held| &held.claims) {
            judge(claim, held[0].command.as_ref().map(|_| &output))
                .map_err(|why| format!("{}: {why}", claim.place))?;
        }
        Ok(())
    };
    let text = "The rank is 16 of forty,\nat seven states; 1.3 mm.";
    for right in [
        "held: x\n16 of forty = rank {} of 40",
        "held: x\nrank is 16 = .rank",
        "held: x\n1.3 mm = .of[0].a * 1e3",
        "held: x\n1.3 mm = min .of.a * 1e3",
        "held: x\nseven = max .at[is=[0.5, 1]].b.*\nseven = .at[is=[0.5, 1]].b.x\nseven > .at[is!=[0, 1]]",
        "held: x\nof [forty], at seven = of {},",
        "held: x\nforty, at [seven] = at {} states\n16 < of {},",
        "held: x\nThe rank = rank 16 of",
        "held: x\n16 of forty, at seven = rank {} of {}, at {} states",
        "held: x\nof forty, at seven = rank # of {}, ... {} states",
    ] {
        assert_eq!(said(text, right), Ok(()), "{right}");
    }
    for (wrong, why) in [
        ("held: x\nrank is 17 = .rank", "'rank is 17' does not stand above"),
        ("held: x\nof forty = .rank", "page.md:8: the page says 'of forty': 40 = 16 is not so"),
        ("held: x\n1.3 = .of[1].a", "1.3 = 2 is not so"),
        ("held: x\n16 = .range", "no place '.range'"),
        ("held: x\n16 of forty", "the output does not contain '16 of forty'"),
        ("held: x\n16 = range {}", "the output does not contain 'range {}'"),
        ("held: x\n16 of forty = rank # ... {} at {}", "the output does not contain"),
        ("held: x\nat seven = of {}, at {} states", "the page says 'at seven', and these are [40.0, 7.0]"),
        ("held: x\n", "it holds nothing"),
        ("held by x\n16", "no ':'"),
        ("held, row by row: x\n{a} = .rank", "no table"),
        ("held: source\n16 = NOTHING in tests/book/main.rs", "no constant 'NOTHING'"),
        ("held: source\n16 = NOT_RUN in tests/book/none.rs", "tests/book/none.rs"),
    ] {
        let found = said(text, wrong).expect_err(wrong);
        assert!(found.contains(why), "{wrong}: {found}");
    }
    let table = "| file | rank |\n|---|---|\n| `a.rs`, `b.rs` | 16 |\n| c | 17 |";
    assert_eq!(said(table, "held, rows 1 to 1: x\n{rank} = .rank"), Ok(()));
    assert!(said(table, "held, row by row: x\n{rank} = .rank").expect_err("17").contains("17 = 16"));
    assert!(said(table, "held, rows 2 to 3: x\n{rank} = .rank").is_err());
    assert_eq!(filled("lines in x/{file} y", &[("file".into(), "`a`, `b`".into())]), "lines in x/a x/b y");
}
