//! Ranks that are reached: a state in exact numbers, and rows that are independent there. They are searched for here, modulo a prime, and
//! proved there: Coq calculates the rows and eliminates (`proofs/coq/Rank.v`).

use crate::place::{Compared, DEEPEST, Extent, State, Values, extent, search};
use crate::printer::Reason;
use crate::residue::{inverse, less, of_fraction, times};
use palmistry_lang::System;
use palmistry_math::expression::{NodeId, Symbol};
use std::collections::BTreeSet;

/// So many states are tried with the same rows.
const TRIES: u64 = 8;
/// The rows are written out in Coq, and have no more parts.
const LARGEST: u64 = 2_000_000;
const NOWHERE: &str = "no state in rational numbers was found at which the rank is reached";
/// No more Lie derivatives are looked at.
const MOST_WORDS: usize = 400;

/// A state at which all entries have values, and the places of so many rows of a matrix that are independent there.
pub(crate) fn of_matrix(
    system: &System,
    compared: &Compared,
    rows: &[Vec<NodeId>],
    wanted: usize,
    named: &BTreeSet<Symbol>,
) -> Result<(State, Vec<usize>), Reason> {
    let nodes: Vec<NodeId> = rows.iter().flatten().copied().collect();
    affordable(system, &nodes)?;
    let ask = |values: &mut Values<'_>| {
        let all: Vec<Option<Row>> = rows.iter().map(|row| row_at(values, row)).collect();
        let exists = nodes.iter().all(|node| values.exists(*node));
        exists.then(|| independent(all.into_iter(), wanted)).flatten()
    };
    let found = search(system, compared, named, TRIES, ask);
    found.ok_or_else(|| NOWHERE.to_owned())
}

/// An output, and the fields along which it is differentiated, the last one first.
#[derive(Clone)]
pub(crate) struct Word {
    pub fields: Vec<usize>,
    pub output: usize,
    term: NodeId,
    row: Vec<NodeId>,
}

/// So many Lie derivatives of the outputs whose differentials are independent at a state, the shortest ones first.
pub(crate) fn of_codistribution(
    system: &mut System,
    compared: &Compared,
    wanted: usize,
    named: &BTreeSet<Symbol>,
) -> Result<(State, Vec<Word>), Reason> {
    let fields = system.moving_fields();
    let outputs: Vec<NodeId> = system.outputs.iter().map(|(_, node)| *node).collect();
    let word = |system: &mut System, fields: Vec<usize>, output: usize, term: NodeId| {
        let row = system.differential(term);
        Word { fields, output, term, row }
    };
    let mut words: Vec<Word> =
        outputs.iter().enumerate().map(|(output, term)| word(system, Vec::new(), output, *term)).collect();
    let mut newest = 0;
    for _ in 0..=system.unknown_count() {
        // a rank has stopped growing by as many derivatives as there are unknowns
        let nodes: Vec<NodeId> = words[newest..].iter().flat_map(|word| &word.row).copied().collect();
        affordable(system, &nodes)?;
        let ask = |values: &mut Values<'_>| {
            let rows = words.iter().map(|word| {
                if !values.exists(word.term) {
                    return None;
                }
                row_at(values, &word.row)
            });
            independent(rows.collect::<Vec<_>>().into_iter(), wanted)
        };
        if let Some((state, rows)) = search(system, compared, named, TRIES, ask) {
            let chosen: Vec<Word> = rows.iter().map(|row| words[*row].clone()).collect();
            let nodes: Vec<NodeId> = chosen.iter().flat_map(|word| &word.row).copied().collect();
            affordable(system, &nodes)?;
            return Ok((state, chosen));
        }
        let last = words[newest..].to_vec();
        newest = words.len();
        for before in last {
            for (place, field) in fields.iter().enumerate() {
                let term = system.lie_derivative(*field, before.term);
                if system.graph.constant_value(term).is_none() {
                    let along = std::iter::once(place).chain(before.fields.iter().copied()).collect();
                    words.push(word(system, along, before.output, term));
                }
            }
        }
        if words.len() == newest {
            break;
        }
        if words.len() > MOST_WORDS {
            return Err(format!("it rests on more than {MOST_WORDS} Lie derivatives"));
        }
    }
    Err(NOWHERE.to_owned())
}

fn affordable(system: &System, nodes: &[NodeId]) -> Result<(), Reason> {
    let Extent { parts, depth } = extent(&system.graph, nodes);
    match parts > LARGEST || depth > DEEPEST {
        true => Err("its rows are too large for the library".to_owned()),
        false => Ok(()),
    }
}

type Row = Vec<u64>;

/// A row at a state; nothing where an entry has no value.
fn row_at(values: &mut Values<'_>, row: &[NodeId]) -> Option<Row> {
    row.iter().map(|entry| of_fraction(&values.of(*entry)?)).collect()
}

/// The places of so many rows that are independent, the first ones that are; rows without a value count for nothing.
fn independent(rows: impl Iterator<Item = Option<Row>>, wanted: usize) -> Option<Vec<usize>> {
    // rows with their pivots, which are one
    let mut basis: Vec<(usize, Row)> = Vec::new();
    let mut chosen = Vec::new();
    for (place, row) in rows.enumerate() {
        if chosen.len() == wanted {
            break;
        }
        let Some(mut row) = row else { continue };
        for (pivot, of) in &basis {
            let factor = row[*pivot];
            if factor != 0 {
                row.iter_mut().zip(of).for_each(|(entry, by)| *entry = less(*entry, times(factor, *by)));
            }
        }
        let Some(pivot) = row.iter().position(|entry| *entry != 0) else { continue };
        let one_over = inverse(row[pivot]);
        row.iter_mut().for_each(|entry| *entry = times(*entry, one_over));
        basis.push((pivot, row));
        chosen.push(place);
    }
    (chosen.len() == wanted).then_some(chosen)
}
