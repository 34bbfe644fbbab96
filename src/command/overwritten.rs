//! Files that a command would write over what it reads: measurements cannot be had again. It is refused before anything is done.

use super::given_files::Given;
use super::output::proof_files;
use super::{Unusable, Verb};
use miette::Report;
use palmistry::file::read_text;
use palmistry::foreign::shown_path;
use palmistry::system::Code;
use std::collections::{BTreeSet, VecDeque};
use std::path::{Path, PathBuf};

/// A text of more bytes than this is not looked through for names: no scene and no proof file is as long.
const LONGEST_TEXT: u64 = 16 << 20;

/// Longer pieces of a text name no file.
const LONGEST_NAME: usize = 1024;

/// The ends of names of files that name other files.
const NAMING: [&str; 4] = ["toml", "proof", "yaml", "yml"];

/// What files `--out` makes in its folder, of all commands together; pictures and theorems are never read.
const IN_FOLDERS: [&str; 11] = [
    "index.html",
    "observe.json",
    "simulation.tsv",
    "parameters.tsv",
    "verify.json",
    "errata.md",
    "drops.json",
    "certify.json",
    "trade.json",
    "stress.json",
    "poses.json",
];

/// A file that is to be written, and the option that names it.
struct Output {
    option: &'static str,
    path: PathBuf,
}

/// A file that is read, and the option that writes it anew, where that is what the option is for.
struct Input {
    path: PathBuf,
    renewed_by: Option<&'static str>,
}

impl Input {
    fn read(path: impl Into<PathBuf>) -> Input {
        Input { path: path.into(), renewed_by: None }
    }
}

/// Refuses a command line by which a file is written that is read as well.
///
/// # Errors
/// The first such file.
pub(super) fn refuse(verb: &Verb) -> miette::Result<()> {
    // what is not there yet is no input, so that usually nothing is looked through; a device or a pipe is no file
    let outputs: Vec<Output> = outputs(verb).into_iter().filter(|output| output.path.is_file()).collect();
    if outputs.is_empty() {
        return Ok(());
    }
    let inputs = inputs(verb);
    let found = outputs.iter().find_map(|output| {
        let is_lost =
            |input: &&Input| input.renewed_by != Some(output.option) && is_same(&output.path, &input.path);
        inputs.iter().find(is_lost).map(|input| refusal(output, input))
    });
    found.map_or(Ok(()), Err)
}

fn refusal(output: &Output, input: &Input) -> Report {
    let (written, read) = (shown_path(&output.path), shown_path(&input.path));
    let also = if written == read { String::new() } else { format!(", which is {read}") };
    Unusable::report(
        Code::Option,
        format!("{} would overwrite {written}{also}: this command reads it", output.option),
        "write to another file, or copy this one first: what it holds would be lost",
    )
}

/// Whether two paths lead to one file on the disk: also by links, and where a file has several names.
fn is_same(one: &Path, other: &Path) -> bool {
    let (Ok(known), Ok(known_too)) = (std::fs::metadata(one), std::fs::metadata(other)) else { return false };
    if !(known.is_file() && known_too.is_file()) {
        return false;
    }
    let paths = || one.canonicalize().ok().zip(other.canonicalize().ok());
    is_one_on_the_disk(&known, &known_too) || paths().is_some_and(|(one, other)| one == other)
}

#[cfg(unix)]
fn is_one_on_the_disk(one: &std::fs::Metadata, other: &std::fs::Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    (one.dev(), one.ino()) == (other.dev(), other.ino())
}

/// Elsewhere the paths have to tell.
#[cfg(not(unix))]
fn is_one_on_the_disk(_: &std::fs::Metadata, _: &std::fs::Metadata) -> bool {
    false
}

/// The files that a command is to write. What `fmt` brings into its form is meant to be written over, and what `new`, `demo`, `man` and
/// `lab` write they have not read.
fn outputs(verb: &Verb) -> Vec<Output> {
    let files: Vec<(&'static str, Option<&PathBuf>)> = match verb {
        Verb::Prove(verb) => {
            vec![("--junit", verb.claims.junit.as_ref()), ("--verdicts", verb.claims.verdicts.as_ref())]
        }
        Verb::Rank(verb) => vec![
            ("--verdicts", verb.verdicts.as_ref()),
            ("--reparametrise", verb.reparametrise.as_ref()),
            ("--table", verb.table.as_ref()),
        ],
        Verb::Reduce(verb) => vec![("--out", verb.out.as_ref())],
        Verb::Certify(verb) => vec![
            ("--state", verb.state.as_ref()),
            ("--merged", verb.merged.as_ref()),
            ("--verdicts", verb.verdicts.as_ref()),
        ],
        Verb::Observe(verb) => vec![
            ("--record", verb.record.as_ref()),
            ("--motion", verb.motion.as_ref()),
            ("--outline", verb.outline.as_ref()),
            ("--track", verb.track.as_ref()),
        ],
        Verb::Plan(verb) => vec![("--out", verb.out.as_ref())],
        _ => Vec::new(),
    };
    let folder: Option<&PathBuf> = match verb {
        Verb::Verify(verb) => Some(&verb.out),
        Verb::Rank(verb) => verb.out.as_ref(),
        Verb::Certify(verb) => verb.out.as_ref(),
        Verb::Trade(verb) => verb.out.as_ref(),
        Verb::Stress(verb) => verb.out.as_ref(),
        Verb::Observe(verb) => verb.out.as_ref(),
        Verb::Poses(verb) => verb.out.as_ref(),
        _ => None,
    };
    let imported: Vec<PathBuf> = match verb {
        Verb::Import(verb) => verb.written(),
        _ => Vec::new(),
    };
    let named = files.into_iter().filter_map(|(option, path)| Some((option, path?.clone())));
    let inside = folder.into_iter().flat_map(|folder| IN_FOLDERS.iter().map(|name| folder.join(name)));
    named
        .chain(inside.chain(imported).map(|path| ("--out", path)))
        .filter(|(_, path)| path.as_os_str() != "-")
        .map(|(option, path)| Output { option, path })
        .collect()
}

/// The files that a command reads: those of the command line, and all that they name.
fn inputs(verb: &Verb) -> Vec<Input> {
    let mut read: Vec<Input> = Vec::new();
    for Given { path, .. } in verb.given() {
        if path.is_dir() {
            // what is wrong with the folder is said by who reads it
            let files = proof_files(&[path.to_owned()]).unwrap_or_default();
            read.extend(files.into_iter().chain([path.join("paper.toml")]).map(Input::read));
        } else {
            read.push(Input::read(path));
        }
    }
    let mut waiting: VecDeque<PathBuf> = read.iter().map(|input| input.path.clone()).collect();
    let mut seen = BTreeSet::new();
    while let Some(path) = waiting.pop_front() {
        if path.canonicalize().is_ok_and(|path| seen.insert(path)) {
            for named in named_files(&path) {
                waiting.push_back(named.clone());
                read.push(Input::read(named));
            }
        }
    }
    if let Verb::Certify(verb) = verb {
        let state = verb.state.iter();
        read.extend(state.map(|path| Input { path: path.clone(), renewed_by: Some("--state") }));
    }
    read
}

/// The files that a scene, a proof file or a problem names, each from its own folder. They are looked for in the text and not among its keys:
/// so a text that is not understood, which is said later, hides none of them.
fn named_files(path: &Path) -> Vec<PathBuf> {
    let end = path.extension().and_then(|end| end.to_str()).unwrap_or_default().to_ascii_lowercase();
    if !(NAMING.contains(&end.as_str()) && path.is_file()) {
        return Vec::new();
    }
    let Ok(text) = read_text(path, LONGEST_TEXT) else { return Vec::new() };
    let folder = path.parent().unwrap_or(Path::new(""));
    let names: BTreeSet<&str> =
        text.lines().map(without_comment).flat_map(|line| pieces(line, &end)).collect();
    names.into_iter().map(|name| folder.join(name)).filter(|file| file.is_file()).collect()
}

/// A line without the comment at its end, which may tell of any file.
fn without_comment(line: &str) -> &str {
    let line = line.trim_start();
    if line.starts_with('#') { "" } else { line.split(" #").next().unwrap_or(line) }
}

/// What stands between quotation marks of a line, of one kind or the other; YAML needs none. Every two neighbouring marks are taken for a pair:
/// an apostrophe on the way then hides nothing.
fn pieces<'t>(line: &'t str, end: &str) -> Vec<&'t str> {
    let within = |mark: char| -> Vec<&'t str> {
        let mut pieces: Vec<&str> = line.split(mark).skip(1).collect();
        pieces.pop();
        pieces
    };
    let quoted = within('"').into_iter().chain(within('\''));
    let bare = line.split([' ', '\t', ',', '[', ']', '{', '}']).filter(|_| end.starts_with('y'));
    quoted
        .chain(bare)
        .filter(|piece| !piece.trim().is_empty() && piece.len() <= LONGEST_NAME)
        .filter(|piece| !piece.contains('\0'))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_files_are_found_in_texts() {
        let folder = tempfile::tempdir().unwrap();
        let put = |name: &str, text: &str| {
            let path = folder.path().join(name);
            std::fs::write(&path, text).unwrap();
            path
        };
        for name in ["a.proof", "b.csv", "it's.csv", "c.tsv", "told.csv"] {
            put(name, "");
        }
        let scene = put(
            "s.toml",
            "model = 'a.proof' # of \"told.csv\"\n# \"told.csv\"\n[data]\nrecord = \"b.csv\"\nmore = [\"it's.csv\", \"no.csv\"]\n",
        );
        let names = |path: &Path| -> Vec<String> {
            let named = named_files(path).into_iter();
            named.map(|path| path.file_name().unwrap().to_str().unwrap().to_owned()).collect()
        };
        assert_eq!(names(&scene), ["a.proof", "b.csv", "it's.csv"]);
        let problem = put(
            "p.yaml",
            "problems:\n  - measurement_files: [c.tsv, no.tsv]\n    sbml_files:\n    - b.csv\n",
        );
        assert_eq!(names(&problem), ["b.csv", "c.tsv"]);
        // a table names nothing
        assert!(names(&put("d.csv", "\"b.csv\"")).is_empty());
    }

    #[test]
    fn one_file_under_several_names_is_one() {
        let folder = tempfile::tempdir().unwrap();
        let place = |name: &str| folder.path().join(name);
        std::fs::write(place("a"), "").unwrap();
        std::fs::write(place("b"), "").unwrap();
        std::fs::create_dir(place("c")).unwrap();
        assert!(is_same(&place("a"), &place("c/../a")));
        assert!(!is_same(&place("a"), &place("b")) && !is_same(&place("a"), &place("none")));
        #[cfg(unix)]
        {
            std::fs::hard_link(place("a"), place("hard")).unwrap();
            std::os::unix::fs::symlink(place("a"), place("soft")).unwrap();
            assert!(is_same(&place("hard"), &place("a")) && is_same(&place("soft"), &place("hard")));
            // what is no file is written through, and nothing of it is lost
            assert!(!is_same(Path::new("/dev/null"), Path::new("/dev/null")));
        }
    }
}
