//! Scenes in space as they are written: their keys, and whether the values can be used.

use super::super::scene::check::{DEVIATIONS, is_deviation};
use super::super::scene::place::Places;
use super::super::scene::sample_times;
use super::measurements::SpaceSensor;
use super::record::COLUMNS;
use super::scene::{SpaceBody, SpaceObserver, SpaceScene};
use super::shape::ShapeKeys;
use crate::solid::FEWEST;
use palmistry_bodies::mechanics::moving::{Course, PushedPalm};
use palmistry_bodies::mechanics::spatial::{SpatialDrive, SpatialPalm};
use palmistry_io::foreign::name_of;
use palmistry_lang::{Code, Problem, ReadError, load};
use palmistry_observe::{FaultRules, OnFault};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The word that makes a scene one in space.
const SPATIAL: &str = "spatial";

/// The most samples: each is three rows of every least squares problem.
const MOST_SAMPLES: usize = 5_000;

/// The highest degree of a shape.
const MOST_DEGREE: usize = 12;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Keys {
    #[serde(deserialize_with = "palmistry_io::foreign::read_line")]
    title: String,
    #[serde(rename = "motion")]
    _motion: String,
    #[serde(default = "one")]
    seed: u64,
    duration: Option<f64>,
    samples: Option<usize>,
    rate: Option<f64>,
    #[serde(default = "down")]
    gravity: [f64; 3],
    body: Option<BodyKeys>,
    palms: PalmKeys,
    #[serde(default)]
    sensor: SensorKeys,
    data: Option<DataKeys>,
    #[serde(default)]
    observer: ObserverKeys,
}

fn one() -> u64 {
    1
}

fn down() -> [f64; 3] {
    [0.0, 0.0, -9.81]
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BodyKeys {
    shape: ShapeKeys,
    centre_of_mass: Option<[f64; 3]>,
    mass: f64,
    inertia_over_mass: Option<[f64; 6]>,
    #[serde(default)]
    orientation: [f64; 3],
    #[serde(default)]
    balanced: bool,
    #[serde(default)]
    rate: [f64; 3],
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PalmKeys {
    azimuth: [f64; 3],
    #[serde(default)]
    hinge: [[f64; 3]; 3],
    #[serde(default)]
    inertia: [f64; 3],
    #[serde(default)]
    curvature: [f64; 3],
    #[serde(default)]
    touch_point: [[f64; 2]; 3],
    prescribed: Option<[Course; 3]>,
    torques: Option<[PushedPalm; 3]>,
}

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct SensorKeys {
    noise: f64,
    resolution: f64,
    torque_noise: f64,
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

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct ObserverKeys {
    window: Option<usize>,
    degree: Option<usize>,
    least_radius: Option<f64>,
    greatest_radius: Option<f64>,
}

impl SpaceScene {
    /// Reads a scene in space; none where the file is a scene of another kind, or none.
    ///
    /// # Errors
    /// What is wrong with the file, and where.
    pub fn read(path: &Path) -> Option<Result<SpaceScene, ReadError>> {
        let text = load(path).ok()?;
        let value = toml::from_str::<toml::Table>(&text).ok()?;
        let is_spatial = value.get("motion").and_then(toml::Value::as_str) == Some(SPATIAL);
        is_spatial.then(|| SpaceScene::parse(&name_of(path), &text))
    }

    /// Reads a scene from a text; files are looked for from the folder of `name`.
    ///
    /// # Errors
    /// What is wrong with the text, and where.
    pub fn parse(name: &str, text: &str) -> Result<SpaceScene, ReadError> {
        let places = Places::of(text).map_err(|problem| problem.locate(name, text))?;
        let keys: Result<Keys, Problem> = toml::from_str(text).map_err(|error| places.explain(&error));
        keys.and_then(|keys| checked(keys, &places, name, text)).map_err(|problem| problem.locate(name, text))
    }
}

/// Marks a value.
struct Wrong<'a, 'b>(&'a Places<'b>);

impl Wrong<'_, '_> {
    fn at(&self, place: &str, message: impl Into<String>, help: &str) -> Problem {
        Problem::new(Code::SceneValue, &self.0.value(place), message, "this").help(help)
    }

    fn positive(&self, place: &str, value: Option<f64>) -> Result<(), Problem> {
        match value {
            Some(value) if !(value > 0.0 && value.is_finite()) => Err(self.at(
                place,
                format!("it has to be positive, and is {value}"),
                "give a number above zero",
            )),
            _ => Ok(()),
        }
    }
}

fn checked(keys: Keys, places: &Places, name: &str, text: &str) -> Result<SpaceScene, Problem> {
    let wrong = Wrong(places);
    if keys.title.trim().is_empty() {
        return Err(wrong.at("title", "the title is empty", "say what the experiment is, in a line"));
    }
    let SensorKeys { noise, resolution, torque_noise } = keys.sensor;
    for (place, value) in [("noise", noise), ("resolution", resolution), ("torque_noise", torque_noise)] {
        if !(value >= 0.0 && value.is_finite()) {
            let message = format!("it must not be negative, and is {value}");
            return Err(wrong.at(&format!("sensor.{place}"), message, "give zero or a number above it"));
        }
        if !is_deviation(value) {
            let message = format!("{value:e} has a square beyond any number");
            return Err(wrong.at(&format!("sensor.{place}"), message, DEVIATIONS));
        }
    }
    for (i, value) in keys.gravity.iter().enumerate() {
        if !value.is_finite() {
            return Err(wrong.at(&format!("gravity[{i}]"), "it is no finite number", "give m/s^2"));
        }
    }
    if keys.gravity == [0.0; 3] {
        let help = "give the acceleration in m/s^2, as in [0, 0, -9.81]; by the weight the mass is distinguished from the inertia of the palms' motors";
        return Err(wrong.at("gravity", "nothing holds a body on its palms", help));
    }
    let geometry: [SpatialPalm; 3] = std::array::from_fn(|i| SpatialPalm {
        azimuth: keys.palms.azimuth[i],
        hinge: keys.palms.hinge[i],
        inertia: keys.palms.inertia[i],
        curvature: keys.palms.curvature[i],
        touch: keys.palms.touch_point[i],
    });
    for (i, palm) in geometry.iter().enumerate() {
        if !palm.azimuth.is_finite() || palm.hinge.iter().any(|x| !x.is_finite()) {
            let help = "give azimuths in rad, points of hinges in m";
            return Err(wrong.at("palms", format!("palm {} is at no finite place", i + 1), help));
        }
        if !(palm.inertia >= 0.0 && palm.inertia.is_finite()) {
            let message = format!("a moment of inertia is {}", palm.inertia);
            return Err(wrong.at(&format!("palms.inertia[{i}]"), message, "give zero or more, in kg m^2"));
        }
        if !palm.curvature.is_finite() {
            let help = "give 1/m: 0 for a flat palm, above 0 for a sphere that bulges towards the body, below 0 for a hollow one";
            let message = format!("a curvature is {}", palm.curvature);
            return Err(wrong.at(&format!("palms.curvature[{i}]"), message, help));
        }
        let place = format!("palms.touch_point[{i}]");
        if palm.touch.iter().any(|x| !x.is_finite()) {
            let help = "give m along the hinge and up the palm";
            return Err(wrong.at(&place, "a sphere touches its plane at no finite place", help));
        }
        if palm.curvature == 0.0 && palm.touch != [0.0; 2] {
            let message = format!("palm {} is flat, and nothing touches its plane there", i + 1);
            return Err(wrong.at(&place, message, "give it a curvature, or [0, 0] here"));
        }
    }
    let observer = checked_observer(&keys.observer, &wrong)?;
    let folder = Path::new(name).parent().unwrap_or(Path::new(""));
    let mut faults = FaultRules::default();
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
        return Err(wrong.at("data.spike", message, "give a number of usual departures: 8 is usual"));
    }
    if let Some(unknown) = columns.keys().find(|name| !COLUMNS.contains(&name.as_str())) {
        let message = format!("'{unknown}' is no column that is known here");
        let help = format!("known are {}", COLUMNS.join(", "));
        return Err(wrong.at(&format!("data.columns.{unknown}"), message, &help));
    }
    let drive = match (keys.palms.prescribed, keys.palms.torques) {
        (Some(courses), None) => Some(SpatialDrive::Prescribed(courses)),
        (None, Some(pushed)) => Some(SpatialDrive::Torques(pushed)),
        (None, None) => None,
        (Some(_), Some(_)) => {
            let help = "give prescribed = [..] or torques = [..], for all three palms";
            return Err(wrong.at("palms", "the palms' motion is given twice", help));
        }
    };
    let body = keys.body.map(|body| read_body(body, places)).transpose()?;
    let mut scene = SpaceScene {
        title: keys.title,
        seed: keys.seed,
        times: Vec::new(),
        gravity: keys.gravity,
        body,
        palms: geometry,
        drive,
        sensor: SpaceSensor { noise, resolution, torque_noise },
        record,
        columns,
        faults,
        observer,
        name: name.to_owned(),
        text: text.to_owned(),
    };
    let simulates = scene.body.is_some() || scene.drive.is_some() || keys.duration.is_some();
    if scene.record.is_some() {
        if simulates {
            let help =
                "leave out [data]; or leave out duration, samples or rate, [body], and how the palms move";
            return Err(wrong.at("data", "the data is both simulated and recorded", help));
        }
        return Ok(scene);
    }
    let (true, true, Some(duration)) = (scene.body.is_some(), scene.drive.is_some(), keys.duration) else {
        let help = "give duration, samples or rate, [body], and prescribed or torques of [palms]; or name a recording in [data]: record = \"run.csv\"";
        return Err(wrong.at("title", "nothing is recorded and what is simulated is not all said", help));
    };
    wrong.positive("duration", Some(duration))?;
    wrong.positive("rate", keys.rate)?;
    let samples = match (keys.samples, keys.rate) {
        (Some(samples), None) => samples,
        (None, Some(rate)) => (duration * rate).min(1e9) as usize + 1,
        _ => {
            let message = "give 'samples' or 'rate', and not both";
            return Err(wrong.at("title", message, "for instance samples = 177"));
        }
    };
    if !(FEWEST..=MOST_SAMPLES).contains(&samples) {
        let place = if keys.rate.is_some() { "rate" } else { "samples" };
        let help = format!("let there be {FEWEST} to {MOST_SAMPLES}");
        return Err(wrong.at(place, format!("there would be {samples} samples"), &help));
    }
    if let Some(window) = scene.observer.window.filter(|window| *window > samples) {
        let message = format!("a window of {window} samples is longer than the record, which has {samples}");
        return Err(wrong.at(
            "observer.window",
            message,
            "leave it out: then all of the record is explained at once",
        ));
    }
    scene.times = sample_times(duration, samples, 0.0, scene.seed);
    Ok(scene)
}

fn checked_observer(keys: &ObserverKeys, wrong: &Wrong) -> Result<SpaceObserver, Problem> {
    if let Some(window) = keys.window.filter(|window| *window < FEWEST) {
        let help = format!(
            "let it have {FEWEST} and more, or leave it out: then all of the record is explained at once"
        );
        return Err(wrong.at(
            "observer.window",
            format!("a window of {window} samples determines no state"),
            &help,
        ));
    }
    if let Some(degree) = keys.degree.filter(|degree| *degree > MOST_DEGREE) {
        let help = format!("let it be no more than {MOST_DEGREE}, or leave it to the measurements");
        return Err(wrong.at("observer.degree", format!("the degree is {degree}"), &help));
    }
    wrong.positive("observer.least_radius", keys.least_radius)?;
    wrong.positive("observer.greatest_radius", keys.greatest_radius)?;
    if let (Some(least), Some(greatest)) = (keys.least_radius, keys.greatest_radius)
        && least > greatest
    {
        let message = format!("the least radius of curvature is {least}, and the greatest {greatest}");
        return Err(wrong.at("observer.least_radius", message, "let it be no greater than the greatest"));
    }
    Ok(SpaceObserver {
        window: keys.window,
        degree: keys.degree,
        radii: [keys.least_radius, keys.greatest_radius],
    })
}

fn read_body(keys: BodyKeys, places: &Places) -> Result<SpaceBody, Problem> {
    Ok(SpaceBody {
        form: keys.shape.form(places, "body.shape", 0)?,
        centre: keys.centre_of_mass,
        mass: keys.mass,
        inertia: keys.inertia_over_mass,
        orientation: keys.orientation,
        balanced: keys.balanced,
        rate: keys.rate,
    })
}
