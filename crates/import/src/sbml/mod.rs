//! SBML, levels 2 and 3: species that react in compartments, and rules.
//!
//! A species means its concentration in formulas, or its amount where the file says so (`hasOnlySubstanceUnits`). Reactions change
//! amounts: a concentration changes by the rate divided by the size of its compartment, and by the change of that size.

mod kinetics;
mod mathml;
mod refused;
mod xml;

use super::expression::{ForeignExpr, Span};
use super::model::{ForeignConstant, ForeignModel, ForeignOutput, ForeignRate};
use dashu::rational::RBig;
use kinetics::{Reaction, Species, Taken};
use mathml::{Formulas, text_of};
use palmistry_io::foreign::Budget;
use palmistry_lang::{Code, Problem};
use palmistry_math::number::parse_decimal;
use refused::{refuse, refuse_packages};
use roxmltree::Node;
use std::collections::{BTreeMap, BTreeSet};
use xml::{child, document, elements, is, listed, place, required};

/// A model with the values of its states at the start.
pub(super) struct Started {
    pub model: ForeignModel,
    /// By state, where the file says so: a formula of constants, definitions and the initial values of other states. That of time is zero.
    pub starts: Vec<(String, ForeignExpr)>,
    /// Species whose initial value needs the size of their compartment: the species, the compartment, and the value by its name.
    pub by_size: Vec<(String, String, ForeignExpr)>,
    /// Constants that are definitions because an initial assignment says what they are.
    pub assigned: BTreeSet<String>,
    /// Constants without a value, which an initial assignment gives one by the states at the start.
    pub by_states: Vec<(String, ForeignExpr)>,
}

/// Reads a model.
pub(super) fn read(text: &str, budget: &Budget) -> Result<ForeignModel, Problem> {
    let started = read_started(text, budget)?;
    let moved: BTreeSet<&str> = started.model.states.iter().map(|state| state.name.as_str()).collect();
    let Some((id, value)) = started.by_states.first() else { return Ok(started.model) };
    // the last one is marked, as it is read from left to right
    let mut bad = (String::new(), value.span.clone());
    value.names(&mut |name, span| {
        if moved.contains(name) || bad.0.is_empty() {
            bad = (name.to_owned(), span.clone());
        }
    });
    let message = format!("'{id}' begins by the value of '{}', which moves", bad.0);
    Err(Problem::new(Code::Foreign, &bad.1, message, "this")
        .help(format!("give '{id}' a value of its own, or make it unknown by taking the assignment out")))
}

/// Reads a model with its initial values.
pub(super) fn read_started(text: &str, budget: &Budget) -> Result<Started, Problem> {
    let document = document(text, budget)?;
    let root = document.root_element();
    if !is(root, "sbml") {
        return Err(Problem::new(Code::Foreign, &place(root), "this is no SBML", "the first element")
            .help("an SBML file begins with <sbml level=\"...\">"));
    }
    let level = root.attribute("level").unwrap_or_default().trim();
    if !matches!(level, "2" | "3") {
        return Err(Problem::new(
            Code::Foreign,
            &place(root),
            format!("SBML of level '{level}' is not read"),
            "this",
        )
        .help("convert it to level 2 or 3, by libSBML for instance"));
    }
    refuse_packages(root)?;
    let model = child(root, "model").ok_or_else(|| {
        Problem::new(Code::Foreign, &place(root), "the file has no model", "this")
            .help("an SBML file has <model> in it")
    })?;
    refuse(model)?;
    let reading = Reading::of(model, level == "3", budget)?;
    let given = reading.starts();
    let by_size = reading.by_size();
    let assigned = reading.initial_values.iter().map(|(id, _)| id.clone()).collect();
    let (model, by_states) = reading.model(model)?;
    let start = |name: &String| Some((name.clone(), given.get(name)?.clone()));
    let mut starts: Vec<(String, ForeignExpr)> =
        model.states.iter().filter_map(|state| start(&state.name)).collect();
    starts.extend(model.clock.iter().map(|clock| (clock.clone(), ForeignExpr::integer(0, &(0..0)))));
    Ok(Started { model, starts, by_size, assigned, by_states })
}

/// What a rule says of a variable.
struct Rule {
    is_rate: bool,
    value: ForeignExpr,
    span: Span,
}

struct Compartment {
    id: String,
    size: Option<RBig>,
    /// Points have no size, and species there no concentration.
    is_point: bool,
}

struct Reading<'b> {
    formulas: Formulas<'b>,
    compartments: Vec<Compartment>,
    species: Vec<Species>,
    parameters: Vec<(String, Option<RBig>)>,
    /// In the order of the file.
    rules: Vec<(String, Rule)>,
    initial_values: Vec<(String, ForeignExpr)>,
    reactions: Vec<Reaction>,
    index: Index,
}

/// Where things stand in the lists of a model, by their ids; the first one of each id.
#[derive(Default)]
struct Index {
    compartments: BTreeMap<String, usize>,
    species: BTreeMap<String, usize>,
    parameters: BTreeSet<String>,
    rules: BTreeMap<String, usize>,
    /// What has an initial assignment.
    begun: BTreeSet<String>,
}

/// The first place of each id.
fn places<'i>(ids: impl Iterator<Item = &'i String>) -> BTreeMap<String, usize> {
    let mut found = BTreeMap::new();
    for (at, id) in ids.enumerate() {
        found.entry(id.clone()).or_insert(at);
    }
    found
}

/// A number in an attribute.
fn value_of(node: Node<'_, '_>, name: &str) -> Result<Option<RBig>, Problem> {
    let Some(text) = node.attribute(name).map(str::trim) else { return Ok(None) };
    if matches!(text, "NaN" | "INF" | "-INF") {
        return Ok(None);
    }
    match (!text.contains('/')).then(|| parse_decimal(text)).flatten() {
        Some(value) => Ok(Some(value)),
        None => {
            Err(Problem::new(Code::Foreign, &place(node), format!("{name}=\"{text}\" is no number"), "this")
                .help("write a decimal"))
        }
    }
}

/// Whether a compartment is a point without a size. In level 3 it may have one all the same, and a concentration there is an
/// amount by that size.
fn is_point(node: Node<'_, '_>, is_level_3: bool) -> Result<bool, Problem> {
    let has_no_dimension = match node.attribute("spatialDimensions").map(str::trim) {
        None => false,
        Some(text) => parse_decimal(text).is_some_and(|dimensions| dimensions == RBig::ZERO),
    };
    Ok(has_no_dimension && !(is_level_3 && value_of(node, "size")?.is_some()))
}

impl<'b> Reading<'b> {
    fn of(model: Node<'_, '_>, is_level_3: bool, budget: &'b Budget) -> Result<Reading<'b>, Problem> {
        let ids: BTreeSet<&str> = model.descendants().filter_map(|node| node.attribute("id")).collect();
        let time = ["time", "t", "clock"]
            .into_iter()
            .find(|name| !ids.contains(name))
            .unwrap_or("time_of_the_model");
        let mut formulas = Formulas { functions: BTreeMap::new(), time: time.to_owned(), budget };
        for function in in_order(listed(model, "listOfFunctionDefinitions")) {
            let (name, definition) = function_definition(function, &formulas)?;
            formulas.functions.insert(name, definition);
        }
        let compartments = listed(model, "listOfCompartments")
            .into_iter()
            .map(|node| {
                Ok(Compartment {
                    id: required(node, "id")?.to_owned(),
                    size: value_of(node, "size")?,
                    is_point: is_point(node, is_level_3)?,
                })
            })
            .collect::<Result<Vec<_>, Problem>>()?;
        let factor = model.attribute("conversionFactor");
        let species = listed(model, "listOfSpecies")
            .into_iter()
            .map(|node| Species::read(node, factor))
            .collect::<Result<Vec<_>, _>>()?;
        let parameters = listed(model, "listOfParameters")
            .into_iter()
            .map(|node| Ok((required(node, "id")?.to_owned(), value_of(node, "value")?)))
            .collect::<Result<Vec<_>, Problem>>()?;
        let index = Index {
            compartments: places(compartments.iter().map(|one| &one.id)),
            species: places(species.iter().map(|one| &one.id)),
            parameters: parameters.iter().map(|(id, _)| id.clone()).collect(),
            rules: BTreeMap::new(),
            begun: BTreeSet::new(),
        };
        let mut reading = Reading {
            index,
            formulas,
            compartments,
            species,
            parameters,
            rules: Vec::new(),
            initial_values: Vec::new(),
            reactions: Vec::new(),
        };
        reading.read_rules(model)?;
        reading.read_beginnings(model)?;
        if is_level_3 {
            // a size may come from a rule as well
            let begun: BTreeSet<&str> = reading.initial_values.iter().map(|(id, _)| id.as_str()).collect();
            for one in &mut reading.compartments {
                let has_size = reading.index.rules.contains_key(&one.id) || begun.contains(one.id.as_str());
                one.is_point &= !has_size;
            }
        }
        let names = ids.into_iter().map(str::to_owned).collect();
        let mut taken = Taken { names, ..Taken::default() };
        let shared = kinetics::shared_local_names(model);
        for node in listed(model, "listOfReactions") {
            let reaction = Reaction::read(node, &reading.formulas, is_level_3, &shared, &mut taken)?;
            reading.reactions.push(reaction);
        }
        Ok(reading)
    }

    /// What species, sizes and parameters are at the start: by an assignment, else by a number.
    fn starts(&self) -> BTreeMap<String, ForeignExpr> {
        let number = |value: RBig| ForeignExpr::new(super::expression::ForeignKind::Number(value), &(0..0));
        let mut starts = BTreeMap::new();
        for one in &self.species {
            let value = self.beginning(one, |size| self.size_at_start(size));
            starts.extend(value.map(|value| (one.id.clone(), value)));
        }
        let sizes = self.compartments.iter().map(|one| (&one.id, &one.size));
        let parameters = self.parameters.iter().map(|(id, value)| (id, value));
        for (id, value) in sizes.chain(parameters) {
            starts.extend(value.clone().map(|value| (id.clone(), number(value))));
        }
        starts.extend(self.initial_values.iter().cloned());
        starts
    }

    /// The species whose initial value is an amount by the size of its compartment, or the other way about.
    fn by_size(&self) -> Vec<(String, String, ForeignExpr)> {
        let of = |one: &Species| {
            let value = self.beginning(one, |size| Some(ForeignExpr::name(size, &(0..0))))?;
            let needs_size = value.as_number().is_none() && !self.index.begun.contains(&one.id);
            needs_size.then(|| (one.id.clone(), one.compartment.clone(), value))
        };
        self.species.iter().filter_map(of).collect()
    }

    fn math(&self, node: Node<'_, '_>) -> Result<ForeignExpr, Problem> {
        let math = child(node, "math").ok_or_else(|| {
            Problem::new(
                Code::Foreign,
                &place(node),
                format!("'{}' has no formula", node.tag_name().name()),
                "this",
            )
            .help("write <math>")
        })?;
        self.formulas.meaning(math)
    }

    /// Whether rules may be about it.
    fn has(&self, id: &str) -> bool {
        self.index.compartments.contains_key(id)
            || self.index.species.contains_key(id)
            || self.index.parameters.contains(id)
    }

    fn read_rules(&mut self, model: Node<'_, '_>) -> Result<(), Problem> {
        for node in listed(model, "listOfRules") {
            let is_rate = is(node, "rateRule");
            if !is_rate && !is(node, "assignmentRule") {
                continue;
            }
            let variable = required(node, "variable")?.to_owned();
            let twice = self.index.rules.contains_key(&variable);
            if twice || !self.has(&variable) {
                let message = match twice {
                    true => format!("'{variable}' has two rules"),
                    false => format!(
                        "the rule is about '{variable}', which is no species, compartment or parameter"
                    ),
                };
                return Err(Problem::new(Code::Foreign, &place(node), message, "this rule")
                    .help("rules about stoichiometries are not read; write the number into the reaction"));
            }
            let rule = Rule { is_rate, value: self.math(node)?, span: place(node) };
            self.index.rules.insert(variable.clone(), self.rules.len());
            self.rules.push((variable, rule));
        }
        Ok(())
    }

    fn read_beginnings(&mut self, model: Node<'_, '_>) -> Result<(), Problem> {
        for node in listed(model, "listOfInitialAssignments") {
            let symbol = required(node, "symbol")?.to_owned();
            if !self.has(&symbol) {
                return Err(Problem::new(
                    Code::Foreign,
                    &place(node),
                    format!("'{symbol}' is no species, compartment or parameter"),
                    "this",
                )
                .help("assignments to stoichiometries are not read; write the number into the reaction"));
            }
            let value = self.math(node)?;
            self.index.begun.insert(symbol.clone());
            self.initial_values.push((symbol, value));
        }
        Ok(())
    }

    fn rule(&self, id: &str) -> Option<&Rule> {
        self.index.rules.get(id).map(|at| &self.rules[*at].1)
    }

    fn compartment(&self, id: &str) -> Option<&Compartment> {
        self.index.compartments.get(id).map(|at| &self.compartments[*at])
    }

    /// The model, and constants that begin by the states.
    fn model(self, node: Node<'_, '_>) -> Result<(ForeignModel, Vec<(String, ForeignExpr)>), Problem> {
        let title = node.attribute("name").or(node.attribute("id")).map(str::to_owned);
        let mut model = ForeignModel { title, source: source(node), ..ForeignModel::default() };
        for (id, rule) in &self.rules {
            match rule.is_rate {
                true => model.states.push(ForeignRate {
                    name: id.clone(),
                    rate: rule.value.clone(),
                    span: rule.span.clone(),
                }),
                false => model.definitions.push((id.clone(), rule.value.clone())),
            }
        }
        self.add_reactions(&mut model)?;
        self.add_held_species(&mut model)?;
        // laws stand in the order of the file, above the rates; states too
        let order: BTreeMap<&str, usize> =
            self.species.iter().enumerate().map(|(at, one)| (one.id.as_str(), at)).collect();
        model.states.sort_by_key(|state| order.get(state.name.as_str()).copied().unwrap_or(usize::MAX));
        let by_states = self.add_constants(&mut model);
        self.outputs(&mut model);
        let mut uses_time = false;
        let mut look =
            |value: &ForeignExpr| value.names(&mut |name, _| uses_time |= name == self.formulas.time);
        model.states.iter().for_each(|state| look(&state.rate));
        model.definitions.iter().for_each(|(_, value)| look(value));
        if uses_time {
            model.add_clock(&self.formulas.time);
        }
        self.refuse_unknown_names(&model)?;
        let unknown: Vec<&str> =
            model.constants.iter().filter(|c| c.is_unknown).map(|c| c.name.as_str()).collect();
        if !unknown.is_empty() {
            model.remarks.push("all parameters are taken to be unknown, and all initial conditions: --unknown says otherwise of parameters".to_owned());
        }
        Ok((model, by_states))
    }

    /// What does not change: sizes, constant species, parameters. Those that begin by the states are constants without a value.
    fn add_constants(&self, model: &mut ForeignModel) -> Vec<(String, ForeignExpr)> {
        let moved: BTreeSet<String> = model.states.iter().map(|state| state.name.clone()).collect();
        let defined: BTreeSet<String> = model.definitions.iter().map(|(name, _)| name.clone()).collect();
        let ruled = |id: &str| self.rule(id).is_some() || moved.contains(id) || defined.contains(id);
        let mut constants = Vec::new();
        let constant = |name: &str, value: Option<RBig>, is_unknown: bool| ForeignConstant {
            name: name.to_owned(),
            value,
            is_unknown,
            may_be_unknown: is_unknown,
        };
        for one in self.compartments.iter().filter(|one| !ruled(&one.id)) {
            constants.push(constant(&one.id, one.size.clone(), false));
        }
        let (mut held, mut by_size) = (Vec::new(), Vec::new());
        for one in self.species.iter().filter(|one| !ruled(&one.id)) {
            let value = self.beginning(one, |size| self.size_at_start(size));
            constants.push(constant(
                &one.id,
                value.as_ref().and_then(|value| value.as_number().cloned()),
                false,
            ));
            held.push(one.id.as_str());
            // an amount in a compartment whose size is a formula
            if let Some(value) = value.filter(|value| value.as_number().is_none()) {
                by_size.push((one.id.clone(), value));
            }
        }
        if !held.is_empty() {
            model.remarks.push(format!("species that are held are known constants: {}", held.join(", ")));
        }
        for (id, value) in self.parameters.iter().filter(|(id, _)| !ruled(id)) {
            constants.push(constant(id, value.clone(), true));
        }
        for (id, value) in self.reactions.iter().flat_map(|reaction| &reaction.local) {
            constants.push(constant(id, value.clone(), true));
        }
        // what begins as a formula of constants is one of them by that formula
        let mut fixed: BTreeSet<String> = constants.iter().map(|constant| constant.name.clone()).collect();
        fixed.extend(self.rules.iter().filter(|(_, rule)| !rule.is_rate).map(|(id, _)| id.clone()));
        let (mut states_begin, mut by_states) = (false, Vec::new());
        let mut moving = BTreeMap::new();
        let mut assigned = BTreeSet::new();
        by_size.retain(|(id, _)| !self.index.begun.contains(id));
        for (id, value) in self.initial_values.iter().chain(&by_size) {
            if moved.contains(id) {
                states_begin = true;
                continue;
            }
            let mut moves = false;
            value.names(&mut |name, _| {
                moves |= !fixed.contains(name) || self.depends_on_states(name, &moved, &mut moving);
            });
            if moves {
                by_states.push((id.clone(), value.clone()));
                continue;
            }
            assigned.insert(id.as_str());
            model.definitions.push((id.clone(), value.clone()));
        }
        if states_begin {
            model.remarks.push(
                "initial assignments of states are not taken over: the rank is decided for unknown initial conditions"
                    .to_owned(),
            );
        }
        let fixed: Vec<&str> = constants
            .iter()
            .filter(|constant| constant.may_be_unknown && assigned.contains(constant.name.as_str()))
            .map(|constant| constant.name.as_str())
            .collect();
        if !fixed.is_empty() {
            model
                .remarks
                .push(format!("fixed by initial assignments, and not identified: {}", fixed.join(", ")));
        }
        constants.retain(|constant| !assigned.contains(constant.name.as_str()));
        let begun = |name: &str| by_states.iter().any(|(id, _)| id == name);
        constants.iter_mut().filter(|one| begun(&one.name)).for_each(|one| one.value = None);
        model.constants = constants;
        by_states
    }

    /// Whether the size of a compartment, by its assignment rule, changes with time.
    fn changes(&self, id: &str) -> bool {
        let is_moved =
            |id: &String| self.rule(id).is_some_and(|rule| rule.is_rate) || self.moves_by_reactions(id);
        let moved: BTreeSet<String> = self
            .species
            .iter()
            .map(|one| &one.id)
            .chain(self.index.rules.keys())
            .filter(|id| is_moved(id))
            .cloned()
            .collect();
        self.depends_on_states(id, &moved, &mut BTreeMap::new())
    }

    /// Whether what a name stands for moves; `known` are the names of which that is known, those that are being looked at among them:
    /// what is defined by itself counts as moving.
    fn depends_on_states(
        &self,
        name: &str,
        moved: &BTreeSet<String>,
        known: &mut BTreeMap<String, bool>,
    ) -> bool {
        if moved.contains(name) || name == self.formulas.time {
            return true;
        }
        if let Some(moves) = known.get(name) {
            return *moves;
        }
        known.insert(name.to_owned(), true);
        let mut found = false;
        if let Some(rule) = self.rule(name).filter(|rule| !rule.is_rate) {
            rule.value.names(&mut |inner, _| found = found || self.depends_on_states(inner, moved, known));
        }
        known.insert(name.to_owned(), found);
        found
    }

    /// SBML has no outputs: assignments that nothing else uses are what the author looks at, else all species.
    fn outputs(&self, model: &mut ForeignModel) {
        let mut used = BTreeSet::new();
        let mut look = |value: &ForeignExpr| {
            value.names(&mut |name, _| {
                used.insert(name.to_owned());
            });
        };
        model.states.iter().for_each(|state| look(&state.rate));
        model.definitions.iter().for_each(|(_, value)| look(value));
        let free = self.rules.iter().filter(|(id, rule)| !rule.is_rate && !used.contains(id));
        let mut names: Vec<String> = free.map(|(id, _)| id.clone()).collect();
        if names.is_empty() {
            let is_species = |name: &&ForeignRate| self.index.species.contains_key(&name.name);
            names = model.states.iter().filter(is_species).map(|state| state.name.clone()).collect();
            if names.is_empty() {
                names = model.states.iter().map(|state| state.name.clone()).collect();
            }
            model.remarks.push(
                "SBML has no outputs: all species that move are measured here; --output says otherwise"
                    .to_owned(),
            );
        } else {
            model.remarks.push(
                "SBML has no outputs: what assignment rules say and nothing uses is measured here; --output says otherwise".to_owned(),
            );
        }
        model.outputs = names
            .into_iter()
            .map(|name| ForeignOutput { name: None, value: ForeignExpr::name(name, &(0..0)) })
            .collect();
    }

    fn refuse_unknown_names(&self, model: &ForeignModel) -> Result<(), Problem> {
        let known: BTreeSet<String> = model.all_names().into_iter().collect();
        let mut bad = None;
        let mut look = |value: &ForeignExpr| {
            value.names(&mut |name, span| {
                if !known.contains(name) && bad.is_none() {
                    bad = Some((name.to_owned(), span.clone()));
                }
            });
        };
        model.states.iter().for_each(|state| look(&state.rate));
        model.definitions.iter().for_each(|(_, value)| look(value));
        match bad {
            Some((name, span)) => {
                Err(Problem::new(Code::Foreign, &span, format!("nothing says what '{name}' is"), "this name")
                    .help("names are those of compartments, species, parameters, functions and reactions"))
            }
            None => Ok(()),
        }
    }
}

/// The functions of a model, each below those that it calls: level 3 has them in any order. Those that go round in a circle stand at the end, and
/// are refused there.
fn in_order<'a, 'i>(list: Vec<Node<'a, 'i>>) -> Vec<Node<'a, 'i>> {
    let by_id: BTreeMap<&str, usize> =
        list.iter().enumerate().filter_map(|(at, node)| Some((node.attribute("id")?, at))).collect();
    let calls = |node: &Node<'a, 'i>| -> BTreeSet<usize> {
        let heads = node.descendants().filter(|one| is(*one, "apply")).filter_map(|one| elements(one).next());
        heads
            .filter(|head| is(*head, "ci"))
            .filter_map(|head| by_id.get(text_of(head).as_str()).copied())
            .collect()
    };
    let mut waiting: Vec<usize> = Vec::new();
    let mut callers: Vec<Vec<usize>> = vec![Vec::new(); list.len()];
    for (at, node) in list.iter().enumerate() {
        let called = calls(node);
        waiting.push(called.len());
        called.into_iter().for_each(|other| callers[other].push(at));
    }
    // the first of those that wait for none
    let mut ready: BTreeSet<usize> = (0..list.len()).filter(|at| waiting[*at] == 0).collect();
    let (mut order, mut placed) = (Vec::new(), BTreeSet::new());
    while let Some(at) = ready.pop_first() {
        order.push(list[at]);
        placed.insert(at);
        for caller in &callers[at] {
            waiting[*caller] -= 1;
            if waiting[*caller] == 0 {
                ready.insert(*caller);
            }
        }
    }
    order.extend((0..list.len()).filter(|at| !placed.contains(at)).map(|at| list[at]));
    order
}

/// A function of the model: its name, its arguments and what it is of them.
fn function_definition(
    node: Node<'_, '_>,
    formulas: &Formulas,
) -> Result<(String, (Vec<String>, ForeignExpr)), Problem> {
    let id = required(node, "id")?.to_owned();
    let unread = || {
        Problem::new(Code::Foreign, &place(node), format!("the function '{id}' cannot be read"), "this")
            .help("a function is a <lambda>")
    };
    let lambda = child(node, "math").and_then(|math| {
        let math = child(math, "semantics").unwrap_or(math);
        child(math, "lambda")
    });
    let lambda = lambda.ok_or_else(unread)?;
    let bound =
        elements(lambda).filter(|one| is(*one, "bvar")).filter_map(|one| child(one, "ci")).map(text_of);
    let bound: Vec<String> = bound.collect();
    let body = elements(lambda).find(|one| !is(*one, "bvar")).ok_or_else(unread)?;
    let body = formulas.meaning_of(body)?;
    Ok((id, (bound, body)))
}

/// Where a model comes from: its id, and the papers that its annotation names.
fn source(model: Node<'_, '_>) -> Option<String> {
    let mut parts: Vec<String> = model.attribute("id").map(str::to_owned).into_iter().collect();
    let annotation = child(model, "annotation")?;
    let described = annotation.descendants().filter(|node| is(*node, "isDescribedBy"));
    for item in described.flat_map(|node| node.descendants()).filter(|node| is(*node, "li")) {
        let Some(resource) = item.attributes().find(|attribute| attribute.name() == "resource") else {
            continue;
        };
        let tail =
            resource.value().trim_start_matches("urn:miriam:").trim_start_matches("http://identifiers.org/");
        parts.push(tail.trim_start_matches("https://identifiers.org/").replace("%2F", "/").replace('/', ":"));
    }
    (!parts.is_empty()).then(|| parts.join(", "))
}
