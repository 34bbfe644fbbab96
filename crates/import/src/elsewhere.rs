//! Files of other formats than those that are read: what they are, and how to bring them here.

use palmistry_lang::{Code, Problem};
use std::path::Path;

/// A format that is not read: what it is, the ends of its files' names, words that its text has (all of one list), and what to do.
type Elsewhere = (&'static str, &'static [&'static str], &'static [&'static [&'static str]], &'static str);

const FORMATS: [Elsewhere; 12] = [
    (
        "a proof file",
        &["proof"],
        &[&["system \"", "drift "]],
        "it needs no import: palmistry check FILE reads it",
    ),
    (
        "Modelica",
        &["mo", "mos"],
        &[&["equation", "der(", "end "]],
        "write x' = -k*x, a line each, and import that as formulas",
    ),
    (
        "Antimony",
        &["ant", "sb"],
        &[&["->", ";", " = "]],
        "write SBML with it (antimony.getSBMLString()), and import that",
    ),
    (
        "BioNetGen",
        &["bngl", "net"],
        &[&["begin model"], &["begin reaction rules"], &["begin molecule types"]],
        "write SBML with it (writeSBML()), and import that",
    ),
    ("COPASI", &["cps"], &[&["<COPASI"]], "export SBML from it, and import that"),
    ("CellML", &["cellml"], &[&["http://www.cellml.org/cellml/"]], "export SBML from it, and import that"),
    ("SED-ML", &["sedml"], &[&["<sedML"]], "import the model that it names"),
    ("XPP", &["ode"], &[&["\n@ total"], &["\ndone"]], "write x' = -k*x, a line each, without its commands"),
    ("a notebook", &["ipynb", "nb"], &[], "write its equations into a file, and import that"),
    ("LaTeX", &["tex"], &[&["\\begin{"], &["\\frac"]], "write x' = -k*x, a line each"),
    ("a scene", &["toml"], &[], "import the model, and name its proof file in the scene"),
    ("YAML", &["yaml", "yml"], &[&["sbml_files:"]], "a PEtab problem names 'parameter_file' and 'problems'"),
];

/// The problem that a text is of a format that is not read, if it looks like one.
pub(super) fn not_read(name: &str, text: &str) -> Option<Problem> {
    let end =
        Path::new(name).extension().and_then(|end| end.to_str()).unwrap_or_default().to_ascii_lowercase();
    let by_name = FORMATS.iter().find(|(_, ends, ..)| ends.contains(&end.as_str()));
    // a long text says what it is at its beginning
    let begin: String = text.chars().take(100_000).collect();
    let by_words = || {
        let has_all = |words: &&[&str]| words.iter().all(|word| begin.contains(word));
        FORMATS.iter().find(|(_, _, lists, _)| lists.iter().any(&has_all))
    };
    let (what, _, _, help) = by_name.or_else(by_words)?;
    let message = format!("this looks like {what}, which is not imported");
    Some(Problem::new(Code::Foreign, &(0..text.len().min(1)), message, "the file").help(*help))
}
