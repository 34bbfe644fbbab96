//! A part of a scene's studies as JSON that is whole or refused.

use super::curvature::Told;
use super::noise::Trial;
use super::part::StudyPart;
use palmistry_io::parts::{Bits, CONTRADICTS, PartError, seal, unseal};
use serde::{Deserialize, Serialize};

/// What the text of a part begins with; another number where its fields mean something else.
const FORMAT: &str = "palmistry observe part 2";

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Written {
    question: Bits,
    readings: Bits,
    trials: u64,
    first: u64,
    last: u64,
    noise: Vec<Option<WrittenEstimate>>,
    arrives: Vec<bool>,
    /// Bounds in m; infinite where blind, none where the body is not held.
    told: Vec<Option<Bits>>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct WrittenEstimate {
    estimate: Vec<Bits>,
    fits: bool,
}

impl StudyPart {
    /// As JSON, with a checksum. It tells no times.
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
            readings: Bits(self.readings),
            trials: self.trials,
            first: self.first,
            last: self.last,
            noise: self.noise.iter().map(trial).collect(),
            arrives: self.arrives.clone(),
            told: self.told.iter().map(|told| told.bound().map(|bound| Bits(bound.to_bits()))).collect(),
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
        let Written { question, readings, trials, first, last, noise, arrives, told } = written;
        let made = (noise.len() + arrives.len() + told.len()) as u64;
        if last.checked_sub(first) != Some(made) || last > trials {
            return Err(CONTRADICTS);
        }
        let noise = noise.into_iter().map(trial).collect();
        let bound = |bits: Option<Bits>| match bits.map(|Bits(bits)| f64::from_bits(bits)) {
            None => Ok(Told::NotHeld),
            Some(f64::INFINITY) => Ok(Told::Blind),
            Some(bound) if bound >= 0.0 => Ok(Told::Bound(bound)),
            Some(_) => Err(CONTRADICTS),
        };
        let told = told.into_iter().map(bound).collect::<Result<_, _>>()?;
        let (asked, readings) = (question.0, readings.0);
        Ok(StudyPart { asked, readings, trials, first, last, noise, arrives, told })
    }
}
