//! Foreign text as it may stand in a line of a terminal, in a page, in Markdown.

use std::borrow::Cow;
use std::path::Path;

/// Whether a character is invisible, or changes how others are displayed: controls, ends of lines, marks of the direction of
/// writing, blanks without a width, tags (Unicode's general categories Cc, Cf, Zl and Zp, and fillers that are shown as nothing).
pub(super) fn is_hidden(c: char) -> bool {
    c.is_control()
        || matches!(c,
            '\u{ad}' | '\u{34f}' | '\u{61c}' | '\u{115f}' | '\u{1160}' | '\u{180e}' | '\u{3164}' | '\u{feff}' | '\u{ffa0}'
            | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{600}'..='\u{605}'
            | '\u{6dd}' | '\u{70f}' | '\u{fff9}'..='\u{fffb}' | '\u{1d173}'..='\u{1d17a}' | '\u{e0000}'..='\u{e0fff}')
}

/// A foreign text in one line in which everything is visible: invisible characters are escaped as in Rust and JSON, `\n` or
/// `\u{1b}`.
pub fn shown(text: &str) -> Cow<'_, str> {
    if !text.contains(is_hidden) {
        return text.into();
    }
    let mut out = String::with_capacity(text.len() + 16);
    for c in text.chars() {
        if is_hidden(c) { push_escaped(c, &mut out) } else { out.push(c) }
    }
    out.into()
}

pub(super) fn push_escaped(c: char, out: &mut String) {
    match c {
        '\n' => out.push_str("\\n"),
        '\r' => out.push_str("\\r"),
        '\t' => out.push_str("\\t"),
        _ => out.push_str(&format!("\\u{{{:x}}}", u32::from(c))),
    }
}

/// Reads a text that is shown as a line: for serde's `deserialize_with`.
///
/// # Errors
/// It is no text.
pub fn read_line<'de, D: serde::Deserializer<'de>>(from: D) -> Result<String, D::Error> {
    let text = <String as serde::Deserialize>::deserialize(from)?;
    Ok(shown(&text).into_owned())
}

/// A path as people read it: in one line, with what is no text replaced.
pub fn shown_path(path: &Path) -> String {
    shown(&path.to_string_lossy()).into_owned()
}

/// A path as a text for other programs (JSON); what is no text in it is replaced.
pub fn name_of(path: &Path) -> String {
    path.to_string_lossy().into_owned()
}

/// A foreign text as the content of an element, or as the value of an attribute in double quotes, of HTML and SVG.
pub fn html(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\n' | '\t' => out.push(c),
            _ if is_hidden(c) => push_escaped(c, &mut out),
            _ => out.push(c),
        }
    }
    out
}

/// A foreign text within a paragraph or a cell of Markdown, as letters and nothing else: no markup, no HTML, no link, no other
/// line.
pub fn markdown(text: &str) -> String {
    let text = shown(text);
    let mut out = String::with_capacity(text.len());
    for (at, c) in text.char_indices() {
        let next = text[at + c.len_utf8()..].chars().next();
        let escapes = match c {
            '<' | '&' => {
                out.push_str(if c == '<' { "&lt;" } else { "&amp;" });
                continue;
            }
            '\\' | '`' | '*' | '[' | ']' | '|' | '~' | '$' => true,
            // within a word it is a letter
            '_' => {
                let is_letter = |c: Option<char>| c.is_some_and(char::is_alphanumeric);
                !(is_letter(text[..at].chars().next_back()) && is_letter(next))
            }
            // code hosts make links of these
            '@' => true,
            ':' => text[at..].starts_with("://"),
            // what begins a line may be a heading, a list or a quotation
            '#' | '>' => at == 0,
            '+' | '-' | '=' => at == 0 && next.is_none_or(|next| next == c || next.is_whitespace()),
            '.' | ')' => {
                at > 0
                    && next.is_none_or(char::is_whitespace)
                    && text[..at].chars().all(|c| c.is_ascii_digit())
            }
            '!' => next == Some('['),
            _ => false,
        };
        if escapes {
            out.push('\\');
        }
        out.push(c);
    }
    out
}

/// The longest run of backquotes in a text.
fn backquotes(text: &str) -> usize {
    text.split(|c| c != '`').map(str::len).max().unwrap_or(0)
}

/// A foreign text as code in a line of Markdown.
pub fn code_span(text: &str) -> String {
    let text = shown(text);
    let fence = "`".repeat(backquotes(&text) + 1);
    let pad = if text.starts_with('`') || text.ends_with('`') { " " } else { "" };
    // within a table a bar ends a cell, also in code
    format!("{fence}{pad}{text}{pad}{fence}")
}

/// A foreign text of one or several lines as a block of code in Markdown: its fence is longer than any in it.
pub fn code_block(text: &str) -> String {
    let fence = "`".repeat(backquotes(text).max(2) + 1);
    let lines: Vec<Cow<'_, str>> = text.lines().map(shown).collect();
    format!("{fence}\n{}\n{fence}\n", lines.join("\n"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_hidden_and_no_line_is_forged() {
        assert_eq!(shown("plain, é, 汉"), "plain, é, 汉");
        let harm = "a\n  ok confirmed\r\u{1b}]0;title\u{7}\u{9b}2J\u{202e}b\u{2028}c\u{feff}\u{7f}";
        let seen = shown(harm);
        assert!(!seen.contains(is_hidden), "{seen}");
        assert!(seen.starts_with("a\\n  ok confirmed\\r\\u{1b}]0;title\\u{7}\\u{9b}2J\\u{202e}b\\u{2028}c"));
    }

    #[test]
    fn markup_is_letters() {
        assert_eq!(html("<a b=\"c\">&\u{1b}"), "&lt;a b=&quot;c&quot;&gt;&amp;\\u{1b}");
        assert_eq!(
            markdown("<img src=x onerror=y> [a](b) *c* |d| `e`\n# f"),
            "&lt;img src=x onerror=y> \\[a\\](b) \\*c\\* \\|d\\| \\`e\\`\\\\n# f"
        );
        assert_eq!(markdown("# 1"), "\\# 1");
        assert_eq!(markdown("1. a"), "1\\. a");
        assert_eq!(markdown("4.31: -x"), "4.31: -x");
        assert_eq!(markdown("-x"), "-x");
        assert_eq!(markdown("x_1, _a_ at https://b"), "x_1, \\_a\\_ at https\\://b");
        assert_eq!(code_span("a`b"), "``a`b``");
        assert_eq!(code_block("a\n```\nb"), "````\na\n```\nb\n````\n");
    }
}
