//! The largest likelihood, from many starts.

use super::checkpoint::{Keep, Kept, SearchCheckpoint};
use super::ends::{SearchEnd, StartEnd};
use super::information::Information;
use super::likelihood::{Likelihood, SimulatedExperiments};
use super::simulate::{Exactness, NotFollowed};
use super::trust::{Scoring, Search};
use argmin::core::{Executor, State};
use nalgebra::DVector;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Arc;

/// Every other search begins at the best of so many draws that can be simulated, the others at the first one: the best draw is often one at which nothing
/// happens that could be measured, and from there nothing is found.
const CANDIDATES: usize = 8;

/// After the searches, so many more begin near the best end, and again as long as one of them finds a better one.
const KICKS: usize = 10;
const ROUNDS: usize = 6;

/// So far from it, in decades, or as parts of the range on a linear scale: as standard deviations, one a search.
const KICK: [f64; 2] = [0.3, 1.0];

/// So many draws are tried at most.
const DRAWS: usize = 50;

/// So many steps are made from the end of the best search, simulated as answers are.
const LAST_STEPS: u64 = 50;

/// Two ends are one optimum whose logarithms of the likelihood differ by less than this, unless they lie apart.
const SAME: f64 = 0.1;

/// By how much the logarithm of the likelihood may fall within an interval of 95 %: half of the quantile of chi-square with one degree of freedom.
pub const ALLOWED: f64 = 3.841_458_820_694_124 / 2.0;

/// Ends that are as likely lie apart where a parameter differs by more than this many standard deviations: within its interval of 95 % it would by two.
const APART: f64 = 5.0;

/// What searches from many starts came to.
#[derive(Clone, Debug)]
pub struct JointFit {
    /// All searches, in the order of their starts.
    pub searches: Vec<SearchEnd>,
    /// How many of them began at random; the others near the best end of those before them.
    pub random: usize,
    /// The place of the best among them.
    pub best: usize,
    /// What is expected at the best.
    pub simulated: SimulatedExperiments,
}

impl JointFit {
    /// The search that came farthest.
    pub fn best(&self) -> &SearchEnd {
        &self.searches[self.best]
    }

    /// How many searches from random starts came to the best end, and how many others; `apart` are the searches that ended elsewhere.
    pub fn arrived(&self, apart: &[usize]) -> [usize; 2] {
        let least = self.best().objective;
        let came = |places: Range<usize>| {
            let is_there =
                |place: &usize| self.searches[*place].objective <= least + SAME && !apart.contains(place);
            places.filter(is_there).count()
        };
        [came(0..self.random), came(self.random..self.searches.len())]
    }

    /// The searches that ended as likely as the best one and elsewhere: a parameter that the information determines has another value there. Then
    /// neither its standard deviation nor an interval around the best value holds all values that explain the measurements.
    pub fn apart(&self, information: &Information) -> Vec<usize> {
        let best = self.best();
        let is_apart = |place: &usize| {
            let one = &self.searches[*place];
            let differs = (0..best.found.len()).any(|parameter| self.differs(information, one, parameter));
            one.objective <= best.objective + ALLOWED && differs
        };
        (0..self.searches.len()).filter(is_apart).collect()
    }

    /// The other values of a parameter at such ends, on its scale, in order; those within a deviation are one.
    pub fn other_values(&self, information: &Information, apart: &[usize], parameter: usize) -> Vec<f64> {
        let of_it = apart.iter().map(|place| &self.searches[*place]);
        let mut values: Vec<f64> = of_it
            .filter(|one| self.differs(information, one, parameter))
            .map(|one| one.found[parameter])
            .collect();
        values.sort_by(f64::total_cmp);
        let near = APART * information.deviations[parameter].unwrap_or(0.0);
        values.dedup_by(|next, before| *next - *before <= near);
        values
    }

    fn differs(&self, information: &Information, one: &SearchEnd, parameter: usize) -> bool {
        let deviation = information.deviations.get(parameter).copied().flatten();
        let off = one.found.get(parameter).map(|value| (value - self.best().found[parameter]).abs());
        off.zip(deviation).is_some_and(|(off, deviation)| off > APART * deviation)
    }
}

/// Searches from random starts within the bounds, evenly on the scales of the parameters; one start with one seed is the same on any number of threads.
/// Where the nominal values explain more than any of them comes to, a search begins there too. Searches that are kept go on from where they came to, with the
/// same answer as in one run.
///
/// # Errors
/// Why none of the starts could be simulated.
pub fn fit(
    likelihood: &Likelihood,
    (starts, steps, seed): (usize, u64, u64),
    keep: Option<&Arc<dyn Keep>>,
    interrupted: &(dyn Fn() -> bool + Sync),
    done: &(dyn Fn() + Sync),
) -> Result<JointFit, String> {
    let kept = |number: usize| keep.map(|keep| Kept { keep: Arc::clone(keep), number });
    let one = |number: usize| {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        random.set_stream(number as u64);
        let wanted = if number.is_multiple_of(2) { 1 } else { CANDIDATES };
        let found = going_on(likelihood, kept(number), steps, interrupted, |kept| {
            from_draws(likelihood, &mut random, (steps, wanted), kept, interrupted)
        });
        done();
        found
    };
    let mut searches: Vec<SearchEnd> = (0..starts).into_par_iter().map(one).collect();
    if let Some(place) = likelihood.problem().nominal()
        && is_within(likelihood, &place)
        && let Ok(here) = likelihood.at(&place, Exactness::Search, &|| interrupted())
        && least(&searches).is_none_or(|best| here.objective < best.objective - SAME)
    {
        searches.push(search(
            likelihood,
            &place,
            Some(here),
            &[],
            (steps, Exactness::Search, None),
            interrupted,
        ));
    }
    for round in 0..ROUNDS {
        let Some(best) = least(&searches).filter(|_| !interrupted()) else { break };
        let (objective, found) = (best.objective, best.found.clone());
        let one = |number: usize| {
            let number = starts + round * KICKS + number;
            let mut random = ChaCha8Rng::seed_from_u64(seed);
            random.set_stream(number as u64);
            going_on(likelihood, kept(number), steps, interrupted, |kept| {
                from_near(likelihood, &mut random, &found, (steps, kept), interrupted)
            })
        };
        let kicked: Vec<SearchEnd> = (0..KICKS).into_par_iter().map(one).collect();
        let is_better = kicked.iter().any(|one| one.objective < objective - SAME);
        searches.extend(kicked);
        if !is_better {
            break;
        }
    }
    best_of(likelihood, (searches, starts), interrupted)
}

/// A search that was kept goes on, or is what it was; else it begins.
fn going_on(
    likelihood: &Likelihood,
    kept: Option<Kept>,
    steps: u64,
    interrupted: &(dyn Fn() -> bool + Sync),
    begin: impl FnOnce(Option<&Kept>) -> SearchEnd,
) -> SearchEnd {
    if let Some(ended) = kept.as_ref().and_then(Kept::ended) {
        return ended;
    }
    let found = match kept.as_ref().and_then(Kept::begun) {
        Some(start) => {
            search(likelihood, &start, None, &[], (steps, Exactness::Search, kept.as_ref()), interrupted)
        }
        None => begin(kept.as_ref()),
    };
    if let Some(kept) = &kept {
        kept.end(&found);
    }
    found
}

/// Whether a place lies within the bounds.
fn is_within(likelihood: &Likelihood, place: &[f64]) -> bool {
    likelihood.problem().parameters.iter().zip(place).all(|(one, value)| {
        let [low, high] = one.scaled_bounds();
        (low..=high).contains(value)
    })
}

/// The search that came farthest.
fn least(searches: &[SearchEnd]) -> Option<&SearchEnd> {
    let by_objective = |a: &&SearchEnd, b: &&SearchEnd| a.objective.total_cmp(&b.objective);
    searches.iter().filter(|one| one.objective.is_finite()).min_by(by_objective)
}

/// A search from near a place.
fn from_near(
    likelihood: &Likelihood,
    random: &mut ChaCha8Rng,
    place: &[f64],
    (steps, kept): (u64, Option<&Kept>),
    interrupted: &(dyn Fn() -> bool + Sync),
) -> SearchEnd {
    let mut why = String::new();
    for _ in 0..DRAWS {
        let size = KICK[0] + random.random::<f64>() * (KICK[1] - KICK[0]);
        let kicked = |(one, place): (&super::EstimatedParameter, &f64)| {
            let [low, high] = one.scaled_bounds();
            let unit = match one.scale {
                super::ParameterScale::Linear => (high - low) / 8.0,
                super::ParameterScale::Log => std::f64::consts::LN_10,
                super::ParameterScale::Log10 => 1.0,
            };
            // by Box and Muller
            let [a, b] = [random.random::<f64>(), random.random::<f64>()];
            let normal = (-2.0 * (1.0 - a).ln()).sqrt() * (std::f64::consts::TAU * b).cos();
            (place + normal * size * unit).clamp(low, high)
        };
        let start: Vec<f64> = likelihood.problem().parameters.iter().zip(place).map(kicked).collect();
        match search_from(likelihood, start, (steps, kept), interrupted) {
            Ok(found) => return found,
            Err(error) => why = error,
        }
    }
    ended(Vec::new(), StartEnd::NoStart(why))
}

/// The best of some searches, followed to its end. One whose end cannot be simulated as exactly as answers are is none.
fn best_of(
    likelihood: &Likelihood,
    (mut searches, random): (Vec<SearchEnd>, usize),
    interrupted: &(dyn Fn() -> bool + Sync),
) -> Result<JointFit, String> {
    let simulate =
        |found: &[f64]| likelihood.at(found, Exactness::Answer, &|| false).map_err(|why| why.to_string());
    let mut order: Vec<usize> =
        (0..searches.len()).filter(|place| searches[*place].objective.is_finite()).collect();
    order.sort_by(|a, b| searches[*a].objective.total_cmp(&searches[*b].objective));
    let mut why_not = None;
    for place in order {
        let best = &searches[place];
        let here = match simulate(&best.found) {
            Ok(here) => here,
            Err(why) => {
                why_not.get_or_insert(why);
                continue;
            }
        };
        let last = search(
            likelihood,
            &best.found,
            Some(here),
            &[],
            (LAST_STEPS, Exactness::Answer, None),
            interrupted,
        );
        let simulated = match simulate(&last.found) {
            Ok(simulated) => simulated,
            Err(why) => {
                why_not.get_or_insert(why);
                continue;
            }
        };
        let best = &mut searches[place];
        best.steps += last.steps;
        best.objective = last.objective;
        best.found = last.found;
        if last.end != StartEnd::Interrupted {
            best.end = last.end;
        }
        return Ok(JointFit { searches, random, best: place, simulated });
    }
    Err(why_not.unwrap_or_else(|| match searches.first().map(|one| &one.end) {
        Some(StartEnd::NoStart(why)) => why.clone(),
        Some(StartEnd::Interrupted) => "interrupted".to_owned(),
        Some(_) => "at no start is the likelihood a finite number".to_owned(),
        None => "no start was asked for".to_owned(),
    }))
}

fn from_draws(
    likelihood: &Likelihood,
    random: &mut ChaCha8Rng,
    (steps, wanted): (u64, usize),
    kept: Option<&Kept>,
    interrupted: &(dyn Fn() -> bool + Sync),
) -> SearchEnd {
    let parameters = &likelihood.problem().parameters;
    let mut why = "no draw was made".to_owned();
    let mut candidates: Vec<(Vec<f64>, f64)> = Vec::new();
    for _ in 0..DRAWS {
        let draw = |one: &super::EstimatedParameter| {
            let [low, high] = one.scaled_bounds();
            let [from, to] = one.starts.map_or([low, high], |range| range.map(|end| one.scale.scaled(end)));
            (from + random.random::<f64>() * (to - from)).clamp(low, high)
        };
        let start: Vec<f64> = parameters.iter().map(draw).collect();
        match likelihood.objective(&start, Exactness::Search, &|| interrupted()) {
            Ok(here) => candidates.push((start, here)),
            Err(NotFollowed::Interrupted) => return ended(start, StartEnd::Interrupted),
            Err(error) => why = error.to_string(),
        }
        if candidates.len() == wanted {
            break;
        }
    }
    candidates.sort_by(|one, other| one.1.total_cmp(&other.1));
    for (start, _) in candidates {
        match search_from(likelihood, start, (steps, kept), interrupted) {
            Ok(found) => return found,
            Err(error) => why = error,
        }
    }
    ended(Vec::new(), StartEnd::NoStart(why))
}

/// A search from a start; an error says why it cannot be simulated.
fn search_from(
    likelihood: &Likelihood,
    start: Vec<f64>,
    (steps, kept): (u64, Option<&Kept>),
    interrupted: &(dyn Fn() -> bool + Sync),
) -> Result<SearchEnd, String> {
    match likelihood.at(&start, Exactness::Search, &|| interrupted()) {
        Ok(here) => {
            Ok(search(likelihood, &start, Some(here), &[], (steps, Exactness::Search, kept), interrupted))
        }
        Err(NotFollowed::Interrupted) => Ok(ended(start, StartEnd::Interrupted)),
        Err(error) => Err(error.to_string()),
    }
}

fn ended(start: Vec<f64>, end: StartEnd) -> SearchEnd {
    SearchEnd { found: start.clone(), start, objective: f64::INFINITY, steps: 0, end }
}

/// A search from a start, with some parameters fixed at their places. Where the simulation there is not given, the search goes on from what is kept.
pub(super) fn search(
    likelihood: &Likelihood,
    start: &[f64],
    here: Option<SimulatedExperiments>,
    held: &[usize],
    (steps, exactness, kept): (u64, Exactness, Option<&Kept>),
    interrupted: &(dyn Fn() -> bool + Sync),
) -> SearchEnd {
    let parameters = &likelihood.problem().parameters;
    let bounds = parameters.iter().enumerate().map(|(place, one)| match held.contains(&place) {
        true => [start[place]; 2],
        false => one.scaled_bounds(),
    });
    let problem = Search { likelihood, bounds: bounds.collect(), exactness, interrupted };
    let objective = here.as_ref().map_or(f64::INFINITY, |here| here.objective);
    let solver = here.map_or_else(Scoring::default, Scoring::from);
    let mut executor = Executor::new(problem, solver)
        .configure(|state| state.param(DVector::from_column_slice(start)).cost(objective).max_iters(steps))
        .ctrlc(false);
    if let Some(kept) = kept {
        executor = executor.checkpointing(SearchCheckpoint {
            kept: kept.clone(),
            start: start.to_vec(),
            most: steps,
        });
    }
    match executor.run() {
        Ok(result) => {
            let end = match (result.solver.converged, result.solver.stuck) {
                (true, _) => StartEnd::Converged,
                (_, true) => StartEnd::Stuck,
                _ => StartEnd::StepsSpent,
            };
            let found =
                result.state.get_best_param().map_or(start.to_vec(), |found| found.as_slice().to_vec());
            let objective = result.state.get_best_cost();
            SearchEnd { start: start.to_vec(), found, objective, steps: result.state.get_iter(), end }
        }
        Err(_) => SearchEnd { objective, ..ended(start.to_vec(), StartEnd::Interrupted) },
    }
}
