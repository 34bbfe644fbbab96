//! The models that came with the program.

use super::Refused;
use palmistry_io::file::{PACKED, files_in, packed_folders};
use palmistry_lang::{DeclarationKind, Outline, load, with_plain_line_ends};
use palmistry_workbench::paper::MANIFEST;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// The comment at the head of a file may say what it is: so many characters of it are given.
const MOST_WORDS: usize = 300;

/// All of them: papers with their proof files and scenes.
pub(super) fn models() -> Value {
    let papers: Vec<Value> = packed_folders().into_iter().map(paper).collect();
    json!({ "papers": papers })
}

fn paper(folder: &str) -> Value {
    let path = PathBuf::from(format!("{PACKED}{folder}"));
    let with = |folder: &Path, end: &str| -> Vec<PathBuf> {
        let files = files_in(folder).unwrap_or_default();
        files.into_iter().filter(|file| file.extension().is_some_and(|found| found == end)).collect()
    };
    let models: Vec<Value> = with(&path, "proof").iter().map(|file| model_of(file)).collect();
    // a paper has its scenes in a folder, examples have them beside their systems
    let mut scenes = with(&path.join("scenes"), "toml");
    scenes.extend(with(&path, "toml").into_iter().filter(|file| !file.ends_with(MANIFEST)));
    let scenes: Vec<Value> = scenes.iter().map(|file| scene_of(file)).collect();
    json!({ "folder": folder, "models": models, "scenes": scenes })
}

fn model_of(file: &Path) -> Value {
    let text = load(file).unwrap_or_default();
    let outline = Outline::of(&with_plain_line_ends(&text));
    let count =
        |is: &dyn Fn(DeclarationKind) -> bool| outline.declarations.iter().filter(|one| is(one.kind)).count();
    let title = outline.declarations.iter().find(|one| one.kind == DeclarationKind::System);
    let head =
        text.lines().map_while(|line| line.strip_prefix('#')).map(str::trim).collect::<Vec<_>>().join(" ");
    json!({
        "file": file.to_string_lossy(),
        "title": title.map(|one| one.name.clone()),
        "about": head.chars().take(MOST_WORDS).collect::<String>(),
        "states": count(&|kind| kind == DeclarationKind::State),
        "outputs": count(&|kind| kind == DeclarationKind::Output),
        "claims": count(&|kind| matches!(kind, DeclarationKind::Claim(_))),
    })
}

fn scene_of(file: &Path) -> Value {
    let text = load(file).unwrap_or_default();
    let title = text.lines().find_map(|line| line.strip_prefix("title = \"")?.strip_suffix('"'));
    json!({ "file": file.to_string_lossy(), "title": title })
}

/// The text of one of them.
pub(super) fn model(file: &Path) -> Result<Value, Refused> {
    if !file.to_string_lossy().starts_with(PACKED) {
        return Err(Refused::new("this is no model of the program"));
    }
    Ok(json!({ "file": file.to_string_lossy(), "text": load(file)? }))
}
