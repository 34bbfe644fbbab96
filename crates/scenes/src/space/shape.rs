//! A body's shape as a scene in space writes it.

use super::super::scene::place::Places;
use palmistry_bodies::mechanics::spatial::{Harmonic, SolidForm};
use palmistry_lang::{Code, Problem, nearest};
use serde::Deserialize;

/// The kinds, each with its keys.
const KINDS: [(&str, &[&str]); 4] = [
    ("ellipsoid", &["semi_axes"]),
    ("superellipsoid", &["semi_axes", "exponent", "rounding"]),
    ("harmonics", &["mean", "terms"]),
    ("blend", &["parts"]),
];

/// Bodies are blended no deeper than this.
const DEEPEST: usize = 8;

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ShapeKeys {
    kind: String,
    semi_axes: Option<[f64; 3]>,
    exponent: Option<u32>,
    rounding: Option<f64>,
    mean: Option<f64>,
    terms: Option<Vec<TermKeys>>,
    parts: Option<Vec<PartKeys>>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct TermKeys {
    powers: [u32; 3],
    coefficient: f64,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct PartKeys {
    times: f64,
    shape: ShapeKeys,
}

impl ShapeKeys {
    /// The form at a place of a scene.
    pub fn form(self, places: &Places<'_>, at: &str, depth: usize) -> Result<SolidForm, Problem> {
        let wrong = |key: &str, message: String, help: String| {
            let place = if key.is_empty() { at.to_owned() } else { format!("{at}.{key}") };
            Problem::new(Code::SceneValue, &places.value(&place), message, "this shape").help(help)
        };
        let names = KINDS.map(|(name, _)| name);
        let Some((_, own)) = KINDS.iter().find(|(name, _)| *name == self.kind) else {
            let help = nearest(&self.kind, names)
                .map_or(format!("known here: {}", names.join(", ")), |name| {
                    format!("perhaps you meant '{name}'")
                });
            return Err(wrong("kind", format!("the kind '{}' is not known", self.kind), help));
        };
        let given = [
            ("semi_axes", self.semi_axes.is_some()),
            ("exponent", self.exponent.is_some()),
            ("rounding", self.rounding.is_some()),
            ("mean", self.mean.is_some()),
            ("terms", self.terms.is_some()),
            ("parts", self.parts.is_some()),
        ];
        if let Some((key, _)) = given.iter().find(|(key, is)| *is && !own.contains(key)) {
            let message = format!("'{key}' is no key of a shape of the kind '{}'", self.kind);
            return Err(wrong(key, message, format!("its keys are {}", own.join(", "))));
        }
        let missing = |key: &str, example: &str| {
            let message = format!("a shape of the kind '{}' has to have '{key}'", self.kind);
            wrong("", message, format!("add, for instance: {example}"))
        };
        let axes = || self.semi_axes.ok_or_else(|| missing("semi_axes", "semi_axes = [2.5, 2, 1]"));
        Ok(match self.kind.as_str() {
            "ellipsoid" => SolidForm::Ellipsoid { semi_axes: axes()? },
            "superellipsoid" => SolidForm::Superellipsoid {
                semi_axes: axes()?,
                exponent: self.exponent.ok_or_else(|| missing("exponent", "exponent = 4"))?,
                rounding: self.rounding.unwrap_or(0.0),
            },
            "harmonics" => {
                let mean = self.mean.ok_or_else(|| missing("mean", "mean = 1.5"))?;
                let term = |term: TermKeys| Harmonic { powers: term.powers, coefficient: term.coefficient };
                SolidForm::Harmonics {
                    mean,
                    terms: self.terms.unwrap_or_default().into_iter().map(term).collect(),
                }
            }
            _ => {
                let example =
                    "parts = [{ times = 0.5, shape = { kind = \"ellipsoid\", semi_axes = [2, 1, 1] } }]";
                let parts = self.parts.clone().ok_or_else(|| missing("parts", example))?;
                if depth >= DEEPEST {
                    let message = format!("blends lie within each other more than {DEEPEST} deep");
                    return Err(wrong("parts", message, "name the parts of the inner ones here".to_owned()));
                }
                let part = |(i, part): (usize, PartKeys)| {
                    let form = part.shape.form(places, &format!("{at}.parts[{i}].shape"), depth + 1)?;
                    Ok((part.times, form))
                };
                SolidForm::Blend(parts.into_iter().enumerate().map(part).collect::<Result<_, Problem>>()?)
            }
        })
    }
}
