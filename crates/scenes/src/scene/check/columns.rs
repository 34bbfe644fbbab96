//! Names and units of a recording's columns.

use super::super::columns::SceneColumn;
use super::super::keys::ColumnKeys;
use super::{Checks, Problem};
use palmistry_lang::scaled_unit;
use std::collections::{BTreeMap, BTreeSet};

impl Checks<'_> {
    pub(super) fn columns(
        &self,
        keys: BTreeMap<String, ColumnKeys>,
    ) -> Result<BTreeMap<String, SceneColumn>, Problem> {
        let mut columns = BTreeMap::new();
        let mut taken = BTreeSet::new();
        for (name, keys) in keys {
            let place = |key: &str| format!("columns.{name}.{key}");
            let factor = keys.factor.unwrap_or(1.0);
            let offset = keys.offset.unwrap_or(0.0);
            self.finite(&place("factor"), factor)?;
            self.finite(&place("offset"), offset)?;
            if factor == 0.0 {
                return Err(self.wrong(
                    &place("factor"),
                    "a factor of zero leaves nothing",
                    "leave it out, or give another",
                ));
            }
            let unit = keys.unit.as_deref().map(scaled_unit).transpose().map_err(|why| {
                let help = "a unit is made of words such as mm, deg, rpm, kPa or s with * / ^; or give a 'factor' in its place";
                self.wrong(&place("unit"), why, help)
            })?;
            let from = keys.from.unwrap_or_else(|| name.clone());
            if from.trim().is_empty() {
                return Err(self.wrong(
                    &place("from"),
                    "the name of a column is empty",
                    "name a column of the recording",
                ));
            }
            if !taken.insert(from.clone()) {
                let message = format!("the column '{from}' is taken twice");
                return Err(self.wrong_key(&format!("columns.{name}"), message, "leave one out"));
            }
            columns.insert(name, SceneColumn { from, unit, factor, offset });
        }
        Ok(columns)
    }
}
