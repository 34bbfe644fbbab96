//! Where a text stands, and which files it may name: those of the folder that is served, and those that came with the program.

use super::Refused;
use palmistry_io::file::{PACKED, identity};
use palmistry_io::foreign::shown;
use palmistry_lang::{Outline, System, load, with_plain_line_ends};
use palmistry_lsp::Draft;
use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};

/// The name of a text that has none.
const NAMELESS: &str = "lab.proof";

/// A text with all files that it names, directly or not.
pub(super) struct Place<'t> {
    /// The text.
    pub text: &'t str,
    /// The file in which it would stand.
    pub file: PathBuf,
    /// The files that it names, by their paths within the folder that is served or among the papers.
    pub named: BTreeMap<PathBuf, String>,
    /// Its own path, as those are.
    pub own: PathBuf,
}

impl<'t> Place<'t> {
    /// # Errors
    /// A name that leads out of the folder, of the text or of a file that it names.
    pub fn new(name: &str, text: &'t str, folder: Option<&Path>) -> Result<Place<'t>, Refused> {
        let name = if name.is_empty() { NAMELESS } else { name };
        let own = inner(name)?;
        let bounds = Bounds { folder: folder.map(real).transpose()? };
        let file = match (is_packed(Path::new(name)), &bounds.folder) {
            (true, _) => PathBuf::from(name),
            (false, Some(folder)) => folder.join(&own),
            // nothing stands beside it
            (false, None) => own.clone(),
        };
        let mut named = BTreeMap::new();
        bounds.follow(&file, text, &mut named)?;
        Ok(Place { text, file, named, own })
    }

    /// The text as somebody is at work on it.
    pub fn draft(&self) -> Draft {
        Draft::read(&self.file, self.text)
    }

    /// The system.
    ///
    /// # Errors
    /// What is wrong with the text, and where.
    pub fn system(&self) -> Result<System, Refused> {
        let folder = self.file.parent().unwrap_or(Path::new(""));
        Ok(System::parse(&self.own.to_string_lossy(), self.text, folder)?)
    }
}

fn is_packed(path: &Path) -> bool {
    path.to_str().is_some_and(|path| path.starts_with(PACKED))
}

/// A path of plain names.
fn inner(name: &str) -> Result<PathBuf, Refused> {
    let path = Path::new(name.strip_prefix(PACKED).unwrap_or(name));
    let is_plain = path.components().all(|part| matches!(part, Component::Normal(_)));
    let has_odd_letters = name.chars().any(|c| c.is_control() || c == '\\');
    let is_proof = path.extension().is_some_and(|end| end == "proof");
    if !is_proof || !is_plain || has_odd_letters {
        return Err(Refused::new(
            "a file is named by a path within the folder that ends with .proof, without '..'",
        ));
    }
    Ok(path.to_owned())
}

fn real(folder: &Path) -> Result<PathBuf, Refused> {
    let found = folder.canonicalize();
    found.map_err(|why| Refused::new(format!("the folder that is served cannot be read: {why}")))
}

/// What a text may name.
struct Bounds {
    /// The folder, as it really is; none where no file may be named.
    folder: Option<PathBuf>,
}

impl Bounds {
    /// Goes through all files that a text names, before anybody reads them.
    fn follow(&self, file: &Path, text: &str, named: &mut BTreeMap<PathBuf, String>) -> Result<(), Refused> {
        let outline = Outline::of(&with_plain_line_ends(text));
        let imported = outline.imports.iter().map(|import| import.path.as_str());
        let referred = outline.references.iter().filter_map(|reference| reference.file.as_deref());
        for name in imported.chain(referred) {
            let path = file.parent().unwrap_or(Path::new("")).join(name);
            // a file that does not exist is reported by the reader, at its place
            let Some(within) = self.within(&path, name)? else { continue };
            if named.contains_key(&within) {
                continue;
            }
            if let Ok(text) = load(&path) {
                named.insert(within, text.clone());
                self.follow(&path, &text, named)?;
            }
        }
        Ok(())
    }

    /// The path of a file within the folder, or among the papers; nothing where there is no such file.
    fn within(&self, path: &Path, name: &str) -> Result<Option<PathBuf>, Refused> {
        let out = || Refused::new(format!("'{}' lies outside of what may be read here", shown(name)));
        if is_packed(path) {
            let found = identity(path).ok();
            return Ok(found.map(|path| PathBuf::from(path.to_string_lossy().replacen(PACKED, "", 1))));
        }
        let Some(folder) = &self.folder else { return Err(out()) };
        // nor is it revealed whether a file exists in another folder
        let lexical = lexical(path);
        if !lexical.starts_with(folder) {
            return Err(out());
        }
        match path.canonicalize() {
            Err(_) => Ok(None),
            Ok(found) => match found.strip_prefix(folder) {
                Ok(within) => Ok(Some(within.to_owned())),
                Err(_) => Err(out()),
            },
        }
    }
}

/// A path without `.` and `..`, by its letters alone.
fn lexical(path: &Path) -> PathBuf {
    let mut found = PathBuf::new();
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir => drop(found.pop()),
            other => found.push(other),
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(name: &str, text: &str, folder: Option<&Path>) -> String {
        Place::new(name, text, folder).map(|_| ()).expect_err("it leads out").message
    }

    /// A folder beside a secret: by `..`, by an absolute path, by a link, by a file that is named, and by the text's own name.
    #[test]
    fn nothing_outside_of_the_folder_is_named() {
        let outer = tempfile::tempdir().expect("a folder");
        let folder = outer.path().join("served");
        std::fs::create_dir(&folder).expect("a folder");
        let secret = outer.path().join("secret.proof");
        std::fs::write(&secret, "system \"secret\"\nstate password").expect("written");
        std::fs::write(folder.join("good.proof"), "system \"good\"\nstate x").expect("written");
        std::fs::write(folder.join("bad.proof"), "use s = \"../secret.proof\"").expect("written");
        let text = |file: &str| format!("system \"a\"\nuse s = \"{file}\"\nstate x");
        let within = text("good.proof");
        let place = Place::new("a.proof", &within, Some(&folder)).expect("it stands there");
        assert_eq!(place.named.len(), 1);
        assert!(Place::new("sub/a.proof", &text("../good.proof"), Some(&folder)).is_ok());
        let absolute = secret.display().to_string();
        for file in
            ["../secret.proof", &absolute, "bad.proof", "x/../../secret.proof", "/etc/passwd", "../nothing"]
        {
            let why = refused("a.proof", &text(file), Some(&folder));
            assert!(why.contains("outside") && !why.contains("password"), "{file}: {why}");
        }
        for file in ["good.proof", "../secret.proof", &absolute] {
            assert!(refused("a.proof", &text(file), None).contains("outside"), "{file}");
        }
        let refers = "system \"a\"\nstate x\nclaim c restates d in \"../secret.proof\": x = x";
        assert!(refused("a.proof", refers, Some(&folder)).contains("outside"));
        for name in [
            "../a.proof",
            "/a.proof",
            "a/../../b.proof",
            ".",
            "..",
            "a\\b",
            "a\nb",
            "papers:",
            "papers:../a",
            "a.toml",
            "scene.toml",
            "proof",
        ] {
            assert!(refused(name, "", Some(&folder)).contains("within"), "{name}");
        }
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(&secret, folder.join("link.proof")).expect("a link");
            assert!(refused("a.proof", &text("link.proof"), Some(&folder)).contains("outside"));
        }
    }
}
