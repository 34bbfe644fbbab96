//! Models that other programs have, as proof files: text in, text out, and errors that point into the text.
//!
//! A reader takes a file of its format to a [`ForeignModel`], in the file's own names: [`julia`] (with [`toolkit`]), [`sbml`],
//! [`scripts`] and [`formulas`]. What all have in common is a [`ForeignExpr`]; [`write`] says it in our language, and what was
//! written is read back before anybody gets it. Nothing of a file is ever run.
//!
//! This floor knows nothing of ranks and verdicts.

#![warn(missing_docs)]

mod cases;
mod elsewhere;
mod expression;
mod file_functions;
mod formulas;
mod functions;
mod julia;
mod model;
mod names;
mod petab;
mod print;
mod reduced;
mod sbml;
mod script;
mod scripts;
mod thin;
mod toolkit;
mod write;

pub use expression::{FUNCTIONS, ForeignExpr, ForeignKind, ForeignOrder};
pub use formulas::PrintedRoles;
pub use model::{ForeignConstant, ForeignModel, ForeignOutput, ForeignRate, ForeignUnknowns};
pub use petab::{ImportedProblem, PetabFile, PetabLoader, import_petab, is_petab, petab_beside};

use palmistry_io::foreign::{Allowance, Budget, Spent};
use palmistry_lang::{Code, Problem, ReadError, System, with_plain_line_ends};
use script::Dialect;
use std::path::Path;

/// What an import may come to: as many bytes as a proof file may have, expressions of so many parts once definitions and functions are put
/// in, and so many steps where a reader has to look at pairs of things.
const ALLOWANCE: Allowance = Allowance { bytes: 16 << 20, nodes: 2_000_000, steps: 200_000_000 };

/// That a model becomes too large to be read.
fn too_much(place: &expression::Span, spent: Spent) -> Problem {
    Problem::new(Code::Foreign, place, format!("the model becomes too large: {spent}"), "here")
        .help("give parts that occur several times names of their own, and import a part of the model")
}

/// A format that can be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ForeignFormat {
    /// `@ODEmodel` of StructuralIdentifiability.jl, or a model of ModelingToolkit.jl.
    Julia,
    /// SBML, levels 2 and 3.
    Sbml,
    /// A model file of StrikePy.
    StrikePy,
    /// A model script of STRIKE-GOLDD.
    StrikeGoldd,
    /// Formulas as SymPy and CasADi print them.
    Formulas,
}

impl ForeignFormat {
    /// All of them.
    pub const ALL: [ForeignFormat; 5] = [
        ForeignFormat::Julia,
        ForeignFormat::Sbml,
        ForeignFormat::StrikePy,
        ForeignFormat::StrikeGoldd,
        ForeignFormat::Formulas,
    ];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            ForeignFormat::Julia => "julia",
            ForeignFormat::Sbml => "sbml",
            ForeignFormat::StrikePy => "strikepy",
            ForeignFormat::StrikeGoldd => "strike-goldd",
            ForeignFormat::Formulas => "formulas",
        }
    }

    /// A short description, for the citation.
    fn in_words(self, text: &str) -> &'static str {
        match self {
            ForeignFormat::Julia if text.contains("@ODEmodel") => "@ODEmodel of StructuralIdentifiability.jl",
            ForeignFormat::Julia if text.contains("@DDSmodel") => "@DDSmodel of StructuralIdentifiability.jl",
            ForeignFormat::Julia => "ModelingToolkit.jl",
            ForeignFormat::Sbml => "SBML",
            ForeignFormat::StrikePy => "StrikePy",
            ForeignFormat::StrikeGoldd => "STRIKE-GOLDD",
            ForeignFormat::Formulas => "printed formulas",
        }
    }

    /// The format of a file, by what it begins with and by the end of its name.
    pub fn of(name: &str, text: &str) -> ForeignFormat {
        let extension = Path::new(name).extension().and_then(|end| end.to_str()).unwrap_or_default();
        let begin = text.trim_start_matches('\u{feff}').trim_start();
        let is_xml = begin.starts_with("<?xml") || begin.starts_with("<sbml") || begin.starts_with("<!--");
        match extension {
            _ if is_xml => ForeignFormat::Sbml,
            _ if text.contains("@ODEmodel") || text.contains("@DDSmodel") => ForeignFormat::Julia,
            "jl" => ForeignFormat::Julia,
            "xml" | "sbml" => ForeignFormat::Sbml,
            "py" => ForeignFormat::StrikePy,
            "m" => ForeignFormat::StrikeGoldd,
            _ if text.contains("@parameters") && text.contains('~') => ForeignFormat::Julia,
            _ if text.contains("variables_locales") || text.contains("import sympy") => {
                ForeignFormat::StrikePy
            }
            _ if text.lines().any(|line| line.trim_start().starts_with("syms ")) => {
                ForeignFormat::StrikeGoldd
            }
            _ => ForeignFormat::Formulas,
        }
    }
}

/// What is asked of a foreign file beside its text.
#[derive(Clone, Debug, Default)]
pub struct ImportQuestion {
    /// Its format; found out where it is not said.
    pub format: Option<ForeignFormat>,
    /// Which of several models, by name or number.
    pub model: Option<String>,
    /// Other outputs than the file's.
    pub outputs: Vec<String>,
    /// Which parameters are to be identified.
    pub unknowns: ForeignUnknowns,
    /// Names that are inputs which are known.
    pub known_inputs: Vec<String>,
    /// Names that are inputs which nobody knows.
    pub unknown_inputs: Vec<String>,
    /// States in the order of a vector of rates, for formulas that do not name them.
    pub states: Vec<String>,
}

/// A foreign file that was read.
#[derive(Debug)]
pub struct ImportedModel {
    /// The format that it was read as.
    pub format: ForeignFormat,
    /// The proof file.
    pub text: String,
    /// The model in its own names.
    pub model: ForeignModel,
    /// The names that differ in the proof file: foreign names and ours.
    pub renamed: Vec<(String, String)>,
}

/// Names of another program as names of the language, in the same order: Greek letters spelled out, what may not stand in a name replaced, words
/// of the language avoided, and no two names made one. Those that may stay as they are do so.
pub fn our_names(foreign: &[String]) -> Vec<String> {
    let names = names::ForeignNames::of(foreign.iter().map(String::as_str));
    foreign.iter().map(|name| names.ours(name).to_owned()).collect()
}

/// Reads a foreign file and writes it as a proof file, which is read back.
///
/// # Errors
/// What cannot be read, where, and what to do.
pub fn import(name: &str, text: &str, question: &ImportQuestion) -> Result<ImportedModel, ReadError> {
    // programs nest brackets deeper than people do, and a thread that asks may have a small stack
    let read = std::thread::scope(|scope| {
        let thread = std::thread::Builder::new().stack_size(STACK);
        let running = thread.spawn_scoped(scope, || read(name, text, question));
        // a panic goes on where it was asked for
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

/// The stack on which a file is read.
const STACK: usize = 64 << 20;

fn read(name: &str, text: &str, question: &ImportQuestion) -> Result<ImportedModel, ReadError> {
    let text = with_plain_line_ends(text);
    let format = question.format.unwrap_or_else(|| ForeignFormat::of(name, &text));
    let located = |problem: Problem| problem.locate(name, &text);
    let inputs = question.known_inputs.iter().chain(&question.unknown_inputs).cloned().collect();
    let roles = PrintedRoles { states: question.states.clone(), outputs: question.outputs.clone(), inputs };
    let which = question.model.as_deref();
    let budget = Budget::new(ALLOWANCE);
    let mut model = match format {
        ForeignFormat::Julia => julia::read(&text, which, &budget),
        ForeignFormat::Sbml => sbml::read(&text, &budget),
        ForeignFormat::StrikePy => scripts::read(&text, Dialect::Python, which, &budget),
        ForeignFormat::StrikeGoldd => scripts::read(&text, Dialect::Matlab, which, &budget),
        ForeignFormat::Formulas => formulas::read(&text, &roles, &budget),
    }
    .map_err(|problem| match format {
        // what is taken for formulas, or for SBML, because it looks like nothing else
        ForeignFormat::Formulas | ForeignFormat::Sbml if question.format.is_none() => {
            located(elsewhere::not_read(name, &text).unwrap_or(problem))
        }
        _ => located(problem),
    })?;
    // the other readers look for it themselves
    if let Some(wanted) = which.filter(|wanted| *wanted != "1" && model.title.as_deref() != Some(wanted))
        && matches!(format, ForeignFormat::Sbml | ForeignFormat::Formulas)
    {
        let problem = Problem::new(
            Code::Foreign,
            &(0..text.len().min(1)),
            format!("the file has no model '{wanted}'"),
            "the file",
        );
        return Err(located(problem.help("it has one model: leave --model out")));
    }
    if question.outputs.is_empty() {
        model.look_at_inputs().map_err(located)?;
    }
    let asked = |why: String| {
        located(
            Problem::new(Code::Foreign, &(0..text.len().min(1)), why, "the file")
                .help("name what the file has"),
        )
    };
    if format != ForeignFormat::Formulas {
        model.choose_outputs(&question.outputs).map_err(asked)?;
    }
    model.choose_inputs(&question.known_inputs, &question.unknown_inputs).map_err(asked)?;
    model.choose_unknowns(&question.unknowns).map_err(asked)?;
    if model.states.is_empty() {
        let problem = Problem::new(
            Code::Foreign,
            &(0..text.len().min(1)),
            "the file has no state that moves",
            "the file",
        );
        return Err(located(problem.help("a model has at least one rate of change")));
    }
    model.order_definitions().map_err(located)?;
    if model.outputs.is_empty() {
        model.remarks.push(
            "no outputs are known: write 'output ...' below, or import again with --output NAME,..."
                .to_owned(),
        );
    }
    if let Some(clock) = &model.clock {
        let value = ForeignExpr::name(clock, &(0..0));
        model.outputs.push(ForeignOutput { name: None, value });
    }
    let file =
        Path::new(name).file_name().map_or(name.to_owned(), |file| file.to_string_lossy().into_owned());
    let origin = format!("{}: {file}", format.in_words(&text));
    let written = write::proof_text(&model, &origin, &budget).map_err(located)?;
    // what cannot be read back is no proof file, whoever is to blame
    if let Err(why) = System::parse("import.proof", &written.text, Path::new("")) {
        let (line, _) = why.line_and_column();
        let excerpt = written.text.lines().nth(line.saturating_sub(1)).unwrap_or_default().trim();
        let message = format!("what was made of it is no proof file: {}", why.message);
        let place = place_of_line(&model, &written, line).unwrap_or(0..text.len().min(1));
        let label = if place.len() > 1 { "this" } else { "the file" };
        let problem = Problem::new(Code::Foreign, &place, message, label);
        let help = why.help.as_deref().map_or(String::new(), |help| format!("{help}; "));
        return Err(located(problem.help(format!("{help}it reads: {excerpt}"))));
    }
    let text = palmistry_lang::format_text("import.proof", &written.text).unwrap_or(written.text);
    Ok(ImportedModel { format, text, model, renamed: written.renamed })
}

/// Where the foreign file has what stands in a line of what was written: the rate, the definition or the output that the line is, or goes on with.
fn place_of_line(model: &ForeignModel, written: &write::ProofText, line: usize) -> Option<expression::Span> {
    let foreign = |ours: &str| {
        let renamed = written.renamed.iter().find(|(_, own)| own == ours);
        renamed.map_or_else(|| ours.to_owned(), |(foreign, _)| foreign.clone())
    };
    let lines: Vec<&str> = written.text.lines().take(line).collect();
    let head = lines.iter().rev().find(|line| line.contains(" = ") || line.starts_with("output "))?;
    let (left, _) = head.split_once(" = ").unwrap_or((head, ""));
    let left = left.trim();
    let place = match left.strip_prefix("let ") {
        Some(name) => {
            let name = foreign(name.trim());
            let definition = model.definitions.iter().find(|(own, _)| *own == name).map(|(_, value)| value);
            let output = || model.outputs.iter().find(|output| output.name.as_ref() == Some(&name));
            definition.or_else(|| output().map(|output| &output.value))?.span.clone()
        }
        None if left.starts_with("output ") => match model.outputs.as_slice() {
            [only] => only.value.span.clone(),
            _ => return None,
        },
        None => {
            let name = foreign(left.trim_end_matches(['\'', '+', ' ']));
            let state = model.states.iter().find(|state| state.name == name)?;
            if state.rate.span.is_empty() { state.span.clone() } else { state.rate.span.clone() }
        }
    };
    (!place.is_empty()).then_some(place)
}

/// What the first comments of a file say, in one line that is not too long: the first ones that stand together and are more than a
/// title of a part.
fn heading(text: &str, comments: &[(usize, String)], before: usize) -> Option<String> {
    let line = |at: usize| text.get(..at).unwrap_or(text).matches('\n').count();
    let mut blocks: Vec<(usize, Vec<&str>)> = Vec::new();
    for (at, comment) in comments.iter().filter(|(at, _)| *at < before).take(200) {
        let own = line(*at);
        match blocks.last_mut() {
            Some((last, block)) if own <= *last + 1 => {
                *last = own;
                block.push(comment);
            }
            _ => blocks.push((own, vec![comment])),
        }
    }
    let says = |block: Vec<&str>| {
        let has_letters = |line: &&str| line.chars().any(char::is_alphabetic);
        let words: Vec<&str> =
            block.into_iter().filter(has_letters).flat_map(str::split_whitespace).collect();
        (words.len() >= 4).then(|| words.join(" "))
    };
    let mut found = blocks.into_iter().find_map(|(_, block)| says(block))?;
    if found.len() > 400 {
        let end = found.char_indices().map(|(at, _)| at).take_while(|at| *at <= 400).last().unwrap_or(0);
        found.truncate(end);
        found.push_str("...");
    }
    Some(found)
}
