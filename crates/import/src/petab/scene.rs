//! The scene of a problem, and its measurements.

use super::{Measurement, Reading, is_number};
use crate::expression::{DEEPEST, ForeignExpr};
use crate::names::ForeignNames;
use palmistry_lang::{Code, Problem};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

/// A text between quotation marks, as TOML reads it.
fn quoted(text: &str) -> String {
    let mut out = String::from("\"");
    for c in text.chars() {
        match c {
            '"' | '\\' => {
                out.push('\\');
                out.push(c);
            }
            _ if c.is_control() => {
                let _ = write!(out, "\\u{:04X}", u32::from(c));
            }
            _ => out.push(c),
        }
    }
    out.push('"');
    out
}

/// A number or a name, as a value of TOML.
fn value(text: &str, names: &ForeignNames) -> String {
    match is_number(text) {
        true => number(text),
        false => quoted(names.ours(text)),
    }
}

/// A decimal as TOML reads it: with digits on both sides of the point.
fn number(text: &str) -> String {
    // the shortest decimal of the nearest double
    text.parse::<f64>().map_or_else(|_| quoted(text), |value| format!("{value:?}"))
}

/// A table in one line.
fn inline(pairs: &[(String, String)]) -> String {
    let list: Vec<String> = pairs.iter().map(|(name, value)| format!("{name} = {value}")).collect();
    format!("{{ {} }}", list.join(", "))
}

impl Reading<'_> {
    /// The experiments: conditions, each with its preequilibration condition where there is one, in the order in which they are first measured.
    pub(super) fn experiments(&self) -> Vec<(String, Option<&str>, &str)> {
        let mut found: Vec<(String, Option<&str>, &str)> = Vec::new();
        for one in &self.measurements {
            let name = experiment_of(one);
            if !found.iter().any(|(other, ..)| *other == name) {
                found.push((name, one.before.as_deref(), &one.condition));
            }
        }
        found
    }

    /// What a condition sets; `first` is the condition in which the states begin.
    fn settings(&self, condition: &str, first: &str, names: &ForeignNames) -> Result<String, Problem> {
        let set = self.conditions.get(condition).map_or(&[][..], Vec::as_slice);
        let mut pairs: Vec<(String, String)> =
            set.iter().map(|(name, own)| (names.ours(name).to_owned(), value(own, names))).collect();
        let starts = if self.by_states.is_empty() { BTreeMap::new() } else { self.starts_in(first) };
        let is_set: BTreeSet<&str> = set.iter().map(|(name, _)| name.as_str()).collect();
        for (id, formula) in self.by_states.iter().filter(|(id, _)| !is_set.contains(id.as_str())) {
            let formula = self.at_start(formula, &starts)?;
            pairs.push((names.ours(id).to_owned(), quoted(&self.text(&formula, names)?)));
        }
        Ok(inline(&pairs))
    }

    /// What each state is at the start in a condition; none of a state of which nothing says it.
    fn starts_in(&self, condition: &str) -> BTreeMap<&str, Option<ForeignExpr>> {
        let mut found: BTreeMap<&str, Option<ForeignExpr>> =
            self.model.states.iter().map(|state| (state.name.as_str(), None)).collect();
        for (name, start) in &self.starts {
            found.entry(name.as_str()).and_modify(|own| *own = Some(start.clone()));
        }
        for (name, own) in self.conditions.get(condition).map_or(&[][..], Vec::as_slice) {
            let number = ForeignExpr::number(own, &(0..0)).ok().filter(|_| is_number(own));
            let value = number.unwrap_or_else(|| ForeignExpr::name(own, &(0..0)));
            found.entry(name.as_str()).and_modify(|start| *start = Some(value));
        }
        found
    }

    /// A formula with what the states are at the start put in. What comes of it is counted before it is made: starts may be formulas of other starts, and double.
    fn at_start(
        &self,
        formula: &ForeignExpr,
        starts: &BTreeMap<&str, Option<ForeignExpr>>,
    ) -> Result<ForeignExpr, Problem> {
        let mut whole = formula.clone();
        for _ in 0..=starts.len() {
            let (mut size, mut deepest, mut is_met, mut unknown) = (whole.size(), 0, false, None);
            whole.names(&mut |name, _| match starts.get(name) {
                Some(Some(start)) => {
                    is_met = true;
                    size = size.saturating_add(start.size());
                    deepest = deepest.max(start.depth());
                }
                Some(None) => unknown = Some(name.to_owned()),
                None => {}
            });
            if let Some(name) = unknown {
                let message = format!("nothing says what '{name}' is at the start");
                return Err(Problem::new(Code::Foreign, &formula.span, message, "this formula needs it")
                    .help("give it an initial value"));
            }
            if !is_met {
                return Ok(whole);
            }
            self.budget.nodes(size).map_err(|spent| crate::too_much(&formula.span, spent))?;
            if whole.depth() + deepest > DEEPEST {
                return Err(Problem::new(
                    Code::Foreign,
                    &formula.span,
                    "initial values that are nested too deeply",
                    "this",
                )
                .help("give some of them values of their own"));
            }
            whole.replace(&|name| starts.get(name).cloned().flatten());
        }
        Err(Problem::new(Code::Foreign, &formula.span, "initial values that go round in a circle", "this")
            .help("give one of them a value of its own"))
    }

    pub(super) fn scene(
        &self,
        title: &str,
        origin: &str,
        stem: &str,
        names: &ForeignNames,
    ) -> Result<String, Problem> {
        let mut out = String::new();
        let _ = writeln!(out, "# {}", palmistry_io::foreign::name_of(std::path::Path::new(origin)));
        let _ = writeln!(out, "title = {}", quoted(title));
        let _ = writeln!(out, "model = {}", quoted(&format!("{stem}.proof")));
        let _ = writeln!(out, "measurements = {}", quoted(&format!("{stem}.csv")));
        out.push_str("\n# states at the start of each experiment, unless it says otherwise\n[initial]\n");
        for (state, start) in &self.starts {
            let text = self.text(start, names)?;
            let text = if is_number(&text) { number(&text) } else { quoted(&text) };
            let _ = writeln!(out, "{} = {text}", names.ours(state));
        }
        out.push_str("\n# how far measurements are off what is expected of them\n[errors]\n");
        for (id, one) in &self.observables {
            let mut pairs = Vec::new();
            let text = self.text(&one.noise, names)?;
            pairs.push(("size".to_owned(), if is_number(&text) { number(&text) } else { quoted(&text) }));
            if one.compared != "linear" {
                pairs.push(("on".to_owned(), quoted(one.compared)));
            }
            if one.law != "normal" {
                pairs.push(("law".to_owned(), quoted(one.law)));
            }
            let _ = writeln!(out, "{} = {}", names.ours(id), inline(&pairs));
        }
        out.push_str("\n# what is estimated: within bounds, on a scale; the nominal values are published ones\n[parameters]\n");
        for (name, one) in self.parameters.iter().filter(|(_, one)| one.is_sought) {
            let mut pairs = Vec::new();
            if let Some([low, high]) = one.bounds {
                pairs.push(("bounds".to_owned(), format!("[{low:?}, {high:?}]")));
            }
            pairs.push(("scale".to_owned(), quoted(one.scale)));
            pairs.extend(one.nominal.as_deref().map(|text| ("nominal".to_owned(), number(text))));
            pairs.extend(one.starts.map(|[low, high]| ("starts".to_owned(), format!("[{low:?}, {high:?}]"))));
            if let Some((law, is_on_scale, [centre, spread])) = one.prior {
                let on = if is_on_scale { ", on = \"scale\"" } else { "" };
                let text = format!("{{ law = \"{law}\", centre = {centre:?}, spread = {spread:?}{on} }}");
                pairs.push(("prior".to_owned(), text));
            }
            let _ = writeln!(out, "{} = {}", names.ours(name), inline(&pairs));
        }
        let known: Vec<String> = self
            .parameters
            .iter()
            .filter(|(_, one)| !one.is_sought)
            .filter_map(|(name, one)| {
                Some(format!("{} = {}", names.ours(name), number(one.nominal.as_deref()?)))
            })
            .collect();
        if !known.is_empty() {
            let _ = writeln!(out, "\n[known]\n{}", known.join("\n"));
        }
        for (name, before, condition) in self.experiments() {
            let set = self.settings(condition, before.unwrap_or(condition), names)?;
            let _ = writeln!(out, "\n[experiments.{}]\nset = {set}", quoted(&name));
            if let Some(before) = before {
                let _ = writeln!(out, "before = {}", self.settings(before, before, names)?);
            }
        }
        Ok(out)
    }

    pub(super) fn csv(&self, names: &ForeignNames) -> String {
        let mut writer = csv::WriterBuilder::new().from_writer(Vec::new());
        let has_set = self.measurements.iter().any(|one| !one.set.is_empty());
        let mut head = vec!["experiment", "output", "time", "value"];
        head.extend(has_set.then_some("set"));
        // a vector takes all that is written
        let _ = writer.write_record(&head);
        for one in &self.measurements {
            let mut row = vec![
                experiment_of(one),
                names.ours(&one.observable).to_owned(),
                one.time.clone(),
                one.value.clone(),
            ];
            let set = one.set.iter().map(|(name, value)| {
                let value = if is_number(value) { value.as_str() } else { names.ours(value) };
                format!("{} = {value}", names.ours(name))
            });
            if has_set {
                row.push(set.collect::<Vec<_>>().join("; "));
            }
            let _ = writer.write_record(&row);
        }
        writer.into_inner().ok().and_then(|bytes| String::from_utf8(bytes).ok()).unwrap_or_default()
    }
}

/// The name of a measurement's experiment.
fn experiment_of(one: &Measurement) -> String {
    match &one.before {
        Some(before) => format!("{} after {before}", one.condition),
        None => one.condition.clone(),
    }
}
