//! Which sets of additions suffice, at a random point.

use super::variant::{Additions, with};
use super::{Addition, DesignQuestion};
use crate::observability::{OutputRows, Probe, Rows};
use crate::sweep::held_constants;
use palmistry_lang::System;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::atomic::Ordering;

/// No more sets than this are looked at.
const MOST_SETS: u64 = 2_000_000;
/// Nor more systems with other inputs or more experiments.
const MOST_SYSTEMS: usize = 600;
/// Nor rows of more entries in all.
const MOST_ENTRIES: usize = 50_000_000;

/// The system with inputs and experiments, and the rows of all that can be measured or known besides.
struct Extended {
    inputs: BTreeSet<usize>,
    experiments: usize,
    /// What is measured as the file says.
    fixed: Rows,
    /// Of each addition its rows.
    rows: Vec<Vec<Vec<u64>>>,
    /// The columns of what is to be identified.
    targets: Vec<usize>,
}

impl Extended {
    fn cost(&self) -> usize {
        self.inputs.len() + self.experiments
    }
}

/// A set that suffices.
#[derive(Clone, PartialEq, Eq)]
struct Found {
    inputs: BTreeSet<usize>,
    experiments: usize,
    rows: BTreeSet<usize>,
}

/// The sets of one size.
pub(super) struct Sets {
    pub sets: Vec<Vec<Addition>>,
    /// Why some were not looked at.
    pub open: Option<String>,
}

pub(super) struct Search<'a> {
    system: &'a System,
    question: &'a DesignQuestion<'a>,
    wanted: &'a [String],
    additions: Additions,
    systems: Vec<Extended>,
    /// By the number of further experiments, of each addition how many outputs it is.
    outputs: BTreeMap<usize, Vec<usize>>,
    left_out: Vec<(Addition, String)>,
    found: Vec<Found>,
    /// Sets, systems, and entries of rows so far.
    looked_at: u64,
    prepared: usize,
    entries: usize,
    rng: ChaCha8Rng,
}

impl<'a> Search<'a> {
    pub fn new(
        system: &'a System,
        question: &'a DesignQuestion<'a>,
        wanted: &'a [String],
        additions: Additions,
    ) -> Search<'a> {
        let mut search = Search {
            system,
            question,
            wanted,
            additions,
            systems: Vec::new(),
            outputs: BTreeMap::new(),
            left_out: Vec::new(),
            found: Vec::new(),
            looked_at: 0,
            prepared: 0,
            entries: 0,
            // any fixed seed: what is found is decided anew
            rng: ChaCha8Rng::seed_from_u64(0x6465_7369_676e),
        };
        search.leave_out_what_cannot_be_read();
        search
    }

    pub fn left_out(self) -> Vec<(Addition, String)> {
        self.left_out
    }

    /// Additions that the file cannot have, each by itself.
    fn leave_out_what_cannot_be_read(&mut self) {
        let mut left_out = Vec::new();
        let mut keep = |list: &mut Vec<Addition>| {
            list.retain(|one| match with(self.system, self.question, std::slice::from_ref(one)) {
                Ok(_) => true,
                Err(why) => {
                    left_out.push((one.clone(), why));
                    false
                }
            });
        };
        keep(&mut self.additions.rows);
        keep(&mut self.additions.inputs);
        let mut experiment = vec![Addition::Experiment; self.additions.experiments.min(1)];
        keep(&mut experiment);
        if experiment.is_empty() {
            self.additions.experiments = 0;
        }
        self.additions.rows = self.without_repetitions(&mut left_out);
        self.left_out = left_out;
    }

    /// What can be measured or known, each once: equal outputs are one when a file is read, and which rows are whose is told by their number.
    fn without_repetitions(&self, left_out: &mut Vec<(Addition, String)>) -> Vec<Addition> {
        let outputs = |additions: &[Addition]| {
            with(self.system, self.question, additions).map_or(0, |system| system.outputs.len())
        };
        let is_measured = |one: &Addition| matches!(one, Addition::Output(_) | Addition::Known(_));
        let measured: Vec<Addition> =
            self.additions.rows.iter().filter(|one| is_measured(one)).cloned().collect();
        if outputs(&measured) == outputs(&[]) + measured.len() {
            return self.additions.rows.clone();
        }
        let (mut before, mut count) = (Vec::new(), outputs(&[]));
        let mut kept = Vec::new();
        for one in &self.additions.rows {
            if is_measured(one) {
                before.push(one.clone());
                if outputs(&before) == count {
                    before.pop();
                    left_out
                        .push((one.clone(), "it is measured, or can be added under another name".to_owned()));
                    continue;
                }
                count += 1;
            }
            kept.push(one.clone());
        }
        kept
    }

    /// All sets of a size that suffice and contain no smaller one, of those that `is_enough` accepts.
    pub fn of_size(&mut self, size: usize, is_enough: &mut dyn FnMut(&[Addition]) -> bool) -> Sets {
        let mut open = self.add_systems(size).err();
        let mut sets = Vec::new();
        let before = self.found.len();
        for place in 0..self.systems.len() {
            if self.systems[place].cost() > size || open.is_some() {
                continue;
            }
            let rows = size - self.systems[place].cost();
            let mut chosen = Vec::new();
            let fixed = self.systems[place].fixed.clone();
            open = self.extend(place, fixed, rows, &mut chosen, &mut sets, is_enough).err();
        }
        debug_assert!(self.found.len() - before == sets.len());
        Sets { sets, open }
    }

    /// The systems with as many inputs and experiments in all as the sets that are looked for.
    fn add_systems(&mut self, size: usize) -> Result<(), String> {
        let costs: &[usize] = if size == 1 { &[0, 1] } else { &[size] };
        for cost in costs {
            for experiments in 0..=self.additions.experiments.min(*cost) {
                let too_many = || format!("more than {MOST_SYSTEMS} choices of inputs and experiments");
                let subsets = subsets(self.additions.inputs.len(), cost - experiments);
                for inputs in subsets.ok_or_else(too_many)? {
                    if self.is_settled(&inputs, experiments) {
                        continue;
                    }
                    self.prepared += 1;
                    if self.prepared > MOST_SYSTEMS {
                        return Err(too_many());
                    }
                    if self.question.interrupt.load(Ordering::Relaxed) {
                        return Err("it was interrupted".to_owned());
                    }
                    if let Some(system) = self.prepared(inputs, experiments)? {
                        self.systems.push(system);
                    }
                }
            }
        }
        Ok(())
    }

    /// The rows of one system; none where everything that can be measured and known does not suffice.
    fn prepared(&mut self, inputs: BTreeSet<usize>, experiments: usize) -> Result<Option<Extended>, String> {
        let mut additions: Vec<Addition> =
            inputs.iter().map(|place| self.additions.inputs[*place].clone()).collect();
        additions.extend(std::iter::repeat_n(Addition::Experiment, experiments));
        let bare = with(self.system, self.question, &additions)?;
        let measured = |one: &&Addition| matches!(one, Addition::Output(_) | Addition::Known(_));
        additions.extend(self.additions.rows.iter().filter(measured).cloned());
        let all = with(self.system, self.question, &additions)?;
        let columns = all.unknown_count();
        let room = || format!("rows of more than {MOST_ENTRIES} entries");
        // no output has more rows than there are unknowns
        let entries = all.outputs.len().saturating_mul(columns).saturating_mul(columns);
        if entries > MOST_ENTRIES {
            return Err(room());
        }
        // initial conditions that the file gives are left free: at these states no more is observable than generically
        let mut all = all;
        let held = held_constants(&mut all);
        let probe = Probe::new(&all, &held);
        let OutputRows { field, rows: mut of_outputs } = probe.output_rows(&mut self.rng)?;
        let names = all.column_names();
        let mut fixed = Rows::new(field, names.len());
        let mut of_additions = of_outputs.split_off(bare.outputs.len()).into_iter();
        of_outputs.into_iter().flatten().for_each(|row| fixed.add(row));
        let outputs_of = self.outputs_of(experiments)?;
        let unit = |place: usize| {
            let mut row = vec![0; names.len()];
            row[place] = field.one();
            row
        };
        let mut rows = Vec::new();
        for (addition, outputs) in self.additions.rows.iter().zip(outputs_of) {
            rows.push(match addition {
                Addition::Initial(state) => {
                    let copy = format!("{state}@");
                    let is_it = |name: &String| name == state || name.starts_with(&copy);
                    (0..names.len()).filter(|place| is_it(&names[*place])).map(unit).collect()
                }
                _ => of_additions.by_ref().take(outputs).flatten().collect(),
            });
        }
        let place = |name: &String| names.iter().position(|other| other == name);
        let targets: Vec<usize> = self.wanted.iter().filter_map(place).collect();
        let mut whole = fixed.clone();
        rows.iter().flatten().for_each(|row: &Vec<u64>| whole.add(row.clone()));
        self.entries += rows.iter().flatten().map(Vec::len).sum::<usize>();
        if self.entries > MOST_ENTRIES {
            return Err(room());
        }
        let system = Extended { inputs, experiments, fixed, rows, targets };
        Ok(whole.has(&system.targets).then_some(system))
    }

    /// How many outputs each addition is where there are so many further experiments: a state has one in each, a constant one in all.
    fn outputs_of(&mut self, experiments: usize) -> Result<Vec<usize>, String> {
        if let Some(known) = self.outputs.get(&experiments) {
            return Ok(known.clone());
        }
        let mut additions = vec![Addition::Experiment; experiments];
        let bare = with(self.system, self.question, &additions)?.outputs.len();
        let mut found = Vec::new();
        for addition in &self.additions.rows {
            additions.push(addition.clone());
            found.push(with(self.system, self.question, &additions)?.outputs.len() - bare);
            additions.pop();
        }
        self.outputs.insert(experiments, found.clone());
        Ok(found)
    }

    /// Sets with so many rows more than those that are chosen.
    fn extend(
        &mut self,
        place: usize,
        span: Rows,
        further: usize,
        chosen: &mut Vec<usize>,
        sets: &mut Vec<Vec<Addition>>,
        is_enough: &mut dyn FnMut(&[Addition]) -> bool,
    ) -> Result<(), String> {
        if further == 0 {
            self.looked_at += 1;
            (self.question.progress)(self.looked_at);
            if self.looked_at > MOST_SETS {
                return Err(format!("more than {MOST_SETS} sets"));
            }
            if self.question.interrupt.load(Ordering::Relaxed) {
                return Err("it was interrupted".to_owned());
            }
            let system = &self.systems[place];
            if self.has_smaller(system, chosen) || !span.has(&system.targets) {
                return Ok(());
            }
            let mut set: Vec<Addition> = chosen.iter().map(|row| self.additions.rows[*row].clone()).collect();
            set.extend(system.inputs.iter().map(|input| self.additions.inputs[*input].clone()));
            set.extend(std::iter::repeat_n(Addition::Experiment, system.experiments));
            if is_enough(&set) {
                let (inputs, experiments) = (system.inputs.clone(), system.experiments);
                self.found.push(Found { inputs, experiments, rows: chosen.iter().copied().collect() });
                sets.push(set);
            }
            return Ok(());
        }
        let from = chosen.last().map_or(0, |last| last + 1);
        for row in from..self.additions.rows.len() {
            chosen.push(row);
            if !self.has_smaller(&self.systems[place], chosen) {
                let mut wider = span.clone();
                self.systems[place].rows[row].iter().for_each(|row| wider.add(row.clone()));
                self.extend(place, wider, further - 1, chosen, sets, is_enough)?;
            }
            chosen.pop();
        }
        Ok(())
    }

    /// Whether inputs and experiments suffice without anything that is measured or known besides.
    fn is_settled(&self, inputs: &BTreeSet<usize>, experiments: usize) -> bool {
        let is_part = |found: &Found| {
            found.rows.is_empty() && found.experiments <= experiments && found.inputs.is_subset(inputs)
        };
        self.found.iter().any(is_part)
    }

    /// Whether a set that suffices is a part of this one.
    fn has_smaller(&self, system: &Extended, chosen: &[usize]) -> bool {
        self.found.iter().any(|found| {
            found.experiments <= system.experiments
                && found.inputs.is_subset(&system.inputs)
                && found.rows.iter().all(|row| chosen.contains(row))
        })
    }
}

/// All subsets of a size, where they are no more than systems are looked at.
fn subsets(of: usize, size: usize) -> Option<Vec<BTreeSet<usize>>> {
    let mut all = vec![BTreeSet::new()];
    for _ in 0..size {
        let longer = |set: &BTreeSet<usize>| {
            let from = set.last().map_or(0, |last| last + 1);
            let set = set.clone();
            (from..of).map(move |next| set.iter().copied().chain([next]).collect()).collect::<Vec<_>>()
        };
        all = all.iter().flat_map(longer).take(MOST_SYSTEMS + 1).collect();
        if all.len() > MOST_SYSTEMS {
            return None;
        }
    }
    Some(all)
}
