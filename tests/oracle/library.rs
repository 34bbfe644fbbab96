//! What the library says: the only file of the oracle that calls it.

use dashu::rational::RBig;
use palmistry::certificate::{BoxStanding, Limits, Region, RegionRows};
use palmistry::drops::{DropAnswer, where_it_drops};
use palmistry::expression::Symbol;
use palmistry::number::{Interval, RealNumber};
use palmistry::observability::{Solutions, SolutionsOf};
use palmistry::sweep::{BranchAnswer, Certainty, SolutionsWanted};
use palmistry::{Outcome, RankQuestion, System, Verdict, answer_rank, answer_solutions, decide_all};
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::atomic::AtomicBool;

/// The words of a verdict that matter here.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Word {
    Proved,
    Refuted,
    Undecided,
}

/// A verdict.
#[derive(Clone, Debug, PartialEq)]
pub struct Said {
    pub id: String,
    pub word: Word,
    /// The engine, or why it is undecided.
    pub why: String,
    pub witness: Option<Shown>,
    /// The verdict at the values that the file gives to parameters, where it is another one.
    pub at_files_values: Option<&'static str>,
}

/// A witness as it is printed.
#[derive(Clone, Debug, PartialEq)]
pub struct Shown {
    pub state: Vec<(String, String)>,
    pub left: String,
    pub right: String,
}

impl Shown {
    /// Whether a number of it is told as a zero of a polynomial, which the witnesses here do not read; `one_variable` judges those, whose
    /// zeros it knows.
    pub fn is_a_zero(&self) -> bool {
        self.state.iter().any(|(_, value)| value.contains("(a zero of "))
    }
}

/// Runs something of the library; a panic is told as such.
fn caught<T>(run: impl FnOnce() -> Result<T, String>) -> Result<T, String> {
    catch_unwind(AssertUnwindSafe(run)).unwrap_or_else(|payload| {
        let text = payload.downcast_ref::<String>().cloned();
        let text = text.or_else(|| payload.downcast_ref::<&str>().map(|text| (*text).to_owned()));
        Err(format!("panicked: {}", text.unwrap_or_default()))
    })
}

fn read(text: &str) -> Result<System, String> {
    System::parse("drawn.proof", text, Path::new("")).map_err(|error| format!("not read: {error:?}"))
}

fn said(outcome: &Outcome) -> Said {
    let (word, why, witness) = match &outcome.verdict {
        Verdict::Proved { engine, .. } => (Word::Proved, engine.clone(), None),
        Verdict::Refuted { engine, witness } => {
            let state = witness.state.iter().map(|at| (at.name.clone(), at.exact.clone())).collect();
            let shown = Shown { state, left: witness.left.clone(), right: witness.right.clone() };
            (Word::Refuted, engine.clone(), Some(shown))
        }
        Verdict::Undecided { why } => (Word::Undecided, why.clone(), None),
        other => (Word::Undecided, other.word().to_owned(), None),
    };
    let at_files_values = outcome.at_files_values.as_ref().map(|special| special.word);
    Said { id: outcome.id.clone(), word, why, witness, at_files_values }
}

/// The verdicts on the claims of a proof file.
pub fn verdicts(text: &str) -> Result<Vec<Said>, String> {
    caught(|| Ok(decide_all(&read(text)?, 1, &false.into(), &|_| ()).iter().map(said).collect()))
}

/// A rank at a state.
#[derive(Clone, Debug, PartialEq)]
pub struct RankSaid {
    /// The rank, where a single one was found.
    pub rank: Option<usize>,
    pub certified: bool,
    /// The length of the longest words.
    pub order: usize,
    /// The rank at almost all states, and whether longer words cannot raise it.
    pub generic: usize,
    pub is_final: bool,
    /// At how many states there was a pole.
    pub poles: u64,
}

/// The rank at a state that is given in full; all states are plain numbers, or angles at zero.
pub fn rank_at(text: &str, at: &[(String, RBig)]) -> Result<RankSaid, String> {
    let found = rank_of(text, at, &[], 1)?;
    let [only] = found.as_slice() else { return Err("not one branch".to_owned()) };
    Ok(only.clone())
}

/// The ranks at some drawn states of each branch of conditions.
pub fn rank_where(text: &str, conditions: &[String]) -> Result<Vec<RankSaid>, String> {
    rank_of(text, &[], conditions, 3)
}

fn rank_of(
    text: &str,
    at: &[(String, RBig)],
    conditions: &[String],
    samples: u64,
) -> Result<Vec<RankSaid>, String> {
    caught(|| {
        let mut system = read(text)?;
        let mut fixed = BTreeMap::new();
        for (name, value) in at {
            let symbol = system.find_symbol(name).ok_or("no such symbol")?;
            fixed.insert(symbol, value.clone());
        }
        let answer = answer_rank(
            &mut system,
            &RankQuestion {
                samples,
                seed: 1,
                wanted: Certainty::Certified,
                digits: None,
                order: None,
                fixed,
                conditions: conditions.to_vec(),
                recorded: 0,
                interrupt: &false.into(),
                progress: &|_| (),
            },
        )
        .map_err(|error| error.to_string())?;
        let said = |branch: &BranchAnswer| {
            let full = &branch.full;
            let histogram = &full.rank_histogram;
            RankSaid {
                rank: if histogram.len() == 1 { histogram.keys().next().copied() } else { None },
                certified: full.certified == full.samples && full.samples > 0,
                order: branch.order,
                generic: branch.generic_rank,
                is_final: branch.is_final,
                poles: full.poles.values().sum(),
            }
        };
        Ok(answer.branches.iter().map(said).collect())
    })
}

/// A state by the names of its coordinates, as it is printed.
type Named = Vec<(String, String)>;

/// Drawn states that meet conditions with their certified ranks, and whether the rank that was found is that of all Lie derivatives.
pub fn recorded(
    text: &str,
    conditions: Vec<String>,
    samples: u64,
) -> Result<Vec<(bool, Named, usize)>, String> {
    caught(|| {
        let mut system = read(text)?;
        let question = RankQuestion { samples, recorded: samples, conditions, ..RankQuestion::default() };
        let answer = answer_rank(&mut system, &question).map_err(|error| error.to_string())?;
        let mut found = Vec::new();
        for branch in &answer.branches {
            for one in &branch.full.recorded {
                let state = one.state.describe(&system);
                let named = state.iter().map(|at| (at.name.clone(), at.exact.clone())).collect();
                found.push((branch.is_final, named, one.rank));
            }
        }
        Ok(found)
    })
}

/// Where the rank of a file drops.
pub fn drops(text: &str) -> Result<DropAnswer, String> {
    caught(|| where_it_drops(&mut read(text)?, 1, &false.into()))
}

/// Which rows are certified.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rows {
    Own,
    Codistribution,
}

/// A search for boxes on which the rank is proved to be full.
pub struct Certificate {
    region: Region,
    symbols: BTreeMap<String, Symbol>,
    /// The proved fraction of the volume.
    pub proved: f64,
    /// The length of the longest words.
    pub order: Option<usize>,
}

/// Searches the sample box of a file.
pub fn certify(text: &str, rows: Rows, boxes: u64) -> Result<Certificate, String> {
    caught(|| {
        let mut system = read(text)?;
        let rows = match rows {
            Rows::Own => RegionRows::Own,
            Rows::Codistribution => RegionRows::Codistribution(None),
        };
        let mut region =
            Region::new(&mut system, rows, &BTreeMap::new(), None).map_err(|error| error.to_string())?;
        region.run(Limits { seconds: None, boxes: Some(boxes) }, &false.into(), &|_| ());
        let answer = region.answer();
        let symbols =
            system.symbols().map(|(symbol, _)| (system.symbol_name(symbol).to_owned(), symbol)).collect();
        Ok(Certificate { region, symbols, proved: answer.proved, order: answer.order })
    })
}

impl Certificate {
    /// Whether a state lies in proved boxes only; angles are given in radians as intervals that hold them.
    pub fn proves(&self, at: &[(String, (RBig, RBig))]) -> bool {
        let mut values = BTreeMap::new();
        for (name, (low, high)) in at {
            if let Some(symbol) = self.symbols.get(name) {
                let (low, high) = (Interval::from_rational(low), Interval::from_rational(high));
                values.insert(*symbol, low.hull(high));
            }
        }
        self.region.standing(|symbol| values.get(&symbol).copied()) == Some(BoxStanding::Proved)
    }
}

/// How many values each unknown of a file has, where that is a number.
pub fn numbers_of_values(text: &str) -> Result<Vec<(String, Option<usize>)>, String> {
    caught(|| {
        let mut system = read(text)?;
        let answer =
            answer_solutions(&mut system, SolutionsWanted::Values, 3_000_000, &AtomicBool::new(false))
                .map_err(|why| why.to_string())?;
        let count = |of_it: &SolutionsOf| match of_it.solutions {
            Solutions::Finite(count) => Some(count),
            _ => None,
        };
        Ok(answer.solutions.unknowns.iter().map(|of_it| (of_it.name.clone(), count(of_it))).collect())
    })
}
