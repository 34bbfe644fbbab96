//! The rank of a matrix of expressions at almost all points.

use crate::observability::elimination::rank;
use palmistry_math::expression::{
    Graph, NodeId, Program, Symbol, draw_residues, expand_angles, failure_bound, sizes,
};
use palmistry_math::number::PrimeField;
use palmistry_math::number::polynomial::Size;
use rand::Rng;

/// The rank of a matrix outside a thin set, and how it is known.
#[derive(Clone, Debug, PartialEq)]
pub enum GenericRank {
    /// The rank: certain as a lower bound, and with an error probability below `2^log2_error` as an upper bound.
    Rank {
        /// The rank.
        rank: usize,
        /// Minus infinity where the rank is full and therefore certain.
        log2_error: f64,
        /// At how many points it was tried.
        points: usize,
    },
    /// Every point was a pole; this divisor was zero.
    Pole(NodeId),
    /// Functions other than sines and cosines of angles are met, and nothing was found out.
    Functions,
    /// Nothing was found out.
    Unknown(String),
}

const ATTEMPTS: usize = 40;

/// The rank of the matrix of `columns` columns with these entries, by rows, as a matrix over the rational functions.
///
/// A nonzero minor modulo one prime is a nonzero minor: the rank found is a lower bound for certain. That no greater
/// minor was missed is as certain as for [`identically_zero`](palmistry_math::expression::identically_zero), with the degree
/// that a minor can have.
pub fn generic_rank(
    graph: &mut Graph,
    entries: &[NodeId],
    columns: usize,
    is_angle: impl Fn(Symbol) -> bool,
    rng: &mut impl Rng,
) -> GenericRank {
    let expanded = expand_angles(graph, entries, &is_angle);
    let program = Program::with_unknown_functions(graph, &expanded, &is_angle);
    if let Some(angle) = program.bare_angle() {
        let name = graph.symbol_name(angle);
        return GenericRank::Unknown(format!(
            "'{name}' is declared as an angle but stands outside sin, cos and tan"
        ));
    }
    if program.unknown_function(graph).is_some() {
        return GenericRank::Functions;
    }
    rank_of(&program, entries.len(), columns, rng)
}

/// The same with every other function taken for an unknown of its own, and whether there is one: then the rank may be less where
/// the functions are related, and is certainly no more.
pub(crate) fn formal_rank(
    graph: &mut Graph,
    entries: &[NodeId],
    columns: usize,
    is_angle: impl Fn(Symbol) -> bool,
    rng: &mut impl Rng,
) -> (GenericRank, bool) {
    let expanded = expand_angles(graph, entries, &is_angle);
    let program = Program::with_unknown_functions(graph, &expanded, &is_angle);
    if let Some(angle) = program.bare_angle() {
        let name = graph.symbol_name(angle);
        let why = format!("'{name}' is declared as an angle but stands outside sin, cos and tan");
        return (GenericRank::Unknown(why), true);
    }
    let is_formal = program.unknown_function(graph).is_some();
    (rank_of(&program, entries.len(), columns, rng), is_formal)
}

/// The rank of a program's values at random points.
fn rank_of(program: &Program, entries: usize, columns: usize, rng: &mut impl Rng) -> GenericRank {
    let rows = entries / columns.max(1);
    let full = rows.min(columns);
    let size = match minor_size(program, columns) {
        Ok(size) => size,
        Err(why) => return GenericRank::Unknown(why),
    };
    let Some((rounds, log2_error)) = failure_bound(size) else {
        return GenericRank::Unknown(format!("the degree of a minor may be {:.1e}", size.degree));
    };
    let (mut best, mut divisor, mut points, mut registers) = (0, None, 0, Vec::new());
    for _ in 0..rounds + ATTEMPTS {
        let field = PrimeField::random(rng);
        let Ok(loaded) = program.load(field) else { continue };
        let inputs = draw_residues(program, &field, rng);
        match loaded.run(&inputs, &mut registers) {
            Ok(values) => {
                let matrix = values.chunks(columns.max(1)).map(<[u64]>::to_vec).collect();
                best = best.max(rank(&field, matrix).unwrap_or(0));
                points += 1;
            }
            Err(failure) => divisor = failure.divisor,
        }
        if best == full {
            return GenericRank::Rank { rank: best, log2_error: f64::NEG_INFINITY, points };
        }
        if points == rounds {
            return GenericRank::Rank { rank: best, log2_error, points };
        }
    }
    match divisor {
        Some(divisor) if points == 0 => GenericRank::Pole(divisor),
        _ => GenericRank::Unknown("too many of the random points were singularities".to_owned()),
    }
}

/// A bound on the numerator of any minor: each row over its own denominator, each minor at most as long as all rows.
fn minor_size(program: &Program, columns: usize) -> Result<Size, String> {
    let entries = sizes(program).map_err(|refusal| refusal.to_string())?;
    let mut rows: Vec<Size> = entries
        .chunks(columns.max(1))
        .map(|row| {
            // over the product of all denominators an entry's numerator has the other denominators as factors
            row.iter().fold(Size::default(), |sum, (top, bottom)| Size {
                degree: sum.degree + top.degree.max(bottom.degree),
                bits: sum.bits + top.bits.max(bottom.bits),
            })
        })
        .collect();
    rows.sort_by(|a, b| b.degree.total_cmp(&a.degree));
    let kept = rows.len().min(columns);
    let factorial: f64 = (1..=kept).map(|k| (k as f64).log2()).sum();
    let degree = rows.iter().take(kept).map(|row| row.degree).sum();
    rows.sort_by(|a, b| b.bits.total_cmp(&a.bits));
    let bits = rows.iter().take(kept).map(|row| row.bits).sum::<f64>() + factorial;
    Ok(Size { degree, bits })
}
