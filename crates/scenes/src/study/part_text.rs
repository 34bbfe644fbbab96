//! A part of a scene's studies as JSON, which is complete or refused.

use super::curvature::WindowBound;
use super::noise::Trial;
use super::part::StudyPart;
use palmistry_io::parts::{Bits, CONTRADICTS, PartError, seal, unseal};
use serde::{Deserialize, Serialize};

/// The first field of a part's text; another number where its fields have another meaning.
const FORMAT: &str = "palmistry observe part 2";

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Written {
    question: Bits,
    measurements: Bits,
    trials: u64,
    first: u64,
    last: u64,
    noise: Vec<Option<WrittenEstimate>>,
    arrives: Vec<bool>,
    /// Bounds in m; infinite where unobservable, none where the body is not held.
    told: Vec<Option<Bits>>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct WrittenEstimate {
    estimate: Vec<Bits>,
    fits: bool,
}

impl StudyPart {
    /// As JSON, with a checksum. It contains no times.
    pub fn text(&self) -> Option<String> {
        let trial = |trial: &Trial| match trial {
            Trial::Failed => None,
            Trial::Converged { estimate, fits } => Some(WrittenEstimate {
                estimate: estimate.iter().map(|value| Bits(value.to_bits())).collect(),
                fits: *fits,
            }),
        };
        let written = Written {
            question: Bits(self.asked),
            measurements: Bits(self.measurements),
            trials: self.trials,
            first: self.first,
            last: self.last,
            noise: self.noise.iter().map(trial).collect(),
            arrives: self.arrives.clone(),
            told: self.bounds.iter().map(|one| one.bound().map(|bound| Bits(bound.to_bits()))).collect(),
        };
        seal(FORMAT, written)
    }

    /// Reads a part.
    ///
    /// # Errors
    /// The text is something else, or was cut or changed.
    pub fn read(text: &str) -> Result<StudyPart, PartError> {
        let written: Written = unseal(FORMAT, text)?;
        let trial = |written: Option<WrittenEstimate>| match written {
            None => Trial::Failed,
            Some(WrittenEstimate { estimate, fits }) => Trial::Converged {
                estimate: estimate.into_iter().map(|Bits(bits)| f64::from_bits(bits)).collect(),
                fits,
            },
        };
        let Written { question, measurements, trials, first, last, noise, arrives, told } = written;
        let made = (noise.len() + arrives.len() + told.len()) as u64;
        if last.checked_sub(first) != Some(made) || last > trials {
            return Err(CONTRADICTS);
        }
        let noise = noise.into_iter().map(trial).collect();
        let bound = |bits: Option<Bits>| match bits.map(|Bits(bits)| f64::from_bits(bits)) {
            None => Ok(WindowBound::NotHeld),
            Some(f64::INFINITY) => Ok(WindowBound::Unobservable),
            Some(bound) if bound >= 0.0 => Ok(WindowBound::Bound(bound)),
            Some(_) => Err(CONTRADICTS),
        };
        let bounds = told.into_iter().map(bound).collect::<Result<_, _>>()?;
        let (asked, measurements) = (question.0, measurements.0);
        Ok(StudyPart { asked, measurements, trials, first, last, noise, arrives, bounds })
    }
}
