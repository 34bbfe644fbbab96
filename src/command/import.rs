//! `palmistry import`: models of other programs, as proof files.

use super::output::{Files, Form};
use super::{Status, Unusable};
use clap::{Args, ValueEnum};
use palmistry::file;
use palmistry::foreign::name_of;
use palmistry::import::{ForeignFormat, ForeignUnknowns, ImportQuestion, ImportedModel, import};
use serde_json::json;
use std::path::PathBuf;

/// Files longer than this are refused, as by every command that reads them.
const LONGEST_FILE: u64 = 16 << 20;

/// Takes a model of another program and writes it as a proof file, with its source cited.
///
/// Nothing of the file is run: it is read as text, by a reader of its format. What cannot be read is named with its line, and what was
/// written is read back before anybody gets it. Expressions are taken over exactly (a decimal is the fraction that it denotes), names
/// that mean something else in proof files are changed, and a comment in the new file says so.
///
/// Formats are recognised by what the file says and how it is called:
///   julia         @ODEmodel and @DDSmodel of StructuralIdentifiability.jl; @parameters, @variables, D(x) ~ ... and
///                 measured_quantities = [y ~ x] of ModelingToolkit.jl
///   sbml          SBML core, levels 2 and 3, without events, delays and algebraic rules
///   strikepy      model files of StrikePy: x, p, h, f, u and w
///   strike-goldd  model scripts of STRIKE-GOLDD, in MATLAB
///   formulas      what SymPy and CasADi print: x' = e, Eq(Derivative(x(t), t), e), Matrix([[e], [e]]), [e, e], @1=e
#[derive(Args)]
#[command(
    verbatim_doc_comment,
    after_help = "Examples:
  palmistry import SIWR.jl --out siwr.proof
  palmistry import benchmarks.jl --model Goodwin        one of several @ODEmodel
  palmistry import BIOMD0000000003.xml --output C,M --unknown VM1,VM3
  palmistry import printed.txt --from formulas --state x,y --output x
  palmistry import HIV.py --out hiv.proof && palmistry rank hiv.proof --samples 0"
)]
pub(crate) struct Import {
    /// The foreign file.
    file: PathBuf,
    /// The format of the file, where it is not to be found out.
    #[arg(long, value_enum, value_name = "FORMAT")]
    from: Option<From>,
    /// Write the proof file here; without it, it is printed.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Which of several models, by its name or its number.
    #[arg(long, value_name = "NAME")]
    model: Option<String>,
    /// What is measured, in place of what the file says: names of states, definitions or outputs; of formulas expressions too.
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    output: Vec<String>,
    /// Which parameters are to be identified: all, none, or these. Without it those that the file says, and of SBML all.
    #[arg(long, value_name = "all|none|NAME,...", value_delimiter = ',')]
    unknown: Vec<String>,
    /// Parameters that are signals which somebody knows.
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    input: Vec<String>,
    /// Parameters that are signals which nobody knows.
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    unknown_input: Vec<String>,
    /// The states in the order of a vector of rates, of formulas that do not name them.
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
    #[value(aliases = ["sympy", "casadi"])]
    Formulas,
}

impl From {
    fn format(self) -> ForeignFormat {
        match self {
            From::Julia => ForeignFormat::Julia,
            From::Sbml => ForeignFormat::Sbml,
            From::Strikepy => ForeignFormat::StrikePy,
            From::StrikeGoldd => ForeignFormat::StrikeGoldd,
            From::Formulas => ForeignFormat::Formulas,
        }
    }
}

impl Import {
    pub fn run(self) -> miette::Result<Status> {
        let shown = name_of(&self.file);
        let text = file::read_text(&self.file, LONGEST_FILE)
            .map_err(|why| Unusable::report(format!("cannot read {shown}: {why}"), ""))?;
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
            format: self.from.map(From::format),
            model: self.model.clone(),
            outputs: list(&self.output),
            unknowns,
            known_inputs: list(&self.input),
            unknown_inputs: list(&self.unknown_input),
            states: list(&self.state),
        }
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
