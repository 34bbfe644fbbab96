//! A system prepared for the extremes, and taken to them.

use super::super::landscape::LandscapeRows;
use super::approach::{Approach, Prepared, approaches_of};
use super::changes::{unit_quantities, units};
use super::line::{Line, OnTheSet, Walk};
use super::scaling::{Quantity, Scaling};
use super::subject::Subject;
use super::units::{Conditioning, Rescaling, Seen, UnitsRow, conditioning, in_units};
use palmistry_lang::{Assignment, Range, System, Value};
use palmistry_math::expression::{NodeId, Symbol};
use palmistry_rank::observability::{Branch, Codistribution, Length, Locus, OWN_ROWS, State};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};

/// Distances are `2^-k` for `k` from 0 to this: down to 8.9e-16.
const MOST_HALVINGS: usize = 50;

/// States on each set at which it is asked what every way says there.
const STATES_ON_THE_SET: u64 = 20;

/// Distances from the sets, in halvings, at which it is asked how states are conditioned: 1e-3, 1e-6, 1e-9.
const NEAR: [usize; 3] = [10, 20, 30];
/// For the conditioning so many times the states of the box are drawn: a spectrum costs little.
const MORE_FOR_CONDITIONING: u64 = 20;

/// How many states and points a run takes.
#[derive(Clone, Copy)]
pub struct StressOptions<'a> {
    pub seed: u64,
    /// Base states on each set, from which lines go.
    pub states: u64,
    /// Every so many halvings of the distance a point; one is 3.3 points a decade.
    pub step: usize,
    /// States of the sample box for the units and the conditioning.
    pub samples: u64,
    /// States on each set for the same.
    pub samples_on_sets: u64,
    /// Set from outside to stop early; what was finished is kept.
    pub interrupt: &'a AtomicBool,
    /// Called with every step that is done.
    pub progress: &'a (dyn Fn() + Sync),
}

/// What was found of one system.
#[derive(Clone, Debug, PartialEq)]
pub struct StressStudy {
    pub file: String,
    pub title: String,
    /// Which rows were taken, in words.
    pub rows: String,
    pub dimension: usize,
    /// What is drawn from a range that the file does not give, and this range.
    pub by_default: Vec<(String, Range)>,
    /// Rows and columns that remain without unit rows.
    pub remaining: (usize, usize),
    pub lines: Vec<Line>,
    /// Sets to which there are no lines, and why.
    pub skipped: Vec<(String, String)>,
    pub scalings: Vec<Scaling>,
    /// In the file's own units first.
    pub units: Vec<UnitsRow>,
    /// Of states of the box, and of states on the sets and near them.
    pub conditioning: Conditioning,
    pub conditioning_near: Conditioning,
    pub interrupted: bool,
}

/// A system with its rows and the sets to walk into, states on them drawn.
pub struct Stress {
    subject: Subject,
    rows: String,
    lines: Vec<Prepared>,
    skipped: Vec<(String, String)>,
    quantities: Vec<Quantity>,
    units: Vec<(String, Rescaling)>,
    box_states: Locus,
}

/// Rows of a system.
#[derive(Clone, Debug)]
pub struct NamedRows {
    /// What they are, in words.
    pub name: String,
    /// Entry after entry.
    pub entries: Vec<NodeId>,
}

/// The name and the entries of a system's rows: its own choice, if it defines one and it is wanted, or else the
/// differentials of its outputs and of their Lie derivatives.
///
/// # Errors
/// In words: no states or outputs, a pole everywhere.
pub fn rows_of(system: &mut System, wanted: LandscapeRows) -> Result<NamedRows, String> {
    if system.unknown_count() == 0 || system.outputs.is_empty() {
        return Err(format!("{} declares no states or no outputs", system.name));
    }
    match system.definition(OWN_ROWS) {
        Some(Value::Matrix(matrix))
            if wanted == LandscapeRows::Own && matrix.columns == system.unknown_count() =>
        {
            Ok(NamedRows { name: format!("the file's own '{OWN_ROWS}'"), entries: matrix.entries.clone() })
        }
        _ => {
            let words = Codistribution::new(system, &Assignment::new(), Length::UntilItStops)?;
            Ok(NamedRows { name: "the full codistribution".to_owned(), entries: words.entries() })
        }
    }
}

impl Stress {
    /// Prepares a system of which nothing is known but its file: see [`approaches_of`]. Where it declares dimensions, units
    /// are changed as these say ([`units`]); where not, each state in turn is measured in units 2^20 and 2^40 times smaller.
    ///
    /// # Errors
    /// As [`rows_of`] and [`Stress::prepare`].
    pub fn of_file(
        system: &mut System,
        wanted: LandscapeRows,
        options: &StressOptions<'_>,
    ) -> Result<Stress, String> {
        let rows = rows_of(system, wanted)?;
        let approaches = approaches_of(system, &rows.entries);
        let quantities = unit_quantities(system, &rows.entries);
        let others = units(system, &rows.entries).unwrap_or_else(|| {
            let column = |(power, (place, state)): (i32, (usize, &Symbol))| {
                let name = format!("{} in units 2^{power} times smaller", system.symbol_name(*state));
                (name, Rescaling::Column { place, power })
            };
            let unknowns = system.unknowns();
            let states = |power| unknowns.iter().enumerate().map(move |state| (power, state));
            [20, 40].into_iter().flat_map(states).map(column).collect()
        });
        Stress::prepare(system, rows, &approaches, quantities, others, options)
    }

    /// Prepares some rows of a system for approaches. Besides each quantity by itself
    /// `quantities` are scaled; `units` are other units to look at the states in.
    ///
    /// # Errors
    /// In words: rows that cannot be evaluated, a sample box from which nothing can be drawn.
    pub fn prepare(
        system: &mut System,
        rows: NamedRows,
        approaches: &[Approach],
        quantities: Vec<Quantity>,
        units: Vec<(String, Rescaling)>,
        options: &StressOptions<'_>,
    ) -> Result<Stress, String> {
        let NamedRows { name, entries: rows } = rows;
        let rows = rows.as_slice();
        let box_states =
            Locus::new(system, &Branch::default(), &BTreeMap::new(), rows).map_err(|e| e.to_string())?;
        let (mut lines, mut skipped) = (Vec::new(), Vec::new());
        let mut met = std::collections::HashSet::new();
        for approach in approaches {
            match approach.prepare(
                system,
                rows,
                options.states.max(options.samples_on_sets).max(STATES_ON_THE_SET),
                options.seed,
            ) {
                // two ways to write one set
                Ok(found) => lines.extend(
                    found.into_iter().filter(|line| line.to_infinity || met.insert(line.steps.clone())),
                ),
                Err(why) => skipped.push((approach.title().to_owned(), why)),
            }
        }
        let subject = Subject::new(system, rows)?;
        let state = box_states.draw(options.seed, 0).map_err(|e| e.to_string())?;
        let mut all = Quantity::all(&subject, &state);
        all.extend(quantities);
        Ok(Stress { subject, rows: name, lines, skipped, quantities: all, units, box_states })
    }

    /// How often [`Stress::run`] calls its progress.
    pub fn steps(&self, options: &StressOptions<'_>) -> u64 {
        self.lines.len() as u64 * options.states + self.quantities.len() as u64 + self.units.len() as u64 + 1
    }

    /// Goes to the extremes. The same whatever the number of threads.
    pub fn run(&self, options: &StressOptions<'_>) -> StressStudy {
        let stopped = || options.interrupt.load(Ordering::Relaxed);
        let subject = &self.subject;
        let halvings: Vec<usize> = (0..=MOST_HALVINGS).step_by(options.step.max(1)).collect();
        let states = options.states as usize;
        let tasks: Vec<(usize, usize)> =
            (0..self.lines.len()).flat_map(|line| (0..states).map(move |base| (line, base))).collect();
        let walks: Vec<Option<Walk>> = tasks
            .par_iter()
            .map(|(line, base)| {
                if stopped() {
                    return None;
                }
                let prepared = &self.lines[*line];
                let walk = prepared.walk(subject, &prepared.bases[*base], &halvings);
                (options.progress)();
                Some(walk)
            })
            .collect();
        let on_the_sets: Vec<Vec<OnTheSet>> = self
            .lines
            .par_iter()
            .map(|line| match stopped() {
                true => Vec::new(),
                false => line.on_the_set(subject, &line.bases),
            })
            .collect();
        let lines = self.lines.iter().zip(walks.chunks(states.max(1))).zip(&on_the_sets);
        let lines = lines.filter_map(|((prepared, walks), on_the_set)| {
            // a line with a base state missing would look better than it is
            let walks = walks.iter().cloned().collect::<Option<Vec<Walk>>>()?;
            Some(prepared.line(subject, states, &halvings, &walks, on_the_set))
        });
        let lines: Vec<Line> = lines.collect();
        let base = self.box_states.draw(options.seed, 0).ok();
        let scalings: Vec<Option<Scaling>> = self
            .quantities
            .par_iter()
            .map(|quantity| {
                let base = base.as_ref().filter(|_| !stopped())?;
                let found = quantity.scale(subject, base);
                (options.progress)();
                Some(found)
            })
            .collect();
        let seen = if stopped() { Vec::new() } else { self.seen(options) };
        (options.progress)();
        let mut units = vec![in_units(subject, &seen, "the file's own", None)];
        let others: Vec<Option<UnitsRow>> = self
            .units
            .par_iter()
            .map(|(name, other)| {
                let found = (!stopped()).then(|| in_units(subject, &seen, name, Some(other)));
                (options.progress)();
                found
            })
            .collect();
        units.extend(others.into_iter().flatten());
        let (of_box, near) = match stopped() {
            true => (Vec::new(), Vec::new()),
            false => (self.of_box(options, options.samples * MORE_FOR_CONDITIONING), self.near(options)),
        };
        StressStudy {
            file: subject.system.name.clone(),
            title: subject.system.title.clone(),
            rows: self.rows.clone(),
            dimension: subject.system.unknown_count(),
            by_default: subject.system.ranges_by_default(),
            remaining: subject.remaining(),
            lines,
            skipped: self.skipped.clone(),
            scalings: scalings.into_iter().flatten().collect(),
            conditioning: conditioning(subject, of_box),
            conditioning_near: conditioning(subject, near),
            units,
            interrupted: stopped(),
        }
    }

    fn of_box(&self, options: &StressOptions<'_>, count: u64) -> Vec<State> {
        (0..count).filter_map(|index| self.box_states.draw(options.seed, index).ok()).collect()
    }

    fn bases(&self, options: &StressOptions<'_>) -> impl Iterator<Item = (&Prepared, &State)> {
        let count = options.samples_on_sets as usize;
        let lines = self.lines.iter().filter(|line| !line.to_infinity);
        lines.flat_map(move |line| line.bases.iter().take(count).map(move |base| (line, base)))
    }

    /// States on the sets, and at some distances from them.
    fn near(&self, options: &StressOptions<'_>) -> Vec<State> {
        let mut states = Vec::new();
        for (line, base) in self.bases(options) {
            states.push(base.clone());
            states.extend(NEAR.iter().map(|halvings| line.at(base, *halvings)));
        }
        states
    }

    /// States of the box and of the sets, but poles.
    fn seen(&self, options: &StressOptions<'_>) -> Vec<Seen> {
        let decider = self.subject.decider();
        let mut states = self.of_box(options, options.samples);
        states.extend(self.bases(options).map(|(_, base)| base.clone()));
        let seen: Vec<Option<Seen>> =
            states.into_par_iter().map(|state| Seen::new(&self.subject, &decider, state)).collect();
        seen.into_iter().flatten().collect()
    }
}
