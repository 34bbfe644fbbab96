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

use crate::certificate::{RegionAnswer, certify_region};
use crate::claim::{Outcome, decide_all};
use crate::experiment::{Answer, Experiment};
use crate::system::{ReadError, System};
use crate::tradeoff::stress::Study;
use crate::tradeoff::{Growth, Trade, TradeQuestion, growth_of_lie_derivatives, trade};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
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
    /// Nothing found yet.
    pub fn begun(seed: u64) -> Verification {
        Verification {
            outcomes: Vec::new(),
            regimes: Vec::new(),
            appendix: None,
            routes: Vec::new(),
            growth: Vec::new(),
            trade: None,
            stress: Vec::new(),
            regions: Vec::new(),
            experiments: Vec::new(),
            seed,
            interrupted: false,
            seconds: 0.0,
        }
    }

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
    let found = Mutex::new(Verification::begun(options.seed));
    verify_into(options, &found)?;
    Ok(found.into_inner().unwrap_or_else(PoisonError::into_inner))
}

/// Runs the main job, and keeps each finding as soon as there is one: who cannot wait for the end may look.
///
/// # Errors
/// As for [`verify`].
pub fn verify_into(options: &Options<'_>, found: &Mutex<Verification>) -> Result<(), VerifyError> {
    let begin = Instant::now();
    let found = || found.lock().unwrap_or_else(PoisonError::into_inner);
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
    let failed = |step: &str| {
        let step = step.to_owned();
        move |why: String| VerifyError::Step { step, why }
    };

    for system in &systems {
        let before = found().outcomes.len();
        let outcomes = decide_all(system, options.seed, options.interrupt, &|outcome| {
            found().outcomes.push(outcome.clone());
            step(&format!("claim {}", outcome.id));
        });
        // as they came, and now in the order of the file
        found().outcomes.splice(before.., outcomes);
    }
    for (regime, system) in REGIMES.iter().zip(&systems) {
        if stopped() {
            break;
        }
        let result = regime.examine(system, &systems[0], options, &step).map_err(failed(regime.file))?;
        found().regimes.push(result);
    }
    if !stopped() {
        step("the appendix's determinants");
        let appendix = printed_values(&systems[0], options.seed).map_err(failed("appendix A.2"))?;
        found().appendix = Some(appendix);
    }
    if !stopped() {
        step("two routes to a Lie derivative");
        let routes = compare_routes(&systems[1], ROUTE_ORDERS, options.seed).map_err(failed("two routes"))?;
        found().routes = routes;
    }
    if !stopped() {
        step("the growth of the graph");
        let growth = growth_of_lie_derivatives(&systems[1], 0, 0, GROWTH_ORDERS);
        found().growth = growth;
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
        let trade = trade(&systems[0], &question).map_err(failed("speed against accuracy"))?;
        found().trade = Some(trade);
    }
    if !stopped() {
        step("the extremes");
        let studies = short_stress(&systems[..REGIMES.len()], options.seed, options.interrupt)
            .map_err(failed("the extremes"))?;
        found().stress = studies;
    }
    for system in systems[..REGIMES.len()].iter_mut().take_while(|_| !stopped()) {
        let name = format!("the box of {}", system.name);
        let region = certify_region(system, SUB_BOXES, options.interrupt).map_err(failed(&name))?;
        found().regions.push(region);
    }
    step("certificates on boxes");
    if !stopped() {
        step("bodies in motion");
        let experiments = motion::experiments(options).map_err(|error| VerifyError::Read(Box::new(error)))?;
        found().experiments = experiments;
    }
    let mut found = found();
    found.interrupted = stopped();
    found.seconds = begin.elapsed().as_secs_f64();
    Ok(())
}
