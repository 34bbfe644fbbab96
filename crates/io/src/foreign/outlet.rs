//! The last step of what is written: nothing reaches a terminal that is not letters, ends of lines or this program's own colours.

use super::text::{is_hidden, push_escaped};
use serde_json::Value;
use std::borrow::Cow;

/// The length of a sequence at the start of a text that only sets a colour or a weight, as this program writes them: `ESC [`,
/// numbers between semicolons, `m`. What conceals text, or blinks, is none.
fn colour_length(text: &str) -> Option<usize> {
    let rest = text.strip_prefix("\u{1b}[")?;
    let end = rest.find(|c: char| !(c.is_ascii_digit() || c == ';'))?;
    if !rest[end..].starts_with('m') {
        return None;
    }
    let numbers: Vec<&str> = rest[..end].split(';').collect();
    let own = match numbers.as_slice() {
        // a colour out of 256, or of red, green and blue
        ["38" | "48", "5", _] | ["38" | "48", "2", _, _, _] => true,
        all => all.iter().all(|number| {
            matches!(number.parse::<u8>(), Ok(0..=4 | 22..=24 | 30..=37 | 39..=47 | 49 | 90..=97 | 100..=107))
                || number.is_empty()
        }),
    };
    own.then_some(2 + end + 1)
}

/// A whole text for a terminal: its lines and colours stay, every other invisible character is escaped.
pub fn terminal(text: &str) -> Cow<'_, str> {
    if !text.contains(|c| is_hidden(c) && c != '\n') {
        return text.into();
    }
    let mut out = String::with_capacity(text.len() + 16);
    let mut at = 0;
    while let Some(c) = text[at..].chars().next() {
        if c == '\u{1b}'
            && let Some(length) = colour_length(&text[at..])
        {
            out.push_str(&text[at..at + length]);
            at += length;
            continue;
        }
        match c {
            '\n' | '\t' => out.push(c),
            _ if is_hidden(c) => push_escaped(c, &mut out),
            _ => out.push(c),
        }
        at += c.len_utf8();
    }
    out.into()
}

/// An object as JSON, indented or in one line; invisible characters are written as `\uXXXX`, so that a terminal shows them and a
/// reader of JSON restores them.
pub fn json_text(object: &Value, indented: bool) -> String {
    let text = if indented { serde_json::to_string_pretty(object) } else { serde_json::to_string(object) };
    let text = text.unwrap_or_default();
    if !text.contains(|c| is_hidden(c) && c != '\n') {
        return text;
    }
    let mut out = String::with_capacity(text.len() + 16);
    for c in text.chars() {
        if is_hidden(c) && c != '\n' {
            for unit in c.encode_utf16(&mut [0; 2]) {
                out.push_str(&format!("\\u{unit:04x}"));
            }
        } else {
            out.push(c);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn own_colours_pass_and_nothing_else() {
        let own = "\u{1b}[1m\u{1b}[31mFAIL\u{1b}[0m\n\u{1b}[38;5;12mx\u{1b}[m";
        assert_eq!(terminal(own), own);
        for (text, seen) in [
            ("\u{1b}[8mhidden", "\\u{1b}[8mhidden"),
            ("\u{1b}]0;title\u{7}", "\\u{1b}]0;title\\u{7}"),
            ("\u{1b}[2J", "\\u{1b}[2J"),
            ("\u{9b}31m", "\\u{9b}31m"),
            ("a\rb", "a\\rb"),
            ("\u{1b}[38;2;1m", "\\u{1b}[38;2;1m"),
            ("\u{1b}", "\\u{1b}"),
        ] {
            assert_eq!(terminal(text), seen);
        }
    }

    #[test]
    fn json_keeps_what_it_says() {
        let object = serde_json::json!({ "a": "x\u{202e}y\u{7f}\u{9b}\u{e0041}\n" });
        for indented in [false, true] {
            let text = json_text(&object, indented);
            assert!(!text.contains(|c| is_hidden(c) && c != '\n'), "{text}");
            assert_eq!(serde_json::from_str::<Value>(&text).unwrap(), object);
        }
    }
}
