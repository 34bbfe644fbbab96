//! The rows of each output by itself, to be put together in any choice of outputs.

use super::covectors::integers;
use super::echelon::Echelon;
use super::probe::{ATTEMPTS, Draw, Probe};
use palmistry_math::number::{PrimeField, Refusal};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

/// The differentials of all outputs' derivatives at one random point modulo a random prime.
pub(crate) struct OutputRows {
    pub field: PrimeField,
    /// Of each output, by unknowns, up to the order at which its own rows rest: whatever else is measured, no further one of it adds anything.
    pub rows: Vec<Vec<Vec<u64>>>,
}

/// The span of some rows.
#[derive(Clone)]
pub(crate) struct Rows(Echelon);

impl Rows {
    /// Of rows of so many entries.
    pub fn new(field: PrimeField, columns: usize) -> Rows {
        Rows(Echelon::new(field, columns))
    }

    /// Takes a row into it.
    pub fn add(&mut self, row: Vec<u64>) {
        self.0.insert(row);
    }

    /// Whether the unit rows of these columns lie in it.
    pub fn has(&self, columns: &[usize]) -> bool {
        let seen = self.0.observable();
        columns.iter().all(|column| seen[*column])
    }
}

impl Probe {
    /// The rows of each output.
    ///
    /// # Errors
    /// In words, where the points were poles.
    pub(crate) fn output_rows(&self, rng: &mut ChaCha8Rng) -> Result<OutputRows, String> {
        let mut refused = String::new();
        for _ in 0..ATTEMPTS {
            let field = PrimeField::random(rng);
            match self.output_rows_in(field, rng) {
                Ok(rows) => return Ok(OutputRows { field, rows }),
                Err(refusal) => refused = refusal.to_string(),
            }
        }
        Err(format!("{ATTEMPTS} random points were singularities: {refused}"))
    }

    fn output_rows_in(&self, field: PrimeField, rng: &mut ChaCha8Rng) -> Result<Vec<Vec<Vec<u64>>>, Refusal> {
        let equations = &self.equations;
        let start = equations.draw(field, rng)?;
        let draw = Draw { field, seed: rng.random(), signs: None };
        let most = equations.closed.len() + 1;
        let mut length = most.min(FIRST);
        loop {
            let trajectory = equations.trajectory(field, &start, (draw.seed, draw.signs), length)?;
            let integers = integers(&field, length);
            let mut rests = true;
            let mut rows = Vec::new();
            for mut covector in trajectory.covectors {
                let mut closed = Echelon::new(field, equations.closed.len());
                let mut own = Vec::new();
                for k in 0..length {
                    let value = covector.value();
                    let part = |places: &[usize]| places.iter().map(|place| value[*place]).collect();
                    own.push(part(&equations.columns));
                    let raised = closed.insert(part(&equations.closed));
                    if !raised {
                        break;
                    }
                    rests &= k + 1 < length;
                    if k + 1 < length {
                        covector = covector.next(&field, &trajectory.entries, &integers);
                    }
                }
                rows.push(own);
            }
            if rests || length >= most {
                return Ok(rows);
            }
            length = (2 * length).min(most);
        }
    }
}

/// So many coefficients are tried first.
const FIRST: usize = 8;
