//! Problems of parameter estimation in the format PEtab, version 1: a proof file of the model, and a scene with its experiments and measurements.
//!
//! The SBML model gives rates and initial values; tables give conditions, observables, measurements and parameters. Nothing is calculated here: formulas
//! go from text to text, in the names of the proof file.
//!
//! Reference: L. Schmiester et al., PEtab: interoperable specification of parameter estimation problems in systems biology, PLoS Comput. Biol. 17, 2021.

mod scene;
mod tables;
mod yaml;

use super::expression::{ForeignExpr, ForeignKind};
use super::model::{ForeignConstant, ForeignModel, ForeignOutput};
use super::names::ForeignNames;
use super::script::{Dialect, Parser, Syntax, SyntaxKind, meaning, tokens};
use super::{ALLOWANCE, STACK, print, sbml, write};
use palmistry_io::foreign::Budget;
use palmistry_lang::{Problem, ReadError, System, with_plain_line_ends};
use palmistry_math::number::parse_decimal;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Component, Path};
use tables::{Row, Table};
use yaml::Yaml;

/// A file of a problem.
#[derive(Clone, Debug)]
pub struct PetabFile {
    /// The name under which it is shown.
    pub name: String,
    /// Its text.
    pub text: String,
}

/// Reads a file that a problem names, from the folder in which the problem lies.
pub type PetabLoader<'l> = dyn Fn(&str) -> Result<PetabFile, String> + Sync + 'l;

/// Reads what a problem names: files beside or below it, and no others, for a problem may be a stranger's.
pub fn petab_beside(problem: &Path) -> impl Fn(&str) -> Result<PetabFile, String> + Sync + use<> {
    let folder = problem.parent().unwrap_or(Path::new("")).to_owned();
    move |name: &str| {
        let named = Path::new(name);
        let is_inside =
            named.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
        if !is_inside {
            return Err("it lies outside of the folder of the problem".to_owned());
        }
        let path = folder.join(named);
        let text = palmistry_io::file::read_text(&path, ALLOWANCE.bytes).map_err(|why| why.to_string())?;
        Ok(PetabFile { name: palmistry_io::foreign::name_of(&path), text })
    }
}

/// A problem as files of ours.
#[derive(Clone, Debug)]
pub struct ImportedProblem {
    /// Its title.
    pub title: String,
    /// The proof file of the model.
    pub proof: String,
    /// The scene: experiments, errors, parameters.
    pub scene: String,
    /// The measurements, as CSV.
    pub measurements: String,
    /// How many states, parameters that are sought, outputs, experiments and measurements there are.
    pub counts: [usize; 5],
    /// What is called otherwise: foreign names and ours.
    pub renamed: Vec<(String, String)>,
    /// What is worth knowing.
    pub remarks: Vec<String>,
}

/// Whether a text is a PEtab problem: it names a parameter file and problems.
pub fn is_petab(text: &str) -> bool {
    let begins = |word: &str| text.lines().any(|line| line.starts_with(word));
    begins("parameter_file") && begins("problems")
}

/// Reads a problem. `stem` is what its files will be called: `stem.proof`, `stem.toml` and `stem.csv`.
///
/// # Errors
/// What cannot be read, where, and what to do.
pub fn import_petab(
    name: &str,
    text: &str,
    stem: &str,
    load: &PetabLoader<'_>,
) -> Result<ImportedProblem, ReadError> {
    let read = std::thread::scope(|scope| {
        let thread = std::thread::Builder::new().stack_size(STACK);
        let running = thread.spawn_scoped(scope, || read(name, text, stem, load));
        running.ok().map(|running| running.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
    });
    read.unwrap_or_else(|| {
        let problem = Problem::new(&(0..text.len().min(1)), "there is no room to read this file", "the file");
        Err(problem.help("free some memory, and report the file if that does not help").locate(name, text))
    })
}

fn read(name: &str, text: &str, stem: &str, load: &PetabLoader<'_>) -> Result<ImportedProblem, ReadError> {
    let refused = |message: String, help: &str| {
        Problem::new(&(0..text.len().min(1)), message, "the file").help(help).locate(name, text)
    };
    let yaml = Yaml::read(text).map_err(|problem| problem.locate(name, text))?;
    let no_problem = || {
        refused(
            "this is no PEtab problem: it does not name 'parameter_file' and 'problems'".to_owned(),
            "PEtab 1.0 names both, and the tables of the problem",
        )
    };
    let version = yaml.get("format_version").and_then(Yaml::text).unwrap_or("1").trim();
    if !version.starts_with('1') {
        return Err(refused(
            "PEtab of this version is not read".to_owned(),
            "version 1 is: petab-python converts between them",
        ));
    }
    let parameters = yaml.get("parameter_file").and_then(Yaml::texts).ok_or_else(no_problem)?;
    let Some(Yaml::List(problems)) = yaml.get("problems") else { return Err(no_problem()) };
    let [problem] = problems.as_slice() else {
        let message = format!("the file has {} problems", problems.len());
        return Err(refused(message, "one is read: write each into a file of its own"));
    };
    let files_of = |key: &str| problem.get(key).and_then(Yaml::texts).unwrap_or_default();
    let models = files_of("sbml_files");
    let [model] = models.as_slice() else {
        let message = format!("the problem has {} SBML files", models.len());
        return Err(refused(message, "one model is read"));
    };
    let all = |names: &[String]| -> Result<Vec<PetabFile>, ReadError> {
        let one = |file: &String| {
            load(file).map_err(|why| {
                refused(
                    format!("cannot read {}: {why}", palmistry_io::foreign::name_of(Path::new(file))),
                    "files are looked for from the folder of the problem",
                )
            })
        };
        names.iter().map(one).collect()
    };
    let files = Files {
        model: all(std::slice::from_ref(model))?.remove(0),
        parameters: all(&parameters)?,
        conditions: all(&files_of("condition_files"))?,
        observables: all(&files_of("observable_files"))?,
        measurements: all(&files_of("measurement_files"))?,
    };
    let title =
        Path::new(name).file_stem().map_or(name.to_owned(), |stem| stem.to_string_lossy().into_owned());
    let file =
        Path::new(name).file_name().map_or(name.to_owned(), |file| file.to_string_lossy().into_owned());
    Reading::of(&files)?.written(&title, &file, stem, refused)
}

struct Files {
    model: PetabFile,
    parameters: Vec<PetabFile>,
    conditions: Vec<PetabFile>,
    observables: Vec<PetabFile>,
    measurements: Vec<PetabFile>,
}

/// A parameter of the table.
struct Parameter {
    scale: &'static str,
    bounds: Option<[f64; 2]>,
    nominal: Option<String>,
    is_sought: bool,
    /// The law, whether it is on the scale of the parameter, and its two numbers.
    prior: Option<(&'static str, bool, [f64; 2])>,
    starts: Option<[f64; 2]>,
}

/// An observable of the table.
struct Observable {
    formula: ForeignExpr,
    noise: ForeignExpr,
    compared: &'static str,
    law: &'static str,
}

/// A measurement of the table.
struct Measurement {
    before: Option<String>,
    condition: String,
    observable: String,
    time: String,
    value: String,
    set: Vec<(String, String)>,
}

struct Reading<'f> {
    files: &'f Files,
    budget: Budget,
    model: ForeignModel,
    starts: Vec<(String, ForeignExpr)>,
    parameters: Vec<(String, Parameter)>,
    conditions: BTreeMap<String, Vec<(String, String)>>,
    observables: Vec<(String, Observable)>,
    measurements: Vec<Measurement>,
}

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

/// Whether a text is a number.
fn is_number(text: &str) -> bool {
    text.parse::<f64>().is_ok_and(f64::is_finite)
}

impl<'f> Reading<'f> {
    fn of(files: &'f Files) -> Result<Reading<'f>, ReadError> {
        let budget = Budget::new(ALLOWANCE);
        let text = with_plain_line_ends(&files.model.text);
        let started =
            sbml::read_started(&text, &budget).map_err(|problem| problem.locate(&files.model.name, &text))?;
        let mut reading = Reading {
            files,
            budget,
            model: started.model,
            starts: started.starts,
            parameters: Vec::new(),
            conditions: BTreeMap::new(),
            observables: Vec::new(),
            measurements: Vec::new(),
        };
        reading.read_parameters()?;
        reading.read_conditions()?;
        reading.read_observables()?;
        reading.read_measurements()?;
        Ok(reading)
    }

    fn read_parameters(&mut self) -> Result<(), ReadError> {
        for file in &self.files.parameters {
            let table = Table::read(file, &["parameterId", "parameterScale", "estimate"])?;
            for row in &table.rows {
                let name = table.needed(row, "parameterId")?.to_owned();
                let scale = match row.cell("parameterScale").unwrap_or("lin") {
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
                let nominal = row.cell("nominalValue").map(str::to_owned);
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
                if self.parameters.iter().any(|(other, _)| *other == name) {
                    return Err(table.error(
                        row,
                        format!("'{name}' stands in the table twice"),
                        "take one row out",
                    ));
                }
                let prior = prior(&table, row, "objectivePrior")?;
                let starts = starts(&table, row)?;
                self.parameters.push((name, Parameter { scale, bounds, nominal, is_sought, prior, starts }));
            }
        }
        Ok(())
    }

    fn read_conditions(&mut self) -> Result<(), ReadError> {
        for file in &self.files.conditions {
            let table = Table::read(file, &["conditionId"])?;
            for row in &table.rows {
                let id = table.needed(row, "conditionId")?.to_owned();
                let mut set = Vec::new();
                for column in table
                    .columns
                    .iter()
                    .filter(|column| !matches!(column.as_str(), "conditionId" | "conditionName" | ""))
                {
                    // an empty cell of a state leaves it as it is
                    let Some(cell) = row.cell(column).filter(|cell| !cell.eq_ignore_ascii_case("nan")) else {
                        continue;
                    };
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

    fn read_observables(&mut self) -> Result<(), ReadError> {
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
                let compared = match row.cell("observableTransformation").unwrap_or("lin") {
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
                let law = match row.cell("noiseDistribution").unwrap_or("normal") {
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
                if self.observables.iter().any(|(other, _)| *other == id) {
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

    fn read_measurements(&mut self) -> Result<(), ReadError> {
        for file in &self.files.measurements {
            let table = Table::read(file, &["observableId", "simulationConditionId", "measurement", "time"])?;
            for row in &table.rows {
                let observable = table.needed(row, "observableId")?.to_owned();
                if !self.observables.iter().any(|(id, _)| *id == observable) {
                    return Err(table.error(
                        row,
                        format!("'{observable}' is no observable"),
                        "the table of observables says which there are",
                    ));
                }
                let condition = table.needed(row, "simulationConditionId")?.to_owned();
                let before = row.cell("preequilibrationConditionId").map(str::to_owned);
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
                    let Some(cell) = row.cell(column) else { continue };
                    for (at, value) in cell.split(';').map(str::trim).enumerate() {
                        set.push((format!("{stem}{}_{observable}", at + 1), value.to_owned()));
                    }
                }
                self.measurements.push(Measurement { before, condition, observable, time, value, set });
            }
        }
        Ok(())
    }

    /// The names that only tables have.
    fn names_of_tables(&self) -> Vec<String> {
        let known: BTreeSet<String> = self.model.all_names().into_iter().collect();
        let mut seen = BTreeSet::new();
        let mut found = Vec::new();
        let mut add = |name: &str| {
            if !known.contains(name) && seen.insert(name.to_owned()) {
                found.push(name.to_owned());
            }
        };
        self.parameters.iter().for_each(|(name, _)| add(name));
        for (_, one) in &self.observables {
            one.formula.names(&mut |name, _| add(name));
            one.noise.names(&mut |name, _| add(name));
        }
        for set in self.conditions.values().chain(self.measurements.iter().map(|one| &one.set)) {
            for (name, value) in set {
                add(name);
                if !is_number(value) {
                    add(value);
                }
            }
        }
        found
    }

    /// What tables say of constants of the model; outputs by the observables.
    fn put_tables_in(&mut self) {
        let by_name: BTreeMap<&str, &Parameter> =
            self.parameters.iter().map(|(name, one)| (name.as_str(), one)).collect();
        for constant in &mut self.model.constants {
            constant.is_unknown = false;
            let Some(one) = by_name.get(constant.name.as_str()) else { continue };
            constant.is_unknown = one.is_sought;
            constant.value = match one.is_sought {
                true => None,
                false => one.nominal.as_deref().and_then(parse_decimal),
            };
        }
        let known: BTreeSet<String> = self.model.all_names().into_iter().collect();
        let mut others = BTreeSet::new();
        for (_, one) in &self.observables {
            one.formula.names(&mut |name, _| {
                if !known.contains(name) && others.insert(name.to_owned()) {
                    let own = by_name.get(name);
                    self.model.constants.push(ForeignConstant {
                        name: name.to_owned(),
                        value: own
                            .filter(|one| !one.is_sought)
                            .and_then(|one| one.nominal.as_deref())
                            .and_then(parse_decimal),
                        is_unknown: own.is_none_or(|one| one.is_sought),
                        may_be_unknown: true,
                    });
                }
            });
        }
        // measurements name their outputs
        for (id, one) in &self.observables {
            if !known.contains(id) {
                self.model.definitions.push((id.clone(), one.formula.clone()));
            }
        }
        let output = |(id, _): &(String, Observable)| ForeignOutput {
            name: Some(id.clone()),
            value: ForeignExpr::name(id, &(0..0)),
        };
        self.model.outputs = self.observables.iter().map(output).collect();
        // nobody is without a clock
        if let Some(clock) = &self.model.clock {
            let value = ForeignExpr::name(clock, &(0..0));
            self.model.outputs.push(ForeignOutput { name: None, value });
        }
        self.model.remarks =
            vec!["initial values stand in the scene: the rank is decided for unknown ones".to_owned()];
    }

    /// Starts without definitions: those may be dropped from the file.
    fn inline_definitions(&mut self) -> Result<(), Problem> {
        let definitions: BTreeMap<String, ForeignExpr> = self.model.definitions.iter().cloned().collect();
        for (_, start) in &mut self.starts {
            // definitions go round in no circle: that was looked at
            for _ in 0..=definitions.len() {
                let mut has_any = false;
                start.names(&mut |name, _| has_any |= definitions.contains_key(name));
                if !has_any {
                    break;
                }
                start.replace(&|name| definitions.get(name).cloned());
                self.budget.nodes(start.size()).map_err(|spent| super::too_much(&start.span, spent))?;
            }
        }
        Ok(())
    }

    fn written(
        mut self,
        title: &str,
        name: &str,
        stem: &str,
        refused: impl Fn(String, &str) -> ReadError,
    ) -> Result<ImportedProblem, ReadError> {
        let of_model = |problem: Problem| problem.locate(&self.files.model.name, &self.files.model.text);
        let tables = self.names_of_tables();
        self.put_tables_in();
        self.model.order_definitions().map_err(of_model)?;
        self.inline_definitions().map_err(of_model)?;
        let origin = format!("PEtab problem {name}");
        let proof = write::proof_text(&self.model, &origin, &self.budget).map_err(of_model)?;
        let renamed: BTreeMap<&str, &str> =
            proof.renamed.iter().map(|(from, to)| (from.as_str(), to.as_str())).collect();
        let mut all = self.model.all_names();
        all.extend(self.observables.iter().map(|(id, _)| id.clone()));
        let names = ForeignNames::of(all.iter().chain(&tables).map(String::as_str));
        let differs =
            all.iter().find(|name| names.ours(name) != *renamed.get(name.as_str()).unwrap_or(&name.as_str()));
        if let Some(name) = differs {
            return Err(refused(
                format!("'{name}' has to be renamed, and so would another name be"),
                "rename it in the model",
            ));
        }
        if let Err(why) = System::parse("import.proof", &proof.text, Path::new("")) {
            return Err(refused(
                format!("what was made of the model is no proof file: {}", why.message),
                "report the file",
            ));
        }
        let text = palmistry_lang::format_text("import.proof", &proof.text).unwrap_or(proof.text);
        let scene = self.scene(title, name, stem, &names).map_err(of_model)?;
        let measurements = self.csv(&names);
        let sought = self.parameters.iter().filter(|(_, one)| one.is_sought).count();
        let counts = [
            self.model.states.len(),
            sought,
            self.observables.len(),
            self.experiments().len(),
            self.measurements.len(),
        ];
        let renamed = names.renamed().map(|(from, to)| (from.to_owned(), to.to_owned())).collect();
        Ok(ImportedProblem {
            title: title.to_owned(),
            proof: text,
            scene,
            measurements,
            counts,
            renamed,
            remarks: self.model.remarks,
        })
    }

    /// An expression in our language.
    fn text(&self, expression: &ForeignExpr, names: &ForeignNames) -> Result<String, Problem> {
        if let ForeignKind::Case { .. } = expression.kind {
            return Err(Problem::new(&expression.span, "a formula by cases is not read here", "this")
                .help("make it an assignment rule of the model"));
        }
        print::text(expression, names, &self.budget)
    }
}

/// A prior of a row: its law, whether it is on the scale of the parameter, and its numbers.
#[allow(clippy::type_complexity)] // named by its one caller
fn prior(
    table: &Table<'_>,
    row: &Row,
    stem: &str,
) -> Result<Option<(&'static str, bool, [f64; 2])>, ReadError> {
    let Some(kind) = row.cell(&format!("{stem}Type")) else { return Ok(None) };
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
    let value = |on_scale: f64| match row.cell("parameterScale") {
        Some("log10") => 10f64.powf(on_scale),
        Some("log") => on_scale.exp(),
        _ => on_scale,
    };
    match row.cell("initializationPriorType") {
        Some("uniform") => pair(table, row, "initializationPriorParameters").map(Some),
        Some("parameterScaleUniform") if row.cell("initializationPriorParameters").is_some() => {
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
