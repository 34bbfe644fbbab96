//! Species and what reactions do to them.

use super::super::expression::{ForeignExpr, ForeignKind, Span};
use super::super::model::{ForeignModel, ForeignRate};
use super::mathml::Formulas;
use super::xml::{child, elements, is, listed, place, required, says};
use super::{Reading, value_of};
use dashu::rational::RBig;
use palmistry_lang::{Code, Problem};
use roxmltree::Node;
use std::collections::{BTreeMap, BTreeSet};

/// A species.
pub(super) struct Species {
    pub id: String,
    pub compartment: String,
    amount: Option<RBig>,
    concentration: Option<RBig>,
    /// Whether its symbol is an amount, and no concentration.
    is_amount: bool,
    /// Whether reactions do not change it.
    is_held: bool,
    factor: Option<String>,
    span: Span,
}

impl Species {
    /// Reads a species; `factor` is what the model multiplies all changes by that name no factor of their own.
    pub fn read(node: Node<'_, '_>, factor: Option<&str>) -> Result<Species, Problem> {
        Ok(Species {
            id: required(node, "id")?.to_owned(),
            compartment: required(node, "compartment")?.to_owned(),
            amount: value_of(node, "initialAmount")?,
            concentration: value_of(node, "initialConcentration")?,
            is_amount: says(node, "hasOnlySubstanceUnits", false),
            is_held: says(node, "boundaryCondition", false) || says(node, "constant", false),
            factor: node.attribute("conversionFactor").or(factor).map(str::to_owned),
            span: place(node),
        })
    }

    /// Its initial value by an amount or a concentration alone, whichever its symbol means.
    fn given(&self, means_amount: bool) -> Option<&RBig> {
        if means_amount { self.amount.as_ref() } else { self.concentration.as_ref() }
    }
}

/// A reaction: what its rate is called, what it is, and how much of which species it makes.
pub(super) struct Reaction {
    id: String,
    law: Option<ForeignExpr>,
    /// Species and how much of it; negative where it is used up.
    makes: Vec<(String, ForeignExpr)>,
    /// Constants of this reaction alone, under names that nothing else has.
    pub local: Vec<(String, Option<RBig>)>,
    span: Span,
}

/// Names that are taken, and of those that several wanted, the last number that was put behind.
#[derive(Default)]
pub(super) struct Taken {
    pub names: BTreeSet<String>,
    pub counts: BTreeMap<String, usize>,
}

/// The names of constants of reactions that more than one reaction has, or that mean something in the whole model.
pub(super) fn shared_local_names(model: Node<'_, '_>) -> BTreeSet<String> {
    let mut count: BTreeMap<&str, usize> = BTreeMap::new();
    for node in model.descendants().filter(|node| node.is_element()) {
        if let Some(id) = node.attribute("id") {
            *count.entry(id).or_default() += 1;
        }
    }
    count.into_iter().filter(|(_, count)| *count > 1).map(|(id, _)| id.to_owned()).collect()
}

impl Reaction {
    pub fn read(
        node: Node<'_, '_>,
        formulas: &Formulas,
        is_level_3: bool,
        shared: &BTreeSet<String>,
        taken: &mut Taken,
    ) -> Result<Reaction, Problem> {
        let id = required(node, "id")?.to_owned();
        let mut makes = Vec::new();
        for (list, sign) in [("listOfReactants", -1), ("listOfProducts", 1)] {
            for reference in listed(node, list) {
                let species = required(reference, "species")?.to_owned();
                let count = stoichiometry(reference, formulas, is_level_3)?;
                makes.push((species, if sign < 0 { count.negative() } else { count }));
            }
        }
        let mut reaction = Reaction { id, law: None, makes, local: Vec::new(), span: place(node) };
        let Some(law) = child(node, "kineticLaw") else { return Ok(reaction) };
        let Some(math) = child(law, "math") else { return Ok(reaction) };
        let mut value = formulas.meaning(math)?;
        let Taken { names: taken, counts } = taken;
        let mut names: BTreeMap<String, String> = BTreeMap::new();
        for list in ["listOfParameters", "listOfLocalParameters"] {
            for parameter in listed(law, list) {
                let own = required(parameter, "id")?;
                let mut name = own.to_owned();
                if shared.contains(own) {
                    let wanted = format!("{own}_{}", reaction.id);
                    name.clone_from(&wanted);
                    let count = counts.entry(wanted.clone()).or_insert(1);
                    while taken.contains(&name) {
                        *count += 1;
                        name = format!("{wanted}_{count}");
                    }
                }
                taken.insert(name.clone());
                names.insert(own.to_owned(), name.clone());
                reaction.local.push((name, value_of(parameter, "value")?));
            }
        }
        value.replace(&|name| names.get(name).map(|own| ForeignExpr::name(own, &(0..0))));
        reaction.law = Some(value);
        Ok(reaction)
    }
}

/// How much of a species takes part.
fn stoichiometry(node: Node<'_, '_>, formulas: &Formulas, is_level_3: bool) -> Result<ForeignExpr, Problem> {
    if let Some(math) = elements(node).find(|one| is(*one, "stoichiometryMath")) {
        return match child(math, "math") {
            Some(math) => formulas.meaning(math),
            None => {
                Err(Problem::new(Code::Foreign, &place(math), "a stoichiometry without a formula", "this")
                    .help("write <math>"))
            }
        };
    }
    let span = place(node);
    match value_of(node, "stoichiometry")? {
        Some(value) => Ok(ForeignExpr::new(ForeignKind::Number(value), &span)),
        None if is_level_3 => {
            Err(Problem::new(Code::Foreign, &span, "the stoichiometry is not said", "this")
                .help("level 3 asks for stoichiometry=\"1\"; one that changes is not read"))
        }
        None => Ok(ForeignExpr::integer(1, &span)),
    }
}

impl Reading<'_> {
    /// Laws as definitions, and rates of the species that reactions change, or that nothing changes and nothing holds.
    pub(super) fn add_reactions(&self, model: &mut ForeignModel) -> Result<(), Problem> {
        for reaction in &self.reactions {
            let changes = reaction.makes.iter().any(|(species, _)| self.moves_by_reactions(species));
            match &reaction.law {
                Some(law) => model.definitions.push((reaction.id.clone(), law.clone())),
                None if changes => {
                    let message = format!("the reaction '{}' has no kinetic law", reaction.id);
                    return Err(Problem::new(Code::Foreign, &reaction.span, message, "this")
                        .help("a model of rates has one for each reaction"));
                }
                None => {}
            }
            if let Some((species, place)) =
                reaction.makes.iter().find(|(species, _)| !self.index.species.contains_key(species))
            {
                return Err(Problem::new(
                    Code::Foreign,
                    &place.span,
                    format!("nothing says what the species '{species}' is"),
                    "this",
                )
                .help("list it under listOfSpecies"));
            }
        }
        // which reaction makes how much of which species
        let mut made: BTreeMap<&str, Vec<(usize, &ForeignExpr)>> = BTreeMap::new();
        for (at, reaction) in self.reactions.iter().enumerate() {
            for (species, count) in &reaction.makes {
                made.entry(species).or_default().push((at, count));
            }
        }
        for species in self.species.iter().filter(|one| self.moves_by_reactions(&one.id)) {
            let rate = self.rate(species, made.get(species.id.as_str()).map_or(&[], Vec::as_slice))?;
            model.states.push(ForeignRate { name: species.id.clone(), rate, span: species.span.clone() });
        }
        Ok(())
    }

    pub(super) fn moves_by_reactions(&self, id: &str) -> bool {
        self.index.species.get(id).is_some_and(|at| !self.species[*at].is_held) && self.rule(id).is_none()
    }

    /// The rate of a species, by what reactions make of it.
    fn rate(&self, species: &Species, made: &[(usize, &ForeignExpr)]) -> Result<ForeignExpr, Problem> {
        let span = &species.span;
        let mut terms = Vec::new();
        for (reaction, count) in made {
            let reaction = &self.reactions[*reaction];
            let rate = ForeignExpr::name(&reaction.id, &reaction.span);
            let (negative, size) = match count.as_number() {
                Some(value) if *value < RBig::ZERO => (true, Some(-value.clone())),
                Some(value) => (false, Some(value.clone())),
                None => (false, None),
            };
            let term = match size {
                Some(size) if size == RBig::ONE => rate,
                Some(size) if size == RBig::ZERO => continue,
                Some(size) => ForeignExpr::new(ForeignKind::Number(size), span).times(rate),
                None => (*count).clone().times(rate),
            };
            terms.push((negative, term));
        }
        let mut rate = match terms.len() {
            0 => return Ok(self.dilution(species)?.unwrap_or_else(|| ForeignExpr::integer(0, span))),
            1 if !terms[0].0 => terms.remove(0).1,
            _ => ForeignExpr::new(ForeignKind::Sum(terms), span),
        };
        if let Some(factor) = &species.factor {
            rate = ForeignExpr::name(factor, span).times(rate);
        }
        if self.is_concentration(species) {
            rate = rate.over(ForeignExpr::name(&species.compartment, span));
        }
        Ok(match self.dilution(species)? {
            Some(change) => rate.plus(change),
            None => rate,
        })
    }

    /// The initial value of a species, as its symbol means it, where the file says so. Where it has to be found by the size of its compartment,
    /// that size is asked for.
    pub(super) fn beginning(
        &self,
        species: &Species,
        size: impl FnOnce(&str) -> Option<ForeignExpr>,
    ) -> Option<ForeignExpr> {
        let number = |value: &RBig| ForeignExpr::new(ForeignKind::Number(value.clone()), &(0..0));
        let means_amount = !self.is_concentration(species);
        if let Some(value) = species.given(means_amount) {
            return Some(number(value));
        }
        let other = species.given(!means_amount)?;
        let size = size(&species.compartment)?;
        Some(match (size.as_number(), means_amount) {
            (Some(size), true) => number(&(other * size)),
            (Some(size), false) if *size == RBig::ZERO => return None,
            (Some(size), false) => number(&(other / size)),
            (None, true) => number(other).times(size),
            (None, false) => number(other).over(size),
        })
    }

    /// The size of a compartment at the start: a number, or its name where a formula says what it is.
    pub(super) fn size_at_start(&self, id: &str) -> Option<ForeignExpr> {
        let assigned = self.rule(id).is_some_and(|rule| !rule.is_rate) || self.index.begun.contains(id);
        match (assigned, self.compartment(id).and_then(|own| own.size.clone())) {
            (true, _) => Some(ForeignExpr::name(id, &(0..0))),
            (false, Some(size)) => Some(ForeignExpr::new(ForeignKind::Number(size), &(0..0))),
            (false, None) => None,
        }
    }

    /// Rates and definitions of species that nothing changes, in compartments that change: their amounts are constant, and so their concentrations
    /// are not.
    pub(super) fn add_held_species(&self, model: &mut ForeignModel) -> Result<(), Problem> {
        let mut changes: BTreeMap<&str, bool> = BTreeMap::new();
        for species in self.species.iter().filter(|one| one.is_held && self.rule(&one.id).is_none()) {
            let Some(rule) = self.rule(&species.compartment).filter(|_| self.is_concentration(species))
            else {
                continue;
            };
            if rule.is_rate {
                let rate = self.dilution(species)?.unwrap_or_else(|| ForeignExpr::integer(0, &species.span));
                model.states.push(ForeignRate { name: species.id.clone(), rate, span: species.span.clone() });
                model.remarks.push(format!(
                    "the amount of '{}' is held: its concentration is a state that changes with the size of '{}'",
                    species.id, species.compartment
                ));
                continue;
            }
            let has_beginning = self.index.begun.contains(&species.id);
            if let Some(amount) = species.amount.as_ref().filter(|_| !has_beginning) {
                let amount = ForeignExpr::new(ForeignKind::Number(amount.clone()), &species.span);
                let size = ForeignExpr::name(&species.compartment, &species.span);
                model.definitions.push((species.id.clone(), amount.over(size)));
            } else if *changes
                .entry(&species.compartment)
                .or_insert_with(|| self.changes(&species.compartment))
            {
                let message = format!(
                    "the amount of '{}' is held in a compartment whose size is assigned, and begins as a concentration",
                    species.id
                );
                return Err(Problem::new(Code::Foreign, &species.span, message, "this species")
                    .help("give it an initialAmount: its concentration is that by the size"));
            }
        }
        Ok(())
    }

    fn is_concentration(&self, species: &Species) -> bool {
        let compartment = self.compartment(&species.compartment);
        !species.is_amount && !compartment.is_some_and(|one| one.is_point)
    }

    /// How a concentration changes because the size of its compartment does.
    fn dilution(&self, species: &Species) -> Result<Option<ForeignExpr>, Problem> {
        let Some(rule) = self.rule(&species.compartment).filter(|_| self.is_concentration(species)) else {
            return Ok(None);
        };
        if !rule.is_rate {
            let message =
                format!("'{}' is a concentration in a compartment whose size is assigned", species.id);
            return Err(Problem::new(Code::Foreign, &species.span, message, "this species")
                .help("write the rate of the size as a rate rule, or the species as an amount"));
        }
        let span = &species.span;
        let share = ForeignExpr::name(&species.id, span).times(rule.value.clone());
        Ok(Some(share.over(ForeignExpr::name(&species.compartment, span)).negative()))
    }
}
