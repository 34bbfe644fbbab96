//! Checks every value of a scene, and decides which of two ways to state a thing was used.

mod columns;
mod library;
mod observer;
mod physics;
mod robot;

use super::keys::{SceneKeys, SensorKeys};
use super::place::Places;
use super::{Scene, Simulated};
use palmistry_lang::{Code, Problem};
use std::collections::BTreeSet;
use std::ops::RangeInclusive;
use std::path::Path;

/// The name of standard input.
pub(super) const STREAM_NAME: &str = "-";

/// The most samples that a scene may ask for: each takes about a kilobyte.
const MOST_SAMPLES: usize = 1_000_000;

/// The source of the measurements, as far as other checks depend on it.
#[derive(Clone, Copy)]
pub(super) struct Source {
    /// The number of samples, where they are simulated.
    pub samples: Option<usize>,
    /// Whether errors of measurements are stated.
    pub is_noisy: bool,
    /// Whether a body between palms is described.
    pub has_palms: bool,
}

/// Reports values that are not allowed.
pub(super) struct Checks<'a> {
    places: &'a Places<'a>,
}

impl Checks<'_> {
    /// An error at a value.
    fn wrong(&self, place: &str, message: impl Into<String>, help: impl Into<String>) -> Problem {
        Problem::new(Code::SceneValue, &self.places.value(place), message, "this").help(help)
    }

    /// An error at a key: it should not be there, or something is missing beside it.
    fn wrong_key(&self, place: &str, message: impl Into<String>, help: impl Into<String>) -> Problem {
        Problem::new(Code::SceneValue, &self.places.key(place), message, "this").help(help)
    }

    fn finite(&self, place: &str, value: f64) -> Result<(), Problem> {
        if value.is_finite() {
            return Ok(());
        }
        Err(self.wrong(place, format!("'{}' is {value}", last(place)), "give a finite number"))
    }

    fn positive(&self, place: &str, value: f64, unit: &str) -> Result<(), Problem> {
        if value.is_finite() && value > 0.0 {
            return Ok(());
        }
        let finite = if value.is_infinite() { "finite " } else { "" };
        let help = format!("give a {finite}number above zero{}", spaced(unit));
        Err(self.wrong(place, format!("'{}' has to be positive, and is {value}", last(place)), help))
    }

    fn not_negative(&self, place: &str, value: f64, unit: &str) -> Result<(), Problem> {
        if value.is_finite() && value >= 0.0 {
            return Ok(());
        }
        let help = format!("give zero or a number above it{}", spaced(unit));
        Err(self.wrong(place, format!("'{}' must not be negative, and is {value}", last(place)), help))
    }

    /// The standard deviation of an error, or a resolution: zero where none is stated. Measurements are weighted by its square; where that is
    /// no number any more, an error that is stated would be taken for one that is not.
    fn deviation(&self, place: &str, value: f64, unit: &str) -> Result<(), Problem> {
        self.not_negative(place, value, unit)?;
        if is_deviation(value) {
            return Ok(());
        }
        let message = format!("'{}' is {value:e}, whose square is beyond any number", last(place));
        Err(self.wrong(place, message, format!("{DEVIATIONS}{}", spaced(unit))))
    }

    fn count(&self, place: &str, value: usize, range: RangeInclusive<usize>) -> Result<(), Problem> {
        if range.contains(&value) {
            return Ok(());
        }
        let help = format!("give a whole number from {} to {}", range.start(), range.end());
        Err(self.wrong(place, format!("'{}' cannot be {value}", last(place)), help))
    }

    /// Names, none of which may be empty or occur twice.
    fn names<T: Ord>(&self, place: &str, names: &[T], shown: impl Fn(&T) -> String) -> Result<(), Problem> {
        let mut seen = BTreeSet::new();
        for (index, name) in names.iter().enumerate() {
            let shown = shown(name);
            if shown.trim().is_empty() {
                return Err(self.wrong(
                    &format!("{place}[{index}]"),
                    "a name is empty",
                    "name it, or leave it out",
                ));
            }
            if !seen.insert(name) {
                let place = format!("{place}[{index}]");
                return Err(self.wrong(&place, format!("{shown} is there twice"), "leave one out"));
            }
        }
        Ok(())
    }
}

/// Whether errors of this size can be weighted, or are none.
pub(crate) fn is_deviation(value: f64) -> bool {
    value == 0.0 || value > 0.0 && (value * value).is_normal()
}

/// What to do about one that is none.
pub(crate) const DEVIATIONS: &str = "give zero where none is stated, or a number from 1e-150 to 1e150";

/// A key without the tables that it stands in and its index.
fn last(place: &str) -> &str {
    let key = place.rsplit('.').next().unwrap_or(place);
    key.split('[').next().unwrap_or(key)
}

fn spaced(unit: &str) -> String {
    if unit.is_empty() { String::new() } else { format!(", in {unit}") }
}

/// The scene of a file's keys.
pub(super) fn scene(keys: SceneKeys, places: &Places, name: &str, text: &str) -> Result<Scene, Problem> {
    let checks = Checks { places };
    if keys.title.trim().is_empty() {
        return Err(checks.wrong("title", "the title is empty", "say what the experiment is, in a line"));
    }
    for (place, path) in [("model", Some(&keys.model)), ("data.record", keys.data.record.as_ref())] {
        if path.is_some_and(|path| path.as_os_str().is_empty()) {
            return Err(checks.wrong(
                place,
                "the name of a file is empty",
                "name a file, relative to this one",
            ));
        }
    }
    let SensorKeys { sensor, channels } = keys.sensor;
    checks.sensor(&sensor)?;
    checks.channels(&channels, keys.data.record.is_some())?;
    // with an infinite threshold nothing is a spike
    if keys.data.spike != f64::INFINITY {
        checks.positive("data.spike", keys.data.spike, "usual departures")?;
    }
    let columns = checks.columns(keys.columns)?;
    let palm_forms = checks.forms(keys.palms.as_ref().and_then(|palms| palms.radii))?;
    let has_palms = keys.body.is_some() || keys.palms.is_some();
    let described =
        [("body", keys.body.is_some()), ("palms", keys.palms.is_some()), ("robot", keys.robot.is_some())];
    let span = checks.span(keys.duration, keys.samples, keys.rate, described)?;
    if keys.robot.is_some() && (has_palms || keys.start.is_some()) {
        let help = "leave out [body] and [palms], and [start]; or [robot] and [ground]";
        return Err(checks.wrong_key("robot", "a robot and something else are simulated at once", help));
    }
    let robot = checks.robot(span, keys.robot, keys.ground)?;
    let system = checks.system(span, keys.start, keys.inputs, has_palms)?;
    let simulated = match (span, &system, &robot) {
        (Some(span), None, None) => Some(checks.held(span, keys.body, keys.palms)?),
        _ => None,
    };
    match &span {
        None if keys.data.record.is_none() => {
            let message = "nothing is simulated and no data is recorded";
            let help = "give duration, samples and [start] with a value for each state, or [body] and [palms]; or name the \
                        recorded data in [data]: record = \"run.csv\"";
            return Err(checks.wrong_key("title", message, help));
        }
        Some(_) if keys.data.record.is_some() => {
            let message = "the data is both simulated and recorded";
            let help = "leave out 'record'; or leave out duration, samples or rate, and [start] or [body] and [palms]";
            return Err(checks.wrong_key("data.record", message, help));
        }
        _ => {}
    }
    if let Some(span) = span {
        checks.jitter(sensor.jitter, span)?;
        checks.delays(&channels, span)?;
    }
    checks.library(&keys.observer.library, &sensor, &channels, robot.as_ref())?;
    let is_noisy = sensor.noise > 0.0 || sensor.resolution > 0.0 || !channels.is_empty();
    let source =
        Source { is_noisy, samples: span.map(|(_, samples)| samples), has_palms: simulated.is_some() };
    let observer = checks.observer(keys.observer, source)?;
    checks.study(&keys.study, &observer, span.is_some())?;
    let folder = Path::new(name).parent().unwrap_or(Path::new(""));
    let mut observer = observer;
    observer.modes.iter_mut().for_each(|own| own.model = folder.join(&own.model));
    let mut data = keys.data;
    data.record =
        data.record.map(|record| if record == Path::new(STREAM_NAME) { record } else { folder.join(record) });
    Ok(Scene {
        title: keys.title,
        model: folder.join(keys.model),
        seed: keys.seed,
        simulated,
        system,
        robot,
        palm_forms,
        sensor,
        channels,
        columns,
        data,
        observer,
        study: keys.study,
        name: name.to_owned(),
        text: text.to_owned(),
    })
}
