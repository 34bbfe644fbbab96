//! A file that imports another one: both are read into one graph, what the other declares goes under its alias, and none is read
//! twice, however many import it.

use super::codes::Code;
use super::domain::Domain;
use super::error::Problem;
use super::model::{Field, FieldPlace, Kind, Matrix, SymbolInfo, System, Value};
use super::nearby::nearest_name;
use super::problems::Problems;
use super::source_text::{is_a_proof_file, load, no_proof_file, with_plain_line_ends};
use palmistry_io::file;
use palmistry_io::foreign::{name_of as whole_name, shown, shown_path};
use palmistry_math::expression::syntax::{Name, Span};
use std::collections::btree_map::Entry;
use std::collections::{BTreeSet, HashMap};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Imports of imports beyond this are refused.
const DEEPEST_IMPORT: usize = 8;

/// More names than this are not imported: what an import imports comes with it, so that ten files of ten lines, each
/// of which imports the next ten times, would bring ten thousand million.
const MOST_NAMES: usize = 200_000;

/// The files of one reading.
#[derive(Default)]
pub(super) struct Reading {
    /// Those that are being read: each is imported by the one before.
    pub open: Vec<PathBuf>,
    /// Those that are read, so that none is read twice, however many others import it. Their graphs are empty: all are
    /// in the one graph of the reading.
    pub done: HashMap<PathBuf, Arc<System>>,
    /// All that were asked for, whether they are there or not.
    pub files: BTreeSet<PathBuf>,
}

impl System {
    /// Reads another file into the same graph. Its symbols are those of the same name here; its fields and definitions
    /// go under `alias.name`.
    pub(super) fn import(
        &mut self,
        alias: &Name,
        path: &Path,
        span: &Span,
        reading: &mut Reading,
    ) -> Result<(), Problem> {
        let refuse = |message: String| Problem::new(Code::Import, span, message, "this file");
        reading.files.insert(path.to_owned());
        let place = file::identity(path).map_err(|e| {
            let help = match nearest_name(path) {
                Some(near) => format!("perhaps you meant \"{}\"", shown(&near)),
                None => "a path begins at the folder of the file that imports, as in use other = \"lib/other.proof\"".to_owned(),
            };
            refuse(format!("cannot read {}: {e}", shown_path(path))).help(help)
        })?;
        if let Some(begin) = reading.open.iter().position(|open| *open == place) {
            let round = reading.open[begin..].iter().chain([&place]);
            let names: Vec<String> = round.map(|file| name_of(file)).collect();
            return Err(refuse(format!("the file imports itself: {}", names.join(" -> ")))
                .help("put what both need into a third file, and import that"));
        }
        if alias.text.contains('.') {
            let message = "a name with a dot belongs to what an imported system imports";
            return Err(Problem::new(Code::Name, &alias.span, message, "choose one without"));
        }
        if self.aliases.iter().any(|(known, _)| *known == alias.text) {
            let message = format!("'{}' is the name of an imported system already", alias.text);
            return Err(Problem::new(Code::Import, &alias.span, message, "the second one")
                .help("choose another name for this one"));
        }
        self.aliases.push((alias.text.clone(), path.to_owned()));
        let other = match reading.done.get(&place) {
            Some(known) => known.clone(),
            None if reading.open.len() > DEEPEST_IMPORT => {
                let message = format!("imports within imports, more than {DEEPEST_IMPORT} deep");
                return Err(refuse(message).help("import fewer files from one another"));
            }
            None => {
                reading.open.push(place.clone());
                let other = Arc::new(self.import_anew(path, span, reading)?);
                reading.open.pop();
                reading.done.insert(place, other.clone());
                other
            }
        };
        let names = self.definitions.len() + other.definitions.len();
        if names > MOST_NAMES {
            let message = format!("the imports bring more than {MOST_NAMES} names");
            return Err(
                refuse(message).help("each import brings all that its file imports, under a name of its own")
            );
        }
        for (symbol, info) in &other.symbols {
            if self.definitions.contains_key(self.graph.symbol_name(*symbol)) {
                let hidden = self.graph.symbol_name(*symbol);
                let message =
                    format!("'{hidden}' is a definition above, and a symbol of {}", shown_path(path));
                return Err(Problem::new(Code::Import, span, message, "imported here")
                    .help("choose another name for the definition"));
            }
            match self.symbols.entry(*symbol) {
                Entry::Vacant(place) => {
                    place.insert(SymbolInfo { kind: Kind::Imported, ..info.clone() });
                }
                Entry::Occupied(mut place) => {
                    let known = place.get_mut();
                    known.is_angle |= info.is_angle;
                    // where imported files differ neither speaks for this one
                    if known.kind == Kind::Imported {
                        known.default =
                            known.default.take().filter(|value| Some(value) == info.default.as_ref());
                        let own = self.sampled.contains(symbol);
                        known.range =
                            known.range.take().filter(|range| own || Some(range) == info.range.as_ref());
                    }
                }
            }
        }
        self.import_vectors(&alias.text, &other);
        self.imported_dimensions.push((alias.text.clone(), span.clone(), other.dimensions.clone()));
        for field in other.fields.iter().chain(&other.imported_fields) {
            let name = format!("{}.{}", alias.text, field.name);
            // of two of one name the first is meant
            let place = FieldPlace::Imported(self.imported_fields.len());
            self.field_places.entry(name.clone()).or_insert(place);
            let written = field.written.clone().under(&alias.text);
            self.imported_fields.push(Field { name, written, ..field.clone() });
        }
        for (name, written) in &other.written {
            self.written.insert(format!("{}.{name}", alias.text), written.clone().under(&alias.text));
        }
        for (name, value) in &other.definitions {
            self.definitions.insert(format!("{}.{name}", alias.text), value.clone());
        }
        if !other.outputs.is_empty() {
            // a word of the language, so that no definition has this name
            let name = format!("{}.output", alias.text);
            let entries: Vec<_> = other.outputs.iter().map(|(_, output)| *output).collect();
            let column = Matrix { rows: entries.len(), columns: 1, entries };
            self.definition_domains
                .insert(name.clone(), Domain::of(other.output_guards.iter().flatten().copied()));
            self.definitions.insert(name, Value::Matrix(column));
        }
        self.calculated.extend(other.calculated.iter().map(|name| format!("{}.{name}", alias.text)));
        for (name, domain) in &other.definition_domains {
            let domain = domain.clone().under(&alias.text);
            self.definition_domains.insert(format!("{}.{name}", alias.text), domain);
        }
        Ok(())
    }

    /// Reads a file that was not imported yet. The graph comes back here.
    fn import_anew(&mut self, path: &Path, span: &Span, reading: &mut Reading) -> Result<System, Problem> {
        let name = whole_name(path);
        let text = load(path).map_err(|message| Problem::new(Code::Import, span, message, "this file"))?;
        let text = with_plain_line_ends(&text);
        let folder = path.parent().unwrap_or(Path::new(""));
        let graph = std::mem::take(&mut self.graph);
        // what is wrong with an imported file is told of that file: here is said that something is
        let mut problems = Problems::up_to(1);
        let built = System::build(&name, &text, folder, graph, reading, &mut problems);
        let mut other = built.map_err(|graph| {
            // what was declared above the import is in it
            self.graph = *graph;
            let first = problems.into_found().into_iter().next();
            let problem =
                first.unwrap_or_else(|| Problem::new(Code::Import, &(0..0), "the file cannot be read", ""));
            if !is_a_proof_file(path, &text) {
                return Problem::new(Code::Import, span, no_proof_file(path), "imported here");
            }
            let inner = problem.locate(&name, &text);
            let (line, column) = inner.line_and_column();
            let problem = Problem::new(
                Code::Import,
                span,
                format!("{name}:{line}:{column}: {}", inner.message),
                "imported here",
            );
            match inner.help {
                Some(help) => problem.help(help),
                None => problem,
            }
        })?;
        self.graph = std::mem::take(&mut other.graph);
        Ok(other)
    }
}

/// The last part of a path, for messages.
fn name_of(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}
