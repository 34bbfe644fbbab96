//! Problems of parameter estimation in the format PEtab, version 1: a proof file of the model, and a scene with its experiments and measurements.
//!
//! The SBML model gives rates and initial values; tables give conditions, observables, measurements and parameters. Nothing is calculated here: formulas
//! go from text to text, in the names of the proof file.
//!
//! Reference: L. Schmiester et al., PEtab: interoperable specification of parameter estimation problems in systems biology, PLoS Comput. Biol. 17, 2021.

mod names;
mod read;
mod scene;
mod tables;
mod yaml;

use super::expression::{ForeignExpr, ForeignKind};
use super::model::{ForeignConstant, ForeignModel, ForeignOutput};
use super::names::ForeignNames;
use super::{ALLOWANCE, STACK, print, sbml, write};
use palmistry_io::foreign::Budget;
use palmistry_lang::{Code, Problem, ReadError, System, with_plain_line_ends};
use palmistry_math::number::parse_decimal;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Component, Path};
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
        // a name beside the problem may stand for a file elsewhere
        let real = |path: &Path| path.canonicalize().map_err(|why| why.to_string());
        if !real(&path)?.starts_with(real(if folder.as_os_str().is_empty() {
            Path::new(".")
        } else {
            &folder
        })?) {
            return Err("it lies outside of the folder of the problem".to_owned());
        }
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
    /// The numbers of states, estimated parameters, outputs, experiments and measurements.
    pub counts: [usize; 5],
    /// What is called otherwise: foreign names and ours.
    pub renamed: Vec<(String, String)>,
    /// Remarks for the user.
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
        let problem = Problem::new(
            Code::Foreign,
            &(0..text.len().min(1)),
            "there is no room to read this file",
            "the file",
        );
        Err(problem.help("free some memory, and report the file if that does not help").locate(name, text))
    })
}

fn read(name: &str, text: &str, stem: &str, load: &PetabLoader<'_>) -> Result<ImportedProblem, ReadError> {
    let refused = |message: String, help: &str| {
        Problem::new(Code::Foreign, &(0..text.len().min(1)), message, "the file")
            .help(help)
            .locate(name, text)
    };
    let yaml = Yaml::read(text).map_err(|problem| problem.locate(name, text))?;
    let no_problem = || {
        refused(
            "this is no PEtab problem: it does not name 'parameter_file' and 'problems'".to_owned(),
            "PEtab 1.0 names both, and the tables of the problem",
        )
    };
    let version = yaml.get("format_version").and_then(Yaml::text).unwrap_or("1").trim();
    if version.split('.').next() != Some("1") {
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
    /// Constants that begin by the states, each with its formula.
    by_states: Vec<(String, ForeignExpr)>,
    parameters: Vec<(String, Parameter)>,
    conditions: BTreeMap<String, Vec<(String, String)>>,
    observables: Vec<(String, Observable)>,
    measurements: Vec<Measurement>,
    /// What a reader of the new files has to know.
    remarks: Vec<String>,
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
            by_states: started.by_states,
            parameters: Vec::new(),
            conditions: BTreeMap::new(),
            observables: Vec::new(),
            measurements: Vec::new(),
            remarks: Vec::new(),
        };
        reading.read_parameters()?;
        reading.read_conditions()?;
        reading.read_observables()?;
        reading.read_measurements()?;
        reading.look_for_time();
        reading.look_at_names()?;
        // the tables are asked first
        let of_tables = |name: &str| reading.parameters.iter().any(|(own, _)| own == name);
        let by_states = std::mem::take(&mut reading.by_states);
        reading.by_states = by_states.into_iter().filter(|(name, _)| !of_tables(name)).collect();
        reading.free_constants(&started.assigned);
        reading.size_compartments(started.by_size);
        Ok(reading)
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
        self.keep_off_cases();
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
        self.remarks
            .insert(0, "initial values stand in the scene: the rank is decided for unknown ones".to_owned());
        self.model.remarks = std::mem::take(&mut self.remarks);
    }

    /// Starts without definitions: those may be dropped from the file.
    fn inline_definitions(&mut self) -> Result<(), Problem> {
        let definitions: BTreeMap<String, ForeignExpr> = self.model.definitions.iter().cloned().collect();
        for (_, start) in self.starts.iter_mut().chain(&mut self.by_states) {
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
            return Err(Problem::new(
                Code::Foreign,
                &expression.span,
                "a formula by cases is not read here",
                "this",
            )
            .help("make it an assignment rule of the model"));
        }
        print::text(expression, names, &self.budget)
    }
}
