//! What each way makes of a state: its verdict, and the digits of its worst entry.

use super::subject::{Subject, Truth};
use super::{Mark, StressVerdict, Way, jacobi};
use dashu::rational::RBig;
use palmistry_math::number::{DoubleDouble, Floats, Interval, RealNumber, rational_to_f64};
use palmistry_rank::observability::{
    Spectrum, State, certain_rank, customary_singular_values, singular_values,
};
use palmistry_rank::sweep::{RankDecider, StateDecision};

/// What one way finds at a state.
#[derive(Clone, Debug, PartialEq)]
pub struct StressFinding {
    pub verdict: StressVerdict,
    /// The correct significant digits of the worst entry; of intervals those that they guarantee.
    pub digits: Option<f64>,
}

impl StressFinding {
    /// What the finding is worth beside the truth.
    pub fn mark(&self, way: Way, truth: &Truth) -> Mark {
        match self.verdict {
            StressVerdict::Refused(_) => Mark::Refused,
            StressVerdict::AtLeast(least) if least <= truth.rank => Mark::Open,
            StressVerdict::Rank(rank) if rank == truth.rank => {
                if self.digits.is_some_and(|digits| digits < way.digits() / 2.0) {
                    Mark::Lost
                } else {
                    Mark::Right
                }
            }
            StressVerdict::Rank(_) | StressVerdict::AtLeast(_) => Mark::Wrong,
        }
    }
}

impl Subject {
    /// What every way of [`Way::ALL`] finds at a state. `column`, if given, is measured in units so many times smaller
    /// (a power of two, so that nothing is rounded).
    pub fn findings(
        &self,
        decider: &RankDecider<'_>,
        state: &State,
        truth: &Truth,
        column: Option<(usize, f64)>,
    ) -> Vec<StressFinding> {
        let singles = self.scaled(self.entries::<f32>(state), column);
        let doubles = self.scaled(self.entries::<f64>(state), column);
        let intervals = self.scaled(self.entries::<Interval>(state), column);
        let double_doubles = self.scaled(self.entries::<DoubleDouble>(state), column);
        let digits = |values: &[f64]| {
            let values: Vec<DoubleDouble> = values.iter().map(|x| DoubleDouble::from_f64(*x)).collect();
            self.worst(&values, truth, column, quick_relative_error)
        };
        Way::ALL
            .iter()
            .map(|way| match way {
                Way::AlwaysFull => StressFinding { verdict: StressVerdict::Rank(self.columns), digits: None },
                Way::Single => self.finding(&singles, *way, |all| {
                    let picked = self.pick(all);
                    let found = digits(&picked.iter().map(|x| f64::from(*x)).collect::<Vec<_>>());
                    (self.by_jacobi(picked, f64::from(f32::EPSILON)), found)
                }),
                Way::Customary => self.finding(&doubles, *way, |all| {
                    let spectrum = customary_singular_values(all, self.columns);
                    (by_spectrum(spectrum, 0), digits(&self.pick(all)))
                }),
                Way::Double => self.finding(&doubles, *way, |all| {
                    let picked = self.pick(all);
                    (self.by_radii(&picked, &vec![0.0; picked.len()]), digits(&picked))
                }),
                Way::Radii => self.finding(&intervals, *way, |all| {
                    let (middles, radii): (Vec<f64>, Vec<f64>) =
                        self.pick(all).iter().map(|v| (v.mid(), v.rad())).unzip();
                    (self.by_radii(&middles, &radii), digits(&middles))
                }),
                Way::Interval => self.finding(&intervals, *way, |all| {
                    let picked = self.pick(all);
                    let guaranteed =
                        picked.iter().map(|v| -(v.rad() / v.mid().abs()).log10()).filter(|d| !d.is_nan());
                    (self.by_pivots(&picked), guaranteed.reduce(f64::min))
                }),
                Way::DoubleDouble => self.finding(&double_doubles, *way, |all| {
                    let picked = self.pick(all);
                    let worst = self.worst(&picked, truth, column, relative_error);
                    (self.by_jacobi(picked, 2f64.powi(-104)), worst)
                }),
                Way::Escalation => {
                    StressFinding { verdict: self.by_ladder(decider, state, &intervals), digits: None }
                }
            })
            .collect()
    }

    fn finding<T>(
        &self,
        entries: &Result<Vec<T>, String>,
        way: Way,
        decide: impl Fn(&[T]) -> (StressVerdict, Option<f64>),
    ) -> StressFinding {
        match entries {
            Err(why) => StressFinding { verdict: StressVerdict::Refused(why.clone()), digits: None },
            Ok(entries) => {
                let (verdict, digits) = decide(entries);
                StressFinding { verdict, digits: digits.map(|d| d.clamp(0.0, way.digits())) }
            }
        }
    }

    fn scaled<T: RealNumber>(
        &self,
        entries: Result<Vec<T>, String>,
        column: Option<(usize, f64)>,
    ) -> Result<Vec<T>, String> {
        let (Some((column, factor)), Ok(mut entries)) = (column, entries.clone()) else { return entries };
        let factor = T::from_f64(factor);
        for entry in entries.iter_mut().skip(column).step_by(self.columns) {
            *entry = *entry * factor;
        }
        match entries.iter().all(|entry| entry.is_finite()) {
            true => Ok(entries),
            false => Err("overflow in other units".to_owned()),
        }
    }

    /// The factor by which each remaining entry was scaled.
    fn column_factors(&self, column: Option<(usize, f64)>) -> impl Iterator<Item = f64> {
        self.remaining.iter().map(move |place| match column {
            Some((column, factor)) if place % self.columns == column => factor,
            _ => 1.0,
        })
    }

    /// The digits of the worst entry; entries that are truly zero have none to lose.
    fn worst(
        &self,
        values: &[DoubleDouble],
        truth: &Truth,
        column: Option<(usize, f64)>,
        relative_error: impl Fn(DoubleDouble, &RBig) -> f64,
    ) -> Option<f64> {
        let entries = values.iter().zip(&truth.entries).zip(self.column_factors(column));
        entries
            .filter(|((_, exact), _)| !exact.is_zero())
            .map(|((value, exact), factor)| {
                let error = match factor == 1.0 {
                    true => relative_error(*value, exact),
                    false => relative_error(*value, &(exact * RBig::try_from(factor).unwrap_or(RBig::ONE))),
                };
                -error.log10()
            })
            .filter(|digits| !digits.is_nan())
            .reduce(f64::min)
    }

    fn by_jacobi<T: RealNumber>(&self, remaining: Vec<T>, epsilon: f64) -> StressVerdict {
        match jacobi::rank(remaining, self.reduction.columns.len(), epsilon) {
            Ok(rank) => StressVerdict::Rank(self.reduction.eliminated + rank),
            Err(_) => StressVerdict::Refused("a singular value is not finite".to_owned()),
        }
    }

    fn by_radii(&self, middles: &[f64], radii: &[f64]) -> StressVerdict {
        by_spectrum(singular_values(middles, radii, self.reduction.columns.len()), self.reduction.eliminated)
    }

    /// Intervals, in whatever units, if they prove the full rank; else the further number types of the [`RankDecider`], which are exact,
    /// so that units (which multiply a column) do not matter to them.
    fn by_ladder(
        &self,
        decider: &RankDecider<'_>,
        state: &State,
        intervals: &Result<Vec<Interval>, String>,
    ) -> StressVerdict {
        if let Ok(intervals) = intervals
            && let StressVerdict::Rank(rank) = self.by_pivots(&self.pick(intervals))
            && rank == self.columns
        {
            return StressVerdict::Rank(rank);
        }
        match decider.decide(state) {
            StateDecision::Report(report) => StressVerdict::Rank(report.rank),
            StateDecision::Pole(why) => StressVerdict::Refused(why),
        }
    }

    fn by_pivots(&self, remaining: &[Interval]) -> StressVerdict {
        let arithmetic = Floats::<Interval>::new();
        let full = self.reduction.rows.len().min(self.reduction.columns.len());
        match certain_rank(&arithmetic, self.matrix(remaining), |v| v.mid().abs() / v.rad()) {
            // no row or column remains: the bound is the rank
            Ok(rank) if rank == full => StressVerdict::Rank(self.reduction.eliminated + rank),
            Ok(rank) => StressVerdict::AtLeast(self.reduction.eliminated + rank),
            Err(refusal) => StressVerdict::Refused(refusal.to_string()),
        }
    }
}

/// `|value - exact| / |exact|`, for an exact number that is not zero.
fn relative_error(value: DoubleDouble, exact: &RBig) -> f64 {
    match value.to_rational() {
        Some(value) => rational_to_f64(&((value - exact) / exact)).abs(),
        None => f64::NAN,
    }
}

/// The same for a value of at most 53 bits, by double-doubles where they reach.
fn quick_relative_error(value: DoubleDouble, exact: &RBig) -> f64 {
    let leading = DoubleDouble::from_rational(exact);
    if (1e-250..1e250).contains(&leading.to_f64().abs()) && value.to_f64().abs() < 1e250 {
        ((value - leading).to_f64() / leading.to_f64()).abs()
    } else {
        relative_error(value, exact)
    }
}

fn by_spectrum(spectrum: Option<Spectrum>, eliminated: usize) -> StressVerdict {
    match spectrum {
        Some(found) if found.tolerance.is_finite() && found.values.iter().all(|v| v.is_finite()) => {
            StressVerdict::Rank(eliminated + found.rank)
        }
        _ => StressVerdict::Refused("an entry, its error or a singular value is not finite".to_owned()),
    }
}
