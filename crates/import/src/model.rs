//! A model as a foreign file has it, in its own names, whatever format it was written in.

use super::expression::{ForeignExpr, ForeignKind, Span};
use dashu::rational::RBig;
use palmistry_lang::{Code, Problem, nearest};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

/// A state and its rate, or what it is after a step.
#[derive(Clone, Debug)]
#[allow(missing_docs)] // the names say it
pub struct ForeignRate {
    pub name: String,
    pub rate: ForeignExpr,
    /// Where the state is named.
    pub span: Range<usize>,
}

/// A constant.
#[derive(Clone, Debug)]
pub struct ForeignConstant {
    /// Its name in the foreign file.
    pub name: String,
    /// Its value there.
    pub value: Option<RBig>,
    /// Whether it is to be identified.
    pub is_unknown: bool,
    /// Whether it is one of those that "all" means: not the size of a compartment, nor a constant species.
    pub may_be_unknown: bool,
}

/// An output.
#[derive(Clone, Debug)]
pub struct ForeignOutput {
    /// Its name, where it has one.
    pub name: Option<String>,
    /// What is measured.
    pub value: ForeignExpr,
}

/// A model in the names of its own file. Definitions stand below what they use.
#[derive(Clone, Debug, Default)]
#[allow(missing_docs)] // the names say it
pub struct ForeignModel {
    pub title: Option<String>,
    /// Where it comes from, as the file says.
    pub source: Option<String>,
    pub states: Vec<ForeignRate>,
    /// Whether time is discrete: rates are the states after a step.
    pub is_discrete: bool,
    pub definitions: Vec<(String, ForeignExpr)>,
    pub outputs: Vec<ForeignOutput>,
    pub constants: Vec<ForeignConstant>,
    pub known_inputs: Vec<String>,
    pub unknown_inputs: Vec<String>,
    /// States with a known initial value, and the value where the file gives it.
    pub initial_values: Vec<(String, Option<ForeignExpr>)>,
    /// The state that is time, where the equations name it: it is measured whatever else is.
    pub clock: Option<String>,
    /// Constants that have several values, one in each experiment.
    pub varied: BTreeSet<String>,
    /// What a reader of the new file has to know, a sentence each.
    pub remarks: Vec<String>,
}

/// Which parameters are to be identified.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum ForeignUnknowns {
    /// What the file says; where it says nothing, all.
    #[default]
    AsTheFileSays,
    /// All of them.
    All,
    /// None.
    None,
    /// These.
    These(Vec<String>),
}

impl ForeignModel {
    /// Declares every name that nothing declares as a constant that is known or not.
    pub(super) fn declare_others(&mut self, is_unknown: bool) {
        let mut known: BTreeSet<String> = self.states.iter().map(|state| state.name.clone()).collect();
        known.extend(self.definitions.iter().map(|(name, _)| name.clone()));
        known.extend(self.constants.iter().map(|constant| constant.name.clone()));
        known.extend(self.known_inputs.iter().chain(&self.unknown_inputs).cloned());
        let mut found = Vec::new();
        let mut look = |name: &str, _: &Span| {
            if known.insert(name.to_owned()) {
                found.push(name.to_owned());
            }
        };
        self.states.iter().for_each(|state| state.rate.names(&mut look));
        self.definitions.iter().for_each(|(_, value)| value.names(&mut look));
        self.outputs.iter().for_each(|output| output.value.names(&mut look));
        self.constants.extend(found.into_iter().map(|name| ForeignConstant {
            name,
            value: None,
            is_unknown,
            may_be_unknown: true,
        }));
    }

    /// Makes time a state with the rate one that is measured: nobody is without a clock.
    pub(super) fn add_clock(&mut self, name: &str) {
        let span = 0..0;
        self.states.push(ForeignRate {
            name: name.to_owned(),
            rate: ForeignExpr::integer(1, &span),
            span: span.clone(),
        });
        self.clock = Some(name.to_owned());
        self.remarks
            .push(format!("the equations name time: '{name}' is a state with the rate 1, and is measured"));
    }

    /// Leaves out definitions that nothing uses, and puts each below what it uses.
    ///
    /// # Errors
    /// Definitions that go round in a circle.
    pub(super) fn order_definitions(&mut self) -> Result<(), Problem> {
        let by_name: BTreeMap<&str, usize> =
            self.definitions.iter().enumerate().map(|(at, (name, _))| (name.as_str(), at)).collect();
        let used = |value: &ForeignExpr| {
            let mut list: Vec<usize> = Vec::new();
            value.names(&mut |name, _| list.extend(by_name.get(name)));
            list
        };
        let mut wanted: Vec<usize> = self.states.iter().flat_map(|state| used(&state.rate)).collect();
        wanted.extend(self.outputs.iter().flat_map(|output| used(&output.value)));
        wanted.extend(self.initial_values.iter().filter_map(|(_, value)| value.as_ref()).flat_map(used));
        let needs: Vec<Vec<usize>> = self.definitions.iter().map(|(_, value)| used(value)).collect();
        let mut needed = BTreeSet::new();
        while let Some(at) = wanted.pop() {
            if needed.insert(at) {
                wanted.extend(&needs[at]);
            }
        }
        // in the order of the file, as far as that goes: what one uses before it
        let mut placed: BTreeSet<usize> = BTreeSet::new();
        let mut order: Vec<usize> = Vec::new();
        for first in needed {
            let mut open: Vec<(usize, usize)> = vec![(first, 0)];
            let mut on_the_way = BTreeSet::from([first]);
            while let Some((at, next)) = open.pop() {
                if placed.contains(&at) {
                    continue;
                }
                match needs[at].get(next) {
                    Some(other) => {
                        open.push((at, next + 1));
                        if !placed.contains(other) {
                            if !on_the_way.insert(*other) {
                                let (name, value) = &self.definitions[*other];
                                let message = format!("'{name}' is defined by itself");
                                return Err(Problem::new(
                                    Code::Foreign,
                                    &value.span,
                                    message,
                                    "this definition",
                                )
                                .help("an equation that has to be solved is no definition: solve it"));
                            }
                            open.push((*other, 0));
                        }
                    }
                    None => {
                        placed.insert(at);
                        order.push(at);
                    }
                }
            }
        }
        let mut all: Vec<Option<(String, ForeignExpr)>> = self.definitions.drain(..).map(Some).collect();
        self.definitions = order.into_iter().filter_map(|at| all[at].take()).collect();
        Ok(())
    }

    /// Takes other outputs than the file's: names of states, definitions, outputs, inputs or constants.
    ///
    /// # Errors
    /// In words: a name that the model does not have, and the one that may have been meant.
    pub(super) fn choose_outputs(&mut self, names: &[String]) -> Result<(), String> {
        if names.is_empty() {
            return Ok(());
        }
        let own: BTreeMap<String, ForeignOutput> =
            self.outputs.iter().filter_map(|output| Some((output.name.clone()?, output.clone()))).collect();
        let everything = self.all_names();
        let chosen = names.iter().map(|name| match own.get(name) {
            Some(output) => Ok(output.clone()),
            None if everything.contains(name) => {
                Ok(ForeignOutput { name: None, value: ForeignExpr::name(name, &(0..0)) })
            }
            None => Err(unknown_name(name, everything.iter().chain(own.keys()))),
        });
        self.outputs = chosen.collect::<Result<_, _>>()?;
        self.remarks.push(format!("outputs as they were asked for: {}", names.join(", ")));
        Ok(())
    }

    /// Says which constants are to be identified.
    ///
    /// # Errors
    /// In words: a name that is no constant, and the one that may have been meant.
    pub(super) fn choose_unknowns(&mut self, which: &ForeignUnknowns) -> Result<(), String> {
        if let ForeignUnknowns::These(names) = which {
            let is_one = |name: &&String| !self.constants.iter().any(|constant| constant.name == **name);
            if let Some(name) = names.iter().find(is_one) {
                return Err(unknown_name(name, self.constants.iter().map(|constant| &constant.name)));
            }
        }
        for constant in &mut self.constants {
            match which {
                ForeignUnknowns::AsTheFileSays => {}
                ForeignUnknowns::All => constant.is_unknown |= constant.may_be_unknown,
                ForeignUnknowns::None => constant.is_unknown = false,
                ForeignUnknowns::These(names) => constant.is_unknown = names.contains(&constant.name),
            }
        }
        Ok(())
    }

    /// Makes signals of constants, or of signals the other kind.
    ///
    /// # Errors
    /// In words: a name that is neither.
    pub(super) fn choose_inputs(&mut self, known: &[String], unknown: &[String]) -> Result<(), String> {
        for (names, is_known) in [(known, true), (unknown, false)] {
            for name in names {
                let before = self.constants.len() + self.known_inputs.len() + self.unknown_inputs.len();
                let candidates: Vec<String> =
                    self.constants.iter().map(|constant| constant.name.clone()).collect();
                self.constants.retain(|constant| constant.name != *name);
                self.known_inputs.retain(|own| own != name);
                self.unknown_inputs.retain(|own| own != name);
                let after = self.constants.len() + self.known_inputs.len() + self.unknown_inputs.len();
                if before == after {
                    return Err(unknown_name(name, candidates.iter()));
                }
                let list = if is_known { &mut self.known_inputs } else { &mut self.unknown_inputs };
                list.push(name.clone());
            }
        }
        Ok(())
    }

    /// Looks at inputs that only outputs have: one that is an output by itself may be a slip of the pen.
    ///
    /// # Errors
    /// An output that is nothing but a signal without an equation that no rate has.
    pub(super) fn look_at_inputs(&mut self) -> Result<(), Problem> {
        let mut used: BTreeSet<String> = BTreeSet::new();
        let mut look = |value: &ForeignExpr| {
            value.names(&mut |name, _| {
                used.insert(name.to_owned());
            });
        };
        self.states.iter().for_each(|state| look(&state.rate));
        self.definitions.iter().for_each(|(_, value)| look(value));
        let inputs: BTreeSet<&String> = self.known_inputs.iter().chain(&self.unknown_inputs).collect();
        let mut alone = Vec::new();
        for output in &self.outputs {
            if let ForeignKind::Name(name) = &output.value.kind
                && inputs.contains(name)
            {
                if !used.contains(name) {
                    let states = self.states.iter().map(|state| state.name.as_str());
                    let help = match nearest(name, states) {
                        Some(other) => format!("perhaps '{other}' is meant; an output is made of states"),
                        None => "an output is made of states: write its formula".to_owned(),
                    };
                    let message =
                        format!("the output is '{name}', which has no equation and stands in no rate");
                    return Err(
                        Problem::new(Code::Foreign, &output.value.span, message, "this output").help(help)
                    );
                }
                alone.push(name.clone());
            }
        }
        if !alone.is_empty() {
            self.remarks.push(format!("outputs that are inputs, and measure no state: {}", alone.join(", ")));
        }
        Ok(())
    }

    /// All of it but definitions and rates.
    pub(super) fn without_formulas(&self) -> ForeignModel {
        ForeignModel {
            title: self.title.clone(),
            source: self.source.clone(),
            states: Vec::new(),
            is_discrete: self.is_discrete,
            definitions: Vec::new(),
            outputs: self.outputs.clone(),
            constants: self.constants.clone(),
            known_inputs: self.known_inputs.clone(),
            unknown_inputs: self.unknown_inputs.clone(),
            initial_values: self.initial_values.clone(),
            clock: self.clock.clone(),
            varied: self.varied.clone(),
            remarks: self.remarks.clone(),
        }
    }

    /// All names of the model, each once, but those of outputs.
    pub(super) fn all_names(&self) -> Vec<String> {
        let states = self.states.iter().map(|state| state.name.clone());
        let constants = self.constants.iter().map(|constant| constant.name.clone());
        let definitions = self.definitions.iter().map(|(name, _)| name.clone());
        let inputs = self.known_inputs.iter().chain(&self.unknown_inputs).cloned();
        let mut seen = BTreeSet::new();
        states
            .chain(constants)
            .chain(inputs)
            .chain(definitions)
            .filter(|name| seen.insert(name.clone()))
            .collect()
    }
}

fn unknown_name<'a>(name: &str, known: impl Iterator<Item = &'a String> + Clone) -> String {
    match nearest(name, known.clone().map(String::as_str)) {
        Some(other) => format!("the file has no '{name}'; perhaps '{other}' is meant"),
        None => {
            let list: Vec<&str> = known.map(String::as_str).take(40).collect();
            format!("the file has no '{name}'; it has {}", list.join(", "))
        }
    }
}
