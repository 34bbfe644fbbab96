//! The files, each as long as is asked for, and their readers.

use palmistry::checker::VerdictFile;
use palmistry::experiment::Scene;
use palmistry::import::{ForeignFormat, ImportQuestion, import};
use palmistry::observer::Record;
use palmistry::system::{System, format_text};
use std::path::Path;

/// What became of a file.
pub enum Outcome {
    /// It was read, or its mistakes were told; and so many bytes came out.
    Read { written: usize },
    /// It asks for too much.
    Refused,
}

/// A row of files.
pub struct Case {
    pub name: &'static str,
    /// The size of the first file, in whatever is counted.
    pub n: usize,
    pub file: fn(usize) -> Vec<u8>,
    pub read: fn(&[u8]) -> Outcome,
    /// Whether refusing it is right.
    pub may_be_refused: bool,
    /// Whether it stays short: what it means grows faster than itself.
    pub grows_slowly: bool,
}

fn list(count: usize, between: &str, one: impl Fn(usize) -> String) -> String {
    (0..count).map(one).collect::<Vec<_>>().join(between)
}

const LEVEL_3: &str = "<?xml version=\"1.0\"?><sbml xmlns=\"http://www.sbml.org/sbml/level3/version1/core\" level=\"3\" version=\"1\"><model id=\"m\">\
    <listOfCompartments><compartment id=\"c\" size=\"1\" constant=\"true\"/></listOfCompartments>";
const MATH: &str = "<math xmlns=\"http://www.w3.org/1998/Math/MathML\">";

/// A model of one state with a rate, and what stands before its parameters.
fn sbml(before: &str, rate: &str) -> Vec<u8> {
    format!(
        "{LEVEL_3}{before}<listOfParameters><parameter id=\"k\" value=\"1\" constant=\"true\"/><parameter id=\"x\" constant=\"false\"/></listOfParameters>\
         <listOfRules><rateRule variable=\"x\">{MATH}{rate}</math></rateRule></listOfRules></model></sbml>"
    )
    .into_bytes()
}

fn condition(i: usize) -> String {
    format!("<apply><lt/><ci>x</ci><cn>{i}</cn></apply>")
}

fn pieces(n: usize, condition: impl Fn(usize) -> String) -> String {
    let each = list(n, "", |i| {
        format!("<piece><apply><times/><cn>{i}</cn><ci>x</ci></apply>{}</piece>", condition(i))
    });
    format!("<piecewise>{each}<otherwise><cn>1</cn></otherwise></piecewise>")
}

fn both(i: usize) -> String {
    format!("<apply><and/>{}<apply><geq/><ci>x</ci><cn>-{i}</cn></apply></apply>", condition(i))
}

fn species(n: usize, is_held: bool) -> String {
    let one = |i: usize| {
        format!(
            "<species id=\"s{i}\" compartment=\"c\" initialConcentration=\"1\" constant=\"{is_held}\" boundaryCondition=\"{is_held}\" hasOnlySubstanceUnits=\"false\"/>"
        )
    };
    format!("<listOfSpecies>{}</listOfSpecies>", list(n, "", one))
}

fn reactions(n: usize) -> Vec<u8> {
    let one = |i: usize| {
        format!(
            "<reaction id=\"r{i}\" reversible=\"false\" fast=\"false\"><listOfReactants><speciesReference species=\"s{i}\" stoichiometry=\"1\" constant=\"true\"/></listOfReactants>\
             <kineticLaw>{MATH}<apply><times/><ci>k</ci><ci>s{i}</ci></apply></math><listOfLocalParameters><localParameter id=\"k\" value=\"1\"/></listOfLocalParameters></kineticLaw></reaction>"
        )
    };
    let all = list(n, "", one);
    format!("{LEVEL_3}{}<listOfReactions>{all}</listOfReactions></model></sbml>", species(n, false))
        .into_bytes()
}

fn functions(n: usize) -> Vec<u8> {
    let body = |i: usize| match i {
        0 => "<apply><plus/><ci>a</ci><ci>a</ci></apply>".to_owned(),
        _ => format!("<apply><ci>f{0}</ci><apply><ci>f{0}</ci><ci>a</ci></apply></apply>", i - 1),
    };
    let all = list(n, "", |i| {
        format!(
            "<functionDefinition id=\"f{i}\">{MATH}<lambda><bvar><ci>a</ci></bvar>{}</lambda></math></functionDefinition>",
            body(i)
        )
    });
    let before = format!("<listOfFunctionDefinitions>{all}</listOfFunctionDefinitions>");
    sbml(&before, &format!("<apply><ci>f{}</ci><ci>x</ci></apply>", n - 1))
}

fn script(lines: &str, rates: &str) -> Vec<u8> {
    format!(
        "import sympy as sym\na, b = sym.symbols(\"a b\")\nk = sym.Symbol(\"k\")\nx = [[a],[b]]\n{lines}\nh = [[a]]\np = [[k]]\nu = []\nw = []\nf = {rates}\nvariables_locales = locals().copy()\n"
    )
    .into_bytes()
}

fn imported(format: ForeignFormat, file: &[u8]) -> Outcome {
    let text = String::from_utf8_lossy(file);
    let question = ImportQuestion { format: Some(format), ..ImportQuestion::default() };
    match import("a", &text, &question) {
        Ok(found) => Outcome::Read { written: found.text.len() },
        Err(why) if why.message.contains("too ") || why.message.contains("more than") => Outcome::Refused,
        Err(why) => panic!("{format:?}: {}", why.message),
    }
}

fn xml(file: &[u8]) -> Outcome {
    imported(ForeignFormat::Sbml, file)
}

fn python(file: &[u8]) -> Outcome {
    imported(ForeignFormat::StrikePy, file)
}

fn julia(file: &[u8]) -> Outcome {
    imported(ForeignFormat::Julia, file)
}

fn printed(file: &[u8]) -> Outcome {
    imported(ForeignFormat::Formulas, file)
}

/// A proof file with all that can be wrong with it.
fn proof(file: &[u8]) -> Outcome {
    let text = String::from_utf8_lossy(file);
    let found = System::examine_text("a.proof", &text, Path::new(""), 20);
    let said = found.problems.iter().map(|why| format!("{:?}", miette::Report::new(why.clone())).len());
    Outcome::Read { written: said.sum() }
}

fn formatted(file: &[u8]) -> Outcome {
    let text = String::from_utf8_lossy(file);
    Outcome::Read { written: format_text("a.proof", &text).map_or(0, |text| text.len()) }
}

fn scene(file: &[u8]) -> Outcome {
    let text = String::from_utf8_lossy(file);
    let said = Scene::parse("a.toml", &text).err().map(|why| format!("{:?}", miette::Report::new(why)).len());
    Outcome::Read { written: said.unwrap_or(0) }
}

fn record(file: &[u8]) -> Outcome {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.csv");
    std::fs::write(&path, file).unwrap();
    let written = match Record::read(&path, &[]) {
        Ok(record) => record.len() * record.names().len(),
        Err(why) => format!("{:?}", miette::Report::new(why)).len(),
    };
    Outcome::Read { written }
}

fn verdicts(file: &[u8]) -> Outcome {
    let text = String::from_utf8_lossy(file);
    Outcome::Read { written: VerdictFile::read(&text).map_or(0, |_| 1) }
}

const HEAD: &str = "system \"a\"\nstate x\n";

const fn case(name: &'static str, n: usize, file: fn(usize) -> Vec<u8>, read: fn(&[u8]) -> Outcome) -> Case {
    Case { name, n, file, read, may_be_refused: false, grows_slowly: false }
}

const fn refusable(
    name: &'static str,
    n: usize,
    file: fn(usize) -> Vec<u8>,
    read: fn(&[u8]) -> Outcome,
) -> Case {
    Case { name, n, file, read, may_be_refused: true, grows_slowly: true }
}

/// All rows.
pub const CASES: &[Case] = &[
    refusable(
        "SBML: attributes",
        100,
        |n| format!("<sbml level=\"3\" {}/>", list(n, " ", |i| format!("a{i}=\"1\""))).into_bytes(),
        |file| match import("a.xml", &String::from_utf8_lossy(file), &ImportQuestion::default()) {
            Err(why) if why.message.contains("more than") => Outcome::Refused,
            _ => Outcome::Read { written: 0 },
        },
    ),
    refusable(
        "SBML: prefixes",
        2000,
        |n| {
            format!("<sbml level=\"3\">{}</sbml>", list(n, "", |i| format!("<a{i}:b xmlns:a{i}=\"u{i}\"/>")))
                .into_bytes()
        },
        |file| match import("a.xml", &String::from_utf8_lossy(file), &ImportQuestion::default()) {
            Err(why) if why.message.contains("more than") => Outcome::Refused,
            _ => Outcome::Read { written: 0 },
        },
    ),
    case("SBML: constant species", 300, |n| sbml(&species(n, true), "<ci>x</ci>"), xml),
    case("SBML: reactions", 150, reactions, xml),
    case("SBML: pieces", 400, |n| sbml("", &pieces(n, condition)), xml),
    case("SBML: pieces of two conditions", 100, |n| sbml("", &pieces(n, both)), xml),
    refusable(
        "SBML: pieces in pieces",
        12,
        |n| {
            sbml("", &(0..n).fold("<cn>1</cn>".to_owned(), |inner, i| format!("<piecewise><piece><apply><plus/><ci>x</ci><cn>{i}</cn></apply>{}</piece><otherwise>{inner}</otherwise></piecewise>", condition(i))))
        },
        xml,
    ),
    refusable("SBML: functions of functions", 10, functions, xml),
    case(
        "SBML: one line",
        200,
        |n| sbml("", &format!("<apply><plus/>{}</apply>", list(n * 20, "", |i| format!("<cn>{i}</cn>")))),
        xml,
    ),
    refusable(
        "script: a vector that doubles",
        10,
        |n| script("v = sym.Matrix([[a],[b]])\n".to_owned().as_str(), "v").splice_lines("v = v + v\n", n),
        python,
    ),
    case(
        "script: definitions",
        1200,
        |n| script(&list(n, "\n", |i| format!("q{i} = k*a + {i}")), "[[q1],[k*q0]]"),
        python,
    ),
    case(
        "script: one name again and again",
        1200,
        |n| script(&list(n, "\n", |i| format!("q = k*a + {i}")), "[[q],[a]]"),
        python,
    ),
    refusable(
        "printed: shared parts",
        50,
        |n| {
            format!(
                "states: x\nx' = @1=(x<0), {}, @{n}\n",
                list(n - 1, ", ", |i| format!(
                    "@{}=if_else(@1, x+{i}, @{})",
                    i + 2,
                    if i == 0 { "1".to_owned() } else { (i + 1).to_string() }
                ))
            )
            .into_bytes()
        },
        |file| match import("a.txt", &String::from_utf8_lossy(file), &ImportQuestion::default()) {
            Ok(found) => Outcome::Read { written: found.text.len() },
            Err(_) => Outcome::Refused,
        },
    ),
    case(
        "printed: rates",
        800,
        |n| list(n, "\n", |i| format!("x{i}' = -k{i}*x{i} + u")).into_bytes(),
        printed,
    ),
    case(
        "@ODEmodel: equations with inputs",
        600,
        |n| {
            format!(
                "ode = @ODEmodel(\n{},\n y(t) = x0(t))\n",
                list(n, ",\n", |i| format!("x{i}'(t) = -u{i}(t)*x{i}(t)*k{i}"))
            )
            .into_bytes()
        },
        julia,
    ),
    case(
        "@ODEmodel: names that are spelled alike",
        700,
        |n| {
            format!(
                "ode = @ODEmodel(\n{},\n y(t) = β0(t))\n",
                list(n, ",\n", |i| format!("β{i}'(t) = -state(t)*beta(t)"))
            )
            .into_bytes()
        },
        julia,
    ),
    case(
        "proof: states",
        800,
        |n| {
            format!(
                "system \"a\"\nstate {}\ndrift f\n{}\noutput x0\n",
                list(n, ", ", |i| format!("x{i}")),
                list(n, "\n", |i| format!("  x{i}' = -x{i}"))
            )
            .into_bytes()
        },
        proof,
    ),
    case(
        "proof: definitions",
        1500,
        |n| format!("{HEAD}{}\n", list(n, "\n", |i| format!("let a{i} = x + {i}"))).into_bytes(),
        proof,
    ),
    case(
        "proof: definitions that double",
        500,
        |n| {
            format!(
                "{HEAD}let a0 = x\n{}\n",
                list(n, "\n", |i| format!("let a{} = a{i}*x + a{i} + {i}", i + 1))
            )
            .into_bytes()
        },
        proof,
    ),
    case(
        "proof: claims",
        700,
        |n| format!("{HEAD}{}\n", list(n, "\n", |i| format!("claim c{i}: x + {i} = {i} + x"))).into_bytes(),
        proof,
    ),
    case(
        "proof: errata in a chain",
        500,
        |n| {
            format!(
                "{HEAD}{}\n",
                list(n, "\n", |i| format!(
                    "erratum e{i}{}: printed x = 2*x corrected x = x",
                    if i + 1 < n { format!(" follows e{}", i + 1) } else { String::new() }
                ))
            )
            .into_bytes()
        },
        proof,
    ),
    case(
        "proof: a chain of restated claims",
        500,
        |n| {
            format!(
                "{HEAD}{}\n",
                list(n, "\n", |i| if i == 0 {
                    "claim e0: x = x".to_owned()
                } else {
                    format!("claim e{i} restates e{}: x = x", i - 1)
                })
            )
            .into_bytes()
        },
        proof,
    ),
    case(
        "proof: one long line",
        6000,
        |n| format!("{HEAD}claim 1: x{} = y\n", " + x".repeat(n)).into_bytes(),
        proof,
    ),
    case(
        "proof: one long name",
        40_000,
        |n| format!("{HEAD}claim 1: x = {}\n", "y".repeat(n)).into_bytes(),
        proof,
    ),
    case(
        "proof: mistakes",
        2000,
        |n| format!("{HEAD}{}\n", list(n, "\n", |i| format!("claim c{i}: x = y{i}"))).into_bytes(),
        proof,
    ),
    case(
        "proof: comments and empty lines",
        10_000,
        |n| format!("{HEAD}{}", "# a\n\n".repeat(n)).into_bytes(),
        proof,
    ),
    case("proof: brackets", 20_000, |n| format!("{HEAD}claim 1: {}\n", "(".repeat(n)).into_bytes(), proof),
    case(
        "proof: a long title",
        40_000,
        |n| format!("system \"{}\"\nstate x\n", "\u{1b}".repeat(n)).into_bytes(),
        proof,
    ),
    case(
        "fmt: fields",
        800,
        |n| {
            format!(
                "system \"a\"\nstate {}\ndrift f\n{}\n",
                list(n, ", ", |i| format!("x{i}")),
                list(n, "\n", |i| format!("  x{i}' = -x{i}"))
            )
            .into_bytes()
        },
        formatted,
    ),
    case(
        "scene: unknown keys",
        3000,
        |n| format!("title = \"a\"\n{}\n", list(n, "\n", |i| format!("key{i} = 1"))).into_bytes(),
        scene,
    ),
    case(
        "scene: one long line",
        20_000,
        |n| format!("title = \"{}\" nothing\n", "a".repeat(n)).into_bytes(),
        scene,
    ),
    case(
        "CSV: columns",
        4000,
        |n| {
            format!(
                "time,{}\n0,{}\n1,{}\n",
                list(n, ",", |i| format!("c{i}")),
                list(n, ",", |_| "1".to_owned()),
                list(n, ",", |_| "2".to_owned())
            )
            .into_bytes()
        },
        record,
    ),
    case(
        "CSV: columns that are missing",
        4000,
        |n| format!("{}\n1\n", list(n, ",", |i| format!("c{i}"))).into_bytes(),
        record,
    ),
    case(
        "CSV: rows",
        6000,
        |n| format!("time,a\n{}\n", list(n, "\n", |i| format!("{i},1.5"))).into_bytes(),
        record,
    ),
    case(
        "CSV: rows that are no numbers",
        6000,
        |n| format!("time,a\n{}\n", list(n, "\n", |i| format!("{i},x"))).into_bytes(),
        record,
    ),
    case(
        "CSV: an open quotation",
        40_000,
        |n| format!("time,a\n0,\"{}", "1\n".repeat(n)).into_bytes(),
        record,
    ),
    case("verdicts: brackets", 40_000, |n| "[".repeat(n).into_bytes(), verdicts),
];

/// A script with lines before its last part.
trait Lines {
    fn splice_lines(self, line: &str, count: usize) -> Vec<u8>;
}

impl Lines for Vec<u8> {
    fn splice_lines(self, line: &str, count: usize) -> Vec<u8> {
        let text = String::from_utf8(self).unwrap();
        text.replace("\nh = ", &format!("\n{}h = ", line.repeat(count))).into_bytes()
    }
}
