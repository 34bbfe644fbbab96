//! The text of a file as it is read: whole, within bounds, its lines counted as a person counts them, and nothing in it that makes it
//! look other than it is.

use super::codes::Code;
use super::entry_words::ENTRIES;
use super::error::Problem;
use palmistry_io::file::{ReadFailure, read_text};
use palmistry_io::foreign::shown_path;
use palmistry_math::expression::parse::ends_a_line;
use std::path::Path;

/// Files longer than this are refused.
const LONGEST_FILE: u64 = 16 << 20;

/// A text in which every line ends with a line feed, whatever its editor took for the end of a line, and without a
/// byte-order mark: so that the reader, the error and the person who looks count the same lines.
pub fn with_plain_line_ends(text: &str) -> String {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut plain = String::with_capacity(text.len());
    let mut characters = text.chars().peekable();
    while let Some(c) = characters.next() {
        // a carriage return before a line feed stays, and is blank
        let within_an_end = c == '\r' && characters.peek() == Some(&'\n');
        plain.push(if ends_a_line(c) && !within_an_end { '\n' } else { c });
    }
    plain
}

/// Refuses characters that make a text look other than it is read: marks of the direction of writing, behind which an
/// editor shows a claim as a comment or a comment as a claim.
pub(super) fn refuse_reordering(text: &str) -> Result<(), Problem> {
    let reorders = |c: char| matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}' | '\u{200e}' | '\u{200f}' | '\u{61c}');
    match text.char_indices().find(|(_, c)| reorders(*c)) {
        None => Ok(()),
        Some((at, c)) => {
            let message = format!("U+{:04X} changes the order in which the text is shown", c as u32);
            Err(Problem::new(Code::File, &(at..at + c.len_utf8()), message, "an invisible character")
                .help("remove it"))
        }
    }
}

/// Whether a text is what its author calls a proof file, right or wrong: by the end of its name, and by its first word. Anything
/// else is not quoted where another file has named it.
pub(super) fn is_a_proof_file(path: &Path, text: &str) -> bool {
    let code = text.lines().map(str::trim_start).find(|line| !line.is_empty() && !line.starts_with('#'));
    let word = code.and_then(|line| line.split(|c: char| !c.is_ascii_alphabetic()).next());
    path.extension().is_some_and(|end| end == "proof") && word.is_none_or(|word| ENTRIES.contains(&word))
}

/// That a file is no proof file, and nothing of what it is.
pub(super) fn no_proof_file(path: &Path) -> String {
    format!("{} is no proof file that can be read", shown_path(path))
}

/// The text of a file, or what is wrong with it in words. A byte-order mark is no part of it.
pub fn load(path: &Path) -> Result<String, String> {
    read_text(path, LONGEST_FILE).map_err(|why| match why {
        why @ (ReadFailure::TooLong(_) | ReadFailure::NotText { .. }) => {
            why.to_string().replacen("it", &shown_path(path), 1)
        }
        why => format!("cannot read {}: {why}", shown_path(path)),
    })
}
