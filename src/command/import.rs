//! `palmistry import`: models of other programs, as proof files.

use super::output::{Files, Form};
use super::{Status, Unusable};
use clap::{Args, ValueEnum};
use palmistry::file;
use palmistry::foreign::name_of;
use palmistry::import::{
    ForeignFormat, ForeignUnknowns, ImportQuestion, ImportedModel, ImportedProblem, import, import_petab,
    is_petab, petab_beside,
};
use palmistry::system::Code;
use serde_json::json;
use std::path::PathBuf;

/// Files longer than this are refused, as by every command that reads them.
const LONGEST_FILE: u64 = 16 << 20;

/// Takes a model of another program and writes it as a proof file, with its source cited.
///
/// Nothing of the file is run: it is read as text, by a reader of its format. What cannot be read is named with its line, and what was
/// written is read back before you get it. Expressions are taken over exactly (a decimal is the fraction that it denotes), names
/// that mean something else in proof files are changed, and a comment in the new file says so.
///
/// Formats are recognised by the content and the name of the file:
///   julia         @ODEmodel and @DDSmodel of StructuralIdentifiability.jl; @parameters, @variables, D(x) ~ ... and
///                 measured_quantities = [y ~ x] of ModelingToolkit.jl
///   sbml          SBML core, levels 2 and 3, without events, delays and algebraic rules
///   strikepy      model files of StrikePy: x, p, h, f, u and w
///   strike-goldd  model scripts of STRIKE-GOLDD, in MATLAB
///   petab         problems of parameter estimation (PEtab 1.0, .yaml): a proof file, and beside it a scene for 'observe' with
///                 its experiments and parameters, and the measurements as CSV
///   formulas      what SymPy and CasADi print: x' = e, Eq(Derivative(x(t), t), e), Matrix([[e], [e]]), [e, e], @1=e
#[derive(Args)]
#[command(
    verbatim_doc_comment,
    after_help = "Examples:
  palmistry import SIWR.jl --out siwr.proof
  palmistry import benchmarks.jl --model Goodwin        one of several @ODEmodel
  palmistry import BIOMD0000000003.xml --output C,M --unknown VM1,VM3
  palmistry import printed.txt --from formulas --state x,y --output x
  palmistry import problem.yaml --out boehm.toml && palmistry observe boehm.toml
  palmistry import HIV.py --out hiv.proof && palmistry rank hiv.proof --samples 0"
)]
pub(crate) struct Import {
    /// The foreign file.
    pub(super) file: PathBuf,
    /// The format of the file; recognised unless given.
    #[arg(long, value_enum, value_name = "FORMAT")]
    from: Option<From>,
    /// Write the proof file here; without it, it is printed. For a PEtab problem NAME.proof, the scene NAME.toml and the measurements NAME.csv
    /// are written beside each other.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Which of several models, by its name or its number.
    #[arg(long, value_name = "NAME")]
    model: Option<String>,
    /// What is measured, in place of what the file says: names of states, definitions or outputs; for formulas expressions too.
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    output: Vec<String>,
    /// Which parameters are to be identified: all, none, or these. Without it those that the file says, and for SBML all.
    #[arg(long, value_name = "all|none|NAME,...", value_delimiter = ',')]
    unknown: Vec<String>,
    /// Parameters that are known input signals.
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    input: Vec<String>,
    /// Parameters that are unknown input signals.
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    unknown_input: Vec<String>,
    /// The states in the order of a vector of rates, for formulas that do not name them.
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    state: Vec<String>,
    /// Print one JSON object with the proof file as 'proof', its 'format', what the model has, what was 'renamed' and what is worth
    /// knowing in 'remarks'.
    #[arg(long)]
    pub json: bool,
}

/// A format by its word.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum From {
    Julia,
    Sbml,
    Strikepy,
    StrikeGoldd,
    Petab,
    #[value(aliases = ["sympy", "casadi"])]
    Formulas,
}

impl From {
    /// A format of models; none of a problem, which is more than a model.
    fn format(self) -> Option<ForeignFormat> {
        Some(match self {
            From::Petab => return None,
            From::Julia => ForeignFormat::Julia,
            From::Sbml => ForeignFormat::Sbml,
            From::Strikepy => ForeignFormat::StrikePy,
            From::StrikeGoldd => ForeignFormat::StrikeGoldd,
            From::Formulas => ForeignFormat::Formulas,
        })
    }
}

impl Import {
    pub fn run(self) -> miette::Result<Status> {
        let shown = name_of(&self.file);
        let text = file::read_old_text(&self.file, LONGEST_FILE)
            .map_err(|why| Unusable::report(Code::File, format!("cannot read {shown}: {why}"), ""))?;
        if matches!(self.from, Some(From::Petab)) || self.from.is_none() && is_petab(&text) {
            return self.run_petab(&shown, &text);
        }
        let imported = import(&shown, &text, &self.question())?;
        let mut files = Files::default();
        if let Some(out) = &self.out {
            files.text(out, &imported.text);
        }
        let to_standard = self.out.as_ref().is_none_or(|out| out.as_os_str() == "-");
        if !self.json && to_standard && self.out.is_some() {
            // it went there already
            remarks(&imported);
            files.note_failures();
            return Ok(if files.whole() { Status::AsExpected } else { Status::Unwritten });
        }
        let written = self.out.as_ref().filter(|out| files.has_written(out));
        let object = json!({
            "file": shown,
            "format": imported.format.name(),
            "written": written.map(|out| name_of(out)),
            "proof": imported.text,
            "title": imported.model.title,
            "source": imported.model.source,
            "states": imported.model.states.iter().map(|state| &state.name).collect::<Vec<_>>(),
            "unknown_parameters": constants(&imported, true),
            "known_parameters": constants(&imported, false),
            "known_inputs": imported.model.known_inputs,
            "unknown_inputs": imported.model.unknown_inputs,
            "outputs": imported.model.outputs.len(),
            "renamed": imported.renamed.iter().map(|(from, to)| json!({ "from": from, "to": to })).collect::<Vec<_>>(),
            "remarks": imported.model.remarks,
        });
        let words = match &self.out {
            None => imported.text.trim_end().to_owned(),
            Some(_) => in_words(&imported),
        };
        if !self.json {
            remarks(&imported);
        }
        if let Some(out) = &self.out {
            files.announce(out);
        }
        files.print(Form::of(self.json), object, || words, Status::AsExpected)
    }

    /// The files that `--out` makes: of a PEtab problem three side by side, and of anything else the one that it names.
    pub(super) fn written(&self) -> Vec<PathBuf> {
        let Some(out) = self.out.as_ref().filter(|out| out.as_os_str() != "-") else { return Vec::new() };
        let is_problem = match self.from {
            Some(from) => matches!(from, From::Petab),
            // a pipe can be read once
            None if !self.file.is_file() => false,
            None => file::read_old_text(&self.file, LONGEST_FILE).is_ok_and(|text| is_petab(&text)),
        };
        match is_problem {
            true => ["proof", "csv", "toml"].map(|end| out.with_extension(end)).to_vec(),
            false => vec![out.clone()],
        }
    }

    fn question(&self) -> ImportQuestion {
        let list = |names: &[String]| -> Vec<String> {
            names.iter().map(|name| name.trim().to_owned()).filter(|name| !name.is_empty()).collect()
        };
        let unknown = list(&self.unknown);
        let unknowns = match unknown.as_slice() {
            [] => ForeignUnknowns::AsTheFileSays,
            [all] if all == "all" => ForeignUnknowns::All,
            [none] if none == "none" => ForeignUnknowns::None,
            _ => ForeignUnknowns::These(unknown),
        };
        ImportQuestion {
            format: self.from.and_then(From::format),
            model: self.model.clone(),
            outputs: list(&self.output),
            unknowns,
            known_inputs: list(&self.input),
            unknown_inputs: list(&self.unknown_input),
            states: list(&self.state),
        }
    }
}

impl Import {
    /// A problem of parameter estimation: three files.
    fn run_petab(self, shown: &str, text: &str) -> miette::Result<Status> {
        let of_models = [
            (self.model.is_some(), "--model"),
            (!self.output.is_empty(), "--output"),
            (!self.unknown.is_empty(), "--unknown"),
            (!self.input.is_empty(), "--input"),
            (!self.unknown_input.is_empty(), "--unknown-input"),
            (!self.state.is_empty(), "--state"),
        ];
        if let Some((_, option)) = of_models.iter().find(|(is_given, _)| *is_given) {
            let message = format!("{option} is not for a PEtab problem");
            return Err(Unusable::report(
                Code::Option,
                message,
                "leave it out: its tables say which parameters are estimated and what is measured",
            ));
        }
        let stem = match &self.out {
            Some(out) if out.as_os_str() != "-" => out.clone(),
            _ => PathBuf::from(&self.file),
        };
        let stem_name =
            stem.file_stem().map_or("problem".to_owned(), |stem| stem.to_string_lossy().into_owned());
        let imported = import_petab(shown, text, &stem_name, &petab_beside(&self.file))?;
        let mut files = Files::default();
        let beside = |extension: &str| stem.with_extension(extension);
        let is_written = self.out.as_ref().is_some_and(|out| out.as_os_str() != "-");
        if is_written {
            files.text(&beside("proof"), &imported.proof);
            files.text(&beside("csv"), &imported.measurements);
            files.text(&beside("toml"), &imported.scene);
            files.announce(&beside("toml"));
        }
        let [states, parameters, outputs, experiments, measurements] = imported.counts;
        let object = json!({
            "file": shown,
            "format": "petab",
            "written": is_written.then(|| name_of(&beside("toml"))),
            "title": imported.title,
            "proof": imported.proof,
            "scene": imported.scene,
            "measurements": imported.measurements,
            "states": states,
            "parameters": parameters,
            "outputs": outputs,
            "experiments": experiments,
            "measured": measurements,
            "renamed": imported.renamed.iter().map(|(from, to)| json!({ "from": from, "to": to })).collect::<Vec<_>>(),
            "remarks": imported.remarks,
        });
        if !self.json {
            petab_remarks(&imported, is_written);
        }
        let words = match is_written {
            false => imported.proof.trim_end().to_owned(),
            true => {
                let count = |number: usize, what: &str| {
                    format!("{number} {what}{}", if number == 1 { "" } else { "s" })
                };
                format!(
                    "petab: {}, {} to be estimated, {}, {}, {}",
                    count(states, "state"),
                    count(parameters, "parameter"),
                    count(outputs, "output"),
                    count(experiments, "experiment"),
                    count(measurements, "measurement")
                )
            }
        };
        files.print(Form::of(self.json), object, || words, Status::AsExpected)
    }
}

/// What is worth knowing of a problem.
fn petab_remarks(imported: &ImportedProblem, is_written: bool) {
    for remark in &imported.remarks {
        file::note(&format!("note: {remark}"));
    }
    let renamed: Vec<String> = imported.renamed.iter().map(|(from, to)| format!("{from} -> {to}")).collect();
    if !renamed.is_empty() {
        file::note(&format!("note: renamed {}", renamed.join(", ")));
    }
    if !is_written {
        file::note(
            "note: this is the model alone; --out NAME.toml writes its experiments and measurements too",
        );
    }
}

/// The names of constants, by whether they are to be identified.
fn constants(imported: &ImportedModel, unknown: bool) -> Vec<&str> {
    let all = imported.model.constants.iter().filter(|constant| constant.is_unknown == unknown);
    all.map(|constant| constant.name.as_str()).collect()
}

fn in_words(imported: &ImportedModel) -> String {
    let model = &imported.model;
    let count = |number: usize, what: &str| format!("{number} {what}{}", if number == 1 { "" } else { "s" });
    let mut parts = vec![
        count(model.states.len(), "state"),
        count(constants(imported, true).len(), "unknown parameter"),
        count(constants(imported, false).len(), "known parameter"),
    ];
    let inputs = model.known_inputs.len() + model.unknown_inputs.len();
    parts.extend((inputs > 0).then(|| count(inputs, "input")));
    parts.push(count(model.outputs.len(), "output"));
    format!("{}: {}", imported.format.name(), parts.join(", "))
}

/// What is worth knowing, beside what is printed.
fn remarks(imported: &ImportedModel) {
    for remark in &imported.model.remarks {
        file::note(&format!("note: {remark}"));
    }
    let renamed: Vec<String> = imported.renamed.iter().map(|(from, to)| format!("{from} -> {to}")).collect();
    if !renamed.is_empty() {
        file::note(&format!("note: renamed {}", renamed.join(", ")));
    }
}
