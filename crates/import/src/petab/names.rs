//! Names in the tables of a problem: each is something of the model, or of another table.

use super::tables::{Row, Table};
use super::{Observable, Reading, is_number};
use crate::expression::{ForeignExpr, ForeignKind, ForeignOrder};
use crate::model::ForeignConstant;
use dashu::rational::RBig;
use palmistry_lang::{ReadError, nearest};
use palmistry_math::number::parse_decimal;
use std::collections::{BTreeMap, BTreeSet};

/// What formulas of PEtab call time.
const TIME: &str = "time";

impl Reading<'_> {
    /// Makes time a state where observables name it.
    pub(super) fn look_for_time(&mut self) {
        let mut uses_time = false;
        for (_, one) in &self.observables {
            one.formula.names(&mut |name, _| uses_time |= name == TIME);
            one.noise.names(&mut |name, _| uses_time |= name == TIME);
        }
        let is_taken = self.model.all_names().iter().any(|name| name == TIME);
        if uses_time && !is_taken && self.model.clock.is_none() {
            self.model.add_clock(TIME);
            self.starts.push((TIME.to_owned(), ForeignExpr::integer(0, &(0..0))));
            self.remarks.push(format!("the observables name time: '{TIME}' is a state with the rate 1"));
        }
    }

    /// Looks for names that stand for nothing.
    ///
    /// # Errors
    /// The first one, in its row.
    pub(super) fn look_at_names(&self) -> Result<(), ReadError> {
        let entities: BTreeSet<String> = self.model.all_names().into_iter().collect();
        let parameters: BTreeSet<&str> = self.parameters.iter().map(|(name, _)| name.as_str()).collect();
        let mut in_formulas: BTreeSet<String> = BTreeSet::new();
        for (_, one) in &self.observables {
            for formula in [&one.formula, &one.noise] {
                formula.names(&mut |name, _| {
                    in_formulas.insert(name.to_owned());
                });
            }
        }
        let observables: BTreeMap<&str, &Observable> =
            self.observables.iter().map(|(id, one)| (id.as_str(), one)).collect();
        let is_value =
            |value: &str| is_number(value) || parameters.contains(value) || entities.contains(value);
        let mut columns: BTreeSet<&str> = BTreeSet::new();
        let mut values: BTreeSet<&str> = BTreeSet::new();
        for set in self.conditions.values() {
            columns.extend(set.iter().map(|(name, _)| name.as_str()));
            values.extend(set.iter().map(|(_, value)| value.as_str()));
        }
        let mut given: BTreeSet<&str> = BTreeSet::new();
        for one in &self.measurements {
            given.extend(one.set.iter().map(|(name, _)| name.as_str()));
            values.extend(one.set.iter().map(|(_, value)| value.as_str()));
        }
        let missing = |table: &Table<'_>, row: &Row, name: &str, what: &str| {
            let all = entities.iter().map(String::as_str).chain(parameters.iter().copied());
            let help = match nearest(name, all.filter(|own| *own != name)) {
                Some(other) => format!("perhaps '{other}' is meant"),
                None => "names are those of the model and of the table of parameters".to_owned(),
            };
            table.error(row, format!("'{name}' {what}"), help)
        };
        for file in &self.files.parameters {
            let table = Table::read(file, &["parameterId"])?;
            for row in &table.rows {
                let name = table.needed(row, "parameterId")?;
                if !(entities.contains(name) || in_formulas.contains(name) || values.contains(name)) {
                    return Err(missing(
                        &table,
                        row,
                        name,
                        "is nothing of the model, and stands in no other table",
                    ));
                }
            }
        }
        for file in &self.files.conditions {
            let table = Table::read(file, &["conditionId"])?;
            for row in &table.rows {
                let id = table.needed(row, "conditionId")?;
                for (name, value) in self.conditions.get(id).map_or(&[][..], Vec::as_slice) {
                    if !(entities.contains(name) || in_formulas.contains(name)) {
                        return Err(missing(&table, row, name, "is a column, and nothing of the model"));
                    }
                    if !is_value(value) {
                        return Err(missing(&table, row, value, "is no number, and no parameter"));
                    }
                }
            }
        }
        for file in &self.files.observables {
            let table = Table::read(file, &["observableId"])?;
            for row in &table.rows {
                let id = table.needed(row, "observableId")?;
                let Some(one) = observables.get(id) else { continue };
                // of its own parameters measurements say what they are, see below
                let is_own = |name: &str| {
                    let stem =
                        name.strip_prefix("observableParameter").or(name.strip_prefix("noiseParameter"));
                    stem.and_then(|stem| stem.split_once('_')).is_some_and(|(_, own)| own == id)
                };
                let mut bad = None;
                for (formula, is_noise) in [(&one.formula, false), (&one.noise, true)] {
                    formula.names(&mut |name, _| {
                        let known = entities.contains(name)
                            || parameters.contains(name)
                            || given.contains(name)
                            || columns.contains(name)
                            || is_own(name)
                            || is_noise && observables.contains_key(name);
                        if !known && bad.is_none() {
                            bad = Some(name.to_owned());
                        }
                    });
                }
                if let Some(name) = bad {
                    return Err(missing(
                        &table,
                        row,
                        &name,
                        "stands in a formula, and nothing says what it is",
                    ));
                }
            }
        }
        for file in &self.files.measurements {
            let table = Table::read(file, &["observableId"])?;
            for row in &table.rows {
                let id = table.needed(row, "observableId")?;
                for column in ["observableParameters", "noiseParameters"] {
                    let cell = table.cell(row, column).unwrap_or_default();
                    let bad =
                        cell.split(';').map(str::trim).find(|value| !value.is_empty() && !is_value(value));
                    if let Some(name) = bad {
                        return Err(missing(&table, row, name, "is no number, and no parameter"));
                    }
                    // as many as the formula has
                    let count = cell.split(';').filter(|value| !value.trim().is_empty()).count();
                    let stem = column.trim_end_matches('s');
                    let wanted =
                        (1..).take_while(|at| in_formulas.contains(&format!("{stem}{at}_{id}"))).count();
                    if count < wanted {
                        let message = format!("'{id}' needs {wanted} {column}, and this row has {count}");
                        return Err(table.error(
                            row,
                            message,
                            "write them into the row, with ';' between them",
                        ));
                    }
                }
            }
        }
        Ok(())
    }

    /// Makes constants of what the tables give values, and the model an initial assignment: the tables are asked first.
    pub(super) fn free_constants(&mut self, assigned: &BTreeSet<String>) {
        let mut set: BTreeSet<String> = self.parameters.iter().map(|(name, _)| name.clone()).collect();
        for condition in self.conditions.values() {
            set.extend(condition.iter().map(|(name, _)| name.clone()));
        }
        let is_free = |name: &String| set.contains(name) && assigned.contains(name);
        let free: Vec<String> =
            self.model.definitions.iter().map(|(name, _)| name.clone()).filter(is_free).collect();
        self.model.definitions.retain(|(name, _)| !is_free(name));
        self.model.constants.extend(free.into_iter().map(|name| ForeignConstant {
            name,
            value: None,
            is_unknown: false,
            may_be_unknown: true,
        }));
    }

    /// Writes initial values by the name of a compartment whose size the tables say.
    pub(super) fn size_compartments(&mut self, by_size: Vec<(String, String, ForeignExpr)>) {
        let mut set: BTreeSet<&str> =
            self.parameters.iter().filter(|(_, one)| one.is_sought).map(|(name, _)| name.as_str()).collect();
        let mut columns: BTreeSet<&str> = BTreeSet::new();
        for condition in self.conditions.values() {
            columns.extend(condition.iter().map(|(name, _)| name.as_str()));
        }
        set.extend(columns.iter().copied());
        let mut values: BTreeMap<String, ForeignExpr> = by_size
            .into_iter()
            .filter(|(_, compartment, _)| set.contains(compartment.as_str()))
            .map(|(species, _, value)| (species, value))
            .collect();
        for (name, start) in &mut self.starts {
            if let Some(value) = values.remove(name) {
                *start = value;
            }
        }
        // a species that is held is an amount by the size, too
        values.retain(|species, _| !columns.contains(species.as_str()));
        let definitions = &mut self.model.definitions;
        self.model.constants.retain(|constant| match values.remove(&constant.name) {
            Some(value) => {
                definitions.push((constant.name.clone(), value));
                false
            }
            None => true,
        });
    }

    /// Moves the limits of cases off the values that experiments give to a constant: where both sides are equal, a case that is written by `sign` has
    /// no value. Between those values it makes no difference where a limit is.
    pub(super) fn keep_off_cases(&mut self) {
        let mut values: BTreeMap<String, Option<BTreeSet<RBig>>> = BTreeMap::new();
        for (name, value) in self.conditions.values().flatten() {
            let all = values.entry(name.clone()).or_insert_with(|| Some(BTreeSet::new()));
            match (all.as_mut(), is_number(value).then(|| parse_decimal(value)).flatten()) {
                (Some(all), Some(value)) => {
                    all.insert(value);
                }
                _ => *all = None,
            }
        }
        // where a condition leaves it out, it has the value of the model
        for constant in &self.model.constants {
            let left_out = |set: &Vec<(String, String)>| !set.iter().any(|(name, _)| *name == constant.name);
            if let (Some(Some(all)), Some(value)) = (values.get_mut(&constant.name), &constant.value)
                && self.conditions.values().any(left_out)
            {
                all.insert(value.clone());
            }
        }
        self.model.varied.extend(values.keys().cloned());
        let mut moved: BTreeSet<String> = BTreeSet::new();
        let mut each = |case: &mut ForeignExpr| {
            let ForeignKind::Case { sides, order, .. } = &mut case.kind else { return };
            let (name, limit, order) = match (&sides.0.kind, &sides.1.kind) {
                (ForeignKind::Name(name), ForeignKind::Number(limit)) => {
                    (name.clone(), limit.clone(), *order)
                }
                (ForeignKind::Number(limit), ForeignKind::Name(name)) => {
                    let turned = match order {
                        ForeignOrder::Less => ForeignOrder::Greater,
                        ForeignOrder::AtMost => ForeignOrder::AtLeast,
                        ForeignOrder::Greater => ForeignOrder::Less,
                        ForeignOrder::AtLeast => ForeignOrder::AtMost,
                    };
                    (name.clone(), limit.clone(), turned)
                }
                _ => return,
            };
            let Some(Some(all)) = values.get(&name) else { return };
            if !all.contains(&limit) {
                return;
            }
            // up where the limit itself belongs to what is below
            let above = all.iter().find(|value| **value > limit).cloned();
            let below = all.iter().rev().find(|value| **value < limit).cloned();
            let other = match order {
                ForeignOrder::AtMost | ForeignOrder::Greater => above.unwrap_or(&limit + RBig::ONE),
                ForeignOrder::Less | ForeignOrder::AtLeast => below.unwrap_or(&limit - RBig::ONE),
            };
            let middle = (limit + other) / RBig::from(2);
            for side in [&mut sides.0, &mut sides.1] {
                if side.as_number().is_some() {
                    side.kind = ForeignKind::Number(middle.clone());
                }
            }
            moved.insert(name);
        };
        self.model.states.iter_mut().for_each(|state| state.rate.cases(&mut each));
        self.model.definitions.iter_mut().for_each(|(_, value)| value.cases(&mut each));
        self.observables.iter_mut().for_each(|(_, one)| one.formula.cases(&mut each));
        if !moved.is_empty() {
            let list = moved.into_iter().collect::<Vec<_>>().join(", ");
            self.remarks
                .push(format!("limits of cases were moved between the values that conditions give: {list}"));
        }
    }
}
