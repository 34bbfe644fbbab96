//! The possible outcomes of a claim.

use dashu::rational::RBig;
use palmistry_checker::{Refutation, VerdictRecord};
use palmistry_lang::{Basis, Expectation, FieldRole, Flaw, Looks};
use palmistry_rank::observability::WrittenState;

/// A state in exact numbers at which a statement fails.
#[derive(Clone, Debug, PartialEq)]
pub struct Witness {
    /// Name, exact value, and the nearest double, of everything that the statement mentions.
    pub state: WrittenState,
    /// The value of the left side: exact where it is rational and short, else to many certified digits.
    pub left: String,
    /// The value of the right side.
    pub right: String,
    /// Which entry differs, where matrices were compared: row and column, counted from one.
    pub entry: Option<(usize, usize)>,
    /// What the checker needs to find it again, and has confirmed; for an equation only.
    pub refutation: Option<Box<Refutation>>,
}

/// What is known of a statement.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// There is an exact argument.
    Proved {
        /// What decided it.
        engine: String,
        /// A bound on the probability that the argument fails, as a power of two; minus infinity where it cannot.
        log2_error: f64,
    },
    /// There is a counterexample.
    Refuted {
        /// What decided it.
        engine: String,
        /// The counterexample.
        witness: Witness,
    },
    /// Nothing is claimed: this is what a name means.
    Definition {
        /// In words.
        text: String,
    },
    /// Neither; the reason.
    Undecided {
        /// In words.
        why: String,
    },
}

impl Verdict {
    /// `proved`, `refuted`, `definition` or `undecided`.
    pub fn word(&self) -> &'static str {
        match self {
            Verdict::Definition { .. } => "definition",
            Verdict::Proved { .. } => "proved",
            Verdict::Refuted { .. } => "refuted",
            Verdict::Undecided { .. } => "undecided",
        }
    }

    pub(crate) fn undecided(why: impl Into<String>) -> Self {
        Verdict::Undecided { why: why.into() }
    }

    /// Whether it is the verdict that was expected.
    pub fn meets(&self, expected: Expectation) -> bool {
        matches!(
            (self, expected),
            (Verdict::Proved { .. }, Expectation::Proved)
                | (Verdict::Refuted { .. }, Expectation::Refuted)
                | (Verdict::Undecided { .. }, Expectation::Undecided)
        )
    }

    /// The verdict on several statements that are claimed together.
    pub(crate) fn all(verdicts: impl IntoIterator<Item = Verdict>) -> Verdict {
        let (mut engine, mut error, mut undecided) = (None, 0.0f64, None);
        for verdict in verdicts {
            match verdict {
                Verdict::Proved { engine: name, log2_error } => {
                    error += log2_error.exp2();
                    engine.get_or_insert(name);
                }
                Verdict::Refuted { .. } => return verdict,
                Verdict::Undecided { .. } | Verdict::Definition { .. } => {
                    undecided.get_or_insert(verdict);
                }
            }
        }
        match (undecided, engine) {
            (Some(verdict), _) => verdict,
            (None, Some(engine)) => Verdict::Proved { engine, log2_error: error.log2() },
            (None, None) => Verdict::undecided("nothing was claimed"),
        }
    }
}

/// What a statement comes to at the file's values, where that is another verdict than the one on all values.
#[derive(Clone, Debug, PartialEq)]
pub struct AtFilesValues {
    /// Name and value of the parameters that the statement depends on, in the order of the file.
    pub values: Vec<(String, RBig)>,
    /// `proved`, `refuted` or `undecided`.
    pub word: &'static str,
}

/// A claim of a file and what it came to.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// The file's name.
    pub file: String,
    /// The line and the column at which the claim's number or name stands in it, both counted from one.
    pub place: (usize, usize),
    /// The claim's number or name.
    pub id: String,
    /// The statement as it stands in the file; of a fault, the right one.
    pub statement: String,
    /// What is the matter with the form in the text; of a fault only.
    pub fault: Option<Flaw>,
    /// The form in the text as a statement, and what became of it; of a fault that can be stated.
    pub printed: Option<(String, Verdict)>,
    /// The words of the text; for a fault, where they are quoted.
    pub quoted: Option<String>,
    /// What a claim rests on. One whose sides are one expression holds by definition, whether the file says so or not.
    pub basis: Basis,
    /// The fault from which this one follows.
    pub follows: Option<String>,
    /// Where in the text a fault stands: its section and page.
    pub passage: Option<String>,
    /// Of a fault, whether a conclusion of the text changes.
    pub conclusion: Option<String>,
    /// How the names of the statements are displayed, where the file says so.
    pub looks: Looks,
    /// The abbreviations that these statements use, those of imported files too: name and meaning, as it is written.
    pub definitions: Vec<(String, String)>,
    /// The fields along which these statements differentiate: name and components, as they are written.
    pub differentiated_along: Vec<(String, String)>,
    /// The expression whose pole the claim is about, as it is written.
    pub pole_of: Option<String>,
    /// The verdict on the claim, or on the corrected form.
    pub verdict: Verdict,
    /// What has to hold for its terms to exist, in words: the verdict is about states at which all of it does.
    pub domain: Vec<String>,
    /// What the file expects; of a definition nothing.
    pub expected: Option<Expectation>,
    /// Whether everything is as the file expects.
    pub ok: bool,
    /// What the verdicts rest on, for a verdict file; empty where it was not to be kept.
    pub evidence: Vec<VerdictRecord>,
    /// The remark in the file.
    pub remark: Option<String>,
    /// The verdict at the file's values of its parameters, where it is another one.
    pub at_files_values: Option<AtFilesValues>,
    /// The same for the printed form of an erratum.
    pub printed_at_files_values: Option<AtFilesValues>,
    /// The fields of the Lie derivatives, where the claim is about the rank of the codistribution.
    pub fields: Vec<FieldRole>,
    /// Of a rank at all states: what it is on each of the sets that are left out, in words.
    pub beside: Vec<String>,
    /// Thin parts of the set that a proof does not speak of, in words.
    pub not_looked_at: Vec<String>,
    /// How long it took.
    pub seconds: f64,
}

impl Outcome {
    /// The verdict in a word: the fault's where the form in the text is refuted, if it can be stated, and the right one
    /// proved; `holds by definition`, `consequence` or `example` where a claim is proved that rests on that; else the verdict's own.
    pub fn word(&self) -> &'static str {
        match (self.fault, &self.printed) {
            (Some(fault), _) if self.ok => fault.word(),
            (Some(_), Some((_, printed))) if !matches!(printed, Verdict::Refuted { .. }) => printed.word(),
            (None, _) if matches!(self.verdict, Verdict::Proved { .. }) => self.basis.word(),
            _ => self.verdict.word(),
        }
    }

    /// The word that the file expects.
    pub fn expected_word(&self) -> &'static str {
        match (self.fault, self.expected) {
            (Some(fault), _) => fault.word(),
            (None, Some(Expectation::Proved)) => self.basis.word(),
            (None, Some(Expectation::Refuted)) => "refuted",
            (None, Some(Expectation::Undecided)) => "undecided",
            (None, None) => "definition",
        }
    }

    /// All words that an outcome can have, in the order in which reports count them.
    pub const WORDS: [&'static str; 12] = [
        "proved",
        "holds by definition",
        "definition",
        "consequence",
        "example",
        "erratum",
        "print or scan",
        "scanning fault",
        "convention",
        "loose wording",
        "refuted",
        "undecided",
    ];
}
