//! The open boxes of a search, dealt out to several searchers, and what they found put together again: the proved volume is exact,
//! since boxes are dealt each to one.

use super::boxes::Volume;
use super::journal::{OTHER_QUESTION, open, sealed, unsealed, write_boxes};
use super::progress::Searches;
use super::region::Region;
use super::search::{Cell, Search};
use palmistry_io::file::Checksum;
use std::collections::BTreeMap;

const FORMAT: &str = "palmistry region part 1";

/// What one of several searchers has found on its share of the open boxes.
#[derive(Clone, Debug, PartialEq)]
pub struct RegionPart {
    /// The search whose boxes were dealt out.
    base: u64,
    /// Which share, counted from one, and of how many.
    number: u64,
    of: u64,
    searches: Searches,
}

/// The open boxes of a share: one in so many, in the order in which they are looked at, so that each has large ones and small ones.
fn dealt(search: &Search, number: u64, of: u64) -> Vec<Cell> {
    let mine = |place: usize| place as u64 % of.max(1) == number.saturating_sub(1);
    let cells = open(search).into_iter().enumerate();
    cells.filter(|(place, _)| mine(*place)).map(|(_, cell)| cell.clone()).collect()
}

fn volume_of<'c>(cells: impl IntoIterator<Item = &'c Cell>) -> Volume {
    let mut volume = Volume::default();
    cells.into_iter().for_each(|cell| volume.add(cell.depth()));
    volume
}

impl Search {
    /// These boxes, open, and nothing else.
    fn of_boxes(&self, cells: Vec<Cell>) -> Search {
        let mut open: BTreeMap<usize, _> = BTreeMap::new();
        for cell in cells {
            open.entry(cell.depth()).or_insert_with(std::collections::VecDeque::new).push_back(cell);
        }
        Search {
            open,
            left: Vec::new(),
            proved: Volume::default(),
            kept: Vec::new(),
            most_kept: self.most_kept,
            boxes: 0,
            plane: self.plane,
            sections: Vec::new(),
        }
    }

    /// What a share of its boxes has become.
    fn append(&mut self, share: Search) {
        for (depth, cells) in share.open {
            self.open.entry(depth).or_default().extend(cells);
        }
        self.left.extend(share.left);
        self.proved.merge(&share.proved);
        self.kept.extend(share.kept);
        self.boxes = self.boxes.saturating_add(share.boxes);
        self.sections.extend(share.sections);
    }
}

impl Region {
    /// Where the search stands, as a number.
    pub fn standing_sum(&self) -> u64 {
        Checksum::of(&self.saved())
    }

    /// Of the open boxes the share of a number, counted from one; nothing else is searched from here on.
    ///
    /// Returns the number that [`Region::part_text`] needs.
    pub fn take_share(&mut self, number: u64, of: u64) -> u64 {
        let base = self.standing_sum();
        for search in &mut self.searches.searches {
            *search = search.of_boxes(dealt(search, number, of));
        }
        (self.searches.turn, self.searches.seconds) = (None, 0.0);
        self.searches.curve.clear();
        base
    }

    /// The result of a share, as text; it contains no times.
    pub fn part_text(&self, base: u64, number: u64, of: u64) -> String {
        let question = self.fingerprint();
        let mut text = format!("{FORMAT}\nquestion {question:016x} {base:016x} {number} {of}\n");
        write_boxes(&self.searches, &mut text);
        sealed(text)
    }

    /// Reads a part of this search.
    ///
    /// # Errors
    /// In words: the text is no part, is damaged, or belongs to another question.
    pub fn read_part(&self, text: &str) -> Result<RegionPart, String> {
        let body = unsealed(text, FORMAT)?;
        let mut words = body.lines().nth(1).unwrap_or_default().split(' ').skip(1);
        let mut number = |radix| words.next().and_then(|word| u64::from_str_radix(word, radix).ok());
        let head = (number(16), number(16), number(10), number(10));
        let (Some(question), Some(base), Some(number), Some(of)) = head else {
            return Err("the saved search is damaged at line 2: it was cut or changed".to_owned());
        };
        if question != self.fingerprint() {
            return Err(OTHER_QUESTION.to_owned());
        }
        let searches = self.read_lines(body, 2)?;
        Ok(RegionPart { base, number, of, searches })
    }

    /// Puts all shares together again.
    ///
    /// # Errors
    /// In words, with the names of the parts: shares are missing or there twice, were dealt by another search or to others, or are not
    /// what was dealt.
    pub fn merge(&mut self, parts: Vec<(String, RegionPart)>) -> Result<(), String> {
        let base = self.standing_sum();
        let of = parts.first().map(|(_, part)| part.of).ok_or("there are no parts")?;
        let mut shares: BTreeMap<u64, (String, Searches)> = BTreeMap::new();
        for (name, part) in parts {
            if part.base != base {
                return Err(format!("{name} is a share of another search than the one that '--state' names"));
            }
            if part.of != of || !(1..=of).contains(&part.number) {
                return Err(format!("{name} is one of {} shares, and others are of {of}", part.of));
            }
            if let Some((other, _)) = shares.get(&part.number) {
                return Err(format!("{other} and {name} are the same share, {} of {of}", part.number));
            }
            shares.insert(part.number, (name, part.searches));
        }
        if let Some(missing) = (1..=of).find(|number| !shares.contains_key(number)) {
            return Err(format!("share {missing} of {of} is missing"));
        }
        let mut merged = self.searches.clone();
        let open: Vec<Search> = merged.searches.clone();
        merged.searches.iter_mut().for_each(|search| search.open.clear());
        for (number, (name, share)) in shares {
            let is_dealt = |(search, found): (&Search, &Search)| {
                let mut volume = found.proved.clone();
                volume.merge(&volume_of(found.unproved()));
                volume.exact() == volume_of(&dealt(search, number, of)).exact()
            };
            let fits = share.searches.len() == open.len() && open.iter().zip(&share.searches).all(is_dealt);
            if !fits {
                return Err(format!("{name} does not have the boxes that were dealt to it: it was changed"));
            }
            for (search, found) in merged.searches.iter_mut().zip(share.searches) {
                search.append(found);
            }
        }
        // in the order of a search to a depth
        merged.sort();
        self.searches = merged;
        Ok(())
    }
}

impl RegionPart {
    /// Whether it is a share of the search that stands at a sum.
    pub fn is_of(&self, base: u64) -> bool {
        self.base == base
    }
}
