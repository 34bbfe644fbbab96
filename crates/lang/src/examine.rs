//! From a file or a text to a system, or to all that is wrong with it.

use super::codes::Code;
use super::error::{Problem, ReadError};
use super::imports::Reading;
use super::model::{System, Value};
use super::problems::{Cause, Problems};
use super::source_text::{is_a_proof_file, load, no_proof_file, with_plain_line_ends};
use miette::NamedSource;
use palmistry_io::file;
use palmistry_io::foreign::name_of;
use palmistry_math::expression::{Graph, Guard, parse_expression};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;

impl std::str::FromStr for System {
    type Err = ReadError;

    /// A system from a text alone: what it imports is looked for where the program runs.
    fn from_str(text: &str) -> Result<System, ReadError> {
        System::parse("the text", text, Path::new(""))
    }
}

impl System {
    /// Reads a proof file.
    ///
    /// # Errors
    /// What is wrong with the file, and where.
    pub fn read(path: &Path) -> Result<System, ReadError> {
        System::examine(path, 1).into_result()
    }

    /// Reads a proof file that another file names. That other file may come from a stranger, and name anything that can be read
    /// here: where it is no proof file, nothing of it is quoted.
    ///
    /// # Errors
    /// What is wrong with the file, and where.
    pub fn read_named(path: &Path) -> Result<System, ReadError> {
        System::read(path).map_err(|error| match is_a_proof_file(path, error.source_code.inner()) {
            true => error,
            false => {
                let name = name_of(path);
                Problem::new(Code::File, &(0..0), no_proof_file(path), "")
                    .help("a proof file begins with an entry")
                    .locate(&name, "")
            }
        })
    }

    /// Reads a system from a text; imports are looked for in `folder`.
    ///
    /// # Errors
    /// What is wrong with the text, and where.
    pub fn parse(name: &str, text: &str, folder: &Path) -> Result<System, ReadError> {
        System::examine_text(name, text, folder, 1).into_result()
    }

    /// Reads a proof file and says all that is wrong with it, up to so many problems.
    pub fn examine(path: &Path, most: usize) -> Examination {
        let name = name_of(path);
        match load(path) {
            Ok(text) => {
                let folder = path.parent().unwrap_or(Path::new(""));
                let mut found = System::examine_text(&name, &text, folder, most);
                found.files.insert(path.to_owned());
                found
            }
            Err(message) => Examination {
                system: None,
                problems: vec![Problem::new(Code::File, &(0..0), message, "").locate(&name, "")],
                more: false,
                files: BTreeSet::from([path.to_owned()]),
            },
        }
    }

    /// The same of a text; imports are looked for in `folder`.
    pub fn examine_text(name: &str, text: &str, folder: &Path, most: usize) -> Examination {
        let mut found = System::examine_draft(name, text, folder, most);
        found.system = found.system.filter(|_| found.problems.is_empty());
        found
    }

    /// The same of a text on which somebody is at work: the system is what could be understood, also where something is
    /// wrong. Nothing is decided of such a one.
    pub fn examine_draft(name: &str, text: &str, folder: &Path, most: usize) -> Examination {
        let text = with_plain_line_ends(text);
        let mut reading = Reading::default();
        reading.open.extend(file::identity(Path::new(name)));
        let mut problems = Problems::up_to(most);
        let built = System::build(name, &text, folder, Graph::default(), &mut reading, &mut problems);
        // what an imported file refers to is looked for where that file itself is read
        let system = built
            .ok()
            .filter(|system| system.check_references(folder, &mut problems, &mut reading.files).is_ok());
        let more = problems.more;
        let found = problems.into_found();
        let source = Arc::new(NamedSource::new(name, text));
        let mut problems: Vec<ReadError> =
            found.into_iter().map(|problem| problem.locate_in(&source)).collect();
        problems.sort_by_key(|problem| problem.span.offset());
        Examination { system, problems, more, files: reading.files }
    }

    /// The value of an expression that is not in the file but asked of it from outside.
    ///
    /// # Errors
    /// What is wrong with the expression, and where in it.
    pub fn evaluate_text(&mut self, text: &str) -> Result<Value, ReadError> {
        self.evaluate_text_guarded(text).map(|(value, _)| value)
    }

    /// The same, and where it exists: the value was simplified, and may have values where the text has none.
    ///
    /// # Errors
    /// What is wrong with the expression, and where in it.
    pub fn evaluate_text_guarded(&mut self, text: &str) -> Result<(Value, Vec<Guard>), ReadError> {
        let text = &with_plain_line_ends(text);
        let expr = parse_expression(text).map_err(|e| expected(e).locate("expression", text))?;
        self.elaborate_guarded(&expr).map_err(|problem| problem.locate("expression", text))
    }
}

/// What examining a file came to.
#[derive(Debug)]
pub struct Examination {
    /// The system, where nothing is wrong.
    pub system: Option<System>,
    /// What is wrong, in the order of the file.
    pub problems: Vec<ReadError>,
    /// Whether there is more than was asked for.
    pub more: bool,
    /// The files that were read or looked for: this one, and all that it imports or refers to.
    pub files: BTreeSet<PathBuf>,
}

impl Examination {
    /// The system, or the first problem.
    ///
    /// # Errors
    /// What is wrong with the file, and where.
    pub fn into_result(self) -> Result<System, ReadError> {
        match self.system {
            Some(system) => Ok(system),
            None => Err(self.problems.into_iter().next().unwrap_or_else(|| {
                Problem::new(Code::File, &(0..0), "the file cannot be read", "").locate("", "")
            })),
        }
    }
}

pub(super) fn expected(error: palmistry_math::expression::Expected) -> Problem {
    Problem {
        code: Code::Syntax,
        message: error.to_string(),
        span: error.at..error.at + 1,
        label: "here".to_owned(),
        help: error.help,
        cause: Cause::Itself,
    }
}
