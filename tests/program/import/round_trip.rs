//! The system of an imported file beside the foreign syntax tree, at random states.

use super::Draws;
use dashu::rational::RBig;
use palmistry::System;
use palmistry::certified_value;
use palmistry::expression::Symbol;
use palmistry::import::{ForeignExpr, ImportedModel};
use palmistry::system::Value;
use std::collections::{BTreeMap, HashMap};
use std::path::Path;

/// An imported file as a system, with what its names are called in the foreign file.
pub struct Both<'a> {
    pub imported: &'a ImportedModel,
    pub system: System,
    drift: String,
    ours: BTreeMap<String, String>,
}

impl<'a> Both<'a> {
    pub fn new(imported: &'a ImportedModel) -> Both<'a> {
        let system = System::parse("imported.proof", &imported.text, Path::new(""))
            .unwrap_or_else(|why| panic!("{:?}\n{}", miette::Report::new(why), imported.text));
        let drift = system.fields[system.drift().expect("a drift")].name.clone();
        Both { imported, system, drift, ours: imported.renamed.iter().cloned().collect() }
    }

    /// What a foreign name is called in the proof file.
    pub fn ours<'b>(&'b self, foreign: &'b str) -> &'b str {
        self.ours.get(foreign).map_or(foreign, String::as_str)
    }

    /// A value for every symbol, between a half and two.
    pub fn state(&self, draws: &mut Draws) -> HashMap<Symbol, RBig> {
        let mut symbols: Vec<Symbol> = self.system.symbols().map(|(symbol, _)| symbol).collect();
        symbols.sort_by_key(|symbol| self.system.symbol_name(*symbol).to_owned());
        let draw = |draws: &mut Draws| RBig::from(512 + draws.below(1536)) / RBig::from(1024);
        symbols.into_iter().map(|symbol| (symbol, draw(draws))).collect()
    }

    /// A symbol's value by its foreign name.
    pub fn given(&self, state: &HashMap<Symbol, RBig>, foreign: &str) -> Option<f64> {
        let symbol = self.system.find_symbol(self.ours(foreign))?;
        Some(state.get(&symbol)?.to_f64().value())
    }

    /// The value of a rate in the system that was read back.
    pub fn rate(&mut self, state: &HashMap<Symbol, RBig>, foreign: &str) -> Option<f64> {
        let text = format!("L({}, {})", self.drift, self.ours(foreign));
        let Value::Scalar(id) = self.system.evaluate_text(&text).expect("a rate") else {
            panic!("{text} is no number")
        };
        certified_value(&self.system.graph, id, state, 14).ok()?.decimal.parse().ok()
    }

    /// The value of an output in the system that was read back.
    pub fn output(&self, state: &HashMap<Symbol, RBig>, at: usize) -> Option<f64> {
        let (_, id) = self.system.outputs[at];
        certified_value(&self.system.graph, id, state, 14).ok()?.decimal.parse().ok()
    }

    /// The value of a foreign expression by its own tree: names are symbols, or definitions of the foreign model.
    pub fn foreign(&self, state: &HashMap<Symbol, RBig>, expression: &ForeignExpr) -> Option<f64> {
        let definitions: BTreeMap<&str, &ForeignExpr> =
            self.imported.model.definitions.iter().map(|(name, value)| (name.as_str(), value)).collect();
        expression.value(&|name| match definitions.get(name) {
            Some(definition) => self.foreign(state, definition),
            None => self.given(state, name),
        })
    }
}

/// Whether two values are one but for rounding.
pub fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-9 * (1.0 + a.abs().max(b.abs()))
}

/// Compares all rates and outputs at some states; how many values were compared.
pub fn compare(imported: &ImportedModel, states: usize) -> usize {
    let mut both = Both::new(imported);
    let mut draws = Draws(7);
    let mut compared = 0;
    let model = &imported.model;
    for _ in 0..states {
        let state = both.state(&mut draws);
        for rate in &model.states {
            let foreign = both.foreign(&state, &rate.rate).expect("every name has a value");
            let ours = both.rate(&state, &rate.name);
            compared += usize::from(same(foreign, ours, &rate.name, &imported.text));
        }
        for (at, output) in model.outputs.iter().enumerate() {
            let foreign = both.foreign(&state, &output.value).expect("every name has a value");
            let ours = both.output(&state, at);
            compared += usize::from(same(foreign, ours, "an output", &imported.text));
        }
    }
    compared
}

/// Where one side has a value, so has the other, and it is the same.
fn same(foreign: f64, ours: Option<f64>, what: &str, text: &str) -> bool {
    match ours {
        Some(ours) => {
            assert!(close(foreign, ours), "{what}: {foreign} there, {ours} here\n{text}");
            true
        }
        None => {
            assert!(!foreign.is_finite(), "{what}: {foreign} there, and nothing here\n{text}");
            false
        }
    }
}
