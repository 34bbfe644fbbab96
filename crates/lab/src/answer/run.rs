//! What whole commands do, in a folder of the question's own: estimates, pages, imports.

use super::Refused;
use super::estimated::{Rewritten, rewritten};
use super::place::Place;
use palmistry_io::file::PACKED;
use palmistry_lang::{Dimension, load};
use serde::Deserialize;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};
use std::process::{Command, Stdio};

/// What is observed, how it is measured and what is to be estimated.
#[derive(Deserialize)]
pub(super) struct ObserveAsked {
    from: MeasuredFrom,
    estimate: Vec<String>,
    #[serde(default)]
    known: BTreeMap<String, f64>,
    /// First guesses; the middle of the sample box where there are none.
    #[serde(default)]
    guess: BTreeMap<String, f64>,
    method: Option<String>,
    /// Steps in a window; all of the record where none is given.
    window: Option<u32>,
    /// The noise of the outputs; estimated where none is given.
    noise: Option<f64>,
    #[serde(default)]
    seed: u64,
}

#[derive(Deserialize)]
#[serde(rename_all = "kebab-case")]
enum MeasuredFrom {
    /// A table, as CSV, and which of its columns is which output, signal or input field.
    Record { csv: String, columns: BTreeMap<String, ColumnAsked>, interpolation: Option<String> },
    /// The system itself, from a state; functions of time by the names of signals and input fields.
    Motion { start: BTreeMap<String, f64>, inputs: BTreeMap<String, String>, duration: f64, samples: u32 },
}

#[derive(Deserialize)]
struct ColumnAsked {
    from: String,
    unit: Option<String>,
}

/// A text as a string of TOML: those of JSON are.
fn quoted(text: &str) -> String {
    Value::from(text).to_string()
}

/// A table of numbers on one line.
fn inline(values: &BTreeMap<String, f64>) -> Result<String, Refused> {
    let pair = |(name, value): (&String, &f64)| match value.is_finite() {
        true => Ok(format!("{} = {value:?}", quoted(name))),
        false => Err(Refused::new(format!("{name} is not finite"))),
    };
    let pairs: Vec<String> = values.iter().map(pair).collect::<Result<_, _>>()?;
    Ok(format!("{{ {} }}", pairs.join(", ")))
}

impl ObserveAsked {
    /// The scene of a model, as a file; nothing in it but what is written here, and names in quotation marks.
    fn scene(
        &self,
        title: &str,
        model: &str,
        (drives, mut known): (&BTreeMap<String, String>, BTreeMap<String, f64>),
    ) -> Result<String, Refused> {
        known.extend(self.known.clone());
        // an input field is known by the symbol that drives it
        let symbol = |name: &String| drives.get(name).unwrap_or(name).clone();
        let mut out = format!("title = {}\nmodel = {}\nseed = {}\n", quoted(title), quoted(model), self.seed);
        let texts = |values: &BTreeMap<String, String>| -> String {
            let pairs: Vec<String> =
                values.iter().map(|(name, text)| format!("{} = {}", quoted(name), quoted(text))).collect();
            format!("{{ {} }}", pairs.join(", "))
        };
        let add = |out: &mut String, line: String| {
            out.push_str(&line);
            out.push('\n');
        };
        match &self.from {
            MeasuredFrom::Record { columns, interpolation, .. } => {
                if !columns.is_empty() {
                    add(&mut out, "[columns]".to_owned());
                }
                for (name, column) in columns {
                    let unit = column.unit.as_ref().filter(|unit| !unit.is_empty());
                    let unit = unit.map_or_else(String::new, |unit| format!(", unit = {}", quoted(unit)));
                    add(
                        &mut out,
                        format!("{} = {{ from = {}{unit} }}", quoted(&symbol(name)), quoted(&column.from)),
                    );
                }
                add(
                    &mut out,
                    format!("[data]\nrecord = {}\non_fault = \"skip\"\nspike = inf", quoted(RECORD)),
                );
                if let Some(way) = interpolation {
                    add(&mut out, format!("interpolation = {}", quoted(way)));
                }
            }
            MeasuredFrom::Motion { start, inputs, duration, samples } => {
                if !duration.is_finite() {
                    return Err(Refused::new("the duration is not finite"));
                }
                add(&mut out, format!("duration = {duration:?}\nsamples = {samples}"));
                add(&mut out, format!("start = {}", inline(start)?));
                if !inputs.is_empty() {
                    let inputs = inputs.iter().map(|(name, text)| (symbol(name), text.clone())).collect();
                    add(&mut out, format!("inputs = {}", texts(&inputs)));
                }
            }
        }
        if let Some(noise) = self.noise {
            if !noise.is_finite() {
                return Err(Refused::new("the noise is not finite"));
            }
            add(&mut out, format!("[sensor]\nnoise = {noise:?}"));
        }
        add(&mut out, "[observer]".to_owned());
        let estimate: Vec<String> = self.estimate.iter().map(|name| quoted(name)).collect();
        add(&mut out, format!("estimate = [{}]", estimate.join(", ")));
        if let Some(method) = &self.method {
            add(&mut out, format!("methods = [{}]", quoted(method)));
        }
        if let Some(window) = self.window {
            add(&mut out, format!("window = {window}"));
        }
        if !known.is_empty() {
            add(&mut out, format!("known = {}", inline(&known)?));
        }
        if !self.guess.is_empty() {
            add(&mut out, format!("guess = {}", inline(&self.guess)?));
        }
        if !drives.is_empty() {
            add(&mut out, format!("inputs = {}", texts(drives)));
        }
        Ok(out)
    }
}

/// The page of an answer, in the folder of its question, beside the folder of files that a question names.
pub(crate) const PAGE: &str = "page.html";
const FILES: &str = "files";
const RECORD: &str = "record.csv";
const SCENE: &str = "scene.toml";

/// Writes a text and what it names where they stand to each other as they do.
fn written(place: &Place<'_>, work: &Path) -> Result<PathBuf, Refused> {
    let files = work.join(FILES);
    for (file, text) in place.named.iter().map(|(file, text)| (file.as_path(), text.as_str())) {
        write(&files.join(file), text)?;
    }
    let own = files.join(&place.own);
    write(&own, place.text)?;
    Ok(own)
}

fn write(path: &Path, text: &str) -> Result<(), Refused> {
    let done =
        std::fs::create_dir_all(path.parent().unwrap_or(path)).and_then(|()| std::fs::write(path, text));
    done.map_err(|why| Refused::new(format!("the folder of this question cannot be written: {why}")))
}

/// What a command has printed, and its exit status.
struct Ran {
    text: String,
    said: String,
    status: Option<i32>,
}

/// Runs the program.
fn command(arguments: &[&str], within: &Path) -> Result<Ran, Refused> {
    let failed = |why: std::io::Error| Refused::new(format!("the program cannot be started: {why}"));
    let program = std::env::current_exe().map_err(failed)?;
    // what is started here does not outlive the server either
    let output = Command::new(program)
        .args(["lab", "--then"])
        .args(arguments)
        .current_dir(within)
        .env("COLUMNS", "80")
        .stdin(Stdio::null())
        .output()
        .map_err(failed)?;
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    Ok(Ran { text: text(&output.stdout), said: text(&output.stderr), status: output.status.code() })
}

impl Ran {
    /// What was printed as JSON.
    fn json(self) -> Result<Value, Refused> {
        let Ran { text, said, status } = self;
        let object: Value = serde_json::from_str(&text).unwrap_or(Value::Null);
        if status.is_none() {
            return Err(Refused::new("it took more than it may: a smaller question may have an answer"));
        }
        match object.get("error") {
            None if object.is_object() => Ok(object),
            Some(error) => {
                let message = error["message"].as_str().unwrap_or("it could not be done").to_owned();
                Err(Refused { message, help: error["help"].as_str().map(str::to_owned) })
            }
            None => Err(Refused::new(said)),
        }
    }
}

/// Puts the page in a folder where the server looks for one; whether there is one.
fn keep_page(folder: &Path, work: &Path) -> bool {
    std::fs::rename(folder.join("index.html"), work.join(PAGE)).is_ok()
}

/// Estimates, with the page that `observe` writes.
pub(super) fn observe(place: &Place<'_>, asked: &ObserveAsked, work: &Path) -> Result<Value, Refused> {
    let system = place.system()?;
    let fields = system.roles();
    let is_driven = |name: &&String| fields.iter().any(|field| field.name == **name);
    let driven = match &asked.from {
        MeasuredFrom::Record { columns, .. } => columns.keys().filter(is_driven).cloned().collect(),
        MeasuredFrom::Motion { inputs, .. } => inputs.keys().filter(is_driven).cloned().collect(),
    };
    let Rewritten { text, known, drives } = rewritten(place.text, &system, &asked.estimate, &driven);
    let own = written(place, work)?;
    write(&own, &text)?;
    let folder = own.parent().unwrap_or(work).to_owned();
    let model = own.file_name().unwrap_or_default().to_string_lossy().into_owned();
    if let MeasuredFrom::Record { csv, .. } = &asked.from {
        write(&folder.join(RECORD), csv)?;
    }
    let scene = asked.scene(&system.title, &model, (&drives, known))?;
    write(&folder.join(SCENE), &scene)?;
    let found = command(&["observe", SCENE, "--json", "--out", "page"], &folder)?.json()?;
    let units: BTreeMap<String, Option<String>> = system
        .symbols()
        .map(|(symbol, _)| {
            (system.symbol_name(symbol).to_owned(), system.dimension_of(symbol).map(Dimension::in_words))
        })
        .collect();
    Ok(
        json!({ "observed": found, "scene": scene, "units": units, "has_page": keep_page(&folder.join("page"), work) }),
    )
}

/// A scene that came with the program.
pub(super) fn scene(scene: &Path, work: &Path) -> Result<Value, Refused> {
    let name = scene.to_string_lossy();
    let rest = name.strip_prefix(PACKED);
    let is_plain = |rest: &str| Path::new(rest).components().all(|part| matches!(part, Component::Normal(_)));
    if !rest.is_some_and(is_plain) {
        return Err(Refused::new("this is no scene of the program"));
    }
    let whole = ["observe", &name, "--json", "--out", "page", "--motion", "motion.csv"];
    let found = match command(&whole, work)?.json() {
        // slow palms have no motion of the body to write
        Err(_) => command(&whole[..5], work)?.json()?,
        Ok(found) => found,
    };
    let motion = std::fs::read_to_string(work.join("motion.csv")).ok();
    Ok(
        json!({ "observed": found, "motion": motion, "scene": load(scene)?, "has_page": keep_page(&work.join("page"), work) }),
    )
}

/// The page of the text as a paper of one file.
pub(super) fn page(place: &Place<'_>, work: &Path) -> Result<Value, Refused> {
    let own = written(place, work)?;
    let folder = own.parent().unwrap_or(work);
    let title = place.system()?.title;
    write(&folder.join("paper.toml"), &format!("title = {}\n", quoted(&title)))?;
    let out = work.join("page-of-this-paper");
    let (folder, out) = (folder.to_string_lossy().into_owned(), out);
    let ran = command(&["verify", &folder, "--out", &out.to_string_lossy()], work)?;
    if keep_page(&out, work) { Ok(json!({ "has_page": true })) } else { Err(Refused::new(ran.said)) }
}

/// A proof file from files of another program: the model, and what it needs beside it.
pub(super) fn import(files: &BTreeMap<String, String>, work: &Path) -> Result<Value, Refused> {
    let main = main_of(files, work)?;
    command(&["import", &main, "--json"], &work.join(FILES))?.json()
}

/// The fit of a problem of parameter estimation, as its files state it.
pub(super) fn fit(files: &BTreeMap<String, String>, work: &Path) -> Result<Value, Refused> {
    let (main, folder) = (main_of(files, work)?, work.join(FILES));
    command(&["import", &main, "--json", "--out", "../problem.proof"], &folder)?.json()?;
    let found = command(&["observe", "problem.toml", "--json", "--out", "page"], work)?.json()?;
    Ok(json!({ "observed": found, "has_page": keep_page(&work.join("page"), work) }))
}

/// Writes the files, and returns which of them is to be imported.
fn main_of(files: &BTreeMap<String, String>, work: &Path) -> Result<String, Refused> {
    let mut names = Vec::new();
    for (name, text) in files {
        let plain = Path::new(name).file_name().map(|name| name.to_string_lossy().into_owned());
        let plain = plain.filter(|plain| !plain.starts_with('-') && !plain.chars().any(char::is_control));
        let plain = plain.ok_or_else(|| Refused::new("this is no name of a file"))?;
        write(&work.join(FILES).join(&plain), text)?;
        names.push(plain);
    }
    // a problem of parameter estimation is named by its YAML, and names the others
    let is_problem = |name: &&String| name.ends_with(".yaml") || name.ends_with(".yml");
    let main = names.iter().find(is_problem).or(names.first());
    main.cloned().ok_or_else(|| Refused::new("no file was given"))
}
