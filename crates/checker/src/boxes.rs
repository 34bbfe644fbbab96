//! A certificate, box by box: full rank at every state of a box, shown again by plain interval arithmetic.

use super::doubt::{Doubt, Effort, Finding, Missing};
use super::listing::{Listing, Step};
use super::piece::{Cover, Piece};
use super::state::Ratio;
use super::witness::Requirement;
use dashu::rational::RBig;
use palmistry_math::number::{Interval, RealNumber};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeSet, HashMap};
use std::sync::atomic::{AtomicBool, Ordering};

/// Where a symbol lies: between two exact ends, or at one value where these are the same.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SymbolRange {
    /// The symbol by its name.
    pub symbol: String,
    /// Whether it is an angle, in radians: for those who read the file; it changes no value.
    pub angle: bool,
    /// The lower end.
    pub low: Ratio,
    /// The upper end.
    pub high: Ratio,
}

/// A box at every state of which the rank is full.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CertifiedBox {
    /// Low and high end, for each of the ranges that have a width, in their order.
    pub sides: Vec<[Ratio; 2]>,
    /// As many rows as there are columns, whose determinant is zero nowhere in the box.
    pub rows: Vec<usize>,
}

/// Boxes on which some rows have full rank.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CertifiedBoxes {
    /// The operations, inputs first.
    pub listing: Listing,
    /// What the columns stand for: the names of the states.
    pub columns: Vec<String>,
    /// What the rows stand for: Lie derivatives, or rows of the file's own.
    pub row_names: Vec<String>,
    /// The entries, as places of the listing; a row for each name.
    pub rows: Vec<Vec<usize>>,
    /// Where the rows, and the system that they are rows of, exist.
    pub requirements: Vec<Requirement>,
    /// The sides of the whole box, and the ranges or values of the other symbols.
    pub ranges: Vec<SymbolRange>,
    /// The boxes, each with the rows of its minor.
    pub boxes: Vec<CertifiedBox>,
    /// The fraction of the whole box that these boxes cover.
    pub volume: Ratio,
    /// How many boxes were proved in all.
    pub proved_boxes: Ratio,
    /// The fraction of the whole box that all proved boxes cover.
    pub proved_volume: Ratio,
    /// A digest of all else, by which a file that was changed by hand is noticed. It is no signature.
    pub digest: String,
}

/// No more slopes are kept for a piece: they take some sixty megabytes.
const MOST_SLOPES: usize = 1 << 22;
/// No box is divided into more pieces.
const MOST_PIECES: usize = 4096;

impl CertifiedBoxes {
    /// Checks every box, and that together they are what they are said to be.
    pub fn check(&self, effort: &Effort, interrupt: &AtomicBool) -> Finding {
        match self.try_check(effort, interrupt) {
            Ok(times) => Finding::Confirmed { times },
            Err(doubt) => Finding::NotConfirmed(doubt),
        }
    }

    fn try_check(&self, effort: &Effort, interrupt: &AtomicBool) -> Result<usize, Doubt> {
        if self.boxes.is_empty() {
            return Err(Doubt::Empty);
        }
        if self.digest != self.digest_of_the_rest() {
            return Err(Doubt::DigestDiffers);
        }
        let free = self.check_shape()?;
        self.check_volume(&free, effort)?;
        let cover = self.cover(&free)?;
        let check = |(index, found): (usize, &CertifiedBox)| {
            if interrupt.load(Ordering::Relaxed) {
                return Some(Doubt::Interrupted);
            }
            self.check_box(&cover, index, found, effort).err()
        };
        match self.boxes.par_iter().enumerate().find_map_first(check) {
            Some(doubt) => Err(doubt),
            None => Ok(self.boxes.len()),
        }
    }

    /// What was confirmed, as text.
    pub fn in_words(&self) -> String {
        format!(
            "full rank shown again on {} boxes, {} of the whole volume",
            self.boxes.len(),
            part_in_words(&self.volume.0)
        )
    }

    /// The ranges that have a width.
    ///
    /// # Errors
    /// Where rows, ranges and boxes do not fit together.
    fn check_shape(&self) -> Result<Vec<&SymbolRange>, Doubt> {
        let steps = self.listing.steps();
        let ragged = self.columns.is_empty()
            || self.rows.len() != self.row_names.len()
            || self.rows.iter().any(|row| row.len() != self.columns.len());
        if ragged {
            return Err(Doubt::Ragged);
        }
        let places = self.rows.iter().flatten().chain(self.requirements.iter().map(|r| &r.step));
        if places.into_iter().any(|place| *place >= steps.len()) {
            return Err(Doubt::NoSuchStep);
        }
        let names: BTreeSet<&str> = self.ranges.iter().map(|range| range.symbol.as_str()).collect();
        let missing = |step: &&Step| matches!(step, Step::Symbol(name) if !names.contains(name.as_str()));
        if names.len() != self.ranges.len()
            || steps.iter().any(|step| missing(&step))
            || self.ranges.iter().any(|range| range.low.0 > range.high.0)
        {
            return Err(Doubt::NoRange);
        }
        let free: Vec<&SymbolRange> = self.ranges.iter().filter(|range| range.low.0 < range.high.0).collect();
        for (index, found) in self.boxes.iter().enumerate() {
            let inside = |(range, [low, high]): (&&SymbolRange, &[Ratio; 2])| {
                range.low.0 <= low.0 && low.0 < high.0 && high.0 <= range.high.0
            };
            if found.sides.len() != free.len() || !free.iter().zip(&found.sides).all(inside) {
                return Err(Doubt::BoxOutside(index));
            }
            let distinct: BTreeSet<usize> =
                found.rows.iter().copied().filter(|row| *row < self.rows.len()).collect();
            if found.rows.len() != self.columns.len() || distinct.len() != self.columns.len() {
                return Err(Doubt::BoxWithoutMinor(index));
            }
        }
        Ok(free)
    }

    /// Whether no two boxes have more than an edge in common, and all together have the volume that is given.
    fn check_volume(&self, free: &[&SymbolRange], effort: &Effort) -> Result<(), Doubt> {
        let apart = |a: &CertifiedBox, b: &CertifiedBox| {
            let mut sides = a.sides.iter().zip(&b.sides);
            sides.any(|([low, high], [other_low, other_high])| high.0 <= other_low.0 || other_high.0 <= low.0)
        };
        for (index, found) in self.boxes.iter().enumerate() {
            effort.spend((index * free.len().max(1)) as u64)?;
            if let Some(other) = self.boxes[..index].iter().position(|other| !apart(found, other)) {
                return Err(Doubt::BoxesOverlap { first: other, second: index });
            }
        }
        let volume = part_of_the_whole(free, self.boxes.iter());
        let more = RBig::from(self.boxes.len()) <= self.proved_boxes.0
            && volume <= self.proved_volume.0
            && self.proved_volume.0 <= RBig::ONE;
        if volume == self.volume.0 && more { Ok(()) } else { Err(Doubt::VolumeDiffers) }
    }

    /// The listing, ready to be evaluated on boxes.
    fn cover(&self, free: &[&SymbolRange]) -> Result<Cover<'_>, Doubt> {
        if self.listing.steps().len().saturating_mul(free.len()) > MOST_SLOPES {
            return Err(Doubt::NoValue(Missing::Effort));
        }
        let places: HashMap<&str, usize> =
            free.iter().enumerate().map(|(place, range)| (range.symbol.as_str(), place)).collect();
        let held: HashMap<&str, Interval> = self
            .ranges
            .iter()
            .filter(|range| range.low.0 == range.high.0)
            .map(|range| (range.symbol.as_str(), Interval::from_rational(&range.low.0)))
            .collect();
        Cover::new(
            &self.listing,
            free.len(),
            |name| places.get(name).copied(),
            |name| held.get(name).copied(),
        )
        .ok_or(Doubt::NoRange)
    }

    /// Divides a box until the determinant of its rows is shown to differ from zero on each piece.
    fn check_box(
        &self,
        cover: &Cover<'_>,
        index: usize,
        found: &CertifiedBox,
        effort: &Effort,
    ) -> Result<(), Doubt> {
        let minor: Vec<&[usize]> = found.rows.iter().map(|row| self.rows[*row].as_slice()).collect();
        let needed =
            cover.needed(minor.iter().copied().flatten().chain(self.requirements.iter().map(|r| &r.step)));
        let whole = found
            .sides
            .iter()
            .map(|[low, high]| Interval::from_rational(&low.0).hull(Interval::from_rational(&high.0)));
        let mut open: Vec<Vec<Interval>> = vec![whole.collect()];
        let mut pieces = 0;
        let cost = needed.cost() + (minor.len() as u64).pow(3).saturating_mul(2 + found.sides.len() as u64);
        while let Some(sides) = open.pop() {
            pieces += 1;
            if pieces > MOST_PIECES {
                return Err(Doubt::BoxNotShown(index));
            }
            effort.spend(cost)?;
            match cover.piece(&needed, &sides, &minor, &self.requirements) {
                Piece::Shown => {}
                Piece::Missing { requirement } => {
                    return Err(Doubt::MissingInBox { index, requirement });
                }
                Piece::Open { steepest: Some(side) } => {
                    let (low, high) = sides[side].split();
                    for half in [low, high] {
                        let mut piece = sides.clone();
                        piece[side] = half;
                        open.push(piece);
                    }
                }
                Piece::Open { steepest: None } => return Err(Doubt::BoxNotShown(index)),
            }
        }
        Ok(())
    }

    /// Leaves out the boxes that this check does not confirm with the work that each of them may take, and notes the volume
    /// of the others; returns how many were left out. What is written can then be confirmed again; but a box in which
    /// the rows do not exist stays, so that whoever checks notices the fault.
    pub fn keep_what_is_shown(&mut self, effort_of_each: u64, interrupt: &AtomicBool) -> usize {
        let before = self.boxes.len();
        let Some((shown, volume)) = self.what_is_shown(effort_of_each, interrupt) else { return 0 };
        let mut places = shown.into_iter();
        self.boxes.retain(|_| places.next() == Some(true));
        self.volume = Ratio(volume);
        self.digest = self.digest_of_the_rest();
        before - self.boxes.len()
    }

    /// Which boxes stay, and their part of the whole.
    fn what_is_shown(&self, effort_of_each: u64, interrupt: &AtomicBool) -> Option<(Vec<bool>, RBig)> {
        let free = self.check_shape().ok()?;
        let cover = self.cover(&free).ok()?;
        let shown = |(index, found): (usize, &CertifiedBox)| {
            let check = || self.check_box(&cover, index, found, &Effort::new(effort_of_each));
            !interrupt.load(Ordering::Relaxed) && matches!(check(), Ok(()) | Err(Doubt::MissingInBox { .. }))
        };
        let shown: Vec<bool> = self.boxes.par_iter().enumerate().map(shown).collect();
        let kept = self.boxes.iter().zip(&shown).filter(|(_, shown)| **shown).map(|(found, _)| found);
        let volume = part_of_the_whole(&free, kept);
        Some((shown, volume))
    }

    /// The digest that fits all else: the hash of Fowler, Noll and Vo (variant 1a, 64 bits) of its JSON.
    pub fn digest_of_the_rest(&self) -> String {
        let rest = CertifiedBoxes { digest: String::new(), ..self.clone() };
        let text = serde_json::to_string(&rest).unwrap_or_default();
        let hash = text.bytes().fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
        });
        format!("{hash:016x}")
    }
}

/// A part of the whole, rounded down.
fn part_in_words(part: &RBig) -> String {
    let millionths = (part * RBig::from(1_000_000)).floor();
    let millionths = u64::try_from(millionths).unwrap_or(0);
    format!("{}.{:06}", millionths / 1_000_000, millionths % 1_000_000)
}

/// What part of the whole box some boxes make that do not overlap.
fn part_of_the_whole<'b>(free: &[&SymbolRange], boxes: impl Iterator<Item = &'b CertifiedBox>) -> RBig {
    let of_box = |found: &CertifiedBox| {
        let sides = free.iter().zip(&found.sides);
        let parts = sides.map(|(range, [low, high])| (&high.0 - &low.0) / (&range.high.0 - &range.low.0));
        parts.fold(RBig::ONE, |product, part| product * part)
    };
    boxes.map(of_box).fold(RBig::ZERO, |sum, volume| sum + volume)
}
