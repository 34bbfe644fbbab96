//! The rank at one state, by the cheapest number type that suffices.
//!
//! | number type | numbers | what it knows |
//! |---|---|---|
//! | doubles | f64 with running error bounds, elimination (streams of states) | a full rank for *certain*, or *computed* |
//! | intervals | f64 rounded outward, elimination | a full rank for *certain* |
//! | residues | modulo a prime of 62 bits | a lower bound for *certain* |
//! | exact | rational numbers | the rank, and the unobservable directions |
//! | enclosures | enclosures of 128 bits and more | a lower bound for *certain*; the rank as *computed* |
//!
//! A number type that cannot decide passes the state to the next one. A stream begins with doubles that know their errors; a single
//! state begins with intervals. Doubles without error bounds are none of them: where a row vanishes they find noise of full rank.
//! Where intervals fall short, a computed rank is taken from enclosures, a certified one by exact numbers.

use super::certainty::Certainty;
use super::digits::{Digits, Matrices, NoDigits, NoEntries, digits_of};
use crate::observability::{
    Defined, Probe, Reduction, Spectrum, State, certain_rank, kernel, singular_values,
};
use dashu::rational::RBig;
use palmistry_math::expression::{Failure, Graph, Loaded, NodeId, Program, Symbol};
use palmistry_math::number::{
    Arithmetic, Enclosure, Enclosures, Floats, Interval, NumberType, PrimeField, Rationals,
};
use std::borrow::Cow;

/// The bits of enclosures, one after the other.
const PRECISE: [usize; 2] = [128, 512];

/// What was found at one state.
#[derive(Clone, Debug)]
pub struct StateReport {
    /// The rank, how it is known, and on which number type that was found.
    pub rank: usize,
    /// How certain the rank is.
    pub certainty: Certainty,
    /// The numbers that decided it.
    pub number_type: NumberType,
    /// What floating point says of the rows that remain without unit rows.
    pub spectrum: Option<Spectrum>,
    /// Whether the spectrum is that of the quick rows.
    pub quick: bool,
    /// The rank that floating point suggests, unit rows included.
    pub computed: Option<usize>,
    /// Where the rank is short: a basis of the unobservable directions, exactly; nothing where residues decided, which only know which
    /// unknowns take part ([`RankDecider::unobservable`] has the rest).
    pub unobservable: Vec<Vec<RBig>>,
    /// The same basis by residues: for each direction the unknowns that take part.
    pub hidden: Vec<Vec<bool>>,
    /// Whether the rows have this rank; else derivatives of higher order raise it.
    pub is_of_rows: bool,
}

/// The decision at one state.
pub enum StateDecision {
    /// It was decided.
    Report(StateReport),
    /// The divisor that is zero there, in words.
    Pole(String),
}

/// Rows as programs.
struct Rows {
    reduction: Reduction,
    program: Program,
}

impl Rows {
    fn new(graph: &Graph, entries: &[NodeId], columns: usize, is_angle: impl Fn(Symbol) -> bool) -> Rows {
        let reduction = Reduction::new(graph, entries, columns);
        let program = Program::new(graph, &reduction.entries, is_angle);
        Rows { reduction, program }
    }

    fn matrix<N>(&self, values: Vec<N>) -> Vec<Vec<N>> {
        let width = self.reduction.columns.len().max(1);
        let mut values = values.into_iter();
        (0..self.reduction.rows.len()).map(|_| values.by_ref().take(width).collect()).collect()
    }
}

/// What remains of some rows without unit rows, at a state.
struct RowsAt<'j, 'g> {
    decider: &'j RankDecider<'g>,
    rows: &'j Rows,
    state: &'j State,
}

impl Matrices for RowsAt<'_, '_> {
    fn entries<A: Arithmetic + Copy>(&self, on: A) -> Result<Vec<Vec<A::Number>>, NoEntries> {
        let values = self.decider.values(self.rows, self.state, on);
        Ok(self.rows.matrix(values.map_err(|why| match why {
            NoValues::Stopped(failure) => NoEntries::Refused(failure.refusal),
            NoValues::NotInThese => NoEntries::NotInThese,
        })?))
    }
}

/// Rows, entry after entry, whose rank is decided.
#[derive(Clone, Copy, Debug)]
pub struct DecidedRows<'r> {
    /// Those that suffice at a generic state: they are tried first.
    pub quick: &'r [NodeId],
    /// All of them: they decide where the quick ones fall short.
    pub all: &'r [NodeId],
    /// How many entries a row has.
    pub columns: usize,
}

/// How certain a rank has to be, and the residues that may prove it.
#[derive(Clone, Copy, Debug)]
pub struct ProofWanted {
    /// How certain the rank has to be, at the least.
    pub wanted: Certainty,
    /// The residues.
    pub field: PrimeField,
}

/// Why there is no exact rank at a state.
enum NoExactRank {
    /// A divisor is zero there, in words.
    Pole(String),
    /// There is no exact arithmetic for these rows.
    NotExact,
}

/// Why rows have no values over an arithmetic.
enum NoValues {
    /// The state or a constant has no image there.
    NotInThese,
    /// An operation has no value.
    Stopped(Failure),
}

/// The rank at a state by exact numbers, and a basis of the unobservable directions.
struct ExactRank {
    rank: usize,
    unobservable: Vec<Vec<RBig>>,
}

/// The rank modulo a prime, and of a basis of the unobservable directions the unknowns that take part.
struct ResidueRank {
    rank: usize,
    hidden: Vec<Vec<bool>>,
}

/// Decides the rank of some rows at any state.
pub struct RankDecider<'g> {
    graph: Cow<'g, Graph>,
    defined: Defined,
    quick: Rows,
    all: Rows,
    /// All rows without any elimination, for the unobservable directions.
    exact: Program,
    columns: usize,
    most: usize,
    field: PrimeField,
    wanted: Certainty,
    /// What Lie derivatives of higher order than the rows' are looked at by, where the rows are short of `most`.
    further: Option<Probe>,
}

impl<'g> RankDecider<'g> {
    /// `defined` says where all of the rows exist. Angles must have been expanded.
    pub fn new(
        graph: &'g Graph,
        defined: Defined,
        rows: DecidedRows<'_>,
        is_angle: impl Fn(Symbol) -> bool + Copy,
        proof: ProofWanted,
    ) -> Self {
        let DecidedRows { quick, all, columns } = rows;
        let ProofWanted { field, wanted } = proof;
        RankDecider {
            graph: Cow::Borrowed(graph),
            defined,
            quick: Rows::new(graph, quick, columns, is_angle),
            all: Rows::new(graph, all, columns, is_angle),
            exact: Program::new(graph, all, is_angle),
            columns,
            most: columns,
            field,
            wanted,
            further: None,
        }
    }

    /// The same for rows that are the differentials of Lie derivatives up to an order that suffices at almost all states: where they are short
    /// of that rank, those of higher order are looked at too.
    #[must_use]
    pub fn with_further_derivatives(self, of: Option<Probe>) -> Self {
        RankDecider { further: of, ..self }
    }

    /// The same where no state's rank exceeds `most`, for certain.
    #[must_use]
    pub fn at_most(self, most: usize) -> Self {
        RankDecider { most: most.min(self.columns), ..self }
    }

    /// The same with a graph of its own.
    pub fn owning(self) -> RankDecider<'static> {
        RankDecider { graph: Cow::Owned(self.graph.into_owned()), ..self }
    }

    /// Rows and columns of what remains of the quick rows without unit rows.
    pub fn remaining(&self) -> (usize, usize) {
        (self.quick.reduction.rows.len(), self.quick.reduction.columns.len())
    }

    /// How many entries a row has.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// The rank at a state.
    pub fn decide(&self, state: &State) -> StateDecision {
        let mut decided = self.decide_rows(state);
        if let (StateDecision::Report(report), Some(probe)) = (&mut decided, &self.further)
            && report.rank < self.most
            && let Some(rank) = probe.rank_at(state, self.field, 0, self.most)
            && rank > report.rank
        {
            // what the rows here say of singular values and directions is not what all derivatives do
            *report = StateReport {
                rank,
                certainty: if rank == self.most { Certainty::Certified } else { Certainty::Computed },
                number_type: NumberType::Residues,
                spectrum: None,
                quick: false,
                computed: None,
                unobservable: Vec::new(),
                hidden: Vec::new(),
                is_of_rows: false,
            };
        }
        decided
    }

    /// The rank of the rows at a state.
    fn decide_rows(&self, state: &State) -> StateDecision {
        if let Some(undefined) = self.defined.failure(&self.graph, state) {
            return StateDecision::Pole(undefined);
        }
        let full = self.columns;
        let mut report = StateReport {
            rank: full,
            certainty: Certainty::Certified,
            number_type: NumberType::Intervals,
            spectrum: None,
            quick: true,
            computed: None,
            unobservable: Vec::new(),
            hidden: Vec::new(),
            is_of_rows: true,
        };
        let mut residues = None;
        for rows in [&self.quick, &self.all] {
            let found = self.intervals(rows, state);
            let certain = found.as_ref().map(|(rank, _)| *rank);
            report.spectrum = found.and_then(|(_, spectrum)| spectrum).or_else(|| self.doubles(rows, state));
            report.quick = std::ptr::eq(rows, &self.quick);
            report.computed = report.spectrum.as_ref().map(|s| rows.reduction.eliminated + s.rank);
            if certain == Some(full) {
                return StateDecision::Report(report);
            }
            residues = self.residues(rows, state);
            if let Some(found) = &mut residues
                && found.rank == self.most
            {
                (report.rank, report.number_type) = (found.rank, NumberType::Residues);
                report.hidden = std::mem::take(&mut found.hidden);
                return StateDecision::Report(report);
            }
        }
        if self.wanted == Certainty::Certified {
            match self.exact(state) {
                Ok(ExactRank { rank, unobservable }) => {
                    (report.rank, report.unobservable, report.number_type) =
                        (rank, unobservable, NumberType::Exact);
                    return StateDecision::Report(report);
                }
                Err(NoExactRank::Pole(pole)) => return StateDecision::Pole(pole),
                Err(NoExactRank::NotExact) => {}
            }
        } else if let Some(found) = residues {
            // no more than this but for one prime in 10^15: found by arithmetic that may err, and sooner than by any other
            (report.rank, report.certainty, report.number_type) =
                (found.rank, Certainty::Computed, NumberType::Residues);
            report.hidden = found.hidden;
            return StateDecision::Report(report);
        }
        match self.precise(state) {
            Ok((rank, bits)) => {
                report.rank = rank;
                report.number_type = NumberType::Enclosures(bits);
                if rank < full && rank != self.most {
                    report.certainty = Certainty::Computed;
                } else if rank < full {
                    // no state's rank is higher: this one is known, and so are the unknowns in the unobservable directions
                    let kernel = self.enclosed_kernel(state, bits).unwrap_or_default();
                    let parts = |vector: &Vec<Enclosure>| vector.iter().map(|v| !v.contains_zero()).collect();
                    report.hidden = kernel.iter().map(parts).collect();
                }
                StateDecision::Report(report)
            }
            Err(pole) => StateDecision::Pole(pole),
        }
    }

    /// The singular values that [`RankDecider::decide`] reports of a state, to so many digits.
    ///
    /// # Errors
    /// Where digits cannot be had, and why.
    pub fn digits(&self, state: &State, digits: usize) -> Result<Digits, NoDigits> {
        let StateDecision::Report(report) = self.decide(state) else { return Err(NoDigits::NoState) };
        let rows = if report.quick { &self.quick } else { &self.all };
        digits_of(&RowsAt { decider: self, rows, state }, digits, self.wanted)
    }

    /// The values of rows over an arithmetic.
    fn values<A: Arithmetic + Copy>(
        &self,
        rows: &Rows,
        state: &State,
        arithmetic: A,
    ) -> Result<Vec<A::Number>, NoValues> {
        let inputs = state.inputs(&rows.program, &arithmetic).map_err(|_| NoValues::NotInThese)?;
        let loaded: Loaded<'_, A> = rows.program.load(arithmetic).map_err(|_| NoValues::NotInThese)?;
        loaded.run(&inputs, &mut Vec::new()).map_err(NoValues::Stopped)
    }

    /// Singular values at the doubles nearest to the state, nothing known of their errors.
    fn doubles(&self, rows: &Rows, state: &State) -> Option<Spectrum> {
        let values = self.values(rows, state, Floats).ok()?;
        singular_values(&values, &vec![0.0; values.len()], rows.reduction.columns.len())
    }

    /// A lower bound on the rank, and singular values with the errors of the entries.
    fn intervals(&self, rows: &Rows, state: &State) -> Option<(usize, Option<Spectrum>)> {
        let arithmetic = Floats::<Interval>::default();
        let values = self.values(rows, state, arithmetic).ok()?;
        let (middles, errors): (Vec<f64>, Vec<f64>) = values.iter().map(|v| (v.mid(), v.rad())).unzip();
        let spectrum = singular_values(&middles, &errors, rows.reduction.columns.len());
        let matrix = rows.matrix(values);
        let certain = certain_rank(&arithmetic, matrix, |v| v.mid().abs() / v.rad()).ok()?;
        Some((rows.reduction.eliminated + certain, spectrum))
    }

    /// A lower bound on the rank: the rank modulo a prime; with the unknowns that take part in the unobservable directions modulo it.
    fn residues(&self, rows: &Rows, state: &State) -> Option<ResidueRank> {
        let values = self.values(rows, state, self.field).ok()?;
        let width = rows.reduction.columns.len();
        let kernel = kernel(&self.field, rows.matrix(values), width).ok()?;
        let hidden = kernel.iter().map(|vector| {
            // what was eliminated is observable
            let mut parts = vec![false; self.columns];
            for (column, part) in rows.reduction.columns.iter().zip(vector) {
                parts[*column] = *part != 0;
            }
            parts
        });
        Some(ResidueRank { rank: rows.reduction.eliminated + width - kernel.len(), hidden: hidden.collect() })
    }

    /// A basis of the unobservable directions at a state, exactly; nothing where there is no exact arithmetic.
    pub fn unobservable(&self, state: &State) -> Vec<Vec<RBig>> {
        self.exact(state).map(|found| found.unobservable).unwrap_or_default()
    }

    /// The same to many digits, where the rank there is the largest possible: a number that is enclosed together with zero is taken for
    /// zero, every other one for the simplest that is enclosed.
    pub fn nearly_unobservable(&self, state: &State) -> Vec<Vec<RBig>> {
        let value = |value: &Enclosure| match (value.low(), value.high()) {
            _ if value.contains_zero() => RBig::ZERO,
            (low, high) if low == high => low,
            (low, high) => RBig::simplest_in(low, high),
        };
        let kernel = self.enclosed_kernel(state, PRECISE[1]).unwrap_or_default();
        kernel.iter().map(|vector| vector.iter().map(value).collect()).collect()
    }

    /// A basis of the unobservable directions, enclosed; nothing where they are not as many as the columns less `most`.
    fn enclosed_kernel(&self, state: &State, bits: usize) -> Option<Vec<Vec<Enclosure>>> {
        let arithmetic = Enclosures::new(bits);
        let values = self.values(&self.all, state, arithmetic).ok()?;
        let reduction = &self.all.reduction;
        let found = kernel(&arithmetic, self.all.matrix(values), reduction.columns.len()).ok()?;
        if found.len() + self.most != self.columns {
            return None;
        }
        let zero = arithmetic.rational(&RBig::ZERO).ok()?;
        let whole = |vector: Vec<Enclosure>| {
            // what was eliminated is observable
            let mut parts = vec![zero.clone(); self.columns];
            for (column, part) in reduction.columns.iter().zip(vector) {
                parts[*column] = part;
            }
            parts
        };
        Some(found.into_iter().map(whole).collect())
    }

    /// The rank and the unobservable directions by exact elimination.
    fn exact(&self, state: &State) -> Result<ExactRank, NoExactRank> {
        let exact = Rationals::default();
        let loaded = self.exact.load(exact).map_err(|_| NoExactRank::NotExact)?;
        let inputs = state.inputs(&self.exact, &exact).map_err(|_| NoExactRank::NotExact)?;
        let values = loaded.run(&inputs, &mut Vec::new()).map_err(|failure| match failure.divisor {
            Some(divisor) => NoExactRank::Pole(format!("{} = 0", self.graph.text(divisor))),
            None => NoExactRank::NotExact,
        })?;
        let rows = values.chunks(self.columns).map(<[RBig]>::to_vec).collect();
        let unobservable = kernel(&exact, rows, self.columns).map_err(|_| NoExactRank::NotExact)?;
        Ok(ExactRank { rank: self.columns - unobservable.len(), unobservable })
    }

    /// A lower bound on the rank, by more and more bits until it is full; the rank by the last and most precise.
    fn precise(&self, state: &State) -> Result<(usize, usize), String> {
        let mut found = Err("a value that is infinite or not a number".to_owned());
        for bits in PRECISE {
            let arithmetic = Enclosures::new(bits);
            found = match self.values(&self.all, state, arithmetic) {
                Ok(values) => certain_rank(&arithmetic, self.all.matrix(values), Enclosure::significance)
                    .map(|rank| (self.all.reduction.eliminated + rank, bits))
                    .map_err(|refusal| refusal.to_string()),
                Err(NoValues::Stopped(Failure { divisor: Some(divisor), .. })) => Err(format!(
                    "{} cannot be distinguished from zero with {bits} bits",
                    self.graph.text(divisor)
                )),
                Err(NoValues::Stopped(failure)) => {
                    Err(format!("{} is not defined", self.graph.text(failure.node)))
                }
                Err(NoValues::NotInThese) => return found,
            };
            if found.as_ref().is_ok_and(|(rank, _)| *rank == self.columns || *rank == self.most) {
                break;
            }
        }
        found
    }
}
