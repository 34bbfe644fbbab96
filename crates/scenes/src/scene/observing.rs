//! What is measured, and what is to be found out from it.

use super::simulated::LibraryBody;
use palmistry_observe::{
    HighGain, Integration, Interpolation, Kalman, Loss, MovingWindow, MultipleShooting, Observer, OnFault,
    Shooting, Smoother, Unscented, WhenUnobservable, WindowSearch,
};
use serde::Deserialize;
use serde::de::{Deserializer, Error, MapAccess, Visitor};
use std::collections::BTreeMap;
use std::fmt;
use std::path::PathBuf;

/// How well the sensors read. All zero unless given.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Sensor {
    /// `noise`: the standard deviation of s1 and s2, in m.
    pub noise: f64,
    /// `resolution`: readings of s1 and s2 are rounded to multiples of it, in m.
    pub resolution: f64,
    /// `jitter`: the standard deviation of the time from one sample to the next, in s.
    pub jitter: f64,
}

/// `[sensor.NAME]`: how one column is read. A reading is `gain * x(t - delay) + bias`, with normal errors, rounded.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Channel {
    /// `noise`: the standard deviation of a reading, in the column's unit; that of `[sensor]` for s1 and s2 unless given, and zero for
    /// all others.
    pub noise: Option<f64>,
    /// `resolution`: readings are rounded to multiples of it; as for the noise unless given.
    pub resolution: Option<f64>,
    /// `bias`: what is added, in the column's unit; 0 unless given. Of a simulated sensor: observers are not told.
    pub bias: f64,
    /// `gain`: by what it is multiplied; 1 unless given. Of a simulated sensor: observers are not told.
    pub gain: f64,
    /// `delay`: by how much the reading is late, in s; 0 unless given. Of a simulated sensor: observers are not told.
    pub delay: f64,
}

impl Default for Channel {
    fn default() -> Self {
        Channel { noise: None, resolution: None, bias: 0.0, gain: 1.0, delay: 0.0 }
    }
}

/// Recorded data, and what to do with a faulty row of it.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Data {
    /// `record`: the file, CSV or Parquet, or `-` for standard input; relative to the scene in the file, and here to where the program runs.
    pub record: Option<PathBuf>,
    /// `on_fault`: `"stop"`, unless `"skip"` is given.
    pub on_fault: OnFault,
    /// `spike`: a value this many usual departures off what its neighbours foretell is a spike; 8 unless given, and none is with `inf`.
    pub spike: f64,
    /// `interpolation`: how columns that drive the model go from one sample to the next: `"polynomial"`, unless `"linear"` or `"hold"` is given.
    pub interpolation: Interpolation,
}

impl Default for Data {
    fn default() -> Self {
        Data { record: None, on_fault: OnFault::Stop, spike: 8.0, interpolation: Interpolation::default() }
    }
}

/// What is to be found out, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct ObserverSettings {
    /// `methods`: one or more, none twice.
    pub methods: Vec<Method>,
    /// `estimate`: the states that are sought, none twice. Others are read from the record.
    pub estimate: Vec<String>,
    /// `known`: states and parameters of the model that no column gives and that are not sought, with their values.
    pub known: BTreeMap<String, f64>,
    /// `inputs`: input fields of the model and the columns that drive them, as in `{ g1 = "tau1" }`; none unless given.
    pub inputs: BTreeMap<String, String>,
    /// `guess` or `guess_off`: where the search begins; where a body between palms is described, `"none"` unless given, and
    /// where another system is, `"sample"`.
    pub guess: Guess,
    /// `clamp`: sought states that keep their first guess in the first window; none unless given.
    pub clamp: Vec<String>,
    /// `window`: the samples of one window; 80 unless given, or all where there are fewer.
    pub window: usize,
    /// `steps`: Newton steps a window; 5 unless given.
    pub steps: usize,
    /// `when_blind`: what to do while the outputs do not tell the state; `"integrate"` unless given.
    pub when_blind: WhenUnobservable,
    /// `blind`: the relative standard deviation (its bound by the size of the state) beyond which a state is not seen;
    /// 1 unless given.
    pub blind: f64,
    /// `inherit`: whether a window begins with what those before it have learned; true unless given.
    pub inherit: bool,
    /// `whole`: whether all samples are one window, which grows from `window` samples to all; false unless given.
    pub whole: bool,
    /// `bounds`: between what some of what is sought lies.
    pub bounds: BTreeMap<String, [f64; 2]>,
    /// `loss`: how residuals are weighed; by their squares unless given.
    pub loss: Loss,
    /// `[observer.shooting]`.
    pub shooting: Shooting,
    /// `[observer.kalman]`.
    pub kalman: Kalman,
    /// `[observer.unscented]`.
    pub unscented: Unscented,
    /// `[observer.high_gain]`.
    pub high_gain: HighGain,
    /// `mode`: what the scene's own model is called among `modes`.
    pub mode: String,
    /// `[[observer.modes]]`: other systems that the readings may be of, window by window, beside the scene's own; none unless given.
    pub modes: Vec<ModeSettings>,
    /// `[[observer.library]]`: known bodies of which one may be what was read; none unless given.
    pub library: Vec<LibraryBody>,
    /// `switch`: whether the rank decides which of `modes` answers each window, and how; by the error of the output unless given.
    pub switch: Option<Switch>,
}

/// Who may answer where the rank decides.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Switch {
    /// `condition`: an observer does not answer a window in which the condition of its codistribution exceeds this anywhere; 1e6 unless given.
    pub condition: f64,
}

impl Default for Switch {
    fn default() -> Self {
        Switch { condition: 1e6 }
    }
}

/// A system that the readings may be of in some windows, and what is sought of it.
#[derive(Clone, Debug, PartialEq)]
pub struct ModeSettings {
    /// `name`.
    pub name: String,
    /// `model`: as of the scene.
    pub model: PathBuf,
    /// `estimate`, `known`, `inputs`, `bounds`: as of `[observer]`, and instead of those.
    pub estimate: Vec<String>,
    /// What no column gives and is not sought.
    pub known: BTreeMap<String, f64>,
    /// `inputs`: as of `[observer]`, and instead of those; none unless given.
    pub inputs: BTreeMap<String, String>,
    /// Between what some of what is sought lies.
    pub bounds: BTreeMap<String, [f64; 2]>,
    /// `guess`: where the search begins in any window; what is not given begins in the middle of its sample box.
    pub guess: BTreeMap<String, f64>,
}

/// A first guess.
#[derive(Clone, Debug, PartialEq)]
pub enum Guess {
    /// `guess`: a value for each state that is sought.
    Values(BTreeMap<String, f64>),
    /// `guess_off`: each state is off the truth by this part of it (0.1: ten percent more). Only where there is a
    /// truth, in a simulation.
    Off(f64),
    /// `"none"`: the readings of the first window give it. Only between two palms.
    None,
    /// `"sample"`: the middle of the model's sample box.
    Sample,
}

/// A way to estimate a state.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// `newton`: Newton's method for the error of the output over a window (4.78).
    Newton,
    /// `trust-region`: the same error, with steps no longer than the quadratic model is trusted.
    TrustRegion,
    /// `multiple-shooting`: the same error, from several states of the sample box, by segments that are joined in the end.
    MultipleShooting,
    /// `integration`: the first guess, carried along by the model; the reference without observer.
    Integration,
    /// `kalman`: the extended Kalman filter.
    Kalman,
    /// `unscented`: the unscented Kalman filter.
    Unscented,
    /// `smoother`: the extended Kalman filter, corrected backwards by what was measured later.
    Smoother,
    /// `high-gain`: the high-gain observer.
    HighGain,
}

impl ObserverSettings {
    /// The observer of a method, with these settings.
    pub fn observer(&self, method: Method) -> Box<dyn Observer> {
        match method {
            Method::Newton => Box::new(self.window(WindowSearch::Newton)),
            Method::TrustRegion => Box::new(self.window(WindowSearch::TrustRegion)),
            Method::MultipleShooting => Box::new(self.multiple_shooting()),
            Method::Integration => Box::new(Integration),
            Method::Kalman => Box::new(self.kalman),
            Method::Unscented => Box::new(self.unscented),
            Method::Smoother => Box::new(Smoother { filter: self.kalman }),
            Method::HighGain => Box::new(self.high_gain),
        }
    }

    /// The observer by multiple shooting.
    pub fn multiple_shooting(&self) -> MultipleShooting {
        MultipleShooting { window: self.window(WindowSearch::TrustRegion), shooting: self.shooting }
    }

    /// The observer by windows.
    pub fn window(&self, search: WindowSearch) -> MovingWindow {
        MovingWindow {
            method: search,
            window: self.window,
            steps: self.steps as u64,
            blind: self.blind,
            when_blind: self.when_blind,
        }
    }
}

impl Method {
    /// Its name, as a scene writes it.
    pub fn name(self) -> &'static str {
        match self {
            Method::Newton => "newton",
            Method::TrustRegion => "trust-region",
            Method::MultipleShooting => "multiple-shooting",
            Method::Integration => "integration",
            Method::Kalman => "kalman",
            Method::Unscented => "unscented",
            Method::Smoother => "smoother",
            Method::HighGain => "high-gain",
        }
    }

    /// How it seeks the smallest error of a window; of a method that works by windows.
    pub fn search(self) -> Option<WindowSearch> {
        match self {
            Method::Newton => Some(WindowSearch::Newton),
            Method::TrustRegion => Some(WindowSearch::TrustRegion),
            Method::MultipleShooting
            | Method::Integration
            | Method::Kalman
            | Method::Unscented
            | Method::Smoother
            | Method::HighGain => None,
        }
    }

    /// Whether it works by windows, with a verdict on each.
    pub fn is_by_windows(self) -> bool {
        self.search().is_some() || self == Method::MultipleShooting
    }
}

/// What to try many times over.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Study {
    /// `[study.noise]`: how the error grows with noise.
    pub noise: Option<NoiseStudy>,
    /// `[study.basin]`: from which first guesses the search arrives.
    pub basin: Option<BasinStudy>,
    /// `[study.curvature]`: what palms of other curvatures tell.
    pub curvature: Option<CurvatureStudy>,
}

impl Study {
    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        *self == Study::default()
    }
}

/// Pairs of palms of other forms, each tried in several motions of the body.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CurvatureStudy {
    /// `range`: the least and the greatest curvature of either palm, in 1/m: above zero of hollow palms, zero of flat ones.
    pub range: [f64; 2],
    /// `points`: how many curvatures of each palm, both ends included.
    pub points: usize,
    /// `orientations`: `phi0` at the start of each motion, in rad.
    pub orientations: Vec<f64>,
    /// `rates`: `omega0` at the start, in rad/s; each orientation begins with each rate.
    pub rates: Vec<f64>,
    /// `noise`: the standard deviation of the contacts' readings, in m.
    pub noise: f64,
}

/// Each level of noise, tried with many seeds.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NoiseStudy {
    /// `levels`: standard deviations of s1 and s2, in m.
    pub levels: Vec<f64>,
    /// `seeds`: how many for each level.
    pub seeds: usize,
}

/// First guesses on a grid.
#[derive(Clone, Debug, PartialEq)]
pub struct BasinStudy {
    /// For each state that the grid spans, a key of its name: the least and the greatest guess.
    pub ranges: BTreeMap<String, [f64; 2]>,
    /// `points`: the points of the grid along each range, both ends included.
    pub points: usize,
}

/// By hand, because every key but one is the name of a state.
impl<'de> Deserialize<'de> for BasinStudy {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Keys;
        impl<'de> Visitor<'de> for Keys {
            type Value = BasinStudy;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a table of ranges and 'points'")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<BasinStudy, A::Error> {
                let (mut ranges, mut points) = (BTreeMap::new(), None);
                while let Some(key) = map.next_key::<String>()? {
                    if key == "points" {
                        points = Some(map.next_value()?);
                    } else {
                        ranges.insert(key, map.next_value()?);
                    }
                }
                Ok(BasinStudy { ranges, points: points.ok_or_else(|| A::Error::missing_field("points"))? })
            }
        }
        deserializer.deserialize_map(Keys)
    }
}
