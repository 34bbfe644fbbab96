//! Lines into a set: exact states at distances 1, 1/2, 1/4, ... from states on the set, and what each way finds at them.

use super::approach::Prepared;
use super::finding::StressFinding;
use super::subject::Subject;
use super::{Mark, StressVerdict, Way};
use dashu::rational::RBig;
use palmistry_math::number::DoubleDouble;
use palmistry_rank::observability::{Coordinate, State};
use std::collections::BTreeSet;

/// What is at the end of a line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum LineLimit {
    /// The ranks at the states on the set, all certified or not.
    Ranks { ranks: BTreeSet<usize>, certified: bool },
    /// There is no rank on the set: a divisor vanishes there, or nothing is certain.
    Pole(String),
    /// The set is at infinity.
    Infinity,
}

/// Where something first happens on the way into the set: a range over the base states.
#[derive(Clone, Debug, PartialEq)]
pub struct First {
    /// The largest distance at which it first happens, over the base states.
    pub distance: f64,
    /// The least one, over those base states at which it happens.
    pub least: f64,
    /// At how many base states it happens.
    pub states: usize,
    /// What is said at the largest distance instead of the truth.
    pub said: String,
}

/// What one way says at states on the set itself, where the rank is another one than around it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct OnTheSet {
    /// The number of states at which it gives the exact rank.
    pub right: usize,
    /// The number of states at which it gives another rank.
    pub wrong: usize,
    /// The number of states at which it is undecided.
    pub open: usize,
    /// The number of states at which it refuses, naming what stands in the way.
    pub refused: usize,
}

impl OnTheSet {
    /// The states that were asked about.
    pub fn states(&self) -> usize {
        self.right + self.wrong + self.open + self.refused
    }

    /// Adds the states of another set.
    pub fn add(&mut self, other: &OnTheSet) {
        self.right += other.right;
        self.wrong += other.wrong;
        self.open += other.open;
        self.refused += other.refused;
    }

    fn count(&mut self, mark: Mark) {
        match mark {
            Mark::Right | Mark::Lost => self.right += 1,
            Mark::Open => self.open += 1,
            Mark::Refused => self.refused += 1,
            Mark::Wrong => self.wrong += 1,
        }
    }
}

/// The results of one way along a line.
#[derive(Clone, Debug, PartialEq)]
pub struct WayOnLine {
    pub way: Way,
    /// The worst of the base states at each distance; `None` where there is no truth to compare with.
    pub marks: Vec<Option<Mark>>,
    /// The digits of the worst entry at each distance, at the worst base state.
    pub digits: Vec<Option<f64>>,
    /// Where the rank is first misreported.
    pub wrong: Option<First>,
    /// Where more than half of the digits are first lost.
    pub lost: Option<First>,
    /// Where it is first undecided.
    pub open: Option<First>,
    /// Where it first refuses, and what it names.
    pub refused: Option<First>,
    /// Its verdicts on the set.
    pub on_the_set: OnTheSet,
}

/// Lines into one set.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    pub title: String,
    /// How the set's conditions were solved, in words: the coordinates that move.
    pub steps: Vec<String>,
    /// From how many states on the set.
    pub states: usize,
    /// The distances, from the largest. For an angle: twice the tangent of half the angle that it lies away.
    pub distances: Vec<f64>,
    /// The true ranks at all points of the lines, and whether each is certified.
    pub ranks: BTreeSet<usize>,
    pub certified: bool,
    /// Points at which there is no truth, since another divisor vanishes.
    pub poles: usize,
    pub end: LineLimit,
    /// In the order of [`Way::ALL`].
    pub ways: Vec<WayOnLine>,
}

/// What every way finds at one point of a line.
#[derive(Clone, Debug)]
pub(super) struct PointOnLine {
    /// The true rank.
    rank: usize,
    certified: bool,
    /// In the order of [`Way::ALL`].
    findings: Vec<MarkedFinding>,
}

/// What a way finds, and how it compares with the truth.
#[derive(Clone, Debug)]
struct MarkedFinding {
    finding: StressFinding,
    mark: Mark,
}

/// The points from one base state, at each distance; `None` where there is no truth.
pub(super) type Walk = Vec<Option<PointOnLine>>;

impl Prepared {
    /// The state at a distance of `2^-halvings` from a base state.
    pub fn at(&self, base: &State, halvings: usize) -> State {
        let distance = RBig::ONE / RBig::from(1u64 << halvings);
        let mut state = base.clone();
        for symbol in &self.moving {
            let Some(value) = state.values.get_mut(symbol) else { continue };
            *value = match &*value {
                Coordinate::Number(_) if self.to_infinity => Coordinate::Number(RBig::ONE / &distance),
                Coordinate::Number(number) => Coordinate::Number(number + &distance),
                Coordinate::Angle { sine, cosine } => {
                    match Coordinate::from_half_tangent(&(&distance / RBig::from(2))) {
                        Coordinate::Angle { sine: s, cosine: c } => Coordinate::Angle {
                            sine: sine * &c + cosine * &s,
                            cosine: cosine * &c - sine * &s,
                        },
                        number => number,
                    }
                }
            };
        }
        state
    }

    /// What all ways find from one base state, at each distance.
    pub fn walk(&self, subject: &Subject, base: &State, halvings: &[usize]) -> Walk {
        let decider = subject.decider();
        halvings
            .iter()
            .map(|halvings| {
                let state = self.at(base, *halvings);
                let truth = subject.truth(&state).ok()?;
                let findings = subject.findings(&decider, &state, &truth, None);
                let marked = findings.into_iter().zip(Way::ALL).map(|(finding, way)| {
                    let mark = finding.mark(way, &truth);
                    MarkedFinding { finding, mark }
                });
                Some(PointOnLine { rank: truth.rank, certified: truth.certified, findings: marked.collect() })
            })
            .collect()
    }

    /// What all ways say at states on the set, in the order of [`Way::ALL`]; nothing at states that have no rank, and nothing
    /// of a set at infinity.
    pub fn on_the_set(&self, subject: &Subject, states: &[State]) -> Vec<OnTheSet> {
        let mut found = vec![OnTheSet::default(); Way::ALL.len()];
        if self.to_infinity {
            return found;
        }
        let decider = subject.decider();
        for state in states {
            let Ok(truth) = subject.truth(state) else { continue };
            let findings = subject.findings(&decider, state, &truth, None);
            for ((finding, way), count) in findings.iter().zip(Way::ALL).zip(&mut found) {
                count.count(finding.mark(way, &truth));
            }
        }
        found
    }

    /// The walks from all base states as one line; `on_the_set` is what [`Prepared::on_the_set`] found.
    pub fn line(
        &self,
        subject: &Subject,
        states: usize,
        halvings: &[usize],
        walks: &[Walk],
        on_the_set: &[OnTheSet],
    ) -> Line {
        let distances: Vec<f64> = halvings.iter().map(|k| 0.5f64.powi(*k as i32)).collect();
        let truths = || walks.iter().flatten().flatten();
        let ways = Way::ALL.iter().map(|way| {
            // for each distance the findings of this way at all base states
            let at = |place: usize| {
                walks.iter().filter_map(move |walk| Some(&walk[place].as_ref()?.findings[way.place()]))
            };
            // where it first happens from each base state, and what is said there
            let range = |happens: &dyn Fn(&MarkedFinding) -> Option<String>| {
                let each = walks.iter().filter_map(|walk| {
                    walk.iter().enumerate().find_map(|(place, found)| {
                        Some((place, happens(&found.as_ref()?.findings[way.place()])?))
                    })
                });
                let each: Vec<(usize, String)> = each.collect();
                let (place, said) = each.iter().min_by_key(|(place, _)| *place)?;
                let last = each.iter().map(|(place, _)| *place).max()?;
                Some(First {
                    distance: distances[*place],
                    least: distances[last],
                    states: each.len(),
                    said: said.clone(),
                })
            };
            let first = |wanted: Mark| range(&|found| (found.mark == wanted).then(|| found.finding.said()));
            // a rank may be wrong and the digits lost at once, so that digits are asked for themselves
            let lost = range(&|found| {
                let digits = found.finding.digits.filter(|digits| *digits < way.digits() / 2.0)?;
                Some(format!("{digits:.1} digits"))
            });
            WayOnLine {
                way: *way,
                marks: (0..distances.len()).map(|place| at(place).map(|found| found.mark).max()).collect(),
                digits: (0..distances.len())
                    .map(|place| at(place).filter_map(|found| found.finding.digits).reduce(f64::min))
                    .collect(),
                wrong: first(Mark::Wrong),
                lost,
                open: first(Mark::Open),
                refused: first(Mark::Refused),
                on_the_set: on_the_set.get(way.place()).copied().unwrap_or_default(),
            }
        });
        Line {
            title: self.title.clone(),
            steps: self.steps.clone(),
            states,
            ranks: truths().map(|point| point.rank).collect(),
            certified: truths().all(|point| point.certified),
            poles: walks.iter().flatten().filter(|truth| truth.is_none()).count(),
            end: self.end(subject, states),
            ways: ways.collect(),
            distances,
        }
    }

    fn end(&self, subject: &Subject, states: usize) -> LineLimit {
        if self.to_infinity {
            return LineLimit::Infinity;
        }
        let mut ranks = BTreeSet::new();
        let mut certified = true;
        for base in self.bases.iter().take(states) {
            match subject.truth(base) {
                Ok(truth) => {
                    ranks.insert(truth.rank);
                    certified &= truth.certified;
                }
                Err(pole) => return LineLimit::Pole(pole),
            }
        }
        LineLimit::Ranks { ranks, certified }
    }
}

impl StressFinding {
    /// The verdict as text.
    pub fn said(&self) -> String {
        match &self.verdict {
            StressVerdict::Rank(rank) => format!("rank {rank}"),
            StressVerdict::AtLeast(least) => format!("at least {least}"),
            StressVerdict::Refused(why) => why.clone(),
        }
    }

    /// What is rounded to zero on the way to a wrong rank, if anything is.
    pub(super) fn rounded(subject: &Subject, state: &State, way: Way) -> Option<String> {
        match way {
            Way::Single => subject.rounded_to_zero::<f32>(state),
            Way::Customary | Way::Double => subject.rounded_to_zero::<f64>(state),
            Way::DoubleDouble => subject.rounded_to_zero::<DoubleDouble>(state),
            Way::AlwaysFull | Way::Radii | Way::Interval | Way::Escalation => None,
        }
    }
}
