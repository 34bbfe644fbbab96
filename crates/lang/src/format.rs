//! The normal form of a proof file: blanks at the beginnings and ends of lines, columns of `=` and `in`, empty lines. Nothing
//! else is touched: every sign, every comment and every text in quotation marks stays as it is, byte for byte.

use super::codes::Code;
use super::entry_words::ENTRIES;
use super::error::{Problem, ReadError};
use super::grammar::parse_file;
use super::signals;
use super::source_text::{refuse_reordering, with_plain_line_ends};
use super::views;

/// What lies within an entry is moved in by so many blanks.
const INDENT: usize = 2;

/// A proof file in normal form. It is only read for its grammar: names may be unknown.
///
/// # Errors
/// What is wrong with the text, and where: then there is no normal form.
pub fn format_text(name: &str, text: &str) -> Result<String, ReadError> {
    let text = with_plain_line_ends(text);
    let located = |problem: Problem| problem.locate(name, &text);
    refuse_reordering(&text).map_err(located)?;
    parse_file(&text).map_err(|error| {
        let problem = Problem::new(Code::Syntax, &(error.at..error.at + 1), error.to_string(), "here");
        located(match error.help {
            Some(help) => problem.help(help),
            None => problem,
        })
    })?;
    let mut lines = lines(&text);
    indent(&mut lines);
    align(&mut lines);
    let formatted = put_together(&lines);
    // a formatter that loses a sign is worse than none
    let signs = |text: &str| text.chars().filter(|c| !c.is_whitespace()).collect::<String>();
    if signs(&formatted) == signs(&text) && parse_file(&formatted).is_ok() {
        Ok(formatted)
    } else {
        Err(located(Problem::new(Code::File, &(0..0), "this file has no normal form", "left as it is")))
    }
}

/// What a line is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum LineKind {
    /// An entry begins.
    Entry,
    /// A state and its rate, or a symbol and its range: the sign that is put below the one above stands at this byte of the text.
    Row(usize),
    /// What was begun goes on.
    Rest,
    Comment,
    Empty,
    /// It begins within quotation marks.
    Quoted,
}

/// A line without the blanks around it, and how far in it stands.
#[derive(Clone, Debug)]
struct Line {
    kind: LineKind,
    indent: usize,
    text: String,
}

/// The lines of a text, told apart.
fn lines(text: &str) -> Vec<Line> {
    let mut found = Vec::new();
    let mut quoted = false;
    let mut depth = 0usize;
    let mut rows: Option<&str> = None;
    for line in text.lines() {
        if quoted {
            // what stands in quotation marks is a text: also the blanks at its beginning and, unless it ends here, at its end
            let goes_on = scan(line, &mut quoted, &mut depth);
            let text = if goes_on { line } else { line.trim_end() };
            found.push(Line { kind: LineKind::Quoted, indent: 0, text: text.to_owned() });
            continue;
        }
        let inner = line.trim_start();
        let indent = columns(&line[..line.len() - inner.len()]);
        let within_brackets = depth > 0;
        let kind = if inner.is_empty() {
            LineKind::Empty
        } else if inner.starts_with('#') {
            LineKind::Comment
        } else if let Some(word) = (!within_brackets).then(|| begins_an_entry(inner)).flatten() {
            rows = match word {
                "drift" | "input" | "field" => Some("="),
                "sample" => Some("in"),
                _ => None,
            };
            LineKind::Entry
        } else {
            match rows.filter(|_| !within_brackets).and_then(|sign| row(inner, sign)) {
                Some(place) => LineKind::Row(place),
                None => LineKind::Rest,
            }
        };
        let goes_on = scan(inner, &mut quoted, &mut depth);
        let text = if goes_on { inner } else { inner.trim_end() };
        found.push(Line { kind, indent, text: text.to_owned() });
    }
    found
}

/// The columns that blanks take; a tabulator is taken for two.
fn columns(blanks: &str) -> usize {
    blanks.chars().map(|c| if c == '\t' { INDENT } else { 1 }).sum()
}

/// Follows quotation marks and brackets through a line; whether it ends within quotation marks.
fn scan(line: &str, quoted: &mut bool, depth: &mut usize) -> bool {
    for c in line.chars() {
        match c {
            '"' => *quoted = !*quoted,
            _ if *quoted => {}
            '#' => break,
            '(' | '[' | '{' => *depth += 1,
            ')' | ']' | '}' => *depth = depth.saturating_sub(1),
            _ => {}
        }
    }
    *quoted
}

/// The word with which a line begins, if it begins an entry: these words are no names, but for those of views, which are where
/// neither a title nor `of` follows.
fn begins_an_entry(line: &str) -> Option<&'static str> {
    let end = line.find(|c: char| !(c.is_ascii_alphanumeric() || c == '_')).unwrap_or(line.len());
    let (word, rest) = line.split_at(end);
    let word = ENTRIES.into_iter().find(|known| *known == word)?;
    let rest = rest.trim_start();
    let is_name = views::WORDS.contains(&word) && !rest.starts_with('"') && !rest.starts_with("of ");
    let is_name = is_name || signals::WORDS.contains(&word) && !signals::goes_on(word, rest);
    (!is_name).then_some(word)
}

/// Where the sign stands in `name' = rate` or `name in [low, high]`.
fn row(line: &str, sign: &str) -> Option<usize> {
    let end = line.find(|c: char| !(c.is_ascii_alphanumeric() || c == '_'))?;
    if end == 0 {
        return None;
    }
    // a component, a derivative of a signal, or what something is in another experiment
    let component = if line[end..].starts_with('[') { line[end..].find(']')? + 1 } else { 0 };
    let end = end + component;
    let end = end + line[end..].find(|c: char| !(c.is_ascii_digit() || matches!(c, '@' | '\'')))?;
    let (name, mut rest) = (&line[..end], line[end..].trim_start());
    if sign == "=" && rest.starts_with('+') {
        rest = rest[1..].trim_start();
    } else if sign == "=" && !name.ends_with('\'') {
        rest = rest.strip_prefix('\'')?.trim_start();
    }
    let after = rest.strip_prefix(sign)?;
    let is_word = after.starts_with(|c: char| c.is_ascii_alphanumeric() || c == '_');
    (sign == "=" || !is_word).then(|| line.len() - rest.len())
}

/// Entries begin at the left edge, and what belongs to one stands further in.
fn indent(lines: &mut [Line]) {
    for line in lines {
        match line.kind {
            LineKind::Entry => line.indent = 0,
            LineKind::Row(_) => line.indent = INDENT,
            LineKind::Rest => line.indent = line.indent.max(INDENT),
            LineKind::Comment | LineKind::Empty | LineKind::Quoted => {}
        }
    }
}

/// Puts the signs of neighbouring rows into one column; what goes on below a row moves with its sign.
fn align(lines: &mut [Line]) {
    let mut begin = 0;
    while begin < lines.len() {
        let end = (begin..lines.len())
            .find(|place| matches!(lines[*place].kind, LineKind::Entry))
            .map_or(lines.len(), |entry| entry.max(begin + 1));
        let end = if end == begin { begin + 1 } else { end };
        let name = |line: &Line, place: usize| line.text[..place].trim_end().chars().count();
        let widest = lines[begin..end].iter().filter_map(|line| match line.kind {
            LineKind::Row(place) => Some(name(line, place)),
            _ => None,
        });
        let Some(widest) = widest.max() else {
            begin = end;
            continue;
        };
        let mut shift = 0isize;
        for line in &mut lines[begin..end] {
            match line.kind {
                LineKind::Row(place) => {
                    let before = line.text[..place].chars().count();
                    let pad = " ".repeat(widest - name(line, place) + 1);
                    line.text = format!("{}{pad}{}", line.text[..place].trim_end(), &line.text[place..]);
                    shift = (widest + 1) as isize - before as isize;
                }
                // what is avoided goes on with no row
                LineKind::Rest if line.text.starts_with("avoid") => shift = 0,
                LineKind::Rest => {
                    line.indent = line.indent.saturating_add_signed(shift).max(INDENT);
                }
                LineKind::Entry => shift = 0,
                _ => {}
            }
        }
        begin = end;
    }
}

/// The lines as a text: at most one of them empty at a time, none at the beginning or the end.
fn put_together(lines: &[Line]) -> String {
    let mut out = String::new();
    let mut empty = 0;
    for line in lines {
        match line.kind {
            LineKind::Empty => empty += 1,
            _ => {
                if empty > 0 && !out.is_empty() {
                    out.push('\n');
                }
                empty = 0;
                out.push_str(&" ".repeat(line.indent));
                out.push_str(&line.text);
                out.push('\n');
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn formatted(text: &str) -> String {
        format_text("test.proof", text).unwrap_or_else(|error| panic!("{error}: {text}"))
    }

    /// By hand: columns of '=' and 'in', lines that go on move with the sign above them, one empty line.
    #[test]
    fn lines_stand_where_they_are_to() {
        let text = "\n\n  system \"s\"   \nstate x, long\n\n\n  param set\ndrift f\nx'= long\n     + 1  # why\n  long' =x\nsample\n\
                    x in [0, 1]\n long   in [0, 1]\n avoid x\nclaim 1: x\n= x\n  \"two  \n   lines\"  \n\t# note\n\
                    set \"a\": x = 0\n";
        let wanted = "system \"s\"\nstate x, long\n\nparam set\ndrift f\n  x'    = long\n         + 1  # why\n  long' =x\nsample\n  \
                      x    in [0, 1]\n  long in [0, 1]\n  avoid x\nclaim 1: x\n  = x\n  \"two  \n   lines\"\n  # note\n\
                      set \"a\": x = 0\n";
        assert_eq!(formatted(text), wanted);
        assert_eq!(formatted(wanted), wanted);
    }

    /// By hand: components and ranges are names of rows, and what is avoided stays where it is.
    #[test]
    fn components_are_rows() {
        let text = "system \"s\"\nstate x[1..3]\ndrift f\nx[1]' = x[2]\n  x[i+1]' = -x[i]\n for i in 1..2\nsample\n \
                    x[1..2] in [0, 1]\n  x[3] in [0, 2]\n  avoid x[1]\n";
        let wanted = "system \"s\"\nstate x[1..3]\ndrift f\n  x[1]'   = x[2]\n  x[i+1]' = -x[i]\n  for i in 1..2\nsample\n  \
                      x[1..2] in [0, 1]\n  x[3]    in [0, 2]\n  avoid x[1]\n";
        assert_eq!(formatted(text), wanted);
        assert_eq!(formatted(wanted), wanted);
    }

    /// A word of a view that is a name is one; a bracket that goes on holds no entry; a file that cannot be read is left.
    #[test]
    fn names_and_brackets_are_no_entries() {
        let text = "system \"s\"\nstate map, x\ndrift f\n  map' = x\n  x'   = 1 +\n    map\nlet a = [1, 2;\n  3, 4]\n";
        assert_eq!(formatted(text), text);
        for damaged in ["sistem \"s\"", "system \"s", "system \"s\" claim 1: x ="] {
            assert!(format_text("test.proof", damaged).is_err(), "{damaged}");
        }
    }
}
