//! Some rows of a system, evaluated at one exact state in every number type, and their true rank there.

use dashu::rational::RBig;
use palmistry_lang::System;
use palmistry_math::expression::{Failure, NodeId, Program, expand_angles};
use palmistry_math::number::{
    Arithmetic, Enclosure, Enclosures, Floats, PrimeField, Rationals, RealNumber, Refusal,
};
use palmistry_rank::observability::{
    Defined, MissingInput, Reduction, Spectrum, State, certain_rank, customary_singular_values, rank,
    singular_values,
};
use palmistry_rank::sweep::{Certainty, DecidedRows, ProofWanted, RankDecider};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// The bits with which the true entries are enclosed; where that is not enough for [`TRUE_BITS`], they are exact.
const BITS: usize = 512;
/// The true entries are known to this part of themselves, at the least.
const TRUE_BITS: i32 = 160;
/// Expressions are quoted up to so many characters.
const LONGEST_QUOTE: usize = 60;

/// Entries and registers, or why there are none.
type Evaluated<N> = Result<(Vec<N>, Vec<N>), String>;

/// Some rows of a system.
pub struct Subject {
    pub system: System,
    /// All entries, sines and cosines of sums of angles expanded.
    expanded: Vec<NodeId>,
    program: Program,
    pub(super) reduction: Reduction,
    /// Where the entries that remain without unit rows are among all.
    pub(super) remaining: Vec<usize>,
    pub columns: usize,
    field: PrimeField,
}

/// The certified facts about a state.
#[derive(Clone, Debug)]
pub struct Truth {
    pub rank: usize,
    /// Whether the rank is proved (where there is exact arithmetic it always is).
    pub certified: bool,
    /// Those that remain without unit rows.
    pub(super) entries: Vec<RBig>,
}

impl Truth {
    fn at(rank: usize, certified: bool, entries: Vec<RBig>) -> Truth {
        Truth { rank, certified, entries }
    }
}

impl Subject {
    /// The rows with these entries, by rows, of as many columns as the system has states.
    ///
    /// # Errors
    /// In words: an angle outside sines and cosines, no states.
    pub fn new(system: &mut System, rows: &[NodeId]) -> Result<Subject, String> {
        let columns = system.unknown_count();
        if columns == 0 || rows.is_empty() {
            return Err(format!("{} has no states, or no outputs whose differentials are rows", system.name));
        }
        let is_angle = &system.angle_test();
        let expanded = expand_angles(&mut system.graph, rows, is_angle);
        let program = Program::new(&system.graph, &expanded, is_angle);
        if let Some(angle) = program.bare_angle() {
            let name = system.symbol_name(angle);
            return Err(format!("'{name}' is declared as an angle but stands outside sin, cos and tan"));
        }
        let reduction = Reduction::new(&system.graph, &expanded, columns);
        let remaining = reduction
            .rows
            .iter()
            .flat_map(|row| reduction.columns.iter().map(move |column| row * columns + column))
            .collect();
        // any fixed field: what it proves does not depend on which
        let field = PrimeField::random(&mut ChaCha8Rng::seed_from_u64(0x73_7472_6573));
        Ok(Subject { system: system.clone(), expanded, program, reduction, remaining, columns, field })
    }

    /// The decider for these rows, which escalates through the number types, certified.
    pub(super) fn decider(&self) -> RankDecider<'_> {
        let rows = DecidedRows { quick: &self.expanded, all: &self.expanded, columns: self.columns };
        let is_angle = |symbol| self.system.is_angle(symbol);
        let proof = ProofWanted { wanted: Certainty::Certified, field: self.field };
        RankDecider::new(&self.system.graph, Defined::default(), rows, is_angle, proof)
    }

    /// The rows that remain without unit rows, and their columns.
    pub fn remaining(&self) -> (usize, usize) {
        (self.reduction.rows.len(), self.reduction.columns.len())
    }

    fn quote(&self, node: NodeId) -> String {
        let text = self.system.graph.text(node);
        if text.chars().count() <= LONGEST_QUOTE {
            return text;
        }
        text.chars().take(LONGEST_QUOTE).chain("...".chars()).collect()
    }

    /// Why an evaluation stopped, with the name of what it stopped at.
    fn name(&self, failure: Failure) -> String {
        match (failure.refusal, failure.divisor) {
            (Refusal::DivisionByZero, Some(divisor)) => {
                format!("division by zero: {} = 0", self.quote(divisor))
            }
            (_, Some(divisor)) => {
                format!("the divisor {} cannot be distinguished from zero", self.quote(divisor))
            }
            (refusal, None) => format!("{refusal}, in {}", self.quote(failure.node)),
        }
    }

    fn run<A: Arithmetic>(&self, state: &State, arithmetic: A) -> Evaluated<A::Number> {
        let inputs = state.inputs(&self.program, &arithmetic).map_err(|why| match why {
            MissingInput::Refused(refusal) => format!("{refusal}, in a coordinate of the state"),
            MissingInput::Unsaid => "the state says nothing of a symbol".to_owned(),
        })?;
        let loaded = self.program.load(arithmetic).map_err(|refusal| format!("{refusal}, in a constant"))?;
        let mut registers = Vec::new();
        let entries = loaded.run(&inputs, &mut registers).map_err(|failure| self.name(failure))?;
        Ok((entries, registers))
    }

    /// All entries in a number of fixed size, every step on the way being finite.
    pub(super) fn entries<T: RealNumber>(&self, state: &State) -> Result<Vec<T>, String> {
        let (entries, registers) = self.run(state, Floats::<T>::new())?;
        match registers.iter().position(|value| !value.is_finite()) {
            None => Ok(entries),
            Some(place) => Err(format!("overflow in {}", self.quote(self.program.origins()[place]))),
        }
    }

    /// The first expression that is not zero and that a number type rounds to zero.
    pub(super) fn rounded_to_zero<T: RealNumber>(&self, state: &State) -> Option<String> {
        let (_, rounded) = self.run(state, Floats::<T>::new()).ok()?;
        let (_, enclosed) = self.run(state, Enclosures::new(BITS)).ok()?;
        let place = rounded
            .iter()
            .zip(&enclosed)
            .position(|(value, true_value)| value.is_zero() == Some(true) && !true_value.contains_zero())?;
        Some(format!("{} is rounded to zero", self.quote(self.program.origins()[place])))
    }

    pub(super) fn matrix<N: Clone>(&self, remaining: &[N]) -> Vec<Vec<N>> {
        remaining.chunks(self.reduction.columns.len().max(1)).map(<[N]>::to_vec).collect()
    }

    pub(super) fn pick<N: Clone>(&self, all: &[N]) -> Vec<N> {
        self.remaining.iter().map(|place| all[*place].clone()).collect()
    }

    /// The rank and the entries, for certain.
    ///
    /// # Errors
    /// What is divided by and vanishes at the state, or why nothing is certain there.
    pub fn truth(&self, state: &State) -> Result<Truth, String> {
        let full = self.reduction.rows.len().min(self.reduction.columns.len());
        let eliminated = self.reduction.eliminated;
        // a rank modulo a prime is a lower bound for certain
        let residues = self.run(state, self.field).ok().map(|(values, _)| self.matrix(&self.pick(&values)));
        let is_full = residues.is_some_and(|matrix| rank(&self.field, matrix) == Ok(full));
        let enclosed = self.run(state, Enclosures::new(BITS)).ok().map(|(values, _)| self.pick(&values));
        let sharp = |value: &Enclosure| value.is_exact() || value.significance() > 2f64.powi(TRUE_BITS);
        if let Some(values) = enclosed.as_ref().filter(|values| is_full && values.iter().all(sharp)) {
            return Ok(Truth::at(eliminated + full, true, values.iter().map(Enclosure::low).collect()));
        }
        let exact = Rationals::default();
        match self.run(state, exact) {
            Ok((values, _)) => {
                let values = self.pick(&values);
                let found = if is_full {
                    full
                } else {
                    rank(&exact, self.matrix(&values)).map_err(|r| r.to_string())?
                };
                Ok(Truth::at(eliminated + found, true, values))
            }
            Err(pole) if pole.starts_with("division by zero") => Err(pole),
            // no exact arithmetic: a full rank is certain all the same, a lower one is as good as the bits
            Err(why) => {
                let values = enclosed.ok_or(why)?;
                let found =
                    certain_rank(&Enclosures::new(BITS), self.matrix(&values), Enclosure::significance)
                        .map_err(|refusal| refusal.to_string())?;
                let entries = values.iter().map(Enclosure::low).collect();
                Ok(Truth::at(eliminated + found, found == full, entries))
            }
        }
    }

    /// The rank alone, for certain; quick where it is full. `None` at a pole, or without exact arithmetic.
    pub(super) fn rank(&self, state: &State) -> Option<usize> {
        let full = self.reduction.rows.len().min(self.reduction.columns.len());
        let residues = self.run(state, self.field).ok().map(|(values, _)| self.matrix(&self.pick(&values)));
        if residues.is_some_and(|matrix| rank(&self.field, matrix) == Ok(full)) {
            return Some(self.reduction.eliminated + full);
        }
        let exact = Rationals::default();
        let (values, _) = self.run(state, exact).ok()?;
        Some(self.reduction.eliminated + rank(&exact, self.matrix(&self.pick(&values))).ok()?)
    }

    /// The spectra of the old and of the new scaling at the double next to a state.
    pub(super) fn spectra(&self, state: &State) -> Option<(Spectrum, Spectrum)> {
        let all = self.entries::<f64>(state).ok()?;
        let picked = self.pick(&all);
        let new = singular_values(&picked, &vec![0.0; picked.len()], self.reduction.columns.len())?;
        Some((customary_singular_values(&all, self.columns)?, new))
    }

    /// How many unit rows were eliminated before the new scaling.
    pub(super) fn eliminated(&self) -> usize {
        self.reduction.eliminated
    }
}
