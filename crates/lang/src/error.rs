//! What can be wrong with a file, shown at its place.

use super::codes::Code;
use super::excerpt::{Excerpt, message};
use super::problems::Cause;
use miette::{Diagnostic, LabeledSpan, NamedSource, SourceCode, SourceSpan};
use std::fmt::Display;
use std::sync::Arc;

/// A file that could not be used: what, where, and what to do.
#[derive(Clone, Debug, thiserror::Error)]
#[error("{message}")]
pub struct ReadError {
    /// What kind of mistake it is.
    pub code: Code,
    /// What is wrong.
    pub message: String,
    /// The text, with its name.
    pub source_code: Arc<NamedSource<String>>,
    /// The place.
    pub span: SourceSpan,
    /// What stands at the place.
    pub label: String,
    /// What to do about it.
    pub help: Option<String>,
    /// What is shown of the text.
    excerpt: Box<Excerpt>,
}

/// What is rendered is the excerpt, and never the text itself.
impl Diagnostic for ReadError {
    fn help<'a>(&'a self) -> Option<Box<dyn Display + 'a>> {
        let more = self.code.reference();
        Some(Box::new(match &self.help {
            Some(help) => format!("{help}\n{more}"),
            None => more,
        }))
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        Some(self.excerpt.as_ref())
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let label = LabeledSpan::new_with_span(Some(self.label.clone()), self.excerpt.marked());
        Some(Box::new(std::iter::once(label)))
    }
}

impl ReadError {
    /// The line and the column of the place, in characters, both counted from one.
    pub fn line_and_column(&self) -> (usize, usize) {
        line_and_column(self.source_code.inner(), self.span.offset())
    }
}

/// The line and the column of a place in a text, in characters, both counted from one.
pub fn line_and_column(text: &str, at: usize) -> (usize, usize) {
    // the place is on the boundary of a character, or at the end
    let before = text.get(..at).unwrap_or(text);
    let line = before.matches('\n').count() + 1;
    let column = before.chars().rev().take_while(|c| *c != '\n').count() + 1;
    (line, column)
}

/// Where the lines of a text begin.
pub(crate) fn line_starts(text: &str) -> Vec<usize> {
    std::iter::once(0).chain(text.match_indices('\n').map(|(at, _)| at + 1)).collect()
}

/// An error without its text: what the elaborator knows.
#[derive(Debug)]
pub struct Problem {
    /// What kind of mistake it is.
    pub code: Code,
    /// What is wrong, in a sentence.
    pub message: String,
    /// Where, in bytes of the text.
    pub span: std::ops::Range<usize>,
    /// What is said at the place.
    pub label: String,
    /// What to do about it.
    pub help: Option<String>,
    /// On what it rests: it says nothing where that is broken itself.
    pub cause: Cause,
}

impl Problem {
    /// A problem at a place, with no advice.
    pub fn new(
        code: Code,
        span: &std::ops::Range<usize>,
        message: impl Into<String>,
        label: impl Into<String>,
    ) -> Self {
        Problem {
            code,
            message: message.into(),
            span: span.clone(),
            label: label.into(),
            help: None,
            cause: Cause::Itself,
        }
    }

    /// Adds what to do about it.
    pub fn help(mut self, help: impl Into<String>) -> Self {
        // without advice there is no line for it
        self.help = Some(help.into()).filter(|help| !help.is_empty());
        self
    }

    /// Says on what the problem rests.
    pub(crate) fn because(mut self, cause: Cause) -> Self {
        self.cause = cause;
        self
    }

    /// The error with the text that it points into. The span is kept within the text and on character boundaries.
    pub fn locate(self, name: &str, text: &str) -> ReadError {
        self.locate_in(&Arc::new(NamedSource::new(name, text.to_owned())))
    }

    /// The same with a text that several errors share.
    pub fn locate_in(self, source: &Arc<NamedSource<String>>) -> ReadError {
        let text = source.inner();
        let (mut begin, mut end) =
            (boundary(text, self.span.start), boundary(text, self.span.end.max(self.span.start)));
        let mut label = self.label;
        if begin == text.len() && !text.is_empty() {
            // there is nothing to mark at the end of the text: mark the last thing before it
            end = text.trim_end().len();
            begin = boundary(text, end.saturating_sub(1));
            label = "the text ends after this".to_owned();
        }
        ReadError {
            code: self.code,
            message: message(&self.message),
            excerpt: Box::new(Excerpt::new(source.name(), text, begin..end)),
            source_code: source.clone(),
            span: SourceSpan::new(begin.into(), end - begin),
            label: message(&label),
            help: self.help.as_deref().map(message),
        }
    }
}

/// The last boundary between characters of a text that is not behind a place.
pub fn boundary(text: &str, at: usize) -> usize {
    let mut at = at.min(text.len());
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    at
}

/// The known name nearest to one that is not known, for "perhaps you meant".
pub fn nearest<'a>(wanted: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    known
        .into_iter()
        .map(|name| (strsim::damerau_levenshtein(wanted, name), name))
        // of a short name nothing else may be left
        .filter(|(distance, _)| {
            let length = wanted.chars().count();
            *distance <= (length / 3).max(1) && *distance < length
        })
        .min()
        .map(|(_, name)| name)
}

#[cfg(test)]
mod tests {
    use super::line_and_column;
    use crate::System;
    use std::path::Path;

    #[test]
    fn a_system_knows_its_places_as_its_text_does() {
        let text = "# \u{e4}\nsystem \"\u{3bb} of a\"\n\nstate x # \u{1d54f}\n\n";
        let system = System::parse("a.proof", text, Path::new("")).unwrap();
        for at in (0..=text.len()).filter(|at| text.is_char_boundary(*at)) {
            assert_eq!(system.place(at), line_and_column(text, at), "{at}");
        }
        assert_eq!(system.place(usize::MAX), line_and_column(text, text.len()));
    }
}
