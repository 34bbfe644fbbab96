//! Which rows: the file's own choice, or what the codistribution needs.

use palmistry_lang::{Assignment, System, Value};
use palmistry_math::expression::NodeId;
use palmistry_rank::observability::{Codistribution, Length, LieDerivative, OWN_ROWS};

pub(super) struct Rows {
    /// All entries by rows, as they are written.
    pub entries: Vec<NodeId>,
    /// The Lie derivatives whose differentials the rows are, or why they are not known.
    pub lie_derivatives: Result<Vec<LieDerivative>, String>,
    /// Where they come from, in words.
    pub origin: String,
}

/// At most this many Lie derivatives are compared with rows, and none of a higher order than the next constant.
const MOST_WORDS: usize = 600;
const LONGEST: usize = 6;
/// Where the rank is short all rows are taken that were looked at, but no more than this for each state.
const ROWS_A_STATE: usize = 4;

impl Rows {
    /// The rows of a system: those that it defines, else those that the codistribution needs; where their rank is below the
    /// number of states, all that were looked at, since a wrong way would take it for higher.
    ///
    /// # Errors
    /// In words, where no row can be evaluated anywhere.
    pub fn of(system: &mut System) -> Result<Rows, String> {
        let columns = system.unknown_count();
        if let Some(Value::Matrix(matrix)) = system.definition(OWN_ROWS)
            && matrix.columns == columns
        {
            let entries = matrix.entries.clone();
            let words = words_of(system, &entries);
            return Ok(Rows {
                entries,
                lie_derivatives: words,
                origin: format!("the file's own '{OWN_ROWS}'"),
            });
        }
        let found = Codistribution::new(system, &Assignment::new(), Length::UntilItStops)?;
        let (kept, origin): (Vec<usize>, _) = if found.generic_rank() < columns {
            let all = found.rows.len().min(ROWS_A_STATE * columns);
            ((0..all).collect(), "the differentials of the codistribution, whose rank is short")
        } else {
            (found.needed.clone(), "the differentials that the codistribution needs")
        };
        Ok(Rows {
            entries: kept.iter().flat_map(|row| found.rows[*row].iter().copied()).collect(),
            lie_derivatives: Ok(kept.iter().map(|row| found.lie_derivatives[*row].clone()).collect()),
            origin: origin.to_owned(),
        })
    }
}

/// The Lie derivatives whose differentials some rows are, if they are.
fn words_of(system: &mut System, entries: &[NodeId]) -> Result<Vec<LieDerivative>, String> {
    let rows: Vec<&[NodeId]> = entries.chunks(system.unknown_count()).collect();
    let mut found: Vec<Option<LieDerivative>> = vec![None; rows.len()];
    let mut words: Vec<(LieDerivative, NodeId)> = (0..system.outputs.len())
        .map(|output| (LieDerivative { fields: Vec::new(), output }, system.outputs[output].1))
        .collect();
    let (mut count, mut longest) = (0, 0);
    loop {
        for (word, value) in &words {
            let differential = system.differential(*value);
            for (row, place) in rows.iter().zip(&mut found) {
                if place.is_none() && *row == differential {
                    *place = Some(word.clone());
                }
            }
        }
        count += words.len();
        if found.iter().all(Option::is_some) {
            return Ok(found.into_iter().flatten().collect());
        }
        let moving = system.moving_fields();
        let more = words.len() * moving.len();
        if more == 0 || longest == LONGEST || count + more > MOST_WORDS {
            break;
        }
        let mut longer = Vec::new();
        for field in moving {
            for (word, value) in &words {
                let derivative = system.lie_derivative(field, *value);
                let fields = [&[field], word.fields.as_slice()].concat();
                longer.push((LieDerivative { fields, output: word.output }, derivative));
            }
        }
        words = longer;
        longest += 1;
    }
    let row = found.iter().position(Option::is_none).unwrap_or(0) + 1;
    Err(format!("row {row} of '{OWN_ROWS}' is no differential of a Lie derivative up to order {longest}"))
}
