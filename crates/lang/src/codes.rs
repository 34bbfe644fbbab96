//! What kind of mistake a message is about. Each kind has a code and a page with a wrong and a right example, in `errors.md`.

/// The page of each code, in Markdown.
pub const ERRORS: &str = include_str!("errors.md");

/// A kind of mistake.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[allow(missing_docs)] // the headings of the page say it
pub enum Code {
    Option,
    Question,
    Place,
    Saved,
    System,
    Syntax,
    File,
    UnknownName,
    Twice,
    Name,
    TooLate,
    OtherKind,
    Component,
    Arguments,
    Shape,
    Value,
    Number,
    TooLarge,
    Field,
    Time,
    Signal,
    Initial,
    ZeroOutput,
    Statement,
    Reference,
    Assumption,
    Range,
    View,
    Import,
    ForeignText,
    Foreign,
    Dimension,
    SceneText,
    SceneKey,
    SceneValue,
    Paper,
}

impl Code {
    /// All of them, with what stands for each in a message.
    pub const ALL: [(Code, &'static str); 36] = [
        (Code::Option, "E001"),
        (Code::Question, "E002"),
        (Code::Place, "E003"),
        (Code::Saved, "E004"),
        (Code::System, "E005"),
        (Code::Syntax, "E101"),
        (Code::File, "E102"),
        (Code::UnknownName, "E201"),
        (Code::Twice, "E202"),
        (Code::Name, "E203"),
        (Code::TooLate, "E204"),
        (Code::OtherKind, "E205"),
        (Code::Component, "E206"),
        (Code::Arguments, "E301"),
        (Code::Shape, "E302"),
        (Code::Value, "E303"),
        (Code::Number, "E304"),
        (Code::TooLarge, "E305"),
        (Code::Field, "E401"),
        (Code::Time, "E402"),
        (Code::Signal, "E403"),
        (Code::Initial, "E404"),
        (Code::ZeroOutput, "E405"),
        (Code::Statement, "E501"),
        (Code::Reference, "E502"),
        (Code::Assumption, "E503"),
        (Code::Range, "E504"),
        (Code::View, "E505"),
        (Code::Import, "E601"),
        (Code::ForeignText, "E602"),
        (Code::Foreign, "E603"),
        (Code::Dimension, "E701"),
        (Code::SceneText, "E801"),
        (Code::SceneKey, "E802"),
        (Code::SceneValue, "E803"),
        (Code::Paper, "E901"),
    ];

    /// What stands for it in a message: `E201`.
    pub fn id(self) -> &'static str {
        Code::ALL.into_iter().find(|(code, _)| *code == self).map_or("", |(_, id)| id)
    }

    /// The line that ends a message: which command explains the code.
    pub fn reference(self) -> String {
        format!("'palmistry explain {}' has an example", self.id())
    }

    /// The code of an id, in capitals or not.
    pub fn of(id: &str) -> Option<Code> {
        Code::ALL.into_iter().find(|(_, known)| known.eq_ignore_ascii_case(id)).map(|(code, _)| code)
    }

    /// In a few words: the heading of its page.
    pub fn title(self) -> &'static str {
        let heading = self.section().split('\n').next().unwrap_or_default();
        heading.split_once(": ").map_or("", |(_, title)| title)
    }

    /// What it is, and how it is mended, in Markdown, without the heading.
    pub fn page(self) -> &'static str {
        self.section().split_once('\n').map_or("", |(_, page)| page.trim())
    }

    fn section(self) -> &'static str {
        let heading = format!("\n## {}", self.id());
        let Some(begin) = ERRORS.find(&heading) else { return "" };
        let section = &ERRORS[begin + 1..];
        let ends = ["\n## ", "\n# "].into_iter().filter_map(|next| section.find(next));
        &section[..ends.min().unwrap_or(section.len())]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_code_has_a_page() {
        for (code, id) in Code::ALL {
            assert_eq!(Code::of(&id.to_lowercase()), Some(code));
            assert!(!code.title().is_empty() && code.page().len() > 200, "{id}: {}", code.title());
            assert!(code.page().contains(&format!("refused={id}\n")), "{id} has no wrong example");
            assert!(!code.page().contains("\n## "), "{id}");
        }
        assert_eq!(ERRORS.matches("\n## E").count(), Code::ALL.len());
    }
}
