//! The four kinds of tables: parameters, conditions, observables, measurements.

use super::tables::{Row, Table};
use super::{Measurement, Observable, Parameter, Reading, is_number};
use crate::expression::ForeignExpr;
use crate::script::{Dialect, Parser, Syntax, SyntaxKind, meaning, tokens};
use palmistry_io::foreign::Budget;
use palmistry_lang::{Problem, ReadError};
use std::collections::BTreeSet;

/// A formula of a table.
fn formula(text: &str, budget: &Budget) -> Result<ForeignExpr, Problem> {
    let (words, _) = tokens(text, Dialect::Printed, budget)?;
    let mut parser = Parser::new(&words, Dialect::Printed);
    let one = parser.expression()?;
    if !parser.at_end() {
        return Err(parser.unexpected("the end of the formula"));
    }
    let mut names = |part: &Syntax| match &part.kind {
        SyntaxKind::Name(name) => Some(Ok(ForeignExpr::name(name, &part.span))),
        _ => None,
    };
    meaning(&one, &mut names)
}

impl Reading<'_> {
    /// What a row adds to what is written.
    fn spend(&self, table: &Table<'_>, row: &Row, bytes: usize) -> Result<(), ReadError> {
        self.budget.bytes(bytes).map_err(|spent| {
            table.error(row, format!("the problem becomes too large: {spent}"), "take a part of it")
        })
    }

    pub(super) fn read_parameters(&mut self) -> Result<(), ReadError> {
        let mut names = BTreeSet::new();
        for file in &self.files.parameters {
            let table = Table::read(file, &["parameterId", "parameterScale", "estimate"])?;
            for row in &table.rows {
                let name = table.needed(row, "parameterId")?.to_owned();
                let scale = match table.cell(row, "parameterScale").unwrap_or("lin") {
                    "lin" => "linear",
                    "log" => "log",
                    "log10" => "log10",
                    other => {
                        let message = format!("'{other}' is no scale");
                        return Err(table.error(row, message, "parameterScale is lin, log or log10"));
                    }
                };
                let is_sought = match table.needed(row, "estimate")? {
                    "1" | "1.0" | "true" | "True" => true,
                    "0" | "0.0" | "false" | "False" => false,
                    other => {
                        return Err(table.error(
                            row,
                            format!("'{other}' is neither 0 nor 1"),
                            "estimate is 0 or 1",
                        ));
                    }
                };
                let bounds = match is_sought {
                    true => Some([table.number(row, "lowerBound")?, table.number(row, "upperBound")?]),
                    false => None,
                };
                if let Some([low, high]) = bounds {
                    if scale != "linear" && low <= 0.0 {
                        let message = format!("the lower bound {low} of '{name}' has no logarithm");
                        let help = format!("a parameter on the scale {scale} has bounds above zero");
                        return Err(table.error(row, message, help));
                    }
                    if low > high {
                        let message =
                            format!("the lower bound {low} of '{name}' is above the upper one, {high}");
                        return Err(table.error(row, message, "lowerBound is the smaller one"));
                    }
                }
                let mut nominal = table.cell(row, "nominalValue").map(str::to_owned);
                if let Some(text) = nominal.as_deref().filter(|text| !is_number(text)) {
                    return Err(table.error(
                        row,
                        format!("'{text}' is no number"),
                        "nominalValue is a decimal",
                    ));
                }
                if !is_sought && nominal.is_none() {
                    return Err(table.error(
                        row,
                        format!("'{name}' is not estimated, and has no value"),
                        "give it a nominalValue, or estimate it",
                    ));
                }
                if !names.insert(name.clone()) {
                    return Err(table.error(
                        row,
                        format!("'{name}' stands in the table twice"),
                        "take one row out",
                    ));
                }
                // between equal bounds there is nothing to estimate
                let (mut is_sought, mut bounds) = (is_sought, bounds);
                if let Some([low, high]) = bounds.filter(|[low, high]| low == high) {
                    (is_sought, bounds, nominal) = (false, None, Some(format!("{low:?}")));
                    self.remarks.push(format!("'{name}' is known: its bounds are both {high}"));
                }
                let prior = prior(&table, row, "objectivePrior")?;
                let starts = starts(&table, row)?;
                self.parameters.push((name, Parameter { scale, bounds, nominal, is_sought, prior, starts }));
            }
        }
        Ok(())
    }

    pub(super) fn read_conditions(&mut self) -> Result<(), ReadError> {
        for file in &self.files.conditions {
            let table = Table::read(file, &["conditionId"])?;
            for row in &table.rows {
                let id = table.needed(row, "conditionId")?.to_owned();
                let mut set = Vec::new();
                for (at, column) in table.columns.iter().enumerate() {
                    if matches!(column.as_str(), "conditionId" | "conditionName" | "") {
                        continue;
                    }
                    // an empty cell of a state keeps its value
                    let Some(cell) = row.at(at) else { continue };
                    self.spend(&table, row, column.len() + cell.len())?;
                    set.push((column.clone(), cell.to_owned()));
                }
                if self.conditions.insert(id.clone(), set).is_some() {
                    return Err(table.error(
                        row,
                        format!("the condition '{id}' stands in the table twice"),
                        "take one row out",
                    ));
                }
            }
        }
        Ok(())
    }

    pub(super) fn read_observables(&mut self) -> Result<(), ReadError> {
        let mut names = BTreeSet::new();
        for file in &self.files.observables {
            let table = Table::read(file, &["observableId", "observableFormula", "noiseFormula"])?;
            for row in &table.rows {
                let id = table.needed(row, "observableId")?.to_owned();
                let read = |column: &str| {
                    let text = table.needed(row, column)?;
                    formula(text, &self.budget).map_err(|problem| {
                        let help = problem
                            .help
                            .clone()
                            .unwrap_or_else(|| "a formula of names, numbers and functions".to_owned());
                        table.error(
                            row,
                            format!("the {column} '{text}' cannot be read: {}", problem.message),
                            help,
                        )
                    })
                };
                let compared = match table.cell(row, "observableTransformation").unwrap_or("lin") {
                    "lin" => "linear",
                    "log" => "log",
                    "log10" => "log10",
                    other => {
                        return Err(table.error(
                            row,
                            format!("'{other}' is no transformation"),
                            "it is lin, log or log10",
                        ));
                    }
                };
                let law = match table.cell(row, "noiseDistribution").unwrap_or("normal") {
                    "normal" => "normal",
                    "laplace" => "laplace",
                    other => {
                        return Err(table.error(
                            row,
                            format!("'{other}' is no distribution that is read"),
                            "it is normal or laplace",
                        ));
                    }
                };
                let observable = Observable {
                    formula: read("observableFormula")?,
                    noise: read("noiseFormula")?,
                    compared,
                    law,
                };
                if !names.insert(id.clone()) {
                    return Err(table.error(
                        row,
                        format!("the observable '{id}' stands in the table twice"),
                        "take one row out",
                    ));
                }
                self.observables.push((id, observable));
            }
        }
        Ok(())
    }

    pub(super) fn read_measurements(&mut self) -> Result<(), ReadError> {
        let known: BTreeSet<String> = self.observables.iter().map(|(id, _)| id.clone()).collect();
        for file in &self.files.measurements {
            let table = Table::read(file, &["observableId", "simulationConditionId", "measurement", "time"])?;
            for row in &table.rows {
                let observable = table.needed(row, "observableId")?.to_owned();
                if !known.contains(&observable) {
                    return Err(table.error(
                        row,
                        format!("'{observable}' is no observable"),
                        "the table of observables says which there are",
                    ));
                }
                let condition = table.needed(row, "simulationConditionId")?.to_owned();
                let before = table.cell(row, "preequilibrationConditionId").map(str::to_owned);
                for id in [Some(&condition), before.as_ref()].into_iter().flatten() {
                    if !self.conditions.contains_key(id) {
                        return Err(table.error(
                            row,
                            format!("'{id}' is no condition"),
                            "the table of conditions says which there are",
                        ));
                    }
                }
                let time = table.needed(row, "time")?;
                let time = match time.to_ascii_lowercase().as_str() {
                    "inf" | "infinity" | "+inf" => "inf".to_owned(),
                    _ => {
                        if table.number(row, "time")? < 0.0 {
                            return Err(table.error(
                                row,
                                format!("the time {time} is before the start"),
                                "times are counted from the start of the experiment",
                            ));
                        }
                        time.to_owned()
                    }
                };
                table.number(row, "measurement")?;
                let value = table.needed(row, "measurement")?.to_owned();
                let mut set = Vec::new();
                for (column, stem) in
                    [("observableParameters", "observableParameter"), ("noiseParameters", "noiseParameter")]
                {
                    let Some(cell) = table.cell(row, column) else { continue };
                    for (at, value) in cell.split(';').map(str::trim).enumerate() {
                        let name = format!("{stem}{}_{observable}", at + 1);
                        self.spend(&table, row, name.len() + value.len())?;
                        set.push((name, value.to_owned()));
                    }
                }
                self.measurements.push(Measurement { before, condition, observable, time, value, set });
            }
        }
        Ok(())
    }
}

/// A prior of a row: its law, whether it is on the scale of the parameter, and its numbers.
#[allow(clippy::type_complexity)] // named by its one caller
fn prior(
    table: &Table<'_>,
    row: &Row,
    stem: &str,
) -> Result<Option<(&'static str, bool, [f64; 2])>, ReadError> {
    let Some(kind) = table.cell(row, &format!("{stem}Type")) else { return Ok(None) };
    let (law, is_on_scale) = match kind {
        // between the bounds nothing is preferred
        "uniform" | "parameterScaleUniform" => return Ok(None),
        "normal" => ("normal", false),
        "laplace" => ("laplace", false),
        "logNormal" => ("log-normal", false),
        "logLaplace" => ("log-laplace", false),
        "parameterScaleNormal" => ("normal", true),
        "parameterScaleLaplace" => ("laplace", true),
        other => return Err(table.error(row, format!("'{other}' is no prior that is read"), "uniform, normal, laplace, logNormal, logLaplace, parameterScaleUniform, parameterScaleNormal and parameterScaleLaplace are")),
    };
    let numbers = pair(table, row, &format!("{stem}Parameters"))?;
    if numbers[1] <= 0.0 {
        return Err(table.error(
            row,
            format!("the spread {} of the prior is not positive", numbers[1]),
            "it is the second number",
        ));
    }
    Ok(Some((law, is_on_scale, numbers)))
}

/// Where searches begin, as values.
fn starts(table: &Table<'_>, row: &Row) -> Result<Option<[f64; 2]>, ReadError> {
    let value = |on_scale: f64| match table.cell(row, "parameterScale") {
        Some("log10") => 10f64.powf(on_scale),
        Some("log") => on_scale.exp(),
        _ => on_scale,
    };
    match table.cell(row, "initializationPriorType") {
        Some("uniform") => pair(table, row, "initializationPriorParameters").map(Some),
        Some("parameterScaleUniform") if table.cell(row, "initializationPriorParameters").is_some() => {
            pair(table, row, "initializationPriorParameters").map(|ends| Some(ends.map(value)))
        }
        _ => Ok(None),
    }
}

fn pair(table: &Table<'_>, row: &Row, column: &str) -> Result<[f64; 2], ReadError> {
    let text = table.needed(row, column)?;
    let numbers: Option<Vec<f64>> =
        text.split(';').map(|part| part.trim().parse::<f64>().ok().filter(|x| x.is_finite())).collect();
    match numbers.as_deref() {
        Some([a, b]) => Ok([*a, *b]),
        _ => Err(table.error(row, format!("'{text}' is no pair of numbers"), "two decimals with ; between")),
    }
}
