//! What is known for certain of a state: by exact arithmetic, or by enclosures that are narrower than any way here can
//! distinguish.

use super::block::Block;
use dashu::rational::RBig;
use palmistry_math::expression::{Program, Symbol};
use palmistry_math::number::{Arithmetic, Enclosure, Enclosures, Function, Rationals, rational_to_f64};
use palmistry_rank::observability::{Coordinate, MissingInput, State, certain_rank, rank};

/// A number that is known for certain.
#[derive(Clone, Debug)]
pub(super) struct Exact {
    /// The value, or the middle of a narrow enclosure.
    pub value: RBig,
    /// Its leading 159 bits as a sum of doubles.
    pub parts: [f64; 3],
    /// What an error is measured against: the magnitude of the value, or where it is zero of the largest in its row.
    pub scale: f64,
}

/// What is known for certain of one state.
#[derive(Clone, Debug)]
pub(super) struct Truth {
    /// The entries that are no constants.
    pub values: Vec<Exact>,
    pub rank: usize,
}

/// The bits of enclosures where there is no exact arithmetic.
const BITS: usize = 320;
/// The bits of an angle in radians: more than any kind of number here rounds it to.
const ANGLE_BITS: usize = 144;

impl Truth {
    /// Of the entries that a program computes and the rank of a block of them; `rows` are the rows of the entries. `None`
    /// at a pole, or where enclosures are too wide or show no full rank.
    pub fn at(state: &State, program: &Program, block: &Block, rows: &[usize]) -> Option<Truth> {
        let exact = Rationals::default();
        if let Ok(values) = run(program, state, exact) {
            let rank = block.eliminated + rank(&exact, block.rows_of(&exact, &values)?).ok()?;
            return Some(Truth { values: measured(values, rows), rank });
        }
        let fine = Enclosures::new(BITS);
        let values = run(program, state, fine).ok()?;
        let certain = certain_rank(&fine, block.rows_of(&fine, &values)?, Enclosure::significance).ok()?;
        let narrow = |v: &Enclosure| {
            let size = rational_to_f64(&middle(v)).abs();
            rational_to_f64(&(v.high() - v.low())) <= size * f64::EPSILON.powi(4)
        };
        if certain < block.rows.min(block.columns) || !values.iter().all(narrow) {
            return None;
        }
        let values = measured(values.iter().map(middle).collect(), rows);
        Some(Truth { values, rank: block.eliminated + certain })
    }
}

fn middle(v: &Enclosure) -> RBig {
    (v.low() + v.high()) / RBig::from(2)
}

fn run<A: Arithmetic>(
    program: &Program,
    state: &State,
    arithmetic: A,
) -> Result<Vec<A::Number>, MissingInput> {
    let inputs = state.inputs(program, &arithmetic)?;
    let loaded = program.load(arithmetic)?;
    Ok(loaded.run(&inputs, &mut Vec::new()).map_err(|failure| failure.refusal)?)
}

fn measured(values: Vec<RBig>, rows: &[usize]) -> Vec<Exact> {
    let magnitudes: Vec<f64> = values.iter().map(|value| rational_to_f64(value).abs()).collect();
    let largest = |index: usize| {
        let same = (0..magnitudes.len()).filter(|other| rows[*other] == rows[index]);
        same.map(|other| magnitudes[other]).fold(0.0, f64::max)
    };
    let exact = |(index, value): (usize, RBig)| {
        let mut parts = [0.0; 3];
        let mut rest = value.clone();
        for part in &mut parts {
            *part = rational_to_f64(&rest);
            rest -= RBig::try_from(*part).unwrap_or(RBig::ZERO);
        }
        let scale = if magnitudes[index] > 0.0 { magnitudes[index] } else { largest(index) };
        Exact { value, parts, scale }
    };
    values.into_iter().enumerate().map(exact).collect()
}

/// The value of a symbol as an enclosure, angles in radians; `None` where the state gives none.
pub(super) fn radians(state: &State, symbol: Symbol) -> Option<(RBig, RBig)> {
    let (sine, cosine) = match state.values.get(&symbol)? {
        Coordinate::Number(value) => return Some((value.clone(), value.clone())),
        Coordinate::Angle { sine, cosine } => (sine, cosine),
    };
    let fine = Enclosures::new(ANGLE_BITS);
    // twice the angle whose tangent is sin/(1 + cos); a half turn has none
    let bottom = cosine + RBig::ONE;
    let angle = if bottom.is_zero() {
        fine.pi().ok()?
    } else {
        let half = fine.apply(Function::Atan, &fine.rational(&(sine / bottom)).ok()?).ok()?;
        fine.add(&half, &half).ok()?
    };
    Some((angle.low(), angle.high()))
}
