//! A search as text, to be taken up again.
//!
//! The first line names the format, the second the question; then come the counts and the open boxes, a line each, and
//! last the number of lines and a checksum, so that a file that was cut or changed is noticed. A box is written as the
//! index and the depth of each of its sides; an open one with the factors that are known to vanish nowhere in it, a proved
//! one (of these the largest) with its minor.

use super::boxes::{DEEPEST, Side, Volume};
use super::progress::{Progress, Searches};
use super::region::Region;
use super::search::{Cell, ProvedCell, Search, Turn};
use palmistry_io::file::Checksum;
use std::collections::{BTreeMap, VecDeque};
use std::fmt::Write;

const FORMAT: &str = "palmistry region 1";

impl Region {
    /// What the boxes mean: all sides, tapes and lists, to the last bit.
    pub(super) fn fingerprint(&self) -> u64 {
        let mut hash = Checksum::default();
        hash.add(env!("CARGO_PKG_VERSION"));
        let problem = &self.problem;
        hash.add(&format!(
            "{} {} {:?} {:?};",
            problem.file, problem.dimension, problem.order, problem.nowhere
        ));
        hash.add(&format!("{:?} {:?};", problem.ranges, problem.minors));
        for part in &problem.parts {
            for coordinate in part.chart.coordinates() {
                hash.add(&format!("{} {} {};", coordinate.name, coordinate.low, coordinate.high));
            }
            // tapes name slots by number: which coordinate these are, and which function of it, belongs to their meaning
            hash.add(&format!("{:?};", part.chart.slots()));
            for factor in &part.factors {
                hash.add(&format!(
                    "{} {:?} {:?} {:?};",
                    factor.text, factor.tape, factor.witnesses, factor.need
                ));
            }
            hash.add(&format!("{:?} {:?} {:?}", part.guards, part.common, part.alternatives));
        }
        hash.add(&format!("{:?}", self.map));
        hash.value()
    }

    /// Where the search stands, as text.
    pub fn saved(&self) -> String {
        let searches = &self.searches;
        let mut text =
            format!("{FORMAT}\nquestion {:016x}\nseconds {}\n", self.fingerprint(), searches.seconds);
        if let Some((part, turn)) = &searches.turn {
            let _ = writeln!(text, "turn {part} {} {}", turn.depth, turn.boxes);
        }
        for point in &searches.curve {
            let _ = writeln!(text, "curve {} {} {}", point.boxes, point.seconds, point.proved);
        }
        write_boxes(searches, &mut text);
        sealed(text)
    }

    /// Takes up a search where a text says that it stood.
    ///
    /// # Errors
    /// In words: the text is no saved search, is damaged, or belongs to another question.
    pub fn resume(&mut self, text: &str) -> Result<(), String> {
        let body = unsealed(text, FORMAT)?;
        if body.lines().nth(1) != Some(format!("question {:016x}", self.fingerprint()).as_str()) {
            return Err(OTHER_QUESTION.to_owned());
        }
        let found = self.read_lines(body, 2)?;
        let fits = found.searches.len() == self.searches.searches.len()
            && found.turn.is_none_or(|(part, _)| part < found.searches.len())
            && found.searches.iter().all(fills_the_box);
        if !fits {
            return Err("the saved search does not cover the box: it was changed".to_owned());
        }
        self.searches = found;
        Ok(())
    }

    /// What the lines of a text say, but for the first of them.
    pub(super) fn read_lines(&self, body: &str, after: usize) -> Result<Searches, String> {
        let mut reader = Reader { region: self, found: Searches::new(&[]) };
        for (number, line) in body.lines().enumerate().skip(after) {
            reader.line(line).ok_or_else(|| damaged(number + 1))?;
        }
        Ok(reader.found)
    }
}

/// Why a text of this format is refused.
pub(super) const OTHER_QUESTION: &str = "the saved search belongs to another question: another file, box, choice of rows or map, \
                                         or another version of this program";

fn damaged(line: usize) -> String {
    format!("the saved search is damaged at line {line}: it was cut or changed")
}

/// A text with its number of lines and its checksum.
pub(super) fn sealed(mut text: String) -> String {
    let (lines, sum) = (text.lines().count(), Checksum::of(&text));
    let _ = writeln!(text, "end {lines} {sum:016x}");
    text
}

/// A text of a format without these.
pub(super) fn unsealed<'t>(text: &'t str, format: &str) -> Result<&'t str, String> {
    if text.lines().next() != Some(format) {
        return Err("this is no saved search of 'certify' (its first line is another)".to_owned());
    }
    let (body, end) = text.trim_end_matches('\n').rsplit_once('\n').ok_or_else(|| damaged(1))?;
    let body = &text[..body.len() + 1];
    let lines = body.lines().count();
    if end != format!("end {lines} {:016x}", Checksum::of(body)) {
        return Err(damaged(lines + 1));
    }
    Ok(body)
}

/// The boxes of all parts, a line each.
pub(super) fn write_boxes(searches: &Searches, text: &mut String) {
    for search in &searches.searches {
        let _ = write!(text, "part {} proved", search.boxes);
        for count in search.proved.counts() {
            let _ = write!(text, " {count}");
        }
        text.push('\n');
        for [x, y] in &search.sections {
            let _ = writeln!(text, "section {}/{} {}/{}", x.index, x.depth, y.index, y.depth);
        }
        for cell in &search.kept {
            let _ = match cell.minor {
                Some(minor) => write!(text, "box {minor}"),
                None => write!(text, "box -"),
            };
            for side in &cell.sides {
                let _ = write!(text, " {}/{}", side.index, side.depth);
            }
            text.push('\n');
        }
        for (word, cells) in [("left", search.left.iter().collect::<Vec<_>>()), ("open", open(search))] {
            for cell in cells {
                let _ = write!(text, "{word} {:x}", cell.known);
                for side in &cell.sides {
                    let _ = write!(text, " {}/{}", side.index, side.depth);
                }
                text.push('\n');
            }
        }
    }
}

pub(super) fn open(search: &Search) -> Vec<&Cell> {
    search.open.values().flatten().collect()
}

/// Whether proved, open and left boxes together have the volume of the box.
fn fills_the_box(search: &Search) -> bool {
    let mut volume = search.proved.clone();
    search.unproved().iter().for_each(|cell| volume.add(cell.depth()));
    volume.exact().is_one()
}

/// Reads a saved search, line by line.
struct Reader<'a> {
    region: &'a Region,
    found: Searches,
}

impl Reader<'_> {
    fn line(&mut self, line: &str) -> Option<()> {
        let mut words = line.split(' ');
        let word = words.next()?;
        match word {
            "seconds" => self.found.seconds = words.next()?.parse().ok().filter(|s: &f64| s.is_finite())?,
            "turn" => {
                let mut number = || words.next()?.parse::<usize>().ok();
                self.found.turn = Some((number()?, Turn { depth: number()?, boxes: number()? }));
            }
            "curve" => {
                let boxes = words.next()?.parse().ok()?;
                let mut number = || words.next()?.parse::<f64>().ok();
                self.found.curve.push(Progress { boxes, seconds: number()?, proved: number()? });
            }
            "part" => {
                let boxes = words.next()?.parse().ok()?;
                words.next().filter(|word| *word == "proved")?;
                let counts: Option<Vec<u64>> = words.by_ref().map(|count| count.parse().ok()).collect();
                let known = self.region.searches.searches.get(self.found.searches.len())?;
                self.found.searches.push(Search {
                    open: BTreeMap::new(),
                    left: Vec::new(),
                    proved: Volume::from_counts(counts?),
                    kept: Vec::new(),
                    most_kept: known.most_kept,
                    boxes,
                    plane: known.plane,
                    sections: Vec::new(),
                });
            }
            "section" => {
                let section = [side(words.next()?)?, side(words.next()?)?];
                self.found.searches.last_mut()?.sections.push(section);
            }
            "box" => {
                let part = self.region.problem.parts.get(self.found.searches.len().checked_sub(1)?)?;
                let minor = match words.next()? {
                    "-" => None,
                    number => Some(number.parse().ok().filter(|m| *m < self.region.problem.minors.len())?),
                };
                let sides: Option<Box<[Side]>> = words.by_ref().map(side).collect();
                let sides = sides.filter(|sides| sides.len() == part.chart.coordinates().len())?;
                self.found.searches.last_mut()?.kept.push(ProvedCell { sides, minor });
            }
            "open" | "left" => {
                let part = self.region.problem.parts.get(self.found.searches.len().checked_sub(1)?)?;
                let known = u128::from_str_radix(words.next()?, 16).ok()?;
                let sides: Option<Box<[Side]>> = words.by_ref().map(side).collect();
                let cell = Cell { sides: sides?, known };
                if cell.sides.len() != part.chart.coordinates().len() {
                    return None;
                }
                let search = self.found.searches.last_mut()?;
                match word {
                    "open" => search.open.entry(cell.depth()).or_insert_with(VecDeque::new).push_back(cell),
                    _ => search.left.push(cell),
                }
            }
            _ => return None,
        }
        words.next().is_none().then_some(())
    }
}

fn side(word: &str) -> Option<Side> {
    let (index, depth) = word.split_once('/')?;
    let side = Side { index: index.parse().ok()?, depth: depth.parse().ok()? };
    (side.depth <= DEEPEST && side.index >> side.depth == 0).then_some(side)
}
