//! The searches of a fit in a file, so that an interrupted run goes on where it was.
//!
//! The file is text: a line that says what it is and of which question, and a line a search. Numbers are kept to the last bit, as hexadecimal words, so that a run in several
//! parts answers as one run does. It is replaced as a whole, at the end of each search and else once a second at most.

use palmistry_fit::{JointProblem, Keep, SearchState, StartEnd};
use palmistry_io::file::{read_text, write_whole};
use palmistry_rank::sweep::Fingerprint;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// What the first line begins with.
const HEAD: &str = "palmistry searches 1";

/// Between two writes of a search that goes on.
const PAUSE: Duration = Duration::from_secs(1);

/// The largest file that is read, in bytes.
const MOST: u64 = 64 << 20;

/// A file of searches.
pub struct SearchFile {
    path: PathBuf,
    question: u64,
    states: Mutex<Kept>,
}

struct Kept {
    searches: BTreeMap<usize, SearchState>,
    written: Option<Instant>,
    /// Why it could not be written last.
    failed: Option<String>,
}

impl SearchFile {
    /// The file of a question: what is in it where it is there, else none yet.
    ///
    /// # Errors
    /// In words: it cannot be read, is damaged, or is of another question.
    pub fn open(path: &Path, question: u64, bounds: &[[f64; 2]]) -> Result<SearchFile, String> {
        let searches = match path.try_exists() {
            Ok(false) => BTreeMap::new(),
            _ => {
                let text = read_text(path, MOST).map_err(|why| why.to_string())?;
                read(&text, question, bounds)?
            }
        };
        let states = Mutex::new(Kept { searches, written: None, failed: None });
        Ok(SearchFile { path: path.to_owned(), question, states })
    }

    /// How many searches it has that have ended, and how many that go on.
    pub fn counts(&self) -> [usize; 2] {
        let states = self.states.lock().unwrap_or_else(PoisonError::into_inner);
        let ended = states.searches.values().filter(|state| state.end.is_some()).count();
        [ended, states.searches.len() - ended]
    }

    /// Writes it, and says why it could not be written last, where it could not.
    pub fn close(&self) -> Option<String> {
        let mut states = self.states.lock().unwrap_or_else(PoisonError::into_inner);
        self.write(&mut states);
        states.failed.take()
    }

    fn write(&self, states: &mut Kept) {
        let mut text = format!("{HEAD} {:016x}\n", self.question);
        for (number, state) in &states.searches {
            let _ = writeln!(text, "{number} {}", line(state));
        }
        states.failed =
            write_whole(&self.path, |out| out.write_all(text.as_bytes())).err().map(|why| why.to_string());
        states.written = Some(Instant::now());
    }
}

impl Keep for SearchFile {
    fn get(&self, number: usize) -> Option<SearchState> {
        self.states.lock().unwrap_or_else(PoisonError::into_inner).searches.get(&number).cloned()
    }

    fn put(&self, number: usize, state: &SearchState) {
        let mut states = self.states.lock().unwrap_or_else(PoisonError::into_inner);
        states.searches.insert(number, state.clone());
        if state.end.is_some() || states.written.is_none_or(|last| last.elapsed() > PAUSE) {
            self.write(&mut states);
        }
    }
}

/// What a fit depends on, as a number: the system, the experiments, the measurements, the parameters and the settings of its searches.
pub(super) fn question(problem: &JointProblem, (starts, steps, seed): (usize, u64, u64)) -> u64 {
    let mut found = Fingerprint::default();
    found.system(&problem.system);
    found.text(&format!("{starts} {steps} {seed}"));
    for one in &problem.parameters {
        let (name, scale, bounds, starts) = (&one.name, one.scale, one.bounds, one.starts);
        found.text(&format!("{name} {scale:?} {bounds:?} {starts:?} {:?} {:?}", one.nominal, one.prior));
    }
    let graph = &problem.system.graph;
    for one in &problem.experiments {
        found.text(&one.name);
        for phase in one.before.iter().chain([&one.phase]) {
            found.nodes(graph, &phase.rates);
            let given: Vec<bool> = phase.start.iter().map(Option::is_some).collect();
            found.text(&format!("{given:?}"));
            found.nodes(graph, &phase.start.iter().flatten().copied().collect::<Vec<_>>());
        }
    }
    for one in &problem.measurements {
        let (place, time, value) = (one.experiment, one.time.to_bits(), one.value.to_bits());
        found.text(&format!("{place} {} {time} {value} {:?} {:?}", one.output, one.scale, one.law));
        found.nodes(graph, &[one.expected, one.size]);
    }
    found.value()
}

fn line(state: &SearchState) -> String {
    let words = |values: &[f64]| {
        let all: Vec<String> = values.iter().map(|value| format!("{:016x}", value.to_bits())).collect();
        if all.is_empty() { "-".to_owned() } else { all.join(",") }
    };
    let (end, why) = match &state.end {
        None => ("on", ""),
        Some(StartEnd::Converged) => ("converged", ""),
        Some(StartEnd::StepsSpent) => ("spent", ""),
        Some(StartEnd::Stuck) => ("stuck", ""),
        Some(StartEnd::Interrupted) => ("interrupted", ""),
        Some(StartEnd::NoStart(why)) => ("none", why.as_str()),
    };
    let numbers = [&state.start[..], &state.place, &state.best, &state.objectives, &state.damping].map(words);
    let why = why.replace(char::is_control, " ");
    format!("{end} {} {} {why}", state.steps, numbers.join(" ")).trim_end().to_owned()
}

fn read(text: &str, question: u64, bounds: &[[f64; 2]]) -> Result<BTreeMap<usize, SearchState>, String> {
    let mut lines = text.lines();
    let head = lines.next().and_then(|line| line.strip_prefix(HEAD)).ok_or("it is no file of searches")?;
    if u64::from_str_radix(head.trim(), 16) != Ok(question) {
        return Err("it is of another question: another scene, other measurements, another seed, or another version of this program".to_owned());
    }
    let one = |(place, line): (usize, &str)| {
        search(line)
            .filter(|(_, state)| is_whole(state, bounds))
            .ok_or_else(|| format!("line {} of it is damaged", place + 2))
    };
    lines.enumerate().map(one).collect()
}

/// Whether a state has all its numbers, within the bounds of the parameters, and a damping that leads on.
fn is_whole(state: &SearchState, bounds: &[[f64; 2]]) -> bool {
    let places = [&state.start, &state.place, &state.best];
    let is_within = |place: &&Vec<f64>| {
        let all = place.iter().zip(bounds);
        place.len() == bounds.len() && all.into_iter().all(|(x, [low, high])| (low..=high).contains(&x))
    };
    let are_numbers = state.objectives.iter().all(|x| x.is_finite());
    // a damping that does not grow would be tried for ever
    let [damping, growth] = state.damping;
    let grows = damping > 0.0 && damping.is_finite() && growth >= 2.0 && growth.is_finite();
    match &state.end {
        Some(StartEnd::NoStart(_)) => places.iter().all(|place| place.is_empty()),
        Some(_) => places.iter().all(is_within) && are_numbers,
        None => places.iter().all(is_within) && are_numbers && grows,
    }
}

fn search(line: &str) -> Option<(usize, SearchState)> {
    let mut parts = line.splitn(9, ' ');
    let number = parts.next()?.parse().ok()?;
    let end = parts.next()?;
    let steps = parts.next()?.parse().ok()?;
    let mut numbers = || -> Option<Vec<f64>> {
        let word =
            |word: &str| (word.len() == 16).then(|| u64::from_str_radix(word, 16).ok())?.map(f64::from_bits);
        match parts.next()? {
            "-" => Some(Vec::new()),
            words => words.split(',').map(word).collect(),
        }
    };
    let (start, place, best) = (numbers()?, numbers()?, numbers()?);
    let [objectives, damping] = [numbers()?, numbers()?].map(|pair| <[f64; 2]>::try_from(pair).ok());
    let why = parts.next().unwrap_or_default().to_owned();
    let end = match end {
        "on" => None,
        "converged" => Some(StartEnd::Converged),
        "spent" => Some(StartEnd::StepsSpent),
        "stuck" => Some(StartEnd::Stuck),
        "none" => Some(StartEnd::NoStart(why)),
        _ => return None,
    };
    let (objectives, damping) = (objectives?, damping?);
    Some((number, SearchState { start, place, best, objectives, damping, steps, end }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_no_search_has_written_is_damaged() {
        let bounds = [[0.0, 1.0], [-1.0, 1.0]];
        let place = vec![0.5, 1.0];
        let state = SearchState {
            start: place.clone(),
            place: place.clone(),
            best: place,
            objectives: [1.0, 1.0],
            damping: [1e-3, 2.0],
            steps: 3,
            end: None,
        };
        let read_back = |state: &SearchState| search(&format!("7 {}", line(state)));
        assert_eq!(read_back(&state), Some((7, state.clone())));
        assert!(is_whole(&state, &bounds));
        for damping in
            [[0.0, 0.0], [0.0, 2.0], [-1.0, 2.0], [1e-3, 1.0], [f64::NAN, 2.0], [1e-3, f64::INFINITY]]
        {
            assert!(!is_whole(&SearchState { damping, ..state.clone() }, &bounds), "{damping:?}");
        }
        for place in [vec![0.5], vec![0.5, 2.0], vec![f64::NAN, 0.0], Vec::new()] {
            assert!(!is_whole(&SearchState { place: place.clone(), ..state.clone() }, &bounds), "{place:?}");
        }
        let ended = SearchState { damping: [0.0; 2], end: Some(StartEnd::Converged), ..state };
        assert!(is_whole(&ended, &bounds) && read_back(&ended).is_some());
    }
}
