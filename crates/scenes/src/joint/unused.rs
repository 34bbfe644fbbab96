//! Names of a scene that mean nothing: a parameter, a known value, an error or an experiment of which nothing else speaks is a
//! misspelt one, and would be left out of the answer without a word.

use super::keys::{Formula, JointScene};
use super::rows::MeasuredRows;
use palmistry_io::foreign::shown;
use palmistry_lang::{Kind, ReadError, System, nearest};
use std::collections::BTreeSet;

/// How many names a help lists.
const LISTED: usize = 20;

/// Refuses errors of what is no formula of the model.
///
/// # Errors
/// The first such name, at its place.
pub(super) fn refuse_unknown_errors(
    scene: &JointScene,
    system: &mut System,
    rows: &MeasuredRows,
) -> Result<(), ReadError> {
    let measured: BTreeSet<&str> = rows.rows.iter().map(|row| row.output.as_str()).collect();
    for name in scene.errors.keys() {
        if !measured.contains(name.as_str()) && system.evaluate_text(name).is_err() {
            let outputs = system.outputs.iter().map(|(name, _)| name.as_str());
            let all: BTreeSet<&str> = measured.iter().copied().chain(outputs).collect();
            let all: Vec<&str> = all.into_iter().collect();
            let message = format!("'{}' is no output of the model", shown(name));
            return Err(scene.error_at_key(&["errors", name], message, one_of("there are", name, &all)));
        }
    }
    Ok(())
}

/// Refuses parameters and known values that name nothing of the model and stand in no formula; with `own_rows`, the scene's own
/// measurements, also experiments of which nothing was measured.
///
/// # Errors
/// The first such name, at its place.
pub(super) fn refuse_unused(
    scene: &JointScene,
    system: &System,
    rows: &MeasuredRows,
    own_rows: bool,
) -> Result<(), ReadError> {
    let written = names_in_formulas(scene, rows);
    let moves =
        |symbol| system.fields.iter().any(|field| field.components.iter().any(|(state, _)| *state == symbol));
    let parameters: Vec<&str> = system
        .symbols()
        .filter(|(symbol, info)| info.kind != Kind::Imported && !moves(*symbol))
        .map(|(symbol, _)| system.symbol_name(symbol))
        .collect();
    let estimated = scene.parameters.iter().map(|own| ("parameters", own.name.as_str()));
    for (table, name) in estimated.chain(scene.known.keys().map(|name| ("known", name.as_str()))) {
        let is_of_the_model = system.find_symbol(name).is_some() || system.definitions.contains_key(name);
        // what is no name at all is refused as such
        if is_name(name) && !is_of_the_model && !written.contains(name) {
            let message = format!("'{name}' is no parameter of the model, and stands in no formula");
            let unset = |other: &&str| {
                !scene.known.contains_key(*other) && scene.parameters.iter().all(|own| own.name != **other)
            };
            let is_new = |other: &&str| {
                system.find_symbol(other).is_none() && !system.definitions.contains_key(*other)
            };
            let written = written.iter().map(String::as_str).filter(is_new);
            let mut all: Vec<&str> = parameters.iter().copied().chain(written).collect();
            // one that has no value yet is the likelier one
            if all.iter().any(unset) {
                all.retain(unset);
            }
            let help = one_of("its parameters without a value are", name, &all);
            return Err(scene.error_at_key(&[table, name], message, help));
        }
    }
    let measured: BTreeSet<&str> = rows.rows.iter().map(|row| row.experiment.as_str()).collect();
    let is_measured = |name: &str| !own_rows || measured.contains(name);
    // a row of an experiment that is not there is reported at the row
    let are_known = measured.iter().all(|name| scene.experiments.iter().any(|(own, _)| own == name));
    match scene.experiments.iter().find(|(name, _)| are_known && !is_measured(name)) {
        Some((name, _)) => Err(scene.error_at_key(
            &["experiments", name],
            format!("nothing was measured in the experiment '{}'", shown(name)),
            "leave it out, or add its measurements",
        )),
        None => Ok(()),
    }
}

/// The nearest name, or all of them.
fn one_of(what: &str, name: &str, all: &[&str]) -> String {
    match nearest(name, all.iter().copied()) {
        Some(near) => format!("perhaps you meant '{}'", shown(near)),
        None if all.is_empty() => "leave it out".to_owned(),
        None => {
            let listed: Vec<_> = all.iter().take(LISTED).map(|name| shown(name)).collect();
            format!("{what} {}", listed.join(", "))
        }
    }
}

fn is_name(text: &str) -> bool {
    text.chars().next().is_some_and(char::is_alphabetic) && text.chars().all(is_of_a_name)
}

fn is_of_a_name(sign: char) -> bool {
    sign.is_alphanumeric() || sign == '_'
}

/// Every name in a formula of the scene or of a row.
fn names_in_formulas(scene: &JointScene, rows: &MeasuredRows) -> BTreeSet<String> {
    let sets = scene.experiments.iter().flat_map(|(_, own)| own.before.iter().chain([&own.set]));
    let formulas = sets.flat_map(|set| set.values()).chain(scene.initial.values());
    let texts = formulas.chain(scene.errors.values().map(|error| &error.size)).filter_map(|own| match own {
        Formula::Text(text) => Some(text.as_str()),
        Formula::Number(_) => None,
    });
    // many rows have the same settings
    let of_rows: BTreeSet<&str> =
        rows.rows.iter().flat_map(|row| [row.set.as_str(), row.output.as_str()]).collect();
    let pieces = texts.chain(of_rows).flat_map(|text| text.split(|sign| !is_of_a_name(sign)));
    pieces.filter(|piece| is_name(piece)).map(str::to_owned).collect()
}
