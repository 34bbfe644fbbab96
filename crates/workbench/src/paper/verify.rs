//! A paper taken through everything, file by file.

use super::bounds::{fewer_samples, left_to_a_command};
use super::findings::{DerivativesFound, FileFindings, Findings};
use super::folder::Paper;
use super::left_out::LeftOut;
use super::reduction::reduce;
use super::views::{draw, has_a_rank, rank_on};
use crate::tradeoff::stress::{Stress, StressOptions, StressStudy};
use crate::tradeoff::{
    LandscapeRows, TradeQuestion, compare_routes, compare_ways, growth_of_lie_derivatives, printed_values,
    trade,
};
use palmistry_io::UNINTERRUPTED;
use palmistry_lang::{ReadError, Statement, System, Time};
use palmistry_math::expression::syntax::{Expr, ExprKind};
use palmistry_prove::certificate::certify_region;
use palmistry_prove::claim::{decide_all, isolated};
use palmistry_prove::drops::where_it_drops;
use palmistry_scenes::joint::{JointExperiments, JointScene};
use palmistry_scenes::slow::{SlowExperiment, SlowScene};
use palmistry_scenes::space::{SpaceExperiment, SpaceScene};
use palmistry_scenes::{Experiment, Scene};
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Instant;

/// How a paper is to be verified.
pub struct VerifyOptions<'a> {
    /// The seed of all that is drawn.
    pub seed: u64,
    /// Set from outside to stop early; what was found is kept.
    pub interrupt: &'a AtomicBool,
    /// Called with each step when it begins, if it may take a while, and when it is done: with the number of steps that are done and of
    /// all.
    pub progress: &'a (dyn Fn(&str, u64, u64) + Sync),
    /// Whether parts of which only the times are of interest are run as well.
    pub timed: bool,
}

impl Default for VerifyOptions<'_> {
    /// The seed 1, all that is asked for, and nothing stops it.
    fn default() -> Self {
        VerifyOptions { seed: 1, timed: true, interrupt: &UNINTERRUPTED, progress: &|_, _, _| () }
    }
}

/// The orders up to which two routes to a Lie derivative are compared: duals double with each.
const ROUTE_ORDERS: usize = 7;
/// The orders of the growth curve.
const GROWTH_ORDERS: usize = 12;
/// A short version of `trade`.
const TRADE_STATES: u64 = 100;
const TRADE_ROUNDS: usize = 3;
/// Sub-boxes that are looked at in each sample box.
const SUB_BOXES: u64 = 4000;
/// A short version of `stress`: one line a set, a point for every five halvings, and so many states of the box and of each set.
const STRESS: (u64, usize, u64, u64) = (1, 5, 40, 2);

/// Verifies a paper.
///
/// # Errors
/// A file that cannot be used.
pub fn verify(paper: &Paper, options: &VerifyOptions<'_>) -> Result<Findings, ReadError> {
    let found = Mutex::new(Findings::begun(options.seed));
    verify_into(paper, options, &found)?;
    Ok(found.into_inner().unwrap_or_else(PoisonError::into_inner))
}

/// Verifies a paper, and keeps each finding as soon as there is one: who cannot wait for the end may look.
///
/// # Errors
/// As for [`verify`].
pub fn verify_into(
    paper: &Paper,
    options: &VerifyOptions<'_>,
    found: &Mutex<Findings>,
) -> Result<(), ReadError> {
    let begin = Instant::now();
    let systems = paper.systems()?;
    // before anything is decided: a mistake in a scene costs no claim
    let scenes = paper.scenes.iter().map(|scene| Observable::read(&paper.folder.join(scene)));
    let scenes = scenes.collect::<Result<Vec<_>, _>>()?;
    let run = Run { paper, options, found, steps: steps(paper, &systems), done: AtomicU64::new(0) };
    {
        let mut found = run.found();
        found.paper = paper.clone();
        if let Some(first) = systems.first().filter(|_| paper.title.is_empty()) {
            found.paper.title.clone_from(&first.title);
        }
        found.files = systems.iter().cloned().map(FileFindings::begun).collect();
    }
    let measured = |name: &Option<String>| {
        let named = name.as_ref().and_then(|name| systems.iter().position(|system| system.name == *name));
        named.or_else(|| systems.iter().position(has_a_rank))
    };
    let traded = measured(&paper.trade);
    let derived = measured(&paper.derivatives.clone().or_else(|| paper.trade.clone()));
    for (place, system) in systems.iter().enumerate() {
        run.claims(place, system);
    }
    // where some files name sets, maps or lines the others are only read and decided
    let any_named = systems.iter().any(names_something);
    for (place, system) in systems.iter().enumerate() {
        let measured = Measured {
            trade: options.timed && traded == Some(place),
            derivatives: derived == Some(place),
            extremes: names_something(system) || !any_named,
        };
        run.examine(place, system, &measured);
    }
    for (scene, name) in scenes.into_iter().zip(&paper.scenes).take_while(|_| !run.stopped()) {
        scene.observe(&run)?;
        run.step(name);
    }
    let mut found = run.found();
    found.interrupted = run.stopped();
    found.seconds = begin.elapsed().as_secs_f64();
    Ok(())
}

/// A scene of a paper with its measurements, of whichever kind it is.
enum Observable {
    Slow(Box<SlowExperiment>),
    Space(Box<SpaceExperiment>),
    Joint(Box<JointExperiments>),
    Moving(Box<Experiment>),
}

impl Observable {
    fn read(path: &Path) -> Result<Observable, ReadError> {
        if let Some(scene) = SpaceScene::read(path) {
            return Ok(Observable::Space(Box::new(SpaceExperiment::new(scene?, None)?)));
        }
        if let Some(scene) = SlowScene::read(path) {
            return Ok(Observable::Slow(Box::new(SlowExperiment::new(scene?, None)?)));
        }
        if let Some(scene) = JointScene::read(path) {
            return Ok(Observable::Joint(Box::new(JointExperiments::new(scene?, None)?)));
        }
        Ok(Observable::Moving(Box::new(Experiment::new(Scene::read(path)?, None)?)))
    }

    /// Runs it and keeps the answers from its measurements; for slow, space and joint scenes only if it ran to its end.
    fn observe(self, run: &Run<'_>) -> Result<(), ReadError> {
        match self {
            Observable::Slow(experiment) => {
                let answers = experiment.run(&|| run.stopped(), &|_| ());
                if !run.stopped() {
                    run.found().slow.push((*experiment, answers));
                }
            }
            Observable::Space(experiment) => {
                let answers = experiment.run(&|| run.stopped(), &|| ());
                if !run.stopped() {
                    run.found().space.push((*experiment, answers));
                }
            }
            Observable::Joint(experiments) => {
                let answer = experiments.run(None, &|| run.stopped(), &|| ());
                if !run.stopped() {
                    run.found().joint.push((*experiments, answer));
                }
            }
            Observable::Moving(experiment) => {
                let answers = experiment.run(run.options.interrupt, &|_| ())?;
                run.found().experiments.push((*experiment, answers));
            }
        }
        Ok(())
    }
}

/// What is done for a file besides what it asks for.
struct Measured {
    trade: bool,
    derivatives: bool,
    /// The extremes, and the certificate on the sample box.
    extremes: bool,
}

/// Of papers with more files only the pictures that they ask for are drawn.
const MOST_FILES_WITH_PICTURES: usize = 40;

/// Whether a file names sets, maps or lines.
fn names_something(system: &System) -> bool {
    !(system.sets.is_empty() && system.maps.is_empty() && system.lines.is_empty())
}

/// Whether a file claims what a rank is at all states, `rank = 6 except where g = 0`.
fn speaks_of_all_states(system: &System) -> bool {
    let statements = system.claims.iter().flat_map(|claim| claim.body.statements());
    let is_of_lie_derivatives = |expr: &Expr| matches!(&expr.kind, ExprKind::Name(name) if name == "rank");
    let is_one = |statement: &Statement| {
        let sides = [&statement.equation.left, &statement.equation.right];
        statement.except.is_some() && sides.into_iter().any(is_of_lie_derivatives)
    };
    statements.into_iter().any(is_one)
}

/// How many steps are announced.
fn steps(paper: &Paper, systems: &[System]) -> u64 {
    let of_system = |system: &System| {
        let ranks = match has_a_rank(system) {
            true => 4 + system.sets.len() + usize::from(speaks_of_all_states(system)),
            false => 0,
        };
        system.claims.len() + system.reductions.len() + ranks
    };
    (systems.iter().map(of_system).sum::<usize>() + paper.scenes.len() + 3) as u64
}

/// One verification under way.
struct Run<'a> {
    paper: &'a Paper,
    options: &'a VerifyOptions<'a>,
    found: &'a Mutex<Findings>,
    steps: u64,
    done: AtomicU64,
}

impl Run<'_> {
    fn found(&self) -> MutexGuard<'_, Findings> {
        self.found.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn stopped(&self) -> bool {
        self.options.interrupt.load(Ordering::Relaxed)
    }

    fn begin(&self, what: &str) {
        let done = self.done.load(Ordering::Relaxed);
        (self.options.progress)(what, done, self.steps.max(done + 1));
    }

    fn step(&self, what: &str) {
        let done = self.done.fetch_add(1, Ordering::Relaxed) + 1;
        (self.options.progress)(what, done, self.steps.max(done));
    }

    fn claims(&self, place: usize, system: &System) {
        let outcomes = decide_all(system, self.options.seed, self.options.interrupt, &|outcome| {
            self.found().files[place].outcomes.push(outcome.clone());
            self.step(&format!("claim {}", outcome.id));
        });
        // as they came, and now in the order of the file
        self.found().files[place].outcomes = outcomes;
    }

    /// Puts a finding in its place, or says what could not be done; nothing once it was stopped.
    fn keep<T>(
        &self,
        place: usize,
        what: &str,
        work: impl FnOnce() -> Result<T, String>,
        put: impl FnOnce(&mut FileFindings, T),
    ) {
        if self.stopped() {
            return;
        }
        self.begin(what);
        let result = isolated(work).and_then(|found| found);
        self.step(what);
        // what was broken off is no finding
        match result {
            Ok(found) => put(&mut self.found().files[place], found),
            Err(_) if self.stopped() => {}
            Err(why) => self.found().files[place].left_out.push(LeftOut { what: what.to_owned(), why }),
        }
    }

    /// Everything but the claims of one file.
    fn examine(&self, place: usize, system: &System, measured: &Measured) {
        let (seed, interrupt) = (self.options.seed, self.options.interrupt);
        if has_a_rank(system) {
            self.found().files[place].too_large.extend(fewer_samples(system));
            for set in std::iter::once(None).chain(system.sets.iter().map(Some)) {
                let what = set.map_or("the whole sample box", |set| &set.name);
                let rank = || Ok(rank_on(system, set, seed, interrupt));
                self.keep(place, what, rank, |file, rank| file.ranks.push(rank));
            }
            if speaks_of_all_states(system) {
                // where there is no such question the claims say why
                let drops = || Ok(where_it_drops(&mut system.clone(), seed, interrupt).ok());
                self.keep(place, "the singular set", drops, |file, found| file.drops = found);
            }
            // what an interrupt has left without a rank gets no picture that nobody asked for
            let observable = self.found().files[place].observable();
            let few = self.paper.files.len() <= MOST_FILES_WITH_PICTURES;
            let pictures = || {
                let mut left_out = Vec::new();
                Ok((
                    draw(system, observable.as_deref().filter(|_| few).unwrap_or(&[]), seed, &mut left_out),
                    left_out,
                ))
            };
            self.keep(place, "pictures", pictures, |file, ((maps, lines), left_out)| {
                (file.maps, file.lines) = (maps, lines);
                file.left_out.extend(left_out);
            });
        }
        for reduction in &system.reductions {
            if self.stopped() {
                return;
            }
            let what = format!("the reduction of {}", reduction.alias.text);
            self.begin(&what);
            let result = isolated(|| reduce(system, reduction, &self.paper.folder, seed, interrupt))
                .unwrap_or_else(|why| Err(LeftOut { what, why }));
            self.step("a reduction");
            let file = &mut self.found().files[place];
            match result {
                Ok(found) => file.reductions.push(found),
                Err(why) => file.left_out.push(why),
            }
        }
        if system.claims.iter().any(|claim| claim.body.statements().iter().any(|s| s.carried.is_some())) {
            let printed = || printed_values(system, seed);
            self.keep(place, "numbers in print", printed, |file, found| file.printed = found);
        }
        if measured.derivatives {
            let derivatives = || derivatives(system, seed);
            self.keep(place, "Lie derivatives", derivatives, |file, found| file.derivatives = Some(found));
        }
        if names_something(system) && has_a_rank(system) && system.time == Time::Continuous {
            let ways = || compare_ways(system, seed);
            self.keep(place, "automatic differentiation", ways, |file, found| file.ways = found);
        }
        if measured.trade && self.is_small_enough(place, system, "speed against accuracy", "trade") {
            let question = TradeQuestion {
                samples: TRADE_STATES,
                seed,
                rounds: TRADE_ROUNDS,
                interrupt,
                progress: &|_, _| (),
            };
            let trade = || trade(system, &question);
            self.keep(place, "speed against accuracy", trade, |file, found| file.trade = Some(found));
        }
        if has_a_rank(system) && measured.extremes {
            if self.is_small_enough(place, system, "the extremes", "stress") {
                let stress = || stress(system, seed, interrupt);
                self.keep(place, "the extremes", stress, |file, found| file.stress = Some(found));
            }
            let certify = || certify_region(&mut system.clone(), SUB_BOXES, interrupt);
            self.keep(place, "certified boxes", certify, |file, found| file.certificate = Some(found));
        }
    }
}

impl Run<'_> {
    /// Whether something is done here; if not, that is noted.
    fn is_small_enough(&self, place: usize, system: &System, what: &str, command: &str) -> bool {
        let left = left_to_a_command(system, what, command);
        let is_done = left.is_none();
        self.found().files[place].too_large.extend(left);
        is_done
    }
}

/// Lie derivatives of the first output along the first field that moves the states.
fn derivatives(system: &System, seed: u64) -> Result<DerivativesFound, String> {
    system.require_continuous("the ways to Lie derivatives are those along flows")?;
    let field = *system.moving_fields().first().ok_or("no field moves the states")?;
    Ok(DerivativesFound {
        field: system.fields[field].name.clone(),
        output: system.outputs[0].0.clone(),
        routes: compare_routes(system, field, 0, ROUTE_ORDERS, seed)?,
        growth: growth_of_lie_derivatives(system, field, 0, GROWTH_ORDERS),
    })
}

/// The extremes, in short.
fn stress(system: &System, seed: u64, interrupt: &AtomicBool) -> Result<StressStudy, String> {
    let (states, step, samples, samples_on_sets) = STRESS;
    let options = StressOptions { seed, states, step, samples, samples_on_sets, interrupt, progress: &|| () };
    Ok(Stress::of_file(&mut system.clone(), LandscapeRows::Own, &options)?.run(&options))
}
