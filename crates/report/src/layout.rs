//! How text is laid out for where it is shown: colours, and lines broken at a width.

use anstyle::{AnsiColor, Style};
use textwrap::{Options, WordSeparator, WordSplitter};

/// Whether text is coloured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Colour {
    /// Characters alone.
    #[default]
    Plain,
    /// With the escape sequences of terminals (ECMA-48).
    Ansi,
}

/// What a colour says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tone {
    /// As expected.
    Good,
    /// Not as expected.
    Bad,
    /// A name that the eye looks for.
    Strong,
    /// What is there for those who look for it.
    Quiet,
}

/// The place where a text is shown. By default a file: no colours, and no line is broken.
#[derive(Clone, Copy, Debug, Default)]
pub struct Layout {
    /// How many columns a line may have, if that is bounded.
    pub width: Option<usize>,
    /// Whether text is coloured.
    pub colour: Colour,
}

/// Lines are never made shorter than this: on a narrower terminal each word would have a line of its own.
const NARROWEST: usize = 40;

impl Layout {
    /// A text in the colour of its tone.
    pub fn paint(&self, tone: Tone, text: &str) -> String {
        let style = match (self.colour, tone) {
            (Colour::Plain, _) => return text.to_owned(),
            (Colour::Ansi, Tone::Good) => Style::new().fg_color(Some(AnsiColor::Green.into())),
            (Colour::Ansi, Tone::Bad) => Style::new().fg_color(Some(AnsiColor::Red.into())).bold(),
            (Colour::Ansi, Tone::Strong) => Style::new().bold(),
            (Colour::Ansi, Tone::Quiet) => Style::new().dimmed(),
        };
        format!("{style}{text}{style:#}")
    }

    /// A text behind what begins its first line; further lines begin `hang` columns from the left. Only blanks are broken
    /// at: a formula without any stays whole, so that it can be copied.
    pub fn wrap(&self, first: &str, hang: usize, text: &str) -> String {
        let Some(width) = self.width else { return format!("{first}{text}").trim_end().to_owned() };
        let rest = " ".repeat(hang);
        let options = Options::new(width.max(NARROWEST))
            .initial_indent(first)
            .subsequent_indent(&rest)
            .break_words(false)
            .word_separator(WordSeparator::AsciiSpace)
            .word_splitter(WordSplitter::NoHyphenation);
        let lines = textwrap::wrap(text, options);
        if lines.is_empty() { first.trim_end().to_owned() } else { lines.join("\n") }
    }
}

/// Columns of an answer that is for people and not searched.
pub(crate) const COLUMNS: usize = 80;

/// Adds a sentence, broken at 80 columns.
pub(crate) fn prose(text: &str, out: &mut String) {
    add("", 2, text, out);
}

/// Adds an entry of a list, broken at 80 columns.
pub(crate) fn item(text: &str, out: &mut String) {
    add("  ", 4, text, out);
}

fn add(first: &str, hang: usize, text: &str, out: &mut String) {
    let layout = Layout { width: Some(COLUMNS), ..Layout::default() };
    out.push_str(&layout.wrap(first, hang, text));
    out.push('\n');
}

/// A text with its longer lines broken at 80 columns; what follows a break stands two columns to the right of the line's own begin. Only blanks are broken
/// at: a name or a formula without any stays whole.
pub(crate) fn in_columns(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for line in text.split_inclusive('\n') {
        let (content, end) = line.strip_suffix('\n').map_or((line, ""), |content| (content, "\n"));
        if content.chars().count() <= COLUMNS {
            out.push_str(line);
            continue;
        }
        let inner = content.trim_start();
        let indent = content.len() - inner.len();
        let layout = Layout { width: Some(COLUMNS), ..Layout::default() };
        out.push_str(&layout.wrap(&" ".repeat(indent), indent + 2, inner));
        out.push_str(end);
    }
    out
}

/// Whether a text fits on one line of 80 columns.
pub(crate) fn fits_a_line(text: &str) -> bool {
    text.chars().count() <= COLUMNS
}

/// A number of things: `1 output`, `2 outputs`.
pub(crate) fn counted<N: std::fmt::Display + PartialEq + From<u8>>(count: N, noun: &str) -> String {
    counted_in(count, noun, &format!("{noun}s"))
}

/// A number of things whose plural is not made with an `s`: `1 box`, `2 boxes`.
pub(crate) fn counted_in<N: std::fmt::Display + PartialEq + From<u8>>(
    count: N,
    one: &str,
    more: &str,
) -> String {
    format!("{count} {}", if count == N::from(1) { one } else { more })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_broken_at_blanks_alone_and_hang() {
        let layout = Layout { width: Some(40), ..Layout::default() };
        let text = "alpha beta gamma delta epsilon zeta eta theta";
        assert_eq!(
            layout.wrap("  left ", 7, text),
            "  left alpha beta gamma delta epsilon\n       zeta eta theta"
        );
        let formula = "x".repeat(60);
        assert_eq!(layout.wrap("  left ", 7, &formula).lines().count(), 1);
        assert_eq!(Layout::default().wrap("  left ", 7, text).lines().count(), 1);
    }

    #[test]
    fn long_lines_are_broken_and_short_ones_kept() {
        let long = ["word"; 30].join(" ");
        let text = format!("a  b\n\n  {long}\n{}", "x".repeat(90));
        let broken = in_columns(&text);
        assert!(broken.starts_with("a  b\n\n  word ") && broken.ends_with(&"x".repeat(90)), "{broken}");
        assert_eq!(broken.lines().filter(|line| line.starts_with("    word")).count(), 1, "{broken}");
        assert_eq!(broken.split_whitespace().count(), text.split_whitespace().count());
        assert_eq!(broken.lines().filter(|line| line.chars().count() > COLUMNS).count(), 1);
    }

    #[test]
    fn colours_take_no_columns() {
        let layout = Layout { width: Some(40), colour: Colour::Ansi };
        let painted = layout.paint(Tone::Bad, "alpha");
        assert_eq!(painted, "\u{1b}[1m\u{1b}[31malpha\u{1b}[0m");
        // 39 columns that are visible fit into 40, and one more word does not
        let line = layout.wrap("", 0, &format!("{painted} beta gamma delta epsilon zeta eta theta"));
        assert_eq!(
            line.lines().next(),
            Some(format!("{painted} beta gamma delta epsilon zeta eta").as_str())
        );
        assert_eq!(Layout::default().paint(Tone::Bad, "alpha"), "alpha");
    }
}
