//! What is known of a region.

use super::boxes::FreeCoordinate;
use super::progress::Progress;
use palmistry_lang::{CoordinateRange, FieldRole, Range};

/// What is proved of a box.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum BoxStanding {
    /// Full rank is proved at all its states.
    Proved,
    /// The system is defined at all its states, and a minor is proved to vanish at some of them.
    MinorVanishes,
    /// The system is proved not to be defined at some of its states.
    Pole,
    /// None of this is proved.
    Undecided,
}

/// A minor that was used for a proof.
#[derive(Clone, Debug, PartialEq)]
pub struct RegionMinor {
    /// The rows beside those that are unit vectors.
    pub rows: Vec<String>,
    /// Its factors: where the rows are defined, it vanishes where one of these does and nowhere else.
    pub factors: Vec<String>,
}

/// A factor that is proved to vanish in some open boxes.
#[derive(Clone, Debug, PartialEq)]
pub struct Vanishing {
    /// The factor.
    pub factor: String,
    /// The place of the minor that vanishes with it; `None` for a pole.
    pub minor: Option<usize>,
    /// How many boxes.
    pub boxes: u64,
    /// These boxes' share of the volume, in the coordinates of the part, rounded down.
    pub fraction: f64,
}

/// Coordinates that were examined separately from the others.
#[derive(Clone, Debug, PartialEq)]
pub struct PartAnswer {
    /// Their names.
    pub coordinates: Vec<String>,
    /// What has to be different from zero for the system to be defined.
    pub guards: Vec<String>,
    /// The factors that all minors have in common.
    pub common: Vec<String>,
    /// Of how many minors one has to be different from zero in addition; 0 if there is no such condition.
    pub alternatives: usize,
    /// The proved fraction of the volume in these coordinates, rounded down.
    pub proved: f64,
    /// The boxes that were looked at.
    pub boxes: u64,
    /// Those that are open.
    pub open_boxes: u64,
    /// The factors that are proved to vanish in open boxes.
    pub vanishing: Vec<Vanishing>,
}

/// An open box.
#[derive(Clone, Debug, PartialEq)]
pub struct OpenBox {
    /// The ranges of the coordinates that are restricted; the others take all their values.
    pub ranges: Vec<CoordinateRange<f64>>,
    /// How it stands.
    pub standing: BoxStanding,
    /// The factor that is proved to vanish in it.
    pub factor: Option<String>,
    /// Whether it is proved to contain no sampled state.
    pub avoided: bool,
    /// Its share of the volume, rounded down.
    pub fraction: f64,
}

/// A rectangle of a map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Patch {
    /// Its low and high end along the first coordinate of the map.
    pub x: (f64, f64),
    /// The same along the second one.
    pub y: (f64, f64),
    /// How it stands.
    pub standing: BoxStanding,
}

/// A plane through the box: the other coordinates are a third of their ranges from the low end.
#[derive(Clone, Debug, PartialEq)]
pub struct RegionMap {
    /// One coordinate.
    pub x: CoordinateRange<f64>,
    /// The other one.
    pub y: CoordinateRange<f64>,
    /// Rectangles that cover it.
    pub patches: Vec<Patch>,
    /// The other coordinates.
    pub at: Vec<(String, f64)>,
}

/// What is known of a region. Fractions are of the volume of the box.
#[derive(Clone, Debug, PartialEq)]
pub struct RegionAnswer {
    /// The file.
    pub file: String,
    /// The title of the system.
    pub title: String,
    /// The fields that move the states; the Lie derivatives are along these.
    pub fields: Vec<FieldRole>,
    /// The number of states.
    pub dimension: usize,
    /// The number of columns that remain after unit rows, and the columns of their entries, are taken out.
    pub columns: usize,
    /// The number of rows other than unit rows.
    pub rows: usize,
    /// The highest order of the Lie derivatives; `None` for a file's own rows.
    pub order: Option<usize>,
    /// The sides of the box, and whether anything depends on them.
    pub ranges: Vec<(FreeCoordinate, bool)>,
    /// The minors that were used.
    pub minors: Vec<RegionMinor>,
    /// The number of minors that these were chosen from.
    pub candidates: usize,
    /// Whether these are all the minors of the rows.
    pub all_minors: bool,
    /// The parts of the box that were examined separately.
    pub parts: Vec<PartAnswer>,
    /// The fraction on which full rank is proved; rounded down.
    pub proved: f64,
    /// The same as a fraction of what lies outside the avoided neighbourhoods; a lower bound.
    pub proved_of_sampled: f64,
    /// The fraction covered by boxes in which a minor is proved to vanish somewhere; rounded down.
    pub minor_vanishes: f64,
    /// The remaining fraction; rounded up.
    pub rest: f64,
    /// What sampled states keep away from.
    pub avoid: Vec<String>,
    /// Sides of the box that the file does not give, and what was taken for them.
    pub by_default: Vec<(String, Range)>,
    /// The boxes that were looked at.
    pub boxes: u64,
    /// Those that are open.
    pub open_boxes: u64,
    /// How long it took, in s.
    pub seconds: f64,
    /// Whether no open box is left.
    pub finished: bool,
    /// How the proved fraction grew.
    pub curve: Vec<Progress>,
    /// The largest open boxes, at most five of each part.
    pub largest: Vec<OpenBox>,
    /// A map of two coordinates, if two matter.
    pub map: Option<RegionMap>,
    /// Further remarks.
    pub remarks: Vec<String>,
    /// Conditions that the system and its rows need to exist and that hold nowhere; nothing is proved then.
    pub nowhere: Vec<String>,
}
