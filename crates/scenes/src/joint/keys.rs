//! The scene as it is written, and whether its values can be used.

use super::super::scene::hints;
use super::super::scene::place::Places;
use palmistry_fit::{ErrorLaw, ErrorScale, ParameterScale, Prior, PriorLaw};
use palmistry_io::foreign::name_of;
use palmistry_lang::{Code, Problem, ReadError, load};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The most starts of a search, and the most steps of each.
const MOST_STARTS: usize = 100_000;
const MOST_STEPS: u64 = 100_000;

/// The most experiments, and the most parameters: each is a column of every derivative.
const MOST_EXPERIMENTS: usize = 10_000;
const MOST_PARAMETERS: usize = 1_000;

/// A number, or a formula.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(untagged)]
pub(super) enum Formula {
    Number(f64),
    Text(String),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Keys {
    #[serde(deserialize_with = "palmistry_io::foreign::read_line")]
    title: String,
    model: PathBuf,
    measurements: PathBuf,
    #[serde(default = "one")]
    seed: u64,
    #[serde(default)]
    initial: BTreeMap<String, Formula>,
    errors: BTreeMap<String, ErrorKeys>,
    parameters: BTreeMap<String, ParameterKeys>,
    #[serde(default)]
    known: BTreeMap<String, f64>,
    experiments: BTreeMap<String, ExperimentKeys>,
    #[serde(default)]
    search: SearchKeys,
}

fn one() -> u64 {
    1
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ErrorKeys {
    pub size: Formula,
    #[serde(default)]
    on: Scale,
    #[serde(default)]
    law: Law,
}

impl ErrorKeys {
    pub fn scale(&self) -> ErrorScale {
        match self.on {
            Scale::Linear => ErrorScale::Linear,
            Scale::Log => ErrorScale::Log,
            Scale::Log10 => ErrorScale::Log10,
        }
    }

    pub fn law(&self) -> ErrorLaw {
        match self.law {
            Law::Normal => ErrorLaw::Normal,
            Law::Laplace => ErrorLaw::Laplace,
        }
    }
}

#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
enum Scale {
    #[default]
    Linear,
    Log,
    Log10,
}

#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Law {
    #[default]
    Normal,
    Laplace,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum PriorKind {
    Normal,
    Laplace,
    LogNormal,
    LogLaplace,
}

#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
enum PriorOn {
    #[default]
    Value,
    Scale,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct PriorKeys {
    law: PriorKind,
    centre: f64,
    spread: f64,
    #[serde(default)]
    on: PriorOn,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct ParameterKeys {
    bounds: [f64; 2],
    scale: Option<Scale>,
    starts: Option<[f64; 2]>,
    nominal: Option<f64>,
    prior: Option<PriorKeys>,
}

#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct ExperimentKeys {
    pub set: BTreeMap<String, Formula>,
    pub before: Option<BTreeMap<String, Formula>>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct SearchKeys {
    starts: usize,
    steps: u64,
    profiles: bool,
}

impl Default for SearchKeys {
    fn default() -> Self {
        SearchKeys { starts: 20, steps: 300, profiles: false }
    }
}

/// An estimated parameter, as the scene states it.
#[derive(Clone, Debug)]
pub(super) struct ParameterSettings {
    pub name: String,
    pub scale: ParameterScale,
    pub bounds: [f64; 2],
    pub starts: Option<[f64; 2]>,
    pub nominal: Option<f64>,
    pub prior: Option<Prior>,
}

/// Several experiments and one set of parameters, as a file says them.
#[derive(Clone, Debug)]
pub struct JointScene {
    /// `title`: what it is, in a line.
    pub title: String,
    /// `model`: the proof file of the equations, from where the program runs.
    pub model: PathBuf,
    /// `measurements`: the CSV file with what was measured, from where the program runs.
    pub measurements: PathBuf,
    /// `seed`: where random numbers begin; 1 unless given.
    pub seed: u64,
    /// `[search] starts`: how many searches begin; 20 unless given, and with 0 nothing is estimated.
    pub starts: usize,
    /// `[search] steps`: how many steps each has at most; 300 unless given.
    pub steps: u64,
    /// `[search] profiles`: whether profile likelihoods are wanted.
    pub profiles: bool,
    pub(super) initial: BTreeMap<String, Formula>,
    pub(super) errors: BTreeMap<String, ErrorKeys>,
    pub(super) parameters: Vec<ParameterSettings>,
    pub(super) known: BTreeMap<String, f64>,
    pub(super) experiments: Vec<(String, ExperimentKeys)>,
    name: String,
    text: String,
}

impl JointScene {
    /// Reads a scene of several experiments; none where the file is a scene of another kind, or none.
    ///
    /// # Errors
    /// What is wrong with the file, and where.
    pub fn read(path: &Path) -> Option<Result<JointScene, ReadError>> {
        let text = load(path).ok()?;
        let value = toml::from_str::<toml::Table>(&text).ok()?;
        if !(value.contains_key("experiments") || value.contains_key("measurements")) {
            return None;
        }
        Some(JointScene::parse(&name_of(path), &text).and_then(|scene| {
            for (place, file) in [("model", &scene.model), ("measurements", &scene.measurements)] {
                let what = if place == "model" { hints::PROOF_FILE } else { "a table of measurements" };
                if let Some((message, help)) = hints::refused_file(file, what) {
                    return Err(scene.error_at(place, message, help));
                }
            }
            Ok(scene)
        }))
    }

    /// Reads a scene from a text; files are looked for from the folder of `name`.
    ///
    /// # Errors
    /// What is wrong with the text, and where.
    pub fn parse(name: &str, text: &str) -> Result<JointScene, ReadError> {
        let read = || {
            let places = Places::of(text)?;
            let keys: Keys = toml::from_str(text).map_err(|error| places.explain(&error))?;
            checked(keys, &places, name, text)
        };
        read().map_err(|problem: Problem| problem.locate(name, text))
    }

    /// A mistake at a place of the scene, named by its keys.
    pub fn error_at(&self, place: &str, message: impl Into<String>, help: impl Into<String>) -> ReadError {
        let span = Places::of(&self.text).map_or(0..0, |places| places.value(place));
        Problem::new(Code::SceneValue, &span, message, "this").help(help).locate(&self.name, &self.text)
    }

    /// A mistake in a key of the scene, named by the tables in which it stands and itself.
    pub(super) fn error_at_key(
        &self,
        place: &[&str],
        message: impl Into<String>,
        help: impl Into<String>,
    ) -> ReadError {
        let span = Places::of(&self.text).map_or(0..0, |places| places.key_of(place));
        Problem::new(Code::SceneValue, &span, message, "this").help(help).locate(&self.name, &self.text)
    }
}

fn checked(keys: Keys, places: &Places<'_>, name: &str, text: &str) -> Result<JointScene, Problem> {
    let wrong = |place: &str, message: String, help: &str| {
        Err(Problem::new(Code::SceneValue, &places.value(place), message, "this").help(help))
    };
    if keys.title.trim().is_empty() {
        return wrong("title", "the title is empty".to_owned(), "say what the experiments are, in a line");
    }
    if keys.experiments.is_empty() {
        return wrong(
            "experiments",
            "there is no experiment".to_owned(),
            "add [experiments.NAME], with what is set in it",
        );
    }
    if keys.parameters.is_empty() {
        return wrong(
            "parameters",
            "no parameter is estimated".to_owned(),
            "add, for instance: k = { bounds = [1e-5, 1e5] }",
        );
    }
    if keys.experiments.len() > MOST_EXPERIMENTS || keys.parameters.len() > MOST_PARAMETERS {
        let message =
            format!("at most {MOST_EXPERIMENTS} experiments and {MOST_PARAMETERS} parameters are read");
        return wrong("experiments", message, "fit a part of them");
    }
    if keys.search.steps == 0 {
        return wrong(
            "search.steps",
            "a search without steps finds nothing".to_owned(),
            "give one or more; starts = 0 only simulates the nominal values",
        );
    }
    if keys.search.starts > MOST_STARTS || keys.search.steps > MOST_STEPS {
        return wrong(
            "search",
            format!("at most {MOST_STARTS} starts and {MOST_STEPS} steps are made"),
            "ask for fewer",
        );
    }
    for (name, own) in &keys.errors {
        if let Formula::Number(size) = own.size
            && !(size > 0.0 && size.is_finite())
        {
            let message = format!("the size of errors has to be positive, and is {size}");
            return wrong(&format!("errors.{name}.size"), message, "give one standard deviation, above zero");
        }
    }
    let mut parameters = Vec::new();
    for (name, own) in keys.parameters {
        let place = format!("parameters.{name}");
        let [low, high] = own.bounds;
        if !(low.is_finite() && high.is_finite() && low < high) {
            return wrong(
                &format!("{place}.bounds"),
                format!("[{low}, {high}] is no range"),
                "give two finite numbers, the lower first",
            );
        }
        // a parameter that can only be positive is estimated by its logarithm
        let scale = match own.scale {
            Some(Scale::Linear) => ParameterScale::Linear,
            Some(Scale::Log) => ParameterScale::Log,
            Some(Scale::Log10) => ParameterScale::Log10,
            None if low > 0.0 => ParameterScale::Log10,
            None => ParameterScale::Linear,
        };
        if scale != ParameterScale::Linear && low <= 0.0 {
            return wrong(
                &format!("{place}.bounds"),
                format!("{low} has no logarithm, and '{name}' is estimated by it"),
                "give a lower bound above zero, or scale = \"linear\"",
            );
        }
        if let Some([from, to]) = own.starts
            && !(low <= from && from <= to && to <= high)
        {
            return wrong(
                &format!("{place}.starts"),
                format!("[{from}, {to}] is no range within the bounds"),
                "give two numbers between the bounds, the lower first",
            );
        }
        if let Some(nominal) = own.nominal
            && !(nominal.is_finite() && (scale == ParameterScale::Linear || nominal > 0.0))
        {
            return wrong(
                &format!("{place}.nominal"),
                format!("{nominal} is no value on this scale"),
                "give a finite number, above zero where a logarithm is estimated",
            );
        }
        let prior = own.prior.map(|own| Prior {
            law: match own.law {
                PriorKind::Normal => PriorLaw::Normal,
                PriorKind::Laplace => PriorLaw::Laplace,
                PriorKind::LogNormal => PriorLaw::LogNormal,
                PriorKind::LogLaplace => PriorLaw::LogLaplace,
            },
            is_on_scale: own.on == PriorOn::Scale,
            centre: own.centre,
            spread: own.spread,
        });
        if let Some(own) = &prior {
            if !(own.spread > 0.0 && own.spread.is_finite() && own.centre.is_finite()) {
                return wrong(
                    &format!("{place}.prior"),
                    format!("a prior about {} with the spread {} is none", own.centre, own.spread),
                    "give a finite centre and a spread above zero",
                );
            }
            let is_log = matches!(own.law, PriorLaw::LogNormal | PriorLaw::LogLaplace);
            if is_log && (own.is_on_scale || low <= 0.0) {
                return wrong(
                    &format!("{place}.prior"),
                    "the prior is one of a logarithm, and the value may be negative".to_owned(),
                    "give bounds above zero, and leave out on = \"scale\"",
                );
            }
        }
        parameters.push(ParameterSettings {
            name,
            scale,
            bounds: own.bounds,
            starts: own.starts,
            nominal: own.nominal,
            prior,
        });
    }
    if keys.search.starts == 0
        && let Some(own) = parameters.iter().find(|own| own.nominal.is_none())
    {
        let message =
            format!("without starts only nominal values are simulated, and '{}' has none", own.name);
        return wrong("search.starts", message, "ask for starts, or give each parameter a nominal value");
    }
    if let Some((name, value)) = keys.known.iter().find(|(_, value)| !value.is_finite()) {
        return wrong(&format!("known.{name}"), format!("{value} is no finite number"), "give one");
    }
    let folder = Path::new(name).parent().unwrap_or(Path::new(""));
    Ok(JointScene {
        title: keys.title,
        model: folder.join(keys.model),
        measurements: folder.join(keys.measurements),
        seed: keys.seed,
        starts: keys.search.starts,
        steps: keys.search.steps,
        profiles: keys.search.profiles,
        initial: keys.initial,
        errors: keys.errors,
        parameters,
        known: keys.known,
        experiments: keys.experiments.into_iter().collect(),
        name: name.to_owned(),
        text: text.to_owned(),
    })
}
