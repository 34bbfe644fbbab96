//! The rank along a motion, and whether it objects to an observer that would answer there.

use std::fmt;

/// A zero of a divisor.
#[derive(Clone, Debug, PartialEq)]
pub struct PoleMet {
    /// What is divided by.
    pub divisor: String,
    /// When it is zero, in s; between two samples as a straight line has it.
    pub time: f64,
}

/// The observability rank along a motion through a window.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionRankFound {
    /// The number of samples that were examined.
    pub asked: usize,
    /// The number of those without a pole.
    pub decided: usize,
    /// The least rank, 0 where none was decided; equal to `of` where all states are observable.
    pub rank: usize,
    /// How many states are followed.
    pub of: usize,
    /// So many derivatives of each output were taken beside it: higher ones may raise the rank.
    pub order: usize,
    /// Whether each rank is proved for its state, the doubles taken as exact.
    pub certified: bool,
    /// The least singular value at the sample of the worst condition, equilibrated, of what remains without unit rows.
    pub smallest: f64,
    /// The worst condition; infinite where the rank is short.
    pub condition: f64,
    /// The time of the least rank, and of those of this rank of the worst condition, in s.
    pub at: f64,
    /// The first pole that the motion meets.
    pub pole: Option<PoleMet>,
    /// Why the motion could not be followed to the end of the window: then it is known only at the window's first sample.
    pub lost: Option<String>,
}

/// Why an observer had better not answer.
#[derive(Clone, Debug, PartialEq)]
pub enum Objection {
    /// Its equations have a pole on the way.
    Pole(PoleMet),
    /// The outputs and so many of their derivatives do not determine its state at some moment.
    Short {
        /// The rank there.
        rank: usize,
        /// What it would have to be.
        of: usize,
        /// In s.
        at: f64,
        /// Derivatives that were taken.
        order: usize,
    },
    /// Its state is badly conditioned at some moment.
    Condition {
        /// The largest over the smallest singular value there.
        condition: f64,
        /// In s.
        at: f64,
    },
    /// Its equations cannot be followed.
    Lost(String),
}

impl fmt::Display for Objection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Objection::Pole(PoleMet { divisor, time }) => {
                write!(f, "a singularity, {divisor} = 0 at {time:.4} s")
            }
            Objection::Short { rank, of, at, order } => {
                write!(f, "rank {rank} of {of} at {at:.4} s, from the outputs")?;
                if *order > 0 {
                    write!(f, " and their derivatives up to order {order}")?;
                }
                Ok(())
            }
            Objection::Condition { condition, at } => write!(f, "condition {condition:.1e} at {at:.4} s"),
            Objection::Lost(why) => write!(f, "its equations cannot be followed: {why}"),
        }
    }
}

impl Objection {
    /// As one word, for machines.
    pub fn word(&self) -> &'static str {
        match self {
            Objection::Pole(_) => "singularity",
            Objection::Short { .. } => "rank",
            Objection::Condition { .. } => "condition",
            Objection::Lost(_) => "lost",
        }
    }
}

impl MotionRankFound {
    /// What speaks against an observer whose condition must not exceed a limit.
    pub fn objection(&self, limit: f64) -> Option<Objection> {
        if let Some(pole) = &self.pole {
            return Some(Objection::Pole(pole.clone()));
        }
        if let Some(why) = &self.lost {
            return Some(Objection::Lost(why.clone()));
        }
        let Self { rank, of, condition, at, order, .. } = *self;
        if rank < of {
            return Some(Objection::Short { rank, of, at, order });
        }
        (condition > limit).then_some(Objection::Condition { condition, at })
    }
}
