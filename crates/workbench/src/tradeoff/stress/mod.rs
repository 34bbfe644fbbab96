//! The extremes: what each number type and each way to decide a rank makes of states that approach a singular set, of
//! quantities from 1e-150 to 1e150, and of other units; beside the truth, which is certified.
//!
//! A `Subject` is some rows of a system; `Approach`es are the sets to walk into; a [`Stress`] has both prepared and
//! [`Stress::run`]s. An evaluation that leaves the finite numbers cannot go on from here without being named: its
//! [`StressVerdict`] has no other place for it.
//!
//! Nothing here knows of palms; which quantities have which dimension is given from above.

mod approach;
mod changes;
mod finding;
mod jacobi;
mod line;
mod run;
mod scaling;
mod subject;
mod units;

#[doc(hidden)]
pub use changes::{unit_quantities, units};
#[doc(hidden)]
pub use line::{First, Line, LineLimit, OnTheSet};
#[doc(hidden)]
pub use run::{NamedRows, Stress, StressOptions, StressStudy, rows_of};
#[doc(hidden)]
pub use scaling::Scaling;
#[doc(hidden)]
pub use units::{Conditioning, Rescaling, UnitsRow};

/// A number type together with a way to decide a rank.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Way {
    /// Looks at nothing and says that the rank is full: what any column is to be compared with.
    AlwaysFull,
    /// Single precision throughout: singular values (one-sided Jacobi) of the equilibrated rows.
    Single,
    /// Doubles by numpy's rule (`matrix_rank`): singular values above `max(rows, columns) * 2^-52` of the largest one count.
    /// All rows, scaled to length one and not equilibrated, in the units of the file.
    Customary,
    /// Doubles, equilibrated, nothing known of the errors of the entries.
    Double,
    /// The same with the errors that intervals know: singular values that the errors may make zero do not count.
    Radii,
    /// Intervals of doubles: elimination with certain pivots. It proves a full rank or is undecided.
    Interval,
    /// Double-doubles throughout: singular values as for single precision.
    DoubleDouble,
    /// The number types of [`RankDecider`](palmistry_rank::sweep::RankDecider) in turn, certified: intervals, residues, exact numbers, enclosures.
    Escalation,
}

impl Way {
    /// All, from the cheapest; at last what `palmistry rank` does.
    pub const ALL: [Way; 8] = [
        Way::AlwaysFull,
        Way::Single,
        Way::Customary,
        Way::Double,
        Way::Radii,
        Way::Interval,
        Way::DoubleDouble,
        Way::Escalation,
    ];

    /// The place in [`Way::ALL`].
    pub fn place(self) -> usize {
        Way::ALL.iter().position(|way| *way == self).unwrap_or(0)
    }

    /// A short name.
    pub fn name(self) -> &'static str {
        match self {
            Way::AlwaysFull => "always full",
            Way::Single => "f32",
            Way::Customary => "f64, numpy's rule",
            Way::Double => "f64",
            Way::Radii => "f64 with radii",
            Way::Interval => "intervals",
            Way::DoubleDouble => "double-double",
            Way::Escalation => "escalation",
        }
    }

    /// The significant decimal digits of the number type.
    pub fn digits(self) -> f64 {
        let bits = match self {
            Way::Single => 24.0,
            Way::DoubleDouble => 106.0,
            _ => 53.0,
        };
        bits * std::f64::consts::LOG10_2
    }
}

/// What a way says of a rank. There is no room in it for a number that is not one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum StressVerdict {
    /// The rank.
    Rank(usize),
    /// Certainly at least this rank; whether more is undecided.
    AtLeast(usize),
    /// No rank, and the name of what stood in the way: the divisor that is zero, the operation that overflowed.
    Refused(String),
}

/// The quality of a verdict, from best to worst.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Mark {
    /// The right rank, with at least half of the digits.
    Right,
    /// The right rank, from entries of which one has lost more than half of its digits.
    Lost,
    /// Undecided.
    Open,
    /// It names what stands in the way.
    Refused,
    /// Another rank than the true one.
    Wrong,
}

impl Mark {
    /// A short name.
    pub fn name(self) -> &'static str {
        match self {
            Mark::Right => "right",
            Mark::Lost => "digits lost",
            Mark::Open => "cannot tell",
            Mark::Refused => "refused",
            Mark::Wrong => "wrong",
        }
    }
}
