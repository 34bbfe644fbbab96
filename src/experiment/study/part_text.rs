//! A part of a scene's studies as JSON that is whole or refused.

use super::noise::Trial;
use super::part::StudyPart;
use crate::sweep::{Bits, CONTRADICTS, PartError, seal, unseal};
use serde::{Deserialize, Serialize};

/// What the text of a part begins with; another number where its fields mean something else.
const FORMAT: &str = "palmistry observe part 1";

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
        let Written { question, readings, trials, first, last, noise, arrives } = written;
        let made = (noise.len() + arrives.len()) as u64;
        if last.checked_sub(first) != Some(made) || last > trials {
            return Err(CONTRADICTS);
        }
        let noise = noise.into_iter().map(trial).collect();
        Ok(StudyPart { asked: question.0, readings: readings.0, trials, first, last, noise, arrives })
    }
}
