//! The searches of all parts together: where the next boxes go, and what is proved of the whole.

use super::part::Part;
use super::search::{Search, Turn};
use dashu::rational::RBig;
use palmistry_math::number::{Interval, RealNumber};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// When to stop.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Limits {
    /// The time to work, explanations at the end included as far as it can be foreseen.
    pub seconds: Option<f64>,
    /// The number of boxes to look at.
    pub boxes: Option<u64>,
}

/// A point of the curve of the proved fraction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// The boxes that were looked at.
    pub boxes: u64,
    /// The time since the start, in s.
    pub seconds: f64,
    /// The proved fraction of the volume, rounded down.
    pub proved: f64,
}

/// The searches of all parts, and where they stand.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Searches {
    pub searches: Vec<Search>,
    /// The part whose turn it is, with what remains of the turn.
    pub turn: Option<(usize, Turn)>,
    pub seconds: f64,
    pub curve: Vec<Progress>,
}

/// The curve has a point wherever the number of boxes has grown by this factor.
const STEP: f64 = 1.25;
/// This many proved boxes are kept before they are sorted to find the largest.
const MOST_UNSORTED: usize = 100_000;
/// The time for which an open box is looked at in the end.
const SECONDS_TO_EXPLAIN: f64 = 2e-6;

impl Searches {
    pub fn new(parts: &[Part]) -> Self {
        Searches {
            searches: parts.iter().map(|part| Search::new(part, Default::default())).collect(),
            turn: None,
            seconds: 0.0,
            curve: Vec::new(),
        }
    }

    /// The boxes that were looked at.
    pub fn boxes(&self) -> u64 {
        self.searches.iter().map(|search| search.boxes).sum()
    }

    /// Whether nothing is left to do.
    pub fn is_finished(&self) -> bool {
        self.searches.iter().all(|search| search.open.is_empty())
    }

    /// The proved part of the volume, exactly: what is proved in each part, multiplied.
    pub fn exact(&self) -> RBig {
        if self.searches.is_empty() {
            return RBig::ZERO;
        }
        self.searches.iter().fold(RBig::ONE, |product, search| product * search.proved.exact())
    }

    /// The same, rounded down.
    pub fn proved(&self) -> f64 {
        Interval::from_rational(&self.exact()).low().max(0.0)
    }

    fn now(&self) -> Progress {
        Progress { boxes: self.boxes(), seconds: self.seconds, proved: self.proved() }
    }

    /// The part whose next boxes promise most. What is open shrinks like a power of the number of boxes, so that the
    /// logarithm of what is proved grows with each further box by about the ratio of these two.
    fn next(&self, deepest: usize) -> Option<(usize, Turn)> {
        let promise = |search: &Search| {
            let proved = search.proved.at_least().max(1e-3);
            (1.0 - proved) / (proved * (search.boxes + 1) as f64)
        };
        let turns = self
            .searches
            .iter()
            .enumerate()
            .filter_map(|(place, search)| search.turn().map(|turn| (promise(search), (place, turn))))
            .filter(|(_, (_, turn))| turn.depth <= deepest);
        turns.reduce(|a, b| if b.0 > a.0 { b } else { a }).map(|(_, next)| next)
    }

    /// Goes on until a limit is reached, nothing is left to do, or an interrupt comes, which ends it before the next box; the block of boxes
    /// that it falls into is open again as a whole. `progress` is called after every block of boxes. What comes out for a number of boxes
    /// depends neither on threads nor on interruptions.
    pub fn run(
        &mut self,
        parts: &[Part],
        limits: Limits,
        interrupt: &AtomicBool,
        progress: &(dyn Fn(Progress) + Sync),
    ) {
        self.run_within(parts, limits, None, interrupt, progress);
    }

    /// The same with boxes of at most so many halvings, all of them: what becomes of a box depends on it alone, so that what comes out then
    /// does not depend on the order in which they are looked at. At the end all boxes are in an order of their own.
    pub fn run_to_depth(
        &mut self,
        parts: &[Part],
        limits: Limits,
        halvings: usize,
        interrupt: &AtomicBool,
        progress: &(dyn Fn(Progress) + Sync),
    ) {
        self.turn = None;
        self.run_within(parts, limits, Some(halvings), interrupt, progress);
        self.sort();
    }

    /// Puts all boxes into the order that depends on nothing but what they are.
    pub fn sort(&mut self) {
        self.turn = None;
        self.searches.iter_mut().for_each(Search::sort);
    }

    fn run_within(
        &mut self,
        parts: &[Part],
        limits: Limits,
        halvings: Option<usize>,
        interrupt: &AtomicBool,
        progress: &(dyn Fn(Progress) + Sync),
    ) {
        let begin = Instant::now();
        let (seconds, boxes) = (self.seconds, self.boxes());
        while !interrupt.load(Ordering::Relaxed) {
            let left =
                limits.boxes.map_or(u64::MAX, |most| boxes.saturating_add(most).saturating_sub(self.boxes()));
            let open: usize = self.searches.iter().map(Search::unproved_boxes).sum();
            let needed = begin.elapsed().as_secs_f64() + SECONDS_TO_EXPLAIN * open as f64;
            if left == 0 || limits.seconds.is_some_and(|most| needed >= most) {
                break;
            }
            let next = self.turn.or_else(|| self.next(halvings.unwrap_or(usize::MAX)));
            let Some((place, turn)) = next else { break };
            let search = &mut self.searches[place];
            let Ok(rest) = search.step(&parts[place], turn, left, halvings.is_some(), interrupt) else {
                break;
            };
            if search.kept.len() > MOST_UNSORTED + search.most_kept {
                search.keep_largest();
            }
            self.turn = rest.map(|rest| (place, rest));
            self.seconds = seconds + begin.elapsed().as_secs_f64();
            let now = self.now();
            if self.curve.last().is_none_or(|last| now.boxes as f64 >= last.boxes as f64 * STEP) {
                self.curve.push(now);
            }
            progress(now);
        }
    }

    /// The curve up to where the search stands.
    pub fn whole_curve(&self) -> Vec<Progress> {
        let mut curve = self.curve.clone();
        let now = self.now();
        if now.boxes > 0 && curve.last().is_none_or(|last| last.boxes < now.boxes) {
            curve.push(now);
        }
        curve
    }
}
