//! The main job: every claim of the thesis's files, the rank of every regime on its singular sets, the appendix's
//! numbers and where their last digits come from. Between floors 6 and 7: it calls everything below and draws nothing.
//!
//! This is the one place beside `proofs/` (and the mechanics to come) that knows that there are palms.

mod appendix;
mod dimensions;
mod equations;
mod motion;
mod regimes;
mod routes;
mod stress;

pub use appendix::{Appendix, DETERMINANT, PrintedValue, printed_values};
pub use dimensions::{DIMENSIONS, UNIT_SYSTEMS, dimension};
pub use equations::{Equation, NUMBERED, equations, in_order_of_the_thesis};
pub use motion::SCENES;
pub use regimes::{Picture, REGIMES, Regime, RegimeResult, SingularSet};
pub use routes::{RouteAgreement, compare_routes};
pub use stress::{prepare_regimes, short_stress};

use crate::claim::{Outcome, decide_all};
use crate::experiment::{Answer, Experiment};
use crate::observability::region::{RegionAnswer, certify_region};
use crate::system::{ReadError, System};
use crate::tradeoff::stress::Study;
use crate::tradeoff::{Growth, Trade, TradeQuestion, growth_of_lie_derivatives, trade};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// How the main job is to be run.
pub struct Options<'a> {
    /// Where the thesis's files are.
    pub folder: &'a Path,
    /// Where the scenes are.
    pub scenes: &'a Path,
    pub seed: u64,
    /// Set from outside to stop early; what was found is kept.
    pub interrupt: &'a AtomicBool,
    /// Called with each step that is done, and with the number of all steps.
    pub progress: &'a (dyn Fn(&str, u64, u64) + Sync),
}

/// Everything that was found.
pub struct Verification {
    /// The claims of all files, in order.
    pub outcomes: Vec<Outcome>,
    pub regimes: Vec<RegimeResult>,
    pub appendix: Option<Appendix>,
    /// The two routes to a Lie derivative, order by order.
    pub routes: Vec<RouteAgreement>,
    /// The size of the graph, order by order.
    pub growth: Vec<Growth>,
    /// Speed against accuracy on the general regime, in short.
    pub trade: Option<Trade>,
    /// The extremes, in short: one study a regime.
    pub stress: Vec<Study>,
    /// Certificates on the sample boxes, after a few thousand sub-boxes: one a regime.
    pub regions: Vec<RegionAnswer>,
    /// Bodies in motion, and what observers made of them.
    pub experiments: Vec<(Experiment, Vec<Answer>)>,
    pub seed: u64,
    /// Whether it was stopped before the end.
    pub interrupted: bool,
    pub seconds: f64,
}

impl Verification {
    /// Whether everything is as the files expect.
    pub fn ok(&self) -> bool {
        !self.interrupted
            && self.outcomes.iter().all(|outcome| outcome.ok)
            && self.regimes.iter().all(RegimeResult::as_expected)
    }
}

/// Why the main job could not be done.
#[derive(Debug, thiserror::Error)]
pub enum VerifyError {
    /// A file cannot be used.
    #[error("{0}")]
    Read(Box<ReadError>),
    /// A step failed, in words.
    #[error("{step}: {why}")]
    Step { step: String, why: String },
}

/// The orders up to which the two routes are compared: duals double with each.
const ROUTE_ORDERS: usize = 7;
/// The orders of the growth curve.
const GROWTH_ORDERS: usize = 12;
/// A short version of `trade`.
const TRADE_STATES: u64 = 100;
const TRADE_ROUNDS: usize = 3;
/// Sub-boxes that are looked at in each regime.
const SUB_BOXES: u64 = 4000;

/// The proof files of the folder beside those of the regimes, in order of name.
fn other_files(folder: &Path) -> Result<Vec<String>, VerifyError> {
    let unreadable = |e: std::io::Error| VerifyError::Step {
        step: folder.display().to_string(),
        why: format!("cannot be read: {e}"),
    };
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(unreadable)? {
        let name = entry.map_err(unreadable)?.file_name().to_string_lossy().into_owned();
        if name.ends_with(".proof") && !REGIMES.iter().any(|regime| regime.file == name) {
            files.push(name);
        }
    }
    files.sort();
    Ok(files)
}

/// Runs the main job.
///
/// # Errors
/// A file that cannot be used, or a step that cannot be done.
pub fn verify(options: &Options<'_>) -> Result<Verification, VerifyError> {
    let begin = Instant::now();
    let read = |file: &str| {
        System::read(&options.folder.join(file)).map_err(|error| VerifyError::Read(Box::new(error)))
    };
    let mut systems = REGIMES.iter().map(|regime| read(regime.file)).collect::<Result<Vec<_>, _>>()?;
    for file in other_files(options.folder)? {
        systems.push(read(&file)?);
    }
    let claims: usize = systems.iter().map(|system| system.claims.len()).sum();
    let steps = claims as u64 + REGIMES.iter().map(Regime::steps).sum::<u64>() + 7;
    let counter = std::sync::atomic::AtomicU64::new(0);
    let step = |what: &str| {
        let done = counter.fetch_add(1, Ordering::Relaxed) + 1;
        (options.progress)(what, done, steps);
    };
    let stopped = || options.interrupt.load(Ordering::Relaxed);

    let outcomes: Vec<Outcome> = systems
        .iter()
        .flat_map(|system| {
            decide_all(system, options.seed, options.interrupt, &|o| step(&format!("claim {}", o.id)))
        })
        .collect();
    let mut regimes = Vec::new();
    for (regime, system) in REGIMES.iter().zip(&systems) {
        if stopped() {
            break;
        }
        let result = regime.examine(system, &systems[0], options, &step);
        regimes.push(result.map_err(|why| VerifyError::Step { step: regime.file.to_owned(), why })?);
    }
    let mut verification = Verification {
        outcomes,
        regimes,
        appendix: None,
        routes: Vec::new(),
        growth: Vec::new(),
        trade: None,
        stress: Vec::new(),
        regions: Vec::new(),
        experiments: Vec::new(),
        seed: options.seed,
        interrupted: false,
        seconds: 0.0,
    };
    if !stopped() {
        step("the appendix's determinants");
        let appendix = printed_values(&systems[0], options.seed);
        verification.appendix =
            Some(appendix.map_err(|why| VerifyError::Step { step: "appendix A.2".to_owned(), why })?);
    }
    if !stopped() {
        step("two routes to a Lie derivative");
        verification.routes = compare_routes(&systems[1], ROUTE_ORDERS, options.seed)
            .map_err(|why| VerifyError::Step { step: "two routes".to_owned(), why })?;
    }
    if !stopped() {
        step("the growth of the graph");
        verification.growth = growth_of_lie_derivatives(&systems[1], 0, 0, GROWTH_ORDERS);
    }
    if !stopped() {
        step("speed against accuracy");
        let question = TradeQuestion {
            samples: TRADE_STATES,
            seed: options.seed,
            rounds: TRADE_ROUNDS,
            interrupt: options.interrupt,
            progress: &|_, _| (),
        };
        let found = trade(&systems[0], &question);
        verification.trade =
            Some(found.map_err(|why| VerifyError::Step { step: "speed against accuracy".to_owned(), why })?);
    }
    if !stopped() {
        step("the extremes");
        verification.stress = short_stress(&systems[..REGIMES.len()], options.seed, options.interrupt)
            .map_err(|why| VerifyError::Step { step: "the extremes".to_owned(), why })?;
    }
    for system in systems[..REGIMES.len()].iter_mut().take_while(|_| !stopped()) {
        let found = certify_region(system, SUB_BOXES, options.interrupt);
        let found =
            found.map_err(|why| VerifyError::Step { step: format!("the box of {}", system.name), why })?;
        verification.regions.push(found);
    }
    step("certificates on boxes");
    if !stopped() {
        step("bodies in motion");
        verification.experiments =
            motion::experiments(options).map_err(|error| VerifyError::Read(Box::new(error)))?;
    }
    verification.interrupted = stopped();
    verification.seconds = begin.elapsed().as_secs_f64();
    Ok(verification)
}
