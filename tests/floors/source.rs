//! The files of `src` as modules, and what each of them names of the others.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// The names on the way from the root to a module.
pub type ModulePath = Vec<String>;

/// All modules that are files.
#[derive(Default)]
pub struct Crate {
    files: BTreeMap<ModulePath, File>,
}

/// What a file says of others, its tests left out.
struct File {
    /// Its text without comments, literals and tests.
    text: String,
    /// What names stand for that it imports.
    imports: BTreeMap<String, ModulePath>,
    /// All that it names with `::`, and all that it imports.
    named: BTreeSet<ModulePath>,
}

/// The files of Rust under a folder, with their texts.
pub fn files(folder: &Path) -> Vec<(PathBuf, String)> {
    let (mut found, mut open) = (Vec::new(), vec![folder.to_owned()]);
    while let Some(place) = open.pop() {
        for entry in std::fs::read_dir(&place).unwrap() {
            let entry = entry.unwrap().path();
            if entry.is_dir() {
                open.push(entry);
            } else if entry.extension().is_some_and(|extension| extension == "rs") {
                let text = std::fs::read_to_string(&entry).unwrap();
                found.push((entry, text));
            }
        }
    }
    found
}

impl Crate {
    /// The files of a folder, `main.rs` left out: it is a crate of its own.
    pub fn read(folder: &Path) -> Crate {
        let mut found = Crate::default();
        let mut tests = BTreeSet::new();
        for (file, text) in files(folder) {
            let inside = file.strip_prefix(folder).unwrap().with_extension("");
            let mut path: ModulePath = inside.iter().map(|name| name.to_str().unwrap().to_owned()).collect();
            match path.last().map(String::as_str) {
                Some("main") => continue,
                Some("mod" | "lib") => drop(path.pop()),
                _ => {}
            }
            tests.extend(found.add(path, &text));
        }
        found.files.retain(|path, _| !tests.iter().any(|test: &ModulePath| path.starts_with(test)));
        found
    }

    /// Adds a file, and gives the modules that it declares for tests alone.
    pub fn add(&mut self, path: ModulePath, text: &str) -> Vec<ModulePath> {
        let (text, tests) = without_tests(without_comments(text));
        let (imports, named) = names(&text);
        let below = |name: String| path.iter().cloned().chain([name]).collect();
        let tests = tests.into_iter().map(below).collect();
        self.files.insert(path, File { text, imports, named });
        tests
    }

    /// The modules that the root declares, in their order.
    pub fn floors(&self) -> Vec<String> {
        let root = &self.files[&ModulePath::new()].text;
        let words: Vec<&str> = root.split(|c: char| c.is_whitespace() || c == ';').collect();
        words.windows(2).filter(|pair| pair[0] == "mod").map(|pair| pair[1].to_owned()).collect()
    }

    /// All modules.
    pub fn modules(&self) -> impl Iterator<Item = &ModulePath> {
        self.files.keys()
    }

    /// The public types of each file, traits and aliases among them.
    pub fn public_types(&self) -> impl Iterator<Item = (&ModulePath, &str)> {
        self.files.iter().flat_map(|(path, file)| {
            let words: Vec<&str> = file.text.split(|c: char| !c.is_alphanumeric() && c != '_').collect();
            let is_type = |words: &&[&str]| {
                words[0] == "pub" && ["struct", "enum", "union", "trait", "type"].contains(&words[1])
            };
            let names: Vec<&str> = words.windows(3).filter(is_type).map(|words| words[2]).collect();
            names.into_iter().map(move |name| (path, name))
        })
    }

    /// The files that hold what a file names, but for itself. A name that is passed on counts for the file that it
    /// comes from, a module that is only imported for nothing: what is taken from it is seen where it is used.
    pub fn needed(&self, from: &ModulePath) -> BTreeSet<ModulePath> {
        let named = self.files[from].named.iter();
        let found = named.filter_map(|name| self.resolve(from, name, 0)).filter(|(_, whole)| !whole);
        found.map(|(path, _)| path).filter(|path| path != from).collect()
    }

    /// The file that a name is of, and whether the name is that of the file's module; `None` of what is not ours.
    fn resolve(&self, from: &ModulePath, name: &[String], depth: usize) -> Option<(ModulePath, bool)> {
        assert!(depth < 20, "{name:?} in {from:?} stands for itself");
        let child = |at: &ModulePath, name: &String| {
            let below: ModulePath = at.iter().chain([name]).cloned().collect();
            self.files.contains_key(&below).then_some(below)
        };
        let import = |at: &ModulePath, name: &String| Some(self.files.get(at)?.imports.get(name)?.clone());
        let (mut at, mut rest) = (from.clone(), name);
        match name[0].as_str() {
            "crate" => (at, rest) = (ModulePath::new(), &name[1..]),
            "self" => rest = &name[1..],
            "super" => {
                while rest.first().is_some_and(|part| part == "super") {
                    at.pop();
                    rest = &rest[1..];
                }
            }
            _ => match (child(from, &name[0]), import(from, &name[0])) {
                (Some(_), _) => {}
                (None, Some(import)) if import != name => {
                    return self.resolve(from, &[import, name[1..].to_vec()].concat(), depth + 1);
                }
                _ => return None,
            },
        }
        while let Some(part) = rest.first() {
            if let Some(below) = child(&at, part) {
                (at, rest) = (below, &rest[1..]);
            } else if let Some(import) = import(&at, part) {
                let found = self.resolve(&at, &[import, rest[1..].to_vec()].concat(), depth + 1);
                // of a type of another crate that is passed on nothing is ours
                return found;
            } else {
                return Some((at, false));
            }
        }
        Some((at, true))
    }
}

/// The text with comments and literals blanked.
fn without_comments(text: &str) -> String {
    let text: Vec<char> = text.chars().collect();
    let starts = |at: usize, with: &str| with.chars().enumerate().all(|(k, c)| text.get(at + k) == Some(&c));
    let (mut out, mut at) = (String::new(), 0);
    while at < text.len() {
        let before = at.checked_sub(1).map(|before| text[before]);
        let begins_a_word = !before.is_some_and(|c| c.is_alphanumeric() || c == '_');
        let hashes = text[at + 1..].iter().take_while(|c| **c == '#').count();
        if starts(at, "//") {
            while at < text.len() && text[at] != '\n' {
                at += 1;
            }
        } else if starts(at, "/*") {
            while !starts(at, "*/") {
                at += 1;
            }
            at += 2;
        } else if begins_a_word && text[at] == 'r' && text.get(at + 1 + hashes) == Some(&'"') {
            let end = format!("\"{}", "#".repeat(hashes));
            at += hashes + 2;
            while !starts(at, &end) {
                at += 1;
            }
            at += end.len();
        } else if text[at] == '"' {
            at += 1;
            while text[at] != '"' {
                at += if text[at] == '\\' { 2 } else { 1 };
            }
            at += 1;
        } else if text[at] == '\'' && (text.get(at + 1) == Some(&'\\') || text.get(at + 2) == Some(&'\'')) {
            // a character; what is left are lifetimes
            at += if text[at + 1] == '\\' { 3 } else { 2 };
            while text[at] != '\'' {
                at += 1;
            }
            at += 1;
        } else {
            out.push(text[at]);
            at += 1;
        }
    }
    out
}

/// The text without what is compiled for tests only, and the files that are declared so.
fn without_tests(mut text: String) -> (String, Vec<String>) {
    const MARK: &str = "#[cfg(test)]";
    let mut modules = Vec::new();
    while let Some(start) = text.find(MARK) {
        let mut depth = 0;
        let end = text[start + MARK.len()..].char_indices().find_map(|(place, c)| {
            match c {
                '{' | '(' | '[' => depth += 1,
                '}' | ')' | ']' => depth -= 1,
                _ => {}
            }
            (depth == 0 && (c == '}' || c == ';')).then_some(start + MARK.len() + place)
        });
        let item = text[start..=end.expect("an item")].to_owned();
        if let Some((_, name)) = item.split_once("mod ").filter(|_| item.ends_with(';')) {
            modules.push(name.trim_end_matches(';').to_owned());
        }
        text = text.replacen(&item, "", 1);
    }
    (text, modules)
}

/// What names stand for that a text imports; and all that it names.
fn names(text: &str) -> (BTreeMap<String, ModulePath>, BTreeSet<ModulePath>) {
    let (mut imports, mut named, mut rest) = (BTreeMap::new(), BTreeSet::new(), String::new());
    for (place, statement) in text.split(';').enumerate() {
        // a statement that imports ends at its semicolon, and what comes before it at a brace or a bracket
        let begins = |at: &usize| {
            let before = statement[..*at].chars().next_back();
            !before.is_some_and(|c| c.is_alphanumeric() || c == '_')
        };
        let import = statement.match_indices("use ").map(|(at, _)| at).find(begins);
        let Some(at) = import else {
            rest.push_str(if place > 0 { ";" } else { "" });
            rest.push_str(statement);
            continue;
        };
        rest.push_str(&statement[..at]);
        for path in expanded(&statement[at + "use ".len()..]) {
            let (path, alias) = match path.split_once(" as ") {
                Some((path, alias)) => (path.to_owned(), Some(alias.trim().to_owned())),
                None => (path, None),
            };
            let mut parts: ModulePath = path.split("::").map(|part| part.trim().to_owned()).collect();
            if parts.last().is_some_and(|last| last == "self") {
                parts.pop();
            }
            imports.insert(alias.unwrap_or_else(|| parts[parts.len() - 1].clone()), parts.clone());
            named.insert(parts);
        }
    }
    let in_a_path = |c: char| c.is_alphanumeric() || c == '_' || c == ':';
    for path in rest.split(|c: char| !in_a_path(c)) {
        let parts: ModulePath = path.split("::").map(str::to_owned).collect();
        if parts.len() > 1 && parts.iter().all(|part| !part.is_empty() && !part.contains(':')) {
            named.insert(parts);
        }
    }
    (imports, named)
}

/// `a::{b, c::{d, e}}` as `a::b`, `a::c::d` and `a::c::e`.
fn expanded(tree: &str) -> Vec<String> {
    let tree = tree.trim();
    let Some((front, inner)) = tree.split_once('{') else { return vec![tree.to_owned()] };
    let inner = &inner[..inner.rfind('}').expect("a brace that closes")];
    let (mut depth, mut parts) = (0, vec![String::new()]);
    for c in inner.chars() {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            _ => {}
        }
        if c == ',' && depth == 0 {
            parts.push(String::new());
        } else {
            parts.last_mut().unwrap().push(c);
        }
    }
    let parts = parts.iter().filter(|part| !part.trim().is_empty());
    parts.flat_map(|part| expanded(&format!("{front}{}", part.trim()))).collect()
}
