//! Mirror images: other states and constants of the same outputs, for all times and all inputs, that are found by turning signs and angles.
//!
//! The class that is looked for: each unknown keeps its value or has its sign turned, each angle `a` becomes `a`, `a + pi`, `-a` or `pi - a`. Such a map has to take
//! solutions to solutions and leave the outputs as they are; both are compared term by term in exact arithmetic, and there is no error. Of systems
//! whose equations are not rational in their states and in the sines and cosines of their angles none is found. What exchanges unknowns, or maps them otherwise, is not looked for here.

use super::discrete::{Exchange, changes_of_sign};
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
    let fixed = model.variables.iter().map(|variable| is_fixed(&variable.input)).collect();
    let mut all: Vec<Mirror> =
        changes_of_sign(&model, fixed).iter().map(|change| in_symbols(&model, change)).collect();
    all.sort_by_key(|mirror| mirror.of.len());
    Ok(all)
}

fn in_symbols(model: &Model, change: &Exchange) -> Mirror {
    let turned = |place: &usize| change.of[*place].1;
    let image = |(symbol, places): &(Symbol, Vec<usize>)| {
        let image = match places.as_slice() {
            [place] => turned(place).then_some(Image::Negative),
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
