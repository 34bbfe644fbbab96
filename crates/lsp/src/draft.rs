//! One text, read as it stands: what a server that keeps no texts answers of it.

use super::completion::completions;
use super::lookup::Library;
use super::source::{Source, uri_of};
use super::{diagnostic, form_edits, hover_of};
use palmistry_lang::{MOST_PROBLEMS, Outline, System};
use palmistry_math::expression::syntax::Span;
use serde_json::Value;
use std::path::Path;
use std::rc::Rc;

/// A text that is being edited. Places are lines and units of UTF-16, as in the Language Server Protocol.
pub struct Draft {
    source: Rc<Source>,
    library: Library,
    /// What it means, as far as it could be understood.
    pub system: Option<System>,
    /// What is wrong with it, as diagnostics of the protocol.
    pub diagnostics: Vec<Value>,
}

impl Draft {
    /// Reads a text that would stand in a file; what it imports is looked for beside that file.
    pub fn read(file: &Path, text: &str) -> Draft {
        let source = Rc::new(Source::new(&uri_of(file), Some(file.to_owned()), text));
        let found = System::examine_draft(&source.name(), &source.text, source.folder(), MOST_PROBLEMS);
        let diagnostics = found.problems.iter().map(|problem| diagnostic(&source, problem)).collect();
        Draft { source, library: Library::default(), system: found.system, diagnostics }
    }

    /// The text as the reader has it, whose bytes the spans of the outline count.
    pub fn plain(&self) -> &str {
        &self.source.plain
    }

    /// What it declares.
    pub fn outline(&self) -> &Outline {
        &self.source.outline
    }

    /// The range of a part of the plain text.
    pub fn range(&self, span: &Span) -> Value {
        self.source.range(span)
    }

    /// What a name is, as a hover of the protocol; nothing where there is none.
    pub fn hover(&self, position: &Value) -> Option<Value> {
        hover_of(&self.library, &self.source, self.system.as_ref(), position)
    }

    /// What can stand at a position, as completion items of the protocol.
    pub fn completions(&self, position: &Value) -> Vec<Value> {
        completions(&self.library, &self.source, self.source.offset(position))
    }

    /// The edits that turn it into its normal form; nothing where it has none.
    pub fn formatted(&self) -> Option<Value> {
        form_edits(&self.source)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    const TEXT: &str = "system \"S\" # a line\nstate phi: rad, omega\nparam k = 2\ndrift f\n  phi' = omega\n  omega' = -k*sin(phi)\noutput phi\nclaim a: L(f, ph\n";

    fn labels(line: usize, character: usize) -> Vec<String> {
        let draft = Draft::read(Path::new("a.proof"), TEXT);
        let found = draft.completions(&json!({ "line": line, "character": character }));
        found.iter().filter_map(|item| Some(item["label"].as_str()?.to_owned())).collect()
    }

    /// By hand: names and functions within an expression, entries where a line begins, units behind a colon, nothing in comments,
    /// titles and numbers.
    #[test]
    fn what_can_stand_at_a_place() {
        let within = labels(7, 16);
        for name in ["phi", "omega", "k", "f", "sin", "pi"] {
            assert!(within.iter().any(|label| label == name), "{name}: {within:?}");
        }
        assert!(!within.iter().any(|label| label == "system"));
        assert!(labels(7, 0).iter().any(|label| label == "claim"));
        assert!(labels(1, 11).iter().any(|label| label == "rad"));
        assert!(!labels(1, 11).iter().any(|label| label == "sin"));
        for (line, character) in [(0, 9), (0, 15), (2, 11), (99, 0)] {
            assert!(labels(line, character).iter().all(|label| label != "omega") || line == 99);
        }
        assert!(labels(0, 15).is_empty() && labels(0, 9).is_empty() && labels(2, 11).is_empty());
    }

    #[test]
    fn a_draft_tells_its_mistakes_and_its_names() {
        let draft = Draft::read(Path::new("a.proof"), TEXT);
        assert_eq!(draft.diagnostics.len(), 1, "{:?}", draft.diagnostics);
        assert_eq!(draft.diagnostics[0]["range"]["start"]["line"], 7);
        let hover = draft.hover(&json!({ "line": 4, "character": 3 })).expect("a name stands there");
        assert!(hover["contents"]["value"].as_str().is_some_and(|text| text.starts_with("**state** `phi`")));
    }
}
