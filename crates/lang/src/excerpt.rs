//! The lines around a place in a text, as they are shown beside an error: cut where they are long, with everything written out that
//! is not seen by itself. Whatever renders an error gets these lines and not the text: a line of a megabyte costs no more than
//! one of a hundred letters, and the place stays the one that is marked.

use miette::{MietteError, MietteSpanContents, SourceCode, SourceSpan, SpanContents};
use palmistry_io::foreign::shown;
use std::fmt::Write;
use std::ops::Range;

/// How much of a line is shown before the place, and behind it.
const BESIDE: usize = 80;

/// How much of a line is shown at most where the place itself is long.
const MARKED: usize = 120;

/// A line that is no longer than this is shown whole.
const WHOLE: usize = 240;

/// No more lines than these are shown of a place that goes over many.
const LINES: usize = 24;

/// What is shown of a text around a place.
#[derive(Clone, Debug)]
pub(super) struct Excerpt {
    name: String,
    lines: String,
    /// The place in these lines.
    marked: SourceSpan,
    /// The line of the text with which they begin, and that of the place, both counted from zero.
    lines_from: usize,
    line: usize,
    /// The column of the place in its line of the text, in characters, counted from zero.
    column: usize,
}

impl Excerpt {
    /// What to show of a text for a place in it, which is on boundaries of characters.
    pub fn new(name: &str, text: &str, place: Range<usize>) -> Excerpt {
        let begin = text[..place.start].rfind('\n').map_or(0, |end| end + 1);
        let line = text[..begin].bytes().filter(|byte| *byte == b'\n').count();
        let column = text[begin..place.start].chars().count();
        let mut excerpt = Excerpt {
            name: shown(name).into_owned(),
            lines: String::new(),
            marked: SourceSpan::new(0.into(), 0),
            lines_from: line,
            line,
            column,
        };
        let mut from = begin;
        if begin > 0 {
            from = text[..begin - 1].rfind('\n').map_or(0, |end| end + 1);
            excerpt.lines_from = line - 1;
        }
        let (mut marked_from, mut marked_to) = (None, None);
        // the end of a place is within the line of its last character
        let last = place.end.max(place.start + 1) - 1;
        for count in 0.. {
            let end = text[from..].find('\n').map_or(text.len(), |at| from + at);
            let shown = ShownLine::new(&text[from..end], from, &place);
            let base = excerpt.lines.len();
            if (from..=end).contains(&place.start) && marked_from.is_none() && from >= begin {
                marked_from = Some(base + shown.place_of(place.start));
            }
            let is_last = (from..=end).contains(&last) || count + 2 >= LINES;
            if marked_from.is_some() && marked_to.is_none() && is_last {
                marked_to = Some(base + shown.place_of(place.end.min(end)));
            }
            let goes_on = marked_to.is_none() || from <= last && end < text.len();
            excerpt.lines.push_str(&shown.text);
            if end == text.len() {
                break;
            }
            excerpt.lines.push('\n');
            from = end + 1;
            if !goes_on || count >= LINES {
                break;
            }
        }
        let start = marked_from.unwrap_or(0);
        let length = marked_to.unwrap_or(start).saturating_sub(start);
        excerpt.marked = SourceSpan::new(start.into(), length);
        excerpt
    }

    /// The place, within what is shown.
    pub fn marked(&self) -> SourceSpan {
        self.marked
    }
}

impl SourceCode for Excerpt {
    fn read_span<'a>(
        &'a self,
        _: &SourceSpan,
        before: usize,
        after: usize,
    ) -> Result<Box<dyn SpanContents<'a> + 'a>, MietteError> {
        // who asks for the place alone wants to know where it is
        let (line, column) =
            if before + after == 0 { (self.line, self.column) } else { (self.lines_from, 0) };
        let all = SourceSpan::new(0.into(), self.lines.len());
        let count = self.lines.matches('\n').count();
        let data = self.lines.as_bytes();
        Ok(Box::new(MietteSpanContents::new_named(self.name.clone(), data, all, line, column, count)))
    }
}

/// A line as it is shown, and where in it the places of the text are.
struct ShownLine<'t> {
    /// What is shown of the line.
    part: &'t str,
    /// Where in the whole text that begins.
    from: usize,
    /// What stands before it.
    before: usize,
    text: String,
}

impl<'t> ShownLine<'t> {
    fn new(line: &'t str, from: usize, place: &Range<usize>) -> ShownLine<'t> {
        let line = line.strip_suffix('\r').unwrap_or(line);
        let within = |at: usize| super::error::boundary(line, at.saturating_sub(from));
        let (mut start, mut end) = (0, line.len());
        if line.len() > WHOLE {
            let [first, last] = [place.start, place.end].map(within);
            // a place that ends in this line alone is looked at from its end
            let anchor = if place.start < from { last } else { first };
            start = moved_back(line, anchor, BESIDE);
            let marked =
                if place.end > place.start { last.min(moved_on(line, anchor, MARKED)) } else { anchor };
            end = moved_on(line, marked.max(anchor), BESIDE);
        }
        let part = &line[start..end];
        let mut text = String::new();
        if start > 0 {
            let _ = write!(text, "[{} characters] ...", line[..start].chars().count());
        }
        let before = text.len();
        text.push_str(&in_letters(part));
        if end < line.len() {
            let _ = write!(text, "... [{} characters]", line[end..].chars().count());
        }
        ShownLine { part, from: from + start, before, text }
    }

    /// Where a place of the text is in this line; at its edge where it is not shown.
    fn place_of(&self, at: usize) -> usize {
        let within = super::error::boundary(self.part, at.saturating_sub(self.from));
        self.before + in_letters(&self.part[..within]).len()
    }
}

/// Text of a line, with tabs as they are: who renders it knows how wide they are.
fn in_letters(text: &str) -> String {
    text.split('\t').map(shown).collect::<Vec<_>>().join("\t")
}

fn moved_back(line: &str, at: usize, most: usize) -> usize {
    line[..at].char_indices().rev().take(most).last().map_or(at, |(place, _)| place)
}

fn moved_on(line: &str, at: usize, most: usize) -> usize {
    line[at..].char_indices().nth(most).map_or(line.len(), |(place, _)| at + place)
}

/// A message or a label is no longer than this.
const LONGEST_MESSAGE: usize = 1600;

/// A message of no more than some length: a name of a megabyte is named by its beginning and its end. A list of faults has a line for each,
/// which stands behind the bar of the message wherever it is shown.
pub(super) fn message(text: &str) -> String {
    let lines: Vec<_> = text.split('\n').map(shown).collect();
    let text = lines.join("\n");
    let count = text.chars().count();
    if count <= LONGEST_MESSAGE {
        return text;
    }
    let (begin, end) =
        (moved_on(&text, 0, LONGEST_MESSAGE * 3 / 4), moved_back(&text, text.len(), LONGEST_MESSAGE / 4));
    format!("{} ... [{} characters] ... {}", &text[..begin], count - LONGEST_MESSAGE, &text[end..])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn marked(excerpt: &Excerpt) -> &str {
        let begin = excerpt.marked.offset();
        &excerpt.lines[begin..begin + excerpt.marked.len()]
    }

    #[test]
    fn short_lines_are_whole_and_the_place_is_the_one_that_is_meant() {
        let text = "one\ntwo three\nfour\nfive";
        let excerpt = Excerpt::new("a", text, 8..13);
        assert_eq!((marked(&excerpt), excerpt.lines.as_str()), ("three", "one\ntwo three\nfour\n"));
        assert_eq!((excerpt.lines_from, excerpt.line, excerpt.column), (0, 1, 4));
        let excerpt = Excerpt::new("a", text, 4..18);
        assert_eq!(marked(&excerpt), "two three\nfour");
        assert_eq!(Excerpt::new("a", "", 0..0).lines, "");
    }

    /// Wherever the place is in a line of whatever length, it is marked, and what is left out is counted.
    #[test]
    fn long_lines_are_cut_around_the_place() {
        for length in [0, 100, 300, 65_534, 65_536, 300_000] {
            for behind in [0, 100, 100_000] {
                let text = format!("é\n{}MARK{}\nlast", "é".repeat(length), "ß".repeat(behind));
                let at = text.find("MARK").unwrap();
                let excerpt = Excerpt::new("a", &text, at..at + 4);
                assert_eq!((marked(&excerpt), excerpt.line, excerpt.column), ("MARK", 1, length));
                let line = excerpt.lines.lines().nth(1).unwrap();
                assert!(line.chars().count() < WHOLE + 60, "{line}");
                let cut: usize = line
                    .split(['[', ']'])
                    .filter_map(|part| part.strip_suffix(" characters")?.parse::<usize>().ok())
                    .sum();
                let kept = line.chars().filter(|c| "éMARKß".contains(*c)).count();
                assert_eq!(cut + kept, length + 4 + behind, "{line}");
            }
        }
    }

    #[test]
    fn long_places_and_hidden_characters_are_shown_in_part_and_in_letters() {
        let text = format!("x = {}", "a\u{1b}[2Jb".repeat(20_000));
        let excerpt = Excerpt::new("na\nme", &text, 4..text.len());
        assert!(excerpt.lines.len() < 800 && marked(&excerpt).starts_with("a\\u{1b}[2Jb"));
        assert_eq!(excerpt.name, "na\\nme");
        let many = "a\n".repeat(10_000);
        assert!(Excerpt::new("a", &many, 4..many.len()).lines.lines().count() <= LINES + 2);
        assert!(message(&"é".repeat(1 << 20)).chars().count() < LONGEST_MESSAGE + 60);
    }
}
