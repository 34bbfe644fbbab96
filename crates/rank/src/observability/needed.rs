//! Which rows of differentials raise the rank at a random point of a locus, and why there may be none.

use super::elimination::independent_rows;
use super::related_rank::related_rank;
use palmistry_lang::{Assignment, System};
use palmistry_math::expression::{NodeId, Program, draw_residues, expand_angles};
use palmistry_math::number::PrimeField;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

const ATTEMPTS: usize = 40;

/// Why there is no codistribution.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CodistributionError {
    /// No field is a drift or an input.
    #[error("{0}")]
    NoMotion(String),
    /// Every state is a pole: a divisor is zero at all of them.
    #[error("undefined at every state there: a division by {divisor} = 0")]
    Pole {
        /// As the file writes it.
        divisor: String,
    },
    /// A symbol that is declared as an angle is met as a number.
    #[error("'{0}' is declared as an angle but stands outside sin, cos and tan")]
    AngleOutside(String),
    /// Outputs are zero, and the conditions do not say so.
    #[error(
        "an output is zero and ties known signals to states: this is not asked of such a system ('rank' and 'prove' are)"
    )]
    NotTied,
    /// Nothing could be evaluated, and why.
    #[error("{0}")]
    NotEvaluated(String),
}

impl From<CodistributionError> for String {
    fn from(error: CodistributionError) -> String {
        error.to_string()
    }
}

/// The rows that raise the rank at a random point of the locus, and whether unknown functions took part.
pub(super) fn needed(
    system: &mut System,
    rows: &[Vec<NodeId>],
    conditions: &Assignment,
) -> Result<(Vec<usize>, bool), CodistributionError> {
    let is_angle = &system.angle_test();
    let as_written: Vec<NodeId> = rows.iter().flatten().copied().collect();
    let as_written_there = system.graph.substitute(&as_written, conditions);
    let entries = as_written_there.clone();
    let entries = expand_angles(&mut system.graph, &entries, is_angle);
    let program = Program::with_unknown_functions(&system.graph, &entries, is_angle);
    if let Some(angle) = program.bare_angle() {
        let name = system.symbol_name(angle);
        return Err(CodistributionError::AngleOutside(name.to_owned()));
    }
    let mut rng = ChaCha8Rng::seed_from_u64(0x0077_6f72_6473); // any fixed seed: the rows do not depend on the user's
    if program.unknown_function(&system.graph).is_some() {
        // what functions satisfy may make a row zero, or a multiple of others
        let guards = system.smooth_guards(&system.moving_fields());
        let guards = system.substitute_guards(&guards, conditions);
        // rows may have more columns than there are unknowns: those of all that moves, or fewer
        let columns = rows.first().map_or(1, Vec::len);
        if let Ok(found) = related_rank(system, &as_written_there, columns, &guards, &mut rng) {
            return Ok((found.needed, !found.exact));
        }
    }
    let (mut registers, mut divisor, mut best) = (Vec::new(), None, None::<Vec<usize>>);
    let mut successes = 0;
    for _ in 0..ATTEMPTS {
        let field = PrimeField::random(&mut rng);
        let Ok(loaded) = program.load(field) else { continue };
        let inputs = draw_residues(&program, &field, &mut rng);
        match loaded.run(&inputs, &mut registers) {
            Ok(values) => {
                let columns = rows.first().map_or(1, Vec::len);
                let matrix: Vec<Vec<u64>> = values.chunks(columns.max(1)).map(<[u64]>::to_vec).collect();
                let kept = independent_rows(&field, &matrix)
                    .map_err(|refusal| CodistributionError::NotEvaluated(refusal.to_string()))?;
                if best.as_ref().is_none_or(|b| kept.len() > b.len()) {
                    best = Some(kept);
                }
                successes += 1;
                if successes == 3 {
                    break;
                }
            }
            Err(failure) => divisor = failure.divisor,
        }
    }
    let guessed = program.unknown_function(&system.graph).is_some();
    best.map(|kept| (kept, guessed)).ok_or_else(|| match divisor {
        Some(divisor) => {
            // what has become the constant zero is named as it was written
            let named = system.graph.vanishing_divisor(&as_written, conditions).unwrap_or(divisor);
            CodistributionError::Pole { divisor: system.graph.text(named) }
        }
        None => CodistributionError::NotEvaluated("no random point could be evaluated".to_owned()),
    })
}
