//! What may be wrong with what is taken for known: a constant, a gain, the time of the outputs.

/// Something that is taken for known, and how an error of it would show.
#[derive(Clone, Debug, PartialEq)]
pub struct Suspect {
    /// The name of a constant, or of a column whose gain it is.
    pub name: String,
    /// What it is.
    pub kind: SuspectKind,
    /// The least error that is noticed with a probability of 0.99, by a test that says of a right model once in a thousand runs that it
    /// does not fit; relative, of a delay in s. None where no error can be distinguished from the unknowns.
    pub noticed: Option<f64>,
    /// By how much each estimate is off for each unit (100 %, or 1 s) by which the truth exceeds what is believed.
    pub shifts: Vec<f64>,
    /// By how much the truth would have to exceed what is believed to explain the measurements best, and the sum of squares that this takes
    /// off the residual.
    pub explains: (f64, f64),
    /// Other suspects whose errors have the same trace: it cannot be distinguished from these.
    pub same_as: Vec<String>,
}

/// What is taken for known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SuspectKind {
    /// A constant.
    Constant,
    /// The gain of a column that drives an input field.
    InputGain,
    /// The gain of an output.
    OutputGain,
    /// The time of the outputs, late against all else.
    Delay,
}

impl std::fmt::Display for Suspect {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.kind {
            SuspectKind::Constant => f.write_str(&self.name),
            SuspectKind::InputGain | SuspectKind::OutputGain => write!(f, "the gain of {}", self.name),
            SuspectKind::Delay => write!(f, "a delay of {}", self.name),
        }
    }
}

impl Suspect {
    /// An error of it as text: in percent, or of a delay in ms.
    pub fn in_words(&self, error: f64) -> String {
        match self.kind {
            SuspectKind::Delay => format!("{:.2e} ms", 1e3 * error),
            _ => format!("{:.2e} %", 100.0 * error),
        }
    }
}
