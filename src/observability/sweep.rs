//! The rank of a set of rows at many sampled states.

use super::codistribution::Codistribution;
use super::elimination::{kernel, rank};
use super::locus::{Locus, LocusError};
use super::singular::{Spectrum, singular_values};
use super::state::{State, StateInWords, float_inputs};
use crate::expression::{Graph, NodeId, Program, Symbol, expand_angles};
use crate::number::{Floats, PrimeField, Rationals, rational_to_f64};
use crate::system::System;
use dashu::rational::RBig;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// How a rank is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Certainty {
    /// Exact arithmetic at the very state: no less by a nonzero minor, no more by exact elimination or full rank.
    Certified,
    /// Singular values only.
    Computed,
}

/// What was found at one state.
#[derive(Clone, Debug)]
pub struct StateReport {
    /// The index of the draw.
    pub index: u64,
    /// The rank, and how it is known.
    pub rank: usize,
    pub certainty: Certainty,
    /// What floating point says.
    pub spectrum: Option<Spectrum>,
    /// Where the rank is short: a basis of the directions that no row sees, exactly.
    pub unseen: Vec<Vec<RBig>>,
}

/// How to sweep.
#[derive(Clone, Copy)]
pub struct SweepOptions<'a> {
    pub samples: u64,
    pub seed: u64,
    /// Set from outside to stop early; what was found is kept.
    pub interrupt: &'a AtomicBool,
    /// Called after every block with the number of states done.
    pub progress: &'a (dyn Fn(u64) + Sync),
}

/// Directions of one kind that are not seen, with one example.
#[derive(Clone, Debug)]
pub struct UnseenDirection {
    /// The states that take part, by name.
    pub states: Vec<String>,
    /// At how many sampled states.
    pub count: u64,
    /// One of them, as `1 r1 - 0.5 omega0`.
    pub example: String,
    /// The index of the draw that it belongs to.
    pub index: u64,
}

/// What a sweep has found.
#[derive(Clone, Debug)]
pub struct SweepReport {
    /// States at which the rank was decided.
    pub samples: u64,
    /// The rank by exact arithmetic where there is one, else by singular values.
    pub rank_histogram: BTreeMap<usize, u64>,
    /// The rank by singular values alone.
    pub computed_histogram: BTreeMap<usize, u64>,
    /// How many of the ranks are certified.
    pub certified: u64,
    /// At how many states the singular values say something else than exact arithmetic.
    pub disagreements: u64,
    /// Poles that were met and left out, by the divisor that was zero.
    pub poles: BTreeMap<String, u64>,
    /// The state of full rank with the largest ratio of singular values.
    pub worst: Option<(StateInWords, Spectrum)>,
    /// What is not seen where the rank is short.
    pub unseen: Vec<UnseenDirection>,
    /// The smallest gap on which a computed rank rests.
    pub smallest_gap: f64,
    /// Whether it was stopped early.
    pub interrupted: bool,
    pub seconds: f64,
}

/// States are swept in blocks of this size; between blocks it can be interrupted.
const BLOCK: u64 = 2048;

/// Decides the rank of the codistribution, or of any rows, at every state drawn from a locus.
///
/// `quick` rows are tried first (those that suffice at a generic state); where they fall short, `all` rows decide.
///
/// # Errors
/// Where states cannot be drawn.
pub fn sweep(
    system: &mut System,
    locus: &Locus,
    quick: &[NodeId],
    all: &[NodeId],
    options: SweepOptions<'_>,
) -> Result<SweepReport, LocusError> {
    let begin = Instant::now();
    let angles = system.angles();
    let is_angle = |symbol: Symbol| angles.contains(&symbol);
    let quick = expand_angles(&mut system.graph, quick, is_angle);
    let all = expand_angles(&mut system.graph, all, is_angle);
    let mut rng = ChaCha8Rng::seed_from_u64(options.seed);
    let outputs: Vec<NodeId> = system.outputs.iter().map(|(_, node)| *node).collect();
    let outputs = expand_angles(&mut system.graph, &outputs, is_angle);
    let judge = Judge {
        outputs: Program::new(&system.graph, &outputs, |_| false, false),
        quick: Program::new(&system.graph, &quick, is_angle, false),
        all: Program::new(&system.graph, &all, is_angle, false),
        columns: system.states.len(),
        field: PrimeField::random(&mut rng),
    };
    let mut tally = Tally::default();
    let mut done = 0;
    while done < options.samples && !options.interrupt.load(Ordering::Relaxed) {
        let end = (done + BLOCK).min(options.samples);
        let block: Vec<Result<(State, Judged), LocusError>> = (done..end)
            .into_par_iter()
            .map(|index| {
                let state = locus.draw(options.seed, index)?;
                let judged = judge.decide(&system.graph, index, &state);
                Ok((state, judged))
            })
            .collect();
        for item in block {
            let (state, judged) = item?;
            tally.add(system, state, judged);
        }
        done = end;
        (options.progress)(done);
    }
    let interrupted = done < options.samples;
    Ok(tally.finish(system, interrupted, begin.elapsed().as_secs_f64()))
}

/// What deciding at one state came to.
enum Judged {
    Report(StateReport),
    Pole(String),
}

struct Judge {
    /// Evaluated only to see whether the outputs exist.
    outputs: Program,
    quick: Program,
    all: Program,
    columns: usize,
    field: PrimeField,
}

impl Judge {
    fn decide(&self, graph: &Graph, index: u64, state: &State) -> Judged {
        if let Some(undefined) = self.undefined_output(graph, state) {
            return Judged::Pole(undefined);
        }
        // where few rows suffice modulo a prime, the rank is certainly full
        let residues = self.residue_rank(&self.quick, state);
        if residues == Some(self.columns) {
            return Judged::Report(StateReport {
                index,
                rank: self.columns,
                certainty: Certainty::Certified,
                spectrum: self.spectrum(&self.quick, state),
                unseen: Vec::new(),
            });
        }
        let spectrum = self.spectrum(&self.all, state);
        let rank = self.residue_rank(&self.all, state);
        if rank == Some(self.columns) {
            let certainty = Certainty::Certified;
            return Judged::Report(StateReport {
                index,
                rank: self.columns,
                certainty,
                spectrum,
                unseen: Vec::new(),
            });
        }
        match self.exact(graph, state) {
            Ok((rank, unseen)) => {
                Judged::Report(StateReport { index, rank, certainty: Certainty::Certified, spectrum, unseen })
            }
            Err(Some(pole)) => Judged::Pole(pole),
            Err(None) => match spectrum {
                Some(spectrum) => Judged::Report(StateReport {
                    index,
                    rank: spectrum.rank,
                    certainty: Certainty::Computed,
                    spectrum: Some(spectrum),
                    unseen: Vec::new(),
                }),
                None => Judged::Pole("a value that is infinite or not a number".to_owned()),
            },
        }
    }

    /// Why an output does not exist at a state, if one does not.
    fn undefined_output(&self, graph: &Graph, state: &State) -> Option<String> {
        let float = |symbol: Symbol| state.values.get(&symbol).map_or(f64::NAN, |value| value.to_f64());
        let inputs = float_inputs(&self.outputs, float);
        match self.outputs.load(Floats).ok()?.run(&inputs, &mut Vec::new()) {
            Ok(_) => None,
            Err(failure) => Some(format!(
                "an output is not defined: {}, in {}",
                failure.refusal,
                graph.text(failure.node)
            )),
        }
    }

    /// A lower bound on the rank: the rank modulo a prime.
    fn residue_rank(&self, program: &Program, state: &State) -> Option<usize> {
        let loaded = program.load(self.field).ok()?;
        let inputs = state.inputs(program, &self.field).ok()?;
        let values = loaded.run(&inputs, &mut Vec::new()).ok()?;
        rank(&self.field, values.chunks(self.columns).map(<[u64]>::to_vec).collect()).ok()
    }

    /// Singular values at the doubles nearest to the state.
    fn spectrum(&self, program: &Program, state: &State) -> Option<Spectrum> {
        let float = |symbol: Symbol| state.values.get(&symbol).map_or(f64::NAN, |value| value.to_f64());
        // exact sines and cosines where the state has them, so that rounding enters once
        let inputs = state.inputs(program, &Floats).unwrap_or_else(|_| float_inputs(program, float));
        let values = program.load(Floats).ok()?.run(&inputs, &mut Vec::new()).ok()?;
        singular_values(&values, self.columns)
    }

    /// The rank and the unseen directions by exact elimination. `Err(Some(..))` names a pole; `Err(None)` means that
    /// there is no exact arithmetic for these rows.
    fn exact(&self, graph: &Graph, state: &State) -> Result<(usize, Vec<Vec<RBig>>), Option<String>> {
        let exact = Rationals::default();
        let loaded = self.all.load(exact).map_err(|_| None)?;
        let inputs = state.inputs(&self.all, &exact).map_err(|_| None)?;
        let values = loaded
            .run(&inputs, &mut Vec::new())
            .map_err(|failure| failure.divisor.map(|divisor| format!("{} = 0", graph.text(divisor))))?;
        let rows = values.chunks(self.columns).map(<[RBig]>::to_vec).collect();
        let unseen = kernel(&exact, rows).map_err(|_| None)?;
        Ok((self.columns - unseen.len(), unseen))
    }
}

#[derive(Default)]
struct Tally {
    samples: u64,
    certified: u64,
    disagreements: u64,
    ranks: BTreeMap<usize, u64>,
    computed: BTreeMap<usize, u64>,
    poles: BTreeMap<String, u64>,
    worst: Option<(State, Spectrum)>,
    unseen: BTreeMap<Vec<String>, UnseenDirection>,
    smallest_gap: Option<f64>,
}

impl Tally {
    fn add(&mut self, system: &System, state: State, judged: Judged) {
        let report = match judged {
            Judged::Pole(divisor) => {
                *self.poles.entry(divisor).or_insert(0) += 1;
                return;
            }
            Judged::Report(report) => report,
        };
        self.samples += 1;
        *self.ranks.entry(report.rank).or_insert(0) += 1;
        self.certified += u64::from(report.certainty == Certainty::Certified);
        for direction in &report.unseen {
            self.add_unseen(system, direction, report.index);
        }
        let Some(spectrum) = report.spectrum else { return };
        *self.computed.entry(spectrum.rank).or_insert(0) += 1;
        self.disagreements += u64::from(spectrum.rank != report.rank);
        let gap = self.smallest_gap.get_or_insert(f64::INFINITY);
        *gap = gap.min(spectrum.gap);
        let worse = self.worst.as_ref().is_none_or(|(_, worst)| spectrum.condition() > worst.condition());
        if report.rank == spectrum.values.len() && worse {
            self.worst = Some((state, spectrum));
        }
    }

    fn add_unseen(&mut self, system: &System, direction: &[RBig], index: u64) {
        let names: Vec<String> = system
            .states
            .iter()
            .zip(direction)
            .filter(|(_, part)| !part.is_zero())
            .map(|(symbol, _)| system.symbol_name(*symbol).to_owned())
            .collect();
        let entry = self.unseen.entry(names.clone()).or_insert_with(|| {
            let parts: Vec<f64> = direction.iter().filter(|p| !p.is_zero()).map(rational_to_f64).collect();
            UnseenDirection { states: names.clone(), count: 0, example: combination(&names, &parts), index }
        });
        entry.count += 1;
    }

    fn finish(self, system: &System, interrupted: bool, seconds: f64) -> SweepReport {
        SweepReport {
            samples: self.samples,
            rank_histogram: self.ranks,
            computed_histogram: self.computed,
            certified: self.certified,
            disagreements: self.disagreements,
            poles: self.poles,
            worst: self.worst.map(|(state, spectrum)| (state.describe(system), spectrum)),
            unseen: self.unseen.into_values().collect(),
            smallest_gap: self.smallest_gap.unwrap_or(f64::INFINITY),
            interrupted,
            seconds,
        }
    }
}

/// `r1 - 0.5 omega0`, the largest part scaled to one.
fn combination(names: &[String], parts: &[f64]) -> String {
    let largest = parts.iter().fold(0.0f64, |a, x| a.max(x.abs()));
    let mut text = String::new();
    for (name, part) in names.iter().zip(parts) {
        let part = part / largest;
        let sign = match (text.is_empty(), part < 0.0) {
            (true, true) => "-",
            (true, false) => "",
            (false, true) => " - ",
            (false, false) => " + ",
        };
        text.push_str(sign);
        if (part.abs() - 1.0).abs() > 5e-5 {
            text.push_str(&format!("{:.4} ", part.abs()));
        }
        text.push_str(name);
    }
    text
}

/// The rows of a codistribution as [`sweep`] wants them.
impl Codistribution {
    /// Sweeps this codistribution.
    ///
    /// # Errors
    /// Where states cannot be drawn.
    pub fn sweep(
        &self,
        system: &mut System,
        locus: &Locus,
        options: SweepOptions<'_>,
    ) -> Result<SweepReport, LocusError> {
        sweep(system, locus, &self.needed_entries(), &self.entries(), options)
    }
}
