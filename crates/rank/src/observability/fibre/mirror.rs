//! Mirror images: other states and constants of the same outputs, for all times and all inputs, that are found by exchanging unknowns and by turning signs and angles.
//!
//! The class that is looked for: each unknown keeps its value or has its sign turned, each angle `a` becomes `a`, `a + pi`, `-a` or `pi - a`; and where there are no angles, unknowns
//! exchange their values, with turned signs or without. Such a map has to take
//! solutions to solutions and leave the outputs as they are; both are compared term by term in exact arithmetic, and there is no error. Of systems
//! whose equations are not rational in their states and in the sines and cosines of their angles none is found. What maps unknowns otherwise is not looked for here.

use super::discrete::{Exchange, changes_of_sign, exchanges_beside};
use super::model::Model;
use palmistry_lang::{Assignment, System};
use palmistry_math::expression::{Input, Symbol};
use std::collections::HashSet;

/// What becomes of an unknown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Image {
    /// `-x`.
    Negative,
    /// `a + pi`, of an angle.
    HalfTurn,
    /// `pi - a`, of an angle.
    Supplement,
    /// The value of another unknown, or its negative.
    Other {
        /// Whose value it is.
        symbol: Symbol,
        /// Whether its sign is turned.
        is_negative: bool,
    },
}

/// A map of the unknowns, by those that it changes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mirror {
    /// In the order of the file.
    pub of: Vec<(Symbol, Image)>,
}

/// The mirror images of a system where only some of its states and unknown constants may differ, the ones that change least first.
///
/// # Errors
/// In words, where the equations cannot be compared.
pub fn mirrors(system: &System, free: &HashSet<Symbol>) -> Result<Vec<Mirror>, String> {
    let model = Model::new(system, &Assignment::default(), &[])?;
    let is_fixed = |input: &Input| input.symbol().is_none_or(|symbol| !free.contains(&symbol));
    let fixed: Vec<bool> = model.variables.iter().map(|variable| is_fixed(&variable.input)).collect();
    // a search among permutations may be cut off before those that change signs alone
    let mut maps = changes_of_sign(&model, fixed.clone());
    let others = exchanges_beside(&model, fixed).into_iter();
    let others: Vec<Exchange> = others.filter(|map| !maps.contains(map)).collect();
    maps.extend(others);
    let mut all: Vec<Mirror> = maps.iter().map(|map| in_symbols(&model, map)).collect();
    all.sort_by_key(|mirror| mirror.of.len());
    Ok(all)
}

fn in_symbols(model: &Model, change: &Exchange) -> Mirror {
    let turned = |place: &usize| change.of[*place].1;
    let of_variable = |place: &usize| {
        let (other, is_negative) = change.of[*place];
        if other == *place {
            return is_negative.then_some(Image::Negative);
        }
        let symbol = model.variables[other].input.symbol()?;
        Some(Image::Other { symbol, is_negative })
    };
    let image = |(symbol, places): &(Symbol, Vec<usize>)| {
        let image = match places.as_slice() {
            [place] => of_variable(place),
            // cosine and sine
            [cosine, sine] => match (turned(cosine), turned(sine)) {
                (true, true) => Some(Image::HalfTurn),
                (false, true) => Some(Image::Negative),
                (true, false) => Some(Image::Supplement),
                (false, false) => None,
            },
            _ => None,
        };
        Some((*symbol, image?))
    };
    Mirror { of: model.unknowns.iter().filter_map(image).collect() }
}
