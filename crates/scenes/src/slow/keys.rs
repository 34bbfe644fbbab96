//! Scenes of slow motion as they are written: their keys, and whether the values can be used.

use super::super::scene::check::{DEVIATIONS, is_deviation};
use super::super::scene::place::Places;
use super::super::scene::{Body, sample_times};
use super::families::Family;
use super::scene::{SlowPalms, SlowScene, SlowStudy};
use palmistry_bodies::mechanics::moving::Course;
use palmistry_bodies::mechanics::resting::plan_3_14;
use palmistry_io::foreign::name_of;
use palmistry_lang::{Code, Problem, ReadError, load};
use palmistry_observe::{FaultRules, OnFault};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The word that makes a scene one of slow motion.
const SLOW: &str = "quasistatic";

/// The most samples; each is a row of every least squares problem.
const MOST_SAMPLES: usize = 20_000;

/// The highest order of a study.
const MOST_ORDER: usize = 200;

/// The most bodies of a study.
const MOST_BODIES: usize = 10_000;

/// The columns that a recording has to have, by the names that the scene may change.
pub(super) const COLUMNS: [&str; 4] = ["phi1", "phi2", "s1", "s2"];

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Keys {
    #[serde(deserialize_with = "palmistry_io::foreign::read_line")]
    title: String,
    motion: String,
    #[serde(default = "one")]
    seed: u64,
    duration: Option<f64>,
    samples: Option<usize>,
    rate: Option<f64>,
    body: Option<Body>,
    palms: Option<PalmKeys>,
    #[serde(default)]
    sensor: SensorKeys,
    data: Option<DataKeys>,
    study: Option<StudyKeys>,
}

fn one() -> u64 {
    1
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PalmKeys {
    plan: Option<PlanKeys>,
    prescribed: Option<[Course; 2]>,
    lengths: Option<[f64; 2]>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PlanKeys {
    margin: f64,
    rounds: f64,
}

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct SensorKeys {
    noise: f64,
    resolution: f64,
    jitter: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct DataKeys {
    record: PathBuf,
    #[serde(default)]
    columns: BTreeMap<String, String>,
    #[serde(default)]
    on_fault: OnFault,
    #[serde(default = "usual_spike")]
    spike: f64,
}

fn usual_spike() -> f64 {
    FaultRules::default().spike
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct StudyKeys {
    bodies: usize,
    families: Vec<Family>,
    samples: Vec<usize>,
    #[serde(default = "exact_only")]
    resolutions: Vec<f64>,
    #[serde(default = "size")]
    size: f64,
    #[serde(default = "margin")]
    margin: f64,
    #[serde(default = "rounds")]
    rounds: f64,
    #[serde(default)]
    orders: Vec<usize>,
    jumps: Option<[usize; 2]>,
}

fn margin() -> f64 {
    0.15
}

fn rounds() -> f64 {
    2.0
}

fn exact_only() -> Vec<f64> {
    vec![0.0]
}

fn size() -> f64 {
    0.02
}

impl SlowScene {
    /// Reads a scene of slow motion; none where the file is a scene of another kind, or none.
    ///
    /// # Errors
    /// What is wrong with the file, and where.
    pub fn read(path: &Path) -> Option<Result<SlowScene, ReadError>> {
        let text = load(path).ok()?;
        let value = toml::from_str::<toml::Table>(&text).ok()?;
        let is_slow = value.get("motion").is_some();
        is_slow.then(|| SlowScene::parse(&name_of(path), &text))
    }

    /// Reads a scene from a text; files are looked for from the folder of `name`.
    ///
    /// # Errors
    /// What is wrong with the text, and where.
    pub fn parse(name: &str, text: &str) -> Result<SlowScene, ReadError> {
        let places = Places::of(text).map_err(|problem| problem.locate(name, text))?;
        let keys: Result<Keys, Problem> = toml::from_str(text).map_err(|error| places.explain(&error));
        keys.and_then(|keys| checked(keys, &places, name, text)).map_err(|problem| problem.locate(name, text))
    }
}

fn checked(keys: Keys, places: &Places, name: &str, text: &str) -> Result<SlowScene, Problem> {
    let wrong = |place: &str, message: String, help: &str| {
        Problem::new(Code::SceneValue, &places.value(place), message, "this").help(help)
    };
    if keys.title.trim().is_empty() {
        return Err(wrong("title", "the title is empty".into(), "say what the experiment is, in a line"));
    }
    if keys.motion != SLOW {
        let message = format!("the motion '{}' is not known", keys.motion);
        return Err(wrong(
            "motion",
            message,
            "say motion = \"quasistatic\" or \"spatial\" (three palms), or leave it out where bodies between two palms have inertia",
        ));
    }
    let sensor = &keys.sensor;
    for (place, value) in [
        ("sensor.noise", sensor.noise),
        ("sensor.resolution", sensor.resolution),
        ("sensor.jitter", sensor.jitter),
    ] {
        if !(value >= 0.0 && value.is_finite()) {
            return Err(wrong(
                place,
                format!("it must not be negative, and is {value}"),
                "give zero or a number above it",
            ));
        }
    }
    for (place, value) in [("sensor.noise", sensor.noise), ("sensor.resolution", sensor.resolution)] {
        if !is_deviation(value) {
            return Err(wrong(place, format!("{value:e} has a square beyond any number"), DEVIATIONS));
        }
    }
    let folder = Path::new(name).parent().unwrap_or(Path::new(""));
    // steps that vary so much are no gaps of a recording, as in every other scene
    let mut faults = FaultRules { jitter: sensor.jitter, ..FaultRules::default() };
    let (record, columns) = match keys.data {
        Some(data) => {
            (faults.on_fault, faults.spike) = (data.on_fault, data.spike);
            // standard input is in no folder
            let is_stream = data.record == Path::new("-");
            (Some(if is_stream { data.record } else { folder.join(&data.record) }), data.columns)
        }
        None => (None, BTreeMap::new()),
    };
    if faults.spike.is_nan() || faults.spike <= 0.0 {
        let message = format!("it has to be above zero, and is {}", faults.spike);
        return Err(wrong("data.spike", message, "give a number of usual departures: 8 is usual"));
    }
    if let Some(unknown) = columns.keys().find(|name| !COLUMNS.contains(&name.as_str())) {
        let message = format!("'{unknown}' is no column that is needed");
        return Err(wrong(&format!("data.columns.{unknown}"), message, "needed are phi1, phi2, s1 and s2"));
    }
    let study = keys.study.map(|study| checked_study(study, &wrong)).transpose()?;
    let mut scene = SlowScene {
        title: keys.title,
        seed: keys.seed,
        times: Vec::new(),
        body: keys.body,
        palms: None,
        noise: sensor.noise,
        resolution: sensor.resolution,
        record,
        columns,
        faults,
        study,
        name: name.to_owned(),
        text: text.to_owned(),
    };
    let simulates = keys.palms.is_some() || scene.body.is_some() || keys.duration.is_some();
    if scene.record.is_some() {
        if simulates {
            let help = "leave out [data]; or leave out duration, samples or rate, [body] and [palms]";
            return Err(wrong("data", "the data is both simulated and recorded".into(), help));
        }
        return Ok(scene);
    }
    let (Some(palms), true, Some(duration)) = (keys.palms, scene.body.is_some(), keys.duration) else {
        let help = "give duration, samples or rate, [body] and [palms]; or name a recording in [data]: record = \"run.csv\"";
        return Err(wrong("title", "nothing is recorded and what is simulated is not all said".into(), help));
    };
    if !(duration > 0.0 && duration.is_finite()) {
        return Err(wrong(
            "duration",
            format!("it has to be positive, and is {duration}"),
            "give a number above zero, in s",
        ));
    }
    let samples = match (keys.samples, keys.rate) {
        (Some(samples), None) => samples,
        (None, Some(rate)) if rate > 0.0 && rate.is_finite() => (duration * rate).min(1e9) as usize + 1,
        (None, Some(rate)) => {
            return Err(wrong(
                "rate",
                format!("it has to be positive, and is {rate}"),
                "give a number above zero, in Hz",
            ));
        }
        _ => {
            return Err(wrong(
                "title",
                "give 'samples' or 'rate', and not both".into(),
                "for instance samples = 270",
            ));
        }
    };
    if !(8..=MOST_SAMPLES).contains(&samples) {
        let place = if keys.rate.is_some() { "rate" } else { "samples" };
        let help = format!("let there be 8 to {MOST_SAMPLES}");
        return Err(wrong(place, format!("there would be {samples} samples"), &help));
    }
    let step = duration / (samples - 1) as f64;
    // accelerations go with the square of a rate
    if !step.powi(-2).is_normal() {
        let message = format!("samples {step:.3e} s apart: rates are beyond any number");
        return Err(wrong("duration", message, "give the duration in s"));
    }
    if sensor.jitter > 0.8 * step {
        let message = format!("a jitter of {} s is too much for samples {step:.3e} s apart", sensor.jitter);
        return Err(wrong("sensor.jitter", message, "give at most 0.8 of the time between samples"));
    }
    scene.times = sample_times(duration, samples, sensor.jitter, scene.seed);
    let lengths = palms.lengths.unwrap_or([f64::INFINITY; 2]);
    if lengths.iter().any(|length| length.is_nan() || *length <= 0.0) {
        return Err(wrong(
            "palms.lengths",
            "a pad has to have a positive length".into(),
            "give both in m, as in [0.0555, 0.0555]",
        ));
    }
    let courses = match (palms.plan, palms.prescribed) {
        (Some(plan), None) => plan_3_14(plan.margin, plan.rounds, duration).map_err(|error| {
            wrong("palms.plan", error.to_string(), "for instance plan = { margin = 0.15, rounds = 2 }")
        })?,
        (None, Some(courses)) => courses,
        _ => {
            let help = "give plan = { margin = 0.15, rounds = 2 }, the plan of figure 3.14, or the motions of both palms as prescribed = [..]";
            return Err(wrong("palms", "it has to be said how the palms move, once".into(), help));
        }
    };
    scene.palms = Some(SlowPalms { courses, lengths });
    Ok(scene)
}

fn checked_study(
    study: StudyKeys,
    wrong: &dyn Fn(&str, String, &str) -> Problem,
) -> Result<SlowStudy, Problem> {
    if !(1..=MOST_BODIES).contains(&study.bodies) {
        return Err(wrong("study.bodies", format!("there cannot be {}", study.bodies), "give 1 to 10000"));
    }
    if study.families.is_empty() || study.samples.is_empty() || study.resolutions.is_empty() {
        return Err(wrong(
            "study",
            "a list is empty".into(),
            "leave nothing to try for none of families, samples and resolutions",
        ));
    }
    if study.samples.iter().any(|samples| !(24..=MOST_SAMPLES).contains(samples)) {
        return Err(wrong("study.samples", "too few or too many samples".into(), "give 24 to 20000"));
    }
    if !study.resolutions.iter().all(|resolution| is_deviation(*resolution)) {
        return Err(wrong(
            "study.resolutions",
            "a resolution is negative or none, or its square is beyond any number".into(),
            "give zero or more, in m",
        ));
    }
    if !(study.size > 0.0 && study.size.is_finite()) {
        return Err(wrong(
            "study.size",
            format!("it has to be positive, and is {}", study.size),
            "give the mean radius in m",
        ));
    }
    if study.orders.iter().any(|order| !(2..=MOST_ORDER).contains(order)) {
        return Err(wrong("study.orders", "an order is too low or too high".into(), "give 2 to 200"));
    }
    if let Some([least, most]) = study.jumps
        && !(least <= most && most > 0)
    {
        return Err(wrong(
            "study.jumps",
            format!("there is no number of jumps from {least} to {most}"),
            "give the least and the most, as in [1, 4], or leave it out for none",
        ));
    }
    if let Err(error) = plan_3_14(study.margin, study.rounds, 1.0) {
        return Err(wrong("study", error.to_string(), "for instance margin = 0.15, rounds = 2"));
    }
    let StudyKeys { bodies, families, samples, resolutions, size, margin, rounds, orders, jumps } = study;
    Ok(SlowStudy { bodies, families, samples, resolutions, size, margin, rounds, orders, jumps })
}

#[cfg(test)]
mod tests {
    use super::SlowScene;

    fn scene(sensor: &str) -> Result<SlowScene, String> {
        let text = format!(
            "title = \"a\"\nmotion = \"quasistatic\"\n[sensor]\n{sensor}\n[data]\nrecord = \"run.csv\"\n"
        );
        SlowScene::parse("a.toml", &text).map_err(|error| error.message.clone())
    }

    /// A jitter that is stated is heeded of a recording, too.
    #[test]
    fn the_jitter_of_a_recording_arrives_at_its_rules() {
        assert_eq!(scene("jitter = 0.1").unwrap().faults.jitter, 0.1);
        assert_eq!(scene("").unwrap().faults.jitter, 0.0);
    }

    /// Errors whose squares are no numbers would count as none.
    #[test]
    fn errors_that_vanish_are_refused() {
        for sensor in ["noise = 1e-320", "resolution = 1e-200", "noise = 1e200"] {
            assert!(scene(sensor).unwrap_err().contains("beyond any number"), "{sensor}");
        }
        assert!(scene("noise = 0").is_ok() && scene("noise = 1e-9").is_ok());
    }
}
