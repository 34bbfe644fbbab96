//! A text as an editor has it: places as lines and UTF-16 units, and what is declared at them.
//!
//! The reader counts bytes of a text in which every line ends with a line feed; the editor counts lines that end with a line
//! feed, a carriage return or both, and in them the units of UTF-16. Each character of one text is one of the other, so that
//! a place in one is a place in the other.

use palmistry_io::foreign::name_of;
use palmistry_lang::{Outline, boundary, with_plain_line_ends};
use palmistry_math::expression::syntax::Span;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// A text with its address.
pub(super) struct Source {
    pub uri: String,
    /// Its file, where the address is one.
    pub path: Option<PathBuf>,
    /// As the editor has it.
    pub text: String,
    /// As the reader has it.
    pub plain: String,
    pub outline: Outline,
    /// From which byte of the plain text on the other one is so many bytes ahead.
    shifts: Vec<(usize, usize)>,
    /// The bytes of the editor's text at which lines begin.
    lines: Vec<usize>,
}

impl Source {
    pub fn new(uri: &str, path: Option<PathBuf>, text: &str) -> Source {
        let plain = with_plain_line_ends(text);
        let mut shifts = Vec::new();
        let (mut ahead, mut at) = (0, 0);
        let without_mark = text.strip_prefix('\u{feff}').unwrap_or(text);
        if without_mark.len() < text.len() {
            ahead = text.len() - without_mark.len();
            shifts.push((0, ahead));
        }
        for (theirs, ours) in without_mark.chars().zip(plain.chars()) {
            at += ours.len_utf8();
            if theirs.len_utf8() > ours.len_utf8() {
                ahead += theirs.len_utf8() - ours.len_utf8();
                shifts.push((at, ahead));
            }
        }
        let ends = text.bytes().enumerate().filter(|(at, byte)| match byte {
            b'\n' => true,
            b'\r' => text.as_bytes().get(at + 1) != Some(&b'\n'),
            _ => false,
        });
        let lines = std::iter::once(0).chain(ends.map(|(at, _)| at + 1)).collect();
        let outline = Outline::of(&plain);
        Source { uri: uri.to_owned(), path, text: text.to_owned(), plain, outline, shifts, lines }
    }

    /// The folder in which imports are looked for.
    pub fn folder(&self) -> &Path {
        self.path.as_deref().and_then(Path::parent).unwrap_or(Path::new(""))
    }

    /// The name under which it is read and reported.
    pub fn name(&self) -> String {
        self.path.as_ref().map_or_else(|| self.uri.clone(), |path| name_of(path))
    }

    /// The position of a byte of the plain text.
    pub fn position(&self, at: usize) -> Value {
        let before = self.shifts.partition_point(|(from, _)| *from <= at);
        let at = at + before.checked_sub(1).map_or(0, |last| self.shifts[last].1);
        let at = boundary(&self.text, at);
        let line = self.lines.partition_point(|begin| *begin <= at).saturating_sub(1);
        let units = self.text[self.lines[line]..at].encode_utf16().count();
        json!({ "line": line, "character": units })
    }

    /// The range of a part of the plain text.
    pub fn range(&self, span: &Span) -> Value {
        json!({ "start": self.position(span.start), "end": self.position(span.end.max(span.start)) })
    }

    /// All of the editor's text.
    pub fn whole(&self) -> Value {
        self.range(&(0..self.plain.len()))
    }

    /// The byte of the plain text at a position; of one that is behind the end of its line or of the text, that end.
    pub fn offset(&self, position: &Value) -> usize {
        let number = |key: &str| position[key].as_u64().and_then(|n| usize::try_from(n).ok()).unwrap_or(0);
        let (line, units) = (number("line"), number("character"));
        let Some(begin) = self.lines.get(line) else { return self.plain.len() };
        let end = self.lines.get(line + 1).copied().unwrap_or(self.text.len());
        let content = self.text[*begin..end].trim_end_matches(['\r', '\n']);
        let (mut at, mut passed) = (*begin, 0);
        for c in content.chars() {
            if passed >= units {
                break;
            }
            passed += c.len_utf16();
            at += c.len_utf8();
        }
        let before = self.shifts.partition_point(|(from, ahead)| from + ahead <= at);
        boundary(&self.plain, at - before.checked_sub(1).map_or(0, |last| self.shifts[last].1))
    }

    /// The lines that a part of the plain text touches, at most so many.
    pub fn lines_of(&self, span: &Span, most: usize) -> String {
        let begin = self.plain[..span.start].rfind('\n').map_or(0, |end| end + 1);
        let end = self.plain[span.end..].find('\n').map_or(self.plain.len(), |end| span.end + end);
        let mut lines: Vec<&str> = self.plain[begin..end].lines().take(most + 1).collect();
        if lines.len() > most {
            lines[most] = "...";
        }
        lines.join("\n")
    }

    /// The number of the line of a byte of the plain text, counted from one as everywhere but in messages of editors.
    pub fn line_number(&self, at: usize) -> u64 {
        self.position(at)["line"].as_u64().unwrap_or(0) + 1
    }
}

/// The file that an address names; none for texts that are in no file.
pub(super) fn path_of(uri: &str) -> Option<PathBuf> {
    let rest = uri.strip_prefix("file://")?;
    let path = &rest[rest.find('/')?..];
    let mut bytes = Vec::new();
    let mut rest = path.as_bytes();
    while let Some((first, after)) = rest.split_first() {
        let escaped = after.get(..2).and_then(|digits| std::str::from_utf8(digits).ok());
        match (first, escaped.and_then(|digits| u8::from_str_radix(digits, 16).ok())) {
            (b'%', Some(byte)) => {
                bytes.push(byte);
                rest = &after[2..];
            }
            _ => {
                bytes.push(*first);
                rest = after;
            }
        }
    }
    let path = String::from_utf8(bytes).ok()?;
    // file:///c:/folder
    let drive = cfg!(windows) && path.as_bytes().get(2) == Some(&b':');
    Some(PathBuf::from(if drive { &path[1..] } else { &path[..] }))
}

/// The address of a file.
pub(super) fn uri_of(path: &Path) -> String {
    let path = path.to_string_lossy().replace(std::path::MAIN_SEPARATOR, "/");
    let mut uri = String::from(if path.starts_with('/') { "file://" } else { "file:///" });
    for byte in path.bytes() {
        match byte {
            b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'-' | b'.' | b'_' | b'~' | b'/' => {
                uri.push(byte as char)
            }
            _ => uri.push_str(&format!("%{byte:02X}")),
        }
    }
    uri
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: a mark, a line that ends with a carriage return, a sign of two units, a separator that ends a line for the
    /// reader and none for the editor.
    #[test]
    fn places_are_lines_and_units() {
        let text = "\u{feff}a\rb\r\n# \u{1d54f}\u{2028}cd\ne";
        let source = Source::new("untitled:1", None, text);
        let at = |what: &str| source.plain.find(what).expect("it is there");
        for (what, line, character) in [("b", 1, 0), ("#", 2, 0), ("cd", 2, 5), ("d", 2, 6), ("e", 3, 0)] {
            let position = json!({ "line": line, "character": character });
            assert_eq!(source.position(at(what)), position, "{what}");
            assert_eq!(source.offset(&position), at(what), "{what}");
        }
        assert_eq!(source.position(0), json!({ "line": 0, "character": 1 }));
        assert_eq!(source.offset(&json!({ "line": 0, "character": 0 })), 0);
        // behind the end of a line, of the text; within a sign of two units; no position
        assert_eq!(source.offset(&json!({ "line": 0, "character": 99 })), 1);
        assert_eq!(source.offset(&json!({ "line": 99, "character": 0 })), source.plain.len());
        assert_eq!(source.offset(&json!({ "line": 2, "character": 3 })), at("\u{1d54f}") + 4);
        assert_eq!(source.offset(&json!({ "line": -1 })), 0);
    }

    #[test]
    fn addresses_of_files() {
        let path = Path::new("/a b/\u{e9}#%/c.proof");
        assert_eq!(uri_of(path), "file:///a%20b/%C3%A9%23%25/c.proof");
        assert_eq!(path_of(&uri_of(path)).as_deref(), Some(path));
        assert_eq!(path_of("file://localhost/x").as_deref(), Some(Path::new("/x")));
        assert_eq!(path_of("untitled:Untitled-1"), None);
        assert_eq!(path_of("file://"), None);
        assert_eq!(path_of("file:///%f%zz%").as_deref(), Some(Path::new("/%f%zz%")));
    }
}
