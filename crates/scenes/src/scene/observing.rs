//! The measurements, and what is to be estimated from them.

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

/// The errors of the sensors. All zero unless given.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Sensor {
    /// `noise`: the standard deviation of s1 and s2, in m.
    pub noise: f64,
    /// `resolution`: measurements of s1 and s2 are rounded to multiples of it, in m.
    pub resolution: f64,
    /// `jitter`: the standard deviation of the time from one sample to the next, in s.
    pub jitter: f64,
}

/// `[sensor.NAME]`: the sensor of one column. A measurement is `gain * x(t - delay) + bias`, with normal errors, rounded.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Channel {
    /// `noise`: the standard deviation of a measurement, in the column's unit; that of `[sensor]` for s1 and s2 unless given, and zero for
    /// all others.
    pub noise: Option<f64>,
    /// `resolution`: measurements are rounded to multiples of it; as for the noise unless given.
    pub resolution: Option<f64>,
    /// `bias`: what is added, in the column's unit; 0 unless given. Of a simulated sensor: observers do not know it.
    pub bias: f64,
    /// `gain`: the factor by which it is multiplied; 1 unless given. Of a simulated sensor: observers do not know it.
    pub gain: f64,
    /// `delay`: by how much the measurement is late, in s; 0 unless given. Of a simulated sensor: observers do not know it.
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
    /// `spike`: a value this many usual departures off the prediction of its neighbours is a spike; 8 unless given, and none is with `inf`.
    pub spike: f64,
    /// `interpolation`: how columns that drive the model go from one sample to the next: `"polynomial"`, unless `"linear"` or `"hold"` is given.
    pub interpolation: Interpolation,
}

impl Default for Data {
    fn default() -> Self {
        Data { record: None, on_fault: OnFault::Stop, spike: 8.0, interpolation: Interpolation::default() }
    }
}

/// What is to be estimated, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct ObserverSettings {
    /// `methods`: one or more, none twice.
    pub methods: Vec<Method>,
    /// `estimate`: the estimated states, none twice. Others are taken from the record.
    pub estimate: Vec<String>,
    /// `known`: states and parameters of the model that no column gives and that are not estimated, with their values.
    pub known: BTreeMap<String, f64>,
    /// `inputs`: input fields of the model and the columns that drive them, as in `{ g1 = "tau1" }`; none unless given.
    pub inputs: BTreeMap<String, String>,
    /// `guess` or `guess_off`: the initial value of the search; where a body between palms is described, `"none"` unless given, and
    /// where another system is, `"sample"`.
    pub guess: Guess,
    /// `clamp`: estimated states that keep their first guess in the first window; none unless given.
    pub clamp: Vec<String>,
    /// `window`: the samples of one window; 80 unless given, or all where there are fewer.
    pub window: usize,
    /// `steps`: Newton steps a window; 5 unless given.
    pub steps: usize,
    /// `when_unobservable`: what to do while the outputs do not determine the state; `"integrate"` unless given.
    pub when_unobservable: WhenUnobservable,
    /// `unobservable_above`: the relative standard deviation (Cramér-Rao bound by the size of the state) above which a state counts as unobservable;
    /// 1 unless given.
    pub unobservable_above: f64,
    /// `inherit`: whether a window starts with the estimate and covariance of those before it; true unless given.
    pub inherit: bool,
    /// `whole`: whether all samples are one window (batch least squares), which grows from `window` samples to all; false unless given.
    pub whole: bool,
    /// `bounds`: lower and upper bounds of estimated quantities, by name.
    pub bounds: BTreeMap<String, [f64; 2]>,
    /// `loss`: the loss function of residuals; their squares unless given.
    pub loss: Loss,
    /// `[observer.shooting]`.
    pub shooting: Shooting,
    /// `[observer.kalman]`.
    pub kalman: Kalman,
    /// `[observer.unscented]`.
    pub unscented: Unscented,
    /// `[observer.high_gain]`.
    pub high_gain: HighGain,
    /// `mode`: the name of the scene's own model among `modes`.
    pub mode: String,
    /// `[[observer.modes]]`: other systems that may explain the measurements, window by window, beside the scene's own; none unless given.
    pub modes: Vec<ModeSettings>,
    /// `[[observer.library]]`: known bodies, one of which may have been measured; none unless given.
    pub library: Vec<LibraryBody>,
    /// `switch`: whether the rank decides which of `modes` answers each window, and how; the output error decides unless given.
    pub switch: Option<Switch>,
}

/// The condition for an observer to answer, where the rank decides.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Switch {
    /// `condition`: an observer does not answer a window in which the condition number of its codistribution exceeds this anywhere; 1e6 unless given.
    pub condition: f64,
}

impl Default for Switch {
    fn default() -> Self {
        Switch { condition: 1e6 }
    }
}

/// A system that may explain the measurements in some windows, and its estimated states.
#[derive(Clone, Debug, PartialEq)]
pub struct ModeSettings {
    /// `name`.
    pub name: String,
    /// `model`: as of the scene.
    pub model: PathBuf,
    /// `estimate`: as of `[observer]`, and instead of it.
    pub estimate: Vec<String>,
    /// `known`: values that no column gives and that are not estimated.
    pub known: BTreeMap<String, f64>,
    /// `inputs`: as of `[observer]`, and instead of those; none unless given.
    pub inputs: BTreeMap<String, String>,
    /// `bounds`: lower and upper bounds of estimated quantities, by name.
    pub bounds: BTreeMap<String, [f64; 2]>,
    /// `guess`: initial values of the search in any window; a state without one starts in the middle of its sample box.
    pub guess: BTreeMap<String, f64>,
}

/// A first guess.
#[derive(Clone, Debug, PartialEq)]
pub enum Guess {
    /// `guess`: a value for each estimated state.
    Values(BTreeMap<String, f64>),
    /// `guess_off`: each state is off the truth by this fraction of it (0.1: ten percent more). Only where there is a
    /// truth, in a simulation.
    Off(f64),
    /// `"none"`: the measurements of the first window give it. Only between two palms.
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
    /// `integration`: the first guess, integrated by the model; the reference without observer.
    Integration,
    /// `kalman`: the extended Kalman filter.
    Kalman,
    /// `unscented`: the unscented Kalman filter.
    Unscented,
    /// `smoother`: the extended Kalman filter with a backward pass of smoothing.
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

    /// The observer of multiple shooting.
    pub fn multiple_shooting(&self) -> MultipleShooting {
        MultipleShooting { window: self.window(WindowSearch::TrustRegion), shooting: self.shooting }
    }

    /// The observer by windows.
    pub fn window(&self, search: WindowSearch) -> MovingWindow {
        MovingWindow {
            method: search,
            window: self.window,
            steps: self.steps as u64,
            unobservable_above: self.unobservable_above,
            when_unobservable: self.when_unobservable,
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

    /// How it minimises the error of a window; of a method that works by windows.
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

    /// Whether it works by windows, with a test of each.
    pub fn is_by_windows(self) -> bool {
        self.search().is_some() || self == Method::MultipleShooting
    }
}

/// Studies, which repeat the estimate many times.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Study {
    /// `[study.noise]`: the error as a function of the noise.
    pub noise: Option<NoiseStudy>,
    /// `[study.basin]`: from which first guesses the search converges to the truth.
    pub basin: Option<BasinStudy>,
    /// `[study.curvature]`: the Cramér-Rao bounds with palms of other curvatures.
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
    /// `noise`: the standard deviation of the contacts' measurements, in m.
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
