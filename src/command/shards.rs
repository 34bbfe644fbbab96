//! Work that is cut into shards: each writes a part into a folder, whole or not at all, and the parts are merged.

use super::Unusable;
use super::output::{Files, Form, print_json, print_text};
use super::{Status, interrupt::interrupted};
use clap::Args;
use miette::Report;
use palmistry::file::{note, read_head, read_text};
use palmistry::foreign::{name_of, shown_path};
use palmistry::system::Code;
use serde_json::json;
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// More shards than this are not cut.
const MOST: u64 = 1_000_000;

/// A part of more bytes than this is not read.
const LONGEST_PART: u64 = 512 << 20;

/// So much of a part says whether it is one.
const HEAD: u64 = 256;

/// The options of commands whose work can be cut.
#[derive(Args, Clone)]
pub(crate) struct Shards {
    /// Do shard K of N alone, counted from 1, and write what was found into the folder '--part'. If its part exists and is complete,
    /// nothing is done.
    #[arg(long, value_name = "K/N", requires = "part", conflicts_with_all = ["merge", "missing"])]
    pub shard: Option<Shard>,
    /// The folder of the parts.
    #[arg(long, value_name = "DIR", requires = "shard")]
    pub part: Option<PathBuf>,
    /// Answer from the parts in this folder, which must be complete: the same answer as that of one run.
    #[arg(long, value_name = "DIR", conflicts_with = "missing")]
    pub merge: Option<PathBuf>,
    /// Print the numbers of those of N shards whose part is not in the folder, one per line.
    #[arg(long, num_args = 2, value_names = ["DIR", "N"])]
    pub missing: Option<Vec<String>>,
}

impl Shards {
    /// Whether anything is asked about shards.
    pub fn are_asked(&self) -> bool {
        self.shard.is_some() || self.merge.is_some() || self.missing.is_some()
    }
}

/// One of several shards.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Shard {
    /// Counted from one.
    pub number: u64,
    pub of: u64,
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Shard, String> {
        let form = || "a shard is K/N, its number and how many there are, as in 3/64".to_owned();
        let (number, of) = text.split_once('/').ok_or_else(form)?;
        let (number, of) = (number.parse().map_err(|_| form())?, count(of).ok_or_else(form)?);
        match number {
            1.. if number <= of => Ok(Shard { number, of }),
            _ => Err(format!("of {of} shards the first is 1/{of} and the last {of}/{of}")),
        }
    }
}

fn count(text: &str) -> Option<u64> {
    text.parse().ok().filter(|count| (1..=MOST).contains(count))
}

impl Shard {
    /// The file of its part: `rank-07-of-64.json`.
    fn file(self, folder: &Path, kind: &str, extension: &str) -> PathBuf {
        let Shard { number, of } = self;
        let width = of.to_string().len();
        folder.join(format!("{kind}-{number:0width$}-of-{of}{extension}"))
    }
}

/// How a part stands.
pub(crate) enum PartStanding<T> {
    /// It is not there.
    Missing,
    /// It was cut or changed.
    Damaged(String),
    /// It was made for something else.
    OfAnother,
    Whole(T),
}

/// What is asked of parts: what they are called, how they are read, and whether they belong to a question.
pub(crate) struct Parts<'a, T> {
    pub kind: &'static str,
    /// How their names end, as `.json`.
    pub extension: &'static str,
    pub read: &'a dyn Fn(&str) -> Result<T, String>,
    pub belongs: &'a dyn Fn(&T) -> bool,
}

/// What can be done about a part of another question.
const ANOTHER: &str = "name another folder, or delete this file";

impl<T> Parts<'_, T> {
    fn standing(&self, path: &Path) -> PartStanding<T> {
        if !path.exists() {
            return PartStanding::Missing;
        }
        // what is no part is not read whole to find that out
        let head = match read_head(path, HEAD) {
            Ok(head) => String::from_utf8_lossy(&head).into_owned(),
            Err(why) => return PartStanding::Damaged(why.to_string()),
        };
        if !["palmistry ", " part "].iter().all(|word| head.contains(word)) {
            return PartStanding::Damaged("it does not begin as a part does".to_owned());
        }
        let text = match read_text(path, LONGEST_PART) {
            Ok(text) => text,
            Err(why) => return PartStanding::Damaged(why.to_string()),
        };
        match (self.read)(&text) {
            Ok(part) if (self.belongs)(&part) => PartStanding::Whole(part),
            Ok(_) => PartStanding::OfAnother,
            Err(why) => PartStanding::Damaged(why),
        }
    }

    /// Whether the part of a shard is there and whole. One that is damaged is made again.
    fn is_there(&self, path: &Path) -> miette::Result<bool> {
        match self.standing(path) {
            PartStanding::Whole(_) => Ok(true),
            PartStanding::Missing => Ok(false),
            PartStanding::Damaged(why) => {
                note(&format!("{} counts as missing: {why}", shown_path(path)));
                Ok(false)
            }
            PartStanding::OfAnother => Err(of_another(path)),
        }
    }

    /// Tells which shards are missing.
    pub fn tell_missing(&self, asked: &[String], form: Form) -> miette::Result<Status> {
        let [folder, of] = asked else { return Ok(Status::AsExpected) };
        let of = count(of).ok_or_else(|| {
            let message = format!("'{of}' is no number of shards");
            Unusable::report(Code::Option, message, "as in --missing parts 64")
        })?;
        let mut missing = Vec::new();
        for number in 1..=of {
            if !self.is_there(&Shard { number, of }.file(Path::new(folder), self.kind, self.extension))? {
                missing.push(number);
            }
        }
        match form {
            Form::Json => print_json(&json!({ "missing": missing, "of": of }))?,
            Form::Text if missing.is_empty() => {}
            Form::Text => print_text(&missing.iter().map(u64::to_string).collect::<Vec<_>>().join("\n"))?,
        }
        Ok(Status::AsExpected)
    }

    /// Does a shard, unless its part is there. `work` gives the text of the part, nothing where it was interrupted; beside the part
    /// it may write other files, without which it is not done.
    pub fn do_shard(
        &self,
        shard: Shard,
        folder: &Path,
        beside: Option<&Path>,
        form: Form,
        work: impl FnOnce(&mut Files) -> miette::Result<Option<String>>,
    ) -> miette::Result<Status> {
        let path = shard.file(folder, self.kind, self.extension);
        let was_there = self.is_there(&path)? && beside.is_none_or(Path::exists);
        let mut files = Files::default();
        let mut is_whole = was_there;
        if !was_there {
            let text = work(&mut files)?;
            super::interrupt::begin_to_tell();
            if let Some(text) = text.filter(|_| !interrupted() && files.whole()) {
                files.text(&path, &text);
                is_whole = files.whole();
            }
        } else {
            super::interrupt::begin_to_tell();
        }
        let Shard { number, of } = shard;
        let object = json!({
            "shard": number,
            "of": of,
            "part": name_of(&path),
            "was_there": was_there,
            "whole": is_whole,
        });
        let in_words = || match (was_there, is_whole) {
            (true, _) => format!("{} is there", shown_path(&path)),
            (false, true) => format!("written: {}", shown_path(&path)),
            (false, false) => format!("shard {number}/{of} is not done: nothing was written"),
        };
        files.print(form, object, in_words, if is_whole { Status::AsExpected } else { Status::CutOff })
    }

    /// All parts of a folder, by their names.
    pub fn all(&self, folder: &Path) -> miette::Result<Vec<(String, T)>> {
        let cannot = |why: std::io::Error| {
            let message = format!("cannot read {}: {why}", shown_path(folder));
            Unusable::report(Code::Saved, message, "name the folder into which '--part' wrote")
        };
        let mut paths = Vec::new();
        for entry in std::fs::read_dir(folder).map_err(cannot)? {
            let path = entry.map_err(cannot)?.path();
            let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
            if name
                .strip_prefix(self.kind)
                .is_some_and(|rest| rest.starts_with('-') && rest.ends_with(self.extension))
            {
                paths.push(path);
            }
        }
        paths.sort();
        let mut parts = Vec::new();
        for path in paths {
            match self.standing(&path) {
                PartStanding::Whole(part) => parts.push((name_of(&path), part)),
                PartStanding::OfAnother => return Err(of_another(&path)),
                PartStanding::Missing => {}
                PartStanding::Damaged(why) => {
                    let message = format!("{}: {why}", shown_path(&path));
                    return Err(Unusable::report(
                        Code::Saved,
                        message,
                        "do its shard again, which writes it anew",
                    ));
                }
            }
        }
        if parts.is_empty() {
            let message = format!(
                "there is no part '{}-K-of-N{}' in {}",
                self.kind,
                self.extension,
                shown_path(folder)
            );
            return Err(Unusable::report(
                Code::Saved,
                message,
                "do the shards first, with --shard and --part",
            ));
        }
        Ok(parts)
    }
}

fn of_another(path: &Path) -> Report {
    let message = format!(
        "{} belongs to another question: another file, other options, or another version of this program",
        shown_path(path)
    );
    Unusable::report(Code::Saved, message, ANOTHER)
}

/// What can be done about parts that are no whole.
pub(crate) const NO_WHOLE: &str =
    "'--missing DIR N' prints which of N shards are to be done; parts of one folder are those of one N";
