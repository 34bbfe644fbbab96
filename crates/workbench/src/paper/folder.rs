//! `paper.toml` and the files beside it: what a paper is called, how it numbers its equations, which files in which order.

use super::numbering::Numbering;
use palmistry_io::file;
use palmistry_io::foreign::{name_of, shown_path};
use palmistry_lang::{Code, Problem, ReadError, System, load, nearest};
use serde::de::{MapAccess, Visitor};
use serde::{Deserialize, Deserializer};
use std::path::{Path, PathBuf};
use toml::Spanned;

/// The name of the file that describes a paper.
pub const MANIFEST: &str = "paper.toml";

/// A paper: a folder of proof files and scenes, or a single proof file.
#[derive(Clone, Debug, Default)]
pub struct Paper {
    /// Its title; that of the first system where the folder does not say.
    pub title: String,
    /// Its authors.
    pub authors: Vec<String>,
    /// The year in which it appeared.
    pub year: Option<i64>,
    /// Where it is published.
    pub source: Option<String>,
    /// Its numbered equations; none where the folder does not say.
    pub numbering: Numbering,
    /// The folder, relative to which files are named.
    pub folder: PathBuf,
    /// The proof files in their order.
    pub files: Vec<String>,
    /// The scenes to run.
    pub scenes: Vec<String>,
    /// The file of whose system speed is measured against accuracy; the first one that moves where nothing is said.
    pub trade: Option<String>,
    /// The file along whose first field Lie derivatives are followed to high orders; that of `trade` where nothing is said.
    pub derivatives: Option<String>,
}

/// The keys of `paper.toml`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Keys {
    #[serde(deserialize_with = "palmistry_io::foreign::read_line")]
    title: String,
    #[serde(default)]
    authors: Vec<Line>,
    year: Option<i64>,
    source: Option<Line>,
    equations: Option<Equations>,
    #[serde(default)]
    order: Vec<Spanned<String>>,
    #[serde(default)]
    scenes: Vec<Spanned<String>>,
    trade: Option<Spanned<String>>,
    derivatives: Option<Spanned<String>>,
}

/// A text that is shown as a line.
#[derive(Deserialize)]
struct Line(#[serde(deserialize_with = "palmistry_io::foreign::read_line")] String);

/// `equations = 20`, or a table from parts to their last equation; the parts in the order in which they stand in the file.
struct Equations(Vec<(String, u32)>);

impl<'de> Deserialize<'de> for Equations {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Read;
        impl<'de> Visitor<'de> for Read {
            type Value = Equations;

            fn expecting(&self, to: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                to.write_str("the number of the last equation, or a table of such numbers")
            }

            fn visit_i64<E: serde::de::Error>(self, last: i64) -> Result<Equations, E> {
                let last = u32::try_from(last)
                    .map_err(|_| E::invalid_value(serde::de::Unexpected::Signed(last), &self))?;
                Ok(Equations(vec![(String::new(), last)]))
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Equations, A::Error> {
                let mut parts = Vec::new();
                while let Some(part) = map.next_entry()? {
                    parts.push(part);
                }
                Ok(Equations(parts))
            }
        }
        deserializer.deserialize_any(Read)
    }
}

/// Equations beyond this are refused: the page has a place for each.
const MOST_EQUATIONS: usize = 100_000;

/// Whether a file is what its author calls a scene, right or wrong: by the end of its name, and by what each kind of scene has. Of anything else that a
/// paper names nothing is quoted, whatever is wrong in it.
fn is_a_scene_file(path: &Path) -> bool {
    let is_named_so = path.extension().is_some_and(|end| end == "toml");
    let table = load(path).ok().and_then(|text| toml::from_str::<toml::Table>(&text).ok());
    let is_one = |table: toml::Table| {
        table.contains_key("motion")
            || table.contains_key("experiments")
            || table.get("observer").is_some_and(toml::Value::is_table)
    };
    is_named_so && table.is_some_and(is_one)
}

impl Paper {
    /// Reads a folder, with or without a `paper.toml`, or a single proof file. The proof files are only named here.
    ///
    /// # Errors
    /// What is wrong, and where: there is no such folder, it holds no proof file, `paper.toml` names a file that is not there.
    pub fn read(path: &Path) -> Result<Paper, ReadError> {
        let shown = shown_path(path);
        let refuse = |message: String, help: &str| {
            Problem::new(Code::Paper, &(0..0), message, "").help(help).locate(&shown, "")
        };
        if file::is_file(path) {
            let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
            if name == MANIFEST {
                return Paper::read(path.parent().unwrap_or(Path::new("")));
            }
            let folder = path.parent().unwrap_or(Path::new("")).to_owned();
            return Ok(Paper { folder, files: vec![name], ..Paper::default() });
        }
        if !file::is_folder(path) {
            let help = "name a folder of proof files, or one proof file";
            return Err(refuse(format!("there is no folder or file {shown}"), help));
        }
        let mut files = Vec::new();
        for found in file::files_in(path).map_err(|e| refuse(format!("cannot read {shown}: {e}"), ""))? {
            if found.extension().is_some_and(|extension| extension == "proof") {
                files.extend(found.file_name().map(|name| name.to_string_lossy().into_owned()));
            }
        }
        let manifest = path.join(MANIFEST);
        let mut paper = match file::is_file(&manifest) {
            true => Paper::described(&manifest, path, &files)?,
            false => Paper { folder: path.to_owned(), ..Paper::default() },
        };
        paper.files.extend(files.into_iter().filter(|file| !paper.files.contains(file)).collect::<Vec<_>>());
        if paper.files.is_empty() {
            return Err(refuse(format!("{shown} holds no proof file"), "proof files end in .proof"));
        }
        Ok(paper)
    }

    fn described(manifest: &Path, folder: &Path, files: &[String]) -> Result<Paper, ReadError> {
        let name = name_of(manifest);
        let text = load(manifest)
            .map_err(|message| Problem::new(Code::Paper, &(0..0), message, "").locate(&name, ""))?;
        let keys: Keys = toml::from_str(&text).map_err(|error| {
            let span = error.span().unwrap_or(0..0);
            Problem::new(Code::Paper, &span, error.message().replace('\n', ", "), "here")
                .help("the keys are: title, authors, year, source, equations, order, scenes, trade, derivatives")
                .locate(&name, &text)
        })?;
        let there = |named: &Spanned<String>| -> Result<String, ReadError> {
            if file::is_file(&folder.join(named.get_ref())) {
                return Ok(named.get_ref().clone());
            }
            let message = format!("there is no file {}", shown_path(&folder.join(named.get_ref())));
            let problem = Problem::new(Code::Paper, &named.span(), message, "named here");
            Err(match nearest(named.get_ref(), files.iter().map(String::as_str)) {
                Some(near) => problem.help(format!("perhaps you meant '{near}'")),
                None => problem.help("files are named relative to the folder of the paper"),
            }
            .locate(&name, &text))
        };
        let scene = |named: &Spanned<String>| -> Result<String, ReadError> {
            let found = there(named)?;
            if is_a_scene_file(&folder.join(&found)) {
                return Ok(found);
            }
            let message = format!("{} is no scene that can be read", shown_path(&folder.join(&found)));
            let help = "a scene is a TOML file; `palmistry observe FILE` says what is wrong in it";
            Err(Problem::new(Code::Paper, &named.span(), message, "named here")
                .help(help)
                .locate(&name, &text))
        };
        let order: Vec<String> = keys.order.iter().map(there).collect::<Result<_, _>>()?;
        if let Some(again) = (1..order.len()).find(|place| order[..*place].contains(&order[*place])) {
            let message = format!("'{}' is named twice", order[again]);
            return Err(Problem::new(Code::Paper, &keys.order[again].span(), message, "the second time")
                .locate(&name, &text));
        }
        let numbering = keys.equations.map(|Equations(parts)| Numbering(parts)).unwrap_or_default();
        if numbering.count() > MOST_EQUATIONS {
            let message = format!("more than {MOST_EQUATIONS} equations");
            return Err(Problem::new(Code::Paper, &(0..0), message, "").locate(&name, &text));
        }
        Ok(Paper {
            title: keys.title,
            authors: keys.authors.into_iter().map(|Line(author)| author).collect(),
            year: keys.year,
            source: keys.source.map(|Line(source)| source),
            numbering,
            folder: folder.to_owned(),
            files: order,
            scenes: keys.scenes.iter().map(scene).collect::<Result<_, _>>()?,
            trade: keys.trade.as_ref().map(there).transpose()?,
            derivatives: keys.derivatives.as_ref().map(there).transpose()?,
        })
    }

    /// The authors as they stand before a title: each between commas, and a comma behind the last one.
    pub fn authors_in_words(&self) -> String {
        match &self.authors[..] {
            [] => String::new(),
            [one] => format!("{one}, "),
            [all @ .., last] => format!("{} and {last}, ", all.join(", ")),
        }
    }

    /// Reads the proof files; each system is called as the paper calls its file.
    ///
    /// # Errors
    /// The first file that cannot be used: what is wrong, and where.
    pub fn systems(&self) -> Result<Vec<System>, ReadError> {
        let read = |file: &String| {
            let mut system = System::read_named(&self.folder.join(file))?;
            system.name.clone_from(file);
            Ok(system)
        };
        self.files.iter().map(read).collect()
    }
}
